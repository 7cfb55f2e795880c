//! An upright cylinder.

use crate::arrays::MapEach;
use glam::{DVec3, Vec2, Vec3};

use crate::geometry::mesh::{Material, Mesh, NO_NORMAL};

/// The cylinder of diameter and height 1 about the origin, upright: a closed prism of `sides` sides (3 to 2^25)
/// whose edges lie on it, with smooth normals around and flat caps. Texture coordinates run once around and upwards, and over the
/// caps' squares. 4 sides - 4 triangles over 2 sides vertices:
/// the sides' two each, the upper cap, the lower one.
pub fn cylinder(sides: u32) -> Mesh {
    let direction = |k: u32| {
        let (sin, cos) = (std::f64::consts::TAU * f64::from(k) / f64::from(sides)).sin_cos();
        DVec3::new(sin, 0.0, cos)
    };
    let ring = |y: f64| (0..sides).map(move |k| direction(k) / 2.0 + DVec3::Y * y);
    let (mut triangles, mut corner_normals, mut corner_uvs) = (Vec::new(), Vec::new(), Vec::new());
    for k in 0..sides {
        // vertices 0 to sides - 1 are the lower ones
        let next = (k + 1) % sides;
        triangles.extend([[k, next, sides + next], [k, sides + next, sides + k]]);
        corner_normals.extend([[k, next, next], [k, next, k]]);
        // below and above, sides + 1 of each; then the caps' squares
        let above = sides + 1;
        corner_uvs.extend([[k, k + 1, above + k + 1], [k, above + k + 1, above + k]]);
    }
    let fan = 1..sides - 1;
    triangles.extend(fan.clone().map(|k| [sides, sides + k, sides + k + 1]));
    triangles.extend(fan.map(|k| [0, k + 1, k]));
    corner_normals.resize(triangles.len(), [NO_NORMAL; 3]);
    let caps = 2 * (sides + 1);
    let of_caps = &triangles[2 * sides as usize..];
    corner_uvs.extend(of_caps.iter().map(|t: &[u32; 3]| t.map_each(|corner| caps + corner)));
    let around = |v: f32| (0..=sides).map(move |k| Vec2::new(k as f32 / sides as f32, v));
    let square = (0..2 * sides).map(|k| {
        let d = direction(k % sides) / 2.0 + 0.5;
        Vec2::new(d.x as f32, if k < sides { d.z } else { 1.0 - d.z } as f32)
    });
    let unit = |k: u32| -> Vec3 { direction(k).as_vec3().normalize() };
    Mesh {
        positions: ring(-0.5).chain(ring(0.5)).collect(),
        normals: (0..sides).map(unit).collect(),
        material_of: vec![0; triangles.len()],
        materials: vec![Material::default()],
        uvs: around(0.0).chain(around(1.0)).chain(square).collect(),
        triangles,
        corner_normals,
        corner_uvs,
        ..Mesh::default()
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{assert_closed, assert_sound, bounds, six_volumes};
    use super::*;

    /// A regular polygon of n corners on a circle of radius 1/2 has the area n sin(2 pi / n) / 8.
    #[test]
    fn a_cylinder_is_closed_and_of_its_polygons_volume() {
        for sides in [3, 4, 33] {
            let mesh = cylinder(sides);
            assert_sound(&mesh);
            assert_closed(&mesh);
            let n = f64::from(sides);
            let volume = n * (std::f64::consts::TAU / n).sin() / 8.0;
            assert!((six_volumes(&mesh) / 6.0 - volume).abs() < 1e-14 * n, "{sides}");
            let (low, high) = bounds(&mesh);
            assert_eq!((low.y, high.y, high.z), (-0.5, 0.5, 0.5));
        }
    }
}
