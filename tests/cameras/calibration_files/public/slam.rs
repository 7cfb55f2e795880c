//! Public files of camodocal, Basalt, ORB-SLAM and stella_vslam.

use super::*;

/// Kannala and Brandt's model by name, of Basalt, ORB-SLAM3 and stella_vslam.
fn named_fisheye(text: &str, d: DVec3) -> DVec2 {
    plane(named(text, FOCAL), brown(equidistant(d), &named(text, ["k1", "k2", "k3", "k4"]), [0.0; 2]))
}

/// OpenCV's first five coefficients by name.
fn named_pinhole(text: &str, d: DVec3) -> DVec2 {
    plane(named(text, FOCAL), brown(flat(d), &named(text, ["k1", "k2", "k3"]), named(text, ["p1", "p2"])))
}

#[test]
fn public_files_of_camodocal_and_basalt_are_read() {
    let basalt = |origin, size, text, project| Public { file: "calib.json", ..public(origin, size, text, project) };
    check_public(&[
        public(
            "HKUST-Aerial-Robotics/VINS-Fusion: config/mynteye/left_mei.yaml",
            [752.0, 480.0],
            "%YAML:1.0
---
model_type: MEI
camera_name: camera
image_width: 752
image_height: 480
mirror_parameters:
   xi: 1.4456544769803834e+00
distortion_parameters:
   k1: -3.4363053357673362e-01
   k2: 6.2347376791548004e-02
   p1: 1.2608078788285675e-03
   p2: -2.1374139252651483e-04
projection_parameters:
   gamma1: 8.9594371861807986e+02
   gamma2: 8.9741581479032754e+02
   u0: 3.7221680816143993e+02
   v0: 2.3833534175557006e+02
",
            |text, d| {
                let [xi] = named(text, ["xi"]);
                let p = d.truncate() / (d.z + xi * d.length());
                let p = brown(p, &named(text, ["k1", "k2"]), named(text, ["p1", "p2"]));
                plane(named(text, ["gamma1", "gamma2", "u0", "v0"]), p)
            },
        ),
        public(
            "HKUST-Aerial-Robotics/VINS-Fusion: config/realsense_t265/848x800_fisheye/left.yaml",
            [848.0, 800.0],
            "%YAML:1.0
---
model_type: KANNALA_BRANDT
camera_name: camera
image_width: 848
image_height: 800
projection_parameters:
   k2: -0.00703547615557909
   k3: 0.042284730821847916
   k4: -0.03999178111553192
   k5: 0.006651225965470076
   mu: 286.2373962402344
   mv: 286.4901123046875
   u0: 421.489990234375
   v0: 400.760986328125

# model_type: MEI
",
            |text, d| {
                let k = named(text, ["k2", "k3", "k4", "k5"]);
                plane(named(text, ["mu", "mv", "u0", "v0"]), brown(equidistant(d), &k, [0.0; 2]))
            },
        ),
        public(
            "flysoaryun/LF-VIO: config/mindvision/mindvision.yaml",
            [1280.0, 960.0],
            "%YAML:1.0

#camera calibration 
model_type: scaramuzza
camera_name: pal
image_width: 1280
image_height: 960
poly_parameters:
   p0: -2.445239e+02
   p1: 0.000000e+00
   p2: 1.748610e-03
   p3: -1.757770e-06
   p4: 4.475965e-09 
affine_parameters:
   ac: 1.000000
   ad: 0.000000
   ae: 0.000000
   cx: 645.107791
   cy: 486.025172
",
            |text, d| {
                // the affine part is the unit matrix
                let heights = named(text, ["p0", "p1", "p2", "p3", "p4"]);
                scaramuzza(&heights, named(text, ["ac", "ad", "ae"]), named(text, ["cx", "cy"]), d)
            },
        ),
        basalt(
            "VladyslavUsenko/basalt: data/euroc_ds_calib.json",
            [752.0, 480.0],
            r#"{"value0": {"T_imu_cam": [], "intrinsics": [{"camera_type": "ds", "intrinsics": {"fx": 349.7560023050409,
"fy": 348.72454229977037, "cx": 365.89440762590149, "cy": 249.32995565708704, "xi": -0.2409573942178872,
"alpha": 0.566996899163044}}], "resolution": [[752, 480]], "vignette": []}}"#,
            |text, d| {
                let [xi, alpha] = named(text, ["xi", "alpha"]);
                let z = xi * d.length() + d.z;
                let p = d.truncate() / (alpha * d.truncate().length().hypot(z) + (1.0 - alpha) * z);
                plane(named(text, FOCAL), p)
            },
        ),
        basalt(
            "VladyslavUsenko/basalt: data/tumvi_512_eucm_calib.json",
            [512.0, 512.0],
            r#"{"value0": {"T_imu_cam": [], "intrinsics": [{"camera_type": "eucm", "intrinsics": {"fx": 191.14799836282189,
"fy": 191.13150963902818, "cx": 254.9585771534443, "cy": 256.88154645599448, "alpha": 0.6291060881178562,
"beta": 1.0418067381860868}}], "resolution": [[512, 512]], "vignette": []}}"#,
            |text, d| {
                let [alpha, beta] = named(text, ["alpha", "beta"]);
                let rho = (beta * d.truncate().length_squared() + d.z * d.z).sqrt();
                plane(named(text, FOCAL), d.truncate() / (alpha * rho + (1.0 - alpha) * d.z))
            },
        ),
        basalt(
            "VladyslavUsenko/basalt: data/t265_kb4_calib.json",
            [848.0, 800.0],
            r#"{"value0": {"T_imu_cam": [], "intrinsics": [{"camera_type": "kb4", "intrinsics": {"fx": 286.60144163375528,
"fy": 286.4617087423328, "cx": 422.2765876951761, "cy": 395.2246466040553, "k1": -0.006762412326815424,
"k2": 0.045170283325720008, "k3": -0.043515167278210638, "k4": 0.008374959821591333}}], "resolution": [[848, 800]]}}"#,
            named_fisheye,
        ),
    ]);
}

#[test]
fn public_files_of_orb_slam_and_stella_vslam_are_read() {
    check_public(&[
        public(
            "UZ-SLAMLab/ORB_SLAM3: Examples/Monocular/TUM_512.yaml",
            [512.0, 512.0],
            "%YAML:1.0

Camera.type: \"KannalaBrandt8\"
Camera.fx: 190.978477 # 190.97847715128717
Camera.fy: 190.973307 # 190.9733070521226
Camera.cx: 254.931706 # 254.93170605935475
Camera.cy: 256.897442 # 256.8974428996504
Camera.k1: 0.003482389402 # 0.0034823894022493434
Camera.k2: 0.000715034845 # 0.0007150348452162257
Camera.k3: -0.002053236141 # -0.0020532361418706202
Camera.k4: 0.000202936736 # 0.00020293673591811182
Camera.width: 512
Camera.height: 512
",
            named_fisheye,
        ),
        Public {
            keys: "index = 1",
            ..public(
                "UZ-SLAMLab/ORB_SLAM3: Examples/Stereo-Inertial/RealSense_T265.yaml",
                [848.0, 800.0],
                "%YAML:1.0

File.version: \"1.0\"
Camera.type: \"KannalaBrandt8\"
Camera1.fx: 284.9501953125
Camera1.fy: 285.115295410156
Camera1.cx: 420.500213623047
Camera1.cy: 400.738098144531
Camera2.fx: 285.001312255859
Camera2.fy: 284.914215087891
Camera2.cx: 411.864196777344
Camera2.cy: 403.41259765625
Camera2.k1: -0.00375203299336135
Camera2.k2: 0.0379297286272049
Camera2.k3: -0.0352463386952877
Camera2.k4: 0.00548873096704
Camera.width: 848
Camera.height: 800
",
                |text, d| named_fisheye(rest(text, "Camera1.cy:"), d),
            )
        },
        public(
            "shanpenghui/ORB_SLAM3_Fixed: Examples_old/Monocular/TUM1.yaml",
            [640.0, 480.0],
            "%YAML:1.0

Camera.type: \"PinHole\"
Camera.fx: 517.306408
Camera.fy: 516.469215
Camera.cx: 318.643040
Camera.cy: 255.313989

Camera.k1: 0.262383
Camera.k2: -0.953104
Camera.p1: -0.005358
Camera.p2: 0.002628
Camera.k3: 1.163314
Camera.width: 640
Camera.height: 480
Viewer.PointSize:2
Viewer.CameraSize: 0.08
",
            named_pinhole,
        ),
        public(
            "stella-cv/stella_vslam: example/aist/fisheye.yaml",
            [960.0, 540.0],
            "# LUMIX fisheye model for 1K setting

Camera:
  name: \"LUMIX DMC-GX8 8mm fisheye 1K\"
  setup: \"monocular\"
  model: \"fisheye\"

  fx: 441.730011169
  fy: 442.520822476
  cx: 480.35667528
  cy: 275.490228646

  k1: -3.068701296607466433e-02
  k2: -3.343454364086094217e-03
  k3: -2.881735840896060968e-03
  k4: -5.917420310474077278e-04

  fps: 30.0
  cols: 960
  rows: 540
",
            named_fisheye,
        ),
    ]);
}
