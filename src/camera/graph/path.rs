//! Ways around what hides a target (Popescu et al., section 3.3, Fig. 8).

use super::Bend;
use super::view::View;
use crate::camera::Bundle;
use crate::camera::perturb::scene_size;
use crate::geometry::cast::Caster;
use crate::geometry::mesh::Mesh;
use glam::{DVec2, DVec3};
use rayon::prelude::*;

/// The scene's triangles, asked by exact rays.
pub struct Occluders<'a> {
    caster: Caster<'a>,
    scene_size: f64,
}

impl<'a> Occluders<'a> {
    pub fn of(mesh: &'a Mesh) -> Occluders<'a> {
        Occluders { caster: Caster::new(mesh), scene_size: scene_size(mesh.bounds()) }
    }

    /// The smallest t in [0, end] at which the ray meets what is visible.
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
            let way = leg[1] - leg[0];
            self.first(leg[0], way, 1.0).map(|t| leg[0] + t * way)
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

/// Surfaces on one ray, at most; one more is behind the way that is then tried, and found to bar it.
const HITS_MAX: usize = 1000;
/// How far behind a hit the next one is looked for, relative: a hit's t is within 1e-9 of itself.
const T_STEP: f64 = 4e-9;

/// A way around: rays are moved by `shift` (world units, parallel to the image) from depth `out` on, reached from the
/// eye, until depth `back`; at depth `end` they are on their plain lines again.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Way {
    pub shift: DVec3,
    pub out: f64,
    pub back: f64,
    pub end: f64,
}

/// How many straight parts stand for a curve when it is tried.
pub const CURVE_PARTS: usize = 16;

impl Way {
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
        let parts = if let Bend::Cuts(n) = bend { n } else { CURVE_PARTS };
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

/// What is to be seen: image places, and the depth of the target's front.
#[derive(Debug, Clone)]
pub struct Sight {
    pub places_px: Vec<DVec2>,
    pub front: f64,
}

/// How far rays are moved, as parts of the largest: 2^(-k/4); each way is then shortened to within 2^-20 of that step.
const STEPS: i32 = 48;
const HALVINGS: usize = 20;
/// Clearance beside what hides the target, as a part of the shift.
const CLEARANCE: f64 = 1.05;
/// Where rays are moved out, as parts of the way to the first thing that hides the target; and where they begin to
/// return, as parts of the way from the last such thing to the target.
const OUT: [f64; 4] = [0.9, 0.7, 0.5, 0.3];
const BACK: [f64; 4] = [0.1, 0.3, 0.6, 0.9];

impl Sight {
    /// The depths of the first and the last thing that hides any of the places.
    pub fn hidden(&self, view: &View, occluders: &Occluders) -> Option<[f64; 2]> {
        let spans = self.places_px.iter().filter_map(|q| occluders.span(view, *q, self.front));
        spans.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])
    }

    /// For each direction (unit, parallel to the image) the way with the least slope, if there is one.
    pub fn ways(
        &self,
        view: &View,
        occluders: &Occluders,
        directions: &[DVec3],
        (bend, largest): (Bend, f64),
    ) -> Vec<Option<Way>> {
        let Some([first, last]) = self.hidden(view, occluders) else { return vec![None; directions.len()] };
        let tries: Vec<(f64, f64)> = OUT.iter().flat_map(|o| BACK.map(|b| (*o, b))).collect();
        let of = |direction: &DVec3| {
            let ways = tries.par_iter().filter_map(|&(out, back)| {
                let way = Way {
                    shift: *direction,
                    out: out * first,
                    back: last + back * (self.front - last),
                    end: self.front,
                };
                // a thing that touches the target's front leaves no room to return
                let room = way.out > 0.0 && way.out < way.back && way.back < way.end;
                if room { self.shortest(view, occluders, way, (bend, largest)) } else { None }
            });
            // the first of the flattest, whatever the order in which they are found
            let ways: Vec<Way> = ways.collect();
            ways.into_iter().reduce(|a, b| if b.slope() < a.slope() { b } else { a })
        };
        directions.iter().map(of).collect()
    }

    /// The way with the least free shift along its own.
    fn shortest(&self, view: &View, occluders: &Occluders, way: Way, (bend, largest): (Bend, f64)) -> Option<Way> {
        let shifted = |by: f64| Way { shift: by * way.shift, ..way };
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
