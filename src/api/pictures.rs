//! Pictures that are thrown onto the surfaces of a scene.

use super::Scene;
use crate::geometry::texture::{Images, ImagesRead, Texels, Texture};
use crate::input::{Error, Loading, Result};
use crate::scene::file;
use crate::scene::library::Library;
use crate::scene::projector_light::ProjectorLight;
use std::path::Path;
use std::sync::Arc;

impl Scene {
    /// Throws a camera's picture onto the scene's surfaces: the keys of a scene file's `[[projector_light]]` as a table in TOML, or in JSON
    /// where it begins with a brace. Relative paths in it start from `folder`. A camera that looks at the scene sees what was added before.
    ///
    /// # Errors
    /// [`Error::Input`] for a wrong key or value or a camera whose rays are not straight, [`Error::Missing`] or [`Error::Read`] for a file
    /// that cannot be read; the scene is then unchanged.
    pub fn add_projector_light(&mut self, table: &str, folder: impl AsRef<Path>) -> Result<()> {
        let loading = Loading::new(self.scene.limits);
        let spec = file::projector_light_of(table, folder.as_ref(), &loading)?;
        let mut images = Images::of(ImagesRead::All);
        let light = Library::for_once().projector_light(&spec, &self.scene.mesh, &mut images, &loading);
        let light = light.map_err(|e| e.at("projector_light"))?;
        self.scene.projector_lights.push(Arc::new(light));
        Ok(())
    }

    /// Gives the projector light of this number, from 0 in the order in which they were added, another picture, such as the next frame of a
    /// video: 8-bit sRGB colours, three (RGB) or four (RGBA) bytes a pixel, row by row from the top. One of another size is stretched over
    /// the camera's image. Frames that follow keep all but the picture.
    ///
    /// # Errors
    /// [`Error::Input`] if there is no such light, or the bytes do not fit the size; the scene is then unchanged.
    pub fn set_picture(&mut self, light: usize, width: usize, height: usize, srgb8: &[u8]) -> Result<()> {
        let count = self.scene.projector_lights.len();
        let Some(shown) = self.scene.projector_lights.get_mut(light) else {
            return Err(Error::input(format!("there is no projector light {light}; the scene has {count}, from 0")));
        };
        let picture = Texture::new(Arc::new(Texels::of_srgb8(width, height, srgb8)?));
        *shown = Arc::new(ProjectorLight::new(shown.camera.clone(), picture, shown.throw)?);
        Ok(())
    }

    /// How many pictures are thrown onto its surfaces.
    pub fn projector_light_count(&self) -> usize {
        self.scene.projector_lights.len()
    }
}
