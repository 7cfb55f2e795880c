//! Projection agrees with coverage: every image of a point has a ray through it, and where a pixel sees a point, the
//! point has an image at that pixel; for every kind of camera, folds, slits and shared faces included.

use crate::common;

use anamorph::internals::camera::kinds::glc::Glc;
use anamorph::internals::camera::kinds::orthographic::Orthographic;
use anamorph::internals::camera::kinds::pinhole::Pinhole;
use anamorph::internals::camera::project::{Degenerate, Projector};
use anamorph::internals::camera::spec::CameraKind;
use anamorph::internals::camera::{Camera, Curve, CurveMap, Curves, Field, Ray, RayMap, Rays};
use common::cameras::{MeshShape, glc_of_each_class, mesh_camera, pinhole, raymap, two_plane};
use common::projection::{Counts, PLACE_PX, check, images_see_their_points, pixels_are_images_of_what_they_see};
use common::rng::Rng;
use common::{ALL_T, FORWARD, camera};
use glam::{DMat2, DVec2, DVec3};
use std::sync::Arc;

const SIZE: (u32, u32) = (60, 44);

#[test]
fn linear_cameras_of_every_class() {
    for (k, (name, kind)) in glc_of_each_class().into_iter().enumerate() {
        let counts = check(name, &camera(kind, SIZE, ALL_T), k as u64);
        assert!(counts[1] + counts[2] > 50, "{name}: {counts:?}");
    }
    check("pinhole", &camera(pinhole(DVec3::new(0.3, 0.4, 4.0), DVec3::ZERO, 40.0), SIZE, FORWARD), 20);
    let (eye, target, up) = (DVec3::new(2.0, 1.0, 3.0), DVec3::ZERO, DVec3::Y);
    check(
        "orthographic",
        &camera(CameraKind::new("orthographic", Orthographic { eye, target, up, height: 2.5 }), SIZE, FORWARD),
        21,
    );
}

#[test]
fn a_point_has_three_images_in_a_continuous_camera() {
    // near and far planes at an angle, a far triangle turned over: rays twist by more than a half turn
    let mut seen = Counts::default();
    for seed in 0..60 {
        let mut rng = Rng(seed);
        let near = [0; 3].map(|_| 3.0 * rng.vector());
        let far = [0; 3].map(|_| 3.0 * rng.vector());
        let camera = camera(CameraKind::new("glc", Glc { near, far }), SIZE, ALL_T);
        let counts = images_see_their_points("cglc", &camera, &mut rng, 60);
        (0..8).for_each(|k| seen[k] += counts[k]);
        pixels_are_images_of_what_they_see("cglc", &camera, &mut rng, 60);
    }
    assert!(seen[2] > 20 && seen[3] > 3 && seen[4..] == [0; 4], "{seen:?}");
}

#[test]
fn meshes_of_pieces() {
    for (k, shape) in [
        MeshShape::default(),
        MeshShape { normalize: true, ..Default::default() },
        MeshShape { weights: true, ..Default::default() },
        MeshShape { normalize: true, weights: true, discontinuous: true },
    ]
    .into_iter()
    .enumerate()
    {
        check(&format!("{shape:?}"), &camera(mesh_camera(k as u64, 5, 4, shape), SIZE, FORWARD), 30 + k as u64);
    }
}

#[test]
fn a_point_on_a_border_has_one_image() {
    let camera = camera(mesh_camera(3, 5, 4, MeshShape::default()), SIZE, FORWARD);
    let Rays::Pieces(pieces) = &camera.layers[0] else { unreachable!() };
    let (projector, mut rng) = (Projector::new(&camera), Rng(5));
    for _ in 0..300 {
        let piece = rng.below(pieces.pieces.len());
        let [a, b, _] = pieces.pieces[piece].corners_px.unwrap();
        let place = a.lerp(b, rng.unit());
        let ray = pieces.bundle_at_place(piece as u32, place).ray(0.0, 0.0);
        let images = projector.project(ray.origin + 0.5 * ray.direction).images;
        let there = images.iter().filter(|i| DVec2::new(i.x, i.y).distance(place) < PLACE_PX).count();
        assert_eq!(there, 1, "{piece} at {place}: {images:?}");
    }
}

#[test]
fn tables_of_rays() {
    check("raymap", &raymap(SIZE.0, SIZE.1, FORWARD), 40);
}

/// All round about the y axis, from a ring of eyes.
#[derive(Debug)]
struct Ring(f64);

impl RayMap for Ring {
    fn ray(&self, a: f64, b: f64) -> Option<Ray> {
        let (sin, cos) = (std::f64::consts::TAU * a).sin_cos();
        let out = DVec3::new(sin, 0.0, -cos);
        Some(Ray { origin: self.0 * out, direction: out + DVec3::Y * (1.0 - 2.0 * b) })
    }
}

/// A full-frame fisheye at z = 4; no rays outside of its circle.
#[derive(Debug)]
struct Fisheye;

impl RayMap for Fisheye {
    fn ray(&self, a: f64, b: f64) -> Option<Ray> {
        let q = DVec2::new(2.0 * a - 1.0, 1.0 - 2.0 * b);
        let angle = 0.5 * q.length();
        let side = q.normalize_or_zero() * angle.sin();
        (q.length() <= 1.0).then_some(Ray { origin: 4.0 * DVec3::Z, direction: side.extend(-angle.cos()) })
    }
}

/// Folded: the columns of the image run to and fro.
#[derive(Debug)]
struct Folded;

impl RayMap for Folded {
    fn ray(&self, a: f64, b: f64) -> Option<Ray> {
        let x = 0.8 * (7.0 * a).sin();
        let origin = DVec3::new(x, 1.5 * (1.0 - 2.0 * b), 3.0);
        Some(Ray { origin, direction: DVec3::new(0.1 * x, 0.05, -1.0) })
    }
}

fn formula(map: impl RayMap + 'static, t_range: [f64; 2]) -> Camera {
    Camera::of("formula", SIZE, t_range, Rays::Field(Field::of_map(SIZE.0, SIZE.1, Arc::new(map)).unwrap()))
}

#[test]
fn formulas() {
    check("fisheye", &formula(Fisheye, FORWARD), 50);
    // from inside the ring: behind the eyes, once a turn each way
    check("ring", &formula(Ring(3.0), ALL_T), 51);
    let counts = check("folded", &formula(Folded, FORWARD), 52);
    assert!(counts[2] + counts[3] > 66, "{counts:?}");
}

/// Curves from z = 2 to z = -2, bent across; folded in x.
#[derive(Debug)]
struct Bent(usize);

impl CurveMap for Bent {
    fn degree(&self) -> usize {
        self.0
    }

    fn curve(&self, a: f64, b: f64) -> Option<(u32, Curve)> {
        let q = DVec2::new(2.2 * (a - 0.5) + 0.4 * (9.0 * a).sin(), 2.2 * (0.5 - b));
        let p = [
            (1.1 * q).extend(2.0),
            (q + DVec2::new(0.9, 0.3 * q.x)).extend(0.8),
            (1.2 * q - DVec2::new(0.5, 0.2)).extend(-0.9),
            (1.5 * q).extend(-2.0),
        ];
        let points = [vec![p[0], p[3]], vec![p[0], p[1], p[3]], p.to_vec()];
        Some((u32::from(b > 0.5), Curve::new(&points[self.0 - 1])))
    }

    fn piece_count(&self) -> usize {
        2
    }
}

fn bent(degree: usize) -> Rays {
    Rays::Curves(Curves::new(SIZE.0, SIZE.1, Arc::new(Bent(degree))))
}

#[test]
fn curves_of_every_degree() {
    for degree in 1..=3 {
        let camera = Camera::of("projector", SIZE, [0.0, 1.0], bent(degree));
        let counts = check(&format!("degree {degree}"), &camera, 60 + degree as u64);
        assert!(counts[1..].iter().sum::<usize>() > 40, "{counts:?}");
    }
}

/// Two pinhole segments in line: from t = 1 to 4 and from 4 to 6 of the rays of a pinhole at z = 4.
fn chain() -> Camera {
    let part = |from: f64, to: f64| {
        let corners = [DVec2::new(-0.4, 0.3), DVec2::new(0.4, 0.3), DVec2::new(-0.4, -0.3)];
        let on = |t: f64| corners.map(|c| DVec3::new(c.x * t, c.y * t, 4.0 - t));
        camera(CameraKind::new("glc", Glc { near: on(from), far: on(to) }), SIZE, [0.0, 1.0])
    };
    let layers = [part(1.0, 4.0), part(4.0, 6.0)].into_iter().flat_map(|c| c.layers).collect();
    Camera { layers, ..part(1.0, 4.0) }
}

#[test]
fn chains() {
    let camera = chain();
    check("chain", &camera, 70);
    let mut bent_chain = camera.clone();
    bent_chain.layers.push(bent(2));
    check("chain with curves", &bent_chain, 71);
    // a point in the shared face belongs to the lower layer alone
    let images = Projector::new(&camera).project(DVec3::new(0.4, 0.3, 0.0)).images;
    assert_eq!(images.len(), 1, "{images:?}");
    let image = images[0];
    assert_eq!((image.layer, image.piece), (0, 0));
    assert!((image.t - 1.0).abs() < 1e-12 && (image.a - 0.625).abs() < 1e-9 && (image.b - 0.375).abs() < 1e-9);
}

#[test]
fn known_points_land_at_known_places() {
    // 90 degrees high, 4:3: at distance 3 the picture is 8 x 6 wide, so (0.5, 1.5) is at a = 9/16, b = 1/4
    let kind = CameraKind::new("pinhole", Pinhole { eye: DVec3::ZERO, target: DVec3::NEG_Z, up: DVec3::Y, vfov: 90.0 });
    let camera = camera(kind, (80, 60), FORWARD);
    let projector = Projector::new(&camera);
    let images = projector.project(DVec3::new(0.5, 1.5, -3.0)).images;
    let [image] = images[..] else { panic!("{images:?}") };
    assert!((image.a - 9.0 / 16.0).abs() < 1e-13 && (image.b - 0.25).abs() < 1e-13 && (image.t - 3.0).abs() < 1e-13);
    assert!((image.x - 45.0).abs() < 1e-11 && (image.y - 15.0).abs() < 1e-11);
    // behind it, and beside the picture
    assert!(projector.project(DVec3::new(0.5, 1.5, 3.0)).images.is_empty());
    assert!(projector.project(DVec3::new(9.0, 1.5, -3.0)).images.is_empty());
}

fn degenerate(camera: &Camera, point: DVec3) -> Option<Degenerate> {
    Projector::new(camera).project(point).degenerate
}

#[test]
fn points_on_slits_and_eyes_are_told() {
    let eye = DVec3::new(0.3, -0.4, 4.0);
    let at_eye = camera(pinhole(eye, DVec3::ZERO, 40.0), SIZE, FORWARD);
    assert_eq!(degenerate(&at_eye, eye), Some(Degenerate::Eye));
    assert_eq!(degenerate(&at_eye, eye + 1e-6 * DVec3::X), None);
    // the rays of a two-plane pinhole meet behind the near plane, at t = -1/2
    let (near, far) = two_plane(DMat2::from_diagonal(DVec2::splat(1.5)), DMat2::from_diagonal(DVec2::splat(4.5)));
    let two = CameraKind::new("glc", Glc { near, far });
    assert_eq!(degenerate(&camera(two.clone(), SIZE, ALL_T), 4.0 * DVec3::Z), Some(Degenerate::Eye));
    assert_eq!(degenerate(&camera(two, SIZE, FORWARD), 4.0 * DVec3::Z), None);
    // slits at t = -1/2 (x = 0 there) and t = -1 (y = 0 there)
    let (near, far) = two_plane(DMat2::from_diagonal(DVec2::new(1.0, 1.0)), DMat2::from_diagonal(DVec2::new(3.0, 2.0)));
    let slits = camera(CameraKind::new("glc", Glc { near, far }), SIZE, ALL_T);
    assert_eq!(degenerate(&slits, DVec3::new(0.0, 0.2, 4.0)), Some(Degenerate::Slit));
    assert_eq!(degenerate(&slits, DVec3::new(0.4, 0.0, 6.0)), Some(Degenerate::Slit));
    // the slit goes on where no ray of the image does
    assert_eq!(degenerate(&slits, DVec3::new(0.0, 0.3, 4.0)), None);
    assert_eq!(degenerate(&slits, DVec3::new(0.01, 0.2, 4.0)), None);
    // formulas: an eye, and the axis that all rays of a ring's row meet
    assert_eq!(degenerate(&formula(Fisheye, FORWARD), 4.0 * DVec3::Z), Some(Degenerate::Eye));
    let ring = formula(Ring(3.0), ALL_T);
    assert_eq!(degenerate(&ring, 0.7 * DVec3::Y), Some(Degenerate::Slit));
    assert_eq!(degenerate(&ring, DVec3::new(0.3, 0.7, 0.0)), None);
}

#[test]
fn a_slit_along_which_t_changes() {
    // The middle row's rays are one line, their origins slide along it: a point on it is seen all along the row.
    let near = [DVec3::new(0.0, 0.0, 2.0), DVec3::new(0.0, 0.0, 1.0), DVec3::new(0.0, 1.0, 2.0)];
    let far = [DVec3::new(-0.1, 0.0, -2.0), DVec3::new(-0.1, 0.0, -3.0), DVec3::new(0.1, 1.0, -2.0)];
    let rows = camera(CameraKind::new("glc", Glc { near, far }), SIZE, FORWARD);
    assert_eq!(degenerate(&rows, DVec3::new(0.0, 0.5, 0.0)), Some(Degenerate::Slit));
    assert_eq!(degenerate(&rows, DVec3::new(0.01, 0.5, 0.0)), None);
    // before every origin, after t = 0
    assert_eq!(degenerate(&rows, DVec3::new(0.0, 0.5, 2.4)), None);
    // A slit that t = 0 meets at a slant: the near triangle has no area.
    let near = [DVec3::new(0.0, 0.0, 1.0), DVec3::new(1.0, 0.0, 1.5), DVec3::new(0.0, 0.0, 1.0)];
    let far = [DVec3::new(0.2, 0.0, -1.0), DVec3::new(0.7, 0.1, -1.0), DVec3::new(0.2, 1.0, -1.0)];
    let slanted = camera(CameraKind::new("glc", Glc { near, far }), SIZE, ALL_T);
    assert_eq!(degenerate(&slanted, DVec3::new(0.5, 0.0, 1.25)), Some(Degenerate::Slit));
    assert_eq!(degenerate(&slanted, DVec3::new(0.5, 0.1, 1.25)), None);
}

/// Every curve runs through the origin at t = 1/2.
#[derive(Debug)]
struct Hourglass;

impl CurveMap for Hourglass {
    fn degree(&self) -> usize {
        2
    }

    fn curve(&self, a: f64, b: f64) -> Option<(u32, Curve)> {
        let q = DVec2::new(2.0 * a - 1.0, 1.0 - 2.0 * b);
        // X(1/2) = (P0 + 2 P1 + P2) / 4
        let (from, to) = (q.extend(2.0), (0.5 * q).extend(-2.0));
        Some((0, Curve::new(&[from, -0.5 * (from + to), to])))
    }
}

fn curved(map: impl CurveMap + 'static, (w, h): (u32, u32)) -> Camera {
    Camera::of("projector", (w, h), [0.0, 1.0], Rays::Curves(Curves::new(w, h, Arc::new(map))))
}

#[test]
fn a_point_that_all_curves_run_through_is_told_and_those_near_it_are_found() {
    for size in [SIZE, (400, 300)] {
        let camera = curved(Hourglass, size);
        let projector = Projector::new(&camera);
        let eye = projector.project(DVec3::ZERO);
        assert_eq!((eye.degenerate, eye.images.len()), (Some(Degenerate::Eye), 0));
        let curve = Hourglass.curve(0.6, 0.3).unwrap().1;
        let place = DVec2::new(0.6 * f64::from(size.0), 0.3 * f64::from(size.1));
        for t in [0.5 + 1e-5, 0.51, 0.7] {
            let all = projector.project(curve.at(t));
            let found = all.images.iter().any(|i| DVec2::new(i.x, i.y).distance(place) < PLACE_PX);
            assert!(found && !all.incomplete, "{size:?} {t}: {all:?}");
        }
    }
}

/// Curves that have nothing to do with their neighbours.
#[derive(Debug)]
struct Noise;

impl CurveMap for Noise {
    fn degree(&self) -> usize {
        3
    }

    fn curve(&self, a: f64, b: f64) -> Option<(u32, Curve)> {
        let mut rng = Rng(a.to_bits() ^ b.to_bits().rotate_left(17));
        Some((0, Curve::new(&[0; 4].map(|_| rng.vector()))))
    }
}

#[test]
#[ignore = "slow: make test-all"]
fn no_search_goes_on_forever() {
    let camera = curved(Noise, SIZE);
    let all = Projector::new(&camera).project(DVec3::ZERO);
    assert!(all.incomplete);
    assert!(serde_json::to_string(&all).unwrap().ends_with("\"incomplete\":true}"));
}
