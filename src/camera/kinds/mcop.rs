//! `mcop`: a multiple-center-of-projection image: a camera on a path takes one column after the other.
//!
//! Rademacher and Bishop 1998, sections 3 and 4.

use super::{POSE, Pose};
use crate::arrays::MapEach;
use crate::camera::recipe::{Built, Recipe, Setting};
use crate::camera::tessellate::{self, Tessellation};
use crate::camera::values::{direction, half_tangent, length, word};
use crate::camera::view::view;
use crate::camera::{Ray, RayMap};
use crate::input::Result;
use crate::input::reader::{Field, Table};
use glam::DVec3;
use std::sync::Arc;

#[derive(Debug, PartialEq)]
struct Mcop {
    map: Columns,
    tessellation: Tessellation,
}

#[derive(Debug, Clone, PartialEq)]
struct Columns {
    path: Path,
    /// tan(vfov / 2).
    k: f64,
}

#[derive(Debug, Clone, PartialEq)]
enum Path {
    /// Equally far apart in a; the last one is at a = 1, or with `closed` the first one again.
    Keys { keys: Vec<Key>, smooth: bool, closed: bool },
    /// Around `target`'s axis, ever looking at it.
    Circle { target: DVec3, start: DVec3, axis: DVec3, sweep: f64 },
}

/// eye, target, up.
type Key = [DVec3; 3];

pub fn read(table: &Table) -> Result<Arc<dyn Recipe>> {
    let own = ["kind", "t_range", "path", "circle", "vfov", "interpolation", "closed"];
    table.allow(&[&own[..], &tessellate::KEYS].concat())?;
    let path = match (table.get("path"), table.get("circle")) {
        (Some(_), Some(circle)) => return Err(circle.error("the camera has a path already; give one of the two")),
        (None, Some(circle)) => read_circle(table, &circle)?,
        (_, None) => read_keys(table)?,
    };
    let k = half_tangent(&table.need("vfov", "40")?)?;
    Ok(Arc::new(Mcop { map: Columns { path, k }, tessellation: Tessellation::read(table)? }))
}

fn read_keys(table: &Table) -> Result<Path> {
    let field =
        table.need("path", "[{ eye = [-4, 1, 5], target = [0, 0, 0] }, { eye = [4, 1, 5], target = [0, 0, 0] }]")?;
    let keys = field.items("a list of { eye, target, up }")?.map(|f| read_key(&f)).collect::<Result<Vec<Key>>>()?;
    if keys.len() < 2 {
        return Err(field.error("a path needs two cameras at least"));
    }
    let ways = [("linear", false), ("catmull-rom", true)];
    let smooth = table.or("interpolation", false, |f| word(f, &ways, "is \"linear\" or \"catmull-rom\""))?;
    Ok(Path::Keys { keys, smooth, closed: table.or("closed", false, Field::boolean)? })
}

fn read_key(field: &Field) -> Result<Key> {
    let table = field.table()?;
    table.allow(&POSE)?;
    let pose = Pose::read(&table)?;
    let key = [pose.eye, pose.target, pose.up];
    view(key[0], key[1], key[2])
        .map_err(|_| field.error("no view: eye and target coincide, or up lies along the view"))?;
    Ok(key)
}

fn read_circle(table: &Table, field: &Field) -> Result<Path> {
    if let Some(key) = ["interpolation", "closed"].into_iter().find_map(|key| table.get(key)) {
        return Err(key.error("goes with path, not with circle; leave it out"));
    }
    let circle = field.table()?;
    circle.allow(&["center", "axis", "front", "radius", "elevation", "sweep"])?;
    let target = circle.or("center", DVec3::ZERO, Field::vec3)?;
    let axis = circle.or("axis", DVec3::Y, direction)?;
    let front = circle.or("front", DVec3::Z, direction)?;
    let radius = length(&circle.need("radius", "8")?)?;
    let elevation = circle.or("elevation", 0.0, Field::number)?;
    let right = view(front, DVec3::ZERO, axis)
        .map_err(|_| field.error("front is parallel to axis; give a direction to a side of it"))?
        .right;
    let start = target + radius * right.cross(axis) + elevation * axis;
    Ok(Path::Circle { target, start, axis, sweep: circle.or("sweep", 360.0, Field::number)? })
}

impl Recipe for Mcop {
    fn build(&self, setting: &Setting) -> Result<Built> {
        self.tessellation.build(Arc::new(self.map.clone()), setting)
    }
}

impl Path {
    /// The camera of the column at `a`.
    fn at(&self, a: f64) -> Key {
        match self {
            Path::Circle { target, start, axis, sweep } => {
                let (sin, cos) = (sweep * (a - 0.5)).to_radians().sin_cos();
                let out = *start - *target;
                let along = out.dot(*axis) * *axis;
                [*target + along + cos * (out - along) + sin * axis.cross(out), *target, *axis]
            }
            Path::Keys { keys, smooth, closed } => {
                let legs = if *closed { keys.len() } else { keys.len() - 1 };
                let place = a * legs as f64;
                let leg = place.floor().clamp(0.0, legs as f64 - 1.0);
                let s = place - leg;
                let near = |k: i64| neighbour(keys, leg as i64 + k, *closed);
                let [before, from, to, after] = [near(-1), near(0), near(1), near(2)];
                [0, 1, 2].map_each(|c| {
                    if *smooth { spline(before[c], from[c], to[c], after[c], s) } else { from[c].lerp(to[c], s) }
                })
            }
        }
    }
}

/// The key of this number; beyond the ends of an open path it goes on straight.
fn neighbour(keys: &[Key], k: i64, closed: bool) -> Key {
    let n = keys.len() as i64;
    let beyond = |end: &Key, inner: &Key| [0, 1, 2].map_each(|c| 2.0 * end[c] - inner[c]);
    match k {
        _ if closed => keys[k.rem_euclid(n) as usize],
        _ if k < 0 => beyond(&keys[0], &keys[1]),
        _ if k >= n => beyond(&keys[keys.len() - 1], &keys[keys.len() - 2]),
        _ => keys[k as usize],
    }
}

/// Catmull and Rom's cubic from `p1` at s = 0 to `p2` at s = 1.
fn spline(p0: DVec3, p1: DVec3, p2: DVec3, p3: DVec3, s: f64) -> DVec3 {
    let (m1, m2) = ((p2 - p0) / 2.0, (p3 - p1) / 2.0);
    let bend = p2 - p1;
    p1 + s * (m1 + s * (3.0 * bend - 2.0 * m1 - m2 + s * (m1 + m2 - 2.0 * bend)))
}

impl RayMap for Columns {
    fn ray(&self, a: f64, b: f64) -> Option<Ray> {
        let [eye, target, up] = self.path.at(a);
        let view = view(eye, target, up).ok()?;
        Some(Ray { origin: eye, direction: view.forward + (1.0 - 2.0 * b) * self.k * view.up })
    }
}
