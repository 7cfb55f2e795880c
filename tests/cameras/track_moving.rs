//! Pictures of `track` with `smooth`, in fine steps: rays move continuously with the targets, from one detour to another too.

use super::track::{HOUSE, SIZE, VIEW, place, places, scene};
use crate::common::file::refusal;
use glam::{DVec2, DVec3};

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

/// Frames of a path.
const FRAMES: usize = 32;
const SMOOTH: f64 = 1.0 / 64.0;
/// Distance of the lattice's points: detours are interpolated between them.
const STEP_PX: f64 = SIZE.1 as f64 * SMOOTH;
/// Of a jump, half the step leaves all; of motion at a constant speed, half. Rays move at a constant speed between two planes of the lattice: if
/// a whole step fits between those where they are fastest, half the step leaves half, and if half of it does, 3/4.
const HALVED: f64 = 0.75;
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

fn moves(meshes: &str, targets: impl Fn(f64) -> Vec<DVec3>) -> Moves {
    let mut frames: Vec<(Vec<DVec2>, Vec<DVec2>)> = Vec::new();
    let mut notes = Vec::new();
    for k in 0..=FRAMES {
        let at = targets(k as f64 / FRAMES as f64);
        let list: Vec<String> = at.iter().map(|at| format!("{{ at = {:?}, radius = 0.4 }}", at.to_array())).collect();
        let camera = scene(meshes, &format!("targets = [{}]\nsmooth = {SMOOTH}", list.join(", "))).camera().unwrap();
        notes.extend(camera.unfulfilled.iter().map(|n| (k, n.clone())));
        frames.push((places(&camera), at.into_iter().map(place).collect()));
    }
    let most = |a: &[DVec2], b: &[DVec2]| a.iter().zip(b).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
    let rays = |n: usize| frames.windows(n + 1).map(|f| most(&f[0].0, &f[n].0)).fold(0.0, f64::max);
    let plain = places(&scene(meshes, "targets = [{ at = [0, 1, 9] }]").camera().unwrap());
    Moves {
        rays_px: [rays(2), rays(1)],
        targets_px: frames.windows(2).map(|f| most(&f[0].1, &f[1].1)).fold(0.0, f64::max),
        shift_px: frames.iter().map(|f| most(&f.0, &plain)).fold(0.0, f64::max),
        notes,
    }
}

#[test]
fn from_one_detour_to_another_rays_do_not_jump() {
    let row = |x: f64, z: f64| DVec3::new(x, 0.8, z);
    type Path = Box<dyn Fn(f64) -> Vec<DVec3>>;
    // where rays jump without it; and in how many frames, at most, a target is hidden meanwhile
    let cases: Vec<(&str, &str, [f64; 2], Path, usize)> = vec![
        ("opposite detours", TOWER, [-0.4, 0.4], Box::new(move |x| vec![row(x, -3.0)]), 16),
        ("into a gate", GATE, [-6.8, -5.4], Box::new(move |x| vec![row(x, -3.0)]), 0),
        ("along a gap", GAP, [-3.4, -2.4], Box::new(move |x| vec![row(x, -3.0)]), 0),
        ("no direction in common", HOUSE, [1.6, 2.4], Box::new(move |x| vec![row(x, -3.0), row(-x, -1.0)]), 0),
        ("three", GATE, [-2.4, -1.2], Box::new(move |x| vec![row(x, -3.0), row(-x, -1.0), row(0.5 * x + 1.0, 0.5)]), 8),
    ];
    let mut failed = Vec::new();
    for (name, meshes, [from, to], path, hidden) in cases {
        let Moves { rays_px, targets_px, shift_px, notes } = moves(meshes, |s| path(from + s * (to - from)));
        println!(
            "{name}: rays {:.3} px, then {:.3} px, targets {targets_px:.3} px, ratio {:.2}, shift {shift_px:.1} px, hidden {:?}",
            rays_px[0],
            rays_px[1],
            rays_px[1] / targets_px,
            notes.iter().map(|n| n.0).collect::<Vec<_>>(),
        );
        // from the detours at one point of the lattice to those at the next, for each target
        let most = path(from).len() as f64 * 2.0 * shift_px / STEP_PX + PASSED;
        assert!(targets_px < STEP_PX / 4.0, "{name}: {targets_px}");
        assert!(notes.iter().all(|n| n.1.contains("is hidden for the moment")), "{name}: {notes:?}");
        let is_smooth = rays_px[1] <= HALVED * rays_px[0] && rays_px[1] <= most * targets_px;
        if !is_smooth || notes.len() > hidden {
            failed.push(name);
        }
    }
    assert!(failed.is_empty(), "{failed:?}");
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
