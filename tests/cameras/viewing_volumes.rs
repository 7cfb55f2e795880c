//! The viewing volumes of Brosz et al. by name: what each promises, by closed forms at known pixels.

use crate::common;

use anamorph::internals::camera::glc::Class;
use anamorph::internals::camera::kinds::pinhole::Pinhole;
use anamorph::internals::camera::spec::CameraKind;
use anamorph::internals::camera::{Camera, Curve, Rays, glc};
use common::{FORWARD, camera, written};
use glam::{DVec2, DVec3};

const SIZE: (u32, u32) = (40, 30);
const ASPECT: f64 = 4.0 / 3.0;

/// Points are sums of some twenty products of numbers up to 10, and angles: 2^-53 each, with a margin for the order of evaluation.
const ROUNDING: f64 = 1e-13;

/// The default viewer: eye (0, 0, 4) looking at the origin, vfov 40.
const EYE: DVec3 = DVec3::new(0.0, 0.0, 4.0);

fn tan20() -> f64 {
    20f64.to_radians().tan()
}

fn load(text: &str) -> Camera {
    written::camera(text, SIZE)
}

fn pixels() -> impl Iterator<Item = (u32, u32)> {
    (0..SIZE.1).flat_map(|j| (0..SIZE.0).map(move |i| (i, j)))
}

/// The pixel's place from the image's middle, y up, in heights of the image.
fn place(i: u32, j: u32) -> DVec2 {
    let (a, b) = ((i as f64 + 0.5) / SIZE.0 as f64, (j as f64 + 0.5) / SIZE.1 as f64);
    DVec2::new((a - 0.5) * ASPECT, 0.5 - b)
}

fn curve(camera: &Camera, i: u32, j: u32) -> Curve {
    camera.curve(0, i, j).unwrap_or_else(|| panic!("no ray at {i},{j}")).1
}

fn close(a: DVec3, b: DVec3) -> bool {
    (a - b).length() <= ROUNDING * (1.0 + a.length())
}

fn is_glc(camera: &Camera) -> bool {
    matches!(&camera.layers[..], [Rays::Pieces(p)] if p.pieces.len() == 1)
}

/// Where the straight ray of the pixel is at a depth from the default viewer.
fn at_depth(camera: &Camera, (i, j): (u32, u32), depth: f64) -> DVec2 {
    let ray = camera.ray(i, j).unwrap();
    let t = (EYE.z - depth - ray.origin.z) / ray.direction.z;
    (ray.origin + t * ray.direction).truncate()
}

#[test]
fn perspective_orthographic_and_inverse_perspective() {
    for c in [1.0, 0.5, 0.0, -1.0] {
        let camera = load(&format!("kind = 'irregular_perspective'\nconvergence = {c:?}"));
        assert!(is_glc(&camera) && camera.t_range == [0.0, 1.0]);
        for (i, j) in pixels() {
            let at_target = place(i, j) * 2.0 * 4.0 * tan20();
            for depth in [0.4, 4.0, 6.0, 8.0] {
                let expected = at_target * (1.0 + c * (depth - 4.0) / 4.0);
                let found = at_depth(&camera, (i, j), depth);
                assert!((found - expected).length() < ROUNDING * 10.0, "{c} at {depth}: {found}, not {expected}");
            }
            let curve = curve(&camera, i, j);
            assert!((curve.points()[0].z - 3.6).abs() < ROUNDING && (curve.points()[1].z + 4.0).abs() < ROUNDING);
        }
    }
    // c = 1 is the pinhole
    let pinhole = CameraKind::new("pinhole", Pinhole { eye: EYE, target: DVec3::ZERO, up: DVec3::Y, vfov: 40.0 });
    let (pinhole, found) = (camera(pinhole, SIZE, FORWARD), load("kind = 'irregular_perspective'\nconvergence = 1"));
    for (i, j) in pixels() {
        let (p, q) = (pinhole.ray(i, j).unwrap(), found.ray(i, j).unwrap());
        assert!(
            close(p.direction.normalize(), q.direction.normalize())
                && (q.origin - EYE).cross(p.direction).length() < ROUNDING
        );
    }
}

#[test]
fn irregular_perspective_is_a_cross_slit_and_differs_by_corner() {
    let camera = load("kind = 'irregular_perspective'");
    let Rays::Pieces(pieces) = &camera.layers[0] else { panic!() };
    let bundle = &pieces.pieces[0].bundle;
    let corner = |x: f64, y: f64, t: f64| {
        let ray = bundle.ray(x * SIZE.0 as f64, y * SIZE.1 as f64);
        ray.origin + t * ray.direction
    };
    let three = |t: f64| [corner(-0.5, -0.5, t), corner(0.5, -0.5, t), corner(-0.5, 0.5, t)];
    let (class, slits) = glc::classify(&three(0.0), &three(1.0));
    assert_eq!(class, Class::CrossSlit);
    // up, rays meet at the eye (depth 0); across at 1 + 0.4 (z - 4) / 4 = 0: depth -6; t = (depth - 0.4) / 7.6
    assert!((slits[0] - -6.4 / 7.6).abs() < 1e-9 && (slits[1] - -0.4 / 7.6).abs() < 1e-9, "{slits:?}");
    let camera = load("kind = 'irregular_perspective'\nconvergence = [[1, 1], [0, 0], [-1, 1], [0.5, 0.5]]");
    assert!(matches!(&camera.layers[..], [Rays::Field(_)]));
    let c = [(1.0, 1.0), (0.0, 0.0), (-1.0, 1.0), (0.5, 0.5)].map(DVec2::from);
    for (i, j) in pixels() {
        let q = place(i, j);
        let (u, v) = (q.x / ASPECT + 0.5, 0.5 - q.y);
        let weights = [(1. - u) * (1. - v), u * (1. - v), (1. - u) * v, u * v];
        let expected: DVec2 = (0..4)
            .map(|k| {
                let corner = DVec2::new([-0.5, 0.5, -0.5, 0.5][k] * ASPECT, [0.5, 0.5, -0.5, -0.5][k]);
                weights[k] * 8.0 * tan20() * corner * (1.0 + c[k] * (7.0 - 4.0) / 4.0)
            })
            .sum();
        assert!((at_depth(&camera, (i, j), 7.0) - expected).length() < 10.0 * ROUNDING);
    }
}

#[test]
fn a_twist_turns_the_far_surface() {
    let turned = |q: DVec2, angle: f64| DVec2::from_angle(angle).rotate(q);
    for (degree, angle) in [(1, 60.0), (1, -250.0), (2, 60.0), (2, -120.0), (3, 90.0), (3, -200.0)] {
        let camera = load(&format!("kind = 'twist'\nangle = {angle:?}\ndegree = {degree}"));
        assert_eq!(is_glc(&camera), degree == 1);
        let theta = f64::to_radians(angle);
        for (i, j) in pixels() {
            let (q, curve) = (2.0 * tan20() * place(i, j), curve(&camera, i, j));
            assert!(close(curve.at(0.0), (2.0 * q).extend(2.0)), "near is not turned");
            assert!(close(curve.at(1.0), (6.0 * turned(q, theta)).extend(-2.0)), "far is turned by the angle");
            // along the axis all go evenly
            assert!((curve.at(0.3).z - (2.0 - 0.3 * 4.0)).abs() < ROUNDING);
            // half-way they are turned by half the angle, as far from the axis as the degree says
            let half = curve.at(0.5).truncate();
            let (c, s) = ((theta / 2.0).cos(), (theta / 2.0).sin());
            let (radius, sideways) = match degree {
                // the mean of q r(0) and q r(theta), with radii of 2 and 6
                1 => (4.0 * c, 2.0 * s),
                // quarter, half, quarter, the middle one at 4 / cos
                2 => (0.5 * 4.0 * c + 0.5 * 4.0 / c, 0.25 * 4.0 * s),
                _ => {
                    // eighths 1 3 3 1 of radii 2, 10/3, 14/3, 6; the legs bring the middle ones to within theta / 2
                    let leg = 4.0 / 3.0 * (theta / 4.0).tan();
                    let (r1, r2) = (10.0 / 3.0, 14.0 / 3.0);
                    let radius = (2.0 + 6.0) * c / 8.0 + 3.0 * (r1 + r2) * (c + leg * s) / 8.0;
                    (radius, (6.0 - 2.0) * s / 8.0 + 3.0 * (r2 - r1) * (s - leg * c) / 8.0)
                }
            };
            let expected = turned(radius * q + sideways * q.perp(), theta / 2.0);
            assert!((half - expected).length() < 10.0 * ROUNDING, "degree {degree}: {half}, not {expected}");
        }
    }
}

#[test]
fn curved_convergence_bows_sideways_and_returns() {
    let camera = load("kind = 'curved_convergence'\nbend = [0.5, -0.25]");
    for (i, j) in pixels() {
        let (q, curve) = (2.0 * tan20() * place(i, j), curve(&camera, i, j));
        assert_eq!(curve.degree(), 2);
        // near 0.4, far 12, half-way 6.2: the pinhole's depths, moved sideways by 2 t (1 - t) of the bend
        for t in [0.0, 0.25, 0.5, 1.0] {
            let depth = 0.4 + t * 11.6;
            let shift = 2.0 * t * (1.0 - t) * 2.0 * 6.2 * tan20() * DVec2::new(0.5, -0.25);
            assert!(close(curve.at(t), (depth * q + shift).extend(4.0 - depth)));
        }
    }
}

#[test]
fn orthographic_turns_into_perspective() {
    let camera = load("kind = 'ortho_to_perspective'");
    for (i, j) in pixels() {
        let (q, curve) = (2.0 * tan20() * place(i, j), curve(&camera, i, j));
        assert!(
            close(curve.at(0.0), EYE + (4.0 * q).extend(0.0)) && close(curve.at(1.0), EYE + (12.0 * q).extend(-12.0))
        );
        // starts along the view, ends along the pinhole's ray
        assert!(curve.tangent(0.0).cross(DVec3::Z).length() < 10.0 * ROUNDING);
        assert!(curve.tangent(1.0).cross(curve.at(1.0) - EYE).length() < 200.0 * ROUNDING);
        assert!(curve.tangent(0.0).z < 0.0 && curve.tangent(1.0).z < 0.0);
    }
    let parallel = load("kind = 'ortho_to_perspective'\nblend = 0");
    let mixed = load("kind = 'ortho_to_perspective'\nblend = [[0, 1], [0.5, 0.25]]");
    for (i, j) in pixels() {
        let q = 2.0 * tan20() * place(i, j);
        for t in [0.0, 0.4, 1.0] {
            assert!(close(curve(&parallel, i, j).at(t), (4.0 * q).extend(curve(&parallel, i, j).at(t).z)));
        }
        let (u, v) = (place(i, j).x / ASPECT + 0.5, 0.5 - place(i, j).y);
        let blend = u * (1.0 - v) + 0.5 * (1.0 - u) * v + 0.25 * u * v;
        assert!(close(curve(&mixed, i, j).at(1.0), EYE + ((4.0 + 8.0 * blend) * q).extend(-12.0)));
    }
}

/// The place of the pinhole's image (heights, y up) of a point before the default viewer.
fn seen(p: DVec3) -> DVec2 {
    let from_eye = p - EYE;
    from_eye.truncate() / (-from_eye.z * 2.0 * tan20())
}

#[test]
fn an_occlusion_camera_looks_behind_the_silhouette() {
    let camera = load("kind = 'occlusion'\nend = 10");
    assert_eq!((camera.layers.len(), camera.t_range), (3, [0.0, 1.0]));
    let curve_of = |layer: usize, i: u32, j: u32| camera.curve(layer, i, j).unwrap().1;
    for (i, j) in pixels() {
        let q = place(i, j);
        // what the pixel shows at a depth is drawn to the middle by d, and to the middle itself where that is nearer
        let drawn = |d: f64| if q.length() > d { q - d * q.normalize() } else { DVec2::ZERO };
        let [first, second, third] = [0, 1, 2].map(|layer| curve_of(layer, i, j));
        assert!(close(first.at(0.0), EYE) && (seen(first.at(0.7)) - q).length() < 10.0 * ROUNDING);
        for (one, next) in [(&first, &second), (&second, &third)] {
            assert!(close(one.at(1.0), next.at(0.0)), "the segments join");
        }
        assert!(second.at(0.0).z.abs() < ROUNDING && (second.at(1.0).z + 2.0).abs() < ROUNDING);
        if q.length() > 0.15 {
            // between the planes at 4 and 6 d is linear in 1/z, here at z = 5
            let d = 0.15 * (1.0 / 4.0 - 1.0 / 5.0) / (1.0 / 4.0 - 1.0 / 6.0);
            assert!((seen(second.at(0.5)) - drawn(d)).length() < 10.0 * ROUNDING);
        }
        for t in [0.0, 0.5, 1.0] {
            assert!((seen(third.at(t)) - drawn(0.15)).length() < 10.0 * ROUNDING);
        }
        assert!((third.at(1.0).z + 6.0).abs() < 10.0 * ROUNDING);
    }
    // a sphere about the target hides this point from the pinhole; the camera shows it beside the silhouette
    let hidden = DVec3::new(1.3, 0.0, -4.0);
    let (sine, reach) = (1.0 / 4.0, hidden - EYE);
    assert!(reach.normalize().truncate().length() < sine && reach.length() > 4.0, "behind the sphere");
    let at = seen(hidden) + DVec2::new(0.15, 0.0);
    assert!(at.x * 2.0 * tan20() > sine / (1.0 - sine * sine).sqrt(), "outside the silhouette");
    let pixel = (((at.x / ASPECT + 0.5) * 40.0) as u32, 15);
    let ray = curve_of(2, pixel.0, pixel.1);
    let t = 2.0 / 4.0;
    // a pixel is 1/30 high and wide, at the depth 8 that is 0.19: the point lies within one of the pixel's ray
    assert!((ray.at(t) - hidden).length() < 1.0 / 30.0 * 8.0 * 2.0 * tan20(), "{} {hidden}", ray.at(t));
}

#[test]
fn an_occlusion_cameras_pole_and_near_distortion() {
    let camera = load("kind = 'occlusion'\npole = [0.25, 0.75]\ndistortion = [0.05, 0.2]\njoin = 'bezier'");
    assert!(matches!(&camera.layers[..], [Rays::Curves(c)] if c.map.degree() == 3));
    let pole = DVec2::new(-0.25 * ASPECT, -0.25);
    for (i, j) in pixels() {
        let (q, points) = (place(i, j), curve(&camera, i, j));
        let away = q - pole;
        for (k, d) in [(1, 0.05), (2, 0.2), (3, 0.2)] {
            let expected = if away.length() > d { q - d * away.normalize() } else { pole };
            assert!((seen(points.points()[k]) - expected).length() < 10.0 * ROUNDING);
        }
        assert!(close(points.points()[0], EYE));
    }
}

#[test]
fn a_street_is_a_pushbroom_until_it_has_views() {
    let plain = load("kind = 'street'");
    assert!(is_glc(&plain));
    let looking = load("kind = 'street'\nviews = [{ at = 0.3, width = 0.4, angle = 80, turn = 10 }]");
    for (i, j) in pixels() {
        let q = place(i, j);
        // the facades, 3 away and 4 along the walk, have the image's aspect: 4 wide, 3 high
        let at_facade = DVec3::new(4.0 * q.x / ASPECT, 3.0 * q.y, 1.0);
        let start = DVec3::new(4.0 * q.x / ASPECT, 0.0, 4.0);
        let straight = curve(&plain, i, j);
        assert!(close(straight.at(0.0), start) && close(straight.at(1.0 / 3.0), at_facade));
        let curve = curve(&looking, i, j);
        assert!(close(curve.points()[0], start) && close(curve.points()[1], at_facade));
        let moved = curve.points()[2] - straight.at(1.0);
        assert!(moved.truncate().y.abs().max(moved.z.abs()) < 10.0 * ROUNDING, "only along the street");
        let a = q.x / ASPECT + 0.5;
        let offset = 2.0 * (a - 0.3) / 0.4;
        let share = (1.0 - offset * offset).max(0.0).powi(2);
        let expected = share * 6.0 * (10f64 + offset.clamp(-1.0, 1.0) * 40.0).to_radians().tan();
        // the spline smooths over its knots, 1/40 apart, 1/8 of half a view: by less than that squared of the largest move
        assert!((moved.x - expected).abs() < 6.0 / 64.0, "{a}: {} {expected}", moved.x);
        if offset.abs() > 1.2 {
            assert!(moved.x.abs() < 10.0 * ROUNDING, "the others stay straight");
        }
    }
    // the middle of the view looks turned by 10 degrees: its end goes along (tan 10, -1)
    let middle = curve(&looking, 11, 15);
    let end = middle.tangent(1.0);
    let a = 11.5 / 40.0;
    let expected = 10.0 + 2.0 * (a - 0.3) / 0.4 * 40.0;
    assert!((end.x.atan2(-end.z).to_degrees() - expected).abs() < 1.0, "{end}");
}

#[test]
fn what_is_up_and_to_the_right_is_up_and_to_the_right() {
    for kind in [
        "kind = 'irregular_perspective'",
        "kind = 'irregular_perspective'\nconvergence = [[1, 1], [0, 0], [-1, 1], [0.5, 0.5]]",
        "kind = 'twist'\nangle = 30",
        "kind = 'twist'\nangle = 30\ndegree = 2",
        "kind = 'twist'\nangle = 30\ndegree = 3",
        "kind = 'curved_convergence'",
        "kind = 'ortho_to_perspective'",
        "kind = 'occlusion'\njoin = 'bezier'",
        "kind = 'street'",
        "kind = 'street'\nviews = [{ at = 0.5 }]",
    ] {
        let camera = load(kind);
        let at = |i: u32, j: u32| curve(&camera, i, j).at(0.3);
        let (middle, right, above) = (at(20, 15), at(30, 15), at(20, 5));
        assert!(right.x > middle.x + 0.1 && above.y > middle.y + 0.1, "{kind}: {middle} {right} {above}");
        assert!(curve(&camera, 20, 15).tangent(0.5).z < 0.0, "{kind}");
    }
    // wherever the viewer stands
    let moved = load("kind = 'ortho_to_perspective'\neye = [5, 0, 0]\ntarget = [0, 0, 0]\nup = [0, 0, 1]");
    let at = |i: u32, j: u32| curve(&moved, i, j).at(0.3);
    assert!(at(30, 15).y > at(20, 15).y + 0.1 && at(20, 5).z > at(20, 15).z + 0.1);
}

#[test]
fn wrong_volumes_say_what_is_wrong() {
    for (camera, key, why) in [
        ("kind = 'twist'\nnear = 5\nfar = 4", "camera.far", "far beyond it"),
        ("kind = 'twist'\nnear = -1", "camera.near", "0 or more"),
        ("kind = 'twist'\nvfov = 180", "camera.vfov", "between 0 and 180"),
        ("kind = 'twist'\ntarget = [0, 0, 4]", "camera", "same point"),
        ("kind = 'twist'\nup = [0, 0, 1]", "camera", "parallel"),
        ("kind = 'twist'\ndegree = 4", "camera.degree", "1 to 3"),
        ("kind = 'twist'\ndegree = 2\nangle = 180", "camera", "below 180"),
        ("kind = 'twist'\nt_range = [0, 1]", "camera", "unknown key \"t_range\""),
        ("kind = 'irregular_perspective'\nconvergence = 3", "camera", "rays cross"),
        ("kind = 'irregular_perspective'\nconvergence = [1, -1]\nfar = 9", "camera", "rays cross"),
        ("kind = 'irregular_perspective'\nconvergence = [1, 2, 3]", "camera.convergence", "two numbers"),
        ("kind = 'curved_convergence'\nbend = 1", "camera.bend", "two numbers"),
        ("kind = 'ortho_to_perspective'\nblend = 1.5", "camera.blend", "not in [0, 1]"),
        ("kind = 'ortho_to_perspective'\nblend = [0, 1]", "camera.blend.0", "two numbers"),
        ("kind = 'ortho_to_perspective'\nnear = 5", "camera", "must lie between"),
        ("kind = 'occlusion'\nnear = 0", "camera", "in front of the eye"),
        ("kind = 'occlusion'\nend = 3", "camera.end", "beyond far"),
        ("kind = 'occlusion'\njoin = 'bent'", "camera.join", "\"bezier\""),
        ("kind = 'occlusion'\ndistortion = [0, -1]", "camera.distortion", "below 0"),
        ("kind = 'street'\nto = [-2, 0, 4]", "camera", "same point"),
        ("kind = 'street'\nup = [1, 0, 0]", "camera", "along the walk"),
        ("kind = 'street'\nfacade = 0", "camera.facade", "above 0"),
        ("kind = 'street'\nfar = 2", "camera", "beyond facade"),
        ("kind = 'street'\nviews = [{ width = 0.2 }]", "camera.views.0", "at is missing"),
        ("kind = 'street'\nviews = [{ at = 0.5, width = 0 }]", "camera.views.0", "width 0"),
        ("kind = 'street'\nviews = [{ at = 0.5, angle = 120, turn = 30 }]", "camera.views.0", "within 90 degrees"),
    ] {
        let error = written::try_camera(camera, SIZE).map(|c| c.kind).unwrap_err();
        let text = error.to_string();
        assert!(error.exit_code() == 2 && text.contains(key) && text.contains(why) && !text.contains('\n'), "{text}");
    }
}
