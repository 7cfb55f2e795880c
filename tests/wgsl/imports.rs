//! Every file imports what it uses of other files, and uses what it imports.

use super::scan::{self, Names};
use anamorph::internals::gpu::kernels::{File, Kernel};
use naga::{Expression, Function, Module};
use std::collections::{BTreeMap, BTreeSet, HashSet};
use std::path::{Path, PathBuf};

/// What is known of all kernels' files.
#[derive(Default)]
struct Imports {
    scanned: BTreeMap<&'static str, Names>,
    /// Imports that a kernel's file uses something of, and those that no kernel's does so far: the file and the import.
    used: BTreeSet<(&'static str, &'static str)>,
    all: BTreeSet<(&'static str, &'static str)>,
    /// Names that a file uses of one that it does not import: both files and the name.
    hidden: BTreeSet<(&'static str, &'static str, String)>,
    /// The files that answer an import of an interface.
    implementations: BTreeMap<&'static str, BTreeSet<&'static str>>,
    /// The files that import an interface.
    importers: BTreeMap<&'static str, BTreeSet<&'static str>>,
    texts: BTreeMap<&'static str, &'static str>,
    seen: HashSet<String>,
}

impl Imports {
    fn add(&mut self, kernel: &Kernel) {
        let paths: Vec<&'static str> = kernel.files.iter().map(|file| file.path).collect();
        if !self.seen.insert(format!("{paths:?} {:?}", kernel.imports.iter().map(|i| i.name).collect::<Vec<_>>())) {
            return;
        }
        for file in &kernel.files {
            self.scanned.entry(file.path).or_insert_with(|| scan::names(file.text));
            self.texts.insert(file.path, file.text);
        }
        let answers = |by: &str| -> Vec<(&'static str, &'static File)> {
            let own = kernel.imports.iter().filter(|import| import.by == by);
            own.map(|i| (i.name, i.file.unwrap_or_else(|| panic!("{by} imports {}: no such file", i.name)))).collect()
        };
        for by in &paths {
            let mut visible: BTreeSet<&str> = BTreeSet::new();
            for (name, file) in answers(by) {
                self.all.insert((by, name));
                let mut given = vec![((*by, name), file.path)];
                if !name.ends_with(".wgsl") {
                    self.implementations.entry(name).or_default().insert(file.path);
                    self.importers.entry(name).or_default().insert(by);
                    // an implementation may be in parts
                    given.extend(answers(file.path).iter().map(|(part, its)| ((file.path, *part), its.path)));
                }
                for (import, path) in given {
                    let names = &self.scanned[path].defined;
                    if names.iter().any(|name| self.scanned[by].used.contains(name)) {
                        self.used.extend([import, (by, name)]);
                    }
                    visible.extend(names.iter().map(String::as_str));
                }
            }
            for name in self.scanned[by].used.iter().filter(|name| !visible.contains(name.as_str())) {
                let of = paths.iter().find(|path| self.scanned[*path].defined.contains(name));
                self.hidden.extend(of.map(|of| (*by, *of, name.clone())));
            }
        }
    }

    fn every() -> Imports {
        let mut imports = Imports::default();
        crate::each_kernel(|kernel, _| imports.add(kernel));
        crate::each_draw().iter().for_each(|kernel| imports.add(kernel));
        imports
    }
}

#[test]
fn every_file_imports_what_it_uses_and_uses_what_it_imports() {
    let imports = Imports::every();
    assert!(imports.hidden.is_empty(), "names of files that are not imported: {:#?}", imports.hidden);
    // a file without code of its own stands for those that it imports
    let has_code = |by: &str| !imports.scanned[by].defined.is_empty();
    let idle: Vec<_> = imports.all.difference(&imports.used).filter(|(by, _)| has_code(by)).collect();
    assert!(idle.is_empty(), "imports of which nothing is used: {idle:#?}");
    for (path, _) in imports.scanned.iter().filter(|(_, names)| names.is_entry) {
        let stage = Path::new(path).file_stem().unwrap().to_str().unwrap();
        let begins = format!("// {}", stage.trim_end_matches("_by_tile"));
        assert!(imports.texts[path].starts_with(&begins), "{path} does not begin with its stage");
    }
}

#[test]
fn a_planted_import_and_a_missing_one_are_noticed() {
    let mut imports = Imports::default();
    let file = |path, text: &str| -> &'static File { Box::leak(Box::new(File::new(path, text.to_string().leak()))) };
    let a = file("a.wgsl", "fn a() -> u32 { return 1u; }\n");
    let b = file("b.wgsl", "#import a.wgsl\nfn b() -> u32 { return a(); }\n");
    let entry = |imported: &str| {
        let text =
            format!("// entry\n#import {imported}\n@compute @workgroup_size(64)\nfn entry() {{ let x = b(); }}\n");
        let files = anamorph::internals::gpu::kernels::Files::of(&[a, b, file("entry.wgsl", &text)]);
        Kernel::of(&files, "entry.wgsl", &|_| &[], &|_| None)
    };
    imports.add(&entry("b.wgsl"));
    assert!(imports.hidden.is_empty() && imports.all == imports.used);
    // b reaches what a has; entry uses nothing of it
    imports.add(&entry("b.wgsl\n#import a.wgsl"));
    assert_eq!(imports.all.difference(&imports.used).collect::<Vec<_>>(), [&("entry.wgsl", "a.wgsl")]);
    let mut imports = Imports::default();
    let c = file("c.wgsl", "#import b.wgsl\nfn c() -> u32 { return a() + b(); }\n");
    let files = anamorph::internals::gpu::kernels::Files::of(&[a, b, c]);
    imports.add(&Kernel::of(&files, "c.wgsl", &|_| &[], &|_| None));
    assert_eq!(imports.hidden.into_iter().collect::<Vec<_>>(), [("c.wgsl", "a.wgsl", "a".to_string())]);
    // an import without a file is an error of the compiler's that shows it
    let files = anamorph::internals::gpu::kernels::Files::of(&[c]);
    let source = Kernel::of(&files, "c.wgsl", &|_| &[], &|_| None).source();
    assert!(
        naga::front::wgsl::parse_str(&source).unwrap_err().emit_to_string(&source).contains("#import b.wgsl in c.wgsl")
    );
}

/// The folders of files: the product's and the laboratory's.
const FOLDERS: [&str; 2] = ["wgsl", "lab/wgsl"];

fn root(folder: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(folder)
}

#[test]
fn every_file_is_part_of_a_kernel() {
    let mut files = BTreeSet::new();
    for root in FOLDERS.map(root) {
        let mut folders = vec![root.clone()];
        while let Some(folder) = folders.pop() {
            for path in std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
                match path.is_dir() {
                    true => folders.push(path),
                    false => drop(files.insert(path.strip_prefix(&root).unwrap().to_str().unwrap().replace('\\', "/"))),
                }
            }
        }
    }
    let joined: BTreeSet<String> = Imports::every().scanned.keys().map(|path| path.to_string()).collect();
    assert_eq!(files.symmetric_difference(&joined).collect::<Vec<_>>(), [""; 0]);
}

/// What an opening comment lacks: which threads there are, what they read, what they write.
fn lacks(text: &str) -> Vec<&'static str> {
    let opening: String = text.lines().map_while(|l| l.strip_prefix("//")).collect();
    let says = |words: &[&str]| words.iter().any(|w| opening.contains(w));
    let threads = says(&["one thread per ", "one subgroup of LANES threads per ", "one thread in all"]);
    let writes = says(&["writes", "Writes", "adds", "merges", "mixes", "copies"]);
    let said = [("threads", threads), ("reads", says(&["Reads "])), ("writes", writes)];
    said.into_iter().filter(|s| !s.1).map(|s| s.0).collect()
}

#[test]
fn every_kernel_says_what_its_threads_read_and_write() {
    for (name, text) in Imports::every().texts {
        assert!(!text.contains("@compute") || lacks(text).is_empty(), "{name} lacks {:?}", lacks(text));
    }
    assert_eq!(lacks("// sort: one thread per pair.\n// Reads pairs.\n\n// writes"), ["writes"]);
}

/// The types of a function's parameters and of what it returns.
fn signature(text: &str, function: &str) -> Option<String> {
    let (_, rest) = text.split_once(&format!("fn {function}("))?;
    let (head, _) = rest.split_once('{')?;
    let (parameters, answer) = head.rsplit_once(')')?;
    let types = parameters.split(',').map(|p| p.split_once(':').map_or(p, |(_, t)| t).trim());
    Some(format!("({}){}", types.collect::<Vec<_>>().join(", "), answer.trim_end()))
}

/// The implementations of an interface have the same functions.
#[test]
fn functions_that_several_implementations_have_have_one_signature() {
    let imports = Imports::every();
    let mut swapped = 0;
    for (interface, paths) in &imports.implementations {
        let mut found: BTreeMap<&str, (String, &str)> = BTreeMap::new();
        for path in paths {
            let is_used =
                |name: &&String| imports.importers[interface].iter().any(|by| imports.scanned[by].used.contains(name));
            for name in imports.scanned[path].defined.iter().filter(is_used) {
                let Some(types) = signature(imports.texts[path], name) else { continue };
                if let Some((other_types, other)) = found.insert(name, (types.clone(), path)) {
                    assert_eq!(types, other_types, "{interface}: {name} of {path} and of {other}");
                    swapped += 1;
                }
            }
        }
    }
    assert!(swapped > 50, "{swapped} functions of several implementations");
    assert_eq!(signature("fn a(x: f32, y: Node) -> u32 {", "a").as_deref(), Some("(f32, Node) -> u32"));
    assert_ne!(signature("fn a(x: f32, y: u32) -> u32 {", "a").as_deref(), Some("(f32, Node) -> u32"));
}

/// The scan and the compiler agree on the names of a kernel, and on which functions call which.
pub fn assert_scanned_right(kernel: &Kernel, module: &Module, what: &str) {
    let scans: Vec<Names> = kernel.files.iter().map(|file| scan::names(file.text)).collect();
    let name = |n: &Option<String>| n.clone();
    let parsed: BTreeSet<String> = (module.functions.iter().filter_map(|(_, f)| name(&f.name)))
        .chain(module.constants.iter().filter_map(|(_, c)| name(&c.name)))
        .chain(module.overrides.iter().filter_map(|(_, o)| name(&o.name)))
        .chain(module.global_variables.iter().filter_map(|(_, g)| name(&g.name)))
        .chain(module.types.iter().filter_map(|(_, t)| name(&t.name)))
        .chain(module.entry_points.iter().map(|e| e.name.clone()))
        .collect();
    let scanned: BTreeSet<String> = scans.iter().flat_map(|scan| scan.defined.clone()).collect();
    let differ: Vec<_> = parsed.symmetric_difference(&scanned).collect();
    assert!(differ.is_empty(), "{what}: {differ:?}");
    let uses = |function: &Function, own: &str| {
        let part = scans.iter().find(|s| s.defined.iter().any(|d| d == own)).expect("a function of some snippet");
        for (_, expression) in function.expressions.iter() {
            let used = match *expression {
                Expression::GlobalVariable(h) => &module.global_variables[h].name,
                Expression::CallResult(h) => &module.functions[h].name,
                Expression::Override(h) => &module.overrides[h].name,
                _ => continue,
            };
            let used = used.as_ref().expect("a name");
            assert!(part.used.contains(used) || part.defined.contains(used), "{what}: {own} uses {used}");
        }
    };
    module.functions.iter().for_each(|(_, f)| uses(f, f.name.as_deref().expect("a name")));
    module.entry_points.iter().for_each(|e| uses(&e.function, &e.name));
}
