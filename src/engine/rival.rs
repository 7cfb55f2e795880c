//! Other techniques to find what each pixel sees, in place of the stages from cull to recheck.

use super::combinations::{Asked, Feature};
use crate::camera::Camera;
use crate::gpu::Gpu;
use crate::gpu::buffers::Buffers;
use crate::gpu::kernels::Variant;
use crate::gpu::recorder::Recorder;
use crate::input::{Error, Result};
use crate::scene::Scene;
use glam::DVec3;
use serde::{Serialize, Serializer};
use std::fmt;
use std::sync::OnceLock;

/// A technique ready for one scene and camera.
pub trait Rival: Send {
    /// Builds what it needs over the triangles of the scene, anew where they moved, beside those that are on the device anyway.
    fn upload(&mut self, _gpu: &Gpu, _scene: &Scene) -> Result<()> {
        Ok(())
    }

    /// Brings what it needs of the camera to that of `setup`, which is of the same kind and size.
    fn aim(&mut self, gpu: &Gpu, setup: &Setup) -> Result<()>;

    /// Triangles that it draws for a chunk of `slots` triangles.
    fn draws(&self, _slots: u32) -> u64 {
        0
    }

    /// Passes over a band, at most.
    fn passes(&self, band: &Target) -> u32;

    /// Fills the visibility buffer of a band, which is clear.
    fn encode(&self, gpu: &Gpu, recorder: &mut Recorder, band: &Target) -> Result<()>;

    /// Whether the last frame is whole.
    fn check(&self, _gpu: &Gpu) -> Result<()> {
        Ok(())
    }

    /// Device memory held beside what all hold, bytes.
    fn bytes(&self) -> u64;
}

/// A band of the image, and where the buffers of its jobs are found.
pub struct Target<'a> {
    /// Rows of pixels.
    pub rows: u32,
    pub chunks: Vec<ChunkScopes<'a>>,
}

/// The triangles of a chunk.
pub struct ChunkScopes<'a> {
    pub scopes: Vec<&'a Buffers>,
    /// Length of `triangles`.
    pub slots: u32,
}

/// What a rival is made for.
pub struct Setup<'a> {
    pub camera: &'a Camera,
    /// How the device holds the camera's rays.
    pub variant: Variant,
    /// Rows of pixels of the largest band.
    pub rows: u32,
    /// Of the scene's box.
    pub centre: DVec3,
    /// What positions on the device are relative to.
    pub anchor: DVec3,
    /// The number that trades the rival's error for its time.
    pub parameter: u32,
}

impl Setup<'_> {
    /// Layers that a pixel may see.
    pub fn layers(&self) -> u32 {
        self.camera.layers.len() as u32
    }
}

/// What every rasterizer has; they lie where [`sample_offsets`](super::plan::samples::sample_offsets) of four do.
pub const MULTISAMPLES: u32 = 4;

/// Features that no rival renders, why, and what to do instead. With an atlas, rivals show mirrors and lenses.
pub const NOT_RENDERED: [(Feature, &str, &str); 7] = [
    (Feature::Gradients, "has no gradients", "use --engine compute"),
    (Feature::Timed, "sees the whole scene at one time", "make shutter and line_time 0"),
    (Feature::Spheres, "draws triangles alone", "use --engine compute"),
    (Feature::Certified, "cannot certify pixels", "use --engine compute, or leave certified out"),
    (Feature::Analytic, "counts samples, and measures no areas", "leave out analytic coverage"),
    (Feature::AlphaMasks, "ignores alpha masks", "use --engine compute"),
    (
        Feature::Optics,
        "does not follow reflected or refracted rays",
        "give the camera an atlas, or use --engine compute",
    ),
];

/// Why some rivals refuse `--no-cull`, and what to do instead.
pub const NOT_CULLED: (&str, &str) = ("culls nothing", "leave out --no-cull");

/// A rival by name.
#[derive(Clone, Copy)]
pub struct Technique {
    pub name: &'static str,
    /// What its number is; `None`: it has none.
    pub parameter: Option<Parameter>,
    /// It leaves out what a piece does not see, and may be told not to.
    pub culls: bool,
    /// It draws through the raster pipeline.
    pub draws: bool,
    /// Samples a pixel that it may have in a frame: 1, or [`MULTISAMPLES`] of the rasterizer's own.
    pub samples: u32,
    pub make: fn(&Gpu, &Setup) -> Result<Box<dyn Rival>>,
}

/// The number that trades a rival's error for its time.
#[derive(Clone, Copy)]
pub struct Parameter {
    pub name: &'static str,
    pub default: u32,
    pub least: u32,
    pub most: u32,
}

/// The techniques that `--engine` and the viewer offer beside the engine and the reference.
static REGISTERED: OnceLock<&'static [Technique]> = OnceLock::new();

/// Makes techniques available by name in the whole process. A program that has some calls it once, when it starts.
pub fn register(techniques: &'static [Technique]) {
    // the first list stays
    let _ = REGISTERED.set(techniques);
}

/// The registered techniques; none in the program `anamorph`.
pub fn techniques() -> &'static [Technique] {
    REGISTERED.get().copied().unwrap_or_default()
}

/// Reads `NAME` or `NAME:N`, one of `techniques` and its number.
///
/// # Errors
/// One line that lists the techniques if the name is unknown, or the numbers if the number is out of range.
pub fn parse(text: &str, techniques: &'static [Technique]) -> std::result::Result<Choice, String> {
    let (name, number) = text.split_once(':').map_or((text, None), |(n, k)| (n, Some(k)));
    let technique = techniques.iter().find(|t| t.name == name).ok_or_else(|| {
        let names: Vec<&str> = ["compute", "reference"].into_iter().chain(techniques.iter().map(|t| t.name)).collect();
        match techniques {
            [] => "no such engine; use compute or reference; other techniques are in anamorph-lab: cargo install --path lab".into(),
            _ => format!("no such engine; use {}", names.join(", ")),
        }
    })?;
    let parameter = match (&technique.parameter, number) {
        (Some(Parameter { name: what, least, most, .. }), Some(text)) => text
            .parse()
            .ok()
            .filter(|n| (*least..=*most).contains(n))
            .ok_or_else(|| format!("write {name}:N with {least} to {most} {what}"))?,
        (Some(parameter), None) => parameter.default,
        (None, Some(_)) => return Err(format!("{name} takes no number; leave it out")),
        (None, None) => 0,
    };
    Ok(Choice { technique, parameter })
}

impl fmt::Debug for Technique {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(self.name)
    }
}

/// What renders a frame.
#[derive(Debug, Clone, Copy)]
pub enum EngineName {
    Compute,
    Reference,
    /// The compute engine with another technique to find what each pixel sees.
    Rival(Choice),
}

/// As on the command line and in reports.
impl fmt::Display for EngineName {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            EngineName::Compute => f.write_str("compute"),
            EngineName::Reference => f.write_str("reference"),
            EngineName::Rival(choice) => f.write_str(&choice.label()),
        }
    }
}

impl Serialize for EngineName {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// A rival and its number.
#[derive(Debug, Clone, Copy)]
pub struct Choice {
    pub technique: &'static Technique,
    pub parameter: u32,
}

impl Choice {
    /// `NAME` or `NAME:N`, as on the command line.
    pub fn label(&self) -> String {
        match self.technique.parameter {
            Some(_) => format!("{}:{}", self.technique.name, self.parameter),
            None => self.technique.name.to_owned(),
        }
    }

    /// Samples a pixel that it takes in a frame, where it takes several: multisampling knows one layer.
    pub fn samples(&self, camera: &Camera) -> u32 {
        if camera.layers.len() == 1 { self.technique.samples } else { 1 }
    }

    /// Refuses frames with features that no rival renders.
    ///
    /// # Errors
    /// [`Error::Input`] of the first such feature.
    pub fn check(&self, asked: &Asked) -> Result<()> {
        let has = |feature: Feature| feature.is_in(asked);
        // an atlas is rendered by the rival, too
        let lacks = |feature: Feature| has(feature) && !(feature == Feature::Optics && has(Feature::Atlas));
        let culls = asked.no_cull && !self.technique.culls;
        let lacking = NOT_RENDERED.iter().find(|row| lacks(row.0)).map(|row| (row.1, row.2));
        match lacking.or(culls.then_some(NOT_CULLED)) {
            Some((what, remedy)) => Err(Error::input(format!("{} {what}; {remedy}", self.technique.name))),
            None => Ok(()),
        }
    }

    /// The rival for a scene and a camera, with the scene's triangles.
    ///
    /// # Errors
    /// [`Error::Input`] where it cannot show them, with the reason.
    pub fn make(&self, gpu: &Gpu, scene: &Scene, setup: Setup) -> Result<Box<dyn Rival>> {
        let name = self.technique.name;
        let mut rival =
            (self.technique.make)(gpu, &Setup { parameter: self.parameter, ..setup }).map_err(|e| e.at(name))?;
        rival.upload(gpu, scene).map_err(|e| e.at(name))?;
        Ok(rival)
    }
}
