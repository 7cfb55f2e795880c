//! `anamorph camera`: what a scene's camera compiled to, and the keys of each kind.

use super::args::{CameraArgs, Cli};
use super::describe::Description;
use super::render::load_shape;
use super::{diagram, export, kinds, memory, outputs, povray, print};
use crate::error::{Error, Result};
use clap::CommandFactory;
use std::path::PathBuf;

/// A number of a pixel's rays, 8 bytes, takes the memory of half a channel: 4 copies of 4 bytes each.
const NUMBERS_A_CHANNEL: usize = 2;

pub fn run(args: &CameraArgs) -> Result<()> {
    if let Some(kind) = &args.help {
        return help(kind.as_deref());
    }
    let Some(path) = &args.scene else { return Err(Error::input("no scene given; see anamorph camera --help")) };
    let (scene, camera) = load_shape(path, &args.change)?;
    let files = args.export.iter().chain(&args.export_povray).chain(&args.rays).chain(&args.diagram);
    outputs::check(path, files.map(PathBuf::as_path))?;
    if args.rays.is_some() || args.export_povray.is_some() {
        let numbers: usize = export::pixel_shape(&camera).iter().product();
        memory::check(camera.width, camera.height, numbers.div_ceil(NUMBERS_A_CHANNEL), 0)?;
    }
    if let Some(file) = &args.export {
        export::write_pieces(file, &scene.camera, &camera)?;
    }
    if let Some(file) = &args.export_povray {
        povray::write(file, &scene, &camera)?;
    }
    if let Some(file) = &args.rays {
        export::write_rays(file, &camera)?;
    }
    if let (Some(file), Some(_)) = (&args.diagram, &camera.optics) {
        let (file, kind) = (file.display(), camera.kind);
        return Err(Error::input(format!(
            "--diagram {file}: {kind} turns rays, which is not drawn; use --rays RAYS.npy"
        )));
    }
    if let Some(file) = &args.diagram {
        diagram::write(file, &scene.mesh, &camera)?;
    }
    print(&Description::of(&camera).to_string())
}

/// The keys of one kind, or the command's own help.
fn help(kind: Option<&str>) -> Result<()> {
    if let Some(kind) = kind {
        return print(kinds::keys(kind)?);
    }
    let mut command = Cli::command();
    command.build();
    let Some(command) = command.find_subcommand_mut("camera") else { return Err(Error::work("no such command")) };
    let text = command.render_help();
    print(&format!("{text}\nKinds of camera: {}\n", kinds::names().join(", ")))
}
