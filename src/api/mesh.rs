//! Meshes.

use crate::geometry::load::load_mesh;
use crate::geometry::mesh::Material;
use crate::geometry::spec::{MeshSource, MeshSpec};
use crate::geometry::spheres::{Join, round_of};
use crate::geometry::texture::{Images, ImagesRead, Texels, Texture};
use crate::input::{Error, Limits, Loading, Result};
use glam::{DVec3, Vec2, Vec3};
use std::path::Path;
use std::sync::Arc;

/// Triangles, optionally with normals, texture coordinates and materials.
#[derive(Debug, Clone)]
pub struct Mesh {
    pub(super) mesh: crate::geometry::mesh::Mesh,
    pub(super) name: String,
}

impl Mesh {
    /// A mesh from vertex positions, world units, and three vertex indices per triangle. Both faces are visible; the colour is a matte
    /// light grey.
    ///
    /// # Errors
    /// [`Error::Input`] for a position that is not finite, or an index without a vertex.
    pub fn new(positions: Vec<[f64; 3]>, triangles: Vec<[u32; 3]>) -> Result<Mesh> {
        let count = positions.len();
        if let Some(k) = positions.iter().position(|p| !p.iter().all(|x| x.is_finite())) {
            let [x, y, z] = positions[k];
            return Err(Error::input(format!("vertex {k} lies at ({x}, {y}, {z}); use finite numbers")));
        }
        if let Some(k) = triangles.iter().position(|t| t.iter().any(|v| *v as usize >= count)) {
            let triangle = triangles[k];
            return Err(Error::input(format!("triangle {k} is {triangle:?}; there are {count} vertices, from 0")));
        }
        let material_of = vec![0; triangles.len()];
        let materials = if triangles.is_empty() { Vec::new() } else { vec![Material::default()] };
        let positions = positions.into_iter().map(DVec3::from_array).collect();
        let mesh = crate::geometry::mesh::Mesh { positions, triangles, materials, material_of, ..Default::default() };
        Ok(Mesh { mesh, name: "mesh".into() })
    }

    /// Reads a mesh file, .obj, .gltf, .glb, .ply, .stl, .off or .dae, with its materials and images.
    ///
    /// # Errors
    /// [`Error::Missing`] or [`Error::Read`] if it cannot be read, [`Error::Input`] with what is wrong with it.
    pub fn read(path: impl AsRef<Path>) -> Result<Mesh> {
        Mesh::read_within(path, Limits::default())
    }

    /// [`Mesh::read`] within other limits.
    ///
    /// # Errors
    /// As [`Mesh::read`].
    pub fn read_within(path: impl AsRef<Path>, limits: Limits) -> Result<Mesh> {
        let spec = MeshSpec::of(MeshSource::File(path.as_ref().to_owned()));
        let mesh = load_mesh(&spec, &mut Images::of(ImagesRead::All), &Loading::new(limits))?;
        Ok(Mesh { mesh, name: spec.called() })
    }

    /// The mesh with a name, for Cryptomatte and the list of objects.
    pub fn named(self, name: impl Into<String>) -> Mesh {
        Mesh { name: name.into(), ..self }
    }

    /// The mesh with one colour, linear RGB in [0, 1], which replaces its materials' colours and textures, and those of its vertices.
    pub fn with_color(mut self, color: [f32; 3]) -> Mesh {
        for material in &mut self.mesh.materials {
            (material.diffuse, material.texture) = (color, None);
        }
        self.mesh.clear_colors();
        self
    }

    /// The mesh with one colour per vertex, linear RGB in [0, 1], interpolated over each triangle and multiplied by the material's colour,
    /// which becomes white where it is the default.
    ///
    /// # Errors
    /// [`Error::Input`] if the count differs from that of the vertices, or one is not in [0, 1].
    pub fn with_colors(mut self, colors: Vec<[f32; 3]>) -> Result<Mesh> {
        self.check_count(colors.len(), "colours")?;
        if let Some(k) = colors.iter().position(|c| !c.iter().all(|x| (0.0..=1.0).contains(x))) {
            return Err(Error::input(format!("colour {k} is {:?}; use linear RGB from 0 to 1", colors[k])));
        }
        for material in self.mesh.materials.iter_mut().filter(|m| **m == Material::default()) {
            material.diffuse = [1.0; 3];
        }
        self.mesh.colors = colors;
        self.mesh.corner_colors = self.mesh.triangles.clone();
        Ok(self)
    }

    /// The mesh with one normal per vertex, of any length, which replaces its own.
    ///
    /// # Errors
    /// [`Error::Input`] if the count differs from that of the vertices, or a normal is zero or not finite.
    pub fn with_normals(mut self, normals: Vec<[f32; 3]>) -> Result<Mesh> {
        self.check_has_corners("normals of their own")?;
        self.check_count(normals.len(), "normals")?;
        let unit = |(k, n): (usize, [f32; 3])| {
            let unit = Vec3::from_array(n).try_normalize();
            unit.ok_or_else(|| Error::input(format!("normal {k} is {n:?}, which has no direction")))
        };
        self.mesh.normals = normals.into_iter().enumerate().map(unit).collect::<Result<_>>()?;
        self.mesh.corner_normals = self.mesh.triangles.clone();
        Ok(self)
    }

    /// The mesh with one pair of texture coordinates per vertex; (0, 0) is an image's lower left corner.
    ///
    /// # Errors
    /// [`Error::Input`] if the count differs from that of the vertices, or one is not finite.
    pub fn with_uvs(mut self, uvs: Vec<[f32; 2]>) -> Result<Mesh> {
        self.check_has_corners("texture coordinates")?;
        self.check_count(uvs.len(), "texture coordinates")?;
        if let Some(k) = uvs.iter().position(|uv| !uv.iter().all(|x| x.is_finite())) {
            return Err(Error::input(format!("texture coordinate {k} is {:?}; use finite numbers", uvs[k])));
        }
        self.mesh.uvs = uvs.into_iter().map(Vec2::from_array).collect();
        self.mesh.corner_uvs = self.mesh.triangles.clone();
        Ok(self)
    }

    /// The mesh with an image on all of it: 8-bit sRGB of `width x height` pixels, three (RGB) or four (RGBA) bytes each, row by row from the
    /// top. It replaces the colours of materials and vertices, and needs texture coordinates. Its opacity is not used.
    ///
    /// # Errors
    /// [`Error::Input`] if the bytes are not those of such an image, or the mesh has no texture coordinates.
    pub fn with_texture(mut self, width: usize, height: usize, srgb8: &[u8]) -> Result<Mesh> {
        if self.mesh.corner_uvs.is_empty() {
            return Err(Error::input("the mesh has no texture coordinates; give uvs, or leave the texture out"));
        }
        let texture = Texture::new(Arc::new(Texels::of_srgb8(width, height, srgb8)?));
        self.mesh.clear_colors();
        for material in &mut self.mesh.materials {
            (material.texture, material.diffuse) = (Some(texture.clone()), [1.0; 3]);
        }
        Ok(self)
    }

    /// Vertex positions, world units.
    pub fn positions(&self) -> impl ExactSizeIterator<Item = [f64; 3]> {
        self.mesh.positions.iter().map(DVec3::to_array)
    }

    /// Three vertex indices per triangle.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.mesh.triangles
    }

    /// Spheres: centres and radii, world units. An id stands for a sphere as it does for a triangle. They take colours, one for each, and
    /// materials, but no normals, texture coordinates or images.
    ///
    /// # Errors
    /// [`Error::Input`] for a centre that is not finite, a radius that is not above 0, or another number of radii.
    pub fn spheres(centers: &[[f64; 3]], radii: &[f64]) -> Result<Mesh> {
        Mesh::spheres_within(centers, radii, Limits::default())
    }

    /// [`Mesh::spheres`] within other limits.
    ///
    /// # Errors
    /// As [`Mesh::spheres`].
    pub fn spheres_within(centers: &[[f64; 3]], radii: &[f64], limits: Limits) -> Result<Mesh> {
        let centres = centers.iter().map(|c| DVec3::from_array(*c)).collect();
        let mesh = round_of(centres, radii.to_vec(), None, None, limits).map_err(Error::input)?;
        Ok(Mesh { mesh, name: "spheres".into() })
    }

    /// Capsules: the ends of their segments and their radii, world units. A capsule is all points within its radius of its segment. An id stands for
    /// a capsule as it does for a triangle. They take colours, one for each end of each, of which the first shows, and materials, but no
    /// normals, texture coordinates or images.
    ///
    /// # Errors
    /// [`Error::Input`] for an end that is not finite, a radius that is not above 0, or another number of radii.
    pub fn capsules(ends: &[[[f64; 3]; 2]], radii: &[f64]) -> Result<Mesh> {
        Mesh::capsules_within(ends, radii, Limits::default())
    }

    /// [`Mesh::capsules`] within other limits.
    ///
    /// # Errors
    /// As [`Mesh::capsules`].
    pub fn capsules_within(ends: &[[[f64; 3]; 2]], radii: &[f64], limits: Limits) -> Result<Mesh> {
        if radii.len() != ends.len() {
            return Err(Error::input(format!("{} radii for {} capsules; give one for each", radii.len(), ends.len())));
        }
        let points = ends.as_flattened().iter().map(|p| DVec3::from_array(*p)).collect();
        let radii = radii.iter().flat_map(|radius| [*radius; 2]).collect();
        let mesh = round_of(points, radii, None, Some(Join::Pairs), limits).map_err(Error::input)?;
        Ok(Mesh { mesh, name: "capsules".into() })
    }

    fn check_has_corners(&self, what: &str) -> Result<()> {
        match self.mesh.has_spheres() {
            true => Err(Error::input(format!("spheres and capsules have no {what}; leave them out"))),
            false => Ok(()),
        }
    }

    fn check_count(&self, count: usize, what: &str) -> Result<()> {
        let vertices = self.mesh.positions.len();
        if count == vertices {
            return Ok(());
        }
        Err(Error::input(format!("{count} {what} for {vertices} vertices; give one a vertex")))
    }
}
