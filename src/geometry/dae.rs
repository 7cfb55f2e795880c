//! COLLADA (.dae), as robots' models have it: the placed triangles of its scene: <https://www.khronos.org/collada/>.

mod geometry;

use super::instances::at_places;
use super::lex::{Tokens, parse_f64};
use super::load::copied;
use super::mesh::{MAX_TRIANGLES, Material, Mesh, Missing, Part};
use super::place::append_with_all;
use crate::arrays::MapEach;
use crate::input::{Error, Limits, Loading, Result};
use geometry::read_geometry;
use glam::{DAffine3, DMat3, DMat4, DVec3};
use roxmltree::{Document, Node, NodeId};
use std::borrow::Cow;
use std::collections::{BTreeSet, HashMap};
use std::path::Path;
use std::rc::Rc;

/// Most nodes of a scene, each counted as often as it is placed.
const MAX_NODES: usize = 1 << 17;

/// Reads a COLLADA file. The nodes of its scene are walked depth-first, in the file's order; that is the order of triangle ids. Polygons are
/// fan-triangulated from their first vertex, strips and fans become triangles. Normals, colours of vertices (linear RGB) and the diffuse and
/// emitted colours of materials are read. Coordinates are as in the file: neither its unit nor its upward axis changes them. Both, and the
/// images, skins and lines that are not read, are listed in [`Mesh::missing`].
///
/// # Errors
/// [`Error::Missing`] or [`Error::Read`] if it cannot be read; [`Error::Input`] naming the file: it is no COLLADA, an id or index is not there,
/// a vertex is not finite, nodes place each other; it has no triangles, or more than 2^28. [`Error::Work`] if they do not fit the free memory.
pub fn load(path: &Path, loading: &Loading) -> Result<Mesh> {
    let name = path.display().to_string();
    let unreadable = |e| Error::unreadable(path, e);
    let start = loading.prefix(path).map_err(unreadable)?;
    // UTF-16 has zero bytes
    if start.has_zero() && !matches!(start.bytes(), [0xFF, 0xFE, ..] | [0xFE, 0xFF, ..]) {
        return Err(Error::input(format!("{name}: {NO_TEXT}")));
    }
    let bytes = start.read_all().map_err(unreadable)?;
    parse(&bytes, &name, loading.limits())
}

/// Ends the line of an error.
const NO_TEXT: &str = "is neither UTF-8 nor UTF-16 text; save it as COLLADA in UTF-8";

/// As [`load`], from the file's bytes; `name` stands for the file in messages.
fn parse(bytes: &[u8], name: &str, limits: Limits) -> Result<Mesh> {
    let wrong = |what: String| Error::input(format!("{name}: {what}"));
    let text = text_of(bytes).ok_or_else(|| wrong(NO_TEXT.into()))?;
    let document = Document::parse(&text).map_err(|e| {
        // names a character that it did not expect, which may be a line's end
        wrong(format!("is no COLLADA: {e}").replace(char::is_control, " "))
    })?;
    let root = document.root_element();
    if root.tag_name().name() != "COLLADA" {
        return Err(wrong("is no COLLADA: its first element is another one".into()));
    }
    let ids = document.descendants().filter_map(|node| Some((node.attribute("id")?, node))).collect();
    let mut scene = Scene { ids, limits, mesh: Mesh::default(), geometries: HashMap::new(), left_out: BTreeSet::new() };
    let placed = scene.place(root);
    placed.map_err(|e| e.at(name))?;
    let Scene { mut mesh, mut left_out, .. } = scene;
    if mesh.triangles.is_empty() {
        return Err(wrong("has no triangles in its scene; export one with meshes".into()));
    }
    mesh.settle_unused().map_err(|k| wrong(format!("vertex {k} is not finite; use finite numbers")))?;
    mesh.drop_unusable();
    left_out.extend(conventions(root));
    let missing = |(what, why): (String, String)| Missing { what: format!("{what} of {name}"), why };
    mesh.missing = left_out.into_iter().map(missing).collect();
    Ok(mesh)
}

/// UTF-8, or UTF-16 after its mark of the order of bytes.
fn text_of(bytes: &[u8]) -> Option<Cow<'_, str>> {
    let units = |of: fn([u8; 2]) -> u16| bytes[2..].as_chunks::<2>().0.iter().map(move |pair| of(*pair));
    match bytes {
        [0xFF, 0xFE, ..] => String::from_utf16(&units(u16::from_le_bytes).collect::<Vec<_>>()).ok().map(Cow::Owned),
        [0xFE, 0xFF, ..] => String::from_utf16(&units(u16::from_be_bytes).collect::<Vec<_>>()).ok().map(Cow::Owned),
        _ => std::str::from_utf8(bytes).ok().map(Cow::Borrowed),
    }
}

/// A note on the unit and the upward axis, unless they are meters and +y, as in a scene.
fn conventions(root: Node) -> Option<(String, String)> {
    let asset = child(root, "asset")?;
    let unit = child(asset, "unit").and_then(|unit| unit.attribute("meter")).unwrap_or("1");
    let up = child(asset, "up_axis").and_then(|up| up.text()).unwrap_or("Y_UP").trim();
    let is_usual = parse_f64(unit.as_bytes()) == Some(1.0) && up == "Y_UP";
    let why = format!("{unit:.20?} m and {up:.20?}; coordinates are as in the file, scale and rotate change them");
    (!is_usual).then(|| ("unit and axis".into(), why))
}

/// A node that waits to be placed.
struct Placed<'a> {
    node: Node<'a, 'a>,
    world_from_parent: DAffine3,
    /// The nodes by whose instances it is placed.
    within: Rc<[NodeId]>,
}

struct Scene<'a> {
    ids: HashMap<&'a str, Node<'a, 'a>>,
    limits: Limits,
    mesh: Mesh,
    /// Meshes by the ids of their geometries; materials have the names by which instances bind them.
    geometries: HashMap<&'a str, Mesh>,
    /// Parts of the file that are left out, and why.
    left_out: BTreeSet<(String, String)>,
}

impl<'a> Scene<'a> {
    /// The element that a reference such as `#id` names.
    fn find(&self, of: Node<'a, 'a>, attribute: &str) -> Result<Node<'a, 'a>> {
        let url = of.attribute(attribute).unwrap_or_default();
        let found = url.strip_prefix('#').and_then(|id| self.ids.get(id));
        found.copied().ok_or_else(|| {
            let kind = of.tag_name().name();
            Error::input(format!("a {kind} names {url:.40?}, which the file does not have; export it again"))
        })
    }

    /// Walks the nodes of the scene with a stack of its own.
    fn place(&mut self, root: Node<'a, 'a>) -> Result<()> {
        let instance = child(root, "scene").and_then(|scene| child(scene, "instance_visual_scene"));
        let top = match instance {
            Some(instance) => self.find(instance, "url")?,
            None => root.descendants().find(|n| n.has_tag_name("visual_scene")).unwrap_or(root),
        };
        let nodes = |of: Node<'a, 'a>| of.children().filter(|n| n.tag_name().name() == "node");
        let place_in_world = |node| Placed { node, world_from_parent: DAffine3::IDENTITY, within: Rc::default() };
        let mut stack: Vec<Placed> = nodes(top).map(place_in_world).collect();
        stack.reverse();
        let mut placed = 0;
        while let Some(Placed { node, world_from_parent, within }) = stack.pop() {
            placed += 1;
            if placed > MAX_NODES || stack.len() > MAX_NODES {
                return Err(Error::input(format!("more than {MAX_NODES} nodes; split the file")));
            }
            let world_from_node = world_from_parent * parent_from_node(node);
            let first = stack.len();
            for part in node.children() {
                match part.tag_name().name() {
                    "node" => {
                        stack.push(Placed { node: part, world_from_parent: world_from_node, within: within.clone() })
                    }
                    "instance_node" => {
                        let node = self.find(part, "url")?;
                        if within.contains(&node.id()) {
                            return Err(Error::input("a node is within itself; nodes must not place each other"));
                        }
                        let within = within.iter().copied().chain([node.id()]).collect();
                        stack.push(Placed { node, world_from_parent: world_from_node, within });
                    }
                    "instance_geometry" => {
                        let geometry = self.find(part, "url")?;
                        self.place_geometry(node, geometry, part, world_from_node)?;
                    }
                    "instance_controller" => {
                        let why = "meshes with skins are drawn as they were bound".into();
                        self.left_out.insert(("skins".into(), why));
                        let skin = self.find(part, "url")?.children().find(|n| n.tag_name().name() == "skin");
                        let Some(skin) = skin else { continue };
                        let geometry = self.find(skin, "source")?;
                        self.place_geometry(node, geometry, part, world_from_node)?;
                    }
                    _ => {}
                }
            }
            stack[first..].reverse();
        }
        Ok(())
    }

    /// Appends the triangles of a geometry, with the materials that its instance binds.
    fn place_geometry(
        &mut self,
        node: Node<'a, 'a>,
        geometry: Node<'a, 'a>,
        instance: Node<'a, 'a>,
        world_from_node: DAffine3,
    ) -> Result<()> {
        let id = geometry.attribute("id").unwrap_or_default();
        let mesh = match self.geometries.get(id) {
            Some(known) => known.clone(),
            None => {
                let read = read_geometry(geometry, &self.ids, &mut self.left_out);
                let mesh = read.map_err(|what| Error::input(format!("geometry {id:.40?}: {what}")))?;
                self.geometries.insert(id, mesh.clone());
                mesh
            }
        };
        let triangles = mesh.triangles.len();
        if self.mesh.triangles.len() + triangles > MAX_TRIANGLES {
            return Err(Error::input("more than 2^28 triangles; split the file"));
        }
        if triangles == 0 {
            return Ok(());
        }
        let mut mesh = copied(at_places(mesh, [world_from_node]), self.limits)?;
        for material in &mut mesh.materials {
            let bound = instance
                .descendants()
                .find(|n| n.tag_name().name() == "instance_material" && n.attribute("symbol") == Some(&material.name));
            if let Some(bound) = bound.and_then(|bound| self.ids.get(bound.attribute("target")?.strip_prefix('#')?)) {
                *material = self.material(*bound, material);
            }
        }
        append_with_all(&mut self.mesh, mesh);
        let name = node.attribute("name").or(geometry.attribute("name")).unwrap_or_default().to_owned();
        self.mesh.parts.push(Part { name, triangles });
        Ok(())
    }

    /// The look of a material's effect; `plain` where it has none.
    fn material(&mut self, from: Node<'a, 'a>, plain: &Material) -> Material {
        let name = from.attribute("name").or(from.attribute("id")).unwrap_or_default();
        let effect = || self.ids.get(child(from, "instance_effect")?.attribute("url")?.strip_prefix('#')?);
        let Some(effect) = effect() else { return Material { name: name.into(), ..plain.clone() } };
        let color = |key: &str| {
            let of = effect.descendants().find(|n| n.tag_name().name() == key)?;
            let [r, g, b] = numbers::<3>(child(of, "color")?)?;
            Some([r, g, b].map_each(|c| c as f32))
        };
        if effect.descendants().any(|n| n.tag_name().name() == "texture") {
            let why = "images of COLLADA are not read; materials have their plain colours".into();
            self.left_out.insert(("textures".into(), why));
        }
        let in_range = |rgb: [f32; 3], most: f32| rgb.map_each(|c| if c >= 0.0 { c.min(most) } else { 0.0 });
        Material {
            name: name.into(),
            diffuse: color("diffuse").map_or(plain.diffuse, |rgb| in_range(rgb, 1.0)),
            emissive: color("emission").map_or([0.0; 3], |rgb| in_range(rgb, f32::MAX)),
            ..plain.clone()
        }
    }
}

/// The product of a node's transforms, in the file's order.
fn parent_from_node(node: Node) -> DAffine3 {
    let mut all = DAffine3::IDENTITY;
    for part in node.children() {
        let vector = || numbers::<3>(part).map_or(DVec3::ZERO, DVec3::from);
        all *= match part.tag_name().name() {
            "matrix" => match numbers::<16>(part) {
                Some(rows) => DAffine3::from_mat4(DMat4::from_cols_array(&rows).transpose()),
                None => continue,
            },
            "translate" => DAffine3::from_translation(vector()),
            "scale" => DAffine3::from_scale(vector()),
            "rotate" => match numbers::<4>(part) {
                Some([x, y, z, degrees]) => {
                    let turned = |axis| DMat3::from_axis_angle(axis, degrees.to_radians());
                    DAffine3::from_mat3(DVec3::new(x, y, z).try_normalize().map_or(DMat3::IDENTITY, turned))
                }
                None => continue,
            },
            _ => continue,
        };
    }
    all
}

fn child<'a>(of: Node<'a, 'a>, name: &str) -> Option<Node<'a, 'a>> {
    of.children().find(|n| n.tag_name().name() == name)
}

/// All numbers of an element's text; other words become NaN.
fn all_numbers(of: Node) -> Vec<f64> {
    Tokens::new(of.text().unwrap_or_default().as_bytes()).map(|token| parse_f64(token).unwrap_or(f64::NAN)).collect()
}

/// The first numbers of an element's text, if there are so many.
fn numbers<const N: usize>(of: Node) -> Option<[f64; N]> {
    all_numbers(of).first_chunk().copied()
}

#[cfg(test)]
mod tests;
