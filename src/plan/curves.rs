//! Tables of what a camera without affine pieces has at every pixel: a ray, or the control points of curves.

use crate::camera::{Camera, Curve, Field};
use crate::gpu::rows::split2;
use glam::DVec3;
use rayon::prelude::*;

/// Numbers of a camera's rays relative to the anchor, each hi and lo. A field: six a pixel, P and D, one column and row
/// more than the band. Curves: three a control point, all of a pixel's together, layer by layer, row by row.
#[derive(Debug, Clone, Default)]
pub struct RayTable {
    pub hi: Vec<f32>,
    pub lo: Vec<f32>,
}

impl RayTable {
    fn push(&mut self, v: DVec3) {
        for [hi, lo] in v.to_array().map(split2) {
            self.hi.push(hi);
            self.lo.push(lo);
        }
    }

    /// The rays of rows `row ..= row + rows`, one column and row more than the band; beyond the image and beside a pixel
    /// without a ray, the place that leaves the slope of [`Field::bundle`].
    pub fn of_field(field: &Field, anchor: DVec3, row: u32, rows: u32) -> RayTable {
        let mut table = RayTable::default();
        for j in row..=row + rows {
            for i in 0..=field.width {
                let (p, d) = field.ray_or_beyond(i, j).unwrap_or((anchor, DVec3::ZERO));
                table.push(p - anchor);
                table.push(d);
            }
        }
        table
    }
}

/// The curves of a band's pixels in every layer, of one degree.
#[derive(Debug, Clone)]
pub struct CurveTable {
    width: u32,
    row: u32,
    rows: u32,
    degree: u32,
    /// Layer by layer, row by row.
    curves: Vec<Option<(u32, Curve)>>,
}

impl CurveTable {
    pub fn new(camera: &Camera, degree: u32, row: u32, rows: u32) -> CurveTable {
        let (width, per_layer) = (camera.width, camera.width as usize * rows as usize);
        let curve = |k: usize| {
            let (layer, pixel) = (k / per_layer, k % per_layer);
            let (i, j) = ((pixel % width as usize) as u32, row + (pixel / width as usize) as u32);
            let (piece, curve) = camera.curve(layer, i, j)?;
            // a curve that is one point meets no triangle's inside
            let moves = curve.points().iter().any(|p| *p != curve.points()[0]);
            moves.then(|| (piece - camera.first_piece(layer), curve.elevated(degree as usize)))
        };
        let curves = (0..per_layer * camera.layers.len()).into_par_iter().map(curve).collect();
        CurveTable { width, row, rows, degree, curves }
    }

    /// The curve of pixel `(i, j)` of the image in a layer, and its piece in that layer.
    pub fn get(&self, layer: usize, i: u32, j: u32) -> Option<(u32, Curve)> {
        let row = layer * self.rows as usize + (j - self.row) as usize;
        self.curves[row * self.width as usize + i as usize]
    }

    /// The control points as kernels read them; a pixel without a curve has all of them in one place.
    pub fn rays(&self, anchor: DVec3) -> RayTable {
        let mut table = RayTable::default();
        for found in &self.curves {
            match found {
                Some((_, curve)) => curve.points().iter().for_each(|p| table.push(*p - anchor)),
                None => (0..=self.degree).for_each(|_| table.push(DVec3::ZERO)),
            }
        }
        table
    }
}
