//! `anamorph bench` as a user runs it: a quick suite, its files, and the page in a browser. Nothing to do without an adapter.

#[path = "../../tests/common/needs.rs"]
mod needs;

use anamorph::internals::gpu::device::adapters;
use anamorph_lab::bench::Run;
use anamorph_lab::bench::row::Row;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn bench(arguments: &[&str], out: &Path) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_anamorph-lab"));
    command.arg("bench").args(arguments).arg("--out").arg(out).output().unwrap()
}

fn text(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

#[test]
fn a_quick_run_leaves_every_file_and_a_page_over_all_runs() {
    if adapters().is_empty() {
        return needs::no_adapter();
    }
    let out = tempfile::tempdir().unwrap();
    let yardstick = yardstick(out.path());
    let done = bench(&["stages", "--quick", "--runs", "1", "--yardstick", &yardstick], out.path());
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let said = String::from_utf8(done.stdout).unwrap();
    let folder =
        said.lines().find_map(|l| l.trim().strip_prefix("-> ")).map(PathBuf::from).expect("the folder is named");
    assert!(folder.file_name().unwrap().to_string_lossy().ends_with("-stages-quick"));

    let results = text(&folder.join("results.json"));
    let run: Run = serde_json::from_str(&results).unwrap();
    // a line for the run, then one for each row
    assert!(results.lines().count() == 1 + run.rows.len(), "{results}");
    assert!(run.rows.len() >= 3 && run.rows.iter().all(|r| r.refused.is_none()), "{run:?}");
    assert!(run.rows.iter().all(|r| r.calls.is_some() == r.is_ours()), "{run:?}");
    let (ours, others): (Vec<&Row>, Vec<&Row>) = run.rows.iter().partition(|r| r.is_ours());
    // it says 1.5 ms, and sees triangle 0 everywhere
    assert!(!others.is_empty());
    for row in others {
        assert_eq!((row.technique.as_str(), row.times.as_ref().map(|t| t.median)), ("yardstick", Some(1.5)));
        assert!(row.error.as_ref().unwrap().wrong_share > 0.9, "{row:?}");
        // it is compared with this engine's time for as much
        let bare = ours.iter().find(|r| r.case == row.case && r.label.as_deref() == Some("t and ids alone"));
        let median = bare.and_then(|r| r.times.as_ref()).map(|t| t.median);
        assert_eq!(row.to_ours.map(|r| r.median), median.map(|m| 1.5 / m), "{row:?}");
    }
    for row in ours {
        if row.label.is_some() {
            assert!(row.counted.is_none() && row.error.as_ref().unwrap().wrong_safe == 0, "{row:?}");
            continue;
        }
        let counted = row.counted.as_ref().unwrap();
        assert!(counted.pairs_kept > 0 && counted.pairs_kept <= counted.pairs_tested, "{row:?}");
        assert!(counted.fragments_kept >= counted.covered && counted.overdraw() >= 1.0, "{row:?}");
        let (times, error) = (row.times.as_ref().unwrap(), row.error.as_ref().unwrap());
        assert!(times.runs == 1 && times.median > 0.0 && row.control_ms > 0.0, "{row:?}");
        assert_eq!(error.wrong_safe, 0, "{row:?}");
        assert_eq!(row.to_ours.map(|r| r.median), Some(1.0));
    }
    let mut csv = csv::Reader::from_path(folder.join("raw.csv")).unwrap();
    let heads = csv.headers().unwrap().clone();
    let median = heads.iter().position(|h| h == "median_ms").unwrap();
    let medians: Vec<f64> = csv.records().map(|r| r.unwrap()[median].parse().unwrap()).collect();
    assert!(medians.into_iter().eq(run.rows.iter().map(|r| r.times.as_ref().unwrap().median)));
    let summary = text(&folder.join("summary.md"));
    assert!(run.rows.iter().all(|r| summary.contains(&r.case)) && summary.contains(run.provenance.fairness()));
    assert!(text(&folder.join("stages.svg")).starts_with("<svg"));

    let page = text(&out.path().join("index.html"));
    assert!(page.contains("<svg") && run.rows.iter().all(|r| page.contains(&r.case)));
    assert!(!page.contains("http://") || page.matches("http://").count() == page.matches("http://www.w3.org/").count());
    open_in_a_browser(&out.path().join("index.html"), &run.rows[0].case);
}

/// A program beside pictures of several samples finds t and ids of one ray per pixel; so does the row that it is compared with.
#[test]
fn a_program_runs_beside_cases_of_several_samples() {
    if adapters().is_empty() {
        return needs::no_adapter();
    }
    let out = tempfile::tempdir().unwrap();
    let yardstick = yardstick(out.path());
    let only = ["--case", "through two slits", "--yardstick", &yardstick];
    let done = bench(&[&["samples", "--quick", "--runs", "1"][..], &only].concat(), out.path());
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let folder = std::fs::read_dir(out.path()).unwrap().map(|e| e.unwrap().path()).find(|p| p.is_dir()).unwrap();
    let run: Run = serde_json::from_str(&text(&folder.join("results.json"))).unwrap();
    assert!(run.rows.iter().all(|row| row.refused.is_none() && row.times.is_some()), "{run:?}");
    let row = |test: &dyn Fn(&Row) -> bool| run.rows.iter().find(|row| test(row)).unwrap();
    let program = row(&|row| !row.is_ours());
    let bare = row(&|row| row.label.as_deref() == Some("t and ids alone"));
    assert_eq!(program.parameter, Some(("samples".to_owned(), 1.0)));
    assert_eq!(program.parameter, bare.parameter);
    // the program sees triangle 0 everywhere
    assert!(program.error.as_ref().unwrap().wrong_share > 0.9, "{program:?}");
    let error = bare.error.as_ref().unwrap();
    assert!(error.wrong_safe == 0 && error.t_median.is_some() && error.psnr.is_none(), "{bare:?}");
    assert_eq!(program.to_ours.map(|r| r.median), bare.times.as_ref().map(|t| 1.5 / t.median));
    let plain = row(&|row| row.is_ours() && row.label.is_none());
    assert!(plain.error.as_ref().unwrap().psnr.is_some(), "{plain:?}");
}

/// A second start keeps the rows that are there.
#[test]
fn whole_calls_are_timed_and_a_second_start_goes_on() {
    if adapters().is_empty() {
        return needs::no_adapter();
    }
    let out = tempfile::tempdir().unwrap();
    let yardstick = yardstick(out.path());
    let run = |case: &str| {
        let only = ["--resume", "--case", case, "--yardstick", &yardstick];
        let done = bench(&[&["calls", "--quick"][..], &only].concat(), out.path());
        assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
        let folder = std::fs::read_dir(out.path()).unwrap().map(|e| e.unwrap().path()).find(|p| p.is_dir()).unwrap();
        let run: Run = serde_json::from_str(&text(&folder.join("results.json"))).unwrap();
        assert!(run.rows.iter().all(|row| row.refused.is_none()), "{run:?}");
        (run, text(&folder.join("summary.md")))
    };
    let (first, summary) = run("objects move");
    let [ours, program] = &first.rows[..] else { panic!("{first:?}") };
    assert!(ours.is_ours() && ours.triangles == 100_000 && summary.contains(&ours.case), "{ours:?}");
    let (calls, frames) = (ours.calls.as_ref().unwrap(), ours.times.as_ref().unwrap());
    assert_eq!((calls.times.runs, frames.runs), (8, 8));
    // a frame is a part of its call, and the parts are all of it
    assert!(calls.times.each.iter().zip(&frames.each).all(|(call, frame)| call > frame && *frame > 0.0), "{calls:?}");
    let parts: Vec<&str> = calls.parts.iter().map(|part| part.0.as_str()).collect();
    assert_eq!((parts.first(), parts.last()), (Some(&"change"), Some(&"rest")));
    assert!(["camera", "plan", "upload", "wait"].iter().all(|name| parts.contains(name)), "{parts:?}");
    let error = ours.error.as_ref().unwrap();
    assert!(error.wrong_safe == 0 && error.wrong_hit_miss == 0, "{error:?}");
    // the program says 1.5 ms of tracing and 9 ms of building, which counts where something moves, and sees triangle 0 everywhere
    let of_program = program.calls.as_ref().unwrap();
    assert_eq!((of_program.times.median, program.times.as_ref().unwrap().median), (10.5, 1.5));
    assert!(program.error.as_ref().unwrap().wrong_share > 0.9 && program.to_ours.is_some(), "{program:?}");

    let (both, _) = run("15k");
    assert_eq!(both.rows.len(), 4);
    assert!(first.rows.iter().all(|row| both.rows.contains(row)));
    let many = |name: &str| both.rows.iter().find(|row| row.case.ends_with(name)).unwrap();
    let (views, batch) = (many("16 at once"), many("16 EXRs"));
    for row in [views, batch] {
        let (calls, frames) = (row.calls.as_ref().unwrap(), row.times.as_ref().unwrap());
        assert!(calls.images == 16 && calls.times.median > frames.median && frames.median > 0.0, "{row:?}");
    }
    assert_eq!(views.error.as_ref().unwrap().wrong_safe, 0, "{views:?}");
}

/// A program that is called like the yardstick: its path.
fn yardstick(folder: &Path) -> String {
    let path = folder.join("yardstick");
    let script = "#!/bin/sh\nwhile [ $# -gt 1 ]; do\n  [ \"$1\" = --dump ] && head -c $((160 * 120 * 8)) /dev/zero > \"$2\"\n  \
                  shift\ndone\necho '{\"trace_ms\": {\"median\": 1.5}, \"build_ms\": {\"median\": 9}}'\n";
    std::fs::write(&path, script).unwrap();
    let made = Command::new("chmod").arg("+x").arg(&path).status().unwrap();
    assert!(made.success());
    path.display().to_string()
}

/// The runs that are committed: enough frames of what takes less than 10 s, at least three whole calls, and no technique nearer to the truth than
/// this engine's own exact way.
#[test]
fn no_rival_is_more_accurate_in_the_committed_runs() {
    let results = Path::new(env!("CARGO_MANIFEST_DIR")).join("../bench_results");
    let runs = std::fs::read_dir(results).unwrap().map(|e| e.unwrap().path().join("results.json"));
    let runs: Vec<Run> = runs.filter(|p| p.is_file()).map(|p| serde_json::from_str(&text(&p)).unwrap()).collect();
    for suite in ["papers", "pareto", "glc", "samples", "stages", "dynamic", "stiff"] {
        assert!(runs.iter().any(|r| r.suite == suite && !r.provenance.quick), "{suite}");
    }
    for case in runs.iter().flat_map(|r| r.rows.chunk_by(|a, b| a.case == b.case)) {
        let has_enough = |row: &Row| {
            let least = if row.calls.is_some() { 3 } else { 7 };
            row.times.as_ref().is_none_or(|t| t.runs >= least || t.median > 1e4)
        };
        assert!(case.iter().all(has_enough), "{}", case[0].case);
        let error = |row: &Row| row.error.as_ref().map(|e| e.wrong_share);
        let ours = case.iter().find(|r| r.is_ours()).and_then(error);
        for rival in case {
            let worse = ours.zip(error(rival)).is_some_and(|(ours, theirs)| theirs < ours);
            assert!(!worse, "{}: {}", rival.case, rival.label());
        }
    }
}

/// Opens the page without a window: it says what it has to, and nothing on the console.
fn open_in_a_browser(page: &Path, says: &str) {
    let names = ["chromium", "chromium-browser", "google-chrome"];
    let asked = |name: &&&str| Command::new(name).arg("--version").output().is_ok_and(|o| o.status.success());
    let Some(browser) = names.iter().find(asked) else {
        return needs::skip("no browser; install chromium");
    };
    let profile = tempfile::tempdir().unwrap();
    let opened = Command::new(browser)
        .args(["--headless", "--no-sandbox", "--disable-gpu", "--enable-logging=stderr", "--dump-dom"])
        .arg(format!("--user-data-dir={}", profile.path().display()))
        .arg(format!("file://{}", page.display()))
        .output()
        .unwrap();
    let (dom, log) = (String::from_utf8_lossy(&opened.stdout), String::from_utf8_lossy(&opened.stderr));
    assert!(opened.status.success() && dom.contains(says), "{log}");
    let console: Vec<&str> = log.lines().filter(|l| l.contains("CONSOLE")).collect();
    assert_eq!(console, [""; 0]);
}

#[test]
fn a_suite_that_is_not_there_is_refused_before_anything_is_written() {
    let out = tempfile::tempdir().unwrap();
    let done = bench(&["parto"], out.path());
    let error = String::from_utf8(done.stderr).unwrap();
    assert_eq!(done.status.code(), Some(2));
    assert!(error.lines().count() == 1 && error.contains("papers, pareto, glc, samples, stages, dynamic"), "{error}");
    let done = bench(&["glc", "--quick", "--yardstick", "/nowhere/to/be/found"], out.path());
    let error = String::from_utf8(done.stderr).unwrap();
    assert!(done.status.code() == Some(2) && error.lines().count() == 1 && error.contains("/nowhere"), "{error}");
    assert_eq!(std::fs::read_dir(out.path()).unwrap().count(), 0);
}
