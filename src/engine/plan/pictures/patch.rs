//! An image in patches, found by halving it.

use crate::arrays::MapEach;
use crate::camera::bundle::Ray;
use crate::camera::{Camera, Rays};
use crate::input::{Error, Result};
use crate::parallel;
use glam::{DVec2, DVec3};
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

/// How far from the camera's own ray a patch may find a point, px of the picture: between black and white in neighbouring pixels that
/// is 1/64, about what a step of 8-bit light is.
pub const TOLERANCE_PX: f64 = 1.0 / 64.0;

/// How far a patch goes on beyond its sides, px: its neighbour may begin so far from it.
pub const OVERLAP_PX: f64 = 2.0 * TOLERANCE_PX;

/// Patches are not halved below this, px: rays of a table bend at pixel centres.
const SMALLEST_PX: f64 = 0.5;

/// Patches of a picture at most, 192 bytes each with what is above them.
const PATCHES_MAX: usize = 1 << 18;

/// As in the kernel: Newton's method takes so many steps at most, and has arrived after one shorter than this, px. It squares what is left.
const STEPS: u32 = 8;
const ARRIVED_PX: f64 = 1.0 / 64.0;

/// Between the nearest and the farthest point of a ray that is tried, at most.
const NEAREST: f64 = 1.0 / 64.0;

/// Rays that are bilinear over a rectangle: with u and v from -1 to 1, `P = p[0] + u p[1] + v p[2] + u v p[3]`, and D alike.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Patch {
    /// Place of the middle, and half the sides, px.
    pub middle: DVec2,
    pub half: DVec2,
    pub p: [DVec3; 4],
    pub d: [DVec3; 4],
}

/// Margin of a box that rays of a patch may meet, relative to the sizes of the scene and of the patch: four times that by which kernels enlarge
/// their boxes, `BOX_ROUNDING` of [`super::pack`].
const MEETING_TOLERANCE: f64 = 1.0 / (1u64 << 18) as f64;

/// A square of the image and what is in it.
pub enum Square {
    Empty,
    Patch(Box<Patch>),
    Four(Vec<Square>),
}

/// The patches of a camera over a scene.
pub struct Patches {
    pub root: Square,
    /// The ends of t.
    pub t_range: [f64; 2],
}

impl Patch {
    fn at(&self, of: &[DVec3; 4], u: f64, v: f64) -> DVec3 {
        of[0] + u * of[1] + v * of[2] + u * v * of[3]
    }

    /// The place of a point, px, where Newton's method finds it in the patch or close to it.
    pub fn find(&self, x: DVec3) -> Option<DVec2> {
        let (mut u, mut v) = (0.0, 0.0);
        for _ in 0..STEPS {
            let d = self.at(&self.d, u, v);
            let rest = x - self.at(&self.p, u, v);
            let t = rest.dot(d) / d.dot(d);
            let right = self.p[1] + v * self.p[3] + t * (self.d[1] + v * self.d[3]);
            let down = self.p[2] + u * self.p[3] + t * (self.d[2] + u * self.d[3]);
            let (across, along) = (down.cross(d), d.cross(right));
            let det = right.dot(across);
            let off = rest - t * d;
            let step = DVec2::new(off.dot(across), off.dot(along)) / det;
            if !step.is_finite() {
                return None;
            }
            (u, v) = ((u + step.x).clamp(-2.0, 2.0), (v + step.y).clamp(-2.0, 2.0));
            if (step * self.half).abs().max_element() < ARRIVED_PX {
                return Some(self.middle + DVec2::new(u, v) * self.half);
            }
        }
        None
    }

    /// The boxes of its origins and directions, and of those that it goes on to.
    pub fn boxes(&self) -> [[DVec3; 2]; 2] {
        let far = DVec2::ONE + OVERLAP_PX / self.half;
        [&self.p, &self.d].map_each(|of| {
            let corners = [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)];
            let at = corners.map_each(|(x, y)| self.at(of, x * far.x, y * far.y));
            [at.into_iter().fold(DVec3::INFINITY, DVec3::min), at.into_iter().fold(DVec3::NEG_INFINITY, DVec3::max)]
        })
    }
}

impl Patch {
    /// Returns `false` only if no ray of the patch meets a box in a scene of this size after its start.
    fn may_meet(&self, t_range: [f64; 2], (lo, hi): (DVec3, DVec3), scene_size: f64) -> bool {
        let [[p_lo, p_hi], [d_lo, d_hi]] = self.boxes();
        let reach = p_lo.abs().max(p_hi.abs()).max_element() + lo.abs().max(hi.abs()).max_element() + scene_size;
        let margin = MEETING_TOLERANCE * reach;
        let d_margin = MEETING_TOLERANCE * d_lo.abs().max(d_hi.abs()).max_element();
        let (mut first, mut last) = (t_range[0].max(0.0), t_range[1]);
        // both sides of each slab say from or up to which t it may be met
        for axis in 0..3 {
            let ends = [
                (hi[axis] - p_lo[axis] + margin, d_lo[axis] - d_margin),
                (p_hi[axis] - lo[axis] + margin, -d_hi[axis] - d_margin),
            ];
            // the ray is in the slab's half-space while t speed <= room
            for (room, speed) in ends {
                match speed {
                    _ if speed > 0.0 => last = last.min(room / speed),
                    _ if speed < 0.0 => first = first.max(room / speed),
                    _ if room < 0.0 => return false,
                    _ => {}
                }
            }
        }
        first <= last
    }
}

impl Square {
    /// Returns `false` only if no ray of the square meets a box in a scene of this size after its start.
    pub fn may_meet(&self, t_range: [f64; 2], bounds: (DVec3, DVec3), scene_size: f64) -> bool {
        match self {
            Square::Empty => false,
            Square::Patch(patch) => patch.may_meet(t_range, bounds, scene_size),
            Square::Four(four) => four.iter().any(|square| square.may_meet(t_range, bounds, scene_size)),
        }
    }
}

/// A camera whose patches are sought.
struct Search<'a> {
    rays: &'a Rays,
    size: DVec2,
    t_range: [f64; 2],
    bounds: (DVec3, DVec3),
    /// Patches so far: beyond [`PATCHES_MAX`] the search ends.
    found: AtomicUsize,
}

/// Where a patch is tried, u and v: most of what bends is off at the middles of sides, at the middle and between.
const TRIED: [(f64, f64); 9] =
    [(0., 0.), (-1., 0.), (1., 0.), (0., -1.), (0., 1.), (-0.5, -0.5), (0.5, -0.5), (-0.5, 0.5), (0.5, 0.5)];

/// As far inside of a patch lies what is tried at its sides, and its corners, of its size: another part may begin there.
const INSET: f64 = 1.0 / (1u64 << 20) as f64;

impl Search<'_> {
    /// The part of the image that a place lies in: rays may jump from one to the next.
    fn part(&self, place: DVec2) -> Option<usize> {
        match self.rays {
            Rays::Pieces(pieces) => {
                let inside = place.min(self.size - 1.0).max(DVec2::ZERO).floor();
                pieces.owner_of_place(inside.x as u32, inside.y as u32, place).map(|piece| piece as usize)
            }
            Rays::Field(field) => field.map().map_or(Some(0), |map| map.part(place, self.size)),
            Rays::Curves(_) => None,
        }
    }

    /// The ray of a part at a place in it or beside it.
    fn ray(&self, part: usize, place: DVec2) -> Option<Ray> {
        let ray = match self.rays {
            Rays::Pieces(pieces) => Some(pieces.bundle_at_place(part as u32, place).ray(0.0, 0.0)),
            Rays::Field(field) => match field.map() {
                Some(map) => map.ray_of_part(part, place, self.size),
                None => field.ray_at(place),
            },
            Rays::Curves(_) => None,
        };
        ray.filter(|r| r.origin.is_finite() && r.direction.is_finite() && r.direction != DVec3::ZERO)
    }

    /// Rays at the corners of a rectangle, made bilinear between them; `None` where one is missing.
    fn patch(&self, part: usize, lo: DVec2, hi: DVec2) -> Option<Patch> {
        let (middle, half) = (0.5 * (lo + hi), 0.5 * (hi - lo));
        let corner = |x: f64, y: f64| self.ray(part, middle + DVec2::new(x, y) * half);
        let [a, b, c, d] = [corner(-1., -1.)?, corner(1., -1.)?, corner(-1., 1.)?, corner(1., 1.)?];
        let bilinear = |of: fn(&Ray) -> DVec3| {
            let [a, b, c, d] = [of(&a), of(&b), of(&c), of(&d)];
            [a + b + c + d, b - a + d - c, c - a + d - b, a - b - c + d].map_each(|v| 0.25 * v)
        };
        Some(Patch { middle, half, p: bilinear(|r| r.origin), d: bilinear(|r| r.direction) })
    }

    /// Whether a patch lies in one part, and finds what the part's own rays pass through where they are as far away as the scene.
    fn holds(&self, part: usize, patch: &Patch) -> bool {
        TRIED.iter().all(|&(u, v)| {
            let place = patch.middle + (1.0 - INSET) * DVec2::new(u, v) * patch.half;
            let Some(ray) = self.ray(part, place).filter(|_| self.part(place) == Some(part)) else { return false };
            let found = |t: f64| {
                let found = patch.find(ray.origin + t * ray.direction);
                found.is_some_and(|at| (at - place).abs().max_element() <= TOLERANCE_PX)
            };
            self.stretch(&ray).is_none_or(|[first, last]| found(first) && found(last))
        }) && self.has_same_corners(part, patch)
    }

    fn has_same_corners(&self, part: usize, patch: &Patch) -> bool {
        let near = (1.0 - INSET) * patch.half;
        let corners =
            [(-1., -1.), (1., -1.), (-1., 1.), (1., 1.)].map_each(|(x, y)| patch.middle + DVec2::new(x, y) * near);
        corners.into_iter().all(|place| self.part(place) == Some(part))
    }

    /// The ends of t between which a ray is as far away as the scene's box, whether it passes through that or not, but for what is much
    /// nearer to its start.
    fn stretch(&self, ray: &Ray) -> Option<[f64; 2]> {
        let (lo, hi) = self.bounds;
        let (far, speed) = ((0.5 * (lo + hi) - ray.origin).length(), ray.direction.length());
        let radius = 0.5 * (hi - lo).length();
        let [start, end] = self.t_range;
        let last = end.min((far + radius) / speed);
        let first = (start + NEAREST * (last - start)).max((far - radius) / speed);
        (start < last).then(|| [first.min(last), last])
    }

    /// A square of the image, at `lo`, px.
    fn square(&self, lo: DVec2, side: f64) -> Square {
        let hi = (lo + side).min(self.size);
        if (hi - lo).min_element() <= 0.0 || self.found.load(Relaxed) > PATCHES_MAX {
            return Square::Empty;
        }
        let patch = self.part(0.5 * (lo + hi)).and_then(|part| Some((part, self.patch(part, lo, hi)?)));
        let is_smallest = side <= SMALLEST_PX;
        match patch {
            Some((part, patch)) if is_smallest || self.holds(part, &patch) => {
                self.found.fetch_add(1, Relaxed);
                Square::Patch(Box::new(patch))
            }
            _ if is_smallest => Square::Empty,
            _ => {
                let half = 0.5 * side;
                let corners = [DVec2::ZERO, DVec2::X, DVec2::Y, DVec2::ONE];
                let four: Vec<Square> = parallel::map(&corners[..], |corner| self.square(lo + half * *corner, half));
                if four.iter().all(|s| matches!(s, Square::Empty)) { Square::Empty } else { Square::Four(four) }
            }
        }
    }
}

impl Square {
    /// How many patches there are.
    pub fn count(&self) -> usize {
        match self {
            Square::Empty => 0,
            Square::Patch(_) => 1,
            Square::Four(four) => four.iter().map(Square::count).sum(),
        }
    }

    pub fn each(&self, visit: &mut impl FnMut(&Patch)) {
        match self {
            Square::Empty => {}
            Square::Patch(patch) => visit(patch),
            Square::Four(four) => four.iter().for_each(|s| s.each(visit)),
        }
    }
}

impl Patches {
    /// Of a camera of one layer of straight rays, for points of a scene in a box.
    ///
    /// # Errors
    /// [`Error::Input`] if there are too many.
    pub fn new(camera: &Camera, bounds: Option<(DVec3, DVec3)>) -> Result<Patches> {
        let size = DVec2::new(camera.width.into(), camera.height.into());
        let root = match bounds {
            None => Square::Empty,
            Some(bounds) => {
                let found = AtomicUsize::new(0);
                let search = Search { rays: &camera.layers[0], size, t_range: camera.t_range, bounds, found };
                search.square(DVec2::ZERO, size.max_element().log2().ceil().exp2())
            }
        };
        if root.count() > PATCHES_MAX {
            let kind = camera.kind;
            return Err(Error::input(format!(
                "camera: the rays of {kind} bend so much over its picture that it takes more than {PATCHES_MAX} parts; \
                 make the picture smaller"
            )));
        }
        Ok(Patches { root, t_range: camera.t_range })
    }
}
