//! The reference that everything else is compared with: every pixel's rays and curves against every triangle, in f64, by the
//! definitions in `docs/reference/definitions.md`. It uses pixels, bundles and triangles only, no tiles and no kernels.
//!
//! * `intersect`: one ray and one triangle; signs are those of exact arithmetic (`exact`).
//! * `sphere`: one ray and one sphere.
//! * `curve`, `length`: one curve and one triangle, every root ([`crate::geometry::bernstein`]); arc lengths.
//! * `bvh`, `beam`: which triangles a ray, a curve, or all rays of a small box about one can meet.
//! * `lens`: rays of calibrated lenses, inverted independently of the camera.
//! * `path`, `answer`: a pixel's segments through all layers, and what they first meet.
//! * `margin`, `verdict`: whether the answer changes within 1/16 px of the centre, and what it may be.
//! * `cover`: proof that triangles which join without gaps leave no miss.
//! * `finding`: the same for whole paths: chains by the verdicts of their layers, curves by samples.
//! * `bounces`: rays through mirrors and lenses, by recursive ray tracing; also judged by samples.
//! * `caustics`: where a light's photons fall, and the light that this adds to a hit.
//! * `pictures`: pictures thrown onto surfaces, by the projection of each hit.
//! * `volume`: what a volume adds to the light along a path, and what it leaves of it.
//! * `image`, `light`, `explain`: whole frames, comparison of other frames, one pixel as text.

mod answer;
mod beam;
mod bounces;
mod bvh;
pub mod caustics;
mod composed;
mod cover;
mod curve;
mod dual;
#[cfg(any(feature = "cli", feature = "view"))]
mod explain;
mod finding;
pub mod gradient;
pub mod image;
mod intersect;
mod length;
mod lens;
mod light;
mod margin;
mod path;
mod pictures;
mod round;
mod tree;
mod verdict;
pub mod volume;

#[cfg(test)]
mod tests;

use crate::arrays::MapEach;
pub use bounces::Outcome;
pub use finding::Finding;
pub use margin::{GAP, MARGIN_PX};
pub use path::Path;
#[cfg(any(feature = "cli", feature = "view"))]
pub use path::Seen;
#[cfg(feature = "cli")]
pub use path::Segment;
pub use verdict::Verdict;

use crate::camera::Camera;
use crate::camera::bundle::Bundle;
use crate::camera::exposure::Sample;
use crate::camera::perturb::{END_REACH, scene_size};
use crate::geometry::instances::Instances;
use crate::geometry::mesh::Mesh;
use crate::geometry::opacity::Threshold;
use crate::geometry::primitive::Primitive;
use crate::geometry::time_steps::{Moment, MovingMesh, TimeSteps};
use crate::parallel;
use crate::scene::Scene;
use beam::Beam;
use bvh::{Bvh, Item};
use glam::DVec3;
use intersect::{Aim, Corners, T_ROUNDING};
use pictures::Pictures;
use round::Round;
use std::sync::Arc;
use tree::{PlacedMeshes, Tree};

/// The first hit of a ray on the mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// The ray parameter; relative error at most 1e-9.
    pub t: f64,
    /// The triangle's or sphere's id: its index in the mesh.
    pub triangle: u32,
    /// Barycentric weights of the triangle's second and third vertex; 0 of a sphere.
    pub bary: [f64; 2],
}

/// A mesh indexed for ray queries. If it moves, queries are answered for one moment.
#[derive(Debug, Clone)]
pub struct Reference<'a> {
    mesh: &'a Mesh,
    /// The places of the meshes in `mesh`, if they stand in several. Ids of triangles then count all places; [`Reference::own`] gives the
    /// triangle of `mesh`.
    instances: Option<&'a Instances>,
    /// Where it moves, and the moment.
    moving: Option<(&'a TimeSteps, Moment)>,
    /// The sample whose rays are asked for, and its pixel: blended surfaces differ from sample to sample.
    sample: Option<((u32, u32), Sample)>,
    /// Boxes of all moments.
    tree: Arc<Tree>,
    /// The mesh's size, by which rays are perturbed: [`crate::camera::perturb`].
    scene_size: f64,
    /// The camera has several layers: no hit is moved to an end of `t_range`.
    has_layers: bool,
    /// Those that are thrown onto it.
    pictures: Arc<Pictures<'a>>,
}

impl<'a> Reference<'a> {
    /// Indexes the mesh: finite positions, indices in range. Triangles with two corners in one place are
    /// left out: they are never hit.
    pub fn build(mesh: &'a Mesh) -> Reference<'a> {
        Reference::of_moving(mesh.into())
    }

    /// The same for the mesh of a scene, at its first moment if it moves.
    pub fn of_scene(scene: &'a Scene) -> Reference<'a> {
        let pictures = Arc::new(Pictures::of(scene));
        match (scene.mesh.instances(), &scene.steps) {
            (Some(instances), None) => Reference { pictures, ..Reference::of_instances(instances) },
            _ => Reference { pictures, ..Reference::of_moving(scene.moving_mesh()) },
        }
    }

    fn of_instances(instances: &'a Instances) -> Reference<'a> {
        let base = MovingMesh::from(&*instances.base);
        let tree = Arc::new(Tree::Placed(PlacedMeshes::new(instances, |id| item(base, id))));
        let scene_size = scene_size(instances.bounds());
        let mesh = &instances.base;
        Reference { instances: Some(instances), ..Reference::new(mesh, tree, scene_size) }
    }

    fn of_moving(all: MovingMesh<'a>) -> Reference<'a> {
        let items = parallel::flat_map(0..all.mesh.triangles.len() as u32, |id| item(all, id));
        let moving = all.steps.map(|steps| (steps, Moment::default()));
        let tree = Arc::new(Tree::Whole(Bvh::build(items)));
        Reference { moving, ..Reference::new(all.mesh, tree, scene_size(all.bounds())) }
    }

    /// Makes the reference of a still mesh in one place.
    fn new(mesh: &'a Mesh, tree: Arc<Tree>, scene_size: f64) -> Reference<'a> {
        let pictures = Arc::default();
        Reference { mesh, instances: None, moving: None, sample: None, tree, scene_size, has_layers: false, pictures }
    }

    /// The mesh as it is at a moment.
    pub fn at(&self, moment: Moment) -> Reference<'a> {
        Reference { moving: self.moving.map(|(steps, _)| (steps, moment)), ..self.clone() }
    }

    /// The mesh as a pixel of a camera sees it: at the moment of its exposure, and by its sample.
    pub fn at_pixel(&self, scene: &Scene, camera: &Camera, pixel: (u32, u32)) -> Reference<'a> {
        let sample = camera.sample.map(|sample| (pixel, sample));
        Reference { sample, has_layers: camera.layers.len() > 1, ..self.at(scene.moment(camera, pixel)) }
    }

    /// The visible hit of the bundle's central ray: the smallest `t` in `t_range` (ends inclusive), the
    /// lowest id among equals. `None` also if there is no ray: not finite, `d = 0` or `h = 0`.
    pub fn hit(&self, bundle: &Bundle, t_range: [f64; 2]) -> Option<Hit> {
        let mut best: Option<Hit> = None;
        self.each_hit_of_ray(bundle, t_range, |hit| {
            best = nearer(best, hit);
            best.map_or(f64::INFINITY, |b| past(b.t))
        });
        best
    }

    /// Distance from `p` along a unit direction to the nearest of the first `count` triangles and spheres, either face, up to `far`. Rays pass
    /// where a triangle is masked.
    fn blocked(&self, p: DVec3, direction: DVec3, far: f64, count: u32) -> Option<f64> {
        let zero = DVec3::ZERO;
        let bundle = Bundle { p: [p, zero, zero], d: [direction, zero, zero], h: [1.0, 0.0, 0.0] };
        let beam = Beam::over(&bundle, 0.0)?;
        let mut nearest = far;
        let mut is_met = false;
        self.tree.walk(self.instances, &beam, [0.0, far], |id| {
            let met: Vec<f64> = match self.round(id) {
                _ if id >= count => Vec::new(),
                Some(sphere) => sphere.meetings(&bundle).into_iter().flatten().collect(),
                None => {
                    let met = self.solid_corners(id).and_then(|c| intersect::meet(&Aim::straight(bundle), &c));
                    met.filter(|m| self.is_there(id, m.bary)).map(|m| m.t).into_iter().collect()
                }
            };
            for t in met {
                if (0.0..=nearest).contains(&t) {
                    (nearest, is_met) = (t, true);
                }
            }
            nearest
        });
        is_met.then_some(nearest)
    }

    /// Every visible hit of the bundle's central ray in `t_range`, mostly near to far. `visit` returns the
    /// largest `t` still of interest.
    fn each_hit_of_ray(&self, bundle: &Bundle, t_range: [f64; 2], mut visit: impl FnMut(Hit) -> f64) {
        let aimed = |b: Bundle| {
            let aim = Aim::new(b, self.scene_size);
            Beam::over(&aim.centre, aim.px).map(|beam| (aim, beam))
        };
        let Some((aim, beam)) = upright(bundle).and_then(aimed) else { return };
        let mut limit = f64::INFINITY;
        self.walk_in_range(&aim.centre, &beam, t_range, |id| {
            if let Some(hit) = self.hit_of(&aim, id, t_range) {
                limit = limit.min(visit(hit));
            }
            limit
        });
    }

    /// Every triangle that a ray of the beam may hit at a `t` in `t_range`, or at one that is moved to an end of it, mostly near to far.
    /// `visit` returns the largest `t` still of interest; hits behind it may still be moved to the start of `t_range`. `h > 0`.
    fn walk_in_range(&self, b: &Bundle, beam: &Beam, t_range: [f64; 2], mut visit: impl FnMut(u32) -> f64) {
        let moved = 2.0 * END_REACH * self.scene_size * b.h[0] / b.d[0].abs().element_sum();
        let range = [-past(-t_range[0]) - moved, past(t_range[1]) + moved];
        // a range without a start moves no hit there
        let start = if t_range[0].is_finite() { past(t_range[0]) + moved } else { t_range[0] };
        self.tree.walk(self.instances, beam, range, |id| visit(id).max(start));
    }

    /// The first visible hit of the central ray on one triangle or sphere, in range. A sphere is entered from outside and left from inside,
    /// where its back is seen.
    fn hit_of(&self, aim: &Aim, id: u32, t_range: [f64; 2]) -> Option<Hit> {
        if let Some(round) = self.round(id) {
            let [entered, left] = round.meetings(&aim.centre)?;
            let seen = [Some(entered), Some(left).filter(|_| self.two_sided(id))];
            let t = seen.into_iter().flatten().find(|t| t_range[0] <= *t && *t <= t_range[1])?;
            return Some(Hit { t, triangle: id, bary: [0.0; 2] });
        }
        let corners = self.solid_corners(id)?;
        let m = intersect::meet(aim, &corners)?;
        let seen = m.sign < 0 || self.two_sided(id);
        let end = || intersect::end_at(&aim.centre, &corners, m.t, t_range, self.scene_size);
        let t = if self.has_layers { m.t } else { end().unwrap_or(m.t) };
        let in_range = t_range[0] <= t && t <= t_range[1];
        let hit = Hit { t, triangle: id, bary: m.bary };
        (seen && in_range && self.is_there(hit.triangle, hit.bary)).then_some(hit)
    }

    fn corners(&self, id: u32) -> Corners {
        Corners::new(self.positions(id))
    }

    /// The primitive as it is at the moment.
    fn primitive(&self, id: u32) -> Primitive {
        Primitive::new(self.positions(id), self.mesh.radius(self.own(id)))
    }

    /// `None` of a triangle.
    fn round(&self, id: u32) -> Option<Round> {
        self.primitive(id).capsule().map(Round)
    }

    /// `None` of a sphere or capsule, and while two of them are in one place.
    fn solid_corners(&self, id: u32) -> Option<Corners> {
        Some(self.corners(id)).filter(|corners| !corners.is_degenerate())
    }

    /// The corners of a triangle about a hit at `p`, as the surface there; of a sphere or capsule that place.
    fn surface(&self, id: u32, p: DVec3) -> [DVec3; 3] {
        if let Primitive::Triangle(corners) = self.primitive(id) { corners } else { [p; 3] }
    }

    /// The corners of a triangle, in the order of its file.
    fn positions(&self, id: u32) -> [DVec3; 3] {
        let mesh = self.mesh;
        match (self.moving, self.instances) {
            (Some((steps, moment)), _) => mesh.triangles[id as usize].map_each(|v| steps.position_at(mesh, v, moment)),
            (None, Some(instances)) => instances.corners(id),
            (None, None) => mesh.triangles[id as usize].map_each(|v| mesh.positions[v as usize]),
        }
    }

    /// A normal of a triangle.
    fn normal(&self, id: u32, n: u32) -> DVec3 {
        match (self.moving, self.instances) {
            (Some((steps, moment)), _) => steps.normal_at(self.mesh, n, moment),
            (None, Some(instances)) => instances.find(id).0.placed_normal(self.mesh.normals[n as usize]).as_dvec3(),
            (None, None) => self.mesh.normals[n as usize].as_dvec3(),
        }
    }

    /// The number of triangles and spheres in all places.
    fn triangle_count(&self) -> usize {
        self.instances.map_or(self.mesh.triangles.len(), |instances| instances.triangle_count())
    }

    /// The triangle of `mesh` that has the surface of this one; ids of smooth surfaces, which come after all triangles, stay.
    fn own(&self, id: u32) -> u32 {
        match self.instances {
            Some(instances) if (id as usize) < instances.triangle_count() => instances.find(id).1,
            _ => id,
        }
    }

    /// A triangle without a material shows both faces.
    fn two_sided(&self, id: u32) -> bool {
        self.mesh.material(self.own(id)).is_none_or(|m| m.two_sided)
    }

    /// Whether the triangle has a surface at a place, seen by the sample.
    fn is_there(&self, id: u32, bary: [f64; 2]) -> bool {
        let threshold =
            self.sample.map_or(Threshold::HALF, |(pixel, s)| Threshold::of_sample(pixel, id, (s.number, s.count)));
        self.mesh.is_there(self.own(id), bary, threshold)
    }
}

/// The box of a triangle or sphere at all moments; `None` if it is never hit.
fn item(all: MovingMesh, id: u32) -> Option<Item> {
    if all.mesh.is_round(id) {
        let at = |step| Some(Round(all.primitive(id, step).capsule()?).bounds());
        let (lo, hi) = bvh::bounds((0..all.count()).filter_map(at));
        return Some(Item { lo, hi, id });
    }
    let corners = (0..all.count()).map(|step| Corners::new(all.corners(id, step)));
    let (lo, hi) = bvh::bounds(corners.clone().map(|corners| corners.bounds()));
    let is_there = all.count() > 1 || corners.clone().any(|corners| !corners.is_degenerate());
    is_there.then_some(Item { lo, hi, id })
}

/// The nearer hit; the lower id among equals.
fn nearer(best: Option<Hit>, hit: Hit) -> Option<Hit> {
    match best {
        Some(b) if (b.t, b.triangle) <= (hit.t, hit.triangle) => best,
        _ => Some(hit),
    }
}

/// The bundle with `h > 0` at its centre (the same rays), if it has a finite ray there.
fn upright(b: &Bundle) -> Option<Bundle> {
    let sign = b.h[0].signum();
    let b = Bundle { p: b.p.map_each(|v| v * sign), d: b.d.map_each(|v| v * sign), h: b.h.map_each(|v| v * sign) };
    let finite = b.p.iter().chain(&b.d).all(|v| v.is_finite()) && b.h.iter().all(|v| v.is_finite());
    (finite && b.h[0] > 0.0 && b.d[0] != DVec3::ZERO).then_some(b)
}

/// An upper bound on the exact `t` whose computed value is `t`.
fn past(t: f64) -> f64 {
    t + 2.0 * T_ROUNDING * t.abs()
}
