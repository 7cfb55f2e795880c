//! The value tree of a file: TOML, JSON, or a job per line.

use super::parse::{self, Format};
use super::reader::{Field, Source};
use super::{Error, Loading, Result};
use std::path::Path;

/// The value tree of another file that is written like a scene: a .toml, a .json, or a .jsonl with a job per line.
///
/// # Errors
/// [`Error::Input`], one line, with the file and the line; or those of `read`.
pub(crate) fn with_tree<T>(path: &Path, loading: &Loading, read: impl FnOnce(&Field) -> Result<T>) -> Result<T> {
    let text = read_text(path, loading)?;
    let root = if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("jsonl")) {
        parse::parse(&parse::listed("job", &text), Format::Json, path)?
    } else {
        parse::parse(&text, Format::of(path)?, path)?
    };
    let source = Source::new(path, path.parent().unwrap_or(Path::new("")), loading);
    read(&Field::new(&source, "", &root))
}

/// The text of a scene file.
pub(crate) fn read_text(path: &Path, loading: &Loading) -> Result<String> {
    let cannot = |why: &dyn std::fmt::Display| Error::unreadable(path, why);
    let bytes = loading.read_or_pipe(path).map_err(|e| cannot(&format_args!("{e}; check the path")))?;
    String::from_utf8(bytes).map_err(|e| {
        let line = 1 + e.as_bytes()[..e.utf8_error().valid_up_to()].iter().filter(|b| **b == b'\n').count();
        cannot(&format_args!("line {line} is not UTF-8 text; save it as UTF-8"))
    })
}
