//! Copies of meshes, height images, smooth normals, and `anamorph info FILE`.

use super::program::Place;
use anamorph::internals::image::frame::{Channel, Frame};
use anamorph::internals::image::{read_exr, write_npy_f64};
use anamorph::internals::input::Loading;
use serde_json::Value;
use std::path::Path;

const HEAD: &str =
    "[image]\nwidth = 64\nheight = 48\n[camera]\nkind = \"pinhole\"\neye = [1, 3, 9]\ntarget = [0, 0, 0]\nvfov = 50\n";

/// The channels of a scene, rendered by the reference.
fn seen(place: &Place, meshes: &str) -> Frame {
    place.write("s.toml", format!("{HEAD}{meshes}"));
    let channels = "R,G,B,A,Z,triangle.id,N,P,albedo";
    place.works(&["render", "s.toml", "--exr", "s.exr", "--engine", "reference", "--channels", channels]);
    read_exr(&place.path().join("s.exr"), &Loading::default()).unwrap()
}

/// A translation, a mirroring and a shear, row by row.
const PLACES: [[f64; 12]; 3] = [
    [1.0, 0.0, 0.0, -2.5, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.5],
    [-1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0],
    [1.0, 0.4, 0.0, 2.5, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.5, -0.5],
];

fn text(places: &[[f64; 12]]) -> String {
    let rows = |m: &[f64; 12]| format!("[{:?}, {:?}, {:?}]", &m[..4], &m[4..8], &m[8..]);
    format!("[{}]", places.iter().map(rows).collect::<Vec<_>>().join(", "))
}

fn with_last_row(m: &[f64; 12]) -> Vec<f64> {
    [&m[..], &[0.0, 0.0, 0.0, 1.0]].concat()
}

#[test]
fn places_are_read_from_lists_and_files() {
    let place = Place::new();
    let teapot = "[[mesh]]\nbuiltin = \"teapot\"\nlevel = 3\nscale = 0.5\nrotate = [0, 30, 0]\n";
    let given = seen(&place, &format!("{teapot}places = {}", text(&PLACES)));
    write_npy_f64(&place.path().join("p34.npy"), &[3, 3, 4], &PLACES.concat()).unwrap();
    write_npy_f64(&place.path().join("p44.npy"), &[3, 4, 4], &PLACES.each_ref().map(with_last_row).concat()).unwrap();
    place.write("p.json", text(&PLACES));
    for file in ["p34.npy", "p44.npy", "p.json"] {
        assert!(seen(&place, &format!("{teapot}places = {file:?}")) == given, "{file}");
    }
    // triangle ids continue from copy to copy, as from mesh to mesh
    let single = |m: &[f64; 12]| format!("{teapot}places = {}\n", text(&[*m]));
    assert!(seen(&place, &PLACES.each_ref().map(single).concat()) == given);
    let per_copy = 64 * 3 * 3;
    let ids: Vec<u32> = given.u32(Channel::TriangleId).unwrap().iter().filter(|id| **id != u32::MAX).copied().collect();
    assert!((0..3).all(|k| ids.iter().any(|id| id / per_copy == k)) && ids.iter().all(|id| id / per_copy < 3));
}

#[test]
fn a_place_transforms_as_scale_rotate_and_translate_do() {
    let place = Place::new();
    // mirroring swaps front and back faces, as a negative scale does
    let one = "[[mesh]]\nbuiltin = \"icosphere\"\nlevel = 1\ntwo_sided = false\n";
    let mirrored = seen(&place, &format!("{one}places = {}", text(&PLACES[1..2])));
    assert!(mirrored == seen(&place, &format!("{one}scale = [-1, 1, 1]")));
    let plain = seen(&place, one);
    assert!(mirrored.f32(Channel::Z).unwrap() != plain.f32(Channel::Z).unwrap());
    // places are applied last: a quarter turn takes what was moved along x to -z
    let turn = "places = [[[0, 0, 1, 0], [0, 1, 0, 0], [-1, 0, 0, 0], [0, 0, 0, 1]]]";
    let moved = seen(&place, &format!("[[mesh]]\nbuiltin = \"teapot\"\nlevel = 2\ntranslate = [1.5, 0, 0]\n{turn}"));
    let same = "[[mesh]]\nbuiltin = \"teapot\"\nlevel = 2\nrotate = [0, 90, 0]\ntranslate = [0, 0, -1.5]";
    assert!(moved == seen(&place, same));
}

#[test]
fn each_copy_is_an_object_of_mattes() {
    let place = Place::new();
    let teapot = "[[mesh]]\nname = \"tree\"\nbuiltin = \"box\"\n";
    place.write("s.toml", format!("{HEAD}{teapot}places = {}\n[[mesh]]\nbuiltin = \"box\"\n", text(&PLACES)));
    let out = ["render", "s.toml", "--exr", "s.exr", "--engine", "reference", "--channels", "crypto.object"];
    place.works(&out);
    let bytes = std::fs::read(place.path().join("s.exr")).unwrap();
    let header = String::from_utf8_lossy(&bytes).into_owned();
    for name in ["\"box\":", "\"tree#0\":", "\"tree#1\":", "\"tree#2\":"] {
        assert!(header.contains(name), "{name}");
    }
    assert!(!header.contains("\"tree\":"));
}

/// On an octahedron of radius 1, barycentric weights are the absolute values of the coordinates, and vertex normals are the axes. So the
/// interpolated normal points away from the origin everywhere.
#[test]
fn a_smooth_octahedron_has_the_normals_of_a_sphere() {
    let place = Place::new();
    let vertices = "v 1 0 0\nv -1 0 0\nv 0 1 0\nv 0 -1 0\nv 0 0 1\nv 0 0 -1\n";
    let faces = ["1 3 5", "3 2 5", "2 4 5", "4 1 5", "3 1 6", "2 3 6", "4 2 6", "1 4 6"];
    place.write("bare.obj", format!("{vertices}{}", faces.map(|f| format!("f {f}\n")).concat()));
    let normals = vertices.replace("v ", "vn ");
    let with = |f: &str| format!("f {}\n", f.split(' ').map(|k| format!("{k}//{k} ")).collect::<String>());
    place.write("with.obj", format!("{vertices}{normals}{}", faces.map(with).concat()));

    let given = seen(&place, "[[mesh]]\nfile = \"with.obj\"\n");
    let smooth = seen(&place, "[[mesh]]\nfile = \"bare.obj\"\nsmooth = true\n");
    let flat = seen(&place, "[[mesh]]\nfile = \"bare.obj\"\n");
    // normals of the file stay as they are
    assert!(seen(&place, "[[mesh]]\nfile = \"with.obj\"\nsmooth = true\n") == given);
    assert!(smooth == given && smooth != flat);
    let vectors = |name: &str| -> Vec<&[f32]> {
        Channel::named(name).into_iter().map(|channel| smooth.f32(channel).unwrap()).collect()
    };
    let [normal, point] = ["N", "P"].map(vectors);
    let mut hits = 0;
    for k in 0..normal[0].len() {
        let [n, p] = [&normal, &point].map(|v| glam::Vec3::new(v[0][k], v[1][k], v[2][k]));
        // zero where nothing is hit
        if n != glam::Vec3::ZERO {
            hits += 1;
            // f32 rounds the stored hit and normal by 2^-24 each, and the hit's length by as much
            assert!((n - p.normalize()).length() < 8.0 * f32::EPSILON, "{k}: {n} at {p}");
        }
    }
    // the silhouette of an octahedron is at least 3^(1/2) units^2, some 50 px here
    assert!(hits > 40, "{hits}");
}

#[test]
fn many_places_take_linear_time() {
    let place = Place::new();
    let count = 20_000;
    let matrix = |k: usize| [1.0, 0.0, 0.0, k as f64, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    write_npy_f64(&place.path().join("p.npy"), &[count as u64, 3, 4], &(0..count).flat_map(matrix).collect::<Vec<_>>())
        .unwrap();
    place.write("s.toml", format!("{HEAD}[[mesh]]\nbuiltin = \"box\"\nplaces = \"p.npy\"\n"));
    let started = std::time::Instant::now();
    let printed: Value = serde_json::from_str(&place.works(&["info", "s.toml", "--json"])).unwrap();
    assert_eq!((&printed["triangles"], &printed["meshes"]), (&(12 * count).into(), &count.into()));
    // measured: 0.01 s; in quadratic time it would be minutes
    assert!(started.elapsed().as_secs() < 20);
}

#[test]
fn wrong_places_are_refused() {
    let place = Place::new();
    write_npy_f64(&place.path().join("shape.npy"), &[12, 3], &[0.0; 36]).unwrap();
    let mut singular = PLACES.concat();
    singular[12..15].fill(0.0);
    singular[16..19].fill(0.0);
    write_npy_f64(&place.path().join("singular.npy"), &[3, 3, 4], &singular).unwrap();
    write_npy_f64(&place.path().join("nan.npy"), &[1, 3, 4], &[f64::NAN; 12]).unwrap();
    write_npy_f64(&place.path().join("row.npy"), &[1, 4, 4], &[1.0; 16]).unwrap();
    let many: Vec<f64> = (0..30_000).flat_map(|_| PLACES[0]).collect();
    write_npy_f64(&place.path().join("many.npy"), &[30_000, 3, 4], &many).unwrap();
    place.write("text.txt", "");
    for (value, says) in [
        ("3", "mesh.0.places: expected a text in quotes"),
        ("\"none.npy\"", "none.npy: cannot be read"),
        ("\"text.txt\"", "places must be a .npy or .json file"),
        ("\"shape.npy\"", "must be N x 4 x 4 or N x 3 x 4"),
        ("\"singular.npy\"", "matrix 1: the matrix is singular"),
        ("\"nan.npy\"", "matrix 0: an entry is not finite"),
        ("\"row.npy\"", "matrix 0: the last row must be 0, 0, 0, 1"),
        ("\"many.npy\"", "mesh teapot: 30000 places of 16384 triangles"),
        ("[1, 2]", "mesh.0.places.0: expected a matrix of 3 or 4 rows"),
        ("[[[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [5, 0, 0, 1]]]", "mesh.0.places.0.3: the last row must be"),
        ("[[[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, inf, 0]]]", "mesh.0.places.0.2.2: expected a finite number"),
        ("[[[1, 0, 0, 0], [0, 1, 0, 0], [1, 1, 0, 0]]]", "mesh.0.places.0: the matrix is singular"),
    ] {
        place.write("s.toml", format!("{HEAD}[[mesh]]\nbuiltin = \"teapot\"\nlevel = 16\nplaces = {value}\n"));
        place.refuses(&["render", "s.toml", "-o", "out.png", "--engine", "reference"], 2, says);
    }
}

const ASC: &str =
    "ncols 3\nnrows 3\nxllcorner 4000000.5\nyllcorner 0\ncellsize 2\nNODATA_value -1\n0 0 0\n0 3 0\n0 0 -1\n";

#[test]
fn heights_are_terrain() {
    let place = Place::new();
    place.write("dem.asc", ASC);
    place.write(
        "obj.obj",
        "v -2 0 -2\nv 0 0 -2\nv 2 0 -2\nv -2 0 0\nv 0 1.5 0\nv 2 0 0\nv -2 0 2\nv 0 0 2\n\
        f 1 4 5\nf 1 5 2\nf 2 5 6\nf 2 6 3\nf 4 7 8\nf 4 8 5\n",
    );
    let terrain = seen(&place, "[[mesh]]\nfile = \"dem.asc\"\nheight_scale = 0.5\n");
    let object = seen(&place, "[[mesh]]\nfile = \"obj.obj\"\n");
    for channel in [Channel::Z, Channel::A] {
        assert!(terrain.f32(channel).unwrap() == object.f32(channel).unwrap(), "{channel:?}");
    }
    assert!(terrain.u32(Channel::TriangleId).unwrap() == object.u32(Channel::TriangleId).unwrap());
    // an image of 12 x 12 texels, red in the west and green in the east, covers the grid of 3 x 3 samples: its middle is at x = 0,
    // and colours are mixed within half a texel of it
    let image = image::RgbImage::from_fn(12, 12, |x, _| image::Rgb(if x < 6 { [255, 0, 0] } else { [0, 255, 0] }));
    image.save(place.path().join("t.png")).unwrap();
    let printed = seen(&place, "[[mesh]]\nfile = \"dem.asc\"\ntexture = \"t.png\"\n");
    let [x, red] = [Channel::PositionX, Channel::AlbedoR].map(|c| printed.f32(c).unwrap());
    let counts = [(-2.0, -0.25, 1.0), (0.25, 2.0, 0.0)].map(|(from, to, shade)| {
        let own: Vec<f32> = x.iter().zip(red).filter(|(x, _)| (from..to).contains(*x)).map(|p| *p.1).collect();
        assert!(own.iter().all(|r| *r == shade), "{shade}: {own:?}");
        own.len()
    });
    assert!(counts.iter().all(|n| *n > 50), "{counts:?}");
}

#[test]
fn wrong_heights_are_refused() {
    let place = Place::new();
    place.write("dem.asc", ASC);
    place.write("large.asc", "ncols 70000\nnrows 70000\ncellsize 1\n1 2 3\n");
    for (keys, says) in [
        ("file = \"none.tif\"", "none.tif: cannot be read"),
        ("file = \"large.asc\"", "large.asc: 70000 x 70000 heights make over 2^28 triangles"),
        ("file = \"dem.asc\"\ncell = 0", "mesh.0.cell: the size of a cell must be above 0"),
        ("file = \"dem.asc\"\ncell = [1, 2, 3]", "mesh.0.cell: expected the size of a cell, as [x, z]"),
        ("file = \"dem.asc\"\nheight_scale = nan", "mesh.0.height_scale: expected a finite number"),
        ("file = \"dem.obj\"\ncell = 1", "unknown key \"cell\""),
    ] {
        place.write("s.toml", format!("{HEAD}[[mesh]]\n{keys}\n"));
        place.refuses(&["render", "s.toml", "-o", "out.png", "--engine", "reference"], 2, says);
    }
}

/// Renders a model through the camera that `info` prints.
fn fitted(place: &Place, printed: &str, mesh: &str) -> Frame {
    let camera = &printed[printed.find("[camera]").unwrap()..];
    place.write("fit.toml", format!("{camera}\n[[mesh]]\n{mesh}\n"));
    place.works(&["render", "fit.toml", "--exr", "fit.exr", "--engine", "reference", "--size", "64x64"]);
    read_exr(&place.path().join("fit.exr"), &Loading::default()).unwrap()
}

fn assert_fits(frame: &Frame) {
    let a = frame.f32(Channel::A).unwrap();
    let border = |k: usize| [k % 64, k / 64].iter().any(|c| [0, 63].contains(c));
    assert!((0..64 * 64).filter(|&k| border(k)).all(|k| a[k] == 0.0));
    // at least a quarter of the image's width
    let columns = (0..64).filter(|i| (0..64).any(|j| a[64 * j + i] > 0.0)).count();
    assert!(columns >= 16, "{columns}");
}

#[test]
fn info_describes_models_and_fits_a_camera() {
    let place = Place::new();
    place.write("dem.asc", ASC);
    place.write("far.obj", "v 4000000 10 -2\nv 4000001 10 -2\nv 4000000 12 -2\nvn 0 0 1\nf 1//1 2//1 3//1\n");
    let printed = place.works(&["info", "dem.asc"]);
    assert!(
        printed.contains("triangles            6\n") && printed.contains("easting 4000003.5, northing 3; "),
        "{printed}"
    );
    assert!(printed.contains("heights              3 x 3, 1 without data"), "{printed}");
    assert_fits(&fitted(&place, &printed, "file = \"dem.asc\""));
    let printed = place.works(&["info", "far.obj"]);
    assert!(printed.contains("normals              yes\n  texture coordinates  no\n"), "{printed}");
    assert_fits(&fitted(&place, &printed, "file = \"far.obj\""));
    let json: Value = serde_json::from_str(&place.works(&["info", "far.obj", "--json"])).unwrap();
    assert_eq!((&json["triangles"], &json["vertices"], &json["kind"]), (&1.into(), &3.into(), &"model".into()));
    assert_eq!(json["bounds"]["low"], serde_json::json!([4e6, 10.0, -2.0]));
    assert_eq!(json["bounds"]["extent"], serde_json::json!([1.0, 2.0, 0.0]));
    let scene: Value = serde_json::from_str(&place.works(&["info", "scene.toml", "--json"])).unwrap();
    assert_eq!((&scene["triangles"], &scene["camera"]), (&320.into(), &"pinhole".into()));
    // numbers from -10 to 13 between places that the file names
    let header =
        "NRRD0004\ntype: short\ndimension: 3\nsizes: 4 3 2\nspacings: 0.5 1 2\nencoding: raw\nendian: little\n\n";
    let numbers = (-10i16..14).flat_map(i16::to_le_bytes);
    place.write("head.nrrd", header.bytes().chain(numbers).collect::<Vec<u8>>());
    let printed = place.works(&["info", "head.nrrd"]);
    assert!(printed.contains("4 x 3 x 2 along x, y and z\n  values               -10 to 13\n"), "{printed}");
    let json: Value = serde_json::from_str(&place.works(&["info", "head.nrrd", "--json"])).unwrap();
    assert_eq!((&json["kind"], &json["shape"]), (&"volume".into(), &serde_json::json!([2, 3, 4])));
    assert_eq!(
        (&json["values"]["median"], &json["bounds"]["high"]),
        (&1.0.into(), &serde_json::json!([1.5, 2.0, 2.0]))
    );
    for (file, says) in [
        ("none.obj", "none.obj: cannot be read"),
        ("none.toml", "none.toml: cannot be read"),
        ("a.xyz", "a.xyz: unknown kind of mesh file"),
    ] {
        place.refuses(&["info", file], 2, says);
    }
}

#[test]
fn elevations_of_real_places_are_read() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/models/terrain");
    let path = |name: &str| folder.join(name).to_string_lossy().into_owned();
    if !folder.is_dir() {
        return println!("skipped: {} is not there", folder.display());
    }
    let place = Place::new();
    let printed = |name: &str| place.works(&["info", &path(name)]);
    // from the tags and headers of the files
    let tiff = printed("bigtujunga.tif");
    assert!(tiff.contains("heights              1197 x 643, ") && tiff.contains("30 x 30 in the file"), "{tiff}");
    assert!(tiff.contains("easting 394268.6554542635, northing 3798272.8276283755"), "{tiff}");
    let png: Value = serde_json::from_str(&place.works(&["info", &path("bigtujunga_u16.png"), "--json"])).unwrap();
    let same: Value = serde_json::from_str(&place.works(&["info", &path("bigtujunga.tif"), "--json"])).unwrap();
    assert_eq!(png["bounds"]["high"][1], same["bounds"]["high"][1]);
    let asc = printed("srtmgl3_colorado.asc");
    assert!(asc.contains("heights              240 x 144, "), "{asc}");
    // 1/1200 of a degree is 92.662 m along the meridian, and cos(40.15 degrees) times that along the parallel
    assert!(asc.contains("if it is in degrees  use cell = [70.827, 92.662] for metres"), "{asc}");
}

#[test]
fn info_describes_calibrations() {
    let place = Place::new();
    let camera = |n: u32, model: &str| {
        format!(
            "cam{n}:\n  camera_model: {model}\n  intrinsics: [50, 50, 47.5, 31.5]\n  distortion_model: equidistant\n  distortion_coeffs: [-0.08333333333333333, 0, 0, 0]\n  resolution: [96, 64]\n"
        )
    };
    place.write("chain.yaml", format!("%YAML:1.0\n{}{}", camera(0, "pinhole"), camera(1, "lens")));
    let printed = place.works(&["info", "chain.yaml"]);
    for line in [
        "chain.yaml (calibration, Kalibr)\n",
        "  camera 0             96 x 64, equidistant\n",
        "    numbers            cx = 47.5, cy = 31.5, fx = 50, fy = 50, k1 = -0.08333333333333333\n",
        "    pixels with a ray  100 %\n",
        "  camera 1             cannot be used: camera_model: \"lens\" is not known",
    ] {
        assert!(printed.contains(line), "{line:?} is not in {printed}");
    }
    let json: Value = serde_json::from_str(&place.works(&["info", "chain.yaml", "--json"])).unwrap();
    assert_eq!((&json["format"], &json["cameras"][0]["numbers"]["fx"]), (&"Kalibr".into(), &50.0.into()));
    assert!(json["cameras"][1]["error"].as_str().is_some_and(|error| error.contains("not known")), "{json}");
    let frame =
        "{\"file_path\": \"a.png\", \"transform_matrix\": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]}";
    place.write("transforms.json", format!("{{\"w\": 96, \"h\": 64, \"fl_x\": 48, \"frames\": [{frame}]}}"));
    let printed = place.works(&["info", "transforms.json"]);
    // 2 atan(1) across, 2 atan(2 / 3) down
    assert!(printed.contains("field of view      90.0 x 67.4 degrees"), "{printed}");
    assert!(printed.contains("images with poses    1, the first is \"a.png\""), "{printed}");
    place.refuses(&["info", "scan.yaml"], 2, "scan.yaml: cannot be read");
}
