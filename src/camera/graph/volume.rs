//! Whether the volumes of pinhole segments intersect (section 3.3: "a precondition ... is that the input segments do
//! not intersect").

use super::view::View;
use crate::arrays::MapEach;
use glam::{DMat3, DVec2, DVec3};

/// A bounded convex volume: points with `normal . x <= limit` for all its planes, normals of unit length.
#[derive(Debug, Clone, PartialEq)]
pub struct Volume(Vec<(DVec3, f64)>);

impl Volume {
    /// The part of a view between two depths over the image rectangle from `lo` to `hi` (px).
    pub fn of_view(view: &View, lo: DVec2, hi: DVec2, [near, far]: [f64; 2]) -> Volume {
        let corners = [lo, DVec2::new(hi.x, lo.y), hi, DVec2::new(lo.x, hi.y)].map_each(|q| view.ray(q).direction);
        let (eye, f) = (view.eye(), view.forward());
        let centre = corners.iter().sum::<DVec3>();
        let mut planes = vec![(f, f.dot(eye) + far), (-f, -f.dot(eye) - near)];
        for k in 0..4 {
            let n = corners[k].cross(corners[(k + 1) % 4]).normalize();
            let outward = if n.dot(centre) > 0.0 { -n } else { n };
            planes.push((outward, outward.dot(eye)));
        }
        Volume(planes)
    }

    /// The box between two corners.
    pub fn of_box(lo: DVec3, hi: DVec3) -> Volume {
        let sides = |n: DVec3| [(n, n.dot(hi)), (-n, -n.dot(lo))];
        Volume([DVec3::X, DVec3::Y, DVec3::Z].into_iter().flat_map(sides).collect())
    }

    /// A point inside both volumes, by more than rounding.
    pub fn meets(&self, other: &Volume) -> Option<DVec3> {
        self.and(other).inside()
    }

    /// What both volumes hold.
    pub fn and(&self, other: &Volume) -> Volume {
        Volume(self.0.iter().chain(&other.0).copied().collect())
    }

    /// The mean of the volume's corners, if it is inside: then the volume is more than a face. Corners are the points
    /// where three planes meet that no other plane cuts off: some hundred triples of the few planes here.
    fn inside(&self) -> Option<DVec3> {
        let planes = &self.0;
        let mut corners = Vec::new();
        for (i, a) in planes.iter().enumerate() {
            for (j, b) in planes.iter().enumerate().skip(i + 1) {
                for c in &planes[j + 1..] {
                    corners.extend(meeting(a, b, c).filter(|x| self.contains(*x, ROUNDING)));
                }
            }
        }
        if corners.is_empty() {
            return None;
        }
        let mean = corners.iter().sum::<DVec3>() / corners.len() as f64;
        self.contains(mean, -2.0 * ROUNDING).then_some(mean)
    }

    /// The point is inside all planes, `tolerance` times its coordinates and the limits beyond them.
    fn contains(&self, x: DVec3, tolerance: f64) -> bool {
        self.0.iter().all(|(n, limit)| n.dot(x) - limit <= tolerance * (x.length() + limit.abs()))
    }
}

/// Determinant of three unit normals below which their planes do not meet in a point that f64 knows to
/// [`ROUNDING`]: 2^-53 over it is 2^-33.
const DETERMINANT_MIN: f64 = 1.0 / (1u64 << 20) as f64;

/// Relative rounding of a corner: a solve of condition 2^20 at most, some ten roundings of 2^-53.
const ROUNDING: f64 = 1.0 / (1u64 << 29) as f64;

/// The point on three planes.
fn meeting(a: &(DVec3, f64), b: &(DVec3, f64), c: &(DVec3, f64)) -> Option<DVec3> {
    let m = DMat3::from_cols(a.0, b.0, c.0).transpose();
    (m.determinant().abs() >= DETERMINANT_MIN).then(|| m.inverse() * DVec3::new(a.1, b.1, c.1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_meet_in_their_insides_alone() {
        let cube = |at: DVec3| Volume::of_box(at, at + DVec3::ONE);
        let unit = cube(DVec3::ZERO);
        assert!(unit.meets(&cube(DVec3::splat(0.75))).is_some_and(|x| (x - DVec3::splat(0.875)).length() < 1e-9));
        for beside in [DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::ONE, 1.5 * DVec3::Y] {
            assert!(unit.meets(&cube(beside)).is_none(), "{beside}");
        }
    }
}
