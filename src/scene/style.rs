//! Non-photorealistic styles: lines of a given width in pixels, and pen strokes.

/// Lines and strokes; none by default.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Style {
    /// Wireframe: along the edges of all triangles.
    pub wireframe: Option<Line>,
    /// Silhouettes and creases.
    pub outline: Option<Outline>,
    /// Borders of the camera's pieces.
    pub borders: Option<Line>,
    pub hatching: Option<Hatching>,
}

/// A line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line {
    /// Width, pixels.
    pub width: f64,
    /// Linear RGB.
    pub colour: [f32; 3],
    /// Distance along the ray, world units, beyond which lines narrow in proportion to the image scale; infinite: never.
    pub depth: f64,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outline {
    pub line: Line,
    /// Least angle between normals at a crease, degrees.
    pub crease: f64,
}

/// Pen strokes: their density follows the darkness of the surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hatching {
    /// Distance between strokes, pixels: between one and two times this.
    pub spacing: f64,
    /// Linear RGB.
    pub ink: [f32; 3],
    pub paper: [f32; 3],
}

impl Style {
    /// Whether wires or strokes are drawn on surfaces.
    pub fn is_on_surfaces(&self) -> bool {
        self.wireframe.is_some() || self.hatching.is_some()
    }

    /// Pixels around a pixel that decide the lines in it; 0: no lines are drawn between pixels.
    pub fn line_reach(&self) -> u32 {
        let widths = [self.outline.map(|o| o.line.width), self.borders.map(|b| b.width)];
        let widest = widths.into_iter().flatten().reduce(f64::max);
        // a line has half its width and half a pixel to each side, and lies between a pixel and the next one
        widest.map_or(0, |width| (0.5 * width + 0.5).ceil() as u32 + 1)
    }
}
