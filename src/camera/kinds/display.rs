//! `display`: what a viewer sees through a curved screen, or a projector throws on it, given as a mesh with texture
//! coordinates.

use crate::camera::mesh::spec::{CameraVertex, MeshCameraSpec};
use crate::camera::recipe::{Built, Recipe, Setting};
use crate::geometry::obj::{Textured, load_textured};
use crate::input::Result;
use crate::input::reader::{Field, Table};
use glam::DVec3;
use std::sync::Arc;

/// A mesh camera: the screen's triangles where their texture coordinates lie in the image, near the eye, far on the screen.
#[derive(Debug, PartialEq)]
struct Display {
    mesh: MeshCameraSpec,
}

pub fn read(table: &Table) -> Result<Arc<dyn Recipe>> {
    table.allow(&["kind", "t_range", "eye", "mesh"])?;
    let eye = table.need("eye", "[0, 0, 0]")?.vec3()?;
    let path: Field = table.need("mesh", "\"screen.obj\"")?;
    Ok(Arc::new(Display { mesh: through(eye, &load_textured(&path.path()?, path.loading())?) }))
}

/// Every corner is a vertex of its own: pieces may join on the screen and not in the image, or the other way round.
fn through(eye: DVec3, screen: &Textured) -> MeshCameraSpec {
    let corner = |&(p, t): &(u32, u32)| {
        let [u, v] = screen.texcoords[t as usize].to_array();
        CameraVertex { image: [u, 1.0 - v], near: eye, far: screen.positions[p as usize], w: 1.0 }
    };
    let vertices = screen.triangles.iter().flatten().map(corner).collect();
    let triangles = (0..screen.triangles.len() as u32).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
    MeshCameraSpec { vertices, triangles, normalize: false }
}

impl Recipe for Display {
    fn build(&self, setting: &Setting) -> Result<Built> {
        setting.size()?;
        self.mesh.build(setting).map_err(|e| e.at("camera.mesh as a camera of kind mesh"))
    }
}
