//! Files of the user that `new` and `example` must not replace.

use crate::image::check_writable;
use crate::input::{Error, Result};
use std::path::Path;

/// Refuses to replace a file with other content: it is another file, or somebody changed it. `option` chooses another place.
pub fn may_write(path: &Path, content: &[u8], option: &str) -> Result<()> {
    check_writable(path)?;
    if path.is_file() && std::fs::read(path).ok().as_deref() != Some(content) {
        let name = path.display();
        return Err(Error::work(format!("{name}: exists with other content; remove it or choose another {option}")));
    }
    Ok(())
}
