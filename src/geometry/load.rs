//! Loading the meshes of a scene: read or generated, with their materials, and placed in the world.

use super::instances::{Instances, Part, Run};
use super::mesh::{self, HALF, MAX_TRIANGLES, Material, Mesh, Missing, NO_COLOR, NO_UV};
use super::parts::separate;
use super::place::{STRETCHES, keeps_spheres, size_of};
use super::spec::{AnimationSpec, MeshSource, MeshSpec, TextureSpec};
use super::spheres::check_radii;
use super::texture::{Images, ImagesRead, Texture};
use super::{dae, generate, gltf, heights, obj, off, place, ply, smooth, stl};
use crate::arrays::MapEach;
use crate::input::{Error, Limits, Loading, Result};
use glam::DAffine3;
use std::collections::{HashMap, HashSet};
use std::path::Path;

/// An object: consecutive triangles or spheres with one name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Object {
    /// Unique in the scene.
    pub name: String,
    pub triangles: usize,
}

/// The triangles of a mesh in the world; its images come from `images`.
pub(crate) fn load_mesh(spec: &MeshSpec, images: &mut Images, loading: &Loading) -> Result<Mesh> {
    copied(placed(load_unplaced(spec, images, loading)?, spec, loading)?.0, loading.limits())
}

/// A mesh in the world, and its objects: one, or one for each part with [`MeshSpec::has_parts`]. A mesh with places is not at them yet; each
/// copy has objects of its own, whose names end in #0, #1 and so on.
pub(crate) fn placed(mut mesh: Mesh, spec: &MeshSpec, loading: &Loading) -> Result<(Part, Vec<Object>)> {
    let own = place::matrix(spec.scale, spec.rotate, spec.translate);
    if !mesh.runs.is_empty() && place::world_normal_from_object(own.matrix3).is_none() {
        // a matrix without inverse leaves no normals
        mesh = with_runs_copied(mesh, loading.limits())?;
    }
    let runs = std::mem::take(&mut mesh.runs);
    let of_runs = runs.iter().map(|run| run.triangles.len()).sum();
    let (name, triangles) = (spec.called(), if runs.is_empty() { mesh.triangles.len() } else { of_runs });
    if mesh.has_spheres() && !spec.keeps_spheres() {
        return Err(Error::input(format!("spheres {name}: the scale {STRETCHES}")));
    }
    let parts = std::mem::take(&mut mesh.parts);
    // each run has its own vertices already
    if spec.has_parts && runs.is_empty() {
        separate(&mut mesh, &parts);
    }
    let objects = |name: &str, copy: &str| match spec.has_parts && !parts.is_empty() {
        true => parts.iter().map(|part| part_object(name, copy, part)).collect(),
        false => vec![Object { name: format!("{name}{copy}"), triangles }],
    };
    // runs are placed by their matrices, not by their vertices
    let mesh = if runs.is_empty() { place::place(mesh, spec.scale, spec.rotate, spec.translate) } else { mesh };
    let at = |place: DAffine3| match runs.as_slice() {
        [] => vec![Run::whole(&mesh, place)],
        runs => {
            let moved = place * own;
            runs.iter().map(|run| Run { matrix: moved * run.matrix, ..run.clone() }).collect()
        }
    };
    let check = |scale: f64| {
        let radii: Vec<f64> = mesh.radii.iter().map(|radius| radius * scale).collect();
        check_radii(&radii).map_err(|why| Error::input(format!("spheres {name}: {why}")))
    };
    let Some(places) = &spec.places else {
        check(1.0)?;
        let own = (!runs.is_empty()).then(|| at(DAffine3::IDENTITY).into());
        return Ok(((mesh, own), objects(&name, "")));
    };
    let places = places.load(loading)?;
    if triangles.saturating_mul(places.len()) > MAX_TRIANGLES {
        let n = places.len();
        return Err(Error::input(format!("mesh {name}: {n} places of {triangles} triangles are over 2^28; use fewer")));
    }
    if mesh.has_spheres() {
        if let Some(k) = places.iter().position(|place| !keeps_spheres(place)) {
            return Err(Error::input(format!("spheres {name}: matrix {k} of places {STRETCHES}")));
        }
        places.iter().try_for_each(|place| check(size_of(place)))?;
    }
    let objects = (0..places.len()).flat_map(|k| objects(&name, &format!("#{k}"))).collect();
    let all = places.iter().flat_map(|place| at(*place)).collect();
    Ok(((mesh, Some(all)), objects))
}

/// A mesh with a copy of each of its runs.
///
/// # Errors
/// As [`Instances::new`] and [`Instances::check_copies`].
pub(crate) fn copied((mesh, runs): Part, limits: Limits) -> Result<Mesh> {
    if runs.is_none() {
        return Ok(mesh);
    }
    let instances = Instances::new(vec![(mesh, runs)])?;
    instances.check_copies(limits)?;
    Ok(instances.copies())
}

/// Copies each run of a mesh to the place that its file gives the run.
fn with_runs_copied(mut mesh: Mesh, limits: Limits) -> Result<Mesh> {
    if mesh.runs.is_empty() {
        return Ok(mesh);
    }
    let (runs, parts) = (std::mem::take(&mut mesh.runs), std::mem::take(&mut mesh.parts));
    Ok(Mesh { parts, ..copied((mesh, Some(runs.into())), limits)? })
}

/// The object of a part, named after the part, or after the mesh if the part has no name.
fn part_object(mesh: &str, copy: &str, part: &mesh::Part) -> Object {
    let name = if part.name.is_empty() { mesh } else { &part.name };
    Object { name: format!("{name}{copy}"), triangles: part.triangles }
}

/// The triangles of a mesh, before they are placed in the world.
pub(crate) fn load_unplaced(spec: &MeshSpec, images: &mut Images, loading: &Loading) -> Result<Mesh> {
    load_dressed(spec, Mesh::default(), images, loading)
}

/// The triangles of a mesh, or these if its source is [`MeshSource::Given`], with the look that it has.
pub(crate) fn load_dressed(spec: &MeshSpec, given: Mesh, images: &mut Images, loading: &Loading) -> Result<Mesh> {
    let mut none = Images::left_out();
    let files = if spec.outside_files { gltf::Files::Anywhere } else { gltf::Files::Below };
    // what it says itself goes before what its file says
    let of_file = if spec.texture == TextureSpec::OfFile && spec.color.is_none() { &mut *images } else { &mut none };
    of_file.blends = spec.blend;

    let mut mesh = match &spec.source {
        MeshSource::Builtin(builtin) => generate::generate(builtin, loading.limits())?,
        MeshSource::Heights(heights) => heights::load(heights, loading)?,
        MeshSource::Given => given,
        MeshSource::Spheres(spheres) => spheres.load(&spec.called(), loading)?,
        MeshSource::File(path) => load_file(path, (files, spec.animation.as_ref()), of_file, loading)?,
        MeshSource::Between(paths, share) => {
            let [from, to] = [&paths[0], &paths[1]]
                .map_each(|path| with_runs_copied(load_file(path, (files, None), of_file, loading)?, loading.limits()));
            let (from, to) = (from?, to?);
            let names = || format!("{} and {}", paths[0].display(), paths[1].display());
            blended(from, &to, *share).ok_or_else(|| {
                Error::input(format!("{}: have other triangles; keyframes of files only move vertices", names()))
            })?
        }
    };
    if spec.smooth {
        mesh = with_runs_copied(mesh, loading.limits())?;
        smooth::smooth(&mut mesh);
    }
    let has_own_color =
        spec.color.is_some() || spec.pattern.is_some() || matches!(spec.texture, TextureSpec::Image { .. });
    if has_own_color {
        mesh.clear_colors();
    }
    for material in &mut mesh.materials {
        material.two_sided = spec.two_sided.unwrap_or(material.two_sided);
        material.diffuse = spec.color.unwrap_or(material.diffuse);
        spec.gloss.apply(material);
        if let Some(pattern) = spec.pattern {
            material.pattern = Some(pattern);
            material.diffuse = spec.color.unwrap_or([1.0; 3]);
        }
    }
    if let TextureSpec::Image { file, repeat, cutoff } = &spec.texture {
        if mesh.corner_uvs.is_empty() {
            let name = spec.called();
            return Err(Error::input(format!("mesh {name}: has no texture coordinates; leave texture out")));
        }
        let cutoff = if spec.blend { Some(HALF) } else { *cutoff };
        let texture = match images.read.reads(cutoff.is_some()) {
            true => Some(Texture { cutoff, ..Texture::new(images.load(file, loading)?) }),
            false => None,
        };
        for material in &mut mesh.materials {
            material.texture.clone_from(&texture);
            material.blend = spec.blend.then_some(1.0);
            material.diffuse = spec.color.unwrap_or([1.0; 3]);
        }
        mesh.repeat_uvs(repeat.as_vec2());
    }
    light_unlit(&mut mesh, images.read);
    if mesh.is_blended() && mesh.corner_uvs.is_empty() {
        // kernels look up opacities where they find texture coordinates
        mesh.corner_uvs = vec![[NO_UV; 3]; mesh.triangles.len()];
    }
    Ok(mesh)
}

/// Lets unlit materials of one colour shine with it and reflect nothing, which shows that colour. An image or colours of vertices cannot
/// shine; these materials are lit as others are, and listed.
fn light_unlit(mesh: &mut Mesh, read: ImagesRead) {
    if !mesh.materials.iter().any(|material| material.is_unlit) {
        return;
    }
    let mut is_colored = vec![false; mesh.materials.len()];
    let colored = mesh.material_of.iter().zip(&mesh.corner_colors).filter(|(_, c)| **c != [NO_COLOR; 3]);
    colored.for_each(|(material, _)| is_colored[*material as usize] = true);
    for (material, is_colored) in mesh.materials.iter_mut().zip(is_colored).filter(|(m, _)| m.is_unlit) {
        if material.texture.is_none() && material.pattern.is_none() && !is_colored {
            let shines = material.diffuse;
            let plain = Material {
                name: std::mem::take(&mut material.name),
                two_sided: material.two_sided,
                blend: material.blend,
                ..Material::default()
            };
            *material = Material { diffuse: [0.0; 3], emissive: shines, ..plain };
        } else if read == ImagesRead::All {
            let what = format!("unlit material {:?}", material.name);
            let why = "it has an image, a pattern or colours of vertices; it is lit as other materials are";
            mesh.missing.push(Missing { what, why: why.into() });
        }
    }
}

/// `files` and `animation` are of glTF.
fn load_file(
    path: &Path,
    (files, animation): (gltf::Files, Option<&AnimationSpec>),
    images: &mut Images,
    loading: &Loading,
) -> Result<Mesh> {
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_lowercase();
    if animation.is_some() && !matches!(extension.as_str(), "gltf" | "glb") {
        let name = path.display();
        return Err(Error::input(format!("{name}: only glTF files have animations; leave animation out")));
    }
    match extension.as_str() {
        "obj" => obj::load(path, images, loading),
        "gltf" | "glb" => gltf::load(path, files, images, animation, loading),
        "ply" => ply::load(path, images, loading),
        "stl" => stl::load(path, loading),
        "off" => off::load(path, loading),
        "dae" => dae::load(path, loading),
        _ => {
            let name = path.display();
            Err(Error::input(format!(
                "{name}: unknown kind of mesh file; use .obj, .gltf, .glb, .ply, .stl, .off or .dae, or .asc, .png or .tif with heights"
            )))
        }
    }
}

/// A mesh on its way to another one of the same triangles; `None` if it is of others. Normals are of unit length there too.
fn blended(mut from: Mesh, to: &Mesh, share: f64) -> Option<Mesh> {
    let faces = |m: &Mesh| (m.positions.len(), m.normals.len());
    let is_same =
        from.triangles == to.triangles && from.corner_normals == to.corner_normals && faces(&from) == faces(to);
    if !is_same {
        return None;
    }
    for (p, q) in from.positions.iter_mut().zip(&to.positions) {
        *p += share * (*q - *p);
    }
    for (n, m) in from.normals.iter_mut().zip(&to.normals) {
        *n = (n.as_dvec3() + share * (m.as_dvec3() - n.as_dvec3())).try_normalize().map_or(*n, |n| n.as_vec3());
    }
    Some(from)
}

/// Gives objects different names: of those with one name, all but the first get the least number that makes it unique, as in `box.2`.
pub(crate) fn with_unique_names(objects: impl Iterator<Item = Object>) -> Vec<Object> {
    let mut taken = HashSet::new();
    // the last number given to each name: smaller ones are taken
    let mut numbers: HashMap<String, usize> = HashMap::new();
    let mut unique = |name: String| {
        let mut own = name.clone();
        while !taken.insert(own.clone()) {
            let number = numbers.entry(name.clone()).or_insert(1);
            *number += 1;
            own = format!("{name}.{number}");
        }
        own
    };
    objects.map(|object| Object { name: unique(object.name), ..object }).collect()
}

#[cfg(test)]
mod tests;
