//! Random mutations of files, of kinds that break parsers or once found a defect.

#![allow(dead_code)]

use std::path::Path;

/// The files of a folder of `fuzz/corpus`: files to start from, and cases that once failed.
pub fn corpus(target: &str) -> Vec<Vec<u8>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/corpus").join(target);
    let mut paths: Vec<_> = std::fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    assert!(!paths.is_empty(), "{}: no files", folder.display());
    paths.iter().map(|path| std::fs::read(path).unwrap()).collect()
}

/// Tokens that break parsers.
const TOKENS: [&[u8]; 24] = [
    b"nan",
    b"inf",
    b"-inf",
    b"-1",
    b"0",
    b"1e308",
    b"-1e-320",
    b"1e999",
    b"99999999999999999999",
    b"[",
    b"]",
    b"{",
    b"}",
    b"\"",
    b"#",
    b"\n",
    b",",
    b"=",
    b"null",
    b"true",
    b"\\",
    b"\xff\xfe",
    b"..",
    b"/",
];

/// Replacements of numbers: large, small, and at the ends of ranges.
const NUMBERS: [&[u8]; 18] = [
    b"1e200",
    b"-1e200",
    b"1e308",
    b"1e30",
    b"1e-12",
    b"1e-200",
    b"4.9e-324",
    b"100000",
    b"1000000",
    b"1000001",
    b"100000000",
    b"268435456",
    b"4294967295",
    b"4294967296",
    b"9223372036854775807",
    b"-0.0",
    b"0.9999999999999999",
    b"1e15",
];

/// Replacements of names: endless files, files that block, folders, files elsewhere, and names with control characters. `fifo` may be a
/// pipe without a writer beside the file.
pub const NAMES: [&[u8]; 12] = [
    b"/dev/zero",
    b"/dev/null",
    b"/dev/full",
    b"/dev/tty",
    b"/proc/self/mem",
    b"fifo",
    b".",
    b"../../../../../../etc/passwd",
    b"\\u001b[31m\\u0007",
    b"\x1b]0;x\x07",
    b"\\u0000",
    b"self",
];

/// SplitMix64.
pub struct Rng(pub u64);

impl Rng {
    pub fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) % n.max(1) as u64) as usize
    }
}

/// Whether quoted names are replaced by [`NAMES`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Names {
    Kept,
    Replaced,
}

/// One of the files with one to four mutations: a byte or token changed or inserted, a part removed, repeated or taken from another file, a
/// number or name replaced, brackets nested, a line made long or repeated.
pub fn changed(all: &[Vec<u8>], names: Names, rng: &mut Rng) -> Vec<u8> {
    let mut text = all[rng.below(all.len())].clone();
    for _ in 0..1 + rng.below(4) {
        let at = rng.below(text.len() + 1);
        let end = (at + 1 + rng.below(12)).min(text.len());
        match rng.below(12) {
            0 if at < text.len() => text[at] = rng.below(256) as u8,
            1 => drop(text.splice(at..at.max(end), [])),
            2 => drop(text.splice(at..at, TOKENS[rng.below(TOKENS.len())].iter().copied())),
            3 => replace_word(&mut text, at, TOKENS[rng.below(TOKENS.len())]),
            4 => {
                let part = text[at..at.max(end)].to_vec();
                drop(text.splice(at..at, part));
            }
            5..=7 => replace_number(&mut text, at, NUMBERS[rng.below(NUMBERS.len())]),
            8 if names == Names::Replaced => replace_quoted(&mut text, at, NAMES[rng.below(NAMES.len())]),
            9 => nest(&mut text, at, rng),
            10 => {
                let long = [b"x", b" ", b"9", b"/"][rng.below(4)].repeat(1 << (6 + rng.below(11)));
                drop(text.splice(at..at, long));
            }
            11 => repeat_line(&mut text, at, 1 << rng.below(10)),
            _ => {
                let other = &all[rng.below(all.len())];
                let from = rng.below(other.len() + 1);
                let part = other[from..(from + rng.below(40)).min(other.len())].to_vec();
                drop(text.splice(at..at, part));
            }
        }
    }
    text
}

fn is_of_word(byte: u8) -> bool {
    byte.is_ascii_alphanumeric() || byte == b'.'
}

/// Replaces the word at a position.
fn replace_word(text: &mut Vec<u8>, at: usize, by: &[u8]) {
    let from = text[..at].iter().rposition(|b| !is_of_word(*b)).map_or(0, |k| k + 1);
    let to = text[at..].iter().position(|b| !is_of_word(*b)).map_or(text.len(), |k| at + k);
    drop(text.splice(from..to, by.iter().copied()));
}

/// Replaces the next number.
fn replace_number(text: &mut Vec<u8>, at: usize, by: &[u8]) {
    let is_first = |k: &usize| text[*k].is_ascii_digit() && (*k == 0 || !is_of_word(text[*k - 1]));
    if let Some(from) = (at..text.len()).find(is_first).or_else(|| (0..text.len()).find(is_first)) {
        replace_word(text, from, by);
    }
}

/// Replaces the next quoted text.
fn replace_quoted(text: &mut Vec<u8>, at: usize, by: &[u8]) {
    let quotes: Vec<usize> = (0..text.len()).filter(|k| text[*k] == b'"').collect();
    let n = quotes.iter().position(|k| *k >= at).unwrap_or(0) & !1;
    if let [from, to, ..] = quotes[n..] {
        drop(text.splice(from + 1..to, by.iter().copied()));
    }
}

/// Inserts opening brackets of one kind, and as many closing ones or none.
fn nest(text: &mut Vec<u8>, at: usize, rng: &mut Rng) {
    let (open, close) =
        [(&b"["[..], &b"]"[..]), (b"{a = ", b"}"), (b"{\"a\":", b"}"), (b"(", b")"), (b"a.", b"")][rng.below(5)];
    let depth = 1 << rng.below(14);
    let mut all = open.repeat(depth);
    if rng.below(2) == 0 {
        all.extend(close.repeat(depth));
    }
    drop(text.splice(at..at, all));
}

fn repeat_line(text: &mut Vec<u8>, at: usize, times: usize) {
    let from = text[..at].iter().rposition(|b| *b == b'\n').map_or(0, |k| k + 1);
    let to = text[at..].iter().position(|b| *b == b'\n').map_or(text.len(), |k| at + k + 1);
    let lines = text[from..to].repeat(times);
    drop(text.splice(from..from, lines));
}
