//! Named cameras: a few keys each, built to pieces, ray fields or curves. One file a family.

pub mod cylinder;
pub mod fisheye;
mod pose;
pub mod sphere;
mod strips;
