//! One kernel at a time: the bytes of a twin's input on the device, outputs poisoned before, words read back.

// every test binary uses a part of it
#![allow(dead_code)]

use super::common::cameras::{self, MeshShape};
use super::common::rng::Rng;
use super::common::{self, ALL_T, FORWARD};
use super::common::{layered, needs};
use anamorph::internals::camera::kinds::glc::Glc;
use anamorph::internals::camera::spec::CameraKind;
use anamorph::internals::camera::{Camera, Rays, TILE};
use anamorph::internals::engine::Capacities;
use anamorph::internals::engine::clusters::{cluster, mapped_surfaces};
use anamorph::internals::engine::plan::Wanted;
use anamorph::internals::engine::plan::slabs;
use anamorph::internals::engine::plan::slabs::Slabs;
use anamorph::internals::engine::stage::{Pixels, Stages};
use anamorph::internals::geometry::generate::{icosphere, plane, teapot};
use anamorph::internals::geometry::mesh::{Material, Mesh};
use anamorph::internals::gpu::Gpu;
use anamorph::internals::gpu::buffers::{Buffers, wait};
use anamorph::internals::gpu::device::AdapterFeatures;
use anamorph::internals::gpu::kernels::{OpticsKind, OpticsModel, RayModel, SurfaceKind, Textures, TilePath, Variant};
use anamorph::internals::gpu::layout::{COUNTERS, Params};
use anamorph::internals::gpu::readback::{read_words, readback};
use anamorph::internals::image::frame::Channel;
use anamorph::internals::scene::Scene;
use anamorph::internals::scene::light::Light;
use anamorph_lab::twin::{KernelInputs, LARGE, Real, Tables};
use glam::{DMat2, DVec2, DVec3};

/// What every word that a kernel does not own must still hold.
pub const POISON: u32 = 0xdead_beef;
/// Poisoned items behind the end of every list.
pub const SPARE: usize = 64;

/// A scene, a camera, and the sizes by which its tables are split.
pub struct Case {
    pub name: String,
    pub scene: Scene,
    pub camera: Camera,
    /// Bytes a binding of the bands' tables and of the chunks' holds.
    pub band_limit: u64,
    pub chunk_limit: u64,
}

/// No table of these tests is that large.
const WHOLE: u64 = 1 << 27;

impl Case {
    pub fn new(name: &str, mesh: Mesh, camera: Camera) -> Case {
        let scene = common::scene(mesh);
        Case { name: name.into(), scene, camera, band_limit: WHOLE, chunk_limit: WHOLE }
    }

    /// For all channels, so that bands are split alike in every test.
    pub fn tables(&self) -> Tables {
        let wanted = Wanted::of(Channel::ALL.to_vec());
        let has = AdapterFeatures { f64: true, atomics64: true, ..Default::default() };
        let tables = Tables::new(&self.scene, &self.camera, &wanted, has, self.band_limit);
        let mesh = &self.scene.with_optics(&self.camera).mesh;
        let clustered = cluster(&**mesh, tables.plan.anchor, SurfaceKind::Plain, self.chunk_limit);
        tables.with_clusters(clustered, mesh)
    }

    /// The same with texture coordinates.
    pub fn mapped_tables(&self) -> Tables {
        let mut tables = self.tables();
        tables.plan.variant.appearance.textures = Some(Textures::default());
        let mesh = &*self.scene.mesh;
        let clustered = cluster(mesh, tables.plan.anchor, SurfaceKind::Mapped, self.chunk_limit);
        tables.with_clusters(clustered, mesh)
    }

    /// Every band under every chunk, its lists as large as `capacities`.
    pub fn inputs<'a>(&self, tables: &'a Tables, capacities: Capacities) -> Vec<KernelInputs<'a>> {
        let chunks = tables.clustered.chunks.len();
        let jobs = (0..tables.plan.bands.len()).flat_map(|b| (0..chunks).map(move |c| (b, c)));
        jobs.map(|(band, chunk)| tables.input(&self.camera, band, chunk, capacities)).collect()
    }

    /// The same, band by band.
    pub fn bands<'a>(&self, tables: &'a Tables) -> Vec<Vec<KernelInputs<'a>>> {
        self.inputs(tables, LARGE).chunks(tables.clustered.chunks.len()).map(<[KernelInputs]>::to_vec).collect()
    }

    pub fn variant(&self, real: Real, atomics64: bool) -> Variant {
        let slabbed = Slabs::of(&self.camera).count() > 1;
        let optics = self.camera.optics.as_deref();
        let optics = optics.map(|optics| OpticsModel { kind: OpticsKind::of(optics), bounced: false });
        Variant::plain(real == Real::F64, atomics64).with(|v| {
            v.rays = RayModel { kind: slabs::kind(&self.camera), slabbed, optics };
            v.extras.counting = true;
            v.appearance.normals = !self.scene.mesh.normals.is_empty();
        })
    }
}

/// The mesh moved and scaled into the ball of radius 1 about the origin.
pub fn fitted(mut mesh: Mesh) -> Mesh {
    let (lo, hi) =
        mesh.positions.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |b, p| (b.0.min(*p), b.1.max(*p)));
    let (centre, scale) = ((lo + hi) / 2.0, 2.0 / (hi - lo).length());
    mesh.positions.iter_mut().for_each(|p| *p = scale * (*p - centre));
    mesh
}

fn scaled(mut mesh: Mesh, by: f64) -> Mesh {
    mesh.positions.iter_mut().for_each(|p| *p *= by);
    mesh
}

/// The first `count` triangles a second time, the other way round: wherever these are nearest, two ts are equal.
fn with_twins(mut mesh: Mesh, count: usize) -> Mesh {
    mesh.triangles.extend_from_within(..count);
    mesh.material_of.extend_from_within(..count);
    mesh.triangles.iter_mut().rev().take(count).for_each(|t| t.swap(0, 2));
    mesh
}

/// A slab of triangles whose every vertex lies on the ray of a pixel, each `step` pixels, up to rounding.
pub fn slab_on_rays(camera: &Camera, step: u32) -> Mesh {
    let (columns, rows) = ((camera.width - 1) / step, (camera.height - 1) / step);
    let mut rng = Rng(31);
    let mut positions = Vec::new();
    for (i, j) in (0..=rows).flat_map(|j| (0..=columns).map(move |i| (i, j))) {
        let ray = camera.ray(i * step, j * step).expect("a camera whose every pixel has a ray");
        positions.push(ray.origin + (0.5 + 0.05 * rng.signed()) * ray.direction);
    }
    let mut triangles = Vec::new();
    for (i, j) in (0..rows).flat_map(|j| (0..columns).map(move |i| (i, j))) {
        let k = j * (columns + 1) + i;
        let below = k + columns + 1;
        triangles.extend([[k, k + 1, below], [k + 1, below + 1, below]]);
    }
    common::mesh(positions, triangles)
}

/// Every third triangle shows one face only.
pub fn part_one_sided(mut mesh: Mesh) -> Mesh {
    mesh.materials.push(Material { two_sided: false, diffuse: [0.9, 0.5, 0.2], ..Material::default() });
    let one_sided = mesh.materials.len() as u32 - 1;
    mesh.material_of.iter_mut().step_by(3).for_each(|m| *m = one_sided);
    mesh
}

/// A ball over a floor of two large triangles.
fn ball_on_floor() -> Mesh {
    let mut mesh = icosphere(2);
    mesh.normals.clear();
    mesh.corner_normals.clear();
    let floor = plane(6.0, 1);
    let first = mesh.positions.len() as u32;
    mesh.positions.extend(floor.positions.iter().map(|p| *p - DVec3::Y));
    mesh.triangles.extend(floor.triangles.iter().map(|t| t.map(|k| k + first)));
    mesh.material_of.extend([0, 0]);
    mesh
}

/// Scenes and cameras that between them take every path of the kernels.
pub fn cases() -> Vec<Case> {
    let soup = |seed: u64, count: usize, size: f64| common::soup(&mut Rng(seed), count, size);
    let glc = |class: &str| {
        let mut all = cameras::glc_of_each_class().into_iter();
        all.find(|c| c.0 == class).map(|c| c.1).expect("a class of that name")
    };
    let mut list: Vec<Case> = cameras::glc_of_each_class()
        .into_iter()
        .enumerate()
        .map(|(k, (name, kind))| {
            let camera = common::camera(kind, (72, 56), FORWARD);
            Case::new(name, part_one_sided(soup(k as u64, 150, 0.4)), camera)
        })
        .collect();
    let shapes = [
        ("pieces", MeshShape::default()),
        ("weighted pieces", MeshShape { weights: true, ..Default::default() }),
        ("discontinuous unit pieces", MeshShape { normalize: true, weights: true, discontinuous: true }),
    ];
    for (name, shape) in shapes {
        let camera = common::camera(cameras::mesh_camera(5, 4, 3, shape), (100, 90), FORWARD);
        list.push(Case::new(name, part_one_sided(icosphere(2)), camera));
    }
    let plain = MeshShape::default();
    let weighted = MeshShape { weights: true, ..plain };
    let chain = layered::chain(3, 3, (4, 3), plain, (100, 90));
    list.push(Case::new("chain", part_one_sided(icosphere(2)), chain));
    let chain = layered::chain(4, 2, (2, 2), weighted, (61, 83));
    list.push(Case::new("weighted chain", part_one_sided(soup(23, 200, 0.5)), chain));
    let chain = layered::chain(5, 16, (1, 1), plain, (40, 33));
    list.push(Case::new("chain of 16", with_twins(part_one_sided(soup(24, 120, 0.7)), 60), chain));
    for (degree, bend) in [(1, 0.0), (2, 0.5), (3, 0.3), (3, 2.5)] {
        let name = format!("curves of degree {degree}, bent by {bend}");
        let camera = layered::wavy(degree, bend, degree == 2, (84, 61));
        list.push(Case::new(&name, part_one_sided(soup(30 + degree as u64, 150, 0.5)), camera));
    }
    let mixed = layered::straight_then_curved((70, 50));
    list.push(Case::new("straight, then curved", part_one_sided(icosphere(2)), mixed));
    list.push(Case::new("ray field", part_one_sided(icosphere(2)), cameras::raymap(90, 70, FORWARD)));
    list.push(Case::new("ray field, both ways", soup(21, 120, 0.5), cameras::raymap(50, 41, [-1.0, 0.6])));
    let inside = |range| common::camera(glc("bilinear"), (64, 48), range);
    list.push(Case::new("both ways", with_twins(part_one_sided(soup(22, 120, 0.6)), 60), inside(ALL_T)));
    // pixel centres k / 32 - 63 / 64 and vertices in the same places: every product is exact, edges are met exactly
    let straight = cameras::two_plane(DMat2::from_diagonal(DVec2::splat(2.0)), DMat2::from_diagonal(DVec2::splat(2.0)));
    let straight = common::camera(CameraKind::new("glc", Glc { near: straight.0, far: straight.1 }), (64, 64), FORWARD);
    let upright = |p: DVec3| DVec3::new(p.x + 1.0 / 64.0, p.z + 1.0 / 64.0, 0.25 * p.x);
    let mut slab = plane(2.0, 16);
    slab.normals.clear();
    slab.corner_normals.clear();
    slab.positions.iter_mut().for_each(|p| *p = upright(*p));
    list.push(Case::new("edges on pixel centres", slab, straight));
    for class in ["bilinear", "pinhole", "cglc"] {
        let camera = common::camera(glc(class), (61, 47), FORWARD);
        list.push(Case::new(&format!("vertices on rays, {class}"), slab_on_rays(&camera, 3), camera));
    }
    list.push(Case::new("a slice", part_one_sided(icosphere(2)), inside([-0.3, 0.45])));
    let mut case = Case::new(
        "bands and chunks",
        part_one_sided(scaled(fitted(teapot(3)), 2.6)),
        common::camera(glc("cross-slit"), (160, 120), FORWARD),
    );
    // some 40 rows of ten channels a band, some 250 triangles a chunk
    (case.band_limit, case.chunk_limit) = (161 * 40 * 50, 96 * 250);
    case.scene.lights = [DVec3::new(-1.0, -2.0, -1.0), DVec3::new(1.0, 0.0, -1.0)].map(Light::distant).to_vec();
    list.push(case);
    let size = (600, 450);
    list.push(Case::new("large", ball_on_floor(), common::camera(glc("cross-slit"), size, FORWARD)));
    let from = DVec3::new(2.0, 1.0, 2.5);
    let pinhole = cameras::pinhole(from, DVec3::ZERO, 60.0);
    list.push(Case::new("large pinhole", ball_on_floor(), common::camera(pinhole, (520, 270), FORWARD)));
    list
}

/// How many random cases each test tries; more by the environment's `SEEDS`.
pub fn seeds() -> std::ops::Range<u64> {
    0..std::env::var("SEEDS").ok().and_then(|n| n.parse().ok()).unwrap_or(12)
}

/// Any camera, any size, any range of t, triangles from specks to walls, anywhere.
pub fn random_case(seed: u64) -> Case {
    let mut rng = Rng(1000 + seed);
    let size = (1 + rng.below(150) as u32, 1 + rng.below(150) as u32);
    let (a, b) = (2.0 * rng.signed(), 2.0 * rng.signed());
    let range = [FORWARD, ALL_T, [a.min(b), a.max(b)], [a, f64::INFINITY]][rng.below(4)];
    let offset = [0.0, 0.0, 30.0, 1e4][rng.below(4)] * rng.vector();
    let mut triple = |centre: DVec3| [0, 1, 2].map(|_| centre + 2.0 * rng.vector() + offset);
    let any_glc = CameraKind::new("glc", Glc { near: triple(2.0 * DVec3::Z), far: triple(-2.0 * DVec3::Z) });
    let shape =
        MeshShape { normalize: rng.below(2) == 0, weights: rng.below(2) == 0, discontinuous: rng.below(2) == 0 };
    let mut pieces = cameras::mesh_spec(seed, 1 + rng.below(6) as u32, 1 + rng.below(6) as u32, shape);
    pieces.vertices.iter_mut().for_each(|v| (v.near, v.far) = (v.near + offset, v.far + offset));
    let eye = offset + 2.0 * rng.vector();
    let camera = match rng.below(5) {
        0 => common::camera(any_glc, size, range),
        1 | 2 => common::camera(CameraKind::new("mesh", pieces), size, range),
        3 => common::camera(cameras::pinhole(eye, offset, 20.0 + 120.0 * rng.unit()), size, range),
        _ => cameras::raymap(size.0, size.1, range),
    };
    let centre = if matches!(camera.layers[0], Rays::Field(_)) { DVec3::ZERO } else { offset };
    let (count, largest) = (1 + rng.below(300), (-6.0 * rng.unit()).exp2() * 4.0);
    let mesh = common::moved(common::soup(&mut rng, count, largest), centre);
    Case::new(
        &format!("seed {seed}, {} of {}x{}, t {range:?}", camera.kind, size.0, size.1),
        part_one_sided(mesh),
        camera,
    )
}

/// More clusters than the other cases have together, over a large image.
pub fn many_clusters() -> Case {
    let from = DVec3::new(0.3, 0.4, 1.4);
    let camera = common::camera(cameras::pinhole(from, DVec3::ZERO, 70.0), (610, 330), FORWARD);
    Case::new("many clusters", fitted(icosphere(5)), camera)
}

/// The adapter, and kernels compiled once for each variant and set of planes.
pub struct Bench {
    pub gpu: Gpu,
    stages: Vec<Stages>,
}

impl Bench {
    /// `None`, as [`needs::no_adapter`] says, on a machine without an adapter.
    pub fn open() -> Option<Bench> {
        needs::adapter().map(|gpu| Bench { gpu, stages: Vec::new() })
    }

    /// The arithmetics and atomics that the adapter can run.
    pub fn variants(&self) -> Vec<(Real, bool)> {
        let reals = [Real::F64, Real::F32].into_iter().filter(|r| self.gpu.has.f64 || *r == Real::F32);
        let atomics = [true, false].into_iter().filter(|a| self.gpu.has.atomics64 || !a);
        reals.flat_map(|r| atomics.clone().map(move |a| (r, a))).collect()
    }

    /// The kernels of a variant, for subgroups as wide as the adapter's.
    pub fn stages(&mut self, variant: Variant, planes: &[Channel]) -> (&Gpu, &Stages) {
        let tiles = variant.tiles().map(|tiles| TilePath { wide: self.gpu.has.wide, ..tiles });
        let variant = tiles.map_or(variant, |tiles| variant.with_tiles(tiles));
        let found = self.stages.iter().position(|s| s.variant == variant && s.planes == planes);
        let at = found.unwrap_or_else(|| {
            self.stages.push(Stages::new(&self.gpu, variant, planes).unwrap());
            self.stages.len() - 1
        });
        (&self.gpu, &self.stages[at])
    }

    /// Runs a source's `probe` in groups of 64, that reads the inputs as binding 0 and writes `words` for each of them to binding 1.
    pub fn probe<T: bytemuck::NoUninit>(&self, source: &str, inputs: &[T], words: usize) -> Vec<u32> {
        let gpu = &self.gpu;
        // the source is whole: its files' imports are in it
        let source: String = source.lines().filter(|l| !l.starts_with('#')).map(|l| format!("{l}\n")).collect();
        let module = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("probe"),
            source: wgpu::ShaderSource::Wgsl(source.as_str().into()),
        });
        let pipeline = gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some("probe"),
            layout: None,
            module: &module,
            entry_point: Some("probe"),
            compilation_options: Default::default(),
            cache: None,
        });
        let mut buffers = Buffers::default();
        buffers.upload(gpu, "inputs", inputs).unwrap();
        buffers.upload(gpu, "found", &vec![POISON; inputs.len() * words]).unwrap();
        let entry = |binding, name| wgpu::BindGroupEntry {
            binding,
            resource: buffers.get(name).expect("a buffer of that name").as_entire_binding(),
        };
        let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("probe"),
            layout: &pipeline.get_bind_group_layout(0),
            entries: &[entry(0, "inputs"), entry(1, "found")],
        });
        run(gpu, |pass| {
            pass.set_pipeline(&pipeline);
            pass.set_bind_group(0, &group, &[]);
            pass.dispatch_workgroups(inputs.len().div_ceil(64) as u32, 1, 1);
            Ok(())
        });
        read(gpu, &buffers, "found")
    }
}

/// Uploads the input's structs to buffers with the kernels' names.
pub fn upload(gpu: &Gpu, input: &KernelInputs) -> Buffers {
    let mut b = Buffers::default();
    b.upload_uniform(gpu, "params", &input.params).unwrap();
    b.upload_uniform(gpu, "shading", &input.appearance.shading).unwrap();
    b.upload_texels(gpu, "clusters", input.clusters).unwrap();
    b.upload(gpu, "triangle_groups", input.triangle_groups).unwrap();
    b.upload(gpu, "nodes", input.nodes).unwrap();
    b.upload(gpu, "tile_start", input.tile_start).unwrap();
    b.upload(gpu, "cells", input.cells).unwrap();
    b.upload_texels(gpu, "pieces", input.pieces).unwrap();
    if let Some(rays) = input.rays {
        b.upload(gpu, "rays_hi", &rays.hi).unwrap();
        b.upload(gpu, "rays_lo", &rays.lo).unwrap();
    }
    b.upload_texels(gpu, "triangles", input.triangles).unwrap();
    b.upload_texels(gpu, "vertices", input.vertices).unwrap();
    b.upload(gpu, "slot_of_id", input.slot_of_id).unwrap();
    if input.uvs.is_empty() {
        b.upload_texels(gpu, "surfaces", input.surfaces).unwrap();
    } else {
        b.upload_texels(gpu, "surfaces", &mapped_surfaces(input.surfaces, input.uvs)).unwrap();
    }
    b.upload_texels(gpu, "normals", &input.appearance.normals).unwrap();
    b.upload_texels(gpu, "materials", &input.appearance.materials).unwrap();
    b.upload_texels(gpu, "lights", &input.appearance.lights).unwrap();
    b.create(gpu, "indirect", 12, wgpu::BufferUsages::INDIRECT).unwrap();
    if let Some(optics) = &input.optics {
        b.upload_uniform(gpu, "optic", &optics.optic).unwrap();
        b.upload(gpu, "paths", optics.paths).unwrap();
        b.upload(gpu, "live", &every_tile(&input.params)).unwrap();
        optics.surface.upload(gpu, &mut b).unwrap();
    }
    b
}

/// The list of tiles with a ray, all of the band's.
fn every_tile(params: &Params) -> Vec<u32> {
    let tiles = params.width.div_ceil(TILE) * params.height.div_ceil(TILE);
    [tiles].into_iter().chain((0..tiles).flat_map(|tile| [tile, 1])).collect()
}

/// The pixels that a stage takes for the rays of an input.
pub fn pixels(input: &KernelInputs) -> Pixels {
    match input.optics.as_ref().map_or(0, |optics| optics.optic.bounces) {
        0 => Pixels::Every(input.params.width * input.params.height),
        _ => Pixels::Live,
    }
}

/// A list of two-word items, capacity for `capacity` items in all and poison behind; the rest is poisoned too.
pub fn list(gpu: &Gpu, buffers: &mut Buffers, name: &'static str, items: &[[u32; 2]], capacity: usize) {
    let mut words = items.to_vec();
    words.resize(capacity.max(items.len()) + SPARE, [POISON; 2]);
    buffers.upload(gpu, name, &words).unwrap();
}

/// Counters with these values; those that are not named are poisoned.
pub fn counters(gpu: &Gpu, buffers: &mut Buffers, values: &[(u32, u32)]) {
    let mut words = [POISON; COUNTERS as usize];
    values.iter().for_each(|&(k, value)| words[k as usize] = value);
    buffers.upload(gpu, "counters", &words).unwrap();
}

/// Runs what `encode` puts into one pass, to its end.
pub fn run(gpu: &Gpu, encode: impl FnOnce(&mut wgpu::ComputePass) -> anamorph::internals::input::Result<()>) {
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    let mut pass = encoder.begin_compute_pass(&Default::default());
    encode(&mut pass).unwrap();
    drop(pass);
    gpu.queue.submit([encoder.finish()]);
    wait(gpu).unwrap();
}

/// All words of a buffer.
pub fn read(gpu: &Gpu, buffers: &Buffers, name: &str) -> Vec<u32> {
    let from = buffers.get(name).expect("a buffer of that name");
    let to = readback(gpu, from.size());
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    encoder.copy_buffer_to_buffer(from, 0, &to, 0, from.size());
    gpu.queue.submit([encoder.finish()]);
    read_words(gpu, &to).unwrap()
}

/// The two-word items of a list, poison and all.
pub fn read_list(gpu: &Gpu, buffers: &Buffers, name: &str) -> Vec<[u32; 2]> {
    read(gpu, buffers, name).chunks_exact(2).map(|w| [w[0], w[1]]).collect()
}

/// Fails where a word from `from` on is not poison any more.
pub fn assert_poisoned(words: &[u32], from: usize, what: &str) {
    if let Some(k) = words.iter().skip(from).position(|w| *w != POISON) {
        panic!("{what}: word {} is not its kernel's and was written", from + k);
    }
}
