//! Every surface by its formula: the first control point of a pixel is the surface's own point.

use super::make::*;
use anamorph::internals::camera::Camera;
use glam::DVec3;
use std::f64::consts::{PI, TAU};

fn assert_surface(surface: &str, formula: impl Fn(f64, f64) -> DVec3) {
    for surfaces in [vec![surface, FAR], vec![surface, FAR, FAR_PLANE], vec![surface, FAR, FAR, FAR_PLANE]] {
        let camera = load(&projector(&surfaces, ""));
        for (i, j) in pixels() {
            let (a, b) = place(i, j);
            let (piece, curve) = camera.curve(0, i, j).unwrap();
            let (found, expected) = (curve.points()[0], formula(a, b));
            assert!(piece == 0 && close(found, expected), "{surface} at {a},{b}: {found}, not {expected}");
            assert_eq!(curve.degree(), surfaces.len() - 1);
        }
    }
}

#[test]
fn flat_surfaces() {
    let (o, u, v) = (DVec3::new(1., 2., 3.), DVec3::new(2., 0., 1.), DVec3::new(0., -3., 0.5));
    assert_surface("{ kind = 'plane', origin = [1, 2, 3], u = [2, 0, 1], v = [0, -3, 0.5] }", |s, t| o + s * u + t * v);
    assert_surface("{ kind = 'point', at = [1, 2, 3] }", |_, _| o);
    let c = [DVec3::ZERO, DVec3::new(2., 0., 0.), DVec3::new(0., 3., 1.), DVec3::new(4., 4., -2.)];
    assert_surface("{ kind = 'bilinear', corners = [[0, 0, 0], [2, 0, 0], [0, 3, 1], [4, 4, -2]] }", |u, v| {
        (1. - u) * (1. - v) * c[0] + u * (1. - v) * c[1] + (1. - u) * v * c[2] + u * v * c[3]
    });
}

#[test]
fn round_surfaces() {
    let c = DVec3::new(1., -1., 2.);
    // about +y: e1 = z, e2 = y x z = x
    assert_surface(
        "{ kind = 'cylinder', center = [1, -1, 2], axis = [0, 4, 0], radius = 3, height = 5, from = 30, to = -200 }",
        |u, v| {
            let th = (30.0 - 230.0 * u).to_radians();
            c + 3.0 * DVec3::new(th.sin(), 0.0, th.cos()) + DVec3::new(0.0, 5.0 * (v - 0.5), 0.0)
        },
    );
    // about -z: e1 = x, e2 = -z x x = -y; a negative height runs the other way
    assert_surface(
        "{ kind = 'cylinder', center = [1, -1, 2], axis = [0, 0, -2], radius = 0.5, height = -4 }",
        |u, v| c + 0.5 * DVec3::new((TAU * u).cos(), -(TAU * u).sin(), 0.0) + DVec3::new(0.0, 0.0, 4.0 * (v - 0.5)),
    );
    // about a slanted axis (0, 3, 4) / 5: e1 = z - 0.8 w = (0, -0.48, 0.36) / 0.6, e2 = w x e1 = x
    let (w, e1) = (DVec3::new(0.0, 0.6, 0.8), DVec3::new(0.0, -0.8, 0.6));
    assert_surface("{ kind = 'cylinder', center = [1, -1, 2], axis = [0, 3, 4], radius = 2, height = 1 }", |u, v| {
        c + 2.0 * ((TAU * u).cos() * e1 + (TAU * u).sin() * DVec3::X) + (v - 0.5) * w
    });
    assert_surface(
        "{ kind = 'sphere', center = [1, -1, 2], radius = 2, lon = [-180, 180], lat = [90, -90] }",
        |u, v| {
            let (l, p) = (TAU * (u - 0.5), PI * (0.5 - v));
            c + 2.0 * DVec3::new(p.cos() * l.sin(), p.sin(), p.cos() * l.cos())
        },
    );
    // n = -z, e1 = y, e2 = n x e1 = x
    assert_surface("{ kind = 'disc', center = [1, -1, 2], normal = [0, 0, -3], radius = 2 }", |u, v| {
        c + 2.0 * v * DVec3::new((TAU * u).sin(), (TAU * u).cos(), 0.0)
    });
    // up = (1, 1, 0) leaves (1, 0, 0) across n = y; e2 = y x x = -z
    assert_surface("{ kind = 'disc', center = [1, -1, 2], normal = [0, 1, 0], up = [1, 1, 0], radius = 2 }", |u, v| {
        c + 2.0 * v * DVec3::new((TAU * u).cos(), 0.0, -(TAU * u).sin())
    });
}

/// Cox and de Boor's recursion.
fn b_spline(i: usize, p: usize, knots: &[f64], t: f64) -> f64 {
    if p == 0 {
        return f64::from(u8::from(knots[i] <= t && t < knots[i + 1]));
    }
    let ratio = |a: f64, b: f64| if b == 0.0 { 0.0 } else { a / b };
    ratio(t - knots[i], knots[i + p] - knots[i]) * b_spline(i, p - 1, knots, t)
        + ratio(knots[i + p + 1] - t, knots[i + p + 1] - knots[i + 1]) * b_spline(i + 1, p - 1, knots, t)
}

#[test]
fn bezier_patches_of_every_degree() {
    for (rows, columns) in [(2, 2), (3, 5), (6, 6), (2, 4)] {
        let (points, text) = grid(rows, columns);
        let expected = |u: f64, v: f64| {
            let term = |i: usize, j: usize| bernstein(j, rows - 1, v) * bernstein(i, columns - 1, u) * points[j][i];
            (0..rows).flat_map(|j| (0..columns).map(move |i| (i, j))).map(|(i, j)| term(i, j)).sum()
        };
        assert_surface(&format!("{{ kind = 'bezier', points = {text} }}"), expected);
    }
}

/// A place of the image as the reparametrisation of a corner pixel: the first pixel is at (0, 0), the last at (1, 1).
fn corners_at_pixels() -> String {
    let (w, h) = (SIZE.0 as f64, SIZE.1 as f64);
    let (su, sv) = (w / (w - 1.0), h / (h - 1.0));
    let (u0, v0) = (-0.5 / (w - 1.0), -0.5 / (h - 1.0));
    format!("reparam = {{ kind = 'affine', m = [[{su:?}, 0, {u0:?}], [0, {sv:?}, {v0:?}]] }}")
}

#[test]
fn patches_end_in_their_corners() {
    let (points, text) = grid(5, 4);
    let knots = "knots_u = [1, 1, 1, 1, 2, 2, 2, 2], knots_v = [0, 0, 0, 0, 0.3, 1, 1, 1, 1]";
    let ones = format!("[{}]", ["[1, 2, 3, 4]"; 5].join(", "));
    for surface in [
        format!("{{ kind = 'bezier', points = {text} }}"),
        format!("{{ kind = 'bspline', degree = 3, points = {text} }}"),
        format!("{{ kind = 'nurbs', degree = 3, points = {text}, {knots}, weights = {ones} }}"),
    ] {
        let camera = load(&projector(&[&surface, FAR], &corners_at_pixels()));
        let at = |i: u32, j: u32| camera.curve(0, i, j).unwrap().1.points()[0];
        let (x, y) = (SIZE.0 - 1, SIZE.1 - 1);
        for (found, expected) in
            [(at(0, 0), points[0][0]), (at(x, 0), points[0][3]), (at(0, y), points[4][0]), (at(x, y), points[4][3])]
        {
            // (u, v) is off by some roundings, which the slopes of up to 15 a unit enlarge
            assert!((found - expected).length() < 100.0 * ROUNDING, "{surface}: {found}, not {expected}");
        }
    }
}

#[test]
fn b_splines() {
    let (points, text) = grid(4, 6);
    // knots with a double one inside, an extent from 2 to 5, and some that are not clamped
    let (ku, kv) = (vec![0.5, 1.0, 2.0, 3.0, 3.0, 4.5, 5.0, 5.0, 6.0], vec![0.0, 0.0, 1.0, 2.0, 2.0, 2.5]);
    let surface =
        format!("{{ kind = 'bspline', degree = [2, 1], points = {text}, knots_u = {ku:?}, knots_v = {kv:?} }}");
    assert_surface(&surface, |u, v| {
        let (s, t) = (2.0 * (1.0 - u) + 5.0 * u, 2.0 * v);
        let weight = |i: usize, j: usize| b_spline(i, 2, &ku, s) * b_spline(j, 1, &kv, t);
        (0..4).flat_map(|j| (0..6).map(move |i| (i, j))).map(|(i, j)| weight(i, j) * points[j][i]).sum()
    });
    // the default knots are clamped and uniform
    let (ku, kv) = (vec![0., 0., 0., 0., 1., 2., 3., 3., 3., 3.], vec![0., 0., 0., 0., 1., 1., 1., 1.]);
    assert_surface(&format!("{{ kind = 'bspline', degree = 3, points = {text} }}"), |u, v| {
        let weight = |i: usize, j: usize| b_spline(i, 3, &ku, 3.0 * u) * b_spline(j, 3, &kv, v);
        (0..4).flat_map(|j| (0..6).map(move |i| (i, j))).map(|(i, j)| weight(i, j) * points[j][i]).sum()
    });
}

#[test]
fn a_b_spline_without_inner_knots_is_the_bezier_patch() {
    let (_, text) = grid(5, 4);
    let bezier = load(&projector(&[&format!("{{ kind = 'bezier', points = {text} }}"), FAR], ""));
    let spline = load(&projector(&[&format!("{{ kind = 'bspline', degree = [3, 4], points = {text} }}"), FAR], ""));
    let ones = format!("[{}]", ["[2, 2, 2, 2]"; 5].join(", "));
    let nurbs = format!("{{ kind = 'nurbs', degree = [3, 4], points = {text}, weights = {ones} }}");
    let nurbs = load(&projector(&[&nurbs, FAR], ""));
    for (i, j) in pixels() {
        let at = |c: &Camera| c.curve(0, i, j).unwrap().1.points()[0];
        assert_eq!(at(&bezier), at(&spline));
        assert!(close(at(&bezier), at(&nurbs)));
    }
}

#[test]
fn a_quarter_circle_is_exact_as_a_nurbs_patch() {
    let w = 0.5f64.sqrt();
    let surface = format!(
        "{{ kind = 'nurbs', degree = [2, 1], points = [[[2, 0, 0], [2, 2, 0], [0, 2, 0]], [[2, 0, 5], [2, 2, 5], [0, 2, 5]]], \
         weights = [[1, {w:?}, 1], [1, {w:?}, 1]] }}"
    );
    let camera = load(&projector(&[&surface, FAR], ""));
    for (i, j) in pixels() {
        let p = camera.curve(0, i, j).unwrap().1.points()[0];
        let (u, v) = place(i, j);
        assert!((p.truncate().length() - 2.0).abs() < ROUNDING && (p.z - 5.0 * v).abs() < ROUNDING);
        // the half-angle's tangent is the ratio of two quadratics in u: at the middle it is that of 22.5 degrees
        let [b0, b1, b2] = [0, 1, 2].map(|k| bernstein(k, 2, u));
        let angle = (w * b1 + b2).atan2(b0 + w * b1);
        assert!((p.y.atan2(p.x) - angle).abs() < ROUNDING);
    }
}
