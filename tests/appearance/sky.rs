//! Light from all around: behind the scene, on matte surfaces and in shiny ones, through every kind of rays. Nothing to do without an
//! adapter.

use crate::common;
use crate::pictures;

use anamorph::internals::camera::Camera;
use anamorph::internals::engine::plan::Wanted;
use anamorph::internals::engine::{Engine, RunOptions};
use anamorph::internals::geometry::generate::icosphere;
use anamorph::internals::geometry::mesh::{Material, Mesh};
use anamorph::internals::geometry::texture::Texels;
use anamorph::internals::scene::Scene;
use anamorph::internals::scene::light::Light;
use anamorph::internals::scene::sky::Sky;
use common::cameras::{MeshShape, mesh_camera, raymap};
use common::file::{camera_of, load, refusal};
use common::gpu::engine_on;
use common::layered::chain;
use common::{FORWARD, camera, moved, scene};
use glam::DVec3;
use half::f16;
use pictures::{COLOUR, Colours, box_filtered, colours, flip};
use std::sync::Arc;

const SIZE: (u32, u32) = (80, 60);

/// Blue above, brown below, with bright and dark squares all around and a sun 8 degrees wide.
fn sky() -> Arc<Sky> {
    let (width, height) = (512, 256);
    let texel = |k: u32| {
        let (x, y) = (f64::from(k % width) / f64::from(width), f64::from(k / width) / f64::from(height));
        let mut light = if y < 0.5 { [0.3, 0.5, 0.9] } else { [0.35, 0.25, 0.15] };
        if (0.4..0.6).contains(&y) && ((40.0 * x) as u32 + (40.0 * y) as u32).is_multiple_of(2) {
            light = [0.9, 0.85, 0.7];
        }
        let sun = ((x - 0.6) * 360.0).hypot((y - 0.3) * 180.0) < 4.0;
        if sun {
            light = [30.0, 27.0, 20.0];
        }
        let [r, g, b] = light;
        [r, g, b, 1.0].map(f16::from_f64)
    };
    let rgba = (0..width * height).map(texel).collect();
    Arc::new(Sky::of(Arc::new(Texels { width, height, rgba }), 0.8, 0.37))
}

fn cameras() -> Vec<(&'static str, Camera)> {
    let of = |text: &str| camera_of("", SIZE, text).unwrap();
    let view = "eye = [0.3, 0.9, 4]\ntarget = [0, 0, 0]\nvfov = 50";
    vec![
        ("pinhole", of(&format!("kind = \"pinhole\"\n{view}"))),
        (
            "cross-slit",
            of(
                "kind = \"cross_slit\"\neye = [0.3, 0.9, 4]\ntarget = [0, 0, 0]\nheight = 4\nslits = [{ distance = 3, angle = 0 }, { distance = 4.5, angle = 90 }]",
            ),
        ),
        ("mesh of 16 x 16", camera(mesh_camera(1, 16, 16, MeshShape::default()), SIZE, FORWARD)),
        ("chain", chain(3, 3, (4, 3), MeshShape::default(), SIZE)),
        ("fisheye", of("kind = \"fisheye\"\neye = [0.3, 0.9, 4]\ntarget = [0, 0, 0]\nfov = 150\nframe = \"full\"")),
        ("sphere", of("kind = \"sphere\"\neye = [0.3, 0.2, 2.5]\ntarget = [0, 0, 0]")),
        ("curved projector", of(&format!("kind = \"twist\"\n{view}\ndegree = 3\nangle = 30"))),
        (
            "mirror",
            of(
                "kind = \"reflection\"\ndepth = 1\neye = { kind = \"pinhole\", eye = [0.3, 0.9, 4], target = [0, 0, 0], vfov = 40 }\nmirror = { shape = \"sphere\", center = [0, 0, 0], radius = 0.9 }",
            ),
        ),
    ]
}

fn rendered(engine: &mut Engine, scene: &Scene, camera: &Camera, samples: u32) -> Colours {
    let wanted = Wanted { samples, ..Wanted::of(COLOUR.to_vec()) };
    colours(&engine.render(scene, camera, &wanted, &RunOptions::default()).unwrap().frame)
}

const FLIP_MAX: f64 = 0.05;

#[test]
fn the_sky_is_seen_behind_all_that_is_there() {
    let Some(mut engine) = engine_on(|_| {}) else { return };
    let empty = Scene { sky: Some(sky()), ..scene(Mesh::default()) };
    let mut unseen = (*sky()).clone();
    unseen.is_seen = false;
    let hidden = Scene { sky: Some(Arc::new(unseen)), ..empty.clone() };
    for (name, camera) in cameras() {
        let exact = box_filtered(&empty, &camera, 64);
        let seen = rendered(&mut engine, &empty, &camera, 1);
        let error = flip(&exact, &seen, SIZE);
        println!("{name}: FLIP {error:.4}");
        assert!(error <= FLIP_MAX, "{name}: FLIP {error}");
        // without it the mirror alone is dark where it sees nothing
        let plain = rendered(&mut engine, &hidden, &camera, 1);
        let background = empty.background.map(f64::from);
        assert!(plain.iter().all(|c| (0..3).all(|k| (c[k] - background[k]).abs() < 1e-6)), "{name}");
    }
}

#[test]
fn what_has_no_ray_sees_no_sky() {
    let Some(mut engine) = engine_on(|_| {}) else { return };
    let empty = Scene { sky: Some(sky()), ..scene(Mesh::default()) };
    let seen = rendered(&mut engine, &empty, &raymap(SIZE.0, SIZE.1, FORWARD), 1);
    for (k, colour) in seen.iter().enumerate() {
        let is_blind = (k % SIZE.0 as usize + 3 * (k / SIZE.0 as usize)).is_multiple_of(17);
        let is_background = (0..3).all(|c| (colour[c] - f64::from(empty.background[c])).abs() < 1e-6);
        assert_eq!(is_blind, is_background, "pixel {k}");
    }
}

/// Four balls: matte, glossy, a rough metal and a smooth one.
fn balls() -> Scene {
    let mut all = Mesh::default();
    let ball = Material { diffuse: [0.8, 0.6, 0.4], ..Material::default() };
    let materials = [
        ball.clone(),
        Material { specular: [0.04; 3], roughness: 0.3, ..ball.clone() },
        Material { metallic: 1.0, roughness: 0.6, ..ball.clone() },
        Material { metallic: 1.0, roughness: 0.2, ..ball },
    ];
    for (k, material) in materials.into_iter().enumerate() {
        let at = DVec3::new(k as f64 % 2.0 - 0.5, (k / 2) as f64 - 0.5, 0.0) * 1.1;
        let mut ball = icosphere(4);
        ball.positions.iter_mut().for_each(|p| *p *= 0.5);
        ball.materials = vec![material];
        let ball = moved(ball, at);
        if k == 0 { all = ball } else { anamorph::internals::geometry::place::append(&mut all, ball) }
    }
    Scene { sky: Some(sky()), lights: vec![Light::distant(DVec3::new(-0.5, -1.0, -0.5))], ..scene(all) }
}

#[test]
#[ignore = "slow: make test-all"]
fn surfaces_send_back_what_comes_from_around() {
    let Some(mut engine) = engine_on(|_| {}) else { return };
    let scene = balls();
    for (name, camera) in cameras().into_iter().take(6) {
        let exact = box_filtered(&scene, &camera, 16);
        for samples in [1, 4] {
            let seen = rendered(&mut engine, &scene, &camera, samples);
            assert!(seen.iter().flatten().all(|v| v.is_finite()));
            let error = flip(&exact, &seen, SIZE);
            println!("{name}, {samples} samples: FLIP {error:.4}");
            assert!(error <= FLIP_MAX, "{name}, {samples} samples: FLIP {error}");
        }
    }
}

/// The kernels average an image along its longitudes and latitudes, which of a linear sky over a box w wide leaves 1 - w^2 / 24 of its
/// slope where a box on the sphere leaves 1 - w^2 / 12: wide lobes are that much off. The slope is 1 at most here.
#[test]
fn a_rough_metal_sends_back_the_mean_over_its_lobe() {
    let Some(mut engine) = engine_on(|_| {}) else { return };
    let (width, height) = (256, 128);
    let texel = |k: u32| {
        let latitude = std::f64::consts::PI * (0.5 - (f64::from(k / width) + 0.5) / f64::from(height));
        [1.0 + latitude.sin(), 1.0, 1.0 - 0.5 * latitude.sin(), 1.0].map(f16::from_f64)
    };
    let texels = Arc::new(Texels { width, height, rgba: (0..width * height).map(texel).collect() });
    let camera =
        camera_of("", SIZE, "kind = \"orthographic\"\neye = [0, 0, 4]\ntarget = [0, 0, 0]\nheight = 1").unwrap();
    for roughness in [0.0, 0.3, 0.5, 0.7] {
        let mut ball = icosphere(5);
        ball.materials = vec![Material { diffuse: [1.0; 3], metallic: 1.0, roughness, ..Material::default() }];
        let sky = Some(Arc::new(Sky::of(texels.clone(), 1.0, 0.0)));
        let scene = Scene { sky, lights: vec![Light::distant(DVec3::Z)], ..scene(ball) };
        let exact = box_filtered(&scene, &camera, 1);
        let seen = rendered(&mut engine, &scene, &camera, 1);
        let off = exact.iter().zip(&seen).flat_map(|(a, b)| (0..3).map(|k| (a[k] - b[k]).abs())).fold(0.0, f64::max);
        println!("roughness {roughness}: {off:.4} off");
        let width = 24f64.sqrt() * f64::from(roughness).powi(2);
        // and halves of values below 2
        let most = width * width / 24.0 + 2.0 / 2048.0;
        assert!(off <= most, "roughness {roughness}: {off} off, {most} may be");
    }
}

#[test]
fn a_scene_says_what_is_around_it() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("sky.hdr");
    let light: Vec<image::Rgb<f32>> = (0..8).map(|k| image::Rgb([k as f32, 100.0, 0.5])).collect();
    let mut bytes = Vec::new();
    image::codecs::hdr::HdrEncoder::new(&mut bytes).encode(&light, 4, 2).unwrap();
    std::fs::write(&path, &bytes).unwrap();
    let camera = "[camera]\nkind = \"orthographic\"\neye = [0, 0, 2]\ntarget = [0, 0, 0]\nheight = 2\n";
    let text =
        |keys: &str| format!("image = {{ width = 4, height = 4 }}\n[environment]\nfile = {:?}\n{keys}\n{camera}", path);
    let sky = load(&text("strength = 3\nrotate = 90\nbackground = false")).unwrap().sky.unwrap();
    assert_eq!((sky.strength, sky.rotation, sky.is_seen), (3.0, 0.25, false));
    assert_eq!(sky.image.texels.rgba[2].map(f16::to_f32), [2.0, 100.0, 0.5, 1.0]);
    for (keys, expected) in [
        ("strength = -1", "environment.strength: -1 is no strength"),
        ("turn = 3", "unknown key \"turn\" in environment"),
    ] {
        let message = load(&text(keys)).expect_err(keys).to_string();
        assert!(message.contains(expected) && !message.contains('\n'), "{message}");
    }
    let message = refusal(
        "[environment]\nfile = \"none.hdr\"",
        SIZE,
        "kind = \"orthographic\"\neye = [0, 0, 2]\ntarget = [0, 0, 0]\nheight = 2",
    );
    assert!(message.contains("none.hdr: cannot be read"), "{message}");
}
