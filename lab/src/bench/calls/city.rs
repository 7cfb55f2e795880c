//! The cities that cases of whole calls show, and their changes before each call.

use super::path::{CALIBRATION, CALIBRATION_FILE};
use crate::bench::row::Moving;
use anamorph::internals::image::write_text;
use anamorph::internals::input::Loading;
use anamorph::internals::scene::Scene as Loaded;
use anamorph::{Mesh, Result, Scene};
use std::fmt::Write;
use std::path::Path;

/// Changes of the scene before each call; the camera is at another pose in any case.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Motion {
    Still,
    /// Each of 100 blocks of the city gets a matrix.
    Objects,
    /// Every vertex of the city gets a place.
    Vertices,
}

impl Motion {
    pub fn moving(self) -> Moving {
        match self {
            Motion::Still => Moving::Camera,
            Motion::Objects => Moving::Objects,
            Motion::Vertices => Moving::Triangles,
        }
    }
}

/// Blocks a side of a city whose blocks are objects.
const SIDE: u32 = 10;
/// From a block to the next, world units.
const PITCH: f64 = 6.25;

/// Name of the city whose vertices move.
const CITY: &str = "city";

/// The `[[mesh]]` tables of a city of so many triangles.
pub fn meshes(motion: Motion, triangles: u32) -> String {
    if motion != Motion::Objects {
        let blocks = (f64::from(triangles) / 160.0).sqrt().floor().clamp(1.0, 12.0);
        return format!(
            "[[mesh]]\nname = \"{CITY}\"\nbuiltin = \"city\"\nblocks = {blocks}\ntriangles = {triangles}\n"
        );
    }
    let mut text = String::new();
    for k in 0..SIDE * SIDE {
        let [x, z] = place(k);
        let count = triangles / (SIDE * SIDE);
        // writing to a String cannot fail
        let _ = write!(
            text,
            "[[mesh]]\nname = \"{}\"\nbuiltin = \"city\"\nblocks = 1\nseed = {k}\ntriangles = {count}\ntranslate = [{x}, 0, {z}]\n",
            block(k)
        );
    }
    text
}

fn block(k: u32) -> String {
    format!("block {k}")
}

/// The x and z of the middle of a block.
fn place(k: u32) -> [f64; 2] {
    [k % SIDE, k / SIDE].map(|at| PITCH * (f64::from(at) - f64::from(SIDE - 1) / 2.0))
}

/// A city in memory, as a program has it that moves it from call to call.
pub struct City {
    pub scene: Scene,
    /// The vertices as they first stand, where they move.
    vertices: Vec<[f64; 3]>,
}

/// A change that is worked out before the time begins.
pub enum Change {
    Nothing,
    /// An object each, by name.
    Matrices(Vec<(String, [[f64; 4]; 3])>),
    Vertices(Vec<[f64; 3]>),
}

impl City {
    /// The city of a scene file. Writes the calibration beside it too.
    ///
    /// # Errors
    /// [`anamorph::Error`] if the folder cannot be written or the city has too few triangles.
    pub fn new(motion: Motion, text: &str, folder: &Path) -> Result<City> {
        write_text(&folder.join(CALIBRATION_FILE), CALIBRATION)?;
        if motion != Motion::Vertices {
            return Ok(City { scene: Scene::parse(text, folder)?, vertices: Vec::new() });
        }
        let mesh = load(text, folder)?.mesh;
        let vertices: Vec<[f64; 3]> = mesh.positions.iter().map(|p| p.to_array()).collect();
        let mut scene = Scene::new();
        scene.add(Mesh::new(vertices.clone(), mesh.triangles.clone())?.named(CITY))?;
        Ok(City { scene, vertices })
    }

    /// The change before call `k`.
    pub fn change(&self, motion: Motion, k: u32) -> Change {
        let phase = 0.1 * f64::from(k);
        match motion {
            Motion::Still => Change::Nothing,
            Motion::Objects => Change::Matrices((0..SIDE * SIDE).map(|at| (block(at), matrix(at, phase))).collect()),
            Motion::Vertices => Change::Vertices(
                self.vertices.iter().map(|&[x, y, z]| [x, y + 0.3 * (0.5 * x + phase).sin(), z]).collect(),
            ),
        }
    }

    pub fn apply(&mut self, change: &Change) -> Result<()> {
        match change {
            Change::Nothing => Ok(()),
            Change::Matrices(all) => all.iter().try_for_each(|(name, matrix)| self.scene.move_object(name, *matrix)),
            Change::Vertices(vertices) => self.scene.set_vertices(CITY, vertices),
        }
    }
}

/// A block turned about its own axis, and lifted.
fn matrix(at: u32, phase: f64) -> [[f64; 4]; 3] {
    let [x, z] = place(at);
    let angle = phase + f64::from(at);
    let (sin, cos) = (0.2 * angle.sin()).sin_cos();
    let lift = 0.5 * (1.0 + angle.cos());
    [[cos, 0.0, sin, x - cos * x - sin * z], [0.0, 1.0, 0.0, lift], [-sin, 0.0, cos, z + sin * x - cos * z]]
}

/// The scene of a text, as the inside of the product has it.
pub fn load(text: &str, folder: &Path) -> Result<Loaded> {
    let path = folder.join("scene.toml");
    write_text(&path, text)?;
    Loaded::load(&path, &[], 0.0, &Loading::default())
}
