//! The reference's rays against the camera's: two independent methods.

use crate::camera::calibration::{Coefficients, Model, Projection};
use crate::camera::kinds::calibrated::lens::Lens;
use crate::reference::lens::{self, brown};
use crate::testing::Rng;
use glam::{DVec2, DVec3};

/// Largest sizes of k1, k2, k3, of k4 to k6, of p1 and p2, of s1 to s4, and of the tilt.
const KINDS: [[f64; 5]; 7] = [
    [0.5, 0.0, 0.0, 0.0, 0.0],
    [0.5, 0.3, 0.0, 0.0, 0.0],
    [0.5, 0.0, 0.005, 0.0, 0.0],
    [0.5, 0.0, 0.05, 0.0, 0.0],
    [0.5, 0.3, 0.005, 0.0, 0.0],
    [0.5, 0.3, 0.005, 0.02, 0.0],
    [0.5, 0.3, 0.05, 0.02, 0.3],
];

fn lens(rng: &mut Rng, [radial, rational, tangential, prism, tilt]: [f64; 5]) -> [f64; 14] {
    let sizes = [
        radial,
        0.6 * radial,
        tangential,
        tangential,
        0.2 * radial,
        rational,
        0.7 * rational,
        0.3 * rational,
        prism,
        prism,
        prism,
        prism,
        tilt,
        tilt,
    ];
    sizes.map(|size| size * rng.signed())
}

/// Places up to 1.3 to the side, far beyond most pictures.
fn places() -> impl Iterator<Item = DVec2> {
    (0..24).flat_map(|j| (0..32).map(move |i| DVec2::new(f64::from(i) - 15.4, f64::from(j) - 11.3) / 12.0))
}

/// Where the direction is seen, x and y with their derivatives, and whether it lies behind a pole.
fn seen(k: &[f64; 14], d: DVec3) -> ([[f64; 3]; 2], bool) {
    let on_side = |side: f64| brown::seen(&Coefficients::of_opencv(k), side, [d.x, d.y]);
    let (place, is_behind) = on_side(1.0).map_or_else(|| (on_side(-1.0), true), |place| (Some(place), false));
    (place.unwrap().map(|d| [d.value, d.rate.x, d.rate.y]), is_behind)
}

#[test]
fn both_methods_find_the_same_rays() {
    let mut rng = Rng(11);
    let (mut with, mut without) = (0, 0);
    for (kind, sizes) in KINDS.iter().enumerate() {
        for number in 0..15 {
            let k = lens(&mut rng, *sizes);
            let (model, name) = (Model::brown(&k), format!("{kind}, lens {number}: {k:?}"));
            let camera = Lens::new(&model).unwrap();
            let reference = lens::Lens::new(&model);
            for q in places() {
                let (a, b) = (camera.direction(q), reference.direction(q));
                assert_eq!(a.is_some(), b.is_some(), "{name}: {q}: {a:?} {b:?}");
                let (Some(a), Some(b)) = (a, b) else {
                    without += 1;
                    continue;
                };
                with += 1;
                let [u, v] = seen(&k, a).0;
                let off = DVec2::new(u[0], v[0]).distance(q);
                // 1e-9 px in a picture of 1000 px are 1e-12; this is under a fiftieth of that
                assert!(off <= 1e-15 * (1.0 + q.length()) * 16.0, "{name}: {q} is seen off by {off}");
                // the rounding of the place over the smallest stretch, and of the ray itself
                let determinant = u[1] * v[2] - u[2] * v[1];
                let tolerance = 1e-14 * (1.0 + a.length()) * (1.0 + determinant.recip());
                assert!((a - b).length() <= tolerance, "{name}: {q}: {a} {b}, determinant {determinant}");
                let back = camera.places(3.0 * a).unwrap();
                let [(place, t)] = back[..] else { panic!("{name}: {q}: {back:?}") };
                // the ray's rounding, times the largest stretch
                let stretch = [u, v].iter().map(|d| d[1].hypot(d[2])).sum::<f64>();
                assert!(
                    place.distance(q) <= 1e-15 * (1.0 + a.length()) * (4.0 + stretch) && t == 3.0,
                    "{name}: {q}: {back:?}"
                );
            }
        }
    }
    assert!(with > 38_000 && without > 11_000, "{with} {without}");
}

/// Lenses with a pole of the radial part that a zero cancels: a factory's calibration, the same with numerator and denominator exchanged,
/// and two fits of noisy pictures of a board by OpenCV.
const CANCELED: [[f64; 8]; 4] = [
    [-4.093396, 9.190781, 0.001254, -0.001030, -8.917245, -4.187956, 9.556831, -9.303533],
    [-4.187956, 9.556831, 0.001254, -0.001030, -9.303533, -4.093396, 9.190781, -8.917245],
    [-0.786736, 0.267539, -0.000870, -0.001802, -0.191839, -0.668827, 0.084596, -0.122923],
    [0.276439, -1.007178, -0.001603, -0.000955, 0.209220, 0.192727, -1.171442, 0.376356],
];

#[test]
fn both_methods_find_the_same_rays_behind_poles_that_cancel() {
    let mut with = [0, 0];
    for first in CANCELED {
        for (tangential, tilt) in [(1.0, 0.0), (0.0, 0.0), (-3.0, 0.0), (1.0, 0.1)] {
            let mut k = [0.0; 14];
            k[..8].copy_from_slice(&first);
            (k[2], k[3], k[12], k[13]) = (tangential * first[2], tangential * first[3], tilt, -0.5 * tilt);
            let model = Model::brown(&k);
            let (camera, reference) = (Lens::new(&model).unwrap(), lens::Lens::new(&model));
            for q in places() {
                let (a, b) = (camera.direction(q), reference.direction(q));
                assert_eq!(a.is_some(), b.is_some(), "{k:?}: {q}: {a:?} {b:?}");
                let (Some(a), Some(b)) = (a, b) else { continue };
                let ([u, v], is_behind) = seen(&k, a);
                with[usize::from(is_behind)] += 1;
                // the rounding of the place, whose terms are a hundred times larger than their sum, over the smallest stretch
                let determinant = u[1] * v[2] - u[2] * v[1];
                assert!(DVec2::new(u[0], v[0]).distance(q) <= 1e-13, "{k:?}: {q} from {a}");
                assert!((a - b).length() <= 1e-12 * (1.0 + determinant.recip()), "{k:?}: {q}: {a} {b}");
            }
        }
    }
    assert!(with[0] > 3000 && with[1] > 2000, "{with:?}");
}

/// Random lenses, whose pole and zero are between a thousandth and a billionth of the pole's square apart.
#[test]
fn both_methods_find_the_same_rays_behind_random_poles() {
    let mut rng = Rng(77);
    let mut behind = 0;
    for number in 0..120 {
        let pole = 0.2 + 1.5 * rng.unit();
        let zero = pole * (1.0 + rng.signed().signum() * 10f64.powf(-3.0 - 6.0 * rng.unit()));
        let [a1, a2, b1] = [0.4, 0.1, 0.3].map(|size| size * rng.signed());
        let [p1, p2] = [0.002, 0.002].map(|size| size * rng.signed() * f64::from(number % 2));
        // A = (1 - q / zero) (1 + a1 q + a2 q^2), B = (1 - q / pole) (1 + b1 q)
        let k = [a1 - zero.recip(), a2 - a1 / zero, p1, p2, -a2 / zero, b1 - pole.recip(), -b1 / pole];
        let model = Model::brown(&k);
        let (camera, reference) = (Lens::new(&model).unwrap(), lens::Lens::new(&model));
        for place in 0..40 {
            let q = (0.05 + 1.6 * rng.unit()) * DVec2::from_angle(2.4 * f64::from(place));
            let (a, b) = (camera.direction(q), reference.direction(q));
            assert_eq!(a.is_some(), b.is_some(), "{number}: {k:?}: {q}: {a:?} {b:?}");
            let (Some(a), Some(b)) = (a, b) else { continue };
            behind += usize::from(a.truncate().length_squared() > pole);
            // the terms of both polynomials are up to a billion times larger than these near the pole
            assert!((a - b).length() <= 1e-11, "{number}: {k:?}: {q}: {a} {b}");
        }
    }
    assert!(behind > 1000, "{behind}");
}

#[test]
fn both_methods_find_the_same_fisheye() {
    let (mut rng, mut missing) = (Rng(5), 0);
    for _ in 0..40 {
        let k = [0.2, 0.1, 0.05, 0.02].map(|size| size * rng.signed());
        let model = Model::fisheye(&k);
        let camera = Lens::new(&model).unwrap();
        let reference = lens::Lens::new(&model);
        for q in places().map(|q| 3.0 * q) {
            let (a, b) = (camera.direction(q), reference.direction(q));
            assert_eq!(a.is_some(), b.is_some(), "{k:?}: {q}: {a:?} {b:?}");
            let (Some(a), Some(b)) = (a, b) else {
                missing += 1;
                continue;
            };
            let theta = a.truncate().length().atan2(a.z);
            let slope = 1.0
                + [0, 1, 2, 3].map(|n| (2 * n + 3) as f64 * k[n] * theta.powi(2 * n as i32 + 2)).iter().sum::<f64>();
            assert!((a - b).length() <= 1e-13 * (1.0 + slope.recip()), "{k:?}: {q}: {a} {b}");
            let back = camera.places(2.0 * a).unwrap();
            assert!(
                back.iter().any(|(place, t)| place.distance(q) <= 1e-12 && (t - 2.0).abs() < 1e-15),
                "{k:?}: {q}: {back:?}"
            );
        }
    }
    assert!(missing > 1000, "{missing}");
}

/// Random projections of each kind, also at the ends of their ranges and near them.
fn projections(rng: &mut Rng) -> Vec<Projection> {
    let unit = |rng: &mut Rng| 0.5 + 0.5 * rng.signed();
    // over pixels of a focal length of some 1
    let polynomial = |rng: &mut Rng| [0.3, 0.1, 0.05, 0.02].map(|size| size * rng.signed());
    let c = |rng: &mut Rng| [0.6 + unit(rng)].into_iter().chain(polynomial(rng)).collect::<Vec<_>>();
    vec![
        Projection::Perspective,
        Projection::Equidistant,
        Projection::Equirectangular,
        Projection::FieldOfView { omega: 3.0 * unit(rng) + 0.01 },
        Projection::Unified { xi: 0.0 },
        Projection::Unified { xi: 1.0 },
        Projection::Unified { xi: 3.0 * unit(rng) },
        Projection::Unified { xi: 1e6 * unit(rng) },
        Projection::EnhancedUnified { alpha: 0.0, beta: 1.0 },
        Projection::EnhancedUnified { alpha: 0.5, beta: 0.3 + unit(rng) },
        Projection::EnhancedUnified { alpha: 1.0, beta: 0.3 + unit(rng) },
        Projection::EnhancedUnified { alpha: unit(rng), beta: 0.3 + 2.0 * unit(rng) },
        Projection::DoubleSphere { xi: rng.signed(), alpha: 0.0 },
        Projection::DoubleSphere { xi: 1.0, alpha: unit(rng) },
        Projection::DoubleSphere { xi: 0.0, alpha: unit(rng) },
        Projection::DoubleSphere { xi: 0.95 * rng.signed(), alpha: unit(rng) },
        Projection::DoubleSphere { xi: 0.0, alpha: 1.0 },
        Projection::Division { k: 0.4 * rng.signed() },
        Projection::Division { k: 0.0 },
        Projection::AngleOfRadius { c: c(rng) },
        Projection::RadiusOfAngle { c: c(rng) },
        Projection::HeightOfRadius { c: c(rng) },
        Projection::HeightOfRadius { c: vec![0.6 + unit(rng)] },
    ]
}

/// The camera by closed forms or Newton's method, the reference by bisection of the forward formulas; and the camera's way back.
#[test]
fn both_methods_find_the_same_rays_of_every_projection() {
    let mut rng = Rng(23);
    let (mut with, mut without, mut behind) = (0, 0, 0);
    for _ in 0..60 {
        for projection in projections(&mut rng) {
            let model = Model { projection, distortions: Vec::new() };
            let name = format!("{:?}", model.projection);
            let camera = Lens::new(&model).unwrap();
            let reference = lens::Lens::new(&model);
            for q in places().map(|q| 2.5 * q) {
                let (a, b) = (camera.direction(q), reference.direction(q));
                assert_eq!(a.is_some(), b.is_some(), "{name}: {q}: {a:?} {b:?}");
                let (Some(a), Some(b)) = (a, b) else {
                    without += 1;
                    continue;
                };
                with += 1;
                behind += u32::from(a.z < 0.0);
                // how far the ray moves for a rounding of the place: by a difference quotient
                let h = 1e-6 * (1.0 + q.length());
                let beside = |s: f64| camera.direction(q * (1.0 + s * h / q.length()));
                let (Some(less), Some(more)) = (beside(-1.0), beside(1.0)) else { continue };
                let steep = (more - less).length() / (2.0 * h);
                let tolerance = 1e-14 * (1.0 + a.length()) * (1.0 + steep * q.length());
                assert!((a - b).length() <= tolerance, "{name}: {q}: {a} {b}, {steep}");
                let back = camera.places(2.0 * a).unwrap();
                // of the ray's rounding the place moves by the inverse
                let tolerance = 1e-14 * (1.0 + q.length()) * (1.0 + a.length() / steep);
                let found = back.iter().any(|(place, t)| place.distance(q) <= tolerance && (t - 2.0).abs() < 1e-14);
                assert!(found, "{name}: {q}: {back:?}, {steep}");
            }
        }
    }
    assert!(with > 400_000 && without > 100_000 && behind > 50_000, "{with} {without} {behind}");
}

#[test]
#[ignore = "slow: make test-all"]
fn both_methods_find_the_same_rays_through_two_distortions() {
    let (mut rng, mut with) = (Rng(31), 0);
    for _ in 0..3 {
        let radial = Coefficients::radial(&[0.05, 0.02, 0.01, 0.004, 0.002, 0.001].map(|size| size * rng.signed()));
        let then = Coefficients::of_opencv(&lens(&mut rng, [0.0, 0.0, 0.005, 0.005, 0.0]));
        let thin_prism = Coefficients { radial: radial.radial, ..then };
        for distortions in [vec![radial, then], vec![thin_prism]] {
            let model = Model { projection: Projection::Equidistant, distortions };
            let camera = Lens::new(&model).unwrap();
            let reference = lens::Lens::new(&model);
            for q in places() {
                let (a, b) = (camera.direction(q), reference.direction(q));
                assert_eq!(a.is_some(), b.is_some(), "{model:?}: {q}: {a:?} {b:?}");
                let (Some(a), Some(b)) = (a, b) else { continue };
                with += 1;
                // the coefficients are so small that no stretch is under 1/10
                assert!((a - b).length() <= 1e-13, "{model:?}: {q}: {a} {b}");
                let back = camera.places(a).unwrap();
                assert!(back.iter().any(|(place, t)| place.distance(q) <= 1e-13 && (t - 1.0).abs() < 1e-14), "{q}");
            }
        }
    }
    assert!(with > 3_700, "{with}");
}

/// At a fold of alpha = 1 the height on the sphere is 0 / 0, and close to xi = 1 the end of the branch rounds beyond 180 degrees.
#[test]
fn ends_of_branches_are_finite_rays_in_both_methods() {
    let near_one = Projection::DoubleSphere { xi: 0.999_999_999_999, alpha: 0.508_109_870_465_909_3 };
    for (projection, q) in [
        (Projection::DoubleSphere { xi: 0.0, alpha: 1.0 }, 1.0),
        (Projection::EnhancedUnified { alpha: 1.0, beta: 1.0 }, 1.0),
        (near_one.clone(), 0.5),
        (near_one, 1.9),
    ] {
        let model = Model { projection, distortions: Vec::new() };
        let q = DVec2::X * q;
        for found in [Lens::new(&model).unwrap().direction(q), lens::Lens::new(&model).direction(q)] {
            // at the fold itself a rounding decides whether there is a ray
            assert!(found.is_none_or(|d| (d.length() - 1.0).abs() < 1e-15), "{model:?}: {found:?}");
        }
    }
}

/// Far away det J is small against the square of the place's radius; that is no fold.
#[test]
fn both_methods_find_rays_thousands_of_focal_lengths_away() {
    let mut k = [0.0; 14];
    k[2] = 1e-8;
    let model = Model::brown(&k);
    let camera = Lens::new(&model).unwrap();
    let reference = lens::Lens::new(&model);
    for radius in [100.0, 3000.0, 1e5] {
        let q = radius * DVec2::new(0.6, -0.8);
        let (a, b) = (camera.direction(q), reference.direction(q));
        let (Some(a), Some(b)) = (a, b) else { panic!("{q}: {a:?} {b:?}") };
        // J is almost the identity, so the rays differ by some roundings of the place
        assert!((a - b).length() <= 64.0 * f64::EPSILON * radius, "{q}: {a} {b}");
    }
}

/// Along a straight line from the middle rays change continuously up to the first fold, and end there.
#[test]
fn rays_are_continuous_along_lines_from_the_middle() {
    // the radial part grows everywhere, and the tangential terms fold it at a radius of some 1.2 on one side
    let k = [-0.4095, 0.0777, -0.0080, 0.0038, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    let camera = Lens::new(&Model::brown(&k)).unwrap();
    let mut counts = [0, 0];
    for q in places() {
        let along = |s: f64| camera.direction(s * q).map(|d| d.truncate());
        let steps: Vec<Option<DVec2>> = (0..=100).map(|s| along(f64::from(s) / 100.0)).collect();
        // once beyond a fold, for good
        let end = steps.iter().position(Option::is_none).unwrap_or(steps.len());
        assert!(steps[end..].iter().all(Option::is_none), "{q}");
        // and up to it without a jump, however fast the ray moves near a fold
        for (n, pair) in steps[..end].windows(2).enumerate() {
            let mut parts = vec![[(n as f64 / 100.0, pair[0].unwrap()), ((n + 1) as f64 / 100.0, pair[1].unwrap())]];
            while let Some([a, b]) = parts.pop() {
                if a.1.distance(b.1) > 0.01 {
                    assert!(b.0 - a.0 > 1e-9, "{q}: {} and {} at {}", a.1, b.1, a.0);
                    let middle = 0.5 * (a.0 + b.0);
                    let between = (middle, along(middle).unwrap());
                    parts.extend([[a, between], [between, b]]);
                }
            }
        }
        counts[usize::from(end == steps.len())] += 1;
    }
    assert!(counts.iter().all(|n| *n > 50), "{counts:?}");
}
