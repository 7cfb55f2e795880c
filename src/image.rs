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

pub use exr::tiled::{TILE as EXR_TILE, write_exr_tiled};
pub use exr::{Attributes, read_exr, read_exr_texts, write_exr, write_exr_with};
pub use file::place::{folder_of, identity, identity_of_new, real_path};
pub use file::unfinished::remove_unfinished;
pub use file::whole::{check_writable, clear_up, is_full, open_to_append, write_lines, write_text};
pub use npy::{
    Grid, put_npy_f64, read_npy_affines, read_npy_columns, read_npy_grid, read_npy_rows, read_npy_volume, write_npy,
    write_npy_f64,
};
pub use number::NumberType;
pub use ply::write_ply;
pub use png::{opaque8, png_bytes, rgb8, srgb8, toned8, write_png, write_png_strips};
pub use points::read_points;
pub use vectors::{read_pairs, read_vectors};
