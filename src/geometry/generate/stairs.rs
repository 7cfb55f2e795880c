//! A flight of stairs.

use glam::DVec3;

use crate::geometry::mesh::{Material, Mesh};

/// A solid flight of `steps` steps (1 to 2^24) that fills its part of the unit cube [-1/2, 1/2]^3: it rises towards
/// -z, each step 1 / steps high and long. Closed, 12 triangles a step: treads, risers, base, walls and back; flat.
pub fn stairs(steps: u32) -> Mesh {
    let mut mesh = Mesh { materials: vec![Material::default()], ..Mesh::default() };
    let share = |k: u32| f64::from(k) / f64::from(steps);
    // Edge k of the profile, k = 0 to steps, has corners on the base, at step k's level and at the next one's, but for one of each two that
    // are in one place at both ends; each of them on the left and on the right.
    for (k, level) in (0..=steps).flat_map(|k| [(k, 0), (k, 1), (k, 2)]) {
        let y = [0.0, share(k), share((k + 1).min(steps))][level];
        if (k, level) != (0, 1) && (k, level) != (steps, 2) {
            let left = DVec3::new(-0.5, y - 0.5, 0.5 - share(k));
            mesh.positions.extend([left, left + DVec3::X]);
        }
    }
    let corner = |k: u32, level: u32| (6 * k + 2 * level).saturating_sub(2);
    let mut quad = |[a, b]: [u32; 2]| mesh.triangles.extend([[a, a + 1, b + 1], [a, b + 1, b]]);
    for k in 0..steps {
        quad([corner(k, 1), corner(k, 2)]);
        quad([corner(k, 2), corner(k + 1, 1)]);
        quad([corner(k + 1, 0), corner(k, 0)]);
    }
    quad([corner(steps, 1), corner(steps, 0)]);
    for k in 0..steps {
        let (base, level, next) = (corner(k, 0), corner(k, 1), corner(k, 2));
        let (far_base, far) = (corner(k + 1, 0), corner(k + 1, 1));
        for [a, b, c] in [[base, far, far_base], [base, next, far], [base, level, next]] {
            // the first step has nothing between its base and its level
            if a != b {
                mesh.triangles.extend([[a + 1, c + 1, b + 1], [a, b, c]]);
            }
        }
    }
    mesh.material_of = vec![0; mesh.triangles.len()];
    mesh
}

#[cfg(test)]
mod tests {
    use super::super::testing::{assert_closed, assert_sound, bounds, six_volumes};
    use super::*;

    /// The steps' heights are 1/n, 2/n, ... 1, each 1/n long: (n + 1) / 2n of the cube.
    #[test]
    fn stairs_are_closed_and_fill_their_part_of_the_cube() {
        for steps in [1, 2, 3, 16] {
            let mesh = stairs(steps);
            assert_sound(&mesh);
            assert_closed(&mesh);
            assert_eq!(mesh.triangles.len() as u32, 12 * steps);
            assert_eq!(mesh.positions.len() as u32, 4 + 4 * steps + 2 * (steps - 1).min(steps));
            let n = f64::from(steps);
            assert!((six_volumes(&mesh) / 6.0 - (n + 1.0) / (2.0 * n)).abs() < 1e-14 * n, "{steps}");
            assert_eq!(bounds(&mesh), (DVec3::splat(-0.5), DVec3::splat(0.5)));
        }
    }

    #[test]
    fn a_foot_climbs_towards_minus_z() {
        let mesh = stairs(4);
        let on = |y: f64, z: f64| mesh.positions.iter().any(|p| (p.y, p.z) == (y, z));
        assert!(on(-0.25, 0.5) && on(0.5, -0.5) && !on(0.5, 0.5));
    }
}
