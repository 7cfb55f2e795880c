//! Pictures of `track` with `smooth`, in fine steps: rays move continuously with the targets, from one detour to another too.

use super::track::{HOUSE, SIZE, VIEW, depth, place_in, places, points_at, scene_in};
use crate::common::file::refusal;
use crate::common::gpu::{check, ids};
use anamorph::internals::camera::Camera;
use anamorph::internals::camera::project::Projector;
use anamorph::internals::image::frame::{Channel, NO_ID};
use anamorph::internals::scene::Scene;
use glam::{DMat2, DVec2, DVec3};

/// A tower at z = 5, higher than the picture, and a floor: a target behind it has detours to the left and to the right alone.
const TOWER: &str = r#"
[[mesh]]
builtin = "plane"
scale = 40
[[mesh]]
builtin = "box"
scale = [3, 14, 1]
translate = [0, 7, 5]
"#;

/// Two houses at z = 5, and a floor.
const GATE: &str = r#"
[[mesh]]
builtin = "plane"
scale = 40
[[mesh]]
builtin = "box"
scale = [4, 5, 1]
translate = [-4, 2.5, 5]
[[mesh]]
builtin = "box"
scale = [4, 4, 1]
translate = [3, 2, 5]
"#;

/// A wall at z = 5 with a gap of 2 in it, higher than the picture, and a floor.
const GAP: &str = r#"
[[mesh]]
builtin = "plane"
scale = 40
[[mesh]]
builtin = "box"
scale = [20, 14, 1]
translate = [-11, 7, 5]
[[mesh]]
builtin = "box"
scale = [20, 14, 1]
translate = [11, 7, 5]
"#;

/// An image of another size and shape than the others.
const OTHER_SIZE: (u32, u32) = (120, 68);

/// Frames of a path.
const FRAMES: usize = 32;
const SMOOTH: f64 = 1.0 / 64.0;
/// Of a jump, half the step leaves all; of motion at a constant speed, half. Rays move at a constant speed between two planes of the lattice: if
/// a whole step fits between those where they are fastest, half the step leaves half, and if half of it does, 3/4.
const HALVED: f64 = 0.75;
/// Of the safe hits of a rendered frame, one of so many is followed.
const EACH: usize = 7;
/// Of a rendered position: two weights, each rounded to f32 by at most 2^-25, of sides of a floor that are shorter than 1024.
const ROUNDING: f64 = 2.0 * 1024.0 / (1u64 << 25) as f64;
/// How much faster than the targets rays move elsewhere: where one target passes before another.
const PASSED: f64 = 8.0;

struct Moves {
    /// The largest motion of a ray, px, in steps of two frames and of one.
    rays_px: [f64; 2],
    /// The same of a target, in steps of one frame.
    targets_px: f64,
    /// How far a ray is from where it is in the plain view.
    shift_px: f64,
    /// Of each frame: its number, and what is not fulfilled.
    notes: Vec<(usize, String)>,
}

/// The largest distance between two places of the same number.
fn most(a: &[DVec2], b: &[DVec2]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max)
}

/// Targets as their path goes on, from 0 to 1.
type Path = Box<dyn Fn(f64) -> Vec<DVec3>>;

/// A path of targets, and how its pictures are made.
struct Case {
    name: &'static str,
    meshes: &'static str,
    size: (u32, u32),
    keys: &'static str,
    frames: usize,
    path: Path,
}

impl Case {
    fn new(name: &'static str, meshes: &'static str, path: impl Fn(f64) -> Vec<DVec3> + 'static) -> Case {
        Case { name, meshes, size: SIZE, keys: "", frames: FRAMES, path: Box::new(path) }
    }

    /// Distance of the lattice's points: detours are interpolated between them.
    fn step_px(&self) -> f64 {
        f64::from(self.size.1) * SMOOTH
    }

    fn at(&self, frame: usize) -> Vec<DVec3> {
        (self.path)(frame as f64 / self.frames as f64)
    }

    fn scene(&self, at: &[DVec3]) -> Scene {
        let list: Vec<String> = at.iter().map(|at| format!("{{ at = {:?}, radius = 0.4 }}", at.to_array())).collect();
        let keys = format!("targets = [{}]\nsmooth = {SMOOTH}\n{}", list.join(", "), self.keys);
        scene_in(self.size, self.meshes, &keys)
    }

    fn moves(&self) -> Moves {
        let mut frames: Vec<(Vec<DVec2>, Vec<DVec2>)> = Vec::new();
        let mut notes = Vec::new();
        for k in 0..=self.frames {
            let at = self.at(k);
            let camera = self.scene(&at).camera().unwrap();
            notes.extend(camera.unfulfilled.iter().map(|n| (k, n.clone())));
            frames.push((places(&camera), at.into_iter().map(|at| place_in(self.size, at)).collect()));
        }
        let rays = |n: usize| frames.windows(n + 1).map(|f| most(&f[0].0, &f[n].0)).fold(0.0, f64::max);
        let plain = self.plain();
        Moves {
            rays_px: [rays(2), rays(1)],
            targets_px: frames.windows(2).map(|f| most(&f[0].1, &f[1].1)).fold(0.0, f64::max),
            shift_px: frames.iter().map(|f| most(&f.0, &plain)).fold(0.0, f64::max),
            notes,
        }
    }

    /// Rays' places in the plain view.
    fn plain(&self) -> Vec<DVec2> {
        places(&scene_in(self.size, self.meshes, "targets = [{ at = [0, 1, 9] }]").camera().unwrap())
    }

    /// How far a ray of the camera is from where it is in the plain view.
    fn shift(&self, camera: &Camera) -> f64 {
        most(&places(camera), &self.plain())
    }

    /// How much faster than the targets rays may move: from the detours at one point of the lattice to those at the next, for each target.
    fn fastest(&self, shift_px: f64) -> f64 {
        (self.path)(0.0).len() as f64 * 2.0 * shift_px / self.step_px() + PASSED
    }

    /// Whether rays do not jump, and targets are hidden in no more frames than these.
    fn is_smooth(&self, hidden: usize) -> bool {
        let Moves { rays_px, targets_px, shift_px, notes } = self.moves();
        let name = self.name;
        println!(
            "{name}: rays {:.3} px, then {:.3} px, targets {targets_px:.3} px, ratio {:.2}, shift {shift_px:.1} px, hidden {:?}",
            rays_px[0],
            rays_px[1],
            rays_px[1] / targets_px,
            notes.iter().map(|n| n.0).collect::<Vec<_>>(),
        );
        assert!(targets_px < self.step_px() / 4.0, "{name}: {targets_px}");
        assert!(notes.iter().all(|n| n.1.contains("is hidden for the moment")), "{name}: {notes:?}");
        rays_px[1] <= HALVED * rays_px[0] && rays_px[1] <= self.fastest(shift_px) * targets_px && notes.len() <= hidden
    }
}

fn row(x: f64, z: f64) -> DVec3 {
    DVec3::new(x, 0.8, z)
}

/// From one place to another as s goes from 0 to 1.
fn between(from: f64, to: f64) -> impl Fn(f64) -> f64 {
    move |s| from + s * (to - from)
}

/// One target from x to x.
fn alone(from: f64, to: f64) -> impl Fn(f64) -> Vec<DVec3> {
    let x = between(from, to);
    move |s| vec![row(x(s), -3.0)]
}

/// Where rays jump without `smooth`; and in how many frames, at most, a target is hidden meanwhile.
fn jumps() -> Vec<(Case, usize)> {
    let (opposite, three) = (between(1.6, 2.4), between(-2.4, -1.2));
    vec![
        (Case::new("opposite detours", TOWER, alone(-0.4, 0.4)), 16),
        (Case::new("into a gate", GATE, alone(-6.8, -5.4)), 0),
        (Case::new("along a gap", GAP, alone(-3.4, -2.4)), 0),
        (Case::new("no direction in common", HOUSE, move |s| vec![row(opposite(s), -3.0), row(-opposite(s), -1.0)]), 0),
        (
            Case::new("three", GATE, move |s| {
                let x = three(s);
                vec![row(x, -3.0), row(-x, -1.0), row(0.5 * x + 1.0, 0.5)]
            }),
            8,
        ),
    ]
}

#[test]
#[ignore = "slow: make test-all"]
fn from_one_detour_to_another_rays_do_not_jump() {
    let failed: Vec<&str> =
        jumps().into_iter().filter(|(case, hidden)| !case.is_smooth(*hidden)).map(|(case, _)| case.name).collect();
    assert!(failed.is_empty(), "{failed:?}");
}

/// Another shape of the image, and `segments`, in which groups of targets neither meet nor part: one target, and two far apart.
#[test]
#[ignore = "slow: make test-all"]
fn rays_do_not_jump_in_other_images_and_in_segments_either() {
    let x = between(-3.4, -3.0);
    let apart = Case::new("two far apart", GATE, move |s| vec![row(x(s) - 3.4, -3.0), row(x(s) + 9.0, -3.0)]);
    let gate = Case { size: OTHER_SIZE, ..Case::new("into a gate", GATE, alone(-6.75, -6.05)) };
    let opposite = Case { size: OTHER_SIZE, ..Case::new("opposite detours", TOWER, alone(-0.2, 0.2)) };
    let cases =
        [(gate, 0), (Case { keys: "segments = 9", ..opposite }, 8), (Case { keys: "segments = 20", ..apart }, 0)];
    for (case, hidden) in cases {
        let case = Case { frames: FRAMES / 2, ..case };
        assert!(case.is_smooth(hidden), "{}", case.name);
    }
}

/// A frame as kernels render it: what some of its pixels see, and where.
struct Shown {
    camera: Camera,
    points: Vec<((u32, u32), DVec3)>,
    targets: Vec<DVec2>,
}

impl Case {
    /// `None` without an adapter.
    fn shown(&self, frame: usize) -> Option<Shown> {
        let at = self.at(frame);
        let scene = self.scene(&at);
        let camera = scene.camera().unwrap();
        let (rendered, judged, _) = check(self.name, &scene, &camera)?;
        let [u, v] = [Channel::BaryU, Channel::BaryV].map(|c| rendered.f32(c).unwrap());
        let point = |k: usize| {
            let [a, b, c] = scene.mesh.triangles[ids(&rendered)[k] as usize].map(|v| scene.mesh.positions[v as usize]);
            a + f64::from(u[k]) * (b - a) + f64::from(v[k]) * (c - a)
        };
        let pixel = |k: usize| (k as u32 % camera.width, k as u32 / camera.width);
        let is_seen = |k: &usize| judged.safe[*k] && ids(&rendered)[*k] != NO_ID;
        let points = (0..u.len()).filter(is_seen).step_by(EACH).map(|k| (pixel(k), point(k))).collect();
        Some(Shown { points, targets: at.into_iter().map(|at| place_in(self.size, at)).collect(), camera })
    }

    /// How much larger than the motion of rays that of images may be: the inverse of how fast, at least, the places of rays move with
    /// those of pixels, at the depth of a point.
    fn stretch(&self, camera: &Camera, points: &[((u32, u32), DVec3)]) -> f64 {
        let by = 1.0 / 1024.0;
        let beside =
            [DVec2::ZERO, DVec2::new(by, 0.0), DVec2::new(0.0, by)].map(|o| camera.with_sample_offset(o.x, o.y));
        let slowest = |(pixel, point): &((u32, u32), DVec3)| {
            let [at, right, down] =
                [0, 1, 2].map(|k| place_in(self.size, points_at(&beside[k], *pixel, [depth(*point)].into_iter())[0]));
            let slope = DMat2::from_cols((right - at) / by, (down - at) / by);
            // the singular values of a 2 x 2 matrix: their product is |det|, the sum of their squares that of the elements
            let (sum, product) = (slope.to_cols_array().map(|x| x * x).iter().sum::<f64>(), slope.determinant().abs());
            product / ((sum + (sum * sum - 4.0 * product * product).max(0.0).sqrt()) / 2.0).sqrt()
        };
        1.0 / points.iter().map(slowest).fold(f64::INFINITY, f64::min)
    }
}

#[test]
#[ignore = "slow: make test-all"]
fn images_of_fixed_points_move_no_faster_than_the_rays() {
    // the frames in which the rays would jump
    let mut cases = jumps().into_iter().map(|(case, _)| case);
    let [opposite, gate] = [0, 1].map(|_| cases.next().unwrap());
    for (case, jump) in [(opposite, 12..=20), (Case { size: OTHER_SIZE, ..gate }, 2..=9)] {
        let Some(frames) = jump.map(|k| case.shown(k)).collect::<Option<Vec<Shown>>>() else { return };
        let centre = |(i, j): (u32, u32)| DVec2::new(f64::from(i) + 0.5, f64::from(j) + 0.5);
        // of the detours that the rays pass between
        let shift_px = [0, FRAMES].map(|k| case.shift(&case.scene(&case.at(k)).camera().unwrap()));
        let shift_px = shift_px.into_iter().fold(0.0, f64::max);
        let (mut rays_px, mut images_px, mut stretch, mut targets_px) = (0f64, 0f64, 0f64, 0f64);
        for pair in frames.windows(2) {
            let [last, next] = pair else { unreachable!() };
            targets_px = targets_px.max(most(&last.targets, &next.targets));
            stretch = stretch.max(case.stretch(&next.camera, &last.points));
            let projector = Projector::new(&next.camera);
            for (pixel, x) in &last.points {
                let then = |camera: &Camera| points_at(camera, *pixel, [depth(*x)].into_iter())[0];
                assert!(then(&last.camera).distance(*x) < ROUNDING, "{}: {pixel:?} does not see {x}", case.name);
                rays_px = rays_px.max(place_in(case.size, then(&next.camera)).distance(place_in(case.size, *x)));
                let images = projector.project(*x).images;
                let moved = images.iter().map(|image| DVec2::new(image.x, image.y).distance(centre(*pixel)));
                // one that leaves the picture goes as far as the border at least
                let size = DVec2::new(case.size.0.into(), case.size.1.into());
                let to_border = centre(*pixel).min(size - centre(*pixel)).min_element();
                images_px = images_px.max(moved.reduce(f64::min).unwrap_or(to_border));
            }
        }
        let (name, fastest) = (case.name, case.fastest(shift_px));
        println!(
            "{name}: rays {rays_px:.3} px, images {images_px:.3} px, stretched {stretch:.2} times, targets {targets_px:.3} px, \
             shift {shift_px:.1} px"
        );
        assert!(shift_px > 5.0 && targets_px < case.step_px() / 4.0, "{name}: {shift_px}, {targets_px}");
        assert!(rays_px <= fastest * targets_px, "{name}: rays move by {rays_px} px, targets by {targets_px} px");
        assert!(images_px <= stretch * rays_px, "{name}: images move by {images_px} px, rays by {rays_px} px");
    }
}

#[test]
fn smooth_is_a_part_of_the_height() {
    let says = |smooth: &str| {
        refusal(HOUSE, SIZE, &format!("kind = \"track\"\n{VIEW}\ntargets = [{{ at = [0, 1, 0] }}]\nsmooth = {smooth}"))
    };
    for wrong in ["-0.1", "0.2", "1e-9", "nan"] {
        assert!(says(wrong).contains("camera.smooth"), "{}", says(wrong));
    }
}
