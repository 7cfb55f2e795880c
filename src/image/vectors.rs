//! One vector per pixel from a .npy or EXR file: a ray map's origins and directions, a table of places.

use std::path::Path;

use glam::{DVec2, DVec3};

use super::exr::read_planes;
use super::npy::{of_file, read_npy_vectors};
use crate::image::frame::Channel;
use crate::input::{Error, Loading, Result};

/// Reads width, height and one vector per pixel, row by row from the top: .npy of f32 or f64 in C order
/// with shape height x width x 3, or EXR with R G B = x y z. Values may be NaN or infinite.
///
/// # Errors
/// [`Error::Input`] naming the file: not there, another format, shape or type, or cut short.
pub fn read_vectors(path: &Path, loading: &Loading) -> Result<(u32, u32, Vec<DVec3>)> {
    let channels = [Channel::R, Channel::G, Channel::B];
    let (width, height, numbers) = read(path, channels, "R G B must hold x y z", loading)?;
    Ok((width, height, numbers.into_iter().map(DVec3::from).collect()))
}

/// Reads width, height and two numbers per pixel: as [`read_vectors`], with shape height x width x 2, or EXR with R and G.
pub fn read_pairs(path: &Path, loading: &Loading) -> Result<(u32, u32, Vec<DVec2>)> {
    let (width, height, numbers) = read(path, [Channel::R, Channel::G], "R and G must hold the two numbers", loading)?;
    Ok((width, height, numbers.into_iter().map(DVec2::from).collect()))
}

fn read<const N: usize>(
    path: &Path,
    channels: [Channel; N],
    holds: &str,
    loading: &Loading,
) -> Result<(u32, u32, Vec<[f64; N]>)> {
    let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
    match extension.as_deref() {
        Some("npy") => of_file(path, loading, read_npy_vectors),
        Some("exr") => {
            let (width, height, planes) = read_planes(path, channels, holds, loading)?;
            let at = |k: usize| planes.each_ref().map(|plane| f64::from(plane[k]));
            Ok((width, height, (0..planes[0].len()).map(at).collect()))
        }
        _ => Err(Error::input(format!("{}: vectors are read from .npy or .exr files only", path.display()))),
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::{write_exr, write_npy};
    use super::*;
    use crate::image::frame::{Channel, Frame, Plane};

    #[test]
    fn npy_round_trips_bit_for_bit() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("v.npy");
        let data: Vec<f64> = (0..4000 * 3).map(|i| 1.0 / f64::from(i)).collect();
        write_npy(&path, &[40, 100, 3], &data).unwrap();
        let (width, height, vectors) = read_vectors(&path, &Loading::default()).unwrap();
        assert_eq!((width, height), (100, 40));
        assert_eq!(vectors.iter().flat_map(|v| v.to_array()).collect::<Vec<_>>(), data);
        assert_eq!(data[0], f64::INFINITY);
    }

    #[test]
    fn exr_channels_are_the_components() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("v.exr");
        let plane = |first: f32| Plane::F32(vec![first, first + 0.5]);
        let planes = vec![(Channel::R, plane(1.0)), (Channel::G, plane(2.0)), (Channel::B, plane(3.0))];
        write_exr(&path, &Frame { width: 2, height: 1, planes: planes.clone() }, &[]).unwrap();
        let expected = vec![DVec3::new(1.0, 2.0, 3.0), DVec3::new(1.5, 2.5, 3.5)];
        assert_eq!(read_vectors(&path, &Loading::default()).unwrap(), (2, 1, expected));
        assert_eq!(
            read_pairs(&path, &Loading::default()).unwrap(),
            (2, 1, vec![DVec2::new(1.0, 2.0), DVec2::new(1.5, 2.5)])
        );
        write_exr(&path, &Frame { width: 2, height: 1, planes: planes[..2].into() }, &[]).unwrap();
        let missing = read_vectors(&path, &Loading::default()).unwrap_err();
        assert!(missing.exit_code() == 2 && missing.to_string().contains("no channel B"), "{missing}");
    }

    #[test]
    fn wrong_files_say_why() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("v.npy");
        let fails = |expected: &str| {
            let error = read_vectors(&path, &Loading::default()).unwrap_err();
            assert!(error.exit_code() == 2 && error.to_string().contains(expected), "{error}");
        };
        fails("cannot be read");
        write_npy(&path, &[2, 2, 2], &[0.0; 8]).unwrap();
        fails("must be height x width x 3");
        assert_eq!(read_pairs(&path, &Loading::default()).unwrap(), (2, 2, vec![DVec2::ZERO; 4]));
        write_npy(&path, &[2, 6], &[0.0; 12]).unwrap();
        fails("must be height x width x 3");
        write_npy(&path, &[0, 2, 3], &[0.0; 0]).unwrap();
        fails("has no pixels");
        write_npy(&path, &[1, 65_537, 3], &vec![0.0; 3 * 65_537]).unwrap();
        fails("over the limit of 65536 pixels a side");
        write_npy(&path, &[2, 2, 3], &[0.0; 12]).unwrap();
        let whole = std::fs::read(&path).unwrap();
        std::fs::write(&path, &whole[..whole.len() - 1]).unwrap();
        fails("ends early");
        std::fs::write(&path, b"v 0 0 0").unwrap();
        fails("header is damaged");
        assert!(
            read_vectors(Path::new("v.png"), &Loading::default()).unwrap_err().to_string().contains(".npy or .exr")
        );
        assert!(read_vectors(&dir.path().join("none.exr"), &Loading::default()).is_err());
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(300))]

        #[test]
        fn damaged_arrays_never_panic(at in 0..200usize, put in any::<[u8; 3]>(), keep in 0..250usize) {
            let dir = tempfile::tempdir().unwrap();
            let path = dir.path().join("v.npy");
            write_npy(&path, &[2, 2, 3], &[1.0; 12]).unwrap();
            let mut bytes = std::fs::read(&path).unwrap();
            bytes[at..at + 3].copy_from_slice(&put);
            bytes.truncate(keep.max(at));
            std::fs::write(&path, bytes).unwrap();
            let _ = read_vectors(&path, &Loading::default());
        }
    }
}
