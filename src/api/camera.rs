//! Cameras, and projection of points.

use super::project::refuse_optics;
use super::{CameraBuilder, Scene};
use crate::arrays::MapEach;
use crate::camera::Field;
use crate::camera::kinds::raymap::RayArrays;
use crate::camera::kinds::{KINDS, calibrated};
use crate::camera::project::{Images, Projector};
use crate::camera::spec::CameraSpec;
use crate::image::frame::Channel;
use crate::image::size::check_size;
use crate::input::tree::Node;
use crate::input::{Error, Loading, Result};
use crate::parallel;
use crate::scene::file::{self, CameraKeys};
use glam::DVec3;
use std::path::Path;
use std::sync::Arc;

/// A camera for an image of one size: each pixel has a ray, a curve, or none. `docs/reference/cameras.md` lists the kinds.
#[derive(Debug, Clone)]
pub struct Camera {
    pub(super) camera: Arc<crate::camera::Camera>,
    /// Its table, if it has one.
    pub(super) keys: Arc<CameraKeys>,
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
        let loading = Loading::new(scene.scene.limits);
        let spec = file::camera_of(&table, folder, &loading)?;
        let camera = Camera::of_spec(&spec, size.or(scene.scene.size), scene, &loading)?;
        Ok(Camera { keys: Arc::new(CameraKeys::of_table(table, folder)), ..camera })
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
        let vectors = |list: &[[f64; 3]]| list.iter().map(|v| DVec3::from_array(*v)).collect::<Vec<_>>();
        let field = Field::new(width, height, &vectors(origins), &vectors(directions))?;
        let kind = RayArrays { field: Arc::new(field) }.into();
        Camera::of_spec(&CameraSpec { kind, t_range }, None, &Scene::new(), &Loading::default())
    }

    fn of_spec(spec: &CameraSpec, size: Option<(u32, u32)>, scene: &Scene, loading: &Loading) -> Result<Camera> {
        let camera = crate::camera::Camera::in_scene(spec, size, scene.scene.surroundings(), loading)?;
        Ok(Camera { camera: Arc::new(camera), keys: Arc::default() })
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
    let points: Vec<DVec3> = points.iter().map(|point| DVec3::from_array(*point)).collect();
    Ok(Projector::project_all(&camera.camera, &points))
}
