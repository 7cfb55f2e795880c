//! Structs that follow from scene and plan alone, before any device is touched: the parameters of one job, and the appearance
//! of the scene.

use super::Capacities;
use super::bounces::Bounce;
use crate::arrays::MapEach;
use crate::camera::Camera;
use crate::camera::optics::{self, Branch, Law, Optics, Surface};
use crate::engine::plan::hierarchy::PackedBvh;
use crate::engine::plan::nodes::Level;
use crate::engine::plan::pages::Pages;
use crate::engine::plan::pictures::ScenePictures;
use crate::engine::plan::{Band, Plan};
use crate::geometry::mesh::Material;
use crate::geometry::texture::Texture;
use crate::geometry::time_steps::MovingMesh;
use crate::gpu::kernels::LightsKind;
use crate::gpu::layout::{self, LAW_FLAT, LAW_NORMALS, f64_pair_bits, split2, split3};
use crate::scene::Scene;
use crate::scene::light::AMBIENT;
use crate::scene::light::{Light, Source};
use crate::scene::style::{Hatching, Line, Outline, Style};
use glam::{DVec2, DVec3};
use std::borrow::Cow;

/// Index of the first and count of the rest.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Span {
    pub first: u32,
    pub count: u32,
}

/// Lights, materials and normals as `shade` reads them.
#[derive(Debug, Clone)]
pub struct Appearance {
    pub shading: layout::Shading,
    /// Plain lights: the direction of travel; else two vec4s each, see `shading/lights/positional/arriving.wgsl`, and what hides them.
    pub lights: Vec<[f32; 4]>,
    pub materials: Vec<layout::Material>,
    pub normals: Vec<[f32; 4]>,
    pub style: layout::Style,
}

impl Appearance {
    /// Positions are relative to `anchor` on the device, and images lie in `pages`.
    pub fn new(
        scene: &Scene,
        normals_of: NormalsOf,
        anchor: DVec3,
        pages: &Pages,
        shadows: Shadows,
        pictures: Option<&ScenePictures>,
    ) -> Appearance {
        let mesh = scene.mesh.base();
        let mut lights: Vec<[f32; 4]> = match shadows.kind {
            LightsKind::Plain => scene.lights.iter().map(|l| light(l, anchor)).collect(),
            _ => scene.lights.iter().flat_map(|l| [light(l, anchor), light_colour(l)]).collect(),
        };
        let own = scene.projector_lights.iter().enumerate().filter(|(_, p)| pictures.is_some() && p.is_light());
        let own: Vec<usize> = own.map(|(k, _)| k).collect();
        let light_count = scene.lights.len() + own.len();
        lights.extend(own.iter().flat_map(|k| [[f32::from_bits(*k as u32), 0.0, 0.0, -1.0], [0.0; 4]]));
        let mut firsts = [0; 3];
        if let Some(bvh) = shadows.bvh {
            for (first, items) in firsts.iter_mut().zip([&bvh.nodes, &bvh.leaves, &bvh.masks]) {
                *first = lights.len() as u32;
                lights.extend(items);
            }
        }
        let pictures_first = lights.len() as u32;
        if let Some(pictures) = pictures {
            let material = mesh.materials.len() + usize::from(scene.sky.is_some());
            lights.extend(pictures.rows(scene, anchor, pictures_first, material as u32));
        }
        Appearance {
            shading: layout::Shading {
                background: scene.background,
                ambient: if scene.sky.is_some() { 0.0 } else { AMBIENT },
                anchor: anchor.as_vec3().to_array(),
                light_count: light_count as u32,
                gain: scene.tone.gain(),
                curve: scene.tone.curve.number(),
                filter_width: 1.0,
                shadow_bvh_scale: shadows.bvh.map_or(1.0, |bvh| bvh.scale),
                sky: scene.sky.as_ref().map_or(layout::NONE, |_| mesh.materials.len() as u32),
                sky_strength: scene.sky.as_ref().map_or(0.0, |s| s.strength),
                sky_rotation: scene.sky.as_ref().map_or(0.0, |s| s.rotation as f32),
                sky_is_seen: scene.sky.as_ref().map_or(0, |s| s.is_seen.into()),
                occlusion_rays: scene.ambient_occlusion.map_or(0, |o| o.rays),
                occlusion_reach: scene.ambient_occlusion.map_or(1.0, |o| o.reach as f32),
                nodes_first: firsts[0],
                leaves_first: firsts[1],
                pictures_first,
                picture_count: pictures.map_or(0, |_| scene.projector_lights.len() as u32),
                masks_first: firsts[2],
                pad0: 0,
                irradiance: scene.sky.as_ref().map_or([[0.0; 4]; 9], |s| s.irradiance.map(|[r, g, b]| [r, g, b, 0.0])),
            },
            lights,
            materials: materials(scene).iter().enumerate().map(|(k, m)| pages.packed(k, m)).collect(),
            normals: match normals_of {
                NormalsOf::Scene => normals(scene.moving_mesh()),
                NormalsOf::Meshes => normals((&**mesh).into()),
                NormalsOf::Nothing => Vec::new(),
            },
            style: style(&scene.style),
        }
    }
}

/// The normals that [`Appearance`] holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NormalsOf {
    /// All normals of the scene, in the world.
    Scene,
    /// The normals of each mesh once, where kernels know the places of meshes.
    Meshes,
    /// No normals: they are on the device already.
    Nothing,
}

/// Facets of a surface that is shaded as smooth turn from each other by no more than this, degrees, and from their shading
/// normals by half of it.
const FACET_ANGLE: f64 = 40.0;

fn style(style: &Style) -> layout::Style {
    let none = Line { width: 0.0, colour: [0.0; 3], depth: f64::INFINITY };
    let (wire, border) = (style.wireframe.unwrap_or(none), style.borders.unwrap_or(none));
    let outline = style.outline.unwrap_or(Outline { line: none, crease: 180.0 });
    let hatching = style.hatching.unwrap_or(Hatching { spacing: 0.0, ink: [0.0; 3], paper: [0.0; 3] });
    // infinity is not to be had in every kernel
    let clamped = |depth: f64| depth.min(f64::from(f32::MAX)) as f32;
    layout::Style {
        wire: wire.colour,
        wire_width: wire.width as f32,
        ink: hatching.ink,
        hatch_spacing: hatching.spacing as f32,
        paper: hatching.paper,
        wire_depth: clamped(wire.depth),
        outline: outline.line.colour,
        outline_width: outline.line.width as f32,
        border: border.colour,
        border_width: border.width as f32,
        crease_cosine: outline.crease.to_radians().cos() as f32,
        outline_depth: clamped(outline.line.depth),
        jump_sine: (outline.crease.min(FACET_ANGLE) / 2.0).to_radians().sin() as f32,
        pad0: 0,
    }
}

/// What kernels know of lights, and the hierarchy of shadow casters.
#[derive(Debug, Clone, Copy)]
pub struct Shadows<'a> {
    pub kind: LightsKind,
    pub bvh: Option<&'a PackedBvh>,
}

impl Shadows<'_> {
    #[cfg(feature = "internals")]
    pub const NONE: Shadows<'static> = Shadows { kind: LightsKind::Plain, bvh: None };
}

/// All time steps of a normal together.
fn normals(all: MovingMesh) -> Vec<[f32; 4]> {
    let steps = |n: u32| (0..all.count()).map(move |step| all.normal(n, step).extend(0.0).to_array());
    (0..all.mesh.normals.len() as u32).flat_map(steps).collect()
}

fn light(light: &Light, anchor: DVec3) -> [f32; 4] {
    match light.source {
        Source::Distant(travel) => travel.as_vec3().extend(0.0).to_array(),
        Source::Point { position, distance } => (position - anchor).as_vec3().extend(distance as f32).to_array(),
    }
}

fn light_colour(light: &Light) -> [f32; 4] {
    let [r, g, b] = light.colour;
    [r, g, b, if light.casts_shadows { 1.0 } else { 0.0 }]
}

/// All materials, then the one whose image is the sky, and those whose images are the pictures that are thrown onto surfaces.
pub fn materials(scene: &Scene) -> Cow<'_, [Material]> {
    if scene.sky.is_none() && scene.projector_lights.is_empty() {
        return Cow::Borrowed(&scene.mesh.base().materials);
    }
    let shows = |name: &str, image: &Texture| {
        let (name, texture) = (name.into(), Some(image.clone()));
        Material { name, texture, ..Material::default() }
    };
    let sky = scene.sky.iter().map(|sky| shows("environment", &sky.image));
    let pictures = scene.projector_lights.iter().map(|p| shows("projector_light", &p.picture));
    Cow::Owned(scene.mesh.base().materials.iter().cloned().chain(sky).chain(pictures).collect())
}

/// The parameters of a job: `clusters` of the chunk whose triangles are `ids`, over `band`, for the camera's own rays.
pub fn params(
    camera: &Camera,
    plan: &Plan,
    band: &Band,
    ids: Span,
    clusters: Span,
    capacities: Capacities,
    raster_budget: f32,
) -> layout::Params {
    let level = |f: fn(&Level) -> u32| {
        let mut words = [0; 8];
        words.iter_mut().zip(&band.nodes.levels).for_each(|(w, l)| *w = f(l));
        words
    };
    layout::Params {
        width: camera.width,
        height: band.rows,
        tiles_x: band.tiles.tiles_x,
        tiles_y: band.tiles.tiles_y,
        levels: band.nodes.levels.len() as u32,
        cluster_first: clusters.first,
        cluster_count: clusters.count,
        id_bits: plan.id_bits,
        queue_capacity: capacities.queue as u32,
        work_capacity: capacities.work as u32,
        pair_capacity: capacities.pairs as u32,
        slab_rows: band.tiles.slab_rows,
        id_first: ids.first,
        id_count: ids.count,
        band_row: band.row,
        spans: plan.slabs.spans,
        recheck_capacity: capacities.recheck_items as u32,
        origin_error: (ORIGIN_UNITS * f64::EPSILON * plan.anchor.abs().element_sum()) as f32,
        task_capacity: capacities.tasks as u32,
        edge_capacity: capacities.edges as u32,
        scene_size: plan.scene_size as f32,
        raster_budget,
        steps: plan.steps,
        sample: camera.sample.map_or(0, |sample| sample.count | sample.number << 16),
        t_min: split3(camera.t_range[0]),
        t_max: split3(camera.t_range[1]),
        t_words: f64_pair_bits(camera.t_range),
        level_start: level(|l| l.start),
        level_width: level(|l| l.width),
        level_height: level(|l| l.height),
        bvh_offset: (plan.anchor - plan.origin).as_vec3().to_array(),
        surface_rows: 1,
    }
}

/// Sample offsets as kernels read them.
pub fn sample_offsets(list: &[DVec2]) -> layout::SampleOffsets {
    let mut sample_offsets = layout::SampleOffsets { at: [[0.0; 4]; 16] };
    for (packed, two) in sample_offsets.at.iter_mut().zip(list.chunks(2)) {
        packed.iter_mut().zip(two.iter().flat_map(|p| p.as_vec2().to_array())).for_each(|(to, from)| *to = from);
    }
    sample_offsets
}

/// A camera's rays are computed in f64 where the scene lies: their origins lose some roundings of its distance from the world's
/// origin, of both signs of a step along the image, and of moving them to the anchor.
const ORIGIN_UNITS: f64 = 8.0;

/// t of rays after a bounce.
const BOUNCED_T_RANGE: [f64; 2] = [0.0, f64::INFINITY];

/// The parameters for rays after a bounce. These are not perturbed: a perturbed ray may have met another surface.
pub fn after_bounce(own: layout::Params) -> layout::Params {
    let [t_min, t_max] = BOUNCED_T_RANGE.map_each(split3);
    layout::Params { t_min, t_max, t_words: f64_pair_bits(BOUNCED_T_RANGE), scene_size: 0.0, ..own }
}

/// The optics for a bounce, in the scene with their facets.
pub fn optic(scene: &Scene, camera: &Camera, optics: &Optics, plan: &Plan, bounce: &Bounce) -> layout::Optic {
    let (law, eye) = match optics.surface {
        Surface::Facets { law: Law::Flat { eye }, .. } => (LAW_FLAT, eye - plan.anchor),
        _ => (LAW_NORMALS, DVec3::ZERO),
    };
    let [eye_hi, eye_lo] = split_vector(eye);
    let [ior_hi, ior_lo] = match optics.bounce {
        optics::Bounce::Reflect => [0.0; 2],
        optics::Bounce::Refract { ior } => split2(ior),
    };
    let [from_hi, from_lo] = split_vector(optics.environment.map_or(DVec3::ZERO, |p| p - plan.anchor));
    let [[tilt_x_hi, tilt_x_lo], [tilt_y_hi, tilt_y_lo]] = bounce.tilt.to_array().map_each(split2);
    let around = optics.surface.bounds();
    let box_centre = (around.lo + around.hi) / 2.0 - plan.anchor;
    let box_half = (around.hi - around.lo) / 2.0;
    let rounding = BOX_ROUNDING * (box_centre.abs() + box_half);
    layout::Optic {
        eye_hi,
        first_id: optics.first_id(scene.mesh.triangle_count()),
        eye_lo,
        count: optics.surface_count() as u32,
        tint: optics.tint,
        bounces: bounce.count,
        base: optics.base,
        ends: (bounce.count == optics.depth && optics.atlas.is_none()) as u32,
        ior_hi,
        ior_lo,
        sees_itself: optics.sees_itself() as u32,
        piece_first: camera.first_piece(camera.layers.len()),
        tilt_x_hi,
        tilt_x_lo,
        tilt_y_hi,
        tilt_y_lo,
        fresnel: optics.fresnel as u32,
        branch: (bounce.branch == Branch::Reflected) as u32,
        scale: bounce.scale as f32,
        colour_only: !bounce.is_main as u32,
        from_hi,
        is_environment: optics.environment.is_some() as u32,
        from_lo,
        law,
        box_centre: box_centre.as_vec3().to_array(),
        scene_size: plan.scene_size as f32,
        box_half: (box_half + rounding).as_vec3().to_array(),
        pad0: 0,
    }
}

/// By which the box around the optics is enlarged, of its size and place: 2^-20. Its numbers are rounded to 2^-24, and a ray that meets the
/// surface by recheck arithmetic is beyond it by far less.
const BOX_ROUNDING: f64 = 1.0 / 1048576.0;

/// Each component as a sum of two.
pub fn split_vector(v: DVec3) -> [[f32; 3]; 2] {
    let s = v.to_array().map_each(split2);
    [s.map_each(|s| s[0]), s.map_each(|s| s[1])]
}
