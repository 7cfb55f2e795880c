//! User input: files, values with their source positions, limits, and the error type.

pub mod error;
pub mod files;
pub mod keyframes;
pub mod limits;
pub mod load;
pub mod loading;
pub mod overrides;
pub mod parse;
pub mod prefix;
pub mod reader;
pub mod tree;
pub mod window;

pub use error::{Error, Result};
pub use limits::Limits;
pub use loading::Loading;
pub use prefix::Prefix;
pub use window::Window;
