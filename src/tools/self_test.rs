//! The self-test: examples, small, by the kernels against the reference, as `render --check` compares them.

use crate::arrays::MapEach;
use crate::engine::plan::Wanted;
use crate::engine::{Engine, RunOptions};
use crate::gpu::GpuOptions;
use crate::gpu::device::{AdapterFeatures, NO_ADAPTER};
use crate::gpu::kernels::{RaysKind, Variant};
use crate::input::{Error, Loading, Result};
use crate::jobs::judged::judge;
use crate::scene::Scene;
use crate::tools::example::{EXAMPLES, Example};
use serde::{Deserialize, Serialize};
use std::fmt;
use std::sync::Arc;

/// Small images that end within tiles; the second size is of the fallback.
const SIZES: [[u32; 2]; 2] = [[150, 115], [131, 101]];

/// Its ray map has a size of its own.
const OWN_SIZE: &str = "fisheye";

/// Examples that the fallback renders too: all need the same few kernels, which may take long to compile.
const BY_FALLBACK: [&str; 14] = [
    "demo",
    "pinhole",
    "orthographic",
    "pushbroom",
    "cross-slit",
    "pencil",
    "bilinear",
    "mesh",
    "columns",
    "city-cross-slit",
    "terrain-top-down",
    "terrain-bottom-up",
    "opposite",
    "city-cylinder",
];

/// A frame of the self-test.
pub struct View {
    example: &'static Example,
    /// Without the adapter's f64 and 64-bit atomics.
    fallback: bool,
}

/// All frames: every example, then some by the fallback.
pub fn views() -> Vec<View> {
    let again = EXAMPLES.iter().filter(|e| BY_FALLBACK.contains(&e.name));
    let all = EXAMPLES.iter().map(|example| View { example, fallback: false });
    all.chain(again.map(|example| View { example, fallback: true })).collect()
}

/// A frame against the reference.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct Tested {
    pub scene: String,
    pub size: [u32; 2],
    /// The kernels that ran.
    pub kernels: String,
    /// Whose answer changes within 1/16 px.
    pub uncertain: u64,
    /// Uncertain pixels with another of the triangles near them.
    pub other: u64,
    /// Pixels whose triangle neither the reference nor a near candidate is.
    pub wrong: u64,
    /// Of 99.9 % of the pixels t is not further off, relative.
    pub t_p999: Option<f64>,
    /// Of colour; `None`: the same.
    pub psnr: Option<f64>,
    /// Why there is no frame.
    pub failed: Option<String>,
}

/// The devices of the self-test, opened when a frame first needs them.
pub struct Tester {
    options: GpuOptions,
    engine: Option<(bool, Engine)>,
}

impl Tester {
    pub fn new(options: &GpuOptions) -> Tester {
        Tester { options: options.clone(), engine: None }
    }

    pub fn test(&mut self, view: &View) -> Tested {
        self.try_to_test(view).unwrap_or_else(|e| {
            // a lost device stays lost
            self.engine = None;
            Tested { scene: view.example.name.into(), failed: Some(e.to_string()), ..Default::default() }
        })
    }

    fn try_to_test(&mut self, view: &View) -> Result<Tested> {
        let folder = tempfile::tempdir().map_err(|e| Error::work(format!("no temporary folder: {e}")))?;
        let path = view.example.write(folder.path())?;
        let [width, height] = SIZES[usize::from(view.fallback)];
        let size = [format!("image.width={width}"), format!("image.height={height}")];
        let overrides: &[String] = if view.example.name == OWN_SIZE { &[] } else { &size };
        let scene = Scene::load(&path, overrides, 0.0, &Loading::default())?;
        let camera = Arc::new(scene.camera()?);
        let engine = self.engine(view.fallback)?;
        let wanted = Wanted::of(camera.channels());
        let frames = engine.prepare(&scene, camera.clone(), &wanted, &RunOptions::default())?;
        let kernels = kernels(frames.variant(), engine.gpu.has);
        let rendered = frames.finish()?;
        let judged = judge(&scene, &camera, &rendered, &rendered, 1)?;
        let seen = judged.comparison;
        let [uncertain, different, wrong_safe] =
            [seen.unsafe_pixels, seen.wrong_triangle, seen.wrong_safe].map_each(Option::unwrap_or_default);
        let wrong = judged.not_near.max(wrong_safe);
        let finite = |value: f64| Some(value).filter(|v| v.is_finite());
        Ok(Tested {
            scene: view.example.name.into(),
            size: [camera.width, camera.height],
            kernels,
            uncertain,
            other: different.saturating_sub(wrong),
            wrong,
            t_p999: seen.t_relative.and_then(|t| finite(t.p999.0)),
            psnr: seen.psnr.and_then(finite),
            failed: None,
        })
    }

    /// The fallback's, or the other one; the other of both is closed.
    fn engine(&mut self, fallback: bool) -> Result<&mut Engine> {
        if self.engine.as_ref().is_none_or(|engine| engine.0 != fallback) {
            let options = GpuOptions { no_f64: fallback, no_int64: fallback, ..self.options.clone() };
            let engine = Engine::open(&options)?.ok_or_else(|| Error::work(NO_ADAPTER))?;
            self.engine = Some((fallback, engine));
        }
        self.engine.as_mut().map(|engine| &mut engine.1).ok_or_else(|| Error::work(NO_ADAPTER))
    }
}

/// The variant of the kernels, in words.
fn kernels(variant: Variant, has: AdapterFeatures) -> String {
    let rays = match variant.rays.kind {
        RaysKind::Pieces => "pieces".into(),
        RaysKind::Field { .. } => "a ray a pixel".into(),
        RaysKind::Curves { degree } => format!("curves of degree {degree}"),
    };
    let raster = match variant.tiles() {
        Some(tiles) if tiles.wide => "tile by tile, several tiles a subgroup",
        Some(_) => "tile by tile, a tile a subgroup",
        None => "pair by pair",
    };
    let depths = if variant.bounds_t_in_raster() { ", its depths bounded in f32" } else { "" };
    let small = if variant.draws_small() { "small triangles by small" } else { "all triangles by bin" };
    let f64 = if has.f64 { "f64" } else { "f64 in 32-bit words" };
    let atomics = if variant.path.atomics64 { "64-bit atomics" } else { "32-bit atomics" };
    format!("{rays}; {raster}{depths}; {small}; {f64}; {atomics}")
}

impl Tested {
    #[cfg(feature = "internals")]
    pub fn is_right(&self) -> bool {
        self.failed.is_none() && self.wrong == 0
    }

    #[cfg(feature = "internals")]
    pub fn pixels(&self) -> u64 {
        u64::from(self.size[0]) * u64::from(self.size[1])
    }
}

impl fmt::Display for Tested {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match &self.failed {
            Some(why) => write!(f, "{:<22} FAILED: {why}", self.scene),
            None => {
                let (wrong, uncertain) = (self.wrong, self.uncertain);
                let mark = if wrong > 0 { "WRONG: " } else { "" };
                write!(f, "{:<22} {mark}{wrong} pixels wrong, {uncertain} uncertain; {}", self.scene, self.kernels)
            }
        }
    }
}

/// What the frames came to, in a line.
#[cfg(feature = "internals")]
pub fn result(frames: &[Tested]) -> String {
    let sum = |of: fn(&Tested) -> u64| frames.iter().map(of).sum::<u64>();
    let (pixels, wrong, uncertain) = (sum(Tested::pixels), sum(|f| f.wrong), sum(|f| f.uncertain));
    let failed = frames.iter().filter(|f| f.failed.is_some()).count();
    let word = if frames.iter().all(Tested::is_right) { "right" } else { "WRONG" };
    let (done, all) = (frames.len(), views().len());
    format!(
        "{word}: {done} of {all} frames, {pixels} pixels: {wrong} wrong, {uncertain} uncertain; {failed} frames failed"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_are_72_frames_and_a_wrong_pixel_is_told() {
        assert_eq!((views().len(), views().iter().filter(|v| v.fallback).count()), (72, BY_FALLBACK.len()));
        let right = Tested { scene: "demo".into(), ..Default::default() };
        let wrong = Tested { wrong: 1, ..right.clone() };
        let failed = Tested { failed: Some("device lost".into()), ..right.clone() };
        assert!(right.is_right() && !wrong.is_right() && !failed.is_right());
        assert!(
            result(&[right]).starts_with("right: 1 of 72") && result(std::slice::from_ref(&wrong)).starts_with("WRONG")
        );
        assert!(wrong.to_string().contains("WRONG: 1 pixels") && failed.to_string().contains("FAILED: device lost"));
    }
}
