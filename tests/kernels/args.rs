//! args: the workgroups of the next dispatch, for every list and counts up to the largest.

use crate::common::needs::adapter;
use crate::stages::{assert_poisoned, counters, read, run};
use anamorph::internals::gpu::Gpu;
use anamorph::internals::gpu::buffers::{Buffers, Pipeline};
use anamorph::internals::gpu::kernels::Kernel;
use anamorph::internals::gpu::layout::*;
use bytemuck::Zeroable;

/// Workgroups a side of a dispatch at most.
const SIDE: u64 = 65_535;

/// A list's counter, its capacity, and how many threads take an item.
type List = (u32, u32, u32);

fn params() -> Params {
    Params {
        raster_budget: f32::MAX,
        queue_capacity: 1000,
        work_capacity: 900_000_000,
        pair_capacity: 70_000_000,
        recheck_capacity: 801,
        task_capacity: 100_000_000,
        edge_capacity: 600,
        ..Params::zeroed()
    }
}

fn lists() -> [List; 8] {
    let p = params();
    [
        (0, p.queue_capacity, 1),
        (Counter::Work.index(), p.work_capacity, CLUSTER / TRIANGLE_GROUP),
        (Counter::Tasks.index(), p.task_capacity, TRIANGLE_GROUP),
        (Counter::Pairs.index(), p.pair_capacity, 1),
        (Counter::RecheckItems.index(), p.recheck_capacity, 1),
        (Counter::Edges.index(), p.edge_capacity, 1),
        (Counter::RecheckSamples.index(), p.recheck_capacity / 2, 1),
        // blocks have capacity for all, which memory keeps far below this
        (Counter::Blocks.index(), u32::MAX - GROUP, LANES),
    ]
}

/// What the kernel writes, and the counters after it.
fn args(gpu: &Gpu, pipeline: &Pipeline, counter: u32, given: &[(u32, u32)]) -> (Vec<u32>, Vec<u32>) {
    args_of(gpu, pipeline, params(), counter, given, 3)
}

fn args_of(
    gpu: &Gpu,
    pipeline: &Pipeline,
    params: Params,
    counter: u32,
    given: &[(u32, u32)],
    written: usize,
) -> (Vec<u32>, Vec<u32>) {
    let mut b = Buffers::default();
    b.upload_uniform(gpu, "params", &params).unwrap();
    b.upload_uniform(gpu, "step", &Step { value: counter }).unwrap();
    b.upload(gpu, "indirect", &[crate::stages::POISON; 8]).unwrap();
    counters(gpu, &mut b, given);
    let group = pipeline.bind(gpu, &[&b]).unwrap();
    run(gpu, |pass| {
        pass.set_pipeline(pipeline.raw());
        pass.set_bind_group(0, &group, &[]);
        pass.dispatch_workgroups(1, 1, 1);
        Ok(())
    });
    let indirect = read(gpu, &b, "indirect");
    assert_poisoned(&indirect[..8], written, "indirect");
    (indirect[..3].to_vec(), read(gpu, &b, "counters"))
}

/// Whether these workgroups are enough for the items, and less than a row more than that.
fn suit(indirect: &[u32], items: u32, threads: u32) -> bool {
    let [columns, rows, deep] = [0, 1, 2].map(|k| u64::from(indirect[k]));
    let needed = (u64::from(items) * u64::from(threads)).div_ceil(u64::from(GROUP));
    let fewest_rows = needed.div_ceil(SIDE);
    deep == 1 && rows == fewest_rows && columns <= SIDE && (needed..needed + rows.max(1)).contains(&(columns * rows))
}

#[test]
fn dispatches_hold_all_items_of_a_list_and_end_with_it() {
    let Some(gpu) = adapter() else { return };
    let pipeline = Pipeline::new(&gpu, Kernel::alone("args.wgsl")).unwrap();
    for (counter, capacity, threads) in lists() {
        let counts = [
            0,
            1,
            7,
            8,
            9,
            64,
            65,
            4_194_240,
            4_194_241,
            9_999_999,
            capacity.saturating_sub(1),
            capacity,
            u32::MAX - GROUP,
        ];
        for count in counts {
            let (indirect, after) = args(&gpu, &pipeline, counter, &[(counter, count)]);
            assert!(suit(&indirect, count.min(capacity), threads), "counter {counter} of {count}: {indirect:?}");
            assert_eq!(after[counter as usize], count);
        }
    }
    // busy tiles: those listed since the last time
    for (count, end) in [(0, 0), (5, 0), (5, 5), (900, 64), (9_000_000, 1)] {
        let given = [(Counter::Busy.index(), count), (Counter::BusyEnd.index(), end)];
        let (indirect, after) = args(&gpu, &pipeline, Counter::Busy.index(), &given);
        assert!(suit(&indirect, count - end, LANES), "busy tiles from {end} to {count}: {indirect:?}");
        assert_eq!([Counter::BusyFirst.index(), Counter::BusyEnd.index()].map(|k| after[k as usize]), [end, count]);
    }
    // planted: one workgroup too few, one row too many, a dispatch into the depth
    assert!(
        suit(&[2, 1, 1], 128, 1) && !suit(&[1, 1, 1], 128, 1) && !suit(&[2, 2, 1], 128, 1) && !suit(&[2, 1, 2], 128, 1)
    );
}

#[test]
fn trace_takes_over_where_what_is_left_of_raster_costs_more() {
    let Some(gpu) = adapter() else { return };
    let kernels = ["choose.wgsl", "args.wgsl"].map(|file| Pipeline::new(&gpu, Kernel::alone(file)).unwrap());
    let traced = Counter::Traced.index();
    let run = |pipeline: &Pipeline, budget: f32, counter: u32, given: &[(u32, u32)]| {
        let own = Params { raster_budget: budget, tiles_x: 7, height: 19, ..params() };
        args_of(&gpu, pipeline, own, counter, given, if counter == traced { 3 } else { 0 })
    };
    let pixels = 7 * 3 * 64;
    let costs = [(0, CULL_COST), (7, CULL_COST), (Counter::Tasks.index(), TASK_COST)];
    let costs = costs.into_iter().chain([(Counter::Large.index(), LARGE_COST), (Counter::Pairs.index(), PAIR_COST)]);
    for (counter, cost) in costs {
        for (count, left, taken) in [(300, 300, 0), (301, 0, pixels)] {
            let after = run(&kernels[0], (300 * cost) as f32, counter, &[(counter, count), (traced, 0)]).1;
            assert_eq!([after[counter as usize], after[traced as usize]], [left, taken], "{counter}");
        }
    }
    // from then on nothing of raster is left
    for counter in [0, Counter::Work.index(), Counter::Tasks.index(), Counter::Pairs.index(), Counter::Busy.index()] {
        let after = run(&kernels[0], f32::MAX, counter, &[(counter, 5), (traced, pixels)]).1;
        assert_eq!([after[counter as usize], after[traced as usize]], [0, pixels], "{counter}");
    }
    // all tiles are traced, more than any list holds
    for count in [0, pixels, 9_999_936] {
        assert!(suit(&run(&kernels[1], 0.0, traced, &[(traced, count)]).0, count, 1));
    }
}
