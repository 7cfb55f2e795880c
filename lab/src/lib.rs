//! The laboratory of anamorph: code that compares the engine with other techniques, measures it, and checks it stage by stage.
//!
//! It depends on the product's internals, and nothing of the product depends on it. `docs/architecture.md` lists its parts.

/// [`Parts`](anamorph::internals::gpu::kernels::Parts) of kernels, by the names of their files under `lab/wgsl`.
macro_rules! snippets {
    ($($name:literal),+) => {{
        use anamorph::internals::gpu::kernels::{Parts, Snippet};
        const PARTS: Parts = &[
            $(&Snippet { name: $name, text: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/wgsl/", $name)) }),+
        ];
        PARTS
    }};
}

pub mod bench;
pub mod control;
pub mod gallery;
pub mod gpu_report;
pub mod operations;
pub mod rivals;
pub mod twin;
