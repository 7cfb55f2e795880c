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
    /// The camera's path. After a bounce: its segments up to the optics and the bounced rays, each but the last ending at t = 1.
    pub path: Path,
    pub seen: Option<Seen>,
    pub bounces: u32,
    /// A curve touches a surface there: t is uncertain.
    touches: bool,
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
            None => Outcome::of_eye(self.first(&path), path),
        }
    }

    /// The same where a path's finding is known: a chain's verdict knows what is seen better than a second look.
    pub fn shown_by(&self, camera: &Camera, finding: &Finding, path: Path) -> Outcome {
        match camera.optics {
            Some(_) => self.shown(camera, path),
            None => Outcome::of_eye(finding.seen, path),
        }
    }

    /// Follows `path` through optics whose facets are the last triangles of the mesh. A curve goes on as its tangent (Brosz et al. 2007,
    /// section 6.1).
    pub fn outcome(&self, optics: &Optics, path: Path) -> Outcome {
        self.outcomes(optics, path).0
    }

    /// All paths that `path` is split into, by tilts and branches, each with its share of the light. The first is the main one.
    pub fn shares(&self, optics: &Optics, path: &Path) -> Vec<Outcome> {
        let tilts = optics.tilts();
        let mut all = Vec::new();
        for tilt in &tilts {
            let start = Outcome { light: 1.0 / tilts.len() as f64, ..Outcome::of_eye(None, path.clone()) };
            let mut todo = vec![(start, None)];
            while let Some((outcome, last)) = todo.pop() {
                let meetings = self.meetings(optics, &outcome, last);
                let Some(first) = meetings.into_iter().reduce(sooner) else {
                    all.push(outcome);
                    continue;
                };
                let branches = optics.branches().iter().rev();
                let steps = branches.map(|b| self.step(optics, &outcome, first, Split { branch: *b, tilt: *tilt }));
                for step in steps {
                    if step.1.is_none() {
                        // all branches end at the same hit
                        all.push(step.0);
                        break;
                    }
                    todo.push(step);
                }
            }
        }
        all
    }

    /// Follows `path` through the optics, whose facets are the last triangles of the mesh. Also returns the outcomes of the paths
    /// that tie with it.
    fn outcomes(&self, optics: &Optics, path: Path) -> (Outcome, Vec<Outcome>) {
        let split = Split { branch: Branch::Main, tilt: optics.tilts()[0] };
        let mut todo = vec![(Outcome::of_eye(None, path), None)];
        let mut done = Vec::new();
        while let Some((outcome, last)) = todo.pop() {
            let meetings = if outcome.seen.is_some() { Vec::new() } else { self.meetings(optics, &outcome, last) };
            let Some(main) = meetings.iter().copied().reduce(sooner) else {
                done.push(outcome);
                continue;
            };
            let step = |meeting: &Meeting| self.step(optics, &outcome, *meeting, split);
            if done.len() + todo.len() < PATHS_MAX {
                let is_tie = |m: &&Meeting| m.hit.triangle != main.hit.triangle && !clears(main.t(), m.t());
                todo.extend(meetings.iter().filter(is_tie).map(step));
            }
            // the last of the list comes first: the first path is the true one
            match step(&main) {
                (outcome, None) => done.push(outcome),
                bounced => todo.push(bounced),
            }
        }
        let others = done.split_off(1);
        (done.remove(0), others)
    }

    /// All hits that may be the first: of the eye's segments, or of the last bounced ray.
    fn meetings(&self, optics: &Optics, outcome: &Outcome, last: Option<u32>) -> Vec<Meeting> {
        let bounced = outcome.bounces > 0;
        // rays that have bounced are not perturbed, and have no tolerance at the ends of their range
        let scene_size = if bounced { 0.0 } else { self.scene_size };
        let reference = Reference { scene_size, ..self.clone() };
        let segments = &outcome.path.segments;
        let from = if bounced { segments.len() - 1 } else { 0 };
        let (first, sees) = (optics.first_id(self.triangle_count()), !bounced || optics.sees_itself());
        let mut meetings: Vec<Meeting> = Vec::new();
        // of t through all layers
        let mut limit = f64::INFINITY;
        for (layer, of_layer) in segments.iter().enumerate().skip(from) {
            let Some((piece, segment)) = of_layer else { continue };
            let base = if bounced { 0.0 } else { layer as f64 };
            let [t0, t1] = if bounced { [0.0, f64::INFINITY] } else { outcome.path.range(layer) };
            let range = [t0, t1.min(limit - base)];
            if range[0] > range[1] {
                break;
            }
            let mut take = |hit: Hit| {
                if Some(hit.triangle) != last && (sees || hit.triangle < first) {
                    limit = limit.min(beyond(base + hit.t));
                    meetings.push(Meeting { layer, piece: *piece, base, hit });
                }
                limit - base
            };
            match segment {
                Segment::Straight(bundle) => reference.each_hit_of_ray(bundle, range, take),
                Segment::Curved(curve) => self.each_hit_of_curves(&[*curve], &[range], |_, hit| take(hit)),
            }
            let (Segment::Straight(bundle), Surface::Smooth(smooth), true) = (segment, &optics.surface, sees) else {
                continue;
            };
            let ray = bundle.ray(0.0, 0.0);
            for part in 0..smooth.count() {
                let triangle = first + part as u32;
                if let Some(t) = first_meeting((smooth, part), &ray, last == Some(triangle), [t0, t1]) {
                    limit = limit.min(beyond(base + t));
                    meetings.push(Meeting { layer, piece: *piece, base, hit: Hit { t, triangle, bary: [0.0; 2] } });
                }
            }
        }
        meetings
    }

    /// The path after a hit: bounced, with the id of the surface, or ended.
    fn step(&self, optics: &Optics, outcome: &Outcome, meeting: Meeting, split: Split) -> (Outcome, Option<u32>) {
        let Meeting { layer, piece, hit, .. } = meeting;
        let mut outcome = outcome.clone();
        let Some((_, segment)) = outcome.path.segments[layer] else { return (outcome, None) };
        outcome.touches |= self.touches(&segment, &hit);
        let surface = hit.triangle.checked_sub(optics.first_id(self.triangle_count()));
        let Some(surface) = surface.filter(|_| outcome.bounces < optics.depth) else {
            let t = if outcome.bounces > 0 { hit.t } else { outcome.path.within(hit.t) };
            outcome.seen = Some(Seen { layer, piece, hit: Hit { t, ..hit } });
            return (outcome, None);
        };
        outcome.first = outcome.first.or(Some(surface));
        let arriving = segment.direction(hit.t);
        let (place, (direction, share)) = match &optics.surface {
            Surface::Facets { facets, law } => {
                at_facet((optics, split), *law, &facets.facet(surface as usize), arriving, hit.bary)
            }
            Surface::Smooth(smooth) => {
                let place = segment.point(hit.t);
                let normal = smooth.normal(surface as usize, place);
                (place, after((optics, split), arriving, normal, normal))
            }
        };
        let straight = |p: DVec3, d: DVec3| {
            Segment::Straight(Bundle {
                p: [p, DVec3::ZERO, DVec3::ZERO],
                d: [d, DVec3::ZERO, DVec3::ZERO],
                h: [1.0, 0.0, 0.0],
            })
        };
        let to_place = match segment {
            Segment::Straight(bundle) => {
                let origin = bundle.ray(0.0, 0.0).origin;
                straight(origin, place - origin)
            }
            Segment::Curved(curve) => Segment::Curved(curve.span([0.0, hit.t])),
        };
        outcome.path.segments.truncate(layer);
        outcome.path.segments.push(Some((piece, to_place)));
        let goes_on = direction.is_finite() && direction != DVec3::ZERO;
        outcome.light *= share;
        outcome.bounces += 1;
        outcome.path.segments.push(goes_on.then(|| (piece, straight(optics.environment.unwrap_or(place), direction))));
        (outcome, Some(hit.triangle))
    }

    /// Judges a pixel behind optics by samples of the box, as [`Reference::finding`] does curves: all must have
    /// the same number of bounces and the same end, without ties.
    pub(super) fn finding_of_bounces(&self, camera: &Camera, optics: &Optics, (i, j): (u32, u32)) -> Finding {
        let at_offset = |(x, y): &(f64, f64)| Path::at_offset(camera, i, j, (x * MARGIN_PX, y * MARGIN_PX));
        let mut all = PLACES.iter().map(at_offset).map(|path| self.outcomes(optics, path));
        let Some((centre, ties)) = all.next() else {
            return Finding { seen: None, safe: true, candidates: Vec::new(), may_miss: true };
        };
        let what = |o: &Outcome| (o.bounces, o.seen.map(|s| (s.layer, s.hit.triangle)));
        let mut finding = Finding { seen: centre.seen, safe: true, candidates: Vec::new(), may_miss: false };
        let mut add = |o: &Outcome| {
            finding.safe &= what(o) == what(&centre) && !o.touches;
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

/// A hit on a path.
#[derive(Debug, Clone, Copy)]
struct Meeting {
    /// The index of the segment in the path.
    layer: usize,
    piece: u32,
    /// The t of the whole path where that of the segment is 0; 0 after a bounce.
    base: f64,
    /// t is the segment's own.
    hit: Hit,
}

impl Meeting {
    /// Through all layers of the eye.
    fn t(&self) -> f64 {
        self.base + self.hit.t
    }
}

/// The one in the lower layer; there the nearer one.
fn sooner(a: Meeting, b: Meeting) -> Meeting {
    if a.layer != b.layer {
        return if a.layer < b.layer { a } else { b };
    }
    nearer(Some(a.hit), b.hit).map_or(a, |hit| Meeting { hit, ..a })
}

impl Outcome {
    /// What the eye's own path shows.
    pub fn of_eye(seen: Option<Seen>, path: Path) -> Outcome {
        Outcome { path, seen, bounces: 0, touches: false, first: None, light: 1.0 }
    }
}
