//! EXR headers: names of objects and materials, the camera with all its keys, the hash of the scene; and cameras read back from them.

use super::program::{Place, SCENE};
use anamorph::internals::image::frame::{Channel, NO_ID};
use anamorph::internals::image::{read_exr, read_exr_texts, write_npy_f64, write_png};
use anamorph::internals::input::Loading;
use exr::meta::MetaData;
use serde_json::Value;

/// A text attribute of a header.
fn text(place: &Place, file: &str, name: &str) -> String {
    let texts = read_exr_texts(&place.path().join(file), &Loading::default()).unwrap();
    texts.into_iter().find(|(own, _)| own == name).unwrap_or_else(|| panic!("{file}: no {name}")).1
}

fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap()
}

/// Renders a scene's depth by the reference.
fn render(place: &Place, scene: &str, exr: &str, more: &[&str]) -> String {
    place.works(&[&["render", scene, "--engine", "reference", "--channels", "Z", "--exr", exr][..], more].concat())
}

/// The bytes of a camera's rays.
fn rays(place: &Place, camera: &str, more: &[&str]) -> Vec<u8> {
    place.works(&[&["camera", camera, "--rays", "rays.npy"][..], more].concat());
    let path = place.path().join("rays.npy");
    let bytes = std::fs::read(&path).unwrap();
    std::fs::remove_file(path).unwrap();
    bytes
}

#[test]
fn the_camera_in_a_header_makes_the_same_rays() {
    let place = Place::new();
    std::fs::create_dir(place.path().join("out")).unwrap();
    let size = ["--size", "36x24"];
    // some that read files, and some that look at the scene
    for name in [
        "pinhole",
        "mesh",
        "deformation",
        "surround",
        "tracked",
        "terrain-bottom-up",
        "curved",
        "lens",
        "mirror-ball",
        "twist",
    ] {
        place.works(&["example", name]);
        let scene = format!("{name}.toml");
        render(&place, &scene, "out/picture.exr", &size);
        let expected = rays(&place, &scene, &size);
        assert!(rays(&place, "out/picture.exr", &[]) == expected, "{name}");
    }
}

#[test]
fn overrides_and_keyframes_are_in_the_header() {
    let place = Place::new();
    let keyed = SCENE.replace("vfov = 40", "vfov = [{ frame = 0, value = 30 }, { frame = 7, value = 50 }]");
    place.write("keyed.toml", keyed.replace("[camera]", "[camera]\nt_range = [-1, inf]"));
    let change = ["--frame", "3", "--set", "camera.eye=[0.1, 0.7, 4.123456789012345]", "--size", "31x17"];
    render(&place, "keyed.toml", "a.exr", &change);
    let camera = json(&text(&place, "a.exr", "anamorph.camera"));
    let keys = &camera["keys"];
    // linear from 30 to 50, to the last bit
    assert_eq!(keys["vfov"], (30.0 * 4.0 + 50.0 * 3.0) / 7.0);
    assert_eq!((&keys["eye"][2], &keys["kind"]), (&4.123456789012345.into(), &"pinhole".into()));
    assert_eq!((&camera["width"], &camera["height"]), (&31.into(), &17.into()));
    assert_eq!((&camera["t_range"], &keys["t_range"]), (&json("[-1.0, \"inf\"]"), &json("[-1, \"inf\"]")));
    // the camera reads no files, so the header holds no folder
    assert!(camera.get("folder").is_none() && camera.get("mesh").is_none());
    assert!(rays(&place, "a.exr", &[]) == rays(&place, "keyed.toml", &change));
    // --set changes the camera of a header as that of a scene
    let wider = ["--set", "camera.vfov=80"];
    assert!(rays(&place, "a.exr", &wider) == rays(&place, "keyed.toml", &[&change[..], &wider].concat()));
    place.refuses(
        &["camera", "a.exr", "--rays", "r.npy", "--frame", "2"],
        2,
        "--frame: a.exr holds the camera of one frame only",
    );
    place.refuses(&["camera", "a.exr", "--export-povray", "r.pov"], 2, "a.exr holds a camera but no scene");
}

#[test]
fn a_camera_that_moved_while_its_picture_was_taken_is_not_read_back() {
    let place = Place::new();
    place.write("panned.toml", SCENE.replace("vfov = 40", "vfov = 40\nline_time = 0.01"));
    let keyed = "line_time = 0.01\nvfov = [{ frame = 0, value = 30 }, { frame = 7, value = 50 }]";
    place.write("zoomed.toml", SCENE.replace("vfov = 40", keyed));
    for name in ["panned", "zoomed"] {
        render(&place, &format!("{name}.toml"), &format!("{name}.exr"), &[]);
    }
    // lines are read one after another, and the camera stands still
    assert!(rays(&place, "panned.exr", &[]) == rays(&place, "panned.toml", &[]));
    place.refuses(
        &["camera", "zoomed.exr", "--rays", "r.npy"],
        2,
        "zoomed.exr: its camera moved while the picture was taken",
    );
}

#[test]
fn a_camera_in_a_header_reads_its_files_again() {
    let place = Place::new();
    for folder in ["scenes", "maps", "out"] {
        std::fs::create_dir(place.path().join(folder)).unwrap();
    }
    let map = |name: &str, value: fn(f64) -> f64| {
        let numbers: Vec<f64> = (0..5 * 4 * 3).map(|k| value(f64::from(k) / 7.0)).collect();
        write_npy_f64(&place.path().join("maps").join(name), &[4, 5, 3], &numbers).unwrap();
    };
    map("p.npy", f64::sin);
    map("d.npy", f64::cos);
    let camera = "[camera]\nkind = \"raymap\"\norigins = \"../maps/p.npy\"\ndirections = \"../maps/d.npy\"\n";
    place.write("scenes/map.toml", camera);
    render(&place, "scenes/map.toml", "out/map.exr", &[]);
    assert!(rays(&place, "out/map.exr", &[]) == rays(&place, "scenes/map.toml", &[]));
    assert_eq!(json(&text(&place, "out/map.exr", "anamorph.camera"))["folder"], "../scenes");
    // picture and files are moved together
    std::fs::create_dir(place.path().join("moved")).unwrap();
    for folder in ["scenes", "maps", "out"] {
        std::fs::rename(place.path().join(folder), place.path().join("moved").join(folder)).unwrap();
    }
    rays(&place, "moved/out/map.exr", &[]);
    std::fs::remove_file(place.path().join("moved/maps/d.npy")).unwrap();
    place.refuses(&["camera", "moved/out/map.exr", "--rays", "r.npy"], 2, "d.npy: ");
}

#[test]
fn pictures_without_a_camera_are_refused() {
    let place = Place::new();
    let frame = anamorph::internals::image::frame::Frame {
        width: 1,
        height: 1,
        planes: vec![(Channel::Z, anamorph::internals::image::frame::Plane::F32(vec![1.0]))],
    };
    anamorph::internals::image::write_exr(&place.path().join("other.exr"), &frame, &[]).unwrap();
    place.refuses(&["camera", "other.exr", "--rays", "r.npy"], 2, "other.exr: its header holds no camera");
    let old = [("anamorph.camera".to_owned(), "{\"kind\": \"pinhole\"}".to_owned())];
    anamorph::internals::image::write_exr(&place.path().join("old.exr"), &frame, &old).unwrap();
    place.refuses(
        &["camera", "old.exr", "--rays", "r.npy"],
        2,
        "old.exr: its header does not hold the keys of the camera",
    );
    place.write("no.exr", "no picture");
    place.refuses(&["camera", "no.exr", "--rays", "r.npy"], 2, "no.exr: not an EXR image");
    place.refuses(&["camera", "gone.exr", "--rays", "r.npy"], 2, "gone.exr: cannot be read");
}

/// A point, as a row vector, times a matrix of OpenEXR, divided by the fourth coordinate.
fn times(point: [f64; 3], m: [f32; 16]) -> [f64; 3] {
    let row = [point[0], point[1], point[2], 1.0];
    let sum = |column: usize| (0..4).map(|k| row[k] * f64::from(m[4 * k + column])).sum::<f64>();
    [0, 1, 2].map(|column| sum(column) / sum(3))
}

#[test]
fn matrices_are_those_of_openexr() {
    let place = Place::new();
    let header = |file: &str| {
        let meta = MetaData::read_from_file(place.path().join(file), false).unwrap();
        let own = &meta.headers[0].own_attributes;
        (own.world_to_camera, own.world_to_normalized_device)
    };
    let eye = "eye = [1, 2, 8]\ntarget = [1, 2, 0]";
    let scene = |camera: &str| format!("[image]\nwidth = 80\nheight = 40\n[camera]\n{camera}\n");
    place.write("pinhole.toml", scene(&format!("kind = \"pinhole\"\n{eye}\nvfov = 90")));
    place.write("parallel.toml", scene(&format!("kind = \"orthographic\"\n{eye}\nheight = 4")));
    place.write("fisheye.toml", scene(&format!("kind = \"fisheye\"\n{eye}\nfov = 120")));
    place.write(
        "glc.toml",
        scene("kind = \"glc\"\nnear = [[0, 1, 0], [1, 1, 0], [0, 0, 0]]\nfar = [[0, 1, -1], [1, 1, -1], [0, 0, -1]]"),
    );
    let near = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-5);
    for name in ["pinhole", "parallel", "fisheye"] {
        render(&place, &format!("{name}.toml"), &format!("{name}.exr"), &[]);
        // relative to the eye: right, up, and forward, which is -z here
        let to_camera = header(&format!("{name}.exr")).0.unwrap();
        let got = times([1.5, 2.25, 5.0], to_camera);
        assert!(near(got, [0.5, 0.25, 3.0]), "{name}: {got:?}");
    }
    let flat = |p: [f64; 3]| [p[0], p[1], 0.0];
    let to_image = header("pinhole.exr").1.unwrap();
    // vfov is 90 degrees: at distance 3 the image reaches 3 above its centre and 6 to the right
    for (point, place) in
        [([1.0, 2.0, 5.0], [0.5, 0.5]), ([7.0, 5.0, 5.0], [1.0, 0.0]), ([-2.0, 0.5, 5.0], [0.25, 0.75])]
    {
        let got = flat(times(point, to_image));
        assert!(near(got, [place[0], place[1], 0.0]), "{point:?}: {got:?}");
    }
    let to_image = header("parallel.exr").1.unwrap();
    for (point, place) in
        [([1.0, 2.0, 5.0], [0.5, 0.5]), ([5.0, 4.0, 3.0], [1.0, 0.0]), ([-1.0, 1.0, 0.0], [0.25, 0.75])]
    {
        let got = flat(times(point, to_image));
        assert!(near(got, [place[0], place[1], 0.0]), "{point:?}: {got:?}");
    }
    assert_eq!(header("fisheye.exr").1, None);
    render(&place, "glc.toml", "glc.exr", &[]);
    assert_eq!(header("glc.exr"), (None, None));
}

#[test]
fn all_channels_and_the_names_of_objects_and_materials() {
    let place = Place::new();
    let box_at = |x: f64, more: &str| format!("[[mesh]]\nbuiltin = \"box\"\ntranslate = [{x}, 0, 0]\n{more}\n");
    let meshes = box_at(-1.2, "name = \"left\"") + &box_at(1.2, "color = [1, 0, 0]");
    place.write("boxes.toml", SCENE.replace("[[mesh]]\nbuiltin = \"icosphere\"\nlevel = 2\n", &meshes));
    let of = |scene: &str, list: &str, more: &[&str]| {
        let args = ["render", scene, "--engine", "reference", "--channels", list, "--exr", "a.exr"];
        place.works(&[&args[..], more].concat());
        read_exr(&place.path().join("a.exr"), &Loading::default()).unwrap()
    };
    let names = |frame: &anamorph::internals::image::frame::Frame| {
        frame.planes.iter().map(|p| p.0.name()).collect::<Vec<_>>().join(" ")
    };
    let without_uv =
        "R G B A Z t triangle.id piece.id bary.u bary.v N.X N.Y N.Z P.X P.Y P.Z albedo.R albedo.G albedo.B";
    // boxes have texture coordinates, balls do not
    let all = of("boxes.toml", "all", &[]);
    assert_eq!(names(&all), format!("{without_uv} uv.U uv.V view.X view.Y view.Z object.id material.id"));
    assert_eq!(
        names(&of("scene.toml", "all", &[])),
        format!("{without_uv} view.X view.Y view.Z object.id material.id")
    );
    let ids = of("boxes.toml", "object.id,material.id", &["--samples", "4"]);
    for (channel, count) in [(Channel::ObjectId, 2), (Channel::MaterialId, 2)] {
        let plane = ids.u32(channel).unwrap();
        assert_eq!(Some(plane), all.u32(channel));
        assert!(
            (0..count).chain([NO_ID]).all(|k| plane.contains(&k)) && plane.iter().all(|k| *k < count || *k == NO_ID)
        );
    }
    // the left box is the first
    let left = ids.u32(Channel::ObjectId).unwrap().iter().position(|k| *k != NO_ID).unwrap();
    assert_eq!(ids.u32(Channel::ObjectId).unwrap()[left], 0);
    assert_eq!(text(&place, "a.exr", "anamorph.objects"), "[\"left\",\"box\"]");
    assert_eq!(json(&text(&place, "a.exr", "anamorph.materials")).as_array().unwrap().len(), 2);
    of("boxes.toml", "Z", &[]);
    let texts = read_exr_texts(&place.path().join("a.exr"), &Loading::default()).unwrap();
    assert!(!texts.iter().any(|(name, _)| name == "anamorph.objects" || name == "anamorph.materials"));
    if place.has_adapter() {
        place.works(&["render", "boxes.toml", "--channels", "all", "--exr", "gpu.exr"]);
        assert_eq!(names(&read_exr(&place.path().join("gpu.exr"), &Loading::default()).unwrap()), names(&all));
    }
}

#[test]
fn a_scene_with_another_hash_than_the_picture_is_noted() {
    let place = Place::new();
    let exr = |name: &str, more: &[&str]| {
        place.works(&[&["render", "scene.toml", "--engine", "reference", "--exr", name][..], more].concat());
    };
    exr("a.exr", &[]);
    exr("b.exr", &["--set", "mesh.0.scale=1.01"]);
    let with = |args: &[&str]| place.works(&[&["compare"][..], args].concat());
    let own = with(&["a.exr", "a.exr", "--scene", "scene.toml"]);
    assert!(!own.contains("note:"), "{own}");
    let foreign = with(&["a.exr", "b.exr", "--scene", "scene.toml"]);
    let note = "note: b.exr has another scene hash than scene.toml";
    assert!(foreign.lines().nth(1).unwrap().starts_with(note), "{foreign}");
    assert_eq!(foreign.lines().count(), 2);
    let notes = json(&with(&["a.exr", "b.exr", "--scene", "scene.toml", "--json"]))["notes"].clone();
    assert_eq!(notes.as_array().unwrap().len(), 1);
    // with the changes it was rendered with, the scene has the picture's hash
    let changed = with(&["b.exr", "b.exr", "--scene", "scene.toml", "--set", "mesh.0.scale=1.01"]);
    assert!(!changed.contains("note:"), "{changed}");
}

#[test]
fn a_lens_counts_in_the_hash_of_a_scene_and_a_thrown_picture_does_not() {
    let place = Place::new();
    let notes = |scene: &str, more: &[&str]| {
        let args =
            ["render", scene, "--engine", "reference", "--size", "12x8", "--channels", "triangle.id", "--exr", "a.exr"];
        place.works(&[&args[..], more].concat());
        let judged = json(&place.works(&["compare", "a.exr", "a.exr", "--scene", scene, "--json"]));
        judged["notes"].as_array().unwrap().len()
    };
    place.works(&["example", "glass-ball"]);
    assert_eq!(notes("glass-ball.toml", &[]), 0);
    assert_eq!(notes("glass-ball.toml", &["--set", "camera.ior=1.4"]), 1);
    // it is not read where no colour is asked for
    write_png(&place.path().join("red.png"), 1, 1, &[200, 10, 10]).unwrap();
    let camera = "{ kind = \"pinhole\", eye = [0, 1, 4], target = [0, 0, 0], vfov = 40 }";
    place.write("thrown.toml", format!("{SCENE}\n[[projector_light]]\nimage = \"red.png\"\ncamera = {camera}\n"));
    assert_eq!(notes("thrown.toml", &[]), 0);
}

#[test]
fn the_compared_channels_are_named() {
    let place = Place::new();
    let exr = |name: &str, channels: &str, eye: &str| {
        let eye = format!("camera.eye=[0, 0.5, {eye}]");
        let args =
            ["render", "scene.toml", "--engine", "reference", "--channels", channels, "--exr", name, "--set", &eye];
        place.works(&args);
    };
    exr("near.exr", "Z", "4");
    exr("far.exr", "Z", "8");
    exr("colour.exr", "R,G,B", "4");
    let line = place.works(&["compare", "near.exr", "far.exr"]);
    assert!(line.starts_with("3072 pixels of Z, ") && line.contains("Z error where both hit median "), "{line}");
    let wrong = json(&place.works(&["compare", "near.exr", "far.exr", "--json"]))["wrong_hit_miss"].as_u64();
    assert!(wrong > Some(100), "{wrong:?}");
    place.refuses(&["compare", "near.exr", "colour.exr"], 2, "nothing to compare: the first image has Z");
}

#[test]
fn a_target_that_cannot_be_tracked_is_reported_and_the_frame_rendered() {
    let place = Place::new();
    let boxed = SCENE.replace("kind = \"pinhole\"", "kind = \"track\"\ntargets = [{ at = [0, 0, 0] }]");
    place.write("track.toml", boxed);
    let line = render(&place, "track.toml", "t.exr", &["--report", "r.json"]);
    assert!(line.contains(" | target 0 is not tracked: every detour around its occluders is blocked"), "{line}");
    assert_eq!(line.lines().count(), 1);
    let report = json(&std::fs::read_to_string(place.path().join("r.json")).unwrap());
    assert!(report["unmet"][0].as_str().unwrap().starts_with("target 0 is not tracked"));
    render(&place, "scene.toml", "p.exr", &[]);
    let [tracked, plain] =
        ["t.exr", "p.exr"].map(|name| read_exr(&place.path().join(name), &Loading::default()).unwrap());
    assert_eq!(tracked, plain);
    assert!(place.works(&["camera", "track.toml"]).contains("note     target 0 is not tracked"));
}
