//! Vertices that move while an image is taken: their positions and normals at several times, and linear between two of them.

use super::mesh::{Mesh, joined};
use super::primitive::Primitive;
use crate::arrays::MapEach;
use crate::parallel;
use glam::{DVec3, Vec3};
use std::ops::Range;

/// Most times of a frame: a [`Moment`] has 8 bits for them.
pub const TIMES_MAX: usize = 1 << 8;

/// Parts that the way from a time to the next is divided into. A pixel's time is rounded to one of them, so that the share of the way is
/// the same number in f32 and f64.
const PARTS: u32 = 1 << 24;

/// Of the size of a position that two interpolations between others gave, each with up to eight roundings.
const STRAIGHT_ROUNDING: f64 = 16.0 * f64::EPSILON;

/// A mesh at several times.
#[derive(Debug, Clone, PartialEq)]
pub struct TimeSteps {
    /// Ascending, at least two and at most [`TIMES_MAX`]; frames after the frame that is rendered.
    times: Vec<f64>,
    /// One for each time.
    steps: Vec<TimeStep>,
}

/// A mesh at one time.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TimeStep {
    /// World space, in the order of [`Mesh::positions`]; vertices after its last one stand still.
    pub positions: Vec<DVec3>,
    /// Unit, in the order of [`Mesh::normals`].
    pub normals: Vec<Vec3>,
}

/// A time: the number of the last time step at or before it, and the share of the way to the next.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Moment {
    pub step: u32,
    /// In parts of 2^-24, less than a whole.
    part: u32,
}

impl Moment {
    /// The share of the way to the next step, in [0, 1): a number of f32.
    pub fn share(self) -> f64 {
        f64::from(self.part) / f64::from(PARTS)
    }

    /// As kernels read it: the step in the high 8 bits.
    pub fn word(self) -> u32 {
        self.step << 24 | self.part
    }
}

impl TimeSteps {
    /// From times and the mesh at each; `None` if there are less than two, or nothing moves.
    pub fn new(times: Vec<f64>, steps: Vec<TimeStep>) -> Option<TimeSteps> {
        let moves = steps.iter().skip(1).any(|step| step.positions != steps[0].positions);
        moves.then(|| TimeSteps::all(times, steps))
    }

    /// The same of a mesh that lies at `own` where it has no time; `None` if it does at all of these times.
    pub fn beside(own: &Mesh, times: Vec<f64>, steps: Vec<TimeStep>) -> Option<TimeSteps> {
        let moves = times.len() > 1 && steps.iter().any(|step| step.positions != own.positions);
        moves.then(|| TimeSteps::all(times, steps))
    }

    fn all(times: Vec<f64>, steps: Vec<TimeStep>) -> TimeSteps {
        debug_assert!(times.len() == steps.len() && times.len() <= TIMES_MAX && times.is_sorted());
        TimeSteps { times, steps }
    }

    pub fn count(&self) -> u32 {
        self.steps.len() as u32
    }

    /// Changes the positions of all vertices at all times.
    pub fn for_each_position(&mut self, change: impl Fn(&mut DVec3)) {
        self.steps.iter_mut().flat_map(|step| &mut step.positions).for_each(change);
    }

    /// Bytes of all steps.
    #[cfg(feature = "internals")]
    pub fn bytes(&self) -> u64 {
        let one = |s: &TimeStep| size_of_val(s.positions.as_slice()) + size_of_val(s.normals.as_slice());
        self.steps.iter().map(|s| one(s) as u64).sum()
    }

    /// A time in frames, rounded to a part of the way between two steps. Before the first and after the last nothing moves.
    pub fn moment(&self, time: f64) -> Moment {
        let (step, share) = between(&self.times, time);
        match (share * f64::from(PARTS)).round() as u32 {
            PARTS => Moment { step: step as u32 + 1, part: 0 },
            part => Moment { step: step as u32, part },
        }
    }

    /// A vertex of the mesh at a time step; the step after the last is the last.
    pub fn position(&self, mesh: &Mesh, vertex: u32, step: u32) -> DVec3 {
        let step = &self.steps[(step as usize).min(self.steps.len() - 1)];
        step.positions.get(vertex as usize).copied().unwrap_or_else(|| mesh.positions[vertex as usize])
    }

    /// A normal of the mesh at a time step, likewise.
    pub fn normal(&self, mesh: &Mesh, normal: u32, step: u32) -> Vec3 {
        let step = &self.steps[(step as usize).min(self.steps.len() - 1)];
        step.normals.get(normal as usize).copied().unwrap_or_else(|| mesh.normals[normal as usize])
    }

    /// A vertex at a time.
    pub fn position_at(&self, mesh: &Mesh, vertex: u32, at: Moment) -> DVec3 {
        let [a, b] = [at.step, at.step + 1].map_each(|step| self.position(mesh, vertex, step));
        a + at.share() * (b - a)
    }

    /// A normal at a time, not of unit length.
    pub fn normal_at(&self, mesh: &Mesh, normal: u32, at: Moment) -> DVec3 {
        let [a, b] = [at.step, at.step + 1].map_each(|step| self.normal(mesh, normal, step).as_dvec3());
        a + at.share() * (b - a)
    }

    /// The same where a mesh that stands still is put before.
    #[cfg(feature = "view")]
    pub fn after(&self, before: &Mesh) -> TimeSteps {
        let joined = |s: &TimeStep| TimeStep {
            positions: [&before.positions[..], &s.positions].concat(),
            normals: [&before.normals[..], &s.normals].concat(),
        };
        TimeSteps { times: self.times.clone(), steps: self.steps.iter().map(joined).collect() }
    }

    /// A vertex at any time, without rounding it.
    fn exact_position(&self, mesh: &Mesh, vertex: u32, time: f64) -> DVec3 {
        let (step, share) = between(&self.times, time);
        let [a, b] = [step, step + 1].map_each(|k| self.position(mesh, vertex, k as u32));
        a + share * (b - a)
    }

    /// The mesh as it moves already, if it does, and a run of its vertices by itself: at each of these times, ascending, as many positions as
    /// the run has vertices; constant before the first and after the last time. Times at which the run alone moved otherwise are left out.
    /// `None` if nothing moves.
    pub fn with(
        before: Option<&TimeSteps>,
        mesh: &Mesh,
        vertices: Range<usize>,
        (times, positions): (&[f64], &[Vec<DVec3>]),
    ) -> Option<TimeSteps> {
        let needed = before.map_or_else(Vec::new, |b| b.needed_times(mesh, &vertices));
        let mut all: Vec<f64> = needed.iter().chain(times).copied().collect();
        all.sort_by(f64::total_cmp);
        all.dedup();
        let count = vertices.end.max(before.map_or(0, |b| b.steps[0].positions.len()));
        let normals = before.map_or_else(Vec::new, |b| b.steps[0].normals.clone());
        let step = |time: &f64| {
            let (k, share) = between(times, *time);
            let next = (k + 1).min(times.len() - 1);
            let own = |v: usize| positions[k][v] + share * (positions[next][v] - positions[k][v]);
            let other =
                |v: u32| before.map_or_else(|| mesh.positions[v as usize], |b| b.exact_position(mesh, v, *time));
            let position = |v: usize| if vertices.contains(&v) { own(v - vertices.start) } else { other(v as u32) };
            let normals =
                (0..normals.len() as u32).map(|n| before.map_or(Vec3::ZERO, |b| b.exact_normal(mesh, n, *time)));
            TimeStep { positions: parallel::map(0..count, position), normals: normals.collect() }
        };
        let steps = all.iter().map(step).collect();
        TimeSteps::new(all, steps)
    }

    /// The times at which vertices other than these, or normals, do not move on straight as before: none where they stand still.
    fn needed_times(&self, mesh: &Mesh, but: &Range<usize>) -> Vec<f64> {
        let others = || (0..self.steps[0].positions.len()).filter(|v| !but.contains(v));
        let normals = 0..self.steps[0].normals.len() as u32;
        let is_same = |a: usize, b: usize| {
            let [a, b] = [a, b].map_each(|k| k as u32);
            others().all(|v| self.position(mesh, v as u32, a) == self.position(mesh, v as u32, b))
                && normals.clone().all(|n| self.normal(mesh, n, a) == self.normal(mesh, n, b))
        };
        let is_between = |a: usize, k: usize, b: usize| {
            let share = (self.times[k] - self.times[a]) / (self.times[b] - self.times[a]);
            let is_straight = |v: usize| {
                let [p, q, r] = [a, k, b].map_each(|k| self.position(mesh, v as u32, k as u32));
                let reach = p.abs().max(r.abs()).max_element();
                (q - (p + share * (r - p))).abs().max_element() <= STRAIGHT_ROUNDING * reach
            };
            let is_steady = |n: u32| {
                let [p, q, r] = [a, k, b].map_each(|k| self.normal(mesh, n, k as u32));
                p == q && q == r
            };
            others().all(is_straight) && normals.clone().all(is_steady)
        };
        let mut kept: Vec<usize> = (0..self.times.len()).collect();
        let mut at = 0;
        while at < kept.len() {
            let [before, after] = [at.checked_sub(1), Some(at + 1)].map_each(|k| k.and_then(|k| kept.get(k).copied()));
            let is_left_out = match (before, after) {
                (Some(a), Some(b)) => is_between(a, kept[at], b),
                (None, Some(other)) | (Some(other), None) => is_same(other, kept[at]),
                (None, None) => true,
            };
            if is_left_out {
                kept.remove(at);
            } else {
                at += 1;
            }
        }
        kept.into_iter().map(|k| self.times[k]).collect()
    }

    /// These normals are the same at all times.
    pub fn set_normals(&mut self, range: Range<usize>, normals: &[Vec3]) {
        for step in &mut self.steps {
            if let Some(own) = step.normals.get_mut(range.clone()) {
                own.copy_from_slice(normals);
            }
        }
    }

    fn exact_normal(&self, mesh: &Mesh, normal: u32, time: f64) -> Vec3 {
        let (step, share) = between(&self.times, time);
        let [a, b] = [step, step + 1].map_each(|k| self.normal(mesh, normal, k as u32).as_dvec3());
        (a + share * (b - a)).normalize_or(a).as_vec3()
    }

    /// The corners of the box around all vertices and spheres at all times; `None` without any.
    pub fn bounds(&self, mesh: &Mesh) -> Option<(DVec3, DVec3)> {
        let one = |p: &DVec3| Some((*p, *p));
        let of_step = |s: &TimeStep| parallel::reduce(&s.positions, one, joined);
        let still = self.steps[0].positions.len().min(mesh.positions.len());
        let others = parallel::reduce(&mesh.positions[still..], one, joined);
        let moving = MovingMesh { mesh, steps: Some(self) };
        let of_round = |id: u32| {
            let boxes = (0..self.count()).map(|step| Some(moving.primitive(id, step).capsule()?.bounds()));
            boxes.flatten().reduce(joined)
        };
        let spheres = parallel::reduce(0..mesh.radii.len() as u32, of_round, joined);
        self.steps.iter().filter_map(of_step).chain(others).chain(spheres).reduce(joined)
    }
}

/// A mesh, and how it moves if it does.
#[derive(Debug, Clone, Copy)]
pub struct MovingMesh<'a> {
    pub mesh: &'a Mesh,
    pub steps: Option<&'a TimeSteps>,
}

/// One that stands still.
impl<'a> From<&'a Mesh> for MovingMesh<'a> {
    fn from(mesh: &'a Mesh) -> MovingMesh<'a> {
        MovingMesh { mesh, steps: None }
    }
}

impl<'a> MovingMesh<'a> {
    /// Time steps; 1 if it stands still.
    pub fn count(self) -> u32 {
        self.steps.map_or(1, TimeSteps::count)
    }

    /// A vertex at a time step.
    pub fn position(self, vertex: u32, step: u32) -> DVec3 {
        self.steps.map_or_else(|| self.mesh.positions[vertex as usize], |s| s.position(self.mesh, vertex, step))
    }

    /// A normal at a time step.
    pub fn normal(self, normal: u32, step: u32) -> Vec3 {
        self.steps.map_or_else(|| self.mesh.normals[normal as usize], |s| s.normal(self.mesh, normal, step))
    }

    /// The corners of a triangle at a time step, in the order of its file.
    pub fn corners(self, id: u32, step: u32) -> [DVec3; 3] {
        self.mesh.triangles[id as usize].map_each(|v| self.position(v, step))
    }

    /// A triangle, sphere or capsule at a time step.
    pub fn primitive(self, id: u32, step: u32) -> Primitive {
        Primitive::new(self.corners(id, step), self.mesh.radius(id))
    }

    /// The corners of the box around all vertices at all times; `None` without any.
    pub fn bounds(self) -> Option<(DVec3, DVec3)> {
        self.steps.map_or_else(|| self.mesh.bounds(), |steps| steps.bounds(self.mesh))
    }
}

/// The last of some ascending times at or before a time, and the share of the way to the next; the ends for times beyond.
fn between(times: &[f64], time: f64) -> (usize, f64) {
    if times.len() < 2 {
        return (0, 0.0);
    }
    let next = times.partition_point(|t| *t <= time).clamp(1, times.len() - 1);
    let share = (time - times[next - 1]) / (times[next] - times[next - 1]);
    (next - 1, share.clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn steps(times: &[f64]) -> TimeSteps {
        let step = |t: &f64| TimeStep { positions: vec![DVec3::X * *t * *t], normals: Vec::new() };
        TimeSteps::new(times.to_vec(), times.iter().map(step).collect()).unwrap()
    }

    #[test]
    fn positions_are_those_of_steps_and_linear_between_them() {
        let (steps, mesh) = (steps(&[-1.0, 1.0, 2.0, 4.0]), Mesh::default());
        let at = |time: f64| steps.position_at(&mesh, 0, steps.moment(time)).x;
        for (time, x) in [(-9.0, 1.0), (-1.0, 1.0), (0.0, 1.0), (1.0, 1.0), (1.5, 2.5), (2.0, 4.0), (3.0, 10.0)] {
            assert_eq!(at(time), x, "{time}");
        }
        assert_eq!([at(4.0), at(5.0)], [16.0; 2]);
        // one part of 2^-24 of two frames, and of the 12 units on the way
        for time in [2.3, 3.999_999_9, 2.000_000_1] {
            let exact = 4.0 + 12.0 * (time - 2.0) / 2.0;
            assert!((at(time) - exact).abs() <= 12.0 / f64::from(PARTS), "{time}");
        }
    }

    #[test]
    fn a_share_is_the_same_in_f32_and_fits_its_word() {
        let steps = steps(&[0.0, 1.0, 2.0]);
        for k in 0..1000 {
            let at = steps.moment(f64::from(k) / 499.5);
            assert_eq!(f64::from(at.share() as f32), at.share());
            let word = at.word();
            assert_eq!((word >> 24, f64::from(word & 0xff_ffff) / f64::from(PARTS)), (at.step, at.share()));
        }
    }

    #[test]
    fn what_stands_still_has_no_steps() {
        let step = TimeStep { positions: vec![DVec3::ONE], normals: Vec::new() };
        assert_eq!(TimeSteps::new(vec![0.0, 1.0], vec![step.clone(), step]), None);
    }

    #[test]
    fn a_run_of_vertices_moves_beside_others() {
        let mesh = Mesh { positions: vec![DVec3::ZERO, DVec3::Y, DVec3::Z], ..Mesh::default() };
        let first = TimeSteps::with(None, &mesh, 1..2, (&[0.0, 2.0], &[vec![DVec3::Y], vec![3.0 * DVec3::Y]])).unwrap();
        let both = TimeSteps::with(
            Some(&first),
            &mesh,
            2..3,
            (&[1.0, 2.0, 5.0], &[vec![DVec3::Z], vec![DVec3::X], vec![DVec3::Z]]),
        );
        let both = both.unwrap();
        assert_eq!((first.count(), both.count()), (2, 4));
        let at = |v: u32, time: f64| both.position_at(&mesh, v, both.moment(time));
        for (time, y) in [(-1.0, 1.0), (0.5, 1.5), (1.0, 2.0), (1.5, 2.5), (4.0, 3.0)] {
            assert_eq!(at(1, time), y * DVec3::Y, "{time}");
        }
        let half = 0.5 * (DVec3::X + DVec3::Z);
        for (time, p) in [(0.5, DVec3::Z), (1.5, half), (2.0, DVec3::X), (3.5, half), (9.0, DVec3::Z)] {
            assert_eq!(at(2, time), p, "{time}");
        }
        assert_eq!(at(0, 1.7), DVec3::ZERO);
    }

    #[test]
    fn times_of_an_earlier_movement_are_forgotten() {
        let mesh = Mesh { positions: vec![DVec3::ZERO, DVec3::Y], ..Mesh::default() };
        // one vertex moves for good, and not straight
        let turns = [DVec3::Y, DVec3::new(0.3, 0.7, 0.1), DVec3::X].map(|p| vec![p]);
        let mut steps = TimeSteps::with(None, &mesh, 1..2, (&[0.0, 0.7, 1000.0], &turns)).unwrap();
        for k in 0..600 {
            let (from, to) = (f64::from(k), f64::from(k) + 1.1);
            let moves = [from, to].map(|x| vec![x * DVec3::X]);
            steps = TimeSteps::with(Some(&steps), &mesh, 0..1, (&[from, to], &moves)).unwrap();
            assert!(steps.count() <= 5, "{k}: {:?}", steps.times);
        }
        let at = |time: f64| steps.position_at(&mesh, 1, steps.moment(time));
        for (time, expected) in [(0.0, DVec3::Y), (0.7, turns[1][0]), (1000.0, DVec3::X)] {
            assert!((at(time) - expected).length() < 1e-12, "{time}: {}", at(time));
        }
        // of one that stands still again nothing is left
        let still = TimeSteps::with(Some(&steps), &mesh, 0..1, (&[0.0], &[vec![DVec3::ZERO]])).unwrap();
        assert_eq!(still.times, [0.0, 0.7, 1000.0]);
    }

    #[test]
    fn vertices_after_the_last_stand_still() {
        let steps = steps(&[0.0, 1.0]);
        let mesh = Mesh { positions: vec![DVec3::ZERO, DVec3::new(3.0, -1.0, 0.0)], ..Mesh::default() };
        assert_eq!(steps.position_at(&mesh, 1, steps.moment(0.5)), mesh.positions[1]);
        assert_eq!(steps.bounds(&mesh), Some((DVec3::new(0.0, -1.0, 0.0), DVec3::new(3.0, 0.0, 0.0))));
    }
}
