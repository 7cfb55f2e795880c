//! Everything that touches a GPU: the adapter, how kernels are joined from files, the structs that they read, and buffers. Of cameras
//! only the layouts that kernels read.

pub mod buffers;
pub mod compile;
pub mod device;
pub mod draw_counts;
pub mod exact;
pub mod kernels;
pub mod layout;
pub mod needs;
pub mod queries;
pub mod readback;
pub mod recorder;
pub mod single;

pub use device::Gpu;
#[cfg(any(feature = "cli", feature = "view"))]
pub use device::GpuOptions;
