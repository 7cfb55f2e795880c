//! Wavefront OBJ: exact f64 positions, triangle ids in file order, parsed in parallel.
//!
//! The text is split at line ends into chunks. A first pass counts each chunk's lines, positions, texture
//! coordinates and normals; with their running sums a second pass knows every line's number and every
//! relative index's base, so the result does not depend on where it is split.

mod chunk;
mod mtl;
#[cfg(test)]
mod tests;

use std::collections::{BTreeSet, HashMap};
use std::path::Path;

use glam::{DVec2, DVec3, Vec2, Vec3};

use crate::geometry::lex;
use crate::geometry::mesh::{MAX_TRIANGLES, Material, Mesh, Missing, NO_NORMAL, NO_UV, Part};
use crate::geometry::texture::{Images, ImagesRead, full_color, linear_color};
use crate::input::{Error, Loading, Result};
use crate::parallel;
use chunk::{Chunk, Counts, LeftOut, NOT_FINITE, Reader, Texcoords};
use mtl::Mapped;

/// Bytes a chunk has at least (but for the last one): small enough to balance cores, large enough that the cost
/// of a chunk does not show. Results do not depend on it.
const CHUNK_BYTES: usize = 1 << 20;

/// Reads an OBJ file and the MTL files it names.
///
/// Faces are fan-triangulated from their first vertex; zero-area triangles stay, so that ids are file order.
/// `Kd` is linear RGB; a vertex of six numbers has an sRGB colour from 0 to 1, by which it is multiplied, or from 0 to 255 where all of the file
/// are whole numbers. Faces whose material is unknown, or whose `.mtl` file is missing, get
/// [`Material::default`]. Lines, points, curves and smoothing are skipped; objects, or else groups, are [`Mesh::parts`]. Images of the materials that faces have come from
/// `images`, and texture coordinates lie as the MTL files' options place them. Images, normals and texture coordinates that do not exist
/// are left out, and listed in [`Mesh::missing`].
///
/// # Errors
/// [`Error::Input`] naming file and line: see [`parse`]; an MTL file is malformed, or an image of a material that faces have is none.
/// [`Error::Missing`] or [`Error::Read`] if one of these files exists and cannot be read, or the OBJ file does not exist.
pub fn load(path: &Path, images: &mut Images, loading: &Loading) -> Result<Mesh> {
    let name = path.display().to_string();
    let text = read(path, loading)?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let (mut mesh, mapped) = parse(&text, &name, CHUNK_BYTES, |libraries| mtl::load(folder, libraries, loading))?;
    if images.read != ImagesRead::None {
        let mut is_used = vec![false; mesh.materials.len()];
        mesh.material_of.iter().for_each(|&m| is_used[m as usize] = true);
        let materials = mesh.materials.iter_mut().zip(&mapped).zip(is_used);
        for ((material, map), _) in materials.filter(|(_, is_used)| *is_used) {
            *material = match images.read.reads(map.is_masked()) {
                true => map.with_images(|image| images.find(image, loading), &mut mesh.missing, loading.limits())?,
                false => map.without_images(loading),
            };
            if images.blends {
                material.blend = map.blend();
            } else if images.read == ImagesRead::All {
                mesh.missing.extend(map.unblended());
            }
        }
    }
    Ok(mesh)
}

/// Parses OBJ text in chunks of at least so many bytes. `name` stands for the file in messages. `load_mtl` is called once, with the arguments of all `mtllib` lines in file
/// order. The mesh has the materials that it returns, in order, without images.
///
/// # Errors
/// [`Error::Input`], always the one of the lowest line: an empty text, no OBJ statements, no faces; a coordinate
/// that is missing or not a number; a vertex that is not finite and that a face has; an index that is 0, or a vertex index out of range;
/// more than 2^28 triangles. Errors of `load_mtl` are passed on.
fn parse(
    text: &[u8],
    name: &str,
    chunk_bytes: usize,
    load_mtl: impl FnOnce(&[&str]) -> Result<Vec<Mapped>>,
) -> Result<(Mesh, Vec<Mapped>)> {
    let (chunks, total) = read_chunks(text, name, chunk_bytes, Texcoords::Kept)?;
    let mut missing = missing(&chunks, name);
    let used: BTreeSet<String> = chunks.iter().flat_map(|c| &c.uses).map(|(_, material)| material.clone()).collect();
    let (mut mesh, mapped) = assemble(chunks, total, load_mtl)?;
    mesh.settle_unused().map_err(|vertex| {
        let at = line_of_vertex(text, vertex).map_or_else(String::new, |line| format!(":{line}"));
        Error::input(format!("{name}{at}: {NOT_FINITE}"))
    })?;
    missing.extend(unknown_materials(&used, &mapped, name));
    Ok((Mesh { missing, ..mesh }, mapped))
}

/// The line of a vertex, from 1.
fn line_of_vertex(text: &[u8], vertex: usize) -> Option<usize> {
    let text = lex::with_line_feeds(text.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(text));
    let mut lines = lex::Lines::new(&text).filter(|(_, line)| lex::Tokens::new(line).next() == Some(b"v"));
    lines.nth(vertex).map(|(number, _)| number + 1)
}

/// What faces refer to and the file does not have, and what of the file the mesh is made without.
fn missing(chunks: &[Chunk], name: &str) -> Vec<Missing> {
    // of the noun, `#` is the plural's ending
    let of = |what: &str, noun: &str, own: fn(&Chunk) -> &LeftOut| {
        let count: usize = chunks.iter().map(|chunk| own(chunk).count).sum();
        let (line, first) = chunks.iter().find_map(|chunk| own(chunk).first.as_ref())?;
        let plural = if count == 1 { "" } else { "s" };
        let noun = noun.replace('#', plural);
        let why = format!("missing at {count} {noun}, first in line {line}: {first}");
        Some(Missing { what: format!("{what} of {name}"), why })
    };
    let all = [
        of("normals", "corner# of faces", |c| &c.dangling_normals),
        of("texture coordinates", "corner# of faces", |c| &c.dangling_texcoords),
        of("vertices", "face#", |c| &c.short_faces),
        of("colours", "vertex line#", |c| &c.wrong_colors),
    ];
    all.into_iter().flatten().collect()
}

/// How exporters call no material.
const NO_MATERIAL: [&str; 3] = ["", "None", "(null)"];

/// The materials that faces use and no file of materials has.
fn unknown_materials(used: &BTreeSet<String>, mapped: &[Mapped], name: &str) -> Option<Missing> {
    let is_known = |used: &str| NO_MATERIAL.contains(&used) || mapped.iter().any(|m| m.material.name == used);
    let mut unknown = used.iter().filter(|used| !is_known(used));
    let first = unknown.next()?;
    let more = match unknown.count() {
        0 => String::new(),
        n => format!(", nor {n} more"),
    };
    let why = format!("no .mtl file that it names has it{more}; a plain grey is used");
    Some(Missing { what: format!("material {first:?} of {name}"), why })
}

/// The triangles of an OBJ file with their texture coordinates: a map from the (u, v) plane to space.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Textured {
    pub positions: Vec<DVec3>,
    pub texcoords: Vec<DVec2>,
    /// Each corner's position and texture coordinate.
    pub triangles: Vec<[(u32, u32); 3]>,
}

/// Reads the positions and texture coordinates of an OBJ file; materials and normals are skipped.
///
/// # Errors
/// Those of [`load`], and a face without texture coordinates.
pub fn load_textured(path: &Path, loading: &Loading) -> Result<Textured> {
    let name = path.display().to_string();
    let text = read(path, loading)?;
    let mut mesh = Textured::default();
    for chunk in read_chunks(&text, &name, CHUNK_BYTES, Texcoords::Needed)?.0 {
        mesh.positions.extend(chunk.positions);
        mesh.texcoords.extend(chunk.texcoords);
        let corners = chunk.triangles.iter().zip(&chunk.corner_texcoords);
        mesh.triangles.extend(corners.map(|(p, t)| std::array::from_fn(|k| (p[k], t[k]))));
    }
    Ok(mesh)
}

fn read(path: &Path, loading: &Loading) -> Result<Vec<u8>> {
    let unreadable = |e| Error::unreadable(path, e);
    let start = loading.prefix(path).map_err(unreadable)?;
    if start.has_zero() {
        return Err(is_binary(&path.display().to_string()));
    }
    start.read_all().map_err(unreadable)
}

fn is_binary(name: &str) -> Error {
    Error::input(format!("{name}: is binary, not OBJ text; use an OBJ, glTF or GLB file"))
}

/// The parsed chunks, with one triangle among them at least, and what is in the whole file.
fn read_chunks(text: &[u8], name: &str, chunk_bytes: usize, texcoords: Texcoords) -> Result<(Vec<Chunk>, Counts)> {
    let text = text.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(text);
    if text.is_empty() {
        return Err(Error::input(format!("{name}: is empty; an OBJ file with faces is needed")));
    }
    if text.contains(&0) {
        return Err(is_binary(name));
    }
    let text = &*lex::with_line_feeds(text);

    // Count, then parse every chunk knowing what lies before it.
    let pieces = lex::split_at_line_ends(text, chunk_bytes);
    let counts: Vec<Counts> = parallel::map(&pieces, |piece| Counts::of(piece));
    let mut before = Vec::with_capacity(counts.len());
    let mut total = Counts::default();
    for count in &counts {
        before.push(total);
        total = total.plus(count);
    }
    if total.positions.max(total.normals).max(total.texcoords) >= u32::MAX as usize {
        return Err(Error::input(format!("{name}: more than 2^32 - 2 vertices; split the file")));
    }
    let chunks = parallel::try_map(0..pieces.len(), |k| {
        Reader::new(name, before[k], total, texcoords).read(pieces[k], &counts[k])
    })?;

    let triangles: usize = chunks.iter().map(|c| c.triangles.len()).sum();
    if triangles > MAX_TRIANGLES {
        return Err(Error::input(format!("{name}: {triangles} triangles, at most 2^28 are possible; split the file")));
    }
    if total.positions == 0 && triangles == 0 {
        return Err(Error::input(format!("{name}: has no OBJ statements (v, f); is it an OBJ file?")));
    }
    if triangles == 0 {
        return Err(Error::input(format!("{name}: has no faces (f lines); export it as a mesh with faces")));
    }
    Ok((chunks, total))
}

/// Joins the chunks in order.
fn assemble(
    chunks: Vec<Chunk>,
    total: Counts,
    load_mtl: impl FnOnce(&[&str]) -> Result<Vec<Mapped>>,
) -> Result<(Mesh, Vec<Mapped>)> {
    let triangles: usize = chunks.iter().map(|c| c.triangles.len()).sum();
    let mut mesh = Mesh {
        positions: Vec::with_capacity(total.positions),
        triangles: Vec::with_capacity(triangles),
        material_of: Vec::with_capacity(triangles),
        ..Mesh::default()
    };
    let libraries: Vec<&str> = chunks.iter().flat_map(|c| &c.libraries).map(String::as_str).collect();
    let mapped = load_mtl(&libraries)?;
    mesh.materials.extend(mapped.iter().map(|m| m.material.clone()));
    assign_materials(&chunks, &mut mesh.materials, &mut mesh.material_of);
    let with_colors = chunks.iter().any(|c| !c.colors.is_empty());
    let full = full_color(chunks.iter().flat_map(|c| c.colors.iter().flatten()));
    mesh.parts = parts(&chunks);
    let with_normals = chunks.iter().any(|c| !c.corner_normals.is_empty());
    let with_uvs = chunks.iter().any(|c| !c.corner_texcoords.is_empty());
    for chunk in chunks {
        mesh.positions.extend_from_slice(&chunk.positions);
        if with_normals {
            let first = mesh.triangles.len() + chunk.triangles.len();
            mesh.normals.extend_from_slice(&chunk.normals);
            mesh.corner_normals.extend_from_slice(&chunk.corner_normals);
            mesh.corner_normals.resize(first, [NO_NORMAL; 3]);
        }
        if with_uvs {
            let first = mesh.triangles.len() + chunk.triangles.len();
            mesh.uvs.extend(chunk.texcoords.iter().map(|uv| uv.as_vec2()));
            mesh.corner_uvs.extend_from_slice(&chunk.corner_texcoords);
            mesh.corner_uvs.resize(first, [NO_UV; 3]);
        }
        if with_colors {
            mesh.colors.extend(chunk.colors.iter().map(|srgb| linear_color(*srgb, full)));
            mesh.colors.resize(mesh.positions.len(), [1.0; 3]);
        }
        mesh.triangles.extend_from_slice(&chunk.triangles);
    }
    if with_colors {
        mesh.corner_colors.clone_from(&mesh.triangles);
        whiten_default(&mut mesh, mapped.len());
    }
    place_uvs(&mut mesh, &mapped);
    mesh.drop_unusable();
    drop_unused_normals(&mut mesh);
    Ok((mesh, mapped))
}

/// The objects of the file (`o`), or its groups (`g`) where it has no objects; empty if it has neither.
fn parts(chunks: &[Chunk]) -> Vec<Part> {
    let has_objects = chunks.iter().flat_map(|c| &c.groups).any(|(_, is_object, _)| *is_object);
    let (mut parts, mut name, mut count) = (Vec::new(), "", 0);
    for chunk in chunks {
        let mut first = 0;
        for (start, _, next) in chunk.groups.iter().filter(|(_, is_object, _)| *is_object == has_objects) {
            count += start - first;
            first = *start;
            if *next != name {
                parts.extend((count > 0).then(|| Part { name: name.to_owned(), triangles: count }));
                (name, count) = (next.as_str(), 0);
            }
        }
        count += chunk.triangles.len() - first;
    }
    if parts.is_empty() && name.is_empty() {
        return parts;
    }
    parts.extend((count > 0).then(|| Part { name: name.to_owned(), triangles: count }));
    parts
}

/// Moves texture coordinates to where their triangles' materials have them in their images.
fn place_uvs(mesh: &mut Mesh, mapped: &[Mapped]) {
    let placements: Vec<_> = mapped.iter().map(Mapped::placement).collect();
    let is_placed = |p: &(Vec2, Vec2)| *p != (Vec2::ONE, Vec2::ZERO);
    if placements.iter().any(is_placed) {
        let mut placed: HashMap<(u32, u32), u32> = HashMap::new();
        for (corners, material) in mesh.corner_uvs.iter_mut().zip(&mesh.material_of) {
            let placement = placements.get(*material as usize).filter(|p| is_placed(p));
            let Some((scale, offset)) = placement else { continue };
            for corner in corners.iter_mut().filter(|c| **c != NO_UV) {
                *corner = *placed.entry((*corner, *material)).or_insert_with(|| {
                    mesh.uvs.push(mesh.uvs[*corner as usize] * *scale + *offset);
                    mesh.uvs.len() as u32 - 1
                });
            }
        }
    }
}

/// Appends one material index a triangle; the state of `usemtl` runs on from chunk to chunk. Of materials of
/// one name the last counts. The default material is appended to `materials` if a triangle needs it.
fn assign_materials(chunks: &[Chunk], materials: &mut Vec<Material>, material_of: &mut Vec<u32>) {
    let index_of: HashMap<String, u32> = materials.iter().zip(0..).map(|(m, i)| (m.name.clone(), i)).collect();
    let fallback = materials.len() as u32;
    let mut current = fallback;
    for chunk in chunks {
        let start = material_of.len();
        for (first_triangle, material) in &chunk.uses {
            material_of.resize(start + first_triangle, current);
            current = index_of.get(material).copied().unwrap_or(fallback);
        }
        material_of.resize(start + chunk.triangles.len(), current);
    }
    if material_of.contains(&fallback) {
        materials.push(Material::default());
    }
}

/// Where vertices have colours, triangles without a material show these as they are.
fn whiten_default(mesh: &mut Mesh, fallback: usize) {
    if let Some(material) = mesh.materials.get_mut(fallback) {
        material.diffuse = [1.0; 3];
    }
}

/// Empties the lists of normals when no corner has one.
fn drop_unused_normals(mesh: &mut Mesh) {
    // No corner refers to these any more; every normal of a mesh has unit length.
    mesh.normals.iter_mut().filter(|n| **n == Vec3::ZERO).for_each(|n| *n = Vec3::Y);
    if mesh.corner_normals.iter().flatten().all(|&n| n == NO_NORMAL) {
        mesh.normals = Vec::new();
        mesh.corner_normals = Vec::new();
    }
}
