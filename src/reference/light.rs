//! How bright a hit is, by the definition.

use super::Hit;
use crate::scene::Scene;
use crate::scene::mesh::NO_NORMAL;
use crate::scene::sky::Sky;
use glam::{DVec3, DVec4, Vec3};
use std::f64::consts::PI;

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

/// What a hit sends back along the unit vector `view`, of every light or one headlight along it and a small ambient term, and what it
/// sends out by itself.
pub fn light(scene: &Scene, hit: &Hit, view: DVec3) -> [f32; 3] {
    let mesh = &scene.mesh;
    let material = &mesh.materials[mesh.material_of[hit.triangle as usize] as usize];
    let (n, colour) = (normal(scene, hit, view), DVec3::from(albedo(scene, hit).map(f64::from)));
    let rgb = |c: [f32; 3]| DVec3::from(c.map(f64::from));
    let metallic = f64::from(material.metallic);
    let gloss = Gloss {
        base: colour * (1.0 - metallic),
        straight: rgb(material.specular).lerp(colour, metallic),
        alpha: material.alpha().into(),
    };
    let headlight = [view];
    let lights = if scene.lights.is_empty() && scene.sky.is_none() { &headlight[..] } else { &scene.lights };
    let direct: DVec3 = lights.iter().map(|travel| gloss.reflected(n, -view, -*travel)).sum();
    let (around, rest) = match &scene.sky {
        Some(sky) => (gloss.reflected_sky(sky, n, -view), 1.0),
        None => (AMBIENT * (gloss.base + gloss.straight), 1.0 - AMBIENT),
    };
    (rgb(material.emissive) + around + rest * direct).as_vec3().to_array()
}

/// A surface of microfacets (GGX; Walter et al. 2007) over a matte one.
struct Gloss {
    base: DVec3,
    /// Of the facets, where light comes and goes straight on.
    straight: DVec3,
    alpha: f64,
}

impl Gloss {
    /// What goes towards `v` of the light from all around: the matte share by the irradiance, the rest by the mean over a lobe about the
    /// mirrored view, times the share of it that microfacets reflect (Karis 2014).
    fn reflected_sky(&self, sky: &Sky, n: DVec3, v: DVec3) -> DVec3 {
        let cos_v = n.dot(v).max(1e-4);
        let mirrored = (2.0 * n.dot(v) * n - v).normalize();
        // normals deviate by alpha / sqrt(2), directions by twice that, a box by 1 / sqrt(12) of its width
        let width = (24.0f64.sqrt() * self.alpha).min(PI);
        let rough = self.alpha.sqrt() * DVec4::new(-1.0, -0.0275, -0.572, 0.022) + DVec4::new(1.0, 0.0425, 1.04, -0.04);
        let turned = (rough.x * rough.x).min((-9.28 * cos_v).exp2()) * rough.x + rough.y;
        let [share, of_grazing] = [-1.04 * turned + rough.z, 1.04 * turned + rough.w];
        let grazing = (50.0 * self.straight.max_element()).min(1.0);
        self.base * sky.irradiance(n) + sky.lobe(mirrored, width) * (self.straight * share + grazing * of_grazing)
    }

    /// What goes towards `v` of a light of irradiance pi from `l`.
    fn reflected(&self, n: DVec3, v: DVec3, l: DVec3) -> DVec3 {
        let Gloss { base, straight, alpha } = *self;
        let cos_l = n.dot(l);
        if cos_l <= 0.0 {
            return DVec3::ZERO;
        }
        let cos_v = n.dot(v).max(1e-4);
        if (l + v).length_squared() < 1e-12 {
            // light goes straight on, which no facet does
            return cos_l * base;
        }
        let h = (l + v).normalize();
        // what reflects nothing straight on does not at grazing angles (Lagarde and de Rousiers 2014)
        let grazing = (50.0 * straight.max_element()).min(1.0);
        let fresnel = straight + (grazing - straight) * (1.0 - v.dot(h).clamp(0.0, 1.0)).powi(5);
        let a2 = alpha * alpha;
        let cos_h = n.dot(h).clamp(0.0, 1.0);
        let facets = a2 / (PI * (cos_h * cos_h * (a2 - 1.0) + 1.0).powi(2));
        // Heitz 2014, equation 99
        let hidden = |cos: f64| (cos * cos * (1.0 - a2) + a2).sqrt();
        let seen = 0.5 / (cos_l * hidden(cos_v) + cos_v * hidden(cos_l));
        cos_l * (base * (1.0 - fresnel) + PI * facets * seen * fresnel)
    }
}
