//! The whole reference: hits against brute force, watertight fans and shells, special cases of the definitions.

mod chains;
mod curves;
mod lenses;
mod make;
mod verdicts;

use super::intersect::{Aim, Corners, meet};
use super::{Hit, Reference, nearer, upright};
use crate::camera::bundle::Bundle;
use crate::camera::perturb::scene_size;
use crate::geometry::mesh::{Material, Mesh};
use crate::testing::Rng;
use glam::DVec3;
use make::{bundle, icosphere, mesh, soup};
use proptest::prelude::*;

const ALL: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];
const FORWARD: [f64; 2] = [0.0, f64::INFINITY];

fn ray(p: DVec3, d: DVec3) -> Bundle {
    let across = d.normalize_or(DVec3::Z).any_orthonormal_vector();
    Bundle { p: [p, DVec3::ZERO, DVec3::ZERO], d: [d, across * 0.01, d.cross(across) * 0.01], h: [1.0, 0.0, 0.0] }
}

/// Every visible hit of the central ray, any order: no hierarchy.
fn all_hits(mesh: &Mesh, b: &Bundle, t_range: [f64; 2]) -> Vec<Hit> {
    let Some(b) = upright(b) else { return Vec::new() };
    let aim = Aim::new(b, scene_size(mesh.bounds()));
    let hit = |(k, t): (usize, &[u32; 3])| {
        let corners = Corners::new(t.map(|i| mesh.positions[i as usize]));
        let m = meet(&aim, &corners)?;
        let seen = mesh.materials[mesh.material_of[k] as usize].two_sided || m.sign < 0;
        let inside = !corners.is_degenerate() && seen && t_range[0] <= m.t && m.t <= t_range[1];
        inside.then_some(Hit { t: m.t, triangle: k as u32, bary: m.bary })
    };
    mesh.triangles.iter().enumerate().filter_map(hit).collect()
}

fn brute_force(mesh: &Mesh, b: &Bundle, t_range: [f64; 2]) -> Option<Hit> {
    all_hits(mesh, b, t_range).into_iter().fold(None, nearer)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 150, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn the_hierarchy_finds_what_brute_force_finds(seed in any::<u64>()) {
        let mut rng = Rng(seed);
        let centre = rng.vector() * [0.0, 1.0, 1e3, 1e7][rng.below(4)];
        let size = [2.0, 0.3, 0.05][rng.below(3)];
        let count = rng.below(300);
        let mesh = soup(&mut rng, count, size, centre);
        let reference = Reference::build(&mesh);
        for _ in 0..20 {
            let b = bundle(&mut rng, centre);
            for t_range in [FORWARD, ALL, [f64::NEG_INFINITY, 3.0], [2.5, 3.5], [-1.0, 3.0]] {
                prop_assert_eq!(reference.hit(&b, t_range), brute_force(&mesh, &b, t_range));
            }
        }
    }

    #[test]
    fn a_hit_is_on_the_ray_and_in_the_triangle(seed in any::<u64>()) {
        let mut rng = Rng(seed);
        let mesh = soup(&mut rng, 40, 1.0, DVec3::ZERO);
        let reference = Reference::build(&mesh);
        for _ in 0..20 {
            let b = bundle(&mut rng, DVec3::ZERO);
            if let Some(hit) = reference.hit(&b, FORWARD) {
                let [u, v] = hit.bary;
                prop_assert!(u >= 0.0 && v >= 0.0 && u + v <= 1.0 + 1e-12);
                let at = mesh.triangles[hit.triangle as usize].map(|k| mesh.positions[k as usize]);
                let on_triangle = at[0] * (1.0 - u - v) + at[1] * u + at[2] * v;
                let r = b.ray(0.0, 0.0);
                let on_ray = r.origin + hit.t * r.direction;
                prop_assert!((on_triangle - on_ray).length() < 1e-6, "{} {}", on_triangle, on_ray);
            }
        }
    }
}

/// Corners around the z axis as seen along it, at any depths, and the apex first.
fn fan(rng: &mut Rng, apex: DVec3, axes: [DVec3; 3], scale: f64) -> Mesh {
    let n = 4 + rng.below(8);
    let mut positions = vec![apex];
    for k in 0..n {
        let angle = (k as f64 + 0.4 * rng.signed()) * std::f64::consts::TAU / n as f64;
        let radius = scale * (1.1 + rng.signed());
        let depth = scale * rng.signed();
        positions.push(apex + axes[0] * (radius * angle.cos()) + axes[1] * (radius * angle.sin()) + axes[2] * depth);
    }
    let triangles = (0..n as u32)
        .map(|k| {
            let t = [0, k + 1, (k + 1) % n as u32 + 1];
            [[t[0], t[1], t[2]], [t[1], t[2], t[0]], [t[0], t[2], t[1]]][rng.below(3)]
        })
        .collect();
    mesh(positions, triangles)
}

#[test]
fn a_fan_about_a_corner_on_the_ray_is_hit_once() {
    for seed in 0..20_000 {
        let mut rng = Rng(seed);
        let b = bundle(&mut rng, DVec3::ZERO);
        let r = b.ray(0.0, 0.0);
        let scale = [1.0, 1e-3, 1e3][rng.below(3)];
        let x = r.direction.normalize().any_orthonormal_vector();
        let axes = [x, r.direction.normalize().cross(x), r.direction];
        // On the ray but for rounding; a step of a few ulp leaves a corner beside it.
        let mut apex = r.origin + 3.0 * r.direction;
        if rng.below(2) == 0 {
            apex += rng.vector() * 4.0 * f64::EPSILON;
        }
        let fan = fan(&mut rng, apex, axes, scale);
        assert_eq!(all_hits(&fan, &b, ALL).len(), 1, "seed {seed}");
    }
}

#[test]
fn a_fan_about_a_corner_exactly_on_the_ray_is_hit_once() {
    for seed in 0..20_000 {
        let mut rng = Rng(seed);
        // Integers throughout, so that the corner is on the ray without rounding.
        let mut whole = |n: f64| (rng.vector() * n).round();
        let (p, mut d) = (whole(100.0), whole(5.0));
        if d == DVec3::ZERO {
            d = DVec3::Z;
        }
        let steps: [DVec3; 4] = std::array::from_fn(|_| whole(3.0));
        let apex = p + 7.0 * d;
        let x = d.normalize().any_orthonormal_vector();
        let b = Bundle { p: [p, steps[0], steps[1]], d: [d, steps[2], steps[3]], h: [1.0, 0.0, 0.0] };
        let fan = fan(&mut rng, apex, [x, d.normalize().cross(x), d.normalize()], 1.0);
        assert_eq!(all_hits(&fan, &b, ALL).len(), 1, "seed {seed}");
    }
}

#[test]
fn an_edge_through_the_ray_belongs_to_one_of_its_two_triangles() {
    for seed in 0..20_000 {
        let mut rng = Rng(seed);
        let b = bundle(&mut rng, DVec3::ZERO);
        let r = b.ray(0.0, 0.0);
        let x = r.direction.normalize().any_orthonormal_vector();
        let y = r.direction.normalize().cross(x);
        let middle = r.origin + 2.0 * r.direction;
        let along = x * rng.signed() + y * rng.signed() + r.direction * rng.signed();
        let beside = r.direction.cross(along).normalize();
        let positions = vec![middle - along, middle + along, middle + beside, middle - beside];
        let pair = mesh(positions, vec![[0, 1, 2], [0, 1, 3]]);
        assert_eq!(all_hits(&pair, &b, ALL).len(), 1, "seed {seed}");
    }
}

#[test]
fn a_shell_is_hit_once_from_inside() {
    let mut rng = Rng(3);
    for offset in [0.0, 1.0, 1e3, 1e6] {
        let centre = rng.direction() * offset;
        let shell = icosphere(2, centre);
        for k in 0..3000 {
            let p = centre + 0.3 * rng.vector();
            let t = shell.triangles[rng.below(shell.triangles.len())];
            let v = t.map(|i| shell.positions[i as usize]);
            // Anywhere, at a corner, at an edge.
            let aim = [p + rng.direction(), v[0], v[0] + (v[1] - v[0]) * 0.5][k % 3];
            let mut b = ray(p, aim - p);
            b.p[1] = rng.vector() * 0.01;
            assert_eq!(all_hits(&shell, &b, FORWARD).len(), 1, "offset {offset}, ray {k}");
            let hits = all_hits(&shell, &b, ALL);
            assert_eq!(hits.len(), 2, "offset {offset}, ray {k}");
        }
    }
}

fn facing_square(z: f64, ids: &[[u32; 3]]) -> Mesh {
    let corner = |x: f64, y: f64| DVec3::new(x, y, z);
    mesh(vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(0.1, 1.0)], ids.to_vec())
}

#[test]
fn of_coincident_triangles_the_lowest_visible_id_wins() {
    let orders = [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0], [1, 0, 2]];
    let mut rng = Rng(11);
    for _ in 0..500 {
        let mut twins = facing_square(1.0, &orders);
        twins.positions.iter_mut().for_each(|v| *v += 0.3 * rng.vector());
        let b = ray(DVec3::ZERO, DVec3::new(0.01, 0.003, 1.0));
        assert_eq!(Reference::build(&twins).hit(&b, FORWARD).unwrap().triangle, 0);
        // One-sided: the first three show their backs, so the fourth is seen.
        twins.materials[0].two_sided = false;
        assert_eq!(Reference::build(&twins).hit(&b, FORWARD).unwrap().triangle, 3);
    }
}

#[test]
fn a_one_sided_back_hides_nothing() {
    let one_sided = Material { two_sided: false, ..Material::default() };
    let mut two = facing_square(1.0, &[[0, 1, 2]]);
    two.positions.extend(facing_square(2.0, &[]).positions);
    two.triangles.push([3, 5, 4]);
    two.materials = vec![one_sided];
    two.material_of = vec![0, 0];
    let reference = Reference::build(&two);
    // N of triangle 0 is +z, as the ray: its back is seen, it is skipped.
    assert_eq!(reference.hit(&ray(DVec3::ZERO, DVec3::Z), FORWARD).unwrap().triangle, 1);
    let back = reference.hit(&ray(DVec3::new(0.0, 0.0, 5.0), DVec3::NEG_Z), FORWARD).unwrap();
    assert_eq!((back.triangle, back.t), (0, 4.0));
}

#[test]
fn the_ends_of_the_range_belong_to_it() {
    let plane = facing_square(3.0, &[[0, 1, 2]]);
    let reference = Reference::build(&plane);
    let b = ray(DVec3::ZERO, DVec3::Z);
    for (range, seen) in [
        ([0.0, 3.0], true),
        ([3.0, 3.0], true),
        ([3.0, f64::INFINITY], true),
        ([f64::NEG_INFINITY, 3.0], true),
        // The plane passes through the ray's point at the end, within its tolerance of 2^-42 of the scene's size.
        ([0.0, 3.0_f64.next_down()], true),
        ([3.0_f64.next_up(), f64::INFINITY], true),
        ([0.0, 3.0 - 1e-10], false),
        ([3.0 + 1e-10, f64::INFINITY], false),
        ([f64::NEG_INFINITY, -3.0], false),
    ] {
        assert_eq!(reference.hit(&b, range).is_some(), seen, "{range:?}");
    }
    let behind = ray(DVec3::ZERO, DVec3::NEG_Z);
    assert_eq!(reference.hit(&behind, [-3.0, 0.0]).unwrap().t, -3.0);
    assert!(reference.hit(&behind, FORWARD).is_none());
    let on_it = ray(DVec3::new(0.0, 0.0, 3.0), DVec3::Z);
    assert_eq!(reference.hit(&on_it, FORWARD).unwrap().t, 0.0);
    assert_eq!(reference.hit(&on_it, [-1.0, 0.0]).unwrap().t, 0.0);
}

/// Such a triangle is visible although a wall stands before the place where the ray meets it, so the search must not stop at the wall.
#[test]
fn a_hit_is_moved_to_the_start_from_behind_a_wall() {
    let far = 2.0_f64.powi(31);
    // a triangle whose plane the ray's start is 0.9 of the tolerance away from, and that the ray meets at this share of the farthest move
    let seen = |share: f64| {
        let at = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
        let ends = [-far, far].into_iter().flat_map(|x| [at(x, 0.0, 9.0), at(x, 1.0, 9.0), at(x, 0.0, 8.0)]);
        let wall = [at(-1.0, -1.0, 0.25), at(1.0, -1.0, 0.25), at(0.0, 2.0, 0.25)];
        let mut all = mesh(wall.into_iter().chain(ends).collect(), vec![[0, 1, 2], [3, 4, 5], [6, 7, 8]]);
        let size = scene_size(all.bounds());
        let t = share * 0.5_f64.powi(32) * size;
        let sine = 0.9 * 0.5_f64.powi(42) * size / t;
        let on_plane = |y: f64, z: f64| at(sine * (z - t), y, z);
        all.positions.extend([on_plane(-1.0, 0.3), on_plane(1.0, 0.3), on_plane(0.0, 40.0)]);
        all.positions.extend((0..600).map(|k| at(f64::from(k % 3) - 1.0, f64::from(k % 2), 50.0 + f64::from(k))));
        all.triangles.extend((0..201).map(|k| [9, 10, 11].map(|v| v + 3 * k)));
        all.material_of.resize(all.triangles.len(), 0);
        Reference::build(&all).hit(&ray(DVec3::ZERO, DVec3::Z), FORWARD).map(|hit| (hit.triangle, hit.t))
    };
    assert_eq!(seen(0.9), Some((3, 0.0)));
    assert_eq!(seen(1.1), Some((0, 0.25)));
}

#[test]
fn negative_depth_comes_first() {
    let mut two = facing_square(-2.0, &[[0, 1, 2]]);
    two.positions.extend(facing_square(1.0, &[]).positions);
    two.triangles.push([3, 4, 5]);
    two.material_of.push(0);
    let reference = Reference::build(&two);
    let hit = |range| reference.hit(&ray(DVec3::ZERO, DVec3::Z), range).unwrap();
    assert_eq!(hit(ALL).t, -2.0);
    assert_eq!(hit(FORWARD).t, 1.0);
}

#[test]
fn no_ray_and_no_triangle_give_no_hit() {
    let plane = facing_square(3.0, &[[0, 1, 2]]);
    let reference = Reference::build(&plane);
    let good = ray(DVec3::ZERO, DVec3::Z);
    let mut bad = [good; 4];
    bad[0].d[0] = DVec3::ZERO;
    bad[1].p[0].x = f64::NAN;
    bad[2].d[0].z = f64::INFINITY;
    bad[3].h = [0.0; 3];
    assert!(bad.iter().all(|b| reference.hit(b, ALL).is_none() && !reference.verdict(&[*b], ALL).safe));
    // The same rays with every homogeneous part negated.
    let flipped = Bundle { p: good.p.map(|v| -v), d: good.d.map(|v| -v), h: good.h.map(|v| -v) };
    assert_eq!(reference.hit(&flipped, ALL), reference.hit(&good, ALL));
    let empty = Mesh::default();
    assert!(Reference::build(&empty).hit(&good, ALL).is_none());
    let miss = Reference::build(&empty).verdict(&[good], ALL);
    assert!(miss.safe && miss.may_miss && miss.candidates.is_empty());
}
