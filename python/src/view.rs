//! A page in the browser.

use crate::calls::{Opener, run};
use crate::scene::Scene;
use pyo3::prelude::*;
use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

/// A server of a scene's page.
#[pyclass(module = "anamorph._native", frozen)]
pub struct Viewer {
    viewer: Mutex<Option<anamorph::Viewer>>,
    #[pyo3(get)]
    address: String,
    opener: Opener,
}

impl Drop for Viewer {
    fn drop(&mut self) {
        if self.opener.is_parent() {
            std::mem::forget(self.take());
        }
    }
}

impl Viewer {
    fn of(viewer: anamorph::Viewer) -> Viewer {
        let address = viewer.address().to_owned();
        Viewer { viewer: Mutex::new(Some(viewer)), address, opener: Opener::this_process() }
    }

    fn take(&self) -> Option<anamorph::Viewer> {
        self.viewer.lock().unwrap_or_else(PoisonError::into_inner).take()
    }
}

#[pymethods]
impl Viewer {
    #[staticmethod]
    fn of_file(py: Python<'_>, path: PathBuf, overrides: Vec<String>, frame: f64, port: u16) -> PyResult<Viewer> {
        let view = move || {
            let overrides: Vec<&str> = overrides.iter().map(String::as_str).collect();
            anamorph::Viewer::of_file(&path, &overrides, frame, port)
        };
        run(py, view).map(Viewer::of)
    }

    #[staticmethod]
    fn of_scene(
        py: Python<'_>,
        scene: &Scene,
        camera: Option<String>,
        folder: PathBuf,
        size: Option<(u32, u32)>,
        port: u16,
    ) -> PyResult<Viewer> {
        let scene = scene.now();
        run(py, move || anamorph::Viewer::of_scene(&scene, camera.as_deref(), &folder, size, port)).map(Viewer::of)
    }

    fn close(&self, py: Python<'_>) {
        let viewer = self.take();
        if self.opener.is_parent() {
            std::mem::forget(viewer);
        } else {
            py.detach(|| drop(viewer));
        }
    }
}
