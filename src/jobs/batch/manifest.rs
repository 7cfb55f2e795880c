//! The manifest: one line of JSON per finished frame, with its inputs and its results. Lines are appended as frames finish. A killed
//! program leaves at most one incomplete line, which is ignored.

use super::list::Task;
use super::lock;
use crate::image::is_full;
use crate::input::files::{Inputs, Stamp, stamp};
use crate::input::{Error, Result};
use crate::jobs::Written;
use serde::{Deserialize, Serialize};
use std::collections::hash_map::DefaultHasher;
use std::collections::{BTreeMap, HashMap, HashSet};
use std::fs::{File, TryLockError};
use std::hash::{Hash, Hasher};
use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::time::{SystemTime, UNIX_EPOCH};

/// The finished frames of a list.
pub struct Manifest {
    /// The files of all lines. This manifest's own is the last: opened for appending too, and locked against other programs, of which some
    /// systems' locks also keep other handles of this one.
    files: Vec<(PathBuf, Mutex<File>)>,
    /// The last line of a frame, by its [`key`].
    lines: Mutex<HashMap<u64, Line>>,
    hashes: Mutex<HashMap<PathBuf, (Stamp, String)>>,
}

#[derive(Clone, Copy)]
struct Line {
    file: usize,
    start: u64,
    ms: f32,
    made_ms: u64,
}

/// Which of two lines of one frame is valid.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Counts {
    /// The one with the later time.
    Newest,
    /// The one read first.
    First,
}

/// Device times of earlier renders.
#[derive(Default)]
pub struct Costs(HashMap<u64, Line>);

impl Costs {
    /// The manifest, if it exists.
    pub fn read(path: &Path) -> Result<Costs> {
        let mut lines = HashMap::new();
        check_file(path)?;
        if let Ok(file) = File::open(path) {
            // merging results later must not change the shards
            read_lines(0, &file, &mut lines, Counts::First).map_err(|e| unreadable(path, &e))?;
        }
        Ok(Costs(lines))
    }

    /// Device time of a frame, ms.
    pub fn of(&self, task: &Task) -> Result<Option<f64>> {
        Ok(self.0.get(&key(task)?).map(|line| f64::from(line.ms)))
    }
}

/// A finished frame.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Done {
    pub frame: String,
    /// Version of the program.
    version: String,
    /// The command line that renders it.
    settings: Vec<String>,
    /// The hash of each input file, existing or not.
    inputs: BTreeMap<PathBuf, String>,
    outputs: BTreeMap<PathBuf, Output>,
    /// Time of completion, milliseconds since 1970.
    made_ms: u64,
    /// Device time, ms.
    pub ms: f64,
    pub adapter: String,
    pub triangles: usize,
    pub pieces: usize,
    /// Median time of the timed frames, ms, and their number.
    #[serde(default)]
    pub call_ms: f64,
    pub frame_ms: f64,
    pub runs: usize,
    /// Device times of the stages, ms.
    pub stages: BTreeMap<String, f64>,
    /// The error against the reference, if requested.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error: Option<serde_json::Value>,
}

/// A written file.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
struct Output {
    bytes: u64,
    hash: String,
}

/// The status of a frame in the list.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Status {
    New,
    Done,
    /// Done, but an input or option has changed since.
    Changed(String),
}

impl Manifest {
    /// Opens a manifest for appending and reads `others`, then the manifest itself. Without `keeps` it starts empty.
    ///
    /// # Errors
    /// [`Error::Write`] if it cannot be written, or another program has it open.
    pub fn open(path: &Path, others: &[PathBuf], keeps: bool) -> Result<Manifest> {
        let failed = |e: io::Error| failure(path, &e);
        others.iter().map(PathBuf::as_path).chain([path]).try_for_each(check_file)?;
        let own = File::options().create(true).append(true).read(true).open(path).map_err(failed)?;
        // other errors: the file system has no locks
        if let Err(TryLockError::WouldBlock) = own.try_lock() {
            let advice = "wait for it, or give each a --shard I/N";
            return Err(Error::work(format!("{}: another batch is using this manifest; {advice}", path.display())));
        }
        let kept = if keeps { whole_lines(&own).map_err(|e| unreadable(path, &e))? } else { 0 };
        own.set_len(kept).map_err(failed)?;
        let others = others.iter().filter(|other| keeps && *other != path);
        let mut files: Vec<_> =
            others.filter_map(|other| Some((other.clone(), Mutex::new(File::open(other).ok()?)))).collect();
        let mut lines = HashMap::new();
        files.push((path.to_owned(), Mutex::new(own)));
        for (k, (path, file)) in files.iter().enumerate() {
            read_lines(k, &lock(file), &mut lines, Counts::Newest).map_err(|e| unreadable(path, &e))?;
        }
        let (lines, hashes) = (Mutex::new(lines), Mutex::default());
        Ok(Manifest { files, lines, hashes })
    }

    /// The status of a frame by the present list and input files.
    pub fn status(&self, task: &Task) -> Result<Status> {
        let Some(done) = self.done(task)? else { return Ok(Status::New) };
        let changed = |what: String| Ok(Status::Changed(what));
        if done.version != env!("CARGO_PKG_VERSION") {
            return changed(format!("written by anamorph {}", done.version));
        }
        let settings = task.settings()?;
        if done.settings != settings {
            return changed(format!("its settings were {}", first_difference(&done.settings, &settings)));
        }
        for (path, hash) in &done.inputs {
            if self.hash(&task.whole(path)).as_ref() != Some(hash) {
                return changed(format!("{} has changed", path.display()));
            }
        }
        for (path, written) in &done.outputs {
            let whole = task.whole(path);
            match stamp(&whole) {
                None => return changed(format!("{} is not there", path.display())),
                // the modification time is not compared: any program can set it
                Some((_, bytes)) if bytes == written.bytes && self.hash(&whole).as_ref() == Some(&written.hash) => {}
                Some(_) => return changed(format!("{} was changed after it was written", path.display())),
            }
        }
        Ok(Status::Done)
    }

    /// The last entry of a frame.
    pub fn done(&self, task: &Task) -> Result<Option<Done>> {
        let Some(line) = self.line(task)? else { return Ok(None) };
        let (path, file) = &self.files[line.file];
        let mut file = lock(file);
        let mut text = Vec::new();
        let mut read = || {
            file.seek(SeekFrom::Start(line.start))?;
            BufReader::new(&mut *file).read_until(b'\n', &mut text)
        };
        read().map_err(|e| unreadable(path, &e))?;
        // a line that was damaged, as by bytes that are no text, is none
        Ok(serde_json::from_slice(&text).ok())
    }

    /// Appends the entry of a finished frame.
    ///
    /// # Errors
    /// [`Error::Work`] or [`Error::Full`] if the line cannot be written; the entry is then ignored.
    pub fn add(&self, task: &Task, inputs: &Inputs, written: &Written, ms: f64) -> Result<Done> {
        let mut outputs = BTreeMap::new();
        for path in task.outputs()? {
            // devices such as /dev/null store nothing
            if let (Some((_, bytes)), Some(hash)) = (stamp(&path), self.hash(&path)) {
                outputs.insert(task.short(&path), Output { bytes, hash });
            }
        }
        let mut found: BTreeMap<PathBuf, String> = BTreeMap::new();
        for (path, stamp) in inputs.files() {
            let hash = self.hash_as_found(path, stamp);
            let first = found.entry(task.short(path)).or_insert_with(|| hash.clone());
            if *first != hash {
                *first = CHANGED.into();
            }
        }
        let as_json = |error| serde_json::to_value(error).map_err(|e| Error::work(format!("an error as JSON: {e}")));
        let done = Done {
            frame: task.name.clone(),
            version: env!("CARGO_PKG_VERSION").into(),
            settings: task.settings()?,
            inputs: found,
            outputs,
            made_ms: SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_millis() as u64),
            ms,
            adapter: written.adapter.clone(),
            triangles: written.triangles,
            pieces: written.pieces,
            call_ms: written.call_ms,
            frame_ms: written.frame_ms.median,
            runs: written.frame_ms.runs,
            stages: written.stages.iter().map(|(name, ms)| ((*name).to_owned(), *ms)).collect(),
            error: written.error.as_ref().map(as_json).transpose()?,
        };
        self.append(task, &done)?;
        Ok(done)
    }

    fn append(&self, task: &Task, done: &Done) -> Result<()> {
        let (path, own) = &self.files[self.files.len() - 1];
        let failed = |e: io::Error| failure(path, &e);
        let text = serde_json::to_string(done).map_err(|e| Error::work(format!("manifest as JSON: {e}")))? + "\n";
        let mut own = lock(own);
        let start = own.seek(SeekFrom::End(0)).map_err(failed)?;
        if let Err(e) = own.write_all(text.as_bytes()) {
            // remove an incomplete line before the next one
            let _ = own.set_len(start);
            return Err(failed(e));
        }
        let line = Line { file: self.files.len() - 1, start, ms: done.ms as f32, made_ms: done.made_ms };
        lock(&self.lines).insert(key(task)?, line);
        Ok(())
    }

    /// Forgets a frame until it is rendered again.
    pub fn forget(&self, task: &Task) -> Result<()> {
        lock(&self.lines).remove(&key(task)?);
        Ok(())
    }

    /// Copies another manifest's entry of a frame into this one.
    pub fn adopt(&self, task: &Task) -> Result<()> {
        let is_own = self.line(task)?.is_some_and(|line| line.file + 1 == self.files.len());
        match self.done(task)? {
            Some(done) if !is_own => self.append(task, &done),
            _ => Ok(()),
        }
    }

    fn line(&self, task: &Task) -> Result<Option<Line>> {
        Ok(lock(&self.lines).get(&key(task)?).copied())
    }

    /// Hash of a file's content when it was read.
    fn hash_as_found(&self, path: &Path, found: &Stamp) -> String {
        let hash = self.hash(path).filter(|_| stamp(path) == *found);
        hash.unwrap_or_else(|| CHANGED.into())
    }

    /// The hash of a file's content; it is read again if its size or time has changed. `None` for a folder, a pipe or a device, which may
    /// have no end.
    fn hash(&self, path: &Path) -> Option<String> {
        let Some(found) = stamp(path) else { return Some(ABSENT.into()) };
        if !path.is_file() {
            return None;
        }
        if let Some((known, hash)) = lock(&self.hashes).get(path)
            && *known == Some(found)
        {
            return Some(hash.clone());
        }
        let (_, bytes) = found;
        let hashed = File::open(path).and_then(|f| murmur3::murmur3_x64_128(&mut BufReader::new(f.take(bytes)), 0));
        let hash = hashed.map_or(ABSENT.into(), |h| format!("{h:032x}"));
        let mut hashes = lock(&self.hashes);
        if hashes.len() >= HASHES_MAX {
            hashes.clear();
        }
        hashes.insert(path.to_owned(), (Some(found), hash.clone()));
        Some(hash)
    }
}

/// Stands in for the hash of a missing file.
const ABSENT: &str = "absent";

/// Stands in for the hash of a file that changed while it was read, or is not a regular file. No file has this hash.
const CHANGED: &str = "changed";

/// Most hashes kept in memory.
const HASHES_MAX: usize = 4096;

/// The [`key_of`] every output in these manifests.
pub fn outputs(paths: &[PathBuf]) -> HashSet<u64> {
    #[derive(Deserialize)]
    struct Head {
        outputs: BTreeMap<PathBuf, serde::de::IgnoredAny>,
    }
    let files = paths.iter().filter(|path| path.is_file()).filter_map(|path| File::open(path).ok());
    let lines = files.flat_map(|file| BufReader::new(file).lines().map_while(io::Result::ok));
    let heads = lines.filter_map(|line| serde_json::from_str::<Head>(&line).ok());
    heads.flat_map(|head| head.outputs.into_keys()).map(|path| key_of(&path)).collect()
}

/// Refuses a manifest that is a folder, or a pipe or a device, which may have no end.
fn check_file(path: &Path) -> Result<()> {
    if path.is_file() || !path.exists() {
        return Ok(());
    }
    Err(Error::input(format!("{}: is not a regular file, so it cannot be a manifest; remove it", path.display())))
}

fn unreadable(path: &Path, e: &io::Error) -> Error {
    Error::unreadable(path, format_args!("{e}; remove this manifest to render all frames again"))
}

fn failure(path: &Path, e: &io::Error) -> Error {
    let text = format!("{}: cannot write the manifest: {e}", path.display());
    if is_full(e) { Error::Full(text) } else { Error::Write(text) }
}

/// Identifies a frame: its first output that no other frame writes; several may write to one device, such as `/dev/null`. Without any,
/// its settings.
fn key(task: &Task) -> Result<u64> {
    match task.outputs()?.iter().find(|path| path.is_file() || !path.exists()) {
        Some(path) => Ok(key_of(task.short(path))),
        None => Ok(key_of(task.settings()?)),
    }
}

/// Of an output's path, or of settings.
pub fn key_of(what: impl Hash) -> u64 {
    let mut hasher = DefaultHasher::new();
    what.hash(&mut hasher);
    hasher.finish()
}

/// Bytes of a file up to the end of its last whole line.
fn whole_lines(file: &File) -> io::Result<u64> {
    let mut reader = BufReader::new(file);
    reader.seek(SeekFrom::Start(0))?;
    let (mut whole, mut line) = (0, Vec::new());
    while reader.by_ref().read_until(b'\n', &mut line)? > 0 {
        whole += if line.ends_with(b"\n") { line.len() as u64 } else { 0 };
        line.clear();
    }
    Ok(whole)
}

/// Adds the lines of file number `k`; lines that describe no frame are ignored.
fn read_lines(k: usize, file: &File, lines: &mut HashMap<u64, Line>, counts: Counts) -> io::Result<()> {
    /// The part of a line that identifies its frame.
    #[derive(Deserialize)]
    struct Head {
        outputs: BTreeMap<PathBuf, serde::de::IgnoredAny>,
        settings: Vec<String>,
        made_ms: u64,
        ms: f64,
    }
    let mut reader = BufReader::new(file);
    reader.seek(SeekFrom::Start(0))?;
    let (mut start, mut text) = (0, Vec::new());
    while reader.read_until(b'\n', &mut text)? > 0 {
        if let Ok(Head { outputs, settings, made_ms, ms }) = serde_json::from_slice(&text) {
            // outputs are words of the settings, in their order
            let first = settings.iter().map(Path::new).find(|word| outputs.contains_key(*word));
            let key = match first {
                Some(first) => Some(key_of(first)),
                None => outputs.is_empty().then(|| key_of(&settings)),
            };
            if let Some(key) = key {
                let own = Line { file: k, start, ms: ms as f32, made_ms };
                let kept = lines.entry(key).or_insert(own);
                // of one file the last line counts, whatever the clock said
                if counts == Counts::Newest && (kept.file == k || kept.made_ms <= made_ms) {
                    *kept = own;
                }
            }
        }
        start += text.len() as u64;
        text.clear();
    }
    Ok(())
}

/// The words of a command line that are missing from another one, or in other positions there.
fn first_difference(was: &[String], is: &[String]) -> String {
    let own: Vec<&str> = was.iter().filter(|word| !is.contains(word)).map(String::as_str).collect();
    let new: Vec<&str> = is.iter().filter(|word| !was.contains(word)).map(String::as_str).collect();
    match (own.is_empty(), new.is_empty()) {
        (true, true) => "in another order".into(),
        (false, _) => own.join(" "),
        (true, false) => format!("without {}", new.join(" ")),
    }
}
