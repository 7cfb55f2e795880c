//! Kernels that no other test here runs alone: whole frames are right, and an error planted in each of these kernels is noticed in them.

use crate::common::cameras::pinhole;
use crate::common::file::camera_of;
use crate::common::gpu::{engine_on, ids};
use crate::common::layered;
use crate::common::needs::skip;
use crate::common::rng::Rng;
use crate::common::volumes::{grid, volume};
use crate::common::{FORWARD, camera, mesh, scene, soup};
use crate::stages::slab_on_rays;
use anamorph::internals::camera::Camera;
use anamorph::internals::engine::plan::Wanted;
use anamorph::internals::engine::plan::samples::sample_offsets;
use anamorph::internals::engine::{Engine, Method, Rendered, RunOptions};
use anamorph::internals::geometry::mesh::{Material, Mesh};
use anamorph::internals::geometry::place;
use anamorph::internals::geometry::spheres::spheres_of;
use anamorph::internals::geometry::texture::{Texels, Texture};
use anamorph::internals::gpu::kernels::File;
use anamorph::internals::image::frame::{Channel, Frame, NO_ID};
use anamorph::internals::input::Limits;
use anamorph::internals::reference::image::{image, judge};
use anamorph::internals::scene::Scene;
use anamorph::internals::scene::light::Light;
use anamorph::internals::scene::style::{Line, Outline, Style};
use anamorph::internals::scene::volume::Mode;
use glam::{DQuat, DVec3, Vec2};
use half::f16;
use std::sync::Arc;

const SIZE: (u32, u32) = (40, 29);

/// Compares frames with what they must be; the error says how they differ.
type Check = fn(&mut Engine) -> Result<(), String>;

fn demand(holds: bool, what: &str) -> Result<(), String> {
    if holds { Ok(()) } else { Err(what.into()) }
}

fn eye() -> Camera {
    camera(pinhole(DVec3::new(0.1, 0.2, 3.0), DVec3::ZERO, 40.0), SIZE, FORWARD)
}

fn frame(engine: &mut Engine, scene: &Scene, camera: &Camera, wanted: &Wanted) -> Rendered {
    engine.render(scene, camera, wanted, &RunOptions::default()).unwrap()
}

fn centres(channels: &[Channel]) -> Wanted {
    Wanted::of(channels.to_vec())
}

/// Triangles before a large one, and the background. The light is the same everywhere, and all triangles are flat.
fn crowd() -> Scene {
    let wall =
        mesh([(-2.0, -1.6), (2.0, -1.5), (0.1, 2.0)].map(|(x, y)| DVec3::new(x, y, -1.5)).to_vec(), vec![[0, 1, 2]]);
    let all = place::merge(vec![wall, soup(&mut Rng(3), 400, 0.25)]).unwrap();
    Scene { lights: vec![Light::distant(DVec3::new(-0.4, -0.5, -1.0))], ..scene(all) }
}

/// Every pixel, by the reference.
fn seen(engine: &mut Engine) -> Result<(), String> {
    seen_by(engine, &eye())
}

/// The same by tracing.
fn traced(engine: &mut Engine) -> Result<(), String> {
    seen_with(engine, &eye(), &crowd(), Method::Trace)
}

/// The same by what costs less: a few triangles, and so many that each pixel has some.
fn chosen(engine: &mut Engine) -> Result<(), String> {
    seen_with(engine, &eye(), &crowd(), Method::Auto)
}

/// Curves, by tracing.
fn traced_curves(engine: &mut Engine) -> Result<(), String> {
    seen_with(engine, &layered::wavy(3, 0.8, false, SIZE), &crowd(), Method::Trace)
}

/// A slab whose vertices lie on rays has no holes, by tracing.
fn traced_no_holes(engine: &mut Engine) -> Result<(), String> {
    let camera = eye();
    let slab = scene(slab_on_rays(&camera, 1));
    let run = RunOptions { method: Method::Trace, ..RunOptions::default() };
    let [raster, trace] = [RunOptions { method: Method::Raster, ..run.clone() }, run]
        .map(|run| engine.render(&slab, &camera, &centres(&[Channel::T, Channel::TriangleId]), &run).unwrap());
    demand(ids(&raster.frame) == ids(&trace.frame), "the slab shows other triangles, or has holes")
}

/// The same with a ball that mirrors what is around it.
fn mirrored(engine: &mut Engine) -> Result<(), String> {
    let eye = "eye = { kind = \"pinhole\", eye = [0.1, 0.2, 3], target = [0, 0, 0], vfov = 40 }";
    let ball = "mirror = { shape = \"sphere\", center = [0, 0, 0.5], radius = 0.6 }";
    seen_by(engine, &camera_of("", SIZE, &format!("kind = \"reflection\"\ndepth = 1\n{eye}\n{ball}")).unwrap())
}

fn seen_by(engine: &mut Engine, camera: &Camera) -> Result<(), String> {
    seen_with(engine, camera, &crowd(), Method::Raster)
}

fn seen_with(engine: &mut Engine, camera: &Camera, scene: &Scene, method: Method) -> Result<(), String> {
    let run = RunOptions { method, ..RunOptions::default() };
    let seen = engine.render(scene, camera, &centres(&Channel::ALL), &run).unwrap().frame;
    let judged = judge(scene, camera, &seen);
    let truth = ids(&judged.truth);
    let wrong = (0..truth.len()).filter(|&k| judged.safe[k] && truth[k] != ids(&seen)[k]).count();
    demand(
        wrong == 0 && judged.not_near == 0,
        &format!("{wrong} safe pixels are wrong, {} name none near", judged.not_near),
    )
}

/// A slab whose vertices lie on rays has no holes; rays of samples, where there are several.
fn no_holes(engine: &mut Engine, samples: u32) -> Result<(), String> {
    const STEP: u32 = 4;
    let camera = eye();
    for place in sample_offsets(samples) {
        let scene = scene(slab_on_rays(&camera.with_sample_offset(place.x, place.y), STEP));
        let wanted = Wanted { samples, sample_ids: true, ..centres(&[Channel::TriangleId]) };
        let run = RunOptions { method: Method::Raster, ..RunOptions::default() };
        let seen = engine.render(&scene, &camera, &wanted, &run).unwrap();
        // with a pixel's border that other samples may look beyond
        let inside = |k: usize| {
            let [x, y] = [k as u32 % SIZE.0, k as u32 / SIZE.0];
            let ends = [SIZE.0, SIZE.1].map(|n| (n - 1) / STEP * STEP - 1);
            (1..ends[0]).contains(&x) && (1..ends[1]).contains(&y)
        };
        let hole = |ids: &[u32]| (0..ids.len()).any(|k| inside(k) && ids[k] == NO_ID);
        demand(!seen.sample_ids.iter().any(|ids| hole(ids)), "the slab has holes")?;
    }
    Ok(())
}

fn no_holes_at_centres(engine: &mut Engine) -> Result<(), String> {
    no_holes(engine, 1)
}

fn no_holes_at_samples(engine: &mut Engine) -> Result<(), String> {
    no_holes(engine, 4)
}

/// Relative error of a sum of some ten numbers in f32.
const SUM_ERROR: f64 = 10.0 / 16_777_216.0;

/// Every sample sees what a frame of its own sees, and colour and coverage are the means of those frames.
fn sampled(engine: &mut Engine) -> Result<(), String> {
    const COLOUR: [Channel; 4] = [Channel::R, Channel::G, Channel::B, Channel::A];
    const SAMPLES: u32 = 4;
    let (scene, camera) = (crowd(), eye());
    let wanted =
        Wanted { samples: SAMPLES, sample_ids: true, ..centres(&[&COLOUR[..], &[Channel::TriangleId]].concat()) };
    let seen = frame(engine, &scene, &camera, &wanted);
    demand(seen.counts.edges > 100, "few edge pixels")?;
    let wanted = centres(&[&COLOUR[..], &[Channel::TriangleId]].concat());
    let own: Vec<Frame> = sample_offsets(SAMPLES)
        .into_iter()
        .map(|p| frame(engine, &scene, &camera.with_sample_offset(p.x, p.y), &wanted).frame)
        .collect();
    for (n, own) in own.iter().enumerate() {
        demand(seen.sample_ids[n] == ids(own), &format!("sample {n} sees other triangles"))?;
    }
    for channel in COLOUR {
        let found = seen.frame.f32(channel).unwrap();
        for (k, found) in found.iter().map(|v| f64::from(*v)).enumerate() {
            let mean = own.iter().map(|f| f64::from(f.f32(channel).unwrap()[k])).sum::<f64>() / f64::from(SAMPLES);
            demand(
                (found - mean).abs() <= SUM_ERROR * mean,
                &format!("{channel:?} of pixel {k}: {found}, not {mean}"),
            )?;
        }
    }
    Ok(())
}

/// What is proven is right and is most of a picture; two walls as good as in one place prove nothing.
fn proven(engine: &mut Engine) -> Result<(), String> {
    let wanted = centres(&[Channel::TriangleId, Channel::Certified]);
    let certified = |f: &Frame| f.u32(Channel::Certified).unwrap().to_vec();
    let (scene_seen, camera) = (crowd(), eye());
    let seen = frame(engine, &scene_seen, &camera, &wanted).frame;
    let truth = image(&scene_seen, &camera, &[Channel::TriangleId]);
    let proven = certified(&seen);
    let wrong = (0..proven.len()).filter(|&k| proven[k] > 0 && ids(&seen)[k] != ids(&truth)[k]).count();
    let share = proven.iter().filter(|p| **p > 0).count() as f64 / proven.len() as f64;
    demand(wrong == 0 && share > 0.99, &format!("{wrong} proven pixels are wrong, {share} are proven"))?;
    let wall = |z: f64| [(-9.0, -9.0), (9.0, -9.5), (0.5, 12.0)].map(|(x, y)| DVec3::new(x, y, z));
    let walls = scene(mesh([wall(0.0), wall(1e-16)].concat(), vec![[0, 1, 2], [3, 4, 5]]));
    let proven = certified(&frame(engine, &walls, &camera, &wanted).frame);
    demand(proven.iter().all(|p| *p == 0), "an order is proven that none can tell")
}

/// The same of spheres: between triangles; level with one another, cut open by the range of t, and touched by rays, which is proven nowhere.
fn proven_spheres(engine: &mut Engine) -> Result<(), String> {
    let wanted = centres(&[Channel::TriangleId, Channel::Certified]);
    let balls = |list: &[(DVec3, f64)]| {
        spheres_of(list.iter().map(|b| b.0).collect(), list.iter().map(|b| b.1).collect(), None, Limits::default())
            .unwrap()
    };
    let mut rng = Rng(8);
    let list: Vec<(DVec3, f64)> = (0..40).map(|_| (rng.vector(), 0.02 + 0.2 * rng.unit())).collect();
    let mixed = scene(place::merge(vec![soup(&mut rng, 60, 0.4), balls(&list)]).unwrap());
    let mut look = |scene: &Scene, camera: &Camera| {
        let seen = frame(engine, scene, camera, &wanted).frame;
        let proven = seen.u32(Channel::Certified).unwrap().to_vec();
        let truth = image(scene, camera, &[Channel::TriangleId]);
        let wrong = (0..proven.len()).filter(|&k| proven[k] > 0 && ids(&seen)[k] != ids(&truth)[k]).count();
        let of_hits = (0..proven.len()).filter(|&k| ids(&seen)[k] != NO_ID).map(|k| proven[k]).collect::<Vec<u32>>();
        demand(wrong == 0, &format!("{wrong} proven pixels are wrong")).map(|()| (proven, of_hits))
    };
    let (proven, _) = look(&mixed, &eye())?;
    let share = proven.iter().filter(|p| **p > 0).count() as f64 / proven.len() as f64;
    demand(share > 0.99, &format!("{share} are proven"))?;
    let (_, of_hits) = look(&scene(balls(&[(DVec3::ZERO, 0.7), (DVec3::ZERO, 0.7)])), &eye())?;
    demand(of_hits.len() > 100 && of_hits.iter().all(|p| *p == 0), "an order is proven that none can tell")?;
    // pixels a quarter wide: four rays touch the ball, and one enters it where the range begins
    let along_z = "kind = \"orthographic\"\neye = [0.125, 0, 4]\ntarget = [0.125, 0, 0]\nheight = 7.25";
    let touching = Camera { t_range: [2.0, 9.0], ..camera_of("", SIZE, along_z).unwrap() };
    let (proven, _) = look(&scene(balls(&[(DVec3::ZERO, 2.0)])), &touching)?;
    let uncertain = proven.iter().filter(|p| **p == 0).count();
    demand(uncertain == 5, &format!("{uncertain} pixels are not proven where rays touch a ball"))
}

/// Lines lie between pixels of different triangles that do not go on in each other: here all but two halves of a square.
fn outlined(engine: &mut Engine) -> Result<(), String> {
    const WIDTH: f64 = 1.5;
    const INK: [f32; 3] = [0.6, 0.0, 0.1];
    let square = |x: f64, y: f64, z: f64| {
        [(0.0, 0.0), (0.8, 0.1), (0.7, 0.9), (-0.1, 0.8)].map(|(a, b)| DVec3::new(x + a, y + b, z))
    };
    let corners = [square(-0.9, -0.8, 0.0), square(-0.3, -0.4, 0.6)].concat();
    let squares = mesh(corners, vec![[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]]);
    let plain = scene(squares);
    let line = Line { width: WIDTH, colour: INK, depth: f64::INFINITY };
    let style = Style { outline: Some(Outline { line, crease: 30.0 }), ..Style::default() };
    let styled = Scene { style, ..plain.clone() };
    let camera = eye();
    let channels = [Channel::R, Channel::G, Channel::B, Channel::TriangleId];
    let [under, seen] = [&plain, &styled].map(|s| frame(engine, s, &camera, &centres(&channels)).frame);
    // the square that a pixel shows
    let thing = |x: u32, y: u32| ids(&under)[(y * SIZE.0 + x) as usize].checked_div(2).filter(|t| *t < 2);
    let mut lines = 0;
    for (x, y) in (0..SIZE.1).flat_map(|y| (0..SIZE.0).map(move |x| (x, y))) {
        // the nearest of the sides between pixels that differ: how far it is from the pixel's centre
        let mut nearest = f64::INFINITY;
        for (i, j) in (0..SIZE.1).flat_map(|j| (0..SIZE.0).map(move |i| (i, j))) {
            for (k, l) in [(i + 1, j), (i, j + 1)].into_iter().filter(|(k, l)| *k < SIZE.0 && *l < SIZE.1) {
                if thing(i, j) != thing(k, l) {
                    let centre = [f64::from(i + k) / 2.0 - f64::from(x), f64::from(j + l) / 2.0 - f64::from(y)];
                    let along = [f64::from(l - j) / 2.0, f64::from(k - i) / 2.0];
                    let past = [0, 1].map(|c| (centre[c].abs() - along[c]).max(0.0));
                    nearest = nearest.min(past[0].hypot(past[1]));
                }
            }
        }
        // the part of a pixel's width that a line there covers
        let part = (nearest + 0.5).min(WIDTH / 2.0) - (nearest - 0.5).max(-WIDTH / 2.0);
        let share = part.clamp(0.0, 1.0);
        lines += u32::from(share > 0.0);
        let k = (y * SIZE.0 + x) as usize;
        for (channel, ink) in channels.into_iter().zip(INK) {
            let [before, found] = [&under, &seen].map(|f| f64::from(f.f32(channel).unwrap()[k]));
            let expected = before + share * (f64::from(ink) - before);
            demand(
                (found - expected).abs() <= SUM_ERROR,
                &format!("{channel:?} of {x}, {y}: {found}, not {expected}"),
            )?;
        }
    }
    demand(lines > 50, "few pixels show a line")
}

/// From far away an image is the mean of its texels, also where no side halves evenly.
fn averaged(engine: &mut Engine) -> Result<(), String> {
    const SIDES: [u32; 2] = [13, 7];
    let mut rng = Rng(8);
    let rgba: Vec<[f16; 4]> = (0..SIDES[0] * SIDES[1])
        .map(|_| [0, 1, 2, 3].map(|c| f16::from_f32(if c == 3 { 1.0 } else { rng.unit() as f32 })))
        .collect();
    let mean = [0, 1, 2].map(|c| rgba.iter().map(|t| f64::from(t[c])).sum::<f64>() / rgba.len() as f64);
    let texture = Texture::new(Arc::new(Texels { width: SIDES[0], height: SIDES[1], rgba }));
    let corners = [(-9.0, 9.0), (9.0, 9.0), (9.0, -9.0), (-9.0, -9.0)];
    let mut wall: Mesh = mesh(corners.map(|(x, y)| DVec3::new(x, y, 0.0)).to_vec(), vec![[0, 1, 2], [0, 2, 3]]);
    // many images a pixel
    wall.uvs = [Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y].map(|uv| uv * 10_000.0).to_vec();
    wall.corner_uvs = wall.triangles.clone();
    wall.materials = vec![Material { diffuse: [1.0; 3], texture: Some(texture), ..Material::default() }];
    let wall = Scene { lights: vec![Light::distant(DVec3::NEG_Z)], ..scene(wall) };
    let plain = [Channel::R, Channel::G, Channel::B];
    let albedo = [Channel::AlbedoR, Channel::AlbedoG, Channel::AlbedoB];
    let seen = frame(engine, &wall, &eye(), &centres(&[plain, albedo].concat())).frame;
    for (channel, mean) in albedo.into_iter().zip(mean) {
        // each of three levels, and the image itself, is rounded to 11 bits
        let off = seen.f32(channel).unwrap().iter().map(|v| (f64::from(*v) - mean).abs()).fold(0.0, f64::max);
        demand(off <= 4.0 / 2048.0 * mean, &format!("{channel:?} is {off} off the mean, {mean}"))?;
    }
    Ok(())
}

/// Facets that are looked up in an atlas show nearly what they show by rays of their own.
fn pasted(engine: &mut Engine) -> Result<(), String> {
    let ball =
        "mirror = { builtin = \"icosphere\", level = 1, scale = 0.8 }\nfacets = \"flat\"\ncolor = [0.9, 0.8, 0.7]";
    let eye = "eye = { kind = \"pinhole\", eye = [0.3, 0.9, 4], target = [0, 0, 0], vfov = 32 }";
    let through = |atlas: &str| {
        camera_of("", SIZE, &format!("kind = \"reflection\"\ndepth = 1\n{eye}\n{ball}\n{atlas}")).unwrap()
    };
    let corners = [(-3.0, 3.0), (3.0, 3.0), (3.0, -3.0), (-3.0, -3.0)];
    let floor = mesh(corners.map(|(x, z)| DVec3::new(x, -1.0, z)).to_vec(), vec![[0, 1, 2], [0, 2, 3]]);
    let floor = Scene { lights: vec![Light::distant(DVec3::NEG_Y)], ..scene(floor) };
    let position = [Channel::PositionX, Channel::PositionY, Channel::PositionZ];
    let channels =
        [&position[..], &[Channel::R, Channel::A, Channel::Z, Channel::TriangleId, Channel::MirrorId]].concat();
    let [direct, atlas] = ["", "atlas = 64"].map(|a| frame(engine, &floor, &through(a), &centres(&channels)).frame);
    let words = |f: &Frame, c: Channel| f.u32(c).unwrap().to_vec();
    demand(words(&direct, Channel::MirrorId) == words(&atlas, Channel::MirrorId), "other facets")?;
    let facets = words(&direct, Channel::MirrorId);
    let mirrored: Vec<usize> = (0..facets.len()).filter(|&k| facets[k] != NO_ID && ids(&direct)[k] < 2).collect();
    let same: Vec<usize> = mirrored.iter().copied().filter(|&k| ids(&atlas)[k] == ids(&direct)[k]).collect();
    demand(
        mirrored.len() > 50 && 10 * same.len() > 9 * mirrored.len(),
        &format!("{} of {} are alike", same.len(), mirrored.len()),
    )?;
    let point = |f: &Frame, k: usize| DVec3::from(position.map(|c| f64::from(f.f32(c).unwrap()[k])));
    let value = |f: &Frame, c: Channel, k: usize| f64::from(f.f32(c).unwrap()[k]);
    let median = |off: &dyn Fn(usize) -> f64| {
        let mut off: Vec<f64> = same.iter().map(|&k| off(k)).collect();
        off.sort_by(f64::total_cmp);
        off[off.len() / 2]
    };
    // half a texel of a facet, which shows a part of the floor
    let off = median(&|k| (point(&direct, k) - point(&atlas, k)).length());
    let depth = median(&|k| (value(&direct, Channel::Z, k) - value(&atlas, Channel::Z, k)).abs());
    demand(off < 0.05 && depth < 0.05, &format!("points are {off} apart, depths {depth}"))?;
    let colours = same.iter().all(|&k| (value(&direct, Channel::R, k) - value(&atlas, Channel::R, k)).abs() < 1e-5);
    demand(colours && mirrored.iter().all(|&k| value(&atlas, Channel::A, k) == 1.0), "other colours or coverage")
}

/// Whether pairs are rasterised one by one or tile by tile.
#[derive(Clone, Copy, PartialEq)]
enum Dispatching {
    ByPair,
    ByTile,
    /// Tile by tile, with bounds on t in f32.
    Bounded,
}

/// A file, its text, what is planted, and what notices it.
type Planted = (&'static str, &'static str, &'static str, Dispatching, Check);

const PLANTED: [Planted; 60] = [
    ("depth/bounded/nearest.wgsl", "share = 1.0 / across;", "share = 1.0 / abs(across);", Dispatching::Bounded, seen),
    (
        "depth/bounded/nearest.wgsl",
        "Found(nearest, may & !is_nearest,",
        "Found(nearest, may & inside & !is_nearest,",
        Dispatching::Bounded,
        no_holes_at_centres,
    ),
    ("depth/bounded/nearest.wgsl", "slots[k] | PROVEN", "slots[0] | PROVEN", Dispatching::Bounded, seen),
    (
        "depth/columns/pieces_bounded.wgsl",
        "cell.d + x * q.dx_hi",
        "cell.d + 1.3 * x * q.dx_hi",
        Dispatching::Bounded,
        seen,
    ),
    ("args.wgsl", "items = GROUP / TRIANGLE_GROUP;", "items = GROUP;", Dispatching::ByPair, seen),
    ("args.wgsl", "count = min(count, params.pair_capacity);", "count = count / 2u;", Dispatching::ByPair, seen),
    ("args.wgsl", "count -= first;", "count = first;", Dispatching::ByTile, seen),
    ("trace.wgsl", "if k == stretches() {", "if k + 1u == stretches() {", Dispatching::ByPair, traced),
    ("hierarchy/followed.wgsl", "count += select(0u, 1u,", "count += select(0u, 0u,", Dispatching::ByPair, traced),
    ("hierarchy/nodes.wgsl", "bytes_of(far.x) * x.step", "0.7 * bytes_of(far.x) * x.step", Dispatching::ByPair, traced),
    ("rays/pieces/path.wgsl", "+ place.x * q.dx_hi", "+ 1.3 * place.x * q.dx_hi", Dispatching::ByPair, traced),
    (
        "rays/straight/seen.wgsl",
        "min(seen.last, last), is_met);",
        "min(seen.last, last) - 0.5, is_met);",
        Dispatching::ByPair,
        traced,
    ),
    (
        "rays/straight/seen.wgsl",
        "vec2<u32>(own.slot, path.item);",
        "vec2<u32>(0u, path.item);",
        Dispatching::ByPair,
        traced_no_holes,
    ),
    (
        "rays/curves/stretch.wgsl",
        "vec3<f32>(x.z, y.z, z.z)",
        "0.0 * vec3<f32>(x.z, y.z, z.z)",
        Dispatching::ByPair,
        traced_curves,
    ),
    ("choose.wgsl", "select(count, 0u, traced > 0u)", "0u", Dispatching::ByPair, chosen),
    ("reach.wgsl", "optic.box_half)", "0.5 * optic.box_half)", Dispatching::ByPair, mirrored),
    ("reach.wgsl", "optic.box_centre,", "optic.box_centre + optic.box_half,", Dispatching::ByTile, mirrored),
    ("split.wgsl", "lane % TRIANGLE_GROUPS;", "(lane % TRIANGLE_GROUPS) / 2u;", Dispatching::ByPair, seen),
    ("split.wgsl", "vec2<u32>(index, address)", "vec2<u32>(index, work[0].y)", Dispatching::ByPair, seen),
    ("allot.wgsl", "ends[tile] = first + count;", "ends[tile] = first + count - 1u;", Dispatching::ByTile, seen),
    ("allot.wgsl", "starts[tile] = first;", "starts[tile] = 0u;", Dispatching::ByTile, sampled),
    ("sort.wgsl", "+ ranks[index]]", "+ ranks[index] / 2u]", Dispatching::ByTile, sampled),
    (
        "recheck.wgsl",
        "merge_hits(cell, slot, triangle, whole, v, bit_mask(bit));",
        "merge_hits(cell, slot, triangle, whole, v, bit_mask(0u));",
        Dispatching::ByPair,
        no_holes_at_centres,
    ),
    ("recheck.wgsl", ".y & 63u;", ".y & 31u;", Dispatching::ByPair, no_holes_at_centres),
    ("software/small.wgsl", "first_slot + lane;", "first_slot + lane / 2u;", Dispatching::ByTile, seen),
    ("software/small.wgsl", "vec2<u32>(slot, address);", "vec2<u32>(slot + 1u, address);", Dispatching::ByTile, seen),
    (
        "rays/certainty.wgsl",
        "select(PROOF_CONTESTED, PROOF_SURE, is_found",
        "select(PROOF_SURE, PROOF_SURE, is_found",
        Dispatching::ByPair,
        proven,
    ),
    ("rays/certainty.wgsl", "- 1u <= ~atomicLoad", "- 1u > ~atomicLoad", Dispatching::ByPair, proven),
    ("rays/certainty.wgsl", "select(0u, PROOF_SURE, is_hit)", "0u", Dispatching::ByPair, proven),
    (
        "rays/straight/round_proof.wgsl",
        "below.value > below.bound,",
        "below.value > -below.bound,",
        Dispatching::ByPair,
        proven_spheres,
    ),
    (
        "rays/straight/round_proof.wgsl",
        "-no_more(half.low - along.value - along.bound",
        "-no_more(half.low + along.value - along.bound",
        Dispatching::ByPair,
        proven_spheres,
    ),
    ("certify_traced.wgsl", "if is_round(triangle) {", "if !is_round(triangle) {", Dispatching::ByPair, proven_spheres),
    (
        "rays/certainty.wgsl",
        "select(PROOF_CONTESTED, PROOF_SURE, is_found",
        "select(PROOF_SURE, PROOF_SURE, is_found",
        Dispatching::ByPair,
        proven_spheres,
    ),
    (
        "edges.wgsl",
        "nearness(layer, near) - 1u > reach",
        "nearness(layer, near) - 1u < reach",
        Dispatching::ByPair,
        sampled,
    ),
    ("edges.wgsl", "s01 == s20 && s01 == s12", "s01 == s20", Dispatching::ByPair, sampled),
    ("sample.wgsl", "covered.may, covered.sure", "covered.may & 7u, covered.sure & 7u", Dispatching::ByPair, sampled),
    ("sample.wgsl", "place + NODE_PX * sample_offset(n)", "place", Dispatching::ByPair, sampled),
    ("samples/hits.wgsl", "here & ~sure", "0u", Dispatching::ByPair, sampled),
    ("sample.wgsl", "let y = bit / TILE;", "let y = bit / TILE / 2u;", Dispatching::ByPair, sampled),
    (
        "edges_by_tile.wgsl",
        "may_cover(sides, 0.0, 0.0, CENTRES",
        "may_cover(sides, 0.0, 0.0, 0.1 * CENTRES",
        Dispatching::ByTile,
        sampled,
    ),
    ("edges_by_tile.wgsl", "edge_of[pixel] = record + 1u;", "edge_of[pixel] = record;", Dispatching::ByTile, sampled),
    ("sample_by_tile.wgsl", "touches[index].xy & pixels", "touches[index].yx & pixels", Dispatching::ByTile, sampled),
    (
        "sample_by_tile.wgsl",
        "complemented_key(0u, nearest.keys[k])",
        "complemented_key(0u, nearest.keys[0])",
        Dispatching::ByTile,
        sampled,
    ),
    (
        "recheck_samples.wgsl",
        "item.y & 15u, 0u, record",
        "item.y & 8u, 0u, record",
        Dispatching::ByTile,
        no_holes_at_samples,
    ),
    ("resolve.wgsl", "coverage += share;", "coverage += 0.5 * share;", Dispatching::ByPair, sampled),
    ("resolve.wgsl", "colour += share * beyond", "colour += 0.0 * share * beyond", Dispatching::ByPair, sampled),
    (
        "outline.wgsl",
        "if id_a == NONE || id_b == NONE {\n        return true;",
        "if id_a == NONE || id_b == NONE {\n        return false;",
        Dispatching::ByPair,
        outlined,
    ),
    (
        "outline.wgsl",
        "0.5 * vec2<f32>(f32(k), f32(1 - k))",
        "0.5 * vec2<f32>(f32(1 - k), f32(k))",
        Dispatching::ByPair,
        outlined,
    ),
    // steps ten times too coarse: errors go by their squares; and a hundred times where bounds are loose
    ("volume/passed/composite.wgsl", "f32 = 1.0 / 512.0;", "f32 = 100.0 / 512.0;", Dispatching::ByPair, glowing),
    (
        "rays/curves/legs.wgsl",
        "0.125 * bend / medium.place_error",
        "0.0000125 * bend / medium.place_error",
        Dispatching::ByPair,
        glowing_along_curves,
    ),
    (
        "volume/passed/maximum.wgsl",
        "largest + medium.value_error",
        "largest + 100.0 * medium.value_error",
        Dispatching::ByPair,
        largest_within,
    ),
    ("volume/cubic.wgsl", "0.45 * next.y", "0.4 * next.y", Dispatching::ByPair, glowing),
    (
        "volume/transfer.wgsl",
        "(value - medium.value[j].x)",
        "(value - 0.9 * medium.value[j].x)",
        Dispatching::ByPair,
        largest_within,
    ),
    (
        "rays/straight/legs.wgsl",
        "let speed = length(vec3<f32>(d));",
        "let speed = 0.98 * length(vec3<f32>(d));",
        Dispatching::ByPair,
        glowing,
    ),
    ("volume/light/unlit.wgsl", "voxels[at + slice + row]", "voxels[at + slice]", Dispatching::ByPair, glowing),
    (
        "volume/light/lit.wgsl",
        "inner(stretch.g, extinctions)",
        "inner(stretch.r, extinctions) * 1.05",
        Dispatching::ByPair,
        lit_within,
    ),
    (
        "volume.wgsl",
        "select(params.t_max.x, key_t(~won), is_hit",
        "select(params.t_max.x, key_t(~won), !is_hit",
        Dispatching::ByPair,
        glowing,
    ),
    ("mip.wgsl", "sum += covered.x * covered.y *", "sum += covered.x *", Dispatching::ByPair, averaged),
    ("paste.wgsl", "texel = vec2<u32>(last) - texel;", "texel = texel;", Dispatching::ByPair, pasted),
    (
        "paste.wgsl",
        "tinted(PLANE_R, pixel, from_texel, optic.tint.x);",
        "tinted(PLANE_R, pixel, from_texel, 1.0);",
        Dispatching::ByPair,
        pasted,
    ),
];

/// Random numbers in a few large cells, through which everything changes much.
fn clouded(engine: &mut Engine, camera: &Camera, mode: Mode, is_lit: bool) -> Result<(), String> {
    let rng = std::cell::RefCell::new(Rng(4));
    let noise = grid([4, 3, 4], DQuat::from_rotation_y(0.4), |_| rng.borrow_mut().unit());
    let points = [[0.1, 0.0, 0.2, 1.0, 0.0], [0.5, 1.0, 0.1, 0.0, 5.0], [0.9, 0.1, 1.0, 0.3, 1.0]];
    let seen_through = Some(volume(noise, &points, mode, is_lit));
    let scene = Scene { volume: seen_through, lights: vec![Light::distant(DVec3::new(-1.0, -2.0, -0.5))], ..crowd() };
    let channels = [Channel::R, Channel::G, Channel::B, Channel::A, Channel::TriangleId];
    let seen = frame(engine, &scene, camera, &centres(&channels)).frame;
    let truth = image(&scene, camera, &channels);
    let same = |k: &usize| ids(&seen)[*k] == ids(&truth)[*k];
    let off = |channel: &Channel| {
        let (a, b) = (seen.f32(*channel).unwrap(), truth.f32(*channel).unwrap());
        (0..a.len()).filter(same).map(|k| (a[k] - b[k]).abs()).fold(0.0, f32::max)
    };
    let worst = channels[..4].iter().map(off).fold(0.0, f32::max);
    demand(worst <= 1.0 / 512.0, &format!("colours are off by {worst}"))
}

fn glowing(engine: &mut Engine) -> Result<(), String> {
    clouded(engine, &eye(), Mode::Composite, false)
}

fn glowing_along_curves(engine: &mut Engine) -> Result<(), String> {
    clouded(engine, &layered::wavy(3, 2.0, false, SIZE), Mode::Composite, false)
}

fn lit_within(engine: &mut Engine) -> Result<(), String> {
    clouded(engine, &eye(), Mode::Composite, true)
}

fn largest_within(engine: &mut Engine) -> Result<(), String> {
    clouded(engine, &eye(), Mode::Maximum, false)
}

/// An engine whose kernels have this in place of a file; `None` where the adapter has not what it takes.
fn engine(by: Dispatching, replaced: Option<&'static File>) -> Option<Engine> {
    let engine = engine_on(|gpu| {
        gpu.has.lanes &= by != Dispatching::ByPair;
        (gpu.has.by_pair, gpu.has.software) = (false, by == Dispatching::ByTile);
        gpu.replaced.extend(replaced);
    })?;
    if by != Dispatching::ByPair && !engine.gpu.has.lanes {
        skip("subgroups are not as wide as a tile");
        return None;
    }
    Some(engine)
}

/// Frames are right, and what is planted in these kernels is noticed.
fn check_planted(by: Dispatching) {
    let mut checked: Vec<Check> = Vec::new();
    let mut unnoticed = Vec::new();
    for (name, from, to, _, check) in PLANTED.into_iter().filter(|p| p.3 == by) {
        if !checked.iter().any(|c| std::ptr::fn_addr_eq(*c, check)) {
            checked.push(check);
            let Some(mut whole) = engine(by, None) else { return };
            check(&mut whole).unwrap_or_else(|e| panic!("for {name}, with nothing planted: {e}"));
        }
        let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("wgsl");
        let text = std::fs::read_to_string(folder.join(name)).unwrap();
        assert_eq!(text.matches(from).count(), 1, "{name} has {from:?} once");
        let file = Box::leak(Box::new(File::new(name, text.replacen(from, to, 1).leak())));
        let Some(mut planted) = engine(by, Some(file)) else { return };
        let noticed = check(&mut planted);
        // it compiles
        planted.gpu.failure().unwrap_or_else(|e| panic!("{name}, {to:?}: {e}"));
        println!("{name}, {to:?}: {noticed:?}");
        if noticed.is_ok() {
            unnoticed.push(format!("{name}: {to}"));
        }
    }
    assert_eq!(unnoticed, [""; 0], "nothing notices these");
}

#[test]
#[ignore = "slow: make test-all"]
fn frames_by_pair_are_right_and_planted_errors_are_noticed() {
    check_planted(Dispatching::ByPair);
}

#[test]
fn frames_by_tile_are_right_and_planted_errors_are_noticed() {
    check_planted(Dispatching::ByTile);
}

#[test]
fn frames_with_bounded_t_are_right_and_planted_errors_are_noticed() {
    check_planted(Dispatching::Bounded);
}
