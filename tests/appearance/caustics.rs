//! Caustics: closed forms that engine and reference must give, and the one against the other. Without an adapter the
//! reference alone.

use crate::common;

use anamorph::internals::engine::plan::Wanted;
use anamorph::internals::engine::{Engine, RunOptions};
use anamorph::internals::image::frame::Channel;
use anamorph::internals::image::write_npy_f64;
use anamorph::internals::reference::caustics::{caustics, photons};
use anamorph::internals::reference::image::image;
use anamorph::internals::scene::Scene;
use anamorph::internals::scene::caustics::beams::{CHANNELS, Fate};
use anamorph::internals::scene::caustics::receiver_triangles::ReceiverTriangles;
use anamorph::internals::scene::caustics::shares::{LINE_WIDTH, shares};
use anamorph::internals::scene::caustics::{CausticMaps, Map};
use common::file::load;
use common::gpu::{engine_on, words};
use glam::DVec2;
use std::f64::consts::PI;
use std::sync::Arc;

const FLOOR: &str = "[[mesh]]\nbuiltin = \"plane\"\nsize = 12\ncolor = [0.8, 0.6, 0.4]";
const CAMERA: &str = r#"
[camera]
kind = "pinhole"
eye = [0, 3, 6]
target = [0, 0, 0]
vfov = 45
"#;
/// A light three above a converging lens that sends all of its light down to the floor.
const LENS: &str = r#"light = { kind = "refraction", ior = 1.5, depth = 2,
  eye = { kind = "pinhole", eye = [0, 5, 0], target = [0, 0, 0], up = [0, 0, 1], vfov = 40 },
  lens = { shape = "lens", center = [0, 2, 0], axis = [0, -1, 0], radius = 0.5, thickness = 0.25, curvatures = [0.7, -0.7] } }
receivers = [{ origin = [-3, 0, 3], u = [6, 0, 0], v = [0, 0, -6], texels = [300, 300] }]"#;
/// A light under a flat mirror: its image is 4.5 above the floor.
const FLAT: &str = r#"light = { kind = "reflection",
  eye = { kind = "pinhole", eye = [0, 1.5, 0], target = [0, 3, 0], up = [0, 0, 1], vfov = 60 },
  mirror = { shape = "quadric", vertex = [0, 3, 0], axis = [0, -1, 0], curvature = 0, radius = 2 } }
receivers = [{ origin = [-2, 0, 2], u = [4, 0, 0], v = [0, 0, -4], texels = [40, 40] }]"#;
const FLAT_HEIGHT: f64 = 4.5;

fn scene(meshes: &str, caustics: &str) -> Scene {
    load(&format!("image = {{ width = 80, height = 60 }}\n{meshes}\n{CAMERA}\n[caustics]\n{caustics}\n")).unwrap()
}

fn engine() -> Option<Engine> {
    engine_on(|_| {})
}

/// The maps by the reference, and by the engine where there is one.
fn lit(scene: &Scene) -> Vec<(&'static str, CausticMaps)> {
    let mut all = vec![("reference", caustics(scene).unwrap())];
    all.extend(engine().map(|mut e| ("engine", e.caustic_maps(scene).unwrap().unwrap().clone())));
    for (name, lit) in &all {
        println!("{name}: {:?}", lit.budget);
    }
    all
}

/// All light is somewhere: sums of whole units that are 2^-30 of a beam's flux, and f64's own rounding.
fn assert_conserved(name: &str, lit: &CausticMaps) {
    let b = &lit.budget;
    let sum = b.deposited + b.missed + b.direct + b.absorbed;
    assert!((sum - b.flux).abs() <= 1e-8 * b.flux, "{name}: {sum} of {}", b.flux);
}

/// Solid angle of a rectangle of half sides `a` and `b` at distance 1.
fn rectangle(a: f64, b: f64) -> f64 {
    4.0 * (a * b / ((1.0 + a * a) * (1.0 + b * b)).sqrt()).asin()
}

#[test]
fn the_light_through_a_lens_is_the_light_on_the_floor() {
    let half = 20f64.to_radians().tan();
    // the rim of the upper face is seen from 5 - 2.125 + its sag
    let sag = 0.7 * 0.25 / (1.0 + (1.0 - 0.35f64 * 0.35).sqrt());
    let far = 5.0 - 2.125 + sag;
    let disc = 2.0 * PI * (1.0 - far / (far * far + 0.25f64).sqrt());
    let known = 7.0 * disc / rectangle(half, half);
    for (name, lit) in lit(&scene(FLOOR, &format!("flux = 7\nmap = [256, 256]\n{LENS}"))) {
        assert_conserved(name, &lit);
        let b = lit.budget;
        assert!((b.deposited - known).abs() <= 0.01 * known, "{name}: {} for {known}", b.deposited);
        assert!((b.direct - (7.0 - known)).abs() <= 0.01 * known && b.missed <= 0.001 * known, "{name}: {b:?}");
        assert_eq!(b.absorbed, 0.0);
    }
}

#[test]
fn a_tinted_lens_keeps_what_its_colour_says() {
    let tinted = LENS.replace("depth = 2,", "depth = 2, color = [1, 0.5, 0],");
    for (name, lit) in lit(&scene(FLOOR, &format!("map = [64, 64]\n{tinted}"))) {
        assert_conserved(name, &lit);
        let [r, g, b] = lit.maps[0].total();
        // two bounces; a unit is 2^-30 of the brightest beam, and there are some thousand beams
        assert!((g - 0.25 * r).abs() < 1e-6 * r && b == 0.0 && r > 0.05, "{name}: {r} {g} {b}");
        assert!((lit.budget.absorbed - (r + 0.75 * r / 1.0) / 3.0).abs() < 0.01 * r, "{name}: {:?}", lit.budget);
    }
}

#[test]
fn a_paraboloid_puts_the_sun_into_one_texel() {
    // focal length 1 / (2 curvature) = 1; a plate of 0.2 x 0.2 there keeps 0.04 of the sun off the mirror
    let plate = "[[mesh]]\nbuiltin = \"plane\"\nsize = 0.2\ntranslate = [0, 1, 0]";
    let sun = r#"map = [100, 100]
light = { kind = "reflection",
  eye = { kind = "orthographic", eye = [0, 5, 0], target = [0, 0, 0], up = [0, 0, 1], height = 1 },
  mirror = { shape = "quadric", axis = [0, 1, 0], curvature = 0.5, conic = -1, radius = 1 } }
receivers = [{ origin = [-0.1, 1, 0.1], u = [0.2, 0, 0], v = [0, 0, -0.2], texels = [11, 11] }]"#;
    for (name, lit) in lit(&scene(plate, sun)) {
        assert_conserved(name, &lit);
        let (b, focus) = (lit.budget, lit.maps[0].flux[5 * 11 + 5][0]);
        assert!((b.deposited - 0.96).abs() < 0.01 * 0.96, "{name}: {b:?}");
        assert!((focus - b.deposited).abs() < 1e-6, "{name}: {focus} in the focus");
        assert!(b.degenerate as f64 > 0.99 * b.triangles as f64, "{name}: {b:?}");
    }
}

/// Irradiance on the floor below the flat mirror, of unit flux.
fn under_the_mirror(p: DVec2) -> f64 {
    let half = 30f64.to_radians().tan();
    let r2 = FLAT_HEIGHT * FLAT_HEIGHT + p.length_squared();
    FLAT_HEIGHT / r2.powf(1.5) / rectangle(half, half)
}

#[test]
fn a_flat_mirror_lights_by_inverse_square_and_cosine() {
    for (name, lit) in lit(&scene(FLOOR, &format!("map = [200, 200]\n{FLAT}"))) {
        assert_conserved(name, &lit);
        let map = &lit.maps[0];
        // a cell's diagonal on the floor
        let cell = 2f64.sqrt() * 2.0 * FLAT_HEIGHT * 30f64.to_radians().tan() / 200.0;
        for k in 0..1600 {
            let texel = DVec2::new((k % 40) as f64 + 0.5, (k / 40) as f64 + 0.5);
            let p = map.receiver.point(texel);
            let known = under_the_mirror(DVec2::new(p.x, p.z));
            let found = map.flux[k][0] / map.receiver.texel_area();
            // a triangle has its mean all over: off by the slope 3 rho / (h^2 + rho^2) times its size; the texel's own mean
            // differs from its middle by its size squared times a curvature of 3 / h^2 at most, over 24
            let rho = p.x.hypot(p.z);
            let slope = 3.0 * rho / (FLAT_HEIGHT * FLAT_HEIGHT + rho * rho);
            let bound = slope * cell + 2.0 * 0.01 * 3.0 / (FLAT_HEIGHT * FLAT_HEIGHT) / 24.0 + 1e-6;
            assert!((found - known).abs() <= bound * known, "{name}, texel {texel}: {found} for {known}");
        }
    }
}

#[test]
fn the_ratio_of_solid_angles_is_near_where_light_is_smooth() {
    let by = |method: &str, caustics: &str| {
        lit(&scene(FLOOR, &format!("map = [200, 200]\nmethod = \"{method}\"\n{caustics}")))
    };
    for ((name, flux), (_, ratio)) in by("flux", FLAT).into_iter().zip(by("solid_angle", FLAT)) {
        for (a, b) in flux.maps[0].flux.iter().zip(&ratio.maps[0].flux) {
            // a triangle's solid angle is area cosine / r^2 up to its size over r, squared: (0.05 / 1.5)^2
            assert!((a[0] - b[0]).abs() <= 0.01 * a[0], "{name}: {a:?} {b:?}");
        }
    }
    for ((name, flux), (_, ratio)) in by("flux", LENS).into_iter().zip(by("solid_angle", LENS)) {
        // 13,840 triangles of at most 0.02 at 5 from the light
        let (a, b) = (flux.budget.deposited, ratio.budget.deposited);
        assert!((a - b).abs() <= 1e-4 * a, "{name}: {a} {b}");
    }
}

/// A ring and a ball of glass.
const SCENES: [&str; 2] = [
    r#"map = [150, 120]
light = { kind = "reflection", depth = 3,
  eye = { kind = "pinhole", eye = [-2, 2.2, 1], target = [0, 0.2, 0], vfov = 55 },
  mirror = { shape = "torus", center = [0, 0.35, 0], radius = 1, tube = 0.3, count = 2000 } }
receivers = [{ origin = [-3, 0, 3], u = [6, 0, 0.5], v = [0.3, 0, -6], texels = [200, 160] }]"#,
    r#"map = [128, 128]
light = { kind = "refraction", ior = 1.5, depth = 3,
  eye = { kind = "pinhole", eye = [-2, 5, 1], target = [0, 1.2, 0], vfov = 30 },
  lens = { shape = "sphere", center = [0, 1.2, 0], radius = 1 } }
receivers = [{ origin = [-3, 0, 3], u = [6, 0, 0], v = [0, 0, -6], texels = [256, 256] },
  { origin = [-3, 0, -2], u = [6, 0, 0], v = [0, 3, 0], texels = [64, 32] }]"#,
];

fn room() -> String {
    format!("{FLOOR}\n[[mesh]]\nbuiltin = \"plane\"\nsize = 6\nrotate = [90, 0, 0]\ntranslate = [0, 3, -2]")
}

#[test]
fn photons_of_the_engine_are_where_the_reference_has_them() {
    let Some(mut engine) = engine() else { return };
    for (text, more) in SCENES.into_iter().flat_map(|text| [(text, ""), (text, SPHERES)]) {
        let scene = scene(&format!("{}{more}", room()), text);
        let spec = scene.caustics.clone().unwrap();
        let (white, camera) = spec.counting(&scene);
        let wanted = Wanted::of(CHANNELS.to_vec());
        let frame = engine.render(&white, &camera, &wanted, &RunOptions::default()).unwrap().frame;
        let receiver_triangles = ReceiverTriangles::new(&spec.receivers, &scene.mesh);
        let (found, known) = (spec.photons(&scene.mesh, &receiver_triangles, &frame).unwrap(), photons(&scene, &spec));
        // weights are f32: half a unit of 2^-24 each, of the sides of the floor's triangles
        let size = |r: u32| {
            let on_receiver = receiver_triangles.triangles.iter().filter(|l| l.receiver == r);
            on_receiver
                .map(|l| (l.corners[1] - l.corners[0]).length() + (l.corners[2] - l.corners[0]).length())
                .fold(0.0, f64::max)
        };
        let (mut on_receiver, mut different) = (0, 0);
        for (a, b) in found.iter().zip(&known) {
            match (a.fate, b.fate) {
                (
                    Fate::OnReceiver { receiver, bounces, place },
                    Fate::OnReceiver { receiver: r, bounces: n, place: p },
                ) => {
                    on_receiver += 1;
                    let near = place.distance(p) <= size(r) / f64::from(1 << 24) + 1e-9 * p.length();
                    different += usize::from(!near || (receiver, bounces) != (r, n) || a.left != b.left);
                }
                (a, b) => different += usize::from(a != b),
            }
        }
        println!("{on_receiver} of {} on a receiver, {different} different", found.len());
        // what is seen edge-on may fare otherwise; it is the share of pixels that are not safe
        assert!(
            on_receiver > found.len() / 20 && different * 1000 <= found.len(),
            "{on_receiver} on a receiver, {different} different"
        );
    }
}

#[test]
fn maps_of_the_engine_are_sums_of_shares_texel_by_texel() {
    let Some(mut engine) = engine() else { return };
    for text in SCENES {
        let scene = scene(&room(), text);
        let spec = scene.caustics.clone().unwrap();
        let (white, camera) = spec.counting(&scene);
        let wanted = Wanted::of(CHANNELS.to_vec());
        let frame = engine.render(&white, &camera, &wanted, &RunOptions::default()).unwrap().frame;
        let receiver_triangles = ReceiverTriangles::new(&spec.receivers, &scene.mesh);
        let caustic_triangles =
            spec.caustic_triangles(&spec.photons(&scene.mesh, &receiver_triangles, &frame).unwrap()).0;
        let lit = engine.caustic_maps(&scene).unwrap().unwrap().clone();
        assert_conserved("engine", &lit);
        for (r, map) in lit.maps.iter().enumerate() {
            let (mut known, mut tolerance) = (vec![0.0; map.flux.len()], vec![0.0; map.flux.len()]);
            for triangle in caustic_triangles.iter().filter(|c| c.receiver as usize == r) {
                let list = shares(&triangle.corners, map.receiver.texels).list;
                let [a, b, c] = triangle.corners;
                let area = (b - a).perp_dot(c - a).abs() / 2.0;
                let around = a.distance(b) + b.distance(c) + c.distance(a);
                let reach = [a, b, c].iter().fold(1.0, |s: f64, p| s.max(p.abs().max_element()));
                // corners are stored and cut in f32: its outline is off by some 8 roundings; a line may be a width beside,
                // in other texels all along
                let off = (around * 8.0 * reach / f64::from(1 << 24) / area).min(1.0);
                let error = if area <= around * LINE_WIDTH / 2.0 { 1.0 } else { off };
                for (texel, share) in &list {
                    known[*texel] += share * triangle.flux[0];
                }
                for texel in beside(map, [a, b, c]) {
                    tolerance[texel] += error * triangle.flux[0];
                }
            }
            let bright = known.iter().fold(0.0, |s: f64, k| s.max(*k));
            let wrong =
                (0..known.len()).filter(|k| (map.flux[*k][0] - known[*k]).abs() > tolerance[*k] + 1e-6 * bright);
            assert_eq!(wrong.count(), 0, "map {r}");
            // of small triangles the rounding of a corner is a larger part
            let lit = known.iter().filter(|k| **k > 0.0).count();
            let tight = (0..known.len()).filter(|k| tolerance[*k] < 0.1 * known[*k]).count();
            println!("map {r}: {tight} of {lit} texels within a tenth");
            assert!(tight >= lit / 20, "the bound says something");
        }
    }
}

/// Texels up to one from the box about a triangle.
fn beside(map: &Map, [a, b, c]: [DVec2; 3]) -> Vec<usize> {
    let [columns, rows] = map.receiver.texels;
    let size = DVec2::new(columns.into(), rows.into());
    let lo = (a.min(b).min(c).floor() - 1.0).clamp(DVec2::ZERO, size);
    let hi = (a.max(b).max(c).floor() + 2.0).clamp(DVec2::ZERO, size);
    let texel = move |(x, y)| y * columns as usize + x;
    (lo.y as usize..hi.y as usize)
        .flat_map(|y| (lo.x as usize..hi.x as usize).map(move |x| (x, y)))
        .map(texel)
        .collect()
}

#[test]
fn pictures_show_what_falls_on_the_floor() {
    let Some(mut engine) = engine() else { return };
    let lit = scene(FLOOR, &format!("flux = 30\nmap = [200, 200]\n{FLAT}"));
    let dark = Scene { caustics: None, ..lit.clone() };
    let camera = lit.camera().unwrap();
    let channels = vec![Channel::R, Channel::G, Channel::B, Channel::T];
    let wanted = Wanted::of(channels.clone());
    let mut render = |scene: &Scene| engine.render(scene, &camera, &wanted, &RunOptions::default()).unwrap().frame;
    let (with, without, truth) = (render(&lit), render(&dark), image(&lit, &camera, &channels));
    assert!(words(&with) == words(&render(&lit)), "two runs give the same bytes");
    let maps = |e: &mut Engine| e.caustic_maps(&lit).unwrap().unwrap().clone();
    let other = self::engine().map(|mut e| maps(&mut e)).unwrap();
    assert_eq!(with.planes.len(), channels.len(), "weights are not handed out where they are not asked for");
    assert!(maps(&mut engine) == other, "two engines give the same maps");
    let mut shown = 0;
    for k in 0..80 * 60 {
        let of = |f: &anamorph::internals::image::frame::Frame, c| f64::from(f.f32(c).unwrap()[k]);
        let ray = camera.ray(k as u32 % 80, k as u32 / 80).unwrap();
        let p = ray.origin + of(&with, Channel::T) * ray.direction;
        for (channel, diffuse) in [(Channel::R, 0.8), (Channel::G, 0.6), (Channel::B, 0.4)] {
            let more = of(&with, channel) - of(&without, channel);
            // half a texel from the border light is constant
            let known = if p.x.abs().max(p.z.abs()) < 1.95 {
                shown += 1;
                diffuse / PI * 30.0 * under_the_mirror(DVec2::new(p.x, p.z))
            } else if p.x.abs().max(p.z.abs()) > 2.0 + 1e-5 {
                0.0
            } else {
                continue;
            };
            // as the map itself, 2.1 % at most, and of f32
            assert!((more - known).abs() <= 0.021 * known + 1e-6, "pixel {k}: {more} for {known}");
            assert!((of(&with, channel) - of(&truth, channel)).abs() <= 1e-4, "pixel {k}, against the reference");
        }
    }
    assert!(shown > 1000, "{shown}");
}

/// One sphere in the way of the light, and one whose center is in the plane of the floor.
const SPHERES: &str = "\n[[spheres]]\ncenters = [[0.5, 0.7, 0.3], [-1, 0, 0.5]]\nradius = 0.3\n";

#[test]
fn spheres_cast_shadows_in_the_caustic_and_receive_none() {
    let Some(mut engine) = engine() else { return };
    let lit = scene(&format!("{FLOOR}{SPHERES}"), &format!("flux = 30\nmap = [200, 200]\n{FLAT}"));
    let dark = Scene { caustics: None, ..lit.clone() };
    let camera = lit.camera().unwrap();
    let channels = vec![Channel::R, Channel::T, Channel::TriangleId];
    let wanted = Wanted::of(channels.clone());
    let mut render = |scene: &Scene| engine.render(scene, &camera, &wanted, &RunOptions::default()).unwrap().frame;
    let by_engine = [render(&lit), render(&dark)];
    let by_reference = [&lit, &dark].map(|scene| image(scene, &camera, &channels));
    for [with, without] in [by_engine, by_reference] {
        let red = |f: &anamorph::internals::image::frame::Frame, k: usize| f.f32(Channel::R).unwrap()[k];
        let (mut on_spheres, mut in_shadow, mut lit_floor) = (0, 0, 0);
        for k in 0..80 * 60 {
            let id = with.u32(Channel::TriangleId).unwrap()[k];
            let more = red(&with, k) - red(&without, k);
            if lit.mesh.triangles.get(id as usize).is_none() {
                continue;
            }
            if lit.mesh.radius(id).is_some() {
                on_spheres += 1;
                assert_eq!(more, 0.0, "pixel {k} on a sphere");
                continue;
            }
            let ray = camera.ray(k as u32 % 80, k as u32 / 80).unwrap();
            let p = ray.origin + f64::from(with.f32(Channel::T).unwrap()[k]) * ray.direction;
            // the shadow of the first sphere from the light's image above the floor, less two texels of 0.1
            let enlarged = FLAT_HEIGHT / (FLAT_HEIGHT - 0.7);
            if (enlarged * DVec2::new(0.5, 0.3)).distance(DVec2::new(p.x, p.z)) < 0.3 * enlarged - 0.2 {
                in_shadow += 1;
                assert_eq!(more, 0.0, "pixel {k} in the shadow");
            }
            lit_floor += u32::from(more > 0.0);
        }
        assert!(on_spheres > 50 && in_shadow >= 5 && lit_floor > 800, "{on_spheres} {in_shadow} {lit_floor}");
    }
}

#[test]
fn a_mirror_shows_the_caustic_too_as_much_as_it_leaves() {
    let mirror = |color: &str| {
        let camera = format!(
            "kind = \"reflection\"\neye = {{ kind = \"pinhole\", eye = [0, 1, 3], target = [0, 2, 0], vfov = 60 }}\n\
             mirror = {{ shape = \"quadric\", vertex = [0, 3, 0], axis = [0, -1, 0], curvature = 0, radius = 2 }}\ncolor = {color}"
        );
        let text =
            format!("image = {{ width = 80, height = 60 }}\n{FLOOR}\n[camera]\n{camera}\n[caustics]\nflux = 30\n");
        load(&format!("{text}map = [100, 100]\n{FLAT}")).unwrap()
    };
    let Some(mut engine) = engine() else { return };
    let wanted = Wanted::of(vec![Channel::R, Channel::MirrorId]);
    let mut added = Vec::new();
    for color in ["[1, 1, 1]", "[0.25, 1, 1]"] {
        let lit = mirror(color);
        let camera = lit.camera().unwrap();
        let dark = Scene { caustics: None, ..lit.clone() };
        let mut render = |scene: &Scene| engine.render(scene, &camera, &wanted, &RunOptions::default()).unwrap().frame;
        let (with, without) = (render(&lit), render(&dark));
        let red = |f: &anamorph::internals::image::frame::Frame| f.f32(Channel::R).unwrap().to_vec();
        let more: Vec<f32> = red(&with).iter().zip(red(&without)).map(|(a, b)| a - b).collect();
        let seen = with.u32(Channel::MirrorId).unwrap().to_vec();
        let truth = image(&lit, &camera, &wanted.channels);
        let off = red(&with).iter().zip(red(&truth)).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(off <= 1e-4, "{color}: {off} from the reference");
        added.push((more, seen));
    }
    let mut mirrored = 0;
    for k in 0..80 * 60 {
        let share = if added[0].1[k] == u32::MAX { 1.0 } else { 0.25 };
        let (full, less) = (added[0].0[k], added[1].0[k]);
        mirrored += usize::from(share < 1.0 && full > 0.1);
        assert!((less - share * full).abs() <= 1e-6, "pixel {k}: {less} of {full}");
    }
    assert!(mirrored > 100, "{mirrored}");
}

/// What the photons' share of light is found from is white, whatever the colours of vertices are; and nothing floats in their way.
#[test]
fn photons_are_those_of_a_plain_floor() {
    let Some(mut engine) = engine() else { return };
    let plain = scene(FLOOR, LENS);
    let mut coloured = plain.clone();
    let mesh = Arc::make_mut(&mut coloured.mesh);
    mesh.colors = vec![[1.0, 0.0, 0.0]];
    mesh.corner_colors = vec![[0; 3]; mesh.triangles.len()];
    let folder = tempfile::tempdir().unwrap();
    write_npy_f64(&folder.path().join("v.npy"), &[2, 2, 2], &[1.0; 8]).unwrap();
    let file = folder.path().join("v.npy");
    let volume = format!(
        "[volume]\nfile = {:?}\nmin = [-1, 0.2, -1]\nmax = [1, 1, 1]\ntransfer = [[0, 1, 1, 1, 0.5], [2, 1, 1, 1, 0.5]]",
        file.display().to_string()
    );
    let filled = scene(&format!("{FLOOR}\n{volume}"), LENS);
    let mut maps = |scene: &Scene| engine.caustic_maps(scene).unwrap().unwrap().clone();
    let expected = maps(&plain);
    assert!(maps(&coloured).maps == expected.maps && maps(&filled).maps == expected.maps);
}

#[test]
fn what_is_drawn_on_surfaces_is_in_the_way_of_no_photon() {
    let Some(mut engine) = engine() else { return };
    let drawn = "[style]\nwireframe = 3\noutline = 2\nhatching = 6";
    let [plain, drawn] = ["", drawn].map(|style| {
        let scene = scene(&format!("{style}\n{FLOOR}"), LENS);
        engine.caustic_maps(&scene).unwrap().unwrap().clone()
    });
    assert_eq!(plain.budget, drawn.budget);
    assert!(plain.maps == drawn.maps);
}

#[test]
fn bad_input_is_refused_in_one_line() {
    let refused = |text: &str| {
        let scene = format!("image = {{ width = 8, height = 6 }}\n{FLOOR}\n{CAMERA}\n[caustics]\n{text}\n");
        let error = load(&scene).expect_err(text);
        assert_eq!(error.exit_code(), 2, "{text}");
        let text = error.to_string();
        assert!(!text.contains('\n'), "{text}");
        text
    };
    let floor = "{ origin = [-2, 0, 2], u = [4, 0, 0], v = [0, 0, -4], texels = [40, 40] }";
    for (from, to, says) in [
        ("v = [0, 0, -4]", "v = [2, 0, 0]", "receivers.0: u and v are parallel"),
        ("v = [0, 0, -4]", "v = [0, 0, 0]", "receivers.0: u and v are parallel"),
        ("origin = [-2, 0, 2]", "origin = [-2, 1, 2]", "receivers.0: no triangle of the scene lies in its plane"),
        (floor, &format!("{floor}, {floor}"), "receivers.1: lies in the plane of receiver 0"),
        (floor, "", "there may be 1 to"),
        ("texels = [40, 40]", "texels = [0, 40]", "texels.0: expected a whole number from 1"),
        ("texels = [40, 40]", "texel = [4, 40]", "nearest known key: \"texels\""),
        ("light = {", "map = [0, 9]\nlight = {", "map.0: expected a whole number from 1"),
        ("light = {", "flux = 0\nlight = {", "0 is no flux"),
        ("light = {", "method = \"photons\"\nlight = {", "use \"flux\" or \"solid_angle\""),
        ("light = {", "color = [1, 1, 1]\nlight = {", "unknown key \"color\""),
        ("kind = \"reflection\"", "kind = \"pinhole\"", "\"pinhole\" cannot be a light here"),
        ("kind = \"pinhole\"", "kind = \"fisheye\"", "\"fisheye\" cannot be a light here"),
        ("vfov = 60", "vfov = 200", "caustics.light: "),
        ("curvature = 0,", "", "caustics.light"),
    ] {
        assert!(FLAT.contains(from), "{from}");
        let text = refused(&FLAT.replacen(from, to, 1));
        assert!(text.contains(says), "{to}: {text}");
    }
    assert!(refused("flux = 1").contains("light is missing"));
}
