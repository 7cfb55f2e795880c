//! Rays through a mirror or lens: recursive ray tracing by the definitions of [`crate::camera::optics`].

use super::finding::{Finding, PLACES};
use super::margin::{MARGIN_PX, beyond, clears};
use super::path::{Path, Seen, Segment};
use super::{Hit, Reference, nearer};
use crate::camera::Camera;
use crate::camera::bundle::Bundle;
use crate::camera::optics::bounce::{Split, after, at_facet};
use crate::camera::optics::meeting::first_meeting;
use crate::camera::optics::{Branch, Optics, Surface};
use glam::DVec3;

/// Where a pixel's path ends, and what it shows.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// The camera's path. With optics: the camera's ray and the bounced ones, each but the last ending at t = 1.
    pub path: Path,
    pub seen: Option<Seen>,
    /// The first surface hit: facet or smooth part.
    pub first: Option<u32>,
    /// The share of the light that the path carries, without the tint.
    pub light: f64,
}

/// Most paths followed because of ties.
const PATHS_MAX: usize = 16;

impl Reference<'_> {
    /// What a path shows: its first hit or, with optics, the end of its bounced ray.
    pub fn shown(&self, camera: &Camera, path: Path) -> Outcome {
        match &camera.optics {
            Some(optics) => self.outcome(optics, path),
            None => Outcome { seen: self.first(&path), path, first: None, light: 1.0 },
        }
    }

    /// Follows `path`, one straight ray, through optics whose facets are the last triangles of the mesh.
    pub fn outcome(&self, optics: &Optics, path: Path) -> Outcome {
        self.outcomes(optics, path).0
    }

    /// All paths that `path` is split into, by tilts and branches, each with its share of the light. The first is the main one.
    pub fn shares(&self, optics: &Optics, path: &Path) -> Vec<Outcome> {
        let tilts = optics.tilts();
        let mut all = Vec::new();
        for tilt in &tilts {
            let start = Outcome { path: path.clone(), seen: None, first: None, light: 1.0 / tilts.len() as f64 };
            let mut todo = vec![(start, None)];
            while let Some((outcome, last)) = todo.pop() {
                let layer = outcome.path.segments.len() - 1;
                let next = outcome.path.segments[layer].and_then(|(piece, segment)| match segment {
                    Segment::Straight(bundle) => Some((piece, bundle)),
                    Segment::Curved(_) => None,
                });
                let hits = next.map(|(_, bundle)| self.hits(optics, &bundle, &outcome, last));
                let first = hits.and_then(|hits| hits.into_iter().fold(None, nearer));
                let (Some((piece, bundle)), Some(hit)) = (next, first) else {
                    all.push(outcome);
                    continue;
                };
                let branches = optics.branches().iter().rev();
                let steps = branches
                    .map(|b| self.step(optics, &outcome, piece, &bundle, hit, Split { branch: *b, tilt: *tilt }));
                for step in steps {
                    match step {
                        Step::Bounced(outcome, last) => todo.push((outcome, Some(last))),
                        Step::Ended(outcome) => {
                            // all branches end at the same hit
                            all.push(outcome);
                            break;
                        }
                    }
                }
            }
        }
        all
    }

    /// Follows `path`, one straight ray, through the optics, whose facets are the last triangles of the mesh. Also returns the
    /// outcomes of the paths that tie with it.
    fn outcomes(&self, optics: &Optics, path: Path) -> (Outcome, Vec<Outcome>) {
        let mut todo = vec![(Outcome { path, seen: None, first: None, light: 1.0 }, None)];
        let mut done = Vec::new();
        while let Some((outcome, last)) = todo.pop() {
            let fork = self.go_on(optics, outcome, last);
            if done.len() + todo.len() < PATHS_MAX {
                // the first path is the true one
                todo.extend(fork.others);
            }
            match fork.main {
                Step::Ended(outcome) => done.push(outcome),
                Step::Bounced(outcome, last) => todo.push((outcome, Some(last))),
            }
        }
        let others = done.split_off(1);
        (done.remove(0), others)
    }

    /// Follows one more ray of a path: its first hit, and the hits that tie with it.
    fn go_on(&self, optics: &Optics, outcome: Outcome, last: Option<u32>) -> Fork {
        let layer = outcome.path.segments.len() - 1;
        let Some((piece, Segment::Straight(bundle))) = outcome.path.segments[layer] else {
            return Fork { main: Step::Ended(outcome), others: Vec::new() };
        };
        let hits = self.hits(optics, &bundle, &outcome, last);
        let Some(main) = hits.iter().copied().fold(None, nearer) else {
            return Fork { main: Step::Ended(outcome), others: Vec::new() };
        };
        let split = Split { branch: Branch::Main, tilt: optics.tilts()[0] };
        let step = |hit: &Hit| self.step(optics, &outcome, piece, &bundle, *hit, split);
        let ties = hits.iter().filter(|h| h.triangle != main.triangle && !clears(main.t, h.t));
        let others = ties
            .map(|h| match step(h) {
                Step::Bounced(outcome, last) => (outcome, Some(last)),
                // an ended path has no ray left to follow
                Step::Ended(outcome) => (outcome.ended(), None),
            })
            .collect();
        Fork { main: step(&main), others }
    }

    /// All hits of a path's last ray that may be the first.
    fn hits(&self, optics: &Optics, bundle: &Bundle, outcome: &Outcome, last: Option<u32>) -> Vec<Hit> {
        let bounced = outcome.path.segments.len() > 1;
        let range = if bounced { [0.0, f64::INFINITY] } else { outcome.path.range(0) };
        let (first, sees) = (optics.first_id(self.mesh), !bounced || optics.sees_itself());
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

    /// The path after a hit: bounced or ended.
    fn step(&self, optics: &Optics, outcome: &Outcome, piece: u32, bundle: &Bundle, hit: Hit, split: Split) -> Step {
        let layer = outcome.path.segments.len() - 1;
        let mut outcome = outcome.clone();
        let surface = hit.triangle.checked_sub(optics.first_id(self.mesh));
        let Some(surface) = surface.filter(|_| layer < optics.depth as usize) else {
            outcome.seen = Some(Seen { layer, piece, hit: Hit { t: outcome.path.within_layer(layer, hit.t), ..hit } });
            return Step::Ended(outcome);
        };
        outcome.first = outcome.first.or(Some(surface));
        let ray = bundle.ray(0.0, 0.0);
        let (place, (direction, share)) = match &optics.surface {
            Surface::Facets { facets, law } => {
                at_facet((optics, split), *law, &facets.facet(surface as usize), ray.direction, hit.bary)
            }
            Surface::Smooth(smooth) => {
                let place = ray.origin + hit.t * ray.direction;
                let normal = smooth.normal(surface as usize, place);
                (place, after((optics, split), ray.direction, normal, normal))
            }
        };
        let straight = |p: DVec3, d: DVec3| {
            Segment::Straight(Bundle {
                p: [p, DVec3::ZERO, DVec3::ZERO],
                d: [d, DVec3::ZERO, DVec3::ZERO],
                h: [1.0, 0.0, 0.0],
            })
        };
        outcome.path.segments[layer] = Some((piece, straight(ray.origin, place - ray.origin)));
        let goes_on = direction.is_finite() && direction != DVec3::ZERO;
        outcome.light *= share;
        outcome.path.segments.push(goes_on.then(|| (piece, straight(optics.environment.unwrap_or(place), direction))));
        Step::Bounced(outcome, hit.triangle)
    }

    /// Judges a pixel behind optics by samples of the box, as [`Reference::finding`] does curves: all must have
    /// the same number of bounces and the same end, without ties.
    pub(super) fn finding_of_bounces(&self, camera: &Camera, optics: &Optics, (i, j): (u32, u32)) -> Finding {
        let at_offset = |(x, y): &(f64, f64)| Path::at_offset(camera, i, j, (x * MARGIN_PX, y * MARGIN_PX));
        let mut all = PLACES.iter().map(at_offset).map(|path| self.outcomes(optics, path));
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

/// A path after one more hit.
enum Step {
    Ended(Outcome),
    /// With the id of the surface.
    Bounced(Outcome, u32),
}

/// The true path and those that tie with it.
struct Fork {
    main: Step,
    others: Vec<(Outcome, Option<u32>)>,
}

impl Outcome {
    /// The same path with an empty last segment.
    fn ended(mut self) -> Outcome {
        self.path.segments.push(None);
        self
    }
}
