//! Materials that shine, compared with their definition by the reference, through every kind of rays. Nothing to do without an adapter.

use crate::common;
use crate::pictures;

use anamorph::internals::camera::Camera;
use anamorph::internals::engine::RunOptions;
use anamorph::internals::engine::combinations::at_once;
use anamorph::internals::engine::plan::Wanted;
use anamorph::internals::geometry::mesh::Material;
use anamorph::internals::image::frame::{Channel, Frame};
use anamorph::internals::reference::image::image;
use anamorph::internals::scene::Scene;
use anamorph::internals::scene::light::Light;
use common::cameras::{MeshShape, glc_of_each_class, mesh_camera};
use common::file::{camera_of, load, refusal};
use common::gpu::engine_on;
use common::rng::Rng;
use common::{FORWARD, camera, scene, soup};
use glam::{DVec3, Vec3};
use pictures::{COLOUR, box_filtered, colours, psnr};
use std::sync::Arc;

const SIZE: (u32, u32) = (61, 45);

/// Every kind of rays.
fn cameras() -> Vec<(&'static str, Camera)> {
    let of = |text: &str| camera_of("", SIZE, text).unwrap();
    let view = "eye = [0.2, 0.3, 4]\ntarget = [0, 0, 0]\nvfov = 40";
    let kinds = glc_of_each_class();
    let mut list: Vec<_> = kinds.into_iter().take(4).map(|(name, kind)| (name, camera(kind, SIZE, FORWARD))).collect();
    list.extend([
        ("mesh", camera(mesh_camera(1, 16, 16, MeshShape { weights: true, ..MeshShape::default() }), SIZE, FORWARD)),
        ("fisheye", of("kind = \"fisheye\"\neye = [0.3, 0.2, 2.5]\ntarget = [0, 0, 0]\nfov = 100\nframe = \"full\"")),
        ("twist", of(&format!("kind = \"twist\"\n{view}\ndegree = 3\nangle = 40"))),
        (
            "reflection",
            of(
                "kind = \"reflection\"\ndepth = 1\neye = { kind = \"pinhole\", eye = [0.2, 0.4, 4], target = [0, 0, 0], vfov = 40 }\nmirror = { shape = \"sphere\", center = [0.9, 0.6, 1.2], radius = 0.6 }",
            ),
        ),
    ]);
    list
}

/// Triangles of all materials: matte and glossy, rough and smooth, metals and lamps.
fn shiny(lights: usize) -> Scene {
    let mut rng = Rng(12);
    let mut all = soup(&mut rng, 150, 0.5);
    let mut colour = || [rng.unit(), rng.unit(), rng.unit()].map(|c| c as f32);
    let mut materials = Vec::new();
    for (k, roughness) in [1.0, 0.7, 0.4, 0.2, 0.1, 0.0].into_iter().enumerate() {
        for metallic in [0.0, 0.5, 1.0] {
            let emissive = if k == 1 { colour() } else { [0.0; 3] };
            materials.push(Material {
                diffuse: colour(),
                specular: colour(),
                roughness,
                metallic,
                emissive,
                ..Material::default()
            });
        }
    }
    materials.push(Material::default());
    let count = materials.len() as u32;
    all.material_of = (0..all.triangles.len() as u32).map(|k| k % count).collect();
    all.materials = materials;
    let directions = [DVec3::new(-0.3, -0.5, -1.0), DVec3::new(0.8, 0.1, -0.4), DVec3::new(0.0, 1.0, -0.1)];
    Scene { lights: directions[..lights].iter().map(|d| Light::distant(*d)).collect(), ..scene(all) }
}

fn planes(frame: &Frame) -> [&[f32]; 3] {
    COLOUR.map(|c| frame.f32(c).unwrap())
}

/// Rounding of one f32 operation, relative.
const UNIT: f64 = f32::EPSILON as f64 / 2.0;

/// What f32 leaves of a unit vector: the ray's stored numbers, their sums and a division, and its length; normals alike.
const VECTOR_UNITS: f64 = 16.0;

#[test]
fn materials_shine_as_the_reference_says() {
    let Some(mut engine) = engine_on(|_| {}) else { return };
    for lights in [0, 1, 3] {
        let scene = shiny(lights);
        for (name, camera) in cameras() {
            let channels = [&COLOUR[..], &[Channel::TriangleId]].concat();
            let exact = image(&scene, &camera, &channels);
            let seen = engine.render(&scene, &camera, &Wanted::of(channels), &RunOptions::default()).unwrap().frame;
            let ids = [&exact, &seen].map(|f| f.u32(Channel::TriangleId).unwrap());
            let (mut most, mut brightest, mut compared) = (0.0f64, 0.0f64, 0);
            for k in (0..ids[0].len()).filter(|&k| ids[0][k] == ids[1][k]) {
                let Some(&material) = scene.mesh.material_of.get(ids[0][k] as usize) else { continue };
                // of microfacets a highlight of value v changes by up to 2 v / alpha a radian, of light and viewer at grazing angles by
                // the share that they see of it, which falls off as their cosine does
                compared += 1;
                let alpha = f64::from(scene.mesh.materials[material as usize].alpha());
                let lamps = lights.max(1) as f64;
                for (a, b) in planes(&exact).iter().zip(planes(&seen)) {
                    let (a, b) = (f64::from(a[k]), f64::from(b[k]));
                    let bound = VECTOR_UNITS * UNIT * lamps * (1.0 + a) * (1.0 + 4.0 / alpha);
                    most = most.max((a - b).abs() / bound);
                    brightest = brightest.max(a);
                }
            }
            println!("{name}, {lights} lights: {most:.3} of what rounding may be off, {brightest:.1} at the brightest");
            assert!(compared > 300, "{name}: {compared} hits");
            assert!(most <= 1.0, "{name}, {lights} lights: {most} of what rounding may be off");
        }
    }
}

/// A sample that is shaded by itself is no further off than a centre; one that shares its triangle's colour with others is lit as
/// another place of the pixel, so the whole is measured.
#[test]
fn samples_shine_as_the_reference_s_do() {
    let Some(mut engine) = engine_on(|_| {}) else { return };
    let mut scene = shiny(1);
    // highlights that are wider than a pixel
    Arc::make_mut(&mut scene.mesh).materials.iter_mut().for_each(|m| m.roughness = m.roughness.max(0.4));
    let mut kinds = 0;
    for (name, camera) in cameras().into_iter().filter(|(_, camera)| at_once(&scene, camera, 16)) {
        let mut seen = |samples| {
            let wanted = Wanted { samples, ..Wanted::of(COLOUR.to_vec()) };
            colours(&engine.render(&scene, &camera, &wanted, &RunOptions::default()).unwrap().frame)
        };
        let (one, many) = (seen(1), seen(16));
        let exact = box_filtered(&scene, &camera, 16);
        let [one, many] = [one, many].map(|seen| psnr(&exact, &seen));
        println!("{name}: {one:.1} dB by centres, {many:.1} dB by 16 samples");
        assert!(many >= 35.0 && many > one + 6.0, "{name}: {one} dB by centres, {many} dB by 16 samples");
        kinds += 1;
    }
    assert!(kinds >= 5, "{kinds} kinds");
}

/// Light that goes straight on along the view: no facet refracts it, whatever the normals that the file gives say.
#[test]
fn light_straight_through_makes_no_nan() {
    let Some(mut engine) = engine_on(|_| {}) else { return };
    let mut scene = shiny(0);
    // smooth normals that face away from what the triangle faces
    let mesh = Arc::make_mut(&mut scene.mesh);
    mesh.normals = vec![Vec3::new(0.0, 0.6, 0.8), Vec3::new(0.8, 0.0, 0.6), Vec3::new(0.0, -0.6, 0.8)];
    mesh.corner_normals = vec![[0, 1, 2]; mesh.triangles.len()];
    let camera =
        camera_of("", SIZE, "kind = \"orthographic\"\neye = [0, 0, 4]\ntarget = [0, 0, 0]\nheight = 2").unwrap();
    scene.lights = [DVec3::Z, DVec3::NEG_Z].map(Light::distant).to_vec();
    let exact = image(&scene, &camera, &COLOUR);
    let seen = engine.render(&scene, &camera, &Wanted::of(COLOUR.to_vec()), &RunOptions::default()).unwrap().frame;
    for (a, b) in planes(&exact).iter().zip(planes(&seen)) {
        assert!(a.iter().chain(b).all(|v| v.is_finite()));
    }
    let error = psnr(&colours(&exact), &colours(&seen));
    assert!(error > 60.0, "{error} dB");
}

#[test]
fn a_mesh_says_how_it_shines() {
    let scene = |keys: &str| {
        load(&format!(
            "image = {{ width = 4, height = 4 }}\n[[mesh]]\nbuiltin = \"box\"\n{keys}\n[camera]\nkind = \"orthographic\"\neye = [0, 0, 2]\ntarget = [0, 0, 0]\nheight = 2\n"
        ))
    };
    let material = |keys: &str| scene(keys).unwrap().mesh.materials[0].clone();
    let plain = Material::default();
    assert_eq!(material(""), plain);
    assert_eq!(material("roughness = 0.3"), Material { roughness: 0.3, specular: [0.04; 3], ..plain.clone() });
    assert_eq!(
        material("metallic = 1\nspecular = [0.1, 0.2, 0.3]"),
        Material { metallic: 1.0, specular: [0.1, 0.2, 0.3], ..plain.clone() }
    );
    assert_eq!(material("emissive = [0, 2, 7]"), Material { emissive: [0.0, 2.0, 7.0], ..plain });
    for (keys, expected) in [
        ("roughness = 1.5", "mesh.0.roughness: 1.5 does not lie in [0, 1]"),
        ("metallic = -1", "mesh.0.metallic: -1 does not lie in [0, 1]"),
        ("emissive = [0, -1, 0]", "mesh.0.emissive: there is no less light than none"),
        ("emissive = [0, 1e39, 0]", "mesh.0.emissive: there is no less light than none and no more than f32 holds"),
        ("specular = 2", "mesh.0.specular: 2 does not lie in [0, 1]"),
        ("texture = { repeat = 2 }", "mesh.0.texture: file is missing"),
        ("texture = { file = \"no.png\", cutoff = 2 }", "mesh.0.texture.cutoff: 2 does not lie in [0, 1]"),
        ("texture = \"no.png\"", "no.png: cannot be read"),
    ] {
        let message = scene(keys).expect_err(keys).to_string();
        assert!(message.contains(expected) && !message.contains('\n'), "{message}");
    }
    let message = refusal(
        "[[mesh]]\nbuiltin = \"city\"\ntexture = \"a.png\"",
        SIZE,
        "kind = \"orthographic\"\neye = [0, 0, 2]\ntarget = [0, 0, 0]\nheight = 2",
    );
    assert!(message.contains("mesh city: has no texture coordinates"), "{message}");
}
