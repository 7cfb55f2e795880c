//! Snippets for the appearance of surfaces: images and alpha masks, light, and what is drawn on them.

use super::parts::*;
use super::variant::{LightsKind, RaysKind, Variant};

impl Variant {
    /// How weights of a triangle's corners change from pixel to pixel, where something follows from that.
    pub fn weights(self) -> Option<Parts> {
        (self.textured || self.styled || self.analytic).then_some(snippets!("shared/weights.wgsl"))
    }

    /// Normals of surfaces, and the light there.
    pub fn lit_surface(self) -> Parts {
        match (self.timed, self.instanced) {
            (true, _) => snippets!("shared/table.wgsl", "shared/surface.wgsl", "shared/normal_timed.wgsl"),
            (false, true) => snippets!("shared/table.wgsl", "shared/surface.wgsl", "shared/normal_placed.wgsl"),
            (false, false) => snippets!("shared/table.wgsl", "shared/surface.wgsl", "shared/normal.wgsl"),
        }
    }

    /// The surfaces of triangles, and of spheres where there are some.
    pub fn flat_surface(self) -> Parts {
        match (self.spheres, self.rays) {
            (false, _) => snippets!("shared/flat_triangle.wgsl"),
            (true, RaysKind::Curves { .. }) => snippets!(
                "shared/sphere.wgsl",
                "shared/sphere_chord.wgsl",
                "camera/curves_outward.wgsl",
                "shared/flat_sphere.wgsl"
            ),
            (true, _) => snippets!(
                "shared/sphere.wgsl",
                "shared/sphere_chord.wgsl",
                "camera/straight_outward.wgsl",
                "shared/flat_sphere.wgsl"
            ),
        }
    }

    /// What casts shadows.
    pub fn leaves(self) -> Option<Parts> {
        let parts = match (self.spheres, self.masked) {
            (false, false) => snippets!("shared/leaf_triangle.wgsl", "shared/leaf_solid.wgsl"),
            (false, true) => snippets!("shared/leaf_triangle.wgsl", "lights/masked_casters.wgsl"),
            (true, false) => snippets!("shared/leaf_sphere.wgsl", "shared/leaf_solid.wgsl"),
            (true, true) => snippets!("shared/leaf_sphere.wgsl", "lights/masked_casters.wgsl"),
        };
        (self.lights == LightsKind::Shadowed).then_some(parts)
    }

    /// The colours of a triangle's corners, for kernels that look up images.
    pub fn corner_colors(self) -> Option<Parts> {
        let parts =
            if self.colored { snippets!("textures/colored.wgsl") } else { snippets!("textures/uncolored.wgsl") };
        self.textured.then_some(parts)
    }

    /// The images that lie on triangles.
    pub fn pages(self) -> Option<Binding> {
        self.textured.then(|| texture("pages", "texture_2d_array<f32>"))
    }

    /// How these are looked up.
    pub fn images(self) -> Parts {
        if self.textured {
            return snippets!(
                "materials/material.wgsl",
                "shared/table.wgsl",
                "materials/rows.wgsl",
                "textures/layout.wgsl",
                "textures/levels.wgsl",
                "textures/mapped.wgsl",
                "textures/filter.wgsl"
            );
        }
        snippets!("materials/material.wgsl", "shared/table.wgsl", "materials/rows.wgsl", "textures/plain.wgsl")
    }

    /// What light arrives at a surface, and what it sends back.
    pub fn light(self) -> [Parts; 2] {
        let lights = match self.lights {
            LightsKind::Plain => snippets!("shared/table.wgsl", "lights/rows.wgsl", "lights/plain.wgsl"),
            LightsKind::Positional => {
                snippets!("shared/table.wgsl", "lights/rows.wgsl", "lights/positional.wgsl", "lights/unshadowed.wgsl")
            }
            LightsKind::Shadowed => match self.timed {
                true => snippets!(
                    "shared/table.wgsl",
                    "lights/rows.wgsl",
                    "lights/positional.wgsl",
                    "lights/shadowed.wgsl",
                    "lights/casters_timed.wgsl",
                    "shared/segment.wgsl",
                    "shared/bvh.wgsl"
                ),
                false => snippets!(
                    "shared/table.wgsl",
                    "lights/rows.wgsl",
                    "lights/positional.wgsl",
                    "lights/shadowed.wgsl",
                    "lights/casters.wgsl",
                    "shared/segment.wgsl",
                    "shared/bvh.wgsl"
                ),
            },
        };
        let materials = match (self.glossy, self.sky) {
            (_, true) => snippets!("materials/glossy.wgsl", "materials/sky.wgsl"),
            (true, false) => snippets!("materials/glossy.wgsl", "materials/no_sky.wgsl"),
            (false, false) => snippets!("materials/matte.wgsl", "materials/no_sky.wgsl"),
        };
        [lights, materials]
    }

    /// The pictures that are thrown onto them.
    pub fn thrown_pictures(self) -> Parts {
        match self.pictures {
            true => snippets!("shared/half_meets.wgsl", "pictures/places.wgsl", "pictures/thrown.wgsl"),
            false => snippets!("pictures/none.wgsl"),
        }
    }

    /// What is drawn on surfaces.
    pub fn style(self) -> Parts {
        if self.styled {
            return snippets!(
                "styles/layout.wgsl",
                "styles/shaded_hit.wgsl",
                "styles/patterns.wgsl",
                "styles/lines.wgsl"
            );
        }
        snippets!("styles/shaded_hit.wgsl", "styles/plain.wgsl")
    }

    /// How that is drawn.
    pub fn style_binding(self) -> Option<Binding> {
        self.styled.then(|| uniform("style", "Style"))
    }

    /// The tables and images in which kernels look up alpha masks.
    pub fn mask_bindings(self) -> Vec<Binding> {
        if !self.masked {
            return Vec::new();
        }
        [table("surfaces"), table("materials")].into_iter().chain(self.pages()).collect()
    }

    /// The test whether a surface is opaque where its image has some opacity.
    pub fn opacity(self) -> Parts {
        if self.masked { snippets!("textures/opacity.wgsl") } else { snippets!("textures/opaque.wgsl") }
    }

    /// The test whether a triangle may have holes.
    pub fn holes(self) -> Parts {
        if self.masked { snippets!("textures/holes.wgsl") } else { snippets!("textures/no_holes.wgsl") }
    }

    /// The tables that [`Variant::holes`] reads, for kernels that look up nothing else of materials and surfaces.
    pub fn hole_surfaces(self) -> Option<Parts> {
        let parts = snippets!("materials/material.wgsl", "materials/rows.wgsl", "textures/layout.wgsl");
        self.masked.then_some(parts)
    }

    /// Their alpha masks.
    pub fn alpha_masks(self) -> Parts {
        if self.masked {
            return snippets!(
                "materials/material.wgsl",
                "shared/table.wgsl",
                "materials/rows.wgsl",
                "textures/layout.wgsl",
                "textures/levels.wgsl",
                "textures/opacity.wgsl",
                "textures/masked.wgsl"
            );
        }
        snippets!("textures/opaque.wgsl", "textures/solid.wgsl")
    }
}
