//! The plan: what a frame needs, worked out before the GPU is touched. Pure functions of camera, scene and limits.
//!
//! The image is split into bands of whole tile rows that fit the adapter's bindings. Every band has its tiles ([`tiles`]:
//! which pixels belong to which piece) and a tree of nodes over them ([`nodes`]: bounds on the rays of each square, affine
//! ones by [`fit`]). Where a field's rays jump inside a tile, it is split ([`cells`]). The tiles of a chain's layers, and of
//! the spans of curved rays, lie stacked as [`slabs`]. Of rays that a mirror or a lens reflects or refracts, the tree is made
//! on the GPU by the kernel `fit`, and level by level as here. To project points the image has another tree ([`beams`]) and a table of its
//! pieces ([`solve`]), and the image of a picture that is thrown onto surfaces a third one ([`pictures`]).

pub mod beams;
pub mod cells;
pub mod curves;
pub mod extent;
pub mod fit;
pub mod hierarchy;
pub mod nodes;
pub mod pages;
pub mod pictures;
pub mod samples;
pub mod slabs;
pub mod solve;
pub mod tiles;
pub mod turned;
pub mod variant;

use crate::camera::ray_order::is_reordered;
use crate::camera::{Camera, Pieces, Rays};
use crate::engine::in_view::InView;
use crate::engine::left_out::LeftOut;
use crate::geometry::mesh::Material;
use crate::gpu::device::AdapterFeatures;
use crate::gpu::kernels::{RaysKind, Variant, VolumeKind};
use crate::gpu::layout::{self, BRANCH};
use crate::image::frame::Channel;
use crate::scene::Scene;
use crate::scene::light::Light;
use crate::scene::volume::Mode;
use curves::{CurveTable, RayTable};
pub use extent::{SceneExtent, SceneShape};
use glam::{DVec2, DVec3};
use nodes::Nodes;
use slabs::Slabs;
use std::ops::Range;
use std::sync::Arc;
use tiles::{Tiler, Tiles};
use turned::{LensBand, Turned};

/// What there is in a scene, with the camera's optics.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct SceneContents {
    /// Triangles and spheres.
    pub triangles: usize,
    pub has_spheres: bool,
    pub has_capsules: bool,
    pub has_normals: bool,
    pub has_uvs: bool,
    /// Vertices have colours.
    pub has_colors: bool,
    /// Images lie on triangles.
    pub has_images: bool,
    /// Some of them are alpha masks.
    pub has_alpha_masks: bool,
    /// Some material is not matte.
    pub has_gloss: bool,
    /// Light comes from all around by an image of it.
    pub has_sky: bool,
    /// Some light has a colour or a position.
    pub has_positional_lights: bool,
    /// Shadow rays are traced.
    pub has_shadows: bool,
    /// Pictures are thrown onto surfaces.
    pub has_pictures: bool,
    /// Patterns, lines or strokes are drawn on surfaces.
    pub has_style: bool,
    /// Pixels around a pixel that decide the lines in it; 0: no lines are drawn between pixels.
    pub line_reach: u32,
    /// Time steps of each vertex; 1: nothing moves while the frame is taken.
    pub steps: u32,
    /// Rays pass through a volume.
    pub volume: Option<VolumeKind>,
    pub has_caustics: bool,
    /// Meshes stand in several places.
    pub has_instances: bool,
}

impl SceneContents {
    /// Lines are drawn between pixels.
    pub fn has_outlines(self) -> bool {
        self.line_reach > 0
    }

    pub fn of(scene: &Scene) -> SceneContents {
        let mesh = scene.mesh.base();
        SceneContents {
            has_sky: scene.sky.is_some(),
            has_positional_lights: !scene.lights.iter().all(Light::is_plain),
            has_shadows: scene.has_shadows(),
            has_pictures: !scene.projector_lights.is_empty(),
            has_style: scene.style.is_on_surfaces() || mesh.has_patterns(),
            line_reach: scene.style.line_reach(),
            steps: scene.step_count(),
            volume: scene.volume.as_ref().map(|volume| match (volume.mode, volume.is_lit) {
                (Mode::Maximum, _) => VolumeKind::Maximum,
                (Mode::Composite, true) => VolumeKind::Lit,
                (Mode::Composite, false) => VolumeKind::Plain,
            }),
            triangles: scene.mesh.triangle_count(),
            has_spheres: mesh.has_spheres(),
            has_capsules: mesh.has_capsules,
            has_normals: !mesh.normals.is_empty(),
            has_uvs: !mesh.corner_uvs.is_empty(),
            has_colors: !mesh.corner_colors.is_empty(),
            has_images: mesh.is_textured(),
            has_alpha_masks: mesh.has_alpha_masks(),
            has_gloss: mesh.materials.iter().any(Material::is_glossy),
            has_caustics: scene.caustics.is_some(),
            has_instances: scene.mesh.instances().is_some(),
        }
    }
}

/// What a caller wants of a frame.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Wanted {
    /// Planes to read back, in the order of [`Channel`].
    pub channels: Vec<Channel>,
    /// 8-bit sRGB colour.
    pub srgb8: bool,
    /// Count tested and kept fragments (slower).
    pub counting: bool,
    /// Samples per pixel. Color and coverage are averaged over them; all other channels use the center. [`crate::engine::Engine::render`] takes a
    /// frame for each where one frame does not render them all ([`super::combinations::Asked::is_separate`]).
    pub samples: u32,
    /// Weight triangles by their visible area in the pixel, not by the number of samples that see them.
    pub analytic: bool,
    /// Also read back the triangle id of every sample.
    pub sample_ids: bool,
    /// Frames that are averaged into one image; textures are filtered that much less in each.
    pub frames: u32,
    /// Only these rows of the image, the first a multiple of [`crate::camera::TILE`].
    pub rows: Option<Rows>,
    /// What follows the frame: gradients, and among them those of coverage. The frame is the same.
    pub gradients: bool,
    pub coverage_gradients: bool,
}

/// Rows of an image.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Rows {
    pub first: u32,
    pub count: u32,
}

impl Wanted {
    /// These planes, by pixel centres alone.
    pub fn of(channels: Vec<Channel>) -> Wanted {
        Wanted {
            channels,
            srgb8: false,
            counting: false,
            samples: 1,
            analytic: false,
            sample_ids: false,
            frames: 1,
            rows: None,
            gradients: false,
            coverage_gradients: false,
        }
    }

    /// Some colour is asked for.
    pub fn has_colour(&self) -> bool {
        self.srgb8 || self.channels.iter().any(|c| matches!(c, Channel::R | Channel::G | Channel::B))
    }

    /// Colours of surfaces are part of it.
    pub(crate) fn needs_appearance(&self) -> bool {
        let albedo = [Channel::AlbedoR, Channel::AlbedoG, Channel::AlbedoB];
        self.has_colour() || self.channels.iter().any(|c| albedo.contains(c))
    }

    /// Images on triangles, where they lie, or colours of vertices are part of it.
    fn is_textured(&self, of: SceneContents) -> bool {
        let any = |which: &[Channel]| self.channels.iter().any(|c| which.contains(c));
        of.has_alpha_masks
            || (of.has_images || of.has_pictures) && self.needs_appearance()
            || self.is_colored(of)
            || of.has_sky && self.has_colour()
            || of.has_uvs && any(&[Channel::TextureU, Channel::TextureV])
    }

    /// Colours of vertices are part of it.
    fn is_colored(&self, of: SceneContents) -> bool {
        of.has_colors && self.needs_appearance()
    }

    /// What a volume changes is part of it.
    pub(crate) fn needs_volume(&self) -> bool {
        self.has_colour() || self.channels.contains(&Channel::A)
    }

    /// Object or material ids are wanted.
    pub fn has_labels(&self) -> bool {
        self.channels.iter().any(|c| c.is_label())
    }

    /// Channels that follow from Z are wanted.
    pub fn has_normalised_depth(&self) -> bool {
        self.channels.iter().any(|c| c.is_of_z())
    }

    /// Samples of a pixel that something of this comes from.
    fn samples(&self) -> u32 {
        let of_samples = self.has_colour() || self.sample_ids || self.channels.contains(&Channel::A);
        if of_samples { self.samples } else { 1 }
    }
}

/// Rows of the image that are rendered together, and their tables.
#[derive(Debug, Clone)]
pub struct Band {
    /// First image row, a multiple of the tile size.
    pub row: u32,
    pub rows: u32,
    /// The rows that the band hands on. The others decide the lines in these.
    pub shown: Rows,
    pub tiles: Arc<Tiles>,
    /// Bounds on the rays. If the band has `turned`, they are in the viewer's frame, and the stage `aim` turns them.
    pub nodes: Arc<Nodes>,
    /// What every pixel's ray or curve is, where the camera has no affine pieces.
    pub rays: Option<RayTable>,
    /// The viewer's tables and its pose, from which the stage `aim` makes rays and bounds.
    pub turned: Option<Turned>,
    /// By what those of samples differ, where there are some: [`curves::sample_ray_deltas`].
    pub sample_ray_deltas: Vec<f32>,
    /// When each pixel sees the scene, if something moves.
    pub moments: Vec<u32>,
}

/// What one frame takes.
#[derive(Debug, Clone)]
pub struct Plan {
    pub variant: Variant,
    /// The parts of the scene that the kernels know of.
    pub in_view: InView,
    /// The contents of these parts.
    pub contents: SceneContents,
    /// The contents of the scene with all parts, and the variant for them.
    pub whole: (SceneContents, Variant),
    /// Pixels of a row.
    pub width: u32,
    pub slabs: Slabs,
    pub bands: Vec<Band>,
    /// Where samples lie about their pixel's centre, px; none where that is the only one.
    pub sample_offsets: Vec<DVec2>,
    /// The channels that `shade` writes: those wanted, and colour if `write` reads it.
    pub planes: Vec<Channel>,
    /// 8-bit sRGB colour is written.
    pub srgb8: bool,
    /// Bits of a visibility key that hold the triangle id.
    pub id_bits: u32,
    pub anchor: DVec3,
    pub origin: DVec3,
    /// Of the scene, see [`SceneExtent`].
    pub centre: DVec3,
    pub scene_size: f64,
    /// Time steps of each vertex.
    pub steps: u32,
    /// How wide images on triangles are filtered, in pixels.
    pub filter_width: f32,
    /// Why raster or trace, where the costs do not decide.
    pub method_why: &'static str,
    pub left_out: Vec<LeftOut>,
}

/// What frames are planned for.
#[derive(Clone, Copy)]
pub struct PlanTarget<'a> {
    pub has: AdapterFeatures,
    /// Bytes that a kernel sees at once.
    pub binding_limit: u64,
    /// The stage `aim` turns rays and bounds to a viewer's pose, instead of the host.
    pub aims: bool,
    /// An earlier plan and its camera; parts that do not depend on the pose are used again.
    pub last: Option<(&'a Plan, &'a Camera)>,
}

impl PlanTarget<'_> {
    /// The band of the earlier plan with these rows.
    fn last_band(&self, of: Rows) -> Option<&Band> {
        let (plan, _) = self.last?;
        plan.bands.iter().find(|band| (band.row, band.rows) == (of.first, of.count))
    }

    /// The camera's pieces, and the earlier plan's tiles for these rows, if the pieces of both cameras own the same pixels.
    fn known_tiles<'a>(
        &'a self,
        camera: &'a Camera,
        sample_offsets: &[DVec2],
        of: Rows,
    ) -> Option<(&'a Pieces, &'a Tiles)> {
        let (plan, last) = self.last?;
        let ([Rays::Pieces(pieces)], [Rays::Pieces(last_pieces)]) = (&camera.layers[..], &last.layers[..]) else {
            return None;
        };
        let size = |camera: &Camera| (camera.width, camera.height);
        let own_alike = size(camera) == size(last)
            && plan.slabs.count() == 1
            && plan.sample_offsets == sample_offsets
            && pieces.own_alike(last_pieces);
        self.last_band(of).filter(|_| own_alike).map(|band| (pieces, &*band.tiles))
    }
}

impl Plan {
    /// Plans frames of `camera` over a scene for the kernels of [`variant::variant`], with all rays.
    #[cfg(feature = "internals")]
    pub fn new(
        variant: Variant,
        camera: &Camera,
        contents: SceneContents,
        extent: SceneExtent,
        wanted: &Wanted,
        has: AdapterFeatures,
        binding_limit: u64,
    ) -> Plan {
        let target = PlanTarget { has, binding_limit, aims: false, last: None };
        Plan::on(target, variant, camera, contents, extent, wanted)
    }

    /// Plans frames for a target.
    pub fn on(
        target: PlanTarget,
        variant: Variant,
        camera: &Camera,
        contents: SceneContents,
        extent: SceneExtent,
        wanted: &Wanted,
    ) -> Plan {
        let slabs = Slabs::of(camera);
        let planes = planes(wanted, variant);
        let pixel_bytes = pixel_bytes(variant, &planes, slabs);
        let sample_offsets = match variant.samples_edges() {
            // the rasterizer says what its samples see at the pixel's centre
            true if variant.samples_at_centre() => vec![DVec2::ZERO; variant.samples() as usize],
            true => samples::sample_offsets(variant.samples()),
            false => Vec::new(),
        };
        let view = View { camera, slabs, extent, sample_offsets: &sample_offsets, target };
        let rows = wanted.rows.unwrap_or(Rows { first: 0, count: camera.height });
        let bands = bands(view, rows, contents.line_reach, pixel_bytes);
        let smooth = camera.optics.as_ref().map_or(0, |o| o.smooth_count());
        let id_bits = usize::BITS - (contents.triangles + smooth).saturating_sub(1).leading_zeros();
        let left_out = left_out(camera, slabs, &bands, &planes, wanted, contents, target.has);
        Plan {
            variant,
            in_view: InView::ALL,
            contents,
            whole: (contents, variant),
            width: camera.width,
            slabs,
            bands,
            sample_offsets,
            planes,
            srgb8: wanted.srgb8,
            id_bits: id_bits.max(1),
            anchor: extent.anchor,
            origin: extent.origin,
            centre: extent.centre,
            scene_size: extent.scene_size,
            steps: contents.steps.max(1),
            // so many boxes of this width tile the pixel
            filter_width: 1.0 / (wanted.frames.max(1) as f32).sqrt(),
            method_why: "",
            left_out,
        }
    }
}

/// The channels that `shade` writes.
fn planes(wanted: &Wanted, variant: Variant) -> Vec<Channel> {
    let mut planes: Vec<Channel> = wanted.channels.iter().copied().filter(|c| c.is_rendered()).collect();
    if wanted.srgb8 && !variant.extras.writes {
        planes.extend([Channel::R, Channel::G, Channel::B]);
    }
    planes.extend((wanted.sample_ids || wanted.has_labels()).then_some(Channel::TriangleId));
    planes.extend(wanted.has_normalised_depth().then_some(Channel::Z));
    planes.sort_unstable();
    planes.dedup();
    planes
}

/// Bytes that the widest table of a band has a pixel.
fn pixel_bytes(variant: Variant, planes: &[Channel], slabs: Slabs) -> u64 {
    let table_bytes = match variant.rays.kind {
        // an item of `paths`
        RaysKind::Pieces | RaysKind::Field { .. } if variant.rays.optics.is_some() => 32,
        RaysKind::Pieces => 0,
        RaysKind::Field { .. } => 24,
        RaysKind::Curves { degree } => 12 * (degree as u64 + 1) * slabs.layers as u64,
    };
    let sample_bytes = match variant.rays.kind {
        _ if !variant.samples_edges() => 0,
        RaysKind::Pieces => 8 * u64::from(variant.samples() + 1),
        RaysKind::Field { .. } | RaysKind::Curves { .. } => 24 * u64::from(variant.samples()),
    };
    // of 8 bytes each, and a quarter more for what is uncertain
    let item_bytes = 10 * variant.proven_a_pixel(slabs.layers as usize);
    (4 * planes.len() as u64).max(8).max(table_bytes).max(sample_bytes).max(item_bytes)
}

impl Plan {
    /// Whether the tables of another variant fit a binding in the bands of this plan.
    pub fn fits(&self, variant: Variant, wanted: &Wanted, binding_limit: u64) -> bool {
        let row_bytes = u64::from(self.width + 1) * pixel_bytes(variant, &planes(wanted, variant), self.slabs);
        u64::from(self.rows_max() + 1) * row_bytes <= binding_limit
    }

    /// The plan for kernels of another variant, which know of fewer parts of the scene.
    pub fn showing(self, in_view: InView, variant: Variant, contents: SceneContents, wanted: &Wanted) -> Plan {
        Plan { variant, in_view, contents, planes: planes(wanted, variant), steps: contents.steps.max(1), ..self }
    }

    /// The plan with the moment at which each pixel of the camera sees the scene, if things move while the frame is taken.
    pub fn at_its_moments(mut self, scene: &Scene, camera: &Camera) -> Plan {
        let Some(moments) = scene.moments(camera).filter(|_| self.variant.is_timed()) else { return self };
        let width = self.width as usize;
        for band in &mut self.bands {
            let own = band.row as usize * width..(band.row + band.rows) as usize * width;
            band.moments = moments[own].iter().map(|moment| moment.word()).collect();
        }
        self
    }

    /// Rows of pixels in all.
    pub fn rows(&self) -> u32 {
        self.bands.iter().map(|b| b.shown.count).sum()
    }

    /// Rows of pixels of the largest band.
    pub fn rows_max(&self) -> u32 {
        self.bands.iter().map(|b| b.rows).max().unwrap_or(0)
    }
}

/// The image, to be split into bands.
#[derive(Clone, Copy)]
struct View<'a> {
    camera: &'a Camera,
    slabs: Slabs,
    extent: SceneExtent,
    sample_offsets: &'a [DVec2],
    target: PlanTarget<'a>,
}

/// Splits rows of the image into bands whose every buffer fits a binding. The rows of a band that are `reach` pixels away, or fewer, decide
/// the lines in its rows.
fn bands(view: View, own: Rows, reach: u32, pixel_bytes: u64) -> Vec<Band> {
    let View { camera, slabs, target, .. } = view;
    let binding_limit = target.binding_limit;
    let tile = crate::camera::TILE;
    let around = reach.next_multiple_of(tile);
    let row_bytes = (camera.width as u64 + 1) * pixel_bytes;
    // one row more than the band: the ray table's
    let fit = (binding_limit / row_bytes).saturating_sub(1).min(u64::from(u32::MAX)) as u32 / tile * tile;
    let fit = fit.max(tile).min(TILE_ROWS_MAX / slabs.count() / BRANCH * BRANCH * tile);
    let is_one = own.around(around, camera.height).count <= fit;
    let rows = if is_one { own.count } else { fit.saturating_sub(2 * around).max(tile) };
    let mut todo: Vec<(u32, u32)> =
        (0..own.count).step_by(rows as usize).map(|r| (own.first + r, rows.min(own.count - r))).rev().collect();
    let mut bands = Vec::new();
    while let Some((row, rows)) = todo.pop() {
        let band = Band::new(view, Rows { first: row, count: rows }, around);
        let fits = band.tiles.start.len() <= TILES_MAX
            && band.tiles.cells.len() * size_of::<layout::Cell>() <= binding_limit as usize
            && size_of_val(band.tiles.cell_samples.as_slice()) <= binding_limit as usize
            && band.nodes.nodes.len() * size_of::<layout::Node>() <= binding_limit as usize
            && band.tiles.pieces.len() * size_of::<layout::Piece>() <= binding_limit as usize;
        if fits || rows <= tile {
            bands.push(band);
            continue;
        }
        let upper = (rows / 2).next_multiple_of(tile);
        todo.push((row + upper, rows - upper));
        todo.push((row, upper));
    }
    bands
}

/// Rows of tiles that a node's address can name: 14 bits.
const TILE_ROWS_MAX: u32 = 1 << 14;

/// Tiles that a pair can name: 24 bits.
const TILES_MAX: usize = 1 << 24;

impl Rows {
    /// With so many rows before and behind, of an image of this height.
    pub fn around(self, more: u32, height: u32) -> Rows {
        let first = self.first.saturating_sub(more);
        Rows { first, count: (self.first + self.count).saturating_add(more).min(height) - first }
    }
}

impl Band {
    /// The places of the pixels that the band shows, in the `k`-th of its planes.
    pub fn shown_in_plane(&self, k: usize, width: u32) -> Range<usize> {
        let pixels = |rows: u32| rows as usize * width as usize;
        let first = k * pixels(self.rows) + pixels(self.shown.first - self.row);
        first..first + pixels(self.shown.count)
    }

    /// The band that shows some rows, with the rows around it that decide the lines in these.
    fn new(view: View, shown: Rows, around: u32) -> Band {
        let View { camera, slabs, extent, sample_offsets, target } = view;
        let anchor = extent.anchor;
        let of = shown.around(around, camera.height);
        let Rows { first: row, count: rows } = of;
        let measure = nodes::WidthMeasure {
            distance: extent.scene_size,
            t_range: camera.t_range,
            incoherent: is_reordered(camera),
            scene_size: extent.scene_size,
        };
        let curves = match slabs::kind(camera) {
            RaysKind::Curves { degree } => Some(CurveTable::new(camera, degree, row, rows)),
            _ => None,
        };
        let tiler = Tiler { camera, slabs, curves: curves.as_ref(), sample_offsets, anchor, row, rows };
        if target.aims {
            let last = target.last_band(of).and_then(|band| band.turned.as_ref());
            if let Some(turned) = Turned::of(view, of, measure, last) {
                let LensBand { tiles, nodes, .. } = &*turned.lens;
                let tiles = match camera.layers.as_slice() {
                    [Rays::Pieces(pieces)] => Arc::new(tiler.moved(pieces, tiles)),
                    _ => tiles.clone(),
                };
                let nodes = nodes.clone();
                return Band {
                    row,
                    rows,
                    shown,
                    tiles,
                    nodes,
                    rays: None,
                    turned: Some(turned),
                    sample_ray_deltas: Vec::new(),
                    moments: Vec::new(),
                };
            }
        }
        let (tiles, nodes) = tiler.tiles_and_nodes(target.known_tiles(camera, sample_offsets, of), measure);
        let rays = match (&curves, camera.layers.as_slice()) {
            (Some(table), _) => Some(table.rays(anchor)),
            (None, [Rays::Field(field)]) => Some(RayTable::of_field(field, anchor, row, rows)),
            _ => None,
        };
        let sample_ray_deltas = match camera.layers.as_slice() {
            [Rays::Field(field)] if !sample_offsets.is_empty() => {
                curves::sample_ray_deltas(field, sample_offsets, anchor, row, rows)
            }
            _ => Vec::new(),
        };
        Band { row, rows, shown, tiles, nodes, rays, turned: None, sample_ray_deltas, moments: Vec::new() }
    }
}

fn left_out(
    camera: &Camera,
    slabs: Slabs,
    bands: &[Band],
    planes: &[Channel],
    wanted: &Wanted,
    contents: SceneContents,
    has: AdapterFeatures,
) -> Vec<LeftOut> {
    let rays = slabs::kind(camera);
    let is_curved = camera.is_curved();
    let smooth = camera.optics.as_ref().map(|optics| optics.smooth_count());
    let is_absent = |c: &Channel| !planes.contains(c) && !wanted.channels.contains(c);
    let absent: Vec<Channel> = Channel::every().filter(is_absent).collect();
    let is_textured = wanted.is_textured(contents);
    let has_images = contents.has_images;
    let has_volume = contents.volume.is_some();
    let rows = [
        (rays == RaysKind::Pieces, LeftOut::RayTable),
        (rays != RaysKind::Pieces, LeftOut::EdgeConics { is_curved: rays.is_curved() }),
        (is_curved, LeftOut::Recheck),
        (!is_curved, LeftOut::Curves),
        (!planes.contains(&Channel::Certified), LeftOut::Certify),
        (slabs.count() == 1, LeftOut::Slabs),
        (bands.iter().all(|b| b.nodes.exact), LeftOut::RayResiduals),
        (!bands.iter().any(|b| b.nodes.discontinuous), LeftOut::BoundsPerCell),
        (smooth.is_none(), LeftOut::Bounces),
        (smooth == Some(0), LeftOut::Meet),
        (bands.len() == 1, LeftOut::Bands),
        (!absent.is_empty(), LeftOut::Channels(absent)),
        (!contents.has_spheres, LeftOut::Spheres),
        (!contents.has_normals, LeftOut::SmoothNormals),
        (!is_textured, LeftOut::Textures { has_images }),
        (contents.has_colors && !wanted.is_colored(contents), LeftOut::VertexColors),
        (!contents.has_alpha_masks, LeftOut::AlphaMasks),
        (!contents.has_sky, LeftOut::Sky),
        (!contents.has_shadows, LeftOut::Shadows),
        (!contents.has_pictures, LeftOut::Pictures),
        (!contents.has_style, LeftOut::SurfaceStyles),
        (!contents.has_outlines(), LeftOut::Outline),
        (!contents.has_gloss, LeftOut::Gloss),
        (wanted.samples() == 1, LeftOut::Samples),
        (wanted.samples() != 1 && !wanted.analytic, LeftOut::Areas),
        (!wanted.srgb8, LeftOut::Write),
        (!(has_volume && wanted.needs_volume()), LeftOut::Volume { has_volume }),
        (contents.steps <= 1, LeftOut::TimeSteps),
        (!wanted.counting, LeftOut::FragmentCounters),
        (!has.f64, LeftOut::AdapterF64 { failed_test: has.f64_is_wrong }),
        (has.atomics64, LeftOut::SecondDepthDispatch),
    ];
    let rows = rows.into_iter().filter_map(|(is_left_out, row)| is_left_out.then_some(row));
    rows.chain(LeftOut::of_rays(&camera.notes)).collect()
}
