//! Kernels one by one: against their twins, or against what they compute. One program, since each takes seconds to link.

#[path = "common/bounced.rs"]
mod bounced;
mod common;
#[path = "common/exact.rs"]
mod exact;
#[path = "common/nasty.rs"]
mod nasty;
#[path = "common/stages.rs"]
mod stages;

mod kernels {
    mod aim;
    mod args;
    mod bin;
    mod bounce;
    mod circle;
    mod control;
    mod cull;
    mod deposit;
    mod fit;
    mod gather;
    mod meet;
    mod opened;
    mod planted;
    mod raster;
    mod readback;
    mod shade;
    mod sides;
    mod sift;
    mod small;
    mod solve;
    mod solve_curves;
    mod write;
}
