//! The `chain` camera: mesh cameras over one image, whose rays are traversed one after the other (Popescu et al.,
//! section 3.1: segments, depth-indexed from the root to the leaves).

use super::recipe::{Built, Recipe, Setting};
use super::{LAYERS_MAX, Pieces, Rays, mesh};
use crate::camera::mesh::spec::{MESH_CAMERA_KEYS, MeshCameraSpec, read_mesh_camera};
use crate::camera::values::of_part;
use crate::input::reader::{Field, Table};
use crate::input::{Error, Result};
use crate::parallel;
use glam::DVec3;
use std::sync::Arc;

#[derive(Debug, PartialEq)]
struct Chain {
    layers: Vec<MeshCameraSpec>,
}

/// Reads `layers`, a list of tables with the keys of a `mesh` camera, and optionally its kind.
pub fn read(table: &Table) -> Result<Arc<dyn Recipe>> {
    table.allow(&["kind", "layers"])?;
    let field = table.need("layers", "[{ file = \"near.json\" }, { file = \"far.json\" }]")?;
    let layers: Vec<_> = field.items("a list of layers")?.map(|layer| read_layer(&layer)).collect::<Result<_>>()?;
    if layers.is_empty() || layers.len() > LAYERS_MAX {
        return Err(field.error(format_args!("{} layers; a chain has 1 to {LAYERS_MAX}", layers.len())));
    }
    Ok(Arc::new(Chain { layers }))
}

fn read_layer(field: &Field) -> Result<MeshCameraSpec> {
    let table = field.table()?;
    if let Some(kind) = table.get("kind").filter(|kind| kind.text() != Ok("mesh")) {
        return Err(kind.error("a layer of a chain is a mesh camera; write kind = \"mesh\", or leave it out"));
    }
    table.allow(&[&["kind"], &MESH_CAMERA_KEYS[..]].concat())?;
    read_mesh_camera(&table)
}

impl Recipe for Chain {
    fn build(&self, setting: &Setting) -> Result<Built> {
        let (width, height) = setting.size()?;
        let mut notes = Vec::new();
        let mut layers: Vec<Pieces> = Vec::new();
        for (k, spec) in self.layers.iter().enumerate() {
            let mut of_layer = Vec::new();
            // the pieces say "camera.KEY: ...", of the table that they are read from
            let pieces = mesh::compile(spec, (width, height), &mut of_layer, setting.limits())
                .map_err(|e| Error::input(of_part(format_args!("camera.layers.{k}"), &e)))?;
            notes.extend(of_layer.into_iter().map(|note| format!("layer {k}: {note}")));
            layers.push(pieces);
        }
        for (k, pair) in layers.windows(2).enumerate() {
            notes.extend(gap_note(k, &pair[0], &pair[1], (width, height)));
        }
        let layers = layers.into_iter().map(Rays::Pieces).collect();
        Ok(Built { t_range: Some([0.0, 1.0]), notes: notes.into(), ..Built::of_layers((width, height), layers) })
    }
}

/// Relative rounding of a ray's end: some ten products and sums of 2^-53 each, with a margin for corners far outside the
/// image, whose weights are larger than 1.
const END_ROUNDING: f64 = 1.0 / (1u64 << 40) as f64;

/// A note if the rays of a layer do not start where those of the previous one end.
fn gap_note(k: usize, front: &Pieces, back: &Pieces, (width, height): (u32, u32)) -> Option<String> {
    let at = |n: usize| ((n % width as usize) as u32, (n / width as usize) as u32);
    let of_pixel = |n: usize| Some((gap(front, back, at(n))?, n));
    let larger = |a: (f64, usize), b: (f64, usize)| if (b.0, a.1) > (a.0, b.1) { b } else { a };
    let (gap, n) = parallel::reduce(0..width as usize * height as usize, of_pixel, larger)?;
    let (i, j) = at(n);
    let next = k + 1;
    (gap > 0.0)
        .then(|| format!("layer {next} does not start where layer {k} ends: up to {gap:.6} apart, at pixel {i},{j}"))
}

/// Gap of the pixel's ray between two layers, world units; 0 within rounding.
fn gap(front: &Pieces, back: &Pieces, (i, j): (u32, u32)) -> Option<f64> {
    let ray = |layer: &Pieces| layer.owner(i, j).map(|k| layer.bundle_at(k, i, j).ray(0.0, 0.0));
    let (a, b) = (ray(front)?, ray(back)?);
    let end = a.origin + a.direction;
    let size = |v: DVec3| v.abs().max_element();
    let gap = (b.origin - end).length();
    let rounding = END_ROUNDING * (size(a.origin) + size(a.direction) + size(b.origin));
    Some(if gap > rounding { gap } else { 0.0 })
}
