//! How the light of a caustic triangle is shared out among the texels of a map, by definition: each texel's part of its area.

use glam::DVec2;

/// Texels and the share of a triangle that each receives.
pub struct Shares {
    /// Index of the texel, row by row, and its part of 1; what is missing to 1 lies beyond the border.
    pub list: Vec<(usize, f64)>,
    /// The triangle is a line or a point.
    pub flat: bool,
}

/// A triangle narrower than this across its longest side is a line, texels. Its light is then so far beside its place at most;
/// f32, which has areas to 2^-22 of the length, has shares to 2^-14 here.
pub const LINE_WIDTH: f64 = 1.0 / 256.0;

/// The shares of a triangle on a map of `texels` columns and rows.
pub fn shares(corners: &[DVec2; 3], texels: [u32; 2]) -> Shares {
    let [a, b, c] = *corners;
    let area = (b - a).perp_dot(c - a).abs() / 2.0;
    let longest = [(a, b, c), (b, c, a), (c, a, b)].into_iter().max_by(|x, y| length(x).total_cmp(&length(y)));
    let Some((from, to, third)) = longest else { return Shares { list: Vec::new(), flat: true } };
    let side = to - from;
    if 2.0 * area <= LINE_WIDTH * side.length() {
        return Shares { list: along(from, side, third, texels), flat: true };
    }
    let mut list = Vec::new();
    each_row(&[a, b, c], texels, |x, y, part| list.push((y * texels[0] as usize + x, part / area)));
    Shares { list, flat: false }
}

fn length(side: &(DVec2, DVec2, DVec2)) -> f64 {
    (side.1 - side.0).length_squared()
}

/// The area of a polygon within each texel that it meets.
fn each_row(polygon: &[DVec2], [columns, rows]: [u32; 2], mut visit: impl FnMut(usize, usize, f64)) {
    let bounds = |polygon: &[DVec2], axis: usize, most: u32| {
        let all = polygon.iter().map(|p| p[axis]);
        let (lo, hi) = (all.clone().fold(f64::INFINITY, f64::min), all.fold(f64::NEG_INFINITY, f64::max));
        (lo.floor().clamp(0.0, most as f64) as usize, hi.ceil().clamp(0.0, most as f64) as usize)
    };
    let (y0, y1) = bounds(polygon, 1, rows);
    for y in y0..y1 {
        let row = between(polygon, DVec2::Y, y as f64);
        let (x0, x1) = bounds(&row, 0, columns);
        for x in x0..x1.max(x0) {
            let part = area(&between(&row, DVec2::X, x as f64));
            if part > 0.0 {
                visit(x, y, part);
            }
        }
    }
}

/// The part of a convex polygon with a coordinate in [at, at + 1].
fn between(polygon: &[DVec2], axis: DVec2, at: f64) -> Vec<DVec2> {
    let upper = clip(polygon, |p| p.dot(axis) - at);
    clip(&upper, |p| at + 1.0 - p.dot(axis))
}

/// The part of a convex polygon where a linear function is not below zero (Sutherland and Hodgman).
fn clip(polygon: &[DVec2], height: impl Fn(DVec2) -> f64) -> Vec<DVec2> {
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (k, &p) in polygon.iter().enumerate() {
        let q = polygon[(k + 1) % polygon.len()];
        let (hp, hq) = (height(p), height(q));
        if hp >= 0.0 {
            kept.push(p);
        }
        if (hp < 0.0) != (hq < 0.0) {
            kept.push(p + (q - p) * (hp / (hp - hq)));
        }
    }
    kept
}

fn area(polygon: &[DVec2]) -> f64 {
    let Some(&first) = polygon.first() else { return 0.0 };
    polygon.windows(2).map(|e| (e[0] - first).perp_dot(e[1] - first)).sum::<f64>().abs() / 2.0
}

/// A flat triangle's shares: its density rises along the longest side to the third corner's foot and falls from there, as
/// that of a triangle with an area; it is split where the side crosses borders of texels.
fn along(from: DVec2, side: DVec2, third: DVec2, [columns, rows]: [u32; 2]) -> Vec<(usize, f64)> {
    let foot = ((third - from).dot(side) / side.length_squared()).clamp(0.0, 1.0);
    let up_to = |s: f64| {
        if s < foot {
            s * s / foot
        } else if s < 1.0 {
            1.0 - (1.0 - s).powi(2) / (1.0 - foot)
        } else {
            1.0
        }
    };
    let mut splits = vec![0.0, 1.0];
    for (axis, most) in [(0, columns), (1, rows)] {
        let (p, d) = (from[axis], side[axis]);
        let (lo, hi) = (p.min(p + d).max(-1.0), p.max(p + d).min(most as f64 + 1.0));
        if d != 0.0 {
            let crossed = (lo.ceil() as i64..=hi.floor() as i64).map(|border| (border as f64 - p) / d);
            splits.extend(crossed.filter(|s| *s > 0.0 && *s < 1.0));
        }
    }
    splits.sort_by(f64::total_cmp);
    let part = |ends: &[f64]| {
        let place = (from + (ends[0] + ends[1]) / 2.0 * side).floor();
        let inside = place.cmpge(DVec2::ZERO).all() && place.x < columns as f64 && place.y < rows as f64;
        // of a point all is at its one place
        let share = if side == DVec2::ZERO { 1.0 } else { up_to(ends[1]) - up_to(ends[0]) };
        inside.then_some((place.y as usize * columns as usize + place.x as usize, share))
    };
    splits.windows(2).filter_map(part).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sum(shares: &Shares) -> f64 {
        shares.list.iter().map(|s| s.1).sum()
    }

    #[test]
    fn shares_of_triangles_lines_and_points_are_known_areas_and_sum_up_to_one() {
        let p = DVec2::new;
        // half of the first texel and what lies right of it
        let s = shares(&[p(0.0, 0.0), p(2.0, 0.0), p(0.0, 2.0)], [4, 4]);
        let known = [(0, 0.5), (1, 0.25), (4, 0.25)];
        assert!(s.list.len() == 3 && s.list.iter().zip(known).all(|(a, b)| a.0 == b.0 && (a.1 - b.1).abs() < 1e-15));
        // a border cuts off what is beyond
        let s = shares(&[p(-1.0, 0.5), p(1.0, 0.5), p(0.0, 0.9)], [4, 4]);
        assert!((sum(&s) - 0.5).abs() < 1e-15 && !s.flat);
        // a line's density rises to the middle: of the part up to s there is 2 s^2
        let s = shares(&[p(0.5, 1.5), p(4.5, 1.5), p(2.5, 1.5)], [6, 3]);
        assert!(s.flat && (sum(&s) - 1.0).abs() < 1e-15);
        assert!((s.list[0].1 - 2.0 * 0.125f64.powi(2)).abs() < 1e-15, "{:?}", s.list);
        let s = shares(&[p(3.25, 2.75); 3], [4, 4]);
        assert_eq!((s.list, s.flat), (vec![(11, 1.0)], true));
        let s = shares(&[p(4.0, 2.75); 3], [4, 4]);
        assert!(s.list.is_empty());
    }

    #[test]
    fn a_thin_triangle_is_shared_as_the_line_that_it_nearly_is() {
        let to = |y: f64| [DVec2::new(0.3, 0.4), DVec2::new(7.1, 3.9), DVec2::new(2.9, y)];
        // the line is at 1.7382 there; 0.0028 and 0.0046 beside it
        let [line, thin] = [1.735, 1.733].map(|y| shares(&to(y), [8, 8]));
        assert!(!thin.flat && line.flat);
        // two borders, the density 2 over a length of 7.6, and a border crossed 0.0046 sideways or twice that along the line
        for (texel, share) in &line.list {
            let other = thin.list.iter().find(|t| t.0 == *texel).map_or(0.0, |t| t.1);
            assert!((share - other).abs() < 0.01, "{texel}: {share} {other}");
        }
    }
}
