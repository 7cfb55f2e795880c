//! Which charts a suite's rows make.

use super::bars::bars;
use super::chart::{Chart, Point, Series};
use super::row::Row;
use super::suites::Plot;
use super::table::families;
use super::verdict::is_in_parts;

/// File name, title, and the SVG for a page.
pub type Drawn = (String, String, String);

const TIME: &str = "ms a frame";
const WRONG: &str = "share of wrong pixels";

/// The charts of a suite's rows, of so many px.
pub fn plots(rows: &[Row], plot: Plot, size: [f64; 2]) -> Vec<Drawn> {
    match plot {
        Plot::Error | Plot::Colour => {
            rows.chunk_by(|a, b| a.case == b.case).filter_map(|c| of_case(c, plot, size)).collect()
        }
        Plot::Scaling => parameters(rows).iter().filter_map(|parameter| of_parameter(rows, parameter, size)).collect(),
        Plot::Stiffness => stiffness(rows, size),
        Plot::Stages => vec![("stages.svg".into(), "time of each stage".into(), bars(rows, size[0], stages))],
        Plot::Calls => vec![("calls.svg".into(), "time of each part of a call".into(), bars(rows, size[0], parts))],
    }
}

fn stages(row: &Row) -> &[(String, f64)] {
    &row.stages
}

fn parts(row: &Row) -> &[(String, f64)] {
    row.calls.as_ref().map_or(&[], |calls| &calls.parts)
}

/// Error against time.
fn of_case(case: &[Row], plot: Plot, size: [f64; 2]) -> Option<Drawn> {
    // frames of several samples have no wrong triangles to count; a program beside them, and what is asked for as much, has no color
    let of_colours = case.iter().filter_map(|row| row.error.as_ref()).any(super::row::Error::is_of_colours);
    let plot = if of_colours { Plot::Colour } else { plot };
    let error = if plot == Plot::Error { wrong_share } else { rms };
    let series = by_technique(case, |row| at_time(row, error(row)?));
    let title = &case[0].case;
    let (axis, none) = match plot {
        Plot::Error => (WRONG, Some(none_wrong(&case[0]))),
        _ => ("error of colours, root mean square", None),
    };
    let chart = Chart { series: &series, axes: [TIME, axis], is_time_up: false, none, size };
    (!series.is_empty()).then(|| (file_name(title), title.clone(), chart.svg()))
}

/// Time against what is swept.
fn of_parameter(rows: &[Row], parameter: &String, size: [f64; 2]) -> Option<Drawn> {
    let own: Vec<Row> = rows.iter().filter(|r| parameter_of(r) == Some(parameter)).cloned().collect();
    let point = |row: &Row| {
        let times = row.times.as_ref()?;
        Some(Point { x: row.parameter.as_ref()?.1, y: times.median, interval: times.interval, number: None })
    };
    let series = by_technique(&own, point);
    let title = format!("time by {parameter}");
    let chart = Chart { series: &series, axes: [parameter, TIME], is_time_up: true, none: None, size };
    (!series.is_empty()).then(|| (file_name(&title), title, chart.svg()))
}

/// A point of a row at its time.
fn at_time(row: &Row, y: f64) -> Option<Point> {
    let times = row.times.as_ref()?;
    Some(Point { x: times.median, y, interval: times.interval, number: row.parameter.as_ref().map(|p| p.1) })
}

/// The error of colours, root mean square of full scale; `None` where they are the same.
pub fn rms(row: &Row) -> Option<f64> {
    Some(10f64.powf(row.error.as_ref()?.psnr? / -20.0))
}

/// Of each family the share of wrong pixels against its number, and against the time.
fn stiffness(rows: &[Row], size: [f64; 2]) -> Vec<Drawn> {
    let mut drawn = Vec::new();
    for (stiffness, rows) in families(rows) {
        let values = || rows.iter().filter_map(|r| r.stiffness.as_ref()).map(|s| s.value).filter(|v| *v > 0.0);
        // 0 is drawn as a tenth of the least
        let least = 0.1 * values().fold(f64::INFINITY, f64::min);
        let at_number = |row: &Row| {
            let x = row.stiffness.as_ref()?.value.max(least);
            Some(Point { x, y: wrong_share(row)?, interval: None, number: None })
        };
        let by_number = by_technique(rows, at_number);
        let by_time = by_technique(rows, |row| at_time(row, wrong_share(row)?));
        let axes = [[stiffness.parameter.as_str(), WRONG], [TIME, WRONG]];
        for ((series, axes), against) in [by_number, by_time].iter().zip(axes).zip(["stiffness", "time"]) {
            if !series.is_empty() {
                let title = format!("{}: error against {against}", stiffness.family);
                let chart = Chart { series, axes, is_time_up: false, none: rows.first().map(none_wrong), size };
                drawn.push((file_name(&title), title, chart.svg()));
            }
        }
    }
    drawn
}

/// None wrong is drawn as half a pixel.
fn none_wrong(row: &Row) -> f64 {
    0.5 / (f64::from(row.width) * f64::from(row.height))
}

fn wrong_share(row: &Row) -> Option<f64> {
    Some(row.error.as_ref()?.wrong_share.max(none_wrong(row)))
}

/// The names of swept parameters.
fn parameters(rows: &[Row]) -> Vec<String> {
    let mut names: Vec<String> = rows.iter().filter_map(parameter_of).cloned().collect();
    names.sort();
    names.dedup();
    names
}

fn parameter_of(row: &Row) -> Option<&String> {
    row.parameter.as_ref().map(|k| &k.0)
}

/// Growth of the time with a swept parameter.
pub struct Growth {
    pub parameter: String,
    /// Exponents by technique: slopes of the time over the larger half of the numbers, both logarithmic.
    pub exponents: Vec<(String, f64)>,
}

pub fn growths(rows: &[Row]) -> Vec<Growth> {
    let of = |parameter: String| {
        let own: Vec<Row> = rows.iter().filter(|r| parameter_of(r) == Some(&parameter)).cloned().collect();
        let point = |row: &Row| {
            Some(Point { x: row.parameter.as_ref()?.1, y: row.times.as_ref()?.median, interval: None, number: None })
        };
        let points = |s: &Series| s.points.iter().map(|p| (p.x, p.y)).collect::<Vec<_>>();
        let fits = by_technique(&own, point).into_iter().filter_map(|s| slope(&points(&s)).map(|k| (s.name, k)));
        Growth { parameter, exponents: fits.collect() }
    };
    let swept =
        |parameter: &String| rows.iter().filter(|r| r.is_ours() && parameter_of(r) == Some(parameter)).count() > 2;
    parameters(rows).into_iter().filter(swept).map(of).filter(|g| !g.exponents.is_empty()).collect()
}

/// Least squares; of three points at least.
fn slope(points: &[(f64, f64)]) -> Option<f64> {
    let larger = &points[points.len() / 2..];
    let used = if larger.len() >= 3 { larger } else { points };
    if used.len() < 3 {
        return None;
    }
    let n = used.len() as f64;
    let logs: Vec<(f64, f64)> = used.iter().map(|(x, y)| (x.ln(), y.ln())).collect();
    let mean = logs.iter().fold((0.0, 0.0), |m, p| (m.0 + p.0 / n, m.1 + p.1 / n));
    let (across, along) = logs.iter().fold((0.0, 0.0), |s, p| {
        let (dx, dy) = (p.0 - mean.0, p.1 - mean.1);
        (s.0 + dx * dy, s.1 + dx * dx)
    });
    (along > 0.0).then(|| across / along)
}

/// Techniques in order of their first row, this engine first; one with several parameters is several series.
fn by_technique(rows: &[Row], point: impl Fn(&Row) -> Option<Point>) -> Vec<Series> {
    let mut all: Vec<Series> = Vec::new();
    for row in rows {
        let Some(point) = point(row).filter(|p| p.x > 0.0 && p.y > 0.0) else { continue };
        let name = match parameter_of(row) {
            Some(parameter) if rows.iter().any(|r| r.name() == row.name() && parameter_of(r) != Some(parameter)) => {
                format!("{}: {parameter}", row.name())
            }
            _ => row.name(),
        };
        match all.iter_mut().find(|s| s.name == name) {
            Some(series) => series.points.push(point),
            None => all.push(Series {
                technique: row.technique.clone(),
                is_variation: row.label.is_some() || row.is_ours() && is_in_parts(row),
                name,
                points: vec![point],
            }),
        }
    }
    all
}

pub fn file_name(title: &str) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '-' };
    let mut name: String = title.chars().map(plain).collect();
    while name.contains("--") {
        name = name.replace("--", "-");
    }
    format!("{}.svg", name.trim_matches('-'))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slopes_are_exponents() {
        let points: Vec<(f64, f64)> = (0..7).map(|k| 10f64.powi(k)).map(|x| (x, 3.0 * x.powf(0.5))).collect();
        assert!((slope(&points).unwrap() - 0.5).abs() < 1e-12);
        // what is constant at first does not count
        let bent: Vec<(f64, f64)> = (0..8).map(|k| 10f64.powi(k)).map(|x| (x, x.max(1e4))).collect();
        assert!((slope(&bent).unwrap() - 1.0).abs() < 1e-12);
        assert_eq!(slope(&points[..2]), None);
    }

    #[test]
    fn names_of_files_are_plain() {
        assert_eq!(file_name("Yu 10 (a): 126 GLCs"), "yu-10-a-126-glcs.svg");
    }
}
