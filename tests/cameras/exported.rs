//! Exported cameras, read back, have the same rays.

use crate::common;
use anamorph::internals::input::Loading;

use anamorph::internals::camera::{Camera, Rays};
use common::rng::Rng;
use glam::DVec3;
use std::path::Path;
use std::process::Command;

const SIZE: (u32, u32) = (48, 36);

/// Roundings of a ray on its way: into the bundle (8), to the corners (6), into a bundle again (8) and to the pixel (6),
/// with a margin for the sums of three corners; each of 2^-53 of the corners' largest numbers, times how slender the piece is.
const ROUNDING: f64 = 64.0 / (1u64 << 53) as f64;

fn run(dir: &Path, args: &[&str]) -> (bool, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_anamorph")).args(args).current_dir(dir).output().unwrap();
    (output.status.success(), String::from_utf8_lossy(&output.stderr).into_owned())
}

/// Longest side squared over twice the area: at least 1, large for slender triangles.
fn slenderness(corners: [glam::DVec2; 3]) -> f64 {
    let [a, b, c] = corners;
    let longest = (b - a).length_squared().max((c - b).length_squared()).max((a - c).length_squared());
    longest / (b - a).perp_dot(c - a).abs()
}

/// Rounding of any of the camera's rays, world units.
fn bound(camera: &Camera) -> f64 {
    let of_layer = |layer: &Rays| {
        let Rays::Pieces(pieces) = layer else { panic!("pieces") };
        let of_piece = |piece: &anamorph::internals::camera::Piece| {
            let whole = [(0.0, 0.0), (SIZE.0 as f64, 0.0), (0.0, SIZE.1 as f64)].map(glam::DVec2::from);
            let corners = piece.corners_px.unwrap_or(whole);
            let largest = |q: &glam::DVec2| {
                let ray = piece.bundle.ray(q.x - piece.centre_px.x, q.y - piece.centre_px.y);
                ray.origin.abs().max_element() + ray.direction.abs().max_element()
            };
            let h = corners.map(|q| {
                let at = q - piece.centre_px;
                piece.bundle.h[0] + at.x * piece.bundle.h[1] + at.y * piece.bundle.h[2]
            });
            let weights = h.iter().fold(0.0f64, |m, w| m.max(*w)) / h.iter().fold(f64::INFINITY, |m, w| m.min(*w));
            corners.iter().map(largest).fold(0.0, f64::max) * weights * slenderness(corners)
        };
        pieces.pieces.iter().map(of_piece).fold(0.0, f64::max)
    };
    ROUNDING * camera.layers.iter().map(of_layer).fold(0.0, f64::max)
}

/// Exports the camera of `table` and reads it back as a mesh camera, or a chain of several layers.
fn there_and_back(dir: &Path, table: &str) -> (Camera, Camera) {
    let original = common::written::camera_in(dir, table, Some(SIZE)).unwrap_or_else(|e| panic!("{table}: {e}"));
    let size = format!("{}x{}", SIZE.0, SIZE.1);
    let (works, err) = run(dir, &["camera", "written.toml", "--size", &size, "--export", "p.json"]);
    assert!(works, "{table}: {err}");
    let back = if original.layers.len() == 1 {
        common::written::camera_in(dir, "kind = \"mesh\"\nfile = \"p.json\"", Some(SIZE)).unwrap()
    } else {
        let layers: serde_json::Value =
            serde_json::from_str(&std::fs::read_to_string(dir.join("p.json")).unwrap()).unwrap();
        let camera = serde_json::json!({ "camera": { "kind": "chain", "layers": layers["layers"] } });
        std::fs::write(dir.join("chain.json"), camera.to_string()).unwrap();
        let scene =
            anamorph::internals::scene::Scene::load(&dir.join("chain.json"), &[], 0.0, &Loading::default()).unwrap();
        Camera::in_scene(&scene.camera, Some(SIZE), &scene.mesh, &Loading::default()).unwrap()
    };
    (original, back)
}

/// Kinds that compile to pieces.
const CAMERAS: &[&str] = &[
    "kind = \"pinhole\"\neye = [1, 2, 8]\ntarget = [0, 0, 0]\nvfov = 40",
    "kind = \"orthographic\"\neye = [1, 2, 8]\ntarget = [0, 0, 0]\nheight = 6",
    "kind = \"glc\"\nnear = [[-1, 1, 2], [1, 1, 2], [-1, -1, 2.5]]\nfar = [[-3, 2, -2], [3, 2, -1], [-3, -2, -2]]",
    "kind = \"panorama\"\nradius = 9\nheight = 5\npieces = 12",
    "kind = \"fisheye\"\neye = [0, 1, 9]\ntarget = [0, 0, 0]\nfov = 150\nframe = \"full\"\npieces = 60",
    "kind = \"sphere\"\neye = [0, 1, 9]\ntarget = [0, 0, 0]\nstrips = 8",
    "kind = \"cylinder\"\neye = [0, 1, 9]\ntarget = [0, 0, 0]\nstrips = 8",
    "kind = \"pushbroom\"\nstart = [-4, 1, 6]\nend = [4, 1, 6]\nlook = [0, 0, -1]\nvfov = 40",
    "kind = \"surround\"\nradius = 6\nlevel = 1",
    "kind = \"twist\"\neye = [0, 0, 8]",
    "kind = \"mesh\"\nnormalize = true\nvertices = [{ image = [0, 0], near = [0, 0, 1], far = [0, 0, 0], w = 2 }, \
     { image = [1, 0], near = [1, 0, 1], far = [1, 0.5, 0] }, { image = [0, 1], near = [0, 1, 1], far = [0, 1, -3], w = 0.3 }]\n\
     triangles = [[0, 1, 2]]",
    "kind = \"chain\"\nlayers = [{ vertices = [{ image = [0, 0], near = [0, 0, 5], far = [0, 0, 0], w = 2 }, \
     { image = [1, 0], near = [0, 0, 5], far = [1, 0, 0] }, { image = [0, 1], near = [0, 0, 5], far = [0, 1, 1] }], \
     triangles = [[0, 1, 2]] }, { vertices = [{ image = [0, 0], near = [0, 0, 0], far = [0, 0, -9], w = 2 }, \
     { image = [1, 0], near = [1, 0, 0], far = [1, 0.5, -9] }, { image = [0, 1], near = [0, 1, 1], far = [0, 1, -3] }], \
     triangles = [[0, 1, 2]] }]",
];

#[test]
fn pieces_read_back_have_the_same_rays() {
    let dir = tempfile::tempdir().unwrap();
    let mut rng = Rng(7);
    for table in CAMERAS {
        let (original, back) = there_and_back(dir.path(), table);
        assert_eq!(original.layers.len(), back.layers.len(), "{table}");
        let bound = bound(&original);
        let mut seen = 0;
        for layer in 0..original.layers.len() {
            for _ in 0..300 {
                let (i, j) = (rng.below(SIZE.0 as usize) as u32, rng.below(SIZE.1 as usize) as u32);
                let ray = |camera: &Camera| camera.pixel(layer, i, j).map(|(_, bundle)| bundle.ray(0.0, 0.0));
                let (Some(a), Some(b)) = (ray(&original), ray(&back)) else {
                    assert!(ray(&original).is_none() && ray(&back).is_none(), "{table}: pixel {i},{j}");
                    continue;
                };
                seen += 1;
                let off = |p: DVec3, q: DVec3| (p - q).abs().max_element();
                let worst = off(a.origin, b.origin).max(off(a.direction, b.direction));
                assert!(worst <= bound, "{table}: pixel {i},{j}: {worst:e} is over {bound:e}");
            }
        }
        assert!(seen > 100, "{table}: {seen}");
    }
}

#[test]
fn vertices_that_are_equal_are_one() {
    let dir = tempfile::tempdir().unwrap();
    there_and_back(dir.path(), CAMERAS[0]);
    let json: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(dir.path().join("p.json")).unwrap()).unwrap();
    assert_eq!(json["vertices"].as_array().unwrap().len(), 4);
    assert_eq!(json["triangles"], serde_json::json!([[0, 1, 2], [2, 1, 3]]));
}

#[test]
fn cameras_without_pieces_are_refused() {
    let dir = tempfile::tempdir().unwrap();
    for (table, says) in [
        (
            "kind = \"fisheye\"\neye = [0, 0, 9]\ntarget = [0, 0, 0]\nfov = 150",
            "fisheye has no pieces but a ray for each pixel",
        ),
        ("kind = \"occlusion\"\neye = [0, 0, 9]", "occlusion has no pieces but a ray for each pixel"),
        (
            "kind = \"curved_convergence\"\neye = [0, 0, 9]",
            "curved_convergence has no pieces but a curve for each pixel",
        ),
    ] {
        std::fs::write(dir.path().join("s.toml"), format!("[camera]\n{table}\n")).unwrap();
        let (works, err) = run(dir.path(), &["camera", "s.toml", "--size", "40x30", "--export", "p.json"]);
        assert!(!works && err.contains(says) && err.contains("use --rays"), "{err}");
        assert!(!dir.path().join("p.json").exists());
    }
}
