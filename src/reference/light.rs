//! How bright a hit is, by the definition.

use super::Hit;
use crate::scene::Scene;
use crate::scene::mesh::NO_NORMAL;
use glam::{DVec3, Vec3};

/// Share of the light that comes from everywhere.
const AMBIENT: f64 = crate::stage::AMBIENT as f64;

/// The unit normal of a triangle's hit, turned against the unit vector `view`: the file's where it has them.
pub fn normal(scene: &Scene, hit: &Hit, view: DVec3) -> DVec3 {
    let mesh = &scene.mesh;
    let id = hit.triangle as usize;
    let v = mesh.triangles[id].map(|k| mesh.positions[k as usize]);
    let flat = (v[1] - v[0]).cross(v[2] - v[0]).normalize_or_zero();
    let seen = if flat.dot(view) > 0.0 { -flat } else { flat };
    let weights = [1.0 - hit.bary[0] - hit.bary[1], hit.bary[0], hit.bary[1]];
    let stored = mesh.corner_normals.get(id).filter(|c| !c.contains(&NO_NORMAL));
    let smooth = stored.map(|c| {
        let n: [Vec3; 3] = c.map(|k| mesh.normals[k as usize]);
        (0..3).map(|k| weights[k] * n[k].as_dvec3()).sum::<DVec3>()
    });
    let n = smooth.and_then(DVec3::try_normalize).unwrap_or(seen);
    if n.dot(seen) < 0.0 { -n } else { n }
}

/// The diffuse colour of a hit, by the texture's own texels at its very place: what filters approximate the mean of over a pixel.
pub fn albedo(scene: &Scene, hit: &Hit) -> [f32; 3] {
    let mesh = &scene.mesh;
    let material = &mesh.materials[mesh.material_of[hit.triangle as usize] as usize];
    let texel = material.texture.as_ref().and_then(|texture| Some(texture.at(mesh.uv_at(hit.triangle, hit.bary)?)));
    let [r, g, b, _] = texel.unwrap_or([1.0; 4]);
    let [dr, dg, db] = material.diffuse.map(f64::from);
    [(dr * r) as f32, (dg * g) as f32, (db * b) as f32]
}

/// Lambert from every light, or one headlight along the unit vector `view`, and a small ambient term.
pub fn light(scene: &Scene, hit: &Hit, view: DVec3) -> [f32; 3] {
    let n = normal(scene, hit, view);
    let lambert = |travel: DVec3| (-n.dot(travel)).max(0.0);
    let direct: f64 =
        if scene.lights.is_empty() { lambert(view) } else { scene.lights.iter().map(|l| lambert(*l)).sum() };
    let received = AMBIENT + (1.0 - AMBIENT) * direct;
    albedo(scene, hit).map(|c| (c as f64 * received) as f32)
}
