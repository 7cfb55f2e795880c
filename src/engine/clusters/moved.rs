//! Triangles whose vertices have moved, in the slots where they were. Only clusters with such vertices are placed again.

use super::{Chunk, Clustered, GROWN_MAX, NONE, TRIANGLE_GROUPS, has_area};
use crate::geometry::mesh::Mesh;
use crate::gpu::layout::{CLUSTER, ID_MASK};
use crate::parallel;
use std::ops::Range;
use std::sync::Arc;

/// The changes of triangles against another placement of the same triangles.
#[derive(Debug, Clone)]
pub struct Moved {
    /// The other placement: its [`Clustered::places`].
    pub from: Arc<()>,
    /// The changed tables of each chunk.
    pub chunks: Vec<MovedChunk>,
}

/// Vertices and clusters of a chunk that changed, as ascending ranges.
#[derive(Debug, Clone, Default)]
pub struct MovedChunk {
    pub vertices: Vec<Range<usize>>,
    pub clusters: Vec<Range<usize>>,
}

impl MovedChunk {
    /// The changed slots.
    pub fn slots(&self) -> Vec<Range<usize>> {
        times(&self.clusters, CLUSTER as usize)
    }

    /// How many slots changed.
    pub fn slot_count(&self) -> u64 {
        u64::from(CLUSTER) * self.clusters.iter().map(|range| range.len() as u64).sum::<u64>()
    }

    /// The changed triangle groups.
    pub fn groups(&self) -> Vec<Range<usize>> {
        times(&self.clusters, TRIANGLE_GROUPS)
    }
}

fn times(ranges: &[Range<usize>], each: usize) -> Vec<Range<usize>> {
    ranges.iter().map(|range| range.start * each..range.end * each).collect()
}

impl Clustered {
    /// Moves these clusters, built for `from`, to the vertices of `to`; the anchor stays. Returns `None` if they must be clustered again: the
    /// mesh has time steps, differs in more than positions and normals, a triangle gained or lost its area, or the boxes have grown by half.
    pub fn moved(&self, from: &Mesh, to: &Mesh) -> Option<Clustered> {
        if self.placed.is_some() || self.chunks.iter().any(|chunk| chunk.steps > 1) || !differ_in_places_alone(from, to)
        {
            return None;
        }
        let count = to.positions.len();
        let has_moved: Vec<bool> = parallel::map(0..count, |k| from.positions[k] != to.positions[k]);
        let chunks: Vec<(Chunk, MovedChunk)> =
            self.chunks.iter().map(|chunk| chunk.moved(to, &has_moved, self)).collect::<Option<_>>()?;
        let (chunks, moved) = chunks.into_iter().unzip();
        let moved = Some(Moved { from: self.places.clone(), chunks: moved });
        Some(Clustered { chunks, places: Arc::default(), moved, slots: self.slots.clone(), placed: None, ..*self })
    }
}

/// Whether two meshes have the same triangles, surfaces and sides; vertices and normals may lie elsewhere.
fn differ_in_places_alone(a: &Mesh, b: &Mesh) -> bool {
    let sides = |mesh: &Mesh| mesh.materials.iter().map(|material| material.two_sided).collect::<Vec<_>>();
    a.positions.len() == b.positions.len()
        && a.normals.len() == b.normals.len()
        && a.triangles == b.triangles
        && a.radii == b.radii
        && a.material_of == b.material_of
        && sides(a) == sides(b)
        && a.corner_normals == b.corner_normals
        && (&a.uvs, &a.corner_uvs) == (&b.uvs, &b.corner_uvs)
        && (&a.colors, &a.corner_colors) == (&b.colors, &b.corner_colors)
}

impl Chunk {
    fn moved(&self, to: &Mesh, has_moved: &[bool], all: &Clustered) -> Option<(Chunk, MovedChunk)> {
        let corners = |id: u32| to.triangles[id as usize];
        let moves = |id: u32| corners(id).iter().any(|v| has_moved[*v as usize]);
        let lies_flat = |id: u32| self.slot_of_id[(id - self.id_first) as usize] == NONE;
        let gets_area = |id: u32| moves(id) && lies_flat(id) && has_area(to.into(), id);
        if all.without_area > 0 && parallel::any(self.id_first..self.id_first + self.id_count, gets_area) {
            return None;
        }
        let each = CLUSTER as usize;
        let slots = |cluster: usize| cluster * each..((cluster + 1) * each).min(self.triangles.len());
        let is_changed = |cluster: usize| self.triangles[slots(cluster)].iter().any(|t| moves(t[3] & ID_MASK));
        let is_changed: Vec<bool> = parallel::map(0..self.cluster_count(), is_changed);
        let vertices = match &self.used {
            Some(used) => ranges(&parallel::map(used.as_slice(), |v| has_moved[*v as usize])),
            None => ranges(has_moved),
        };
        let mut own = self.clone();
        if !own.place(to.into(), |cluster| is_changed[cluster]) || own.size() > GROWN_MAX * self.clustered_size {
            return None;
        }
        Some((own, MovedChunk { vertices, clusters: ranges(&is_changed) }))
    }
}

/// The ranges of numbers that are marked.
fn ranges(is_marked: &[bool]) -> Vec<Range<usize>> {
    let mut at = 0;
    let runs = is_marked.chunk_by(|a, b| a == b).map(|run| {
        at += run.len();
        (run[0], at - run.len()..at)
    });
    runs.filter_map(|(is_marked, range)| is_marked.then_some(range)).collect()
}
