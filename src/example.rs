//! Ready scenes on built-in geometry: one for each kind of camera, and the one of `make demo`.

mod make;

/// A scene, and the files that its camera reads.
pub struct Example {
    pub name: &'static str,
    /// What it shows, in a line.
    pub shows: &'static str,
    /// The scene file, commented.
    scene: &'static str,
    /// Makes the camera's own files: name and content.
    files: fn() -> Vec<(&'static str, Part)>,
}

/// The content of one file.
pub enum Part {
    Text(String),
    /// A .npy of height x width x 3.
    Vectors {
        width: u64,
        height: u64,
        numbers: Vec<f64>,
    },
}

impl Example {
    pub fn scene_name(&self) -> String {
        format!("{}.toml", self.name)
    }

    /// Every file's name and content, the scene last: once it is there, all is.
    pub fn parts(&self) -> Vec<(String, Part)> {
        let own = (self.files)().into_iter().map(|(name, part)| (name.to_owned(), part));
        own.chain([(self.scene_name(), Part::Text(self.scene.to_owned()))]).collect()
    }
}

/// The example `$name`, its scene beside this file.
macro_rules! example {
    ($name:literal, $shows:literal, $files:expr) => {
        Example { name: $name, shows: $shows, scene: include_str!(concat!("example/", $name, ".toml")), files: $files }
    };
    ($name:literal, $shows:literal) => {
        example!($name, $shows, Vec::new)
    };
}

/// All examples, the simplest camera first.
pub const EXAMPLES: [Example; 10] = [
    example!("demo", "a city in reverse perspective: a cross-slit camera with one slit behind it"),
    example!("pinhole", "the teapot through an ordinary camera"),
    example!("orthographic", "a city through parallel rays"),
    example!("pushbroom", "a city from a moving line camera (a GLC)"),
    example!("cross-slit", "a city through two slits (a GLC)"),
    example!("pencil", "a sheared city: a line of eyes, one for each row (a GLC)"),
    example!("bilinear", "a twisted city: no two rays meet (a GLC)"),
    example!("mesh", "a lens over a city: 450 pieces in a file of their own", make::lens),
    example!("panorama", "the teapot unrolled by 270 degrees: a mesh camera around it", make::ring),
    example!("fisheye", "a city from a crossing, straight up: a ray map in two files", make::fisheye),
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::{write_npy_f64, write_text};
    use crate::scene::Scene;

    #[test]
    fn every_example_loads_says_what_it_shows_and_comes_out_the_same() {
        for example in &EXAMPLES {
            let dir = tempfile::tempdir().unwrap();
            for (name, part) in example.parts() {
                match part {
                    Part::Text(text) => write_text(&dir.path().join(name), &text).unwrap(),
                    Part::Vectors { width, height, numbers } => {
                        write_npy_f64(&dir.path().join(name), &[height, width, 3], &numbers).unwrap();
                    }
                }
            }
            assert!(example.scene.starts_with("# "), "{}", example.name);
            let scene = Scene::load(&dir.path().join(example.scene_name()), &[], 0.0).unwrap();
            assert!(scene.output.color.is_some());
            let camera = scene.camera().unwrap();
            assert!(camera.notes.is_empty());
            assert!(camera.ray(camera.width / 2, camera.height / 2).is_some());
        }
    }
}
