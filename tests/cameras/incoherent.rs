//! Incoherent (incoherent) rays: culling changes no pixel.

use crate::common;

use anamorph::internals::camera::{Camera, Field, Rays};
use anamorph::internals::engine::plan::Wanted;
use anamorph::internals::engine::{Method, Rendered, RunOptions};
use anamorph::internals::geometry::generate::icosphere;
use anamorph::internals::geometry::mesh::Mesh;
use anamorph::internals::geometry::place::merge;
use anamorph::internals::image::frame::Channel;
use common::gpu::{check, engine_on, ids, wanted, words};
use common::rng::Rng;
use common::{ALL_T, FORWARD, moved, scene, soup};
use glam::DVec3;

/// Rays through vertices, through middles of edges and of triangles, and past everything, from anywhere and in random order.
fn rays(mesh: &Mesh, count: usize, rng: &mut Rng) -> Vec<(DVec3, DVec3)> {
    let (lo, hi) = mesh.bounds().unwrap();
    let (middle, reach) = ((lo + hi) / 2.0, (hi - lo).length());
    let ray = |k: usize| {
        let corners = mesh.triangles[rng.below(mesh.triangles.len())].map(|v| mesh.positions[v as usize]);
        let through = match k % 8 {
            0..3 => corners[0],
            3 | 4 => (corners[0] + corners[1]) / 2.0,
            5 | 6 => (corners[0] + corners[1] + corners[2]) / 3.0,
            _ => middle + reach * rng.vector(),
        };
        let from = middle + (0.7 + rng.unit()) * reach * rng.vector().normalize();
        // directions of any length
        (from, (through - from) * (0.2 + rng.unit()))
    };
    (0..count).map(ray).collect()
}

fn camera(rays: &[(DVec3, DVec3)], (width, height): (u32, u32), t_range: [f64; 2]) -> Camera {
    let (origins, directions): (Vec<_>, Vec<_>) = rays.iter().copied().unzip();
    let field = Field::new(width, height, &origins, &directions).unwrap();
    Camera::of("raymap", (width, height), t_range, Rays::Field(field))
}

fn things(level: u32) -> Mesh {
    merge(vec![icosphere(level), soup(&mut Rng(4), 200, 0.1)]).unwrap()
}

#[test]
fn incoherent_rays_see_the_same_without_culling() {
    assert_culling_loses_nothing(true);
}

#[test]
fn incoherent_rays_see_the_same_without_culling_and_subgroups() {
    assert_culling_loses_nothing(false);
}

fn assert_culling_loses_nothing(lanes: bool) {
    let Some(mut engine) = engine_on(|gpu| gpu.has.lanes &= lanes) else { return };
    for (by, t_range) in [(DVec3::ZERO, FORWARD), (DVec3::new(300.0, -20.0, 7.0), ALL_T), (DVec3::X, [0.4, 1.1])] {
        let mesh = moved(things(5), by);
        let camera = camera(&rays(&mesh, 41 * 31, &mut Rng(8)), (41, 31), t_range);
        let scene = scene(mesh);
        let [culled, all] = [false, true].map(|no_cull| {
            let run = RunOptions { no_cull, ..Default::default() };
            engine.render(&scene, &camera, &wanted(), &run).unwrap()
        });
        assert!(words(&culled.frame) == words(&all.frame), "{by}, {t_range:?}, lanes {lanes}");
        let share = culled.counts.pairs as f64 / all.counts.pairs as f64;
        println!("{by}, {t_range:?}, lanes {lanes}: {share:.2} of all pairs");
        assert!(
            share < if engine.gpu.has.lanes { 0.25 } else { 0.5 },
            "{by}, {t_range:?}, lanes {lanes}: {share:.2} of all pairs"
        );
    }
}

#[test]
#[ignore = "slow: make test-all"]
fn incoherent_rays_see_what_the_reference_does() {
    let mesh = things(3);
    let camera = camera(&rays(&mesh, 48 * 40, &mut Rng(9)), (48, 40), FORWARD);
    let Some((_, _, seen)) = check("incoherent rays", &scene(mesh), &camera) else { return };
    assert!(seen.pixels == 48 * 40);
}

#[test]
fn incoherent_rays_see_the_same_in_images_of_every_shape() {
    let Some(mut engine) = engine_on(|_| {}) else { return };
    let mesh = icosphere(3);
    let rays = rays(&mesh, 40 * 25, &mut Rng(10));
    let scene = scene(mesh);
    let wanted = Wanted::of(vec![Channel::T, Channel::TriangleId]);
    let mut render = |size| {
        let camera = camera(&rays, size, FORWARD);
        let run = RunOptions { method: Method::Raster, ..RunOptions::default() };
        engine.render(&scene, &camera, &wanted, &run).unwrap()
    };
    let square = render((40, 25));
    for size in [(1000, 1), (1, 1000), (250, 4)] {
        let line = render(size);
        // on a vertex or an edge the perturbation decides, which depends on the neighbouring pixels: compare the other rays
        let plain: Vec<usize> = (0..rays.len()).filter(|k| k % 8 >= 5).collect();
        let seen = |r: &Rendered| plain.iter().map(|&k| ids(&r.frame)[k]).collect::<Vec<_>>();
        assert!(seen(&line) == seen(&square), "{size:?}");
        // tiles have an eighth as many rays, so there are at most eight times as many pairs
        assert!(line.counts.pairs < 8 * square.counts.pairs, "{size:?}: {} pairs", line.counts.pairs);
    }
}
