//! The program: its commands, its benchmarks, its examples, its report on an adapter, and its page in the browser.

pub mod bench;
pub mod cli;
mod drawing;
pub mod example;
pub mod gpu_report;
#[cfg(feature = "view")]
pub mod view;
