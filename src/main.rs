//! The program `anamorph`; all of it is in [`anamorph::cli`].

fn main() -> std::process::ExitCode {
    keep_window_system_quiet();
    anamorph::cli::main()
}

/// Vulkan's device-select layer asks for a Wayland display, whose client library complains on stderr where this
/// variable is missing, as on a machine without a desktop. A folder that does not exist is no display either, silently.
fn keep_window_system_quiet() {
    const VARIABLE: &str = "XDG_RUNTIME_DIR";
    if std::env::var_os(VARIABLE).is_none_or(|v| !v.as_encoded_bytes().starts_with(b"/")) {
        // SAFETY: no other thread runs yet.
        unsafe { std::env::set_var(VARIABLE, "/nonexistent") };
    }
}
