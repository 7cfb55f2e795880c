//! Whole calls of an arm, beside its frames: each begins with a scene and a camera in memory and nothing of them on the device, and ends with
//! arrays.

use super::row::Calls;
use anamorph::internals::camera::Camera;
use anamorph::internals::engine::plan::Wanted;
use anamorph::internals::engine::{Engine, RunOptions};
use anamorph::internals::input::Result;
use anamorph::internals::scene::Scene;
use std::time::Instant;

/// Calls of an arm.
const CALLS: usize = 3;

/// An arm whose first call takes longer has no other, ms.
const ONCE_MS: f64 = 3000.0;

/// Renders through all `cameras` in each call: one, or one for each sample whose frame is its own.
///
/// # Errors
/// [`anamorph::Error`] if the frame fails, as for want of memory beside the frames that are there.
pub fn calls(
    engine: &mut Engine,
    scene: &Scene,
    cameras: &[&Camera],
    wanted: &Wanted,
    options: &RunOptions,
) -> Result<Calls> {
    let (mut calls, mut frames) = (Vec::new(), Vec::new());
    while calls.len() < CALLS && calls.iter().all(|ms| *ms <= ONCE_MS) {
        let started = Instant::now();
        let mut frame_ms = 0.0;
        for camera in cameras {
            frame_ms += engine.render(scene, (*camera).clone(), wanted, options)?.frame_ms.iter().sum::<f64>();
        }
        calls.push(started.elapsed().as_secs_f64() * 1e3);
        frames.push(frame_ms);
    }
    Ok(Calls::of(&calls, &frames))
}
