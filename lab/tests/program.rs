//! The program `anamorph-lab` as a user runs it.

#[path = "../../tests/common/needs.rs"]
mod needs;

/// The program that these tests run.
const PROGRAM: &str = env!("CARGO_BIN_EXE_anamorph-lab");

mod program {
    pub mod engines;
    pub mod gpu_report;
    #[path = "../../../tests/cli/program.rs"]
    pub mod place;
}
