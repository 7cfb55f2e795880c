//! A test whether any ray of an image may meet a box, by the bounds of rays that its bands have for [`super::super::stage::cull`].

use crate::arrays::MapEach;
use crate::camera::perturb::PERTURB;
use crate::engine::plan::nodes::Level;
use crate::engine::plan::turned::Turned;
use crate::engine::plan::{Band, Plan};
use crate::gpu::layout::{BRANCH, Node, RAYS_NONE};
use glam::DVec3;

/// The rays of an image, by bounds of squares of it.
#[derive(Clone, Copy)]
pub struct ImageRays<'a> {
    bands: &'a [Band],
    /// Origin of the bounds, world units.
    anchor: DVec3,
    scene_size: f64,
    t_range: [f64; 2],
}

/// Most nodes that are tested against one box; a box that needs more may be met.
const NODES_MAX: usize = 512;

/// Rounding of the sums below, relative to the sizes of their terms: each has less than 32 roundings of 2^-53.
const ROUNDING: f64 = 1.0 / (1u64 << 48) as f64;

/// Margin of a box, relative to its size and its distance from the anchor. Clusters have the same one: it covers the rounding of positions on
/// the device.
const BOX_TOLERANCE: f64 = 1.0 / (1u64 << 22) as f64;

/// Margin of a box, relative to its distance from the world's origin and the size of the scene. It covers the distances of a receiver's
/// triangles from its plane, 2^-32 of these, and of triangles from the ends of rays at which they count as met, 2^-32 too.
const PLACE_TOLERANCE: f64 = 1.0 / (1u64 << 31) as f64;

impl<'a> ImageRays<'a> {
    /// The rays of a plan's bands, which start and end at `t_range`. Returns `None` if the plan does not bound them as straight rays.
    pub fn of(plan: &'a Plan, t_range: [f64; 2]) -> Option<ImageRays<'a>> {
        let is_straight = plan.variant.rechecks() && plan.slabs.count() == 1;
        is_straight.then_some(ImageRays {
            bands: &plan.bands,
            anchor: plan.anchor,
            scene_size: plan.scene_size,
            t_range,
        })
    }

    /// Returns `true` only if every ray starts beyond a plane, where the product of its place with the unit normal is larger than `at`.
    pub fn start_beyond(&self, (normal, at): (DVec3, f64)) -> bool {
        let starts_beyond = |node: &Node, turned: Option<&Turned>| {
            let Bundle { p, d, r_p, r_d } = Bundle::of(node, turned);
            let t0 = self.t_range[0];
            let least = |c: &[DVec3; 3], radius: f64| {
                normal.dot(c[0]) - normal.dot(c[1]).abs() - normal.dot(c[2]).abs() - radius
            };
            let (own, ahead) = (least(&p, r_p), if t0 > 0.0 { t0 * least(&d, r_d) } else { 0.0 });
            let at = at - normal.dot(self.anchor);
            let sizes = size(&p) + r_p + t0 * (size(&d) + r_d) + at.abs() + self.anchor.length();
            own + ahead > at + BOX_TOLERANCE * sizes + PLACE_TOLERANCE * self.scene_size
        };
        self.t_range[0] >= 0.0
            && self.bands.iter().all(|band| {
                let Level { start, width, height, .. } = band.nodes.levels[band.nodes.levels.len() - 1];
                let top = &band.nodes.nodes[start as usize..(start + width * height) as usize];
                top.iter().all(|node| node.rays == RAYS_NONE || starts_beyond(node, band.turned.as_ref()))
            })
    }

    /// Returns `false` only if no ray meets the box between these corners.
    pub fn may_meet(&self, (lo, hi): (DVec3, DVec3)) -> bool {
        if lo.cmpgt(hi).any() {
            return false;
        }
        let half = (hi - lo) / 2.0;
        let center = lo + half - self.anchor;
        let margin = BOX_TOLERANCE * (center.abs() + half).max_element()
            + PLACE_TOLERANCE * ((lo.abs().max(hi.abs()) + self.anchor.abs()).max_element() + self.scene_size);
        let target = Target { center, half: half + margin };
        !target.half.is_finite() || self.bands.iter().any(|band| target.may_be_met(band, self.t_range))
    }
}

/// A box, relative to the anchor.
struct Target {
    center: DVec3,
    half: DVec3,
}

/// The rays P + t D of a node: P and D are affine over its square, give or take a radius.
struct Bundle {
    p: [DVec3; 3],
    d: [DVec3; 3],
    r_p: f64,
    r_d: f64,
}

impl Target {
    /// Descends from the top of the tree to the tiles, as long as a node may meet the box.
    fn may_be_met(&self, band: &Band, t_range: [f64; 2]) -> bool {
        let nodes = &band.nodes;
        let top = nodes.levels.len() - 1;
        let Level { width, height, .. } = nodes.levels[top];
        let mut left: Vec<(usize, u32, u32)> = (0..height).flat_map(|y| (0..width).map(move |x| (top, x, y))).collect();
        for _ in 0..NODES_MAX {
            let Some((level, x, y)) = left.pop() else { return false };
            let Level { start, width, .. } = nodes.levels[level];
            let node = &nodes.nodes[(start + y * width + x) as usize];
            if node.rays == RAYS_NONE || self.is_missed_by(&Bundle::of(node, band.turned.as_ref()), t_range) {
                continue;
            }
            let Some(level) = level.checked_sub(1) else { return true };
            let Level { width, height, .. } = nodes.levels[level];
            let children = |k: u32, count: u32| BRANCH * k..(BRANCH * (k + 1)).min(count);
            left.extend(children(y, height).flat_map(|y| children(x, width).map(move |x| (level, x, y))));
        }
        true
    }

    /// Returns whether a plane is found that has all rays of the bundle on one side and the box on the other.
    fn is_missed_by(&self, rays: &Bundle, t_range: [f64; 2]) -> bool {
        let forward = rays.d[0].normalize_or_zero();
        let slowest = forward.dot(rays.d[0]) - forward.dot(rays.d[1]).abs() - forward.dot(rays.d[2]).abs() - rays.r_d;
        let far = (rays.p[0] - self.center).length() + size(&rays.p[1..]) + rays.r_p + self.half.length();
        // a ray that is farther along has passed the box
        let most = if slowest > 0.0 { far / slowest * (1.0 + ROUNDING) } else { f64::INFINITY };
        let t = [t_range[0].max(-most), t_range[1].min(most)];
        if t[0] > t[1] {
            return true;
        }
        let [a, b, c, d] = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
            .map_each(|(x, y)| rays.d[0] + x * rays.d[1] + y * rays.d[2]);
        let to_box = self.center - rays.p[0];
        let normals = [
            forward,
            a.cross(b),
            b.cross(c),
            c.cross(d),
            d.cross(a),
            forward.cross(rays.p[1]),
            forward.cross(rays.p[2]),
            to_box - to_box.dot(forward) * forward,
            DVec3::X,
            DVec3::Y,
            DVec3::Z,
        ];
        normals.iter().any(|normal| self.is_beyond(normal.normalize_or_zero(), rays, t))
    }

    /// Returns whether the rays and the box have no number of `normal . x` in common.
    fn is_beyond(&self, normal: DVec3, rays: &Bundle, [t0, t1]: [f64; 2]) -> bool {
        let range = |c: &[DVec3; 3], radius: f64| {
            let middle = normal.dot(c[0]);
            let half = normal.dot(c[1]).abs() + normal.dot(c[2]).abs() + radius;
            [middle - half, middle + half]
        };
        let ([p_lo, p_hi], [d_lo, d_hi]) = (range(&rays.p, rays.r_p), range(&rays.d, rays.r_d));
        let ends = [t0 * d_lo, t0 * d_hi, t1 * d_lo, t1 * d_hi];
        let lo = p_lo + ends.into_iter().fold(f64::INFINITY, f64::min);
        let hi = p_hi + ends.into_iter().fold(f64::NEG_INFINITY, f64::max);
        let (middle, half) = (normal.dot(self.center), normal.abs().dot(self.half));
        let sizes = self.center.length()
            + self.half.length()
            + size(&rays.p)
            + rays.r_p
            + t0.abs().max(t1.abs()) * (size(&rays.d) + rays.r_d);
        // infinite where the range of t is: nothing is beyond then
        let slack = ROUNDING * sizes;
        lo > middle + half + slack || hi < middle - half - slack
    }
}

impl Bundle {
    /// The rays of a node in the world, perturbed or not.
    fn of(node: &Node, turned: Option<&Turned>) -> Bundle {
        let v = |v: [f32; 3]| DVec3::from(v.map_each(f64::from));
        let (p, d) = ([node.p, node.px, node.py].map_each(v), [node.d, node.dx, node.dy].map_each(v));
        let (r_p, r_d) = (f64::from(node.r_p), f64::from(node.r_d));
        let Some(turned) = turned else { return Bundle { p, d, r_p, r_d } };
        let [from_eye, x, y] = p.map_each(|v| turned.turned(v));
        let d = d.map_each(|v| turned.turned(v));
        Bundle { p: [turned.eye + from_eye, x, y], d, r_p: r_p + turned.perturb, r_d: r_d + PERTURB * size(&d) }
    }
}

/// The sum of the lengths.
fn size(vectors: &[DVec3]) -> f64 {
    vectors.iter().map(|v| v.length()).sum()
}
