//! A volume as kernels read it, and how finely they follow rays through it.
//!
//! What `volume` may be off by, of colours in [0, 1], is 1/512: a share [`SHARE`] by the colours of stretches (a constant of the kernel),
//! one by corners of the transfer function, one by the legs of curves; and a quarter of 1/512, two shares of 1/4096, by what is left out behind
//! dark volume and by rounding. `docs/reference/definitions.md`, Volume, has the proof.

use crate::arrays::MapEach;
use crate::engine::plan::Plan;
use crate::gpu::kernels::RaysKind;
use crate::gpu::layout::{Medium, split2};
use crate::parallel;
use crate::scene::Scene;
use crate::scene::volume::{ControlPoint, Grid, Mode, Volume};
use glam::DVec3;

/// Each of three parts of the error.
const SHARE: f64 = 1.0 / 2048.0;

/// What legs beside a curve do: their places, how they are spread along it, and the colour there.
const LEG_EFFECTS: f64 = 3.0;

/// Where a volume ends abruptly, a leg enters it earlier or later by its distance from the curve over the sine of their angle: down to 1/8.
const LEAST_SINE: f64 = 1.0 / 8.0;

/// What the kernel reads of a volume.
pub fn medium(volume: &Volume, scene: &Scene, plan: &Plan) -> Medium {
    let grid = &volume.grid;
    let from_anchor = grid.to_world.inverse() * glam::DAffine3::from_translation(plan.anchor);
    let rows = [0, 1, 2].map_each(|row| {
        let values = [from_anchor.x_axis[row], from_anchor.y_axis[row], from_anchor.z_axis[row]].map_each(split2);
        (values.map_each(|v| v[0]), values.map_each(|v| v[1]), split2(from_anchor.translation[row]))
    });
    let [(x_hi, x_lo, x0), (y_hi, y_lo, y0), (z_hi, z_lo, z0)] = rows;
    let errors = Errors::of(volume, plan);
    let table = Table::of(&volume.transfer);
    Medium {
        x_hi,
        x0_hi: x0[0],
        x_lo,
        x0_lo: x0[1],
        y_hi,
        y0_hi: y0[0],
        y_lo,
        y0_lo: y0[1],
        z_hi,
        z0_hi: z0[0],
        z_lo,
        z0_lo: z0[1],
        last: grid.sides.map_each(|n| (n - 1) as f32),
        layers: plan.slabs.layers,
        corner_rate: errors.corner_rate as f32,
        value_error: errors.value_error as f32,
        place_error: errors.place_error as f32,
        headlight: u32::from(volume.is_lit && scene.has_headlight()),
        point: table.point,
        slope: table.slope,
        value: table.value,
    }
}

/// The transfer function: piece 0 lies before the first control point, each other one begins with its own.
struct Table {
    point: [[f32; 4]; 64],
    slope: [[f32; 4]; 64],
    value: [[f32; 4]; 64],
}

impl Table {
    fn of(points: &[ControlPoint]) -> Table {
        let row = |p: &ControlPoint| [p.colour[0], p.colour[1], p.colour[2], p.extinction];
        // pieces that nothing is in end behind all values
        let mut table = Table { point: [[0.0; 4]; 64], slope: [[0.0; 4]; 64], value: [[0.0, f32::MAX, 0.0, 0.0]; 64] };
        if let Some(first) = points.first() {
            table.point[0] = row(first);
            table.value[0] = [first.value, first.value, 0.0, 0.0];
        }
        for (k, own) in points.iter().enumerate() {
            let next = points.get(k + 1);
            let slope = next.map_or([0.0; 4], |next| {
                let width = f64::from(next.value) - f64::from(own.value);
                let (a, b) = (row(own), row(next));
                [0, 1, 2, 3].map_each(|n| ((f64::from(b[n]) - f64::from(a[n])) / width) as f32)
            });
            let steepest = slope[..3].iter().fold(0.0, |most: f32, s| most.max(s.abs()));
            table.point[k + 1] = row(own);
            table.slope[k + 1] = slope;
            table.value[k + 1] = [own.value, next.map_or(f32::MAX, |n| n.value), steepest, slope[3].abs()];
        }
        table
    }
}

/// How finely rays are followed.
struct Errors {
    corner_rate: f64,
    value_error: f64,
    place_error: f64,
}

impl Errors {
    fn of(volume: &Volume, plan: &Plan) -> Errors {
        let degree = match plan.variant.rays.kind {
            RaysKind::Curves { degree } => degree,
            _ => 1,
        };
        // of a curve each coordinate has as many monotone parts as its degree
        let longest = f64::from(plan.slabs.layers * degree) * volume.grid.edges();
        let corner_rate = SHARE / longest;
        // of what is seen of one world unit: its colour's slope, and its extinction's
        let slopes = |a: &ControlPoint, b: &ControlPoint| {
            let width = f64::from(b.value) - f64::from(a.value);
            let colour = (0..3).map(|k| f64::from((b.colour[k] - a.colour[k]).abs())).fold(0.0, f64::max);
            [colour / width, f64::from((b.extinction - a.extinction).abs()) / width]
        };
        let pieces: Vec<Piece> = volume.transfer.windows(2).map(|p| Piece::new(p, slopes(&p[0], &p[1]))).collect();
        let steepest = pieces.iter().map(|p| p.slopes[0] + p.slopes[1]).fold(0.0, f64::max);
        let value_error = if steepest > 0.0 { SHARE / steepest } else { f64::from(f32::MAX) };
        let place_error = match (plan.variant.rays.kind, volume.mode) {
            (RaysKind::Curves { .. }, Mode::Composite) => {
                let change = largest_change(&volume.grid, &pieces, longest);
                let ends = volume.extinction_max() / LEAST_SINE;
                SHARE / (LEG_EFFECTS * change).max(ends).max(f64::from(f32::MIN_POSITIVE))
            }
            (RaysKind::Curves { .. }, Mode::Maximum) => {
                let all = [Piece { from: f64::MIN, to: f64::MAX, slopes: [1.0, 0.0] }];
                value_error / largest_change(&volume.grid, &all, longest).max(f64::from(f32::MIN_POSITIVE))
            }
            _ => 1.0,
        };
        // within f32, and never 0
        let kept = |x: f64| x.clamp(f64::from(f32::MIN_POSITIVE), 1e30);
        Errors { corner_rate: kept(corner_rate), value_error: kept(value_error), place_error: kept(place_error) }
    }
}

/// A piece of the transfer function: its ends, and the slopes of its colour and its extinction.
struct Piece {
    from: f64,
    to: f64,
    slopes: [f64; 2],
}

impl Piece {
    fn new(ends: &[ControlPoint], slopes: [f64; 2]) -> Piece {
        Piece { from: ends[0].value.into(), to: ends[1].value.into(), slopes }
    }
}

/// The largest change of colours per world unit across any cell: that of the colour itself, and that of the extinction over the longest way.
fn largest_change(grid: &Grid, pieces: &[Piece], longest: f64) -> f64 {
    let axes = grid.to_world.matrix3;
    let spacing = DVec3::new(axes.x_axis.length(), axes.y_axis.length(), axes.z_axis.length());
    let [nx, ny, nz] = grid.sides;
    let of_cell = |i: u32, j: u32, k: u32| {
        let corner = |n: u32| f64::from(grid.values[grid.index([i + (n & 1), j + (n >> 1 & 1), k + (n >> 2)])]);
        let values: [f64; 8] = std::array::from_fn(|n| corner(n as u32));
        let (lo, hi) = values.iter().fold((f64::MAX, f64::MIN), |(lo, hi), v| (lo.min(*v), hi.max(*v)));
        let steepest = |axis: usize| {
            let ends = (0..8).filter(|n| n >> axis & 1 == 0).map(|n| (values[n | 1 << axis] - values[n]).abs());
            ends.fold(0.0, f64::max)
        };
        let gradient = (DVec3::new(steepest(0), steepest(1), steepest(2)) / spacing).length();
        let met = pieces.iter().filter(|p| p.from < hi && lo < p.to);
        gradient * met.map(|p| p.slopes[0] + p.slopes[1] * longest).fold(0.0, f64::max)
    };
    let row = |r: u32| {
        let (j, k) = (r % (ny - 1), r / (ny - 1));
        (0..nx - 1).map(|i| of_cell(i, j, k)).fold(0.0, f64::max)
    };
    parallel::reduce(0..(ny - 1) * (nz - 1), |r| Some(row(r)), f64::max).unwrap_or(0.0)
}

/// The grid's numbers for the kernel: values alone, or with the factors of the colour at each node, or with its normal.
pub fn voxels(volume: &Volume, scene: &Scene) -> Vec<f32> {
    if !volume.is_lit {
        return volume.grid.values.clone();
    }
    let of_nodes = volume.grid.lit(scene).unwrap_or_else(|| volume.grid.normals());
    let rows = volume.grid.values.iter().zip(&of_nodes);
    rows.flat_map(|(value, v)| [*value, v.x as f32, v.y as f32, v.z as f32]).collect()
}

/// Bytes of a node on the device.
pub fn node_bytes(volume: &Volume) -> u64 {
    if volume.is_lit { 16 } else { 4 }
}
