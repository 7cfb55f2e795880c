//! Contact sheets: many pictures, small, each over its name.

use image::imageops::{FilterType, overlay, resize};
use image::{Rgb, RgbImage};

/// A picture's place on the sheet, pixels, without its name.
const CELL: [u32; 2] = [240, 180];
/// Height of a name's line.
const LINE: u32 = 18;
const GAP: u32 = 4;
const PAPER: Rgb<u8> = Rgb([255; 3]);
const INK: Rgb<u8> = Rgb([0; 3]);

/// A picture as large as a cell of the sheet allows.
pub fn small(picture: &RgbImage) -> RgbImage {
    let (width, height) = picture.dimensions();
    let shrink = (f64::from(CELL[0]) / f64::from(width)).min(f64::from(CELL[1]) / f64::from(height));
    let [width_small, height_small] = [width, height].map(|n| (f64::from(n) * shrink).round().max(1.0) as u32);
    resize(picture, width_small, height_small, FilterType::Triangle)
}

/// All pictures in rows of `columns`, each over its name.
pub fn sheet(pictures: &[(&str, RgbImage)], columns: u32) -> RgbImage {
    let rows = (pictures.len() as u32).div_ceil(columns);
    let (pitch_x, pitch_y) = (CELL[0] + GAP, CELL[1] + LINE);
    let mut sheet = RgbImage::from_pixel(columns * pitch_x + GAP, rows * pitch_y + GAP, PAPER);
    for (k, (name, picture)) in (0u32..).zip(pictures) {
        let (x, y) = (GAP + k % columns * pitch_x, GAP + k / columns * pitch_y);
        overlay(&mut sheet, picture, x.into(), (y + CELL[1] - picture.height()).into());
        write(&mut sheet, name, x, y + CELL[1] + 3);
    }
    sheet
}

/// Letters of 3 x 5 dots, a row a number, its highest of three bits on the left: a to z, then the hyphen.
#[rustfmt::skip] // a table
const LETTERS: [[u8; 5]; 27] = [
    [2, 5, 7, 5, 5], [6, 5, 6, 5, 6], [3, 4, 4, 4, 3], [6, 5, 5, 5, 6], [7, 4, 6, 4, 7], [7, 4, 6, 4, 4], [3, 4, 5, 5, 3],
    [5, 5, 7, 5, 5], [7, 2, 2, 2, 7], [1, 1, 1, 5, 2], [5, 5, 6, 5, 5], [4, 4, 4, 4, 7], [5, 7, 7, 5, 5], [6, 5, 5, 5, 5],
    [2, 5, 5, 5, 2], [6, 5, 6, 4, 4], [2, 5, 5, 6, 3], [6, 5, 6, 5, 5], [3, 4, 2, 1, 6], [7, 2, 2, 2, 2], [5, 5, 5, 5, 7],
    [5, 5, 5, 5, 2], [5, 5, 7, 7, 5], [5, 5, 2, 5, 5], [5, 5, 2, 2, 2], [7, 1, 2, 4, 7], [0, 0, 7, 0, 0],
];

/// Writes a name, its upper left corner at (x, y), in dots of 2 x 2 pixels; what is no letter is a hyphen.
fn write(sheet: &mut RgbImage, name: &str, x: u32, y: u32) {
    for (k, c) in (0u32..).zip(name.bytes()) {
        let letter = LETTERS[if c.is_ascii_lowercase() { usize::from(c - b'a') } else { 26 }];
        for (i, j) in (0..6).flat_map(|i| (0..10).map(move |j| (i, j))) {
            if letter[j as usize / 2] >> (2 - i / 2) & 1 == 1 {
                sheet.put_pixel(x + 8 * k + i, y + j, INK);
            }
        }
    }
}
