//! f64 in 32-bit words (`naga-soft-f64`): the numbers that the host's f64 gives, bit for bit.

mod common;

use anamorph::internals::gpu::Gpu;
use anamorph::internals::gpu::buffers::Buffers;
use anamorph::internals::gpu::compile::lowered;
use anamorph::internals::gpu::readback::{read_words, readback};
use common::needs::{adapter, skip};
use common::rng::Rng;

/// Reads two numbers per row, three words each: an f64 and an f32. Writes what every operation makes of them.
const PROBE: &str = "
@group(0) @binding(0) var<storage, read> given: array<vec4<u32>>;
@group(0) @binding(1) var<storage, read_write> found: array<array<vec2<u32>, 24>>;

fn flag(is: bool) -> vec2<u32> {
    return vec2<u32>(select(0u, 1u, is), 0u);
}

// Shapes that kernels use: structs, arrays of vectors, vectors of conditions.
struct Pair {
    both: vec3<f64>,
    spare: array<vec3<f64>, 2>,
}

const ZERO: Pair = Pair(vec3<f64>(0.0), array<vec3<f64>, 2>(vec3<f64>(1.0, 2.0, 3.0), vec3<f64>(0.5)));

@compute @workgroup_size(64)
fn probe(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= arrayLength(&given) {
        return;
    }
    let row = given[id.x];
    let a = real_from_bits(row.xy);
    let b = real_from_bits(row.zw);
    var pair = ZERO;
    pair.both = vec3<f64>(a, b, 1.0);
    pair.spare[id.x & 1u] = pair.both.zyx;
    let picked = select(pair.spare[0], pair.spare[1], vec3<bool>((id.x & 1u) != 0u, true, false));
    var crossed = vec3<f64>(a, b, 2.0);
    crossed -= cross(vec3<f64>(a, b, 0.5), vec3<f64>(b, a, 0.25));
    found[id.x] = array<vec2<u32>, 24>(
        real_to_bits(a + b), real_to_bits(a - b), real_to_bits(a * b), real_to_bits(a / b),
        real_to_bits(sqrt(a)), real_to_bits(-a), real_to_bits(abs(a)), real_to_bits(min(a, b)), real_to_bits(max(a, b)),
        flag(a < b), flag(a <= b), flag(a == b), flag(a != b), flag(a > b), flag(a >= b),
        real_to_bits(f64(bitcast<f32>(row.x))), vec2<u32>(bitcast<u32>(f32(a)), 0u),
        real_to_bits(f64(row.x)), real_to_bits(f64(i32(row.x))), vec2<u32>(u32(select(0.0lf, a, abs(a) < 4e9)), 0u),
        real_to_bits(dot(vec3<f64>(a, b, 1.5), vec3<f64>(b, a, 0.75))),
        real_to_bits(crossed.z), real_to_bits(picked.z), real_to_bits(select(a, b, all(vec2<f64>(a, b) < vec2<f64>(b, a)))),
    );
}
";

const NAMES: [&str; 24] = [
    "+", "-", "*", "/", "sqrt", "neg", "abs", "min", "max", "<", "<=", "==", "!=", ">", ">=", "f64(f32)", "f32",
    "f64(u32)", "f64(i32)", "u32", "dot", "cross", "swizzle", "select",
];

/// Below the least normal number all is 0, and one NaN stands for all.
fn as_soft(v: f64) -> f64 {
    match v {
        v if v.is_nan() => f64::from_bits(0x7ff8_0000_0000_0000),
        v if v.abs() < f64::MIN_POSITIVE => 0.0_f64.copysign(v),
        v => v,
    }
}

fn by_host(k: u32, [a, b]: [f64; 2]) -> [u64; 24] {
    let flag = u64::from;
    let bits = |v: f64| as_soft(v).to_bits();
    let (x, low) = (as_soft(a), a.to_bits() as u32);
    let y = as_soft(b);
    let product = |p: f64, q: f64| as_soft(p * q);
    let dot = as_soft(as_soft(product(x, y) + product(y, x)) + 1.5 * 0.75);
    [
        bits(x + y),
        bits(x - y),
        bits(x * y),
        bits(x / y),
        bits(x.sqrt()),
        (-a).to_bits(),
        a.abs().to_bits(),
        if y < x { b.to_bits() } else { a.to_bits() },
        if x < y { b.to_bits() } else { a.to_bits() },
        flag(x < y),
        flag(x <= y),
        flag(x == y),
        flag(x != y),
        flag(x > y),
        flag(x >= y),
        bits(f64::from(f32::from_bits(low))),
        u64::from((x as f32).to_bits()),
        bits(f64::from(low)),
        bits(f64::from(low as i32)),
        if x.abs() < 4e9 { u64::from(x as u32) } else { 0 },
        bits(dot),
        bits(2.0 - as_soft(product(x, x) - product(y, y))),
        if k & 1 == 0 { a.to_bits() } else { 3.0_f64.to_bits() },
        if x < y && y < x { b.to_bits() } else { a.to_bits() },
    ]
}

/// Numbers of every kind: any bits, those near each other, near powers of two, near the ends of f32's and f64's range, and the few
/// that are special.
fn pairs() -> Vec<[f64; 2]> {
    const SPECIAL: [f64; 14] = [
        0.0,
        -0.0,
        1.0,
        -1.0,
        f64::INFINITY,
        f64::NEG_INFINITY,
        f64::NAN,
        f64::MAX,
        f64::MIN_POSITIVE,
        1e-320,
        4294967295.0,
        4294967296.0,
        3.4028235677973366e38,
        1.401298464324817e-45,
    ];
    let mut rng = Rng(6);
    let mut list: Vec<[f64; 2]> = SPECIAL.iter().flat_map(|&a| SPECIAL.map(|b| [a, b])).collect();
    for k in 0..50_000 {
        let (a, b) = (f64::from_bits(rng.word()), f64::from_bits(rng.word()));
        let near = |a: f64, rng: &mut Rng, ulps: u64| f64::from_bits(a.to_bits() ^ (rng.word() % ulps));
        let ordinary = |rng: &mut Rng| (rng.signed()) * f64::exp2(f64::from(k % 80) - 40.0);
        let (c, d) = (ordinary(&mut rng), ordinary(&mut rng));
        let short = f64::from((c * 1000.0) as f32);
        let end = f64::from_bits(((rng.word() % 64 + 860) << 52) | (rng.word() >> 12));
        list.extend([
            [a, b],
            [c, d],
            [c, near(c, &mut rng, 8)],
            [c, -near(c, &mut rng, 1 << 40)],
            [short, 1.0 + f64::EPSILON * f64::from(k)],
            [end, SPECIAL[k as usize % SPECIAL.len()]],
            [c.round(), d.round() + 0.5],
            [c * c, d],
        ]);
    }
    list
}

/// What a probe makes of numbers, in so many pairs of words each.
fn run(gpu: &Gpu, source: wgpu::ShaderSource, numbers: &[[f64; 2]], each: usize) -> Vec<u64> {
    let module = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor { label: Some("probe"), source });
    let pipeline = gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some("probe"),
        layout: None,
        module: &module,
        entry_point: Some("probe"),
        compilation_options: Default::default(),
        cache: None,
    });
    let words = |v: f64| [v.to_bits() as u32, (v.to_bits() >> 32) as u32];
    let given: Vec<[[u32; 2]; 2]> = numbers.iter().map(|p| p.map(words)).collect();
    let mut buffers = Buffers::default();
    buffers.upload(gpu, "given", &given).unwrap();
    buffers.upload(gpu, "found", &vec![[u32::MAX; 2]; each * numbers.len()]).unwrap();
    let of = |name: &str| buffers.get(name).expect("a buffer of that name");
    let entry = |binding, name| wgpu::BindGroupEntry { binding, resource: of(name).as_entire_binding() };
    let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("probe"),
        layout: &pipeline.get_bind_group_layout(0),
        entries: &[entry(0, "given"), entry(1, "found")],
    });
    let back = readback(gpu, of("found").size());
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    {
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.dispatch_workgroups(numbers.len().div_ceil(64) as u32, 1, 1);
    }
    encoder.copy_buffer_to_buffer(of("found"), 0, &back, 0, of("found").size());
    gpu.queue.submit([encoder.finish()]);
    let found = read_words(gpu, &back).unwrap();
    found.chunks_exact(2).take(each * numbers.len()).map(|w| u64::from(w[0]) | (u64::from(w[1]) << 32)).collect()
}

fn soft(source: &str) -> wgpu::ShaderSource<'static> {
    wgpu::ShaderSource::Naga(std::borrow::Cow::Owned(lowered(source).unwrap()))
}

const REAL: &str = include_str!("../wgsl/arithmetic/f64.wgsl");

#[test]
fn every_operation_gives_the_hosts_number() {
    let Some(gpu) = adapter() else { return };
    let pairs = pairs();
    let found = run(&gpu, soft(&[REAL, PROBE].concat()), &pairs, NAMES.len());
    for (k, (pair, row)) in pairs.iter().zip(found.chunks_exact(NAMES.len())).enumerate() {
        for ((name, host), soft) in NAMES.iter().zip(by_host(k as u32, *pair)).zip(row) {
            // f32's NaN keeps a sign that says nothing
            let both_nan = *name == "f32" && [host, *soft].iter().all(|v| f32::from_bits(*v as u32).is_nan());
            assert!(both_nan || host == *soft, "{name} of {pair:?}: {soft:#x}, the host's {host:#x}");
        }
    }
}

/// Vectors and arrays in structs, indexed by what is known when the kernel runs; switches; loops that end early.
const SHAPES: &str = "
@group(0) @binding(0) var<storage, read> given: array<vec4<u32>>;
@group(0) @binding(1) var<storage, read_write> found: array<array<vec2<u32>, 7>>;

struct Corners {
    v: array<vec3<f64>, 3>,
    n: vec3<f64>,
}

fn around(q: Corners, at: vec3<f64>, direction: vec3<f64>) -> f64 {
    var total = f64(0.0);
    for (var k = 0u; k < 3u; k++) {
        let e = q.v[(k + 1u) % 3u] - q.v[k];
        total += dot(e, cross(direction, q.v[k] - at));
    }
    return total;
}

fn bernstein(m: u32, t: f64) -> vec4<f64> {
    let s = 1.0 - t;
    switch m {
        case 0u: { return vec4<f64>(1.0, 0.0, 0.0, 0.0); }
        case 1u: { return vec4<f64>(s, t, 0.0, 0.0); }
        case 2u: { return vec4<f64>(s * s, 2.0 * s * t, t * t, 0.0); }
        default: { return vec4<f64>(s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t); }
    }
}

fn sorted(a: f64, b: f64) -> array<f64, 2> {
    if a < b {
        return array<f64, 2>(a, b);
    }
    return array<f64, 2>(b, a);
}

fn root(a: f64) -> f64 {
    var lo = f64(0.0);
    var hi = max(a, f64(1.0));
    var t = 0.5 * (lo + hi);
    for (var k = 0u; k < 64u; k++) {
        let value = t * t - a;
        if (value < 0.0) == true {
            lo = t;
        } else {
            hi = t;
        }
        let slope = t + t;
        var next = t - value / slope;
        if slope == 0.0 || !(next > lo && next < hi) {
            next = 0.5 * (lo + hi);
        }
        let done = value == 0.0 || abs(next - t) <= 1e-12;
        t = select(next, t, value == 0.0);
        if done {
            break;
        }
    }
    return t;
}

@compute @workgroup_size(64)
fn probe(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= arrayLength(&given) {
        return;
    }
    let a = real_from_bits(given[id.x].xy);
    let b = real_from_bits(given[id.x].zw);
    var q = Corners(array<vec3<f64>, 3>(vec3<f64>(a, b, 1.0), vec3<f64>(b, a, 2.0), vec3<f64>(1.0)), vec3<f64>(a));
    q.v[id.x % 3u] = q.v[0] + vec3<f64>(b);
    let w = bernstein(id.x % 4u, a);
    var each = vec3<f64>(a, b, 3.0) * vec3<f64>(b, a, 0.1) / vec3<f64>(3.0, b, a);
    // f32 comes from bits and goes into bits: a driver may optimize away a conversion to f32 and back
    each = 0.5 * (each + q.n) - vec3<f64>(vec3<f32>(0.3, bitcast<vec2<f32>>(given[id.x].yw)));
    let ends = sorted(a, b);
    found[id.x] = array<vec2<u32>, 7>(
        real_to_bits(around(q, q.n, vec3<f64>(b, 1.0, a))), real_to_bits(w.x + b * w.y + w.z * a + w.w),
        real_to_bits(select(ends[min(id.x, 1u)], b, id.x % 2u == 0u)), real_to_bits(root(abs(a))),
        real_to_bits(dot(bernstein(3u, b), vec4<f64>(a, b, 0.5, -1.0))), real_to_bits(each[id.x % 3u]),
        bitcast<vec2<u32>>(vec2<f32>(q.v[id.x % 3u].yx)),
    );
}
";

#[test]
fn every_shape_gives_the_numbers_of_the_adapters_own_f64() {
    let Some(gpu) = adapter() else { return };
    if !gpu.has.f64 || gpu.info.device_type != wgpu::DeviceType::Cpu {
        return skip("no software adapter with f64");
    }
    let mut rng = Rng(7);
    let numbers: Vec<[f64; 2]> = (0..4096).map(|_| [rng.signed(), 3.0 * rng.signed()]).collect();
    let source = [REAL, SHAPES].concat();
    let own = run(&gpu, wgpu::ShaderSource::Wgsl(source.clone().into()), &numbers, 7);
    let soft = run(&gpu, soft(&source), &numbers, 7);
    for (k, (own, soft)) in own.iter().zip(&soft).enumerate() {
        assert!(own == soft, "part {} of {:?}: {soft:#x}, the adapter's {own:#x}", k % 7, numbers[k / 7]);
    }
}
