//! The program: its commands, example scenes, scenes for the user's own models, the self-test, and the schema of scene files.

pub mod cli;
pub mod example;
pub mod new;
pub mod process;
pub mod schema;
pub mod self_test;
