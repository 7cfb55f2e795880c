//! Plots of rows, as SVG.

use super::row::Row;
use super::suites::Plot;
use super::table::families;
use crate::input::{Error, Result};
use plotters::coord::Shift;
use plotters::prelude::*;
use std::fmt::Display;

/// File name, title, and the SVG.
pub type Drawn = (String, String, String);

const SIZE: (u32, u32) = (960, 460);
const MARGIN: u32 = 12;
/// For the names of the series, right of the plot.
const LEGEND: u32 = 260;
/// Distinct on white, and inverted on black; the first is this engine's.
const COLOURS: [RGBColor; 10] = [
    RGBColor(0, 90, 200),
    RGBColor(210, 80, 0),
    RGBColor(0, 140, 90),
    RGBColor(170, 60, 160),
    RGBColor(130, 110, 0),
    RGBColor(200, 30, 60),
    RGBColor(0, 140, 170),
    RGBColor(110, 70, 40),
    RGBColor(90, 90, 90),
    RGBColor(120, 150, 20),
];

/// Points of one technique.
struct Series {
    name: String,
    points: Vec<(f64, f64)>,
}

pub fn plots(rows: &[Row], plot: Plot) -> Result<Vec<Drawn>> {
    match plot {
        Plot::Error | Plot::Colour => rows
            .chunk_by(|a, b| a.case == b.case)
            .filter_map(|case| {
                let error = if plot == Plot::Error { wrong_share } else { rms };
                let series = by_technique(case, |row| Some((row.times.as_ref()?.median, error(row)?)));
                let title = &case[0].case;
                (!series.is_empty()).then(|| {
                    let (axis, none) = match plot {
                        Plot::Error => ("share of wrong pixels", Some(none_wrong(&case[0]))),
                        _ => ("error of colours, root mean square", None),
                    };
                    Ok((file_name(title), title.clone(), chart(&series, ["ms a frame", axis], none)?))
                })
            })
            .collect(),
        Plot::Scaling => parameters(rows)
            .into_iter()
            .filter_map(|parameter| {
                let own: Vec<Row> = rows.iter().filter(|r| parameter_of(r) == Some(&parameter)).cloned().collect();
                let series = by_technique(&own, |row| Some((row.parameter.as_ref()?.1, row.times.as_ref()?.median)));
                let title = format!("time by {parameter}");
                (!series.is_empty())
                    .then(|| Ok((file_name(&title), title, chart(&series, [&parameter, "ms a frame"], None)?)))
            })
            .collect(),
        Plot::Stiffness => stiffness(rows),
        Plot::Stages => Ok(vec![("stages.svg".into(), "time of each stage".into(), bars(rows)?)]),
    }
}

/// The error of colours, root mean square of full scale; `None` where they are the same.
fn rms(row: &Row) -> Option<f64> {
    Some(10f64.powf(row.error.as_ref()?.psnr? / -20.0))
}

/// Of each family the share of wrong pixels against its number, and against the time.
fn stiffness(rows: &[Row]) -> Result<Vec<Drawn>> {
    const WRONG: &str = "share of wrong pixels";
    let mut drawn = Vec::new();
    for (stiffness, rows) in families(rows) {
        let values = || rows.iter().filter_map(|r| r.stiffness.as_ref()).map(|s| s.value).filter(|v| *v > 0.0);
        // 0 is drawn as a tenth of the least
        let least = 0.1 * values().fold(f64::INFINITY, f64::min);
        let by_number = by_technique(rows, |row| Some((row.stiffness.as_ref()?.value.max(least), wrong_share(row)?)));
        let by_time = by_technique(rows, |row| Some((row.times.as_ref()?.median, wrong_share(row)?)));
        let axes = [[stiffness.parameter.as_str(), WRONG], ["ms a frame", WRONG]];
        for ((series, axes), against) in [by_number, by_time].iter().zip(axes).zip(["stiffness", "time"]) {
            if !series.is_empty() {
                let title = format!("{}: error against {against}", stiffness.family);
                let svg = chart(series, axes, rows.first().map(none_wrong))?;
                drawn.push((file_name(&title), title, svg));
            }
        }
    }
    Ok(drawn)
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
        let series = by_technique(&own, |row| Some((row.parameter.as_ref()?.1, row.times.as_ref()?.median)));
        let fits = series.into_iter().filter_map(|s| slope(&s.points).map(|k| (s.name, k)));
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
fn by_technique(rows: &[Row], point: impl Fn(&Row) -> Option<(f64, f64)>) -> Vec<Series> {
    let mut all: Vec<Series> = Vec::new();
    for row in rows {
        let Some(point) = point(row).filter(|p| p.0 > 0.0 && p.1 > 0.0) else { continue };
        let name = match parameter_of(row) {
            Some(parameter) if rows.iter().any(|r| r.name() == row.name() && parameter_of(r) != Some(parameter)) => {
                format!("{}: {parameter}", row.name())
            }
            _ => row.name(),
        };
        match all.iter_mut().find(|s| s.name == name) {
            Some(series) => series.points.push(point),
            None => all.push(Series { name, points: vec![point] }),
        }
    }
    all
}

fn file_name(title: &str) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '-' };
    let mut name: String = title.chars().map(plain).collect();
    while name.contains("--") {
        name = name.replace("--", "-");
    }
    format!("{}.svg", name.trim_matches('-'))
}

/// Names in their colours, right of the plot.
fn legend<'a>(root: &DrawingArea<SVGBackend, Shift>, names: impl Iterator<Item = &'a str>) -> Result<()> {
    const LINE: i32 = 18;
    const MARK: i32 = 16;
    let left = (SIZE.0 - LEGEND) as i32 + 10;
    for (k, name) in names.enumerate() {
        let (y, colour) = (MARGIN as i32 + LINE * (k as i32 + 1), COLOURS[k % COLOURS.len()]);
        root.draw(&PathElement::new([(left, y), (left + MARK, y)], colour.stroke_width(4))).map_err(failed)?;
        root.draw(&Text::new(name, (left + MARK + 6, y - 5), ("sans-serif", 12))).map_err(failed)?;
    }
    Ok(())
}

fn failed(e: impl Display) -> Error {
    Error::work(format!("plot: {e}"))
}

/// To four digits, in short.
fn number(v: &f64) -> String {
    let rounded = format!("{v:.3e}").parse().unwrap_or(*v);
    if (0.01..100_000.0).contains(&rounded) { format!("{rounded}") } else { format!("{rounded:.0e}") }
}

/// Both axes logarithmic. `none` is the height at which a value of 0 is drawn.
fn chart(series: &[Series], [x_name, y_name]: [&str; 2], none: Option<f64>) -> Result<String> {
    let range = |of: fn(&(f64, f64)) -> f64| {
        let all = series.iter().flat_map(|s| &s.points).map(of);
        let (lo, hi) = all.fold((f64::INFINITY, 0.0f64), |(lo, hi), v| (lo.min(v), hi.max(v)));
        (lo / 1.5)..(hi * 1.5)
    };
    let mut svg = String::new();
    {
        let root = SVGBackend::with_string(&mut svg, SIZE).into_drawing_area();
        let mut chart = ChartBuilder::on(&root)
            .margin(MARGIN)
            .margin_right(LEGEND)
            .x_label_area_size(44)
            .y_label_area_size(72)
            .build_cartesian_2d(range(|p| p.0).log_scale(), range(|p| p.1).log_scale())
            .map_err(failed)?;
        chart
            .configure_mesh()
            .light_line_style(TRANSPARENT)
            .x_desc(x_name)
            .y_desc(y_name)
            .x_label_formatter(&number)
            .y_label_formatter(&number)
            .draw()
            .map_err(failed)?;
        let x = range(|p| p.0);
        if let Some(none) = none.filter(|y| range(|p| p.1).contains(y)) {
            let (left, y) = chart.backend_coord(&(x.start, none));
            root.draw(&Text::new("none", (left - 36, y - 6), ("sans-serif", 10))).map_err(failed)?;
            let line = [(x.start, none), (x.end, none)];
            chart.draw_series(DashedLineSeries::new(line, 4, 4, BLACK.mix(0.4).into())).map_err(failed)?;
        }
        for (k, s) in series.iter().enumerate() {
            // what lies below others shows beside them
            let (colour, wider) = (COLOURS[k % COLOURS.len()], 2 * (series.len() - 1 - k) as u32);
            let line = LineSeries::new(s.points.iter().copied(), colour.stroke_width(2 + wider));
            chart.draw_series(line).map_err(failed)?;
            chart.draw_series(s.points.iter().map(|p| Circle::new(*p, 3 + wider, colour.filled()))).map_err(failed)?;
        }
        legend(&root, series.iter().map(|s| s.name.as_str()))?;
        root.present().map_err(failed)?;
    }
    Ok(svg)
}

/// A bar a row, its stages stacked.
fn bars(rows: &[Row]) -> Result<String> {
    let rows: Vec<&Row> = rows.iter().filter(|r| !r.stages.is_empty()).collect();
    let mut names: Vec<&str> = rows.iter().flat_map(|r| &r.stages).map(|s| s.0.as_str()).collect();
    let mut seen = Vec::new();
    names.retain(|n| {
        !seen.contains(n) && {
            seen.push(*n);
            true
        }
    });
    let total = |row: &&Row| row.stages.iter().map(|s| s.1).sum::<f64>();
    let most = rows.iter().map(total).fold(1e-9, f64::max);
    let count = rows.len() as i32;
    let mut svg = String::new();
    {
        let root = SVGBackend::with_string(&mut svg, SIZE).into_drawing_area();
        let mut chart = ChartBuilder::on(&root)
            .margin(MARGIN)
            .margin_right(LEGEND)
            .x_label_area_size(44)
            .y_label_area_size(210)
            .build_cartesian_2d(0.0..most * 1.05, (0..count).into_segmented())
            .map_err(failed)?;
        let row_name = |at: &SegmentValue<i32>| match at {
            SegmentValue::CenterOf(k) => {
                let own =
                    |r: &&Row| r.label.as_ref().map_or_else(|| r.case.clone(), |label| format!("{}, {label}", r.case));
                rows.get((count - 1 - k) as usize).map_or(String::new(), own)
            }
            _ => String::new(),
        };
        chart
            .configure_mesh()
            .light_line_style(TRANSPARENT)
            .disable_y_mesh()
            .x_desc("ms on the device")
            .y_labels(rows.len())
            .y_label_formatter(&row_name)
            .draw()
            .map_err(failed)?;
        for (k, name) in names.iter().enumerate() {
            let colour = COLOURS[k % COLOURS.len()];
            let bar = |(at, row): (usize, &&Row)| {
                let place = row.stages.iter().position(|s| s.0 == *name)?;
                let from: f64 = row.stages[..place].iter().map(|s| s.1).sum();
                let y = count - 1 - at as i32;
                let corners =
                    [(from, SegmentValue::Exact(y)), (from + row.stages[place].1, SegmentValue::Exact(y + 1))];
                let mut bar = Rectangle::new(corners, colour.mix(0.8).filled());
                bar.set_margin(3, 3, 0, 0);
                Some(bar)
            };
            chart.draw_series(rows.iter().enumerate().filter_map(bar)).map_err(failed)?;
        }
        legend(&root, names.iter().copied())?;
        root.present().map_err(failed)?;
    }
    Ok(svg)
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
    fn numbers_are_short() {
        let shown = [0.099_999_999_999_999_98, 1e-12, 0.3, 1024.0, 1e6].map(|v| number(&v));
        assert_eq!(shown, ["0.1", "1e-12", "0.3", "1024", "1e6"]);
    }

    #[test]
    fn names_of_files_are_plain() {
        assert_eq!(file_name("Yu 10 (a): 126 GLCs"), "yu-10-a-126-glcs.svg");
    }
}
