//! Features that most frames do without.

/// Features that most frames do without.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Extras {
    pub vertices: VerticesKind,
    pub primitives: PrimitivesKind,
    /// The samples of a pixel at an edge.
    pub samples: Option<EdgeSamples>,
    /// Lines are drawn between pixels.
    pub outlined: bool,
    pub volume: Option<VolumeKind>,
    /// `shade` writes 8-bit sRGB itself: it is wanted, and no later stage changes colours.
    pub writes: bool,
    /// Count tested and kept fragments.
    pub counting: bool,
    /// `cull` leaves out clusters that no ray of a node meets.
    pub culling: bool,
}

/// The primitives of a scene.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum PrimitivesKind {
    #[default]
    Triangles,
    /// Spheres too.
    Spheres,
    /// Spheres and capsules too.
    Capsules,
}

/// How kernels find the vertices of a triangle.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum VerticesKind {
    /// A table holds every triangle.
    #[default]
    Still,
    /// They move while the frame is taken, and each pixel shows them at a moment of its own.
    Timed,
    /// Meshes stand in several places, and the tables hold each once.
    Placed,
}

/// How a pixel at an edge is sampled.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct EdgeSamples {
    /// 2 to 32.
    pub count: u32,
    pub measure: SampleMeasure,
}

/// A triangle's fraction of a pixel at an edge.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SampleMeasure {
    /// The fraction of samples that show it.
    Counted,
    /// Its visible area.
    Area,
    /// The fraction of samples that show it in the rasterizer of a rival, which shades at the pixel's centre.
    AtCentre,
}

/// How a volume is rendered.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum VolumeKind {
    /// The light that it sends out and absorbs.
    Plain,
    /// The same in the scene's light.
    Lit,
    /// The largest value along a ray.
    Maximum,
}

impl Default for Extras {
    fn default() -> Extras {
        Extras {
            vertices: VerticesKind::Still,
            primitives: PrimitivesKind::Triangles,
            samples: None,
            outlined: false,
            volume: None,
            writes: false,
            counting: false,
            culling: true,
        }
    }
}
