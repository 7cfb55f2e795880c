//! Times gradients beside the frame that they are of, by the triangles' corners and by a number of the camera: `cargo bench
//! --bench gradients`, in Markdown, as bench_results/gradients.md. `cargo test --benches` runs each once, on little.

use anamorph::{Channel, RenderOptions, Renderer, Scene};
use std::time::Instant;

/// Rounds, in each of which every way is timed once.
const ROUNDS: usize = 5;

const CAMERAS: [(&str, &str); 3] = [
    ("pinhole", "kind = \"pinhole\", vfov = 60"),
    (
        "cross-slit",
        "kind = \"cross_slit\", slits = [{ distance = 9, angle = 0 }, { distance = 14, angle = 90 }], height = 7",
    ),
    ("fisheye", "kind = \"fisheye\", fov = 150, frame = \"full\""),
];

fn main() -> anamorph::Result<()> {
    let bench = std::env::args().any(|a| a == "--bench");
    let (size, triangles, rounds) = if bench { ((800, 600), 15_000, ROUNDS) } else { ((80, 60), 1000, 1) };
    let mut renderer = Renderer::new()?;
    let Some(adapter) = renderer.adapter().map(str::to_owned) else {
        println!("skipped: there is no adapter");
        return Ok(());
    };
    println!(
        "# Gradients\n\n{} x {} pixels, a city of {triangles} triangles, on {adapter}; ms, medians of {rounds} rounds, whole calls.\n",
        size.0, size.1
    );
    println!(
        "| camera | frame | with depth by vertices | coverage by vertices | depth by a number of the camera | coverage by a number |"
    );
    println!("|---|---:|---:|---:|---:|---:|");
    for (name, camera) in CAMERAS {
        let scene = Scene::parse(
            &format!(
                "image = {{ width = {}, height = {} }}\ncamera = {{ {camera}, eye = [0, 2, 9], target = [0, 0, 0] }}\n\
                 mesh = [{{ builtin = \"city\", triangles = {triangles}, blocks = 12 }}]",
                size.0, size.1
            ),
            ".",
        )?;
        let camera = scene.camera()?;
        let options = RenderOptions { channels: vec![Channel::TriangleId], ..Default::default() };
        let mut ms = [const { Vec::new() }; 5];
        // the first round is not counted
        for round in 0..=rounds {
            for (k, ms) in ms.iter_mut().enumerate() {
                let started = Instant::now();
                match k {
                    0 => drop(renderer.render(&scene, &camera, &options)?),
                    1 => drop(renderer.gradients(&scene, &camera, &["depth"], &["vertices"])?),
                    2 => drop(renderer.gradients(&scene, &camera, &["coverage"], &["vertices"])?),
                    3 => drop(renderer.gradients(&scene, &camera, &["depth"], &["camera.eye.0"])?),
                    _ => drop(renderer.gradients(&scene, &camera, &["coverage"], &["camera.eye.0"])?),
                }
                if round > 0 {
                    ms.push(started.elapsed().as_secs_f64() * 1e3);
                }
            }
        }
        let [frame, depth, coverage, depth_by_eye, coverage_by_eye] = ms.map(median);
        println!("| {name} | {frame:.0} | {depth:.0} | {coverage:.0} | {depth_by_eye:.0} | {coverage_by_eye:.0} |");
    }
    Ok(())
}

fn median(mut all: Vec<f64>) -> f64 {
    all.sort_by(f64::total_cmp);
    all[all.len() / 2]
}
