//! Gradients: closed forms, the reference against finite differences, and the kernels against the reference, through cameras of many kinds.

use crate::common;

use anamorph::internals::camera::Camera;
use anamorph::internals::camera::change::{PixelRay, rate};
use anamorph::internals::engine::stage::gradient::Gradient;
use anamorph::internals::input::{Loading, Result};
use anamorph::internals::reference::gradient::{Direction, Edge, PixelChange, changes};
use anamorph::internals::scene::Scene;
use anamorph::internals::scene::gradients::{Changes, HIT_NUMBERS, NONE, Seen, VERTEX_DIRECTIONS};
use common::file::load;
use common::gpu::{engine_on, ids};
use glam::DVec3;

pub(super) const SIZE: (u32, u32) = (60, 44);

/// A ball, and a plane behind it.
pub(super) const BALL: &str = "[[mesh]]\nbuiltin = \"icosphere\"\nlevel = 1\n\
    [[mesh]]\nbuiltin = \"box\"\nscale = [0.7, 2.6, 0.9]\nrotate = [20, 30, 10]\ntranslate = [0.4, -0.1, -0.6]\n";

/// A camera about the ball, and numbers of it.
struct Case {
    keys: &'static str,
    numbers: &'static [&'static str],
}

const VIEW: &str = "eye = [1.5, 2, 3]\ntarget = [0.1, 0.05, 0]\n";

const CASES: [Case; 17] = [
    Case { keys: "kind = \"pinhole\"\nvfov = 38\nVIEW", numbers: &["vfov", "eye.0", "target.1"] },
    Case { keys: "kind = \"orthographic\"\nheight = 2.4\nVIEW", numbers: &["height", "eye.2"] },
    Case {
        keys: "kind = \"glc\"\nnear = [[-1.4, 1.4, 2], [1.4, 1.4, 2.4], [-1.4, 0.6, 1.8]]\n\
            far = [[-0.8, 0.2, -2.3], [0.8, 0.2, -1.7], [-1, -2.2, -2]]",
        numbers: &["near.1.2", "far.0.1"],
    },
    Case {
        keys: "kind = \"cross_slit\"\nslits = [{ distance = 4, angle = 20 }, { distance = 2.5, angle = 100 }]\nheight = 2.2\nVIEW",
        numbers: &["slits.0.distance", "slits.1.angle", "eye.1"],
    },
    Case {
        keys: "kind = \"pushbroom\"\nstart = [-1.2, 2, 3]\nend = [1.3, 2.1, 3]\nlook = [0, -2, -3]\nvfov = 40",
        numbers: &["vfov", "start.0", "look.2"],
    },
    Case { keys: "kind = \"pencil\"\nvfov = 36\nslit = 0.7\nangle = 30\nVIEW", numbers: &["slit", "angle"] },
    Case { keys: "kind = \"twisted\"\nheight = 2.4\nangle = 20\nVIEW", numbers: &["angle", "height"] },
    Case {
        keys: "kind = \"mesh\"\nvertices = [\n\
            { image = [0, 0], near = [-1.1, 1.4, 2], far = [-1, 0.1, -2], w = 1 },\n\
            { image = [1, 0], near = [1, 1.3, 2.1], far = [1, 0.2, -2], w = 1.6 },\n\
            { image = [0, 1], near = [-1, 0.5, 2], far = [-1.1, -1.9, -1.9], w = 0.7 },\n\
            { image = [1, 1], near = [1.1, 0.6, 1.9], far = [0.9, -2, -2], w = 1.2 },\n\
            { image = [0.45, 0.55], near = [0.1, 1.1, 2.2], far = [-0.2, -1.1, -2.2], w = 0.8 },\n]\n\
            triangles = [[0, 1, 4], [1, 3, 4], [3, 2, 4], [2, 0, 4]]",
        numbers: &["vertices.4.near.0", "vertices.4.w", "vertices.1.far.1"],
    },
    Case {
        keys: "kind = \"panorama\"\ncenter = [0, 0, 0]\nradius = 3\nelevation = 2\nheight = 2.4",
        numbers: &["radius", "elevation"],
    },
    Case {
        keys: "kind = \"panorama\"\ncenter = [0, 0, 0]\nradius = 3\nelevation = 2\nheight = 2.4\npieces = 24",
        numbers: &["radius"],
    },
    Case { keys: "kind = \"fisheye\"\nfov = 100\nVIEW", numbers: &["fov", "eye.0"] },
    Case {
        keys: "kind = \"fisheye\"\nfov = 110\nmapping = \"stereographic\"\nframe = \"full\"\nVIEW",
        numbers: &["fov", "target.0"],
    },
    Case { keys: "kind = \"sphere\"\neye = [0.2, 0.3, 2.2]\ntarget = [0, 0, 0]", numbers: &["eye.2", "target.1"] },
    Case {
        keys: "kind = \"cylinder\"\neye = [0.2, 0.3, 2.2]\ntarget = [0, 0, 0]\ntan = [-1.5, 0.7]",
        numbers: &["eye.0", "tan.0"],
    },
    Case { keys: "kind = \"panini\"\nfov = 70\nVIEW", numbers: &["fov", "eye.1"] },
    Case { keys: "kind = \"ods\"\neye = [0.2, 0.3, 2.2]\ntarget = [0, 0, 0]\nipd = 0.3\nVIEWED", numbers: &["ipd"] },
    Case { keys: "LENS\nkind = \"opencv\"\nmodel = \"fisheye\"\nVIEW", numbers: &["fx", "cy", "k1", "k4", "eye.0"] },
];

const LENS: &str = "%YAML:1.0\n---\nimage_width: 60\nimage_height: 44\n\
    camera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [ 50., 0., 30.5, 0., 51., 21., 0., 0., 1. ]\n\
    distortion_coefficients: !!opencv-matrix\n   rows: 4\n   cols: 1\n   dt: d\n   data: [ 0.08, -0.02, 0.01, -0.003 ]\n";

/// A scene, its camera, and what the reference's frame shows.
pub(super) struct View {
    pub scene: Scene,
    pub camera: Camera,
    pub rays: Vec<PixelRay>,
    pub ids: Vec<u32>,
}

impl View {
    pub fn of(meshes: &str, size: (u32, u32), keys: &str) -> View {
        let folder = tempfile::tempdir().unwrap();
        let mut keys = keys.replace("VIEWED", "").replace("VIEW", VIEW);
        if keys.starts_with("LENS") {
            let path = folder.path().join("lens.yml");
            std::fs::write(&path, LENS).unwrap();
            keys = keys.replace("LENS", &format!("file = {path:?}"));
        }
        let image = format!("image = {{ width = {}, height = {} }}\n", size.0, size.1);
        let scene = load(&format!("{image}{meshes}\n[camera]\n{keys}\n")).unwrap_or_else(|e| panic!("{keys}: {e}"));
        let camera = scene.camera().unwrap();
        let frame = anamorph::internals::reference::image::image(
            &scene,
            &camera,
            &[anamorph::internals::image::frame::Channel::TriangleId],
        );
        // the lens is read again for other values of its numbers
        std::mem::forget(folder);
        View { rays: camera.pixel_rays(true), ids: ids(&frame).to_vec(), scene, camera }
    }

    fn of_case(case: &Case) -> View {
        View::of(BALL, SIZE, case.keys)
    }

    pub fn corners(&self, id: u32) -> [DVec3; 3] {
        self.scene.mesh.triangles[id as usize].map(|v| self.scene.mesh.positions[v as usize])
    }

    fn with_seen<T>(&self, then: impl FnOnce(&Seen) -> T) -> T {
        let corners = |id: u32| self.corners(id);
        let (width, height) = (self.camera.width, self.camera.height);
        then(&Seen { width, height, rays: &self.rays, ids: &self.ids, corners: &corners, has_edges: true })
    }

    pub fn reference(&self, directions: &[Direction]) -> Vec<PixelChange> {
        self.with_seen(|seen| changes(seen, directions))
    }

    fn camera_at(&self, key: &str, value: f64) -> Result<Camera> {
        let spec = self.scene.camera_keys.with_number(key, value, &Loading::default())?;
        Camera::in_scene(&spec, Some((self.camera.width, self.camera.height)), &self.scene.mesh, &Loading::default())
    }

    fn rates(&self, key: &str) -> anamorph::internals::camera::change::Rate {
        let value = self.scene.camera_keys.number(key, &Loading::default()).unwrap();
        rate(&self.camera, (key, value), &|v| self.camera_at(key, v), true).unwrap()
    }
}

/// t, Z, position and weights of a hit, in vectors.
fn hit(ray: &PixelRay, [a, b, c]: [DVec3; 3]) -> [f64; HIT_NUMBERS] {
    let (p, d) = (DVec3::from_slice(&ray[..3]), DVec3::from_slice(&ray[3..6]));
    let normal = (b - a).cross(c - a);
    let t = normal.dot(a - p) / normal.dot(d);
    let x = p + t * d;
    // areas
    let weight = |u: DVec3, v: DVec3| (u - x).cross(v - x).dot(normal) / normal.length_squared();
    [t, t * d.length(), x.x, x.y, x.z, weight(b, c), weight(c, a), weight(a, b)]
}

/// The coverage by a triangle of the pixel, across one of its edges, from rays half a pixel to each side.
fn coverage(ray: &PixelRay, corners: [DVec3; 3], edge: &Edge, sign: f64) -> f64 {
    let vector = |k: usize| DVec3::from_slice(&ray[3 * k..3 * k + 3]);
    let (from, to) = (corners[edge.number], corners[(edge.number + 1) % 3]);
    let side = |x: f64, y: f64| {
        let p = vector(0) + x * vector(2) + y * vector(4);
        let d = vector(1) + x * vector(3) + y * vector(5);
        (from - p).cross(to - from).dot(d)
    };
    // the slope of a quadratic function is its central difference
    let slope = (side(0.5, 0.0) - side(-0.5, 0.0)).hypot(side(0.0, 0.5) - side(0.0, -0.5));
    (0.5 + sign * side(0.0, 0.0) / slope).clamp(0.0, 1.0)
}

fn sign(ray: &PixelRay, [a, b, c]: [DVec3; 3]) -> f64 {
    (b - a).cross(c - a).dot(DVec3::from_slice(&ray[3..6])).signum()
}

/// A central difference, and how far it may be off: twice what halving the step changes, and rounding of values of this size.
pub(super) fn difference(step: f64, size: f64, f: impl Fn(f64) -> f64) -> (f64, f64) {
    let over = |h: f64| (f(h) - f(-h)) / (2.0 * h);
    let (whole, half) = (over(step), over(step / 2.0));
    (half, 2.0 * (whole - half).abs() + ROUNDING * size / step)
}

/// Rounding of a hit or a distance relative to its size: a thousand of f64's, as triangles are seen under angles of a hundredth and more.
const ROUNDING: f64 = 1024.0 * f64::EPSILON;

/// How flat a hit is: |N| |D| / |N . D|. Below [`FLAT`] differences over a step stay in the linear range.
fn flatness(ray: &PixelRay, [a, b, c]: [DVec3; 3]) -> f64 {
    let (normal, d) = ((b - a).cross(c - a), DVec3::from_slice(&ray[3..6]));
    normal.length() * d.length() / normal.dot(d).abs()
}

const FLAT: f64 = 50.0;

#[test]
fn the_reference_is_the_limit_of_differences_by_corners() {
    let mut tested = [0, 0];
    for case in &CASES {
        let view = View::of_case(case);
        for (k, change) in view.reference(&Direction::vertices()).iter().enumerate() {
            let ray = &view.rays[k];
            if view.ids[k] != NONE && flatness(ray, view.corners(view.ids[k])) < FLAT {
                let corners = view.corners(view.ids[k]);
                let size = hit(ray, corners).iter().fold(1f64, |m, n| m.max(n.abs())) * flatness(ray, corners);
                for (direction, n) in (0..VERTEX_DIRECTIONS).flat_map(|v| (0..HIT_NUMBERS).map(move |n| (v, n))) {
                    let (slope, off) = difference(1.0 / 4096.0, size, |h| {
                        let mut moved = corners;
                        moved[direction / 3][direction % 3] += h;
                        hit(ray, moved)[n]
                    });
                    let got = change.hit[direction][n];
                    assert!(
                        (got - slope).abs() <= off,
                        "{}: pixel {k}, {direction}, {n}: {got}, not {slope} +- {off}",
                        case.keys
                    );
                    tested[0] += 1;
                }
            }
            let Some(edge) = change.edge.as_ref().filter(|edge| edge.distance.abs() < 0.49) else { continue };
            let corners = view.corners(edge.triangle);
            let sign = sign(&view.rays[edge.pixels[0] as usize], corners);
            let length = (corners[edge.number] - corners[(edge.number + 1) % 3]).length();
            assert!((coverage(ray, corners, edge, sign) - edge.coverage).abs() < 1e-9, "{}: pixel {k}", case.keys);
            for direction in 0..VERTEX_DIRECTIONS {
                // edges are near the hits, a pixel is some hundredth of them
                let (slope, off) = difference(length / 65536.0, 1e3, |h| {
                    let mut moved = corners;
                    moved[direction / 3][direction % 3] += h;
                    coverage(ray, moved, edge, sign)
                });
                let got = edge.change[direction];
                assert!(
                    (got - slope).abs() <= off,
                    "{}: pixel {k}, {direction}: coverage {got}, not {slope} +- {off}",
                    case.keys
                );
                tested[1] += 1;
            }
        }
    }
    println!("{} changes of hits, {} of coverage", tested[0], tested[1]);
    assert!(tested[0] > 500_000 && tested[1] > 50_000, "{tested:?}");
}

#[test]
fn the_reference_is_the_limit_of_differences_by_numbers_of_the_camera() {
    let mut tested = [0, 0];
    for case in &CASES {
        let view = View::of_case(case);
        for key in case.numbers {
            let value = view.scene.camera_keys.number(key, &Loading::default()).unwrap();
            let rates = view.rates(key);
            // three steps that are not those of the derivative
            let step = 0.37 * rates.step;
            let rays = [-1.0, -0.5, 0.5, 1.0].map(|k| view.camera_at(key, value + k * step).unwrap().pixel_rays(true));
            let at = |k: usize, h: f64| {
                &rays[if h == -1.0 {
                    0
                } else if h == -0.5 {
                    1
                } else if h == 0.5 {
                    2
                } else {
                    3
                }][k]
            };
            let direction = [Direction { rays: Some(&rates.rays), coordinate: None }];
            for (k, change) in view.reference(&direction).iter().enumerate() {
                let is_whole = rays.iter().all(|r| r[k].iter().all(|n| n.is_finite()))
                    && rates.rays[k].iter().all(|n| n.is_finite());
                let ray = &view.rays[k];
                if view.ids[k] != NONE && is_whole && flatness(ray, view.corners(view.ids[k])) < 10.0 {
                    let corners = view.corners(view.ids[k]);
                    let size = hit(ray, corners).iter().fold(1f64, |m, n| m.max(n.abs())) * flatness(ray, corners);
                    for n in 0..HIT_NUMBERS {
                        let (slope, off) = difference(1.0, 8.0 * size, |h| hit(at(k, h), corners)[n]);
                        let (slope, off) = (slope / step, off / step + 1e-9 * slope.abs() / step);
                        let got = change.hit[0][n];
                        assert!(
                            (got - slope).abs() <= off,
                            "{} {key}: pixel {k}, {n}: {got}, not {slope} +- {off}",
                            case.keys
                        );
                        tested[0] += 1;
                    }
                }
                let Some(edge) = change.edge.as_ref().filter(|edge| is_whole && edge.distance.abs() < 0.3) else {
                    continue;
                };
                let corners = view.corners(edge.triangle);
                let sign = sign(&view.rays[edge.pixels[0] as usize], corners);
                let values = [-1.0, -0.5, 0.5, 1.0].map(|h| coverage(at(k, h), corners, edge, sign));
                if values.iter().any(|c| *c <= 0.0 || *c >= 1.0) {
                    continue;
                }
                let (slope, off) = difference(1.0, 1e3, |h| coverage(at(k, h), corners, edge, sign));
                let (slope, off) = (slope / step, off / step);
                let got = edge.change[0];
                assert!(
                    (got - slope).abs() <= off,
                    "{} {key}: pixel {k}: coverage {got}, not {slope} +- {off}",
                    case.keys
                );
                tested[1] += 1;
            }
        }
    }
    println!("{} changes of hits, {} of coverage", tested[0], tested[1]);
    assert!(tested[0] > 200_000 && tested[1] > 500, "{tested:?}");
}

/// f64 of the kernel and of the reference round alike, each to 2^-53 some hundred times; then the kernel's number is rounded to f32.
const F32_ROUNDING: f64 = 1.0 / (1 << 24) as f64;
const F64_ROUNDING: f64 = 256.0 * f64::EPSILON;

/// How far two results of f64 may lie apart, relative to the largest numbers on the way: they are divided by the cosine between ray and
/// plane, and by the height of the triangle over its longest side, each once or twice.
fn condition(ray: &PixelRay, [a, b, c]: [DVec3; 3]) -> f64 {
    let longest = (b - a).length().max((c - b).length()).max((a - c).length());
    let needle = longest * longest / (b - a).cross(c - a).length();
    (flatness(ray, [a, b, c]) * needle).powi(2)
}

fn compare(
    what: &str,
    view: &View,
    got: &Changes,
    expected: &[PixelChange],
    directions: usize,
    scale: f64,
) -> [usize; 3] {
    let mut tested = [0; 3];
    for (k, change) in expected.iter().enumerate() {
        let own = &got.hits[HIT_NUMBERS * directions * k..][..HIT_NUMBERS * directions];
        if view.ids[k] == NONE {
            assert!(own.iter().all(|n| *n == 0.0), "{what}: pixel {k} hits nothing");
        } else {
            let tolerance = F64_ROUNDING * condition(&view.rays[k], view.corners(view.ids[k])) * scale;
            let largest = change.hit.iter().flatten().fold(1f64, |m, n| m.max(n.abs()));
            for (got, expected) in own.iter().zip(change.hit.iter().flatten()) {
                let off = (f64::from(*got) - expected).abs();
                let is_right =
                    off <= F32_ROUNDING * expected.abs() + tolerance * largest || got.is_nan() && expected.is_nan();
                assert!(is_right, "{what}: pixel {k}: {got}, not {expected}");
                tested[0] += 1;
            }
        }
        let (triangle, share) = (got.edges.triangle[k], f64::from(got.edges.coverage[k]));
        let Some(edge) = &change.edge else {
            assert!(triangle == NONE && share == 1.0, "{what}: pixel {k} has no edge");
            continue;
        };
        // a pixel is at least 2^-12 of what is seen: the slope of E is that much smaller than its terms
        let tolerance = 4096.0 * F64_ROUNDING * scale;
        if (triangle, got.edges.pixels[k]) != (edge.triangle, edge.pixels) {
            // two edges whose distances differ by 2^-20 px to within rounding
            let [own, others] = [share, edge.coverage].map(|share| (share - 0.5).abs());
            assert!(
                (own - others).abs() <= F32_ROUNDING + tolerance + 1.0 / f64::from(1 << 20),
                "{what}: pixel {k} is covered by {share}, not {}",
                edge.coverage
            );
            tested[2] += 1;
            continue;
        }
        assert!(
            (share - edge.coverage).abs() <= F32_ROUNDING + tolerance,
            "{what}: pixel {k} is covered by {share}, not {}",
            edge.coverage
        );
        // where one is within half a pixel and the other is not, by a rounding
        if (edge.distance.abs() - 0.5).abs() < tolerance {
            continue;
        }
        let largest = edge.change.iter().fold(1f64, |m, n| m.max(n.abs()));
        for (got, expected) in got.coverage[directions * k..].iter().zip(&edge.change) {
            let off = (f64::from(*got) - expected).abs();
            let is_right =
                off <= F32_ROUNDING * expected.abs() + tolerance * largest || got.is_nan() && expected.is_nan();
            assert!(is_right, "{what}: pixel {k}: coverage {got}, not {expected}");
            tested[1] += 1;
        }
    }
    tested
}

/// The kernels on an adapter, with its own f64 or in words.
fn kernels_agree(has_f64: bool, cases: &[Case]) {
    let Some(engine) = engine_on(|gpu| gpu.has.f64 &= has_f64) else { return };
    let kernels = Gradient::new(&engine.gpu, true).unwrap();
    let mut all = [0; 3];
    for case in cases {
        let view = View::of_case(case);
        let mut add = |tested: [usize; 3]| (0..3).for_each(|n| all[n] += tested[n]);
        let got = view.with_seen(|seen| kernels.changes(seen, None)).unwrap();
        add(compare(case.keys, &view, &got, &view.reference(&Direction::vertices()), VERTEX_DIRECTIONS, 1.0));
        for key in case.numbers {
            let rates = view.rates(key);
            let got = view.with_seen(|seen| kernels.changes(seen, Some(&rates.rays))).unwrap();
            let expected = view.reference(&[Direction { rays: Some(&rates.rays), coordinate: None }]);
            let scale = rates.rays.iter().flatten().filter(|n| n.is_finite()).fold(1f64, |m, n| m.max(n.abs()));
            add(compare(&format!("{} {key}", case.keys), &view, &got, &expected, 1, scale));
        }
    }
    println!("{} changes of hits, {} of coverage, {} other edges at one distance", all[0], all[1], all[2]);
    assert!(all[0] > 20_000 * cases.len() && all[1] > 1000 * cases.len() && all[2] * 1000 < all[1], "{all:?}");
}

#[test]
fn the_kernels_agree_with_the_reference() {
    kernels_agree(true, &CASES);
}

#[test]
#[ignore = "slow: make test-all"]
fn the_kernels_agree_with_the_reference_without_f64() {
    kernels_agree(false, &CASES[..2]);
}

/// A plane z = 0 in front of a pinhole at z = 4 whose picture is 4 high there; two triangles that meet at x = `EDGE`.
const EDGE: f64 = 0.317;

fn plane() -> View {
    let size = 2.0 * (20f64.to_radians()).tan() * 4.0;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("plane.obj");
    std::fs::write(&path, format!("v -9 -9 0\nv {EDGE} -9 0\nv {EDGE} 9 0\nf 1 2 3\n")).unwrap();
    let view = View::of(
        &format!("[[mesh]]\nfile = {path:?}\n"),
        SIZE,
        "kind = \"pinhole\"\neye = [0, 0, 4]\ntarget = [0, 0, 0]\nvfov = 40",
    );
    assert!(size > 2.9 && view.ids.iter().filter(|id| **id != NONE).count() > 500);
    view
}

/// f64 of numbers of some units through some ten operations.
const CLOSE: f64 = 1e-13;

fn assert_close(what: &str, got: f64, expected: f64, tolerance: f64) {
    assert!((got - expected).abs() <= tolerance * (1.0 + expected.abs()), "{what}: {got}, not {expected}");
}

/// The place of a pixel's centre on the plane, and half a pixel's size there.
fn on_plane(pixel: usize) -> (f64, f64, f64) {
    let (i, j) = (pixel as u32 % SIZE.0, pixel as u32 / SIZE.0);
    let half = 4.0 * 20f64.to_radians().tan() / f64::from(SIZE.1);
    let x = (2.0 * f64::from(i) + 1.0 - f64::from(SIZE.0)) * half;
    let y = (f64::from(SIZE.1) - 2.0 * f64::from(j) - 1.0) * half;
    (x, y, half)
}

#[test]
fn of_a_plane_before_a_pinhole_by_its_corners() {
    let view = plane();
    for (k, change) in view.reference(&Direction::vertices()).iter().enumerate().filter(|(k, _)| view.ids[*k] != NONE) {
        let weights = &change.values[5..8];
        let (x, y, _) = on_plane(k);
        assert_close("x", change.values[2], x, CLOSE);
        for (direction, hit) in change.hit.iter().enumerate() {
            // D = (x / 4, y / 4, -1): moved towards the eye, the plane is hit so much earlier
            let dt = if direction % 3 == 2 { -weights[direction / 3] } else { 0.0 };
            assert_close("t", hit[0], dt, CLOSE);
            assert_close("Z", hit[1], dt * (x * x + y * y + 16.0).sqrt() / 4.0, CLOSE);
            assert_close("z", hit[4], -dt, CLOSE);
            assert_close("the sum of weights", hit[5] + hit[6] + hit[7], 0.0, CLOSE);
        }
        // the two corners at the edge share what is beyond the first one: (x + 9) / (EDGE + 9)
        let by_edge = change.hit[3][5] + change.hit[6][5];
        assert_close("the first weight by the edge", by_edge, (x + 9.0) / (EDGE + 9.0).powi(2), CLOSE);
    }
}

#[test]
fn of_a_plane_before_a_pinhole_by_the_camera() {
    let view = plane();
    let half_angle = 20f64.to_radians();
    for (key, expected) in [
        // P moves, and the directions do not
        ("eye.2", Box::new(|x: f64, y: f64| [1.0, x / 4.0, y / 4.0, 0.0]) as Box<dyn Fn(f64, f64) -> [f64; 4]>),
        // k = tan(vfov / 2), vfov in degrees
        (
            "vfov",
            Box::new(move |x: f64, y: f64| {
                let share = (1.0 / (half_angle.cos().powi(2) * half_angle.tan())) * std::f64::consts::PI / 360.0;
                [0.0, x * share, y * share, 0.0]
            }),
        ),
    ] {
        let rates = view.rates(key);
        let tolerance = CLOSE + 16.0 * (rates.error[0] + rates.error[1]);
        assert!(tolerance < 1e-9, "{key}: {:?}", rates.error);
        let changes = view.reference(&[Direction { rays: Some(&rates.rays), coordinate: None }]);
        for (k, change) in changes.iter().enumerate().filter(|(k, _)| view.ids[*k] != NONE) {
            let (x, y, _) = on_plane(k);
            let got = [change.hit[0][0], change.hit[0][2], change.hit[0][3], change.hit[0][4]];
            for (got, expected) in got.into_iter().zip(expected(x, y)) {
                assert_close(&format!("{key} at {x}, {y}"), got, expected, tolerance);
            }
        }
    }
}

#[test]
fn coverage_at_an_upright_edge_is_the_share_of_the_pixel() {
    let view = plane();
    let mut seen = 0;
    for (k, change) in view.reference(&Direction::vertices()).iter().enumerate() {
        let (x, y, half) = on_plane(k);
        // only the upright edge is in the picture; it passes through one column
        if (x - EDGE).abs() > half {
            continue;
        }
        let edge = change.edge.as_ref().unwrap();
        assert_close("coverage", edge.coverage, ((EDGE - (x - half)) / (2.0 * half)).clamp(0.0, 1.0), CLOSE);
        // the edge moves as its corners do, by the weights of its place
        assert_close("by both corners", edge.change[3] + edge.change[6], 1.0 / (2.0 * half), 1e-12);
        assert_close("by the lower one", edge.change[3], (9.0 - y) / 18.0 / (2.0 * half), 1e-12);
        seen += 1;
    }
    assert!(seen > 10, "{seen} pixels");
}

#[test]
fn rates_of_a_fisheye_are_those_of_its_polynomial() {
    let view = View::of_case(&CASES[16]);
    let k = [0.08, -0.02, 0.01, -0.003];
    let theta_of = |pixel: usize| {
        let d = DVec3::from_slice(&view.rays[pixel][3..6]);
        let ahead = (DVec3::new(0.1, 0.05, 0.0) - DVec3::new(1.5, 2.0, 3.0)).normalize();
        (d.dot(ahead).clamp(-1.0, 1.0).acos(), ahead, d)
    };
    for (n, key) in ["k1", "k2", "k3", "k4"].into_iter().enumerate() {
        let rates = view.rates(key);
        let mut largest = 0f64;
        for pixel in 0..view.rays.len() {
            let (theta, ahead, d) = theta_of(pixel);
            let power = |n: usize| theta.powi(2 * n as i32);
            // theta (1 + k1 theta^2 + ...) stays, theta changes
            let slope: f64 = 1.0 + (0..4).map(|m| (2 * m + 3) as f64 * k[m] * power(m + 1)).sum::<f64>();
            let expected = -theta * power(n + 1) / slope;
            let away = (d * d.dot(ahead) - ahead).normalize_or_zero();
            let got = DVec3::from_slice(&rates.rays[pixel][3..6]).dot(away);
            // acos rounds angles near the axis to 2^-26
            let tolerance = rates.error[1] + 1e-12 / rates.step + 1e-7 * expected.abs();
            assert!((got - expected).abs() <= tolerance, "{key}, pixel {pixel}: {got}, not {expected}");
            largest = largest.max(expected.abs());
        }
        println!("{key}: step {:e}, error {:e} of {largest:e}", rates.step, rates.error[1]);
        // of the fourth power of 1/256, with the derivatives of high orders that a polynomial of degree 9 has
        assert!(rates.error[1] < 1e-8 * largest);
    }
}

#[test]
fn what_does_not_change_smoothly_has_no_gradient() {
    let view = View::of(
        BALL,
        SIZE,
        "kind = \"panorama\"\ncenter = [0, 0, 0]\nradius = 3\nelevation = 2\nheight = 2.4\npieces = 24",
    );
    let refused = |key: &str| {
        let value = view.scene.camera_keys.number(key, &Loading::default()).unwrap();
        let error = rate(&view.camera, (key, value), &|v| view.camera_at(key, v), false).unwrap_err();
        assert!(error.exit_code() == 2 && !error.to_string().contains('\n'), "{error}");
        error.to_string()
    };
    let text = refused("pieces");
    assert!(text.contains("has no gradient here") && text.contains("whole number"), "{text}");
}
