//! Scenes for the user's own model: a commented template for each task, its places and lengths filled in from the model's bounds.

use crate::arrays::MapEach;
use crate::geometry::mesh::joined;
use crate::input::{Error, Loading, Result};
use crate::scene::{Scene, file};
use glam::{DMat3, DVec3};
use std::path::Path;

/// What somebody may want of a model.
pub struct Task {
    pub name: &'static str,
    /// What comes out, in a line.
    pub shows: &'static str,
    /// The scene, with `<<...>>` where something is filled in: see [`Model::filled`].
    template: &'static str,
}

/// The task `$name`, its template beside this file.
macro_rules! task {
    ($name:literal, $shows:literal) => {
        Task { name: $name, shows: $shows, template: include_str!(concat!("new/", $name, ".toml")) }
    };
}

#[rustfmt::skip] // a table
pub const TASKS: [Task; 15] = [
    task!("ground-truth", "an ordinary camera, with depth, ids and normals"),
    task!("fisheye", "a fisheye lens of 200 degrees"),
    task!("lidar", "a spinning scanner: its range image and its points"),
    task!("rolling-shutter", "the model moves while rows are read one after another"),
    task!("line-scan", "the model passes a line camera"),
    task!("push-broom", "a strip from above, as by an aircraft or a satellite"),
    task!("dome", "a circle of 180 degrees for a planetarium dome"),
    task!("cylinder-wall", "a curved screen around the viewer"),
    task!("stereo", "an omni-directional stereo pair for a headset"),
    task!("light-field", "a light-field display with 8 x 8 views"),
    task!("mirror", "the model and a mirror ball beside it"),
    task!("unroll", "the model from all around in one picture"),
    task!("cross-slit", "two slits instead of an eye"),
    task!("several-views", "front, side and top in one picture"),
    task!("bent", "left, front and right at once, along curved rays"),
];

/// Which of the model's axes points up.
#[derive(Debug, Clone, Copy, clap::ValueEnum)]
pub enum Up {
    Y,
    Z,
}

impl Up {
    /// What a scene says of it.
    fn told(self) -> &'static str {
        match self {
            Up::Y => "                # if its z axis points up: anamorph new --up z",
            Up::Z => "                # its z axis points up",
        }
    }

    /// Right, up and towards the viewer, as columns.
    fn axes(self) -> DMat3 {
        match self {
            Up::Y => DMat3::IDENTITY,
            Up::Z => DMat3::from_cols(DVec3::X, DVec3::Z, DVec3::NEG_Y),
        }
    }
}

/// A model, and where it is.
#[derive(Debug)]
pub struct Model {
    /// Its table of the scene file.
    table: String,
    /// As comments call it.
    name: String,
    centre: DVec3,
    /// Of the ball around its bounds, above 0.
    radius: f64,
    up: Up,
}

impl Model {
    /// The model in a file: triangles, or points as small spheres. The scene will name it `file`; `path` is where it is read from.
    ///
    /// # Errors
    /// [`Error::Input`] where it cannot be read or holds nothing.
    pub fn read(path: &Path, file: &str, up: Up) -> Result<Model> {
        let quoted = |path: &str| toml::Value::String(path.to_owned()).to_string();
        let (read_from, shown) = (quoted(&path.to_string_lossy()), quoted(file));
        let name = Path::new(file).file_name().map_or(file.into(), |n| n.to_string_lossy()).into_owned();
        let (table, (centre, radius)) = match of_table(&format!("[[mesh]]\nfile = {read_from}\n")) {
            Ok(scene) => {
                let bounds = scene.mesh.drawn_bounds();
                (format!("[[mesh]]\nfile = {shown}{}", up.told()), ball(bounds).ok_or_else(|| nothing(path))?)
            }
            Err(of_mesh) => {
                // a file of points is no mesh; anything else is told as a mesh
                let scene = of_table(&format!("[[spheres]]\nfile = {read_from}\nradius = 1\n")).map_err(|_| of_mesh)?;
                // the radius is not known yet: around their centres
                let centres = scene.mesh.positions.iter().map(|p| (*p, *p));
                let (centre, radius) = ball(centres.reduce(joined)).ok_or_else(|| nothing(path))?;
                let points = scene.mesh.round_counts()[0].max(1) as f64;
                // neighbours on a surface of the ball's size are about this far apart
                let apart = 2.0 * radius / points.sqrt();
                let apart = rounded(apart, apart);
                (
                    format!(
                        "[[spheres]]                     # points, as small spheres\nfile = {shown}\nradius = {apart}"
                    ),
                    (centre, radius),
                )
            }
        };
        Ok(Model { table, name, centre, radius, up })
    }

    /// The teapot, for who has no model at hand.
    ///
    /// # Errors
    /// None that is expected: it is built in.
    pub fn teapot() -> Result<Model> {
        let table =
            "[[mesh]]\nbuiltin = \"teapot\"              # or file = \"model.obj\": .ply, .stl, .gltf, .glb, too";
        let scene = of_table(&format!("{table}\n"))?;
        let (centre, radius) = ball(scene.bounds()).ok_or_else(|| Error::work("no teapot"))?;
        Ok(Model { table: table.into(), name: "The teapot".into(), centre, radius, up: Up::Y })
    }

    /// The scene file of a task, to be written as `scene`.
    ///
    /// # Errors
    /// None that is expected: the templates are built in.
    pub fn scene(&self, task: &Task, scene: &str) -> Result<String> {
        let mut text = String::new();
        let mut rest = task.template;
        while let Some((before, after)) = rest.split_once("<<") {
            let (asked, after) = after.split_once(">>").ok_or_else(|| Error::work("a template without >>"))?;
            text += before;
            text +=
                &self.filled(asked, task, scene).ok_or_else(|| Error::work(format!("a template with {asked:?}")))?;
            rest = after;
        }
        Ok(text + rest)
    }

    /// What stands for `<<asked>>`. In `point`, `offset`, `direction` and `length` numbers are to the right, up and towards the
    /// viewer, in radii of the model; points are from its centre.
    fn filled(&self, asked: &str, task: &Task, scene: &str) -> Option<String> {
        let mut words = asked.split(' ');
        let what = words.next()?;
        let numbers: Vec<f64> = words.map(|word| word.parse().ok()).collect::<Option<_>>()?;
        let vector = || <[f64; 3]>::try_from(&numbers[..]).ok().map(|v| self.up.axes() * DVec3::from_array(v));
        let written =
            |v: DVec3, size: f64| format!("[{}]", v.to_array().map_each(|x| rounded(x, size).to_string()).join(", "));
        Some(match what {
            "mesh" => self.table.clone(),
            "model" => self.name.clone(),
            "name" => task.name.to_owned(),
            "scene" => scene.to_owned(),
            "up" => written(self.up.axes().y_axis, 1.0),
            "point" => written(self.centre + self.radius * vector()?, self.radius),
            "offset" => written(self.radius * vector()?, self.radius),
            "direction" => written(vector()?, 1.0),
            "length" => {
                let length = self.radius * *numbers.first()?;
                rounded(length, length).to_string()
            }
            _ => return None,
        })
    }
}

/// All tasks, a line each.
pub fn list() -> String {
    TASKS.iter().map(|task| format!("{:<18}{}\n", task.name, task.shows)).collect()
}

/// The scene of one table.
fn of_table(table: &str) -> Result<Scene> {
    let camera = "[camera]\nkind = \"pinhole\"\neye = [0, 0, 1]\ntarget = [0, 0, 0]\nvfov = 40\n";
    let loading = Loading::default();
    let file = file::of_text(&format!("{table}{camera}"), Path::new("new.toml"), 0.0, &loading)?;
    Scene::from_file(file, &loading)
}

/// Middle and radius of the ball around bounds.
fn ball(bounds: Option<(DVec3, DVec3)>) -> Option<(DVec3, f64)> {
    let (low, high) = bounds?;
    let radius = (high - low).length() / 2.0;
    // halved first, as the sum may overflow; a single point has some size too
    (radius.is_finite()).then(|| (low / 2.0 + high / 2.0, if radius > 0.0 { radius } else { 1.0 }))
}

fn nothing(path: &Path) -> Error {
    Error::input(format!("{}: nothing in it to look at", path.display()))
}

/// To four digits of `size`; never -0.
fn rounded(x: f64, size: f64) -> f64 {
    let decimals = (3 - size.abs().log10().floor() as i32).clamp(0, 17) as usize;
    format!("{x:.decimals$}").parse().unwrap_or(x) + 0.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::frame::Channel;
    use crate::reference::image::image;

    /// A cube of 2 around (10, 20, 30), some of its corners as a PLY of points, too.
    fn model(up: Up) -> Model {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("cube.obj");
        let corners = (0..8).map(|k| [9 + (k & 1) * 2, 19 + (k >> 1 & 1) * 2, 29 + (k >> 2) * 2]);
        let mut text: String = corners.map(|[x, y, z]| format!("v {x} {y} {z}\n")).collect();
        text += "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
        std::fs::write(&path, text).unwrap();
        Model::read(&path, "models/cube.obj", up).unwrap()
    }

    #[test]
    fn places_are_those_of_the_bounds_whichever_axis_is_up() {
        let radius = 3.0f64.sqrt();
        for (up, point, name) in
            [(Up::Y, [10.0, 20.0 + radius, 30.0], "[0, 1, 0]"), (Up::Z, [10.0, 20.0, 30.0 + radius], "[0, 0, 1]")]
        {
            let model = model(up);
            let filled = |asked: &str| model.filled(asked, &TASKS[0], "s.toml").unwrap();
            let at: Vec<f64> = serde_json::from_str(&filled("point 0 1 0")).unwrap();
            // four digits of a radius of 1.7
            assert!(at.iter().zip(point).all(|(a, b)| (a - b).abs() <= 5e-4), "{at:?}");
            assert_eq!(filled("up"), name);
            assert!(filled("mesh").contains("file = \"models/cube.obj\""));
            assert_eq!((filled("length 1").as_str(), filled("name").as_str()), ("1.732", "ground-truth"));
            assert!(model.filled("nonsense", &TASKS[0], "s.toml").is_none());
        }
    }

    /// Points have no size of their own: those of a small thing are small.
    #[test]
    fn points_are_spheres_about_as_large_as_they_lie_apart() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("points.ply");
        let side = 20;
        let places = (0..side * side).map(|k| [0.001 * f64::from(k % side), 0.001 * f64::from(k / side)]);
        let lines: String = places.map(|[x, y]| format!("{x} {y} 5\n")).collect();
        let properties = "property double x\nproperty double y\nproperty double z\n";
        let header = format!("ply\nformat ascii 1.0\nelement vertex {}\n{properties}end_header\n", side * side);
        std::fs::write(&path, header + &lines).unwrap();
        let model = Model::read(&path, "points.ply", Up::Y).unwrap();
        assert!((model.radius - 0.0134).abs() < 1e-4 && (model.centre.z - 5.0).abs() < 1e-12, "{model:?}");
        let radius: f64 = model.table.rsplit("radius = ").next().unwrap().parse().unwrap();
        assert!((0.0005..0.002).contains(&radius), "{radius}");
    }

    #[test]
    fn every_task_makes_a_scene_that_shows_the_model() {
        for (task, up) in TASKS.iter().flat_map(|t| [(t, Up::Y), (t, Up::Z)]) {
            let mut model = model(up);
            // the scene is read without the file
            model.table =
                "[[mesh]]\nbuiltin = \"box\"\nscale = 2\nplaces = [[[1, 0, 0, 10], [0, 1, 0, 20], [0, 0, 1, 30]]]"
                    .into();
            let text = model.scene(task, "cube.toml").unwrap();
            assert!(text.starts_with("# ") && text.contains("cube.obj") && !text.contains("<<"), "{text}");
            let overrides: &[String] =
                if task.name == "lidar" { &["camera.columns=90".into()] } else { &SMALL.map(String::from) };
            let dir = tempfile::tempdir().unwrap();
            let path = dir.path().join("cube.toml");
            std::fs::write(&path, text).unwrap();
            // what moves is in the middle then
            let scene = Scene::load(&path, overrides, 0.45, &Loading::default()).unwrap();
            let camera = scene.camera().unwrap();
            let frame = image(&scene, &camera, &[Channel::A]);
            let alpha = frame.f32(Channel::A).unwrap();
            let shown = alpha.iter().filter(|&&a| a > 0.0).count() as f64 / alpha.len() as f64;
            // enough of the picture to see what it is
            assert!(shown >= 0.05, "{}: {shown}", task.name);
        }
    }

    const SMALL: [&str; 2] = ["image.width=64", "image.height=48"];
}
