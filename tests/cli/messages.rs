//! Notes and progress on stderr, and how names are printed.

use super::program::{Place, SCENE, assert_one_line};
use std::io::{BufRead, BufReader};
use std::process::Stdio;

#[test]
fn control_characters_in_names_are_escaped() {
    let place = Place::new();
    let name = "\u{1b}[31mred\u{7}\u{9b}1m";
    let ran = place.run(&["render", &format!("{name}.toml"), "-o", "a.png"]);
    assert_one_line(&ran, "a name");
    assert!(ran.code == 2 && ran.err.contains("\\u001b[31mred\\u0007\\u009b1m.toml: cannot be read"), "{:?}", ran.err);
    place.write("s.toml", SCENE.replace("kind = \"pinhole\"", "kind = \"pin\\u0000\\u001b[2J\""));
    let ran = place.run(&["render", "s.toml", "-o", "a.png"]);
    assert_one_line(&ran, "a value");
    assert!(!ran.err.contains(['\0', '\u{1b}']), "{:?}", ran.err);
    // also in notes
    place.write("q.obj", "mtllib q.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n");
    place.write("q.mtl", "newmtl m\nmap_Kd \u{1b}[31mno.png\n");
    place.write("q.toml", SCENE.replace("builtin = \"icosphere\"\nlevel = 2", "file = \"q.obj\""));
    let ran = place.run(&["render", "q.toml", "-o", "q.png", "--engine", "reference"]);
    assert!(ran.code == 0 && ran.err.starts_with("left out: \\u001b[31mno.png ("), "{:?}", ran.err);
    // and on stdout
    let out = place.works(&["render", "scene.toml", "-o", &format!("{name}.png"), "--engine", "reference"]);
    assert!(out.starts_with("\\u001b[31mred\\u0007\\u009b1m.png 64x48"), "{out:?}");
}

/// Notes leave the exit code 0.
#[test]
fn a_picture_of_nothing_and_coarse_positions_are_said_in_a_line() {
    let place = Place::new();
    let render = ["render", "scene.toml", "--engine", "reference", "--strict"];
    let said = |more: &[&str]| {
        let ran = place.run(&[&render[..], more].concat());
        assert_eq!(ran.code, 0, "{}", ran.err);
        ran.err
    };
    let away = ["--set", "camera.target=[0, 0.5, 8]"];
    for output in [["-o", "o.png"], ["--exr", "o.exr"]] {
        let err = said(&[&output[..], &away].concat());
        let start = "no pixel shows a surface: the scene lies from (-1, -1, -1) to (1, 1, 1), behind the camera; ";
        assert!(err.starts_with(start) && err.lines().count() == 1, "{err}");
        assert_eq!(said(&output), "");
    }
    let far = ["--set", "mesh.0.translate=[0, 0, 6000000]", "--set", "camera.eye=[0, 0, 6000004]"];
    let far = [&far[..], &["--set", "camera.target=[0, 0, 6000000]", "--exr", "o.exr"]].concat();
    let err = said(&[&far[..], &["--channels", "P,Z"]].concat());
    assert!(err.starts_with("P has steps of 5.0e-1, as f32") && err.lines().count() == 1, "{err}");
    assert_eq!(said(&[&far[..], &["--channels", "Z"]].concat()), "");
}

#[test]
fn long_lines_are_shortened() {
    let place = Place::new();
    place.write("s.toml", format!("{SCENE}[output]\n{} = 1\n", "x".repeat(100_000)));
    let ran = place.run(&["render", "s.toml"]);
    assert_one_line(&ran, "a long key");
    assert!(ran.code == 2 && ran.err.len() < 3000, "{}", ran.err.len());
    let name = "y".repeat(100_000);
    let ran = place.run(&["render", "scene.toml", "--set", &format!("{name}=1"), "-o", "a.png"]);
    assert_one_line(&ran, "a long flag");
    assert!(ran.code == 2 && ran.err.len() < 3000, "{}", ran.err.len());
}

/// Reads the first line of stderr, then kills the program.
fn progress_of(place: &Place, args: &[&str]) -> String {
    let mut child = place.command(args).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    let lines = BufReader::new(child.stderr.take().unwrap()).lines().map_while(Result::ok);
    let line = lines.into_iter().next();
    child.kill().unwrap();
    child.wait().unwrap();
    line.expect("it ended without a line")
}

#[test]
#[ignore = "slow: make test-all"]
fn long_work_prints_progress_lines_without_a_terminal() {
    let place = Place::new();
    let line =
        progress_of(&place, &["render", "scene.toml", "--engine", "reference", "--check", "--repeat", "1000000"]);
    // as in "progress: rendering, 5 s, 1 %, 495 s left"
    let parts: Vec<&str> = line.strip_prefix("progress: rendering, ").into_iter().flat_map(|l| l.split(", ")).collect();
    let number = |part: usize, unit: &str| parts.get(part)?.strip_suffix(unit)?.parse::<u32>().ok();
    assert!(number(0, " s").is_some_and(|s| s >= 5) && parts.len() == 3, "{line}");
    assert!(number(1, " %").is_some_and(|p| p < 100) && number(2, " s left").is_some_and(|s| s > 0), "{line}");
    let job = "[[job]]\nscene = \"scene.toml\"\ncolor = \"{frame}.png\"\nengine = \"reference\"\n";
    place.write("j.toml", format!("{job}frames = {{ last = 99999 }}\n"));
    let line = progress_of(&place, &["batch", "j.toml"]);
    let is_progress =
        line.starts_with("progress: ") && line.contains(" of 100000 frames, ") && line.ends_with(" s left");
    assert!(is_progress, "{line}");
}

#[test]
fn a_style_that_the_reference_leaves_out_is_reported() {
    let place = Place::new();
    place.write("s.toml", format!("{SCENE}[style]\nwireframe = {{ width = 1 }}\n"));
    let render = ["render", "s.toml", "--engine", "reference", "--size", "8x6"];
    let ran = place.run(&[&render[..], &["-o", "a.png", "--report", "r.json"]].concat());
    let says = "[style] is left out: the reference draws no wireframe, outline, borders or hatching\n";
    assert_eq!((ran.code, ran.err.as_str()), (0, says));
    let report: serde_json::Value =
        serde_json::from_slice(&std::fs::read(place.path().join("r.json")).unwrap()).unwrap();
    assert_eq!(report["left_out"][0]["what"], "style");
    // without colour a style has no effect
    place.works(&[&render[..], &["--exr", "z.exr", "--channels", "Z"]].concat());
}

#[test]
fn a_manifest_that_cannot_be_read_is_named() {
    let place = Place::new();
    place.write("j.toml", "[[job]]\nscene = \"scene.toml\"\ncolor = \"a.png\"\nengine = \"reference\"\n");
    std::fs::create_dir(place.path().join("j.toml.1-of-2.manifest.jsonl")).unwrap();
    place.refuses(&["batch", "j.toml", "--gather"], 2, "j.toml.1-of-2.manifest.jsonl: is not a regular file");
}
