//! Whole calls of a run in one table.

use super::row::Row;
use super::table::time_cell;

/// Explanation of the times of calls.
pub const ABOUT_CALLS: &str = "A call lasts from the change (keys of a camera, matrices of objects, vertices) to t, Z and ids in the \
     caller's memory, through the public interface of one renderer; its frame is the part from the submission until the results are complete on the \
     device. Times are medians over the poses of a path, half along a street of the city and half around it, with intervals that hold the median with \
     95 % probability. The parts of a call are told by the product; wait holds the frame. The first call, which compiles the kernels and uploads the scene, is apart. Slower cases take fewer of the 100 poses. An outside \
     program (Embree) gets the pieces of the camera, which are computed outside its time; its call is its tracing, and also its building where \
     something moves, of the whole city as it first stands. Wrong pixels are counted against the reference at a few poses.";

pub const HEADS: [&str; 11] = [
    "case",
    "technique",
    "ms a call [95 %]",
    "slowest call",
    "first call",
    "ms a frame [95 %]",
    "slowest frame",
    "call / frame",
    "images a second",
    "peak MiB",
    "wrong safe px",
];

/// A row in words; `None` of a row without calls.
pub fn cells(row: &Row) -> Option<[String; 11]> {
    let calls = row.calls.as_ref()?;
    let frames = row.times.as_ref();
    Some([
        row.case.clone(),
        row.label(),
        time_cell(&calls.times),
        format!("{:.1}", calls.times.slowest()),
        calls.first_ms.map(|ms| format!("{ms:.0}")).unwrap_or_default(),
        frames.map(time_cell).unwrap_or_default(),
        frames.map(|times| format!("{:.1}", times.slowest())).unwrap_or_default(),
        calls.to_frame.map(|ratio| format!("{:.2}", ratio.median)).unwrap_or_default(),
        format!("{:.1}", calls.images_a_second()),
        calls.peak_bytes.map(|bytes| (bytes >> 20).to_string()).unwrap_or_default(),
        row.error.as_ref().map(|e| e.wrong_safe.to_string()).unwrap_or_default(),
    ])
}

pub const PART_HEADS: [&str; 3] = ["technique", "parts of a call, median ms", "stages of its frame, median ms"];

/// The parts of a row's call; `None` of a row without any.
pub fn part_cells(row: &Row) -> Option<[String; 3]> {
    let parts = row.calls.as_ref().map(|calls| &calls.parts).filter(|parts| !parts.is_empty())?;
    let list =
        |all: &[(String, f64)]| all.iter().map(|(name, ms)| format!("{name} {ms:.2}")).collect::<Vec<_>>().join(", ");
    Some([row.label(), list(parts), list(&row.stages)])
}
