//! Shading of a hit, by the definition.

use super::pictures::{Shown, painted};
use super::{Hit, Reference};
use crate::arrays::MapEach;
use crate::geometry::mesh::{Mesh, NO_NORMAL};
use crate::scene::Scene;
use crate::scene::light::{AmbientOcclusion, Arriving, Light};
use crate::scene::sky::Sky;
use glam::{DVec3, DVec4};
use std::f64::consts::PI;
use std::iter::zip;

/// Share of ambient light.
const AMBIENT: f64 = crate::scene::light::AMBIENT as f64;

/// The unit normal of the surface itself at a hit at `p`, on the side opposite the unit vector `view`.
fn flat_normal(reference: &Reference, hit: &Hit, (p, view): (DVec3, DVec3)) -> DVec3 {
    let flat = reference.primitive(hit.triangle).normal_at(p).normalize_or_zero();
    if flat.dot(view) > 0.0 { -flat } else { flat }
}

/// The unit normal of a hit at `p` on the side opposite the unit vector `view`: from the file, or else the triangle's or sphere's.
pub fn normal(reference: &Reference, hit: &Hit, (p, view): (DVec3, DVec3)) -> DVec3 {
    let mesh = reference.mesh;
    let id = reference.own(hit.triangle) as usize;
    let seen = flat_normal(reference, hit, (p, view));
    let weights = [1.0 - hit.bary[0] - hit.bary[1], hit.bary[0], hit.bary[1]];
    let stored = mesh.corner_normals.get(id).filter(|c| !c.contains(&NO_NORMAL));
    let smooth = stored.map(|c| {
        let n = c.map_each(|k| reference.normal(hit.triangle, k));
        (0..3).map(|k| weights[k] * n[k]).sum::<DVec3>()
    });
    let n = smooth.and_then(DVec3::try_normalize).unwrap_or(seen);
    if n.dot(seen) < 0.0 { -n } else { n }
}

/// The diffuse colour of a hit on a triangle with these corners: its material's, times the texture's without filtering, the pattern's and
/// the vertices'.
pub fn albedo(mesh: &Mesh, [v0, v1, v2]: [DVec3; 3], hit: &Hit) -> [f32; 3] {
    let material = &mesh.materials[mesh.material_of[hit.triangle as usize] as usize];
    let texel = material.texture.as_ref().and_then(|texture| Some(texture.at(mesh.uv_at(hit.triangle, hit.bary)?)));
    let [r, g, b, _] = texel.unwrap_or([1.0; 4]);
    let [pr, pg, pb] =
        material.pattern.map_or([1.0; 3], |pattern| pattern.at(v0 + hit.bary[0] * (v1 - v0) + hit.bary[1] * (v2 - v0)));
    let weights = [1.0 - hit.bary[0] - hit.bary[1], hit.bary[0], hit.bary[1]];
    let of_vertices = match mesh.corner_colors.is_empty() {
        true => DVec3::ONE,
        false => zip(weights, mesh.colors_of(hit.triangle as usize))
            .map(|(w, c)| w * DVec3::from(c.map_each(f64::from)))
            .sum(),
    };
    let [dr, dg, db] = (DVec3::from(material.diffuse.map_each(f64::from)) * of_vertices).to_array();
    [(dr * r * pr) as f32, (dg * g * pg) as f32, (db * b * pb) as f32]
}

/// The diffuse colour of a hit at `p`, as [`albedo`].
fn own_albedo(reference: &Reference, hit: &Hit, p: DVec3) -> [f32; 3] {
    let own = Hit { triangle: reference.own(hit.triangle), ..*hit };
    albedo(reference.mesh, reference.surface(hit.triangle, p), &own)
}

/// The diffuse colour of a hit at `p` with all pictures that are thrown onto it.
pub fn painted_albedo(obstacles: &Obstacles, hit: &Hit, (p, view): (DVec3, DVec3)) -> [f32; 3] {
    let reference = obstacles.all;
    let own = own_albedo(reference, hit, p);
    let shown = reference.pictures.at(&obstacles.above(hit, p, view), p, normal(reference, hit, (p, view)));
    if shown.is_empty() {
        return own;
    }
    let [lit, seen] = painted(DVec3::from(own.map_each(f64::from)), &shown);
    (lit + seen).as_vec3().to_array()
}

/// The light that a hit at `p` reflects and emits towards the viewer, `view` being the unit direction of the ray: from all lights, or
/// from a headlight and a small ambient term. `obstacles` cast shadows.
pub fn light(scene: &Scene, obstacles: &Obstacles, hit: &Hit, (p, view): (DVec3, DVec3)) -> [f32; 3] {
    let reference = obstacles.all;
    let mesh = reference.mesh;
    let material = &mesh.materials[mesh.material_of[reference.own(hit.triangle) as usize] as usize];
    let n = normal(reference, hit, (p, view));
    let start = obstacles.above(hit, p, view);
    let pictures = reference.pictures.at(&start, p, n);
    let own = DVec3::from(own_albedo(reference, hit, p).map_each(f64::from));
    let [colour, as_it_is] = painted(own, &pictures);
    let rgb = |c: [f32; 3]| DVec3::from(c.map_each(f64::from));
    let metallic = f64::from(material.metallic);
    let gloss = Gloss {
        base: colour * (1.0 - metallic),
        f0: rgb(material.specular).lerp(colour, metallic),
        alpha: material.alpha().into(),
    };
    let of_light = |light: &Light| {
        let Arriving { to_light, far, strength } = light.arriving(p);
        let is_dark = n.dot(to_light) <= 0.0 || light.casts_shadows && !start.sees(to_light, far);
        if is_dark { DVec3::ZERO } else { strength * gloss.reflected(n, -view, to_light) }
    };
    let of_picture = |shown: &Shown| Some(shown.strength()? * gloss.reflected(n, -view, shown.to_start));
    let open = scene.ambient_occlusion.map_or(1.0, |occlusion| start.openness(n, occlusion));
    let direct = match scene.has_headlight() {
        true => open * gloss.reflected(n, -view, -view),
        false => scene.lights.iter().map(of_light).chain(pictures.iter().filter_map(of_picture)).sum(),
    };
    let (around, rest) = match &scene.sky {
        Some(sky) => (gloss.reflected_sky(sky, n, -view), 1.0),
        None => (AMBIENT * (gloss.base + gloss.f0), 1.0 - AMBIENT),
    };
    (rgb(material.emissive) + as_it_is + open * around + rest * direct).as_vec3().to_array()
}

/// The shadow casters: the triangles and spheres with the lowest ids.
pub struct Obstacles<'a> {
    pub all: &'a Reference<'a>,
    pub count: u32,
}

/// A place just above a hit, on the viewer's side.
pub struct Above<'a> {
    of: &'a Obstacles<'a>,
    p: DVec3,
    /// The triangle's own unit normal, on that side.
    flat: DVec3,
}

/// Offset of shadow rays above the hit, relative to the largest coordinate of the hit and its triangle.
const ABOVE: f64 = 1e-9;

impl Obstacles<'_> {
    fn above(&self, hit: &Hit, p: DVec3, view: DVec3) -> Above<'_> {
        let flat = flat_normal(self.all, hit, (p, view));
        let size = self.all.positions(hit.triangle).iter().fold(p.abs(), |most, v| most.max(v.abs())).max_element();
        Above { of: self, p: p + ABOVE * size * flat, flat }
    }
}

impl Above<'_> {
    /// Distance to the first obstacle along a unit direction, up to `far`.
    fn meets(&self, direction: DVec3, far: f64) -> Option<f64> {
        self.of.all.blocked(self.p, direction, far, self.of.count)
    }

    /// Whether nothing is in the way along a unit direction, up to `far`.
    pub fn sees(&self, direction: DVec3, far: f64) -> bool {
        self.flat.dot(direction) > 0.0 && self.meets(direction, far).is_none()
    }

    /// Ambient visibility: the cosine-weighted share of directions about the normal without an obstacle; far obstacles count less.
    fn openness(&self, n: DVec3, occlusion: AmbientOcclusion) -> f64 {
        // a frame about the normal (Duff et al. 2017)
        let side = if n.z >= 0.0 { 1.0 } else { -1.0 };
        let a = -1.0 / (side + n.z);
        let b = n.x * n.y * a;
        let right = DVec3::new(1.0 + side * n.x * n.x * a, side * b, -side * n.x);
        let up = DVec3::new(b, side + n.y * n.y * a, -n.y);
        let hidden = |d: DVec3| {
            let d = d.x * right + d.y * up + d.z * n;
            let met = if self.flat.dot(d) > 0.0 { self.meets(d, occlusion.reach) } else { None };
            met.map_or(0.0, |s| 1.0 - s / occlusion.reach)
        };
        1.0 - occlusion.directions().map(hidden).sum::<f64>() / f64::from(occlusion.rays)
    }
}

/// A surface of microfacets (GGX; Walter et al. 2007) over a matte one.
struct Gloss {
    base: DVec3,
    /// Reflectance of the facets at normal incidence.
    f0: DVec3,
    alpha: f64,
}

impl Gloss {
    /// The environment light reflected towards `v`: the matte share by the irradiance, the rest by the mean over a lobe about the
    /// mirrored view, times the share of it that microfacets reflect (Karis 2014).
    fn reflected_sky(&self, sky: &Sky, n: DVec3, v: DVec3) -> DVec3 {
        let cos_v = n.dot(v).max(1e-4);
        let mirrored = (2.0 * n.dot(v) * n - v).normalize();
        // normals deviate by alpha / sqrt(2), directions by twice that, a box by 1 / sqrt(12) of its width
        let width = (24.0f64.sqrt() * self.alpha).min(PI);
        let rough = self.alpha.sqrt() * DVec4::new(-1.0, -0.0275, -0.572, 0.022) + DVec4::new(1.0, 0.0425, 1.04, -0.04);
        let falloff = (rough.x * rough.x).min((-9.28 * cos_v).exp2()) * rough.x + rough.y;
        let [share, of_grazing] = [-1.04 * falloff + rough.z, 1.04 * falloff + rough.w];
        let grazing = (50.0 * self.f0.max_element()).min(1.0);
        self.base * sky.irradiance(n) + sky.lobe(mirrored, width) * (self.f0 * share + grazing * of_grazing)
    }

    /// The light reflected towards `v` from a light of irradiance pi in direction `l`.
    fn reflected(&self, n: DVec3, v: DVec3, l: DVec3) -> DVec3 {
        let Gloss { base, f0, alpha } = *self;
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
        let grazing = (50.0 * f0.max_element()).min(1.0);
        let fresnel = f0 + (grazing - f0) * (1.0 - v.dot(h).clamp(0.0, 1.0)).powi(5);
        let a2 = alpha * alpha;
        let cos_h = n.dot(h).clamp(0.0, 1.0);
        let facets = a2 / (PI * (cos_h * cos_h * (a2 - 1.0) + 1.0).powi(2));
        // Heitz 2014, equation 99
        let hidden = |cos: f64| (cos * cos * (1.0 - a2) + a2).sqrt();
        let seen = 0.5 / (cos_l * hidden(cos_v) + cos_v * hidden(cos_l));
        cos_l * (base * (1.0 - fresnel) + PI * facets * seen * fresnel)
    }
}
