//! Cameras from typed values.

use super::{Camera, Scene, Table, Value};
use crate::input::Result;
use std::path::PathBuf;

/// The kind and the keys of a camera, to be built for a scene. `docs/reference/cameras.md` lists the keys of each kind with their units: lengths
/// are in world units, angles in degrees, errors in pixels. Keys are checked when the camera is built, as those of [`Camera::parse`].
///
/// ```
/// use anamorph::{Camera, Scene, Table};
///
/// # fn main() -> anamorph::Result<()> {
/// let scene = Scene::new();
/// let fisheye = Camera::builder("fisheye")
///     .key("eye", [0.0, 0.0, 3.0])
///     .key("target", [0.0, 0.0, 0.0])
///     .key("fov", 200.0)
///     .size(640, 480);
/// let [eye, _] = fisheye.clone().build(&scene)?.ray(320, 240).expect("the circle holds the middle");
/// assert_eq!(eye, [0.0, 0.0, 3.0]);
///
/// let misspelled = fisheye.key("fvo", 180.0).build(&scene).unwrap_err();
/// assert!(misspelled.to_string().starts_with("unknown key \"fvo\" in camera; nearest known key: \"fov\""));
///
/// // a key that holds a table
/// let mirror = Table::new().key("shape", "sphere").key("center", [0.0, 0.0, 0.0]).key("radius", 1.0);
/// let eye = Table::new().key("kind", "pinhole").key("eye", [0.0, 0.0, 4.0]).key("target", [0.0; 3]).key("vfov", 40.0);
/// let reflection = Camera::builder("reflection").key("mirror", mirror).key("eye", eye).size(64, 48).build(&scene)?;
/// assert_eq!(reflection.kind(), "reflection");
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone)]
#[must_use]
pub struct CameraBuilder {
    table: Table,
    /// Relative paths start from it.
    folder: PathBuf,
    /// Width and height, pixels.
    size: Option<(u32, u32)>,
}

impl CameraBuilder {
    pub(super) fn new(kind: &str) -> CameraBuilder {
        CameraBuilder { table: Table::new().key("kind", kind), folder: PathBuf::new(), size: None }
    }

    /// Sets a key, and replaces its value if it has one.
    pub fn key(self, name: impl Into<String>, value: impl Into<Value>) -> CameraBuilder {
        CameraBuilder { table: self.table.key(name, value), ..self }
    }

    /// Sets the folder that relative paths start from, as in `file` and `mask`; without it they start from the working directory.
    pub fn folder(self, folder: impl Into<PathBuf>) -> CameraBuilder {
        CameraBuilder { folder: folder.into(), ..self }
    }

    /// Sets the image's width and height, pixels; without it the image has the scene's size, or the size of the camera's file.
    pub fn size(self, width: u32, height: u32) -> CameraBuilder {
        CameraBuilder { size: Some((width, height)), ..self }
    }

    /// Builds the camera. It depends on the scene only where its kind says so, as `track`; its limits are the scene's.
    ///
    /// # Errors
    /// The errors of [`Camera::parse`], each one line with the name of the key; for an unknown key also the nearest known one.
    pub fn build(self, scene: &Scene) -> Result<Camera> {
        Camera::of_table(Value::from(self.table).node(), &self.folder, scene, self.size)
    }
}
