//! What moves while a frame is taken because files or sizes say so, in closed form: vertices on their way from one file to the next, a
//! glTF's nodes, morph targets and skins, keyframes of a scale; and things that pass a line scan.

use super::exposure::{ROUNDED, SIZE, assert_shown, place, scene_of, scene_with};
use crate::common;

use common::file::load;
use glam::DVec2;
use serde_json::{Value, json};
use std::path::Path;

/// Rows are read one after the other in a frame.
fn row_time(j: u32) -> f64 {
    f64::from(j) / f64::from(SIZE.1)
}

fn by_rows() -> String {
    format!("line_time = {}", 1.0 / f64::from(SIZE.1))
}

/// How far a point lies inside of a convex polygon whose corners are counter-clockwise.
fn inside(corners: &[DVec2], p: DVec2) -> f64 {
    let next = corners.iter().cycle().skip(1);
    let depth = |(a, b): (&DVec2, &DVec2)| (*b - *a).normalize().perp_dot(p - *a);
    corners.iter().zip(next).map(depth).fold(f64::INFINITY, f64::min)
}

/// Four corners, counter-clockwise.
type Quad = [DVec2; 4];

fn mixed(from: &Quad, to: &Quad, share: f64) -> Quad {
    [0, 1, 2, 3].map(|k| from[k] + share * (to[k] - from[k]))
}

fn quad(corners: [[f64; 2]; 4]) -> Quad {
    corners.map(DVec2::from)
}

fn write_obj(folder: &Path, name: &str, quad: &Quad, faces: &str) {
    let vertices: String = quad.iter().map(|p| format!("v {:?} {:?} 0\n", p.x, p.y)).collect();
    std::fs::write(folder.join(name), vertices + faces).unwrap();
}

/// A bar on the left that becomes a square in the middle and then leans to the right.
fn three_quads() -> [Quad; 3] {
    [
        [[-1.9, -2.5], [-1.1, -2.5], [-1.1, 2.5], [-1.9, 2.5]],
        [[-1.0, -1.5], [1.0, -1.5], [1.0, 1.5], [-1.0, 1.5]],
        [[0.0, -2.5], [0.5, -2.5], [1.9, 2.5], [1.4, 2.5]],
    ]
    .map(quad)
}

/// Corners move less than three units from file to file, which is a step: less than [`ROUNDED`] in 2^-24 of it.
#[test]
fn vertices_go_from_file_to_file_row_by_row() {
    let folder = tempfile::tempdir().unwrap();
    let quads = three_quads();
    for (name, quad) in ["a.obj", "b.obj", "c.obj"].iter().zip(&quads) {
        write_obj(folder.path(), name, quad, "f 1 2 3\nf 1 3 4\n");
    }
    let key = |frame: f64, name: &str| format!("{{ frame = {frame}, value = '{}/{name}' }}", folder.path().display());
    let keys = |last: &str| format!("file = [{}, {}, {}]", key(0.0, "a.obj"), key(0.5, "b.obj"), key(1.0, last));
    let scene = scene_with("", &keys("c.obj"), &by_rows()).unwrap();
    assert_shown(&scene, 2.0 * ROUNDED, |i, j| {
        let (time, half) = (row_time(j), usize::from(row_time(j) > 0.5));
        let now = mixed(&quads[half], &quads[half + 1], 2.0 * time - half as f64);
        inside(&now, place(i, j, DVec2::ZERO))
    });
    // the same vertices, but the quad is divided along its other diagonal; and one triangle more
    for (name, faces) in [("other.obj", "f 1 2 4\nf 2 3 4\n"), ("more.obj", "f 1 2 3\nf 1 3 4\nf 2 3 4\n")] {
        write_obj(folder.path(), name, &quads[2], faces);
        let error = scene_with("", &keys(name), &by_rows()).unwrap_err();
        let text = error.to_string();
        assert!(error.exit_code() == 2 && !text.contains('\n'), "{text}");
        let says = format!(
            "b.obj and {}/{name}: have other triangles; keyframes of files only move vertices",
            folder.path().display()
        );
        assert!(text.contains(&says), "{text}");
    }
}

/// The mesh of a glTF after `edit`: strips of two triangles between rows of two vertices, and an animation "a" whose times are accessor 2.
/// Each of these lists of numbers has an accessor of its own from number 3 on.
fn animated(folder: &Path, rows: &[[DVec2; 2]], lists: &[(&str, Vec<f32>)], edit: impl FnOnce(&mut Value)) -> String {
    let positions: Vec<f32> = rows.iter().flatten().flat_map(|p| [p.x as f32, p.y as f32, 0.0]).collect();
    let first = |k: usize| 2 * k as u16;
    let indices: Vec<u16> =
        (0..rows.len() - 1).flat_map(|k| [0, 1, 2, 2, 1, 3].map(|corner: u16| first(k) + corner)).collect();
    let indices: Vec<u8> = indices.iter().flat_map(|k| k.to_le_bytes()).collect();
    let floats = |numbers: &[f32]| numbers.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>();
    let times: &[f32] = &[0.0, 0.5, 1.0];
    let mut parts =
        vec![("VEC3", 5126, floats(&positions)), ("SCALAR", 5123, indices), ("SCALAR", 5126, floats(times))];
    parts.extend(lists.iter().map(|(kind, numbers)| (*kind, 5126, floats(numbers))));
    let (mut bytes, mut views, mut accessors) = (Vec::new(), Vec::new(), Vec::new());
    for (k, (kind, component, part)) in parts.iter().enumerate() {
        let width = match *kind {
            "SCALAR" => 1,
            "VEC3" => 3,
            "VEC4" => 4,
            _ => 16,
        };
        let count = part.len() / width / if *component == 5123 { 2 } else { 4 };
        views.push(json!({ "buffer": 0, "byteOffset": bytes.len(), "byteLength": part.len() }));
        accessors.push(json!({ "bufferView": k, "componentType": component, "count": count, "type": kind }));
        bytes.extend(part);
    }
    let mut document = json!({
        "asset": { "version": "2.0" },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1 }] }],
        "animations": [{ "name": "a", "channels": [], "samplers": [] }],
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{ "uri": "all.bin", "byteLength": bytes.len() }],
    });
    edit(&mut document);
    std::fs::write(folder.join("all.bin"), bytes).unwrap();
    let path = folder.join("all.gltf");
    std::fs::write(&path, serde_json::to_vec(&document).unwrap()).unwrap();
    format!("file = '{}'", path.display())
}

/// Lets an accessor's values move a node.
fn move_node(document: &mut Value, node: usize, path: &str, accessor: usize) {
    let channel = json!({ "sampler": 0, "target": { "node": node, "path": path } });
    document["animations"][0]["channels"] = json!([channel]);
    document["animations"][0]["samplers"] = json!([{ "input": 2, "output": accessor }]);
}

/// The animation's second lasts a frame; its middle is a key, so that a way with a corner there is followed exactly.
const PLAYED: &str = "animation = 'a'\nanimation_time = [{ frame = 0, value = 0 }, { frame = 0.5, value = 0.5 }, { frame = 1, value = 1 }]";

/// Asserts what a scene of this glTF shows row by row, and that nothing of it moves unless its animation plays.
fn assert_played(mesh: &str, tolerance: f64, inside: impl Fn(f64, DVec2) -> f64) {
    let scene = scene_with("", &format!("{mesh}\n{PLAYED}"), &by_rows()).unwrap();
    assert_shown(&scene, tolerance, |i, j| inside(row_time(j), place(i, j, DVec2::ZERO)));
    let still = scene_with("", mesh, &by_rows()).unwrap();
    assert!(still.steps.is_none());
}

const BAR: [[f64; 2]; 4] = [[-0.5, -2.5], [0.5, -2.5], [-0.5, 2.5], [0.5, 2.5]];

/// Rows of two vertices each from below.
fn rows_of(corners: [[f64; 2]; 4]) -> [[DVec2; 2]; 2] {
    let [a, b, c, d] = corners.map(DVec2::from);
    [[a, b], [c, d]]
}

/// A bar goes to the right, and back in the second half. All numbers but times are multiples of 1/4 and so the same in f32.
#[test]
fn nodes_of_a_gltf_move_row_by_row() {
    let folder = tempfile::tempdir().unwrap();
    let way = ("VEC3", vec![-1.5, 0.0, 0.0, 1.25, 0.0, 0.0, -0.75, 0.0, 0.0]);
    let mesh = animated(folder.path(), &rows_of(BAR), &[way], |document| move_node(document, 0, "translation", 3));
    let middle = |time: f64| if time < 0.5 { -1.5 + 5.5 * time } else { 1.25 - 4.0 * (time - 0.5) };
    // a step is a sixtieth of a frame, in which it moves less than a tenth of a unit
    assert_played(&mesh, 2.0 * ROUNDED, |time, p| 0.5 - (p.x - middle(time)).abs());
}

/// Two targets, one of which fades while the other one comes.
#[test]
fn morph_targets_of_a_gltf_move_row_by_row() {
    let folder = tempfile::tempdir().unwrap();
    let targets: [[[f64; 2]; 4]; 2] =
        [[[-1.0, 0.0], [-1.0, 0.0], [-1.0, 0.0], [-0.5, 0.0]], [[0.5, 0.0], [1.5, 0.25], [1.0, -0.5], [1.0, -1.0]]];
    let moves = |k: usize| ("VEC3", targets[k].iter().flat_map(|[x, y]| [*x as f32, *y as f32, 0.0]).collect());
    let weights = ("SCALAR", vec![1.0, 0.0, 0.25, 0.5, 0.0, 1.0]);
    let mesh = animated(folder.path(), &rows_of(BAR), &[weights, moves(0), moves(1)], |document| {
        move_node(document, 0, "weights", 3);
        document["meshes"][0]["primitives"][0]["targets"] = json!([{ "POSITION": 4 }, { "POSITION": 5 }]);
    });
    assert_played(&mesh, 2.0 * ROUNDED, |time, p| {
        let fading = if time < 0.5 { 1.0 - 1.5 * time } else { 0.5 - 0.5 * time };
        let [a, b, c, d] = [0, 1, 2, 3].map(|k| {
            let [first, second] = targets.map(|target| DVec2::from(target[k]));
            DVec2::from(BAR[k]) + fading * first + time * second
        });
        inside(&[a, b, d, c], p)
    });
}

/// A bar whose upper end turns by 60 degrees to the right in a frame; its middle follows by half.
#[test]
fn skins_of_a_gltf_bend_row_by_row() {
    let folder = tempfile::tempdir().unwrap();
    let rows = [[[-0.5, -1.75], [0.5, -1.75]], [[-0.5, 0.0], [0.5, 0.0]], [[-0.5, 1.75], [0.5, 1.75]]];
    let rows = rows.map(|row| row.map(DVec2::from));
    let turn: Vec<f32> = [0.0f64, 30.0, 60.0]
        .iter()
        .flat_map(|angle| [0.0, 0.0, -(angle.to_radians() / 2.0).sin() as f32, (angle.to_radians() / 2.0).cos() as f32])
        .collect();
    // of the second joint: none below, half of the middle, all above
    let shares = [0.0, 0.0, 0.5, 0.5, 1.0, 1.0];
    let weights: Vec<f32> = shares.iter().flat_map(|share| [1.0 - share, *share, 0.0, 0.0]).collect();
    let joints: Vec<f32> = shares.iter().flat_map(|_| [0.0, 1.0, 0.0, 0.0]).collect();
    let lists = [("VEC4", turn), ("VEC4", joints), ("VEC4", weights)];
    let mesh = animated(folder.path(), &rows, &lists, |document| {
        move_node(document, 2, "rotation", 3);
        document["scenes"] = json!([{ "nodes": [0, 1] }]);
        document["nodes"] = json!([{ "mesh": 0, "skin": 0 }, { "children": [2] }, {}]);
        document["skins"] = json!([{ "joints": [1, 2] }]);
        document["meshes"][0]["primitives"][0]["attributes"] = json!({ "POSITION": 0, "JOINTS_0": 4, "WEIGHTS_0": 5 });
    });
    // corners go straight in steps of at most a degree: so far inside of their circle, and as far along it by less than a tenth of that
    let sagitta = DVec2::new(0.5, 1.75).length() * (1.0 - 0.5f64.to_radians().cos());
    assert_played(&mesh, 1.1 * sagitta, |time, p| {
        let turn = DVec2::from_angle(-60f64.to_radians() * time);
        let bent = |k: usize| rows[k].map(|p| p.lerp(turn.rotate(p), 0.5 * k as f64));
        let part = |[[a, b], [c, d]]: [[DVec2; 2]; 2]| inside(&[a, b, d, c], p);
        part([bent(0), bent(1)]).max(part([bent(1), bent(2)]))
    });
}

/// A box that grows to the sides and shrinks in height.
#[test]
fn sizes_change_row_by_row() {
    let sizes = "scale = [{ frame = 0, value = [0.5, 5, 0.1] }, { frame = 1, value = [3.5, 2, 0.1] }]";
    let scene = scene_of("", sizes, &by_rows());
    assert_shown(&scene, 2.0 * ROUNDED, |i, j| {
        let (p, time) = (place(i, j, DVec2::ZERO).abs(), row_time(j));
        (0.25 + 1.5 * time - p.x).min(2.5 - 1.5 * time - p.y)
    });
    // one number is all three
    let scene = scene_of("", "scale = [{ frame = 0, value = 4 }, { frame = 1, value = 1 }]", &by_rows());
    assert_shown(&scene, 2.0 * ROUNDED, |i, j| {
        let p = place(i, j, DVec2::ZERO).abs();
        2.0 - 1.5 * row_time(j) - p.max_element()
    });
}

/// Two triangles pass a line of pixels; what the columns show is their shape, and mirrored in the other order.
#[test]
fn a_line_scan_takes_things_as_they_pass() {
    let folder = tempfile::tempdir().unwrap();
    // one twice as far from the line as the other, which looks twice as high for its size
    let shapes = [[[-0.9, -1.75], [0.25, -1.25], [-0.5, 1.5]], [[0.25, 0.25], [0.9, -0.5], [0.75, 0.75]]];
    let shapes = shapes.map(|corners| corners.map(DVec2::from));
    let depths = [2.0, 1.0];
    let vertices: String = shapes
        .iter()
        .zip(depths)
        .flat_map(|(corners, depth)| corners.map(|p| format!("v {:?} {:?} {:?}\n", p.x, p.y, 2.0 - depth)))
        .collect();
    let path = folder.path().join("shapes.obj");
    std::fs::write(&path, vertices + "f 1 2 3\nf 4 5 6\n").unwrap();
    let line_time = 1.0 / f64::from(SIZE.0);
    for order in ["left", "right"] {
        let scene = load(&format!(
            "image = {{ width = {}, height = {} }}\n[[mesh]]\nfile = '{}'\n\
             translate = [{{ frame = 0, value = [-1, 0, 0] }}, {{ frame = 1, value = [1, 0, 0] }}]\n\
             [camera]\nkind = 'pushbroom'\nstart = [0, 0, 2]\ndirection = [1, 0, 0]\nextent = 1e-9\nlook = [0, 0, -1]\n\
             up = [0, 1, 0]\nvfov = 90\nline_order = '{order}'\nline_time = {line_time}\n",
            SIZE.0,
            SIZE.1,
            path.display()
        ))
        .unwrap();
        // the line itself is a billionth wide
        assert_shown(&scene, 2.0 * ROUNDED + 1e-9, |i, j| {
            let line = if order == "left" { SIZE.0 - 1 - i } else { i };
            let x = 1.0 - 2.0 * f64::from(line) * line_time;
            let slope = 1.0 - (2.0 * f64::from(j) + 1.0) / f64::from(SIZE.1);
            let depth = |k: usize| inside(&shapes[k], DVec2::new(x, depths[k] * slope));
            depth(0).max(depth(1))
        });
    }
}
