//! A page for each kind of camera: what it is, a picture of one scene through it, its rays, its keys. `make camera-pages` writes them to docs/cameras.
//! FOLDER is the first argument; after it may come the kinds whose pages are made anew, where the others are there already.

#[path = "agreement/views.rs"]
mod views;

use anamorph::camera_kinds;
use anamorph::internals::image::write_text;
use anamorph::internals::input::{Error, Result};
use anamorph::internals::tools::cli;
use anamorph::internals::tools::example::EXAMPLES;
use image::codecs::jpeg::JpegEncoder;
use image::imageops::FilterType;
use std::fmt::Write;
use std::fs::File;
use std::io::BufWriter;
use std::path::Path;
use toml::{Table, Value};
use views::{View, views, write_camera_files};

/// Pixels across a picture of a page.
const WIDTH: u32 = 480;
/// Of JPEG, percent.
const QUALITY: u8 = 82;

/// In the ball of radius 1 about the origin, at which all cameras look.
const STILL_LIFE: &str = r#"
[[mesh]]
builtin = "plane"
size = 1.35
translate = [0, -0.35, 0]
pattern = { kind = "checker", size = 0.135, light = [0.8, 0.78, 0.72], dark = [0.25, 0.3, 0.36] }

[[mesh]]
builtin = "teapot"
scale = 0.2
translate = [-0.05, -0.35, 0]
color = [0.75, 0.42, 0.18]

[[mesh]]
builtin = "icosphere"
scale = 0.15
smooth = true
translate = [0.42, -0.2, 0.32]
color = [0.65, 0.1, 0.08]

[[mesh]]
builtin = "box"
scale = 0.22
rotate = [0, 30, 0]
translate = [-0.45, -0.24, 0.3]
color = [0.2, 0.42, 0.25]

[[mesh]]
builtin = "cylinder"
scale = [0.14, 0.75, 0.14]
smooth = true
translate = [0.4, 0.02, -0.42]
color = [0.2, 0.35, 0.6]

[[mesh]]
builtin = "cylinder"
scale = [0.14, 0.75, 0.14]
smooth = true
translate = [-0.4, 0.02, -0.42]
color = [0.8, 0.78, 0.7]

[[light]]
direction = [-1, -2, -1.2]
color = [0.9, 0.9, 0.9]
shadows = true

[ambient_occlusion]
rays = 16
distance = 0.4
"#;

/// Captions of pictures that are no plain view of the scene.
const CAPTIONS: [(&str, &str); 6] = [
    (
        "surround",
        "Each half of a square is the triangle of one of 320 cameras, which look inwards from a ball. Neighbours on the ball need not be neighbours here, \
         and the last row is not full. A mesh listed row by row stays connected, as in `anamorph example surround`",
    ),
    ("hinge", "Right of the middle the second camera sees the scene, turned by 25 degrees about the column there"),
    (
        "mcop",
        "Columns on the left are seen from the start of the path, those on the right from its end: the table's front edge bends as the eye rises and sinks",
    ),
    (
        "display",
        "A pinhole's picture, bent as on the flat triangles of the screen: the table's edges break where two of them meet",
    ),
    (
        "lightfield",
        "The middle of the picture, pixel by pixel: each block of 5 x 4 pixels is one lenslet, which sees the scene from 20 directions",
    ),
    ("ods", "Above all around for the left eye, below for the right eye"),
];

fn main() -> Result<()> {
    let folder = std::env::args_os().nth(1).ok_or_else(|| Error::input("use: camera_pages FOLDER [KIND...]"))?;
    let folder = Path::new(&folder);
    std::fs::create_dir_all(folder).map_err(|e| broken(folder, e))?;
    let scenes = tempfile::tempdir().map_err(|e| Error::work(format!("no temporary folder: {e}")))?;
    write_camera_files(scenes.path())?;
    let views = views()?;
    let mut index = String::from(
        "# All cameras\n\nOne scene through each kind: a teapot on a checkered table, a ball, a box and two columns. [Cameras and their \
         keys](../reference/cameras.md) compares the kinds.\n\n| | | |\n|---|---|---|\n",
    );
    let kinds: Vec<(&str, String)> = camera_kinds().collect();
    let asked: Vec<String> = std::env::args().skip(2).collect();
    for (name, help) in kinds.iter().filter(|kind| asked.is_empty() || asked.iter().any(|a| a == kind.0)) {
        // the plain one, where a kind has several
        let plain = name.replace('_', "-");
        let of_kind = |v: &&View| v.kind() == *name;
        let view = views.iter().filter(of_kind).find(|v| v.name == plain).or(views.iter().find(of_kind));
        let view = view.ok_or_else(|| Error::work(format!("no camera of kind {name}")))?;
        let has_diagram = picture(scenes.path(), view, folder, name)?;
        write_text(&folder.join(format!("{name}.md")), &page(name, help, view, has_diagram)?)?;
        println!("{name}");
    }
    for row in kinds.chunks(3) {
        let cell = |(name, help): &(&str, String)| {
            format!(" [![{name}: {}]({name}.jpg)]({name}.md)<br>[`{name}`]({name}.md) |", title(help))
        };
        // writing to a string does not fail
        let _ = writeln!(index, "|{}", row.iter().map(cell).collect::<String>());
    }
    write_text(&folder.join("README.md"), &index)
}

/// Renders the scene through the camera, and draws its rays where that can be done; whether it was.
fn picture(scenes: &Path, view: &View, folder: &Path, name: &str) -> Result<bool> {
    // each eye is twice as wide as high
    let [width, height] = if name == "ods" { [view.size[0]; 2] } else { view.size };
    let scene = scenes.join(format!("{name}.toml"));
    let image = format!("[image]\nwidth = {width}\nheight = {height}\nbackground = [0.55, 0.68, 0.82]\n");
    write_text(&scene, &format!("{image}{STILL_LIFE}\n{}", view.text()?))?;
    let large = scenes.join("picture.png");
    let svg = folder.join(format!("{name}.svg"));
    let argument = |path: &Path| path.as_os_str().to_owned();
    let render = vec![
        "anamorph".into(),
        "render".into(),
        argument(&scene),
        "--samples".into(),
        "4".into(),
        "-o".into(),
        argument(&large),
    ];
    if cli::main(render) != 0 {
        return Err(Error::work(format!("no picture of {name}")));
    }
    // there is none of mirrors, lenses, composites and lists of rays
    let diagram = vec!["anamorph".into(), "camera".into(), argument(&scene), "--diagram".into(), argument(&svg)];
    let has_diagram = cli::main(diagram) == 0;
    let picture = image::open(&large).map_err(|e| broken(&large, e))?.into_rgb8();
    let rows = (WIDTH * picture.height()).div_ceil(picture.width());
    let small = if name == "lightfield" {
        // smaller, it would mix the views
        let [left, top] = [picture.width() - WIDTH, picture.height() - rows].map(|beside| beside / 2);
        image::imageops::crop_imm(&picture, left, top, WIDTH, rows).to_image()
    } else {
        image::imageops::resize(&picture, WIDTH, rows, FilterType::Triangle)
    };
    let path = folder.join(format!("{name}.jpg"));
    let file = File::create(&path).map_err(|e| broken(&path, e))?;
    JpegEncoder::new_with_quality(BufWriter::new(file), QUALITY).encode_image(&small).map_err(|e| broken(&path, e))?;
    Ok(has_diagram)
}

impl View {
    fn kind(&self) -> &str {
        self.camera.get("kind").and_then(Value::as_str).unwrap_or_default()
    }

    /// Its [camera] table.
    fn text(&self) -> Result<String> {
        let scene = Table::from_iter([("camera".to_owned(), Value::from(self.camera.clone()))]);
        toml::to_string(&scene).map_err(|e| Error::work(format!("{}: {e}", self.name)))
    }
}

/// The line after the kind's name.
fn title(help: &str) -> &str {
    help.lines().next().and_then(|line| line.split_once(": ")).map_or("", |(_, title)| title)
}

fn page(name: &str, help: &str, view: &View, has_diagram: bool) -> Result<String> {
    let diagram = if has_diagram { format!("![Its pieces and rays]({name}.svg)\n\n") } else { String::new() };
    let used: Vec<String> = EXAMPLES
        .iter()
        .filter(|e| e.scene.contains(&format!("kind = \"{name}\"")))
        .map(|e| format!("`{}`", e.name))
        .collect();
    let examples = if used.is_empty() {
        String::new()
    } else {
        format!("Examples (`anamorph example NAME`): {}.\n\n", used.join(", "))
    };
    let own = CAPTIONS.iter().find(|caption| caption.0 == name);
    let caption = own.map_or(String::new(), |(_, text)| format!("{text}.\n\n"));
    Ok(format!(
        "# {name}\n\n{}.\n\n![A teapot, a ball, a box and two columns through it]({name}.jpg)\n\n{caption}{diagram}\
         The camera of this picture (its scene: `lab/examples/camera_pages.rs`; its files: `lab/examples/agreement`):\n\n<!-- not run: it may name files of its own -->\n```toml\n{}```\n\n{examples}\
         ## Keys and formula\n\nAs `anamorph camera --help {name}` prints them. [To the last bit](../reference/definitions.md#{name}).\n\n\
         ```text\n{}\n```\n",
        capital(title(help)),
        view.text()?,
        help.trim_end(),
    ))
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}

fn broken(path: &Path, e: impl std::fmt::Display) -> Error {
    Error::work(format!("{}: {e}", path.display()))
}
