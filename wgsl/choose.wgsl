// choose: one thread in all. Reads a count of what a stage of raster has still to do, and writes 0 in its place once that costs more than
// tracing, so that nothing more of raster is dispatched; COUNT_TRACED is then the number of pixels that trace takes, those of whole tiles.
// (It has no branches: lavapipe would compile it anew for uniform numbers that alone decide one.)

#import shared/params.wgsl

// By the places of counters: the queues of cull, then COUNT_WORK and so on.
const COSTS: array<u32, 22> = array<u32, 22>(
    CULL_COST, CULL_COST, CULL_COST, CULL_COST, CULL_COST, CULL_COST, CULL_COST, CULL_COST,
    0u, PAIR_COST, 0u, 0u, 0u, 0u, 0u, 0u, 0u, 0u, 0u, TASK_COST, LARGE_COST, 0u,
);

@compute @workgroup_size(1)
fn choose() {
    let count = atomicLoad(&counters[step.value]);
    let is_dear = f32(count) * f32(COSTS[step.value]) > params.raster_budget;
    let pixels = params.tiles_x * ((params.height + TILE - 1u) / TILE) * TILE * TILE;
    let traced = max(atomicLoad(&counters[COUNT_TRACED]), select(0u, pixels, is_dear));
    atomicStore(&counters[COUNT_TRACED], traced);
    atomicStore(&counters[step.value], select(count, 0u, traced > 0u));
}
