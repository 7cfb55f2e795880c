//! One measured row: case, technique, times and errors.

use super::case::{Arm, Case};
use super::times::{Ratio, Times};
use anamorph::internals::camera::Camera;
use anamorph::internals::engine::{Counts, Rendered};
use anamorph::internals::gpu::draw_counts::DrawCounts;
use anamorph::internals::image::compare::Comparison;
use anamorph::internals::scene::Scene;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// A row of raw.csv and results.json.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Row {
    pub suite: String,
    /// Commit of the measured source, if known.
    #[serde(default)]
    pub commit: Option<String>,
    pub case: String,
    /// `anamorph`, or a rival as `--engine` names it.
    pub technique: String,
    /// Distinguishes rows of the same technique in a case.
    #[serde(alias = "way")]
    pub label: Option<String>,
    /// Name and value of the swept parameter.
    #[serde(alias = "knob")]
    pub parameter: Option<(String, f64)>,
    pub triangles: usize,
    pub pieces: usize,
    pub width: u32,
    pub height: u32,
    pub moving: Moving,
    #[serde(default)]
    pub stiffness: Option<Stiffness>,
    /// Times of frames.
    pub times: Option<Times>,
    #[serde(default)]
    pub calls: Option<Calls>,
    /// Median time of an empty kernel, run in turn with the rest, ms.
    pub control_ms: f64,
    /// The time of this row over that of `anamorph` in the same case; of a yardstick, over that of `anamorph` asked for no more.
    pub to_ours: Option<Ratio>,
    /// Time on the device by stage, ms.
    pub stages: Vec<(String, f64)>,
    pub passes: u32,
    pub bytes: u64,
    pub counted: Option<Counted>,
    /// Of a rival that draws, where the adapter counts it.
    #[serde(default)]
    pub drawn: Option<Drawn>,
    pub error: Option<Error>,
    #[serde(default)]
    pub certified: Option<Certified>,
    /// The reason if there is no time.
    pub refused: Option<String>,
    pub paper: Option<Paper>,
}

/// What changes in each frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Moving {
    Nothing,
    /// Matrices of objects.
    Objects,
    /// Every vertex.
    Triangles,
    /// The camera: it is compiled, planned and uploaded again.
    Camera,
}

impl Moving {
    pub fn name(self) -> &'static str {
        match self {
            Moving::Nothing => "nothing",
            Moving::Objects => "objects",
            Moving::Triangles => "triangles",
            Moving::Camera => "camera",
        }
    }
}

/// Whole calls, from what changes to the arrays in the caller's memory.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Calls {
    pub times: Times,
    /// Time of a first call, which compiles kernels and uploads the scene, ms; `None` where it was not timed apart.
    pub first_ms: Option<f64>,
    /// A call's time over its frame's.
    pub to_frame: Option<Ratio>,
    /// Images of a call.
    pub images: u32,
    /// Median times of parts of a call by name, ms.
    pub parts: Vec<(String, f64)>,
    /// Largest resident memory of the process during the calls, bytes; `None` where it is not known.
    pub peak_bytes: Option<u64>,
}

impl Calls {
    /// Calls of one image each, and the frame of each, ms.
    pub fn of(calls: &[f64], frames: &[f64]) -> Calls {
        let [each, own] = [calls, frames].map(|list| list.iter().copied().map(Some).collect::<Vec<_>>());
        Calls {
            times: Times::of(calls),
            first_ms: None,
            to_frame: Ratio::of(&each, &own),
            images: 1,
            parts: Vec::new(),
            peak_bytes: None,
        }
    }

    /// Images a second.
    pub fn images_a_second(&self) -> f64 {
        1e3 * f64::from(self.images) / self.times.median
    }
}

/// A scene of a family that one number makes stiffer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Stiffness {
    pub family: String,
    /// Name of the parameter.
    #[serde(alias = "knob")]
    pub parameter: String,
    pub value: f64,
}

/// What is proven of a frame, shares of its pixels.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Certified {
    /// By bounds in f32.
    pub by_f32: f64,
    /// By bounds on the recheck.
    pub by_recheck: f64,
    /// Pixels that are proven and have another triangle than the reference.
    pub wrong: u64,
}

/// What a frame of this engine tests and keeps.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Counted {
    /// (triangle, tile) pairs.
    pub pairs_tested: u64,
    pub pairs_kept: u64,
    /// Pixels tried for a triangle.
    pub fragments_tested: u64,
    /// Those that the triangle holds.
    pub fragments_kept: u64,
    /// Signs that f64 decided.
    pub rechecked: u64,
    /// Pixels that show a triangle.
    pub covered: u64,
}

/// What the adapter's rasterizer does for a frame of a rival.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Drawn {
    /// Triangles that it is handed: a third of the runs of vertex shaders.
    pub triangles_drawn: u64,
    /// Those that are left once what is outside is clipped off.
    pub triangles_left: u64,
    /// Runs of fragment shaders.
    pub fragments: u64,
    /// Pixels that show a triangle.
    pub covered: u64,
}

/// Against the f64 reference.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Error {
    /// Each how many-th row was compared.
    #[serde(default = "every_row")]
    pub row_step: u32,
    /// Pixels with another triangle, of those compared.
    pub wrong_share: f64,
    pub wrong_hit_miss: u64,
    /// Wrong pixels whose answer no shift by 1/16 px changes.
    pub wrong_safe: u64,
    /// Wrong pixels that name no triangle that may be seen within 1/16 px.
    #[serde(default)]
    pub wrong_not_near: Option<u64>,
    /// Half of the errors of t are not larger, relative.
    #[serde(default)]
    pub t_median: Option<f64>,
    /// 99.9 % of them are not.
    pub t_p999: Option<f64>,
    /// None is; `None` where there is none, or one is not finite.
    #[serde(default)]
    pub t_max: Option<f64>,
    /// The same of Z.
    #[serde(default)]
    pub z: Option<[f64; 3]>,
    /// `None`: identical colours, or none to compare.
    pub psnr: Option<f64>,
    pub identical: bool,
}

fn every_row() -> u32 {
    1
}

/// What a paper prints.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Paper {
    pub paper: String,
    pub figure: String,
    /// Frames a second, where it prints them.
    pub fps: Option<f64>,
    /// The same with its culling switched off.
    pub fps_no_cull: Option<f64>,
    pub hardware: String,
    /// The stand-in for the paper's scene.
    pub stand_in: String,
}

/// This engine's name among the techniques.
const OURS: &str = "anamorph";

impl Row {
    pub fn new(suite: &str, case: &Case, arm: &Arm) -> Row {
        let own_parameter = arm.parameter.map(|(name, value)| (name.to_owned(), value));
        // what is no rival is refused by name
        let choice = arm.choice().ok().flatten();
        let rivals_parameter =
            choice.and_then(|c| c.technique.parameter.as_ref().map(|k| (k.name.to_owned(), f64::from(c.parameter))));
        let asked = || arm.rival.clone().unwrap_or_else(|| OURS.to_owned());
        Row {
            suite: suite.to_owned(),
            commit: None,
            case: case.name.clone(),
            technique: choice.map_or_else(asked, |c| c.technique.name.to_owned()),
            label: arm.label.map(str::to_owned),
            parameter: own_parameter.or(rivals_parameter),
            triangles: 0,
            pieces: 0,
            width: 0,
            height: 0,
            moving: case.moving,
            stiffness: case.stiffness.clone(),
            times: None,
            calls: None,
            control_ms: 0.0,
            to_ours: None,
            stages: Vec::new(),
            passes: 0,
            bytes: 0,
            counted: None,
            drawn: None,
            error: None,
            certified: None,
            refused: None,
            paper: case.paper.clone(),
        }
    }

    /// A row of a case that failed.
    pub fn refused(suite: &str, case: &Case, arm: &Arm, why: &anamorph::internals::input::Error) -> Row {
        Row { refused: Some(why.to_string()), ..Row::new(suite, case, arm) }
    }

    /// A row of the program that runs beside the arms.
    /// `arm`: this engine's that is asked for as much.
    pub fn of_yardstick(suite: &str, case: &Case, arm: Option<&Arm>, program: &Path) -> Row {
        let name = program.file_name().unwrap_or(program.as_os_str()).to_string_lossy().into_owned();
        let parameter = arm.and_then(|arm| arm.parameter);
        Row { technique: name, ..Row::new(suite, case, &Arm { parameter, ..Arm::ours() }) }
    }

    pub fn is_ours(&self) -> bool {
        self.technique == OURS
    }

    pub fn describe(&mut self, scene: &Scene, camera: &Camera) {
        self.triangles = scene.mesh.triangles.len();
        self.pieces = match camera.optics.as_ref() {
            Some(optics) => optics.surface_count(),
            None => camera.first_piece(camera.layers.len()) as usize,
        };
        (self.width, self.height) = (camera.width, camera.height);
    }

    pub fn took(&mut self, rendered: &Rendered) {
        self.stages = rendered.stages.iter().map(|(name, ms)| ((*name).to_owned(), *ms)).collect();
        self.stages.extend(rendered.caustics.as_ref().map(|c| ("deposit (once)".to_owned(), c.ms)));
        self.passes = rendered.passes.total();
        self.bytes = rendered.bytes;
    }

    /// The row for a terminal.
    pub fn line(&self) -> String {
        let call = self.calls.as_ref().map_or(String::new(), |c| format!(", {:.2} ms a call", c.times.median));
        let time = self.times.as_ref().map(|t| format!("{:>9.2} ms{call}", t.median));
        let wrong = self.error.as_ref().map(|e| match e.psnr.filter(|_| e.is_of_colours()) {
            Some(psnr) => format!(", {psnr:.1} dB"),
            None => format!(", {:.4} % wrong", 100.0 * e.wrong_share),
        });
        let time = time.or_else(|| self.refused.clone()).unwrap_or_default();
        format!("  {:<56} {:<40} {time}{}\n", self.case, self.label(), wrong.unwrap_or_default())
    }

    /// How this engine found its triangles, by the stages that took over a twentieth of the device's time: `raster`, `trace`, or both, where
    /// trace took over or an atlas was rasterized.
    pub fn found_by(&self) -> &'static str {
        let all: f64 = self.stages.iter().filter(|s| !s.0.contains("once")).map(|s| s.1).sum();
        let took = |names: &[&str]| {
            self.stages.iter().filter(|s| names.contains(&s.0.as_str())).map(|s| s.1).sum::<f64>() > all / 20.0
        };
        match (self.is_ours(), took(&["small", "raster"]), took(&["trace"])) {
            (true, true, false) => "raster",
            (true, false, true) => "trace",
            (true, true, true) => "raster, trace",
            _ => "",
        }
    }

    /// The technique and its label.
    pub fn name(&self) -> String {
        self.label.as_ref().map_or_else(|| self.technique.clone(), |label| format!("{}, {label}", self.technique))
    }

    /// The same with its number.
    pub fn label(&self) -> String {
        match &self.parameter {
            Some((name, value)) => format!("{} ({value} {name})", self.name()),
            None => self.name(),
        }
    }
}

impl Drawn {
    pub fn of(counts: DrawCounts, covered: u64) -> Drawn {
        let DrawCounts { vertices, triangles, fragments } = counts;
        Drawn { triangles_drawn: vertices / 3, triangles_left: triangles, fragments, covered }
    }

    /// Fragments for each pixel that shows a triangle.
    pub fn overdraw(&self) -> f64 {
        self.fragments as f64 / self.covered.max(1) as f64
    }
}

impl Counted {
    pub fn of(counts: Counts, covered: u64) -> Counted {
        let Counts { pairs_tested, pairs_kept, fragments_tested, fragments_kept, rechecked, .. } = counts;
        Counted { pairs_tested, pairs_kept, fragments_tested, fragments_kept, rechecked, covered }
    }

    /// Fragments tested for each pixel that shows a triangle.
    pub fn overdraw(&self) -> f64 {
        self.fragments_tested as f64 / self.covered.max(1) as f64
    }
}

impl Error {
    /// Nothing is wrong.
    #[cfg(test)]
    pub fn none() -> Error {
        Error {
            row_step: every_row(),
            wrong_share: 0.0,
            wrong_hit_miss: 0,
            wrong_safe: 0,
            wrong_not_near: None,
            t_median: None,
            t_p999: None,
            t_max: None,
            z: None,
            psnr: None,
            identical: true,
        }
    }

    /// Colours alone were compared with the truth; wrong pixels are not counted.
    pub fn is_of_colours(&self) -> bool {
        self.t_median.is_none() && self.wrong_share == 0.0 && (self.psnr.is_some() || self.identical)
    }

    /// Over several frames: the mean of the shares of wrong pixels, the sums of counts, and the largest of the other errors; `None` without
    /// frames.
    pub fn over(all: &[Error]) -> Option<Error> {
        let first = all.first()?;
        let most = |of: fn(&Error) -> Option<f64>| all.iter().filter_map(of).max_by(f64::total_cmp);
        Some(Error {
            wrong_share: all.iter().map(|e| e.wrong_share).sum::<f64>() / all.len() as f64,
            wrong_hit_miss: all.iter().map(|e| e.wrong_hit_miss).sum(),
            wrong_safe: all.iter().map(|e| e.wrong_safe).sum(),
            t_median: most(|e| e.t_median),
            t_p999: most(|e| e.t_p999),
            t_max: most(|e| e.t_max),
            z: None,
            psnr: None,
            identical: all.iter().all(|e| e.identical),
            ..*first
        })
    }

    pub fn of(c: &Comparison) -> Error {
        let share = |n: Option<u64>| n.unwrap_or(0) as f64 / c.pixels as f64;
        let finite = |value: f64| Some(value).filter(|v| v.is_finite());
        Error {
            row_step: every_row(),
            wrong_share: share(c.wrong_triangle),
            wrong_hit_miss: c.wrong_hit_miss.unwrap_or(0),
            wrong_safe: c.wrong_safe.unwrap_or(0),
            wrong_not_near: None,
            t_median: c.t_relative.and_then(|t| finite(t.median.0)),
            t_p999: c.t_relative.and_then(|t| finite(t.p999.0)),
            t_max: c.t_relative.and_then(|t| finite(t.max.0)),
            z: c.z_relative.map(|z| [z.median.0, z.p999.0, z.max.0]).filter(|z| z.iter().all(|v| v.is_finite())),
            psnr: c.psnr.and_then(finite),
            identical: c.identical == Some(true),
        }
    }
}
