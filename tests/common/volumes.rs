//! Volumes for tests.

use anamorph::internals::scene::volume::{ControlPoint, Grid, Mode, Volume, placed};
use glam::{DMat3, DQuat, DVec3};
use std::sync::Arc;

/// A grid from -1 to 1 along each axis, turned about its middle, of a function of the place in it.
pub fn grid(sides: [u32; 3], turn: DQuat, value: impl Fn(DVec3) -> f64) -> Grid {
    let spacing = DVec3::splat(2.0) / DVec3::from(sides.map(|n| f64::from(n - 1)));
    let to_world = placed(sides, DVec3::splat(-1.0), spacing, DMat3::from_quat(turn));
    let place = |i: u32, j: u32, k: u32| DVec3::splat(-1.0) + spacing * DVec3::from([i, j, k].map(f64::from));
    let [nx, ny, nz] = sides;
    let nodes = (0..nz).flat_map(|k| (0..ny).flat_map(move |j| (0..nx).map(move |i| (i, j, k))));
    let values = nodes.map(|(i, j, k)| value(place(i, j, k)) as f32).collect();
    Grid { sides, values, to_world }
}

/// Colours and extinctions by value.
pub fn transfer(points: &[[f32; 5]]) -> Vec<ControlPoint> {
    let point = |&[value, r, g, b, extinction]: &[f32; 5]| ControlPoint { value, colour: [r, g, b], extinction };
    points.iter().map(point).collect()
}

pub fn volume(grid: Grid, points: &[[f32; 5]], mode: Mode, is_lit: bool) -> Volume {
    Volume { grid: Arc::new(grid), transfer: transfer(points), mode, is_lit }
}

/// A cloud of some bumps, in 0 to about 1.
pub fn bumps(p: DVec3) -> f64 {
    let ball = (-3.0 * (p - DVec3::new(0.1, -0.1, 0.05)).length_squared()).exp();
    ball * (0.8 + 0.4 * (7.0 * p.x + 2.0 * p.y).sin() * (6.0 * p.y - 3.0 * p.z).cos())
}

/// A transfer function with a thin shell, corners and a constant piece.
pub const SHELLS: [[f32; 5]; 6] = [
    [0.1, 0.0, 0.0, 0.2, 0.0],
    [0.3, 0.2, 0.4, 1.0, 1.5],
    [0.5, 0.9, 0.2, 0.1, 1.5],
    [0.52, 1.0, 0.0, 0.0, 40.0],
    [0.54, 1.0, 0.6, 0.1, 2.0],
    [0.9, 1.0, 1.0, 0.8, 12.0],
];
