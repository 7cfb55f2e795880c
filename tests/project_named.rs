//! Projection agrees with coverage for every camera with a name.

mod common;

use anamorph::camera::kinds::NAMED;
use common::projection::check;
use common::written::camera;

const SIZE: (u32, u32) = (60, 44);

/// A viewer in front of the cube that the tests' points are in.
const POSE: &str = "eye = [0.2, 0.3, 4]\ntarget = [0, 0, 0]";

/// Kinds and what they are asked for; every kind of the program at least once.
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
];

#[test]
fn every_named_camera() {
    for (k, (kind, keys)) in ASKED.iter().enumerate() {
        let text = format!("kind = '{kind}'\n{}", keys.replace("POSE", POSE));
        let counts = check(&format!("{kind}: {keys}"), &camera(&text, SIZE), k as u64);
        assert!(counts[1..].iter().sum::<usize>() > 20, "{kind}: {keys}: {counts:?}");
    }
}

#[test]
fn no_kind_is_left_out() {
    let missing: Vec<&str> =
        NAMED.iter().map(|k| k.name).filter(|n| !ASKED.iter().any(|(kind, _)| kind == n)).collect();
    assert!(missing.is_empty(), "{missing:?} have no case here");
}
