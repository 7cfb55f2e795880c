//! Renders, comparisons, cameras and examples that work.

use super::program::{Place, SCENE};
use anamorph::internals::image::frame::{Channel, Frame};
use anamorph::internals::image::read_exr;
use anamorph::internals::input::Loading;
use serde_json::Value;
use std::time::Instant;

fn frame(place: &Place, name: &str) -> Frame {
    read_exr(&place.path().join(name), &Loading::default()).unwrap()
}

fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap()
}

fn json_file(place: &Place, name: &str) -> Value {
    json(&std::fs::read_to_string(place.path().join(name)).unwrap())
}

/// Renders the demo small with all outputs, and looks into each of them.
fn renders_with(place: &Place, engine: &str) {
    place.works(&["example", "demo"]);
    let started = Instant::now();
    let line = place.works(
        &[
            &["render", "demo.toml", "--engine", engine, "--size", "64x48"][..],
            &["--exr", "all.exr", "--report", "r.json", "--check", "--repeat", "3"],
        ]
        .concat(),
    );
    let program_ms = started.elapsed().as_secs_f64() * 1e3;
    let is_told = |text: &str| line.contains(text);
    assert!(
        is_told("demo.png") && is_told(" 64x48 | 48000 triangles, 1 piece | call ") && is_told(", frame "),
        "{line}"
    );
    assert_eq!(line.lines().count(), 1, "{line}");
    let picture = image::open(place.path().join("demo.png")).unwrap();
    assert_eq!((picture.width(), picture.height(), picture.color()), (64, 48, image::ColorType::Rgb8));
    let all = frame(place, "all.exr");
    // no mirror, no mirror.id
    assert_eq!(all.planes.iter().map(|p| p.0).collect::<Vec<_>>(), Channel::ALL[..10]);
    assert!(all.f32(Channel::A).unwrap().contains(&1.0) && all.f32(Channel::Z).unwrap().contains(&f32::INFINITY));

    let report = json_file(place, "r.json");
    for key in [
        "adapter",
        "driver",
        "engine",
        "width",
        "height",
        "triangles",
        "pieces",
        "frame_ms",
        "call_ms",
        "stages",
        "pairs_tested",
        "pairs_kept",
        "fragments_tested",
        "fragments_kept",
        "rechecked",
        "bytes",
        "left_out",
        "grown",
        "passes",
        "stage_passes",
        "operations",
        "rechecked_share",
        "error",
    ] {
        assert!(report.get(key).is_some(), "{key} is missing");
    }
    assert_eq!((&report["engine"], &report["width"], &report["height"]), (&engine.into(), &64.into(), &48.into()));
    assert_eq!((&report["triangles"], &report["pieces"]), (&48000.into(), &1.into()));
    let ms = |key: &str| report["frame_ms"][key].as_f64().unwrap();
    assert!(
        report["frame_ms"]["runs"] == 3 && 0.0 < ms("min") && ms("min") <= ms("median") && ms("median") <= ms("max")
    );
    let call = |part: &str| report["call_ms"][part].as_f64().unwrap();
    let parts = ["read", "camera", "place", "plan", "upload", "compile", "wait", "read_back", "encode"].map(call);
    assert!(["read", "wait", "encode"].iter().all(|part| call(part) > 0.0), "{}", report["call_ms"]);
    assert!(parts.iter().sum::<f64>() <= call("total"), "{}", report["call_ms"]);
    // the total leaves out the repeated frames and the check
    assert!(call("total") + 3.0 * ms("min") < program_ms, "{} of {program_ms}", report["call_ms"]);
    assert_eq!((&report["error"]["wrong_safe"], &report["error"]["not_near"]), (&0.into(), &0.into()));
    let count = |key: &str| report[key].as_u64();
    if engine == "compute" {
        assert!(count("pairs_kept") > Some(0) && count("fragments_kept") > Some(0) && count("bytes") > Some(0));
        assert!(report["left_out"].as_array().unwrap().iter().all(|l| l["what"] != "fragment counters"));
        let stages = report["stage_passes"].as_array().unwrap();
        let passes = |name: &str| stages.iter().find(|s| s["name"] == name).and_then(|s| s["passes"].as_u64());
        assert_eq!((passes("cull"), passes("shade"), passes("write")), (Some(1), Some(1), None));
        assert_eq!(stages.iter().filter_map(|s| s["passes"].as_u64()).sum::<u64>(), report["passes"]);
        // each stage processes at most what the one before may queue
        let of = |key: &str| report["operations"][key].as_u64().unwrap();
        assert!(of("split_items") > 0 && of("bin_items") <= 8 * of("split_items"), "{report}");
        assert!(of("large_items") <= 8 * of("bin_items") && of("recheck_pixels") > 0, "{report}");
        assert_eq!((of("edge_pixels"), of("recheck_sample_items")), (0, 0));
        let share = report["rechecked"].as_f64().unwrap() / report["fragments_tested"].as_f64().unwrap();
        assert!(report["rechecked_share"] == share && share < 0.1, "{report}");
    } else {
        assert!(report["pairs_kept"].is_null() && report["bytes"].is_null() && report["adapter"] == "cpu");
        assert!(report["passes"].is_null() && report["operations"].is_null() && report["rechecked_share"].is_null());
    }
}

#[test]
fn without_a_command_the_help_is_printed() {
    let place = Place::new();
    let help = place.works(&[]);
    assert!(help.contains("Usage: anamorph <COMMAND>") && help.contains("Render one scene"), "{help}");
}

#[test]
fn the_reference_renders() {
    renders_with(&Place::new(), "reference");
}

#[test]
fn the_compute_engine_renders_what_the_reference_does() {
    let place = Place::new();
    if !place.has_adapter() {
        return;
    }
    renders_with(&place, "compute");
    let reference = ["render", "demo.toml", "--engine", "reference", "--size", "64x48", "--exr", "truth.exr"];
    place.works(&reference);
    let compared = json(&place.works(&["compare", "all.exr", "truth.exr", "--scene", "demo.toml", "--json"]));
    assert_eq!((&compared["wrong_safe"], &compared["not_near"]), (&0.into(), &0.into()));
    assert_eq!(compared["pixels"], 64 * 48);
    // all samples in one frame
    place.works(&["render", "demo.toml", "--size", "64x48", "-o", "s.png", "--report", "s.json", "--samples", "4"]);
    let report = json_file(&place, "s.json");
    let shade = report["stage_passes"].as_array().unwrap().iter().find(|s| s["name"] == "shade").unwrap().clone();
    assert_eq!(shade["passes"], 1);
    assert!(report["operations"]["edge_pixels"].as_u64() > Some(0), "{report}");
    let dump = ["render", "demo.toml", "--size", "64x48", "-o", "d.png", "--dump-kernels", "kernels"];
    place.works(&dump);
    let names: Vec<_> =
        std::fs::read_dir(place.path().join("kernels")).unwrap().map(|f| f.unwrap().file_name()).collect();
    assert!(
        ["cull.wgsl", "raster.wgsl", "shade.wgsl"].iter().all(|own| names.iter().any(|name| name == own)),
        "{names:?}"
    );
    let moving = ["render", "demo.toml", "--size", "64x48", "--repeat", "2", "--moving", "--no-int64"];
    place.works(&moving);
}

#[test]
fn only_channels_that_are_asked_for_are_written() {
    let place = Place::new();
    place.write("scene.toml", SCENE.to_owned() + "[output]\ncolor = \"a.png\"\nexr = \"a.exr\"\n");
    let by_reference = ["render", "scene.toml", "--engine", "reference", "--channels", "Z,R,Z"];
    place.works(&by_reference);
    assert_eq!(place.names(), ["a.exr", "a.png", "scene.toml"]);
    let channels = |name| frame(&place, name).planes.iter().map(|p| p.0).collect::<Vec<_>>();
    assert_eq!(channels("a.exr"), [Channel::R, Channel::Z]);
    // flags win over [output]
    place.works(&[&by_reference[..], &["--exr", "b.exr", "-o", "b.png"]].concat());
    assert_eq!(place.names(), ["a.exr", "a.png", "b.exr", "b.png", "scene.toml"]);
    if place.has_adapter() {
        place.works(&["render", "scene.toml", "--channels", "triangle.id", "--exr", "c.exr"]);
        assert_eq!(channels("c.exr"), [Channel::TriangleId]);
        assert_eq!(frame(&place, "c.exr").planes[0].1, frame_of_ids(&place));
    }
}

/// The layers of a Cryptomatte hold every sample once, and its names are distinguished.
#[test]
fn cryptomattes_share_pixels_out() {
    let place = Place::new();
    let boxes = "mesh = [{ builtin = \"box\", color = [1, 0, 0] }, { builtin = \"box\", translate = [0.9, 0.2, 0] }]\n";
    let camera = "[camera]\nkind = \"pinhole\"\neye = [1, 2, 5]\ntarget = [0.4, 0, 0]\nvfov = 40\n";
    place.write("boxes.toml", format!("image = {{ width = 40, height = 30 }}\n{boxes}{camera}"));
    let layers = "crypto.object,crypto.material,A";
    let args =
        ["render", "boxes.toml", "--exr", "m.exr", "--samples", "4", "--engine", "reference", "--channels", layers];
    place.works(&args);

    let image = exr::prelude::read_first_flat_layer_from_file(place.path().join("m.exr")).unwrap();
    let plane = |name: &str| -> Vec<f32> {
        let channel = image.layer_data.channel_data.list.iter().find(|c| c.name.to_string() == name).expect(name);
        channel.sample_data.values_as_f32().collect()
    };
    let coverage = plane("A");
    // both boxes are of the one material that a builtin has
    for (layer, names) in [("CryptoObject", 2), ("CryptoMaterial", 1)] {
        let ranks: Vec<[Vec<f32>; 2]> = (0..3)
            .flat_map(|k| [["R", "G"], ["B", "A"]].map(|pair| pair.map(|c| plane(&format!("{layer}{k:02}.{c}")))))
            .collect();
        let shares = |k: usize| ranks.iter().map(|r| r[1][k]).collect::<Vec<f32>>();
        assert!(
            (0..coverage.len())
                .all(|k| shares(k).iter().sum::<f32>() == coverage[k] && shares(k).is_sorted_by(|a, b| a >= b))
        );
        let mixed = (0..coverage.len()).filter(|&k| shares(k)[1] > 0.0).count();
        let ids: std::collections::BTreeSet<u32> =
            ranks[0][0].iter().map(|id| id.to_bits()).filter(|id| *id != 0).collect();
        assert!(
            (mixed > 5) == (names == 2) && ids.len() == names,
            "{layer}: {mixed} pixels of two, {} names",
            ids.len()
        );
        let text = |key: &str| {
            let of = |(name, value): (&exr::meta::attribute::Text, &exr::meta::attribute::AttributeValue)| match value {
                exr::meta::attribute::AttributeValue::Text(text) if name.to_string().ends_with(key) => {
                    Some(text.to_string())
                }
                _ => None,
            };
            image.layer_data.attributes.other.iter().filter_map(of).collect::<Vec<String>>()
        };
        assert!(text("/name").contains(&layer.to_owned()) && text("/hash") == ["MurmurHash3_32"; 2]);
        let manifest = text("/manifest").join(" ");
        assert!(ids.iter().all(|id| manifest.contains(&format!("{id:08x}"))), "{layer}: {manifest}");
    }
    place.refuses(&["render", "boxes.toml", "-o", "m.png", "--channels", "crypto.object"], 2, "--exr");
}

/// The ids of the reference's frame of `scene.toml`.
fn frame_of_ids(place: &Place) -> anamorph::internals::image::frame::Plane {
    let args = ["render", "scene.toml", "--engine", "reference", "--channels", "triangle.id", "--exr", "ids.exr"];
    place.works(&args);
    frame(place, "ids.exr").planes.remove(0).1
}

#[test]
fn frames_compare() {
    let place = Place::new();
    let render = |name: &str, set: &str| {
        place.works(&["render", "scene.toml", "--engine", "reference", "--exr", name, "--set", set]);
    };
    render("a.exr", "camera.vfov=40");
    render("b.exr", "camera.vfov=41");
    let same = place.works(&["compare", "a.exr", "a.exr", "--scene", "scene.toml"]);
    assert!(same.contains("0 with the wrong triangle") && same.contains("colour identical"), "{same}");
    assert_eq!(json(&place.works(&["compare", "a.exr", "a.exr", "--json"]))["identical"], true);
    let different = place.works(&["compare", "a.exr", "b.exr"]);
    assert!(different.contains("PSNR") && !different.contains("identical"), "{different}");
    assert!(json(&place.works(&["compare", "a.exr", "b.exr", "--json"]))["wrong_triangle"].as_u64() > Some(0));
}

#[test]
fn more_samples_smooth_edges_and_leave_ids() {
    let place = Place::new();
    let render = |name: &str, samples: &str| {
        place.works(&["render", "scene.toml", "--engine", "reference", "--exr", name, "--samples", samples]);
        frame(&place, name)
    };
    let (one, four) = (render("1.exr", "1"), render("4.exr", "4"));
    for channel in [Channel::Z, Channel::T, Channel::BaryU] {
        assert_eq!(one.f32(channel), four.f32(channel));
    }
    assert_eq!(one.u32(Channel::TriangleId), four.u32(Channel::TriangleId));
    let partly = |f: &Frame| f.f32(Channel::A).unwrap().iter().filter(|a| **a > 0.0 && **a < 1.0).count();
    assert!(partly(&one) == 0 && partly(&four) > 10);
    assert!(four.f32(Channel::A).unwrap().iter().all(|a| (a * 4.0).fract() == 0.0));
}

#[test]
fn frames_pick_between_keys() {
    let place = Place::new();
    let keys = "[{ frame = 0, value = [-2, 0, 0] }, { frame = 4, value = [2, 0, 0] }]";
    let moving = SCENE.replace("level = 2", &format!("level = 2\ntranslate = {keys}"));
    place.write(
        "moving.toml",
        moving.replace("width = 64", "width = [{ frame = 0, value = 64 }, { frame = 4, value = 96 }]"),
    );
    let bytes = |name: &str| std::fs::read(place.path().join(name)).unwrap();
    for (frame, x, width) in [("-1", "-2", "64"), ("1", "-1", "72"), ("4", "2", "96"), ("99", "2", "96")] {
        let render = ["--engine", "reference", "--exr"];
        place.works(&[&["render", "moving.toml", "--frame", frame], &render[..], &["a.exr"]].concat());
        let (at, width) = (format!("mesh.0.translate=[{x}, 0, 0]"), format!("image.width={width}"));
        place.works(&[&["render", "scene.toml", "--set", &at, "--set", &width], &render[..], &["b.exr"]].concat());
        assert_eq!(bytes("a.exr"), bytes("b.exr"), "frame {frame}");
    }
    // --set comes first: it may change a key, or give all of them
    place.works(&["camera", "moving.toml", "--frame", "2", "--set", "image.width.1.value=66", "--rays", "r.npy"]);
    assert!(String::from_utf8_lossy(&bytes("r.npy")[..128]).contains("(48, 65, 6"));
    let set = "camera.vfov=[{frame=0, value=30}, {frame=10, value=50}]";
    place.works(&["render", "scene.toml", "--set", set, "--frame", "5", "--engine", "reference", "--exr", "a.exr"]);
    place.works(&["render", "scene.toml", "--engine", "reference", "--exr", "b.exr"]);
    assert_eq!(bytes("a.exr"), bytes("b.exr"));
}

#[test]
fn same_scene_same_bytes() {
    let place = Place::new();
    let render = |name: &str| place.works(&["render", "scene.toml", "--engine", "reference", "--exr", name]);
    render("a.exr");
    render("b.exr");
    let bytes = |name: &str| std::fs::read(place.path().join(name)).unwrap();
    assert_eq!(bytes("a.exr"), bytes("b.exr"));
    let header = String::from_utf8_lossy(&bytes("a.exr")[..2000]).into_owned();
    for text in ["distance from P to the hit along the ray", "anamorph.scene_hash", "\"kind\":\"pinhole\""] {
        assert!(header.contains(text), "{text}");
    }
}

#[test]
fn an_exported_camera_has_the_same_rays() {
    let place = Place::new();
    for example in ["pinhole", "bilinear", "panorama"] {
        place.works(&["example", example]);
        let scene = format!("{example}.toml");
        let printed = place.works(&["camera", &scene, "--size", "32x24", "--export", "p.json", "--rays", "r.npy"]);
        assert!(printed.contains("pieces") && printed.contains("class"), "{printed}");
        let bytes = std::fs::read(place.path().join("r.npy")).unwrap().len();
        assert_eq!(bytes % 64, 0);
        assert!(bytes > 32 * 24 * 6 * 8 && bytes < 32 * 24 * 6 * 8 + 256);
        let text = std::fs::read_to_string(place.path().join(&scene)).unwrap();
        let again =
            text.split("[camera]").next().unwrap().to_owned() + "[camera]\nkind = \"mesh\"\nfile = \"p.json\"\n";
        place.write("again.toml", again);
        for (scene, exr) in [(scene.as_str(), "a.exr"), ("again.toml", "b.exr")] {
            let args = ["render", scene, "--engine", "reference", "--size", "32x24", "--exr", exr, "-o", "o.png"];
            place.works(&args);
        }
        let compared = json(&place.works(&["compare", "b.exr", "a.exr", "--scene", &scene, "--json"]));
        assert_eq!(compared["wrong_safe"], 0, "{example}");
    }
    place.works(&["example", "fisheye"]);
    assert!(place.works(&["camera", "fisheye.toml"]).contains("a ray of its own"));
    let before = place.names();
    let ran = place.run(&["camera", "fisheye.toml", "--export", "q.json"]);
    assert!(ran.code == 2 && ran.err.contains("use --rays"), "{}", ran.err);
    assert_eq!(place.names(), before);
}

#[test]
fn a_scene_for_povray_has_a_ray_for_each_pixel_and_a_colour_for_each_triangle() {
    let place = Place::new();
    let export = |more: &[&str]| {
        place.works(&[&["camera", "scene.toml", "--size", "8x6", "--export-povray", "s.pov"], more].concat());
        std::fs::read_to_string(place.path().join("s.pov")).unwrap()
    };
    let count = |text: &str, start: &str| text.lines().filter(|l| l.starts_with(start)).count();
    let text = export(&[]);
    assert_eq!((count(&text, "mesh {"), count(&text, "triangle {")), (48, 320));
    assert!(text.contains("+I\"s.pov\" +O\"s.png\"") && text.contains("+W8 +H7"), "{}", &text[..400]);
    assert!(text.contains("rgb <63,1,0>/255") && !text.contains("rgb <64,1,0>/255") && !text.contains("rgbt"));
    // one-sided triangles are clear from behind; rays of one length end
    assert_eq!(export(&["--set", "mesh.0.two_sided=false"]).matches("rgbt 1").count(), 320);
    let parallel = "camera={kind=\"orthographic\", eye=[0, 0, 4], target=[0, 0, 0], height=2, t_range=[-1, 4]}";
    let ended = export(&["--set", parallel]);
    let camera = ended.lines().find_map(|l| l.strip_prefix("camera { mesh_camera { 1 1 ")).unwrap();
    // 5 world units of 2^k
    assert_eq!((camera.parse::<f64>().unwrap() / 5.0).log2().fract(), 0.0, "{camera}");
}

#[test]
fn classes_and_slits_are_named() {
    let place = Place::new();
    for (example, says) in [
        ("pinhole", "class    pinhole, rays meet at t = 0"),
        ("orthographic", "class    orthographic"),
        ("pushbroom", "class    pushbroom, slit at"),
        ("cross-slit", "class    cross-slit, slits at"),
        ("pencil", "class    pencil, slit at"),
        ("bilinear", "class    bilinear"),
        ("mesh", "450 of pinhole"),
        ("panorama", "96 of "),
    ] {
        place.works(&["example", example]);
        let printed = place.works(&["camera", &format!("{example}.toml")]);
        assert!(printed.contains(says), "{example}: {printed}");
    }
}

#[test]
fn texts_are_printed() {
    let place = Place::new();
    assert!(place.works(&["--help"]).contains("render"));
    assert!(place.works(&["--version"]).starts_with("anamorph "));
    assert!(place.works(&["render", "--help"]).contains("--samples"));
    assert!(place.works(&["camera", "--help"]).contains("Kinds of camera: pinhole"));
    assert!(place.works(&["camera", "--help", "mesh"]).contains("normalize"));
    let info = place.works(&["info"]);
    let backends = ["(vulkan, ", "(metal, ", "(dx12, "];
    assert!(info.starts_with("anamorph "), "{info}");
    assert_eq!(backends.iter().any(|backend| info.contains(backend)), place.has_adapter(), "{info}");
    let list = place.works(&["example", "--list"]);
    let examples = list.lines().filter(|line| line.starts_with("  ")).count();
    assert_eq!(examples, anamorph::internals::tools::example::EXAMPLES.len(), "{list}");
    let pixel = place.works(&["render", "scene.toml", "--pixel", "32,24"]);
    assert!(pixel.contains("hit: triangle") && pixel.contains("safe: "), "{pixel}");
}

/// Of a pixel behind a mirror the triangle is told that the picture shows, and where; of one on facets as of one on the surface itself.
#[test]
fn a_pixel_behind_a_mirror_is_explained() {
    let place = Place::new();
    for facets in ["exact", "normals", "flat"] {
        let eye = "eye = { kind = \"pinhole\", eye = [0, 0, 5], target = [0, 0, 0], vfov = 40 }";
        let mirror = "mirror = { shape = \"sphere\", center = [0, 0, 0], radius = 1 }";
        let scene = format!(
            "image = {{ width = 64, height = 48 }}\nmesh = [{{ builtin = \"plane\", size = 12, divisions = 1, translate = [0, -1.1, 0] }}]\n\
             [camera]\nkind = \"reflection\"\n{eye}\n{mirror}\nfacets = \"{facets}\"\n"
        );
        place.write("mirror.toml", scene);
        place.works(&[
            "render",
            "mirror.toml",
            "--engine",
            "reference",
            "--exr",
            "m.exr",
            "--channels",
            "triangle.id,P.Y",
        ]);
        let shown = frame(&place, "m.exr");
        let (ids, y) = (shown.u32(Channel::TriangleId).unwrap(), shown.f32(Channel::PositionY).unwrap());
        // below the middle the ball shows the floor
        let at = 34 * 64 + 32;
        assert!(ids[at] < 2 && (y[at] + 1.1).abs() < 1e-5, "{facets}: {} {}", ids[at], y[at]);
        let text = place.works(&["render", "mirror.toml", "--pixel", "32,34"]);
        let says = [format!("hit: triangle {},", ids[at]), "bounces: 1, ".into(), "layer: 1".into()];
        assert!(says.iter().all(|words| text.contains(words)), "{facets}: {text}");
    }
}

#[test]
fn points_are_projected() {
    let place = Place::new();
    // the eye is at (0, 0.5, 4) and looks at the origin: that is the middle of 64 x 48; then behind it; then the eye
    place.write("p.csv", "x,y,z\n0,0,0\n0,1,8\n0,0.5,4\n");
    let lines =
        |text: &str| -> Vec<serde_json::Value> { text.lines().map(|l| serde_json::from_str(l).unwrap()).collect() };
    let out = lines(&place.works(&["project", "scene.toml", "--points", "p.csv"]));
    assert_eq!(out.len(), 3);
    let image = &out[0]["images"][0];
    assert_eq!(
        (&out[0]["point"], out[0]["images"].as_array().unwrap().len()),
        (&serde_json::json!([0.0, 0.0, 0.0]), 1)
    );
    let near = |key: &str, value: f64| (image[key].as_f64().unwrap() - value).abs() < 1e-9;
    assert!(near("x", 32.0) && near("y", 24.0) && near("a", 0.5) && near("b", 0.5), "{image}");
    assert!(near("t", 16.25_f64.sqrt()) && image["piece"] == 0 && image["layer"] == 0, "{image}");
    assert!(out[0]["degenerate"].is_null() && out[1]["degenerate"].is_null());
    assert_eq!(out[1]["images"], serde_json::json!([]));
    assert_eq!(out[2]["degenerate"], "eye");
    // by either engine the same lines
    let [by_cpu, by_gpu] = ["reference", "compute"]
        .map(|engine| place.works(&["project", "scene.toml", "--points", "p.csv", "--engine", engine]));
    assert!(by_cpu == by_gpu && lines(&by_cpu) == out, "{by_cpu}{by_gpu}");
    // another size, into a file
    let printed = place.works(&["project", "scene.toml", "--points", "p.csv", "--size", "128x96", "-o", "out.jsonl"]);
    assert_eq!(printed, "");
    let out = lines(&std::fs::read_to_string(place.path().join("out.jsonl")).unwrap());
    assert_eq!(out.len(), 3);
    assert!((out[0]["images"][0]["x"].as_f64().unwrap() - 64.0).abs() < 1e-9);
}

#[cfg(target_os = "linux")]
#[test]
fn without_an_adapter_the_cpu_renders() {
    let place = Place::new();
    let run = |args: &[&str]| {
        let mut command = place.command(args);
        let none = command.env("VK_ICD_FILENAMES", "/nonexistent").env("VK_DRIVER_FILES", "/nonexistent");
        let output = none.output().unwrap();
        let text = |bytes| String::from_utf8(bytes).unwrap();
        (output.status.code(), text(output.stdout), text(output.stderr))
    };
    let (code, out, err) = run(&["render", "scene.toml", "-o", "a.png", "--report", "r.json"]);
    assert_eq!((code, err.lines().count()), (Some(0), 1), "{err}");
    assert!(err.contains("no Vulkan adapter found") && out.ends_with("| cpu\n"), "{err}{out}");
    assert_eq!(json_file(&place, "r.json")["engine"], "reference");
    place.write("p.csv", "0,0,0\n");
    let (code, out, err) = run(&["project", "scene.toml", "--points", "p.csv", "--engine", "compute"]);
    assert_eq!((code, out.lines().count(), err.lines().count()), (Some(0), 1, 1), "{err}");
    assert!(err.contains("no Vulkan adapter found") && err.contains("projecting on the CPU"), "{err}");
    let (code, out, err) = run(&["info"]);
    assert!(code == Some(0) && err.is_empty() && out.contains("--engine reference"), "{out}{err}");
    let (code, _, err) = run(&["render", "scene.toml", "-o", "a.png", "--adapter", "llvm"]);
    assert!(code == Some(2) && err.contains("there is: none"), "{err}");
}

#[test]
fn gradients_are_written_as_arrays() {
    let place = Place::new();
    for engine in ["compute", "reference"] {
        let folder = format!("gradients/{engine}");
        place.works(&[
            "render",
            "scene.toml",
            "--size",
            "16x12",
            "--engine",
            engine,
            "--gradients",
            "depth,position,coverage",
            "--gradients-of",
            "vertices,camera.vfov,camera.eye.0",
            "--gradients-to",
            &folder,
        ]);
        let shape = |name: &str| {
            let bytes = std::fs::read(place.path().join(&folder).join(format!("gradient.{name}.npy"))).unwrap();
            String::from_utf8_lossy(&bytes[..128.min(bytes.len())]).into_owned()
        };
        for (name, kind, expected) in [
            ("triangle", "u4", "(12, 16"),
            ("depth.vertices", "f4", "(12, 16, 3, 3"),
            ("depth.camera", "f4", "(12, 16, 2"),
            ("position.vertices", "f4", "(12, 16, 3, 3, 3"),
            ("position.camera", "f4", "(12, 16, 3, 2"),
            ("coverage", "f4", "(12, 16"),
            ("coverage.triangle", "u4", "(12, 16"),
            ("coverage.pixels", "u4", "(12, 16, 2"),
            ("coverage.vertices", "f4", "(12, 16, 3, 3"),
            ("coverage.camera", "f4", "(12, 16, 2"),
        ] {
            let header = shape(name);
            assert!(header.contains(expected) && header.contains(kind), "{name}: {header}");
        }
        let list = json_file(&place, &format!("{folder}/gradient.json"));
        assert_eq!(list["gradients"].as_array().unwrap().len(), 10);
        assert_eq!((&list["camera"][0]["name"], &list["camera"][0]["value"]), (&"camera.vfov".into(), &json("40.0")));
        // directions of a length of about 1, at values whose rounding is 2^-52
        assert!(list["camera"][1]["direction_error"].as_f64().unwrap() < 1e-9, "{list}");
    }
    // again into the same folder
    let again = ["render", "scene.toml", "--gradients", "depth", "--gradients-to", "gradients/compute"];
    place.works(&again);
    // another file of this name stays
    place.write("gradients/compute/gradient.json", "{}");
    place.refuses(&again, 2, "is not a list of gradients");
}

#[test]
fn projectors_are_written_as_control_points() {
    let place = Place::new();
    let scene = "[image]\nwidth = 4\nheight = 2\n[camera]\nkind = \"projector\"\n";
    let plane = |z: i32| format!("{{ kind = \"plane\", origin = [0, 0, {z}], u = [8, 0, 0], v = [0, 4, 0] }}");
    for (m, shape) in [(1, "(2, 4, 2, 3"), (2, "(2, 4, 3, 3"), (3, "(2, 4, 4, 3")] {
        let surfaces: Vec<String> = (0..=m).map(|k| plane(-k * k)).collect();
        place.write("p.toml", format!("{scene}surfaces = [{}]\n", surfaces.join(", ")));
        let printed = place.works(&["camera", "p.toml", "--rays", "r.npy"]);
        assert_eq!(printed.contains(&format!("a curve of degree {m}")), m > 1, "{printed}");
        let bytes = std::fs::read(place.path().join("r.npy")).unwrap();
        assert!(String::from_utf8_lossy(&bytes[..128]).contains(shape));
        let numbers: Vec<f64> = bytes[bytes.len() - 2 * 4 * 3 * 8 * (m as usize + 1)..]
            .chunks(8)
            .map(|b| f64::from_le_bytes(b.try_into().unwrap()))
            .collect();
        let expected = |(i, j): (u32, u32)| {
            (0..=m).flat_map(move |k| [2.0 * i as f64 + 1.0, 2.0 * j as f64 + 1.0, f64::from(-k * k)])
        };
        let pixels = (0..2).flat_map(|j| (0..4).map(move |i| (i, j)));
        assert_eq!(numbers, pixels.flat_map(expected).collect::<Vec<_>>());
    }
    // a chain: three segments of P and D
    place.write("o.toml", "[image]\nwidth = 4\nheight = 2\n[camera]\nkind = \"occlusion\"\n");
    place.works(&["camera", "o.toml", "--rays", "r.npy"]);
    let bytes = std::fs::read(place.path().join("r.npy")).unwrap();
    assert!(String::from_utf8_lossy(&bytes[..128]).contains("(2, 4, 3, 6"));
}

#[test]
fn the_report_says_where_the_light_of_caustics_went() {
    let place = Place::new();
    place.works(&["example", "caustic"]);
    let common = ["render", "caustic.toml", "--size", "64x48", "--set", "caustics.map=[48, 32]", "--report", "r.json"];
    for engine in ["compute", "reference"].into_iter().filter(|e| *e == "reference" || place.has_adapter()) {
        place.works(&[&common[..], &["--engine", engine]].concat());
        let caustics = json_file(&place, "r.json")["caustics"].clone();
        let of = |key: &str| caustics[key].as_f64().unwrap();
        let sum = of("deposited") + of("missed") + of("direct") + of("absorbed");
        assert!((sum - 6.0).abs() < 1e-6 && of("flux") == 6.0 && of("deposited") > 1.0, "{engine}: {caustics}");
        assert!(of("triangles") > of("degenerate") && of("ms") > 0.0, "{engine}: {caustics}");
    }
    if place.has_adapter() {
        place.works(&[&common[..], &["--repeat", "3", "--moving"]].concat());
        assert_eq!(json_file(&place, "r.json")["frame_ms"]["runs"].as_u64(), Some(3));
    }
    place.works(&["example", "pinhole"]);
    place.works(&["render", "pinhole.toml", "--size", "64x48", "--report", "r.json", "--engine", "reference"]);
    assert!(json_file(&place, "r.json").get("caustics").is_none());
}

/// A PLY with colours, through a pinhole: the nearer of two points on one ray is seen, and every output says so.
#[test]
fn points_are_splatted() {
    let place = Place::new();
    let scene = "[image]\nwidth = 8\nheight = 6\n[camera]\nkind = \"pinhole\"\neye = [0, 0, 4]\ntarget = [0, 0, 0]\nvfov = 40\n";
    place.write("own.toml", scene);
    let rows = "0.05 0.05 0 255 0 0\n0.0625 0.0625 -1 0 255 0\n0.8 0.5 0 0 0 255\n";
    let head = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
    let colors = "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n";
    place.write("cloud.ply", format!("{head}{colors}{rows}"));
    place.write("cloud.csv", "0.05,0.05,0\n0.0625,0.0625,-1\n0.8,0.5,0\n");
    let outputs = ["-o", "a.png", "--exr", "a.exr", "--depth", "t.npy", "--index", "k.npy"];
    for engine in ["reference", "compute"] {
        place.works(&[&["splat", "own.toml", "--points", "cloud.ply", "--engine", engine], &outputs[..]].concat());
        let picture = image::open(place.path().join("a.png")).unwrap().to_rgba8();
        let seen: Vec<_> =
            picture.enumerate_pixels().filter(|(_, _, p)| p[3] == 255).map(|(x, y, p)| (x, y, p.0)).collect();
        // a pixel is 8 (tan 20 deg) / 6 = 0.485 wide at z = 0
        assert_eq!(seen, [(5, 1, [0, 0, 255, 255]), (4, 2, [255, 0, 0, 255])], "{engine}");
        let all = frame(&place, "a.exr");
        let t = all.f32(Channel::T).unwrap();
        assert!((t[2 * 8 + 4] - 4.0).abs() < 1e-6 && t.iter().filter(|t| t.is_finite()).count() == 2);
        let index = std::fs::read(place.path().join("k.npy")).unwrap();
        let numbers: Vec<u32> =
            index[index.len() - 4 * 48..].chunks(4).map(|b| u32::from_le_bytes(b.try_into().unwrap())).collect();
        assert_eq!((numbers[2 * 8 + 4], numbers[8 + 5], numbers[0]), (0, 2, u32::MAX), "{engine}");
    }
    place.works(&["splat", "own.toml", "--points", "cloud.csv", "-o", "a.png"]);
    let white = image::open(place.path().join("a.png")).unwrap().to_rgba8();
    assert_eq!(white.get_pixel(4, 2).0, [255; 4]);
}
