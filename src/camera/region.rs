//! Regions of the image, in image coordinates.

mod mask;

use crate::camera::pieces::side;
use crate::input::Result;
use crate::input::reader::{Field, Table};
use glam::DVec2;
use mask::Mask;

/// Where a camera shows, if no other one comes before it.
#[derive(Debug, Clone, PartialEq)]
pub enum Region {
    Whole,
    /// Its lesser and greater corner; the border belongs to it.
    Rectangle([DVec2; 2]),
    /// Its corners in order, and the corners of the box around them.
    Polygon {
        corners: Vec<DVec2>,
        bounds: [DVec2; 2],
    },
    Mask(Mask),
}

/// Most corners of a polygon: every pixel is tested against every side.
const CORNERS_MAX: usize = 1024;

impl Region {
    pub fn read(field: &Field) -> Result<Region> {
        let table = field.table()?;
        let kind = table.need("kind", "\"rectangle\"")?;
        match kind.text()? {
            "rectangle" => read_rectangle(&table),
            "polygon" => read_polygon(&table),
            "mask" => {
                table.allow(&["kind", "file"])?;
                let file = table.need("file", "\"mask.png\"")?;
                Mask::load(&file.path()?, file.loading()).map(Region::Mask).map_err(|e| file.error(e))
            }
            _ => Err(kind.error("use \"rectangle\", \"polygon\" or \"mask\"")),
        }
    }

    /// The place lies in it, borders included.
    pub fn holds(&self, place: DVec2) -> bool {
        match self {
            Region::Whole => true,
            Region::Rectangle([low, high]) => low.cmple(place).all() && place.cmple(*high).all(),
            Region::Polygon { corners, .. } => is_in_polygon(corners, place),
            Region::Mask(mask) => mask.holds(place),
        }
    }

    /// The corners of the box around it.
    pub fn bounds(&self) -> [DVec2; 2] {
        match self {
            Region::Whole => [DVec2::ZERO, DVec2::ONE],
            Region::Rectangle(bounds) | Region::Polygon { bounds, .. } => *bounds,
            Region::Mask(mask) => mask.bounds,
        }
    }

    /// How far a place lies inside of the border, px; negative outside. Of masks at most `most`.
    pub fn depth_px(&self, place_px: DVec2, size: DVec2, most: f64) -> f64 {
        let to_border = match self {
            Region::Whole => return f64::INFINITY,
            Region::Mask(mask) => mask.to_border(place_px, size, most),
            Region::Rectangle([low, high]) => {
                let [low, high] = [*low * size, *high * size];
                let corners = [low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y)];
                to_sides(&corners, place_px)
            }
            Region::Polygon { corners, .. } => {
                let corners: Vec<DVec2> = corners.iter().map(|q| *q * size).collect();
                to_sides(&corners, place_px)
            }
        };
        if self.holds(place_px / size) { to_border } else { -to_border }
    }

    /// No border crosses the square whose sides are `radius` px from a place.
    pub fn is_clear(&self, place_px: DVec2, size: DVec2, radius: f64) -> bool {
        let to_corner = std::f64::consts::SQRT_2 * radius;
        self.depth_px(place_px, size, 2.0 * to_corner).abs() > to_corner
    }
}

/// The distance from a place to the nearest side of a polygon.
fn to_sides(corners: &[DVec2], place: DVec2) -> f64 {
    let mut from = corners[corners.len() - 1];
    let mut nearest = f64::INFINITY;
    for &to in corners {
        let side = to - from;
        let share =
            if side == DVec2::ZERO { 0.0 } else { ((place - from).dot(side) / side.length_squared()).clamp(0.0, 1.0) };
        nearest = nearest.min((place - from - share * side).length());
        from = to;
    }
    nearest
}

fn read_rectangle(table: &Table) -> Result<Region> {
    table.allow(&["kind", "from", "to"])?;
    let from = read_place(&table.need("from", "[0, 0]")?)?;
    let to = read_place(&table.need("to", "[0.5, 0.5]")?)?;
    if from.cmpge(to).any() {
        return Err(table.error("the rectangle has no area; from is its upper left corner, to its lower right one"));
    }
    Ok(Region::Rectangle([from, to]))
}

fn read_polygon(table: &Table) -> Result<Region> {
    table.allow(&["kind", "points"])?;
    let field = table.need("points", "[[0, 0], [1, 0], [0.5, 1]]")?;
    let items = field.items("a list of image places, as [[0, 0], [1, 0], [0.5, 1]]")?;
    let count = items.len();
    if !(3..=CORNERS_MAX).contains(&count) {
        return Err(field.error(format_args!("{count} points; a polygon has 3 to {CORNERS_MAX}; or use a mask")));
    }
    let corners: Vec<DVec2> = items.map(|item| read_place(&item)).collect::<Result<_>>()?;
    let bounds = corners.iter().fold([corners[0]; 2], |[low, high], q| [low.min(*q), high.max(*q)]);
    if bounds[0].cmpge(bounds[1]).any() {
        return Err(field.error("the polygon has no area; its points must not lie on one line"));
    }
    Ok(Region::Polygon { corners, bounds })
}

/// Farthest coordinate of a region: far outside of the image nothing is seen.
const FARTHEST: f64 = 1000.0;

fn read_place(field: &Field) -> Result<DVec2> {
    let place: [f64; 2] = field.numbers("an image place, as [a, b]")?;
    match place.iter().find(|x| x.abs() > FARTHEST) {
        Some(x) => Err(field
            .error(format_args!("{x} is too far outside of the image, from [0, 0] to [1, 1]; use {FARTHEST} at most"))),
        None => Ok(place.into()),
    }
}

/// A ray from the place meets an odd number of sides, or the place lies on a side, within rounding.
fn is_in_polygon(corners: &[DVec2], place: DVec2) -> bool {
    let mut is_inside = false;
    let mut from = corners[corners.len() - 1];
    for &to in corners {
        let turn = side(from, to, place);
        let (low, high) = (from.min(to), from.max(to));
        if turn == 0.0 && low.cmple(place).all() && place.cmple(high).all() {
            return true;
        }
        // the side crosses the place's height to the right of it
        let goes_down = from.y <= place.y && place.y < to.y;
        let goes_up = to.y <= place.y && place.y < from.y;
        is_inside ^= goes_down && turn > 0.0 || goes_up && turn < 0.0;
        from = to;
    }
    is_inside
}
