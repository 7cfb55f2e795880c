//! Coverage by conics agrees with projection: where an equation that knows nothing of edges says that a point of a
//! triangle is seen, the three edge functions of that image place say so too, at the same t.

use crate::common;

use anamorph::internals::camera::{Bundle, kinds};
use anamorph::internals::reference::Reference;
use common::rng::Rng;
use common::{ALL_T, mesh};
use glam::{DMat3, DVec2, DVec3};

const SIZE: (u32, u32) = (640, 480);
const CASES: u64 = 20_000;

/// An image place (a, b) and the ray parameter at which it sees a point.
#[derive(Debug, Clone, Copy)]
struct Image {
    a: f64,
    b: f64,
    t: f64,
}

type Three = [DVec3; 3];

/// The sweep triangle at t.
fn sweep(near: &Three, far: &Three, t: f64) -> Three {
    [0, 1, 2].map(|k| near[k] + t * (far[k] - near[k]))
}

/// (a, b) of a point in the plane of the triangle `s`, by least squares.
fn place_in(s: &Three, x: DVec3) -> DVec2 {
    let (u, v, w) = (s[1] - s[0], s[2] - s[0], x - s[0]);
    let (uu, uv, vv) = (u.dot(u), u.dot(v), v.dot(v));
    let det = uu * vv - uv * uv;
    DVec2::new((vv * u.dot(w) - uv * v.dot(w)) / det, (uu * v.dot(w) - uv * u.dot(w)) / det)
}

/// The image of a point through a GLC in planes parallel to each other with the normal `n`: the sweep plane that holds
/// the point gives t.
fn project_rational(near: &Three, far: &Three, n: DVec3, x: DVec3) -> Image {
    let t = n.dot(x - near[0]) / n.dot(far[0] - near[0]);
    let q = place_in(&sweep(near, far, t), x);
    Image { a: q.x, b: q.y, t }
}

/// The coefficients of det[A0(t) - X, A1(t) - X, A2(t) - X], constant first.
fn cubic(near: &Three, far: &Three, x: DVec3) -> [f64; 4] {
    let c = near.map(|p| p - x);
    let d = [0, 1, 2].map(|k| far[k] - near[k]);
    let det = |a: DVec3, b: DVec3, c: DVec3| DMat3::from_cols(a, b, c).determinant();
    [
        det(c[0], c[1], c[2]),
        det(d[0], c[1], c[2]) + det(c[0], d[1], c[2]) + det(c[0], c[1], d[2]),
        det(c[0], d[1], d[2]) + det(d[0], c[1], d[2]) + det(d[0], d[1], c[2]),
        det(d[0], d[1], d[2]),
    ]
}

/// All simple real roots: Newton's steps kept inside an interval that holds one sign change, between the places where
/// the slope is 0.
fn real_roots(c: [f64; 4]) -> Vec<f64> {
    let f = |t: f64| c[0] + t * (c[1] + t * (c[2] + t * c[3]));
    let slope = |t: f64| c[1] + t * (2.0 * c[2] + t * 3.0 * c[3]);
    // Cauchy's bound on the size of a root
    let bound = 1.0 + c[..3].iter().fold(0.0f64, |m, v| m.max((v / c[3]).abs()));
    let mut ends = vec![-bound];
    let discriminant = c[2] * c[2] - 3.0 * c[1] * c[3];
    if discriminant > 0.0 {
        let q = -(c[2] + c[2].signum() * discriminant.sqrt());
        let (r, s) = (q / (3.0 * c[3]), c[1] / q);
        ends.extend([r.min(s), r.max(s)]);
    }
    ends.push(bound);
    let mut roots = Vec::new();
    for pair in ends.windows(2) {
        let [mut lo, mut hi] = [pair[0], pair[1]];
        if f(lo).signum() == f(hi).signum() {
            continue;
        }
        let mut t = 0.5 * (lo + hi);
        for _ in 0..200 {
            if f(t).signum() == f(lo).signum() {
                lo = t;
            } else {
                hi = t;
            }
            let newton = t - f(t) / slope(t);
            let next = if lo < newton && newton < hi { newton } else { 0.5 * (lo + hi) };
            if next == t {
                break;
            }
            t = next;
        }
        roots.push(t);
    }
    roots
}

fn project_cubic(near: &Three, far: &Three, x: DVec3) -> Vec<Image> {
    let image = |t: f64| {
        let q = place_in(&sweep(near, far, t), x);
        Image { a: q.x, b: q.y, t }
    };
    real_roots(cubic(near, far, x)).into_iter().map(image).collect()
}

/// E of the edge i -> j on the bundle's central ray.
fn edge(b: &Bundle, vi: DVec3, vj: DVec3) -> f64 {
    let r = b.ray(0.0, 0.0);
    (vi - r.origin).cross(vj - vi).dot(r.direction)
}

/// Relative to the lengths involved, cases closer than this to a slit, an edge-on view or a double root are left out:
/// there the answer magnifies rounding (2^-53) by the inverse, at worst some 1e4^2.
const ILL: f64 = 1e-3;
/// What remains of t's digits: 2^-53 magnified by ILL^-2 and ten operations.
const T_ERROR: f64 = 1e-9;
/// The same for barycentric weights, which go through one more division by an area.
const WEIGHT_ERROR: f64 = 1e-7;

/// Whether the equations are well-conditioned at the image `at` of a point of triangle `v`.
fn is_well_seen(near: &Three, far: &Three, b: &Bundle, v: &Three, at: Image) -> bool {
    let s = sweep(near, far, at.t);
    let (u, w) = (s[1] - s[0], s[2] - s[0]);
    let plane = u.cross(w);
    let r = b.ray(0.0, 0.0);
    let n = (v[1] - v[0]).cross(v[2] - v[0]);
    // the ray through the sweep plane: how t changes with the point
    plane.length() > ILL * u.length_squared().max(w.length_squared())
        && plane.dot(r.direction).abs() > ILL * plane.length() * r.direction.length()
        && n.dot(r.direction).abs() > ILL * n.length() * r.direction.length()
        && n.length() > ILL * (v[1] - v[0]).length_squared().max((v[2] - v[0]).length_squared())
        && at.a.abs().max(at.b.abs()) < 1.0 / ILL
        && at.t.abs() < 1.0 / ILL
}

/// Asserts that the triangle covers the image place, with the weights and the t that put the point there.
fn assert_covered(name: &str, bundle: &Bundle, v: &Three, weights: [f64; 3], at: Image) {
    let b = bundle.recentred((at.a - 0.5) * SIZE.0 as f64, (at.b - 0.5) * SIZE.1 as f64);
    let r = b.ray(0.0, 0.0);
    let n = (v[1] - v[0]).cross(v[2] - v[0]);
    let facing = n.dot(r.direction);
    let e = [edge(&b, v[1], v[2]), edge(&b, v[2], v[0]), edge(&b, v[0], v[1])];
    assert!(e.iter().all(|e| e.signum() == facing.signum()), "{name}: E {e:?}, N.D {facing} at {at:?}");
    for k in 0..3 {
        assert!(
            (e[k] / facing - weights[k]).abs() < WEIGHT_ERROR,
            "{name}: weight {k} is {}, not {}",
            e[k] / facing,
            weights[k]
        );
    }
    let t = n.dot(v[0] - r.origin) / facing;
    let scale = at.t.abs().max(1.0);
    assert!((t - at.t).abs() < T_ERROR * scale, "{name}: t {t}, not {}", at.t);
    let mesh = mesh(v.to_vec(), vec![[0, 1, 2]]);
    let hit = Reference::build(&mesh).hit(&b, ALL_T).unwrap_or_else(|| panic!("{name}: no hit at {at:?}"));
    assert!((hit.t - at.t).abs() < T_ERROR * scale, "{name}: the reference has t {}, not {}", hit.t, at.t);
}

/// A random triangle, and weights of a point well inside.
fn triangle(rng: &mut Rng) -> (Three, [f64; 3]) {
    let v = [2.0 * rng.vector(), 2.0 * rng.vector(), 2.0 * rng.vector()];
    let w = [(); 3].map(|()| 0.05 + rng.unit());
    let sum: f64 = w.iter().sum();
    (v, w.map(|w| w / sum))
}

#[test]
fn parallel_planes_by_the_rational_equation() {
    let mut checked = 0;
    for seed in 0..CASES {
        let mut rng = Rng(seed);
        let n = rng.direction();
        let (e1, e2) = n.any_orthonormal_pair();
        let mut on = |at: f64| [(); 3].map(|()| at * n + 3.0 * rng.signed() * e1 + 3.0 * rng.signed() * e2);
        let (near, far) = (on(2.0), on(-1.5));
        let (v, weights) = triangle(&mut rng);
        let x = (0..3).map(|k| weights[k] * v[k]).sum();
        let at = project_rational(&near, &far, n, x);
        let bundle = kinds::glc::bundle(&near, &far, SIZE.0, SIZE.1).unwrap();
        let centred = bundle.recentred((at.a - 0.5) * SIZE.0 as f64, (at.b - 0.5) * SIZE.1 as f64);
        if is_well_seen(&near, &far, &centred, &v, at) {
            assert_covered(&format!("seed {seed}"), &bundle, &v, weights, at);
            checked += 1;
        }
    }
    println!("{checked} of {CASES} cases are well-conditioned");
    assert!(checked > CASES / 2);
}

#[test]
fn any_planes_by_the_cubic_equation_up_to_three_images() {
    let mut images = [0; 4];
    let mut checked = 0;
    for seed in 0..CASES {
        let mut rng = Rng(seed);
        let mut three = || [3.0 * rng.vector(), 3.0 * rng.vector(), 3.0 * rng.vector()];
        let (near, far) = (three(), three());
        let (v, weights) = triangle(&mut rng);
        let x = (0..3).map(|k| weights[k] * v[k]).sum();
        let bundle = kinds::glc::bundle(&near, &far, SIZE.0, SIZE.1).unwrap();
        let all = project_cubic(&near, &far, x);
        for (k, at) in all.iter().enumerate() {
            let centred = bundle.recentred((at.a - 0.5) * SIZE.0 as f64, (at.b - 0.5) * SIZE.1 as f64);
            let isolated = all.iter().enumerate().all(|(j, o)| j == k || (o.t - at.t).abs() > ILL * (1.0 + at.t.abs()));
            if isolated && is_well_seen(&near, &far, &centred, &v, *at) {
                assert_covered(&format!("seed {seed}, image {k}"), &bundle, &v, weights, *at);
                checked += 1;
            }
        }
        images[all.len()] += 1;
    }
    println!("points by the number of their images {images:?}; {checked} images are well-conditioned");
    assert!(images[1] > 100 && images[3] > 100 && images[0] == 0, "a cubic has one real root or three: {images:?}");
    assert!(checked > CASES / 2);
}

#[test]
fn the_three_edge_functions_sum_to_n_d() {
    for seed in 0..CASES {
        let mut rng = Rng(seed);
        let p = [rng.vector(), rng.vector(), rng.vector()];
        let d = [rng.vector(), rng.vector(), rng.vector()];
        let b = Bundle { p, d, h: [1.0, 0.0, 0.0] }.recentred(3.0 * rng.signed(), 3.0 * rng.signed());
        let (v, _) = triangle(&mut rng);
        let sum = edge(&b, v[0], v[1]) + edge(&b, v[1], v[2]) + edge(&b, v[2], v[0]);
        let n = (v[1] - v[0]).cross(v[2] - v[0]);
        // some 40 roundings of products of three lengths of at most 20
        assert!((sum - n.dot(b.ray(0.0, 0.0).direction)).abs() < 40.0 * f64::EPSILON * 8000.0, "seed {seed}");
    }
}

#[test]
fn a_planted_error_is_seen() {
    let mut rng = Rng(1);
    let (near, far) = (
        [3.0 * rng.vector(), 3.0 * rng.vector(), 3.0 * rng.vector()],
        [3.0 * rng.vector(), 3.0 * rng.vector(), 3.0 * rng.vector()],
    );
    let bundle = kinds::glc::bundle(&near, &far, SIZE.0, SIZE.1).unwrap();
    let (v, weights) = triangle(&mut rng);
    let x = (0..3).map(|k| weights[k] * v[k]).sum();
    let at = project_cubic(&near, &far, x)[0];
    assert_covered("right", &bundle, &v, weights, at);
    // a hundredth of a pixel
    let off = Image { a: at.a + 0.01 / SIZE.0 as f64, ..at };
    let seen = std::panic::catch_unwind(|| assert_covered("off", &bundle, &v, weights, off));
    assert!(seen.is_err());
}
