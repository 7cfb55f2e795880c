//! `raymap`: a ray for each pixel, from files or arrays.

use crate::camera::recipe::{Built, Recipe, Setting};
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

/// The rays of a program's arrays.
#[derive(Debug, Clone)]
pub struct RayArrays {
    pub field: Arc<Field>,
}

/// The same arrays, not equal ones.
impl PartialEq for RayArrays {
    fn eq(&self, other: &RayArrays) -> bool {
        Arc::ptr_eq(&self.field, &other.field)
    }
}

impl Recipe for Raymap {
    /// The image's size is that of the files, which the scene may only repeat.
    fn build(&self, setting: &Setting) -> Result<Built> {
        built(Field::load(&self.origins, &self.directions, setting.loading())?, setting)
    }
}

impl Recipe for RayArrays {
    fn build(&self, setting: &Setting) -> Result<Built> {
        built(Field::clone(&self.field), setting)
    }
}

fn built(field: Field, setting: &Setting) -> Result<Built> {
    let size = (field.width, field.height);
    if setting.size.is_some_and(|s| s != size) {
        let (w, h) = size;
        return Err(Error::input(format!("image: the ray map is {w}x{h}; leave the size out or make it that")));
    }
    Ok(Built::new(size, Rays::Field(field)))
}
