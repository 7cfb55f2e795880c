//! Tables of what a camera without affine pieces has at every pixel: a ray, or the control points of curves.

use super::fit::affine;
use super::slabs::bend;
use super::tiles::{TileRay, TileRays, place_in_tile};
use crate::arrays::MapEach;
use crate::camera::TILE;
use crate::camera::{Camera, Curve, Field};
use crate::gpu::layout::split2;
use crate::parallel;
use glam::{DVec2, DVec3};

/// Numbers of a camera's rays relative to the anchor, each hi and lo. A field: six a pixel, P and D, one column and row
/// more than the band. Curves: three a control point, all of a pixel's together, layer by layer, row by row.
#[derive(Debug, Clone, Default)]
pub struct RayTable {
    pub hi: Vec<f32>,
    pub lo: Vec<f32>,
}

impl RayTable {
    fn push(&mut self, v: DVec3) {
        for [hi, lo] in v.to_array().map_each(split2) {
            self.hi.push(hi);
            self.lo.push(lo);
        }
    }

    /// The rays of rows `row ..= row + rows`, one column and row more than the band; beyond the image and beside a pixel
    /// without a ray, the place that leaves the slope of [`Field::bundle`].
    pub fn of_field(field: &Field, anchor: DVec3, row: u32, rows: u32) -> RayTable {
        let numbers = 6 * (field.width as usize + 1);
        let count = numbers * (rows as usize + 1);
        let mut table = RayTable { hi: vec![0.0; count], lo: vec![0.0; count] };
        let halves = table.hi.chunks_exact_mut(numbers).zip(table.lo.chunks_exact_mut(numbers));
        parallel::for_each(halves.enumerate(), |(j, (hi, lo))| {
            let j = row + j as u32;
            let [hi, lo] = [hi, lo].map_each(bytemuck::cast_slice_mut::<f32, [f32; 6]>);
            for ((hi, lo), i) in hi.iter_mut().zip(lo).zip(0..=field.width) {
                let (p, d) = field.ray_or_beyond(i, j).unwrap_or((anchor, DVec3::ZERO));
                let [[a, b, c], [d, e, f]] = [p - anchor, d].map_each(|v| v.to_array().map_each(split2));
                *hi = [a[0], b[0], c[0], d[0], e[0], f[0]];
                *lo = [a[1], b[1], c[1], d[1], e[1], f[1]];
            }
        });
        table
    }
}

/// Sample rays minus their pixel's ray, as f32: six numbers per sample, all samples of a pixel together, row by row of the band; 0 where
/// there is no ray. The error is 2^-24 of the difference, or of the whole ray where rays jump within the pixel or its centre has none.
pub fn sample_ray_deltas(field: &Field, sample_offsets: &[DVec2], anchor: DVec3, row: u32, rows: u32) -> Vec<f32> {
    let of_row = |j: u32| {
        let pixel = move |i: u32| {
            let (p, d) = field.ray(i, j).unwrap_or((anchor, DVec3::ZERO));
            let delta = move |place: &DVec2| match field.ray_at_offset(i, j, *place) {
                Some((q, e)) => [q - p, e - d],
                None => [DVec3::ZERO; 2],
            };
            sample_offsets.iter().flat_map(delta)
        };
        (0..field.width).flat_map(pixel).flat_map(|v| v.as_vec3().to_array())
    };
    parallel::flat_map(row..row + rows, of_row)
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
        let curves = parallel::map(0..per_layer * camera.layers.len(), curve);
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

/// The curves of one tile, or of a part of it: control points that are affine over it, up to a distance each.
pub struct Net {
    points: Vec<([DVec3; 3], f64)>,
    /// The largest bend of any of the curves.
    bend: f64,
}

/// The nets of all tiles, layer by layer, row by row; `None`: no curve there.
pub fn nets(table: &CurveTable, tiles_x: u32) -> Vec<Option<Net>> {
    let tiles_y = table.rows.div_ceil(TILE);
    let layers = table.curves.len() / (table.width as usize * table.rows as usize);
    let net = |k: u32| {
        let (layer, y, x) = ((k / tiles_x / tiles_y) as usize, k / tiles_x % tiles_y, k % tiles_x);
        let right = TILE.min(table.width - x * TILE);
        let below = TILE.min(table.rows - y * TILE);
        let pixels = (0..below).flat_map(|j| (0..right).map(move |i| (i, j)));
        let at = |(i, j): (u32, u32)| {
            Some((place_in_tile(i, j), table.get(layer, x * TILE + i, table.row + y * TILE + j)?.1))
        };
        Net::of(pixels.filter_map(at))
    };
    parallel::map(0..layers as u32 * tiles_y * tiles_x, net)
}

impl Net {
    /// Of curves of one degree at places of a tile; `None` without any.
    pub fn of(curves: impl Iterator<Item = (DVec2, Curve)>) -> Option<Net> {
        let (places, curves): (Vec<DVec2>, Vec<Curve>) = curves.unzip();
        let degree = curves.first()?.degree();
        let point = |m: usize| affine(places.iter().zip(&curves).map(|(place, c)| (*place, c.points()[m])));
        let bend = curves.iter().map(bend).fold(0.0, f64::max);
        Some(Net { points: (0..=degree).map(point).collect(), bend })
    }

    /// The rays by which a span of t is bounded: the chords at the tile's corners. The ends of a true chord are sums of
    /// control points with Bernstein weights, so they lie as far from the affine ones' as these weights make it; and a
    /// bend, the distance between two such sums, at most two whole distances more than the largest at a corner, being
    /// convex over the tile. Nor is it more than twice that of the whole curve: control points of a part are means of
    /// those of the whole, whose distance from its chord is at most its bend, and so are the part's ends. Straight rays have none.
    pub fn over(&self, span: [f64; 2], anchor: DVec3) -> TileRays {
        let weights = span.map_each(|t| bernstein(self.points.len() - 1, t));
        let off = |k: usize| self.points[k].1;
        let all = 0..self.points.len();
        let r_p: f64 = all.clone().map(|k| weights[0][k] * off(k)).sum();
        let r_d: f64 = all.clone().map(|k| (weights[1][k] - weights[0][k]).abs() * off(k)).sum();
        let largest = all.map(off).fold(0.0, f64::max);
        let mut bent = 0.0f64;
        let corner = |place: DVec2| {
            let points: Vec<DVec3> = self.points.iter().map(|(c, _)| c[0] + place.x * c[1] + place.y * c[2]).collect();
            let curve = Curve::new(&points).span(span);
            bent = bent.max(bend(&curve));
            let (start, end) = (curve.points()[0], curve.points()[curve.degree()]);
            TileRay { place, p: start - anchor, d: end - start }
        };
        let rays = [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)].map_each(DVec2::from).map_each(corner).to_vec();
        let bent = if self.points.len() > 2 { (bent + 2.0 * largest).min(2.0 * self.bend) } else { 0.0 };
        TileRays { rays, r_p: r_p + bent, r_d }
    }
}

/// Bernstein polynomials 0 to m at t, m up to 3.
fn bernstein(m: usize, t: f64) -> Vec<f64> {
    let mut b = vec![1.0];
    for n in 1..=m {
        let before = |k: usize| if k == 0 { 0.0 } else { t * b[k - 1] };
        b = (0..=n).map(|k| before(k) + if k < n { (1.0 - t) * b[k] } else { 0.0 }).collect();
    }
    b
}
