//! The one table of kernels: from which snippets each is joined, and which buffers it binds.
//!
//! A kernel's module is its bindings, generated from this table, and the plain concatenation of its snippets. Each snippet names
//! at its top what it provides, and what it needs of the others and of the bindings. Variants swap a snippet that provides the same
//! functions, or set an `override` constant.

use crate::image::frame::Channel;

mod kernel;
mod optics;
mod samples;
mod surfaces;
mod variant;
pub use kernel::{Access, Binding, Kernel, Parts, Snippet};
pub(crate) use kernel::{kernel, read, snippets, texture, uniform, write, write_texture};
pub use optics::{OpticsKind, bounce, fit, meet, paste};
pub use samples::{edges, edges_by_tile, recheck_samples, resolve, sample, sample_by_tile};
pub use surfaces::{mip, outline, shade, write_srgb};
pub use variant::{LightsKind, RaysKind, Variant};

pub(crate) const PARAMS: Parts = snippets!("shared/params.wgsl");
pub(crate) const ITEMS: Parts = snippets!("shared/items.wgsl");
const INDEX: Parts = snippets!("shared/index.wgsl");
const ADDRESS: Parts = snippets!("shared/address.wgsl");
pub(crate) const SLABS: Parts = snippets!("shared/slabs.wgsl");
pub(crate) const VERTEX: Parts = snippets!("shared/vertex.wgsl");
pub(crate) const TRIANGLE_ROW: Parts = snippets!("shared/triangle.wgsl");
const TRIANGLE: Parts = snippets!("shared/triangle.wgsl", "shared/vertex_real.wgsl");
pub(crate) const RAY: Parts = snippets!("shared/ray.wgsl");
const BUNDLE: Parts = snippets!("shared/ray.wgsl", "shared/bundle.wgsl");
const SHADING: Parts = snippets!("shared/shading.wgsl");
const MEETS: Parts = snippets!("shared/meets.wgsl");
/// Which pixels of a node's square a triangle may cover.
const WITHIN: Parts = snippets!("shared/node_conics.wgsl", "shared/extent.wgsl", "shared/within.wgsl");
/// Whether rays of a node may meet a triangle's box.
const BOX_MET: Parts = snippets!("shared/meets.wgsl", "shared/box_met.wgsl");
const SIDES: Parts = snippets!("shared/sides.wgsl", "shared/perturb.wgsl");
const NEARNESS: Parts = snippets!("shared/nearness.wgsl");
/// The cell of a pixel.
const CELLS: Parts = snippets!("shared/cells.wgsl");
const LANES: Parts = snippets!("shared/lanes.wgsl");
const NODE_BY_LANES: Parts = snippets!("shared/node_by_lanes.wgsl");
const COLUMN: Parts = snippets!("shared/column.wgsl");
/// No triangle has holes.
const SOLID: Parts = snippets!("textures/solid.wgsl");
const SURFACE: Parts = snippets!("shared/surface.wgsl");
const UNCERTAIN: Parts = snippets!("shared/recheck_items.wgsl");
const PAIR: Parts = snippets!("shared/pair.wgsl");
const BITS: Parts = snippets!("shared/bits.wgsl");
const MEETING: Parts = snippets!("shared/meeting.wgsl");
const MEETING_OF_RAYS: Parts = snippets!("shared/meeting_of_rays.wgsl");
pub(crate) const KEY: Parts = snippets!("shared/key.wgsl");
const REAL_F64: Parts = snippets!("shared/real_f64.wgsl");
const REAL_F32: Parts = snippets!("shared/real_f32.wgsl");
const OPTICS_ROWS: Parts = snippets!("optics/rows.wgsl");
const CAUSTICS: Parts = snippets!("caustics/rows.wgsl");

pub(crate) fn params() -> Binding {
    uniform("params", "Params")
}

fn step() -> Binding {
    uniform("step", "Step")
}

fn optic() -> Binding {
    uniform("optic", "Optic")
}

fn paths() -> Binding {
    read("paths", "array<PathState>")
}

fn counters() -> Binding {
    write("counters", "array<atomic<u32>>")
}

/// Lays out the next indirect dispatch.
pub fn args() -> Kernel {
    let bindings = vec![params(), step(), counters(), write("indirect", "array<u32>")];
    kernel("args", bindings, &[PARAMS, snippets!("args.wgsl")])
}

pub fn cull(variant: Variant) -> Kernel {
    let mut bindings = vec![
        params(),
        step(),
        read("clusters", "array<Cluster>"),
        read("nodes", "array<Node>"),
        read("tile_start", "array<u32>"),
        read("cells", "array<Cell>"),
        read("queue_in", "array<vec2<u32>>"),
        write("queue_out", "array<vec2<u32>>"),
        write("work", "array<vec2<u32>>"),
        counters(),
    ];
    bindings.extend(variant.scattered_rays(true));
    let snippets = [PARAMS, ITEMS, INDEX, WITHIN, MEETS, variant.tile_rays(), snippets!("cull.wgsl")];
    let mut kernel = kernel("cull", bindings, &snippets);
    kernel.constants.push(("CULLING", variant.culling as u32 as f64));
    kernel
}

pub fn split(variant: Variant) -> Kernel {
    let mut bindings = vec![
        params(),
        read("triangle_groups", "array<Cluster>"),
        read("nodes", variant.rows("array<Node>")),
        read("cells", "array<Cell>"),
        read("work", "array<vec2<u32>>"),
        write("tasks", "array<vec2<u32>>"),
        counters(),
    ];
    bindings.extend(variant.scattered_rays(variant.culling));
    let own = [variant.item_rays(), variant.item_node(), snippets!("split.wgsl")];
    let snippets = [&[PARAMS, ITEMS, INDEX, ADDRESS, MEETS][..], &own].concat();
    let mut kernel = kernel("split", bindings, &snippets);
    kernel.constants.push(("CULLING", variant.culling as u32 as f64));
    kernel
}

pub fn bin(variant: Variant) -> Kernel {
    let mut bindings = vec![
        params(),
        read("triangle_groups", variant.rows("array<Cluster>")),
        read("nodes", variant.rows("array<Node>")),
        read("tasks", "array<vec2<u32>>"),
        read("triangles", "array<vec4<u32>>"),
        read("vertices_hi", "array<f32>"),
        read("cells", "array<Cell>"),
        counters(),
    ];
    let mut own = snippets!("shared/triangle_group_rows.wgsl", "shared/by_pair.wgsl");
    if variant.by_tile {
        let unsorted = write("unsorted", "array<vec2<u32>>");
        bindings.extend([unsorted, write("ranks", "array<u32>"), write("ends", "array<atomic<u32>>")]);
        own = snippets!("shared/triangle_group_by_lanes.wgsl", "shared/by_tile.wgsl");
    } else {
        bindings.push(write("pairs", "array<vec2<u32>>"));
    }
    let snippets = [PARAMS, ITEMS, INDEX, ADDRESS, SLABS, VERTEX, PAIR, WITHIN, BOX_MET, variant.item_node()];
    bindings.extend(variant.scattered_rays(variant.culling));
    let snippets = [&snippets[..], &[variant.item_rays(), own, snippets!("bin.wgsl")]].concat();
    let mut kernel = kernel("bin", bindings, &snippets);
    kernel.constants.push(("SLABBED", variant.slabbed as u32 as f64));
    kernel.constants.push(("COUNTING", variant.counting as u32 as f64));
    kernel.constants.push(("SAMPLE_REACH", variant.sample_reach()));
    kernel
}

/// Runs of the tiles in the sorted list of pairs.
pub fn allot() -> Kernel {
    let bindings = vec![
        params(),
        write("starts", "array<u32>"),
        write("ends", "array<u32>"),
        write("busy", "array<u32>"),
        counters(),
    ];
    kernel("allot", bindings, &[PARAMS, ITEMS, snippets!("allot.wgsl")])
}

pub fn sort() -> Kernel {
    let bindings = vec![
        params(),
        read("unsorted", "array<vec2<u32>>"),
        read("ranks", "array<u32>"),
        read("starts", "array<u32>"),
        write("pairs", "array<vec2<u32>>"),
        counters(),
    ];
    kernel("sort", bindings, &[PARAMS, ITEMS, PAIR, snippets!("sort.wgsl")])
}

pub fn raster(variant: Variant) -> Kernel {
    if variant.by_tile {
        return raster_by_tile(variant);
    }
    let mut kernel = into_visibility("raster", variant, &[UNCERTAIN, snippets!("raster.wgsl")]);
    kernel.constants.push(("ALL_UNCERTAIN", f64::from(u8::from(variant.all_uncertain && variant.rechecks()))));
    kernel
}

fn raster_by_tile(variant: Variant) -> Kernel {
    let mut bindings = vec![
        params(),
        read("pairs", "array<vec2<u32>>"),
        write("starts", "array<u32>"),
        read("ends", "array<u32>"),
        write("busy", "array<u32>"),
        write("recheck_items", "array<vec2<u32>>"),
        read("triangles", "array<vec4<u32>>"),
        read("vertices_hi", "array<f32>"),
        read("vertices_lo", "array<f32>"),
        read("nodes", "array<vec4<f32>>"),
        write("visibility", "array<atomic<u64>>"),
        counters(),
    ];
    let column = match variant.rays {
        RaysKind::Field => {
            bindings.extend([read("rays_hi", "array<vec2<f32>>"), read("rays_lo", "array<vec2<f32>>")]);
            snippets!("camera/field_column.wgsl")
        }
        _ => {
            let pieces = read("pieces", "array<vec4<f32>>");
            bindings.extend([pieces, read("tile_start", "array<u32>"), read("cells", "array<Cell>")]);
            snippets!("camera/piece.wgsl", "camera/pieces_column.wgsl")
        }
    };
    if variant.bounced {
        bindings.extend([optic(), paths()]);
    }
    let snippets = [PARAMS, ITEMS, INDEX, SLABS, VERTEX, variant.real(), TRIANGLE, BUNDLE, KEY, PAIR, BITS];
    let own = [
        WITHIN,
        variant.merge(),
        UNCERTAIN,
        LANES,
        NODE_BY_LANES,
        COLUMN,
        column,
        snippets!("shared/waiting.wgsl"),
        snippets!("shared/pixel_test.wgsl"),
        snippets!("raster_by_tile.wgsl"),
    ];
    let mut kernel = kernel("raster", bindings, &[&snippets[..], &own, variant.start()].concat());
    kernel.constants = variant.constants();
    kernel.constants.push(("COUNTING", variant.counting as u32 as f64));
    kernel
}

/// What bounds in f32 may leave to be rechecked.
pub fn recheck(variant: Variant) -> Kernel {
    into_visibility("recheck", variant, &[SIDES, snippets!("recheck.wgsl")])
}

/// What is proven of what raster and recheck found.
pub fn certify(variant: Variant, planes: &[Channel]) -> Kernel {
    let mut bindings = vec![
        params(),
        step(),
        read("pairs", "array<vec2<u32>>"),
        read("triangles", "array<vec4<u32>>"),
        read("vertices_hi", "array<f32>"),
        read("vertices_lo", "array<f32>"),
        read("visibility", "array<u32>"),
        write("proofs", "array<atomic<u32>>"),
        write("planes", "array<u32>"),
        counters(),
    ];
    bindings.extend(variant.rays());
    bindings.extend([read("tile_start", "array<u32>"), read("cells", "array<Cell>")]);
    let snippets = [PARAMS, ITEMS, INDEX, SLABS, VERTEX, variant.real(), TRIANGLE, BUNDLE, KEY];
    let shared = [PAIR, BITS, MEETING, variant.camera(), snippets!("shared/proof.wgsl")];
    let own = [NEARNESS, SOLID, snippets!("certify.wgsl")];
    let all = [&snippets[..], &shared[..], variant.coverage(), variant.proof(), &own].concat();
    let mut kernel = kernel("certify", bindings, &all).with_planes(planes);
    kernel.constants.extend(variant.constants());
    kernel
}

/// A kernel from pairs to the visibility buffer.
fn into_visibility(name: &'static str, variant: Variant, own: &[Parts]) -> Kernel {
    let mut bindings = vec![
        params(),
        step(),
        read("pairs", "array<vec2<u32>>"),
        write("recheck_items", "array<vec2<u32>>"),
        read("triangles", "array<vec4<u32>>"),
        read("vertices_hi", "array<f32>"),
        read("vertices_lo", "array<f32>"),
        write("visibility", variant.keys()),
        counters(),
    ];
    bindings.extend(variant.rays());
    bindings.extend([read("tile_start", "array<u32>"), read("cells", "array<Cell>")]);
    if variant.bounced {
        bindings.extend([optic(), paths()]);
    }
    if variant.masked {
        bindings.extend([read("surfaces", "array<vec4<u32>>"), read("materials", "array<Material>")]);
        bindings.extend(variant.pages());
    }
    let snippets = [PARAMS, ITEMS, INDEX, SLABS, VERTEX, variant.real(), TRIANGLE, BUNDLE, KEY, variant.holes()];
    let shared = [PAIR, BITS, variant.merge(), MEETING, snippets!("shared/hits.wgsl"), variant.camera()];
    let all = [&snippets[..], &shared[..], own, variant.coverage(), variant.start()].concat();
    let mut kernel = kernel(name, bindings, &all);
    kernel.constants = variant.constants();
    kernel.constants.push(("COUNTING", variant.counting as u32 as f64));
    kernel
}

/// Points against the beams of a camera; no part of a frame.
pub fn sift() -> Kernel {
    let bindings = vec![
        uniform("chunk", "Chunk"),
        read("beams", "array<Beam>"),
        read("points", "array<vec4<f32>>"),
        write("found", "array<u32>"),
    ];
    kernel("sift", bindings, &[PARAMS, ITEMS, snippets!("shared/beams.wgsl"), snippets!("sift.wgsl")])
}

/// Caustic triangles onto the maps of receivers; no part of a frame.
pub fn deposit() -> Kernel {
    let bindings = vec![
        uniform("casting", "Casting"),
        read("casts", "array<Cast>"),
        read("receivers", "array<Receiver>"),
        write("sums", "array<atomic<u32>>"),
    ];
    kernel("deposit", bindings, &[PARAMS, ITEMS, CAUSTICS, snippets!("deposit.wgsl")])
}

/// Caustics into the colour planes, after `shade`.
pub fn gather(variant: Variant, planes: &[Channel]) -> Kernel {
    let mut bindings = vec![
        params(),
        read("visibility", "array<u32>"),
        read("landing_of", "array<u32>"),
        read("landings", "array<Landing>"),
        read("receivers", "array<Receiver>"),
        read("sums", "array<u32>"),
        write("planes", "array<u32>"),
    ];
    // of keys the ids alone are read
    let snippets = [PARAMS, ITEMS, SLABS, REAL_F32, KEY, SHADING, CAUSTICS, snippets!("gather.wgsl")];
    let seen: &[Parts] = if variant.optics.is_some() {
        bindings.extend([optic(), paths()]);
        &[OPTICS_ROWS, snippets!("caustics/bounced.wgsl")]
    } else {
        &[snippets!("caustics/plain.wgsl")]
    };
    let mut kernel = kernel("gather", bindings, &[&snippets[..], seen].concat()).with_planes(planes);
    kernel.constants.push(("SLABBED", variant.slabbed as u32 as f64));
    kernel
}

/// All kernels of a variant that writes `planes`, in the order of the pipeline, and those beside it.
pub fn all(variant: Variant, planes: &[Channel]) -> Vec<Kernel> {
    let mut all = vec![args(), cull(variant), split(variant), bin(variant), raster(variant), shade(variant, planes)];
    all.extend(variant.by_tile.then(|| [allot(), sort()]).into_iter().flatten());
    if variant.rechecks() {
        all.push(recheck(variant));
    }
    if planes.contains(&Channel::Certified) {
        all.push(certify(variant, planes));
    }
    if variant.samples_edges() {
        all.extend([edges(variant), sample(variant), resolve(variant, planes)]);
        if variant.samples_by_tile() {
            all.extend([edges_by_tile(variant), sample_by_tile(variant), recheck_samples(variant)]);
        }
    }
    if variant.bounces_rays() {
        all.extend([bounce(variant), fit(variant)]);
    }
    if variant.meets() {
        all.push(meet(variant));
    }
    if variant.optics == Some(OpticsKind::Atlas) {
        all.push(paste(variant, planes));
    }
    all.extend(variant.outlined.then(|| outline(planes)));
    all.extend([gather(variant, planes), write_srgb(planes), mip(), sift(), deposit()]);
    all
}
