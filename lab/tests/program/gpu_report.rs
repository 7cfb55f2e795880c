//! `anamorph gpu-report`: a first frame and the control kernels, what a later run finds, and a self-test that fails.

use super::place::{Place, assert_one_line};
use serde_json::{Value, json};
use std::path::PathBuf;

/// The report's folder in `out`.
fn folder(place: &Place) -> PathBuf {
    folder_of(place, "-gpu-report")
}

/// The folder in `out` whose name ends so.
fn folder_of(place: &Place, end: &str) -> PathBuf {
    let mut entries = std::fs::read_dir(place.path().join("out")).unwrap().map(|e| e.unwrap().path());
    entries.find(|path| path.to_string_lossy().ends_with(end)).expect(end)
}

fn report(place: &Place) -> Value {
    serde_json::from_str(&std::fs::read_to_string(folder(place).join("report.json")).unwrap()).unwrap()
}

#[test]
#[ignore = "slow: make test-all"]
fn a_report_is_gone_on_with_and_wrong_pixels_are_an_error() {
    let place = Place::new();
    if !place.has_adapter() {
        return;
    }
    let short = ["gpu-report", "--minutes", "0", "--out", "out"];
    let said = place.works(&short);
    let first = report(&place);
    let frames = first["frames"].as_array().unwrap();
    assert_eq!((frames.len(), &frames[0]["scene"], &frames[0]["wrong"]), (1, &json!("demo"), &json!(0)));
    assert!(frames[0]["kernels"].as_str().unwrap().starts_with("pieces; "));
    let measured = first["bandwidths"]["Ok"].as_array().unwrap();
    assert!(measured.iter().all(|b| b["bytes"].as_f64().unwrap() > 0.0 && b["ms"].as_f64().unwrap() > 0.0));
    for control in ["read_only", "write_only"] {
        assert!(measured.iter().any(|b| b["kernel"] == control) && said.contains(control), "{said}");
    }
    assert!(said.contains("not run: self-test, 71 frames; stages, all ") && said.contains("go on"), "{said}");

    // a suite's case that is there is not run again, nor what the report has
    place.works(&["bench", "stages", "--quick", "--case", "city-cross-slit", "--runs", "1", "--out", "out"]);
    // all other files follow from its results
    let run = folder_of(&place, "-stages-quick");
    let files = ["../index.html", "index.html", "raw.csv", "summary.md", "stages.svg"].map(|file| run.join(file));
    let drawn = files.each_ref().map(|path| std::fs::read_to_string(path).unwrap_or_else(|e| panic!("{path:?}: {e}")));
    files.iter().for_each(|path| std::fs::remove_file(path).unwrap());
    place.works(&["bench", "page", "--out", "out"]);
    assert!(drawn[0].contains("city-cross-slit"));
    for (path, text) in files.iter().zip(&drawn) {
        assert!(std::fs::read_to_string(path).unwrap() == *text, "{}", path.display());
    }
    let is_software = first["provenance"]["is_software"] == true;
    let again = place.works(&short);
    assert_eq!(report(&place)["bandwidths"], first["bandwidths"]);
    assert_eq!(report(&place)["frames"], first["frames"]);
    assert!(!is_software || again.contains("; stages, 3 of 4 cases (cow-panorama, "), "{again}");
    let page = std::fs::read_to_string(folder(&place).join("index.html")).unwrap();
    let says = ["right: 1 of 72 frames", "Occupancy: not told", "read_only", "glc, all"];
    assert!(says.iter().all(|text| page.contains(text)), "{page}");
    assert!(!is_software || page.contains("<summary>city-cross-slit"), "{page}");

    let mut planted = first.clone();
    planted["frames"][0]["wrong"] = json!(3);
    std::fs::write(folder(&place).join("report.json"), planted.to_string()).unwrap();
    let ran = place.run(&short);
    assert_one_line(&ran, "wrong pixels");
    assert!(ran.code == 1 && ran.err.contains("the self-test failed: 1 wrong frames"), "{}", ran.err);
    let page = std::fs::read_to_string(folder(&place).join("index.html")).unwrap();
    assert!(page.contains("WRONG: 1 of 72 frames"));

    // of another version nothing is kept
    planted["provenance"]["version"] = json!("0.0.0");
    std::fs::write(folder(&place).join("report.json"), planted.to_string()).unwrap();
    place.works(&short);
    assert_eq!(report(&place)["frames"], first["frames"]);
}
