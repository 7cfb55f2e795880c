//! Times a thousand small images: in one frame, beside one frame of the same rays by a `mesh` camera, one image of as many pixels, and a
//! call for each: `cargo bench --bench views`. `cargo test --benches` runs each once, on little.

use anamorph::{Camera, Channel, RenderOptions, Renderer, Scene};
use std::fmt::Write;
use std::time::Instant;

/// Pixels of a side of an image.
const SIDE: u32 = 64;

/// Rounds, in each of which every way is timed once.
const ROUNDS: usize = 5;

fn main() -> anamorph::Result<()> {
    let bench = std::env::args().any(|a| a == "--bench");
    let (count, rounds) = if bench { (1000, ROUNDS) } else { (10, 1) };
    // each way has a device of its own, which keeps its lists as long as it needs them
    let mut renderers = [Renderer::new()?, Renderer::new()?, Renderer::new()?, Renderer::new()?];
    let Some(adapter) = renderers[0].adapter() else {
        println!("skipped: there is no adapter");
        return Ok(());
    };
    println!("{count} images of {SIDE}x{SIDE}, t and triangle ids, on {adapter}; medians of {rounds} rounds, ms");
    let options = RenderOptions { channels: vec![Channel::T, Channel::TriangleId], ..Default::default() };
    for (name, scene) in [("15,000 triangles", city(15_000)?), ("100,000 triangles", city(100_000)?)] {
        let views: Vec<View> = (0..count).map(View::new).collect();
        let each: Vec<Camera> = views
            .iter()
            .map(|view| Camera::parse(&view.pinhole(), ".", &scene, Some((SIDE, SIDE))))
            .collect::<Result<_, _>>()?;
        // cameras of their own for each round: the plan of one that is there already is not made again
        let columns = (f64::from(count)).sqrt().ceil() as u32;
        let size = (SIDE * columns, SIDE * count.div_ceil(columns));
        let of_size = |table: &str| {
            (0..=rounds).map(|_| Camera::parse(table, ".", &scene, Some(size))).collect::<Result<Vec<_>, _>>()
        };
        let mesh = of_size(&mesh(&views, columns))?;
        let whole = of_size(&views[0].pinhole())?;
        let mut ms = [const { Vec::new() }; 4];
        // the first round is not counted
        for round in 0..=rounds {
            for (k, (renderer, ms)) in renderers.iter_mut().zip(&mut ms).enumerate() {
                let started = Instant::now();
                match k {
                    0 => drop(renderer.render_many(&scene, &each, &options)?),
                    1 => drop(renderer.render(&scene, &mesh[round], &options)?),
                    2 => drop(renderer.render(&scene, &whole[round], &options)?),
                    _ => {
                        for camera in &each {
                            renderer.render(&scene, camera, &options)?;
                        }
                    }
                }
                if round > 0 {
                    ms.push(started.elapsed().as_secs_f64() * 1e3);
                }
            }
        }
        let [many, mesh, whole, calls] = ms.map(median);
        println!("{name}: in one frame {many:.0}, a mesh camera {mesh:.0}, one pinhole {whole:.0}, calls {calls:.0}");
        println!("  in one frame over a mesh camera {:.2}, calls over one frame {:.2}", many / mesh, calls / many);
    }
    Ok(())
}

fn city(triangles: u32) -> anamorph::Result<Scene> {
    let text = format!(
        "image = {{ width = 64, height = 64 }}\ncamera = {{ kind = \"pinhole\", eye = [0, 2, 9], target = [0, 0, 0], vfov = 60 }}\n\
         mesh = [{{ builtin = \"city\", triangles = {triangles}, blocks = 12 }}]"
    );
    Scene::parse(&text, ".")
}

/// A place around the city and the direction of a look.
struct View {
    eye: [f64; 3],
    target: [f64; 3],
}

/// Of a view, degrees.
const VFOV: f64 = 60.0;

impl View {
    fn new(k: u32) -> View {
        // golden angles: no two are near each other
        let (sine, cosine) = (f64::from(k) * 2.399963).sin_cos();
        let far = 4.0 + f64::from(k % 97) * 0.06;
        View { eye: [far * sine, 0.5 + f64::from(k % 31) * 0.1, far * cosine], target: [sine, 0.2, -cosine] }
    }

    fn pinhole(&self) -> String {
        let View { eye, target } = self;
        format!("kind = \"pinhole\"\neye = {eye:?}\ntarget = {target:?}\nvfov = {VFOV}")
    }

    /// Points at t = 1 of the rays through the image's corners, row by row.
    fn corners(&self) -> [[f64; 3]; 4] {
        let View { eye: e, target } = *self;
        let unit = |v: [f64; 3]| v.map(|x| x / v.iter().map(|x| x * x).sum::<f64>().sqrt());
        let cross = |a: [f64; 3], b: [f64; 3]| {
            [0, 1, 2].map(|k| a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3])
        };
        let forward = unit([0, 1, 2].map(|k| target[k] - e[k]));
        let right = unit(cross(forward, [0.0, 1.0, 0.0]));
        let up = cross(right, forward);
        let reach = (VFOV.to_radians() / 2.0).tan();
        [(-reach, reach), (reach, reach), (-reach, -reach), (reach, -reach)]
            .map(|(x, y)| [0, 1, 2].map(|k| e[k] + forward[k] + x * right[k] + y * up[k]))
    }
}

/// All views as squares of one image, two triangles each.
fn mesh(views: &[View], columns: u32) -> String {
    let rows = (views.len() as u32).div_ceil(columns);
    let (mut vertices, mut triangles) = (String::new(), String::new());
    for (k, view) in (0u32..).zip(views) {
        for (n, far) in (0u32..).zip(view.corners()) {
            let image =
                [f64::from(k % columns + n % 2) / f64::from(columns), f64::from(k / columns + n / 2) / f64::from(rows)];
            // writing to a String cannot fail
            let _ = write!(vertices, "{{ image = {image:?}, near = {:?}, far = {far:?}, w = 1 }},", view.eye);
        }
        let first = 4 * k;
        let _ = write!(
            triangles,
            "[{first}, {}, {}], [{}, {}, {}],",
            first + 1,
            first + 2,
            first + 1,
            first + 3,
            first + 2
        );
    }
    format!("kind = \"mesh\"\nvertices = [{vertices}]\ntriangles = [{triangles}]")
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}
