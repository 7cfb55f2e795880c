//! The files that examples' cameras read.

use super::{NamedFile, npy};
use crate::arrays::MapEach;
use glam::{DVec2, DVec3};
use serde::Serialize;

/// A mesh camera's `file`.
#[derive(Default, Serialize)]
struct Pieces {
    vertices: Vec<Vertex>,
    triangles: Vec<[usize; 3]>,
}

#[derive(Serialize)]
struct Vertex {
    image: [f64; 2],
    near: [f64; 3],
    far: [f64; 3],
}

/// A grid of `columns x rows` cells over the image, two triangles each, with the rays (near, far) that `ray` gives
/// for (a, b).
fn grid(columns: usize, rows: usize, ray: impl Fn(f64, f64) -> (DVec3, DVec3)) -> Vec<u8> {
    let mut pieces = Pieces::default();
    for j in 0..=rows {
        for i in 0..=columns {
            let (a, b) = (i as f64 / columns as f64, j as f64 / rows as f64);
            let (near, far) = ray(a, b);
            pieces.vertices.push(Vertex { image: [a, b], near: short(near), far: short(far) });
        }
    }
    for j in 0..rows {
        for i in 0..columns {
            let k = j * (columns + 1) + i;
            let below = k + columns + 1;
            pieces.triangles.extend([[k, k + 1, below], [below, k + 1, below + 1]]);
        }
    }
    // numbers and lists alone: nothing that JSON refuses
    (serde_json::to_string(&pieces).unwrap_or_default() + "\n").into()
}

/// Six digits behind the point, so that a person can read the file; the same on every machine, whatever the last
/// bits of its sines are.
fn short(v: DVec3) -> [f64; 3] {
    (v * 1e6).round().to_array().map_each(|x| x / 1e6)
}

/// A vertex of an .obj.
fn vertex_line(v: DVec3) -> String {
    let [x, y, z] = short(v);
    format!("v {x} {y} {z}\n")
}

/// `mesh.json`: an eye above a city, with the picture's middle enlarged.
pub fn lens() -> Vec<NamedFile> {
    const EYE: DVec3 = DVec3::new(34.0, 40.0, 62.0);
    const TARGET: DVec3 = DVec3::new(0.0, 3.0, 0.0);
    const HALF_HEIGHT: f64 = 0.34;
    const ASPECT: f64 = 4.0 / 3.0;
    // the lens in half heights of the picture, and how much smaller angles are in its middle
    const RADIUS: f64 = 0.9;
    const DEPTH: f64 = 0.6;
    let forward = (TARGET - EYE).normalize();
    let right = forward.cross(DVec3::Y).normalize();
    let up = right.cross(forward);
    let ray = |a: f64, b: f64| {
        let (x, y) = (ASPECT * (2.0 * a - 1.0), 1.0 - 2.0 * b);
        let inside = (1.0 - (x * x + y * y) / (RADIUS * RADIUS)).max(0.0);
        let scale = HALF_HEIGHT * (1.0 - DEPTH * inside * inside);
        let direction = forward + scale * (x * right + y * up);
        (EYE, EYE + (TARGET - EYE).length() * direction)
    };
    vec![("mesh.json", grid(15, 15, ray))]
}

/// `panorama.json`: an eye that goes round the y axis and looks at it.
pub fn ring() -> Vec<NamedFile> {
    const DISTANCE: f64 = 9.0;
    const HEIGHT: f64 = 4.5;
    const SWEEP_DEG: f64 = 270.0;
    const LOWEST: f64 = -1.4;
    const HIGHEST: f64 = 3.6;
    let ray = |a: f64, b: f64| {
        // to the right in the picture is to the right of the eye
        let (sin, cos) = (SWEEP_DEG * (a - 0.5)).to_radians().sin_cos();
        let near = DVec3::new(DISTANCE * sin, HEIGHT, DISTANCE * cos);
        (near, DVec3::new(0.0, HIGHEST + b * (LOWEST - HIGHEST), 0.0))
    };
    vec![("panorama.json", grid(48, 1, ray))]
}

/// `fisheye-origins.npy` and `fisheye-directions.npy`: the angle from straight up grows with the distance from the
/// picture's middle; NaN outside the circle.
pub fn fisheye() -> Vec<NamedFile> {
    const SIDE: u64 = 600;
    const FIELD_DEG: f64 = 190.0;
    const EYE: DVec3 = DVec3::new(0.3, 1.6, 0.2);
    const NORTH: DVec3 = DVec3::NEG_Z;
    const WEST: DVec3 = DVec3::NEG_X;
    let place = |k: u64| 2.0 * (k as f64 + 0.5) / SIDE as f64 - 1.0;
    let direction = |i: u64, j: u64| {
        // lying on the back, head to the north: west is on the right
        let (x, y) = (place(i), -place(j));
        let radius = f64::hypot(x, y);
        if radius > 1.0 {
            return DVec3::NAN;
        }
        let (sin, cos) = (radius * FIELD_DEG.to_radians() / 2.0).sin_cos();
        cos * DVec3::Y + sin / radius * (x * WEST + y * NORTH)
    };
    let pixels = || (0..SIDE).flat_map(|j| (0..SIDE).map(move |i| (i, j)));
    let file = |numbers: Vec<f64>| npy([SIDE, SIDE, 3], &numbers);
    vec![
        ("fisheye-origins.npy", file(pixels().flat_map(|_| EYE.to_array()).collect())),
        ("fisheye-directions.npy", file(pixels().flat_map(|(i, j)| direction(i, j).to_array()).collect())),
    ]
}

/// `deformation.npy` and finer ones of the same: offsets that turn and enlarge the picture's middle, none at its border.
pub fn offsets() -> Vec<NamedFile> {
    vec![
        ("deformation.npy", deformation(16, 16)),
        ("deformation-80x60.npy", deformation(80, 60)),
        ("deformation-128x128.npy", deformation(128, 128)),
    ]
}

fn deformation(columns: u64, rows: u64) -> Vec<u8> {
    const TURN: f64 = 0.6;
    const GROWTH: f64 = 0.5;
    let place = |k: u64, count: u64| k as f64 / (count - 1) as f64 - 0.5;
    let offset = |i: u64, j: u64| {
        let p = DVec2::new(place(i, columns), place(j, rows));
        let inside = (1.0 - 4.0 * p.length_squared()).max(0.0).powi(2);
        (1.0 + GROWTH * inside) * DVec2::from_angle(TURN * inside).rotate(p) - p
    };
    let places = (0..rows).flat_map(|j| (0..columns).map(move |i| (i, j)));
    let numbers: Vec<f64> = places.flat_map(|(i, j)| offset(i, j).to_array()).collect();
    npy([rows, columns, 2], &numbers)
}

/// `surround.obj`: 400 triangles around a walker: the sides of a rounded square box, two for each of 20 x 9 cells from
/// the top left, then its lid and its base alternately. In an image of 20 x 10 cells the sides unfold in one piece.
pub fn barrel() -> Vec<NamedFile> {
    const AROUND: usize = 20;
    const UP: usize = 9;
    const RADIUS: f64 = 0.75;
    const TOP: f64 = 2.2;
    const BASE: f64 = -0.25;
    /// How far lid and base rise beyond the sides, in their middle.
    const CROWN: f64 = 0.2;
    let mut text = String::new();
    let mut vertex = |v: DVec3| text += &vertex_line(v);
    for j in 0..=UP {
        for i in 0..AROUND {
            let (sin, cos) = (std::f64::consts::TAU * i as f64 / AROUND as f64).sin_cos();
            let radius = RADIUS / (sin.powi(4) + cos.powi(4)).powf(0.25);
            vertex(DVec3::new(radius * sin, TOP + (BASE - TOP) * j as f64 / UP as f64, radius * cos));
        }
    }
    vertex(DVec3::Y * (TOP + CROWN));
    vertex(DVec3::Y * (BASE - CROWN));
    let at = |i: usize, j: usize| j * AROUND + i % AROUND + 1;
    let (lid, base) = (AROUND * (UP + 1) + 1, AROUND * (UP + 1) + 2);
    let mut face = |[a, b, c]: [usize; 3]| text += &format!("f {a} {b} {c}\n");
    for (j, i) in (0..UP).flat_map(|j| (0..AROUND).map(move |i| (j, i))) {
        face([at(i, j), at(i, j + 1), at(i + 1, j)]);
        face([at(i + 1, j + 1), at(i + 1, j), at(i, j + 1)]);
    }
    for i in 0..AROUND {
        face([lid, at(i, 0), at(i + 1, 0)]);
        face([base, at(i + 1, UP), at(i, UP)]);
    }
    vec![("surround.obj", text.into())]
}

/// `ring.obj`: 400 triangles around the y axis, a ring of radius 1 and height 0.55 on the ground.
pub fn band() -> Vec<NamedFile> {
    const AROUND: usize = 200;
    const HEIGHT: f64 = 0.55;
    let mut text = String::new();
    for y in [0.0, HEIGHT] {
        for i in 0..AROUND {
            let (sin, cos) = (std::f64::consts::TAU * i as f64 / AROUND as f64).sin_cos();
            text += &vertex_line(DVec3::new(sin, y, cos));
        }
    }
    for i in 0..AROUND {
        let (a, b) = (i + 1, (i + 1) % AROUND + 1);
        text += &format!("f {a} {b} {}\nf {a} {} {}\n", b + AROUND, b + AROUND, a + AROUND);
    }
    vec![("ring.obj", text.into())]
}

/// `helix.ply`: the atoms of a double helix about the y axis, 42 pairs in four turns; strands of eight atoms a pair, and rungs of seven.
pub fn helix() -> Vec<NamedFile> {
    const PAIRS: usize = 42;
    const PAIRS_A_TURN: f64 = 10.5;
    const RISE: f64 = 0.17;
    /// From one strand to the other, about the axis.
    const APART: f64 = 2.4;
    const STRAND_ATOMS: usize = 4;
    const RUNG_ATOMS: usize = 7;
    const STRANDS: [[u8; 3]; 2] = [[230, 120, 50], [150, 110, 200]];
    const BASES: [[u8; 3]; 4] = [[205, 70, 60], [70, 150, 215], [235, 190, 70], [95, 180, 95]];
    let mut atoms: Vec<(DVec3, f64, [u8; 3])> = Vec::new();
    let place = |pair: f64, strand: usize| {
        let angle = std::f64::consts::TAU * pair / PAIRS_A_TURN + strand as f64 * APART;
        DVec3::new(angle.cos(), (pair - (PAIRS as f64 - 1.0) / 2.0) * RISE, angle.sin())
    };
    for k in 0..PAIRS {
        let base = (k * k + 3 * k / 2) % BASES.len();
        for (strand, color) in STRANDS.into_iter().enumerate() {
            let on_strand = |j: usize| place(k as f64 + j as f64 / STRAND_ATOMS as f64, strand);
            let radius = |j: usize| if j.is_multiple_of(2) { 0.17 } else { 0.12 };
            atoms.extend((0..STRAND_ATOMS).map(|j| (on_strand(j), radius(j), color)));
        }
        let ends = [place(k as f64, 0), place(k as f64, 1)];
        atoms.extend((1..=RUNG_ATOMS).map(|j| {
            let is_first = 2 * j + k % 2 <= RUNG_ATOMS + 1;
            let color = BASES[if is_first { base } else { base ^ 1 }];
            (ends[0].lerp(ends[1], j as f64 / (RUNG_ATOMS + 1) as f64), 0.11, color)
        }));
    }
    let mut text = format!("ply\nformat ascii 1.0\nelement vertex {}\n", atoms.len());
    let properties = ["float x", "float y", "float z", "float radius", "uchar red", "uchar green", "uchar blue"];
    text.extend(properties.map(|property| format!("property {property}\n")));
    text.push_str("end_header\n");
    for (at, radius, [r, g, b]) in atoms {
        let [x, y, z] = short(at);
        text.push_str(&format!("{x} {y} {z} {radius} {r} {g} {b}\n"));
    }
    vec![("helix.ply", text.into())]
}

/// `flock-300.obj` and three larger ones, with their colours: so many triangles, four a butterfly, in a ring around the y axis.
/// A larger flock has the butterflies of a smaller one and more.
pub fn flocks() -> Vec<NamedFile> {
    let flock = |name, triangles: usize| (name, flock(triangles / 4).into());
    let colours = [[0.85, 0.45, 0.1], [0.2, 0.35, 0.75], [0.85, 0.8, 0.3], [0.7, 0.15, 0.3]];
    let material = |(k, [r, g, b]): (usize, &[f64; 3])| format!("newmtl wings{k}\nKd {r} {g} {b}\n");
    vec![
        ("flock.mtl", colours.iter().enumerate().map(material).collect::<String>().into()),
        flock("flock-300.obj", 300),
        flock("flock-700.obj", 700),
        flock("flock-1100.obj", 1100),
        flock("flock-1500.obj", 1500),
    ]
}

/// Butterflies that fly round a ring: head, tail and two wings, each a front and a hind tip.
fn flock(count: usize) -> String {
    const COLOURS: usize = 4;
    /// Half a body, and how far wings reach, at their front.
    const BODY: f64 = 0.075;
    const WING: f64 = 0.165;
    /// Nearest and farthest from the axis; lowest and highest.
    const RADIUS: [f64; 2] = [1.9, 2.65];
    const HEIGHT: [f64; 2] = [0.25, 2.4];
    /// Golden ratios in one, two and three dimensions: places that are spread evenly however many there are.
    const SPREAD: [f64; 3] = [0.618_033_988_749_895, 0.754_877_666_246_693, 0.819_172_513_396_164];
    let mut text = String::from("mtllib flock.mtl\n");
    for k in 0..count {
        let [turn, out, up] = SPREAD.map_each(|s| (k as f64 * s).fract());
        let mix = |[a, b]: [f64; 2], s: f64| a + (b - a) * s;
        let (sin, cos) = (std::f64::consts::TAU * turn).sin_cos();
        let (side, ahead) = (DVec3::new(sin, 0.0, cos), DVec3::new(cos, 0.0, -sin));
        let at = mix(RADIUS, out) * side + mix(HEIGHT, up) * DVec3::Y;
        // wings at half-mast, each butterfly in another stroke
        let (lift, reach) = (0.2 + 0.9 * (k as f64 * SPREAD[0] * SPREAD[1]).fract()).sin_cos();
        let tip = |s: f64, along: f64, long: f64| {
            at + along * BODY * ahead + long * WING * (s * reach * side + lift * DVec3::Y)
        };
        let points = [
            at + BODY * ahead,
            at - BODY * ahead,
            tip(1.0, 1.3, 1.0),
            tip(1.0, -1.2, 0.7),
            tip(-1.0, 1.3, 1.0),
            tip(-1.0, -1.2, 0.7),
        ];
        text.extend(points.map(vertex_line));
        let n = 6 * k + 1;
        let [head, tail, front, hind, front2, hind2] = [n, n + 1, n + 2, n + 3, n + 4, n + 5];
        text += &format!("usemtl wings{}\nf {tail} {front} {head}\nf {tail} {hind} {front}\n", k % COLOURS);
        text += &format!("f {tail} {head} {front2}\nf {tail} {front2} {hind2}\n");
    }
    text
}

/// `plume.npy`: smoke that rises, swings to and fro, widens and thins; how dense it is, at nodes along z, y (upwards) and x.
pub fn plume() -> Vec<NamedFile> {
    const NODES: [u64; 3] = [32, 96, 32];
    /// Of 1, at the top.
    const THINNED: f64 = 0.75;
    const DIGITS: f64 = 1e4;
    let place = |k: u64, count: u64| k as f64 / (count - 1) as f64;
    let density = |x: f64, height: f64, z: f64| {
        let axis = DVec2::new(0.9 * height * (6.0 * height).sin(), 0.35 * (9.0 * height + 1.0).cos() * height);
        let off = DVec2::new(2.5 * x, 2.5 * z) - axis;
        let radius = 0.28 + 0.95 * height;
        let swirl = (9.0 * off.x + 14.0 * height).sin() * (8.0 * off.y - 17.0 * height).cos()
            + 0.6 * (19.0 * off.x - 23.0 * height).cos() * (21.0 * off.y + 11.0 * height).sin();
        // billows move its border to and fro
        let inside = 1.0 - off.length() / (radius * (1.0 + 0.22 * swirl));
        let ends = (12.0 * height).min(6.0 * (1.0 - height)).clamp(0.0, 1.0);
        (1.0 - THINNED * height) * ends * (1.8 * inside).clamp(0.0, 1.0)
    };
    let [depth, rows, columns] = NODES;
    let nodes = (0..depth).flat_map(|k| (0..rows).flat_map(move |j| (0..columns).map(move |i| (i, j, k))));
    let number = |(i, j, k)| {
        let exact = density(2.0 * place(i, columns) - 1.0, place(j, rows), 2.0 * place(k, depth) - 1.0);
        (DIGITS * exact).round() / DIGITS
    };
    vec![("plume.npy", npy(NODES, &nodes.map(number).collect::<Vec<f64>>()))]
}
