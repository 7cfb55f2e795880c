//! Where the manifests of a list lie, and the folders that its frames go to.

use super::list::Jobs;
use super::shard::Shard;
use crate::image;
use crate::input::Result;
use std::collections::BTreeSet;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

/// The manifests of a list.
pub struct Paths {
    /// Of the whole list.
    pub whole: PathBuf,
    /// That of this run.
    pub own: PathBuf,
}

/// What their names end with.
const ENDING: &str = ".manifest.jsonl";

impl Paths {
    pub fn of(list: &Path, shard: Option<Shard>) -> Paths {
        let name = list.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let whole = list.with_file_name(format!("{name}{ENDING}"));
        let own = match shard {
            Some(shard) => list.with_file_name(format!("{name}.{}-of-{}{ENDING}", shard.index + 1, shard.count)),
            None => whole.clone(),
        };
        Paths { whole, own }
    }

    /// Those that are there, of the whole list and of its shards.
    pub fn others(&self) -> Vec<PathBuf> {
        let folder = image::folder_of(&self.whole);
        let name = self.whole.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let start = name.trim_end_matches(ENDING).to_owned() + ".";
        let is_of_shard = |name: &OsString| {
            let name = name.to_string_lossy();
            let shard = name.strip_prefix(&start).and_then(|rest| rest.strip_suffix(ENDING));
            let numbers = shard.and_then(|shard| shard.split_once("-of-"));
            numbers.is_some_and(|(i, n)| i.parse::<u32>().is_ok() && n.parse::<u32>().is_ok())
        };
        let names = std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.file_name());
        let shards = names.filter(is_of_shard);
        // with the folder as in `self.whole`, so that paths can be compared
        let mut all: Vec<PathBuf> = shards.map(|name| self.whole.with_file_name(name)).collect();
        all.sort();
        all.insert(0, self.whole.clone());
        all
    }
}

/// Where the frames of a list go to.
pub fn folders(jobs: &Jobs) -> Result<BTreeSet<PathBuf>> {
    let mut all = BTreeSet::new();
    for task in jobs.tasks() {
        for path in task.outputs()? {
            all.extend(folder_of(&path));
        }
    }
    Ok(all)
}

/// The folder that a file goes to, if it is there.
pub fn folder_of(path: &Path) -> Option<PathBuf> {
    let folder = image::folder_of(path);
    folder.is_dir().then(|| folder.to_owned())
}
