//! The triangles of a COLLADA geometry.

use super::{all_numbers, child};
use crate::arrays::MapEach;
use crate::geometry::lex::{Tokens, parse_i64};
use crate::geometry::mesh::{Material, Mesh, NO_COLOR, NO_NORMAL, NO_UV};
use glam::{DVec3, Vec2};
use roxmltree::Node;
use std::collections::{BTreeSet, HashMap};

/// Where one of a corner's indices leads.
#[derive(Debug, Clone, Copy)]
struct Input {
    /// The index's place in a corner.
    offset: usize,
    /// The first of the source's values in the mesh, and their number.
    first: u32,
    count: usize,
}

/// Semantics of the inputs that are read, and their names in errors.
const SEMANTICS: [(&str, &str); 4] =
    [("POSITION", "position"), ("NORMAL", "normal"), ("TEXCOORD", "uv"), ("COLOR", "color")];

/// What the indices of a corner lead to.
#[derive(Debug, Default)]
struct Inputs {
    /// By [`SEMANTICS`].
    of: [Option<Input>; 4],
    /// Indices of a corner.
    stride: usize,
}

/// Values of sources that are in the mesh already, by the id of the source and their place in [`SEMANTICS`].
type Known<'a> = HashMap<(&'a str, usize), (u32, usize)>;

type Ids<'a> = HashMap<&'a str, Node<'a, 'a>>;

/// The mesh of a geometry, in its own coordinates. Its materials have the symbols of its triangles as names.
///
/// # Errors
/// What is wrong, without the geometry's name.
pub(super) fn read_geometry<'a>(
    geometry: Node<'a, 'a>,
    ids: &Ids<'a>,
    left_out: &mut BTreeSet<(String, String)>,
) -> Result<Mesh, String> {
    let mut mesh = Mesh::default();
    let Some(from) = child(geometry, "mesh") else {
        left_out.insert(("geometries".into(), "only meshes are drawn, no splines or hulls".into()));
        return Ok(mesh);
    };
    let mut known = Known::new();
    for primitive in from.children().filter(Node::is_element) {
        let kind = primitive.tag_name().name();
        match kind {
            "triangles" | "polylist" | "polygons" | "tristrips" | "trifans" => {}
            "lines" | "linestrips" => {
                left_out.insert(("lines".into(), "they are no triangles".into()));
                continue;
            }
            _ => continue,
        }
        let inputs = Inputs::read(primitive, ids, &mut known, &mut mesh)?;
        let symbol = primitive.attribute("material").unwrap_or("default");
        let material = mesh.materials.iter().position(|m| m.name == symbol).unwrap_or_else(|| {
            mesh.materials.push(Material { name: symbol.into(), ..Material::default() });
            mesh.materials.len() - 1
        });
        let mut lengths = child(primitive, "vcount").map(all_numbers).unwrap_or_default().into_iter();
        let lists = primitive.descendants().filter(|n| n.tag_name().name() == "p");
        for list in lists {
            let indices = read_indices(list, &inputs)?;
            let corners: Vec<&[usize]> = indices.chunks_exact(inputs.stride).collect();
            match kind {
                "triangles" => corners.chunks_exact(3).for_each(|t| add(&mut mesh, &inputs, [t[0], t[1], t[2]])),
                "polylist" => {
                    let mut rest = &corners[..];
                    for length in lengths.by_ref() {
                        let Some((polygon, after)) = rest.split_at_checked(length as usize) else {
                            return Err("its vcount names more corners than there are; export it again".into());
                        };
                        rest = after;
                        fan(&mut mesh, &inputs, polygon);
                    }
                }
                "tristrips" => {
                    for (k, w) in corners.windows(3).enumerate() {
                        let ordered = if k % 2 == 0 { [w[0], w[1], w[2]] } else { [w[1], w[0], w[2]] };
                        add(&mut mesh, &inputs, ordered);
                    }
                }
                // polygons, one a list, and fans
                _ => fan(&mut mesh, &inputs, &corners),
            }
        }
        mesh.material_of.resize(mesh.triangles.len(), material as u32);
        fill(&mut mesh);
    }
    if !mesh.corner_colors.is_empty() {
        // colours of vertices are shown as they are
        mesh.materials.iter_mut().for_each(|m| m.diffuse = [1.0; 3]);
    }
    Ok(mesh)
}

/// Triangles whose primitive has no such input say so.
fn fill(mesh: &mut Mesh) {
    let count = mesh.triangles.len();
    for (corners, is_there, none) in [
        (&mut mesh.corner_normals, !mesh.normals.is_empty(), NO_NORMAL),
        (&mut mesh.corner_uvs, !mesh.uvs.is_empty(), NO_UV),
        (&mut mesh.corner_colors, !mesh.colors.is_empty(), NO_COLOR),
    ] {
        if is_there {
            corners.resize(count, [none; 3]);
        }
    }
}

impl Inputs {
    fn read<'a>(
        primitive: Node<'a, 'a>,
        ids: &Ids<'a>,
        known: &mut Known<'a>,
        mesh: &mut Mesh,
    ) -> Result<Inputs, String> {
        let mut inputs = Inputs { stride: 1, ..Inputs::default() };
        let of = |node: Node<'a, 'a>| node.children().filter(|n| n.tag_name().name() == "input");
        for input in of(primitive) {
            let offset = input.attribute("offset").unwrap_or("0");
            let offset =
                offset.trim().parse().ok().filter(|k| *k < 64).ok_or("an input has no offset; export it again")?;
            inputs.stride = inputs.stride.max(offset + 1);
            let source = find(input, ids)?;
            match input.attribute("semantic") {
                // what a vertex has goes by its index
                Some("VERTEX") => {
                    for own in of(source) {
                        inputs.add(own, find(own, ids)?, offset, known, mesh)?;
                    }
                }
                _ => inputs.add(input, source, offset, known, mesh)?,
            }
        }
        Ok(inputs)
    }

    /// Takes an input, and its source's values into the mesh.
    fn add<'a>(
        &mut self,
        input: Node<'a, 'a>,
        source: Node<'a, 'a>,
        offset: usize,
        known: &mut Known<'a>,
        mesh: &mut Mesh,
    ) -> Result<(), String> {
        let semantic = input.attribute("semantic").unwrap_or_default();
        let Some(what) = SEMANTICS.iter().position(|(name, _)| *name == semantic) else { return Ok(()) };
        // of several sets of texture coordinates or colours the first counts
        if what >= 2 && self.of[what].is_some() {
            return Ok(());
        }
        let key = (source.attribute("id").unwrap_or_default(), what);
        let (first, count) = match known.get(&key) {
            Some(known) => *known,
            None => {
                let added = take(source, SEMANTICS[what].1, mesh)?;
                known.insert(key, added);
                added
            }
        };
        self.of[what] = Some(Input { offset, first, count });
        Ok(())
    }
}

fn find<'a>(input: Node<'a, 'a>, ids: &Ids<'a>) -> Result<Node<'a, 'a>, String> {
    let url = input.attribute("source").unwrap_or_default();
    let found = url.strip_prefix('#').and_then(|id| ids.get(id)).copied();
    found.ok_or_else(|| format!("an input names {url:.40?}, which the file does not have; export it again"))
}

/// Appends the values of a source to the mesh: the index of the first, and their number.
fn take(source: Node, what: &str, mesh: &mut Mesh) -> Result<(u32, usize), String> {
    let width = if what == "uv" { 2 } else { 3 };
    let array = child(source, "float_array").ok_or("a source has no float_array; export it again")?;
    let values = all_numbers(array);
    let accessor = child(source, "technique_common").and_then(|common| child(common, "accessor"));
    let number = |key: &str, default: usize| match accessor.and_then(|a| a.attribute(key)) {
        Some(text) => text.trim().parse().map_err(|_| format!("an accessor's {key} is no number; export it again")),
        None => Ok(default),
    };
    let (stride, offset): (usize, usize) = (number("stride", width)?, number("offset", 0)?);
    if stride < width {
        return Err(format!("a source has {stride} of {width} numbers for each {what}; export it again"));
    }
    let rows: Vec<&[f64]> =
        values.get(offset..).unwrap_or_default().chunks(stride).filter(|row| row.len() >= width).collect();
    let vector = |row: &&[f64]| DVec3::new(row[0], row[1], row[2]);
    let first = match what {
        "position" => {
            mesh.positions.extend(rows.iter().map(vector));
            mesh.positions.len()
        }
        "normal" => {
            mesh.normals.extend(rows.iter().map(|row| vector(row).normalize_or_zero().as_vec3()));
            mesh.normals.len()
        }
        "uv" => {
            mesh.uvs.extend(rows.iter().map(|row| Vec2::new(row[0] as f32, row[1] as f32)));
            mesh.uvs.len()
        }
        _ => {
            let in_range = |c: f64| if c.is_finite() { c.clamp(0.0, 1.0) as f32 } else { 1.0 };
            mesh.colors.extend(rows.iter().map(|row| [in_range(row[0]), in_range(row[1]), in_range(row[2])]));
            mesh.colors.len()
        }
    } - rows.len();
    let first = u32::try_from(first + rows.len()).map(|end| end - rows.len() as u32);
    Ok((first.map_err(|_| "more than 2^32 values are not possible; split the file")?, rows.len()))
}

/// The indices of a list, each in range of its input.
fn read_indices(list: Node, inputs: &Inputs) -> Result<Vec<usize>, String> {
    let index = |token: &[u8]| parse_i64(token).and_then(|k| usize::try_from(k).ok());
    let all = Tokens::new(list.text().unwrap_or_default().as_bytes()).map(index).collect::<Option<Vec<usize>>>();
    let all = all.ok_or("an index is no whole number from 0; export it again")?;
    if inputs.of[0].is_none() {
        return Err("it has no positions; export it again".into());
    }
    for input in inputs.of.iter().flatten() {
        let mut own = all.chunks_exact(inputs.stride).map(|corner| corner[input.offset]);
        if let Some(index) = own.find(|index| *index >= input.count) {
            return Err(format!("index {index} of {} values; export it again", input.count));
        }
    }
    Ok(all)
}

fn fan(mesh: &mut Mesh, inputs: &Inputs, polygon: &[&[usize]]) {
    polygon.windows(2).skip(1).for_each(|pair| add(mesh, inputs, [polygon[0], pair[0], pair[1]]));
}

/// Appends a triangle, whose indices are in range.
fn add(mesh: &mut Mesh, inputs: &Inputs, corners: [&[usize]; 3]) {
    let before = mesh.triangles.len();
    let Mesh { triangles, corner_normals, corner_uvs, corner_colors, .. } = mesh;
    for (list, input) in [triangles, corner_normals, corner_uvs, corner_colors].into_iter().zip(&inputs.of) {
        if let Some(input) = input {
            // triangles before may have none: `NO_UV` and `NO_COLOR` are the same number
            list.resize(before, [NO_NORMAL; 3]);
            list.push(corners.map_each(|corner| input.first + corner[input.offset] as u32));
        }
    }
}
