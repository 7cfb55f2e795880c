//! Whole frames by the reference, and judgement of other frames by it.

use super::{Hit, Reference, Verdict};
use crate::camera::{Bundle, Camera};
use crate::frame::{Channel, Frame, NO_ID, Plane};
use crate::scene::Scene;
use crate::scene::mesh::NO_NORMAL;
use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// How a frame stands against the reference.
#[derive(Debug, Clone)]
pub struct Judgement {
    /// The reference's own frame, all channels.
    pub truth: Frame,
    /// Pixels whose answer holds within 1/16 px of their centres.
    pub safe: Vec<bool>,
    /// Scene extent over |D|: what an error of t is at least measured against.
    pub scales: Vec<f32>,
    /// Pixels whose id is neither the reference's nor a near candidate.
    pub not_near: u64,
}

/// Share of the light that comes from everywhere.
const AMBIENT: f64 = crate::stage::AMBIENT as f64;

/// One pixel's values, in the order of [`Channel::ALL`]; ids as numbers of their own.
struct Pixel {
    colour: [f32; 3],
    hit: Option<(Hit, u32)>,
    z: f32,
}

/// The asked-for channels of the reference's frame.
pub fn image(scene: &Scene, camera: &Camera, channels: &[Channel]) -> Frame {
    let reference = Reference::build(&scene.mesh);
    let pixels = each_pixel(camera, |i, j| {
        let ray = camera.pixel(0, i, j);
        pixel(scene, ray.and_then(|(piece, b)| Some((b, reference.hit(&b, camera.t_range)?, piece))))
    });
    frame(camera, &pixels, channels)
}

/// Holds `frame`'s triangle ids against the reference.
pub fn judge(scene: &Scene, camera: &Camera, frame_seen: &Frame) -> Judgement {
    let reference = Reference::build(&scene.mesh);
    let extent = scene.bounds().map_or(0.0, |(lo, hi)| (hi - lo).length());
    let ids = frame_seen.u32(Channel::TriangleId);
    let judged = each_pixel(camera, |i, j| {
        let (verdict, owner) = verdict(&reference, camera, i, j);
        let at = j as usize * camera.width as usize + i as usize;
        let near = ids.is_none_or(|ids| names_near(&verdict, ids[at]));
        let scale = owner.map_or(0.0, |(_, b)| extent / b.ray(0.0, 0.0).direction.length());
        let seen = owner.and_then(|(piece, b)| Some((b, verdict.hit?, piece)));
        (pixel(scene, seen), verdict.safe, scale as f32, near)
    });
    let pixels: Vec<&Pixel> = judged.iter().map(|j| &j.0).collect();
    Judgement {
        truth: frame(camera, &pixels, &Channel::ALL),
        safe: judged.iter().map(|j| j.1).collect(),
        scales: judged.iter().map(|j| j.2).collect(),
        not_near: judged.iter().filter(|j| !j.3).count() as u64,
    }
}

/// Text for a person about one pixel: its ray, the visible hit, and what else the answer may be.
pub fn explain(scene: &Scene, camera: &Camera, i: u32, j: u32) -> String {
    use std::fmt::Write;
    let reference = Reference::build(&scene.mesh);
    let (verdict, owner) = verdict(&reference, camera, i, j);
    let mut text = format!("pixel {i},{j}\n");
    // writing to a String cannot fail
    let _ = match owner {
        None => writeln!(text, "ray: none"),
        Some((piece, b)) => {
            let ray = b.ray(0.0, 0.0);
            writeln!(text, "piece: {piece}\nP: {}\nD: {}", ray.origin, ray.direction)
        }
    };
    let _ = match verdict.hit {
        None => writeln!(text, "hit: none"),
        Some(h) => writeln!(text, "hit: triangle {}, t {}, bary {} {}", h.triangle, h.t, h.bary[0], h.bary[1]),
    };
    let miss = if verdict.may_miss { " or none" } else { "" };
    let _ = writeln!(text, "within 1/16 px: triangles {:?}{miss}", verdict.candidates);
    let _ = write!(text, "safe: {}", verdict.safe);
    text
}

/// What pixel `(i, j)` shows and how sure that is, with the piece that owns it and its bundle.
fn verdict(reference: &Reference, camera: &Camera, i: u32, j: u32) -> (Verdict, Option<(u32, Bundle)>) {
    let owner = camera.pixel(0, i, j);
    let (bundles, outside) = camera.near(0, i, j);
    let mut verdict = reference.verdict(&bundles, camera.t_range);
    if owner.is_none() {
        verdict.hit = None;
        verdict.safe = verdict.safe && verdict.candidates.is_empty();
        verdict.may_miss = true;
    } else if outside {
        verdict.safe = verdict.safe && verdict.candidates.is_empty();
        verdict.may_miss = true;
    }
    (verdict, owner)
}

/// An id that the verdict allows: the reference's own or a near candidate's.
fn names_near(verdict: &Verdict, id: u32) -> bool {
    let own = verdict.hit.map_or(NO_ID, |h| h.triangle);
    id == own || (!verdict.safe && if id == NO_ID { verdict.may_miss } else { verdict.candidates.contains(&id) })
}

fn each_pixel<T: Send>(camera: &Camera, f: impl Fn(u32, u32) -> T + Sync) -> Vec<T> {
    let w = camera.width as usize;
    (0..w * camera.height as usize).into_par_iter().map(|k| f((k % w) as u32, (k / w) as u32)).collect()
}

fn pixel(scene: &Scene, seen: Option<(Bundle, Hit, u32)>) -> Pixel {
    let Some((bundle, hit, piece)) = seen else {
        return Pixel { colour: scene.background, hit: None, z: f32::INFINITY };
    };
    let direction = bundle.ray(0.0, 0.0).direction;
    let z = (hit.t * direction.length()) as f32;
    Pixel { colour: light(scene, &hit, direction.normalize()), hit: Some((hit, piece)), z }
}

/// Lambert from every light, or one headlight along the ray, and a small ambient term.
fn light(scene: &Scene, hit: &Hit, view: DVec3) -> [f32; 3] {
    let mesh = &scene.mesh;
    let id = hit.triangle as usize;
    let v = mesh.triangles[id].map(|k| mesh.positions[k as usize]);
    let flat = (v[1] - v[0]).cross(v[2] - v[0]).normalize_or_zero();
    let seen = if flat.dot(view) > 0.0 { -flat } else { flat };
    let weights = [1.0 - hit.bary[0] - hit.bary[1], hit.bary[0], hit.bary[1]];
    let stored = mesh.corner_normals.get(id).filter(|c| !c.contains(&NO_NORMAL));
    let smooth = stored.map(|c| {
        let n: [Vec3; 3] = c.map(|k| mesh.normals[k as usize]);
        (0..3).map(|k| weights[k] * n[k].as_dvec3()).sum::<DVec3>()
    });
    let mut n = smooth.and_then(DVec3::try_normalize).unwrap_or(seen);
    if n.dot(seen) < 0.0 {
        n = -n;
    }
    let lambert = |travel: DVec3| (-n.dot(travel)).max(0.0);
    let direct: f64 =
        if scene.lights.is_empty() { lambert(view) } else { scene.lights.iter().map(|l| lambert(*l)).sum() };
    let received = AMBIENT + (1.0 - AMBIENT) * direct;
    let diffuse = mesh.materials[mesh.material_of[id] as usize].diffuse;
    diffuse.map(|c| (c as f64 * received) as f32)
}

fn frame<P: std::borrow::Borrow<Pixel> + Sync>(camera: &Camera, pixels: &[P], channels: &[Channel]) -> Frame {
    let f32s = |f: fn(&Pixel) -> f32| Plane::F32(pixels.iter().map(|p| f(p.borrow())).collect());
    let u32s = |f: fn(&Pixel) -> u32| Plane::U32(pixels.iter().map(|p| f(p.borrow())).collect());
    let plane = |channel: Channel| match channel {
        Channel::R => f32s(|p| p.colour[0]),
        Channel::G => f32s(|p| p.colour[1]),
        Channel::B => f32s(|p| p.colour[2]),
        Channel::A => f32s(|p| p.hit.is_some() as u32 as f32),
        Channel::Z => f32s(|p| p.z),
        Channel::T => f32s(|p| p.hit.map_or(f32::INFINITY, |h| h.0.t as f32)),
        Channel::TriangleId => u32s(|p| p.hit.map_or(NO_ID, |h| h.0.triangle)),
        Channel::PieceId => u32s(|p| p.hit.map_or(NO_ID, |h| h.1)),
        Channel::BaryU => f32s(|p| p.hit.map_or(0.0, |h| h.0.bary[0] as f32)),
        Channel::BaryV => f32s(|p| p.hit.map_or(0.0, |h| h.0.bary[1] as f32)),
    };
    let mut channels = channels.to_vec();
    channels.sort_unstable();
    channels.dedup();
    Frame { width: camera.width, height: camera.height, planes: channels.into_iter().map(|c| (c, plane(c))).collect() }
}
