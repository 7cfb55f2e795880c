//! Which names a file defines, and which it uses of others: by its tokens, with the scopes of WGSL's functions.

use std::collections::BTreeSet;

/// Names in the order of their first place.
#[derive(Debug, Default, PartialEq)]
pub struct Names {
    /// Functions, structs, constants, overrides, aliases and private variables.
    pub defined: Vec<String>,
    /// All names that are neither defined here nor a function's own: those of WGSL too.
    pub used: Vec<String>,
    /// It has an entry point.
    pub is_entry: bool,
}

/// Names, numbers, and all else character by character.
fn tokens(text: &str) -> Vec<&str> {
    let mut tokens = Vec::new();
    // neither imports nor choices of implementations
    for line in text.lines().filter(|line| !line.starts_with('#')) {
        let mut rest = line.split("//").next().unwrap_or_default();
        while let Some(first) = rest.chars().next() {
            let is_word = |c: char| c.is_ascii_alphanumeric() || c == '_';
            let mut end = rest.find(|c| !is_word(c)).unwrap_or(rest.len());
            if first.is_ascii_digit() {
                // 1.5e-3: a point, and a sign after the exponent's letter
                let in_number = |(k, c): (usize, char)| {
                    let exponent = k > 0 && matches!(rest.as_bytes()[k - 1], b'e' | b'E') && !rest.starts_with("0x");
                    is_word(c) || c == '.' || exponent && matches!(c, '+' | '-')
                };
                end = rest.char_indices().find(|c| !in_number(*c)).map_or(rest.len(), |c| c.0);
            }
            let (token, after) = rest.split_at(end.max(first.len_utf8()));
            if !token.trim().is_empty() {
                tokens.push(token);
            }
            rest = after;
        }
    }
    tokens
}

fn is_name(token: &str) -> bool {
    token.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_')
}

/// Scans a file.
pub fn names(text: &str) -> Names {
    let mut scan = Scan { tokens: tokens(text), ..Scan::default() };
    while scan.at < scan.tokens.len() {
        scan.item();
    }
    let defined: BTreeSet<&String> = scan.names.defined.iter().collect();
    let mut seen = BTreeSet::new();
    let used = scan.names.used.iter().filter(|n| !defined.contains(n) && seen.insert(n.as_str())).cloned().collect();
    Names { used, ..scan.names }
}

#[derive(Default)]
struct Scan<'a> {
    tokens: Vec<&'a str>,
    at: usize,
    names: Names,
    /// Names of a function's own, a set for each block around.
    scopes: Vec<BTreeSet<&'a str>>,
}

impl<'a> Scan<'a> {
    fn next(&mut self) -> &'a str {
        self.at += 1;
        self.tokens.get(self.at - 1).copied().unwrap_or_default()
    }

    fn peek(&self) -> &'a str {
        self.tokens.get(self.at).copied().unwrap_or_default()
    }

    /// A definition of the module.
    fn item(&mut self) {
        match self.next() {
            "@" => self.attribute(),
            "fn" => self.function(),
            "struct" => {
                self.define();
                self.next();
                self.until_end(&["}"], true);
            }
            "const" | "override" | "alias" => {
                self.define();
                self.until_end(&[";"], false);
            }
            "var" => {
                if self.peek() == "<" {
                    while self.next() != ">" {}
                }
                self.define();
                self.until_end(&[";"], false);
            }
            ";" => (),
            "enable" => self.until_end(&[";"], false),
            other => panic!("{other:?} begins nothing of a module"),
        }
    }

    fn define(&mut self) {
        let name = self.next().to_string();
        self.names.defined.push(name);
    }

    /// What `@` begins: names of WGSL's own, or numbers that constants may stand for.
    fn attribute(&mut self) {
        let name = self.next();
        let is_word = ["builtin", "interpolate"].contains(&name);
        self.names.is_entry |= ["compute", "vertex", "fragment"].contains(&name);
        if self.peek() == "(" {
            self.next();
            if is_word {
                while self.next() != ")" {}
            } else {
                self.until_end(&[")"], false);
            }
        }
    }

    fn function(&mut self) {
        self.define();
        self.next();
        self.scopes.push(BTreeSet::new());
        self.until_end(&[")"], true);
        while self.peek() != "{" {
            self.token(false);
        }
        self.next();
        self.block();
        self.scopes.pop();
    }

    /// The statements up to `}`.
    fn block(&mut self) {
        self.scopes.push(BTreeSet::new());
        while !["}", ""].contains(&self.peek()) {
            match self.peek() {
                "{" => {
                    self.next();
                    self.block();
                }
                "let" | "const" | "var" => self.local(),
                "for" => {
                    // what its head declares lives to the end of its body
                    self.at += 2;
                    self.scopes.push(BTreeSet::new());
                    if ["let", "const", "var"].contains(&self.peek()) {
                        self.local();
                    }
                    self.until_end(&["{"], false);
                    self.block();
                    self.scopes.pop();
                }
                _ => self.token(false),
            }
        }
        self.next();
        self.scopes.pop();
    }

    /// `let NAME = VALUE;`: the value may use another thing of the same name.
    fn local(&mut self) {
        self.next();
        if self.peek() == "<" {
            while self.next() != ">" {}
        }
        let name = self.next();
        self.until_end(&[";"], false);
        self.scopes.last_mut().expect("a function's block").insert(name);
    }

    /// Up to and with one of the ends, outside brackets; `NAME:` declares members or parameters where `declares`.
    fn until_end(&mut self, ends: &[&str], declares: bool) {
        while !ends.contains(&self.peek()) && !self.peek().is_empty() {
            let opened = self.peek();
            self.token(declares);
            match opened {
                "(" => self.until_end(&[")"], declares),
                "[" => self.until_end(&["]"], declares),
                _ => (),
            }
        }
        self.next();
    }

    fn token(&mut self, declares: bool) {
        let before = self.at.checked_sub(1).map(|k| self.tokens[k]).unwrap_or_default();
        let token = self.next();
        if token == "@" {
            self.attribute();
        } else if is_name(token) && before != "." {
            if declares && self.peek() == ":" {
                // members have no scope
                if let Some(scope) = self.scopes.last_mut() {
                    scope.insert(token);
                }
            } else if !self.scopes.iter().any(|s| s.contains(token)) {
                self.names.used.push(token.into());
            }
        }
    }
}

#[test]
fn names_are_told_from_members_and_locals() {
    let text = "
        struct Item { size: vec2<f32>, @size(PAD) mark: array<u32, COUNT>, } // struct Not {}
        const SMALL: f32 = 1.5e-3 * UNIT;
        var<private> stored: array<f32, SMALL_COUNT>;
        @compute @workgroup_size(GROUP) fn main(@builtin(workgroup_id) group: vec3<u32>) -> Answer {
            let first = first(group.mark, nodes[group.x].far);
            if first > 0x1Eu { let inner = 1.0lf; var<function> near = inner; }
            for (var k = limit; k < near; k++) { let last = k; step(last); }
            return Answer(k, last, stored[first], size);
        }";
    let Names { defined, used, is_entry } = names(text);
    assert!(is_entry && !names("fn main() {}").is_entry);
    assert_eq!(defined, ["Item", "SMALL", "stored", "main"]);
    let used: Vec<&str> = used.iter().map(String::as_str).filter(|n| !["array", "vec2", "vec3"].contains(n)).collect();
    let expected = [
        "f32",
        "PAD",
        "u32",
        "COUNT",
        "UNIT",
        "SMALL_COUNT",
        "GROUP",
        "Answer",
        "first",
        "nodes",
        "if",
        "limit",
        "near",
        "step",
        "return",
        "k",
        "last",
        "size",
    ];
    assert_eq!(used, expected);
}
