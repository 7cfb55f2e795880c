//! What a scene file may say, and what the error says when it says something else.

use glam::DVec3;
use proptest::prelude::*;

use super::*;
use crate::camera::kinds::glc::Glc;
use crate::camera::kinds::pinhole::Pinhole;
use crate::camera::mesh::spec::MeshCameraSpec;
use crate::camera::spec::CameraKind;
use crate::geometry::generate::Builtin;
use crate::geometry::spec::MeshSource;
use crate::image::size::MAX_PIXELS;
use crate::input::parse::Format;

const FULL: &str = r#"
[image]
width = 800
height = 600
background = [0.0, 0.5, 1.0]

[[mesh]]
file = "spot.obj"
translate = [1, 2, 3]
rotate = [0, 90, 0]
scale = 2.0
two_sided = false
color = [1, 0, 0]

[[mesh]]
builtin = "city"
seed = 18446744073709551615
blocks = 8
scale = [1, 2, 3]

[[light]]
direction = [-1, -2, -1]

[camera]
kind = "pinhole"
eye = [0, 1, 5]
target = [0, 0, 0]
vfov = 40
t_range = [-1, inf]

[output]
color = "out.png"
exr = "out.exr"
"#;

/// The scene of this text, as if it were that of the file `path`.
fn read_named(text: &str, format: Format, path: &str, overrides: &[String]) -> Result<SceneFile> {
    read_scene(text, format, &source(Path::new(path), &Loading::default()), overrides, 0.0)
}

fn read(text: &str, overrides: &[&str]) -> Result<SceneFile> {
    let overrides: Vec<String> = overrides.iter().map(|s| s.to_string()).collect();
    read_named(text, Format::Toml, "dir/scene.toml", &overrides)
}

fn error(text: &str, overrides: &[&str]) -> String {
    let error = read(text, overrides).unwrap_err();
    assert_eq!(error.exit_code(), 2);
    let message = error.to_string();
    assert!(!message.contains('\n'), "{message}");
    message
}

/// A scene that is right but for its camera table, whose first line is line 2.
fn camera_error(camera: &str) -> String {
    error(&format!("[camera]\n{camera}"), &[])
}

#[test]
fn reads_every_key() {
    let scene = read(FULL, &[]).unwrap();
    assert_eq!(
        scene.image,
        ImageSpec { width: Some(800), height: Some(600), background: [0.0, 0.5, 1.0], ..ImageSpec::default() }
    );
    let spot = &scene.meshes[0];
    assert_eq!(spot.source, MeshSource::File("dir/spot.obj".into()));
    assert_eq!((spot.translate, spot.rotate), (DVec3::new(1.0, 2.0, 3.0), DVec3::new(0.0, 90.0, 0.0)));
    assert_eq!((spot.scale, spot.two_sided, spot.color), (DVec3::splat(2.0), Some(false), Some([1.0, 0.0, 0.0])));
    let city = &scene.meshes[1];
    let source = Builtin::City { seed: u64::MAX, blocks: Some(8), triangles: 15_000 };
    assert_eq!(city.source, MeshSource::Builtin(source));
    assert_eq!((city.scale, city.two_sided, city.color), (DVec3::new(1.0, 2.0, 3.0), Some(true), None));
    assert_eq!(scene.lights, [Light::distant(DVec3::new(-1.0, -2.0, -1.0))]);
    assert_eq!(scene.camera.t_range, [-1.0, f64::INFINITY]);
    let (eye, target, up) = (DVec3::new(0.0, 1.0, 5.0), DVec3::ZERO, DVec3::Y);
    assert_eq!(scene.camera.kind, CameraKind::new("pinhole", Pinhole { eye, target, up, vfov: 40.0 }));
    assert_eq!(scene.output.color, Some("dir/out.png".into()));
    assert_eq!(scene.output.exr, Some("dir/out.exr".into()));
    assert_eq!(scene.dir, Path::new("dir"));
}

#[test]
fn json_reads_as_toml_does() {
    let toml = "[camera]\nkind='orthographic'\neye=[0,0,1]\ntarget=[0,0,0]\nheight=2\nt_range=[-inf, 3]\n[[mesh]]\nbuiltin='box'";
    let json = r#"{"camera": {"kind": "orthographic", "eye": [0,0,1], "target": [0,0,0], "height": 2,
        "t_range": ["-inf", 3]}, "mesh": [{"builtin": "box"}]}"#;
    let from_json = read_named(json, Format::Json, "dir/scene.json", &[]).unwrap();
    assert_eq!(read(toml, &[]).unwrap(), from_json);
}

#[test]
fn defaults_are_as_documented() {
    let scene =
        read("[camera]\nkind='glc'\nnear=[[0,0,0],[1,0,0],[0,1,0]]\nfar=[[0,0,1],[1,0,1],[0,1,1]]", &[]).unwrap();
    assert_eq!(scene.image, ImageSpec::default());
    assert!(scene.meshes.is_empty() && scene.lights.is_empty());
    assert_eq!(scene.camera.t_range, [0.0, f64::INFINITY]);
    assert_eq!(scene.output, OutputSpec::default());
    let Some(&Glc { near, far }) = scene.camera.kind.recipe() else { panic!("not a glc") };
    assert_eq!((near[1], far[2]), (DVec3::X, DVec3::new(0.0, 1.0, 1.0)));
}

#[test]
fn builtins_have_defaults_and_limits() {
    for (name, expected) in [
        ("teapot", Builtin::Teapot { level: 10 }),
        ("icosphere", Builtin::Icosphere { level: 4 }),
        ("box", Builtin::Box),
        ("cylinder", Builtin::Cylinder { sides: 32 }),
        ("stairs", Builtin::Stairs { steps: 10 }),
        ("cow", Builtin::Cow { level: 2 }),
        ("walker", Builtin::Walker { level: 2 }),
        ("plane", Builtin::Plane { size: 10.0, divisions: 1 }),
        ("city", Builtin::City { seed: 1, blocks: None, triangles: 15_000 }),
        ("terrain", Builtin::Terrain { seed: 1, size: 256 }),
        ("soup", Builtin::Soup { seed: 1, triangles: 10_000 }),
    ] {
        let scene = read(FULL, &[&format!("mesh.1={{builtin='{name}'}}")]).unwrap();
        assert_eq!(scene.meshes[1].source, MeshSource::Builtin(expected));
    }
    for (mesh, expected) in [
        ("{builtin='torus'}", "unknown built-in mesh \"torus\"; nearest known: \"soup\""),
        ("{builtin='box', level=2}", "unknown key \"level\" in mesh.1"),
        ("{builtin='icosphere', level=4294967296}", "mesh.1.level: expected a whole number from 0 to 4294967295"),
        ("{builtin='soup', triangles=-1}", "found the whole number -1"),
        ("{builtin='city', seed=1.5}", "found the number 1.5"),
        ("{builtin='box', file='a.obj'}", "either a file or a builtin"),
        ("{}", "a mesh needs file"),
        ("{fil='a.obj'}", "nearest known key: \"file\""),
        ("{file=''}", "the file name is empty"),
    ] {
        let got = error(FULL, &[&format!("mesh.1={mesh}")]);
        assert!(got.starts_with("dir/scene.toml: --set: ") && got.contains(expected), "{mesh}: {got}");
    }
}

#[test]
fn unknown_keys_name_line_and_nearest() {
    let got = camera_error("kind = 'pinhole'\neye = [0, 0, 1]\ntarget = [0, 0, 0]\nvfv = 40\n");
    assert_eq!(
        got,
        "dir/scene.toml:5: unknown key \"vfv\" in camera; nearest known key: \"vfov\" \
         (known: kind, t_range, eye, target, up, matrix, quaternion, convention, distance, vfov, \
         line_time, line_order, times)"
    );
    let line = camera_error("kind = 'pinhole'\neye = [0, 0, 1]\ntarget = [0, 0, 0]\nvfov = 40\nlinetime = 1e-3\n");
    assert!(
        line.starts_with("dir/scene.toml:6: unknown key \"linetime\" in camera; nearest known key: \"line_time\""),
        "{line}"
    );
    let top = error("[camer]\nkind = 'glc'\n", &[]);
    assert!(top.starts_with("dir/scene.toml:1: unknown key \"camer\" here; nearest known key: \"camera\""), "{top}");
    let second = error(&FULL.replace("seed", "sed"), &[]);
    assert!(second.starts_with("dir/scene.toml:17: unknown key \"sed\" in mesh.1;"), "{second}");
}

#[test]
fn wrong_values_name_line_key_and_what_is_expected() {
    for (from, to, expected) in [
        (
            "width = 800",
            "width = 'wide'",
            "3: image.width: expected a whole number from 1 to 65536, found the text \"wide\"",
        ),
        (
            "width = 800",
            "width = 0",
            "3: image.width: expected a whole number from 1 to 65536, found the whole number 0",
        ),
        ("width = 800", "width = 65537", "3: image.width: expected a whole number from 1 to 65536"),
        (
            "width = 800",
            "width = 800.0",
            "3: image.width: expected a whole number from 1 to 65536, found the number 800",
        ),
        ("width = 800\nheight = 600", "width=65536\nheight=65536", "over the limit of 1073741824 pixels in all"),
        (
            "[0.0, 0.5, 1.0]",
            "[0.0, 0.5, 1.0]\ntone = \"filmic\"",
            "6: image.tone: \"filmic\" is no tone curve; known: \"clip\", \"reinhard\", \"aces\"",
        ),
        ("[0.0, 0.5, 1.0]", "[0.0, 0.5, 1.0]\nexposure = 65", "6: image.exposure: 65 stops; use -64 to 64"),
        ("[0.0, 0.5, 1.0]", "[0.0, 0.5, 1.5]", "5: image.background: colours lie in [0, 1]"),
        ("[0.0, 0.5, 1.0]", "[0.0, nan, 1.0]", "5: image.background.1: expected a finite number, found the number NaN"),
        ("scale = 2.0", "scale = inf", "11: mesh.0.scale: expected a finite number, found the number inf"),
        ("scale = 2.0", "scale = true", "11: mesh.0.scale: expected a finite number, found true"),
        ("scale = 2.0", "scale = 1e999", "mesh.0.scale: expected a finite number"),
        (
            "translate = [1, 2, 3]",
            "translate = [1, 2]",
            "9: mesh.0.translate: expected three numbers, as [x, y, z], found a list of 2",
        ),
        (
            "translate = [1, 2, 3]",
            "translate = [{ frame = 0, value = [1, 2, 3] }, { time = 1, value = [2, 2, 3] }]",
            "9: mesh.0.translate: expected three numbers, as [x, y, z], found a list of 2; each keyframe has the keys frame and value",
        ),
        ("two_sided = false", "two_sided = 0", "12: mesh.0.two_sided: expected true or false"),
        ("direction = [-1, -2, -1]", "direction = [0, 0, 0]", "22: light.0.direction: the direction is zero"),
        ("[[light]]", "[light]", "21: light: expected lights, each a table [[light]], found a table"),
        ("vfov = 40", "", "camera: vfov is missing; add e.g. vfov = 40"),
        ("vfov = 40", "vfov = '40'", "28: camera.vfov: expected a finite number, found the text \"40\""),
        ("[-1, inf]", "[1, 0]", "29: camera.t_range: the first end 1 is above the second 0; swap them"),
        ("[-1, inf]", "[0, nan]", "29: camera.t_range.1: expected a number, inf or -inf, found the number NaN"),
        ("[-1, inf]", "[inf, inf]", "29: camera.t_range: the range holds no finite t"),
        ("\"out.png\"", "3", "32: output.color: expected a text in quotes, found the whole number 3"),
    ] {
        assert!(FULL.contains(from), "{from}");
        let got = error(&FULL.replacen(from, to, 1), &[]);
        assert!(got.starts_with("dir/scene.toml:") && got.contains(expected), "{to}: {got}");
    }
}

#[test]
fn camera_kinds_say_what_is_known() {
    assert!(camera_error("kind = 'pinhol'").starts_with(
        "dir/scene.toml:2: camera.kind: unknown camera kind \"pinhol\"; nearest known: \"pinhole\" (known: pinhole, "
    ));
    assert!(camera_error("vfov = 40").contains("kind is missing"));
    assert!(error("", &[]).contains("there is no camera"));
}

#[test]
fn overrides_win_and_errors_say_set() {
    let scene = read(FULL, &["camera.vfov=50", "mesh.0.scale=3", "image.width=64", "output.color=a.png"]).unwrap();
    assert_eq!(scene.camera.kind.recipe::<Pinhole>().unwrap().vfov, 50.0);
    assert_eq!(scene.meshes[0].scale, DVec3::splat(3.0));
    assert_eq!(scene.image.width, Some(64));
    assert_eq!(scene.output.color, Some("dir/a.png".into()));
    let got = error(FULL, &["camera.vfof=50"]);
    assert!(
        got.starts_with("dir/scene.toml: --set: unknown key \"vfof\" in camera; nearest known key: \"vfov\""),
        "{got}"
    );
}

const PIECES: &str = r#"{"vertices": [
    {"image": [0, 0], "near": [0, 0, 0], "far": [0, 0, -1]},
    {"image": [1, 0], "near": [1, 0, 0], "far": [2, 0, -1], "w": 2},
    {"image": [0, 1], "near": [0, 1, 0], "far": [0, 2, -1]}],
  "triangles": [[0, 1, 2]]}"#;

/// Loads a scene whose mesh camera's file holds `pieces`.
fn load_pieces(pieces: &str) -> Result<SceneFile> {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("pieces.json"), pieces).unwrap();
    let path = dir.path().join("scene.toml");
    std::fs::write(&path, "[camera]\nkind = 'mesh'\nfile = 'pieces.json'\n").unwrap();
    load(&path, &["camera.normalize=true".into()], 0.0, &Loading::default())
}

#[test]
fn mesh_camera_reads_alike_inline_and_from_a_file() {
    let Some(from_file) = load_pieces(PIECES).unwrap().camera.kind.recipe::<MeshCameraSpec>().cloned() else {
        panic!("not a mesh")
    };
    assert_eq!((from_file.vertices[1].w, from_file.vertices[2].w), (2.0, 1.0));
    assert_eq!((from_file.triangles[0], from_file.normalize), ([0, 1, 2], true));
    let inline = format!(r#"{{"camera": {{"kind": "mesh", "normalize": true, {}}}"#, &PIECES[1..]);
    let scene = read_named(&inline, Format::Json, "scene.json", &[]).unwrap();
    assert_eq!(scene.camera.kind, CameraKind::new("mesh", from_file));
}

#[test]
fn mesh_camera_errors_name_the_piece() {
    for (from, to, expected) in [
        ("[[0, 1, 2]]", "[[0, 1, 2], [0, 1, 3]]", "triangles.1: vertex 3 does not exist; there are 3, counted from 0"),
        ("\"w\": 2", "\"w\": 0", "vertices.1: w is 0; a weight must be finite and above 0"),
        ("\"w\": 2", "\"v\": 2", "pieces.json:3: not valid here: unknown field `v`"),
        ("\"near\": [1, 0, 0]", "\"near\": [1, 1e999, 0]", "pieces.json:3: not valid here: number out of range"),
        ("\"near\": [1, 0, 0], ", "", "missing field `near`"),
        ("[[0, 1, 2]]", "[[0, 1, -2]]", "pieces.json:5: "),
        ("[[0, 1, 2]]", "[[0, 1]]", "pieces.json:5: "),
    ] {
        let got = load_pieces(&PIECES.replacen(from, to, 1)).unwrap_err();
        assert!(got.exit_code() == 2 && got.to_string().contains(expected), "{to}: {got}");
    }
    assert!(camera_error("kind='mesh'").contains("needs vertices and triangles, or file"));
    assert!(camera_error("kind='mesh'\nfile='no.json'").contains("camera.file: dir/no.json cannot be read"));
    assert!(camera_error("kind='mesh'\nvertices=[]\ntriangles=[]\nfile='a'").contains("either a file or vertices"));
    assert!(camera_error("kind='mesh'\nvertices=[]\ntriangles=[[0,1,4294967296]]").contains("triangles.0.2: expected"));
}

#[test]
fn files_that_cannot_be_read_say_so() {
    let dir = tempfile::tempdir().unwrap();
    let fails = |name: &str, bytes: Option<&[u8]>| {
        let path = dir.path().join(name);
        if let Some(bytes) = bytes {
            std::fs::write(&path, bytes).unwrap();
        }
        load(&path, &[], 0.0, &Loading::default()).unwrap_err().to_string()
    };
    assert!(fails("none.toml", None).contains("none.toml: cannot be read: "));
    assert!(fails("spot.obj", Some(b"v 0 0 0")).contains("a scene is a .toml or .json file"));
    assert!(fails("bad.toml", Some(b"a = 1\nb = '\xff'")).contains("line 2 is not UTF-8"));
    assert!(load(dir.path(), &[], 0.0, &Loading::default()).is_err());
}

#[test]
fn sizes_are_checked_for_the_command_line_too() {
    assert!(check_size(1, 1).is_ok() && check_size(MAX_SIDE, MAX_PIXELS / MAX_SIDE).is_ok());
    assert!(check_size(0, 5).is_err() && check_size(5, MAX_SIDE + 1).is_err());
    assert!(check_size(MAX_SIDE, MAX_PIXELS / MAX_SIDE + 1).is_err());
    assert!(check_size(u64::MAX, u64::MAX).is_err());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn random_text_never_panics(text in any::<String>(), set in any::<String>()) {
        for format in [Format::Toml, Format::Json] {
            let _ = read_named(&text, format, "s", &[]);
        }
        if let Err(e) = read(FULL, &[&set]) {
            prop_assert!(!e.to_string().contains('\n'), "{}", e);
        }
    }

    #[test]
    fn mutated_scenes_never_panic(at in 0..FULL.len(), cut in 0..12usize, put in "[-0-9a-z\\[\\]{}=\"'.,_ \n\u{e9}]{0,6}") {
        let mut text = FULL.to_string();
        text.replace_range(at..(at + cut).min(FULL.len()), &put);
        if let Err(e) = read(&text, &[]) {
            prop_assert!(e.to_string().starts_with("dir/scene.toml:") && !e.to_string().contains('\n'), "{}", e);
        }
        let mut json = PIECES.to_string();
        json.replace_range((at % PIECES.len())..(at % PIECES.len() + cut).min(PIECES.len()), &put);
        let inline = format!(r#"{{"camera": {{"kind": "mesh", {}}}"#, json.get(1..).unwrap_or(""));
        if let Err(e) = read_named(&inline, Format::Json, "s.json", &[]) {
            prop_assert!(e.to_string().starts_with("s.json:") && !e.to_string().contains('\n'), "{}", e);
        }
    }
}
