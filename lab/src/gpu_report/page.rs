//! The report as one page.

use super::self_test::{Tested, result};
use super::{Report, not_run};
use crate::bench::Ongoing;
use crate::bench::page::{document, escaped, table};
use anamorph::internals::image::write_text;
use anamorph::internals::input::Result;
use std::path::{Path, PathBuf};

/// Writes report.json and the page to the report's folder; returns the page's path.
pub fn write(folder: &Path, report: &Report, suites: &[Ongoing]) -> Result<PathBuf> {
    report.write(folder)?;
    let path = folder.join("index.html");
    write_text(&path, &page(report, suites))?;
    Ok(path)
}

fn page(report: &Report, suites: &[Ongoing]) -> String {
    let p = &report.provenance;
    let mut text = format!(
        "<p>anamorph {}, {}, {} cores.</p>\n<h2>Adapter</h2>\n<pre>{}</pre>\n{}",
        escaped(&p.version),
        escaped(&p.date),
        p.cores,
        escaped(&report.adapter),
        paragraph(&[&subgroups(report.subgroup_widths), "Occupancy: not told; wgpu has no way to ask this driver."])
    );
    text += &self_test(&report.frames);
    text += &bandwidths(report);
    let left = not_run(report, suites);
    text += "<h2>Not run</h2>\n";
    text += &match left.is_empty() {
        true => paragraph(&["Nothing: all was run."]),
        false => paragraph(&["The time was up. The same command with the same --out goes on with:"]) + &list(&left),
    };
    for (k, suite) in suites.iter().enumerate() {
        text += &suite.section(k).unwrap_or_default();
    }
    document(&format!("Report on {}", p.adapter), &text)
}

fn subgroups(widths: Option<[u32; 2]>) -> String {
    match widths {
        None => "Kernels use no subgroups on this adapter.".into(),
        Some([least, most]) if least == most => format!("A kernel of 64 threads ran in subgroups of {least} threads."),
        Some([least, most]) => format!("A kernel of 64 threads ran in subgroups of {least} to {most} threads."),
    }
}

fn self_test(frames: &[Tested]) -> String {
    let result = result(frames);
    let meaning = "Each frame is compared with the f64 reference. Uncertain: the answer changes within 1/16 px of the pixel's \
                   centre. Wrong: the pixel shows a triangle that is neither the reference's nor, if uncertain, near. PSNR is low in \
                   scenes with patterns or lines, which the kernels filter and the reference does not.";
    let mut kernels: Vec<&str> = frames.iter().map(|f| f.kernels.as_str()).filter(|k| !k.is_empty()).collect();
    kernels.sort_unstable();
    kernels.dedup();
    let of_kernels = kernels.into_iter().map(|k| {
        let own: Vec<&Tested> = frames.iter().filter(|f| f.kernels == k).collect();
        let wrong: u64 = own.iter().map(|f| f.wrong).sum();
        [k.to_owned(), own.len().to_string(), wrong.to_string()]
    });
    let of_frame = |f: &Tested| {
        let t = f.t_p999.map_or(String::new(), |t| format!("{t:.0e}"));
        let psnr = f.psnr.map_or(String::new(), |psnr| format!("{psnr:.1}"));
        let size = format!("{} x {}", f.size[0], f.size[1]);
        let failed = f.failed.clone().unwrap_or_default();
        let wrong = f.wrong.to_string();
        [f.scene.clone(), size, wrong, f.uncertain.to_string(), f.other.to_string(), t, psnr, failed]
    };
    let heads =
        ["scene", "pixels", "wrong", "uncertain", "of these another", "t error p99.9", "PSNR dB", "failed because"];
    format!(
        "<h2>Self-test</h2>\n{}{}{}",
        paragraph(&[&result, meaning]),
        table(&["kernels that ran", "frames", "wrong px"], of_kernels),
        table(&heads, frames.iter().map(of_frame))
    )
}

fn bandwidths(report: &Report) -> String {
    let all = match &report.bandwidths {
        Ok(all) => all,
        Err(e) => return format!("<h2>Bandwidth</h2>\n{}", paragraph(&[e])),
    };
    let rows = all.iter().map(|b| {
        let (mib, ms) = (b.bytes as f64 / f64::from(1 << 20), format!("{:.3}", b.ms));
        [b.kernel.clone(), b.counted.clone(), format!("{mib:.0}"), ms, format!("{:.1}", b.gb_a_second())]
    });
    let about = "read_only and write_only are control kernels that do nothing else. Of shade and write only the bytes are \
                 counted that they must read and write; stages are measured on adapters with timestamps.";
    let heads = ["kernel", "counted", "MiB", "ms", "GB/s"];
    format!("<h2>Bandwidth</h2>\n{}{}", paragraph(&[about]), table(&heads, rows))
}

fn paragraph(lines: &[&str]) -> String {
    lines.iter().map(|line| format!("<p>{}</p>\n", escaped(line))).collect()
}

fn list(items: &[String]) -> String {
    let items: String = items.iter().map(|item| format!("<li>{}</li>\n", escaped(item))).collect();
    format!("<ul>\n{items}</ul>\n")
}
