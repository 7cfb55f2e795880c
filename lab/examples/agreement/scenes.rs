//! The scenes: meshes moved into the ball of radius 1 about the origin, at which cameras look, one scene file for every mesh and camera, for
//! `anamorph render` to open.

use super::views::{SIZE, View};
use anamorph::internals::image::write_text;
use anamorph::internals::input::{Error, Loading, Result};
use anamorph::internals::scene::Scene;
use std::path::{Path, PathBuf};
use toml::{Table, Value, toml};

/// Models by name, and their files in the folder of the models.
const MODELS: [(&str, &str); 7] = [
    ("cow", "cow.obj"),
    ("spot", "spot/cow.obj"),
    ("teapot", "teapot.obj"),
    ("suzanne", "suzanne.obj"),
    ("blub", "blub_triangulated.obj"),
    ("rocker-arm", "rocker-arm.obj"),
    ("bunny", "stanford-bunny.obj"),
];

/// Something to look at.
pub struct Subject {
    pub name: &'static str,
    /// The keys of its [[mesh]], but for those that place it.
    source: Table,
    /// The file that must be there.
    pub file: Option<PathBuf>,
}

/// The city, and every model of the folder.
pub fn subjects(models: Option<&Path>) -> Vec<Subject> {
    let city = toml! {
        builtin = "city"
        seed = 3
        triangles = 35000
    };
    let mut subjects = vec![Subject { name: "city", source: city, file: None }];
    for (folder, (name, file)) in models.into_iter().flat_map(|folder| MODELS.map(|model| (folder, model))) {
        // scene files lie elsewhere
        let path = std::path::absolute(folder.join(file)).unwrap_or_else(|_| folder.join(file));
        let source = Table::from_iter([("file".to_owned(), Value::from(path.to_string_lossy().as_ref()))]);
        subjects.push(Subject { name, source, file: Some(path) });
    }
    subjects
}

impl Subject {
    /// Its [[mesh]] table, placed so that its vertices lie in the ball: the middle of their box at the origin, the farthest
    /// of them at a distance of 1.
    pub fn placed(&self) -> Result<Table> {
        let folder = tempfile::tempdir().map_err(|e| Error::work(format!("no temporary folder: {e}")))?;
        let view = toml! {
            kind = "pinhole"
            eye = [0, 0, 4]
            target = [0, 0, 0]
            vfov = 30
        };
        let as_it_is = write(&folder.path().join("scene.toml"), SIZE, &self.source, &view)?;
        let scene = Scene::load(&as_it_is, &[], 0.0, &Loading::default())?;
        let (lo, hi) = scene.bounds().ok_or_else(|| Error::input(format!("{}: no vertices", self.name)))?;
        let middle = (lo + hi) / 2.0;
        let scale = 1.0 / scene.mesh.positions.iter().map(|p| p.distance(middle)).fold(0.0, f64::max);
        let mut placed = self.source.clone();
        placed.insert("scale".into(), scale.into());
        placed.insert("translate".into(), (-scale * middle).to_array().to_vec().into());
        Ok(placed)
    }
}

impl View {
    /// FOLDER/MESH-CAMERA.EXTENSION.
    pub fn path(&self, folder: &Path, subject: &str, extension: &str) -> PathBuf {
        folder.join(format!("{subject}-{}.{extension}", self.name))
    }

    /// Writes the scene of a mesh through this camera into the folder; returns its path.
    pub fn scene(&self, folder: &Path, subject: &str, mesh: &Table) -> Result<PathBuf> {
        write(&self.path(folder, subject, "toml"), self.size, mesh, &self.camera)
    }
}

fn write(path: &Path, [width, height]: [u32; 2], mesh: &Table, camera: &Table) -> Result<PathBuf> {
    let mut scene = Table::new();
    let image = toml! { background = [0.55, 0.68, 0.82] };
    let sides = [("width".to_owned(), Value::from(width)), ("height".to_owned(), Value::from(height))];
    scene.insert("image".into(), Value::Table(image.into_iter().chain(sides).collect()));
    scene.insert("mesh".into(), vec![mesh.clone()].into());
    scene.insert("camera".into(), camera.clone().into());
    let text = toml::to_string(&scene).map_err(|e| Error::work(format!("{}: {e}", path.display())))?;
    write_text(path, &text)?;
    Ok(path.to_owned())
}
