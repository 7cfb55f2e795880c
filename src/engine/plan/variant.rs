//! Which variant of the kernels a frame takes: decided here alone, before anything is planned.

use super::slabs::{self, Slabs};
use super::{SceneContents, Wanted};
use crate::camera::Camera;
use crate::engine::{Arithmetic, RunOptions};
use crate::gpu::device::AdapterFeatures;
use crate::gpu::kernels::{
    AdapterPath, Appearance, EdgeSamples, Extras, LightsKind, MaterialsKind, Method, OpticsKind, OpticsModel,
    PrimitivesKind, RayModel, SampleMeasure, Textures, TileDepths, TilePath, Variant, VerticesKind, Visibility,
};
use crate::image::frame::Channel;

/// The variant for a scene with these contents through `camera`, on an adapter with these abilities.
pub fn variant(
    camera: &Camera,
    contents: SceneContents,
    wanted: &Wanted,
    has: AdapterFeatures,
    run: &RunOptions,
) -> Variant {
    let kind = slabs::kind(camera);
    let optics = camera.optics.as_deref().map(|optics| OpticsModel { kind: OpticsKind::of(optics), bounced: false });
    let visibility = Visibility::by_pair(method(camera, contents, wanted, has, run).0);
    let variant = Variant {
        path: AdapterPath { arithmetic: run.arithmetic, atomics64: has.atomics64, visibility },
        rays: RayModel { kind, slabbed: Slabs::of(camera).count() > 1, optics },
        appearance: appearance(contents, wanted),
        extras: Extras {
            vertices: match contents.steps > 1 {
                true => VerticesKind::Timed,
                false if follows_instances(camera, contents, wanted, has, run) => VerticesKind::Placed,
                false => VerticesKind::Still,
            },
            primitives: match contents.has_spheres {
                true if contents.has_capsules => PrimitivesKind::Capsules,
                true => PrimitivesKind::Spheres,
                false => PrimitivesKind::Triangles,
            },
            samples: edge_samples(wanted, run),
            outlined: contents.has_outlines() && wanted.has_colour(),
            volume: contents.volume.filter(|_| wanted.needs_volume()),
            // nine storage buffers are more than some adapters bind
            writes: wanted.srgb8
                && !(contents.steps > 1 && kind.is_curved())
                && optics.is_none()
                && wanted.samples() == 1
                && !contents.has_outlines()
                && contents.volume.is_none()
                && !contents.has_caustics,
            counting: wanted.counting,
            culling: !run.no_cull,
        },
    };
    let variant = if has.by_tile() { variant.with_tiles(tile_path(has)) } else { variant };
    if wanted.channels.contains(&Channel::Certified) { variant } else { variant.with_small() }
}

/// How raster by tile goes on an adapter: a CPU finds each t in f64, where it has that.
fn tile_path(has: AdapterFeatures) -> TilePath {
    let is_exact = has.software && has.f64 && has.atomics64;
    let depths = if is_exact { TileDepths::Exact { small: false } } else { TileDepths::Bounded };
    TilePath { wide: has.wide, depths }
}

fn appearance(contents: SceneContents, wanted: &Wanted) -> Appearance {
    let has_colour = wanted.has_colour();
    let pictures = contents.has_pictures && wanted.needs_appearance();
    let textures = Textures { colored: wanted.is_colored(contents), masked: contents.has_alpha_masks };
    Appearance {
        textures: wanted.is_textured(contents).then_some(textures),
        normals: contents.has_normals,
        materials: match (contents.has_sky, contents.has_gloss) {
            (true, _) if has_colour => MaterialsKind::UnderSky,
            (false, true) if has_colour => MaterialsKind::Glossy,
            _ => MaterialsKind::Matte,
        },
        lights: match contents.has_shadows {
            _ if !has_colour && !pictures => LightsKind::Plain,
            true => LightsKind::Shadowed { pictures },
            false if contents.has_positional_lights || pictures => LightsKind::Positional { pictures },
            false => LightsKind::Plain,
        },
        styled: contents.has_style && wanted.needs_appearance(),
    }
}

fn edge_samples(wanted: &Wanted, run: &RunOptions) -> Option<EdgeSamples> {
    let measure = match run.rival.is_some() {
        true => SampleMeasure::AtCentre,
        false if wanted.analytic => SampleMeasure::Area,
        false => SampleMeasure::Counted,
    };
    (wanted.samples() > 1).then_some(EdgeSamples { count: wanted.samples(), measure })
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
        _ if slabs::kind(camera).is_curved() => (Method::Trace, "rays are curved"),
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
        && !slabs::kind(camera).is_curved()
        && camera.optics.is_none()
        && contents.steps <= 1
        && !(contents.has_spheres || contents.has_alpha_masks || contents.has_caustics || has_shadow_rays)
        && !(contents.has_pictures && wanted.needs_appearance())
}
