//! Public files of OpenCV, ROS and KITTI.

use super::*;

/// The numbers of a matrix's `data`.
fn matrix<const N: usize>(text: &str, key: &str) -> [f64; N] {
    after(rest(text, key), "data")
}

fn of_matrix(k: [f64; 9], p: DVec2) -> DVec2 {
    DVec2::new(k[0] * p.x + k[1] * p.y + k[2], k[4] * p.y + k[5])
}

/// OpenCV's first five coefficients.
fn five([k1, k2, p1, p2, k3]: [f64; 5], p: DVec2) -> DVec2 {
    brown(p, &[k1, k2, k3], [p1, p2])
}

fn opencv(text: &str, d: DVec3) -> DVec2 {
    of_matrix(matrix(text, "camera_matrix"), five(matrix(text, "distortion_coefficients"), flat(d)))
}

#[test]
fn public_files_of_opencv_are_read() {
    check_public(&[
        public(
            "opencv/opencv: samples/data/left_intrinsics.yml",
            [640.0, 480.0],
            "%YAML:1.0
---
image_width: 640
image_height: 480
flags: 2
camera_matrix: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 5.3591573396163199e+02, 0., 3.4228315473308373e+02, 0.,
       5.3591573396163199e+02, 2.3557082909788173e+02, 0., 0., 1. ]
distortion_coefficients: !!opencv-matrix
   rows: 5
   cols: 1
   dt: d
   data: [ -2.6637260909660682e-01, -3.8588898922304653e-02,
       1.7831947042852964e-03, -2.8122100441115472e-04,
       2.3839153080878486e-01 ]
",
            opencv,
        ),
        public(
            "opencv/opencv: samples/cpp/tutorial_code/calib3d/camera_calibration/out_camera_data.yml",
            [640.0, 480.0],
            "%YAML:1.0
calibration_Time: \"08/19/11 20:44:38\"
image_Width: 640
image_Height: 480
Camera_Matrix: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 6.5746697810243404e+002, 0., 3.1950000000000000e+002, 0.,
       6.5746697810243404e+002, 2.3950000000000000e+002, 0., 0., 1. ]
Distortion_Coefficients: !!opencv-matrix
   rows: 5
   cols: 1
   dt: d
   data: [ -4.1802327018241026e-001, 5.0715243805833121e-001, 0., 0.,
       -5.7843596847939704e-001 ]
",
            |text, d| of_matrix(matrix(text, "Camera_Matrix"), five(matrix(text, "Distortion_Coefficients"), flat(d))),
        ),
        Public {
            file: "camera.xml",
            ..public(
                "ScanVan/Calibration-CPP: out_camera_omni.xml",
                [3008.0, 3008.0],
                "<?xml version=\"1.0\"?>
<opencv_storage>
<flags>0</flags>
<imageSize>
  3008 3008</imageSize>
<camera_matrix type_id=\"opencv-matrix\">
  <rows>3</rows>
  <cols>3</cols>
  <dt>d</dt>
  <data>
    1.4778188305088690e+03 6.9746120167421488e-01 1.4886670907354676e+03
    0. 1.4786059696837733e+03 1.4986215926029258e+03 0. 0. 1.</data></camera_matrix>
<distortion_coefficients type_id=\"opencv-matrix\">
  <rows>1</rows>
  <cols>4</cols>
  <dt>d</dt>
  <data>
    -2.2603874071366884e-02 1.6680375260089541e-03
    1.7996364807964125e-04 4.3613572037580836e-04</data></distortion_coefficients>
<xi>9.5458918408607130e-01</xi>
</opencv_storage>
",
                |text, d| {
                    let [k1, k2, p1, p2] = matrix(text, "distortion_coefficients");
                    let p = d.truncate() / (d.z + named(text, ["xi"])[0] * d.length());
                    of_matrix(matrix(text, "camera_matrix"), brown(p, &[k1, k2], [p1, p2]))
                },
            )
        },
    ]);
}

#[test]
fn public_files_of_ros_and_kitti_are_read() {
    check_public(&[
        public(
            "vas0x59/aruco_ros_board: ost.yaml",
            [640.0, 480.0],
            "image_width: 640
image_height: 480
camera_name: test
camera_matrix:
  rows: 3
  cols: 3
  data: [641.650188, 0.000000, 311.974380, 0.000000, 641.371720, 228.580277, 0.000000, 0.000000, 1.000000]
distortion_model: plumb_bob
distortion_coefficients:
  rows: 1
  cols: 5
  data: [0.032609, -0.085947, -0.000148, -0.004368, 0.000000]
rectification_matrix:
  rows: 3
  cols: 3
  data: [1.000000, 0.000000, 0.000000, 0.000000, 1.000000, 0.000000, 0.000000, 0.000000, 1.000000]
",
            opencv,
        ),
        public(
            "ger-unicamp/drone_data: camera_info.yaml",
            [752.0, 480.0],
            "header: 
  seq: 2
  stamp: 
    secs: 5
    nsecs: 872000000
  frame_id: \"uav1/bluefox_optflow_optical\"
height: 480
width: 752
distortion_model: \"plumb_bob\"
D: [0.0, 0.0, 0.0, 0.0, 0.0]
K: [215.6810060961547, 0.0, 376.5, 0.0, 215.6810060961547, 240.5, 0.0, 0.0, 1.0]
R: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]
binning_x: 0
binning_y: 0
roi: 
  x_offset: 0
  do_rectify: False
---
header: 
  seq: 3
",
            |text, d| of_matrix(after(text, "K:"), five(after(text, "D:"), flat(d))),
        ),
        Public {
            file: "ost.txt",
            ..public(
                "wennycooper/undistortion: ost.txt",
                [1920.0, 1080.0],
                "# oST version 5.0 parameters


[image]

width
1920

height
1080

[narrow_stereo]

camera matrix
1588.052924 0.000000 964.986969
0.000000 1586.031534 538.015331
0.000000 0.000000 1.000000

distortion
-0.130096 0.069268 -0.001506 -0.000456 0.000000

rectification
1.000000 0.000000 0.000000
0.000000 1.000000 0.000000
0.000000 0.000000 1.000000
",
                |text, d| of_matrix(after(text, "camera matrix"), five(after(text, "distortion"), flat(d))),
            )
        },
        Public {
            file: "calib_cam_to_cam.txt",
            keys: "index = 2",
            ..public(
                "MIT-SPARK/Kimera-VIO: tests/data/ForKittiData/calib_cam_to_cam.txt",
                [1242.0, 375.0],
                "calib_time: 09-Jan-2012 13:57:47
corner_dist: 9.950000e-02
S_02: 1.392000e+03 5.120000e+02
K_02: 9.597910e+02 0.000000e+00 6.960217e+02 0.000000e+00 9.569251e+02 2.241806e+02 0.000000e+00 0.000000e+00 1.000000e+00
D_02: -3.691481e-01 1.968681e-01 1.353473e-03 5.677587e-04 -6.770705e-02
S_rect_02: 1.242000e+03 3.750000e+02
P_rect_02: 7.215377e+02 0.000000e+00 6.095593e+02 4.485728e+01 0.000000e+00 7.215377e+02 1.728540e+02 2.163791e-01 0.000000e+00 0.000000e+00 1.000000e+00 2.745884e-03
S_rect_03: 1.242000e+03 3.750000e+02
P_rect_03: 7.215377e+02 0.000000e+00 6.095593e+02 -3.395242e+02 0.000000e+00 7.215377e+02 1.728540e+02 2.199936e+00 0.000000e+00 0.000000e+00 1.000000e+00 2.729905e-03
",
                |text, d| {
                    let [fx, _, cx, _, _, fy, cy] = after(text, "P_rect_02:");
                    plane([fx, fy, cx, cy], flat(d))
                },
            )
        },
    ]);
}
