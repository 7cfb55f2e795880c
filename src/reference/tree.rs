//! What queries walk: a hierarchy over all triangles; or one over the places where meshes stand, and one over the triangles of each mesh.

use super::bvh::{Bvh, Item, Probe};
use crate::geometry::instances::{Instance, Instances};

/// Hierarchies over the triangles of a scene.
#[derive(Debug)]
pub enum Tree {
    Whole(Bvh),
    Placed(PlacedMeshes),
}

/// Hierarchies over places and over the triangles of each mesh, in its own coordinates.
#[derive(Debug)]
pub struct PlacedMeshes {
    places: Bvh,
    meshes: Vec<Bvh>,
    /// The mesh at each place.
    mesh_at: Vec<usize>,
}

impl PlacedMeshes {
    /// `item` gives the box of a triangle of the base mesh; `None` if it is never hit.
    pub fn new(instances: &Instances, item: impl Fn(u32) -> Option<Item>) -> PlacedMeshes {
        let (firsts, mesh_at) = instances.meshes();
        let hierarchy = |first: &&Instance| Bvh::build(first.triangles.clone().filter_map(&item).collect());
        let meshes = firsts.iter().map(hierarchy).collect();
        let boxed = |(id, (lo, hi))| Item { lo, hi, id };
        let is_there = |item: &Item| item.lo.cmple(item.hi).all();
        let places = (0..).zip(instances.boxes()).map(boxed).filter(is_there);
        PlacedMeshes { places: Bvh::build(places.collect()), meshes, mesh_at }
    }
}

impl Tree {
    /// As [`Bvh::walk`]; `instances` are those that the tree was made of.
    pub fn walk(
        &self,
        instances: Option<&Instances>,
        probe: &impl Probe,
        range: [f64; 2],
        mut visit: impl FnMut(u32) -> f64,
    ) {
        let (placed, instances) = match (self, instances) {
            (Tree::Placed(placed), Some(instances)) => (placed, instances),
            (Tree::Whole(bvh), _) => return bvh.walk(probe, range, visit),
            _ => return,
        };
        let [t_min, mut t_max] = range;
        placed.places.walk(probe, range, |place| {
            let instance = &instances.list[place as usize];
            let in_world = |corners| instance.placed_box(corners);
            placed.meshes[placed.mesh_at[place as usize]].walk_boxes(probe, in_world, [t_min, t_max], |own| {
                t_max = t_max.min(visit(own - instance.triangles.start + instance.first_id));
                t_max
            });
            t_max
        });
    }
}
