//! Lines, tokens and numbers of OBJ, MTL and STL text.

use std::borrow::Cow;

/// A text whose lines end in carriage returns alone, as old Macs wrote them, with line feeds instead; any other text as it is.
pub(super) fn with_line_feeds(text: &[u8]) -> Cow<'_, [u8]> {
    if text.contains(&b'\n') || !text.contains(&b'\r') {
        return Cow::Borrowed(text);
    }
    Cow::Owned(text.iter().map(|&b| if b == b'\r' { b'\n' } else { b }).collect())
}

/// Splits `text` into pieces of at least `bytes` bytes (the last one may be shorter), each ending at a line end
/// that no backslash continues.
pub(super) fn split_at_line_ends(text: &[u8], bytes: usize) -> Vec<&[u8]> {
    let mut pieces = Vec::new();
    let mut rest = text;
    while rest.len() > bytes {
        let mut end = bytes;
        while end < rest.len() && (rest[end - 1] != b'\n' || is_continued(&rest[..end - 1])) {
            end += 1;
        }
        let (piece, after) = rest.split_at(end);
        pieces.push(piece);
        rest = after;
    }
    if !rest.is_empty() {
        pieces.push(rest);
    }
    pieces
}

/// The line without its line end goes on in the next one.
fn is_continued(line: &[u8]) -> bool {
    line.strip_suffix(b"\r").unwrap_or(line).ends_with(b"\\")
}

/// Logical lines: continued ones joined (a comment does not continue), with the number of the first, from 0.
pub(super) struct Lines<'a> {
    rest: &'a [u8],
    number: usize,
}

impl<'a> Lines<'a> {
    pub(super) fn new(text: &'a [u8]) -> Self {
        Lines { rest: text, number: 0 }
    }

    /// Lines handed out so far, each part of a continued one counted.
    pub(super) fn read_so_far(&self) -> usize {
        self.number
    }

    fn next_physical(&mut self) -> Option<&'a [u8]> {
        if self.rest.is_empty() {
            return None;
        }
        self.number += 1;
        let (line, rest) = match self.rest.iter().position(|&b| b == b'\n') {
            Some(end) => (&self.rest[..end], &self.rest[end + 1..]),
            None => (self.rest, &[][..]),
        };
        self.rest = rest;
        Some(line)
    }

    /// Joins what follows a continued line, backslashes and line ends as blanks.
    #[cold]
    fn join(&mut self, first: &'a [u8]) -> Vec<u8> {
        let mut joined = Vec::new();
        let mut part = first;
        while is_continued(part) {
            let kept = part.strip_suffix(b"\r").unwrap_or(part);
            joined.extend_from_slice(&kept[..kept.len() - 1]);
            joined.push(b' ');
            part = self.next_physical().unwrap_or_default();
        }
        joined.extend_from_slice(part);
        joined
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = (usize, Cow<'a, [u8]>);

    fn next(&mut self) -> Option<Self::Item> {
        let number = self.number;
        let line = self.next_physical()?;
        if is_continued(line) && Tokens::new(line).next().is_some() {
            return Some((number, Cow::Owned(self.join(line))));
        }
        Some((number, Cow::Borrowed(line)))
    }
}

/// The blank-separated tokens of a line, up to a comment.
#[derive(Clone)]
pub(super) struct Tokens<'a> {
    rest: &'a [u8],
}

impl<'a> Tokens<'a> {
    pub(super) fn new(line: &'a [u8]) -> Self {
        Tokens { rest: line }
    }

    /// Everything after the tokens read so far, without blanks around it: a name with blanks in it.
    pub(super) fn name(&self) -> String {
        String::from_utf8_lossy(self.rest.trim_ascii()).into_owned()
    }
}

impl<'a> Iterator for Tokens<'a> {
    type Item = &'a [u8];

    fn next(&mut self) -> Option<&'a [u8]> {
        let start = self.rest.iter().position(|b| !b.is_ascii_whitespace())?;
        let rest = &self.rest[start..];
        if rest[0] == b'#' {
            self.rest = &[];
            return None;
        }
        let end = rest.iter().position(|b| b.is_ascii_whitespace()).unwrap_or(rest.len());
        let (token, rest) = rest.split_at(end);
        self.rest = rest;
        Some(token)
    }
}

/// A token as it may stand in a message: printable, short, in quotes.
pub(super) fn quoted(token: &[u8]) -> String {
    const LONGEST: usize = 24;
    let text = String::from_utf8_lossy(token);
    let mut short: String = text.chars().take(LONGEST).map(|c| if c.is_control() { '?' } else { c }).collect();
    if text.chars().count() > LONGEST {
        short.push_str("...");
    }
    format!("\"{short}\"")
}

/// Why a text that goes on after a zero byte is refused.
pub(super) const HAS_ZEROS: &str = "has zero bytes in its text; is it damaged?";

/// The f64 nearest to the decimal number, ties to even; `None` if the token is no number. May be infinite or NaN.
pub(super) fn parse_f64(token: &[u8]) -> Option<f64> {
    parse_short_decimal(token).or_else(|| std::str::from_utf8(token).ok()?.parse().ok())
}

/// 10^k, k = 0..=22: all of them exact in f64, since 5^22 < 2^53.
const EXACT_POWERS_OF_TEN: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20,
    1e21, 1e22,
];

/// `-ddd.ddd` without an exponent, where at most 2^53 stands over at most 10^22: then both are exact and the one
/// division rounds correctly. `None` is left to the general parser.
fn parse_short_decimal(token: &[u8]) -> Option<f64> {
    /// 19 digits cannot overflow a u64.
    const MOST_DIGITS: usize = 19;
    let (negative, digits) = match token {
        [b'-', rest @ ..] => (true, rest),
        _ => (false, token),
    };
    let mut mantissa = 0u64;
    let mut point = None;
    for (at, &b) in digits.iter().enumerate() {
        match b {
            b'0'..=b'9' => mantissa = mantissa.wrapping_mul(10).wrapping_add(u64::from(b - b'0')),
            b'.' if point.is_none() => point = Some(at),
            _ => return None,
        }
    }
    let count = digits.len() - usize::from(point.is_some());
    if count == 0 || count > MOST_DIGITS || mantissa > 1 << 53 {
        return None;
    }
    let places = point.map_or(0, |at| digits.len() - at - 1);
    let value = mantissa as f64 / EXACT_POWERS_OF_TEN[places];
    Some(if negative { -value } else { value })
}

/// A decimal integer with an optional sign; `None` if the token is something else or does not fit.
pub(super) fn parse_i64(token: &[u8]) -> Option<i64> {
    let (negative, digits) = match token {
        [b'-', rest @ ..] => (true, rest),
        [b'+', rest @ ..] => (false, rest),
        _ => (false, token),
    };
    // 18 digits cannot overflow.
    if digits.is_empty() || digits.len() > 18 {
        return None;
    }
    let mut value = 0i64;
    for &b in digits {
        if !b.is_ascii_digit() {
            return None;
        }
        value = value * 10 + i64::from(b - b'0');
    }
    Some(if negative { -value } else { value })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn continued_lines_are_one_and_keep_their_number() {
        let mut lines = Lines::new(b"f 1 \\\r\n 2 \\\n3\r\n# path\\\nv 1");
        assert_eq!(lines.next(), Some((0, Cow::Owned(b"f 1   2  3\r".to_vec()))));
        assert_eq!(lines.next(), Some((3, Cow::Borrowed(&b"# path\\"[..]))));
        assert_eq!(lines.next(), Some((4, Cow::Borrowed(&b"v 1"[..]))));
        assert_eq!((lines.next(), lines.read_so_far()), (None, 5));
    }

    #[test]
    fn pieces_end_at_line_ends_and_join_to_the_text() {
        let text = b"v 1\nv 2\\\n3\n\nf 1 2 3 4 5 6 7\nx";
        for bytes in 1..text.len() + 2 {
            let pieces = split_at_line_ends(text, bytes);
            assert_eq!(pieces.concat(), text);
            assert!(pieces[..pieces.len() - 1].iter().all(|p| p.ends_with(b"\n") && !p.ends_with(b"\\\n")));
        }
    }

    #[test]
    fn words_stop_at_comments() {
        let tokens: Vec<&[u8]> = Tokens::new(b" f\t1#2  #3 4\r").collect();
        assert_eq!(tokens, [&b"f"[..], b"1#2"]);
    }

    #[test]
    fn numbers_that_are_none() {
        for token in ["", "-", ".", "+", "1,0", "0x10", "1.2.3", "--1", "e5", "1e", "1_0"] {
            assert_eq!(parse_f64(token.as_bytes()), None, "{token}");
        }
        for token in ["", "-", "1.0", "1/2", "99999999999999999999"] {
            assert_eq!(parse_i64(token.as_bytes()), None, "{token}");
        }
        assert_eq!(parse_i64(b"-12"), Some(-12));
        assert_eq!(parse_f64(b"-0").map(f64::to_bits), Some((-0.0f64).to_bits()));
    }

    proptest! {
        #[test]
        fn numbers_round_as_std_does(token in "[-+]?[0-9]{0,21}(\\.[0-9]{0,24})?([eE][-+]?[0-9]{1,3})?") {
            let expected = token.parse::<f64>().ok().map(f64::to_bits);
            prop_assert_eq!(parse_f64(token.as_bytes()).map(f64::to_bits), expected);
        }
    }
}
