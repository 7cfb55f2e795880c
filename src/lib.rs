pub mod camera;
pub mod error;
pub mod frame;
pub mod scene;
