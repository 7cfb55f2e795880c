//! Triangles made ready for the kernels: chunks that fit a binding, in an order that keeps neighbours together.
//!
//! Positions are rebased to an anchor in f64 and stored as f32 pairs. Every triangle row names its corners in the
//! order of their positions, so an edge is the same number from both sides, seams with doubled vertices included.

use super::mesh::{Mesh, NO_NORMAL};
use crate::gpu::rows::{CLUSTER, Cluster, ID_BITS_MAX, NONE, ONE_SIDED, ORDER_SHIFT, split2};
use glam::DVec3;
use rayon::prelude::*;

/// Triangles `id_first .. id_first + id_count` of a scene, as the kernels read them.
#[derive(Debug, Clone, Default)]
pub struct Chunk {
    pub id_first: u32,
    pub id_count: u32,
    /// Three numbers a vertex relative to the anchor: the f32 nearest, and what it leaves.
    pub vertices_hi: Vec<f32>,
    pub vertices_lo: Vec<f32>,
    /// A row a slot: three vertices in the order of their positions; id, file order and sidedness.
    pub triangles: Vec<[u32; 4]>,
    /// A row a slot: the normals of the corners in file order, and the material.
    pub surfaces: Vec<[u32; 4]>,
    /// Slot of triangle `id_first + k`; [`NONE`] for triangles without area, which are never hit.
    pub slot_of_id: Vec<u32>,
    pub clusters: Vec<Cluster>,
}

/// Scene-wide facts about the chunks.
#[derive(Debug, Clone)]
pub struct Clustered {
    pub chunks: Vec<Chunk>,
    pub anchor: DVec3,
    /// Triangles without area, left out.
    pub without_area: usize,
}

/// Bytes of a triangle's rows and of a vertex in the largest single buffer that holds them.
const TRIANGLE_BYTES: u64 = 16;
const VERTEX_BYTES: u64 = 12;

/// Cuts a mesh into chunks none of whose buffers exceeds `binding_limit` bytes.
pub fn cluster(mesh: &Mesh, anchor: DVec3, binding_limit: u64) -> Clustered {
    let whole = mesh.triangles.len() as u64 * TRIANGLE_BYTES <= binding_limit
        && mesh.positions.len() as u64 * VERTEX_BYTES <= binding_limit;
    let per_chunk = if whole { mesh.triangles.len() as u64 } else { binding_limit / (3 * VERTEX_BYTES) };
    let count = mesh.triangles.len() as u64;
    let mut chunks: Vec<Chunk> = (0..count)
        .step_by(per_chunk.max(1) as usize)
        .map(|first| {
            let ids = first as u32..(first + per_chunk).min(count) as u32;
            chunk(mesh, anchor, ids, whole)
        })
        .collect();
    if chunks.is_empty() {
        // a scene without triangles still has a background to shade
        chunks.push(Chunk::default());
    }
    let slots: usize = chunks.iter().map(|c| c.triangles.len()).sum();
    Clustered { chunks, anchor, without_area: mesh.triangles.len() - slots }
}

fn chunk(mesh: &Mesh, anchor: DVec3, ids: std::ops::Range<u32>, whole: bool) -> Chunk {
    let order = morton_order(mesh, ids.clone());
    let mut chunk = Chunk { id_first: ids.start, id_count: ids.len() as u32, ..Default::default() };
    let index_of: Box<dyn Fn(u32) -> u32 + Sync> = if whole {
        chunk.store_vertices(mesh.positions.par_iter(), anchor);
        Box::new(|v| v)
    } else {
        let mut used: Vec<u32> = order.iter().flat_map(|&id| mesh.triangles[id as usize]).collect();
        used.par_sort_unstable();
        used.dedup();
        chunk.store_vertices(used.par_iter().map(|&v| &mesh.positions[v as usize]), anchor);
        // every vertex of the chunk is in the sorted list
        Box::new(move |v| used.partition_point(|&u| u < v) as u32)
    };
    chunk.triangles = order.par_iter().map(|&id| triangle_row(mesh, id, &*index_of)).collect();
    chunk.surfaces = order.par_iter().map(|&id| surface_row(mesh, id)).collect();
    chunk.slot_of_id = vec![NONE; ids.len()];
    for (slot, &id) in order.iter().enumerate() {
        chunk.slot_of_id[(id - ids.start) as usize] = slot as u32;
    }
    let groups: Vec<(usize, &[u32])> = order.chunks(CLUSTER as usize).enumerate().collect();
    chunk.clusters = groups.into_par_iter().map(|(k, ids)| cluster_row(mesh, anchor, k, ids)).collect();
    chunk
}

impl Chunk {
    fn store_vertices<'a>(&mut self, positions: impl IndexedParallelIterator<Item = &'a DVec3>, anchor: DVec3) {
        let pairs: Vec<[[f32; 2]; 3]> = positions.map(|p| (*p - anchor).to_array().map(split2)).collect();
        self.vertices_hi = pairs.iter().flat_map(|p| p.map(|v| v[0])).collect();
        self.vertices_lo = pairs.iter().flat_map(|p| p.map(|v| v[1])).collect();
    }
}

/// The triangles that have an area, along a Morton curve through their centroids.
fn morton_order(mesh: &Mesh, ids: std::ops::Range<u32>) -> Vec<u32> {
    let corners = |id: u32| mesh.triangles[id as usize].map(|v| mesh.positions[v as usize]);
    let bounds = ids
        .clone()
        .into_par_iter()
        .map(|id| corners(id).iter().sum::<DVec3>())
        .map(|c| (c, c))
        .reduce(|| (DVec3::INFINITY, DVec3::NEG_INFINITY), |a, b| (a.0.min(b.0), a.1.max(b.1)));
    let scale = ((1u64 << 21) as f64 - 1.0) / (bounds.1 - bounds.0).max_element().max(f64::MIN_POSITIVE);
    let mut keyed: Vec<(u64, u32)> = ids
        .into_par_iter()
        .filter(|&id| has_area(corners(id)))
        .map(|id| {
            let place = (corners(id).iter().sum::<DVec3>() - bounds.0) * scale;
            (spread(place.x) | spread(place.y) << 1 | spread(place.z) << 2, id)
        })
        .collect();
    keyed.par_sort_unstable();
    keyed.into_iter().map(|(_, id)| id).collect()
}

/// The low 21 bits of a number, two zero bits between each.
fn spread(place: f64) -> u64 {
    let mut x = place.max(0.0) as u64 & 0x1f_ffff;
    x = (x | x << 32) & 0x1f00000000ffff;
    x = (x | x << 16) & 0x1f0000ff0000ff;
    x = (x | x << 8) & 0x100f00f00f00f00f;
    x = (x | x << 4) & 0x10c30c30c30c30c3;
    (x | x << 2) & 0x1249249249249249
}

/// Three different positions that are not on a line, as f64 sees it.
fn has_area(corners: [DVec3; 3]) -> bool {
    let [a, b, c] = order_by_position(&corners).map(|k| corners[k]);
    a != b && b != c && (b - a).cross(c - a) != DVec3::ZERO
}

/// The corners' indices, ascending by x, then y, then z.
fn order_by_position(corners: &[DVec3; 3]) -> [usize; 3] {
    let less = |a: usize, b: usize| {
        let (p, q) = (corners[a], corners[b]);
        (p.x, p.y, p.z) < (q.x, q.y, q.z)
    };
    let mut k = [0, 1, 2];
    if less(k[1], k[0]) {
        k.swap(0, 1);
    }
    if less(k[2], k[1]) {
        k.swap(1, 2);
    }
    if less(k[1], k[0]) {
        k.swap(0, 1);
    }
    k
}

/// Where each file corner stands in a row, by order code: the table of `wgsl/shared/triangle.wgsl`.
pub const CORNER_ORDERS: [[usize; 3]; 6] = [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0], [1, 0, 2]];

fn triangle_row(mesh: &Mesh, id: u32, index_of: &(dyn Fn(u32) -> u32 + Sync)) -> [u32; 4] {
    let corners = mesh.triangles[id as usize];
    let sorted = order_by_position(&corners.map(|v| mesh.positions[v as usize]));
    // the place of file corner c in the row
    let place = [0, 1, 2].map(|c| sorted.iter().position(|&s| s == c).unwrap_or(0));
    let order = CORNER_ORDERS.iter().position(|o| *o == place).unwrap_or(0) as u32;
    let material = &mesh.materials[mesh.material_of[id as usize] as usize];
    let side = if material.two_sided { 0 } else { ONE_SIDED };
    let [a, b, c] = sorted.map(|s| index_of(corners[s]));
    debug_assert!(id < 1 << ID_BITS_MAX);
    [a, b, c, id | order << ORDER_SHIFT | side]
}

fn surface_row(mesh: &Mesh, id: u32) -> [u32; 4] {
    let [a, b, c] = mesh.corner_normals.get(id as usize).copied().unwrap_or([NO_NORMAL; 3]);
    [a, b, c, mesh.material_of[id as usize]]
}

fn cluster_row(mesh: &Mesh, anchor: DVec3, index: usize, ids: &[u32]) -> Cluster {
    let positions = ids.iter().flat_map(|&id| mesh.triangles[id as usize]).map(|v| mesh.positions[v as usize] - anchor);
    let (lo, hi) = positions.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(lo, hi), p| (lo.min(p), hi.max(p)));
    let (centre, half) = ((lo + hi) / 2.0, (hi - lo) / 2.0);
    // f32 rounding of the box and of what kernels compute from it: 2^-22 of the largest coordinate, 4 roundings
    let slack = (centre.abs() + half).max_element() * CLUSTER_SLACK;
    Cluster {
        centre: centre.as_vec3().to_array(),
        first: (index * CLUSTER as usize) as u32,
        half: (half + slack).as_vec3().to_array(),
        count: ids.len() as u32,
    }
}

const CLUSTER_SLACK: f64 = 1.0 / (1u64 << 22) as f64;
