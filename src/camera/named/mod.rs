//! Named cameras: a few keys each, built to pieces, ray fields or curves. One file a family.

pub mod irregular_perspective;
pub mod occlusion;
pub mod ortho_to_perspective;
mod stand;
pub mod street;
pub mod twist;
