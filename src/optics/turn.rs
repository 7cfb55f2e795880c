//! What surfaces make of rays: the definitions in f64.

use super::{Branch, FLAT_LEAST, Facet, Law, Optics, Turn};
use glam::{DVec2, DVec3};

/// How a ray is turned: which part of its light, and the tilt of normals.
#[derive(Debug, Clone, Copy)]
pub struct Spin {
    pub branch: Branch,
    pub tilt: DVec2,
}

/// Where a ray is turned that meets a facet with these weights of the second and third corner; where to, and its share of the
/// light.
pub fn at_facet(
    by: (&Optics, Spin),
    law: Law,
    facet: &Facet,
    direction: DVec3,
    [u, v]: [f64; 2],
) -> (DVec3, (DVec3, f64)) {
    let weights = [1.0 - u - v, u, v];
    let mixed = |v: [DVec3; 3]| weights[0] * v[0] + weights[1] * v[1] + weights[2] * v[2];
    let [a, b, c] = facet.corners;
    let outside = (b - a).cross(c - a);
    let turned = match law {
        Law::Normals => after(by, direction, mixed(facet.normals), outside),
        Law::Flat { eye } => {
            let at = |k: usize| after(by, facet.corners[k] - eye, facet.normals[k], outside);
            let ((a, share_a), (b, share_b), (c, share_c)) = (at(0), at(1), at(2));
            let corners = [a, b, c];
            let heights = corners.map(|d| d.dot(outside.normalize()));
            let leaves = |side: f64| heights.iter().all(|h| side * h >= FLAT_LEAST);
            let scaled = [0, 1, 2].map(|k| corners[k] / heights[k].abs());
            let direction = if leaves(1.0) || leaves(-1.0) { mixed(scaled) } else { mixed(corners) };
            (direction, weights[0] * share_a + weights[1] * share_b + weights[2] * share_c)
        }
    };
    (mixed(facet.corners), turned)
}

/// The unit direction after a surface with a normal, and its share of the light; which side is met, `outside` says. Zero where
/// nothing goes that way.
pub fn after((optics, spin): (&Optics, Spin), direction: DVec3, normal: DVec3, outside: DVec3) -> (DVec3, f64) {
    let d = direction.normalize();
    let n = tilted(normal.normalize(), spin.tilt);
    let reflected = d - 2.0 * d.dot(n) * n;
    let Turn::Refract { ior } = optics.turn else { return (reflected, 1.0) };
    // indices on this side and on the other
    let (n1, n2) = if d.dot(outside) < 0.0 { (1.0, ior) } else { (ior, 1.0) };
    let (cosine, against) = if d.dot(n) < 0.0 { (-d.dot(n), n) } else { (d.dot(n), -n) };
    let square = 1.0 - (n1 / n2).powi(2) * (1.0 - cosine * cosine);
    if square < 0.0 {
        return if spin.branch == Branch::Main { (reflected, 1.0) } else { (DVec3::ZERO, 0.0) };
    }
    let inner = square.sqrt();
    let refracted = n1 / n2 * d + (n1 / n2 * cosine - inner) * against;
    let s = (n1 * cosine - n2 * inner) / (n1 * cosine + n2 * inner);
    let p = (n2 * cosine - n1 * inner) / (n2 * cosine + n1 * inner);
    let back = if optics.fresnel { (s * s + p * p) / 2.0 } else { 0.0 };
    if spin.branch == Branch::Main { (refracted, 1.0 - back) } else { (reflected, back) }
}

/// A unit normal tilted in its tangent plane, whose axes are those of Duff et al. 2017.
fn tilted(n: DVec3, tilt: DVec2) -> DVec3 {
    if tilt == DVec2::ZERO {
        return n;
    }
    let side = if n.z >= 0.0 { 1.0 } else { -1.0 };
    let a = -1.0 / (side + n.z);
    let b = n.x * n.y * a;
    let axes =
        [DVec3::new(1.0 + side * n.x * n.x * a, side * b, -side * n.x), DVec3::new(b, side + n.y * n.y * a, -n.y)];
    (n + tilt.x * axes[0] + tilt.y * axes[1]).normalize()
}
