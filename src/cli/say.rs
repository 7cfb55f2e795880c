//! What reaches the terminal: text on stdout, errors and notes on stderr. Names of files and keys of scenes may hold anything, so control
//! characters are shown as `\u001b`, never sent.

use crate::error::{Error, Result};
use std::borrow::Cow;
use std::fmt::Display;
use std::io::{self, Write};

/// Characters of a line on stderr at most; of a longer one the middle is left out.
const LINE_MAX: usize = 2000;

/// Of these, so many are its end.
const LINE_END: usize = 500;

/// Puts an error on stderr, on one line.
pub fn complain(error: &Error) {
    note(format_args!("error: {error}"));
}

/// Puts a line on stderr for a person.
pub fn note(line: impl Display) {
    // with stderr gone there is nobody left to tell
    let _ = io::stderr().write_all((line_of(line) + "\n").as_bytes());
}

/// Writes `text` to stdout. A reader that has gone away is no error.
pub fn print(text: &str) -> Result<()> {
    let mut out = io::stdout().lock();
    match out.write_all(shown(text).as_bytes()).and_then(|()| out.flush()) {
        Err(e) if e.kind() != io::ErrorKind::BrokenPipe => Err(Error::work(format!("cannot write to stdout: {e}"))),
        _ => Ok(()),
    }
}

/// As one line that is not too long, whatever line breaks and control characters it holds.
pub fn line_of(text: impl Display) -> String {
    let text = text.to_string();
    let words: Vec<&str> = text.split_whitespace().collect();
    shortened(&shown(&words.join(" "))).into_owned()
}

/// Without characters that move the cursor, ring, or turn the direction of writing. They are spelled as JSON does, which stays the same JSON.
fn shown(text: &str) -> Cow<'_, str> {
    if !text.chars().any(is_hidden) {
        return text.into();
    }
    let spelled =
        |c: char| if is_hidden(c) { format!("\\u{:04x}", u32::from(c)).into() } else { Cow::from(String::from(c)) };
    text.chars().map(spelled).collect::<String>().into()
}

fn is_hidden(c: char) -> bool {
    let turns = matches!(c, '\u{200e}' | '\u{200f}' | '\u{61c}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    turns || (c.is_control() && !matches!(c, '\n' | '\t'))
}

fn shortened(line: &str) -> Cow<'_, str> {
    let length = line.chars().count();
    if length <= LINE_MAX {
        return line.into();
    }
    let at = |k: usize| line.char_indices().nth(k).map_or(line.len(), |(at, _)| at);
    let (start, end) = (&line[..at(LINE_MAX - LINE_END)], &line[at(length - LINE_END)..]);
    format!("{start} ... ({} characters left out) ... {end}", length - LINE_MAX).into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_cannot_command_the_terminal() {
        let line = line_of("a\u{1b}]0;owned\u{7}\n\r b\0\u{9b}31m\u{202e}c é\t日本");
        assert_eq!(line, "a\\u001b]0;owned\\u0007 b\\u0000\\u009b31m\\u202ec é 日本");
        // as JSON it says the same
        let json = serde_json::to_string("\u{7f}\u{9b}\u{1b}\u{202e}\"").unwrap();
        let printed = shown(&json);
        assert!(!printed.chars().any(is_hidden) && printed != json);
        assert_eq!(serde_json::from_str::<String>(&printed).unwrap(), "\u{7f}\u{9b}\u{1b}\u{202e}\"");
        assert!(matches!(shown("two\nlines\t{}"), Cow::Borrowed("two\nlines\t{}")));
    }

    #[test]
    fn a_long_line_keeps_its_start_and_its_end() {
        let long = format!("first {} last", "ä".repeat(100_000));
        let line = line_of(&long);
        assert!(line.starts_with("first ää") && line.ends_with("ää last"), "{line}");
        assert!(line.contains(" ... (98011 characters left out) ... "), "{line}");
        assert!(line.chars().count() < LINE_MAX + 50);
        let whole = "x".repeat(LINE_MAX);
        assert_eq!(line_of(&whole), whole);
    }
}
