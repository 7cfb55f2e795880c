//! Tables of surfaces, per slot of a chunk. They are made when they are uploaded, and not kept on the host.

use super::Chunk;
use crate::geometry::mesh::{Mesh, NO_NORMAL};
use crate::gpu::layout::ID_MASK;
use crate::parallel;

impl Chunk {
    /// Per slot: the normals of the corners in file order, and the material.
    pub fn surfaces(&self, mesh: &Mesh) -> Vec<[u32; 4]> {
        self.per_slot(|id| {
            let [a, b, c] = mesh.corner_normals.get(id as usize).copied().unwrap_or([NO_NORMAL; 3]);
            [a, b, c, mesh.material_of[id as usize]]
        })
    }

    /// The table of surfaces without texture coordinates, and its rows per triangle: 1, or 0 if all triangles share the only row.
    pub fn plain_surfaces(&self, mesh: &Mesh) -> (Vec<[u32; 4]>, u32) {
        match mesh.corner_normals.is_empty() && mesh.materials.len() <= 1 {
            true => (vec![[NO_NORMAL, NO_NORMAL, NO_NORMAL, 0]], 0),
            false => (self.surfaces(mesh), 1),
        }
    }

    /// Texture coordinates, six numbers a slot: of the corners in file order, v downwards; NaN where a triangle has none.
    pub fn uvs(&self, mesh: &Mesh) -> Vec<[f32; 6]> {
        self.per_slot(|id| {
            let Some([a, b, c]) = mesh.uvs_of(id as usize) else { return [f32::NAN; 6] };
            [a.x, 1.0 - a.y, b.x, 1.0 - b.y, c.x, 1.0 - c.y]
        })
    }

    /// Colors, nine numbers a slot: of the corners in file order.
    fn colors(&self, mesh: &Mesh) -> Vec<[f32; 9]> {
        self.per_slot(|id| {
            let colors = mesh.colors_of(id as usize);
            std::array::from_fn(|k| colors[k / 3][k % 3])
        })
    }

    /// The table that kernels read for surfaces with texture coordinates.
    pub fn mapped_surfaces(&self, mesh: &Mesh) -> Vec<[[u32; 4]; 3]> {
        mapped_surfaces(&self.surfaces(mesh), &self.uvs(mesh))
    }

    /// The table that kernels read for surfaces with colors at their corners: per slot three vec4s as in [`mapped_surfaces`], whose last
    /// number is the first of nine, and two more vec4s.
    pub fn colored_surfaces(&self, mesh: &Mesh) -> Vec<[[u32; 4]; 5]> {
        let (mapped, colors) = (self.mapped_surfaces(mesh), self.colors(mesh));
        let colored = |([own, ab, [u, v, is_mapped, _]], colors): (&[[u32; 4]; 3], &[f32; 9])| {
            let [a, b, c, d, e, f, g, h, i] = colors.map(f32::to_bits);
            [*own, *ab, [*u, *v, *is_mapped, a], [b, c, d, e], [f, g, h, i]]
        };
        mapped.iter().zip(&colors).map(colored).collect()
    }

    /// Calls `of` with the id of each slot's triangle.
    fn per_slot<T: Send>(&self, of: impl Fn(u32) -> T + Sync) -> Vec<T> {
        parallel::map(&*self.triangles, |triangle| of(triangle[3] & ID_MASK))
    }
}

/// The table that kernels read for surfaces with texture coordinates: per slot the row of `surfaces`, then two vec4s with the texture
/// coordinates of the three corners and a flag, 1 if the triangle has any.
pub fn mapped_surfaces(surfaces: &[[u32; 4]], uvs: &[[f32; 6]]) -> Vec<[[u32; 4]; 3]> {
    let mapped = |(own, uv): (&[u32; 4], &[f32; 6])| {
        let is_mapped = u32::from(uv.iter().all(|v| v.is_finite()));
        let [a, b, c, d, e, f] = uv.map(f32::to_bits);
        [*own, [a, b, c, d], [e, f, is_mapped, 0]]
    };
    surfaces.iter().zip(uvs).map(mapped).collect()
}
