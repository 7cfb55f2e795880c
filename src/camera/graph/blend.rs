//! The rays of a view about several targets: one net over the image, and how the targets' shifts are blended on it.

use super::path::{CURVE_PARTS, Detour, SightLines};
use super::view::View;
use super::{Bend, Graph, Leg, Net};
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
    pub sight_lines: SightLines,
    /// Half-size of its core, in which all rays have its full shift, along x and y, px.
    pub core_px: f64,
    /// The detour of its rays; `None`: straight.
    pub detour: Option<Detour>,
}

/// The least width of the band over which rays return to the plain view, px.
const BAND_MIN_PX: f64 = 8.0;
/// The band's width, in parts of the largest shift in the picture: over 1.125, the steepest `share / depth` of a detour
/// against its end, rays do not cross.
const BAND: f64 = 1.5;
/// Lines of the net in each direction where targets share a part of the image.
const SHARED_LINES: usize = 24;
/// Lines of the net that are closer than this (px) are one; a target's core is as much smaller.
const LINE_GAP_PX: f64 = 1.0 / 64.0;
/// The camera's rays and the plain view's, over one net.
pub fn graphs(view: &View, seen: &[Seen], size: (u32, u32), far: f64) -> [Graph; 2] {
    let net = net(view, seen, size);
    let shares: Vec<Vec<f64>> = net.places_px.iter().map(|q| shares(view, seen, *q)).collect();
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
    [true, false].map(|shifted| Graph { net: net.clone(), legs: depths.windows(2).map(|p| leg(p, shifted)).collect() })
}

impl Seen {
    /// Distance from its place at which its shift ends, px.
    fn reach_px(&self, view: &View) -> f64 {
        let shift_px = self.detour.map_or(0.0, |w| w.slope() / view.steps()[0].length());
        self.core_px + (BAND * shift_px).max(BAND_MIN_PX)
    }

    /// Distance from its place as the larger of x and y.
    fn distance_px(&self, place_px: DVec2) -> f64 {
        (place_px - self.place_px).abs().max_element()
    }
}

/// The share of each target's shift at an image place: 1 in the target's core, falling to 0 over its band; where bands
/// overlap, weighted by the distance to each core.
fn shares(view: &View, seen: &[Seen], place_px: DVec2) -> Vec<f64> {
    let in_core = |s: &&(usize, f64)| s.1 <= seen[s.0].core_px + LINE_GAP_PX;
    let distances: Vec<(usize, f64)> = seen.iter().map(|s| s.distance_px(place_px)).enumerate().collect();
    let nearer = |a: &&(usize, f64), b: &&(usize, f64)| {
        a.1.total_cmp(&b.1).then(seen[a.0].sight_lines.front.total_cmp(&seen[b.0].sight_lines.front))
    };
    if let Some((own, _)) = distances.iter().filter(in_core).min_by(nearer) {
        return (0..seen.len()).map(|k| if k == *own { 1.0 } else { 0.0 }).collect();
    }
    let falls = |&(k, d): &(usize, f64)| {
        let (core, reach) = (seen[k].core_px, seen[k].reach_px(view));
        ((reach - d) / (reach - core)).clamp(0.0, 1.0)
    };
    let parts: Vec<f64> = distances.iter().map(falls).collect();
    let most = parts.iter().copied().fold(0.0, f64::max);
    let weights: Vec<f64> = parts.iter().map(|u| u / (1.0 - u)).collect();
    let sum: f64 = weights.iter().sum();
    if sum > 0.0 { weights.iter().map(|w| most * w / sum).collect() } else { weights }
}

/// Two triangles for every cell between the lines along the targets' cores and bands, and the image's borders.
fn net(view: &View, seen: &[Seen], size: (u32, u32)) -> Net {
    let lines = |axis: usize, size: u32| {
        let (first, last) = (-1.0, size as f64 + 1.0);
        let ends =
            |s: &Seen| [-s.reach_px(view), -s.core_px, s.core_px, s.reach_px(view)].map(|d| s.place_px[axis] + d);
        let mut lines: Vec<f64> = seen.iter().flat_map(ends).collect();
        if share_a_part(view, seen) {
            let lo = lines.iter().copied().fold(f64::INFINITY, f64::min).max(first);
            let hi = lines.iter().copied().fold(f64::NEG_INFINITY, f64::max).min(last);
            lines.extend((0..=SHARED_LINES).map(|k| lo + (hi - lo) * k as f64 / SHARED_LINES as f64));
            // a cell of each target's own about its place, however near another is
            lines.extend(seen.iter().flat_map(|s| [s.place_px[axis] - 0.5, s.place_px[axis] + 0.5]));
        }
        lines.retain(|x| *x > first + LINE_GAP_PX && *x < last - LINE_GAP_PX);
        lines.extend([first, last]);
        lines.sort_by(f64::total_cmp);
        lines.dedup_by(|b, a| *b - *a < LINE_GAP_PX);
        lines
    };
    let (xs, ys) = (lines(0, size.0), lines(1, size.1));
    let columns = xs.len() as u32;
    let places_px = ys.iter().flat_map(|y| xs.iter().map(|x| DVec2::new(*x, *y))).collect();
    let cell = |k: u32| [[k, k + 1, k + columns], [k + columns, k + 1, k + columns + 1]];
    let rows = 0..ys.len() as u32 - 1;
    Net { places_px, triangles: rows.flat_map(|j| (0..columns - 1).flat_map(move |i| cell(j * columns + i))).collect() }
}

/// The rays of two targets share a part of the image, and one of them is moved.
fn share_a_part(view: &View, seen: &[Seen]) -> bool {
    let meet = |a: &Seen, b: &Seen| a.distance_px(b.place_px) < a.reach_px(view) + b.reach_px(view);
    (0..seen.len())
        .any(|i| (0..i).any(|j| (seen[i].detour.is_some() || seen[j].detour.is_some()) && meet(&seen[i], &seen[j])))
}

impl Graph {
    /// The points that the ray at an image place runs through, curves as some straight parts.
    pub fn line(&self, place_px: DVec2, bend: Bend) -> Option<Vec<DVec3>> {
        let corners = |t: &[u32; 3]| t.map(|k| self.net.places_px[k as usize]);
        let weights = |t: &[u32; 3]| {
            let [a, b, c] = corners(t);
            let area = |a: DVec2, b: DVec2, c: DVec2| (b - a).perp_dot(c - a);
            let whole = area(a, b, c);
            [area(place_px, b, c) / whole, area(a, place_px, c) / whole, area(a, b, place_px) / whole]
        };
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
