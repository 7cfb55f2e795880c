//! Polygons in the image: wider outlines, and triangles over them with holes left open.

use crate::arrays::MapEach;
use glam::DVec2;
use std::collections::BTreeSet;

/// Corners in order, of either orientation; no two sides cross.
pub type Outline = Vec<DVec2>;

/// The rectangle between two corners.
pub fn rectangle(lo: DVec2, hi: DVec2) -> Outline {
    vec![lo, DVec2::new(hi.x, lo.y), hi, DVec2::new(lo.x, hi.y)]
}

/// Twice the area, positive where the corners run from x towards y.
pub fn area2(outline: &[DVec2]) -> f64 {
    let from = outline[0];
    outline.windows(2).map(|s| (s[0] - from).perp_dot(s[1] - from)).sum()
}

/// The weights of a triangle's corners at a place.
pub fn weights([a, b, c]: [DVec2; 3], q: DVec2) -> [f64; 3] {
    let area = |a: DVec2, b: DVec2, c: DVec2| (b - a).perp_dot(c - a);
    [area(q, b, c), area(a, q, c), area(a, b, q)].map_each(|w| w / area(a, b, c))
}

/// The outline with every side moved outwards by `by`, corner for corner; `None` where a corner is too sharp for that.
pub fn widened(outline: &[DVec2], by: f64) -> Option<Outline> {
    let n = outline.len();
    let sign = area2(outline).signum();
    let outward = |k: usize| -sign * (outline[(k + 1) % n] - outline[k]).normalize().perp();
    let moved = |k: usize| {
        let (a, b) = (outward((k + n - 1) % n), outward(k));
        // the point on both moved sides: q . a = q . b = by
        let along = a + b;
        let corner = outline[k] + along * (2.0 * by / along.length_squared());
        ((corner - outline[k]).length() <= SHARPEST * by && corner.is_finite()).then_some(corner)
    };
    (0..n).map(moved).collect()
}

/// How far a widened corner may move, in parts of the width: corners of some 15 degrees.
const SHARPEST: f64 = 8.0;

/// Two sides of the outline touch that are not neighbours, or it has no area.
pub fn is_tangled(outline: &[DVec2]) -> bool {
    let n = outline.len();
    let side = |k: usize| (outline[k], outline[(k + 1) % n]);
    let is_other = |i: usize, j: usize| j != i && j != (i + 1) % n && i != (j + 1) % n;
    area2(outline) == 0.0
        || (0..n).any(|k| side(k).0 == side(k).1)
        || (0..n).any(|i| (0..i).any(|j| is_other(i, j) && touch(side(i), side(j))))
}

/// The areas of two outlines have a point in common.
pub fn overlap(a: &[DVec2], b: &[DVec2]) -> bool {
    let sides = |o: &[DVec2]| (0..o.len()).map(|k| (o[k], o[(k + 1) % o.len()])).collect::<Vec<_>>();
    let crossing = sides(a).iter().any(|s| sides(b).iter().any(|t| touch(*s, *t)));
    crossing || contains(a, b[0]) || contains(b, a[0])
}

/// The place is inside the outline: a ray from it to the right leaves it an odd number of times.
pub fn contains(outline: &[DVec2], q: DVec2) -> bool {
    let n = outline.len();
    let crosses = |k: &usize| {
        let (a, b) = (outline[*k], outline[(k + 1) % n]);
        (a.y > q.y) != (b.y > q.y) && q.x < a.x + (q.y - a.y) / (b.y - a.y) * (b.x - a.x)
    };
    (0..n).filter(crosses).count() % 2 == 1
}

fn touch((a, b): (DVec2, DVec2), (c, d): (DVec2, DVec2)) -> bool {
    let side = |p: DVec2, q: DVec2, r: DVec2| (q - p).perp_dot(r - p);
    let straddles = |p, q, r, s| side(p, q, r) * side(p, q, s) <= 0.0;
    let boxes = a.min(b).cmple(c.max(d)).all() && c.min(d).cmple(a.max(b)).all();
    boxes && straddles(a, b, c, d) && straddles(c, d, a, b)
}

/// Triangles that cover `outer` without its `holes`, which lie inside it and are disjoint: indices into the
/// corners of all outlines one after the other. Every corner is a corner of each triangle that it touches.
///
/// Ear clipping, the holes joined to the outside by bridges (Eberly, "Triangulation by ear clipping").
pub fn triangulate(outer: &[DVec2], holes: &[Outline]) -> Vec<[u32; 3]> {
    let places: Vec<DVec2> = outer.iter().chain(holes.iter().flatten()).copied().collect();
    let ring = |first: usize, outline: &[DVec2], sign: f64| {
        let mut ring: Vec<usize> = (first..first + outline.len()).collect();
        if area2(outline) * sign < 0.0 {
            ring.reverse();
        }
        ring
    };
    let mut whole = ring(0, outer, 1.0);
    let mut first = outer.len();
    let mut inner: Vec<Vec<usize>> = Vec::new();
    for hole in holes {
        inner.push(ring(first, hole, -1.0));
        first += hole.len();
    }
    while !inner.is_empty() {
        let Some((at, hole, corner)) = bridge(&places, &whole, &inner) else { break };
        let mut hole = inner.swap_remove(hole);
        hole.rotate_left(corner);
        let back = [hole[0], whole[at]];
        whole.splice(at + 1..at + 1, hole.into_iter().chain(back));
    }
    clip_ears(&places, whole)
}

/// The shortest segment from a corner of the outline to a corner of a hole that crosses no side: place in the outline, hole, place in it.
fn bridge(places: &[DVec2], whole: &[usize], holes: &[Vec<usize>]) -> Option<(usize, usize, usize)> {
    let sides: Vec<(usize, usize)> = std::iter::once(whole)
        .chain(holes.iter().map(Vec::as_slice))
        .flat_map(|r| (0..r.len()).map(move |k| (r[k], r[(k + 1) % r.len()])))
        .collect();
    let mut bridges: Vec<(f64, usize, usize, usize)> = Vec::new();
    for (at, &from) in whole.iter().enumerate() {
        for (h, hole) in holes.iter().enumerate() {
            bridges
                .extend(hole.iter().enumerate().map(|(k, &to)| (places[from].distance_squared(places[to]), at, h, k)));
        }
    }
    bridges.sort_by(|a, b| a.0.total_cmp(&b.0));
    let free = |&&(_, at, h, k): &&(f64, usize, usize, usize)| {
        let (from, to) = (whole[at], holes[h][k]);
        let n = whole.len();
        let (before, after) = (places[whole[(at + n - 1) % n]], places[whole[(at + 1) % n]]);
        let is_other = |s: &&(usize, usize)| ![s.0, s.1].iter().any(|c| *c == from || *c == to);
        opens_to(before, places[from], after, places[to])
            && !sides.iter().filter(is_other).any(|s| touch((places[from], places[to]), (places[s.0], places[s.1])))
    };
    bridges.iter().find(free).map(|&(_, at, h, k)| (at, h, k))
}

/// `q` lies inside the angle of the outline at `corner`, whose corners run from x towards y.
fn opens_to(before: DVec2, corner: DVec2, after: DVec2, q: DVec2) -> bool {
    let left = |a: DVec2, b: DVec2| (b - a).perp_dot(q - a) > 0.0;
    if (corner - before).perp_dot(after - corner) > 0.0 {
        left(before, corner) && left(corner, after)
    } else {
        left(before, corner) || left(corner, after)
    }
}

/// Cuts off the first ear of the ring, again and again. A corner that is no ear is tested again only after a neighbour of it, or the corner
/// found inside its triangle, was cut off: nothing else can make it an ear.
fn clip_ears(places: &[DVec2], ring: Vec<usize>) -> Vec<[u32; 3]> {
    let n = ring.len();
    let mut left = n;
    // the ring as a linked list of its corners' numbers
    let mut next: Vec<usize> = (0..n).map(|k| (k + 1) % n).collect();
    let mut before: Vec<usize> = (0..n).map(|k| (k + n - 1) % n).collect();
    let mut is_left = vec![true; n];
    // corners to be tested, and for each corner those that are no ears because it is inside their triangle
    let mut untested: BTreeSet<usize> = (0..n).collect();
    let mut blocked: Vec<Vec<usize>> = vec![Vec::new(); n];
    let mut triangles = Vec::new();
    while left > 2 {
        let Some(k) = untested.pop_first() else { break };
        let corners = [before[k], k, next[k]].map_each(|c| ring[c]);
        let t = corners.map_each(|c| places[c]);
        let side = |a: DVec2, b: DVec2, q: DVec2| (b - a).perp_dot(q - a);
        let within = |q: DVec2| side(t[0], t[1], q) >= 0.0 && side(t[1], t[2], q) >= 0.0 && side(t[2], t[0], q) >= 0.0;
        if side(t[0], t[1], t[2]) <= 0.0 {
            continue;
        }
        let is_inside = |c: &usize| is_left[*c] && !t.contains(&places[ring[*c]]) && within(places[ring[*c]]);
        if let Some(inside) = (0..n).find(is_inside) {
            blocked[inside].push(k);
            continue;
        }
        triangles.push(corners.map_each(|c| c as u32));
        (is_left[k], left) = (false, left - 1);
        (next[before[k]], before[next[k]]) = (next[k], before[k]);
        untested.extend([before[k], next[k]]);
        untested.extend(blocked[k].drain(..).filter(|c| is_left[*c]));
    }
    triangles
}

#[cfg(test)]
mod tests {
    use super::*;

    fn covered2(places: &[DVec2], triangles: &[[u32; 3]]) -> f64 {
        triangles.iter().map(|t| area2(&t.map(|k| places[k as usize]))).sum()
    }

    #[test]
    fn triangles_cover_an_outline_without_its_holes() {
        let at = |x: f64, y: f64| DVec2::new(x, y);
        let outer = rectangle(at(0.0, 0.0), at(100.0, 60.0));
        let star =
            vec![at(70., 10.), at(76., 22.), at(90., 25.), at(76., 30.), at(70., 45.), at(65., 30.), at(52., 25.)];
        let holes = [
            rectangle(at(10., 10.), at(30., 30.)),
            rectangle(at(35., 10.), at(45., 30.)),
            star,
            rectangle(at(10., 40.), at(45., 50.)),
        ];
        for count in 0..=holes.len() {
            let holes = &holes[..count];
            let places: Vec<DVec2> = outer.iter().chain(holes.iter().flatten()).copied().collect();
            let triangles = triangulate(&outer, holes);
            let open: f64 = holes.iter().map(|h| area2(h).abs()).sum();
            assert_eq!(covered2(&places, &triangles), area2(&outer) - open, "{count} holes");
            assert_eq!(triangles.len(), places.len() + 2 * count - 2);
            for hole in holes {
                let (lo, hi) = crate::camera::boxes::around(hole);
                let middle = (lo + hi) / 2.0;
                let within = |t: &[u32; 3]| super::contains(&t.map(|k| places[k as usize]), middle);
                assert!(!contains(hole, middle) || !triangles.iter().any(within));
            }
        }
    }

    #[test]
    fn wider_outlines_are_wider_by_as_much_on_every_side() {
        let square = rectangle(DVec2::new(2.0, 3.0), DVec2::new(10.0, 5.0));
        assert_eq!(widened(&square, 1.0), Some(rectangle(DVec2::new(1.0, 2.0), DVec2::new(11.0, 6.0))));
        let reversed: Outline = square.into_iter().rev().collect();
        assert_eq!(widened(&reversed, 1.0).map(|w| area2(&w)), Some(-80.0));
        let needle = [DVec2::ZERO, DVec2::new(100.0, 1.0), DVec2::new(100.0, -1.0)];
        assert!(widened(&needle, 1.0).is_none());
    }

    #[test]
    fn outlines_that_cross_themselves_or_each_other_are_found() {
        let square = |x: f64| rectangle(DVec2::new(x, 0.0), DVec2::new(x + 2.0, 2.0));
        assert!(!is_tangled(&square(0.0)));
        let mut bow = square(0.0);
        bow.swap(0, 1);
        assert!(is_tangled(&bow));
        assert!(overlap(&square(0.0), &square(1.0)) && !overlap(&square(0.0), &square(2.5)));
        assert!(overlap(&square(0.0), &rectangle(DVec2::splat(0.5), DVec2::splat(0.7))));
    }

    /// Cuts off the first ear, testing all corners each time.
    fn clip_ears_simply(places: &[DVec2], mut ring: Vec<usize>) -> Vec<[u32; 3]> {
        let mut triangles = Vec::new();
        while ring.len() > 2 {
            let n = ring.len();
            let corners = |k: usize| [ring[(k + n - 1) % n], ring[k], ring[(k + 1) % n]];
            let is_ear = |k: &usize| {
                let t = corners(*k).map(|c| places[c]);
                let side = |a: DVec2, b: DVec2, q: DVec2| (b - a).perp_dot(q - a);
                let within =
                    |q: DVec2| side(t[0], t[1], q) >= 0.0 && side(t[1], t[2], q) >= 0.0 && side(t[2], t[0], q) >= 0.0;
                side(t[0], t[1], t[2]) > 0.0 && !ring.iter().any(|&c| !t.contains(&places[c]) && within(places[c]))
            };
            let Some(ear) = (0..n).find(is_ear) else { break };
            triangles.push(corners(ear).map(|c| c as u32));
            ring.remove(ear);
        }
        triangles
    }

    /// A star of `n` corners at random distances from its middle.
    fn star(n: usize, seed: u64) -> Outline {
        let depth = |k: usize| 10.0 + (seed.wrapping_add(k as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 60) as f64;
        (0..n)
            .map(|k| DVec2::splat(50.0) + depth(k) * DVec2::from_angle(std::f64::consts::TAU * k as f64 / n as f64))
            .collect()
    }

    #[test]
    fn ears_are_cut_off_in_the_order_of_the_simple_algorithm() {
        for seed in 0..40 {
            let outline = star(3 + seed as usize, seed);
            let ring: Vec<usize> = (0..outline.len()).collect();
            assert_eq!(clip_ears(&outline, ring.clone()), clip_ears_simply(&outline, ring), "{seed}");
            let outer = rectangle(DVec2::ZERO, DVec2::splat(100.0));
            let triangles = triangulate(&outer, std::slice::from_ref(&outline));
            assert_eq!(triangles.len(), outline.len() + 4);
        }
    }

    #[test]
    fn triangulation_takes_quadratic_time() {
        let started = std::time::Instant::now();
        let outer = rectangle(DVec2::ZERO, DVec2::splat(100.0));
        assert_eq!(triangulate(&outer, &[star(4000, 1)]).len(), 4004);
        // cubic time would be minutes
        assert!(started.elapsed().as_secs() < 10, "{:?}", started.elapsed());
    }
}
