//! A viewer that moves: tables that depend on its lens alone are kept from pose to pose, and the stage `aim` turns the rays of the lens and
//! the bounds on them.

use super::curves::RayTable;
use super::nodes::{Nodes, WidthMeasure};
use super::tiles::{Tiler, Tiles};
use super::{Rows, View};
use crate::arrays::MapEach;
use crate::camera::lens::LensRays;
use crate::camera::perturb::PERTURB;
use crate::camera::pieces::TurnedPieces;
use crate::camera::view::View as Axes;
use crate::camera::{Camera, Field, Pieces, Rays};
use crate::gpu::layout::{ViewerPose, f64_pair_bits, split2};
use crate::parallel;
use glam::{DVec2, DVec3};
use std::sync::Arc;

/// The tables of a band for a viewer at the origin, with the world's axes.
#[derive(Debug)]
pub struct LensBand {
    rays: UnturnedRays,
    rows: Rows,
    sample_offsets: Vec<DVec2>,
    measure: WidthMeasure,
    pub tiles: Arc<Tiles>,
    /// Bounds on the rays, without perturbations.
    pub nodes: Arc<Nodes>,
    /// The rays of a field in the order of [`RayTable::of_field`]: six numbers each, or only the direction's three if all rays start in the eye.
    pub table: RayTable,
}

/// The rays of a viewer in its frame.
#[derive(Debug, Clone)]
enum UnturnedRays {
    Field(Arc<LensRays>),
    Pieces(Arc<Pieces>),
}

/// A band's lens, and the viewer's pose.
#[derive(Debug, Clone)]
pub struct Turned {
    pub lens: Arc<LensBand>,
    /// The eye relative to the anchor.
    pub eye: DVec3,
    axes: Axes,
    /// How far perturbations move origins at most.
    pub perturb: f64,
}

impl Turned {
    /// Returns the lens and the pose of a band's rays, if the camera's rays are those of a viewer at a pose; takes the lens from `last`, the band of an earlier
    /// plan, if it is the same.
    pub(super) fn of(view: View, rows: Rows, measure: WidthMeasure, last: Option<&Turned>) -> Option<Turned> {
        let (rays, eye, axes) = match view.camera.layers.as_slice() {
            [Rays::Field(field)] => {
                let (rays, viewer) = field.turned().filter(|_| view.sample_offsets.is_empty())?;
                (UnturnedRays::Field(rays.clone()), viewer.eye, viewer.view)
            }
            [Rays::Pieces(pieces)] => {
                let TurnedPieces { unturned, eye, view } = pieces.turned()?;
                (UnturnedRays::Pieces(unturned.clone()), *eye, *view)
            }
            _ => return None,
        };
        // perturbations are added where bounds are turned: in `aim_nodes` and `in_view::rays`
        let measure = WidthMeasure { scene_size: 0.0, ..measure };
        let is_same = |lens: &LensBand| {
            lens.rays.is_same(&rays)
                && lens.rows == rows
                && lens.sample_offsets == view.sample_offsets
                && lens.measure == measure
        };
        let lens = match last.filter(|last| is_same(&last.lens)) {
            Some(last) => last.lens.clone(),
            None => Arc::new(LensBand::new(view, rays, rows, measure, last.map(|last| &*last.lens))?),
        };
        let perturb = PERTURB * view.extent.scene_size;
        Some(Turned { lens, eye: eye - view.extent.anchor, axes, perturb })
    }

    /// Returns a vector of the viewer's frame in the world.
    pub fn turned(&self, v: DVec3) -> DVec3 {
        self.axes.vector(v.x, v.y, v.z)
    }

    /// Returns the number of rays that the kernel writes.
    pub fn ray_count(&self) -> u32 {
        self.lens.table.hi.len() as u32 / self.lens.numbers_a_ray()
    }

    /// Returns the pose in the layout of the kernel.
    pub fn pose(&self) -> ViewerPose {
        let Turned { eye, axes: Axes { right, up, forward }, .. } = self;
        let numbers: Vec<f64> = [*eye, *right, *up, *forward].iter().flat_map(|v| v.to_array()).collect();
        let [eye_f32, right_f32, up_f32, forward_f32] = [eye, right, up, forward].map_each(|v| v.as_vec3().to_array());
        ViewerPose {
            numbers: std::array::from_fn(|k| f64_pair_bits([numbers[2 * k], numbers[2 * k + 1]])),
            eye: eye_f32,
            ray_count: self.ray_count(),
            right: right_f32,
            numbers_a_ray: self.lens.numbers_a_ray(),
            up: up_f32,
            node_count: self.lens.nodes.nodes.len() as u32,
            forward: forward_f32,
            perturb: (self.perturb * (1.0 + f64::from(f32::EPSILON))) as f32,
        }
    }
}

impl UnturnedRays {
    fn is_same(&self, other: &UnturnedRays) -> bool {
        match (self, other) {
            (UnturnedRays::Field(a), UnturnedRays::Field(b)) => Arc::ptr_eq(a, b),
            (UnturnedRays::Pieces(a), UnturnedRays::Pieces(b)) => Arc::ptr_eq(a, b),
            _ => false,
        }
    }
}

impl LensBand {
    fn new(
        view: View,
        rays: UnturnedRays,
        rows: Rows,
        measure: WidthMeasure,
        last: Option<&LensBand>,
    ) -> Option<LensBand> {
        let unturned = match (&rays, view.camera.layers.as_slice()) {
            (UnturnedRays::Pieces(pieces), _) => Rays::Pieces(Pieces::clone(pieces)),
            (_, [Rays::Field(field)]) => Rays::Field(field.unturned()?),
            _ => return None,
        };
        let table = match (&rays, &unturned) {
            (UnturnedRays::Field(rays), Rays::Field(field)) if rays.is_central() => directions_of(field, rays, rows),
            (_, Rays::Field(field)) => RayTable::of_field(field, DVec3::ZERO, rows.first, rows.count),
            _ => RayTable::default(),
        };
        let camera = Camera { layers: vec![unturned], ..view.camera.clone() };
        let tiler = Tiler {
            camera: &camera,
            slabs: view.slabs,
            curves: None,
            sample_offsets: view.sample_offsets,
            anchor: DVec3::ZERO,
            row: rows.first,
            rows: rows.count,
        };
        // another lens, as after a zoom, may have pieces that own the same pixels
        let known = last.and_then(|last| Some((last.pieces_alike(&rays, rows, view)?, &*last.tiles)));
        let (tiles, nodes) = tiler.tiles_and_nodes(known, measure);
        Some(LensBand { rays, rows, sample_offsets: view.sample_offsets.to_vec(), measure, tiles, nodes, table })
    }

    /// Returns the pieces of `rays` if they own the same pixels as the pieces of this lens.
    fn pieces_alike<'a>(&self, rays: &'a UnturnedRays, rows: Rows, view: View) -> Option<&'a Pieces> {
        match (&self.rays, rays) {
            (UnturnedRays::Pieces(own), UnturnedRays::Pieces(other)) => {
                let is_alike = self.rows == rows && self.sample_offsets == view.sample_offsets && other.own_alike(own);
                is_alike.then_some(other)
            }
            _ => None,
        }
    }

    /// Returns how many numbers the table has for each ray.
    fn numbers_a_ray(&self) -> u32 {
        match &self.rays {
            UnturnedRays::Field(rays) if rays.is_central() => 3,
            _ => 6,
        }
    }
}

/// Returns a band's directions, with one column and one row more; zeros for pixels without a ray.
fn directions_of(field: &Field, rays: &LensRays, Rows { first, count }: Rows) -> RayTable {
    let numbers = 3 * (field.width as usize + 1);
    let size = numbers * (count as usize + 1);
    let mut table = RayTable { hi: vec![0.0; size], lo: vec![0.0; size] };
    let halves = table.hi.chunks_exact_mut(numbers).zip(table.lo.chunks_exact_mut(numbers));
    parallel::for_each(halves.enumerate(), |(j, (hi, lo))| {
        let j = first + j as u32;
        let within = rays.directions_of_row(j);
        let beyond =
            (within.len() as u32..=field.width).map(|i| field.ray_or_beyond(i, j).map_or(DVec3::ZERO, |ray| ray.1));
        let [hi, lo] = [hi, lo].map_each(bytemuck::cast_slice_mut::<f32, [f32; 3]>);
        for ((hi, lo), direction) in hi.iter_mut().zip(lo).zip(within.iter().copied().chain(beyond)) {
            let [x, y, z] = direction.to_array().map_each(split2);
            (*hi, *lo) = ([x[0], y[0], z[0]], [x[1], y[1], z[1]]);
        }
    });
    table
}
