//! `anamorph project`: every image of 3-D points, a JSON line a point.

use super::args::ProjectArgs;
use super::render::load;
use super::{outputs, print};
use crate::camera::project::{Images, Projector};
use crate::error::{Error, Result};
use crate::output::{read_points, write_text};
use glam::DVec3;
use rayon::prelude::*;
use serde::Serialize;
use std::path::PathBuf;

/// Points that are projected side by side before their lines are printed.
const CHUNK: usize = 1 << 14;

/// One line.
#[derive(Serialize)]
struct Line {
    point: [f64; 3],
    #[serde(flatten)]
    images: Images,
}

pub fn run(args: &ProjectArgs) -> Result<()> {
    let points = read_points(&args.points)?;
    let (_, camera) = load(&args.scene, &args.change)?;
    outputs::check(&args.scene, args.output.iter().map(PathBuf::as_path))?;
    let projector = Projector::new(&camera);
    let mut whole = String::new();
    for chunk in points.chunks(CHUNK) {
        let lines = chunk.par_iter().map(|p| line(&projector, *p)).collect::<Result<Vec<String>>>()?.concat();
        match &args.output {
            Some(_) => whole.push_str(&lines),
            None => print(&lines)?,
        }
    }
    args.output.as_ref().map_or(Ok(()), |file| write_text(file, &whole))
}

fn line(projector: &Projector, point: DVec3) -> Result<String> {
    let line = Line { point: point.to_array(), images: projector.project(point) };
    let text = serde_json::to_string(&line).map_err(|e| Error::work(format!("images as JSON: {e}")))?;
    Ok(text + "\n")
}
