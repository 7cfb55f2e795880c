//! Image regions that overlap: the common subdivision of their triangles, and what each region adds on it.

use super::outline::{self, Outline};
use crate::arrays::MapEach;
use crate::camera::boxes::around;
use glam::DVec2;
use std::collections::HashMap;

/// Places closer than this (px) to a line are on it.
const ON_LINE_PX: f64 = 1.0 / (1u64 << 20) as f64;
/// Places closer than this (px) are one: crossings of the same two lines, computed from different ends.
const SAME_PX: f64 = 1.0 / (1u64 << 16) as f64;
/// Shares this close to 0 or 1 are 0 or 1: [`ON_LINE_PX`] over a band that is 1/64 px wide.
const SHARE_ROUNDING: f64 = 1.0 / (1u64 << 14) as f64;

/// The triangles of a region, its band and a rectangle around both. What the region adds to the root is given at the corners
/// of its outline, is 0 at the other vertices, and linear over the triangles.
pub struct Profile {
    places_px: Vec<DVec2>,
    /// Of the vertices in `places_px`, the first corner of the region's outline.
    first_corner: usize,
    triangles: Vec<[usize; 3]>,
}

/// Weights of corners of a region's outline, by their places (px). They sum to the region's share: 1 inside the region, 0
/// outside its band.
pub type Mix = Vec<(DVec2, f64)>;

/// Triangles over a rectangle, and the mix of each region at each vertex.
pub struct Overlay {
    pub places_px: Vec<DVec2>,
    pub mixes: Vec<Vec<Mix>>,
    pub triangles: Vec<[u32; 3]>,
}

/// A region's share where it has this mix.
pub fn share(mix: &Mix) -> f64 {
    match mix.iter().map(|(_, weight)| weight).sum::<f64>() {
        s if s < SHARE_ROUNDING => 0.0,
        s if s > 1.0 - SHARE_ROUNDING => 1.0,
        s => s,
    }
}

/// The triangles of a band between two outlines with `n` corners each, which start at the vertices `inner` and `outer`.
pub fn band(n: u32, inner: u32, outer: u32) -> Vec<[u32; 3]> {
    let side = |s: u32| {
        let next = (s + 1) % n;
        let ([a, b], [c, d]) = ([inner + s, inner + next], [outer + s, outer + next]);
        [[a, b, c], [b, d, c]]
    };
    (0..n).flat_map(side).collect()
}

impl Profile {
    /// Of a region with a band, over a rectangle around both.
    pub fn new(inner: &Outline, outer: &Outline, rectangle: &Outline) -> Profile {
        let (n, first) = (inner.len() as u32, rectangle.len() as u32);
        let around = outline::triangulate(rectangle, std::slice::from_ref(outer));
        let within = outline::triangulate(inner, &[]);
        let within = within.into_iter().map(|t| t.map_each(|k| first + n + k));
        let places_px: Vec<DVec2> = rectangle.iter().chain(outer).chain(inner).copied().collect();
        let triangles = around.into_iter().chain(within).chain(band(n, first + n, first));
        let positive = |t: [u32; 3]| {
            let t = t.map_each(|k| k as usize);
            if outline::area2(&t.map_each(|k| places_px[k])) < 0.0 { [t[0], t[2], t[1]] } else { t }
        };
        let triangles = triangles.map(positive).collect();
        Profile { first_corner: (first + n) as usize, triangles, places_px }
    }

    /// The mix at a place of a triangle.
    fn mix(&self, triangle: usize, q: DVec2) -> Mix {
        let t = self.triangles[triangle];
        let weights = outline::weights(t.map_each(|k| self.places_px[k]), q);
        let mix = (0..3).filter(|k| t[*k] >= self.first_corner).map(|k| (self.places_px[t[k]], weights[k])).collect();
        if share(&mix) > 0.0 { mix } else { Mix::new() }
    }
}

/// A convex part of the rectangle that lies in one triangle of every profile.
struct Cell {
    corners: Vec<DVec2>,
    triangles: Vec<usize>,
}

/// The common subdivision of profiles over one rectangle.
pub fn overlay(rectangle: &Outline, profiles: &[Profile]) -> Overlay {
    let mut cells = vec![Cell { corners: rectangle.clone(), triangles: Vec::new() }];
    for profile in profiles {
        cells = cells.iter().flat_map(|cell| cut(cell, profile)).collect();
    }
    let mut vertices = Vertices::default();
    for cell in &cells {
        for q in &cell.corners {
            vertices.add(*q, || profiles.iter().zip(&cell.triangles).map(|(p, t)| p.mix(*t, *q)).collect());
        }
    }
    let mut by_x: Vec<usize> = (0..vertices.places_px.len()).collect();
    by_x.sort_by(|a, b| vertices.places_px[*a].x.total_cmp(&vertices.places_px[*b].x));
    let mut triangles = Vec::new();
    for cell in &cells {
        let ring: Vec<usize> = cell.corners.iter().filter_map(|q| vertices.find(*q)).collect();
        let ring = with_vertices_between(&ring, &vertices.places_px, &by_x);
        vertices.fan(&ring, &mut triangles);
    }
    Overlay { places_px: vertices.places_px, mixes: vertices.mixes, triangles }
}

/// The parts of a cell in the triangles of one more profile.
fn cut(cell: &Cell, profile: &Profile) -> Vec<Cell> {
    let (lo, hi) = around(&cell.corners);
    let part = |k: usize| {
        let t = profile.triangles[k].map_each(|v| profile.places_px[v]);
        let (from, to) = around(&t);
        if from.cmpge(hi).any() || to.cmple(lo).any() {
            return None;
        }
        let sides = [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])];
        let corners = sides.into_iter().fold(cell.corners.clone(), |corners, side| clipped(&corners, side));
        let triangles = cell.triangles.iter().copied().chain([k]).collect();
        (corners.len() > 2).then_some(Cell { corners, triangles })
    };
    (0..profile.triangles.len()).filter_map(part).collect()
}

/// The part of a convex polygon on the left of a line (Sutherland and Hodgman); empty if all of it is within
/// [`ON_LINE_PX`] of the line.
fn clipped(corners: &[DVec2], (a, b): (DVec2, DVec2)) -> Vec<DVec2> {
    let along = (b - a).normalize();
    let distance = |q: DVec2| {
        let d = along.perp_dot(q - a);
        if d.abs() < ON_LINE_PX { 0.0 } else { d }
    };
    if corners.iter().all(|q| distance(*q) <= 0.0) {
        return Vec::new();
    }
    let n = corners.len();
    let mut left = Vec::new();
    for k in 0..n {
        let (p, q) = (corners[k], corners[(k + 1) % n]);
        let (s, t) = (distance(p), distance(q));
        if s >= 0.0 {
            left.push(p);
        }
        if s * t < 0.0 {
            left.push(p.lerp(q, s / (s - t)));
        }
    }
    left
}

/// The ring with every vertex that lies on one of its sides.
fn with_vertices_between(ring: &[usize], places: &[DVec2], by_x: &[usize]) -> Vec<usize> {
    let mut all = Vec::new();
    for (k, &from) in ring.iter().enumerate() {
        let to = ring[(k + 1) % ring.len()];
        if from == to {
            continue;
        }
        let (p, q) = (places[from], places[to]);
        let (length, along) = ((q - p).length(), (q - p).normalize());
        let (lo, hi) = (p.x.min(q.x) - SAME_PX, p.x.max(q.x) + SAME_PX);
        let first = by_x.partition_point(|v| places[*v].x < lo);
        let near = by_x[first..].iter().copied().take_while(|v| places[*v].x <= hi);
        let on = |v: &usize| {
            let d = places[*v] - p;
            *v != from && *v != to && along.perp_dot(d).abs() < SAME_PX && (0.0..length).contains(&along.dot(d))
        };
        let mut between: Vec<usize> = near.filter(on).collect();
        between.sort_by(|a, b| along.dot(places[*a]).total_cmp(&along.dot(places[*b])));
        all.push(from);
        all.extend(between);
    }
    all.dedup();
    all
}

/// Vertices by their places.
#[derive(Default)]
struct Vertices {
    places_px: Vec<DVec2>,
    mixes: Vec<Vec<Mix>>,
    by_place: HashMap<[i64; 2], Vec<usize>>,
}

impl Vertices {
    fn key(q: DVec2) -> [i64; 2] {
        (q / (4.0 * SAME_PX)).floor().to_array().map_each(|x| x as i64)
    }

    fn find(&self, q: DVec2) -> Option<usize> {
        let [x, y] = Vertices::key(q);
        let keys = (-1..=1).flat_map(|i| (-1..=1).map(move |j| [x + i, y + j]));
        let near = keys.filter_map(|key| self.by_place.get(&key)).flatten().copied();
        near.filter(|v| self.places_px[*v].distance(q) < SAME_PX).min()
    }

    fn add(&mut self, q: DVec2, mixes: impl FnOnce() -> Vec<Mix>) {
        if self.find(q).is_none() {
            self.by_place.entry(Vertices::key(q)).or_default().push(self.places_px.len());
            self.places_px.push(q);
            self.mixes.push(mixes());
        }
    }

    /// Triangles from a convex ring to its middle. Mixes are linear over the ring: those of the middle are the mean.
    fn fan(&mut self, ring: &[usize], triangles: &mut Vec<[u32; 3]>) {
        let (n, count) = (ring.len(), ring.len() as f64);
        if n < 3 {
            return;
        }
        if n == 3 {
            triangles.push([0, 1, 2].map_each(|k| ring[k] as u32));
            return;
        }
        let middle = self.places_px.len();
        self.places_px.push(ring.iter().map(|v| self.places_px[*v]).sum::<DVec2>() / count);
        let mean = |r: usize| {
            let all = ring.iter().flat_map(|v| &self.mixes[*v][r]);
            all.map(|(corner, weight)| (*corner, weight / count)).collect::<Mix>()
        };
        let mixes = (0..self.mixes[ring[0]].len()).map(mean).collect();
        self.mixes.push(mixes);
        triangles.extend((0..n).map(|k| [ring[k], ring[(k + 1) % n], middle].map_each(|v| v as u32)));
    }
}

/// What regions with these shares leave to those after them, in order: with these factors, shares sum to at most 1.
pub fn left_in_order(shares: &[f64]) -> Vec<f64> {
    let mut left = 1.0;
    let next = |share: &f64| {
        let own = left;
        left *= 1.0 - share;
        own
    };
    shares.iter().map(next).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_common_subdivision_covers_the_rectangle_once_and_keeps_every_share() {
        let square = |x: f64, y: f64, w: f64| outline::rectangle(DVec2::new(x, y), DVec2::new(x + w, y + w));
        let frame = square(0.0, 0.0, 100.0);
        // the second pair has sides in common, the third one corner on the other's side
        for (x, y) in [(33.3, 27.1), (30.0, 20.0), (45.0, 35.0), (20.0, 20.0)] {
            let of = |x: f64, y: f64| Profile::new(&square(x, y, 30.0), &square(x - 5.0, y - 5.0, 40.0), &frame);
            let both = overlay(&frame, &[of(20.0, 20.0), of(x, y)]);
            let area: f64 = both.triangles.iter().map(|t| outline::area2(&t.map(|k| both.places_px[k as usize]))).sum();
            assert!((area - 20_000.0).abs() < 1e-6, "{area}");
            // every side but the frame's is shared by two triangles
            let sides: Vec<(u32, u32)> =
                both.triangles.iter().flat_map(|t| [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])]).collect();
            let open = sides.iter().filter(|(a, b)| !sides.contains(&(*b, *a))).count();
            assert_eq!(open, 4);
            for (q, mixes) in both.places_px.iter().zip(&both.mixes) {
                let shares = [share(&mixes[0]), share(&mixes[1])];
                let expected = |x: f64, y: f64| {
                    let off = (*q - DVec2::new(x, y) - 15.0).abs().max_element();
                    (1.0 - (off - 15.0) / 5.0).clamp(0.0, 1.0)
                };
                assert!((shares[0] - expected(20.0, 20.0)).abs() < 1e-4 && (shares[1] - expected(x, y)).abs() < 1e-4);
            }
        }
    }

    #[test]
    fn weights_in_order_sum_to_at_most_1() {
        assert_eq!(left_in_order(&[0.0, 1.0, 0.5]), [1.0, 1.0, 0.0]);
        for shares in [[0.5, 0.5, 1.0], [0.25, 0.5, 0.125], [1.0, 1.0, 1.0]] {
            let sum: f64 = left_in_order(&shares).iter().zip(shares).map(|(left, share)| left * share).sum();
            let rest: f64 = shares.iter().map(|share| 1.0 - share).product();
            assert_eq!(sum, 1.0 - rest);
        }
    }
}
