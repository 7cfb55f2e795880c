//! `--points`: the point in f64 at which each pixel's ray hits the triangle that the frame shows.

use crate::camera::Camera;
use crate::geometry::primitive::Primitive;
use crate::image::frame::{Channel, Frame, NO_ID};
use crate::image::{write_npy, write_ply};
use crate::input::{Error, Result};
use crate::parallel;
use crate::scene::Scene;
use glam::DVec3;
use std::path::Path;

/// Checks, before any work, that the points can be written.
///
/// # Errors
/// [`Error::Input`] for a file of another kind, or a camera whose rays are curved, or have several segments, as behind a mirror.
pub fn check(points: Option<&Path>, camera: &Camera) -> Result<()> {
    let Some(path) = points else { return Ok(()) };
    if !has_extension(path, "ply") && !has_extension(path, "npy") {
        return Err(Error::input(format!("{}: points are written as .ply or .npy; name the file so", path.display())));
    }
    if camera.composition.as_ref().is_some_and(|composition| composition.master.is_some()) {
        return Err(Error::input(
            "--points needs one ray per pixel; a composite with master has several; use --exr with --channels P",
        ));
    }
    if camera.is_curved() || camera.layers.len() > 1 || camera.optics.is_some() {
        return Err(Error::input("--points needs one straight ray per pixel; use --exr with --channels P,Z,t"));
    }
    Ok(())
}

fn has_extension(path: &Path, extension: &str) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case(extension))
}

/// Writes the points row by row: the hits and their triangles as PLY; or every pixel's as an array, NaN where there is none.
///
/// A point is `P + t D` of the camera's f64 ray. t is computed again in f64, from the plane of the frame's triangle, or from its sphere, where
/// they are at the pixel's time.
pub fn write(path: &Path, scene: &Scene, camera: &Camera, frame: &Frame) -> Result<()> {
    let ids = frame.u32(Channel::TriangleId).ok_or_else(|| Error::work("--points: the frame has no triangle ids"))?;
    let width = camera.width as usize;
    let of_pixel = |k: usize| Some((point(scene, camera, (k % width) as u32, (k / width) as u32, ids[k])?, ids[k]));
    let points: Vec<Option<(DVec3, u32)>> = parallel::map(0..ids.len(), of_pixel);
    if has_extension(path, "ply") {
        let hits: Vec<_> = points.into_iter().flatten().collect();
        return write_ply(path, &hits);
    }
    let numbers: Vec<f64> = points.iter().flat_map(|p| p.map_or([f64::NAN; 3], |(at, _)| at.to_array())).collect();
    write_npy(path, &[ids.len() as u64, 3], &numbers)
}

/// The intersection of the ray of pixel (i, j) with the triangle's plane, or the first one in range with the sphere or capsule.
fn point(scene: &Scene, camera: &Camera, i: u32, j: u32, id: u32) -> Option<DVec3> {
    if id == NO_ID {
        return None;
    }
    let ray = camera.ray(i, j)?;
    let t = match scene.primitive_at(id, scene.moment(camera, (i, j))) {
        Primitive::Triangle([a, b, c]) => {
            let normal = (b - a).cross(c - a);
            normal.dot(a - ray.origin) / normal.dot(ray.direction)
        }
        Primitive::Round(capsule) => {
            let [enters, leaves] = capsule.nearest_meetings(ray.origin, ray.direction);
            if enters < camera.t_range[0] { leaves } else { enters }
        }
    };
    t.is_finite().then(|| ray.origin + t * ray.direction)
}
