//! The net of `track` with few segments: a core and four segments around it for each target, or group of targets whose
//! bands meet (Popescu et al., section 3.3, Fig. 8).

use super::Net;
use super::blend::{Seen, shares};
use super::outline::{self, Outline};
use super::view::View;
use crate::arrays::MapEach;
use glam::DVec2;

/// The fewest segments of a layer: a core, four around it, and four up to the image's borders.
pub const FEWEST: usize = 9;

/// Targets whose bands meet: the rectangles around their cores and around their bands.
struct Group {
    seen: Vec<usize>,
    core: [DVec2; 2],
    reach: [DVec2; 2],
}

/// A net of at most `segments` pairs of triangles, and the targets' shares at its vertices.
pub fn net(view: &View, seen: &[Seen], size: (u32, u32), segments: usize) -> (Net, Vec<Vec<f64>>) {
    let groups = groups(view, seen, segments);
    let end = DVec2::new(size.0 as f64, size.1 as f64);
    let lo = groups.iter().fold(DVec2::ZERO, |lo, g| lo.min(g.reach[0])) - 1.0;
    let hi = groups.iter().fold(end, |hi, g| hi.max(g.reach[1])) + 1.0;
    let image = outline::rectangle(lo, hi);
    let holes: Vec<Outline> = groups.iter().map(|g| outline::rectangle(g.reach[0], g.reach[1])).collect();
    let mut places_px: Vec<DVec2> = image.iter().chain(holes.iter().flatten()).copied().collect();
    let mut shares_at: Vec<Vec<f64>> = vec![vec![0.0; seen.len()]; places_px.len()];
    let mut triangles = outline::triangulate(&image, &holes);
    // what is left is for cores of several targets: n by n cells each
    let several = groups.iter().filter(|g| g.seen.len() > 1).count();
    let spare = segments.saturating_sub(count(groups.len())) / several.max(1);
    let finer = (1..).take_while(|n| n * n + 2 * n - 3 <= spare).last().unwrap_or(1) as u32;
    for (k, group) in groups.iter().enumerate() {
        let n = if group.seen.len() > 1 { finer } else { 1 };
        let (first, outer) = (places_px.len() as u32, 4 + 4 * k as u32);
        for (j, i) in (0..=n).flat_map(|j| (0..=n).map(move |i| (j, i))) {
            let part = DVec2::new(f64::from(i), f64::from(j)) / f64::from(n);
            let q = group.core[0] + part * (group.core[1] - group.core[0]);
            let mut own = shares(view, seen, q);
            let sum: f64 = own.iter().sum();
            let presence = group.seen.iter().map(|k| seen[*k].presence).fold(0.0, f64::max);
            own.iter_mut().for_each(|w| *w *= presence / sum.max(f64::MIN_POSITIVE));
            places_px.push(q);
            shares_at.push(own);
        }
        let at = |i: u32, j: u32| first + j * (n + 1) + i;
        let cell =
            |i: u32, j: u32| [[at(i, j), at(i + 1, j), at(i, j + 1)], [at(i, j + 1), at(i + 1, j), at(i + 1, j + 1)]];
        triangles.extend((0..n).flat_map(|j| (0..n).flat_map(move |i| cell(i, j))));
        // around the core: along each side, triangles to one outer corner, and one to the next corner
        let sides: [&dyn Fn(u32) -> u32; 4] = [&|s| at(s, 0), &|s| at(n, s), &|s| at(n - s, n), &|s| at(0, n - s)];
        for (c, side) in sides.into_iter().enumerate() {
            let [from, to] = [c as u32, (c as u32 + 1) % 4].map_each(|corner| outer + corner);
            triangles.extend((0..n).map(|s| [from, side(s + 1), side(s)]));
            triangles.push([from, to, side(n)]);
        }
    }
    (Net { places_px, triangles }, shares_at)
}

/// Segments of a layer with so many groups, each with one core.
fn count(groups: usize) -> usize {
    1 + 8 * groups
}

/// The hidden targets and what is beside them, so grouped that no two groups meet and the segments suffice.
fn groups(view: &View, seen: &[Seen], segments: usize) -> Vec<Group> {
    let of = |(k, s): (usize, &Seen)| Group {
        seen: vec![k],
        core: [s.place_px - s.core_px, s.place_px + s.core_px],
        reach: [s.place_px - s.reach_px(view), s.place_px + s.reach_px(view)],
    };
    let meet = |a: &Group, b: &Group| a.reach[0].cmple(b.reach[1]).all() && b.reach[0].cmple(a.reach[1]).all();
    let both = |a: [DVec2; 2], b: [DVec2; 2]| [a[0].min(b[0]), a[1].max(b[1])];
    let mut groups: Vec<Group> = Vec::new();
    let join = |groups: &mut Vec<Group>, mut group: Group| {
        while let Some(at) = groups.iter().position(|g| meet(g, &group)) {
            let other = groups.remove(at);
            group = Group {
                seen: [other.seen, group.seen].concat(),
                core: both(other.core, group.core),
                reach: both(other.reach, group.reach),
            };
        }
        groups.push(group);
    };
    for group in seen.iter().enumerate().map(of) {
        join(&mut groups, group);
    }
    groups.retain(|g| g.seen.iter().any(|k| seen[*k].detour.is_some()));
    while groups.len() > 1 && count(groups.len()) > segments {
        let (last, mut before) = (groups.remove(groups.len() - 1), groups.remove(groups.len() - 1));
        before.core = both(before.core, last.core);
        before.reach = both(before.reach, last.reach);
        before.seen.extend(last.seen);
        join(&mut groups, before);
    }
    groups
}
