//! Closed meshes, a thousand triangles to a million. Coordinates are multiples of 2^-19 below 2: f32 holds them too.

use anamorph::internals::geometry::generate::icosphere;
use glam::DVec3;

/// A closed mesh.
pub struct Closed {
    pub name: &'static str,
    pub vertices: Vec<DVec3>,
    pub triangles: Vec<[u32; 3]>,
}

/// The multiple of 2^-20 that is nearest.
pub fn rounded(x: f64) -> f64 {
    let unit = f64::from(1 << 20);
    (x * unit).round() / unit
}

pub fn closed() -> Vec<Closed> {
    vec![
        ball("ball", 3, 0.0),
        grid("torus", 200, 50, torus),
        ball("bumpy-ball", 6, 0.05),
        cube(150),
        ball("large-ball", 8, 0.02),
    ]
}

fn ball(name: &'static str, level: u32, bump: f64) -> Closed {
    let mesh = icosphere(level);
    let bumpy = |p: &DVec3| *p * (1.0 + bump * (20.0 * p.x).sin() * (17.0 * p.y).cos());
    let vertices = mesh.positions.iter().map(|p| on_lattice(bumpy(p))).collect();
    Closed { name, vertices, triangles: mesh.triangles.clone() }
}

fn on_lattice(p: DVec3) -> DVec3 {
    2.0 * DVec3::from((p / 2.0).to_array().map(rounded))
}

fn torus(u: f64, v: f64) -> DVec3 {
    let [(su, cu), (sv, cv)] = [u, v].map(|x| (x * std::f64::consts::TAU).sin_cos());
    DVec3::new((0.7 + 0.3 * cv) * cu, 0.3 * sv, (0.7 + 0.3 * cv) * su)
}

/// A surface that closes in both directions.
fn grid(name: &'static str, columns: u32, rows: u32, at: fn(f64, f64) -> DVec3) -> Closed {
    let vertex = |k: u32| at(f64::from(k % columns) / f64::from(columns), f64::from(k / columns) / f64::from(rows));
    let index = |i: u32, j: u32| j % rows * columns + i % columns;
    let mut triangles = Vec::new();
    for (i, j) in (0..rows).flat_map(|j| (0..columns).map(move |i| (i, j))) {
        let [a, b, c, d] = [(i, j), (i + 1, j), (i, j + 1), (i + 1, j + 1)].map(|(i, j)| index(i, j));
        triangles.extend([[a, c, b], [b, c, d]]);
    }
    Closed { name, vertices: (0..columns * rows).map(vertex).map(on_lattice).collect(), triangles }
}

/// A cube of side 1, each face of `n` x `n` squares: planes and edges along the axes.
fn cube(n: u32) -> Closed {
    let mut numbers = std::collections::HashMap::new();
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for face in 0..6usize {
        let (axis, side) = (face / 2, (face % 2) as u32 * n);
        let mut number = |i: u32, j: u32| {
            let mut at = [0; 3];
            (at[axis], at[(axis + 1) % 3], at[(axis + 2) % 3]) = (side, i, j);
            *numbers.entry(at).or_insert_with(|| {
                vertices.push(on_lattice(DVec3::from(at.map(f64::from)) / f64::from(n) - 0.5));
                vertices.len() as u32 - 1
            })
        };
        for (i, j) in (0..n).flat_map(|j| (0..n).map(move |i| (i, j))) {
            let [a, b, c, d] = [(i, j), (i + 1, j), (i, j + 1), (i + 1, j + 1)].map(|(i, j)| number(i, j));
            triangles.extend(if side == 0 { [[a, c, b], [b, c, d]] } else { [[a, b, c], [b, d, c]] });
        }
    }
    Closed { name: "cube", vertices, triangles }
}
