//! A viewer that moves: tables that depend on its lens alone are kept from pose to pose, and the kernel `aim` turns the rays of the lens.

use super::curves::RayTable;
use super::fit::Fit;
use super::tiles::{TileFits, Tiler, Tiles};
use super::{Rows, View};
use crate::arrays::MapEach;
use crate::camera::lens::LensRays;
use crate::camera::view::View as Axes;
use crate::camera::{Camera, Field, Rays};
use crate::gpu::layout::{RAYS_NONE, ViewerPose, f64_pair_bits, split2};
use crate::parallel;
use glam::DVec3;
use std::sync::Arc;

/// The tables of a band for a lens at the origin, with the world's axes.
#[derive(Debug)]
pub struct LensBand {
    rays: Arc<LensRays>,
    rows: Rows,
    pub tiles: Arc<Tiles>,
    fits: Vec<TileFits>,
    /// Rays in the order of [`RayTable::of_field`]: six numbers each, or only the direction's three if all rays start in the eye.
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
    /// Returns the lens and the pose of a band's rays, if the camera is a lens at a pose; takes the lens from `last`, the band of an earlier
    /// plan, if it is the same.
    pub(super) fn of(view: View, rows: Rows, last: Option<&Turned>) -> Option<Turned> {
        let [Rays::Field(field)] = view.camera.layers.as_slice() else { return None };
        let (rays, viewer) = field.turned().filter(|_| view.sample_offsets.is_empty())?;
        let is_same = |lens: &LensBand| Arc::ptr_eq(&lens.rays, rays) && lens.rows == rows;
        let lens = match last.filter(|last| is_same(&last.lens)) {
            Some(last) => last.lens.clone(),
            None => Arc::new(LensBand::new(view, field.unturned()?, rays.clone(), rows)),
        };
        Some(Turned { lens, eye: viewer.eye - view.extent.anchor, axes: viewer.view })
    }

    /// Returns the bounds of the rays of a tile.
    pub fn fits(&self, tile: usize) -> TileFits {
        let turned = |fit: &Fit| {
            let mut turned =
                Fit { p: fit.p.map_each(|p| self.turned(p)), d: fit.d.map_each(|d| self.turned(d)), ..*fit };
            if fit.rays != RAYS_NONE {
                turned.p[0] += self.eye;
            }
            turned
        };
        let TileFits { whole, each, .. } = &self.lens.fits[tile];
        TileFits { each: each.iter().map(turned).collect(), ..turned(whole).into() }
    }

    /// Returns a vector of the viewer's frame in the world.
    fn turned(&self, v: DVec3) -> DVec3 {
        self.axes.vector(v.x, v.y, v.z)
    }

    /// Returns the number of rays that the kernel writes.
    pub fn count(&self) -> u32 {
        self.lens.table.hi.len() as u32 / self.lens.numbers_a_ray()
    }

    /// Returns the pose in the layout of the kernel.
    pub fn pose(&self) -> ViewerPose {
        let Turned { eye, axes: Axes { right, up, forward }, .. } = self;
        let numbers: Vec<f64> = [*eye, *right, *up, *forward].iter().flat_map(|v| v.to_array()).collect();
        ViewerPose {
            numbers: std::array::from_fn(|k| f64_pair_bits([numbers[2 * k], numbers[2 * k + 1]])),
            count: self.count(),
            numbers_a_ray: self.lens.numbers_a_ray(),
            pad1: 0,
            pad2: 0,
        }
    }
}

impl LensBand {
    fn new(view: View, field: Field, rays: Arc<LensRays>, rows: Rows) -> LensBand {
        let table = match rays.is_central() {
            true => directions_of(&field, rows),
            false => RayTable::of_field(&field, DVec3::ZERO, rows.first, rows.count),
        };
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
        LensBand { rays, rows, tiles: Arc::new(tiles), fits, table }
    }

    /// Returns how many numbers the table has for each ray.
    fn numbers_a_ray(&self) -> u32 {
        if self.rays.is_central() { 3 } else { 6 }
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
