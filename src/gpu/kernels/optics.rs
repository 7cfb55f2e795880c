//! What a mirror or a lens brings into kernels.

use super::parts::*;
use super::variant::{Method, RaysKind, Variant};
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

impl OpticsKind {
    #[cfg(feature = "internals")]
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
    /// Rays are bounced after this dispatch.
    pub fn bounces_rays(self) -> bool {
        self.optics.is_some_and(|o| o != OpticsKind::Atlas)
    }

    /// For the rays of the next bounce.
    pub fn after_bounce(self) -> Variant {
        // a few rays, each its own way
        let method = if self.traces() { Method::Trace } else { Method::Raster };
        let by_tile = self.by_tile && method == Method::Raster;
        let rays = RaysKind::Field;
        Variant { rays, method, by_tile, small: false, incoherent: false, slabbed: false, bounced: true, ..self }
    }

    /// The pixel of a thread: of a tile that has a ray after a bounce, or of all.
    pub fn pixel_at(self) -> Parts {
        if self.bounced { LIVE_PIXELS } else { snippets!("shared/every_pixel.wgsl") }
    }

    /// A smooth surface is to be met.
    pub fn meets(self) -> bool {
        self.optics.is_some_and(OpticsKind::is_smooth)
    }

    /// Which triangles rays do not meet because they start there.
    pub fn start(self) -> &'static [Parts] {
        if self.bounced {
            &[OPTICS_LAYOUT, snippets!("optics/start.wgsl")]
        } else {
            &[snippets!("shared/any_start.wgsl")]
        }
    }

    /// What a pixel shows, and what lies behind its ray.
    pub fn seen(self) -> &'static [Parts] {
        if self.optics.is_some() {
            &[OPTICS_LAYOUT, snippets!("optics/seen.wgsl")]
        } else {
            &[snippets!("shared/seen.wgsl")]
        }
    }

    /// How rays arrive at the surface. Only straight ones meet a smooth one.
    pub fn arrival(self) -> Parts {
        match self.rays {
            RaysKind::Curves { .. } if !self.meets() => snippets!("optics/arrive_curved.wgsl"),
            _ => snippets!("optics/arrive_straight.wgsl"),
        }
    }

    /// The surface of the optics: its structs, and how rays meet it and go on from there.
    pub fn surface(self) -> (Binding, &'static [Parts]) {
        const SMOOTH: Parts = snippets!("optics/smooth.wgsl");
        const MARCH: Parts = snippets!("optics/march.wgsl");
        match self.optics {
            Some(OpticsKind::Quadrics) => {
                (reads("quadrics", "array<Quadric>"), &[SMOOTH, snippets!("optics/quadrics.wgsl")])
            }
            Some(OpticsKind::Torus) => {
                (reads("tori", "array<Torus>"), &[SMOOTH, MARCH, snippets!("optics/torus.wgsl")])
            }
            Some(OpticsKind::Wave) => {
                const CIRCLE: Parts = snippets!("optics/circle.wgsl");
                (reads("waves", "array<Wave>"), &[SMOOTH, MARCH, CIRCLE, snippets!("optics/wave.wgsl")])
            }
            _ => (reads("corners", "array<Corner>"), &[snippets!("optics/facets.wgsl")]),
        }
    }
}
