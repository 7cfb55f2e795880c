//! Curves against dense samples, against rays, against surfaces with known roots; whole findings.

use super::make::{icosphere, mesh, soup};
use crate::camera::curve::{Curve, CurveMap, Curves};
use crate::camera::{Bundle, Camera, Rays};
use crate::geometry::mesh::Mesh;
use crate::reference::curve::meetings;
use crate::reference::intersect::Corners;
use crate::reference::{Finding, Hit, Path, Reference, Seen, Segment};
use crate::testing::Rng;
use glam::DVec3;
use std::sync::Arc;

fn first(reference: &Reference, curve: Curve) -> Option<Hit> {
    reference.first(&Path::through(&[Segment::Curved(curve)])).map(|s| s.hit)
}

fn random_curve(rng: &mut Rng) -> Curve {
    let points = [0; 4].map(|_| 1.5 * rng.vector());
    Curve::new(&points[..2 + rng.below(3)])
}

/// The place that the weights of a hit stand for.
fn on_triangle(v: [DVec3; 3], [u, v2]: [f64; 2]) -> DVec3 {
    v[0] * (1.0 - u - v2) + v[1] * u + v[2] * v2
}

/// How far a meeting may lie from the curve: the polynomial's rounding over its slope, at least 1e-16 over 1e-6 where a
/// root is not near another one; the bound keeps 100 times that.
const PLACE_ERROR: f64 = 1e-8;

#[test]
fn no_crossing_of_a_random_triangle_is_missed_and_none_is_made_up() {
    let (mut rng, mut counts) = (Rng(1), [0_usize; 4]);
    for case in 0..200_000 {
        let curve = random_curve(&mut rng);
        let v = [0; 3].map(|_| 2.0 * rng.vector());
        let corners = Corners::new(v);
        let found = meetings(&curve, &corners);
        for m in &found {
            let error = (curve.at(m.t) - on_triangle(v, m.bary)).length();
            assert!(
                error < PLACE_ERROR && m.bary.iter().all(|b| (0.0..=1.0).contains(b)),
                "case {case}: {m:?} {error}"
            );
        }
        counts[found.len()] += 1;
        // Dense sampling: each change of side between samples, well inside by chords, is a meeting between them.
        let n = (v[1] - v[0]).cross(v[2] - v[0]);
        let steps = 64;
        let height = |k: i32| n.dot(curve.at(f64::from(k) / f64::from(steps)) - v[0]);
        for k in 0..steps {
            let (a, b) = (height(k), height(k + 1));
            if a * b >= 0.0 || a.abs().min(b.abs()) < 1e-9 {
                continue;
            }
            let (t0, t1) = (f64::from(k) / f64::from(steps), f64::from(k + 1) / f64::from(steps));
            let (p, q) = (curve.at(t0), curve.at(t1));
            // Any place of the curve in between is within this much of the chord.
            let bend = (q - p).length() + 40.0 / f64::from(steps * steps);
            let at = p.lerp(q, a / (a - b));
            let clearance = |i: usize| {
                let e = v[(i + 1) % 3] - v[i];
                n.cross(e).normalize().dot(at - v[i])
            };
            let inside = (0..3).map(clearance).fold(f64::INFINITY, f64::min);
            let there = found.iter().filter(|m| t0 <= m.t && m.t <= t1).count();
            if inside > bend {
                assert_eq!(there % 2, 1, "case {case}: a crossing between {t0} and {t1} is missed: {found:?}");
            } else if inside < -bend {
                assert_eq!(there, 0, "case {case}: no crossing between {t0} and {t1}: {found:?}");
            }
        }
    }
    assert!(counts[1] > 10_000 && counts[2] > 1000 && counts[3] > 20, "{counts:?}");
}

#[test]
fn signs_of_meetings_are_those_of_the_tangent() {
    let mut rng = Rng(2);
    for _ in 0..50_000 {
        let (curve, v) = (random_curve(&mut rng), [rng.vector(), rng.vector(), rng.vector()]);
        let n = (v[1] - v[0]).cross(v[2] - v[0]);
        for m in meetings(&curve, &Corners::new(v)) {
            let slope = curve.tangent(m.t).dot(n);
            assert!(f64::from(m.sign) * slope > 0.0 || slope.abs() < 1e-6);
        }
    }
}

/// No hierarchy.
fn brute_force(mesh: &Mesh, curve: &Curve) -> Option<Hit> {
    let mut best: Option<Hit> = None;
    for (k, t) in mesh.triangles.iter().enumerate() {
        let two_sided = mesh.materials[mesh.material_of[k] as usize].two_sided;
        for m in meetings(curve, &Corners::new(t.map(|i| mesh.positions[i as usize]))) {
            if (two_sided || m.sign < 0) && best.is_none_or(|b| (m.t, k as u32) < (b.t, b.triangle)) {
                best = Some(Hit { t: m.t, triangle: k as u32, bary: m.bary });
            }
        }
    }
    best
}

#[test]
fn the_hierarchy_finds_what_brute_force_finds() {
    let mut hits = 0;
    for seed in 0..300 {
        let mut rng = Rng(seed);
        let centre = rng.vector() * [0.0, 1.0, 1e4][rng.below(3)];
        let (count, size) = (rng.below(300), [2.0, 0.3, 0.05][rng.below(3)]);
        let mesh = soup(&mut rng, count, size, centre);
        let reference = Reference::build(&mesh);
        for _ in 0..20 {
            let points: Vec<DVec3> = random_curve(&mut rng).points().iter().map(|p| *p + centre).collect();
            let curve = Curve::new(&points);
            let found = first(&reference, curve);
            assert_eq!(found, brute_force(&mesh, &curve), "seed {seed}");
            hits += usize::from(found.is_some());
        }
    }
    assert!(hits > 2000, "{hits}");
}

#[test]
fn straight_curves_of_any_degree_see_what_rays_see() {
    let mut hits = 0;
    for seed in 0..400 {
        let mut rng = Rng(seed);
        let mesh = soup(&mut rng, 100, 0.6, DVec3::ZERO);
        let reference = Reference::build(&mesh);
        for _ in 0..20 {
            let (p, q) = (2.0 * rng.vector(), 2.0 * rng.vector());
            let bundle =
                Bundle { p: [p, DVec3::X, DVec3::Y], d: [q - p, DVec3::ZERO, DVec3::ZERO], h: [1.0, 0.0, 0.0] };
            let by_ray = reference.hit(&bundle, [0.0, 1.0]);
            let line = Curve::of_ray(&bundle.ray(0.0, 0.0));
            for degree in 1..=3 {
                let by_curve = first(&reference, line.elevated(degree));
                assert_eq!(by_curve.map(|h| h.triangle), by_ray.map(|h| h.triangle), "seed {seed} degree {degree}");
                let pairs = by_curve.iter().zip(&by_ray);
                pairs.for_each(|(c, r)| {
                    assert!((c.t - r.t).abs() < PLACE_ERROR && (c.bary[0] - r.bary[0]).abs() < 1e-6)
                });
            }
            hits += usize::from(by_ray.is_some());
        }
    }
    assert!(hits > 2000, "{hits}");
}

#[test]
#[ignore = "slow: make test-all"]
fn a_closed_shell_is_left_once_more_than_it_is_entered() {
    let shell = icosphere(2, DVec3::ZERO);
    let corners: Vec<Corners> =
        shell.triangles.iter().map(|t| Corners::new(t.map(|k| shell.positions[k as usize]))).collect();
    let mut rng = Rng(4);
    for case in 0..20_000 {
        // From inside to outside, at random or through a corner or the middle of an edge.
        let t = shell.triangles[rng.below(320)].map(|k| shell.positions[k as usize]);
        let aim = [2.0 * rng.direction(), 1.7 * t[0], 0.8 * (t[0] + t[1])][case % 3];
        let from = 0.3 * rng.vector();
        let line = Curve::new(&[from, from + 3.0 * (aim - from).normalize()]);
        let curve = if case % 2 == 0 { line.elevated(3) } else { Curve::new(&[from, 0.5 * rng.vector(), 2.0 * aim]) };
        let mut found: Vec<_> = corners.iter().flat_map(|c| meetings(&curve, c)).collect();
        found.sort_unstable_by(|a, b| a.t.total_cmp(&b.t));
        assert!(!found.is_empty(), "case {case}: lost between triangles");
        // Both triangles at an edge may have it: one place, counted once.
        found.dedup_by(|b, a| (b.t - a.t).abs() < PLACE_ERROR && a.sign == b.sign);
        let sum: i32 = found.iter().map(|m| i32::from(m.sign)).sum();
        assert_eq!(sum, 1, "case {case}: {found:?}");
    }
}

/// A flat triangle through y = `y`, whose N points down.
fn level(y: f64) -> [DVec3; 3] {
    [DVec3::new(-9.0, y, -9.0), DVec3::new(9.0, y, -9.0), DVec3::new(0.0, y, 9.0)]
}

/// Falls through y = 0.5 at t = 1/4 and rises through it at 3/4.
fn valley() -> Curve {
    // y = 4 (t - 1/2)^2 + 1/4
    Curve::new(&[DVec3::new(-1.0, 1.25, 0.0), DVec3::new(0.0, -0.75, 0.0), DVec3::new(1.0, 1.25, 0.0)])
}

#[test]
fn a_later_root_counts_where_the_first_shows_an_invisible_face() {
    // N . X' > 0 while the curve falls: the back.
    let mut one = mesh(level(0.5).to_vec(), vec![[0, 1, 2]]);
    let t = |m: &Mesh| first(&Reference::build(m), valley()).map(|h| h.t);
    assert_eq!(t(&one), Some(0.25));
    one.materials[0].two_sided = false;
    assert_eq!(t(&one), Some(0.75));
    one.triangles[0].swap(1, 2);
    assert_eq!(t(&one), Some(0.25));
    // A touch shows no face.
    one.positions = level(0.25).to_vec();
    assert_eq!(t(&one), None);
    one.materials[0].two_sided = true;
    assert_eq!(t(&one), Some(0.5));
}

#[test]
fn one_triangle_is_met_three_times() {
    // y = 16 (t - 1/4) (t - 1/2) (t - 3/4)
    let y = [-1.5, 13.0 / 6.0, -13.0 / 6.0, 1.5];
    let points: Vec<DVec3> = y.iter().enumerate().map(|(k, y)| DVec3::new(k as f64 / 3.0, *y, 0.0)).collect();
    let found: Vec<_> =
        meetings(&Curve::new(&points), &Corners::new(level(0.0))).iter().map(|m| (m.t, m.sign)).collect();
    assert_eq!(found.len(), 3);
    for (found, (t, sign)) in found.iter().zip([(0.25, -1), (0.5, 1), (0.75, -1)]) {
        assert!((found.0 - t).abs() < 1e-15 && found.1 == sign, "{found:?}");
    }
}

/// Parabolas side by side: `x` moves each, a quarter a pixel.
#[derive(Debug)]
struct Valleys;

const VALLEYS: u32 = 8;

impl CurveMap for Valleys {
    fn degree(&self) -> usize {
        2
    }

    fn curve(&self, a: f64, b: f64) -> Option<(u32, Curve)> {
        let at = DVec3::new(0.0, (b - 0.5) * 2.0, (a - 0.5) * 2.0);
        let points: Vec<DVec3> = valley().points().iter().map(|p| *p + at).collect();
        Some((u32::from(a > 0.5), Curve::new(&points)))
    }

    fn piece_count(&self) -> usize {
        2
    }
}

fn valleys() -> Camera {
    let curves = Curves::new(VALLEYS, VALLEYS, Arc::new(Valleys));
    Camera::of("projector", (VALLEYS, VALLEYS), [0.0, 1.0], Rays::Curves(curves))
}

fn find(mesh: &Mesh, camera: &Camera, i: u32, j: u32) -> (Finding, Path) {
    let path = Path::of_pixel(camera, i, j);
    (Reference::build(mesh).finding(camera, &path, (i, j)), path)
}

#[test]
fn a_pixel_is_safe_unless_an_edge_a_tie_or_a_touch_is_near() {
    let camera = valleys();
    let ground = mesh(level(0.5).to_vec(), vec![[0, 1, 2]]);
    let (safe, path) = find(&ground, &camera, 3, 3);
    // pixel (3, 3) is moved by (3.5 / 8 - 1/2) 2 = -1/8: 4 (t - 1/2)^2 = 1/4 + 1/8
    let t = 0.5 - 0.375_f64.sqrt() / 2.0;
    let seen = safe.seen.unwrap();
    assert!((seen.t() - t).abs() < 1e-15 && seen.piece == 0 && safe.safe && !safe.may_miss, "{safe:?}");
    assert_eq!(find(&ground, &camera, 4, 3).0.seen.unwrap().piece, 1);
    // Z is the length of the parabola: y' = 8 (t - 1/2), x' = 2, so dy/dx = 2 s with s = 2 t - 1
    let primitive = |s: f64| 0.5 * s * (1.0 + 4.0 * s * s).sqrt() + 0.25 * (2.0 * s).asinh();
    let z = primitive(2.0 * t - 1.0) - primitive(-1.0);
    assert!((path.depth(&seen) - z).abs() < 1e-9 * z, "{} for {z}", path.depth(&seen));
    // An edge at the curves' x within 1/16 px and beyond: pixels are 1/4 apart in z.
    for (off, is_safe) in [(0.06, false), (0.065, true), (-0.06, false), (-0.065, true)] {
        let edge = (3.5 / 8.0 - 0.5) * 2.0 + 0.25 * off;
        let beside = [DVec3::new(-9.0, 0.5, edge), DVec3::new(9.0, 0.5, edge), DVec3::new(0.0, 0.5, 9.0)];
        let finding = find(&mesh(beside.to_vec(), vec![[0, 1, 2]]), &camera, 3, 3).0;
        assert_eq!((finding.safe, finding.may_miss), (is_safe, off > 0.0 || !is_safe), "{off}: {finding:?}");
        assert_eq!(finding.seen.is_some(), off < 0.0);
        assert_eq!(finding.candidates, if is_safe && off > 0.0 { vec![] } else { vec![0] });
    }
    // Two levels: t' = 8 (1/2 - t) moves y, so a gap of g in t is one of g t 8 (1/2 - t) in y.
    let slope = 8.0 * (0.5 - t);
    for (gap, is_safe) in [(1.2e-6, true), (0.8e-6, false)] {
        let mut two = ground.clone();
        two.positions.extend(level(0.5 - gap * t * slope));
        two.triangles.push([3, 4, 5]);
        two.material_of.push(0);
        let finding = find(&two, &camera, 3, 3).0;
        assert_eq!((finding.safe, finding.candidates.len()), (is_safe, if is_safe { 1 } else { 2 }), "{finding:?}");
    }
    // Twins are one surface.
    let mut twins = ground.clone();
    twins.triangles.push([1, 0, 2]);
    twins.material_of.push(0);
    assert!(find(&twins, &camera, 3, 3).0.safe);
    // The lowest place of the valley within 1/16 px (in y) of the ground.
    for (off, is_safe) in [(0.0, false), (0.06, false), (0.065, true), (-0.06, false), (-0.065, true)] {
        let bottom = 0.25 + (3.5 / 8.0 - 0.5) * 2.0 + 0.25 * off;
        let finding = find(&mesh(level(bottom).to_vec(), vec![[0, 1, 2]]), &camera, 3, 3).0;
        assert_eq!(finding.safe, is_safe, "{off}: {finding:?}");
        assert_eq!(finding.may_miss, off < 0.0 || !is_safe, "{off}: {finding:?}");
    }
}

#[test]
fn the_view_is_the_tangent_and_at_a_standstill_the_way_around_it() {
    let curve = valley();
    let segment = Segment::Curved(curve);
    assert_eq!(segment.view(0.25), curve.tangent(0.25).normalize());
    let (p, d) = (DVec3::ONE, DVec3::new(0.6, 0.0, 0.8));
    let starting = Segment::Curved(Curve::new(&[p, p, p, p + d]));
    // the chord over 2^-26 of t: t^3 of it is 2^-78, under the rounding of p; so from the origin
    let from_origin = Segment::Curved(Curve::new(&[DVec3::ZERO, DVec3::ZERO, DVec3::ZERO, d]));
    assert!((from_origin.view(0.0) - d).length() < 1e-15);
    assert!((starting.view(0.5) - d).length() < 1e-15);
    let seen = Seen { layer: 0, piece: 0, hit: Hit { t: 0.5, triangle: 0, bary: [0.0; 2] } };
    assert!((Path::through(&[starting]).depth(&seen) - 0.125).abs() < 1e-10);
}
