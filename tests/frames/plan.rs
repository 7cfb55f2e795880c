//! The plan: tiles split the image into cells as the camera says, bands fit the bindings, nodes bound every ray.

use crate::common;

use anamorph::internals::camera::TILE;
use anamorph::internals::camera::kinds::glc::Glc;
use anamorph::internals::camera::spec::CameraKind;
use anamorph::internals::camera::{Camera, Field, Ray, Rays};
use anamorph::internals::engine::RunOptions;
use anamorph::internals::engine::left_out::LeftOut;
use anamorph::internals::engine::plan::slabs::Slabs;
use anamorph::internals::engine::plan::variant::variant;
use anamorph::internals::engine::plan::{Band, Plan, PlanTarget, SceneContents, SceneExtent, SceneShape, Wanted};
use anamorph::internals::gpu::device::AdapterFeatures;
use anamorph::internals::gpu::layout::{self, BRANCH};
use anamorph::internals::image::frame::Channel;
use common::cameras::{MeshShape, glc_of_each_class, mesh_camera, mesh_spec, raymap};
use common::file::camera_of;
use common::layered;
use common::rng::Rng;
use common::{FORWARD, camera};
use glam::{DVec2, DVec3, Vec3};

const SIZE: (u32, u32) = (101, 77);
const LAVAPIPE_BINDING: u64 = 128 << 20;
const HAS_ALL: AdapterFeatures = AdapterFeatures {
    f64: true,
    software: true,
    f64_is_wrong: false,
    atomics64: true,
    lanes: true,
    wide: false,
    by_pair: false,
    timestamps: true,
    clip_distances: true,
    draw_counts: false,
};
const HAS_NONE: AdapterFeatures = AdapterFeatures {
    f64: false,
    atomics64: false,
    lanes: false,
    wide: false,
    by_pair: false,
    timestamps: false,
    clip_distances: false,
    draw_counts: false,
    software: true,
    f64_is_wrong: false,
};

fn wanted(channels: &[Channel]) -> Wanted {
    Wanted::of(channels.to_vec())
}

fn of(triangles: usize) -> SceneContents {
    SceneContents { triangles, ..SceneContents::default() }
}

/// The plan of frames without options.
fn new_plan(
    camera: &Camera,
    contents: SceneContents,
    extent: SceneExtent,
    wanted: &Wanted,
    has: AdapterFeatures,
    limit: u64,
) -> Plan {
    let variant = variant(camera, contents, wanted, has, &RunOptions::default());
    Plan::new(variant, camera, contents, extent, wanted, has, limit)
}

fn plan(camera: &Camera, binding_limit: u64) -> Plan {
    new_plan(camera, of(1000), SceneExtent::point(DVec3::ZERO), &wanted(&Channel::ALL), HAS_ALL, binding_limit)
}

/// A GLC of random near and far points.
fn random_glc(rng: &mut Rng) -> CameraKind {
    let offset = [0.0, 1.0, 1e3, 1e6][rng.below(4)] * rng.vector();
    let mut three = || [offset + 5.0 * rng.vector(), offset + 5.0 * rng.vector(), offset + 5.0 * rng.vector()];
    CameraKind::new("glc", Glc { near: three(), far: three() })
}

/// Rays with nothing in common.
fn random_field(rng: &mut Rng) -> Camera {
    let n = (SIZE.0 * SIZE.1) as usize;
    let p: Vec<DVec3> = (0..n).map(|_| 5.0 * rng.vector()).collect();
    let d: Vec<DVec3> = (0..n).map(|_| if rng.below(9) == 0 { DVec3::ZERO } else { rng.vector() }).collect();
    let field = Field::new(SIZE.0, SIZE.1, &p, &d).unwrap();
    Camera::of("raymap", SIZE, FORWARD, Rays::Field(field))
}

fn cameras() -> Vec<(String, Camera)> {
    let mut rng = Rng(1);
    let mut list: Vec<(String, CameraKind)> =
        glc_of_each_class().into_iter().map(|(name, kind)| (name.to_string(), kind)).collect();
    list.extend((0..20).map(|k| (format!("glc {k}"), random_glc(&mut rng))));
    for (columns, rows) in [(1, 1), (3, 2), (16, 16), (40, 30)] {
        for bits in 0..8 {
            let shape = MeshShape { normalize: bits & 1 != 0, weights: bits & 2 != 0, discontinuous: bits & 4 != 0 };
            list.push((format!("{columns} x {rows} {shape:?}"), mesh_camera(bits, columns, rows, shape)));
        }
    }
    let mut holes = mesh_spec(9, 12, 9, MeshShape::default());
    holes.triangles.retain(|t| (t[0] + t[2]) % 5 != 0);
    list.push(("holes".into(), CameraKind::new("mesh", holes)));
    let mut list: Vec<(String, Camera)> =
        list.into_iter().map(|(name, kind)| (name, camera(kind, SIZE, FORWARD))).collect();
    list.push(("ray map".into(), raymap(SIZE.0, SIZE.1, FORWARD)));
    list.push(("random ray map".into(), random_field(&mut rng)));
    list
}

/// The piece that the tiles of `band` give to image pixel (i, j), by its number in the camera; every claim.
fn claims(band: &Band, i: u32, j: u32) -> Vec<u32> {
    let y = j - band.row;
    let tile = (y / TILE * band.tiles.tiles_x + i / TILE) as usize;
    let bit = y % TILE * TILE + i % TILE;
    let cells = &band.tiles.cells[band.tiles.start[tile] as usize..band.tiles.start[tile + 1] as usize];
    assert!(cells.iter().all(|c| c.tile as usize == tile));
    let owns = |c: &&layout::Cell| (c.mask_lo as u64 | (c.mask_hi as u64) << 32) >> bit & 1 == 1;
    let number = |c: &layout::Cell| band.tiles.pieces.get(c.piece as usize).map_or(c.piece, |p| p.number);
    cells.iter().filter(owns).map(number).collect()
}

#[test]
fn cells_split_the_image_as_the_camera_does() {
    for (name, camera) in cameras() {
        for limit in [LAVAPIPE_BINDING, 1 << 16] {
            for band in &plan(&camera, limit).bands {
                let pixels = (0..band.rows).flat_map(|y| (0..SIZE.0).map(move |x| (x, band.row + y)));
                let mut owned = 0;
                for (i, j) in pixels {
                    let owner = camera.pixel(0, i, j).map(|(piece, _)| piece);
                    assert_eq!(claims(band, i, j), owner.into_iter().collect::<Vec<_>>(), "{name} at {i},{j}");
                    owned += owner.is_some() as u32;
                }
                let bits = |c: &layout::Cell| c.mask_lo.count_ones() + c.mask_hi.count_ones();
                let all: u32 = band.tiles.cells.iter().map(bits).sum();
                assert_eq!(all, owned, "{name}: cells own pixels beyond the image");
                assert!(band.tiles.cells.iter().all(|c| bits(c) > 0), "{name}: a cell without pixels");
            }
        }
    }
}

#[test]
fn a_packed_piece_gives_the_rays_of_its_pixels() {
    for (name, camera) in cameras() {
        let Rays::Pieces(_) = &camera.layers[0] else { continue };
        let extent = SceneExtent::of(&camera, SceneShape::default());
        let plan = new_plan(&camera, of(1), extent, &wanted(&Channel::ALL), HAS_ALL, 1 << 16);
        for band in &plan.bands {
            for (i, j) in (0..band.rows).step_by(5).flat_map(|y| (0..SIZE.0).step_by(7).map(move |x| (x, band.row + y)))
            {
                let Some((number, bundle)) = camera.pixel(0, i, j) else { continue };
                let row = band.tiles.pieces.iter().find(|p| p.number == number).unwrap();
                let (x, y) = (i as f64 - row.origin_x as f64, (j - band.row) as f64 - row.origin_y as f64);
                let v = |hi: [f32; 3], lo: [f32; 3]| Vec3::from(hi).as_dvec3() + Vec3::from(lo).as_dvec3();
                let at = |c: [DVec3; 3]| c[0] + x * c[1] + y * c[2];
                let h = row.h_hi as f64
                    + row.h_lo as f64
                    + x * (row.hx_hi as f64 + row.hx_lo as f64)
                    + y * (row.hy_hi as f64 + row.hy_lo as f64);
                let p = at([v(row.p_hi, row.p_lo), v(row.px_hi, row.px_lo), v(row.py_hi, row.py_lo)]) / h + plan.anchor;
                let d = at([v(row.d_hi, row.d_lo), v(row.dx_hi, row.dx_lo), v(row.dy_hi, row.dy_lo)]) / h;
                let ray = bundle.ray(0.0, 0.0);
                // pairs of f32 hold 2^-48 of values up to 100 (relative to the anchor), pixel offsets are up to 101
                let bound = 1e-10 + f64::EPSILON * 8.0 * plan.anchor.length();
                assert!(
                    (p - ray.origin).length() <= bound && (d - ray.direction).length() <= bound,
                    "{name} at {i},{j}"
                );
            }
        }
    }
}

#[test]
fn bands_cover_the_image_and_their_tables_fit_the_bindings() {
    for (name, camera) in cameras() {
        let mut counts = Vec::new();
        for limit in [LAVAPIPE_BINDING, 1 << 20, 1 << 18, 1 << 17, 1 << 16] {
            let plan = plan(&camera, limit);
            let mut row = 0;
            for band in &plan.bands {
                assert_eq!((band.row, band.row % TILE), (row, 0), "{name}");
                row += band.rows;
                let pixels = band.rows as u64 * SIZE.0 as u64;
                let table = band.rays.as_ref().map_or(0, |f| f.hi.len().max(f.lo.len()) as u64 * 4);
                let largest = (8 * pixels)
                    .max(4 * pixels * plan.planes.len() as u64)
                    .max(table)
                    .max(std::mem::size_of_val(&band.tiles.cells[..]) as u64)
                    .max(std::mem::size_of_val(&band.tiles.pieces[..]) as u64)
                    .max(std::mem::size_of_val(&band.nodes.nodes[..]) as u64);
                assert!(largest <= limit, "{name}: {largest} bytes of {limit} in a band of {} rows", band.rows);
            }
            assert_eq!(row, SIZE.1, "{name}");
            counts.push(plan.bands.len());
        }
        assert!(counts[0] == 1 && counts.is_sorted() && counts[4] >= 5, "{name}: {counts:?}");
    }
}

#[test]
fn a_limit_too_small_for_a_row_of_tiles_gives_bands_of_one_row() {
    let (_, kind) = glc_of_each_class().swap_remove(0);
    let plan = plan(&camera(kind, SIZE, FORWARD), 256);
    assert!(plan.bands.iter().all(|b| b.rows <= TILE));
    assert_eq!(plan.bands.len() as u32, SIZE.1.div_ceil(TILE));
}

/// Asserts that every node bounds the rays of the pixels below it, and that a node without rays has none.
fn assert_bounded(name: &str, camera: &Camera, anchor: DVec3, slabs: Slabs, band: &Band) {
    let slab_rows = band.tiles.slab_rows;
    let all_rows = slab_rows * slabs.count();
    assert_eq!(slab_rows, slabs.tile_rows(band.rows));
    for (depth, level) in band.nodes.levels.iter().enumerate() {
        let side = TILE * BRANCH.pow(depth as u32);
        let expected = (SIZE.0.div_ceil(side), (all_rows * TILE).div_ceil(side));
        assert_eq!((level.width, level.height), expected, "{name}");
        let mut seen = vec![false; (level.width * level.height) as usize];
        let pixels = (0..band.rows).flat_map(|y| (0..SIZE.0).map(move |x| (x, y)));
        for (slab, (i, row)) in pixels.flat_map(|p| (0..slabs.count()).map(move |s| (s, p))) {
            let Some((ray, bend)) = slab_ray(camera, slabs, slab, i, band.row + row) else { continue };
            let y = slab * slab_rows * TILE + row;
            let k = y / side * level.width + i / side;
            seen[k as usize] = true;
            let node = &band.nodes.nodes[(level.start + k) as usize];
            let is_inside = contains(node, (i % side, y % side), side, (ray.origin - anchor, ray.direction), bend);
            assert!(is_inside, "{name}, level {depth}, slab {slab}, pixel {i},{row}: beyond {node:?}");
            if depth > 0 {
                continue;
            }
            let bit = y % TILE * TILE + i % TILE;
            let cells =
                &band.tiles.cells[band.tiles.start[k as usize] as usize..band.tiles.start[k as usize + 1] as usize];
            let owns = |c: &&layout::Cell| (u64::from(c.mask_hi) << 32 | u64::from(c.mask_lo)) >> bit & 1 == 1;
            let cell = cells.iter().find(owns).unwrap();
            let node = &band.nodes.nodes[cell.node as usize];
            let is_inside = contains(node, (i % TILE, y % TILE), TILE, (ray.origin - anchor, ray.direction), bend);
            assert!(is_inside, "{name}, slab {slab}, pixel {i},{row}: beyond its cell's {node:?}");
            assert!(cells.len() > 1 || cell.node == k, "{name}: a lone cell has its tile's node");
        }
        for (k, seen) in seen.iter().enumerate() {
            let node = &band.nodes.nodes[level.start as usize + k];
            assert_eq!(node.rays != 0, *seen, "{name}, level {depth}, node {k}");
        }
    }
}

/// A node over `side` pixels per side bounds a ray (origin, direction) that bends so far, of its pixel (x, y).
fn contains(node: &layout::Node, (x, y): (u32, u32), side: u32, ray: (DVec3, DVec3), bend: f64) -> bool {
    let q = (DVec2::new(x as f64, y as f64) + 0.5) / (side as f64 / 2.0) - 1.0;
    let at = |c: [[f32; 3]; 3]| {
        let c = c.map(|v| Vec3::from(v).as_dvec3());
        c[0] + q.x * c[1] + q.y * c[2]
    };
    let off_p = (at([node.p, node.px, node.py]) - ray.0).length();
    let off_d = (at([node.d, node.dx, node.dy]) - ray.1).length();
    node.rays != layout::RAYS_NONE && off_p + bend <= node.r_p as f64 && off_d <= node.r_d as f64
}

/// The ray of a pixel over its slab's span of t, and how far the true one leaves it at the same part of the span.
fn slab_ray(camera: &Camera, slabs: Slabs, slab: u32, i: u32, j: u32) -> Option<(Ray, f64)> {
    let (layer, [from, to]) = slabs.of_slab(slab);
    if !camera.is_curved() {
        return camera.pixel(layer, i, j).map(|(_, b)| (b.ray(0.0, 0.0), 0.0));
    }
    let (_, curve) = camera.curve(layer, i, j)?;
    let ray = Ray { origin: curve.at(from), direction: curve.at(to) - curve.at(from) };
    let off = |k: u32| {
        let s = f64::from(k) / 16.0;
        (curve.at(from + s * (to - from)) - (ray.origin + s * ray.direction)).length()
    };
    Some((ray, (0..=16).map(off).fold(0.0, f64::max)))
}

/// Chains and curved cameras.
fn layered_cameras() -> Vec<(String, Camera)> {
    let chain = |layers, shape| layered::chain(8, layers, (5, 4), shape, SIZE);
    vec![
        ("chain".into(), chain(3, MeshShape::default())),
        (
            "discontinuous chain".into(),
            chain(2, MeshShape { discontinuous: true, weights: true, ..MeshShape::default() }),
        ),
        ("parabolas".into(), layered::wavy(2, 0.5, true, SIZE)),
        ("cubics".into(), layered::wavy(3, 1.5, false, SIZE)),
        ("straight, then curved".into(), layered::straight_then_curved(SIZE)),
    ]
}

#[test]
fn nodes_bound_every_ray_of_their_squares() {
    for (name, camera) in cameras().into_iter().chain(layered_cameras()) {
        for extent in
            [SceneExtent::of(&camera, SceneShape::default()), SceneExtent::point(DVec3::new(3.0, -200.0, 0.1))]
        {
            for limit in [LAVAPIPE_BINDING, 1 << 17] {
                let plan = new_plan(&camera, of(1), extent, &wanted(&Channel::ALL), HAS_ALL, limit);
                plan.bands.iter().for_each(|b| assert_bounded(&name, &camera, plan.anchor, plan.slabs, b));
            }
        }
    }
}

#[test]
fn nodes_of_one_affine_bundle_bound_it_tightly() {
    for (name, kind) in glc_of_each_class() {
        let plan = plan(&camera(kind, SIZE, FORWARD), LAVAPIPE_BINDING);
        let band = &plan.bands[0];
        assert!(band.nodes.exact, "{name}");
        for node in &band.nodes.nodes {
            let size = |c: [[f32; 3]; 3]| c.iter().map(|v| Vec3::from(*v).length()).sum::<f32>();
            // rounding of a row to f32 and of what kernels make of it, 2^-22 of its sizes, and no more
            let (p, d) = (size([node.p, node.px, node.py]), size([node.d, node.dx, node.dy]));
            let bound = (1.0 / (1u32 << 21) as f32).max(f32::MIN_POSITIVE);
            assert!(node.r_p <= bound * p + 1e-9 && node.r_d <= bound * d + 1e-9, "{name}: {node:?}");
        }
    }
}

#[test]
fn the_key_has_bits_for_every_id() {
    let (_, kind) = glc_of_each_class().swap_remove(0);
    let camera = camera(kind, (16, 16), FORWARD);
    for (triangles, bits) in
        [(0, 1), (1, 1), (2, 1), (3, 2), (4, 2), (5, 3), (1 << 20, 20), ((1 << 20) + 1, 21), (1 << 28, 28)]
    {
        let plan = new_plan(
            &camera,
            of(triangles),
            SceneExtent::point(DVec3::ZERO),
            &wanted(&Channel::ALL),
            HAS_ALL,
            LAVAPIPE_BINDING,
        );
        assert_eq!(plan.id_bits, bits, "{triangles} triangles");
        assert!(triangles as u64 <= 1 << bits && bits <= layout::ID_BITS_MAX);
    }
}

#[test]
fn planes_are_what_is_wanted_and_colour_where_a_picture_follows_from_it() {
    let (_, kind) = glc_of_each_class().swap_remove(0);
    let camera = camera(kind, (16, 16), FORWARD);
    let planes = |channels: &[Channel], srgb8: bool, samples: u32| {
        let wanted = Wanted { srgb8, samples, ..wanted(channels) };
        new_plan(&camera, of(9), SceneExtent::point(DVec3::ZERO), &wanted, HAS_ALL, LAVAPIPE_BINDING).planes
    };
    use Channel::{B, G, R, T, Z};
    assert_eq!(planes(&[T, Z, T], false, 1), [Z, T]);
    // shade writes the picture, unless samples change it
    assert_eq!(planes(&[Z, G], true, 1), [G, Z]);
    assert_eq!(planes(&[], true, 1), []);
    assert_eq!(planes(&[Z, G], true, 4), [R, G, B, Z]);
    assert_eq!(planes(&[], true, 4), [R, G, B]);
    assert_eq!(planes(&Channel::ALL, true, 1), Channel::ALL);
}

#[test]
fn what_is_left_out_is_said() {
    let left_out = |camera: &Camera, normals: bool, wanted: &Wanted, has: AdapterFeatures, limit: u64| {
        let all = SceneContents {
            has_normals: true,
            has_uvs: true,
            has_colors: true,
            has_images: true,
            has_alpha_masks: true,
            has_gloss: true,
            has_sky: true,
            has_shadows: true,
            has_pictures: true,
            has_style: true,
            line_reach: 2,
            ..of(9)
        };
        let contents = if normals { all } else { of(9) };
        let plan = new_plan(camera, contents, SceneExtent::point(DVec3::ZERO), wanted, has, limit);
        plan.left_out
    };
    let (_, kind) = glc_of_each_class().swap_remove(3);
    let glc = camera(kind, SIZE, FORWARD);
    let every: Vec<Channel> = Channel::every().collect();
    let all = Wanted { srgb8: true, counting: true, samples: 4, analytic: true, ..wanted(&every) };
    let counted = left_out(&glc, true, &Wanted { analytic: false, ..all.clone() }, HAS_ALL, LAVAPIPE_BINDING);
    assert!(counted.contains(&LeftOut::Areas));
    let least = left_out(&glc, true, &all, HAS_ALL, LAVAPIPE_BINDING);
    assert_eq!(
        least,
        [
            LeftOut::RayTable,
            LeftOut::Curves,
            LeftOut::Slabs,
            LeftOut::RayResiduals,
            LeftOut::BoundsPerCell,
            LeftOut::Bounces,
            LeftOut::Bands,
            LeftOut::Spheres,
            LeftOut::Volume { has_volume: false },
            LeftOut::TimeSteps,
            LeftOut::SecondDepthDispatch
        ]
    );
    let eye = r#"eye = { kind = "pinhole", eye = [0, 0, 5], target = [0, 0, 0], vfov = 40 }"#;
    for (facets, is_left_out) in [("normals", true), ("exact", false)] {
        let keys = format!("mirror = {{ shape = \"sphere\", radius = 1 }}\nfacets = \"{facets}\"");
        let mirror = camera_of("", SIZE, &format!("kind = \"reflection\"\n{eye}\n{keys}")).unwrap();
        let left_out = left_out(&mirror, true, &all, HAS_ALL, LAVAPIPE_BINDING);
        assert!(left_out.contains(&LeftOut::Meet) == is_left_out && !left_out.contains(&LeftOut::Bounces));
    }
    assert!(!left_out(&glc, true, &all, HAS_ALL, 1 << 16).contains(&LeftOut::Bands));
    let few = left_out(&glc, false, &wanted(&[Channel::T]), HAS_NONE, LAVAPIPE_BINDING);
    assert!(few.iter().any(|left| matches!(left, LeftOut::Channels(_))));
    for what in [
        LeftOut::Certify,
        LeftOut::SmoothNormals,
        LeftOut::Textures { has_images: false },
        LeftOut::AlphaMasks,
        LeftOut::Gloss,
        LeftOut::Sky,
        LeftOut::Shadows,
        LeftOut::Pictures,
        LeftOut::SurfaceStyles,
        LeftOut::Outline,
        LeftOut::Write,
        LeftOut::FragmentCounters,
        LeftOut::AdapterF64 { failed_test: false },
    ] {
        assert!(few.contains(&what) && !least.contains(&what), "{what:?}: {few:?}");
    }
    assert!(!few.contains(&LeftOut::SecondDepthDispatch));
    let field = left_out(&raymap(SIZE.0, SIZE.1, FORWARD), true, &all, HAS_ALL, LAVAPIPE_BINDING);
    assert!(field.contains(&LeftOut::EdgeConics { is_curved: false }) && !field.contains(&LeftOut::RayTable));
    assert!(!field.contains(&LeftOut::RayResiduals));
    let discontinuous =
        camera(mesh_camera(1, 16, 16, MeshShape { discontinuous: true, ..MeshShape::default() }), SIZE, FORWARD);
    assert!(!left_out(&discontinuous, true, &all, HAS_ALL, LAVAPIPE_BINDING).contains(&LeftOut::BoundsPerCell));
    let pieces = camera(mesh_camera(1, 4, 4, MeshShape::default()), SIZE, FORWARD);
    assert!(!left_out(&pieces, true, &all, HAS_ALL, LAVAPIPE_BINDING).contains(&LeftOut::RayResiduals));
    let chain =
        left_out(&layered::chain(1, 2, (2, 2), MeshShape::default(), SIZE), true, &all, HAS_ALL, LAVAPIPE_BINDING);
    assert!(!chain.contains(&LeftOut::Slabs) && chain.contains(&LeftOut::Curves));
    let curves = left_out(&layered::wavy(2, 0.5, false, SIZE), true, &all, HAS_ALL, LAVAPIPE_BINDING);
    assert!(!curves.contains(&LeftOut::Slabs) && !curves.contains(&LeftOut::Curves));
    assert!(curves.contains(&LeftOut::Recheck) && !chain.contains(&LeftOut::Recheck));
}

#[test]
fn the_anchor_is_near_the_rays_and_in_the_scene() {
    let mut rng = Rng(2);
    for _ in 0..50 {
        let camera = camera(random_glc(&mut rng), SIZE, FORWARD);
        let start = camera.ray(SIZE.0 / 2, SIZE.1 / 2).unwrap().origin;
        assert_eq!(SceneExtent::of(&camera, SceneShape::default()).anchor, start);
        let (a, b) = (rng.vector(), rng.vector());
        let (lo, hi) = (a.min(b), a.max(b));
        let (bounds, grain) = (Some((lo, hi)), 1e-3 * (hi - lo).max_element());
        for (grain, most) in [(0.0, (hi - lo).max_element() / 2.0), (grain, 1024.0 * grain)] {
            let SceneExtent { anchor, origin, .. } = SceneExtent::of(&camera, SceneShape { bounds, grain });
            let off = (anchor - start.clamp(lo, hi)).abs().max_element();
            assert!(off <= most / 2.0 && (origin - (lo + hi) / 2.0).abs().max_element() <= most / 2.0);
            let coarse = SceneShape { bounds, grain: 1e-6 * grain };
            let SceneExtent { anchor: own, origin: moved, .. } = SceneExtent::of(&camera, coarse);
            assert_eq!(moved, if grain > 0.0 { own } else { origin });
            // the way between both is stored as f32
            assert_eq!((anchor - origin).as_vec3().as_dvec3(), anchor - origin);
        }
    }
}

/// The plan of a pose that takes over tiles of an earlier one is the plan made anew.
#[test]
fn tiles_that_are_taken_over_are_those_of_a_plan_made_anew() {
    let poses = ["eye = [0, 0.2, 2.5]\ntarget = [0, 0, 0]", "eye = [-3, 1, 0]\ntarget = [0.2, 0, 0]\nup = [1, 0, 0]"];
    // the strips of a width of 61 pixels end 0.4 px behind the border of a tile: samples lie in a strip that owns no centre there
    for (keys, size) in [
        ("kind = \"pinhole\"\nvfov = 60", SIZE),
        ("kind = \"fisheye\"\nfov = 150\npieces = 60", SIZE),
        ("kind = \"cylinder\"\nfov = 250\nstrips = 5", (61, 45)),
    ] {
        for samples in [1, 4] {
            let wanted = Wanted { samples, srgb8: true, ..Wanted::of(vec![Channel::T]) };
            let [first, second] = poses.map(|pose| camera_of("", size, &format!("{keys}\n{pose}")).unwrap());
            let plan = |camera: &Camera, last| {
                let variant = variant(camera, SceneContents::default(), &wanted, HAS_ALL, &RunOptions::default());
                let target = PlanTarget { has: HAS_ALL, binding_limit: LAVAPIPE_BINDING, aims: true, last };
                let extent = SceneExtent::point(DVec3::ZERO);
                Plan::on(target, variant, camera, SceneContents::default(), extent, &wanted)
            };
            let before = plan(&first, None);
            let [kept, anew] = [plan(&second, Some((&before, &first))), plan(&second, None)];
            for (a, b) in kept.bands.iter().zip(&anew.bands) {
                let name = format!("{keys}, {samples} samples");
                assert_eq!((&a.tiles.start, &a.tiles.cell_samples), (&b.tiles.start, &b.tiles.cell_samples), "{name}");
                assert_eq!((&a.tiles.cells, &a.tiles.pieces), (&b.tiles.cells, &b.tiles.pieces), "{name}");
                assert_eq!((&a.nodes.nodes, a.nodes.exact), (&b.nodes.nodes, b.nodes.exact), "{name}");
            }
        }
    }
}
