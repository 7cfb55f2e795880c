//! The program: its commands, its benchmarks, its examples, its scenes for the user's own models, and its report on
//! an adapter.

pub mod bench;
pub mod cli;
pub mod example;
pub mod gpu_report;
pub mod new;
