//! The list of jobs: each is a `render` with its flags, for each of its frames and all products of what it sweeps.

use super::manifest::key_of;
use super::names::{fill, plain};
use crate::camera::kinds::calibrated;
use crate::input::limits::FRAMES;
use crate::input::load::with_tree;
use crate::input::reader::{Field, Table};
use crate::input::{Error, Limits, Loading, Result};
use crate::jobs::outputs::{EXR, Kind, PICTURE, POINTS, REPORT};
use crate::jobs::{Change, EngineName, RenderJob, options};
use std::path::{Path, PathBuf};

pub struct Jobs {
    all: Vec<Job>,
    /// Folder of the file, which paths start from.
    dir: PathBuf,
    /// The limits on the list and on each of its frames.
    limits: Limits,
}

#[derive(Debug)]
struct Job {
    /// Its number in the list.
    name: String,
    /// Its position in the file.
    key: String,
    scene: String,
    /// Keys of flags of `render`, and their values as they are written.
    flags: Vec<(&'static str, Option<String>)>,
    sweep: Vec<Swept>,
    /// The folder of COLMAP's whose images [`IMAGE`] sweeps.
    images: Option<PathBuf>,
    frames: Vec<f64>,
}

/// The key of the image, where a job renders those of a COLMAP model.
const IMAGE: &str = "image";

/// A value of the scene that takes several, as `--set` does.
#[derive(Debug)]
struct Swept {
    key: String,
    values: Vec<String>,
}

/// One frame that is to be rendered.
#[derive(Debug, Clone)]
pub struct Task<'a> {
    /// Its number among all frames of the list, from 0.
    pub index: usize,
    /// As `job.0, camera.vfov=40, frame 3`.
    pub name: String,
    /// What the job sweeps, by key.
    pub values: Vec<(&'a str, &'a str)>,
    /// Where values given as keyframes are taken.
    pub frame: f64,
    /// How often a device was lost with it.
    pub(super) losses: u32,
    job: &'a Job,
    dir: &'a Path,
    limits: Limits,
}

/// The keys of files that a job writes; their names differ from frame to frame.
const OUTPUTS: [(&str, Kind); 4] = [("color", PICTURE), ("exr", EXR), ("points", POINTS), ("report", REPORT)];

/// Keys of other flags with a value.
const VALUES: [&str; 5] = ["size", "engine", "method", "samples", "repeat"];

/// Keys of flags without one.
const SWITCHES: [&str; 4] = ["analytic", "check", "no_cull", "strict"];

/// A list has fewer frames, even without limits: the numbers of frames must be exact in f64.
const FRAMES_MAX: f64 = 1e15;

impl Jobs {
    /// Reads a list: `[[job]]` tables of a .toml, `{ "job": [...] }` of a .json, or a job a line of a .jsonl.
    ///
    /// # Errors
    /// [`Error::Input`] if it is no list, is empty, or has wrong flags.
    pub fn read(path: &Path, loading: &Loading) -> Result<Jobs> {
        let all: Vec<Job> = with_tree(path, loading, |root| {
            let table = root.table()?;
            table.allow(&["job"])?;
            let list = table.need("job", "[{ scene = \"scene.toml\", color = \"out-{frame:04}.png\" }]")?;
            list.items("a list of jobs, as [[job]]")?.enumerate().map(|(k, job)| read_job(k, &job, path)).collect()
        })?;
        if all.is_empty() {
            let hint = "a .toml has [[job]] tables, a .json { \"job\": [...] }, a .jsonl one job per line";
            return Err(Error::input(format!("{}: has no jobs; {hint}", path.display())));
        }
        let dir = absolute(path).parent().unwrap_or(Path::new("")).to_owned();
        let limits = loading.limits();
        let jobs = Jobs { all, dir, limits };
        let frames = jobs.all.iter().fold(0, |sum: u64, job| sum.saturating_add(job.frames_in_all()));
        limits.check(FRAMES, frames).map_err(|e| e.at(path.display()))?;
        if frames >= FRAMES_MAX as u64 {
            return Err(Error::input(format!(
                "{}: more than {FRAMES_MAX:.0e} frames; use fewer swept values or frames",
                path.display()
            )));
        }
        for job in jobs.all.iter().filter(|job| job.count() > 0) {
            jobs.task(0, job, 0).job()?;
        }
        Ok(jobs)
    }

    /// Frames of all jobs.
    pub fn count(&self) -> usize {
        self.all.iter().map(Job::count).sum()
    }

    /// Some of them are not by the reference.
    pub fn need_adapter(&self) -> Result<bool> {
        for job in self.all.iter().filter(|job| job.count() > 0) {
            if !matches!(self.task(0, job, 0).job()?.engine, Some(EngineName::Reference)) {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// In the order of the file; of a job the last swept key changes first, and frames before that.
    pub fn tasks(&self) -> impl Iterator<Item = Task<'_>> {
        let each = |job| (0..Job::count(job)).map(move |k| (job, k));
        self.all.iter().flat_map(each).enumerate().map(|(index, (job, k))| self.task(index, job, k))
    }

    fn task<'a>(&'a self, index: usize, job: &'a Job, k: usize) -> Task<'a> {
        let (mut rest, frame) = (k / job.frames.len(), job.frames[k % job.frames.len()]);
        let mut values = Vec::new();
        for swept in job.sweep.iter().rev() {
            values.push((swept.key.as_str(), swept.values[rest % swept.values.len()].as_str()));
            rest /= swept.values.len();
        }
        values.reverse();
        let sets: String = values.iter().map(|(key, value)| format!(", {key}={value}")).collect();
        Task {
            index,
            name: format!("{}{sets}, frame {frame}", job.name),
            values,
            frame,
            losses: 0,
            job,
            dir: &self.dir,
            limits: self.limits,
        }
    }

    /// The first frame of each combination of swept values: the frames of one combination are read from the same files.
    pub fn products(&self) -> impl Iterator<Item = Task<'_>> {
        let each = |job| (0..Job::count(job)).step_by(Job::frames(job)).map(move |k| (job, k));
        self.all.iter().flat_map(each).map(|(job, k)| self.task(0, job, k))
    }

    /// The scenes of all jobs.
    pub fn scenes(&self) -> impl Iterator<Item = &Path> {
        self.all.iter().map(|job| Path::new(&job.scene))
    }
}

impl Job {
    /// The number of frames, at most `u64::MAX`.
    fn frames_in_all(&self) -> u64 {
        let all = self.sweep.iter().map(|s| s.values.len()).chain([self.frames.len()]);
        all.fold(1, |product: u64, n| product.saturating_mul(n as u64))
    }

    /// The number of frames of one combination of swept values, at least 1, as it is used as a step.
    fn frames(&self) -> usize {
        self.frames.len().max(1)
    }

    fn count(&self) -> usize {
        // fits: `Jobs::read` refuses lists of `FRAMES_MAX` and more
        self.frames_in_all() as usize
    }
}

impl Task<'_> {
    /// The render job of this frame.
    ///
    /// # Errors
    /// [`Error::Input`] for a value that is none of its flag.
    pub(crate) fn job(&self) -> Result<RenderJob> {
        let mut job = RenderJob::of(&self.job.scene);
        job.change = Change { frame: self.frame, ..Change::default() };
        job.limits = self.limits;
        for (key, value) in &self.job.flags {
            let value = self.filled(key, value.as_deref().unwrap_or_default())?;
            set(&mut job, key, value).map_err(|e| Error::input(format!("{}: {key}: {e}", self.job.key)))?;
        }
        let mut sets = self.image_camera();
        sets.append(&mut job.change.set);
        sets.extend(self.swept().map(|(key, value)| format!("{key}={value}")));
        job.change.set = sets;
        Ok(job)
    }

    /// The camera of the image of a COLMAP model, which comes before all that is set or swept.
    fn image_camera(&self) -> Vec<String> {
        let (Some(folder), Some((_, image))) = (&self.job.images, self.values.iter().find(|v| v.0 == IMAGE)) else {
            return Vec::new();
        };
        let folder = serde_json::Value::from(folder.display().to_string());
        vec![format!("camera={{ kind = \"calibrated\", file = {folder}, image = {image} }}")]
    }

    /// The values of the scene that are swept.
    fn swept(&self) -> impl Iterator<Item = &(&str, &str)> {
        self.values.iter().filter(|(key, _)| self.job.images.is_none() || *key != IMAGE)
    }

    /// As job.0.
    #[cfg(feature = "cli")]
    pub(crate) fn job_name(&self) -> &str {
        &self.job.name
    }

    /// A path as from the folder of the list, where it is in there.
    pub(crate) fn short(&self, path: &Path) -> PathBuf {
        let whole = absolute(path);
        whole.strip_prefix(self.dir).map_or(whole.clone(), Path::to_owned)
    }

    /// And back.
    pub(crate) fn whole(&self, path: &Path) -> PathBuf {
        self.dir.join(path)
    }

    /// The files that it writes, at least one.
    pub fn outputs(&self) -> Result<Vec<PathBuf>> {
        let outputs = self.job.flags.iter().filter(|(key, _)| is_output(key));
        outputs.map(|(key, file)| self.filled(key, file.as_deref().unwrap_or_default()).map(PathBuf::from)).collect()
    }

    /// The kinds of the [`outputs`](Task::outputs), in their order.
    pub(crate) fn kinds(&self) -> Vec<Kind> {
        let kind = |key: &str| OUTPUTS.iter().find(|own| own.0 == key).map(|own| own.1);
        self.job.flags.iter().filter_map(|(key, _)| kind(key)).collect()
    }

    /// The key of an output of this frame in [`manifest::outputs`](super::manifest::outputs).
    pub(crate) fn output_key(&self, path: &Path) -> u64 {
        key_of(self.short(path))
    }

    /// The command line that says all that the frame depends on but for what is in files, as if typed in the folder of the list.
    pub(crate) fn settings(&self) -> Result<Vec<String>> {
        let shown = |text: String| self.short(Path::new(&text)).display().to_string();
        let mut line = vec!["render".to_owned(), shown(self.job.scene.clone())];
        line.extend(self.image_camera().into_iter().flat_map(|camera| ["--set".to_owned(), camera]));
        for (key, value) in &self.job.flags {
            line.push(format!("--{}", if *key == "color" { "output".into() } else { key.replace('_', "-") }));
            if let Some(value) = value {
                let filled = self.filled(key, value)?;
                line.push(if is_output(key) { shown(filled) } else { filled });
            }
        }
        line.extend(self.swept().flat_map(|(key, value)| ["--set".to_owned(), format!("{key}={value}")]));
        line.extend(["--frame".to_owned(), self.frame.to_string()]);
        Ok(line)
    }

    /// The value of a flag: names of files have those of this task in them.
    fn filled(&self, key: &str, text: &str) -> Result<String> {
        if !is_output(key) {
            return Ok(text.to_owned());
        }
        let swept = |key: &str| self.values.iter().find(|v| v.0 == key).map(|v| plain(v.1));
        let value = |key: &str| if key == "frame" { Some(self.frame.to_string()) } else { swept(key) };
        fill(text, value).map_err(|e| Error::input(format!("{}: {e}", self.job.key)))
    }
}

/// Sets the option of a key.
fn set(job: &mut RenderJob, key: &str, value: String) -> std::result::Result<(), String> {
    match key {
        "color" => job.color = Some(value.into()),
        "exr" => job.exr = Some(value.into()),
        "points" => job.points = Some(value.into()),
        "report" => job.report = Some(value.into()),
        "size" => job.change.size = Some(options::size(&value)?),
        "engine" => job.engine = Some(options::engine(&value)?),
        "method" => job.method = options::method(&value)?,
        "samples" => job.samples = options::samples(&value)?,
        "repeat" => job.repeat = Some(options::repeat(&value)?),
        "channels" => {
            job.channels = Some(value.split(',').map(options::channels).collect::<std::result::Result<_, _>>()?)
        }
        "set" => job.change.set.push(value),
        "analytic" => job.analytic = true,
        "check" => job.check = true,
        "no_cull" => job.no_cull = true,
        "strict" => job.strict = true,
        _ => return Err("jobs do not have this option".into()),
    }
    Ok(())
}

/// However it is spelled; not where links lead.
fn absolute(path: &Path) -> PathBuf {
    std::path::absolute(path).unwrap_or_else(|_| path.to_owned())
}

fn is_output(key: &str) -> bool {
    OUTPUTS.iter().any(|own| own.0 == key)
}

fn read_job(k: usize, field: &Field, path: &Path) -> Result<Job> {
    let table = field.table()?;
    let mut known = vec!["scene", "frames", "images", "set", "sweep", "channels"];
    known.extend(OUTPUTS.iter().map(|own| own.0));
    known.extend(VALUES.iter().chain(&SWITCHES));
    table.allow(&known)?;
    let mut flags = Vec::new();
    for (key, _) in OUTPUTS {
        flags.extend(table.optional(key, |f| f.path())?.map(|file| (key, Some(file.display().to_string()))));
    }
    if flags.iter().all(|(key, _)| *key == "report") {
        return Err(table.error("nothing to write; add color, exr or points"));
    }
    for key in VALUES {
        flags.extend(table.optional(key, Field::inline)?.map(|value| (key, Some(value.trim_matches('"').to_owned()))));
    }
    for key in SWITCHES {
        flags.extend(table.or(key, false, Field::boolean)?.then_some((key, None)));
    }
    if let Some(list) = table.get("channels") {
        let names = list.items("a list of channels, as [\"R\", \"Z\"]")?;
        let names: Vec<&str> = names.map(|name| name.text()).collect::<Result<_>>()?;
        flags.push(("channels", Some(names.join(","))));
    }
    if let Some(list) = table.get("set") {
        for text in list.items("a list of texts, as [\"camera.vfov=40\"]")? {
            flags.push(("set", Some(text.text()?.to_owned())));
        }
    }
    let mut sweep = Vec::new();
    if let Some(field) = table.get("sweep") {
        read_sweep(&field.table()?, "", &mut sweep)?;
    }
    let images = table.optional("images", |field| Ok(absolute(&field.path()?)))?;
    if let Some(folder) = &images {
        if sweep.iter().any(|swept: &Swept| swept.key == IMAGE) {
            return Err(table.error("sweep.image: images sweeps it already; remove one of the two"));
        }
        let names = calibrated::file::images(folder, table.loading())?;
        let values = names.into_iter().map(|name| serde_json::Value::from(name).to_string()).collect();
        sweep.push(Swept { key: IMAGE.into(), values });
    }
    Ok(Job {
        name: format!("job.{k}"),
        key: format!("{}: job.{k}", path.display()),
        scene: table.need("scene", "\"scene.toml\"")?.path()?.display().to_string(),
        flags,
        sweep,
        images,
        frames: table.or("frames", vec![0.0], read_frames)?,
    })
}

/// Lists of values; tables are dotted keys.
fn read_sweep(table: &Table, prefix: &str, all: &mut Vec<Swept>) -> Result<()> {
    for (key, field) in table.fields() {
        let key = format!("{prefix}{key}");
        if field.is_table() {
            read_sweep(&field.table()?, &format!("{key}."), all)?;
            continue;
        }
        let values: Vec<String> =
            field.items("a list of values, as [1, 16, 128]")?.map(|value| value.inline()).collect::<Result<_>>()?;
        if values.is_empty() {
            return Err(field.error("no values; write at least one, as [1, 16, 128]"));
        }
        all.push(Swept { key, values });
    }
    Ok(())
}

/// A number, a list of numbers, or `{ first, last, step }`.
fn read_frames(field: &Field) -> Result<Vec<f64>> {
    if field.is_list() {
        return field.items("a list of frames")?.map(|frame| frame.number()).collect();
    }
    if !field.is_table() {
        return Ok(vec![field.number()?]);
    }
    let table = field.table()?;
    table.allow(&["first", "last", "step"])?;
    let first = table.or("first", 0.0, Field::number)?;
    let last = table.need("last", "1999")?.number()?;
    let step = table.or("step", 1.0, Field::number)?;
    let steps = ((last - first) / step + 1e-9).floor();
    if !(0.0..FRAMES_MAX).contains(&steps) {
        return Err(field.error(format_args!(
            "first = {first}, last = {last}, step = {step} gives no frames, or more than {FRAMES_MAX:.0e}"
        )));
    }
    field.limits().check(FRAMES, steps as u64 + 1).map_err(|e| field.error(e))?;
    Ok((0..=steps as u64).map(|k| first + step * k as f64).collect())
}
