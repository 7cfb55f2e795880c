//! Everything that touches a GPU and knows nothing of cameras: the adapter, the kernels' sources and bindings, the
//! structs they read, and buffers.

pub mod buffers;
mod compile;
pub mod device;
pub mod kernels;
pub mod layout;
pub mod recorder;
pub mod soft_f64;

pub use device::{Gpu, GpuOptions};
