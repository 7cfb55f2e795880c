//! bounce: the kernel against its twin, from the same bytes.

use crate::bounced::{bounces, cases, delicate, variant};
use crate::stages::{Bench, Case, POISON, SPARE, assert_poisoned, read, run, upload};
use anamorph::internals::camera::TILE;
use anamorph::internals::engine::stage;
use anamorph::internals::gpu::kernels::{Kernel, OpticsKind};
use anamorph::internals::gpu::layout::{NONE, split2};
use anamorph_lab::twin::bounce::{Bounced, bounce};
use anamorph_lab::twin::raster::Visibility;
use anamorph_lab::twin::{KernelInputs, Real};

/// Share of bounced rays that may be lost because rounding decides between two directions: total reflection, the
/// rim of a quadric, grazing facets. Measured: none, but in f32 of rays along a wave 0.0009.
const LOST_MAX_F64: f64 = 0.0;
const LOST_MAX_F32: f64 = 0.002;
/// Bounds that nine of ten numbers must not exceed, relative to the largest coordinate. Measured: 3e-13 and 7e-5, of small
/// facets and of a ball seen from six radii away.
const BOUND_TYPICAL_F64: f64 = 1e-12;
const BOUND_TYPICAL_F32: f64 = 2e-4;
/// Factor for tori and waves, where the bound adds the errors of many terms. Measured: 15 and 20.
const BOUND_MARCHED: f64 = 40.0;
/// And for the delicate cases. Measured: 9400, of a ring from 9400 of its radii away, and 2800, of a wire.
const BOUND_DELICATE: f64 = 2e4;
/// Rounding of one f32 operation, relative.
const UNIT: f64 = f32::EPSILON as f64 / 2.0;
/// A stored pair's rounding, relative.
const PAIR: f64 = 1.0 / (1u64 << 48) as f64;
/// A stored pair's second number may be flushed to 0.
const FLUSHED: f64 = f32::MIN_POSITIVE as f64;

/// The path state of a pixel whose ray misses the optics.
const NO_PATH: [u32; 8] = [0, 0, 0, 0, NONE, NONE, 0, 0];

/// What the kernel left.
#[derive(Clone)]
struct Left {
    hi: Vec<u32>,
    lo: Vec<u32>,
    paths: Vec<[u32; 8]>,
}

fn run_kernel(bench: &mut Bench, case: &Case, real: Real, input: &KernelInputs, visibility: &Visibility) -> Left {
    let (gpu, stages) = bench.stages(variant(case, input, real, false), &[]);
    let (w, h) = (input.params.width as usize, input.params.height as usize);
    let numbers = 6 * (w + 1) * (h + 1);
    let mut buffers = upload(gpu, input);
    buffers.upload_uniform(gpu, "optic", &input.optics.unwrap().next.unwrap()).unwrap();
    buffers.upload(gpu, "visibility", &visibility.words).unwrap();
    let tiles = w.div_ceil(TILE as usize) * h.div_ceil(TILE as usize);
    buffers.upload(gpu, "bounced_live", &vec![0u32; 1 + 2 * tiles]).unwrap();
    buffers.upload(gpu, "bounced_hi", &vec![POISON; numbers + SPARE]).unwrap();
    buffers.upload(gpu, "bounced_lo", &vec![POISON; numbers + SPARE]).unwrap();
    buffers.upload(gpu, "bounced_paths", &vec![[POISON; 8]; w * h + SPARE]).unwrap();
    run(gpu, |pass| stages.encode(gpu, pass, &[&buffers], &[stage::bounce::bounce()], &mut Default::default()));
    let words = |name: &str, from: usize| {
        let words = read(gpu, &buffers, name);
        assert_poisoned(&words, from, &format!("{}, {name}", case.name));
        words[..from].to_vec()
    };
    let paths = words("bounced_paths", 8 * w * h);
    let path = |k: usize| [0, 1, 2, 3, 4, 5, 6, 7].map(|i| paths[8 * k + i]);
    Left { hi: words("bounced_hi", numbers), lo: words("bounced_lo", numbers), paths: (0..w * h).map(path).collect() }
}

/// Bounced rays compared with the twin's.
#[derive(Debug, Default)]
struct Compared {
    wrong: Vec<String>,
    bounced: usize,
    lost: usize,
    /// Largest share of its bound that a number is off by; ninth tenth of all bounds over the largest coordinate.
    share: f64,
    bound: f64,
}

fn compare(input: &KernelInputs, left: &Left, twin: &[Option<Bounced>]) -> Compared {
    let (w, h) = (input.params.width as usize, input.params.height as usize);
    let mut seen = Compared::default();
    let (mut bounds, mut size) = (Vec::new(), 1.0_f64);
    for (y, x) in (0..=h).flat_map(|y| (0..=w).map(move |x| (y, x))) {
        let at = 6 * (y * (w + 1) + x);
        let numbers = || (at..at + 6).map(|k| (left.hi[k], left.lo[k]));
        if x == w || y == h {
            if numbers().any(|n| n != (POISON, POISON)) {
                seen.wrong.push(format!("({x}, {y}) is beside the band and was written"));
            }
            continue;
        }
        let path = left.paths[y * w + x];
        let Some(Bounced { ray, path: want, length_error }) = &twin[y * w + x] else {
            if numbers().any(|n| n != (0, 0)) || path != NO_PATH {
                seen.wrong.push(format!("({x}, {y}): a ray although nothing is hit"));
            }
            continue;
        };
        seen.bounced += 1;
        let words: [u32; 8] = bytemuck::cast(*want);
        let length = f64::from(f32::from_bits(path[3])) - f64::from(want.length);
        let known = |w: [u32; 8]| [w[4], w[5], w[6], w[7]];
        // a share's own error, and its rounding, that of three products and of the twin's
        let off = |k: usize| (f64::from(f32::from_bits(path[k])) - f64::from(f32::from_bits(words[k]))).abs();
        let may = |k: usize| (ray.share.e + 8.0 * UNIT) * f64::from(f32::from_bits(words[k]));
        let is_light = |k: usize| off(k) <= may(k);
        if known(path) != known(words) || !(0..3).all(is_light) {
            seen.wrong.push(format!("({x}, {y}): the path {path:x?} for {words:x?}"));
        }
        let exact: Vec<_> = ray.place.0.into_iter().chain(ray.d.0).collect();
        if exact.iter().any(|n| n.e.is_infinite()) {
            seen.lost += 1;
            continue;
        }
        if length.is_nan() || length.abs() > *length_error {
            seen.wrong.push(format!("({x}, {y}): the length off by {length:e}, may {length_error:e}"));
        }
        for (k, ((hi, lo), near)) in numbers().zip(exact).enumerate() {
            let value = f64::from(f32::from_bits(hi)) + f64::from(f32::from_bits(lo));
            let (off, may) = ((value - near.v).abs(), near.e + PAIR * near.v.abs() + FLUSHED);
            // not a number is never right
            if off.is_nan() || off > may {
                seen.wrong.push(format!("({x}, {y}), number {k}: {value} for {}, off {off:e}, may {may:e}", near.v));
            }
            seen.share = seen.share.max(off / may);
            size = size.max(near.v.abs());
            bounds.push(may);
        }
    }
    bounds.sort_by(f64::total_cmp);
    seen.bound = bounds.get(bounds.len() * 9 / 10).copied().unwrap_or(0.0) / size;
    seen
}

#[test]
fn the_kernel_bounces_rays_as_its_twin_does() {
    let Some(mut bench) = Bench::open() else { return };
    let reals: Vec<Real> = bench.variants().into_iter().filter(|v| !v.1).map(|v| v.0).collect();
    let wide = |case: &Case| match case.variant(Real::F64, false).optics() {
        Some(OpticsKind::Torus | OpticsKind::Wave) => BOUND_MARCHED,
        _ => 1.0,
    };
    let f64_alone = |case| (case, reals.iter().copied().filter(|r| *r == Real::F64).collect(), BOUND_DELICATE);
    let plain = cases().into_iter().map(|case| (wide(&case), case)).map(|(wide, case)| (case, reals.clone(), wide));
    for (case, reals, wide) in plain.chain(delicate().into_iter().map(f64_alone)).collect::<Vec<(Case, Vec<_>, _)>>() {
        let tables = case.tables();
        let mut bounced = 0;
        for (band, &real) in (0..tables.plan.bands.len()).flat_map(|b| reals.iter().map(move |r| (b, r))) {
            tables.follow(&case.camera, band, real, |inputs, visibility| {
                let input = &inputs[0];
                if input.optics.is_none_or(|o| o.optic.ends == 1) {
                    return;
                }
                let name = format!("{}, band {band}, after {}, {real:?}", case.name, bounces(input));
                let left = run_kernel(&mut bench, &case, real, input, visibility);
                let seen = compare(input, &left, &bounce(input, visibility, real));
                let (lost, share, bound) = (seen.lost, seen.share, seen.bound);
                println!("{name}: {} bounced, {lost} lost, {share:.3} of bounds, mostly {bound:.1e}", seen.bounced);
                assert!(seen.wrong.is_empty(), "{name}: {} differ, the first: {}", seen.wrong.len(), seen.wrong[0]);
                let (most, typical) = match real {
                    Real::F64 => (LOST_MAX_F64, BOUND_TYPICAL_F64),
                    Real::F32 => (LOST_MAX_F32, BOUND_TYPICAL_F32),
                };
                assert!(lost as f64 <= most * seen.bounced as f64, "{name}: {lost} of {} lost", seen.bounced);
                assert!(bound <= wide * typical, "{name}: a bound of {bound:e}");
                bounced += seen.bounced;
            });
        }
        assert!(bounced > 75 * reals.len(), "{}: {bounced} rays bounced", case.name);
    }
}

/// What the kernel would leave if it were the twin.
fn left_by_twin(input: &KernelInputs, twin: &[Option<Bounced>]) -> Left {
    let (w, h) = (input.params.width as usize, input.params.height as usize);
    let numbers = 6 * (w + 1) * (h + 1);
    let mut left = Left { hi: vec![POISON; numbers], lo: vec![POISON; numbers], paths: vec![NO_PATH; w * h] };
    for (pixel, bounced) in twin.iter().enumerate() {
        let at = 6 * (pixel / w * (w + 1) + pixel % w);
        let values = bounced.map_or([0.0; 6], |b| {
            let [p, d] = [b.ray.place, b.ray.d].map(|v| v.value());
            [p.x, p.y, p.z, d.x, d.y, d.z]
        });
        for (k, [hi, lo]) in values.map(split2).into_iter().enumerate() {
            (left.hi[at + k], left.lo[at + k]) = (hi.to_bits(), lo.to_bits());
        }
        if let Some(b) = bounced {
            left.paths[pixel] = bytemuck::cast(b.path);
        }
    }
    left
}

#[test]
fn the_comparison_sees_planted_errors() {
    for case in cases().into_iter().take(4) {
        let tables = case.tables();
        tables.follow(&case.camera, 0, Real::F64, |inputs, visibility| {
            let input = &inputs[0];
            if input.optics.is_none_or(|o| o.optic.ends == 1) {
                return;
            }
            let twin = bounce(input, visibility, Real::F64);
            let right = left_by_twin(input, &twin);
            assert!(compare(input, &right, &twin).wrong.is_empty(), "{}", case.name);
            let w = input.params.width as usize;
            let Some(hit) = twin.iter().position(Option::is_some) else { return };
            let miss = twin.iter().position(Option::is_none).unwrap();
            let at = |pixel: usize| 6 * (pixel / w * (w + 1) + pixel % w);
            let found = |what: &str, change: &dyn Fn(&mut Left)| {
                let mut left = right.clone();
                change(&mut left);
                let wrong = compare(input, &left, &twin).wrong;
                assert_eq!(wrong.len(), 1, "{}, {what}: {wrong:?}", case.name);
            };
            for k in 0..6 {
                found("a last bit", &|l| l.hi[at(hit) + k] ^= 1);
                found("no number", &|l| l.hi[at(hit) + k] = f32::NAN.to_bits());
            }
            let far = (0..6).max_by_key(|k| right.lo[at(hit) + k] & 0x7fff_ffff).unwrap();
            found("no second number", &|l| l.lo[at(hit) + far] = 0);
            found("a ray from nowhere", &|l| l.hi[at(miss) + 3] = 1.0_f32.to_bits());
            found("a path from nowhere", &|l| l.paths[miss][0] = 1);
            found("beside the band", &|l| l.hi[6 * w] = 0);
            for k in [4, 5, 6] {
                found("another path", &|l| l.paths[hit][k] ^= 1);
            }
            for k in 0..3 {
                found("less light", &|l| l.paths[hit][k] -= 64);
            }
            found("a longer path", &|l| {
                l.paths[hit][3] = (f32::from_bits(l.paths[hit][3]) * (1.0 + 8.0 * f32::EPSILON)).to_bits();
            });
        });
    }
}

#[test]
fn the_kernel_has_the_rule_s_constant() {
    let case = cases().into_iter().next().unwrap();
    let source = Kernel::new("bounce.wgsl", case.variant(Real::F64, false), &[]).source();
    assert!(
        source.contains(&format!("const FLAT_LEAST: real = {:?};", anamorph::internals::camera::optics::FLAT_LEAST))
    );
}

/// Computed by hand: a ray straight down on a mirror in the plane y = 0, and one that enters glass there at 45 degrees.
#[test]
fn the_twin_bounces_rays_by_the_law() {
    use anamorph::internals::gpu::layout::{Corner, LAW_NORMALS, Optic};
    use anamorph_lab::twin::bounded::Bounded3;
    use anamorph_lab::twin::refract::{BoundedRay, at_facet};
    let real = Real::F64;
    let v = |v: [f32; 3]| Bounded3::pair(v, [0.0; 3], real);
    let corner = |p_hi: [f32; 3]| Corner { p_hi, n_hi: [0.0, 1.0, 0.0], ..bytemuck::Zeroable::zeroed() };
    let corners = [corner([0.0; 3]), corner([0.0, 0.0, 4.0]), corner([4.0, 0.0, 0.0])];
    let mirror = Optic { law: LAW_NORMALS, ..bytemuck::Zeroable::zeroed() };
    let down = at_facet(&mirror, &corners, &BoundedRay { p: v([1.0, 2.0, 1.5]), d: v([0.0, -3.0, 0.0]) }, real);
    assert!((down.place.value() - glam::DVec3::new(1.0, 0.0, 1.5)).length() < 1e-15);
    assert!((down.d.value() - glam::DVec3::Y).length() < 1e-15);
    let glass = Optic { ior_hi: 1.5, ..mirror };
    let slanted = at_facet(&glass, &corners, &BoundedRay { p: v([0.0, 1.0, 1.0]), d: v([1.0, -1.0, 0.0]) }, real);
    let sine = 0.5_f64.sqrt() / 1.5;
    assert!((slanted.d.value() - glam::DVec3::new(sine, -(1.0 - sine * sine).sqrt(), 0.0)).length() < 1e-15);
    // from inside it does not come out at 45 degrees
    let back = at_facet(&glass, &corners, &BoundedRay { p: v([0.0, -1.0, 1.0]), d: v([1.0, 1.0, 0.0]) }, real);
    let half = 0.5_f64.sqrt();
    assert!((back.d.value() - glam::DVec3::new(half, -half, 0.0)).length() < 1e-15);
}
