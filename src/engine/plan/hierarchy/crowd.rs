//! Binary hierarchies over boxes, many of which may share a center, or lie on one line.
//!
//! Boxes with one center give the builder nothing to sort by: the hierarchy becomes as deep as there are boxes, and building it takes the
//! square of their number. Depth cameras write such boxes: points without a depth all lie at the origin. A crowd is therefore spread out:
//! the hierarchy is built over points about the center, and fitted to the boxes afterwards. So it is with boxes without area, as those of
//! triangles on an axis: the builder compares areas, and all boxes around such boxes have none. They are built over as thin boxes.

use crate::arrays::MapEach;
use crate::parallel;
use glam::Vec3A;
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use std::time::Duration;

/// As many boxes with one center, or without area, are a crowd; the builder copes with fewer.
const CROWD: usize = 64;

/// Smallest size of the cube of these points, and half the thickness of thin boxes, in units of the scene: 1024 roundings of an f32 next to 1.
const CUBE_MIN: f32 = 1024.0 * f32::EPSILON;

/// Points evenly spread over the unit cube: multiples of powers of 1/x, without their whole parts, with x the root of x^4 = x + 1. Distances
/// between them differ, unlike those of a grid, whose ties make the builder join one box at a time.
const STEPS: [f64; 3] = [0.819_172_513_396_164_4, 0.671_043_606_703_789_2, 0.549_700_477_901_970_3];

/// Builds a hierarchy.
pub fn build(boxes: &[Aabb], params: BvhBuildParams) -> Bvh2 {
    let crowds = crowds(boxes);
    let is_flat = |b: &Aabb| b.half_area() == 0.0;
    if crowds.is_empty() && boxes.iter().filter(|b| is_flat(b)).count() < CROWD {
        return build_bvh2(boxes, params, &mut Duration::default());
    }
    let thin = Vec3A::splat(CUBE_MIN);
    let thickened = |b: &Aabb| if is_flat(b) { Aabb { min: b.min - thin, max: b.max + thin } } else { *b };
    let mut spread: Vec<Aabb> = boxes.iter().map(thickened).collect();
    for crowd in crowds {
        let half_size = |k: &u32| boxes[*k as usize].diagonal().max_element() / 2.0;
        let size = crowd.iter().map(half_size).fold(CUBE_MIN, f32::max);
        for (rank, k) in crowd.iter().enumerate() {
            let place = STEPS.map_each(|step| (rank as f64 * step).fract() as f32 - 0.5);
            let point = boxes[*k as usize].center() + Vec3A::from(place) * size;
            spread[*k as usize] = Aabb { min: point - thin, max: point + thin };
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

    /// Without the points, 20,000 boxes take 15 seconds, and 50,000 overflow the stack.
    #[test]
    fn crowds_and_lines_make_shallow_hierarchies_that_hold_them() {
        for size in [0.0, 0.25] {
            let box_of = |k: u32| {
                let half = Vec3A::splat(size * (k % 7) as f32);
                Aabb { min: Vec3A::splat(0.5) - half, max: Vec3A::splat(0.5) + half }
            };
            let mut boxes: Vec<Aabb> = (0..50_000).map(box_of).collect();
            boxes.extend((0..20_000).map(|k| Aabb::from_point(Vec3A::new(k as f32 / 20_000.0, 0.0, 0.0))));
            let tree = build(&boxes, BvhBuildParams::medium_build());
            // each level halves what is left, or does half as well as that
            assert!(tree.depth(0) <= 2 * boxes.len().ilog2() as usize, "{}", tree.depth(0));
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
