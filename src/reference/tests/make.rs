//! Random meshes and bundles, all from one seed.

use crate::camera::bundle::Bundle;
use crate::geometry::mesh::{Material, Mesh};
use crate::testing::Rng;
use glam::DVec3;

/// A mesh of its own two-sided material over these triangles.
pub fn mesh(positions: Vec<DVec3>, triangles: Vec<[u32; 3]>) -> Mesh {
    let material_of = vec![0; triangles.len()];
    Mesh { positions, triangles, materials: vec![Material::default()], material_of, ..Mesh::default() }
}

/// `n` triangles of about `size` in the unit cube about `centre`; some share corners, some are twins or
/// without area, a third shows one face only.
pub fn soup(rng: &mut Rng, n: usize, size: f64, centre: DVec3) -> Mesh {
    let mut positions = Vec::new();
    let mut triangles: Vec<[u32; 3]> = Vec::new();
    for _ in 0..n {
        let old = |rng: &mut Rng| triangles[rng.below(triangles.len())];
        let t = match rng.below(16) {
            0 if !triangles.is_empty() => {
                let [a, b, c] = old(rng);
                [[b, a, c], [b, c, a], [a, b, c]][rng.below(3)]
            }
            1 if !triangles.is_empty() => {
                let [a, b, _] = old(rng);
                positions.push(centre + rng.vector());
                [b, a, positions.len() as u32 - 1]
            }
            2 => {
                positions.extend([centre + rng.vector(), centre + rng.vector()]);
                let k = positions.len() as u32;
                [k - 1, k - 2, k - 1]
            }
            _ => {
                let at = centre + rng.vector();
                positions.extend([at, at + size * rng.vector(), at + size * rng.vector()]);
                let k = positions.len() as u32;
                [k - 3, k - 2, k - 1]
            }
        };
        triangles.push(t);
    }
    let mut mesh = mesh(positions, triangles);
    mesh.materials.push(Material { two_sided: false, ..Material::default() });
    mesh.material_of = (0..n).map(|_| u32::from(rng.below(3) == 0)).collect();
    mesh
}

/// A random bundle that looks at the cube of half-size 1 about `centre`, about 1/64 of it a pixel: pinhole,
/// orthographic, cross-slit or any affine one; a third of them projective.
pub fn bundle(rng: &mut Rng, centre: DVec3) -> Bundle {
    let forward = rng.direction();
    let right = forward.cross(rng.direction()).normalize_or(forward.any_orthonormal_vector());
    let down = forward.cross(right);
    let px = 1.0 / 64.0;
    let (x, y) = (rng.signed() * 40.0, rng.signed() * 40.0);
    let eye = centre - 3.0 * forward;
    let steps = |sx: f64, sy: f64| [DVec3::ZERO, right * (px * sx), down * (px * sy)];
    let (p, d) = match rng.below(4) {
        0 => (steps(0.0, 0.0), steps(1.0 / 3.0, 1.0 / 3.0)),
        1 => (steps(1.0, 1.0), steps(0.0, 0.0)),
        2 => (steps(1.0, 0.0), steps(0.2, 0.5)),
        _ => {
            let mut any = || [DVec3::ZERO, rng.vector() * px, rng.vector() * px];
            (any(), any())
        }
    };
    let h = if rng.below(3) == 0 { [1.0, 0.004 * rng.signed(), 0.004 * rng.signed()] } else { [1.0, 0.0, 0.0] };
    let flat = Bundle {
        p: [eye, p[1] + eye * h[1], p[2] + eye * h[2]],
        d: [forward, d[1] + forward * h[1], d[2] + forward * h[2]],
        h,
    };
    flat.recentred(x, y)
}

/// A unit icosahedron, each face divided in four `level` times, corners on the unit sphere about `centre`.
pub fn icosphere(level: u32, centre: DVec3) -> Mesh {
    let g = 0.5 * (1.0 + 5.0_f64.sqrt());
    let corner = |k: usize| {
        let (s, q) = (if k & 1 == 0 { 1.0 } else { -1.0 }, if k & 2 == 0 { g } else { -g });
        match k / 4 {
            0 => DVec3::new(s, q, 0.0),
            1 => DVec3::new(0.0, s, q),
            _ => DVec3::new(q, 0.0, s),
        }
    };
    let base: Vec<DVec3> = (0..12).map(|k| corner(k).normalize()).collect();
    let near = |a: usize, b: usize| (base[a] - base[b]).length() < 1.1;
    let mut faces: Vec<[DVec3; 3]> = Vec::new();
    for a in 0..12 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                if near(a, b) && near(b, c) && near(a, c) {
                    let outward = (base[b] - base[a]).cross(base[c] - base[a]).dot(base[a]) > 0.0;
                    faces.push(if outward { [base[a], base[b], base[c]] } else { [base[a], base[c], base[b]] });
                }
            }
        }
    }
    for _ in 0..level {
        faces = faces
            .into_iter()
            .flat_map(|[a, b, c]| {
                let (d, e, f) = ((a + b).normalize(), (b + c).normalize(), (c + a).normalize());
                [[a, d, f], [d, b, e], [f, e, c], [d, e, f]]
            })
            .collect();
    }
    // Every face has corners of its own: edges are shared by position alone.
    let positions: Vec<DVec3> = faces.iter().flatten().map(|&v| centre + v).collect();
    let triangles = (0..faces.len() as u32).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
    mesh(positions, triangles)
}
