//! What the kernels read of a camera's optics for each bounce, and what a pixel shows that sees a mirror or lens.

use super::bounce::{bounce, table};
use super::raster::Visibility;
use super::{KernelInputs, Real};
use anamorph::internals::camera::Camera;
use anamorph::internals::engine::bounces::bounces;
use anamorph::internals::engine::plan::Plan;
use anamorph::internals::engine::plan::curves::RayTable;
use anamorph::internals::engine::surface::OpticsSurface;
use anamorph::internals::engine::tables;
use anamorph::internals::gpu::layout::{Cell, NONE, Node, Optic, PathState};
use anamorph::internals::scene::Scene;

/// What the kernels read of the optics for one bounce.
#[derive(Debug, Clone, Copy)]
pub struct OpticsInput<'a> {
    pub optic: Optic,
    /// That of the next bounce.
    pub next: Option<Optic>,
    /// One per pixel of the band.
    pub paths: &'a [PathState],
    pub surface: &'a OpticsSurface,
}

/// What happened to a pixel's ray at earlier bounces.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Behind {
    /// Factor of the colour that the ray sees.
    pub light: [f32; 3],
    /// Summed over the earlier rays, world units.
    pub length: f32,
    /// The surface of the optics that was met first, and the number of its piece among all pieces.
    pub first: Option<(u32, u32)>,
}

impl OpticsInput<'_> {
    /// The index of a surface's piece among the optics' pieces.
    pub fn piece_of(&self, surface: u32) -> u32 {
        match self.surface {
            OpticsSurface::Corners(corners) => corners[3 * surface as usize].piece,
            OpticsSurface::Quadrics(_) | OpticsSurface::Torus(_) | OpticsSurface::Wave(_) => surface,
        }
    }

    /// Rays of this bounce may meet the surface.
    pub fn is_seen(&self) -> bool {
        self.optic.bounces == 0 || self.optic.sees_itself == 1
    }

    fn is_bounced(&self) -> bool {
        self.optic.bounces > 0
    }
}

impl KernelInputs<'_> {
    /// No ray of this bounce meets the triangle.
    pub fn is_excluded(&self, id: u32) -> bool {
        self.optics.is_some_and(|o| id >= o.optic.first_id && !o.is_seen())
    }

    /// The pixel's ray starts on the triangle.
    pub fn starts_on(&self, pixel: usize, id: u32) -> bool {
        self.optics.is_some_and(|o| o.is_bounced() && o.paths[pixel].last == id)
    }

    /// The pixel is shown by this bounce, or by one to come, where its ray meets nothing.
    pub fn has_path(&self, x: u32, y: u32) -> bool {
        let pixel = (y * self.params.width + x) as usize;
        self.optics.is_none_or(|o| !o.is_bounced() || o.paths[pixel].last != NONE)
    }

    /// The ray goes on from this surface at the next bounce.
    pub fn goes_on(&self, id: u32) -> bool {
        self.optics.is_some_and(|o| id >= o.optic.first_id && o.optic.ends == 0)
    }

    /// The surface's appearance where rays end on it.
    pub fn base(&self, id: u32) -> Option<[f32; 3]> {
        self.optics.filter(|o| id >= o.optic.first_id).map(|o| o.optic.base)
    }

    /// The ray ends on a surface that is no triangle.
    pub fn ends_on_smooth(&self, id: u32) -> bool {
        self.base(id).is_some() && self.optics.is_some_and(|o| o.surface.is_smooth())
    }

    pub fn behind(&self, pixel: u32) -> Behind {
        let Some(optics) = &self.optics else { return Behind { light: [1.0; 3], length: 0.0, first: None } };
        let path = &optics.paths[pixel as usize];
        let first = (path.first != NONE).then(|| (path.first, optics.optic.piece_first + path.piece));
        Behind { light: path.light, length: path.length, first }
    }
}

/// The optics as the engine lays them out. Of split rays the twin follows only the main branch, with its share of the light. It renders
/// cameras with an atlas as if they had none.
pub struct Optics {
    pub depth: u32,
    /// By the number of bounces.
    bounces: Vec<Optic>,
    surface: OpticsSurface,
    /// Path states before the first bounce.
    unbounced: Vec<PathState>,
}

/// Rays of a band after one or more bounces.
pub struct BouncedRays {
    pub bounces: u32,
    pub rays: RayTable,
    pub paths: Vec<PathState>,
    pub nodes: Vec<Node>,
    pub tile_start: Vec<u32>,
    pub cells: Vec<Cell>,
}

impl Optics {
    /// Of the camera's optics, where it has them; `scene` holds their facets.
    pub fn new(scene: &Scene, camera: &Camera, plan: &Plan) -> Option<Optics> {
        let optics = &anamorph::internals::camera::optics::Optics { atlas: None, ..camera.optics.as_deref()?.clone() };
        let rows = plan.bands.iter().map(|b| b.rows).max().unwrap_or(0);
        let nothing = PathState { light: [1.0; 3], length: 0.0, first: NONE, last: NONE, piece: 0, pad0: 0 };
        Some(Optics {
            depth: optics.depth,
            bounces: bounces(Some(optics))
                .iter()
                .filter(|b| b.is_main)
                .map(|b| tables::optic(scene, camera, optics, plan, b))
                .collect(),
            surface: OpticsSurface::new(&optics.surface, plan.anchor),
            unbounced: vec![nothing; (rows * camera.width) as usize],
        })
    }

    /// The input of the rays of the eye, or of those that are `bounced`.
    pub fn input<'a>(&'a self, bounced: Option<&'a BouncedRays>) -> OpticsInput<'a> {
        let (count, paths) = bounced.map_or((0, &self.unbounced), |b| (b.bounces, &b.paths));
        let next = self.bounces.get(count as usize + 1).copied();
        OpticsInput { optic: self.bounces[count as usize], next, paths, surface: &self.surface }
    }
}

impl BouncedRays {
    /// The rays after a bounce of a band, without the tree of their bounds; `input` is any chunk of that band.
    pub fn new(input: &KernelInputs, visibility: &Visibility, real: Real) -> BouncedRays {
        let bounced = bounce(input, visibility, real);
        let tiles = input.params.tiles_x * input.params.tiles_y;
        let no_ray = PathState { first: NONE, last: NONE, ..bytemuck::Zeroable::zeroed() };
        BouncedRays {
            bounces: input.optics.map_or(0, |o| o.optic.bounces) + 1,
            rays: table(input, &bounced),
            paths: bounced.iter().map(|b| b.map_or(no_ray, |b| b.path)).collect(),
            nodes: Vec::new(),
            tile_start: (0..=tiles).collect(),
            cells: Vec::new(),
        }
    }
}
