//! The appearance of surfaces, as kernels compute it.

/// How triangles are shaded.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Appearance {
    /// Images lie on triangles, a frame has their texture coordinates, or vertices have colours.
    pub textures: Option<Textures>,
    /// The scene has normals of its own.
    pub normals: bool,
    pub materials: MaterialsKind,
    pub lights: LightsKind,
    /// Patterns, lines or strokes are drawn on surfaces.
    pub styled: bool,
}

/// The table of surfaces has texture coordinates of triangles.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Textures {
    /// It has the colours of corners too.
    pub colored: bool,
    /// Some images are alpha masks.
    pub masked: bool,
}

/// The columns of the table of surfaces.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SurfaceKind {
    /// Normals and material.
    Plain,
    /// Texture coordinates too.
    Mapped,
    /// Texture coordinates and the colours of corners too.
    Colored,
}

/// How surfaces reflect light.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum MaterialsKind {
    /// All are matte.
    #[default]
    Matte,
    /// Some have highlights.
    Glossy,
    /// Light comes from all around, by an image of the sky; some may have highlights.
    UnderSky,
}

/// The lights of a scene.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum LightsKind {
    /// Directional white lights only.
    #[default]
    Plain,
    /// Coloured and positional lights too; with pictures, some throw a picture.
    Positional { pictures: bool },
    /// Shadows too.
    Shadowed { pictures: bool },
}

impl LightsKind {
    pub fn has_pictures(self) -> bool {
        matches!(self, LightsKind::Positional { pictures: true } | LightsKind::Shadowed { pictures: true })
    }

    pub fn has_shadows(self) -> bool {
        matches!(self, LightsKind::Shadowed { .. })
    }
}
