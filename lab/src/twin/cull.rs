//! cull in f64: which clusters may be seen in which squares of the image.

use super::KernelInputs;
use anamorph::internals::gpu::layout::{BRANCH, Cluster, LEVEL_CELL, Node, RAYS_AFFINE, RAYS_DISCONTINUOUS, RAYS_NONE};
use glam::DVec3;

/// How a node's bundle is bounded: all boxes and radii grow by `tolerance` times the sizes of what they are made of, and
/// beyond `refine_to` in t only origins and directions are bounded, separately.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bound {
    pub tolerance: f64,
    pub refine_to: f64,
}

impl Bound {
    /// The nodes' own bound.
    pub const PLAIN: Bound = Bound { tolerance: 0.0, refine_to: f64::INFINITY };
    /// The pairs that a kernel must keep: all but those that its rounding may lose. The nodes' radii hold 2^-22 of the same
    /// sizes for that (plan and clusters), and an f32 kernel sums at most four terms, 2^-24 each.
    pub const NEEDED: Bound = Bound { tolerance: -1.0 / (1u64 << 22) as f64, refine_to: f64::INFINITY };
    /// What a kernel may keep: 1e-6 of tolerance on t, taken three times, and its rounding; and no refinement beyond the t whose
    /// product with a scene-sized number may overflow f32.
    pub const ALLOWED: Bound = Bound { tolerance: 1.0 / (1u64 << 18) as f64, refine_to: 0.99e15 };
}

/// Children met by which a cluster is handed on undivided, where one affine bundle bounds the node's tiles too.
pub const HAND_ON: usize = 4;

/// The highest level of what is handed on.
pub const HAND_ON_LEVEL: u32 = 3;

/// How often a range of t is narrowed by the width of the bundle over it.
pub const REFINEMENTS: u32 = 2;

/// A node's address, as items of the lists name it; of a cell: [`LEVEL_CELL`], and its number's low 14 bits in `x`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Address {
    pub level: u32,
    pub x: u32,
    pub y: u32,
}

impl Address {
    pub fn pack(self) -> u32 {
        self.level << 28 | self.y << 14 | self.x
    }

    pub fn unpack(word: u32) -> Address {
        Address { level: word >> 28, x: word & 0x3fff, y: word >> 14 & 0x3fff }
    }

    pub fn of_cell(cell: u32) -> Address {
        Address::unpack(LEVEL_CELL << 28 | cell)
    }

    /// The cell that it names.
    pub fn cell(self) -> Option<u32> {
        (self.level == LEVEL_CELL).then_some(self.y << 14 | self.x)
    }
}

/// The items that cull hands to bin, and those between its steps.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Culled {
    /// (cluster, node) words.
    pub work: Vec<[u32; 2]>,
    /// Queue k holds what step k reads; the first is not written: all clusters, at a node above the top level.
    pub queues: Vec<Vec<[u32; 2]>>,
}

/// Descends from the top of the tree with every cluster of the batch.
pub fn cull(input: &KernelInputs, bound: Bound) -> Culled {
    let p = &input.params;
    let top = Address { level: p.levels, x: 0, y: 0 }.pack();
    let all = (p.cluster_first..p.cluster_first + p.cluster_count).map(|c| [c, top]).collect();
    let mut culled = Culled { work: Vec::new(), queues: vec![all] };
    for _ in 0..input.cull_steps {
        let mut next = Vec::new();
        // the queue that the step before has left
        for &[cluster, node] in &culled.queues[culled.queues.len() - 1] {
            let node = Address::unpack(node);
            let met: Vec<Address> = input
                .children(node)
                .into_iter()
                .filter(|&child| node_meets(input, child, &input.clusters[cluster as usize], bound))
                .collect();
            if hands_on(input, node, met.len()) {
                culled.work.push([cluster, node.pack()]);
                continue;
            }
            for child in met {
                if !input.is_descended(child) {
                    culled.work.push([cluster, child.pack()]);
                } else if child.level > 0 {
                    next.push([cluster, child.pack()]);
                } else {
                    let cells = input
                        .children(child)
                        .into_iter()
                        .filter(|&cell| node_meets(input, cell, &input.clusters[cluster as usize], bound));
                    culled.work.extend(cells.map(|cell| [cluster, cell.pack()]));
                }
            }
        }
        culled.queues.push(next);
    }
    // the last step writes work alone
    culled.queues.pop();
    culled
}

/// A node that is left undivided when so many of its children are met.
pub fn hands_on(input: &KernelInputs, node: Address, met: usize) -> bool {
    may_hand_on(input, node) && met > HAND_ON
}

/// A node that may be left undivided: one bundle over many tiles, and not over too many.
pub fn may_hand_on(input: &KernelInputs, node: Address) -> bool {
    let above_tiles = (2..input.params.levels).contains(&node.level) && node.level <= HAND_ON_LEVEL;
    above_tiles && input.node(node).rays == RAYS_AFFINE
}

impl KernelInputs<'_> {
    pub fn node(&self, at: Address) -> &Node {
        let level = at.level as usize;
        let index = match at.cell() {
            Some(cell) => self.cells[cell as usize].node,
            None => self.params.level_start[level] + at.y * self.params.level_width[level] + at.x,
        };
        &self.nodes[index as usize]
    }

    /// Whether cull goes on from a node that a cluster meets: from all above level 1, and there and below where rays are
    /// discontinuous.
    pub fn is_descended(&self, at: Address) -> bool {
        at.cell().is_none() && (at.level > 1 || self.node(at).rays == RAYS_DISCONTINUOUS)
    }

    /// The nodes one level down, row by row; of a tile its cells.
    pub fn children(&self, at: Address) -> Vec<Address> {
        if at.level == 0 {
            let tile = (at.y * self.params.tiles_x + at.x) as usize;
            return (self.tile_start[tile]..self.tile_start[tile + 1]).map(Address::of_cell).collect();
        }
        let level = at.level - 1;
        let end = |from: u32, count: u32| (from + BRANCH).min(count);
        let (x0, y0) = (at.x * BRANCH, at.y * BRANCH);
        let x1 = end(x0, self.params.level_width[level as usize]);
        let y1 = end(y0, self.params.level_height[level as usize]);
        (y0..y1).flat_map(|y| (x0..x1).map(move |x| Address { level, x, y })).collect()
    }

    /// The node one level up; of a cell its tile.
    pub fn parent(&self, at: Address) -> Address {
        match at.cell() {
            Some(cell) => {
                let tile = self.cells[cell as usize].tile;
                Address { level: 0, x: tile % self.params.tiles_x, y: tile / self.params.tiles_x }
            }
            None => Address { level: at.level + 1, x: at.x / BRANCH, y: at.y / BRANCH },
        }
    }
}

/// Whether any ray of the node may meet the box of a cluster, or of a triangle group, at a t in range?
pub fn node_meets(input: &KernelInputs, at: Address, cluster: &Cluster, bound: Bound) -> bool {
    let node = input.node(at);
    if node.rays == RAYS_NONE {
        return false;
    }
    let beam = Beam::new(node, cluster, bound.tolerance);
    let [t_min, t_max] = input.t_range();
    let forward = t_max >= 0.0 && beam.meets([t_min.max(0.0), t_max], bound);
    let backward = t_min < 0.0 && beam.reversed().meets([(-t_max).max(0.0), -t_min], bound);
    forward || backward
}

fn v(a: [f32; 3]) -> DVec3 {
    DVec3::from(a.map(f64::from))
}

/// The rays of a node relative to the centre of a box: `P = p + x px + y py`, `D = d + x dx + y dy` for x, y in
/// [-1, 1], and half-sizes that all the rest adds up to.
struct Beam {
    p: [DVec3; 3],
    d: [DVec3; 3],
    /// Of the box and of what origins may be off.
    half: DVec3,
    /// Of what directions may be off, a unit of t.
    half_a_t: DVec3,
}

impl Beam {
    fn new(node: &Node, cluster: &Cluster, tolerance: f64) -> Beam {
        let (centre, half) = (v(cluster.centre), v(cluster.half));
        let (p, d) = ([node.p, node.px, node.py].map(v), [node.d, node.dx, node.dy].map(v));
        let sizes = |c: &[DVec3; 3], r: f32| c.iter().map(|v| v.abs()).sum::<DVec3>() + f64::from(r);
        let (size_p, size_d) = (sizes(&p, node.r_p) + centre.abs() + half, sizes(&d, node.r_d));
        Beam {
            p: [p[0] - centre, p[1], p[2]],
            d,
            half: half + f64::from(node.r_p) + tolerance * size_p,
            half_a_t: DVec3::splat(f64::from(node.r_d)) + tolerance * size_d,
        }
    }

    /// The same rays, run through the other way.
    fn reversed(&self) -> Beam {
        Beam { d: self.d.map(|d| -d), ..*self }
    }

    /// Some t in the range (t >= 0) may lie in the box: first with origins and directions bounded separately, then with both
    /// together where the bundle is widest in what was left, and again in what that leaves. The width is convex in t, so
    /// largest at an end.
    fn meets(&self, range: [f64; 2], bound: Bound) -> bool {
        let still = self.half + self.p[1].abs() + self.p[2].abs();
        let widening = self.half_a_t + self.d[1].abs() + self.d[2].abs();
        let coarse = self.within(still, widening, range);
        if coarse[0] > coarse[1] || coarse[1] > bound.refine_to {
            return coarse[0] <= coarse[1];
        }
        let width = |t: f64| {
            (self.p[1] + t * self.d[1]).abs() + (self.p[2] + t * self.d[2]).abs() + self.half + t * self.half_a_t
        };
        let refine = |[from, to]: [f64; 2]| {
            // an empty range stays so
            if from > to { [from, to] } else { self.within(width(from).max(width(to)), DVec3::ZERO, [from, to]) }
        };
        let left = (0..REFINEMENTS).fold(coarse, |range, _| refine(range));
        left[0] <= left[1]
    }

    /// The part of a range in which `|p + t d| <= still + t widening` in every component; empty: from > to.
    fn within(&self, still: DVec3, widening: DVec3, [mut from, mut to]: [f64; 2]) -> [f64; 2] {
        for axis in 0..3 {
            for sign in [1.0, -1.0] {
                // t (sign d - widening) <= still - sign p
                let (slope, distance) = (sign * self.d[0][axis] - widening[axis], still[axis] - sign * self.p[0][axis]);
                if slope > 0.0 {
                    to = to.min(distance / slope);
                } else if slope < 0.0 {
                    from = from.max(distance / slope);
                } else if distance < 0.0 {
                    return [1.0, 0.0];
                }
            }
        }
        [from, to]
    }
}
