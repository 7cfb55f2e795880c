//! `ods`, `camera_texture`, `display` and `lightfield`: known pixels have known rays.

use crate::common;

use anamorph::internals::camera::Camera;
use anamorph::internals::image::write_npy_f64;
use anamorph::internals::input::Result;
use common::written::{assert_refused, camera, camera_in, try_camera};
use glam::{DVec2, DVec3};
use std::fmt::Write;

const POSE: &str = "eye = [0, 0, 0]\ntarget = [0, 0, -1]\n";

/// Sums and products of a few numbers up to 10, 2^-53 each.
const ROUNDING: f64 = 1e-14;

fn all_pixels(camera: &Camera) -> impl Iterator<Item = (u32, u32)> + use<> {
    let (w, h) = (camera.width, camera.height);
    (0..h).flat_map(move |j| (0..w).map(move |i| (i, j)))
}

fn assert_ray(camera: &Camera, (i, j): (u32, u32), origin: DVec3, direction: DVec3) {
    let ray = camera.ray(i, j).unwrap();
    let off = (ray.origin - origin).length().max((ray.direction - direction).length());
    assert!(off < ROUNDING, "{} at {i},{j}: {ray:?}, not {origin} {direction}", camera.kind);
}

#[test]
fn a_stereo_pair_is_googles_formula() {
    let ods = camera(&format!("{POSE}kind = 'ods'\nipd = 0.5"), (72, 48));
    for (i, j) in all_pixels(&ods) {
        let right = j >= 24;
        let (x, y) = ((f64::from(i) + 0.5) / 72.0, (f64::from(j % 24) + 0.5) / 24.0);
        let theta = x * std::f64::consts::TAU - std::f64::consts::PI;
        let phi = std::f64::consts::FRAC_PI_2 - y * std::f64::consts::PI;
        let scale = 0.25 * if right { 1.0 } else { -1.0 };
        let origin = DVec3::new(theta.cos() * scale, 0.0, theta.sin() * scale);
        let direction = DVec3::new(theta.sin() * phi.cos(), phi.sin(), -theta.cos() * phi.cos());
        assert_ray(&ods, (i, j), origin, direction);
        // tangent to the circle: perpendicular to the radius
        assert!(origin.dot(direction).abs() < ROUNDING);
    }
}

#[test]
fn the_left_eye_is_above_and_sees_near_things_farther_right() {
    let ods = camera(&format!("{POSE}kind = 'ods'\nipd = 0.5"), (720, 2));
    // where the row on the horizon comes nearest to a point ahead
    let column = |j: u32| {
        let off = |i: &u32| {
            let r = ods.ray(*i, j).unwrap();
            let flat = DVec3::new(r.direction.x, 0.0, r.direction.z).normalize();
            let to = DVec3::new(0.0, 0.0, -2.0) - r.origin;
            if to.dot(flat) > 0.0 { to.cross(flat).length() } else { f64::INFINITY }
        };
        (0..720).min_by(|a, b| off(a).total_cmp(&off(b))).unwrap()
    };
    // asin(0.25 / 2) = 7.18 degrees, 2 pixels a degree from the middle at 360
    let (left, right) = (column(0), column(1));
    assert!((374..=375).contains(&left) && (345..=346).contains(&right), "{left} {right}");
}

/// Offsets of a grid of `n` x `m`, as a scene file writes them.
fn offsets(n: u32, m: u32, at: impl Fn(f64, f64) -> DVec2) -> String {
    let mut text = String::from("offsets = [");
    for j in 0..m {
        text.push('[');
        for i in 0..n {
            let o = at(f64::from(i) / f64::from(n - 1), f64::from(j) / f64::from(m - 1));
            write!(text, "[{:?}, {:?}],", o.x, o.y).unwrap();
        }
        text.push_str("],");
    }
    text + "]\n"
}

fn texture(keys: &str) -> String {
    format!("{POSE}kind = 'camera_texture'\nvfov = 60\n{keys}")
}

#[test]
fn no_offsets_are_the_pinhole() {
    let pinhole = camera(&format!("{POSE}kind = 'pinhole'\nvfov = 60"), (40, 30));
    for mode in ["affine", "bilinear"] {
        for scale in [1.0, 0.0] {
            let none = |_: f64, _: f64| if scale == 0.0 { DVec2::new(0.3, -5.0) } else { DVec2::ZERO };
            let keys = format!("mode = '{mode}'\nscale = {scale}\n{}", offsets(5, 4, none));
            let camera = camera(&texture(&keys), (40, 30));
            assert!(camera.notes.is_empty());
            for (i, j) in all_pixels(&camera) {
                let ray = pinhole.ray(i, j).unwrap();
                assert_ray(&camera, (i, j), ray.origin, ray.direction);
            }
        }
    }
}

#[test]
fn an_affine_displacement_moves_every_pixel_by_it() {
    // the middle half of the view, and shifted by an eighth: place q shows p = 2 (q - (1/4 + 1/8, 1/4))
    let shrink = |x: f64, y: f64| DVec2::new(0.375 - 0.5 * x, 0.25 - 0.5 * y);
    let pinhole = camera(&format!("{POSE}kind = 'pinhole'\nvfov = 60"), (16, 16));
    for mode in ["affine", "bilinear"] {
        let keys = format!("mode = '{mode}'\n{}", offsets(4, 3, shrink));
        let small = camera(&texture(&keys), (32, 32));
        for (i, j) in all_pixels(&small) {
            let inside = (12..28).contains(&i) && (8..24).contains(&j);
            assert_eq!(small.ray(i, j).is_some(), inside, "{mode} {i},{j}");
            if inside {
                let ray = pinhole.ray(i - 12, j - 8).unwrap();
                assert_ray(&small, (i, j), ray.origin, ray.direction);
            }
        }
    }
}

/// A wave that keeps the borders, like a lens.
fn wave(x: f64, y: f64) -> DVec2 {
    let bump = (std::f64::consts::PI * x).sin() * (std::f64::consts::PI * y).sin();
    DVec2::new(0.05, -0.04) * bump
}

#[test]
fn bilinear_cells_are_inverted_exactly() {
    let (n, m) = (6, 5);
    let size = (60, 40);
    let keys = format!("mode = 'bilinear'\n{}", offsets(n, m, wave));
    let bent = camera(&texture(&keys), size);
    let k = 30f64.to_radians().tan();
    for (i, j) in all_pixels(&bent) {
        let d = bent.ray(i, j).unwrap().direction;
        // where the pinhole sees it
        let p = DVec2::new(d.x / (k * 1.5), -d.y / k) / 2.0 + 0.5;
        let cell = p * DVec2::new(f64::from(n - 1), f64::from(m - 1));
        let lo = cell.floor().min(DVec2::new(f64::from(n - 2), f64::from(m - 2)));
        let f = cell - lo;
        let at = |x: f64, y: f64| wave((lo.x + x) / f64::from(n - 1), (lo.y + y) / f64::from(m - 1));
        let offset = at(0., 0.).lerp(at(1., 0.), f.x).lerp(at(0., 1.).lerp(at(1., 1.), f.x), f.y);
        let q = p + offset;
        let expected = DVec2::new((f64::from(i) + 0.5) / 60.0, (f64::from(j) + 0.5) / 40.0);
        assert!((q - expected).length() < 1e-13, "{i},{j}: {q}, not {expected}");
    }
}

#[test]
fn affine_cells_approach_bilinear_ones_by_their_square() {
    let size = (60, 40);
    let pair = |n: u32| {
        let grid = offsets(n, n, wave);
        let of = |mode: &str| camera(&texture(&format!("mode = '{mode}'\n{grid}")), size);
        (of("affine"), of("bilinear"))
    };
    let worst = |n: u32| {
        let (a, b) = pair(n);
        assert_eq!(a.piece_count() as u32, 2 * (n - 1) * (n - 1));
        let off = |(i, j)| (a.ray(i, j).unwrap().direction - b.ray(i, j).unwrap().direction).length();
        all_pixels(&a).map(off).fold(0.0, f64::max)
    };
    let (coarse, fine) = (worst(5), worst(17));
    // 16 by the square of 4; the worst place need not be a pixel
    assert!(coarse > 1e-4 && fine < coarse / 10.0, "{coarse} {fine}");
}

#[test]
fn where_cells_fold_the_first_shows_and_the_count_is_told() {
    // three columns of cells; the middle one runs backwards
    let fold = |x: f64, _: f64| {
        DVec2::new(
            if x > 0.5 && x < 0.9 {
                -0.5
            } else if x > 0.2 && x < 0.5 {
                0.3
            } else {
                0.0
            },
            0.0,
        )
    };
    for (mode, folded) in [("affine", "4 of 12 pieces"), ("bilinear", "2 of 6 cells")] {
        let keys = format!("mode = '{mode}'\n{}", offsets(4, 3, fold));
        let camera = camera(&texture(&keys), (60, 30));
        assert!(camera.notes[0].starts_with(folded), "{:?}", camera.notes);
        // crossings at 0, 0.633, 0.167, 1: in a = 0.4 the first column shows x = 0.4 / 0.633 / 3
        let k = 30f64.to_radians().tan();
        let x = 0.5 + camera.ray(23, 15).unwrap().direction.x / (4.0 * k);
        let expected = (23.5 / 60.0) / (1.0 / 3.0 + 0.3) / 3.0;
        assert!((x - expected).abs() < 1e-13, "{mode}: {x}, not {expected}");
        // beyond it, the second column's lower numbers before the third's: from (0.633, 1/3) back to (0.167, 2/3)
        assert!(all_pixels(&camera).all(|(i, j)| camera.ray(i, j).is_some()));
    }
}

#[test]
fn offsets_come_from_files_too() {
    let folder = tempfile::tempdir().unwrap();
    let (n, m) = (5, 4);
    let numbers: Vec<f64> = (0..m)
        .flat_map(|j| (0..n).map(move |i| wave(f64::from(i) / f64::from(n - 1), f64::from(j) / f64::from(m - 1))))
        .flat_map(|o| o.to_array())
        .collect();
    write_npy_f64(&folder.path().join("o.npy"), &[m.into(), n.into(), 2], &numbers).unwrap();
    let read = camera_in(folder.path(), &texture("file = 'o.npy'"), Some((30, 20))).unwrap();
    let inline = camera(&texture(&offsets(n, m, wave)), (30, 20));
    for (i, j) in all_pixels(&read) {
        assert_eq!(read.ray(i, j), inline.ray(i, j));
    }
    write_npy_f64(&folder.path().join("o.npy"), &[1, 1, 3], &[0.0; 3]).unwrap();
    let wrong = camera_in(folder.path(), &texture("file = 'o.npy'"), Some((30, 20))).unwrap_err().to_string();
    assert!(wrong.contains("must be height x width x 2"), "{wrong}");
}

/// A quarter of a cylinder of radius 2 about the eye, `n` flat strips, the texture over all of it.
fn screen(n: u32) -> String {
    let mut text = String::new();
    for k in 0..=n {
        let u = f64::from(k) / f64::from(n);
        let (sin, cos) = ((u - 0.5) * std::f64::consts::FRAC_PI_2).sin_cos();
        for v in [0.0, 1.0] {
            writeln!(text, "v {} {} {}\nvt {u} {v}", 2.0 * sin, 2.0 * v - 1.0, -2.0 * cos).unwrap();
        }
    }
    for k in 0..n {
        let [a, b, c, d] = [1, 2, 3, 4].map(|c| 2 * k + c);
        writeln!(text, "f {a}/{a} {c}/{c} {d}/{d} {b}/{b}").unwrap();
    }
    text
}

fn display(obj: &str, size: (u32, u32)) -> Result<Camera> {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("s.obj"), obj).unwrap();
    camera_in(folder.path(), "kind = 'display'\neye = [0.5, 0, 0]\nmesh = 's.obj'", Some(size))
}

#[test]
fn a_display_sends_each_pixel_to_its_place_on_the_screen() {
    let n = 8;
    let camera = display(&screen(n), (64, 20)).unwrap();
    assert_eq!(camera.piece_count(), 16);
    let eye = DVec3::new(0.5, 0.0, 0.0);
    for (i, j) in all_pixels(&camera) {
        let u = (f64::from(i) + 0.5) / 64.0 * f64::from(n);
        let ends = [u.floor(), u.floor() + 1.0].map(|k| {
            let (sin, cos) = ((k / f64::from(n) - 0.5) * std::f64::consts::FRAC_PI_2).sin_cos();
            DVec3::new(2.0 * sin, 0.0, -2.0 * cos)
        });
        let point = ends[0].lerp(ends[1], u.fract()) + DVec3::Y * (0.95 - 0.1 * f64::from(j));
        assert_ray(&camera, (i, j), eye, point - eye);
    }
}

#[test]
fn screens_without_a_map_are_refused() {
    for (obj, expected) in [
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", ":4: face without texture coordinates"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 x\nf 1/1 2/1 3/1\n", ":5: coordinate"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1\nf 1/1 2/1 3/1\n", ":5: has 1 of 2"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 1\nf 1/1 2/2 3/2\n", "0 has no area"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\nf 1/1 2/2 3/3\n", "overlap"),
        ("v 0 0 0\n", "no faces"),
    ] {
        let error = display(obj, (8, 8)).unwrap_err();
        assert!(error.exit_code() == 2 && error.to_string().contains(expected), "{expected}: {error}");
    }
}

const PANEL: &str = "kind = 'lightfield'\ncenter = [0, 1, 0]\nnormal = [0, 0, 1]\nwidth = 4\nheight = 2\n";

#[test]
fn a_lenslet_holds_an_upright_picture() {
    let camera = camera(&format!("{PANEL}views = [3, 3]\nfov = [90, 60]"), (12, 6));
    let down = 30f64.to_radians().tan() * 2.0 / 3.0;
    for (i, j) in all_pixels(&camera) {
        // lenslets 1 unit apart: centres at x = -1.5 ... 1.5, y = 1.5 and 0.5
        let origin = DVec3::new(f64::from(i / 3) - 1.5, 1.5 - f64::from(j / 3), 0.0);
        let (x, y) = (f64::from(i % 3) - 1.0, f64::from(j % 3) - 1.0);
        assert_ray(&camera, (i, j), origin, DVec3::new(x * 2.0 / 3.0, -y * down, -1.0));
    }
}

#[test]
fn wrong_values_name_their_keys() {
    let missing = "give either file";
    for (table, expected) in [
        (format!("{POSE}kind = 'ods'\nipd = -1"), "camera.ipd"),
        (format!("{POSE}kind = 'ods'"), "ipd is missing"),
        (texture(""), missing),
        (texture("file = 'x.npy'\noffsets = []"), missing),
        (texture("offsets = []"), "camera.offsets: 0 x 0 offsets make no cell"),
        (texture("offsets = [[[0, 0], [0, 0]], [[0, 0]]]"), "camera.offsets.1: 1 offsets"),
        (texture("offsets = [[[0, 0], [0]], [[0, 0], [0, 0]]]"), "camera.offsets.0.1"),
        (texture("offsets = [[[0, 0], [-1, 0]], [[0, 0], [-1, 0]]]"), "to a line or a point"),
        (texture("mode = 'cubic'"), "camera.mode"),
        (texture("pieces = 'exact'"), "camera.pieces"),
        (format!("{PANEL}views = [7, 3]\nfov = 40"), "use 42 x 30"),
        (format!("{PANEL}views = [0, 3]\nfov = 40"), "camera.views.0"),
        (format!("{PANEL}views = [4, 3]\nfov = 180"), "camera.fov"),
        (format!("{PANEL}views = [4, 3]\nfov = 40\nup = [0, 0, 1]"), "normal is zero"),
        (format!("{PANEL}views = [4, 3]\nfov = 40").replace("width = 4", "width = 0"), "camera.width"),
    ] {
        assert_refused(&table, expected);
    }
    assert!(
        try_camera(&format!("{POSE}kind = 'ods'\nipd = 0.1"), (4, 5)).unwrap_err().to_string().contains("even height")
    );
}
