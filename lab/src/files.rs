//! The laboratory's WGSL files, beside the product's.

use anamorph::internals::gpu::kernels::{Files, Kernel, Variant};
use include_dir::{Dir, include_dir};
use std::sync::LazyLock;

static WGSL: Dir = include_dir!("$CARGO_MANIFEST_DIR/wgsl");

/// The product's files and the laboratory's.
pub fn files() -> &'static Files {
    static FILES: LazyLock<Files> = LazyLock::new(|| Files::own().with(&WGSL));
    &FILES
}

/// Interfaces with the implementations that a kernel has, whatever its variant.
pub type Chosen<'a> = &'a [(&'a str, &'static [&'static str])];

/// A kernel with its own implementations and constants; the others are the variant's.
pub fn kernel(entry: &'static str, variant: Variant, chosen: Chosen, constants: &[(&str, f64)]) -> Kernel {
    let choose = |interface: &str| {
        let own = chosen.iter().find(|(name, _)| *name == interface);
        own.map_or_else(|| variant.implementations(interface), |(_, implementations)| *implementations)
    };
    let constant = |name: &str| {
        let own = constants.iter().find(|(constant, _)| *constant == name);
        own.map(|(_, value)| *value).or_else(|| variant.constant(name, &[]))
    };
    Kernel::of(files(), entry, &choose, &constant)
}
