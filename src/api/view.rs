//! A page in the browser that shows a scene.

use super::Scene;
use crate::input::{Error, Limits, Result};
use crate::view::{Document, Options, Server};
use std::path::Path;

/// Serves a page on this machine that shows a scene, to look at and to change: `docs/guide/view.md`. Dropped, it ends.
pub struct Viewer {
    server: Server,
}

impl Viewer {
    /// Shows a scene file, changed as by [`Scene::load`]. `port` is a port of 127.0.0.1; 0: any that is free.
    ///
    /// # Errors
    /// Those of [`Scene::load`]; [`Error::Work`] if the adapter or the port cannot be used.
    pub fn of_file(path: impl AsRef<Path>, overrides: &[&str], frame: f64, port: u16) -> Result<Viewer> {
        Viewer::of_file_within(path, overrides, frame, port, Limits::default())
    }

    /// [`Viewer::of_file`] within other limits, whatever the scene is changed to.
    ///
    /// # Errors
    /// As [`Viewer::of_file`].
    pub fn of_file_within(
        path: impl AsRef<Path>,
        overrides: &[&str],
        frame: f64,
        port: u16,
        limits: Limits,
    ) -> Result<Viewer> {
        let mut document = Document::open(path.as_ref(), limits)?;
        let overrides: Vec<String> = overrides.iter().map(|text| (*text).to_owned()).collect();
        document.change(None, &overrides, frame)?;
        let server = Server::start(document, None, Options { port, frame, ..Options::default() })?;
        Ok(Viewer { server })
    }

    /// Shows a scene in memory, as it is now. `camera` is a `[camera]` table; without it, the scene's own camera is used. The table is TOML, or
    /// JSON if it begins with a brace. Its relative paths start from `folder`. `size` is the image's size in pixels; without it, the scene's own. The
    /// limits are the scene's.
    ///
    /// # Errors
    /// [`Error::Input`] for a wrong table, or if the scene has no camera; [`Error::Work`] if the adapter or the port cannot be used.
    pub fn of_scene(
        scene: &Scene,
        camera: Option<&str>,
        folder: impl AsRef<Path>,
        size: Option<(u32, u32)>,
        port: u16,
    ) -> Result<Viewer> {
        let keys = &scene.scene.camera_keys;
        let own = keys.json(false, keys.folder()).get("keys").map(ToString::to_string);
        let (camera, folder) = match (camera, own) {
            (Some(camera), _) => (camera.to_owned(), folder.as_ref()),
            (None, Some(own)) => (own, keys.folder()),
            (None, None) => return Err(Error::input("the scene has no camera; give one")),
        };
        let document = Document::of_camera(&camera, size.or(scene.scene.size), folder, scene.scene.limits)?;
        let options = Options { port, ..Options::default() };
        Ok(Viewer { server: Server::start(document, Some(scene.scene.clone()), options)? })
    }

    /// Where the page is. The address has a token; without it nothing is served.
    pub fn address(&self) -> &str {
        self.server.address()
    }
}
