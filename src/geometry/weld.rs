//! Vertices in the same place, which become one: those of triangles that have only corners, and others.

use crate::arrays::MapEach;
use crate::parallel;
use glam::DVec3;
use std::collections::HashMap;
use std::sync::atomic::{AtomicU32, Ordering};

/// A coordinate in the precision of its file.
pub(super) trait Number: Copy + Into<f64> + Send + Sync {}

impl Number for f32 {}
impl Number for f64 {}

/// Sets of corners; corners in the same place are in one of them. Threads take set by set. With more sets each pass uses fewer of the
/// corners in a line of a cache: 64 took half as long again.
const SETS: usize = 16;

/// The vertices of triangles, in the order of their first corners, and the vertices of each triangle.
pub(super) fn weld<T: Number>(corners: &[[[T; 3]; 3]]) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let all = corners.as_flattened();
    let place = |corner: u32| DVec3::from(all[corner as usize].map_each(Into::into));
    let first = first_in_place(all.len() as u32, place);
    let mut positions = Vec::new();
    let mut vertices = vec![[0; 3]; corners.len()];
    for (corner, first) in (0..).zip(first) {
        let vertex = match first == corner {
            true => {
                positions.push(place(corner));
                positions.len() as u32 - 1
            }
            // an earlier corner, whose vertex is known
            false => vertices.as_flattened()[first as usize],
        };
        vertices.as_flattened_mut()[corner as usize] = vertex;
    }
    (positions, vertices)
}

/// The bits of a place; 0 and -0 are one.
fn key(place: DVec3) -> [u64; 3] {
    (place + 0.0).to_array().map_each(f64::to_bits)
}

/// Of each corner, or vertex, the first one in the same place.
pub(super) fn first_in_place(count: u32, place: impl Fn(u32) -> DVec3 + Sync) -> Vec<u32> {
    let key = |corner: u32| key(place(corner));
    // corners in their order, list by list
    const LIST: u32 = 1 << 16;
    let lists = parallel::map(0..count.div_ceil(LIST), |k| {
        let mut sets = vec![Vec::new(); SETS];
        (k * LIST..count.min((k + 1) * LIST)).for_each(|corner| sets[set(key(corner))].push(corner));
        sets
    });
    let first: Vec<AtomicU32> = parallel::map(0..count, |_| AtomicU32::new(0));
    parallel::map(0..SETS, |set| {
        let mut known = HashMap::new();
        for corner in lists.iter().flat_map(|sets| &sets[set]) {
            let first_of_corner = *known.entry(key(*corner)).or_insert(*corner);
            first[*corner as usize].store(first_of_corner, Ordering::Relaxed);
        }
    });
    first.into_iter().map(AtomicU32::into_inner).collect()
}

/// The set of a place.
fn set([x, y, z]: [u64; 3]) -> usize {
    // an odd number without a pattern in its bits: 2^64 over the golden ratio
    const MIX: u64 = 0x9e37_79b9_7f4a_7c15;
    let mixed = [x, y, z].into_iter().fold(0u64, |all, bits| (all ^ bits).wrapping_mul(MIX).rotate_left(29));
    mixed as usize % SETS
}
