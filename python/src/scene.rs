//! Scenes, and meshes from arrays.

use crate::calls::{finish, run};
use anamorph::{Caster, Exposure, LineOrder, Mesh};
use numpy::{PyReadonlyArray2, PyReadonlyArray3};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

/// A scene. A call that runs keeps what it has begun with: a change then makes a new one inside.
#[pyclass(module = "anamorph._native", frozen)]
pub struct Scene {
    scene: Arc<Mutex<Arc<anamorph::Scene>>>,
    /// The last that was needed.
    caster: Arc<Mutex<Option<CasterOf>>>,
}

/// A scene as it was, and its caster.
type CasterOf = (Arc<anamorph::Scene>, Arc<Caster>);

impl Scene {
    fn of(scene: anamorph::Scene) -> Scene {
        Scene { scene: Arc::new(Mutex::new(Arc::new(scene))), caster: Arc::default() }
    }

    /// What gives the caster of the scene as it is now, made when it is first needed.
    pub fn caster(&self) -> impl FnOnce() -> Arc<Caster> + Send + 'static {
        let (scene, kept) = (self.now(), self.caster.clone());
        move || {
            let mut kept = kept.lock().unwrap_or_else(PoisonError::into_inner);
            if let Some((_, caster)) = kept.as_ref().filter(|(of, _)| Arc::ptr_eq(of, &scene)) {
                return caster.clone();
            }
            let caster = Arc::new(Caster::new(&scene));
            *kept = Some((scene, caster.clone()));
            caster
        }
    }

    /// As it is now. While another thread changes it, Python's lock is free.
    pub fn now(&self) -> Arc<anamorph::Scene> {
        match self.scene.try_lock() {
            Ok(scene) => scene.clone(),
            Err(_) => {
                Python::attach(|py| py.detach(|| self.scene.lock().unwrap_or_else(PoisonError::into_inner).clone()))
            }
        }
    }

    /// Adds what `make` makes on a thread of its own; nothing if the call is broken off meanwhile.
    fn add(
        &self,
        py: Python<'_>,
        make: impl FnOnce() -> anamorph::Result<anamorph::Placed> + Send + 'static,
    ) -> PyResult<()> {
        let (placed, scene) = (run(py, make)?, self.scene.clone());
        finish(py, move || {
            let mut scene = scene.lock().unwrap_or_else(PoisonError::into_inner);
            Arc::make_mut(&mut scene).add_placed(placed)
        })
    }

    fn change(
        &self,
        py: Python<'_>,
        change: impl FnOnce(&mut anamorph::Scene) -> anamorph::Result<()> + Send + 'static,
    ) -> PyResult<()> {
        let scene = self.scene.clone();
        run(py, move || change(Arc::make_mut(&mut scene.lock().unwrap_or_else(PoisonError::into_inner))))
    }
}

/// Name and triangle count of each object.
type Objects = Vec<(String, usize)>;

#[pymethods]
impl Scene {
    #[new]
    fn new() -> Scene {
        Scene::of(anamorph::Scene::new())
    }

    #[staticmethod]
    fn load(py: Python<'_>, path: PathBuf, overrides: Vec<String>, frame: f64) -> PyResult<Scene> {
        let load = move || {
            let overrides: Vec<&str> = overrides.iter().map(String::as_str).collect();
            anamorph::Scene::load(path, &overrides, frame)
        };
        Ok(Scene::of(run(py, load)?))
    }

    #[staticmethod]
    fn parse(py: Python<'_>, text: String, folder: PathBuf) -> PyResult<Scene> {
        Ok(Scene::of(run(py, move || anamorph::Scene::parse(&text, folder))?))
    }

    /// Adds the mesh of a `[[mesh]]` table.
    fn add_table(&self, py: Python<'_>, table: String, folder: PathBuf) -> PyResult<()> {
        self.add(py, move || anamorph::Placed::of_table(&table, folder))
    }

    /// Adds a mesh of arrays with the keys of a `[[mesh]]` table, and an image of 8-bit sRGB colours (H, W, 3), or (H, W, 4).
    #[allow(clippy::too_many_arguments)]
    #[pyo3(signature = (positions, triangles, normals, uvs, colors, name, table, folder, texture))]
    fn add_arrays(
        &self,
        py: Python<'_>,
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
        // copied while Python's lock is held, so that no other thread changes them
        let (positions, triangles) = (rows(&positions), rows(&triangles));
        let (normals, uvs, colors) = (normals.as_ref().map(rows), uvs.as_ref().map(rows), colors.as_ref().map(rows));
        let texture = texture.map(|texture| {
            let shape = texture.as_array().raw_dim();
            (shape[1], shape[0], texture.as_array().iter().copied().collect::<Vec<u8>>())
        });
        self.add(py, move || {
            let mut mesh = Mesh::new(positions, triangles)?.named(name);
            if let Some(normals) = normals {
                mesh = mesh.with_normals(normals)?;
            }
            if let Some(uvs) = uvs {
                mesh = mesh.with_uvs(uvs)?;
            }
            if let Some(colors) = colors {
                mesh = mesh.with_colors(colors)?;
            }
            if let Some((width, height, bytes)) = texture {
                mesh = mesh.with_texture(width, height, &bytes)?;
            }
            anamorph::Placed::of_mesh(mesh, &table, folder)
        })
    }

    /// Adds spheres of arrays with the keys of a `[[mesh]]` table that they may have.
    #[pyo3(signature = (centers, radii, colors, name, table, folder))]
    #[allow(clippy::too_many_arguments)]
    fn add_spheres(
        &self,
        py: Python<'_>,
        centers: PyReadonlyArray2<'_, f64>,
        radii: Vec<f64>,
        colors: Option<PyReadonlyArray2<'_, f32>>,
        name: String,
        table: String,
        folder: PathBuf,
    ) -> PyResult<()> {
        let (centers, colors) = (rows(&centers), colors.as_ref().map(rows));
        self.add(py, move || {
            let mut spheres = Mesh::spheres(&centers, &radii)?.named(name);
            if let Some(colors) = colors {
                spheres = spheres.with_colors(colors)?;
            }
            anamorph::Placed::of_mesh(spheres, &table, folder)
        })
    }

    /// Adds capsules of arrays, the two ends of each one after the other, with the keys of a `[[mesh]]` table that they may have.
    #[pyo3(signature = (ends, radii, colors, name, table, folder))]
    #[allow(clippy::too_many_arguments)]
    fn add_capsules(
        &self,
        py: Python<'_>,
        ends: PyReadonlyArray2<'_, f64>,
        radii: Vec<f64>,
        colors: Option<PyReadonlyArray2<'_, f32>>,
        name: String,
        table: String,
        folder: PathBuf,
    ) -> PyResult<()> {
        let (ends, colors) = (rows(&ends), colors.as_ref().map(rows));
        self.add(py, move || {
            let ends: Vec<[[f64; 3]; 2]> = ends.chunks_exact(2).map(|ends| [ends[0], ends[1]]).collect();
            let mut capsules = Mesh::capsules(&ends, &radii)?.named(name);
            if let Some(colors) = colors {
                capsules = capsules.with_colors(colors.into_iter().flat_map(|color: [f32; 3]| [color; 2]).collect())?;
            }
            anamorph::Placed::of_mesh(capsules, &table, folder)
        })
    }

    /// Places an object by the rows of an affine matrix.
    fn move_object(&self, py: Python<'_>, name: String, matrix: [[f64; 4]; 3]) -> PyResult<()> {
        self.change(py, move |scene| scene.move_object(&name, matrix))
    }

    /// Gives an object other vertices.
    fn set_vertices(&self, py: Python<'_>, name: String, vertices: PyReadonlyArray2<'_, f64>) -> PyResult<()> {
        let vertices = rows(&vertices);
        self.change(py, move |scene| scene.set_vertices(&name, &vertices))
    }

    /// Lets an object move while an image is taken.
    fn animate(
        &self,
        py: Python<'_>,
        name: String,
        times: Vec<f64>,
        vertices: PyReadonlyArray3<'_, f64>,
    ) -> PyResult<()> {
        let array = vertices.as_array();
        let step = |step: numpy::ndarray::ArrayView2<'_, f64>| {
            step.rows().into_iter().map(|row| [row[0], row[1], row[2]]).collect::<Vec<_>>()
        };
        let steps: Vec<Vec<[f64; 3]>> = array.outer_iter().map(step).collect();
        self.change(py, move |scene| scene.animate(&name, &times, &steps))
    }

    /// Sets when the pixels of images are exposed.
    fn set_exposure(
        &self,
        py: Python<'_>,
        line_time: f64,
        line_order: &str,
        times: Option<PyReadonlyArray2<'_, f64>>,
        shutter: f64,
    ) -> PyResult<()> {
        let Some(line_order) = LineOrder::named(line_order) else {
            let message =
                format!("line_order: {line_order:?} is no order; known: \"down\", \"up\", \"right\", \"left\"");
            return Err(PyValueError::new_err(message));
        };
        let times = times.map(|times| {
            let shape = times.as_array().raw_dim();
            (shape[1] as u32, shape[0] as u32, times.as_array().iter().copied().collect())
        });
        let exposure = Exposure { line_time, line_order, times, shutter };
        self.change(py, move |scene| scene.set_exposure(&exposure))
    }

    /// Throws the picture of a `[[projector_light]]` table onto surfaces.
    fn add_projector_light(&self, py: Python<'_>, table: String, folder: PathBuf) -> PyResult<()> {
        self.change(py, move |scene| scene.add_projector_light(&table, folder))
    }

    /// Gives a projector light another picture of 8-bit sRGB colours (H, W, 3), or (H, W, 4).
    fn set_picture(&self, py: Python<'_>, light: usize, picture: PyReadonlyArray3<'_, u8>) -> PyResult<()> {
        let shape = picture.as_array().raw_dim();
        let bytes: Vec<u8> = picture.as_array().iter().copied().collect();
        self.change(py, move |scene| scene.set_picture(light, shape[1], shape[0], &bytes))
    }

    #[getter]
    fn projector_light_count(&self) -> usize {
        self.now().projector_light_count()
    }

    /// Gives the scene a volume of these numbers (z, y, x) with the keys of a `[volume]` table, or none.
    fn set_volume(
        &self,
        py: Python<'_>,
        values: Option<PyReadonlyArray3<'_, f32>>,
        table: String,
        folder: PathBuf,
    ) -> PyResult<()> {
        let values = values.map(|values| {
            let shape = values.as_array().raw_dim();
            ([shape[0], shape[1], shape[2]], values.as_array().iter().copied().collect::<Vec<f32>>())
        });
        self.change(py, move |scene| match values {
            Some((shape, numbers)) => scene.set_volume(shape, numbers, &table, folder),
            None => {
                scene.remove_volume();
                Ok(())
            }
        })
    }

    #[getter]
    fn has_camera(&self) -> bool {
        self.now().has_camera()
    }

    #[getter]
    fn triangle_count(&self) -> usize {
        self.now().triangle_count()
    }

    #[getter]
    fn bounds(&self, py: Python<'_>) -> PyResult<Option<[[f64; 3]; 2]>> {
        let scene = self.now();
        run(py, move || Ok(scene.bounds()))
    }

    #[getter]
    fn objects(&self) -> Objects {
        self.now().objects().map(|(name, count)| (name.to_owned(), count)).collect()
    }

    #[getter]
    fn missing(&self) -> Vec<String> {
        self.now().missing().collect()
    }
}

/// The rows of an array, of any strides.
pub fn rows<T: numpy::Element + Copy + Default, const N: usize>(array: &PyReadonlyArray2<'_, T>) -> Vec<[T; N]> {
    let view = array.as_array();
    // rows that lie one after another
    if let Some(flat) = view.as_slice() {
        return flat.as_chunks().0.to_vec();
    }
    view.rows()
        .into_iter()
        .map(|row| {
            let mut own = [T::default(); N];
            own.iter_mut().zip(row).for_each(|(to, from)| *to = *from);
            own
        })
        .collect()
}
