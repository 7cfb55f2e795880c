//! Files of OpenCV, ROS and KITTI.

use super::*;

const MATRIX: &str = "[60, 0, 47.5, 0, 58, 31, 0, 0, 1]";

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
