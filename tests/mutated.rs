//! Runs the program on mutated files: every run ends in time with exit code 0, 1 or 2, without a signal or a panic. An error is one line.
//! Outputs are whole, and no other files are left.
//!
//! `ANAMORPH_FUZZ=20000 cargo test --test mutated` runs 20,000 mutations. Cases that fail are kept in
//! `target/tmp/mutated`.

#[path = "../fuzz/mutations.rs"]
mod mutations;

use anamorph::internals::input::Loading;
use mutations::{Names, Rng, changed, corpus};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Most time of a run, at 64 x 48 pixels.
const MOST: Duration = Duration::from_secs(20);

/// Limit of the address space of a run in KiB: a run cannot take the memory of the others, and out-of-memory is tested.
const ADDRESSES_KIB: u64 = 4_000_000;

/// One run in so many renders on the adapter, which is slow to open. The others use the reference.
const COMPUTE: usize = 16;

fn rounds() -> usize {
    std::env::var("ANAMORPH_FUZZ").ok().and_then(|n| n.parse().ok()).unwrap_or(48)
}

/// A kind of file: the folder of its corpus, its name, the scene that reads it, and the command.
struct Target {
    corpus: &'static str,
    file: &'static str,
    scene: &'static str,
    args: &'static [&'static str],
}

const RENDER: &[&str] = &["render", "scene.toml", "-o", "out.png", "--exr", "out.exr", "--size", "64x48"];
const CAMERA: &[&str] = &["camera", "scene.toml", "--rays", "out.npy"];
const PINHOLE: &str = "[camera]\nkind = \"pinhole\"\neye = [0.2, 0.4, 5]\ntarget = [0, 0, 0]\nvfov = 40\n";

const TARGETS: [Target; 11] = [
    Target { corpus: "scene", file: "scene.toml", scene: "", args: RENDER },
    Target { corpus: "camera", file: "camera", scene: "", args: RENDER },
    Target { corpus: "obj", file: "mesh.obj", scene: "[[mesh]]\nfile = \"mesh.obj\"\n", args: RENDER },
    Target { corpus: "ply", file: "mesh.ply", scene: "[[mesh]]\nfile = \"mesh.ply\"\n", args: RENDER },
    Target { corpus: "stl", file: "mesh.stl", scene: "[[mesh]]\nfile = \"mesh.stl\"\n", args: RENDER },
    Target { corpus: "mtl", file: "m.mtl", scene: "[[mesh]]\nfile = \"of_m.obj\"\n", args: RENDER },
    Target { corpus: "gltf", file: "mesh.gltf", scene: "[[mesh]]\nfile = \"mesh.gltf\"\n", args: RENDER },
    Target {
        corpus: "npy",
        file: "a.npy",
        scene: "[camera]\nkind = \"raymap\"\norigins = \"a.npy\"\ndirections = \"a.npy\"\n",
        args: CAMERA,
    },
    Target {
        corpus: "calibration",
        file: "lens.yml",
        scene: "[camera]\nkind = \"calibrated\"\nfile = \"lens.yml\"\neye = [0, 0, 3]\ntarget = [0, 0, 0]\n",
        args: CAMERA,
    },
    Target {
        corpus: "jobs",
        file: "jobs",
        scene: "[[mesh]]\nbuiltin = \"box\"\n",
        args: &["batch", "jobs", "--gather"],
    },
    Target {
        corpus: "manifest",
        file: "list.toml.manifest.jsonl",
        scene: "[[mesh]]\nbuiltin = \"box\"\n",
        args: &["batch", "list.toml", "--resume"],
    },
];

/// The list of the manifests in the corpus.
const LIST: &str = "[[job]]\nscene = \"scene.toml\"\ncolor = \"a-{frame}.png\"\nframes = { last = 1 }\nsize = \"16x12\"\nengine = \"reference\"\n";

/// Writes a case to a folder three levels below `dir`, so that paths with `..` stay in `dir`. Returns the folder and the command line.
fn lay_out(dir: &Path, target: &Target, data: &[u8]) -> (PathBuf, Vec<String>) {
    let folder = dir.join("a/b/c");
    std::fs::create_dir_all(&folder).unwrap();
    let write = |name: &str, text: &[u8]| std::fs::write(folder.join(name), text).unwrap();
    let camera = if target.scene.contains("[camera]") { "" } else { PINHOLE };
    // a ray map and a lens have sizes of their own
    let size = if target.args == CAMERA { "" } else { "[image]\nwidth = 64\nheight = 48\n" };
    write("scene.toml", format!("{size}{}{camera}", target.scene).as_bytes());
    write("of_m.obj", b"mtllib m.mtl\nusemtl red\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n");
    write("list.toml", LIST.as_bytes());
    #[cfg(unix)]
    Command::new("mkfifo").arg(folder.join("fifo")).arg(folder.join("fifo.obj")).status().unwrap();
    let is_json = data.trim_ascii_start().first() == Some(&b'{');
    let name = match (target.file, is_json) {
        ("camera", _) => "scene.toml",
        ("jobs", true) if data.contains(&b'\n') => "jobs.jsonl",
        ("jobs", true) => "jobs.json",
        ("jobs", false) => "jobs.toml",
        ("scene.toml", true) => "scene.json",
        ("mesh.gltf", _) if data.starts_with(b"glTF") => "mesh.glb",
        (name, _) => name,
    };
    match target.file {
        "camera" => {
            let image = b"image = { width = 64, height = 48 }\nmesh = [{ builtin = \"box\" }]\n[camera]\n";
            write(name, &[image, data].concat());
        }
        _ => write(name, data),
    }
    if name == "mesh.glb" {
        write(
            "scene.toml",
            format!("[image]\nwidth = 64\nheight = 48\n[[mesh]]\nfile = \"mesh.glb\"\n{PINHOLE}").as_bytes(),
        );
    }
    let args = target.args.iter().map(|arg| match *arg {
        "scene.toml" if name == "scene.json" => name.to_owned(),
        "jobs" => name.to_owned(),
        arg => arg.to_owned(),
    });
    (folder, args.collect())
}

/// Runs the program; `None` if it takes longer than `most`.
fn run(folder: &Path, args: &[String], most: Duration) -> Option<Output> {
    let program = env!("CARGO_BIN_EXE_anamorph");
    let mut command = Command::new(if cfg!(unix) { "sh" } else { program });
    if cfg!(unix) {
        command.args(["-c", &format!("ulimit -v {ADDRESSES_KIB}; exec \"$0\" \"$@\""), program]);
    }
    let file = |name: &str| std::fs::File::create(folder.join(name)).unwrap();
    let streams = folder.parent().unwrap();
    let mut child = command
        .args(args)
        .current_dir(folder)
        .stdin(Stdio::null())
        .stdout(file("../stdout"))
        .stderr(file("../stderr"))
        .spawn()
        .unwrap();
    let started = Instant::now();
    loop {
        if let Some(status) = child.try_wait().unwrap() {
            let read = |name: &str| std::fs::read(streams.join(name)).unwrap();
            return Some(Output { status, stdout: read("stdout"), stderr: read("stderr") });
        }
        if started.elapsed() > most {
            child.kill().unwrap();
            child.wait().unwrap();
            return None;
        }
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// What is wrong with a run; `None` if nothing is.
fn fault(folder: &Path, args: &[String], output: Option<Output>) -> Option<String> {
    let Some(output) = output else { return Some(format!("not done within {MOST:?}")) };
    // long work prints lines of progress too
    let stderr = String::from_utf8_lossy(&output.stderr);
    let said = stderr.lines().filter(|line| !line.starts_with("progress: ")).collect::<Vec<_>>().join("\n");
    let Some(code @ 0..=2) = output.status.code() else { return Some(format!("{}: {said}", output.status)) };
    if ["panicked", "internal error", "backtrace", "stack overflow"].iter().any(|word| said.contains(word)) {
        return Some(said);
    }
    let is_batch = args[0] == "batch";
    // a batch prints a line for each frame that fails
    let lines = said.lines().count();
    if code != 0 && !is_batch && (lines != 1 || !said.starts_with("error: ")) {
        return Some(format!("exit code {code} with {lines} lines: {said}"));
    }
    let names = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().to_string_lossy().into_owned());
    for name in names {
        if name.starts_with(".anamorph") || name.ends_with(".tmp") {
            return Some(format!("{name} is left"));
        }
        if !name.starts_with("out.") {
            continue;
        }
        if code != 0 {
            return Some(format!("exit code {code}, but {name} is there: {said}"));
        }
        let bytes = std::fs::read(folder.join(&name)).unwrap();
        let is_whole = match name.as_str() {
            "out.png" => bytes.ends_with(b"IEND\xaeB`\x82"),
            "out.exr" => anamorph::internals::image::read_exr(&folder.join(&name), &Loading::default()).is_ok(),
            _ => bytes.starts_with(b"\x93NUMPY"),
        };
        if !is_whole {
            return Some(format!("{name} is not whole"));
        }
    }
    None
}

/// Runs a case and returns its fault. A case that takes too long is run again, one at a time, in case the machine was busy.
fn judge(target: &Target, data: &[u8], on_adapter: bool, alone: &Mutex<()>) -> Option<String> {
    for attempt in 0..2 {
        let dir = tempfile::tempdir().unwrap();
        let (folder, mut args) = lay_out(dir.path(), target, data);
        if args[0] == "render" && !on_adapter {
            args.extend(["--engine".to_owned(), "reference".to_owned()]);
        }
        let lock = (attempt == 1).then(|| alone.lock().unwrap_or_else(PoisonError::into_inner));
        let output = run(&folder, &args, MOST);
        drop(lock);
        if output.is_some() || attempt == 1 {
            return fault(&folder, &args, output);
        }
    }
    None
}

fn keep(target: &Target, k: usize, data: &[u8]) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("mutated");
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join(format!("{}-{k}", target.corpus));
    std::fs::write(&path, data).unwrap();
    path
}

/// Runs all cases on all processors. Those that fail are kept, and named at the end.
fn run_all(cases: usize, case: impl Fn(usize) -> (usize, Vec<u8>) + Sync) {
    let (next, alone, faults) = (AtomicUsize::new(0), Mutex::new(()), Mutex::new(Vec::new()));
    let work = || {
        loop {
            let k = next.fetch_add(1, Ordering::Relaxed);
            if k >= cases {
                return;
            }
            let (n, data) = case(k);
            let target = &TARGETS[n];
            if let Some(fault) = judge(target, &data, k % COMPUTE == 0, &alone) {
                let line = format!("{}: {}", keep(target, k, &data).display(), fault.trim_end());
                println!("{line}");
                faults.lock().unwrap_or_else(PoisonError::into_inner).push(line);
            }
        }
    };
    let threads = std::thread::available_parallelism().map_or(1, |n| n.get());
    std::thread::scope(|scope| (0..threads).for_each(|_| drop(scope.spawn(work))));
    let faults = faults.into_inner().unwrap_or_else(PoisonError::into_inner);
    assert!(faults.is_empty(), "{} of {cases} cases:\n{}", faults.len(), faults.join("\n"));
}

#[test]
#[ignore = "slow: make test-all"]
fn cases_that_once_failed_pass() {
    let all: Vec<(usize, Vec<u8>)> =
        (0..TARGETS.len()).flat_map(|n| corpus(TARGETS[n].corpus).into_iter().map(move |data| (n, data))).collect();
    run_all(all.len(), |k| all[k].clone());
}

#[test]
fn mutated_files_are_refused_or_rendered() {
    let all: Vec<Vec<Vec<u8>>> = TARGETS.iter().map(|target| corpus(target.corpus)).collect();
    run_all(rounds(), |k| {
        let mut rng = Rng(k as u64 ^ 0x5eed);
        let n = rng.below(TARGETS.len());
        (n, changed(&all[n], Names::Replaced, &mut rng))
    });
}
