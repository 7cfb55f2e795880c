//! Scenes, and meshes from arrays.

use crate::calls::{python_error, run};
use anamorph::Mesh;
use numpy::{PyReadonlyArray2, PyReadonlyArray3};
use pyo3::prelude::*;
use std::path::PathBuf;
use std::sync::Arc;

/// A scene. Each change makes a new one inside, so that a call that runs keeps what it has begun with.
#[pyclass(module = "anamorph._native")]
pub struct Scene {
    pub scene: Arc<anamorph::Scene>,
}

/// Name and triangle count of each object.
type Objects = Vec<(String, usize)>;

#[pymethods]
impl Scene {
    #[new]
    fn new() -> Scene {
        Scene { scene: Arc::new(anamorph::Scene::new()) }
    }

    #[staticmethod]
    fn load(py: Python<'_>, path: PathBuf, overrides: Vec<String>, frame: f64) -> PyResult<Scene> {
        let load = move || {
            let overrides: Vec<&str> = overrides.iter().map(String::as_str).collect();
            anamorph::Scene::load(path, &overrides, frame)
        };
        Ok(Scene { scene: Arc::new(run(py, load)?) })
    }

    #[staticmethod]
    fn parse(py: Python<'_>, text: String, folder: PathBuf) -> PyResult<Scene> {
        Ok(Scene { scene: Arc::new(run(py, move || anamorph::Scene::parse(&text, folder))?) })
    }

    /// Adds the mesh of a `[[mesh]]` table.
    fn add_table(&mut self, py: Python<'_>, table: String, folder: PathBuf) -> PyResult<()> {
        let scene = self.scene.clone();
        let add = move || {
            let mut scene = scene;
            Arc::make_mut(&mut scene).add_table(&table, folder)?;
            Ok(scene)
        };
        self.scene = run(py, add)?;
        Ok(())
    }

    /// Adds a mesh of arrays with the keys of a `[[mesh]]` table, and an image of 8-bit sRGB colours (H, W, 3), or (H, W, 4).
    #[allow(clippy::too_many_arguments)]
    #[pyo3(signature = (positions, triangles, normals, uvs, colors, name, table, folder, texture))]
    fn add_arrays(
        &mut self,
        positions: PyReadonlyArray2<'_, f64>,
        triangles: PyReadonlyArray2<'_, u32>,
        normals: Option<PyReadonlyArray2<'_, f32>>,
        uvs: Option<PyReadonlyArray2<'_, f32>>,
        colors: Option<PyReadonlyArray2<'_, f32>>,
        name: String,
        table: String,
        folder: PathBuf,
        texture: Option<PyReadonlyArray3<'_, u8>>,
    ) -> PyResult<()> {
        let mut mesh = Mesh::new(rows(&positions), rows(&triangles)).map_err(python_error)?.named(name);
        if let Some(normals) = normals {
            mesh = mesh.with_normals(rows(&normals)).map_err(python_error)?;
        }
        if let Some(uvs) = uvs {
            mesh = mesh.with_uvs(rows(&uvs)).map_err(python_error)?;
        }
        if let Some(colors) = colors {
            mesh = mesh.with_colors(rows(&colors)).map_err(python_error)?;
        }
        if let Some(texture) = texture {
            let (pixels, shape) = (texture.as_array(), texture.as_array().raw_dim());
            let bytes: Vec<u8> = pixels.iter().copied().collect();
            mesh = mesh.with_texture(shape[1], shape[0], &bytes).map_err(python_error)?;
        }
        let mut scene = self.scene.clone();
        Arc::make_mut(&mut scene).add_with(mesh, &table, folder).map_err(python_error)?;
        self.scene = scene;
        Ok(())
    }

    #[getter]
    fn has_camera(&self) -> bool {
        self.scene.has_camera()
    }

    #[getter]
    fn triangle_count(&self) -> usize {
        self.scene.triangle_count()
    }

    #[getter]
    fn bounds(&self) -> Option<[[f64; 3]; 2]> {
        self.scene.bounds()
    }

    #[getter]
    fn objects(&self) -> Objects {
        self.scene.objects().map(|(name, count)| (name.to_owned(), count)).collect()
    }

    #[getter]
    fn missing(&self) -> Vec<String> {
        self.scene.missing().collect()
    }
}

/// The rows of an array, of any strides.
pub fn rows<T: numpy::Element + Copy + Default, const N: usize>(array: &PyReadonlyArray2<'_, T>) -> Vec<[T; N]> {
    let view = array.as_array();
    view.rows()
        .into_iter()
        .map(|row| {
            let mut own = [T::default(); N];
            own.iter_mut().zip(row).for_each(|(to, from)| *to = *from);
            own
        })
        .collect()
}
