//! What `cargo fuzz` runs where there is a nightly toolchain, over a corpus and texts that are changed at random: nothing panics, and what
//! is refused is refused in one line.

#[path = "../fuzz/targets.rs"]
mod targets;

use std::path::Path;

/// Changed texts a target; as many as `ANAMORPH_FUZZ` says.
fn rounds() -> usize {
    std::env::var("ANAMORPH_FUZZ").ok().and_then(|n| n.parse().ok()).unwrap_or(1500)
}

/// Every file of the target's folder in `fuzz/corpus`: what to begin with, and what once failed.
fn corpus(target: &str) -> Vec<Vec<u8>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/corpus").join(target);
    let mut paths: Vec<_> = std::fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    assert!(!paths.is_empty(), "{}: no files", folder.display());
    paths.iter().map(|path| std::fs::read(path).unwrap()).collect()
}

/// What parsers stumble over.
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

/// SplitMix64.
struct Rng(u64);

impl Rng {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) % n.max(1) as u64) as usize
    }
}

/// One to four changes: a byte, a token, a part left out, twice, or of another text.
fn changed(all: &[Vec<u8>], rng: &mut Rng) -> Vec<u8> {
    let mut text = all[rng.below(all.len())].clone();
    for _ in 0..1 + rng.below(4) {
        let at = rng.below(text.len() + 1);
        let end = (at + 1 + rng.below(12)).min(text.len());
        match rng.below(6) {
            0 if at < text.len() => text[at] = rng.below(256) as u8,
            1 => drop(text.splice(at..at.max(end), [])),
            2 => drop(text.splice(at..at, TOKENS[rng.below(TOKENS.len())].iter().copied())),
            // a word by a token
            3 => {
                let from =
                    text[..at].iter().rposition(|b| !b.is_ascii_alphanumeric() && *b != b'.').map_or(0, |k| k + 1);
                let to = text[at..]
                    .iter()
                    .position(|b| !b.is_ascii_alphanumeric() && *b != b'.')
                    .map_or(text.len(), |k| at + k);
                drop(text.splice(from..to, TOKENS[rng.below(TOKENS.len())].iter().copied()));
            }
            4 => {
                let part = text[at..at.max(end)].to_vec();
                drop(text.splice(at..at, part));
            }
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

fn run(target: &str, function: fn(&[u8]), rounds: usize) {
    let all = corpus(target);
    all.iter().for_each(|data| function(data));
    let mut rng = Rng(target.len() as u64);
    for _ in 0..rounds {
        let text = changed(&all, &mut rng);
        let outcome = std::panic::catch_unwind(|| function(&text));
        assert!(outcome.is_ok(), "{target}: this panics:\n{}", String::from_utf8_lossy(&text));
    }
}

#[test]
fn scene_files() {
    run("scene", targets::scene, rounds());
}

#[test]
fn obj_files() {
    run("obj", targets::obj, rounds());
}

#[test]
fn gltf_files() {
    run("gltf", targets::gltf, rounds());
}

#[test]
fn height_images() {
    run("heights", targets::heights, rounds());
}

#[test]
fn cameras() {
    run("camera", targets::camera, rounds());
}

/// Random bytes are numbers too.
#[test]
fn small_frames() {
    run("frame", targets::frame, rounds() / 15);
}
