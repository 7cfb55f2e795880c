//! Renders from a scene file to written files: one [`RenderJob`], as `anamorph render` describes it, and lists of them, which are
//! [`batch`]es. A job is [`Work`]: read and checked, rendered on a device, written.

pub mod backend;
pub mod batch;
mod files;
pub mod job;
mod judged;
mod memory;
pub mod outputs;
mod points;
pub mod samples;
mod strips;
pub mod words;
mod work;

pub use backend::Backend;
pub use files::CAMERA;
pub use job::{Change, EngineName, RenderJob, load, load_shape};
pub use memory::check as check_memory;
pub use work::{Seen, Work, Written, refuse_missing};
