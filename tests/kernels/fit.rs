//! fit: the kernel's nodes must hold the rays that it read, be little wider than the host's, and be discontinuous by its rule.

use crate::bounced::{bounces, case, cases};
use crate::nasty::{SIZE, nasty};
use crate::stages::{Bench, Case, POISON, SPARE, assert_poisoned, read, run, upload};
use anamorph::internals::engine::plan::curves::RayTable;
use anamorph::internals::engine::plan::fit::{LOOSE, LOOSE_SIZE};
use anamorph::internals::engine::plan::nodes::{DISCONTINUOUS_WIDTH, Level};
use anamorph::internals::engine::stage;
use anamorph::internals::gpu::kernels::Kernel;
use anamorph::internals::gpu::layout::{BRANCH, Cell, Node, RAYS_DISCONTINUOUS, RAYS_LOOSE, RAYS_NONE};
use anamorph_lab::twin::cull::Address;
use anamorph_lab::twin::fit::{fit, rays_below, reach};
use anamorph_lab::twin::{KernelInputs, Real};
use glam::DVec3;

/// What kernels that read a node may lose of it, relative to its sizes: four roundings of 2^-24, for which the host's
/// rows have margin too.
const READ_TOLERANCE: f64 = 1.0 / (1u64 << 22) as f64;
/// Radii of the kernel over those of the host, and what its sums may lose beside that, relative to the node's sizes: the
/// mean of 64 rays in f32, 2^-18; its own tolerance a level, 2^-20.
const LOOSER_MAX: f64 = 1.05;
const LOOSER_TOLERANCE: f64 = 1.0 / (1u64 << 17) as f64;

/// What the kernel left.
#[derive(Clone)]
struct Left {
    nodes: Vec<Node>,
    masks: Vec<u64>,
}

fn run_kernel(bench: &mut Bench, case: &Case, input: &KernelInputs, levels: &[Level]) -> Left {
    let (gpu, stages) = bench.stages(case.variant(Real::F32, false).after_bounce(), &[]);
    let mut buffers = upload(gpu, input);
    let count = levels.iter().map(|l| l.width * l.height).sum::<u32>() as usize;
    let node_words = size_of::<Node>() / 4;
    buffers.upload(gpu, "nodes", &vec![POISON; node_words * count + SPARE * node_words]).unwrap();
    let tiles = input.params.tiles_x * input.params.tiles_y;
    let poison = f32::from_bits(POISON);
    let cell = |tile: u32| Cell {
        p: [poison; 3],
        h: poison,
        d: [poison; 3],
        piece: POISON,
        tile,
        mask_lo: POISON,
        mask_hi: POISON,
        node: tile,
    };
    let before: Vec<Cell> = (0..tiles).map(cell).collect();
    buffers.upload(gpu, "cells", &before).unwrap();
    run(gpu, |pass| stages.encode(gpu, pass, &[&buffers], &stage::fit::fit(levels), &mut Default::default()));
    let words = read(gpu, &buffers, "nodes");
    assert_poisoned(&words, node_words * count, &format!("{}, nodes", case.name));
    let nodes = bytemuck::cast_slice(&words[..node_words * count]).to_vec();
    let cells: Vec<[u32; 12]> = read(gpu, &buffers, "cells").chunks_exact(12).map(|w| w.try_into().unwrap()).collect();
    for (after, before) in cells.iter().zip(&before) {
        let mut kept: [u32; 12] = bytemuck::cast(*before);
        (kept[9], kept[10]) = (after[9], after[10]);
        assert!(*after == kept, "{}: a cell's own words were written", case.name);
    }
    Left { nodes, masks: cells.iter().map(|w| u64::from(w[9]) | u64::from(w[10]) << 32).collect() }
}

fn size(c: [[f32; 3]; 3]) -> f64 {
    c.iter().map(|v| length(*v)).sum()
}

fn length(v: [f32; 3]) -> f64 {
    DVec3::from(v.map(f64::from)).length()
}

/// Every node's address, and its index.
fn addresses(levels: &[Level]) -> impl Iterator<Item = (usize, Address)> + '_ {
    (0..).zip(levels).flat_map(|(level, l)| {
        let at = move |k: u32| Address { level, x: k % l.width, y: k / l.width };
        (0..l.width * l.height).map(move |k| ((l.start + k) as usize, at(k)))
    })
}

/// How nodes stand against the rays, the host's nodes and the rule of tearing.
#[derive(Debug, Default)]
struct Compared {
    wrong: Vec<String>,
    discontinuous: usize,
    /// Least margin that a radius has beyond what it must hold, and largest excess over the host's, relative to its sizes.
    margin: f64,
    excess: f64,
}

fn compare(input: &KernelInputs, levels: &[Level], left: &Left) -> Compared {
    let mut seen = Compared { margin: f64::INFINITY, ..Compared::default() };
    let host = fit(input);
    for (tile, (mask, cell)) in left.masks.iter().zip(&host.cells).enumerate() {
        let want = u64::from(cell.mask_lo) | u64::from(cell.mask_hi) << 32;
        if *mask != want {
            seen.wrong.push(format!("tile {tile}: pixels {mask:x} for {want:x}"));
        }
    }
    for (index, at) in addresses(levels) {
        let (node, host) = (&left.nodes[index], &host.nodes.nodes[index]);
        let rays = rays_below(input, at);
        if rays.is_empty() != (node.rays == RAYS_NONE)
            || ![RAYS_NONE, RAYS_LOOSE, RAYS_DISCONTINUOUS].contains(&node.rays)
        {
            seen.wrong.push(format!("{at:?}: {} rays are called {}", rays.len(), node.rays));
            continue;
        }
        if rays.is_empty() {
            continue;
        }
        seen.discontinuous += usize::from(node.rays == RAYS_DISCONTINUOUS);
        let needed = reach(node, at, &rays);
        let sizes = [size([node.p, node.px, node.py]), size([node.d, node.dx, node.dy])];
        let radii = [node.r_p, node.r_d].map(f64::from);
        let host_radii = [host.r_p, host.r_d].map(f64::from);
        for k in 0..2 {
            let margin = (radii[k] - needed[k] - READ_TOLERANCE * (sizes[k] + needed[k])) / sizes[k];
            if margin.is_nan() || margin < 0.0 {
                let off = needed[k];
                seen.wrong.push(format!("{at:?}, radius {k}: {} does not hold {off}, sizes {}", radii[k], sizes[k]));
            }
            let excess = (radii[k] - LOOSER_MAX * host_radii[k]) / sizes[k];
            if excess.is_nan() || excess > LOOSER_TOLERANCE {
                seen.wrong.push(format!("{at:?}, radius {k}: {} where the host has {}", radii[k], host_radii[k]));
            }
            seen.margin = seen.margin.min(margin);
            seen.excess = seen.excess.max(excess);
        }
    }
    // by the kernel's own numbers but for their rounding, by the host's but for what radii may differ
    for (nodes, margin) in [(&left.nodes, 1e-4), (&host.nodes.nodes, 0.1)] {
        for ((index, at), rule) in addresses(levels).zip(discontinuous(input, levels, nodes, margin)) {
            let is = left.nodes[index].rays == RAYS_DISCONTINUOUS;
            if rule.is_some_and(|discontinuous| discontinuous != is) {
                seen.wrong.push(format!("{at:?}: discontinuous {is} against the rule, but for {margin}"));
            }
        }
    }
    seen
}

/// Which nodes are discontinuous by the rule of plan/fit.rs and plan/nodes.rs, bottom up; nothing where a quantity is nearer to its
/// limit than `margin` of it, or one below is.
fn discontinuous(input: &KernelInputs, levels: &[Level], nodes: &[Node], margin: f64) -> Vec<Option<bool>> {
    let distance = input.optics.map_or(0.0, |o| f64::from(o.optic.scene_size));
    let above = |a: f64, b: f64| if (a - b).abs() <= margin * a.abs().max(b.abs()) { None } else { Some(a > b) };
    let both = |a: Option<bool>, b: Option<bool>| match (a, b) {
        (Some(false), _) | (_, Some(false)) => Some(false),
        (Some(true), Some(true)) => Some(true),
        _ => None,
    };
    let is_loose = |r: f32, c: [[f32; 3]; 3]| {
        let slopes = length(c[1]) + length(c[2]);
        both(above(f64::from(r), LOOSE * slopes), above(f64::from(r), LOOSE_SIZE * size(c)))
    };
    let mut widths: Vec<Option<f64>> = vec![None; nodes.len()];
    let mut flags = vec![Some(false); nodes.len()];
    for (index, at) in addresses(levels) {
        let node = &nodes[index];
        if node.rays == RAYS_NONE {
            continue;
        }
        let t = (distance / length(node.d)).min(f64::from(input.params.t_max[0]));
        let half = |x: [f32; 3], y: [f32; 3], r: f32| length(x) + length(y) + f64::from(r);
        let width = half(node.px, node.py, node.r_p) + t * half(node.dx, node.dy, node.r_d);
        widths[index] = Some(width);
        if at.level == 0 {
            continue;
        }
        let below = levels[at.level as usize - 1];
        let children = (0..BRANCH * BRANCH).map(|k| (at.x * BRANCH + k % BRANCH, at.y * BRANCH + k / BRANCH));
        let inside = children.filter(|(x, y)| *x < below.width && *y < below.height);
        let with_rays: Vec<usize> = inside
            .map(|(x, y)| (below.start + y * below.width + x) as usize)
            .filter(|&k| nodes[k].rays != RAYS_NONE)
            .collect();
        let sum: Option<f64> = with_rays.iter().map(|&k| widths[k]).sum();
        let mean = sum.map(|s| s / with_rays.len() as f64);
        let loose =
            match (is_loose(node.r_p, [node.p, node.px, node.py]), is_loose(node.r_d, [node.d, node.dx, node.dy])) {
                (Some(true), _) | (_, Some(true)) => Some(true),
                (Some(false), Some(false)) => Some(false),
                _ => None,
            };
        flags[index] = both(loose, mean.and_then(|mean| above(DISCONTINUOUS_WIDTH * width, mean)));
        widths[index] = match flags[index] {
            Some(true) => mean,
            Some(false) => Some(width),
            None => None,
        };
    }
    flags
}

fn check(bench: &mut Bench, case: &Case, name: &str, input: &KernelInputs, levels: &[Level]) -> Compared {
    let seen = compare(input, levels, &run_kernel(bench, case, input, levels));
    println!(
        "{name}: {} nodes discontinuous, margin {:.1e}, excess {:.1e}",
        seen.discontinuous, seen.margin, seen.excess
    );
    assert!(seen.wrong.is_empty(), "{name}: {} differ, the first: {}", seen.wrong.len(), seen.wrong[0]);
    seen
}

#[test]
fn nodes_contain_the_bounced_rays() {
    let Some(mut bench) = Bench::open() else { return };
    for case in cases() {
        let tables = case.tables();
        for band in 0..tables.plan.bands.len() {
            let levels = &tables.plan.bands[band].nodes.levels;
            tables.follow(&case.camera, band, Real::F64, |inputs, _| {
                if bounces(&inputs[0]) > 0 {
                    let name = format!("{}, band {band}, after {}", case.name, bounces(&inputs[0]));
                    check(&mut bench, &case, &name, &inputs[0], levels);
                }
            });
        }
    }
}

/// A camera of that size, whose own rays are not looked at.
fn any_case() -> Case {
    let eye = "eye = { kind = \"pinhole\", eye = [0, 0, 5], target = [0, 0, 0], vfov = 40 }";
    case("nasty", SIZE, &format!("kind = \"reflection\"\n{eye}\nmirror = {{ shape = \"sphere\", radius = 1 }}"))
}

/// What fit reads of a case, over these rays.
fn over<'a>(input: &KernelInputs<'a>, rays: &'a RayTable) -> KernelInputs<'a> {
    KernelInputs { rays: Some(rays), ..*input }
}

#[test]
fn nodes_hold_nasty_rays() {
    let Some(mut bench) = Bench::open() else { return };
    let case = any_case();
    let tables = case.tables();
    let list = nasty();
    let mut discontinuous = 0;
    tables.follow(&case.camera, 0, Real::F64, |inputs, _| {
        if bounces(&inputs[0]) == 0 {
            return;
        }
        for (name, rays) in &list {
            let input = over(&inputs[0], rays);
            discontinuous += check(&mut bench, &case, name, &input, &tables.plan.bands[0].nodes.levels).discontinuous;
        }
    });
    assert!(discontinuous > 10, "{discontinuous} nodes discontinuous");
}

#[test]
fn the_kernel_has_the_host_s_constants() {
    let source = Kernel::new("fit.wgsl", any_case().variant(Real::F32, false).after_bounce(), &[]).source();
    for line in [
        format!("const LOOSE: f32 = {LOOSE:?};"),
        format!("const LOOSE_SIZE: f32 = 1.0 / {:?};", 1.0 / LOOSE_SIZE),
        format!("const DISCONTINUOUS_WIDTH: f32 = {DISCONTINUOUS_WIDTH:?};"),
    ] {
        assert!(source.contains(&line), "no {line}");
    }
}

#[test]
fn the_comparison_sees_planted_errors() {
    let case = any_case();
    let tables = case.tables();
    let levels = &tables.plan.bands[0].nodes.levels;
    let list = nasty();
    tables.follow(&case.camera, 0, Real::F64, |inputs, _| {
        let (_, rays) = list.iter().find(|t| t.0 == "a silhouette").unwrap();
        if bounces(&inputs[0]) == 0 {
            return;
        }
        let input = over(&inputs[0], rays);
        // the host's own nodes, with the margin that they have for kernels twice
        let host = fit(&input);
        let mut nodes = host.nodes.nodes.clone();
        for node in &mut nodes {
            node.r_p += (size([node.p, node.px, node.py]) * READ_TOLERANCE) as f32;
            node.r_d += (size([node.d, node.dx, node.dy]) * READ_TOLERANCE) as f32;
            node.rays =
                node.rays.min(RAYS_LOOSE).max(if node.rays == RAYS_DISCONTINUOUS { RAYS_DISCONTINUOUS } else { 0 });
        }
        let masks = host.cells.iter().map(|c| u64::from(c.mask_lo) | u64::from(c.mask_hi) << 32).collect();
        let right = Left { nodes, masks };
        let seen = compare(&input, levels, &right);
        assert!(seen.wrong.is_empty(), "{:?}", seen.wrong.first());
        let top = right.nodes.len() - 1;
        let discontinuous = right.nodes.iter().position(|n| n.rays == RAYS_DISCONTINUOUS).unwrap();
        let found = |what: &str, change: &dyn Fn(&mut Left)| {
            let mut left = right.clone();
            change(&mut left);
            assert!(!compare(&input, levels, &left).wrong.is_empty(), "{what} is not seen");
        };
        // a tile's radii just hold its rays; those above hold what may lie below
        for (k, share) in [(0, 0.99), (levels[1].start as usize, 0.2), (top, 0.2)] {
            found("a small radius of origins", &|l| l.nodes[k].r_p *= share);
            found("a small radius of directions", &|l| l.nodes[k].r_d *= share);
            found("a large radius", &|l| l.nodes[k].r_p *= 1.3);
            found("a fit beside the rays", &|l| l.nodes[k].d[1] += 0.01);
            found("no rays", &|l| l.nodes[k].rays = RAYS_NONE);
        }
        found("no tolerance", &|l| (l.nodes[0].r_p, l.nodes[0].r_d) = (0.0, 0.0));
        found("a node that is not discontinuous", &|l| l.nodes[discontinuous].rays = RAYS_LOOSE);
        found("a discontinuous tile", &|l| l.nodes[0].rays = RAYS_DISCONTINUOUS);
        found("a pixel too few", &|l| l.masks[3] ^= 1 << 17);
    });
}
