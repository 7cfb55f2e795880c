//! A drawing as SVG text: a few shapes, each with a class that the style sheet colours.

use crate::arrays::MapEach;
use glam::DVec2;

/// Colours of layers, first to last; a ninth layer has the first one's again. Dark enough for white paper, and apart in
/// lightness too.
const LAYERS: [&str; 8] = ["#1f5fa8", "#c1440e", "#2b8a3e", "#8a3ffc", "#b58900", "#0b7285", "#a61e4d", "#495057"];

const STYLE: &str = "\
text { font-family: sans-serif; font-size: 13px; fill: #333 }
.title { font-size: 16px; fill: #000 }
.number { font-size: 10px; text-anchor: middle; fill: #555; stroke: none }
.frame { fill: none; stroke: #888 }
.box { stroke: #999; stroke-dasharray: 4 3; fill: none }
.mesh { stroke: #b9b9b9; stroke-width: 0.6; fill: none }
.point { fill: #b9b9b9; stroke: none }
.axis { stroke: #333; fill: none }
.piece { fill-opacity: 0.08; stroke-width: 0.8 }
.grid { fill: none; stroke-width: 0.8 }
.near { fill: none; stroke-width: 1 }
.far { fill: none; stroke-width: 0.6; stroke-dasharray: 2 2 }
.ray { fill: none; stroke-width: 0.6; stroke-opacity: 0.75 }
.slit { fill: none; stroke: #e03131; stroke-width: 2 }
.eye { fill: #e03131; stroke: none }
";

/// A rectangle of the page, px; y runs down.
#[derive(Debug, Clone, Copy)]
pub struct Frame {
    pub lo: DVec2,
    pub size: DVec2,
}

impl Frame {
    pub fn new(x: f64, y: f64, width: f64, height: f64) -> Frame {
        Frame { lo: DVec2::new(x, y), size: DVec2::new(width, height) }
    }

    pub fn hi(&self) -> DVec2 {
        self.lo + self.size
    }

    /// The largest frame of `sides`' shape in the middle of this one.
    pub fn fitted(&self, sides: DVec2) -> Frame {
        let size = sides * (self.size / sides).min_element();
        Frame { lo: self.lo + (self.size - size) / 2.0, size }
    }

    pub fn corners(&self) -> [DVec2; 4] {
        let (lo, hi) = (self.lo, self.hi());
        [lo, DVec2::new(hi.x, lo.y), hi, DVec2::new(lo.x, hi.y)]
    }
}

/// What has been drawn so far.
pub struct Svg {
    text: String,
    clips: usize,
}

impl Svg {
    pub fn new(size: DVec2) -> Svg {
        let (w, h) = (size.x, size.y);
        let mut text = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w}\" height=\"{h}\" viewBox=\"0 0 {w} {h}\">\n<style>\n{STYLE}"
        );
        for (k, colour) in LAYERS.iter().enumerate() {
            text += &format!(".layer{k} {{ stroke: {colour} }}\n.layer{k} .piece {{ fill: {colour} }}\n");
        }
        text += &format!("</style>\n<rect width=\"{w}\" height=\"{h}\" fill=\"#fff\"/>\n");
        Svg { text, clips: 0 }
    }

    /// The whole document.
    pub fn finish(self) -> String {
        self.text + "</svg>\n"
    }

    /// Draws what `draw` does as one group of a layer's colour, cut off at `frame`.
    pub fn layer(&mut self, layer: usize, frame: &Frame, draw: impl FnOnce(&mut Svg)) {
        self.clips += 1;
        let (clip, colour) = (self.clips, layer % LAYERS.len());
        let (lo, size) = (frame.lo, frame.size);
        let [x, y, w, h] = [lo.x, lo.y, size.x, size.y].map_each(short);
        self.text +=
            &format!("<clipPath id=\"c{clip}\"><rect x=\"{x}\" y=\"{y}\" width=\"{w}\" height=\"{h}\"/></clipPath>\n");
        self.text += &format!("<g class=\"layer{colour}\" clip-path=\"url(#c{clip})\">\n");
        draw(self);
        self.text += "</g>\n";
    }

    pub fn polygon(&mut self, class: &str, corners: &[DVec2]) {
        self.text += &format!("<polygon class=\"{class}\" points=\"{}\"/>\n", places(corners));
    }

    pub fn polyline(&mut self, class: &str, points: &[DVec2]) {
        self.text += &format!("<polyline class=\"{class}\" points=\"{}\"/>\n", places(points));
    }

    /// A Bezier curve of degree 1, 2 or 3.
    pub fn bezier(&mut self, class: &str, points: &[DVec2]) {
        let word = ["M", "L", "Q", "C"][points.len() - 1];
        let (start, rest) = (place(&points[0]), places(&points[1..]));
        self.text += &format!("<path class=\"{class}\" d=\"M{start} {word}{rest}\"/>\n");
    }

    /// Lines from point to point, as one shape.
    pub fn lines(&mut self, class: &str, lines: impl Iterator<Item = [DVec2; 2]>) {
        let lines: String = lines.map(|[a, b]| format!("M{}L{}", place(&a), place(&b))).collect();
        self.text += &format!("<path class=\"{class}\" d=\"{lines}\"/>\n");
    }

    pub fn dot(&mut self, class: &str, at: DVec2, radius: f64) {
        let [x, y] = at.to_array().map_each(short);
        self.text += &format!("<circle class=\"{class}\" cx=\"{x}\" cy=\"{y}\" r=\"{radius}\"/>\n");
    }

    /// `text` is the program's own: letters, digits and points, nothing that XML reads.
    pub fn text(&mut self, class: &str, at: DVec2, text: &str) {
        let [x, y] = at.to_array().map_each(short);
        self.text += &format!("<text class=\"{class}\" x=\"{x}\" y=\"{y}\">{text}</text>\n");
    }
}

/// Hundredths of a pixel: as fine as anyone sees.
fn short(x: f64) -> String {
    // -0.00 is 0.00
    format!("{:.2}", (x * 100.0).round() / 100.0 + 0.0)
}

fn place(p: &DVec2) -> String {
    format!("{},{}", short(p.x), short(p.y))
}

fn places(points: &[DVec2]) -> String {
    points.iter().map(place).collect::<Vec<_>>().join(" ")
}
