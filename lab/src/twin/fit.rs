//! fit in f64: the tree of nodes over bounced rays, as the host builds it for a camera's own rays.

use super::KernelInputs;
use super::cull::Address;
use anamorph::internals::camera::TILE;
use anamorph::internals::engine::plan::fit::Fit;
use anamorph::internals::engine::plan::nodes::{Nodes, WidthMeasure};
use anamorph::internals::engine::plan::tiles::{TileFits, TileRay, TileRays};
use anamorph::internals::gpu::layout::{BRANCH, Cell, Node};
use glam::{DVec2, DVec3};

/// Nodes, and one cell per tile.
pub struct Fitted {
    pub nodes: Nodes,
    pub cells: Vec<Cell>,
}

/// A ray of the band, by its pixel.
pub struct PixelRay {
    pub pixel: (u32, u32),
    pub p: DVec3,
    pub d: DVec3,
}

/// All levels over the rays of `input`. Besides these, only its parameters and optics are read.
pub fn fit(input: &KernelInputs) -> Fitted {
    let p = &input.params;
    let distance = input.optics.map_or(0.0, |o| f64::from(o.optic.scene_size));
    let tile = |tile: u32| {
        let at = Address { level: 0, x: tile % p.tiles_x, y: tile / p.tiles_x };
        let rays = rays_below(input, at);
        let mask = |r: &PixelRay| 1u64 << (r.pixel.1 % TILE * TILE + r.pixel.0 % TILE);
        let tile_rays = rays.iter().map(|r| TileRay { place: place_in(at, r.pixel), p: r.p, d: r.d });
        let whole = Fit::of(&TileRays { rays: tile_rays.collect(), ..TileRays::default() });
        (TileFits::from(whole), rays.iter().fold(0, |all, r| all | mask(r)))
    };
    let (bounds, masks): (Vec<TileFits>, Vec<u64>) = (0..p.tiles_x * p.tiles_y).map(tile).unzip();
    let cell = |(tile, mask): (u32, u64)| Cell {
        tile,
        node: tile,
        mask_lo: mask as u32,
        mask_hi: (mask >> 32) as u32,
        ..bytemuck::Zeroable::zeroed()
    };
    Fitted {
        nodes: Nodes::new(
            |k| &bounds[k],
            (p.tiles_x, p.tiles_y),
            WidthMeasure { distance, t_range: input.t_range(), incoherent: false, scene_size: 0.0 },
        ),
        cells: (0..).zip(masks).map(cell).collect(),
    }
}

/// The rays of the pixels below a node; those that are numbers.
pub fn rays_below(input: &KernelInputs, at: Address) -> Vec<PixelRay> {
    let (Some(table), side) = (input.rays, side_px(at)) else { return Vec::new() };
    let (width, height) = (input.params.width, input.params.height);
    let columns = at.x * side..((at.x + 1) * side).min(width);
    let rows = at.y * side..((at.y + 1) * side).min(height);
    let ray = |(i, j): (u32, u32)| {
        let first = 6 * (j as usize * (width as usize + 1) + i as usize);
        let number = |k: usize| f64::from(table.hi[first + k]) + f64::from(table.lo[first + k]);
        let v = |k: usize| DVec3::new(number(k), number(k + 1), number(k + 2));
        let all = &table.hi[first..first + 6];
        let is_ray = all[3..] != [0.0; 3] && all.iter().all(|x| x.is_finite());
        is_ray.then(|| PixelRay { pixel: (i, j), p: v(0), d: v(3) })
    };
    rows.flat_map(|j| columns.clone().map(move |i| (i, j))).filter_map(ray).collect()
}

/// How far origins and directions of rays of a node lie from its fit: what its radii must hold.
pub fn reach(node: &Node, at: Address, rays: &[PixelRay]) -> [f64; 2] {
    let v = |a: [f32; 3]| DVec3::from(a.map(f64::from));
    let (p, d) = ([node.p, node.px, node.py].map(v), [node.d, node.dx, node.dy].map(v));
    let off = |c: &[DVec3; 3], q: DVec2, of: DVec3| (c[0] + q.x * c[1] + q.y * c[2] - of).length();
    rays.iter().fold([0.0, 0.0], |[r_p, r_d], ray| {
        let place = place_in(at, ray.pixel);
        [r_p.max(off(&p, place, ray.p)), r_d.max(off(&d, place, ray.d))]
    })
}

/// Pixels per side of a node.
fn side_px(at: Address) -> u32 {
    TILE * BRANCH.pow(at.level)
}

/// A pixel's place in [-1, 1]^2 over a node.
fn place_in(at: Address, (i, j): (u32, u32)) -> DVec2 {
    let side = side_px(at);
    let place = |pixel: u32, node: u32| (f64::from(pixel - node * side) + 0.5) * 2.0 / f64::from(side) - 1.0;
    DVec2::new(place(i, at.x), place(j, at.y))
}
