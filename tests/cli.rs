//! The program as a user runs it: good runs leave whole files, bad ones one line on stderr and nothing else.

#[path = "common/needs.rs"]
mod needs;

/// The program that these tests run.
const PROGRAM: &str = env!("CARGO_BIN_EXE_anamorph");

mod cli {
    pub mod bad;
    pub mod batch;
    pub mod docs;
    pub mod drawn;
    pub mod good;
    pub mod headers;
    pub mod inputs;
    #[cfg(unix)]
    pub mod lab;
    pub mod limits;
    pub mod messages;
    pub mod models;
    pub mod outputs;
    pub mod program;
    pub mod widths;
}
