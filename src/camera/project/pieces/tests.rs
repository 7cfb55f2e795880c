use super::*;
use crate::camera::Rays;
use crate::camera::mesh::spec::{CameraVertex, MeshCameraSpec};
use crate::camera::spec::{CameraKind, CameraSpec};
use crate::testing::Rng;

/// Two pieces for each of 9 x 7 cells, a little beyond the image on every side; `ray`: near and far points over [0, 1]^2.
fn mesh(rng: &mut Rng, weights: bool, ray: impl Fn(DVec2, &mut Rng) -> (DVec3, DVec3)) -> Camera {
    let (columns, rows) = (9, 7);
    let mut vertices = Vec::new();
    for (i, j) in (0..=rows).flat_map(|j| (0..=columns).map(move |i| (i, j))) {
        let image = 1.2 * DVec2::new(f64::from(i) / 9.0, f64::from(j) / 7.0) - 0.1;
        let w = if weights { (rng.signed()).exp2() } else { 1.0 };
        let (near, far) = ray(image, rng);
        vertices.push(CameraVertex { image: image.to_array(), near, far, w });
    }
    let cells = (0..rows).flat_map(|j| (0..columns).map(move |i| (j * (columns + 1) + i) as u32));
    let triangles = cells.flat_map(|k| [[k, k + 1, k + 10], [k + 11, k + 1, k + 10]]).collect();
    let kind = CameraKind::new("mesh", MeshCameraSpec { vertices, triangles, normalize: false });
    Camera::new(&CameraSpec { kind, t_range: [f64::NEG_INFINITY, f64::INFINITY] }, Some((90, 70))).unwrap()
}

/// What the tree finds is what all pieces, one by one and without any bound, find.
fn assert_nothing_is_lost(name: &str, camera: &Camera, points: impl Iterator<Item = DVec3>) -> [usize; 2] {
    let Rays::Pieces(pieces) = &camera.layers[0] else { unreachable!() };
    let search = Search::new(pieces, camera);
    let mut counts = [0; 2];
    for point in points {
        let shown = search.images(point, super::super::tree::WHOLE);
        let mut all = Shown::default();
        (0..pieces.pieces.len() as u32).for_each(|k| search.images_in(k, point, &mut all));
        let sorted = |shown: &Shown| {
            let mut found: Vec<_> = shown.found.iter().map(|f| (f.piece, f.t.to_bits(), f.place.to_string())).collect();
            found.sort();
            found
        };
        assert_eq!((sorted(&shown), shown.degenerate), (sorted(&all), all.degenerate), "{name}: {point}");
        counts[0] += all.found.len();
        counts[1] += usize::from(all.degenerate.is_some());
    }
    counts
}

#[test]
#[ignore = "slow: make test-all"]
fn the_tree_loses_no_image() {
    for seed in 0..20 {
        let mut rng = Rng(seed);
        // turned in space, so that no axis is special; every second one torn apart and weighted
        let turn = glam::DMat3::from_axis_angle(rng.vector().normalize(), 3.0 * rng.unit());
        let torn = if seed % 2 == 1 { 1.0 } else { 0.05 };
        let camera = mesh(&mut rng, seed % 2 == 1, |q, rng| {
            let q = q - 0.5;
            let ends = ((2.2 * q).extend(2.0) + torn * rng.vector(), (3.2 * q).extend(-2.0) + torn * rng.vector());
            (turn * ends.0, turn * ends.1)
        });
        let points = (0..300).map(|_| rng.vector());
        let [found, _] = assert_nothing_is_lost(&format!("seed {seed}"), &camera, points);
        assert!(found > 100, "{found}");
    }
}

#[test]
fn the_tree_loses_no_eye_and_no_slit() {
    for offset in [DVec3::ZERO, DVec3::new(300.0, -20.0, 1e4)] {
        let mut rng = Rng(3);
        let eye = DVec3::new(0.3, -0.2, 4.0) + offset;
        let pinhole = mesh(&mut rng, true, |q, _| (eye, (q - 0.5).extend(0.0) + offset));
        let around = (-4..=4).map(|e| eye + f64::from(e).powi(5) * 1e-13 * eye.length() * DVec3::X);
        let [_, degenerate] = assert_nothing_is_lost("pinhole", &pinhole, around);
        assert!(degenerate > 0 && degenerate < 9, "{degenerate}");
        // slits at z = 4 along y and at z = 6 along x
        let slits = mesh(&mut rng, false, |q, _| {
            let q = q - 0.5;
            (q.extend(2.0) + offset, DVec3::new(3.0 * q.x, 2.0 * q.y, -2.0) + offset)
        });
        let on = (-20..=20).map(|k| DVec3::new(0.0, 0.05 * f64::from(k), 4.0) + offset);
        let [_, degenerate] = assert_nothing_is_lost("slits", &slits, on);
        assert!(degenerate > 5 && degenerate < 41, "{degenerate}");
    }
}
