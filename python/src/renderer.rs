//! Rendering to arrays.

use crate::calls::{Opener, run};
use crate::camera::Camera;
use crate::frame::{Planes, channels, planes};
use crate::scene::Scene;
use anamorph::{Numbers, RenderOptions};
use numpy::{PyArray1, PyArray3, PyArray4, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyCFunction;
use std::sync::{Arc, Mutex, MutexGuard};

/// A device, or the reference on the CPU, with what it holds.
#[pyclass(module = "anamorph._native", frozen)]
pub struct Renderer {
    renderer: Arc<Mutex<anamorph::Renderer>>,
    adapter: Option<String>,
    opener: Opener,
}

impl Drop for Renderer {
    fn drop(&mut self) {
        if self.opener.is_parent() {
            std::mem::forget(self.renderer.clone());
        }
    }
}

#[pymethods]
impl Renderer {
    #[new]
    #[pyo3(signature = (adapter, reference))]
    fn new(py: Python<'_>, adapter: Option<String>, reference: bool) -> PyResult<Renderer> {
        let open = move || match (reference, adapter) {
            (true, _) => Ok(anamorph::Renderer::reference()),
            (false, Some(adapter)) => anamorph::Renderer::on(adapter),
            (false, None) => anamorph::Renderer::new(),
        };
        let renderer = run(py, open)?;
        let adapter = renderer.adapter().map(str::to_owned);
        Ok(Renderer { renderer: Arc::new(Mutex::new(renderer)), adapter, opener: Opener::this_process() })
    }

    /// The adapter's name; `None`: the reference renders.
    #[getter]
    fn adapter(&self) -> Option<&str> {
        self.adapter.as_deref()
    }

    /// The planes of the channels, 8-bit sRGB colour (H, W, 4) where it is wanted, and a function that returns the report as JSON.
    #[allow(clippy::too_many_arguments, clippy::type_complexity)]
    #[pyo3(signature = (scene, camera, names, color, samples, analytic))]
    fn render<'py>(
        &self,
        py: Python<'py>,
        scene: &Scene,
        camera: &Camera,
        names: Vec<String>,
        color: bool,
        samples: u32,
        analytic: bool,
    ) -> PyResult<(Planes<'py>, Option<Bound<'py, PyArray3<u8>>>, Bound<'py, PyCFunction>)> {
        let options = RenderOptions { channels: channels(&names)?, color, samples, analytic, ..Default::default() };
        let (renderer, scene, camera) = (self.renderer.clone(), scene.now(), camera.camera.clone());
        let mut rendered = run(py, move || lock(&renderer)?.render(&scene, &camera, &options))?;
        let size = [rendered.frame.height as usize, rendered.frame.width as usize];
        let (own, rgba) = (std::mem::take(&mut rendered.frame.planes), rendered.rgba.take());
        let rgba = rgba.map(|bytes| PyArray1::from_vec(py, bytes).reshape([size[0], size[1], 4])).transpose()?;
        Ok((planes(py, own, size)?, rgba, read_later(py, move || rendered.report())?))
    }

    /// Arrays of gradients by their names; and of each number of the camera its name, value, step, and errors of origins and directions.
    #[allow(clippy::type_complexity)]
    #[pyo3(signature = (scene, camera, quantities, of))]
    fn gradients<'py>(
        &self,
        py: Python<'py>,
        scene: &Scene,
        camera: &Camera,
        quantities: Vec<String>,
        of: Vec<String>,
    ) -> PyResult<(Vec<(String, Bound<'py, PyAny>)>, Vec<(String, f64, f64, f64, f64)>)> {
        let (renderer, scene, camera) = (self.renderer.clone(), scene.now(), camera.camera.clone());
        let found = run(py, move || {
            let [quantities, of] = [&quantities, &of].map(|names| names.iter().map(String::as_str).collect::<Vec<_>>());
            lock(&renderer)?.gradients(&scene, &camera, &quantities, &of)
        })?;
        let array = |array: anamorph::GradientArray| {
            let numbers = match array.numbers {
                Numbers::F32(numbers) => PyArray1::from_vec(py, numbers).reshape(array.shape)?.into_any(),
                Numbers::U32(numbers) => PyArray1::from_vec(py, numbers).reshape(array.shape)?.into_any(),
            };
            Ok((array.name, numbers))
        };
        let arrays = found.arrays.into_iter().map(array).collect::<PyResult<_>>()?;
        let parameters = found.parameters.into_iter().map(|p| (p.name, p.value, p.step, p.error[0], p.error[1]));
        Ok((arrays, parameters.collect()))
    }

    /// The same of an image through each camera: planes (N, H, W), colour (N, H, W, 4).
    #[allow(clippy::too_many_arguments, clippy::type_complexity)]
    #[pyo3(signature = (scene, cameras, names, color, samples, analytic))]
    fn render_many<'py>(
        &self,
        py: Python<'py>,
        scene: &Scene,
        cameras: Vec<PyRef<'py, Camera>>,
        names: Vec<String>,
        color: bool,
        samples: u32,
        analytic: bool,
    ) -> PyResult<(Planes<'py>, Option<Bound<'py, PyArray4<u8>>>, Bound<'py, PyCFunction>)> {
        let options = RenderOptions { channels: channels(&names)?, color, samples, analytic, ..Default::default() };
        let (renderer, scene) = (self.renderer.clone(), scene.now());
        let cameras: Vec<anamorph::Camera> = cameras.iter().map(|camera| camera.camera.clone()).collect();
        let mut views = run(py, move || lock(&renderer)?.render_many(&scene, &cameras, &options))?;
        let [count, height, width] = [views.count, views.height as usize, views.width as usize];
        let (own, rgba) = (std::mem::take(&mut views.planes), views.rgba.take());
        let rgba = rgba.map(|bytes| PyArray1::from_vec(py, bytes).reshape([count, height, width, 4])).transpose()?;
        Ok((planes(py, own, [count, height, width])?, rgba, read_later(py, move || views.report())?))
    }
}

/// A function of Python that returns a report: a part of it may be worked out only when it is read.
fn read_later<'py>(
    py: Python<'py>,
    report: impl Fn() -> String + Send + Sync + 'static,
) -> PyResult<Bound<'py, PyCFunction>> {
    PyCFunction::new_closure(py, None, None, move |_, _| report())
}

/// Opened again if a call broke off in the middle.
fn lock(renderer: &Mutex<anamorph::Renderer>) -> anamorph::Result<MutexGuard<'_, anamorph::Renderer>> {
    renderer.lock().or_else(|broken| {
        let mut own = broken.into_inner();
        own.reopen()?;
        renderer.clear_poison();
        Ok(own)
    })
}
