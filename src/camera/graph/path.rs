//! Detours of rays around the occluders of a target (Popescu et al., section 3.3, Fig. 8).

use super::Bend;
use super::view::View;
use crate::camera::Bundle;
use crate::camera::perturb::scene_size;
use crate::geometry::cast::Caster;
use crate::geometry::mesh::Mesh;
use glam::{DVec2, DVec3};
use rayon::prelude::*;

/// The scene's triangles, intersected exactly.
pub struct Occluders<'a> {
    caster: Caster<'a>,
    scene_size: f64,
}

impl<'a> Occluders<'a> {
    pub fn of(mesh: &'a Mesh) -> Occluders<'a> {
        Occluders { caster: Caster::new(mesh), scene_size: scene_size(mesh.bounds()) }
    }

    /// The smallest t in [0, end] at which the ray hits a visible face.
    pub fn first(&self, origin: DVec3, direction: DVec3, end: f64) -> Option<f64> {
        self.between(origin, direction, [0.0, end])
    }

    fn between(&self, origin: DVec3, direction: DVec3, range: [f64; 2]) -> Option<f64> {
        let zero = DVec3::ZERO;
        let bundle = Bundle { p: [origin, zero, zero], d: [direction, zero, zero], h: [1.0, 0.0, 0.0] };
        self.caster.first(&bundle.aim(self.scene_size)?, range).map(|hit| hit.t)
    }

    /// Where a polyline first meets something.
    pub fn first_on(&self, line: &[DVec3]) -> Option<DVec3> {
        line.windows(2).find_map(|leg| {
            let direction = leg[1] - leg[0];
            self.first(leg[0], direction, 1.0).map(|t| leg[0] + t * direction)
        })
    }

    /// The first and the last depth under `end` at which something is on the view's ray.
    fn span(&self, view: &View, place_px: DVec2, end: f64) -> Option<[f64; 2]> {
        let ray = view.ray(place_px);
        let first = self.first(ray.origin, ray.direction, end)?;
        let mut last = first;
        for _ in 0..HITS_MAX {
            let past = last + T_STEP * last;
            match self.between(ray.origin, ray.direction, [past, end]) {
                Some(t) if past < end => last = t,
                _ => break,
            }
        }
        Some([first, last])
    }
}

/// Most surfaces on one ray. If there are more, the detour is tried all the same and found blocked.
const HITS_MAX: usize = 1000;
/// Relative distance behind a hit at which the search for the next one starts: a hit's t has relative error 1e-9.
const T_STEP: f64 = 4e-9;

/// A detour: rays leave the eye, are shifted by `shift` (world units, parallel to the image) from depth `out` to depth `back`, and
/// are on their straight lines again at depth `end`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Detour {
    pub shift: DVec3,
    pub out: f64,
    pub back: f64,
    pub end: f64,
}

/// Straight parts that approximate a curve in the occlusion test.
pub const CURVE_PARTS: usize = 16;

impl Detour {
    /// The share of the shift at a depth, as a smooth step up and down.
    pub fn share(&self, depth: f64) -> f64 {
        self.shares(depth, depth)[0]
    }

    /// The Bezier points of the share between two depths that no end of a slope lies between.
    pub fn shares(&self, from: f64, to: f64) -> [f64; 4] {
        let on = |first: f64, last: f64| {
            let [a, b] = [from, to].map(|z| (z - first) / (last - first));
            [smooth(a, a, a), smooth(a, a, b), smooth(a, b, b), smooth(b, b, b)]
        };
        match to {
            z if z <= self.out => on(0.0, self.out),
            z if z <= self.back => [1.0; 4],
            z if z <= self.end => on(self.back, self.end).map(|s| 1.0 - s),
            _ => [0.0; 4],
        }
    }

    /// The shift changes between two depths that no end of a slope lies between.
    pub fn is_sloped(&self, to: f64) -> bool {
        to <= self.out || (self.back < to && to <= self.end)
    }

    /// The depths between which the ray is taken as straight, with `parts` of them on either slope.
    fn depths(&self, parts: usize) -> Vec<f64> {
        let slope = |from: f64, to: f64| (0..=parts).map(move |k| from + (to - from) * k as f64 / parts as f64);
        slope(0.0, self.out).chain(slope(self.back, self.end)).collect()
    }

    /// The ray at an image place from the eye to `end`.
    fn line(&self, view: &View, place_px: DVec2, bend: Bend) -> Vec<DVec3> {
        let parts = if let Bend::Straight(n) = bend { n } else { CURVE_PARTS };
        self.depths(parts).into_iter().map(|z| view.point(place_px, z) + self.share(z) * self.shift).collect()
    }

    /// How far the rays are moved in the picture: where their shift is largest against their depth.
    pub fn slope(&self) -> f64 {
        self.shift.length() / self.out
    }
}

/// The polar form of `3 z^2 - 2 z^3`, the smooth step: Bezier points between two depths are its values at them, mixed.
fn smooth(x: f64, y: f64, z: f64) -> f64 {
    x * y + y * z + z * x - 2.0 * x * y * z
}

/// The lines of sight to a target: image places, px, and the depth of the target's front.
#[derive(Debug, Clone)]
pub struct SightLines {
    pub places_px: Vec<DVec2>,
    pub front: f64,
}

/// How far rays are moved, as parts of the largest: 2^(-k/4); each shift is then reduced to within 2^-20 of that step.
const STEPS: i32 = 48;
const HALVINGS: usize = 20;
/// Clearance beside what hides the target, as a part of the shift.
const CLEARANCE: f64 = 1.05;
/// Where rays are moved out, as shares of the depth of the first occluder; and where they begin to
/// return, as shares of the depth from the last occluder to the target.
const OUT: [f64; 4] = [0.9, 0.7, 0.5, 0.3];
const BACK: [f64; 4] = [0.1, 0.3, 0.6, 0.9];

impl SightLines {
    /// The depths of the first and the last occluder of any of the places.
    pub fn hidden(&self, view: &View, occluders: &Occluders) -> Option<[f64; 2]> {
        let spans = self.places_px.iter().filter_map(|q| occluders.span(view, *q, self.front));
        spans.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])
    }

    /// The detour of least slope for each direction (unit, parallel to the image); `None` if all are blocked.
    pub fn detours(
        &self,
        view: &View,
        occluders: &Occluders,
        directions: &[DVec3],
        (bend, largest): (Bend, f64),
    ) -> Vec<Option<Detour>> {
        let Some([first, last]) = self.hidden(view, occluders) else { return vec![None; directions.len()] };
        let tries: Vec<(f64, f64)> = OUT.iter().flat_map(|o| BACK.map(|b| (*o, b))).collect();
        let of = |direction: &DVec3| {
            let detours = tries.par_iter().filter_map(|&(out, back)| {
                let detour = Detour {
                    shift: *direction,
                    out: out * first,
                    back: last + back * (self.front - last),
                    end: self.front,
                };
                // an occluder that touches the target's front leaves no depth to return
                let fits = detour.out > 0.0 && detour.out < detour.back && detour.back < detour.end;
                if fits { self.shortest(view, occluders, detour, (bend, largest)) } else { None }
            });
            // the first of the flattest, in the order of `tries`: deterministic
            let detours: Vec<Detour> = detours.collect();
            detours.into_iter().reduce(|a, b| if b.slope() < a.slope() { b } else { a })
        };
        directions.iter().map(of).collect()
    }

    /// The detour with the least unoccluded shift in its direction.
    fn shortest(
        &self,
        view: &View,
        occluders: &Occluders,
        detour: Detour,
        (bend, largest): (Bend, f64),
    ) -> Option<Detour> {
        let shifted = |by: f64| Detour { shift: by * detour.shift, ..detour };
        let free = |by: f64| {
            let clear = |q: &DVec2| occluders.first_on(&shifted(by).line(view, *q, bend)).is_none();
            self.places_px.iter().all(clear)
        };
        let step = |k: i32| largest * (-f64::from(k) / 4.0).exp2();
        let k = (0..STEPS).rev().find(|&k| free(step(k)))?;
        let (mut low, mut high) = (step(k + 1), step(k));
        for _ in 0..HALVINGS {
            let middle = (low + high) / 2.0;
            if free(middle) { high = middle } else { low = middle }
        }
        Some(if free(CLEARANCE * high) { shifted(CLEARANCE * high) } else { shifted(high) })
    }
}
