//! A layer of a camera's rays as lines in the world: near surface, far ends, sample rays, slits.

use super::describe::piece_class;
use super::glc::Class;
use super::{Camera, Curve, Piece, Pieces, Rays};
use crate::arrays::MapEach;
use glam::{DVec2, DVec3};

/// Pixels between which surfaces are drawn, across and down; every [`STEP`]th has a line and a ray.
const PIXELS: (u32, u32) = (24, 16);
const STEP: usize = 4;
/// Slits are those of so many pieces of a layer at most.
const SLITS_MAX: usize = 200;
/// A ray goes to where this share of the rays have left the scene, so that a few that graze it do not set the scale.
const LEFT_SHARE: f64 = 0.75;
/// A far end given by the camera is drawn up to so many times as far as the scene reaches.
const FAR_REACH: f64 = 2.0;
/// From 2 up to so many pieces of a layer, its near surface is drawn piece by piece, else by lines of pixels.
const OUTLINED_MAX: usize = 1000;
/// Neighbours on a line are treated as disconnected if their distance exceeds the usual one by this factor.
const JUMP: f64 = 10.0;
/// Slits farther from the middle than this many times the drawing's own extent are left out.
const SLIT_REACH: f64 = 1.5;

/// The least and the greatest corner.
pub type Box3 = (DVec3, DVec3);

/// A layer's rays at a grid of pixels, clipped to what is drawn, row by row.
pub struct LayerVolume {
    columns: usize,
    pub curves: Vec<Option<Curve>>,
    /// Slits and points where rays meet, by their ends.
    pub slits: Vec<[DVec3; 2]>,
    /// The near surface of each piece, if the layer has several pieces but no more than [`OUTLINED_MAX`].
    pub outlines: Vec<[DVec3; 3]>,
    /// The ends of t.
    pub ends: [f64; 2],
}

/// The volume of each layer of a camera around the scene in `bounds`, and how many slits far outside were left out.
pub fn layers(camera: &Camera, bounds: Option<Box3>) -> (Vec<LayerVolume>, usize) {
    let mut layers: Vec<LayerVolume> = (0..camera.layers.len()).map(|k| LayerVolume::of(camera, k, bounds)).collect();
    let mut points: Vec<DVec3> = bounds.map(|b| corners(b).to_vec()).unwrap_or_default();
    let curves = layers.iter().flat_map(|layer| layer.curves.iter().flatten());
    points.extend(curves.flat_map(|c| [0.0, 0.25, 0.5, 0.75, 1.0].map(|t| c.at(t))));
    let left_out = drop_far_slits(&mut layers, &points);
    (layers, left_out)
}

/// The corners of a box: bits 0, 1 and 2 of a corner's number say which side of x, y and z it is on.
pub fn corners((lo, hi): Box3) -> [DVec3; 8] {
    let side = |k: usize, bit: usize, axis: usize| if k >> bit & 1 == 0 { lo[axis] } else { hi[axis] };
    [0, 1, 2, 3, 4, 5, 6, 7].map(|k| DVec3::new(side(k, 0, 0), side(k, 1, 1), side(k, 2, 2)))
}

/// The numbers of the two corners of each of a box's twelve edges.
#[cfg(feature = "cli")]
pub fn box_edges() -> impl Iterator<Item = [usize; 2]> {
    (0..8).flat_map(|k| [1, 2, 4].map_each(|bit| [k, k | bit])).filter(|[k, end]| k != end)
}

impl LayerVolume {
    fn of(camera: &Camera, layer: usize, bounds: Option<Box3>) -> LayerVolume {
        let (n, m) = (PIXELS.0.min(camera.width - 1), PIXELS.1.min(camera.height - 1));
        let pixel = |x: u32, y: u32| (spread(x, n, camera.width), spread(y, m, camera.height));
        let at = |(i, j): (u32, u32)| camera.curve(layer, i, j).map(|(_, curve)| curve);
        let mut curves: Vec<_> = (0..=m).flat_map(|y| (0..=n).map(move |x| pixel(x, y))).map(at).collect();
        // the layers of a chain continue each other
        let whole = layer + 1 < camera.layers.len() || matches!(camera.layers[layer], Rays::Curves(_));
        let ends = if whole { [0.0, 1.0] } else { ends(&curves, bounds, camera.t_range) };
        if !whole {
            // of straight rays: P and P + D
            let clipped =
                |c: &Curve| Curve::new(&ends.map_each(|t| c.points()[0] + t * (c.points()[1] - c.points()[0])));
            curves.iter_mut().flatten().for_each(|c| *c = clipped(c));
        }
        let (slits, outlines) = match &camera.layers[layer] {
            Rays::Pieces(pieces) => (slits(camera, pieces), outlines(pieces, ends[0])),
            _ => (Vec::new(), Vec::new()),
        };
        LayerVolume { columns: n as usize + 1, curves, slits, outlines, ends }
    }

    /// Points of the surface at t = 0 (near) or 1 (far), row by row or column by column.
    fn lines(&self, t: f64, by_rows: bool) -> Vec<Vec<Option<DVec3>>> {
        let rows = self.curves.len() / self.columns;
        let at = |x: usize, y: usize| self.curves[y * self.columns + x].map(|c| c.at(t));
        match by_rows {
            true => (0..rows).map(|y| (0..self.columns).map(|x| at(x, y)).collect()).collect(),
            false => (0..self.columns).map(|x| (0..rows).map(|y| at(x, y)).collect()).collect(),
        }
    }

    /// The rays that are drawn.
    pub fn rays(&self) -> impl Iterator<Item = &Curve> {
        let drawn = |k: usize| (k % self.columns).is_multiple_of(STEP) && (k / self.columns).is_multiple_of(STEP);
        self.curves.iter().enumerate().filter(move |(k, _)| drawn(*k)).filter_map(|(_, curve)| curve.as_ref())
    }

    /// Lines of the far ends of the rays.
    pub fn far(&self) -> Vec<Vec<DVec3>> {
        let of = |by_rows: bool| {
            let far = self.lines(1.0, by_rows);
            // where pixels on the border have no ray: lines inside, as of the near surface
            let border = [far.first(), far.last()].into_iter().flatten();
            let lines: Vec<_> = match border.clone().flatten().all(Option::is_some) {
                true => border.collect(),
                false if self.outlines.is_empty() => far.iter().step_by(STEP / 2).collect(),
                // pieces apart in the image may be anywhere
                false => Vec::new(),
            };
            unbroken(lines.into_iter())
        };
        [true, false].into_iter().flat_map(of).collect()
    }

    /// Lines of the near surface, if it is not drawn by [`LayerVolume::outlines`].
    pub fn near(&self) -> Vec<Vec<DVec3>> {
        let ways = [true, false].into_iter().filter(|_| self.outlines.is_empty());
        ways.flat_map(|by_rows| unbroken(self.lines(0.0, by_rows).iter().step_by(STEP))).collect()
    }
}

/// Lines without the parts where pixels have no ray or the surface jumps.
fn unbroken<'a>(lines: impl Iterator<Item = &'a Vec<Option<DVec3>>>) -> Vec<Vec<DVec3>> {
    let runs: Vec<Vec<DVec3>> = lines.flat_map(|line| runs(line)).collect();
    let steps = runs.iter().flat_map(|run| run.windows(2).map(|w| w[0].distance(w[1])));
    let Some(usual) = quantile(steps.filter(|s| *s > 0.0).collect(), 0.5) else { return Vec::new() };
    let parts = runs.iter().flat_map(|run| run.chunk_by(|a, b| a.distance(*b) <= JUMP * usual));
    parts.filter(|part| part.len() > 1).map(<[DVec3]>::to_vec).collect()
}

/// Pixel `k` of `0..=n` that are spread evenly over `count`, ends included.
pub fn spread(k: u32, n: u32, count: u32) -> u32 {
    // the product is under 2^16 * 2^5
    (k * (count - 1) + n / 2).checked_div(n).unwrap_or(0)
}

/// The parts of a line between its gaps, of two points at least.
pub fn runs<T: Copy>(line: &[Option<T>]) -> impl Iterator<Item = Vec<T>> + '_ {
    let parts = line.split(Option::is_none).filter(|part| part.len() > 1);
    parts.map(|part| part.iter().flatten().copied().collect())
}

/// Takes out slits far from all `points`, and says how many.
fn drop_far_slits(layers: &mut [LayerVolume], points: &[DVec3]) -> usize {
    let (lo, hi) = points.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(l, h), p| (l.min(*p), h.max(*p)));
    let (middle, reach) = ((lo + hi) / 2.0, SLIT_REACH * (hi - lo).length());
    let mut left_out = 0;
    for layer in layers {
        let before = layer.slits.len();
        layer.slits.retain(|slit| slit.iter().all(|p| p.distance(middle) <= reach));
        left_out += before - layer.slits.len();
    }
    left_out
}

/// The ends of t between which a layer of straight rays is drawn: `t_range` where it is about as long as the scene, else
/// up to where most rays have left the scene's box. t from 0 to 1 without a scene.
fn ends(curves: &[Option<Curve>], bounds: Option<Box3>, [least, most]: [f64; 2]) -> [f64; 2] {
    let Some((lo, hi)) = bounds else { return [least.max(0.0), most.min(least.max(0.0) + 1.0)] };
    let (middle, size) = ((lo + hi) / 2.0, (hi - lo).length());
    let rays = || curves.iter().flatten().map(|c| (c.points()[0], c.points()[1] - c.points()[0]));
    let spans: Vec<[f64; 2]> = rays().filter_map(|(p, d)| span(p, d, lo, hi)).collect();
    let reach = quantile(spans.iter().map(|s| s[1]).filter(|t| *t > 0.0).collect(), LEFT_SHARE);
    // rays that all miss go on to beside the scene
    let beside = || quantile(rays().map(|(p, d)| (p.distance(middle) + size / 2.0) / d.length()).collect(), 0.5);
    let reach = reach.or_else(beside).unwrap_or(1.0);
    let back = quantile(spans.iter().map(|s| s[0].min(0.0)).collect(), 1.0 - LEFT_SHARE).unwrap_or(0.0);
    let first = if least >= -FAR_REACH * reach { least } else { back.max(least) };
    let last = if most <= FAR_REACH * reach { most } else { reach.max(first) };
    [first, last]
}

/// The finite number that a share of all lie below.
fn quantile(mut numbers: Vec<f64>, share: f64) -> Option<f64> {
    numbers.retain(|t| t.is_finite());
    numbers.sort_by(f64::total_cmp);
    let last = numbers.len().checked_sub(1)?;
    Some(numbers[(share * last as f64).round() as usize])
}

/// The t at which the ray p + t d enters and leaves the box.
fn span(p: DVec3, d: DVec3, lo: DVec3, hi: DVec3) -> Option<[f64; 2]> {
    let (mut from, mut to) = (f64::NEG_INFINITY, f64::INFINITY);
    for axis in 0..3 {
        if d[axis] == 0.0 {
            if p[axis] < lo[axis] || p[axis] > hi[axis] {
                return None;
            }
            continue;
        }
        let (a, b) = ((lo[axis] - p[axis]) / d[axis], (hi[axis] - p[axis]) / d[axis]);
        (from, to) = (from.max(a.min(b)), to.min(a.max(b)));
    }
    (from <= to).then_some([from, to])
}

/// The places at t of the pieces' corners, if there are several, and few enough to distinguish.
fn outlines(pieces: &Pieces, t: f64) -> Vec<[DVec3; 3]> {
    let corners = pieces.pieces.iter().filter_map(|piece| Some(piece.corners_px?.map_each(|q| piece_at(piece, q, t))));
    if (2..=OUTLINED_MAX).contains(&pieces.pieces.len()) { corners.collect() } else { Vec::new() }
}

/// X(t) of a piece's ray at an image place, px.
fn piece_at(piece: &Piece, at_px: DVec2, t: f64) -> DVec3 {
    let offset = at_px - piece.centre_px;
    let ray = piece.bundle.ray(offset.x, offset.y);
    ray.origin + t * ray.direction
}

/// The slits of a layer's first pieces, each as long as the piece makes it; a point twice where the rays meet.
fn slits(camera: &Camera, pieces: &Pieces) -> Vec<[DVec3; 2]> {
    let (w, h) = (f64::from(camera.width), f64::from(camera.height));
    let image = [(0.0, 0.0), (w, 0.0), (0.0, h), (w, h)].map_each(DVec2::from);
    let mut slits = Vec::new();
    for piece in pieces.pieces.iter().take(SLITS_MAX) {
        let (class, roots) = piece_class(&piece.bundle);
        let corners = piece.corners_px.map_or(image.to_vec(), |c| c.to_vec());
        for t in roots {
            let points: Vec<DVec3> = corners.iter().map(|q| piece_at(piece, *q, t)).collect();
            let pairs = points.iter().enumerate().flat_map(|(k, a)| points[k + 1..].iter().map(move |b| [*a, *b]));
            let longest = pairs.max_by(|a, b| a[0].distance(a[1]).total_cmp(&b[0].distance(b[1])));
            let meets = class == Class::Pinhole.name();
            slits.extend(longest.map(|[a, b]| if meets { [a, a] } else { [a, b] }));
        }
    }
    slits
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ray(p: [f64; 3], d: [f64; 3]) -> Option<Curve> {
        let (p, d) = (DVec3::from(p), DVec3::from(d));
        Some(Curve::new(&[p, p + d]))
    }

    #[test]
    fn rays_end_with_the_scene_or_with_t() {
        let bounds = Some((DVec3::splat(-1.0), DVec3::splat(1.0)));
        let rays = [ray([0., 0., 5.], [0., 0., -2.]), ray([0.5, 0., 5.], [0., 0., -2.]), None];
        let inf = f64::INFINITY;
        assert_eq!(ends(&rays, bounds, [0.0, inf]), [0.0, 3.0]);
        assert_eq!(ends(&rays, bounds, [0.0, 1e9]), [0.0, 3.0]);
        assert_eq!(ends(&rays, bounds, [1.0, 2.5]), [1.0, 2.5]);
        assert_eq!(ends(&rays, bounds, [0.0, 5.0]), [0.0, 5.0]);
        assert_eq!(ends(&rays, bounds, [f64::NEG_INFINITY, inf]), [0.0, 3.0]);
        let inside = [ray([0., 0., 0.], [0., 0., -2.])];
        assert_eq!(ends(&inside, bounds, [f64::NEG_INFINITY, inf]), [-0.5, 0.5]);
        assert_eq!(ends(&rays, None, [0.0, inf]), [0.0, 1.0]);
        // all miss: to beside the scene, half its size beyond
        let miss = [ray([0., 9., 0.], [0., 3., 0.]), ray([9., 9., 0.], [1., 0., 0.])];
        let [first, last] = ends(&miss, bounds, [0.0, inf]);
        assert!(first == 0.0 && last > 3.0 && last.is_finite(), "{last}");
    }

    #[test]
    fn spans_of_a_box() {
        let (lo, hi) = (DVec3::ZERO, DVec3::new(2.0, 2.0, 2.0));
        assert_eq!(span(DVec3::new(-1., 1., 1.), DVec3::X, lo, hi), Some([1.0, 3.0]));
        assert_eq!(span(DVec3::new(-1., 3., 1.), DVec3::X, lo, hi), None);
        assert_eq!(span(DVec3::new(-1., -1., 1.), DVec3::new(1., -1., 0.), lo, hi), None);
        assert_eq!(span(DVec3::ONE, DVec3::new(0., 0., -0.5), lo, hi), Some([-2.0, 2.0]));
    }
}
