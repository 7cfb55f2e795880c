//! Whole frames of the engine against the reference, the twins and each other.

#[path = "../common/bounced.rs"]
mod bounced;
#[path = "../common/mod.rs"]
mod common;
#[path = "../common/stages.rs"]
mod stages;

mod adapters;
mod aim;
mod baselines_agree;
mod capsules;
mod certified;
mod certified_spheres;
mod combinations;
mod comparators_can_fail;
mod conic;
mod determinism;
mod exposed_files;
mod exposure;
mod frame_reference;
mod gradients;
mod in_view;
mod instances;
mod layered_reference;
mod memory;
mod methods;
mod moved;
mod optics;
mod optics_along_curves;
mod overflow;
mod plan;
mod random_frames;
mod spheres;
mod steps;
mod strips;
mod tessellate;
mod ties;
mod true_coverage;
mod twin_reference;
mod volume;
mod watertight;
