//! Cameras, and where they show points.

use crate::calls::run;
use crate::scene::{Scene, rows};
use numpy::{PyArray1, PyArray2, PyArray3, PyArrayMethods, PyReadonlyArray2, PyReadonlyArray3};
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
    let all = run(py, move || anamorph::project(&camera, &points))?;
    let place = |image: &anamorph::Image| (image.x, image.y, image.t, image.piece);
    Ok(all.iter().map(|of| (of.images.iter().map(place).collect(), of.degenerate.map(|d| d.name()))).collect())
}

/// What works on points: the CPU, the fastest adapter, or the adapter of a name.
fn device_of(device: Option<String>) -> anamorph::Device {
    match device.as_deref() {
        None => anamorph::Device::Cpu,
        Some("") => anamorph::Device::Gpu,
        Some(name) => anamorph::Device::Named(name.to_owned()),
    }
}

/// Numbers of images by point, M images: first (N + 1), x, y, t, piece, of each point 0, 1 (slit) or 2 (eye), and how many points a kernel finished.
type Many<'py> = (
    Bound<'py, PyArray1<u64>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<u32>>,
    Bound<'py, PyArray1<u8>>,
    u64,
);

/// All images of (N, 3) points as arrays. `device`: none, the CPU; empty, the fastest adapter; else a part of an adapter's name.
#[pyfunction]
pub fn project_many<'py>(
    py: Python<'py>,
    camera: &Camera,
    points: PyReadonlyArray2<'_, f64>,
    device: Option<String>,
    within_px: f64,
) -> PyResult<Many<'py>> {
    let (camera, points) = (camera.camera.clone(), rows::<f64, 3>(&points));
    let all = run(py, move || anamorph::project_many(&camera, &points, &device_of(device), within_px))?;
    let degenerate = all.degenerate.iter().map(|d| match d {
        None => 0,
        Some(anamorph::Degenerate::Slit) => 1,
        Some(anamorph::Degenerate::Eye) => 2,
    });
    let degenerate: Vec<u8> = degenerate.collect();
    Ok((
        PyArray1::from_vec(py, all.first),
        PyArray1::from_vec(py, all.x),
        PyArray1::from_vec(py, all.y),
        PyArray1::from_vec(py, all.t),
        PyArray1::from_vec(py, all.piece),
        PyArray1::from_vec(py, degenerate),
        all.by_kernel,
    ))
}

/// Each pixel's nearest of (N, 3) points: its number and its t, (H, W) each; how many points are degenerate.
#[pyfunction]
#[allow(clippy::type_complexity)]
pub fn splat<'py>(
    py: Python<'py>,
    camera: &Camera,
    points: PyReadonlyArray2<'_, f64>,
    device: Option<String>,
) -> PyResult<(Bound<'py, PyArray2<u32>>, Bound<'py, PyArray2<f64>>, u64)> {
    let (camera, points) = (camera.camera.clone(), rows::<f64, 3>(&points));
    let all = run(py, move || anamorph::splat(&camera, &points, &device_of(device)))?;
    let shape = [all.height as usize, all.width as usize];
    let index = PyArray1::from_vec(py, all.index).reshape(shape)?;
    Ok((index, PyArray1::from_vec(py, all.t).reshape(shape)?, all.degenerate))
}
