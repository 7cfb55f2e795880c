//! The kernels of cameras with a mirror or a lens.

use super::*;
use crate::camera::optics::{Optics, Smooth, Surface};

/// What the surface of a camera's optics is made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OpticsKind {
    Facets,
    /// Facets that are looked up in an atlas.
    Atlas,
    Quadrics,
    Torus,
    Wave,
}

const REFRACT: Parts = snippets!("optics/refract.wgsl");

impl OpticsKind {
    pub const ALL: [OpticsKind; 5] =
        [OpticsKind::Facets, OpticsKind::Atlas, OpticsKind::Quadrics, OpticsKind::Torus, OpticsKind::Wave];

    pub fn of(optics: &Optics) -> OpticsKind {
        match &optics.surface {
            Surface::Facets { .. } if optics.atlas.is_some() => OpticsKind::Atlas,
            Surface::Facets { .. } => OpticsKind::Facets,
            Surface::Smooth(Smooth::Quadrics(_)) => OpticsKind::Quadrics,
            Surface::Smooth(Smooth::Torus(_)) => OpticsKind::Torus,
            Surface::Smooth(Smooth::Wave(_)) => OpticsKind::Wave,
        }
    }

    /// The surface is no triangles, and met by `meet`.
    pub fn is_smooth(self) -> bool {
        matches!(self, OpticsKind::Quadrics | OpticsKind::Torus | OpticsKind::Wave)
    }
}

impl Variant {
    /// There are passes after the eye's.
    pub fn bounces_rays(self) -> bool {
        self.optics.is_some_and(|o| o != OpticsKind::Atlas)
    }

    /// The rays of the pass after this one's.
    pub fn after_bounce(self) -> Variant {
        Variant { rays: RaysKind::Field, scattered: false, slabbed: false, bounced: true, ..self }
    }

    /// A smooth surface is to be met.
    pub fn meets(self) -> bool {
        self.optics.is_some_and(OpticsKind::is_smooth)
    }

    /// Which triangles rays do not meet because they start there.
    pub(super) fn start(self) -> &'static [Parts] {
        if self.bounced {
            &[OPTICS_ROWS, snippets!("optics/start.wgsl")]
        } else {
            &[snippets!("shared/any_start.wgsl")]
        }
    }

    /// What a pixel shows, and what lies behind its ray.
    pub(super) fn seen(self) -> &'static [Parts] {
        if self.optics.is_some() {
            &[OPTICS_ROWS, snippets!("optics/seen.wgsl")]
        } else {
            &[snippets!("shared/seen.wgsl")]
        }
    }

    /// The surface of the optics: its rows, and how rays meet it and go on from there.
    fn surface(self) -> (Binding, &'static [Parts]) {
        const SMOOTH: Parts = snippets!("optics/smooth.wgsl");
        const MARCH: Parts = snippets!("optics/march.wgsl");
        match self.optics {
            Some(OpticsKind::Quadrics) => {
                (read("quadrics", "array<Quadric>"), &[SMOOTH, snippets!("optics/quadrics.wgsl")])
            }
            Some(OpticsKind::Torus) => (read("tori", "array<Torus>"), &[SMOOTH, MARCH, snippets!("optics/torus.wgsl")]),
            Some(OpticsKind::Wave) => {
                const CIRCLE: Parts = snippets!("optics/circle.wgsl");
                (read("waves", "array<Wave>"), &[SMOOTH, MARCH, CIRCLE, snippets!("optics/wave.wgsl")])
            }
            _ => (read("corners", "array<Corner>"), &[snippets!("optics/facets.wgsl")]),
        }
    }
}

/// Smooth surfaces into the visibility buffer; triangles get there by `raster`.
pub fn meet(variant: Variant) -> Kernel {
    let visibility = if variant.atomics64 { "array<atomic<u64>>" } else { "array<atomic<u32>>" };
    let (surface, surface_snippets) = variant.surface();
    let mut bindings = vec![params(), step(), optic(), paths(), surface, write("visibility", visibility)];
    bindings.extend(variant.pixel_rays());
    let snippets = [PARAMS, ITEMS, SLABS, variant.real(), BUNDLE, KEY, variant.merge(), OPTICS_ROWS, REFRACT];
    let own = [variant.camera(), snippets!("meet.wgsl")];
    let mut kernel = kernel("meet", bindings, &[&snippets[..], surface_snippets, &own[..], variant.pixel()].concat());
    kernel.constants = variant.constants();
    kernel
}

/// The rays that the optics' surface turns.
pub fn bounce(variant: Variant) -> Kernel {
    let (surface, surface_snippets) = variant.surface();
    let mut bindings = vec![
        params(),
        optic(),
        read("visibility", "array<u32>"),
        paths(),
        surface,
        write("bounced_hi", "array<f32>"),
        write("bounced_lo", "array<f32>"),
        write("bounced_paths", "array<PathState>"),
    ];
    bindings.extend(variant.pixel_rays());
    let snippets = [PARAMS, ITEMS, SLABS, variant.real(), BUNDLE, KEY, OPTICS_ROWS, REFRACT];
    let own = [variant.camera(), snippets!("bounce.wgsl")];
    let mut kernel = kernel("bounce", bindings, &[&snippets[..], surface_snippets, &own[..], variant.pixel()].concat());
    kernel.constants = variant.constants();
    kernel
}

/// What facets show, from their atlas.
pub fn paste(variant: Variant, planes: &[Channel]) -> Kernel {
    let (surface, surface_snippets) = variant.surface();
    let mut bindings = vec![
        params(),
        optic(),
        uniform("atlas_layout", "AtlasLayout"),
        read("visibility", "array<u32>"),
        surface,
        read("atlas", "array<u32>"),
        write("planes", "array<u32>"),
    ];
    bindings.extend(variant.pixel_rays());
    let snippets = [PARAMS, ITEMS, SLABS, variant.real(), BUNDLE, KEY, OPTICS_ROWS, REFRACT, SHADING];
    let own = [variant.camera(), snippets!("paste.wgsl")];
    let mut kernel = kernel("paste", bindings, &[&snippets[..], surface_snippets, &own[..], variant.pixel()].concat())
        .with_planes(planes);
    kernel.constants.extend(variant.constants());
    kernel
}

/// Bounds on the rays after a bounce, node by node.
pub fn fit(variant: Variant) -> Kernel {
    let variant = variant.after_bounce();
    let mut bindings = vec![params(), step(), optic(), write("nodes", "array<Node>"), write("cells", "array<Cell>")];
    bindings.extend(variant.rays());
    // bounds are f32
    let snippets = [PARAMS, ITEMS, INDEX, SLABS, BITS, REAL_F32, BUNDLE, OPTICS_ROWS];
    let mut kernel = kernel("fit", bindings, &[&snippets[..], &[variant.camera(), snippets!("fit.wgsl")]].concat());
    kernel.constants = variant.constants();
    kernel
}
