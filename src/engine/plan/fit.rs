//! Rays of a part of the image as one affine bundle, and how far they may lie from it.

use super::tiles::TileRays;
use crate::camera::Bundle;
use crate::camera::perturb::PERTURB;
use crate::gpu::layout::{self, RAYS_AFFINE, RAYS_LOOSE};
use glam::{DVec2, DVec3};

/// An affine fit of rays over a square, (x, y) in [-1, 1]^2, and how far the rays may lie from it.
#[derive(Debug, Clone, Copy, Default)]
pub struct Fit {
    pub p: [DVec3; 3],
    pub d: [DVec3; 3],
    pub r_p: f64,
    pub r_d: f64,
    /// One of the RAYS constants.
    pub rays: u32,
}

/// What f32 rounding of a node and of what kernels compute from it may add to its radii, relative to the sizes
/// summed and the radii themselves: four roundings of 2^-24.
const NODE_ERROR: f64 = 1.0 / (1u64 << 22) as f64;
/// Residuals below this share of the rays' size are rounding of the fit itself: 64 samples of some 2^-50 each.
const FIT_ROUNDING: f64 = 1.0 / (1u64 << 40) as f64;
/// Rays stray that lie farther from their fit than this share of its slopes: twice that is a Newton step's tolerance in
/// the node's units, and of half the node such a step says nothing any more.
pub const LOOSE: f64 = 0.25;
/// And farther than this share of their own size: next to no slope at all a hair would count.
pub const LOOSE_SIZE: f64 = 1.0 / (1u64 << 12) as f64;

/// The affine function nearest to values at places, by least squares: value at the centre and slopes; and the largest
/// distance that remains. At least one place.
pub fn affine(pairs: impl Iterator<Item = (DVec2, DVec3)> + Clone) -> ([DVec3; 3], f64) {
    let (mut n, mut centre, mut mean) = (0.0, DVec2::ZERO, DVec3::ZERO);
    let (mut lo, mut hi) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for (place, value) in pairs.clone() {
        (n, centre, mean) = (n + 1.0, centre + place, mean + value);
        (lo, hi) = (lo.min(value), hi.max(value));
    }
    if lo == hi {
        // rays from one point, or parallel ones
        return ([lo, DVec3::ZERO, DVec3::ZERO], 0.0);
    }
    (centre, mean) = (centre / n, mean / n);
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    let mut right = [DVec3::ZERO; 2];
    for (place, value) in pairs.clone() {
        let q = place - centre;
        (xx, xy, yy) = (xx + q.x * q.x, xy + q.x * q.y, yy + q.y * q.y);
        right[0] += q.x * (value - mean);
        right[1] += q.y * (value - mean);
    }
    let det = xx * yy - xy * xy;
    // places on a line fix no plane: the mean alone, and honest radii
    let inverse = if det > FIT_ROUNDING * (xx + yy).powi(2) { [yy / det, -xy / det, xx / det] } else { [0.0; 3] };
    let x = inverse[0] * right[0] + inverse[1] * right[1];
    let y = inverse[1] * right[0] + inverse[2] * right[1];
    let fit = [mean - centre.x * x - centre.y * y, x, y];
    let far = |(q, v): (DVec2, DVec3)| (fit[0] + q.x * fit[1] + q.y * fit[2] - v).length();
    (fit, pairs.map(far).fold(0.0, f64::max))
}

impl Fit {
    /// The bundle nearest to the rays; its radii hold them and what lies that far from them.
    pub fn of(tile: &TileRays) -> Fit {
        if tile.rays.is_empty() {
            return Fit::default();
        }
        let (p, off_p) = affine(tile.rays.iter().map(|s| (s.place, s.p)));
        let (d, off_d) = affine(tile.rays.iter().map(|s| (s.place, s.d)));
        let (r_p, r_d) = (off_p + tile.r_p, off_d + tile.r_d);
        let mut fit = Fit { p, d, r_p, r_d, rays: RAYS_LOOSE };
        let (size_p, size_d) = fit.sizes();
        if r_p <= FIT_ROUNDING * size_p && r_d <= FIT_ROUNDING * size_d {
            fit.rays = RAYS_AFFINE;
        }
        fit
    }

    /// The rays of a bundle, its weight constant, over a square that extends `half` pixels to each side of its centre.
    pub fn of_bundle(Bundle { p, d, h }: &Bundle, half: f64) -> Fit {
        let over = |v: &[DVec3; 3]| [v[0] / h[0], half * v[1] / h[0], half * v[2] / h[0]];
        Fit { p: over(p), d: over(d), r_p: 0.0, r_d: 0.0, rays: RAYS_AFFINE }
    }

    /// Whether the rays are those of a bundle of constant weight, with nothing beside it.
    pub fn is_of_bundle(&self) -> bool {
        self.rays == RAYS_AFFINE && self.r_p == 0.0 && self.r_d == 0.0
    }

    /// Extends affine rays to a square `times` as large with the same upper left corner.
    pub fn extended(&self, times: f64) -> Fit {
        let over = |[c, x, y]: [DVec3; 3]| [c + (times - 1.0) * (x + y), times * x, times * y];
        Fit { p: over(self.p), d: over(self.d), ..*self }
    }

    /// Origins or directions lie so far from the fit that it says little.
    pub fn is_loose(&self) -> bool {
        let far = |r: f64, fit: &[DVec3; 3], size: f64| {
            r > LOOSE * (fit[1].length() + fit[2].length()) && r > LOOSE_SIZE * size
        };
        let (size_p, size_d) = self.sizes();
        far(self.r_p, &self.p, size_p) || far(self.r_d, &self.d, size_d)
    }

    /// How far rays may lie from the fit, against how large they are.
    pub fn looseness(&self) -> f64 {
        let (size_p, size_d) = self.sizes();
        let share = |r: f64, size: f64| if r > 0.0 { r / size } else { 0.0 };
        share(self.r_p, size_p) + share(self.r_d, size_d)
    }

    fn sizes(&self) -> (f64, f64) {
        let size = |c: &[DVec3; 3]| c.iter().map(|v| v.length()).sum::<f64>();
        (size(&self.p), size(&self.d))
    }

    /// As kernels read it: a bound of the rays, perturbed or not, in a scene of this size.
    pub fn packed(&self, scene_size: f64) -> layout::Node {
        let (size_p, size_d) = self.sizes();
        let (r_p, r_d) = (self.r_p + PERTURB * scene_size, self.r_d + PERTURB * size_d);
        let v = |v: DVec3| v.as_vec3().to_array();
        layout::Node {
            p: v(self.p[0]),
            r_p: (r_p + NODE_ERROR * (size_p + r_p)) as f32,
            px: v(self.p[1]),
            r_d: (r_d + NODE_ERROR * (size_d + r_d)) as f32,
            py: v(self.p[2]),
            rays: self.rays,
            d: v(self.d[0]),
            width: 0.0,
            dx: v(self.d[1]),
            piece: layout::NONE,
            dy: v(self.d[2]),
            pad2: 0.0,
        }
    }
}
