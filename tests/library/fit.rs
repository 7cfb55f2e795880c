//! A lens is found from an image of squares by the gradients of its edges, as `python/examples/fit_fisheye.py` finds it.

use anamorph::{Camera, Mesh, NO_ID, Renderer, Scene};
use std::path::Path;

const NAMES: [&str; 4] = ["camera.fx", "camera.fy", "camera.k1", "camera.k2"];

const TRUTH: [f64; 4] = [200.0, 195.0, 0.05, -0.01];

/// 5 % off.
const START: [f64; 4] = [210.0, 185.25, 0.0525, -0.0105];

/// Of the calibrated image, px.
const SIDE: u32 = 640;

type Numbers = [f64; 4];

/// White squares all about the eye, up to 70 degrees from where it looks.
fn squares() -> Scene {
    let mut scene = Scene::new();
    for (ring, (angle, count)) in [(0f64, 1u32), (22.0, 6), (45.0, 10), (68.0, 14)].into_iter().enumerate() {
        for k in 0..count {
            let turn = std::f64::consts::TAU * (f64::from(k) + 0.3 * ring as f64) / f64::from(count);
            let (sin, cos) = angle.to_radians().sin_cos();
            let ahead = [sin * turn.cos(), sin * turn.sin(), -cos];
            // across the way ahead, turned a little
            let side = 0.5 + 0.1 * f64::from(k % 3);
            let across = [-turn.sin() * side, turn.cos() * side, 0.2 * side];
            let up =
                [0, 1, 2].map(|n| ahead[(n + 1) % 3] * across[(n + 2) % 3] - ahead[(n + 2) % 3] * across[(n + 1) % 3]);
            let corner = |(x, y): (f64, f64)| [0, 1, 2].map(|n| 4.0 * ahead[n] + x * across[n] + y * up[n]);
            let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(corner).to_vec();
            scene.add(Mesh::new(corners, vec![[0, 1, 2], [0, 2, 3]]).unwrap()).unwrap();
        }
    }
    scene
}

/// The camera with these numbers.
fn lens(numbers: &Numbers, folder: &Path, scene: &Scene, side: u32) -> anamorph::Result<Camera> {
    let [fx, fy, k1, k2] = numbers;
    let centre = f64::from(SIDE - 1) / 2.0;
    let text = format!(
        "%YAML:1.0\n---\nimage_width: {SIDE}\nimage_height: {SIDE}\n\
         camera_matrix: {{ rows: 3, cols: 3, dt: d, data: [{fx:?}, 0., {centre:?}, 0., {fy:?}, {centre:?}, 0., 0., 1.] }}\n\
         distortion_coefficients: {{ rows: 4, cols: 1, dt: d, data: [{k1:?}, {k2:?}, 0., 0.] }}\n"
    );
    std::fs::write(folder.join("lens.yml"), text).unwrap();
    let table = "kind = \"opencv\"\nmodel = \"fisheye\"\nfile = \"lens.yml\"\neye = [0, 0, 0]\ntarget = [0, 0, -1]";
    Camera::parse(table, folder, scene, Some((side, side)))
}

/// The image with smooth edges, and how it changes with the numbers; `None` where a pixel at the rim has no derivative.
fn image(renderer: &mut Renderer, scene: &Scene, camera: &Camera) -> (Vec<f64>, Vec<Option<Numbers>>) {
    let found = renderer.gradients(scene, camera, &["coverage"], &NAMES).unwrap();
    let is_white = |pixel: u32| f64::from(found.u32("triangle").unwrap().1[pixel as usize] != NO_ID);
    let (shares, changes) = (found.f32("coverage").unwrap().1, found.f32("coverage.camera").unwrap().1);
    let sides = found.u32("coverage.pixels").unwrap().1.as_chunks::<2>().0;
    let mut image = Vec::new();
    let mut all = Vec::new();
    for (pixel, (share, sides)) in (0..).zip(shares.iter().zip(sides)) {
        let [inside, outside] = sides.map(|side| is_white(if side == NO_ID { pixel } else { side }));
        image.push(f64::from(*share) * inside + (1.0 - f64::from(*share)) * outside);
        let change: Numbers = std::array::from_fn(|n| f64::from(changes[4 * pixel as usize + n]) * (inside - outside));
        all.push(change.iter().all(|c| c.is_finite()).then_some(change));
    }
    (image, all)
}

/// Solves a system of four equations, by elimination with the largest pivots.
fn solved(mut m: [[f64; 4]; 4], mut b: Numbers) -> Numbers {
    for k in 0..4 {
        let largest = (k..4).max_by(|i, j| m[*i][k].abs().total_cmp(&m[*j][k].abs())).unwrap();
        m.swap(k, largest);
        b.swap(k, largest);
        for i in (0..4).filter(|i| *i != k) {
            let share = m[i][k] / m[k][k];
            (0..4).for_each(|n| m[i][n] -= share * m[k][n]);
            b[i] -= share * b[k];
        }
    }
    std::array::from_fn(|k| b[k] / m[k][k])
}

/// Steps of Levenberg and Marquardt towards the lens of a photo.
fn fitted(renderer: &mut Renderer, scene: &Scene, folder: &Path, side: u32, mut numbers: Numbers) -> Numbers {
    let truth = lens(&TRUTH, folder, scene, side).unwrap();
    let photo = image(renderer, scene, &truth).0;
    let mut rendered = |numbers: &Numbers| {
        let camera = lens(numbers, folder, scene, side).ok()?;
        let (image, changes) = image(renderer, scene, &camera);
        let pixels = image.iter().zip(&photo).zip(changes);
        Some(pixels.filter_map(|((own, photo), change)| Some((own - photo, change?))).collect::<Vec<(f64, Numbers)>>())
    };
    let error = |pixels: &[(f64, Numbers)]| pixels.iter().map(|(off, _)| off * off).sum::<f64>();
    let mut pixels = rendered(&numbers).unwrap();
    let mut damping = 1e-3;
    for _ in 0..12 {
        let sum = |f: &dyn Fn(&(f64, Numbers)) -> f64| pixels.iter().map(f).sum::<f64>();
        let mut normal: [[f64; 4]; 4] = std::array::from_fn(|i| std::array::from_fn(|j| sum(&|(_, c)| c[i] * c[j])));
        (0..4).for_each(|k| normal[k][k] *= 1.0 + damping);
        let step = solved(normal, std::array::from_fn(|k| -sum(&|(off, c)| off * c[k])));
        let next: Numbers = std::array::from_fn(|k| numbers[k] + step[k]);
        match rendered(&next).filter(|own| error(own) < error(&pixels)) {
            Some(own) => (numbers, pixels, damping) = (next, own, damping / 10.0),
            None => damping *= 10.0,
        }
    }
    numbers
}

/// The farthest that a direction up to 70 degrees from the axis is seen from where it should be, px of the calibrated image.
fn off(numbers: &Numbers) -> f64 {
    let radius =
        |n: &Numbers, focal: f64, theta: f64| focal * theta * (1.0 + theta.powi(2) * (n[2] + theta.powi(2) * n[3]));
    let thetas = (0..=70).map(|degrees| f64::from(degrees).to_radians());
    let each = |theta| [0, 1].map(|k| (radius(numbers, numbers[k], theta) - radius(&TRUTH, TRUTH[k], theta)).abs());
    thetas.flat_map(each).fold(0.0, f64::max)
}

#[test]
#[ignore = "slow: make test-all"]
fn a_fisheye_is_found_from_its_edges() {
    let folder = tempfile::tempdir().unwrap();
    let (scene, mut renderer) = (squares(), Renderer::new().unwrap());
    let first = off(&START);
    assert!(first > 10.0, "{first} px");
    // edges pull from within a pixel: small images first
    let mut numbers = START;
    for side in [24, 48, 96] {
        numbers = fitted(&mut renderer, &scene, folder.path(), side, numbers);
        println!("{side}: {numbers:?}, off by {:.2e} px", off(&numbers));
    }
    // the photo is of the same model, so that only the rounding of f32 coverage is left: 2^-24 of a pixel of 640 / 96 px, and a hundred
    // for the parts of the numbers that look alike
    assert!(off(&numbers) < 1e-4, "{numbers:?}, off by {} px", off(&numbers));
}
