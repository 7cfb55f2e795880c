//! Caustics by the reference: every photon's way followed by itself, and triangles cut along the texels' borders.

use super::path::{Path, Segment};
use super::{Outcome, Reference};
use crate::camera::Camera;
use crate::caustics::beams::{Cast, Fate, Photon};
use crate::caustics::landing::is_in_plane;
use crate::caustics::{Budget, Caustics, Illumination, Map, mean};
use crate::scene::Scene;
use glam::{DVec2, DVec3};
use rayon::prelude::*;

/// The maps of the scene's receivers; `None` without caustics.
pub fn caustics(scene: &Scene) -> Option<Illumination> {
    let caustics = scene.caustics.as_deref()?;
    let photons = photons(scene, caustics);
    let (casts, mut budget) = caustics.casts(&photons);
    let map = |r: &crate::caustics::Receiver| Map {
        receiver: *r,
        flux: vec![[0.0; 3]; r.texels[0] as usize * r.texels[1] as usize],
    };
    let mut maps: Vec<Map> = caustics.receivers.iter().map(map).collect();
    for cast in &casts {
        add(&mut maps[cast.receiver as usize], cast, &mut budget);
    }
    budget.deposited = maps.iter().map(|m| mean(m.total())).sum();
    Some(Illumination { maps, budget })
}

/// The photons of the light, row by row.
pub fn photons(scene: &Scene, caustics: &Caustics) -> Vec<Photon> {
    let light = &caustics.light;
    let joined = scene.with_optics(light);
    let reference = Reference::build(&joined.mesh);
    let first_id = caustics.optics.first_id(&joined.mesh);
    let (columns, rows) = (light.width, light.height);
    let photon = |k: u32| {
        let shown = reference.shown(light, Path::of_pixel(light, k % columns, k / columns));
        photon(caustics, first_id, &shown)
    };
    (0..columns * rows).into_par_iter().map(photon).collect()
}

fn photon(caustics: &Caustics, first_id: u32, shown: &Outcome) -> Photon {
    if shown.first.is_none() {
        return Photon { fate: Fate::Direct, left: [1.0; 3] };
    }
    let turns = shown.path.segments.len() as u32 - 1;
    let left = caustics.optics.tint.map(|tint| f64::from(tint).powi(turns as i32));
    let fate = match shown.seen {
        None => Fate::Missed,
        Some(seen) if seen.hit.triangle >= first_id => Fate::Absorbed,
        Some(seen) => {
            let p = match shown.path.of(&seen) {
                Segment::Straight(b) => Some(b.ray(0.0, 0.0)).map(|r| r.origin + seen.hit.t * r.direction),
                Segment::Curved(_) => None,
            };
            let receiver = p.and_then(|p| Some((caustics.receivers.iter().position(|r| is_in_plane(r, p))?, p)));
            receiver.map_or(Fate::Missed, |(k, p)| {
                let place = caustics.receivers[k].texels_of(p);
                Fate::Landed { receiver: k as u32, turns, place }
            })
        }
    };
    Photon { fate, left }
}

/// Spreads the flux of a triangle over a map, and what lies outside over the missed.
fn add(map: &mut Map, cast: &Cast, budget: &mut Budget) {
    let shares = shares(&cast.corners, map.receiver.texels);
    let mut inside = 0.0;
    for (texel, share) in shares.list {
        inside += share;
        map.flux[texel].iter_mut().zip(cast.flux).for_each(|(sum, flux)| *sum += share * flux);
    }
    budget.missed += mean(cast.flux) * (1.0 - inside);
    budget.degenerate += u64::from(shares.flat);
}

/// Texels and the share of a triangle that each receives.
struct Shares {
    list: Vec<(usize, f64)>,
    /// The triangle is a line or a point.
    flat: bool,
}

/// A triangle narrower than this part of its longest side is a line: its corners are right to some 1e-9 of a map's side.
const FLAT: f64 = 1e-9;

fn shares(corners: &[DVec2; 3], texels: [u32; 2]) -> Shares {
    let [a, b, c] = *corners;
    let area = (b - a).perp_dot(c - a).abs() / 2.0;
    let longest = [(a, b, c), (b, c, a), (c, a, b)].into_iter().max_by(|x, y| length(x).total_cmp(&length(y)));
    let Some((from, to, third)) = longest else { return Shares { list: Vec::new(), flat: true } };
    let side = to - from;
    if 2.0 * area <= FLAT * side.length_squared() {
        return Shares { list: along(from, side, third, texels), flat: true };
    }
    let mut list = Vec::new();
    each_row(&[a, b, c], texels, |x, y, part| list.push((y * texels[0] as usize + x, part / area)));
    Shares { list, flat: false }
}

fn length(side: &(DVec2, DVec2, DVec2)) -> f64 {
    (side.1 - side.0).length_squared()
}

/// The area of a polygon within each texel that it meets.
fn each_row(polygon: &[DVec2], [columns, rows]: [u32; 2], mut visit: impl FnMut(usize, usize, f64)) {
    let bounds = |polygon: &[DVec2], axis: usize, most: u32| {
        let all = polygon.iter().map(|p| p[axis]);
        let (lo, hi) = (all.clone().fold(f64::INFINITY, f64::min), all.fold(f64::NEG_INFINITY, f64::max));
        (lo.floor().clamp(0.0, most as f64) as usize, hi.ceil().clamp(0.0, most as f64) as usize)
    };
    let (y0, y1) = bounds(polygon, 1, rows);
    for y in y0..y1 {
        let row = between(polygon, DVec2::Y, y as f64);
        let (x0, x1) = bounds(&row, 0, columns);
        for x in x0..x1.max(x0) {
            let part = area(&between(&row, DVec2::X, x as f64));
            if part > 0.0 {
                visit(x, y, part);
            }
        }
    }
}

/// The part of a convex polygon with a coordinate in [at, at + 1].
fn between(polygon: &[DVec2], axis: DVec2, at: f64) -> Vec<DVec2> {
    let upper = cut(polygon, |p| p.dot(axis) - at);
    cut(&upper, |p| at + 1.0 - p.dot(axis))
}

/// The part of a convex polygon where a linear function is not below zero (Sutherland and Hodgman).
fn cut(polygon: &[DVec2], height: impl Fn(DVec2) -> f64) -> Vec<DVec2> {
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (k, &p) in polygon.iter().enumerate() {
        let q = polygon[(k + 1) % polygon.len()];
        let (hp, hq) = (height(p), height(q));
        if hp >= 0.0 {
            kept.push(p);
        }
        if (hp < 0.0) != (hq < 0.0) {
            kept.push(p + (q - p) * (hp / (hp - hq)));
        }
    }
    kept
}

fn area(polygon: &[DVec2]) -> f64 {
    let Some(&first) = polygon.first() else { return 0.0 };
    polygon.windows(2).map(|e| (e[0] - first).perp_dot(e[1] - first)).sum::<f64>().abs() / 2.0
}

/// A flat triangle's shares: its density rises along the longest side to the third corner's foot and falls from there, as
/// that of a triangle with an area; it is cut where the side crosses borders of texels.
fn along(from: DVec2, side: DVec2, third: DVec2, [columns, rows]: [u32; 2]) -> Vec<(usize, f64)> {
    let foot = ((third - from).dot(side) / side.length_squared()).clamp(0.0, 1.0);
    let up_to = |s: f64| {
        if s < foot {
            s * s / foot
        } else if s < 1.0 {
            1.0 - (1.0 - s).powi(2) / (1.0 - foot)
        } else {
            1.0
        }
    };
    let mut cuts = vec![0.0, 1.0];
    for (axis, most) in [(0, columns), (1, rows)] {
        let (p, d) = (from[axis], side[axis]);
        let (lo, hi) = (p.min(p + d).max(-1.0), p.max(p + d).min(most as f64 + 1.0));
        if d != 0.0 {
            let crossed = (lo.ceil() as i64..=hi.floor() as i64).map(|border| (border as f64 - p) / d);
            cuts.extend(crossed.filter(|s| *s > 0.0 && *s < 1.0));
        }
    }
    cuts.sort_by(f64::total_cmp);
    let part = |ends: &[f64]| {
        let place = (from + (ends[0] + ends[1]) / 2.0 * side).floor();
        let inside = place.cmpge(DVec2::ZERO).all() && place.x < columns as f64 && place.y < rows as f64;
        // of a point all is at its one place
        let share = if side == DVec2::ZERO { 1.0 } else { up_to(ends[1]) - up_to(ends[0]) };
        inside.then_some((place.y as usize * columns as usize + place.x as usize, share))
    };
    cuts.windows(2).filter_map(part).collect()
}

/// What the receivers add to the colour of a hit: diffuse reflection of the light that falls there.
pub fn reflected(scene: &Scene, lit: &Illumination, triangle: u32, bary: [f64; 2]) -> [f32; 3] {
    let corners = scene.mesh.triangles[triangle as usize].map(|k| scene.mesh.positions[k as usize]);
    let Some(map) = lit.maps.iter().find(|m| corners.iter().all(|p| is_in_plane(&m.receiver, *p))) else {
        return [0.0; 3];
    };
    let [a, b, c] = corners;
    let p: DVec3 = a + bary[0] * (b - a) + bary[1] * (c - a);
    let diffuse = scene.mesh.materials[scene.mesh.material_of[triangle as usize] as usize].diffuse;
    let received = map.irradiance(map.receiver.texels_of(p)).unwrap_or_default();
    [0, 1, 2].map(|k| (f64::from(diffuse[k]) * received[k] / std::f64::consts::PI) as f32)
}

/// A scene's camera shows caustics where it has some.
pub fn shown_by(scene: &Scene, camera: &Camera, shown: &Outcome, lit: &Illumination) -> [f32; 3] {
    let first = camera.optics.as_ref().map_or(u32::MAX, |o| o.first_id(&scene.mesh));
    match shown.seen.filter(|s| s.hit.triangle < first) {
        Some(seen) => reflected(scene, lit, seen.hit.triangle, seen.hit.bary),
        None => [0.0; 3],
    }
}
