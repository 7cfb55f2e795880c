//! The detours of targets where they are; and, with `smooth`, of targets that move: found for targets at the points of a lattice
//! that is fixed in the view, and interpolated linearly between them.
//!
//! What is found at a point may differ from what is found at the next by any amount: where a detour is blocked, where targets cease
//! to have a direction in common, where the flattest detours are opposite. Interpolated, the shift of a target's rays is continuous in
//! the places of all targets: it changes by the difference between two points of the lattice while its target, or another,
//! moves from the one to the other. Between opposite detours the rays pass through what hides the target. Where the detours
//! at neighbouring points are alike, those between see the target as they do, since each passes all that hides places
//! up to the next point.

use super::blend::{GUARD, MARGIN_PX, Seen, Target, before, graphs};
use super::path::{self, Candidates, Detour, EDGE_DEPTH, Occluders, Paths, SightLines};
use super::view::View;
use super::{Graph, lattice};
use crate::arrays::MapEach;
use crate::camera::LAYERS_MAX;
use crate::parallel;
use glam::{DVec2, DVec3};
use std::collections::BTreeMap;

/// How far around a target the search looks for what is about to hide it, in parts of the image's height.
const AHEAD: f64 = 1.0 / 16.0;
/// The distance between two points of the lattice in depth, in parts of the depth: what is less before a target is no edge that hides it.
const STEP_DEPTH: f64 = EDGE_DEPTH;
/// A target is left out by degrees from this weight of the lattice's points at which it can be reached.
const REACHED: f64 = 1.0 / 16.0;
/// How often a detour disturbed by others is widened, and the factor; halvings of the last step.
const WIDENINGS: usize = 12;
const WIDENING: f64 = 1.25;
const WIDENING_HALVINGS: usize = 8;
/// How steep the mean of detours may be, in parts of the flattest. With `smooth` more, so that rays pass over a house that they would
/// otherwise go through, from one of its sides to the other.
const STEEP: f64 = 2.0;
const STEEP_SMOOTH: f64 = 3.0;
/// Points on a target's outline that must be seen, and on one half as large.
const OUTLINE: usize = 8;

impl Seen {
    /// A target as it is seen without detours, in a picture that goes from 0 to `end` (px); `None` if it is not wholly before the eye.
    /// `beside_px`: how far around it its detour is of use.
    pub fn new(view: &View, end: DVec2, index: usize, target: Target, beside_px: f64) -> Option<Seen> {
        let [right, down] = view.steps().map_each(DVec3::normalize);
        let front = view.depth(target.at) - target.radius;
        let place_px = view.place(target.at).filter(|_| front > 0.0)?;
        let ring = |radius: f64| {
            let angle = |k: usize| std::f64::consts::TAU * k as f64 / OUTLINE as f64;
            (0..OUTLINE).map(move |k| target.at + radius * (angle(k).cos() * right + angle(k).sin() * down))
        };
        let points = ring(target.radius).chain(ring(target.radius / 2.0));
        let places = points.filter(|_| target.radius > 0.0).filter_map(|p| view.place(p));
        let places_px: Vec<DVec2> = std::iter::once(place_px).chain(places).collect();
        let reach = |q: &DVec2| (*q - place_px).abs().max_element();
        let outline_px = places_px.iter().map(reach).fold(0.0, f64::max);
        let sight_lines = SightLines { places_px, front, outline_px, beside_px, ahead_px: AHEAD * end.y };
        let is_inside = place_px.cmpge(DVec2::ZERO).all() && place_px.cmple(end).all();
        let core_px = outline_px + MARGIN_PX;
        Some(Seen { index, target, place_px, is_inside, sight_lines, core_px, presence: 1.0, detour: None })
    }

    pub fn is_within(&self, lo: DVec2, hi: DVec2) -> bool {
        self.place_px.cmpge(lo).all() && self.place_px.cmple(hi).all()
    }

    /// Its core or its band is in the picture.
    pub fn meets(&self, view: &View, end: DVec2) -> bool {
        let reach = self.reach_px(view);
        (self.place_px + reach).cmpgt(DVec2::ZERO).all() && (self.place_px - reach).cmplt(end).all()
    }
}

/// Whether another target shows where one is.
pub fn is_behind(view: &View, seen: &[Seen], s: &Seen) -> bool {
    seen.iter().any(|o| {
        o.index != s.index
            && o.target.at != s.target.at
            && o.distance_px(s.place_px) <= (1.0 + GUARD) * o.core_px
            && before(view, o, s) > 0.0
    })
}

/// What is searched for detours, and how.
pub struct Search<'a> {
    pub paths: Paths<'a>,
    pub size: (u32, u32),
    /// Where the rays of graphs end.
    pub far: f64,
    pub segments: Option<usize>,
    /// The distance between two points of the lattice along the picture, in parts of the image's height; 0: detours are those of the
    /// targets' own places.
    pub smooth: f64,
}

/// [`Paths::steep`] for [`Search::smooth`].
pub fn steep(smooth: f64) -> f64 {
    if smooth > 0.0 { STEEP_SMOOTH } else { STEEP }
}

/// A target at a point of the lattice.
struct Prospect {
    seen: Seen,
    is_hidden: bool,
    candidates: Option<Candidates>,
}

impl Prospect {
    fn is_unreachable(&self) -> bool {
        self.is_hidden && self.candidates.is_none()
    }
}

/// The detour of a target, if it has or needs one; or why it is not tracked.
type Outcome = std::result::Result<Option<Detour>, String>;

impl Search<'_> {
    /// Gives targets their detours, and their presence: 0 for those that cannot be reached.
    pub fn set_detours(&self, seen: &mut [Seen], unfulfilled: &mut Vec<String>) {
        let step_px = self.smooth * self.end().y;
        let place = |s: &Seen| {
            let [x, y] = (s.place_px / step_px).to_array();
            // one step before the target: a point must not be behind the surface that the target is on
            let at = [x, y, s.sight_lines.front.ln() / STEP_DEPTH - 1.0];
            if self.smooth > 0.0 { at.to_vec() } else { Vec::new() }
        };
        let axes = if self.smooth > 0.0 { 3 } else { 0 };
        let point = |corner: &[i64], n: usize| corner[axes * n..axes * (n + 1)].to_vec();
        let mut prospects: BTreeMap<(usize, Vec<i64>), Prospect> = BTreeMap::new();
        for (k, s) in seen.iter_mut().enumerate() {
            let own: Vec<Vec<i64>> = lattice::corners(&place(s)).into_iter().map(|(corner, _)| corner).collect();
            let found: Vec<Prospect> = parallel::map(&own, |at| self.prospect(s, step_px, at));
            // no other target's place changes that it cannot be reached
            if found.iter().all(Prospect::is_unreachable) {
                s.presence = 0.0;
                unfulfilled.extend(s.is_inside.then(|| no_path(s.index, self.paths.largest)));
            }
            prospects.extend(own.into_iter().map(|at| (k, at)).zip(found));
        }
        let reachable: Vec<usize> = (0..seen.len()).filter(|k| seen[*k].presence > 0.0).collect();
        let corners = lattice::corners(&reachable.iter().flat_map(|k| place(&seen[*k])).collect::<Vec<f64>>());
        let outcomes_at = |(corner, _): &(Vec<i64>, f64)| {
            let of = |(n, k): (usize, &usize)| &prospects[&(*k, point(corner, n))];
            self.outcomes(&reachable.iter().enumerate().map(of).collect::<Vec<_>>())
        };
        let outcomes: Vec<Vec<Outcome>> = parallel::map(&corners, outcomes_at);
        // those for which there is no room are named from the last on
        for (n, k) in reachable.iter().enumerate().rev() {
            let s = &mut seen[*k];
            let of = || outcomes.iter().zip(&corners).map(|(all, (_, weight))| (&all[n], *weight));
            let found: Vec<(Option<Detour>, f64)> =
                of().filter_map(|(o, w)| Some((o.as_ref().ok().copied()?, w))).collect();
            let reached: f64 = found.iter().map(|(_, weight)| weight).sum();
            s.presence = (reached / REACHED).min(1.0);
            s.detour = mean(&found, s.sight_lines.front);
            if let (true, true, Some((Err(why), _))) = (found.is_empty(), s.is_inside, of().next()) {
                unfulfilled.push(why.clone());
            }
        }
    }

    /// A target at a point of the lattice, or, without one, where it is.
    fn prospect(&self, s: &Seen, step_px: f64, at: &[i64]) -> Prospect {
        let radius = s.target.radius;
        let at = match at {
            &[x, y, z] => {
                let depth = (z as f64 * STEP_DEPTH).exp() + radius;
                self.paths.view.point(step_px * DVec2::new(x as f64, y as f64), depth)
            }
            _ => s.target.at,
        };
        let target = Target { at, radius };
        // all points around a place are in one cell with it
        let beside_px = std::f64::consts::SQRT_2 * step_px;
        let seen = Seen::new(self.paths.view, self.end(), s.index, target, beside_px).unwrap_or_else(|| s.clone());
        let lines = &seen.sight_lines;
        let is_before_front = lines.hidden(self.paths.view, self.paths.occluders).is_some();
        // what is between a ball's front and its middle leaves no depth to return
        let is_hidden =
            is_before_front || !reaches(self.paths.view, self.paths.occluders, &[self.paths.view.eye(), at], &target);
        let candidates = (!is_hidden || is_before_front).then(|| lines.candidates(&self.paths)).flatten();
        let candidates = candidates.filter(|c| (0..self.paths.directions.len()).any(|d| c.flattest(d).is_finite()));
        Prospect { seen, is_hidden, candidates }
    }

    fn end(&self) -> DVec2 {
        DVec2::new(self.size.0 as f64, self.size.1 as f64)
    }

    /// The detours of targets at some points of the lattice: all in one direction if one works for all, so that neighbours
    /// bend alike, and so wide that none disturbs another.
    fn outcomes(&self, prospects: &[&Prospect]) -> Vec<Outcome> {
        let mut outcomes: Vec<Outcome> = prospects
            .iter()
            .map(|p| if p.is_unreachable() { Err(no_path(p.seen.index, self.paths.largest)) } else { Ok(None) })
            .collect();
        let reachable = || (0..prospects.len()).filter(|k| !prospects[*k].is_unreachable());
        // indices are those in `prospects` here
        let mut seen: Vec<Seen> = reachable().map(|k| Seen { index: k, ..prospects[k].seen.clone() }).collect();
        let of = |(n, k): (usize, usize)| Some((n, prospects[k].candidates.as_ref()?));
        let found: Vec<(usize, &Candidates)> = reachable().enumerate().filter_map(of).collect();
        self.choose(&mut seen, &found);
        let (mut seen, apart): (Vec<Seen>, Vec<Seen>) = seen.into_iter().partition(|s| {
            s.is_inside || ((self.smooth > 0.0 || s.detour.is_some()) && s.meets(self.paths.view, self.end()))
        });
        let index = |k: usize| prospects[k].seen.index;
        while seen.iter().any(|s| s.detour.is_some()) {
            let wide = self.widened(seen.clone());
            let left_out = match &wide {
                Ok(wide) => self.without_room(wide).map(|(k, segments)| (k, no_room(index(k), segments))),
                Err(k) => Some((*k, conflict(index(*k)))),
            };
            match (left_out, wide) {
                (Some((k, why)), _) => {
                    outcomes[k] = Err(why);
                    seen.retain(|s| s.index != k);
                }
                (None, Ok(wide)) => {
                    seen = wide;
                    break;
                }
                (None, Err(_)) => break,
            }
        }
        for s in seen.into_iter().chain(apart) {
            outcomes[s.index] = Ok(s.detour);
        }
        outcomes
    }

    /// Gives every target with candidates its detour.
    fn choose(&self, seen: &mut [Seen], found: &[(usize, &Candidates)]) {
        let weights = |cost: &dyn Fn(usize) -> f64| -> Option<Vec<f64>> {
            let costs: Vec<f64> = (0..self.paths.directions.len()).map(cost).collect();
            let least = costs.iter().copied().fold(f64::INFINITY, f64::min);
            least.is_finite().then(|| costs.iter().map(|c| path::weight(*c, least)).collect())
        };
        let common = weights(&|d| found.iter().map(|(_, c)| c.fade * c.flattest(d)).sum());
        for (k, candidates) in found {
            let own = || weights(&|d| candidates.flattest(d));
            let Some(weights) = common.clone().or_else(own) else { continue };
            seen[*k].detour = seen[*k].sight_lines.chosen(&self.paths, candidates, &weights);
        }
    }

    /// The graph in which rays make the targets' detours, and the plain one.
    pub fn graphs(&self, seen: &[Seen]) -> [Graph; 2] {
        graphs(self.paths.view, seen, self.size, self.far, self.segments)
    }

    /// The index of the last target with a detour, and how many segments rays have, if there are others and these are more than layers.
    pub fn without_room(&self, seen: &[Seen]) -> Option<(usize, usize)> {
        let last = seen.iter().rfind(|s| s.detour.is_some())?.index;
        if seen.iter().filter(|s| s.detour.is_some()).count() == 1 {
            return None;
        }
        let segments = self.graphs(seen)[0].legs.iter().map(|leg| leg.bent(self.paths.bend).len()).sum::<usize>();
        (segments > LAYERS_MAX).then_some((last, segments))
    }

    /// Whether the rays of the graph at a target's place reach its centre.
    pub fn is_reached(&self, graph: &Graph, s: &Seen) -> bool {
        let line = graph.line(s.place_px, self.paths.bend);
        line.is_some_and(|line| reaches(self.paths.view, self.paths.occluders, &line, &s.target))
    }

    /// The targets with detours so wide that none is hidden but those behind others; the error is the index of a target that
    /// stays hidden however far the detours are widened.
    fn widened(&self, mut seen: Vec<Seen>) -> std::result::Result<Vec<Seen>, usize> {
        let blocked = |seen: &[Seen]| {
            let [graph, _] = self.graphs(seen);
            let is_blocked =
                |s: &Seen| s.is_inside && !self.is_reached(&graph, s) && !is_behind(self.paths.view, seen, s);
            (0..seen.len()).filter(|k| is_blocked(&seen[*k])).collect::<Vec<usize>>()
        };
        let mut narrower: Option<Vec<Seen>> = None;
        let mut still_hidden = 0;
        for _ in 0..=WIDENINGS {
            let blocked_now = blocked(&seen);
            let Some(first) = blocked_now.first() else {
                // no wider than need be, so that the width changes smoothly with the targets' places
                let Some(mut low) = narrower else { return Ok(seen) };
                for _ in 0..WIDENING_HALVINGS {
                    let middle = mean_of(&low, &seen);
                    if blocked(&middle).is_empty() { seen = middle } else { low = middle }
                }
                return Ok(seen);
            };
            still_hidden = seen[*first].index;
            narrower = Some(seen.clone());
            for k in blocked_now {
                if let Some(detour) = &mut seen[k].detour {
                    detour.shift *= WIDENING;
                }
            }
        }
        Err(still_hidden)
    }
}

/// The mean of the detours at some points, by their weights, of a target with this front. Its depths are means weighted by how far
/// rays are moved: those of shifts that vanish do not count.
fn mean(found: &[(Option<Detour>, f64)], front: f64) -> Option<Detour> {
    if let [(detour, _)] = found {
        return detour.map(|d| Detour { back: d.back * (front / d.end), end: front, ..d });
    }
    let reached: f64 = found.iter().map(|(_, weight)| weight).sum();
    let detours = || found.iter().filter_map(|(d, weight)| d.map(|d| (d, weight / reached)));
    let sum: f64 = detours().map(|(d, weight)| weight * d.slope()).sum();
    let part = |of: fn(&Detour) -> f64| detours().map(|(d, weight)| weight * d.slope() * of(&d)).sum::<f64>() / sum;
    (sum > 0.0).then(|| Detour {
        shift: detours().map(|(d, weight)| weight * d.shift).sum(),
        out: part(|d| d.out),
        back: front * part(|d| d.back / d.end),
        end: front,
    })
}

/// The targets with shifts halfway between both.
fn mean_of(a: &[Seen], b: &[Seen]) -> Vec<Seen> {
    let between = |a: &Detour, b: &Detour| Detour { shift: a.shift.lerp(b.shift, 0.5), ..*b };
    let of = |(a, b): (&Seen, &Seen)| Seen {
        detour: a.detour.as_ref().zip(b.detour.as_ref()).map(|(a, b)| between(a, b)),
        ..b.clone()
    };
    a.iter().zip(b).map(of).collect()
}

pub fn no_room(index: usize, segments: usize) -> String {
    format!("target {index} is not tracked: with it, rays would have {segments} segments, and {LAYERS_MAX} is the most")
}

fn conflict(index: usize) -> String {
    format!(
        "target {index} is not tracked: its access path conflicts with those of the targets next to it in the picture"
    )
}

fn no_path(index: usize, largest: f64) -> String {
    format!(
        "target {index} is not tracked: every detour around its occluders is blocked, up to a shift of {largest:.3}; another radius or \
         another bend may help"
    )
}

/// How far before its centre a target without a radius may be hit, as a part of its distance: its own surface.
const OWN: f64 = 1.0 / (1u64 << 20) as f64;

/// Whether the line reaches the target's centre without a hit outside the target's ball.
fn reaches(view: &View, occluders: &Occluders, line: &[DVec3], target: &Target) -> bool {
    let end = view.depth(target.at);
    let mut line: Vec<DVec3> = line.iter().copied().take_while(|p| view.depth(*p) < end).collect();
    line.push(target.at);
    let own = target.radius + OWN * (target.at - view.eye()).length();
    occluders.first_on(&line).is_none_or(|hit| (hit - target.at).length() <= own)
}
