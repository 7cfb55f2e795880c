//! Checks of all files that a batch writes, before it writes any: none may replace an input, another output, or a file of another kind.

use super::list::Task;
use super::{Batch, manifest};
use crate::geometry::texture::ImagesRead;
use crate::image::check_writable;
use crate::input::files::Inputs;
use crate::input::{Error, Loading, Result};
use crate::jobs::job::load_from;
use crate::jobs::outputs::{LOG, MANIFEST, Outputs};
use std::cell::LazyCell;
use std::path::{Path, PathBuf};

/// A batch whose files are checked.
pub struct Checks<'a> {
    pub batch: &'a Batch,
    pub list: &'a Path,
    /// The files that the list was read from.
    pub inputs: &'a Inputs,
}

impl Checks<'_> {
    /// Checks all files. Scenes are read, into the library, only if an output exists that may not be of an earlier run: it may be one of
    /// their inputs.
    ///
    /// # Errors
    /// [`Error::Input`] for a file that must not be replaced, [`Error::Write`] for one that cannot be written.
    pub fn run(&self) -> Result<()> {
        let mut outputs = Outputs::default();
        let frames_are_known = self.add_frames(&mut outputs)?;
        let own_are_known = self.add_own(&mut outputs)?;
        self.refuse_inputs(&outputs, self.inputs)?;
        let manifests = self.batch.earlier.iter().filter(|path| **path != self.batch.paths.own);
        for path in manifests.map(PathBuf::as_path).chain(self.batch.jobs.scenes()) {
            outputs.owner(path).map_or(Ok(()), |owner| Err(self.is_read(path, owner)))?;
        }
        if frames_are_known && own_are_known {
            return Ok(());
        }
        for task in self.batch.jobs.products() {
            let job = task.job()?;
            let loading = Loading::new(job.limits);
            // an error in the scene is reported when its frame is rendered
            let _ = load_from(&self.batch.library, &job.scene, &job.change, |_| ImagesRead::All, &loading);
            self.refuse_inputs(&outputs, &loading.into_inputs())?;
        }
        Ok(())
    }

    /// Adds the files of all frames. Returns whether an earlier run wrote all that exist.
    fn add_frames(&self, outputs: &mut Outputs) -> Result<bool> {
        let known = LazyCell::new(|| manifest::outputs(&self.batch.earlier));
        let mut are_known = true;
        for task in self.batch.jobs.tasks() {
            for (kind, path) in task.kinds().into_iter().zip(task.outputs()?) {
                let added = outputs.add(&path, task.index);
                if let Some(first) = added.first {
                    let (list, path, first, second) =
                        (self.list.display(), path.display(), self.frame(first), &task.name);
                    let hint = "name what differs, as in {frame:04}";
                    return Err(Error::input(format!("{list}: {first} and {second} both write {path}; {hint}")));
                }
                if added.exists {
                    kind.check(&path).map_err(|e| e.at(format_args!("{}: {}", self.list.display(), task.name)))?;
                    are_known &= known.contains(&task.output_key(&path));
                }
            }
        }
        Ok(are_known)
    }

    /// Adds the files of the batch itself. Returns whether all that exist look like those of an earlier run.
    fn add_own(&self, outputs: &mut Outputs) -> Result<bool> {
        let asked = self.batch.beside.iter().map(|(path, kind)| (path, *kind));
        let mut are_known = true;
        let frames = self.batch.jobs.count();
        for (k, (path, kind)) in asked.chain([(&self.batch.paths.own, MANIFEST)]).enumerate() {
            let added = outputs.add(path, frames + k);
            if let Some(first) = added.first {
                let (path, first) = (path.display(), self.owner(first));
                return Err(Error::input(format!(
                    "{path}: {first} writes this file too; give each output its own name"
                )));
            }
            if added.exists && !kind.is_ours(path) {
                are_known = false;
                // first, as "is also an input" says more than "is not a table"
                self.refuse_inputs(outputs, self.inputs)?;
                kind.check(path)?;
            }
        }
        // a log is appended to, so it need not be replaced
        let whole = self.batch.beside.iter().filter(|(_, kind)| kind.name != LOG.name);
        whole.map(|(path, _)| path).try_for_each(|path| check_writable(path))?;
        Ok(are_known)
    }

    fn refuse_inputs(&self, outputs: &Outputs, inputs: &Inputs) -> Result<()> {
        outputs.first_input(inputs).map_or(Ok(()), |(input, owner)| Err(self.is_read(input, owner)))
    }

    fn is_read(&self, input: &Path, owner: usize) -> Error {
        let (list, input, owner) = (self.list.display(), input.display(), self.owner(owner));
        Error::input(format!("{list}: {owner} would replace {input}, an input; choose another name for the output"))
    }

    fn owner(&self, owner: usize) -> String {
        if owner < self.batch.jobs.count() { self.frame(owner) } else { "another output".into() }
    }

    fn frame(&self, index: usize) -> String {
        self.batch.jobs.tasks().nth(index).map(|task: Task| task.name).unwrap_or_default()
    }
}
