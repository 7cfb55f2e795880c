//! Scenes of the examples in good light: a sun and a sky, shadows, and surfaces that shine a little.

use anamorph::internals::geometry::mesh::DIELECTRIC;
use anamorph::internals::geometry::pattern::{Pattern, PatternKind};
use anamorph::internals::geometry::texture::Texels;
use anamorph::internals::image::tone::{Curve, Tone};
use anamorph::internals::scene::Scene;
use anamorph::internals::scene::light::{AmbientOcclusion, Light};
use anamorph::internals::scene::sky::Sky;
use glam::DVec3;
use half::f16;
use std::sync::Arc;

/// The same things, lit as out of doors; what is lit by caustics stays dark.
pub fn dressed(mut scene: Scene) -> Scene {
    pave(&mut scene);
    for material in &mut Arc::make_mut(&mut scene.mesh).materials {
        if !material.is_glossy() {
            (material.specular, material.roughness) = ([DIELECTRIC; 3], 0.55);
        }
    }
    if scene.caustics.is_some() {
        return scene;
    }
    if scene.lights.is_empty() {
        scene.lights = vec![Light::distant(DVec3::new(-1.0, -2.0, -1.2))];
    }
    for light in &mut scene.lights {
        (light.colour, light.casts_shadows) = ([0.85, 0.78, 0.65], true);
    }
    scene.sky = Some(Arc::new(sky()));
    let size = scene.bounds().map_or(1.0, |(lo, hi)| (hi - lo).length());
    scene.ambient_occlusion = Some(AmbientOcclusion { rays: 32, reach: 0.025 * size });
    scene.tone = Tone { exposure: 0.0, curve: Curve::Clip };
    scene
}

/// Floors are of stone.
fn pave(scene: &mut Scene) {
    let mut first = 0;
    for object in &scene.objects {
        let own = first..first + object.triangles;
        first += object.triangles;
        let corners = own.clone().flat_map(|k| scene.mesh.triangles[k]).map(|v| scene.mesh.positions[v as usize]);
        let span = corners.clone().fold(DVec3::NEG_INFINITY, DVec3::max) - corners.fold(DVec3::INFINITY, DVec3::min);
        let (true, Some(&material)) = (object.name.starts_with("plane"), scene.mesh.material_of.get(own.start)) else {
            continue;
        };
        let material = &mut Arc::make_mut(&mut scene.mesh).materials[material as usize];
        let [light, dark] = [1.15, 0.75].map(|by| material.diffuse.map(|c| (by * c).min(1.0)));
        let grain = span.max_element() / 12.0;
        (material.pattern, material.diffuse) =
            (Some(Pattern { light, dark, ..Pattern::new(PatternKind::Stone, grain) }), [1.0; 3]);
    }
}

/// Blue above and bright towards the horizon, earth below; not seen itself.
fn sky() -> Sky {
    let (width, height) = (32, 64);
    let texel = |k: u32| {
        let up = 1.0 - 2.0 * (f64::from(k / width) + 0.5) / f64::from(height);
        let haze = (-6.0 * up.abs()).exp();
        let base = if up > 0.0 { [0.3, 0.42, 0.62] } else { [0.2, 0.17, 0.13] };
        let [r, g, b] = base.map(|c| c + haze * (0.6 - c));
        [r, g, b, 1.0].map(f16::from_f64)
    };
    let rgba = (0..width * height).map(texel).collect();
    let mut sky = Sky::of(Arc::new(Texels { width, height, rgba }), 1.0, 0.0);
    sky.is_seen = false;
    sky
}
