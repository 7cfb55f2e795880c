//! Triangles at random, for tests and the worst cases of timings.

use glam::DVec3;

use super::materials;
use super::random::Random;
use crate::geometry::mesh::Mesh;
use crate::parallel;

const COLOURS: [(&str, [f32; 3]); 4] =
    [("red", [0.75, 0.25, 0.2]), ("yellow", [0.8, 0.65, 0.25]), ("green", [0.3, 0.6, 0.3]), ("blue", [0.25, 0.4, 0.7])];

/// Exactly `triangles` triangles in [-1, 1]^3, without normals, in four colours. Each triangle's corners are
/// uniform in a cube of half edge triangles^(-1/3) / 2 about a uniform centre, so that the triangles' density
/// does not depend on their number. Triangle k has vertices 3k, 3k + 1, 3k + 2. `triangles` is 1 to 2^28.
pub fn soup(seed: u64, triangles: u64) -> Mesh {
    let half_edge = 0.5 / (triangles as f64).cbrt();
    let corners_and_colour = |k: u64| {
        let mut random = Random::new(seed, k);
        let mut point = |half: f64| DVec3::from_array(std::array::from_fn(|_| random.between(-half, half)));
        let centre = point(1.0 - half_edge);
        let corners: [DVec3; 3] = std::array::from_fn(|_| centre + point(half_edge));
        (corners, random.below(COLOURS.len() as u64) as u32)
    };
    let (corners, material_of): (Vec<[DVec3; 3]>, Vec<u32>) =
        parallel::map(0..triangles, corners_and_colour).into_iter().unzip();
    Mesh {
        positions: corners.into_flattened(),
        triangles: (0..triangles as u32).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect(),
        materials: materials(&COLOURS),
        material_of,
        ..Mesh::default()
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{assert_sound, bounds};
    use super::*;

    #[test]
    fn triangles_stay_in_the_cube_and_shrink() {
        for count in [1, 8, 1000] {
            let mesh = soup(3, count);
            assert_sound(&mesh);
            assert_eq!(mesh.triangles.len() as u64, count);
            let (low, high) = bounds(&mesh);
            assert!(low.min_element() >= -1.0 && high.max_element() <= 1.0);
            let longest = (mesh.positions.chunks(3))
                .map(|p| (p[1] - p[0]).abs().max_element().max((p[2] - p[0]).abs().max_element()))
                .fold(0.0, f64::max);
            // Twice the half edge, and a rounding of coordinates up to 1.
            assert!(longest <= 1.0 / (count as f64).cbrt() + 4.0 * f64::EPSILON);
        }
        assert_ne!(soup(1, 10), soup(2, 10));
    }
}
