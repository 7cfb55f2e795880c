//! What pictures look like: samples, images, lights, lines, and the channels of surfaces.

#[path = "../common/mod.rs"]
mod common;
#[path = "../common/pictures.rs"]
mod pictures;

mod blend;
mod caustics;
mod decided;
mod gloss;
mod masks;
mod motion;
mod projector_lights;
mod relit;
mod samples;
mod shadows;
mod sky;
mod styles;
mod surface_channels;
mod textures;
