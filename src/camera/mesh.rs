//! The `mesh` camera: image triangles whose corners carry rays (Hou et al. 2006; Popescu's CGLC segments).

pub mod overlap;
pub mod spec;

use super::bundle::{Bundle, Ray};
use super::pieces::{Piece, Pieces, side};
use crate::arrays::MapEach;
use crate::camera::mesh::spec::MeshCameraSpec;
use crate::input::limits::LISTED_PIECES;
use crate::input::{Error, Limits, Result};
use crate::parallel;
use glam::{DVec2, DVec3};
pub(super) use overlap::first_overlap;
use std::collections::HashMap;

/// Compiles every image triangle to one piece.
///
/// With `L_i` the barycentric coordinates of the image place, `p = sum w_i L_i near_i`, `h = sum w_i L_i` and
/// `d = sum w_i L_i (far_i - near_i)`, or with `normalize` `d = sum w_i L_i unit(far_i - near_i)`.
pub fn compile(
    spec: &MeshCameraSpec,
    (width, height): (u32, u32),
    notes: &mut Vec<String>,
    limits: Limits,
) -> Result<Pieces> {
    if spec.triangles.is_empty() {
        return Err(Error::input("camera.triangles: the camera has no pieces; give at least one triangle"));
    }
    limits.check(LISTED_PIECES, spec.triangles.len() as u64).map_err(|e| e.at("camera.triangles"))?;
    let size = DVec2::new(width as f64, height as f64);
    let pieces: Vec<Piece> = parallel::try_map(0..spec.triangles.len(), |k| piece(spec, k, &spec.triangles[k], size))?;
    let corners: Vec<[DVec2; 3]> = pieces.iter().filter_map(|p| p.corners_px).collect();
    if let Some((j, k)) = first_overlap(&corners) {
        return Err(Error::input(format!("camera.triangles: {j} and {k} overlap in the image; pieces must not")));
    }
    let dead: Vec<usize> = (0..pieces.len()).filter(|&k| pieces[k].bundle.d == [DVec3::ZERO; 3]).collect();
    match dead.len() {
        0 => {}
        n if n == pieces.len() => {
            return Err(Error::input("camera.vertices: near and far are equal everywhere, so no ray has a direction"));
        }
        n => notes.push(format!("{n} pieces have no ray direction (near = far), the first is {}: background", dead[0])),
    }
    Ok(Pieces::new(pieces, width, height))
}

fn piece(spec: &MeshCameraSpec, index: usize, triangle: &[u32; 3], size: DVec2) -> Result<Piece> {
    let v = triangle.map_each(|i| &spec.vertices[i as usize]);
    let corners = v.map_each(|v| DVec2::from(v.image) * size);
    let area2 = side(corners[0], corners[1], corners[2]);
    if area2 == 0.0 {
        return Err(Error::input(format!("camera.triangles: {index} has no area in the image; remove it")));
    }
    let mut direction = v.map_each(|v| v.far - v.near);
    if spec.normalize {
        direction = direction.map_each(|d| d.normalize_or_zero());
    }
    let w = v.map_each(|v| v.w);
    let affine = |q: [DVec3; 3]| interpolated(&corners, q);
    let weighted = |q: [DVec3; 3]| affine([w[0] * q[0], w[1] * q[1], w[2] * q[2]]);
    let h = affine(w.map_each(|w| DVec3::new(w, 0.0, 0.0))).map_each(|v| v.x);
    let bundle = Bundle { p: weighted(v.map_each(|v| v.near)), d: weighted(direction), h };
    Ok(Piece { bundle, centre_px: (corners[0] + corners[1] + corners[2]) / 3.0, corners_px: Some(corners) })
}

/// The places of corners, each once, and the number of each corner's place.
pub(super) fn welded(corners: impl Iterator<Item = DVec3>) -> (Vec<DVec3>, Vec<u32>) {
    let (mut number_of, mut places) = (HashMap::new(), Vec::new());
    let number = |p: DVec3| {
        // -0 is 0
        *number_of.entry((p + 0.0).to_array().map_each(f64::to_bits)).or_insert_with(|| {
            places.push(p);
            places.len() as u32 - 1
        })
    };
    let numbers = corners.map(number).collect();
    (places, numbers)
}

/// The corners of a triangle of a joint image: right-angled halves of cells, two a cell, row by row. The first is the right angle, and
/// they are counter-clockwise as seen in the picture, whose y goes down.
pub(super) fn half_cell(triangle: usize, columns: usize, cell: DVec2) -> [DVec2; 3] {
    let corner = DVec2::new((triangle / 2 % columns) as f64, (triangle / 2 / columns) as f64);
    let is_upper = triangle.is_multiple_of(2);
    let shape = if is_upper { [(0., 0.), (0., 1.), (1., 0.)] } else { [(1., 1.), (1., 0.), (0., 1.)] };
    shape.map_each(|(x, y)| (corner + DVec2::new(x, y)) * cell)
}

/// The piece over an image triangle (px) of some area whose corners have the rays `rays`: P and D are affine between.
pub(crate) fn triangle(corners: [DVec2; 3], rays: [Ray; 3]) -> Piece {
    let p = interpolated(&corners, rays.map_each(|r| r.origin));
    let d = interpolated(&corners, rays.map_each(|r| r.direction));
    let centre_px = (corners[0] + corners[1] + corners[2]) / 3.0;
    Piece { bundle: Bundle { p, d, h: [1.0, 0.0, 0.0] }, centre_px, corners_px: Some(corners) }
}

/// The affine function of the image place (px) with the values `q` at the corners of a triangle of some area: its
/// value at their mean, and its derivatives along x and y.
pub(super) fn interpolated(corners: &[DVec2; 3], q: [DVec3; 3]) -> [DVec3; 3] {
    let area2 = side(corners[0], corners[1], corners[2]);
    // dL_i/dx = (y_j - y_k) / 2A, dL_i/dy = (x_k - x_j) / 2A for the corners i, j, k in order
    let gradient = [0, 1, 2].map_each(|i| {
        let e = corners[(i + 2) % 3] - corners[(i + 1) % 3];
        DVec2::new(-e.y, e.x) / area2
    });
    // the L_i sum to 1, so their gradients sum to 0: differences from corner 0 lose nothing
    let (a, b) = (q[1] - q[0], q[2] - q[0]);
    let slope = |g1: f64, g2: f64| g1 * a + g2 * b;
    [q[0] + (a + b) / 3.0, slope(gradient[1].x, gradient[2].x), slope(gradient[1].y, gradient[2].y)]
}
