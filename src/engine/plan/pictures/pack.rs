//! The patches of a picture as rows that kernels read.

use super::patch::{Patch, Patches, Square};
use crate::arrays::MapEach;
use crate::engine::plan::beams::{down, up};
use crate::gpu::layout::NONE;
use crate::scene::projector_light::ProjectorLight;
use glam::DVec3;

/// Boxes are enlarged by this, relative to the scene and to where the rays start: points and patches are rounded to 2^-24 each, in four
/// sums.
const BOX_ROUNDING: f64 = 1.0 / (1u64 << 20) as f64;

/// Rows of a picture's header, of a node and of a patch.
pub const HEADER_ROWS: u32 = 4;
const NODE_ROWS: u32 = 4;
const PATCH_ROWS: u32 = 8;

/// The units of a picture's rows: positions times `scale`, relative to `anchor`; directions times `d_scale`; and rays begin `skipped`
/// later than the camera's, no later than they meet the scene, which leaves more digits of it where that is far away.
pub struct Packing {
    anchor: DVec3,
    scale: f64,
    d_scale: f64,
    start: f64,
    skipped: f64,
    t_last: f64,
}

/// Nodes in preorder, each before those below it, and then the patches.
pub struct Packed {
    pub count: u32,
    pub rows: Vec<[f32; 4]>,
}

impl Packing {
    pub fn new(patches: &Patches, bounds: Option<(DVec3, DVec3)>, anchor: DVec3) -> Packing {
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

    pub fn header(
        &self,
        light: &ProjectorLight,
        [material, first, count]: [u32; 3],
    ) -> [[f32; 4]; HEADER_ROWS as usize] {
        let throw = light.throw;
        let t = |t: f64| (t * (self.scale / self.d_scale)).min(f64::from(f32::MAX)) as f32;
        let word = f32::from_bits;
        let size = [light.camera.width as f32, light.camera.height as f32];
        [
            [word(throw.mode as u32), word(material), word(first), word(count)],
            [throw.strength, throw.feather, throw.angle_power, throw.distance_power].map_each(|v| v as f32),
            [size[0], size[1], t(self.skipped - self.start), t(self.t_last - self.skipped)],
            [self.scale as f32, throw.distance.unwrap_or(0.0) as f32, word(throw.occlusion.into()), 0.0],
        ]
    }

    pub fn nodes(&self, root: &Square, first: u32) -> Packed {
        let (mut nodes, mut patches) = (Vec::new(), Vec::new());
        self.grow(root, &mut nodes, &mut patches);
        let count = nodes.len() as u32;
        let patches_first = first + NODE_ROWS * count;
        let node = |n: &PackedNode| {
            let ([p, d], patch) = (n.boxes, n.patch.map_or(NONE, |k| patches_first + PATCH_ROWS * k));
            let row = |v: DVec3, round: fn(f64) -> f32, last: u32| {
                let [x, y, z] = v.to_array().map_each(round);
                [x, y, z, f32::from_bits(last)]
            };
            [row(p[0], down, n.next), row(p[1], up, patch), row(d[0], down, 0), row(d[1], up, 0)]
        };
        let mut rows: Vec<[f32; 4]> = nodes.iter().flat_map(node).collect();
        rows.extend(patches.iter().flat_map(|patch| self.patch(patch)));
        Packed { count, rows }
    }

    /// Adds a square's nodes; the boxes around all below it.
    pub fn grow(
        &self,
        square: &Square,
        nodes: &mut Vec<PackedNode>,
        patches: &mut Vec<Patch>,
    ) -> Option<[[DVec3; 2]; 2]> {
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
        let [p, d] = [&patch.p, &patch.d].map_each(|of| of.map_each(|v| v.as_vec3()));
        let places = [patch.middle.x, patch.middle.y, patch.half.x, patch.half.y].map_each(|v| v as f32);
        let row = |k: usize| if k < 4 { p[k].extend(places[k]) } else { d[k - 4].extend(0.0) };
        std::array::from_fn(|k| row(k).to_array())
    }
}

#[derive(Clone, Copy)]
pub struct PackedNode {
    pub boxes: [[DVec3; 2]; 2],
    /// The node that follows all below this one.
    pub next: u32,
    pub patch: Option<u32>,
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
    [0, 1].map_each(|k| [a[k][0].min(b[k][0]), a[k][1].max(b[k][1])])
}
