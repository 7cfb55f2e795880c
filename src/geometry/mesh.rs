//! Triangles and spheres as every loader and generator returns them, in f64.

use super::instances::Run;
use super::opacity::Threshold;
use super::pattern::Pattern;
use super::primitive::Primitive;
use super::texture::Texture;
use crate::arrays::MapEach;
use crate::input::{Limits, Result};
use crate::parallel;
use glam::{DVec2, DVec3, Vec2, Vec3};
use std::fmt;

/// Most triangles a mesh, or a scene, may have.
pub const MAX_TRIANGLES: usize = 1 << 28;

/// Marks a corner without a normal in [`Mesh::corner_normals`].
pub const NO_NORMAL: u32 = u32::MAX;

/// Marks a corner without a texture coordinate in [`Mesh::corner_uvs`].
pub const NO_UV: u32 = u32::MAX;

/// Marks a corner without a colour in [`Mesh::corner_colors`].
pub const NO_COLOR: u32 = u32::MAX;

/// The least opacity of a surface whose file or key says no other.
pub const HALF: f32 = 0.5;

/// Triangles over shared positions. Triangle `k` of the mesh is triangle `k` in file order, so ids
/// follow from the position in `triangles` alone. Spheres and capsules have rows there too: two of their corners are one
/// vertex, so that code for triangles alone leaves them out as triangles without area.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Mesh {
    /// Positions in f64: object space as loaded, world space once placed in a scene.
    pub positions: Vec<DVec3>,
    /// Three indices into `positions` per triangle; of a sphere three times its centre, of a capsule one end and twice the other.
    pub triangles: Vec<[u32; 3]>,
    /// The radius of each sphere and capsule, 0 of each triangle; empty when there are triangles alone.
    pub radii: Vec<f64>,
    /// Whether some rows with a radius are capsules.
    pub has_capsules: bool,
    /// Unit normals; empty when the source has none.
    pub normals: Vec<Vec3>,
    /// Three indices into `normals` per triangle ([`NO_NORMAL`]: none); empty when `normals` is.
    pub corner_normals: Vec<[u32; 3]>,
    /// Texture coordinates, (0, 0) an image's lower left corner; empty when the source has none.
    pub uvs: Vec<Vec2>,
    /// Three indices into `uvs` per triangle ([`NO_UV`]: none); empty when `uvs` is.
    pub corner_uvs: Vec<[u32; 3]>,
    /// Linear RGB in [0, 1], interpolated over each triangle and multiplied by its material's colour; empty when the source has none.
    pub colors: Vec<[f32; 3]>,
    /// Three indices into `colors` per triangle ([`NO_COLOR`]: white); empty when `colors` is.
    pub corner_colors: Vec<[u32; 3]>,
    /// At least one once there is a triangle.
    pub materials: Vec<Material>,
    /// One index into `materials` per triangle.
    pub material_of: Vec<u32>,
    /// Missing files and attributes that its file refers to.
    pub missing: Vec<Missing>,
    /// Nodes or groups of its file, in the order of their triangles, in all runs; empty: the file has none, or the mesh is placed.
    pub parts: Vec<Part>,
    /// The places of runs of the triangles, if the mesh's file places some runs more than once; empty once the mesh is placed.
    pub runs: Vec<Run>,
}

/// A node or group of a mesh file: consecutive triangles.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Part {
    /// May be empty, and that of several.
    pub name: String,
    pub triangles: usize,
}

/// Something that a mesh file says and that is not drawn, or that it refers to and that does not exist. The mesh is loaded without it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Missing {
    pub what: String,
    /// The place of the reference in the file, and the replacement.
    pub why: String,
}

impl Missing {
    /// A line that lists what mesh files lack; `None` if nothing.
    pub fn line(all: &[Missing]) -> Option<String> {
        let first = all.first()?;
        let more = match all.len() {
            1 => String::new(),
            n => format!(", and {} more, listed by --report", n - 1),
        };
        Some(format!("left out: {} ({}){more}; --strict makes this an error", first.what, first.why))
    }
}

/// Bytes of a triangle and of a vertex: the mesh, its placed copy, and what is made of it for rays or a device. Measured with meshes of
/// 5 million triangles, as the largest resident set of a render, to within a fifth.
const TRIANGLE_BYTES: u64 = 170;
const VERTEX_BYTES: u64 = 80;

/// Refuses a mesh of this size if it does not fit the free memory. To be called before it is made; `what` and `advice` are for the error.
///
/// # Errors
/// [`Error::Work`](crate::input::Error::Work) with both sizes.
pub fn check_memory(
    limits: Limits,
    (triangles, vertices): (u64, u64),
    what: impl fmt::Display,
    advice: &str,
) -> Result<()> {
    let bytes = TRIANGLE_BYTES.saturating_mul(triangles).saturating_add(VERTEX_BYTES.saturating_mul(vertices));
    limits.check_memory(bytes, what, advice)
}

impl Mesh {
    /// The corners of the box around all vertices and spheres; `None` without any.
    pub fn bounds(&self) -> Option<(DVec3, DVec3)> {
        let of_vertices = parallel::reduce(&self.positions, |p| Some((*p, *p)), joined);
        let of_round = |id: u32| Some(self.primitive(id).capsule()?.bounds());
        let of_round = parallel::reduce(0..self.radii.len() as u32, of_round, joined);
        of_vertices.into_iter().chain(of_round).reduce(joined)
    }

    /// The corners of the box around all triangles and spheres: [`Mesh::bounds`] without vertices that no triangle has.
    pub fn drawn_bounds(&self) -> Option<(DVec3, DVec3)> {
        let of = |(k, t): (usize, &[u32; 3])| {
            // triangles that a file's opacity leaves out have one corner
            let is_seen = t[0] != t[1] || t[1] != t[2] || self.is_round(k as u32);
            is_seen.then(|| self.primitive(k as u32).bounds())
        };
        self.triangles.iter().enumerate().filter_map(of).reduce(joined).or_else(|| self.bounds())
    }

    /// Number of vertices that no triangle or sphere has.
    pub fn unused_vertices(&self) -> usize {
        let mut is_used = vec![false; self.positions.len()];
        self.triangles.iter().flatten().for_each(|vertex| is_used[*vertex as usize] = true);
        is_used.iter().filter(|is_used| !**is_used).count()
    }

    /// Puts vertices that are not finite, and that no triangle has, where another vertex is. Depth cameras write them where they see nothing.
    ///
    /// # Errors
    /// The index of a vertex that is not finite and that a triangle has.
    pub fn settle_unused(&mut self) -> std::result::Result<(), usize> {
        if self.positions.iter().all(|p| p.is_finite()) {
            return Ok(());
        }
        let is_finite = |vertex: &u32| self.positions[*vertex as usize].is_finite();
        if let Some(vertex) = self.triangles.iter().flatten().filter(|v| !is_finite(v)).min() {
            return Err(*vertex as usize);
        }
        let place = self.triangles.first().map_or(DVec3::ZERO, |t| self.positions[t[0] as usize]);
        self.positions.iter_mut().filter(|p| !p.is_finite()).for_each(|p| *p = place);
        Ok(())
    }

    /// Takes normals without a direction, and texture coordinates that are not finite, from the corners that have them.
    pub fn drop_unusable(&mut self) {
        let Mesh { normals, corner_normals, uvs, corner_uvs, .. } = self;
        if parallel::any(&*normals, |normal| !normal.is_normalized()) {
            let normal = |k: u32| if k != NO_NORMAL && normals[k as usize].is_normalized() { k } else { NO_NORMAL };
            parallel::for_each_mut(corner_normals, |_, corners| *corners = corners.map_each(normal));
        }
        if parallel::any(&*uvs, |uv| !uv.is_finite()) {
            let uv = |k: u32| if k != NO_UV && uvs[k as usize].is_finite() { k } else { NO_UV };
            parallel::for_each_mut(corner_uvs, |_, corners| *corners = corners.map_each(uv));
        }
    }

    /// A triangle, sphere or capsule, where the mesh is.
    pub fn primitive(&self, id: u32) -> Primitive {
        let corners = self.triangles[id as usize].map_each(|v| self.positions[v as usize]);
        Primitive::new(corners, self.radius(id))
    }

    /// Whether the primitive is a sphere or capsule.
    pub fn is_round(&self, id: u32) -> bool {
        self.radius(id).is_some()
    }

    /// The radius of a sphere or capsule; `None` of a triangle.
    pub fn radius(&self, id: u32) -> Option<f64> {
        self.radii.get(id as usize).copied().filter(|radius| *radius > 0.0)
    }

    /// The numbers of spheres and of capsules.
    pub fn round_counts(&self) -> [usize; 2] {
        let one =
            |id: u32| self.primitive(id).capsule().map(|capsule| if capsule.is_sphere() { [1, 0] } else { [0, 1] });
        let counts = parallel::reduce(0..self.radii.len() as u32, one, |a, b| [a[0] + b[0], a[1] + b[1]]);
        counts.unwrap_or_default()
    }

    pub fn has_spheres(&self) -> bool {
        !self.radii.is_empty()
    }

    /// The texture coordinates of a triangle's corners; `None` if a corner has none.
    pub fn uvs_of(&self, triangle: usize) -> Option<[Vec2; 3]> {
        let corners = self.corner_uvs.get(triangle).filter(|c| !c.contains(&NO_UV))?;
        Some(corners.map_each(|k| self.uvs[k as usize]))
    }

    /// The texture coordinates at barycentric weights of its second and third corner.
    pub fn uv_at(&self, triangle: u32, [u, v]: [f64; 2]) -> Option<DVec2> {
        let [a, b, c] = self.uvs_of(triangle as usize)?.map_each(|uv| uv.as_dvec2());
        Some((1.0 - u - v) * a + u * b + v * c)
    }

    /// The colours of a triangle's corners, white where there are none.
    pub fn colors_of(&self, triangle: usize) -> [[f32; 3]; 3] {
        let corners = self.corner_colors.get(triangle).copied().unwrap_or([NO_COLOR; 3]);
        corners.map_each(|k| self.colors.get(k as usize).copied().unwrap_or([1.0; 3]))
    }

    /// Leaves out the colours of vertices.
    pub fn clear_colors(&mut self) {
        (self.colors, self.corner_colors) = (Vec::new(), Vec::new());
    }

    /// Multiplies all texture coordinates: an image repeats as often where one is.
    pub fn repeat_uvs(&mut self, times: Vec2) {
        self.uvs.iter_mut().for_each(|uv| *uv *= times);
    }

    /// Whether some material has a texture, and some triangle coordinates.
    pub fn is_textured(&self) -> bool {
        !self.corner_uvs.is_empty() && self.materials.iter().any(|m| m.texture.is_some())
    }

    /// Whether the colour of a triangle changes over it.
    pub fn has_changing_colors(&self) -> bool {
        self.is_textured() || self.has_patterns() || !self.corner_colors.is_empty()
    }

    /// Whether some material has a pattern.
    pub fn has_patterns(&self) -> bool {
        self.materials.iter().any(|m| m.pattern.is_some())
    }

    /// Whether some material is not there everywhere on its triangles.
    pub fn has_alpha_masks(&self) -> bool {
        !self.corner_uvs.is_empty() && self.materials.iter().any(Material::has_alpha)
    }

    /// Whether some material is blended.
    pub fn is_blended(&self) -> bool {
        self.materials.iter().any(|m| m.blend.is_some())
    }

    /// Whether a triangle may have holes, by its material's mask or because it is blended.
    pub fn has_alpha(&self, triangle: u32) -> bool {
        let is_placed = |m: &Material| m.blend.is_some() || self.uvs_of(triangle as usize).is_some();
        self.material(triangle).is_some_and(|m| m.has_alpha() && is_placed(m))
    }

    /// Whether a triangle has a surface at a place; where it is blended, whether a ray of this threshold sees it.
    pub fn is_there(&self, triangle: u32, bary: [f64; 2], threshold: Threshold) -> bool {
        let Some(material) = self.material(triangle).filter(|m| m.has_alpha()) else { return true };
        let texture = material.texture.as_ref().filter(|t| t.has_alpha_mask());
        let placed = texture.and_then(|texture| Some((texture, self.uv_at(triangle, bary)?)));
        match (material.blend, placed) {
            (None, Some((texture, uv))) => texture.is_there(uv),
            (None, None) => true,
            (Some(factor), Some((texture, uv))) => threshold.is_reached_by(texture.at(uv)[3] as f32 * factor),
            (Some(factor), None) => threshold.is_reached_by(factor),
        }
    }

    /// The material of a triangle; `None`: the default one.
    pub fn material(&self, triangle: u32) -> Option<&Material> {
        self.material_of.get(triangle as usize).and_then(|m| self.materials.get(*m as usize))
    }
}

/// The box around two.
pub fn joined(a: (DVec3, DVec3), b: (DVec3, DVec3)) -> (DVec3, DVec3) {
    (a.0.min(b.0), a.1.max(b.1))
}

/// The material of a triangle.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    pub name: String,
    /// Linear RGB reflectance in [0, 1].
    pub diffuse: [f32; 3],
    /// Texture that multiplies the colour, on triangles with texture coordinates.
    pub texture: Option<Texture>,
    /// A blended material's opacity in [0, 1], by which its image's is multiplied; `None`: the image's cutoff says where there is a surface.
    pub blend: Option<f32>,
    /// Specular reflectance at normal incidence, linear RGB; 0: a matte surface.
    pub specular: [f32; 3],
    /// Roughness of the microfacets, in [0, 1].
    pub roughness: f32,
    /// Metalness in [0, 1]: the share of the colour that is a metal's specular reflectance.
    pub metallic: f32,
    /// Emission, linear RGB.
    pub emissive: [f32; 3],
    /// Procedural pattern that multiplies the diffuse colour.
    pub pattern: Option<Pattern>,
    /// Whether both faces are visible.
    pub two_sided: bool,
    /// Whether its colour is to be seen as it is, whatever the light.
    pub is_unlit: bool,
}

/// Reflectance of a typical dielectric at normal incidence.
pub const DIELECTRIC: f32 = 0.04;

/// The least alpha of microfacets: a smoother surface shows a light of no size as a point of no size; it is a camera's mirror that
/// shows anything else.
const ALPHA_MIN: f32 = 0.01;

impl Material {
    /// Alpha of its microfacets (Burley 2012).
    pub fn alpha(&self) -> f32 {
        (self.roughness * self.roughness).max(ALPHA_MIN)
    }

    /// Whether there may be places without a surface.
    pub fn has_alpha(&self) -> bool {
        self.blend.is_some() || self.texture.as_ref().is_some_and(Texture::has_alpha_mask)
    }

    /// Whether it is shinier than matte, or emits light.
    pub fn is_glossy(&self) -> bool {
        self.specular != [0.0; 3] || self.metallic > 0.0 || self.emissive != [0.0; 3]
    }
}

impl Default for Material {
    /// Light grey and matte, both faces visible.
    fn default() -> Self {
        Material {
            name: "default".into(),
            diffuse: [0.8; 3],
            texture: None,
            blend: None,
            specular: [0.0; 3],
            roughness: 1.0,
            metallic: 0.0,
            emissive: [0.0; 3],
            pattern: None,
            two_sided: true,
            is_unlit: false,
        }
    }
}
