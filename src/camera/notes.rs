//! Lines for the user about a camera's rays.

use std::fmt;
use std::ops::Deref;
use std::sync::{Arc, LazyLock};

/// Lines that say what was left out or approximated.
#[derive(Clone)]
pub enum Notes {
    Known(Vec<String>),
    /// Worked out when they are first read.
    Later(Arc<Lines>),
}

type Lines = LazyLock<Vec<String>, Box<dyn FnOnce() -> Vec<String> + Send>>;

impl Notes {
    /// Lines that take time to work out.
    pub fn later(lines: impl FnOnce() -> Vec<String> + Send + 'static) -> Notes {
        Notes::Later(Arc::new(LazyLock::new(Box::new(lines))))
    }

    pub fn push(&mut self, line: String) {
        self.extend([line]);
    }
}

impl Extend<String> for Notes {
    fn extend<T: IntoIterator<Item = String>>(&mut self, lines: T) {
        match self {
            Notes::Known(known) => known.extend(lines),
            Notes::Later(first) => {
                let (first, more) = (first.clone(), Vec::from_iter(lines));
                *self = Notes::later(move || [&first[..], &more].concat());
            }
        }
    }
}

impl Default for Notes {
    fn default() -> Notes {
        Notes::Known(Vec::new())
    }
}

impl From<Vec<String>> for Notes {
    fn from(lines: Vec<String>) -> Notes {
        Notes::Known(lines)
    }
}

impl Deref for Notes {
    type Target = [String];

    fn deref(&self) -> &[String] {
        match self {
            Notes::Known(lines) => lines,
            Notes::Later(lines) => lines,
        }
    }
}

impl fmt::Debug for Notes {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.debug_list().entries(self.iter()).finish()
    }
}

impl PartialEq for Notes {
    fn eq(&self, other: &Notes) -> bool {
        **self == **other
    }
}

impl Eq for Notes {}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicU32, Ordering};

    #[test]
    fn later_lines_are_worked_out_once_and_only_if_read() {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let mut notes = Notes::later(|| {
            COUNT.fetch_add(1, Ordering::Relaxed);
            vec!["first".into()]
        });
        let first = notes.clone();
        notes.push("second".into());
        assert_eq!(COUNT.load(Ordering::Relaxed), 0);
        assert_eq!(format!("{notes:?}"), r#"["first", "second"]"#);
        assert_eq!((first.len(), notes.len(), COUNT.load(Ordering::Relaxed)), (1, 2, 1));
    }
}
