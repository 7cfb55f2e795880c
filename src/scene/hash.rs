//! A hash of everything that decides a frame, for the header of its EXR.

use crate::camera::composition::Composition;
use crate::camera::{Camera, Rays};
use crate::geometry::texture::{Texels, Texture};
use crate::scene::Scene;
use crate::scene::caustics::Caustics;
use crate::scene::light::{AmbientOcclusion, Source};
use crate::scene::style::Style;
use crate::scene::volume::Volume;
use glam::DVec3;
use std::fmt::{self, Write};

/// The EXR attribute with the [`scene_hash`], in hexadecimal.
pub const SCENE_HASH: &str = "anamorph.scene_hash";

/// FNV-1a over 64-bit words instead of bytes.
struct Fnv(u64);

impl Fnv {
    fn word(&mut self, word: u64) {
        self.0 = (self.0 ^ word).wrapping_mul(0x0000_0100_0000_01b3);
    }

    fn number(&mut self, number: f64) {
        self.word(number.to_bits());
    }

    fn vector(&mut self, v: DVec3) {
        v.to_array().into_iter().for_each(|x| self.number(x));
    }
}

impl Write for Fnv {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        text.bytes().for_each(|byte| self.word(u64::from(byte)));
        Ok(())
    }
}

/// A hash of triangles, spheres and how they move, normals, colours of vertices, materials, alpha masks, lights, the volume, background,
/// image size, rays, mirror or lens, however the scene file spells them. It is the same on all machines. Images that only colour triangles
/// are left out, and so are lights that throw pictures, because neither are read if no colour is asked for. Meshes that stand in several places
/// count with their matrices, so such a scene differs from one of copies.
pub fn scene_hash(scene: &Scene, camera: &Camera) -> u64 {
    let mut h = Fnv(0xcbf2_9ce4_8422_2325);
    let mesh = scene.mesh.base();
    for count in [mesh.positions.len(), mesh.triangles.len(), mesh.normals.len(), mesh.materials.len()] {
        h.word(count as u64);
    }
    mesh.positions.iter().for_each(|p| h.vector(*p));
    mesh.triangles.iter().chain(&mesh.corner_normals).flatten().for_each(|i| h.word(u64::from(*i)));
    mesh.normals.iter().for_each(|n| h.vector(n.as_dvec3()));
    mesh.material_of.iter().for_each(|m| h.word(u64::from(*m)));
    for material in &mesh.materials {
        material.diffuse.iter().for_each(|c| h.number(f64::from(*c)));
        h.word(u64::from(material.two_sided));
        if material.is_glossy() {
            let numbers =
                material.specular.iter().chain(&material.emissive).chain([&material.roughness, &material.metallic]);
            numbers.for_each(|v| h.number(f64::from(*v)));
        }
        if let Some(texture) = material.texture.as_ref().filter(|texture| texture.has_alpha_mask()) {
            image(&mut h, texture);
        }
        if let Some(opacity) = material.blend {
            h.number(f64::from(opacity));
        }
        if let Some(pattern) = material.pattern {
            h.word(pattern.kind as u64);
            h.number(pattern.size);
            pattern.light.iter().chain(&pattern.dark).for_each(|c| h.number(f64::from(*c)));
        }
    }
    if mesh.has_alpha_masks() {
        mesh.uvs.iter().flat_map(|uv| uv.to_array()).for_each(|v| h.number(f64::from(v)));
        mesh.corner_uvs.iter().flatten().for_each(|k| h.word(u64::from(*k)));
    }
    if !mesh.corner_colors.is_empty() {
        mesh.colors.iter().flatten().for_each(|c| h.number(f64::from(*c)));
        mesh.corner_colors.iter().flatten().for_each(|k| h.word(u64::from(*k)));
    }
    mesh.radii.iter().for_each(|radius| h.number(*radius));
    for instance in scene.mesh.instances().into_iter().flat_map(|instances| &instances.list) {
        h.word(u64::from(instance.triangles.start));
        let matrix = instance.matrix.unwrap_or_default();
        matrix.to_cols_array().into_iter().for_each(|v| h.number(v));
    }
    h.word(scene.lights.len() as u64);
    for light in &scene.lights {
        match light.source {
            Source::Distant(travel) => h.vector(travel),
            Source::Point { position, distance } => {
                h.vector(position);
                h.number(distance);
            }
        }
        if !light.is_plain() {
            light.colour.iter().for_each(|c| h.number(f64::from(*c)));
            h.word(u64::from(light.casts_shadows));
        }
    }
    if let Some(AmbientOcclusion { rays, reach }) = scene.ambient_occlusion {
        h.word(u64::from(rays));
        h.number(reach);
    }
    if let Some(sky) = &scene.sky {
        image(&mut h, &sky.image);
        [f64::from(sky.strength), sky.rotation].into_iter().for_each(|v| h.number(v));
        h.word(u64::from(sky.is_seen));
    }
    if scene.style != Style::default() {
        style(&mut h, &scene.style);
    }
    scene.background.iter().for_each(|c| h.number(f64::from(*c)));
    h.word(u64::from(camera.width) << 32 | u64::from(camera.height));
    camera.t_range.iter().for_each(|t| h.number(*t));
    rays(&mut h, camera);
    if let Some(optics) = &camera.optics {
        written(&mut h, optics);
    }
    if let Some(composition) = camera.layered() {
        composed(&mut h, scene, composition);
    }
    if let Some(caustics) = &scene.caustics {
        light(&mut h, caustics);
    }
    if let Some(volume) = &scene.volume {
        medium(&mut h, volume);
    }
    if let Some(steps) = &scene.steps {
        let vertices = 0..mesh.positions.len() as u32;
        let all = vertices.flat_map(|v| (0..steps.count()).map(move |step| (v, step)));
        all.for_each(|(v, step)| h.vector(steps.position(mesh, v, step)));
        scene.moments(camera).into_iter().flatten().for_each(|moment| h.word(u64::from(moment.word())));
    }
    h.0
}

fn medium(h: &mut Fnv, volume: &Volume) {
    let Volume { grid, transfer, mode, is_lit } = volume;
    grid.sides.iter().for_each(|n| h.word(u64::from(*n)));
    grid.values.iter().for_each(|v| h.word(u64::from(v.to_bits())));
    grid.to_world.to_cols_array().into_iter().for_each(|x| h.number(x));
    for point in transfer {
        let numbers = point.colour.iter().chain([&point.value, &point.extinction]);
        numbers.for_each(|x| h.number(f64::from(*x)));
    }
    h.word(*mode as u64);
    h.word(u64::from(*is_lit));
}

fn style(h: &mut Fnv, style: &Style) {
    let Style { wireframe, outline, borders, hatching } = style;
    let lines = [*wireframe, outline.map(|o| o.line), *borders];
    for (k, line) in lines.iter().enumerate().filter_map(|(k, line)| Some((k, line.as_ref()?))) {
        h.word(k as u64);
        line.colour.iter().for_each(|c| h.number(f64::from(*c)));
        [line.width, line.depth].into_iter().for_each(|v| h.number(v));
    }
    if let Some(outline) = outline {
        h.number(outline.crease);
    }
    if let Some(hatching) = hatching {
        h.number(hatching.spacing);
        hatching.ink.iter().chain(&hatching.paper).for_each(|c| h.number(f64::from(*c)));
    }
}

fn image(h: &mut Fnv, texture: &Texture) {
    let Texels { width, height, rgba } = &*texture.texels;
    h.word(u64::from(*width) << 32 | u64::from(*height));
    texture.wrap.iter().for_each(|w| h.word(*w as u64));
    h.number(f64::from(texture.cutoff.unwrap_or(-1.0)));
    for texel in rgba {
        h.word(texel.iter().fold(0, |word, v| word << 16 | u64::from(v.to_bits())));
    }
}

fn light(h: &mut Fnv, caustics: &Caustics) {
    h.number(caustics.flux);
    h.word(caustics.method as u64);
    for receiver in &caustics.receivers {
        [receiver.origin, receiver.u, receiver.v].into_iter().for_each(|v| h.vector(v));
        receiver.texels.iter().for_each(|n| h.word(u64::from(*n)));
    }
    caustics.cells.iter().for_each(|n| h.word(u64::from(*n)));
    rays(h, &caustics.light);
}

fn composed(h: &mut Fnv, scene: &Scene, composition: &Composition) {
    h.word(composition.master.map_or(u64::MAX, |master| master as u64));
    let shows = composition.shows(&scene.objects);
    for (member, shows) in composition.members.iter().zip(shows) {
        h.word(member.priority as u64);
        h.number(member.feather);
        written(h, &member.region);
        shows.into_iter().for_each(|is_shown| h.word(u64::from(is_shown)));
        member.camera.t_range.iter().for_each(|t| h.number(*t));
        rays(h, &member.camera);
    }
}

/// All that a value holds: numbers are written with as many digits as tell them apart.
fn written(h: &mut Fnv, value: &impl fmt::Debug) {
    // a hash takes all text
    let _ = write!(h, "{value:?}");
}

fn rays(h: &mut Fnv, camera: &Camera) {
    camera.layers.iter().for_each(|layer| match layer {
        Rays::Pieces(pieces) => {
            for piece in &pieces.pieces {
                piece.bundle.p.iter().chain(&piece.bundle.d).for_each(|v| h.vector(*v));
                piece.bundle.h.iter().for_each(|x| h.number(*x));
                for corner in piece.corners_px.iter().flatten() {
                    h.number(corner.x);
                    h.number(corner.y);
                }
            }
        }
        // far too many to list one by one
        Rays::Field(field) if field.is_computed() => {
            written(h, &field.map());
        }
        Rays::Field(field) => {
            for (i, j) in (0..field.height).flat_map(|j| (0..field.width).map(move |i| (i, j))) {
                let (p, d) = field.ray(i, j).unwrap_or_default();
                h.vector(p);
                h.vector(d);
            }
        }
        Rays::Curves(curves) => {
            for (i, j) in (0..curves.height).flat_map(|j| (0..curves.width).map(move |i| (i, j))) {
                curves.near(i, j, (0.0, 0.0)).iter().flat_map(|(_, c)| c.points().to_vec()).for_each(|p| h.vector(p));
            }
        }
    });
}
