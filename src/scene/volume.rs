//! A volume: a regular grid of numbers in space that glow and absorb light. `docs/reference/definitions.md`, Volume.

mod header;
pub mod load;
pub mod spec;

use crate::arrays::MapEach;
use crate::parallel;
use crate::scene::Scene;
use crate::scene::light::AMBIENT;
use glam::{DAffine3, DMat3, DVec3};
use std::sync::Arc;

/// A volume in the world.
#[derive(Debug, Clone)]
pub struct Volume {
    pub grid: Arc<Grid>,
    /// By increasing value, at least one.
    pub transfer: Vec<ControlPoint>,
    pub mode: Mode,
    /// Lights of the scene shine on it.
    pub is_lit: bool,
}

/// What is seen along a ray.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mode {
    /// Light that the volume sends out and absorbs.
    Composite,
    /// The largest value.
    Maximum,
}

/// What a value looks like. Between two of them all is linear, before the first and behind the last constant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ControlPoint {
    pub value: f32,
    /// Linear RGB in [0, 1].
    pub colour: [f32; 3],
    /// Share of the light that is absorbed, per world unit.
    pub extinction: f32,
}

/// Values at the nodes of a regular grid.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    /// Nodes along x, y and z: 2 to [`SIDE_MAX`].
    pub sides: [u32; 3],
    /// Finite; x runs fastest, z slowest.
    pub values: Vec<f32>,
    /// From grid coordinates, in which nodes are whole numbers from 0 on, to world coordinates.
    pub to_world: DAffine3,
}

/// Most nodes of a side. A ray then passes at most three times as many cells, fewer than rounds of a kernel's loops on software adapters.
pub const SIDE_MAX: u64 = 4096;

/// Most control points: with one before the first they fill a kernel's table of 64.
pub const POINTS_MAX: usize = 63;

impl Volume {
    /// Both are the same grid, not an equal one, and look alike.
    pub fn is_same(&self, other: &Volume) -> bool {
        let look = |v: &Volume| (v.mode, v.is_lit);
        Arc::ptr_eq(&self.grid, &other.grid) && self.transfer == other.transfer && look(self) == look(other)
    }

    /// The largest extinction.
    pub fn extinction_max(&self) -> f64 {
        self.transfer.iter().map(|p| f64::from(p.extinction)).fold(0.0, f64::max)
    }
}

impl Grid {
    /// The number of a node in [`Grid::values`].
    pub fn index(&self, [i, j, k]: [u32; 3]) -> usize {
        let [nx, ny, _] = self.sides.map_each(|n| n as usize);
        (k as usize * ny + j as usize) * nx + i as usize
    }

    /// The corners of the box around it, world units.
    pub fn bounds(&self) -> (DVec3, DVec3) {
        let last = DVec3::from(self.sides.map_each(|n| f64::from(n - 1)));
        let corner = |k: u32| {
            let end = DVec3::from([0, 1, 2].map_each(|axis| f64::from(k >> axis & 1)));
            self.to_world.transform_point3(last * end)
        };
        let none = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        (0..8).map(corner).fold(none, |(lo, hi), p| (lo.min(p), hi.max(p)))
    }

    /// The sum of the lengths of its three edges, world units. A straight line in it is no longer.
    pub fn edges(&self) -> f64 {
        let axes = self.to_world.matrix3;
        let each = [axes.x_axis, axes.y_axis, axes.z_axis];
        each.iter().zip(self.sides).map(|(axis, n)| axis.length() * f64::from(n - 1)).sum()
    }

    /// The gradient at a node, per world unit: differences of both neighbours, or at the border of one.
    pub fn gradient(&self, node: [u32; 3]) -> DVec3 {
        let slope = |axis: usize| {
            let (mut before, mut after) = (node, node);
            before[axis] = node[axis].saturating_sub(1);
            after[axis] = (node[axis] + 1).min(self.sides[axis] - 1);
            let value = |n: [u32; 3]| f64::from(self.values[self.index(n)]);
            (value(after) - value(before)) / f64::from(after[axis] - before[axis])
        };
        let own = DVec3::new(slope(0), slope(1), slope(2));
        // gradients go by the inverse transpose
        self.to_world.matrix3.inverse().transpose() * own
    }

    /// The unit normal at each node, towards smaller values; 0 where all differences are 0.
    pub fn normals(&self) -> Vec<DVec3> {
        self.each_node(|node| -self.gradient(node).normalize_or_zero())
    }

    /// What a function makes of each node, in the order of the values.
    fn each_node<T: Send>(&self, f: impl Fn([u32; 3]) -> T + Sync) -> Vec<T> {
        let [nx, ny, nz] = self.sides;
        let row = |r: u64| (0..nx).map(move |i| [i, (r % u64::from(ny)) as u32, (r / u64::from(ny)) as u32]);
        parallel::flat_map(0..u64::from(ny) * u64::from(nz), |r| row(r).map(&f))
    }

    /// The factor of the volume's colour at each node by the lights of a scene: `None` if it has only the headlight, whose factor depends on the ray.
    pub fn lit(&self, scene: &Scene) -> Option<Vec<DVec3>> {
        if scene.has_headlight() {
            return None;
        }
        Some(self.each_node(|node| {
            let normal = -self.gradient(node).normalize_or_zero();
            let place = self.to_world.transform_point3(DVec3::from(node.map_each(f64::from)));
            factor(scene, place, normal)
        }))
    }
}

/// The light that a place with this normal sends back, as a surface would that is white and matte; 1 without a normal.
fn factor(scene: &Scene, place: DVec3, normal: DVec3) -> DVec3 {
    if normal == DVec3::ZERO {
        return DVec3::ONE;
    }
    let ambient = f64::from(AMBIENT);
    let (around, rest) = match &scene.sky {
        Some(sky) => (sky.irradiance(normal), 1.0),
        None => (DVec3::splat(ambient), 1.0 - ambient),
    };
    let direct = scene.lights.iter().map(|light| {
        let arriving = light.arriving(place);
        normal.dot(arriving.to_light).max(0.0) * arriving.strength
    });
    around.max(DVec3::ZERO) + rest * direct.sum::<DVec3>()
}

/// From grid coordinates to the world for nodes from `first` on, `spacing` apart, turned about the middle of their box.
pub fn placed(sides: [u32; 3], first: DVec3, spacing: DVec3, rotation: DMat3) -> DAffine3 {
    let middle = first + spacing * DVec3::from(sides.map_each(|n| f64::from(n - 1))) / 2.0;
    let matrix3 = rotation * DMat3::from_diagonal(spacing);
    DAffine3 { matrix3, translation: middle + rotation * (first - middle) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DQuat;

    fn ramp(sides: [u32; 3], to_world: DAffine3, slope: DVec3) -> Grid {
        let mut grid = Grid { sides, values: Vec::new(), to_world };
        let value = |node: [u32; 3]| to_world.transform_point3(DVec3::from(node.map(f64::from))).dot(slope) as f32;
        grid.values = grid.each_node(value);
        grid
    }

    #[test]
    fn the_gradient_of_a_ramp_is_its_slope_however_the_grid_lies() {
        let slope = DVec3::new(1.0, -2.0, 0.5);
        let rotation = DMat3::from_quat(DQuat::from_rotation_y(0.7));
        let to_world = placed([5, 4, 3], DVec3::new(1.0, 2.0, 3.0), DVec3::new(0.5, 0.25, 1.0), rotation);
        let grid = ramp([5, 4, 3], to_world, slope);
        for node in [[0, 0, 0], [4, 3, 2], [2, 1, 1]] {
            assert!((grid.gradient(node) - slope).length() < 1e-5, "{node:?}: {}", grid.gradient(node));
        }
        assert!(grid.normals().iter().all(|n| (*n + slope.normalize()).length() < 1e-5));
    }

    #[test]
    fn a_grid_turns_about_its_middle() {
        let rotation = DMat3::from_quat(DQuat::from_rotation_z(1.0));
        let (first, spacing) = (DVec3::new(-1.0, 2.0, 0.0), DVec3::new(0.5, 1.0, 2.0));
        let middle = |m: DAffine3| m.transform_point3(DVec3::new(2.0, 1.5, 1.0));
        let [straight, turned] = [DMat3::IDENTITY, rotation].map(|r| placed([5, 4, 3], first, spacing, r));
        assert!((middle(straight) - middle(turned)).length() < 1e-12);
        assert_eq!(straight.translation, first);
        let edge = turned.transform_vector3(DVec3::X);
        assert!((edge - rotation * DVec3::new(0.5, 0.0, 0.0)).length() < 1e-12);
    }
}
