//! A viewer that moves: tables that depend on its lens alone are kept from pose to pose, and the kernel `aim` turns the lens's directions into
//! rays.

use super::curves::RayTable;
use super::fit::Fit;
use super::tiles::{TileFits, Tiler, Tiles};
use super::{Rows, View};
use crate::arrays::MapEach;
use crate::camera::directions::Directions;
use crate::camera::view::View as Axes;
use crate::camera::{Camera, Field, Rays};
use crate::gpu::layout::{RAYS_NONE, ViewerPose, f64_pair_bits, split2};
use crate::parallel;
use glam::DVec3;
use std::sync::Arc;

/// The tables of a band for a lens at the origin, with the world's axes.
#[derive(Debug)]
pub struct LensBand {
    directions: Arc<Directions>,
    rows: Rows,
    pub tiles: Arc<Tiles>,
    fits: Vec<TileFits>,
    /// Directions, three numbers each, in the order of [`RayTable::of_field`].
    pub table: RayTable,
}

/// A band's lens, and the viewer's pose.
#[derive(Debug, Clone)]
pub struct Turned {
    pub lens: Arc<LensBand>,
    /// The eye relative to the anchor.
    eye: DVec3,
    axes: Axes,
}

impl Turned {
    /// Returns the lens and the pose of a band's rays, if the camera has one eye and one lens; takes the lens from `last`, the band of an earlier
    /// plan, if it is the same.
    pub(super) fn of(view: View, rows: Rows, last: Option<&Turned>) -> Option<Turned> {
        let [Rays::Field(field)] = view.camera.layers.as_slice() else { return None };
        let (directions, viewer) = field.turned().filter(|_| view.sample_offsets.is_empty())?;
        let is_same = |lens: &LensBand| Arc::ptr_eq(&lens.directions, directions) && lens.rows == rows;
        let lens = match last.filter(|last| is_same(&last.lens)) {
            Some(last) => last.lens.clone(),
            None => Arc::new(LensBand::new(view, field.unturned()?, directions.clone(), rows)),
        };
        Some(Turned { lens, eye: viewer.eye - view.extent.anchor, axes: viewer.view })
    }

    /// Returns the bounds of the rays of each tile.
    pub fn fits(&self) -> Vec<TileFits> {
        let turned = |fit: &Fit| {
            let p = if fit.rays == RAYS_NONE { fit.p } else { [self.eye, DVec3::ZERO, DVec3::ZERO] };
            Fit { p, d: fit.d.map_each(|d| self.axes.vector(d.x, d.y, d.z)), ..*fit }
        };
        let of_tile =
            |tile: &TileFits| TileFits { whole: turned(&tile.whole), each: tile.each.iter().map(turned).collect() };
        parallel::map(self.lens.fits.as_slice(), of_tile)
    }

    /// Returns the number of rays that the kernel writes.
    pub fn count(&self) -> u32 {
        self.lens.table.hi.len() as u32 / 3
    }

    /// Returns the pose in the layout of the kernel.
    pub fn pose(&self) -> ViewerPose {
        let Turned { eye, axes: Axes { right, up, forward }, .. } = self;
        let numbers: Vec<f64> = [*eye, *right, *up, *forward].iter().flat_map(|v| v.to_array()).collect();
        ViewerPose {
            numbers: std::array::from_fn(|k| f64_pair_bits([numbers[2 * k], numbers[2 * k + 1]])),
            count: self.count(),
            pad0: 0,
            pad1: 0,
            pad2: 0,
        }
    }
}

impl LensBand {
    fn new(view: View, field: Field, directions: Arc<Directions>, rows: Rows) -> LensBand {
        let table = directions_of(&field, rows);
        let camera = Camera { layers: vec![Rays::Field(field)], ..view.camera.clone() };
        let Rows { first: row, count: rows_count } = rows;
        let anchor = DVec3::ZERO;
        let tiler = Tiler {
            camera: &camera,
            slabs: view.slabs,
            curves: None,
            sample_offsets: &[],
            anchor,
            row,
            rows: rows_count,
        };
        let (tiles, fits) = tiler.tiles();
        LensBand { directions, rows, tiles: Arc::new(tiles), fits, table }
    }
}

/// Returns a band's directions, with one column and one row more; zeros for pixels without a ray.
fn directions_of(field: &Field, Rows { first, count }: Rows) -> RayTable {
    let numbers = 3 * (field.width as usize + 1);
    let size = numbers * (count as usize + 1);
    let mut table = RayTable { hi: vec![0.0; size], lo: vec![0.0; size] };
    let halves = table.hi.chunks_exact_mut(numbers).zip(table.lo.chunks_exact_mut(numbers));
    parallel::for_each(halves.enumerate(), |(j, (hi, lo))| {
        for ((hi, lo), i) in hi.chunks_exact_mut(3).zip(lo.chunks_exact_mut(3)).zip(0..=field.width) {
            let direction = field.ray_or_beyond(i, first + j as u32).map_or(DVec3::ZERO, |(_, d)| d);
            hi.iter_mut().zip(lo).zip(direction.to_array()).for_each(|((hi, lo), v)| [*hi, *lo] = split2(v));
        }
    });
    table
}
