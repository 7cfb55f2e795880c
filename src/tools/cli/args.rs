//! Commands and flags, each value checked as far as it can be without the scene.

use crate::input::{Limits, limits};
use crate::jobs::batch::Shard;
use crate::jobs::options;
use crate::jobs::{Change, EngineName, RenderJob};
use crate::tools::new::Up;
use clap::{Args, Parser, Subcommand, ValueEnum};
use std::ffi::OsString;
use std::path::PathBuf;

/// Renders triangles through cameras whose rays do not meet in a point.
#[derive(Debug, Parser)]
#[command(name = "anamorph", version, disable_help_subcommand = true)]
pub struct Cli {
    #[command(subcommand)]
    pub command: Command,
}

#[derive(Debug, Subcommand)]
pub enum Command {
    /// Render one scene
    #[command(after_help = limits::help())]
    Render(Box<RenderArgs>),
    /// Measure the error of one EXR against another
    #[command(after_help = limits::help())]
    Compare(CompareArgs),
    /// Show what a scene's camera compiles to; `--help KIND`: the keys of a kind of camera
    #[command(disable_help_flag = true, after_help = limits::help())]
    Camera(CameraArgs),
    /// Render a list of jobs
    #[command(after_help = limits::help())]
    Batch(BatchArgs),
    /// Find where 3-D points appear in the image
    #[command(after_help = limits::help())]
    Project(ProjectArgs),
    /// Draw 3-D points: the nearest in each pixel
    #[command(after_help = limits::help())]
    Splat(SplatArgs),
    /// List adapters and the code paths they select; with FILE: counts and bounds of a model or scene, and a camera for it
    #[command(after_help = limits::help())]
    Info(InfoArgs),
    /// Show a scene in the browser, to look at and to change
    #[cfg(feature = "view")]
    #[command(after_help = limits::help())]
    View(ViewArgs),
    /// Say what works on this machine, and what to install for what does not
    Doctor,
    /// Write an example scene
    Example(ExampleArgs),
    /// Write a commented scene for a model of your own, by what you want of it
    New(NewArgs),
    /// Print the completions of a shell, as in: anamorph completions bash >>~/.bash_completion
    Completions { shell: clap_complete::Shell },
    /// Print the JSON schema of scene files, by which editors complete and check them
    Schema,
    /// Write manual pages, a file for each command
    Man {
        /// Folder to write them to
        #[arg(long, value_name = "DIR", default_value = ".")]
        out: PathBuf,
    },
    /// Measure error against run time, of this engine and of its rivals; runs anamorph-lab
    #[command(disable_help_flag = true)]
    Bench(LabArgs),
    /// Test and measure this machine's GPU for some minutes, into a folder to send to the developers; runs anamorph-lab
    #[command(disable_help_flag = true)]
    GpuReport(LabArgs),
}

/// Changes of the limits on work and memory.
#[derive(Debug, Clone, Default, Args)]
pub struct Caps {
    /// Remove the limits on pieces, cells, corners, bounces, frames and memory
    #[arg(long)]
    pub no_limits: bool,
    /// Memory that the program may use, as in 8G or 500M [default: the free memory]
    #[arg(long, value_name = "SIZE", value_parser = bytes)]
    pub memory: Option<u64>,
}

impl Caps {
    /// The limits, less those that the flags remove.
    pub fn limits(&self) -> Limits {
        let limits = if self.no_limits { Limits::none() } else { Limits::default() };
        self.memory.map_or(limits, |bytes| limits.memory(bytes))
    }
}

#[derive(Debug, Clone, Args)]
pub struct RenderArgs {
    #[command(flatten)]
    job: RenderJob,
    /// Adapter to use: a part of its name
    #[arg(long, value_name = "NAME")]
    pub adapter: Option<String>,
    /// Do without 64-bit atomics
    #[arg(long)]
    pub no_int64: bool,
    /// Emulate f64 with 32-bit integers
    #[arg(long)]
    pub no_f64: bool,
    /// Write the source of every compiled kernel to this folder, as NAME.wgsl
    #[arg(long, value_name = "DIR")]
    pub dump_kernels: Option<PathBuf>,
    /// Only print one pixel's ray, hit, near candidates and whether it is safe
    #[arg(long, value_name = "X,Y", allow_hyphen_values = true, value_parser = pixel, conflicts_with_all = [
        "output", "exr", "points", "gradients", "engine", "samples", "analytic", "channels", "report", "check", "repeat", "no_cull", "method",
        "adapter", "no_int64", "no_f64", "dump_kernels",
    ])]
    pub pixel: Option<(u32, u32)>,
    #[command(flatten)]
    pub caps: Caps,
}

impl RenderArgs {
    /// The render job of these flags.
    pub fn job(&self) -> RenderJob {
        RenderJob { limits: self.caps.limits(), ..self.job.clone() }
    }
}

#[derive(Debug, Args)]
pub struct BatchArgs {
    /// List of jobs, .toml, .json or .jsonl
    #[arg(value_name = "JOBS", required_unless_present = "write_driver")]
    pub jobs: Option<PathBuf>,
    /// Skip frames that the manifest beside the list records as done and whose inputs have not changed
    #[arg(long)]
    pub resume: bool,
    /// Render the I-th of N parts of the list, of about equal cost, as in 1/4
    #[arg(long, value_name = "I/N", value_parser = options::shard)]
    pub shard: Option<Shard>,
    /// Render nothing: merge the manifests of all shards into that of the list, and list the frames that are not done
    #[arg(long, conflicts_with_all = ["shard", "resume", "jobs_at_once", "adapters", "fail_fast", "progress", "log"])]
    pub gather: bool,
    /// Write a program that renders lists on a Ray cluster, shard by shard
    #[arg(long, value_name = "FILE.py", exclusive = true)]
    pub write_driver: Option<PathBuf>,
    /// Number of threads that write frames [default: one per core]
    #[arg(long = "jobs", value_name = "K", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub jobs_at_once: Option<u16>,
    /// Adapters to use at once: parts of their names, their numbers in info from 0, or all (a software adapter only if there is no other)
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub adapters: Option<Vec<String>>,
    /// Stop at the first frame that fails
    #[arg(long)]
    pub fail_fast: bool,
    /// Progress: auto (a bar on a terminal), json (a line per event on stdout), none
    #[arg(long, value_name = "HOW", default_value = "auto")]
    pub progress: ProgressName,
    /// Append a line per event, with its time
    #[arg(long, value_name = "FILE")]
    pub log: Option<PathBuf>,
    /// Times and counts of the batch and of each frame, as JSON
    #[arg(long, value_name = "R.json")]
    pub report: Option<PathBuf>,
    /// One row per frame: swept values, times, and errors if check = true
    #[arg(long, value_name = "T.csv")]
    pub csv: Option<PathBuf>,
    #[command(flatten)]
    pub caps: Caps,
}

/// How a batch reports progress.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ProgressName {
    Auto,
    Json,
    None,
}

#[derive(Debug, Args)]
pub struct CompareArgs {
    /// The image to judge
    pub a: PathBuf,
    /// The image to compare it with
    pub b: PathBuf,
    /// Scene of both: finds which pixels are safe
    #[arg(long, value_name = "SCENE")]
    pub scene: Option<PathBuf>,
    /// Change a value of the scene, as when the images were rendered
    #[arg(long, value_name = "KEY=VALUE", requires = "scene")]
    pub set: Vec<String>,
    /// Frame of the scene that the images show
    #[arg(long, value_name = "F", allow_hyphen_values = true, default_value_t = 0.0, value_parser = options::frame, requires = "scene")]
    pub frame: f64,
    /// Print JSON
    #[arg(long)]
    pub json: bool,
    #[command(flatten)]
    pub caps: Caps,
}

#[derive(Debug, Args)]
pub struct CameraArgs {
    /// Scene file, .toml or .json; or a rendered EXR, whose header holds the camera
    #[arg(required_unless_present = "help")]
    pub scene: Option<PathBuf>,
    #[command(flatten)]
    pub change: Change,
    /// Write the pieces as a mesh camera, or several layers as a chain camera
    #[arg(long, value_name = "FILE.json")]
    pub export: Option<PathBuf>,
    /// Write the scene for POV-Ray 3.7, with each pixel's ray, and each triangle's id as its colour
    #[arg(long, value_name = "FILE.pov")]
    pub export_povray: Option<PathBuf>,
    /// Write each pixel's P and D: an array of H x W x 6; a curve's or projector's control points: H x W x (m+1) x 3
    #[arg(long, value_name = "RAYS.npy")]
    pub rays: Option<PathBuf>,
    /// Draw the pieces, and sample rays around the scene
    #[arg(long, value_name = "D.svg")]
    pub diagram: Option<PathBuf>,
    /// Print help; with a kind of camera, its keys
    #[arg(short, long, value_name = "KIND", num_args = 0..=1)]
    pub help: Option<Option<String>>,
    #[command(flatten)]
    pub caps: Caps,
}

/// What projects points.
#[derive(Debug, Args)]
pub struct DeviceArgs {
    // the command says what it does there
    #[arg(long, value_name = "NAME", value_parser = sifting_engine)]
    pub engine: Option<EngineName>,
    /// Adapter to use: a part of its name
    #[arg(long, value_name = "NAME")]
    pub adapter: Option<String>,
}

fn device_help(work: &str) -> String {
    format!(
        "{work}: compute (GPU) or reference (CPU); same output [default: compute from 65,536 points on with a hardware GPU, else reference]"
    )
}

#[derive(Debug, Args)]
#[command(mut_arg("engine", |arg| arg.help(device_help("Where candidates are searched"))))]
pub struct ProjectArgs {
    /// Scene file, .toml or .json
    pub scene: PathBuf,
    /// Points: .npy of N x 3, or .csv, .txt, .xyz with three numbers per line
    #[arg(long, value_name = "FILE")]
    pub points: PathBuf,
    /// Write the lines to this file instead of stdout
    #[arg(short, long, value_name = "OUT.jsonl")]
    pub output: Option<PathBuf>,
    #[command(flatten)]
    pub change: Change,
    #[command(flatten)]
    pub device: DeviceArgs,
    #[command(flatten)]
    pub caps: Caps,
}

#[derive(Debug, Args)]
#[command(mut_arg("engine", |arg| arg.help(device_help("Where hidden points are left out"))))]
pub struct SplatArgs {
    /// Scene file, .toml or .json
    pub scene: PathBuf,
    /// Points: .ply with or without colours, .npy of N x 3, or .csv, .txt, .xyz with three numbers per line
    #[arg(long, value_name = "FILE")]
    pub points: PathBuf,
    /// Colour, 8-bit sRGB and coverage; white for points without colours
    #[arg(short, long, value_name = "OUT.png")]
    pub output: Option<PathBuf>,
    /// Colour (linear), coverage and t, 32-bit
    #[arg(long, value_name = "OUT.exr")]
    pub exr: Option<PathBuf>,
    /// t of each pixel's point in f64, H x W; inf where there is none
    #[arg(long, value_name = "OUT.npy")]
    pub depth: Option<PathBuf>,
    /// Each pixel's point, from 0, as u32, H x W; 4294967295 where there is none
    #[arg(long, value_name = "OUT.npy")]
    pub index: Option<PathBuf>,
    #[command(flatten)]
    pub change: Change,
    #[command(flatten)]
    pub device: DeviceArgs,
    #[command(flatten)]
    pub caps: Caps,
}

#[derive(Debug, Args)]
pub struct InfoArgs {
    /// Describe this model (.obj, .gltf, .glb, .ply, .stl, .off, .dae; .asc, .png, .tif with heights), scene (.toml, .json) or volume (.nrrd, .nhdr,
    /// .mha, .mhd, .npy) instead of the adapters
    pub file: Option<PathBuf>,
    /// Print JSON
    #[arg(long)]
    pub json: bool,
    #[command(flatten)]
    pub caps: Caps,
}

#[cfg(feature = "view")]
#[derive(Debug, Args)]
pub struct ViewArgs {
    /// Scene file, .toml or .json
    pub scene: PathBuf,
    /// Port on 127.0.0.1 [default: any that is free]
    #[arg(long, value_name = "N", default_value_t = 0, hide_default_value = true)]
    pub port: u16,
    /// Open the page in the default browser
    #[arg(long)]
    pub open: bool,
    /// Token in the address, 16 characters or more [default: a random one]
    #[arg(long, value_name = "TEXT", value_parser = token)]
    pub token: Option<String>,
    #[command(flatten)]
    pub change: Change,
    /// Adapter to use: a part of its name
    #[arg(long, value_name = "NAME")]
    pub adapter: Option<String>,
    #[command(flatten)]
    pub caps: Caps,
}

/// Characters that a token needs at least: too many to try.
#[cfg(feature = "view")]
const TOKEN_MIN: usize = 16;

#[cfg(feature = "view")]
fn token(text: &str) -> Result<String, String> {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
    match text.len() >= TOKEN_MIN && text.chars().all(is_plain) {
        true => Ok(text.into()),
        false => Err(format!("write {TOKEN_MIN} or more letters and digits")),
    }
}

#[derive(Debug, Args)]
pub struct ExampleArgs {
    /// Name of the example
    #[arg(required_unless_present = "list")]
    pub name: Option<String>,
    /// Folder to write it to
    #[arg(long, value_name = "DIR", default_value = ".")]
    pub out: PathBuf,
    /// Print all names
    #[arg(long, conflicts_with_all = ["name", "out"])]
    pub list: bool,
}

#[derive(Debug, Args)]
pub struct NewArgs {
    /// What you want: a name of --list
    #[arg(required_unless_present = "list")]
    pub task: Option<String>,
    /// The model, .obj, .ply, .stl, .off, .dae, .gltf or .glb; or points, .ply, .npy, .csv or .xyz [default: the built-in teapot]
    #[arg(long, value_name = "FILE")]
    pub mesh: Option<PathBuf>,
    /// The model's axis that points up
    #[arg(long, value_name = "AXIS", default_value = "y", requires = "mesh")]
    pub up: Up,
    /// Scene file to write [default: TASK.toml]
    #[arg(short, long, value_name = "SCENE.toml")]
    pub output: Option<PathBuf>,
    /// Print all tasks
    #[arg(long, conflicts_with_all = ["task", "mesh", "output"])]
    pub list: bool,
}

/// Arguments that are handed on to the laboratory's program.
#[derive(Debug, Args)]
pub struct LabArgs {
    #[arg(value_name = "ARGUMENTS", trailing_var_arg = true, allow_hyphen_values = true)]
    pub arguments: Vec<OsString>,
}

/// A number of bytes: a number with an optional unit, k, M, G or T for powers of 1024, and optionally B or iB.
fn bytes(text: &str) -> Result<u64, String> {
    let number = text.trim_end_matches(|c: char| c.is_ascii_alphabetic());
    let power = match text[number.len()..].to_ascii_lowercase().trim_end_matches('b').trim_end_matches('i') {
        "" => Some(0),
        "k" => Some(1),
        "m" => Some(2),
        "g" => Some(3),
        "t" => Some(4),
        _ => None,
    };
    let value = number.parse().ok().zip(power).map(|(n, power): (f64, i32)| n * 1024f64.powi(power));
    match value {
        // fits u64; a fraction of a byte is dropped
        Some(bytes) if (1.0..9e18).contains(&bytes) => Ok(bytes as u64),
        _ => Err("give a number of bytes, as 500M or 8G".into()),
    }
}

fn pixel(text: &str) -> Result<(u32, u32), String> {
    let place = text.split_once(',').and_then(|(x, y)| Some((x.trim().parse().ok()?, y.trim().parse().ok()?)));
    place.ok_or_else(|| "write it as COLUMN,ROW, for example 400,300; row 0 is on top".into())
}

fn sifting_engine(name: &str) -> Result<EngineName, String> {
    options::engine(name)
        .ok()
        .filter(|e| !matches!(e, EngineName::Rival(_)))
        .ok_or_else(|| "use compute or reference".into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_flags_fit_together() {
        Cli::command().debug_assert();
    }

    #[test]
    fn values_are_read_or_refused() {
        assert_eq!([bytes("4096"), bytes("8G"), bytes("1.5MiB")], [Ok(4096), Ok(8 << 30), Ok(3 << 19)]);
        assert!(["", "G", "-1G", "8X", "0", "nan", "1e30", "8é"].iter().all(|wrong| bytes(wrong).is_err()));
        assert_eq!(pixel("3, 4"), Ok((3, 4)));
        assert!(pixel("3").is_err() && pixel("-1,2").is_err());
    }
}
