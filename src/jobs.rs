//! Renders from scene files to output files: a [`RenderJob`] as described by the flags of `anamorph render`, and [`batch`]es, which are
//! lists of them. [`Work`] performs a job: read and check, render on a device, write.

pub mod backend;
pub mod batch;
mod files;
pub mod gradients;
pub mod job;
pub mod judged;
mod memory;
#[cfg(feature = "cli")]
mod notes;
pub mod options;
pub mod outputs;
mod points;
pub mod project;
pub mod splat;
mod strips;
mod work;

pub use crate::engine::rival::EngineName;
pub use backend::{Backend, Kept, render_each};
#[cfg(feature = "cli")]
pub use files::{CAMERA, named_as};
pub use job::{Change, RenderJob};
#[cfg(feature = "cli")]
pub use job::{load, load_shape};
pub use memory::{check as check_memory, need as memory_need};
#[cfg(feature = "internals")]
pub use work::counted;
#[cfg(feature = "cli")]
pub use work::refuse_missing;
pub use work::{Seen, Work, Written};
