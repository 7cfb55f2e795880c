//! A multi-perspective renderer: triangles through cameras whose rays do not meet in a point, exactly, by compute
//! kernels alone.
//!
//! ```text
//! scene file --scene--> Scene: triangles in f64, lights, camera spec
//!                         |
//!            camera: an image cut into pieces, each an affine bundle of rays; or a ray a pixel
//!                         |
//!            plan: bands of the image, tiles, cells (piece x tile), a tree of nodes with bounds on their rays
//!                         |                                                          host, f64
//! ------------------------+-----------------------------------------------------------------
//!                         |                                                          GPU, one submission
//!            cull:   clusters of triangles x nodes          -> work items
//!            bin:    triangles of a cluster x tiles         -> (triangle, cell) pairs
//!            raster: pairs, pixel by pixel                  -> visibility buffer: (t, id) a pixel
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
//! anything; signs that a rounding bound does not prove are taken again in f64.
//!
//! Three layers keep it true: [`reference`] (one f64 ray a pixel, no pieces' tricks), the twins of the stages in
//! f64 (`twin`), and the kernels in `wgsl/`.

pub mod camera;
pub mod cli;
pub mod compare;
pub mod engine;
pub mod error;
pub mod example;
pub mod frame;
pub mod gpu;
pub mod output;
pub mod plan;
pub mod reference;
pub mod report;
pub mod scene;
pub mod stage;

pub use error::{Error, Result};

/// Pixels a side of a tile.
pub const TILE: u32 = 8;
