//! Ready scenes on built-in geometry: the one of `make demo`, one for each simple kind of camera, and those of the gallery: one for each
//! figure of the papers that shows a rendering, and some of what no paper has.

mod make;
mod takes;

use crate::image::{put_npy, write_lines};
use crate::input::Result;
use std::path::{Path, PathBuf};

/// A scene, and the files that its camera reads.
pub struct Example {
    pub name: &'static str,
    /// What it shows, in a line.
    pub shows: &'static str,
    /// The figure that it is after, if any.
    pub figure: Option<&'static str>,
    /// The scene file, commented.
    pub scene: &'static str,
    /// Makes the camera's own files: name and content.
    files: fn() -> Vec<NamedFile>,
}

/// A file's name and content.
type NamedFile = (&'static str, Vec<u8>);

/// The content of a .npy of f64, which fill the shape.
fn npy(shape: [u64; 3], numbers: &[f64]) -> Vec<u8> {
    let mut bytes = Vec::new();
    // writing to a vector does not fail
    let _ = put_npy(&mut bytes, &shape, numbers);
    bytes
}

impl Example {
    pub fn scene_name(&self) -> String {
        format!("{}.toml", self.name)
    }

    /// Every file's name and content, the scene last: once it is there, all is.
    pub fn parts(&self) -> Vec<(String, Vec<u8>)> {
        let own = (self.files)().into_iter().map(|(name, content)| (name.to_owned(), content));
        own.chain([(self.scene_name(), self.scene.into())]).collect()
    }

    /// Writes every file into the folder, which is there; returns the scene's path.
    ///
    /// # Errors
    /// [`crate::input::Error::Work`] if one cannot be written.
    pub fn write(&self, folder: &Path) -> Result<PathBuf> {
        for (name, content) in self.parts() {
            write_lines(&folder.join(name), |out| out.write_all(&content))?;
        }
        Ok(folder.join(self.scene_name()))
    }
}

/// The example `$name`, its scene beside this file.
macro_rules! example {
    ($name:literal, $figure:expr, $shows:literal, $files:expr) => {
        Example {
            name: $name,
            shows: $shows,
            figure: $figure,
            scene: include_str!(concat!("example/", $name, ".toml")),
            files: $files,
        }
    };
    ($name:literal, $figure:expr, $shows:literal) => {
        example!($name, $figure, $shows, Vec::new)
    };
}

/// All examples: the demo, the simplest cameras first, then the gallery.
#[rustfmt::skip] // a table
pub const EXAMPLES: [Example; 58] = [
    example!("demo", None, "a city in reverse perspective: a cross-slit camera with one slit behind it"),
    example!("pinhole", None, "the teapot through an ordinary camera"),
    example!("orthographic", None, "a city through parallel rays"),
    example!("pushbroom", None, "a city from a moving line camera (a GLC)"),
    example!("cross-slit", None, "a city through two slits (a GLC)"),
    example!("pencil", None, "a sheared city: a line of eyes, one for each row (a GLC)"),
    example!("bilinear", None, "a twisted city: no two rays meet (a GLC)"),
    example!("mesh", None, "a lens over a city: 450 pieces in a file of their own", make::lens),
    example!("panorama", None, "the teapot unrolled by 270 degrees: a mesh camera around it", make::ring),
    example!("fisheye", None, "a city from a crossing, straight up: a ray map in two files", make::fisheye),
    example!("magnifier", None, "a cow through a magnifying glass: a lens of two faces and a rim"),
    example!("still-life", None, "stone, wood, metal and shadows through two slits"),
    example!("pen-and-ink", None, "a city all around, drawn with a pen"),
    example!("wireframe", None, "the same as a wireframe that grows thinner with depth"),
    example!("rolling-shutter", None, "propellers and a bus, read row by row while they move"),
    example!("video-on-city", None, "a street corner of boxes that wears the pictures of three cameras", takes::takes),
    example!("helix", None, "a double helix of 630 exact spheres from all around", make::helix),
    example!("smoke", None, "smoke along rays that bend: a volume in a file of its own", make::plume),
    example!("hidden-mirror", None, "a mirror ball behind a pillar, seen along rays that bend around it"),
    example!("composite", None, "a street, a fisheye and a map of a city in one picture: three cameras"),
    example!("table", None, "a table from above, and each thing on it from its own best side: five cameras"),
    example!("city-cross-slit", Some("Yu 1"), "a city of 15,000 triangles through two slits"),
    example!("primitives", Some("Yu 5"), "a ball, a cylinder and a box through two slits"),
    example!("cow-panorama", Some("Yu 6"), "a cow from all around"),
    example!("teapot-panorama", Some("Yu 7"), "a teapot from 270 degrees around"),
    example!("teapot-above", Some("Yu 7"), "the same teapot from above, and from all around at once"),
    example!("mirror-ball", Some("Yu 8"), "a mirror ball of 960 facets, one GLC each"),
    example!("hinge", Some("Yu 9"), "faux animation: a cow turns its head by a second camera"),
    example!("car", Some("Brosz 1"), "a car seen nearly all round, along curved rays", || vec![
        ("car.obj", include_str!("example/car.obj").into()),
        ("car.mtl", include_str!("example/car.mtl").into()),
    ]),
    example!("three-projections", Some("Brosz 4"), "perspective, parallel and inverse perspective, side by side"),
    example!("columns", Some("Brosz 5"), "irregular perspective: columns that keep their shape"),
    example!("cylinders", Some("Brosz 6"), "a cylindrical panorama between nested cylinders"),
    example!("angular-fisheye", Some("Brosz 8"), "a city from above between two hemispheres"),
    example!("lens", Some("Brosz 8"), "the same re-parametrised, as through a lens"),
    example!("twist", Some("Brosz 7"), "a colonnade twisted along straight rays"),
    example!("twist-curved", Some("Brosz 7"), "the same twist along curved rays"),
    example!("curved", Some("Brosz 9"), "streets that converge along curves"),
    example!("occlusion", Some("Brosz 10"), "an occlusion camera: what a ball hides shows around it"),
    example!("street", Some("Brosz 11"), "the edge of a city, with perspective views down two streets"),
    example!("ortho-to-perspective", Some("Brosz 12"), "a city, parallel in front and in perspective behind"),
    example!("stairs", Some("Brosz 13"), "a house of stairs: floor and ceiling in one picture"),
    example!("terrain-top-down", Some("Popescu 1"), "a terrain, two regions seen from viewpoints of their own"),
    example!("terrain-bottom-up", Some("Popescu 2"), "two views of a terrain in one continuous picture"),
    example!("tracked", Some("Popescu 3, 10"), "two balls in a city, tracked through what hides them"),
    example!("tree", Some("Popescu 4, 7"), "the whole tree of cameras of two views, joined by curves"),
    example!("morph", Some("Popescu 6"), "a camera of two regions half-way to its plain view"),
    example!("opposite", Some("Popescu 9"), "two opposite views of a street, continuous"),
    example!("graph-camera", Some("Popescu 9"), "the same two views by a graph camera, with its breaks"),
    example!("aeroplane", Some("Popescu 11"), "an aeroplane across a joint of segments, smooth", || vec![
        ("aeroplane.obj", include_str!("example/aeroplane.obj").into()),
        ("aeroplane.mtl", include_str!("example/aeroplane.mtl").into()),
    ]),
    example!("city-cylinder", Some("Lorenz 1, 4"), "a city all around in 160 perspective strips"),
    example!("deformation", Some("Lorenz 5, 6"), "a city deformed by a grid of offsets", make::offsets),
    example!("mirror-ring", Some("Hou 1, 6"), "a mirror of mixed curvature, where it sees itself in a few places"),
    example!("mirror-teapot", Some("Hou 7"), "a shiny teapot, of 100 cameras, among 400 triangles that move", make::flocks),
    example!("water", Some("Hou 9"), "a drum under water: 12 facets that refract"),
    example!("glass-ball", Some("Hou 8"), "a ball of glass: two refractions and Fresnel's reflections"),
    example!("caustic", Some("Hou 11"), "the light that a ring reflects onto the floor", make::band),
    example!("caustic-ball", Some("Hou 11"), "the light that a ball of glass gathers on the floor"),
    example!("surround", Some("Hou 12"), "a walker from all around by 400 cameras, unfolded; the small triangles of the last row look up and down", make::barrel),
];

/// All of them by what they are for.
#[rustfmt::skip] // a table
const GROUPS: [(&str, &[&str]); 8] = [
    ("To begin with", &["demo", "pinhole", "orthographic", "still-life", "pen-and-ink", "wireframe"]),
    ("Two slits, moving eyes", &[
        "pushbroom", "cross-slit", "pencil", "bilinear", "city-cross-slit", "primitives", "hinge",
    ]),
    ("Sensors", &["fisheye", "angular-fisheye", "lens", "rolling-shutter"]),
    ("All around", &[
        "panorama", "cow-panorama", "teapot-panorama", "teapot-above", "cylinders", "city-cylinder", "surround",
    ]),
    ("Mirrors, lenses, caustics", &[
        "magnifier", "mirror-ball", "mirror-ring", "mirror-teapot", "water", "glass-ball", "caustic", "caustic-ball", "hidden-mirror",
    ]),
    ("Bent rays", &[
        "car", "three-projections", "columns", "twist", "twist-curved", "curved", "occlusion", "street", "ortho-to-perspective", "stairs",
        "deformation", "mesh",
    ]),
    ("Several views in one picture", &[
        "composite", "table", "terrain-top-down", "terrain-bottom-up", "morph", "tracked", "tree", "opposite", "graph-camera", "aeroplane",
    ]),
    ("Spheres, volumes, videos", &["helix", "smoke", "video-on-city"]),
];

/// All examples, a line each, under the heading of their group.
pub fn list() -> String {
    let mut text = String::new();
    for (k, (heading, names)) in GROUPS.iter().enumerate() {
        text += &format!("{}{heading}:\n", if k == 0 { "" } else { "\n" });
        for example in names.iter().flat_map(|name| EXAMPLES.iter().find(|e| e.name == *name)) {
            let after = example.figure.map(|figure| format!(" (after {figure})")).unwrap_or_default();
            text += &format!("  {:<22}{}{after}\n", example.name, example.shows);
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::Loading;
    use crate::scene::Scene;

    #[test]
    fn every_example_is_in_one_group() {
        let mut grouped: Vec<&str> = GROUPS.iter().flat_map(|group| group.1).copied().collect();
        let mut all: Vec<&str> = EXAMPLES.iter().map(|e| e.name).collect();
        grouped.sort_unstable();
        all.sort_unstable();
        assert_eq!(grouped, all);
        assert_eq!(list().lines().filter(|line| line.starts_with("  ")).count(), all.len());
    }

    #[test]
    fn the_teapot_of_cameras_has_the_papers_numbers() {
        let dir = tempfile::tempdir().unwrap();
        let example = EXAMPLES.iter().find(|e| e.name == "mirror-teapot").unwrap();
        let path = example.write(dir.path()).unwrap();
        let floor = 2;
        for (flock, triangles) in [(300, 400), (700, 800), (1100, 1200), (1500, 1600)] {
            let scene =
                Scene::load(&path, &[format!("mesh.0.file=flock-{flock}.obj")], 0.0, &Loading::default()).unwrap();
            assert_eq!(scene.mesh.triangles.len(), triangles + floor);
        }
        for cameras in [100, 256, 512] {
            let keys = [format!("camera.mirror.cameras={cameras}")];
            let camera = Scene::load(&path, &keys, 0.0, &Loading::default()).unwrap().camera().unwrap();
            assert_eq!(camera.optics.as_ref().unwrap().piece_count(), cameras);
        }
    }

    #[test]
    fn the_rays_of_surround_are_continuous_at_any_size() {
        let dir = tempfile::tempdir().unwrap();
        let path = EXAMPLES.iter().find(|e| e.name == "surround").unwrap().write(dir.path()).unwrap();
        for (width, height) in [(800, 400), (800, 600), (300, 500)] {
            let size = [format!("image.width={width}"), format!("image.height={height}")];
            let camera = Scene::load(&path, &size, 0.0, &Loading::default()).unwrap().camera().unwrap();
            let ray = |x: f64, y: f64| {
                let (i, j) = (x.floor(), y.floor());
                camera.with_sample_offset(x - i - 0.5, y - j - 0.5).ray(i as u32, j as u32).unwrap()
            };
            // the image has 20 x 10 cells; rows 0 and 9 are the caps; rays on both sides of a border between cells are the same
            let cell = glam::DVec2::new(f64::from(width) / 20.0, f64::from(height) / 10.0);
            let distance = |a: glam::DVec2, b: glam::DVec2| (ray(a.x, a.y).origin - ray(b.x, b.y).origin).length();
            for (column, row) in (1..20).flat_map(|c| (1..9).map(move |r| (f64::from(c), f64::from(r)))) {
                let step = 1e-6;
                let beside = cell * glam::DVec2::new(column, row - 0.4);
                let below = cell * glam::DVec2::new(column - 0.4, row);
                for (place, across) in [(beside, glam::DVec2::X), (below, glam::DVec2::Y)] {
                    let gap = distance(place - step * across, place + step * across);
                    // cells are about 0.3 wide, and a step crosses 2e-6 px
                    assert!(gap < 1e-6, "{width} x {height}: {gap} at {place}");
                }
            }
        }
    }

    #[test]
    fn every_example_loads_says_what_it_shows_and_comes_out_the_same() {
        for example in &EXAMPLES {
            let dir = tempfile::tempdir().unwrap();
            let path = example.write(dir.path()).unwrap();
            assert!(example.scene.starts_with("# "), "{}", example.name);
            assert_eq!(example.scene.contains("After"), example.figure.is_some(), "{}", example.name);
            let scene = Scene::load(&path, &[], 0.0, &Loading::default()).unwrap();
            assert_eq!(scene.output.color, Some(dir.path().join(format!("{}.png", example.name))));
            let camera = scene.camera().unwrap();
            // of the gallery's cameras some say how they are built, and all with optics, and where borders of pieces are drawn
            let says = example.figure.is_some() || camera.optics.is_some() || scene.style.borders.is_some();
            assert!(camera.notes.is_empty() || says, "{}: {:?}", example.name, camera.notes);
            assert!(camera.ray(camera.width / 2, camera.height / 2).is_some(), "{}", example.name);
            // no rays of different views cross
            let crosses = camera.kind == "top_down" && camera.notes.iter().any(|note| note.contains("cross"));
            assert!(!crosses, "{}: {:?}", example.name, camera.notes);
        }
    }
}
