//! `surround`: a closed mesh of cameras around an object, unfolded into the image.
//!
//! Hou, Wei, Shum and Guo 2006, sections 2 and 3.4: each triangle of the mesh is a camera with a ray at each corner, and has a
//! right-angled triangle of one size in the image (their joint texture atlas), so that the packing wastes nothing.

use crate::arrays::MapEach;
use crate::camera::mesh::{half_cell, triangle, welded};
use crate::camera::recipe::{Built, Recipe, Setting};
use crate::camera::values::{direction, length};
use crate::camera::{Pieces, Ray, Rays};
use crate::geometry::generate::icosphere;
use crate::geometry::obj;
use crate::geometry::texture::Images;
use crate::input::Result;
use crate::input::limits::CAMERAS;
use crate::input::reader::{Field, Table};
use crate::parallel;
use glam::{DVec2, DVec3};
use std::collections::HashMap;
use std::sync::Arc;

/// 20 * 4^7 = 327,680 cameras.
const LEVEL_MAX: u64 = 7;

#[derive(Debug, PartialEq)]
struct Surround {
    /// Corners in world units.
    vertices: Vec<DVec3>,
    /// Counter-clockwise seen from outside.
    triangles: Vec<[u32; 3]>,
    /// Unit vectors into the mesh, one per vertex.
    inward: Vec<DVec3>,
    up: DVec3,
    /// Cells in a row of the image; `None`: as many as make cells near-square.
    columns: Option<usize>,
    notes: Vec<String>,
}

pub fn read(table: &Table) -> Result<Arc<dyn Recipe>> {
    let center = table.or("center", DVec3::ZERO, Field::vec3)?;
    let up = table.or("up", DVec3::Y, direction)?;
    let (field, mesh, scale) = match table.get("file") {
        Some(file) => {
            table.allow(&["kind", "t_range", "file", "center", "scale", "up", "columns"])?;
            let mesh = obj::load(&file.path()?, &mut Images::left_out(), file.loading());
            let mesh = mesh.map_err(|e| e.at("camera.file"))?;
            (file, mesh, table.or("scale", 1.0, length)?)
        }
        None => {
            table.allow(&["kind", "t_range", "level", "center", "radius", "up", "columns"])?;
            let radius = table.need("radius", "8")?;
            let level = table.or("level", 2, |f| f.integer(0, LEVEL_MAX))?;
            let scale = length(&radius)?;
            (radius, icosphere(level as u32), scale)
        }
    };
    field.limits().check(CAMERAS, mesh.triangles.len() as u64).map_err(|e| field.error(e))?;
    let columns = table.optional("columns", |f| f.integer(1, mesh.triangles.len().div_ceil(2).max(1) as u64))?;
    let columns = columns.map(|n| n as usize);
    let (vertices, numbers) = welded(mesh.triangles.iter().flatten().map(|i| mesh.positions[*i as usize]));
    let corners = numbers.chunks_exact(3).map(|t| [t[0], t[1], t[2]]);
    let triangles: Vec<[u32; 3]> = corners.filter(|[a, b, c]| a != b && b != c && c != a).collect();
    if triangles.is_empty() {
        return Err(field.error("the mesh has no triangle with three corners; give one around the middle"));
    }
    let vertices: Vec<DVec3> = vertices.into_iter().map(|v| scale * v + center).collect();
    let mut notes = Vec::new();
    let open = border_edges(&triangles);
    if open > 0 {
        notes.push(format!(
            "the camera mesh is not closed: {open} of its edges belong to one triangle alone, or go the wrong way"
        ));
    }
    let inward = inward_normals(&vertices, &triangles).map_err(|v| {
        field.error(format_args!("the mesh has no normal at {v}: triangles without area or back to back; mend it"))
    })?;
    Ok(Arc::new(Surround { vertices, triangles, inward, up, columns, notes }))
}

/// Edges that no other triangle has the other way round.
fn border_edges(triangles: &[[u32; 3]]) -> usize {
    let mut balance: HashMap<(u32, u32), i32> = HashMap::new();
    for [a, b, c] in triangles {
        for (i, j) in [(a, b), (b, c), (c, a)] {
            *balance.entry((*i.min(j), *i.max(j))).or_default() += if i < j { 1 } else { -1 };
        }
    }
    balance.values().filter(|n| **n != 0).count()
}

/// Unit vectors against the mean normal, weighted by area; an error is a vertex that has none.
fn inward_normals(vertices: &[DVec3], triangles: &[[u32; 3]]) -> std::result::Result<Vec<DVec3>, DVec3> {
    let mut sums = vec![DVec3::ZERO; vertices.len()];
    for t in triangles {
        let [a, b, c] = t.map_each(|i| vertices[i as usize]);
        t.iter().for_each(|&i| sums[i as usize] -= (b - a).cross(c - a));
    }
    let used = |k: usize| triangles.iter().any(|t| t.contains(&(k as u32)));
    sums.iter()
        .enumerate()
        .map(|(k, s)| match s.try_normalize() {
            Some(n) => Ok(n),
            // a corner of left-out triangles alone
            None if !used(k) => Ok(DVec3::ZERO),
            None => Err(vertices[k]),
        })
        .collect()
}

impl Surround {
    /// The triangle's corners, in an order that keeps its sense: the first is the image triangle's right angle, and of the
    /// three rotations the one whose upright side points up most.
    fn rotated(&self, t: &[u32; 3], upper: bool) -> [u32; 3] {
        let rotations = [*t, [t[1], t[2], t[0]], [t[2], t[0], t[1]]];
        let rise = |w: &[u32; 3]| {
            let along = self.vertices[w[0] as usize] - self.vertices[w[1] as usize];
            (if upper { along } else { -along }).normalize_or_zero().dot(self.up)
        };
        rotations
            .into_iter()
            .fold(rotations[0], |best, rotation| if rise(&rotation) > rise(&best) { rotation } else { best })
    }
}

impl Recipe for Surround {
    fn build(&self, setting: &Setting) -> Result<Built> {
        let (w, h) = setting.size()?;
        let cells = self.triangles.len().div_ceil(2);
        let near_square = ((cells as f64 * w as f64 / h as f64).sqrt().ceil() as usize).clamp(1, cells.max(1));
        let columns = self.columns.unwrap_or(near_square);
        let rows = cells.div_ceil(columns);
        let cell = DVec2::new(w as f64 / columns as f64, h as f64 / rows as f64);
        let piece = |(k, t): (usize, &[u32; 3])| {
            let place = half_cell(k, columns, cell);
            let ray = |i: u32| Ray { origin: self.vertices[i as usize], direction: self.inward[i as usize] };
            triangle(place, self.rotated(t, k % 2 == 0).map_each(ray))
        };
        let pieces = parallel::map(0..self.triangles.len(), |k| piece((k, &self.triangles[k])));
        let built = Built::new((w, h), Rays::Pieces(Pieces::new(pieces, w, h)));
        Ok(Built { notes: self.notes.clone().into(), ..built })
    }
}
