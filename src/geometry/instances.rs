//! Meshes that stand in a scene more than once. Their triangles are stored once, with a matrix for each place.

use crate::arrays::MapEach;
use crate::geometry::mesh::{MAX_TRIANGLES, Mesh, NO_NORMAL, check_memory, joined};
use crate::geometry::place::{self, size_of, transformed_normal, world_normal_from_object};
use crate::input::{Error, Limits, Result};
use crate::parallel;
use glam::{DAffine3, DMat3, DVec3, Vec3};
use std::collections::{BTreeSet, HashMap};
use std::ops::Range;
use std::sync::Arc;

/// The triangles of a scene: the meshes, each stored once, and the places where they stand. Triangle ids run on from instance to instance.
#[derive(Debug, Clone, PartialEq)]
pub struct Instances {
    /// All meshes, one after the other, before the matrices of their places.
    pub base: Arc<Mesh>,
    /// The instances in the order of their triangle ids. Instances of one mesh have the same ranges.
    pub list: Vec<Instance>,
}

/// A mesh in one of its places.
#[derive(Debug, Clone, PartialEq)]
pub struct Instance {
    /// The id of its first triangle.
    pub first_id: u32,
    /// Its triangles, vertices and normals in the base mesh.
    pub triangles: Range<u32>,
    pub vertices: Range<u32>,
    pub normals: Range<u32>,
    /// The box around its vertices in the base mesh.
    pub bounds: (DVec3, DVec3),
    /// From the base mesh to the world; `None`: the base mesh is in the world.
    pub matrix: Option<DAffine3>,
}

/// A run of a mesh's triangles, with their vertices and normals, and its place.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    pub triangles: Range<u32>,
    pub vertices: Range<u32>,
    pub normals: Range<u32>,
    pub matrix: DAffine3,
}

/// A mesh, and its runs in the order of their triangle ids; `None`: it stands once, where it is.
pub type Part = (Mesh, Option<Arc<[Run]>>);

/// A whole mesh at each of some places.
pub fn at_places(mesh: Mesh, places: impl IntoIterator<Item = DAffine3>) -> Part {
    let runs = places.into_iter().map(|place| Run::whole(&mesh, place)).collect();
    (mesh, Some(runs))
}

impl Run {
    /// A whole mesh.
    pub fn whole(mesh: &Mesh, matrix: DAffine3) -> Run {
        let [triangles, vertices, normals] = counts(mesh).map_each(|count| 0..count);
        Run { triangles, vertices, normals, matrix }
    }

    /// The rest of a mesh after its state when it was `earlier`.
    pub fn after(self, earlier: &Run) -> Run {
        let triangles = earlier.triangles.end..self.triangles.end;
        let vertices = earlier.vertices.end..self.vertices.end;
        Run { triangles, vertices, normals: earlier.normals.end..self.normals.end, ..self }
    }

    /// The box around the run's vertices, before its matrix.
    pub fn bounds(&self, mesh: &Mesh) -> (DVec3, DVec3) {
        bounds_of(mesh.positions.get(places(&self.vertices)).unwrap_or_default())
    }
}

/// A place takes the memory of so many triangles.
const TRIANGLES_A_PLACE: usize = 16;

/// Copies of no more triangles than this take little memory.
const COPIED_MAX: usize = 1 << 16;

impl Instances {
    /// Meshes and their runs, in the order of their triangle ids.
    ///
    /// # Errors
    /// [`Error::Input`] if there are more than 2^28 triangles in all places, or 2^32 - 1 or more vertices or other attributes in the meshes.
    pub fn new(parts: Vec<Part>) -> Result<Instances> {
        check_triangles(parts.iter().map(triangles_of).fold(0, usize::saturating_add))?;
        let (mut list, mut firsts) = (Vec::new(), [0; 3]);
        for part in &parts {
            add_places(&mut list, part, firsts);
            let own = counts(&part.0);
            firsts = [0, 1, 2].map_each(|k| u32::saturating_add(firsts[k], own[k]));
        }
        let base = Arc::new(place::merge(parts.into_iter().map(|part| part.0).collect())?);
        Ok(Instances { base, list })
    }

    /// A mesh in the world as one instance for each of some runs of its triangles, so that each can move. Returns `None` if vertices or normals
    /// of one run lie among those of another.
    pub fn of_runs(mesh: &Arc<Mesh>, counts: impl Iterator<Item = usize>) -> Option<Instances> {
        let (mut list, mut first_id, mut ends) = (Vec::new(), 0, [0; 2]);
        let mut add = |triangles: u32, [vertices, normals]: [Range<u32>; 2]| {
            let bounds = bounds_of(&mesh.positions[places(&vertices)]);
            let own = first_id..first_id + triangles;
            list.push(Instance { first_id, triangles: own, vertices, normals, bounds, matrix: None });
            first_id += triangles;
        };
        let lens = [mesh.positions.len(), mesh.normals.len()].map_each(|n| n as u32);
        let rest = |k: usize| mesh.triangles.len().saturating_sub(k);
        let mut first = 0;
        for count in counts.map(Some).chain([None]) {
            let count = count.unwrap_or(rest(first)).min(rest(first));
            let used = |corners: &[[u32; 3]], end: u32| {
                let own = corners.get(first..first + count).unwrap_or_default();
                let ends = |[a, b, c]: &[u32; 3]| {
                    let used = [*a, *b, *c].into_iter().filter(|v| *v != NO_NORMAL);
                    used.clone().min().zip(used.max())
                };
                let ends = parallel::reduce(own, ends, |a, b| (a.0.min(b.0), a.1.max(b.1)));
                ends.map_or(end..end, |(lo, hi)| lo..hi + 1)
            };
            let own = [used(&mesh.triangles, ends[0]), used(&mesh.corner_normals, ends[1])];
            if own[0].start < ends[0] || own[1].start < ends[1] {
                return None;
            }
            // vertices that no triangle has keep their place
            let gaps = [0, 1].map_each(|k| ends[k]..own[k].start);
            if gaps.iter().any(|gap| !gap.is_empty()) {
                add(0, gaps);
            }
            ends = [0, 1].map_each(|k| own[k].end);
            if count > 0 {
                add(count as u32, own);
            }
            first += count;
        }
        if ends != lens {
            add(0, [0, 1].map_each(|k| ends[k]..lens[k]));
        }
        Some(Instances { base: mesh.clone(), list })
    }

    /// The instances that are exactly these triangles, by their indices.
    pub fn exactly(&self, ids: &Range<usize>) -> Option<Range<usize>> {
        let last_id = ids.end.checked_sub(1).filter(|_| !ids.is_empty())?;
        let [first, last] = [ids.start, last_id].map_each(|id| self.index_of(id as u32));
        let own = self.list.get(first..=last)?;
        let (start, end) = (own.first()?.first_id as usize, own.last()?);
        (start == ids.start && end.first_id as usize + end.triangles.len() == ids.end).then_some(first..last + 1)
    }

    /// Whether rays can be taken to the base mesh from each place: see [`Instance::inverse`]. No mesh may be far smaller than all together.
    pub fn are_invertible(&self) -> bool {
        let size = |(lo, hi): (DVec3, DVec3)| (hi - lo).max_element();
        let boxes = self.boxes();
        let whole = boxes.iter().copied().filter(|(lo, hi)| lo.cmple(*hi).all()).reduce(joined).map_or(0.0, size);
        self.list.iter().zip(boxes).all(|(instance, own)| {
            let is_seen = !instance.is_point() && size(own) > 0.0;
            instance.inverse().is_some() && (!is_seen || size(own) >= SIZE_MIN * whole)
        })
    }

    /// Appends a mesh and its runs.
    ///
    /// # Errors
    /// As [`Instances::new`]; the instances are then as before.
    pub fn append(&mut self, part: Part) -> Result<()> {
        place::check_counts([&*self.base, &part.0])?;
        let own = triangles_of(&part);
        check_triangles(own)?;
        check_triangles(self.triangle_count() + own)?;
        add_places(&mut self.list, &part, counts(&self.base));
        place::append_with_all(Arc::make_mut(&mut self.base), part.0);
        Ok(())
    }

    /// Whether a copy of each mesh at each of its places would take much more memory. Spheres are always copied.
    pub fn saves_memory(&self) -> bool {
        !self.base.has_spheres() && saves_memory(self.triangle_count(), self.base.triangles.len(), self.list.len())
    }

    /// The number of triangles in all places.
    pub fn triangle_count(&self) -> usize {
        end_id(&self.list)
    }

    /// The number of vertices in all places.
    pub fn vertex_count(&self) -> usize {
        self.list.iter().map(|instance| instance.vertices.len()).sum()
    }

    /// The number of vertices in all places that no triangle has.
    pub fn unused_vertices(&self) -> usize {
        // so many of the first k vertices are used
        let mut used = vec![0_u32; self.base.positions.len() + 1];
        self.base.triangles.iter().flatten().for_each(|vertex| used[*vertex as usize + 1] = 1);
        (1..used.len()).for_each(|k| used[k] += used[k - 1]);
        let used_of = |range: &Range<u32>| (used[range.end as usize] - used[range.start as usize]) as usize;
        self.list.iter().map(|instance| instance.vertices.len() - used_of(&instance.vertices)).sum()
    }

    /// The first instance of each mesh, and the mesh of each instance by its place among these.
    pub fn meshes(&self) -> (Vec<&Instance>, Vec<usize>) {
        let (mut meshes, mut of_instance) = (Vec::new(), Vec::with_capacity(self.list.len()));
        let mut known = HashMap::new();
        for instance in &self.list {
            let mesh = *known.entry([&instance.triangles, &instance.vertices]).or_insert_with(|| {
                meshes.push(instance);
                meshes.len() - 1
            });
            of_instance.push(mesh);
        }
        (meshes, of_instance)
    }

    /// The instance of a triangle, by its index.
    pub fn index_of(&self, id: u32) -> usize {
        self.list.partition_point(|instance| instance.first_id <= id).saturating_sub(1)
    }

    /// The instance of a triangle, and the triangle in the base mesh.
    pub fn find(&self, id: u32) -> (&Instance, u32) {
        let instance = &self.list[self.index_of(id)];
        (instance, id - instance.first_id + instance.triangles.start)
    }

    /// The corners of a triangle in the world, in the order of its file.
    pub fn corners(&self, id: u32) -> [DVec3; 3] {
        let (instance, own) = self.find(id);
        self.base.triangles[own as usize].map_each(|vertex| instance.placed(self.base.positions[vertex as usize]))
    }

    /// The box around each instance in the world, by the box of its mesh: all vertices lie in it, and it may be larger than need be.
    pub fn boxes(&self) -> Vec<(DVec3, DVec3)> {
        self.list.iter().map(|instance| instance.placed_box(instance.bounds)).collect()
    }

    /// The box around all vertices in the world; `None` without any. Vertices of an instance are looked at only if its box reaches out of
    /// what is found so far.
    pub fn bounds(&self) -> Option<(DVec3, DVec3)> {
        let boxes = self.boxes();
        let mut found: Option<(DVec3, DVec3)> = None;
        let mut is_seen = vec![false; boxes.len()];
        for axis in 0..3 {
            for is_upper in [false, true] {
                let reach = |k: &usize| if is_upper { boxes[*k].1[axis] } else { -boxes[*k].0[axis] };
                let mut order: Vec<usize> = (0..boxes.len()).collect();
                order.sort_by(|a, b| reach(b).total_cmp(&reach(a)));
                for k in order {
                    let inner = found.map_or(f64::NEG_INFINITY, |(lo, hi)| if is_upper { hi[axis] } else { -lo[axis] });
                    // its vertices reach no farther than what is found, to within the rounding of its box
                    if reach(&k) - 2.0 * self.list[k].box_rounding()[axis] <= inner {
                        break;
                    }
                    if !std::mem::replace(&mut is_seen[k], true) {
                        found = found.into_iter().chain(self.exact_box(&self.list[k])).reduce(joined);
                    }
                }
            }
        }
        found
    }

    /// The box around the vertices of an instance.
    fn exact_box(&self, instance: &Instance) -> Option<(DVec3, DVec3)> {
        let own = &self.base.positions[places(&instance.vertices)];
        let placed = |p: &DVec3| {
            let p = instance.placed(*p);
            Some((p, p))
        };
        parallel::reduce(own, placed, joined)
    }

    /// A copy of each mesh at each of its places, as one mesh. [`Instances::check_copies`] says whether they fit the memory. One thread makes them:
    /// others may wait for them in loops on all cores.
    pub fn copies(&self) -> Mesh {
        let Instances { base, list } = self;
        let mut mesh = Mesh {
            uvs: base.uvs.clone(),
            colors: base.colors.clone(),
            materials: base.materials.clone(),
            missing: base.missing.clone(),
            has_capsules: base.has_capsules,
            ..Mesh::default()
        };
        for instance in list {
            let shifted = |from: u32, to: usize| move |k: u32| if k == NO_NORMAL { k } else { k - from + to as u32 };
            let vertex = shifted(instance.vertices.start, mesh.positions.len());
            let normal = shifted(instance.normals.start, mesh.normals.len());
            mesh.triangles.extend(instance.own(&base.triangles).iter().map(|t| t.map_each(vertex)));
            mesh.corner_normals.extend(instance.own(&base.corner_normals).iter().map(|t| t.map_each(normal)));
            mesh.corner_uvs.extend_from_slice(instance.own(&base.corner_uvs));
            mesh.corner_colors.extend_from_slice(instance.own(&base.corner_colors));
            mesh.material_of.extend_from_slice(instance.own(&base.material_of));
            mesh.radii.extend(instance.own(&base.radii).iter().map(|radius| radius * instance.size()));
            mesh.positions.extend(self.placed_vertices(instance));
            mesh.normals.extend(self.placed_normals(instance));
        }
        mesh
    }

    /// The vertices of an instance in the world.
    fn placed_vertices(&self, instance: &Instance) -> impl Iterator<Item = DVec3> {
        self.base.positions[places(&instance.vertices)].iter().map(|p| instance.placed(*p))
    }

    /// The normals of an instance in the world.
    fn placed_normals(&self, instance: &Instance) -> impl Iterator<Item = Vec3> {
        let matrix = instance.normal_matrix();
        let own = &self.base.normals[places(&instance.normals)];
        own.iter().map(move |normal| matrix.map_or(*normal, |matrix| transformed_normal(matrix, *normal)))
    }

    /// The copies after the instances in `moved`, given by their indices, got other places; `before` are the copies until then.
    pub fn copies_again(&self, before: &Mesh, moved: &BTreeSet<usize>) -> Mesh {
        let mut mesh = before.clone();
        let (mut first_vertex, mut first_normal) = (0, 0);
        for (k, instance) in self.list.iter().enumerate() {
            if moved.contains(&k) {
                let positions = mesh.positions[first_vertex..].iter_mut();
                positions.zip(self.placed_vertices(instance)).for_each(|(to, p)| *to = p);
                let normals = mesh.normals[first_normal..].iter_mut();
                normals.zip(self.placed_normals(instance)).for_each(|(to, normal)| *to = normal);
            }
            first_vertex += instance.vertices.len();
            first_normal += instance.normals.len();
        }
        mesh
    }

    /// Refuses copies that do not fit the free memory, or indices.
    ///
    /// # Errors
    /// [`Error::Work`] with both sizes, and [`Error::Input`] if there are 2^32 - 1 or more vertices or normals.
    pub fn check_copies(&self, limits: Limits) -> Result<()> {
        let total = |range: fn(&Instance) -> &Range<u32>| self.list.iter().map(|i| range(i).len()).sum::<usize>();
        let (vertices, normals) = (self.vertex_count(), total(|i| &i.normals));
        let triangles = self.triangle_count();
        if vertices.max(normals) >= u32::MAX as usize {
            return Err(Error::input(format!(
                "a copy of each mesh at each of its places has {} vertices; at most 2^32 - 2 are possible: use fewer places",
                vertices.max(normals)
            )));
        }
        let places = self.list.len();
        let what = format_args!("a copy of each mesh at each of {places} places, {triangles} triangles in all,");
        check_memory(limits, (triangles as u64, vertices as u64), what, "use fewer places")
    }
}

/// As a range of places in a list.
fn places(range: &Range<u32>) -> Range<usize> {
    range.start as usize..range.end as usize
}

/// How many triangles, vertices and normals a mesh has.
fn counts(mesh: &Mesh) -> [u32; 3] {
    // `merge` refuses more than a u32 holds
    let count = |count: usize| count.min(u32::MAX as usize) as u32;
    [mesh.triangles.len(), mesh.positions.len(), mesh.normals.len()].map_each(count)
}

/// The triangles of a mesh in all places.
fn triangles_of((mesh, runs): &Part) -> usize {
    let of_runs = |runs: &Arc<[Run]>| runs.iter().map(|run| run.triangles.len()).fold(0, usize::saturating_add);
    runs.as_ref().map_or(mesh.triangles.len(), of_runs)
}

/// The id after those of all instances.
fn end_id(list: &[Instance]) -> usize {
    list.last().map_or(0, |last| last.first_id as usize + last.triangles.len())
}

/// Adds the instances of a mesh that lies behind so many triangles, vertices and normals in the base mesh.
fn add_places(list: &mut Vec<Instance>, (mesh, runs): &Part, firsts: [u32; 3]) {
    let mut boxes = HashMap::new();
    let mut add = |run: &Run, matrix: Option<DAffine3>| {
        let bounds = *boxes.entry(run.vertices.clone()).or_insert_with(|| run.bounds(mesh));
        let shifted = |own: &Range<u32>, by: u32| own.start.saturating_add(by)..own.end.saturating_add(by);
        list.push(Instance {
            first_id: end_id(list) as u32,
            triangles: shifted(&run.triangles, firsts[0]),
            vertices: shifted(&run.vertices, firsts[1]),
            normals: shifted(&run.normals, firsts[2]),
            bounds,
            matrix,
        });
    };
    match runs {
        Some(runs) => runs.iter().for_each(|run| add(run, Some(run.matrix))),
        None => add(&Run::whole(mesh, DAffine3::IDENTITY), None),
    }
}

/// Whether so many triangles in places take much less memory as meshes of so many triangles, and their places.
pub fn saves_memory(triangles: usize, of_meshes: usize, places: usize) -> bool {
    triangles > COPIED_MAX && triangles >= 2 * of_meshes && triangles >= TRIANGLES_A_PLACE * places
}

/// Refuses more triangles than ids can number.
fn check_triangles(triangles: usize) -> Result<()> {
    if triangles > MAX_TRIANGLES {
        return Err(Error::input(format!(
            "the scene has {triangles} triangles in all places, at most 2^28 are possible; use fewer"
        )));
    }
    Ok(())
}

/// The box around some points.
fn bounds_of(points: &[DVec3]) -> (DVec3, DVec3) {
    parallel::reduce(points, |p| Some((*p, *p)), joined).unwrap_or((DVec3::INFINITY, DVec3::NEG_INFINITY))
}

/// The largest condition number of a matrix whose inverse takes rays to the base mesh: up to it, the inverse in f64 is right to far below f32.
const CONDITION_MAX: f64 = (1 << 12) as f64;

/// The least size of a mesh, relative to that of all together, of which f32 arithmetic takes rays to the base mesh.
const SIZE_MIN: f64 = 1e-18;

impl Instance {
    /// The inverse of its matrix without the translation, and the condition number of the matrix, its columns scaled to one size. Returns `None`
    /// for a matrix close to a singular one.
    pub fn inverse(&self) -> Option<(DMat3, f64)> {
        let Some(DAffine3 { matrix3: m, .. }) = self.matrix.filter(|_| !self.is_point()) else {
            return Some((DMat3::IDENTITY, 1.0));
        };
        let sizes = [m.x_axis, m.y_axis, m.z_axis].map_each(|axis| axis.abs().max_element());
        let even = DMat3::from_cols(m.x_axis / sizes[0], m.y_axis / sizes[1], m.z_axis / sizes[2]);
        let back = even.inverse();
        let condition = largest_row_sum(even) * largest_row_sum(back);
        let inverse = DMat3::from_diagonal(DVec3::from_array(sizes).recip()) * back;
        (condition <= CONDITION_MAX && inverse.is_finite()).then_some((inverse, condition))
    }

    /// The part of a list of the base mesh's triangles that the instance has; empty if the list is.
    fn own<'a, T>(&self, of_triangles: &'a [T]) -> &'a [T] {
        of_triangles.get(places(&self.triangles)).unwrap_or_default()
    }

    /// A vertex of its mesh in the world.
    pub fn placed(&self, p: DVec3) -> DVec3 {
        self.matrix.map_or(p, |matrix| matrix.transform_point3(p))
    }

    /// Whether its matrix puts all vertices in one place: its triangles have no area.
    pub fn is_point(&self) -> bool {
        self.matrix.is_some_and(|matrix| matrix.matrix3 == DMat3::ZERO)
    }

    /// Whether its matrix mirrors it.
    pub fn is_mirrored(&self) -> bool {
        self.matrix.is_some_and(|DAffine3 { matrix3: m, .. }| {
            // of any size: a determinant may leave the range of f64
            let [x, y, z] = [m.x_axis, m.y_axis, m.z_axis].map_each(|axis| axis / axis.abs().max_element());
            x.dot(y.cross(z)) < 0.0
        })
    }

    /// A normal of its mesh in the world.
    pub fn placed_normal(&self, normal: Vec3) -> Vec3 {
        self.normal_matrix().map_or(normal, |matrix| transformed_normal(matrix, normal))
    }

    /// The matrix that takes normals of its mesh to the world; `None`: they are as in the mesh.
    fn normal_matrix(&self) -> Option<DMat3> {
        self.matrix.and_then(|matrix| world_normal_from_object(matrix.matrix3))
    }

    /// The factor by which its matrix scales spheres.
    fn size(&self) -> f64 {
        self.matrix.map_or(1.0, |matrix| size_of(&matrix))
    }

    /// By how much its box in the world is larger than that of its vertices may be, for rounding.
    fn box_rounding(&self) -> DVec3 {
        self.matrix.map_or(DVec3::ZERO, |matrix| rounding_of(&matrix, self.bounds))
    }

    /// A box in the world that holds a box of the base mesh at its place, whatever is rounded.
    pub fn placed_box(&self, corners: (DVec3, DVec3)) -> (DVec3, DVec3) {
        self.matrix.map_or(corners, |matrix| placed_box(&matrix, corners))
    }
}

/// A box that holds a box at a place, whatever is rounded.
pub fn placed_box(matrix: &DAffine3, (lo, hi): (DVec3, DVec3)) -> (DVec3, DVec3) {
    if lo.cmpgt(hi).any() {
        return (lo, hi);
    }
    let (centre, half) = ((lo + hi) / 2.0, (hi - lo) / 2.0);
    let sizes = [matrix.matrix3.x_axis, matrix.matrix3.y_axis, matrix.matrix3.z_axis].map_each(DVec3::abs);
    let of = |v: DVec3| sizes[0] * v.x + sizes[1] * v.y + sizes[2] * v.z;
    let (middle, reach) = (matrix.transform_point3(centre), of(half));
    let rounding = rounding_of(matrix, (lo, hi));
    (middle - reach - rounding, middle + reach + rounding)
}

fn rounding_of(matrix: &DAffine3, (lo, hi): (DVec3, DVec3)) -> DVec3 {
    let sizes = [matrix.matrix3.x_axis, matrix.matrix3.y_axis, matrix.matrix3.z_axis].map_each(DVec3::abs);
    let far = lo.abs().max(hi.abs());
    BOX_ROUNDING * (sizes[0] * far.x + sizes[1] * far.y + sizes[2] * far.z + matrix.translation.abs())
}

/// A vertex of a mesh that is not finite, or a corner of the box around a run of the mesh that is not.
pub fn infinite_vertex((mesh, runs): &Part) -> Option<DVec3> {
    let is_far = |p: &DVec3| !p.is_finite();
    let of_mesh = parallel::reduce(&mesh.positions, |p| is_far(p).then_some(*p), |first, _| first);
    of_mesh.or_else(|| {
        let mut boxes = HashMap::new();
        let placed = |run: &Run| {
            let bounds = *boxes.entry(run.vertices.clone()).or_insert_with(|| run.bounds(mesh));
            let (lo, hi) = placed_box(&run.matrix, bounds);
            (!run.vertices.is_empty()).then_some([lo, hi])
        };
        runs.iter().flat_map(|runs| runs.iter()).filter_map(placed).flatten().find(is_far)
    })
}

/// The roundings of a placed corner and of the box around it: fewer than 16, each 2^-53 of the sizes that are added up.
const BOX_ROUNDING: f64 = 16.0 * f64::EPSILON;

/// The largest sum of the sizes of a row's numbers.
pub fn largest_row_sum(m: DMat3) -> f64 {
    (m.x_axis.abs() + m.y_axis.abs() + m.z_axis.abs()).max_element()
}

#[cfg(test)]
mod tests;
