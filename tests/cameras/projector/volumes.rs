//! What projectors compile to, which way round they are, and curves through their control points.

use super::make::*;
use crate::common::{FORWARD, camera};
use anamorph::internals::camera::kinds::glc::Glc;
use anamorph::internals::camera::spec::CameraKind;
use anamorph::internals::camera::{Camera, Curve, Rays};
use glam::{DVec2, DVec3};
use std::f64::consts::PI;

#[test]
fn straight_projectors_between_planes_are_a_glc() {
    let near = [DVec3::new(-1., 1., 2.), DVec3::new(1.5, 1., 2.25), DVec3::new(-1., -2., 2.)];
    let far = [DVec3::new(-3., 2., -2.), DVec3::new(3., 2.5, -2.), DVec3::new(-3., -2., -1.)];
    let text = |p: DVec3| format!("[{:?}, {:?}, {:?}]", p.x, p.y, p.z);
    let plane = |q: [DVec3; 3]| {
        let (o, u, v) = (text(q[0]), text(q[1] - q[0]), text(q[2] - q[0]));
        format!("{{ kind = 'plane', origin = {o}, u = {u}, v = {v} }}")
    };
    let bilinear = |q: [DVec3; 3]| {
        let corners = [q[0], q[1], q[2], q[1] + q[2] - q[0]].map(text).join(", ");
        format!("{{ kind = 'bilinear', corners = [{corners}] }}")
    };
    let glc = |near, far| camera(CameraKind::new("glc", Glc { near, far }), SIZE, FORWARD);
    let same = |found: &Camera, expected: &Camera| {
        assert!(
            matches!(&found.layers[..], [Rays::Pieces(p)] if p.pieces.len() == 1 && p.pieces[0].corners_px.is_none())
        );
        assert_eq!((found.t_range, found.piece_count()), ([0.0, 1.0], 1));
        for (i, j) in pixels() {
            let (found, expected) = (found.ray(i, j).unwrap(), expected.ray(i, j).unwrap());
            assert!(close(found.origin, expected.origin) && close(found.direction, expected.direction));
        }
    };
    same(&load(&projector(&[&plane(near), &plane(far)], "")), &glc(near, far));
    // the corners' differences are exact in these numbers, so the patches are planes
    same(&load(&projector(&[&bilinear(near), &bilinear(far)], "")), &glc(near, far));
    let eye = DVec3::new(0., 0., 5.);
    same(&load(&projector(&["{ kind = 'point', at = [0, 0, 5] }", &plane(far)], "")), &glc([eye; 3], far));
    let m = "reparam = { kind = 'affine', m = [[0.5, 0.25, 0.125], [-1, 2, 0.5]] }";
    let at = |q: [DVec3; 3], a: f64, b: f64| {
        let (u, v) = (0.5 * a + 0.25 * b + 0.125, 2.0 * b - a + 0.5);
        q[0] + u * (q[1] - q[0]) + v * (q[2] - q[0])
    };
    let moved = |q: [DVec3; 3]| [at(q, 0., 0.), at(q, 1., 0.), at(q, 0., 1.)];
    same(&load(&projector(&[&plane(near), &plane(far)], m)), &glc(moved(near), moved(far)));
    // a patch that is no plane, or a map that is not affine, is a ray field
    let bent = "{ kind = 'bilinear', corners = [[-1, 1, 2], [1.5, 1, 2.25], [-1, -2, 2], [1.5, -2, 3]] }";
    let bent = load(&projector(&[bent, &plane(far)], ""));
    let polar = load(&projector(&[&plane(near), &plane(far)], "reparam = { kind = 'polar' }"));
    for camera in [bent, polar] {
        assert!(matches!(&camera.layers[..], [Rays::Field(_)]) && camera.t_range == [0.0, 1.0]);
    }
}

#[test]
fn nested_cylinders_stand_upright_with_a_negative_height() {
    // from 180 to -180 about +y: the middle of the image looks along th = 0, +z, and u runs from -x to +x as seen from inside
    let ring = |radius: f64| {
        format!(
            "{{ kind = 'cylinder', center = [0, 0, 0], axis = [0, 1, 0], radius = {radius:?}, height = {:?}, \
                 from = 180, to = -180 }}",
            -2.0 * radius
        )
    };
    let camera = load(&projector(&[&ring(0.5), &ring(4.0)], ""));
    let direction = |i: u32, j: u32| camera.ray(i, j).unwrap().direction;
    let (middle, right) = (direction(SIZE.0 / 2, SIZE.1 / 2), direction(SIZE.0 * 3 / 4, SIZE.1 / 2));
    assert!(middle.z > 0.0 && middle.x.abs() < 0.2 * middle.z);
    // looking along +z with y up, the right hand is at -x
    assert!(right.x < 0.0 && right.z.abs() < 0.2 * -right.x);
    assert!(direction(0, 0).y > 0.0 && direction(0, SIZE.1 - 1).y < 0.0);
    let turned = load(&projector(
        &[&ring(0.5).replace("height = -", "height = "), &ring(4.0).replace("height = -", "height = ")],
        "",
    ));
    assert!(turned.ray(0, 0).unwrap().direction.y < 0.0);
}

#[test]
fn a_hemisphere_under_a_polar_map_is_an_angular_fisheye() {
    let dome = |radius: f64| {
        format!("{{ kind = 'sphere', center = [1, 2, 3], radius = {radius:?}, lon = [90, 450], lat = [90, 0] }}")
    };
    for (reparam, power) in [("{ kind = 'polar' }", 1.0), ("{ kind = 'lens', power = 2 }", 2.0)] {
        let camera = load(&projector(&[&dome(0.25), &dome(8.0)], &format!("reparam = {reparam}")));
        assert!(matches!(&camera.layers[..], [Rays::Field(_)]));
        for (i, j) in pixels() {
            let (a, b) = place(i, j);
            let q = DVec2::new(2.0 * a - 1.0, 1.0 - 2.0 * b);
            let Some(ray) = camera.ray(i, j) else {
                assert!(q.length() > 1.0);
                continue;
            };
            let d = ray.direction.normalize();
            let angle = d.y.clamp(-1.0, 1.0).acos();
            // near the pole the arc cosine's slope enlarges the rounding by up to 20
            assert!((angle - q.length().powf(power) * PI / 2.0).abs() < 20.0 * ROUNDING);
            assert!(
                close(ray.origin - DVec3::new(1., 2., 3.), 0.25 * d)
                    && (ray.direction.length() - 7.75).abs() < 10.0 * ROUNDING
            );
            // u = 0, to the right in the picture, is at longitude 90: +x; a quarter turn on, upwards, is at 180: -z
            assert!((d.x * q.y + d.z * q.x).abs() < ROUNDING && d.x * q.x - d.z * q.y >= 0.0);
        }
    }
}

#[test]
fn curves_go_from_the_first_surface_to_the_last_along_the_others() {
    let surfaces = [
        "{ kind = 'plane', origin = [-1, 1, 4], u = [2, 0, 0], v = [0, -2, 0] }",
        "{ kind = 'sphere', center = [0, 0, 0], radius = 3, lon = [-60, 60], lat = [60, -60] }",
        "{ kind = 'bilinear', corners = [[-2, 2, 0], [2, 1, 0], [-2, -2, 1], [2, -2, 0]] }",
        "{ kind = 'plane', origin = [-3, 3, -4], u = [6, 0, 0], v = [0, -6, 1] }",
    ];
    let single: Vec<Camera> = surfaces.iter().map(|s| load(&projector(&[s, FAR], ""))).collect();
    for m in [2, 3] {
        let camera = load(&projector(&surfaces[..=m], ""));
        assert!(matches!(&camera.layers[..], [Rays::Curves(c)] if c.map.degree() == m && c.map.piece_count() == 0));
        assert_eq!((camera.t_range, camera.piece_count()), ([0.0, 1.0], 0));
        for (i, j) in pixels() {
            let (piece, curve) = camera.curve(0, i, j).unwrap();
            let s: Vec<DVec3> = single[..=m].iter().map(|c| c.curve(0, i, j).unwrap().1.points()[0]).collect();
            assert!(piece == 0 && curve.degree() == m && curve.points().iter().zip(&s).all(|(p, s)| close(*p, *s)));
            assert!(close(curve.at(0.0), s[0]) && close(curve.at(1.0), s[m]));
            assert!(close(curve.tangent(0.0), m as f64 * (s[1] - s[0])));
            assert!(close(curve.tangent(1.0), m as f64 * (s[m] - s[m - 1])));
            let t = 0.3;
            let sum: DVec3 = (0..=m).map(|k| bernstein(k, m, t) * s[k]).sum();
            assert!(close(curve.at(t), sum));
        }
    }
}

#[test]
fn planes_evenly_between_two_make_the_straight_projector() {
    let plane = |z: f64, half: f64| {
        let side = 2.0 * half;
        format!(
            "{{ kind = 'plane', origin = [{:?}, {half:?}, {z:?}], u = [{side:?}, 0, 0], v = [0, {:?}, 0] }}",
            -half, -side
        )
    };
    let straight = load(&projector(&[&plane(4.0, 1.0), &plane(-2.0, 4.0)], ""));
    for m in [2usize, 3] {
        let middle = |k: usize| plane(4.0 - 6.0 * k as f64 / m as f64, 1.0 + 3.0 * k as f64 / m as f64);
        let all: Vec<String> = (0..=m).map(middle).collect();
        let camera = load(&projector(&all.iter().map(String::as_str).collect::<Vec<_>>(), ""));
        for (i, j) in pixels() {
            let (curve, line) = (camera.curve(0, i, j).unwrap().1, straight.curve(0, i, j).unwrap().1);
            let raised: Curve = line.elevated(m);
            assert!(raised.points().iter().zip(curve.points()).all(|(p, q)| close(*p, *q)));
            assert!([0.0, 0.25, 0.7, 1.0].iter().all(|t| close(curve.at(*t), line.at(*t))));
        }
    }
}

#[test]
fn a_pixel_whose_control_points_meet_has_no_projector() {
    // the second plane is the first turned about the image's column at a = 25/48, the centre of pixel column 12
    let near = "{ kind = 'plane', origin = [0, 0, 0], u = [48, 0, 0], v = [0, 1, 0] }";
    let turned = "{ kind = 'plane', origin = [0, 0, 25], u = [48, 0, -48], v = [0, 1, 0] }";
    for surfaces in [vec![near, turned], vec![near, turned, turned], vec![near, near, turned, turned]] {
        let camera = load(&projector(&surfaces, "reparam = { kind = 'polar' }"));
        assert!(camera.curve(0, 0, 0).is_none(), "outside the circle");
        // a map that is the identity on the image, but not known to be affine
        let identity = "reparam = { kind = 'magnify', center = [9, 9], radius = 1, strength = 2 }";
        let camera = load(&projector(&surfaces, identity));
        for (i, j) in pixels() {
            assert_eq!(camera.curve(0, i, j).is_none(), i == 12, "{i},{j}");
        }
    }
}
