//! A cow and a walker, put together from ellipsoids.

use crate::arrays::MapEach;
use glam::DVec3;

use super::icosphere::icosphere;
use crate::geometry::mesh::Mesh;

/// An ellipsoid of revolution.
struct Part {
    material: u32,
    /// Its ends.
    from: [f64; 3],
    to: [f64; 3],
    /// Half its width across them.
    radius: f64,
    /// A second one is its mirror image in the plane z = 0.
    twice: bool,
}

const fn one(material: u32, from: [f64; 3], to: [f64; 3], radius: f64) -> Part {
    Part { material, from, to, radius, twice: false }
}

const fn two(material: u32, from: [f64; 3], to: [f64; 3], radius: f64) -> Part {
    Part { material, from, to, radius, twice: true }
}

const COW_MATERIALS: [(&str, [f32; 3]); 4] = [
    ("hide", [0.82, 0.78, 0.7]),
    ("brown", [0.3, 0.13, 0.06]),
    ("skin", [0.8, 0.45, 0.4]),
    ("horn", [0.06, 0.05, 0.04]),
];

/// It looks along +x. The patches differ: two on its left side (-z), one on its right.
const COW: [Part; 20] = [
    one(0, [-1.1, 1.05, 0.0], [0.95, 1.05, 0.0], 0.44),
    one(0, [-1.08, 1.12, 0.0], [-0.2, 1.1, 0.0], 0.41),
    one(1, [0.1, 1.1, 0.0], [0.98, 1.12, 0.0], 0.43),
    one(1, [0.5, 1.08, 0.0], [1.42, 1.66, 0.0], 0.23),
    one(1, [1.08, 1.68, 0.0], [1.78, 1.34, 0.0], 0.19),
    one(2, [1.54, 1.43, 0.0], [1.86, 1.29, 0.0], 0.14),
    one(2, [-0.6, 0.66, 0.0], [-0.15, 0.66, 0.0], 0.17),
    one(0, [-1.02, 1.32, 0.0], [-1.22, 0.4, 0.0], 0.045),
    one(1, [-1.19, 0.62, 0.0], [-1.25, 0.28, 0.0], 0.07),
    one(1, [-0.95, 1.22, -0.24], [-0.35, 1.16, -0.36], 0.2),
    one(1, [-0.35, 0.92, -0.36], [0.05, 0.95, -0.38], 0.12),
    one(1, [-0.75, 1.1, 0.32], [-0.1, 1.2, 0.34], 0.17),
    two(1, [1.2, 1.66, 0.1], [1.1, 1.68, 0.44], 0.075),
    two(3, [1.2, 1.7, 0.08], [1.3, 1.98, 0.26], 0.04),
    two(3, [1.41, 1.59, 0.15], [1.47, 1.56, 0.17], 0.035),
    two(0, [0.62, 1.1, 0.22], [0.62, 0.0, 0.22], 0.12),
    two(0, [-0.74, 1.2, 0.22], [-0.78, 0.0, 0.22], 0.14),
    two(3, [0.55, 0.06, 0.22], [0.75, 0.06, 0.22], 0.06),
    two(3, [-0.86, 0.06, 0.22], [-0.64, 0.06, 0.22], 0.06),
    two(2, [1.72, 1.36, 0.06], [1.8, 1.32, 0.09], 0.03),
];

const WALKER_MATERIALS: [(&str, [f32; 3]); 4] = [
    ("shirt", [0.75, 0.18, 0.12]),
    ("trousers", [0.1, 0.17, 0.42]),
    ("skin", [0.8, 0.55, 0.42]),
    ("black", [0.05, 0.04, 0.04]),
];

/// He walks along +x, the left leg (-z) and the right arm in front.
const WALKER: [Part; 21] = [
    one(0, [0.0, 0.9, 0.0], [0.02, 1.55, 0.0], 0.2),
    one(0, [0.0, 1.38, -0.28], [0.0, 1.38, 0.28], 0.1),
    one(1, [0.0, 0.78, 0.0], [0.0, 1.12, 0.0], 0.18),
    one(2, [0.01, 1.42, 0.0], [0.03, 1.62, 0.0], 0.06),
    one(2, [0.03, 1.54, 0.0], [0.04, 1.8, 0.0], 0.1),
    one(3, [-0.08, 1.68, 0.0], [0.1, 1.78, 0.0], 0.09),
    two(3, [0.11, 1.69, 0.035], [0.14, 1.69, 0.04], 0.015),
    one(2, [0.11, 1.66, 0.0], [0.17, 1.63, 0.0], 0.02),
    one(1, [-0.02, 0.98, -0.1], [0.26, 0.48, -0.1], 0.1),
    one(1, [0.22, 0.56, -0.1], [0.34, 0.05, -0.1], 0.07),
    one(3, [0.27, 0.05, -0.1], [0.54, 0.05, -0.1], 0.05),
    one(1, [0.02, 0.98, 0.1], [-0.12, 0.46, 0.1], 0.1),
    one(1, [-0.1, 0.54, 0.1], [-0.48, 0.12, 0.1], 0.07),
    one(3, [-0.52, 0.18, 0.1], [-0.32, 0.04, 0.1], 0.05),
    one(0, [0.0, 1.45, -0.25], [-0.14, 1.12, -0.28], 0.06),
    one(2, [-0.13, 1.18, -0.28], [-0.1, 0.88, -0.28], 0.045),
    one(2, [-0.1, 0.92, -0.28], [-0.07, 0.8, -0.28], 0.04),
    one(0, [0.0, 1.45, 0.25], [0.16, 1.12, 0.28], 0.06),
    one(2, [0.13, 1.16, 0.28], [0.38, 1.02, 0.26], 0.045),
    one(2, [0.34, 1.04, 0.26], [0.47, 1.0, 0.26], 0.04),
    one(3, [-0.2, 1.02, 0.0], [0.2, 1.02, 0.0], 0.14),
];

/// A cow of 28 ellipsoids, each an [`icosphere`] of 20 * 4^level triangles with smooth normals: 3.2 units long and 2
/// high, it stands on y = 0 and looks along +x.
pub fn cow(level: u32) -> Mesh {
    figure(&COW, &COW_MATERIALS, level)
}

/// A walking man of 22 ellipsoids, as [`cow`]: 1.8 units high, he stands on y = 0 and walks along +x.
pub fn walker(level: u32) -> Mesh {
    figure(&WALKER, &WALKER_MATERIALS, level)
}

fn figure(parts: &[Part], materials: &[(&str, [f32; 3])], level: u32) -> Mesh {
    let ball = icosphere(level);
    let mut mesh = Mesh { materials: super::materials(materials), ..Mesh::default() };
    for part in parts {
        let [from, to] = [part.from, part.to].map_each(DVec3::from_array);
        push_ellipsoid(&mut mesh, &ball, [from, to], part.radius, part.material);
        if part.twice {
            let mirror = DVec3::new(1.0, 1.0, -1.0);
            push_ellipsoid(&mut mesh, &ball, [from * mirror, to * mirror], part.radius, part.material);
        }
    }
    mesh
}

/// Appends `ball` stretched along `ends` to their distance, and across to 2 `radius`.
fn push_ellipsoid(mesh: &mut Mesh, ball: &Mesh, ends: [DVec3; 2], radius: f64, material: u32) {
    let base = mesh.positions.len() as u32;
    let (centre, half) = ((ends[0] + ends[1]) / 2.0, (ends[1] - ends[0]) / 2.0);
    let (axis, length) = (half.normalize(), half.length());
    let stretched = |p: DVec3, along: f64, across: f64| across * p + (along - across) * p.dot(axis) * axis;
    mesh.positions.extend(ball.positions.iter().map(|&p| centre + stretched(p, length, radius)));
    // normals of a stretched surface shrink where it grows
    let normal = |&p: &DVec3| stretched(p, 1.0 / length, 1.0 / radius).normalize().as_vec3().normalize();
    mesh.normals.extend(ball.positions.iter().map(normal));
    let triangles = ball.triangles.iter().map(|t| t.map_each(|i| base + i));
    mesh.corner_normals.extend(triangles.clone());
    mesh.triangles.extend(triangles);
    mesh.material_of.resize(mesh.triangles.len(), material);
}

#[cfg(test)]
mod tests {
    use super::super::testing::{assert_closed, assert_sound, bounds, six_volumes};
    use super::*;

    /// An ellipsoid of revolution's volume is the ball's times length * radius^2, whatever the triangles.
    #[test]
    fn parts_are_closed_and_of_their_volume() {
        for (mesh, parts) in [(cow(2), &COW[..]), (walker(2), &WALKER[..])] {
            assert_sound(&mesh);
            assert_closed(&mesh);
            let volume = |p: &Part| {
                let length = DVec3::from_array(p.to).distance(DVec3::from_array(p.from)) / 2.0;
                length * p.radius.powi(2) * if p.twice { 2.0 } else { 1.0 }
            };
            let expected = six_volumes(&icosphere(2)) * parts.iter().map(volume).sum::<f64>();
            // sums of some thousand terms of size 1
            assert!((six_volumes(&mesh) - expected).abs() < 1e-11, "{} {expected}", six_volumes(&mesh));
            assert!((0..mesh.materials.len() as u32).all(|m| mesh.material_of.contains(&m)));
        }
    }

    #[test]
    fn figures_stand_on_the_ground_and_have_their_size() {
        // as the tables' ends and radii say, to a tenth
        for (mesh, size) in [(cow(3), DVec3::new(3.15, 2.0, 1.0)), (walker(3), DVec3::new(1.05, 1.8, 0.6))] {
            let (low, high) = bounds(&mesh);
            assert!((-1e-3..0.02).contains(&low.y), "{low}");
            assert!((high - low - size).abs().max_element() < 0.1, "{}", high - low);
        }
    }
}
