//! Families of scenes that grow stiff, from mild to absurd: what numerics make hard, one thing a family, by one number.

mod cameras;
mod meshes;
mod rest;

use super::case::Source;
use glam::DVec3;

/// Scenes that one number makes stiffer.
pub struct Family {
    pub name: &'static str,
    /// What the number is.
    pub parameter: &'static str,
    /// From mild to absurd.
    pub values: &'static [f64],
    pub scene: fn(f64) -> Source,
    /// As `--engine` names them.
    pub rivals: &'static [&'static str],
}

/// Of one GLC.
const BY_PIECES: &[&str] = &["raytrace", "raster-warp:0", "raster-bound"];
/// Of a ray per pixel.
const BY_RAYS: &[&str] = &["raytrace"];
/// Of a curve per pixel.
const BY_CURVES: &[&str] = &["raymarch-segments:16"];

/// All families.
pub fn families() -> Vec<Family> {
    [cameras::families(), meshes::families(), rest::families()].into_iter().flatten().collect()
}

type Triangle = [DVec3; 3];

/// A scene file with a camera and one mesh.
fn scene(camera: &str, triangles: &[Triangle]) -> Source {
    let head = "image = { width = 96, height = 96 }\n[[mesh]]\nfile = \"mesh.obj\"\n[camera]\n";
    Source::Files(vec![("scene.toml", format!("{head}{camera}\n")), ("mesh.obj", obj(triangles))])
}

/// Three vertices of its own for every triangle, to the last bit.
fn obj(triangles: &[Triangle]) -> String {
    let corners: String = triangles.iter().flatten().map(|v| format!("v {:?} {:?} {:?}\n", v.x, v.y, v.z)).collect();
    let faces: String =
        (0..triangles.len()).map(|k| format!("f {} {} {}\n", 3 * k + 1, 3 * k + 2, 3 * k + 3)).collect();
    corners + &faces
}

/// Numbers that depend on a seed alone (SplitMix64).
struct Rng(u64);

impl Rng {
    /// In [-1, 1).
    fn signed(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    fn vector(&mut self) -> DVec3 {
        DVec3::new(self.signed(), self.signed(), self.signed())
    }
}

/// Triangles of up to `size` with their middles in a box.
fn cloud(seed: u64, count: usize, middle: DVec3, half: DVec3, size: f64) -> Vec<Triangle> {
    let mut rng = Rng(seed);
    (0..count)
        .map(|_| {
            let at = middle + half * rng.vector();
            [0, 1, 2].map(|_| at + size * rng.vector())
        })
        .collect()
}

/// A GLC between two planes across z: at z = 2 the image is the square from -1 to 1, at z = -2 the given map of it.
fn glc(map: impl Fn(f64, f64) -> [f64; 2]) -> String {
    let corners = [(-1.0, 1.0), (1.0, 1.0), (-1.0, -1.0)];
    let near = corners.map(|(x, y)| [x, y, 2.0]);
    let far = corners.map(|(x, y)| {
        let [x, y] = map(x, y);
        [x, y, -2.0]
    });
    format!("kind = \"glc\"\nnear = {near:?}\nfar = {far:?}")
}

/// A picture of the square from -1 to 1 seen along -z from z = 2.
const ALONG_Z: &str = "kind = \"orthographic\"\neye = [0, 0, 2]\ntarget = [0, 0, 0]\nheight = 2";
