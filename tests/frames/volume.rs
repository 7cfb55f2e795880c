//! Volumes: closed forms of the reference, the engine's frames against the reference, and frames without a volume.

use crate::common;
use anamorph::internals::input::Loading;

use anamorph::internals::camera::{Camera, Curve, CurveMap, Curves, Rays};
use anamorph::internals::engine::plan::Wanted;
use anamorph::internals::engine::{Engine, RunOptions};
use anamorph::internals::image::frame::{Channel, Frame, NO_ID};
use anamorph::internals::reference::image::image;
use anamorph::internals::scene::Scene;
use anamorph::internals::scene::light::Light;
use anamorph::internals::scene::volume::{Mode, Volume};
use common::cameras::{MeshShape, glc_of_each_class, mesh_camera, pinhole, raymap};
use common::file::{camera_of, load};
use common::gpu::{Without, engine_on, ids, render_with};
use common::layered::{chain, straight_then_curved, wavy};
use common::rng::Rng;
use common::volumes::{SHELLS, bumps, grid, volume};
use common::{ALL_T, FORWARD, camera, soup};
use glam::{DQuat, DVec2, DVec3};
use std::sync::Arc;

const SIZE: (u32, u32) = (30, 22);

/// What the definitions allow.
const ERROR: f64 = 1.0 / 512.0;

const COLOUR: [Channel; 4] = [Channel::R, Channel::G, Channel::B, Channel::A];

/// A scene of a volume alone.
fn scene_of(volume: Volume) -> Scene {
    Scene { volume: Some(volume), background: [0.1, 0.2, 0.3], size: Some(SIZE), ..Scene::empty() }
}

fn parallel() -> Camera {
    let text = "kind = \"orthographic\"\neye = [3, 2, 4]\ntarget = [0, 0, 0]\nheight = 4.2";
    camera_of("", SIZE, text).unwrap()
}

/// The reference's values and, with an adapter, the engine's, each with how exact it is.
fn frames(scene: &Scene, camera: &Camera) -> Vec<(Frame, f64)> {
    let own = image(scene, camera, &COLOUR);
    let rendered = render_with(scene, camera, Without::Nothing, &RunOptions::default());
    [(own, 1e-6)].into_iter().chain(rendered.map(|r| (r.frame, ERROR))).collect()
}

fn channel(frame: &Frame, channel: Channel) -> &[f32] {
    frame.f32(channel).unwrap()
}

/// Where a line through the box from -1 to 1 enters and leaves it.
fn chord(p: DVec3, d: DVec3) -> Option<(f64, f64)> {
    let (a, b) = ((-DVec3::ONE - p) / d, (DVec3::ONE - p) / d);
    let (enters, leaves) = (a.min(b).max_element(), a.max(b).min_element());
    (enters < leaves).then_some((enters, leaves))
}

/// A box of one value: exp(-k L) of what lies behind is left.
#[test]
fn a_uniform_box_absorbs_by_the_length_in_it() {
    let uniform = grid([3, 4, 5], DQuat::IDENTITY, |_| 1.0);
    let scene = scene_of(volume(uniform, &[[1.0, 0.9, 0.5, 0.25, 0.7]], Mode::Composite, false));
    let (camera, mut inside) = (parallel(), 0);
    for (frame, error) in frames(&scene, &camera) {
        for (i, j) in (0..SIZE.1).flat_map(|j| (0..SIZE.0).map(move |i| (i, j))) {
            let ray = camera.ray(i, j).unwrap();
            let length = chord(ray.origin, ray.direction).map_or(0.0, |(a, b)| (b - a) * ray.direction.length());
            inside += u32::from(length > 0.0);
            let left = (-0.7 * length).exp();
            let k = (j * SIZE.0 + i) as usize;
            for (of, colour, behind) in [(Channel::R, 0.9, 0.1), (Channel::G, 0.5, 0.2), (Channel::B, 0.25, 0.3)] {
                let expected = colour * (1.0 - left) + f64::from(behind as f32) * left;
                let seen = f64::from(channel(&frame, of)[k]);
                assert!((seen - expected).abs() <= error, "{i},{j} {of:?}: {seen}, {expected}");
            }
            let seen = f64::from(channel(&frame, Channel::A)[k]);
            assert!((seen - (1.0 - left)).abs() <= error, "{i},{j}: coverage {seen}, {}", 1.0 - left);
        }
    }
    assert!(inside > 200, "{inside}");
}

/// Along a ramp of extinction k (1 + z) / 2 and constant colour, the optical depth is the mean of its ends times the length.
#[test]
fn a_ramp_absorbs_by_its_mean() {
    let ramp = grid([2, 2, 9], DQuat::IDENTITY, |p| p.z);
    let scene =
        scene_of(volume(ramp, &[[-1.0, 1.0, 1.0, 1.0, 0.0], [1.0, 1.0, 1.0, 1.0, 1.8]], Mode::Composite, false));
    let camera = parallel();
    for (frame, error) in frames(&scene, &camera) {
        for (i, j) in (0..SIZE.1).flat_map(|j| (0..SIZE.0).map(move |i| (i, j))) {
            let ray = camera.ray(i, j).unwrap();
            let Some((a, b)) = chord(ray.origin, ray.direction) else { continue };
            let z = ray.origin.z + 0.5 * (a + b) * ray.direction.z;
            let left = (-0.9 * (1.0 + z) * (b - a) * ray.direction.length()).exp();
            let seen = f64::from(channel(&frame, Channel::A)[(j * SIZE.0 + i) as usize]);
            assert!((seen - (1.0 - left)).abs() <= error, "{i},{j}: {seen}, {}", 1.0 - left);
        }
    }
}

/// The largest value of x + y along a line is at one of its ends.
#[test]
fn the_maximum_of_a_ramp_is_at_an_end() {
    let ramp = grid([5, 5, 3], DQuat::IDENTITY, |p| p.x + p.y);
    let points = [[-2.0, 0.0, 1.0, 0.0, 50.0], [2.0, 1.0, 0.0, 0.5, 50.0]];
    let scene = scene_of(volume(ramp, &points, Mode::Maximum, false));
    let camera = parallel();
    for (frame, error) in frames(&scene, &camera) {
        for (i, j) in (0..SIZE.1).flat_map(|j| (0..SIZE.0).map(move |i| (i, j))) {
            let ray = camera.ray(i, j).unwrap();
            let k = (j * SIZE.0 + i) as usize;
            let largest = chord(ray.origin, ray.direction).map(|(a, b)| {
                let at = |t: f64| (ray.origin + t * ray.direction).truncate().element_sum();
                at(a).max(at(b))
            });
            let expected = largest.map_or(f64::from(0.1f32), |v| (v + 2.0) / 4.0);
            let seen = f64::from(channel(&frame, Channel::R)[k]);
            assert!((seen - expected).abs() <= error, "{i},{j}: {seen}, {expected}");
        }
    }
}

/// The direction in which a light travels, and its colour. Of both together no matte surface sends back more than 1.
const LIGHTS: [(DVec3, [f32; 3]); 2] =
    [(DVec3::new(-1.0, -2.0, -1.5), [0.5, 0.4, 0.3]), (DVec3::new(0.5, 0.3, -1.0), [0.3, 0.4, 0.5])];

fn light((travel, colour): (DVec3, [f32; 3])) -> Light {
    Light { colour, ..Light::distant(travel) }
}

/// The factor of `lit` by these lights on what rises along `gradient`.
fn factor(lights: &[(DVec3, [f32; 3])], gradient: DVec3) -> DVec3 {
    let n = -gradient.normalize();
    let facing = |travel: DVec3| n.dot(-travel.normalize()).max(0.0);
    0.1 + 0.9
        * lights.iter().map(|(travel, colour)| facing(*travel) * DVec3::from(colour.map(f64::from))).sum::<DVec3>()
}

/// Values that rise along (1, -2, -2) of the grid are one matte surface everywhere: one factor, whatever the cells' sides are. With the
/// ends of the extinction at the least and the greatest value, the optical depth is its mean times the length.
#[test]
fn a_lit_ramp_shines_by_the_angle_of_its_gradient() {
    let (turn, rise) =
        (DQuat::from_axis_angle(DVec3::new(1.0, 2.0, 0.5).normalize(), 0.4), DVec3::new(1.0, -2.0, -2.0));
    let colour = DVec3::new(0.9, 0.5, 0.25);
    let points = [[-5.0, 0.9, 0.5, 0.25, 0.2], [5.0, 0.9, 0.5, 0.25, 1.6]];
    // the nodes' values are whole halves, so f32 has them exactly
    let ramp = grid([3, 5, 9], turn, |p| rise.dot(p));
    let mut scene = scene_of(volume(ramp, &points, Mode::Composite, true));
    let camera = parallel();
    let view = camera.ray(0, 0).unwrap().direction.normalize();
    // a light behind it adds nothing
    let behind = (turn * -rise, [1.0, 0.8, 0.6]);
    let shone: [&[_]; 3] = [&[], &[LIGHTS[0], behind], &LIGHTS];
    let mut factors = Vec::new();
    for lights in shone {
        scene.lights = lights.iter().copied().map(light).collect();
        let factor = match lights {
            [] => DVec3::splat(0.1 + 0.9 * (turn * rise).normalize().dot(view).abs()),
            _ => factor(lights, turn * rise),
        };
        factors.push(factor);
        for (frame, error) in frames(&scene, &camera) {
            let mut inside = 0;
            for (i, j) in (0..SIZE.1).flat_map(|j| (0..SIZE.0).map(move |i| (i, j))) {
                let ray = camera.ray(i, j).unwrap();
                let (p, d) = (turn.inverse() * ray.origin, turn.inverse() * ray.direction);
                let Some((a, b)) = chord(p, d) else { continue };
                inside += 1;
                let v = rise.dot(p + 0.5 * (a + b) * d);
                let left = (-(0.9 + 0.14 * v) * (b - a) * d.length()).exp();
                let expected = factor * colour * (1.0 - left) + left * DVec3::from(scene.background.map(f64::from));
                let k = (j * SIZE.0 + i) as usize;
                let seen = DVec3::from([Channel::R, Channel::G, Channel::B].map(|of| channel(&frame, of)[k].into()));
                assert!((seen - expected).abs().max_element() <= error, "{i},{j} by {lights:?}: {seen}, {expected}");
            }
            assert!(inside > 150, "{inside}");
        }
    }
    // the lights tell these apart by much more than the bound
    println!("factors {factors:?}");
    assert!(factors.windows(2).all(|f| (f[0] - f[1]).abs().max_element() > 0.1), "{factors:?}");
}

/// Parabolas in planes across y, from z = 2 to z = -2, that bulge sideways: between z = 1 and -1 by an eighth of `bend`, half of it to each
/// side.
#[derive(Debug)]
struct Parabolas;

impl Parabolas {
    /// From -3 to 3 down the image.
    fn bend(b: f64) -> f64 {
        6.0 * b - 3.0
    }
}

impl CurveMap for Parabolas {
    fn degree(&self) -> usize {
        2
    }

    fn curve(&self, a: f64, b: f64) -> Option<(u32, Curve)> {
        let (q, part) = (DVec2::new(a - 0.5, 0.5 - b), Parabolas::bend(b) / 16.0);
        let beside = |parts: f64, z: f64| DVec3::new(q.x + parts * part, q.y, z);
        Some((0, Curve::new(&[beside(-7.0, 2.0), beside(9.0, 0.0), beside(-7.0, -2.0)])))
    }
}

/// Within the box, x = q + bend (1/16 - u^2 / 2) and z = 2 u for u from -1/2 to 1/2: the arc's length is the integral of
/// sqrt(4 + bend^2 u^2) over it. Lit from in front, values that rise away from the viewer have one factor everywhere.
#[test]
fn a_box_absorbs_by_the_length_of_the_curve_in_it() {
    let uniform = grid([3, 4, 5], DQuat::IDENTITY, |p| -p.z);
    let mut scene = scene_of(volume(uniform, &[[0.0, 0.9, 0.5, 0.25, 0.7]], Mode::Composite, true));
    scene.lights = LIGHTS.map(light).to_vec();
    let factor = factor(&LIGHTS, DVec3::NEG_Z);
    let camera =
        Camera::of("projector", SIZE, [0.0, 1.0], Rays::Curves(Curves::new(SIZE.0, SIZE.1, Arc::new(Parabolas))));
    let mut most = 0.0f64;
    for (frame, error) in frames(&scene, &camera) {
        for (i, j) in (0..SIZE.1).flat_map(|j| (0..SIZE.0).map(move |i| (i, j))) {
            let bend = Parabolas::bend((f64::from(j) + 0.5) / f64::from(SIZE.1));
            let root = (1.0 + bend * bend / 16.0).sqrt();
            let length = root + 4.0 / bend * (bend / 4.0).asinh();
            let left = (-0.7 * length).exp();
            most = most.max((-1.4f64).exp() - left);
            let behind = DVec3::from(scene.background.map(f64::from));
            let expected = factor * DVec3::new(0.9, 0.5, 0.25) * (1.0 - left) + left * behind;
            let k = (j * SIZE.0 + i) as usize;
            let seen = DVec3::from([Channel::R, Channel::G, Channel::B].map(|of| channel(&frame, of)[k].into()));
            assert!((seen - expected).abs().max_element() <= error, "{i},{j}: {seen}, {expected}");
            let seen = f64::from(channel(&frame, Channel::A)[k]);
            assert!((seen - (1.0 - left)).abs() <= error, "{i},{j}: coverage {seen}, {}", 1.0 - left);
        }
    }
    // the straight way from end to end is shorter by much more than the bound
    assert!(most > 10.0 * ERROR, "{most}");
}

/// A wall in the middle is seen through half of the box, and hides the other half.
#[test]
fn a_surface_hides_what_is_behind() {
    let text = "[[mesh]]\nbuiltin = \"plane\"\nsize = 9\nrotate = [90, 0, 0]\nemissive = [1, 1, 1]\ncolor = [0, 0, 0]";
    let eye = "kind = \"orthographic\"\neye = [0, 0, 5]\ntarget = [0, 0, 0]\nheight = 1.5";
    let mut scene = load(&format!("image = {{ width = 40, height = 30 }}\n{text}\n[camera]\n{eye}\n")).unwrap();
    let uniform = grid([2, 2, 2], DQuat::IDENTITY, |_| 1.0);
    scene.volume = Some(volume(uniform, &[[1.0, 0.0, 0.0, 0.0, 0.7]], Mode::Composite, false));
    for (frame, error) in frames(&scene, &scene.camera().unwrap()) {
        for seen in channel(&frame, Channel::G) {
            assert!((f64::from(*seen) - (-0.7f64).exp()).abs() <= error, "{seen}");
        }
        assert!(channel(&frame, Channel::A).iter().all(|a| *a == 1.0));
    }
}

/// Cameras of every kind of ray, by name.
fn cameras() -> Vec<(String, Camera)> {
    cameras_of(SIZE)
}

/// The same for images of another size.
fn cameras_of(size: (u32, u32)) -> Vec<(String, Camera)> {
    let of = |kind| camera(kind, size, FORWARD);
    let mut list: Vec<(String, Camera)> = vec![
        ("pinhole".into(), of(pinhole(DVec3::new(1.0, 0.8, 2.5), DVec3::ZERO, 45.0))),
        ("inside".into(), of(pinhole(DVec3::new(0.2, 0.1, 0.6), DVec3::ZERO, 70.0))),
        ("both ways".into(), camera(pinhole(DVec3::new(0.2, 0.1, 0.6), DVec3::ZERO, 70.0), size, ALL_T)),
        ("mesh".into(), of(mesh_camera(3, 3, 2, MeshShape::default()))),
        ("torn mesh".into(), of(mesh_camera(5, 3, 2, MeshShape { discontinuous: true, ..MeshShape::default() }))),
        ("raymap".into(), raymap(size.0, size.1, FORWARD)),
        ("chain".into(), chain(11, 3, (3, 2), MeshShape::default(), size)),
        ("chain of 5".into(), chain(12, 5, (2, 2), MeshShape::default(), size)),
        ("straight, then curved".into(), straight_then_curved(size)),
    ];
    list.extend(glc_of_each_class().into_iter().map(|(name, kind)| (format!("glc {name}"), of(kind))));
    for (degree, bend) in [(2, 0.5), (3, 0.8), (3, 2.0)] {
        list.push((format!("curves of degree {degree}, bent by {bend}"), wavy(degree, bend, degree == 3, size)));
    }
    let named = [
        ("fisheye", "kind = \"fisheye\"\neye = [0.5, 0.4, 2]\ntarget = [0, 0, 0]\nfov = 150"),
        (
            "pushbroom",
            "kind = \"pushbroom\"\nstart = [-1.5, 0.3, 3]\nend = [1.5, 0.2, 3]\nlook = [0, 0, -1]\nvfov = 40",
        ),
        (
            "twist",
            "kind = \"twist\"\neye = [0, 0, 4]\ntarget = [0, 0, 0]\nvfov = 40\nnear = 1\nfar = 7\nangle = 60\ndegree = 3",
        ),
        (
            "curved convergence",
            "kind = \"curved_convergence\"\neye = [0, 0, 4]\ntarget = [0, 0, 0]\nvfov = 40\nnear = 1\nfar = 7\nbend = [0.5, 0.3]",
        ),
        (
            "irregular",
            "kind = \"irregular_perspective\"\neye = [0, 0, 4]\ntarget = [0, 0, 0]\nvfov = 40\nnear = 1\nfar = 7\nconvergence = -0.5",
        ),
        (
            "composite",
            "kind = \"composite\"\ncameras = [{ camera = { kind = \"pinhole\", eye = [0, 0, 4], target = [0, 0, 0], vfov = 40, \
             t_range = [0, 9] }, region = { kind = \"rectangle\", from = [0, 0], to = [0.5, 1] } }, \
             { camera = { kind = \"twist\", eye = [0, 0, 4], target = [0, 0, 0], vfov = 40, near = 1, far = 7, angle = 60, degree = 2 } }]",
        ),
    ];
    list.extend(named.map(|(name, text)| (name.to_owned(), camera_of("", size, text).unwrap())));
    list
}

/// The largest difference of colours and coverage where both show the same triangle.
fn largest_difference(seen: &Frame, truth: &Frame) -> f64 {
    let same = |k: &usize| ids(seen)[*k] == ids(truth)[*k];
    let off = |of: Channel| {
        let (a, b) = (channel(seen, of), channel(truth, of));
        (0..a.len()).filter(same).map(|k| f64::from((a[k] - b[k]).abs())).fold(0.0, f64::max)
    };
    COLOUR.map(off).into_iter().fold(0.0, f64::max)
}

fn wanted() -> Wanted {
    Wanted::of([&COLOUR[..], &[Channel::TriangleId]].concat())
}

/// How far the engine is off the reference, and how many pixels show the volume alone.
fn error_of(engine: &mut Engine, scene: &Scene, camera: &Camera) -> (f64, usize) {
    let seen = engine.render(scene, camera, &wanted(), &RunOptions::default()).unwrap().frame;
    (largest_difference(&seen, &image(scene, camera, &wanted().channels)), through(&seen))
}

/// Bumps with shells among triangles: through every camera, at every pixel.
#[test]
#[ignore = "slow: make test-all"]
fn frames_agree_with_the_reference_through_every_camera() {
    let Some(mut engine) = engine_on(|_| {}) else { return };
    let mut scene = common::scene(soup(&mut Rng(8), 40, 0.3));
    let (turn, mut worst) = (DQuat::from_rotation_y(0.4) * DQuat::from_rotation_x(0.3), 0.0f64);
    scene.volume = Some(volume(grid([17, 15, 13], turn, bumps), &SHELLS, Mode::Composite, false));
    let all = cameras();
    assert!(all.len() >= 12);
    for (name, camera) in &all {
        let (error, _) = error_of(&mut engine, &scene, camera);
        println!("{name}: {error:.2e}");
        assert!(error <= ERROR, "{name}: {error}");
        worst = worst.max(error);
    }
    println!("largest: {worst:.2e}");
}

/// How many pixels show a hundredth of the volume or more, and nothing else.
fn through(frame: &Frame) -> usize {
    ids(frame).iter().zip(channel(frame, Channel::A)).filter(|(id, a)| **id == NO_ID && **a > 0.01).count()
}

/// The largest value, and light on the volume, through every camera too: by a headlight in one, and by lights of the scene in the next.
#[test]
#[ignore = "slow: make test-all"]
fn maxima_and_lit_volumes_agree_with_the_reference() {
    let Some(mut engine) = engine_on(|_| {}) else { return };
    let turn = DQuat::from_rotation_z(0.5);
    let own = |mode, is_lit| volume(grid([14, 12, 16], turn, bumps), &SHELLS, mode, is_lit);
    let mut scene = common::scene(soup(&mut Rng(9), 20, 0.3));
    let all = cameras_of((14, 10));
    assert!(all.len() >= 24);
    for (mode, is_lit) in [(Mode::Maximum, false), (Mode::Composite, true)] {
        scene.volume = Some(own(mode, is_lit));
        for (k, (name, camera)) in all.iter().enumerate() {
            let lights = if is_lit && k % 2 == 1 { LIGHTS.map(light).to_vec() } else { Vec::new() };
            let name = format!("{mode:?}, lit {is_lit} by {} lights, {name}", lights.len());
            scene.lights = lights;
            let (error, seen) = error_of(&mut engine, &scene, camera);
            println!("{name}: {error:.2e}, {seen} pixels");
            assert!(error <= ERROR, "{name}: {error}");
            assert!(seen > 5, "{name}: {seen} pixels show the volume");
        }
    }
}

/// Random numbers at the nodes, and steep transfer functions: as far from smooth as volumes are.
#[test]
#[ignore = "slow: make test-all"]
fn noise_agrees_with_the_reference() {
    let Some(mut engine) = engine_on(|_| {}) else { return };
    for seed in 0..3 {
        let rng = std::cell::RefCell::new(Rng(seed));
        let noise = grid([8, 7, 9], DQuat::IDENTITY, |_| rng.borrow_mut().unit());
        let steps = [
            [0.3, 0.1, 0.2, 0.9, 0.0],
            [0.3001, 0.9, 0.2, 0.1, 8.0],
            [0.6, 0.2, 0.9, 0.1, 8.0],
            [0.601, 0.0, 0.0, 1.0, 0.5],
        ];
        let mut scene = common::scene(soup(&mut Rng(seed), 10, 0.3));
        scene.volume = Some(volume(noise, &steps, Mode::Composite, false));
        for (name, camera) in cameras().iter().filter(|c| ["pinhole", "raymap", "chain"].contains(&c.0.as_str())) {
            let (error, _) = error_of(&mut engine, &scene, camera);
            println!("noise {seed}, {name}: {error:.2e}");
            assert!(error <= ERROR, "noise {seed}, {name}: {error}");
        }
    }
}

/// Far from the origin and at other scales, positions in the grid keep their digits.
#[test]
fn a_volume_far_away_looks_the_same() {
    let Some(mut engine) = engine_on(|_| {}) else { return };
    let near = volume(grid([17, 15, 13], DQuat::IDENTITY, bumps), &SHELLS, Mode::Composite, false);
    for (offset, eye) in [(DVec3::new(3e5, -2e5, 1e5), 2.5), (DVec3::ZERO, 4e4)] {
        let mut own = near.clone();
        let placed = std::sync::Arc::make_mut(&mut own.grid);
        placed.to_world.translation += offset;
        let vfov = (45f64.to_radians() / eye * 2.5).to_degrees();
        let camera = camera(pinhole(offset + eye * DVec3::new(0.3, 0.2, 0.93), offset, vfov), SIZE, FORWARD);
        let (error, _) = error_of(&mut engine, &scene_of(own), &camera);
        assert!(error <= ERROR, "{offset}, {eye}: {error}");
    }
}

/// In 32-bit words, and all in f32.
#[test]
fn adapters_without_f64_agree_with_the_reference() {
    let scene = scene_of(volume(grid([17, 15, 13], DQuat::IDENTITY, bumps), &SHELLS, Mode::Composite, false));
    let camera = cameras().into_iter().find(|c| c.0 == "pinhole").unwrap().1;
    let Some(seen) = render_with(&scene, &camera, Without::F64, &RunOptions::default()) else { return };
    let error = largest_difference(&seen.frame, &image(&scene, &camera, &wanted().channels));
    assert!(error <= ERROR, "{error}");
}

/// Curves of either degree in 32-bit words too: with the most legs, loops of vectors would use up the rounds that drivers allow a thread.
#[test]
#[ignore = "slow: make test-all"]
fn curves_without_f64_agree_with_the_reference() {
    let mut scene = common::scene(soup(&mut Rng(8), 40, 0.3));
    let (turn, mut compared) = (DQuat::from_rotation_y(0.4) * DQuat::from_rotation_x(0.3), 0);
    for (is_lit, extinction) in [(false, 1.0), (true, 4.0)] {
        let steep = SHELLS.map(|[value, r, g, b, own]| [value, r, g, b, extinction * own]);
        scene.volume = Some(volume(grid([17, 15, 13], turn, bumps), &steep, Mode::Composite, is_lit));
        let names =
            ["curves of degree 3, bent by 2", "curves of degree 2, bent by 0.5", "straight, then curved", "twist"];
        // kernels with f64 in words take a software adapter long to compile: without light one of them
        for name in &names[..if is_lit { 4 } else { 1 }] {
            let camera = cameras().into_iter().find(|c| c.0 == *name).unwrap().1;
            let Some(seen) = render_with(&scene, &camera, Without::F64, &RunOptions::default()) else { return };
            let error = largest_difference(&seen.frame, &image(&scene, &camera, &wanted().channels));
            println!("{name}, extinction times {extinction}, without f64: {error:.2e}");
            assert!(error <= ERROR, "{name}, extinction times {extinction}: {error}");
            compared += 1;
        }
    }
    assert_eq!(compared, 5);
}

/// Many samples a pixel are frames whose volumes are averaged too: `at_once` says that one frame does not take them.
#[test]
fn samples_take_a_frame_each() {
    let scene = scene_of(volume(grid([5, 5, 5], DQuat::IDENTITY, bumps), &SHELLS, Mode::Composite, false));
    assert!(!anamorph::internals::engine::combinations::at_once(&scene, &parallel(), 4));
    assert!(anamorph::internals::engine::combinations::at_once(&Scene { volume: None, ..scene }, &parallel(), 4));
}

/// A volume that absorbs nothing leaves every bit as it is, and so does one that no ray meets.
#[test]
fn nothing_changes_where_there_is_nothing() {
    let Some(mut engine) = engine_on(|_| {}) else { return };
    let mut scene = common::scene(soup(&mut Rng(8), 40, 0.3));
    let camera = camera(pinhole(DVec3::new(1.0, 0.8, 2.5), DVec3::ZERO, 45.0), SIZE, FORWARD);
    let mut take = |scene: &Scene| engine.render(scene, &camera, &wanted(), &RunOptions::default()).unwrap().frame;
    let plain = take(&scene);
    scene.volume =
        Some(volume(grid([5, 5, 5], DQuat::IDENTITY, bumps), &[[0.0, 1.0, 1.0, 1.0, 0.0]], Mode::Composite, false));
    assert!(common::gpu::words(&take(&scene)) == common::gpu::words(&plain));
    let mut far = grid([5, 5, 5], DQuat::IDENTITY, bumps);
    far.to_world.translation += DVec3::new(0.0, 0.0, 100.0);
    scene.volume = Some(volume(far, &SHELLS, Mode::Maximum, false));
    assert!(common::gpu::words(&take(&scene)) == common::gpu::words(&plain));
}

/// A scene file's error, with numbers of its own in a file beside it.
fn refusal(keys: &str, file: (&str, &[u8])) -> String {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join(file.0), file.1).unwrap();
    let path = folder.path().join("scene.toml");
    let camera = "[camera]\nkind = \"pinhole\"\neye = [0, 0, 5]\ntarget = [0, 0, 0]\nvfov = 40\n";
    std::fs::write(&path, format!("image = {{ width = 8, height = 8 }}\n{camera}[volume]\n{keys}\n")).unwrap();
    let error = Scene::load(&path, &[], 0.0, &Loading::default()).expect_err(keys);
    assert_eq!(error.exit_code(), 2, "{error}");
    let text = error.to_string();
    assert!(!text.contains('\n'), "{text}");
    text
}

/// A .npy file of a shape.
fn npy(descr: &str, shape: &str, bytes: &[u8]) -> Vec<u8> {
    let mut header = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': {shape}, }}");
    header += &" ".repeat(63 - (10 + header.len()) % 64);
    header.push('\n');
    let length = (header.len() as u16).to_le_bytes();
    [b"\x93NUMPY\x01\x00", &length[..], header.as_bytes(), bytes].concat()
}

#[test]
fn wrong_volumes_are_errors_of_one_line() {
    const PLACED: &str = "min = [0, 0, 0]\nmax = [1, 1, 1]";
    const SEEN: &str = "transfer = [[0, 1, 1, 1, 1]]";
    let raw = "file = \"a.raw\"\nshape = [2, 2, 2]\ntype = \"u8\"";
    let good = [0u8; 8];
    for (keys, why) in [
        ("", "file is missing"),
        ("file = \"a.raw\"\nshape = [2, 2]", "three whole numbers"),
        ("file = \"a.raw\"\nshape = [2, 2, 1]", "from 2 to 4096"),
        ("file = \"a.raw\"\nshape = [2, 2, 2]\ntype = \"f16\"", "use one of f32, f64, u8"),
        ("file = \"a.raw\"\nshape = [2, 2, 2]\ntype = \"u16\"\nendian = \"middle\"", "use \"little\" or \"big\""),
        ("file = \"a.txt\"", "a .npy, .nrrd, .nhdr, .mhd, .mha or .raw file"),
        ("file = \"a.npy\"\nshape = [2, 2, 2]", "says this itself"),
        (raw, "lies nowhere"),
        (&format!("{raw}\nmin = [0, 0, 0]"), "give min and max, or origin and spacing"),
        (&format!("{raw}\nmin = [0, 0, 0]\nmax = [1, 0, 1]"), "above that of min"),
        (&format!("{raw}\norigin = [0, 0, 0]\nspacing = [1, 0, 1]"), "above 0"),
        (&format!("{raw}\n{PLACED}"), "transfer is missing"),
        (&format!("{raw}\n{PLACED}\ntransfer = []"), "1 to 63"),
        (&format!("{raw}\n{PLACED}\ntransfer = [[0, 1, 1, 1]]"), "five numbers"),
        (&format!("{raw}\n{PLACED}\ntransfer = [[0, 1, 2, 1, 1]]"), "colours lie in [0, 1]"),
        (&format!("{raw}\n{PLACED}\ntransfer = [[0, 1, 1, 1, -1]]"), "extinction lies from 0"),
        (&format!("{raw}\n{PLACED}\ntransfer = [[0, 1, 1, 1, 1], [0, 1, 1, 1, 1]]"), "must increase"),
        (&format!("{raw}\n{PLACED}\n{SEEN}\nmode = \"mean\""), "\"composite\" or \"maximum\""),
        (&format!("{raw}\n{PLACED}\n{SEEN}\nmode = \"maximum\"\nlit = true"), "\"composite\" alone"),
        (&format!("{raw}\n{PLACED}\n{SEEN}\nlight = true"), "unknown key"),
        (&format!("file = \"b.raw\"\nshape = [2, 2, 2]\ntype = \"u8\"\n{PLACED}\n{SEEN}"), "b.raw"),
        (
            &format!("file = \"a.raw\"\nshape = [4000, 4000, 4000]\ntype = \"f32\"\n{PLACED}\n{SEEN}"),
            "the file has 8 bytes",
        ),
        (&format!("file = \"a.raw\"\nshape = [2, 2, 2]\ntype = \"u16\"\n{PLACED}\n{SEEN}"), "the file has 8 bytes"),
    ] {
        let text = refusal(keys, ("a.raw", &good));
        assert!(text.contains(why), "{keys}: {text}");
    }
    let keys = format!("file = \"a.npy\"\n{PLACED}\n{SEEN}");
    let numbers =
        |v: f32| [[1.0; 7].as_slice(), &[v]].concat().iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>();
    for (bytes, why) in [
        (npy("<f4", "(2, 2, 2)", &numbers(f32::NAN)), "[1][1][1] is NaN"),
        (npy("<f4", "(2, 2, 2)", &numbers(f32::INFINITY)), "[1][1][1] is inf"),
        (npy("<f4", "(2, 2, 2)", &[0; 31]), "ends early"),
        (npy("<f4", "(4, 2)", &[0; 32]), "must have three sides"),
        (npy("<f4", "(8, 1, 1)", &[0; 32]), "must have three sides"),
        (npy("<f4", "(99999, 99999, 99999)", &[0; 32]), "must have three sides"),
        (npy("<i8", "(2, 2, 2)", &[0; 64]), "type \"<i8\""),
    ] {
        let text = refusal(&keys, ("a.npy", &bytes));
        assert!(text.contains(why), "{text}");
    }
}

/// The same numbers as every type, and in either order of bytes.
#[test]
fn files_of_every_type_hold_the_same_numbers() {
    let folder = tempfile::tempdir().unwrap();
    let numbers: Vec<u8> = (0..24).map(|n| n * 7).collect();
    let wide = |big: bool| -> Vec<u8> {
        let two = |n: &u8| if big { u16::from(*n).to_be_bytes() } else { u16::from(*n).to_le_bytes() };
        numbers.iter().flat_map(two).collect()
    };
    let floats: Vec<u8> = numbers.iter().flat_map(|n| f32::from(*n).to_le_bytes()).collect();
    let shape = "shape = [2, 3, 4]";
    for (name, bytes, keys) in [
        ("a.npy", npy("|u1", "(2, 3, 4)", &numbers), String::new()),
        ("b.npy", npy("<u2", "(2, 3, 4)", &wide(false)), String::new()),
        ("c.npy", npy(">u2", "(2, 3, 4)", &wide(true)), String::new()),
        ("d.npy", npy("<f4", "(2, 3, 4)", &floats), String::new()),
        ("a.raw", numbers.clone(), format!("{shape}\ntype = \"u8\"")),
        ("b.raw", wide(false), format!("{shape}\ntype = \"u16\"")),
        ("c.raw", wide(true), format!("{shape}\ntype = \"u16\"\nendian = \"big\"")),
        ("d.raw", floats.clone(), format!("{shape}\ntype = \"f32\"")),
        ("e.npy", npy("<i2", "(2, 3, 4)", &wide(false)), String::new()),
        ("e.raw", wide(true), format!("{shape}\ntype = \"i16\"\nendian = \"big\"")),
        (
            "e.nrrd",
            [&b"NRRD0001\ntype: uint16\ndimension: 3\nsizes: 4 3 2\nencoding: raw\nendian: big\n\n"[..], &wide(true)]
                .concat(),
            String::new(),
        ),
    ] {
        std::fs::write(folder.path().join(name), bytes).unwrap();
        let camera = "[camera]\nkind = \"pinhole\"\neye = [0, 0, 5]\ntarget = [0, 0, 0]\nvfov = 40\n";
        let placed = "origin = [1, 2, 3]\nspacing = [0.5, 1, 2]\ntransfer = [[0, 1, 1, 1, 1]]";
        let path = folder.path().join("scene.toml");
        let text =
            format!("image = {{ width = 8, height = 8 }}\n{camera}[volume]\nfile = \"{name}\"\n{keys}\n{placed}\n");
        std::fs::write(&path, text).unwrap();
        let scene = Scene::load(&path, &[], 0.0, &Loading::default()).unwrap();
        let grid = scene.volume.unwrap().grid;
        assert_eq!(grid.sides, [4, 3, 2], "{name}");
        assert!(grid.values.iter().zip(&numbers).all(|(a, b)| *a == f32::from(*b)), "{name}");
        assert_eq!(grid.to_world.transform_point3(DVec3::new(3.0, 2.0, 1.0)), DVec3::new(2.5, 4.0, 5.0));
    }
}

/// What another transfer function colours stays so when another camera looks at it.
#[test]
fn what_is_lit_anew_stays_so_through_another_camera() {
    let Some(mut engine) = engine_on(|_| {}) else { return };
    let run = RunOptions::default();
    let wanted = Wanted::of(COLOUR.to_vec());
    let shells = SHELLS.map(|[value, r, g, b, extinction]| [value, b, r, g, 0.5 * extinction]);
    let [first, second] = [&SHELLS, &shells]
        .map(|points| scene_of(volume(grid([9, 9, 9], DQuat::IDENTITY, bumps), points, Mode::Composite, false)));
    let other = "kind = \"orthographic\"\neye = [-3, 1, 4]\ntarget = [0, 0, 0]\nheight = 4.2";
    let other = camera_of("", SIZE, other).unwrap();
    let mut frames = engine.prepare(&first, parallel(), &wanted, &run).unwrap();
    frames.light(&second).unwrap();
    frames.aim(&other).unwrap();
    frames.refresh().unwrap();
    let seen = frames.finish().unwrap().frame;
    let expected = engine.render(&second, &other, &wanted, &run).unwrap().frame;
    for of in COLOUR {
        assert_eq!(channel(&seen, of), channel(&expected, of), "{of:?}");
    }
}
