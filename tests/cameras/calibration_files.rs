//! Calibration files as programs and data sets write them: each ray is seen at its pixel by the formula of the writer's own code.

use crate::calibrated::{POSE, brown, count, equidistant, in_camera_frame, in_file};
use crate::common::written::camera_in;
use glam::{DMat3, DVec2, DVec3};

/// A file of 96 x 64 pixels, and the writer's projection to its pixels, whose first has its centre at (0, 0).
struct Case {
    name: &'static str,
    file: &'static str,
    text: String,
    keys: &'static str,
    project: fn(DVec3) -> DVec2,
    /// Rays behind the eye are expected.
    is_wide: bool,
}

const NARROW: Case =
    Case { name: "", file: "cam.yaml", text: String::new(), keys: "", project: |_| DVec2::ZERO, is_wide: false };
const WIDE: Case =
    Case { name: "", file: "cam.yaml", text: String::new(), keys: "", project: |_| DVec2::ZERO, is_wide: true };

const K: [f64; 4] = [0.02, -0.003, 2e-4, -1e-5];
const BROWN: ([f64; 2], [f64; 2]) = ([-0.05, 0.01], [1e-3, -2e-3]);

fn flat(d: DVec3) -> DVec2 {
    d.truncate() / d.z
}

fn to_pixel(focal: [f64; 2], centre: [f64; 2], p: DVec2) -> DVec2 {
    DVec2::from(focal) * p + DVec2::from(centre)
}

fn radtan(d: DVec3) -> DVec2 {
    to_pixel([60.0, 58.0], [47.5, 31.0], brown(flat(d), &BROWN.0, BROWN.1))
}

fn kannala_brandt(d: DVec3) -> DVec2 {
    to_pixel([30.0, 29.0], [47.5, 31.0], brown(equidistant(d), &K, [0.0; 2]))
}

/// Rational distortion, and k3 of the numerator.
fn rational(d: DVec3) -> DVec2 {
    let (p, r2) = (flat(d), flat(d).length_squared());
    let radial = (1.0 + r2 * (-0.05 + r2 * (0.01 + r2 * 0.002))) / (1.0 + r2 * (0.03 + r2 * (0.004 - r2 * 0.001)));
    to_pixel([60.0, 58.0], [47.5, 31.0], p * radial + brown(p, &[], BROWN.1) - p)
}

fn eucm(d: DVec3, alpha: f64, beta: f64) -> DVec2 {
    let rho = (beta * d.truncate().length_squared() + d.z * d.z).sqrt();
    to_pixel([30.0, 29.0], [47.5, 31.0], d.truncate() / (alpha * rho + (1.0 - alpha) * d.z))
}

fn double_sphere(d: DVec3) -> DVec2 {
    let z = -0.2 * d.length() + d.z;
    to_pixel([20.0, 19.0], [47.5, 31.0], d.truncate() / (0.6 * d.truncate().length().hypot(z) + 0.4 * z))
}

fn check(cases: &[Case]) {
    for Case { name, file, text, keys, project, is_wide } in cases {
        let keys = if keys.contains("image") { (*keys).into() } else { format!("{keys}\n{POSE}") };
        let camera = in_file(file, text, &keys).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert_eq!((camera.width, camera.height), (96, 64), "{name}");
        let [seen, behind] = count(&camera, name, project);
        assert!(seen > 3000 && (!is_wide || behind > 20), "{name}: {seen} rays, {behind} behind");
    }
}

const MATRIX: &str = "[60, 0, 47.5, 0, 58, 31, 0, 0, 1]";
const RADTAN: &str = "-0.05, 0.01, 0.001, -0.002";

/// OpenCV's YAML with other spellings of its keys.
fn opencv(size: &str, matrix: &str, coefficients: &str, k: &str) -> String {
    format!(
        "%YAML:1.0\n---\n{size}{matrix}: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: {MATRIX}\n\
         {coefficients}: !!opencv-matrix\n   rows: {}\n   cols: 1\n   dt: d\n   data: [ {k} ]\n",
        k.split(',').count()
    )
}

#[test]
fn files_of_opencv_and_ros_are_read_in_all_spellings() {
    let tutorial = opencv(
        "image_Width: 96\nimage_Height: 64\n",
        "Camera_Matrix",
        "Distortion_Coefficients",
        &format!("{RADTAN}, 0"),
    );
    let kinect = opencv(
        "img_size: !!opencv-matrix\n   rows: 2\n   cols: 1\n   dt: i\n   data: [ 96, 64 ]\n",
        "K",
        "dist",
        &format!("{RADTAN}, 0., 0., 0., 0."),
    );
    let ros_1 = format!(
        "header: \n  seq: 4\n  stamp: \n    secs: 1\n    nsecs: 2\n  frame_id: \"cam\"\nheight: 64\nwidth: 96\n\
         distortion_model: \"plumb_bob\"\nD: [{RADTAN}, 0.0]\nK: {MATRIX}\nR: [1.0, 0.0]\nP: [1.0]\nbinning_x: 0\nbinning_y: 0\n\
         roi: \n  x_offset: 0\n  height: 0\n  do_rectify: False\n---\nheader: \n  seq: 5\n---\n"
    );
    let listed = |list: &str| list.trim_matches(['[', ']']).replace(", ", "\n- ");
    let ros_2 = |model: &str, k: &str, matrix: &str| {
        format!(
            "height: 64\nwidth: 96\ndistortion_model: {model}\nd:\n- {}\nk:\n- {}\nr: []\np: []\n---\n",
            listed(k),
            listed(matrix)
        )
    };
    let plain = |rest: &str| {
        format!("image_width: 96.0\nimage_height: 64\ncamera_matrix: {{rows: 3, cols: 3, data: {MATRIX}}}\n{rest}")
    };
    let ini = format!(
        "# a comment\n\n[image]\n\nwidth\n96\n\nheight\n64\n\n[left]\n\ncamera matrix\n60 0 47.5\n0 58 31\n0 0 1\n\ndistortion\n{} 0\n\n\
         rectification\n1 0 0\n0 1 0\n0 0 1\n",
        RADTAN.replace(',', "")
    );
    let undistorted = |d: DVec3| to_pixel([60.0, 58.0], [47.5, 31.0], flat(d));
    check(&[
        Case { name: "OpenCV's tutorial", text: tutorial, project: radtan, ..NARROW },
        Case { name: "OpenCV's Kinect sample", text: kinect, project: radtan, ..NARROW },
        Case { name: "ROS 1's message", text: ros_1, project: radtan, ..NARROW },
        Case { name: "ROS 2's message", text: ros_2("plumb_bob", RADTAN, MATRIX), project: radtan, ..NARROW },
        Case {
            name: "ROS 2's rational model",
            text: ros_2("rational_polynomial", &format!("{RADTAN}, 0.002, 0.03, 0.004, -0.001"), MATRIX),
            project: rational,
            ..NARROW
        },
        Case {
            name: "ROS 2's fisheye",
            text: ros_2("equidistant", "0.02, -0.003, 2e-4, -1e-5, 0.0", "[30, 0, 47.5, 0, 29, 31, 0, 0, 1]"),
            project: kannala_brandt,
            ..WIDE
        },
        Case {
            name: "Gazebo's empty model",
            text: plain("distortion_model: ''\ndistortion_coefficients: {rows: 0, cols: 0, data: []}\n"),
            project: undistorted,
            ..NARROW
        },
        Case {
            name: "no model",
            text: plain("distortion_model: none\ndistortion_coefficients: {rows: 1, cols: 5, data: [0, 0, 0, 0, 0]}\n"),
            project: undistorted,
            ..NARROW
        },
        Case { name: "ROS's .ini", file: "cam.ini", text: ini.clone(), project: radtan, ..NARROW },
        Case {
            name: "ROS's .ini without a comment",
            text: ini.trim_start_matches("# a comment\n\n").into(),
            project: radtan,
            ..NARROW
        },
    ]);
    let cut = ros_2("plumb_bob", RADTAN, MATRIX).replace("---", "binning_x: 2\n---");
    let camera = in_file("cam.yaml", &cut, POSE).unwrap();
    assert!(camera.unfulfilled.iter().any(|note| note.contains("binning and roi")), "{:?}", camera.unfulfilled);
}

#[test]
fn yaml_of_kalibr_euroc_svo_and_vikit_is_read() {
    let chain = "%YAML:1.0 # for OpenCV\n\ncam0:\n  T_cam_imu:\n  - [1.0, 0.0, 0.0, 0.0]\n  cam_overlaps: []\n  camera_model: pinhole\n  \
                 distortion_coeffs: [-0.05, 0.01, 0.001, -0.002]\n  distortion_model: radtan\n  intrinsics: [60, 58, 47.5, 31]\n  resolution: [96.0, 64]\n";
    let euroc = format!(
        "%YAML:1.0\n# General sensor definitions.\nsensor_type: camera\nT_BS:\n  cols: 4\n  rows: 4\n  data: [1, 0]\nrate_hz: 20\n\
         resolution: [96, 64]\ncamera_model: pinhole\nintrinsics: [60, 58, 47.5, 31] #fu, fv, cu, cv\n\
         distortion_model: radial-tangential\ndistortion_coefficients: [{RADTAN}]\n"
    );
    let wide = euroc
        .replace("60, 58", "30, 29")
        .replace("radial-tangential", "equidistant")
        .replace(RADTAN, "0.02, -0.003, 2e-4, -1e-5");
    let svo = |kind: &str, intrinsics: &str, k: &str| {
        format!(
            "label: rig\ncameras:\n- camera:\n    image_height: 64\n    image_width: 96\n    type: pinhole\n    intrinsics:\n      cols: 1\n      rows: 4\n      \
             data: [{intrinsics}]\n    distortion:\n      type: {kind}\n      parameters:\n        cols: 1\n        rows: 4\n        data: [{k}]\n  T_B_C:\n    data: [1]\n"
        )
    };
    let vikit = |model: &str, numbers: [&str; 4], k: &[&str]| {
        let [fx, fy, cx, cy] = numbers;
        let k: String = k.iter().enumerate().map(|(n, k)| format!("  cam_d{n}: {k}\n")).collect();
        format!(
            "cam0:\n  cam_model: {model}\n  cam_width: 96\n  cam_height: 64\n  cam_fx: {fx}\n  cam_fy: {fy}\n  cam_cx: {cx}\n  cam_cy: {cy}\n{k}"
        )
    };
    check(&[
        Case { name: "Kalibr for OpenVINS", text: chain.into(), project: radtan, ..NARROW },
        Case { name: "EuRoC", text: euroc, project: radtan, ..NARROW },
        Case { name: "EuRoC's fisheye", text: wide, project: kannala_brandt, ..WIDE },
        Case { name: "SVO", text: svo("radial-tangential", "60, 58, 47.5, 31", RADTAN), project: radtan, ..NARROW },
        Case {
            name: "SVO's fisheye",
            text: svo("equidistant", "30, 29, 47.5, 31", "0.02, -0.003, 2e-4, -1e-5"),
            project: kannala_brandt,
            ..WIDE
        },
        Case {
            name: "vikit",
            text: vikit("PinholeEquidistant", ["30", "29", "47.5", "31"], &["0.02", "-0.003", "2e-4", "-1e-5"]),
            project: kannala_brandt,
            ..WIDE
        },
        Case {
            name: "vikit's pinhole",
            text: vikit("Pinhole", ["60", "58", "47.5", "31"], &["-0.05", "0.01", "0.001", "-0.002"]),
            project: radtan,
            ..NARROW
        },
        Case {
            // PTAM: fractions of the image, pixel centres at whole numbers
            name: "vikit's ATAN",
            text: vikit("ATAN", ["0.625", "0.90625", "0.5", "0.5"], &["0.9"]),
            project: |d| {
                let r = flat(d).length();
                let ratio = (2.0 * r * 0.45f64.tan()).atan() / (0.9 * r);
                to_pixel([0.625 * 96.0, 0.90625 * 64.0], [0.5 * 96.0 - 0.5, 0.5 * 64.0 - 0.5], flat(d) * ratio)
            },
            ..NARROW
        },
    ]);
}

/// A file of camodocal's with these tables.
fn camodocal(model: &str, tables: &[(&str, &str)]) -> String {
    let tables: String =
        tables.iter().map(|(name, numbers)| format!("{name}:\n   {}\n", numbers.replace(", ", "\n   "))).collect();
    format!("%YAML:1.0\n---\nmodel_type: {model}\ncamera_name: camera\nimage_width: 96\nimage_height: 64\n{tables}")
}

#[test]
fn models_of_camodocal_basalt_and_orb_slam_are_their_formulas() {
    let bent = ("distortion_parameters", "k1: -0.05, k2: 0.01, p1: 0.001, p2: -0.002");
    let basalt = |kind: &str, numbers: &str| {
        format!(
            "{{\"value0\": {{\"T_imu_cam\": [], \"intrinsics\": [{{\"camera_type\": \"{kind}\", \"intrinsics\": {{{numbers}, \"cx\": 47.5, \"cy\": 31}}}}], \
             \"resolution\": [[96, 64]], \"vignette\": []}}}}"
        )
    };
    let orb = |camera: &str, kind: &str, numbers: &[(&str, &str)]| {
        let numbers: String = numbers.iter().map(|(name, x)| format!("{camera}.{name}: {x}\n")).collect();
        format!(
            "%YAML:1.0\n\nFile.version: \"1.0\"\nCamera.type: \"{kind}\"\n{numbers}Camera.width: 96\nCamera.height: 64\nCamera.fps: 20\n"
        )
    };
    let pinhole = [
        ("fx", "60."),
        ("fy", "58."),
        ("cx", "47.5"),
        ("cy", "31."),
        ("k1", "-0.05"),
        ("k2", "0.01"),
        ("p1", "0.001"),
        ("p2", "-0.002"),
    ];
    let fisheye = [
        ("fx", "30."),
        ("fy", "29."),
        ("cx", "47.5"),
        ("cy", "31."),
        ("k1", "0.02"),
        ("k2", "-0.003"),
        ("k3", "2e-4"),
        ("k4", "-1e-5"),
    ];
    let stella = |model: &str, numbers: &str| {
        format!("Camera:\n  name: a\n  setup: monocular\n  model: {model}\n  cols: 96\n  rows: 64\n{numbers}")
    };
    check(&[
        Case {
            name: "camodocal's MEI",
            text: camodocal(
                "MEI",
                &[
                    ("mirror_parameters", "xi: 1.3"),
                    bent,
                    ("projection_parameters", "gamma1: 90, gamma2: 88, u0: 47.5, v0: 31"),
                ],
            ),
            project: |d| {
                to_pixel([90.0, 88.0], [47.5, 31.0], brown(d.truncate() / (d.z + 1.3 * d.length()), &BROWN.0, BROWN.1))
            },
            ..NARROW
        },
        Case {
            name: "camodocal's KANNALA_BRANDT",
            text: camodocal(
                "KANNALA_BRANDT",
                &[(
                    "projection_parameters",
                    "k2: 0.02, k3: -0.003, k4: 2e-4, k5: -1e-5, mu: 30, mv: 29, u0: 47.5, v0: 31",
                )],
            ),
            project: kannala_brandt,
            ..WIDE
        },
        Case {
            name: "camodocal's PINHOLE",
            text: camodocal("PINHOLE", &[bent, ("projection_parameters", "fx: 60, fy: 58, cx: 47.5, cy: 31")]),
            project: radtan,
            ..NARROW
        },
        Case {
            name: "camodocal's PINHOLE_FULL",
            text: camodocal(
                "PINHOLE_FULL",
                &[
                    (
                        "distortion_parameters",
                        "k1: -0.05, k2: 0.01, k3: 0.002, k4: 0.03, k5: 0.004, k6: -0.001, p1: 0.001, p2: -0.002",
                    ),
                    ("projection_parameters", "fx: 60, fy: 58, cx: 47.5, cy: 31"),
                ],
            ),
            project: rational,
            ..NARROW
        },
        Case {
            name: "Basalt's ds",
            file: "calib.json",
            text: basalt("ds", "\"fx\": 20, \"fy\": 19, \"xi\": -0.2, \"alpha\": 0.6"),
            project: double_sphere,
            ..WIDE
        },
        Case {
            name: "Basalt's eucm",
            text: basalt("eucm", "\"fx\": 30, \"fy\": 29, \"alpha\": 0.6, \"beta\": 1.1"),
            project: |d| eucm(d, 0.6, 1.1),
            ..WIDE
        },
        Case {
            name: "Basalt's ucm",
            text: basalt("ucm", "\"fx\": 30, \"fy\": 29, \"alpha\": 0.6"),
            project: |d| eucm(d, 0.6, 1.0),
            ..WIDE
        },
        Case {
            name: "Basalt's kb4",
            text: basalt("kb4", "\"fx\": 30, \"fy\": 29, \"k1\": 0.02, \"k2\": -0.003, \"k3\": 2e-4, \"k4\": -1e-5"),
            project: kannala_brandt,
            ..WIDE
        },
        Case { name: "ORB-SLAM3", text: orb("Camera1", "PinHole", &pinhole), project: radtan, ..NARROW },
        Case {
            name: "ORB-SLAM2",
            text: orb("Camera", "PinHole", &pinhole).replace("Camera.type: \"PinHole\"\n", ""),
            project: radtan,
            ..NARROW
        },
        Case {
            name: "ORB-SLAM3's fisheye",
            text: orb("Camera", "KannalaBrandt8", &fisheye),
            project: kannala_brandt,
            ..WIDE
        },
        Case {
            name: "stella_vslam's fisheye",
            text: stella(
                "fisheye",
                "  fx: 30\n  fy: 29\n  cx: 47.5\n  cy: 31\n  k1: 0.02\n  k2: -0.003\n  k3: 2e-4\n  k4: -1e-5\n",
            ),
            project: kannala_brandt,
            ..WIDE
        },
        Case {
            // stella_vslam: x = cols (0.5 + longitude / 2 pi), y = rows (0.5 - latitude / pi), latitude upward
            name: "stella_vslam's panorama",
            text: stella("equirectangular", ""),
            project: |d| {
                let (longitude, latitude) = (d.x.atan2(d.z), -d.y.atan2(d.x.hypot(d.z)));
                // the first column looks straight back, which is both ends of the turn
                let longitude = if longitude > std::f64::consts::PI - 1e-9 { -longitude } else { longitude };
                DVec2::new(
                    96.0 * (0.5 + longitude / std::f64::consts::TAU),
                    64.0 * (0.5 - latitude / std::f64::consts::PI),
                )
            },
            ..WIDE
        },
    ]);
}

/// A `transforms.json` with a frame without keys of its own, and one that has all.
fn transforms(keys: &str) -> String {
    let matrix = "[[0, 0, -1, 1], [0, 1, 0, 2], [1, 0, 0, 3], [0, 0, 0, 1]]";
    format!(
        "{{\"w\": 96.0, \"h\": 64, {keys}, \"frames\": [{{\"file_path\": \"a.png\", \"transform_matrix\": {matrix}}}, \
         {{\"file_path\": \"b.png\", \"fl_x\": 40, \"cx\": 40, \"transform_matrix\": {matrix}}}]}}"
    )
}

#[test]
fn lenses_of_transforms_json_are_those_of_nerfstudio() {
    let numbers = "\"fl_x\": 60, \"fl_y\": 58, \"cx\": 48, \"cy\": 31.5, \"k1\": -0.05, \"k2\": 0.01, \"p1\": 0.001, \"p2\": -0.002";
    let wide = "\"fl_x\": 30, \"fl_y\": 29, \"cx\": 48, \"cy\": 31.5, \"k1\": 0.02, \"k2\": -0.003, \"k3\": 2e-4, \"k4\": -1e-5";
    let six = "\"distortion_params\": [0.02, -0.003, 2e-4, -1e-5, 1e-6, 1e-7, 0.001, -0.002, 0.001, 2e-4, -5e-4, 1e-4]";
    let file = "transforms.json";
    let case = |name, keys: String, project, is_wide| Case {
        name,
        file,
        text: transforms(&keys),
        keys: "index = 0",
        project,
        is_wide,
    };
    check(&[
        case("no model", numbers.into(), radtan, false),
        case(
            "OPENCV with k3 and k4",
            format!("\"camera_model\": \"OPENCV\", \"k3\": 0.002, \"k4\": -0.001, {numbers}"),
            |d| to_pixel([60.0, 58.0], [47.5, 31.0], brown(flat(d), &[-0.05, 0.01, 0.002, -0.001], BROWN.1)),
            false,
        ),
        case("OPENCV_FISHEYE", format!("\"camera_model\": \"OPENCV_FISHEYE\", {wide}"), kannala_brandt, true),
        case("instant-ngp's fisheye", format!("\"is_fisheye\": true, {wide}"), kannala_brandt, true),
        case(
            // Project Aria: tangential and prism terms of the point that the radial terms have moved, p0 with x
            "FISHEYE624",
            format!("\"camera_model\": \"FISHEYE624\", \"fl_x\": 30, \"fl_y\": 29, \"cx\": 48, \"cy\": 31.5, {six}"),
            |d| {
                let p = brown(equidistant(d), &[0.02, -0.003, 2e-4, -1e-5, 1e-6, 1e-7], [0.0; 2]);
                let (r2, [p0, p1]) = (p.length_squared(), [0.001, -0.002]);
                let bent = p * (2.0 * (p.x * p0 + p.y * p1)) + r2 * DVec2::new(p0, p1);
                let prism = DVec2::new(0.001 * r2 + 2e-4 * r2 * r2, -5e-4 * r2 + 1e-4 * r2 * r2);
                to_pixel([30.0, 29.0], [47.5, 31.0], p + bent + prism)
            },
            true,
        ),
        case(
            // nerfstudio: pi times the place, over the focal lengths
            "EQUIRECTANGULAR",
            "\"camera_model\": \"EQUIRECTANGULAR\", \"fl_x\": 48, \"fl_y\": 64".into(),
            |d| {
                let (longitude, latitude) = (d.x.atan2(d.z), d.y.atan2(d.x.hypot(d.z)));
                DVec2::new(longitude * 48.0, latitude * 64.0) / std::f64::consts::PI + DVec2::new(47.5, 31.5)
            },
            true,
        ),
        case(
            "a field of view",
            "\"camera_angle_x\": 1.2".into(),
            |d| to_pixel([48.0 / 0.6f64.tan(); 2], [47.5, 31.5], flat(d)),
            false,
        ),
    ]);
    // with an image, its pose and its own numbers: OpenGL's camera looks along -z
    let camera = in_file(file, &transforms(numbers), "image = 'b.png'").unwrap();
    let ray = camera.ray(0, 0).unwrap();
    assert_eq!(ray.origin, DVec3::new(1.0, 2.0, 3.0));
    let to_world = DMat3::from_cols(DVec3::Z, DVec3::Y, DVec3::NEG_X);
    let [seen, _] =
        count_in(&camera, to_world, |d| to_pixel([40.0, 58.0], [39.5, 31.0], brown(flat(d), &BROWN.0, BROWN.1)));
    assert_eq!(seen, 96 * 64);
    for (keys, says) in [
        (POSE, "has cameras 0, 1; choose one: index = 0, or an image: image = \"a.png\""),
        ("image = 'c.png'", "has no image \"c.png\"; its images are \"a.png\", \"b.png\""),
        ("index = 7\neye = [0, 0, 0]\ntarget = [0, 0, 1]", "has no camera of this index; it has 0, 1"),
    ] {
        let error = in_file(file, &transforms(numbers), keys).unwrap_err().to_string();
        assert!(error.contains(says) && !error.contains('\n'), "{error}");
    }
    let error = in_file(file, &transforms("\"camera_model\": \"VR180_L\", \"fl_x\": 1"), &format!("index = 0\n{POSE}"))
        .unwrap_err();
    assert!(error.to_string().contains("camera_model: \"VR180_L\" is not read as a lens; use ods"), "{error}");
}

/// As [`count`], for a camera whose axes (x right, y up, z backward) `to_world` takes to the world.
fn count_in(
    camera: &anamorph::internals::camera::Camera,
    to_world: DMat3,
    project: impl Fn(DVec3) -> DVec2,
) -> [usize; 2] {
    // the camera of `count` has the world's axes
    let back = to_world.transpose();
    let mut counts = [0, 0];
    for (i, j) in (0..camera.height).flat_map(|j| (0..camera.width).map(move |i| (i, j))) {
        let Some(ray) = camera.ray(i, j) else { continue };
        let d = in_camera_frame(back * ray.direction);
        let off = project(d) - DVec2::new(i.into(), j.into());
        // the rotation rounds directions by some 2^-52, which a focal length of 60 px makes 2^-46; doubled ten times for the formula
        assert!(off.length() <= 1.0 / (1u64 << 36) as f64, "pixel {i},{j} of {d} is projected {off} off");
        counts = [counts[0] + 1, counts[1] + usize::from(d.z < 0.0)];
    }
    counts
}

/// The direction that OCamCalib's `cam2world` has for a pixel, as (row, column) down and right.
fn cam2world(heights: &[f64], [c, d, e]: [f64; 3], [row, column]: [f64; 2], (i, j): (u32, u32)) -> DVec3 {
    let inverse = 1.0 / (c - d * e);
    let (down, right) = (f64::from(j) - row, f64::from(i) - column);
    let (x, y) = (inverse * (down - d * right), inverse * (-e * down + c * right));
    let r = x.hypot(y);
    let z = heights.iter().rev().fold(0.0, |sum, a| sum * r + a);
    // its z points from the scene to the camera
    DVec3::new(y, x, -z).normalize()
}

#[test]
fn scaramuzzas_model_is_that_of_ocamcalib_and_camodocal() {
    let heights = [-32.0, 0.0, 1.2e-2, 2e-5, 1e-7];
    let affine = [1.01, 0.02, -0.01];
    let ocam = "#polynomial coefficients for the DIRECT mapping function (ocam_model.ss in MATLAB). These are used by cam2world\n\n\
                5 -32.0 0.0 1.2e-2 2e-5 1e-7\n\n#polynomial coefficients for the inverse mapping function\n\n3 50 20 1\n\n\
                #center: \"row\" and \"column\", starting from 0 (C convention)\n\n31.25 47.5\n\n#affine parameters \"c\", \"d\", \"e\"\n\n\
                1.01 0.02 -0.01\n\n#image size: \"height\" and \"width\"\n\n64 96\n";
    let camera = in_file("calib_results.txt", ocam, POSE).unwrap();
    let mut behind = 0;
    for (i, j) in (0..64).flat_map(|j| (0..96).map(move |i| (i, j))) {
        let expected = cam2world(&heights, affine, [31.25, 47.5], (i, j));
        let found = in_camera_frame(camera.ray(i, j).unwrap().direction);
        behind += u32::from(found.z < 0.0);
        // some roundings of the direction's components
        assert!((found - expected).length() < 16.0 * f64::EPSILON, "{i},{j}: {found}, not {expected}");
    }
    assert!(behind > 50, "{behind}");
    // camodocal's affine part takes x before y, and has the same heights
    let text = camodocal(
        "SCARAMUZZA",
        &[
            ("poly_parameters", "p0: -32, p1: 0, p2: 1.2e-2, p3: 2e-5, p4: 1e-7"),
            ("affine_parameters", "ac: 1.01, ad: 0.02, ae: -0.01, cx: 47.5, cy: 31.25"),
        ],
    );
    let camera = in_file("cam.yaml", &text, POSE).unwrap();
    for (i, j) in [(0, 0), (50, 20), (95, 63)] {
        let expected = cam2world(&heights, affine, [47.5, 31.25], (j, i));
        let found = in_camera_frame(camera.ray(i, j).unwrap().direction);
        assert!((found - DVec3::new(expected.y, expected.x, expected.z)).length() < 16.0 * f64::EPSILON, "{i},{j}");
    }
}

#[test]
fn polynomials_of_woodscape_ncore_and_profiles_of_gyroflow_are_read() {
    let woodscape = "{\"extrinsic\": {}, \"intrinsic\": {\"aspect_ratio\": 1.02, \"cx_offset\": 1.5, \"cy_offset\": -0.75, \"height\": 64.0, \
                     \"k1\": 30.0, \"k2\": 1.0, \"k3\": -0.5, \"k4\": 0.1, \"model\": \"radial_poly\", \"poly_order\": 4, \"width\": 96.0}, \"name\": \"FV\"}";
    let ncore = |kind: &str, rest: &str| {
        format!(
            "{{\"a@b\": {{\"camera_model_type\": \"{kind}\", \"resolution\": [96, 64], \"shutter_type\": 1, \"intrinsics\": {{{rest}}}}}}}"
        )
    };
    let both = "\"principal_point\": [47.5, 31], \"pixeldist_to_angle_poly\": [0, 0.03], \"angle_to_pixeldist_poly\": [0, 30, 1], \"linear_cde\": [1.01, 0.02, -0.01]";
    let gyroflow = |rest: &str| {
        format!(
            "{{\"calib_dimension\": {{\"w\": 96, \"h\": 64}}, {rest}, \"fisheye_params\": {{\"camera_matrix\": [[30, 0, 40], [0, 29, 30], [0, 0, 1]], \
             \"distortion_coeffs\": [0.02, -0.003, 2e-4, -1e-5]}}}}"
        )
    };
    check(&[
        Case {
            name: "WoodScape",
            file: "front.json",
            text: woodscape.into(),
            project: |d| {
                let (chi, theta) = (d.truncate().length(), d.truncate().length().atan2(d.z));
                let rho = theta * (30.0 + theta * (1.0 + theta * (-0.5 + theta * 0.1)));
                let u = d.truncate() * rho / chi;
                DVec2::new(u.x, u.y * 1.02) + DVec2::new(48.0 + 1.5 - 0.5, 32.0 - 0.75 - 0.5)
            },
            ..WIDE
        },
        Case {
            name: "ncore from angles",
            text: ncore("ftheta", &format!("\"reference_poly\": 2, {both}")),
            project: |d| {
                let p = equidistant(d);
                let p = p * (30.0 + p.length());
                DVec2::new(1.01 * p.x + 0.02 * p.y, -0.01 * p.x + p.y) + DVec2::new(47.5, 31.0)
            },
            ..WIDE
        },
        Case {
            name: "ncore to angles",
            text: ncore("ftheta", &format!("\"reference_poly\": \"PIXELDIST_TO_ANGLE\", {both}")),
            project: |d| {
                let p = equidistant(d) / 0.03;
                DVec2::new(1.01 * p.x + 0.02 * p.y, -0.01 * p.x + p.y) + DVec2::new(47.5, 31.0)
            },
            ..WIDE
        },
        Case {
            // its pinhole's first pixel is centred at (0.5, 0.5)
            name: "ncore's pinhole",
            text: ncore(
                "opencv-pinhole",
                "\"principal_point\": [48, 31.5], \"focal_length\": [60, 58], \"radial_coeffs\": [-0.05, 0.01, 0.002, 0.03, 0.004, -0.001], \
                 \"tangential_coeffs\": [0.001, -0.002], \"thin_prism_coeffs\": [0, 0, 0, 0]",
            ),
            project: rational,
            ..NARROW
        },
        Case {
            name: "ncore's fisheye",
            text: ncore(
                "opencv-fisheye",
                "\"principal_point\": [48, 31.5], \"focal_length\": [30, 29], \"radial_coeffs\": [0.02, -0.003, 2e-4, -1e-5]",
            ),
            project: kannala_brandt,
            ..WIDE
        },
        Case {
            name: "gyroflow",
            file: "lens.json",
            text: gyroflow("\"asymmetrical\": true"),
            project: |d| to_pixel([30.0, 29.0], [40.0, 30.0], brown(equidistant(d), &K, [0.0; 2])),
            ..WIDE
        },
        Case {
            name: "gyroflow's symmetrical lens",
            text: gyroflow("\"crop\": 1.5"),
            project: |d| to_pixel([20.0, 29.0 / 1.5], [48.0, 32.0], brown(equidistant(d), &K, [0.0; 2])),
            ..WIDE
        },
    ]);
}

/// A model of OpenSfM's with an image that looks along the world's x.
fn opensfm(kind: &str, numbers: &str) -> String {
    format!(
        "[{{\"cameras\": {{\"v2 a 96 64\": {{\"projection_type\": \"{kind}\", \"width\": 96, \"height\": 64, {numbers}}}}}, \"shots\": {{\"a.jpg\": \
         {{\"rotation\": [0, -1.5707963267948966, 0], \"translation\": [0, 0, 2], \"camera\": \"v2 a 96 64\"}}}}}}]"
    )
}

#[test]
fn cameras_of_photogrammetry_are_read() {
    let six = "\"k1\": 0.02, \"k2\": -0.003, \"k3\": 2e-4, \"k4\": -1e-5, \"k5\": 1e-6, \"k6\": 1e-7, \"p1\": 0.001, \"p2\": -0.002";
    let metashape = |kind: &str, numbers: &[(&str, &str)]| {
        let numbers: String = numbers.iter().map(|(name, x)| format!("<{name}>{x}</{name}>")).collect();
        format!(
            "<?xml version=\"1.0\"?><document version=\"1.5.0\"><chunk><sensors><sensor id=\"3\" label=\"a\" type=\"{kind}\"><resolution width=\"96\" height=\"64\"/>\
             <calibration type=\"{kind}\" class=\"initial\"><f>1</f></calibration><calibration type=\"{kind}\" class=\"adjusted\">{numbers}</calibration></sensor></sensors>\
             <cameras><camera id=\"0\" sensor_id=\"3\" label=\"a\"><transform>0 0 1 2 0 1 0 0 -1 0 0 0 0 0 0 1</transform></camera><camera id=\"1\" sensor_id=\"3\" label=\"b\"/>\
             </cameras></chunk></document>"
        )
    };
    let numbers = [
        ("f", "60"),
        ("cx", "-0.5"),
        ("cy", "-0.75"),
        ("k1", "-0.05"),
        ("k2", "0.01"),
        ("k4", "0.001"),
        ("p1", "-0.002"),
        ("p2", "0.001"),
        ("b1", "1.5"),
        ("b2", "0.25"),
    ];
    // Agisoft's manual: p1 with r^2 + 2 x^2, k4 of r^8
    fn agisoft(p: DVec2) -> DVec2 {
        let (x, y, r2) = (p.x, p.y, p.length_squared());
        let radial = 1.0 - 0.05 * r2 + 0.01 * r2 * r2 + 0.001 * r2.powi(4);
        let (p1, p2) = (-0.002, 0.001);
        let u = x * radial + (p1 * (r2 + 2.0 * x * x) + 2.0 * p2 * x * y);
        let v = y * radial + (p2 * (r2 + 2.0 * y * y) + 2.0 * p1 * x * y);
        DVec2::new(48.0 - 0.5 + u * 60.0 + u * 1.5 + v * 0.25, 32.0 - 0.75 + v * 60.0) - 0.5
    }
    let alicevision = |kind: &str, k: &str| {
        format!(
            "{{\"version\": [\"1\", \"2\", \"11\"], \"views\": [{{\"viewId\": \"1\", \"poseId\": \"1\", \"intrinsicId\": \"7\", \"path\": \"a.jpg\"}}], \
             \"intrinsics\": [{{\"intrinsicId\": \"7\", \"width\": \"96\", \"height\": \"64\", \"sensorWidth\": \"36\", \"sensorHeight\": \"24\", \"type\": \"{kind}\", \
             \"focalLength\": \"22.5\", \"principalPoint\": [\"0.5\", \"-0.25\"], \"distortionParams\": [{k}]}}], \"poses\": [{{\"poseId\": \"1\", \"pose\": {{\"transform\": \
             {{\"rotation\": [\"0\", \"0\", \"1\", \"0\", \"1\", \"0\", \"-1\", \"0\", \"0\"], \"center\": [\"2\", \"0\", \"0\"]}}}}}}]}}"
        )
    };
    check(&[
        Case {
            name: "OpenSfM's perspective",
            file: "reconstruction.json",
            text: opensfm("perspective", "\"focal\": 0.625, \"k1\": -0.05, \"k2\": 0.01"),
            project: |d| to_pixel([60.0; 2], [47.5, 31.5], brown(flat(d), &BROWN.0, [0.0; 2])),
            ..NARROW
        },
        Case {
            name: "OpenSfM's brown",
            text: opensfm(
                "brown",
                "\"focal_x\": 0.625, \"focal_y\": 0.6, \"c_x\": 0.01, \"c_y\": -0.02, \"k1\": -0.05, \"k2\": 0.01, \"k3\": 0.002, \"p1\": 0.001, \"p2\": -0.002",
            ),
            project: |d| {
                to_pixel([60.0, 57.6], [47.5 + 0.96, 31.5 - 1.92], brown(flat(d), &[-0.05, 0.01, 0.002], BROWN.1))
            },
            ..NARROW
        },
        Case {
            name: "OpenSfM's fisheye62",
            text: opensfm(
                "fisheye62",
                &format!("\"focal_x\": 0.3125, \"focal_y\": 0.3, \"c_x\": 0, \"c_y\": 0, {six}"),
            ),
            project: |d| {
                to_pixel(
                    [30.0, 28.8],
                    [47.5, 31.5],
                    brown(equidistant(d), &[0.02, -0.003, 2e-4, -1e-5, 1e-6, 1e-7], BROWN.1),
                )
            },
            ..WIDE
        },
        Case {
            name: "OpenSfM's panorama",
            text: opensfm("spherical", "\"k1\": 0"),
            project: |d| {
                let (longitude, latitude) = (d.x.atan2(d.z), d.y.atan2(d.x.hypot(d.z)));
                DVec2::new(longitude, latitude) * 96.0 / std::f64::consts::TAU + DVec2::new(47.5, 31.5)
            },
            ..WIDE
        },
        Case {
            name: "AliceVision's radial3",
            file: "cameras.sfm",
            text: alicevision("radial3", "\"-0.05\", \"0.01\", \"0.002\""),
            project: |d| to_pixel([60.0; 2], [48.0, 31.25], brown(flat(d), &[-0.05, 0.01, 0.002], [0.0; 2])),
            ..NARROW
        },
        Case {
            name: "AliceVision's fisheye4",
            text: alicevision("fisheye4", "\"0.02\", \"-0.003\", \"0.0002\", \"-0.00001\""),
            project: |d| to_pixel([60.0; 2], [48.0, 31.25], brown(equidistant(d), &K, [0.0; 2])),
            ..NARROW
        },
        Case {
            name: "Metashape",
            file: "cameras.xml",
            text: metashape("frame", &numbers),
            project: |d| agisoft(flat(d)),
            ..NARROW
        },
        Case {
            name: "Metashape's fisheye",
            file: "cameras.xml",
            text: metashape("fisheye", &numbers),
            project: |d| agisoft(equidistant(d)),
            ..NARROW
        },
    ]);
    // each image looks along the world's x from (2, 0, 0) or, for OpenSfM, from -R^T t
    for (file, text, image, eye) in [
        ("a.json", opensfm("perspective", "\"focal\": 0.625"), "a.jpg", DVec3::new(-2.0, 0.0, 0.0)),
        ("a.sfm", alicevision("pinhole", ""), "a.jpg", DVec3::new(2.0, 0.0, 0.0)),
        ("a.xml", metashape("frame", &[("f", "60")]), "a", DVec3::new(2.0, 0.0, 0.0)),
    ] {
        let camera = in_file(file, &text, &format!("image = '{image}'")).unwrap_or_else(|e| panic!("{file}: {e}"));
        let [a, b] = [camera.ray(47, 31).unwrap(), camera.ray(48, 32).unwrap()];
        assert!(a.origin.distance(eye) < 1e-15, "{file}: {}", a.origin);
        // the middle lies within a pixel of both rays, of 1 / 60
        assert!((a.direction + b.direction).normalize().dot(DVec3::X) > 0.999, "{file}: {}", a.direction);
        // y is down in the camera and the world alike: the lower pixel is seen along +y
        assert!(b.direction.y > a.direction.y, "{file}");
    }
}

#[test]
fn kittis_rectified_cameras_are_read() {
    let text = "calib_time: 09-Jan-2012 13:57:47\nS_00: 1.0e+02 7.0e+01\nK_00: 1.0e+00 0 0\nS_rect_00: 9.6e+01 6.4e+01\n\
                P_rect_00: 6.0e+01 0 47.5 0 0 5.8e+01 3.1e+01 0 0 0 1 0\nP_rect_01: 6.0e+01 0 47.5 -20 0 58 31 0 0 0 1 0\nS_rect_01: 96 64\n";
    let project = |d| to_pixel([60.0, 58.0], [47.5, 31.0], flat(d));
    check(&[Case {
        name: "KITTI",
        file: "calib_cam_to_cam.txt",
        text: text.into(),
        keys: "index = 1",
        project,
        ..NARROW
    }]);
}

#[test]
fn files_that_are_known_and_not_read_are_named() {
    for (file, text, says) in [
        (
            "a.txt",
            "P0: 200 0 159 0 0 200 119 0 0 0 1 0\nP2: 1 2\n",
            "not a calibration but KITTI's P0 to P3 without a size",
        ),
        ("a.txt", "# time x y z qx qy qz qw\n1.0 0 0 0 0 0 0 1\n", "not a calibration but a list of poses"),
        ("a.json", "{\"CalibrationInformation\": {}}", "Azure Kinect's raw calibration"),
        ("a.yml", "%YAML:1.0\nM1: 1\nD1: 2\n", "a stereo calibration of OpenCV without a size"),
        ("a.xml", "<lensdatabase/>", "a database of lensfun"),
        ("a.json", "{\"a\": 1}", "not a calibration of a format that is read: COLMAP, "),
        ("a.json", "{\"a\": ", "not a calibration: EOF"),
        ("a.txt", "hello", "not a calibration of a format that is read: COLMAP, "),
        ("a.yaml", "cam0:\n  camera_model: [pinhole\n", "(as YAML: "),
        ("a.xmp", "<x:xmpmeta xmlns:x='adobe:ns:meta/'/>", "an XMP of RealityCapture"),
        ("a.csv", "#name,x,y,alt\na.jpg,1,2,3\n", "a list of RealityCapture's cameras"),
    ] {
        let error = in_file(file, text, POSE).unwrap_err();
        let said = error.to_string();
        assert!(error.exit_code() == 2 && said.contains(says) && !said.contains('\n'), "{text}: {said}");
    }
}

#[test]
fn a_picture_with_pixels_without_rays_says_so() {
    // theta - theta^3 / 12 folds at theta = 2, at 4 / 3 of the focal length
    let text = "image_width: 96\nimage_height: 96\ndistortion_model: fisheye\ncamera_matrix: {rows: 3, cols: 3, data: [30, 0, 47.5, 0, 30, 47.5, 0, 0, 1]}\n\
                distortion_coefficients: {rows: 1, cols: 4, data: [-0.08333333333333333, 0, 0, 0]}\n";
    let camera = in_file("cam.yaml", text, POSE).unwrap();
    let missing = (0..96 * 96).filter(|k| camera.ray(k % 96, k / 96).is_none()).count();
    let share = format!("{:.1} % of the pixels have no ray", 100.0 * missing as f64 / (96.0 * 96.0));
    let note = &camera.unfulfilled[0];
    assert!(
        missing > 3000 && note.starts_with(&share) && note.contains("114.6 degrees from its axis"),
        "{note}, not {share}"
    );
    let whole = text.replace("-0.08333333333333333", "0");
    assert!(in_file("cam.yaml", &whole, POSE).unwrap().unfulfilled.is_empty());
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("cam.yaml"), text).unwrap();
    // the same share in an image of another size
    let small =
        camera_in(folder.path(), &format!("kind = 'calibrated'\nfile = 'cam.yaml'\n{POSE}"), Some((48, 48))).unwrap();
    assert!(small.unfulfilled[0].contains("114.6 degrees"), "{:?}", small.unfulfilled);
}
