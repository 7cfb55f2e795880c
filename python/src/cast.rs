//! Rays cast at a scene.

use crate::calls::run;
use crate::scene::{Scene, rows};
use anamorph::{Caster, RayHit};
use numpy::{IntoPyArray, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2};
use pyo3::prelude::*;
use rayon::prelude::*;

/// Columns of hits: t, triangle, object, weights, points, normals.
type Columns<'py> = (
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<i64>>,
    Bound<'py, PyArray1<i64>>,
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray2<f64>>,
);

type Flags<'py> = Bound<'py, PyArray1<bool>>;

/// The first hit of each ray, and whether it is certain; of one that meets nothing t is infinite, the ids are -1, and the rest is NaN.
#[pyfunction]
pub fn cast<'py>(
    py: Python<'py>,
    scene: &Scene,
    origins: PyReadonlyArray2<'py, f64>,
    directions: PyReadonlyArray2<'py, f64>,
    t_range: [f64; 2],
) -> PyResult<(Columns<'py>, Flags<'py>)> {
    let (caster, rays) = (scene.caster(), rays(&origins, &directions));
    let (table, certain) = run(py, move || {
        let (caster, rays) = (caster(), rays());
        let table = Table::of(&caster.first(&rays, t_range)?);
        Ok((table, certain(&caster, &rays)))
    })?;
    Ok((table.columns(py)?, certain.into_pyarray(py)))
}

/// All hits of all rays, how many each ray has, and whether they are certain.
#[pyfunction]
pub fn cast_all<'py>(
    py: Python<'py>,
    scene: &Scene,
    origins: PyReadonlyArray2<'py, f64>,
    directions: PyReadonlyArray2<'py, f64>,
    t_range: [f64; 2],
) -> PyResult<(Columns<'py>, Bound<'py, PyArray1<i64>>, Flags<'py>)> {
    let (caster, rays) = (scene.caster(), rays(&origins, &directions));
    let (table, counts, certain) = run(py, move || {
        let (caster, rays) = (caster(), rays());
        let all = caster.all(&rays, t_range)?;
        let counts: Vec<i64> = all.iter().map(|hits| hits.len() as i64).collect();
        let hits: Vec<Option<RayHit>> = all.into_par_iter().flatten_iter().map(Some).collect();
        Ok((Table::of(&hits), counts, certain(&caster, &rays)))
    })?;
    Ok((table.columns(py)?, counts.into_pyarray(py), certain.into_pyarray(py)))
}

/// Whether each ray meets anything.
#[pyfunction]
pub fn meets_any<'py>(
    py: Python<'py>,
    scene: &Scene,
    origins: PyReadonlyArray2<'py, f64>,
    directions: PyReadonlyArray2<'py, f64>,
    t_range: [f64; 2],
) -> PyResult<Flags<'py>> {
    let (caster, rays) = (scene.caster(), rays(&origins, &directions));
    Ok(run(py, move || caster().meets_any(&rays(), t_range))?.into_pyarray(py))
}

/// Copied while Python's lock is held, so that no other thread changes them.
fn rays(
    origins: &PyReadonlyArray2<f64>,
    directions: &PyReadonlyArray2<f64>,
) -> impl FnOnce() -> Vec<[[f64; 3]; 2]> + Send + 'static {
    let (origins, directions) = (rows(origins), rows(directions));
    move || origins.into_par_iter().zip(directions).map(|(origin, direction)| [origin, direction]).collect()
}

fn certain(caster: &Caster, rays: &[[[f64; 3]; 2]]) -> Vec<bool> {
    rays.par_iter().map(|ray| caster.is_certain(ray)).collect()
}

/// Hits by columns.
struct Table {
    t: Vec<f64>,
    triangles: Vec<i64>,
    objects: Vec<i64>,
    weights: Vec<[f64; 2]>,
    points: Vec<[f64; 3]>,
    normals: Vec<[f64; 3]>,
}

impl Table {
    fn of(hits: &[Option<RayHit>]) -> Table {
        Table {
            t: column(hits, f64::INFINITY, |hit| hit.t),
            triangles: column(hits, -1, |hit| hit.triangle.into()),
            objects: column(hits, -1, |hit| hit.object.into()),
            weights: column(hits, [f64::NAN; 2], |hit| hit.bary),
            points: column(hits, [f64::NAN; 3], |hit| hit.point),
            normals: column(hits, [f64::NAN; 3], |hit| hit.normal),
        }
    }

    /// Without a copy.
    fn columns(self, py: Python<'_>) -> PyResult<Columns<'_>> {
        let count = self.t.len();
        let vectors = |flat: Vec<f64>, n: usize| flat.into_pyarray(py).reshape([count, n]);
        Ok((
            self.t.into_pyarray(py),
            self.triangles.into_pyarray(py),
            self.objects.into_pyarray(py),
            vectors(self.weights.into_flattened(), 2)?,
            vectors(self.points.into_flattened(), 3)?,
            vectors(self.normals.into_flattened(), 3)?,
        ))
    }
}

fn column<T: Copy + Send + Sync>(hits: &[Option<RayHit>], none: T, of: fn(&RayHit) -> T) -> Vec<T> {
    hits.par_iter().map(|hit| hit.as_ref().map_or(none, of)).collect()
}
