//! What a frame takes of the device's memory, for each triangle, vertex and pixel, as the README says. Nothing to do without an adapter.

mod common;

use anamorph::engine::RunOptions;
use anamorph::frame::Channel;
use anamorph::plan::Wanted;
use anamorph::scene::generate::icosphere;
use common::cameras::glc_of_each_class;
use common::gpu::engine_on;
use common::{FORWARD, camera, scene};

/// Rows of a triangle and of its cluster and bunch, and its share of the lists as they are at first: 2 pairs of 20, 28 items of 8 for 64
/// triangles in the lists before these, and a doubt of 8 for 16. A vertex has 24 bytes, a normal 12.
const TRIANGLE: f64 = 40.5 + 2.0 * 20.0 + 3.5 + 0.5;
const VERTEX: f64 = 24.0;
const NORMAL: f64 = 12.0;

/// Visibility, and what tiles of 64 pixels have: a node and its share of those above, a cell, a first cell, a run, a place among the
/// busy ones, and room for 4 pairs.
const PIXEL: f64 = 8.0 + (96.0 * 16.0 / 15.0 + 48.0 + 4.0 + 8.0 + 8.0 + 4.0 * 20.0) / 64.0;

/// What a frame of a ball takes, and what its mesh does as it is said.
fn bytes(detail: u32, side: u32) -> Option<(f64, f64)> {
    let mesh = icosphere(detail);
    let (triangles, vertices) = (mesh.triangles.len() as f64, mesh.positions.len() as f64);
    let said = TRIANGLE * triangles + VERTEX * vertices + NORMAL * mesh.normals.len() as f64;
    let (_, kind) = glc_of_each_class().swap_remove(0);
    let camera = camera(kind, (side, side), FORWARD);
    let wanted = Wanted::of(vec![Channel::T, Channel::TriangleId]);
    let rendered = engine_on(|_| {})?.render(&scene(mesh), &camera, &wanted, &RunOptions::default()).unwrap();
    Some((rendered.bytes as f64, said))
}

/// Rows and lists end on their own sizes: a page of them.
const ROUNDING: f64 = 4096.0;

#[test]
fn a_triangle_takes_what_is_said() {
    let (Some(few), Some(many)) = (bytes(4, 64), bytes(6, 64)) else { return };
    let (taken, said) = (many.0 - few.0, many.1 - few.1);
    println!("{taken} bytes taken, {said} said");
    assert!((taken - said).abs() <= ROUNDING, "{taken} bytes taken, {said} said");
}

#[test]
fn a_pixel_takes_what_is_said() {
    let (Some(few), Some(many)) = (bytes(2, 256), bytes(2, 1024)) else { return };
    let pixels = 1024.0 * 1024.0 - 256.0 * 256.0;
    let (taken, said) = (many.0 - few.0, (PIXEL + 2.0 * 4.0) * pixels);
    println!("{:.1} bytes a pixel, {:.1} said", taken / pixels, said / pixels);
    assert!((taken - said).abs() <= ROUNDING, "{taken} bytes taken, {said} said");
}
