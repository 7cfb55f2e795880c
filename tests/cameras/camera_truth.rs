//! The mappings of `docs/reference/definitions.md`, written down a second time and evaluated at many pixels; and who owns a border.

use crate::common;

use anamorph::internals::camera::kinds::glc::Glc;
use anamorph::internals::camera::kinds::orthographic::Orthographic;
use anamorph::internals::camera::kinds::pinhole::Pinhole;
use anamorph::internals::camera::mesh::spec::{CameraVertex, MeshCameraSpec};
use anamorph::internals::camera::spec::{CameraKind, CameraSpec};
use anamorph::internals::camera::{Camera, Field, Ray, glc};
use common::cameras::{MeshShape, glc_of_each_class, mesh_spec, raymap};
use common::rng::Rng;
use common::{FORWARD, camera};
use glam::{DVec2, DVec3};

const SIZE: (u32, u32) = (53, 37);

/// Rays are sums of some ten products of numbers up to 100: 2^-53 each, with a margin for the order of evaluation.
const RAY_ROUNDING: f64 = 1e-12;

fn close(a: DVec3, b: DVec3) -> bool {
    (a - b).length() <= RAY_ROUNDING * (1.0 + a.length())
}

/// Image coordinates of the centre of pixel (i, j).
fn place(i: u32, j: u32) -> (f64, f64) {
    ((i as f64 + 0.5) / SIZE.0 as f64, (j as f64 + 0.5) / SIZE.1 as f64)
}

fn pixels() -> impl Iterator<Item = (u32, u32)> {
    (0..SIZE.1).flat_map(|j| (0..SIZE.0).map(move |i| (i, j)))
}

/// Asserts that the camera's ray of every pixel is the one of the formula.
fn assert_rays(name: &str, camera: &Camera, formula: impl Fn(f64, f64) -> (DVec3, DVec3)) {
    for (i, j) in pixels() {
        let (a, b) = place(i, j);
        let (p, d) = formula(a, b);
        let Ray { origin, direction } = camera.ray(i, j).unwrap();
        assert!(close(origin, p) && close(direction, d), "{name} at {i},{j}: {origin} {direction}, not {p} {d}");
    }
}

#[test]
fn pinhole() {
    let mut rng = Rng(1);
    for _ in 0..20 {
        let (eye, target, up) = (9.0 * rng.vector(), 9.0 * rng.vector(), rng.direction());
        let vfov = 5.0 + 160.0 * rng.unit();
        let camera = camera(CameraKind::new("pinhole", Pinhole { eye, target, up, vfov }), SIZE, FORWARD);
        let f = (target - eye).normalize();
        let r = f.cross(up).normalize();
        let u = r.cross(f);
        let k = (vfov.to_radians() / 2.0).tan();
        let aspect = SIZE.0 as f64 / SIZE.1 as f64;
        assert_rays("pinhole", &camera, |a, b| (eye, f + (2.0 * a - 1.0) * k * aspect * r + (1.0 - 2.0 * b) * k * u));
    }
}

#[test]
fn orthographic() {
    let mut rng = Rng(2);
    for _ in 0..20 {
        let (eye, target, up) = (9.0 * rng.vector(), 9.0 * rng.vector(), rng.direction());
        let height = 0.1 + 9.0 * rng.unit();
        let camera = camera(CameraKind::new("orthographic", Orthographic { eye, target, up, height }), SIZE, FORWARD);
        let f = (target - eye).normalize();
        let r = f.cross(up).normalize();
        let u = r.cross(f);
        let aspect = SIZE.0 as f64 / SIZE.1 as f64;
        let half = height / 2.0;
        assert_rays("orthographic", &camera, |a, b| {
            (eye + (2.0 * a - 1.0) * half * aspect * r + (1.0 - 2.0 * b) * half * u, f)
        });
    }
}

#[test]
fn what_is_up_and_to_the_right_is_up_and_to_the_right_in_the_picture() {
    let (eye, target, up) = (DVec3::new(0.0, 0.0, 5.0), DVec3::ZERO, DVec3::Y);
    for kind in [
        CameraKind::new("pinhole", Pinhole { eye, target, up, vfov: 60.0 }),
        CameraKind::new("orthographic", Orthographic { eye, target, up, height: 4.0 }),
    ] {
        let camera = camera(kind, SIZE, FORWARD);
        let at = |i: u32, j: u32| {
            let r = camera.ray(i, j).unwrap();
            r.origin + r.direction * (5.0 / -r.direction.z)
        };
        let (left_top, right_bottom) = (at(0, 0), at(SIZE.0 - 1, SIZE.1 - 1));
        assert!(left_top.x < -1.0 && left_top.y > 1.0 && right_bottom.x > 1.0 && right_bottom.y < -1.0);
    }
}

#[test]
fn a_known_point_lands_on_its_pixel() {
    // 90 degrees high, 4:3: at distance 3 the picture is 8 x 6 wide, so (0.5, 1.5) is at a = 9/16, b = 1/4
    let kind = CameraKind::new("pinhole", Pinhole { eye: DVec3::ZERO, target: DVec3::NEG_Z, up: DVec3::Y, vfov: 90.0 });
    let camera = camera(kind, (80, 60), FORWARD);
    let point = DVec3::new(0.5, 1.5, -3.0);
    let miss = |i: u32, j: u32| {
        let r = camera.ray(i, j).unwrap();
        (r.origin + 3.0 * r.direction - point).abs().max_element()
    };
    // between the four pixels about place (45, 15), each half a pixel of 1/10 away in both directions
    for (i, j) in [(44, 14), (45, 14), (44, 15), (45, 15)] {
        assert!((miss(i, j) - 0.05).abs() < 1e-12, "{i},{j}: {}", miss(i, j));
    }
}

#[test]
fn general_linear_cameras_and_their_classes() {
    let mut rng = Rng(3);
    for _ in 0..20 {
        let mut three = || [5.0 * rng.vector(), 5.0 * rng.vector(), 5.0 * rng.vector()];
        let (n, f) = (three(), three());
        assert_rays("glc", &camera(CameraKind::new("glc", Glc { near: n, far: f }), SIZE, FORWARD), |a, b| {
            let p = n[0] + a * (n[1] - n[0]) + b * (n[2] - n[0]);
            let q = f[0] + a * (f[1] - f[0]) + b * (f[2] - f[0]);
            (p, q - p)
        });
        assert_eq!(glc::classify(&n, &f).0, glc::Class::Cglc);
    }
    for (name, kind) in glc_of_each_class() {
        let Some(&Glc { near, far }) = kind.recipe() else { unreachable!() };
        let (class, slits) = glc::classify(&near, &far);
        assert_eq!(class.name(), name);
        // at a slit's t all rays meet one line: the map from the image to that plane is singular
        for t in slits {
            let at = |k: usize| near[k].lerp(far[k], t);
            let area = (at(1) - at(0)).cross(at(2) - at(0)).length();
            assert!(area < 1e-9, "{name}: the slit at t = {t} has the area {area}");
        }
    }
}

/// Barycentric coordinates of `q` by ratios of areas.
fn barycentric(q: DVec2, c: [DVec2; 3]) -> [f64; 3] {
    let area = |a: DVec2, b: DVec2, c: DVec2| (b - a).perp_dot(c - a);
    let whole = area(c[0], c[1], c[2]);
    [area(q, c[1], c[2]) / whole, area(c[0], q, c[2]) / whole, area(c[0], c[1], q) / whole]
}

#[test]
fn pieces_interpolate_by_weights() {
    for (k, shape) in [
        MeshShape::default(),
        MeshShape { normalize: true, ..Default::default() },
        MeshShape { weights: true, ..Default::default() },
        MeshShape { normalize: true, weights: true, discontinuous: true },
    ]
    .into_iter()
    .enumerate()
    {
        let spec = mesh_spec(k as u64, 5, 4, shape);
        let camera = camera(CameraKind::new("mesh", spec.clone()), SIZE, FORWARD);
        for (i, j) in pixels() {
            let (piece, bundle) = camera.pixel(0, i, j).unwrap();
            let v = spec.triangles[piece as usize].map(|k| spec.vertices[k as usize]);
            let (a, b) = place(i, j);
            let l = barycentric(DVec2::new(a, b), v.map(|v| DVec2::from(v.image)));
            assert!(l.iter().all(|l| *l >= -1e-12), "{i},{j} is not in piece {piece}");
            let sum: f64 = (0..3).map(|k| v[k].w * l[k]).sum();
            let weighted =
                |f: &dyn Fn(&CameraVertex) -> DVec3| (0..3).map(|k| v[k].w * l[k] / sum * f(&v[k])).sum::<DVec3>();
            let p = weighted(&|v| v.near);
            let d =
                if shape.normalize { weighted(&|v| (v.far - v.near).normalize()) } else { weighted(&|v| v.far) - p };
            let ray = bundle.ray(0.0, 0.0);
            assert!(close(ray.origin, p) && close(ray.direction, d), "{shape:?} at {i},{j}");
        }
    }
}

#[test]
fn a_ray_map_is_read_pixel_by_pixel_and_not_where_it_is_not_finite() {
    let mut rng = Rng(4);
    let n = (SIZE.0 * SIZE.1) as usize;
    let mut lot = || (0..n).map(|_| 5.0 * rng.vector()).collect::<Vec<_>>();
    let (mut p, mut d) = (lot(), lot());
    p[3].y = f64::NAN;
    d[7].z = f64::INFINITY;
    d[11] = DVec3::ZERO;
    let field = Field::new(SIZE.0, SIZE.1, &p, &d).unwrap();
    for (k, (i, j)) in pixels().enumerate() {
        let expected = (![3, 7, 11].contains(&k)).then_some((p[k], d[k]));
        assert_eq!(field.ray(i, j), expected);
    }
    let camera = raymap(SIZE.0, SIZE.1, FORWARD);
    let blind = pixels().filter(|&(i, j)| camera.ray(i, j).is_none()).count();
    assert_eq!(blind, pixels().filter(|(i, j)| (i + 3 * j) % 17 == 0).count());
}

/// Two pieces over the unit square, cut from its top left to its bottom right; corners go round either way.
fn halves(first: [u32; 3], second: [u32; 3]) -> CameraKind {
    let vertex = |a: f64, b: f64| {
        let near = DVec3::new(a, b, 0.0);
        CameraVertex { image: [a, b], near, far: near + DVec3::NEG_Z, w: 1.0 }
    };
    let vertices = vec![vertex(0.0, 0.0), vertex(1.0, 0.0), vertex(0.0, 1.0), vertex(1.0, 1.0)];
    CameraKind::new("mesh", MeshCameraSpec { vertices, triangles: vec![first, second], normalize: false })
}

#[test]
fn pixels_exactly_on_a_border_belong_to_the_lowest_numbered_piece() {
    // any size: the centres of pixels (k, k) of a square image are on the diagonal, however a and b are rounded
    for side in [7, 16, 37, 100] {
        for (upper, lower) in [([0, 1, 3], [0, 2, 3]), ([3, 1, 0], [2, 3, 0])] {
            for (first, second, upper_first) in [(upper, lower, true), (lower, upper, false)] {
                let camera = camera(halves(first, second), (side, side), FORWARD);
                for (i, j) in (0..side).flat_map(|j| (0..side).map(move |i| (i, j))) {
                    let owner = camera.pixel(0, i, j).unwrap().0;
                    let expected = if i == j { 0 } else { u32::from((i > j) != upper_first) };
                    assert_eq!(owner, expected, "{i},{j} of {side}");
                }
            }
        }
    }
}

fn error(kind: CameraKind) -> String {
    let error = Camera::new(&CameraSpec { kind, t_range: FORWARD }, Some(SIZE)).unwrap_err();
    assert_eq!(error.exit_code(), 2);
    assert!(!error.to_string().contains('\n'));
    error.to_string()
}

#[test]
fn pieces_that_overlap_or_have_no_area_are_errors_that_name_the_triangles() {
    let overlap = error(halves([0, 1, 3], [0, 1, 2]));
    assert!(overlap.contains("0 and 1 overlap"), "{overlap}");
    let flat = error(halves([0, 1, 3], [2, 3, 2]));
    assert!(flat.contains("1 has no area"), "{flat}");
    let mut spec = mesh_spec(1, 8, 8, MeshShape::default());
    // one vertex of the middle pulled over its neighbours
    spec.vertices[40].image = [0.9, 0.9];
    let far = error(CameraKind::new("mesh", spec.clone()));
    assert!(far.contains("overlap"), "{far}");
    spec.triangles = Vec::new();
    assert!(error(CameraKind::new("mesh", spec)).contains("no pieces"));
}

#[test]
fn cameras_without_a_picture_are_errors() {
    let pinhole = |eye, target, up, vfov| error(CameraKind::new("pinhole", Pinhole { eye, target, up, vfov }));
    assert!(pinhole(DVec3::X, DVec3::X, DVec3::Y, 40.0).contains("eye and target"));
    assert!(pinhole(DVec3::ZERO, DVec3::Y, DVec3::Y, 40.0).contains("parallel"));
    assert!(pinhole(DVec3::ZERO, DVec3::X, DVec3::ZERO, 40.0).contains("up"));
    for vfov in [0.0, -1.0, 180.0, f64::NAN] {
        assert!(pinhole(DVec3::ZERO, DVec3::X, DVec3::Y, vfov).contains("vfov"));
    }
    let orthographic =
        CameraKind::new("orthographic", Orthographic { eye: DVec3::ZERO, target: DVec3::X, up: DVec3::Y, height: 0.0 });
    assert!(error(orthographic).contains("height"));
    assert!(error(CameraKind::new("glc", Glc { near: [DVec3::X; 3], far: [DVec3::X; 3] })).contains("direction"));
}
