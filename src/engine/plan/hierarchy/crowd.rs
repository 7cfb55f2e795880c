//! Binary hierarchies over boxes, many of which may share a center.
//!
//! Boxes with one center give the builder nothing to sort by: the hierarchy becomes as deep as there are boxes, and building it takes the
//! square of their number. Depth cameras write such boxes: points without a depth all lie at the origin. A crowd is therefore spread out:
//! the hierarchy is built over points on a grid about the center, and fitted to the boxes afterwards.

use crate::parallel;
use glam::{Vec3, Vec3A};
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use std::time::Duration;

/// As many boxes with one center are a crowd; the builder copes with fewer.
const CROWD: usize = 64;

/// Smallest size of the grid, in units of the scene: 64 cells of 16 roundings of an f32 next to 1.
const GRID_MIN: f32 = 64.0 * 16.0 * f32::EPSILON;

/// Builds a hierarchy.
pub fn build(boxes: &[Aabb], params: BvhBuildParams) -> Bvh2 {
    let crowds = crowds(boxes);
    if crowds.is_empty() {
        return build_bvh2(boxes, params, &mut Duration::default());
    }
    let mut spread = boxes.to_vec();
    for crowd in crowds {
        let half_size = |k: &u32| boxes[*k as usize].diagonal().max_element() / 2.0;
        let size = crowd.iter().map(half_size).fold(GRID_MIN, f32::max);
        let side = (crowd.len() as f32).cbrt().ceil();
        for (rank, k) in crowd.iter().enumerate() {
            let rank = rank as f32;
            let cell = Vec3::new(rank % side, (rank / side).floor() % side, (rank / (side * side)).floor());
            let point = boxes[*k as usize].center() + Vec3A::from(cell / side - 0.5) * size;
            spread[*k as usize] = Aabb::from_point(point);
        }
    }
    let mut tree = build_bvh2(&spread, params, &mut Duration::default());
    fit(&mut tree, boxes);
    tree
}

/// Fits a hierarchy to other boxes of its items.
pub fn fit(tree: &mut Bvh2, boxes: &[Aabb]) {
    let order = &tree.primitive_indices;
    parallel::for_each_mut(&mut tree.nodes, |_, node| {
        if !node.is_leaf() {
            return;
        }
        let own = &order[node.first_index as usize..][..node.prim_count as usize];
        if let Some(around) = own.iter().map(|k| boxes[*k as usize]).reduce(|a, b| a.union(&b)) {
            node.set_aabb(around);
        }
    });
    tree.refit_all();
}

/// The indices of boxes with one center, where they are many.
fn crowds(boxes: &[Aabb]) -> Vec<Vec<u32>> {
    if boxes.len() < CROWD {
        return Vec::new();
    }
    let key = |k: u32| {
        let center = boxes[k as usize].center().to_array();
        // + 0.0: both zeros are one number
        center
            .into_iter()
            .fold(0_u64, |key, x| (key ^ u64::from((x + 0.0).to_bits())).wrapping_mul(0x9E37_79B9_7F4A_7C15))
    };
    let mut keys: Vec<(u64, u32)> = parallel::map(0..boxes.len() as u32, |k| (key(k), k));
    parallel::sort(&mut keys);
    let large = keys.chunk_by(|a, b| a.0 == b.0).filter(|crowd| crowd.len() >= CROWD);
    large.map(|crowd| crowd.iter().map(|(_, k)| *k).collect()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Without the grid, 20,000 boxes take 15 seconds, and 50,000 overflow the stack.
    #[test]
    fn a_crowd_makes_a_shallow_hierarchy_that_holds_it() {
        for size in [0.0, 0.25] {
            let box_of = |k: u32| {
                let half = Vec3A::splat(size * (k % 7) as f32);
                Aabb { min: Vec3A::splat(0.5) - half, max: Vec3A::splat(0.5) + half }
            };
            let mut boxes: Vec<Aabb> = (0..50_000).map(box_of).collect();
            boxes.extend((0..100).map(|k| Aabb::from_point(Vec3A::new(k as f32 / 100.0, 0.0, 0.0))));
            let tree = build(&boxes, BvhBuildParams::medium_build());
            assert!(tree.depth(0) < 64, "{}", tree.depth(0));
            let mut found = vec![false; boxes.len()];
            let mut left = vec![0];
            while let Some(k) = left.pop() {
                let node = tree.nodes[k as usize];
                let holds = |inner: &Aabb| node.aabb().union(inner) == *node.aabb();
                if node.is_leaf() {
                    for k in &tree.primitive_indices[node.first_index as usize..][..node.prim_count as usize] {
                        assert!(holds(&boxes[*k as usize]));
                        found[*k as usize] = true;
                    }
                } else {
                    let below = [node.first_index, node.first_index + 1];
                    assert!(below.iter().all(|k| holds(tree.nodes[*k as usize].aabb())));
                    left.extend(below);
                }
            }
            assert!(found.iter().all(|f| *f));
        }
    }
}
