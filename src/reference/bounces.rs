//! Rays that a mirror or a lens turns, followed one by one: recursive ray tracing, by the definitions of
//! [`crate::camera::optics`] alone.

use super::finding::{Finding, PLACES};
use super::margin::{MARGIN_PX, beyond, clears};
use super::path::{Path, Seen, Segment};
use super::{Hit, Reference, nearer};
use crate::camera::Camera;
use crate::camera::bundle::Bundle;
use crate::camera::optics::meeting::first_meeting;
use crate::camera::optics::turn::{Spin, after, at_facet};
use crate::camera::optics::{Branch, Optics, Surface};
use glam::DVec3;

/// What a pixel's path comes to.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// As the camera gives it; or its ray and then those that were turned, each but the last ending at t = 1.
    pub path: Path,
    pub seen: Option<Seen>,
    /// The first surface that was met: facet or smooth surface.
    pub first: Option<u32>,
    /// The share of the light that is left on this way, without the tint.
    pub light: f64,
}

/// Other ways that are followed from ties at most.
const WAYS_MAX: usize = 16;

impl Reference<'_> {
    /// What a path shows: what it first meets, or, with optics, what its ray comes to.
    pub fn shown(&self, camera: &Camera, path: Path) -> Outcome {
        match &camera.optics {
            Some(optics) => self.outcome(optics, path),
            None => Outcome { seen: self.first(&path), path, first: None, light: 1.0 },
        }
    }

    /// The way of `path`, of one straight ray, through optics whose facets are the last triangles of the mesh.
    pub fn outcome(&self, optics: &Optics, path: Path) -> Outcome {
        self.outcomes(optics, path).0
    }

    /// Everything that the light of a path is shared out to, tilts and branches; what it shows first of all.
    pub fn shares(&self, optics: &Optics, path: &Path) -> Vec<Outcome> {
        let tilts = optics.tilts();
        let mut all = Vec::new();
        for tilt in &tilts {
            let start = Outcome { path: path.clone(), seen: None, first: None, light: 1.0 / tilts.len() as f64 };
            let mut todo = vec![(start, None)];
            while let Some((way, last)) = todo.pop() {
                let layer = way.path.segments.len() - 1;
                let next = way.path.segments[layer].and_then(|(piece, segment)| match segment {
                    Segment::Straight(bundle) => Some((piece, bundle)),
                    Segment::Curved(_) => None,
                });
                let hits = next.map(|(_, bundle)| self.hits(optics, &bundle, &way, last));
                let first = hits.and_then(|hits| hits.into_iter().fold(None, nearer));
                let (Some((piece, bundle)), Some(hit)) = (next, first) else {
                    all.push(way);
                    continue;
                };
                let branches = optics.branches().iter().rev();
                let steps =
                    branches.map(|b| self.step(optics, &way, piece, &bundle, hit, Spin { branch: *b, tilt: *tilt }));
                for step in steps {
                    match step {
                        Way::Turned(way, last) => todo.push((way, Some(last))),
                        Way::Ended(way) => {
                            // it ends on all branches alike
                            all.push(way);
                            break;
                        }
                    }
                }
            }
        }
        all
    }

    /// The way of `path`, of one straight ray, through the optics, whose facets are the last triangles of the mesh; and the
    /// ways that tie with it.
    fn outcomes(&self, optics: &Optics, path: Path) -> (Outcome, Vec<Outcome>) {
        let mut todo = vec![(Outcome { path, seen: None, first: None, light: 1.0 }, None)];
        let mut done = Vec::new();
        while let Some((way, last)) = todo.pop() {
            let fork = self.go_on(optics, way, last);
            if done.len() + todo.len() < WAYS_MAX {
                // the first of all ways is the true one
                todo.extend(fork.others);
            }
            match fork.main {
                Way::Ended(outcome) => done.push(outcome),
                Way::Turned(way, last) => todo.push((way, Some(last))),
            }
        }
        let others = done.split_off(1);
        (done.remove(0), others)
    }

    /// One ray further: what it meets first, and what else may be first.
    fn go_on(&self, optics: &Optics, way: Outcome, last: Option<u32>) -> Fork {
        let layer = way.path.segments.len() - 1;
        let Some((piece, Segment::Straight(bundle))) = way.path.segments[layer] else {
            return Fork { main: Way::Ended(way), others: Vec::new() };
        };
        let hits = self.hits(optics, &bundle, &way, last);
        let Some(main) = hits.iter().copied().fold(None, nearer) else {
            return Fork { main: Way::Ended(way), others: Vec::new() };
        };
        let spin = Spin { branch: Branch::Main, tilt: optics.tilts()[0] };
        let step = |hit: &Hit| self.step(optics, &way, piece, &bundle, *hit, spin);
        let ties = hits.iter().filter(|h| h.triangle != main.triangle && !clears(main.t, h.t));
        let others = ties
            .map(|h| match step(h) {
                Way::Turned(way, last) => (way, Some(last)),
                // what ended has no ray left to follow
                Way::Ended(way) => (way.ended(), None),
            })
            .collect();
        Fork { main: step(&main), others }
    }

    /// Everything that the last ray of a way meets and that may be first.
    fn hits(&self, optics: &Optics, bundle: &Bundle, way: &Outcome, last: Option<u32>) -> Vec<Hit> {
        let turned = way.path.segments.len() > 1;
        let range = if turned { [0.0, f64::INFINITY] } else { way.path.range(0) };
        let (first, sees) = (optics.first_id(self.mesh), !turned || optics.sees_itself());
        let mut hits = Vec::new();
        let mut limit = f64::INFINITY;
        self.each_hit_of_ray(bundle, range, |hit| {
            if Some(hit.triangle) != last && (sees || hit.triangle < first) {
                limit = limit.min(beyond(hit.t));
                hits.push(hit);
            }
            limit
        });
        if let (Surface::Smooth(smooth), true) = (&optics.surface, sees) {
            let ray = bundle.ray(0.0, 0.0);
            for part in 0..smooth.count() {
                let triangle = first + part as u32;
                let t = first_meeting((smooth, part), &ray, last == Some(triangle), range);
                hits.extend(t.map(|t| Hit { t, triangle, bary: [0.0; 2] }));
            }
        }
        hits
    }

    /// What becomes of a way at a hit.
    fn step(&self, optics: &Optics, way: &Outcome, piece: u32, bundle: &Bundle, hit: Hit, spin: Spin) -> Way {
        let layer = way.path.segments.len() - 1;
        let mut way = way.clone();
        let surface = hit.triangle.checked_sub(optics.first_id(self.mesh));
        let Some(surface) = surface.filter(|_| layer < optics.depth as usize) else {
            way.seen = Some(Seen { layer, piece, hit: Hit { t: way.path.within_layer(layer, hit.t), ..hit } });
            return Way::Ended(way);
        };
        way.first = way.first.or(Some(surface));
        let ray = bundle.ray(0.0, 0.0);
        let (place, (direction, share)) = match &optics.surface {
            Surface::Facets { facets, law } => {
                at_facet((optics, spin), *law, &facets.facet(surface as usize), ray.direction, hit.bary)
            }
            Surface::Smooth(smooth) => {
                let place = ray.origin + hit.t * ray.direction;
                let normal = smooth.normal(surface as usize, place);
                (place, after((optics, spin), ray.direction, normal, normal))
            }
        };
        let straight = |p: DVec3, d: DVec3| {
            Segment::Straight(Bundle {
                p: [p, DVec3::ZERO, DVec3::ZERO],
                d: [d, DVec3::ZERO, DVec3::ZERO],
                h: [1.0, 0.0, 0.0],
            })
        };
        way.path.segments[layer] = Some((piece, straight(ray.origin, place - ray.origin)));
        let goes_on = direction.is_finite() && direction != DVec3::ZERO;
        way.light *= share;
        way.path.segments.push(goes_on.then(|| (piece, straight(optics.environment.unwrap_or(place), direction))));
        Way::Turned(way, hit.triangle)
    }

    /// Judges a pixel behind optics by samples of the box, as [`Reference::finding`] does curves: the way of each must
    /// have as many turns and the same end, without ties.
    pub(super) fn finding_of_bounces(&self, camera: &Camera, optics: &Optics, (i, j): (u32, u32)) -> Finding {
        let near = |(x, y): &(f64, f64)| Path::near(camera, i, j, (x * MARGIN_PX, y * MARGIN_PX));
        let mut all = PLACES.iter().map(near).map(|path| self.outcomes(optics, path));
        let Some((centre, ties)) = all.next() else {
            return Finding { seen: None, safe: true, candidates: Vec::new(), may_miss: true };
        };
        let what = |o: &Outcome| (o.path.segments.len(), o.seen.map(|s| s.hit.triangle));
        let mut finding = Finding { seen: centre.seen, safe: true, candidates: Vec::new(), may_miss: false };
        let mut add = |o: &Outcome| {
            finding.safe &= what(o) == what(&centre);
            match o.seen {
                Some(seen) => finding.candidates.push(seen.hit.triangle),
                None => finding.may_miss = true,
            }
        };
        add(&centre);
        ties.iter().for_each(&mut add);
        for (outcome, ties) in all {
            add(&outcome);
            ties.iter().for_each(&mut add);
        }
        finding.candidates.sort_unstable();
        finding.candidates.dedup();
        finding
    }
}

/// A way one ray further.
enum Way {
    Ended(Outcome),
    /// With the surface that turned it.
    Turned(Outcome, u32),
}

/// The true way and those that tie with it.
struct Fork {
    main: Way,
    others: Vec<(Outcome, Option<u32>)>,
}

impl Outcome {
    /// An outcome without a ray to follow.
    fn ended(mut self) -> Outcome {
        self.path.segments.push(None);
        self
    }
}
