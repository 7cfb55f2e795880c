//! `anamorph new`: a commented scene for the user's own model.

use super::args::NewArgs;
use super::keep::may_write;
use super::say::print;
use crate::image::write_text;
use crate::input::tree::did_you_mean;
use crate::input::{Error, Result};
use crate::tools::new::{Model, TASKS, list};
use std::path::{Path, PathBuf};

pub fn run(args: &NewArgs) -> Result<()> {
    let Some(name) = args.task.as_deref().filter(|_| !args.list) else {
        return print(&list());
    };
    let task = TASKS.iter().find(|task| task.name == name).ok_or_else(|| {
        let known: Vec<_> = TASKS.iter().map(|task| task.name).collect();
        Error::input(format!("no task {name:?}{}; known: {}", did_you_mean(name, &known), known.join(", ")))
    })?;
    let scene = args.output.clone().unwrap_or_else(|| PathBuf::from(format!("{name}.toml")));
    let model = match &args.mesh {
        None => Model::teapot()?,
        Some(path) => Model::read(path, &seen_from(&scene, path), args.up)?,
    };
    let text = model.scene(task, &scene.file_name().unwrap_or_default().to_string_lossy())?;
    may_write(&scene, text.as_bytes(), "--output")?;
    write_text(&scene, &text)?;
    print(&format!("{}\n", scene.display()))
}

/// The model's path as the scene names it: from the scene's folder, or absolute where that is another one.
fn seen_from(scene: &Path, model: &Path) -> String {
    let folder = scene.parent().unwrap_or(Path::new(""));
    let path = match model.strip_prefix(folder) {
        Ok(inside) => inside.to_owned(),
        Err(_) => std::path::absolute(model).unwrap_or_else(|_| model.to_owned()),
    };
    path.to_string_lossy().into_owned()
}
