//! Where a point lies in the picture of a camera, as kernels find it: the image in patches, in each of which origins and directions
//! of rays are bilinear, and a tree of boxes around these. Newton's method finds the place in a patch.
//!
//! A patch is halved until that method, from its middle, ends within [`TOLERANCE_PX`] of the camera's own ray wherever it was tried: one
//! patch is enough for a pinhole, and a panorama takes thousands.

use super::beams::{down, up};
use crate::camera::bundle::Ray;
use crate::camera::{Camera, Rays};
use crate::gpu::layout::NONE;
use crate::input::{Error, Result};
use crate::scene::Scene;
use crate::scene::projector_light::ProjectorLight;
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

/// How far from the camera's own ray a patch may find a point, px of the picture: between black and white in neighbouring pixels that
/// is 1/64, about what a step of 8-bit light is.
const TOLERANCE_PX: f64 = 1.0 / 64.0;

/// How far a patch goes on beyond its sides, px: its neighbour may begin so far from it.
const OVERLAP_PX: f64 = 2.0 * TOLERANCE_PX;

/// Patches are not halved below this, px: rays of a table bend at pixel centres.
const SMALLEST_PX: f64 = 0.5;

/// Patches of a picture at most, 192 bytes each with what is above them.
const PATCHES_MAX: usize = 1 << 18;

/// As in the kernel: Newton's method takes so many steps at most, and has arrived after one shorter than this, px. It squares what is left.
const STEPS: u32 = 8;
const ARRIVED_PX: f64 = 1.0 / 64.0;

/// Between the nearest and the farthest point of a ray that is tried, at most.
const NEAREST: f64 = 1.0 / 64.0;

/// Boxes are enlarged by this, relative to the scene and to where the rays start: points and patches are rounded to 2^-24 each, in four
/// sums.
const BOX_ROUNDING: f64 = 1.0 / (1u64 << 20) as f64;

/// Rows of a picture's header, of a node and of a patch.
const HEADER_ROWS: u32 = 4;
const NODE_ROWS: u32 = 4;
const PATCH_ROWS: u32 = 8;

/// Rays that are bilinear over a rectangle: with u and v from -1 to 1, `P = p[0] + u p[1] + v p[2] + u v p[3]`, and D alike.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Patch {
    /// Place of the middle, and half the sides, px.
    middle: DVec2,
    half: DVec2,
    p: [DVec3; 4],
    d: [DVec3; 4],
}

/// A square of the image and what is in it.
enum Square {
    Empty,
    Patch(Box<Patch>),
    Four(Vec<Square>),
}

/// The patches of a camera over a scene.
pub struct Patches {
    root: Square,
    count: usize,
    /// The ends of t.
    t_range: [f64; 2],
}

/// The patches of all pictures of a scene, and what they were made for.
pub struct ScenePictures {
    /// One a picture; the same for the same camera.
    all: Vec<(Arc<Camera>, Arc<Patches>)>,
    bounds: Option<(DVec3, DVec3)>,
}

impl Patch {
    fn at(&self, of: &[DVec3; 4], u: f64, v: f64) -> DVec3 {
        of[0] + u * of[1] + v * of[2] + u * v * of[3]
    }

    /// The place of a point, px, where Newton's method finds it in the patch or close to it.
    fn find(&self, x: DVec3) -> Option<DVec2> {
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
    fn boxes(&self) -> [[DVec3; 2]; 2] {
        let far = DVec2::ONE + OVERLAP_PX / self.half;
        [&self.p, &self.d].map(|of| {
            let corners = [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)];
            let at = corners.map(|(x, y)| self.at(of, x * far.x, y * far.y));
            [at.into_iter().fold(DVec3::INFINITY, DVec3::min), at.into_iter().fold(DVec3::NEG_INFINITY, DVec3::max)]
        })
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
            [a + b + c + d, b - a + d - c, c - a + d - b, a - b - c + d].map(|v| 0.25 * v)
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
        let corners = [(-1., -1.), (1., -1.), (-1., 1.), (1., 1.)].map(|(x, y)| patch.middle + DVec2::new(x, y) * near);
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
                let four: Vec<Square> =
                    corners.par_iter().map(|corner| self.square(lo + half * *corner, half)).collect();
                if four.iter().all(|s| matches!(s, Square::Empty)) { Square::Empty } else { Square::Four(four) }
            }
        }
    }
}

impl Square {
    fn count(&self) -> usize {
        match self {
            Square::Empty => 0,
            Square::Patch(_) => 1,
            Square::Four(four) => four.iter().map(Square::count).sum(),
        }
    }

    fn each(&self, visit: &mut impl FnMut(&Patch)) {
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
        let count = root.count();
        if count > PATCHES_MAX {
            let kind = camera.kind;
            return Err(Error::input(format!(
                "camera: the rays of {kind} bend so much over its picture that it takes more than {PATCHES_MAX} parts; \
                 make the picture smaller"
            )));
        }
        Ok(Patches { root, count, t_range: camera.t_range })
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.count
    }
}

impl ScenePictures {
    /// Those of `last` are taken over where camera and scene are the same.
    ///
    /// # Errors
    /// Those of [`Patches::new`].
    pub fn of(scene: &Scene, last: Option<&ScenePictures>) -> Result<ScenePictures> {
        let bounds = scene.bounds();
        let mut all: Vec<(Arc<Camera>, Arc<Patches>)> = Vec::new();
        for (k, light) in scene.projector_lights.iter().enumerate() {
            let known = last.filter(|last| last.bounds == bounds).map_or(&[][..], |last| &last.all[..]);
            let is_same = |(camera, _): &&(Arc<Camera>, Arc<Patches>)| Arc::ptr_eq(camera, &light.camera);
            let patches = match known.iter().find(is_same).or_else(|| all.iter().find(is_same)) {
                Some((_, patches)) => patches.clone(),
                None => {
                    let at = |e: Error| e.at(format_args!("projector_light.{k}"));
                    Arc::new(Patches::new(&light.camera, bounds).map_err(at)?)
                }
            };
            all.push((light.camera.clone(), patches));
        }
        Ok(ScenePictures { all, bounds })
    }

    /// The rows of all pictures as kernels read them, the first of which will be row `first`: headers, nodes and patches. Positions are
    /// relative to `anchor`; `material` is the index of the first picture's.
    pub fn rows(&self, scene: &Scene, anchor: DVec3, first: u32, material: u32) -> Vec<[f32; 4]> {
        let mut rows = vec![[0.0; 4]; HEADER_ROWS as usize * self.all.len()];
        for (k, (light, (_, patches))) in scene.projector_lights.iter().zip(&self.all).enumerate() {
            let packing = Packing::new(patches, scene.bounds(), anchor);
            let nodes_first = first + rows.len() as u32;
            let nodes = packing.nodes(&patches.root, nodes_first);
            let header = packing.header(light, [material + k as u32, nodes_first, nodes.count]);
            rows[HEADER_ROWS as usize * k..][..HEADER_ROWS as usize].copy_from_slice(&header);
            rows.extend(nodes.rows);
        }
        rows
    }
}

/// The units of a picture's rows: positions times `scale`, relative to `anchor`; directions times `d_scale`; and rays begin `skipped`
/// later than the camera's, no later than they meet the scene, which leaves more digits of it where that is far away.
struct Packing {
    anchor: DVec3,
    scale: f64,
    d_scale: f64,
    start: f64,
    skipped: f64,
    t_last: f64,
}

/// Nodes in preorder, each before those below it, and then the patches.
struct Packed {
    count: u32,
    rows: Vec<[f32; 4]>,
}

impl Packing {
    fn new(patches: &Patches, bounds: Option<(DVec3, DVec3)>, anchor: DVec3) -> Packing {
        let (lo, hi) = bounds.unwrap_or((anchor, anchor));
        let (centre, radius) = (0.5 * (lo + hi), 0.5 * (hi - lo).length());
        let (mut nearest, mut fastest, mut widest) = (f64::INFINITY, 0.0_f64, 0.0_f64);
        let [start, t_last] = patches.t_range;
        patches.root.each(&mut |patch| {
            let boxes = patch.boxes();
            let [p, d] = boxes;
            nearest = nearest.min((centre.clamp(p[0], p[1]) - centre).length());
            let most = d[0].abs().max(d[1].abs());
            (fastest, widest) = (fastest.max(most.length()), widest.max(most.max_element()));
        });
        let skipped = match (nearest - 2.0 * radius) / fastest {
            ahead if ahead.is_finite() && ahead > start => ahead.min(t_last),
            _ => start,
        };
        let power = |size: f64| (-size.max(f64::from(f32::MIN_POSITIVE)).log2().ceil()).exp2();
        let reach = (lo - anchor).abs().max((hi - anchor).abs()).max_element();
        Packing { anchor, scale: power(reach), d_scale: power(widest), start, skipped, t_last }
    }

    fn header(&self, light: &ProjectorLight, [material, first, count]: [u32; 3]) -> [[f32; 4]; HEADER_ROWS as usize] {
        let throw = light.throw;
        let t = |t: f64| (t * (self.scale / self.d_scale)).min(f64::from(f32::MAX)) as f32;
        let word = f32::from_bits;
        let size = [light.camera.width as f32, light.camera.height as f32];
        [
            [word(throw.mode as u32), word(material), word(first), word(count)],
            [throw.strength, throw.feather, throw.angle_power, throw.distance_power].map(|v| v as f32),
            [size[0], size[1], t(self.skipped - self.start), t(self.t_last - self.skipped)],
            [self.scale as f32, throw.distance.unwrap_or(0.0) as f32, word(throw.occlusion.into()), 0.0],
        ]
    }

    fn nodes(&self, root: &Square, first: u32) -> Packed {
        let (mut nodes, mut patches) = (Vec::new(), Vec::new());
        self.grow(root, &mut nodes, &mut patches);
        let count = nodes.len() as u32;
        let patches_first = first + NODE_ROWS * count;
        let node = |n: &PackedNode| {
            let ([p, d], patch) = (n.boxes, n.patch.map_or(NONE, |k| patches_first + PATCH_ROWS * k));
            let row = |v: DVec3, round: fn(f64) -> f32, last: u32| {
                let [x, y, z] = v.to_array().map(round);
                [x, y, z, f32::from_bits(last)]
            };
            [row(p[0], down, n.next), row(p[1], up, patch), row(d[0], down, 0), row(d[1], up, 0)]
        };
        let mut rows: Vec<[f32; 4]> = nodes.iter().flat_map(node).collect();
        rows.extend(patches.iter().flat_map(|patch| self.patch(patch)));
        Packed { count, rows }
    }

    /// Adds a square's nodes; the boxes around all below it.
    fn grow(&self, square: &Square, nodes: &mut Vec<PackedNode>, patches: &mut Vec<Patch>) -> Option<[[DVec3; 2]; 2]> {
        let at = nodes.len();
        let mut node = PackedNode { boxes: Default::default(), next: 0, patch: None };
        nodes.push(node);
        let boxes = match square {
            Square::Empty => None,
            Square::Patch(patch) => {
                node.patch = Some(patches.len() as u32);
                let own = self.scaled(patch);
                patches.push(own);
                Some(widened(own.boxes()))
            }
            Square::Four(four) => four.iter().filter_map(|s| self.grow(s, nodes, patches)).reduce(joined),
        };
        match boxes {
            None => nodes.truncate(at),
            Some(boxes) => nodes[at] = PackedNode { boxes, next: nodes.len() as u32, ..node },
        }
        boxes
    }

    fn scaled(&self, patch: &Patch) -> Patch {
        let mut own = *patch;
        for (p, d) in own.p.iter_mut().zip(&mut own.d) {
            *p = (*p + self.skipped * *d) * self.scale;
            *d *= self.d_scale;
        }
        own.p[0] -= self.anchor * self.scale;
        own
    }

    fn patch(&self, patch: &Patch) -> [[f32; 4]; PATCH_ROWS as usize] {
        let [p, d] = [&patch.p, &patch.d].map(|of| of.map(|v| v.as_vec3()));
        let places = [patch.middle.x, patch.middle.y, patch.half.x, patch.half.y].map(|v| v as f32);
        let row = |k: usize| if k < 4 { p[k].extend(places[k]) } else { d[k - 4].extend(0.0) };
        std::array::from_fn(|k| row(k).to_array())
    }
}

#[derive(Clone, Copy)]
struct PackedNode {
    boxes: [[DVec3; 2]; 2],
    /// The node that follows all below this one.
    next: u32,
    patch: Option<u32>,
}

/// By the rounding of points, which are up to 1, and of patches.
fn widened([p, d]: [[DVec3; 2]; 2]) -> [[DVec3; 2]; 2] {
    let widen = |[lo, hi]: [DVec3; 2], least: f64| {
        let by = BOX_ROUNDING * (lo.abs().max(hi.abs()).max_element() + least);
        [lo - by, hi + by]
    };
    [widen(p, 1.0), widen(d, 0.0)]
}

fn joined(a: [[DVec3; 2]; 2], b: [[DVec3; 2]; 2]) -> [[DVec3; 2]; 2] {
    [0, 1].map(|k| [a[k][0].min(b[k][0]), a[k][1].max(b[k][1])])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::project::Projector;
    use crate::scene::file;
    use std::path::Path;

    const SIZE: (u32, u32) = (96, 64);
    const LOOK: &str = "eye = [0.4, 1.5, 4]\ntarget = [0, 0, 0]";
    const BOUNDS: (DVec3, DVec3) = (DVec3::new(-1.5, -1.0, -1.5), DVec3::new(1.5, 1.0, 1.5));

    fn camera(keys: &str) -> Camera {
        let spec = file::camera_of(&keys.replace("LOOK", LOOK), Path::new("")).unwrap();
        Camera::new(&spec, Some(SIZE)).unwrap()
    }

    /// Of cameras whose rays bend: two for each of so few pixels, of which there could be four, as there are almost of a whole turn about
    /// an axis.
    const MANY: usize = 2 * 96 * 64;

    /// Kinds of cameras, and patches of each at most.
    fn cameras() -> Vec<(Camera, usize)> {
        [
            ("kind = \"pinhole\"\nLOOK\nvfov = 35", 1),
            ("kind = \"orthographic\"\nLOOK\nheight = 3", 1),
            ("kind = \"pinhole\"\neye = [0, 0, 1]\ntarget = [0, 0, 0]\nvfov = 120", 1),
            ("kind = \"pushbroom\"\nstart = [-2, 3, 0]\nend = [2, 3, 0]\nlook = [0, -1, 0.1]\nvfov = 70", 1),
            ("kind = \"cross_slit\"\nLOOK\nheight = 3\nslits = [{ distance = 3, angle = 0 }, { distance = 4.5, angle = 90 }]", 1),
            ("kind = \"fisheye\"\nLOOK\nfov = 120\nframe = \"full\"", MANY),
            ("kind = \"fisheye\"\nLOOK\nfov = 190", MANY),
            ("kind = \"sphere\"\nLOOK", MANY),
            ("kind = \"cylinder\"\nLOOK\nfov = 200\nvfov = 80", MANY),
            ("kind = \"panini\"\nLOOK\nfov = 150\nd = 1", MANY),
            ("kind = \"panorama\"\ncenter = [0, 0, 0]\nradius = 4\nheight = 3\nelevation = 1", 16_000),
            ("kind = \"panorama\"\ncenter = [0, 0, 0]\nradius = 4\nheight = 3\npieces = 12", MANY),
            ("kind = \"twist\"\nLOOK\nvfov = 40\nangle = 30\ndegree = 1", MANY),
        ]
        .map(|(keys, most)| (camera(keys), most))
        .into()
    }

    /// The places of a point as the kernel finds them, which goes down a tree of these patches.
    fn found(patches: &Patches, x: DVec3) -> Vec<DVec2> {
        let mut places = Vec::new();
        patches.root.each(&mut |patch| {
            let far = patch.half + OVERLAP_PX;
            places.extend(patch.find(x).filter(|at| (*at - patch.middle).abs().cmple(far).all()));
        });
        places
    }

    /// Points of the box, by the digits of their numbers in bases 2, 3 and 5.
    fn points() -> impl Iterator<Item = DVec3> {
        let digits = |mut k: u32, base: u32| {
            let (mut sum, mut part) = (0.0, 1.0);
            while k > 0 {
                part /= f64::from(base);
                sum += part * f64::from(k % base);
                k /= base;
            }
            sum
        };
        let at = move |k: u32| DVec3::new(digits(k, 2), digits(k, 3), digits(k, 5));
        (1..400).map(move |k| BOUNDS.0 + at(k) * (BOUNDS.1 - BOUNDS.0))
    }

    #[test]
    fn each_image_of_a_point_lies_in_a_patch_within_the_tolerance() {
        for (camera, most) in cameras() {
            let patches = Patches::new(&camera, Some(BOUNDS)).unwrap();
            let name = format!("{} {:?}", camera.kind, camera.t_range);
            let (mut images, mut missed, mut largest) = (0, 0, 0.0_f64);
            let projector = Projector::new(&camera);
            for x in points() {
                let near = found(&patches, x);
                for image in projector.project(x).images {
                    let off = near.iter().map(|at| (*at - DVec2::new(image.x, image.y)).length());
                    let off = off.fold(f64::INFINITY, f64::min);
                    images += 1;
                    missed += usize::from(off > 4.0 * TOLERANCE_PX);
                    largest = if off.is_finite() { largest.max(off) } else { largest };
                }
            }
            println!("{name}: {} patches, {images} images, {missed} missed, {largest:.4} px", patches.count());
            assert!(patches.count() <= most, "{name}: {} patches", patches.count());
            // where rays cross each other's slit, a point may be seen by a column of the image
            assert!(images > 100 && missed * 200 <= images, "{name}: {missed} of {images} missed");
        }
    }

    #[test]
    fn no_patch_is_left_out_by_the_boxes_above_it() {
        for (camera, _) in cameras() {
            let patches = Patches::new(&camera, Some(BOUNDS)).unwrap();
            let packing = Packing::new(&patches, Some(BOUNDS), DVec3::new(0.5, 0.0, 0.0));
            let (mut nodes, mut packed) = (Vec::new(), Vec::new());
            packing.grow(&patches.root, &mut nodes, &mut packed);
            assert_eq!(packed.len(), patches.count());
            for (k, node) in nodes.iter().enumerate() {
                for below in &nodes[k + 1..node.next as usize] {
                    let inside = |of: usize| {
                        let ([lo, hi], [l, h]) = (node.boxes[of], below.boxes[of]);
                        l.cmpge(lo).all() && h.cmple(hi).all()
                    };
                    assert!(inside(0) && inside(1) && node.patch.is_none());
                }
            }
        }
    }

    #[test]
    fn rays_without_any_order_are_refused_before_they_fill_the_memory() {
        let (w, h) = (512u32, 512u32);
        let mut state = 1u64;
        let mut unit = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f64 / f64::from(1 << 24) - 0.5
        };
        let n = (w * h) as usize;
        let vectors: Vec<DVec3> = (0..n).map(|_| DVec3::new(unit(), unit(), unit() - 1.0)).collect();
        let origins = vec![DVec3::new(0.0, 0.0, 2.0); n];
        let field = crate::camera::Field::new(w, h, &origins, &vectors).unwrap();
        let camera = Camera::of("raymap", (w, h), [0.0, f64::INFINITY], Rays::Field(field));
        let error = Patches::new(&camera, Some(BOUNDS)).err().unwrap().to_string();
        assert!(error.contains("more than 262144 parts"), "{error}");
    }
}
