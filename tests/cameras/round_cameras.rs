//! Cameras with one eye whose picture is bent: fisheyes, the sphere, the cylinder; exact, and in strips.

use crate::common;

use anamorph::internals::camera::{Camera, Ray};
use common::written::{assert_refused, camera};
use glam::DVec3;

/// An eye at the origin that looks along -z with y up: right, up, forward are x, y, -z.
const POSE: &str = "eye = [0, 0, 0]\ntarget = [0, 0, -1]\n";

/// Sines, cosines and three products of numbers up to 1, 2^-53 each, with a margin for the library's own functions.
const ROUNDING: f64 = 1e-14;

fn direction(camera: &Camera, i: u32, j: u32) -> DVec3 {
    let Ray { origin, direction } = camera.ray(i, j).unwrap();
    assert_eq!(origin, DVec3::ZERO);
    direction
}

fn assert_direction(camera: &Camera, (i, j): (u32, u32), expected: DVec3) {
    let d = direction(camera, i, j);
    assert!((d - expected).length() <= ROUNDING, "{} at {i},{j}: {d}, not {expected}", camera.kind);
}

/// The unit direction at these degrees to the right of ahead and above the horizon.
fn towards(lon: f64, lat: f64) -> DVec3 {
    let (lon, lat) = (lon.to_radians(), lat.to_radians());
    DVec3::new(lat.cos() * lon.sin(), lat.sin(), -lat.cos() * lon.cos())
}

#[test]
fn a_fisheye_sees_known_angles_at_known_pixels() {
    // the middle row of 9 x 9: pixel 7 is at 2/3 of the circle's radius, and so is the row 1
    for (mapping, fov, angle) in [
        ("equidistant", 180.0, 60.0),
        ("equidistant", 270.0, 90.0),
        // sin(theta / 2) = 2/3 sin(90)
        ("equisolid", 360.0, 2.0 * (2.0_f64 / 3.0).asin().to_degrees()),
        // tan(theta / 2) = 2/3 tan(45)
        ("stereographic", 180.0, 2.0 * (2.0_f64 / 3.0).atan().to_degrees()),
        // sin(theta) = 2/3 sin(30)
        ("orthographic", 60.0, (1.0_f64 / 3.0).asin().to_degrees()),
    ] {
        let camera = camera(&format!("{POSE}kind = 'fisheye'\nfov = {fov}\nmapping = '{mapping}'"), (9, 9));
        assert_direction(&camera, (4, 4), DVec3::NEG_Z);
        assert_direction(&camera, (7, 4), towards(angle, 0.0));
        assert_direction(&camera, (1, 4), towards(-angle, 0.0));
        assert_direction(&camera, (4, 1), towards(0.0, angle));
        assert_direction(&camera, (4, 7), towards(0.0, -angle));
        // (3, 3) of 4.5 px is inside the circle, (4, 4) not
        assert!(camera.ray(7, 1).is_some_and(|r| r.direction.x > 0.0 && r.direction.y > 0.0));
        assert!(camera.ray(8, 0).is_none() && camera.ray(0, 8).is_none());
    }
}

#[test]
fn pixels_exactly_on_the_rim_have_rays() {
    let mut on_rim = 0;
    // a rim meets pixel centres if one side is odd and one even, and its radius is the hypotenuse of a Pythagorean triple
    for (w, h) in
        [(6, 5), (5, 6), (14, 13), (13, 40), (26, 25), (24, 25), (65, 100), (66, 65), (85, 86), (126, 125), (325, 330)]
    {
        let camera = camera(&format!("{POSE}kind = 'fisheye'\nfov = 180"), (w, h));
        for (i, j) in (0..h).flat_map(|j| (0..w).map(move |i| (i, j))) {
            // in half pixels
            let (x, y) = (2 * i64::from(i) + 1 - i64::from(w), 2 * i64::from(j) + 1 - i64::from(h));
            let outside = x * x + y * y - i64::from(w.min(h)).pow(2);
            assert_eq!(camera.ray(i, j).is_some(), outside <= 0, "{i},{j} of {w}x{h}");
            if outside == 0 {
                on_rim += 1;
                assert!(direction(&camera, i, j).z.abs() <= ROUNDING, "{i},{j} of {w}x{h}: not at 90 degrees");
            }
        }
    }
    assert!(on_rim > 100, "{on_rim}");
}

#[test]
fn a_full_frame_fisheye_has_its_field_of_view_along_the_diagonal() {
    // the diagonal of 40 x 30 is 50 px: 20 px from the middle is 0.8 of half of it
    let wide = camera(&format!("{POSE}kind = 'fisheye'\nfov = 200\nframe = 'full'"), (41, 31));
    let half_diagonal = 41.0_f64.hypot(31.0) / 2.0;
    assert_direction(&wide, (40, 15), towards(20.0 / half_diagonal * 100.0, 0.0));
    assert!((0..31).all(|j| (0..41).all(|i| wide.ray(i, j).is_some())));
    let circle = camera(&format!("{POSE}kind = 'fisheye'\nfov = 200"), (41, 31));
    assert_direction(&circle, (35, 15), towards(15.0 / 15.5 * (10.0 / 15.0) * 150.0, 0.0));
    assert!(circle.ray(36, 15).is_none() && circle.ray(0, 0).is_none());
}

#[test]
fn a_sphere_is_longitude_and_latitude() {
    let whole = camera(&format!("{POSE}kind = 'sphere'"), (36, 18));
    for (i, j) in [(0, 0), (35, 17), (18, 9), (26, 4), (3, 12)] {
        assert_direction(&whole, (i, j), towards(f64::from(i) * 10.0 - 175.0, 85.0 - f64::from(j) * 10.0));
    }
    let part = camera(&format!("{POSE}kind = 'sphere'\nlon = [-10, 80]\nlat = [0, 60]"), (9, 6));
    assert_direction(&part, (8, 0), towards(75.0, 55.0));
}

#[test]
fn a_cylinder_is_angle_and_tangent() {
    let whole = camera(&format!("{POSE}kind = 'cylinder'\ntan = [-1, 3]"), (36, 8));
    for (i, j) in [(0, 0), (35, 7), (18, 4), (26, 1)] {
        let up = DVec3::Y * (2.75 - 0.5 * f64::from(j));
        assert_direction(&whole, (i, j), towards(f64::from(i) * 10.0 - 175.0, 0.0) + up);
    }
    let quarter = camera(&format!("{POSE}kind = 'cylinder'\nfov = 90\nvfov = 90"), (9, 5));
    assert_direction(&quarter, (8, 0), towards(40.0, 0.0) + 0.8 * DVec3::Y);
    // pixels as high as they are wide: 10 degrees
    let square = camera(&format!("{POSE}kind = 'cylinder'"), (36, 9));
    assert_direction(&square, (18, 3), towards(5.0, 0.0) + 10.0_f64.to_radians() * DVec3::Y);
}

/// The exact cylinder's image place of a direction, in pixels.
fn on_the_cylinder(d: DVec3, size: (u32, u32), fov: f64, tan: [f64; 2]) -> (f64, f64) {
    let angle = d.x.atan2(-d.z);
    let v = d.y / d.x.hypot(d.z);
    ((angle / fov + 0.5) * f64::from(size.0), (tan[1] - v) / (tan[1] - tan[0]) * f64::from(size.1))
}

#[test]
fn strips_of_a_cylinder_keep_their_bound_and_reach_it() {
    let (size, tan) = ((720, 41), [-1.0, 1.0]);
    for fov in [360.0_f64, 200.0] {
        let radians = fov.to_radians();
        for n in [4, 9, 30] {
            let table = format!("{POSE}kind = 'cylinder'\nfov = {fov}\ntan = [-1, 1]\nstrips = {n}");
            let camera = camera(&table, size);
            assert_eq!(camera.piece_count(), 2 * n);
            let delta = radians / n as f64 / 2.0;
            let s = |k: i32| f64::from(k) / 10_000.0;
            let beside = (0..=10_000).map(|k| (s(k) * delta - (s(k) * delta.tan()).atan()).abs()).fold(0.0, f64::max);
            let beside = beside * f64::from(size.0) / radians;
            let above = (1.0 / delta.cos() - 1.0) * f64::from(size.1) / 2.0;
            let (mut x, mut y) = (0.0_f64, 0.0_f64);
            for (i, j) in (0..size.1).flat_map(|j| (0..size.0).map(move |i| (i, j))) {
                let (px, py) = on_the_cylinder(direction(&camera, i, j), size, radians, tan);
                (x, y) = (x.max((px - f64::from(i) - 0.5).abs()), y.max((py - f64::from(j) - 0.5).abs()));
            }
            // the sampled maximum of the formula is low by (delta / 10^4)^2, pixels round to 1e-10
            assert!(x <= beside * 1.001 + 1e-9 && y <= above + 1e-9, "{n} strips: {x} of {beside}, {y} of {above}");
            // some column is near the worst place of a strip of 24 px or more, the first row is 1/41 inside the image
            assert!(x > 0.9 * beside && y > 0.9 * above, "{n} strips: {x} of {beside}, {y} of {above}");
            let note = &camera.notes[0];
            assert!(note.contains(&format!("{beside:.4} px beside, {above:.4} px above")), "{note}");
        }
    }
}

/// The largest angle between corresponding rays, radians.
fn worst_turn(a: &Camera, b: &Camera) -> f64 {
    let pixels = (0..a.height).flat_map(|j| (0..a.width).map(move |i| (i, j)));
    pixels.map(|(i, j)| direction(a, i, j).angle_between(direction(b, i, j))).fold(0.0, f64::max)
}

#[test]
fn cells_of_a_sphere_keep_their_bound_which_falls_with_their_square() {
    let exact = camera(&format!("{POSE}kind = 'sphere'"), (240, 120));
    let mut last = f64::INFINITY;
    for n in [8_u32, 16, 32] {
        let cells = camera(&format!("{POSE}kind = 'sphere'\nstrips = {n}"), (240, 120));
        assert_eq!(cells.piece_count() as u32, 2 * n * (n / 2));
        let step = std::f64::consts::TAU / f64::from(n);
        let bound = (step * step / 2.0).asin();
        let worst = worst_turn(&exact, &cells);
        assert!(worst <= bound && worst > bound / 8.0, "{n}: {worst} of {bound}");
        assert!(worst < last / 3.0, "{n}: {worst} after {last}");
        last = worst;
        assert!(cells.notes[0].contains(&format!("at most {:.4} degrees", bound.to_degrees())));
    }
}

/// The two samples of a border between strips, one from either side.
fn assert_no_seam(camera: &Camera, left: (u32, u32), right: (u32, u32)) {
    let from_left = camera.with_sample_offset(0.5, 0.0);
    let from_right = camera.with_sample_offset(-0.5, 0.0);
    let (a, b) = (direction(&from_left, left.0, left.1), direction(&from_right, right.0, right.1));
    assert!((a - b).length() < ROUNDING, "{left:?} and {right:?}: {a} and {b}");
}

#[test]
fn strips_join_all_round() {
    for kind in ["kind = 'cylinder'\nvfov = 80\nstrips = 6", "kind = 'sphere'\nstrips = 6"] {
        let camera = camera(&format!("{POSE}{kind}"), (60, 30));
        for j in 0..30 {
            assert_no_seam(&camera, (59, j), (0, j));
            assert_no_seam(&camera, (19, j), (20, j));
        }
    }
}

#[test]
fn wrong_values_name_their_keys() {
    for (table, expected) in [
        ("kind = 'fisheye'", "fov is missing"),
        ("kind = 'fisheye'\nfov = 0", "camera.fov: 0 degrees"),
        ("kind = 'fisheye'\nfov = 361", "camera.fov: 361"),
        ("kind = 'fisheye'\nfov = 360\nmapping = 'stereographic'", "camera.fov"),
        ("kind = 'fisheye'\nfov = 181\nmapping = 'orthographic'", "camera.fov"),
        ("kind = 'fisheye'\nfov = 90\nmapping = 'equal'", "camera.mapping"),
        ("kind = 'fisheye'\nfov = 90\nframe = 1", "camera.frame"),
        ("kind = 'fisheye'\nfov = 90\nvfov = 1", "unknown key \"vfov\""),
        ("kind = 'sphere'\nlon = [0, 361]", "lon"),
        ("kind = 'sphere'\nlon = [10, 10]", "camera.lon"),
        ("kind = 'sphere'\nlat = [-91, 0]", "lat"),
        ("kind = 'sphere'\nstrips = 4", "camera.strips = 4: too few"),
        ("kind = 'sphere'\nstrips = 100000", "over the limit"),
        ("kind = 'sphere'\nstrips = 9\npieces = 'exact'", "camera.strips"),
        ("kind = 'cylinder'\nfov = 400", "camera.fov"),
        ("kind = 'cylinder'\nvfov = 180", "camera.vfov"),
        ("kind = 'cylinder'\nvfov = 90\ntan = [0, 1]", "camera.tan"),
        ("kind = 'cylinder'\ntan = [1, 1]", "camera.tan"),
        ("kind = 'cylinder'\nstrips = 2", "camera.strips = 2: a strip is 180 degrees or wider; give 3 or more"),
        ("kind = 'cylinder'\nstrips = 0", "camera.strips"),
        ("kind = 'cylinder'\nup = [0, 0, 1]", "up is parallel"),
    ] {
        assert_refused(&format!("{POSE}{table}"), expected);
    }
}
