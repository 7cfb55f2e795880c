//! Where the sides of edges are decided: next to a pixel's centre.
//!
//! A ray that meets an edge exactly must pass on one side of it, the same for all triangles. And a ray that should meet it exactly
//! misses it by a rounding, which no two ways to compute the ray share. So every side is that of a ray beside the pixel's centre: to
//! the right and half as far down, by far more than rounding and far less than anything that is seen. The reference, the twins
//! and the kernels (`wgsl/shared/beside.wgsl`) take the same one, so that they agree about edges through pixel centres too.
//! Depths and weights are those of the centre.

use super::bundle::Bundle;
use glam::{DVec3, Vec3Swizzles};

/// How far origins and directions move, relative to the scene's size and to the direction's own: 2^-42. That is 64 roundings of a number
/// that kernels store (2^-48) to the right and 36 down.
pub const BESIDE: f64 = 1.0 / (1u64 << 42) as f64;

/// How far at most, px: 2^-24. That is also what f32 may round off a pixel's slopes, so that kernels' bounds in f32 hold it.
pub const BESIDE_PX: f64 = 1.0 / (1u64 << 24) as f64;

/// How far down for a step to the right: no simple fraction, along which edges of grids run.
pub const BESIDE_DOWN: f64 = 47.0 / 83.0;

/// Positions far from the world's origin are rounded more: a 16th of their distance counts as size.
const FAR_SHARE: f64 = 1.0 / 16.0;

fn size(v: DVec3) -> f64 {
    v.abs().element_sum()
}

/// The size of a scene in these bounds, rounded up to a power of two, so that it is as good as never changed by a triangle more.
pub fn reach(bounds: Option<(DVec3, DVec3)>) -> f64 {
    let Some((lo, hi)) = bounds else { return 0.0 };
    let reach = size(hi - lo) + FAR_SHARE * size(lo.abs().max(hi.abs()));
    if reach > 0.0 { reach.log2().ceil().exp2() } else { 0.0 }
}

impl Bundle {
    /// The bundle about the place where the sides of its centre are decided, in a scene of this size; and how far to the right that is,
    /// px. Without a size rays stay where they are.
    pub fn beside(&self, reach: f64) -> (Bundle, f64) {
        if reach == 0.0 {
            return (*self, 0.0);
        }
        let b = self.sloping();
        let place = b.p[0] / b.h[0];
        let origins = (size(b.p[1] - b.h[1] * place) + size(b.p[2] - b.h[2] * place)) / b.h[0].abs();
        let directions = (size(b.d[1]) + size(b.d[2])) / size(b.d[0]);
        let step = (BESIDE * reach / (origins + reach * directions)).min(BESIDE_PX);
        (b.recentred(step, BESIDE_DOWN * step), step)
    }

    /// The bundle with slopes both ways: a ray without a neighbour on the right or below goes across the other slope instead, and without
    /// both anywhere.
    pub fn sloping(&self) -> Bundle {
        let mut b = *self;
        let along = b.d[0] / size(b.d[0]);
        let [no_right, no_down] = [1, 2].map(|k| (b.p[k], b.d[k], b.h[k]) == (DVec3::ZERO, DVec3::ZERO, 0.0));
        if no_right && no_down {
            b.d[1] = b.d[0].yzx();
        } else if no_right {
            (b.p[1], b.d[1]) = (along.cross(b.p[2]), along.cross(b.d[2]));
        }
        if no_down {
            (b.p[2], b.d[2]) = (along.cross(b.p[1]), along.cross(b.d[1]));
        }
        b
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RIGHT: DVec3 = DVec3::new(0.01, 0.0, 0.0);
    const DOWN: DVec3 = DVec3::new(0.0, -0.01, 0.0);

    #[test]
    fn constants_are_the_kernel_s() {
        let source = include_str!("../../wgsl/shared/beside.wgsl");
        for (name, value) in [("BESIDE_PX", "1.0 / 16777216.0"), ("BESIDE_DOWN", "47.0 / 83.0")] {
            assert!(source.contains(&format!("const {name}: real = {value};")), "{name}");
        }
        assert_eq!(BESIDE_PX, 1.0 / 16_777_216.0);
        let share = "const BESIDE: real = 2.2737367544323206e-13;";
        assert!(include_str!("../../wgsl/shared/real_f64.wgsl").contains(share));
        assert_eq!(BESIDE, 2.2737367544323206e-13);
        assert!(
            include_str!("../../wgsl/shared/params.wgsl").contains("const BESIDE_LOST: f32 = 1.0 / 2199023255552.0;")
        );
        assert_eq!(2.0 * BESIDE, 1.0 / 2_199_023_255_552.0);
    }

    /// Right and down, by what was said and no more, wherever the scene is and whatever weight the bundle has.
    #[test]
    fn rays_go_aside_by_the_scene_s_size() {
        for h in [[1.0, 0.0, 0.0], [2.0, 0.3, -0.1], [-1.0, 0.0, 0.2]] {
            let at = DVec3::new(5.0, -3.0, 1.0);
            let bundle = Bundle {
                p: [at * h[0], RIGHT + at * h[1], DOWN + at * h[2]],
                d: [DVec3::NEG_Z, DVec3::ZERO, DVec3::ZERO],
                h,
            };
            for reach in [0.0, 1.0, 8.0] {
                let moved = bundle.beside(reach).0.ray(0.0, 0.0).origin - at;
                let right = BESIDE * reach / 2.0;
                // the place itself is rounded, and so is what is taken from it
                let room = 4.0 * f64::EPSILON * size(at);
                let expected = right * DVec3::new(1.0, -BESIDE_DOWN, 0.0) * h[0].signum();
                assert!((moved - expected).abs().max_element() <= room, "{h:?} {reach}: {moved}");
            }
        }
        let central = Bundle { p: [DVec3::ZERO; 3], d: [DVec3::NEG_Z, RIGHT, DOWN], h: [1.0, 0.0, 0.0] };
        assert_eq!(central.beside(8.0).1, BESIDE / 0.02);
        let slow = Bundle { d: [DVec3::NEG_Z, 1e-9 * RIGHT, 1e-9 * DOWN], ..central };
        assert_eq!(slow.beside(8.0).1, BESIDE_PX);
        assert_eq!(central.beside(0.0), (central, 0.0));
        // without a neighbour on the right, below, or both
        for (dx, dy) in [(DVec3::ZERO, DOWN), (RIGHT, DVec3::ZERO), (DVec3::ZERO, DVec3::ZERO)] {
            let lone = Bundle { d: [DVec3::NEG_Z, dx, dy], ..central };
            let moved = lone.beside(8.0).0.d[0];
            assert!(moved.x != 0.0 && moved.y != 0.0 && moved.z == -1.0 && size(moved) <= 1.0 + BESIDE, "{moved}");
        }
    }

    #[test]
    fn a_scene_s_size_is_a_power_of_two() {
        assert_eq!(reach(None), 0.0);
        assert_eq!(reach(Some((DVec3::ZERO, DVec3::ZERO))), 0.0);
        assert_eq!(reach(Some((DVec3::splat(-0.5), DVec3::splat(0.5)))), 4.0);
        assert_eq!(reach(Some((DVec3::splat(1e6), DVec3::splat(1e6 + 1.0)))), f64::from(1 << 18));
    }
}
