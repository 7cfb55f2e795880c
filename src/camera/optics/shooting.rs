//! Normal shooting: a fine mirror that reflects rays as a coarse one does.
//!
//! Hou, Wei, Shum and Guo 2006, section 2.3: the mirror that is seen is matched with the coarse one whose facets are the cameras
//! along its normals, as Sander et al. 2000 match a mesh with its simplified copy. In the paper every ray starts on the coarse facet;
//! here it starts at the bounce on the fine mirror, which is nearer to the smooth surface.

use super::facets::{CoarseFacets, Facet, Facets};
use crate::arrays::MapEach;
use crate::camera::Bundle;
use crate::camera::perturb::scene_size;
use crate::geometry::cast::{Caster, Hit, as_near};
use crate::parallel;
use glam::DVec3;

/// Cosine of the angle, 60 degrees, between a fine and a coarse normal at most: a line that comes to others has left the part of
/// the mirror that it started from, through an edge or to the far side.
const ALIKE_LEAST: f64 = 0.5;
/// A line that meets the coarse mirror farther away than so many times its nearest place has gone past its rim: a facet as steep
/// as that, by 75 degrees to the fine normal, is no copy.
const FARTHER_MOST: f64 = 4.0;

/// The coarse mirror, indexed for ray queries.
struct Target<'a> {
    coarse: &'a Facets,
    caster: Caster<'a>,
    scene_size: f64,
}

impl Facets {
    /// The same facets with normals of a coarse copy. Each vertex takes the normal where the line along its own normal, in either
    /// direction, hits the copy; if that line misses, or hits another part of the copy, the normal at the nearest point. `coarse` of the
    /// result holds the coarse facet of each facet, found in the same way from the facet's centre.
    pub fn shot_at(&self, coarse: &Facets) -> Facets {
        let mesh = coarse.mesh([0.0; 3]);
        let target = Target { coarse, caster: Caster::new(&mesh), scene_size: scene_size(mesh.bounds()) };
        // corners of one place and one normal are one shot
        let each = || self.triangles.iter().zip(&self.corner_normals);
        let mut shots: Vec<(u32, u32)> = each().flat_map(|(t, n)| [0, 1, 2].map_each(|k| (t[k], n[k]))).collect();
        parallel::sort(&mut shots);
        shots.dedup();
        let shoot = |(p, n): &(u32, u32)| target.shot(self.positions[*p as usize], self.normals[*n as usize]);
        let hits: Vec<Option<Hit>> = parallel::map(&shots, shoot);
        let normal = |(hit, (_, n)): (&Option<Hit>, &(u32, u32))| match hit {
            Some(hit) => target.normal(hit),
            None => self.normals[*n as usize],
        };
        let corner_normals: Vec<[u32; 3]> = each()
            // every shot is in the list
            .map(|(t, n)| [0, 1, 2].map_each(|k| shots.partition_point(|s| *s < (t[k], n[k])) as u32))
            .collect();
        let of: Vec<u32> = parallel::map(0..self.triangles.len(), |k| target.coarse_of(&self.facet(k)));
        let weights_on = |(facet, corners): (&u32, &[u32; 3])| {
            corners.map_each(|k| hits[k as usize].map_or([0.0; 2], |hit| target.weights_on(*facet, &hit)))
        };
        let weights = of.iter().zip(&corner_normals).map(weights_on).collect();
        Facets {
            positions: self.positions.clone(),
            normals: hits.iter().zip(&shots).map(normal).collect(),
            triangles: self.triangles.clone(),
            corner_normals,
            coarse: Some(CoarseFacets { copy: Box::new(coarse.clone()), of, weights }),
        }
    }
}

impl Target<'_> {
    /// The place of the coarse mirror that belongs to one of the fine: where the line along the unit normal meets it; of places
    /// that are one by rounding, as on an edge, the one whose normal is most alike.
    fn shot(&self, place: DVec3, normal: DVec3) -> Option<Hit> {
        let likeness = |hit: &Hit| self.normal(hit).dot(normal);
        let alike = |hit: &Hit| likeness(hit) >= ALIKE_LEAST;
        let mut near = self.caster.nearest(place, alike);
        if near.is_empty() {
            near = self.caster.nearest(place, |_| true);
        }
        let distance = near.first()?.t;
        let met = self.on_line(place, normal, alike).filter(|hit| hit.t <= FARTHER_MOST * distance);
        match met {
            Some(met) if met.t > as_near(place, distance) => Some(met),
            met => near.into_iter().chain(met).max_by(|a, b| likeness(a).total_cmp(&likeness(b))),
        }
    }

    /// Of all places `of` the coarse mirror that the line along a unit direction meets, either way, the nearest.
    fn on_line(&self, place: DVec3, direction: DVec3, of: impl Fn(&Hit) -> bool) -> Option<Hit> {
        let (e1, e2) = direction.any_orthonormal_pair();
        let aim = |d: DVec3| {
            let line = Bundle { p: [place, e1, e2], d: [d, DVec3::ZERO, DVec3::ZERO], h: [1.0, 0.0, 0.0] };
            line.aim(self.scene_size)
        };
        self.caster.on_line([&aim(direction)?, &aim(-direction)?], of)
    }

    /// The coarse facet that a fine one belongs to.
    fn coarse_of(&self, facet: &Facet) -> u32 {
        let [a, b, c] = facet.corners;
        let normal = facet.normals.iter().sum::<DVec3>().normalize_or((b - a).cross(c - a).normalize_or(DVec3::Y));
        self.shot((a + b + c) / 3.0, normal).map_or(0, |hit| hit.triangle)
    }

    /// A place of the coarse mirror by the weights of a facet's second and third corner: of its foot on the facet's plane.
    fn weights_on(&self, facet: u32, hit: &Hit) -> [f64; 2] {
        if hit.triangle == facet {
            return hit.bary;
        }
        let Facet { corners: own, .. } = self.coarse.facet(hit.triangle as usize);
        let [u, v] = hit.bary;
        let [a, b, c] = self
            .coarse
            .facet(facet as usize)
            .corners
            .map_each(|p| p - ((1.0 - u - v) * own[0] + u * own[1] + v * own[2]));
        let normal = (b - a).cross(c - a);
        [c.cross(a), a.cross(b)].map_each(|area| area.dot(normal) / normal.length_squared())
    }

    /// The coarse mirror's unit normal; that of the facet itself where the corners' cancel out.
    fn normal(&self, hit: &Hit) -> DVec3 {
        let Facet { corners: [a, b, c], normals } = self.coarse.facet(hit.triangle as usize);
        let [u, v] = hit.bary;
        let mixed = (1.0 - u - v) * normals[0] + u * normals[1] + v * normals[2];
        mixed.try_normalize().unwrap_or_else(|| (b - a).cross(c - a).normalize_or(DVec3::Y))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::optics::Wave;
    use crate::camera::optics::shape::tests::{cap, torus};
    use crate::camera::optics::shape::{Cap, Shape};
    use crate::geometry::generate::teapot;

    fn ball() -> Shape {
        Shape::Sphere { center: DVec3::new(3.0, -2.0, 1.0), radius: 2.0 }
    }

    fn lens() -> Shape {
        Shape::Lens { caps: [cap(-0.4, 0.5, 0.9, false), cap(0.4, -0.6, 0.9, true)] }
    }

    fn bowl() -> Shape {
        let cap = Cap { vertex: DVec3::ZERO, axis: DVec3::Y, curvature: 0.9, conic: -1.0, rim: 2.0, flipped: false };
        Shape::Quadric { cap }
    }

    /// The largest distance between the normals of two corners.
    fn normal_distance(a: &Facets, b: &Facets) -> f64 {
        let each = (0..a.triangles.len()).flat_map(|k| {
            let (a, b) = (a.facet(k).normals, b.facet(k).normals);
            [0, 1, 2].map(|c| (a[c] - b[c]).length())
        });
        each.fold(0.0, f64::max)
    }

    #[test]
    fn a_mirror_shot_at_itself_is_itself() {
        let pot = Facets::of_mesh(&teapot(4)).unwrap();
        for (name, facets) in [
            ("ball", ball().facets(400)),
            ("torus", torus().facets(600)),
            ("lens", lens().facets(500)),
            ("teapot", pot.resampled(600).unwrap()),
        ] {
            let shot = facets.shot_at(&facets);
            // a sum of three weighted normals and its length
            assert!(normal_distance(&shot, &facets) < 1e-14, "{name}: {}", normal_distance(&shot, &facets));
            let own = (0..facets.triangles.len()).filter(|k| shot.coarse_of(*k) == *k as u32).count();
            assert_eq!(own, facets.triangles.len(), "{name}");
            let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
            for k in 0..own {
                let off = |i: usize| (shot.coarse_weights(k)[i / 2][i % 2] - corners[i / 2][i % 2]).abs();
                // of a vertex that other facets share: its foot on this one
                assert!((0..6).all(|i| off(i) < 1e-9), "{name}: {k}");
            }
            assert_eq!((&shot.positions, &shot.triangles), (&facets.positions, &facets.triangles));
        }
    }

    #[test]
    fn normals_come_nearer_to_the_surfaces_own_with_more_cameras() {
        for (name, shape) in [("bowl", bowl()), ("torus", torus())] {
            let fine = shape.facets(4000);
            let off = [60, 240, 960].map(|n| normal_distance(&fine.shot_at(&shape.facets(n)), &fine));
            // interpolated normals are off by the square of a facet's size, and its sides are not all alike
            assert!(off[1] < off[0] / 2.0 && off[2] < off[1] / 2.0, "{name}: {off:?}");
        }
    }

    #[test]
    fn every_copy_of_a_ball_has_the_balls_own_normals() {
        // between corners whose normals are radii the sum of normals is the radius of the place
        let fine = ball().facets(4000);
        for n in [8, 60, 960] {
            assert!(normal_distance(&fine.shot_at(&ball().facets(n)), &fine) < 1e-14, "{n}");
        }
    }

    #[test]
    fn every_facet_belongs_to_the_coarse_one_over_it() {
        let (fine, coarse) = (ball().facets(4000), ball().facets(100));
        let shot = fine.shot_at(&coarse);
        let mut seen = vec![false; coarse.triangles.len()];
        for k in 0..fine.triangles.len() {
            let coarse_facet = shot.coarse_of(k) as usize;
            seen[coarse_facet] = true;
            let centre = fine.facet(k).corners.iter().sum::<DVec3>() / 3.0 - DVec3::new(3.0, -2.0, 1.0);
            // the radius through its centre passes the three edges of the coarse facet on one side
            let [a, b, c] = coarse.facet(coarse_facet).corners.map(|p| p - DVec3::new(3.0, -2.0, 1.0));
            let sides = [a.cross(b), b.cross(c), c.cross(a)].map(|n| n.dot(centre));
            assert!(sides.iter().all(|s| *s > -0.02), "{k}: {sides:?}");
        }
        assert!(seen.iter().all(|s| *s), "a coarse facet without fine ones");
        assert_eq!(shot.piece_count(), coarse.triangles.len());
    }

    #[test]
    fn a_rim_beyond_the_copys_takes_its_nearest_place() {
        // an open wave, a copy half as wide: what is beyond takes the normal of its border
        let wave = |size: f64| Shape::Wave(Wave { centre: DVec3::ZERO, size, amplitude: 0.0, wavelength: 1.0 });
        let shot = wave(4.0).facets(200).shot_at(&wave(2.0).facets(50));
        for k in 0..200 {
            assert!(shot.facet(k).normals.iter().all(|n| (*n - DVec3::Y).length() < 1e-15));
        }
        // not the other side of the bowl: all are within the angle of a facet
        let fine = bowl().facets(3000);
        assert!(normal_distance(&fine.shot_at(&bowl().facets(300)), &fine) < 0.35);
    }
}
