//! `mesh`: image triangles whose corners carry rays (Hou et al. 2006; Popescu's CGLC segments).

use crate::camera::Rays;
use crate::camera::mesh::compile;
use crate::camera::mesh::spec::{MESH_CAMERA_KEYS, MeshCameraSpec, read_mesh_camera};
use crate::camera::recipe::{Built, Recipe, Setting};
use crate::input::Result;
use crate::input::reader::Table;
use std::sync::Arc;

/// Reads the camera's table.
pub fn read(table: &Table) -> Result<Arc<dyn Recipe>> {
    table.allow(&[&["kind", "t_range"], &MESH_CAMERA_KEYS[..]].concat())?;
    Ok(Arc::new(read_mesh_camera(table)?))
}

impl Recipe for MeshCameraSpec {
    fn build(&self, setting: &Setting) -> Result<Built> {
        let (width, height) = setting.size()?;
        let mut notes = Vec::new();
        let pieces = compile(self, (width, height), &mut notes, setting.limits())?;
        Ok(Built { notes: notes.into(), ..Built::new((width, height), Rays::Pieces(pieces)) })
    }
}
