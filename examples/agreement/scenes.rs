//! The scenes: meshes moved into the ball of radius 1 about the origin, and the cameras that look at it, one scene file
//! for every two of them, for `anamorph render` to open.

use anamorph::internals::camera::kinds::KINDS;
use anamorph::internals::image::{write_npy_f64, write_text};
use anamorph::internals::input::{Error, Result};
use anamorph::internals::scene::Scene;
use glam::DVec3;
use std::f64::consts::TAU;
use std::path::{Path, PathBuf};
use toml::{Table, Value, toml};

/// Width and height of the pictures, pixels, but for scans.
const SIZE: [u32; 2] = [800, 600];

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

/// A camera by name, and its keys.
pub struct View {
    pub name: String,
    size: [u32; 2],
    camera: Table,
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

/// Every camera of `cameras.toml`.
///
/// # Errors
/// [`Error::Work`] where a kind of the program has none.
pub fn views() -> Result<Vec<View>> {
    let broken = |why: &dyn std::fmt::Display| Error::work(format!("cameras.toml: {why}"));
    let mut all: Table = include_str!("cameras.toml").parse().map_err(|e| broken(&e))?;
    let Some(Value::Array(tables)) = all.remove("camera") else { return Err(broken(&"no [[camera]]")) };
    let mut views = Vec::new();
    for table in tables {
        let Value::Table(mut camera) = table else { return Err(broken(&"a camera is no table")) };
        let Some(Value::String(name)) = camera.remove("name") else { return Err(broken(&"a camera has no name")) };
        let size = camera.remove("image").map_or(Ok(SIZE), Value::try_into).map_err(|e| broken(&e))?;
        views.push(View { name, size, camera });
    }
    let seen = |kind: &str| views.iter().any(|v| v.camera.get("kind").and_then(Value::as_str) == Some(kind));
    match KINDS.iter().map(|k| k.name).find(|kind| !seen(kind)) {
        Some(kind) => Err(broken(&format_args!("no camera of kind {kind}"))),
        None => Ok(views),
    }
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
        let scene = Scene::load(&as_it_is, &[], 0.0)?;
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

/// Writes the files that cameras read into the scenes' folder.
pub fn write_camera_files(folder: &Path) -> Result<()> {
    write_text(&folder.join("lens.yml"), include_str!("lens.yml"))?;
    write_text(&folder.join("fisheye.yml"), include_str!("fisheye.yml"))?;
    write_text(&folder.join("screen.obj"), include_str!("screen.obj"))?;
    let [w, h] = SIZE;
    let pixels = || (0..h).flat_map(move |j| (0..w).map(move |i| (i, j)));
    let rays: Vec<[DVec3; 2]> = pixels().map(|(i, j)| rippled((i, j))).collect();
    for (k, name) in ["ray-origins.npy", "ray-directions.npy"].into_iter().enumerate() {
        let numbers: Vec<f64> = rays.iter().flat_map(|r| r[k].to_array()).collect();
        write_npy_f64(&folder.join(name), &[h.into(), w.into(), 3], &numbers)?;
    }
    let shots: Vec<f64> = pixels().flat_map(|(i, j)| rosette(j * w + i)).flat_map(|v| v.to_array()).collect();
    write_npy_f64(&folder.join("rosette.npy"), &[u64::from(w) * u64::from(h), 6], &shots)
}

/// Where the viewer of `raymap` and of the rosette stands, and the directions ahead, to the right and up.
fn pose() -> (DVec3, [DVec3; 3]) {
    let eye = DVec3::new(1.5, 2.0, 3.0);
    let forward = -eye.normalize();
    let right = forward.cross(DVec3::Y).normalize();
    (eye, [forward, right, right.cross(forward)])
}

/// A pixel's ray through rippled glass: it starts off the eye, and is bent.
fn rippled((i, j): (u32, u32)) -> [DVec3; 2] {
    let (eye, [forward, right, up]) = pose();
    let [w, h] = SIZE.map(f64::from);
    let (x, y) = ((2.0 * (f64::from(i) + 0.5) - w) / h, 1.0 - 2.0 * (f64::from(j) + 0.5) / h);
    let ripple = 0.02 * DVec3::new((5.0 * y).sin(), (4.0 * x).cos(), (3.0 * (x + y)).sin());
    let direction = forward + 0.25 * (x * right + y * up) + 0.5 * ripple;
    [eye + ripple, direction]
}

/// Shot k of a scanner of two mirrors that turn against each other, one a little faster: petals about the view's middle, one
/// beside the other.
fn rosette(k: u32) -> [DVec3; 2] {
    /// Turns of the first mirror during the scan: one in a row of the image.
    const TURNS: f64 = SIZE[1] as f64;
    /// Turns of the second one meanwhile.
    const RATIO: f64 = -(TURNS + 1.0) / TURNS;
    /// Tangent of the half angle that is scanned.
    const REACH: f64 = 0.25;
    let (eye, [forward, right, up]) = pose();
    let angle = TAU * TURNS * f64::from(k) / f64::from(SIZE[0] * SIZE[1]);
    let x = angle.cos() + (RATIO * angle).cos();
    let y = angle.sin() + (RATIO * angle).sin();
    [eye, (forward + 0.5 * REACH * (x * right + y * up)).normalize()]
}
