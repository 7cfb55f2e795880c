//! `anamorph compare`: the error of one EXR against another.

use super::args::CompareArgs;
use super::progress::Progress;
use super::say::print;
use crate::engine::report::Judged;
use crate::image::compare::{Comparison, compare};
use crate::image::frame::{Channel, Frame};
use crate::image::{read_exr, read_exr_texts};
use crate::input::{Error, Loading, Result};
use crate::jobs::{Change, load};
use crate::reference::image;
use crate::scene::hash::{SCENE_HASH, scene_hash};
use serde::Serialize;
use std::path::Path;

pub fn run(args: &CompareArgs) -> Result<()> {
    let progress = Progress::start("comparing");
    let loading = Loading::new(args.caps.limits());
    let (a, b) = (read_exr(&args.a, &loading)?, read_exr(&args.b, &loading)?);
    // finds different sizes and channels before the slow judgement
    let comparison = compare(&a, &b, None, None)?;
    let (text, json) = match &args.scene {
        None => (comparison.to_string(), to_json(&comparison)?),
        Some(scene) => {
            let (judged, notes) = with_scene(args, scene, (&a, &b), &loading)?;
            let text = format!("{}, {} not near", judged.comparison, judged.not_near);
            let text = notes.iter().fold(text, |text, note| format!("{text}\nnote: {note}"));
            (text, to_json(&JudgedWithNotes { judged, notes })?)
        }
    };
    drop(progress);
    print(&format!("{}\n", if args.json { json } else { text }))
}

/// The error, and notes that limit its meaning.
#[derive(Serialize)]
struct JudgedWithNotes {
    #[serde(flatten)]
    judged: Judged,
    notes: Vec<String>,
}

/// Compares A with B; the reference determines the safe pixels and judges the ids of A.
fn with_scene(
    args: &CompareArgs,
    path: &Path,
    (a, b): (&Frame, &Frame),
    loading: &Loading,
) -> Result<(Judged, Vec<String>)> {
    if a.u32(Channel::TriangleId).is_none() {
        let a = args.a.display();
        return Err(Error::input(format!(
            "{a}: no channel triangle.id, which --scene is about; render it with that channel"
        )));
    }
    let change = Change { size: Some((a.width, a.height)), set: args.set.clone(), frame: args.frame };
    let (scene, camera) = load(path, &change, loading)?;
    let own = format!("{:016x}", scene_hash(&scene, &camera));
    let mut notes = Vec::new();
    for file in [&args.a, &args.b] {
        let texts = read_exr_texts(file, loading)?;
        let of_file = texts.iter().find(|(name, _)| name == SCENE_HASH).map(|(_, hash)| hash);
        if of_file.is_some_and(|hash| *hash != own) {
            let (file, scene) = (file.display(), path.display());
            notes.push(format!(
                "{file} has another scene hash than {scene}: safe and near pixels are those of {scene}, and may be wrong for {file}; \
                 give the scene, --set and --frame that it was rendered with"
            ));
        }
    }
    notes.dedup();
    let judgement = image::judge(&scene, &camera, a);
    let comparison: Comparison = compare(a, b, Some(&judgement.safe), Some(&judgement.scales))?;
    Ok((Judged { comparison, not_near: judgement.not_near }, notes))
}

fn to_json(value: &impl Serialize) -> Result<String> {
    serde_json::to_string_pretty(value).map_err(|e| Error::work(format!("comparison as JSON: {e}")))
}
