//! The two hierarchies over triangles, that of the reference and that of cameras, against all triangles one by one: on rays anywhere,
//! through edges and through corners.

use crate::common;

use anamorph::internals::camera::Bundle;
use anamorph::internals::camera::perturb::scene_size;
use anamorph::internals::geometry::cast::Caster;
use anamorph::internals::geometry::generate::{icosphere, soup};
use anamorph::internals::geometry::mesh::Mesh;
use anamorph::internals::reference::Reference;
use common::rng::Rng;
use glam::DVec3;
use rayon::prelude::*;

/// Rays at each mesh.
const RAYS: u64 = 500_000;

/// Weights and t are off by less: these meshes and rays are of size 1, and no triangle is seen flatter than this allows, but for those that
/// [`FLAT`] leaves open.
const TOLERANCE: f64 = 1e-9;

/// Cosine between a ray and a plane below which rounding may come to [`TOLERANCE`]: 2^-52 of size 10 over it.
const FLAT: f64 = 1e-5;

/// Where a ray first meets a mesh: t, the triangle, and the weights of its second and third corner.
type First = Option<(f64, u32, [f64; 2])>;

/// A ray from about the mesh: a third each to anywhere, to a point of an edge, and to a corner.
fn ray(mesh: &Mesh, seed: u64) -> Bundle {
    let mut rng = Rng(seed);
    let [a, b, c] = mesh.triangles[rng.below(mesh.triangles.len())].map(|k| mesh.positions[k as usize]);
    let to = match seed % 3 {
        0 => 0.7 * rng.vector(),
        // halves and quarters of an edge are often exact
        1 => a.lerp(b, 0.25 * rng.below(5) as f64),
        _ => c,
    };
    // rays along axes meet whole edges of generated meshes
    let from = match rng.below(4) {
        0 => to + 4.0 * [DVec3::X, DVec3::Y, DVec3::Z][rng.below(3)],
        _ => 3.0 * rng.vector(),
    };
    Bundle { p: [from, DVec3::ZERO, DVec3::ZERO], d: [to - from, DVec3::ZERO, DVec3::ZERO], h: [1.0, 0.0, 0.0] }
}

/// What is wrong with an answer, by all triangles one by one: one that the ray meets for sure must not be missed, and one that it misses
/// for sure must not be met.
fn fault(mesh: &Mesh, ray: &Bundle, first: First) -> Option<&'static str> {
    let (p, d) = (ray.p[0], ray.d[0]);
    let mut sure = f64::INFINITY;
    let mut is_candidate = first.is_none();
    for (k, corners) in (0..).zip(&mesh.triangles) {
        let [a, b, c] = corners.map(|k| mesh.positions[k as usize]);
        // Moeller and Trumbore 1997
        let (e1, e2) = (b - a, c - a);
        let across = d.cross(e2);
        let volume = e1.dot(across);
        let is_flat = volume.abs() < FLAT * d.length() * e1.cross(e2).length();
        let from = p - a;
        let (u, v) = (from.dot(across) / volume, d.dot(from.cross(e1)) / volume);
        let t = e2.dot(from.cross(e1)) / volume;
        let least = u.min(v).min(1.0 - u - v);
        if !is_flat && least > TOLERANCE && t > TOLERANCE {
            sure = sure.min(t);
        }
        if let Some((found, _, weights)) = first.filter(|f| f.1 == k) {
            let same = |x: f64, y: f64| (x - y).abs() <= TOLERANCE * (1.0 + y.abs());
            let at = same(found, t) && same(weights[0], u.clamp(0.0, 1.0)) && same(weights[1], v.clamp(0.0, 1.0));
            is_candidate = is_flat || least >= -TOLERANCE && at;
        }
    }
    match first {
        None if sure.is_finite() => Some("a triangle is missed"),
        Some((t, ..)) if t > sure + TOLERANCE * (1.0 + sure) => Some("a nearer triangle is missed"),
        _ if !is_candidate => Some("what is met is not there"),
        _ => None,
    }
}

/// Both hierarchies over `mesh`, which is all of `truth` or what is left of it: of some rays how many have a fault by each, and how many
/// are answered differently.
fn faults(truth: &Mesh, mesh: &Mesh, count: u64) -> [usize; 3] {
    let size = scene_size(mesh.bounds());
    let range = [0.0, f64::INFINITY];
    let (caster, reference) = (Caster::new(mesh), Reference::build(mesh));
    let faults = |seed: u64| {
        let ray = ray(truth, seed);
        let cast = caster.first(&ray.aim(size)?, range).map(|h| (h.t, h.triangle, h.bary));
        let hit = reference.hit(&ray, range).map(|h| (h.t, h.triangle, h.bary));
        let wrong = [cast, hit].map(|first| usize::from(fault(truth, &ray, first).is_some()));
        Some([wrong[0], wrong[1], usize::from(cast != hit)])
    };
    let sum = |a: [usize; 3], b: [usize; 3]| [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
    (0..count).into_par_iter().filter_map(faults).reduce(|| [0; 3], sum)
}

fn meshes() -> [Mesh; 2] {
    [icosphere(1), soup(7, 60)]
}

#[test]
fn both_hierarchies_answer_as_all_triangles_one_by_one() {
    for mesh in meshes() {
        assert_eq!(faults(&mesh, &mesh, RAYS), [0; 3]);
    }
}

/// The test above would notice: four neighbouring triangles, a leaf, are left out.
#[test]
fn a_missing_leaf_is_noticed() {
    for mesh in meshes() {
        let mut rest = mesh.clone();
        // two corners in one place: no hierarchy holds them
        rest.triangles[8..12].iter_mut().for_each(|t| t[1] = t[0]);
        let [cast, hit, _] = faults(&mesh, &rest, RAYS / 100);
        assert!(cast > 0 && hit > 0, "{cast} {hit}");
    }
}
