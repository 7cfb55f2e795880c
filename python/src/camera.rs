//! Cameras, and where they show points.

use crate::calls::run;
use crate::scene::{Scene, rows};
use numpy::{PyArray3, PyArrayMethods, PyReadonlyArray2, PyReadonlyArray3};
use pyo3::prelude::*;
use std::path::PathBuf;

/// A camera for an image of one size.
#[pyclass(module = "anamorph._native", frozen)]
pub struct Camera {
    pub camera: anamorph::Camera,
}

#[pymethods]
impl Camera {
    /// Of the keys of a scene file's `[camera]`, as JSON; for an image of the scene's size, or of this one.
    #[staticmethod]
    fn of_table(
        py: Python<'_>,
        table: String,
        folder: PathBuf,
        scene: &Scene,
        size: Option<(u32, u32)>,
    ) -> PyResult<Camera> {
        let scene = scene.now();
        Ok(Camera { camera: run(py, move || anamorph::Camera::parse(&table, folder, &scene, size))? })
    }

    /// The scene's own.
    #[staticmethod]
    fn of_scene(py: Python<'_>, scene: &Scene, size: Option<(u32, u32)>) -> PyResult<Camera> {
        let scene = scene.now();
        let make = move || match size {
            Some((width, height)) => scene.camera_of_size(width, height),
            None => scene.camera(),
        };
        Ok(Camera { camera: run(py, make)? })
    }

    /// A ray for each pixel: (H, W, 3) origins and directions.
    #[staticmethod]
    fn of_rays(
        py: Python<'_>,
        origins: PyReadonlyArray3<'_, f64>,
        directions: PyReadonlyArray3<'_, f64>,
        t_range: (f64, f64),
    ) -> PyResult<Camera> {
        let shape = origins.as_array().raw_dim();
        let vectors = |array: &PyReadonlyArray3<'_, f64>| -> Vec<[f64; 3]> {
            array.as_array().rows().into_iter().map(|v| [v[0], v[1], v[2]]).collect()
        };
        let range = [t_range.0, t_range.1];
        let (origins, directions) = (vectors(&origins), vectors(&directions));
        let make = move || anamorph::Camera::of_rays((shape[1], shape[0]), &origins, &directions, range);
        Ok(Camera { camera: run(py, make)? })
    }

    #[getter]
    fn kind(&self) -> &str {
        self.camera.kind()
    }

    #[getter]
    fn width(&self) -> u32 {
        self.camera.width()
    }

    #[getter]
    fn height(&self) -> u32 {
        self.camera.height()
    }

    #[getter]
    fn piece_count(&self) -> usize {
        self.camera.piece_count()
    }

    /// The names of its channels.
    #[getter]
    fn channels(&self) -> Vec<&'static str> {
        self.camera.channels().into_iter().map(anamorph::Channel::name).collect()
    }

    /// Origins and directions of the rays through the pixels' centres, (H, W, 3) each; NaN where a pixel has none.
    #[allow(clippy::type_complexity)]
    fn rays<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyArray3<f64>>, Bound<'py, PyArray3<f64>>)> {
        let camera = self.camera.clone();
        let shape = [camera.height() as usize, camera.width() as usize, 3];
        let [origins, directions] = run(py, move || Ok(camera.rays()))?;
        let array = |vectors: Vec<[f64; 3]>| numpy::PyArray1::from_vec(py, vectors.into_flattened()).reshape(shape);
        Ok((array(origins)?, array(directions)?))
    }
}

/// The kinds of cameras and their help: a line, the keys, the formula.
#[pyfunction]
pub fn camera_kinds() -> Vec<(&'static str, String)> {
    anamorph::camera_kinds().collect()
}

/// The names of the images of a COLMAP model, in order.
#[pyfunction]
pub fn colmap_images(py: Python<'_>, folder: PathBuf) -> PyResult<Vec<String>> {
    run(py, move || anamorph::colmap_images(folder))
}

/// An image of a point: column, row, t, piece.
type Place = (f64, f64, f64, u32);

/// Of each of the (N, 3) points: its images, and why it has a whole curve of them, if it has.
#[pyfunction]
pub fn project(
    py: Python<'_>,
    camera: &Camera,
    points: PyReadonlyArray2<'_, f64>,
) -> PyResult<Vec<(Vec<Place>, Option<&'static str>)>> {
    let (camera, points) = (camera.camera.clone(), rows::<f64, 3>(&points));
    let all = run(py, move || Ok(anamorph::project(&camera, &points)))?;
    let place = |image: &anamorph::Image| (image.x, image.y, image.t, image.piece);
    Ok(all.iter().map(|of| (of.images.iter().map(place).collect(), of.degenerate.map(|d| d.name()))).collect())
}
