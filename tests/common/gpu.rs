//! The engine on this machine's adapter, and judgement of its frames by the reference.

use super::needs;
use anamorph::internals::camera::{Camera, Rays};
use anamorph::internals::engine::left_out::LeftOut;
use anamorph::internals::engine::plan::Wanted;
use anamorph::internals::engine::{Engine, Rendered, RunOptions};
use anamorph::internals::gpu::Gpu;
use anamorph::internals::image::compare::{Comparison, compare};
use anamorph::internals::image::frame::{Channel, Frame, NO_ID, Plane};
use anamorph::internals::reference::image::{Judgement, judge};
use anamorph::internals::scene::Scene;
use std::sync::{Mutex, MutexGuard, OnceLock};

/// What an engine does without, that this machine's adapter may have.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Without {
    Nothing,
    /// And without subgroups of eight threads: raster goes pair by pair, in two dispatches.
    Int64Atomics,
    F64,
    /// Subgroups of eight threads: raster goes pair by pair.
    Lanes,
    /// Tile by tile, raster bounds t in f32, and recheck finds it.
    F64Depths,
}

type Slot = OnceLock<Option<Mutex<Engine>>>;

/// An engine for each kind of kernels, so that none is compiled twice.
static ENGINES: [Slot; 10] = [const { OnceLock::new() }; 10];

/// An engine whose kernels suit the camera; `None`, as [`needs::no_adapter`] says, where the machine has no adapter.
pub fn engine(camera: &Camera, without: Without) -> Option<MutexGuard<'static, Engine>> {
    let field = matches!(camera.layers[0], Rays::Field(_));
    let less = |gpu: &mut Gpu| {
        gpu.has.f64 &= without != Without::F64;
        gpu.has.atomics64 &= without != Without::Int64Atomics;
        gpu.has.lanes &= !matches!(without, Without::Lanes | Without::Int64Atomics);
        if without == Without::F64Depths {
            (gpu.has.by_pair, gpu.has.software) = (false, false);
        }
    };
    let slot = ENGINES[2 * without as usize + usize::from(field)].get_or_init(|| engine_on(less).map(Mutex::new));
    if slot.is_none() {
        // each test says so
        needs::no_adapter();
    }
    slot.as_ref().map(|e| e.lock().unwrap_or_else(|e| e.into_inner()))
}

/// An engine of its own on an adapter that is made to look smaller; `None` as [`engine`] without one.
pub fn engine_on(less: impl FnOnce(&mut Gpu)) -> Option<Engine> {
    let mut gpu = needs::adapter()?;
    less(&mut gpu);
    Some(Engine::new(gpu))
}

/// Makes the adapter's bindings and tables so small, bytes, that images and meshes are split.
pub fn limit_bindings(gpu: &mut Gpu, bytes: u64) {
    (gpu.limits.max_storage_buffer_binding_size, gpu.table_limit) = (bytes, bytes);
}

/// Asserts that f64 in 32-bit words gives a frame that is right, and the triangles that the adapter's own f64 gives.
pub fn assert_same_without_f64(name: &str, scene: &Scene, camera: &Camera, with_f64: &Frame) -> Option<Rendered> {
    let words_only = render_with(scene, camera, Without::F64, &RunOptions::default())?;
    assert!(words_only.left_out.iter().any(|l| matches!(l, LeftOut::AdapterF64 { .. })));
    assert_right(&format!("{name} without f64"), scene, camera, &words_only.frame);
    // a driver may take f64's sums and products in another order, so that t is off by a rounding
    assert!(ids(&words_only.frame) == ids(with_f64), "{name}: f64 in 32-bit words sees other triangles");
    Some(words_only)
}

/// All channels.
pub fn wanted() -> Wanted {
    Wanted { srgb8: true, ..Wanted::of(Channel::ALL.to_vec()) }
}

pub fn render_with(scene: &Scene, camera: &Camera, without: Without, run: &RunOptions) -> Option<Rendered> {
    let mut engine = engine(camera, without)?;
    Some(engine.render(scene, camera, &wanted(), run).unwrap())
}

/// All channels of the scene by the engine; `None` without an adapter.
pub fn render(scene: &Scene, camera: &Camera) -> Option<Frame> {
    render_with(scene, camera, Without::Nothing, &RunOptions::default()).map(|r| r.frame)
}

/// The triangle ids of a frame.
pub fn ids(frame: &Frame) -> &[u32] {
    frame.u32(Channel::TriangleId).unwrap()
}

/// Pixels of the frame that hit something.
pub fn hits(frame: &Frame) -> usize {
    ids(frame).iter().filter(|&&id| id != NO_ID).count()
}

/// Every plane as words, so that frames compare by their bytes.
pub fn words(frame: &Frame) -> Vec<u32> {
    let word = |p: &Plane| match p {
        Plane::F32(v) => v.iter().map(|x| x.to_bits()).collect::<Vec<_>>(),
        Plane::U32(v) => v.clone(),
    };
    frame.planes.iter().flat_map(|(_, p)| word(p)).collect()
}

/// Largest relative error of t at the 99.9th of a hundred pixels: t is worked out in f64 from positions stored to
/// 2^-48 and written as f32 (2^-24); the rest is margin for surfaces seen edge-on, where t is ill-conditioned.
const T_ERROR: f64 = 1e-5;

/// Asserts that the frame is right by margin: every safe pixel has the reference's triangle, every other one a near
/// candidate's.
pub fn assert_right(name: &str, scene: &Scene, camera: &Camera, frame: &Frame) -> (Judgement, Comparison) {
    let judged = judge(scene, camera, frame);
    let seen = compare(frame, &judged.truth, Some(&judged.safe), Some(&judged.scales)).unwrap();
    println!("{name}: {seen}");
    assert_eq!((seen.wrong_safe, judged.not_near), (Some(0), 0), "{name}: {seen}");
    if let Some(t) = &seen.t_relative {
        assert!(t.p999.0 <= T_ERROR, "{name}: {seen}");
    }
    let (pieces, truth) = (frame.u32(Channel::PieceId).unwrap(), judged.truth.u32(Channel::PieceId).unwrap());
    let same = (0..pieces.len()).filter(|&k| pieces[k] != NO_ID && truth[k] != NO_ID).all(|k| pieces[k] == truth[k]);
    assert!(same, "{name}: a pixel names another piece than its own");
    (judged, seen)
}

/// Renders and asserts as [`assert_right`]; nothing without an adapter.
pub fn check(name: &str, scene: &Scene, camera: &Camera) -> Option<(Frame, Judgement, Comparison)> {
    let frame = render(scene, camera)?;
    let (judged, seen) = assert_right(name, scene, camera, &frame);
    Some((frame, judged, seen))
}
