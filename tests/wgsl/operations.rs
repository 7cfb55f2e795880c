//! The count of a kernel's operations: on a kernel whose counts are known, and what shall hold of the stages.

use super::super::variants;
use anamorph::internals::engine::stage::KernelId;
use anamorph::internals::gpu::kernels::{Method, TilePath, Variant, Visibility};
use anamorph::internals::image::frame::Channel;
use anamorph_lab::operations::{ByLoopDepth, Operations, of_kernel, operations};

const KNOWN: &str = "
override COUNTING: bool = false;
override LISTED: u32 = 7u;
const NEVER: bool = false;
struct Item { place: vec3<f32>, id: u32, weights: array<f32, 2> }
@group(0) @binding(0) var<storage, read> items: array<Item>;
@group(0) @binding(1) var<storage, read_write> sums: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read_write> counters: array<atomic<u32>>;
@group(0) @binding(3) var<uniform> step: vec4<u32>;
@group(0) @binding(4) var table: texture_2d<u32>;

// 4 words a texel, in a loop; 5 f64 operations and a division outside of it
fn wide(texels: u32) -> f64 {
    var total = 0u;
    for (var k = 0u; k < texels; k++) {
        total += textureLoad(table, vec2(k, 0u), 0).x;
    }
    let x = f64(total);
    return dot(vec2<f64>(x), vec2<f64>(x, 1.0lf)) / (-x);
}

// not called
fn idle() { sums[1] = vec4(f32(wide(9u))); }

fn put(place: u32, value: f32) {
    if place != 7u {
        sums[place] = vec4(value);
    }
}

// of this call alone a constant: false
fn is_below(limit: u32, k: u32) -> bool {
    if limit == 0u {
        return false;
    }
    return k < limit;
}

fn counts() -> bool { return atomicAdd(&counters[0], 1u) > 8u; }

@compute @workgroup_size(64) fn known(@builtin(global_invocation_id) thread: vec3<u32>) {
    var local = array<vec4<f32>, 2>();
    local[0] = vec4(1.0);
    let item = items[thread.x];                      // 6 words
    if COUNTING || NEVER {
        counts();
    }
    if COUNTING && counts() && counts() {
        return;
    }
    if LISTED != 7u || step.x == 1u {
        local[1] = sums[step.y];                     // 4
    }
    put(LISTED, 1.0);                                // none where it is 7
    put(step.z, 2.0);                                // 4
    if is_below(0u, step.w) && item.id > 5u {
        sums[0] = sums[1];                           // none
    }
    if is_below(9u, step.w) {
        sums[0].x = 0.0;                             // 1
    }
    for (var i = 0u; i < item.id; i++) {
        local[0] += sums[i];                         // 4, in a loop
        for (var j = 0u; COUNTING && j < i; j++) {
            sums[j] = local[0];
        }
        for (var j = 0u; j < i; j++) {
            sums[j].y = items[j].place.x;            // 1 and 1, in a loop in a loop
            atomicMax(&counters[j], 1u);
            for (var k = 0u; k < j; k++) {
                local[1].x += items[k].place.y;      // counted there too
            }
        }
        let far = wide(i);
        if far < 0.0lf {                             // 1 operation
            atomicStore(&counters[i], u32(item.weights[1]));
            break;
        }
    }
    let v = sqrt(vec3<f64>(item.place)) * 2.0lf;     // 3 conversions, 3 roots, 3 products, and below 3 conversions
    sums[thread.x] = local[0] + vec4(vec3<f32>(v), atomicLoadOf());
}

fn atomicLoadOf() -> f32 { return f32(atomicLoad(&counters[1])); }
";

fn known(constants: &[(&str, f64)]) -> ByLoopDepth {
    operations(KNOWN, constants).unwrap_or_else(|e| panic!("{e}"))
}

#[test]
fn operations_are_counted_where_they_are_done() {
    let outside = Operations { loads: 6 + 4 + 1, stores: 4 + 4 + 1, atomics: 0, f64: 3 + 3 + 3, f64_divisions: 3 };
    // by `wide`: a conversion, a dot product of two numbers, a negation
    let in_a_loop = Operations { loads: 4, stores: 1, atomics: 0, f64: 1 + 3 + 1 + 1, f64_divisions: 1 };
    let deeper = Operations { loads: 1 + 1 + 4, stores: 1, atomics: 1, ..Default::default() };
    assert_eq!(known(&[]), [outside, in_a_loop, deeper]);
}

#[test]
fn what_overrides_leave_out_is_not_counted() {
    let [outside, in_a_loop, deeper] = known(&[]);
    let counting = Operations { atomics: 3, ..outside };
    assert_eq!(known(&[("COUNTING", 1.0)]), [counting, in_a_loop, Operations { stores: 1 + 4, ..deeper }]);
    assert_eq!(known(&[("LISTED", 8.0)]), [Operations { stores: 3 * 4 + 1, ..outside }, in_a_loop, deeper]);
    assert!(operations(KNOWN, &[("NEVER", 1.0)]).is_err(), "no override");
}

/// The kernel of a stage with every plane.
fn of_stage(id: KernelId, variant: Variant) -> Option<ByLoopDepth> {
    let planes: Vec<Channel> = Channel::every().collect();
    let kernel = id.kernel(variant, &planes)?;
    Some(of_kernel(&kernel).unwrap_or_else(|e| panic!("{variant:?}: {e}")))
}

fn sum(counted: ByLoopDepth) -> Operations {
    let mut sum = Operations::default();
    counted.into_iter().for_each(|operations| sum += operations);
    sum
}

/// Only what raster leaves uncertain, and what is seen, takes f64.
#[test]
fn no_stage_before_raster_takes_f64() {
    let by_tile = |variant: Variant| [vec![variant], variant.by_each_tile_path()].concat();
    for variant in variants().flat_map(by_tile).filter(|v| v.f64()) {
        for id in [KernelId::Cull, KernelId::Split, KernelId::Bin, KernelId::Allot, KernelId::Sort, KernelId::Write] {
            let Some(counted) = of_stage(id, variant) else { continue };
            let Operations { loads, stores, f64, f64_divisions, .. } = sum(counted);
            assert_eq!((f64, f64_divisions), (0, 0), "{id:?} {variant:?}");
            assert!(loads > 0 && stores > 0, "{id:?} {variant:?}");
        }
    }
}

#[test]
fn counting_costs_nothing_where_nothing_is_counted() {
    let plain = Variant::plain(true, true).with(|v| v.path.visibility = Visibility::by_pair(Method::Auto));
    let by_tile = |variant: Variant| variant.with_tiles(TilePath::EXACT).with_small();
    for plain in [plain, by_tile(plain)] {
        let counting = plain.with(|v| v.extras.counting = true);
        for id in [KernelId::Bin, KernelId::Raster, KernelId::Trace] {
            let [more, less] = [counting, plain].map(|variant| of_stage(id, variant).map(sum).unwrap());
            assert!(more.atomics > less.atomics, "{id:?}: {more:?} {less:?}");
            assert_eq!(Operations { atomics: less.atomics, ..more }, less, "{id:?}");
        }
    }
    let counted = of_stage(KernelId::Recheck, plain).map(sum).unwrap();
    assert!(counted.f64 > 0 && counted.f64_divisions > 0 && counted.atomics > 0, "{counted:?}");
}
