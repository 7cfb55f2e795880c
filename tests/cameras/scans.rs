//! `lidar`, and the points that `render --points` writes.

use crate::common;
use anamorph::internals::input::Loading;

use anamorph::internals::camera::Camera;
use anamorph::internals::image::{read_npy_rows, write_npy_f64};
use common::written::{assert_refused, camera as of_size, camera_in};
use glam::DVec3;
use std::path::Path;
use std::process::{Command, Output};

const SCANNER: &str = "kind = 'lidar'\neye = [0, 0, 0]\ntarget = [0, 0, -1]\n";

/// Sines and sums of numbers up to 10, 2^-53 each.
const ROUNDING: f64 = 1e-14;

/// Of the share of the way between two time steps: 2^-25 of a unit a second for a second.
const TIME_ROUNDING: f64 = 3e-8 + ROUNDING;

fn without_size(table: &str) -> Camera {
    camera_in(tempfile::tempdir().unwrap().path(), table, None).unwrap()
}

fn assert_ray(camera: &Camera, (i, j): (u32, u32), origin: DVec3, direction: DVec3) {
    let ray = camera.ray(i, j).unwrap();
    let off = (ray.origin - origin).length().max((ray.direction - direction).length());
    assert!(off < ROUNDING, "{i},{j}: {ray:?}, not {origin} {direction}");
}

#[test]
fn a_scanner_turns_and_moves() {
    let beams = [20.0_f64, 0.0, -40.0];
    let keys = "beams = [20, 0, -40]\ncolumns = 10\nstart = -90\nsweep = 200\nvelocity = [0, 0, -5]\nperiod = 0.2";
    let camera = without_size(&format!("{SCANNER}{keys}"));
    assert_eq!((camera.width, camera.height), (10, 3));
    for (j, beam) in (0..3).zip(beams.map(f64::to_radians)) {
        for i in 0..10 {
            let part = (f64::from(i) + 0.5) / 10.0;
            let azimuth = (-90.0 + 200.0 * part).to_radians();
            let direction = DVec3::new(beam.cos() * azimuth.sin(), beam.sin(), -beam.cos() * azimuth.cos());
            assert_ray(&camera, (i, j), DVec3::new(0.0, 0.0, -part), direction);
        }
    }
    // it begins on the left and goes to the right
    assert!(camera.ray(0, 1).unwrap().direction.x < -0.9 && camera.ray(7, 1).unwrap().direction.x > 0.5);
}

/// Seven rays straight down from a line, the fourth of them not a ray.
fn seven(folder: &Path) -> Vec<[f64; 6]> {
    let mut rows: Vec<[f64; 6]> = (0..7).map(|k| [0.1 * f64::from(k) - 0.3, 3.0, 0.05, 0.01, -2.0, 0.0]).collect();
    rows[3][4] = f64::NAN;
    let numbers: Vec<f64> = rows.iter().flatten().copied().collect();
    write_npy_f64(&folder.join("rays.npy"), &[7, 6], &numbers).unwrap();
    rows
}

#[test]
fn a_list_is_laid_out_row_by_row() {
    let folder = tempfile::tempdir().unwrap();
    let rows = seven(folder.path());
    for (size, expected) in [(None, (3, 3)), (Some((7, 1)), (7, 1)), (Some((4, 3)), (4, 3))] {
        let camera = camera_in(folder.path(), "kind = 'lidar'\nfile = 'rays.npy'", size).unwrap();
        assert_eq!((camera.width, camera.height), expected);
        for k in 0..camera.width * camera.height {
            let ray = camera.ray(k % camera.width, k / camera.width);
            assert_eq!(ray.is_some(), k < 7 && k != 3, "{k}");
            if let Some(ray) = ray {
                let r = rows[k as usize];
                assert_eq!(ray.origin, DVec3::new(r[0], r[1], r[2]));
                assert_eq!(ray.direction, DVec3::new(r[3], r[4], r[5]));
                // off the pixel's centre it is the same ray
                assert_eq!(camera.with_sample_offset(0.3, -0.4).ray(k % camera.width, k / camera.width), Some(ray));
            }
        }
    }
    let narrow = camera_in(folder.path(), "kind = 'lidar'\nfile = 'rays.npy'", Some((3, 2))).unwrap_err().to_string();
    assert!(narrow.contains("3 x 2 pixels for 7 rays; use 3 x 3"), "{narrow}");
    write_npy_f64(&folder.path().join("rays.npy"), &[2, 3], &[0.0; 6]).unwrap();
    let wrong = camera_in(folder.path(), "kind = 'lidar'\nfile = 'rays.npy'", None).unwrap_err().to_string();
    assert!(wrong.contains("must be N x 6"), "{wrong}");
    write_npy_f64(&folder.path().join("rays.npy"), &[0, 6], &[0.0; 0]).unwrap();
    assert!(camera_in(folder.path(), "kind = 'lidar'\nfile = 'rays.npy'", None).is_err());
}

#[test]
fn wrong_scanners_name_their_keys() {
    for (keys, expected) in [
        ("", "beams is missing"),
        ("beams = []\ncolumns = 4", "camera.beams"),
        ("beams = [91]\ncolumns = 4", "camera.beams"),
        ("beams = [1]", "columns is missing"),
        ("beams = [1]\ncolumns = 0", "camera.columns"),
        ("beams = [1]\ncolumns = 100000", "camera.columns"),
        ("beams = [1]\ncolumns = 4\nvelocity = [1, 0, 0]", "camera.velocity"),
        ("beams = [1]\ncolumns = 4\nfile = 'x.npy'", "eye describes a scanner, but file lists the rays"),
        ("beams = [1]\ncolumns = 4", "image: the scan is 4 x 1"),
    ] {
        assert_refused(&format!("{SCANNER}{keys}"), expected);
    }
    of_size(&format!("{SCANNER}beams = [1]\ncolumns = 4"), (4, 1));
}

/// Renders by the reference, as `anamorph` does.
fn render(folder: &Path, camera: &str, flags: &[&str]) -> Output {
    let mesh = "[[mesh]]\nbuiltin = 'plane'\nsize = 4\n";
    std::fs::write(folder.join("scene.toml"), format!("{mesh}[camera]\n{camera}\n")).unwrap();
    run(folder, flags)
}

/// Renders the folder's scene.
fn run(folder: &Path, flags: &[&str]) -> Output {
    let program = env!("CARGO_BIN_EXE_anamorph");
    let fixed = ["render", "scene.toml", "--engine", "reference"];
    Command::new(program).args(fixed).args(flags).current_dir(folder).output().unwrap()
}

#[test]
fn points_lie_where_the_rays_meet_the_plane() {
    let folder = tempfile::tempdir().unwrap();
    let rows = seven(folder.path());
    let camera = "kind = 'lidar'\nfile = 'rays.npy'";
    for flags in [&["--points", "p.npy"][..], &["--points", "p.ply"], &["--size", "7x1", "--points", "p.PLY"]] {
        let done = render(folder.path(), camera, flags);
        assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    }
    // y = 0 at t = 3/2
    let expected: Vec<Option<DVec3>> = rows
        .iter()
        .map(|r| r[4].is_finite().then(|| DVec3::new(r[0] + 0.015, 0.0, r[2])))
        .chain([None, None])
        .collect();
    let points = read_npy_rows::<3>(&folder.path().join("p.npy"), &Loading::default()).unwrap();
    assert_eq!(points.len(), 9);
    for (found, expected) in points.iter().zip(&expected) {
        match expected {
            Some(at) => assert!((DVec3::from(*found) - *at).length() < ROUNDING, "{found:?}, not {at}"),
            None => assert!(found.iter().all(|x| x.is_nan())),
        }
    }
    let ply = std::fs::read(folder.path().join("p.ply")).unwrap();
    assert_eq!(ply, std::fs::read(folder.path().join("p.PLY")).unwrap());
    let header = "ply\nformat binary_little_endian 1.0\nelement vertex 6\nproperty double x\nproperty double y\n\
                  property double z\nproperty uint triangle_id\nend_header\n";
    let body = ply.strip_prefix(header.as_bytes()).unwrap();
    assert_eq!(body.len(), 6 * 28);
    for (record, at) in body.chunks_exact(28).zip(expected.iter().flatten()) {
        let x = |k: usize| f64::from_le_bytes(record[8 * k..8 * k + 8].try_into().unwrap());
        assert!((DVec3::new(x(0), x(1), x(2)) - *at).length() < ROUNDING);
        assert!(u32::from_le_bytes(record[24..].try_into().unwrap()) < 2);
    }
}

#[test]
fn points_are_where_things_are_at_the_pixels_time() {
    let folder = tempfile::tempdir().unwrap();
    let camera =
        "kind = 'orthographic'\neye = [0, 5, 0]\ntarget = [0, 0, 0]\nup = [0, 0, -1]\nheight = 3\nline_time = 0.1\n";
    // a unit up in a second, a frame
    let rises = "translate = [{ frame = 0, value = [0, 0, 0] }, { frame = 1, value = [0, 1, 0] }]\n";
    for (thing, height) in
        [("[[mesh]]\nbuiltin = 'plane'\nsize = 4\n", 0.0), ("[[spheres]]\ncenters = [[0, 0, 0]]\nradius = 2\n", 2.0)]
    {
        let scene = format!("[image]\nwidth = 1\nheight = 9\n{thing}{rises}[camera]\n{camera}");
        std::fs::write(folder.path().join("scene.toml"), scene).unwrap();
        let done = run(folder.path(), &["--points", "p.npy"]);
        assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
        let points = read_npy_rows::<3>(&folder.path().join("p.npy"), &Loading::default()).unwrap();
        for (row, point) in points.iter().enumerate() {
            // rows are a third of a unit apart; below a sphere's top by its roundness
            let z = (row as f64 - 4.0) / 3.0;
            let top = if height > 0.0 { (height * height - z * z).sqrt() } else { 0.0 };
            let expected = DVec3::new(0.0, top + 0.1 * row as f64, z);
            assert!((DVec3::from(*point) - expected).length() < TIME_ROUNDING, "{row}: {point:?}, not {expected}");
        }
    }
    // all at one time, which is not the frame's own
    write_npy_f64(&folder.path().join("late.npy"), &[9], &[0.5; 9]).unwrap();
    let late = camera.replace("line_time = 0.1", "times = 'late.npy'");
    for (mesh, eye, expected) in [
        (rises, "eye = [0, 5, 0]", 0.5),
        ("", "eye = [{ frame = 0, value = [0, 5, 0] }, { frame = 1, value = [0.5, 5, 0] }]", 0.0),
    ] {
        let camera = late.replace("eye = [0, 5, 0]", eye);
        let plane = "[[mesh]]\nbuiltin = 'plane'\nsize = 4\n";
        let scene = format!("[image]\nwidth = 1\nheight = 9\n{plane}{mesh}[camera]\n{camera}");
        std::fs::write(folder.path().join("scene.toml"), scene).unwrap();
        let done = run(folder.path(), &["--points", "p.npy"]);
        assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
        let points = read_npy_rows::<3>(&folder.path().join("p.npy"), &Loading::default()).unwrap();
        assert!((points[4][1] - expected).abs() < TIME_ROUNDING, "{points:?}");
    }
    let mirror = "kind = 'reflection'\neye = { kind = 'pinhole', eye = [0, 3, 3], target = [0, 0, 0], vfov = 40 }\nmirror = { shape = 'sphere', center = [0, 0.5, 0], radius = 0.5 }\n";
    let refused = render(folder.path(), mirror, &["--size", "16x12", "--points", "p.npy"]);
    let said = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert!(refused.status.code() == Some(2) && said.contains("one straight ray per pixel"), "{said}");
}

#[test]
fn points_leave_the_other_files_as_they_were() {
    let folder = tempfile::tempdir().unwrap();
    let camera = "kind = 'pinhole'\neye = [0, 3, 3]\ntarget = [0, 0, 0]\nvfov = 40";
    let flags = ["--size", "16x12", "--channels", "R,Z", "--exr"];
    for flags in [[&flags[..], &["a.exr"]].concat(), [&flags[..], &["b.exr", "--points", "p.npy"]].concat()] {
        assert!(render(folder.path(), camera, &flags).status.success());
    }
    assert_eq!(
        std::fs::read(folder.path().join("a.exr")).unwrap(),
        std::fs::read(folder.path().join("b.exr")).unwrap()
    );
    let refused = render(folder.path(), camera, &["--size", "16x12", "--points", "p.txt"]);
    let said = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert!(refused.status.code() == Some(2) && said.contains("p.txt: points are written as .ply or .npy"), "{said}");
}
