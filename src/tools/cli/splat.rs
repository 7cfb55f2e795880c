//! `anamorph splat`: points as a picture, through any camera that `project` handles.

use super::args::SplatArgs;
use super::progress::Progress;
use super::project::refuse_optics;
use super::say::note;
use crate::geometry::ply::load_points;
use crate::image::{read_points, write_exr, write_npy, write_png};
use crate::input::{Error, Loading, Result};
use crate::jobs::splat::splat;
use crate::jobs::{load_shape, named_as, outputs};
use glam::DVec3;
use std::path::Path;

pub fn run(args: &SplatArgs) -> Result<()> {
    args.device.check()?;
    let files = [
        (&args.output, outputs::PICTURE),
        (&args.exr, outputs::EXR),
        (&args.depth, outputs::RAYS),
        (&args.index, outputs::RAYS),
    ];
    named_as(args.output.as_deref(), "png", "colour is written as PNG; name it .png, or use --exr")?;
    named_as(args.exr.as_deref(), "exr", "this output is written as EXR; name it .exr, or use -o for a PNG")?;
    if files.iter().all(|(path, _)| path.is_none()) {
        return Err(Error::input(
            "nothing to write; add -o OUT.png, --exr OUT.exr, --depth OUT.npy or --index OUT.npy",
        ));
    }
    let progress = Progress::start("building the camera");
    let loading = Loading::new(args.caps.limits());
    let (points, colors) = read(&args.points, &loading)?;
    let (_, camera) = load_shape(&args.scene, &args.change, &loading)?;
    drop(progress);
    refuse_optics(&camera)?;
    outputs::check(&loading.into_inputs(), files.iter().filter_map(|(path, kind)| Some((path.as_deref()?, *kind))))?;
    let gpu = args.device.open(points.len())?;
    let progress = Progress::start("splatting");
    let all = splat(&camera, &points, gpu.as_ref())?;
    drop(progress);
    if all.degenerate > 0 {
        note(format_args!(
            "{} points are on a slit or an eye of the camera: their curves and areas of images are not drawn",
            all.degenerate
        ));
    }
    let (width, height) = (all.width, all.height);
    let shape = [height.into(), width.into()];
    let colors = colors.as_deref();
    args.output.as_ref().map_or(Ok(()), |path| write_png(path, width, height, &all.rgba(colors)))?;
    args.exr.as_ref().map_or(Ok(()), |path| write_exr(path, &all.frame(colors), &[]))?;
    args.depth.as_ref().map_or(Ok(()), |path| write_npy(path, &shape, &all.t))?;
    args.index.as_ref().map_or(Ok(()), |path| write_npy(path, &shape, &all.index))
}

/// Points, and their colours (linear) if the file has some.
type Cloud = (Vec<DVec3>, Option<Vec<[f32; 3]>>);

fn read(path: &Path, loading: &Loading) -> Result<Cloud> {
    let is = |ending: &str| path.extension().is_some_and(|e| e.eq_ignore_ascii_case(ending));
    if !is("ply") {
        let is_text = ["npy", "csv", "txt", "xyz"].into_iter().any(is);
        if !is_text {
            let name = path.display();
            return Err(Error::input(format!(
                "{name}: points are read from .ply, .npy, .csv, .txt or .xyz files only"
            )));
        }
        return Ok((read_points(path, loading)?, None));
    }
    let points = load_points(path, loading)?;
    match points.centres.iter().position(|p| !p.is_finite()) {
        Some(k) => Err(Error::input(format!("{}: vertex {k} is not finite; leave it out", path.display()))),
        None => Ok((points.centres, points.colors)),
    }
}
