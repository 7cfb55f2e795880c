//! Which variant of the kernels a frame takes: decided here alone, before anything is planned.

use super::slabs::{self, Slabs};
use super::{SceneContents, Wanted};
use crate::camera::Camera;
use crate::camera::ray_order::is_reordered;
use crate::engine::{Arithmetic, RunOptions};
use crate::gpu::device::AdapterFeatures;
use crate::gpu::kernels::{LightsKind, OpticsKind, Variant};
use crate::image::frame::Channel;

/// The variant for a scene with these contents through `camera`, on an adapter with these abilities.
pub fn variant(
    camera: &Camera,
    contents: SceneContents,
    wanted: &Wanted,
    has: AdapterFeatures,
    run: &RunOptions,
) -> Variant {
    let has_colour = wanted.has_colour();
    let variant = Variant {
        f64: run.arithmetic != Arithmetic::Single,
        atomics64: has.atomics64,
        by_tile: false,
        wide: false,
        small: false,
        rays: slabs::kind(camera),
        incoherent: is_reordered(camera),
        slabbed: Slabs::of(camera).count() > 1,
        counting: wanted.counting,
        culling: !run.no_cull,
        all_uncertain: run.arithmetic == Arithmetic::Double,
        normals: contents.has_normals,
        textured: wanted.is_textured(contents),
        masked: contents.has_alpha_masks,
        glossy: (contents.has_gloss || contents.has_sky) && has_colour,
        sky: contents.has_sky && has_colour,
        lights: match (contents.has_shadows, contents.has_positional_lights) {
            _ if !has_colour => LightsKind::Plain,
            (true, _) => LightsKind::Shadowed,
            (false, true) => LightsKind::Positional,
            (false, false) => LightsKind::Plain,
        },
        styled: contents.has_style && wanted.needs_appearance(),
        outlined: contents.has_outlines && has_colour,
        optics: camera.optics.as_deref().map(OpticsKind::of),
        bounced: false,
        samples: wanted.samples(),
        analytic: wanted.analytic && wanted.samples() > 1,
    };
    let variant = if has.lanes && has.f64 { Variant { wide: has.wide, ..variant }.with_tiles() } else { variant };
    if wanted.channels.contains(&Channel::Certified) { variant } else { variant.with_small() }
}
