//! Output files, looked at before any work is done.

use crate::error::{Error, Result};
use crate::output::check_writable;
use std::path::{Path, PathBuf};

/// Finds that one of `outputs` cannot be written, is another one of them too, or is the scene itself.
///
/// # Errors
/// [`Error::Input`] for one file named twice, [`Error::Work`] for one that cannot be written.
pub fn check<'a>(scene: &Path, outputs: impl Iterator<Item = &'a Path>) -> Result<()> {
    let mut taken: Vec<PathBuf> = vec![scene.into()];
    for path in outputs {
        // devices may take more than one
        let is_own = !path.exists() || path.is_file();
        if is_own && taken.iter().any(|t| same(t, path)) {
            let name = path.display();
            return Err(Error::input(format!("{name}: named twice; give each output a name of its own")));
        }
        taken.push(path.into());
        check_writable(path)?;
    }
    Ok(())
}

/// Both paths are one file, as far as their names and links tell.
fn same(a: &Path, b: &Path) -> bool {
    let whole = |p: &Path| {
        let folder = p.parent().filter(|f| !f.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let in_folder = |f: PathBuf| Some(f.join(p.file_name()?));
        p.canonicalize().ok().or_else(|| folder.canonicalize().ok().and_then(in_folder))
    };
    a == b || whole(a).is_some_and(|a| whole(b) == Some(a))
}
