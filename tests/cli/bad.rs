//! Wrong command lines, scenes, files and outputs.

use super::program::{Place, Ran, SCENE, assert_one_line};

const RENDER: [&str; 4] = ["render", "scene.toml", "-o", "out.png"];

#[test]
fn wrong_command_lines() {
    let place = Place::new();
    let more = |extra: &[&'static str]| [&RENDER[..], extra].concat();
    for (args, says) in [
        (
            vec!["draw"],
            "'draw'; use one of render, compare, camera, batch, project, splat, info, view, doctor, example, new, completions, schema, man, bench, gpu-report",
        ),
        (vec!["new", "fishey"], "no task \"fishey\"; did you mean \"fisheye\"?; known: "),
        (vec!["example", "projector"], "no example \"projector\"; with such a camera: teapot-above, car, "),
        (
            vec!["camera", "--help", "fishye"],
            "no such kind of camera in this version; did you mean \"fisheye\"?; known: ",
        ),
        (vec!["rendr"], "a similar subcommand exists: 'render'"),
        (vec!["render"], "SCENE"),
        (vec!["render", "scene.toml"], "nothing to write; add -o"),
        (vec!["render", "scene.toml", "-o"], "a value is required"),
        (more(&["--sice", "8x8"]), "--size"),
        (more(&["--size", "8"]), "WIDTHxHEIGHT"),
        (more(&["--size", "0x8"]), "at least 1"),
        (more(&["--size", "-8x8"]), "WIDTHxHEIGHT"),
        (more(&["--size", "65537x1"]), "65536"),
        (more(&["--size", "65536x65536"]), "1073741824 pixels in all"),
        (more(&["--size", "99999999999999999999x1"]), "WIDTHxHEIGHT"),
        (more(&["--samples", "0"]), "1..=64"),
        (more(&["--samples", "65"]), "1..=64"),
        (more(&["--analytic"]), "analytic coverage needs several samples per pixel; use at least 2"),
        (more(&["--analytic", "--samples", "40"]), "areas are found in one frame"),
        (more(&["--analytic", "--samples", "4", "--engine", "reference"]), "leave out analytic coverage"),
        (more(&["--gradients", "depth"]), "--gradients-to"),
        (more(&["--gradients-to", "g"]), "--gradients"),
        (more(&["--gradients-of", "vertices"]), "--gradients"),
        (more(&["--gradients", "depht", "--gradients-to", "g"]), "nearest known: \"depth\""),
        (more(&["--gradients", "", "--gradients-to", "g"]), "known: depth, t"),
        (more(&["--gradients", "t", "--gradients-to", "g", "--gradients-of", "vfov"]), "as in camera.vfov"),
        (
            more(&["--gradients", "t", "--gradients-to", "g", "--gradients-of", "camera.fov"]),
            "camera.fov: the camera's table has no such number",
        ),
        (more(&["--gradients", "t", "--gradients-to", "g", "--pixel", "1,1"]), "cannot be used with"),
        (more(&["--repeat", "0"]), "--repeat"),
        (more(&["--moving"]), "--repeat"),
        (more(&["--channels", "R,Q"]), "no such channel; known: R, G"),
        (more(&["--channels", ""]), "known: R, G"),
        (more(&["--set", "camera.vfov"]), "no '='"),
        (more(&["--set", "camera.vfof=3"]), "vfov"),
        (more(&["--frame", "inf"]), "write a finite number"),
        (vec!["camera", "scene.toml", "--frame", "one"], "write a finite number"),
        (more(&["--set", "camera.vfov=[{frame=2, value=1}, {frame=1, value=2}]"]), "frame 1 comes after frame 2"),
        (more(&["--engine", "reference", "--adapter", "x"]), "--adapter"),
        (more(&["--engine", "reference", "--no-int64"]), "--no-int64"),
        (more(&["--engine", "reference", "--repeat", "1", "--moving"]), "--moving"),
        (more(&["--pixel", "1,1"]), "cannot be used with"),
        (vec!["render", "scene.toml", "--pixel", "1"], "COLUMN,ROW"),
        (vec!["render", "scene.toml", "--pixel", "64,0"], "columns go from 0 to 63"),
        (more(&["--adapter", "no such adapter"]), "no such adapter"),
        (more(&["--exr", "out.png"]), "name it .exr"),
        (vec!["render", "scene.toml", "-o", "scene.toml"], "scene.toml: is also an input; choose another name"),
        (vec!["render", "scene.toml", "--exr", "o.exr", "--report", "./o.exr"], "named twice"),
        (vec!["render", "scene.toml", "-o", "out.exr"], "use --exr"),
        (vec!["render", "scene.toml", "-o", "out.jpg"], "name it .png"),
        (vec!["render", "no.toml", "-o", "out.png"], "no.toml: cannot be read"),
        (vec!["render", ".", "-o", "out.png"], "cannot be read"),
        (vec!["render", "scene.obj", "-o", "out.png"], ".toml or .json"),
        (vec!["compare", "a.exr"], "<B>"),
        (vec!["compare", "a.exr", "b.exr"], "a.exr: cannot be read"),
        (vec!["camera"], "SCENE"),
        (vec!["camera", "--help", "perspective"], "known: pinhole"),
        (vec!["camera", "scene.toml", "--rays", "r.npy", "--export", "r.npy"], "named twice"),
        (vec!["camera", "scene.toml", "--export-povray", "scene.toml"], "is also an input"),
        (vec!["project", "scene.toml"], "--points"),
        (vec!["splat", "scene.toml"], "--points"),
        (vec!["splat", "scene.toml", "--points", "p.csv"], "nothing to write; add -o OUT.png"),
        (vec!["splat", "scene.toml", "--points", "p.csv", "-o", "a.png"], "p.csv: cannot be read"),
        (vec!["splat", "scene.toml", "--points", "p.csv", "-o", "a.jpg"], "a.jpg: colour is written as PNG"),
        (vec!["splat", "scene.toml", "--points", "p.csv", "--exr", "a.png"], "a.png: this output is written as EXR"),
        (vec!["splat", "scene.toml", "--points", "scene.toml", "-o", "a.png"], ".ply, .npy, .csv, .txt or .xyz"),
        (
            vec!["splat", "scene.toml", "--points", "p.csv", "-o", "a.png", "--engine", "raytrace"],
            "use compute or reference",
        ),
        (vec!["project", "scene.toml", "--points", "p.csv"], "p.csv: cannot be read"),
        (vec!["project", "scene.toml", "--points", "scene.toml"], ".npy, .csv, .txt or .xyz"),
        (vec!["project", "scene.toml", "--points", "p.csv", "--engine", "raytrace"], "use compute or reference"),
        (vec!["project", "scene.toml", "--points", "p.csv", "--engine", "reference", "--adapter", "x"], "--adapter"),
        (vec!["example"], "NAME"),
        (vec!["example", "nothing"], "known: demo"),
        (vec!["example", "demo", "--list"], "cannot be used with"),
        (vec!["info", "extra"], "extra"),
        (vec!["view", "none.toml"], "none.toml: cannot be read"),
        (vec!["view", "scene.toml", "--port", "70000"], "70000 is not in 0..=65535"),
        (vec!["view", "scene.toml", "--token", "short"], "write 16 or more letters and digits"),
        (vec!["view", "scene.toml", "--set", "camera.vfof=3"], "nearest known key: \"vfov\""),
        (vec!["view", "scene.toml", "--set", "camera"], "no '='"),
    ] {
        place.refuses(&args, 2, says);
    }
}

/// What a ray tracer with one straight ray a pixel has no word for.
#[test]
fn cameras_that_povray_has_not() {
    let place = Place::new();
    let at = "eye = [0, 0.5, 4]\ntarget = [0, 0, 0]";
    for (camera, says) in [
        (format!("kind = \"twist\"\n{at}\nvfov = 40\ndegree = 3\nangle = 70"), "twist has a curve for each pixel"),
        (format!("kind = \"occlusion\"\n{at}\nvfov = 40\nnear = 4\nfar = 6"), "occlusion has"),
        (
            format!(
                "kind = \"reflection\"\neye = {{ kind = \"pinhole\", {}, vfov = 40 }}\n\
                     mirror = {{ shape = \"sphere\", radius = 0.5 }}",
                at.replace('\n', ", ")
            ),
            "reflection reflects or refracts rays",
        ),
        (format!("kind = \"pinhole\"\n{at}\nvfov = 40\nt_range = [-inf, inf]"), "t_range starts at -inf"),
        (
            format!("kind = \"pinhole\"\n{at}\nvfov = 40\nt_range = [1e308, inf]"),
            "the ray of pixel 0,0 starts too far away",
        ),
        (format!("kind = \"pinhole\"\n{at}\nvfov = 40\nt_range = [0, 4]"), "t_range ends at 4"),
    ] {
        place.write("s.toml", format!("[[mesh]]\nbuiltin = \"icosphere\"\n[camera]\n{camera}\n"));
        let args = ["camera", "s.toml", "--size", "8x6", "--export-povray", "s.pov"];
        place.refuses(&args, 2, &format!("--export-povray: {says}"));
    }
    let set = "camera={kind=\"orthographic\", eye=[0, 0, 4], target=[0, 0, 0], height=2, t_range=[0, 4]}";
    let args = ["camera", "scene.toml", "--set", set, "--set", "mesh.0.two_sided=false", "--export-povray", "s.pov"];
    place.refuses(&args, 2, "two_sided = true");
}

/// Each scene with the text that its error must hold.
#[test]
fn wrong_scenes() {
    let place = Place::new();
    place.write("garbage.obj", [0u8, 159, 146, 150, 255, 254, 1, 2].repeat(100));
    place.write("empty.obj", "");
    place.write("range.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n");
    place.write("nan.obj", "v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    place.write("garbage.glb", [7u8; 64]);
    place.write("garbage.npy", [7u8; 64]);
    place.write("garbage.json", [7u8; 64]);
    let camera = |text: &str| SCENE.split("[camera]").next().unwrap().to_owned() + "[camera]\n" + text;
    let pinhole = |keys: &str| camera(&format!("kind = \"pinhole\"\n{keys}\n"));
    let mesh = |text: &str| SCENE.replace("builtin = \"icosphere\"\nlevel = 2", text);
    let piece = |vertices: &str, triangles: &str| {
        camera(&format!("kind = \"mesh\"\nvertices = [{vertices}]\ntriangles = {triangles}\n"))
    };
    let corners = "{ image = [0, 0], near = [0, 0, 1], far = [0, 0, 0] }, { image = [1, 0], near = [1, 0, 1], far = [1, 0, 0] }, \
                   { image = [0, 1], near = [0, 1, 1], far = [0, 1, 0] }";
    let flat = corners.replace("near = [0, 0, 1]", "near = [0, 0, 0]").replace("[1, 0, 1]", "[1, 0, 0]");
    let flat = flat.replace("[0, 1, 1]", "[0, 1, 0]");
    for (text, says) in [
        ("[image".to_owned(), "scene.toml:1"),
        ("\u{0}\u{1}".into(), "scene.toml"),
        ("".into(), "no camera"),
        (SCENE.replace("[image]", "[imag]"), "image"),
        (SCENE.replace("vfov", "vfow"), "vfov"),
        (SCENE.replace("width = 64", "width = 0"), "width"),
        (SCENE.replace("width = 64", "width = 1e3"), "width"),
        (SCENE.replace("width = 64\n", ""), "width and height"),
        (SCENE.replace("width = 64\nheight = 48\n", ""), "no size"),
        (SCENE.replace("width = 64", "width = 70000"), "65536"),
        (SCENE.replace("[0.1, 0.2, 0.3]", "[0.1, 0.2, 3]"), "[0, 1]"),
        (pinhole("eye = [0, 0, 0]\ntarget = [0, 0, 0]\nvfov = 40"), "same point"),
        (pinhole("eye = [0, 0, 1e308]\ntarget = [0, 0, 0]\nvfov = 40"), "eye and target are too far apart"),
        (pinhole("eye = [0, 0, 1e-200]\ntarget = [0, 0, 0]\nvfov = 40"), "eye and target are too close together"),
        (
            camera("kind = \"lidar\"\nfile = \"rays.npy\"\nbeams = [15, 0]"),
            "beams describes a scanner, but file lists the rays; leave one of the two out",
        ),
        (pinhole("eye = [0, 5, 0]\ntarget = [0, 0, 0]\nvfov = 40"), "parallel"),
        (pinhole("eye = [0, 0, 5]\ntarget = [0, 0, 0]\nup = [0, 0, 0]\nvfov = 40"), "up is zero"),
        (pinhole("eye = [0, 0, 5]\ntarget = [0, 0, 0]\nvfov = 0"), "vfov"),
        (pinhole("eye = [0, 0, 5]\ntarget = [0, 0, 0]\nvfov = 180"), "vfov"),
        (pinhole("eye = [0, 0, 5]\ntarget = [0, 0, 0]\nvfov = nan"), "vfov"),
        (pinhole("eye = [0, 0, inf]\ntarget = [0, 0, 0]\nvfov = 40"), "eye"),
        (pinhole("eye = [0, 0, 5]\ntarget = [0, 0, 0]\nvfov = 40\nt_range = [2, 1]"), "t_range"),
        (
            pinhole("vfov = [{ frame = 0, value = 40 }, { frame = 0, value = 50 }]"),
            "scene.toml:11: camera.vfov.1.value",
        ),
        (pinhole("vfov = [{ frame = 0, value = 40 }, { frame = 1, value = [50] }]"), "all keys need as many numbers"),
        (pinhole("vfov = [{ frame = 0, value = \"wide\" }]"), "camera.vfov.0.value: expected a finite number"),
        (camera("kind = \"pinhol\""), "pinhole"),
        (camera("kind = \"reflection\""), "mirror"),
        (camera("kind = \"orthographic\"\neye = [0, 0, 5]\ntarget = [0, 0, 0]\nheight = -1"), "height"),
        (camera("kind = \"glc\"\nnear = [[0,0,0],[1,0,0],[0,1,0]]\nfar = [[0,0,0],[1,0,0],[0,1,0]]"), "near and far"),
        (piece(corners, "[]"), "no pieces"),
        (piece(corners, "[[0, 1, 3]]"), "vertex 3 does not exist"),
        (piece(corners, "[[0, 1, 1]]"), "no area"),
        (piece(corners, "[[0, 1, 2], [0, 2, 1]]"), "overlap"),
        (piece(&flat, "[[0, 1, 2]]"), "near and far are equal"),
        (camera("kind = \"mesh\"\nfile = \"garbage.json\""), "garbage.json"),
        (camera("kind = \"mesh\"\nfile = \"no.json\""), "no.json"),
        (camera("kind = \"raymap\"\norigins = \"garbage.npy\"\ndirections = \"garbage.npy\""), "garbage.npy"),
        (camera("kind = \"raymap\"\norigins = \"no.npy\"\ndirections = \"no.npy\""), "no.npy"),
        (mesh("file = \"garbage.obj\""), "garbage.obj"),
        (mesh("file = \"empty.obj\""), "empty.obj"),
        (mesh("file = \"range.obj\""), "range.obj"),
        (mesh("file = \"nan.obj\""), "nan.obj"),
        (mesh("file = \"no.obj\""), "no.obj"),
        (mesh("file = \"garbage.glb\""), "garbage.glb"),
        (mesh("file = \"scene.toml\""), "unknown kind of mesh"),
        (mesh("builtin = \"citi\""), "city"),
        (mesh("builtin = \"city\"\ntriangles = 1"), "triangles = 1"),
        (mesh("builtin = \"box\"\nscale = 1e308\ntranslate = [1.7e308, 1.7e308, 0]"), "finite"),
        (SCENE.to_owned() + "[[light]]\ndirection = [0, 0, 0]\n", "direction"),
        (SCENE.to_owned() + "[output]\ncolour = \"o.png\"\n", "color"),
    ] {
        place.write("scene.toml", &text);
        // the command line's errors come first, the scene's before anything is opened or written
        let before = place.names();
        let ran = place.run(&["render", "scene.toml", "-o", "missing/out.png"]);
        assert_one_line(&ran, &text);
        assert!(ran.code == 2 && ran.err.contains(says), "{text}\n{says:?} not in: {}", ran.err);
        assert_eq!(place.names(), before, "{text}");
    }
}

#[test]
fn wrong_exr_files() {
    let place = Place::new();
    place.write("garbage.exr", [3u8; 500]);
    place.write("empty.exr", "");
    place.works(&["render", "scene.toml", "--engine", "reference", "--exr", "a.exr"]);
    place.works(&["render", "scene.toml", "--engine", "reference", "--exr", "z.exr", "--channels", "Z"]);
    place.works(&["render", "scene.toml", "--engine", "reference", "--exr", "small.exr", "--size", "8x8"]);
    let whole = std::fs::read(place.path().join("a.exr")).unwrap();
    place.write("cut.exr", &whole[..whole.len() / 2]);
    for (a, b, says) in [
        ("garbage.exr", "a.exr", "garbage.exr: not an EXR"),
        ("a.exr", "empty.exr", "empty.exr: not an EXR"),
        ("cut.exr", "a.exr", "cut.exr: not an EXR"),
        ("a.exr", "small.exr", "differ in size"),
        ("a.exr", ".", ".: "),
    ] {
        place.refuses(&["compare", a, b], 2, says);
    }
    place.refuses(&["compare", "z.exr", "a.exr", "--scene", "scene.toml"], 2, "no channel triangle.id");
    place.refuses(&["compare", "a.exr", "a.exr", "--scene", "no.toml"], 2, "no.toml");
}

#[test]
fn outputs_that_cannot_be_written() {
    let place = Place::new();
    std::fs::create_dir(place.path().join("folder")).unwrap();
    for (args, says) in [
        (&["-o", "missing/out.png"][..], "create it first"),
        (&["-o", "folder"], "it is a folder"),
        (&["-o", "scene.toml/out.png"], "scene.toml"),
        (&["--exr", "missing/out.exr"], "create it first"),
        (&["--check", "--report", "missing/r.json"], "create it first"),
        (&["-o", "out.png", "--exr", "missing/out.exr"], "create it first"),
        #[cfg(target_os = "linux")]
        (&["-o", "/dev/full"], "No space left"),
        #[cfg(target_os = "linux")]
        (&["--exr", "/dev/full"], "No space left"),
        #[cfg(target_os = "linux")]
        (&["-o", "/proc/no.png"], "/proc/no.png"),
        (&["-o", "out.png", "--size", "65536x16384"], "memory"),
    ] {
        place.refuses(&[&["render", "scene.toml", "--engine", "reference"], args].concat(), 1, says);
    }
    for flag in ["--export", "--export-povray", "--rays"] {
        place.refuses(&["camera", "scene.toml", flag, "missing/x"], 1, "create it first");
    }
    place.refuses(&["example", "pinhole", "--out", "scene.toml"], 1, "scene.toml");
    place.write("pinhole.toml", "mine");
    place.refuses(&["example", "pinhole"], 1, "other content");
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_or_closed_stdout() {
    let place = Place::new();
    let full = std::fs::File::options().write(true).open("/dev/full").unwrap();
    let output = place.command(&["example", "--list"]).stdout(full).output().unwrap();
    let code = output.status.code().unwrap();
    let ran = Ran { code, out: String::new(), err: String::from_utf8(output.stderr).unwrap() };
    assert_one_line(&ran, "full stdout");
    assert!(code == 1 && ran.err.contains("stdout"), "{}", ran.err);

    let (reader, writer) = std::io::pipe().unwrap();
    drop(reader);
    let output = place.command(&["camera", "--help", "mesh"]).stdout(writer).output().unwrap();
    assert_eq!((output.status.code(), output.stderr.as_slice()), (Some(0), &b""[..]));
}
