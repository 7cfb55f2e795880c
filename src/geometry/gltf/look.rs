//! What the triangles of a glTF file look like: materials, their images, and what of them is not drawn.

use crate::arrays::MapEach;
use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

use gltf::Primitive;
use gltf::material::AlphaMode;
use gltf::mesh::Mode;
use gltf::texture::{Info, WrappingMode};

use super::Builder;
use super::json::{MaterialParts, is_read};
use super::source::{FileAccess, Source};
use crate::geometry::mesh::{DIELECTRIC, HALF, Material, Mesh, Missing, NO_UV};
use crate::geometry::texture::{Absent, ImagesRead, Texels, Texture, Wrap, decode, unread_format};
use crate::input::{Error, Result};

/// A material without its images; with `blends` one of the mode `BLEND` is blended.
pub(super) fn material(from: &gltf::Material, kept: &MaterialParts, blends: bool) -> Material {
    let pbr = from.pbr_metallic_roughness();
    let [r, g, b, opacity] = pbr.base_color_factor();
    // what images say of these two is not read
    let has_image = pbr.metallic_roughness_texture().is_some();
    Material {
        name: from.name().unwrap_or_default().to_owned(),
        diffuse: [r, g, b].map_each(|c| c.clamp(0.0, 1.0)),
        specular: kept.specular.unwrap_or([DIELECTRIC; 3]),
        roughness: pbr.roughness_factor().clamp(0.0, 1.0),
        metallic: if has_image { 0.0 } else { pbr.metallic_factor().clamp(0.0, 1.0) },
        emissive: match from.emissive_texture() {
            Some(_) => [0.0; 3],
            None => from.emissive_factor().map_each(|c| (c * kept.emissive_strength).clamp(0.0, f32::MAX)),
        },
        blend: (blends && from.alpha_mode() == AlphaMode::Blend).then_some(opacity.clamp(0.0, 1.0)),
        two_sided: from.double_sided(),
        is_unlit: kept.is_unlit,
        ..Material::default()
    }
}

/// The least opacity at which a material has a surface; `None`: everywhere.
fn cutoff(material: &gltf::Material) -> Option<f32> {
    match material.alpha_mode() {
        AlphaMode::Opaque => None,
        AlphaMode::Mask => Some(material.alpha_cutoff().unwrap_or(0.5)),
        AlphaMode::Blend => Some(HALF),
    }
}

/// The mean opacity of a triangle's vertices.
fn mean_opacity(colors: Option<&[[f32; 4]]>, triangle: &[u32; 3]) -> f64 {
    let of = |corner: u32| colors.map_or(1.0, |c| f64::from(c[corner as usize][3]));
    // three equal f32 numbers have a sum that f64 holds, so that their mean is that number
    (of(triangle[0]) + of(triangle[1]) + of(triangle[2])) / 3.0
}

impl Builder<'_> {
    /// Which triangles of a primitive have a surface: their opacity without an image reaches the cutoff. An image cannot raise it.
    pub(super) fn visible(
        &mut self,
        primitive: &Primitive,
        triangles: &[[u32; 3]],
        colors: Option<&[[f32; 4]]>,
    ) -> impl Fn(usize) -> bool + use<> {
        let material = primitive.material();
        let pbr = material.pbr_metallic_roughness();
        let factor = f64::from(pbr.base_color_factor()[3]);
        let is_cut = self.read != ImagesRead::None && !self.is_blended(&material);
        let least = cutoff(&material).filter(|_| is_cut).map(f64::from);
        let opacity = |t: &[u32; 3]| mean_opacity(colors, t);
        let is_there: Vec<bool> = match least {
            Some(least) => triangles.iter().map(|t| factor * opacity(t) >= least).collect(),
            None => Vec::new(),
        };
        if let (Some(index), Some(_), Some(_)) = (material.index(), least, pbr.base_color_texture()) {
            let faded = triangles.iter().zip(&is_there).filter(|(t, is_there)| **is_there && opacity(t) != 1.0).count();
            if faded > 0 {
                *self.faded.entry(index).or_default() += faded;
            }
        }
        move |k| is_there.get(k).copied().unwrap_or(true)
    }

    fn is_blended(&self, material: &gltf::Material) -> bool {
        self.blends && material.alpha_mode() == AlphaMode::Blend
    }

    /// Takes the opacities of `COLOR_0` at the triangles of a primitive that come next, if its material is blended.
    pub(super) fn take_opacities(
        &mut self,
        primitive: &Primitive,
        triangles: &[[u32; 3]],
        colors: Option<&[[f32; 4]]>,
    ) {
        if colors.is_some() && self.is_blended(&primitive.material()) {
            self.opacities.resize(self.mesh.triangles.len(), u8::MAX);
            let steps = |t| (255.0 * mean_opacity(colors, t)).round() as u8;
            self.opacities.extend(triangles.iter().map(steps));
        }
    }

    /// Gives triangles of blended materials that `COLOR_0` makes less opaque a copy of their material with that opacity.
    pub(super) fn fade_materials(&mut self) {
        let mut copies = HashMap::new();
        let Mesh { materials, material_of, .. } = &mut self.mesh;
        for (material, opacity) in material_of.iter_mut().zip(&self.opacities).filter(|(_, o)| **o != u8::MAX) {
            *material = *copies.entry((*material, *opacity)).or_insert_with(|| {
                let plain = &materials[*material as usize];
                let blend = plain.blend.map(|factor| factor * f32::from(*opacity) / 255.0);
                materials.push(Material { blend, ..plain.clone() });
                materials.len() as u32 - 1
            });
        }
    }

    fn leave_out(&mut self, what: impl Into<String>, why: impl Into<String>) {
        self.mesh.missing.push(Missing { what: what.into(), why: why.into() });
    }

    /// Lists what the file says and is not drawn.
    pub(super) fn list_unread(&mut self) {
        let source = self.source;
        let (mut lines, mut morphed) = (0, 0);
        for node in source.document.nodes() {
            let primitives = || node.mesh().into_iter().flat_map(|mesh| mesh.primitives());
            let is_line =
                |p: &Primitive| matches!(p.mode(), Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip);
            lines += primitives().filter(is_line).count();
            let weights = source.kept.nodes[node.index()].weights.iter().flatten();
            let is_moved = weights.into_iter().any(|w| *w != 0.0) && primitives().any(|p| p.morph_targets().len() > 0);
            morphed += usize::from(is_moved && self.pose.is_none());
        }
        if lines > 0 {
            self.leave_out("lines and points", format!("{lines} primitives of nodes are no triangles"));
        }
        if morphed > 0 {
            self.leave_out(
                "morph targets",
                format!("{morphed} nodes have weights of them; animation = \"NAME\" applies them"),
            );
        }
        if self.read != ImagesRead::All {
            return;
        }
        let mut is_used = vec![false; self.mesh.materials.len() + 1];
        self.mesh.material_of.iter().for_each(|&m| is_used[m as usize] = true);
        let mut unread: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
        let materials = source.document.materials().zip(&source.kept.materials).zip(is_used);
        for ((material, kept), _) in materials.filter(|(_, is_used)| *is_used) {
            let name = material.name().unwrap_or_default();
            kept.unread.iter().for_each(|part| unread.entry(part).or_default().push(name));
            let opacity = material.pbr_metallic_roughness().base_color_factor()[3];
            if material.alpha_mode() == AlphaMode::Blend && !self.blends && 0.0 < opacity && opacity < 1.0 {
                let drawn = if opacity >= HALF { "it is drawn opaque" } else { "below 0.5 it is not drawn" };
                let why = format!("its opacity is {opacity}; {drawn} without blend = true");
                self.leave_out(format!("transparency of material {name:?}"), why);
            }
        }
        for (part, materials) in unread {
            let more = match materials.len() {
                1 => String::new(),
                n => format!(" and {} more", n - 1),
            };
            self.leave_out(format!("{part} of material {:?}{more}", materials[0]), "it is not read");
        }
        for (material, triangles) in std::mem::take(&mut self.faded) {
            let name = self.mesh.materials[material].name.clone();
            let why = format!("its image says alone where {triangles} of its triangles are opaque");
            self.leave_out(format!("opacity of COLOR_0 on material {name:?}"), why);
        }
        let is_of_material = |name: &String| source.kept.materials.iter().any(|m| m.unread.contains(name));
        let others = source.kept.extensions.iter().filter(|name| !is_read(name) && !is_of_material(name));
        for name in others {
            self.leave_out(format!("extension {name}"), "it is not read");
        }
    }

    /// Puts their images on the materials that triangles have, each decoded once.
    pub(super) fn hang_images(&mut self, access: FileAccess) -> Result<()> {
        let read = self.read;
        if read == ImagesRead::None {
            return Ok(());
        }
        let mut decoded = HashMap::new();
        let mut is_used = vec![false; self.mesh.materials.len() + 1];
        self.mesh.material_of.iter().for_each(|&m| is_used[m as usize] = true);
        let mut bare = vec![0; is_used.len()];
        let triangles = self.mesh.material_of.iter().zip(&self.mesh.corner_uvs);
        triangles.filter(|(_, corners)| corners.contains(&NO_UV)).for_each(|(&m, _)| bare[m as usize] += 1);
        let materials = self.source.document.materials().zip(&mut self.mesh.materials).zip(is_used).zip(bare);
        for (((from, material), _), bare) in materials.filter(|((_, is_used), _)| *is_used) {
            let Some(info) = from.pbr_metallic_roughness().base_color_texture() else { continue };
            if let Some(wrong) = &self.source.material_error {
                return Err(Error::input(format!("{wrong}; texture = false shows none")));
            }
            if !read.reads(from.alpha_mode() != AlphaMode::Opaque) {
                continue;
            }
            let texture = read_texture(self.source, access, &from, &info, &mut decoded);
            match texture.map_err(|e| Error::input(format!("{e}; texture = false shows none")))? {
                Ok(texture) => {
                    material.texture = Some(texture);
                    if bare > 0 {
                        let why = format!("missing at {bare} of its triangles; its own colour is used there");
                        let what = format!("texture coordinates of material {:?}", material.name);
                        self.mesh.missing.push(Missing { what, why });
                    }
                }
                Err((what, absent)) => {
                    let image = info.texture().source().index();
                    let why = format!("image {image}: {absent}; the material's own colour is used");
                    self.mesh.missing.push(Missing { what, why });
                }
            }
        }
        Ok(())
    }
}

/// The base colour's image, decoded once for all materials; or its name, and why it is left out.
fn read_texture(
    source: &Source,
    access: FileAccess,
    material: &gltf::Material,
    info: &Info,
    decoded: &mut HashMap<usize, Arc<Texels>>,
) -> Result<std::result::Result<Texture, (String, Absent)>> {
    let image = info.texture().source();
    let texels = match decoded.get(&image.index()) {
        Some(known) => known.clone(),
        None => {
            let at = |e: Error| e.at(format!("image {}", image.index()));
            let bytes = match source.read_image(&image, access).map_err(|e| at(Error::input(e)))? {
                Ok(bytes) => bytes,
                Err(file) => return Ok(Err((file.display().to_string(), Absent::NoFile))),
            };
            if let Some(format) = unread_format(&bytes) {
                let material = material.name().unwrap_or_default();
                return Ok(Err((format!("texture of material {material:?}"), Absent::Format(format))));
            }
            let texels = decode(&bytes).map_err(at)?;
            decoded.entry(image.index()).or_insert(Arc::new(texels)).clone()
        }
    };
    let wrap = |mode: WrappingMode| match mode {
        WrappingMode::Repeat => Wrap::Repeat,
        WrappingMode::ClampToEdge => Wrap::Clamp,
        WrappingMode::MirroredRepeat => Wrap::Mirror,
    };
    // of the image times the factor
    let factor = material.pbr_metallic_roughness().base_color_factor()[3];
    let cutoff = cutoff(material).map(|least| if factor > 0.0 { (least / factor).min(f32::MAX) } else { f32::MAX });
    let sampler = info.texture().sampler();
    Ok(Ok(Texture { texels, wrap: [wrap(sampler.wrap_s()), wrap(sampler.wrap_t())], cutoff }))
}
