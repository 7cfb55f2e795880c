//! All files that a batch writes, looked at before it writes any: none may replace a file that is read, another output, or a file of
//! another kind.

use super::jobs::{Jobs, Task};
use super::manifest;
use super::paths::Paths;
use crate::cli::args::BatchArgs;
use crate::cli::outputs::{LOG, MANIFEST, Outputs, REPORT, TABLE};
use crate::cli::render::load_from;
use crate::error::{Error, Result};
use crate::inputs::{Inputs, noted};
use crate::output::check_writable;
use crate::scene::library::Library;
use crate::scene::texture::ImagesRead;
use std::cell::LazyCell;
use std::path::{Path, PathBuf};

/// What the files of a batch are looked for in.
pub struct Checks<'a> {
    pub args: &'a BatchArgs,
    pub list: &'a Path,
    pub jobs: &'a Jobs,
    pub paths: &'a Paths,
    /// All manifests that are there.
    pub earlier: &'a [PathBuf],
    /// The files that the list was read from.
    pub inputs: &'a Inputs,
}

impl Checks<'_> {
    /// Scenes are read only where a file is there already that is not known to be an earlier output; `library` keeps them.
    ///
    /// # Errors
    /// [`Error::Input`] for a file that must not be replaced, [`Error::Work`] for one that cannot be written.
    pub fn run(&self, library: &Library) -> Result<()> {
        let mut outputs = Outputs::default();
        let frames_are_known = self.take_frames(&mut outputs)?;
        let own_are_known = self.take_own(&mut outputs)?;
        self.refuse_read(&outputs, self.inputs)?;
        let manifests = self.earlier.iter().filter(|path| **path != self.paths.own);
        for path in manifests.map(PathBuf::as_path).chain(self.jobs.scenes()) {
            outputs.owner(path).map_or(Ok(()), |owner| Err(self.is_read(path, owner)))?;
        }
        if frames_are_known && own_are_known {
            return Ok(());
        }
        for task in self.jobs.products() {
            let args = task.args()?;
            // what is wrong with a scene is said when it is its turn
            let (_, inputs) = noted(|| load_from(library, &args.scene, &args.change, |_| ImagesRead::All));
            self.refuse_read(&outputs, &inputs)?;
        }
        Ok(())
    }

    /// The files of all frames; whether all that are there were written by an earlier run.
    fn take_frames(&self, outputs: &mut Outputs) -> Result<bool> {
        let known = LazyCell::new(|| manifest::outputs(self.earlier));
        let mut are_known = true;
        for task in self.jobs.tasks() {
            for (kind, path) in task.kinds().into_iter().zip(task.outputs()?) {
                let taken = outputs.take(&path, task.index);
                if let Some(first) = taken.first {
                    let (list, path, first, second) =
                        (self.list.display(), path.display(), self.frame(first), &task.name);
                    let hint = "name what differs, as in {frame:04}";
                    return Err(Error::input(format!("{list}: {first} and {second} both write {path}; {hint}")));
                }
                if taken.is_there {
                    kind.check(&path).map_err(|e| e.at(format_args!("{}: {}", self.list.display(), task.name)))?;
                    are_known &= known.contains(&task.output_key(&path));
                }
            }
        }
        Ok(are_known)
    }

    /// The files of the batch itself; whether all that are there look like those of an earlier run.
    fn take_own(&self, outputs: &mut Outputs) -> Result<bool> {
        let log = self.args.log.as_ref();
        let asked = [(self.args.csv.as_ref(), TABLE), (self.args.report.as_ref(), REPORT), (log, LOG)];
        let asked = asked.into_iter().filter_map(|(path, kind)| Some((path?, kind)));
        let mut are_known = true;
        let frames = self.jobs.count();
        for (k, (path, kind)) in asked.chain([(&self.paths.own, MANIFEST)]).enumerate() {
            let taken = outputs.take(path, frames + k);
            if let Some(first) = taken.first {
                let (path, first) = (path.display(), self.owner(first));
                return Err(Error::input(format!("{path}: {first} writes it too; give each output a name of its own")));
            }
            if taken.is_there && !kind.is_ours(path) {
                are_known = false;
                // the list's own name may be the manifest's
                outputs.among(self.inputs).map_or(Ok(()), |(input, owner)| Err(self.is_read(input, owner)))?;
                kind.check(path)?;
            }
        }
        // a log is only added to
        [&self.args.csv, &self.args.report].into_iter().flatten().try_for_each(|path| check_writable(path))?;
        Ok(are_known)
    }

    fn refuse_read(&self, outputs: &Outputs, inputs: &Inputs) -> Result<()> {
        outputs.among(inputs).map_or(Ok(()), |(input, owner)| Err(self.is_read(input, owner)))
    }

    fn is_read(&self, input: &Path, owner: usize) -> Error {
        let (list, input, owner) = (self.list.display(), input.display(), self.owner(owner));
        Error::input(format!("{list}: {owner} writes over {input}, which is read; choose another name for the output"))
    }

    fn owner(&self, owner: usize) -> String {
        if owner < self.jobs.count() { self.frame(owner) } else { "another output".into() }
    }

    fn frame(&self, index: usize) -> String {
        self.jobs.tasks().nth(index).map(|task: Task| task.name).unwrap_or_default()
    }
}
