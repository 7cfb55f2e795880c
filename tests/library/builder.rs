//! Cameras from typed values are the cameras of the same keys as text, and so are their errors.

use anamorph::{Camera, CameraBuilder, Result, Scene, Table, Value};
use std::fs;

const SIZE: (u32, u32) = (48, 36);

const TARGET: [f64; 3] = [0.0, 0.25, 0.0];

/// The bits of all rays.
fn ray_bits(camera: &Camera) -> [Vec<[u64; 3]>; 2] {
    camera.rays().map(|vectors| vectors.into_iter().map(|v| v.map(f64::to_bits)).collect())
}

fn pose() -> Table {
    Table::new().key("eye", [0.1, 2.0, 3.0]).key("target", TARGET)
}

fn posed(kind: &str) -> CameraBuilder {
    Camera::builder(kind).key("eye", [0.1, 2.0, 3.0]).key("target", TARGET)
}

#[test]
fn typed_values_make_the_cameras_of_the_same_text() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("cameras.txt"), "1 OPENCV 48 36 40 41 24.5 18 0.1 -0.02 0.001 0.002\n").unwrap();
    let scene = Scene::new();
    let pose_text = "eye = [0.1, 2, 3]\ntarget = [0, 0.25, 0]";
    let pinhole = |vfov: i32| pose().key("kind", "pinhole").key("vfov", vfov);
    let pinhole_text = "{ kind = 'pinhole', eye = [0.1, 2, 3], target = [0, 0.25, 0], vfov = 28 }";
    let region = Table::new().key("kind", "rectangle").key("from", [0, 0]).key("to", [0.55, 1.0]);
    let beams: Vec<f64> = (0..36).map(|row| 20.5 - f64::from(row)).collect();
    let slit = |angle: i64, distance: f32| Table::new().key("angle", angle).key("distance", distance);
    let cases = [
        (posed("pinhole").key("vfov", 40u32), format!("{pose_text}\nvfov = 40")),
        (posed("fisheye").key("fov", 200.5).key("pieces", 64usize), format!("{pose_text}\nfov = 200.5\npieces = 64")),
        (posed("orthographic").key("height", 1.9), format!("{pose_text}\nheight = 1.9")),
        (posed("cylinder").key("tan", &[-1.5, 0.7][..]), format!("{pose_text}\ntan = [-1.5, 0.7]")),
        (posed("calibrated").key("file", String::from("cameras.txt")), format!("{pose_text}\nfile = 'cameras.txt'")),
        (
            Camera::builder("glc")
                .key("near", [[-1.4, 1.4, 2.0], [1.4, 1.4, 2.0], [-1.4, 0.6, 2.0]])
                .key("far", vec![[-0.8, 0.2, -2.0], [0.8, 0.2, -2.0], [-0.8, -2.2, -2.0]])
                .key("t_range", [Value::from(-1), Value::from(f64::INFINITY)]),
            "near = [[-1.4, 1.4, 2], [1.4, 1.4, 2], [-1.4, 0.6, 2]]\nfar = [[-0.8, 0.2, -2], [0.8, 0.2, -2], [-0.8, -2.2, -2]]\n\
             t_range = [-1, inf]"
                .into(),
        ),
        (
            posed("cross_slit").key("height", 1.9).key("slits", [slit(20, 4.0), slit(100, 2.5)]),
            format!("{pose_text}\nheight = 1.9\nslits = [{{ angle = 20, distance = 4 }}, {{ angle = 100, distance = 2.5 }}]"),
        ),
        (
            Camera::builder("mcop")
                .key("path", vec![pose(), pose().key("eye", [1.1, 2.2, 3.0]), pose().key("eye", [1.5, 2.0, 2.0])])
                .key("vfov", 30)
                .key("closed", true)
                .key("interpolation", "catmull-rom"),
            "path = [{ eye = [0.1, 2, 3], target = [0, 0.25, 0] }, { eye = [1.1, 2.2, 3], target = [0, 0.25, 0] },\n\
                     { eye = [1.5, 2, 2], target = [0, 0.25, 0] }]\nvfov = 30\nclosed = true\ninterpolation = 'catmull-rom'"
                .into(),
        ),
        (
            posed("lidar").key("beams", beams.clone()).key("columns", 48u64).key("period", 0.1),
            format!("{pose_text}\nbeams = {beams:?}\ncolumns = 48\nperiod = 0.1"),
        ),
        (
            Camera::builder("reflection")
                .key("eye", pinhole(28))
                .key("mirror", Table::new().key("shape", "sphere").key("center", [0.0; 3]).key("radius", 0.4)),
            format!("eye = {pinhole_text}\nmirror = {{ shape = 'sphere', center = [0, 0, 0], radius = 0.4 }}"),
        ),
        (
            Camera::builder("composite").key(
                "cameras",
                [Table::new().key("region", region).key("camera", pinhole(28)), Table::new().key("camera", pinhole(50))],
            ),
            format!(
                "cameras = [{{ region = {{ kind = 'rectangle', from = [0, 0], to = [0.55, 1] }}, camera = {pinhole_text} }},\n\
                            {{ camera = {} }}]",
                pinhole_text.replace("28", "50")
            ),
        ),
    ];
    for (builder, text) in cases {
        let built = builder.size(SIZE.0, SIZE.1).folder(folder.path()).build(&scene);
        let built = built.unwrap_or_else(|e| panic!("{text}: {e}"));
        let parsed = format!("kind = '{}'\n{text}", built.kind());
        let parsed = Camera::parse(&parsed, folder.path(), &scene, Some(SIZE)).unwrap();
        assert_eq!((built.width(), built.height(), built.piece_count()), (48, 36, parsed.piece_count()), "{text}");
        assert!(built.rays()[0].iter().any(|p| p[0].is_finite()), "{text}");
        assert_eq!(ray_bits(&built), ray_bits(&parsed), "{text}");
    }
}

#[test]
fn a_key_that_is_set_again_has_its_last_value() {
    let scene = Scene::new();
    let pinhole = posed("pinhole").key("vfov", "wide").size(8, 6);
    let again = pinhole.key("vfov", 40).key("kind", "fisheye").key("kind", "pinhole").build(&scene).unwrap();
    let once = posed("pinhole").key("vfov", 40).size(8, 6).build(&scene).unwrap();
    assert_eq!(ray_bits(&again), ray_bits(&once));
}

#[test]
fn typed_values_and_text_fail_with_the_same_errors() {
    let folder = tempfile::tempdir().unwrap();
    let scene = Scene::new();
    let text = "kind = 'fisheye'\neye = [0.1, 2, 3]\ntarget = [0, 0.25, 0]";
    let fisheye = || posed("fisheye");
    let mirror = Table::new().key("shape", "sphere").key("raduis", 1);
    let cases: [(CameraBuilder, String, &str); 9] = [
        (fisheye().key("fvo", 180), format!("{text}\nfvo = 180"), "nearest known key: \"fov\""),
        (fisheye().key("fov", true), format!("{text}\nfov = true"), "camera.fov: expected a finite number, found true"),
        (fisheye().key("fov", f64::NAN), format!("{text}\nfov = nan"), "camera.fov: expected a finite number"),
        (fisheye().key("fov", 400.0), format!("{text}\nfov = 400.0"), "camera.fov"),
        (
            fisheye().key("fov", 180).key("pieces", 8.0),
            format!("{text}\nfov = 180\npieces = 8.0"),
            "camera.pieces: expected",
        ),
        (fisheye().key("fov", [1, 2]), format!("{text}\nfov = [1, 2]"), "camera.fov: expected a finite number"),
        (fisheye().key("kind", "fishey"), text.replace("fisheye", "fishey"), "nearest known: \"fisheye\""),
        (
            Camera::builder("calibrated").key("file", "none.txt").key("eye", [0.0; 3]).key("target", [1.0; 3]),
            "kind = 'calibrated'\nfile = 'none.txt'\neye = [0, 0, 0]\ntarget = [1, 1, 1]".into(),
            "none.txt",
        ),
        (
            Camera::builder("reflection").key("eye", Table::new().key("kind", "pinhole")).key("mirror", mirror),
            "kind = 'reflection'\neye = { kind = 'pinhole' }\nmirror = { shape = 'sphere', raduis = 1 }".into(),
            "camera.",
        ),
    ];
    for (builder, text, says) in cases {
        let [built, parsed]: [Result<Camera>; 2] = [
            builder.size(SIZE.0, SIZE.1).folder(folder.path()).build(&scene),
            Camera::parse(&text, folder.path(), &scene, Some(SIZE)),
        ];
        let error = built.unwrap_err();
        assert!(error.to_string().contains(says) && !error.to_string().contains('\n'), "{error}");
        assert_eq!(error, parsed.unwrap_err());
    }
    // a size is needed, and may be the scene's
    let missing = fisheye().key("fov", 180).build(&scene).unwrap_err();
    assert_eq!(missing, Camera::parse(&format!("{text}\nfov = 180"), "", &scene, None).unwrap_err());
    let sized = "image = { width = 7, height = 5 }\ncamera = { kind = 'pinhole', eye = [0, 0, 1], target = [0, 0, 0], vfov = 40 }";
    let camera = fisheye().key("fov", 180).build(&Scene::parse(sized, ".").unwrap()).unwrap();
    assert_eq!((camera.width(), camera.height()), (7, 5));
}
