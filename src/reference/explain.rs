//! One pixel as text.

use super::bounces::Outcome;
use super::composed::Composed;
use super::lens::own_for_few;
use super::path::{Path, Segment};
use super::{Finding, Reference, Seen};
use crate::camera::Camera;
use crate::camera::composition::Composition;
use crate::geometry::mesh::Mesh;
use crate::scene::Scene;
use glam::DVec3;
use std::fmt::Write;

/// A pixel, explained.
#[derive(Debug, Clone, PartialEq)]
pub struct Explained {
    /// For the user: its ray or segments, layer by layer, the visible hit, and the other candidates.
    pub text: String,
    /// The visible triangle.
    pub triangle: Option<u32>,
    /// Where it is hit, world units.
    pub point: Option<DVec3>,
}

/// Explains pixel `(i, j)` in f64.
pub fn explain(scene: &Scene, camera: &Camera, i: u32, j: u32) -> Explained {
    if let Some(composition) = camera.layered() {
        return explain_each(scene, composition, (i, j));
    }
    let (scene, camera) = (&*scene.with_optics(camera), &*own_for_few(camera));
    let path = Path::of_pixel(camera, i, j);
    let reference = Reference::of_scene(scene).at_pixel(scene, camera, (i, j));
    let finding = reference.finding(camera, &path, (i, j));
    let shown = reference.shown_by(camera, &finding, path);
    let mut text = format!("pixel {i},{j}\n");
    // writing to a String cannot fail
    let _ = write_path(&mut text, &shown)
        .and_then(|()| write_finding(&mut text, (scene.mesh.base(), camera), &shown, &finding));
    let segment = |seen: &Seen| shown.path.segments.get(seen.layer).copied().flatten();
    let point = shown.seen.and_then(|seen| Some(segment(&seen)?.1.point(seen.hit.t)));
    Explained { text, triangle: shown.seen.map(|seen| seen.hit.triangle), point }
}

/// What each camera of a composite sees, and which one is seen.
fn explain_each(scene: &Scene, composition: &Composition, (i, j): (u32, u32)) -> Explained {
    let scenes = scene.of_each_camera(composition);
    let held = composition.held(i, j);
    let mut text = format!("pixel {i},{j}\n");
    let mut each = Vec::new();
    for (k, (own, member)) in scenes.iter().zip(&composition.members).enumerate() {
        let explained = explain(own, &member.camera, i, j);
        let rest = explained.text.split_once('\n').map_or("", |(_, rest)| rest);
        let place = if held.held[k] { "" } else { ", outside of its region" };
        // writing to a String cannot fail
        let _ = writeln!(text, "camera: {k}{place}\n{}", rest.trim_end());
        each.push(explained);
    }
    let shown = Composed::new(scene, composition, &scenes, None).owner_of(i, j);
    let number = shown.map_or("none".into(), |k| k.to_string());
    let _ = writeln!(text, "shown: {number}");
    let own = shown.map(|k| each.swap_remove(k));
    Explained { text, triangle: own.as_ref().and_then(|e| e.triangle), point: own.and_then(|e| e.point) }
}

/// Behind a mirror or lens each bounced ray is one more segment.
fn write_path(text: &mut String, shown: &Outcome) -> std::fmt::Result {
    let path = &shown.path;
    if let Some(first) = shown.first {
        writeln!(text, "bounces: {}, the first at triangle {first}", shown.bounces)?;
    }
    for (layer, segment) in path.segments.iter().enumerate() {
        if path.segments.len() > 1 {
            writeln!(text, "layer: {layer}")?;
        }
        match segment {
            None => writeln!(text, "ray: none")?,
            Some((piece, Segment::Straight(b))) => {
                let ray = b.ray(0.0, 0.0);
                writeln!(text, "piece: {piece}\nP: {}\nD: {}", ray.origin, ray.direction)?;
            }
            Some((piece, Segment::Curved(curve))) => {
                let points: Vec<String> = curve.points().iter().map(ToString::to_string).collect();
                writeln!(text, "piece: {piece}\ncontrol points: {}", points.join(" "))?;
            }
        }
    }
    Ok(())
}

fn write_finding(
    text: &mut String,
    (mesh, camera): (&Mesh, &Camera),
    Outcome { path, seen, .. }: &Outcome,
    finding: &Finding,
) -> std::fmt::Result {
    match seen {
        None => writeln!(text, "hit: none")?,
        Some(seen) => {
            let (h, [u, v]) = (seen.hit, seen.hit.bary);
            // copies of meshes have no spheres
            let round = mesh.is_round(h.triangle).then(|| mesh.primitive(h.triangle).capsule()).flatten();
            match round {
                Some(round) => {
                    let what = if round.is_sphere() { "sphere" } else { "capsule" };
                    writeln!(text, "hit: {what} {}, t {}", h.triangle, seen.t())?;
                }
                None => writeln!(text, "hit: triangle {}, t {}, bary {u} {v}", h.triangle, seen.t())?,
            }
            if path.segments.len() > 1 || camera.is_curved() {
                writeln!(text, "at: layer {}, piece {}, Z {}", seen.layer, seen.piece, path.depth(seen))?;
            }
        }
    }
    let miss = if finding.may_miss { " or none" } else { "" };
    let how = if camera.is_curved() || mesh.has_spheres() { " (sampled)" } else { "" };
    let what = if mesh.has_spheres() { "triangles and spheres" } else { "triangles" };
    writeln!(text, "within 1/16 px: {what} {:?}{miss}{how}", finding.candidates)?;
    write!(text, "safe: {}", finding.safe)
}
