//! What surfaces are like at the hits, N, P and albedo: the engine against the reference, through every kind of rays. Views and depths
//! against their definitions.

use crate::common;
use crate::pictures;

use anamorph::internals::camera::{Camera, Rays};
use anamorph::internals::engine::RunOptions;
use anamorph::internals::engine::combinations::at_once;
use anamorph::internals::engine::plan::Wanted;
use anamorph::internals::geometry::mesh::NO_COLOR;
use anamorph::internals::geometry::texture::{Texels, Texture};
use anamorph::internals::image::frame::{Channel, Frame, NO_ID};
use anamorph::internals::reference::image::{image, judge};
use anamorph::internals::reference::{Outcome, Path, Reference};
use anamorph::internals::scene::Scene;
use common::cameras::{MeshShape, glc_of_each_class, mesh_camera, raymap};
use common::file::{camera_of, load, scene_of};
use common::gpu::{Without, engine, ids};
use common::layered::{chain, straight_then_curved, wavy};
use common::rng::Rng;
use common::{FORWARD, camera};
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
            let rival = rival.map(|name| anamorph_lab::rivals::parse(name).unwrap());
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
#[ignore = "slow: make test-all"]
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

/// A ball that reflects, or that refracts with this index.
#[derive(Clone, Copy)]
struct Ball {
    centre: DVec3,
    radius: f64,
    ior: Option<f64>,
}

impl Ball {
    /// How far a ray from a place goes to the surface, after a start on it.
    fn met(&self, p: DVec3, d: DVec3) -> f64 {
        let m = self.centre - p;
        let (along, root) = (d.dot(m), (self.radius * self.radius - d.cross(m).length_squared()).sqrt());
        [along - root, along + root].into_iter().find(|t| *t > 1e-6).unwrap()
    }

    /// Where a unit direction goes on at a place of the surface: the law of reflection, or Snell's.
    fn after(&self, place: DVec3, d: DVec3) -> DVec3 {
        let outwards = (place - self.centre) / self.radius;
        let n = if d.dot(outwards) < 0.0 { outwards } else { -outwards };
        let c = -d.dot(n);
        let reflected = d + 2.0 * c * n;
        let Some(ior) = self.ior else { return reflected };
        let e = if d.dot(outwards) < 0.0 { 1.0 / ior } else { ior };
        let root = 1.0 - e * e * (1.0 - c * c);
        if root < 0.0 { reflected } else { e * d + (e * c - root.sqrt()) * n }
    }
}

/// X and X' at t of the curve of these control points, by de Casteljau's rule.
fn on_curve(points: &[DVec3], t: f64) -> (DVec3, DVec3) {
    let degree = points.len() - 1;
    let mut row = points.to_vec();
    while row.len() > 2 {
        row = row.windows(2).map(|p| p[0].lerp(p[1], t)).collect();
    }
    (row[0].lerp(row[1], t), degree as f64 * (row[1] - row[0]))
}

/// Its length from 0 to t, by Simpson's rule.
fn arc(points: &[DVec3], t: f64) -> f64 {
    const PARTS: u32 = 256;
    let speed = |k: u32| on_curve(points, t * f64::from(k) / f64::from(PARTS)).1.length();
    let weight = |k: u32| if k == 0 || k == PARTS { 1.0 } else { 2.0 + 2.0 * f64::from(k % 2) };
    t / (3.0 * f64::from(PARTS)) * (0..=PARTS).map(|k| weight(k) * speed(k)).sum::<f64>()
}

/// `view` and `Z` where the reference sees something, by the definitions: against the last ray, and of the whole path.
fn view_and_z(camera: &Camera, ball: Option<Ball>, shown: &Outcome, (i, j): (u32, u32)) -> Option<(DVec3, f64)> {
    let seen = shown.seen?;
    let t = seen.hit.t;
    // the tangent, and the length from the start
    let along = |layer: usize, t: f64| match &camera.layers[layer] {
        Rays::Curves(_) => {
            let points = camera.curve(layer, i, j).unwrap().1.points().to_vec();
            (on_curve(&points, t).1, arc(&points, t))
        }
        _ => {
            let d = camera.pixel(layer, i, j).unwrap().1.ray(0.0, 0.0).direction;
            (d, t * d.length())
        }
    };
    let Some(ball) = ball.filter(|_| shown.bounces > 0) else {
        let (tangent, length) = along(seen.layer, t);
        let before: f64 = (0..seen.layer).map(|layer| along(layer, 1.0).1).sum();
        return Some((-tangent.normalize(), before + length));
    };
    let ray = camera.ray(i, j).unwrap();
    let (mut place, mut d, mut before) = (ray.origin, ray.direction.normalize(), 0.0);
    for _ in 0..shown.bounces {
        let far = ball.met(place, d);
        place += far * d;
        before += far;
        d = ball.after(place, d);
    }
    Some((-d, before + t))
}

/// Cameras of every kind of ray with what they look at, about the origin: by name, and with the mirror or lens if there is one.
fn sights() -> Vec<(&'static str, Camera, Option<Ball>)> {
    const POSE: &str = "eye = [0.2, 0.3, 4]\ntarget = [0, 0, 0]";
    const EYE: &str = "eye = { kind = 'pinhole', eye = [0.2, 0.3, 4], target = [0, 0, 0], vfov = 40 }";
    let of = |text: &str| camera_of(STAND, SIGHT, &text.replace("POSE", POSE).replace("EYE", EYE)).unwrap();
    let mirror = Ball { centre: DVec3::new(0.85, -0.2, 0.6), radius: 0.45, ior: None };
    let lens = Ball { centre: DVec3::new(0.1, 0.2, 1.9), radius: 0.5, ior: Some(1.3) };
    let [m, l] = [mirror, lens]
        .map(|b| format!("{{ shape = 'sphere', center = {:?}, radius = {} }}", b.centre.to_array(), b.radius));
    vec![
        ("pinhole", of("kind = 'pinhole'\nPOSE\nvfov = 40"), None),
        (
            "pinhole both ways",
            of("kind = 'pinhole'\neye = [0.1, 0.2, 0.9]\ntarget = [0, 0, 0]\nvfov = 70\nt_range = [-inf, inf]"),
            None,
        ),
        ("orthographic", of("kind = 'orthographic'\nPOSE\nheight = 2.5"), None),
        ("cross-slit", camera(glc_of_each_class()[3].1.clone(), SIGHT, FORWARD), None),
        ("fisheye", of("kind = 'fisheye'\nPOSE\nfov = 60\nframe = 'full'"), None),
        ("cylinder", of("kind = 'cylinder'\nPOSE\nvfov = 40"), None),
        ("panini", of("kind = 'panini'\nPOSE\nfov = 60"), None),
        ("mesh", camera(mesh_camera(3, 3, 2, MeshShape::default()), SIGHT, FORWARD), None),
        ("ray map", raymap(SIGHT.0, SIGHT.1, FORWARD), None),
        ("chain", chain(11, 3, (3, 2), MeshShape::default(), SIGHT), None),
        ("chain of 5", chain(12, 5, (2, 2), MeshShape::default(), SIGHT), None),
        ("straight, then curved", straight_then_curved(SIGHT), None),
        ("parabolas", wavy(2, 0.5, false, SIGHT), None),
        ("cubics", wavy(3, 0.8, false, SIGHT), None),
        ("twist", of("kind = 'twist'\nPOSE\nvfov = 40\nangle = 40\ndegree = 3"), None),
        ("occlusion", of("kind = 'occlusion'\nPOSE\nvfov = 40\nnear = 3.4\nfar = 4.4\ndistortion = [0.02, 0.1]"), None),
        (
            "track",
            of("kind = 'track'\nPOSE\nvfov = 30\ntargets = [{ at = [-0.12, 0.09, 0.78], radius = 0.03 }]\nfar = 6"),
            None,
        ),
        ("mirror", of(&format!("kind = 'reflection'\nEYE\nmirror = {m}\ndepth = 1")), Some(mirror)),
        ("lens", of(&format!("kind = 'refraction'\nEYE\nlens = {l}\nior = 1.3\ndepth = 2")), Some(lens)),
    ]
}

const SIGHT: (u32, u32) = (48, 36);

/// Seen by [`sights`]: a ball on a table, and a box that hides a part of it.
const STAND: &str = r#"
[[mesh]]
builtin = "icosphere"
level = 2
scale = 0.6
translate = [0.03, -0.1, 0.07]
[[mesh]]
builtin = "box"
scale = 0.3
translate = [-0.1, 0.1, 1]
[[mesh]]
builtin = "plane"
size = 6
translate = [0, -0.72, 0]
"#;

/// A unit vector's some ten operations of f32 on numbers up to 1.
const VIEW_ERROR: f64 = 10.0 / 16_777_216.0;

/// Of Z, whose t comes of f64, relative to it: its some ten operations of f32.
const Z_ERROR: f64 = 10.0 / 16_777_216.0;

/// Views and normalised depths are those of their definitions at every safe pixel that sees something, and 0 and 1 where nothing is hit.
#[test]
fn views_and_depths_are_those_of_the_definitions() {
    let channels = ["view", "depth.linear", "depth.perspective"].into_iter().flat_map(Channel::named);
    let wanted = Wanted::of(channels.chain([Channel::Z, Channel::TriangleId]).collect());
    let [near, far] = [2.0, 9.0];
    let of_z = |z: f64| [(z - near) / (far - near), far * (z - near) / (z * (far - near))];
    let stand = scene_of(STAND, SIGHT, "kind = 'pinhole'\neye = [0, 0, 4]\ntarget = [0, 0, 0]\nvfov = 40").unwrap();
    let scene = Scene { depth_range: Some([near, far]), ..stand };
    let all = sights();
    assert!(all.len() >= 12);
    for (name, camera, ball) in all {
        let Some(mut engine) = engine(&camera, Without::Nothing) else { return };
        let frame = engine.render(&scene, &camera, &wanted, &RunOptions::default()).unwrap().frame;
        let names = |frame: &Frame| frame.planes.iter().map(|(c, _)| *c).collect::<Vec<_>>();
        assert_eq!(names(&frame), names(&image(&scene, &camera, &wanted.channels)), "{name}");
        let safe = judge(&scene, &camera, &frame).safe;
        let joined = scene.with_optics(&camera);
        let reference = Reference::of_scene(&joined);
        let all = [Channel::Z, Channel::DepthLinear, Channel::DepthPerspective].map(|c| frame.f32(c).unwrap());
        let views = vectors(&frame, [Channel::ViewX, Channel::ViewY, Channel::ViewZ]);
        let (mut hits, mut behind, mut worst) = (0, 0, [0.0f64; 2]);
        for k in 0..views.len() {
            let [own, linear, perspective] = all.map(|plane| f64::from(plane[k]));
            if own.is_infinite() {
                assert!([linear, perspective] == [1.0; 2] && views[k] == DVec3::ZERO, "{name} {k}");
            } else {
                // f32 of what f64 makes of the f32 Z
                let expected = of_z(own);
                let off = |seen: f64, expected: f64| (seen - expected).abs() / expected.abs();
                let off = off(linear, expected[0]).max(off(perspective, expected[1]));
                assert!(off <= f64::from(f32::EPSILON), "{name} {k}: {off}");
            }
            if !safe[k] {
                continue;
            }
            let (i, j) = (k as u32 % SIGHT.0, k as u32 / SIGHT.0);
            let shown = reference.shown(&camera, Path::of_pixel(&camera, i, j));
            assert_eq!(ids(&frame)[k], shown.seen.map_or(NO_ID, |seen| seen.hit.triangle), "{name} {i},{j}");
            let Some((view, z)) = view_and_z(&camera, ball, &shown, (i, j)) else { continue };
            hits += 1;
            behind += u32::from(shown.bounces > 0 || shown.seen.is_some_and(|seen| seen.layer > 0));
            // what Z may be off by, through the slopes of both depths, and their own rounding
            let rounding = Z_ERROR * z.abs();
            let allowed = [1.0, far * near / (z * z)].map(|slope| rounding * slope / (far - near));
            let expected = of_z(z);
            for (seen, expected, allowed) in [(linear, expected[0], allowed[0]), (perspective, expected[1], allowed[1])]
            {
                let off = (seen - expected).abs() - 0.5 * f64::from(f32::EPSILON) * expected.abs();
                assert!(off <= allowed, "{name} {i},{j}: {seen}, {expected}");
            }
            let off = (views[k] - view).length();
            assert!(off <= VIEW_ERROR, "{name} {i},{j}: {}, {view}", views[k]);
            worst = [worst[0].max(off), worst[1].max((own - z).abs() / z.abs())];
        }
        println!(
            "{name}: {hits} hits, {behind} of them later on their paths; views off {:.1e}, Z {:.1e}",
            worst[0], worst[1]
        );
        let least_behind = if camera.layers.len() > 1 || ball.is_some() { 30 } else { 0 };
        assert!(hits > 60 && behind >= least_behind, "{name}: {hits} hits, {behind} later on their paths");
    }
}

/// Depths between a near and a far that are given, and can be.
#[test]
fn normalised_depths_need_a_range() {
    let text = "image = { width = 61, height = 45, depth_range = [2, 9] }\n[[mesh]]\nbuiltin = \"teapot\"\n\
        [camera]\nkind = \"pinhole\"\neye = [3, 4, 6]\ntarget = [0, 1, 0]\nvfov = 40\n";
    let without = load(&text.replace(", depth_range = [2, 9]", "")).unwrap();
    let wanted = Wanted::of(["depth.linear", "depth.perspective"].into_iter().flat_map(Channel::named).collect());
    let camera = without.camera().unwrap();
    for range in ["[0, 1]", "[2, 2]", "[3, 1]"] {
        let error = load(&text.replace("[2, 9]", range)).unwrap_err().to_string();
        assert!(error.contains("near must be above 0, and far above near"), "{error}");
    }
    let Some(mut engine) = engine(&camera, Without::Nothing) else { return };
    let error = engine.render(&without, &camera, &wanted, &RunOptions::default()).unwrap_err().to_string();
    assert_eq!(error, "depth.linear needs near and far; add depth_range = [near, far] to [image]");
}
