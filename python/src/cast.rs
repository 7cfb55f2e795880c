//! Rays cast at a scene.

use crate::calls::run;
use crate::scene::{Scene, rows};
use anamorph::RayHit;
use numpy::{IntoPyArray, PyArray1, PyArray2, PyReadonlyArray2};
use pyo3::prelude::*;

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
    let (hits, certain) = run(py, move || {
        let caster = caster();
        Ok((caster.first(&rays, t_range)?, rays.iter().map(|ray| caster.is_certain(ray)).collect::<Vec<_>>()))
    })?;
    Ok((columns(py, &hits), certain.into_pyarray(py)))
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
    let (hits, counts, certain) = run(py, move || {
        let caster = caster();
        let all = caster.all(&rays, t_range)?;
        let counts: Vec<i64> = all.iter().map(|hits| hits.len() as i64).collect();
        let certain: Vec<bool> = rays.iter().map(|ray| caster.is_certain(ray)).collect();
        Ok((all.into_iter().flatten().map(Some).collect::<Vec<_>>(), counts, certain))
    })?;
    Ok((columns(py, &hits), counts.into_pyarray(py), certain.into_pyarray(py)))
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
    Ok(run(py, move || caster().meets_any(&rays, t_range))?.into_pyarray(py))
}

/// Copied while Python's lock is held, so that no other thread changes them.
fn rays(origins: &PyReadonlyArray2<f64>, directions: &PyReadonlyArray2<f64>) -> Vec<[[f64; 3]; 2]> {
    rows(origins).into_iter().zip(rows(directions)).map(|(origin, direction)| [origin, direction]).collect()
}

fn columns<'py>(py: Python<'py>, hits: &[Option<RayHit>]) -> Columns<'py> {
    let ids = |of: fn(&RayHit) -> u32| {
        hits.iter().map(|hit| hit.as_ref().map_or(-1, |hit| i64::from(of(hit)))).collect::<Vec<_>>().into_pyarray(py)
    };
    let t: Vec<f64> = hits.iter().map(|hit| hit.map_or(f64::INFINITY, |hit| hit.t)).collect();
    (
        t.into_pyarray(py),
        ids(|hit| hit.triangle),
        ids(|hit| hit.object),
        vectors(py, hits, |hit| hit.bary),
        vectors(py, hits, |hit| hit.point),
        vectors(py, hits, |hit| hit.normal),
    )
}

fn vectors<'py, const N: usize>(
    py: Python<'py>,
    hits: &[Option<RayHit>],
    of: fn(&RayHit) -> [f64; N],
) -> Bound<'py, PyArray2<f64>> {
    let flat: Vec<f64> = hits.iter().flat_map(|hit| hit.as_ref().map_or([f64::NAN; N], of)).collect();
    let shaped = numpy::ndarray::Array2::from_shape_vec((hits.len(), N), flat);
    shaped.unwrap_or_default().into_pyarray(py)
}
