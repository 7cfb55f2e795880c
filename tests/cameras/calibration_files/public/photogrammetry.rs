//! Public files of photogrammetry and radiance fields.

use super::*;

/// nerfstudio's and instant-ngp's OPENCV.
fn transforms(text: &str, d: DVec3) -> DVec2 {
    let p = brown(flat(d), &named(text, ["k1", "k2"]), named(text, ["p1", "p2"]));
    plane(named(text, ["fl_x", "fl_y", "cx", "cy"]), p) - 0.5
}

#[test]
fn public_files_of_transforms_json_and_colmap_are_read() {
    let json = |origin, size, text| Public { file: "transforms.json", ..public(origin, size, text, transforms) };
    let colmap = |origin, size, text, project| Public {
        file: "cameras.txt",
        keys: "index = 1",
        ..public(origin, size, text, project)
    };
    check_public(&[
        json(
            "nimrodw/drone_nerf: transforms.json",
            [1500.0, 1000.0],
            r#"{"camera_angle_x": 0.86, "camera_angle_y": 0.59, "fl_x": 2535.7774397566545, "fl_y": 2535.7774397566545,
"k1": -0.006337414014651379, "k2": -0.061534936860702154, "p1": -0.0014092239651047748, "p2": 9.249850279926745e-05,
"cx": 750.0, "cy": 500.0, "w": 1500.0, "h": 1000.0, "aabb_scale": 4,
"frames": [{"file_path": "data/4_00001.JPG", "transform_matrix": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]}]}"#,
        ),
        json(
            "sangminkim-99/COLMAP_multicam: transforms.json",
            [640.0, 480.0],
            r#"{"frames": [{"file_path": "./images/robot/000000-color.png", "sharpness": 1014.7752234763147,
"transform_matrix": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]],
"w": 640.0, "h": 480.0, "fl_x": 608.562030830161, "fl_y": 608.5331075830826, "k1": 0.13988932934004733,
"k2": -0.30767041035500986, "k3": 0, "k4": 0, "p1": -0.00020454452767109955, "p2": -0.00042662455043181386,
"cx": 321.3254292697266, "cy": 243.76173751078295}]}"#,
        ),
        json(
            "5697526/NeRF-TensoRF: transforms.json",
            [1080.0, 1920.0],
            r#"{"camera_angle_x": 0.5733101478800153, "camera_angle_y": 0.9653913690755414, "fl_x": 1831.9143095815152,
"fl_y": 1831.9143095815152, "k1": 0, "k2": 0, "p1": 0, "p2": 0, "cx": 540.0, "cy": 960.0, "w": 1080.0, "h": 1920.0,
"frames": [{"file_path": "./images/14.jpg", "transform_matrix": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]}]}"#,
        ),
        colmap(
            "sangminkim-99/COLMAP_multicam: colmap_text/cameras.txt",
            [640.0, 480.0],
            "# Camera list with one line of data per camera:
#   CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]
# Number of cameras: 2
1 OPENCV 640 480 603.464681591248 602.86731959286703 318.84492798218935 239.21314824403373 0.12896650307015176 -0.25087859406183488 -0.0020447505577008535 -0.0018532628694871657
2 OPENCV 640 480 608.56203083016101 608.5331075830826 321.32542926972661 243.76173751078295 0.13988932934004733 -0.30767041035500986 -0.00020454452767109955 -0.00042662455043181386
",
            |text, d| {
                let [fx, fy, cx, cy, k1, k2, p1, p2] = after(text, "1 OPENCV 640 480");
                plane([fx, fy, cx, cy], brown(flat(d), &[k1, k2], [p1, p2])) - 0.5
            },
        ),
        colmap(
            "Laxmaan/3D-Reconstruction: cameras.txt",
            [4000.0, 3000.0],
            "# Number of cameras: 1\n1 SIMPLE_RADIAL 4000 3000 3036.32 2000 1500 0.0249925\n",
            simple_radial,
        ),
        colmap(
            "Chapapa78/ProjetSLAM: cameras.txt",
            [1080.0, 1920.0],
            "# Number of cameras: 1394
1 SIMPLE_RADIAL 1080 1920 2054.9734369699504 540 960 0.08196779041606532
2 SIMPLE_RADIAL 1080 1920 2055.6661649740331 540 960 0.084874561648175473
",
            simple_radial,
        ),
    ]);
}

/// The first camera of COLMAP's model SIMPLE_RADIAL.
fn simple_radial(text: &str, d: DVec3) -> DVec2 {
    let [_, _, f, cx, cy, k] = after(text, "1 SIMPLE_RADIAL");
    plane([f, f, cx, cy], brown(flat(d), &[k], [0.0; 2])) - 0.5
}

/// OpenSfM's `perspective`, relative to the larger side.
fn opensfm(text: &str, d: DVec3) -> DVec2 {
    let ([width, height], [focal]) = (named(text, ["width", "height"]), named(text, ["focal"]));
    let f = focal * f64::max(width, height);
    plane([f, f, 0.5 * width, 0.5 * height], brown(flat(d), &named(text, ["k1", "k2"]), [0.0; 2])) - 0.5
}

#[test]
fn public_files_of_opensfm_and_alicevision_are_read() {
    let json = |origin, size, text| Public { file: "reconstruction.json", ..public(origin, size, text, opensfm) };
    let sfm = |origin, size, text| Public { file: "cameras.sfm", ..public(origin, size, text, alicevision) };
    check_public(&[
        json(
            "mapillary/OpenSfM: data/berlin/reconstruction_example.json",
            [3264.0, 2448.0],
            r#"[{"cameras": {"v2 apple iphone4,1 3264 2448 perspective 0.9722": {"projection_type": "perspective",
"width": 3264, "height": 2448, "focal": 0.8696658484855359, "k1": 0.08851464962037196, "k2": -0.2324428377906099}},
"shots": {"03.jpg": {"rotation": [1.003762767932739, -0.322790511169595, 0.5356962109505305],
"translation": [0.5087233233896116, 24.781886004913993, -20.531969658319593],
"camera": "v2 apple iphone4,1 3264 2448 perspective 0.9722", "orientation": 1}}}]"#,
        ),
        json(
            "arjunkurup/sfm-data-bathtub: reconstruction.json",
            [2880.0, 2160.0],
            r#"[{"cameras": {"v2 unknown unknown 2880 2160 perspective 0": {"projection_type": "perspective", "width": 2880,
"height": 2160, "focal": 0.8508120812316551, "k1": 0.0009656271338284912, "k2": -0.0002651899903388182}}, "shots": {}}]"#,
        ),
        sfm(
            "ledionkalludra/LoD2to3: data/meshroom/cameras.sfm",
            [4000.0, 3000.0],
            r#"{"version": ["1", "2", "6"], "views": [], "intrinsics": [{"intrinsicId": "2390361049", "width": "4000",
"height": "3000", "sensorWidth": "8.1265990486979671", "sensorHeight": "6.0949492865234758", "type": "radial3",
"initialFocalLength": "5.4000000000000004", "focalLength": "5.678361290663454", "pixelRatio": "1",
"principalPoint": ["-32.291769408137576", "-65.688458120059806"],
"distortionParams": ["0.082661234054845489", "-0.1084229596836524", "0.030428071832084524"],
"undistortionOffset": ["0", "0"], "undistortionParams": "", "locked": "false"}]}"#,
        ),
        sfm(
            "alicevision/AliceVision: pyTests/data/small.sfm",
            [6016.0, 3200.0],
            r#"{"version": ["1", "2", "5"], "views": [], "intrinsics": [{"intrinsicId": "3553739036", "width": "6016",
"height": "3200", "sensorWidth": "36", "sensorHeight": "19.148936170212767", "type": "radial3", "initialFocalLength": "-1",
"focalLength": "43.45584412271571", "pixelRatio": "1", "principalPoint": ["0", "0"], "distortionParams": ["0", "0", "0"]}]}"#,
        ),
    ]);
}

/// AliceVision's `radial3`: the focal length is in the sensor's unit, and the principal point is an offset from the middle.
fn alicevision(text: &str, d: DVec3) -> DVec2 {
    let [width, height, sensor, focal] = named(text, ["width", "height", "sensorWidth", "focalLength"]);
    let [x, y] = after(text, "principalPoint");
    let f = focal / sensor * width;
    let k = after::<3>(text, "distortionParams");
    plane([f, f, 0.5 * width + x, 0.5 * height + y], brown(flat(d), &k, [0.0; 2])) - 0.5
}

/// The frame camera of Agisoft's manual, whose p1 and p2 are OpenCV's p2 and p1.
fn metashape(text: &str, d: DVec3) -> DVec2 {
    let [f, cx, cy, b1, b2] = named(text, ["f", "cx", "cy", "b1", "b2"]);
    let p = brown(flat(d), &named(text, ["k1", "k2", "k3", "k4"]), named(text, ["p2", "p1"]));
    let [width, height] = match text.contains("<width>") {
        true => named(text, ["width", "height"]),
        false => after(text, "<resolution"),
    };
    DVec2::new(0.5 * width + cx + p.x * (f + b1) + p.y * b2, 0.5 * height + cy + p.y * f) - 0.5
}

#[test]
fn public_files_of_metashape_are_read() {
    let xml = |origin, size, text| Public { file: "cameras.xml", ..public(origin, size, text, metashape) };
    check_public(&[
        xml(
            "hwiyoung/MappingLocalization: cameras.xml",
            [1384.0, 1032.0],
            r#"<?xml version="1.0" encoding="UTF-8"?>
<document version="1.5.0"><chunk label="Merged Chunk" enabled="true"><sensors next_id="4">
<sensor id="1" label="train_R" type="frame"><resolution width="1384" height="1032"/>
<property name="pixel_width" value="0.00645"/>
<calibration type="frame" class="initial"><resolution width="1384" height="1032"/>
<f>1279.71039201197</f><cx>-6.272717931</cx><cy>-1.60870271</cy><k1>-0.184066204152112</k1><k2>0.204098997889525</k2>
<k3>-0.190930310380786</k3><p1>-0.000384022825200163</p1><p2>-7.83755478488317e-05</p2></calibration>
</sensor></sensors></chunk></document>"#,
        ),
        xml(
            "hwiyoung/MappingLocalization: calibration/calib_lcam.xml",
            [1384.0, 1032.0],
            r#"<?xml version="1.0" encoding="UTF-8"?>
<calibration><projection>frame</projection><width>1384</width><height>1032</height><f>1278.27004761879825</f>
<cx>-10.21222021</cx><cy>-12.57474453</cy><k1>-0.17759609150540318</k1><k2>0.15681000753497404</k2>
<p1>0.00039689851424900256</p1><p2>-8.50563182421899e-05</p2><k3>-0.08057988377985598</k3>
<date>2020-07-15T09:43:30Z</date></calibration>"#,
        ),
        xml(
            "bitbyt3r/metashape-automation: cameras.xml",
            [5184.0, 3456.0],
            r#"<?xml version="1.0" encoding="UTF-8"?>
<document version="1.5.0"><chunk label="Chunk 1" enabled="true"><sensors next_id="94">
<sensor id="0" label="Canon EOS REBEL T5i (37mm)" type="frame"><resolution width="5184" height="3456"/>
<calibration type="frame" class="adjusted"><resolution width="5184" height="3456"/><f>8397.0800252741</f>
<b1>0.256163863908223</b1><b2>-22.8315524998528</b2><k1>-0.0603472625149708</k1><k2>0.184858521842878</k2>
<p1>-0.00119014441157678</p1><p2>0.00126022593561743</p2></calibration>
</sensor></sensors></chunk></document>"#,
        ),
    ]);
}
