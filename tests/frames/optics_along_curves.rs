//! Mirrors and lenses seen along curves and along layers of rays: closed forms, and frames against the reference.

use crate::common;

use anamorph::internals::camera::optics::{Bounce, Facets, Law, Optics, Quadric, Smooth, Surface};
use anamorph::internals::camera::{Camera, Curve};
use anamorph::internals::engine::RunOptions;
use anamorph::internals::geometry::{generate, place};
use anamorph::internals::image::frame::{Channel, NO_ID};
use anamorph::internals::reference::{Path, Reference, Segment};
use anamorph::internals::scene::Scene;
use common::cameras::{MeshShape, mesh_spec};
use common::file::load;
use common::gpu::{Without, assert_same_without_f64, check, ids, render, render_with, words};
use common::rng::Rng;
use common::{layered, scene};
use glam::DVec3;
use std::sync::Arc;

const SIZE: (u32, u32) = (77, 59);

/// What a ball of radius 0.8 about the origin mirrors: a cloud of small triangles around it, and two balls.
fn cloud() -> Scene {
    let mut cloud = common::soup(&mut Rng(5), 400, 0.3);
    cloud.positions.iter_mut().for_each(|p| *p = 1.4 * p.normalize() + 0.8 * *p);
    let ball = |x: f64, y: f64| {
        let mut ball = generate::icosphere(2);
        ball.positions.iter_mut().for_each(|p| *p = 0.4 * *p + DVec3::new(x, y, 1.1));
        ball
    };
    scene(place::merge(vec![ball(-0.9, 0.5), ball(0.8, -0.7), cloud]).unwrap())
}

/// Not on the axis of any eye: no ray of a pixel's centre meets an edge.
const MIDDLE: DVec3 = DVec3::new(0.031, 0.017, 0.0);

fn ball_of_facets() -> Surface {
    let mut ball = generate::icosphere(3);
    ball.positions.iter_mut().for_each(|p| *p = 0.8 * *p + MIDDLE);
    Surface::Facets { facets: Facets::of_mesh(&ball).unwrap(), law: Law::Normals }
}

fn ball() -> Surface {
    Surface::Smooth(Smooth::Quadrics(vec![Quadric::sphere(MIDDLE, 0.8)]))
}

fn before(optics: Optics, camera: Camera) -> Camera {
    Camera { optics: Some(Arc::new(optics)), ..camera }
}

type Named = Vec<(String, Camera)>;

/// Eyes of several layers of straight rays, and curved ones.
fn eyes() -> (Named, Named) {
    let plain = MeshShape::default();
    let chain = |layers, shape| layered::chain(8, layers, (5, 4), shape, SIZE);
    let straight = vec![
        ("chain of 2".to_string(), chain(2, plain)),
        ("weighted chain".into(), chain(4, MeshShape { weights: true, ..plain })),
        ("discontinuous chain".into(), chain(3, MeshShape { discontinuous: true, ..plain })),
        ("chain of 16".into(), chain(16, plain)),
    ];
    let mut curved = vec![("straight, then curved".to_string(), layered::straight_then_curved(SIZE))];
    for (degree, bend) in [(1, 0.0), (2, 0.3), (2, 1.0), (3, 0.3), (3, 1.0)] {
        curved.push((format!("degree {degree} bent by {bend}"), layered::wavy(degree, bend, bend > 0.5, SIZE)));
    }
    (straight, curved)
}

/// Mirrors and lenses before each eye, with their names.
fn cases() -> Named {
    let (straight, curved) = eyes();
    let glass = Bounce::Refract { ior: 1.5 };
    let mut list = Vec::new();
    for (name, eye) in straight.iter().chain(&curved) {
        list.push((format!("{name}, mirror"), before(Optics::new(Bounce::Reflect, ball_of_facets(), 1), eye.clone())));
        list.push((format!("{name}, lens"), before(Optics::new(glass, ball_of_facets(), 3), eye.clone())));
    }
    for (name, eye) in straight {
        list.push((format!("{name}, smooth mirror"), before(Optics::new(Bounce::Reflect, ball(), 2), eye.clone())));
        list.push((format!("{name}, smooth lens"), before(Optics::new(glass, ball(), 2), eye)));
    }
    list
}

#[test]
fn frames_agree_with_the_reference() {
    let scene = cloud();
    let (mut mirrored, mut later) = (0, 0);
    for (name, camera) in cases() {
        let Some((frame, judged, _)) = check(&name, &scene, &camera) else { return };
        let (seen, known) = (&frame, &judged.truth);
        let of_mirror = |k: &usize| known.u32(Channel::MirrorId).unwrap()[*k] != NO_ID;
        let pixels: Vec<usize> = (0..judged.safe.len()).filter(of_mirror).collect();
        assert!(pixels.len() > 200, "{name}: {} pixels see the optics", pixels.len());
        mirrored += pixels.len();
        for &k in pixels.iter().filter(|k| judged.safe[**k]) {
            let both = |c| (seen.u32(c).unwrap()[k], known.u32(c).unwrap()[k]);
            for channel in [Channel::MirrorId, Channel::PieceId, Channel::TriangleId] {
                let (seen, known) = both(channel);
                assert_eq!(seen, known, "{name}: {channel:?} of pixel {k}");
            }
            let numbers = |c| (seen.f32(c).unwrap()[k], known.f32(c).unwrap()[k]);
            // a few f32 roundings of each of up to 19 lengths
            let (z, z_known) = numbers(Channel::Z);
            assert!(z == z_known || (z - z_known).abs() <= 1e-5 * z_known, "{name}: Z {z} and {z_known} of pixel {k}");
            later += usize::from(numbers(Channel::T).1.is_finite());
        }
    }
    assert!(later > mirrored / 20, "{later} of {mirrored} pixels see something in the optics");
}

#[test]
#[ignore = "slow: make test-all"]
fn other_adapters_see_the_same() {
    let scene = cloud();
    let few = ["chain of 2, smooth mirror", "weighted chain, mirror", "degree 3 bent by 0.3, lens"];
    let few = cases().into_iter().filter(|(name, _)| few.contains(&name.as_str()));
    for (k, (name, camera)) in few.enumerate() {
        let Some(whole) = render_with(&scene, &camera, Without::Nothing, &RunOptions::default()) else { return };
        let two = render_with(&scene, &camera, Without::Int64Atomics, &RunOptions::default()).unwrap();
        assert_eq!(words(&whole.frame), words(&two.frame), "{name}: two 32-bit atomics are one of 64");
        // kernels with f64 in words take a software adapter long to compile
        if k == 0 {
            assert_same_without_f64(&name, &scene, &camera, &whole.frame);
        }
    }
}

/// A curve goes on as its tangent, reflected by the law of mirrors, and its length is that of its arc.
#[test]
fn curves_are_reflected_as_their_tangents() {
    const HEIGHT: f64 = -0.4;
    let (a, b) = (DVec3::new(-40.0, HEIGHT, -40.0), DVec3::new(40.0, HEIGHT, 40.0));
    let (c, d) = (DVec3::new(a.x, HEIGHT, b.z), DVec3::new(b.x, HEIGHT, a.z));
    let floor = common::mesh(vec![a, c, b, d], vec![[0, 1, 2], [0, 2, 3]]);
    let facets = Facets::of_mesh(&floor).unwrap();
    let floor = Surface::Facets { facets, law: Law::Normals };
    let nothing = scene(common::mesh(Vec::new(), Vec::new()));
    for degree in [2, 3] {
        let camera = layered::wavy(degree, 0.5, false, (31, 23));
        let camera = before(Optics::new(Bounce::Reflect, floor.clone(), 1), camera);
        let joined = nothing.with_optics(&camera);
        let reference = Reference::build(&joined.mesh);
        let mut met = 0;
        for k in 0..31 * 23 {
            let path = Path::of_pixel(&camera, k % 31, k / 31);
            let Some((_, Segment::Curved(curve))) = path.segments[0] else { panic!("a curve") };
            let shown = reference.shown(&camera, path);
            let Some(t) = first_crossing(&curve, HEIGHT) else {
                assert_eq!(shown.bounces, 0);
                continue;
            };
            met += 1;
            let tangent = curve.tangent(t).normalize();
            let [Some((_, Segment::Curved(to_floor))), Some((_, Segment::Straight(on)))] = shown.path.segments[..]
            else {
                panic!("a curve and a ray: {:?}", shown.path)
            };
            let ray = on.ray(0.0, 0.0);
            // places are weighted means of corners 57 away: some ten roundings of 2^-53 of that. t by bisection is off by less
            assert!((ray.origin - curve.at(t)).length() < 1e-13, "{} {}", ray.origin, curve.at(t));
            assert!((ray.direction - tangent * DVec3::new(1.0, -1.0, 1.0)).length() < 1e-13);
            // the length of a fine polyline: its chords are shorter by about the square of a step
            let steps = 20_000;
            let at = |n: u32| curve.at(t * f64::from(n) / f64::from(steps));
            let length: f64 = (0..steps).map(|n| (at(n + 1) - at(n)).length()).sum();
            assert!((Segment::Curved(to_floor).length(1.0) - length).abs() < 1e-7 * length);
        }
        assert!(met > 50, "{met}");
    }
}

/// The first t at which a curve crosses a height, by a search of small steps and bisection.
fn first_crossing(curve: &Curve, height: f64) -> Option<f64> {
    let above = |t: f64| curve.at(t).y - height;
    let step = 1.0 / 4096.0;
    let k = (0..4096).find(|k| above(f64::from(*k) * step) * above(f64::from(k + 1) * step) <= 0.0)?;
    let (mut lo, mut hi) = (f64::from(k) * step, f64::from(k + 1) * step);
    for _ in 0..60 {
        let middle = 0.5 * (lo + hi);
        if above(lo) * above(middle) <= 0.0 { hi = middle } else { lo = middle }
    }
    Some(0.5 * (lo + hi))
}

/// Rays that go on straight through every face are those of one camera: the same picture in the mirror.
#[test]
fn layers_of_straight_rays_see_what_one_layer_sees() {
    let whole = mesh_spec(6, 4, 3, MeshShape::default());
    let part = |from: f64, to: f64| {
        let mut spec = whole.clone();
        for v in &mut spec.vertices {
            (v.near, v.far) = (v.near.lerp(v.far, from), v.near.lerp(v.far, to));
        }
        spec
    };
    let scene = cloud();
    for surface in [ball(), ball_of_facets()] {
        let mirror = || Optics::new(Bounce::Reflect, surface.clone(), 1);
        let one = before(mirror(), layered::of_layers(vec![part(0.0, 1.0)], SIZE));
        let layers = vec![part(0.0, 0.3), part(0.3, 0.6), part(0.6, 1.0)];
        let in_layers = before(mirror(), layered::of_layers(layers, SIZE));
        let (Some(one), Some(in_layers)) = (render(&scene, &one), render(&scene, &in_layers)) else { return };
        let of_mirror = |k: &usize| one.u32(Channel::MirrorId).unwrap()[*k] != NO_ID;
        let pixels: Vec<usize> = (0..ids(&one).len()).filter(of_mirror).collect();
        let differ = pixels.iter().filter(|k| ids(&one)[**k] != ids(&in_layers)[**k]).count();
        // rays that pass an edge within rounding may fall to either side
        assert!(pixels.len() > 500 && differ <= 2, "{differ} of {} pixels differ", pixels.len());
        let (z, z_in_layers) = (one.f32(Channel::Z).unwrap(), in_layers.f32(Channel::Z).unwrap());
        let same = pixels.into_iter().filter(|k| ids(&one)[*k] == ids(&in_layers)[*k] && z[*k].is_finite());
        let mut seen = 0;
        for k in same {
            // the two rays are off by f64 roundings; lengths of up to four segments by those of f32
            assert!((z[k] - z_in_layers[k]).abs() <= 1e-6 * z[k], "Z {} and {}", z[k], z_in_layers[k]);
            seen += 1;
        }
        assert!(seen > 100, "{seen}");
    }
}

/// Kinds of a scene file whose rays are curved or layered.
const EYES: [&str; 8] = [
    r#"kind = "curved_convergence", eye = [0.3, 1.1, 6], vfov = 42, near = 2, far = 14, bend = [0.3, 0.1]"#,
    r#"kind = "occlusion", eye = [0.3, 1.1, 6], vfov = 42, near = 4, far = 8"#,
    r#"kind = "occlusion", eye = [0.3, 1.1, 6], vfov = 42, near = 4, far = 8, join = "bezier""#,
    r#"kind = "twist", eye = [0.3, 1.1, 6], vfov = 42, degree = 2, angle = 50"#,
    r#"kind = "twist", eye = [0.3, 1.1, 6], vfov = 42, degree = 3, angle = 90"#,
    r#"kind = "ortho_to_perspective", eye = [0.3, 1.1, 6], vfov = 30"#,
    r#"kind = "street", from = [-2.1, 0.2, 5], to = [1.9, 0.2, 5], facade = 4, far = 10, views = [{ at = 0.5, width = 0.5 }]"#,
    r#"kind = "top_down", eye = [0.3, 3, 7], target = [0, 0, 0], vfov = 42, foreground = true, regions = [{ rect = [0.3, 0.3, 0.7, 0.7], eye = [0, 4, 5] }]"#,
];

/// A mirror in a scene file, with a floor and things around it.
fn file(camera: &str) -> anamorph::internals::input::Result<(Scene, Camera)> {
    let things = r#"image = { width = 101, height = 77, background = [0.2, 0.3, 0.4] }
mesh = [
    { builtin = "plane", size = 12, divisions = 6, translate = [0, -1.2, 0] },
    { builtin = "icosphere", level = 2, scale = 0.5, translate = [-1.6, -0.3, 1.4] },
    { builtin = "teapot", level = 3, scale = 0.4, translate = [1.6, -1.2, 1.2] },
]
light = [{ direction = [-1, -2, -1.2] }]"#;
    let scene = load(&format!("{things}\n[camera]\n{camera}\n"))?;
    let camera = scene.camera()?;
    Ok((scene, camera))
}

#[test]
#[ignore = "slow: make test-all"]
fn every_kind_of_eye_sees_a_mirror() {
    let mirrors = [
        r#"kind = "reflection"
mirror = { shape = "sphere", radius = 1, count = 900 }
facets = "normals""#,
        r#"kind = "refraction"
lens = { shape = "torus", axis = [0.3, 1, 0.5], radius = 0.9, tube = 0.35, count = 800 }
facets = "normals"
ior = 1.3
depth = 4
fresnel = true"#,
    ];
    for (n, eye) in EYES.iter().enumerate() {
        let mirror = mirrors[n % 2];
        let (scene, camera) = file(&format!("eye = {{ {eye} }}\n{mirror}")).unwrap_or_else(|e| panic!("{eye}: {e}"));
        let Some((frame, judged, _)) = check(eye, &scene, &camera) else { return };
        let mirrored = frame.u32(Channel::MirrorId).unwrap().iter().filter(|id| **id != NO_ID).count();
        assert!(mirrored > 300, "{eye}: {mirrored} pixels see the mirror");
        let mut off = 0;
        for channel in [Channel::R, Channel::G, Channel::B] {
            let (seen, known) = (frame.f32(channel).unwrap(), judged.truth.f32(channel).unwrap());
            let pairs = seen.iter().zip(known).zip(&judged.safe);
            // some ten f32 roundings of a colour, and steep normals next to edges
            off += pairs.filter(|((a, b), safe)| **safe && (*a - *b).abs() > 1e-4).count();
        }
        assert_eq!(off, 0, "{eye}: {off} colours are off");
    }
}

#[test]
fn what_does_not_go_is_said_in_one_line() {
    let ball = "mirror = { shape = \"sphere\", radius = 1 }";
    let mesh = "mirror = { builtin = \"icosphere\" }";
    let cases = [
        (
            EYES[0],
            ball,
            "camera.facets: curved_convergence has curved rays, which meet facets but not the exact surface",
        ),
        (EYES[0], "mirror = { builtin = \"icosphere\" }\nfacets = \"flat\"", "flat facets need an eye in one point"),
        (EYES[1], "mirror = { builtin = \"icosphere\" }\nfacets = \"flat\"", "occlusion has several layers of rays"),
        (
            EYES[3],
            "mirror = { builtin = \"icosphere\" }\natlas = 8",
            "camera.atlas: an atlas needs an eye in one point",
        ),
        (
            EYES[3],
            "mirror = { builtin = \"icosphere\" }\nfacets_error = 1",
            "camera.facets_error: it is measured for one",
        ),
        (
            EYES[1],
            "mirror = { builtin = \"icosphere\" }\nt_range = [0, 1]",
            "camera.t_range: the several layers of rays of",
        ),
    ];
    for (eye, mirror, words) in cases {
        let error = file(&format!("kind = \"reflection\"\neye = {{ {eye} }}\n{mirror}")).unwrap_err().to_string();
        assert!(error.contains(words) && error.lines().count() == 1, "{error}");
    }
    // layers of straight rays meet the exact surface; curves a mesh
    assert!(file(&format!("kind = \"reflection\"\neye = {{ {} }}\n{ball}", EYES[1])).is_ok());
    assert!(file(&format!("kind = \"reflection\"\neye = {{ {} }}\n{mesh}", EYES[0])).is_ok());
}
