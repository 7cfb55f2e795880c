//! PLY: polygons with what their vertices have, as text or binary: <http://paulbourke.net/dataformats/ply/>.

mod body;
mod element;
mod faces;
mod points;
mod read;
#[cfg(test)]
mod tests;

use super::lex::HAS_ZEROS;
use super::mesh::{MAX_TRIANGLES, Material, Mesh, Missing, NO_UV, check_memory};
use super::texture::{Images, ImagesRead, Texture};
use crate::input::{Error, Limits, Loading, Result};
use body::Body;
use element::{Color, VertexProperties, Vertices};
use faces::{FaceProperties, Faces, FileFacts, not_finite};
use read::{Element, Encoding, Header};
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

/// What is made of a file's header and of the data behind it.
fn read_file<T>(
    path: &Path,
    loading: &Loading,
    parse: impl FnOnce(&Header, Body, Limits) -> std::result::Result<T, Wrong>,
) -> Result<T> {
    let name = path.display().to_string();
    let told = |e| match e {
        Wrong::Line(line, text) => Error::input(format!("{name}:{line}: {text}")),
        Wrong::File(text) => Error::input(format!("{name}: {text}")),
        Wrong::Memory(e) => e.at(&name),
        Wrong::Unreadable(e) => Error::unreadable(path, e),
    };
    let unreadable = |e| Error::unreadable(path, e);
    let start = loading.prefix(path).map_err(unreadable)?;
    // a header may be longer than what is read first, if it is text
    let has_header = !start.bytes().starts_with(b"ply") || start.has_zero() || Header::is_whole(start.bytes());
    let (length, goes_on_after_zero) = (start.length(), start.goes_on_after_zero());
    if !has_header && !start.is_whole() {
        let what = format_args!("a file of {length} bytes");
        loading.limits().check_memory(length, what, "use a smaller one").map_err(|e| e.at(&name))?;
    }
    let mut window = start.into_window().map_err(unreadable)?;
    if !has_header {
        window.read_all().map_err(unreadable)?;
    }
    let (header, header_end) = Header::parse(window.bytes()).map_err(told)?;
    if header.encoding == Encoding::Ascii && goes_on_after_zero {
        return Err(Error::input(format!("{name}: {HAS_ZEROS}")));
    }
    check_sizes(&header, length, loading.limits()).map_err(told)?;
    parse(&header, Body::new(window, header_end), loading.limits()).map_err(told)
}

/// What is wrong with a file.
#[derive(Debug)]
enum Wrong {
    /// With the line, from 1.
    Line(usize, String),
    File(String),
    Memory(Error),
    Unreadable(std::io::Error),
}

/// The mesh, and the names of its images.
fn parse(header: &Header, mut body: Body, limits: Limits) -> std::result::Result<(Mesh, Vec<String>), Wrong> {
    let textures: Vec<String> = header
        .comments
        .iter()
        .filter_map(|c| c.trim().strip_prefix("TextureFile").map(|file| file.trim().to_owned()))
        .collect();
    let is_face = |element: &&Element| faces::NAMES.contains(&element.name.as_str()) && element.count > 0;
    let facts = FileFacts {
        vertices: header.elements.iter().rfind(|e| e.name == "vertex").map_or(0, |e| e.count),
        textures: textures.len(),
        has_face_colors: header.elements.iter().filter(is_face).any(|e| Color::of(e).is_some()),
    };
    let (mut vertices, mut faces) = (Vertices::default(), Faces::default());
    for element in &header.elements {
        match element.name.as_str() {
            "vertex" => {
                let properties = VertexProperties::of(element)?;
                vertices = Vertices::default();
                vertices.reserve(element.count, &properties);
                body.read(element, |part| properties.read(part), |part| vertices.append(&part))?;
            }
            name if faces::NAMES.contains(&name) => {
                let properties = FaceProperties::of(element, facts);
                // most faces are triangles
                faces.triangles.reserve_exact(element.count);
                body.read(element, |part| properties.read(part), |part| faces.append(part))?;
            }
            _ => body.skip(element)?,
        }
    }
    let triangles = faces.promised;
    if triangles > MAX_TRIANGLES {
        return Err(Wrong::File(format!("{triangles} triangles, at most 2^28 are possible; split the file")));
    }
    let what = format_args!("{triangles} triangles");
    check_memory(limits, (triangles as u64, vertices.positions.len() as u64), what, "use fewer")
        .map_err(Wrong::Memory)?;
    if faces.count == 0 {
        return Err(Wrong::File("has no faces; render points as spheres, by [[spheres]]".into()));
    }
    Ok((assemble(vertices, faces, textures.len())?, textures))
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

/// Makes a mesh of what was read.
fn assemble(vertices: Vertices, faces: Faces, textures: usize) -> std::result::Result<Mesh, Wrong> {
    if let Some(wrong) = faces.wrong {
        return Err(wrong);
    }
    let mut mesh = Mesh { positions: vertices.positions, triangles: faces.triangles, ..Mesh::default() };
    let count = mesh.triangles.len();
    if count == 0 {
        return Err(Wrong::File("has no triangles; render points as spheres, by [[spheres]]".into()));
    }
    mesh.settle_unused().map_err(|k| {
        let [x, y, z] = mesh.positions[k].to_array();
        Wrong::File(format!("vertex {k} lies at ({x}, {y}, {z}); use finite numbers"))
    })?;
    mesh.material_of = match faces.textures.is_empty() {
        // memory of zeros is taken when it is written
        true => vec![0; count],
        false => faces.textures,
    };
    mesh.material_of.resize(count, 0);
    // attributes of faces go before attributes of vertices
    if !faces.colors.is_empty() {
        (mesh.colors, mesh.corner_colors) = (faces.colors, faces.corner_colors);
    } else if !vertices.colors.is_empty() {
        mesh.colors = used_colors(&vertices.colors, &mesh.triangles)?;
        mesh.corner_colors.clone_from(&mesh.triangles);
    }
    if faces.has_uvs {
        (mesh.uvs, mesh.corner_uvs) = (faces.uvs, faces.corner_uvs);
        mesh.corner_uvs.resize(count, [NO_UV; 3]);
    } else if !vertices.uvs.is_empty() {
        mesh.uvs = vertices.uvs;
        mesh.corner_uvs.clone_from(&mesh.triangles);
    }
    if !vertices.normals.is_empty() {
        mesh.normals = vertices.normals;
        mesh.corner_normals.clone_from(&mesh.triangles);
    }
    mesh.drop_unusable();
    let white = Material { diffuse: [1.0; 3], ..Material::default() };
    let material = if mesh.corner_colors.is_empty() { Material::default() } else { white };
    mesh.materials = vec![material; textures.max(1)];
    Ok(mesh)
}

/// The colours of vertices; white where no triangle has a vertex.
///
/// # Errors
/// A triangle has a vertex whose colour is not finite.
fn used_colors(colors: &[Option<[f32; 3]>], triangles: &[[u32; 3]]) -> std::result::Result<Vec<[f32; 3]>, Wrong> {
    let mut is_used = vec![false; colors.len()];
    triangles.iter().flatten().for_each(|k| is_used[*k as usize] = true);
    let color = |(k, (color, is_used)): (usize, (&Option<[f32; 3]>, bool))| match is_used {
        true => color.ok_or_else(|| not_finite(format_args!("vertex {k}"))),
        false => Ok([1.0; 3]),
    };
    colors.iter().zip(is_used).enumerate().map(color).collect()
}
