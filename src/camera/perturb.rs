//! Perturbed rays, on which coverage is decided.
//!
//! A ray that meets an edge exactly must pass on one side of it, the same for all triangles. And a ray that should meet an edge
//! exactly misses it by rounding, which differs between any two ways to compute the ray. So coverage tests use a perturbed ray: it
//! lies to the right of the pixel's centre and about half as far down, by far more than rounding and far less than anyone can see. The
//! reference, the twins and the kernels (`wgsl/rays/straight/perturb.wgsl`) perturb alike, so they agree about edges through pixel
//! centres too. Depths and weights are those of the unperturbed ray.

use super::bundle::{Bundle, Ray};
use crate::arrays::MapEach;
use crate::geometry::cast::Aim;
use glam::DVec3;

/// How far a perturbation moves origins, relative to the scene's size, and directions, relative to their own: 2^-42. That is 64 roundings
/// of a number that kernels store (2^-48) to the right, and 36 down.
pub const PERTURB: f64 = 1.0 / (1u64 << 42) as f64;

/// Largest perturbation to the right, px: 2^-24. f32 may round a pixel's slopes by as much, so the kernels' bounds in f32 cover it.
pub const PERTURB_PX: f64 = 1.0 / (1u64 << 24) as f64;

/// Step down for a step to the right of 1. Edges of grids run along simple fractions; this is none.
pub const PERTURB_DOWN: f64 = 47.0 / 83.0;

/// How far a hit is moved at most to an end of `t_range`, relative to the scene's size (`docs/reference/definitions.md`, Ends of t_range):
/// 2^-32. A ray whose angle to a plane has the sine 2^-10 stays within 2^-42 of the plane over that distance.
pub const END_REACH: f64 = 1.0 / (1u64 << 32) as f64;

/// The sine of a ray's angle to a triangle's plane (of 1-norms), 2^-21, below which the ray sees the triangle edge-on. Bounds in f32 prove no t
/// there.
pub const EDGE_ON: f64 = 1.0 / (1u64 << 21) as f64;

/// A scene far from the world's origin is rounded more: this share of its distance is added to its size.
const FAR_SHARE: f64 = 1.0 / 16.0;

fn size(v: DVec3) -> f64 {
    v.abs().element_sum()
}

/// The size of a scene with these bounds, rounded up to a power of two, so that one triangle more hardly ever changes it.
pub fn scene_size(bounds: Option<(DVec3, DVec3)>) -> f64 {
    let Some((lo, hi)) = bounds else { return 0.0 };
    let size = size(hi - lo) + FAR_SHARE * size(lo.abs().max(hi.abs()));
    if size > 0.0 { size.log2().ceil().exp2() } else { 0.0 }
}

impl Bundle {
    /// The bundle centred on the perturbed ray, in a scene of this size; and the perturbation to the right, px. A scene of size 0 perturbs
    /// nothing.
    pub fn perturbed(&self, scene_size: f64) -> (Bundle, f64) {
        if scene_size == 0.0 {
            return (*self, 0.0);
        }
        let b = self.sloping();
        let place = b.p[0] / b.h[0];
        let origins = (size(b.p[1] - b.h[1] * place) + size(b.p[2] - b.h[2] * place)) / b.h[0].abs();
        let directions = (size(b.d[1]) + size(b.d[2])) / size(b.d[0]);
        let step = (PERTURB * scene_size / (origins + scene_size * directions)).min(PERTURB_PX);
        (b.recentred(step, PERTURB_DOWN * step), step)
    }

    /// The bundle's central ray, to be cast at a mesh of this size; `None` if it is not finite or has no direction.
    pub fn aim(&self, scene_size: f64) -> Option<Aim> {
        let is_sound = |ray: &Ray| ray.origin.is_finite() && ray.direction.is_finite() && ray.direction != DVec3::ZERO;
        let aim = Aim { ray: self.ray(0.0, 0.0), perturbed: self.perturbed(scene_size).0.ray(0.0, 0.0) };
        (is_sound(&aim.ray) && is_sound(&aim.perturbed)).then_some(aim)
    }

    /// The bundle with slopes both ways. A ray without a neighbour on the right or below gets a slope across its other one; without
    /// both, a slope across its direction.
    pub fn sloping(&self) -> Bundle {
        let mut b = *self;
        let along = b.d[0] / size(b.d[0]);
        let [no_right, no_down] = [1, 2].map_each(|k| (b.p[k], b.d[k], b.h[k]) == (DVec3::ZERO, DVec3::ZERO, 0.0));
        if no_right && no_down {
            b.d[1] = across(b.d[0]);
        } else if no_right {
            (b.p[1], b.d[1]) = (along.cross(b.p[2]), along.cross(b.d[2]));
        }
        if no_down {
            (b.p[2], b.d[2]) = (along.cross(b.p[1]), along.cross(b.d[1]));
        }
        b
    }
}

/// A vector at right angles to this one; 0 only for 0.
fn across(v: DVec3) -> DVec3 {
    if v.x.abs() > v.y.abs() { DVec3::new(-v.z, 0.0, v.x) } else { DVec3::new(0.0, v.z, -v.y) }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RIGHT: DVec3 = DVec3::new(0.01, 0.0, 0.0);
    const DOWN: DVec3 = DVec3::new(0.0, -0.01, 0.0);

    #[test]
    fn constants_match_the_kernels() {
        let source = include_str!("../../wgsl/rays/straight/perturb.wgsl");
        for (name, value) in [("PERTURB_PX", "1.0 / 16777216.0"), ("PERTURB_DOWN", "47.0 / 83.0")] {
            assert!(source.contains(&format!("const {name}: real = {value};")), "{name}");
        }
        assert_eq!(PERTURB_PX, 1.0 / 16_777_216.0);
        let share = "const PERTURB: real = 2.2737367544323206e-13;";
        assert!(include_str!("../../wgsl/arithmetic/f64.wgsl").contains(share));
        assert_eq!(PERTURB, 2.2737367544323206e-13);
        assert!(
            include_str!("../../wgsl/shared/params.wgsl").contains("const PERTURB_BOUND: f32 = 1.0 / 2199023255552.0;")
        );
        assert_eq!(2.0 * PERTURB, 1.0 / 2_199_023_255_552.0);
        assert!(include_str!("../../wgsl/shared/params.wgsl").contains("const END_BOUND: f32 = 1.0 / 2147483648.0;"));
        assert!(
            include_str!("../../wgsl/rays/straight/plane_tolerance.wgsl")
                .contains("const LEAST_SINE: real = 1.0 / 1024.0;")
        );
        assert_eq!([2.0 * END_REACH, PERTURB / END_REACH], [1.0 / 2_147_483_648.0, 1.0 / 1024.0]);
        let edge_on = "const EDGE_ON: real = 1.0 / 2097152.0;";
        assert!(include_str!("../../wgsl/rays/straight/plane_tolerance.wgsl").contains(edge_on));
        assert_eq!(EDGE_ON, 1.0 / 2_097_152.0);
    }

    /// Right and down by the constants above, wherever the scene is and whatever weight the bundle has.
    #[test]
    fn rays_are_perturbed_by_the_scenes_size() {
        for h in [[1.0, 0.0, 0.0], [2.0, 0.3, -0.1], [-1.0, 0.0, 0.2]] {
            let at = DVec3::new(5.0, -3.0, 1.0);
            let bundle = Bundle {
                p: [at * h[0], RIGHT + at * h[1], DOWN + at * h[2]],
                d: [DVec3::NEG_Z, DVec3::ZERO, DVec3::ZERO],
                h,
            };
            for scene_size in [0.0, 1.0, 8.0] {
                let moved = bundle.perturbed(scene_size).0.ray(0.0, 0.0).origin - at;
                let right = PERTURB * scene_size / 2.0;
                // the origin is rounded, and so is the difference
                let tolerance = 4.0 * f64::EPSILON * size(at);
                let expected = right * DVec3::new(1.0, -PERTURB_DOWN, 0.0) * h[0].signum();
                assert!((moved - expected).abs().max_element() <= tolerance, "{h:?} {scene_size}: {moved}");
            }
        }
        let central = Bundle { p: [DVec3::ZERO; 3], d: [DVec3::NEG_Z, RIGHT, DOWN], h: [1.0, 0.0, 0.0] };
        assert_eq!(central.perturbed(8.0).1, PERTURB / 0.02);
        let slow = Bundle { d: [DVec3::NEG_Z, 1e-9 * RIGHT, 1e-9 * DOWN], ..central };
        assert_eq!(slow.perturbed(8.0).1, PERTURB_PX);
        assert_eq!(central.perturbed(0.0), (central, 0.0));
        // without a neighbour on the right, below, or both
        for (dx, dy) in [(DVec3::ZERO, DOWN), (RIGHT, DVec3::ZERO), (DVec3::ZERO, DVec3::ZERO)] {
            let lone = Bundle { d: [DVec3::NEG_Z, dx, dy], ..central };
            let moved = lone.perturbed(8.0).0.d[0];
            assert!(moved.x != 0.0 && moved.y != 0.0 && moved.z == -1.0 && size(moved) <= 1.0 + PERTURB, "{moved}");
        }
    }

    /// A ray without neighbours is perturbed across its direction, whichever that is.
    #[test]
    fn lone_rays_of_every_direction_are_perturbed() {
        for d in
            [DVec3::X, DVec3::Y, DVec3::NEG_Z, DVec3::ONE, DVec3::new(-2.0, -2.0, -2.0), DVec3::new(1.0, -1.0, 1.0)]
        {
            let lone = Bundle { p: [DVec3::ZERO; 3], d: [d, DVec3::ZERO, DVec3::ZERO], h: [1.0, 0.0, 0.0] };
            let angle = lone.perturbed(8.0).0.d[0].cross(d).length() / d.length_squared();
            // to the right and down by at most PERTURB together, and not much less
            assert!((0.1 * PERTURB..=PERTURB).contains(&angle), "{d}: {angle:e}");
        }
    }

    #[test]
    fn a_scenes_size_is_a_power_of_two() {
        assert_eq!(scene_size(None), 0.0);
        assert_eq!(scene_size(Some((DVec3::ZERO, DVec3::ZERO))), 0.0);
        assert_eq!(scene_size(Some((DVec3::splat(-0.5), DVec3::splat(0.5)))), 4.0);
        assert_eq!(scene_size(Some((DVec3::splat(1e6), DVec3::splat(1e6 + 1.0)))), f64::from(1 << 18));
    }
}
