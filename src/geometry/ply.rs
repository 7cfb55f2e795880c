//! PLY: polygons with what their vertices have, as text or binary: <http://paulbourke.net/dataformats/ply/>.

mod element;
mod points;
mod read;
#[cfg(test)]
mod tests;

use super::lex::HAS_ZEROS;
use super::mesh::{MAX_TRIANGLES, Material, Mesh, Missing, NO_NORMAL, NO_UV, check_memory};
use super::texture::{Images, ImagesRead, Texture, linear_of_srgb};
use crate::arrays::MapEach;
use crate::input::{Error, Limits, Loading, Result};
use element::{Face, STRIP_END, Vertex, VertexProperties, read_faces};
use glam::Vec2;
use read::{Encoding, Header};
use std::path::Path;

pub use points::load_points;

/// Reads a PLY file. Its faces are fan-triangulated from their first vertex, triangle strips (`tristrips`) cut up; zero-area triangles
/// stay, so that ids are file order.
///
/// Of vertices `x y z`, `nx ny nz`, `red green blue` (or `r g b`, `diffuse_red diffuse_green diffuse_blue`) and `s t` (or `u v`, `texture_u
/// texture_v`) are read, of faces `vertex_indices` (or `vertex_index`), `texcoord`, `texnumber` and such colours. Colours are sRGB: floats from 0 to 1, `ushort` from 0 to 65535, other integers from 0 to 255. Images are those of
/// the comments `TextureFile`, beside the file. Those that do not exist are left out, and listed in [`Mesh::missing`].
///
/// # Errors
/// [`Error::Missing`] or [`Error::Read`] if it cannot be read; [`Error::Input`] naming the file, and the line of a text: it is damaged, has no faces or more than 2^28 triangles; a
/// vertex or colour that a face has is not finite, an index has no vertex, a face has fewer than 3; an image exists and cannot be read. [`Error::Work`] if the
/// mesh does not fit the free memory.
pub fn load(path: &Path, images: &mut Images, loading: &Loading) -> Result<Mesh> {
    let name = path.display().to_string();
    let (mut mesh, textures) = read_file(path, loading, parse)?;
    if let (Some(first), true) = (textures.first(), images.read != ImagesRead::None && mesh.corner_uvs.is_empty()) {
        let why = format!("it names the image {first}; a plain colour is used");
        mesh.missing.push(Missing { what: format!("texture coordinates of {name}"), why });
    }
    if images.read != ImagesRead::None && !mesh.corner_uvs.is_empty() {
        let folder = path.parent().unwrap_or(Path::new(""));
        for (material, file) in mesh.materials.iter_mut().zip(&textures) {
            let file = folder.join(file);
            if !images.read.reads(false) {
                // the colour that it has with its image
                loading.note(&file);
                material.diffuse = if file.is_file() { [1.0; 3] } else { material.diffuse };
                continue;
            }
            match images.find(&file, loading)? {
                Ok(texels) => (material.texture, material.diffuse) = (Some(Texture::new(texels)), [1.0; 3]),
                Err(absent) => {
                    let why = format!("{name}: {absent}; a plain colour is used");
                    mesh.missing.push(Missing { what: file.display().to_string(), why });
                }
            }
        }
    }
    Ok(mesh)
}

/// What is made of a file's bytes.
fn read_file<T>(
    path: &Path,
    loading: &Loading,
    parse: impl FnOnce(&[u8], Limits) -> std::result::Result<T, Wrong>,
) -> Result<T> {
    let name = path.display().to_string();
    let told = |e| match e {
        Wrong::Line(line, text) => Error::input(format!("{name}:{line}: {text}")),
        Wrong::File(text) => Error::input(format!("{name}: {text}")),
        Wrong::Memory(e) => e.at(&name),
    };
    let unreadable = |e| Error::unreadable(path, e);
    let start = loading.prefix(path).map_err(unreadable)?;
    // a header may be longer than what is read first, if it is text
    if !start.bytes().starts_with(b"ply") || start.has_zero() || Header::is_whole(start.bytes()) {
        let (header, _) = Header::parse(start.bytes()).map_err(told)?;
        if header.encoding == Encoding::Ascii && start.goes_on_after_zero() {
            return Err(Error::input(format!("{name}: {HAS_ZEROS}")));
        }
        check_sizes(&header, start.length(), loading.limits()).map_err(told)?;
    }
    parse(&start.read_all().map_err(unreadable)?, loading.limits()).map_err(told)
}

/// What is wrong with a file.
enum Wrong {
    /// With the line, from 1.
    Line(usize, String),
    File(String),
    Memory(Error),
}

/// The mesh, and the names of its images.
fn parse(bytes: &[u8], limits: Limits) -> std::result::Result<(Mesh, Vec<String>), Wrong> {
    let (header, mut body) = Header::parse(bytes)?;
    check_sizes(&header, bytes.len() as u64, limits)?;
    let (mut vertices, mut faces) = (Vec::new(), Vec::new());
    let mut has = Attributes::default();
    for element in &header.elements {
        match element.name.as_str() {
            "vertex" => {
                let properties = VertexProperties::of(element)?;
                has = Attributes::of(&properties);
                vertices = properties.read(&mut body, element)?;
            }
            "face" | "tristrips" => read_faces(&mut body, element, &mut faces)?,
            _ => body.read(element, &mut |_| Ok(()))?,
        }
    }
    let triangles: usize = faces.iter().map(|face| face.corners.len().saturating_sub(2)).sum();
    if triangles > MAX_TRIANGLES {
        return Err(Wrong::File(format!("{triangles} triangles, at most 2^28 are possible; split the file")));
    }
    let what = format_args!("{triangles} triangles");
    check_memory(limits, (triangles as u64, vertices.len() as u64), what, "use fewer").map_err(Wrong::Memory)?;
    if faces.is_empty() {
        return Err(Wrong::File("has no faces; render points as spheres, by [[spheres]]".into()));
    }
    let textures: Vec<String> = header
        .comments
        .iter()
        .filter_map(|c| c.trim().strip_prefix("TextureFile").map(|file| file.trim().to_owned()))
        .collect();
    Ok((assemble(&vertices, &faces, has, textures.len())?, textures))
}

/// Refuses what a header promises beyond the file's bytes, or beyond memory.
fn check_sizes(header: &Header, bytes: u64, limits: Limits) -> std::result::Result<(), Wrong> {
    for element in &header.elements {
        // a binary element may have no property, and no bytes
        let least = element.least_bytes(header.encoding);
        if (element.count as u64).saturating_mul(least.max(1)) > bytes || least == 0 && element.count > 0 {
            let (name, count, plural) = (&element.name, element.count, if element.count == 1 { "" } else { "s" });
            return Err(Wrong::File(format!("its header says {count} {name}{plural}, in a file of {bytes} bytes")));
        }
    }
    let vertices = header.count("vertex") as u64;
    let faces = header.count("face").saturating_add(header.count("tristrips")) as u64;
    check_memory(limits, (faces, vertices), format_args!("{faces} faces"), "use fewer").map_err(Wrong::Memory)
}

/// What vertices have beside their places.
#[derive(Debug, Clone, Copy, Default)]
struct Attributes {
    normals: bool,
    colors: bool,
    uvs: bool,
}

impl Attributes {
    fn of(properties: &VertexProperties) -> Attributes {
        Attributes {
            normals: properties.normal.is_some(),
            colors: properties.color.is_some(),
            uvs: properties.uv.is_some(),
        }
    }
}

/// Makes a mesh of what was read.
fn assemble(vertices: &[Vertex], faces: &[Face], has: Attributes, textures: usize) -> std::result::Result<Mesh, Wrong> {
    let mut mesh = Mesh { positions: vertices.iter().map(|v| v.position).collect(), ..Mesh::default() };
    // of faces goes before of vertices
    let colors_of_faces = faces.iter().any(|f| f.color.is_some());
    let uvs_of_faces = faces.iter().any(|f| !f.texcoords.is_empty());
    for (k, face) in faces.iter().enumerate() {
        let corners = indices(face, k, vertices.len())?;
        if corners.len() < 3 && !face.is_strip {
            return Err(Wrong::File(format!("face {k} has {} of at least 3 vertices", corners.len())));
        }
        // the corners of each triangle, by their places in the face
        let triangles = if face.is_strip { strip(&face.corners) } else { fan(corners.len() as u32) };
        if uvs_of_faces {
            let (pairs, _) = face.texcoords.as_chunks::<2>();
            if !face.texcoords.is_empty() && pairs.len() != corners.len() {
                let (count, corners) = (face.texcoords.len(), corners.len());
                return Err(Wrong::File(format!(
                    "face {k} has a texcoord of {count} numbers; give 2 for each of {corners} vertices"
                )));
            }
            let first = mesh.uvs.len() as u32;
            mesh.uvs.extend(pairs.iter().map(|uv| Vec2::from(uv.map_each(|x| x as f32))));
            let uv_of = |c: u32| if face.texcoords.is_empty() { NO_UV } else { first + c };
            mesh.corner_uvs.extend(triangles.iter().map(|t| t.map_each(uv_of)));
        }
        if colors_of_faces {
            let color = linear(face.color.unwrap_or([1.0; 3]), || format!("face {k}"))?;
            mesh.corner_colors.resize(mesh.corner_colors.len() + triangles.len(), [mesh.colors.len() as u32; 3]);
            mesh.colors.push(color);
        }
        mesh.triangles.extend(triangles.iter().map(|t| t.map_each(|c| corners[c as usize])));
        let material = usize::try_from(face.texture).ok().filter(|t| *t < textures).unwrap_or(0);
        mesh.material_of.resize(mesh.triangles.len(), material as u32);
    }
    if mesh.triangles.is_empty() {
        return Err(Wrong::File("has no triangles; render points as spheres, by [[spheres]]".into()));
    }
    mesh.settle_unused().map_err(|k| {
        let [x, y, z] = vertices[k].position.to_array();
        Wrong::File(format!("vertex {k} lies at ({x}, {y}, {z}); use finite numbers"))
    })?;
    if has.colors && !colors_of_faces {
        let mut is_used = vec![false; vertices.len()];
        mesh.triangles.iter().flatten().for_each(|k| is_used[*k as usize] = true);
        let color = |((k, v), is_used): ((usize, &Vertex), bool)| match is_used {
            true => linear(v.color, || format!("vertex {k}")),
            false => Ok([1.0; 3]),
        };
        mesh.colors = vertices.iter().enumerate().zip(is_used).map(color).collect::<std::result::Result<_, _>>()?;
        mesh.corner_colors.clone_from(&mesh.triangles);
    }
    if has.uvs && !uvs_of_faces {
        mesh.uvs = vertices.iter().map(|v| v.uv.as_vec2()).collect();
        mesh.corner_uvs.clone_from(&mesh.triangles);
    }
    if has.normals {
        mesh.normals = vertices.iter().map(|v| v.normal.normalize_or_zero().as_vec3()).collect();
        mesh.corner_normals.clone_from(&mesh.triangles);
    }
    drop_unusable(&mut mesh);
    let white = Material { diffuse: [1.0; 3], ..Material::default() };
    let material = if mesh.corner_colors.is_empty() { Material::default() } else { white };
    mesh.materials = vec![material; textures.max(1)];
    Ok(mesh)
}

/// Corners whose normal has no direction, or whose texture coordinates are not finite, have none.
fn drop_unusable(mesh: &mut Mesh) {
    for corner in mesh.corner_normals.iter_mut().flatten() {
        if !mesh.normals[*corner as usize].is_normalized() {
            *corner = NO_NORMAL;
        }
    }
    for corner in mesh.corner_uvs.iter_mut().flatten().filter(|c| **c != NO_UV) {
        if !mesh.uvs[*corner as usize].is_finite() {
            *corner = NO_UV;
        }
    }
}

/// Linear light of an sRGB colour from 0 to 1.
fn linear(color: [f64; 3], of: impl Fn() -> String) -> std::result::Result<[f32; 3], Wrong> {
    if color.iter().all(|c| c.is_finite()) {
        return Ok(color.map_each(|c| linear_of_srgb(c.clamp(0.0, 1.0)) as f32));
    }
    Err(Wrong::File(format!("{} has a colour that is not finite; use finite numbers", of())))
}

/// The vertices of a face; of the ends of strips, -1, any number.
fn indices(face: &Face, number: usize, vertices: usize) -> std::result::Result<Vec<u32>, Wrong> {
    let index = |k: &i64| match usize::try_from(*k) {
        Ok(index) if index < vertices => Ok(index as u32),
        _ if *k == STRIP_END && face.is_strip => Ok(0),
        _ => Err(Wrong::File(format!("face {number} names vertex {k}; there are {vertices}, from 0"))),
    };
    face.corners.iter().map(index).collect()
}

fn fan(corners: u32) -> Vec<[u32; 3]> {
    (2..corners).map(|c| [0, c - 1, c]).collect()
}

/// Every second triangle of a strip has its corners in reverse, so that all face the same side.
fn strip(corners: &[i64]) -> Vec<[u32; 3]> {
    let mut triangles = Vec::new();
    let mut first = 0;
    for part in corners.split(|k| *k == STRIP_END) {
        let ordered = |k: u32| if k.is_multiple_of(2) { [k, k + 1, k + 2] } else { [k + 1, k, k + 2] };
        triangles.extend((0..part.len().saturating_sub(2) as u32).map(|k| ordered(k).map_each(|c| first + c)));
        first += part.len() as u32 + 1;
    }
    triangles
}
