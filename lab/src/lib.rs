//! The laboratory of anamorph: code that compares the engine with other techniques, measures it, and checks it stage by stage.
//!
//! It depends on the product's internals, and nothing of the product depends on it. `docs/architecture.md` lists its parts.

pub mod bench;
pub mod control;
mod files;
pub mod gallery;
pub mod gpu_report;
pub mod operations;
pub mod rivals;
pub mod twin;
