//! `anamorph camera`: what a scene's camera compiled to, and the keys of each kind.

use super::args::{CameraArgs, Cli};
use super::progress::Progress;
use super::say::print;
use super::{diagram, export, povray};
use crate::camera::Camera;
use crate::camera::describe::Description;
use crate::camera::kinds::KINDS;
use crate::camera::recipe::Kind;
use crate::geometry::texture::ImagesRead;
use crate::image::read_exr_texts;
use crate::input::tree::did_you_mean;
use crate::input::{Error, Loading, Result};
use crate::jobs::outputs;
use crate::jobs::{CAMERA, check_memory, load_shape};
use crate::scene::library::Library;
use crate::scene::{Scene, file};
use clap::CommandFactory;
use std::path::Path;
use std::sync::Arc;

/// A number of a pixel's rays, 8 bytes, takes the memory of half a channel: 4 copies of 4 bytes each.
const NUMBERS_A_CHANNEL: usize = 2;

pub fn run(args: &CameraArgs) -> Result<()> {
    if let Some(kind) = &args.help {
        return help(kind.as_deref());
    }
    let Some(path) = &args.scene else { return Err(Error::input("no scene given; see anamorph camera --help")) };
    let is_picture = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("exr"));
    let progress = Progress::start("building the camera");
    let limits = args.caps.limits();
    let loading = Loading::new(limits);
    let (scene, camera) = match is_picture {
        true => load_picture(path, args, &loading)?,
        false => load_shape(path, &args.change, &loading)?,
    };
    progress.now("writing");
    let files = [
        (&args.export, outputs::PIECES),
        (&args.export_povray, outputs::POVRAY),
        (&args.rays, outputs::RAYS),
        (&args.diagram, outputs::DIAGRAM),
    ];
    outputs::check(
        &loading.into_inputs(),
        files.into_iter().filter_map(|(path, kind)| Some((path.as_deref()?, kind))),
    )?;
    if args.rays.is_some() || args.export_povray.is_some() {
        let numbers: usize = export::pixel_shape(&camera).iter().product();
        check_memory((camera.width, camera.height), numbers.div_ceil(NUMBERS_A_CHANNEL), 0, limits)?;
    }
    if let Some(file) = &args.export {
        export::write_pieces(file, &scene.camera, &camera, limits)?;
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
            "--diagram {file}: {kind} reflects or refracts rays, which diagrams do not show; use --rays RAYS.npy"
        )));
    }
    if let Some(file) = &args.diagram {
        scene.mesh.check_copies(scene.limits)?;
        diagram::write(file, &scene.mesh, &camera)?;
    }
    let description = Description::of(&camera).to_string();
    drop(progress);
    print(&description)
}

/// The camera in the header of an EXR, and the meshes that it looks at.
fn load_picture(path: &Path, args: &CameraArgs, loading: &Loading) -> Result<(Scene, Arc<Camera>)> {
    let name = path.display();
    if args.change.frame != 0.0 {
        return Err(Error::input(format!("--frame: {name} holds the camera of one frame only; leave --frame out")));
    }
    if let Some(file) = &args.export_povray {
        let file = file.display();
        return Err(Error::input(format!(
            "--export-povray {file}: {name} holds a camera but no scene; give the scene file"
        )));
    }
    let texts = read_exr_texts(path, loading)?;
    let text = texts.into_iter().find(|(name, _)| name == CAMERA).map(|(_, text)| text);
    let text = text
        .ok_or_else(|| Error::input(format!("{name}: its header holds no camera; give an EXR that anamorph wrote")))?;
    let file = file::load_header(&text, path, &args.change.set, loading)?;
    let library = Library::for_once();
    let at = |e: Error| e.at(path.display());
    let scene = library.scene(file, ImagesRead::Masks, loading).map_err(at)?;
    let camera = library.camera(&scene, args.change.size, loading).map_err(at)?;
    Ok((scene, camera))
}

/// The keys of one kind, or the command's own help.
fn help(kind: Option<&str>) -> Result<()> {
    if let Some(kind) = kind {
        return print(&keys(kind)?);
    }
    let mut command = Cli::command();
    command.build();
    let Some(command) = command.find_subcommand_mut("camera") else { return Err(Error::work("no such command")) };
    let text = command.render_help();
    print(&format!("{text}\nKinds of camera: {}\n", names().join(", ")))
}

fn names() -> Vec<&'static str> {
    KINDS.iter().map(|k| k.name).collect()
}

/// # Errors
/// [`Error::Input`] that lists the known kinds.
fn keys(kind: &str) -> Result<String> {
    KINDS.iter().find(|k| k.name == kind).map(Kind::whole_help).ok_or_else(|| {
        let (known, hint) = (names().join(", "), did_you_mean(kind, &names()));
        Error::input(format!("--help {kind}: no such kind of camera in this version{hint}; known: {known}"))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::recipe::POSE;

    #[test]
    fn poses_are_in_the_help_of_the_kinds_that_read_them() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("scene.toml");
        // these have an eye and a target in tables of their own
        let nested = ["bottom_up", "graph_camera", "mcop"];
        for kind in names() {
            // the error for an unknown key lists the known ones
            std::fs::write(&path, format!("[camera]\nkind = {kind:?}\nunknown = 1\n")).unwrap();
            let refusal = file::load(&path, &[], 0.0, &Loading::default()).unwrap_err().to_string();
            assert!(refusal.contains("unknown key \"unknown\""), "{refusal}");
            let reads = refusal.contains("quaternion") || nested.contains(&kind);
            let help = keys(kind).unwrap();
            assert_eq!(help.matches(POSE.trim_end()).count(), usize::from(reads), "{help}");
            assert!(help.ends_with('\n'));
        }
    }
}
