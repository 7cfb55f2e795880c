//! A kernel, joined from its entry file and all that it imports.

use super::files::{Access, Binding, File, Files, Line};
use super::variant::Variant;
use crate::image::frame::Channel;
use std::collections::BTreeSet;
use std::path::Path;

/// One compute kernel, ready to compile.
#[derive(Debug, Clone)]
pub struct Kernel {
    /// The entry point's name, or the entry file's where it has several.
    pub name: &'static str,
    /// Each file after those that it imports, the entry file last.
    pub files: Vec<&'static File>,
    pub constants: Vec<(&'static str, f64)>,
    pub imports: Vec<Import>,
}

/// An import of a kernel's file.
#[derive(Debug, Clone, Copy)]
pub struct Import {
    /// The path of the file that names it.
    pub by: &'static str,
    /// As it is written there.
    pub name: &'static str,
    /// `None`: there is no such file.
    pub file: Option<&'static File>,
}

/// The implementations of an interface, the preferred one first; none if it is no interface.
pub type Choose<'a> = &'a dyn Fn(&str) -> &'static [&'static str];

/// The files and imports found so far while a kernel is joined.
struct Joiner<'a> {
    library: &'a Files,
    choose: Choose<'a>,
    seen: BTreeSet<&'static str>,
    files: Vec<&'static File>,
    imports: Vec<Import>,
}

impl Joiner<'_> {
    fn add(&mut self, file: &'static File) {
        if !self.seen.insert(file.path) {
            return;
        }
        for import in &file.imports {
            let imported = self.library.imported(import, self.choose);
            self.imports.push(Import { by: file.path, name: import, file: imported });
            if let Some(imported) = imported {
                self.add(imported);
            }
        }
        self.files.push(file);
    }
}

impl Kernel {
    /// The kernel of an entry file for a variant whose frames have these planes.
    pub fn new(entry: &'static str, variant: Variant, planes: &[Channel]) -> Kernel {
        let constant = |name: &str| variant.constant(name, planes);
        Kernel::of(Files::own(), entry, &|interface| variant.implementations(interface), &constant)
    }

    /// A kernel that is the same for all variants.
    pub fn alone(entry: &'static str) -> Kernel {
        Kernel::of(Files::own(), entry, &|_| &[], &|_| None)
    }

    /// Joins a kernel from the files of a library; `constant` has the values of `override` constants that are not the default ones.
    pub fn of(library: &Files, entry: &'static str, choose: Choose, constant: &dyn Fn(&str) -> Option<f64>) -> Kernel {
        let file = library.get(entry);
        let chosen = file.map_or(&[][..], |file| &file.chosen);
        let choose = |interface: &str| {
            let own = chosen.iter().find(|(name, _)| *name == interface);
            own.map_or_else(|| choose(interface), |(_, implementation)| std::slice::from_ref(implementation))
        };
        let (seen, files, imports) = (BTreeSet::new(), Vec::new(), Vec::new());
        let mut joiner = Joiner { library, choose: &choose, seen, files, imports };
        match file {
            Some(file) => joiner.add(file),
            None => joiner.imports.push(Import { by: entry, name: entry, file: None }),
        }
        let constants = joiner.files.iter().flat_map(|file| &file.constants);
        let constants = constants.filter_map(|name| Some((*name, constant(name)?))).collect();
        let stem = Path::new(entry).file_stem().and_then(|stem| stem.to_str()).unwrap_or(entry);
        let name = file.and_then(File::entry_point).unwrap_or(stem);
        Kernel { name, files: joiner.files, constants, imports: joiner.imports }
    }

    /// It computes with f64, in 32-bit words where an adapter has none.
    pub fn has_f64(&self) -> bool {
        self.files.iter().any(|file| file.path == "arithmetic/f64.wgsl")
    }

    /// What its files declare: the number of each is its place. Two files may declare the same.
    pub fn bindings(&self) -> Vec<Binding> {
        let mut bindings: Vec<Binding> = Vec::new();
        for binding in self.files.iter().flat_map(|file| file.bindings()) {
            if !bindings.contains(&binding) {
                bindings.push(binding);
            }
        }
        bindings
    }

    /// The lines that precede all files.
    fn head(&self) -> String {
        let lines = self.files.iter().flat_map(|file| &file.lines);
        let enables =
            lines.filter_map(|line| if let Line::Enable(text) = line { Some(format!("{text}\n")) } else { None });
        // the compiler refuses these, and shows them
        let missing = self.imports.iter().filter(|import| import.file.is_none());
        let missing = missing.map(|Import { by, name, .. }| format!("#import {name} in {by}: there is no such file\n"));
        enables.chain(missing).collect()
    }

    /// What is compiled. Every file has as many lines as it has by itself.
    pub fn source(&self) -> String {
        self.joined(|_| String::new())
    }

    /// The same, each file below a line that names it.
    pub fn labelled_source(&self) -> String {
        self.joined(|file| format!("// {}:1\n", file.path))
    }

    fn joined(&self, label: impl Fn(&File) -> String) -> String {
        let bindings = self.bindings();
        let mut declared = BTreeSet::new();
        let mut text = self.head();
        for file in &self.files {
            text += &label(file);
            for line in &file.lines {
                match line {
                    Line::Code(code) => text += code,
                    Line::Directive(line) | Line::Enable(line) => text.extend(["// ", line]),
                    Line::Binding(binding) => match bindings.iter().position(|other| other == binding) {
                        Some(number) if declared.insert(number) => text += &binding.numbered(number),
                        _ => text.extend(["// ", binding.name]),
                    },
                }
                text.push('\n');
            }
        }
        text
    }

    /// The file that has a line of [`Kernel::source`], and the line's number there, both from 1.
    pub fn place(&self, line: usize) -> (&'static str, usize) {
        let mut before = self.head().lines().count();
        if line <= before {
            return (self.name, line);
        }
        for file in &self.files {
            if line <= before + file.lines.len() {
                return (file.path, line - before);
            }
            before += file.lines.len();
        }
        (self.name, line)
    }
}

/// How many storage buffers are among these.
pub fn storage_buffers(bindings: &[(u32, Binding)]) -> u32 {
    bindings.iter().filter(|(_, b)| matches!(b.access, Access::Read | Access::Write)).count() as u32
}
