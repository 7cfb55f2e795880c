//! Named cameras: a few keys each, built to pieces, ray fields or curves. One file a family.

pub mod camera_texture;
pub mod cross_slit;
pub mod cylinder;
pub mod display;
pub mod fisheye;
pub mod hinge;
pub mod irregular_perspective;
pub mod lidar;
pub mod lightfield;
pub mod mcop;
pub mod occlusion;
pub mod ods;
pub mod opencv;
pub mod ortho_to_perspective;
pub mod panini;
pub mod panorama;
pub mod pencil;
mod pose;
pub mod pushbroom;
pub mod reflection;
pub mod sphere;
mod stand;
pub mod street;
mod strips;
pub mod surround;
pub mod twist;
pub(crate) mod values;
