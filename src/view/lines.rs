//! The camera's volume and the scene as lines, as JSON for the page.

use crate::arrays::MapEach;
use crate::camera::volume;
use crate::camera::{Camera, Curve};
use crate::geometry::mesh::Mesh;
use crate::geometry::wires::{self, Wires};
use glam::DVec3;
use serde_json::{Value as Json, json};

/// Points on a drawn curve.
const CURVE_POINTS: u32 = 12;
/// Lines of the scene that are sent.
const LINES_MAX: usize = 4000;

/// x, y, z of the points of a line, one after another.
fn line(points: impl IntoIterator<Item = DVec3>) -> Vec<f32> {
    points.into_iter().flat_map(|p| p.as_vec3().to_array()).collect()
}

/// The volume of a camera around the scene in `mesh`. Straight rays without a far end go to where most have left the scene.
pub fn of_camera(camera: &Camera, mesh: &Mesh) -> Json {
    let (layers, _) = volume::layers(camera, mesh.bounds());
    let near = layers.iter().flat_map(|layer| layer.near()).map(line);
    let outline = |[a, b, c]: &[DVec3; 3]| line([*a, *b, *c, *a]);
    let outlines = layers.iter().flat_map(|layer| layer.outlines.iter().map(outline));
    let rays = layers.iter().flat_map(|layer| layer.rays()).map(along);
    let (eyes, slits): (Vec<_>, Vec<_>) = layers.iter().flat_map(|layer| &layer.slits).partition(|[a, b]| a == b);
    json!({
        "near": near.chain(outlines).collect::<Vec<_>>(),
        "far": layers.iter().flat_map(|layer| layer.far()).map(line).collect::<Vec<_>>(),
        "rays": rays.collect::<Vec<_>>(),
        "slits": slits.into_iter().map(|ends: &[DVec3; 2]| line(*ends)).collect::<Vec<_>>(),
        "eyes": eyes.into_iter().map(|[eye, _]| line([*eye])).collect::<Vec<_>>(),
    })
}

fn along(curve: &Curve) -> Vec<f32> {
    match curve.degree() {
        1 => line([curve.at(0.0), curve.at(1.0)]),
        _ => line((0..=CURVE_POINTS).map(|k| curve.at(f64::from(k) / f64::from(CURVE_POINTS)))),
    }
}

/// The creases and borders of a mesh, or some of its edges or vertices where there are few; and the box around it.
pub fn of_scene(mesh: &Mesh) -> Json {
    let bounds = mesh.bounds();
    let (lines, points) = match wires::of(mesh, None) {
        Wires::Lines(lines, _) => (lines, Vec::new()),
        Wires::Points(points) => (Vec::new(), points),
    };
    let lines: Vec<Vec<f32>> = match lines.len() {
        n if n * 20 >= mesh.triangles.len().min(LINES_MAX) => {
            lines.iter().take(LINES_MAX).map(|ends| line(*ends)).collect()
        }
        // smooth all over: the outlines of some triangles
        _ => {
            let step = mesh.triangles.len().div_ceil(LINES_MAX / 2).max(1);
            let outline = |t: &[u32; 3]| line([t[0], t[1], t[2]].map_each(|v| mesh.positions[v as usize]));
            mesh.triangles.iter().step_by(step).map(outline).collect()
        }
    };
    json!({
        "lines": lines,
        "points": line(points),
        "bounds": bounds.map(|(lo, hi)| [lo.to_array(), hi.to_array()]),
    })
}
