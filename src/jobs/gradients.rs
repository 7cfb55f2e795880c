//! `--gradients`: how a frame changes with triangles and the camera, computed after it, and the files with that.

use super::Backend;
use super::options::Gradients as Named;
use crate::arrays::MapEach;
use crate::camera::Camera;
use crate::camera::change::{PixelRay, rate};
use crate::engine::stage::gradient::Gradient;
use crate::image::{write_npy, write_text};
use crate::input::{Error, Loading, Result};
use crate::reference::gradient::{Direction, PixelChange, changes};
use crate::scene::Scene;
use crate::scene::file::CameraKeys;
use crate::scene::gradients::{
    Array, Asked, Changes, Collected, Edges, Gradients, HIT_NUMBERS, NONE, Numbers, Parameter, Seen,
};
use serde_json::json;
use std::path::{Path, PathBuf};

/// The gradients of a frame whose pixels show the triangles `ids`, by the same renderer. `keys` are those of the camera.
///
/// # Errors
/// [`Error::Input`] if the camera has no such number, or its rays do not change smoothly with one; [`Error::Work`] if memory does not suffice
/// or the device fails.
pub fn gradients_of(
    backend: &Backend,
    (scene, camera, keys): (&Scene, &Camera, &CameraKeys),
    ids: &[u32],
    asked: &Asked,
) -> Result<Gradients> {
    let size = (camera.width, camera.height);
    asked.check_memory(size, scene.limits)?;
    // the numbers of a camera may lie in a file, which is read here
    let loading = &Loading::new(scene.limits);
    let number = |key| Ok((key, keys.number(key, loading)?));
    let numbers: Vec<(&str, f64)> = asked.numbers().map(number).collect::<Result<_>>()?;
    let rays = camera.pixel_rays(asked.has_coverage());
    let corners = |id: u32| scene.mesh.triangles[id as usize].map_each(|v| scene.mesh.positions[v as usize]);
    let (width, height) = size;
    let seen = Seen { width, height, rays: &rays, ids, corners: &corners, has_edges: asked.has_coverage() };
    let kernels = match backend {
        Backend::Compute(engine, _) => Some(Gradient::new(&engine.gpu, seen.has_edges)?),
        Backend::Reference => None,
    };
    let changes = |rates: Option<&[PixelRay]>| match &kernels {
        Some(kernels) => kernels.changes(&seen, rates),
        None => Ok(by_reference(&seen, rates)),
    };
    let mut collected = Collected::new(asked, size);
    if asked.has_vertices() {
        collected.add_vertices(changes(None)?);
    }
    let mut parameters = Vec::new();
    for (k, (key, value)) in numbers.iter().enumerate() {
        let name = format!("camera.{key}");
        let of_value = |value| {
            let spec = keys.with_number(key, value, loading)?;
            Camera::in_scene(&spec, Some(size), scene.surroundings(), loading)
        };
        let rate = rate(camera, (&name, *value), &of_value, seen.has_edges)?;
        collected.add_number((k, numbers.len()), changes(Some(&rate.rays))?);
        parameters.push(Parameter { name, value: *value, step: rate.step, error: rate.error });
    }
    Ok(Gradients { width, height, parameters, arrays: collected.arrays(ids) })
}

/// By the reference, in the engine's form.
fn by_reference(seen: &Seen, rates: Option<&[PixelRay]>) -> Changes {
    let one = [Direction { rays: rates, coordinate: None }];
    let vertices = Direction::vertices();
    let directions: &[Direction] = if rates.is_some() { &one } else { &vertices };
    let mut all = Changes::default();
    for PixelChange { hit, edge, .. } in changes(seen, directions) {
        let hit = if hit.is_empty() { vec![[0.0; HIT_NUMBERS]; directions.len()] } else { hit };
        all.hits.extend(hit.into_iter().flatten().map(|number| number as f32));
        if !seen.has_edges {
            continue;
        }
        let Edges { coverage, triangle, pixels } = &mut all.edges;
        coverage.push(edge.as_ref().map_or(1.0, |edge| edge.coverage as f32));
        triangle.push(edge.as_ref().map_or(NONE, |edge| edge.triangle));
        pixels.push(edge.as_ref().map_or([NONE; 2], |edge| edge.pixels));
        let change = edge.map_or(vec![0.0; directions.len()], |edge| edge.change);
        all.coverage.extend(change.into_iter().map(|number| number as f32));
    }
    all
}

impl Named {
    /// The file of an array.
    fn file(&self, name: &str) -> PathBuf {
        self.folder.join(format!("gradient.{name}.npy"))
    }

    /// The file that says what the arrays hold.
    pub fn list(&self) -> PathBuf {
        self.folder.join("gradient.json")
    }

    /// The files of all arrays.
    pub fn files(&self) -> Vec<PathBuf> {
        self.asked.names().iter().map(|name| self.file(name)).collect()
    }

    /// Makes the folder.
    ///
    /// # Errors
    /// [`Error::Write`] if that fails.
    pub fn make_folder(&self) -> Result<()> {
        let folder: &Path = &self.folder;
        std::fs::create_dir_all(folder)
            .map_err(|e| Error::unwritable(folder, format_args!("cannot make this folder: {e}")))
    }

    /// Writes all files.
    ///
    /// # Errors
    /// [`Error::Write`] if one cannot be written.
    pub fn write(&self, gradients: &Gradients) -> Result<()> {
        for Array { name, shape, numbers } in &gradients.arrays {
            let shape: Vec<u64> = shape.iter().map(|side| *side as u64).collect();
            match numbers {
                Numbers::F32(numbers) => write_npy(&self.file(name), &shape, numbers)?,
                Numbers::U32(numbers) => write_npy(&self.file(name), &shape, numbers)?,
            }
        }
        write_text(&self.list(), &described(gradients)?)
    }
}

/// What the arrays hold, as JSON.
pub fn described(gradients: &Gradients) -> Result<String> {
    let parameter = |p: &Parameter| json!({ "name": p.name, "value": p.value, "step": p.step, "origin_error": p.error[0], "direction_error": p.error[1] });
    let array = |a: &Array| json!({ "name": a.name, "shape": a.shape });
    let value = json!({
        "gradients": gradients.arrays.iter().map(array).collect::<Vec<_>>(),
        "camera": gradients.parameters.iter().map(parameter).collect::<Vec<_>>(),
    });
    let text = serde_json::to_string_pretty(&value).map_err(|e| Error::work(format!("gradients as JSON: {e}")))?;
    Ok(text + "\n")
}
