//! raster and recheck: the kernels against their twin, from the same bytes.

use crate::common::rng::Rng;
use crate::stages::{
    Bench, Case, POISON, SPARE, assert_poisoned, cases, counters, list, random_case, read, run, seeds, upload,
};
use anamorph::internals::camera::TILE;
use anamorph::internals::engine::stage;
use anamorph::internals::engine::stage::raster::raster_steps;
use anamorph::internals::engine::stage::recheck::recheck;
use anamorph::internals::gpu::Gpu;
use anamorph::internals::gpu::buffers::Buffers;
use anamorph::internals::gpu::kernels::{TilePath, Variant};
use anamorph::internals::gpu::layout::{COUNTERS, Counter, Params};
use anamorph_lab::twin::bin::{Pair, bin};
use anamorph_lab::twin::cull::{Bound, cull};
use anamorph_lab::twin::raster::{Tested, Visibility, raster, test};
use anamorph_lab::twin::rays::Cast;
use anamorph_lab::twin::{KernelInputs, Real};

/// Share of pixels that may be excused because the twin's own bound leaves them undecided.
/// Measured: 0.0006 in f32, none in f64.
const EXCUSED_MAX_F32: f64 = 0.002;
const EXCUSED_MAX_F64: f64 = 0.0;
/// In f32 where the rays of every ninth pixel meet a vertex, and a pinhole's those of seven in nine a vertex or an edge: which of the
/// triangles there has a ray is f32's rounding to say.
const EXCUSED_ON_RAYS_MAX_F32: f64 = 7.0 / 9.0;
/// t of the same triangle, from keys whose ids leave at least 42 bits of it (2e-13), and f64 rounding of triangles seen
/// up to a thousandfold edge-on.
const T_RELATIVE_F64: f64 = 1e-12;

/// What the kernel left.
struct Drawn {
    words: Vec<[u32; 2]>,
    tested: u32,
    kept: u32,
    rechecked: u32,
}

/// One input's pairs.
pub type Job<'a> = (KernelInputs<'a>, Vec<[u32; 2]>);

/// Pairs by tile, as sort leaves them; how many tiles are busy.
fn sorted(gpu: &Gpu, buffers: &mut Buffers, input: &KernelInputs, pairs: &[[u32; 2]]) -> u32 {
    let mut sorted = pairs.to_vec();
    sorted.sort_by_key(|pair| Pair::unpack(*pair).tile);
    let tiles = 0..input.tile_start.len() as u32 - 1;
    let before = |tile: u32| sorted.partition_point(|pair| Pair::unpack(*pair).tile < tile) as u32;
    let starts: Vec<u32> = tiles.clone().map(before).collect();
    let ends: Vec<u32> = tiles.clone().map(|tile| before(tile + 1)).collect();
    let busy: Vec<u32> = tiles.filter(|tile| starts[*tile as usize] < ends[*tile as usize]).collect();
    list(gpu, buffers, "pairs", &sorted, sorted.len());
    buffers.upload(gpu, "starts", &starts).unwrap();
    buffers.upload(gpu, "ends", &ends).unwrap();
    buffers.upload(gpu, "busy", &busy).unwrap();
    busy.len() as u32
}

/// How raster goes over pairs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum By {
    Pair,
    /// With t in f64.
    Tile,
    /// With bounds on t, which recheck finds.
    BoundedTile,
}

/// Arithmetic, 64-bit atomics, and how raster goes.
type Mode = (Real, bool, By);

/// All that the adapter can run.
fn modes(bench: &Bench, variant: impl Fn(Real, bool) -> Variant) -> Vec<Mode> {
    let mut all: Vec<Mode> =
        bench.variants().into_iter().map(|(real, atomics64)| (real, atomics64, By::Pair)).collect();
    if bench.gpu.has.lanes && variant(Real::F64, true).with_tiles(TilePath::EXACT).by_tile() {
        let has = |atomics64: bool| bench.variants().contains(&(Real::F64, atomics64));
        all.extend(has(true).then_some((Real::F64, true, By::Tile)));
        all.extend([false, true].into_iter().filter(|&a| has(a)).map(|a| (Real::F64, a, By::BoundedTile)));
    }
    all
}

/// Draws the jobs of one band into one buffer, as the engine does: every job in each step.
fn run_kernel(bench: &mut Bench, case: &Case, (real, atomics64, by): Mode, jobs: &[Job]) -> Drawn {
    let by_tile = by != By::Pair;
    let by_pair = crate::bounced::variant(case, &jobs[0].0, real, atomics64);
    let variant = match by {
        By::Pair => by_pair,
        By::Tile => by_pair.with_tiles(TilePath::EXACT),
        By::BoundedTile => by_pair.with_tiles(TilePath::BOUNDED),
    };
    let (gpu, stages) = bench.stages(variant, &[]);
    let owned = [
        Counter::FragmentsTested.index(),
        Counter::FragmentsKept.index(),
        Counter::RecheckItems.index(),
        Counter::PairsKept.index(),
        Counter::Proven.index(),
    ];
    let pixels = (jobs[0].0.params.width * jobs[0].0.params.height) as usize;
    let mut visibility = vec![[0u32; 2]; pixels];
    visibility.resize(pixels + SPARE, [POISON; 2]);
    let mut shared = Buffers::default();
    shared.upload(gpu, "visibility", &visibility).unwrap();
    let mut sums = [0; 5];
    for step in 0..raster_steps(stages.variant) {
        for (input, pairs) in jobs {
            let mut buffers = upload(gpu, input);
            list(gpu, &mut buffers, "pairs", pairs, pairs.len());
            let capacity = input.params.recheck_capacity as usize;
            list(gpu, &mut buffers, "recheck_items", &[], capacity);
            let zeros = owned.map(|k| (k, 0));
            let mut given = [&zeros[..], &[(Counter::Pairs.index(), pairs.len() as u32)]].concat();
            if by_tile {
                let busy = sorted(gpu, &mut buffers, input, pairs);
                given.extend([
                    (Counter::Busy.index(), busy),
                    (Counter::BusyFirst.index(), 0),
                    (Counter::BusyEnd.index(), 0),
                ]);
            }
            counters(gpu, &mut buffers, &given);
            run(gpu, |pass| {
                let rechecked = stages.variant.rechecks().then(|| recheck(step));
                let dispatches: Vec<_> =
                    stage::raster::raster(stages.variant, step, 1).into_iter().chain(rechecked).collect();
                stages.encode(gpu, pass, &[&buffers, &shared], &dispatches, &mut Default::default())
            });
            assert_poisoned(
                &read(gpu, &buffers, "recheck_items"),
                2 * capacity,
                &format!("{}, recheck_items", case.name),
            );
            let counters = read(gpu, &buffers, "counters");
            for (k, &value) in counters.iter().take(COUNTERS as usize).enumerate() {
                let is_given = given.iter().any(|g| g.0 == k as u32);
                assert!(is_given || value == POISON, "{}: counter {k} is {value}", case.name);
            }
            // the second step counts nothing again, or all
            if step > 0 && by == By::BoundedTile {
                continue;
            }
            sums.iter_mut().zip(owned).for_each(|(sum, k)| *sum += counters[k as usize]);
        }
    }
    let words = read(gpu, &shared, "visibility");
    assert_poisoned(&words, 2 * pixels, &format!("{}, visibility", case.name));
    let words = words.chunks_exact(2).take(pixels).map(|w| [w[0], w[1]]).collect();
    Drawn { words, tested: sums[0], kept: sums[1], rechecked: sums[2] - sums[4] }
}

/// How a visibility buffer stands against the twin's.
#[derive(Debug, Default)]
pub struct Compared {
    pub wrong: Vec<String>,
    /// Pixels that differ where the twin's own signs are within rounding, or two hits closer than their ts are known.
    excused: usize,
    /// Largest difference of t where the ids agree, relative to t, and relative to what it may be.
    t_relative: f64,
    t_share: f64,
}

pub fn compare(jobs: &[Job], real: Real, kernel: &[[u32; 2]], twin: &Visibility) -> Compared {
    let mut seen = Compared::default();
    let keys = jobs[0].0.keys(real);
    for (pixel, words) in kernel.iter().enumerate() {
        let word = u64::from(words[1]) << 32 | u64::from(words[0]);
        let kernel = (word != 0).then_some(!word);
        let twin_key = twin.key(pixel);
        match (kernel, twin_key) {
            (None, None) => {}
            (Some(a), Some(b)) => {
                let (t, twin_t) = (keys.t(a), keys.t(b));
                let [own, other] = [b, a].map(|key| hit(jobs, pixel, (keys.layer(key), keys.id(key)), real));
                let error = |h: &Tested| h.hit.map_or(0.0, |h| h.t_error);
                let may = error(&own) + error(&other) + 2.0 * keys.step() * twin_t.abs();
                let off = (t - twin_t).abs();
                let one = (keys.layer(a), keys.id(a)) == (keys.layer(b), keys.id(b));
                if one {
                    seen.t_relative = seen.t_relative.max(off / twin_t.abs());
                    seen.t_share = seen.t_share.max(off / may);
                }
                let same = one && off <= may;
                if !same {
                    // another hit no farther than the ts are known, or one that rounding may find
                    let close = other.hit.is_some() && off <= may;
                    seen.judge(close || twin.uncertain[pixel], pixel, format!("{a:x} for {b:x}, t {t} for {twin_t}"));
                }
            }
            _ => seen.judge(twin.uncertain[pixel], pixel, format!("{kernel:x?} for {twin_key:x?}")),
        }
    }
    seen
}

impl Compared {
    fn judge(&mut self, excused: bool, pixel: usize, text: String) {
        if excused {
            self.excused += 1;
        } else {
            self.wrong.push(format!("pixel {pixel}: {text}"));
        }
    }
}

/// The twin's test of one triangle at one pixel of a layer.
fn hit(jobs: &[Job], pixel: usize, (layer, id): (u32, u32), real: Real) -> Tested {
    let nothing = Tested { hit: None, uncertain: false };
    let here = |p: &Params| id.wrapping_sub(p.id_first) < p.id_count;
    let Some((input, _)) = jobs.iter().find(|j| here(&j.0.params)) else { return nothing };
    let slot = input.slot_of_id.get(id.wrapping_sub(input.params.id_first) as usize);
    let (x, y) = (pixel as u32 % input.params.width, pixel as u32 / input.params.width);
    let (Some(&slot), Some(cell)) = (slot, input.pixel_cell(layer, x, y)) else { return nothing };
    if slot as usize >= input.triangles.len() {
        return nothing;
    }
    let mut cast = input.cell_cast(&input.cells[cell as usize], (y % TILE) * TILE + x % TILE);
    if let Cast::Curve(curve) = &mut cast {
        curve.span = [0.0, 1.0];
    }
    test(input, &cast, &input.corners(slot), real)
}

/// The twin's pairs, every second with the whole tile to look at; and as many again that mostly cover nothing. In any order.
fn pairs_of(input: &KernelInputs, rng: &mut Rng) -> Vec<[u32; 2]> {
    let work = cull(input, Bound::PLAIN).work;
    let mut pairs: Vec<Pair> = bin(input, &work, Real::F32).iter().map(|b| b.pair()).collect();
    pairs.iter_mut().step_by(2).for_each(|p| (p.from, p.to) = ([0, 0], [7, 7]));
    let listed: std::collections::HashSet<(u32, u32)> = pairs.iter().map(|p| (p.slot, p.tile)).collect();
    for _ in 0..pairs.len().min(2000) {
        let (slot, tile) = (rng.below(input.triangles.len()) as u32, rng.below(input.tile_start.len() - 1) as u32);
        if !listed.contains(&(slot, tile)) {
            pairs.push(Pair { slot, tile, from: [1, 0], to: [6, 7] });
        }
    }
    rng.shuffled(pairs.len()).into_iter().map(|k| pairs[k].pack()).collect()
}

/// The chunks of a band, each with pairs.
fn jobs_of<'a>(band: Vec<KernelInputs<'a>>, rng: &mut Rng) -> Vec<Job<'a>> {
    let job = |mut input: KernelInputs<'a>| {
        let pairs = pairs_of(&input, rng);
        input.params.pair_capacity = pairs.len() as u32;
        // all pixels of each pair
        input.params.recheck_capacity = 64 * pairs.len() as u32;
        (input, pairs)
    };
    band.into_iter().map(job).collect()
}

#[test]
fn the_kernel_draws_what_its_twin_draws() {
    let Some(mut bench) = Bench::open() else { return };
    let mut rng = Rng(77);
    for case in cases().into_iter().chain(seeds().map(random_case)) {
        let variants = modes(&bench, |real, atomics64| case.variant(real, atomics64));
        let tables = case.tables();
        for band in case.bands(&tables) {
            let jobs = jobs_of(band, &mut rng);
            for real in [Real::F64, Real::F32] {
                let mut twin = Visibility::new((jobs[0].0.params.width * jobs[0].0.params.height) as usize);
                jobs.iter().for_each(|(input, pairs)| raster(input, pairs, real, &mut twin));
                for &variant in variants.iter().filter(|v| v.0 == real) {
                    check(&case, &jobs, variant, &run_kernel(&mut bench, &case, variant, &jobs), &twin);
                }
            }
        }
    }
}

/// They meet no facet where they start, and none at all where the optics do not see themselves.
#[test]
#[ignore = "slow: make test-all"]
fn the_kernel_draws_what_bounced_rays_hit() {
    let Some(mut bench) = Bench::open() else { return };
    let mut rng = Rng(78);
    for case in crate::bounced::cases() {
        let tables = case.tables();
        for band in 0..tables.plan.bands.len() {
            tables.follow(&case.camera, band, Real::F64, |inputs, _| {
                if crate::bounced::bounces(&inputs[0]) == 0 {
                    return;
                }
                let jobs = jobs_of(inputs.to_vec(), &mut rng);
                let variants =
                    modes(&bench, |real, atomics64| crate::bounced::variant(&case, &jobs[0].0, real, atomics64));
                for mode in variants {
                    let real = mode.0;
                    let mut twin = Visibility::new((jobs[0].0.params.width * jobs[0].0.params.height) as usize);
                    jobs.iter().for_each(|(input, pairs)| raster(input, pairs, real, &mut twin));
                    let drawn = run_kernel(&mut bench, &case, mode, &jobs);
                    check(&case, &jobs, mode, &drawn, &twin);
                }
            });
        }
    }
}

/// A visibility buffer in f64 is the twin's.
pub fn assert_drawn(name: &str, jobs: &[Job], words: &[[u32; 2]], twin: &Visibility) {
    let seen = assert_alike(name, jobs, Real::F64, words, twin);
    assert!(seen.excused as f64 <= EXCUSED_MAX_F64 * words.len() as f64, "{name}: {} excused", seen.excused);
}

fn assert_alike(name: &str, jobs: &[Job], real: Real, words: &[[u32; 2]], twin: &Visibility) -> Compared {
    let seen = compare(jobs, real, words, twin);
    let (t, share) = (seen.t_relative, seen.t_share);
    println!("{name}: {} excused, t within {t:.1e}, {share:.3} of its bound", seen.excused);
    assert!(seen.wrong.is_empty(), "{name}: {} pixels differ, the first: {}", seen.wrong.len(), seen.wrong[0]);
    seen
}

fn check(case: &Case, jobs: &[Job], (real, atomics64, by): Mode, kernel: &Drawn, twin: &Visibility) {
    let row = jobs[0].0.params.band_row;
    let name =
        format!("{}, row {row}, {} chunks, {real:?}, 64-bit atomics {atomics64}, by {by:?}", case.name, jobs.len());
    let uncertain = twin.uncertain.iter().filter(|d| **d).count();
    println!("{name}: {} hits, {uncertain} uncertain, rechecked {}", twin.kept, kernel.rechecked);
    let seen = assert_alike(&name, jobs, real, &kernel.words, twin);
    let most = match real {
        Real::F64 => EXCUSED_MAX_F64,
        Real::F32 if case.name.starts_with("vertices on rays") => EXCUSED_ON_RAYS_MAX_F32,
        Real::F32 => EXCUSED_MAX_F32,
    };
    // the fewest pixels in which a share means anything
    let pixels = kernel.words.len().max(1000) as f64;
    assert!(seen.excused as f64 <= most * pixels, "{name}: {} excused", seen.excused);
    let ordinary = !case.name.starts_with("seed");
    assert!(
        real == Real::F32 || !ordinary || seen.t_relative <= T_RELATIVE_F64,
        "{name}: t off by {}",
        seen.t_relative
    );
    if by != By::Pair {
        // all pixels of a tile, where its bounds leave the pair
        let most = 64 * jobs.iter().map(|j| j.1.len() as u64).sum::<u64>();
        assert!((u64::from(kernel.kept)..=most).contains(&u64::from(kernel.tested)), "{name}: fragments tested");
    } else {
        assert_eq!(u64::from(kernel.tested), twin.tested, "{name}: fragments tested");
    }
    if by != By::Pair {
        // what lies behind all that is there is left out, and of a discontinuous tile's cells each may have listed a triangle
        let is_once = |(_, pairs): &Job| {
            let places = pairs.iter().map(|p| Pair::unpack(*p)).map(|p| (p.slot, p.tile));
            places.collect::<std::collections::HashSet<_>>().len() == pairs.len()
        };
        let least = kernel.words.iter().filter(|w| **w != [0; 2]).count() as u64;
        let most = if uncertain == 0 && jobs.iter().all(is_once) { twin.kept } else { u64::MAX };
        assert!((least..=most).contains(&u64::from(kernel.kept)), "{name}: fragments kept");
    } else if uncertain == 0 {
        assert_eq!(u64::from(kernel.kept), twin.kept, "{name}: fragments kept");
    }
}

#[test]
fn the_comparison_sees_planted_errors() {
    let case = cases().into_iter().find(|c| c.name == "weighted pieces").expect("a case of that name");
    let tables = case.tables();
    let jobs = jobs_of(case.bands(&tables).swap_remove(0), &mut Rng(3));
    let (input, pairs) = &jobs[0];
    let mut twin = Visibility::new((input.params.width * input.params.height) as usize);
    raster(input, pairs, Real::F64, &mut twin);
    let right = twin.words.clone();
    assert!(compare(&jobs, Real::F64, &right, &twin).wrong.is_empty());
    let hit = right.iter().position(|w| *w != [0; 2]).unwrap();
    let miss = right.iter().position(|w| *w == [0; 2]).unwrap();
    let other = right.iter().find(|w| w[0] & 0xff != right[hit][0] & 0xff && **w != [0; 2]).unwrap();
    let step = 1 << (input.params.id_bits + 8);
    for (pixel, word) in [
        (hit, [0; 2]),
        (miss, right[hit]),
        (hit, *other),
        // t off by 256 steps of its last kept bit, some 1e-10 of itself
        (hit, [right[hit][0] ^ step, right[hit][1]]),
        (hit, [right[hit][0] ^ 1, right[hit][1]]),
    ] {
        let mut words = right.clone();
        words[pixel] = word;
        assert_eq!(compare(&jobs, Real::F64, &words, &twin).wrong.len(), 1, "pixel {pixel} as {word:x?}");
    }
}
