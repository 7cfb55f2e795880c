//! The `pieces` surface: triangles over (u, v), linear on each, and nothing outside them.

use crate::arrays::MapEach;
use crate::camera::mesh::spec::read_triangles;
use crate::camera::pieces::side;
use crate::input::Result;
use crate::input::reader::{Field, Table};
use glam::{DVec2, DVec3};

/// Triangles, and a grid over (u, v) to find them by.
#[derive(Debug, Clone, PartialEq)]
pub struct Facets {
    /// Places in (u, v).
    pub images: Vec<DVec2>,
    /// Points of space, one for each place.
    pub points: Vec<DVec3>,
    pub triangles: Vec<[u32; 3]>,
    grid: Grid,
}

/// For each of `count` x `count` cells over a box, the triangles whose boxes meet it, ascending.
#[derive(Debug, Clone, PartialEq)]
struct Grid {
    low: DVec2,
    high: DVec2,
    count: usize,
    cells: Vec<Vec<u32>>,
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
        Ok(Facets { grid: Grid::new(&images, &triangles), images, points, triangles })
    }

    /// The lowest-numbered triangle that holds (u, v), its border included, and the point there.
    pub fn at(&self, uv: DVec2) -> Option<(u32, DVec3)> {
        let contains = |&&k: &&u32| {
            let [a, b, c] = self.corners(k);
            let o = side(a, b, c);
            side(a, b, uv) * o >= 0.0 && side(b, c, uv) * o >= 0.0 && side(c, a, uv) * o >= 0.0
        };
        let k = *self.grid.near(uv).iter().find(contains)?;
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

impl Grid {
    fn new(images: &[DVec2], triangles: &[[u32; 3]]) -> Grid {
        let (low, high) = images.iter().fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |b, p| (b.0.min(*p), b.1.max(*p)));
        let count = ((triangles.len() as f64).sqrt().ceil() as usize).max(1);
        let mut grid = Grid { low, high, count, cells: vec![Vec::new(); count * count] };
        for (k, t) in triangles.iter().enumerate() {
            let [a, b, c] = t.map_each(|i| images[i as usize]);
            let (first, last) = (grid.cell(a.min(b).min(c)), grid.cell(a.max(b).max(c)));
            for (x, y) in (first.1..=last.1).flat_map(|y| (first.0..=last.0).map(move |x| (x, y))) {
                grid.cells[y * count + x].push(k as u32);
            }
        }
        grid
    }

    /// Column and row; the outermost ones beyond the box. Monotone, so that a place in a triangle's box is in its cells.
    fn cell(&self, at: DVec2) -> (usize, usize) {
        let along = |x: f64, low: f64, high: f64| {
            ((x - low) / (high - low) * self.count as f64).clamp(0.0, self.count as f64 - 1.0) as usize
        };
        (along(at.x, self.low.x, self.high.x), along(at.y, self.low.y, self.high.y))
    }

    fn near(&self, at: DVec2) -> &[u32] {
        let (x, y) = self.cell(at);
        &self.cells[y * self.count + x]
    }
}

fn read_vertex(field: &Field) -> Result<(DVec2, DVec3)> {
    let table = field.table()?;
    table.allow(&["image", "at"])?;
    let image: [f64; 2] = table.need("image", "[0, 0]")?.numbers("two numbers, as [u, v]")?;
    Ok((image.into(), table.need("at", "[0, 0, 0]")?.vec3()?))
}
