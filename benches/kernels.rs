//! Times a frame of the teapot through one piece and through 1,000, and says how wrong the frame is beside it.
//!
//! `cargo bench` runs every case some times; `cargo test --benches` once, on a small image.

use anamorph::camera::Camera;
use anamorph::compare::compare;
use anamorph::engine::{Engine, RunOptions};
use anamorph::frame::Channel;
use anamorph::gpu::device::NO_ADAPTER;
use anamorph::gpu::{Gpu, GpuOptions};
use anamorph::plan::Wanted;
use anamorph::reference::image::judge;
use anamorph::scene::Scene;
use anamorph::scene::file::{CameraKind, CameraSpec, CameraVertex, MeshCameraSpec, OutputSpec};
use anamorph::scene::generate;
use glam::{DVec2, DVec3};

const FORWARD: [f64; 2] = [0.0, f64::INFINITY];

/// A pinhole at `eye` as rays through the image place (a, b), [0, 1]^2: the teapot fills most of the picture.
fn ray(q: DVec2) -> (DVec3, DVec3) {
    let eye = DVec3::new(0.0, 2.0, 9.0);
    (eye, eye + DVec3::new(5.0 * (q.x - 0.5), 0.35 - 3.75 * (q.y - 0.5) - 1.0, -9.0))
}

/// Two pieces for each of `columns` x `rows` cells, bent a little at their corners so that no two are one bundle.
fn pieces(columns: u32, rows: u32) -> CameraKind {
    let vertex = |i: u32, j: u32| {
        let q = DVec2::new(i as f64 / columns as f64, j as f64 / rows as f64);
        let (near, far) = ray(q);
        let bend = 0.1 * DVec3::new((9.0 * q.y).sin(), (9.0 * q.x).sin(), 0.0);
        CameraVertex { image: q.to_array(), near, far: far + bend, w: 1.0 }
    };
    let vertices = (0..=rows).flat_map(|j| (0..=columns).map(move |i| (i, j))).map(|(i, j)| vertex(i, j)).collect();
    let cells = (0..rows).flat_map(|j| (0..columns).map(move |i| j * (columns + 1) + i));
    let triangles =
        cells.flat_map(|k| [[k, k + 1, k + columns + 1], [k + columns + 2, k + 1, k + columns + 1]]).collect();
    CameraKind::Mesh(MeshCameraSpec { vertices, triangles, normalize: false })
}

fn one_piece() -> CameraKind {
    let corners = [DVec2::ZERO, DVec2::X, DVec2::Y].map(ray);
    CameraKind::Glc { near: corners.map(|c| c.0), far: corners.map(|c| c.1) }
}

fn main() -> anamorph::Result<()> {
    let bench = std::env::args().any(|a| a == "--bench");
    let (size, repeat) = if bench { ((800, 600), 20) } else { ((160, 120), 1) };
    let Some(gpu) = Gpu::open(&GpuOptions::default())? else {
        println!("skipped: {NO_ADAPTER}");
        return Ok(());
    };
    let channels = vec![Channel::T, Channel::TriangleId];
    let wanted = Wanted { channels, srgb8: false, counting: false };
    println!("{}, {}, {} x {}, {repeat} frames each", gpu.info.name, gpu.info.driver_info, size.0, size.1);
    let mut engine = Engine::new(gpu);
    for (name, kind) in [("one piece", one_piece()), ("1,000 pieces", pieces(25, 20))] {
        let spec = CameraSpec { kind, t_range: FORWARD };
        let camera = Camera::new(&spec, Some(size))?;
        let scene = Scene {
            mesh: generate::teapot(16),
            lights: Vec::new(),
            background: [0.0; 3],
            size: Some(size),
            camera: spec,
            caustics: None,
            output: OutputSpec::default(),
        };
        let run = RunOptions { repeat, ..Default::default() };
        let mut rendered = engine.render(&scene, &camera, &wanted, &run)?;
        rendered.frame_ms.sort_by(f64::total_cmp);
        let ms = |k: usize| rendered.frame_ms[k];
        let last = rendered.frame_ms.len() - 1;
        let truth = judge(&scene, &camera, &rendered.frame);
        let error = compare(&rendered.frame, &truth.truth, Some(&truth.safe), Some(&truth.scales))?;
        println!("{name}: {:.2} ms a frame ({:.2} to {:.2}); {error}", ms(last / 2), ms(0), ms(last));
        for (stage, ms) in &rendered.stages {
            println!("    {stage:<8}{ms:.3} ms");
        }
    }
    Ok(())
}
