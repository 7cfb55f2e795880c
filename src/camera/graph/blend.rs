//! The rays of a view about several targets: one net over the image, and how the targets' shifts are blended on it.

use super::outline;
use super::path::{CURVE_PARTS, Detour, SightLines};
use super::view::View;
use super::{Bend, Graph, Leg, Net};
use crate::arrays::MapEach;
use glam::{DVec2, DVec3};

/// A ball to track.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Target {
    pub at: DVec3,
    pub radius: f64,
}

/// A target in the picture.
#[derive(Debug, Clone)]
pub struct Seen {
    /// Index in the list of targets.
    pub index: usize,
    pub target: Target,
    pub place_px: DVec2,
    /// In the picture; others are beside it, and only their bands may be in it.
    pub is_inside: bool,
    pub sight_lines: SightLines,
    /// Half-size of its core, in which all rays have its full shift, along x and y, px.
    pub core_px: f64,
    /// The part of its shift that its rays have, and of the room that it takes from others; under 1 where it is about to be left out.
    pub presence: f64,
    /// The detour of its rays; `None`: straight.
    pub detour: Option<Detour>,
}

/// Pixels beyond a target's outline that share its detour: those that an image filter may read.
pub const MARGIN_PX: f64 = 2.0;
/// The least width of the band over which rays return to the plain view, px.
const BAND_MIN_PX: f64 = 8.0;
/// The band's width, in parts of the largest shift in the picture: over 1.125, the steepest `share / depth` of a detour
/// against its end, rays do not cross.
const BAND: f64 = 1.5;
/// Lines of the net over each band, as shares of its width: where the bands of several targets may meet.
const BAND_LINES: [f64; 2] = [1.0 / 3.0, 2.0 / 3.0];
/// Around the core of the nearer of two targets, in parts of the core: where the rays pass from its detour to that of
/// the other, if the place is in the other's core.
pub const GUARD: f64 = 0.7;
/// Lines of the net that are closer than this (px) are one; a target's core is as much smaller.
const LINE_GAP_PX: f64 = 1.0 / 64.0;

/// The camera's rays and the plain view's, over one net; with `segments`, of at most so many pairs of triangles.
pub fn graphs(view: &View, seen: &[Seen], size: (u32, u32), far: f64, segments: Option<usize>) -> [Graph; 2] {
    let (net, shares) = match segments {
        None => net(view, seen, size),
        Some(n) => super::coarse::net(view, seen, size, n),
    };
    let detours: Vec<(usize, Detour)> = seen.iter().enumerate().filter_map(|(k, s)| s.detour.map(|w| (k, w))).collect();
    let mut depths: Vec<f64> = detours.iter().flat_map(|(_, w)| [w.out, w.back, w.end]).chain([0.0, far]).collect();
    depths.sort_by(f64::total_cmp);
    depths.dedup();
    let leg = |pair: &[f64], shifted: bool| {
        let (from, to) = (pair[0], pair[1]);
        let of_detours: Vec<[f64; 4]> = detours.iter().map(|(_, w)| w.shares(from, to)).collect();
        let points = |i: usize| {
            let depth = from + (to - from) * i as f64 / 3.0;
            let shift = |v: usize| {
                let parts = detours.iter().zip(&of_detours).map(|((k, w), s)| shares[v][*k] * s[i] * w.shift);
                if shifted { parts.sum() } else { DVec3::ZERO }
            };
            (0..shares.len()).map(|v| view.point(net.places_px[v], depth) + shift(v)).collect::<Vec<_>>()
        };
        if detours.iter().any(|(_, w)| w.is_sloped(to)) {
            Leg::Connecting([points(0), points(1), points(2), points(3)])
        } else {
            Leg::Straight([points(0), points(3)])
        }
    };
    [true, false]
        .map_each(|shifted| Graph { net: net.clone(), legs: depths.windows(2).map(|p| leg(p, shifted)).collect() })
}

impl Seen {
    /// Distance from its place at which its shift ends, px.
    pub fn reach_px(&self, view: &View) -> f64 {
        let shift_px = self.detour.map_or(0.0, |w| w.slope() / view.steps()[0].length());
        self.core_px + (BAND * shift_px).max(BAND_MIN_PX)
    }

    /// Distance from its place as the larger of x and y.
    pub fn distance_px(&self, place_px: DVec2) -> f64 {
        (place_px - self.place_px).abs().max_element()
    }
}

/// The share of each target's shift at an image place: 1 in the target's core, falling to 0 over its band. Where bands
/// overlap, each share is weighted by its distance to the cores of the others; where cores overlap, that of the nearer
/// target counts. Continuous in the place and in the targets' places and depths.
pub fn shares(view: &View, seen: &[Seen], place_px: DVec2) -> Vec<f64> {
    let of = |s: &Seen| {
        let (d, core, reach) = (s.distance_px(place_px), s.core_px, s.reach_px(view));
        let past = if d <= core + LINE_GAP_PX { 0.0 } else { d - core };
        let fall = |width: f64| s.presence * (1.0 - past / width).clamp(0.0, 1.0);
        [fall(reach - core), fall(GUARD * core)]
    };
    let falls: Vec<[f64; 2]> = seen.iter().map(of).collect();
    // what the other leaves of a place: in its own core all, but for the core of a nearer target and what is next to that
    let left = |k: usize, j: usize| {
        let own = falls[k][1] * (1.0 - falls[j][1] * before(view, &seen[j], &seen[k]));
        1.0 - falls[j][0] * (1.0 - own)
    };
    let weight = |k: usize| falls[k][0] * (0..seen.len()).filter(|j| *j != k).map(|j| left(k, j)).product::<f64>();
    let weights: Vec<f64> = (0..seen.len()).map(weight).collect();
    let most = falls.iter().map(|f| f[0]).fold(0.0, f64::max);
    let sum: f64 = weights.iter().sum();
    if sum > 0.0 { weights.iter().map(|w| most * w / sum).collect() } else { weights }
}

/// How much nearer to the eye one target is than another: 0 to 1, and 1/2 at the same depth. It changes over as much
/// depth as both cores are wide.
pub fn before(view: &View, a: &Seen, b: &Seen) -> f64 {
    let (front, other) = (a.sight_lines.front, b.sight_lines.front);
    let width = 2.0 * (a.core_px + b.core_px) * view.steps()[0].length() * front.min(other);
    (0.5 + (other - front) / width).clamp(0.0, 1.0)
}

/// Four triangles for every cell between the lines along the targets' cores and bands, and the image's borders; and the
/// shares at its vertices. No line begins or ends while targets move, so that the net moves as smoothly as they.
fn net(view: &View, seen: &[Seen], size: (u32, u32)) -> (Net, Vec<Vec<f64>>) {
    let lines = |axis: usize, size: u32| {
        let (first, last) = (-1.0, size as f64 + 1.0);
        let of = |s: &Seen| {
            let (core, reach) = (s.core_px, s.reach_px(view));
            let between = BAND_LINES.map_each(|part| core + part * (reach - core));
            // one target's share is linear between these alone
            let more = if seen.len() > 1 { vec![between[0], between[1], (1.0 + GUARD) * core] } else { Vec::new() };
            let at = s.place_px[axis];
            [core, reach].into_iter().chain(more).flat_map(move |d| [at - d, at + d])
        };
        let mut lines: Vec<f64> = seen.iter().flat_map(of).collect();
        lines.retain(|x| *x > first + LINE_GAP_PX && *x < last - LINE_GAP_PX);
        lines.extend([first, last]);
        lines.sort_by(f64::total_cmp);
        lines.dedup_by(|b, a| *b - *a < LINE_GAP_PX);
        lines
    };
    let (xs, ys) = (lines(0, size.0), lines(1, size.1));
    let (columns, rows) = (xs.len() as u32, ys.len() as u32);
    let crossings = ys.iter().flat_map(|y| xs.iter().map(|x| DVec2::new(*x, *y)));
    let middles = ys.windows(2).flat_map(|y| {
        let middle = move |x: &[f64]| DVec2::new(x[0] + x[1], y[0] + y[1]) / 2.0;
        xs.windows(2).map(middle)
    });
    let places_px: Vec<DVec2> = crossings.chain(middles).collect();
    let cell = |i: u32, j: u32| {
        let k = j * columns + i;
        let middle = columns * rows + j * (columns - 1) + i;
        let corners = [k, k + 1, k + columns + 1, k + columns];
        (0..4).map(move |c| [corners[c], corners[(c + 1) % 4], middle])
    };
    let triangles = (0..rows - 1).flat_map(|j| (0..columns - 1).flat_map(move |i| cell(i, j))).collect();
    let shares = places_px.iter().map(|q| shares(view, seen, *q)).collect();
    (Net { places_px, triangles }, shares)
}

impl Graph {
    /// The points that the ray at an image place runs through, curves as some straight parts.
    pub fn line(&self, place_px: DVec2, bend: Bend) -> Option<Vec<DVec3>> {
        let weights = |t: &[u32; 3]| outline::weights(t.map_each(|k| self.net.places_px[k as usize]), place_px);
        let least = |t: &[u32; 3]| weights(t).into_iter().fold(f64::INFINITY, f64::min);
        let triangle = self.net.triangles.iter().max_by(|a, b| least(a).total_cmp(&least(b)))?;
        let w = weights(triangle);
        let at = |points: &[DVec3]| (0..3).map(|k| w[k] * points[triangle[k] as usize]).sum::<DVec3>();
        let parts = if bend == Bend::Curved { Bend::Straight(CURVE_PARTS) } else { bend };
        let legs: Vec<Leg> = self.legs.iter().flat_map(|leg| leg.bent(parts)).collect();
        let starts = legs.iter().map(|leg| at(&leg.points()[0]));
        let end = legs.last().and_then(|leg| leg.points().last()).map(|points| at(points));
        Some(starts.chain(end).collect())
    }
}
