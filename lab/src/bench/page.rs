//! Pages over runs: one over all of them, and one for each. They need nothing but the pictures beside them.

use super::chart::{LARGE, SMALL};
use super::closeups;
use super::plot::{Drawn, file_name, plots};
use super::row::Row;
use super::suites::{Plot, SUITES};
use super::table::{
    ABOUT_TIMES, HEADS, REACH_HEADS, STIFF_HEADS, WORK_HEADS, about, about_times, cells, families, reach, stiff, work,
};
use super::verdict::verdict;
use super::{Run, bars, call_table, marks, operations};

const STYLE: &str = "
:root { color-scheme: light dark; }
body { font: 15px/1.45 system-ui, sans-serif; margin: 2rem auto; max-width: 64rem; padding: 0 1rem; }
table { border-collapse: collapse; margin: .6rem 0 1.2rem; font-size: 13px; display: block; overflow-x: auto; }
td, th { border-bottom: 1px solid color-mix(in srgb, currentColor 25%, transparent); padding: .2rem .7rem .2rem 0; text-align: left; }
.note { opacity: .8; }
.multiples { display: grid; grid-template-columns: repeat(auto-fill, minmax(260px, 1fr)); gap: 1rem; }
figure { margin: 0; }
figure img { width: 100%; image-rendering: pixelated; }
figcaption, .legend { font-size: 13px; }
.legend span { display: inline-block; margin-right: 1rem; }
nav a { margin-right: 1rem; }
details { border-bottom: 1px solid color-mix(in srgb, currentColor 15%, transparent); padding: .3rem 0; }
summary { cursor: pointer; }
.slider { position: relative; max-width: 640px; }
.slider img { display: block; width: 100%; image-rendering: pixelated; }
.slider img + img { position: absolute; inset: 0; clip-path: inset(0 0 0 var(--at, 50%)); }
.slider input { width: 100%; }
";

/// Of charts; also in each file of one.
const CHART_STYLE: &str = "
.chart { max-width: 100%; height: auto; font: 11px system-ui, sans-serif; }
.chart text { fill: currentColor; }
.chart .m { text-anchor: middle; }
.chart .e { text-anchor: end; }
.chart .axes path { stroke: currentColor; fill: none; }
.chart .axes .grid { opacity: .12; }
.chart .axes .none { stroke-dasharray: 3 3; opacity: .5; }
.chart g[class^=t] { stroke: currentColor; fill: currentColor; }
.chart g[class^=t] polyline { fill: none; stroke-width: 1.2; }
.chart g[class^=t] path { stroke-width: 2; opacity: .6; }
.chart g[class^=t] text { stroke: none; font-size: 10px; }
.chart .h { fill: Canvas; stroke-width: 1.5; }
.legend svg { vertical-align: -3px; fill: currentColor; }
";

/// Moves the border between two pictures.
const SLIDER: &str = "<script>for (const s of document.querySelectorAll('.slider input')) \
    s.oninput = () => s.parentElement.style.setProperty('--at', s.value + '%');</script>\n";

fn style() -> String {
    [STYLE, CHART_STYLE, &marks::style(), &bars::style()].concat()
}

/// A chart as a file of its own.
pub fn standalone(svg: &str) -> String {
    let style = [":root { color-scheme: light dark; }", CHART_STYLE, &marks::style(), &bars::style()].concat();
    let opened = svg.replacen("<svg ", "<svg xmlns=\"http://www.w3.org/2000/svg\" ", 1);
    opened.replacen('>', &format!("><style>{style}</style>"), 1)
}

pub fn plot_of(run: &Run) -> Plot {
    SUITES.iter().find(|s| s.name == run.suite).map_or(Plot::Error, |s| s.plot)
}

const ABOUT_PAGES: &str = "The heading of a run leads to its tables, each chart to a larger one. <code>make pages</code> adds two files to the folder \
    of each run: index.html, its tables and charts on one page, and raw.csv, all numbers.";

const ABOUT_VERDICT: [&str; 3] = [
    "Each row of a rival is compared with the fastest frame of this engine of the same case whose error is not larger. Above 1 this engine is faster; \
     times within 5 % are even. A ratio is the median over rounds, in each of which all techniques render one frame.",
    "This engine takes part in its plain form: in one frame, by raster or trace as it chooses itself. Where a rival takes a frame for each sample, so may \
     this engine; beside a program that finds t and ids alone, our frame is asked for no more.",
    "Rivals are built anew here, over the same buffers, and share shading and reading back with this engine. They are not tuned as the papers' authors \
     tuned theirs.",
];

/// Words of the tables, each with what it means.
const WORDS: [(&str, &str); 14] = [
    (
        "raster, trace",
        "this engine's two ways to find the triangle of each pixel: triangle by triangle, or ray by ray through a hierarchy of boxes. By itself \
     it begins with raster, and stops once tracing is rated cheaper",
    ),
    ("wrong pixel", "one that shows another triangle than the f64 reference does for its ray"),
    (
        "safe pixel",
        "one whose answer is the same everywhere within 1/16 px of its centre; elsewhere two answers are right",
    ),
    (
        "GLC",
        "general linear camera: rays through three points of one plane and three of another, and all that lie affinely between (Yu and McMillan 2004)",
    ),
    ("pieces, strips", "parts of the image, each with one GLC, or one perspective view"),
    ("facets", "triangles that a curved mirror or lens is divided into, one GLC each; without them it is exact"),
    (
        "texels of an atlas",
        "each facet is rendered to a triangle of so many texels a side, and looked up (Yu et al., Hou et al.)",
    ),
    ("S of 6 x 6", "splats by 6 x 6 positions a triangle (Yu et al.)"),
    (
        "PPP, IB",
        "piecewise perspective projection, and image-based: Lorenz and Doellner's words for drawing each triangle in each piece that sees it, and for \
     looking rays up in pictures already drawn",
    ),
    ("HQ", "high quality, their word for several samples a pixel"),
    ("a frame a sample", "as many frames as samples, averaged; otherwise one frame has all samples"),
    ("areas", "triangles count by their visible area in the pixel"),
    ("no culling", "nothing is left out early"),
    ("t and ids alone", "no colour"),
];

/// The words, folded, with the pages that say more.
fn words() -> String {
    let all: String =
        WORDS.iter().map(|(word, what)| format!("<dt>{}</dt><dd>{}</dd>", escaped(word), escaped(what))).collect();
    format!(
        "<details id=\"words\"><summary>Words</summary><dl>{all}</dl><p>More: <a href=\"../docs/reference/rivals.md\">rivals and benchmarks</a>, <a \
         href=\"../docs/claims.md\">claims</a>, <a href=\"../docs/glossary.md\">glossary</a>, <a href=\"../docs/method/README.md\">the method</a>.</p></details>\n"
    )
}

/// All runs, each with the name of its folder: a verdict, then each suite in small charts that lead to the large ones, under a heading that
/// leads to the run's tables. No link leads to raw.csv or index.html of a run, which the repository leaves out.
pub fn page(runs: &[(String, Run)]) -> String {
    let about: String = ABOUT_VERDICT.map(|text| format!("<p>{text}</p>\n")).concat();
    let mut text = format!("<h2 id=\"verdict\">Verdict</h2>\n{about}");
    let full = || runs.iter().map(|(_, run)| run).filter(|run| !run.provenance.quick);
    let mut adapters: Vec<&str> = full().map(|run| run.provenance.adapter.as_str()).collect();
    adapters.sort_unstable();
    adapters.dedup();
    for adapter in adapters {
        text += &verdict(adapter, &full().filter(|run| run.provenance.adapter == adapter).collect::<Vec<_>>());
    }
    text += &words();
    text += &marks::legend(runs.iter().flat_map(|(_, run)| &run.rows).map(|row| row.technique.as_str()));
    text += &format!("<p class=\"note\">{ABOUT_TIMES}</p>\n<p class=\"note\">{ABOUT_PAGES}</p>\n<nav>");
    for (folder, run) in runs {
        text += &format!("<a href=\"#{folder}\">{}</a> ", escaped(&name(run)));
    }
    text += "</nav>\n";
    for (folder, run) in runs {
        text += &format!(
            "<section id=\"{folder}\"><h2><a href=\"{folder}/summary.md\">{}</a></h2>\n<p class=\"note\">{}. {}</p>\n<div class=\"multiples\">\n",
            escaped(&name(run)),
            SUITES.iter().find(|s| s.name == run.suite).map_or("", |s| s.asks),
            source(run)
        );
        let plot = plot_of(run);
        if plot == Plot::Stages || plot == Plot::Calls {
            text += "</div><div>";
            if plot == Plot::Calls {
                text += &table(&call_table::HEADS, run.rows.iter().filter_map(call_table::cells));
            }
            text += &plots(&run.rows, plot, LARGE).into_iter().map(|(_, _, svg)| svg).collect::<String>();
        } else {
            for (file, title, svg) in plots(&run.rows, plot, SMALL) {
                text += &format!(
                    "<figure><figcaption><a href=\"{folder}/{file}\">{}</a>{}</figcaption>{svg}</figure>\n",
                    escaped(&title),
                    escaped(&absent(run, &title))
                );
            }
        }
        text += "</div></section>\n";
    }
    document("Error and run time", &text)
}

/// Which rivals a chart of a case does not show; "" where it shows all.
fn absent(run: &Run, case: &str) -> String {
    let own = || run.rows.iter().filter(|row| row.case == case);
    let without_time = own().filter(|row| row.times.is_none() && !row.is_ours());
    let mut refused: Vec<&str> = without_time.map(|row| row.technique.as_str()).collect();
    refused.dedup();
    match own().any(|row| !row.is_ours()) {
        true if refused.is_empty() => String::new(),
        true => format!(" (no time for {}: the table says why)", refused.join(", ")),
        false if own().next().is_some() => " (this engine alone)".to_owned(),
        // over several cases
        false => String::new(),
    }
}

/// Of a run: its suite and adapter.
fn name(run: &Run) -> String {
    let quick = if run.provenance.quick { " (quick)" } else { "" };
    format!("{}{quick}, {}, {}", run.suite, run.provenance.short_adapter(), run.provenance.date)
}

/// Where a run comes from.
fn source(run: &Run) -> String {
    let p = &run.provenance;
    let commit = p.commit.as_deref().unwrap_or("unknown");
    format!(
        "<code>{}</code>, {}, version {} ({}), {} {}, {} cores.",
        escaped(&p.command),
        escaped(&p.date),
        escaped(&p.version),
        escaped(commit),
        escaped(&p.adapter),
        escaped(&p.driver),
        p.cores
    )
}

/// The place of a case on its run's page.
fn anchor(title: &str) -> String {
    file_name(title).trim_end_matches(".svg").to_owned()
}

/// One run, in its own folder.
pub fn run_page(run: &Run, plots: &[Drawn]) -> String {
    let legend = marks::legend(run.rows.iter().map(|row| row.technique.as_str()));
    let text = format!(
        "<nav><a href=\"../index.html\">all runs</a></nav>\n{legend}<p class=\"note\">{}</p>\n{}{}</section>\n",
        escaped(about_times(run)),
        section(0, run, plots),
        closeups_of(run)
    );
    document(&name(run), &text)
}

/// A whole page. Light and dark as the reader's system is.
pub fn document(heading: &str, body: &str) -> String {
    let script = if body.contains("class=\"slider\"") { SLIDER } else { "" };
    let heading = escaped(heading);
    format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" \
         content=\"width=device-width\">\n<link rel=\"icon\" href=\"data:,\">\n<title>anamorph: {heading}</title>\n\
         <style>{}</style>\n</head>\n<body>\n<h1>{heading}</h1>\n{body}{script}</body>\n</html>\n",
        style()
    )
}

/// A run without its closing tag: closeups may follow. The details of each case are folded.
pub fn section(k: usize, run: &Run, plots: &[Drawn]) -> String {
    let mut text = format!(
        "<section id=\"run{k}\">\n<h2>{}</h2>\n<p>{}</p>\n<p class=\"note\">{}</p>\n",
        escaped(&name(run)),
        source(run),
        run.provenance.fairness()
    );
    if families(&run.rows).next().is_some() {
        return text + &stiff_families(run, plots);
    }
    if !run.operations.is_empty() {
        text += &format!("<h3>Operations</h3>\n<p class=\"note\">{}</p>\n", escaped(operations::ABOUT));
        text += &table(&operations::HEADS, run.operations.iter().map(operations::cells));
    }
    if plot_of(run) == Plot::Calls {
        text += "<h3>Calls</h3>\n";
        text += &table(&call_table::HEADS, run.rows.iter().filter_map(call_table::cells));
    }
    let cases: Vec<_> = run.rows.chunk_by(|a, b| a.case == b.case).collect();
    // plots over several cases come first
    for (_, title, svg) in plots.iter().filter(|(_, title, _)| !cases.iter().any(|c| c[0].case == *title)) {
        text += &format!("<h3 id=\"{}\">{}</h3>\n{svg}\n", anchor(title), escaped(title));
    }
    for rows in cases {
        let case = &rows[0].case;
        let svg = plots.iter().find(|(_, title, _)| title == case).map_or("", |(_, _, svg)| svg);
        text += &format!(
            "<details id=\"{}\"><summary>{}{}</summary>\n<p class=\"note\">{}</p>\n{}",
            anchor(case),
            escaped(case.trim()),
            escaped(&best(rows)),
            escaped(&about(&rows[0])),
            table(&HEADS, rows.iter().map(cells))
        );
        if rows.iter().any(|row| call_table::part_cells(row).is_some()) {
            text += &table(&call_table::PART_HEADS, rows.iter().filter_map(call_table::part_cells));
        }
        if rows.iter().any(|row| row.counted.is_some() || row.drawn.is_some()) {
            text += &table(&WORK_HEADS, rows.iter().filter_map(work));
        }
        text += &format!("{svg}</details>\n");
    }
    // a link to a case opens it
    text + "<script>const open = () => { const d = document.getElementById(location.hash.slice(1)); if (d && d.tagName === 'DETAILS') d.open = true; }; \
            addEventListener('hashchange', open); open();</script>\n"
}

/// The time of this engine's first row.
fn best(rows: &[Row]) -> String {
    let Some(ours) = rows.iter().find(|r| r.is_ours()) else { return String::new() };
    let call = ours.calls.as_ref().map(|calls| format!("{:.2} ms a call, ", calls.times.median)).unwrap_or_default();
    ours.times.as_ref().map_or(String::new(), |times| format!(": this engine {call}{:.2} ms a frame", times.median))
}

fn stiff_families(run: &Run, plots: &[Drawn]) -> String {
    let mut text = "<h3>How far</h3>\n".to_owned();
    text += &table(&REACH_HEADS, families(&run.rows).filter_map(|(_, rows)| reach(rows)));
    for (stiffness, rows) in families(&run.rows) {
        text += &format!("<h3>{}</h3>\n", escaped(&stiffness.family));
        text += &format!("<p class=\"note\">stiffness: {}</p>\n", escaped(&stiffness.parameter));
        for (_, title, svg) in
            plots.iter().filter(|(_, title, _)| title.starts_with(&format!("{}: error", stiffness.family)))
        {
            text += &format!("<div id=\"{}\">{svg}</div>\n", anchor(title));
        }
        text += &format!(
            "<details><summary>rows</summary>{}</details>\n",
            table(&STIFF_HEADS, rows.iter().filter_map(stiff))
        );
    }
    text
}

/// Pictures of both techniques, one over the other, with a slider between.
fn closeups_of(run: &Run) -> String {
    let drawn = |c: &closeups::Drawn| {
        let pairs = c.pictures.chunks(2).map(|pair| {
            let images =
                pair.iter().map(|p| format!("<img src=\"{}\" alt=\"{}\">", escaped(&p.file), escaped(&p.label)));
            let labels = pair.iter().map(|p| format!("{}: {:.1} dB", escaped(&p.label), p.psnr));
            format!(
                "<figure><div class=\"slider\">{}<input type=\"range\" min=\"0\" max=\"100\" value=\"50\" \
                 aria-label=\"how much of the left picture is seen\"></div><figcaption>{}</figcaption></figure>\n",
                images.collect::<String>(),
                labels.collect::<Vec<_>>().join(" (left); ")
            )
        });
        format!(
            "<h3 id=\"{}\">{}</h3>\n<div class=\"multiples\">\n{}</div>\n",
            anchor(&c.name),
            escaped(&c.name),
            pairs.collect::<String>()
        )
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
