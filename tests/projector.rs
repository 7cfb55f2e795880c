//! The projector: each surface and each reparametrisation by the contract's formulas written down a second time, what it
//! compiles to, and curves through their control points.

mod common;

use anamorph::Result;
use anamorph::camera::{Camera, Curve, Rays};
use anamorph::scene::Scene;
use anamorph::scene::file::CameraKind;
use common::{FORWARD, camera};
use glam::{DVec2, DVec3};
use std::f64::consts::{PI, TAU};
use std::path::Path;

const SIZE: (u32, u32) = (24, 18);

/// Points are sums of some twenty products of numbers up to 10, and angles of some turns: 2^-53 each, with room for the
/// order of evaluation.
const ROUNDING: f64 = 1e-13;

fn try_load(dir: &Path, camera: &str) -> Result<Camera> {
    let path = dir.join("scene.toml");
    let (w, h) = SIZE;
    std::fs::write(&path, format!("[image]\nwidth = {w}\nheight = {h}\n[camera]\n{camera}\n")).unwrap();
    Scene::load(&path, &[])?.camera()
}

fn load(camera: &str) -> Camera {
    let dir = tempfile::tempdir().unwrap();
    try_load(dir.path(), camera).unwrap_or_else(|e| panic!("{camera}: {e}"))
}

fn projector(surfaces: &[&str], reparam: &str) -> String {
    format!("kind = \"projector\"\nsurfaces = [{}]\n{reparam}", surfaces.join(", "))
}

fn pixels() -> impl Iterator<Item = (u32, u32)> {
    (0..SIZE.1).flat_map(|j| (0..SIZE.0).map(move |i| (i, j)))
}

fn place(i: u32, j: u32) -> (f64, f64) {
    ((i as f64 + 0.5) / SIZE.0 as f64, (j as f64 + 0.5) / SIZE.1 as f64)
}

fn close(a: DVec3, b: DVec3) -> bool {
    (a - b).length() <= ROUNDING * (1.0 + a.length())
}

/// A second surface that no surface here touches, and a third.
const FAR: &str = "{ kind = 'point', at = [30, 20, 10] }";
const FAR_PLANE: &str = "{ kind = 'plane', origin = [30, 20, 10], u = [1, 2, 0], v = [0, 1, 3] }";

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

/// A grid of points that no plane holds, and its text.
fn grid(rows: usize, columns: usize) -> (Vec<Vec<DVec3>>, String) {
    let point = |i: usize, j: usize| {
        let (x, y) = (i as f64, j as f64);
        DVec3::new(x + 0.25 * y, y - 0.125 * x * x, (x * y * 0.5).sin())
    };
    let grid: Vec<Vec<DVec3>> = (0..rows).map(|j| (0..columns).map(|i| point(i, j)).collect()).collect();
    let text = |p: &DVec3| format!("[{:?}, {:?}, {:?}]", p.x, p.y, p.z);
    let row = |row: &Vec<DVec3>| format!("[{}]", row.iter().map(text).collect::<Vec<_>>().join(", "));
    let text = format!("[{}]", grid.iter().map(row).collect::<Vec<_>>().join(", "));
    (grid, text)
}

fn bernstein(i: usize, n: usize, t: f64) -> f64 {
    let binomial: f64 = (0..i).map(|k| (n - k) as f64 / (k + 1) as f64).product();
    binomial * t.powi(i as i32) * (1.0 - t).powi((n - i) as i32)
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
    let ones = format!("[{}]", vec!["[1, 2, 3, 4]"; 5].join(", "));
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
    let ones = format!("[{}]", vec!["[2, 2, 2, 2]"; 5].join(", "));
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

/// Where on the surfaces the pixels lie, by a plane whose points are (u, v, 0).
fn assert_reparam(dir: &Path, reparam: &str, formula: impl Fn(f64, f64) -> Option<DVec2>) {
    let surface = "{ kind = 'plane', origin = [0, 0, 0], u = [1, 0, 0], v = [0, 1, 0] }";
    let camera = try_load(dir, &projector(&[surface, FAR], &format!("reparam = {reparam}"))).unwrap();
    for (i, j) in pixels() {
        let (a, b) = place(i, j);
        let found = camera.curve(0, i, j).map(|(_, c)| c.points()[0]);
        match (found, formula(a, b)) {
            (Some(p), Some(uv)) => assert!(close(p, uv.extend(0.0)), "{reparam} at {a},{b}: {p}, not {uv}"),
            (found, expected) => assert!(found.is_none() && expected.is_none(), "{reparam} at {a},{b}: {found:?}"),
        }
    }
}

#[test]
fn reparametrisations() {
    let dir = tempfile::tempdir().unwrap();
    let check = |text: &str, formula: &dyn Fn(f64, f64) -> Option<DVec2>| assert_reparam(dir.path(), text, formula);
    check("{ kind = 'affine', m = [[2, 0.5, -1], [0.25, -3, 4]] }", &|a, b| {
        Some(DVec2::new(2.0 * a + 0.5 * b - 1.0, 0.25 * a - 3.0 * b + 4.0))
    });
    for (text, power) in [("{ kind = 'polar' }", 1.0), ("{ kind = 'lens', power = 2.5 }", 2.5)] {
        check(text, &|a, b| {
            let (x, y) = (2.0 * a - 1.0, 1.0 - 2.0 * b);
            let rho = (x * x + y * y).sqrt();
            let turn = if y >= 0.0 { (x / rho).acos() } else { TAU - (x / rho).acos() };
            (rho <= 1.0).then(|| DVec2::new(turn / TAU, rho.powf(power)))
        });
    }
    check("{ kind = 'magnify', center = [0.4, 0.6], radius = 0.3, strength = 3 }", &|a, b| {
        let c = DVec2::new(0.4, 0.6);
        let d = DVec2::new(a, b) - c;
        let q = d.length() / 0.3;
        let s = if q >= 1.0 { 1.0 } else { 1.0 / 3.0 + (2.0 / 3.0) * q.powi(2) * (3.0 - 2.0 * q) };
        Some(c + s * d)
    });
}

#[test]
fn tables_are_bilinear_between_the_centres_of_their_cells() {
    let dir = tempfile::tempdir().unwrap();
    // 3 x 2 cells with centres at a = 1/6, 1/2, 5/6 and b = 1/4, 3/4; one of them has no place
    let cell = |x: usize, y: usize| [x as f64 + 0.5 * y as f64, 2.0 * y as f64 - (x * y) as f64];
    let mut numbers: Vec<f64> = (0..2).flat_map(|y| (0..3).flat_map(move |x| cell(x, y))).collect();
    let expected = |a: f64, b: f64| {
        let (x, y) = ((3.0 * a - 0.5).clamp(0.0, 2.0), (2.0 * b - 0.5).clamp(0.0, 1.0));
        // the cells' numbers are themselves bilinear in the cell
        DVec2::new(x + 0.5 * y, 2.0 * y - x * y)
    };
    let table = "{ kind = 'table', file = 'uv.npy' }";
    anamorph::output::write_npy_f64(&dir.path().join("uv.npy"), &[2, 3, 2], &numbers).unwrap();
    assert_reparam(dir.path(), table, |a, b| Some(expected(a, b)));
    numbers[10] = f64::NAN;
    anamorph::output::write_npy_f64(&dir.path().join("uv.npy"), &[2, 3, 2], &numbers).unwrap();
    // the last cell of the second row has a say where x > 1 and y > 0
    assert_reparam(dir.path(), table, |a, b| (a <= 0.5 || b <= 0.25).then(|| expected(a, b)));
    use anamorph::frame::{Channel, Frame, Plane};
    let planes = vec![(Channel::R, Plane::F32(vec![0.25; 4])), (Channel::G, Plane::F32(vec![0.75; 4]))];
    anamorph::output::write_exr(&dir.path().join("uv.exr"), &Frame { width: 2, height: 2, planes }, &[]).unwrap();
    assert_reparam(dir.path(), "{ kind = 'table', file = 'uv.exr' }", |_, _| Some(DVec2::new(0.25, 0.75)));
}

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
    let glc = |near, far| camera(CameraKind::Glc { near, far }, SIZE, FORWARD);
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

/// Two triangles over the unit square, their border the diagonal u + v = 1; `z` of the corners.
fn square<const N: usize>(order: [&str; N], z: [f64; 4]) -> String {
    let at = |u: u32, v: u32, z: f64| format!("{{ image = [{u}, {v}], at = [{u}, {v}, {z:?}] }}");
    let vertices = [at(0, 0, z[0]), at(1, 0, z[1]), at(0, 1, z[2]), at(1, 1, z[3])].join(", ");
    format!("{{ kind = 'pieces', vertices = [{vertices}], triangles = [{}] }}", order.join(", "))
}

const UPPER: &str = "[0, 1, 2]";
const LOWER: &str = "[1, 3, 2]";

#[test]
fn pieces_are_linear_on_each_triangle_and_the_lowest_numbered_owns_a_border() {
    let z = [1.0, 2.0, 4.0, -8.0];
    let height = |a: f64, b: f64| {
        let upper = 1.0 + a * 1.0 + b * 3.0;
        let lower = -8.0 + (1.0 - b) * 10.0 + (1.0 - a) * 12.0;
        if a + b <= 1.0 { upper } else { lower }
    };
    // straight ones become pieces; under a map that is not affine, or with more surfaces, they stay curves
    let odd = "reparam = { kind = 'magnify', center = [9, 9], radius = 1, strength = 2 }";
    for (surfaces, reparam, curved) in [
        (vec![square([UPPER, LOWER], z), FAR_PLANE.into()], "", false),
        (vec![square([UPPER, LOWER], z), square([UPPER, LOWER], [9.0; 4])], "", false),
        (vec![square([UPPER, LOWER], z), FAR_PLANE.into()], odd, true),
        (vec![square([UPPER, LOWER], z), FAR.into(), FAR_PLANE.into()], "", true),
    ] {
        let surfaces: Vec<&str> = surfaces.iter().map(String::as_str).collect();
        let camera = load(&projector(&surfaces, reparam));
        assert_eq!((camera.is_curved(), camera.piece_count()), (curved, 2));
        for (i, j) in pixels() {
            let (a, b) = place(i, j);
            let (piece, curve) = camera.curve(0, i, j).unwrap();
            assert_eq!(piece, u32::from(a + b > 1.0), "{a},{b}");
            assert!(close(curve.points()[0], DVec3::new(a, b, height(a, b))), "{a},{b}: {}", curve.points()[0]);
        }
    }
    // on the diagonal both hold the pixel: the order in the file decides (3 x 2^k pixels a side give exact places)
    let swapped = load(&projector(&[&square([LOWER, UPPER], z), FAR, FAR], ""));
    assert!(pixels().all(|(i, j)| {
        let (a, b) = place(i, j);
        swapped.curve(0, i, j).unwrap().0 == u32::from(a + b < 1.0 - 1e-9)
    }));
}

#[test]
fn nothing_is_outside_the_pieces() {
    let half = square([UPPER], [0.0; 4]);
    for surfaces in [vec![half.as_str(), FAR], vec![half.as_str(), FAR, FAR_PLANE]] {
        let camera = load(&projector(&surfaces, ""));
        for (i, j) in pixels() {
            let (a, b) = place(i, j);
            assert_eq!(camera.curve(0, i, j).is_some(), a + b <= 1.0 + 1e-9, "{a},{b}");
        }
    }
}

#[test]
fn surfaces_cut_in_different_ways_count_each_pair() {
    let other = "{ kind = 'pieces', vertices = [{ image = [0, 0], at = [5, 5, 5] }, { image = [0.5, 0], at = [5, 6, 5] }, \
                 { image = [1, 0], at = [5, 5, 7] }, { image = [0, 1], at = [8, 5, 5] }, { image = [0.5, 1], at = [5, 9, 5] }, \
                 { image = [1, 1], at = [5, 5, 9] }], triangles = [[0, 1, 3], [1, 4, 3], [1, 2, 4], [2, 5, 4]] }";
    let camera = load(&projector(&[&square([UPPER, LOWER], [0.0; 4]), other], ""));
    assert_eq!(camera.piece_count(), 8);
    for (i, j) in pixels() {
        let (a, b) = place(i, j);
        let first = u32::from(a + b > 1.0 + 1e-9);
        let column = u32::from(a > 0.5);
        let second = 2 * column + u32::from(2.0 * (a - 0.5 * column as f64) + b > 1.0 + 1e-9);
        assert_eq!(camera.curve(0, i, j).unwrap().0, first + 2 * second, "{a},{b}");
    }
}

#[test]
fn overlapping_pieces_are_owned_by_the_lowest_numbered() {
    let both = square([UPPER, "[0, 1, 3]"], [0.0, 1.0, 2.0, 3.0]);
    let camera = load(&projector(&[&both, FAR], ""));
    for (i, j) in pixels() {
        let (a, b) = place(i, j);
        let owner = if a + b <= 1.0 + 1e-9 { Some(0) } else { (b <= a + 1e-9).then_some(1) };
        assert_eq!(camera.curve(0, i, j).map(|c| c.0), owner, "{a},{b}");
    }
}

#[test]
fn wrong_projectors_say_what_is_wrong() {
    let dir = tempfile::tempdir().unwrap();
    let fails = |camera: String, key: &str, why: &str| {
        let error = try_load(dir.path(), &camera).map(|c| c.kind).unwrap_err();
        let text = error.to_string();
        assert!(error.exit_code() == 2 && text.contains(key) && text.contains(why) && !text.contains('\n'), "{text}");
    };
    let one = |surface: &str, key: &str, why: &str| fails(projector(&[surface, FAR], ""), key, why);
    fails("kind = 'projector'".into(), "camera", "surfaces is missing");
    fails(projector(&[FAR], ""), "camera.surfaces", "1 surfaces");
    fails(projector(&[FAR; 5], ""), "camera.surfaces", "5 surfaces");
    fails(projector(&[FAR, FAR], ""), "camera.surfaces", "no pixel has a projector");
    fails(projector(&[FAR, FAR, FAR], ""), "camera.surfaces", "no pixel has a projector");
    fails(projector(&[FAR, FAR_PLANE], "t_range = [0, 2]"), "t_range", "unknown key");
    one("{ kind = 'torus' }", "camera.surfaces.0.kind", "unknown kind \"torus\"");
    one("{ at = [0, 0, 0] }", "camera.surfaces.0", "kind is missing");
    one("{ kind = 'plane', origin = [0, 0, 0], u = [1, 0, 0] }", "camera.surfaces.0", "v is missing");
    one(
        "{ kind = 'plane', origin = [0, 0, 0], u = [1, 0, 0], w = [1, 0, 0] }",
        "camera.surfaces.0",
        "unknown key \"w\"",
    );
    one("{ kind = 'bilinear', corners = [[0, 0, 0]] }", "camera.surfaces.0.corners", "four points");
    one("{ kind = 'cylinder', center = [0, 0, 0], axis = [0, 0, 0], radius = 1, height = 1 }", "0.axis", "is zero");
    one("{ kind = 'cylinder', center = [0, 0, 0], axis = [0, 1, 0], radius = -1, height = 1 }", "0.radius", "below 0");
    one("{ kind = 'sphere', center = [0, 0, 0], radius = 1, lon = [0], lat = [0, 1] }", "0.lon", "two angles");
    one("{ kind = 'disc', center = [0, 0, 0], normal = [0, 1, 0], radius = 1 }", "surfaces.0", "up is parallel");
    let bezier = |points: &str| format!("{{ kind = 'bezier', points = {points} }}");
    one(&bezier("[[[0, 0, 0], [1, 0, 0]]]"), "0.points", "1 rows; 2 to 6");
    one(&bezier("[[[0, 0, 0], [1, 0, 0]], [[0, 0, 0]]]"), "0.points.1", "1 in this row; 2 to 6");
    one(&bezier("[[[0, 0, 0], [1, 0, 0]], [[0, 0, 0], [1, 1, 1], [2, 2, 2]]]"), "0.points.1", "rows must be equal");
    one(&bezier("[[0, 1, 2], [3, 4, 5]]"), "0.points.0.0", "three numbers");
    one(&bezier(&grid(7, 2).1), "0.points", "7 rows; 2 to 6");
    let spline = |rest: &str| format!("{{ kind = 'bspline', points = {}, {rest} }}", grid(3, 4).1);
    one(&spline("degree = 3"), "0.points", "3 rows; 4 to");
    one(&spline("degree = 0"), "0.degree", "1 to 5");
    one(&spline("degree = [3, 2], knots_u = [0, 1]"), "0.knots_u", "2 knots; 4 control points of degree 3 need 8");
    one(&spline("degree = [3, 2], knots_u = [0, 0, 0, 0, 1, 1, 1, 0.5]"), "0.knots_u", "knot 7 is below");
    one(&spline("degree = [1, 2], knots_u = [0, 1, 1, 1, 2, 3]"), "0.knots_u", "more than 2 times");
    one(&spline("degree = 2, knots_v = [0, 1, 2, 2, 3, 4]"), "0.knots_v", "no extent");
    let nurbs =
        |weights: &str| format!("{{ kind = 'nurbs', degree = 1, points = {}, weights = {weights} }}", grid(2, 2).1);
    one(&nurbs("[[1, 1], [1, 0]]"), "0.weights.1.1", "0 is not above 0");
    one(&nurbs("[[1, 1, 1], [1, 1, 1]]"), "0.weights", "one weight for each control point");
    one(&square(["[0, 1, 4]"], [0.0; 4]), "0.triangles", "vertex 4 does not exist");
    one(&square(["[0, 1, 1]"], [0.0; 4]), "0.triangles", "no area");
    one(&square([], [0.0; 4]), "0.triangles", "no pieces");
    let map = |reparam: &str, key: &str, why: &str| {
        fails(projector(&[FAR, FAR_PLANE], &format!("reparam = {reparam}")), key, why);
    };
    map("{ kind = 'mirror' }", "reparam.kind", "unknown kind");
    map("{ kind = 'affine', m = [[1, 0], [0, 1]] }", "reparam.m.0", "three numbers");
    map("{ kind = 'polar', power = 2 }", "reparam", "unknown key \"power\"");
    map("{ kind = 'lens', power = 0 }", "reparam.power", "not above 0");
    map("{ kind = 'magnify', center = [0, 0], radius = 0, strength = 2 }", "reparam.radius", "not above 0");
    map("{ kind = 'magnify', center = [0, 0], radius = 1, strength = -2 }", "reparam.strength", "not above 0");
    map("{ kind = 'table', file = 'none.npy' }", "reparam.file", "cannot be read");
    anamorph::output::write_npy_f64(&dir.path().join("three.npy"), &[1, 1, 3], &[0.0; 3]).unwrap();
    map("{ kind = 'table', file = 'three.npy' }", "reparam.file", "height x width x 2");
    anamorph::output::write_npy_f64(&dir.path().join("nan.npy"), &[1, 1, 2], &[f64::NAN; 2]).unwrap();
    map("{ kind = 'table', file = 'nan.npy' }", "reparam.file", "no pair of finite numbers");
}
