//! Notes about a finished render: its files hold less than a user expects.

use crate::arrays::MapEach;
use crate::camera::Camera;
use crate::camera::volume::corners;
use crate::image::frame::{Channel, Frame, NO_ID};
use crate::reference::image::rows_of_image;
use crate::scene::Scene;
use glam::DVec3;

/// Most pixels of a picture alone that the reference is asked about, on the CPU: some seconds through the slowest lens.
const PIXELS_MAX: u64 = 1 << 20;

/// Rows that are cast first, to find at little cost that something is hit.
const FIRST_ROWS: u32 = 8;

/// Largest ratio of a scene's coordinates to its size without a note. An image has up to 2^16 pixels a side and f32 numbers have 24 bits, so that
/// neighboring pixels of the largest image, seen from side to side, still differ by a step of f32 if coordinates take 2^7 times the size at most.
const FAR: f64 = 128.0;

/// The line about a frame in which no pixel shows a surface, with the positions of scene and camera. `None` if a pixel shows a surface, the scene
/// has none, or the frame does not tell: a picture without other channels that has several colors, as a sky has, or over [`PIXELS_MAX`] pixels.
pub fn nothing_hit(scene: &Scene, camera: &Camera, frame: &Frame, srgb8: Option<&[u8]>) -> Option<String> {
    if scene.volume.is_some() || scene.mesh.triangle_count() == 0 {
        return None;
    }
    let (lo, hi) = scene.mesh.drawn_bounds()?;
    let is_empty = empty_by_channels(frame).unwrap_or_else(|| srgb8.is_some_and(|own| is_empty(scene, camera, own)));
    is_empty.then(|| {
        format!("no pixel shows a surface: the scene lies from {} to {}{}", short(lo), short(hi), place(camera, lo, hi))
    })
}

/// Reports whether no pixel shows a surface, by the first channel that tells.
fn empty_by_channels(frame: &Frame) -> Option<bool> {
    let misses = |channel: Channel, is_miss: fn(&f32) -> bool| Some(frame.f32(channel)?.iter().all(is_miss));
    let by_id = || Some(frame.u32(Channel::TriangleId)?.iter().all(|id| *id == NO_ID));
    let by_depth =
        || misses(Channel::Z, |z| *z == f32::INFINITY).or_else(|| misses(Channel::T, |t| *t == f32::INFINITY));
    by_id().or_else(|| misses(Channel::A, |a| *a == 0.0)).or_else(by_depth)
}

/// Reports whether a picture has one color and the reference finds no surface at any pixel.
fn is_empty(scene: &Scene, camera: &Camera, srgb8: &[u8]) -> bool {
    let mut pixels = srgb8.chunks_exact(4);
    let first = pixels.next();
    let is_empty = |step: u32| empty_by_channels(&rows_of_image(scene, camera, &[Channel::A], step)) == Some(true);
    let is_small = u64::from(camera.width) * u64::from(camera.height) <= PIXELS_MAX;
    is_small && pixels.all(|pixel| Some(pixel) == first) && is_empty(camera.height.div_ceil(FIRST_ROWS)) && is_empty(1)
}

/// Words for the position of the box from `lo` to `hi` relative to the ray of the middle pixel.
fn place(camera: &Camera, lo: DVec3, hi: DVec3) -> String {
    let (i, j) = camera.middle();
    let Some(ray) = camera.ray(i, j) else { return String::new() };
    let along = corners((lo, hi)).map(|p| (p - ray.origin).dot(ray.direction) / ray.direction.length_squared());
    let [start, end] = camera.t_range;
    let is_within = ray.origin.cmpge(lo).all() && ray.origin.cmple(hi).all();
    let relation = match () {
        () if is_within => "around the camera",
        () if along.iter().all(|t| *t < 0.0) => "behind the camera",
        () if along.iter().all(|t| *t < start) => "before the start of the camera's t_range",
        () if along.iter().all(|t| *t > end) => "beyond the end of the camera's t_range",
        () => "beside what the camera sees",
    };
    format!(
        ", {relation}; the ray of its middle pixel begins at {} towards {}",
        short(ray.origin),
        short(ray.direction.normalize_or_zero())
    )
}

/// The line about the channel `P` of a scene that is far from the world's origin; `None` if its f32 numbers are fine enough for it.
pub fn coarse_positions(scene: &Scene) -> Option<String> {
    let (lo, hi) = scene.mesh.drawn_bounds()?;
    let (farthest, extent) = (lo.abs().max(hi.abs()).max_element(), (hi - lo).max_element());
    // between two powers of two, f32 numbers have the step of the lower one
    let step = farthest.log2().floor().exp2() * f64::from(f32::EPSILON);
    (farthest > FAR * extent).then(|| {
        format!(
            "P has steps of {step:.1e}, as f32 numbers have at {farthest:.1e} from the origin, and the scene is {extent:.1e} wide; \
             use --points OUT.npy, which has f64, or move the scene to the origin"
        )
    })
}

/// The line about blended surfaces in a picture of one sample, which shows them as opaque or not at all.
pub fn unblended(scene: &Scene, samples: u32) -> Option<String> {
    let line = "blend = true needs samples: one sample shows surfaces that are at least half opaque; add --samples 64";
    (samples == 1 && scene.mesh.base().is_blended()).then(|| line.into())
}

/// A point to a thousandth.
fn short(p: DVec3) -> String {
    let [x, y, z] = p.to_array().map_each(|x| (x * 1e3).round() / 1e3 + 0.0);
    format!("({x}, {y}, {z})")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::Loading;

    /// A scene of this text, and the line about its frame by the reference, of these channels.
    fn line(text: &str, channels: &[Channel], srgb8: Option<&[u8]>) -> Option<String> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("s.toml");
        std::fs::write(&path, text).unwrap();
        let scene = Scene::load(&path, &[], 0.0, &Loading::default()).unwrap();
        let camera = scene.camera().unwrap();
        let frame = rows_of_image(&scene, &camera, channels, 1);
        nothing_hit(&scene, &camera, &frame, srgb8)
    }

    fn looking(eye: &str, target: &str, more: &str) -> String {
        format!(
            "[image]\nwidth = 4\nheight = 4\n[[mesh]]\nbuiltin = \"box\"\n[camera]\nkind = \"pinhole\"\neye = {eye}\ntarget = {target}\nvfov = 10\n{more}"
        )
    }

    #[test]
    fn a_frame_without_hits_says_where_the_scene_is() {
        let all = [Channel::R, Channel::G, Channel::B];
        let (grey, mixed) = ([9; 64], [[9; 32], [8; 32]].concat());
        for (eye, target, more, relation) in [
            (
                "[0, 0, 5]",
                "[0, 0, 6]",
                "",
                "behind the camera; the ray of its middle pixel begins at (0, 0, 5) towards (",
            ),
            ("[0, 0, 5]", "[0, 4, 0]", "", "beside what the camera sees"),
            ("[0, 0, 5]", "[0, 0, 0]", "t_range = [0, 1]", "beyond the end of the camera's t_range"),
            ("[0, 0, 5]", "[0, 0, 0]", "t_range = [50, 60]", "before the start of the camera's t_range"),
            ("[0, 0, 0]", "[0, 0, -1]", "t_range = [0, 1e-3]", "around the camera"),
        ] {
            let text = looking(eye, target, more);
            let said = [
                line(&text, &[Channel::A], None),
                line(&text, &[Channel::Z], None),
                line(&text, &[Channel::T], None),
                line(&text, &[Channel::TriangleId], None),
                line(&text, &all, Some(&grey)),
            ];
            for said in said {
                let said = said.unwrap();
                assert!(
                    said.starts_with("no pixel shows a surface: the scene lies from (-") && said.contains(relation),
                    "{said}"
                );
            }
            // a sky, for example
            assert_eq!(line(&text, &all, Some(&mixed)), None);
        }
        let seen = looking("[0, 0, 5]", "[0, 0, 0]", "");
        assert_eq!([line(&seen, &[Channel::A], None), line(&seen, &all, Some(&grey))], [None, None]);
        let unseen = looking("[0, 0, 5]", "[0, 0, 6]", "").replace("[[mesh]]\nbuiltin = \"box\"\n", "");
        assert_eq!(line(&unseen, &[Channel::A], None), None);
    }

    #[test]
    fn positions_are_coarse_far_from_the_origin() {
        let at = |x: f64| {
            let text = format!(
                "{}\n",
                looking("[0, 0, 5]", "[0, 0, 0]", "").replace("\"box\"", &format!("\"box\"\ntranslate = [{x}, 0, 0]"))
            );
            let folder = tempfile::tempdir().unwrap();
            let path = folder.path().join("s.toml");
            std::fs::write(&path, text).unwrap();
            coarse_positions(&Scene::load(&path, &[], 0.0, &Loading::default()).unwrap())
        };
        assert_eq!(at(0.0), None);
        // 2^22 is below, where f32 numbers have a step of a half
        assert!(at(6e6).unwrap().starts_with("P has steps of 5.0e-1, as f32"), "{:?}", at(6e6));
    }
}
