//! Times projection and splatting of many points, kernels beside the CPU, a depth image seen again by another camera, and two ways to the
//! roots of a cubic: `cargo bench --bench points`, with the names of cameras behind `--`, if not all; in Markdown, as
//! bench_results/points.md. `cargo test --benches` runs each once, on little.

use anamorph::internals::geometry::bernstein::Bernstein;
use anamorph::{Camera, Channel, Device, RenderOptions, Renderer, Scene, project_many, splat};
use std::hint::black_box;
use std::time::Instant;

/// Pixels of the image.
const SIZE: (u32, u32) = (1024, 768);

/// Cameras: the three classes of GLCs that are used most, pieces, and a volume of curves between control surfaces.
const CAMERAS: [(&str, &str); 5] = [
    ("pinhole", "kind = 'pinhole'\neye = [0, 0, 4]\ntarget = [0, 0, 0]\nvfov = 40"),
    (
        "cross-slit",
        "kind = 'cross_slit'\nslits = [{ distance = 4, angle = 20 }, { distance = 2.5, angle = 100 }]\neye = [0, 0, 4]
         target = [0, 0, 0]\nheight = 2",
    ),
    ("pushbroom", "kind = 'pushbroom'\nstart = [-1, 0, 4]\nend = [1, 0.2, 4]\nlook = [0, 0, -1]\nvfov = 30"),
    ("pieces", "kind = 'panorama'\ncenter = [0, 0, 0]\nradius = 3\nheight = 2"),
    ("volume", "kind = 'twist'\neye = [0, 0, 4]\ntarget = [0, 0, 0]\nvfov = 40\ndegree = 3\nangle = 70"),
];

fn main() -> anamorph::Result<()> {
    let bench = std::env::args().any(|a| a == "--bench");
    let counts: &[usize] = if bench { &[100_000, 1_000_000, 10_000_000] } else { &[1000] };
    println!("# Points through cameras\n");
    cubics(if bench { 1_000_000 } else { 1000 });
    let renderer = Renderer::new()?;
    let Some(adapter) = renderer.adapter() else {
        println!("skipped: there is no adapter");
        return Ok(());
    };
    println!(
        "\n{} x {} pixels, on {adapter}, {} threads of the CPU; ms, medians of rounds. Exact: kernels say where there is no image, the CPU finds the \
         others, and the numbers are the CPU's to the last bit; 0.1 px: the kernels' images where they prove so much.\n",
        SIZE.0,
        SIZE.1,
        std::thread::available_parallelism().map_or(1, usize::from)
    );
    println!(
        "| camera | points | rounds | project, CPU | kernels, exact | kernels, 0.1 px | share proven | splat, CPU | splat, kernels | share left out |"
    );
    println!("|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|");
    let scene = Scene::new();
    let asked: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with("--")).collect();
    for (name, keys) in CAMERAS.into_iter().filter(|c| asked.is_empty() || asked.iter().any(|a| a == c.0)) {
        let camera = Camera::parse(keys, ".", &scene, Some(SIZE))?;
        // a point of a panorama takes the CPU some 0.1 ms, and one of a volume more
        let most = if ["pieces", "volume"].contains(&name) { 100_000 } else { usize::MAX };
        for &count in counts.iter().filter(|count| **count <= most) {
            let points = points(count);
            let rounds = if bench && count <= MOST_IN_ROUNDS { ROUNDS } else { 1 };
            let (mut ms, mut shares) = ([const { Vec::new() }; 5], (0, 0));
            for _ in 0..rounds {
                let (cpu, exact) = timed(|| project_many(&camera, &points, &Device::Cpu, 0.0));
                let (gpu, same) = timed(|| project_many(&camera, &points, &Device::Gpu, 0.0));
                let (within, near) = timed(|| project_many(&camera, &points, &Device::Gpu, 0.1));
                let (exact, same, near) = (exact?, same?, near?);
                let is_same = exact.x == same.x && exact.y == same.y && exact.t == same.t;
                assert!(is_same && near.first == exact.first, "{name}");
                shares.0 = near.by_kernel;
                drop((exact, same, near));
                let (splat_cpu, one) = timed(|| splat(&camera, &points, &Device::Cpu));
                let (splat_gpu, other) = timed(|| splat(&camera, &points, &Device::Gpu));
                let (one, other) = (one?, other?);
                assert!(one.index == other.index && one.t == other.t, "{name}");
                shares.1 = other.by_kernel;
                ms.iter_mut().zip([cpu, gpu, within, splat_cpu, splat_gpu]).for_each(|(all, one)| all.push(one));
            }
            let [cpu, gpu, within, splat_cpu, splat_gpu] = ms.map(median);
            let share = |part: u64| part as f64 / count as f64;
            println!(
                "| {name} | {count} | {rounds} | {cpu:.0} | {gpu:.0} | {within:.0} | {:.3} | {splat_cpu:.0} | {splat_gpu:.0} | {:.3} |",
                share(shares.0),
                share(shares.1)
            );
        }
    }
    reprojected(renderer, if bench { ROUNDS } else { 1 }, if bench { 2 } else { 8 })
}

/// The depth image of a pinhole, each pixel a point, through a cross-slit camera.
fn reprojected(mut renderer: Renderer, rounds: usize, coarser: u32) -> anamorph::Result<()> {
    let (width, height) = (2 * SIZE.0 / coarser, 2 * SIZE.1 / coarser);
    let scene = Scene::parse(
        &format!(
            "image = {{ width = {width}, height = {height} }}\nmesh = [{{ builtin = 'city', seed = 3, blocks = 12, triangles = 15000 }}]\n\
             camera = {{ kind = 'pinhole', eye = [30, 30, 40], target = [0, 0, 0], vfov = 50 }}"
        ),
        ".",
    )?;
    let (first, channels) = (scene.camera()?, vec![Channel::PositionX, Channel::PositionY, Channel::PositionZ]);
    let second =
        "kind = 'cross_slit'\nslits = [{ distance = 60, angle = 0 }, { distance = 45, angle = 90 }]\neye = [32, 30, 40]
                  target = [0, 0, 0]\nheight = 45";
    let second = Camera::parse(second, ".", &scene, Some((SIZE.0 / coarser, SIZE.1 / coarser)))?;
    let (mut ms, mut count) = ([const { Vec::new() }; 3], 0);
    for _ in 0..rounds {
        let options = RenderOptions { channels: channels.clone(), ..Default::default() };
        let (render, frame) = timed(|| renderer.render(&scene, &first, &options));
        let frame = frame?.frame;
        let planes = channels.iter().map(|c| frame.f32(*c).unwrap_or_default());
        let [x, y, z] = planes.collect::<Vec<_>>()[..] else { continue };
        let places = x.iter().zip(y).zip(z).map(|((x, y), z)| [x, y, z].map(|v| f64::from(*v)));
        let points: Vec<[f64; 3]> = places.filter(|p| p.iter().all(|v| v.is_finite())).collect();
        count = points.len();
        let (cpu, one) = timed(|| splat(&second, &points, &Device::Cpu));
        let (gpu, other) = timed(|| splat(&second, &points, &Device::Gpu));
        assert!(one?.index == other?.index);
        ms.iter_mut().zip([render, cpu, gpu]).for_each(|(all, one)| all.push(one));
    }
    let [render, cpu, gpu] = ms.map(median);
    println!(
        "\nA depth image of {width} x {height} pixels by a pinhole ({render:.0} ms), its {count} points splatted through a cross-slit camera: \
         {cpu:.0} ms by the CPU, {gpu:.0} ms with kernels; medians of {rounds} rounds."
    );
    Ok(())
}

/// Rounds where there are at most so many points.
const ROUNDS: usize = 3;
const MOST_IN_ROUNDS: usize = 1_000_000;

fn median(mut all: Vec<f64>) -> f64 {
    all.sort_by(f64::total_cmp);
    all.get(all.len() / 2).copied().unwrap_or(f64::NAN)
}

fn timed<T>(work: impl FnOnce() -> T) -> (f64, T) {
    let started = Instant::now();
    let result = work();
    (started.elapsed().as_secs_f64() * 1e3, result)
}

/// In a cube in front of the cameras.
fn points(count: usize) -> Vec<[f64; 3]> {
    let mut state = 7;
    (0..count).map(|_| [0; 3].map(|_| 0.6 * signed(&mut state))).collect()
}

fn signed(state: &mut u64) -> f64 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

/// Roots in [0, 1] of random cubics: bracketed Newton, as `project` has it, against the closed form (Cardano; Viete).
fn cubics(count: usize) {
    let mut state = 5;
    let all: Vec<[f64; 4]> = (0..count).map(|_| [0; 4].map(|_| signed(&mut state))).collect();
    let (numeric, found) =
        timed(|| all.iter().map(|c| Bernstein::of_powers(c, [0.0, 1.0]).roots(0.0).len()).sum::<usize>());
    let (closed, roots) =
        timed(|| all.iter().map(|c| black_box(closed_form(*c)).iter().flatten().count()).sum::<usize>());
    // how far off the closed form is, by a step of Newton's method
    let off = all.iter().flat_map(|c| {
        closed_form(*c).into_iter().flatten().map(|t| {
            let (value, slope) = (c[0] + t * (c[1] + t * (c[2] + t * c[3])), c[1] + t * (2.0 * c[2] + t * 3.0 * c[3]));
            (value / slope).abs()
        })
    });
    let worst = off.fold(0.0, f64::max);
    println!(
        "{count} cubics over [0, 1], one thread: bracketed Newton {numeric:.1} ms, {found} roots; closed form {closed:.1} ms, {roots} roots, off \
         by up to {worst:.1e}."
    );
}

fn closed_form([d, c, b, a]: [f64; 4]) -> [Option<f64>; 3] {
    let (b, c, d) = (b / a, c / a, d / a);
    let (p, q) = (c - b * b / 3.0, 2.0 * b * b * b / 27.0 - b * c / 3.0 + d);
    let shift = -b / 3.0;
    let within = |t: f64| Some(t).filter(|t| (0.0..=1.0).contains(t));
    let inner = q * q / 4.0 + p * p * p / 27.0;
    if inner > 0.0 {
        let root = inner.sqrt();
        let u = (-q / 2.0 - q.signum() * root).cbrt();
        return [within(shift + u - p / (3.0 * u)), None, None];
    }
    let r = 2.0 * (-p / 3.0).sqrt();
    let angle = (3.0 * q / (p * r)).clamp(-1.0, 1.0).acos() / 3.0;
    [0.0, 1.0, 2.0].map(|k| within(shift + r * (angle - k * std::f64::consts::TAU / 3.0).cos()))
}
