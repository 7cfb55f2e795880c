//! Kernels one by one: against their twins, or against what they compute. One program, since each takes seconds to link.

mod common;
#[path = "common/exact.rs"]
mod exact;
#[path = "common/nasty.rs"]
mod nasty;
#[path = "common/stages.rs"]
mod stages;
#[path = "common/turned.rs"]
mod turned;

mod kernels {
    mod args;
    mod bin;
    mod bounce;
    mod circle;
    mod cull;
    mod deposit;
    mod fit;
    mod gather;
    mod meet;
    mod planted;
    mod raster;
    mod shade;
    mod sides;
    mod sift;
    mod write;
}
