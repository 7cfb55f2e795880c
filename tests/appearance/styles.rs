//! Patterns, lines and strokes through every kind of rays: against what many rays a pixel of the reference say, and how far from what they
//! follow their places are. Nothing to do without an adapter.

use crate::common;
use crate::pictures;

use anamorph::internals::camera::Camera;
use anamorph::internals::engine::combinations::at_once;
use anamorph::internals::engine::plan::Wanted;
use anamorph::internals::engine::{Engine, RunOptions};
use anamorph::internals::geometry::mesh::Material;
use anamorph::internals::geometry::pattern::{Pattern, PatternKind};
use anamorph::internals::image::frame::{Channel, NO_ID};
use anamorph::internals::reference::image::image;
use anamorph::internals::scene::Scene;
use anamorph::internals::scene::light::Light;
use anamorph::internals::scene::style::{Hatching, Line, Outline, Style};
use common::cameras::{MeshShape, mesh_camera};
use common::file::{camera_of, load};
use common::gpu::engine_on;
use common::layered::chain;
use common::{FORWARD, camera};
use glam::{DVec2, DVec3};
use pictures::{COLOUR, Colours, box_filtered, colours, flip, psnr};
use rayon::prelude::*;
use std::sync::Arc;

const SIZE: (u32, u32) = (80, 60);

/// What pictures may differ from many rays per pixel.
const FLIP_MAX: f64 = 0.05;

/// Every kind of rays, of things about the origin.
fn families() -> Vec<(&'static str, Camera)> {
    let of = |text: &str| camera_of("", SIZE, text).unwrap();
    let look = "eye = [0.3, 0.9, 4]\ntarget = [0, 0, 0]";
    vec![
        ("pinhole", of(&format!("kind = \"pinhole\"\n{look}\nvfov = 32"))),
        (
            "cross-slit",
            of(&format!(
                "kind = \"cross_slit\"\n{look}\nheight = 2.2\nslits = [{{ distance = 3, angle = 0 }}, {{ distance = 4.5, angle = 90 }}]"
            )),
        ),
        ("mesh of 16 x 16", camera(mesh_camera(1, 16, 16, MeshShape::default()), SIZE, FORWARD)),
        ("chain", chain(3, 3, (4, 3), MeshShape::default(), SIZE)),
        ("fisheye", of("kind = \"fisheye\"\neye = [0.2, 0.5, 2]\ntarget = [0, 0, 0]\nfov = 110\nframe = \"full\"")),
        ("curved projector", of(&format!("kind = \"twist\"\n{look}\nvfov = 32\ndegree = 3\nangle = 40"))),
        (
            "mirror",
            of(
                "kind = \"reflection\"\ndepth = 1\neye = { kind = \"pinhole\", eye = [1.6, 0.9, 4], target = [0, 0.2, -2.4], vfov = 14 }\nmirror = { shape = \"sphere\", center = [0, 0.2, -2.6], radius = 0.8 }",
            ),
        ),
    ]
}

/// A scene without a camera of its own.
fn things(text: &str, style: Style) -> Scene {
    let camera = "[camera]\nkind = \"orthographic\"\neye = [0, 0, 2]\ntarget = [0, 0, 0]\nheight = 2";
    let scene =
        load(&format!("image = {{ width = 4, height = 4, background = [1, 1, 1] }}\n{text}\n{camera}")).unwrap();
    Scene { lights: vec![Light::distant(DVec3::new(-0.5, -0.8, -0.6))], style, ..scene }
}

/// A polyhedron whose outline is made of edges.
fn ball(style: Style) -> Scene {
    let mut scene = things("[[mesh]]\nbuiltin = \"icosphere\"\nlevel = 1\nscale = 0.8", style);
    let mesh = Arc::make_mut(&mut scene.mesh);
    (mesh.normals, mesh.corner_normals) = (Vec::new(), Vec::new());
    scene
}

fn rendered(engine: &mut Engine, scene: &Scene, camera: &Camera, samples: u32) -> Colours {
    let wanted = Wanted { samples, ..Wanted::of(COLOUR.to_vec()) };
    colours(&engine.render(scene, camera, &wanted, &RunOptions::default()).unwrap().frame)
}

#[test]
#[ignore = "slow: make test-all"]
fn a_checker_is_the_mean_of_what_pixels_cover() {
    assert_is_filtered(PatternKind::Checker, 0.5);
}

#[test]
#[ignore = "slow: make test-all"]
fn stone_is_the_mean_of_what_pixels_cover() {
    assert_is_filtered(PatternKind::Stone, 0.5);
}

#[test]
#[ignore = "slow: make test-all"]
fn wood_is_the_mean_of_what_pixels_cover() {
    assert_is_filtered(PatternKind::Wood, 0.15);
}

fn assert_is_filtered(kind: PatternKind, size: f64) {
    let Some(mut engine) = engine_on(|_| {}) else { return };
    let mut scene = things("[[mesh]]\nbuiltin = \"plane\"\nsize = 400\ntranslate = [0, -1, 0]", Style::default());
    let pattern = Pattern { light: [1.0, 0.9, 0.8], dark: [0.0, 0.1, 0.3], ..Pattern::new(kind, size) };
    Arc::make_mut(&mut scene.mesh).materials[0] =
        Material { diffuse: [1.0; 3], pattern: Some(pattern), ..Material::default() };
    scene.lights = vec![Light::distant(DVec3::NEG_Y)];
    for (name, camera) in families() {
        let exact = box_filtered(&scene, &camera, 64);
        let seen = rendered(&mut engine, &scene, &camera, 1);
        let (error, unfiltered) = (flip(&exact, &seen, SIZE), flip(&exact, &box_filtered(&scene, &camera, 1), SIZE));
        println!("{kind:?}, {name}: FLIP {error:.4}, {:.1} dB; unfiltered {unfiltered:.4}", psnr(&exact, &seen));
        assert!(error <= FLIP_MAX && error < unfiltered, "{kind:?}, {name}: FLIP {error}, unfiltered {unfiltered}");
    }
}

/// Places per side of a pixel.
const FINE: usize = 8;

/// What many rays per pixel see, row by row of a grid that is `FINE` times as fine as the image.
struct Grid {
    width: usize,
    height: usize,
    ids: Vec<u32>,
    pieces: Vec<u32>,
    mirrors: Vec<u32>,
    positions: Vec<DVec3>,
    normals: Vec<DVec3>,
    colours: Colours,
}

fn grid(scene: &Scene, camera: &Camera) -> Grid {
    let (width, height) = (SIZE.0 as usize * FINE, SIZE.1 as usize * FINE);
    let (none, zero) = (vec![0; width * height], vec![DVec3::ZERO; width * height]);
    let (pieces, mirrors, normals) = (none.clone(), none.clone(), zero.clone());
    let colours_of_all = vec![[0.0; 3]; width * height];
    let mut all = Grid { width, height, ids: none, pieces, mirrors, positions: zero, normals, colours: colours_of_all };
    let position = [Channel::PositionX, Channel::PositionY, Channel::PositionZ];
    let normal = [Channel::NormalX, Channel::NormalY, Channel::NormalZ];
    let mut channels = [&COLOUR[..], &position, &normal, &[Channel::TriangleId, Channel::PieceId]].concat();
    channels.extend(camera.optics.as_ref().map(|_| Channel::MirrorId));
    for (i, j) in (0..FINE * FINE).map(|k| (k % FINE, k / FINE)) {
        let offset = |k: usize| (k as f64 + 0.5) / FINE as f64 - 0.5;
        let frame = image(scene, &camera.with_sample_offset(offset(i), offset(j)), &channels);
        let vector = |of: [Channel; 3], k: usize| DVec3::from(of.map(|c| f64::from(frame.f32(c).unwrap()[k])));
        let seen = colours(&frame);
        for (k, colour) in seen.iter().enumerate() {
            let at = (k / SIZE.0 as usize * FINE + j) * width + k % SIZE.0 as usize * FINE + i;
            all.ids[at] = frame.u32(Channel::TriangleId).unwrap()[k];
            all.mirrors[at] = frame.u32(Channel::MirrorId).map_or(0, |ids| ids[k]);
            all.pieces[at] = frame.u32(Channel::PieceId).unwrap()[k];
            all.positions[at] = vector(position, k);
            all.normals[at] = vector(normal, k);
            all.colours[at] = *colour;
        }
    }
    all
}

impl Grid {
    /// Of each place how far the nearest border is at which two places beside each other differ, px; up to `most`.
    fn distances(&self, most: f64, differ: impl Fn(usize, usize) -> bool) -> Vec<f64> {
        let mut borders = vec![Vec::new(); self.height];
        for k in 0..self.width * self.height {
            let (i, j) = (k % self.width, k / self.width);
            if i + 1 < self.width && differ(k, k + 1) {
                borders[j].push(DVec2::new(i as f64 + 1.0, j as f64 + 0.5));
            }
            if j + 1 < self.height && differ(k, k + self.width) {
                borders[j].push(DVec2::new(i as f64 + 0.5, j as f64 + 1.0));
            }
        }
        let reach = most * FINE as f64 + 2.0;
        let nearest = |k: usize| {
            let at = DVec2::new((k % self.width) as f64 + 0.5, (k / self.width) as f64 + 0.5);
            let rows = (at.y - reach).max(0.0) as usize..((at.y + reach) as usize).min(self.height);
            let near = borders[rows].iter().flatten().filter(|b| (b.x - at.x).abs() <= reach);
            near.map(|b| b.distance_squared(at)).fold(f64::INFINITY, f64::min).sqrt() / FINE as f64
        };
        (0..self.width * self.height).into_par_iter().map(nearest).collect()
    }

    /// The picture of all places.
    fn mean(&self, colour: impl Fn(usize) -> [f64; 3]) -> Colours {
        let mut sums = vec![[0.0; 3]; SIZE.0 as usize * SIZE.1 as usize];
        for k in 0..self.width * self.height {
            let sum = &mut sums[k / self.width / FINE * SIZE.0 as usize + k % self.width / FINE];
            let own = colour(k);
            (0..3).for_each(|c| sum[c] += own[c] / (FINE * FINE) as f64);
        }
        sums
    }
}

fn line(width: f64) -> Line {
    Line { width, colour: [0.6, 0.0, 0.1], depth: f64::INFINITY }
}

#[test]
#[ignore = "slow: make test-all"]
fn wires_are_as_wide_in_pixels_as_they_shall_be() {
    let Some(mut engine) = engine_on(|_| {}) else { return };
    let (plain, mut kinds) = (ball(Style::default()), 0);
    for (name, camera) in families() {
        let grid = grid(&plain, &camera);
        let to_edge = grid.distances(2.0, |a, b| grid.ids[a] != grid.ids[b]);
        for width in [0.7, 1.5, 3.0] {
            let scene = ball(Style { wireframe: Some(line(width)), ..Style::default() });
            let is_wire = |k: usize| grid.ids[k] != NO_ID && to_edge[k] <= width / 2.0;
            let exact = grid.mean(|k| if is_wire(k) { line(width).colour.map(f64::from) } else { grid.colours[k] });
            for samples in [1, 8] {
                if samples > 1 && !at_once(&scene, &camera, samples) {
                    continue;
                }
                let seen = rendered(&mut engine, &scene, &camera, samples);
                let error = flip(&exact, &seen, SIZE);
                println!("{name}, {width} px, {samples} samples: FLIP {error:.4}, {:.1} dB", psnr(&exact, &seen));
                assert!(error <= FLIP_MAX, "{name}, {width} px, {samples} samples: FLIP {error}");
                kinds += 1;
            }
        }
    }
    assert!(kinds >= 7 * 3 + 4 * 3);
}

#[test]
fn wires_far_away_are_thinner() {
    let Some(mut engine) = engine_on(|_| {}) else { return };
    let (_, camera) = families().swap_remove(0);
    let ink = |engine: &mut Engine, depth: f64| {
        let wireframe = Some(Line { depth, colour: [0.0; 3], ..line(2.0) });
        let scene = Scene { lights: Vec::new(), ..ball(Style { wireframe, ..Style::default() }) };
        let plain = Scene { style: Style::default(), ..scene.clone() };
        let (seen, plain) = (rendered(engine, &scene, &camera, 1), rendered(engine, &plain, &camera, 1));
        seen.iter().zip(&plain).map(|(a, b)| b[0] - a[0]).sum::<f64>()
    };
    let [whole, half] = [f64::INFINITY, 1.6].map(|depth| ink(&mut engine, depth));
    // the ball is 3.2 away; where lines meet they cover each other
    println!("ink {whole:.1}, of half the width {half:.1}");
    assert!((0.45..0.6).contains(&(half / whole)), "{whole}, {half}");
}

#[test]
fn outlines_and_borders_lie_between_what_differs() {
    let Some(mut engine) = engine_on(|_| {}) else { return };
    // two boxes, each face of one before its parallel of the other
    let turned = "[[mesh]]\nbuiltin = \"box\"\nrotate = [20, 35, 0]";
    let text = format!("{turned}\nscale = 0.9\n{turned}\nscale = 0.5\ntranslate = [0.2, 0.25, 0.8]");
    let plain = things(&text, Style::default());
    for (name, camera) in families() {
        let grid = grid(&plain, &camera);
        let is_plane = |a: usize, b: usize| {
            let off = grid.normals[a].dot(grid.positions[b] - grid.positions[a]).abs();
            grid.normals[a].dot(grid.normals[b]) > 0.9 && off < 1e-4
        };
        let is_face = |a: usize, b: usize| grid.ids[a] == grid.ids[b] || is_plane(a, b);
        let to_edge = grid.distances(2.0, |a, b| {
            grid.mirrors[a] != grid.mirrors[b]
                || (grid.ids[a] == NO_ID) != (grid.ids[b] == NO_ID)
                || grid.ids[a] != NO_ID && !is_face(a, b)
        });
        let to_border = grid.distances(2.0, |a, b| grid.pieces[a] != grid.pieces[b]);
        for (what, distances, style) in [
            (
                "outline",
                &to_edge,
                Style { outline: Some(Outline { line: line(2.0), crease: 40.0 }), ..Style::default() },
            ),
            ("borders", &to_border, Style { borders: Some(line(2.0)), ..Style::default() }),
        ] {
            let scene = things(&text, style);
            let exact =
                grid.mean(|k| if distances[k] <= 1.0 { line(2.0).colour.map(f64::from) } else { grid.colours[k] });
            let seen = rendered(&mut engine, &scene, &camera, 1);
            let error = flip(&exact, &seen, SIZE);
            let inked = |picture: &Colours| picture.iter().map(|c| c[0] - c[1]).sum::<f64>();
            let ratio = inked(&seen) / inked(&exact).max(1e-9);
            println!("{name}, {what}: FLIP {error:.4}, {:.1} dB, {ratio:.3} of the ink", psnr(&exact, &seen));
            // borders of pixels are where lines run, at most half a pixel away
            assert!(error <= 2.0 * FLIP_MAX, "{name}, {what}: FLIP {error}");
            let lines = distances.iter().filter(|d| **d <= 1.0).count();
            assert!(lines > 0 || what == "borders", "{name}: nothing is outlined");
            assert!(lines == 0 || (0.8..1.25).contains(&ratio), "{name}, {what}: {ratio} of the ink");
        }
    }
}

/// A stroke's share of ink, by the definition.
fn is_ink(s: f64, slope: f64, spacing: f64, ink: f64) -> bool {
    let level = (slope * spacing).log2();
    let (period, left) = ((level.floor() + 1.0).exp2(), 1.0 - level + level.floor());
    let width = ink * period / slope / (1.0 + left);
    let distance = |s: f64| (s / period - (s / period).round()).abs() * period / slope;
    distance(s) <= width / 2.0 || distance(s + period / 2.0) <= width * left / 2.0
}

#[test]
#[ignore = "slow: make test-all"]
fn strokes_are_as_dense_as_surfaces_are_dark() {
    let Some(mut engine) = engine_on(|_| {}) else { return };
    const SPACING: f64 = 5.0;
    let style =
        Style { hatching: Some(Hatching { spacing: SPACING, ink: [0.0; 3], paper: [1.0; 3] }), ..Style::default() };
    let plain = ball(Style::default());
    let axes = [DVec3::new(0.5773503, 0.7113249, 0.4009186), DVec3::new(0.6804138, -0.4082483, 0.6085806)];
    for (name, camera) in families() {
        let grid = grid(&plain, &camera);
        let beside = |k: usize, step: usize| {
            let same = |n: &usize| grid.ids.get(*n) == Some(&grid.ids[k]) && !n.is_multiple_of(grid.width);
            let other = Some(k + step).filter(same).or(k.checked_sub(step).filter(same));
            other.map(|n| (grid.positions[n] - grid.positions[k]) * FINE as f64)
        };
        let share = |k: usize| {
            let [r, g, b] = grid.colours[k];
            let dark = 1.0 - (0.2126 * r + 0.7152 * g + 0.0722 * b).clamp(0.0, 1.0);
            let (Some(right), Some(down)) = (beside(k, 1), beside(k, grid.width)) else { return dark };
            let first = dark.min(0.5);
            let inks = [first, if dark > 0.5 { 1.0 - (1.0 - dark) / (1.0 - first) } else { 0.0 }];
            let strokes = axes.iter().zip(inks).filter(|(_, ink)| *ink > 0.0);
            let slope = |axis: DVec3| right.dot(axis).hypot(down.dot(axis));
            let mut all = strokes.map(|(axis, ink)| is_ink(grid.positions[k].dot(*axis), slope(*axis), SPACING, ink));
            if all.any(|ink| ink) { 1.0 } else { 0.0 }
        };
        let exact = grid.mean(|k| if grid.ids[k] == NO_ID { grid.colours[k] } else { [1.0 - share(k); 3] });
        let seen = rendered(&mut engine, &ball(style), &camera, 1);
        let error = flip(&exact, &seen, SIZE);
        let tone = |picture: &Colours| picture.iter().map(|c| c[0]).sum::<f64>() / picture.len() as f64;
        println!(
            "{name}: FLIP {error:.4}, {:.1} dB, tone {:.3} and {:.3}",
            psnr(&exact, &seen),
            tone(&exact),
            tone(&seen)
        );
        let inked = grid.ids.iter().filter(|id| **id != NO_ID).count();
        assert!(error <= FLIP_MAX && inked > 5000, "{name}: FLIP {error}, {inked} places");
    }
}

/// Rays that look all over the scene are sorted, and beside each other no more.
#[test]
fn lines_between_pixels_need_pixels_beside_each_other() {
    let Some(mut engine) = engine_on(|_| {}) else { return };
    let display = "kind = \"lightfield\"\ncenter = [0, 0, 2]\nnormal = [0, 0, 1]\nup = [0, 1, 0]\nwidth = 2\nheight = 2\nviews = [8, 8]\nfov = 40";
    let camera = camera_of("", (64, 64), display).unwrap();
    let scene = ball(Style { borders: Some(line(2.0)), ..Style::default() });
    let wanted = Wanted::of(COLOUR.to_vec());
    let refused = engine.render(&scene, &camera, &wanted, &RunOptions::default()).unwrap_err().to_string();
    assert!(refused.contains("remove outline and borders") && !refused.contains('\n'), "{refused}");
}

#[test]
fn a_scene_says_how_it_is_drawn() {
    let camera = "[camera]\nkind = \"orthographic\"\neye = [0, 0, 2]\ntarget = [0, 0, 0]\nheight = 2";
    let load = |text: &str| load(&format!("image = {{ width = 4, height = 4 }}\n{text}\n{camera}"));
    let scene = load("[style]\nwireframe = 2\noutline = { width = 3, crease = 20, depth = 5 }\nhatching = { spacing = 8, color = [0.1, 0, 0] }\nborders = { color = [1, 0, 0] }\n[[mesh]]\nbuiltin = \"box\"\npattern = { kind = \"wood\", size = 0.2, dark = [0, 0, 0] }").unwrap();
    let black = Line { width: 1.0, colour: [0.0; 3], depth: f64::INFINITY };
    assert_eq!(
        scene.style,
        Style {
            wireframe: Some(Line { width: 2.0, ..black }),
            outline: Some(Outline { line: Line { width: 3.0, depth: 5.0, ..black }, crease: 20.0 }),
            borders: Some(Line { colour: [1.0, 0.0, 0.0], ..black }),
            hatching: Some(Hatching { spacing: 8.0, ink: [0.1, 0.0, 0.0], paper: [1.0; 3] }),
        }
    );
    let material = &scene.mesh.materials[0];
    let wood = Pattern { dark: [0.0; 3], ..Pattern::new(PatternKind::Wood, 0.2) };
    assert_eq!((material.pattern, material.diffuse), (Some(wood), [1.0; 3]));
    for (text, expected) in [
        ("[style]\nwire = 1", "unknown key \"wire\" in style"),
        ("[style]\nwireframe = 0", "style.wireframe: 0 is no width"),
        ("[style]\nwireframe = { width = 100 }", "style.wireframe.width: 100 is no width"),
        ("[style]\noutline = { crease = 200 }", "style.outline.crease: 200 is no angle"),
        ("[style]\nborders = { depth = 2 }", "unknown key \"depth\" in style.borders"),
        ("[style]\nhatching = { spacing = -1 }", "style.hatching.spacing: -1 is out of range"),
        (
            "[[mesh]]\nbuiltin = \"box\"\npattern = { kind = \"tin\" }",
            "mesh.0.pattern.kind: \"tin\" is no pattern; known: \"checker\"",
        ),
        ("[[mesh]]\nbuiltin = \"box\"\npattern = { size = 2 }", "mesh.0.pattern: kind is missing"),
    ] {
        let message = load(text).expect_err(text).to_string();
        assert!(message.contains(expected) && !message.contains('\n'), "{message}");
    }
}
