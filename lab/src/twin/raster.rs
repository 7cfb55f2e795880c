//! raster and recheck in f64: each pixel of each pair against the triangle's edges; the nearest hit wins.

use super::edge::{Side, side};
use super::rays::{Cast, PixelRays, owned};
use super::{KernelInputs, Real, bin, curve};
use anamorph::internals::camera::perturb::{EDGE_ON, END_REACH, PERTURB};
use glam::DVec3;
use rayon::prelude::*;

/// A triangle as stored: corners in the order of their positions, relative to the anchor.
#[derive(Debug, Clone, Copy)]
pub struct Corners {
    pub v: [DVec3; 3],
    pub id: u32,
    /// The file's order runs the other way round.
    pub reversed: bool,
    pub one_sided: bool,
}

impl Corners {
    /// The size of the largest, the sum of its absolute components.
    pub fn reach(&self) -> f64 {
        self.v.iter().map(|v| v.abs().element_sum()).fold(0.0, f64::max)
    }
}

/// The hit of a pixel's ray on one triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tested {
    pub hit: Option<Fragment>,
    /// Another correct evaluation may find a hit where this one finds none, or none where it does.
    pub uncertain: bool,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fragment {
    pub t: f64,
    /// How far another correct evaluation's t may be from this one.
    pub t_error: f64,
    pub id: u32,
}

/// Whether the pixel lies inside the triangle's three edges.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Coverage {
    pub inside: bool,
    pub uncertain: bool,
}

const NOTHING: Tested = Tested { hit: None, uncertain: false };

/// The sides of the three edges, taken from the smaller end to the larger, hold the ray between them.
fn ray_coverage(rays: &PixelRays, c: &Corners, real: Real) -> Coverage {
    let [v0, v1, v2] = c.v;
    let of = |from: DVec3, to: DVec3| side(rays, from, to, real);
    let flipped = |s: Side| Side { sign: -s.sign, ..s };
    let first = of(v0, v1);
    let second = of(v1, v2);
    let differ = |a: Side, b: Side| a.sign != b.sign && !a.uncertain && !b.uncertain;
    if differ(first, second) {
        return Coverage { inside: false, uncertain: false };
    }
    let third = flipped(of(v0, v2));
    if differ(first, third) || differ(second, third) {
        return Coverage { inside: false, uncertain: false };
    }
    let inside = first.sign == second.sign && first.sign == third.sign;
    Coverage { inside, uncertain: first.uncertain || second.uncertain || third.uncertain }
}

/// How far `N . (v h - p)` and `N . d` of another correct evaluation may be off, in units of its arithmetic.
pub struct QuotientError {
    pub above: f64,
    pub below: f64,
}

/// Units that a product of normal and vector may lose: cross product 3, dot product 3, edges 2.
const PRODUCT_UNITS: f64 = 8.0;
/// Units that a vertex less an origin may lose: a product, a difference, and the origin's own sums.
const OFFSET_UNITS: f64 = 3.0;
/// Units of reach that an edge loses where its two vertices are read as f32.
const STORED_UNITS: f64 = 2.0;

/// The normal's size is that of its factors.
pub fn quotient_error(rays: &PixelRays, c: &Corners, real: Real) -> QuotientError {
    let [v0, v1, v2] = c.v;
    let (e1, e2) = ((v1 - v0).length(), (v2 - v0).length());
    let reach = c.reach();
    let stored = if real == Real::F32 { STORED_UNITS * reach * (e1 + e2) } else { 0.0 };
    let normal = PRODUCT_UNITS * e1 * e2 + stored;
    let offset = (v0 * rays.bundle.h[0] - rays.bundle.p[0]).length();
    let offset_error = OFFSET_UNITS * e1 * e2 * (reach * rays.size_h + rays.size_p);
    QuotientError {
        above: real.rounding() * (normal * offset + offset_error),
        below: real.rounding() * (normal * rays.bundle.d[0].length() + OFFSET_UNITS * e1 * e2 * rays.size_d),
    }
}

/// A ray or curve against a triangle: inside, seen from a visible face, t in range.
pub fn test(input: &KernelInputs, cast: &Cast, c: &Corners, real: Real) -> Tested {
    match cast {
        Cast::Ray(rays) => test_ray(input, rays, c, real),
        Cast::Curve(of_pixel) => curve::test(of_pixel, c, real),
    }
}

fn test_ray(input: &KernelInputs, rays: &PixelRays, c: &Corners, real: Real) -> Tested {
    // f32 rays are not perturbed
    let scene_size = if real == Real::F64 { f64::from(input.params.scene_size) } else { 0.0 };
    let covered = ray_coverage(&rays.perturbed(scene_size), c, real);
    if !covered.inside && !covered.uncertain {
        return NOTHING;
    }
    let [v0, v1, v2] = c.v;
    let b = &rays.bundle;
    let normal = (v1 - v0).cross(v2 - v0);
    let across = normal.dot(b.d[0]);
    let t = normal.dot(v0 * b.h[0] - b.p[0]) / across;
    let error = quotient_error(rays, c, real);
    let edge_on = across.abs() <= error.below;
    let t_error =
        if edge_on { f64::INFINITY } else { (error.above + t.abs() * error.below) / (across.abs() - error.below) };

    let facing_away = (across > 0.0) != c.reversed;
    let is_back_face = c.one_sided && facing_away;
    if across == 0.0 || (is_back_face && !edge_on) {
        return Tested { hit: None, uncertain: edge_on };
    }
    let [t_min, t_max] = input.t_range();
    // a hit within the margin of an end of t_range is moved to that end
    let margin = end_margin(rays, c, across, real, (input.slabbed, scene_size)) / across.abs();
    let near = |end: f64, margin: f64| (t - end).abs() <= margin;
    let at_end = [t_min, t_max].into_iter().any(|end| near(end, t_error + 2.0 * margin));
    let t = [t_min, t_max].into_iter().find(|end| near(*end, margin)).unwrap_or(t);
    let in_range = t >= t_min && t <= t_max;
    if !in_range && !at_end {
        return NOTHING;
    }
    let size = |v: DVec3| v.abs().element_sum();
    // kernels take the t of the perturbed ray there
    let is_along_plane = across.abs() < EDGE_ON * size(normal) * size(b.d[0]);
    let uncertain = covered.uncertain || at_end || is_along_plane || (c.one_sided && edge_on);
    let hit = (covered.inside && in_range && !is_back_face).then_some(Fragment { t, t_error, id: c.id });
    Tested { hit, uncertain }
}

/// Rounding of `N . (v h - p)` as stored, in units of what is summed up.
const END_UNITS: f64 = 16.0;

/// Tolerance at the ends of t_range, times `N . d`, which is `across`: of a chain's segment, or in a scene of this size.
fn end_margin(rays: &PixelRays, c: &Corners, across: f64, real: Real, (slabbed, scene_size): (bool, f64)) -> f64 {
    let [v0, v1, v2] = c.v;
    let size = |v: DVec3| v.abs().element_sum();
    let b = &rays.bundle;
    let of_chain = END_UNITS * real.unit() * (c.reach() * b.h[0].abs() + size(b.p[0]) + size(b.d[0]));
    let of_plane = size((v1 - v0).cross(v2 - v0));
    let of_scene = (PERTURB * of_plane).min(END_REACH * across.abs() / size(b.d[0])) * scene_size * b.h[0].abs();
    if slabbed { of_plane * of_chain } else { of_scene }
}

/// The visibility buffer of a band: a complemented key per pixel, low word first; 0: no hit.
#[derive(Debug, Clone, PartialEq)]
pub struct Visibility {
    pub words: Vec<[u32; 2]>,
    /// Pixels where another correct evaluation of some pair may differ.
    pub uncertain: Vec<bool>,
    /// Owned pixels inside the pairs' boxes, and hits among them.
    pub tested: u64,
    pub kept: u64,
}

impl Visibility {
    pub fn new(pixels: usize) -> Visibility {
        Visibility { words: vec![[0; 2]; pixels], uncertain: vec![false; pixels], tested: 0, kept: 0 }
    }

    pub fn key(&self, pixel: usize) -> Option<u64> {
        let [lo, hi] = self.words[pixel];
        let word = u64::from(hi) << 32 | u64::from(lo);
        (word != 0).then_some(!word)
    }

    /// Keeps the larger of a pixel's word and this one.
    pub fn merge(&mut self, pixel: usize, word: u64) {
        let [lo, hi] = self.words[pixel];
        let best = word.max(u64::from(hi) << 32 | u64::from(lo));
        self.words[pixel] = [best as u32, (best >> 32) as u32];
    }
}

/// Merges the hits of all pairs.
pub fn raster(input: &KernelInputs, pairs: &[[u32; 2]], real: Real, visibility: &mut Visibility) {
    let keys = input.keys(real);
    let tested: Vec<(usize, u32, Tested)> =
        pairs.par_iter().flat_map_iter(|&pair| test_pair(input, pair, real)).collect();
    visibility.tested += tested.len() as u64;
    for (pixel, layer, tested) in tested {
        visibility.uncertain[pixel] |= tested.uncertain;
        if let Some(hit) = tested.hit {
            visibility.kept += 1;
            visibility.merge(pixel, !keys.key(layer, hit.t, hit.id));
        }
    }
}

/// The owned pixels of a pair's box, by their place in the band, and their layer.
fn test_pair(input: &KernelInputs, pair: [u32; 2], real: Real) -> Vec<(usize, u32, Tested)> {
    let pair = bin::Pair::unpack(pair);
    let corners = input.corners(pair.slot);
    if input.is_excluded(corners.id) {
        return Vec::new();
    }
    let tile = pair.tile as usize;
    let cells = &input.cells[input.tile_start[tile] as usize..input.tile_start[tile + 1] as usize];
    let in_box = cells.iter().flat_map(|cell| {
        let pixels = owned(cell) & pair.pixels();
        (0..64u32).filter(move |bit| pixels >> bit & 1 == 1).map(move |bit| (cell, bit))
    });
    in_box
        .map(|(cell, bit)| {
            let (x, y) = input.pixel_of(cell.tile, bit);
            let pixel = (y * input.params.width + x) as usize;
            let tested = match input.starts_on(pixel, corners.id) {
                true => NOTHING,
                false => test(input, &input.cell_cast(cell, bit), &corners, real),
            };
            (pixel, input.layer_of(cell.tile), tested)
        })
        .collect()
}
