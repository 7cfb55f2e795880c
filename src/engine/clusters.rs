//! Triangles made ready for the kernels: chunks that fit a binding, in an order that keeps neighbours together.
//!
//! Positions are rebased to an anchor in f64 and stored as f32 pairs. Every triangle names its corners in the
//! order of their positions, so an edge is the same number from both sides, seams with doubled vertices included.

pub mod instances;
pub mod moved;
pub mod surfaces;

use crate::arrays::MapEach;
use crate::geometry::instances::Instances;
use crate::geometry::mesh::Mesh;
use crate::geometry::primitive::{Capsule, Primitive};
use crate::geometry::time_steps::MovingMesh;
use crate::gpu::kernels::{SurfaceKind, Variant};
use crate::gpu::layout::{
    CAPSULE, CLUSTER, Cluster, ID_MASK, NONE, ONE_SIDED, ORDER_SHIFT, SPHERE, TRIANGLE_GROUP, Vertex, split2,
};
use crate::parallel;
use crate::scene::Scene;
use glam::DVec3;
use instances::PlacedMeshes;
use moved::Moved;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Triangles `id_first .. id_first + id_count` of a scene, as the kernels read them.
#[derive(Debug, Clone, Default)]
pub struct Chunk {
    pub id_first: u32,
    pub id_count: u32,
    /// All time steps of a vertex together; empty but in [`Chunk::with_vertices`].
    pub vertices: Vec<Vertex>,
    /// Per slot: three vertices in the order of their positions; id, file order and sidedness. Of a sphere: the vertex in its centre, its
    /// radius as two f32, and its id, [`SPHERE`] and sidedness.
    pub triangles: Arc<Vec<[u32; 4]>>,
    /// Slot of triangle `id_first + k`; [`NONE`] for triangles without area, which are never hit, and for spheres that are out of view.
    pub slot_of_id: Arc<Vec<u32>>,
    /// Time steps of each vertex; 1 if nothing moves during a frame.
    pub steps: u32,
    /// The boxes of clusters, and of their triangle groups, in the world. The last cluster's groups may be empty.
    boxes: Arc<[Vec<Bounds>; 2]>,
    /// The scene's vertices that it has, ascending; `None`: all.
    used: Option<Arc<Vec<u32>>>,
    /// How large the boxes of its clusters were together when triangles were put in these.
    clustered_size: f64,
}

/// Scene-wide facts about the chunks.
#[derive(Debug, Clone)]
pub struct Clustered {
    pub chunks: Vec<Chunk>,
    /// Origin of the stored positions, world units.
    pub anchor: DVec3,
    /// Identity of the triangles and their places in the world; copies about other anchors share it.
    pub places: Arc<()>,
    /// Identity of the order in which triangles lie in chunks: placements of the same triangles share it.
    pub slots: Arc<()>,
    /// The changes against an earlier placement, where these are known.
    pub moved: Option<Moved>,
    /// The tables that surfaces have.
    pub surfaces: SurfaceKind,
    /// Triangles without area, left out.
    pub without_area: usize,
    /// The meshes and their places, if the tables hold each mesh once. Vertices are then relative to the origin of their mesh, not to the
    /// anchor.
    pub placed: Option<Arc<PlacedMeshes>>,
}

/// Bytes of a triangle and of a vertex in the largest table that holds them: where images lie, or what trace tests; with colours that of
/// surfaces.
const TRIANGLE_BYTES: u64 = 48;
const COLORED_TRIANGLE_BYTES: u64 = 80;
const VERTEX_BYTES: u64 = size_of::<Vertex>() as u64;

/// Splits a mesh into chunks none of whose tables exceeds `table_limit` bytes; `surfaces` says which tables there are.
#[cfg(any(test, feature = "internals"))]
pub fn cluster<'a>(
    all: impl Into<MovingMesh<'a>>,
    anchor: DVec3,
    surfaces: SurfaceKind,
    table_limit: u64,
) -> Clustered {
    clustered(all.into(), anchor, (surfaces, true), table_limit)
}

/// Clusters the triangles of a scene for the kernels of a variant: each mesh once if the kernels know of places, or else as [`cluster_shown`] does.
pub fn cluster_scene(scene: &Scene, anchor: DVec3, variant: Variant, table_limit: u64) -> Clustered {
    match scene.mesh.instances().filter(|_| variant.is_instanced()) {
        Some(instances) => PlacedMeshes::clustered(instances, anchor, variant.surfaces()),
        None => cluster_shown(scene.moving_mesh(), anchor, variant, table_limit),
    }
}

/// Splits what kernels of a variant know of a mesh into such chunks. They leave spheres out where none is in view.
pub fn cluster_shown<'a>(
    all: impl Into<MovingMesh<'a>>,
    anchor: DVec3,
    variant: Variant,
    table_limit: u64,
) -> Clustered {
    clustered(all.into(), anchor, (variant.surfaces(), variant.has_round()), table_limit)
}

fn clustered(
    all: MovingMesh,
    anchor: DVec3,
    (surfaces, has_spheres): (SurfaceKind, bool),
    table_limit: u64,
) -> Clustered {
    let mesh = all.mesh;
    let surface_bytes = bytes_a_triangle(surfaces);
    let steps = u64::from(all.count());
    // trace tests a triangle at the two ends of each of its ways
    let traced_bytes = if steps > 1 { 2 * (steps - 1) * TRIANGLE_BYTES } else { TRIANGLE_BYTES };
    let (triangle_bytes, vertex_bytes) = (surface_bytes.max(traced_bytes), steps * VERTEX_BYTES);
    let whole = mesh.triangles.len() as u64 * triangle_bytes <= table_limit
        && mesh.positions.len() as u64 * vertex_bytes <= table_limit;
    let per_chunk =
        if whole { mesh.triangles.len() as u64 } else { table_limit / triangle_bytes.max(3 * vertex_bytes) };
    let count = mesh.triangles.len() as u64;
    let mut chunks: Vec<Chunk> = (0..count)
        .step_by(per_chunk.max(1) as usize)
        .map(|first| {
            let ids = first as u32..(first + per_chunk).min(count) as u32;
            chunk(all, ids, (whole, has_spheres))
        })
        .collect();
    if chunks.is_empty() {
        // a scene without triangles still has a background to shade
        chunks.push(Chunk::default());
    }
    let slots: usize = chunks.iter().map(|c| c.triangles.len()).sum();
    let hidden = if has_spheres { 0 } else { mesh.round_counts().iter().sum() };
    let without_area = mesh.triangles.len() - hidden - slots;
    let [places, slots] = Default::default();
    Clustered { chunks, anchor, places, slots, moved: None, surfaces, without_area, placed: None }
}

/// Bytes of a triangle in the table of surfaces.
fn bytes_a_triangle(surfaces: SurfaceKind) -> u64 {
    if surfaces == SurfaceKind::Colored { COLORED_TRIANGLE_BYTES } else { TRIANGLE_BYTES }
}

fn chunk(all: MovingMesh, ids: std::ops::Range<u32>, (whole, has_spheres): (bool, bool)) -> Chunk {
    let mesh = all.mesh;
    let mut order = morton_order(all, ids.clone());
    if !has_spheres {
        order.retain(|id| !mesh.is_round(*id));
    }
    let mut chunk = Chunk { id_first: ids.start, id_count: ids.len() as u32, steps: all.count(), ..Default::default() };
    if !whole {
        chunk.used = Some(Arc::new(used_vertices(mesh, &order)));
    }
    let mut slot_of_id = vec![NONE; ids.len()];
    for (slot, &id) in order.iter().enumerate() {
        slot_of_id[(id - ids.start) as usize] = slot as u32;
    }
    chunk.slot_of_id = Arc::new(slot_of_id);
    chunk.triangles = Arc::new(parallel::map(&order, |&id| [0, 0, 0, id | side(mesh, id)]));
    chunk.place(all, |_| true);
    chunk.clustered_size = chunk.size();
    chunk
}

impl Clustered {
    /// The same triangles where their vertices are now, each in the cluster where it was. `false` where they are to be clustered anew:
    /// a triangle has got or lost its area, or the boxes have grown by half.
    pub fn refit(&mut self, mesh: &Mesh) -> bool {
        let lies_flat = |chunk: &Chunk| {
            let slot = |id: u32| chunk.slot_of_id[(id - chunk.id_first) as usize];
            let ids = chunk.id_first..chunk.id_first + chunk.id_count;
            !parallel::any(ids, |id| slot(id) == NONE && has_area(mesh.into(), id))
        };
        (self.places, self.moved) = (Arc::default(), None);
        self.chunks.iter_mut().all(|chunk| {
            (self.without_area == 0 || lies_flat(chunk))
                && chunk.place(mesh.into(), |_| true)
                && chunk.size() <= GROWN_MAX * chunk.clustered_size
        })
    }
}

impl Clustered {
    /// Returns a copy of the triangles about another anchor.
    pub fn anchored(&self, anchor: DVec3) -> Clustered {
        Clustered { anchor, moved: None, ..self.clone() }
    }

    /// Returns the clusters of these meshes at the places of `instances`; `None` if `instances` are of other meshes.
    pub fn placed_at(&self, instances: &Arc<Instances>) -> Option<Clustered> {
        let placed = self.placed.as_ref()?.moved(instances)?;
        Some(Clustered { placed: Some(Arc::new(placed)), places: Arc::default(), moved: None, ..self.clone() })
    }

    /// The mesh that the tables are made of.
    pub fn mesh<'a>(&'a self, scene: &'a Scene) -> MovingMesh<'a> {
        self.placed.as_ref().map_or_else(|| scene.moving_mesh(), |placed| (&*placed.instances.base).into())
    }

    /// Returns a copy whose chunks have their vertices.
    #[cfg(any(test, feature = "internals"))]
    pub fn with_vertices(&self, mesh: &Mesh) -> Clustered {
        let chunks = self.chunks.iter().map(|chunk| chunk.with_vertices(mesh.into(), self.anchor)).collect();
        Clustered { chunks, ..self.clone() }
    }
}

/// Triangle groups of a cluster.
const TRIANGLE_GROUPS: usize = (CLUSTER / TRIANGLE_GROUP) as usize;

const EMPTY: Cluster = Cluster { centre: [0.0; 3], first: 0, half: [0.0; 3], count: 0 };

/// Beyond it, boxes have grown too much for triangles to stay in them.
const GROWN_MAX: f64 = 1.5;

impl Chunk {
    /// All that depends on positions, of the triangles in the slots of the clusters that `changes` names; whether each of these has an area.
    fn place(&mut self, all: MovingMesh, changes: impl Fn(usize) -> bool + Sync) -> bool {
        let (first, indices) = self.used.as_ref().map_or((0, Vec::new()), |used| vertex_indices(used));
        // every vertex of the chunk is in the list, if there is one
        let index_of = |v: u32| if indices.is_empty() { v } else { indices[(v - first) as usize] };
        let triangles = Arc::make_mut(&mut self.triangles);
        let [clusters, groups] = Arc::make_mut(&mut self.boxes);
        clusters.resize(triangles.len().div_ceil(CLUSTER as usize), Bounds::NONE);
        groups.resize(clusters.len() * TRIANGLE_GROUPS, Bounds::NONE);
        let each = triangles.chunks_mut(CLUSTER as usize).zip(groups.chunks_mut(TRIANGLE_GROUPS)).zip(clusters);
        let all_have_area = AtomicBool::new(true);
        parallel::for_each(each.enumerate(), |(k, ((triangles, groups), cluster))| {
            if !changes(k) {
                return;
            }
            let have_area = place_cluster(triangles, groups, all, &index_of);
            *cluster = groups.iter().fold(Bounds::NONE, |whole, group| whole.joined(*group));
            all_have_area.fetch_and(have_area, Ordering::Relaxed);
        });
        all_have_area.into_inner()
    }

    /// Returns the vertices relative to an anchor, all time steps of a vertex together. They are made when they are uploaded, and not kept.
    pub fn vertices(&self, all: MovingMesh, anchor: DVec3) -> Vec<Vertex> {
        let used = self.used.as_ref().map(|used| used.as_slice());
        let (count, steps) = (used.map_or(all.mesh.positions.len(), <[u32]>::len), all.count() as usize);
        parallel::map(0..count * steps, |k| {
            let (k, step) = (k / steps, (k % steps) as u32);
            Vertex::new(all.position(used.map_or(k as u32, |used| used[k]), step) - anchor)
        })
    }

    /// Returns a copy that has its vertices, relative to an anchor.
    pub fn with_vertices(&self, all: MovingMesh, anchor: DVec3) -> Chunk {
        Chunk { vertices: self.vertices(all, anchor), ..self.clone() }
    }

    /// Returns the number of clusters.
    pub fn cluster_count(&self) -> usize {
        self.boxes[0].len()
    }

    /// Returns the clusters, relative to an anchor. They are made when they are uploaded, and not kept.
    pub fn clusters(&self, anchor: DVec3) -> Vec<Cluster> {
        self.packed(&self.boxes[0], CLUSTER as usize, anchor)
    }

    /// Returns the triangle groups of each cluster in the same way.
    pub fn triangle_groups(&self, anchor: DVec3) -> Vec<Cluster> {
        self.packed(&self.boxes[1], TRIANGLE_GROUP as usize, anchor)
    }

    /// Returns boxes of so many slots each, relative to an anchor.
    fn packed(&self, boxes: &[Bounds], each: usize, anchor: DVec3) -> Vec<Cluster> {
        parallel::map(0..boxes.len(), |k| {
            let slots = self.triangles.len().min((k + 1) * each).saturating_sub(k * each);
            if slots == 0 { EMPTY } else { boxes[k].packed(anchor, k * each, slots) }
        })
    }

    /// Of all boxes together.
    fn size(&self) -> f64 {
        self.boxes[0].iter().map(|cluster| (cluster.hi - cluster.lo).element_sum()).sum()
    }
}

/// Puts the triangles of a cluster where their vertices are, and the boxes of its groups around them; whether each has an area.
fn place_cluster(
    triangles: &mut [[u32; 4]],
    groups: &mut [Bounds],
    all: MovingMesh,
    index_of: &impl Fn(u32) -> u32,
) -> bool {
    let mut have_area = true;
    for (group, triangles) in groups.iter_mut().zip(triangles.chunks_mut(TRIANGLE_GROUP as usize)) {
        *group = Bounds::NONE;
        for triangle in triangles {
            let id = triangle[3] & ID_MASK;
            let primitive = all.primitive(id, 0);
            *triangle = match primitive {
                Primitive::Round(Capsule { radius, .. }) => {
                    *group = group.with(&primitive.extremes());
                    packed_round(all.mesh, triangle[3], radius, index_of)
                }
                Primitive::Triangle(first) => {
                    let order = order_by_position(all, id, first);
                    have_area &= spans_area(all, id, first, order);
                    *group = group.with(&first);
                    packed_triangle(all.mesh, triangle[3], order, index_of)
                }
            };
            *group = (1..all.count()).fold(*group, |group, step| group.with(&all.primitive(id, step).extremes()));
        }
    }
    have_area
}

/// The vertices of some triangles, ascending.
fn used_vertices(mesh: &Mesh, ids: &[u32]) -> Vec<u32> {
    let corners = |id: &u32| mesh.triangles[*id as usize];
    let ends = parallel::reduce(
        ids,
        |id| {
            let [a, b, c] = corners(id);
            Some((a.min(b).min(c), a.max(b).max(c)))
        },
        |a, b| (a.0.min(b.0), a.1.max(b.1)),
    );
    let Some((first, last)) = ends else { return Vec::new() };
    let mut is_used = vec![false; (last - first) as usize + 1];
    ids.iter().flat_map(corners).for_each(|v| is_used[(v - first) as usize] = true);
    parallel::flat_map(0..is_used.len() as u32, |k| is_used[k as usize].then_some(first + k))
}

/// The first of some ascending vertices, and the place among them of each vertex from it on.
fn vertex_indices(used: &[u32]) -> (u32, Vec<u32>) {
    let (Some(first), Some(last)) = (used.first(), used.last()) else { return (0, Vec::new()) };
    let mut indices = vec![0; (last - first) as usize + 1];
    (0..).zip(used).for_each(|(k, v)| indices[(v - first) as usize] = k);
    (*first, indices)
}

/// The triangles that have an area, along a Morton curve through their first centroids.
fn morton_order(all: MovingMesh, ids: std::ops::Range<u32>) -> Vec<u32> {
    let corners = |id: u32| all.corners(id, 0);
    let sum = |id: u32| corners(id).iter().sum::<DVec3>();
    let join = |a: (DVec3, DVec3), b: (DVec3, DVec3)| (a.0.min(b.0), a.1.max(b.1));
    let bounds = parallel::reduce(ids.clone(), |id| Some((sum(id), sum(id))), join);
    let bounds = bounds.unwrap_or((DVec3::INFINITY, DVec3::NEG_INFINITY));
    let key = |id: u32| morton_key(sum(id), bounds);
    // triangles without area come last
    let mut keyed = parallel::map(ids, |id| (if has_area(all, id) { key(id) } else { NO_KEY }, id));
    parallel::sort(&mut keyed);
    keyed.truncate(keyed.partition_point(|(key, _)| *key < NO_KEY));
    parallel::map(&keyed, |(_, id)| *id)
}

/// The place of a point along a Morton curve through the box between two corners.
pub fn morton_key(p: DVec3, (lo, hi): (DVec3, DVec3)) -> u64 {
    let scale = ((1u64 << 21) as f64 - 1.0) / (hi - lo).max_element().max(f64::MIN_POSITIVE);
    let place = (p - lo) * scale;
    interleave(place.x) | interleave(place.y) << 1 | interleave(place.z) << 2
}

/// More than a key of 63 bits.
const NO_KEY: u64 = u64::MAX;

/// The low 21 bits of a number, two zero bits between each.
fn interleave(place: f64) -> u64 {
    let mut x = place.max(0.0) as u64 & 0x1f_ffff;
    x = (x | x << 32) & 0x1f00000000ffff;
    x = (x | x << 16) & 0x1f0000ff0000ff;
    x = (x | x << 8) & 0x100f00f00f00f00f;
    x = (x | x << 4) & 0x10c30c30c30c30c3;
    (x | x << 2) & 0x1249249249249249
}

/// A sphere or capsule, or three different positions that are not on a line, as f64 sees it. What moves may have an area at other times than its steps.
fn has_area(all: MovingMesh, id: u32) -> bool {
    if all.mesh.is_round(id) {
        return true;
    }
    let first = all.corners(id, 0);
    spans_area(all, id, first, order_by_position(all, id, first))
}

/// Whether a triangle has an area: `first` are its corners at the first time step, `order` is their [`order_by_position`].
fn spans_area(all: MovingMesh, id: u32, first: [DVec3; 3], order: [usize; 3]) -> bool {
    if all.steps.is_some() {
        return !is_collapsed(all, id);
    }
    let [a, b, c] = order.map_each(|k| first[k]);
    a != b && b != c && (b - a).cross(c - a) != DVec3::ZERO
}

/// Two corners of a triangle lie in one place at all time steps, and so between them. Triangles that a camera of a composite does not show do.
fn is_collapsed(all: MovingMesh, id: u32) -> bool {
    let meet = |a: usize, b: usize| {
        (0..all.count()).all(|step| {
            let corners = all.corners(id, step);
            corners[a] == corners[b]
        })
    };
    meet(0, 1) || meet(1, 2) || meet(2, 0)
}

/// The indices of a triangle's corners, ascending by x, then y, then z; of the first time step at which two differ. `first` are the corners at
/// the first step.
fn order_by_position(all: MovingMesh, id: u32, first: [DVec3; 3]) -> [usize; 3] {
    let less = |a: usize, b: usize| {
        let key = |p: DVec3| (p.x, p.y, p.z);
        if first[a] != first[b] {
            return key(first[a]) < key(first[b]);
        }
        let later = (1..all.count()).map(|step| all.corners(id, step)).find(|corners| corners[a] != corners[b]);
        later.is_some_and(|corners| key(corners[a]) < key(corners[b]))
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

/// Where each file corner stands in a packed triangle, by order code: the table of `wgsl/vertices/triangle.wgsl`.
#[cfg(any(test, feature = "internals"))]
pub const CORNER_ORDERS: [[usize; 3]; 6] = [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0], [1, 0, 2]];

/// The order code of a packed triangle, by the file corners that come first and second in it.
const ORDER_CODES: [[u32; 3]; 3] = [[0, 0, 3], [5, 0, 2], [1, 4, 0]];

/// Of the triangle with the id and the sidedness in `last`, whose corners are in this order.
fn packed_triangle(mesh: &Mesh, last: u32, sorted: [usize; 3], index_of: impl Fn(u32) -> u32) -> [u32; 4] {
    let corners = mesh.triangles[(last & ID_MASK) as usize];
    let order = ORDER_CODES[sorted[0]][sorted[1]];
    let [a, b, c] = sorted.map_each(|s| index_of(corners[s]));
    [a, b, c, last & (ID_MASK | ONE_SIDED) | order << ORDER_SHIFT]
}

/// The sphere or capsule with the id and the sidedness in `last`. The vertex of a capsule's other end is the next one.
fn packed_round(mesh: &Mesh, last: u32, radius: f64, index_of: impl Fn(u32) -> u32) -> [u32; 4] {
    let [first, other, _] = mesh.triangles[(last & ID_MASK) as usize];
    let [hi, lo] = split2(radius).map_each(f32::to_bits);
    let kind = if first == other { SPHERE } else { CAPSULE };
    [index_of(first), hi, lo, last & (ID_MASK | ONE_SIDED) | kind]
}

/// [`ONE_SIDED`], or 0.
fn side(mesh: &Mesh, id: u32) -> u32 {
    debug_assert!(id <= ID_MASK);
    let material = &mesh.materials[mesh.material_of[id as usize] as usize];
    if material.two_sided { 0 } else { ONE_SIDED }
}

/// A box of positions.
#[derive(Debug, Clone, Copy)]
struct Bounds {
    lo: DVec3,
    hi: DVec3,
}

impl Bounds {
    const NONE: Bounds = Bounds { lo: DVec3::INFINITY, hi: DVec3::NEG_INFINITY };

    fn with(self, corners: &[DVec3; 3]) -> Bounds {
        let [a, b, c] = *corners;
        Bounds { lo: self.lo.min(a).min(b).min(c), hi: self.hi.max(a).max(b).max(c) }
    }

    fn joined(self, other: Bounds) -> Bounds {
        Bounds { lo: self.lo.min(other.lo), hi: self.hi.max(other.hi) }
    }

    /// Of the slots from `first` on.
    fn packed(self, anchor: DVec3, first: usize, count: usize) -> Cluster {
        let (lo, hi) = (self.lo - anchor, self.hi - anchor);
        let (centre, half) = ((lo + hi) / 2.0, (hi - lo) / 2.0);
        // f32 rounding of the box and of what kernels compute from it: 2^-22 of the largest coordinate, 4 roundings
        let tolerance = (centre.abs() + half).max_element() * CLUSTER_TOLERANCE;
        Cluster {
            centre: centre.as_vec3().to_array(),
            first: first as u32,
            half: (half + tolerance).as_vec3().to_array(),
            count: count as u32,
        }
    }
}

const CLUSTER_TOLERANCE: f64 = 1.0 / (1u64 << 22) as f64;

#[cfg(test)]
mod tests;
