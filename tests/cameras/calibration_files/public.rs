//! Numbers of public files: each ray is seen at its place by the formula of the writer's own code.

use super::*;

mod aslam;
mod photogrammetry;
mod polynomials;
mod slam;
mod vision;

/// The keys of a public file that define its lens, and the writer's projection to pixels, whose first has its center at (0, 0).
struct Public {
    /// Repository and path.
    origin: &'static str,
    /// Name that the file gets.
    file: &'static str,
    /// Keys of the scene's camera, beside its pose.
    keys: &'static str,
    size: [f64; 2],
    text: &'static str,
    /// Projects a direction with the numbers of the text.
    project: fn(&str, DVec3) -> DVec2,
}

const FOCAL: [&str; 4] = ["fx", "fy", "cx", "cy"];

fn public(origin: &'static str, size: [f64; 2], text: &'static str, project: fn(&str, DVec3) -> DVec2) -> Public {
    Public { origin, file: "camera.yaml", keys: "", size, text, project }
}

/// Places in each image: 64 x 48, evenly spread, of which at least 1,000 have a ray.
const PLACES: (u32, u32) = (64, 48);

/// Largest error of a place. Places are under 2^13 px, which round to 2^-40 px, and the formulas amplify that by under 2^7.
const PIXEL: f64 = 1.0 / (1u64 << 33) as f64;

/// Compares each file's rays with its formula, and prints the largest error.
fn check_public(files: &[Public]) {
    for Public { origin, file, keys, size: [width, height], text, project } in files {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join(file), text).unwrap();
        let table = format!("kind = 'calibrated'\nfile = '{file}'\n{keys}\n{POSE}");
        let camera = camera_in(folder.path(), &table, Some(PLACES)).unwrap_or_else(|e| panic!("{origin}: {e}"));
        let (mut count, mut largest) = (0, 0.0);
        for (i, j) in (0..PLACES.1).flat_map(|j| (0..PLACES.0).map(move |i| (i, j))) {
            let Some(ray) = camera.ray(i, j) else { continue };
            let place = |k: u32, count: u32, side: f64| (f64::from(k) + 0.5) / f64::from(count) * side - 0.5;
            let place = DVec2::new(place(i, PLACES.0, *width), place(j, PLACES.1, *height));
            let off = (project(text, in_camera_frame(ray.direction)) - place).length();
            assert!(off <= PIXEL, "{origin}: the ray at {place} is projected {off} px off");
            (count, largest) = (count + 1, f64::max(largest, off));
        }
        assert!(count >= 1000, "{origin}: only {count} places have a ray");
        println!("{origin}: {largest:.1e} px");
    }
}

/// The text after a key.
fn rest<'a>(text: &'a str, key: &str) -> &'a str {
    text.split_once(key).unwrap_or_else(|| panic!("no {key} in {text}")).1
}

/// The first numbers after a key.
fn after<const N: usize>(text: &str, key: &str) -> [f64; N] {
    let words = rest(text, key).split(|c: char| !(c.is_ascii_alphanumeric() || "+-.".contains(c)));
    let numbers: Vec<f64> = words.filter_map(|word| word.parse().ok()).take(N).collect();
    numbers.try_into().unwrap_or_else(|_| panic!("no {N} numbers after {key} in {text}"))
}

/// The number of each key of YAML, JSON or XML; 0 where it is absent.
fn named<const N: usize>(text: &str, keys: [&str; N]) -> [f64; N] {
    keys.map(|key| {
        let spellings = [format!("{key}:"), format!("{key}\":"), format!("<{key}>")];
        let found = spellings.iter().find(|spelling| text.contains(spelling.as_str()));
        found.map_or(0.0, |spelling| after::<1>(text, spelling)[0])
    })
}

/// From the plane to pixels.
fn plane([fx, fy, cx, cy]: [f64; 4], p: DVec2) -> DVec2 {
    to_pixel([fx, fy], [cx, cy], p)
}

/// The place, up to `end`, at which a growing function has this value.
fn inverse(grows: impl Fn(f64) -> f64, value: f64, end: f64) -> f64 {
    let (mut low, mut high) = (0.0, end);
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            return middle;
        }
        if grows(middle) < value { low = middle } else { high = middle }
    }
}

/// A polynomial by Horner's rule.
fn polynomial(c: &[f64], x: f64) -> f64 {
    c.iter().rev().fold(0.0, |sum, c| sum * x + c)
}

/// Angle from the axis.
fn angle(d: DVec3) -> f64 {
    d.truncate().length().atan2(d.z)
}

/// Scaramuzza's model: the height over the sensor is minus the polynomial of the radius, and `[1 e; d c]` takes the sensor to pixels.
fn scaramuzza(heights: &[f64], [c, d, e]: [f64; 3], center: [f64; 2], direction: DVec3) -> DVec2 {
    let radius = inverse(|rho| rho.atan2(-polynomial(heights, rho)), angle(direction), 2048.0);
    let p = direction.truncate().normalize_or_zero() * radius;
    DVec2::new(p.x + e * p.y, d * p.x + c * p.y) + DVec2::from(center)
}
