//! Images on triangles: their filtered means against the mean of many rays of the reference, through every kind of rays. Nothing to do
//! without an adapter.

use crate::common;
use crate::pictures;
use anamorph::internals::input::Loading;

use anamorph::internals::camera::{Camera, Rays};
use anamorph::internals::engine::combinations::at_once;
use anamorph::internals::engine::plan::Wanted;
use anamorph::internals::engine::plan::samples::sample_offsets;
use anamorph::internals::engine::{Engine, RunOptions};
use anamorph::internals::geometry::mesh::{Material, NO_UV};
use anamorph::internals::geometry::texture::{Texels, Texture, Wrap};
use anamorph::internals::image::frame::{Channel, Frame, NO_ID};
use anamorph::internals::image::png_bytes;
use anamorph::internals::reference::image::image;
use anamorph::internals::scene::Scene;
use anamorph::internals::scene::light::Light;
use common::cameras::{MeshShape, mesh_camera};
use common::file::camera_of;
use common::gpu::{Without, check, engine_on, hits, ids, limit_bindings, render, render_with};
use common::layered::chain;
use common::rng::Rng;
use common::{FORWARD, camera, mesh, scene, soup};
use glam::{DVec3, Vec2, Vec3};
use half::f16;
use pictures::{COLOUR, Colours, box_filtered, colours, flip, psnr};
use std::sync::Arc;

const SIZE: (u32, u32) = (80, 60);

fn texels(width: u32, height: u32, value: impl Fn(u32, u32) -> [f32; 4]) -> Arc<Texels> {
    let rgba = (0..width * height).map(|k| value(k % width, k / width).map(f16::from_f32)).collect();
    Arc::new(Texels { width, height, rgba })
}

fn grey(v: f32) -> [f32; 4] {
    [v, v, v, 1.0]
}

/// Two by two squares.
fn checker() -> Texture {
    let colour = |light: bool| if light { [0.8, 0.7, 0.6, 1.0] } else { [0.02, 0.05, 0.12, 1.0] };
    Texture::new(texels(64, 64, |x, y| colour((x / 32 + y / 32) % 2 == 1)))
}

/// Rings that grow finer outwards, down to two texels at the borders; halves of its sides are soon odd.
fn zone_plate() -> Texture {
    const SIDE: u32 = 500;
    let phase = |x: u32, y: u32| {
        let [x, y] = [x, y].map(|k| f64::from(k) + 0.5 - f64::from(SIDE) / 2.0);
        std::f64::consts::PI * (x * x + y * y) / f64::from(SIDE)
    };
    Texture::new(texels(SIDE, SIDE, |x, y| grey(0.5 + 0.5 * phase(x, y).cos() as f32)))
}

/// A horizontal square, and how often an image lies along its sides.
fn floor(size: f64, height: f64, repeat: f32, texture: Texture) -> Scene {
    let half = size / 2.0;
    let corners = [(-half, half), (half, half), (half, -half), (-half, -half)];
    let positions = corners.map(|(x, z)| DVec3::new(x, height, z)).to_vec();
    let mut mesh = mesh(positions, vec![[0, 1, 2], [0, 2, 3]]);
    mesh.uvs = [Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y].map(|uv| uv * repeat).to_vec();
    mesh.corner_uvs = mesh.triangles.clone();
    mesh.materials = vec![Material { diffuse: [1.0; 3], texture: Some(texture), ..Material::default() }];
    // straight down, so that light is the same everywhere
    Scene { lights: vec![Light::distant(DVec3::NEG_Y)], ..scene(mesh) }
}

/// Every kind of rays, from above the floor.
pub fn families(size: (u32, u32)) -> Vec<(&'static str, Camera)> {
    let of = |text: &str| camera_of("", size, text).unwrap();
    let look = "eye = [0.3, 0.9, 3]\ntarget = [0, -0.4, 0]";
    let pinhole = format!("{look}\nvfov = 50");
    vec![
        ("pinhole", of(&format!("kind = \"pinhole\"\n{pinhole}"))),
        (
            "cross-slit",
            of(&format!(
                "kind = \"cross_slit\"\n{look}\nheight = 3\nslits = [{{ distance = 2.2, angle = 0 }}, {{ distance = 3.5, angle = 90 }}]"
            )),
        ),
        ("mesh of 16 x 16", camera(mesh_camera(1, 16, 16, MeshShape::default()), size, FORWARD)),
        (
            "weighted mesh",
            camera(mesh_camera(1, 6, 5, MeshShape { weights: true, ..MeshShape::default() }), size, FORWARD),
        ),
        ("fisheye", of(&format!("kind = \"fisheye\"\n{look}\nfov = 150\nframe = \"full\""))),
        ("curved projector", of(&format!("kind = \"twist\"\n{pinhole}\ndegree = 3\nangle = 30"))),
        (
            "mirror",
            of(
                "kind = \"reflection\"\ndepth = 1\neye = { kind = \"pinhole\", eye = [0.3, 0.9, 4], target = [0, 0, 0], vfov = 32 }\nmirror = { shape = \"sphere\", center = [0, 0, 0], radius = 0.9 }",
            ),
        ),
    ]
}

fn rendered(engine: &mut Engine, scene: &Scene, camera: &Camera) -> Colours {
    colours(&engine.render(scene, camera, &Wanted::of(COLOUR.to_vec()), &RunOptions::default()).unwrap().frame)
}

/// What `--samples 1` may differ from 256 rays per pixel.
const FLIP_MAX: f64 = 0.05;

#[test]
fn filtered_images_look_like_many_rays_a_pixel() {
    let Some(mut engine) = engine_on(|_| {}) else { return };
    let scenes =
        [("checker", floor(4000.0, -1.0, 2000.0, checker())), ("zone plate", floor(6.0, -1.0, 1.0, zone_plate()))];
    for (what, scene) in scenes {
        let mut unfiltered_most = 0.0f64;
        for (name, camera) in families(SIZE) {
            let exact = box_filtered(&scene, &camera, 64);
            let seen = rendered(&mut engine, &scene, &camera);
            assert!(seen.iter().flatten().all(|v| v.is_finite()), "{what}, {name}");
            let (error, db) = (flip(&exact, &seen, SIZE), psnr(&exact, &seen));
            let unfiltered = flip(&exact, &box_filtered(&scene, &camera, 1), SIZE);
            println!("{what}, {name}: FLIP {error:.4}, {db:.1} dB; unfiltered FLIP {unfiltered:.4}");
            assert!(error <= FLIP_MAX && error < unfiltered, "{what}, {name}: FLIP {error}, unfiltered {unfiltered}");
            unfiltered_most = unfiltered_most.max(unfiltered);
        }
        // the measure sees what is not filtered
        assert!(unfiltered_most > FLIP_MAX, "{what}");
    }
}

#[test]
fn borders_of_pieces_do_not_show() {
    let Some(mut engine) = engine_on(|_| {}) else { return };
    let scene = floor(4000.0, -1.0, 2000.0, checker());
    let camera = camera(mesh_camera(1, 16, 16, MeshShape::default()), SIZE, FORWARD);
    let exact = box_filtered(&scene, &camera, 256);
    let wanted = Wanted::of([&COLOUR[..], &[Channel::PieceId]].concat());
    let frame = engine.render(&scene, &camera, &wanted, &RunOptions::default()).unwrap().frame;
    let (seen, pieces) = (colours(&frame), frame.u32(Channel::PieceId).unwrap());
    let (w, h) = (SIZE.0 as usize, SIZE.1 as usize);
    let mut errors = [(0.0, 0usize); 2];
    for k in (0..w * h).filter(|&k| pieces[k] != NO_ID) {
        let beside = [(k % w + 1 < w).then_some(k + 1), (k / w + 1 < h).then_some(k + w)];
        let at_border = beside.into_iter().flatten().any(|n| pieces[n] != pieces[k] && pieces[n] != NO_ID);
        let group = &mut errors[usize::from(at_border)];
        *group = (group.0 + (seen[k][0] - exact[k][0]).abs(), group.1 + 1);
    }
    let [inside, border] = errors.map(|(sum, count)| sum / count as f64);
    println!("mean error {inside:.4} inside pieces, {border:.4} at their borders, of {} pixels", errors[1].1);
    assert!(errors[1].1 > 500);
    // thousands of pixels each: their means are as near as chance brings them
    assert!(border < 1.2 * inside, "{border} at borders, {inside} elsewhere");
}

/// An image of so many texels a side, no two near ones alike.
fn patches(width: u32, height: u32) -> Texture {
    Texture::new(texels(width, height, |x, y| {
        let mut rng = Rng(u64::from(x * 1000 + y));
        [rng.unit() as f32, rng.unit() as f32, rng.unit() as f32, 1.0]
    }))
}

#[test]
fn magnified_texels_are_bilinear_and_go_on_as_the_borders_say() {
    let Some(mut engine) = engine_on(|_| {}) else { return };
    // an image of 2 x 3 texels is 40 px wide
    let view = "kind = \"orthographic\"\neye = [0, 5, 0]\ntarget = [0, 0, 0]\nup = [0, 0, -1]\nheight = 1";
    let camera = camera_of("", SIZE, view).unwrap();
    for wrap in [Wrap::Repeat, Wrap::Clamp, Wrap::Mirror] {
        let texture = Texture { wrap: [wrap, wrap], ..patches(2, 3) };
        let mut scene = floor(1.5, 0.0, 3.0, texture);
        Arc::make_mut(&mut scene.mesh).uvs.iter_mut().for_each(|uv| *uv -= Vec2::ONE);
        let exact = box_filtered(&scene, &camera, 1);
        let seen = rendered(&mut engine, &scene, &camera);
        let texels_a_pixel = 3.0 * 3.0 / 1.5 / f64::from(SIZE.1);
        // see filter.wgsl: so much of the next level is mixed in; and f32 rounds places of texels in [0, 6]
        let level = 0.5 * (1.0 + texels_a_pixel.powi(2) / 3.0).log2();
        let most = level + 6.0 * 8.0 * f64::from(f32::EPSILON);
        for (k, (a, b)) in exact.iter().zip(&seen).enumerate() {
            let off = (0..3).map(|c| (a[c] - b[c]).abs()).fold(0.0, f64::max);
            assert!(off <= most, "{wrap:?}: pixel {k} is {off} off, {most} may be");
        }
    }
}

#[test]
fn images_of_one_colour_are_that_colour_everywhere() {
    let Some(mut engine) = engine_on(|_| {}) else { return };
    let colour = [0.75, 0.5, 0.25];
    for (name, camera) in families(SIZE) {
        let image = floor(4000.0, -1.0, 900.0, Texture::new(texels(37, 53, |_, _| [0.75, 0.5, 0.25, 1.0])));
        let mut plain = image.clone();
        Arc::make_mut(&mut plain.mesh).materials[0] = Material { diffuse: colour, ..Material::default() };
        for samples in [1, 4] {
            if !at_once(&plain, &camera, samples) {
                continue;
            }
            let wanted = Wanted { samples, ..Wanted::of(COLOUR.to_vec()) };
            let [a, b] = [&image, &plain].map(|scene| {
                let frame = engine.render(scene, &camera, &wanted, &RunOptions::default()).unwrap().frame;
                colours(&frame)
            });
            let off = a.iter().flatten().zip(b.iter().flatten()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            // of up to 16 taps, each of 7 mixtures; and levels whose weights add up to 1 in f32, halves of f16 that round alike
            assert!(off <= 64.0 * f64::from(f32::EPSILON), "{name}, {samples} samples: {off} off");
        }
    }
}

/// Images are numbered by frames: black and white in red, green and blue are the digits of the number.
#[test]
fn a_video_shows_each_frame_its_own_image() {
    const NUMBERS: [u32; 6] = [0, 1, 2, 3, 5, 6];
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("video")).unwrap();
    let bits = |number: u32| [0, 1, 2].map(|bit| number >> bit & 1);
    for number in NUMBERS {
        let [r, g, b] = bits(number).map(|bit| 255 * bit as u8);
        let bytes = png_bytes(4, 4, &[r, g, b, 255].repeat(16)).unwrap();
        for name in [format!("video/{number:04}.png"), format!("video/{number}.png")] {
            std::fs::write(folder.path().join(name), &bytes).unwrap();
        }
    }
    let path = folder.path().join("scene.toml");
    let load = |texture: &str, camera: &str, frame: f64| {
        let text = format!(
            "image = {{ width = 32, height = 24 }}\n[[mesh]]\nbuiltin = \"plane\"\nsize = 9\ntexture = \"{texture}\"\n\
             translate = [{{ frame = 0, value = [-1, 0, 0] }}, {{ frame = 9, value = [1, 0, 0] }}]\n\
             [camera]\nkind = \"orthographic\"\neye = [0, 5, 0]\ntarget = [0, 0, 0]\nup = [0, 0, -1]\nheight = 4\n{camera}\n"
        );
        std::fs::write(&path, text).unwrap();
        Scene::load(&path, &[], frame, &Loading::default())
    };
    let channels = [Channel::AlbedoR, Channel::AlbedoG, Channel::AlbedoB];
    let mut engine = engine_on(|_| {});
    // between two frames the lower number counts, and rows that are read one after the other during five frames show one image
    let rows = "line_time = 0.2";
    let mut cases: Vec<(f64, u32, &str)> = NUMBERS.iter().map(|number| (f64::from(*number), *number, "")).collect();
    cases.extend([(2.75, 2, ""), (5.999, 5, ""), (1.0, 1, rows), (2.5, 2, rows)]);
    for (frame, number, camera) in cases {
        for texture in ["video/{frame:04}.png", "video/{frame}.png"] {
            let scene = load(texture, camera, frame).unwrap();
            assert_eq!(scene.steps.is_some(), !camera.is_empty());
            let camera = scene.camera().unwrap();
            let rendered = engine.as_mut().map(|engine| {
                engine.render(&scene, &camera, &Wanted::of(channels.to_vec()), &RunOptions::default()).unwrap().frame
            });
            for frame in [image(&scene, &camera, &channels)].into_iter().chain(rendered) {
                for (channel, bit) in channels.into_iter().zip(bits(number)) {
                    let values = frame.f32(channel).unwrap();
                    let off = values.iter().map(|v| (v - bit as f32).abs()).fold(0.0, f32::max);
                    // as above: of up to 16 taps, each of 7 mixtures
                    assert!(off <= 64.0 * f32::EPSILON, "frame {number}, {channel:?}: {off} off");
                }
            }
        }
    }
    let error = load("video/{frame:04}.png", "", 4.5).unwrap_err().to_string();
    assert!(error.contains("video/0004.png") && !error.contains('\n'), "{error}");
}

/// A ball of radius 1 with its own normals, and an image around it of 32 x 16 patches of random grey, uniform in [0, 1].
fn patched_ball(columns: u32, rows: u32) -> Scene {
    let mut rng = Rng(5);
    let patches: Vec<f32> = (0..32 * 16).map(|_| rng.unit() as f32).collect();
    let image = texels(256, 128, |x, y| grey(patches[(y / 8 * 32 + x / 8) as usize]));
    let at = |i: u32, j: u32| {
        let (u, v) = (f64::from(i) / f64::from(columns), f64::from(j) / f64::from(rows));
        let ((sin, cos), (up, out)) =
            ((std::f64::consts::TAU * u).sin_cos(), (std::f64::consts::PI * (v - 0.5)).sin_cos());
        (DVec3::new(out * sin, up, out * cos), Vec2::new(u as f32, v as f32))
    };
    let places = || (0..=rows).flat_map(|j| (0..=columns).map(move |i| at(i, j)));
    // without the two caps at the poles
    let quads = (1..rows - 1).flat_map(|j| (0..columns).map(move |i| j * (columns + 1) + i));
    let triangles = quads.flat_map(|k| [[k, k + 1, k + columns + 2], [k, k + columns + 2, k + columns + 1]]).collect();
    let mut ball = mesh(places().map(|p| p.0).collect(), triangles);
    (ball.uvs, ball.normals) = (places().map(|p| p.1).collect(), places().map(|p| p.0.as_vec3()).collect());
    (ball.corner_uvs, ball.corner_normals) = (ball.triangles.clone(), ball.triangles.clone());
    ball.materials = vec![Material { diffuse: [1.0; 3], texture: Some(Texture::new(image)), ..Material::default() }];
    scene(ball)
}

/// The mean and the largest difference between a pixel's filtered albedo and the mean of those of 16 x 16 rays that hit the ball: first
/// for pixels that see their triangle under a cosine below 0.1, then for those above 0.4.
fn errors_near_and_far_from_the_horizon(engine: &mut Engine, ball: &Scene, keys: &str) -> [(f64, f64); 2] {
    const FINE: u32 = 16;
    let [camera, finer] = [1, FINE].map(|n| camera_of("", (n * SIZE.0, n * SIZE.1), keys).unwrap());
    let channels = [Channel::A, Channel::AlbedoR, Channel::TriangleId];
    let seen = engine.render(ball, &camera, &Wanted::of(channels.to_vec()), &RunOptions::default()).unwrap().frame;
    let fine = image(ball, &finer, &channels);
    let (covered, albedo) = (fine.f32(Channel::A).unwrap(), fine.f32(Channel::AlbedoR).unwrap());
    let mut errors = [Vec::new(), Vec::new()];
    for (k, &id) in ids(&seen).iter().enumerate().filter(|(_, id)| **id != NO_ID) {
        let (i, j) = (k as u32 % SIZE.0, k as u32 / SIZE.0);
        let [a, b, c] = ball.mesh.triangles[id as usize].map(|v| ball.mesh.positions[v as usize]);
        let cosine = (b - a).cross(c - a).normalize().dot(camera.ray(i, j).unwrap().direction.normalize()).abs();
        let at = |n: u32| ((FINE * j + n / FINE) * FINE * SIZE.0 + FINE * i + n % FINE) as usize;
        let sum = |plane: &[f32]| (0..FINE * FINE).map(|n| f64::from(plane[at(n)])).sum::<f64>();
        let error = (f64::from(seen.f32(Channel::AlbedoR).unwrap()[k]) - sum(albedo) / sum(covered)).abs();
        if !(0.1..=0.4).contains(&cosine) {
            errors[usize::from(cosine > 0.4)].push(error);
        }
    }
    assert!(errors[0].len() > 10, "{} pixels at the horizon", errors[0].len());
    errors.map(|e| (e.iter().sum::<f64>() / e.len() as f64, e.iter().copied().fold(0.0, f64::max)))
}

/// A pixel at the horizon of a curved surface covers what turns towards the viewer, and nothing beyond the horizon. There the filter may
/// misplace a share q of its weights. The image is in [0, 1], so that changes a mean by q at most; two uniform numbers differ by 1/3 on
/// average, so by q / 3 on average. The filter's other errors are measured far from the horizon. q adds up from
/// * the pixel's shape: a square whose sides are at 45 degrees to the horizon is as wide as a triangle and is taken for a box; 0.172 of one
///   lies outside the other, and 0.104 on average over all directions;
/// * 16 taps: each blurs the footprint's end, where weights are twice the mean, by the deviation of a box of 1/16: 2 / 2 / 16 / sqrt(12);
/// * triangles: their cosines are off by up to half of the angle between two, pi / COLUMNS, by half of that on average. The footprint's
///   ends move by as much, on an arc of at least 1 / sqrt(R) with R px the ball's radius, 40 at most here. Again weights are twice the
///   mean.
#[test]
#[ignore = "slow: make test-all"]
fn images_on_curved_surfaces_are_filtered_up_to_the_horizon() {
    const COLUMNS: u32 = 512;
    let taps = 1.0 / 16.0 / 12f64.sqrt();
    let triangles = 2.0 * std::f64::consts::PI / f64::from(COLUMNS) * 40f64.sqrt();
    let q_mean = 0.104 + taps + 0.5 * triangles;
    let q_most = 0.172 + taps + triangles;
    let Some(mut engine) = engine_on(|_| {}) else { return };
    let ball = patched_ball(COLUMNS, COLUMNS / 2);
    let look = "eye = [0.7, 1.1, 3.4]\ntarget = [0, 0, 0]";
    let slits = "slits = [{ distance = 2.2, angle = 0 }, { distance = 3.5, angle = 90 }]";
    for (name, keys) in [
        ("pinhole", format!("kind = \"pinhole\"\n{look}\nvfov = 37")),
        ("cross-slit", format!("kind = \"cross_slit\"\n{look}\nheight = 2.4\n{slits}")),
        (
            "fisheye",
            "kind = \"fisheye\"\neye = [0.35, 0.55, 1.5]\ntarget = [0, 0, 0]\nfov = 110\nframe = \"full\"".into(),
        ),
    ] {
        let [(mean, most), (far_mean, far_most)] = errors_near_and_far_from_the_horizon(&mut engine, &ball, &keys);
        println!(
            "{name}: {mean:.4} off on average, {most:.3} at most; {far_mean:.4} and {far_most:.3} far from the horizon"
        );
        assert!(mean <= q_mean / 3.0 + far_mean, "{name}: {mean} off on average");
        assert!(most <= q_most + far_most, "{name}: {most} off at most");
    }
}

/// Normals that do not turn change nothing.
#[test]
fn images_on_flat_surfaces_are_the_same_with_normals_and_without() {
    let Some(mut engine) = engine_on(|_| {}) else { return };
    let plain = floor(4000.0, -1.0, 2000.0, checker());
    let mut with_normals = plain.clone();
    let mesh = Arc::make_mut(&mut with_normals.mesh);
    mesh.normals = vec![Vec3::Y];
    mesh.corner_normals = vec![[0; 3]; mesh.triangles.len()];
    let albedo = [Channel::AlbedoR, Channel::AlbedoG, Channel::AlbedoB];
    for (name, camera) in families(SIZE) {
        let [a, b] = [&plain, &with_normals].map(|scene| {
            let frame =
                engine.render(scene, &camera, &Wanted::of(albedo.to_vec()), &RunOptions::default()).unwrap().frame;
            albedo.map(|c| frame.f32(c).unwrap().iter().map(|v| v.to_bits()).collect::<Vec<_>>())
        });
        assert!(a == b, "{name}");
    }
}

#[test]
fn many_images_of_all_sizes_lie_beside_each_other() {
    let Some(mut engine) = engine_on(|_| {}) else { return };
    const SIDE: usize = 18;
    let mut rng = Rng(5);
    let (mut all, mut colours_of) = (mesh(Vec::new(), Vec::new()), Vec::new());
    all.materials.clear();
    for k in 0..SIDE * SIDE {
        let colour = [rng.unit(), rng.unit(), rng.unit()].map(|v| f16::from_f64(v).to_f32());
        let [r, g, b] = colour;
        let size = [1 + rng.below(40) as u32, 1 + rng.below(40) as u32];
        let at = DVec3::new((k % SIDE) as f64, 0.0, (k / SIDE) as f64);
        let first = all.positions.len() as u32;
        all.positions.extend([at, at + DVec3::Z, at + DVec3::X, at + DVec3::X + DVec3::Z]);
        all.triangles.extend([[first, first + 1, first + 2], [first + 2, first + 1, first + 3]]);
        let repeat = (8.0 * rng.unit() - 4.0).exp2() as f32;
        all.uvs.extend([Vec2::ZERO, Vec2::X, Vec2::Y, Vec2::ONE].map(|uv| repeat * uv));
        let texture = Texture::new(texels(size[0], size[1], |_, _| [r, g, b, 1.0]));
        all.materials.push(Material { diffuse: [1.0; 3], texture: Some(texture), ..Material::default() });
        all.material_of.resize(all.triangles.len(), k as u32);
        colours_of.push(colour);
    }
    all.corner_uvs = all.triangles.clone();
    let scene = Scene { lights: vec![Light::distant(DVec3::NEG_Y)], ..scene(all) };
    let view = format!(
        "kind = \"orthographic\"\neye = [{0}, 5, {0}]\ntarget = [{0}, 0, {0}]\nup = [0, 0, -1]\nheight = {SIDE}",
        SIDE as f64 / 2.0
    );
    let side = 8 * SIDE as u32;
    let camera = camera_of("", (side, side), &view).unwrap();
    let small = engine_on(|gpu| gpu.limits.max_texture_dimension_2d = 128).unwrap();
    for engine in [&mut engine, &mut { small }] {
        let seen = rendered(engine, &scene, &camera);
        for (k, colour) in seen.iter().enumerate() {
            let at = k / side as usize / 8 * SIDE + k % side as usize / 8;
            let off = (0..3).map(|c| (colour[c] - f64::from(colours_of[at][c])).abs()).fold(0.0, f64::max);
            assert!(off <= 64.0 * f64::from(f32::EPSILON), "image {at} is {off} off");
        }
    }
    engine = engine_on(|gpu| gpu.limits.max_texture_dimension_2d = 32).unwrap();
    let message = engine.render(&scene, &camera, &Wanted::of(COLOUR.to_vec()), &RunOptions::default()).unwrap_err();
    assert!(message.to_string().contains("the adapter has 32 a side"), "{message}");
    // what does not show them does not need them
    engine.render(&scene, &camera, &Wanted::of(vec![Channel::Z]), &RunOptions::default()).unwrap();
}

#[test]
#[ignore = "slow: make test-all"]
fn frames_that_make_a_picture_together_are_filtered_less() {
    let Some(mut engine) = engine_on(|_| {}) else { return };
    let scene = floor(6.0, -1.0, 1.0, zone_plate());
    let (name, camera) = families(SIZE).swap_remove(5);
    let exact = box_filtered(&scene, &camera, 256);
    let mean = |engine: &mut Engine, frames: u32| {
        let wanted = Wanted { frames, ..Wanted::of(COLOUR.to_vec()) };
        let mut sum = vec![[0.0; 3]; exact.len()];
        for place in sample_offsets(16) {
            let moved = camera.with_sample_offset(place.x, place.y);
            let frame = engine.render(&scene, &moved, &wanted, &RunOptions::default()).unwrap().frame;
            sum.iter_mut().zip(colours(&frame)).for_each(|(s, c)| (0..3).for_each(|k| s[k] += c[k] / 16.0));
        }
        psnr(&exact, &sum)
    };
    let [wide, narrow] = [1, 16].map(|frames| mean(&mut engine, frames));
    println!("{name}: 16 frames {wide:.1} dB as wide as a pixel, {narrow:.1} dB as wide as a sample");
    assert!(narrow > wide + 3.0 && narrow >= 35.0);
}

/// An atlas keeps them too, as far as the texel that a pixel looks up is from its own place.
#[test]
fn texture_coordinates_come_out_of_an_atlas() {
    let Some(mut engine) = engine_on(|_| {}) else { return };
    let scene = floor(6.0, -1.0, 1.0, checker());
    let through = |atlas: &str| {
        let ball = "mirror = { builtin = \"icosphere\", level = 2, scale = 0.8 }\nfacets = \"flat\"";
        let eye = "eye = { kind = \"pinhole\", eye = [0.3, 0.9, 4], target = [0, 0, 0], vfov = 32 }";
        camera_of("", SIZE, &format!("kind = \"reflection\"\ndepth = 1\n{eye}\n{ball}\n{atlas}")).unwrap()
    };
    let wanted = Wanted::of(vec![Channel::TextureU, Channel::TextureV, Channel::MirrorId, Channel::TriangleId]);
    let [direct, atlas] =
        ["", "atlas = 64"].map(|a| engine.render(&scene, through(a), &wanted, &RunOptions::default()).unwrap().frame);
    let uv = |frame: &Frame, k: usize| [Channel::TextureU, Channel::TextureV].map(|c| frame.f32(c).unwrap()[k]);
    let mirrored = |k: &usize| {
        let is_turned = |f: &Frame| f.u32(Channel::MirrorId).unwrap()[*k] != NO_ID;
        is_turned(&direct) && ids(&direct)[*k] < 2 && ids(&atlas)[*k] == ids(&direct)[*k]
    };
    let all: Vec<usize> = (0..ids(&direct).len()).filter(mirrored).collect();
    let off = all.iter().map(|&k| {
        let ([u, v], [s, t]) = (uv(&direct, k), uv(&atlas, k));
        f64::from((u - s).hypot(v - t))
    });
    let mut off: Vec<f64> = off.collect();
    off.sort_by(f64::total_cmp);
    println!("{} pixels, median {:.4} off, most {:.4}", all.len(), off[off.len() / 2], off[off.len() - 1]);
    assert!(all.len() > 200 && off[off.len() / 2] < 0.02);
}

#[test]
fn texture_coordinates_are_a_channel() {
    let Some(mut engine) = engine_on(|_| {}) else { return };
    let uv = [Channel::TextureU, Channel::TextureV];
    for (name, camera) in families(SIZE) {
        let mut scene = floor(6.0, -1.0, 3.0, checker());
        // also without any image
        Arc::make_mut(&mut scene.mesh).materials[0].texture = None;
        let exact = image(&scene, &camera, &[&uv[..], &[Channel::TriangleId]].concat());
        let seen = engine.render(
            &scene,
            &camera,
            &Wanted::of(exact.planes.iter().map(|p| p.0).collect()),
            &RunOptions::default(),
        );
        let seen = seen.unwrap().frame;
        let hits = exact.u32(Channel::TriangleId).unwrap().iter().zip(seen.u32(Channel::TriangleId).unwrap());
        let same: Vec<usize> = hits.enumerate().filter(|(_, (a, b))| a == b).map(|(k, _)| k).collect();
        assert!(same.len() > exact.f32(uv[0]).unwrap().len() / 2);
        for channel in uv {
            let (a, b) = (exact.f32(channel).unwrap(), seen.f32(channel).unwrap());
            let off = same.iter().map(|&k| (a[k] - b[k]).abs()).fold(0.0, f32::max);
            // rays of about 10 units in f32 meet a floor of 6 units with 3 images, at 0.03 to one at least
            let most = 3.0 / 6.0 * 10.0 * 16.0 * f32::EPSILON / 0.03;
            assert!(off <= most, "{name}, {}: {off} off, {most} may be", channel.name());
        }
    }
}

/// Large squares and small triangles at all angles, with rings cut out of them.
pub fn masked_shapes() -> Scene {
    let ring = |x: u32, y: u32| {
        let [x, y] = [(x, 0.5), (y, 0.42)].map(|(k, middle)| (f64::from(k) + 0.5) / 32.0 - middle);
        let off = (x * x + y * y).sqrt();
        [0.9, 0.6, 0.3, if (0.15..0.4).contains(&off) { 1.0 } else { 0.1 }]
    };
    let texture = Texture { cutoff: Some(0.5), ..Texture::new(texels(32, 32, ring)) };
    let mut all = soup(&mut Rng(8), 24, 0.9);
    let small = soup(&mut Rng(9), 200, 0.1);
    let first = all.positions.len() as u32;
    all.positions.extend(&small.positions);
    all.triangles.extend(small.triangles.iter().map(|t| t.map(|v| v + first)));
    all.uvs = [Vec2::ZERO, Vec2::X, Vec2::Y].map(|uv| 2.3 * uv - Vec2::splat(0.4)).to_vec();
    all.corner_uvs = vec![[0, 1, 2]; all.triangles.len()];
    // some have no coordinates, and some no image
    all.corner_uvs[3] = [NO_UV; 3];
    all.materials = vec![Material { texture: Some(texture), ..Material::default() }, Material::default()];
    all.material_of = (0..all.triangles.len() as u32).map(|k| u32::from(k % 7 == 0)).collect();
    scene(all)
}

#[test]
#[ignore = "slow: make test-all"]
fn holes_are_seen_through_by_every_kind_of_rays() {
    let scene = masked_shapes();
    let mut solid = scene.clone();
    Arc::make_mut(&mut solid.mesh).materials[0].texture = None;
    const SMALL: (u32, u32) = (48, 36);
    let kinds = families(SMALL).into_iter().chain([("chain", chain(3, 3, (4, 3), MeshShape::default(), SMALL))]);
    for (name, camera) in kinds {
        let Some((frame, _, _)) = check(name, &scene, &camera) else { return };
        // a third of the hits are other ones at least
        let differ = render(&solid, &camera).map(|f| ids(&f).iter().zip(ids(&frame)).filter(|(a, b)| a != b).count());
        assert!(differ.unwrap() * 3 > hits(&frame), "{name}: {differ:?} of {}", hits(&frame));
        // kernels without f64 take long to compile
        let lesser = [Without::Int64Atomics, Without::F64];
        for without in lesser.into_iter().take(if name == "pinhole" { 2 } else { 1 }) {
            let less = render_with(&scene, &camera, without, &RunOptions::default()).unwrap();
            assert!(ids(&less.frame) == ids(&frame), "{name} without {without:?}");
        }
    }
}

/// A floor before a few hundred triangles, all with images.
fn furnished() -> Scene {
    let mut scene = floor(40.0, -1.0, 20.0, checker());
    let soup = soup(&mut Rng(4), 2000, 0.2);
    let (first, uv) = (scene.mesh.positions.len() as u32, scene.mesh.uvs.len() as u32);
    Arc::make_mut(&mut scene.mesh).positions.extend(&soup.positions);
    Arc::make_mut(&mut scene.mesh).uvs.extend([Vec2::ZERO, Vec2::X, Vec2::Y]);
    Arc::make_mut(&mut scene.mesh).corner_uvs.resize(2 + soup.triangles.len(), [uv, uv + 1, uv + 2]);
    Arc::make_mut(&mut scene.mesh).triangles.extend(soup.triangles.iter().map(|t| t.map(|v| v + first)));
    Arc::make_mut(&mut scene.mesh).materials.push(Material { texture: Some(zone_plate()), ..Material::default() });
    let mesh = Arc::make_mut(&mut scene.mesh);
    mesh.material_of = (0..mesh.triangles.len()).map(|k| u32::from(k >= 2)).collect();
    scene
}

/// Chunks of the scene and bands of the image see the same images; the first row of a band of rays or curves has neighbours on one side
/// alone.
#[test]
fn images_are_the_same_in_chunks_and_bands() {
    let scene = furnished();
    let Some(mut whole) = engine_on(|_| {}) else { return };
    let mut parts = engine_on(|gpu| limit_bindings(gpu, 1 << 16)).unwrap();
    for (name, camera) in families(SIZE) {
        let wanted = Wanted { srgb8: true, ..Wanted::of(COLOUR.to_vec()) };
        let [a, b] = [&mut whole, &mut parts]
            .map(|engine| engine.render(&scene, &camera, &wanted, &RunOptions::default()).unwrap());
        assert!(b.passes.total() > a.passes.total(), "{name}: {:?}, {:?} in parts", a.passes, b.passes);
        let (a, b) = (colours(&a.frame), colours(&b.frame));
        let differ = a.iter().zip(&b).filter(|(a, b)| a != b).count();
        let error = psnr(&a, &b);
        println!("{name}: {differ} pixels differ, {error:.1} dB");
        let is_pieces = matches!(camera.layers[..], [Rays::Pieces(_)]);
        assert!(
            if is_pieces && camera.optics.is_none() { differ == 0 } else { error > 50.0 },
            "{name}: {differ}, {error} dB"
        );
    }
}

/// Images that are already on the device are not put there again, and others are.
#[test]
fn images_are_exchanged_where_light_is() {
    let Some(mut engine) = engine_on(|_| {}) else { return };
    let (_, camera) = families(SIZE).swap_remove(1);
    let one = masked_shapes();
    let picture = |scene: &Scene| {
        let mut engine = engine_on(|_| {}).unwrap();
        rendered(&mut engine, scene, &camera)
    };
    let darker = |scene: &Scene, value: f32, hole: f32| {
        let Texture { texels, .. } = scene.mesh.materials[0].texture.clone().unwrap();
        let rgba = texels
            .rgba
            .iter()
            .map(|t| [t[0], f16::from_f32(value), t[2], if t[3] < f16::ONE { f16::from_f32(hole) } else { t[3] }]);
        let texels = Arc::new(Texels { width: texels.width, height: texels.height, rgba: rgba.collect() });
        let mut other = scene.clone();
        Arc::make_mut(&mut other.mesh).materials[0].texture =
            Some(Texture { cutoff: Some(0.5), ..Texture::new(texels) });
        other
    };
    let mut wider = one.clone();
    Arc::make_mut(&mut wider.mesh).materials[0].texture.as_mut().unwrap().cutoff = Some(0.9);
    let mut lit = one.clone();
    lit.lights = vec![Light::distant(DVec3::new(0.0, -0.6, -0.8))];
    let wanted = Wanted::of(COLOUR.to_vec());
    let mut frames = engine.prepare(&one, &camera, &wanted, &RunOptions::default()).unwrap();
    let whole = frames.refresh().unwrap();
    assert_eq!(whole, 0);
    let mut passes = Vec::new();
    for scene in [&lit, &darker(&one, 0.1, 0.1), &wider, &one] {
        frames.light(scene).unwrap();
        passes.push(frames.refresh().unwrap());
    }
    // light alone needs no new search, other alpha masks do
    assert!(passes[0] < 3 && passes[1..].iter().all(|p| *p > 4), "{passes:?}");
    frames.light(&wider).unwrap();
    assert!(colours(&frames.finish().unwrap().frame) == picture(&wider));

    let mut moved = one.clone();
    Arc::make_mut(&mut moved.mesh).uvs[0].x += 0.5;
    let mut frames = engine.prepare(&one, &camera, &wanted, &RunOptions::default()).unwrap();
    let message = frames.light(&moved).unwrap_err().to_string();
    assert!(message.starts_with("other texture coordinates"), "{message}");
}

#[test]
fn what_ignores_alpha_masks_says_so() {
    let Some(mut engine) = engine_on(|_| {}) else { return };
    let (scene, (_, camera)) = (masked_shapes(), families(SIZE).swap_remove(0));
    let mut blended = scene.clone();
    Arc::make_mut(&mut blended.mesh).materials[0].blend = Some(0.5);
    assert!(at_once(&scene, &camera, 4) && !at_once(&blended, &camera, 4));
    let rival = RunOptions { rival: anamorph_lab::rivals::parse("raytrace").ok(), ..RunOptions::default() };
    let message = engine.render(&scene, &camera, &Wanted::of(vec![Channel::R]), &rival).unwrap_err().to_string();
    assert!(message.starts_with("raytrace ignores alpha masks"), "{message}");
}
