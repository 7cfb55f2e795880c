//! `opencv` and `panini`: places in the picture by the models' own forward formulas.

use crate::common;

use anamorph::internals::camera::project::Projector;
use anamorph::internals::camera::{Camera, Rays};
use anamorph::internals::input::Result;
use anamorph::internals::reference::image::explain;
use common::written::{assert_refused, camera, camera_in};
use glam::{DQuat, DVec2, DVec3};

/// OpenCV's camera at the origin: z forward is -z of the world, y down is -y.
const POSE: &str = "eye = [0, 0, 0]\ntarget = [0, 0, -1]\n";

const MATRIX: [f64; 9] = [320.5, 0.0, 63.25, 0.0, 318.0, 47.5, 0.0, 0.0, 1.0];
const SIZE: (u32, u32) = (128, 96);

/// A file as OpenCV 4 writes it, with keys of no concern to us around.
fn yaml(matrix: [f64; 9], coefficients: &[f64]) -> String {
    let list =
        |n: &[f64]| n.iter().map(|x| format!("{x:e}")).collect::<Vec<_>>().join(", ").replace(", 0e0", ",\n       0.");
    let n = coefficients.len();
    format!(
        "%YAML:1.0\n---\ncalibration_time: \"Tue 04 Nov 2025 09:21:07\"\nimage_width: {}\nimage_height: {}\nflags: 0\n\
         # a remark\ncamera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [ {} ]\n\
         distortion_coefficients: !!opencv-matrix\n   rows: {n}\n   cols: 1\n   dt: d\n   data: [ {} ]\n\
         avg_reprojection_error: 1.9e-01\n",
        SIZE.0,
        SIZE.1,
        list(&matrix),
        list(coefficients)
    )
}

fn opencv(text: &str, keys: &str, size: Option<(u32, u32)>) -> Result<Camera> {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("cam.yml"), text).unwrap();
    camera_in(folder.path(), &format!("kind = 'opencv'\nfile = 'cam.yml'\n{keys}"), size)
}

/// OpenCV's `projectPoints` without rotation and translation, written from its documentation.
fn project(m: [f64; 9], k: &[f64], d: DVec3) -> DVec2 {
    let c = |i: usize| k.get(i).copied().unwrap_or(0.0);
    let (x, y) = (d.x / -d.z, -d.y / -d.z);
    let r2 = x * x + y * y;
    let g = (1.0 + c(0) * r2 + c(1) * r2 * r2 + c(4) * r2 * r2 * r2)
        / (1.0 + c(5) * r2 + c(6) * r2 * r2 + c(7) * r2 * r2 * r2);
    let xd = x * g + 2.0 * c(2) * x * y + c(3) * (r2 + 2.0 * x * x) + c(8) * r2 + c(9) * r2 * r2;
    let yd = y * g + c(2) * (r2 + 2.0 * y * y) + 2.0 * c(3) * x * y + c(10) * r2 + c(11) * r2 * r2;
    DVec2::new(m[0] * xd + m[2], m[4] * yd + m[5])
}

/// OpenCV's `fisheye::projectPoints`.
fn project_fisheye(m: [f64; 9], k: &[f64], d: DVec3) -> DVec2 {
    let across = DVec2::new(d.x, -d.y);
    let theta = across.length().atan2(-d.z);
    let t2 = theta * theta;
    let seen = theta * (1.0 + t2 * (k[0] + t2 * (k[1] + t2 * (k[2] + t2 * k[3]))));
    DVec2::new(m[0], m[4]) * across.normalize_or_zero() * seen + DVec2::new(m[2], m[5])
}

/// Pixels: places up to 128 round to 2^-46, and the model's 2^-48 times the focal length of 320 is 2^-39.6.
const PIXEL_ROUNDING: f64 = 1.0 / (1u64 << 39) as f64;

fn all_pixels(camera: &Camera) -> impl Iterator<Item = (u32, u32)> + use<> {
    let (w, h) = (camera.width, camera.height);
    (0..h).flat_map(move |j| (0..w).map(move |i| (i, j)))
}

#[test]
fn every_ray_is_seen_at_its_pixel_by_the_brown_model() {
    for k in [
        &[][..],
        &[-0.3, 0.12, 0.0, 0.0],
        &[-0.28, 0.09, 1.2e-3, -8e-4],
        &[-0.418, 0.507, 1e-4, 2e-4, -0.578],
        &[0.3, 0.1, -4e-3, 2e-3, 0.02, 0.1, 0.05, 0.01],
        // zero tails, as calibrateCamera returns them
        &[-0.28, 0.09, 1.2e-3, -8e-4, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        &[-0.28, 0.09, 1.2e-3, -8e-4, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        // a pole at a radius of 1.954, ten times as far as the picture's corners
        &[0.0, 0.0, 0.0, 0.0, 0.0, -0.08, -0.04, -0.002],
        &[0.0, 0.0, 0.0, 0.0, 0.0, -0.071, 0.017, -0.001],
        &[-0.28, 0.09, 1.2e-3, -8e-4, 0.0, 0.1, 0.0, 0.0, 3e-3, -1e-3, 2e-3, 1e-3],
    ] {
        let camera = opencv(&yaml(MATRIX, k), POSE, None).unwrap();
        assert_eq!((camera.width, camera.height), SIZE);
        for (i, j) in all_pixels(&camera) {
            let ray = camera.ray(i, j).unwrap();
            assert_eq!(ray.direction.z, -1.0, "t is OpenCV's z");
            let seen = project(MATRIX, k, ray.direction);
            let off = (seen - DVec2::new(i.into(), j.into())).length();
            assert!(off <= PIXEL_ROUNDING, "{k:?}: {i},{j} is seen at {seen}, {off} px off");
        }
    }
}

#[test]
fn every_ray_is_seen_at_its_pixel_by_the_fisheye_model() {
    // 64 px of a focal length of 32 px: rays beyond 90 degrees
    let matrix = [32.0, 0.0, 63.5, 0.0, 31.0, 47.5, 0.0, 0.0, 1.0];
    let k = [0.01, -0.002, 1e-4, 0.0];
    let camera = opencv(&yaml(matrix, &k), &format!("{POSE}model = 'fisheye'"), None).unwrap();
    let mut behind = 0;
    for (i, j) in all_pixels(&camera) {
        let ray = camera.ray(i, j).unwrap();
        behind += u32::from(ray.direction.z > 0.0);
        let off = (project_fisheye(matrix, &k, ray.direction) - DVec2::new(i.into(), j.into())).length();
        assert!(off <= PIXEL_ROUNDING, "{i},{j}: {off} px off");
    }
    assert!(behind > 100, "{behind} rays go behind");
}

#[test]
fn the_principal_point_is_a_pixel_centre_and_right_is_right() {
    let matrix = [100.0, 0.0, 64.0, 0.0, 100.0, 48.0, 0.0, 0.0, 1.0];
    let camera = opencv(&yaml(matrix, &[0.0; 5]), POSE, None).unwrap();
    assert_eq!(camera.ray(64, 48).unwrap().direction, DVec3::NEG_Z);
    assert!((camera.ray(114, 23).unwrap().direction - DVec3::new(0.5, 0.25, -1.0)).length() < 1e-15);
    // twice the size: u = (129 + 1/2) / 2 - 1/2 = 64.25
    let twice = opencv(&yaml(matrix, &[0.0; 5]), POSE, Some((256, 192))).unwrap();
    assert!((twice.ray(129, 97).unwrap().direction - DVec3::new(0.0025, -0.0025, -1.0)).length() < 1e-15);
}

#[test]
fn no_pixel_beyond_the_fold_has_a_ray() {
    // r - r^3 reaches 2 / (3 sqrt 3) = 0.385 at most: 38.49 px of the 63.5 to the left and right
    let matrix = [100.0, 0.0, 63.5, 0.0, 100.0, 47.5, 0.0, 0.0, 1.0];
    let camera = opencv(&yaml(matrix, &[-1.0, 0.0, 0.0, 0.0]), POSE, None).unwrap();
    for (i, j) in all_pixels(&camera) {
        let radius = DVec2::new(f64::from(i) - 63.5, f64::from(j) - 47.5).length() / 100.0;
        let ray = camera.ray(i, j);
        assert_eq!(ray.is_some(), radius < 2.0 / (3.0 * 3f64.sqrt()), "{i},{j}");
        // the branch through the middle
        assert!(ray.is_none_or(|r| r.direction.truncate().length() < 3f64.sqrt().recip()));
    }
}

/// A pole outside the picture changes nothing inside: directions near the axis are seen near the middle.
#[test]
fn poles_outside_the_picture_leave_it_alone() {
    let matrix = [40.0, 0.0, 31.5, 0.0, 40.0, 23.5, 0.0, 0.0, 1.0];
    let text =
        |k: &[f64]| yaml(matrix, k).replace("image_width: 128", "image_width: 64").replace("height: 96", "height: 48");
    for k in [[0.0, 0.0, 0.0, 0.0, 0.0, -0.08, -0.04, -0.002], [0.0, 0.0, 0.0, 0.0, 0.0, -0.071, 0.017, -0.001]] {
        let camera = opencv(&text(&k), POSE, None).unwrap();
        let middle = camera.ray(31, 23).unwrap().direction;
        assert!((middle - DVec3::new(-0.0125, 0.0125, -1.0)).length() < 1e-4, "{k:?}: {middle}");
        let radii: Vec<f64> = (31..64).map(|i| camera.ray(i, 23).unwrap().direction.truncate().length()).collect();
        assert!(radii.windows(2).skip(1).all(|w| w[0] < w[1]), "{k:?}: {radii:?}");
    }
}

/// Tangential terms that fold a lens whose radial part grows everywhere. Each pixel's ray is seen at that pixel; points on rays
/// project to their pixels, up to the fold; and no pixel takes a ray of another branch.
#[test]
fn one_branch_up_to_the_fold() {
    let (matrix, k) = ([40.0, 0.0, 63.5, 0.0, 40.0, 47.5, 0.0, 0.0, 1.0], [-0.4095, 0.0777, -0.0080, 0.0038]);
    let camera = opencv(&yaml(matrix, &k), POSE, None).unwrap();
    let projector = Projector::new(&camera);
    let (mut with, mut without) = (0, 0);
    for (i, j) in all_pixels(&camera) {
        let place = DVec2::new(f64::from(i) + 0.5, f64::from(j) + 0.5);
        let Some(ray) = camera.ray(i, j) else {
            without += 1;
            continue;
        };
        with += 1;
        let off = (project(matrix, &k, ray.direction) + 0.5).distance(place);
        assert!(off <= PIXEL_ROUNDING, "{i},{j}: {off}");
        let images = projector.project(2.5 * ray.direction).images;
        let [image] = images[..] else { panic!("{i},{j}: {images:?}") };
        assert!(
            DVec2::new(image.x, image.y).distance(place) <= 1e-9 && (image.t - 2.5).abs() < 1e-15,
            "{i},{j}: {image:?}"
        );
        // halfway to the middle there is a ray, nearer to the axis
        let Rays::Field(field) = &camera.layers[0] else { unreachable!() };
        let inner = field.ray_at(DVec2::new(64.0, 48.0).midpoint(place)).unwrap().direction;
        assert!(inner.truncate().length() <= ray.direction.truncate().length(), "{i},{j}");
    }
    assert!(with > 3000 && without > 3000, "{with} {without}");
}

/// `--check` can find a wrong inverse of a lens, because the reference computes its own rays.
#[test]
fn the_reference_inverts_lenses_itself() {
    let k = [-0.28, 0.09, 1.2e-3, -8e-4, 0.0, 0.1, 0.0, 0.0, 3e-3, -1e-3, 2e-3, 1e-3, 0.05, -0.03];
    let mut scene =
        common::file::load("[camera]\nkind = 'pinhole'\neye = [0, 0, 0]\ntarget = [0, 0, -1]\nvfov = 40\n").unwrap();
    let camera = opencv(&yaml(MATRIX, &k), POSE, None).unwrap();
    scene.size = Some(SIZE);
    let text = explain(&scene, &camera, 20, 30).text;
    let direction = text.lines().find_map(|l| l.strip_prefix("D: [")).unwrap().trim_end_matches(']');
    let own: Vec<f64> = direction.split(", ").map(|x| x.parse().unwrap()).collect();
    let off = DVec3::from_slice(&own) - camera.ray(20, 30).unwrap().direction;
    assert!(off.length() < 1e-14, "{text}");
    // another lens has other rays in the reference too
    let wrong = opencv(&yaml(MATRIX, &k.map(|k| 1.01 * k)), POSE, None).unwrap();
    assert_ne!(explain(&scene, &wrong, 20, 30).text, text);
}

#[test]
fn a_rolling_shutter_moves_and_turns_row_by_row() {
    let matrix = [100.0, 0.0, 63.5, 0.0, 100.0, 47.5, 0.0, 0.0, 1.0];
    let text = yaml(matrix, &[-0.1, 0.0, 0.0, 0.0]);
    let still = opencv(&text, POSE, None).unwrap();
    let keys = format!("{POSE}line_time = 0.01\nvelocity = [3, 0, -1]\nangular_velocity = [0, 90, 0]");
    let moving = opencv(&text, &keys, None).unwrap();
    for (i, j) in all_pixels(&still) {
        let (a, b) = (still.ray(i, j).unwrap(), moving.ray(i, j).unwrap());
        let time = f64::from(j) * 0.01;
        assert!((b.origin - DVec3::new(3.0, 0.0, -1.0) * time).length() < 1e-14);
        // to the left, as seen from above: anticlockwise about y
        let turned = DQuat::from_rotation_y((90.0 * time).to_radians()) * a.direction;
        assert!((b.direction - turned).length() < 1e-14, "{i},{j}");
    }
    assert!(moving.ray(63, 90).unwrap().direction.x < -0.5);
}

#[test]
fn wrong_calibrations_say_why() {
    let refused = |text: &str, keys: &str, expected: &str| {
        let error = opencv(text, &format!("{POSE}{keys}"), None).unwrap_err();
        let said = error.to_string();
        assert!(error.exit_code() == 2 && said.contains(expected) && !said.contains('\n'), "{expected}: {said}");
    };
    let good = yaml(MATRIX, &[0.1, 0.0, 0.0, 0.0]);
    refused(
        &yaml(MATRIX, &[0.1; 6]),
        "",
        "camera.file: 6 distortion coefficients; the Brown model has 0, 4, 5, 8, 12 or 14",
    );
    let mut tilted = [0.0; 14];
    tilted[12] = 1.6;
    refused(&yaml(MATRIX, &tilted), "", "camera.file: tau_x = 1.6, tau_y = 0: a tilt must be under pi / 2");
    refused(&yaml(MATRIX, &[0.1; 5]), "model = 'fisheye'", "the fisheye model has 4");
    let mut skewed = MATRIX;
    skewed[1] = 0.5;
    refused(&yaml(skewed, &[]), "", "must be [fx, 0, cx");
    let mut flat = MATRIX;
    flat[0] = 0.0;
    refused(&yaml(flat, &[]), "", "camera_matrix: focal lengths 0, 318");
    refused(&good.replace("image_width: 128", "image_width: 0"), "", "no pixels");
    refused(&good.replace("image_width: 128\n", ""), "", "image_width");
    refused(&good.replace("rows: 4", "rows: 5"), "", "distortion_coefficients: 4 numbers in 5 x 1");
    refused(&good.replace("1e-1", ".nan"), "", "finite");
    refused("nothing", "", "not a calibration");
    refused("cam0:\n  camera_model: pinhole\n", "", "a calibration of Kalibr, which kind = \"calibrated\" reads");
    refused("%YAML:1.0\n---\n[", "", "not a calibration");
    refused(&good, "model = 'tilted'", "camera.model");
    refused(&good, "velocity = [1, 0, 0]", "camera.velocity");
    assert_refused(&format!("{POSE}kind = 'opencv'\nfile = 'none.yml'"), "cannot be read");
}

#[test]
fn a_file_that_leaves_its_model_open_is_told_of() {
    let open = yaml(MATRIX, &[0.1, 0.0, 0.0, 0.0]);
    let told = |text: &str, keys: &str| opencv(text, &format!("{POSE}{keys}"), None).unwrap().unfulfilled;
    assert!(told(&open, "")[0].contains("model = \"fisheye\""));
    // the scene says, the file says, or no fisheye has as many
    assert!(told(&open, "model = 'brown'").is_empty() && told(&open, "model = 'fisheye'").is_empty());
    for line in ["distortion_model: plumb_bob", "distortion_model: fisheye", "fisheye_model: 0"] {
        assert!(told(&format!("{open}{line}\n"), "").is_empty(), "{line}");
    }
    assert!(told(&yaml(MATRIX, &[0.1, 0.0, 0.0, 0.0, 0.0]), "").is_empty());
}

/// The same lens in all three formats of `FileStorage`, as OpenCV 5 writes them.
#[test]
fn xml_and_json_are_read_as_yaml_is() {
    let k = [-0.28, 0.09, 1.2e-3, -8e-4, 0.0];
    let data = |n: &[f64], between: &str| n.iter().map(|x| format!("{x:?}")).collect::<Vec<_>>().join(between);
    let matrix = |name: &str, rows: usize, n: &[f64]| {
        let (cols, data) = (n.len() / rows, data(n, " "));
        format!(
            "<{name} type_id=\"opencv-matrix\">\n  <rows>{rows}</rows>\n  <cols>{cols}</cols>\n  <dt>d</dt>\n  <data>\n    {data}</data></{name}>\n"
        )
    };
    let xml = format!(
        "<?xml version=\"1.0\"?>\n<opencv_storage>\n<calibration_time>\"now &amp; then\"</calibration_time>\n<image_width>128</image_width>\n\
         <image_height>96</image_height>\n{}{}</opencv_storage>\n",
        matrix("camera_matrix", 3, &MATRIX),
        matrix("distortion_coefficients", 5, &k)
    );
    let table = |rows: usize, n: &[f64]| {
        let (cols, data) = (n.len() / rows, data(n, ", "));
        format!(
            "{{ \"type_id\": \"opencv-matrix\", \"rows\": {rows}, \"cols\": {cols}, \"dt\": \"d\", \"data\": [ {data} ] }}"
        )
    };
    let json = format!(
        "{{\n    \"image_width\": 128,\n    \"image_height\": 96,\n    \"camera_matrix\": {},\n    \"distortion_coefficients\": {}\n}}\n",
        table(3, &MATRIX),
        table(5, &k)
    );
    let expected = opencv(&yaml(MATRIX, &k), POSE, None).unwrap();
    for text in [&xml, &json, &yaml(MATRIX, &k).replace("%YAML:1.0", "%YAML 1.2")] {
        let camera = opencv(text, POSE, None).unwrap_or_else(|e| panic!("{e}: {text}"));
        for (i, j) in all_pixels(&expected) {
            assert_eq!(camera.ray(i, j), expected.ray(i, j));
        }
    }
    let wrong = |text: String, expected: &str| {
        let error = opencv(&text, POSE, None).unwrap_err();
        let said = error.to_string();
        assert!(error.exit_code() == 2 && said.contains(expected) && !said.contains('\n'), "{expected}: {said}");
    };
    wrong(xml.replace("opencv_storage", "storage"), "its root element is <storage>");
    wrong(xml.replace("image_width", "breadth"), "image_width is missing; add image_width and image_height");
    wrong(xml.replace("</data>", " x</data>"), "<data>: \"x\" is not a number");
    wrong(xml.replace("<rows>5", "<rows>4"), "distortion_coefficients: 5 numbers in 4 x 1");
    wrong(xml.replace("<dt>", "<rows>1</rows><dt>"), "<rows> is there twice");
    wrong(xml.replace("</opencv_storage>", ""), "not a calibration");
    wrong(json.replace("\"rows\"", "\"row\""), "missing field `rows`");
    wrong(format!("<a>{}", "<b>".repeat(100_000)), "not a calibration");
}

/// ROS's `camera_info` names the model of its coefficients.
#[test]
fn the_model_that_a_file_names_is_read() {
    let k = [0.02, -0.003, 1e-3, 0.0];
    let text = |key: &str, k: &[f64]| format!("{}{key}\n", yaml(MATRIX, k));
    let plain = |model: &str| opencv(&yaml(MATRIX, &k), &format!("{POSE}model = '{model}'"), None).unwrap();
    let same = |a: &Camera, b: &Camera| all_pixels(a).all(|(i, j)| a.ray(i, j) == b.ray(i, j));
    for (key, model) in [
        ("distortion_model: equidistant", "fisheye"),
        ("distortion_model: plumb_bob", "brown"),
        ("distortion_model: rational_polynomial", "brown"),
        ("fisheye_model: 1", "fisheye"),
        ("fisheye_model: 0", "brown"),
    ] {
        let read = opencv(&text(key, &k), POSE, None).unwrap();
        assert!(same(&read, &plain(model)), "{key}");
        assert!(same(&opencv(&text(key, &k), &format!("{POSE}model = '{model}'"), None).unwrap(), &read), "{key}");
        let other = if model == "brown" { "fisheye" } else { "brown" };
        assert!(!same(&read, &plain(other)), "{key}");
        let error = opencv(&text(key, &k), &format!("{POSE}model = '{other}'"), None).unwrap_err().to_string();
        assert!(error.contains("camera.model") && error.contains(&format!("the file says {key}")), "{error}");
    }
    for (key, expected) in [
        ("distortion_model: fov", "distortion_model: \"fov\" is not known"),
        ("distortion_model: equidistant\nfisheye_model: 0", "contradict each other"),
    ] {
        let error = opencv(&text(key, &k), POSE, None).unwrap_err();
        assert!(error.exit_code() == 2 && error.to_string().contains(expected), "{error}");
    }
    let error = opencv(&text("distortion_model: equidistant", &[0.1; 5]), POSE, None).unwrap_err().to_string();
    assert!(error.contains("the fisheye model has 4"), "{error}");
}

/// Sharpless's forward formula, equations 1 and 2 with the vertical compression.
fn panini_place(d: f64, s: f64, lon: f64, lat: f64) -> DVec2 {
    let stretch = (d + 1.0) / (d + lon.cos());
    DVec2::new(stretch * lon.sin(), lat.tan() * ((1.0 - s) * stretch + s / lon.cos()))
}

#[test]
fn every_ray_of_panini_is_seen_at_its_pixel() {
    for (fov, d, s) in [
        (90.0, 0.0, 0.0),
        (150.0, 1.0, 0.0),
        (170.0, 1.0, 1.0),
        (300.0, 1.0, 0.0),
        (200.0, 3.0, 0.0),
        (120.0, 0.5, 0.4),
    ] {
        let camera = camera(&format!("{POSE}kind = 'panini'\nfov = {fov}\nd = {d}\ns = {s}"), (64, 48));
        let half = panini_place(d, s, f64::to_radians(fov / 2.0), 0.0).x;
        for (i, j) in all_pixels(&camera) {
            let v = camera.ray(i, j).unwrap().direction;
            let across = v.x.hypot(v.z);
            // the horizontal part is a unit vector: t is the distance from the axis
            assert!((across - 1.0).abs() < 1e-13, "{across}");
            let seen = panini_place(d, s, v.x.atan2(-v.z), v.y.atan2(across)) / half * 32.0;
            let expected = DVec2::new(f64::from(i) + 0.5 - 32.0, 24.0 - f64::from(j) - 0.5);
            // the stretch of the picture over the angle, up to 60 at the border of 300 degrees, times its rounding
            assert!((seen - expected).length() < 1e-11, "{fov} {d} {s}: {i},{j} at {seen}, not {expected}");
        }
    }
}

#[test]
fn panini_with_d_0_is_a_pinhole() {
    let flat = camera(&format!("{POSE}kind = 'panini'\nfov = 90\nd = 0"), (40, 30));
    let vfov = 2.0 * 0.75_f64.atan().to_degrees();
    let pinhole = camera(&format!("{POSE}kind = 'pinhole'\nvfov = {vfov}"), (40, 30));
    for (i, j) in all_pixels(&flat) {
        let (a, b) = (flat.ray(i, j).unwrap().direction, pinhole.ray(i, j).unwrap().direction);
        assert!((a.normalize() - b.normalize()).length() < 1e-14);
    }
}

#[test]
fn wrong_panini_values_name_their_keys() {
    for (keys, expected) in [
        ("fov = 180\nd = 0", "camera.fov: 180 degrees"),
        ("fov = 180\ns = 0.1", "camera.fov: 180 degrees"),
        ("fov = 360", "camera.fov"),
        ("fov = 100\nd = -1", "camera.d"),
        ("fov = 100\ns = 1.5", "camera.s"),
    ] {
        assert_refused(&format!("{POSE}kind = 'panini'\n{keys}"), expected);
    }
}
