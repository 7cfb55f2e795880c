//! Frames as arrays: made, written, read and compared.

use crate::calls::run;
use crate::camera::Camera;
use crate::scene::Scene;
use anamorph::{Channel, Frame, Plane};
use numpy::{PyArray1, PyArrayMethods, PyReadonlyArray2, PyReadonlyArray3, PyUntypedArrayMethods};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use std::path::PathBuf;

/// The name and the (H, W) or (N, H, W) array of each channel: float32, of ids uint32.
pub type Planes<'py> = Vec<(&'static str, Bound<'py, PyAny>)>;

/// The channels of these names.
pub fn channels(names: &[String]) -> PyResult<Vec<Channel>> {
    let mut all = Vec::new();
    for name in names {
        match Channel::named(name) {
            none if none.is_empty() => {
                let known: Vec<&str> = Channel::every().map(Channel::name).collect();
                let known = known.join(", ");
                let meant = Channel::similar(name).map_or(String::new(), |own| format!("did you mean {own}? "));
                return Err(PyValueError::new_err(format!(
                    "no channel {name:?}; {meant}known: {known}, N, P, albedo, uv, view"
                )));
            }
            own => all.extend(own),
        }
    }
    Ok(all)
}

/// The names of the channels that a name stands for: several of `N`, `P`, `albedo`, `uv` and `view`.
#[pyfunction]
pub fn channels_named(name: String) -> PyResult<Vec<&'static str>> {
    Ok(channels(&[name])?.into_iter().map(Channel::name).collect())
}

/// Planes as arrays of a shape, without a copy.
pub fn planes<const N: usize>(py: Python<'_>, planes: Vec<(Channel, Plane)>, shape: [usize; N]) -> PyResult<Planes<'_>>
where
    [usize; N]: numpy::ndarray::IntoDimension,
{
    let array = |(channel, plane): (Channel, Plane)| {
        let array = match plane {
            Plane::F32(values) => PyArray1::from_vec(py, values).reshape(shape)?.into_any(),
            Plane::U32(values) => PyArray1::from_vec(py, values).reshape(shape)?.into_any(),
        };
        Ok((channel.name(), array))
    };
    planes.into_iter().map(array).collect()
}

/// A frame of arrays of one shape, copied.
fn frame(planes: &[(String, Bound<'_, PyAny>)]) -> PyResult<Frame> {
    let mut size = None;
    let mut own = Vec::new();
    for (name, array) in planes {
        let [channel] = channels(std::slice::from_ref(name))?[..] else {
            return Err(PyValueError::new_err(format!("{name:?} is several channels; name each")));
        };
        let (shape, plane) = if channel.is_id() {
            let array = array.extract::<PyReadonlyArray2<'_, u32>>().map_err(|_| wrong_array(name, "uint32"))?;
            (array.shape().to_vec(), Plane::U32(array.as_array().iter().copied().collect()))
        } else {
            let array = array.extract::<PyReadonlyArray2<'_, f32>>().map_err(|_| wrong_array(name, "float32"))?;
            (array.shape().to_vec(), Plane::F32(array.as_array().iter().copied().collect()))
        };
        if *size.get_or_insert_with(|| shape.clone()) != shape {
            return Err(PyValueError::new_err(format!("the array of {name} has another shape, {shape:?}")));
        }
        own.push((channel, plane));
    }
    let Some(size) = size else { return Err(PyValueError::new_err("a frame has one channel at least")) };
    own.sort_by_key(|plane| plane.0);
    Ok(Frame { width: size[1] as u32, height: size[0] as u32, planes: own })
}

fn wrong_array(name: &str, kind: &str) -> PyErr {
    PyTypeError::new_err(format!("{name} needs an array of shape (H, W) and type {kind}"))
}

/// Writes planes as EXR.
#[pyfunction]
pub fn write_exr(py: Python<'_>, path: PathBuf, planes: Vec<(String, Bound<'_, PyAny>)>) -> PyResult<()> {
    let frame = frame(&planes)?;
    run(py, move || anamorph::write_exr(path, &frame))
}

/// Writes (H, W, 3) or (H, W, 4) sRGB bytes as PNG.
#[pyfunction]
pub fn write_png(py: Python<'_>, path: PathBuf, srgb8: PyReadonlyArray3<'_, u8>) -> PyResult<()> {
    let (shape, bytes) = (srgb8.shape().to_vec(), srgb8.as_array().iter().copied().collect::<Vec<u8>>());
    run(py, move || anamorph::write_png(path, (shape[1] as u32, shape[0] as u32), &bytes))
}

/// The channels of an EXR.
#[pyfunction]
pub fn read_exr(py: Python<'_>, path: PathBuf) -> PyResult<Planes<'_>> {
    let frame = run(py, move || anamorph::read_exr(path))?;
    planes(py, frame.planes, [frame.height as usize, frame.width as usize])
}

/// Compares two frames; the comparison as JSON.
#[pyfunction]
pub fn compare(
    py: Python<'_>,
    a: Vec<(String, Bound<'_, PyAny>)>,
    b: Vec<(String, Bound<'_, PyAny>)>,
) -> PyResult<String> {
    let (a, b) = (frame(&a)?, frame(&b)?);
    run(py, move || anamorph::compare(&a, &b).map(|c| c.json()))
}

/// Compares a frame with the reference; the comparison as JSON.
#[pyfunction]
pub fn check(
    py: Python<'_>,
    scene: &Scene,
    camera: &Camera,
    planes: Vec<(String, Bound<'_, PyAny>)>,
) -> PyResult<String> {
    let (scene, camera, frame) = (scene.now(), camera.camera.clone(), frame(&planes)?);
    run(py, move || anamorph::check(&scene, &camera, &frame).map(|c| c.json()))
}
