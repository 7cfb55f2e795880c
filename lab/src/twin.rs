//! Twins: the stages of a frame in f64 on the host, `cull -> bin -> raster -> shade -> write`, one file each. With a mirror
//! or lens, `meet` runs beside raster, and after shade `bounce -> fit` and all stages again.
//!
//! A twin reads the same bytes as its kernel ([`KernelInputs`]) and computes the same lists and words, so a frame can be followed
//! stage by stage, and any stage can run on another's correct output. A twin defines the result of the stage, not the
//! kernel's algorithm: bin tests every pixel, so split and sort have no twins; shade bounds the error of f32. Twins are
//! simple and slow.

pub mod along;
pub mod bin;
pub mod bounce;
pub mod bounded;
pub mod cull;
pub mod curve;
pub mod deposit;
pub mod edge;
pub mod fit;
pub mod gather;
pub mod key;
pub mod meet;
pub mod optics;
pub mod quadric;
pub mod raster;
pub mod rays;
pub mod refract;
pub mod shade;
pub mod sift;
pub mod smooth;
pub mod solve;
pub mod solve_cell;
pub mod surface;
pub mod torus;
pub mod wave;
pub mod write;

pub use key::{KeyLayout, Real};

use anamorph::internals::camera::Camera;
use anamorph::internals::engine::clusters::{Chunk, Clustered, cluster};
use anamorph::internals::engine::plan::curves::RayTable;
use anamorph::internals::engine::plan::pages::Pages;
use anamorph::internals::engine::plan::variant::variant;
use anamorph::internals::engine::plan::{Plan, SceneContents, SceneExtent, SceneShape, Wanted};
use anamorph::internals::engine::tables::{Appearance, NormalsOf, Shadows, Span, after_bounce, params};
use anamorph::internals::engine::{Capacities, RunOptions};
use anamorph::internals::geometry::mesh::Mesh;
use anamorph::internals::gpu::device::AdapterFeatures;
use anamorph::internals::gpu::kernels::{RaysKind, SurfaceKind};
use anamorph::internals::gpu::layout::{Cell, Cluster, Node, ONE_SIDED, Params, Piece, Vertex};
use anamorph::internals::image::frame::{Channel, Frame, plane_of_words};
use anamorph::internals::scene::Scene;
use glam::DVec3;
use optics::{BouncedRays, Optics, OpticsInput};
use raster::{Corners, Visibility};

/// Everything that the kernels of one job read.
#[derive(Clone, Copy)]
pub struct KernelInputs<'a> {
    pub params: Params,
    pub clusters: &'a [Cluster],
    pub triangle_groups: &'a [Cluster],
    pub nodes: &'a [Node],
    pub cull_steps: u32,
    pub tile_start: &'a [u32],
    pub cells: &'a [Cell],
    pub pieces: &'a [Piece],
    pub kind: RaysKind,
    pub rays: Option<&'a RayTable>,
    /// Keys begin with a layer.
    pub slabbed: bool,
    pub triangles: &'a [[u32; 4]],
    pub vertices: &'a [Vertex],
    pub slot_of_id: &'a [u32],
    pub surfaces: &'a [[u32; 4]],
    /// Texture coordinates of each slot's corners, v downwards; empty if nothing needs them.
    pub uvs: &'a [[f32; 6]],
    pub appearance: &'a Appearance,
    pub optics: Option<OpticsInput<'a>>,
}

impl KernelInputs<'_> {
    /// A vertex relative to the anchor, as stored.
    fn vertex(&self, index: u32) -> DVec3 {
        self.vertices[index as usize].position()
    }

    /// The anchor: positions are relative to it.
    fn anchor(&self) -> DVec3 {
        self.appearance.shading.anchor.map(f64::from).into()
    }

    pub fn corners(&self, slot: u32) -> Corners {
        let [a, b, c, last] = self.triangles[slot as usize];
        Corners {
            v: [a, b, c].map(|k| self.vertex(k)),
            id: last & 0x0fff_ffff,
            reversed: last >> 28 & 7 >= 3,
            one_sided: last & ONE_SIDED != 0,
        }
    }

    /// How the frame's keys are laid out.
    pub fn keys(&self, real: Real) -> KeyLayout {
        KeyLayout { real, id_bits: self.params.id_bits, slabbed: self.slabbed }
    }

    /// The ends of t, inclusive.
    pub fn t_range(&self) -> [f64; 2] {
        [self.params.t_min, self.params.t_max].map(|t| t.iter().map(|&part| f64::from(part)).sum())
    }
}

/// The host's tables for a frame, as [`anamorph::internals::engine::Engine`] prepares them.
pub struct Tables {
    pub plan: Plan,
    pub clustered: Clustered,
    /// Clusters and triangle groups of each chunk.
    boxes: Vec<[Vec<Cluster>; 2]>,
    /// Surfaces and texture coordinates of each chunk, as in [`KernelInputs`].
    surfaces: Vec<SurfaceTables>,
    pub appearance: Appearance,
    pub optics: Option<Optics>,
}

/// Capacities that never overflow.
pub const LARGE: Capacities = Capacities {
    queue: u32::MAX as u64,
    work: u32::MAX as u64,
    tasks: u32::MAX as u64,
    pairs: u32::MAX as u64,
    recheck_items: u32::MAX as u64,
    edges: u32::MAX as u64,
};

/// Surfaces and texture coordinates of a chunk.
type SurfaceTables = (Vec<[u32; 4]>, Vec<[f32; 6]>);

fn surface_tables(clustered: &Clustered, mesh: &Mesh) -> Vec<SurfaceTables> {
    let is_plain = clustered.surfaces == SurfaceKind::Plain;
    let uvs = |chunk: &Chunk| if is_plain { Vec::new() } else { chunk.uvs(mesh) };
    clustered.chunks.iter().map(|chunk| (chunk.surfaces(mesh), uvs(chunk))).collect()
}

fn boxes(clustered: &Clustered) -> Vec<[Vec<Cluster>; 2]> {
    let of_chunk = |chunk: &Chunk| [chunk.clusters(clustered.anchor), chunk.triangle_groups(clustered.anchor)];
    clustered.chunks.iter().map(of_chunk).collect()
}

impl Tables {
    /// Bands and chunks are split so that no table exceeds `binding_limit` bytes.
    pub fn new(scene: &Scene, camera: &Camera, wanted: &Wanted, has: AdapterFeatures, binding_limit: u64) -> Tables {
        let scene = &*scene.with_optics(camera);
        let extent = SceneExtent::of(camera, SceneShape::of(scene));
        let contents = SceneContents::of(scene);
        let variant = variant(camera, contents, wanted, has, &RunOptions::default());
        let plan = Plan::new(variant, camera, contents, extent, wanted, has, binding_limit);
        let clustered = cluster(&*scene.mesh, extent.anchor, plan.variant.surfaces(), binding_limit);
        Tables {
            optics: Optics::new(scene, camera, &plan),
            boxes: boxes(&clustered),
            surfaces: surface_tables(&clustered, &scene.mesh),
            clustered: clustered.with_vertices(&scene.mesh),
            plan,
            appearance: Appearance::new(scene, NormalsOf::Scene, extent.anchor, &Pages::default(), Shadows::NONE, None),
        }
    }

    /// Returns these tables with other clusters of the triangles of `mesh`.
    pub fn with_clusters(self, clustered: Clustered, mesh: &Mesh) -> Tables {
        let (boxes, surfaces) = (boxes(&clustered), surface_tables(&clustered, mesh));
        Tables { boxes, surfaces, clustered: clustered.with_vertices(mesh), ..self }
    }

    /// All clusters of a chunk over a band, for the camera's own rays.
    pub fn input(&self, camera: &Camera, band: usize, chunk: usize, capacities: Capacities) -> KernelInputs<'_> {
        let ([clusters, triangle_groups], surfaces) = (&self.boxes[chunk], &self.surfaces[chunk]);
        let (band, chunk) = (&self.plan.bands[band], &self.clustered.chunks[chunk]);
        let ids = Span { first: chunk.id_first, count: chunk.id_count };
        let all = Span { first: 0, count: clusters.len() as u32 };
        KernelInputs {
            params: params(camera, &self.plan, band, ids, all, capacities, f32::MAX),
            clusters,
            triangle_groups,
            nodes: &band.nodes.nodes,
            cull_steps: band.nodes.cull_steps(),
            tile_start: &band.tiles.start,
            cells: &band.tiles.cells,
            pieces: &band.tiles.pieces,
            kind: self.plan.variant.rays.kind,
            rays: band.rays.as_ref(),
            slabbed: self.plan.variant.rays.slabbed,
            triangles: &chunk.triangles,
            vertices: &chunk.vertices,
            slot_of_id: &chunk.slot_of_id,
            surfaces: &surfaces.0,
            uvs: &surfaces.1,
            appearance: &self.appearance,
            optics: self.optics.as_ref().map(|o| o.input(None)),
        }
    }

    /// The same for rays that were reflected or refracted.
    pub fn bounced_input<'a>(
        &'a self,
        camera: &Camera,
        band: usize,
        chunk: usize,
        bounced: &'a BouncedRays,
    ) -> KernelInputs<'a> {
        let mut input = self.input(camera, band, chunk, LARGE);
        input.params = after_bounce(input.params);
        KernelInputs {
            nodes: &bounced.nodes,
            // where bounced rays are discontinuous is not known beforehand
            cull_steps: input.params.levels,
            tile_start: &bounced.tile_start,
            cells: &bounced.cells,
            kind: RaysKind::Field { incoherent: false },
            rays: Some(&bounced.rays),
            optics: self.optics.as_ref().map(|o| o.input(Some(bounced))),
            ..input
        }
    }

    /// Follows the rays of a band from bounce to bounce; `see` receives each with all chunks, and its visibility buffer.
    pub fn follow(&self, camera: &Camera, band: usize, real: Real, mut see: impl FnMut(&[KernelInputs], &Visibility)) {
        let chunks = || 0..self.clustered.chunks.len();
        let mut inputs: Vec<KernelInputs> = chunks().map(|c| self.input(camera, band, c, LARGE)).collect();
        let visibility = visible(&inputs, real);
        see(&inputs, &visibility);
        let depth = self.optics.as_ref().map_or(0, |o| o.depth);
        let mut bounced = (depth > 0).then(|| self.bounced(camera, band, &inputs[0], &visibility, real));
        while let Some(now) = bounced.take() {
            inputs = chunks().map(|c| self.bounced_input(camera, band, c, &now)).collect();
            let visibility = visible(&inputs, real);
            see(&inputs, &visibility);
            bounced = (now.bounces < depth).then(|| self.bounced(camera, band, &inputs[0], &visibility, real));
            inputs.clear();
        }
    }

    /// The rays of the next bounce of a band, with the tree of their bounds.
    fn bounced(
        &self,
        camera: &Camera,
        band: usize,
        input: &KernelInputs,
        visibility: &Visibility,
        real: Real,
    ) -> BouncedRays {
        let mut bounced = BouncedRays::new(input, visibility, real);
        let fitted = fit::fit(&self.bounced_input(camera, band, 0, &bounced));
        (bounced.nodes, bounced.cells) = (fitted.nodes.nodes, fitted.cells);
        bounced
    }
}

/// The first hits of the rays of a bounce, over all chunks.
pub fn visible(inputs: &[KernelInputs], real: Real) -> Visibility {
    let pixels = inputs.first().map_or(0, |i| i.params.width * i.params.height);
    let mut visibility = Visibility::new(pixels as usize);
    for input in inputs {
        let work = cull::cull(input, cull::Bound::PLAIN).work;
        let pairs: Vec<[u32; 2]> = bin::bin(input, &work, real).iter().map(|b| b.pair().pack()).collect();
        raster::raster(input, &pairs, real, &mut visibility);
    }
    if let Some(input) = inputs.first() {
        meet::meet(input, real, &mut visibility);
    }
    visibility
}

/// A frame by the twins alone: the planned channels, and 8-bit sRGB RGBA if planned.
pub fn render(scene: &Scene, camera: &Camera, wanted: &Wanted, binding_limit: u64) -> (Frame, Option<Vec<u32>>) {
    let has = AdapterFeatures { f64: true, atomics64: true, ..Default::default() };
    let tables = Tables::new(scene, camera, wanted, has, binding_limit);
    let channels = &tables.plan.planes;
    let mut planes: Vec<Vec<u32>> = vec![Vec::new(); channels.len()];
    for band in 0..tables.plan.bands.len() {
        let pixels = render_band(&tables, camera, band);
        for (plane, &channel) in planes.iter_mut().zip(channels) {
            // every pixel is a miss of the first chunk or a hit of one
            plane.extend(pixels.iter().map(|p| p.word(channel).unwrap_or(0)));
        }
    }
    let plane = |channel: Channel| channels.iter().position(|c| *c == channel).map(|k| &planes[k]);
    let srgb8 = match [Channel::R, Channel::G, Channel::B].map(plane) {
        [Some(r), Some(g), Some(b)] if wanted.srgb8 => {
            let colour = |k: usize| [r[k], g[k], b[k]].map(f32::from_bits);
            Some((0..r.len()).map(|k| write::write(colour(k), scene.tone)).collect())
        }
        _ => None,
    };
    let planes = channels.iter().zip(planes).map(|(&c, words)| (c, plane_of_words(c, words))).collect();
    (Frame { width: camera.width, height: camera.height, planes }, srgb8)
}

/// The pixels of a band, after all bounces and under all chunks.
fn render_band(tables: &Tables, camera: &Camera, band: usize) -> Vec<shade::Pixel> {
    let count = (tables.plan.bands[band].rows * camera.width) as usize;
    let mut pixels = vec![shade::Pixel::Untouched; count];
    tables.follow(camera, band, Real::F64, |inputs, visibility| {
        for input in inputs {
            for (pixel, shaded) in pixels.iter_mut().zip(shade::shade(input, visibility, Real::F64)) {
                if !matches!(shaded, shade::Pixel::Untouched) {
                    *pixel = shaded;
                }
            }
        }
    });
    pixels
}
