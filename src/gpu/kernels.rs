//! The one table of kernels: from which snippets each is joined, and which buffers it binds.
//!
//! A kernel's module is its bindings, generated from this table, and the plain concatenation of its snippets. Each snippet names
//! at its top what it provides, and what it needs of the others and of the bindings. Variants swap a snippet that provides the same
//! functions, or set an `override` constant.

use crate::image::frame::Channel;
use std::fmt::Write;

/// How the kernels hold a camera's rays.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RaysKind {
    /// Affine pieces.
    Pieces,
    /// A ray a pixel.
    Field,
    /// A Bezier curve a pixel and layer, all of this degree.
    Curves { degree: u32 },
}

/// What the kernels know of lights.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LightsKind {
    /// Ways that white light travels everywhere.
    Plain,
    /// Colours too, and places.
    Placed,
    /// And what is in the way of light.
    Hidden,
}

/// Which variants of the kernels a scene and an adapter need.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Variant {
    /// Rechecks, depths and shading in f64; else all in f32.
    pub f64: bool,
    /// One 64-bit atomic a fragment; without it two dispatches of 32-bit ones.
    pub atomics64: bool,
    /// `raster` goes tile by tile, not pair by pair.
    pub by_tile: bool,
    pub rays: RaysKind,
    /// The rays are incoherent even after sorting: they are tested one by one against boxes.
    pub scattered: bool,
    /// The tiles of several layers, or of several spans of t, are stacked below each other.
    pub slabbed: bool,
    /// Count tested and kept fragments.
    pub counting: bool,
    /// `cull` leaves out what a node's rays do not meet.
    pub culling: bool,
    /// Bounds in f32 prove nothing: all is left to `recheck`.
    pub all_uncertain: bool,
    /// The scene has normals of its own.
    pub normals: bool,
    /// Images lie on triangles, or their texture coordinates are asked for.
    pub textured: bool,
    /// These images cut holes into triangles.
    pub masked: bool,
    /// Some material is not matte.
    pub glossy: bool,
    /// Light comes from all around by an image of it.
    pub sky: bool,
    pub lights: LightsKind,
    /// Patterns, lines or strokes are drawn on surfaces.
    pub styled: bool,
    /// Lines are drawn between pixels.
    pub outlined: bool,
    /// A mirror or a lens turns rays.
    pub optics: Option<OpticsKind>,
    /// The rays are those that it turned, and start on it.
    pub bounced: bool,
    /// Samples of a pixel that holds an edge, 32 at most; 1: its centre alone, and no pixel is looked at for edges.
    pub samples: u32,
    /// Of such a pixel triangles have shares by their areas, not by their samples' number.
    pub analytic: bool,
}

/// How a kernel binds a buffer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Access {
    Uniform,
    Read,
    Write,
    /// A texture, whose texels are read one by one.
    Texels,
    /// A texture, whose texels are written one by one.
    WriteTexels,
}

/// One buffer of a kernel: its name is the buffer's name everywhere.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Binding {
    pub name: &'static str,
    pub access: Access,
    pub wgsl_type: &'static str,
}

/// One compute kernel, ready to compile.
#[derive(Debug, Clone)]
pub struct Kernel {
    /// The stage's name, the entry point's and the file's.
    pub name: &'static str,
    pub bindings: Vec<Binding>,
    pub parts: Vec<&'static Snippet>,
    /// A line before all others.
    pub enables: &'static str,
    pub constants: Vec<(&'static str, f64)>,
    /// It uses f64, and is lowered to 32-bit words where an adapter has none.
    pub f64: bool,
}

/// A part of kernels: a file under `wgsl/`.
#[derive(Debug, PartialEq, Eq)]
pub struct Snippet {
    /// The file's path under `wgsl/`.
    pub name: &'static str,
    pub text: &'static str,
}

/// Snippets in the order in which they are joined.
pub type Parts = &'static [&'static Snippet];

/// [`Parts`] by their names.
macro_rules! snippets {
    ($($name:literal),+) => {{
        use $crate::gpu::kernels::{Parts, Snippet};
        const PARTS: Parts = &[
            $(&Snippet { name: $name, text: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/wgsl/", $name)) }),+
        ];
        PARTS
    }};
}
pub(crate) use snippets;

mod optics;
mod samples;
mod surfaces;
pub use optics::{OpticsKind, bounce, fit, meet, paste};
pub use samples::{edges, edges_by_tile, recheck_samples, resolve, sample, sample_by_tile};
use surfaces::plane_constants;
pub use surfaces::{mip, outline, shade, write_srgb};

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

impl Variant {
    /// A scene without normals, images, lines or samples, through pieces, on an adapter without f64 and 64-bit atomics.
    pub const PLAIN: Variant = Variant {
        f64: false,
        atomics64: false,
        by_tile: false,
        rays: RaysKind::Pieces,
        scattered: false,
        slabbed: false,
        counting: false,
        culling: true,
        all_uncertain: false,
        normals: false,
        textured: false,
        masked: false,
        glossy: false,
        sky: false,
        lights: LightsKind::Plain,
        styled: false,
        outlined: false,
        optics: None,
        bounced: false,
        samples: 1,
        analytic: false,
    };

    /// Every variant that some camera needs on an adapter with these abilities.
    pub fn every(f64: bool, atomics64: bool) -> Vec<Variant> {
        let mut list = Vec::new();
        for more in [false, true] {
            let [counting, normals, textured, glossy, sky] = [more; 5];
            let [styled, outlined] = [more; 2];
            let lights = if more { LightsKind::Hidden } else { LightsKind::Plain };
            let of_camera = Variant {
                f64,
                atomics64,
                counting,
                normals,
                textured,
                glossy,
                sky,
                lights,
                styled,
                outlined,
                ..Variant::PLAIN
            };
            let variant = |rays, slabbed, optics| {
                let scattered = more && rays == RaysKind::Field;
                Variant { rays, scattered, slabbed, optics, ..of_camera }
            };
            let curves = [1, 2, 3].map(|degree| RaysKind::Curves { degree });
            for rays in [RaysKind::Pieces, RaysKind::Field].into_iter().chain(curves) {
                list.extend([false, true].map(|slabbed| variant(rays, slabbed, None)));
            }
            for (rays, slabbed) in [(RaysKind::Pieces, false), (RaysKind::Pieces, true), (RaysKind::Field, false)] {
                list.push(Variant { samples: 4, analytic: more, ..variant(rays, slabbed, None) });
            }
            if textured {
                let kinds = [RaysKind::Pieces, RaysKind::Field, RaysKind::Curves { degree: 3 }];
                list.extend(kinds.map(|rays| Variant { masked: true, ..variant(rays, false, None) }));
                let slabbed = Variant { masked: true, ..variant(RaysKind::Pieces, true, None) };
                let seen = Variant { masked: true, ..variant(RaysKind::Pieces, false, Some(OpticsKind::Facets)) };
                list.extend([slabbed, seen, seen.after_bounce()]);
            }
            list.push(Variant { lights: LightsKind::Placed, ..variant(RaysKind::Pieces, false, None) });
            for optics in OpticsKind::ALL {
                let seen = [RaysKind::Pieces, RaysKind::Field].map(|rays| variant(rays, false, Some(optics)));
                list.extend(seen);
                list.extend(seen[0].bounces_rays().then(|| seen[0].after_bounce()));
            }
        }
        list
    }

    /// Bounds in f32 prove most of what straight rays meet; where a curve meets a triangle is found in recheck arithmetic.
    pub fn rechecks(self) -> bool {
        !matches!(self.rays, RaysKind::Curves { .. })
    }

    /// The same, with `raster` tile by tile where there is that.
    pub fn with_tiles(self) -> Variant {
        let by_tile = self.f64 && self.atomics64 && !self.all_uncertain && self.rechecks() && !self.masked;
        Variant { by_tile, ..self }
    }

    pub(crate) fn real(self) -> Parts {
        if self.f64 { REAL_F64 } else { REAL_F32 }
    }

    fn merge(self) -> Parts {
        if self.atomics64 { snippets!("shared/merge_u64.wgsl") } else { snippets!("shared/merge_u32.wgsl") }
    }

    /// The type of a buffer of visibility keys that are merged.
    fn keys(self) -> &'static str {
        if self.atomics64 { "array<atomic<u64>>" } else { "array<atomic<u32>>" }
    }

    fn camera(self) -> Parts {
        match self.rays {
            RaysKind::Pieces => snippets!("camera/piece.wgsl", "camera/pieces.wgsl"),
            RaysKind::Field => snippets!("camera/field_rays.wgsl", "camera/field.wgsl"),
            RaysKind::Curves { .. } => snippets!("camera/curves.wgsl"),
        }
    }

    /// The camera's rays pixel by pixel, after they were found by tiles and cells.
    fn pixel(self) -> &'static [Parts] {
        match self.rays {
            RaysKind::Pieces => &[CELLS, snippets!("camera/pieces_pixel.wgsl")],
            RaysKind::Field => &[snippets!("camera/field_pixel.wgsl")],
            RaysKind::Curves { .. } => &[CELLS, snippets!("camera/curves_pixel.wgsl")],
        }
    }

    fn coverage(self) -> &'static [Parts] {
        match self.rays {
            RaysKind::Pieces => &[MEETING_OF_RAYS, snippets!("camera/pieces_coverage.wgsl")],
            RaysKind::Field => &[MEETING_OF_RAYS, snippets!("camera/field_coverage.wgsl")],
            RaysKind::Curves { .. } => {
                &[snippets!("camera/curves_coverage.wgsl"), snippets!("camera/curves_meeting.wgsl")]
            }
        }
    }

    fn proof(self) -> &'static [Parts] {
        const STRAIGHT: Parts = snippets!("shared/perturb.wgsl", "camera/straight_proof.wgsl");
        match self.rays {
            RaysKind::Pieces => &[STRAIGHT, snippets!("camera/pieces_proof.wgsl")],
            RaysKind::Field => &[STRAIGHT, snippets!("camera/field_proof.wgsl")],
            RaysKind::Curves { .. } => &[snippets!("camera/curves_proof.wgsl")],
        }
    }

    /// The buffers with which rays are found pixel by pixel.
    pub(crate) fn pixel_rays(self) -> Vec<Binding> {
        let mut list = self.rays();
        if self.rays != RaysKind::Field {
            list.extend([read("tile_start", "array<u32>"), read("cells", "array<Cell>")]);
        }
        list
    }

    /// The snippets with which rays are found pixel by pixel.
    pub(crate) fn pixel_snippets(self) -> Vec<Parts> {
        [&[self.real(), BUNDLE, self.camera()][..], self.pixel()].concat()
    }

    /// Tests of a tile's rays against a box.
    fn tile_rays(self) -> Parts {
        match self.scattered {
            true => snippets!("camera/field_rays.wgsl", "shared/rays_scattered.wgsl"),
            false => snippets!("shared/rays_coherent.wgsl"),
        }
    }

    /// Tests of an item's rays against a box.
    fn item_rays(self) -> Parts {
        match (self.scattered && self.culling, self.by_tile) {
            (true, true) => snippets!(
                "camera/field_rays.wgsl",
                "shared/rays_scattered.wgsl",
                "shared/lanes.wgsl",
                "shared/items_scattered_by_lanes.wgsl"
            ),
            (true, false) => {
                snippets!("camera/field_rays.wgsl", "shared/rays_scattered.wgsl", "shared/items_scattered.wgsl")
            }
            (false, _) => snippets!("shared/items_coherent.wgsl"),
        }
    }

    /// The binding of those tests.
    fn scattered_rays(self, asks: bool) -> Option<Binding> {
        (self.scattered && asks).then(|| read("rays_hi", "array<f32>"))
    }

    /// How a kernel sees a list of structs: as it is, or as rows that the lanes of a subgroup load together.
    fn rows(self, list: &'static str) -> &'static str {
        if self.by_tile { "array<vec4<f32>>" } else { list }
    }

    /// How a kernel loads the node of its item.
    fn item_node(self) -> Parts {
        if self.by_tile { NODE_BY_LANES } else { snippets!("shared/node_rows.wgsl") }
    }

    /// The buffers that hold the camera's rays.
    fn rays(self) -> Vec<Binding> {
        match self.rays {
            RaysKind::Pieces => vec![read("pieces", "array<Piece>")],
            RaysKind::Field | RaysKind::Curves { .. } => {
                vec![read("rays_hi", "array<f32>"), read("rays_lo", "array<f32>")]
            }
        }
    }

    /// The constants of kernels that follow the camera's rays.
    pub(crate) fn constants(self) -> Vec<(&'static str, f64)> {
        let mut constants = vec![("SLABBED", self.slabbed as u32 as f64)];
        if let RaysKind::Curves { degree } = self.rays {
            constants.push(("DEGREE", degree as f64));
        }
        constants
    }
}

pub(crate) fn uniform(name: &'static str, wgsl_type: &'static str) -> Binding {
    Binding { name, access: Access::Uniform, wgsl_type }
}

pub(crate) fn read(name: &'static str, wgsl_type: &'static str) -> Binding {
    Binding { name, access: Access::Read, wgsl_type }
}

pub(crate) fn write(name: &'static str, wgsl_type: &'static str) -> Binding {
    Binding { name, access: Access::Write, wgsl_type }
}

/// Named and bound like buffers.
pub(crate) fn texture(name: &'static str, wgsl_type: &'static str) -> Binding {
    Binding { name, access: Access::Texels, wgsl_type }
}

pub(crate) fn write_texture(name: &'static str, wgsl_type: &'static str) -> Binding {
    Binding { name, access: Access::WriteTexels, wgsl_type }
}

pub(crate) fn kernel(name: &'static str, bindings: Vec<Binding>, parts: &[Parts]) -> Kernel {
    let parts = parts.concat();
    let f64 = parts.iter().any(|p| p.name == REAL_F64[0].name);
    Kernel { name, bindings, parts, enables: "", constants: Vec::new(), f64 }
}

impl Kernel {
    /// What precedes the snippets.
    fn head(&self) -> String {
        let mut head = self.enables.to_string();
        for (k, b) in self.bindings.iter().enumerate() {
            let space = match b.access {
                Access::Uniform => "<uniform>",
                Access::Read => "<storage, read>",
                Access::Write => "<storage, read_write>",
                Access::Texels | Access::WriteTexels => "",
            };
            // writing to a String cannot fail
            let _ = writeln!(head, "@group(0) @binding({k}) var{space} {}: {};", b.name, b.wgsl_type);
        }
        head
    }

    /// What is compiled: the bindings, then the snippets.
    pub fn source(&self) -> String {
        self.head() + &self.parts.iter().map(|p| p.text).collect::<String>()
    }

    /// The same, each snippet below a line that names it.
    pub fn labelled_source(&self) -> String {
        let part = |p: &&Snippet| format!("// {}:1\n{}", p.name, p.text);
        self.head() + &self.parts.iter().map(part).collect::<String>()
    }

    /// The snippet that holds a line of [`Kernel::source`], and the line's number there, both from 1. The bindings come before all snippets.
    pub fn place(&self, line: usize) -> (&'static str, usize) {
        let mut before = self.head().lines().count();
        if line <= before {
            return (BINDINGS, line);
        }
        for part in &self.parts {
            let lines = part.text.lines().count();
            if line <= before + lines {
                return (part.name, line - before);
            }
            before += lines;
        }
        (self.name, line)
    }
}

/// Stands for a snippet's name in front of the first one.
const BINDINGS: &str = "bindings";

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
    kernel.constants.push(("ASIDE", variant.aside()));
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
    let mut kernel = kernel("certify", bindings, &all);
    kernel.constants = variant.constants();
    let plane = planes.iter().position(|c| *c == Channel::Certified);
    kernel.constants.extend(plane.map(|k| ("PLANE_CERTIFIED", k as f64)));
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
    let mut kernel = kernel("gather", bindings, &[&snippets[..], seen].concat());
    kernel.constants = [vec![("SLABBED", variant.slabbed as u32 as f64)], plane_constants(planes)].concat();
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
