//! Reflection and refraction of a ray at a surface: the definitions, in f64.

use super::{Bounce, Branch, FLAT_LEAST, Facet, Law, Optics};
use crate::arrays::MapEach;
use glam::{DVec2, DVec3};

/// Which branch of a split ray is followed, and the tilt of its normals.
#[derive(Debug, Clone, Copy)]
pub struct Split {
    pub branch: Branch,
    pub tilt: DVec2,
}

/// The bounce of a ray that meets a facet at barycentric weights `[u, v]` of its second and third corner: the point, then the new
/// direction and its share of the light.
pub fn at_facet(
    by: (&Optics, Split),
    law: Law,
    facet: &Facet,
    direction: DVec3,
    [u, v]: [f64; 2],
) -> (DVec3, (DVec3, f64)) {
    let weights = [1.0 - u - v, u, v];
    let mixed = |v: [DVec3; 3]| weights[0] * v[0] + weights[1] * v[1] + weights[2] * v[2];
    let [a, b, c] = facet.corners;
    let outside = (b - a).cross(c - a);
    let bounced = match law {
        Law::Normals => after(by, direction, mixed(facet.normals), outside),
        Law::Flat { eye } => {
            let bent = [0, 1, 2].map_each(|k| bent(by, facet.corners[k] - eye, facet.normals[k], outside));
            let corners = [0, 1, 2].map_each(|k| bent[k].d);
            let heights = corners.map_each(|d| d.dot(outside.normalize()));
            let leaves = |side: f64| heights.iter().all(|h| side * h >= FLAT_LEAST);
            let scaled = [0, 1, 2].map_each(|k| corners[k] / heights[k].abs());
            let direction = if leaves(1.0) || leaves(-1.0) { mixed(scaled) } else { mixed(corners) };
            (direction, weights[0] * bent[0].share + weights[1] * bent[1].share + weights[2] * bent[2].share)
        }
    };
    (mixed(facet.corners), bounced)
}

/// The unit direction after a surface with a shading `normal`, and its share of the light; both zero if no light goes there. `outside` is
/// the geometric normal; its sign says which side is hit. An interpolated or tilted normal may send a direction to the wrong side of the
/// surface; it is then reflected by the surface's plane.
pub fn after(by: (&Optics, Split), direction: DVec3, normal: DVec3, outside: DVec3) -> (DVec3, f64) {
    let Bent { d, share, transmitted } = bent(by, direction, normal, outside);
    let up = outside.normalize();
    let height = d.dot(up);
    let is_wrong = height != 0.0 && (height * direction.dot(up) < 0.0) == transmitted;
    (if is_wrong { d - 2.0 * height * up } else { d }, share)
}

/// A direction reflected or refracted by a normal.
struct Bent {
    d: DVec3,
    share: f64,
    /// Refracted to the other side of the surface.
    transmitted: bool,
}

fn bent((optics, split): (&Optics, Split), direction: DVec3, normal: DVec3, outside: DVec3) -> Bent {
    let d = direction.normalize();
    let n = tilted(normal.normalize(), split.tilt);
    let reflected = |share: f64| Bent { d: d - 2.0 * d.dot(n) * n, share, transmitted: false };
    let Bounce::Refract { ior } = optics.bounce else { return reflected(1.0) };
    // indices on this side and on the other
    let (n1, n2) = if d.dot(outside) < 0.0 { (1.0, ior) } else { (ior, 1.0) };
    let (cosine, against) = if d.dot(n) < 0.0 { (-d.dot(n), n) } else { (d.dot(n), -n) };
    let square = 1.0 - (n1 / n2).powi(2) * (1.0 - cosine * cosine);
    if square < 0.0 {
        let nothing = Bent { d: DVec3::ZERO, share: 0.0, transmitted: false };
        return if split.branch == Branch::Main { reflected(1.0) } else { nothing };
    }
    let inner = square.sqrt();
    let refracted = n1 / n2 * d + (n1 / n2 * cosine - inner) * against;
    let s = (n1 * cosine - n2 * inner) / (n1 * cosine + n2 * inner);
    let p = (n2 * cosine - n1 * inner) / (n2 * cosine + n1 * inner);
    let back = if optics.fresnel { (s * s + p * p) / 2.0 } else { 0.0 };
    match split.branch {
        Branch::Main => Bent { d: refracted, share: 1.0 - back, transmitted: true },
        Branch::Reflected => reflected(back),
    }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::optics::{Facets, Surface};
    use crate::geometry::generate::icosphere;

    fn optics(bounce: Bounce) -> Optics {
        let facets = Facets::of_mesh(&icosphere(2)).unwrap();
        Optics::new(bounce, Surface::Facets { facets, law: Law::Normals }, 2)
    }

    /// A ball of facets: interpolated normals lean away from the facets', so that some rays meet them from behind.
    #[test]
    fn no_ray_leaves_a_facet_on_the_wrong_side() {
        let split = Split { branch: Branch::Main, tilt: DVec2::ZERO };
        for (bounce, transmitted) in [(Bounce::Reflect, false), (Bounce::Refract { ior: 1.5 }, true)] {
            let optics = optics(bounce);
            let facets = optics.facets().unwrap();
            let (mut seen, mut mended) = (0, 0);
            for k in 0..facets.triangles.len() {
                let facet = facets.facet(k);
                let [a, b, c] = facet.corners;
                let up = (b - a).cross(c - a).normalize();
                for (u, v) in [(0.3, 0.3), (0.05, 0.05), (0.9, 0.05), (0.05, 0.9)] {
                    for d in [DVec3::NEG_Z, DVec3::new(0.3, -0.8, 0.2), DVec3::X] {
                        if d.dot(up) >= 0.0 {
                            continue;
                        }
                        let n = (1.0 - u - v) * facet.normals[0] + u * facet.normals[1] + v * facet.normals[2];
                        let bent = bent((&optics, split), d, n, up);
                        let (_, (after, share)) = at_facet((&optics, split), Law::Normals, &facet, d, [u, v]);
                        let is_right = |d: DVec3| (d.dot(up) < 0.0) == bent.transmitted;
                        assert!(is_right(after), "{bounce:?} at facet {k}: {after}");
                        assert!((after.length() - 1.0).abs() < 1e-14 && share == 1.0);
                        // a right direction is not changed
                        assert!(!is_right(bent.d) || after == bent.d);
                        assert_eq!(bent.transmitted, transmitted);
                        seen += 1;
                        mended += usize::from(!is_right(bent.d));
                    }
                }
            }
            println!("{bounce:?}: {mended} of {seen} directions mended");
            assert!(mended > 0 || transmitted);
        }
    }
}
