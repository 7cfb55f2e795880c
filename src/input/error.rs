//! The error type: a one-line message, and its exit code.

use super::limits::memory::ADVICE;
use std::path::Path;

/// An error message of one line: what is wrong, where (file, key or line), and the remedy.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    /// The command line or an input file is wrong: exit code 2.
    #[error("{0}")]
    Input(String),
    /// An input file does not exist: exit code 2.
    #[error("{0}")]
    Missing(String),
    /// An input file cannot be read: exit code 2.
    #[error("{0}")]
    Read(String),
    /// The work itself failed (memory does not suffice, a device was lost): exit code 1.
    #[error("{0}")]
    Work(String),
    /// An output file cannot be written: exit code 1.
    #[error("{0}")]
    Write(String),
    /// An output file cannot be written because the disk is full, so later ones cannot either: exit code 1.
    #[error("{0}")]
    Full(String),
}

/// With this crate's [`Error`].
pub type Result<T> = std::result::Result<T, Error>;

impl Error {
    /// An [`Error::Input`].
    pub fn input(message: impl Into<String>) -> Self {
        Error::Input(message.into())
    }

    /// An [`Error::Read`], or [`Error::Missing`]: `path` cannot be read, because of `why`; an [`Error::Work`] if `why` is too little memory.
    pub(crate) fn unreadable(path: &Path, why: impl std::fmt::Display) -> Self {
        let why = why.to_string();
        if let Some(at) = why.find(ADVICE) {
            return Error::work(format!("{}: {}", path.display(), &why[..at + ADVICE.len()]));
        }
        let text = format!("{}: cannot be read: {why}", path.display());
        match path.try_exists() {
            Ok(false) => Error::Missing(text),
            _ => Error::Read(text),
        }
    }

    /// An [`Error::Write`]: `path` cannot be written, because of `why`.
    pub(crate) fn unwritable(path: &Path, why: impl std::fmt::Display) -> Self {
        Error::Write(format!("{}: {why}", path.display()))
    }

    /// An [`Error::Work`].
    pub fn work(message: impl Into<String>) -> Self {
        Error::Work(message.into())
    }

    /// The same error, prefixed with `place` (a file, a key, a mesh).
    pub fn at(mut self, place: impl std::fmt::Display) -> Self {
        let (Error::Input(text)
        | Error::Missing(text)
        | Error::Read(text)
        | Error::Work(text)
        | Error::Write(text)
        | Error::Full(text)) = &mut self;
        *text = format!("{place}: {text}");
        self
    }

    /// The program's exit code: 2 for input and its files, else 1.
    pub fn exit_code(&self) -> u8 {
        match self {
            Error::Input(_) | Error::Missing(_) | Error::Read(_) => 2,
            Error::Work(_) | Error::Write(_) | Error::Full(_) => 1,
        }
    }
}
