//! A multi-perspective renderer: triangles through cameras whose rays do not meet in a point, exactly, by compute
//! kernels alone.
//!
//! A [`Scene`] is loaded from a file or parsed from text; [`Mesh`]es made from arrays can be added. Its [`Camera`] gives each pixel a
//! ray or a curve. A [`Renderer`] renders it to arrays, on a GPU or on the CPU. A [`Job`] renders a scene file to image files, and a
//! [`Batch`] runs a list of jobs. `docs/reference/definitions.md` defines the ray of every pixel of every camera, and the channels.
//!
//! Arrays of a scene:
//!
//! ```
//! use anamorph::{Channel, Mesh, RenderOptions, Renderer, Scene};
//!
//! # fn main() -> anamorph::Result<()> {
//! let mut scene = Scene::parse(r#"
//!     image = { width = 40, height = 30 }
//!     camera = { kind = "pinhole", eye = [0, 0, 4], target = [0, 0, 0], vfov = 30 }
//! "#, ".")?;
//! let square = vec![[-1.0, -1.0, 1.0], [1.0, -1.0, 1.0], [1.0, 1.0, 1.0], [-1.0, 1.0, 1.0]];
//! scene.add(Mesh::new(square, vec![[0, 1, 2], [0, 2, 3]])?)?;
//! let camera = scene.camera()?;
//! let options = RenderOptions { channels: vec![Channel::Z, Channel::TriangleId], ..Default::default() };
//! let rendered = Renderer::new()?.render(&scene, &camera, &options)?;
//! // row by row from the top
//! let depth = rendered.frame.f32(Channel::Z).expect("asked for")[15 * 40 + 20];
//! assert!((depth - 3.0).abs() < 0.01, "the square stands at z = 1, the eye at z = 4");
//! # Ok(())
//! # }
//! ```
//!
//! One camera over many frames: what does not change from frame to frame stays on the device.
//!
//! ```
//! # use anamorph::{RenderOptions, Renderer, Scene};
//! # fn main() -> anamorph::Result<()> {
//! # let folder = tempfile::tempdir().expect("a folder");
//! # let path = folder.path().join("scene.toml");
//! # std::fs::write(&path, r#"
//! #   image = { width = 40, height = 30 }
//! #   mesh = [{ builtin = "icosphere", level = 2 }]
//! #   camera = { kind = "fisheye", fov = 180, target = [0, 0, 0],
//! #              eye = [{ frame = 0, value = [0, 0, 4] }, { frame = 9, value = [4, 0, 0] }] }
//! # "#).expect("written");
//! let mut renderer = Renderer::new()?;
//! let options = RenderOptions { color: true, ..Default::default() };
//! for frame in 0..3 {
//!     let scene = Scene::load(&path, &["camera.fov=170"], f64::from(frame))?;
//!     let rendered = renderer.render(&scene, &scene.camera()?, &options)?;
//!     rendered.write_png(folder.path().join(format!("{frame}.png")))?;
//! }
//! # Ok(())
//! # }
//! ```
//!
//! Where a camera shows points, and the error of a frame against the reference:
//!
//! ```
//! # use anamorph::{Channel, RenderOptions, Renderer, Scene};
//! # fn main() -> anamorph::Result<()> {
//! # let scene = Scene::parse(r#"
//! #   image = { width = 40, height = 30 }
//! #   mesh = [{ builtin = "icosphere", level = 2 }]
//! #   camera = { kind = "fisheye", eye = [0, 0, 4], target = [0, 0, 0], fov = 120 }
//! # "#, ".")?;
//! # let camera = scene.camera()?;
//! let images = anamorph::project(&camera, &[[0.0, 0.0, 0.0], [1.0, 0.5, 0.0]])?;
//! assert!(images.iter().all(|of_point| !of_point.images.is_empty()));
//!
//! let options = RenderOptions { channels: camera.channels(), ..Default::default() };
//! let rendered = Renderer::new()?.render(&scene, &camera, &options)?;
//! let error = anamorph::check(&scene, &camera, &rendered.frame)?;
//! assert_eq!(error.wrong_safe, Some(0), "pixels whose triangle rounding cannot change are all right");
//! # Ok(())
//! # }
//! ```
//!
//! # Features
//!
//! `cli` (default): the program `anamorph`, with what only it needs. `view` (default): `Viewer`, a page in the browser, and the program's
//! command for it. `simplify` (by `cli`): the key `facets` of mirrors and lenses, and glTF whose buffers are compressed, by
//! meshoptimizer, which takes a C++ compiler. `draco` (by `cli`): glTF whose meshes are compressed by Draco. `internals`: what this project's own tests and its laboratory use; it may
//! change at any time.

#![cfg_attr(not(feature = "internals"), deny(missing_docs))]

mod api;
mod arrays;
mod camera;
mod engine;
mod geometry;
mod gpu;
mod image;
mod input;
mod jobs;
mod parallel;
mod reference;
mod scene;
#[cfg(test)]
mod testing;
#[cfg(feature = "cli")]
mod tools;
#[cfg(feature = "view")]
mod view;

#[cfg(feature = "internals")]
#[doc(hidden)]
pub mod internals;

pub use crate::api::*;
pub use crate::input::{Error, Result};
#[cfg(feature = "cli")]
#[doc(hidden)]
pub use crate::tools::{
    cli::main as program,
    process::{ExitWhenFull, keep_window_system_quiet},
};

/// The README's example, compiled.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
mod readme {}
