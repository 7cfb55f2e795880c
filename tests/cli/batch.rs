//! Lists of jobs.

use super::program::Place;
use std::process::Stdio;

const JOBS: &str = r#"
[[job]]
scene = "scene.toml"
color = "a-{frame:02}.png"
frames = { last = 2 }
size = "16x12"
engine = "reference"

[[job]]
scene = "scene.toml"
exr = "b-{mesh.0.level}-{camera.vfov}-{frame}.exr"
frames = [1, 2.5]
set = ["image.width=20"]
engine = "reference"
channels = ["Z", "t"]
sweep.camera.vfov = [20, 40]
sweep."mesh.0.level" = [1, 2]
"#;

fn files(place: &Place, ending: &str) -> Vec<String> {
    let mut names = place.names();
    names.retain(|name| name.ends_with(ending));
    names
}

#[test]
fn every_frame_of_every_product_is_rendered() {
    let place = Place::new();
    place.write("jobs.toml", JOBS);
    let lines = place.works(&["batch", "jobs.toml"]);
    assert_eq!(lines, "jobs.toml: 11 frames\n");
    assert_eq!(files(&place, ".png"), ["a-00.png", "a-01.png", "a-02.png"]);
    let expected = [
        "b-1-20-1.exr",
        "b-1-20-2.5.exr",
        "b-1-40-1.exr",
        "b-1-40-2.5.exr",
        "b-2-20-1.exr",
        "b-2-20-2.5.exr",
        "b-2-40-1.exr",
        "b-2-40-2.5.exr",
    ];
    assert_eq!(files(&place, ".exr"), expected);
    // each is what render makes of it
    let set = ["--set", "image.width=20", "--set", "camera.vfov=40", "--set", "mesh.0.level=1", "--frame", "2.5"];
    let alone = ["render", "scene.toml", "--exr", "alone.exr", "--channels", "Z,t", "--engine", "reference"];
    place.works(&[&alone[..], &set].concat());
    let read = |name: &str| std::fs::read(place.path().join(name)).unwrap();
    assert!(read("alone.exr") == read("b-1-40-2.5.exr"));
    assert!(read("alone.exr") != read("b-2-40-2.5.exr"));
}

#[test]
fn the_same_list_is_written_in_three_ways() {
    let place = Place::new();
    let job =
        |k: u32| format!(r#"{{"scene": "scene.toml", "size": "8x6", "color": "{k}.png", "engine": "reference"}}"#);
    place.write("jobs.json", format!("{{\"job\": [{}, {}]}}", job(0), job(1)));
    place.write("jobs.jsonl", format!("{}\n\n{}\n", job(2), job(3)));
    place.works(&["batch", "jobs.json"]);
    place.works(&["batch", "jobs.jsonl"]);
    assert_eq!(files(&place, ".png"), ["0.png", "1.png", "2.png", "3.png"]);
    place.write("bad.jsonl", format!("{}\n\n{}\n", job(2), job(3).replace("size", "sice")));
    place.refuses(
        &["batch", "bad.jsonl"],
        2,
        "bad.jsonl:3: unknown key \"sice\" in job.1; nearest known key: \"size\"",
    );
}

#[test]
fn what_goes_wrong_with_one_is_said_and_the_rest_go_on() {
    let place = Place::new();
    place.write("corrupt.toml", "[camera\n");
    let job = |scene: &str, k: u32| {
        format!("[[job]]\nscene = \"{scene}\"\ncolor = \"{k}.png\"\nsize = \"8x6\"\nengine = \"reference\"\n")
    };
    place.write(
        "jobs.toml",
        ["scene.toml", "corrupt.toml", "scene.toml"].iter().zip(0..).map(|(s, k)| job(s, k)).collect::<String>(),
    );
    let ran = place.run(&["batch", "jobs.toml"]);
    assert_eq!(ran.code, 1);
    assert!(ran.err.contains("jobs.toml: job.1, frame 0: ") && ran.err.contains("corrupt.toml:1"), "{}", ran.err);
    assert!(ran.err.trim_end().ends_with("jobs.toml: 2 of 3 frames done, 1 failed: job.1, frame 0"), "{}", ran.err);
    assert_eq!(files(&place, ".png"), ["0.png", "2.png"]);
    let many: String = (0..200).map(|k| job(if k == 3 { "corrupt.toml" } else { "scene.toml" }, 10 + k)).collect();
    place.write("jobs.toml", many);
    let ran = place.run(&["batch", "jobs.toml", "--fail-fast"]);
    assert!(ran.code == 1 && ran.err.contains("not begun, which --resume does"), "{}", ran.err);
    // those that were begun by then are done
    assert!(files(&place, ".png").len() < 100, "{}", ran.err);
}

#[test]
fn wrong_lists_are_refused_before_anything_is_rendered() {
    let place = Place::new();
    for (job, says) in [
        ("color = \"a.png\"", "jobs.toml:1: job.0: scene is missing"),
        ("scene = \"scene.toml\"", "job.0: nothing to write; add color"),
        ("scene = \"scene.toml\"\ncolor = \"a.png\"\nframes = { last = 2 }", "both write"),
        ("scene = \"scene.toml\"\ncolor = \"{fram}.png\"", "is neither frame, nor image, nor a swept key"),
        ("scene = \"scene.toml\"\ncolor = \"a.png\"\nsize = \"8\"", "WIDTHxHEIGHT"),
        ("scene = \"scene.toml\"\ncolor = \"a.png\"\nsamples = 65", "from 1 to 64"),
        ("scene = \"scene.toml\"\ncolor = \"a.png\"\nsweep.camera.vfov = []", "no values"),
        (
            "scene = \"scene.toml\"\ncolor = \"a.png\"\nframes = { last = -1 }",
            "first = 0, last = -1, step = 1 gives no frames",
        ),
        ("scene = \"scene.toml\"\ncolor = \"a.png\"\nchannels = [\"Q\"]", "no such channel"),
    ] {
        place.write("jobs.toml", format!("[[job]]\n{job}\n"));
        place.refuses(&["batch", "jobs.toml"], 2, says);
    }
    for (name, content) in [("none.toml", "job = []"), ("none.json", "{\"job\": []}"), ("none.jsonl", "\n\n")] {
        place.write(name, content);
        place.refuses(&["batch", name], 2, "has no jobs");
    }
    place.write("none.toml", "");
    place.refuses(&["batch", "none.toml"], 2, "job is missing");
    place.write("jobs.txt", "");
    place.refuses(&["batch", "jobs.txt"], 2, "jobs.txt");
    place.write("jobs.toml", "[[job]]\nscene = \"scene.toml\"\ncolor = \"a.png\"\n");
    place.refuses(&["batch", "jobs.toml", "--csv", "no/t.csv"], 1, "does not exist; create it first");
    place.refuses(&["batch", "jobs.toml", "--progress", "fast"], 2, "auto, json, none");
    place.refuses(&["batch", "jobs.toml", "--adapters", "nothing"], 2, "no such adapter");
    place.refuses(&["batch"], 2, "JOBS");
    assert!(files(&place, ".png").is_empty());
}

/// Two scenes, of which the second has a camera that moves, in turn.
fn frames(last: u32) -> String {
    format!(
        r#"
[[job]]
scene = "scene.toml"
color = "a-{{frame}}.png"
exr = "a-{{frame}}.exr"
channels = ["R", "G", "B", "Z", "triangle.id"]
frames = {{ last = {last} }}
set = ["mesh.0.rotate=[{{frame = 0, value = [0, 0, 0]}}, {{frame = 9, value = [0, 90, 0]}}]"]
size = "40x30"

[[job]]
scene = "scene.toml"
color = "b-{{camera.vfov}}-{{frame}}.png"
frames = {{ last = {last} }}
samples = 4
set = ["camera.eye=[{{frame = 0, value = [0, 0.5, 4]}}, {{frame = 9, value = [4, 0.5, 0]}}]"]
sweep.camera.vfov = [30, 50]
size = "48x32"
"#
    )
}

/// What a list wrote: names and bytes.
fn written(place: &Place) -> Vec<(String, Vec<u8>)> {
    let names = place.names().into_iter().filter(|name| name.ends_with(".png") || name.ends_with(".exr"));
    names.map(|name| (name.clone(), std::fs::read(place.path().join(&name)).unwrap())).collect()
}

fn clear(place: &Place) {
    for name in place.names() {
        let ends = [".png", ".exr", ".jsonl", ".tmp"];
        if ends.iter().any(|end| name.ends_with(end)) {
            std::fs::remove_file(place.path().join(name)).unwrap();
        }
    }
}

#[test]
#[ignore = "slow: make test-all"]
fn frames_that_overlap_are_those_of_render() {
    let place = Place::new();
    if !place.has_adapter() {
        return;
    }
    place.write("jobs.toml", frames(3));
    place.works(&["batch", "jobs.toml"]);
    let all = written(&place);
    assert_eq!(all.len(), 4 * 2 + 4 * 2);
    // and on two devices at once
    clear(&place);
    let info: serde_json::Value = serde_json::from_str(&place.works(&["info", "--json"])).unwrap();
    let name = info["adapters"][0]["name"].as_str().and_then(|name| name.split_whitespace().next()).unwrap();
    place.works(&["batch", "jobs.toml", "--adapters", &format!("{name},{name}"), "--report", "r.json"]);
    assert!(written(&place) == all);
    let report: serde_json::Value =
        serde_json::from_slice(&std::fs::read(place.path().join("r.json")).unwrap()).unwrap();
    assert_eq!(report["devices"].as_array().map(Vec::len), Some(2));
    for k in 0..4 {
        let rotate = "mesh.0.rotate=[{frame = 0, value = [0, 0, 0]}, {frame = 9, value = [0, 90, 0]}]";
        let frame = k.to_string();
        let alone = ["render", "scene.toml", "-o", "alone.png", "--exr", "alone.exr", "--size", "40x30"];
        let more = ["--channels", "R,G,B,Z,triangle.id", "--set", rotate, "--frame", &frame];
        place.works(&[&alone[..], &more].concat());
        for ending in ["png", "exr"] {
            let read = |name: String| std::fs::read(place.path().join(name)).unwrap();
            assert!(read(format!("alone.{ending}")) == read(format!("a-{k}.{ending}")), "frame {k}, {ending}");
        }
        let eye = "camera.eye=[{frame = 0, value = [0, 0.5, 4]}, {frame = 9, value = [4, 0.5, 0]}]";
        let alone = ["render", "scene.toml", "-o", "alone.png", "--size", "48x32", "--samples", "4", "--set", eye];
        place.works(&[&alone[..], &["--set", "camera.vfov=50", "--frame", &frame]].concat());
        let read = |name: String| std::fs::read(place.path().join(name)).unwrap();
        assert!(read("alone.png".into()) == read(format!("b-50-{k}.png")), "frame {k}");
    }
}

#[test]
fn resume_skips_what_is_done_and_says_what_has_changed() {
    let place = Place::new();
    let list = |fov: u32| {
        let job = "[[job]]\nscene = \"scene.toml\"\ncolor = \"{frame}.png\"\nframes = { last = 3 }\nsize = \"8x6\"\n";
        format!("{job}engine = \"reference\"\nset = [\"camera.vfov={fov}\"]\n")
    };
    place.write("jobs.toml", list(40));
    let resume = || place.run(&["batch", "jobs.toml", "--resume"]);
    let expects = |done: &str, says: &str| {
        let ran = resume();
        assert_eq!((ran.code, ran.out.as_str()), (0, done), "{}", ran.err);
        let said = if says.is_empty() { ran.err.is_empty() } else { ran.err.contains(says) };
        assert!(said, "{says:?} not in {:?}", ran.err);
    };
    expects("jobs.toml: 4 frames\n", "");
    expects("jobs.toml: 0 frames, 4 before\n", "");
    std::fs::remove_file(place.path().join("2.png")).unwrap();
    expects("jobs.toml: 1 frame, 3 before\n", "again: 1 frame: 2.png is not there\n");
    place.write("1.png", "broken");
    expects("jobs.toml: 1 frame, 3 before\n", "again: 1 frame: 1.png was changed after it was written\n");
    // a change that keeps size and time is found by the hash
    let path = place.path().join("1.png");
    let written = std::fs::metadata(&path).unwrap().modified().unwrap();
    let mut bytes = std::fs::read(&path).unwrap();
    *bytes.last_mut().unwrap() ^= 1;
    std::fs::write(&path, bytes).unwrap();
    std::fs::File::options().append(true).open(&path).unwrap().set_modified(written).unwrap();
    expects("jobs.toml: 1 frame, 3 before\n", "again: 1 frame: 1.png was changed after it was written\n");
    // several reasons are printed with their numbers of frames, on one line
    std::fs::remove_file(place.path().join("2.png")).unwrap();
    place.write("3.png", "broken");
    let ran = resume();
    let line = "again: 2 frames: 2.png is not there (1 frame); 3.png was changed after it was written (1 frame)\n";
    assert_eq!((ran.code, ran.err.as_str()), (0, line));
    place.write("jobs.toml", list(41));
    expects("jobs.toml: 4 frames\n", "again: 4 frames: its settings were camera.vfov=40\n");
    let scene = std::fs::read_to_string(place.path().join("scene.toml")).unwrap();
    place.write("scene.toml", scene + "# another\n");
    expects("jobs.toml: 4 frames\n", "again: 4 frames: scene.toml has changed\n");
    // what was being written when the program was killed is no line; the one before it was of the other scene
    let manifest = place.path().join("jobs.toml.manifest.jsonl");
    let whole = std::fs::read_to_string(&manifest).unwrap();
    place.write("jobs.toml.manifest.jsonl", &whole[..whole.len() - 20]);
    expects("jobs.toml: 1 frame, 3 before\n", "scene.toml has changed");
    expects("jobs.toml: 0 frames, 4 before\n", "");
    // without --resume all is done again
    assert_eq!(place.works(&["batch", "jobs.toml"]), "jobs.toml: 4 frames\n");
}

/// A line of a manifest that was damaged is none, and its frame is rendered again.
#[test]
fn a_manifest_with_bytes_that_are_no_text_is_gone_on_with() {
    let place = Place::new();
    place.write(
        "jobs.toml",
        "[[job]]\nscene = \"scene.toml\"\ncolor = \"{frame}.png\"\nframes = { last = 1 }\nengine = \"reference\"\n",
    );
    place.works(&["batch", "jobs.toml"]);
    let path = place.path().join("jobs.toml.manifest.jsonl");
    let mut bytes = std::fs::read(&path).unwrap();
    let adapter = b"\"adapter\":\"cpu\"";
    let at = bytes.windows(adapter.len()).position(|own| own == adapter).unwrap();
    bytes[at + adapter.len() - 2] = 0xff;
    std::fs::write(&path, bytes).unwrap();
    assert_eq!(place.works(&["batch", "jobs.toml", "--resume"]), "jobs.toml: 1 frame, 1 before\n");
}

#[test]
fn shards_are_the_whole_list_and_are_gathered() {
    let place = Place::new();
    place.write("jobs.toml", JOBS);
    for shard in ["1/3", "2/3"] {
        place.works(&["batch", "jobs.toml", "--shard", shard]);
    }
    let ran = place.run(&["batch", "jobs.toml", "--gather"]);
    assert!(
        ran.code == 1 && ran.err.contains("3 of 11 frames are not done, which --resume does: job.0"),
        "{}",
        ran.err
    );
    place.works(&["batch", "jobs.toml", "--shard", "3/3"]);
    assert_eq!(place.works(&["batch", "jobs.toml", "--gather", "--csv", "all.csv"]), "jobs.toml: 11 frames\n");
    let table = std::fs::read_to_string(place.path().join("all.csv")).unwrap();
    assert_eq!(table.lines().filter(|line| line.contains(",true,")).count(), 11, "{table}");
    // by what frames took the same again, and nothing is left to do
    let mut all = 0;
    for shard in ["1/2", "2/2"] {
        let line = place.works(&["batch", "jobs.toml", "--shard", shard, "--resume"]);
        let before = line.trim_end().strip_prefix("jobs.toml: 0 frames, ").and_then(|l| l.strip_suffix(" before"));
        all += before.unwrap_or_else(|| panic!("{line}")).parse::<u32>().unwrap();
    }
    assert_eq!(all, 11);
    // what the shards did last counts, not what was gathered before
    let scene = std::fs::read_to_string(place.path().join("scene.toml")).unwrap();
    place.write("scene.toml", scene + "# another\n");
    let ran = place.run(&["batch", "jobs.toml", "--gather"]);
    assert!(ran.code == 1 && ran.err.contains("11 of 11 frames are not done"), "{}", ran.err);
    for shard in ["1/2", "2/2"] {
        let ran = place.run(&["batch", "jobs.toml", "--shard", shard, "--resume"]);
        assert!(ran.code == 0 && ran.err.contains("scene.toml has changed"), "{}", ran.err);
    }
    // by another spelling of the list's name too
    let list = place.path().join("jobs.toml");
    assert!(place.works(&["batch", list.to_str().unwrap(), "--gather"]).ends_with("jobs.toml: 11 frames\n"));
    place.refuses(&["batch", "jobs.toml", "--shard", "3/2"], 2, "write it as I/N");
}

#[test]
fn a_sweep_with_checks_is_a_table() {
    let place = Place::new();
    if !place.has_adapter() {
        return;
    }
    let job = "[[job]]\nscene = \"scene.toml\"\ncolor = \"{camera.vfov}-{mesh.0.level}.png\"\nsize = \"16x12\"\n";
    place.write(
        "jobs.toml",
        format!("{job}check = true\nrepeat = 3\nsweep.camera.vfov = [20, 40]\nsweep.\"mesh.0.level\" = [1, 2]\n"),
    );
    let out = place.works(&[
        "batch",
        "jobs.toml",
        "--csv",
        "t.csv",
        "--report",
        "r.json",
        "--log",
        "log.txt",
        "--progress",
        "json",
    ]);
    let events: Vec<serde_json::Value> = out.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let of = |name: &str| events.iter().filter(|e| e["event"] == name).count();
    assert_eq!((of("start"), of("done"), of("end"), events.len()), (1, 4, 1, 6), "{out}");
    let mut table = csv::Reader::from_path(place.path().join("t.csv")).unwrap();
    let names = table.headers().unwrap().clone();
    let rows: Vec<csv::StringRecord> = table.records().map(Result::unwrap).collect();
    let column = |name: &str| {
        let k = names.iter().position(|n| n == name).unwrap_or_else(|| panic!("{name} not in {names:?}"));
        rows.iter().map(|row| row[k].to_owned()).collect::<Vec<_>>()
    };
    assert_eq!(column("camera.vfov"), ["20", "20", "40", "40"]);
    assert_eq!(column("triangles"), ["80", "320", "80", "320"]);
    assert_eq!(column("runs"), ["3"; 4]);
    assert_eq!(column("error.wrong_safe"), ["0"; 4]);
    assert!(column("frame_ms").iter().all(|ms| ms.parse::<f64>().unwrap() > 0.0));
    let report: serde_json::Value =
        serde_json::from_slice(&std::fs::read(place.path().join("r.json")).unwrap()).unwrap();
    assert_eq!((report["done"].as_u64(), report["each"].as_array().map(Vec::len)), (Some(4), Some(4)));
    let log = std::fs::read_to_string(place.path().join("log.txt")).unwrap();
    assert!(log.lines().count() == 6 && log.lines().all(|line| line.contains("Z ")), "{log}");
}

#[test]
fn every_image_of_a_colmap_model_is_rendered() {
    let place = Place::new();
    std::fs::create_dir(place.path().join("sparse")).unwrap();
    place.write("sparse/cameras.txt", "3 SIMPLE_RADIAL_FISHEYE 32 24 10 16 12 0.01\n");
    let images = "1 1 0 0 0 0 0 4 3 b 2.jpg\n\n2 0.9 0.1 0 0 0.2 0 5 3 a/1.jpg\n\n";
    place.write("sparse/images.txt", images);
    let job =
        "[[job]]\nscene = \"scene.toml\"\nimages = \"sparse\"\ncolor = \"of {image}.png\"\nengine = \"reference\"\n";
    place.write("jobs.toml", format!("{job}sweep.mesh.0.level = [1]\n"));
    place.works(&["batch", "jobs.toml", "--csv", "t.csv"]);
    assert_eq!(files(&place, ".jpg.png"), ["of a_1.jpg.png", "of b 2.jpg.png"].map(|name| name.replace("b 2", "b_2")));
    let table = std::fs::read_to_string(place.path().join("t.csv")).unwrap();
    assert!(table.lines().next().unwrap().contains("image") && table.contains("a/1.jpg"), "{table}");
    let camera = "camera={ kind = \"calibrated\", file = \"sparse\", image = \"a/1.jpg\" }";
    let sets = ["--set", camera, "--set", "mesh.0.level=1"];
    place.works(&[&["render", "scene.toml", "-o", "own.png", "--engine", "reference"], &sets[..]].concat());
    let read = |name: &str| std::fs::read(place.path().join(name)).unwrap();
    assert!(read("own.png") == read("of a_1.jpg.png") && read("own.png") != read("of b_2.jpg.png"));
    // nothing is left to do, and a changed pose is
    let again = place.works(&["batch", "jobs.toml", "--resume", "--progress", "json"]);
    assert!(again.contains("\"skipped\":2"), "{again}");
    place.write("sparse/images.txt", images.replace("0.2 0 5", "0.3 0 5"));
    let ran = place.run(&["batch", "jobs.toml", "--resume"]);
    assert!(ran.code == 0 && ran.err.contains("2 frames: sparse/images.txt has changed"), "{}", ran.err);
    assert!(read("own.png") != read("of a_1.jpg.png"));
}

/// Kills the program at moments spread over its run, goes on, and ends with the files of a run that nobody disturbed.
#[test]
#[ignore = "slow: make test-all"]
fn what_is_killed_goes_on_and_ends_with_the_same_files() {
    let place = Place::new();
    if !place.has_adapter() {
        return;
    }
    place.write("jobs.toml", frames(15));
    let started = std::time::Instant::now();
    place.works(&["batch", "jobs.toml"]);
    let whole = started.elapsed();
    let expected = written(&place);
    assert_eq!(expected.len(), 16 * 2 + 16 * 2);
    clear(&place);
    let mut cut_short = 0;
    for k in 0..20u32 {
        let mut command = place.command(&["batch", "jobs.toml", "--resume"]);
        let mut child = command.stdout(Stdio::null()).spawn().unwrap();
        // a golden ratio of its run, so that no two moments are near
        let share = (f64::from(k) * 0.618_034).fract();
        std::thread::sleep(whole.mul_f64(share));
        cut_short += u32::from(child.try_wait().unwrap().is_none());
        child.kill().unwrap();
        child.wait().unwrap();
        let done = written(&place);
        // whatever is there is whole
        assert!(done.iter().all(|file| expected.contains(file)), "moment {k}");
        if done.len() == expected.len() {
            clear(&place);
        }
    }
    assert!(cut_short >= 5, "{cut_short} of 20 runs were cut short");
    let ran = place.run(&["batch", "jobs.toml", "--resume"]);
    assert_eq!(ran.code, 0, "{}", ran.err);
    assert!(written(&place) == expected);
    assert!(place.names().iter().all(|name| !name.ends_with(".tmp")), "{:?}", place.names());
}

/// Pictures go where nothing is kept, and the table has each frame's own numbers.
#[cfg(target_os = "linux")]
#[test]
fn frames_without_files_have_lines_of_their_own() {
    let place = Place::new();
    let job = "[[job]]\nscene = \"scene.toml\"\ncolor = \"/dev/null\"\nsize = \"32x24\"\nengine = \"reference\"\n";
    place.write("jobs.toml", format!("{job}sweep.\"mesh.0.level\" = [1, 2, 3]\n"));
    place.works(&["batch", "jobs.toml", "--csv", "t.csv"]);
    let mut table = csv::Reader::from_path(place.path().join("t.csv")).unwrap();
    let triangles = table.headers().unwrap().iter().position(|name| name == "triangles").unwrap();
    let counts: Vec<String> = table.records().map(|row| row.unwrap()[triangles].to_owned()).collect();
    assert!(counts.len() == 3 && counts[0] != counts[1] && counts[1] != counts[2], "{counts:?}");
    assert_eq!(place.works(&["batch", "jobs.toml", "--resume"]), "jobs.toml: 0 frames, 3 before\n");
}

/// A small disk is full before all is written; with more space the rest is done.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_stops_with_what_is_done() {
    for (key, ending, flag) in [("exr", "exr", "--exr"), ("color", "png", "-o"), ("points", "ply", "--points")] {
        let place = Place::new();
        let disk = place.path().join("disk");
        std::fs::create_dir(&disk).unwrap();
        let Some(_mounted) = Mounted::new(&disk, "size=128k") else { return };
        let job = format!("[[job]]\nscene = \"scene.toml\"\n{key} = \"disk/{{frame}}.{ending}\"\n");
        let rest = "frames = { last = 79 }\nsize = \"64x48\"\nengine = \"reference\"\n";
        place.write("jobs.toml", job + rest);
        let ran = place.run(&["batch", "jobs.toml"]);
        assert_eq!(ran.code, 1, "{}", ran.err);
        let says = ["No space left", "stopped: the disk is full"];
        assert!(says.iter().all(|text| ran.err.contains(text)), "{key}: {}", ran.err);
        let done = std::fs::read_dir(&disk).unwrap().count();
        let printed = format!(": {done} of 80 frames done");
        assert!((1..80).contains(&done) && ran.err.contains(&printed), "{key}: {done}: {}", ran.err);
        // only the frames in flight fail
        assert!(ran.err.matches("No space left").count() <= 20, "{key}: {}", ran.err);
        assert!(Mounted::mount(&disk, "remount,size=16m"));
        let line = place.works(&["batch", "jobs.toml", "--resume"]);
        assert_eq!(line, format!("jobs.toml: {} frames, {done} before\n", 80 - done));
        let first = std::fs::read(disk.join(format!("0.{ending}"))).unwrap();
        let alone = format!("alone.{ending}");
        place.works(&["render", "scene.toml", flag, &alone, "--size", "64x48", "--engine", "reference"]);
        assert!(std::fs::read(place.path().join(alone)).unwrap() == first);
    }
}

/// A file system in memory, mounted on a folder until it is dropped.
#[cfg(target_os = "linux")]
struct Mounted(std::path::PathBuf);

#[cfg(target_os = "linux")]
impl Mounted {
    fn new(folder: &std::path::Path, options: &str) -> Option<Mounted> {
        if !Mounted::mount(folder, options) {
            println!("skipped: no file system can be mounted here");
            return None;
        }
        Some(Mounted(folder.to_owned()))
    }

    fn mount(folder: &std::path::Path, options: &str) -> bool {
        let mut command = std::process::Command::new("mount");
        let ran = command.args(["-t", "tmpfs", "-o", options, "tmpfs"]).arg(folder).output();
        ran.is_ok_and(|o| o.status.success())
    }
}

#[cfg(target_os = "linux")]
impl Drop for Mounted {
    fn drop(&mut self) {
        let _ = std::process::Command::new("umount").arg(&self.0).status();
    }
}

/// Without a cluster the driver renders on this machine, and passes on the events of all shards. A small stand-in takes the place of Ray.
#[cfg(target_os = "linux")]
#[test]
fn the_ray_driver_needs_no_cluster_and_passes_events_on() {
    use std::process::Command;
    if !Command::new("python3").arg("--version").output().is_ok_and(|o| o.status.success()) {
        println!("skipped: no python3 on this machine");
        return;
    }
    let place = Place::new();
    place.write("jobs.toml", JOBS);
    place.works(&["batch", "--write-driver", "driver.py"]);
    let run = |arguments: &[&str]| {
        let mut command = Command::new("python3");
        command.args(["driver.py", "jobs.toml", "--shards", "3", "--anamorph", env!("CARGO_BIN_EXE_anamorph")]);
        command.args(arguments).current_dir(place.path());
        command.env("PYTHONPATH", concat!(env!("CARGO_MANIFEST_DIR"), "/tests/ray/stub"));
        let ran = command.output().unwrap();
        let [out, err] = [ran.stdout, ran.stderr].map(|bytes| String::from_utf8(bytes).unwrap());
        (out, err, ran.status.code())
    };
    let (out, err, code) = run(&["--progress", "json"]);
    let here = "note: no Ray cluster runs here; this machine renders alone\n";
    let gathered = format!("{}: 11 frames\n", place.path().join("jobs.toml").display());
    assert_eq!((err, code), (format!("{here}{gathered}"), Some(0)));
    let events: Vec<serde_json::Value> = out.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let count = |kind: &str| events.iter().filter(|event| event["event"] == kind).count();
    assert_eq!((count("start"), count("done"), count("end")), (3, 11, 3), "{out}");
    let shards: std::collections::BTreeSet<u64> = events.iter().filter_map(|event| event["shard"].as_u64()).collect();
    assert_eq!(shards, [1, 2, 3].into());
    // all is done before
    let (out, err, code) = run(&[]);
    assert_eq!((err.as_str(), code), (here, Some(0)), "{out}");
    assert_eq!(out.lines().filter(|line| line.contains(": 0 done, ")).count(), 3, "{out}");
    // a cluster that is named must be there
    let (_, err, code) = run(&["--address", "10.0.0.1:9"]);
    let refused = "error: --address 10.0.0.1:9: Could not find any running Ray instance. Please specify one.\n";
    assert_eq!((err.as_str(), code), (refused, Some(2)));
}

/// A list on a cluster of two nodes, of which one is killed with a shard half done: all files are those of one machine.
#[cfg(target_os = "linux")]
#[test]
fn a_killed_node_of_a_ray_cluster_costs_no_frame() {
    use std::process::Command;
    let has_ray = Command::new("python3").args(["-c", "import ray"]).output().is_ok_and(|o| o.status.success());
    if !has_ray {
        println!("skipped: no Ray on this machine; pip install ray");
        return;
    }
    let place = Place::new();
    let rotate = "mesh.0.rotate=[{frame = 0, value = [0, 0, 0]}, {frame = 79, value = [0, 90, 0]}]";
    let job = "[[job]]\nscene = \"scene.toml\"\ncolor = \"{frame}.png\"\nframes = { last = 79 }\nsize = \"640x480\"\n";
    // slow enough for a node to be killed in the middle
    place.write("jobs.toml", format!("{job}samples = 16\nset = [\"{rotate}\"]\n"));
    place.works(&["batch", "jobs.toml"]);
    let expected = written(&place);
    assert_eq!(expected.len(), 80);
    clear(&place);
    place.works(&["batch", "--write-driver", "driver.py"]);
    let nodes = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/ray/two_nodes.py");
    let mut command = Command::new("python3");
    command.args([nodes, "driver.py", env!("CARGO_BIN_EXE_anamorph")]).arg(place.path().join("jobs.toml"));
    let ran = command.current_dir(place.path()).output().unwrap();
    let (out, err) = (String::from_utf8_lossy(&ran.stdout), String::from_utf8_lossy(&ran.stderr));
    assert!(ran.status.success(), "{out}{err}");
    assert!(out.contains("killed a node with 2 shards begun"), "{out}{err}");
    // what the killed node had done of its shard was not done again
    let again = out.lines().any(|line| line.starts_with("shard") && !line.contains(" 0 skipped"));
    assert!(again, "{out}");
    assert!(written(&place) == expected);
    let table = std::fs::read_to_string(place.path().join("jobs.csv")).unwrap();
    assert_eq!(table.lines().filter(|line| line.contains(",true,")).count(), 80);
}
