//! Public files of polynomial lenses, and of gyroflow.

use super::*;

/// OCamCalib counts rows before columns: its affine part and center are exchanged.
fn ocam(text: &str, d: DVec3) -> DVec2 {
    let [_, heights @ ..] = after::<6>(text, "cam2world");
    let [row, column] = after(text, "(C convention)");
    scaramuzza(&heights, after(text, "\"e\""), [column, row], d)
}

#[test]
fn public_files_of_ocamcalib_and_woodscape_are_read() {
    let results = |origin, size, text| Public { file: "calib_results.txt", ..public(origin, size, text, ocam) };
    check_public(&[
        results(
            "BhavayGoyal/UVSS: calib_results_fisheye.txt",
            [1936.0, 1216.0],
            "#polynomial coefficients for the DIRECT mapping function (ocam_model.ss in MATLAB). These are used by cam2world

5 -3.919750e+02 0.000000e+00 6.577892e-04 -8.750121e-07 1.164417e-09 

#polynomial coefficients for the inverse mapping function (ocam_model.invpol in MATLAB). These are used by world2cam

3 764.973050 491.815815 -109.325553 

#center: \"row\" and \"column\", starting from 0 (C convention)

607.187791 967.008793

#affine parameters \"c\", \"d\", \"e\"

0.991936 0.000158 -0.001031

#image size: \"height\" and \"width\"

1216 1936

",
        ),
        results(
            "renmengqisheng/calib_fisheye: calib_results.txt",
            [1920.0, 1208.0],
            "#polynomial coefficients for the DIRECT mapping function (ocam_model.ss in MATLAB). These are used by cam2world

5 -7.463674e+02 0.000000e+00 8.872435e-04 -1.024379e-06 9.406640e-10 

#polynomial coefficients for the inverse mapping function (ocam_model.invpol in MATLAB). These are used by world2cam

3 976.011496 423.799439 -71.005688 

#center: \"row\" and \"column\", starting from 0 (C convention)

630.102940 958.314910

#affine parameters \"c\", \"d\", \"e\"

0.996974 -0.014257 0.013102

#image size: \"height\" and \"width\"

1208 1920

",
        ),
        results(
            "vivekmudgal/fisheye-localization: calib_results.txt",
            [640.0, 480.0],
            "#polynomial coefficients for the DIRECT mapping function (ocam_model.ss in MATLAB). These are used by cam2world

5 -3.258881e+02 0.000000e+00 8.612196e-04 -3.553896e-08 6.737619e-09 

#polynomial coefficients for the inverse mapping function (ocam_model.invpol in MATLAB). These are used by world2cam

3 407.216320 159.672870 -53.191585 

#center: \"row\" and \"column\", starting from 0 (C convention)

261.744395 326.939156

#affine parameters \"c\", \"d\", \"e\"

1.001968 0.001400 0.000113

#image size: \"height\" and \"width\"

480 640

",
        ),
        Public {
            file: "front.json",
            ..public(
                "valeoai/WoodScape: scripts/calibration/front.json",
                [1280.0, 966.0],
                r#"{"extrinsic": {"translation": [3.7484, 0.0, 0.6601699999999999]}, "intrinsic": {"aspect_ratio": 1.0,
"cx_offset": 3.942, "cy_offset": -3.093, "height": 966.0, "k1": 339.749, "k2": -31.988, "k3": 48.275, "k4": -7.201,
"model": "radial_poly", "poly_order": 4, "width": 1280.0}, "name": "FV"}"#,
                |text, d| {
                    let [k1, k2, k3, k4] = named(text, ["k1", "k2", "k3", "k4"]);
                    let p = d.truncate().normalize_or_zero() * polynomial(&[0.0, k1, k2, k3, k4], angle(d));
                    let [width, height, x, y] = named(text, ["width", "height", "cx_offset", "cy_offset"]);
                    // its aspect ratio is 1
                    p + DVec2::new(0.5 * width + x, 0.5 * height + y) - 0.5
                },
            )
        },
    ]);
}

#[test]
fn public_models_of_ncore_are_read() {
    const ORIGIN: &str = "NVIDIA/ncore: ncore/impl/sensors/camera_test.py";
    let json = |size, text, project| Public { file: "camera.json", ..public(ORIGIN, size, text, project) };
    check_public(&[
        json(
            [3848.0, 2168.0],
            r#"{"camera_model_type": "ftheta", "resolution": [3848, 2168], "shutter_type": "ROLLING_TOP_TO_BOTTOM",
"principal_point": [1909.3092041015625, 1103.27880859375], "reference_poly": "ANGLE_TO_PIXELDIST",
"pixeldist_to_angle_poly": [0.0, 0.00031855489942245185, -5.4367417234857385e-09, 4.775631279319015e-12, -1.0283620548333567e-15, -1.1274463994279525e-19],
"angle_to_pixeldist_poly": [0.0, 3139.48583984375, 164.5725860595703, -442.12896728515625, 259.5827331542969, 153.66644287109375],
"max_angle": 0.7037167544041137, "linear_cde": [1.0000840425491333, -2.8000000384054147e-05, -7.300000288523734e-05]}"#,
            |text, d| {
                let radius = polynomial(&after::<6>(text, "angle_to_pixeldist_poly"), angle(d));
                let p = d.truncate().normalize_or_zero() * radius;
                let ([c, dd, e], point) = (after(text, "linear_cde"), after::<2>(text, "principal_point"));
                DVec2::new(c * p.x + dd * p.y, e * p.x + p.y) + DVec2::from(point)
            },
        ),
        json(
            [3848.0, 2168.0],
            r#"{"camera_model_type": "ftheta", "resolution": [3848, 2168], "shutter_type": "ROLLING_TOP_TO_BOTTOM",
"principal_point": [1904.948486328125, 1090.5164794921875], "reference_poly": "PIXELDIST_TO_ANGLE",
"pixeldist_to_angle_poly": [0.0, 0.0005380856455303729, -1.2021251771798802e-09, 4.5657002484267295e-12, -5.581118088908714e-16, 0.0],
"angle_to_pixeldist_poly": [0.0, 1858.59228515625, 6.894773483276367, -53.92193603515625, 14.201756477355957, 0.0],
"max_angle": 1.2292176485061646}"#,
            |text, d| {
                let c = after::<6>(text, "pixeldist_to_angle_poly");
                let radius = inverse(|r| polynomial(&c, r), angle(d), 2500.0);
                d.truncate().normalize_or_zero() * radius + DVec2::from(after::<2>(text, "principal_point"))
            },
        ),
        json(
            [3840.0, 2160.0],
            r#"{"camera_model_type": "opencv-fisheye", "resolution": [3840, 2160], "shutter_type": "ROLLING_TOP_TO_BOTTOM",
"principal_point": [1928.184506, 1083.862789], "focal_length": [1913.76478, 1913.99708],
"radial_coeffs": [-0.030093122, -0.005103817, -0.000849622, 0.001079542], "max_angle": 1.2217304763960306}"#,
            |text, d| {
                let k = after::<4>(text, "radial_coeffs");
                let ([fx, fy], [cx, cy]) = (after(text, "focal_length"), after(text, "principal_point"));
                plane([fx, fy, cx, cy], brown(equidistant(d), &k, [0.0; 2])) - 0.5
            },
        ),
    ]);
}

/// gyroflow's fisheye of a lens that is not `asymmetrical`: the principal point is half the size.
fn gyroflow(text: &str, d: DVec3) -> DVec2 {
    let [fx, _, _, _, fy] = after(text, "camera_matrix");
    let [width, height] = named(text, ["w", "h"]);
    let k = after::<4>(text, "distortion_coeffs");
    plane([fx, fy, 0.5 * width, 0.5 * height], brown(equidistant(d), &k, [0.0; 2]))
}

#[test]
fn public_profiles_of_gyroflow_are_read() {
    let profile = |origin, size, text| Public { file: "lens.json", ..public(origin, size, text, gyroflow) };
    check_public(&[
        profile(
            "gyroflow/lens_profiles: Mobile phones/Apple/Apple_iPhone12_raw_cam_UltraWide_16x9.json",
            [1920.0, 1080.0],
            r#"{"calib_dimension": {"w": 1920, "h": 1080}, "input_horizontal_stretch": 1.0, "crop": null, "asymmetrical": false,
"fisheye_params": {"RMS_error": 0.2113121097109413, "camera_matrix": [[816.3986838185905, 0.0, 954.00962346415],
[0.0, 807.1544891144971, 572.6121567515329], [0.0, 0.0, 1.0]], "distortion_coeffs": [0.5626566258167011,
-0.8024681978540943, 6.104535872876585, -18.326472752062276], "radial_distortion_limit": null}}"#,
        ),
        profile(
            "gyroflow/lens_profiles: Insta360/Insta360_EVO_Unknown_50fpz_2.7k_1by1_2880x2880-29.97fps.json",
            [2880.0, 2880.0],
            r#"{"calib_dimension": {"w": 2880, "h": 2880}, "crop": null, "asymmetrical": false, "fisheye_params": {"camera_matrix":
[[869.1582755977588, 0.0, 1441.3758444705966], [0.0, 868.4250488704606, 1422.360054613191], [0.0, 0.0, 1.0]],
"distortion_coeffs": [-0.0020760214117440147, -0.0030266544909939865, -0.0007369470066610488, -0.0004695878363621481]},
"distortion_model": null, "digital_lens": null}"#,
        ),
        profile(
            "gyroflow/lens_profiles: Canon/Canon_EOS 700D_Nikkor 35mm DX f1.8G_Dual ISO Anamorphic_C4k_2.39by1_4412x1846-23.98fps.json",
            [4412.0, 1846.0],
            r#"{"calib_dimension": {"w": 4412, "h": 1846}, "crop": null, "asymmetrical": false, "fisheye_params": {"camera_matrix":
[[8578.743241800665, 0.0, 1974.2544303169975], [0.0, 8576.14585242171, 1045.5776554975148], [0.0, 0.0, 1.0]],
"distortion_coeffs": [0.35528535432516906, -10.642098041947468, 253.1119280841791, -2223.2448009675295]}}"#,
        ),
    ]);
}
