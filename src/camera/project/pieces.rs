//! The rays of a piece through a point.
//!
//! A tree over the pieces finds those whose rays may pass the point; in each the roots of a cubic ([`Columns`]) give t
//! and the place, and Newton's method makes both exact.

use super::beam::{Beam, ROUNDING};
use super::columns::Columns;
use super::newton::{self, Volume};
use super::tree::{Leaf, Tree, place_key};
use super::{BORDER_PX, Degenerate, Found, ONE_PLACE_PX, Shown, T_TOLERANCE};
use crate::arrays::MapEach;
use crate::camera::Camera;
use crate::camera::pieces::{Piece, Pieces, clip};
use crate::parallel;
use glam::{DVec2, DVec3};

/// Pieces over an image of a known size.
pub struct Search<'a> {
    pieces: &'a Pieces,
    size: DVec2,
    t_range: [f64; 2],
    /// Its leaves are the pieces in the image.
    pub tree: Tree,
}

/// How far beyond its border a piece's rays are bounded, px: more than a place may be off ([`BORDER_PX`]), or a ray that
/// Newton's method takes for one through the point (1e-7 of a pixel's footprint).
const BEYOND_PX: f64 = 1.0 / (1u64 << 20) as f64;

/// Places of t that are tried on a slit whose t changes along it.
const SLIT_SAMPLES: i32 = 256;

impl<'a> Search<'a> {
    pub fn new(pieces: &'a Pieces, camera: &Camera) -> Search<'a> {
        let size = DVec2::new(camera.width.into(), camera.height.into());
        let leaf = |(k, piece): (usize, &Piece)| {
            let around = seen(piece, size);
            let middle = 0.5 * around.iter().fold(DVec2::INFINITY, |m, q| m.min(*q))
                + 0.5 * around.iter().fold(DVec2::NEG_INFINITY, |m, q| m.max(*q));
            let beam = around.iter().map(|q| beam_at(piece, *q)).reduce(|a, b| a.joined(&b))?;
            Some(Leaf { key: place_key(middle, size), number: k as u32, beam })
        };
        let leaves = parallel::flat_map(0..pieces.pieces.len(), |k| leaf((k, &pieces.pieces[k])));
        Search { pieces, size, t_range: camera.t_range, tree: Tree::new(leaves, camera.t_range) }
    }

    /// At and below the nodes `from` of the tree.
    pub fn images(&self, point: DVec3, from: &[u32]) -> Shown {
        let mut shown = Shown::default();
        self.tree.walk(point, from, |k| {
            if may_see(&self.pieces.pieces[k as usize], point) {
                self.images_in(k, point, &mut shown);
            }
        });
        shown
    }

    fn images_in(&self, k: u32, point: DVec3, shown: &mut Shown) {
        let piece = &self.pieces.pieces[k as usize];
        let Some(columns) = Columns::of(&piece.bundle, point, self.half_px(piece)) else { return };
        if let Some(t) = columns.vanish() {
            if self.in_range(t) {
                shown.degenerate = shown.degenerate.max(Some(Degenerate::Eye));
            }
            return;
        }
        let Some(roots) = columns.roots() else {
            // Singular for every t: the point is on a slit along which t changes.
            let seen = (-SLIT_SAMPLES..=SLIT_SAMPLES).flat_map(|s| {
                let u = f64::from(s) / f64::from(SLIT_SAMPLES);
                [columns.unit * u, columns.unit / u]
            });
            let mut places = seen.filter(|t| t.is_finite() && self.in_range(*t)).filter_map(|t| columns.place(t));
            if places.any(|q| self.owns(k, piece.centre_px + q)) {
                shown.degenerate = shown.degenerate.max(Some(Degenerate::Slit));
            }
            return;
        };
        for t in roots {
            match columns.line(t) {
                Some((t, line)) => {
                    if self.in_range(t) && self.crosses(piece, line) {
                        shown.degenerate = shown.degenerate.max(Some(Degenerate::Slit));
                    }
                }
                None => shown.found.extend(self.image_at(k, piece, &columns, point, t)),
            }
        }
    }

    /// The exact image near a root of the determinant, if it is in the piece.
    fn image_at(&self, k: u32, piece: &Piece, columns: &Columns, point: DVec3, t: f64) -> Option<Found> {
        let place = piece.centre_px + columns.place(t)?;
        // a root is far better than this; what is farther away is another piece's
        if !self.reaches(piece, place, 1.0) {
            return None;
        }
        let root = newton::solve(&InPiece(piece), point, place, t)?;
        (root.degenerate.is_none() && self.owns(k, root.place)).then_some(Found {
            place: root.place,
            t: root.t,
            piece: k,
        })
    }

    /// Half the piece's extent in the image: the unit in which its columns are of like size.
    fn half_px(&self, piece: &Piece) -> f64 {
        let whole = self.size.max_element();
        piece.corners_px.map_or(whole, |[a, b, c]| (a.max(b).max(c) - a.min(b).min(c)).max_element()) / 2.0
    }

    fn in_range(&self, t: f64) -> bool {
        let tolerance = T_TOLERANCE * t.abs().max(1.0);
        self.t_range[0] - tolerance <= t && t <= self.t_range[1] + tolerance
    }

    /// The place is in the image and in the piece, or within `tolerance` px of it.
    fn reaches(&self, piece: &Piece, place: DVec2, tolerance: f64) -> bool {
        let in_image = place.cmpge(DVec2::splat(-tolerance)).all() && place.cmple(self.size + tolerance).all();
        in_image && piece.reaches(place, DVec2::splat(tolerance))
    }

    /// Piece `k` shows the place: it owns it, or is within rounding of doing so.
    fn owns(&self, k: u32, place: DVec2) -> bool {
        let piece = &self.pieces.pieces[k as usize];
        if !self.reaches(piece, place, BORDER_PX) {
            return false;
        }
        let pixel = place.clamp(DVec2::ZERO, self.size - 1.0).as_uvec2();
        !piece.contains(place) || self.pieces.owner_of_place(pixel.x, pixel.y, place) == Some(k)
    }

    /// The line `a x + b y + c = 0` about the piece's centre passes through the piece within the image.
    fn crosses(&self, piece: &Piece, [a, b, c]: [f64; 3]) -> bool {
        let inside = seen(piece, self.size);
        let side = |q: &DVec2| a * (q.x - piece.centre_px.x) + b * (q.y - piece.centre_px.y) + c;
        inside.iter().any(|q| side(q) >= 0.0) && inside.iter().any(|q| side(q) <= 0.0)
    }
}

/// The corners of the part of a piece that an image of `size` shows, px.
fn seen(piece: &Piece, size: DVec2) -> Vec<DVec2> {
    match piece.corners_px {
        None => vec![DVec2::ZERO, DVec2::new(size.x, 0.0), size, DVec2::new(0.0, size.y)],
        Some(corners) => clip(corners.to_vec(), DVec2::ZERO, size),
    }
}

/// The ray of a corner, with a margin for what is up to [`BEYOND_PX`] beyond it and for rounding. Rays of places between
/// corners are between theirs: both P and D are p / h with h > 0.
fn beam_at(piece: &Piece, corner: DVec2) -> Beam {
    let (b, q) = (&piece.bundle, corner - piece.centre_px);
    let ray = b.ray(q.x, q.y);
    let h = b.h[0] + q.x * b.h[1] + q.y * b.h[2];
    if h.is_nan() || h <= 0.0 {
        return Beam::ALL;
    }
    let error = |v: &[DVec3; 3], at: DVec3| {
        let slope = (v[1] - at * b.h[1]).length() + (v[2] - at * b.h[2]).length();
        let terms = v[0].length() + q.x.abs() * v[1].length() + q.y.abs() * v[2].length();
        (BEYOND_PX * slope + ROUNDING * terms) / h
    };
    Beam::about(ray.origin, ray.direction, error(&b.p, ray.origin), error(&b.d, ray.direction))
}

/// Some ray of the piece may pass through `x`. With `m = x h - p` it does where the quadratic `m x d` is 0; it is not
/// where all Bernstein coefficients over the triangle lie on one side of a plane through 0. Where the quadratic is
/// almost linear the triangle of its corner values decides, so each plane is along one of that triangle's edges.
fn may_see(piece: &Piece, x: DVec3) -> bool {
    let Some(corners) = piece.corners_px else { return true };
    let b = &piece.bundle;
    let rays = corners.map_each(|corner| {
        let q = corner - piece.centre_px;
        let at = |v: &[DVec3; 3]| v[0] + q.x * v[1] + q.y * v[2];
        (x * (b.h[0] + q.x * b.h[1] + q.y * b.h[2]) - at(&b.p), at(&b.d))
    });
    let [(m0, d0), (m1, d1), (m2, d2)] = rays;
    let corner = [m0.cross(d0), m1.cross(d1), m2.cross(d2)];
    let between = [m0.cross(d1) + m1.cross(d0), m1.cross(d2) + m2.cross(d1), m2.cross(d0) + m0.cross(d2)];
    let coefficients = [corner[0], corner[1], corner[2], 0.5 * between[0], 0.5 * between[1], 0.5 * between[2]];
    // what a place beyond the border adds, and the rounding of x h - p, both by largest components: a product of two
    // has two terms of them
    let large = |v: DVec3| v.abs().max_element();
    let (m, d) = rays.iter().fold((0.0_f64, 0.0_f64), |(m, d), r| (m.max(large(r.0)), d.max(large(r.1))));
    let slopes = [1, 2].map_each(|k| (large(x * b.h[k] - b.p[k]), large(b.d[k])));
    let (slope_m, slope_d) = (slopes[0].0 + slopes[1].0, slopes[0].1 + slopes[1].1);
    let beyond = BEYOND_PX * (m * slope_d + slope_m * d + BEYOND_PX * slope_m * slope_d);
    let h = corners
        .iter()
        .fold(0.0_f64, |h, c| h.max((b.h[0] + (*c - piece.centre_px).dot(DVec2::new(b.h[1], b.h[2]))).abs()));
    let error = 2.0 * (beyond + ROUNDING * (m + large(x) * h) * d);
    [(0, 1), (1, 2), (2, 0)].iter().all(|&(i, j)| {
        let normal = (corner[j] - corner[i]).cross(d0);
        let error = error * normal.abs().element_sum();
        let side = coefficients.map(|e| normal.dot(e));
        side.iter().any(|s| *s <= error) && side.iter().any(|s| *s >= -error)
    })
}

/// One piece's rays.
struct InPiece<'a>(&'a Piece);

impl Volume for InPiece<'_> {
    fn at(&self, place_px: DVec2, t: f64) -> Option<(DVec3, DVec3)> {
        let offset = place_px - self.0.centre_px;
        let ray = self.0.bundle.ray(offset.x, offset.y);
        let at = ray.origin + t * ray.direction;
        at.is_finite().then_some((at, ray.direction))
    }

    fn size(&self, place_px: DVec2, t: f64) -> f64 {
        let (b, q) = (&self.0.bundle, (place_px - self.0.centre_px).abs());
        let sum = |v: &[DVec3; 3]| v[0].length() + q.x * v[1].length() + q.y * v[2].length();
        let h = b.h[0] + (place_px - self.0.centre_px).dot(DVec2::new(b.h[1], b.h[2]));
        (sum(&b.p) + t.abs() * sum(&b.d)) / h.abs()
    }
}

const _: () = assert!(BORDER_PX < ONE_PLACE_PX, "images within rounding of a border are found as one");

#[cfg(test)]
mod tests;
