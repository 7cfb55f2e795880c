//! Frames of `track` and `top_down` as kernels render them: with `smooth` and `segments`, with targets that pass each other or that no
//! shift reaches, and with regions that overlap. Nothing to do without an adapter.

use crate::common;

use common::file::scene_of;
use common::gpu::{check, hits};

const SIZE: (u32, u32) = (48, 36);

/// Four by four blocks between streets at -6.25, 0 and 6.25, and a closed box on one crossing.
const CITY: &str = r#"
[[mesh]]
builtin = "city"
seed = 3
blocks = 4
triangles = 1100
[[mesh]]
builtin = "box"
scale = 1.5
translate = [6.25, 0.9, 0]
"#;

/// What a camera is asked for, and what comes of it.
struct Case {
    name: String,
    keys: String,
    /// Whether it has layers of rays, or else one.
    is_layered: bool,
    /// Targets that are not tracked.
    left_out: usize,
}

const VIEW: &str = "eye = [0, 7, 30]\ntarget = [0, 2, 0]\nvfov = 40";

fn track(name: &str, targets: &[[f64; 3]], keys: &str) -> Case {
    let list: Vec<String> = targets.iter().map(|at| format!("{{ at = {at:?}, radius = 0.3 }}")).collect();
    Case {
        name: format!("track: {name}"),
        keys: format!("kind = \"track\"\n{VIEW}\ntargets = [{}]\n{keys}", list.join(", ")),
        is_layered: true,
        left_out: 0,
    }
}

/// On two streets, behind houses.
const HIDDEN: [f64; 3] = [-3.0, 0.4, 0.3];
const FARTHER: [f64; 3] = [4.0, 0.4, -6.0];
/// In the closed box.
const INSIDE: [f64; 3] = [6.25, 0.9, 0.0];

fn tracks() -> Vec<Case> {
    // one on each street, in the picture beside each other, at one place and past each other
    let passing = |x: f64| [[-3.0 + x, 0.4, 0.3], [-3.6 - x, 0.5, -6.0]];
    let mut cases = vec![
        track("smooth", &[HIDDEN], "smooth = 0.015625"),
        track("smooth, farther on the lattice", &[[-2.9, 0.4, 0.3]], "smooth = 0.03125"),
        track("smooth, two", &[HIDDEN, FARTHER], "smooth = 0.03125"),
        track("segments", &[HIDDEN], "segments = 9"),
        track("segments, two", &[HIDDEN, FARTHER], "segments = 20"),
        track("segments, with curves", &[HIDDEN], "segments = 9\njoin = \"bezier\""),
        track("smooth and segments", &[HIDDEN, FARTHER], "smooth = 0.03125\nsegments = 24"),
        track("smooth, in three parts", &[HIDDEN], "smooth = 0.03125\nlongitudinal = 3"),
        Case { is_layered: false, left_out: 1, ..track("unreachable", &[INSIDE], "") },
        Case { is_layered: false, left_out: 1, ..track("unreachable, smooth", &[INSIDE], "smooth = 0.03125") },
        Case { left_out: 1, ..track("one of two unreachable", &[INSIDE, FARTHER], "") },
    ];
    for (k, x) in [-0.8, 0.1, 0.9].into_iter().enumerate() {
        cases.push(track(&format!("two that pass, {k}"), &passing(x), ""));
        cases.push(track(&format!("two that pass, smooth, {k}"), &passing(x), "smooth = 0.03125"));
    }
    cases
}

fn regions() -> Vec<Case> {
    let layouts: [(&str, &[&str]); 3] = [
        ("two", &["rect = [0.2, 0.2, 0.5, 0.6]", "rect = [0.35, 0.4, 0.7, 0.75]"]),
        ("one in another", &["rect = [0.4, 0.4, 0.5, 0.5]", "rect = [0.2, 0.2, 0.7, 0.7]"]),
        (
            "three",
            &[
                "rect = [0.2, 0.2, 0.5, 0.6]",
                "polygon = [[0.45, 0.3], [0.8, 0.25], [0.75, 0.7], [0.6, 0.5]]",
                "rect = [0.3, 0.45, 0.7, 0.8]",
            ],
        ),
    ];
    let eyes = ["eye = [-8, 14, 6]", "eye = [10, 11, 8]", "eye = [1, 18, 12]"];
    let case = |(name, outlines): &(&str, &[&str]), keys: &str| {
        let list = outlines.iter().zip(eyes).map(|(o, eye)| format!("{{ {o}, {eye}, target = [0, 1, -2] }}"));
        let list: Vec<String> = list.collect();
        Case {
            name: format!("top_down: {name}, {keys}"),
            keys: format!("kind = \"top_down\"\n{VIEW}\nband = 0.1\nregions = [{}]\n{keys}", list.join(", ")),
            is_layered: keys.contains("foreground"),
            left_out: 0,
        }
    };
    layouts.iter().flat_map(|l| ["", "foreground = true"].map(|keys| case(l, keys))).collect()
}

#[test]
#[ignore = "slow: make test-all"]
fn frames_of_detours_and_of_regions_that_overlap_are_right() {
    for Case { name, keys, is_layered, left_out } in tracks().into_iter().chain(regions()) {
        let scene = scene_of(CITY, SIZE, &keys).unwrap();
        let camera = scene.camera().unwrap();
        let not_tracked = camera.unfulfilled.iter().filter(|says| says.contains("is not tracked")).count();
        assert!(not_tracked == left_out, "{name}: {:?}", camera.unfulfilled);
        assert_eq!(camera.layers.len() > 1, is_layered, "{name}");
        let Some((frame, judged, _)) = check(&name, &scene, &camera) else { return };
        // the judgement says something: most pixels are safe, and half of the picture are houses and streets
        let safe = judged.safe.iter().filter(|safe| **safe).count();
        let pixels = (SIZE.0 * SIZE.1) as usize;
        assert!(4 * safe > 3 * pixels && 5 * hits(&frame) > 2 * pixels, "{name}: {safe} safe, {} hits", hits(&frame));
    }
}
