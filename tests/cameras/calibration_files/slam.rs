//! Files of SLAM programs: Kalibr, EuRoC, SVO, vikit, camodocal, Basalt, ORB-SLAM and stella_vslam.

use super::*;

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
            name: "vikit's pinhole without distortion",
            text: vikit("PinholeNoDistortion", ["60", "58", "47.5", "31"], &[]),
            project: |d| to_pixel([60.0, 58.0], [47.5, 31.0], flat(d)),
            ..NARROW
        },
        Case {
            name: "vikit's PinholeAtan",
            text: vikit("PinholeAtan", ["60", "58", "47.5", "31"], &["0.9"]),
            project: |d| {
                let r = flat(d).length();
                to_pixel([60.0, 58.0], [47.5, 31.0], flat(d) * ((2.0 * r * 0.45f64.tan()).atan() / (0.9 * r)))
            },
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
