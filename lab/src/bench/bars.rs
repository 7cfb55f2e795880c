//! Bars of stages, as SVG that takes its colours from the page around it.

use super::page::escaped;
use super::row::Row;
use std::fmt::Write;

const BAR: f64 = 14.0;
const GAP: f64 = 4.0;
/// Mean width of a character in the names of rows, rounded up.
const CHARACTER: f64 = 6.2;
/// Space on either side of a name.
const MARGIN: f64 = 6.0;
/// Least length of the longest bar.
const LONGEST_MIN: f64 = 240.0;
/// For the time behind a bar.
const TIME: f64 = 84.0;
/// A line of the key.
const LINE: f64 = 16.0;

/// A bar a row, its stages or other parts beside each other in their order, as long as they take; each as a share of the longest row of its
/// case.
pub fn bars(rows: &[Row], width: f64, parts: fn(&Row) -> &[(String, f64)]) -> String {
    let rows: Vec<&Row> = rows.iter().filter(|r| !parts(r).is_empty()).collect();
    let mut names: Vec<&str> = Vec::new();
    for (name, _) in rows.iter().flat_map(|r| parts(r)) {
        if !names.contains(&name.as_str()) {
            names.push(name);
        }
    }
    let total = |row: &Row| parts(row).iter().map(|s| s.1).sum::<f64>();
    let longest =
        |case: &str| rows.iter().filter(|r| r.case == case).map(|r| total(r)).fold(f64::MIN_POSITIVE, f64::max);
    let name = |row: &Row| {
        let own = if row.is_ours() { row.label.as_ref() } else { Some(&row.technique) };
        own.map_or_else(|| row.case.clone(), |own| format!("{}, {own}", row.case))
    };
    let characters = rows.iter().map(|row| name(row).chars().count()).max().unwrap_or(0);
    let names_width = (characters as f64 * CHARACTER + 2.0 * MARGIN).ceil();
    let width = width.max(names_width + LONGEST_MIN + TIME);
    let per_line = ((width / 90.0) as usize).max(1);
    let key = LINE * names.len().div_ceil(per_line) as f64 + 6.0;
    let height = key + rows.len() as f64 * (BAR + GAP);
    let mut svg = format!("<svg class=\"chart\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" role=\"img\">");
    for (k, name) in names.iter().enumerate() {
        let (x, y) = ((k % per_line) as f64 * 90.0, (k / per_line) as f64 * LINE);
        let _ = write!(
            svg,
            "<rect class=\"s{}\" x=\"{x}\" y=\"{y}\" width=\"10\" height=\"10\"/><text x=\"{}\" y=\"{}\">{name}</text>",
            k % CLASSES,
            x + 14.0,
            y + 9.0
        );
    }
    for (k, row) in rows.iter().enumerate() {
        let y = key + k as f64 * (BAR + GAP);
        let (end, name) = (names_width - MARGIN, name(row));
        let _ = write!(svg, "<text class=\"e\" x=\"{end:.0}\" y=\"{:.0}\">{}</text>", y + 11.0, escaped(&name));
        let scale = (width - names_width - TIME) / longest(&row.case);
        let mut x = names_width;
        for (stage, ms) in parts(row) {
            let class = names.iter().position(|n| n == stage).unwrap_or(0) % CLASSES;
            let _ = write!(
                svg,
                "<rect class=\"s{class}\" x=\"{x:.1}\" y=\"{y:.0}\" width=\"{:.1}\" height=\"{BAR}\"><title>{stage} {ms:.3} ms</title></rect>",
                ms * scale
            );
            x += ms * scale;
        }
        let _ = write!(svg, "<text x=\"{:.1}\" y=\"{:.0}\">{:.2} ms</text>", x + 5.0, y + 11.0, total(row));
    }
    svg + "</svg>\n"
}

/// Colours of stages.
const CLASSES: usize = 14;
const COLOURS: [&str; CLASSES] = [
    "#4477aa", "#cc6677", "#228833", "#ccbb44", "#66ccee", "#aa3377", "#999933", "#bbbbbb", "#ee7733", "#117733",
    "#882255", "#44aa99", "#999999", "#ddaa33",
];

/// Their style sheet.
pub fn style() -> String {
    COLOURS.iter().enumerate().map(|(k, colour)| format!(".s{k}{{fill:{colour}}}")).collect()
}
