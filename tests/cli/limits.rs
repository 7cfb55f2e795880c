//! Work beyond the limits or the memory is refused in one line, before it begins.

#[cfg(target_os = "linux")]
use super::outputs::{limited, waits};
use super::program::Place;
#[cfg(target_os = "linux")]
use super::program::{Ran, assert_one_line};
#[cfg(target_os = "linux")]
use std::process::Stdio;
use std::time::{Duration, Instant};

const BOX: &str = "[image]\nwidth = 64\nheight = 48\n[[mesh]]\nbuiltin = \"box\"\n";

/// A refusal takes milliseconds; on a busy machine at most this.
const AT_ONCE: Duration = Duration::from_secs(10);

/// Work that takes seconds takes at most this on a busy machine. With an algorithm of quadratic time it takes minutes on an idle one.
const BOUNDED: Duration = Duration::from_secs(120);

fn timed<T>(most: Duration, what: &str, run: impl FnOnce() -> T) -> T {
    let started = Instant::now();
    let result = run();
    assert!(started.elapsed() < most, "{what}: {:?}", started.elapsed());
    result
}

fn mesh(keys: &str) -> String {
    let camera = "[camera]\nkind = \"pinhole\"\neye = [0, 0, 6]\ntarget = [0, 0, 0]\nvfov = 40\n";
    format!("[image]\nwidth = 64\nheight = 48\n[[mesh]]\n{keys}\n{camera}")
}

#[test]
fn meshes_larger_than_the_memory_are_refused() {
    let place = Place::new();
    for (keys, what) in [
        ("builtin = \"icosphere\"\nlevel = 11", "icosphere of 83886080 triangles"),
        ("builtin = \"teapot\"\nlevel = 1000", "teapot of 64000000 triangles"),
        ("builtin = \"soup\"\ntriangles = 100000000", "soup of 100000000 triangles"),
        ("builtin = \"terrain\"\nsize = 8192", "terrain of 134217728 triangles"),
    ] {
        place.write("s.toml", mesh(keys));
        let args = ["render", "s.toml", "-o", "o.png", "--memory", "8G"];
        timed(AT_ONCE, what, || place.refuses(&args, 1, &format!("{what} takes about")));
        #[cfg(target_os = "linux")]
        {
            // the limit of the process's address space counts too
            let mut shell = limited(&place, "-v 10000000", &["render", "s.toml", "-o", "o.png"]);
            let ran = Ran::of(timed(AT_ONCE, what, || shell.output().unwrap()));
            assert_one_line(&ran, what);
            assert!(ran.code == 1 && ran.err.contains("--memory"), "{}", ran.err);
        }
    }
    // copies of meshes and height images too
    let places: Vec<f64> =
        std::iter::repeat_n([1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1., 0.], 20_000).flatten().collect();
    anamorph::internals::image::write_npy_f64(&place.path().join("p.npy"), &[20_000, 3, 4], &places).unwrap();
    place.write("s.toml", mesh("builtin = \"box\"\nplaces = \"p.npy\""));
    let copies = "a copy of each mesh at each of 20000 places, 240000 triangles in all, takes about";
    place.refuses(&["info", "s.toml", "--memory", "40M"], 1, copies);
    place.works(&["info", "s.toml", "--memory", "40M", "--no-limits"]);
    // larger meshes are copied only for what needs copies
    place.write("s.toml", mesh("builtin = \"icosphere\"\nplaces = \"p.npy\""));
    place.works(&["info", "s.toml", "--memory", "100M"]);
    let raster = ["render", "s.toml", "-o", "o.png", "--memory", "100M", "--method", "raster"];
    place.refuses(&raster, 1, "a copy of each mesh at each of 20000 places");
    place.write("h.asc", format!("ncols 1000\nnrows 1000\ncellsize 1\n{}", "0 ".repeat(1_000_000)));
    place.refuses(&["info", "h.asc", "--memory", "300M"], 1, "terrain of 1000 x 1000 heights takes about");
    place.refuses(&["render", "scene.toml", "-o", "o.png", "--memory", "64k"], 1, "or use --memory or --no-limits");
    place.refuses(&["render", "scene.toml", "-o", "o.png", "--memory", "8X"], 2, "as 500M or 8G");
    place.works(&["camera", "scene.toml", "--memory", "64k", "--no-limits", "--rays", "r.npy"]);
}

/// A .npy file that promises this many rows of three f32 numbers and holds none.
fn promised_rows(rows: u64) -> Vec<u8> {
    let header = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': ({rows}, 3), }}");
    let header = format!("{header:<117}\n");
    [b"\x93NUMPY\x01\x00", &(header.len() as u16).to_le_bytes()[..], header.as_bytes()].concat()
}

#[test]
fn spheres_are_counted_before_they_are_read() {
    let place = Place::new();
    let camera = "[camera]\nkind = \"pinhole\"\neye = [0, 0, 6]\ntarget = [0, 0, 0]\nvfov = 40\n";
    place.write("s.toml", format!("{BOX}[[spheres]]\nfile = \"p.npy\"\nradius = 1\n{camera}"));
    for (rows, memory, says) in [
        (300_000_000, "900G", "p.npy: 300000000 spheres, at most 2^28 are possible"),
        (100_000_000, "1G", "p.npy: 100000000 spheres takes about"),
        (100_000_000, "900G", "p.npy: the file ends early"),
    ] {
        place.write("p.npy", promised_rows(rows));
        place.refuses(&["info", "s.toml", "--memory", memory], 2, says);
    }
}

#[test]
fn keyframes_are_counted_before_the_scene_is_read_at_each() {
    let place = Place::new();
    // all of them while the shutter is open
    let keys: Vec<String> =
        (0..5000).map(|k| format!("{{ frame = {:.4}, value = [0, {k}, 4] }}", f64::from(k - 2500) * 2e-4)).collect();
    let image = BOX.replace("height = 48", "height = 48\nshutter = 1");
    let camera = format!("kind = \"pinhole\"\neye = [{}]\ntarget = [0, 0, 0]\nvfov = 40\n", keys.join(", "));
    place.write("s.toml", format!("{image}[camera]\n{camera}"));
    let says = "the frame takes 5000 or more steps from keyframe to keyframe, over the limit of 255";
    timed(AT_ONCE, "keyframes", || place.refuses(&["info", "s.toml"], 2, says));
}

/// Rays that begin very far away all pass through every point within rounding: each pixel would search all of them.
#[test]
fn projector_lights_whose_rays_begin_too_far_away_are_refused() {
    let place = Place::new();
    image::RgbImage::from_pixel(8, 8, image::Rgb([200, 100, 50])).save(place.path().join("picture.png")).unwrap();
    let of_each = |of: &dyn Fn(f64) -> [f64; 3]| -> Vec<f64> { (0..8 * 8).flat_map(|k| of(f64::from(k))).collect() };
    let around = |far: f64| of_each(&|k| [far * k.cos(), far * k.sin(), far]);
    let inwards = of_each(&|k| [-k.cos(), -k.sin(), -1.0]);
    anamorph::internals::image::write_npy_f64(&place.path().join("d.npy"), &[8, 8, 3], &inwards).unwrap();
    let camera = "[camera]\nkind = \"pinhole\"\neye = [0, 0, 6]\ntarget = [0, 0, 0]\nvfov = 40\n";
    let rays = "{ kind = \"raymap\", origins = \"o.npy\", directions = \"d.npy\" }";
    for mode in ["show", "light"] {
        let light = format!("[[projector_light]]\nimage = \"picture.png\"\nmode = \"{mode}\"\ncamera = {rays}\n");
        place.write("s.toml", format!("{BOX}{camera}{light}"));
        for (far, is_refused) in [(1e30, true), (1e3, false)] {
            anamorph::internals::image::write_npy_f64(&place.path().join("o.npy"), &[8, 8, 3], &around(far)).unwrap();
            let args = ["render", "s.toml", "-o", "o.png", "--engine", "reference", "--size", "8x6"];
            let says = "projector_light.0: camera: a ray begins 1.4e30 from the origin, so far that rounding exceeds";
            match is_refused {
                true => timed(AT_ONCE, mode, || place.refuses(&args, 2, says)),
                false => drop(timed(BOUNDED, mode, || place.works(&args))),
            }
        }
    }
}

/// The allocator may find no room for an arena of each thread; it must not ask the system for every number then.
#[cfg(target_os = "linux")]
#[test]
fn frames_beside_little_memory_end() {
    let place = Place::new();
    place.works(&["example", "caustic-ball", "--out", "."]);
    for kib in [150_000, 200_000, 250_000, 300_000, 400_000, 500_000, 600_000] {
        let mut shell = limited(&place, &format!("-v {kib}"), &["render", "caustic-ball.toml", "-o", "o.png"]);
        let child = shell.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let ran = Ran::of(waits(child, BOUNDED).unwrap_or_else(|| panic!("{kib} KiB: no end")));
        match ran.code {
            0 => assert!(ran.out.starts_with("o.png 640x480"), "{kib} KiB: {}", ran.out),
            code => {
                assert_one_line(&ran, &format!("{kib} KiB"));
                assert_eq!(code, 1, "{kib} KiB: {}", ran.err);
            }
        }
    }
}

#[test]
fn work_over_the_limits_is_refused_without_no_limits() {
    let place = Place::new();
    let fisheye = "[camera]\nkind = \"fisheye\"\neye = [0, 0, 4]\ntarget = [0, 0, 0]\nfov = 90\n";
    place.write("pieces.toml", format!("{BOX}{fisheye}pieces = 1000001\n"));
    place.refuses(&["camera", "pieces.toml"], 2, "1000001 pieces are over the limit of 1000000");
    place.works(&["camera", "pieces.toml", "--no-limits"]);
    let polygon: Vec<String> = (0..10_001).map(|k| format!("[{k}, {}]", k * k)).collect();
    let region = format!("{{ polygon = [{}], eye = [0, 9, 0] }}", polygon.join(", "));
    let root = "[camera]\nkind = \"top_down\"\neye = [0, 0, 4]\ntarget = [0, 0, 0]\nvfov = 40\n";
    place.write("corners.toml", format!("{BOX}{root}regions = [{region}]\n"));
    place.refuses(&["camera", "corners.toml"], 2, "10001 corners are over the limit of 10000");
    let eye = "{ kind = \"pinhole\", eye = [0, 0, 6], target = [0, 0, 0], vfov = 40 }";
    let keys = "mirror = { shape = \"sphere\", radius = 1 }\ndepth = 16\nroughness = 0.2\nrays = 256\n";
    place.write("rough.toml", format!("{BOX}[camera]\nkind = \"reflection\"\neye = {eye}\n{keys}"));
    place.works(&["camera", "rough.toml"]);
    let args = ["render", "rough.toml", "-o", "o.png", "--size", "1024x1024"];
    place.refuses(&args, 2, "4294967296 ray bounces are over the limit of 1073741824");
    let values: Vec<String> = (0..1000).map(|k| k.to_string()).collect();
    let swept: String = ["a", "b", "c"].map(|key| format!("\"camera.{key}\" = [{}]\n", values.join(", "))).concat();
    place.write("jobs.toml", format!("[[job]]\nscene = \"scene.toml\"\ncolor = \"o.png\"\n[job.sweep]\n{swept}"));
    timed(AT_ONCE, "sweeps", || {
        place.refuses(&["batch", "jobs.toml"], 2, "1000000000 frames are over the limit of 4000000; split the list");
    });
    // 10^21, more than 64 bits hold
    let swept: String =
        ["a", "b", "c", "d", "e", "f", "g"].map(|key| format!("\"camera.{key}\" = [{}]\n", values.join(", "))).concat();
    place.write("jobs.toml", format!("[[job]]\nscene = \"scene.toml\"\ncolor = \"o.png\"\n[job.sweep]\n{swept}"));
    place.refuses(&["batch", "jobs.toml", "--no-limits"], 2, "more than 1e15 frames; use fewer swept values or frames");
    place.write("jobs.toml", "[[job]]\nscene = \"scene.toml\"\ncolor = \"o-{frame}.png\"\nframes = { last = 1e12 }\n");
    place.refuses(&["batch", "jobs.toml"], 2, "1000000000001 frames are over the limit");
    let help = place.works(&["render", "--help"]);
    assert!(help.contains("1000000 pieces") && help.contains("--memory") && help.contains("--no-limits"), "{help}");
}

#[test]
fn control_points_are_bounded_as_scenes_are() {
    let place = Place::new();
    let plane =
        |x: &str, z: f64| format!("{{ kind = \"plane\", origin = [{x}, 2, {z}], u = [4, 0, 0], v = [0, -4, 0] }}");
    let scene = |middle: &str| {
        let surfaces = [plane("-2", 3.0), plane(middle, 0.0), plane("-2", -3.0)].join(", ");
        format!("{BOX}[camera]\nkind = \"projector\"\nsurfaces = [{surfaces}]\n")
    };
    place.write("far.toml", scene("1e200"));
    for engine in ["compute", "reference"] {
        let args = ["render", "far.toml", "--exr", "o.exr", "--engine", engine];
        timed(AT_ONCE, engine, || {
            place.refuses(&args, 2, "a control point lies 1.0e200 from the origin, over the limit of 1e30")
        });
    }
    place.write("far.toml", scene("1e29"));
    timed(BOUNDED, "far", || place.works(&["render", "far.toml", "--exr", "o.exr", "--engine", "reference"]));
}

#[test]
#[ignore = "slow: make test-all"]
fn cameras_of_many_pieces_are_not_built_in_quadratic_time() {
    let place = Place::new();
    let fan = |n: usize| {
        let at = |k: usize| std::f64::consts::TAU * (k % n) as f64 / n as f64;
        let rim = |k: usize| {
            format!(
                "{{\"image\": [{}, {}], \"near\": [0, 0, 4], \"far\": [{k}, 1, 0]}}",
                0.5 + 0.4 * at(k).cos(),
                0.5 + 0.4 * at(k).sin()
            )
        };
        let vertices: Vec<String> = (0..n).map(rim).collect();
        let triangles: Vec<String> = (0..n).map(|k| format!("[0, {}, {}]", 1 + k, 1 + (k + 1) % n)).collect();
        let middle = "{\"image\": [0.5, 0.5], \"near\": [0, 0, 4], \"far\": [0, 0, 0]}";
        format!("{{\"vertices\": [{middle}, {}], \"triangles\": [{}]}}", vertices.join(", "), triangles.join(", "))
    };
    place.write("fan.json", fan(100_000));
    place.write("offsets.npy", random_offsets(600));
    let central = "eye = [0, 0, 4]\ntarget = [0, 0, 0]\n";
    let texture = format!("{central}vfov = 40\nmode = \"bilinear\"\nfile = \"offsets.npy\"\n");
    let polygon: Vec<String> = (0..1600)
        .map(|k| std::f64::consts::TAU * f64::from(k) / 1600.0)
        .map(|a| format!("[{:.9}, {:.9}]", 0.5 + 0.3 * a.cos(), 0.5 + 0.3 * a.sin()))
        .collect();
    let region = format!("regions = [{{ polygon = [{}], eye = [3, 3, 5] }}]\n", polygon.join(", "));
    for (kind, keys) in [
        ("mesh", "file = \"fan.json\"\n".to_owned()),
        ("panorama", "radius = 8\nheight = 4\npieces = 100000\n".into()),
        ("cylinder", format!("{central}strips = 1000000\n")),
        ("camera_texture", texture),
        ("top_down", format!("{central}vfov = 40\n{region}")),
    ] {
        place.write("s.toml", format!("{BOX}[camera]\nkind = \"{kind}\"\n{keys}"));
        timed(BOUNDED, kind, || place.works(&["camera", "s.toml"]));
    }
}

/// A .npy of n x n pairs in [-1, 1].
fn random_offsets(n: usize) -> Vec<u8> {
    let mut header = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({n}, {n}, 2), }}");
    while (10 + header.len() + 1) % 64 != 0 {
        header.push(' ');
    }
    header.push('\n');
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    let mut state = 1u64;
    for _ in 0..2 * n * n {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        bytes.extend(((state >> 11) as f64 / (1u64 << 52) as f64 - 1.0).to_le_bytes());
    }
    bytes
}
