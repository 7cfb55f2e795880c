//! What a user gives: files, values with the place they came from, limits, and the one error type.

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
