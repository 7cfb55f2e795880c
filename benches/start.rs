//! Times what comes before frames: reading a large OBJ file, and the whole program from its start to a PNG: `cargo bench --bench start`. `cargo test --benches` runs each once, on little.

use anamorph::internals::geometry::obj;
use anamorph::internals::geometry::texture::Images;
use anamorph::internals::gpu::device::NO_ADAPTER;
use anamorph::internals::gpu::{Gpu, GpuOptions};
use anamorph::internals::input::Loading;
use anamorph::internals::tools::example::EXAMPLES;
use criterion::{Criterion, Throughput};
use std::fmt::Write;
use std::process::Command;

/// Of the OBJ text.
const BYTES: usize = 100 << 20;

/// Times that the program is started.
const STARTS: usize = 10;

fn main() -> anamorph::internals::input::Result<()> {
    let bench = std::env::args().any(|a| a == "--bench");
    let mut criterion = Criterion::default().sample_size(STARTS).configure_from_args();
    let folder = tempfile::tempdir()
        .map_err(|e| anamorph::internals::input::Error::work(format!("no temporary folder: {e}")))?;
    load(&mut criterion, folder.path(), if bench { BYTES } else { BYTES / 1000 })?;
    match Gpu::open(&GpuOptions::default())? {
        Some(_) => first_picture(&mut criterion, folder.path())?,
        None => println!("skipped: {NO_ADAPTER}"),
    }
    criterion.final_summary();
    Ok(())
}

/// A file with texture coordinates, from the system's cache of it.
fn load(criterion: &mut Criterion, folder: &std::path::Path, bytes: usize) -> anamorph::internals::input::Result<()> {
    let path = folder.join("terrain.obj");
    let text = terrain(bytes);
    std::fs::write(&path, &text)
        .map_err(|e| anamorph::internals::input::Error::work(format!("{}: {e}", path.display())))?;
    let mut group = criterion.benchmark_group("load");
    group.throughput(Throughput::Bytes(text.len() as u64));
    group.bench_function("obj", |bencher| {
        bencher.iter(|| obj::load(&path, &mut Images::left_out(), &Loading::default()).expect("a file as above"))
    });
    group.finish();
    Ok(())
}

/// Squares of two triangles each, as files have them: six digits, indices into positions, texture coordinates and normals.
fn terrain(bytes: usize) -> String {
    // of a vertex and its two triangles
    const BYTES_EACH: usize = 150;
    let side = (bytes / BYTES_EACH).isqrt().max(2);
    let mut text = String::with_capacity(bytes + bytes / 8);
    for k in 0..side * side {
        let (x, z) = ((k % side) as f64, (k / side) as f64);
        let height = (0.37 * x).sin() * (0.23 * z).cos();
        let (u, v) = (x / side as f64, z / side as f64);
        // writing to a String cannot fail
        let _ = write!(text, "v {:.6} {height:.6} {:.6}\nvt {u:.6} {v:.6}\n", 0.1 * x, -0.1 * z);
    }
    text += "vn 0 1 0\n";
    let corner = |k: usize| format!("{k}/{k}/1");
    for k in (1..side * (side - 1)).filter(|k| k % side != 0) {
        let [a, b, c, d] = [k, k + 1, k + side, k + side + 1].map(corner);
        let _ = write!(text, "f {a} {b} {c}\nf {b} {d} {c}\n");
    }
    text
}

/// 15,000 triangles at 800 x 600.
fn first_picture(criterion: &mut Criterion, folder: &std::path::Path) -> anamorph::internals::input::Result<()> {
    let Some(example) = EXAMPLES.iter().find(|e| e.name == "city-cross-slit") else {
        return Err(anamorph::internals::input::Error::input("there is no example city-cross-slit"));
    };
    let scene = example.write(folder)?;
    let start = || {
        let mut program = Command::new(env!("CARGO_BIN_EXE_anamorph"));
        program.arg("render").arg(&scene).args(["--set", "image.width=800", "--set", "image.height=600", "--output"]);
        let done = program.arg(folder.join("first.png")).output().expect("the program starts");
        assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    };
    // what drivers keep is there from the second on
    start();
    criterion.bench_function("first picture", |bencher| bencher.iter(start));
    Ok(())
}
