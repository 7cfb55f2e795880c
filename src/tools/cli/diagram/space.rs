//! The scene with the camera's volume: near surface, far ends, sample rays or projectors, and slits.

use super::svg::{Frame, Svg};
use super::view::View;
use crate::arrays::MapEach;
use crate::camera::volume::{self, Box3, LayerVolume, box_edges, corners};
use crate::camera::{Camera, Curve};
use crate::geometry::mesh::Mesh;
use crate::geometry::wires::{self, Wires};
use glam::{DVec2, DVec3};

pub fn draw(svg: &mut Svg, frame: Frame, mesh: &Mesh, camera: &Camera) {
    let bounds = mesh.bounds();
    let (drawings, left_out) = volume::layers(camera, bounds);
    let curves: Vec<Curve> = drawings.iter().flat_map(|s| s.curves.iter().flatten().copied()).collect();
    let mut points: Vec<DVec3> = bounds.map(|b| corners(b).to_vec()).unwrap_or_default();
    points.extend(curves.iter().flat_map(|c| [0.0, 0.25, 0.5, 0.75, 1.0].map(|t| c.at(t))));
    points.extend(drawings.iter().flat_map(|s| s.slits.iter().flatten()));
    let look = curves.iter().map(chord).sum::<DVec3>() / curves.len().max(1) as f64;
    let view = View::beside(look).fitted(&points, &frame);
    let scene = draw_scene(svg, mesh, bounds, &view);
    for (k, drawing) in drawings.iter().enumerate() {
        svg.layer(k, &frame, |svg| draw_layer(svg, drawing, &view));
    }
    draw_axes(svg, &frame, &view);
    let foot = DVec2::new(frame.lo.x, frame.hi().y + 36.0);
    svg.text("label", foot - DVec2::Y * 16.0, &scene);
    svg.text("label", foot, &legend(camera, &drawings, left_out));
}

/// The rays of one layer.
fn draw_layer(svg: &mut Svg, layer: &LayerVolume, view: &View) {
    let places = |points: &[DVec3]| points.iter().map(|p| view.place(*p)).collect::<Vec<DVec2>>();
    layer.far().iter().for_each(|line| svg.polyline("far", &places(line)));
    layer.rays().for_each(|curve| svg.bezier("ray", &places(curve.points())));
    layer.outlines.iter().for_each(|outline| svg.polygon("near", &outline.map_each(|p| view.place(p))));
    layer.near().iter().for_each(|line| svg.polyline("near", &places(line)));
    for [a, b] in layer.slits.iter().map(|ends| ends.map_each(|p| view.place(p))) {
        if a == b { svg.dot("eye", a, 3.5) } else { svg.polyline("slit", &[a, b]) }
    }
}

/// What is drawn of the camera; `left_out` slits are not.
fn legend(camera: &Camera, drawings: &[LayerVolume], left_out: usize) -> String {
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

/// Draws the meshes and the box around them, and says what of them.
fn draw_scene(svg: &mut Svg, mesh: &Mesh, bounds: Option<Box3>, view: &View) -> String {
    let Some(bounds) = bounds else { return "scene: no meshes".into() };
    let corner = corners(bounds).map(|p| view.place(p));
    box_edges().for_each(|[from, to]| svg.polyline("box", &[corner[from], corner[to]]));
    let triangles = mesh.triangles.len();
    match wires::of(mesh, Some(&|d| view.on_page(d))) {
        Wires::Lines(lines, count) => {
            svg.lines("mesh", lines.iter().map(|line| line.map_each(|p| view.place(p))));
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
