//! The first hits of paths, and the hits that tie with them.

use super::bvh::Probe;
use super::curve::{Sweep, is_flat, meetings};
use super::intersect::Meeting;
use super::margin::{beyond, clears};
use super::path::{Path, Seen, Segment};
use super::{Hit, Reference, nearer, past};
use crate::camera::curve::Curve;

/// The answer at one image place.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Answer {
    pub seen: Option<Seen>,
    /// Other triangles that tie with the first hit.
    pub ties: Vec<u32>,
    /// The curve touches the visible triangle, or crosses it at so small an angle that t is uncertain.
    pub touches: bool,
}

/// A path's segment in one layer and the hits that may be its answer.
struct Candidates<'a> {
    path: &'a Path,
    layer: usize,
    piece: u32,
    segment: &'a Segment,
    range: [f64; 2],
    /// The largest t still of interest.
    limit: f64,
    /// Visible hits in range, in no order.
    near: Vec<Hit>,
}

impl Reference<'_> {
    /// A path's first hit: the lowest layer with a visible hit, the smallest t there, the lowest id among equals.
    pub fn first(&self, path: &Path) -> Option<Seen> {
        let reference = Reference { has_layers: path.segments.len() > 1, ..self.clone() };
        (0..path.segments.len()).find_map(|layer| {
            let (piece, segment) = path.segments[layer].as_ref()?;
            let range = path.range(layer);
            let mut best = None;
            let mut visit = |hit| {
                best = nearer(best, hit);
                best.map_or(f64::INFINITY, |b| past(b.t))
            };
            match segment {
                Segment::Straight(bundle) => reference.each_hit_of_ray(bundle, range, visit),
                Segment::Curved(curve) => self.each_hit_of_curves(&[*curve], &[range], |_, hit| visit(hit)),
            }
            best.map(|hit| Seen { layer, piece: *piece, hit: Hit { t: path.within(hit.t), ..hit } })
        })
    }

    /// The first hits of several paths through neighbouring places, and the hits that tie with them.
    pub(super) fn answers(&self, paths: &[Path]) -> Vec<Answer> {
        let mut answers = vec![Answer::default(); paths.len()];
        let layers = paths.iter().map(|p| p.segments.len()).max().unwrap_or(0);
        for layer in 0..layers {
            let pairs = paths.iter().zip(&mut answers);
            let (mut candidates, answers): (Vec<Candidates>, Vec<&mut Answer>) =
                pairs.filter_map(|(path, answer)| Some((Candidates::new(path, layer, answer)?, answer))).unzip();
            self.gather(&mut candidates);
            candidates.iter().zip(answers).for_each(|(list, answer)| list.add_to(answer));
        }
        for (path, answer) in paths.iter().zip(&mut answers) {
            let Some(seen) = answer.seen else { continue };
            answer.ties.retain(|id| !self.hides_twin(seen.hit.triangle, *id));
            answer.touches = self.touches(path.of(&seen), &seen.hit);
        }
        answers
    }

    /// Intersects the segments with the triangles.
    fn gather(&self, candidates: &mut [Candidates]) {
        let (mut curves, mut ranges, mut curved) = (Vec::new(), Vec::new(), Vec::new());
        for list in candidates {
            match list.segment {
                Segment::Straight(bundle) => self.each_hit_of_ray(bundle, list.range, |hit| list.take(hit)),
                Segment::Curved(curve) => {
                    curves.push(*curve);
                    ranges.push(list.range);
                    curved.push(list);
                }
            }
        }
        self.each_hit_of_curves(&curves, &ranges, |k, hit| curved[k].take(hit));
    }

    /// Both triangles have the same three corners, or both spheres or capsules are the same: wherever one is hit, so is the other.
    fn hides_twin(&self, seen: u32, other: u32) -> bool {
        let same_size = self.mesh.radius(self.own(seen)) == self.mesh.radius(self.own(other));
        !self.mesh.has_alpha(self.own(seen)) && same_size && self.corners(seen).v == self.corners(other).v
    }

    /// A curve crosses the surface of a hit at so small an angle that t is uncertain by more than [`super::GAP`].
    pub(super) fn touches(&self, segment: &Segment, hit: &Hit) -> bool {
        match segment {
            Segment::Straight(_) => false,
            Segment::Curved(c) => match self.round(hit.triangle) {
                Some(round) => round.is_flat(c, hit.t),
                None => is_flat(c, &self.corners(hit.triangle), hit.t),
            },
        }
    }

    /// Every visible hit of curves of one degree, each in its range; each meeting of a triangle by itself. They are
    /// searched together, which is fast if they are close. `visit` takes a curve's index and returns the largest t still of
    /// interest to it.
    pub(super) fn each_hit_of_curves(
        &self,
        curves: &[Curve],
        ranges: &[[f64; 2]],
        mut visit: impl FnMut(usize, Hit) -> f64,
    ) {
        let Some(sweep) = Sweep::around(curves) else { return };
        let start = ranges.iter().fold(f64::INFINITY, |m, r| m.min(r[0]));
        let mut limits: Vec<f64> = ranges.iter().map(|r| r[1]).collect();
        let last = |limits: &[f64]| limits.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        self.tree.walk(self.instances, &sweep, [start, last(&limits)], |id| {
            let round = self.round(id);
            let corners = self.solid_corners(id);
            let Some((lo, hi)) = round.map(|r| r.bounds()).or(corners.map(|c| c.bounds())) else {
                return last(&limits);
            };
            if sweep.span(lo, hi, [start, last(&limits)]).is_none() {
                return last(&limits);
            }
            for (k, (curve, range)) in curves.iter().zip(ranges).enumerate() {
                let of_triangle = corners.iter().flat_map(|c| meetings(curve, c)).map(|m| (m.t, m.sign, m.bary));
                let of_round = round.iter().flat_map(|s| s.roots(curve)).map(|r| (r.t, r.sign, [0.0; 2]));
                for (t, sign, bary) in of_triangle.chain(of_round) {
                    let m = Meeting { t, sign, bary };
                    let seen = m.sign < 0 || self.two_sided(id);
                    let hit = Hit { t: m.t, triangle: id, bary: m.bary };
                    if seen && range[0] <= m.t && m.t <= range[1] && self.is_there(hit.triangle, hit.bary) {
                        limits[k] = limits[k].min(visit(k, hit));
                    }
                }
            }
            last(&limits)
        });
    }
}

impl<'a> Candidates<'a> {
    /// Along the path's segment in a layer, as far as it may change the answer of the layers before.
    fn new(path: &'a Path, layer: usize, before: &Answer) -> Option<Candidates<'a>> {
        let (piece, segment) = path.segments.get(layer)?.as_ref()?;
        let [t0, t1] = path.range(layer);
        let limit = before.seen.map_or(f64::INFINITY, |s| beyond(s.t())) - layer as f64;
        let range = [t0, t1.min(limit)];
        (limit >= t0).then_some(Candidates { path, layer, piece: *piece, segment, range, limit, near: Vec::new() })
    }

    /// The t of the whole path where that of the layer is 0.
    fn base(&self) -> f64 {
        self.layer as f64
    }

    /// Adds a hit; returns the largest t still of interest.
    fn take(&mut self, hit: Hit) -> f64 {
        self.near.push(hit);
        self.limit = self.limit.min(beyond(self.base() + hit.t) - self.base());
        self.limit
    }

    fn add_to(&self, answer: &mut Answer) {
        if answer.seen.is_none() {
            let (layer, piece) = (self.layer, self.piece);
            let first = self.near.iter().copied().fold(None, nearer);
            answer.seen = first.map(|hit| Seen { layer, piece, hit: Hit { t: self.path.within(hit.t), ..hit } });
        }
        let front = answer.seen.map_or(0.0, |s| s.t());
        answer.ties.extend(self.near.iter().filter(|h| !clears(front, self.base() + h.t)).map(|h| h.triangle));
    }
}
