//! One mesh through one camera: rendered, timed, and compared with the reference.

use anamorph::internals::camera::Camera;
use anamorph::internals::engine::plan::Wanted;
use anamorph::internals::engine::plan::slabs::{Slabs, kind};
use anamorph::internals::engine::report::FrameMs;
use anamorph::internals::engine::{Engine, Rendered, RunOptions};
use anamorph::internals::gpu::kernels::RaysKind;
use anamorph::internals::image::compare::{Comparison, Quantiles, compare};
use anamorph::internals::image::frame::{Channel, Frame, NO_ID};
use anamorph::internals::input::{Error, Loading, Result};
use anamorph::internals::reference::image::judge;
use anamorph::internals::scene::Scene;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Frames that are timed after a first one.
const TIMED: u32 = 3;
/// From this time of the first frame on one is enough, ms.
const LONG_MS: f64 = 5000.0;
/// Of all pixels, those that must show the mesh: a picture of nothing proves nothing.
const LEAST_COVERAGE: f64 = 0.02;
/// Largest error of t relative to max(|t|, extent / |D|) of all but one pixel of a thousand: t is worked out in f64 from
/// positions stored to 2^-48 and written as f32 (2^-24); the rest is margin for surfaces seen edge-on, where t is
/// ill-conditioned.
const T_ERROR: f64 = 1e-5;

/// A line of the table.
#[derive(Serialize, Deserialize)]
pub struct Line {
    pub mesh: String,
    pub camera: String,
    /// The commit that the program was built from, and the adapter.
    pub by: String,
    pub outcome: Outcome,
}

#[derive(Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    Frame(Box<Figures>),
    Error(String),
}

/// What a frame took, and how it stands against the reference.
#[derive(Serialize, Deserialize)]
pub struct Figures {
    pub size: [u32; 2],
    pub triangles: usize,
    pub pieces: usize,
    /// How the kernels hold the rays: pieces, a field, or curves of a degree.
    pub rays: String,
    pub layers: u32,
    /// Into how many spans of t each layer of curves is split.
    pub spans: u32,
    /// Compute passes of a frame.
    pub passes: u32,
    /// What f32 does not prove is taken again in f64.
    pub rechecked: bool,
    /// Each timed frame, ms.
    pub frame_ms: Vec<f64>,
    /// Share of the pixels that show the mesh.
    pub coverage: f64,
    pub unsafe_share: f64,
    pub wrong_triangle: u64,
    pub wrong_safe: u64,
    /// Unsafe pixels that name no near candidate.
    pub not_near: u64,
    /// Pixels with the right triangle but another piece than their own.
    pub wrong_piece: u64,
    /// `None` where nothing is hit.
    pub t: Option<Errors>,
    pub z: Option<Errors>,
    /// What is wrong; empty where the frame is right.
    pub faults: Vec<String>,
}

/// Quantiles of relative errors; an infinite one is `None`.
#[derive(Serialize, Deserialize)]
pub struct Errors {
    pub p99: Option<f64>,
    pub p999: Option<f64>,
    pub max: Option<f64>,
}

impl Errors {
    fn of(quantiles: Quantiles) -> Errors {
        let finite = |x: f64| x.is_finite().then_some(x);
        Errors { p99: finite(quantiles.p99.0), p999: finite(quantiles.p999.0), max: finite(quantiles.max.0) }
    }
}

impl Line {
    /// Whether the frame is there and right.
    pub fn is_right(&self) -> bool {
        matches!(&self.outcome, Outcome::Frame(f) if f.faults.is_empty())
    }
}

/// A frame's figures, and its picture: RGBA, 8 bits each.
pub fn measure(engine: &mut Engine, scene: &Path) -> Result<(Figures, Vec<u8>)> {
    let scene = Scene::load(scene, &[], 0.0, &Loading::default())?;
    let camera = scene.camera()?;
    let rendered = render(engine, &scene, &camera)?;
    let judged = judge(&scene, &camera, &rendered.frame);
    let compared = compare(&rendered.frame, &judged.truth, Some(&judged.safe), Some(&judged.scales))?;
    let slabs = Slabs::of(&camera);
    let mut figures = Figures {
        size: [camera.width, camera.height],
        triangles: scene.mesh.triangles.len(),
        pieces: camera.piece_count(),
        rays: match kind(&camera) {
            RaysKind::Pieces => "pieces".into(),
            RaysKind::Field { .. } => "field".into(),
            RaysKind::Curves { degree } => format!("curves of degree {degree}"),
        },
        layers: slabs.layers,
        spans: slabs.spans,
        passes: rendered.passes.total(),
        rechecked: engine.gpu.has.f64,
        frame_ms: rendered.frame_ms.clone(),
        coverage: covered(&rendered.frame) as f64 / compared.pixels as f64,
        unsafe_share: compared.unsafe_share.unwrap_or(f64::NAN),
        wrong_triangle: count(compared.wrong_triangle)?,
        wrong_safe: count(compared.wrong_safe)?,
        not_near: judged.not_near,
        wrong_piece: wrong_pieces(&rendered.frame, &judged.truth),
        t: compared.t_relative.map(Errors::of),
        z: compared.z_relative.map(Errors::of),
        faults: Vec::new(),
    };
    figures.faults = faults(&figures, &compared);
    let picture = rendered.srgb8.ok_or_else(|| Error::work("no picture came back"))?;
    Ok((figures, picture))
}

/// A first frame, which warms the adapter up, and the timed ones.
fn render(engine: &mut Engine, scene: &Scene, camera: &Camera) -> Result<Rendered> {
    let channels =
        Channel::ALL.iter().copied().filter(|c| !matches!(c, Channel::R | Channel::G | Channel::B)).collect();
    let wanted = Wanted { srgb8: true, ..Wanted::of(channels) };
    let first = engine.render(scene, camera, &wanted, &RunOptions::default())?;
    let long = first.frame_ms.iter().any(|&ms| ms > LONG_MS);
    drop(first);
    let repeat = if long { 0 } else { TIMED };
    engine.render(scene, camera, &wanted, &RunOptions { repeat, ..Default::default() })
}

fn count(pixels: Option<u64>) -> Result<u64> {
    pixels.ok_or_else(|| Error::work("the frame has no triangle ids"))
}

fn covered(frame: &Frame) -> usize {
    frame.u32(Channel::TriangleId).map_or(0, |ids| ids.iter().filter(|&&id| id != NO_ID).count())
}

fn wrong_pieces(frame: &Frame, truth: &Frame) -> u64 {
    let of = |channel| frame.u32(channel).zip(truth.u32(channel));
    let Some(((ids, true_ids), (pieces, true_pieces))) = of(Channel::TriangleId).zip(of(Channel::PieceId)) else {
        return 0;
    };
    (0..ids.len()).filter(|&k| ids[k] == true_ids[k] && pieces[k] != true_pieces[k]).count() as u64
}

fn faults(figures: &Figures, compared: &Comparison) -> Vec<String> {
    let mut faults = Vec::new();
    let mut say = |wrong: bool, what: String| wrong.then(|| faults.push(what));
    say(figures.wrong_safe > 0, format!("{} safe pixels have the wrong triangle", figures.wrong_safe));
    say(figures.not_near > 0, format!("{} pixels name no near candidate", figures.not_near));
    say(figures.wrong_piece > 0, format!("{} pixels name another piece than their own", figures.wrong_piece));
    if let Some(t) = &compared.t_relative {
        say(t.p999.0 > T_ERROR, format!("t is off by {} or more in one pixel of a thousand", t.p999));
    }
    let coverage = 100.0 * figures.coverage;
    say(figures.coverage < LEAST_COVERAGE, format!("only {coverage:.1} % of the picture show the mesh"));
    faults
}

impl std::fmt::Display for Line {
    /// One line for a person.
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(f, "{:<10} {:<22}", self.mesh, self.camera)?;
        match &self.outcome {
            Outcome::Error(e) => write!(f, " ERROR: {e}"),
            Outcome::Frame(x) => {
                let (ms, unsafe_, covered) = (x.median_ms(), 100.0 * x.unsafe_share, 100.0 * x.coverage);
                write!(f, " {ms:>8.0} ms, {covered:>5.1} % covered, {unsafe_:>6.3} % unsafe, {}", x.passes_used())?;
                if x.faults.is_empty() { Ok(()) } else { write!(f, " WRONG: {}", x.faults.join("; ")) }
            }
        }
    }
}

impl Figures {
    pub fn median_ms(&self) -> f64 {
        FrameMs::of(&self.frame_ms).median
    }

    /// Which kernels the frame took.
    pub fn passes_used(&self) -> String {
        let of = |n: u32, one: &str, more: &str| format!("{n} {}", if n == 1 { one } else { more });
        let slabs = match (self.layers, self.spans) {
            (1, 1) => String::new(),
            (layers, 1) => format!(", {}", of(layers, "layer", "layers")),
            (layers, spans) => format!(", {} x {}", of(layers, "layer", "layers"), of(spans, "span", "spans")),
        };
        let recheck = if self.rechecked { ", f64" } else { "" };
        format!("{}{slabs}, {}{recheck}", self.rays, of(self.passes, "pass", "passes"))
    }
}
