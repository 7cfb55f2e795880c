//! The error type: a one-line message, and its exit code.

/// An error message of one line: what is wrong, where (file, key or line), and the remedy.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    /// The command line or an input file is wrong: exit code 2.
    #[error("{0}")]
    Input(String),
    /// The work itself failed (an output cannot be written, a device was lost): exit code 1.
    #[error("{0}")]
    Work(String),
    /// The work failed because the disk is full, so later work will fail too: exit code 1.
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

    /// An [`Error::Work`].
    pub fn work(message: impl Into<String>) -> Self {
        Error::Work(message.into())
    }

    /// The same error, prefixed with `place` (a file, a key, a mesh).
    pub fn at(self, place: impl std::fmt::Display) -> Self {
        match self {
            Error::Input(m) => Error::Input(format!("{place}: {m}")),
            Error::Work(m) => Error::Work(format!("{place}: {m}")),
            Error::Full(m) => Error::Full(format!("{place}: {m}")),
        }
    }

    /// The program's exit code: 2 for input, else 1.
    pub fn exit_code(&self) -> u8 {
        match self {
            Error::Input(_) => 2,
            Error::Work(_) | Error::Full(_) => 1,
        }
    }
}
