//! The suites: lists of cases.

mod beyond;
mod calls;
mod dynamic;
mod glc;
mod papers;
mod pareto;
mod samples;
mod stages;
mod stiff;

use super::case::{Case, Source};
use super::closeups::{Closeups, LORENZ};

/// A list of cases by name.
pub struct Suite {
    pub name: &'static str,
    /// What it answers, in a line.
    pub asks: &'static str,
    /// How a plot of each case has its axes.
    pub plot: Plot,
    cases: fn() -> Vec<Case>,
    /// Small cases.
    quick: fn() -> Vec<Case>,
    pub closeups: &'static [Closeups],
}

/// What a suite's rows are drawn as.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Plot {
    /// Share of wrong pixels against the time, a front a technique.
    Error,
    /// Error of colours against the time.
    Colour,
    /// The time against what is swept, both logarithmic, with fitted slopes.
    Scaling,
    /// Stacked times of stages.
    Stages,
    /// Share of wrong pixels against what makes scenes stiff, and against the time.
    Stiffness,
    /// Stacked parts of whole calls.
    Calls,
}

pub const SUITES: [Suite; 9] = [
    Suite {
        name: "papers",
        asks: "what each paper measured, by this engine and by the paper's own technique, on stand-ins of the same counts",
        plot: Plot::Error,
        cases: papers::cases,
        quick: papers::quick,
        closeups: &LORENZ,
    },
    Suite {
        name: "pareto",
        asks: "what less error costs each technique",
        plot: Plot::Error,
        cases: pareto::cases,
        quick: pareto::quick,
        closeups: &[],
    },
    Suite {
        name: "glc",
        asks: "how the time grows with pieces, triangles, pixels and spheres",
        plot: Plot::Scaling,
        cases: glc::cases,
        quick: glc::quick,
        closeups: &[],
    },
    Suite {
        name: "samples",
        asks: "what less aliasing costs: samples of a pixel, against a box filter of 256",
        plot: Plot::Colour,
        cases: samples::cases,
        quick: samples::quick,
        closeups: &[],
    },
    Suite {
        name: "stages",
        asks: "where a frame's time goes",
        plot: Plot::Stages,
        cases: stages::cases,
        quick: stages::quick,
        closeups: &[],
    },
    Suite {
        name: "dynamic",
        asks: "what it costs that every vertex moves in each frame",
        plot: Plot::Scaling,
        cases: dynamic::cases,
        quick: dynamic::quick,
        closeups: &[],
    },
    Suite {
        name: "stiff",
        asks: "what stays right, and what is proven, as scenes grow stiff",
        plot: Plot::Stiffness,
        cases: stiff::cases,
        quick: stiff::quick,
        closeups: &[],
    },
    Suite {
        name: "beyond",
        asks: "what it costs that things move, cameras share a picture, mirrors are seen along curves, and space is filled: none of the papers has these",
        plot: Plot::Stages,
        cases: beyond::cases,
        quick: beyond::quick,
        closeups: &[],
    },
    Suite {
        name: "calls",
        asks: "how long whole calls take along a path, from the change of a camera, objects or vertices to arrays in memory",
        plot: Plot::Calls,
        cases: calls::cases,
        quick: calls::quick,
        closeups: &[],
    },
];

impl Suite {
    pub fn cases(&self, quick: bool) -> Vec<Case> {
        // whole calls have sizes of their own
        let resized = |case: Case| if case.calls.is_some() { case } else { case.set(&QUICK_SIZE) };
        if quick { (self.quick)().into_iter().map(resized).collect() } else { (self.cases)() }
    }
}

/// The image of a quick case.
const QUICK_SIZE: [&str; 2] = ["image.width=160", "image.height=120"];

/// A scene of `lab/src/bench/scenes`.
macro_rules! scene {
    ($name:literal) => {
        $crate::bench::case::Source::Text(
            include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/src/bench/scenes/", $name, ".toml")).into(),
        )
    };
}
use scene;

/// A city of so many triangles, of fewer blocks where they are few.
fn city_of(count: u32) -> Vec<String> {
    const LEAST_A_BLOCK: u32 = 64;
    let blocks = f64::from(count / LEAST_A_BLOCK).sqrt().floor().clamp(1.0, 12.0);
    vec![format!("mesh.0.triangles={count}"), format!("mesh.0.blocks={blocks}")]
}

fn cylinder_scene() -> Source {
    scene!("cylinder")
}

#[cfg(test)]
mod tests {
    use super::*;
    use anamorph::internals::input::Loading;
    use std::collections::BTreeSet;

    /// Scenes of many triangles or pieces are left to the runs.
    #[test]
    #[ignore = "slow: make test-all"]
    fn the_scenes_of_all_arms_have_cameras() {
        let is_large = |key: &String| {
            let number = key.rsplit('=').next().and_then(|n| n.parse::<f64>().ok()).unwrap_or(0.0);
            number > 20_000.0 || key.contains("size=1030")
        };
        for suite in &SUITES {
            let timed_by_frames = |case: &Case| case.calls.is_none();
            for case in suite.cases(false).into_iter().chain(suite.cases(true)).filter(timed_by_frames) {
                let folder = tempfile::tempdir().unwrap();
                let path = case.write(folder.path()).unwrap();
                let small = ["image.width=32", "image.height=24"].map(str::to_owned);
                let own = case.arms.iter().map(|arm| &arm.set).chain([&case.truth]).collect::<BTreeSet<_>>();
                for set in own.into_iter().filter(|s| !s.iter().chain(&case.set).any(is_large)) {
                    let set = [&case.set[..], set, &small].concat();
                    let scene = anamorph::internals::scene::Scene::load(&path, &set, 0.0, &Loading::default());
                    let camera = scene.and_then(|s| s.camera());
                    assert!(camera.is_ok(), "{}: {}: {set:?}: {:?}", suite.name, case.name, camera.err());
                }
            }
        }
    }

    #[test]
    fn every_case_has_a_name_of_its_own_and_rivals_that_are_there() {
        for suite in &SUITES {
            for quick in [false, true] {
                let cases = suite.cases(quick);
                let mut names: Vec<&String> = cases.iter().map(|c| &c.name).collect();
                names.sort();
                names.dedup();
                assert!(!cases.is_empty() && names.len() == cases.len(), "{}", suite.name);
                for arm in cases.iter().flat_map(|c| &c.arms) {
                    assert!(arm.choice().is_ok(), "{}: {arm:?}", suite.name);
                }
            }
        }
    }
}
