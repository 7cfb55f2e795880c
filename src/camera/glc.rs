//! The general linear camera: three generator rays, and what kind of camera they make.
//!
//! Yu and McMillan 2004; Yu, Yu and McMillan 2009, section 3.1. Near points `n0 n1 n2` and far points
//! `f0 f1 f2` give `P = n0 + a (n1-n0) + b (n2-n0)`, `Q` alike from the far points, `D = Q - P`.

use super::bundle::Bundle;
use glam::{DMat2, DVec2, DVec3};

/// The bundle between two planes `q[0] + a q[1] + b q[2]`; `None` where they are the same.
pub(super) fn of_planes(near: &[DVec3; 3], far: &[DVec3; 3], width: u32, height: u32) -> Option<Bundle> {
    let (w, h) = (width as f64, height as f64);
    let centred = |q: &[DVec3; 3]| [q[0] + 0.5 * q[1] + 0.5 * q[2], q[1] / w, q[2] / h];
    let dir = [far[0] - near[0], far[1] - near[1], far[2] - near[2]];
    (dir != [DVec3::ZERO; 3]).then(|| Bundle { p: centred(near), d: centred(&dir), h: [1.0, 0.0, 0.0] })
}

/// The class of a GLC by the roots of its characteristic equation `det((1-t) A + t B) = 0`, with `A`, `B`
/// the 2x2 maps from `(a, b)` to the parallel near and far planes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Class {
    Pinhole,
    Orthographic,
    Pushbroom,
    CrossSlit,
    Pencil,
    TwistedOrthographic,
    Bilinear,
    /// Near and far are not parallel: a continuous GLC, whose characteristic equation is a cubic.
    Cglc,
    /// Every ray lies in one plane: the image has no area anywhere.
    Flat,
}

impl Class {
    pub fn name(self) -> &'static str {
        match self {
            Class::Pinhole => "pinhole",
            Class::Orthographic => "orthographic",
            Class::Pushbroom => "pushbroom",
            Class::CrossSlit => "cross-slit",
            Class::Pencil => "pencil",
            Class::TwistedOrthographic => "twisted orthographic",
            Class::Bilinear => "bilinear",
            Class::Cglc => "cglc",
            Class::Flat => "flat",
        }
    }
}

/// Relative size below which a coefficient of the characteristic equation counts as zero. Coefficients are sums of
/// products of two differences of scene-file numbers, so their rounding is some 2^-50; numbers
/// written with 12 digits still classify as meant.
const CLASS_ZERO: f64 = 1e-11;

/// The class, and the ray parameters t of the slits (finite real roots, ascending; a double root once).
pub fn classify(near: &[DVec3; 3], far: &[DVec3; 3]) -> (Class, Vec<f64>) {
    let (p1, p2) = (near[1] - near[0], near[2] - near[0]);
    let (q1, q2) = (far[1] - far[0], far[2] - far[0]);
    let Some((e1, e2)) = common_plane(&[p1, p2, q1, q2]) else { return (Class::Cglc, Vec::new()) };
    let map = |u: DVec3, v: DVec3| DMat2::from_cols(DVec2::new(u.dot(e1), u.dot(e2)), DVec2::new(v.dot(e1), v.dot(e2)));
    roots_and_class(map(p1, p2), map(q1, q2))
}

/// Orthonormal axes of a plane parallel to all of `vectors`, or `None` where there is no such plane.
fn common_plane(vectors: &[DVec3; 4]) -> Option<(DVec3, DVec3)> {
    let largest = vectors.iter().fold(DVec3::ZERO, |m, v| if v.length() > m.length() { *v } else { m });
    let Some(e1) = largest.try_normalize() else { return Some((DVec3::X, DVec3::Y)) };
    let residual = |v: &DVec3| *v - v.dot(e1) * e1;
    let second = vectors.iter().map(residual).fold(DVec3::ZERO, |m, v| if v.length() > m.length() { v } else { m });
    if second.length() <= CLASS_ZERO * largest.length() {
        return Some((e1, e1.any_orthonormal_vector()));
    }
    let e2 = second.normalize();
    let normal = e1.cross(e2);
    vectors.iter().all(|v| v.dot(normal).abs() <= CLASS_ZERO * largest.length()).then_some((e1, e2))
}

fn roots_and_class(a: DMat2, b: DMat2) -> (Class, Vec<f64>) {
    let c = b - a;
    let scale = [a, b].iter().flat_map(|m| m.to_cols_array()).fold(0.0f64, |s, v| s.max(v.abs())).powi(2);
    let zero = |v: f64| v.abs() <= CLASS_ZERO * scale;
    // det(A + t C) = det A + t (a00 c11 + a11 c00 - a01 c10 - a10 c01) + t^2 det C
    let (c0, c2) = (a.determinant(), c.determinant());
    let c1 = a.x_axis.x * c.y_axis.y + a.y_axis.y * c.x_axis.x - a.y_axis.x * c.x_axis.y - a.x_axis.y * c.y_axis.x;
    if zero(c2) {
        return match (zero(c1), zero(c0)) {
            (false, _) => (Class::Pushbroom, vec![-c0 / c1]),
            (true, true) => (Class::Flat, Vec::new()),
            (true, false) if c.to_cols_array().into_iter().all(|v| v * v <= CLASS_ZERO.powi(2) * scale) => {
                (Class::Orthographic, Vec::new())
            }
            (true, false) => (Class::TwistedOrthographic, Vec::new()),
        };
    }
    let discriminant = c1 * c1 - 4.0 * c2 * c0;
    if discriminant.abs() <= CLASS_ZERO * (c1 * c1).max((c2 * c0).abs()) {
        let t = -c1 / (2.0 * c2);
        let m = a + c * t;
        let rank_zero = m.to_cols_array().into_iter().all(|v| v * v <= CLASS_ZERO * scale);
        return (if rank_zero { Class::Pinhole } else { Class::Pencil }, vec![t]);
    }
    if discriminant < 0.0 {
        return (Class::Bilinear, Vec::new());
    }
    let q = -0.5 * (c1 + c1.signum() * discriminant.sqrt());
    let (r0, r1) = (q / c2, c0 / q);
    (Class::CrossSlit, vec![r0.min(r1), r0.max(r1)])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A GLC in the two-plane form: 2x2 maps on z = 0 and z = 1.
    fn two_plane(a: [f64; 4], b: [f64; 4]) -> (Class, Vec<f64>) {
        let pts = |m: [f64; 4], z: f64| [DVec3::new(0., 0., z), DVec3::new(m[0], m[1], z), DVec3::new(m[2], m[3], z)];
        classify(&pts(a, 0.0), &pts(b, 1.0))
    }

    /// Roots of sums of a few products: some ten roundings of 2^-53.
    const ROOT_ROUNDING: f64 = 1e-14;

    #[test]
    fn each_class_by_its_roots() {
        let unit = [1., 0., 0., 1.];
        for (a, b, class, slits) in [
            (unit, [2., 0., 0., 2.], Class::Pinhole, vec![-1.0]),
            ([0.; 4], unit, Class::Pinhole, vec![0.0]),
            (unit, unit, Class::Orthographic, vec![]),
            (unit, [1., 0., 0., 3.], Class::Pushbroom, vec![-0.5]),
            (unit, [2., 0., 0., 3.], Class::CrossSlit, vec![-1.0, -0.5]),
            (unit, [2., 0., 1., 2.], Class::Pencil, vec![-1.0]),
            (unit, [1., 0., 1., 1.], Class::TwistedOrthographic, vec![]),
            (unit, [0., 1., -1., 0.], Class::Bilinear, vec![]),
            ([1., 0., 0., 0.], [1., 0., 0., 0.], Class::Flat, vec![]),
        ] {
            let (found, roots) = two_plane(a, b);
            assert_eq!((found, roots.len()), (class, slits.len()));
            assert!(roots.iter().zip(&slits).all(|(r, s)| (r - s).abs() <= ROOT_ROUNDING), "{class:?}: {roots:?}");
        }
    }

    #[test]
    fn planes_that_are_not_parallel_are_continuous() {
        let near = [DVec3::ZERO, DVec3::X, DVec3::Y];
        let far = [DVec3::Z, DVec3::new(1., 0., 1.5), DVec3::new(0., 1., 1.)];
        assert_eq!(classify(&near, &far).0, Class::Cglc);
    }
}
