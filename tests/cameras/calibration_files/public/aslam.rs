//! Public files of Kalibr, EuRoC, Kimera, SVO and vikit.

use super::*;

/// `pinhole` of Kalibr, EuRoC and SVO, with radtan, equidistant, or aslam's `fisheye`, the FOV model.
fn aslam(text: &str, d: DVec3) -> DVec2 {
    let after_data = |key: &str| rest(text, key).split_once("data:").map_or(rest(text, key), |(_, data)| data);
    let is_svo = text.contains("cols:");
    let of = |key: &str| if is_svo { after_data(key) } else { rest(text, key) };
    let f = after::<4>(of("intrinsics:"), "[");
    let k = of(if is_svo { "parameters:" } else { "distortion_coeff" });
    if text.contains("type: fisheye") {
        let [omega] = after(k, "[");
        let r = flat(d).length();
        return plane(f, flat(d) * ((2.0 * r * (0.5 * omega).tan()).atan() / (r * omega)));
    }
    let [k1, k2, k3, k4] = after(k, "[");
    match text.contains("equidistant") {
        true => plane(f, brown(equidistant(d), &[k1, k2, k3, k4], [0.0; 2])),
        false => plane(f, brown(flat(d), &[k1, k2], [k3, k4])),
    }
}

#[test]
fn public_files_of_kalibr_euroc_and_kimera_are_read() {
    check_public(&[
        public(
            "rpng/open_vins: config/euroc_mav/kalibr_imucam_chain.yaml",
            [752.0, 480.0],
            "%YAML:1.0

cam0:
  T_imu_cam: #rotation from camera to IMU R_CtoI, position of camera in IMU p_CinI
    - [0.0148655429818, -0.999880929698, 0.00414029679422, -0.0216401454975]
  cam_overlaps: [1]
  camera_model: pinhole
  distortion_coeffs: [-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05]
  distortion_model: radtan
  intrinsics: [458.654, 457.296, 367.215, 248.375] #fu, fv, cu, cv
  resolution: [752, 480]
",
            aslam,
        ),
        public(
            "rpng/open_vins: config/tum_vi/kalibr_imucam_chain.yaml",
            [512.0, 512.0],
            "%YAML:1.0 # need to specify the file type at the top!

cam0:
  cam_overlaps: [1]
  camera_model: pinhole
  distortion_coeffs: [0.0034823894022493434, 0.0007150348452162257, -0.0020532361418706202, 0.00020293673591811182]
  distortion_model: equidistant
  intrinsics: [190.97847715128717, 190.9733070521226, 254.93170605935475, 256.8974428996504]
  resolution: [512, 512]
",
            aslam,
        ),
        public(
            "rpng/open_vins: config/uzhfpv_indoor/kalibr_imucam_chain.yaml",
            [640.0, 480.0],
            "%YAML:1.0

cam0:
  camera_model: pinhole
  distortion_coeffs: [-0.013721808247486035, 0.020727425669427896, -0.012786476702685545,
                      0.0025242267320687625]
  distortion_model: equidistant
  intrinsics: [278.66723066149086, 278.48991409740296, 319.75221200593535, 241.96858910358173]
  resolution: [640, 480]
  timeshift_cam_imu: -0.016684572091862235
",
            aslam,
        ),
        public(
            "MIT-SPARK/Kimera-VIO: tests/data/MicroEurocDataset/mav0/cam0/sensor.yaml",
            [752.0, 480.0],
            "%YAML:1.0
sensor_type: camera
rate_hz: 20
resolution: [752, 480]
camera_model: pinhole
intrinsics: [458.654, 457.296, 367.215, 248.375] #fu, fv, cu, cv
distortion_model: radial-tangential
distortion_coefficients: [-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05]
",
            aslam,
        ),
        public(
            "MIT-SPARK/Kimera-VIO: params/RealSenseIR/LeftCameraParams.yaml",
            [640.0, 480.0],
            "%YAML:1.0
camera_id: left_cam
resolution: [640, 480]
camera_model: pinhole
intrinsics: [384.5697007030446, 385.6469026594307, 324.92457920979194, 239.78003927789618] #fu, fv, cu, cv
distortion_model: equidistant
distortion_coefficients: [0.34610989806637954, 0.11497394690333039, 0.09283198659020588, 0.011326272488628174]
",
            aslam,
        ),
        public(
            "MIT-SPARK/Kimera-VIO: tests/data/ForOmniCamera/OmniCamParams.yaml",
            [2000.0, 1500.0],
            "%YAML:1.0
camera_id: left_cam
resolution: [2000, 1500]
camera_model: omni
intrinsics: [] # must be empty for omni
distortion_model: omni
distortion_coefficients: [875.074642516832, 0.0, -0.00030379174233022, -4.81892212543229e-08, 1.71277628064668e-11]
omni_affine: [0.0, 0.0, 1.0]
omni_distortion_center: [1005.817454205254, 743.034296906609]
",
            |text, d| {
                // its height is the polynomial itself, its affine part [1 a; b c]
                let heights = after::<5>(text, "distortion_coefficients:").map(|a| -a);
                let [a, b, c] = after(text, "omni_affine:");
                scaramuzza(&heights, [c, b, a], after(text, "omni_distortion_center:"), d)
            },
        ),
    ]);
}

#[test]
fn public_files_of_svo_and_vikit_are_read() {
    check_public(&[
        public(
            "uzh-rpg/rpg_svo_pro_open: svo_ros/param/calib/davis_flyingroom.yaml",
            [346.0, 260.0],
            "cameras:
- camera:
    distortion:
      parameters:
        cols: 1
        rows: 4
        data: [0.2250580451135414, 0.217092209159718, -0.05534881782056823, 0.16384768043077721]
      type: equidistant
    image_height: 260
    image_width: 346
    intrinsics:
      cols: 1
      rows: 4
      data: [198.71975957912073, 198.68261014084223, 163.13401862233954, 143.59070352169638]
    label: cam
    type: pinhole
label: DAVIS-03460003
",
            aslam,
        ),
        public(
            "uzh-rpg/rpg_svo_pro_open: svo_ros/param/calib/svo_test_pinhole.yaml",
            [752.0, 480.0],
            "cameras:
- camera:
    distortion:
      parameters:
        cols: 1
        rows: 1
        data: [0.9320]
      type: fisheye
    image_height: 480
    image_width: 752
    intrinsics:
      cols: 1
      rows: 4
      data: [383.013152, 382.39248, 344.7056, 244.32688]
    type: pinhole
",
            aslam,
        ),
        public(
            "uzh-rpg/rpg_svo_pro_open: svo_ros/param/calib/bluefox_25000826_fisheye.yaml",
            [752.0, 480.0],
            "cameras:
- camera:
    distortion:
      parameters:
        cols: 1
        rows: 0
        data: []
      type: none
    image_height: 480
    image_width: 752
    intrinsics:
      cols: 1
      data: [-2.065170e+02, 0.000000e+00, 2.207161e-03, -4.879622e-06, 1.865656e-08, 394.552874, 241.800066, 1.000330, 0.000219, 0.000257, 294.182260, 152.289570, -12.191217, 27.959546, 8.241525, -1.970397, 10.689256, 1.871609, -6.437684, 0.430037, 3.215544, 0.921484, 0.0, 1.0]
      rows: 24
    type: omni
",
            |text, d| {
                let [heights @ .., cx, cy, c, dd, e] = after::<10>(rest(text, "intrinsics:"), "[");
                scaramuzza(&heights, [c, dd, e], [cx, cy], d)
            },
        ),
        public(
            "uzh-rpg/rpg_svo: svo_ros/param/camera_atan.yaml",
            [752.0, 480.0],
            "cam_model: ATAN
cam_width: 752
cam_height: 480
cam_fx: 0.509326
cam_fy: 0.796651
cam_cx: 0.45905
cam_cy: 0.510056
cam_d0: 0.9320",
            |text, d| {
                let ([fx, fy, cx, cy], [omega]) = (named(text, FOCAL), named(text, ["d0"]));
                let r = flat(d).length();
                let p = flat(d) * ((2.0 * r * (0.5 * omega).tan()).atan() / (r * omega));
                plane([fx * 752.0, fy * 480.0, cx * 752.0 - 0.5, cy * 480.0 - 0.5], p)
            },
        ),
        public(
            "uzh-rpg/rpg_svo: svo_ros/param/camera_pinhole.yaml",
            [752.0, 480.0],
            "cam_model: Pinhole
cam_width: 752
cam_height: 480
cam_fx: 414.536145
cam_fy: 414.284429
cam_cx: 348.804988
cam_cy: 240.076451
cam_d0: -0.283076
cam_d1: 0.066674
cam_d2: 0.000896
cam_d3: 0.000778",
            vikit,
        ),
        public(
            "uzh-rpg/rpg_svo_pro_open: vikit/vikit_cameras/test/data/calib_pinhole_radtan.yaml",
            [752.0, 480.0],
            "cam0:
  cam_model: PinholeRadialTangential
  cam_width: 752
  cam_height: 480
  cam_fx: 465.2005090331355
  cam_fy: 465.4821196969644
  cam_cx: 407.7552059925612
  cam_cy: 244.36152062408814
  cam_d0: -0.3091674142711387
  cam_d1: 0.10905899434862235
  cam_d2: 9.527033720237582e-05
  cam_d3: -0.0005776582308113238
",
            vikit,
        ),
    ]);
}

/// `Pinhole` and `PinholeRadialTangential` of vikit.
fn vikit(text: &str, d: DVec3) -> DVec2 {
    plane(named(text, FOCAL), brown(flat(d), &named(text, ["d0", "d1"]), named(text, ["d2", "d3"])))
}
