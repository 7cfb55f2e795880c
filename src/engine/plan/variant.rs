//! Which variant of the kernels a frame takes: decided here alone, before anything is planned.

use super::slabs::{self, Slabs};
use super::{SceneContents, Wanted};
use crate::camera::Camera;
use crate::camera::ray_order::is_reordered;
use crate::engine::{Arithmetic, RunOptions};
use crate::gpu::device::AdapterFeatures;
use crate::gpu::kernels::{LightsKind, Method, OpticsKind, RaysKind, Variant};
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
    let pictures = contents.has_pictures && wanted.needs_appearance();
    let variant = Variant {
        f64: run.arithmetic != Arithmetic::Single,
        atomics64: has.atomics64,
        f64_depths: has.software && has.f64 && has.atomics64,
        by_tile: false,
        wide: false,
        method: method(camera, contents, wanted, has, run).0,
        small: false,
        rays: slabs::kind(camera),
        incoherent: is_reordered(camera),
        slabbed: Slabs::of(camera).count() > 1,
        counting: wanted.counting,
        culling: !run.no_cull,
        all_uncertain: run.arithmetic == Arithmetic::Double,
        normals: contents.has_normals,
        textured: wanted.is_textured(contents),
        colored: wanted.is_colored(contents),
        masked: contents.has_alpha_masks,
        glossy: (contents.has_gloss || contents.has_sky) && has_colour,
        sky: contents.has_sky && has_colour,
        lights: match (contents.has_shadows, contents.has_positional_lights) {
            _ if !has_colour && !pictures => LightsKind::Plain,
            (true, _) => LightsKind::Shadowed,
            (false, true) => LightsKind::Positional,
            (false, false) if pictures => LightsKind::Positional,
            (false, false) => LightsKind::Plain,
        },
        pictures,
        styled: contents.has_style && wanted.needs_appearance(),
        outlined: contents.has_outlines && has_colour,
        optics: camera.optics.as_deref().map(OpticsKind::of),
        bounced: false,
        samples: wanted.samples(),
        analytic: wanted.analytic && wanted.samples() > 1,
        centred: run.rival.is_some() && wanted.samples() > 1,
        timed: contents.steps > 1,
        spheres: contents.has_spheres,
        instanced: follows_instances(camera, contents, wanted, has, run),
        volume: contents.volume.filter(|_| wanted.needs_volume()),
        // nine storage buffers are more than some adapters bind
        writes: wanted.srgb8
            && !(contents.steps > 1 && matches!(slabs::kind(camera), RaysKind::Curves { .. }))
            && camera.optics.is_none()
            && wanted.samples() == 1
            && !contents.has_outlines
            && contents.volume.is_none()
            && !contents.has_caustics,
    };
    let variant = if has.by_tile() { Variant { wide: has.wide, ..variant }.with_tiles() } else { variant };
    if wanted.channels.contains(&Channel::Certified) { variant } else { variant.with_small() }
}

/// How the triangle of each pixel is found, and why, where the costs do not decide. What samples see and what is proven is found from pairs.
/// Without asking for it nothing is traced that moves, since its hierarchy would be built anew for each frame.
pub fn method(
    camera: &Camera,
    contents: SceneContents,
    wanted: &Wanted,
    has: AdapterFeatures,
    run: &RunOptions,
) -> (Method, &'static str) {
    const RASTER: Method = Method::Raster;
    let is_auto = run.method == Method::Auto;
    match () {
        _ if run.rival.is_some() => (RASTER, ""),
        _ if contents.steps > 1 => (Method::Trace, "things move while the frame is taken"),
        _ if contents.has_spheres => (Method::Trace, "the scene has spheres"),
        _ if camera.optics.is_some() && camera.is_curved_or_layered() => {
            (Method::Trace, "a mirror or lens is seen along curved or layered rays")
        }
        _ if run.method == RASTER => (RASTER, "asked for"),
        _ if wanted.samples() > 1 => (RASTER, "samples are taken of pairs of triangles and tiles"),
        _ if wanted.channels.contains(&Channel::Certified) => (RASTER, "proofs take pairs of triangles and tiles"),
        _ if follows_instances(camera, contents, wanted, has, run) => (Method::Trace, "meshes stand in several places"),
        _ if !is_auto => (Method::Trace, "asked for"),
        _ if contents.has_alpha_masks => (RASTER, "the scene has alpha masks"),
        _ if run.moving => (RASTER, "everything moves"),
        _ if run.no_cull => (RASTER, "nothing is to be culled"),
        _ if run.arithmetic != Arithmetic::Rechecked => (RASTER, "other arithmetic is asked for"),
        _ if matches!(slabs::kind(camera), RaysKind::Curves { .. }) => (Method::Trace, "rays are curved"),
        // pair by pair each t takes hundreds of operations in words
        _ if !has.lanes && !has.f64 => (Method::Trace, "raster has no f64 and no subgroups of eight threads here"),
        _ => (Method::Auto, ""),
    }
}

/// Whether the frame is traced through a hierarchy of places and those of the meshes that stand there. Other frames take a copy of each mesh at
/// each of its places.
fn follows_instances(
    camera: &Camera,
    contents: SceneContents,
    wanted: &Wanted,
    has: AdapterFeatures,
    run: &RunOptions,
) -> bool {
    // on a CPU, raster of copies is faster where there are few triangles for each pixel: measurements are in `bench_results/lab.md`
    let pixels = u64::from(camera.width) * u64::from(camera.height);
    let is_cheaper = !has.software || contents.triangles as u64 >= 4 * pixels || run.method == Method::Trace;
    let has_shadow_rays = contents.has_shadows && (wanted.has_colour() || contents.has_pictures);
    let is_rasterized = wanted.samples() > 1 || wanted.channels.contains(&Channel::Certified);
    let is_other_run = run.rival.is_some() || run.moving || run.no_cull || run.arithmetic != Arithmetic::Rechecked;
    contents.has_instances
        && is_cheaper
        && run.method != Method::Raster
        && !is_other_run
        && !is_rasterized
        && !wanted.gradients
        && !matches!(slabs::kind(camera), RaysKind::Curves { .. })
        && camera.optics.is_none()
        && contents.steps <= 1
        && !(contents.has_spheres || contents.has_alpha_masks || contents.has_caustics || has_shadow_rays)
        && !(contents.has_pictures && wanted.needs_appearance())
}
