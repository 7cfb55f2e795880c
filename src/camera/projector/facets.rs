//! The `pieces` surface: triangles over (u, v), linear on each, and nothing outside them.

use crate::arrays::MapEach;
use crate::camera::boxes::{Boxes, around_triangle};
use crate::camera::mesh::spec::read_triangles;
use crate::camera::pieces::{holds, side};
use crate::input::Result;
use crate::input::reader::{Field, Table};
use glam::{DVec2, DVec3};

/// Triangles, and a hierarchy over (u, v) to find them by.
#[derive(Debug, Clone, PartialEq)]
pub struct Facets {
    /// Places in (u, v).
    pub images: Vec<DVec2>,
    /// Points of space, one for each place.
    pub points: Vec<DVec3>,
    pub triangles: Vec<[u32; 3]>,
    boxes: Boxes,
}

impl Facets {
    pub(super) fn read(table: &Table) -> Result<Facets> {
        table.allow(&["kind", "vertices", "triangles"])?;
        let field = table.need("vertices", "[{ image = [0, 0], at = [0, 0, 0] }, ...]")?;
        let vertices: Vec<(DVec2, DVec3)> =
            field.items("a list of vertices")?.map(|vertex| read_vertex(&vertex)).collect::<Result<_>>()?;
        let triangles = read_triangles(table)?;
        let wrong = |message: String| table.need("triangles", "[[0, 1, 2]]").map_or_else(|e| e, |f| f.error(message));
        if triangles.is_empty() {
            return Err(wrong("the surface has no pieces; give at least one triangle".into()));
        }
        for (k, t) in triangles.iter().enumerate() {
            let count = vertices.len();
            if let Some(index) = t.iter().find(|&&index| index as usize >= count) {
                let message = format!("triangle {k}: vertex {index} does not exist; there are {count}, counted from 0");
                return Err(wrong(message));
            }
            let [a, b, c] = t.map_each(|i| vertices[i as usize].0);
            if side(a, b, c) == 0.0 {
                return Err(wrong(format!("triangle {k} has no area over (u, v); remove it")));
            }
        }
        let (images, points): (Vec<_>, Vec<_>) = vertices.into_iter().unzip();
        let boxes = triangles.iter().map(|t| around_triangle(&t.map_each(|i| images[i as usize])));
        Ok(Facets { boxes: Boxes::new(boxes, 1), images, points, triangles })
    }

    /// The lowest-numbered triangle that holds (u, v), its border included, and the point there.
    pub fn at(&self, uv: DVec2) -> Option<(u32, DVec3)> {
        let k = self.boxes.first(uv, &|k| Some(k as u32).filter(|k| holds(self.corners(*k), uv)))?;
        let [a, b, c] = self.corners(k);
        let [p, q, r] = self.triangles[k as usize].map_each(|i| self.points[i as usize]);
        let area = (b - a).perp_dot(c - a);
        let (s, t) = ((uv - a).perp_dot(c - a) / area, (b - a).perp_dot(uv - a) / area);
        Some((k, p + s * (q - p) + t * (r - p)))
    }

    /// The places of triangle `k`.
    pub fn corners(&self, k: u32) -> [DVec2; 3] {
        self.triangles[k as usize].map_each(|i| self.images[i as usize])
    }

    /// The same triangles over (u, v), whatever their points.
    pub fn same_pieces(&self, other: &Facets) -> bool {
        let corners = |f: &Facets, k: usize| f.corners(k as u32);
        let count = self.triangles.len();
        count == other.triangles.len() && (0..count).all(|k| corners(self, k) == corners(other, k))
    }
}

fn read_vertex(field: &Field) -> Result<(DVec2, DVec3)> {
    let table = field.table()?;
    table.allow(&["image", "at"])?;
    let image: [f64; 2] = table.need("image", "[0, 0]")?.numbers("two numbers, as [u, v]")?;
    Ok((image.into(), table.need("at", "[0, 0, 0]")?.vec3()?))
}
