//! Files of photogrammetry and radiance fields: `transforms.json`, OpenSfM, AliceVision and Metashape.

use super::*;

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
