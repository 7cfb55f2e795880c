//! Triangles made ready for the kernels: chunks that fit a binding, in an order that keeps neighbours together.
//!
//! Positions are rebased to an anchor in f64 and stored as f32 pairs. Every triangle names its corners in the
//! order of their positions, so an edge is the same number from both sides, seams with doubled vertices included.

use crate::arrays::MapEach;
use crate::geometry::mesh::{self, Mesh, NO_NORMAL};
use crate::geometry::time_steps::MovingMesh;
use crate::gpu::kernels::SurfaceKind;
use crate::gpu::layout::{
    CLUSTER, Cluster, ID_MASK, NONE, ONE_SIDED, ORDER_SHIFT, SPHERE, TRIANGLE_GROUP, Vertex, split2,
};
use crate::parallel;
use glam::DVec3;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Triangles `id_first .. id_first + id_count` of a scene, as the kernels read them.
#[derive(Debug, Clone, Default)]
pub struct Chunk {
    pub id_first: u32,
    pub id_count: u32,
    /// All time steps of a vertex together.
    pub vertices: Vec<Vertex>,
    /// Per slot: three vertices in the order of their positions; id, file order and sidedness. Of a sphere: the vertex in its centre, its
    /// radius as two f32, and its id, [`SPHERE`] and sidedness.
    pub triangles: Arc<Vec<[u32; 4]>>,
    /// Per slot: the normals of the corners in file order, and the material.
    pub surfaces: Arc<Vec<[u32; 4]>>,
    /// Where images lie on triangles, six numbers a slot: the texture coordinates of the corners in file order, v downwards; NaN
    /// of one that has none.
    pub uvs: Arc<Vec<[f32; 6]>>,
    /// Where vertices have colours, nine numbers a slot: those of the corners in file order.
    pub colors: Arc<Vec<[f32; 9]>>,
    /// Slot of triangle `id_first + k`; [`NONE`] for triangles without area, which are never hit.
    pub slot_of_id: Arc<Vec<u32>>,
    pub clusters: Vec<Cluster>,
    /// One for each triangle group of each cluster; the last cluster's may be empty.
    pub triangle_groups: Vec<Cluster>,
    /// Time steps of each vertex; 1 if nothing moves during a frame.
    pub steps: u32,
    /// The boxes of clusters, and of their triangle groups, in the world.
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
    /// Triangles without area, left out.
    pub without_area: usize,
}

/// Bytes of a triangle and of a vertex in the largest table that holds them: where images lie, or what trace tests; with colours that of
/// surfaces.
const TRIANGLE_BYTES: u64 = 48;
const COLORED_TRIANGLE_BYTES: u64 = 80;
const VERTEX_BYTES: u64 = size_of::<Vertex>() as u64;

/// Splits a mesh into chunks none of whose tables exceeds `table_limit` bytes; `surfaces` says which tables there are.
pub fn cluster<'a>(
    all: impl Into<MovingMesh<'a>>,
    anchor: DVec3,
    surfaces: SurfaceKind,
    table_limit: u64,
) -> Clustered {
    let all = all.into();
    let mesh = all.mesh;
    let surface_bytes = if surfaces == SurfaceKind::Colored { COLORED_TRIANGLE_BYTES } else { TRIANGLE_BYTES };
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
            chunk(all, anchor, ids, (whole, surfaces))
        })
        .collect();
    if chunks.is_empty() {
        // a scene without triangles still has a background to shade
        chunks.push(Chunk::default());
    }
    let slots: usize = chunks.iter().map(|c| c.triangles.len()).sum();
    Clustered { chunks, anchor, places: Arc::default(), without_area: mesh.triangles.len() - slots }
}

fn chunk(all: MovingMesh, anchor: DVec3, ids: std::ops::Range<u32>, (whole, surfaces): (bool, SurfaceKind)) -> Chunk {
    let mesh = all.mesh;
    let order = morton_order(all, ids.clone());
    let mut chunk = Chunk { id_first: ids.start, id_count: ids.len() as u32, steps: all.count(), ..Default::default() };
    if !whole {
        let mut used = parallel::map(&order, |&id| mesh.triangles[id as usize]).into_flattened();
        parallel::sort(&mut used);
        used.dedup();
        chunk.used = Some(Arc::new(used));
    }
    chunk.surfaces = Arc::new(parallel::map(&order, |&id| triangle_surface(mesh, id)));
    if surfaces != SurfaceKind::Plain {
        chunk.uvs = Arc::new(parallel::map(&order, |&id| triangle_uvs(mesh, id)));
    }
    if surfaces == SurfaceKind::Colored {
        chunk.colors = Arc::new(parallel::map(&order, |&id| triangle_colors(mesh, id)));
    }
    let mut slot_of_id = vec![NONE; ids.len()];
    for (slot, &id) in order.iter().enumerate() {
        slot_of_id[(id - ids.start) as usize] = slot as u32;
    }
    chunk.slot_of_id = Arc::new(slot_of_id);
    chunk.triangles = Arc::new(parallel::map(&order, |&id| [0, 0, 0, id | side(mesh, id)]));
    chunk.place(all, anchor);
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
        self.places = Arc::default();
        self.chunks.iter_mut().all(|chunk| {
            (self.without_area == 0 || lies_flat(chunk))
                && chunk.place(mesh.into(), self.anchor)
                && chunk.size() <= GROWN_MAX * chunk.clustered_size
        })
    }
}

impl Clustered {
    /// Returns a copy of the triangles about another anchor.
    pub fn anchored<'a>(&self, all: impl Into<MovingMesh<'a>>, anchor: DVec3) -> Clustered {
        let all = all.into();
        let chunks = self.chunks.iter().map(|chunk| chunk.anchored(all, anchor)).collect();
        Clustered { chunks, anchor, places: self.places.clone(), without_area: self.without_area }
    }
}

/// Triangle groups of a cluster.
const TRIANGLE_GROUPS: usize = (CLUSTER / TRIANGLE_GROUP) as usize;

const EMPTY: Cluster = Cluster { centre: [0.0; 3], first: 0, half: [0.0; 3], count: 0 };

/// Beyond it, boxes have grown too much for triangles to stay in them.
const GROWN_MAX: f64 = 1.5;

impl Chunk {
    /// All that depends on positions, of the triangles in their slots; whether each has an area.
    fn place(&mut self, all: MovingMesh, anchor: DVec3) -> bool {
        let mesh = all.mesh;
        let used = self.used.as_ref().map(|used| used.as_slice());
        // every vertex of the chunk is in the sorted list
        let index_of = |v: u32| used.map_or(v, |used| used.partition_point(|&u| u < v) as u32);
        let triangles = Arc::make_mut(&mut self.triangles);
        let [clusters, groups] = Arc::make_mut(&mut self.boxes);
        clusters.resize(triangles.len().div_ceil(CLUSTER as usize), Bounds::NONE);
        groups.resize(clusters.len() * TRIANGLE_GROUPS, Bounds::NONE);
        let each = triangles.chunks_mut(CLUSTER as usize).zip(groups.chunks_mut(TRIANGLE_GROUPS)).zip(clusters);
        let all_have_area = AtomicBool::new(true);
        parallel::for_each(each, |((triangles, groups), cluster)| {
            let (mut whole, mut have_area) = (Bounds::NONE, true);
            for (group, triangles) in groups.iter_mut().zip(triangles.chunks_mut(TRIANGLE_GROUP as usize)) {
                let mut own = Bounds::NONE;
                for triangle in triangles.iter_mut() {
                    let id = triangle[3] & ID_MASK;
                    let order = order_by_position(all, id);
                    have_area &= has_area(all, id);
                    own = (0..all.count()).fold(own, |own, step| own.with(&extremes(all, id, step)));
                    *triangle = match mesh.radius(id) {
                        Some(radius) => packed_sphere(mesh, triangle[3], radius, index_of),
                        None => packed_triangle(mesh, triangle[3], order, index_of),
                    };
                }
                *group = own;
                whole = whole.joined(own);
            }
            *cluster = whole;
            all_have_area.fetch_and(have_area, Ordering::Relaxed);
        });
        *self = self.anchored(all, anchor);
        all_have_area.into_inner()
    }

    /// Returns a copy of the triangles about another anchor.
    fn anchored(&self, all: MovingMesh, anchor: DVec3) -> Chunk {
        let used = self.used.as_ref().map(|used| used.as_slice());
        let (count, steps) = (used.map_or(all.mesh.positions.len(), <[u32]>::len), all.count() as usize);
        let vertices = parallel::map(0..count * steps, |k| {
            let (k, step) = (k / steps, (k % steps) as u32);
            Vertex::new(all.position(used.map_or(k as u32, |used| used[k]), step) - anchor)
        });
        let packed = |boxes: &[Bounds], each: usize| {
            parallel::map(0..boxes.len(), |k| {
                let slots = self.triangles.len().min((k + 1) * each).saturating_sub(k * each);
                if slots == 0 { EMPTY } else { boxes[k].packed(anchor, k * each, slots) }
            })
        };
        let [clusters, groups] = &*self.boxes;
        Chunk {
            vertices,
            clusters: packed(clusters, CLUSTER as usize),
            triangle_groups: packed(groups, TRIANGLE_GROUP as usize),
            id_first: self.id_first,
            id_count: self.id_count,
            triangles: self.triangles.clone(),
            surfaces: self.surfaces.clone(),
            uvs: self.uvs.clone(),
            colors: self.colors.clone(),
            slot_of_id: self.slot_of_id.clone(),
            steps: self.steps,
            boxes: self.boxes.clone(),
            used: self.used.clone(),
            clustered_size: self.clustered_size,
        }
    }

    /// Of all boxes together.
    fn size(&self) -> f64 {
        self.clusters.iter().map(|c| c.half.iter().map(|h| f64::from(*h)).sum::<f64>()).sum()
    }
}

/// The triangles that have an area, along a Morton curve through their first centroids.
fn morton_order(all: MovingMesh, ids: std::ops::Range<u32>) -> Vec<u32> {
    let corners = |id: u32| all.corners(id, 0);
    let sum = |id: u32| corners(id).iter().sum::<DVec3>();
    let join = |a: (DVec3, DVec3), b: (DVec3, DVec3)| (a.0.min(b.0), a.1.max(b.1));
    let bounds = parallel::reduce(ids.clone(), |id| Some((sum(id), sum(id))), join);
    let bounds = bounds.unwrap_or((DVec3::INFINITY, DVec3::NEG_INFINITY));
    let scale = ((1u64 << 21) as f64 - 1.0) / (bounds.1 - bounds.0).max_element().max(f64::MIN_POSITIVE);
    let key = |id: u32| {
        let place = (sum(id) - bounds.0) * scale;
        interleave(place.x) | interleave(place.y) << 1 | interleave(place.z) << 2
    };
    let mut keyed = parallel::flat_map(ids, |id| has_area(all, id).then(|| (key(id), id)));
    parallel::sort(&mut keyed);
    keyed.into_iter().map(|(_, id)| id).collect()
}

/// The low 21 bits of a number, two zero bits between each.
fn interleave(place: f64) -> u64 {
    let mut x = place.max(0.0) as u64 & 0x1f_ffff;
    x = (x | x << 32) & 0x1f00000000ffff;
    x = (x | x << 16) & 0x1f0000ff0000ff;
    x = (x | x << 8) & 0x100f00f00f00f00f;
    x = (x | x << 4) & 0x10c30c30c30c30c3;
    (x | x << 2) & 0x1249249249249249
}

/// The corners of a triangle, or of a sphere's box.
fn extremes(all: MovingMesh, id: u32, step: u32) -> [DVec3; 3] {
    mesh::extremes(all.corners(id, step), all.mesh.radius(id))
}

/// A sphere, or three different positions that are not on a line, as f64 sees it. What moves may have an area at other times than its steps.
fn has_area(all: MovingMesh, id: u32) -> bool {
    if all.mesh.radius(id).is_some() {
        return true;
    }
    let corners = all.corners(id, 0);
    let [a, b, c] = order_by_position(all, id).map_each(|k| corners[k]);
    all.steps.is_some() || a != b && b != c && (b - a).cross(c - a) != DVec3::ZERO
}

/// The corners' indices, ascending by x, then y, then z; of the first time step at which two differ.
fn order_by_position(all: MovingMesh, id: u32) -> [usize; 3] {
    let first = all.corners(id, 0);
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

/// Where each file corner stands in a packed triangle, by order code: the table of `wgsl/shared/triangle.wgsl`.
pub const CORNER_ORDERS: [[usize; 3]; 6] = [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0], [1, 0, 2]];

/// Of the triangle with the id and the sidedness in `last`, whose corners are in this order.
fn packed_triangle(mesh: &Mesh, last: u32, sorted: [usize; 3], index_of: impl Fn(u32) -> u32) -> [u32; 4] {
    let corners = mesh.triangles[(last & ID_MASK) as usize];
    // the place of file corner c in the packed triangle
    let place = [0, 1, 2].map_each(|c| sorted.iter().position(|&s| s == c).unwrap_or(0));
    let order = CORNER_ORDERS.iter().position(|o| *o == place).unwrap_or(0) as u32;
    let [a, b, c] = sorted.map_each(|s| index_of(corners[s]));
    [a, b, c, last & (ID_MASK | ONE_SIDED) | order << ORDER_SHIFT]
}

/// Of the sphere with the id and the sidedness in `last`.
fn packed_sphere(mesh: &Mesh, last: u32, radius: f64, index_of: impl Fn(u32) -> u32) -> [u32; 4] {
    let [centre, ..] = mesh.triangles[(last & ID_MASK) as usize];
    let [hi, lo] = split2(radius).map_each(f32::to_bits);
    [index_of(centre), hi, lo, last & (ID_MASK | ONE_SIDED) | SPHERE]
}

/// [`ONE_SIDED`], or 0.
fn side(mesh: &Mesh, id: u32) -> u32 {
    debug_assert!(id <= ID_MASK);
    let material = &mesh.materials[mesh.material_of[id as usize] as usize];
    if material.two_sided { 0 } else { ONE_SIDED }
}

fn triangle_surface(mesh: &Mesh, id: u32) -> [u32; 4] {
    let [a, b, c] = mesh.corner_normals.get(id as usize).copied().unwrap_or([NO_NORMAL; 3]);
    [a, b, c, mesh.material_of[id as usize]]
}

fn triangle_uvs(mesh: &Mesh, id: u32) -> [f32; 6] {
    let Some([a, b, c]) = mesh.uvs_of(id as usize) else { return [f32::NAN; 6] };
    [a.x, 1.0 - a.y, b.x, 1.0 - b.y, c.x, 1.0 - c.y]
}

fn triangle_colors(mesh: &Mesh, id: u32) -> [f32; 9] {
    let colors = mesh.colors_of(id as usize);
    std::array::from_fn(|k| colors[k / 3][k % 3])
}

/// The table that kernels read for surfaces with texture coordinates: per slot that of `surfaces`, then two vec4s with the texture
/// coordinates of the three corners and a flag, 1 if the triangle has any.
pub fn mapped_surfaces(surfaces: &[[u32; 4]], uvs: &[[f32; 6]]) -> Vec<[[u32; 4]; 3]> {
    let mapped = |(own, uv): (&[u32; 4], &[f32; 6])| {
        let is_mapped = u32::from(uv.iter().all(|v| v.is_finite()));
        let [a, b, c, d, e, f] = uv.map(f32::to_bits);
        [*own, [a, b, c, d], [e, f, is_mapped, 0]]
    };
    surfaces.iter().zip(uvs).map(mapped).collect()
}

/// The table that kernels read for surfaces with colours at their corners: per slot that of [`mapped_surfaces`], whose last number is the
/// first of nine, and two more vec4s.
pub fn colored_surfaces(mapped: &[[[u32; 4]; 3]], colors: &[[f32; 9]]) -> Vec<[[u32; 4]; 5]> {
    let colored = |([own, ab, [u, v, is_mapped, _]], colors): (&[[u32; 4]; 3], &[f32; 9])| {
        let [a, b, c, d, e, f, g, h, i] = colors.map(f32::to_bits);
        [*own, *ab, [*u, *v, *is_mapped, a], [b, c, d, e], [f, g, h, i]]
    };
    mapped.iter().zip(colors).map(colored).collect()
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
mod tests {
    use super::*;
    use crate::geometry::generate::soup;
    use glam::DMat3;

    const LIMITS: [u64; 2] = [1 << 27, 1 << 13];

    fn mesh() -> Mesh {
        soup(3, 700)
    }

    fn moved(mesh: &Mesh, to: impl Fn(DVec3) -> DVec3) -> Mesh {
        Mesh { positions: mesh.positions.iter().map(|p| to(*p)).collect(), ..mesh.clone() }
    }

    /// A triangle as clusters store it: its positions in stored order, and its last word.
    fn stored(chunk: &Chunk, slot: u32) -> ([[f64; 3]; 3], u32) {
        let triangle = chunk.triangles[slot as usize];
        ([0, 1, 2].map(|c| chunk.vertices[triangle[c] as usize].position().to_array()), triangle[3])
    }

    #[test]
    fn triangles_that_moved_are_held_as_if_clustered_anew_in_boxes_that_hold_them() {
        let mesh = mesh();
        let rotated = moved(&mesh, |p| DMat3::from_rotation_z(0.4) * p + DVec3::new(0.5, -1.0, 0.0));
        for limit in LIMITS {
            let mut refitted = cluster(&mesh, DVec3::ZERO, SurfaceKind::Plain, limit);
            let slots: Vec<_> = refitted.chunks.iter().map(|c| c.slot_of_id.clone()).collect();
            assert!(refitted.refit(&rotated));
            let anew = cluster(&rotated, DVec3::ZERO, SurfaceKind::Plain, limit);
            assert_eq!(refitted.chunks.len(), anew.chunks.len());
            assert_eq!(anew.chunks.len() > 1, limit == LIMITS[1]);
            for ((a, b), slots) in refitted.chunks.iter().zip(&anew.chunks).zip(slots) {
                assert_eq!(a.slot_of_id, slots);
                for (at, anew_at) in a.slot_of_id.iter().zip(b.slot_of_id.iter()).filter(|s| *s.0 != NONE) {
                    assert_eq!(stored(a, *at), stored(b, *anew_at));
                    let cluster = &a.clusters[(at / CLUSTER) as usize];
                    let within = |p: [f64; 3]| {
                        (0..3).all(|k| (p[k] - f64::from(cluster.centre[k])).abs() <= f64::from(cluster.half[k]))
                    };
                    assert!(stored(a, *at).0.into_iter().all(within));
                }
            }
        }
    }

    #[test]
    fn triangles_that_lost_their_area_or_moved_away_are_clustered_anew() {
        let mesh = mesh();
        let flat = moved(&mesh, |p| DVec3::new(p.x, 0.0, 0.0));
        let scattered = moved(&mesh, |p| DVec3::new((40.0 * p.x).sin(), (40.0 * p.y).cos(), (40.0 * p.z).sin()) * 9.0);
        for limit in LIMITS {
            assert!(cluster(&mesh, DVec3::ZERO, SurfaceKind::Plain, limit).refit(&mesh));
            for to in [&flat, &scattered] {
                assert!(!cluster(&mesh, DVec3::ZERO, SurfaceKind::Plain, limit).refit(to));
            }
            assert!(!cluster(&flat, DVec3::ZERO, SurfaceKind::Plain, limit).refit(&mesh));
        }
    }
}
