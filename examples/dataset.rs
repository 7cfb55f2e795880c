//! Depth and ids of a mesh from arrays through fisheyes around it: `cargo run --release --example dataset -- FOLDER`.
//!
//! Writes an EXR and a PNG for each view, and a line with the share of pixels that show the mesh.

use anamorph::{Camera, Channel, Mesh, NO_ID, RenderOptions, Renderer, Result, Scene};
use std::path::Path;

/// Width and height of an image, pixels.
const SIZE: (u32, u32) = (320, 320);

/// Number of images.
const VIEWS: u32 = 4;

fn main() -> Result<()> {
    let folder = std::env::args().nth(1).unwrap_or_else(|| ".".into());
    let mut scene = Scene::new();
    scene.add(octahedron()?)?;
    // the scene stays on the device from image to image
    let mut renderer = Renderer::new()?;
    let options = RenderOptions { channels: vec![Channel::Z, Channel::TriangleId], color: true, ..Default::default() };
    for view in 0..VIEWS {
        let angle = f64::from(view) / f64::from(VIEWS) * std::f64::consts::TAU;
        let (x, z) = (3.0 * angle.sin(), 3.0 * angle.cos());
        let fisheye = Camera::builder("fisheye").key("eye", [x, 1.0, z]).key("target", [0.0; 3]).key("fov", 120.0);
        let camera = fisheye.size(SIZE.0, SIZE.1).build(&scene)?;
        let rendered = renderer.render(&scene, &camera, &options)?;
        let ids = rendered.frame.u32(Channel::TriangleId).unwrap_or_default();
        let shown = ids.iter().filter(|id| **id != NO_ID).count();
        let name = Path::new(&folder).join(format!("view-{view}"));
        rendered.write_exr(name.with_extension("exr"))?;
        rendered.write_png(name.with_extension("png"))?;
        println!("{}: {:.1} % of {} pixels", name.display(), 100.0 * shown as f64 / ids.len() as f64, ids.len());
    }
    Ok(())
}

/// Eight triangles around the origin, counter-clockwise seen from outside.
fn octahedron() -> Result<Mesh> {
    let corners = vec![[1., 0., 0.], [-1., 0., 0.], [0., 1., 0.], [0., -1., 0.], [0., 0., 1.], [0., 0., -1.]];
    let faces = vec![[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    Ok(Mesh::new(corners, faces)?.named("octahedron"))
}
