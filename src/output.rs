//! Files the program writes and the images it reads back: PNG, EXR, NumPy arrays, points, text.

pub mod cryptomatte;
mod exr;
mod npy;
mod place;
mod ply;
mod png;
mod points;
mod stream;
mod unfinished;
mod vectors;
mod whole;

pub use exr::tiled::{TILE as EXR_TILE, write_exr_tiled};
pub use exr::{Attributes, read_exr, read_exr_texts, write_exr, write_exr_with};
pub use npy::{put_npy_f64, read_npy_affines, read_npy_rows, write_npy_f64};
pub use place::{folder_of, identity, identity_of_new, real_path};
pub use ply::write_ply;
pub use png::{rgb8, srgb8, toned8, write_png, write_png_strips};
pub use points::read_points;
pub use unfinished::remove_unfinished;
pub use vectors::{read_pairs, read_vectors};
pub use whole::{check_writable, clear_up, is_full, open_to_append, write_lines, write_text};
