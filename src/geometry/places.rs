//! The transforms of the copies of a mesh.

use crate::arrays::MapEach;
use crate::image::read_npy_affines;
use crate::input::load::with_tree;
use crate::input::reader::Field;
use crate::input::{Error, Loading, Result};
use glam::DAffine3;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// One transform for each copy of a mesh. It is applied after scale, rotation and translation.
#[derive(Debug, Clone, PartialEq)]
pub enum Places {
    Given(Arc<[DAffine3]>),
    /// A .npy or .json file, already relative to the working directory.
    File(PathBuf),
}

impl Places {
    /// A list of matrices, or a file's name.
    pub(super) fn read(field: &Field) -> Result<Places> {
        if !field.is_list() {
            return Ok(Places::File(field.path()?));
        }
        Ok(Places::Given(read_list(field)?))
    }

    /// # Errors
    /// [`Error::Input`] naming the file, and the matrix by its index from 0.
    pub fn load(&self, loading: &Loading) -> Result<Arc<[DAffine3]>> {
        match self {
            Places::Given(places) => Ok(places.clone()),
            Places::File(path) => match path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).as_deref() {
                Some("npy") => read_npy(path, loading),
                Some("json") => with_tree(path, loading, read_list),
                _ => Err(Error::input(format!("{}: places must be a .npy or .json file", path.display()))),
            },
        }
    }
}

fn read_list(field: &Field) -> Result<Arc<[DAffine3]>> {
    let matrix = |f: Field| {
        let place = f.affine()?;
        check(&place).map_err(|why| f.error(why))?;
        Ok(place)
    };
    field.items("a list of matrices, as [[[1, 0, 0, x], [0, 1, 0, y], [0, 0, 1, z]], ...]")?.map(matrix).collect()
}

fn read_npy(path: &Path, loading: &Loading) -> Result<Arc<[DAffine3]>> {
    let places = read_npy_affines(path, loading)?;
    let wrong = |(k, place): (usize, &DAffine3)| Some((k, check(place).err()?));
    match places.iter().enumerate().find_map(wrong) {
        Some((k, why)) => Err(Error::input(format!("{}: matrix {k}: {why}", path.display()))),
        None => Ok(places.into()),
    }
}

/// Rounding error of the determinant if the largest entry of each column is 1. It is a sum of 6 products of 3 numbers, each at most 1, with
/// at most 5 roundings each: 6 * 5 * 2^-53.
const DETERMINANT_ERROR: f64 = 15.0 * f64::EPSILON;

/// # Errors
/// Why the matrix cannot be used.
fn check(place: &DAffine3) -> std::result::Result<(), &'static str> {
    if !place.is_finite() {
        return Err("an entry is not finite; use finite numbers");
    }
    let m = place.matrix3;
    let [x, y, z] = [m.x_axis, m.y_axis, m.z_axis].map_each(|axis| axis / axis.abs().max_element());
    // NaN, and so not greater, if a column is zero
    match x.dot(y.cross(z)).abs() > DETERMINANT_ERROR {
        true => Ok(()),
        false => Err("the matrix is singular; its first three columns must be linearly independent"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DMat3, DVec3};

    #[test]
    fn singular_matrices_are_refused_and_small_or_thin_ones_are_not() {
        let of = |x, y, z| check(&DAffine3::from_mat3(DMat3::from_cols(x, y, z)));
        let (x, y, z) = (DVec3::new(1.0, 0.3, 0.7), DVec3::new(0.1, 0.9, -0.4), DVec3::new(-0.3, 0.2, 1.0));
        for scale in [1e-200, 1.0, -1e200] {
            assert_eq!(of(scale * x, y, z), Ok(()));
            assert_eq!(of(scale * x, scale * y, 1e-13 * z + x + y), Ok(()));
            // dependent up to rounding
            assert!(of(scale * x, y, x / 3.0 + 0.7 * y).is_err());
        }
        assert!(of(x, DVec3::ZERO, z).is_err() && of(x, DVec3::INFINITY, z).is_err());
        assert!(check(&DAffine3::from_translation(DVec3::NAN)).is_err());
    }
}
