//! How kernels are made: a kernel is its bindings and the snippets that it is joined from; which ones, its stage says
//! (`engine/stage`), for a variant.
//!
//! A kernel's module is its bindings, generated, and the plain concatenation of its snippets. Each snippet names
//! at its top what it provides, and what it needs of the others and of the bindings. Variants swap a snippet that provides the same
//! functions, or set an `override` constant.

mod kernel;
mod optics;
pub mod parts;
mod samples;
mod surfaces;
mod variant;
pub use kernel::{Access, Binding, Kernel, Parts, Snippet};
pub use optics::OpticsKind;
pub use variant::{LightsKind, Method, RaysKind, SurfaceKind, Variant, VolumeKind};
