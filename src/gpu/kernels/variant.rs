//! Which kernels a scene, a camera and an adapter need.

mod appearance;
#[cfg(feature = "internals")]
mod every;
mod extras;
mod implementations;
mod path;
mod rays;
pub use appearance::{Appearance, LightsKind, MaterialsKind, SurfaceKind, Textures};
pub use extras::{EdgeSamples, Extras, PrimitivesKind, SampleMeasure, VerticesKind, VolumeKind};
pub use path::{AdapterPath, Arithmetic, Method, RasterPath, TileDepths, TilePath, Visibility};
pub use rays::{OpticsModel, RayModel, RaysKind};

use super::optics::OpticsKind;

/// Which variant of the kernels a frame takes. The default one is for a plain scene through pieces, pair by pair.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Variant {
    pub path: AdapterPath,
    pub rays: RayModel,
    pub appearance: Appearance,
    pub extras: Extras,
}

impl Variant {
    /// The variant after a change.
    #[cfg(feature = "internals")]
    pub fn with(mut self, change: impl FnOnce(&mut Variant)) -> Variant {
        change(&mut self);
        self
    }

    /// Raster goes tile by tile where it can: its bounds in f32 must prove something, and no alpha mask cut holes.
    pub fn with_tiles(mut self, tiles: TilePath) -> Variant {
        if self.path.arithmetic == Arithmetic::Rechecked && self.rechecks() && !self.is_masked() {
            self.path.visibility = self.path.visibility.with_raster(|_| RasterPath::ByTile(tiles));
        }
        self
    }

    /// The stage `small` draws small triangles where it can. Stages that find samples or proofs need all pairs, so it does not go with them.
    pub fn with_small(mut self) -> Variant {
        let is_plain = self.rays.kind == RaysKind::Pieces && !self.rays.slabbed && !self.samples_edges();
        if is_plain && self.extras.culling {
            self.path.visibility = self.path.visibility.with_raster(|raster| raster.with_small(true));
        }
        self
    }

    /// For the rays of the next bounce: a few rays, each with a direction of its own.
    pub fn after_bounce(mut self) -> Variant {
        self.path.visibility = match self.path.visibility {
            Visibility::Raster(raster) => Visibility::Raster(raster.with_small(false)),
            Visibility::Auto(_) | Visibility::Trace => Visibility::Trace,
        };
        let optics = self.rays.optics.map(|optics| OpticsModel { bounced: true, ..optics });
        self.rays = RayModel { kind: RaysKind::Field { incoherent: false }, slabbed: false, optics };
        self
    }

    /// Kernels compute with f64, in 32-bit words where the adapter has none.
    pub fn f64(self) -> bool {
        self.path.arithmetic != Arithmetic::Single
    }

    pub fn method(self) -> Method {
        self.path.visibility.method()
    }

    /// The stages from cull to raster are there.
    pub fn rasters(self) -> bool {
        self.method() != Method::Trace
    }

    /// The stage trace is there.
    pub fn traces(self) -> bool {
        self.method() != Method::Raster
    }

    pub fn tiles(self) -> Option<TilePath> {
        self.path.visibility.tiles()
    }

    pub fn by_tile(self) -> bool {
        self.tiles().is_some()
    }

    /// The stage `small` draws the triangles of few pixels.
    pub fn draws_small(self) -> bool {
        self.tiles().is_some_and(|tiles| tiles.depths == TileDepths::Exact { small: true })
    }

    /// The lanes of a tile load together numbers that all of them need. So on software adapters, whose subgroups have no more threads
    /// than a tile has columns: each thread that loads a number takes time there.
    pub fn loads_by_lanes(self) -> bool {
        self.tiles().is_some_and(|tiles| !tiles.wide)
    }

    /// Raster bounds t in f32, and merges no key.
    pub fn bounds_t_in_raster(self) -> bool {
        self.tiles().is_some_and(|tiles| tiles.depths == TileDepths::Bounded)
    }

    /// Raster by tile finds each t in f64.
    fn has_exact_tiles(self) -> bool {
        self.by_tile() && !self.bounds_t_in_raster()
    }

    /// Bounds in f32 prove most coverage tests of straight rays. A curve meets a triangle in recheck arithmetic.
    pub fn rechecks(self) -> bool {
        !self.rays.kind.is_curved()
    }

    /// Triangles of a pixel that are left to recheck, proven to be nearest: by trace one, and by raster where it bounds t one a layer.
    pub fn proven_a_pixel(self, layers: usize) -> u64 {
        match self {
            _ if self.bounds_t_in_raster() => layers as u64,
            _ => u64::from(self.rechecks() && self.traces()),
        }
    }

    /// Neither raster nor trace merges a key.
    pub fn leaves_all_to_recheck(self) -> bool {
        self.rechecks() && (self.method() == Method::Trace || self.bounds_t_in_raster())
    }

    pub fn surfaces(self) -> SurfaceKind {
        match self.appearance.textures {
            None => SurfaceKind::Plain,
            Some(Textures { colored: false, .. }) => SurfaceKind::Mapped,
            Some(Textures { colored: true, .. }) => SurfaceKind::Colored,
        }
    }

    /// Some surfaces are alpha masks.
    pub fn is_masked(self) -> bool {
        self.appearance.textures.is_some_and(|textures| textures.masked)
    }

    pub fn optics(self) -> Option<OpticsKind> {
        self.rays.optics.map(|optics| optics.kind)
    }

    /// The rays have bounced at a mirror or a lens, and start there.
    pub fn is_bounced(self) -> bool {
        self.rays.optics.is_some_and(|optics| optics.bounced)
    }

    /// Rays are bounced after this dispatch.
    pub fn bounces_rays(self) -> bool {
        self.optics().is_some_and(|kind| kind != OpticsKind::Atlas)
    }

    /// A smooth surface is intersected.
    pub fn meets(self) -> bool {
        self.optics().is_some_and(OpticsKind::is_smooth)
    }

    /// There are spheres or capsules beside triangles.
    pub fn has_round(self) -> bool {
        self.extras.primitives != PrimitivesKind::Triangles
    }

    pub fn is_timed(self) -> bool {
        self.extras.vertices == VerticesKind::Timed
    }

    pub fn is_instanced(self) -> bool {
        self.extras.vertices == VerticesKind::Placed
    }

    /// Samples of a pixel at an edge; 1: its centre alone, and no pixel is searched for edges.
    pub fn samples(self) -> u32 {
        self.extras.samples.map_or(1, |samples| samples.count)
    }

    pub fn samples_edges(self) -> bool {
        self.extras.samples.is_some()
    }

    /// A rival's rasterizer takes the samples, and shades at the pixel's centre.
    pub fn samples_at_centre(self) -> bool {
        self.extras.samples.is_some_and(|samples| samples.measure == SampleMeasure::AtCentre)
    }

    /// The edges of pixels are found tile by tile where there is one tile to each.
    pub fn samples_by_tile(self) -> bool {
        self.has_exact_tiles() && self.samples_edges() && !self.rays.slabbed
    }

    /// Largest distance of a sample from its pixel's centre, px.
    pub fn sample_reach(self) -> f64 {
        // rounded up
        f64::from(self.samples() - 1) / f64::from(2 * self.samples()) * (1.0 + f64::from(f32::EPSILON))
    }
}
