//! The process of a program: its environment, its allocator, and its end when memory runs out.

use std::alloc::{GlobalAlloc, Layout, System};
use std::io::Write;

/// Vulkan's device-select layer asks for a Wayland display, whose client library complains on stderr where this
/// variable is missing, as on a machine without a desktop. A folder that does not exist is no display either, silently.
pub fn keep_window_system_quiet() {
    const VARIABLE: &str = "XDG_RUNTIME_DIR";
    if std::env::var_os(VARIABLE).is_none_or(|v| !v.as_encoded_bytes().starts_with(b"/")) {
        // SAFETY: no other thread runs yet.
        unsafe { std::env::set_var(VARIABLE, "/nonexistent") };
    }
}

/// Address space that glibc reserves while it makes an arena for a thread: twice an arena's heap, which is aligned to its own size.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
const ARENA_BYTES: u64 = 128 << 20;

/// Lets glibc make no more arenas than fit a quarter of the process's address space, if that is limited (`ulimit -v`). A thread that finds no room
/// for an arena of its own would ask the system for a page at every allocation, which is thousands of times slower: work would not end
/// instead of being refused. To be called before threads are started.
pub fn fit_arenas_to_address_space() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    if let Some(bytes) = crate::input::limits::address_space() {
        let arenas = libc::c_int::try_from(bytes / 4 / ARENA_BYTES).unwrap_or(libc::c_int::MAX).max(1);
        // SAFETY: sets a number of the allocator. If it is refused, allocations are only slower.
        unsafe { libc::mallopt(libc::M_ARENA_MAX, arenas) };
    }
}

/// The system's allocator. If it has no more memory, the program prints one line and exits with code 1, instead of aborting by a
/// signal. Work that is known to be too large is refused before it begins: see `src/input/limits.rs`.
pub struct ExitWhenFull;

impl ExitWhenFull {
    fn checked(pointer: *mut u8, bytes: usize) -> *mut u8 {
        if pointer.is_null() {
            // stderr is unbuffered and numbers are formatted in place: nothing here allocates
            let _ = writeln!(
                std::io::stderr(),
                "error: out of memory: cannot allocate {bytes} bytes more; make the image or the scene smaller"
            );
            // SAFETY: ends the process. Not `exit`: it runs handlers of drivers, which may allocate or wait for a thread.
            unsafe { libc::_exit(1) }
        }
        pointer
    }
}

// SAFETY: every call is passed to the system's allocator with the same arguments, and its result is returned.
unsafe impl GlobalAlloc for ExitWhenFull {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ExitWhenFull::checked(unsafe { System.alloc(layout) }, layout.size())
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        ExitWhenFull::checked(unsafe { System.alloc_zeroed(layout) }, layout.size())
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        ExitWhenFull::checked(unsafe { System.realloc(pointer, layout, size) }, size)
    }
}
