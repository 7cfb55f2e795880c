//! Caustics by the reference: every photon is traced by itself, and triangles are clipped to texels.

use super::light::albedo;
use super::path::{Path, Segment};
use super::{Hit, Outcome, Reference};
use crate::arrays::MapEach;
use crate::camera::Camera;
use crate::parallel;
use crate::scene::Scene;
use crate::scene::caustics::beams::{CausticTriangle, Fate, Photon};
use crate::scene::caustics::receiver_triangles::is_in_plane;
use crate::scene::caustics::shares::shares;
use crate::scene::caustics::{CausticMaps, Caustics, FluxBudget, Map, mean};
use glam::DVec3;

/// The maps of the scene's receivers; `None` without caustics.
pub fn caustics(scene: &Scene) -> Option<CausticMaps> {
    let caustics = scene.caustics.as_deref()?;
    let photons = photons(scene, caustics);
    let (caustic_triangles, mut budget) = caustics.caustic_triangles(&photons);
    let map = |r: &crate::scene::caustics::Receiver| Map {
        receiver: *r,
        flux: vec![[0.0; 3]; r.texels[0] as usize * r.texels[1] as usize],
    };
    let mut maps: Vec<Map> = caustics.receivers.iter().map(map).collect();
    for triangle in &caustic_triangles {
        add(&mut maps[triangle.receiver as usize], triangle, &mut budget);
    }
    budget.deposited = maps.iter().map(|m| mean(m.total())).sum();
    Some(CausticMaps { maps, budget })
}

/// The photons of the light, row by row.
pub fn photons(scene: &Scene, caustics: &Caustics) -> Vec<Photon> {
    let light = &caustics.light;
    let joined = scene.with_optics(light);
    let reference = Reference::build(&joined.mesh);
    let first_id = caustics.optics.first_id(joined.mesh.triangle_count());
    let (columns, rows) = (light.width, light.height);
    let photon = |k: u32| {
        let shown = reference.shown(light, Path::of_pixel(light, k % columns, k / columns));
        photon(caustics, first_id, |id| joined.mesh.is_round(id), &shown)
    };
    parallel::map(0..columns * rows, photon)
}

fn photon(caustics: &Caustics, first_id: u32, is_round: impl Fn(u32) -> bool, shown: &Outcome) -> Photon {
    if shown.first.is_none() {
        return Photon { fate: Fate::Direct, left: [1.0; 3] };
    }
    let left = caustics.optics.tint.map_each(|tint| f64::from(tint).powi(shown.bounces as i32));
    let fate = match shown.seen {
        None => Fate::Missed,
        Some(seen) if seen.hit.triangle >= first_id => Fate::Absorbed,
        Some(seen) if is_round(seen.hit.triangle) => Fate::Missed,
        Some(seen) => {
            let p = match shown.path.of(&seen) {
                Segment::Straight(b) => Some(b.ray(0.0, 0.0)).map(|r| r.origin + seen.hit.t * r.direction),
                Segment::Curved(_) => None,
            };
            let receiver = p.and_then(|p| Some((caustics.receivers.iter().position(|r| is_in_plane(r, p))?, p)));
            receiver.map_or(Fate::Missed, |(k, p)| {
                let place = caustics.receivers[k].texels_of(p);
                Fate::OnReceiver { receiver: k as u32, bounces: shown.bounces, place }
            })
        }
    };
    Photon { fate, left }
}

/// Spreads the flux of a triangle over a map; the part outside counts as missed.
fn add(map: &mut Map, triangle: &CausticTriangle, budget: &mut FluxBudget) {
    let shares = shares(&triangle.corners, map.receiver.texels);
    let mut inside = 0.0;
    for (texel, share) in shares.list {
        inside += share;
        map.flux[texel].iter_mut().zip(triangle.flux).for_each(|(sum, flux)| *sum += share * flux);
    }
    budget.missed += mean(triangle.flux) * (1.0 - inside);
    budget.degenerate += u64::from(shares.flat);
}

/// The light that a receiver adds to the colour of what a camera shows: diffuse reflection of the caustic.
pub fn shown_by(scene: &Scene, camera: &Camera, shown: &Outcome, caustics: &CausticMaps) -> [f32; 3] {
    let first = camera.optics.as_ref().map_or(u32::MAX, |o| o.first_id(scene.mesh.triangle_count()));
    let Some(Hit { triangle, bary, .. }) = shown.seen.map(|s| s.hit).filter(|hit| hit.triangle < first) else {
        return [0.0; 3];
    };
    if scene.mesh.is_round(triangle) {
        return [0.0; 3];
    }
    let corners = scene.mesh.triangles[triangle as usize].map_each(|k| scene.mesh.positions[k as usize]);
    let Some(map) = caustics.maps.iter().find(|m| corners.iter().all(|p| is_in_plane(&m.receiver, *p))) else {
        return [0.0; 3];
    };
    let [a, b, c] = corners;
    let p: DVec3 = a + bary[0] * (b - a) + bary[1] * (c - a);
    let diffuse = albedo(&scene.mesh, corners, &Hit { t: 0.0, triangle, bary });
    let received = map.irradiance(map.receiver.texels_of(p)).unwrap_or_default();
    [0, 1, 2].map_each(|k| (f64::from(diffuse[k]) * received[k] / std::f64::consts::PI) as f32)
}
