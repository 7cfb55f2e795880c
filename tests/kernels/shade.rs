//! shade: the kernel against its twin, from the same bytes.

use crate::common::rng::Rng;
use crate::stages::{
    Bench, Case, POISON, SPARE, assert_poisoned, cases, pixels, random_case, read, run, seeds, upload,
};
use anamorph::internals::engine::pages::PageStore;
use anamorph::internals::engine::stage;
use anamorph::internals::geometry::mesh::NO_UV;
use anamorph::internals::gpu::kernels::Textures;
use anamorph::internals::image::frame::Channel;
use anamorph_lab::twin::bin::bin;
use anamorph_lab::twin::cull::{Bound, cull};
use anamorph_lab::twin::raster::{Visibility, raster};
use anamorph_lab::twin::shade::{Pixel, shade};
use anamorph_lab::twin::{KernelInputs, Real};
use glam::Vec2;
use std::collections::BTreeSet;

/// Colour agrees this well in f32 where nothing is ill-conditioned: some 80 roundings of 2^-24. The twin's own bound is
/// wider where a triangle is small beside its distance from the anchor.
const COLOUR_TYPICAL: f64 = 1e-5;
/// Weights agree to this where they come from f64.
const WEIGHT_TYPICAL: f64 = 1e-6;
/// Z in units of 2^-23 where directions do not cancel: t, |D| and their product, 2 to 3 roundings each.
const Z_TYPICAL_ULP: f64 = 4.0;
/// All that `shade` writes.
fn all() -> Vec<Channel> {
    Channel::every().filter(|c| *c != Channel::Certified && c.is_rendered()).collect()
}

/// Share of hits whose face or normal towards the viewer is not certain, so that colour is not compared.
const EDGE_ON_MAX: f64 = 0.01;
/// Share of compared colours that may exceed [`COLOUR_TYPICAL`].
const ILL_CONDITIONED_MAX: f64 = 0.05;

fn run_kernel(
    bench: &mut Bench,
    case: &Case,
    real: Real,
    input: &KernelInputs,
    visibility: &Visibility,
    planes: &[Channel],
) -> Vec<u32> {
    let textured = !input.uvs.is_empty();
    let variant = crate::bounced::variant(case, input, real, false)
        .with(|v| v.appearance.textures = textured.then(Textures::default));
    let (gpu, stages) = bench.stages(variant, planes);
    let mut buffers = upload(gpu, input);
    if textured {
        // no material has an image
        PageStore::default().place(gpu, &[], &mut buffers).unwrap();
    }
    buffers.upload(gpu, "visibility", &visibility.words).unwrap();
    let words = visibility.words.len() * planes.len();
    let start = planes.iter().flat_map(|&c| vec![before(c, input); visibility.words.len()]);
    buffers.upload(gpu, "planes", &start.chain(vec![POISON; SPARE]).collect::<Vec<_>>()).unwrap();
    run(gpu, |pass| {
        stages.encode(gpu, pass, &[&buffers], &[stage::shade::shade(pixels(input))], &mut Default::default())
    });
    let out = read(gpu, &buffers, "planes");
    assert_poisoned(&out, words, &format!("{}, planes", case.name));
    out[..words].to_vec()
}

/// What a plane holds before: with optics light is added to colours, which start at 0.
fn before(channel: Channel, input: &KernelInputs) -> u32 {
    let is_colour = matches!(channel, Channel::R | Channel::G | Channel::B);
    if is_colour && input.optics.is_some() { 0 } else { POISON }
}

/// How planes stand against the twin's pixels.
#[derive(Debug, Default)]
struct Compared {
    wrong: Vec<String>,
    hits: usize,
    edge_on: usize,
    ill_conditioned: usize,
    /// Largest errors: t relative, Z in units of 2^-23, weights and colours as they are.
    t: f64,
    z_ulp: f64,
    weight: f64,
    colour: f64,
    /// Largest errors of t, Z, weights, colours, normals, positions and texture coordinates, relative to their bounds.
    shares: [f64; 7],
    /// All different words of texture coordinates.
    uvs: BTreeSet<u32>,
}

fn compare(words: &[u32], pixels: &[Pixel], planes: &[Channel], input: &KernelInputs) -> Compared {
    let mut seen = Compared::default();
    for (k, pixel) in pixels.iter().enumerate() {
        if let Pixel::Hit(s) = pixel {
            seen.hits += 1;
            seen.edge_on += usize::from(s.error.colour[0].is_infinite());
        }
        let mut ill = false;
        for (plane, &channel) in planes.iter().enumerate() {
            let got = words[plane * pixels.len() + k];
            let want = pixel.word(channel).unwrap_or(before(channel, input));
            let value = f64::from(f32::from_bits(got));
            let bounded = match pixel {
                Pixel::Hit(s) => s.values.number(channel).zip(s.error.number(channel).filter(|most| *most > 0.0)),
                _ => None,
            };
            // ids, numbers that are known exactly, misses and pixels of other chunks: the very word
            let Some((exact, most)) = bounded else {
                if got != want {
                    seen.wrong.push(format!("pixel {k}, {channel:?}: {got:x} for {want:x}"));
                }
                continue;
            };
            let off = (value - exact).abs();
            // not a number is never right
            if off.is_nan() || off > most {
                seen.wrong.push(format!("pixel {k}, {channel:?}: {value} for {exact}, off {off:e}, may {most:e}"));
            }
            if most.is_infinite() {
                continue;
            }
            let kind = match channel {
                Channel::T => 0,
                Channel::Z => 1,
                Channel::BaryU | Channel::BaryV => 2,
                Channel::R | Channel::G | Channel::B => 3,
                Channel::NormalX | Channel::NormalY | Channel::NormalZ => 4,
                Channel::ViewX | Channel::ViewY | Channel::ViewZ => 4,
                Channel::PositionX | Channel::PositionY | Channel::PositionZ => 5,
                _ => {
                    seen.uvs.insert(got);
                    6
                }
            };
            seen.shares[kind] = seen.shares[kind].max(off / most);
            match channel {
                Channel::T => seen.t = seen.t.max(off / exact.abs()),
                Channel::Z => seen.z_ulp = seen.z_ulp.max(off / exact.abs() / f64::from(f32::EPSILON)),
                Channel::BaryU | Channel::BaryV => seen.weight = seen.weight.max(off),
                Channel::R | Channel::G | Channel::B => {
                    seen.colour = seen.colour.max(off);
                    ill |= off > COLOUR_TYPICAL;
                }
                _ => {}
            }
        }
        seen.ill_conditioned += usize::from(ill);
    }
    seen
}

/// The visibility buffer of a band, all chunks drawn, in each arithmetic.
fn visibility_of(band: &[KernelInputs], reals: &[Real]) -> Vec<Visibility> {
    let pairs_of = |chunk: &KernelInputs| -> Vec<[u32; 2]> {
        let work = cull(chunk, Bound::PLAIN).work;
        bin(chunk, &work, Real::F32).iter().map(|b| b.pair().pack()).collect()
    };
    let pairs: Vec<Vec<[u32; 2]>> = band.iter().map(pairs_of).collect();
    let drawn = |&real: &Real| {
        let mut visibility = Visibility::new((band[0].params.width * band[0].params.height) as usize);
        band.iter().zip(&pairs).for_each(|(chunk, pairs)| raster(chunk, pairs, real, &mut visibility));
        visibility
    };
    reals.iter().map(drawn).collect()
}

#[test]
fn the_kernel_shades_what_its_twin_shades() {
    let Some(mut bench) = Bench::open() else { return };
    let reals: Vec<Real> = bench.variants().into_iter().filter(|v| !v.1).map(|v| v.0).collect();
    for case in cases().into_iter().chain(seeds().map(random_case)) {
        let tables = case.tables();
        let mut hits = 0;
        for band in case.bands(&tables) {
            for (visibility, &real) in visibility_of(&band, &reals).iter().zip(&reals) {
                for input in &band {
                    hits += check(&mut bench, &case, input, visibility, real);
                }
            }
        }
        assert!(hits > 0 || case.name.starts_with("seed"), "{}: nothing is seen", case.name);
    }
}

#[test]
fn the_kernel_shades_what_optics_show() {
    let Some(mut bench) = Bench::open() else { return };
    let reals: Vec<Real> = bench.variants().into_iter().filter(|v| !v.1).map(|v| v.0).collect();
    for case in crate::bounced::cases() {
        let tables = case.tables();
        for (band, &real) in (0..tables.plan.bands.len()).flat_map(|b| reals.iter().map(move |r| (b, r))) {
            tables.follow(&case.camera, band, real, |inputs, visibility| {
                for input in inputs {
                    check(&mut bench, &case, input, visibility, real);
                }
            });
        }
    }
}

/// Cases of every kind of rays, with texture coordinates: every corner has its own, and every ninth triangle has none.
fn mapped() -> impl Iterator<Item = Case> {
    const NAMES: [&str; 7] = [
        "pieces",
        "weighted chain",
        "curves of degree 3, bent by 0.3",
        "ray field",
        "both ways",
        "vertices on rays, pinhole",
        "bands and chunks",
    ];
    let mapped = |mut case: Case| {
        let (mut mesh, mut rng) = ((*case.scene.mesh).clone(), Rng(91));
        let count = mesh.triangles.len() as u32;
        mesh.uvs = (0..3 * count).map(|_| Vec2::new(4.0 * rng.signed() as f32, rng.unit() as f32)).collect();
        mesh.corner_uvs = (0..count).map(|k| [3 * k, 3 * k + 1, if k % 9 == 0 { NO_UV } else { 3 * k + 2 }]).collect();
        case.scene.mesh = mesh.into();
        case
    };
    let all = cases().into_iter().filter(|c| NAMES.contains(&c.name.as_str()));
    let all: Vec<Case> = all.map(mapped).collect();
    assert_eq!(all.len(), NAMES.len());
    all.into_iter()
}

#[test]
#[ignore = "slow: make test-all"]
fn the_kernel_interpolates_texture_coordinates_as_its_twin_does() {
    let Some(mut bench) = Bench::open() else { return };
    let reals: Vec<Real> = bench.variants().into_iter().filter(|v| !v.1).map(|v| v.0).collect();
    for case in mapped() {
        let tables = case.mapped_tables();
        let (mut uvs, mut hits) = (BTreeSet::new(), 0);
        for band in case.bands(&tables) {
            for (visibility, &real) in visibility_of(&band, &reals).iter().zip(&reals) {
                for input in &band {
                    let seen = compared(&mut bench, &case, input, visibility, real);
                    hits += seen.hits;
                    uvs.extend(seen.uvs);
                }
            }
        }
        // u and v of each hit in one arithmetic, less triangles without any and equal words
        let least = 2 * hits / reals.len() * 3 / 4;
        assert!(hits > 500 && uvs.len() > least, "{}: {} numbers of {hits} hits", case.name, uvs.len());
    }
}

/// Compares the kernel's planes with the twin's; returns the number of pixels that are hits of the chunk.
fn check(bench: &mut Bench, case: &Case, input: &KernelInputs, visibility: &Visibility, real: Real) -> usize {
    compared(bench, case, input, visibility, real).hits
}

fn compared(bench: &mut Bench, case: &Case, input: &KernelInputs, visibility: &Visibility, real: Real) -> Compared {
    let name = format!("{}, row {}, ids from {}, {real:?}", case.name, input.params.band_row, input.params.id_first);
    let words = run_kernel(bench, case, real, input, visibility, &all());
    let pixels = shade(input, visibility, real);
    let seen = compare(&words, &pixels, &all(), input);
    println!(
        "{name}: {} hits, t {:.1e}, Z {:.1} ulp, weights {:.1e}, colour {:.1e}, edge-on {}, ill-conditioned {}, of bounds {:.2?}",
        seen.hits, seen.t, seen.z_ulp, seen.weight, seen.colour, seen.edge_on, seen.ill_conditioned, seen.shares
    );
    assert!(seen.wrong.is_empty(), "{name}: {} words differ, the first: {}", seen.wrong.len(), seen.wrong[0]);
    // what is typical holds of ordinary cameras; random ones have rays that cancel and images a pixel wide
    if case.name.starts_with("seed") {
        return seen;
    }
    let share = |count: usize| count as f64 / seen.hits.max(1) as f64;
    assert!(share(seen.edge_on) <= EDGE_ON_MAX, "{name}: {} edge-on", seen.edge_on);
    assert!(share(seen.ill_conditioned) <= ILL_CONDITIONED_MAX, "{name}: {}", seen.ill_conditioned);
    assert!(real == Real::F32 || seen.weight <= WEIGHT_TYPICAL, "{name}: weights {}", seen.weight);
    assert!(seen.z_ulp <= Z_TYPICAL_ULP, "{name}: Z {} ulp", seen.z_ulp);
    seen
}

#[test]
fn only_the_channels_asked_for_are_written() {
    let Some(mut bench) = Bench::open() else { return };
    let case = cases().into_iter().find(|c| c.name == "pieces").expect("a case of that name");
    let (real, _) = bench.variants()[0];
    let tables = case.tables();
    let band = case.bands(&tables).swap_remove(0);
    let visibility = visibility_of(&band, &[real]).swap_remove(0);
    let pixels = shade(&band[0], &visibility, real);
    for planes in [
        vec![Channel::Z],
        vec![Channel::G, Channel::TriangleId],
        vec![Channel::PieceId, Channel::BaryV],
        vec![Channel::NormalY, Channel::PositionZ, Channel::AlbedoB],
    ] {
        let words = run_kernel(&mut bench, &case, real, &band[0], &visibility, &planes);
        let seen = compare(&words, &pixels, &planes, &band[0]);
        assert!(seen.wrong.is_empty() && seen.hits > 0, "{planes:?}: {:?}", seen.wrong.first());
    }
}

#[test]
fn the_comparison_sees_planted_errors() {
    let case = cases().into_iter().find(|c| c.name == "pieces").expect("a case of that name");
    let tables = case.tables();
    let band = case.bands(&tables).swap_remove(0);
    let visibility = visibility_of(&band, &[Real::F64]).swap_remove(0);
    let pixels = shade(&band[0], &visibility, Real::F64);
    let planes = all();
    let right: Vec<u32> =
        planes.iter().flat_map(|&c| pixels.iter().map(move |p| p.word(c).unwrap_or(POISON))).collect();
    assert_eq!(compare(&right, &pixels, &planes, &band[0]).wrong, Vec::<String>::new());
    let sure = |p: &Pixel| matches!(p, Pixel::Hit(s) if s.error.colour[0] < 1e-3);
    let hit = pixels.iter().position(sure).unwrap();
    let miss = pixels.iter().position(|p| matches!(p, Pixel::Miss(_))).unwrap();
    for (plane, channel) in planes.iter().enumerate() {
        for pixel in [hit, miss] {
            let at = plane * pixels.len() + pixel;
            let off = match channel {
                Channel::TriangleId | Channel::PieceId => right[at] ^ 1,
                _ => (f32::from_bits(right[at]) * 1.01 + 1e-2).to_bits(),
            };
            for wrong in [off, f32::NAN.to_bits(), POISON] {
                // an infinite depth stays so under the factor
                if wrong == right[at] {
                    continue;
                }
                let mut words = right.clone();
                words[at] = wrong;
                let seen = compare(&words, &pixels, &planes, &band[0]);
                assert_eq!(seen.wrong.len(), 1, "{channel:?}, pixel {pixel} as {wrong:x}");
            }
        }
    }
}
