//! A camera as a drawing: its pieces on the image, and its volume with sample rays or projectors around the scene, as
//! Yu and McMillan 2004, Brosz et al. 2007 and Popescu et al. draw theirs.

mod image;
mod space;
mod svg;
mod view;

use crate::camera::Camera;
use crate::geometry::mesh::Mesh;
use crate::image::write_text;
use crate::input::Result;
use glam::DVec2;
use std::path::Path;
use svg::{Frame, Svg};

/// Writes the drawing as SVG; the same camera and scene give the same bytes.
///
/// # Errors
/// [`crate::input::Error::Work`] naming `path` where it cannot be written.
pub fn write(path: &Path, mesh: &Mesh, camera: &Camera) -> Result<()> {
    write_text(path, &draw(mesh, camera))
}

fn draw(mesh: &Mesh, camera: &Camera) -> String {
    let mut svg = Svg::new(DVec2::new(1240.0, 600.0));
    let title = format!("{}, {} x {} pixels", camera.kind, camera.width, camera.height);
    svg.text("title", DVec2::new(24.0, 32.0), &title);
    image::draw(&mut svg, Frame::new(24.0, 48.0, 460.0, 500.0), camera);
    space::draw(&mut svg, Frame::new(516.0, 48.0, 700.0, 490.0), mesh, camera);
    svg.finish()
}
