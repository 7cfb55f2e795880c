//! A case: one scene, seen by several techniques, each as an arm. All arms run in turn, A B A B, with an empty kernel between
//! them as a control; each frame is held against one truth.

use super::row::{Error, Paper, Row, Times};
use crate::baseline::Choice;
use crate::camera::Camera;
use crate::compare::compare;
use crate::engine::{Engine, Frames, RunOptions};
use crate::error::Result;
use crate::example::EXAMPLES;
use crate::frame::Channel;
use crate::output::write_text;
use crate::plan::Wanted;
use crate::reference::image::{Judgement, judge};
use crate::scene::Scene;
use std::path::{Path, PathBuf};

/// Where a case's scene comes from.
#[derive(Debug, Clone)]
pub enum Source {
    /// A ready scene.
    Example(&'static str),
    /// A scene file's text.
    Text(String),
}

/// One scene and all that look at it.
#[derive(Debug, Clone)]
pub struct Case {
    /// What it is about, unique in its suite.
    pub name: String,
    pub source: Source,
    /// KEY=VALUE of the scene for all arms.
    pub set: Vec<String>,
    /// KEY=VALUE of the scene that is the truth, beside these.
    pub truth: Vec<String>,
    /// Every vertex is new in each frame.
    pub moving: bool,
    pub arms: Vec<Arm>,
    /// What a paper prints of it.
    pub paper: Option<Paper>,
}

/// One way to show a case's scene.
#[derive(Debug, Clone)]
pub struct Arm {
    /// A rival as `--engine` names it; `None`: this engine.
    pub by: Option<String>,
    /// KEY=VALUE of its own.
    pub set: Vec<String>,
    /// The number that a sweep varies, where its choice has none, with its name.
    pub knob: Option<(&'static str, f64)>,
}

/// Frames of more pixels are not held against the reference: it takes minutes.
const JUDGED_MAX: u64 = 1 << 20;

impl Case {
    pub fn of(name: impl Into<String>, example: &'static str, arms: Vec<Arm>) -> Case {
        Case::new(name, Source::Example(example), arms)
    }

    pub fn new(name: impl Into<String>, source: Source, arms: Vec<Arm>) -> Case {
        Case { name: name.into(), source, set: Vec::new(), truth: Vec::new(), moving: false, arms, paper: None }
    }

    pub fn set(mut self, set: &[&str]) -> Case {
        self.set.extend(set.iter().map(|s| (*s).to_owned()));
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

    /// Writes the scene into a folder; returns its path.
    fn write(&self, folder: &Path) -> Result<PathBuf> {
        match &self.source {
            Source::Text(text) => {
                let path = folder.join("scene.toml");
                write_text(&path, text)?;
                Ok(path)
            }
            Source::Example(name) => match EXAMPLES.iter().find(|e| e.name == *name) {
                Some(example) => example.write(folder),
                None => Err(crate::Error::input(format!("there is no example {name}"))),
            },
        }
    }

    /// Runs all arms so many times each.
    pub fn run(&self, engine: &mut Engine, suite: &str, runs: u32) -> Result<Vec<Row>> {
        let folder = tempfile::tempdir().map_err(|e| crate::Error::work(format!("no temporary folder: {e}")))?;
        let path = self.write(folder.path())?;
        let load = |more: &[String]| Scene::load(&path, &[&self.set[..], more].concat(), 0.0);
        let truth = load(&self.truth)?;
        let truth_camera = truth.camera()?;
        let judged = u64::from(truth_camera.width) * u64::from(truth_camera.height) <= JUDGED_MAX;
        let mut rows: Vec<Row> = self.arms.iter().map(|arm| Row::new(suite, self, arm)).collect();

        // everything that an arm needs, on the device
        let opened = |arm: &Arm| {
            let scene = load(&arm.set)?;
            let camera = scene.camera()?;
            Ok::<_, crate::Error>((scene, camera))
        };
        let scenes: Vec<Result<(Scene, Camera)>> = self.arms.iter().map(opened).collect();
        let mut frames: Vec<Option<Frames>> = Vec::new();
        for ((arm, scene), row) in self.arms.iter().zip(&scenes).zip(&mut rows) {
            let prepared = scene.as_ref().map_err(Clone::clone).and_then(|(scene, camera)| {
                row.describe(scene, camera);
                let channels = vec![Channel::R, Channel::G, Channel::B, Channel::T, Channel::TriangleId];
                let run = RunOptions { by: arm.choice()?, moving: self.moving, ..Default::default() };
                engine.prepare(scene, camera, &Wanted { channels, srgb8: false, counting: false }, &run)
            });
            match prepared {
                Ok(prepared) => frames.push(Some(prepared)),
                Err(e) => {
                    row.refused = Some(e.to_string());
                    frames.push(None);
                }
            }
        }

        // in turn, the order turned round every other time
        let mut times = vec![Vec::new(); frames.len()];
        let mut control = Vec::new();
        for k in 0..runs as usize {
            let mut order: Vec<usize> = (0..frames.len()).collect();
            if k % 2 == 1 {
                order.reverse();
            }
            control.push(engine.empty_frame()?);
            for arm in order {
                let Some(prepared) = &mut frames[arm] else { continue };
                match prepared.frame() {
                    Ok(ms) => times[arm].push(ms),
                    Err(e) => {
                        rows[arm].refused = Some(e.to_string());
                        frames[arm] = None;
                    }
                }
            }
        }

        let mut truth_frame: Option<Judgement> = None;
        for ((prepared, row), times) in frames.into_iter().zip(&mut rows).zip(times) {
            let Some(prepared) = prepared else { continue };
            row.times = Some(Times::of(&times));
            row.control_ms = Times::of(&control).median;
            match prepared.finish() {
                Ok(rendered) => {
                    row.took(&rendered);
                    if judged {
                        let truth = truth_frame.get_or_insert_with(|| judge(&truth, &truth_camera, &rendered.frame));
                        let of = compare(&rendered.frame, &truth.truth, Some(&truth.safe), Some(&truth.scales))?;
                        row.error = Some(Error::of(&of));
                    }
                }
                Err(e) => row.refused = Some(e.to_string()),
            }
        }
        let ours = rows.iter().find(|r| r.is_ours()).and_then(|r| r.times.as_ref()).map(|t| t.median);
        rows.iter_mut().for_each(|row| row.relate(ours));
        Ok(rows)
    }
}

impl Arm {
    pub fn ours() -> Arm {
        Arm { by: None, set: Vec::new(), knob: None }
    }

    /// A rival, as `--engine` names it.
    pub fn rival(name: &str) -> Arm {
        Arm { by: Some(name.to_owned()), ..Arm::ours() }
    }

    /// # Errors
    /// [`crate::Error::Input`] where there is no such rival.
    pub fn choice(&self) -> Result<Option<Choice>> {
        self.by.as_deref().map(Choice::parse).transpose().map_err(crate::Error::input)
    }

    pub fn set(mut self, set: &[&str]) -> Arm {
        self.set.extend(set.iter().map(|s| (*s).to_owned()));
        self
    }

    /// The number that a sweep varies.
    pub fn knob(self, name: &'static str, value: f64) -> Arm {
        Arm { knob: Some((name, value)), ..self }
    }
}

/// This engine, then rivals by name.
pub fn arms(rivals: &[&str]) -> Vec<Arm> {
    [Arm::ours()].into_iter().chain(rivals.iter().map(|name| Arm::rival(name))).collect()
}
