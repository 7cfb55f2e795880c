//! A multi-perspective renderer: triangles through cameras whose rays do not meet in a point, exactly, by compute
//! kernels alone.
//!
//! `docs/architecture.md` shows the layers, which are the modules of this crate, and how a frame flows through them;
//! `docs/reference/definitions.md` has the ray of every pixel of every camera and says what the channels mean.
//!
//! The image of a triangle under a bilinear piece is bounded by three conics: `E_ij = ((v_i - P) x (v_j - v_i)) . D` is
//! quadratic in the image place when P and D are affine. Coverage is three sign tests a pixel, without projecting
//! anything. Signs that a rounding bound does not prove in f32 are computed again in f64. A curved ray meets a triangle's plane at the
//! roots of a polynomial of its own degree, none of which is missed.
//!
//! A frame, on the GPU where there is one:
//!
//! ```
//! use anamorph::engine::{Engine, plan::Wanted};
//! use anamorph::{gpu::Gpu, image::frame::Channel, reference, scene::Scene};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # let folder = tempfile::tempdir()?;
//! # let path = folder.path().join("scene.toml");
//! # std::fs::write(&path, r#"
//! #   image = { width = 40, height = 30 }
//! #   mesh = [{ builtin = "icosphere", level = 2 }]
//! #   camera = { kind = "pinhole", eye = [0, 0, 4], target = [0, 0, 0], vfov = 40 }
//! # "#)?;
//! let scene = Scene::load(&path, &["camera.vfov=30".into()], 0.0)?;
//! let camera = scene.camera()?;
//! let channels = vec![Channel::T, Channel::TriangleId];
//! let frame = match Gpu::open(&Default::default())? {
//!     Some(gpu) => {
//!         let wanted = Wanted::of(channels);
//!         Engine::new(gpu).render(&scene, &camera, &wanted, &Default::default())?.frame
//!     }
//!     None => reference::image::image(&scene, &camera, &channels),
//! };
//! let middle = frame.f32(Channel::T).ok_or("asked for")?[15 * 40 + 20];
//! assert!((middle - 3.0).abs() < 0.1, "the ball of radius 1 begins at z = 1");
//! # Ok(())
//! # }
//! ```

pub mod camera;
pub mod engine;
pub mod geometry;
pub mod gpu;
pub mod image;
pub mod input;
pub mod reference;
pub mod rivals;
pub mod scene;
pub mod tools;
pub mod twin;

pub use crate::input::{Error, Result};

/// The README's example, compiled.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
mod readme {}
