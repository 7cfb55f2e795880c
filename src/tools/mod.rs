//! The program: its commands, its benchmarks, its examples and its report on an adapter.

pub mod bench;
pub mod cli;
pub mod example;
pub mod gpu_report;
