//! A multi-perspective renderer: triangles through cameras whose rays do not meet in a point, exactly, by compute
//! kernels alone.
//!
//! ```text
//! scene file --scene--> Scene: triangles in f64, lights, camera spec
//!                         |
//!            camera: layers, each an image cut into pieces with an affine bundle of rays; or a ray or curve a pixel
//!                         |
//!            plan: bands of the image, slabs (layers, spans of curves) of tiles, cells (piece x tile), a tree of
//!                  nodes with bounds on their rays
//!                         |                                                          host, f64
//! ------------------------+-----------------------------------------------------------------
//!                         |                                                          GPU, one submission
//!            cull:   clusters of triangles x nodes          -> work items
//!            bin:    triangles of a cluster x tiles         -> (triangle, tile) pairs
//!            raster: pairs, one by one or tile by tile      -> visibility buffer: (layer, t, id) a pixel; items to recheck
//!            recheck: what f32 did not prove, in f64        -> visibility buffer
//!            (certify: what is proven of it, where asked)
//!            shade:  visible triangle of each pixel         -> planes: colour, depth, ids
//!            write:  colour                                 -> 8-bit sRGB
//! ------------------------+-----------------------------------------------------------------
//!                         |
//!            engine: looks at the counters, grows lists that ran over, reads the image
//!                         |
//!            output: PNG, EXR;  compare: error against another frame
//! ```
//!
//! The image of a triangle under a bilinear piece is bounded by three conics: `E_ij = ((v_i - P) x (v_j - v_i)) . D` is
//! quadratic in the image place when P and D are affine. Coverage is three sign tests a pixel, without projecting
//! anything; signs that a rounding bound does not prove are left to `recheck`, in f64. The channel `certified` says which pixels
//! are proven: `certify` bounds every hit from both sides and holds what was found against all that may lie before it. A curved ray meets a triangle's plane at the
//! roots of a polynomial of its own degree, none of which is missed.
//!
//! Three layers keep it true: [`mod@reference`] (one f64 ray or curve a pixel, no pieces' tricks), the twins of the stages in
//! f64 ([`twin`]), and the kernels in `wgsl/`.
//!
//! Light that a mirror or a lens turns onto the scene ([`caustics`]) is followed before the first frame, by a frame of a camera
//! at the light: `deposit` adds up what falls where, and after `shade` `gather` shows it.
//!
//! Other ways to find what each pixel sees, the papers' and ray tracing, take the place of the stages from cull to recheck in [`baseline`];
//! [`bench`](mod@bench) measures error against run time of all of them.
//!
//! Where a camera shows given points is another question ([`camera::project`]), answered in f64; for many points the
//! kernel `sift` finds the parts of the image to look at.
//!
//! A frame, on the GPU where there is one:
//!
//! ```
//! use anamorph::{engine::Engine, frame::Channel, gpu::Gpu, plan::Wanted, reference, scene::Scene};
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
