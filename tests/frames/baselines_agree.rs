//! The rivals: exact ones against the reference by margin, the others by an error that falls with their number. Nothing to do
//! without an adapter.

use crate::common;

use anamorph::internals::engine::RunOptions;
use anamorph::internals::engine::plan::Wanted;
use anamorph::internals::engine::rival::{Choice, Technique};
use anamorph::internals::image::frame::{Channel, NO_ID};
use anamorph::internals::reference::image::judge;
use anamorph::internals::scene::Scene;
use anamorph::internals::scene::light::Light;
use anamorph_lab::rivals::TECHNIQUES;
use common::file::load;
use common::gpu::{Without, engine, hits, wanted};
use glam::DVec3;
use std::sync::Arc;

/// A ball, a box that only its outside is visible of, a teapot and a floor; all within 3 of the origin.
const THINGS: &str = r#"
[[mesh]]
builtin = "plane"
size = 6
divisions = 3
translate = [0, -1, 0]
[[mesh]]
builtin = "icosphere"
level = 2
scale = 0.7
translate = [-1.1, -0.2, 0.4]
[[mesh]]
builtin = "teapot"
level = 3
scale = 0.4
translate = [0.9, -1, -0.6]
[[mesh]]
builtin = "box"
two_sided = false
scale = 0.4
rotate = [10, 30, 0]
translate = [0.3, -0.5, 1.2]
"#;

const SLITS: &str = r#"
kind = "cross_slit"
slits = [{ distance = 9, angle = 90 }, { distance = 5, angle = 0 }]
eye = [0, 1.6, 5]
target = [0, -0.2, 0]
height = 2.6
"#;

const RING: &str = "kind = \"panorama\"\nradius = 4\nelevation = 1.2\nheight = 2.6\npieces = 6";

/// Bilinear pieces, all of the scene in front of them.
const PIECES: &str =
    "kind = \"fisheye\"\neye = [0, 1, 6]\ntarget = [0, -0.2, 0]\nfov = 60\nframe = \"full\"\npieces = 12";

const STRIPS: &str = "kind = \"cylinder\"\neye = [0.1, 0.4, 2.2]\ntarget = [0, 0.2, 0]\ntan = [-1.2, 0.8]\nstrips = 24";

const FISHEYE: &str = "kind = \"fisheye\"\neye = [0, 0.5, 3]\ntarget = [0, -0.2, 0]\nfov = 120";

const CURVED: &str = "kind = \"twist\"\neye = [0, 1.2, 4]\nvfov = 40\ndegree = 3\nangle = 70";

const CHAIN: &str = "kind = \"occlusion\"\neye = [0, 1.2, 5]\nvfov = 40\nnear = 4\nfar = 6\ndistortion = [0.05, 0.1]";

fn scene(camera: &str) -> Scene {
    load(&format!("image = {{ width = 96, height = 72 }}\n{THINGS}\n[camera]\n{camera}")).unwrap()
}

/// Two cameras one behind the other, as in a graph camera.
const GRAPH: &str = r#"
kind = "graph_camera"
views = [
  { eye = [-0.4, 0.6, 3], target = [-1, -0.2, 0], vfov = 50 },
  { eye = [0.4, 0.6, 3], target = [1, -0.2, 0], vfov = 50 },
]
weights = [2, 1, 2]
"#;

/// A plain view in layers one behind the other, each of pinhole pieces: a detour round the ball, not bent.
const LAYERS: &str = r#"
kind = "track"
eye = [0, 1.2, 5]
target = [0, -0.2, 0]
vfov = 40
targets = [{ at = [-1.1, 0.1, -0.9], radius = 0.2 }]
segments = 9
morph = 0
"#;

/// What a rival makes of the scene against the reference: pixels with another triangle, those of them that are safe, and those
/// that name no near candidate; `None` without an adapter.
fn wrong(camera: &str, by: &str) -> Option<(u64, u64, u64)> {
    wrong_in(&scene(camera), by)
}

fn wrong_in(scene: &Scene, by: &str) -> Option<(u64, u64, u64)> {
    let camera = scene.camera().unwrap();
    let mut engine = engine(&camera, Without::Nothing)?;
    let run = RunOptions { rival: Some(anamorph_lab::rivals::parse(by).unwrap()), ..Default::default() };
    let frame = engine.render(scene, &camera, &wanted(), &run).unwrap().frame;
    assert!(hits(&frame) > 1000, "{by}: {} hits", hits(&frame));
    let judged = judge(scene, &camera, &frame);
    let seen =
        anamorph::internals::image::compare::compare(&frame, &judged.truth, Some(&judged.safe), Some(&judged.scales))
            .unwrap();
    println!("{by}: {seen}, {} not near", judged.not_near);
    Some((seen.wrong_triangle.unwrap(), seen.wrong_safe.unwrap(), judged.not_near))
}

#[test]
fn ray_tracing_is_right_at_every_safe_pixel() {
    for camera in [SLITS, RING, FISHEYE, CHAIN] {
        for by in ["raytrace", "raytrace-brute", "raytrace-refit"] {
            let Some((_, safe, not_near)) = wrong(camera, by) else { return };
            assert_eq!((safe, not_near), (0, 0), "{by}: {camera}");
        }
    }
}

/// Rays start some 400 units from triangles of a tenth of a unit: a product of two such distances is rounded by as much as a triangle's area.
#[test]
fn ray_tracing_is_right_for_small_triangles_far_from_where_rays_start() {
    let city = "image = { width = 128, height = 96 }\nmesh = [{ builtin = \"city\", seed = 3, blocks = 12, triangles = 100000 }]\n\
                camera = { kind = \"cross_slit\", slits = [{ distance = 400, angle = 90 }, { distance = 40, angle = 0 }], \
                eye = [-36, 20, 50], target = [-10, 9.5, 15], height = 4 }";
    let Some((_, safe, not_near)) = wrong_in(&load(city).unwrap(), "raytrace") else { return };
    assert_eq!((safe, not_near), (0, 0));
}

#[test]
fn bounding_triangles_are_exact_where_they_hold_their_images() {
    for camera in [SLITS, PIECES, STRIPS] {
        for by in ["raster-bound", "raster-bound-passes"] {
            let Some((_, safe, not_near)) = wrong(camera, by) else { return };
            assert_eq!((safe, not_near), (0, 0), "{by}: {camera}");
        }
    }
}

#[test]
fn perspective_pieces_are_as_right_as_the_rasterizer_places_vertices() {
    // a rasterizer snaps vertices to 1/256 px, far under the 1/16 px of a safe pixel
    let many = STRIPS.replace("strips = 24", "strips = 300");
    for camera in [STRIPS, &many, GRAPH] {
        let Some((_, safe, not_near)) = wrong(camera, "raster-pieces") else { return };
        assert_eq!((safe, not_near), (0, 0), "{camera}");
    }
}

/// Triangles here have one colour each, so pixels differ by which triangles their samples see alone. The rasterizer snaps vertices to 1/256 px:
/// an edge is moved past a sample that is nearer than sqrt(2)/256 px, as one in 90 is, so past some of four in 4.4 % of the pixels that one
/// edge crosses, and in 8.8 % of those that two cross.
#[test]
fn multisampling_takes_the_same_four_samples_as_this_engine() {
    let many = STRIPS.replace("strips = 24", "strips = 300");
    for text in [STRIPS, &many] {
        let mut scene = scene(text);
        scene.lights = [DVec3::new(-1.0, -2.0, -1.0), DVec3::new(1.0, -0.5, 0.2)].map(Light::distant).to_vec();
        let mesh = Arc::make_mut(&mut scene.mesh);
        (mesh.normals, mesh.corner_normals) = (Vec::new(), Vec::new());
        let camera = scene.camera().unwrap();
        let Some(mut engine) = engine(&camera, Without::Nothing) else { return };
        let mut frame = |by: Option<&str>, samples: u32| {
            let rival = by.map(|by| anamorph_lab::rivals::parse(by).unwrap());
            let channels = vec![Channel::A, Channel::R, Channel::G, Channel::B];
            let wanted = Wanted { samples, ..Wanted::of(channels) };
            engine.render(&scene, &camera, &wanted, &RunOptions { rival, ..Default::default() }).unwrap().frame
        };
        let frames = [frame(Some("raster-pieces"), 4), frame(None, 4), frame(None, 1)];
        let colours = |f: usize, k: usize| {
            [Channel::A, Channel::R, Channel::G, Channel::B].map(|channel| frames[f].f32(channel).unwrap()[k])
        };
        let differ = |a: [f32; 4], b: [f32; 4]| a.iter().zip(b).any(|(a, b)| (a - b).abs() > 1e-4);
        let (mut edges, mut other) = (0, 0);
        for k in 0..96 * 72 {
            let is_edge = differ(colours(1, k), colours(2, k));
            edges += u32::from(is_edge);
            other += u32::from(differ(colours(0, k), colours(1, k)));
        }
        println!("{edges} edge pixels, {other} differ");
        assert!(edges > 300 && f64::from(other) < 0.088 * f64::from(edges), "{text}: {other} of {edges}");
    }
}

#[test]
fn leaving_nothing_out_early_changes_no_pixel() {
    for (camera, by) in
        [(PIECES, Some("raster-bound")), (STRIPS, Some("raster-pieces")), (RING, None), (FISHEYE, None), (CURVED, None)]
    {
        let scene = scene(camera);
        let camera = scene.camera().unwrap();
        let Some(mut engine) = engine(&camera, Without::Nothing) else { return };
        let [with, without] = [false, true].map(|no_cull| {
            let run = RunOptions {
                rival: by.map(|by| anamorph_lab::rivals::parse(by).unwrap()),
                no_cull,
                ..Default::default()
            };
            engine.render(&scene, &camera, &wanted(), &run).unwrap().frame
        });
        // what is not clipped has its t from other corners, rounded otherwise
        let seen = anamorph::internals::image::compare::compare(&without, &with, None, None).unwrap();
        println!("{by:?}: {seen}");
        assert_eq!(seen.wrong_triangle, Some(0), "{by:?}");
    }
}

/// Triangles reach through several layers, and each layer shows what lies in it alone.
#[test]
fn straight_edges_are_as_right_through_layers() {
    assert!(scene(LAYERS).camera().unwrap().layers.len() > 2);
    let Some((_, safe, not_near)) = wrong(LAYERS, "raster-warp") else { return };
    assert_eq!((safe, not_near), (0, 0));
}

/// A frame by a camera that came later is the one that it makes by itself.
#[test]
fn cameras_may_move_between_frames() {
    let changed = |camera: &str, from: &str, to: &str| (camera.to_owned(), camera.replace(from, to));
    let cases: [((String, String), &[&str]); 6] = [
        (changed(SLITS, "eye = [0, 1.6, 5]", "eye = [0.7, 1.9, 5.5]"), &["raytrace", "raster-warp:1", "raster-bound"]),
        (changed(RING, "radius = 4", "radius = 4.7"), &[]),
        (changed(PIECES, "fov = 60", "fov = 55"), &["raster-splat:4"]),
        (changed(STRIPS, "eye = [0.1, 0.4, 2.2]", "eye = [0.4, 0.6, 2.5]"), &["raster-pieces"]),
        (changed(FISHEYE, "eye = [0, 0.5, 3]", "eye = [0.4, 0.6, 3.5]"), &["raster-cubemap:64"]),
        (changed(CURVED, "angle = 70", "angle = 50"), &["raymarch-segments:4"]),
    ];
    for ((first, then), rivals) in cases {
        assert_ne!(first, then);
        for by in [None].into_iter().chain(rivals.iter().copied().map(Some)) {
            let (scene, then) = (scene(&first), self::scene(&then).camera().unwrap());
            let camera = scene.camera().unwrap();
            let run = RunOptions { rival: by.map(|by| anamorph_lab::rivals::parse(by).unwrap()), ..Default::default() };
            let Some(mut engine) = engine(&camera, Without::Nothing) else { return };
            let alone = engine.render(&scene, &then, &wanted(), &run).unwrap().frame;
            let mut frames = engine.prepare(&scene, &camera, &wanted(), &run).unwrap();
            frames.frame().unwrap();
            frames.aim(&then).unwrap();
            frames.frame().unwrap();
            let aimed = frames.finish().unwrap().frame;
            assert!(hits(&alone) > 1000, "{by:?}: {first}");
            // positions are relative to where the first camera had them: other roundings, other ties
            let judged = judge(&scene, &then, &aimed);
            let seen = anamorph::internals::image::compare::compare(&aimed, &alone, Some(&judged.safe), None).unwrap();
            println!("{by:?}: {seen}");
            assert_eq!(seen.wrong_safe, Some(0), "{by:?}: {first}");
        }
    }
}

#[test]
fn frames_of_one_camera_are_not_taken_by_one_of_another_kind() {
    let [scene, other] = [SLITS, FISHEYE].map(scene);
    let (camera, other) = (scene.camera().unwrap(), other.camera().unwrap());
    let Some(mut engine) = engine(&camera, Without::Nothing) else { return };
    let mut frames = engine.prepare(&scene, &camera, &wanted(), &RunOptions::default()).unwrap();
    let error = frames.aim(&other).unwrap_err();
    assert!(error.exit_code() == 2 && error.to_string().contains("call Engine::prepare again"), "{error}");
}

#[test]
fn the_error_of_what_approximates_falls_with_its_number() {
    let falls = |camera: &str, name: &str, numbers: &[u32], share: f64| {
        let errors: Option<Vec<u64>> = numbers.iter().map(|n| Some(wrong(camera, &format!("{name}:{n}"))?.0)).collect();
        let Some(errors) = errors else { return };
        let (first, last) = (errors[0] as f64, errors[errors.len() - 1] as f64);
        assert!(first > 0.0 && last <= share * first, "{name}: {errors:?}");
    };
    // four times as many parts a side: straight edges are off by a sixteenth
    falls(SLITS, "raster-warp", &[0, 2], 0.5);
    falls(SLITS, "raster-splat", &[2, 9], 0.5);
    falls(FISHEYE, "raster-cubemap", &[32, 256], 0.25);
    falls(FISHEYE, "raster-image", &[32, 256], 0.25);
    falls(CURVED, "raymarch-segments", &[1, 16], 0.1);
}

#[test]
fn all_glcs_at_once_and_one_by_one_are_one_picture() {
    for (one, all) in [("raster-splat-passes:5", "raster-splat:5"), ("raster-bound-passes", "raster-bound")] {
        let (Some(one), Some(all)) = (wrong(PIECES, one), wrong(PIECES, all)) else { return };
        assert_eq!(one, all);
    }
}

#[test]
fn the_rasterizer_counts_what_it_draws() {
    let scene = scene(SLITS);
    let camera = scene.camera().unwrap();
    let Some(mut engine) = engine(&camera, Without::Nothing) else { return };
    let mut draws = |by: &str, counting| {
        let run = RunOptions { rival: Some(anamorph_lab::rivals::parse(by).unwrap()), ..Default::default() };
        let rendered = engine.render(&scene, &camera, &Wanted { counting, ..wanted() }, &run).unwrap();
        let is_hit = |id: &&u32| **id != NO_ID;
        let covered = rendered.frame.u32(Channel::TriangleId).unwrap().iter().filter(is_hit).count();
        (rendered.draws, covered as u64)
    };
    assert_eq!(draws("raster-warp:0", false).0, None);
    // the teapot's poles have triangles without area, which are left out
    let corner = |k: u32| scene.mesh.positions[k as usize];
    let has_area = |t: &&[u32; 3]| (corner(t[1]) - corner(t[0])).cross(corner(t[2]) - corner(t[0])) != DVec3::ZERO;
    let corners = 3 * scene.mesh.triangles.iter().filter(has_area).count() as u64;
    for (by, parts) in [("raster-warp:0", 1), ("raster-warp:2", 16)] {
        let (Some(draws), covered) = draws(by, true) else { return common::needs::skip("the adapter counts no draws") };
        assert_eq!(draws.vertices, parts * corners, "{by}");
        assert!(draws.triangles > 0 && draws.triangles <= parts * corners / 3, "{by}: {draws:?}");
        assert!(draws.fragments >= covered && covered > 0, "{by}: {draws:?}, {covered} pixels");
    }
}

#[test]
fn what_a_rival_cannot_show_it_refuses_in_a_line() {
    let refusal = |camera: &str, by: &str| {
        let scene = scene(camera);
        let camera = scene.camera().unwrap();
        let run = RunOptions { rival: Some(anamorph_lab::rivals::parse(by).unwrap()), ..Default::default() };
        let error = engine(&camera, Without::Nothing)?.render(&scene, &camera, &wanted(), &run);
        let error = error.map(|_| ()).unwrap_err();
        assert_eq!(error.exit_code(), 2);
        Some(error.to_string())
    };
    let says = |camera: &str, by: &str, what: &str| {
        let Some(text) = refusal(camera, by) else { return };
        assert!(
            text.starts_with(by.split(':').next().unwrap()) && text.contains(what) && !text.contains('\n'),
            "{text}"
        );
    };
    says(CURVED, "raytrace", "raymarch-segments");
    says(SLITS, "raymarch-segments", "straight");
    says(SLITS, "raster-pieces", "perspective");
    says(SLITS, "raster-cubemap:64", "one point");
    says(SLITS, "raster-image:64", "one point");
    says(&FISHEYE.replace("fov = 120", "fov = 200"), "raster-image:64", "raster-cubemap");
    let looks_up = |t: &&Technique| ["raster-cubemap", "raster-image"].contains(&t.name);
    for technique in TECHNIQUES.iter().filter(|t| t.name.starts_with("raster") && !looks_up(t)) {
        says(FISHEYE, technique.name, "pieces");
    }
    let mirror = "kind = \"reflection\"\neye = { kind = \"pinhole\", eye = [0, 1, 5], target = [0, 0, 0], vfov = 40 }\n\
                  mirror = { shape = \"sphere\", radius = 0.5 }";
    says(mirror, "raytrace", "atlas");
}

#[test]
fn frames_of_moving_triangles_are_timed_with_what_is_built_over_them() {
    let scene = scene(SLITS);
    let camera = scene.camera().unwrap();
    let frame = |rival: Option<Choice>| {
        let run = RunOptions { rival, moving: true, repeat: 2, ..Default::default() };
        Some(engine(&camera, Without::Nothing)?.render(&scene, &camera, &wanted(), &run).unwrap())
    };
    for by in ["raytrace", "raytrace-refit", "raster-warp"] {
        let Some(rendered) = frame(Some(anamorph_lab::rivals::parse(by).unwrap())) else { return };
        assert_eq!(rendered.frame_ms.len(), 2, "{by}");
    }
}
