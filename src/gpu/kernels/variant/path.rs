//! The path of a frame on an adapter: its arithmetic, and the stages that find triangles.

/// How visibility is computed on this adapter.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct AdapterPath {
    pub arithmetic: Arithmetic,
    /// One 64-bit atomic a fragment; without it two dispatches of 32-bit ones.
    pub atomics64: bool,
    pub visibility: Visibility,
}

/// Arithmetic used for coverage tests.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Arithmetic {
    /// f32 where its bounds prove them, and recheck arithmetic elsewhere.
    #[default]
    Rechecked,
    /// f32 alone, depths and shading too.
    Single,
    /// Recheck arithmetic everywhere.
    Double,
}

/// The stages that find the triangle of each pixel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Visibility {
    /// The stages from cull to raster.
    Raster(RasterPath),
    /// The stage trace.
    Trace,
    /// Both; the costs that the stage choose counts decide.
    Auto(RasterPath),
}

/// How the stage raster goes through pairs of triangles and tiles.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum RasterPath {
    #[default]
    ByPair,
    ByTile(TilePath),
}

/// How raster goes tile by tile, a subgroup a tile.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TilePath {
    /// Subgroups have more threads than a tile has columns: those of a tile are a part of one.
    pub wide: bool,
    pub depths: TileDepths,
}

/// How raster by tile compares depths.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TileDepths {
    /// Bounds in f32, as in trace; recheck finds t once a pixel. So on GPUs.
    Bounded,
    /// Each t in f64. So on software adapters, which may draw the triangles of few pixels in the stage `small`: bin pairs the others with tiles.
    Exact { small: bool },
}

/// How the triangle of each pixel is found. All find the same triangles, except where two depths are equal to within the rounding of f64.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Method {
    /// The one that costs less.
    #[default]
    Auto,
    /// Triangles are projected: the stages from cull to raster.
    Raster,
    /// Rays are traced through a bounding volume hierarchy: the stage trace.
    Trace,
}

impl Default for Visibility {
    fn default() -> Visibility {
        Visibility::Raster(RasterPath::ByPair)
    }
}

impl Visibility {
    /// The stages of this method; raster goes pair by pair.
    pub fn by_pair(method: Method) -> Visibility {
        match method {
            Method::Auto => Visibility::Auto(RasterPath::ByPair),
            Method::Raster => Visibility::Raster(RasterPath::ByPair),
            Method::Trace => Visibility::Trace,
        }
    }

    pub fn method(self) -> Method {
        match self {
            Visibility::Auto(_) => Method::Auto,
            Visibility::Raster(_) => Method::Raster,
            Visibility::Trace => Method::Trace,
        }
    }

    pub fn tiles(self) -> Option<TilePath> {
        if let Visibility::Auto(RasterPath::ByTile(tiles)) | Visibility::Raster(RasterPath::ByTile(tiles)) = self {
            Some(tiles)
        } else {
            None
        }
    }

    /// With another path of raster, if raster is there.
    pub fn with_raster(self, change: impl Fn(RasterPath) -> RasterPath) -> Visibility {
        match self {
            Visibility::Auto(raster) => Visibility::Auto(change(raster)),
            Visibility::Raster(raster) => Visibility::Raster(change(raster)),
            Visibility::Trace => Visibility::Trace,
        }
    }
}

impl RasterPath {
    /// With or without the stage `small`, where depths are compared in f64.
    pub fn with_small(self, small: bool) -> RasterPath {
        match self {
            RasterPath::ByTile(TilePath { wide, depths: TileDepths::Exact { .. } }) => {
                RasterPath::ByTile(TilePath { wide, depths: TileDepths::Exact { small } })
            }
            other => other,
        }
    }
}
