//! Images: channels, and reading and writing of PNG, EXR and NumPy files.

pub mod compare;
pub mod cryptomatte;
mod exr;
pub mod file;
pub mod frame;
mod npy;
mod number;
mod ply;
mod png;
mod points;
pub mod size;
pub mod tone;
mod vectors;

#[cfg(feature = "cli")]
pub use exr::read_exr_texts;
pub use exr::tiled::{TILE as EXR_TILE, write_exr_tiled};
pub use exr::{Attributes, read_exr, write_exr, write_exr_with};
pub use file::place::{folder_of, identity, identity_of_new, real_path};
#[cfg(feature = "cli")]
pub use file::unfinished::remove_unfinished;
pub use file::whole::{check_writable, clear_up, is_full, write_text};
#[cfg(feature = "cli")]
pub use file::whole::{open_to_append, write_lines};
#[cfg(feature = "cli")]
pub use npy::put_npy;
pub use npy::{Grid, read_npy_affines, read_npy_columns, read_npy_grid, read_npy_rows, read_npy_volume, write_npy};
pub use number::{Format as NumberFormat, NumberType};
pub use ply::write_ply;
#[cfg(any(feature = "cli", feature = "view"))]
pub use png::png_bytes;
#[cfg(feature = "internals")]
pub use png::toned8;
pub use png::{opaque8, rgb8, srgb8, write_png, write_png_strips};
#[cfg(feature = "cli")]
pub use points::read_points;
pub use points::read_text_points;
pub use vectors::{read_pairs, read_vectors};
