//! Files of polynomial lenses: OCamCalib, WoodScape, ncore and gyroflow.

use super::*;

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
