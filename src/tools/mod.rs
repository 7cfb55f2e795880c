//! The program: its commands, its benchmarks, its examples, its scenes for the user's own models, its report on an
//! adapter, and the schema of scene files.

pub mod bench;
pub mod cli;
pub mod example;
pub mod gpu_report;
pub mod new;
pub mod schema;
