//! An oracle of others' making: POV-Ray 3.7 traces the very rays of a camera and meets the triangles that the reference says
//! are seen, as Yu et al. 2009 compared theirs (4.4, Figure 5). Nothing to do without a `povray` of that version.

use crate::common;

use anamorph::internals::camera::Camera;
use anamorph::internals::image::compare::{Comparison, compare};
use anamorph::internals::image::frame::{Channel, Frame, NO_ID, Plane};
use anamorph::internals::reference::image::judge;
use anamorph::internals::scene::Scene;
use std::ops::Range;
use std::path::Path;
use std::process::Command;

/// A ball, a cylinder and a box on a floor, through two slits: the bench's stand-in for the figure.
const PRIMITIVES: &str = include_str!("../../lab/src/bench/scenes/primitives.toml");

/// Cameras that look at them: other linear ones, a field with pixels without rays, pieces.
const CAMERAS: &[(&str, &str)] = &[
    (
        "bilinear",
        "kind = \"glc\"\nnear = [[-2.4, 2.6, 6], [2.4, 1.8, 6], [-1.6, 0.2, 6]]\n\
         far = [[-3.4, 1.8, -2], [3.2, 2.4, -2], [-3.6, -1.6, -2]]",
    ),
    ("pencil", "kind = \"pencil\"\neye = [0, 2, 9]\ntarget = [0, -0.2, 0]\nvfov = 36\nslit = 0.5\nangle = 60"),
    ("fisheye", "kind = \"fisheye\"\neye = [0.4, 1.6, 2.6]\ntarget = [0, -0.3, 0]\nfov = 170"),
    (
        "fisheye in pieces",
        "kind = \"fisheye\"\neye = [0, 1, 6]\ntarget = [0, -0.2, 0]\nfov = 70\nframe = \"full\"\npieces = 12",
    ),
    ("panorama", "kind = \"panorama\"\nradius = 6\nelevation = 1\nheight = 4\npieces = 6"),
    // starts behind the eye, ends in the scene
    ("slices", "kind = \"orthographic\"\neye = [1, 2, 0.4]\ntarget = [0, 0, 0]\nheight = 5\nt_range = [-0.5, 2.25]"),
    ("behind", "kind = \"pinhole\"\neye = [0, 0.3, 0]\ntarget = [0, 0.1, -1]\nvfov = 50\nt_range = [-6, inf]"),
];

/// The scene of the text in an image of this size, and its camera.
fn small(text: &str, size: (u32, u32)) -> (Scene, Camera) {
    let mut scene = common::file::load(text).unwrap();
    scene.size = Some(size);
    let camera = scene.camera().unwrap_or_else(|e| panic!("{text}: {e}"));
    (scene, camera)
}

/// POV-Ray 3.7 is there; says so where it is not.
fn has_povray() -> bool {
    let printed = Command::new("povray").arg("--version").output();
    let found = printed.is_ok_and(|printed| {
        String::from_utf8_lossy(&[printed.stdout, printed.stderr].concat()).contains("POV-Ray 3.7")
    });
    if !found {
        common::needs::skip("no povray 3.7 on this machine");
    }
    found
}

/// What POV-Ray sees in the scene of the text: exported by the program, rendered by the command that the file says.
fn traced(text: &str, (width, height): (u32, u32)) -> Frame {
    let folder = tempfile::tempdir().unwrap();
    let run = |program: &str, args: &[&str]| {
        let output = Command::new(program).args(args).current_dir(folder.path()).output().unwrap();
        assert!(output.status.success(), "{program} {args:?}: {}", String::from_utf8_lossy(&output.stderr));
    };
    std::fs::write(folder.path().join("s.toml"), text).unwrap();
    let size = format!("{width}x{height}");
    run(env!("CARGO_BIN_EXE_anamorph"), &["camera", "s.toml", "--size", &size, "--export-povray", "s.pov"]);
    let scene = std::fs::read_to_string(folder.path().join("s.pov")).unwrap();
    let command = scene.lines().find_map(|l| l.strip_prefix("// povray ")).unwrap().replace('"', "");
    run("povray", &command.split(' ').collect::<Vec<_>>());
    let ids = ids(&folder.path().join("s.png"), (width, height));
    Frame { width, height, planes: vec![(Channel::TriangleId, Plane::U32(ids))] }
}

/// The ids in a picture that has one row too many on top.
fn ids(picture: &Path, (width, height): (u32, u32)) -> Vec<u32> {
    let picture = image::open(picture).unwrap().into_rgb8();
    assert_eq!(picture.dimensions(), (width, height + 1));
    let id = |p: &image::Rgb<u8>| if p.0 == [255; 3] { NO_ID } else { u32::from_le_bytes([p[0], p[1], p[2], 0]) };
    picture.pixels().skip(width as usize).map(id).collect()
}

/// The frame against the reference, and how many pixels name no near candidate.
fn against(scene: &Scene, camera: &Camera, frame: &Frame) -> (Comparison, u64) {
    let judged = judge(scene, camera, frame);
    (compare(frame, &judged.truth, Some(&judged.safe), None).unwrap(), judged.not_near)
}

/// Asserts that POV-Ray sees what the reference says, and that it would be noticed if it did not. What it sees.
fn assert_agrees(name: &str, text: &str, size: (u32, u32)) -> Frame {
    let (scene, camera) = small(text, size);
    let frame = traced(text, size);
    let hits = common::gpu::hits(&frame);
    assert!(hits > 1000, "{name}: {hits} hits");
    // P is the reference's to the last bit and D to some of them, 1e-15; a safe pixel has the same answer for every ray within
    // 1/16 px, 1e-4 and more, and no second hit within 1e-6 of t: none may differ
    let (seen, not_near) = against(&scene, &camera, &frame);
    println!("{name}: {hits} hits; {seen}; {not_near} not near");
    assert_eq!((seen.wrong_safe, not_near), (Some(0), 0), "{name}: {seen}");
    // shifted by half a pixel it is another camera
    let (seen, not_near) = against(&scene, &camera.with_sample_offset(0.5, 0.0), &frame);
    assert!(seen.wrong_safe > Some(0) && not_near > 0, "{name}: {seen}");
    frame
}

#[test]
fn the_figure_of_three_solids_is_the_same() {
    if has_povray() {
        assert_agrees("cross-slit", PRIMITIVES, (200, 150));
    }
}

#[test]
fn every_kind_of_straight_rays_is_the_same() {
    if !has_povray() {
        return;
    }
    let (solids, _) = PRIMITIVES.split_once("[camera]").unwrap();
    for (name, camera) in CAMERAS {
        assert_agrees(name, &format!("{solids}[camera]\n{camera}\n"), (160, 120));
    }
}

#[test]
fn unseen_sides_and_coincident_triangles_are_the_same() {
    if !has_povray() {
        return;
    }
    // a box whose sides are not seen from within, and a ball twice: the first from outside alone
    let solids = "[[mesh]]\nbuiltin = \"box\"\ntwo_sided = false\nscale = 4\nrotate = [10, 20, 0]\n\
                  [[mesh]]\nbuiltin = \"icosphere\"\nlevel = 2\ntwo_sided = false\n\
                  [[mesh]]\nbuiltin = \"icosphere\"\nlevel = 2\n\
                  [[mesh]]\nbuiltin = \"plane\"\nsize = 9\ndivisions = 4\ntranslate = [0, -3, 0]\n";
    let (first, second) = (12..332, 332..652);
    for (camera, seen, unseen) in [
        ("kind = \"fisheye\"\neye = [0.3, 0.4, 1.6]\ntarget = [0, 0, 0]\nfov = 180\nframe = \"full\"", &first, &second),
        ("kind = \"pinhole\"\neye = [0.3, 0.4, 0.5]\ntarget = [0, 0, 0]\nvfov = 100", &second, &first),
    ] {
        let frame = assert_agrees(camera, &format!("{solids}[camera]\n{camera}\n"), (160, 120));
        let pixels = |of: &Range<u32>| common::gpu::ids(&frame).iter().filter(|&id| of.contains(id)).count();
        assert!(pixels(seen) > 1000 && pixels(unseen) == 0, "{camera}: {} {}", pixels(seen), pixels(unseen));
    }
}
