//! The kernels that say what surfaces look like: their images and holes, the light that they send back, and what is drawn on them.

use super::*;

impl Variant {
    /// How weights of a triangle's corners change from pixel to pixel, where something follows from that.
    pub(super) fn weights(self) -> Option<Parts> {
        (self.textured || self.styled || self.analytic).then_some(snippets!("shared/weights.wgsl"))
    }

    /// The images that lie on triangles.
    pub(super) fn pages(self) -> Option<Binding> {
        self.textured.then(|| texture("pages", "texture_2d_array<f32>"))
    }

    /// How these are looked up.
    pub(super) fn images(self) -> Parts {
        if self.textured {
            return snippets!(
                "materials/material.wgsl",
                "textures/rows.wgsl",
                "textures/levels.wgsl",
                "textures/mapped.wgsl",
                "textures/filter.wgsl"
            );
        }
        snippets!("materials/material.wgsl", "textures/plain.wgsl")
    }

    /// What light arrives at a surface, and what it sends back.
    pub(super) fn light(self) -> [Parts; 2] {
        let lights = match self.lights {
            LightsKind::Plain => snippets!("lights/plain.wgsl"),
            LightsKind::Placed => snippets!("lights/placed.wgsl", "lights/unhidden.wgsl"),
            LightsKind::Hidden => {
                snippets!("lights/placed.wgsl", "lights/hidden.wgsl", "shared/segment.wgsl", "shared/bvh.wgsl")
            }
        };
        let materials = match (self.glossy, self.sky) {
            (_, true) => snippets!("materials/glossy.wgsl", "materials/sky.wgsl"),
            (true, false) => snippets!("materials/glossy.wgsl", "materials/no_sky.wgsl"),
            (false, false) => snippets!("materials/matte.wgsl", "materials/no_sky.wgsl"),
        };
        [lights, materials]
    }

    /// What is drawn on surfaces.
    pub(super) fn style(self) -> Parts {
        if self.styled {
            return snippets!("styles/rows.wgsl", "styles/look.wgsl", "styles/patterns.wgsl", "styles/lines.wgsl");
        }
        snippets!("styles/look.wgsl", "styles/plain.wgsl")
    }

    /// How that is drawn.
    pub(super) fn style_row(self) -> Option<Binding> {
        self.styled.then(|| uniform("style", "Style"))
    }

    /// Where their holes are.
    pub(super) fn holes(self) -> Parts {
        if self.masked {
            return snippets!(
                "materials/material.wgsl",
                "textures/rows.wgsl",
                "textures/levels.wgsl",
                "textures/masked.wgsl"
            );
        }
        SOLID
    }
}

pub fn shade(variant: Variant, planes: &[Channel]) -> Kernel {
    let mut bindings = vec![
        params(),
        uniform("shading", "Shading"),
        read("triangles", "array<vec4<u32>>"),
        read("vertices_hi", "array<f32>"),
        read("vertices_lo", "array<f32>"),
        read("slot_of_id", "array<u32>"),
        read("surfaces", "array<vec4<u32>>"),
        read("normals", "array<f32>"),
        read("materials", "array<Material>"),
        read("lights", "array<vec4<f32>>"),
        read("visibility", "array<u32>"),
        write("planes", "array<u32>"),
    ];
    bindings.extend(variant.pages());
    bindings.extend(variant.pixel_rays());
    if variant.optics.is_some() {
        bindings.extend([optic(), paths()]);
    }
    let snippets = [PARAMS, ITEMS, INDEX, SLABS, VERTEX, variant.real(), TRIANGLE, BUNDLE, KEY];
    bindings.extend(variant.style_row());
    let own = [variant.camera(), SHADING, SURFACE, variant.images(), variant.style(), snippets!("shade.wgsl")];
    let mut all = [&snippets[..], &own[..], &variant.light(), variant.pixel(), variant.seen()].concat();
    all.extend(variant.weights());
    let mut kernel = kernel("shade", bindings, &all).with_planes(planes);
    kernel.constants.extend(variant.constants());
    kernel.constants.push(("NORMALS", variant.normals as u32 as f64));
    if let Some(optics) = variant.optics {
        kernel.constants.push(("SMOOTH", optics.is_smooth() as u32 as f64));
    }
    kernel
}

/// Lines between pixels, into the colour planes.
pub fn outline(planes: &[Channel]) -> Kernel {
    let bindings = vec![params(), uniform("style", "Style"), write("planes", "array<u32>")];
    let snippets = [PARAMS, ITEMS, SHADING, snippets!("styles/rows.wgsl"), snippets!("outline.wgsl")];
    kernel("outline", bindings, &snippets).with_planes(planes)
}

pub fn write_srgb(planes: &[Channel]) -> Kernel {
    let bindings =
        vec![params(), uniform("shading", "Shading"), read("planes", "array<u32>"), write("srgb8", "array<u32>")];
    kernel("write", bindings, &[PARAMS, ITEMS, SHADING, snippets!("write.wgsl")]).with_planes(planes)
}

/// The levels of an image, each from the one before; no part of a frame.
pub fn mip() -> Kernel {
    let coarser = write_texture("coarser", "texture_storage_2d<rgba16float, write>");
    let bindings = vec![texture("finer", "texture_2d<f32>"), coarser];
    kernel("mip", bindings, &[PARAMS, ITEMS, snippets!("mip.wgsl")])
}
