//! What a frame takes of the device's memory, for each triangle, vertex and pixel, as docs/reference/limits.md says. Nothing to do without
//! an adapter.

use crate::common;

use anamorph::internals::engine::plan::Wanted;
use anamorph::internals::engine::{Engine, RunOptions};
use anamorph::internals::geometry::generate::icosphere;
use anamorph::internals::image::frame::Channel;
use common::cameras::glc_of_each_class;
use common::gpu::engine_on;
use common::{FORWARD, camera, scene};

/// Bytes in lists whose layout depends on how raster goes over pairs.
#[derive(Clone, Copy)]
struct Lists {
    /// A pair: itself; tile by tile its unsorted copy and its rank; and where small triangles are drawn by themselves, one that is left.
    pair: f64,
    /// A tile: its run of pairs and its entry among the busy tiles.
    tile: f64,
}

const BY_TILE: Lists = Lists { pair: 8.0 + 8.0 + 4.0, tile: 8.0 + 8.0 };
const BY_TILE_WITH_SMALL: Lists = Lists { pair: BY_TILE.pair + 8.0, ..BY_TILE };
const BY_PAIR: Lists = Lists { pair: 8.0, tile: 0.0 };

/// Rows of a triangle and of its cluster and triangle group, and its share of the lists as they are at first: 2 pairs, 28 items of 8 for 64
/// triangles in the lists before these, and an item to recheck of 8 bytes for 16. A vertex has 32 bytes, a normal 12.
fn triangle(lists: Lists) -> f64 {
    40.5 + 2.0 * lists.pair + 3.5 + 0.5
}
const VERTEX: f64 = 32.0;
const NORMAL: f64 = 12.0;

/// Visibility, what trace leaves to recheck, and what tiles of 64 pixels have: a node and its share of those above, a cell, a first cell, and
/// capacity for 4 pairs and an item to recheck.
fn pixel(lists: Lists) -> f64 {
    8.0 + 8.0 + (96.0 * 16.0 / 15.0 + 48.0 + 4.0 + lists.tile + 4.0 * lists.pair + 8.0) / 64.0
}

/// Engines with their lists: one whose raster goes tile by tile if the adapter can, and one that goes pair by pair.
fn engines() -> Option<Vec<(Engine, Lists)>> {
    let (any, by_pair) = (engine_on(|_| {})?, engine_on(|gpu| gpu.has.lanes = false)?);
    let has = any.gpu.has;
    let lists = match has.by_tile() {
        true if has.f64 && has.atomics64 => BY_TILE_WITH_SMALL,
        true => BY_TILE,
        false => BY_PAIR,
    };
    Some(vec![(any, lists), (by_pair, BY_PAIR)])
}

/// What a frame of a ball takes, and what its mesh does as it is said.
fn bytes((engine, lists): &mut (Engine, Lists), detail: u32, side: u32) -> (f64, f64) {
    let mesh = icosphere(detail);
    let (triangles, vertices) = (mesh.triangles.len() as f64, mesh.positions.len() as f64);
    let said = triangle(*lists) * triangles + VERTEX * vertices + NORMAL * mesh.normals.len() as f64;
    let (_, kind) = glc_of_each_class().swap_remove(0);
    let camera = camera(kind, (side, side), FORWARD);
    let wanted = Wanted::of(vec![Channel::T, Channel::TriangleId]);
    let rendered = engine.render(&scene(mesh), &camera, &wanted, &RunOptions::default()).unwrap();
    (rendered.bytes as f64, said)
}

/// Rows and lists end on their own sizes: a page of them.
const ROUNDING: f64 = 4096.0;

/// Triangles, vertices and clusters lie in textures of whole rows.
const TEXTURE_ROW: f64 = 65536.0;

#[test]
fn a_triangle_takes_what_is_said() {
    for mut engine in engines().into_iter().flatten() {
        let (few, many) = (bytes(&mut engine, 4, 64), bytes(&mut engine, 6, 64));
        let (taken, said) = (many.0 - few.0, many.1 - few.1);
        println!("{taken} bytes taken, {said} said");
        assert!((taken - said).abs() <= ROUNDING + 3.0 * TEXTURE_ROW, "{taken} bytes taken, {said} said");
    }
}

#[test]
fn a_pixel_takes_what_is_said() {
    for mut engine in engines().into_iter().flatten() {
        // lists begin with all spare items from 256 x 256 pixels on
        let (few, many) = (bytes(&mut engine, 5, 256), bytes(&mut engine, 5, 1024));
        let pixels = 1024.0 * 1024.0 - 256.0 * 256.0;
        let (taken, said) = (many.0 - few.0, (pixel(engine.1) + 2.0 * 4.0) * pixels);
        println!("{:.1} bytes a pixel, {:.1} said", taken / pixels, said / pixels);
        assert!((taken - said).abs() <= ROUNDING, "{taken} bytes taken, {said} said");
    }
}

/// A small frame of an empty scene takes what its pixels take, 2^14 items to recheck, 64 items of each other list, and textures of whole rows.
#[test]
fn a_small_frame_of_nothing_takes_no_long_lists() {
    for (engine, lists) in engines().iter_mut().flatten() {
        let (_, kind) = glc_of_each_class().swap_remove(0);
        let wanted = Wanted::of(vec![Channel::T, Channel::TriangleId]);
        let camera = camera(kind, (160, 120), FORWARD);
        let nothing = scene(anamorph::internals::geometry::mesh::Mesh::default());
        let taken = engine.render(&nothing, &camera, &wanted, &RunOptions::default()).unwrap().bytes as f64;
        let said = (pixel(*lists) + 2.0 * 4.0) * 160.0 * 120.0 + 8.0 * 16384.0;
        println!("{taken} bytes taken, {said} said");
        assert!(taken <= said + ROUNDING + 16.0 * TEXTURE_ROW, "{taken} bytes taken, {said} said");
    }
}
