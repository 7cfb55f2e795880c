//! Times whole calls while the camera moves: from its new keys to the arrays in the caller's memory, beside the frame of each call:
//! `cargo bench --bench calls`, with parts of the names of cases behind `--`, if not all. `cargo test --benches` runs each once, on little.

use anamorph::{Camera, Channel, RenderOptions, Renderer, Scene};
use std::time::Instant;

/// Poses of a path: half through the scene, half around it.
const POSES: u32 = 40;

/// Cameras by name, without the keys of their pose.
const CAMERAS: [(&str, &str); 5] = [
    ("pinhole", "kind = 'pinhole'\nvfov = 60"),
    ("fisheye", "kind = 'fisheye'\nfov = 180"),
    ("cylinder", "kind = 'cylinder'\nvfov = 60"),
    ("brown", "kind = 'opencv'\nfile = 'calls-brown.yml'"),
    (
        "cross-slit",
        "kind = 'cross_slit'\nheight = 60\nslits = [{ distance = 40, angle = 0 }, { distance = 60, angle = 90 }]",
    ),
];

/// A calibration of OpenCV's tutorial.
const BROWN: &str = "%YAML:1.0
image_width: 640
image_height: 480
camera_matrix: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 535.9, 0., 342.3, 0., 535.9, 235.6, 0., 0., 1. ]
distortion_coefficients: !!opencv-matrix
   rows: 5
   cols: 1
   dt: d
   data: [ -0.2664, -0.0386, 0.0018, -0.0003, 0.2384 ]
";

/// Triangles, and the size of the image.
const SCENES: [(u32, (u32, u32)); 4] =
    [(15_000, (320, 240)), (15_000, (1920, 1080)), (100_000, (640, 480)), (1_000_000, (320, 240))];

fn main() -> anamorph::Result<()> {
    let bench = std::env::args().any(|a| a == "--bench");
    let asked: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with("--")).collect();
    let mut renderer = Renderer::new()?;
    let Some(adapter) = renderer.adapter() else {
        println!("skipped: there is no adapter");
        return Ok(());
    };
    println!("t, Z and ids on {adapter}; medians over {POSES} poses, ms\n");
    println!("| case | camera | call | its frame | call / frame | slowest call |");
    println!("|---|---:|---:|---:|---:|---:|");
    let folder = env!("CARGO_TARGET_TMPDIR");
    std::fs::write(format!("{folder}/calls-brown.yml"), BROWN).expect("a file in the folder for temporary files");
    let scenes = if bench { &SCENES[..] } else { &[(500, (32, 24))] };
    let options = RenderOptions { channels: vec![Channel::T, Channel::Z, Channel::TriangleId], ..Default::default() };
    for &(triangles, size) in scenes {
        let scene = city(triangles)?;
        for (name, keys) in CAMERAS {
            let case = format!("{name}, {triangles} triangles, {} x {}", size.0, size.1);
            if !asked.is_empty() && !asked.iter().any(|a| case.contains(a.as_str())) {
                continue;
            }
            let mut times: [Vec<f64>; 3] = Default::default();
            // the first pose makes the kernels and uploads the scene
            for pose in 0..=if bench { POSES } else { 2 } {
                let started = Instant::now();
                let camera = Camera::parse(&format!("{}\n{keys}", path(pose)), folder, &scene, Some(size))?;
                let compiled = started.elapsed();
                let rendered = renderer.render(&scene, &camera, &options)?;
                let call = started.elapsed();
                if pose > 0 {
                    let all = [compiled.as_secs_f64() * 1e3, call.as_secs_f64() * 1e3, rendered.frame_ms()];
                    times.iter_mut().zip(all).for_each(|(list, ms)| list.push(ms));
                }
            }
            let slowest = times[1].iter().copied().fold(0.0, f64::max);
            let [camera, call, frame] = times.map(median);
            let ratio = call / frame;
            println!("| {case} | {camera:.1} | {call:.1} | {frame:.1} | {ratio:.2} | {slowest:.0} |");
        }
    }
    Ok(())
}

/// The keys of a pose.
fn path(pose: u32) -> String {
    let (share, around) = (f64::from(pose % 20) / 20.0, pose >= 20);
    let angle = std::f64::consts::TAU * share;
    match around {
        false => format!("eye = [{0}, 3, 1]\ntarget = [{1}, 2, -20]", 50.0 * share - 25.0, 40.0 * share - 10.0),
        true => format!("eye = [{}, 30, {}]\ntarget = [0, 0, 0]", 60.0 * angle.cos(), 60.0 * angle.sin()),
    }
}

fn city(triangles: u32) -> anamorph::Result<Scene> {
    let camera = "camera = { kind = \"pinhole\", eye = [0, 2, 9], target = [0, 0, 0], vfov = 60 }";
    Scene::parse(&format!("{camera}\nmesh = [{{ builtin = \"city\", triangles = {triangles} }}]"), ".")
}

fn median(mut ms: Vec<f64>) -> f64 {
    ms.sort_by(f64::total_cmp);
    ms[ms.len() / 2]
}
