//! Lists of jobs.

use super::program::Place;

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
    assert!(lines.ends_with("jobs.toml: 11 frames\n") && lines.lines().count() == 12, "{lines}");
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
    assert!(ran.err.trim_end().ends_with("2 of 3 frames done, 1 failed: jobs.toml: job.1, frame 0"), "{}", ran.err);
    assert_eq!(files(&place, ".png"), ["0.png", "2.png"]);
    std::fs::remove_file(place.path().join("2.png")).unwrap();
    place.run(&["batch", "jobs.toml", "--fail-fast"]);
    assert_eq!(files(&place, ".png"), ["0.png"]);
}

#[test]
fn wrong_lists_are_refused_before_anything_is_rendered() {
    let place = Place::new();
    for (job, says) in [
        ("color = \"a.png\"", "jobs.toml:1: job.0: scene is missing"),
        ("scene = \"scene.toml\"", "job.0: nothing to write; add color"),
        ("scene = \"scene.toml\"\ncolor = \"a.png\"\nframes = { last = 2 }", "both write"),
        ("scene = \"scene.toml\"\ncolor = \"{fram}.png\"", "names \"fram\", which is no swept key"),
        ("scene = \"scene.toml\"\ncolor = \"a.png\"\nsize = \"8\"", "WIDTHxHEIGHT"),
        ("scene = \"scene.toml\"\ncolor = \"a.png\"\nsamples = 65", "1..=64"),
        ("scene = \"scene.toml\"\ncolor = \"a.png\"\nsweep.camera.vfov = []", "no values"),
        ("scene = \"scene.toml\"\ncolor = \"a.png\"\nframes = { last = -1 }", "no frames from 0 to -1 by 1"),
        ("scene = \"scene.toml\"\ncolor = \"a.png\"\nchannels = [\"Q\"]", "no such channel"),
    ] {
        place.write("jobs.toml", format!("[[job]]\n{job}\n"));
        place.refuses(&["batch", "jobs.toml"], 2, says);
    }
    place.write("jobs.txt", "");
    place.refuses(&["batch", "jobs.txt"], 2, "jobs.txt");
    assert!(files(&place, ".png").is_empty());
}
