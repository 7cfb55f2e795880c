//! Text to stdout, errors and notes to stderr. File names and scene keys may contain anything, so control characters are escaped, as in
//! `\u001b`.

use super::pages::page_of;
use crate::input::{Error, Result};
use std::borrow::Cow;
use std::fmt::Display;
use std::io::{self, Write};

/// The longest line on stderr, in characters: some 12 lines of a terminal. The middle of a longer one is left out.
const LINE_MAX: usize = 1000;

/// Characters kept from the end of the line, which has the advice.
const LINE_END: usize = 400;

/// Prints an error to stderr, on one line, with the page that explains it.
pub fn complain(error: &Error) {
    let text = error.to_string();
    let page = page_of(&text).map_or(String::new(), |page| format!(" (see {page})"));
    note(format_args!("error: {text}{page}"));
}

/// Prints a line to stderr.
pub fn note(line: impl Display) {
    // a closed stderr is no reason to stop
    let _ = io::stderr().write_all((line_of(line) + "\n").as_bytes());
}

/// Writes `text` to stdout. A closed pipe is not an error.
pub fn print(text: &str) -> Result<()> {
    let mut out = io::stdout().lock();
    match out.write_all(escaped(text).as_bytes()).and_then(|()| out.flush()) {
        Err(e) if e.kind() != io::ErrorKind::BrokenPipe => Err(Error::work(format!("cannot write to stdout: {e}"))),
        _ => Ok(()),
    }
}

/// The text on one line of at most [`LINE_MAX`] characters and a few, with control characters escaped.
pub fn line_of(text: impl Display) -> String {
    let text = text.to_string();
    let words: Vec<&str> = text.split_whitespace().collect();
    shortened(&escaped(&words.join(" "))).into_owned()
}

/// Escapes control characters, and those that change the direction of text, as JSON strings do: JSON text keeps its meaning.
fn escaped(text: &str) -> Cow<'_, str> {
    if !text.chars().any(is_escaped) {
        return text.into();
    }
    let escape =
        |c: char| if is_escaped(c) { format!("\\u{:04x}", u32::from(c)).into() } else { Cow::from(String::from(c)) };
    text.chars().map(escape).collect::<String>().into()
}

fn is_escaped(c: char) -> bool {
    let is_bidi = matches!(c, '\u{200e}' | '\u{200f}' | '\u{61c}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    is_bidi || (c.is_control() && !matches!(c, '\n' | '\t'))
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
    fn control_characters_are_escaped() {
        let line = line_of("a\u{1b}]0;owned\u{7}\n\r b\0\u{9b}31m\u{202e}c é\t日本");
        assert_eq!(line, "a\\u001b]0;owned\\u0007 b\\u0000\\u009b31m\\u202ec é 日本");
        // JSON text keeps its meaning
        let json = serde_json::to_string("\u{7f}\u{9b}\u{1b}\u{202e}\"").unwrap();
        let printed = escaped(&json);
        assert!(!printed.chars().any(is_escaped) && printed != json);
        assert_eq!(serde_json::from_str::<String>(&printed).unwrap(), "\u{7f}\u{9b}\u{1b}\u{202e}\"");
        assert!(matches!(escaped("two\nlines\t{}"), Cow::Borrowed("two\nlines\t{}")));
    }

    #[test]
    fn a_long_line_keeps_its_start_and_its_end() {
        let long = format!("first {} last", "ä".repeat(100_000));
        let line = line_of(&long);
        assert!(line.starts_with("first ää") && line.ends_with("ää last"), "{line}");
        let left_out = long.chars().count() - LINE_MAX;
        assert!(line.contains(&format!(" ... ({left_out} characters left out) ... ")), "{line}");
        assert!(line.chars().count() < LINE_MAX + 50);
        let whole = "x".repeat(LINE_MAX);
        assert_eq!(line_of(&whole), whole);
    }
}
