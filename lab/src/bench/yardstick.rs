//! Another program in the same loop: `embree_peer`'s command line, which shoots the rays of GLC pieces.
//!
//! `PROGRAM MESH.tri W H pieces FILE [options]` prints one line of JSON with `trace_ms` and `build_ms`, each with its median, and
//! writes each pixel's triangle id (u32, 0xffffffff: none) and t (f32), one after the other, to `--dump FILE`.

use super::row::Moving;
use anamorph::internals::camera::bundle::Bundle;
use anamorph::internals::camera::pieces::Piece;
use anamorph::internals::camera::{Camera, Rays};
use anamorph::internals::image::frame::{Channel, Frame, Plane};
use anamorph::internals::input::{Error, Result};
use anamorph::internals::scene::Scene;
use glam::{DVec2, DVec3};
use serde::Deserialize;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A program, with a mesh and a camera as its files.
pub struct Yardstick {
    command: Vec<String>,
    /// Where its files are.
    folder: tempfile::TempDir,
    program: PathBuf,
    /// t where its own is 0, and where it is 1.
    t_range: [f64; 2],
    size: (u32, u32),
    /// What it builds over the triangles counts.
    builds: bool,
}

#[derive(Deserialize)]
struct Said {
    trace_ms: Figure,
    build_ms: Figure,
}

#[derive(Deserialize)]
struct Figure {
    median: f64,
}

impl Yardstick {
    /// `None` where it cannot show the scene or the camera: it knows triangles at one time, and still GLC pieces.
    ///
    /// # Errors
    /// [`Error::Write`] if a file cannot be written.
    pub fn new(program: &Path, scene: &Scene, camera: &Camera, moving: Moving) -> Result<Option<Yardstick>> {
        let [Rays::Pieces(pieces)] = &camera.layers[..] else { return Ok(None) };
        if scene.steps.is_some()
            || camera.optics.is_some()
            || moving == Moving::Camera
            || !pieces.pieces.iter().all(|p| is_plain(&p.bundle))
        {
            return Ok(None);
        }
        let t_range = [camera.t_range[0], camera.t_range[1].min(last_t(scene, &pieces.pieces))];
        let folder = tempfile::tempdir().map_err(|e| Error::work(format!("no temporary folder: {e}")))?;
        let size = (camera.width, camera.height);
        let text: String = pieces.pieces.iter().map(|p| line(p, size, t_range)).collect();
        let (mesh, rays) = (folder.path().join("mesh.tri"), folder.path().join("camera.pieces"));
        let failed = |e: std::io::Error| Error::work(format!("{}: {e}", folder.path().display()));
        std::fs::write(&mesh, triangles(scene)).map_err(failed)?;
        std::fs::write(&rays, text).map_err(failed)?;
        let (w, h) = (size.0.to_string(), size.1.to_string());
        let command = [&mesh.display().to_string(), &w, &h, "pieces", &rays.display().to_string()];
        let command = command.into_iter().chain(["--coherent", "1", "--no-shade", "--warmup", "1", "--frames", "1"]);
        Ok(Some(Yardstick {
            command: command.map(str::to_owned).collect(),
            program: program.to_owned(),
            t_range,
            size,
            builds: moving == Moving::Triangles,
            folder,
        }))
    }

    /// One more frame, ms.
    pub fn frame(&self) -> Result<f64> {
        let (trace_ms, build_ms) = self.trace_and_build()?;
        Ok(trace_ms + if self.builds { build_ms } else { 0.0 })
    }

    /// One more frame: the times of its rays, and of the hierarchy, ms.
    pub fn trace_and_build(&self) -> Result<(f64, f64)> {
        let said = self.run(&[])?;
        Ok((said.trace_ms.median, said.build_ms.median))
    }

    /// What it sees.
    pub fn finish(&self) -> Result<Frame> {
        let dump = self.folder.path().join("seen.bin");
        self.run(&["--dump", &dump.display().to_string()])?;
        let bytes = std::fs::read(&dump).map_err(|e| self.failed(&e))?;
        let pixels = self.size.0 as usize * self.size.1 as usize;
        if bytes.len() != 8 * pixels {
            return Err(self.failed(&format!("{} bytes of {} dumped", bytes.len(), 8 * pixels)));
        }
        let word = |k: usize| u32::from_le_bytes([bytes[4 * k], bytes[4 * k + 1], bytes[4 * k + 2], bytes[4 * k + 3]]);
        let t = |k: usize| self.t_range[0] + f64::from(f32::from_bits(word(k))) * (self.t_range[1] - self.t_range[0]);
        let ids = (0..pixels).map(|k| word(2 * k)).collect();
        let ts = (0..pixels).map(|k| t(2 * k + 1) as f32).collect();
        let planes = vec![(Channel::T, Plane::F32(ts)), (Channel::TriangleId, Plane::U32(ids))];
        Ok(Frame { width: self.size.0, height: self.size.1, planes })
    }

    fn run(&self, more: &[&str]) -> Result<Said> {
        let done = Command::new(&self.program).args(&self.command).args(more).output().map_err(|e| self.failed(&e))?;
        if !done.status.success() {
            let said = String::from_utf8_lossy(&done.stderr);
            return Err(self.failed(&said.lines().last().unwrap_or("it failed")));
        }
        serde_json::from_slice(&done.stdout).map_err(|e| self.failed(&e))
    }

    fn failed(&self, e: &dyn std::fmt::Display) -> Error {
        Error::work(format!("{}: {e}", self.program.display()))
    }
}

/// Rays are affine over the image without a weight.
fn is_plain(b: &Bundle) -> bool {
    b.h[1] == 0.0 && b.h[2] == 0.0
}

/// A t beyond the whole scene on every ray: four times what it takes at the corners and the middle of each piece.
fn last_t(scene: &Scene, pieces: &[Piece]) -> f64 {
    let (lo, hi) = scene.bounds().unwrap_or((DVec3::ZERO, DVec3::ZERO));
    let (middle, reach) = ((lo + hi) / 2.0, (hi - lo).length());
    let of = |piece: &Piece| {
        let places = piece.corners_px.map_or(vec![piece.centre_px], |c| vec![c[0], c[1], c[2], piece.centre_px]);
        let t = |q: DVec2| {
            let from_centre = q - piece.centre_px;
            let ray = piece.bundle.ray(from_centre.x, from_centre.y);
            (ray.origin.distance(middle) + reach) / ray.direction.length()
        };
        places.into_iter().map(t).fold(0.0, f64::max)
    };
    4.0 * pieces.iter().map(of).fold(0.0, f64::max)
}

/// A piece as the program reads it: whether it is a triangle or a parallelogram, three places in the image, [0, 1]^2, y down, and
/// where their rays start and end.
fn line(piece: &Piece, (width, height): (u32, u32), t_range: [f64; 2]) -> String {
    let size = DVec2::new(f64::from(width), f64::from(height));
    let (kind, corners) = match piece.corners_px {
        Some(corners) => ('t', corners),
        None => ('r', [DVec2::ZERO, DVec2::new(size.x, 0.0), DVec2::new(0.0, size.y)]),
    };
    let at = |q: DVec2, t: f64| {
        let from_centre = q - piece.centre_px;
        let ray = piece.bundle.ray(from_centre.x, from_centre.y);
        (ray.origin + t * ray.direction).to_array()
    };
    let places = corners.into_iter().flat_map(|q| (q / size).to_array());
    let rays = t_range.into_iter().flat_map(|t| corners.map(|q| at(q, t))).flatten();
    let mut text = String::from(kind);
    for number in places.chain(rays) {
        // writing to a String cannot fail
        let _ = write!(text, " {number}");
    }
    text + "\n"
}

/// The mesh as the program reads it: "TRI1", how many vertices and triangles (u32), vertices (f32 x 3), triangles (u32 x 3).
fn triangles(scene: &Scene) -> Vec<u8> {
    let mesh = &scene.mesh;
    let mut bytes = b"TRI1".to_vec();
    bytes.extend((mesh.positions.len() as u32).to_le_bytes());
    bytes.extend((mesh.triangles.len() as u32).to_le_bytes());
    mesh.positions.iter().for_each(|p| bytes.extend(bytemuck::cast::<_, [u8; 12]>(p.as_vec3().to_array())));
    mesh.triangles.iter().for_each(|t| bytes.extend(bytemuck::cast::<_, [u8; 12]>(*t)));
    bytes
}
