//! Where a square of the image is sampled for bounds of what it shows.

use crate::arrays::MapEach;
use glam::DVec2;

/// Samples lie this share of the square's side inside of its border: rays may jump at the border of a pixel.
const INSET: f64 = 1.0 / (1u64 << 20) as f64;

/// What bounds take for the strip outside of the samples: four times as much as goes on linearly there.
pub const MARGIN: f64 = 8.0 * INSET;

/// The middle is off the mean of the corners by at most this much of their spread where rays are smooth; beside a jump
/// it is off by a quarter or more of the jump, which then is most of the spread (and what is off counts twice).
pub const SMOOTH: f64 = 0.25;

/// The step over which slopes are taken, px.
const STEP_PX: f64 = 1.0 / 1024.0;

/// The corners of a square: left and right above, left and right below.
pub fn corners(at: DVec2, side: f64) -> [DVec2; 4] {
    [DVec2::ZERO, DVec2::X, DVec2::Y, DVec2::ONE].map_each(|c| at + side * c)
}

/// The corners of the unit squares in a block of `side` by `side` of them, where blocks are numbered row by row over `cells` squares.
pub fn squares(block: u32, side: u32, cells: [u32; 2]) -> impl Iterator<Item = DVec2> {
    let columns = cells[0].div_ceil(side);
    let [x, y] = [(block % columns, cells[0]), (block / columns, cells[1])]
        .map_each(|(k, end)| k * side..(k * side + side).min(end));
    y.flat_map(move |j| x.clone().map(move |i| DVec2::new(i.into(), j.into())))
}

/// Just inside the corners, and the middle.
pub fn samples(at: DVec2, side: f64) -> [DVec2; 5] {
    let [a, b, c, d] = corners(at + INSET * side, (1.0 - 2.0 * INSET) * side);
    [a, b, c, d, at + 0.5 * side]
}

/// How much a pixel to the right and one down change what is `off` from the place: of both sides the one that changes
/// less, as the other may be behind a jump; nothing where there is no ray on either side.
pub fn least_slope(place: DVec2, off: impl Fn(DVec2) -> Option<f64>) -> f64 {
    let along = |axis: DVec2| {
        let sides = [axis, -axis].map_each(|step| off(place + STEP_PX * step));
        sides.into_iter().flatten().reduce(f64::min).unwrap_or(0.0) / STEP_PX
    };
    along(DVec2::X) + along(DVec2::Y)
}
