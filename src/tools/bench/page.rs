//! Pages over runs; they need nothing but the pictures beside them.

use super::plot::Drawn;
use super::table::{HEADS, REACH_HEADS, STIFF_HEADS, WORK_HEADS, about, cells, families, reach, stiff, work};
use super::{Run, operations};

const STYLE: &str = "
:root { color-scheme: light dark; }
body { font: 15px/1.45 system-ui, sans-serif; margin: 2rem auto; max-width: 62rem; padding: 0 1rem; }
table { border-collapse: collapse; margin: .6rem 0 1.2rem; font-size: 13px; }
td, th { border-bottom: 1px solid color-mix(in srgb, currentColor 25%, transparent); padding: .2rem .7rem .2rem 0; text-align: left; }
svg { max-width: 100%; height: auto; }
.note { opacity: .8; }
.closeups { display: grid; grid-template-columns: 1fr 1fr; gap: .6rem; }
figure { margin: 0; }
figure img { width: 100%; image-rendering: pixelated; }
figcaption { font-size: 13px; }
nav a { margin-right: 1rem; }
@media (prefers-color-scheme: dark) { svg { filter: invert(1) hue-rotate(180deg); } }
";

/// All runs, one after the other.
pub fn page(runs: &[(String, Run, Vec<Drawn>)]) -> String {
    let mut text = "<nav>".to_owned();
    for (k, (_, run, _)) in runs.iter().enumerate() {
        let p = &run.provenance;
        text +=
            &format!("<a href=\"#run{k}\">{} {} {}</a> ", escaped(&p.date), escaped(&run.suite), escaped(&p.adapter));
    }
    text += "</nav>\n";
    for (k, (folder, run, plots)) in runs.iter().enumerate() {
        text += &section(k, run, plots);
        text += &closeups(folder, run);
        text += "</section>\n";
    }
    document("Error and run time", &text)
}

/// A whole page. Light and dark as the reader's system is; no script.
pub fn document(heading: &str, body: &str) -> String {
    format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" \
         content=\"width=device-width\">\n<link rel=\"icon\" href=\"data:,\">\n<title>anamorph: {heading}</title>\n\
         <style>{STYLE}</style>\n</head>\n<body>\n<h1>{heading}</h1>\n{body}</body>\n</html>\n"
    )
}

/// A run without its closing tag: closeups may follow.
pub fn section(k: usize, run: &Run, plots: &[Drawn]) -> String {
    let p = &run.provenance;
    let commit = p.commit.as_deref().unwrap_or("unknown");
    let mut text = format!(
        "<section id=\"run{k}\">\n<h2>{}{}</h2>\n<p><code>{}</code>, {}, version {} ({}), {} {}, {} cores.</p>\n<p class=\"note\">{}</p>\n",
        escaped(&run.suite),
        if p.quick { " (quick)" } else { "" },
        escaped(&p.command),
        escaped(&p.date),
        escaped(&p.version),
        escaped(commit),
        escaped(&p.adapter),
        escaped(&p.driver),
        p.cores,
        p.fairness()
    );
    let drawn_of = |case: &str| plots.iter().find(|(_, title, _)| title == case);
    if families(&run.rows).next().is_some() {
        text += "<h3>How far</h3>\n";
        text += &table(&REACH_HEADS, families(&run.rows).filter_map(|(_, rows)| reach(rows)));
    }
    for (stiffness, rows) in families(&run.rows) {
        text += &format!("<h3>{}</h3>\n", escaped(&stiffness.family));
        text += &format!("<p class=\"note\">stiffness: {}</p>\n", escaped(&stiffness.parameter));
        let own = plots.iter().filter(|(_, title, _)| title.starts_with(&format!("{}: error", stiffness.family)));
        own.for_each(|(_, _, svg)| text += svg);
        text += &table(&STIFF_HEADS, rows.iter().filter_map(stiff));
    }
    if families(&run.rows).next().is_some() {
        return text;
    }
    if !run.operations.is_empty() {
        text += &format!("<h3>Operations</h3>\n<p class=\"note\">{}</p>\n", escaped(operations::ABOUT));
        text += &table(&operations::HEADS, run.operations.iter().map(operations::cells));
    }
    let cases: Vec<_> = run.rows.chunk_by(|a, b| a.case == b.case).collect();
    // plots over several cases come first
    for (_, title, svg) in plots.iter().filter(|(_, title, _)| !cases.iter().any(|c| c[0].case == *title)) {
        text += &format!("<h3>{}</h3>\n{svg}\n", escaped(title));
    }
    for rows in cases {
        text += &format!("<h3>{}</h3>\n<p class=\"note\">{}</p>\n", escaped(&rows[0].case), escaped(&about(&rows[0])));
        text += &table(&HEADS, rows.iter().map(cells));
        if rows.iter().any(|row| row.counted.is_some() || row.drawn.is_some()) {
            text += &table(&WORK_HEADS, rows.iter().filter_map(work));
        }
        if let Some((_, _, svg)) = drawn_of(&rows[0].case) {
            text += svg;
        }
    }
    text
}

/// Pictures of both techniques side by side.
fn closeups(folder: &str, run: &Run) -> String {
    let picture = |p: &super::closeups::Picture| {
        let (folder, file, label) = (escaped(folder), escaped(&p.file), escaped(&p.label));
        format!(
            "<figure><img src=\"{folder}/{file}\" alt=\"{label}\"><figcaption>{label}: {:.1} dB</figcaption></figure>\n",
            p.psnr
        )
    };
    let drawn = |c: &super::closeups::Drawn| {
        let pictures: String = c.pictures.iter().map(picture).collect();
        format!("<h3>{}</h3>\n<div class=\"closeups\">\n{pictures}</div>\n", escaped(&c.name))
    };
    run.closeups.iter().map(drawn).collect()
}

pub fn table<const N: usize>(heads: &[&str; N], rows: impl Iterator<Item = [String; N]>) -> String {
    let line = |tag: &str, cells: &[&str]| {
        let cells: String = cells.iter().map(|cell| format!("<{tag}>{}</{tag}>", escaped(cell))).collect();
        format!("<tr>{cells}</tr>\n")
    };
    let body: String = rows.map(|row| line("td", &row.each_ref().map(String::as_str))).collect();
    format!("<table>\n{}{body}</table>\n", line("th", heads))
}

pub fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
