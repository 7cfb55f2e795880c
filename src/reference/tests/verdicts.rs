//! Verdicts against dense samples of the box, and against cases whose answer is plain.

use super::make::{bundle, icosphere, mesh, soup};
use super::{ALL, FORWARD, ray};
use crate::camera::bundle::Bundle;
use crate::geometry::mesh::Mesh;
use crate::reference::{MARGIN_PX, Reference};
use crate::testing::Rng;
use glam::DVec3;
use proptest::prelude::*;

/// Places of a 9 x 9 grid over the box, its border included.
fn samples() -> impl Iterator<Item = (f64, f64)> {
    let at = |k: i32| MARGIN_PX * f64::from(k) / 4.0;
    (-4..=4).flat_map(move |j| (-4..=4).map(move |i| (at(i), at(j))))
}

/// What the verdict says holds at every sample: safe or not, and whether it proves that nothing misses.
fn check(mesh: &Mesh, b: &Bundle, t_range: [f64; 2]) -> Result<(bool, bool), TestCaseError> {
    let reference = Reference::build(mesh);
    let v = reference.verdict(&[*b], t_range);
    prop_assert_eq!(v.hit, reference.hit(b, t_range));
    if v.safe {
        prop_assert_eq!(v.candidates.len(), usize::from(v.hit.is_some()));
    }
    for (x, y) in samples() {
        let answer = reference.hit(&b.recentred(x, y), t_range).map(|h| h.triangle);
        match answer {
            Some(id) => prop_assert!(v.candidates.contains(&id), "{} at {} {} not in {:?}", id, x, y, v),
            None => prop_assert!(v.may_miss, "a miss at {} {} in {:?}", x, y, v),
        }
        if v.safe {
            prop_assert_eq!(answer, v.hit.map(|h| h.triangle));
        }
    }
    Ok((v.safe, !v.may_miss))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_verdict_holds_all_over_the_box(seed in any::<u64>()) {
        let mut rng = Rng(seed);
        let centre = rng.vector() * [0.0, 1.0, 1e4][rng.below(3)];
        let size = [2.0, 0.2, 0.01][rng.below(3)];
        let count = 1 + rng.below(300);
        let mesh = soup(&mut rng, count, size, centre);
        for _ in 0..6 {
            let b = bundle(&mut rng, centre);
            for t_range in [FORWARD, ALL, [2.9, 3.1]] {
                check(&mesh, &b, t_range)?;
            }
        }
    }

    #[test]
    fn a_verdict_holds_beside_edges_and_corners(seed in any::<u64>()) {
        let mut rng = Rng(seed);
        let mesh = icosphere(2, DVec3::ZERO);
        let b = bundle(&mut rng, DVec3::ZERO);
        let r = b.ray(0.0, 0.0);
        // Moves the sphere so that a corner or an edge comes within a tenth of a pixel.
        let t = mesh.triangles[rng.below(320)].map(|k| mesh.positions[k as usize]);
        let feature = t[0] + (t[1] - t[0]) * [0.0, 0.5][rng.below(2)];
        let to = r.origin + r.direction * (3.0 - feature.dot(r.direction.normalize()));
        let shift = to - feature + rng.vector() * 0.002;
        let moved = Mesh { positions: mesh.positions.iter().map(|v| *v + shift).collect(), ..mesh };
        check(&moved, &b, FORWARD)?;
        check(&moved, &b, ALL)?;
    }
}

fn square(z: f64, half: f64) -> Mesh {
    let at = |x: f64, y: f64| DVec3::new(x * half, y * half, z);
    mesh(vec![at(-1.0, -1.0), at(3.0, -1.0), at(-1.0, 3.0)], vec![[0, 1, 2]])
}

fn both(mut a: Mesh, b: &Mesh) -> Mesh {
    let n = a.positions.len() as u32;
    a.positions.extend_from_slice(&b.positions);
    a.triangles.extend(b.triangles.iter().map(|t| t.map(|k| k + n)));
    a.material_of.extend_from_slice(&b.material_of);
    a
}

fn verdict(mesh: &Mesh, t_range: [f64; 2]) -> (bool, Vec<u32>, bool) {
    let b =
        Bundle { p: [DVec3::ZERO, DVec3::X, DVec3::Y], d: [DVec3::Z, DVec3::ZERO, DVec3::ZERO], h: [1.0, 0.0, 0.0] };
    let v = Reference::build(mesh).verdict(&[b], t_range);
    (v.safe, v.candidates, v.may_miss)
}

#[test]
fn an_edge_matters_within_a_sixteenth_pixel_and_not_beyond() {
    for (half, safe) in [(0.0626, true), (0.0624, false), (10.0, true)] {
        assert_eq!(verdict(&square(2.0, half), FORWARD), (safe, vec![0], !safe));
        let beside = Mesh {
            positions: square(2.0, 1.0).positions.iter().map(|v| *v + DVec3::X * (1.0 + half)).collect(),
            ..square(2.0, 1.0)
        };
        let candidates = if safe { vec![] } else { vec![0] };
        assert_eq!(verdict(&beside, FORWARD), (safe, candidates, true));
    }
}

#[test]
fn depths_tie_under_a_relative_gap_of_a_millionth() {
    let front = square(2.0, 5.0);
    for (gap, safe) in [(1.1e-6, true), (0.9e-6, false), (1.0, true)] {
        let candidates = if safe { vec![0] } else { vec![0, 1] };
        assert_eq!(verdict(&both(front.clone(), &square(2.0 * (1.0 + gap), 5.0)), FORWARD), (safe, candidates, false));
    }
    // Steep planes of the same slope: their depths overlap over the box, but never at one ray.
    let tilt = |z: f64| {
        let mut m = square(z, 5.0);
        m.positions.iter_mut().for_each(|v| v.z += 3.0 * v.x);
        m
    };
    assert_eq!(verdict(&both(tilt(20.0), &tilt(20.1)), FORWARD), (true, vec![0], false));
}

#[test]
fn the_ends_of_the_range_make_a_pixel_unsafe_only_where_they_are_met() {
    let mut tilted = square(2.0, 5.0);
    tilted.positions.iter_mut().for_each(|v| v.z += v.x);
    for (end, safe, ids) in [(2.1, true, vec![0]), (2.01, false, vec![0]), (1.99, false, vec![0]), (1.9, true, vec![])]
    {
        let covered = safe && !ids.is_empty();
        assert_eq!(verdict(&tilted, [0.0, end]), (safe, ids, !covered), "{end}");
    }
}

#[test]
fn twins_count_once_and_backs_of_one_sided_ones_not_at_all() {
    let mut twins = both(square(2.0, 5.0), &square(2.0, 5.0));
    assert_eq!(verdict(&twins, FORWARD), (true, vec![0], false));
    // N is +z as the ray: a one-sided triangle shows its back.
    twins.materials.push(crate::geometry::mesh::Material { two_sided: false, ..Default::default() });
    twins.material_of = vec![1, 0];
    assert_eq!(verdict(&twins, FORWARD), (true, vec![1], false));
    twins.material_of = vec![1, 1];
    assert_eq!(verdict(&twins, FORWARD), (true, vec![], true));
    // Flipped to show their fronts, the lower one hides the higher.
    twins.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    assert_eq!(verdict(&twins, FORWARD), (true, vec![0], false));
    // Small enough that every edge passes within the box, a back is still no candidate.
    let mut speck = square(2.0, 0.01);
    speck.materials[0].two_sided = false;
    assert_eq!(verdict(&speck, FORWARD), (true, vec![], true));
    speck.triangles[0].swap(1, 2);
    assert_eq!(verdict(&speck, FORWARD), (false, vec![0], true));
}

#[test]
fn triangles_that_join_leave_no_miss() {
    let rim = |k: u32| {
        let a = f64::from(k) * 1.1 + 0.2;
        DVec3::new(a.cos(), a.sin(), 2.0 + 0.3 * (3.0 * a).sin())
    };
    let mut positions = vec![DVec3::new(0.01, -0.02, 2.0)];
    positions.extend((0..6).map(rim));
    let fan: Vec<[u32; 3]> = (0..6).map(|k| [0, k + 1, (k + 1) % 6 + 1]).collect();
    let whole = mesh(positions.clone(), fan.clone());
    let (safe, candidates, may_miss) = verdict(&whole, FORWARD);
    assert_eq!((safe, candidates, may_miss), (false, (0..6).collect(), false));
    // The same with one triangle flipped about is not proven, with one left out not true.
    let (_, _, open) = verdict(&mesh(positions.clone(), fan[1..].to_vec()), FORWARD);
    assert!(open);
    // A range that ends within the fan.
    let (_, _, may_miss) = verdict(&whole, [0.0, 2.0]);
    assert!(may_miss);
    // One-sided: seen from the front it covers, from the back it is not there.
    for (flip, seen) in [(true, true), (false, false)] {
        let flipped = fan.iter().map(|t| if flip { [t[0], t[2], t[1]] } else { *t }).collect();
        let mut one_sided = mesh(positions.clone(), flipped);
        one_sided.materials[0].two_sided = false;
        let (_, candidates, may_miss) = verdict(&one_sided, FORWARD);
        assert_eq!((candidates.len(), may_miss), (if seen { 6 } else { 0 }, !seen));
    }
}

#[test]
fn pieces_must_agree() {
    let two = both(square(2.0, 5.0), &square(3.0, 500.0));
    let reference = Reference::build(&two);
    let there = ray(DVec3::ZERO, DVec3::Z);
    let elsewhere = ray(DVec3::new(100.0, 0.0, 0.0), DVec3::Z);
    let v = reference.verdict(&[there, there], FORWARD);
    assert!(v.safe && v.candidates == [0]);
    let v = reference.verdict(&[there, elsewhere], FORWARD);
    assert!(!v.safe && v.candidates == [0, 1] && !v.may_miss);
    assert_eq!(v.hit.map(|h| h.triangle), Some(0));
    assert!(reference.verdict(&[], FORWARD).safe);
}

#[test]
fn nearly_all_pixels_beside_edges_of_a_closed_sphere_are_proven_not_to_miss() {
    let sphere = icosphere(2, DVec3::ZERO);
    let (mut unsafe_px, mut proven) = (0, 0);
    let mut rng = Rng(5);
    for _ in 0..4000 {
        // Within the disc of the sphere: no silhouette, all edges inner ones.
        let eye = rng.direction() * 3.0;
        let x = eye.normalize().any_orthonormal_vector();
        let y = eye.normalize().cross(x);
        let d = -eye + 0.5 * (x * rng.signed() + y * rng.signed());
        let b = Bundle { p: [eye, x * 0.01, DVec3::ZERO], d: [d, x * 0.01, y * 0.02], h: [1.0, 0.0, 0.0] };
        let (safe, covered) = check(&sphere, &b, FORWARD).unwrap();
        unsafe_px += usize::from(!safe);
        proven += usize::from(!safe && covered);
    }
    assert!(unsafe_px > 20 && unsafe_px < 400, "{unsafe_px} of 4000 unsafe");
    assert!(proven * 100 >= unsafe_px * 95, "{proven} of {unsafe_px} proven");
}
