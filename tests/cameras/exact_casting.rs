//! Rays from anywhere against all triangles one by one, in whole numbers: through vertices, along edges, within planes.

use crate::common;

use anamorph::internals::geometry::cast::{ExactCaster, Hit, Ray};
use anamorph::internals::geometry::generate::{cube, icosphere};
use anamorph::internals::geometry::mesh::{Material, Mesh};
use common::rng::Rng;
use glam::DVec3;
use std::cmp::Ordering;
use std::sync::Arc;

type Whole = [i128; 3];

fn minus(a: Whole, b: Whole) -> Whole {
    [0, 1, 2].map(|k| a[k] - b[k])
}

fn cross(a: Whole, b: Whole) -> Whole {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn dot(a: Whole, b: Whole) -> i128 {
    (0..3).map(|k| a[k] * b[k]).sum()
}

fn whole(p: DVec3) -> Whole {
    p.to_array().map(|x| x as i128)
}

/// A mesh whose coordinates are even numbers, so that the middles of its edges are whole too.
fn even(mesh: Mesh, size: f64) -> Mesh {
    let positions = mesh.positions.iter().map(|p| 2.0 * (size * *p).round()).collect();
    Mesh { positions, ..mesh }
}

/// Triangles anywhere on a coarse grid, so that many share vertices, edges and planes, some lie in one another, and some have no area.
fn grid_soup(rng: &mut Rng) -> Mesh {
    let triangles: Vec<[u32; 3]> = (0..300).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
    let positions = (0..900).map(|_| 2.0 * (4.0 * rng.vector()).round()).collect();
    let material_of = vec![0; triangles.len()];
    Mesh { positions, triangles, material_of, materials: vec![Material::default()], ..Mesh::default() }
}

/// t as a fraction whose denominator is above 0.
#[derive(Debug, Clone, Copy)]
struct Fraction(i128, i128);

impl Fraction {
    fn compare(self, other: Fraction) -> Ordering {
        (self.0 * other.1).cmp(&(other.0 * self.1))
    }
}

/// All that a ray meets, in order, by the definition: the signs of all three edges are the same, those of 0 as if the ray's origin were moved
/// by (e, e^2, e^3).
fn truth(mesh: &Mesh, p: Whole, d: Whole, range: [i128; 2]) -> Vec<(Fraction, u32)> {
    let mut all = Vec::new();
    for (id, corners) in (0..).zip(&mesh.triangles) {
        let v = corners.map(|k| whole(mesh.positions[k as usize]));
        let side = |from: Whole, to: Whole| {
            let edge = minus(to, from);
            let value = dot(cross(minus(from, p), edge), d);
            // by e, then by e^2, then by e^3
            let moved = [0, 1, 2].map(|k| {
                let mut by = [0; 3];
                by[k] = -1;
                dot(cross(by, edge), d)
            });
            [value, moved[0], moved[1], moved[2]].into_iter().find(|x| *x != 0).map_or(0, i128::signum)
        };
        let sides = [side(v[0], v[1]), side(v[1], v[2]), side(v[2], v[0])];
        let normal = cross(minus(v[1], v[0]), minus(v[2], v[0]));
        let (above, below) = (dot(normal, minus(v[0], p)), dot(normal, d));
        if sides[0] == 0 || sides.iter().any(|s| *s != sides[0]) || below == 0 {
            continue;
        }
        let t = Fraction(above * below.signum(), below.abs());
        let [lo, hi] = range.map(|t| Fraction(t, 1));
        if t.compare(lo).is_ge() && t.compare(hi).is_le() {
            all.push((t, id));
        }
    }
    all.sort_by(|a, b| a.0.compare(b.0).then(a.1.cmp(&b.1)));
    all
}

/// A ray at a vertex, at the middle of an edge, within a triangle's plane, along an edge, or anywhere.
fn ray(mesh: &Mesh, rng: &mut Rng) -> (Whole, Whole) {
    let [a, b, c] = mesh.triangles[rng.below(mesh.triangles.len())].map(|k| whole(mesh.positions[k as usize]));
    let far = |rng: &mut Rng| whole((40.0 * rng.vector()).round());
    let middle = [0, 1, 2].map(|k| (a[k] + b[k]) / 2);
    match rng.below(7) {
        0 => (far(rng), far(rng)),
        1 => {
            let from = far(rng);
            (from, minus(c, from))
        }
        2 => {
            let from = far(rng);
            (from, minus(middle, from))
        }
        // in the plane, from outside
        3 => (minus(a, [0, 1, 2].map(|k| 9 * (c[k] - a[k]))), minus(middle, a)),
        4 => (minus(a, [0, 1, 2].map(|k| 9 * (b[k] - a[k]))), minus(b, a)),
        // along an axis, through a vertex
        5 => {
            let mut along = [0; 3];
            along[rng.below(3)] = 3;
            (minus(c, along.map(|x| 30 * x)), along)
        }
        // from a vertex
        _ => (a, far(rng)),
    }
}

fn same(hits: &[Hit], truth: &[(Fraction, u32)]) -> bool {
    let near = |t: f64, Fraction(above, below): Fraction| {
        let exact = above as f64 / below as f64;
        (t - exact).abs() <= 2.0 * exact.abs() / (1u64 << 40) as f64
    };
    hits.len() == truth.len() && hits.iter().zip(truth).all(|(hit, (t, id))| hit.triangle == *id && near(hit.t, *t))
}

#[test]
fn rays_meet_what_they_meet_in_whole_numbers() {
    let mut rng = Rng(17);
    let closed = [even(cube(), 5.0), even(icosphere(1), 9.0), even(icosphere(3), 40.0)];
    let soups: Vec<Mesh> = (0..6).map(|_| grid_soup(&mut rng)).collect();
    let mut met = 0;
    for (k, mesh) in closed.iter().chain(&soups).enumerate() {
        let caster = ExactCaster::new(Arc::new(mesh.clone()));
        for n in 0..2000 {
            let (p, d) = ray(mesh, &mut rng);
            if d == [0; 3] {
                continue;
            }
            let range = [[-(1 << 40), 1 << 40], [0, 1 << 40], [1, 1], [-1, 1]][rng.below(4)];
            let truth = truth(mesh, p, d, range);
            let vector = |w: Whole| DVec3::from_array(w.map(|x| x as f64));
            let own = Ray { origin: vector(p), direction: vector(d) };
            let ends = range.map(|t| t as f64);
            let name = format!("mesh {k}, ray {n}, {p:?} {d:?} {range:?}");
            let all = caster.all(&own, ends);
            assert!(same(&all, &truth), "{name}: {all:?} for {truth:?}");
            assert_eq!(caster.first(&own, ends), all.first().copied(), "{name}");
            assert_eq!(caster.meets_any(&own, ends), !all.is_empty(), "{name}");
            assert!(caster.is_exact(&own), "{name}");
            // a closed surface is crossed in and out
            assert!(
                k >= closed.len() || range[0] != -(1 << 40) || all.len().is_multiple_of(2),
                "{name}: {} crossings",
                all.len()
            );
            met += all.len();
        }
    }
    assert!(met > 15_000, "{met} hits");
}

#[test]
fn coordinates_whose_products_leave_f64_are_not_called_exact() {
    let ray = Ray { origin: DVec3::ZERO, direction: DVec3::X };
    let mut mesh = cube();
    assert!(ExactCaster::new(Arc::new(mesh.clone())).is_exact(&ray));
    assert!(!ExactCaster::new(Arc::new(mesh.clone())).is_exact(&Ray { direction: 1e-31 * DVec3::X, ..ray }));
    mesh.positions[0] *= 1e31;
    assert!(!ExactCaster::new(Arc::new(mesh)).is_exact(&ray));
}
