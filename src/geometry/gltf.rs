//! glTF 2.0: the placed triangles of the default scene.

mod accessor;
mod draco;
mod json;
mod look;
mod meshopt;
mod pose;
mod source;
#[cfg(test)]
mod tests;

use crate::arrays::MapEach;
use std::borrow::Cow;
use std::collections::{BTreeMap, HashMap};
use std::path::Path;

use glam::{DAffine3, DMat3, DMat4, DVec2, DVec3, DVec4, Vec2};
use gltf::mesh::Mode;
use gltf::texture::Info;
use gltf::{Document, Node, Primitive, Semantic};

use crate::geometry::instances::{Run, placed_box, saves_memory};
use crate::geometry::mesh::{MAX_TRIANGLES, Material, Mesh, NO_COLOR, NO_NORMAL, NO_UV, Part, check_memory};
use crate::geometry::place::{transformed_normal, world_normal_from_object};
use crate::geometry::spec::AnimationSpec;
use crate::geometry::texture::{Images, ImagesRead};
use crate::input::{Error, Loading, Result};
use pose::Pose;
use source::{FileAccess, Source};

/// Where the files that a glTF file names may be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Files {
    /// In its folder or below, also after symbolic links are resolved.
    Below,
    Anywhere,
}

/// Reads a `.gltf` file with its buffers (files that `files` allows, or `data:` URIs), or a `.glb` file.
///
/// The default scene (or else the first, or else all nodes that are no other's child) is walked depth-first, in
/// the file's order; that is the order of triangle ids. A mesh under several nodes is placed at each. Where copies would take much memory, each
/// mesh is stored once, and [`Mesh::runs`] are its places. Strips and fans become triangles as the glTF specification lists them; lines and
/// points are skipped. The base colour
/// factor is the diffuse colour, its image the texture, with the first sampler's borders and `KHR_texture_transform`. A masked material has a
/// surface where its opacity reaches its cutoff, a blended one where it reaches one half. The opacity is the factor's times the image's; times the
/// mean of `COLOR_0` at the corners it is judged for whole triangles, which keep their ids where they are left out, as triangles without area.
/// `COLOR_0` is the vertices' colour, by which the diffuse colour is multiplied. The material is as rough, metallic and emissive as its factors
/// and `KHR_materials_emissive_strength` say where no image says more, or as `KHR_materials_pbrSpecularGlossiness` says. Transforms are read and
/// multiplied in f64; normals go by the inverse transpose. Vertices keep the file's order also where a node mirrors them. `EXT_mesh_gpu_instancing`
/// places a mesh several times; nodes that `KHR_node_visibility` hides are left out, with their children.
///
/// With `animation` the scene is as at a time of one of its animations, with its morph targets and skins. Without it morph targets and
/// skins are not applied. Normalised and quantised integers (`KHR_mesh_quantization`) are read. Images that do not exist, and what the file says and
/// is not drawn, are left out, and listed in [`Mesh::missing`].
///
/// # Errors
/// [`Error::Input`] naming the file and the accessor, buffer, node or mesh: no glTF 2.0; a required extension
/// that would change the triangles; a buffer that is missing, short, remote or where `files` does not allow it; an accessor or an index out
/// of range; a node that is its own ancestor or has two parents; no triangles, or more than 2^28.
pub fn load(
    path: &Path,
    files: Files,
    images: &Images,
    animation: Option<&AnimationSpec>,
    loading: &Loading,
) -> Result<Mesh> {
    let name = path.display().to_string();
    let unreadable = |e| Error::unreadable(path, e);
    let start = loading.prefix(path).map_err(unreadable)?;
    source::check_start(start.bytes(), start.length()).map_err(|e| e.at(&name))?;
    let bytes = start.read_all().map_err(unreadable)?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut mesh = parse(bytes, FileAccess { folder, files, loading }, images, animation).map_err(|e| e.at(&name))?;
    mesh.missing.iter_mut().for_each(|missing| missing.why = format!("{name}: {}", missing.why));
    Ok(mesh)
}

/// As [`load`], from the file's bytes.
fn parse<'b>(
    bytes: impl Into<Cow<'b, [u8]>>,
    access: FileAccess,
    images: &Images,
    animation: Option<&AnimationSpec>,
) -> Result<Mesh> {
    let source = Source::parse(bytes.into(), access)?;
    let pose = animation.map(|animation| Pose::at(&source, animation)).transpose()?;
    let mut builder = Builder::new(&source, pose, images);
    builder.place_scene()?;
    builder.hang_images(access)?;
    builder.list_unread();
    builder.finish()
}

/// The nodes to start from, in order.
fn roots(document: &Document) -> Vec<Node<'_>> {
    match document.default_scene().or_else(|| document.scenes().next()) {
        Some(scene) => scene.nodes().collect(),
        None => top_nodes(document),
    }
}

/// The nodes that are no other's child, in order.
fn top_nodes(document: &Document) -> Vec<Node<'_>> {
    let mut is_child = vec![false; document.nodes().len()];
    document.nodes().flat_map(|node| node.children()).for_each(|child| is_child[child.index()] = true);
    document.nodes().filter(|node| !is_child[node.index()]).collect()
}

/// Vertices already placed for the current node, by accessor: primitives often share them.
#[derive(Default)]
struct Placed {
    /// The first position's index, and how many there are.
    positions: HashMap<usize, (u32, u32)>,
    /// The index of each normal, or [`NO_NORMAL`].
    normals: HashMap<usize, Vec<u32>>,
}

/// A mesh of a node, or of an instance of the node.
struct Placement<'a> {
    node: Node<'a>,
    mesh: gltf::Mesh<'a>,
    world_from_mesh: DMat4,
}

const NOT_FINITE: &str = "a placed vertex is not finite; check the node's transform and POSITION";

/// The least and the greatest corner of a box.
type Corners = (DVec3, DVec3);

/// So many places need no look at how much memory is free.
const UNCHECKED_PLACES: usize = 1 << 20;

/// The least number of triangles in all nodes that is worth instances: frames through instances take longer, and many need copies.
const SHARED_MIN: usize = 1 << 21;

/// The triangles of a mesh, by the counts of its accessors; one for a rest of corners, which is an error.
fn triangle_count(mesh: &gltf::Mesh) -> usize {
    let of_primitive = |primitive: Primitive| {
        let Some(positions) = primitive.get(&Semantic::Positions).map(|positions| positions.count()) else { return 0 };
        let corners = primitive.indices().map_or(positions, |indices| indices.count());
        match primitive.mode() {
            Mode::Triangles => corners.div_ceil(3),
            Mode::TriangleStrip | Mode::TriangleFan => corners.saturating_sub(2),
            _ => 0,
        }
    };
    mesh.primitives().map(of_primitive).fold(0, usize::saturating_add)
}

/// Whether a copy of each mesh at each place would take much more memory than the meshes, and every node's matrix has an inverse.
fn are_shared(all: &[Placement]) -> bool {
    let mut count_of: HashMap<usize, usize> = HashMap::new();
    let count = |mesh: &gltf::Mesh| *count_of.entry(mesh.index()).or_insert_with(|| triangle_count(mesh));
    let total = all.iter().map(|placement| &placement.mesh).map(count).fold(0, usize::saturating_add);
    let once = count_of.into_values().fold(0, usize::saturating_add);
    let has_normals = |placement: &Placement| {
        let m = placement.world_from_mesh;
        m.row(3) == DVec4::W && world_normal_from_object(DMat3::from_mat4(m)).is_some()
    };
    total >= SHARED_MIN && saves_memory(total, once, all.len()) && all.iter().all(has_normals)
}

/// How the vertices of a primitive get into the world.
struct Placing<'p> {
    node: &'p Node<'p>,
    primitive: &'p Primitive<'p>,
    /// One transform, or one for each vertex.
    world: Vec<DMat4>,
}

impl Placing<'_> {
    /// Of a vertex.
    fn world_from_node(&self, vertex: usize) -> DMat4 {
        self.world[vertex % self.world.len().max(1)]
    }
}

struct Builder<'a> {
    source: &'a Source,
    /// The nodes at a time of an animation; `None`: as the file places them.
    pose: Option<Pose>,
    read: ImagesRead,
    /// Materials of the mode `BLEND` are blended.
    blends: bool,
    mesh: Mesh,
    default_is_used: bool,
    /// Number of triangles whose vertices fade within an image, by material.
    faded: BTreeMap<usize, usize>,
    /// The mean opacity of `COLOR_0` of each triangle of a blended material, in steps of 1/255; the triangles after the last are opaque.
    opacities: Vec<u8>,
    /// So many vertices need no other look at how much memory is free.
    unchecked_vertices: usize,
}

impl<'a> Builder<'a> {
    fn new(source: &'a Source, pose: Option<Pose>, images: &Images) -> Self {
        let (read, blends) = (images.read, images.blends);
        let materials = source.document.materials().zip(&source.kept.materials);
        let materials = materials.map(|(m, kept)| look::material(&m, kept, blends)).collect();
        let mesh = Mesh { materials, ..Mesh::default() };
        let (default_is_used, faded, opacities, unchecked_vertices) = (false, BTreeMap::new(), Vec::new(), 1 << 20);
        Builder { source, pose, read, blends, mesh, default_is_used, faded, opacities, unchecked_vertices }
    }

    fn finish(mut self) -> Result<Mesh> {
        if self.mesh.triangles.is_empty() {
            return Err(Error::input("has no triangles in its scene; export one with triangle meshes"));
        }
        if self.default_is_used {
            // colours of vertices are shown as they are
            let diffuse = if self.mesh.colors.is_empty() { Material::default().diffuse } else { [1.0; 3] };
            self.mesh.materials.push(Material { diffuse, two_sided: false, ..Material::default() });
        }
        self.fade_materials();
        if self.mesh.corner_normals.iter().flatten().all(|&n| n == NO_NORMAL) {
            self.mesh.normals = Vec::new();
            self.mesh.corner_normals = Vec::new();
            self.mesh.runs.iter_mut().for_each(|run| run.normals = 0..0);
        }
        if !self.mesh.colors.is_empty() {
            self.mesh.corner_colors.resize(self.mesh.triangles.len(), [NO_COLOR; 3]);
        }
        if self.mesh.uvs.is_empty() {
            self.mesh.corner_uvs = Vec::new();
        }
        Ok(self.mesh)
    }

    /// Places the meshes of all nodes. Each mesh is stored once, with a list of its places, where that takes much less memory.
    fn place_scene(&mut self) -> Result<()> {
        let all = self.placements()?;
        let is_shared = self.pose.is_none() && are_shared(&all);
        let mut known: HashMap<usize, (Run, Corners)> = HashMap::new();
        for Placement { node, mesh, world_from_mesh } in &all {
            let at_node = |e: Error| e.at(format!("node {}", node.index()));
            let (run, bounds) = match known.get(&mesh.index()) {
                Some(known) => known.clone(),
                None => {
                    let before = Run::whole(&self.mesh, DAffine3::IDENTITY);
                    let matrix = if is_shared { DMat4::IDENTITY } else { *world_from_mesh };
                    self.place_mesh(node, mesh, matrix).map_err(at_node)?;
                    let run = Run::whole(&self.mesh, DAffine3::IDENTITY).after(&before);
                    let bounds = if is_shared { run.bounds(&self.mesh) } else { Default::default() };
                    (run, bounds)
                }
            };
            let name = node.name().or(mesh.name()).unwrap_or_default().to_owned();
            let triangles = run.triangles.len();
            self.mesh.parts.extend((triangles > 0).then_some(Part { name, triangles }));
            if is_shared {
                known.entry(mesh.index()).or_insert_with(|| (run.clone(), bounds));
                let run = Run { matrix: DAffine3::from_mat4(*world_from_mesh), ..run };
                let (lo, hi) = placed_box(&run.matrix, bounds);
                let is_finite = lo.is_finite() && hi.is_finite();
                if !is_finite && !run.vertices.is_empty() {
                    return Err(at_node(Error::input(NOT_FINITE)));
                }
                self.mesh.runs.push(run);
            }
        }
        Ok(())
    }

    /// The meshes of all nodes, depth-first, with a stack of its own: a chain of nodes may be long.
    fn placements(&self) -> Result<Vec<Placement<'a>>> {
        let document = &self.source.document;
        let (mut all, mut triangles) = (Vec::new(), 0_usize);
        let mut is_placed = vec![false; document.nodes().len()];
        let mut stack: Vec<(Node, DMat4)> = roots(document).into_iter().map(|root| (root, DMat4::IDENTITY)).collect();
        stack.reverse();
        while let Some((node, world_from_parent)) = stack.pop() {
            if std::mem::replace(&mut is_placed[node.index()], true) {
                let index = node.index();
                return Err(Error::input(format!("node {index} is reached twice; nodes must form trees")));
            }
            let kept = &self.source.kept.nodes[node.index()];
            if kept.is_hidden {
                continue;
            }
            let own = match &self.pose {
                Some(pose) => pose.parent_from_node(&node),
                None => kept.local.parent_from_node(),
            };
            let world_from_node = world_from_parent * own;
            // other meshes have only lines and points
            if let Some(mesh) = node.mesh().filter(|mesh| triangle_count(mesh) > 0) {
                let at_node = |e: Error| e.at(format!("node {}", node.index()));
                let instances = match &kept.instances {
                    Some(instances) => self.source.read_instances(instances).map_err(at_node)?,
                    None => vec![DMat4::IDENTITY],
                };
                // instances can ask for far more triangles than the file has bytes
                triangles = triangles.saturating_add(triangle_count(&mesh).saturating_mul(instances.len()));
                if triangles > MAX_TRIANGLES {
                    return Err(at_node(Error::input("more than 2^28 triangles; split the file")));
                }
                let places = all.len() + instances.len();
                if places > UNCHECKED_PLACES {
                    let what = format_args!("a scene of {places} places");
                    check_memory(self.source.limits, (2 * places as u64, 0), what, "split the file")?;
                }
                all.extend(instances.into_iter().map(|node_from_instance| Placement {
                    node: node.clone(),
                    mesh: mesh.clone(),
                    world_from_mesh: world_from_node * node_from_instance,
                }));
            }
            let first_child = stack.len();
            stack.extend(node.children().map(|child| (child, world_from_node)));
            stack[first_child..].reverse();
        }
        Ok(all)
    }

    fn place_mesh(&mut self, node: &Node, mesh: &gltf::Mesh, world_from_mesh: DMat4) -> Result<()> {
        let mut placed = Placed::default();
        for primitive in mesh.primitives() {
            self.place_primitive(node, &primitive, world_from_mesh, &mut placed)
                .map_err(|e| e.at(format!("mesh {}, primitive {}", mesh.index(), primitive.index())))?;
        }
        Ok(())
    }

    fn place_primitive(
        &mut self,
        node: &Node,
        primitive: &Primitive,
        world_from_node: DMat4,
        placed: &mut Placed,
    ) -> Result<()> {
        let mode = primitive.mode();
        let Some(positions) = primitive.get(&Semantic::Positions) else { return Ok(()) };
        if !matches!(mode, Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan) {
            return Ok(());
        }
        let placing = self.placing(node, primitive, positions.count(), world_from_node)?;
        // what moves vertices may differ from primitive to primitive
        let mut own = Placed::default();
        let placed = if self.pose.is_some() { &mut own } else { placed };
        let (base, count) = self.place_positions(&positions, &placing, placed)?;
        let corners: Vec<u32> = match primitive.indices() {
            Some(indices) => self.source.read_indices(&indices, count)?,
            None => (0..count).collect(),
        };
        let triangles = triangles_of(mode, &corners)?;

        let normals = match primitive.get(&Semantic::Normals) {
            Some(normals) => self.place_normals(&normals, count, &placing, placed)?,
            None => &[],
        };
        let normal_of = |corner: u32| normals.get(corner as usize).copied().unwrap_or(NO_NORMAL);
        self.mesh.corner_normals.extend(triangles.iter().map(|t| t.map_each(normal_of)));
        let colors = self.read_colors(primitive, count)?;
        let is_there = self.visible(primitive, &triangles, colors.as_deref());
        self.take_opacities(primitive, &triangles, colors.as_deref());
        let placed = triangles.iter().enumerate().map(|(k, t)| match is_there(k) {
            true => t.map_each(|corner| base + corner),
            // without area, so that it keeps its id
            false => [base + t[0]; 3],
        });
        self.mesh.triangles.extend(placed);
        let first_uv = self.place_uvs(primitive, count)?;
        let uv_of = |corner: u32| match first_uv {
            Some(first) if self.mesh.uvs[(first + corner) as usize].is_finite() => first + corner,
            _ => NO_UV,
        };
        self.mesh.corner_uvs.extend(triangles.iter().map(|t| t.map_each(uv_of)));
        if let Some(colors) = colors {
            let first = self.mesh.colors.len() as u32;
            let in_range = |c: f32| if c.is_finite() { c.clamp(0.0, 1.0) } else { 1.0 };
            self.mesh.colors.extend(colors.iter().map(|[r, g, b, _]| [*r, *g, *b].map_each(in_range)));
            self.mesh.corner_colors.resize(self.mesh.triangles.len() - triangles.len(), [NO_COLOR; 3]);
            self.mesh.corner_colors.extend(triangles.iter().map(|t| t.map_each(|corner| first + corner)));
        }
        let material = primitive.material().index().unwrap_or_else(|| {
            self.default_is_used = true;
            self.source.document.materials().len()
        });
        self.mesh.material_of.resize(self.mesh.triangles.len(), material as u32);
        Ok(())
    }

    /// How the vertices of a primitive get into the world.
    fn placing<'p>(&self, node: &'p Node, primitive: &'p Primitive, count: usize, world: DMat4) -> Result<Placing<'p>> {
        let skinned = match &self.pose {
            Some(pose) => pose.skinned(self.source, node, primitive, count)?,
            None => None,
        };
        Ok(Placing { node, primitive, world: skinned.unwrap_or_else(|| vec![world]) })
    }

    /// The vectors of an accessor, moved by morph targets.
    fn morphed(&self, from: &gltf::Accessor, what: Semantic, placing: &Placing) -> Result<Vec<DVec3>> {
        let mut values = self.source.read_vectors(from)?;
        if let Some(pose) = &self.pose {
            pose.morph(self.source, placing.node, placing.primitive, what, &mut values)?;
        }
        Ok(values)
    }

    /// Appends the accessor's positions unless this node has them already; the first one's index, and the count.
    fn place_positions(&mut self, from: &gltf::Accessor, placing: &Placing, placed: &mut Placed) -> Result<(u32, u32)> {
        if let Some(&known) = placed.positions.get(&from.index()) {
            return Ok(known);
        }
        let base = self.mesh.positions.len();
        let vertices = base.saturating_add(from.count());
        if vertices >= u32::MAX as usize {
            return Err(Error::input("more than 2^32 - 2 vertices; split the file"));
        }
        if vertices > self.unchecked_vertices {
            let what = format_args!("a mesh of {vertices} vertices");
            check_memory(
                self.source.limits,
                (self.mesh.triangles.len() as u64, vertices as u64),
                what,
                "split the file",
            )?;
            self.unchecked_vertices = 2 * vertices;
        }
        for (k, p) in self.morphed(from, Semantic::Positions, placing)?.into_iter().enumerate() {
            let p_world = placing.world_from_node(k).transform_point3(p);
            if !p_world.is_finite() {
                return Err(Error::input(NOT_FINITE));
            }
            self.mesh.positions.push(p_world);
        }
        let run = (base as u32, from.count() as u32);
        placed.positions.insert(from.index(), run);
        Ok(run)
    }

    /// Appends the texture coordinates of a primitive, as its base colour's image lies on them; the index of the first one.
    fn place_uvs(&mut self, primitive: &Primitive, count: u32) -> Result<Option<u32>> {
        let material = primitive.material();
        let info = material.pbr_metallic_roughness().base_color_texture();
        let transform = info.as_ref().and_then(Info::texture_transform);
        let set = transform.as_ref().and_then(|t| t.tex_coord()).or(info.as_ref().map(Info::tex_coord)).unwrap_or(0);
        let Some(accessor) = primitive.get(&Semantic::TexCoords(set)) else { return Ok(None) };
        let first = self.mesh.uvs.len();
        check_each(&accessor, "texture coordinates", (first, count))?;
        let placed = |uv: DVec2| {
            let uv = transform.as_ref().map_or(uv, |t| {
                let [scale, offset] = [t.scale(), t.offset()].map_each(|v| DVec2::from(v.map_each(f64::from)));
                let (sin, cos) = f64::from(t.rotation()).sin_cos();
                let scaled = scale * uv;
                DVec2::new(cos * scaled.x + sin * scaled.y, cos * scaled.y - sin * scaled.x) + offset
            });
            // from the upper left corner to the lower left one
            Vec2::new(uv.x as f32, (1.0 - uv.y) as f32)
        };
        self.mesh.uvs.extend(self.source.read_pairs(&accessor)?.into_iter().map(placed));
        Ok(Some(first as u32))
    }

    /// The colours of a primitive's vertices, with their opacity.
    fn read_colors(&self, primitive: &Primitive, count: u32) -> Result<Option<Vec<[f32; 4]>>> {
        let Some(accessor) = primitive.get(&Semantic::Colors(0)) else { return Ok(None) };
        check_each(&accessor, "colours", (self.mesh.colors.len(), count))?;
        self.source.read_colors(&accessor).map(Some)
    }

    /// Appends the accessor's normals unless this node has them already; the index of each.
    fn place_normals<'p>(
        &mut self,
        from: &gltf::Accessor,
        count: u32,
        placing: &Placing,
        placed: &'p mut Placed,
    ) -> Result<&'p [u32]> {
        check_each(from, "normals", (self.mesh.normals.len(), count))?;
        let known = placed.normals.entry(from.index()).or_default();
        if known.is_empty() {
            let matrix_of = |k: usize| world_normal_from_object(DMat3::from_mat4(placing.world_from_node(k)));
            let one = matrix_of(0);
            for (k, n) in self.morphed(from, Semantic::Normals, placing)?.into_iter().enumerate() {
                let matrix = if placing.world.len() == 1 { one } else { matrix_of(k) };
                known.push(match (matrix, n.try_normalize()) {
                    (Some(matrix), Some(n)) => {
                        self.mesh.normals.push(transformed_normal(matrix, n.as_vec3()));
                        self.mesh.normals.len() as u32 - 1
                    }
                    _ => NO_NORMAL,
                });
            }
        }
        Ok(known)
    }
}

/// Refuses another number of values than positions, and more than indices can number behind those so far.
fn check_each(accessor: &gltf::Accessor, what: &str, (so_far, count): (usize, u32)) -> Result<()> {
    if accessor.count() != count as usize {
        let found = accessor.count();
        return Err(Error::input(format!("{found} {what} for {count} positions; give one each")));
    }
    if so_far.saturating_add(count as usize) >= u32::MAX as usize {
        return Err(Error::input(format!("more than 2^32 - 2 {what}; split the file")));
    }
    Ok(())
}

/// Triangles from the corners of a primitive, in the order and winding of the glTF specification (3.7.2.1).
fn triangles_of(mode: Mode, corners: &[u32]) -> Result<Vec<[u32; 3]>> {
    let triangles = match mode {
        Mode::TriangleStrip => {
            let wound = |(k, w): (usize, &[u32])| if k % 2 == 0 { [w[0], w[1], w[2]] } else { [w[0], w[2], w[1]] };
            corners.windows(3).enumerate().map(wound).collect()
        }
        Mode::TriangleFan => corners.windows(2).skip(1).map(|w| [w[0], w[1], corners[0]]).collect(),
        _ if corners.len().is_multiple_of(3) => corners.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect(),
        _ => return Err(Error::input(format!("{} corners are not whole triangles; give three each", corners.len()))),
    };
    Ok(triangles)
}
