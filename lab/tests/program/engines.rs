//! The commands of `anamorph` with the laboratory's techniques.

use super::place::Place;
use serde_json::Value;

#[test]
fn techniques_render_the_engines_picture_with_a_frame_for_each_sample() {
    let place = Place::new();
    if !place.has_adapter() {
        return;
    }
    place.works(&["render", "scene.toml", "-o", "ours.png"]);
    let raytraced = ["render", "scene.toml", "-o", "theirs.png", "--engine", "raytrace"];
    place.works(&raytraced);
    let sampled = ["--samples", "4", "-o", "sampled.png", "--report", "s.json"];
    place.works(&[&["render", "scene.toml", "--engine", "raytrace"], &sampled[..]].concat());
    let report: Value = serde_json::from_slice(&std::fs::read(place.path().join("s.json")).unwrap()).unwrap();
    assert_eq!(report["engine"], "raytrace");
    let shade = report["stage_passes"].as_array().unwrap().iter().find(|s| s["name"] == "shade").unwrap();
    assert_eq!(shade["passes"], 4);
    assert!(report["operations"]["edge_pixels"].is_null(), "{report}");
    let picture = |name: &str| image::open(place.path().join(name)).unwrap().into_rgb8().into_raw();
    let (ours, theirs) = (picture("ours.png"), picture("theirs.png"));
    // colors are rounded to 8 bits from values that differ in their last places
    let differ = ours.iter().zip(&theirs).filter(|(a, b)| a.abs_diff(**b) > 1).count();
    assert!((differ as f64) < 0.002 * ours.len() as f64, "{differ} of {}", ours.len());
}

#[test]
fn wrong_command_lines() {
    let place = Place::new();
    let engine = |name: &'static str| vec!["render", "scene.toml", "-o", "out.png", "--engine", name];
    for (arguments, says) in [
        (engine("gpu"), "no such engine"),
        (engine("rastr"), "raster-warp"),
        (engine("raster-warp:9"), "0 to 4 levels"),
        (
            [&engine("raytrace")[..], &["--gradients", "t", "--gradients-to", "g"]].concat(),
            "has no gradients; use --engine compute",
        ),
        (vec!["gpu-report", "--minutes", "-1"], "write a number of minutes from 0 to 1440"),
        (vec!["gpu-report", "--minutes", "eight"], "write a number of minutes"),
        (vec!["gpu-report", "--adapter", "no such adapter", "--out", "."], "no such adapter"),
        (vec!["bench", "--nothing"], "--nothing"),
    ] {
        place.refuses(&arguments, 2, says);
    }
    for arguments in [&["--help"][..], &[]] {
        let help = place.works(arguments);
        assert!(help.contains("bench") && help.contains("gpu-report"), "{help}");
    }
}
