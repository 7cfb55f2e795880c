//! The program: its commands, its benchmarks and its examples.

pub mod bench;
pub mod cli;
pub mod example;
