//! gather: the kernel against its twin, from the same bytes.

use crate::common::needs::adapter;
use crate::common::rng::Rng;
use anamorph::internals::engine::stage;
use anamorph::internals::engine::stage::Stages;
use anamorph::internals::gpu::Gpu;
use anamorph::internals::gpu::buffers::Buffers;
use anamorph::internals::gpu::kernels::{OpticsKind, OpticsModel, Variant};
use anamorph::internals::gpu::layout::{NONE, Optic, Params, PathState, Receiver, ReceiverTriangle};
use anamorph::internals::gpu::readback::{read_words, readback};
use anamorph::internals::image::frame::Channel;
use anamorph_lab::twin::gather::{gather, place, units};
use bytemuck::Zeroable;
use glam::DVec2;

const WIDTH: u32 = 90;
const HEIGHT: u32 = 41;
const PIXELS: usize = (WIDTH * HEIGHT) as usize;
const TRIANGLES: usize = 50;
const ID_BITS: u32 = 7;
const PLANES: [Channel; 5] = [Channel::R, Channel::G, Channel::B, Channel::BaryU, Channel::BaryV];

/// Everything that the kernel reads.
struct Case {
    visibility: Vec<u32>,
    planes: Vec<u32>,
    receiver_triangle_of: Vec<u32>,
    receiver_triangles: Vec<ReceiverTriangle>,
    receivers: Vec<Receiver>,
    sums: Vec<u32>,
    optic: Optic,
    path_states: Vec<PathState>,
}

fn variant(optics: bool) -> Variant {
    let facets = OpticsModel { kind: OpticsKind::Facets, bounced: false };
    Variant::plain(false, false).with(|v| v.rays.optics = optics.then_some(facets))
}

fn case(rng: &mut Rng) -> Case {
    let sizes = [[17, 9], [1, 1], [40, 60]];
    let mut first = 0;
    let receiver = |[columns, rows]: [u32; 2]| {
        let receiver = Receiver { columns, rows, first, scale: 1e-9 };
        first += columns * rows;
        receiver
    };
    let receivers: Vec<Receiver> = sizes.into_iter().map(receiver).collect();
    let texels = receivers.iter().map(|r| (r.columns * r.rows) as usize).sum::<usize>();
    let sums = (0..6 * texels).map(|k| if k % 2 == 0 { rng.word() as u32 } else { rng.below(3) as u32 }).collect();
    let vector = |rng: &mut Rng, size: f64| [size * rng.signed(), size * rng.signed()].map(|v| v as f32);
    let mut receiver_triangles = Vec::new();
    let mut receiver_triangle_of = vec![NONE; 64];
    for id in (0..TRIANGLES).filter(|id| id % 3 > 0) {
        receiver_triangle_of[id] = receiver_triangles.len() as u32;
        let receiver = rng.below(3);
        let [columns, rows] = sizes[receiver].map(|n| n as f32);
        let middle = [columns * rng.unit() as f32, rows * rng.unit() as f32];
        let (ab, ac) = (vector(rng, f64::from(columns)), vector(rng, f64::from(rows)));
        let diffuse = [rng.unit(), rng.unit(), rng.unit()].map(|c| c as f32);
        receiver_triangles.push(ReceiverTriangle {
            a: middle,
            ab,
            ac,
            receiver: receiver as u32,
            pad0: 0,
            diffuse,
            pad1: 0,
        });
    }
    // the last ids are those of optics
    let key = |rng: &mut Rng| match rng.below(10) {
        0 => [0, 0],
        _ => [!((rng.word() as u32) << ID_BITS | rng.below(TRIANGLES + 10) as u32), rng.word() as u32],
    };
    let numbers = |rng: &mut Rng| (0..PIXELS).map(|_| (rng.unit() as f32).to_bits()).collect::<Vec<_>>();
    let path_state = |rng: &mut Rng| PathState {
        light: [rng.unit(), rng.unit(), rng.unit()].map(|l| l as f32),
        ..PathState::zeroed()
    };
    Case {
        visibility: (0..PIXELS).flat_map(|_| key(rng)).collect(),
        planes: (0..PLANES.len()).flat_map(|_| numbers(rng)).collect(),
        receiver_triangle_of,
        receiver_triangles,
        receivers,
        sums,
        optic: Optic { first_id: TRIANGLES as u32, ..Optic::zeroed() },
        path_states: (0..PIXELS).map(|_| path_state(rng)).collect(),
    }
}

fn run(gpu: &Gpu, case: &Case, optics: bool) -> Vec<u32> {
    let mut b = Buffers::default();
    let params = Params { width: WIDTH, height: HEIGHT, id_bits: ID_BITS, ..Params::zeroed() };
    b.upload_uniform(gpu, "params", &params).unwrap();
    b.upload_uniform(gpu, "optic", &case.optic).unwrap();
    b.upload(gpu, "paths", &case.path_states).unwrap();
    b.upload(gpu, "visibility", &case.visibility).unwrap();
    b.upload(gpu, "planes", &case.planes).unwrap();
    b.upload(gpu, "receiver_triangle_of", &case.receiver_triangle_of).unwrap();
    b.upload(gpu, "receiver_triangles", &case.receiver_triangles).unwrap();
    b.upload(gpu, "receivers", &case.receivers).unwrap();
    b.upload(gpu, "sums", &case.sums).unwrap();
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    let mut pass = encoder.begin_compute_pass(&Default::default());
    let stages = Stages::new(gpu, variant(optics), &PLANES).unwrap();
    stages.encode(gpu, &mut pass, &[&b], &[stage::gather::gather(PIXELS as u32)], &mut Default::default()).unwrap();
    drop(pass);
    let bytes = 4 * case.planes.len() as u64;
    let list = readback(gpu, bytes);
    encoder.copy_buffer_to_buffer(b.get("planes").unwrap(), 0, &list, 0, bytes);
    gpu.queue.submit([encoder.finish()]);
    let mut words = read_words(gpu, &list).unwrap();
    words.truncate(case.planes.len());
    words
}

/// Pixels and colours that are wrong, and how many had something added.
fn compare(words: &[u32], case: &Case, optics: bool) -> (Vec<String>, usize) {
    let (mut wrong, mut lit) = (Vec::new(), 0);
    if words[3 * PIXELS..] != case.planes[3 * PIXELS..] {
        wrong.push("the weights have changed".into());
    }
    let brightest = (0..case.sums.len() / 6).flat_map(|k| units(&case.sums, k)).fold(0.0, f64::max);
    for pixel in 0..PIXELS {
        let before = |plane: usize| f32::from_bits(case.planes[plane * PIXELS + pixel]);
        let [low, high] = [case.visibility[2 * pixel], case.visibility[2 * pixel + 1]];
        let id = !low & ((1 << ID_BITS) - 1);
        let receiver_triangle =
            case.receiver_triangle_of.get(id as usize).filter(|k| **k != NONE && [low, high] != [0, 0]);
        let (mut known, mut tolerance, mut border) = ([0.0; 3], 0.0, false);
        if let Some(receiver_triangle) = receiver_triangle.map(|k| &case.receiver_triangles[*k as usize]) {
            let receiver = &case.receivers[receiver_triangle.receiver as usize];
            let at = place(receiver_triangle, [before(3), before(4)]);
            known = gather(receiver_triangle, receiver, &case.sums, at);
            // a place of three terms is right to 4 roundings of 2^-24 of their sizes, and light changes by the brightest
            // texel over one at most each way
            let size = [receiver_triangle.a, receiver_triangle.ab, receiver_triangle.ac]
                .iter()
                .flatten()
                .map(|v| f64::from(v.abs()))
                .sum::<f64>();
            let off = 4.0 * size / f64::from(1 << 24);
            tolerance = 2.0 * off * brightest * f64::from(receiver.scale);
            let end = DVec2::new(receiver.columns.into(), receiver.rows.into());
            border = at.abs().min((at - end).abs()).min_element() <= off;
        }
        lit += usize::from(known[0] > 0.0);
        for k in 0..3 {
            let left = if optics { f64::from(case.path_states[pixel].light[k]) } else { 1.0 };
            let sum = f64::from(before(k)) + left * known[k];
            let got = f64::from(f32::from_bits(words[k * PIXELS + pixel]));
            // some ten operations on f32
            if (got - sum).abs() > tolerance + 10.0 * sum / f64::from(1 << 24) && !border {
                wrong.push(format!("pixel {pixel}, colour {k}: {got} for {sum}"));
            }
        }
    }
    (wrong, lit)
}

#[test]
fn the_kernel_adds_what_its_twin_does() {
    let Some(gpu) = adapter() else { return };
    let mut rng = Rng(21);
    for optics in [false, true] {
        let case = case(&mut rng);
        let words = run(&gpu, &case, optics);
        let (wrong, lit) = compare(&words, &case, optics);
        assert!(wrong.is_empty(), "{} are wrong, the first: {}", wrong.len(), wrong[0]);
        assert!(lit > PIXELS / 10, "{lit} pixels show a receiver");
        // and another colour where a channel changes
        let pixel = (0..PIXELS).find(|k| words[*k] != case.planes[*k]).unwrap();
        let mut planted = words.clone();
        planted[pixel] = (f32::from_bits(planted[pixel]) * 1.01).to_bits();
        assert_eq!(compare(&planted, &case, optics).0.len(), 1, "a planted error is seen");
    }
}
