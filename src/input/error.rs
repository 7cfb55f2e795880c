//! The one error type: one line for a person, and the exit code it leads to.

/// What went wrong, as one line that says what, where (file, key or line) and what to do.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    /// The command line or an input file is wrong: exit code 2.
    #[error("{0}")]
    Input(String),
    /// The work itself failed (an output cannot be written, a device was lost): exit code 1.
    #[error("{0}")]
    Work(String),
    /// So it did, as there is no room to write to: what comes after it will fail too. Exit code 1.
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

    /// The same error with `place` (a file, a key, a mesh) said first.
    pub fn at(self, place: impl std::fmt::Display) -> Self {
        match self {
            Error::Input(m) => Error::Input(format!("{place}: {m}")),
            Error::Work(m) => Error::Work(format!("{place}: {m}")),
            Error::Full(m) => Error::Full(format!("{place}: {m}")),
        }
    }

    /// The exit code of a program that ends with it: 2 for input, else 1.
    pub fn exit_code(&self) -> u8 {
        match self {
            Error::Input(_) => 2,
            Error::Work(_) | Error::Full(_) => 1,
        }
    }
}
