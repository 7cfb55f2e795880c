//! Triangles as every loader and generator returns them, in f64.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// Marks a corner without a normal in [`Mesh::corner_normals`].
pub const NO_NORMAL: u32 = u32::MAX;

/// Triangles over shared positions. Triangle `k` of the mesh is triangle `k` in file order, so ids
/// follow from the position in `triangles` alone.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Mesh {
    /// Positions in f64: object space as loaded, world space once placed in a scene.
    pub positions: Vec<DVec3>,
    /// Three indices into `positions` a triangle.
    pub triangles: Vec<[u32; 3]>,
    /// Unit normals; empty when the source has none.
    pub normals: Vec<Vec3>,
    /// Three indices into `normals` a triangle ([`NO_NORMAL`]: none); empty when `normals` is.
    pub corner_normals: Vec<[u32; 3]>,
    /// At least one once there is a triangle.
    pub materials: Vec<Material>,
    /// One index into `materials` a triangle.
    pub material_of: Vec<u32>,
}

impl Mesh {
    /// The corners of the box around all vertices; `None` without any.
    pub fn bounds(&self) -> Option<(DVec3, DVec3)> {
        let one = |p: &DVec3| (*p, *p);
        self.positions.par_iter().map(one).reduce_with(|a, b| (a.0.min(b.0), a.1.max(b.1)))
    }
}

/// What a triangle looks like.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    pub name: String,
    /// Linear RGB reflectance in [0, 1].
    pub diffuse: [f32; 3],
    /// Both faces are visible.
    pub two_sided: bool,
}

impl Default for Material {
    /// Light grey, both faces visible.
    fn default() -> Self {
        Material { name: "default".into(), diffuse: [0.8; 3], two_sided: true }
    }
}
