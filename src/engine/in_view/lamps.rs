//! Lamps behind a side of the scene's box that triangles fill, such as a lamp below the ground. No light of these lamps enters the box.
//!
//! Kernels start shadow rays a little above a surface. Where a surface that faces down touches the ground, a ray may start below the ground and
//! reach the lamp: without the lamp, that false light is gone too.

use super::rays::ImageRays;
use crate::arrays::MapEach;
use crate::geometry::exact::Exact;
use crate::geometry::mesh::Mesh;
use crate::parallel;
use crate::scene::Scene;
use crate::scene::light::{Light, Source};
use glam::{DVec2, DVec3};
use std::collections::HashMap;
use std::sync::OnceLock;

/// Whether triangles fill each side of the box around a scene, looked at when a frame first asks.
#[derive(Default)]
pub struct Sides([OnceLock<bool>; 6]);

/// A side of the box around a scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Side {
    axis: usize,
    is_upper: bool,
    bounds: (DVec3, DVec3),
}

impl Side {
    /// The sides of a box.
    fn all(bounds: (DVec3, DVec3)) -> impl Iterator<Item = Side> {
        (0..6).map(move |k| Side { axis: k / 2, is_upper: k % 2 == 1, bounds })
    }

    /// The other two axes.
    fn along(&self) -> [usize; 2] {
        [(self.axis + 1) % 3, (self.axis + 2) % 3]
    }

    /// The coordinate of the side along its axis.
    fn at(&self) -> f64 {
        let (lo, hi) = self.bounds;
        if self.is_upper { hi[self.axis] } else { lo[self.axis] }
    }

    /// The unit normal that points into the box, and its product with the places in the side.
    pub fn plane(&self) -> (DVec3, f64) {
        let sign = if self.is_upper { -1.0 } else { 1.0 };
        (sign * DVec3::AXES[self.axis], sign * self.at())
    }

    /// Returns whether a place is outside of the box, straight behind this side.
    fn is_behind(&self, place: DVec3) -> bool {
        let (lo, hi) = self.bounds;
        let is_outside = if self.is_upper { place[self.axis] > self.at() } else { place[self.axis] < self.at() };
        is_outside && self.along().iter().all(|&k| lo[k] <= place[k] && place[k] <= hi[k])
    }

    /// Returns whether opaque triangles in the side fill it. Triangles that lie side by side must have whole edges in common.
    fn is_filled(&self, mesh: &Mesh) -> bool {
        let is_in_side = |p: DVec3| p[self.axis] == self.at();
        let within = |id: u32| {
            let corners = mesh.triangles[id as usize].map_each(|v| mesh.positions[v as usize]);
            let is_opaque = !mesh.is_round(id) && !mesh.has_alpha(id);
            (is_opaque && corners.into_iter().all(is_in_side)).then_some(corners)
        };
        let triangles: Vec<[DVec3; 3]> = parallel::flat_map(0..mesh.triangles.len() as u32, within);
        if triangles.len() > TRIANGLES_MAX {
            return false;
        }
        // With all triangles counter-clockwise, opposite edges of neighbours cancel. If the edges that are left lie on the rim, the triangles cover
        // every place of the side equally often: as often as these edges go around the side.
        let [x, y] = self.along();
        let mut edges: HashMap<[[u64; 2]; 2], i32> = HashMap::new();
        for corners in triangles {
            let [a, mut b, mut c] = corners.map_each(|p| DVec2::new(p[x] + 0.0, p[y] + 0.0));
            match turn(a, b, c) {
                0 => continue,
                1 => {}
                _ => std::mem::swap(&mut b, &mut c),
            }
            for (from, to) in [(a, b), (b, c), (c, a)] {
                let [from, to] = [from, to].map_each(|p| p.to_array().map_each(f64::to_bits));
                let (ends, count) = if from < to { ([from, to], 1) } else { ([to, from], -1) };
                *edges.entry(ends).or_default() += count;
            }
        }
        let (lo, hi) = self.bounds;
        let rim = [(0, lo[x]), (0, hi[x]), (1, lo[y]), (1, hi[y])];
        let mut left = edges.iter().filter(|(_, count)| **count != 0).map(|(ends, _)| ends).peekable();
        left.peek().is_some()
            && left.all(|ends| rim.iter().any(|&(k, at)| ends.iter().all(|end| f64::from_bits(end[k]) == at + 0.0)))
    }
}

/// A side of more triangles counts as not filled.
const TRIANGLES_MAX: usize = 1 << 17;

/// The sign of the area of a triangle, without rounding.
fn turn(a: DVec2, b: DVec2, c: DVec2) -> i32 {
    // a x b + b x c + c x a
    let terms = [(a, b), (b, c), (c, a)].map(|(p, q)| Exact::product(p.x, q.y).minus(&Exact::product(p.y, q.x)));
    let sum = terms.iter().fold(Exact::default(), |sum, term| sum.plus(term));
    sum.sign().into()
}

/// A bit for each of the first 64 lights: whether it is a lamp whose light reaches nothing that `rays` meet. `None`: rays are not bounded.
pub fn hidden(scene: &Scene, sides: &Sides, rays: Option<&ImageRays>) -> u64 {
    let is_still = scene.steps.is_none() && scene.mesh.instances().is_none();
    let (Some(rays), Some(bounds), true) = (rays, scene.mesh.bounds(), is_still) else { return 0 };
    let is_hidden = |light: &Light| {
        let Source::Point { position, .. } = light.source else { return false };
        let behind = Side::all(bounds).zip(&sides.0).find(|(side, _)| side.is_behind(position));
        light.casts_shadows
            && behind.is_some_and(|(side, known)| {
                rays.start_beyond(side.plane()) && *known.get_or_init(|| side.is_filled(scene.mesh.mesh()))
            })
    };
    let bits = scene.lights.iter().take(u64::BITS as usize).enumerate();
    bits.map(|(k, light)| u64::from(is_hidden(light)) << k).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A mesh of triangles in the plane y = 0 over the square from 0 to 4, and a vertex above.
    fn side_of(triangles: &[[[f64; 2]; 3]]) -> bool {
        let mut mesh = Mesh::default();
        for triangle in triangles {
            let first = mesh.positions.len() as u32;
            mesh.positions.extend(triangle.map(|[x, z]| DVec3::new(x, 0.0, z)));
            mesh.triangles.push([first, first + 1, first + 2]);
        }
        let bounds = (DVec3::ZERO, DVec3::new(4.0, 3.0, 4.0));
        Side { axis: 1, is_upper: false, bounds }.is_filled(&mesh)
    }

    #[test]
    fn a_side_is_filled_where_edges_cancel_but_for_the_rim() {
        let [a, b, c, d] = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]];
        let (middle, end) = ([2.0, 1.0], [2.0, 0.0]);
        assert!(side_of(&[[a, b, c], [a, c, d]]));
        // wound otherwise, and twice
        assert!(side_of(&[[a, c, b], [a, c, d]]));
        assert!(side_of(&[[a, c, b], [a, c, d], [b, c, d], [a, b, d]]));
        assert!(side_of(&[[a, b, middle], [b, c, middle], [c, d, middle], [d, a, middle]]));
        assert!(side_of(&[[a, end, d], [end, b, c], [c, d, end]]));
        // a hole, a triangle too few, one that laps over, none
        assert!(!side_of(&[[a, end, middle], [b, c, middle], [c, d, middle], [d, a, middle]]));
        assert!(!side_of(&[[a, b, c]]));
        assert!(!side_of(&[[a, b, c], [a, c, d], [a, b, middle]]));
        assert!(!side_of(&[]));
        assert!(!side_of(&[[a, b, a]]));
    }

    #[test]
    fn lamps_stand_straight_behind_one_side() {
        let bounds = (DVec3::ZERO, DVec3::splat(2.0));
        let behind = |x: f64, y: f64, z: f64| {
            Side::all(bounds)
                .filter(|side| side.is_behind(DVec3::new(x, y, z)))
                .map(|s| (s.axis, s.is_upper))
                .collect::<Vec<_>>()
        };
        assert_eq!(behind(1.0, -1.0, 1.0), [(1, false)]);
        assert_eq!(behind(3.0, 1.0, 2.0), [(0, true)]);
        assert_eq!(behind(1.0, 1.0, 1.0), []);
        assert_eq!(behind(1.0, 0.0, 1.0), []);
        assert_eq!(behind(-1.0, -1.0, 1.0), []);
    }
}
