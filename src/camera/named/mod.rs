//! Named cameras: a few keys each, built to pieces, ray fields or curves. One file a family.

pub mod cross_slit;
pub mod hinge;
pub mod mcop;
pub mod panorama;
pub mod pencil;
mod pose;
pub mod pushbroom;
pub mod surround;
mod values;
