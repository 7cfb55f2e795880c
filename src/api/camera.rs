//! Cameras, and projection of points.

use super::project::refuse_optics;
use super::{CameraBuilder, Scene};
use crate::arrays::MapEach;
use crate::camera::Field;
use crate::camera::kinds::raymap::RayArrays;
use crate::camera::kinds::{KINDS, calibrated};
use crate::camera::project::{Images, Projector};
use crate::camera::spec::{CameraKind, CameraSpec};
use crate::engine::call_ms::ms_since;
use crate::image::frame::Channel;
use crate::image::size::check_size;
use crate::input::tree::Node;
use crate::input::{Error, Loading, Result};
use crate::parallel;
use crate::scene::file::{self, CameraKeys};
use bytemuck::cast_slice;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

/// A camera for an image of one size: each pixel has a ray, a curve, or none. `docs/reference/cameras.md` lists the kinds.
#[derive(Debug, Clone)]
pub struct Camera {
    pub(super) camera: Arc<crate::camera::Camera>,
    /// Its table, if it has one.
    pub(super) keys: Arc<CameraKeys>,
    /// Time that it took to compile, until a call has counted it.
    pub(super) compile_ms: Uncounted,
}

/// Milliseconds that one call counts.
#[derive(Debug, Clone, Default)]
pub(super) struct Uncounted(Arc<AtomicU64>);

impl Uncounted {
    pub fn since(moment: Instant) -> Uncounted {
        Uncounted(Arc::new(AtomicU64::new(ms_since(moment).to_bits())))
    }

    /// The time for the first that asks; 0 for all others.
    pub fn take(&self) -> f64 {
        f64::from_bits(self.0.swap(0, Ordering::Relaxed))
    }
}

impl Camera {
    /// The camera of the keys of a scene file's `[camera]`, for an image of `size` or of the scene's: a table in TOML, or in JSON where it
    /// begins with a brace. Relative paths in it start from `folder`. Of the scene it depends only where the kind says so, as `track`; its limits are
    /// the scene's.
    ///
    /// # Errors
    /// [`Error::Input`] for a wrong key, values that contradict each other, or no size; [`Error::Missing`] or [`Error::Read`] for a file that cannot be read.
    pub fn parse(table: &str, folder: impl AsRef<Path>, scene: &Scene, size: Option<(u32, u32)>) -> Result<Camera> {
        Camera::of_table(file::parse_table(table)?, folder.as_ref(), scene, size)
    }

    /// A camera of this kind from typed values instead of text: see [`CameraBuilder`].
    pub fn builder(kind: &str) -> CameraBuilder {
        CameraBuilder::new(kind)
    }

    /// The camera of a parsed table, as [`Camera::parse`] and [`CameraBuilder::build`] make it.
    pub(super) fn of_table(table: Node, folder: &Path, scene: &Scene, size: Option<(u32, u32)>) -> Result<Camera> {
        let started = Instant::now();
        let loading = Loading::new(scene.scene.limits);
        let spec = file::camera_of(&table, folder, &loading)?;
        scene.cameras.next_scene();
        let (key, mesh) = ((spec, size.or(scene.scene.size)), &scene.scene.mesh);
        let camera = scene.cameras.get(key, mesh, scene.scene.surroundings(), true, &loading)?;
        let keys = Arc::new(CameraKeys::of_table(table, folder));
        Ok(Camera::compiled(camera, keys, started))
    }

    /// A camera of given rays `P + t D`, one for each of `width x height` pixels, row by row from the top; `t_range` has the ends of t. A pixel
    /// whose ray is not finite, or whose D is 0, has no ray.
    ///
    /// # Errors
    /// [`Error::Input`] if there are not so many rays, none of them is finite, or the range has no finite t.
    pub fn of_rays(
        (width, height): (usize, usize),
        origins: &[[f64; 3]],
        directions: &[[f64; 3]],
        t_range: [f64; 2],
    ) -> Result<Camera> {
        let started = Instant::now();
        let (pixels, own, other) = (width.saturating_mul(height), origins.len(), directions.len());
        if (own, other) != (pixels, pixels) {
            let rays = format!("{own} origins and {other} directions");
            return Err(Error::input(format!("{rays} for {width} x {height} pixels; give one each a pixel")));
        }
        check_size(width as u64, height as u64)?;
        // within the size's limits
        let (width, height) = (width as u32, height as u32);
        let [first, last] = t_range;
        if !(first <= last && first < f64::INFINITY && last > f64::NEG_INFINITY) {
            return Err(Error::input(format!("t_range: [{first}, {last}] holds no finite t; use e.g. [0, inf]")));
        }
        let field = Field::new(width, height, cast_slice(origins), cast_slice(directions))?;
        let kind = CameraKind::new("raymap", RayArrays { field: Arc::new(field) });
        let camera = crate::camera::Camera::new(&CameraSpec { kind, t_range }, None)?;
        Ok(Camera::compiled(Arc::new(camera), Arc::default(), started))
    }

    /// A camera whose compilation began at `started`.
    pub(super) fn compiled(camera: Arc<crate::camera::Camera>, keys: Arc<CameraKeys>, started: Instant) -> Camera {
        Camera { camera, keys, compile_ms: Uncounted::since(started) }
    }

    /// The `kind` key of a scene file.
    pub fn kind(&self) -> &str {
        self.camera.kind
    }

    /// Pixels.
    pub fn width(&self) -> u32 {
        self.camera.width
    }

    /// Pixels.
    pub fn height(&self) -> u32 {
        self.camera.height
    }

    /// Number of pieces (general linear cameras, or pieces of curves) of its image; 0 if each pixel has its own ray.
    pub fn piece_count(&self) -> usize {
        self.camera.piece_count()
    }

    /// The channels of its images, for [`RenderOptions::channels`](super::RenderOptions::channels).
    pub fn channels(&self) -> Vec<Channel> {
        self.camera.channels()
    }

    /// Origin P and direction D of the ray `P + t D` through the centre of pixel (column, row), row 0 on top, in world axes and units; for
    /// a curved ray its chord. `None` if the pixel has no ray or lies outside the image.
    pub fn ray(&self, column: u32, row: u32) -> Option<[[f64; 3]; 2]> {
        if column >= self.camera.width || row >= self.camera.height {
            return None;
        }
        self.camera.ray(column, row).map(|ray| [ray.origin.to_array(), ray.direction.to_array()])
    }

    /// Origins and directions of all of them, row by row from the top; NaN where a pixel has no ray.
    pub fn rays(&self) -> [Vec<[f64; 3]>; 2] {
        let width = self.camera.width;
        let none = [[f64::NAN; 3]; 2];
        let ray = |k: u32| self.ray(k % width, k / width).unwrap_or(none);
        let both: Vec<[[f64; 3]; 2]> = parallel::map(0..width * self.camera.height, ray);
        [0, 1].map_each(|k| both.iter().map(|ray| ray[k]).collect())
    }
}

/// Each kind of camera, with its help: a line, its keys, and its formula.
pub fn camera_kinds() -> impl Iterator<Item = (&'static str, String)> {
    KINDS.iter().map(|kind| (kind.name, kind.whole_help()))
}

/// The names of the images of a COLMAP model, in order: values of `image` for cameras of kind `calibrated`. `folder` has `cameras` and
/// `images` as .bin or .txt, or is a file with images, such as `transforms.json`.
///
/// # Errors
/// [`Error::Missing`] or [`Error::Read`] if the file of images cannot be read; [`Error::Input`] if it has no images.
pub fn colmap_images(folder: impl AsRef<Path>) -> Result<Vec<String>> {
    calibrated::file::images(folder.as_ref(), &Loading::default())
}

/// All images of each point (world units): every place whose ray, or curve, passes through it.
///
/// # Errors
/// [`Error::Input`] for a camera with a mirror or a lens.
pub fn project(camera: &Camera, points: &[[f64; 3]]) -> Result<Vec<Images>> {
    refuse_optics(camera)?;
    Ok(Projector::project_all(&camera.camera, cast_slice(points)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(keys: &str, folder: &Path, scene: &Scene) -> Arc<crate::camera::Camera> {
        Camera::parse(keys, folder, scene, Some((32, 24))).unwrap().camera
    }

    #[test]
    fn equal_cameras_are_compiled_once() {
        let scene =
            Scene::parse("mesh = [{ builtin = 'box' }]\ncamera = { kind = 'panorama', radius = 4, height = 3 }", ".")
                .unwrap();
        let keys = "kind = 'fisheye'\nfov = 120\neye = [0, 0, 4]\ntarget = [0, 0, 0]";
        let first = parse(keys, ".".as_ref(), &scene);
        // a clone of the scene shares them, and so does a scene whose mesh has moved
        let mut moved = scene.clone();
        moved.move_object("box", [[1.0, 0.0, 0.0, 1.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]]).unwrap();
        for scene in [&scene, &moved] {
            assert!(Arc::ptr_eq(&first, &parse(keys, ".".as_ref(), scene)));
        }
        assert!(!Arc::ptr_eq(&first, &parse(&keys.replace("120", "121"), ".".as_ref(), &scene)));
        assert!(!Arc::ptr_eq(&first, &Camera::parse(keys, ".", &scene, Some((32, 25))).unwrap().camera));
    }

    #[test]
    fn a_camera_is_compiled_again_for_another_scene_or_file() {
        let scene =
            Scene::parse("mesh = [{ builtin = 'box' }]\ncamera = { kind = 'panorama', radius = 4, height = 3 }", ".")
                .unwrap();
        let track = "kind = 'track'\neye = [0, 0, 9]\ntarget = [0, 0, 0]\nvfov = 40\ntargets = [{ at = [0, 0, -3], radius = 0.5 }]";
        let first = parse(track, ".".as_ref(), &scene);
        assert!(Arc::ptr_eq(&first, &parse(track, ".".as_ref(), &scene)));
        let mut moved = scene.clone();
        moved.move_object("box", [[1.0, 0.0, 0.0, 1.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]]).unwrap();
        assert!(!Arc::ptr_eq(&first, &parse(track, ".".as_ref(), &moved)));

        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, x: f32| {
            let file = folder.path().join(name);
            crate::image::write_npy(&file, &[2, 2, 3], &[x; 12]).unwrap();
        };
        write("origins.npy", 0.0);
        write("directions.npy", 1.0);
        let keys = "kind = 'raymap'\norigins = 'origins.npy'\ndirections = 'directions.npy'";
        let raymap = || Camera::parse(keys, folder.path(), &scene, None).unwrap().camera;
        let first = raymap();
        assert!(Arc::ptr_eq(&first, &raymap()));
        write("directions.npy", 2.0);
        assert!(!Arc::ptr_eq(&first, &raymap()));
    }
}
