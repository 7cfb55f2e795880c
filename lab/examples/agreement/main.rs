//! `make agreement MODELS=FOLDER`: compares every camera with the f64 reference, on a city of 35,000 triangles and on real
//! models, and writes what it finds to agreement.md and agreement.json, a line a frame. Fails where a line is wrong.

mod line;
mod scenes;
#[path = "../common/sheet.rs"]
mod sheet;
mod table;
mod views;

use anamorph::internals::engine::Engine;
use anamorph::internals::gpu::Gpu;
use anamorph::internals::gpu::device::NO_ADAPTER;
use anamorph::internals::image::write_png;
use anamorph::internals::input::{Error, Result};
use clap::Parser;
use line::{Line, Outcome};
use scenes::Subject;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};
use table::Table;
use views::View;

/// Compares every camera with the f64 reference
#[derive(Parser)]
struct Args {
    /// Where the table goes, and the scenes; a table that is there is gone on with
    folder: PathBuf,
    /// The folder of the models; without it the city alone
    models: Option<PathBuf>,
    /// Only these meshes
    #[arg(long, value_delimiter = ',')]
    meshes: Vec<String>,
    /// Only these cameras
    #[arg(long, value_delimiter = ',')]
    cameras: Vec<String>,
    /// None of these cameras
    #[arg(long, value_delimiter = ',')]
    without: Vec<String>,
    /// Leaves lines that are there and right as they are
    #[arg(long)]
    resume: bool,
    /// Writes every picture to FOLDER/scenes, and a contact sheet for each mesh
    #[arg(long)]
    pictures: bool,
}

fn main() -> ExitCode {
    match run(&Args::parse()) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(e) => {
            eprintln!("error: {e}");
            ExitCode::from(e.exit_code())
        }
    }
}

/// Whether all lines of this run are right.
fn run(args: &Args) -> Result<bool> {
    let (subjects, views) = (scenes::subjects(args.models.as_deref()), views::views()?);
    let meshes: Vec<String> = subjects.iter().map(|s| s.name.to_owned()).collect();
    let cameras: Vec<String> = views.iter().map(|v| v.name.clone()).collect();
    known(&args.meshes, &meshes)?;
    known(&args.cameras, &cameras)?;
    known(&args.without, &cameras)?;
    let folder = args.folder.join("scenes");
    std::fs::create_dir_all(&folder).map_err(|e| Error::work(format!("{}: {e}", folder.display())))?;
    views::write_camera_files(&folder)?;
    let mut table = Table::open(&args.folder, meshes, cameras)?;
    let engine = Engine::new(Gpu::open(&Default::default())?.ok_or_else(|| Error::work(NO_ADAPTER))?);
    let by = provenance(&engine);
    let mut bench = Bench { engine, folder, by };
    let mut right = true;
    for subject in subjects.iter().filter(|s| args.meshes.is_empty() || args.meshes.iter().any(|m| m == s.name)) {
        if let Some(file) = subject.file.as_ref().filter(|f| !f.is_file()) {
            println!("{:<10} skipped: {} is not there", subject.name, file.display());
            continue;
        }
        let is_asked = |v: &&View| args.cameras.is_empty() || args.cameras.contains(&v.name);
        let asked = views.iter().filter(is_asked).filter(|v| !args.without.contains(&v.name));
        let is_left = |v: &&View| !args.resume || !table.line(subject.name, &v.name).is_some_and(Line::is_right);
        let left: Vec<&View> = asked.filter(is_left).collect();
        right &= bench.compare(subject, &left, &mut table, args.pictures)?;
        if args.pictures {
            bench.write_sheet(subject, &views)?;
        }
    }
    Ok(right)
}

fn known(asked: &[String], names: &[String]) -> Result<()> {
    match asked.iter().find(|a| !names.contains(a)) {
        Some(name) => Err(Error::input(format!("there is no {name}; use some of {}", names.join(", ")))),
        None => Ok(()),
    }
}

/// What renders, and where the scenes lie.
struct Bench {
    engine: Engine,
    folder: PathBuf,
    by: String,
}

impl Bench {
    /// Compares a mesh with the reference through some cameras; whether all of it is right.
    fn compare(&mut self, subject: &Subject, views: &[&View], table: &mut Table, pictures: bool) -> Result<bool> {
        let mesh = subject.placed()?;
        let mut right = true;
        for view in views {
            let scene = view.scene(&self.folder, subject.name, &mesh)?;
            let outcome = match line::measure(&mut self.engine, &scene) {
                Ok((figures, rgba)) => {
                    let [width, height] = figures.size;
                    if pictures {
                        write_png(&scene.with_extension("png"), width, height, &rgba)?;
                    }
                    Outcome::Frame(Box::new(figures))
                }
                Err(e) => Outcome::Error(e.to_string()),
            };
            let names = (subject.name.to_owned(), view.name.clone());
            let line = Line { mesh: names.0, camera: names.1, by: self.by.clone(), outcome };
            println!("{line}");
            right &= line.is_right();
            table.put(line)?;
        }
        Ok(right)
    }

    /// Writes the contact sheet of a mesh: all its pictures that are there.
    fn write_sheet(&self, subject: &Subject, views: &[View]) -> Result<()> {
        let picture = |view: &View| image::open(view.path(&self.folder, subject.name, "png")).ok();
        let small = |of: image::DynamicImage| sheet::small(&of.into_rgb8());
        let all: Vec<_> = views.iter().filter_map(|v| Some((v.name.as_str(), small(picture(v)?)))).collect();
        let sheet = sheet::sheet(&all, SHEET_COLUMNS);
        let path = self.folder.with_file_name(format!("{}.png", subject.name));
        write_png(&path, sheet.width(), sheet.height(), &sheet)
    }
}

const SHEET_COLUMNS: u32 = 7;

/// The commit and the adapter, for a person to read.
fn provenance(engine: &Engine) -> String {
    let source = Path::new(env!("CARGO_MANIFEST_DIR"));
    let git = Command::new("git").arg("-C").arg(source).args(["describe", "--always", "--dirty"]).output();
    let commit = git.ok().filter(|o| o.status.success()).map(|o| String::from_utf8_lossy(&o.stdout).trim().to_owned());
    let info = &engine.gpu.info;
    let commit = commit.unwrap_or_else(|| format!("version {}", env!("CARGO_PKG_VERSION")));
    format!("{commit}, {}, {} {}", info.name, info.driver, info.driver_info)
}
