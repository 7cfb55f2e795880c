//! User input: files, values with their source positions, limits, and the error type.

pub mod error;
pub mod files;
pub mod keyframes;
pub mod limits;
pub mod load;
pub mod overrides;
pub mod parse;
pub mod reader;
pub mod tree;

pub use error::{Error, Result};
