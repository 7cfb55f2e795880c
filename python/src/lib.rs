//! The native module of the Python package `anamorph`: the facade of the library over arrays. What users see is `anamorph/*.py`.

mod calls;
mod camera;
mod cast;
mod frame;
mod renderer;
mod scene;
mod view;

use pyo3::prelude::*;

/// The library's facade, as the package's own modules use it.
#[pymodule]
mod _native {
    #[pymodule_export]
    use super::camera::{Camera, camera_kinds, colmap_images, project, project_many, splat};
    #[pymodule_export]
    use super::cast::{cast, cast_all, meets_any};
    #[pymodule_export]
    use super::frame::{channels_named, check, compare, read_exr, write_exr, write_png};
    #[pymodule_export]
    use super::program;
    #[pymodule_export]
    use super::renderer::Renderer;
    #[pymodule_export]
    use super::scene::Scene;
    #[pymodule_export]
    use super::view::Viewer;
}

/// Runs the program on these arguments, the first of which is its name; its exit code.
#[pyfunction]
fn program(py: Python<'_>, arguments: Vec<std::ffi::OsString>) -> u8 {
    py.detach(|| anamorph::program(arguments))
}
