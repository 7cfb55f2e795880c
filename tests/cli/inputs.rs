//! Files that a scene names and that do not exist, are not regular files, or are nested deeply.

use super::program::{Place, SCENE};

/// A quad that faces the camera. Its image does not exist, nor the normal that one face names.
const QUAD: &str =
    "mtllib q.mtl\nusemtl m\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvt 0 0\nf 1/1/7 2/1 3/1\nf 1/1 3/1 4/1\n";

fn quad() -> Place {
    let place = Place::new();
    place.write("q.obj", QUAD);
    place.write("q.mtl", "newmtl m\nKd 1 0 0\nmap_Kd no.png\n");
    place.write("scene.toml", SCENE.replace("builtin = \"icosphere\"\nlevel = 2", "file = \"q.obj\""));
    place
}

#[test]
fn what_mesh_files_lack_is_noted_and_reported() {
    let place = quad();
    let all = ["render", "scene.toml", "--engine", "reference", "-o", "o.png", "--report", "r.json"];
    let ran = place.run(&all);
    assert_eq!(ran.code, 0, "{}", ran.err);
    let image = "q.mtl:3: map_Kd: the file does not exist; the material's own colour is used";
    let normal = "missing at 1 corner of faces, first in line 8: face's normal index 7, but there are none";
    let line = format!(
        "left out: normals of q.obj ({normal}), and 1 more, listed by --report; --strict makes this an error\n"
    );
    assert_eq!(ran.err, line);
    let report: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(place.path().join("r.json")).unwrap()).unwrap();
    let said: Vec<_> = report["left_out"].as_array().unwrap().iter().map(|l| (&l["what"], &l["why"])).collect();
    assert!(said.contains(&(&"no.png".into(), &image.into())), "{said:?}");
    assert!(said.contains(&(&"normals of q.obj".into(), &normal.into())), "{said:?}");
    let pixel = image::open(place.path().join("o.png")).unwrap().into_rgb8()[(32, 24)];
    assert!(pixel[0] > 100 && pixel[1] == 0 && pixel[2] == 0, "{pixel:?}");

    place.refuses(&[&all[..4], &["-o", "p.png", "--strict"]].concat(), 2, "normals of q.obj: missing at 1 corner");
    place.write("q.obj", QUAD.replace("/7", ""));
    place.refuses(&[&all[..4], &["-o", "p.png", "--strict"]].concat(), 2, image);
}

/// Images are read if colour is asked for; alpha masks are always read.
#[test]
fn images_are_read_only_if_an_output_needs_them() {
    let place = quad();
    place.write("q.obj", QUAD.replace("/7", ""));
    place.write("no.png", "this is no image");
    let ids =
        ["render", "scene.toml", "--engine", "reference", "--channels", "Z,triangle.id", "--exr", "o.exr", "--strict"];
    place.works(&ids);
    place.works(&["render", "scene.toml", "--pixel", "32,24", "--strict"]);
    place.works(&["camera", "scene.toml"]);
    for more in [&["--channels", "albedo", "--exr", "p.exr"][..], &["-o", "p.png"], &["--exr", "p.exr"]] {
        let args = [&["render", "scene.toml", "--engine", "reference"], more].concat();
        place.refuses(&args, 2, "q.mtl:3: map_Kd: no.png: is no PNG, JPEG or HDR");
    }
    place.write("q.mtl", "newmtl m\nKd 1 0 0\nmap_d no.png\n");
    place.refuses(&[&ids[..6], &["--exr", "p.exr"]].concat(), 2, "q.mtl:3: map_d: no.png: is no PNG");
}

#[test]
fn a_batch_notes_what_is_missing_once() {
    let place = quad();
    let job = "scene = \"scene.toml\"\nengine = \"reference\"\nframes = 3\ncolor = \"o-{frame:01}.png\"\n";
    place.write("jobs.toml", format!("[[job]]\n{job}"));
    let ran = place.run(&["batch", "jobs.toml"]);
    assert_eq!((ran.code, ran.err.matches("left out: ").count(), ran.err.lines().count()), (0, 1, 1), "{}", ran.err);
    place.write("strict.toml", format!("[[job]]\n{}strict = true\n", job.replace("o-", "p-")));
    let ran = place.run(&["batch", "strict.toml"]);
    assert!(ran.code == 1 && ran.err.contains("render without --strict"), "{}", ran.err);
}

/// A pipe without a writer and an endless device are refused wherever a file is read.
#[cfg(unix)]
#[test]
fn pipes_and_devices_are_refused_as_inputs() {
    let place = quad();
    let fifo = |name: &str| {
        assert!(std::process::Command::new("mkfifo").arg(place.path().join(name)).status().unwrap().success());
    };
    ["p.obj", "no.png", "p.toml", "p.mtl", "p.npy"].into_iter().for_each(fifo);
    let render = ["render", "scene.toml", "--engine", "reference", "-o", "o.png"];
    let says = "it is a pipe or a device, not a regular file";
    place.refuses(&render, 2, &format!("q.mtl:3: map_Kd: no.png: cannot be read: {says}"));
    place.refuses(
        &[&render[..], &["--set", "mesh.0.file=p.obj"]].concat(),
        2,
        &format!("p.obj: cannot be read: {says}"),
    );
    place.refuses(&["render", "p.toml", "-o", "o.png"], 2, &format!("p.toml: cannot be read: {says}"));
    place.refuses(&["render", "/dev/zero", "-o", "o.png"], 2, &format!("/dev/zero: cannot be read: {says}"));
    place.refuses(&["project", "scene.toml", "--points", "p.npy"], 2, &format!("p.npy: cannot be read: {says}"));
    place.write("q.obj", QUAD.replace("q.mtl", "p.mtl"));
    // a material library that is not a regular file is skipped, as one that does not exist
    let ran = place.run(&[&render[..], &["--strict"]].concat());
    assert!(ran.code == 2 && ran.err.contains("normals of q.obj"), "{}", ran.err);
}

/// `anamorph camera <(command)` and `command | anamorph camera /dev/stdin`.
#[cfg(unix)]
#[test]
fn scenes_come_through_pipes() {
    let place = Place::new();
    let program = env!("CARGO_BIN_EXE_anamorph");
    for line in [
        format!("{program} camera <(cat scene.toml)"),
        format!("cat scene.toml | {program} camera /dev/stdin"),
        format!("{program} camera /dev/stdin < scene.toml"),
    ] {
        let ran = std::process::Command::new("bash").args(["-c", &line]).current_dir(place.path()).output().unwrap();
        assert!(ran.status.success(), "{line}: {}", String::from_utf8_lossy(&ran.stderr));
    }
}

#[test]
fn nested_files_are_refused_at_once() {
    let place = Place::new();
    let camera = "[camera]\nkind = \"opencv\"\nfile = \"c.yaml\"\neye = [0, 0, 4]\ntarget = [0, 0, 0]\n";
    place.write("scene.toml", format!("[[mesh]]\nbuiltin = \"box\"\n{camera}"));
    for open in ["[", "{a: ", "[1, "] {
        place.write("c.yaml", format!("%YAML:1.0\n---\nimage_width: {}\n", open.repeat(100_000)));
        place.refuses(
            &["render", "scene.toml", "-o", "o.png"],
            2,
            "100000 lists and tables in brackets, over the limit of 10000",
        );
    }
    for (name, text) in [("a.toml", format!("a = {}", "[".repeat(100_000))), ("a.json", "[".repeat(100_000))] {
        place.write(name, text);
        place.refuses(&["render", name, "-o", "o.png"], 2, name);
    }
}
