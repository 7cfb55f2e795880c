//! Rows as raw.csv and as summary.md.

use super::page::plot_of;
use super::plot::{Drawn, Growth, growths};
use super::row::{Moving, Row, Stiffness};
use super::suites::Plot;
use super::times::Times;
use super::{Run, call_table, operations};
use anamorph::internals::input::{Error, Result};

const COLUMNS: [&str; 68] = [
    "suite",
    "commit",
    "case",
    "technique",
    "label",
    "parameter",
    "value",
    "triangles",
    "pieces",
    "width",
    "height",
    "moving",
    "family",
    "stiffness",
    "of",
    "call_median_ms",
    "call_low_ms",
    "call_high_ms",
    "call_slowest_ms",
    "call_first_ms",
    "call_each_ms",
    "call_to_frame",
    "call_images",
    "call_parts_ms",
    "call_peak_bytes",
    "median_ms",
    "interval_low_ms",
    "interval_high_ms",
    "runs",
    "each_ms",
    "control_ms",
    "to_ours",
    "to_ours_low",
    "to_ours_high",
    "passes",
    "bytes",
    "pairs_tested",
    "pairs_kept",
    "fragments_tested",
    "fragments_kept",
    "rechecked",
    "triangles_drawn",
    "triangles_left",
    "fragments_drawn",
    "covered",
    "overdraw",
    "row_step",
    "wrong_share",
    "wrong_hit_miss",
    "wrong_safe",
    "wrong_not_near",
    "t_median",
    "t_p999",
    "t_max",
    "z_median",
    "z_p999",
    "z_max",
    "certified_by_f32",
    "certified_by_recheck",
    "certified_wrong",
    "psnr_db",
    "stages_ms",
    "refused",
    "paper",
    "figure",
    "paper_fps",
    "paper_fps_no_cull",
    "paper_hardware",
];

/// What times are.
pub const ABOUT_TIMES: &str = "A call lasts from a scene and a camera in memory, nothing of them on the device but compiled kernels, to arrays in \
     memory: the median of three, or one of over 3 s; the suite calls times changes of a scene that stays on the device. Times of frames are medians of frames that ran in turn with those of all other techniques. A frame lasts from the first submission until the \
     results are complete on the device. Of an outside program (Embree) it is the tracing time that the program reports. What is built once \
     over a scene that stands still is not in it: a hierarchy of boxes, of this engine where it traces and of the rivals that do; the suite \
     dynamic has it in the time. Intervals hold the median with 95 % probability, whatever the distribution. A ratio is the median over \
     rounds in which both ran. (?): an end of the interval is more than 5 % from the median after all rounds. What takes over 10 s a frame \
     ran once, and has no interval.";

/// Explanation of the times of a run.
pub fn about_times(run: &Run) -> &'static str {
    if plot_of(run) == Plot::Calls { call_table::ABOUT_CALLS } else { ABOUT_TIMES }
}

/// Every row, every value. Stages are name=ms, and the times of frames ms, separated by semicolons.
pub fn csv(rows: &[Row]) -> Result<String> {
    let failed = |e: &dyn std::fmt::Display| Error::work(format!("raw.csv: {e}"));
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(COLUMNS).map_err(|e| failed(&e))?;
    for row in rows {
        writer.write_record(record(row)).map_err(|e| failed(&e))?;
    }
    let bytes = writer.into_inner().map_err(|e| failed(&e))?;
    String::from_utf8(bytes).map_err(|e| failed(&e))
}

fn record(row: &Row) -> [String; 68] {
    fn or_empty<T: ToString>(value: Option<T>) -> String {
        value.map_or(String::new(), |v| v.to_string())
    }
    let (parameter, times) = (row.parameter.as_ref(), row.times.as_ref());
    let (counted, drawn) = (row.counted.as_ref(), row.drawn.as_ref());
    let (error, paper, stiffness) = (row.error.as_ref(), row.paper.as_ref(), row.stiffness.as_ref());
    let z = error.and_then(|e| e.z);
    let named =
        |list: &[(String, f64)]| list.iter().map(|(name, ms)| format!("{name}={ms:.4}")).collect::<Vec<_>>().join(";");
    let calls = row.calls.as_ref();
    let call_interval = calls.and_then(|c| c.times.interval);
    [
        row.suite.clone(),
        or_empty(row.commit.as_ref()),
        row.case.clone(),
        row.technique.clone(),
        or_empty(row.label.as_ref()),
        or_empty(parameter.map(|k| &k.0)),
        or_empty(parameter.map(|k| k.1)),
        row.triangles.to_string(),
        row.pieces.to_string(),
        row.width.to_string(),
        row.height.to_string(),
        row.moving.name().to_owned(),
        or_empty(stiffness.map(|s| &s.family)),
        or_empty(stiffness.map(|s| s.value)),
        or_empty(stiffness.map(|s| &s.parameter)),
        or_empty(calls.map(|c| c.times.median)),
        or_empty(call_interval.map(|i| i[0])),
        or_empty(call_interval.map(|i| i[1])),
        or_empty(calls.map(|c| c.times.slowest())),
        or_empty(calls.and_then(|c| c.first_ms)),
        or_empty(calls.map(|c| each_ms(&c.times))),
        or_empty(calls.and_then(|c| c.to_frame).map(|r| r.median)),
        or_empty(calls.map(|c| c.images)),
        or_empty(calls.map(|c| named(&c.parts))),
        or_empty(calls.and_then(|c| c.peak_bytes)),
        or_empty(times.map(|t| t.median)),
        or_empty(times.and_then(|t| t.interval).map(|i| i[0])),
        or_empty(times.and_then(|t| t.interval).map(|i| i[1])),
        or_empty(times.map(|t| t.runs)),
        or_empty(times.map(each_ms)),
        row.control_ms.to_string(),
        or_empty(row.to_ours.map(|r| r.median)),
        or_empty(row.to_ours.and_then(|r| r.interval).map(|i| i[0])),
        or_empty(row.to_ours.and_then(|r| r.interval).map(|i| i[1])),
        row.passes.to_string(),
        row.bytes.to_string(),
        or_empty(counted.map(|c| c.pairs_tested)),
        or_empty(counted.map(|c| c.pairs_kept)),
        or_empty(counted.map(|c| c.fragments_tested)),
        or_empty(counted.map(|c| c.fragments_kept)),
        or_empty(counted.map(|c| c.rechecked)),
        or_empty(drawn.map(|d| d.triangles_drawn)),
        or_empty(drawn.map(|d| d.triangles_left)),
        or_empty(drawn.map(|d| d.fragments)),
        or_empty(counted.map(|c| c.covered).or(drawn.map(|d| d.covered))),
        or_empty(counted.map(|c| c.overdraw()).or(drawn.map(|d| d.overdraw()))),
        or_empty(error.map(|e| e.row_step)),
        or_empty(error.map(|e| e.wrong_share)),
        or_empty(error.map(|e| e.wrong_hit_miss)),
        or_empty(error.map(|e| e.wrong_safe)),
        or_empty(error.and_then(|e| e.wrong_not_near)),
        or_empty(error.and_then(|e| e.t_median)),
        or_empty(error.and_then(|e| e.t_p999)),
        or_empty(error.and_then(|e| e.t_max)),
        or_empty(z.map(|z| z[0])),
        or_empty(z.map(|z| z[1])),
        or_empty(z.map(|z| z[2])),
        or_empty(row.certified.as_ref().map(|c| c.by_f32)),
        or_empty(row.certified.as_ref().map(|c| c.by_recheck)),
        or_empty(row.certified.as_ref().map(|c| c.wrong)),
        or_empty(error.and_then(|e| e.psnr)),
        named(&row.stages),
        or_empty(row.refused.as_ref()),
        or_empty(paper.map(|p| &p.paper)),
        or_empty(paper.map(|p| &p.figure)),
        or_empty(paper.and_then(|p| p.fps)),
        or_empty(paper.and_then(|p| p.fps_no_cull)),
        or_empty(paper.map(|p| &p.hardware)),
    ]
}

/// Times in the order of the frames.
fn each_ms(times: &Times) -> String {
    let each: Vec<String> = times.each.iter().map(|ms| format!("{ms:.4}")).collect();
    each.join(";")
}

/// An interval behind its median.
fn between(interval: Option<[f64; 2]>) -> String {
    interval.map_or(String::new(), |[lo, hi]| format!(" [{lo:.2}, {hi:.2}]"))
}

/// A median with its interval.
pub fn time_cell(times: &Times) -> String {
    let wide = if times.is_wide() { " (?)" } else { "" };
    format!("{:.2}{}{wide}", times.median, between(times.interval))
}

/// The words of a row that people read.
pub fn cells(row: &Row) -> [String; 10] {
    let time = row.times.as_ref().map(time_cell);
    let error = row.error.as_ref();
    let ids = error.filter(|e| !e.is_of_colours());
    let psnr = |e: &super::row::Error| match e.psnr {
        Some(psnr) => format!("{psnr:.1}"),
        None if e.identical => "identical".to_owned(),
        None => String::new(),
    };
    [
        row.label(),
        row.found_by().to_owned(),
        row.calls.as_ref().map(|calls| time_cell(&calls.times)).unwrap_or_default(),
        time.or_else(|| row.refused.clone()).unwrap_or_default(),
        row.times.as_ref().map(|t| t.runs.to_string()).unwrap_or_default(),
        row.to_ours.map(|r| format!("{:.2}{}", r.median, between(r.interval))).unwrap_or_default(),
        ids.map(|e| format!("{:.4}", 100.0 * e.wrong_share)).unwrap_or_default(),
        ids.map(|e| e.wrong_safe.to_string()).unwrap_or_default(),
        error.and_then(|e| e.t_p999).map(|t| format!("{t:.1e}")).unwrap_or_default(),
        error.map(psnr).unwrap_or_default(),
    ]
}

pub const HEADS: [&str; 10] = [
    "technique",
    "found by",
    "ms a call [95 %]",
    "ms a frame [95 %]",
    "frames",
    "to ours [95 %]",
    "wrong %",
    "wrong safe px",
    "t error p99.9",
    "PSNR dB",
];

/// The rows of each family of stiff scenes, with the first one's stiffness.
pub fn families(rows: &[Row]) -> impl Iterator<Item = (&Stiffness, &[Row])> {
    let family = |row: &Row| row.stiffness.as_ref().map(|s| s.family.clone());
    rows.chunk_by(move |a, b| family(a) == family(b)).filter_map(|rows| Some((rows[0].stiffness.as_ref()?, rows)))
}

/// Largest stiffness of a family up to which this engine is right in every pixel, in every safe pixel, and certifies 99 %; and up to which
/// f32 alone, and the best rival, are right in every safe pixel.
pub fn reach(rows: &[Row]) -> Option<[String; 7]> {
    let parameter = rows.first()?.stiffness.as_ref()?;
    let value = |row: &Row| row.stiffness.as_ref().map_or(f64::NAN, |s| s.value);
    let mut values: Vec<f64> = rows.iter().map(value).collect();
    values.dedup();
    // how many of the values in a row
    let count = |of: &dyn Fn(&Row) -> bool, right: fn(&Row) -> bool| {
        values.iter().take_while(|v| rows.iter().any(|row| of(row) && value(row) == **v && right(row))).count()
    };
    let every = |row: &Row| row.error.as_ref().is_some_and(|e| e.wrong_share == 0.0);
    let safe = |row: &Row| row.error.as_ref().is_some_and(|e| e.wrong_safe == 0);
    let proven = |row: &Row| row.certified.as_ref().is_some_and(|c| c.by_f32 + c.by_recheck >= 0.99);
    let to = |count: usize| count.checked_sub(1).map_or("-".to_owned(), |last| format!("{:e}", values[last]));
    let ours = |row: &Row| row.is_ours() && row.label.is_none();
    let by_f32 = |row: &Row| row.is_ours() && row.label.as_deref() == Some("f32 alone");
    let rivals = rows.iter().filter(|r| !r.is_ours()).map(|r| r.technique.as_str());
    let best = rivals.map(|name| count(&|row| row.technique == name, safe)).max();
    Some([
        parameter.family.clone(),
        format!("{}: {:e} to {:e}", parameter.parameter, values.first()?, values.last()?),
        to(count(&ours, every)),
        to(count(&ours, safe)),
        to(count(&ours, proven)),
        to(count(&by_f32, safe)),
        best.map_or(String::new(), to),
    ])
}

pub const REACH_HEADS: [&str; 7] = [
    "family",
    "stiffness",
    "every pixel right to",
    "every safe pixel right to",
    "99 % proven to",
    "f32 alone: every safe pixel right to",
    "best rival: every safe pixel right to",
];

/// What a row of a stiff scene is asked; `None` of other scenes.
pub fn stiff(row: &Row) -> Option<[String; 9]> {
    let stiffness = row.stiffness.as_ref()?;
    let error = row.error.as_ref();
    let errors = |of: [Option<f64>; 3]| of.map(|e| e.map_or("-".to_owned(), |e| format!("{e:.0e}"))).join(", ");
    let wrong = |e: &super::row::Error| {
        let all = (e.wrong_share * f64::from(row.width) * f64::from(row.height.div_ceil(e.row_step))).round();
        format!("{} safe, {} far, {all} in all", e.wrong_safe, e.wrong_not_near.unwrap_or(0))
    };
    let certified = |c: &super::row::Certified| {
        let [by_f32, by_recheck] = [c.by_f32, c.by_recheck].map(|share| 100.0 * share);
        format!(
            "{by_f32:.2} by f32, {by_recheck:.2} by recheck, {:.2} not; {} wrong",
            (100.0 - by_f32 - by_recheck).max(0.0),
            c.wrong
        )
    };
    let recheck_ms = row.stages.iter().find(|s| s.0 == "recheck").map(|s| format!("{:.3}", s.1));
    Some([
        format!("{:e}", stiffness.value),
        row.label(),
        cells(row)[3].clone(),
        error.map(wrong).unwrap_or_default(),
        error.map(|e| errors([e.t_median, e.t_p999, e.t_max])).unwrap_or_default(),
        error.map(|e| errors([0, 1, 2].map(|k| e.z.map(|z| z[k])))).unwrap_or_default(),
        row.certified.as_ref().map(certified).unwrap_or_default(),
        row.counted.as_ref().map(|c| c.rechecked.to_string()).unwrap_or_default(),
        recheck_ms.unwrap_or_default(),
    ])
}

pub const STIFF_HEADS: [&str; 9] = [
    "stiffness",
    "technique",
    "ms a frame [95 %]",
    "wrong px",
    "t error: median, p99.9, max",
    "Z error",
    "certified %",
    "rechecked",
    "recheck, ms",
];

/// What a row's frames take beside time; `None` where it was not counted.
pub fn work(row: &Row) -> Option<[String; 8]> {
    let counts = match (&row.counted, &row.drawn) {
        (Some(c), _) => [
            format!("{} of {}", c.pairs_kept, c.pairs_tested),
            format!("{} of {}", c.fragments_kept, c.fragments_tested),
            format!("{:.2}", c.overdraw()),
            c.rechecked.to_string(),
        ],
        (None, Some(d)) => {
            let replicas = d.triangles_drawn as f64 / row.triangles.max(1) as f64;
            [
                format!(
                    "{} of {} triangles, {replicas:.2} a triangle of the scene",
                    d.triangles_left, d.triangles_drawn
                ),
                format!("{} drawn", d.fragments),
                format!("{:.2}", d.overdraw()),
                String::new(),
            ]
        }
        (None, None) => return None,
    };
    let stages: Vec<String> = row.stages.iter().map(|(name, ms)| format!("{name} {ms:.2}")).collect();
    let [pairs, fragments, overdraw, rechecked] = counts;
    let mebibytes = format!("{:.1}", row.bytes as f64 / f64::from(1 << 20));
    Some([row.label(), stages.join(", "), row.passes.to_string(), mebibytes, pairs, fragments, overdraw, rechecked])
}

pub const WORK_HEADS: [&str; 8] = [
    "technique",
    "stages, median ms",
    "passes",
    "MiB",
    "pairs kept, or triangles drawn",
    "fragments kept, or drawn",
    "overdraw",
    "rechecked",
];

pub fn markdown(run: &Run, plots: &[Drawn]) -> String {
    let p = &run.provenance;
    let commit = p.commit.as_deref().unwrap_or("unknown");
    let mut text = format!(
        "# {}\n\n`{}`, {}, version {} ({commit}), {} {}, {} cores.\n\n{}\n\n{} Errors are against the f64 reference.\n",
        run.suite,
        p.command,
        p.date,
        p.version,
        p.adapter,
        p.driver,
        p.cores,
        p.fairness(),
        about_times(run)
    );
    let swept = if plot_of(run) == Plot::Scaling { growths(&run.rows) } else { Vec::new() };
    for Growth { parameter, exponents } in swept {
        let exponents: Vec<String> = exponents.iter().map(|(t, slope)| format!("{slope:.2} ({t})")).collect();
        text += &format!("\nTime grows as {parameter} to the power of {}.\n", exponents.join(", "));
    }
    let reached: Vec<[String; 7]> = families(&run.rows).filter_map(|(_, rows)| reach(rows)).collect();
    if !reached.is_empty() {
        text += &format!("\n## How far\n\n| {} |\n|{}\n", REACH_HEADS.join(" | "), "---|".repeat(REACH_HEADS.len()));
        reached.iter().for_each(|cells| text += &format!("| {} |\n", cells.join(" | ")));
    }
    let calls: Vec<[String; 11]> = run.rows.iter().filter_map(call_table::cells).collect();
    if plot_of(run) == Plot::Calls {
        text += &format!("\n## Calls\n\n| {} |\n|", call_table::HEADS.join(" | "));
        text += &format!("{}\n", "---|".repeat(call_table::HEADS.len()));
        calls.iter().for_each(|cells| text += &format!("| {} |\n", cells.join(" | ")));
    }
    for (stiffness, rows) in families(&run.rows) {
        text += &format!("\n## {}\n\nStiffness: {}.\n", stiffness.family, stiffness.parameter);
        text += &format!("\n| {} |\n|{}\n", STIFF_HEADS.join(" | "), "---|".repeat(STIFF_HEADS.len()));
        rows.iter().filter_map(stiff).for_each(|cells| text += &format!("| {} |\n", cells.join(" | ")));
    }
    for rows in run.rows.chunk_by(|a, b| a.case == b.case).filter(|rows| rows[0].stiffness.is_none()) {
        text += &format!("\n## {}\n\n{}\n", rows[0].case, about(&rows[0]));
        text += &format!("\n| {} |\n|{}\n", HEADS.join(" | "), "---|".repeat(HEADS.len()));
        rows.iter().for_each(|row| text += &format!("| {} |\n", cells(row).join(" | ")));
        let parts: Vec<[String; 3]> = rows.iter().filter_map(call_table::part_cells).collect();
        if !parts.is_empty() {
            let heads = call_table::PART_HEADS;
            text += &format!("\n| {} |\n|{}\n", heads.join(" | "), "---|".repeat(heads.len()));
            parts.iter().for_each(|cells| text += &format!("| {} |\n", cells.join(" | ")));
        }
        let work: Vec<[String; 8]> = rows.iter().filter_map(work).collect();
        if !work.is_empty() {
            text += &format!("\n| {} |\n|{}\n", WORK_HEADS.join(" | "), "---|".repeat(WORK_HEADS.len()));
            work.iter().for_each(|cells| text += &format!("| {} |\n", cells.join(" | ")));
        }
    }
    if !run.operations.is_empty() {
        let heads = operations::HEADS;
        text += &format!("\n## Operations\n\n{}\n", operations::ABOUT);
        text += &format!("\n| {} |\n|{}\n", heads.join(" | "), "---|".repeat(heads.len()));
        run.operations.iter().for_each(|of| text += &format!("| {} |\n", operations::cells(of).join(" | ")));
    }
    for (name, title, _) in plots {
        text += &format!("\n![{title}]({name})\n");
    }
    text
}

/// A case in a line.
pub fn about(row: &Row) -> String {
    let moving = match row.moving {
        Moving::Nothing => "",
        Moving::Objects => ", objects at new places in each frame, and the camera",
        Moving::Triangles if row.calls.as_ref().is_some_and(|c| c.first_ms.is_some()) => {
            ", every vertex new in each frame, and the camera"
        }
        Moving::Triangles => ", every vertex new in each frame",
        Moving::Camera => ", the camera new in each frame",
    };
    let mut text = format!(
        "{} triangles, {} x {} pixels{moving}; an empty kernel: {:.2} ms.",
        row.triangles, row.width, row.height, row.control_ms
    );
    if let Some(step) = row.error.as_ref().map(|e| e.row_step).filter(|step| *step > 1) {
        text += &format!(" Compared with the reference: one row in {step}.");
    }
    if let Some(p) = &row.paper {
        let fps = p.fps.map_or("prints no time".to_owned(), |fps| {
            let no_cull = p.fps_no_cull.map(|fps| format!(", {fps} without culling,")).unwrap_or_default();
            format!("prints {fps} frames a second ({:.1} ms){no_cull} on {}", 1e3 / fps, p.hardware)
        });
        text += &format!(" {}, figure {} {fps}. Here: {}.", p.paper, p.figure, p.stand_in);
    }
    text
}
