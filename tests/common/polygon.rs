//! Areas of convex polygons and of what they have in common.

use glam::DVec2;

/// The part of a convex polygon in another, both the same way around (Sutherland and Hodgman 1974).
pub fn common(mut corners: Vec<DVec2>, other: &[DVec2]) -> Vec<DVec2> {
    for (k, &from) in other.iter().enumerate() {
        let side = other[(k + 1) % other.len()] - from;
        let inside = |p: DVec2| side.perp_dot(p - from);
        let mut kept = Vec::new();
        for (k, &p) in corners.iter().enumerate() {
            let q = corners[(k + 1) % corners.len()];
            if inside(p) >= 0.0 {
                kept.push(p);
            }
            if (inside(p) >= 0.0) != (inside(q) >= 0.0) {
                kept.push(p.lerp(q, inside(p) / (inside(p) - inside(q))));
            }
        }
        corners = kept;
    }
    corners
}

pub fn area(corners: &[DVec2]) -> f64 {
    let next = corners.iter().cycle().skip(1);
    0.5 * corners.iter().zip(next).map(|(p, q)| p.perp_dot(*q)).sum::<f64>()
}

/// A pixel about its centre.
pub fn pixel_about(centre: DVec2) -> [DVec2; 4] {
    [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)].map(|corner| centre + DVec2::from(corner))
}
