//! Martin Newell's teapot (1975), with the bottom that was added later: 32 bicubic Bezier patches.
//!
//! Body, rim, lid and bottom are patches of revolution: four quarters, each from a profile of four rows. Handle
//! and spout are given as their half on one side; the other is its mirror image. The usual file lists 306 control
//! points for these patches one by one; here quarters and sides share their numbers, and 290 points differ.

use crate::arrays::MapEach;
use glam::{DVec2, DVec3};

use super::plane::grid_triangles;
use crate::geometry::mesh::{Material, Mesh};

/// Control points: rows along v, columns along u; dS/dv x dS/du points outwards. Newell's axes: z is up.
type Patch = [[DVec3; 4]; 4];

/// How far along a quarter circle's end tangents its inner control points lie, in radii.
const QUARTER: f64 = 0.56;
/// The same in the lid's knob, 0.45 / 0.8.
const QUARTER_OF_KNOB: f64 = 0.5625;

/// A control point of a profile: radius, height, and the inner control points' place along the tangents.
type ProfilePoint = (f64, f64, f64);

const fn profile_point(radius: f64, height: f64) -> ProfilePoint {
    (radius, height, QUARTER)
}

/// Profiles so that outwards is left of the way along them (seen with the axis to the left).
const PROFILES: [[ProfilePoint; 4]; 6] = [
    // Rim.
    [profile_point(1.4, 2.4), profile_point(1.3375, 2.53125), profile_point(1.4375, 2.53125), profile_point(1.5, 2.4)],
    // Body.
    [profile_point(1.5, 2.4), profile_point(1.75, 1.875), profile_point(2.0, 1.35), profile_point(2.0, 0.9)],
    [profile_point(2.0, 0.9), profile_point(2.0, 0.45), profile_point(1.5, 0.225), profile_point(1.5, 0.15)],
    // Lid.
    [profile_point(0.0, 3.15), (0.8, 3.15, QUARTER_OF_KNOB), profile_point(0.0, 2.85), profile_point(0.2, 2.7)],
    [profile_point(0.2, 2.7), profile_point(0.4, 2.55), profile_point(1.3, 2.55), profile_point(1.3, 2.4)],
    // Bottom.
    [profile_point(1.5, 0.15), profile_point(1.5, 0.075), profile_point(1.425, 0.0), profile_point(0.0, 0.0)],
];

/// The halves of handle (two patches) and spout (two patches) on the side of negative y.
const HALVES: [[[[f64; 3]; 4]; 4]; 4] = [
    [
        [[-1.6, 0.0, 2.025], [-1.6, -0.3, 2.025], [-1.5, -0.3, 2.25], [-1.5, 0.0, 2.25]],
        [[-2.3, 0.0, 2.025], [-2.3, -0.3, 2.025], [-2.5, -0.3, 2.25], [-2.5, 0.0, 2.25]],
        [[-2.7, 0.0, 2.025], [-2.7, -0.3, 2.025], [-3.0, -0.3, 2.25], [-3.0, 0.0, 2.25]],
        [[-2.7, 0.0, 1.8], [-2.7, -0.3, 1.8], [-3.0, -0.3, 1.8], [-3.0, 0.0, 1.8]],
    ],
    [
        [[-2.7, 0.0, 1.8], [-2.7, -0.3, 1.8], [-3.0, -0.3, 1.8], [-3.0, 0.0, 1.8]],
        [[-2.7, 0.0, 1.575], [-2.7, -0.3, 1.575], [-3.0, -0.3, 1.35], [-3.0, 0.0, 1.35]],
        [[-2.5, 0.0, 1.125], [-2.5, -0.3, 1.125], [-2.65, -0.3, 0.9375], [-2.65, 0.0, 0.9375]],
        [[-2.0, 0.0, 0.9], [-2.0, -0.3, 0.9], [-1.9, -0.3, 0.6], [-1.9, 0.0, 0.6]],
    ],
    [
        [[1.7, 0.0, 1.425], [1.7, -0.66, 1.425], [1.7, -0.66, 0.6], [1.7, 0.0, 0.6]],
        [[2.6, 0.0, 1.425], [2.6, -0.66, 1.425], [3.1, -0.66, 0.825], [3.1, 0.0, 0.825]],
        [[2.3, 0.0, 2.1], [2.3, -0.25, 2.1], [2.4, -0.25, 2.025], [2.4, 0.0, 2.025]],
        [[2.7, 0.0, 2.4], [2.7, -0.25, 2.4], [3.3, -0.25, 2.4], [3.3, 0.0, 2.4]],
    ],
    [
        [[2.7, 0.0, 2.4], [2.7, -0.25, 2.4], [3.3, -0.25, 2.4], [3.3, 0.0, 2.4]],
        [[2.8, 0.0, 2.475], [2.8, -0.25, 2.475], [3.525, -0.25, 2.49375], [3.525, 0.0, 2.49375]],
        [[2.9, 0.0, 2.475], [2.9, -0.15, 2.475], [3.45, -0.15, 2.5125], [3.45, 0.0, 2.5125]],
        [[2.8, 0.0, 2.4], [2.8, -0.15, 2.4], [3.2, -0.15, 2.4], [3.2, 0.0, 2.4]],
    ],
];

/// The Utah teapot: y up, standing on y = 0, spout along +x, bounds (-3, 0, -2) .. (3.434, 3.15, 2). 32 patches of
/// `level` x `level` cells of two triangles: 64 level^2 triangles, facing outwards, with smooth normals from the
/// patches' derivatives and their parameters as texture coordinates. Patches meet without gaps, at equal vertices of their own. At the tips
/// of lid and bottom the cells are triangles: 8 level of the triangles have no area. `level` is 1 to 2048.
pub fn teapot(level: u32) -> Mesh {
    let mut mesh = Mesh { materials: vec![Material::default()], ..Mesh::default() };
    for patch in patches() {
        push_patch(&mut mesh, &patch, level);
    }
    mesh.corner_normals = mesh.triangles.clone();
    mesh.corner_uvs = mesh.triangles.clone();
    mesh.material_of = vec![0; mesh.triangles.len()];
    mesh
}

fn patches() -> Vec<Patch> {
    const TURNS: [DVec3; 5] = [DVec3::X, DVec3::Y, DVec3::NEG_X, DVec3::NEG_Y, DVec3::X];
    let quarters = TURNS.windows(2);
    let mut patches = Vec::new();
    for profile in PROFILES {
        for ends in quarters.clone() {
            patches.push(profile.map_each(|(radius, height, tangent)| {
                let inner = tangent * radius;
                [(radius, 0.0), (radius, inner), (inner, radius), (0.0, radius)]
                    .map_each(|(from, to)| from * ends[0] + to * ends[1] + DVec3::new(0.0, 0.0, height))
            }));
        }
    }
    for half in HALVES {
        let given: Patch = half.map_each(|row| row.map_each(DVec3::from));
        // Mirrored, the columns run the other way round: turned back on the given side, so that both face outwards.
        patches.push(given.map_each(|[a, b, c, d]| [d, c, b, a]));
        patches.push(given.map_each(|row| row.map_each(|p| DVec3::new(p.x, -p.y, p.z))));
    }
    patches
}

/// Appends (level + 1)^2 vertices and 2 level^2 triangles.
fn push_patch(mesh: &mut Mesh, patch: &Patch, level: u32) {
    let base = mesh.positions.len() as u32;
    // A turn about x: y up, outwards stays outwards.
    let y_up = |p: DVec3| DVec3::new(p.x, p.z, -p.y);
    for j in 0..=level {
        for i in 0..=level {
            let (u, v) = (f64::from(i) / f64::from(level), f64::from(j) / f64::from(level));
            mesh.positions.push(y_up(curve(&patch.map_each(|row| curve(&row, u)), v)));
            mesh.normals.push(y_up(normal(patch, u, v)).as_vec3());
            mesh.uvs.push(DVec2::new(u, v).as_vec2());
        }
    }
    mesh.triangles.extend(grid_triangles(level).iter().map(|t| t.map_each(|k| base + k)));
}

/// The cubic Bezier curve at t; exactly the point where all four are one, so that tips stay points.
fn curve(points: &[DVec3; 4], t: f64) -> DVec3 {
    if points.iter().all(|p| *p == points[0]) {
        return points[0];
    }
    let s = 1.0 - t;
    s * s * s * points[0] + 3.0 * s * s * t * points[1] + 3.0 * s * t * t * points[2] + t * t * t * points[3]
}

/// A third of the curve's derivative at t.
fn slope(points: &[DVec3; 4], t: f64) -> DVec3 {
    let s = 1.0 - t;
    s * s * (points[1] - points[0]) + 2.0 * s * t * (points[2] - points[1]) + t * t * (points[3] - points[2])
}

/// The outward unit normal dS/dv x dS/du. Where a row of control points is one point, dS/du vanishes like
/// (v - tip) d2S/dudv, which takes its place.
fn normal(patch: &Patch, u: f64, v: f64) -> DVec3 {
    let is_tip = |row: &[DVec3; 4]| row.iter().all(|p| *p == row[0]);
    let slopes_u = patch.map_each(|row| slope(&row, u));
    let along_v = slope(&patch.map_each(|row| curve(&row, u)), v);
    let along_u = match v {
        0.0 if is_tip(&patch[0]) => slope(&slopes_u, v),
        1.0 if is_tip(&patch[3]) => -slope(&slopes_u, v),
        _ => curve(&slopes_u, v),
    };
    along_v.cross(along_u).normalize()
}

#[cfg(test)]
mod tests {
    use crate::geometry::texture::Images;
    use std::collections::HashSet;

    use super::super::testing::{assert_sound, bounds, six_volumes};
    use super::*;
    use crate::geometry::obj;
    use crate::input::Loading;
    use crate::testing::model;

    fn bits(p: DVec3) -> [u64; 3] {
        // Adding 0 makes one of the two zeros.
        (p + DVec3::ZERO).to_array().map(f64::to_bits)
    }

    #[test]
    fn the_table_has_32_patches_over_290_points() {
        let patches = patches();
        assert_eq!(patches.len(), 32);
        let points: HashSet<_> = patches.iter().flatten().flatten().map(|p| bits(*p)).collect();
        // Circles of 12: 4 of the rim, 6 more of the body, 5 of the lid and 2 of the bottom, and 3 tips; 7 rows of 6
        // in handle and spout; the handle ends in a point of the body.
        assert_eq!(points.len(), 12 * (4 + 6 + 5 + 2) + 3 + 2 * 7 * 6 - 1);
    }

    #[test]
    fn counts_bounds_and_normals() {
        let mesh = teapot(10);
        assert_sound(&mesh);
        assert_eq!(mesh.triangles.len(), 6400);
        let corners = || mesh.triangles.iter().map(|t| t.map(|i| mesh.positions[i as usize]));
        let flat = corners().filter(|[a, b, c]| (*b - *a).cross(*c - *a) == DVec3::ZERO).count();
        assert_eq!(flat, 80);
        let (low, high) = bounds(&mesh);
        assert_eq!((low, high.y, high.z), (DVec3::new(-3.0, 0.0, -2.0), 3.15, 2.0));
        assert!((high.x - 3.434).abs() < 1e-3, "{high}");
        for (k, [a, b, c]) in corners().enumerate() {
            let face = (b - a).cross(c - a);
            for &i in &mesh.triangles[k] {
                assert!(face == DVec3::ZERO || face.dot(mesh.normals[i as usize].as_dvec3()) > 0.0, "triangle {k}");
            }
        }
        assert!(six_volumes(&mesh) > 0.0);
        let tip = |y: f64| mesh.positions.iter().position(|p| *p == DVec3::new(0.0, y, 0.0)).unwrap();
        assert_eq!(mesh.normals[tip(3.15)], glam::Vec3::Y);
        assert_eq!(mesh.normals[tip(0.0)], -glam::Vec3::Y);
    }

    #[test]
    fn borders_of_patches_meet_exactly() {
        let mesh = teapot(7);
        let mut half_edges = HashSet::new();
        for [a, b, c] in mesh.triangles.iter().map(|t| t.map(|i| bits(mesh.positions[i as usize]))) {
            half_edges.extend([(a, b), (b, c), (c, a)].into_iter().filter(|(from, to)| from != to));
        }
        let open = half_edges.iter().filter(|(from, to)| !half_edges.contains(&(*to, *from))).count();
        // The rim's inner edge and the lid's (28 each), and both ends of handle and spout (14 each).
        assert_eq!(open, 2 * 28 + 4 * 14);
    }

    #[test]
    fn every_vertex_of_a_published_teapot_is_one_of_ours() {
        let Some(path) = model("teapot.obj") else { return };
        let ours = teapot(10).positions;
        // The file has six digits or so.
        const ROUNDED: f64 = 1e-5;
        for p in obj::load(&path, &mut Images::left_out(), &Loading::default()).unwrap().positions {
            assert!(ours.iter().any(|q| q.distance(p) < ROUNDED), "{p}");
        }
    }
}
