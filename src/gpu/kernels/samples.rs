//! The kernels that find the pixels that hold an edge, and what their samples see.

use super::*;

const CELL_SAMPLES: Parts = snippets!("samples/cells.wgsl");
const SAMPLE_PLACES: Parts = snippets!("samples/places.wgsl");
const SAMPLE_HITS: Parts = snippets!("samples/hits.wgsl");
const DEPTH_BOUNDS: Parts = snippets!("samples/depth_bounds.wgsl");

impl Variant {
    /// Pixels that hold an edge have several samples.
    pub fn samples_edges(self) -> bool {
        self.samples > 1
    }

    /// The edges of pixels are found tile by tile where there is one tile to each.
    pub fn samples_by_tile(self) -> bool {
        self.by_tile && self.samples_edges() && !self.slabbed
    }

    /// Strips of four that the samples of a pixel take.
    fn strips(self) -> f64 {
        f64::from(self.samples.div_ceil(4))
    }

    /// How far a pixel's samples lie from its centre at most, px: [`crate::engine::plan::samples::places`].
    pub(super) fn sample_reach(self) -> f64 {
        // rounded up
        f64::from(self.samples - 1) / f64::from(2 * self.samples) * (1.0 + f64::from(f32::EPSILON))
    }

    /// The rays of samples in recheck arithmetic, and what they bind beside the pixels' own.
    fn sample_rays(self, bindings: &mut Vec<Binding>) -> &'static [Parts] {
        if self.rays == RaysKind::Pieces {
            bindings.push(uniform("places", "Places"));
            return &[SAMPLE_PLACES, snippets!("camera/pieces_sample.wgsl")];
        }
        bindings.push(read("rays_aside", "array<f32>"));
        &[snippets!("camera/field_sample.wgsl")]
    }
}

/// The pixels that hold an edge, tile by tile.
pub fn edges_by_tile(variant: Variant) -> Kernel {
    let bindings = vec![
        params(),
        read("pairs", "array<vec2<u32>>"),
        read("starts", "array<u32>"),
        read("ends", "array<u32>"),
        read("triangles", "array<vec4<u32>>"),
        read("vertices_hi", "array<f32>"),
        read("visibility", "array<vec2<u32>>"),
        read("nodes", "array<vec4<f32>>"),
        read("tile_start", "array<u32>"),
        read("cell_samples", "array<vec2<u32>>"),
        write("edge_of", "array<u32>"),
        write("samples", "array<vec2<u32>>"),
        write("touches", "array<vec4<u32>>"),
        write("blocks", "array<vec4<u32>>"),
        counters(),
    ];
    // of keys the ids alone are read
    let snippets = [PARAMS, ITEMS, INDEX, SLABS, VERTEX, TRIANGLE_ROW, REAL_F32, KEY, PAIR, BITS, WITHIN, COLUMN];
    let four = snippets!("samples/four.wgsl");
    let own = [DEPTH_BOUNDS, LANES, NODE_BY_LANES, CELL_SAMPLES, four, snippets!("edges_by_tile.wgsl")];
    let mut kernel = kernel("edges", bindings, &[&snippets[..], &own].concat());
    kernel.constants = sample_constants(variant);
    kernel.constants.push(("STRIPS", variant.strips()));
    kernel
}

/// What the samples of those pixels see, tile by tile.
pub fn sample_by_tile(variant: Variant) -> Kernel {
    let mut bindings = vec![
        params(),
        read("blocks", "array<vec4<u32>>"),
        read("touches", "array<vec4<u32>>"),
        read("triangles", "array<vec4<u32>>"),
        read("vertices_hi", "array<f32>"),
        read("vertices_lo", "array<f32>"),
        read("nodes", "array<vec4<f32>>"),
        write("samples", "array<vec2<u32>>"),
        write("recheck_items", "array<vec2<u32>>"),
        counters(),
        read("tile_start", "array<u32>"),
        read("cell_samples", "array<vec2<u32>>"),
    ];
    let rays: &[Parts] = match variant.rays {
        RaysKind::Field => {
            bindings.extend([read("rays_hi", "array<vec2<f32>>"), read("rays_lo", "array<vec2<f32>>")]);
            bindings.push(read("rays_aside", "array<vec2<f32>>"));
            &[snippets!("camera/field_column.wgsl"), snippets!("camera/field_strip.wgsl")]
        }
        _ => {
            bindings.extend([
                read("pieces", "array<Piece>"),
                read("cells", "array<Cell>"),
                uniform("places", "Places"),
            ]);
            &[snippets!("camera/piece.wgsl"), SAMPLE_PLACES, snippets!("camera/pieces_strip.wgsl")]
        }
    };
    let snippets = [PARAMS, ITEMS, INDEX, SLABS, VERTEX, variant.real(), TRIANGLE, BUNDLE, KEY, BITS, WITHIN];
    let own = [LANES, NODE_BY_LANES, COLUMN, CELL_SAMPLES];
    let hold =
        [snippets!("shared/waiting.wgsl"), snippets!("shared/pixel_test.wgsl"), snippets!("sample_by_tile.wgsl")];
    let mut kernel = kernel("sample", bindings, &[&snippets[..], &own, rays, &hold].concat());
    kernel.constants = variant.constants();
    kernel.constants.extend([("SAMPLES", f64::from(variant.samples)), ("STRIPS", variant.strips())]);
    kernel
}

/// What that leaves uncertain.
pub fn recheck_samples(variant: Variant) -> Kernel {
    let mut bindings = vec![
        params(),
        step(),
        read("pairs", "array<vec2<u32>>"),
        read("recheck_items", "array<vec2<u32>>"),
        read("triangles", "array<vec4<u32>>"),
        read("vertices_hi", "array<f32>"),
        read("vertices_lo", "array<f32>"),
        write("visibility", variant.keys()),
        counters(),
        read("tile_start", "array<u32>"),
        read("cells", "array<Cell>"),
        read("cell_samples", "array<vec2<u32>>"),
    ];
    bindings.extend(variant.rays());
    let snippets = [PARAMS, ITEMS, INDEX, SLABS, VERTEX, variant.real(), TRIANGLE, BUNDLE, KEY, PAIR, BITS];
    let own = [variant.merge(), MEETING, MEETING_OF_RAYS, SIDES, variant.camera(), CELL_SAMPLES, SAMPLE_HITS];
    let rays = variant.sample_rays(&mut bindings);
    let mut kernel = kernel(
        "recheck_samples",
        bindings,
        &[&snippets[..], &own, rays, &[snippets!("recheck_samples.wgsl")]].concat(),
    );
    kernel.constants = variant.constants();
    kernel.constants.extend([("SAMPLES", f64::from(variant.samples)), ("STRIPS", variant.strips())]);
    kernel
}

/// The pixels that hold an edge, pair by pair.
pub fn edges(variant: Variant) -> Kernel {
    let bindings = vec![
        params(),
        step(),
        read("pairs", "array<vec2<u32>>"),
        read("triangles", "array<vec4<u32>>"),
        read("vertices_hi", "array<f32>"),
        read("slot_of_id", "array<u32>"),
        read("visibility", "array<u32>"),
        read("nodes", "array<Node>"),
        read("tile_start", "array<u32>"),
        read("cells", "array<Cell>"),
        read("cell_samples", "array<vec2<u32>>"),
        write("edge_of", "array<atomic<u32>>"),
        write("samples", "array<u32>"),
        counters(),
    ];
    // of keys the ids and layers alone are read
    let snippets = [PARAMS, ITEMS, INDEX, SLABS, VERTEX, TRIANGLE_ROW, REAL_F32, KEY, PAIR, BITS, CELLS, WITHIN];
    let own = [DEPTH_BOUNDS, NEARNESS, CELL_SAMPLES, snippets!("edges.wgsl")];
    let mut kernel = kernel("edges", bindings, &[&snippets[..], &own].concat());
    kernel.constants = sample_constants(variant);
    kernel
}

/// What the samples of those pixels see, pair by pair.
pub fn sample(variant: Variant) -> Kernel {
    let mut bindings = vec![
        params(),
        step(),
        read("pairs", "array<vec2<u32>>"),
        read("triangles", "array<vec4<u32>>"),
        read("vertices_hi", "array<f32>"),
        read("vertices_lo", "array<f32>"),
        write("visibility", variant.keys()),
        counters(),
        read("nodes", "array<Node>"),
        read("tile_start", "array<u32>"),
        read("cells", "array<Cell>"),
        read("cell_samples", "array<vec2<u32>>"),
        read("edge_of", "array<u32>"),
    ];
    bindings.extend(variant.rays());
    let snippets = [PARAMS, ITEMS, INDEX, SLABS, VERTEX, variant.real(), TRIANGLE, BUNDLE, KEY, PAIR, BITS];
    let own = [WITHIN, variant.merge(), MEETING, MEETING_OF_RAYS, SIDES, variant.camera(), CELL_SAMPLES, SAMPLE_HITS];
    let rays = variant.sample_rays(&mut bindings);
    let all = [&snippets[..], &own, rays, &[snippets!("sample.wgsl")]].concat();
    let mut kernel = kernel("sample", bindings, &all);
    kernel.constants = sample_constants(variant);
    kernel
}

/// The colours of those pixels.
pub fn resolve(variant: Variant, planes: &[Channel]) -> Kernel {
    let mut bindings = vec![
        params(),
        uniform("shading", "Shading"),
        uniform("places", "Places"),
        read("triangles", "array<vec4<u32>>"),
        read("vertices_hi", "array<f32>"),
        read("slot_of_id", "array<u32>"),
        read("surfaces", "array<vec4<u32>>"),
        read("normals", "array<f32>"),
        read("materials", "array<Material>"),
        read("lights", "array<vec4<f32>>"),
        read("samples", "array<u32>"),
        write("planes", "array<u32>"),
        counters(),
        read("cell_samples", "array<vec2<u32>>"),
    ];
    bindings.extend(variant.pages());
    bindings.extend(variant.style_row());
    bindings.extend(variant.pixel_rays());
    let snippets = [PARAMS, ITEMS, INDEX, SLABS, VERTEX, variant.real(), TRIANGLE_ROW, BUNDLE, KEY, SHADING, SURFACE];
    let mut own = vec![variant.camera(), variant.images(), BITS, CELL_SAMPLES, SAMPLE_PLACES];
    own.push(variant.style());
    own.extend(variant.weights());
    own.push(if variant.analytic { snippets!("samples/areas.wgsl") } else { snippets!("samples/counted.wgsl") });
    own.extend(variant.light());
    own.extend(variant.pixel());
    if variant.rays == RaysKind::Pieces {
        own.push(snippets!("camera/pieces_sample_ray.wgsl"));
    } else {
        own.extend(variant.sample_rays(&mut bindings));
    }
    own.push(snippets!("resolve.wgsl"));
    let mut kernel = kernel("resolve", bindings, &[&snippets[..], &own].concat()).with_planes(planes);
    kernel.constants.extend(variant.constants());
    kernel.constants.push(("SAMPLES", f64::from(variant.samples)));
    kernel.constants.push(("NORMALS", variant.normals as u32 as f64));
    kernel
}

/// The constants of kernels that hold triangles against samples.
fn sample_constants(variant: Variant) -> Vec<(&'static str, f64)> {
    let samples = [("SAMPLES", f64::from(variant.samples)), ("SAMPLE_REACH", variant.sample_reach())];
    [variant.constants(), samples.to_vec()].concat()
}
