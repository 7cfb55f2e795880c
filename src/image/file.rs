//! Output files: whole or not there, and removed if they are unfinished.

pub mod place;
mod stream;
pub mod unfinished;
pub mod whole;
