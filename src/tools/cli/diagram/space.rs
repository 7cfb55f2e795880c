//! The scene with the camera's volume: near surface, far ends, sample rays or projectors, and slits.

use super::layer::{Box3, LayerDrawing};
use super::svg::{Frame, Svg};
use super::view::View;
use super::wires::{self, Wires};
use crate::camera::{Camera, Curve};
use crate::geometry::mesh::Mesh;
use glam::{DVec2, DVec3};

/// Slits farther from the middle than this many times the drawing's own extent are left out.
const SLIT_REACH: f64 = 1.5;

pub fn draw(svg: &mut Svg, frame: Frame, mesh: &Mesh, camera: &Camera) {
    let bounds = mesh.bounds();
    let mut drawings: Vec<LayerDrawing> =
        (0..camera.layers.len()).map(|k| LayerDrawing::of(camera, k, bounds)).collect();
    let mut points: Vec<DVec3> = bounds.map(|b| corners(b).to_vec()).unwrap_or_default();
    let curves: Vec<Curve> = drawings.iter().flat_map(|s| s.curves.iter().flatten().copied()).collect();
    points.extend(curves.iter().flat_map(|c| [0.0, 0.25, 0.5, 0.75, 1.0].map(|t| c.at(t))));
    let left_out = drop_far_slits(&mut drawings, &points);
    points.extend(drawings.iter().flat_map(|s| s.slits.iter().flatten()));
    let look = curves.iter().map(chord).sum::<DVec3>() / curves.len().max(1) as f64;
    let view = View::beside(look).fitted(&points, &frame);
    let scene = draw_scene(svg, mesh, bounds, &view);
    for (k, drawing) in drawings.iter().enumerate() {
        svg.layer(k, &frame, |svg| drawing.draw(svg, &view));
    }
    draw_axes(svg, &frame, &view);
    let foot = DVec2::new(frame.lo.x, frame.hi().y + 36.0);
    svg.text("label", foot - DVec2::Y * 16.0, &scene);
    svg.text("label", foot, &legend(camera, &drawings, left_out));
}

/// What is drawn of the camera; `left_out` slits are not.
fn legend(camera: &Camera, drawings: &[LayerDrawing], left_out: usize) -> String {
    let rays = drawings.iter().map(|s| s.rays().count()).sum::<usize>();
    let what = if camera.is_curved() { "projectors" } else { "rays" };
    let range = match drawings {
        [one] => format!("t from {} to {}", rounded(one.ends[0]), rounded(one.ends[1])),
        [.., last] if last.ends[1] < 1.0 => {
            format!("{} layers, t from 0 to 1, in the last to {}", drawings.len(), rounded(last.ends[1]))
        }
        _ => format!("{} layers, t from 0 to 1", drawings.len()),
    };
    let slits = match (drawings.iter().all(|s| s.slits.is_empty()), left_out) {
        (true, 0) => "",
        (false, 0) => "; red: slits, eyes",
        (true, _) => "; slits far outside are left out",
        (false, _) => "; red: slits, eyes, but for some far outside",
    };
    format!("camera: {rays} {what}, {range}; dashed: their far ends{slits}")
}

/// Unit direction from a curve's first to its last point.
fn chord(curve: &Curve) -> DVec3 {
    (curve.at(1.0) - curve.at(0.0)).normalize_or_zero()
}

fn rounded(t: f64) -> f64 {
    (t * 1e3).round() / 1e3
}

fn corners((lo, hi): Box3) -> [DVec3; 8] {
    let side = |k: usize, bit: usize, axis: usize| if k >> bit & 1 == 0 { lo[axis] } else { hi[axis] };
    [0, 1, 2, 3, 4, 5, 6, 7].map(|k| DVec3::new(side(k, 0, 0), side(k, 1, 1), side(k, 2, 2)))
}

/// Draws the meshes and the box around them, and says what of them.
fn draw_scene(svg: &mut Svg, mesh: &Mesh, bounds: Option<Box3>, view: &View) -> String {
    let Some(bounds) = bounds else { return "scene: no meshes".into() };
    let corner = corners(bounds).map(|p| view.place(p));
    for (k, bit) in (0..8).flat_map(|k| [1, 2, 4].map(|bit| (k, bit))).filter(|(k, bit)| k & bit == 0) {
        svg.polyline("box", &[corner[k], corner[k | bit]]);
    }
    let triangles = mesh.triangles.len();
    match wires::of(mesh, view) {
        Wires::Lines(lines, count) => {
            svg.lines("mesh", lines.iter().map(|line| line.map(|p| view.place(p))));
            let most = if lines.len() < count { format!("the {} longest of ", lines.len()) } else { String::new() };
            format!("scene: {triangles} triangles; {most}{count} creases and outlines")
        }
        Wires::Points(points) => {
            points.iter().for_each(|p| svg.dot("point", view.place(*p), 0.8));
            format!("scene: {triangles} triangles; {} of their vertices", points.len())
        }
    }
}

/// The world's axes in the lower left corner.
fn draw_axes(svg: &mut Svg, frame: &Frame, view: &View) {
    const LENGTH_PX: f64 = 28.0;
    let at = DVec2::new(frame.lo.x + 30.0, frame.hi().y - 30.0);
    for (axis, name) in [(DVec3::X, "x"), (DVec3::Y, "y"), (DVec3::Z, "z")] {
        let direction = view.on_page(axis);
        svg.polyline("axis", &[at, at + LENGTH_PX * direction]);
        svg.text("number", at + (LENGTH_PX + 8.0) * direction + DVec2::Y * 3.5, name);
    }
}

/// Takes out slits far from all `points`, and says how many.
fn drop_far_slits(drawings: &mut [LayerDrawing], points: &[DVec3]) -> usize {
    let (lo, hi) = points.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(l, h), p| (l.min(*p), h.max(*p)));
    let (middle, reach) = ((lo + hi) / 2.0, SLIT_REACH * (hi - lo).length());
    let mut left_out = 0;
    for drawing in drawings {
        let before = drawing.slits.len();
        drawing.slits.retain(|slit| slit.iter().all(|p| p.distance(middle) <= reach));
        left_out += before - drawing.slits.len();
    }
    left_out
}
