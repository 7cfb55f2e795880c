//! Gradients of a frame.

use super::renderer::Renderer;
use super::{Camera, Scene};
use crate::engine::combinations;
use crate::engine::plan::Wanted;
use crate::image::frame::Channel;
use crate::input::{Error, Result};
use crate::jobs::gradients::{described, gradients_of};
use crate::jobs::{RenderJob, check_memory};
use crate::scene::gradients::{Asked, Of, Quantity};

pub use crate::scene::gradients::{Array as GradientArray, Gradients, Numbers, Parameter as GradientParameter};

impl Gradients {
    /// The array of this name, such as `depth.vertices`: its shape, and its numbers in C order.
    pub fn f32(&self, name: &str) -> Option<(&[usize], &[f32])> {
        match self.arrays.iter().find(|array| array.name == name)? {
            GradientArray { shape, numbers: Numbers::F32(numbers), .. } => Some((shape, numbers)),
            _ => None,
        }
    }

    /// The same of an array of ids or pixels, such as `coverage.triangle`.
    pub fn u32(&self, name: &str) -> Option<(&[usize], &[u32])> {
        match self.arrays.iter().find(|array| array.name == name)? {
            GradientArray { shape, numbers: Numbers::U32(numbers), .. } => Some((shape, numbers)),
            _ => None,
        }
    }

    /// The names and shapes of all arrays, and the numbers of the camera, as JSON: `docs/guide/gradients.md`.
    ///
    /// # Errors
    /// [`Error::Work`] for a number that JSON does not have.
    pub fn json(&self) -> Result<String> {
        described(self)
    }
}

impl Renderer {
    /// How what each pixel shows changes with the corners of its triangle, and with numbers of the camera: `docs/reference/definitions.md`,
    /// Gradients. `quantities` are `depth`, `t`, `position`, `barycentrics` and `coverage`; `of` names what they are by: `vertices`, and numbers
    /// of the camera's table, such as `camera.vfov` or `camera.eye.0`, or of its calibration file, such as `camera.fx`.
    ///
    /// The frame with the triangle of each pixel is rendered first. Lengths are in world units, angles in degrees as in the table, image places
    /// in pixels.
    ///
    /// ```
    /// # use anamorph::{Renderer, Scene};
    /// # fn main() -> anamorph::Result<()> {
    /// let scene = Scene::parse(r#"
    ///     image = { width = 40, height = 30 }
    ///     mesh = [{ builtin = "icosphere", level = 2 }]
    ///     camera = { kind = "fisheye", eye = [0, 0, 4], target = [0, 0, 0], fov = 60 }
    /// "#, ".")?;
    /// let of = ["vertices", "camera.fov", "camera.eye.2"];
    /// let gradients = Renderer::new()?.gradients(&scene, &scene.camera()?, &["depth", "coverage"], &of)?;
    /// let (shape, numbers) = gradients.f32("depth.camera").expect("asked for");
    /// assert_eq!(shape, [30, 40, 2]);
    /// // in the middle of the ball: the depth grows as the eye moves away
    /// assert!((numbers[2 * (15 * 40 + 20) + 1] - 1.0).abs() < 0.05);
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// [`Error::Input`] for an unknown name, a number that the camera has not, or that its rays do not change smoothly with, or a scene and a camera
    /// without gradients (`docs/reference/combinations.md`); [`Error::Work`] if memory does not suffice or the device is lost.
    pub fn gradients(&mut self, scene: &Scene, camera: &Camera, quantities: &[&str], of: &[&str]) -> Result<Gradients> {
        let quantities = quantities.iter().map(|name| Quantity::named(name)).collect::<std::result::Result<_, _>>();
        let of = of.iter().map(|name| Of::named(name)).collect::<std::result::Result<_, _>>();
        let asked = Asked::new(quantities.map_err(Error::Input)?, of.map_err(Error::Input)?)?;
        let (scene, rays) = (&scene.scene, &camera.camera);
        let plain = Wanted::of(vec![Channel::TriangleId]);
        let wanted = Wanted { gradients: true, coverage_gradients: asked.has_coverage(), ..plain.clone() };
        combinations::Asked::new(scene, rays, &wanted).check()?;
        let (size, limits) = ((rays.width, rays.height), scene.limits);
        check_memory(size, plain.channels.len() + 3, 0, limits)?;
        asked.check_memory(size, limits)?;
        self.recover()?;
        let rendered = self.render_frame(scene, rays, &plain)?;
        let ids = rendered.frame.u32(Channel::TriangleId).ok_or_else(|| Error::work("the frame has no triangles"))?;
        let backend = self.backend(&RenderJob::of(""))?;
        gradients_of(&backend, (scene, rays, &camera.keys), ids, &asked)
    }
}
