//! `anamorph compare`: the error of one EXR against another.

use super::args::{Change, CompareArgs};
use super::print;
use super::progress::Progress;
use super::render::load;
use crate::compare::{Comparison, compare};
use crate::error::{Error, Result};
use crate::frame::{Channel, Frame};
use crate::output::read_exr;
use crate::reference::image;
use crate::report::Judged;
use serde::Serialize;
use std::path::Path;

pub fn run(args: &CompareArgs) -> Result<()> {
    let progress = Progress::start("comparing");
    let (a, b) = (read_exr(&args.a)?, read_exr(&args.b)?);
    let (text, json) = match &args.scene {
        None => {
            let comparison = compare(&a, &b, None, None)?;
            (comparison.to_string(), to_json(&comparison)?)
        }
        Some(scene) => {
            // sizes first: judging takes long
            compare(&a, &b, None, None)?;
            let judged = with_scene(args, scene, &a, &b)?;
            (format!("{}, {} not near", judged.comparison, judged.not_near), to_json(&judged)?)
        }
    };
    drop(progress);
    print(&format!("{}\n", if args.json { json } else { text }))
}

/// A against B, with the reference's word on which pixels are safe and on the ids of A.
fn with_scene(args: &CompareArgs, path: &Path, a: &Frame, b: &Frame) -> Result<Judged> {
    if a.u32(Channel::TriangleId).is_none() {
        let a = args.a.display();
        return Err(Error::input(format!(
            "{a}: no channel triangle.id, which --scene is about; render it with that channel"
        )));
    }
    let (scene, camera) = load(path, &Change { size: Some((a.width, a.height)), ..Change::default() })?;
    let judgement = image::judge(&scene, &camera, a);
    let comparison: Comparison = compare(a, b, Some(&judgement.safe), Some(&judgement.scales))?;
    Ok(Judged { comparison, not_near: judgement.not_near })
}

fn to_json(value: &impl Serialize) -> Result<String> {
    serde_json::to_string_pretty(value).map_err(|e| Error::work(format!("comparison as JSON: {e}")))
}
