//! small: what it draws and what it leaves to bin and raster come, together, to what the twin's raster draws.

use crate::kernels::raster::{Job, assert_drawn, compare};
use crate::stages::{
    Bench, Case, POISON, assert_poisoned, cases, counters, list, many_clusters, random_case, read, read_list, run,
    seeds, upload,
};
use anamorph::internals::engine::stage;
use anamorph::internals::engine::stage::recheck::recheck;
use anamorph::internals::engine::stage::small::small;
use anamorph::internals::engine::stage::sort::sort;
use anamorph::internals::engine::stage::split::split;
use anamorph::internals::gpu::buffers::Buffers;
use anamorph::internals::gpu::kernels::{File, TilePath, Variant};
use anamorph::internals::gpu::layout::{COUNTERS, Counter};
use anamorph_lab::twin::bin::bin;
use anamorph_lab::twin::cull::{Bound, cull};
use anamorph_lab::twin::raster::{Visibility, raster};
use anamorph_lab::twin::{KernelInputs, LARGE, Real, Tables};
use std::collections::HashSet;

/// The kernels' list of what small leaves, and how long it should be.
struct Left {
    large: Vec<[u32; 2]>,
    demand: u32,
    /// Triangles that are drawn, once for each node.
    drawn: u32,
}

/// `None` where small triangles are not drawn by themselves.
fn variant(bench: &Bench, case: &Case) -> Option<Variant> {
    let variant = case.variant(Real::F64, true).with_tiles(TilePath::EXACT).with_small();
    (bench.gpu.has.lanes && variant.draws_small()).then_some(variant)
}

/// Draws the clusters of one input, from split to recheck.
fn draw(bench: &mut Bench, case: &Case, variant: Variant, input: &KernelInputs, shared: &Buffers) -> Left {
    let (gpu, stages) = bench.stages(variant, &[]);
    let work = cull(input, Bound::PLAIN).work;
    let mut input = *input;
    input.params.work_capacity = work.len() as u32;
    input.params.task_capacity = 8 * work.len() as u32;
    let mut buffers = upload(gpu, &input);
    let (pairs, tiles) = (input.params.pair_capacity as usize, input.tile_start.len() - 1);
    list(gpu, &mut buffers, "work", &work, work.len());
    list(gpu, &mut buffers, "tasks", &[], 8 * work.len());
    for name in ["large", "unsorted", "pairs"] {
        list(gpu, &mut buffers, name, &[], pairs);
    }
    list(gpu, &mut buffers, "recheck_items", &[], input.params.recheck_capacity as usize);
    buffers.upload(gpu, "ranks", &vec![POISON; pairs]).unwrap();
    buffers.upload(gpu, "starts", &vec![POISON; tiles]).unwrap();
    buffers.upload(gpu, "ends", &vec![0u32; tiles]).unwrap();
    buffers.upload(gpu, "busy", &vec![POISON; tiles]).unwrap();
    let zeros: Vec<(u32, u32)> = (0..COUNTERS).map(|k| (k, 0)).collect();
    counters(gpu, &mut buffers, &[&zeros[..], &[(Counter::Work.index(), work.len() as u32)]].concat());
    run(gpu, |pass| {
        let mut dispatches = vec![split(), small(), stage::bin::bin(variant)];
        dispatches.extend(sort(tiles as u32));
        dispatches.extend(stage::raster::raster(variant, 0, 1));
        dispatches.push(recheck(0));
        stages.encode(gpu, pass, &[&buffers, shared], &dispatches, &mut Default::default())
    });
    let counted = read(gpu, &buffers, "counters");
    let demand = counted[Counter::Large.index() as usize];
    let count = (demand as usize).min(pairs);
    let items = read_list(gpu, &buffers, "large");
    assert_poisoned(items.as_flattened(), 2 * count, &format!("{}, large", case.name));
    let tasks = counted[Counter::Tasks.index() as usize] as usize;
    let of = |task: &[u32; 2]| input.triangle_groups[task[0] as usize].count;
    let all: u32 = read_list(gpu, &buffers, "tasks")[..tasks].iter().map(of).sum();
    assert!(demand <= all, "{}: {demand} of {all} triangles are left", case.name);
    Left { large: items[..count].to_vec(), demand, drawn: all - demand }
}

/// The bands of a case: their inputs with all pairs that the twin finds, and what it draws of these.
fn bands<'a>(case: &Case, tables: &'a Tables) -> Vec<(Vec<Job<'a>>, Visibility)> {
    let with_pairs = |mut input: KernelInputs<'a>| {
        let pixels = input.params.width * input.params.height;
        input.params.pair_capacity = 1 << 18;
        input.params.recheck_capacity = 8 * pixels + (1 << 16);
        let binned = bin(&input, &cull(&input, Bound::PLAIN).work, Real::F64);
        (input, binned.iter().map(|b| b.pair().pack()).collect())
    };
    let band = |inputs: Vec<KernelInputs<'a>>| {
        let jobs: Vec<Job> = inputs.into_iter().map(with_pairs).collect();
        let mut twin = Visibility::new((jobs[0].0.params.width * jobs[0].0.params.height) as usize);
        jobs.iter().for_each(|(input, pairs)| raster(input, pairs, Real::F64, &mut twin));
        (jobs, twin)
    };
    case.bands(tables).into_iter().map(band).collect()
}

/// Draws the jobs of a band into one buffer, and what each leaves.
fn draw_band(bench: &mut Bench, case: &Case, variant: Variant, jobs: &[Job]) -> (Vec<[u32; 2]>, Vec<Left>) {
    let pixels = (jobs[0].0.params.width * jobs[0].0.params.height) as usize;
    let mut shared = Buffers::default();
    shared.upload(&bench.gpu, "visibility", &vec![[0u32; 2]; pixels]).unwrap();
    let left = jobs.iter().map(|(input, _)| draw(bench, case, variant, input, &shared)).collect();
    (read(&bench.gpu, &shared, "visibility").chunks_exact(2).map(|w| [w[0], w[1]]).collect(), left)
}

#[test]
fn small_and_large_triangles_come_to_what_the_twin_draws() {
    let Some(mut bench) = Bench::open() else { return };
    let (mut drawn, mut left) = (0, 0);
    for case in cases().into_iter().chain([many_clusters()]).chain(seeds().map(random_case)) {
        let Some(variant) = variant(&bench, &case) else { continue };
        let tables = case.tables();
        for (jobs, twin) in bands(&case, &tables) {
            let (words, found) = draw_band(&mut bench, &case, variant, &jobs);
            for found in found {
                let once: HashSet<&[u32; 2]> = found.large.iter().collect();
                assert_eq!(once.len(), found.large.len(), "{}: an item is left twice", case.name);
                drawn += found.drawn;
                left += found.demand;
            }
            assert_drawn(&case.name, &jobs, &words, &twin);
        }
    }
    if bench.gpu.has.lanes && bench.gpu.has.f64 && bench.gpu.has.atomics64 {
        assert!(drawn > 1000 && left > 100, "the cases must draw triangles ({drawn}) and leave some ({left})");
    }
}

/// The bound adds up the worst of every rounding, and real ones cancel: measured, 4 pixels are wrong at a hundredth of it, 126 at half of
/// that.
#[test]
fn a_bound_on_coverage_two_hundred_times_smaller_is_noticed() {
    let (name, bound) = ("software/drawn.wgsl", "20.0 * UNIT");
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("wgsl").join(name);
    let text = std::fs::read_to_string(path).unwrap();
    assert_eq!(text.matches(bound).count(), 1);
    let Some(mut bench) = Bench::open() else { return };
    let planted = text.replacen(bound, "0.1 * UNIT", 1);
    bench.gpu.replaced.push(Box::leak(Box::new(File::new(name, planted.leak()))));
    let mut wrong = 0;
    for case in cases().into_iter().filter(|c| c.name.starts_with("vertices on rays")) {
        let Some(variant) = variant(&bench, &case) else { return };
        let tables = case.tables();
        for (jobs, twin) in bands(&case, &tables) {
            let (words, _) = draw_band(&mut bench, &case, variant, &jobs);
            wrong += compare(&jobs, Real::F64, &words, &twin).wrong.len();
        }
    }
    assert!(wrong > 0, "nothing notices the bound");
}

#[test]
fn the_counter_keeps_counting_past_the_end_of_the_list() {
    let Some(mut bench) = Bench::open() else { return };
    let case = cases().into_iter().find(|c| c.name == "large").expect("a case of that name");
    let Some(variant) = variant(&bench, &case) else { return };
    let tables = case.tables();
    let mut input = case.inputs(&tables, LARGE)[0];
    let draw = |bench: &mut Bench, pairs: u32, input: &mut KernelInputs| {
        input.params.pair_capacity = pairs;
        input.params.recheck_capacity = 1 << 16;
        let pixels = (input.params.width * input.params.height) as usize;
        let mut shared = Buffers::default();
        shared.upload(&bench.gpu, "visibility", &vec![[0u32; 2]; pixels]).unwrap();
        self::draw(bench, &case, variant, input, &shared)
    };
    let whole = draw(&mut bench, 1 << 16, &mut input);
    let short = draw(&mut bench, 1, &mut input);
    assert!(whole.demand > 1 && whole.large.len() == whole.demand as usize, "{} left", whole.demand);
    assert!(short.demand == whole.demand && short.large.len() == 1 && whole.large.contains(&short.large[0]));
}
