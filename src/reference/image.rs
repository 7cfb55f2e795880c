//! Whole frames by the reference, and judgement of other frames by it.

pub use super::explain::explain;
use super::light::light;
use super::{Finding, Path, Reference, Seen};
use crate::camera::Camera;
use crate::frame::{Channel, Frame, NO_ID, Plane};
use crate::scene::Scene;
use rayon::prelude::*;

/// How a frame stands against the reference.
#[derive(Debug, Clone)]
pub struct Judgement {
    /// The reference's own frame, all channels.
    pub truth: Frame,
    /// Pixels whose answer holds within 1/16 px of their centres.
    pub safe: Vec<bool>,
    /// Scene extent over |D|, of a curve |X'| at the hit: what an error of t is at least measured against.
    pub scales: Vec<f32>,
    /// Pixels whose id is neither the reference's nor a near candidate.
    pub not_near: u64,
}

/// One pixel's values, in the order of [`Channel::ALL`]; ids as numbers of their own.
struct Pixel {
    colour: [f32; 3],
    seen: Option<Seen>,
    z: f32,
}

/// The asked-for channels of the reference's frame.
pub fn image(scene: &Scene, camera: &Camera, channels: &[Channel]) -> Frame {
    let reference = Reference::build(&scene.mesh);
    let pixels = each_pixel(camera, |i, j| {
        let path = Path::of_pixel(camera, i, j);
        pixel(scene, &path, reference.first(&path))
    });
    frame(camera, &pixels, channels)
}

/// Holds `frame`'s triangle ids against the reference.
pub fn judge(scene: &Scene, camera: &Camera, frame_seen: &Frame) -> Judgement {
    let reference = Reference::build(&scene.mesh);
    let extent = scene.bounds().map_or(0.0, |(lo, hi)| (hi - lo).length());
    let ids = frame_seen.u32(Channel::TriangleId);
    let judged = each_pixel(camera, |i, j| {
        let path = Path::of_pixel(camera, i, j);
        let finding = reference.finding(camera, &path, (i, j));
        let at = j as usize * camera.width as usize + i as usize;
        let near = ids.is_none_or(|ids| names_near(&finding, ids[at]));
        let speed = path.speed(finding.seen.as_ref());
        (pixel(scene, &path, finding.seen), finding.safe, (extent / speed) as f32, near)
    });
    let pixels: Vec<&Pixel> = judged.iter().map(|j| &j.0).collect();
    Judgement {
        truth: frame(camera, &pixels, &Channel::ALL),
        safe: judged.iter().map(|j| j.1).collect(),
        scales: judged.iter().map(|j| j.2).collect(),
        not_near: judged.iter().filter(|j| !j.3).count() as u64,
    }
}

/// An id that the finding allows: the reference's own or a near candidate's.
fn names_near(finding: &Finding, id: u32) -> bool {
    let own = finding.seen.map_or(NO_ID, |s| s.hit.triangle);
    id == own || (!finding.safe && if id == NO_ID { finding.may_miss } else { finding.candidates.contains(&id) })
}

fn each_pixel<T: Send>(camera: &Camera, f: impl Fn(u32, u32) -> T + Sync) -> Vec<T> {
    let w = camera.width as usize;
    (0..w * camera.height as usize).into_par_iter().map(|k| f((k % w) as u32, (k / w) as u32)).collect()
}

fn pixel(scene: &Scene, path: &Path, seen: Option<Seen>) -> Pixel {
    let Some(seen) = seen else { return Pixel { colour: scene.background, seen: None, z: f32::INFINITY } };
    let view = path.of(&seen).view(seen.hit.t);
    Pixel { colour: light(scene, &seen.hit, view), seen: Some(seen), z: path.depth(&seen) as f32 }
}

fn frame<P: std::borrow::Borrow<Pixel> + Sync>(camera: &Camera, pixels: &[P], channels: &[Channel]) -> Frame {
    let f32s = |f: fn(&Pixel) -> f32| Plane::F32(pixels.iter().map(|p| f(p.borrow())).collect());
    let u32s = |f: fn(&Pixel) -> u32| Plane::U32(pixels.iter().map(|p| f(p.borrow())).collect());
    let plane = |channel: Channel| match channel {
        Channel::R => f32s(|p| p.colour[0]),
        Channel::G => f32s(|p| p.colour[1]),
        Channel::B => f32s(|p| p.colour[2]),
        Channel::A => f32s(|p| p.seen.is_some() as u32 as f32),
        Channel::Z => f32s(|p| p.z),
        Channel::T => f32s(|p| p.seen.map_or(f32::INFINITY, |s| s.t() as f32)),
        Channel::TriangleId => u32s(|p| p.seen.map_or(NO_ID, |s| s.hit.triangle)),
        Channel::PieceId => u32s(|p| p.seen.map_or(NO_ID, |s| s.piece)),
        Channel::BaryU => f32s(|p| p.seen.map_or(0.0, |s| s.hit.bary[0] as f32)),
        Channel::BaryV => f32s(|p| p.seen.map_or(0.0, |s| s.hit.bary[1] as f32)),
    };
    let mut channels = channels.to_vec();
    channels.sort_unstable();
    channels.dedup();
    Frame { width: camera.width, height: camera.height, planes: channels.into_iter().map(|c| (c, plane(c))).collect() }
}
