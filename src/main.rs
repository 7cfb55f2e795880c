//! The program `anamorph`; all of it is in `src/tools/cli`.

use anamorph::ExitWhenFull;

#[global_allocator]
static ALLOCATOR: ExitWhenFull = ExitWhenFull;

fn main() -> std::process::ExitCode {
    anamorph::keep_window_system_quiet();
    std::process::ExitCode::from(anamorph::program(std::env::args_os().collect()))
}
