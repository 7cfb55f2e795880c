//! Whole frames by the reference, and comparison of other frames with it.

use super::caustics::{caustics, shown_by};
use super::composed::Composed;
#[cfg(any(feature = "cli", feature = "view"))]
pub use super::explain::explain;
use super::lens::own;
use super::light::{Obstacles, light, normal, painted_albedo};
use super::volume::{Medium, Passed};
use super::{Finding, Outcome, Path, Reference};
use crate::arrays::MapEach;
use crate::camera::Camera;
use crate::image::frame::{Channel, Frame, NO_ID, PixelValues, normalised_depth, plane_of_words};
use crate::parallel;
use crate::parallel::share::Share;
use crate::scene::Scene;
use crate::scene::caustics::CausticMaps;
use crate::scene::labels::Labels;
use glam::DVec3;
use std::borrow::Borrow;

/// The comparison of a frame with the reference.
#[derive(Debug, Clone)]
pub struct Judgement {
    /// The reference's own frame, all channels.
    pub truth: Frame,
    /// Safe pixels: their answer is the same within 1/16 px of their centres.
    pub safe: Vec<bool>,
    /// Per pixel: scene extent over |D| (for curves |X'| at the hit), the least scale for relative errors of t.
    pub scales: Vec<f32>,
    /// Pixels whose id is neither the reference's nor a near candidate.
    pub not_near: u64,
    /// Which pixels show the reference's triangle or a near candidate.
    #[cfg(feature = "internals")]
    pub near: Vec<bool>,
}

/// The asked-for channels of the reference's frame.
pub fn image(scene: &Scene, camera: &Camera, channels: &[Channel]) -> Frame {
    rows_of_image(scene, camera, channels, 1)
}

/// The same of each `step`-th row alone, the first one first.
pub fn rows_of_image(scene: &Scene, camera: &Camera, channels: &[Channel], step: u32) -> Frame {
    let has_colour = channels.iter().any(|c| matches!(c, Channel::R | Channel::G | Channel::B));
    let maps = if has_colour { caustics(scene) } else { None };
    rows_with_caustics(scene, camera, channels, maps.as_ref(), (step, &Share::default()))
}

/// Each `step`-th row of a frame with given caustics.
pub fn rows_with_caustics(
    scene: &Scene,
    camera: &Camera,
    channels: &[Channel],
    maps: Option<&CausticMaps>,
    (step, share): (u32, &Share),
) -> Frame {
    let rows = camera.height.div_ceil(step);
    let row = share.part_of(rows as usize);
    // the pixels of a row are done nearly at the same time
    let told = |i: u32, values: PixelValues| {
        if i + 1 == camera.width {
            row.add();
        }
        values
    };
    if let Some(composition) = camera.layered() {
        let scenes = scene.of_each_camera(composition);
        let composed = Composed::new(scene, composition, &scenes, maps);
        return frame(camera, &each_pixel(camera, step, |i, j| told(i, composed.values(i, j))), channels);
    }
    let camera = &*own(camera);
    let scene = &*scene.with_optics(camera);
    let casters = scene.of_casters();
    let view = CameraView::new(scene, camera, &casters, maps);
    frame(camera, &each_pixel(camera, step, |i, j| told(i, view.values(i, j))), channels)
}

/// Compares `frame`'s triangle ids with the reference.
pub fn judge(scene: &Scene, camera: &Camera, frame_seen: &Frame) -> Judgement {
    judge_rows(scene, camera, frame_seen, 1)
}

/// The same in each `step`-th row alone: what comes has these rows only.
pub fn judge_rows(scene: &Scene, camera: &Camera, frame_seen: &Frame, step: u32) -> Judgement {
    let ids = frame_seen.u32(Channel::TriangleId);
    let id = |i: u32, j: u32| ids.map(|ids| ids[j as usize * camera.width as usize + i as usize]);
    let maps = caustics(scene);
    let judged = if let Some(composition) = camera.layered() {
        let scenes = scene.of_each_camera(composition);
        let composed = Composed::new(scene, composition, &scenes, maps.as_ref());
        each_pixel(camera, step, |i, j| composed.judged((i, j), id(i, j)))
    } else {
        let camera = &*own(camera);
        let scene = &*scene.with_optics(camera);
        let casters = scene.of_casters();
        let view = CameraView::new(scene, camera, &casters, maps.as_ref());
        each_pixel(camera, step, |i, j| {
            let judged = view.judged(i, j);
            let is_near = id(i, j).is_none_or(|id| names_near(&judged.finding, id));
            (judged.values, judged.finding.safe, judged.scale, is_near)
        })
    };
    let pixels: Vec<&PixelValues> = judged.iter().map(|j| &j.0).collect();
    Judgement {
        truth: frame(camera, &pixels, &Channel::ALL),
        safe: judged.iter().map(|j| j.1).collect(),
        scales: judged.iter().map(|j| j.2).collect(),
        not_near: judged.iter().filter(|j| !j.3).count() as u64,
        #[cfg(feature = "internals")]
        near: judged.iter().map(|j| j.3).collect(),
    }
}

/// A camera that looks at a scene.
pub(super) struct CameraView<'a> {
    scene: &'a Scene,
    camera: &'a Camera,
    reference: Reference<'a>,
    /// Of what casts shadows, if that is not what is seen.
    casters: Option<Reference<'a>>,
    labels: Labels,
    medium: Option<Medium<'a>>,
    maps: Option<&'a CausticMaps>,
    extent: f64,
}

/// A pixel's values and how sure they are.
pub(super) struct Judged {
    pub values: PixelValues,
    pub finding: Finding,
    /// As in [`Judgement::scales`].
    pub scale: f32,
}

impl<'a> CameraView<'a> {
    /// The scene has the camera's optics; `casters` is [`Scene::of_casters`].
    pub fn new(
        scene: &'a Scene,
        camera: &'a Camera,
        casters: &'a Scene,
        maps: Option<&'a CausticMaps>,
    ) -> CameraView<'a> {
        CameraView {
            scene,
            camera,
            reference: Reference::of_scene(scene),
            casters: scene.casters.is_some().then(|| Reference::of_scene(casters)),
            labels: Labels::of(scene),
            medium: Medium::of(scene),
            maps,
            extent: scene.bounds().map_or(0.0, |(lo, hi)| (hi - lo).length()),
        }
    }

    pub fn values(&self, i: u32, j: u32) -> PixelValues {
        let path = Path::of_pixel(self.camera, i, j);
        let reference = self.reference.at_pixel(self.scene, self.camera, (i, j));
        let shown = reference.shown(self.camera, path);
        self.shown(&reference, &shown, (i, j))
    }

    pub fn judged(&self, i: u32, j: u32) -> Judged {
        let path = Path::of_pixel(self.camera, i, j);
        let reference = self.reference.at_pixel(self.scene, self.camera, (i, j));
        let finding = reference.finding(self.camera, &path, (i, j));
        let shown = reference.shown_by(self.camera, &finding, path);
        let scale = (self.extent / shown.path.speed(shown.seen.as_ref())) as f32;
        Judged { values: self.shown(&reference, &shown, (i, j)), finding, scale }
    }

    fn shown(&self, reference: &Reference, shown: &Outcome, pixel_at: (u32, u32)) -> PixelValues {
        let others = self.casters.as_ref().map(|casters| casters.at_pixel(self.scene, self.camera, pixel_at));
        let casters = others.as_ref().unwrap_or(reference);
        let values = pixel((self.scene, self.camera), (reference, casters), shown, pixel_at, self.maps);
        self.labels.labelled(through(self.medium.as_ref(), shown, values))
    }
}

/// An id that the finding allows: the reference's own or a near candidate's.
pub(super) fn names_near(finding: &Finding, id: u32) -> bool {
    let own = finding.seen.map_or(NO_ID, |s| s.hit.triangle);
    id == own || (!finding.safe && if id == NO_ID { finding.may_miss } else { finding.candidates.contains(&id) })
}

fn each_pixel<T: Send>(camera: &Camera, step: u32, f: impl Fn(u32, u32) -> T + Sync) -> Vec<T> {
    let (w, step) = (camera.width as usize, step as usize);
    let rows = (camera.height as usize).div_ceil(step);
    parallel::map(0..w * rows, |k| f((k % w) as u32, (k / w * step) as u32))
}

fn pixel(
    (scene, camera): (&Scene, &Camera),
    (reference, casters): (&Reference, &Reference),
    shown: &Outcome,
    (i, j): (u32, u32),
    maps: Option<&CausticMaps>,
) -> PixelValues {
    let behind = camera.first_piece(camera.layers.len());
    let mirror = shown.first.unwrap_or(NO_ID);
    let piece_of = |first: u32| camera.optics.as_ref().map_or(first, |o| o.piece_of(first));
    let piece =
        |of_ray: u32| shown.first.map_or_else(|| camera.piece_number(of_ray, (i, j)), |first| behind + piece_of(first));
    let colour = match &camera.optics {
        Some(optics) if shown.first.is_some() && (optics.fresnel || optics.rays > 1) => {
            let path = Path::of_pixel(camera, i, j);
            let add = |sum: [f64; 3], c: [f64; 3]| [0, 1, 2].map_each(|k| sum[k] + c[k]);
            reference.shares(optics, &path).iter().map(|o| colour(scene, camera, casters, o)).fold([0.0; 3], add)
        }
        _ => colour(scene, camera, casters, shown),
    };
    // of split rays those that say what is seen show caustics
    let split = camera.optics.as_ref().filter(|_| shown.first.is_some()).map_or(1.0, |o| o.tilts().len() as f64);
    let kept = light_left(camera, shown).map_each(|k| k / split);
    let more = maps.filter(|_| shown.seen.is_some()).map_or([0.0; 3], |maps| shown_by(scene, camera, shown, maps));
    let colour = [0, 1, 2].map_each(|k| colour[k] + kept[k] * f64::from(more[k]));
    let has_bounced = shown.first.is_some();
    let coverage = f64::from(u8::from(shown.seen.is_some() || has_bounced));
    let Some(seen) = shown.seen else {
        let piece = if has_bounced { piece(NO_ID) } else { NO_ID };
        return PixelValues { colour, coverage, piece, mirror, ..PixelValues::MISS };
    };
    let (segment, id) = (shown.path.of(&seen), seen.hit.triangle);
    let z = shown.path.depth(&seen);
    let is_triangle = (id as usize) < scene.mesh.triangle_count();
    let ends_on = camera.optics.as_ref().filter(|o| id >= o.first_id(scene.mesh.triangle_count()));
    let uv = ends_on
        .map_or_else(|| scene.mesh.base().uv_at(scene.mesh.base_id(id), seen.hit.bary), |_| None)
        .unwrap_or_default();
    let obstacles = obstacles(scene, camera, casters);
    let place = (segment.point(seen.hit.t), segment.view(seen.hit.t));
    PixelValues {
        colour,
        coverage,
        z,
        view: -segment.view(seen.hit.t),
        depth: scene.depth_range.map_or([1.0; 2], |range| normalised_depth(z, range)),
        // t of a bounced path is that of its last ray
        t: if shown.bounces > 0 { seen.hit.t } else { seen.t() },
        bary: seen.hit.bary,
        triangle: id,
        piece: piece(seen.piece),
        mirror,
        normal: if is_triangle {
            normal(reference, &seen.hit, (segment.point(seen.hit.t), segment.view(seen.hit.t)))
        } else {
            DVec3::ZERO
        },
        position: segment.point(seen.hit.t),
        albedo: ends_on.map_or_else(|| painted_albedo(&obstacles, &seen.hit, place), |optics| optics.base),
        uv: uv.to_array(),
        // labels follow from the triangle; the reference has margins instead of certified pixels
        ..PixelValues::MISS
    }
}

/// All triangles but those of the camera's own mirror or lens.
fn obstacles<'a>(scene: &Scene, camera: &Camera, reference: &'a Reference<'a>) -> Obstacles<'a> {
    let all = scene.mesh.triangle_count() as u32;
    Obstacles { all: reference, count: camera.optics.as_ref().map_or(all, |o| o.first_id(scene.mesh.triangle_count())) }
}

/// What is seen of a pixel through the scene's volume.
fn through(medium: Option<&Medium>, shown: &Outcome, values: PixelValues) -> PixelValues {
    let passed = medium.map_or(Passed::UNCHANGED, |medium| medium.along(&shown.path, shown.seen.as_ref()));
    let coverage = 1.0 - passed.left * (1.0 - values.coverage);
    PixelValues { colour: passed.over(values.colour), coverage, ..values }
}

/// The contribution of an outcome to its pixel.
fn colour(scene: &Scene, camera: &Camera, casters: &Reference, outcome: &Outcome) -> [f64; 3] {
    let optics = camera.optics.as_ref();
    let obstacles = obstacles(scene, camera, casters);
    let own = match outcome.seen {
        None => beyond(scene, &outcome.path),
        Some(seen) => match optics.filter(|o| seen.hit.triangle >= o.first_id(scene.mesh.triangle_count())) {
            Some(optics) => optics.base,
            None => {
                let (segment, t) = (outcome.path.of(&seen), seen.hit.t);
                light(scene, &obstacles, &seen.hit, (segment.point(t), segment.view(t)))
            }
        },
    };
    let left = light_left(camera, outcome);
    [0, 1, 2].map_each(|k| left[k] * f64::from(own[k]))
}

/// The colour of a path that hits nothing: background, or sky in its last direction.
fn beyond(scene: &Scene, path: &Path) -> [f32; 3] {
    let last = path.segments.iter().rev().flatten().next();
    match (&scene.sky, last) {
        (Some(sky), Some((_, segment))) if sky.is_seen => sky.radiance(segment.view(1.0)).as_vec3().to_array(),
        _ => scene.background,
    }
}

/// The share of the light that the tints of all bounces leave.
fn light_left(camera: &Camera, outcome: &Outcome) -> [f64; 3] {
    let tint = |k: usize| camera.optics.as_ref().map_or(1.0, |o| f64::from(o.tint[k]).powi(outcome.bounces as i32));
    [0, 1, 2].map_each(|k| outcome.light * tint(k))
}

/// Of whole rows.
fn frame<P: Borrow<PixelValues>>(camera: &Camera, pixels: &[P], channels: &[Channel]) -> Frame {
    let plane = |channel: Channel| plane_of_words(channel, pixels.iter().map(|p| p.borrow().word(channel)).collect());
    let channels = Channel::in_order(channels.iter().copied());
    let height = pixels.len() as u32 / camera.width;
    Frame { width: camera.width, height, planes: channels.into_iter().map(|c| (c, plane(c))).collect() }
}
