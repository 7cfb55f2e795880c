//! What lies on the device between frames: the scene's chunks, the bands' tables, and the lists between the stages.

mod costs;
mod moves;
mod upload;

use super::Capacities;
use super::bounce_tables::BounceTables;
use super::bounces::{Bounce, bounces};
use super::buffer_table::{BufferSpec, ITEM_BYTES, Sizes, VEC4_BYTES, table};
use super::medium::{medium, voxels};
use super::pages::PageStore;
use super::tables::{Appearance, NormalsOf, Shadows, Span, after_bounce, materials, params, sample_offsets};
use crate::camera::Camera;
use crate::engine::clusters::Clustered;
use crate::engine::plan::hierarchy::moving::MovingBvh;
use crate::engine::plan::hierarchy::placed::PlacedBvh;
use crate::engine::plan::hierarchy::{Hierarchy, PackedBvh, TracedBvh};
use crate::engine::plan::pages::Pages;
use crate::engine::plan::pictures::ScenePictures;
use crate::engine::plan::turned::LensBand;
use crate::engine::plan::{Band, Plan};
use crate::geometry::mesh::Mesh;
use crate::geometry::time_steps::MovingMesh;
use crate::gpu::Gpu;
use crate::gpu::buffers::Buffers;
use crate::gpu::kernels::{LightsKind, Method};
use crate::gpu::layout::Params;
use crate::input::{Error, Result};
use crate::scene::Scene;
use crate::scene::volume::{Grid, Volume};
use costs::Costs;
use glam::DVec3;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Weak};
use upload::{chunk_on_device, place, upload_band};

pub struct Resident {
    pub chunks: Vec<ChunkOnDevice>,
    /// Tables of each band.
    pub bands: Vec<Buffers>,
    /// The viewers' tables that these bands hold, where the stage `aim` turns them.
    lenses: Vec<Option<Arc<LensBand>>>,
    /// The stage `aim` has not turned them to the present pose yet.
    pub needs_aim: AtomicBool,
    /// Lists, visibility and planes, shared by all bands.
    pub shared: Buffers,
    pub capacities: Capacities,
    /// Into how many batches the clusters of each chunk are split.
    pub batches: u32,
    /// How often raster goes over the busy tiles: again for those that have more pairs than it takes at once.
    pub raster_rounds: u32,
    /// As many pairs as a binding holds vec4s.
    pairs_by_tile: u64,
    /// One for every (band, chunk, batch), in the order of [`Resident::jobs`].
    params: Vec<Buffers>,
    /// The same for rays after a bounce.
    bounced_params: Vec<Buffers>,
    /// All bounces of a frame.
    pub bounces: Vec<Bounce>,
    /// What rays bounce off.
    pub bounce_tables: Option<BounceTables>,
    /// Frames may trace rays.
    traces: bool,
    /// Some rays are always traced.
    pub always_traces: bool,
    pub bvh: BvhState,
    /// Hierarchies were built again when triangles last moved.
    rebuilds: bool,
    costs: &'static Costs,
    /// Triangles without area.
    pub without_area: usize,
    /// Shadow casters: all triangles but the camera's own, which are the last ones.
    shadow_casters: Option<Hierarchy>,
    /// Where points lie in the pictures that are thrown onto surfaces.
    pictures: Option<ScenePictures>,
    facets: usize,
    /// Alpha masks: the images, and how each material uses them.
    alpha_masks: (Pages, Vec<Option<AlphaMask>>),
    /// The grid whose values alone are on the device.
    grid: Option<Arc<Grid>>,
    /// The meshes whose normals are on the device, where kernels know the places of meshes.
    meshes_with_normals: Option<Weak<Mesh>>,
}

/// How an image is wrapped, its cutoff and its blended material's opacity, its page, and its origin there.
type AlphaMask = (u32, (f32, Option<f32>), u32, [u32; 2]);

/// Triangles in their clusters, and the mesh that has them.
pub type Triangles<'a> = (&'a Clustered, MovingMesh<'a>);

pub struct ChunkOnDevice {
    pub buffers: Buffers,
    pub id_first: u32,
    pub id_count: u32,
    pub clusters: u32,
    /// Length of `triangles`.
    pub slots: u32,
    /// As [`Params::surface_rows`].
    surface_rows: u32,
    /// The hierarchy that trace follows, kept from the first move of triangles on.
    moving_bvh: Option<MovingBvh>,
    /// The hierarchies of meshes that stand in several places.
    placed_bvh: Option<PlacedBvh>,
}

/// The clusters of one batch in one band, for one bounce.
pub struct Job<'a> {
    pub index: usize,
    pub chunk: &'a ChunkOnDevice,
    pub params: &'a Buffers,
    pub clusters: u32,
}

impl Resident {
    /// Everything but the appearance of the scene, which [`Resident::upload_appearance`] uploads.
    pub fn new(
        gpu: &Gpu,
        scene: &Scene,
        clustered: &Clustered,
        camera: &Camera,
        plan: &Plan,
        capacities: Option<Capacities>,
    ) -> Result<Resident> {
        let bounces = bounces(camera.optics.as_deref());
        let always_traces =
            plan.variant.method() == Method::Trace || plan.variant.traces() && plan.variant.bounces_rays();
        let mut resident = Resident {
            chunks: Vec::new(),
            bands: Vec::new(),
            lenses: Vec::new(),
            needs_aim: AtomicBool::new(true),
            shared: Buffers::default(),
            capacities: Capacities { queue: 0, work: 0, tasks: 0, pairs: 0, recheck_items: 0, edges: 0 },
            batches: 1,
            raster_rounds: 1,
            pairs_by_tile: gpu.binding_limit() / VEC4_BYTES,
            params: Vec::new(),
            bounced_params: Vec::new(),
            bounce_tables: camera
                .optics
                .as_ref()
                .map(|o| BounceTables::new(gpu, scene, camera, o, plan, &bounces))
                .transpose()?,
            bounces,
            without_area: 0,
            traces: plan.variant.traces(),
            always_traces,
            bvh: BvhState::None,
            rebuilds: false,
            costs: if gpu.has.software { &Costs::SOFTWARE } else { &Costs::GPU },
            shadow_casters: None,
            pictures: None,
            facets: camera.optics.as_ref().and_then(|o| o.facets()).map_or(0, |f| f.triangles.len()),
            alpha_masks: Default::default(),
            grid: None,
            meshes_with_normals: None,
        };
        resident.upload_bands(gpu, plan)?;
        resident.upload_scene(gpu, (clustered, clustered.mesh(scene)), plan.origin)?;
        if plan.variant.samples_edges() {
            resident.shared.upload_uniform(gpu, "sample_offsets", &sample_offsets(&plan.sample_offsets))?;
        }
        resident.raster_rounds = resident.first_rounds(plan);
        resident.capacities = capacities.unwrap_or_else(|| resident.first_guess(camera, plan));
        resident.allocate_lists(gpu, camera, plan)?;
        Ok(resident)
    }

    /// Builds the hierarchies that trace follows, of the triangles that are on the device.
    pub fn build_bvh(&mut self, gpu: &Gpu, triangles: Triangles, origin: DVec3) -> Result<()> {
        self.bvh = BvhState::Built;
        self.upload_bvh(gpu, triangles, origin)
    }

    /// What tracing a frame costs: each chunk has a hierarchy of its own.
    pub fn trace_cost(&self, plan: &Plan) -> u64 {
        self.chunks.len() as u64 * plan.bands.iter().map(|band| self.costs.trace(plan, band)).sum::<u64>()
    }

    /// What raster costs in a frame whose lists cost so much.
    pub fn raster_cost(&self, lists: u64) -> u64 {
        if lists == 0 { 0 } else { self.costs.stages + lists }
    }

    /// A cost as time on an adapter like this one.
    pub fn milliseconds(&self, cost: u64) -> f64 {
        cost as f64 / f64::from(self.costs.millisecond)
    }

    /// What building the hierarchies would cost that are not there yet.
    pub fn build_cost(&self) -> u64 {
        if self.bvh == BvhState::None { self.rebuild_cost() } else { 0 }
    }

    /// Cost of building all hierarchies.
    pub fn rebuild_cost(&self) -> u64 {
        self.costs.triangle * self.chunks.iter().map(|chunk| u64::from(chunk.slots)).sum::<u64>()
    }

    /// Puts the triangles of a mesh on the device, anew where they were there before.
    pub fn upload_scene(&mut self, gpu: &Gpu, triangles: Triangles, origin: DVec3) -> Result<()> {
        let clustered = triangles.0;
        (self.without_area, self.rebuilds) = (clustered.without_area, false);
        self.bvh = if self.always_traces { BvhState::Built } else { BvhState::None };
        let mut there = std::mem::take(&mut self.chunks).into_iter().map(|c| c.buffers);
        let mut each = || there.next().unwrap_or_default();
        let on_device = |chunk| chunk_on_device(gpu, chunk, triangles, each());
        self.chunks = clustered.chunks.iter().map(on_device).collect::<Result<_>>()?;
        self.upload_bvh(gpu, triangles, origin)
    }

    /// Uploads the hierarchies that trace follows, relative to `origin`; empty ones while they are not built.
    pub fn upload_bvh(&mut self, gpu: &Gpu, (clustered, all): Triangles, origin: DVec3) -> Result<()> {
        if !self.traces {
            return Ok(());
        }
        if clustered.placed.is_some() {
            return self.upload_placed_bvh(gpu, clustered, origin);
        }
        let is_there = matches!(self.bvh, BvhState::Built | BvhState::Preferred);
        for (there, chunk) in self.chunks.iter_mut().zip(&clustered.chunks) {
            let of_chunk = || TracedBvh::new(&chunk.with_vertices(all, clustered.anchor), clustered.anchor - origin);
            let bvh = if is_there { of_chunk() } else { Some(TracedBvh::default()) };
            if bvh.is_none() {
                self.bvh = BvhState::GivenUp;
            }
            let bvh = bvh.unwrap_or_default();
            there.moving_bvh = None;
            there.buffers.upload_texels(gpu, "bvh", &bvh.nodes)?;
            there.buffers.upload_texels(gpu, "bvh_triangles", &bvh.triangles)?;
        }
        Ok(())
    }

    /// Uploads the hierarchies of meshes that stand in several places. The hierarchies of meshes stay if they are there; that of the places is
    /// built anew.
    pub(super) fn upload_placed_bvh(&mut self, gpu: &Gpu, clustered: &Clustered, origin: DVec3) -> Result<()> {
        let (Some(placed), Some(there)) = (&clustered.placed, self.chunks.first_mut()) else { return Ok(()) };
        let is_known = there.placed_bvh.is_some();
        let bvh = match there.placed_bvh.take() {
            Some(mut known) => known.place(placed, origin).then_some(known),
            None => PlacedBvh::new(clustered, placed, origin),
        };
        let rows = bvh.as_ref().and_then(|bvh| bvh.rows(placed, clustered.anchor));
        let (Some(mut bvh), Some(rows)) = (bvh, rows) else {
            self.bvh = BvhState::GivenUp;
            return Ok(());
        };
        if is_known {
            there.buffers.update_texels(gpu, "bvh", &bvh.traced.nodes, &bvh.top_rows())?;
        } else {
            there.buffers.upload_texels(gpu, "bvh", &bvh.traced.nodes)?;
            there.buffers.upload_texels(gpu, "bvh_triangles", &bvh.traced.triangles)?;
            // the device has them
            bvh.traced.triangles = Vec::new();
        }
        there.placed_bvh = Some(bvh);
        there.buffers.upload_texels(gpu, "instances", &rows)
    }

    /// Some rays are to be traced, and cannot be.
    pub fn cannot_trace(&self) -> bool {
        self.always_traces && self.bvh == BvhState::GivenUp
    }

    /// Puts the triangles that are there about another anchor. Hierarchies do not follow it.
    pub fn anchor_scene(&mut self, gpu: &Gpu, triangles: Triangles) -> Result<()> {
        if let (Some(placed), Some(there)) = (&triangles.0.placed, self.chunks.first_mut()) {
            let rows = there.placed_bvh.as_ref().and_then(|bvh| bvh.rows(placed, triangles.0.anchor));
            return rows.map_or(Ok(()), |rows| there.buffers.upload_texels(gpu, "instances", &rows));
        }
        let (clustered, all) = triangles;
        let mut each = self.chunks.iter_mut().zip(&clustered.chunks);
        each.try_for_each(|(there, chunk)| {
            place(gpu, &mut there.buffers, &chunk.with_vertices(all, clustered.anchor), clustered)
        })
    }

    /// Takes over the patches of pictures that a plan has made.
    pub fn take_pictures(&mut self, pictures: Option<&ScenePictures>) {
        self.pictures = pictures.cloned();
    }

    /// Rebuilds the hierarchy of shadow casters when the appearance is next uploaded.
    pub fn forget_shadow_casters(&mut self) {
        self.shadow_casters = None;
    }

    /// Refits the hierarchy of shadow casters to triangles that have moved.
    pub fn refit_shadow_casters(&mut self, scene: &Scene) {
        if let Some(shadow_casters) = &mut self.shadow_casters {
            shadow_casters.refit(scene);
        }
    }

    /// Whether the camera has the bounces that the tables on the device were made for. Rays of an atlas do not bounce.
    pub fn bounces_like(&self, camera: &Camera) -> bool {
        self.bounces == bounces(camera.optics.as_deref())
    }

    /// Uploads the tables of another camera with the same bounces, for a plan whose bands are as large.
    pub fn aim(&mut self, gpu: &Gpu, scene: &Scene, camera: &Camera, plan: &Plan) -> Result<()> {
        if let (Some(tables), Some(optics)) = (&mut self.bounce_tables, &camera.optics) {
            tables.aim(gpu, scene, camera, optics, plan, &self.bounces)?;
            self.facets = optics.facets().map_or(0, |f| f.triangles.len());
        }
        self.upload_bands(gpu, plan)?;
        // another camera may have more tiles
        self.allocate_lists(gpu, camera, plan)
    }

    /// Puts the tables of bands on the device; those of a lens that is there stay.
    fn upload_bands(&mut self, gpu: &Gpu, plan: &Plan) -> Result<()> {
        let lens_of = |band: &Band| band.turned.as_ref().map(|turned| turned.lens.clone());
        let (mut there, mut lenses) = (std::mem::take(&mut self.bands), std::mem::take(&mut self.lenses));
        there.resize_with(plan.bands.len(), Buffers::default);
        lenses.resize(plan.bands.len(), None);
        for ((band, buffers), lens) in plan.bands.iter().zip(&mut there).zip(&lenses) {
            let keeps_lens = matches!((lens, lens_of(band)), (Some(a), Some(b)) if Arc::ptr_eq(a, &b));
            if !keeps_lens {
                // buffers of another kind of rays may be there
                *buffers = Buffers::default();
            }
            upload_band(gpu, band, keeps_lens, buffers)?;
        }
        (self.bands, self.lenses) = (there, plan.bands.iter().map(lens_of).collect());
        self.needs_aim.store(true, Ordering::Relaxed);
        Ok(())
    }

    /// Lights, materials with their images, and normals; whether alpha masks are as before.
    pub fn upload_appearance(&mut self, gpu: &Gpu, store: &PageStore, scene: &Scene, plan: &Plan) -> Result<bool> {
        let pages = match plan.variant.appearance.textures.is_some() {
            true => store.place(gpu, &materials(scene), &mut self.shared)?,
            false => Pages::default(),
        };
        let bvh = match plan.variant.appearance.lights {
            LightsKind::Shadowed { .. } => Some(self.shadow_casters(scene, plan)?),
            _ => None,
        };
        let shadows = Shadows { kind: plan.variant.appearance.lights, bvh: bvh.as_ref() };
        let meshes = plan.variant.is_instanced().then(|| Arc::downgrade(scene.mesh.base()));
        let normals_of = match (&meshes, &self.meshes_with_normals) {
            (Some(meshes), Some(known)) if meshes.ptr_eq(known) => NormalsOf::Nothing,
            (Some(_), _) => NormalsOf::Meshes,
            (None, _) => NormalsOf::Scene,
        };
        self.pictures = match plan.variant.appearance.lights.has_pictures() {
            true => Some(ScenePictures::of(scene, self.pictures.as_ref())?),
            false => None,
        };
        let Appearance { mut shading, lights, materials, normals, style } =
            Appearance::new(scene, normals_of, plan.anchor, &pages, shadows, self.pictures.as_ref());
        shading.filter_width = plan.filter_width;
        self.shared.upload_uniform(gpu, "shading", &shading)?;
        if plan.variant.appearance.styled || plan.variant.extras.outlined {
            self.shared.upload_uniform(gpu, "style", &style)?;
        }
        self.shared.upload_texels(gpu, "lights", &lights)?;
        self.shared.upload_texels(gpu, "materials", &materials)?;
        if normals_of != NormalsOf::Nothing {
            self.shared.upload_texels(gpu, "normals", &normals)?;
        }
        self.meshes_with_normals = meshes;
        if let Some(volume) = scene.volume.as_ref().filter(|_| plan.variant.extras.volume.is_some()) {
            self.upload_volume(gpu, volume, scene, plan)?;
        }
        let masks = materials.iter().map(|m| {
            let blend = (m.is_blended == 1).then_some(m.opacity);
            (m.cutoff > 0.0 || blend.is_some()).then_some((m.texture, (m.cutoff, blend), m.page, m.origin))
        });
        let masks = (pages, masks.collect());
        let keeps_masks = self.alpha_masks.0.has_the_images_of(&masks.0) && self.alpha_masks.1 == masks.1;
        self.alpha_masks = masks;
        Ok(keeps_masks)
    }

    /// Where the volume lies and what it looks like, and how finely the rays of a plan are followed through it.
    pub fn upload_medium(&mut self, gpu: &Gpu, volume: &Volume, scene: &Scene, plan: &Plan) -> Result<()> {
        self.shared.upload_uniform(gpu, "medium", &medium(volume, scene, plan))
    }

    /// The volume, and the light at its nodes.
    fn upload_volume(&mut self, gpu: &Gpu, volume: &Volume, scene: &Scene, plan: &Plan) -> Result<()> {
        self.upload_medium(gpu, volume, scene, plan)?;
        let is_there = self.grid.as_ref().is_some_and(|grid| Arc::ptr_eq(grid, &volume.grid));
        if !is_there {
            self.shared.upload(gpu, "voxels", &voxels(volume, scene))?;
        }
        // light may be another one next time
        self.grid = (!volume.is_lit).then(|| volume.grid.clone());
        Ok(())
    }

    /// The hierarchy of shadow casters, built where there is none.
    fn shadow_casters(&mut self, scene: &Scene, plan: &Plan) -> Result<PackedBvh> {
        let scene = &*scene.of_casters();
        let count = scene.mesh.triangles.len() - self.facets;
        let packed = if plan.variant.is_timed() {
            PackedBvh::of_moving(scene, plan.anchor, count)?
        } else {
            let built = match self.shadow_casters.take() {
                Some(built) => built,
                None => Hierarchy::build(scene, plan.anchor, count)?,
            };
            self.shadow_casters.insert(built).packed(scene)
        };
        Ok(if plan.variant.is_masked() { packed.with_masks(&scene.mesh, count) } else { packed })
    }

    /// A start from the sizes of the image and of the largest chunk: most clusters meet a few nodes, most triangles a few tiles, of very many
    /// triangles one or none; plus up to 32 MiB in all, so that the first frames of all but very few scenes fit. A frame whose lists are too
    /// small is done again.
    fn first_guess(&self, camera: &Camera, plan: &Plan) -> Capacities {
        let largest = |of: fn(&ChunkOnDevice) -> u32| self.chunks.iter().map(of).max().map_or(0, u64::from);
        let (clusters, slots) = (largest(|chunk| chunk.clusters), largest(|chunk| chunk.slots));
        let pixels = u64::from(plan.rows_max()) * u64::from(camera.width);
        let proven = pixels * plan.variant.proven_a_pixel(camera.layers.len());
        let cells = plan.bands.iter().map(|b| b.tiles.cells.len()).max().unwrap_or(0) as u64;
        let nodes = plan.bands.iter().map(|b| b.nodes.nodes.len()).max().unwrap_or(0) as u64;
        let spare = |items: u64| items * cells.min(SPARE_CELLS) / SPARE_CELLS;
        // no list has an item twice
        let items = |things: u64, guess: u64| guess.min(things * nodes).max(ITEMS_MIN);
        Capacities {
            queue: items(clusters, 8 * clusters + spare(1 << 15)),
            work: items(clusters, 4 * clusters + spare(1 << 17)),
            tasks: items(slots, 16 * clusters + spare(1 << 18)),
            pairs: items(slots, (2 * slots).min(slots + slots / 8 + (1 << 20)) + 4 * cells + spare(1 << 20)),
            recheck_items: slots / 16 + pixels / 64 + proven + (1 << 14),
            edges: pixels / 8 + 1024,
        }
    }

    /// A start for the rounds of raster: busy tiles of large chunks have more pairs than one round takes. A round that finds no busy tile
    /// takes far less time than a frame that is done again. Samples of edges are found in one round.
    fn first_rounds(&self, plan: &Plan) -> u32 {
        let largest = self.chunks.iter().map(|chunk| chunk.slots).max().unwrap_or(0);
        let is_large = largest >= LARGE_CHUNK && !plan.variant.samples_edges();
        if is_large { LARGE_CHUNK_ROUNDS * largest.div_ceil(LARGE_CHUNK) } else { 1 }
    }

    /// The buffers that kernels write, at the present capacities, and the parameters that name these.
    fn allocate_lists(&mut self, gpu: &Gpu, camera: &Camera, plan: &Plan) -> Result<()> {
        let most = gpu.binding_limit() / ITEM_BYTES;
        let c = &mut self.capacities;
        [&mut c.queue, &mut c.work, &mut c.tasks, &mut c.pairs, &mut c.recheck_items]
            .into_iter()
            .for_each(|items| *items = (*items).min(most));
        // all pixels of a band fit: see its plan
        c.edges = c.edges.min(u64::from(plan.rows_max()) * u64::from(plan.width));
        let (capacities, raster_rounds) = (self.capacities, self.raster_rounds);
        let sizes = Sizes { plan, capacities, raster_rounds, samples_by_tile: self.samples_by_tile(plan) };
        for BufferSpec { name, bytes, usage } in table() {
            if let Some(bytes) = bytes(&sizes) {
                self.shared.fit(gpu, name, bytes, usage)?;
            }
        }
        self.write_params(gpu, camera, plan)
    }

    /// Edges are found tile by tile: raster takes all pairs of a tile at once, and the lists fit their bindings.
    pub fn samples_by_tile(&self, plan: &Plan) -> bool {
        self.raster_rounds == 1 && plan.variant.samples_by_tile() && self.capacities.pairs <= self.pairs_by_tile
    }

    pub fn write_params(&mut self, gpu: &Gpu, camera: &Camera, plan: &Plan) -> Result<()> {
        self.params.clear();
        self.bounced_params.clear();
        for band in &plan.bands {
            for chunk in &self.chunks {
                for batch in 0..self.batches {
                    let ids = Span { first: chunk.id_first, count: chunk.id_count };
                    let (first, count) = self.batch(chunk, batch);
                    let clusters = Span { first, count };
                    let uniform = |params: Params| {
                        let mut buffers = Buffers::default();
                        buffers.upload_uniform(gpu, "params", &params)?;
                        Ok(buffers)
                    };
                    let budget = self.raster_budget(plan, band, chunk);
                    let surface_rows = chunk.surface_rows;
                    let own = params(camera, plan, band, ids, clusters, self.capacities, budget);
                    let own = Params { surface_rows, ..own };
                    self.params.push(uniform(own)?);
                    if self.bounce_tables.is_some() {
                        self.bounced_params.push(uniform(after_bounce(own))?);
                    }
                }
            }
        }
        Ok(())
    }

    /// What raster may still cost in a band before trace takes over: what tracing costs, and building the hierarchy where there is none.
    fn raster_budget(&self, plan: &Plan, band: &Band, chunk: &ChunkOnDevice) -> f32 {
        let build = match self.bvh {
            BvhState::GivenUp => return f32::MAX,
            BvhState::Preferred => return 0.0,
            BvhState::Built => 0,
            BvhState::None => self.costs.triangle * u64::from(chunk.slots),
        };
        (self.costs.trace(plan, band) + build).saturating_sub(self.costs.stages) as f32
    }

    /// First cluster and count of one batch.
    fn batch(&self, chunk: &ChunkOnDevice, batch: u32) -> (u32, u32) {
        let at = |k: u32| (chunk.clusters as u64 * k as u64 / self.batches as u64) as u32;
        (at(batch), at(batch + 1) - at(batch))
    }

    /// Every batch of every chunk over band `band`, in a bounce by its number.
    pub fn jobs(&self, band: usize, bounce: usize) -> impl Iterator<Item = Job<'_>> {
        (0..).map_while(move |k| self.job(band, bounce, k))
    }

    /// The k-th of them.
    pub fn job(&self, band: usize, bounce: usize, k: usize) -> Option<Job<'_>> {
        let all = if self.bounces[bounce].count == 0 { &self.params } else { &self.bounced_params };
        let chunk = self.chunks.get(k / self.batches as usize)?;
        let index = band * self.chunks.len() * self.batches as usize + k;
        let clusters = self.batch(chunk, k as u32 % self.batches).1;
        Some(Job { index: bounce * self.params.len() + index, chunk, params: &all[index], clusters })
    }

    pub fn job_count(&self) -> usize {
        self.params.len() * self.bounces.len()
    }

    /// Where kernels find the buffers of a job over a band, for a bounce by its number.
    pub fn scopes<'a>(&'a self, job: &Job<'a>, band: usize, bounce: usize) -> Vec<&'a Buffers> {
        let own = self
            .bounce_tables
            .iter()
            .flat_map(|t| [vec![t.uniforms(bounce)], t.scopes(self.bounces[bounce].count, band)].concat());
        [job.params].into_iter().chain(own).chain([&job.chunk.buffers, &self.bands[band], &self.shared]).collect()
    }

    /// Grows what overflowed, by the counters: larger lists, or more batches where a list is as large as a binding.
    pub fn grow(&mut self, gpu: &Gpu, camera: &Camera, plan: &Plan, need: Capacities) -> Result<()> {
        let most = gpu.binding_limit() / ITEM_BYTES;
        if need.queue.max(need.work).max(need.tasks).max(need.pairs).max(need.recheck_items) > most {
            let largest = self.chunks.iter().map(|c| c.clusters).max().unwrap_or(0);
            if self.batches >= largest {
                let Capacities { queue, work, tasks, pairs, recheck_items, .. } = need;
                let needed = format!(
                    "cull {queue}, split {work}, bin {tasks}, raster {pairs}, recheck {recheck_items} items needed"
                );
                let lists = format!("{needed}, {most} fit a binding");
                return Err(Error::work(format!("lists between the stages overflow: {lists}; make the image smaller")));
            }
            self.batches = (self.batches * 2).min(largest);
        }
        // a quarter more than was counted: what an overflowing list dropped could not be counted further on
        let grown = |have: u64, need: u64| if need > have { need + need / 4 } else { have };
        let c = &mut self.capacities;
        *c = Capacities {
            queue: grown(c.queue, need.queue),
            work: grown(c.work, need.work),
            tasks: grown(c.tasks, need.tasks),
            pairs: grown(c.pairs, need.pairs),
            recheck_items: grown(c.recheck_items, need.recheck_items),
            edges: grown(c.edges, need.edges),
        };
        self.allocate_lists(gpu, camera, plan)
    }

    pub fn bytes(&self) -> u64 {
        let chunks: u64 = self.chunks.iter().map(|c| c.buffers.bytes()).sum();
        let params = self.params.iter().chain(&self.bounced_params);
        let rest: u64 = self.bands.iter().chain(params).chain([&self.shared]).map(Buffers::bytes).sum();
        chunks + rest + self.bounce_tables.as_ref().map_or(0, BounceTables::bytes)
    }
}

/// Cells from which on an image has all of the spare items in its lists; fewer have a part in proportion: 256 x 256 pixels.
const SPARE_CELLS: u64 = 1024;

/// Items of the shortest list.
const ITEMS_MIN: u64 = 64;

/// Triangles of a large chunk, and the rounds of raster over its busy tiles that the first frame has for each so many triangles. A fisheye
/// image of 800 x 600 pixels over a terrain took three or four rounds in chunks of 1.4 million triangles, and one in a chunk of a million.
const LARGE_CHUNK: u32 = 1 << 20;
const LARGE_CHUNK_ROUNDS: u32 = 2;

/// The hierarchies that trace follows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BvhState {
    /// They hold nothing.
    None,
    /// They are there.
    Built,
    /// And frames are traced from their start.
    Preferred,
    /// They are too deep, or paths take too many steps in them: raster does it all.
    GivenUp,
}
