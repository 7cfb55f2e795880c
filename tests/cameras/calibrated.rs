//! `calibrated`: every model of every file, each ray seen at its pixel by the formula that the file's own program documents; poses of
//! images; files that are wrong.

use crate::common::written::camera_in;
use anamorph::internals::camera::Camera;
use anamorph::internals::input::Result;
use glam::{DMat3, DQuat, DVec2, DVec3};
use std::fs;
use std::path::Path;

/// The camera's frame in the world: x right, y down, z forward.
pub const POSE: &str = "eye = [0, 0, 0]\ntarget = [0, 0, -1]";

const SIZE: [u32; 2] = [96, 64];

/// The direction in the camera's frame.
pub fn in_camera_frame(d: DVec3) -> DVec3 {
    DVec3::new(d.x, -d.y, -d.z)
}

/// Largest error of a pixel. Places are some 100 px, which round to 2^-47, and the formulas amplify that by under 2^7.
const PIXEL: f64 = 1.0 / (1u64 << 40) as f64;

/// Every pixel's ray is projected to the pixel's number; the numbers of pixels with a ray, and of rays behind the eye.
pub fn count(camera: &Camera, name: &str, project: impl Fn(DVec3) -> DVec2) -> [usize; 2] {
    let mut counts = [0, 0];
    for (i, j) in (0..camera.height).flat_map(|j| (0..camera.width).map(move |i| (i, j))) {
        let Some(ray) = camera.ray(i, j) else { continue };
        let d = in_camera_frame(ray.direction);
        let off = project(d) - DVec2::new(i.into(), j.into());
        assert!(off.length() <= PIXEL, "{name}: pixel {i},{j} of {d} is projected {off} off");
        counts = [counts[0] + 1, counts[1] + usize::from(d.z < 0.0)];
    }
    counts
}

/// Brown's polynomial terms, as COLMAP's and Kalibr's sources have them.
pub fn brown(p: DVec2, k: &[f64], [p1, p2]: [f64; 2]) -> DVec2 {
    let r2 = p.length_squared();
    let radial = k.iter().rev().fold(0.0, |sum, k| (sum + k) * r2);
    p + p * radial
        + DVec2::new(
            2.0 * p1 * p.x * p.y + p2 * (r2 + 2.0 * p.x * p.x),
            2.0 * p2 * p.x * p.y + p1 * (r2 + 2.0 * p.y * p.y),
        )
}

/// On the sphere of angles: theta in the direction of (x, y).
pub fn equidistant(d: DVec3) -> DVec2 {
    d.truncate().normalize_or_zero() * d.truncate().length().atan2(d.z)
}

/// The projection of a COLMAP model, without focal lengths and principal point, from its `sensor/models.h`.
fn colmap(model: &str, k: &[f64], d: DVec3) -> DVec2 {
    let flat = d.truncate() / d.z;
    match model {
        "SIMPLE_PINHOLE" | "PINHOLE" => flat,
        "SIMPLE_RADIAL" | "RADIAL" => brown(flat, k, [0.0; 2]),
        "OPENCV" => brown(flat, &k[..2], [k[2], k[3]]),
        "FULL_OPENCV" => {
            let (r2, [k3, k4, k5, k6]) = (flat.length_squared(), [k[4], k[5], k[6], k[7]]);
            let over = 1.0 + k4 * r2 + k5 * r2 * r2 + k6 * r2.powi(3);
            let radial = (1.0 + k[0] * r2 + k[1] * r2 * r2 + k3 * r2.powi(3)) / over;
            flat * radial + brown(flat, &[], [k[2], k[3]]) - flat
        }
        "FOV" => {
            let r = flat.length();
            flat * ((2.0 * r * (k[0] / 2.0).tan()).atan() / (r * k[0]))
        }
        "SIMPLE_FISHEYE" | "FISHEYE" | "SIMPLE_RADIAL_FISHEYE" | "RADIAL_FISHEYE" | "OPENCV_FISHEYE" => {
            brown(equidistant(d), k, [0.0; 2])
        }
        "THIN_PRISM_FISHEYE" => {
            let p = equidistant(d);
            brown(p, &[k[0], k[1], k[4], k[5]], [k[2], k[3]]) + DVec2::new(k[6], k[7]) * p.length_squared()
        }
        "RAD_TAN_THIN_PRISM_FISHEYE" => {
            let p = brown(equidistant(d), &k[..6], [0.0; 2]);
            let r2 = p.length_squared();
            // p0 goes with 2 x^2 + r^2 in x
            brown(p, &[], [k[7], k[6]]) + DVec2::new(k[8] + k[9] * r2, k[10] + k[11] * r2) * r2
        }
        "SIMPLE_DIVISION" | "DIVISION" => {
            // the root of k rho r^2 - r + rho = 0 on the middle's branch, rho = tan(theta)
            let (across, root) = (d.truncate(), (d.z * d.z - 4.0 * k[0] * d.truncate().length_squared()).sqrt());
            across * 2.0 / (d.z + root)
        }
        "EUCM" => {
            let [alpha, beta] = [k[0], k[1]];
            let rho = (beta * (d.x * d.x + d.y * d.y) + d.z * d.z).sqrt();
            d.truncate() / (alpha * rho + (1.0 - alpha) * d.z)
        }
        "EQUIRECTANGULAR" => DVec2::new(d.x.atan2(d.z), d.y.atan2(d.x.hypot(d.z))),
        _ => unreachable!("{model}"),
    }
}

/// Each model, its number in binary files, and parameters of a lens of this image.
const COLMAP: [(&str, u32, &[f64]); 18] = [
    ("SIMPLE_PINHOLE", 0, &[60.0, 48.25, 31.5]),
    ("PINHOLE", 1, &[60.0, 58.0, 48.25, 31.5]),
    ("SIMPLE_RADIAL", 2, &[60.0, 48.25, 31.5, -0.08]),
    ("RADIAL", 3, &[60.0, 48.25, 31.5, -0.08, 0.01]),
    ("OPENCV", 4, &[60.0, 58.0, 48.25, 31.5, -0.08, 0.01, 1e-3, -2e-3]),
    ("OPENCV_FISHEYE", 5, &[30.0, 29.0, 48.25, 31.5, 0.02, -0.003, 2e-4, -1e-5]),
    ("FULL_OPENCV", 6, &[60.0, 58.0, 48.25, 31.5, -0.08, 0.01, 1e-3, -2e-3, 0.002, 0.03, 0.004, -0.001]),
    ("FOV", 7, &[60.0, 58.0, 48.25, 31.5, 0.9]),
    ("SIMPLE_RADIAL_FISHEYE", 8, &[30.0, 48.25, 31.5, 0.02]),
    ("RADIAL_FISHEYE", 9, &[30.0, 48.25, 31.5, 0.02, -0.003]),
    ("THIN_PRISM_FISHEYE", 10, &[30.0, 29.0, 48.25, 31.5, 0.02, -0.003, 1e-3, -2e-3, 2e-4, -1e-5, 1e-3, -5e-4]),
    (
        "RAD_TAN_THIN_PRISM_FISHEYE",
        11,
        &[30.0, 29.0, 48.25, 31.5, 0.02, -0.003, 2e-4, -1e-5, 1e-6, 1e-7, 1e-3, -2e-3, 1e-3, 2e-4, -5e-4, 1e-4],
    ),
    ("SIMPLE_DIVISION", 12, &[60.0, 48.25, 31.5, -0.4]),
    ("DIVISION", 13, &[40.0, 39.0, 48.25, 31.5, -0.9]),
    ("SIMPLE_FISHEYE", 14, &[30.0, 48.25, 31.5]),
    ("FISHEYE", 15, &[30.0, 29.0, 48.25, 31.5]),
    ("EUCM", 16, &[30.0, 29.0, 48.25, 31.5, 0.6, 1.1]),
    ("EQUIRECTANGULAR", 17, &[96.0, 64.0]),
];

/// A model in text: a camera, and an image of it.
fn write_text(folder: &Path, cameras: &str, images: &str) {
    fs::write(folder.join("cameras.txt"), format!("# Camera list\n{cameras}\n")).unwrap();
    fs::write(folder.join("images.txt"), format!("# Image list\n{images}")).unwrap();
}

fn line(model: &str, parameters: &[f64]) -> String {
    let parameters: Vec<String> = parameters.iter().map(f64::to_string).collect();
    format!("7 {model} {} {} {}", SIZE[0], SIZE[1], parameters.join(" "))
}

/// The same model in binary.
fn write_binary(folder: &Path, number: u32, parameters: &[f64], (q, t, name): ([f64; 4], [f64; 3], &str)) {
    let words = |all: &[f64]| all.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>();
    let long = |x: u64| x.to_le_bytes().to_vec();
    let short = |x: u32| x.to_le_bytes().to_vec();
    let size = [long(SIZE[0].into()), long(SIZE[1].into())].concat();
    let camera = [long(1), short(7), short(number), size, words(parameters)].concat();
    fs::write(folder.join("cameras.bin"), camera).unwrap();
    let points = [long(1), words(&[1.0, 2.0]), long(u64::MAX)].concat();
    let image = [long(1), short(3), words(&q), words(&t), short(7), name.into(), vec![0], points].concat();
    fs::write(folder.join("images.bin"), image).unwrap();
}

#[test]
fn every_model_of_colmap_is_its_formula_in_text_and_binary() {
    for (model, number, parameters) in COLMAP {
        let [text, binary] = [(); 2].map(|()| tempfile::tempdir().unwrap());
        write_text(text.path(), &line(model, parameters), "");
        write_binary(binary.path(), number, parameters, ([1.0, 0.0, 0.0, 0.0], [0.0; 3], "a.jpg"));
        let of = |folder: &Path| {
            let keys = format!("kind = 'calibrated'\nfile = '{}'\n{POSE}", folder.display());
            camera_in(folder, &keys, None).unwrap_or_else(|e| panic!("{model}: {e}"))
        };
        let (camera, again) = (of(text.path()), of(binary.path()));
        assert_eq!([camera.width, camera.height], SIZE);
        let (focal, centre, k) = match parameters {
            [w, h] => {
                (DVec2::new(w / std::f64::consts::TAU, h / std::f64::consts::PI), DVec2::new(*w, *h) / 2.0, &[][..])
            }
            [f, x, y, k @ ..] if model.starts_with("SIMPLE") || model.starts_with("RADIAL") => {
                (DVec2::splat(*f), DVec2::new(*x, *y), k)
            }
            [fx, fy, x, y, k @ ..] => (DVec2::new(*fx, *fy), DVec2::new(*x, *y), k),
            _ => unreachable!(),
        };
        // COLMAP's first pixel is centred at (0.5, 0.5)
        let [seen, behind] = count(&camera, model, |d| focal * colmap(model, k, d) + centre - 0.5);
        assert!(seen > 5000, "{model}: {seen} rays");
        let is_wide = model.contains("FISHEYE") || matches!(model, "EUCM" | "EQUIRECTANGULAR");
        assert!(!is_wide || behind > 20, "{model}: {behind} rays behind the eye");
        for (i, j) in [(0, 0), (50, 20), (95, 63)] {
            assert_eq!(camera.ray(i, j), again.ray(i, j), "{model}");
        }
    }
}

#[test]
fn images_of_colmap_have_their_pose() {
    // the world to the camera
    let rotation = DQuat::from_xyzw(0.2, -0.4, 0.1, 0.8).normalize();
    let t = DVec3::new(0.3, -1.2, 2.5);
    let (q, name) = ([rotation.w, rotation.x, rotation.y, rotation.z], "street 1/left.jpg");
    let folder = tempfile::tempdir().unwrap();
    let word = |all: &[f64]| all.iter().map(|x| format!("{x:?}")).collect::<Vec<_>>().join(" ");
    let image = |id: u32, name: &str| format!("{id} {} {} 7 {name}\n", word(&q), word(&t.to_array()));
    // an image without points has an empty line, the last may lack even that
    let images = format!("{}1.5 2.5 -1\n{}\n{}", image(1, "first.jpg"), image(2, "empty.jpg"), image(3, name));
    write_text(folder.path(), &line("PINHOLE", COLMAP[1].2), images.trim_end());
    let of = |keys: &str| camera_in(folder.path(), &format!("kind = 'calibrated'\nfile = '.'\n{keys}"), None);
    let camera = of(&format!("image = '{name}'")).unwrap();
    let point = DVec3::new(0.4, 0.2, 3.0);
    let in_camera = rotation * point + t;
    let seen = DVec2::new(60.0, 58.0) * in_camera.truncate() / in_camera.z + DVec2::new(48.25, 31.5) - 0.5;
    let ray = |i, j| camera.ray(i, j).unwrap();
    let eye = ray(0, 0).origin;
    assert!((rotation * eye + t).length() < 1e-15, "{eye}");
    // pixel centres lie on a lattice: interpolate the direction at the place
    let (base, x, y) = (ray(0, 0).direction, ray(1, 0).direction, ray(0, 1).direction);
    let direction = base + seen.x * (x - base) + seen.y * (y - base);
    let t_camera = in_camera.z;
    assert!((eye + t_camera * direction - point).length() < 1e-12, "{}", eye + t_camera * direction);
    // the same in binary, which comes first
    write_binary(folder.path(), 1, COLMAP[1].2, (q, t.to_array(), name));
    let again = of(&format!("image = '{name}'")).unwrap();
    assert_eq!(again.ray(5, 6).unwrap(), ray(5, 6));

    let refused = |keys: &str, expected: &str| {
        let error = of(keys).expect_err(keys).to_string();
        assert!(error.contains(expected) && !error.contains('\n'), "{keys}: {error}");
    };
    // tabs and several blanks, the ends of lines of Windows, a byte order mark: as COLMAP reads it
    for name in ["cameras.bin", "images.bin"] {
        fs::remove_file(folder.path().join(name)).unwrap();
    }
    let spaced = format!("\u{feff}{}", images.replacen(' ', "\t", 9).replace(" 7 ", "  7  ").replace('\n', "\r\n"));
    fs::write(folder.path().join("images.txt"), spaced).unwrap();
    assert_eq!(of(&format!("image = '{name}'")).unwrap().ray(5, 6).unwrap(), ray(5, 6));
    // a file that is named is the one that is read
    write_binary(folder.path(), 0, &[50.0, 40.0, 30.0], (q, t.to_array(), name));
    let named = camera_in(folder.path(), &format!("kind = 'calibrated'\nfile = 'cameras.txt'\n{POSE}"), None).unwrap();
    assert!(named.ray(5, 6).unwrap().direction != of(POSE).unwrap().ray(5, 6).unwrap().direction);
    write_binary(folder.path(), 1, COLMAP[1].2, (q, t.to_array(), "a\u{fffd}"));
    let bytes = fs::read(folder.path().join("images.bin")).unwrap();
    let at = bytes.windows(3).position(|w| w == "\u{fffd}".as_bytes()).unwrap();
    fs::write(folder.path().join("images.bin"), [&bytes[..at], b"\xff", &bytes[at + 3..]].concat()).unwrap();
    let error = of("image = 'a'").unwrap_err().to_string();
    assert!(error.contains("image 3: its name is not UTF-8"), "{error}");
    write_binary(folder.path(), 1, COLMAP[1].2, (q, t.to_array(), name));

    refused("image = 'none.jpg'", "images.bin: has no image \"none.jpg\"");
    refused(&format!("image = '{name}'\neye = [0, 0, 0]"), "eye: image says it already");
    refused(&format!("image = '{name}'\nindex = 7"), "image and index both choose a camera");
    refused(&format!("index = 3\n{POSE}"), "has no camera of this index; it has 7");
}

const RESOLUTION: &str = "resolution: [96, 64]";

/// A camera chain of Kalibr's: cam0 a plain pinhole, cam1 the one that is tested.
fn chain(model: &str, intrinsics: &str, distortion: &str, coefficients: &str) -> String {
    format!(
        "cam0:\n  camera_model: pinhole\n  intrinsics: [50, 50, 47, 31]\n  distortion_model: none\n  \
         distortion_coeffs: []\n  {RESOLUTION}\n  rostopic: /cam0/image_raw\n\
         cam1:\n  T_cn_cnm1:\n  - [1.0, 0.0, 0.0, 0.1]\n  - [0.0, 1.0, 0.0, 0.0]\n  - [0.0, 0.0, 1.0, 0.0]\n  \
         - [0.0, 0.0, 0.0, 1.0]\n  camera_model: {model}\n  intrinsics: {intrinsics}\n  \
         distortion_model: {distortion}\n  distortion_coeffs: {coefficients}\n  {RESOLUTION}\n"
    )
}

pub fn in_file(name: &str, text: &str, keys: &str) -> Result<Camera> {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join(name), text).unwrap();
    camera_in(folder.path(), &format!("kind = 'calibrated'\nfile = '{name}'\n{keys}"), None)
}

type Project = fn(DVec3) -> DVec2;

#[test]
fn every_model_of_kalibr_is_its_formula() {
    const RADTAN: ([f64; 2], [f64; 2]) = ([-0.05, 0.01], [1e-3, -2e-3]);
    let cases: [(&str, &str, &str, &str, f64, Project); 8] = [
        ("pinhole", "[60, 58, 47.5, 31]", "none", "[]", 0.0, |d| d.truncate() / d.z),
        ("pinhole", "[60, 58, 47.5, 31]", "radtan", "[-0.05, 0.01, 0.001, -0.002]", 0.0, |d| {
            brown(d.truncate() / d.z, &RADTAN.0, RADTAN.1)
        }),
        ("pinhole", "[30, 29, 47.5, 31]", "equidistant", "[0.02, -0.003, 2e-4, -1e-5]", 1.0, |d| {
            brown(equidistant(d), &[0.02, -0.003, 2e-4, -1e-5], [0.0; 2])
        }),
        ("pinhole", "[60, 58, 47.5, 31]", "fov", "[0.9]", 0.0, |d| colmap("FOV", &[0.9], d)),
        ("omni", "[1.3, 90, 88, 47.5, 31]", "radtan", "[-0.05, 0.01, 0.001, -0.002]", 0.0, |d| {
            brown(d.truncate() / (d.z + 1.3 * d.length()), &RADTAN.0, RADTAN.1)
        }),
        ("omni", "[0.8, 30, 30, 47.5, 31]", "none", "[]", 1.0, |d| d.truncate() / (d.z + 0.8 * d.length())),
        ("eucm", "[0.6, 1.1, 30, 29, 47.5, 31]", "none", "[]", 1.0, |d| colmap("EUCM", &[0.6, 1.1], d)),
        ("ds", "[-0.2, 0.6, 20, 19, 47.5, 31]", "none", "[]", 1.0, |d| {
            let z = -0.2 * d.length() + d.z;
            d.truncate() / (0.6 * d.truncate().length().hypot(z) + 0.4 * z)
        }),
    ];
    for (model, intrinsics, distortion, k, wide, project) in cases {
        let name = format!("{model}-{distortion}");
        let text = chain(model, intrinsics, distortion, k);
        let camera = in_file("chain.yaml", &text, &format!("index = 1\n{POSE}"));
        let camera = camera.unwrap_or_else(|e| panic!("{name}: {e}"));
        let numbers: Vec<f64> = intrinsics.trim_matches(['[', ']']).split(", ").map(|n| n.parse().unwrap()).collect();
        let [fu, fv, pu, pv] = numbers[numbers.len() - 4..] else { unreachable!() };
        let [seen, behind] = count(&camera, &name, |d| DVec2::new(fu, fv) * project(d) + DVec2::new(pu, pv));
        assert!(seen > 3000 && (wide == 0.0 || behind > 20), "{name}: {seen} rays, {behind} behind");
    }
}

/// A rig with a camera of another model before the one that is tested.
fn rig(properties: &str) -> String {
    format!(
        "{{\"rig\": {{\"sensors\": [{{\"name\": \"lidar\"}}, {{\"name\": \"front\", \"properties\": \
         {{\"Model\": \"ftheta\", \"width\": \"96\", \"height\": 64, \"cx\": \"47.5\", \"cy\": 31.25, {properties}}}}}]}}}}"
    )
}

#[test]
fn f_theta_polynomials_go_both_ways() {
    const C: [f64; 4] = [0.03, 2e-5, -1e-7, 1e-9];
    let centre = DVec2::new(47.5, 31.25);
    let value = |x: f64| C.iter().rev().fold(0.0, |sum, c| (sum + c) * x);
    let list = "\"0 0.03 2e-5 -1e-7 1e-9\"";
    for properties in [
        format!("\"bw-poly\": {list}"),
        format!("\"polynomial\": {list}, \"polynomial-type\": \"pixeldistance-to-angle\""),
    ] {
        let camera = in_file("rig.json", &rig(&properties), POSE).unwrap();
        let mut behind = 0;
        for (i, j) in (0..64).flat_map(|j| (0..96).map(move |i| (i, j))) {
            let off = DVec2::new(i.into(), j.into()) - centre;
            let (sin, cos) = value(off.length()).sin_cos();
            let expected = (off.normalize() * sin).extend(cos);
            let found = in_camera_frame(camera.ray(i, j).unwrap().direction);
            behind += u32::from(cos < 0.0);
            assert!((found - expected).length() < 1e-14, "{i},{j}: {found}, not {expected}");
        }
        assert!(behind > 50, "{behind}");
    }
    // r = 30 theta + theta^2, and the affine part
    let text =
        rig("\"polynomial\": \"0 30 1\", \"polynomial-type\": \"angle-to-pixeldistance\", \"linear-c\": \"1.01\", \
         \"linear-d\": 0.02, \"linear-e\": -0.01");
    let camera = in_file("rig.json", &text, &format!("index = 1\n{POSE}")).unwrap();
    let linear = DMat3::from_cols_array(&[1.01, -0.01, 0.0, 0.02, 1.0, 0.0, 0.0, 0.0, 1.0]);
    let [seen, behind] = count(&camera, "angle-to-pixeldistance", |d| {
        let p = equidistant(d);
        (linear * (p * (30.0 + p.length())).extend(0.0)).truncate() + centre
    });
    assert!(seen == 96 * 64 && behind > 50, "{seen} {behind}");
}

#[test]
fn files_of_ros_are_opencvs_without_a_model_in_the_scene() {
    let text = "image_width: 96\nimage_height: 64\ncamera_name: left\ncamera_matrix:\n  rows: 3\n  cols: 3\n  \
                data: [30.0, 0, 47.5, 0, 29.0, 31.0, 0, 0, 1]\ndistortion_model: equidistant\n\
                distortion_coefficients:\n  rows: 1\n  cols: 4\n  data: [0.02, -0.003, 0.0, 0.0]\n";
    let camera = in_file("left.yaml", text, POSE).unwrap();
    let [seen, behind] = count(&camera, "equidistant", |d| {
        DVec2::new(30.0, 29.0) * brown(equidistant(d), &[0.02, -0.003], [0.0; 2]) + DVec2::new(47.5, 31.0)
    });
    assert!(seen == 96 * 64 && behind > 50, "{seen} {behind}");
}

#[test]
fn wrong_files_are_refused_in_one_line() {
    let simple = |model: &str, k: &str| format!("1 {model} 96 64 {k}");
    for (cameras, says) in [
        ("", "cameras.txt: has no camera that can be used"),
        ("1 PINHOLE", "cameras.txt: line 2: the width is missing"),
        ("1 PINHOLE 96 64 a", "line 2: a parameter: \"a\" is not a number"),
        ("1 LENS 96 64 1", "camera 1: model \"LENS\" is not known"),
        (&simple("OPENCV", "60 60 48 32"), "camera 1: 4 parameters; OPENCV has 8"),
        (&simple("PINHOLE", "0 60 48 32"), "camera 1: focal lengths 0, 60"),
        (&simple("PINHOLE", "60 60 nan 32"), "all numbers finite"),
        (&simple("RADIAL", "60 48 32 inf 0"), "distortion coefficients: all must be finite"),
        (&simple("EUCM", "60 60 48 32 1.5 1"), "alpha = 1.5: must be in [0, 1]"),
        (&simple("FOV", "60 60 48 32 4"), "omega = 4: must be in [0, pi)"),
        ("1 PINHOLE 0 64 60 60 48 32", "cameras.txt: camera 1: "),
        ("1 PINHOLE 96 64 60 60 48 32\n2 PINHOLE 96 64 60 60 48 32", "has cameras 1, 2; choose one: index = 1"),
    ] {
        let folder = tempfile::tempdir().unwrap();
        write_text(folder.path(), cameras, "");
        let keys = format!("kind = 'calibrated'\nfile = 'cameras.txt'\n{POSE}");
        let error = camera_in(folder.path(), &keys, None).expect_err(cameras).to_string();
        assert!(error.contains(says) && !error.contains('\n'), "{cameras}: {error}");
    }
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("cameras.bin"), [9, 0, 0, 0, 0, 0, 0, 0, 1]).unwrap();
    let keys = format!("kind = 'calibrated'\nfile = '.'\n{POSE}");
    let error = camera_in(folder.path(), &keys, None).unwrap_err().to_string();
    assert!(error.contains("cameras.bin: ends too early"), "{error}");

    let refused = |name: &str, text: &str, says: &str| {
        let error = in_file(name, text, &format!("index = 1\n{POSE}")).expect_err(text).to_string();
        assert!(error.contains(says) && !error.contains('\n'), "{text}: {error}");
    };
    for (model, intrinsics, distortion, k, says) in [
        ("lens", "[1]", "none", "[]", "camera_model: \"lens\" is not known"),
        ("ds", "[0.1, 60, 58, 47.5, 31]", "none", "[]", "intrinsics: 5 numbers; ds has 6: xi, alpha, fu, fv, pu, pv"),
        ("ds", "[1.1, 0.5, 60, 58, 47.5, 31]", "none", "[]", "xi = 1.1: must be in (-1, 1]"),
        ("omni", "[1, 60, 58, 47.5, 31]", "fov", "[0.9]", "distortion_model: fov with 1 distortion_coeffs and omni"),
        ("pinhole", "[60, 58, 47.5, 31]", "radtan", "[1]", "radtan (4)"),
        ("pinhole", "[60, 58, 47.5]", "none", "[]", "pinhole has 4"),
        ("pinhole", "hello", "none", "[]", "not a camchain as Kalibr writes it"),
    ] {
        refused("chain.yaml", &chain(model, intrinsics, distortion, k), says);
    }
    for (properties, says) in [
        ("\"bw-poly\": \"0.1 0.03\"", "its first number must be 0"),
        ("\"bw-poly\": \"0 -0.03\"", "polynomial: must be finite, and start with 0 and a number over 0"),
        ("\"bw-poly\": \"0 x\"", "polynomial: \"x\" is not a number"),
        ("\"polynomial\": \"0 1\", \"polynomial-type\": \"cubic\"", "polynomial-type: \"cubic\" is not known"),
        ("\"linear-c\": \"a\", \"bw-poly\": \"0 1\"", "linear-c must be a finite number"),
        ("\"other\": 1", "polynomial (or bw-poly) is missing"),
    ] {
        refused("rig.json", &rig(properties), says);
    }
    let long = format!("\"bw-poly\": \"0 0.01{}\"", " 1e-3".repeat(20_000));
    refused("rig.json", &rig(&long), "polynomial: of degree 20001; at most 16");
    refused("rig.json", &rig("\"bw-poly\": \"0 0.03\", \"linear-c\": 0"), "c - d e = 0; it must be over 0");
    refused("rig.json", "{\"rig\": {\"sensors\": []}}", "has no camera of this index");
    refused("cam.yaml", "image_width: 96\n", "not a calibration as OpenCV writes it");
}
