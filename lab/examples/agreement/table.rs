//! The table of all lines, as JSON for programs and as Markdown for people.

use crate::line::{Errors, Figures, Line, Outcome};
use anamorph::internals::image::write_text;
use anamorph::internals::input::{Error, Result};
use std::path::{Path, PathBuf};

pub struct Table {
    folder: PathBuf,
    pub lines: Vec<Line>,
    /// Meshes and cameras in the table's order.
    order: [Vec<String>; 2],
}

impl Table {
    /// The table that the folder holds; an empty one where it holds none.
    pub fn open(folder: &Path, meshes: Vec<String>, cameras: Vec<String>) -> Result<Table> {
        let path = folder.join("agreement.json");
        let lines = match std::fs::read_to_string(&path) {
            Ok(text) => serde_json::from_str(&text)
                .map_err(|e| Error::input(format!("{}: no table of this program: {e}; remove it", path.display())))?,
            Err(_) => Vec::new(),
        };
        Ok(Table { folder: folder.to_owned(), lines, order: [meshes, cameras] })
    }

    pub fn line(&self, mesh: &str, camera: &str) -> Option<&Line> {
        self.lines.iter().find(|l| l.mesh == mesh && l.camera == camera)
    }

    /// Puts a line in its place, instead of an older one, and writes both files.
    pub fn put(&mut self, line: Line) -> Result<()> {
        self.lines.retain(|l| (&l.mesh, &l.camera) != (&line.mesh, &line.camera));
        self.lines.push(line);
        let place = |names: &[String], name: &String| names.iter().position(|n| n == name).unwrap_or(names.len());
        let [meshes, cameras] = &self.order;
        self.lines.sort_by_key(|l| (place(meshes, &l.mesh), place(cameras, &l.camera)));
        let json = serde_json::to_string_pretty(&self.lines).map_err(|e| Error::work(e.to_string()))?;
        write_text(&self.folder.join("agreement.json"), &(json + "\n"))?;
        write_text(&self.folder.join("agreement.md"), &self.markdown())
    }

    fn markdown(&self) -> String {
        let mut text = String::from(HEAD);
        let wrong = self.lines.iter().filter(|l| !l.is_right()).count();
        text += &format!("{} frames, {wrong} of them wrong.\n\n", self.lines.len());
        let mut by: Vec<&str> = self.lines.iter().map(|l| l.by.as_str()).collect();
        by.sort_unstable();
        by.dedup();
        by.iter().for_each(|by| text += &format!("* {by}\n"));
        for lines in self.lines.chunk_by(|a, b| a.mesh == b.mesh) {
            text += &format!("\n## {}\n\n{COLUMNS}", title(lines));
            lines.iter().for_each(|line| text += &row(line));
        }
        text
    }
}

const HEAD: &str = "# Every camera against the f64 reference

Each mesh is moved into the ball of radius 1 about the origin. A pixel is safe where the reference's answer holds all over
1/16 px about its centre. `wrong`: safe pixels with another triangle than the reference's; `not near`: pixels that name no
candidate near by; `piece`: pixels with another piece than their own. All three must be 0. t is relative to max(|t|,
extent / |D|). `frame` is the median of the timed frames: all channels and the picture, no read-back.

";

const COLUMNS: &str =
    "| camera | wrong | not near | piece | unsafe % | t p99 | t max | covered % | pieces | passes used | frame ms |
|---|---:|---:|---:|---:|---:|---:|---:|---:|---|---:|
";

fn title(lines: &[Line]) -> String {
    let triangles = lines.iter().find_map(|l| match &l.outcome {
        Outcome::Frame(f) => Some(f.triangles),
        Outcome::Error(_) => None,
    });
    let mesh = lines.first().map_or("", |l| l.mesh.as_str());
    triangles.map_or(mesh.to_owned(), |n| format!("{mesh}, {n} triangles"))
}

fn row(line: &Line) -> String {
    match &line.outcome {
        Outcome::Error(e) => format!("| {} | **error**: {} ||||||||||\n", line.camera, e.replace('|', "\\|")),
        Outcome::Frame(f) => figures(&line.camera, f),
    }
}

fn figures(camera: &str, f: &Figures) -> String {
    let error = |of: fn(&Errors) -> Option<f64>| match &f.t {
        Some(errors) => of(errors).map_or("inf".to_owned(), |e| format!("{e:.0e}")),
        None => "-".to_owned(),
    };
    let counts =
        [f.wrong_safe, f.not_near, f.wrong_piece].map(|n| if n == 0 { "0".into() } else { format!("**{n}**") });
    format!(
        "| {camera} | {} | {:.3} | {} | {} | {:.1} | {} | {} | {:.1} |\n",
        counts.join(" | "),
        100.0 * f.unsafe_share,
        error(|e| e.p99),
        error(|e| e.max),
        100.0 * f.coverage,
        f.pieces,
        f.passes_used(),
        f.median_ms()
    )
}
