//! Projection agrees with coverage for every camera with a name.

use crate::common;

use anamorph::internals::camera::kinds::KINDS;
use anamorph::internals::camera::mesh::spec::CameraVertex;
use anamorph::internals::camera::project::{Degenerate, Projector};
use anamorph::internals::image::write_npy_f64;
use common::FORWARD;
use common::cameras::{MeshShape, corners_of_each_class, mesh_spec, raymap};
use common::file::camera_of;
use common::projection::check;
use common::written::camera_in;
use glam::DVec3;
use std::path::Path;

const SIZE: (u32, u32) = (60, 44);

/// A viewer in front of the cube that the tests' points are in.
const POSE: &str = "eye = [0.2, 0.3, 4]\ntarget = [0, 0, 0]";

/// What some cameras are built around: a box before the middle of the cube.
pub(crate) const BOX: &str = "[[mesh]]\nbuiltin = \"box\"\nscale = 0.3\ntranslate = [0, 0, 1.5]";

/// Distorted and seen row by row.
const CALIBRATED: &str = "%YAML:1.0\n---\nimage_width: 60\nimage_height: 44\ncamera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   \
dt: d\n   data: [ 90., 0., 29.5, 0., 90., 21.5, 0., 0., 1. ]\ndistortion_coefficients: !!opencv-matrix\n   rows: 5\n   cols: 1\n   dt: d\n   \
data: [ -0.3, 0.1, 0.004, -0.003, 0.01 ]\n";

/// A fisheye by a polynomial from pixels to angles.
const F_THETA: &str = "{\"rig\": {\"sensors\": [{\"properties\": {\"Model\": \"ftheta\", \"width\": 60, \"height\": 44, \
\"cx\": 29.5, \"cy\": 21.5, \"polynomial\": \"0 0.012 1e-6 -1e-9\"}}]}}";

/// A screen of three parts before the eye.
const SCREEN: &str = "v -0.5 0.4 2.2\nv -0.2 0.4 2\nv 0.2 0.4 2\nv 0.5 0.4 2.2\nv -0.5 -0.4 2.2\nv -0.2 -0.4 2\nv 0.2 -0.4 2\nv 0.5 -0.4 2.2\n\
vt 0 1\nvt 0.3 1\nvt 0.7 1\nvt 1 1\nvt 0 0\nvt 0.3 0\nvt 0.7 0\nvt 1 0\n\
f 1/1 5/5 2/2\nf 2/2 5/5 6/6\nf 2/2 6/6 3/3\nf 3/3 6/6 7/7\nf 3/3 7/7 4/4\nf 4/4 7/7 8/8\n";

/// Kinds and what they are asked for; every kind of the program but `lidar` at least once.
const ASKED: &[(&str, &str)] = &[
    ("cross_slit", "slits = [{ distance = 4, angle = 20 }, { distance = 2.5, angle = 100 }]\nPOSE\nheight = 2"),
    ("cross_slit", "slits = [{ point = [0, 0, 4], direction = [1, 0.2, 0.3] }, { distance = 2.5, angle = 90 }]\nPOSE\nheight = 2"),
    ("pushbroom", "start = [-1, 0, 4]\nend = [1, 0.2, 4]\nlook = [0, 0, -1]\nvfov = 30"),
    ("pencil", "POSE\nvfov = 30\nslit = 0.7\nangle = 30"),
    ("twisted", "POSE\nheight = 2\nangle = 20"),
    ("panorama", "center = [0, 0, 0]\nradius = 3\nheight = 2"),
    ("hinge", "POSE\nvfov = 30\npath = 1.5\nangle = 25"),
    ("surround", "radius = 3\nlevel = 1"),
    ("mcop", "path = [{ eye = [-1, 0, 4], target = [-0.9, 0, 0] }, { eye = [1, 0.3, 4], target = [0.9, 0.1, 0] }]\nvfov = 30"),
    ("mcop", "circle = { radius = 3 }\nvfov = 40\nt_range = [0, 2.5]"),
    (
        "projector",
        "surfaces = [{ kind = 'sphere', center = [0, 0, 0], radius = 3, lon = [-60, 60], lat = [40, -40] },
         { kind = 'plane', origin = [-1, 1, -1], u = [2, 0, 0], v = [0, -2, 0] }]",
    ),
    (
        "projector",
        "surfaces = [{ kind = 'cylinder', center = [0, 0, 0], axis = [0, 1, 0], radius = 3, height = -3, from = 60, to = -70 },
         { kind = 'point', at = [0.1, 0.2, 1.5] },
         { kind = 'plane', origin = [-2, 2, -1], u = [4, 0, 0], v = [0, -4, 0] }]\nreparam = { kind = 'polar' }",
    ),
    ("irregular_perspective", "vfov = 40"),
    ("irregular_perspective", "convergence = [[1, 1], [0, 1], [0.5, 0], [1, -0.5]]"),
    ("twist", "angle = 60"),
    ("twist", "angle = 80\ndegree = 2"),
    ("twist", "angle = 200\ndegree = 3"),
    ("curved_convergence", "bend = [0.3, 0.1]"),
    ("ortho_to_perspective", "vfov = 40"),
    ("occlusion", "vfov = 40\nnear = 3.4\nfar = 4.4\ndistortion = [0.02, 0.1]"),
    ("occlusion", "vfov = 40\nnear = 3.4\nfar = 4.4\ndistortion = [0, 0.1]\njoin = 'bezier'"),
    ("street", "facade = 4"),
    ("street", "facade = 4\nviews = [{ at = 0.5, width = 0.4, angle = 40 }]"),
    ("fisheye", "POSE\nfov = 60"),
    ("fisheye", "POSE\nfov = 40\nframe = 'full'\nmapping = 'stereographic'"),
    ("sphere", "eye = [0, 0, 1.2]\ntarget = [0, 0, 0]"),
    ("sphere", "eye = [0, 0, 1.2]\ntarget = [0, 0, 0]\nstrips = 12"),
    ("cylinder", "eye = [0, 0.1, 1.2]\ntarget = [0, 0.1, 0]\nvfov = 80"),
    ("cylinder", "eye = [0, 0.1, 1.2]\ntarget = [0, 0.1, 0]\nstrips = 8\nvfov = 80"),
    ("panorama", "center = [0, 0, 0]\nradius = 3\nheight = 2\npieces = 12"),
    ("fisheye", "POSE\nfov = 60\nframe = 'full'\npieces = 'auto'\nerror = 0.5"),
    (
        "chain",
        "layers = [
         { vertices = [
             { image = [0, 0], near = [-0.6, 0.5, 1.2], far = [-1, 0.8, 0.1] }, { image = [1, 0], near = [0.6, 0.5, 1.2], far = [1, 0.8, 0.1] },
             { image = [0, 1], near = [-0.6, -0.5, 1.2], far = [-1, -0.8, 0.3] }, { image = [1, 1], near = [0.6, -0.5, 1.2], far = [1, -0.9, 0] }],
           triangles = [[0, 1, 2], [1, 3, 2]] },
         { vertices = [
             { image = [0, 0], near = [-1, 0.8, 0.1], far = [-0.8, 0.6, -1] }, { image = [1, 0], near = [1, 0.8, 0.1], far = [0.8, 0.5, -1] },
             { image = [0, 1], near = [-1, -0.8, 0.3], far = [-0.8, -0.6, -1] }, { image = [1, 1], near = [1, -0.9, 0], far = [0.7, -0.6, -1.2] }],
           triangles = [[0, 1, 2], [1, 3, 2]] }]",
    ),
    ("bottom_up", "VIEWS\nfar = 6"),
    ("bottom_up", "VIEWS\nfar = 6\nforeground = true\njoin = 'bezier'"),
    ("graph_camera", "VIEWS\nfar = 6"),
    ("top_down", "POSE\nvfov = 30\nregions = [{ rect = [0.15, 0.2, 0.45, 0.7], eye = [-0.7, 1.2, 3.5] }]\nband = 0.1\nfar = 6"),
    (
        "top_down",
        "POSE\nvfov = 30\nregions = [{ rect = [0.15, 0.2, 0.45, 0.7], eye = [-0.7, 1.2, 3.5] }]\nband = 0.1\nfar = 6\nforeground = true\njoin = 'bezier'",
    ),
    ("track", "eye = [0, 0.3, 4]\ntarget = [0, 0, 0]\nvfov = 30\ntargets = [{ at = [0, 0, 0], radius = 0.05 }]\nfar = 6"),
    ("track", "eye = [0, 0.3, 4]\ntarget = [0, 0, 0]\nvfov = 30\ntargets = [{ at = [0, 0, 0], radius = 0.05 }]\nfar = 6\njoin = 'bezier'"),
    ("opencv", "POSE\nfile = 'FOLDER/camera.yml'"),
    ("opencv", "POSE\nfile = 'FOLDER/camera.yml'\nline_time = 0.001\nvelocity = [10, 0, 3]\nangular_velocity = [0, 90, 0]"),
    ("calibrated", "POSE\nfile = 'FOLDER/rig.json'"),
    ("ods", "eye = [0, 0.1, 0.9]\ntarget = [0, 0, 0]\nipd = 0.3"),
    ("camera_texture", "POSE\nvfov = 30\nOFFSETS"),
    ("camera_texture", "POSE\nvfov = 30\nOFFSETS\nmode = 'bilinear'"),
    ("panini", "POSE\nfov = 50"),
    ("panini", "POSE\nfov = 40\ns = 0.7"),
    ("display", "eye = [0, 0.1, 4]\nmesh = 'FOLDER/screen.obj'"),
    ("lightfield", "center = [0, 0, 1.5]\nnormal = [0, 0, 1]\nwidth = 2\nheight = 1.5\nviews = [5, 4]\nfov = 20"),
    (
        "composite",
        "cameras = [
         { camera = { kind = 'pinhole', eye = [0.2, 0.3, 4], target = [0, 0, 0], vfov = 30 }, region = { kind = 'rectangle', from = [0, 0], to = [0.52, 0.7] } },
         { camera = { kind = 'fisheye', eye = [0.2, 0.3, 4], target = [0, 0, 0], fov = 60, frame = 'full' }, frame = 'region', region = { kind = 'rectangle', from = [0.52, 0], to = [1, 1] } },
         { camera = { kind = 'orthographic', eye = [0.2, 0.3, 4], target = [0, 0, 0], height = 2 } }]",
    ),
    (
        "composite",
        "cameras = [
         { camera = { kind = 'pinhole', eye = [0.2, 0.3, 4], target = [0, 0, 0], vfov = 30, t_range = [0, 9] }, region = { kind = 'rectangle', from = [0, 0], to = [0.52, 0.7] } },
         { camera = { kind = 'twist', angle = 80, degree = 2 } }]",
    ),
];

const VIEWS: &str = "views = [{ eye = [-0.3, 0.2, 4], target = [-0.7, 0, 0], vfov = 30 }, { eye = [0.3, 0.4, 4], target = [0.7, 0, 0], vfov = 30 }]";

const OFFSETS: &str =
    "offsets = [[[0, 0], [0.05, 0], [0, 0]], [[0, 0.03], [0.1, -0.05], [0, 0]], [[0, 0], [0.02, 0.05], [0, 0]]]";

fn keys(of: &str, folder: &Path) -> String {
    let words = [("POSE", POSE), ("VIEWS", VIEWS), ("OFFSETS", OFFSETS), ("FOLDER", folder.to_str().unwrap())];
    words.iter().fold(of.to_string(), |text, (word, by)| text.replace(word, by))
}

/// The keys of all these cameras, whose files are in a folder.
pub(crate) fn all_keys(folder: &Path) -> Vec<String> {
    keys_with_pose(folder, POSE)
}

/// The same, those that have a pose with another one.
pub(crate) fn keys_with_pose(folder: &Path, pose: &str) -> Vec<String> {
    std::fs::write(folder.join("camera.yml"), CALIBRATED).unwrap();
    std::fs::write(folder.join("rig.json"), F_THETA).unwrap();
    std::fs::write(folder.join("screen.obj"), SCREEN).unwrap();
    ASKED
        .iter()
        .map(|(kind, asked)| format!("kind = '{kind}'\n{}", keys(&asked.replace("POSE", pose), folder)))
        .collect()
}

/// The keys of cameras of the kinds whose projection is tested elsewhere: eyes, GLCs of every class, pieces, and tables of rays.
pub(crate) fn plain_keys(folder: &Path) -> Vec<String> {
    let three = |corners: [DVec3; 3]| corners.map(|p| p.to_array());
    let glcs = corners_of_each_class().into_iter();
    let glcs = glcs.map(|(_, near, far)| format!("kind = 'glc'\nnear = {:?}\nfar = {:?}", three(near), three(far)));
    let mesh = mesh_spec(3, 5, 4, MeshShape { weights: true, ..MeshShape::default() });
    let vertex = |v: &CameraVertex| {
        let (near, far) = (v.near.to_array(), v.far.to_array());
        format!("{{ image = {:?}, near = {near:?}, far = {far:?}, w = {:?} }}", v.image, v.w)
    };
    let vertices: Vec<String> = mesh.vertices.iter().map(vertex).collect();
    let rays = raymap(SIZE.0, SIZE.1, FORWARD);
    let pixels = (0..SIZE.1).flat_map(|j| (0..SIZE.0).map(move |i| (i, j)));
    let rays = pixels.map(|(i, j)| rays.ray(i, j).map_or([DVec3::NAN; 2], |ray| [ray.origin, ray.direction]));
    let rays: Vec<[DVec3; 2]> = rays.collect();
    for (k, name) in ["origins", "directions"].iter().enumerate() {
        let numbers: Vec<f64> = rays.iter().flat_map(|ray| ray[k].to_array()).collect();
        let shape = [SIZE.1.into(), SIZE.0.into(), 3];
        write_npy_f64(&folder.join(format!("{name}.npy")), &shape, &numbers).unwrap();
    }
    let numbers: Vec<f64> = rays.iter().flatten().flat_map(|p| p.to_array()).collect();
    write_npy_f64(&folder.join("rays.npy"), &[rays.len() as u64, 6], &numbers).unwrap();
    let own = [
        format!("kind = 'pinhole'\n{POSE}\nvfov = 30"),
        format!("kind = 'orthographic'\n{POSE}\nheight = 2"),
        format!("kind = 'mesh'\nvertices = [{}]\ntriangles = {:?}", vertices.join(", "), mesh.triangles),
        keys("kind = 'raymap'\norigins = 'FOLDER/origins.npy'\ndirections = 'FOLDER/directions.npy'", folder),
        keys("kind = 'lidar'\nfile = 'FOLDER/rays.npy'", folder),
    ];
    glcs.chain(own).collect()
}

/// The cameras of one share of the list, so that the shares are tested side by side.
fn share(first: usize) {
    let folder = tempfile::tempdir().unwrap();
    let texts = all_keys(folder.path());
    for (k, (kind, asked)) in ASKED.iter().enumerate().skip(first).step_by(2) {
        let text = &texts[k];
        let camera = camera_of(BOX, SIZE, text).unwrap_or_else(|e| panic!("{text}: {e}"));
        let start = std::time::Instant::now();
        let counts = check(&format!("{kind}: {asked}"), &camera, k as u64);
        println!("{:6.2} s  {kind}: {counts:?}", start.elapsed().as_secs_f64());
        assert!(counts[1..].iter().sum::<usize>() > 13, "{kind}: {asked}: {counts:?}");
    }
}

#[test]
#[ignore = "slow: make test-all"]
fn every_other_named_camera() {
    share(0);
}

#[test]
fn every_named_camera_between_them() {
    share(1);
}

#[test]
fn the_ray_of_a_shot_is_seen_all_over_its_pixel() {
    let text = "kind = 'lidar'\neye = [0.2, 0.3, 4]\ntarget = [0, 0, 0]\nbeams = [12, 5, 0, -7]\ncolumns = 20\nstart = -15\nsweep = 30\n\
                period = 0.1\nvelocity = [1, 0, 0]";
    let scan = camera_in(tempfile::tempdir().unwrap().path(), text, None).unwrap();
    let projector = Projector::new(&scan);
    for (i, j) in (0..4).flat_map(|j| (0..20).map(move |i| (i, j))) {
        let ray = scan.ray(i, j).unwrap();
        let point = ray.origin + 3.7 * ray.direction;
        assert_eq!(projector.project(point).degenerate, Some(Degenerate::Eye), "{i},{j}");
        let beside = projector.project(point + DVec3::new(1e-3, 1e-3, 0.0));
        assert!(beside.images.is_empty() && beside.degenerate.is_none() && !beside.incomplete, "{i},{j}: {beside:?}");
    }
}

#[test]
fn no_kind_is_left_out() {
    // points are not sought behind mirrors and lenses: the command refuses these
    let separate = ["lidar", "reflection", "refraction"];
    let elsewhere = ["pinhole", "orthographic", "glc", "mesh", "raymap"];
    let asked = |name: &str| {
        separate.contains(&name) || elsewhere.contains(&name) || ASKED.iter().any(|(kind, _)| *kind == name)
    };
    let missing: Vec<&str> = KINDS.iter().map(|k| k.name).filter(|n| !asked(n)).collect();
    assert!(missing.is_empty(), "{missing:?} have no case here");
}
