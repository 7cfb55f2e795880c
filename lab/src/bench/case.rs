//! A case: one scene rendered by several techniques, each an arm.

use super::calls::Plan;
use super::row::{Moving, Paper, Stiffness};
use anamorph::internals::engine::rival::Choice;
use anamorph::internals::engine::{Arithmetic, Method};
use anamorph::internals::image::write_text;
use anamorph::internals::input::Result;
use anamorph::internals::tools::example::EXAMPLES;
use std::path::{Path, PathBuf};

/// The source of a case's scene.
#[derive(Debug, Clone)]
pub enum Source {
    /// An example by name.
    Example(&'static str),
    /// A scene file's text.
    Text(String),
    /// Names and texts, the scene file's first.
    Files(Vec<(&'static str, String)>),
}

/// One scene and its arms.
#[derive(Debug, Clone)]
pub struct Case {
    /// Its title, unique in its suite.
    pub name: String,
    pub source: Source,
    /// KEY=VALUE of the scene for all arms.
    pub set: Vec<String>,
    /// Additional KEY=VALUE of the reference scene.
    pub truth: Vec<String>,
    pub moving: Moving,
    /// Whether this engine's tests and hits are counted, in an extra frame.
    pub counted: bool,
    /// If set, the reference has colours only, averaged over so many samples per pixel.
    pub filtered: Option<u32>,
    /// The stiffness of the scene, in stiff suites; proofs are counted then too.
    pub stiffness: Option<Stiffness>,
    pub arms: Vec<Arm>,
    /// If set, whole calls are timed, not frames of the arms.
    pub calls: Option<Plan>,
    /// The paper's own figures.
    pub paper: Option<Paper>,
}

/// One technique that renders a case's scene.
#[derive(Debug, Clone)]
pub struct Arm {
    /// A rival as `--engine` names it; `None`: this engine.
    pub rival: Option<String>,
    /// Its own KEY=VALUE.
    pub set: Vec<String>,
    /// Distinguishes it from other arms of the same technique.
    pub label: Option<&'static str>,
    /// Name and value of the swept parameter, if the technique has none of its own.
    pub parameter: Option<(&'static str, f64)>,
    /// As [`anamorph::internals::engine::RunOptions::no_cull`].
    pub no_cull: bool,
    pub arithmetic: Arithmetic,
    /// How this engine finds triangles; `None`: by what costs less, and by raster where a case is counted.
    pub method: Option<Method>,
    /// Render t and ids only, like yardsticks, without colour.
    pub bare: bool,
    /// Of a pixel.
    pub samples: Samples,
}

/// Samples per pixel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Samples {
    /// In one frame.
    AtOnce(u32),
    /// In one frame, weighted by areas.
    Analytic(u32),
    /// One frame per sample.
    Separate(u32),
}

impl Case {
    pub fn of(name: impl Into<String>, example: &'static str, arms: Vec<Arm>) -> Case {
        Case::new(name, Source::Example(example), arms)
    }

    pub fn new(name: impl Into<String>, source: Source, arms: Vec<Arm>) -> Case {
        Case {
            name: name.into(),
            source,
            set: Vec::new(),
            truth: Vec::new(),
            moving: Moving::Nothing,
            counted: false,
            filtered: None,
            stiffness: None,
            arms,
            calls: None,
            paper: None,
        }
    }

    pub fn set(mut self, set: &[impl AsRef<str>]) -> Case {
        self.set.extend(set.iter().map(|s| s.as_ref().to_owned()));
        self
    }

    /// The truth is the scene with these.
    pub fn truth(mut self, set: &[&str]) -> Case {
        self.truth.extend(set.iter().map(|s| (*s).to_owned()));
        self
    }

    pub fn paper(self, paper: Paper) -> Case {
        Case { paper: Some(paper), ..self }
    }

    pub fn moving(self, moving: Moving) -> Case {
        Case { moving, ..self }
    }

    pub fn stiff(self, stiffness: Stiffness) -> Case {
        Case { stiffness: Some(stiffness), ..self }
    }

    pub fn filtered(self, samples: u32) -> Case {
        Case { filtered: Some(samples), ..self }
    }

    pub fn counted(self) -> Case {
        Case { counted: true, ..self }
    }

    /// Writes the scene into a folder; returns its path.
    pub(super) fn write(&self, folder: &Path) -> Result<PathBuf> {
        match &self.source {
            Source::Text(text) => {
                let path = folder.join("scene.toml");
                write_text(&path, text)?;
                Ok(path)
            }
            Source::Files(files) => {
                for (name, text) in files {
                    write_text(&folder.join(name), text)?;
                }
                Ok(folder.join(files[0].0))
            }
            Source::Example(name) => match EXAMPLES.iter().find(|e| e.name == *name) {
                Some(example) => example.write(folder),
                None => Err(anamorph::internals::input::Error::input(format!("there is no example {name}"))),
            },
        }
    }
}

impl Arm {
    pub fn ours() -> Arm {
        Arm {
            rival: None,
            set: Vec::new(),
            label: None,
            parameter: None,
            no_cull: false,
            arithmetic: Arithmetic::default(),
            method: None,
            bare: false,
            samples: Samples::AtOnce(1),
        }
    }

    /// A rival, as `--engine` names it.
    pub fn rival(name: &str) -> Arm {
        Arm { rival: Some(name.to_owned()), ..Arm::ours() }
    }

    /// With so many samples per pixel.
    pub fn samples(self, samples: Samples) -> Arm {
        let (label, n) = match samples {
            Samples::AtOnce(n) => (self.label, n),
            Samples::Analytic(n) => (Some("areas"), n),
            Samples::Separate(n) => (Some("a frame a sample"), n),
        };
        Arm { samples, label, parameter: Some(("samples", f64::from(n))), ..self }
    }

    /// # Errors
    /// [`anamorph::internals::input::Error::Input`] if there is no such rival.
    pub fn choice(&self) -> Result<Option<Choice>> {
        self.rival.as_deref().map(crate::rivals::parse).transpose().map_err(anamorph::internals::input::Error::input)
    }

    pub fn set(mut self, set: &[&str]) -> Arm {
        self.set.extend(set.iter().map(|s| (*s).to_owned()));
        self
    }

    /// Distinguishes it from other arms of the same technique.
    pub fn label(self, label: &'static str) -> Arm {
        Arm { label: Some(label), ..self }
    }

    /// Without culling.
    pub fn no_cull(self) -> Arm {
        Arm { no_cull: true, ..self.label("no culling") }
    }

    /// t and ids only, like yardsticks.
    pub fn bare(self) -> Arm {
        Arm { bare: true, ..self.label("t and ids alone") }
    }

    /// All coverage tests in this arithmetic.
    pub fn arithmetic(self, arithmetic: Arithmetic, label: &'static str) -> Arm {
        Arm { arithmetic, ..self.label(label) }
    }

    /// Finds triangles by this method.
    pub fn by(self, method: Method) -> Arm {
        let label = match method {
            Method::Auto => "auto",
            Method::Raster => "raster",
            Method::Trace => "trace",
        };
        Arm { method: Some(method), ..self.label(label) }
    }

    /// Sets the swept parameter.
    pub fn parameter(self, name: &'static str, value: f64) -> Arm {
        Arm { parameter: Some((name, value)), ..self }
    }
}

/// This engine, then rivals by name.
pub fn arms(rivals: &[&str]) -> Vec<Arm> {
    [Arm::ours()].into_iter().chain(rivals.iter().map(|name| Arm::rival(name))).collect()
}
