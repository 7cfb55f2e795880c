//! The path of one image place: its segments, layer by layer.

use super::Hit;
use super::curve::POINT_ROUNDING;
use super::intersect::T_ROUNDING;
use super::length::arc_length;
use crate::camera::bundle::Bundle;
use crate::camera::curve::Curve;
use crate::camera::{Camera, Rays};
use glam::{DVec2, DVec3};

/// A ray or a curve of one layer.
#[derive(Debug, Clone, Copy)]
pub enum Segment {
    /// The central ray of the bundle.
    Straight(Bundle),
    /// t in [0, 1].
    Curved(Curve),
}

/// All segments of one place of the image.
#[derive(Debug, Clone)]
pub struct Path {
    /// The layers' segments, first to last, each with its piece, numbered through all layers.
    pub segments: Vec<Option<(u32, Segment)>>,
    /// The camera's.
    pub t_range: [f64; 2],
}

/// The first hit of a path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seen {
    pub layer: usize,
    /// Numbered through all layers.
    pub piece: u32,
    /// t is that of the layer.
    pub hit: Hit,
}

/// Tolerance on t at the face shared by two layers, on both sides: neither the rounding
/// of t (of a number near 1; near 0 it is far smaller) nor that of the face's own place lets a surface slip through.
fn face_allowance(place_error: f64, direction: DVec3) -> f64 {
    2.0 * T_ROUNDING + place_error / direction.length()
}

impl Seen {
    /// The channel `t`: that of the layer, and 1 for each layer before it.
    pub fn t(&self) -> f64 {
        self.layer as f64 + self.hit.t
    }
}

impl Segment {
    /// `X'(t)`.
    pub fn direction(&self, t: f64) -> DVec3 {
        match self {
            Segment::Straight(b) => b.ray(0.0, 0.0).direction,
            Segment::Curved(c) => c.tangent(t),
        }
    }

    /// `X(t)`.
    pub fn point(&self, t: f64) -> DVec3 {
        match self {
            Segment::Straight(b) => {
                let ray = b.ray(0.0, 0.0);
                ray.origin + t * ray.direction
            }
            Segment::Curved(c) => c.at(t),
        }
    }

    /// Length from t = 0 to `t`, world units; negative for negative t.
    pub fn length(&self, t: f64) -> f64 {
        match self {
            Segment::Straight(b) => t * b.ray(0.0, 0.0).direction.length(),
            Segment::Curved(c) => arc_length(c, t),
        }
    }

    /// Unit tangent at `t`; where the derivative is 0, the direction of a short chord about it.
    pub fn view(&self, t: f64) -> DVec3 {
        let around = || match self {
            Segment::Straight(_) => DVec3::ZERO,
            Segment::Curved(c) => c.at((t + VIEW_STEP).min(1.0)) - c.at((t - VIEW_STEP).max(0.0)),
        };
        self.direction(t).try_normalize().unwrap_or_else(|| around().normalize_or_zero())
    }
}

/// Half the interval of t of that chord: the square root of f64's precision, which balances rounding against curvature.
const VIEW_STEP: f64 = 1.0 / (1 << 26) as f64;

impl Path {
    /// A chain of these segments, each the one piece of its layer.
    #[cfg(feature = "internals")]
    pub fn through(segments: &[Segment]) -> Path {
        let segments = segments.iter().zip(0..).map(|(s, piece)| Some((piece, *s))).collect();
        Path { segments, t_range: [0.0, 1.0] }
    }

    /// The path of the pixel's own sample.
    pub fn of_pixel(camera: &Camera, i: u32, j: u32) -> Path {
        Path::at_offset(camera, i, j, (0.0, 0.0))
    }

    /// The path `(x, y)` pixels right of and below the pixel's sample, less than half a pixel away.
    pub fn at_offset(camera: &Camera, i: u32, j: u32, (x, y): (f64, f64)) -> Path {
        let segment = |layer: usize| {
            let (piece, segment) = match &camera.layers[layer] {
                Rays::Pieces(p) => {
                    let place = p.place(i, j) + DVec2::new(x, y);
                    let piece = p.owner_of_place(i, j, place)?;
                    (piece, Segment::Straight(p.bundle_at_place(piece, place)))
                }
                Rays::Field(f) => {
                    // the four sides of the centre in the order of `quadrants`
                    let side = usize::from(x < 0.0) + 2 * usize::from(y < 0.0);
                    let bundle =
                        if (x, y) == (0.0, 0.0) { f.bundle(i, j) } else { f.quadrants(i, j).get(side).copied() };
                    (0, Segment::Straight(bundle?.recentred(x, y)))
                }
                Rays::Curves(c) => c.near(i, j, (x, y)).map(|(piece, curve)| (piece, Segment::Curved(curve)))?,
            };
            Some((camera.first_piece(layer) + piece, segment))
        };
        Path { segments: (0..camera.layers.len()).map(segment).collect(), t_range: camera.t_range }
    }

    /// The range of t in a layer of rays: the camera's, plus a tolerance where the neighbouring layer's ray starts at the same
    /// place. A t beyond [0, 1] is then clamped ([`Path::within`]).
    pub fn range(&self, layer: usize) -> [f64; 2] {
        let [mut t0, mut t1] = self.t_range;
        let Some(Segment::Straight(own)) = self.segment(layer) else { return self.t_range };
        let direction = own.ray(0.0, 0.0).direction;
        if let Some(error) = layer.checked_sub(1).and_then(|before| self.joint(before)) {
            t0 -= face_allowance(error, direction);
        }
        if let Some(error) = self.joint(layer) {
            t1 += face_allowance(error, direction);
        }
        [t0, t1]
    }

    /// `t` in the camera's own range.
    pub fn within(&self, t: f64) -> f64 {
        t.clamp(self.t_range[0], self.t_range[1])
    }

    pub(super) fn segment(&self, layer: usize) -> Option<&Segment> {
        self.segments.get(layer)?.as_ref().map(|s| &s.1)
    }

    /// Error bound on the joint of this layer's ray and the next one's, world units; `None` if they do not join.
    fn joint(&self, layer: usize) -> Option<f64> {
        let (Segment::Straight(a), Segment::Straight(b)) = (self.segment(layer)?, self.segment(layer + 1)?) else {
            return None;
        };
        let (a, b) = (a.ray(0.0, 0.0), b.ray(0.0, 0.0));
        let size = [a.origin, a.direction, b.origin, b.direction].iter().fold(0.0, |s, v| s + v.length());
        let error = JOINT_ROUNDING * size;
        ((a.origin + a.direction - b.origin).length() <= error).then_some(error)
    }

    /// The channel `Z`: the lengths of the earlier segments plus that to the hit on its own, world units.
    pub fn depth(&self, seen: &Seen) -> f64 {
        let before: f64 = self.segments[..seen.layer].iter().flatten().map(|(_, s)| s.length(1.0)).sum();
        before + self.of(seen).length(seen.hit.t)
    }

    /// |X'| at the hit, else at the start of the first segment; 0 without one.
    pub fn speed(&self, seen: Option<&Seen>) -> f64 {
        let (segment, t) = match seen {
            Some(seen) => (Some(self.of(seen)), seen.hit.t),
            None => (self.segments.iter().flatten().next().map(|s| &s.1), 0.0),
        };
        segment.map_or(0.0, |s| s.direction(t).length())
    }

    /// The segment of the hit.
    pub fn of(&self, seen: &Seen) -> &Segment {
        self.segment(seen.layer).expect("what is seen is seen along a segment")
    }
}

/// How exactly pieces give the two ends of a ray, against the sum of the magnitudes of the rays at a joint. A piece's
/// corner values are summed over three corners with slopes of the image's barycentrics, and moved to the pixel: some
/// 16 roundings of half an epsilon of terms up to four times the corners' size (centre, two slopes, each to a corner
/// and back). [`POINT_ROUNDING`] is the bound for the points of a curve.
const JOINT_ROUNDING: f64 = 16.0 * 4.0 * 0.5 * f64::EPSILON + POINT_ROUNDING;
