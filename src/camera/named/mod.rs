//! Named cameras: a few keys each, built to pieces, ray fields or curves. One file a family.

pub mod camera_texture;
pub mod cylinder;
pub mod display;
pub mod fisheye;
pub mod lidar;
pub mod lightfield;
pub mod ods;
pub mod opencv;
pub mod panini;
mod pose;
pub mod sphere;
mod strips;
