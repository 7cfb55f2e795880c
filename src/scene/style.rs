//! How a picture is drawn beyond how things are lit: lines as wide in pixels as they shall be, and strokes of a pen.

/// Lines and strokes; none by default.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Style {
    /// Along the edges of all triangles.
    pub wireframe: Option<Line>,
    /// Where one thing hides another, or a surface has a crease.
    pub outline: Option<Outline>,
    /// Where pieces of the camera meet.
    pub borders: Option<Line>,
    pub hatching: Option<Hatching>,
}

/// A line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line {
    /// Pixels.
    pub width: f64,
    /// Linear RGB.
    pub colour: [f32; 3],
    /// World units along the ray beyond which lines grow narrower as what is there grows smaller; infinite: nowhere.
    pub depth: f64,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outline {
    pub line: Line,
    /// Degrees between normals from which on an edge is a crease.
    pub crease: f64,
}

/// Ink on paper: as much of it as a surface is dark.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hatching {
    /// From stroke to stroke, pixels: once to twice as much.
    pub spacing: f64,
    /// Linear RGB.
    pub ink: [f32; 3],
    pub paper: [f32; 3],
}

impl Style {
    /// Something is drawn on surfaces by themselves.
    pub fn is_on_surfaces(&self) -> bool {
        self.wireframe.is_some() || self.hatching.is_some()
    }

    /// Something is drawn between pixels.
    pub fn is_between_pixels(&self) -> bool {
        self.outline.is_some() || self.borders.is_some()
    }
}
