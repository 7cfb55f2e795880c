//! `raymap`: a ray for each pixel, from files.

use crate::camera::recipe::{Built, Recipe, Setting};
use crate::camera::spec::CameraKind;
use crate::camera::{Field, Rays};
use crate::input::reader::Table;
use crate::input::{Error, Result};
use std::path::PathBuf;
use std::sync::Arc;

/// Two H x W x 3 arrays of floats, each a .npy or an EXR file.
#[derive(Debug, Clone, PartialEq)]
pub struct Raymap {
    pub origins: PathBuf,
    pub directions: PathBuf,
}

/// Reads the camera's table.
pub fn read(table: &Table) -> Result<Arc<dyn Recipe>> {
    table.allow(&["kind", "t_range", "origins", "directions"])?;
    let origins = table.need("origins", "\"origins.npy\"")?.path()?;
    let directions = table.need("directions", "\"directions.npy\"")?.path()?;
    Ok(Arc::new(Raymap { origins, directions }))
}

impl From<Raymap> for CameraKind {
    fn from(recipe: Raymap) -> CameraKind {
        CameraKind::new("raymap", recipe)
    }
}

impl Recipe for Raymap {
    /// The image's size is that of the files, which the scene may only repeat.
    fn build(&self, setting: &Setting) -> Result<Built> {
        let field = Field::load(&self.origins, &self.directions)?;
        let size = (field.width, field.height);
        if setting.size.is_some_and(|s| s != size) {
            let (w, h) = size;
            return Err(Error::input(format!("image: the ray map is {w}x{h}; leave the size out or make it that")));
        }
        Ok(Built::new(size, Rays::Field(field)))
    }
}
