//! Hills: fractal noise over a square.

use crate::arrays::MapEach;
use glam::{DVec3, Vec3};

use super::materials;
use super::plane::{grid_triangles, grid_uvs};
use super::random::Random;
use crate::geometry::mesh::Mesh;
use crate::parallel;

/// Edge of the square, in scene units.
const EXTENT: f64 = 100.0;
/// Heights lie in [0, 2 RELIEF].
const RELIEF: f64 = 15.0;
/// Noise cells along the square's edge in the first octave.
const FIRST_CELLS: u32 = 3;
/// Octaves of half the size and half the height each; the same for all sizes, so that a seed is one landscape.
const OCTAVES: u32 = 10;

const MATERIALS: [(&str, [f32; 3]); 3] =
    [("grass", [0.25, 0.42, 0.16]), ("rock", [0.42, 0.38, 0.34]), ("snow", [0.9, 0.92, 0.95])];
/// Triangles whose normal is less upright than this (its y) are rock.
const STEEPEST_GRASS: f64 = 0.8;
/// Triangles above this height that are not steep are snow.
const SNOW_LINE: f64 = 1.25 * RELIEF;

/// A landscape over [-50, 50]^2 in x and z with heights in [0, 30]: `size` x `size` cells of two triangles, row by
/// row along +z, 2 size^2 triangles in all, with smooth normals and texture coordinates from 0 to 1 along +x and -z; grass, rock and snow.
/// `size` is 1 to 11585; the seed alone makes the shape, the size how finely it is sampled.
pub fn terrain(seed: u64, size: u32) -> Mesh {
    let side = size + 1;
    let noise = Noise { seed };
    let place = |k: i64| k as f64 / f64::from(size);
    let height = |column: i64, row: i64| noise.height(place(column), place(row));
    let vertex = |k: u64| {
        let (column, row) = ((k % u64::from(side)) as i64, (k / u64::from(side)) as i64);
        DVec3::new(EXTENT * (place(column) - 0.5), height(column, row), EXTENT * (place(row) - 0.5))
    };
    let vertices = u64::from(side) * u64::from(side);
    let positions: Vec<DVec3> = parallel::map(0..vertices, vertex);
    let normals = parallel::map(0..vertices, |k| normal(&positions, side as usize, k as usize));
    let triangles = grid_triangles(size);
    Mesh {
        corner_normals: triangles.clone(),
        uvs: grid_uvs(size),
        corner_uvs: triangles.clone(),
        material_of: parallel::map(&triangles, |t| material(t.map_each(|i| positions[i as usize]))),
        materials: materials(&MATERIALS),
        positions,
        triangles,
        normals,
        ..Mesh::default()
    }
}

/// The normal from the differences to the neighbours; one-sided at the border.
fn normal(positions: &[DVec3], side: usize, k: usize) -> Vec3 {
    let (column, row) = (k % side, k / side);
    let last = side - 1;
    let along_x = positions[k + usize::from(column < last)] - positions[k - usize::from(column > 0)];
    let along_z = positions[if row < last { k + side } else { k }] - positions[if row > 0 { k - side } else { k }];
    along_z.cross(along_x).normalize().as_vec3()
}

fn material([a, b, c]: [DVec3; 3]) -> u32 {
    let upright = (b - a).cross(c - a).normalize().y;
    match () {
        () if upright < STEEPEST_GRASS => 1,
        () if (a.y + b.y + c.y) / 3.0 > SNOW_LINE => 2,
        () => 0,
    }
}

/// Value noise: random values on a lattice, joined smoothly, at several scales.
struct Noise {
    seed: u64,
}

impl Noise {
    /// The height at (x, z) in [0, 1]^2: the octaves' weights sum to less than 1.
    fn height(&self, x: f64, z: f64) -> f64 {
        let (mut sum, mut weight, mut cells) = (0.0, 0.5, f64::from(FIRST_CELLS));
        for octave in 0..OCTAVES {
            sum += weight * self.octave(octave, x * cells, z * cells);
            weight *= 0.5;
            cells *= 2.0;
        }
        RELIEF * (1.0 + sum)
    }

    /// One octave, in [-1, 1].
    fn octave(&self, octave: u32, x: f64, z: f64) -> f64 {
        let (column, row) = (x.floor(), z.floor());
        let (u, v) = (smooth(x - column), smooth(z - row));
        let (column, row) = (column as u64, row as u64);
        let low = mix(self.value(octave, column, row), self.value(octave, column + 1, row), u);
        let high = mix(self.value(octave, column, row + 1), self.value(octave, column + 1, row + 1), u);
        mix(low, high, v)
    }

    /// The lattice's value in [-1, 1). Columns and rows stay under 2^24.
    fn value(&self, octave: u32, column: u64, row: u64) -> f64 {
        Random::new(self.seed, u64::from(octave) << 48 | column << 24 | row).between(-1.0, 1.0)
    }
}

fn mix(a: f64, b: f64, t: f64) -> f64 {
    a * (1.0 - t) + b * t
}

/// Rises from 0 to 1 with first and second derivatives 0 at both ends: 6t^5 - 15t^4 + 10t^3.
fn smooth(t: f64) -> f64 {
    t * t * t * (t * (t * 6.0 - 15.0) + 10.0)
}

#[cfg(test)]
mod tests {
    use super::super::testing::{assert_sound, bounds};
    use super::*;

    #[test]
    fn landscapes_keep_their_bounds_and_face_up() {
        for size in [1, 2, 33] {
            let mesh = terrain(7, size);
            assert_sound(&mesh);
            assert_eq!(mesh.triangles.len(), 2 * (size as usize).pow(2));
            let (low, high) = bounds(&mesh);
            assert_eq!([low.x, low.z, high.x, high.z], [-50.0, -50.0, 50.0, 50.0]);
            assert!(low.y >= 0.0 && high.y <= 2.0 * RELIEF);
            assert!(mesh.normals.iter().all(|n| n.y > 0.0));
            for [a, b, c] in mesh.triangles.iter().map(|t| t.map(|i| mesh.positions[i as usize])) {
                assert!((b - a).cross(c - a).y > 0.0);
            }
        }
    }

    #[test]
    fn a_seed_is_one_landscape_at_every_size() {
        let (coarse, fine) = (terrain(7, 8), terrain(7, 16));
        assert_eq!(coarse.positions[9 * 3 + 5], fine.positions[17 * 6 + 10]);
        assert_ne!(coarse, terrain(8, 8));
        let (low, high) = bounds(&fine);
        assert!(high.y - low.y > 0.3 * RELIEF, "too flat");
    }
}
