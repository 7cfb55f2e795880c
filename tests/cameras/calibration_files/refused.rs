//! Files that are known and not read, and pictures with pixels that have no ray.

use super::*;

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
        (
            "a.yaml",
            "%YAML:1.0\nimage_width: 752\nimage_height: 480\ncam0_calib: \"cam0_mei.yaml\"\n",
            "a configuration of VINS-Fusion, not a lens; use the file \"cam0_mei.yaml\" that its cam0_calib names",
        ),
        (
            "a.yaml",
            "cam_model: PinholeAtan\ncam_width: 96\ncam_height: 64\ncam_fx: 0.5\ncam_fy: 0.8\ncam_cx: 0.5\ncam_cy: 0.5\ncam_d0: 0.9\n",
            "cam_fx: 0.5: PinholeAtan has pixels; use ATAN for fractions of the image",
        ),
        ("a.xmp", "<x:xmpmeta xmlns:x='adobe:ns:meta/'/>", "an XMP of RealityCapture"),
        ("a.csv", "#name,x,y,alt\na.jpg,1,2,3\n", "a list of RealityCapture's cameras"),
    ] {
        let error = in_file(file, text, POSE).unwrap_err();
        let said = error.to_string();
        assert!(error.exit_code() == 2 && said.contains(says) && !said.contains('\n'), "{text}: {said}");
    }
}

#[test]
fn a_file_of_omnidir_is_of_no_other_model() {
    let text = "image_width: 96\nimage_height: 64\ncamera_matrix: [60, 0.5, 47.5, 0, 58, 31, 0, 0, 1]\n\
                distortion_coefficients: [0.1, 0, 0, 0]\nxi: 0.9\n";
    let folder = tempfile::tempdir().unwrap();
    let read = |text: &str, keys: &str| {
        std::fs::write(folder.path().join("cam.yml"), text).unwrap();
        camera_in(folder.path(), &format!("kind = 'opencv'\nfile = 'cam.yml'\n{keys}{POSE}"), None)
    };
    assert!(read(text, "").is_ok());
    for (text, keys, says) in [
        (text, "model = 'brown'\n", "the file has xi, so it is of cv::omnidir"),
        (&text.replace("0.1, 0, 0, 0", "0.1, 0, 0, 0, 0"), "", "5 distortion coefficients; cv::omnidir has 4"),
        (&text.replace("xi: 0.9", "xi: [1, 2]"), "", "xi must be a finite number"),
        (&text.replace("xi: 0.9\n", ""), "", "camera_matrix: must be [fx, 0, cx; 0, fy, cy; 0, 0, 1]"),
    ] {
        let error = read(text, keys).unwrap_err().to_string();
        assert!(error.contains(says) && !error.contains('\n'), "{text}: {error}");
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
