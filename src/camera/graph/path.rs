//! Detours of rays around the occluders of a target (Popescu et al., section 3.3, Fig. 8).

use super::Bend;
use super::view::View;
use crate::arrays::MapEach;
use crate::camera::Bundle;
use crate::camera::perturb::scene_size;
use crate::geometry::cast::Caster;
use crate::geometry::mesh::Mesh;
use crate::parallel;
use glam::{DVec2, DVec3};

/// The scene's triangles and spheres, intersected exactly.
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
            let [a, b] = [from, to].map_each(|z| (z - first) / (last - first));
            [smooth(a, a, a), smooth(a, a, b), smooth(a, b, b), smooth(b, b, b)]
        };
        match to {
            z if z <= self.out => on(0.0, self.out),
            z if z <= self.back => [1.0; 4],
            z if z <= self.end => on(self.back, self.end).map_each(|s| 1.0 - s),
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
    /// Half-size of the target's outline in the picture; how far around it what hides a place counts as if it hid the target;
    /// and how far beyond that the search looks for what is about to hide it, px.
    pub outline_px: f64,
    pub beside_px: f64,
    pub ahead_px: f64,
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
/// Directions around a target in which the search looks ahead, and places along each.
const SPOKES: usize = 16;
const PLACES: usize = 12;
/// Halvings of the distance between two of these places, for the edge of what hides the one and not the other.
const EDGE_HALVINGS: usize = 16;
/// What is about to hide the target counts if its shift is at most this many times the target's own.
const SHIFT_AHEAD_MAX: f64 = 2.0;
/// An occluder's edge is nearer than the target by more than this part of its depth.
pub const EDGE_DEPTH: f64 = 1.0 / 256.0;
/// A detour counts in the mean of all that are less steep than this many times the flattest.
const SPREAD: f64 = 2.0;

/// The weight of a detour among several: 1 for the flattest, falling to 0 at [`SPREAD`] times its slope.
pub fn weight(slope: f64, flattest: f64) -> f64 {
    if slope.is_finite() { ((SPREAD * flattest - slope) / ((SPREAD - 1.0) * flattest)).clamp(0.0, 1.0) } else { 0.0 }
}

/// What is known of the detours of a target before one is chosen.
#[derive(Debug)]
pub struct Candidates {
    /// The lines of sight that must be free: the target's own; if all of them are, that nearest to it which is not.
    places_px: Vec<DVec2>,
    /// Depths of the first and the last occluder.
    span: [f64; 2],
    /// 1 for a hidden target; else falling to 0 with the distance to what is about to hide it.
    pub fade: f64,
    /// For each direction, the slope of each of [`tries`]; infinite if it is blocked.
    slopes: Vec<Vec<f64>>,
}

/// Pairs of [`OUT`] and [`BACK`].
fn tries() -> Vec<[f64; 2]> {
    OUT.iter().flat_map(|o| BACK.map_each(|b| [*o, b])).collect()
}

impl Candidates {
    /// The slope of the flattest detour in a direction; infinite if all are blocked.
    pub fn flattest(&self, direction: usize) -> f64 {
        self.slopes[direction].iter().copied().fold(f64::INFINITY, f64::min)
    }
}

/// The scene before a view, and how rays may pass through it.
#[derive(Clone, Copy)]
pub struct Paths<'a> {
    pub view: &'a View,
    pub occluders: &'a Occluders<'a>,
    /// Unit, parallel to the image.
    pub directions: &'a [DVec3],
    pub bend: Bend,
    /// The largest shift that is tried.
    pub largest: f64,
    /// The mean of detours is used if it is less steep than this many times the flattest; opposite directions have none.
    pub steep: f64,
}

/// How far before a target's front the search for what hides it ends, as a part of the way there: a ball of the target's size is no
/// occluder of it.
const FRONT: f64 = 1.0 / (1u64 << 24) as f64;

impl SightLines {
    fn before_front(&self) -> f64 {
        (1.0 - FRONT) * self.front
    }

    /// The depths of the first and the last occluder of any of the places.
    pub fn hidden(&self, view: &View, occluders: &Occluders) -> Option<[f64; 2]> {
        let spans = self.places_px.iter().filter_map(|q| occluders.span(view, *q, self.before_front()));
        spans.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])
    }

    /// Places around the target, along each of the spokes, and their weights: 1 at its outline and beside it, 0 where the search
    /// ends.
    fn spokes(&self) -> impl Iterator<Item = impl Fn(f64) -> (DVec2, f64)> {
        let (centre, from, width) = (self.places_px[0], self.outline_px, self.beside_px + self.ahead_px);
        let steep = width / self.ahead_px;
        (0..SPOKES).map(move |k| {
            let along = DVec2::from_angle(std::f64::consts::TAU * k as f64 / SPOKES as f64);
            move |part: f64| (centre + (from + part * width) * along, (steep * (1.0 - part)).min(1.0))
        })
    }

    /// The place nearest to the target at which an occluder's edge is before its depth, and its weight. A surface that
    /// runs through the target's depth there, as the floor below it, has no edge.
    fn edge(&self, paths: &Paths) -> Option<(DVec2, f64)> {
        let first = |q: DVec2| {
            let ray = paths.view.ray(q);
            paths.occluders.first(ray.origin, ray.direction, self.front)
        };
        let on = |spoke: &dyn Fn(f64) -> (DVec2, f64)| {
            let part = |k: usize| k as f64 / PLACES as f64;
            let k = (0..PLACES).find(|k| first(spoke(part(*k)).0).is_some())?;
            let (mut low, mut high) = (part(k.saturating_sub(1)), part(k));
            for _ in 0..EDGE_HALVINGS {
                let middle = (low + high) / 2.0;
                if first(spoke(middle).0).is_some() { high = middle } else { low = middle }
            }
            let depth = first(spoke(high).0)?;
            (depth < (1.0 - EDGE_DEPTH) * self.front).then_some((high, spoke(high)))
        };
        let nearest = self.spokes().filter_map(|spoke| on(&spoke)).reduce(|a, b| if b.0 < a.0 { b } else { a });
        nearest.map(|(_, edge)| edge)
    }

    /// The detours of a target that is hidden, or about to be.
    pub fn candidates(&self, paths: &Paths) -> Option<Candidates> {
        let of = |places_px: Vec<DVec2>, span: [f64; 2], fade: f64| {
            let slope = |direction: &DVec3, [out, back]: [f64; 2]| {
                let detour = self.detour(*direction, span, [out, back])?;
                Some(shortest(paths, &places_px, detour)?.slope())
            };
            let slopes_in = |d: &DVec3| parallel::map(&tries(), |t| slope(d, *t).unwrap_or(f64::INFINITY));
            let slopes = paths.directions.iter().map(slopes_in).collect();
            Candidates { places_px, span, fade, slopes }
        };
        if let Some(span) = self.hidden(paths.view, paths.occluders) {
            return Some(of(self.places_px.clone(), span, 1.0));
        }
        let (place_px, weight) = self.edge(paths)?;
        let span = paths.occluders.span(paths.view, place_px, self.before_front())?;
        Some(of(vec![place_px], span, weight))
    }

    /// A detour by `direction`; `None` if an occluder that touches the target's front leaves no depth to return.
    fn detour(&self, direction: DVec3, [first, last]: [f64; 2], [out, back]: [f64; 2]) -> Option<Detour> {
        let detour =
            Detour { shift: direction, out: out * first, back: last + back * (self.front - last), end: self.front };
        let fits = detour.out > 0.0 && detour.out < detour.back && detour.back < detour.end;
        fits.then_some(detour)
    }

    /// The detour in the mean of the flattest candidates, each direction weighted, so that it changes smoothly with the
    /// target's place; if that mean is blocked or steep, the flattest candidate.
    pub fn chosen(&self, paths: &Paths, candidates: &Candidates, weights: &[f64]) -> Option<Detour> {
        let (mut direction, mut parts, mut sum) = (DVec3::ZERO, [0.0; 2], 0.0);
        let mut best: Option<(f64, DVec3, [f64; 2])> = None;
        for (d, w) in weights.iter().enumerate().filter(|(_, w)| **w > 0.0) {
            let flattest = candidates.flattest(d);
            for (slope, t) in candidates.slopes[d].iter().zip(tries()) {
                let w = w * weight(*slope, flattest);
                direction += w * paths.directions[d];
                parts = [0, 1].map_each(|k| parts[k] + w * t[k]);
                sum += w;
                if w > 0.0 && best.is_none_or(|b| *slope < b.0) {
                    best = Some((*slope, paths.directions[d], t));
                }
            }
        }
        let (flattest, of_flattest, t) = best?;
        let mean = || {
            let (direction, parts) = (direction.try_normalize()?, parts.map_each(|p| p / sum));
            let ahead = self.ahead(paths, candidates.span, direction, parts);
            let detour = self.detour(direction, widened(candidates.span, &ahead), parts)?;
            let own = shortest(paths, &candidates.places_px, detour)?;
            if own.slope() > paths.steep * flattest {
                return None;
            }
            // longer already where a longer one is about to be needed, if that leaves the target in sight
            let least = candidates.fade * own.shift.length();
            let counted = ahead.iter().filter(|a| a.shift <= SHIFT_AHEAD_MAX * own.shift.length());
            let longest = counted.map(|a| a.weight * a.shift).fold(least, f64::max);
            let of = |by: f64| Detour { shift: by * direction, ..own };
            let is_clear = |by: f64| is_free(paths, &self.places_px, &of(by));
            let (mut low, mut high) = (least, longest);
            if least < longest && !is_clear(longest) {
                for _ in 0..HALVINGS {
                    let middle = (low + high) / 2.0;
                    if is_clear(middle) { low = middle } else { high = middle }
                }
                return Some(of(low));
            }
            Some(of(longest))
        };
        let simple = || {
            let own = shortest(paths, &candidates.places_px, self.detour(of_flattest, candidates.span, t)?)?;
            Some(Detour { shift: candidates.fade * own.shift, ..own })
        };
        mean().or_else(simple)
    }

    /// What hides the places around the target, where a detour passes it.
    fn ahead(&self, paths: &Paths, span: [f64; 2], direction: DVec3, parts: [f64; 2]) -> Vec<Ahead> {
        let places = self.spokes().flat_map(|spoke| (1..PLACES).map(move |k| spoke(k as f64 / PLACES as f64)));
        let of = |&(q, weight): &(DVec2, f64)| {
            let own = paths.occluders.span(paths.view, q, self.before_front())?;
            let both = [span[0].min(own[0]), span[1].max(own[1])];
            let shift = shortest(paths, &[q], self.detour(direction, both, parts)?)?.shift.length();
            Some(Ahead { weight, span: own, shift })
        };
        parallel::flat_map(&places.collect::<Vec<_>>(), of)
    }
}

/// What hides a place beside a target.
struct Ahead {
    /// 1 at the target's outline, 0 where the search ends.
    weight: f64,
    /// Depths of the first and the last occluder.
    span: [f64; 2],
    /// The shift that passes them, world units.
    shift: f64,
}

/// The depths of the first and the last occluder, moved by their weights towards those that are about to be.
fn widened(span: [f64; 2], ahead: &[Ahead]) -> [f64; 2] {
    let mixed = |k: usize| ahead.iter().map(move |a| span[k] + a.weight * (a.span[k] - span[k]));
    [mixed(0).fold(span[0], f64::min), mixed(1).fold(span[1], f64::max)]
}

/// Nothing is on the detour's rays at the image places.
fn is_free(paths: &Paths, places_px: &[DVec2], detour: &Detour) -> bool {
    let line_to_front = |q: &DVec2| {
        let mut line = detour.line(paths.view, *q, paths.bend);
        if let [.., from, to] = &mut line[..] {
            *to = from.lerp(*to, 1.0 - FRONT);
        }
        line
    };
    places_px.iter().all(|q| paths.occluders.first_on(&line_to_front(q)).is_none())
}

/// The detour with the least unoccluded shift in its direction.
fn shortest(paths: &Paths, places_px: &[DVec2], detour: Detour) -> Option<Detour> {
    let shifted = |by: f64| Detour { shift: by * detour.shift, ..detour };
    let free = |by: f64| is_free(paths, places_px, &shifted(by));
    let step = |k: i32| paths.largest * (-f64::from(k) / 4.0).exp2();
    let k = (0..STEPS).rev().find(|&k| free(step(k)))?;
    let (mut low, mut high) = (step(k + 1), step(k));
    for _ in 0..HALVINGS {
        let middle = (low + high) / 2.0;
        if free(middle) { high = middle } else { low = middle }
    }
    Some(if free(CLEARANCE * high) { shifted(CLEARANCE * high) } else { shifted(high) })
}
