//! The program `anamorph`; all of it is in [`anamorph::cli`].

fn main() -> std::process::ExitCode {
    anamorph::cli::main()
}
