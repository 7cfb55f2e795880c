//! aim: the rays of a lens must become those of the camera at its pose, and the bounds on them must hold these rays and be little wider than
//! those that the host finds for the pose.

use crate::common::file::camera_of;
use crate::stages::{Bench, POISON, SPARE, assert_poisoned, read, run};
use anamorph::internals::camera::perturb::PERTURB;
use anamorph::internals::camera::{Camera, TILE};
use anamorph::internals::engine::RunOptions;
use anamorph::internals::engine::plan::nodes::Level;
use anamorph::internals::engine::plan::turned::Turned;
use anamorph::internals::engine::plan::variant::variant;
use anamorph::internals::engine::plan::{Band, Plan, PlanTarget, SceneContents, SceneExtent, Wanted};
use anamorph::internals::engine::stage::aim::aim;
use anamorph::internals::gpu::buffers::Buffers;
use anamorph::internals::gpu::device::AdapterFeatures;
use anamorph::internals::gpu::layout::{BRANCH, Cell, Node, RAYS_NONE};
use anamorph::internals::image::frame::Channel;
use anamorph_lab::twin::cull::Address;
use anamorph_lab::twin::fit::{PixelRay, reach};
use glam::DVec3;

const SIZE: (u32, u32) = (90, 46);

/// Central lenses and others, one without a ray in the corners, one whose rays jump within tiles, and pieces.
const LENSES: [&str; 6] = [
    "kind = \"pinhole\"\nvfov = 60",
    "kind = \"fisheye\"\nfov = 150\npieces = 60",
    "kind = \"fisheye\"\nfov = 200",
    "kind = \"ods\"\nipd = 0.3",
    "kind = \"cylinder\"\nfov = 250",
    "kind = \"lidar\"\nbeams = [30, 20, 12, 11, 4, -4, -12, -20]\ncolumns = 90\nvelocity = [0.2, 0.1, 0]\nperiod = 0.5",
];

/// A pose's keys, and what positions are relative to: in the eye, or so far away that its distance is what rounds most.
const POSES: [(&str, DVec3); 3] = [
    ("eye = [0, 0.2, 2.5]\ntarget = [0, 0, 0]", DVec3::new(0.0, 0.2, 2.5)),
    ("eye = [-3, 1, 0]\ntarget = [0.1, 0, 0.3]\nup = [1, 0.1, 0]", DVec3::ZERO),
    ("eye = [-3e5, 1, 2e5]\ntarget = [0.1, 0, 0.3]", DVec3::new(-3e5, 4e4, 0.0)),
];

/// The kernel adds 2^-20 of its sums of sizes to radii. A size there is a sum of components, up to the root of 3 times a length.
const LOOSER_MAX: f64 = 1.0 / (1u64 << 20) as f64;

/// A stored ray: pairs of f32 hold 2^-48 of each number, and rotations in f64 round by a few 2^-53.
const RAY_ROUNDING: f64 = 1.0 / (1u64 << 46) as f64;

fn plan(camera: &Camera, anchor: DVec3, aims: bool) -> Plan {
    let wanted = Wanted::of(vec![Channel::T]);
    let has = AdapterFeatures { f64: true, atomics64: true, ..Default::default() };
    let variant = variant(camera, SceneContents::default(), &wanted, has, &RunOptions::default());
    let target = PlanTarget { has, binding_limit: 1 << 27, aims, last: None };
    let extent = SceneExtent { scene_size: 16.0, ..SceneExtent::point(anchor) };
    Plan::on(target, variant, camera, SceneContents::default(), extent, &wanted)
}

/// The words that the kernels leave in `rays_hi`, `rays_lo` and `nodes`.
fn run_kernels(bench: &mut Bench, plan: &Plan, turned: &Turned) -> [Vec<u32>; 3] {
    let (gpu, stages) = bench.stages(plan.variant, &[]);
    let mut buffers = Buffers::default();
    if turned.ray_count() > 0 {
        buffers.upload(gpu, "lens_hi", &turned.lens.table.hi).unwrap();
        buffers.upload(gpu, "lens_lo", &turned.lens.table.lo).unwrap();
    }
    buffers.upload(gpu, "lens_nodes", &turned.lens.nodes.nodes).unwrap();
    buffers.upload_uniform(gpu, "viewer", &turned.pose()).unwrap();
    let words = [
        ("rays_hi", 6 * turned.ray_count() as usize),
        ("rays_lo", 6 * turned.ray_count() as usize),
        ("nodes", size_of_val(&turned.lens.nodes.nodes[..]) / 4),
    ];
    for (name, count) in words {
        buffers.upload(gpu, name, &vec![POISON; count + SPARE]).unwrap();
    }
    run(gpu, |pass| stages.encode(gpu, pass, &[&buffers], &aim(turned, plan.variant), &mut Default::default()));
    words.map(|(name, count)| {
        let mut left = read(gpu, &buffers, name);
        assert_poisoned(&left, count, name);
        left.truncate(count);
        left
    })
}

fn ray_of(camera: &Camera, anchor: DVec3, pixel: (u32, u32)) -> Option<PixelRay> {
    let ray = camera.ray(pixel.0, pixel.1)?;
    Some(PixelRay { pixel, p: ray.origin - anchor, d: ray.direction })
}

/// The rays of the pixels below a node.
fn rays_below(camera: &Camera, anchor: DVec3, at: Address) -> Vec<PixelRay> {
    let side = TILE * BRANCH.pow(at.level);
    let columns = at.x * side..((at.x + 1) * side).min(camera.width);
    let rows = at.y * side..((at.y + 1) * side).min(camera.height);
    rows.flat_map(|j| columns.clone().map(move |i| (i, j))).filter_map(|pixel| ray_of(camera, anchor, pixel)).collect()
}

fn length(v: [f32; 3]) -> f64 {
    DVec3::from(v.map(f64::from)).length()
}

/// Sizes of the node's origins and directions.
fn sizes(node: &Node) -> [f64; 2] {
    let size = |c: [[f32; 3]; 3]| c.iter().map(|v| length(*v)).sum::<f64>();
    [size([node.p, node.px, node.py]), size([node.d, node.dx, node.dy])]
}

/// Each node holds the rays below it, perturbed or not, and is little wider than the host's. Returns how many cells have a node of their own.
fn assert_bounded(name: &str, camera: &Camera, plan: &Plan, eye: DVec3, nodes: &[Node], host: &Band) -> usize {
    for (level, Level { start, width, height }) in (0..).zip(&host.nodes.levels) {
        for k in 0..width * height {
            let at = Address { level, x: k % width, y: k / width };
            let (node, own) = (&nodes[(start + k) as usize], &host.nodes.nodes[(start + k) as usize]);
            let rays = rays_below(camera, plan.anchor, at);
            assert_eq!((node.rays, node.piece), (own.rays, own.piece), "{name}, {at:?}");
            assert_eq!(node.rays == RAYS_NONE, rays.is_empty(), "{name}, {at:?}");
            if rays.is_empty() {
                continue;
            }
            let [off_p, off_d] = reach(node, at, &rays);
            let [size_p, size_d] = sizes(node);
            let perturbed = [PERTURB * plan.scene_size, PERTURB * size_d];
            let [r_p, r_d] = [node.r_p, node.r_d].map(f64::from);
            assert!(off_p + perturbed[0] <= r_p && off_d + perturbed[1] <= r_d, "{name}, {at:?}: beyond {node:?}");
            let looser = [r_p - f64::from(own.r_p), r_d - f64::from(own.r_d)];
            let most = [2.0 * size_p + 4.0 * eye.length() + r_p, 2.0 * size_d + r_d].map(|size| LOOSER_MAX * size);
            assert!(looser[0] <= most[0] && looser[1] <= most[1], "{name}, {at:?}: {looser:?} wider than the host's");
        }
    }
    // tiles of several cells have a node for each cell
    let above = host.nodes.levels.iter().map(|level| (level.width * level.height) as usize).sum::<usize>();
    let has_own = |cell: &&Cell| cell.node as usize >= above;
    for cell in host.tiles.cells.iter().filter(has_own) {
        let at = Address { level: 0, x: cell.tile % host.tiles.tiles_x, y: cell.tile / host.tiles.tiles_x };
        let mask = u64::from(cell.mask_hi) << 32 | u64::from(cell.mask_lo);
        let rays = rays_below(camera, plan.anchor, at);
        let is_own = |ray: &PixelRay| mask >> (ray.pixel.1 % TILE * TILE + ray.pixel.0 % TILE) & 1 == 1;
        let rays: Vec<PixelRay> = rays.into_iter().filter(is_own).collect();
        let node = &nodes[cell.node as usize];
        let [off_p, off_d] = reach(node, at, &rays);
        assert!(off_p <= f64::from(node.r_p) && off_d <= f64::from(node.r_d), "{name}, a cell of {at:?}");
    }
    host.tiles.cells.iter().filter(has_own).count()
}

#[test]
fn turned_rays_and_bounds_are_those_of_the_camera_at_its_pose() {
    let Some(mut bench) = Bench::open() else { return };
    if !bench.gpu.has.f64 {
        return;
    }
    let mut cells = 0;
    for (lens, (pose, anchor)) in LENSES.iter().flat_map(|lens| POSES.map(|pose| (lens, pose))) {
        let name = format!("{lens}\n{pose}");
        let size = if lens.contains("lidar") { (90, 8) } else { SIZE };
        let camera = camera_of("", size, &name).unwrap();
        let (plan, host) = (plan(&camera, anchor, true), plan(&camera, anchor, false));
        let (band, host) = (&plan.bands[0], &host.bands[0]);
        let turned = band.turned.as_ref().unwrap();
        assert_eq!(band.nodes.nodes.len(), host.nodes.nodes.len(), "{name}");
        let [hi, lo, nodes] = run_kernels(&mut bench, &plan, turned);
        let number = |k: usize| f64::from(f32::from_bits(hi[k])) + f64::from(f32::from_bits(lo[k]));
        let pixels = (0..size.1).flat_map(|j| (0..size.0).map(move |i| (i, j)));
        for (i, j) in pixels.filter(|_| turned.ray_count() > 0) {
            let first = 6 * (j * (size.0 + 1) + i) as usize;
            let Some(ray) = ray_of(&camera, plan.anchor, (i, j)) else { continue };
            let v = |k: usize| DVec3::new(number(first + k), number(first + k + 1), number(first + k + 2));
            let place = camera.ray(i, j).unwrap().origin;
            // the camera's own ray is rounded in the world
            let most = RAY_ROUNDING * (ray.p.length() + turned.eye.length()) + f64::EPSILON * 8.0 * place.length();
            assert!((v(0) - ray.p).length() <= most, "{name}: the ray of ({i}, {j}) starts at {}", v(0));
            assert!((v(3) - ray.d).length() <= RAY_ROUNDING * ray.d.length(), "{name}: the ray of ({i}, {j})");
        }
        cells += assert_bounded(&name, &camera, &plan, turned.eye, bytemuck::cast_slice(&nodes), host);
    }
    assert!(cells > 0, "no lens has a tile of several cells");
}
