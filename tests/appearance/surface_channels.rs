//! What surfaces are like at the hits, N, P and albedo: the engine against the reference, through every kind of rays.

use crate::common;
use crate::pictures;

use anamorph::internals::engine::RunOptions;
use anamorph::internals::engine::combinations::at_once;
use anamorph::internals::engine::plan::Wanted;
use anamorph::internals::geometry::mesh::NO_COLOR;
use anamorph::internals::geometry::texture::{Texels, Texture};
use anamorph::internals::image::frame::{Channel, Frame, NO_ID};
use anamorph::internals::reference::image::image;
use anamorph::internals::scene::Scene;
use common::file::load;
use common::gpu::{Without, engine, engine_on, ids};
use common::rng::Rng;
use glam::DVec3;
use pictures::COLOUR;
use std::sync::Arc;

/// Off the origin, so that the anchor is no round number.
const THINGS: &str = r#"
[[mesh]]
builtin = "icosphere"
level = 2
translate = [10.3, 0.2, -4]
color = [0.7, 0.3, 0.2]
[[mesh]]
builtin = "teapot"
level = 3
scale = 0.5
translate = [11.9, -0.6, -4.4]
color = [0.2, 0.5, 0.6]
[[mesh]]
builtin = "plane"
size = 5
translate = [11, -0.8, -4]
"#;

const EYE: &str = "eye = [10.7, 1.3, 1.2]\ntarget = [11, 0, -4]";

fn cameras() -> [String; 6] {
    [
        format!(
            "kind = \"cross_slit\"\nslits = [{{ distance = 9, angle = 90 }}, {{ distance = 5, angle = 0 }}]\n{EYE}\nheight = 3"
        ),
        format!("kind = \"fisheye\"\n{EYE}\nfov = 100\nframe = \"full\""),
        format!("kind = \"fisheye\"\n{EYE}\nfov = 60\nframe = \"full\"\npieces = 9"),
        format!("kind = \"twist\"\n{EYE}\nvfov = 45\ndegree = 3\nangle = 50"),
        format!("kind = \"occlusion\"\n{EYE}\nvfov = 45\nnear = 4\nfar = 6\ndistortion = [0.05, 0.1]"),
        format!(
            "kind = \"reflection\"\neye = {{ kind = \"pinhole\", {}, vfov = 45 }}\n\
             mirror = {{ shape = \"sphere\", center = [11.3, 0.9, -3.2], radius = 0.5 }}\ndepth = 1",
            EYE.replace('\n', ", ")
        ),
    ]
}

fn asked() -> Vec<Channel> {
    let surface = Channel::MORE.into_iter().filter(|c| *c != Channel::Certified);
    [Channel::TriangleId, Channel::MirrorId].into_iter().chain(surface).collect()
}

fn vectors(frame: &Frame, channels: [Channel; 3]) -> Vec<DVec3> {
    let [x, y, z] = channels.map(|c| frame.f32(c).unwrap());
    (0..x.len()).map(|k| DVec3::new(x[k].into(), y[k].into(), z[k].into())).collect()
}

const NORMAL: [Channel; 3] = [Channel::NormalX, Channel::NormalY, Channel::NormalZ];
const POSITION: [Channel; 3] = [Channel::PositionX, Channel::PositionY, Channel::PositionZ];
const ALBEDO: [Channel; 3] = [Channel::AlbedoR, Channel::AlbedoG, Channel::AlbedoB];

/// Rounding of f32 of numbers up to 16, in a point's some ten operations.
const POINT_ERROR: f64 = 10.0 * 16.0 / 16_777_216.0;

#[test]
fn surfaces_are_the_reference_s_at_every_hit() {
    for text in cameras() {
        let text =
            format!("image = {{ width = 64, height = 48, depth_range = [0.5, 20] }}\n{THINGS}\n[camera]\n{text}");
        let scene: Scene = load(&text).unwrap();
        let camera = scene.camera().unwrap();
        let Some(mut engine) = engine(&camera, Without::Nothing) else { return };
        let wanted = Wanted::of(asked());
        let seen = engine.render(&scene, &camera, &wanted, &RunOptions::default()).unwrap().frame;
        let truth = image(&scene, &camera, &asked());
        let all = |channels| vectors(&seen, channels).into_iter().zip(vectors(&truth, channels));
        let same: Vec<usize> = (0..ids(&seen).len()).filter(|&k| ids(&seen)[k] == ids(&truth)[k]).collect();
        let hits = same.iter().filter(|&&k| ids(&seen)[k] != NO_ID).count();
        assert!(hits > 800 && same.len() + 30 > ids(&seen).len(), "{hits} hits, {} alike: {text}", same.len());

        let off = |channels: [Channel; 3]| -> Vec<f64> {
            let all: Vec<(DVec3, DVec3)> = all(channels).collect();
            same.iter().map(|&k| (all[k].0 - all[k].1).length()).collect()
        };
        let largest = |off: &[f64]| off.iter().copied().fold(0.0, f64::max);
        for label in [Channel::ObjectId, Channel::MaterialId] {
            let [of_seen, of_truth] = [&seen, &truth].map(|frame| frame.u32(label).unwrap());
            assert!(same.iter().all(|&k| of_seen[k] == of_truth[k]), "{label:?}: {text}");
        }
        assert_eq!(largest(&off(ALBEDO)), 0.0, "{text}");
        let position = largest(&off(POSITION));
        assert!(position <= POINT_ERROR, "{position}: {text}");
        // where a face is seen edge-on it may be turned either way
        let normals = off(NORMAL);
        let turned = normals.iter().filter(|&&d| d > 1e-4).count();
        println!("{hits} hits, position off {position:.1e}, {turned} normals by more than 1e-4");
        assert!(turned <= hits / 500, "{turned} normals of {hits}: {text}");
        let units = vectors(&seen, NORMAL);
        assert!(same.iter().all(|&k| {
            let length = units[k].length();
            (length - 1.0).abs() < 1e-6 || (length == 0.0 && ids(&seen)[k] >= scene.mesh.triangles.len() as u32)
        }));
    }
}

/// Object and material ids of these triangles, from the meshes' triangle counts.
fn labels(scene: &Scene, ids: &[u32]) -> [Vec<u32>; 2] {
    let mut of_triangle = Vec::new();
    for (number, object) in (0..).zip(&scene.objects) {
        of_triangle.extend(vec![number; object.triangles]);
    }
    let of = |list: &[u32], behind: usize| {
        let one =
            |id: &u32| if *id == NO_ID { NO_ID } else { list.get(*id as usize).copied().unwrap_or(behind as u32) };
        ids.iter().map(one).collect()
    };
    [of(&of_triangle, scene.objects.len()), of(&scene.mesh.material_of, scene.mesh.materials.len())]
}

#[test]
fn labels_are_those_of_the_triangles_in_every_engine() {
    let (object, material) = (Channel::ObjectId, Channel::MaterialId);
    for text in cameras() {
        let text = format!("image = {{ width = 64, height = 64 }}\n{THINGS}\n[camera]\n{text}");
        let scene: Scene = load(&text).unwrap();
        let camera = scene.camera().unwrap();
        let Some(mut engine) = engine(&camera, Without::Nothing) else { return };
        let mut rendered = |wanted: &Wanted, rival: Option<&str>| {
            let rival = rival.map(|name| anamorph::internals::rivals::parse(name).unwrap());
            engine.render(&scene, &camera, wanted, &RunOptions { rival, ..RunOptions::default() })
        };
        let all = Wanted::of(vec![Channel::TriangleId, object, material]);
        for by in [None, Some("raytrace"), Some("raster-warp:1")] {
            // a rival refuses cameras that it cannot show
            let Ok(seen) = rendered(&all, by) else { continue };
            let expected = labels(&scene, ids(&seen.frame));
            assert_eq!([object, material].map(|c| seen.frame.u32(c).unwrap().to_vec()), expected, "{by:?}: {text}");
        }
        let whole = rendered(&all, None).unwrap().frame;
        let several = kinds(&labels(&scene, ids(&whole))[0]);
        assert!(several >= 3, "{several} objects: {text}");
        // alone they bring no triangle ids, and with several samples they are those of the pixel's centre
        for samples in [1, 4] {
            if samples > 1 && !at_once(&scene, &camera, samples) {
                continue;
            }
            let alone = Wanted { samples, ..Wanted::of(vec![Channel::A, object]) };
            let alone = rendered(&alone, None).unwrap().frame;
            assert_eq!(alone.planes.iter().map(|p| p.0).collect::<Vec<_>>(), [Channel::A, object]);
            assert_eq!(alone.u32(object), whole.u32(object), "{samples} samples: {text}");
        }
        let truth = image(&scene, &camera, &[Channel::TriangleId, object, material]);
        assert_eq!([object, material].map(|c| truth.u32(c).unwrap().to_vec()), labels(&scene, ids(&truth)), "{text}");
    }
}

fn kinds(labels: &[u32]) -> usize {
    labels.iter().filter(|k| **k != NO_ID).collect::<std::collections::BTreeSet<_>>().len()
}

/// Random colours of the scene's vertices; one corner in ten has none.
fn give_colors(scene: &mut Scene) {
    let mut rng = Rng(3);
    let mesh = Arc::make_mut(&mut scene.mesh);
    mesh.colors = mesh.positions.iter().map(|_| [(); 3].map(|()| rng.unit() as f32)).collect();
    let corner = |k: u32| if k.is_multiple_of(10) { NO_COLOR } else { k };
    mesh.corner_colors = mesh.triangles.iter().map(|t| t.map(corner)).collect();
}

#[test]
fn colours_of_vertices_are_interpolated() {
    for text in cameras() {
        let text =
            format!("image = {{ width = 64, height = 48, depth_range = [0.5, 20] }}\n{THINGS}\n[camera]\n{text}");
        let mut scene: Scene = load(&text).unwrap();
        give_colors(&mut scene);
        let camera = scene.camera().unwrap();
        let Some(mut engine) = engine(&camera, Without::Nothing) else { return };
        let asked = [vec![Channel::TriangleId, Channel::Z], ALBEDO.to_vec()].concat();
        let seen = engine.render(&scene, &camera, &Wanted::of(asked.clone()), &RunOptions::default()).unwrap().frame;
        let truth = image(&scene, &camera, &asked);
        let mesh = &scene.mesh;
        let is_own = |k: &usize| ids(&seen)[*k] == ids(&truth)[*k] && (ids(&seen)[*k] as usize) < mesh.triangles.len();
        let hits: Vec<usize> = (0..ids(&seen).len()).filter(is_own).collect();
        assert!(hits.len() > 500, "{} hits: {text}", hits.len());
        let [of_seen, of_truth] = [&seen, &truth].map(|frame| vectors(frame, ALBEDO));
        let is_far = |k: &&usize| {
            let corners = mesh.triangles[ids(&seen)[**k] as usize].map(|v| mesh.positions[v as usize]);
            let [a, b, c] = corners;
            let longest = (b - a).length().max((c - b).length()).max((a - c).length());
            let height = (b - a).cross(c - a).length() / longest;
            // the place is off by POINT_ERROR along the view, ten times that along a surface that is seen at a cosine of 0.1: of a
            // ball that is a hundredth of its picture; a colour changes by its range, 1, over the triangle's height
            (of_seen[**k] - of_truth[**k]).length() > 3f64.sqrt() * 10.0 * POINT_ERROR / height
        };
        let far = hits.iter().filter(is_far).count();
        assert!(far <= hits.len() / 50, "{far} of {}: {text}", hits.len());
        // and they are no plain colours
        let plain = hits
            .iter()
            .filter(|k| scene.mesh.materials.iter().any(|m| DVec3::from(m.diffuse.map(f64::from)) == of_seen[**k]));
        assert!(plain.count() < hits.len() / 50);
    }
}

/// Rounding of three weights, which are clamped, and of their sum with a colour.
const WEIGHTS_ERROR: f64 = 8.0 / 16_777_216.0;

/// A triangle whose corners have one colour looks as if its material had it: with samples, in the light, and with an alpha mask.
#[test]
fn three_corners_of_one_colour_are_a_plain_triangle() {
    for text in cameras() {
        let text =
            format!("image = {{ width = 64, height = 48, depth_range = [0.5, 20] }}\n{THINGS}\n[camera]\n{text}");
        let plain: Scene = load(&text).unwrap();
        let camera = plain.camera().unwrap();
        let mut colored = plain.clone();
        let mesh = Arc::make_mut(&mut colored.mesh);
        mesh.colors = mesh.materials.iter().map(|m| m.diffuse).collect();
        mesh.corner_colors = mesh.material_of.iter().map(|m| [*m; 3]).collect();
        mesh.materials.iter_mut().for_each(|m| m.diffuse = [1.0; 3]);
        let mut masked = colored.clone();
        let mesh = Arc::make_mut(&mut masked.mesh);
        let white = Arc::new(Texels { width: 1, height: 1, rgba: vec![[half::f16::ONE; 4]] });
        let texture = Texture { cutoff: Some(0.5), ..Texture::new(white) };
        mesh.materials.iter_mut().for_each(|m| m.texture = Some(texture.clone()));
        let Some(mut engine) = engine(&camera, Without::Nothing) else { return };
        for samples in [1, 4] {
            if samples > 1 && !at_once(&plain, &camera, samples) {
                continue;
            }
            let wanted = Wanted { samples, ..Wanted::of(COLOUR.to_vec()) };
            let mut seen = |scene: &Scene| {
                vectors(&engine.render(scene, &camera, &wanted, &RunOptions::default()).unwrap().frame, COLOUR)
            };
            let truth = seen(&plain);
            // with alpha masks each sample is a frame
            let scenes = if samples > 1 { &[&colored][..] } else { &[&colored, &masked] };
            for scene in scenes {
                let own = seen(scene);
                let off = own.iter().zip(&truth).map(|(a, b)| (*a - *b).abs().max_element()).fold(0.0, f64::max);
                assert!(off <= WEIGHTS_ERROR, "{off} with {samples} samples: {text}");
            }
        }
    }
}

/// Views are those of the reference and point against the ray; normalised depths follow from Z by their formulas.
#[test]
fn views_and_normalised_depths() {
    let text = "image = { width = 61, height = 45, depth_range = [2, 9] }\n[[mesh]]\nbuiltin = \"teapot\"\n\
        [camera]\nkind = \"KIND\"\neye = [3, 4, 6]\ntarget = [0, 1, 0]\n";
    let cameras = [
        ("pinhole", "vfov = 40"),
        ("orthographic", "height = 5"),
        ("fisheye", "fov = 70"),
        ("twist", "angle = 40\ndegree = 3\nvfov = 40"),
        ("cylinder", "vfov = 50"),
        ("panini", "fov = 60"),
    ];
    let channels = ["view", "depth.linear", "depth.perspective"].into_iter().flat_map(Channel::named);
    let wanted = Wanted::of(channels.chain([Channel::Z]).collect());
    for (kind, keys) in cameras {
        let scene = load(&format!("{}{keys}\n", text.replace("KIND", kind))).unwrap();
        let camera = scene.camera().unwrap();
        let truth = image(&scene, &camera, &wanted.channels);
        let Some(mut engine) = engine_on(|_| {}) else { return };
        let frame = engine.render(&scene, &camera, &wanted, &RunOptions::default()).unwrap().frame;
        let names = |frame: &Frame| frame.planes.iter().map(|(c, _)| *c).collect::<Vec<_>>();
        assert_eq!(names(&frame), names(&truth), "{kind}");
        let of = |frame: &Frame, channel: Channel| frame.f32(channel).unwrap().to_vec();
        let mut hits = 0;
        for k in 0..of(&frame, Channel::Z).len() {
            let z = f64::from(of(&frame, Channel::Z)[k]);
            let depths = [Channel::DepthLinear, Channel::DepthPerspective].map(|c| f64::from(of(&frame, c)[k]));
            let views = [Channel::ViewX, Channel::ViewY, Channel::ViewZ].map(|c| (of(&frame, c)[k], of(&truth, c)[k]));
            if z.is_infinite() {
                assert!(depths == [1.0; 2] && views.iter().all(|v| v.0 == 0.0), "{kind} {k}");
                continue;
            }
            hits += 1;
            let linear = (z - 2.0) / 7.0;
            // f32 of what f64 makes of the f32 Z
            let ulp = f64::from(f32::EPSILON);
            assert!((depths[0] - linear).abs() <= ulp * linear.abs(), "{kind} {k}");
            assert!((depths[1] - 9.0 / z * linear).abs() <= ulp * depths[1].abs(), "{kind} {k}");
            let length: f32 = views.iter().map(|v| v.0 * v.0).sum();
            assert!((length - 1.0).abs() < 1e-6, "{kind} {k}");
            // a few roundings of f32; where the reference sees another triangle a curve's tangent differs with t
            let off = views.iter().map(|v| (v.0 - v.1).abs()).fold(0.0, f32::max);
            let is_same = (of(&truth, Channel::Z)[k] - of(&frame, Channel::Z)[k]).abs() < 1e-4;
            assert!(off < 2e-6 || !is_same, "{kind} {k}: {off}");
        }
        assert!(hits > 100, "{kind}: {hits}");
    }
    let without =
        load(&format!("{}vfov = 40\n", text.replace("KIND", "pinhole").replace(", depth_range = [2, 9]", ""))).unwrap();
    let camera = without.camera().unwrap();
    let Some(mut engine) = engine_on(|_| {}) else { return };
    let error = engine.render(&without, &camera, &wanted, &RunOptions::default()).unwrap_err().to_string();
    assert_eq!(error, "depth.linear needs near and far; add depth_range = [near, far] to [image]");
    for range in ["[0, 1]", "[2, 2]", "[3, 1]"] {
        let error = load(&text.replace("[2, 9]", range).replace("KIND", "pinhole")).unwrap_err().to_string();
        assert!(error.contains("near must be above 0, and far above near"), "{error}");
    }
}
