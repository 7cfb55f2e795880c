//! Outputs that would replace other files, and those that may be replaced.

use super::program::{Place, SCENE};
#[cfg(unix)]
use super::program::{Ran, assert_one_line};
#[cfg(unix)]
use crate::PROGRAM;
use std::collections::BTreeMap;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// A mesh with a material and an image, scenes with a lidar and with a camera of pieces, and a list of points.
fn place() -> Place {
    let place = Place::new();
    place.write(
        "m.obj",
        "mtllib m.mtl\nv -1 -1 0\nv 1 -1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl a\nf 1/1 2/2 3/3\n",
    );
    place.write("m.mtl", "newmtl a\nKd 1 1 1\nmap_Kd t.png\n");
    place.write("mesh.toml", SCENE.replace("builtin = \"icosphere\"\nlevel = 2", "file = \"m.obj\""));
    place.works(&["render", "scene.toml", "-o", "t.png", "--engine", "reference", "--size", "8x8"]);
    place.works(&["camera", "scene.toml", "--rays", "r.npy", "--export", "c.json", "--size", "8x6"]);
    let head = SCENE.split("[camera]").next().unwrap();
    place.write("pieces.toml", format!("{head}[camera]\nkind = \"mesh\"\nfile = \"c.json\"\n"));
    place.write("ply.toml", "[[mesh]]\nfile = \"m.obj\"\n[camera]\nkind = \"lidar\"\nfile = \"l.npy\"\n");
    let numbers: Vec<f64> = (0..12).map(f64::from).collect();
    anamorph::internals::image::write_npy_f64(&place.path().join("l.npy"), &[2, 6], &numbers).unwrap();
    place.write("p.csv", "0 0 0\n");
    place
}

/// All files and what they hold; for a link, the file that it leads to.
fn files(place: &Place) -> BTreeMap<String, Vec<u8>> {
    let read = |name: &String| std::fs::read(place.path().join(name)).unwrap_or_default();
    place.names().into_iter().map(|name| (name.clone(), read(&name))).collect()
}

/// Runs and expects exit code 2, one line with `says`, and all files unchanged.
fn keeps(place: &Place, args: &[&str], says: &str) {
    let before = files(place);
    place.refuses(args, 2, says);
    assert!(files(place) == before, "{args:?}");
}

#[test]
fn inputs_are_never_replaced() {
    let place = place();
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("t.png", place.path().join("soft.png")).unwrap();
        std::fs::hard_link(place.path().join("t.png"), place.path().join("hard.png")).unwrap();
        std::os::unix::fs::symlink(".", place.path().join("here")).unwrap();
    }
    let render = ["render", "mesh.toml", "--engine", "reference", "-o", "new.png"];
    for args in [
        &["-o", "m.obj"][..],
        &["-o", "t.png"],
        #[cfg(unix)]
        &["-o", "soft.png"],
        #[cfg(unix)]
        &["-o", "hard.png"],
        #[cfg(unix)]
        &["-o", "here/t.png"],
        &["-o", "./here/./t.png"],
        &["--exr", "m.mtl"],
        &["--report", "mesh.toml"],
        &["--points", "m.obj"],
    ] {
        let given = if args[0] == "-o" { &render[..4] } else { &render[..] };
        keeps(&place, &[given, args].concat(), "is also an input");
    }
    let lidar = ["render", "ply.toml", "--engine", "reference", "--points"];
    keeps(&place, &[&lidar[..], &["l.npy"]].concat(), "l.npy: is also an input; choose another name for the output");
    for (flag, file) in [("--rays", "l.npy"), ("--export", "m.obj"), ("--diagram", "ply.toml")] {
        keeps(&place, &["camera", "ply.toml", flag, file], "is also an input");
    }
    // a camera does not read the images that colour meshes
    keeps(&place, &["camera", "ply.toml", "--rays", "t.png"], "t.png: exists and is not a NumPy array");
    keeps(&place, &["camera", "pieces.toml", "--export", "c.json"], "is also an input");
    keeps(&place, &["project", "scene.toml", "--points", "p.csv", "-o", "p.csv"], "is also an input");
    keeps(&place, &["project", "mesh.toml", "--points", "p.csv", "-o", "m.obj"], "is also an input");
}

#[test]
fn a_batch_replaces_nothing_that_it_reads() {
    let place = place();
    let job = |keys: &str| format!("[[job]]\nscene = \"mesh.toml\"\nsize = \"8x6\"\nengine = \"reference\"\n{keys}\n");
    let other = "[[job]]\nscene = \"scene.toml\"\nsize = \"8x6\"\nengine = \"reference\"\n";
    place.write("my.json", "{}");
    let reads = ", an input; choose another name for the output";
    for (list, flags, says) in [
        (job("color = \"j.toml\""), &[][..], "j.toml: exists and is not a PNG"),
        (job("color = \"t.png\""), &[], "job.0, frame 0 would replace "),
        (job("exr = \"m.obj\""), &[], "m.obj: exists and is not an EXR"),
        (job("color = \"j.toml.manifest.jsonl\""), &[], "writes this file too"),
        // an input of another job
        (format!("{other}color = \"t.png\"\n{}", job("color = \"a.png\"")), &[], reads),
        (job("color = \"a.png\""), &["--csv", "j.toml"], reads),
        (job("color = \"a.png\""), &["--csv", "mesh.toml"], "is not a table"),
        (job("color = \"a.png\""), &["--report", "m.obj"], "is not a report"),
        (job("color = \"a.png\""), &["--log", "m.mtl"], "is not a log"),
        (job("color = \"a.png\""), &["--log", "a.png"], "job.0, frame 0 writes this file too"),
        (job("color = \"a.png\""), &["--csv", "a", "--log", "./a"], "another output writes this file too"),
        (job("color = \"a.png\""), &["--csv", "a", "--report", "a"], "another output writes this file too"),
        (job("color = \"a.png\""), &["--csv", "j.toml.manifest.jsonl"], "another output writes this file too"),
        (job("color = \"a.png\""), &["--gather", "--csv", "j.toml"], reads),
        (job("color = \"a.png\""), &["--gather", "--report", "m.obj"], "is not a report"),
        (job("color = \"x.png\"\nexr = \"./x.png\""), &[], "both write"),
    ] {
        place.write("j.toml", &list);
        keeps(&place, &[&["batch", "j.toml"], flags].concat(), says);
    }
    // a report and a file of pieces have the same extension
    place.write("j.toml", other.replace("scene.toml", "pieces.toml") + "color = \"a.png\"\n");
    keeps(&place, &["batch", "j.toml", "--report", "c.json"], reads);
    keeps(&place, &["batch", "--write-driver", "mesh.toml"], "is not a driver");
    place.write("mine.toml.manifest.jsonl", "{\"scene\": \"scene.toml\"}\n");
    place.write("mine.toml", job("color = \"a.png\""));
    keeps(&place, &["batch", "mine.toml"], "mine.toml.manifest.jsonl: exists and is not a manifest");
}

#[test]
fn a_scene_names_outputs_in_its_own_folder_only() {
    let place = Place::new();
    std::fs::create_dir(place.path().join("got")).unwrap();
    place.write("bashrc", "alias ls=ls\n");
    place.write("got/profile", "mine\n");
    let absolute = place.path().join("bashrc").display().to_string();
    let render = ["render", "got/s.toml", "--engine", "reference"];
    let outside = "got/s.toml: [output] names a file outside of the scene's folder";
    for (name, says) in [
        ("../bashrc", outside),
        (absolute.as_str(), outside),
        ("../new.png", outside),
        ("/dev/null", outside),
        ("profile", "profile: exists and is not a PNG"),
    ] {
        place.write("got/s.toml", format!("{SCENE}[output]\ncolor = \"{name}\"\n"));
        keeps(&place, &render, says);
        // an output on the command line takes the place of the scene's
        place.works(&[&render[..], &["-o", "own.png"]].concat());
        std::fs::remove_file(place.path().join("own.png")).unwrap();
    }
    place.write("got/s.toml", format!("{SCENE}[output]\ncolor = \"none/new.png\"\n"));
    place.refuses(&render, 1, "does not exist; create it first");
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("..", place.path().join("got/in")).unwrap();
        place.write("got/s.toml", format!("{SCENE}[output]\nexr = \"in/new.exr\"\n"));
        keeps(&place, &render, outside);
    }
    place.write("got/s.toml", format!("{SCENE}[output]\ncolor = \"../new.png\"\n"));
    place.works(&[&render[..], &["--outputs-anywhere"]].concat());
    assert!(place.names().contains(&"new.png".to_owned()));
    place.write("got/s.toml", format!("{SCENE}[output]\ncolor = \"../bashrc\"\n"));
    keeps(&place, &[&render[..], &["--outputs-anywhere"]].concat(), "bashrc: exists and is not a PNG");
}

#[test]
fn outputs_of_an_earlier_run_are_replaced() {
    let place = place();
    for _ in 0..2 {
        let outputs = ["-o", "picture", "--exr", "data", "--report", "told", "--points", "p.ply"];
        place.works(&[&["render", "mesh.toml", "--engine", "reference"], &outputs[..]].concat());
        place.works(&[
            "camera",
            "pieces.toml",
            "--export",
            "e",
            "--rays",
            "f",
            "--diagram",
            "g",
            "--export-povray",
            "h",
            "--size",
            "8x6",
        ]);
        place.works(&["project", "scene.toml", "--points", "p.csv", "-o", "i"]);
        place.works(&["batch", "--write-driver", "driver"]);
        let job = "[[job]]\nscene = \"mesh.toml\"\ncolor = \"{frame}\"\nreport = \"r{frame}\"\nsize = \"8x6\"\n";
        place.write("j.toml", format!("{job}engine = \"reference\"\nframes = {{ last = 2 }}\n"));
        let batch = ["batch", "j.toml", "--csv", "table", "--report", "all", "--log", "log"];
        assert_eq!(place.works(&batch), "j.toml: 3 frames\n");
        assert_eq!(place.works(&[&batch[..], &["--resume"]].concat()), "j.toml: 0 frames, 3 before\n");
        assert_eq!(place.works(&["batch", "j.toml", "--gather", "--csv", "table"]), "j.toml: 3 frames\n");
        // any file with the right extension may be replaced, and any empty file
        place.write("data.exr", "mine");
        place.write("picture", "");
        place.works(&["render", "mesh.toml", "--engine", "reference", "--exr", "data.exr", "-o", "picture"]);
    }
    assert_eq!(std::fs::read_to_string(place.path().join("log")).unwrap().matches("start: ").count(), 4);
    // an example replaces only files that are the same
    place.works(&["example", "deformation"]);
    place.works(&["example", "deformation"]);
    place.write("deformation.npy", "mine");
    place.refuses(&["example", "deformation"], 1, "exists with other content");
}

/// Waits for a program that should end, and kills it after `most`.
pub fn waits(mut child: std::process::Child, most: Duration) -> Option<std::process::Output> {
    let started = Instant::now();
    while child.try_wait().unwrap().is_none() {
        if started.elapsed() > most {
            child.kill().unwrap();
            child.wait().unwrap();
            return None;
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    Some(child.wait_with_output().unwrap())
}

#[cfg(unix)]
#[test]
#[ignore = "slow: make test-all"]
fn devices_and_pipes_are_written_to() {
    let place = Place::new();
    let render = ["render", "scene.toml", "--engine", "reference", "--size", "8x6"];
    place.works(&[&render[..], &["-o", "/dev/null", "--exr", "/dev/null"]].concat());
    place.works(&[&render[..], &["-o", "own.png"]].concat());
    let own = std::fs::read(place.path().join("own.png")).unwrap();
    let output = place.command(&[&render[..], &["-o", "/dev/stdout"]].concat()).output().unwrap();
    assert!(output.status.success() && output.stdout.starts_with(&own));
    assert!(Command::new("mkfifo").arg(place.path().join("pipe")).status().unwrap().success());
    let reader = std::fs::canonicalize(place.path()).unwrap().join("pipe");
    let reader = std::thread::spawn(move || std::fs::read(reader).unwrap());
    place.works(&[&render[..], &["-o", "pipe"]].concat());
    assert!(reader.join().unwrap() == own);
    // without a reader the program ends too
    let mut command = place.command(&[&render[..], &["-o", "pipe"]].concat());
    let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let output = waits(child, Duration::from_secs(120)).expect("it does not end");
    let err = String::from_utf8(output.stderr).unwrap();
    assert!(
        output.status.code() == Some(1) && err.contains("pipe: cannot be written: it is a pipe, and no process"),
        "{err}"
    );
}

#[cfg(unix)]
#[test]
fn a_manifest_that_names_an_endless_file_does_not_hang() {
    let place = Place::new();
    let job = "[[job]]\nscene = \"scene.toml\"\ncolor = \"{frame}.png\"\nframes = { last = 1 }\nsize = \"8x6\"\n";
    place.write("j.toml", format!("{job}engine = \"reference\"\n"));
    place.works(&["batch", "j.toml"]);
    let manifest = std::fs::read_to_string(place.path().join("j.toml.manifest.jsonl")).unwrap();
    let resume = || {
        let mut command = place.command(&["batch", "j.toml", "--resume"]);
        let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let output = waits(child, Duration::from_secs(120)).expect("it does not end");
        let text = |bytes| String::from_utf8(bytes).unwrap();
        (output.status.code(), text(output.stdout), text(output.stderr))
    };
    assert!(Command::new("mkfifo").arg(place.path().join("pipe")).status().unwrap().success());
    for (was, is) in [
        ("\"scene.toml\":\"", "\"/dev/zero\":\""),
        ("\"scene.toml\":\"", "\"pipe\":\""),
        ("\"outputs\":{\"0.png\"", "\"outputs\":{\"/dev/zero\""),
        ("\"outputs\":{\"0.png\"", "\"outputs\":{\"0.png\":{\"bytes\":0,\"hash\":\"\"},\"pipe\""),
    ] {
        assert!(manifest.contains(was), "{manifest}");
        place.write("j.toml.manifest.jsonl", manifest.replace(was, is));
        let (code, out, err) = resume();
        assert!(code == Some(0) && !out.contains(" 0 frames, 2 before"), "{out}{err}");
    }
    std::fs::remove_file(place.path().join("j.toml.manifest.jsonl")).unwrap();
    std::os::unix::fs::symlink("/dev/zero", place.path().join("j.toml.manifest.jsonl")).unwrap();
    let (code, _, err) = resume();
    assert!(code == Some(2) && err.contains("is not a regular file, so it cannot be a manifest"), "{err}");
}

/// A manifest of an earlier version, which also has the times of outputs, is still valid.
#[test]
fn an_old_manifest_is_read() {
    let place = Place::new();
    place.write(
        "j.toml",
        "[[job]]\nscene = \"scene.toml\"\ncolor = \"a.png\"\nsize = \"8x6\"\nengine = \"reference\"\n",
    );
    place.works(&["batch", "j.toml"]);
    let manifest = std::fs::read_to_string(place.path().join("j.toml.manifest.jsonl")).unwrap();
    let old = manifest.replace("\"hash\":", "\"modified_ns\":1,\"hash\":");
    assert_ne!(old, manifest);
    place.write("j.toml.manifest.jsonl", old);
    assert_eq!(place.works(&["batch", "j.toml", "--resume"]), "j.toml: 0 frames, 1 before\n");
}

/// The program under a limit of the shell, as `-v 500000`.
#[cfg(unix)]
pub fn limited(place: &Place, limit: &str, args: &[&str]) -> Command {
    let mut shell = Command::new("sh");
    shell.args(["-c", &format!("ulimit {limit}; exec \"$0\" \"$@\""), PROGRAM]).args(args);
    shell.current_dir(place.path()).stdin(Stdio::null());
    shell
}

/// A limit on the size of files ends a write as a full disk does, not the program.
#[cfg(unix)]
#[test]
fn files_over_the_limit_of_the_shell_are_refused_in_a_line() {
    let place = Place::new();
    let (png, exr) = (["-o", "o.png"], ["--exr", "o.exr"]);
    for output in [png, exr] {
        // blocks of 512 or 1024 bytes, fewer than either file has
        let args = [&["render", "scene.toml", "--engine", "reference", "--size", "640x480"], &output[..]].concat();
        let ran = Ran::of(limited(&place, "-f 1", &args).output().unwrap());
        assert_one_line(&ran, output[1]);
        assert!(ran.code == 1 && ran.err.contains("raise the limit on the size of files (ulimit -f)"), "{}", ran.err);
        assert_eq!(place.names(), ["scene.toml"]);
    }
}

/// The file that a link leads to is written, and nothing is left beside either.
#[cfg(unix)]
#[test]
fn a_link_as_output_stays_one_and_leaves_nothing_beside_it() {
    let place = Place::new();
    std::fs::create_dir(place.path().join("real")).unwrap();
    std::os::unix::fs::symlink("real/o.png", place.path().join("link.png")).unwrap();
    for _ in ["a new file", "a file that is there"] {
        place.works(&["render", "scene.toml", "--engine", "reference", "-o", "link.png"]);
        assert_eq!(place.names(), ["link.png", "real", "scene.toml"]);
        let real: Vec<_> =
            std::fs::read_dir(place.path().join("real")).unwrap().map(|e| e.unwrap().file_name()).collect();
        assert_eq!(real, ["o.png"]);
        assert!(std::fs::symlink_metadata(place.path().join("link.png")).unwrap().is_symlink());
    }
}

/// Whether this process ignores a signal, which its children inherit; false if the system does not say.
#[cfg(unix)]
fn is_ignored(signal: i32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    mask.and_then(|m| u64::from_str_radix(m.trim(), 16).ok()).is_some_and(|m| m >> (signal - 1) & 1 == 1)
}

/// A program that is ended while it writes a file removes it, and its exit status names the signal.
#[cfg(unix)]
#[test]
fn an_interrupted_program_leaves_no_temporary_file() {
    use std::os::unix::process::ExitStatusExt;
    let place = Place::new();
    if !place.has_adapter() {
        return;
    }
    let is_temporary = |name: &String| name.starts_with(".anamorph-");
    for (name, number) in [("INT", 2), ("TERM", 15), ("HUP", 1)] {
        // as it is in the background of a shell, or under nohup
        if is_ignored(number) {
            println!("SIG{name} is ignored here, and so by the program");
            continue;
        }
        // written strip by strip as it is rendered
        let args = ["render", "scene.toml", "--exr", "large.exr", "--size", "16384x8192", "--channels", "Z"];
        let mut child = place.command(&args).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        let started = Instant::now();
        // five times in a row: the check that the folder is writable has a temporary file for a moment only
        let mut seen = 0;
        while seen < 5 {
            assert!(child.try_wait().unwrap().is_none(), "it ended before it was ended");
            assert!(started.elapsed() < Duration::from_secs(300));
            std::thread::sleep(Duration::from_millis(20));
            seen = if place.names().iter().any(is_temporary) { seen + 1 } else { 0 };
        }
        let id = child.id().to_string();
        assert!(Command::new("kill").args(["-s", name, &id]).status().unwrap().success());
        assert_eq!(child.wait().unwrap().signal(), Some(number), "{name}");
        assert_eq!(place.names(), ["scene.toml"], "{name}");
    }
}
