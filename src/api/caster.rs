//! Rays cast at a scene.

use super::Scene;
use crate::arrays::MapEach;
use crate::geometry::cast::{ExactCaster, Hit, Ray};
use crate::geometry::mesh::Mesh;
use crate::input::{Error, Result};
use crate::parallel;
use glam::DVec3;
use std::sync::Arc;

/// A scene's triangles, spheres and capsules, indexed for rays from anywhere. All it needs is a CPU.
///
/// Which triangles a ray meets, and in which order, is decided without rounding. A ray that goes into a closed surface, or out of it, through
/// an edge or a vertex meets one triangle there; one that only touches it meets none, or two at the same t. It meets what it would meet
/// with its origin moved by (e, e², e³), for an e smaller than all numbers. A triangle without area, or in whose plane the ray lies, is never met. One-sided triangles are met at
/// their front, and what an alpha mask leaves out is not met.
///
/// A sphere or capsule is met where the ray enters it and, unless it is one-sided, where it leaves it. A ray that touches one does both at
/// one t. On the side of a capsule t is exact to 2^-40 of itself: of meetings nearer to each other either may come first.
#[derive(Debug)]
pub struct Caster {
    caster: ExactCaster,
    mesh: Arc<Mesh>,
    /// For each object the first triangle after it.
    ends: Vec<u32>,
}

/// What a ray `origin + t * direction` meets.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RayHit {
    /// The ray parameter, to within 2^-40 of itself.
    pub t: f64,
    /// The id of the triangle or sphere in the scene, as in the channel `triangle.id`.
    pub triangle: u32,
    /// The object that it is of, by its place in [`Scene::objects`].
    pub object: u32,
    /// Weights of its second and third vertex; 0 of a sphere.
    pub bary: [f64; 2],
    /// Where on the triangle or sphere, world units.
    pub point: [f64; 3],
    /// The triangle's unit normal; its vertices are counter-clockwise seen from where it points. Of a sphere or capsule the one outwards.
    pub normal: [f64; 3],
}

impl Caster {
    /// Indexes the triangles and spheres of a scene as it is now.
    pub fn new(scene: &Scene) -> Caster {
        let mesh = scene.scene.mesh.mesh().clone();
        let ends = scene.scene.objects.iter().scan(0, |end, object| {
            *end += object.triangles as u32;
            Some(*end)
        });
        Caster { ends: ends.collect(), caster: ExactCaster::new(mesh.clone()), mesh }
    }

    /// For each ray, given as origin and direction, the first hit with t in `t_range`, ends included; among those at the same t that of the
    /// lowest id. The rays run on all cores.
    ///
    /// # Errors
    /// [`Error::Input`] for a ray that is not finite or has no direction, or a range that is none.
    pub fn first(&self, rays: &[[[f64; 3]; 2]], t_range: [f64; 2]) -> Result<Vec<Option<RayHit>>> {
        self.each(rays, t_range, |ray| Some(self.described(ray, self.caster.first(ray, t_range)?)))
    }

    /// For each ray all hits, in the order along it; those at the same t by id.
    ///
    /// # Errors
    /// As [`Caster::first`].
    pub fn all(&self, rays: &[[[f64; 3]; 2]], t_range: [f64; 2]) -> Result<Vec<Vec<RayHit>>> {
        let described =
            |ray: &Ray| self.caster.all(ray, t_range).into_iter().map(|hit| self.described(ray, hit)).collect();
        self.each(rays, t_range, described)
    }

    /// For each ray whether it meets anything.
    ///
    /// # Errors
    /// As [`Caster::first`].
    pub fn meets_any(&self, rays: &[[[f64; 3]; 2]], t_range: [f64; 2]) -> Result<Vec<bool>> {
        self.each(rays, t_range, |ray| self.caster.meets_any(ray, t_range))
    }

    /// Whether nothing is rounded in finding what a ray meets: all coordinates of it and of the scene but 0 have sizes from 1e-30 to 1e30; in
    /// a scene with spheres they, and all radii, from 1e-12 to 1e24.
    pub fn is_certain(&self, [origin, direction]: &[[f64; 3]; 2]) -> bool {
        let ray = Ray { origin: DVec3::from_array(*origin), direction: DVec3::from_array(*direction) };
        self.caster.is_exact(&ray)
    }

    /// What is found of each ray, which is checked first.
    fn each<T: Send>(
        &self,
        rays: &[[[f64; 3]; 2]],
        [from, to]: [f64; 2],
        find: impl Fn(&Ray) -> T + Sync,
    ) -> Result<Vec<T>> {
        if from.is_nan() || to.is_nan() || from > to {
            return Err(Error::input(format!("t_range is {from} to {to}; give the smaller end first")));
        }
        let rays = parallel::try_map(0..rays.len(), |k| checked(k, &rays[k]))?;
        Ok(self.caster.each(&rays, find))
    }

    fn described(&self, ray: &Ray, hit: Hit) -> RayHit {
        let (place, normal) = self.surface(ray, &hit);
        RayHit {
            t: hit.t,
            triangle: hit.triangle,
            object: self.ends.partition_point(|end| *end <= hit.triangle) as u32,
            bary: hit.bary,
            point: place.to_array(),
            normal: normal.to_array(),
        }
    }

    /// Place and normal.
    fn surface(&self, ray: &Ray, hit: &Hit) -> (DVec3, DVec3) {
        if let Some(round) = self.caster.round(hit.triangle) {
            return round.place_and_normal(ray, hit.t);
        }
        let [a, b, c] = self.mesh.triangles[hit.triangle as usize].map_each(|k| self.mesh.positions[k as usize]);
        let [u, v] = hit.bary;
        ((1.0 - u - v) * a + u * b + v * c, unit_normal(a, b, c))
    }
}

/// Also of triangles whose sides, multiplied, leave the range of f64.
fn unit_normal(a: DVec3, b: DVec3, c: DVec3) -> DVec3 {
    let (e1, e2) = (b - a, c - a);
    let size = |v: DVec3| v.abs().max_element();
    (e1 / size(e1)).cross(e2 / size(e2)).normalize_or_zero()
}

fn checked(k: usize, [origin, direction]: &[[f64; 3]; 2]) -> Result<Ray> {
    let ray = Ray { origin: DVec3::from_array(*origin), direction: DVec3::from_array(*direction) };
    match () {
        _ if !ray.origin.is_finite() => {
            Err(Error::input(format!("ray {k}: its origin is {}; use finite numbers", ray.origin)))
        }
        _ if !ray.direction.is_finite() || ray.direction == DVec3::ZERO => Err(Error::input(format!(
            "ray {k}: its direction is {}; use finite numbers that are not all 0",
            ray.direction
        ))),
        _ => Ok(ray),
    }
}
