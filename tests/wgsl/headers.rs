//! Every snippet's header names what it provides, needs and binds: the names that its kernels' other snippets use of it, those that it
//! uses of theirs, and the buffers and textures that it reads or writes.

use super::scan::{self, Names};
use anamorph::internals::gpu::kernels::Kernel;
use naga::{Expression, Function, Module};
use std::collections::{BTreeMap, BTreeSet, HashSet};
use std::path::{Path, PathBuf};

/// Snippets of which some variant of a kernel uses nothing.
const IDLE: [(&str, &str); 31] = [
    ("bin", "shared/slabs.wgsl"),
    ("certify", "shared/index.wgsl"),
    ("certify", "shared/ray.wgsl"),
    ("cull", "shared/within.wgsl"),
    ("edges", "shared/index.wgsl"),
    ("edges", "shared/within.wgsl"),
    ("fit", "camera/field.wgsl"),
    ("raster", "shared/index.wgsl"),
    ("raster", "shared/key.wgsl"),
    ("raster", "shared/ray.wgsl"),
    ("recheck", "shared/index.wgsl"),
    ("recheck", "shared/ray.wgsl"),
    ("resolve", "shared/bits.wgsl"),
    ("resolve", "shared/index.wgsl"),
    ("sample", "shared/index.wgsl"),
    ("sample", "shared/key.wgsl"),
    ("sample", "shared/ray.wgsl"),
    ("sample", "shared/within.wgsl"),
    ("recheck_samples", "shared/index.wgsl"),
    ("recheck_samples", "shared/ray.wgsl"),
    ("shade", "shared/index.wgsl"),
    ("trace", "shared/bits.wgsl"),
    ("trace", "shared/index.wgsl"),
    ("trace", "shared/key.wgsl"),
    ("trace", "shared/merge_u32.wgsl"),
    ("trace", "shared/merge_u64.wgsl"),
    ("trace", "shared/vertex_real.wgsl"),
    ("trace", "shared/vertex_real_placed.wgsl"),
    ("trace", "shared/vertex_real_timed.wgsl"),
    ("splat_project", "rivals/drawn.wgsl"),
    ("splat_project", "rivals/range.wgsl"),
];

/// Longest line of a header, characters.
const WIDTH: usize = 140;

/// What a header says, or has to say.
#[derive(Debug, Default, Clone, PartialEq)]
struct Header {
    provides: BTreeSet<String>,
    needs: BTreeSet<String>,
    binds: BTreeSet<String>,
}

impl Header {
    /// The lists of a snippet's opening comment: `// Needs: a, b`, and further lines that are indented.
    fn of(text: &str) -> Header {
        let mut header = Header::default();
        let mut list = None;
        for line in text.lines().map_while(|l| l.strip_prefix("//")) {
            let rest = match line.split_once(": ") {
                Some((" Provides", rest)) => Some((&mut header.provides, rest)),
                Some((" Needs", rest)) => Some((&mut header.needs, rest)),
                Some((" Binds", rest)) => Some((&mut header.binds, rest)),
                _ => line.strip_prefix("   ").and_then(|rest| Some((list.take()?, rest))),
            };
            list = rest.map(|(list, names)| {
                for name in names.split(',').map(str::trim).filter(|n| !n.is_empty()) {
                    assert!(list.insert(name.to_string()), "{name} stands twice in {line:?}");
                }
                list
            });
        }
        header
    }

    /// As it stands in a snippet.
    fn text(&self) -> String {
        let lists = [("Provides", &self.provides), ("Needs", &self.needs), ("Binds", &self.binds)];
        let mut text = String::new();
        for (title, names) in lists.into_iter().filter(|(_, names)| !names.is_empty()) {
            let mut line = format!("// {title}:");
            for (k, name) in names.iter().enumerate() {
                let comma = if k + 1 < names.len() { "," } else { "" };
                if line.len() + 1 + name.len() + comma.len() > WIDTH {
                    text += &(line + "\n");
                    line = "//  ".into();
                }
                line += &format!(" {name}{comma}");
            }
            text += &(line + "\n");
        }
        text
    }
}

/// All snippets of the kernels, what each must say, and what is wrong with how kernels are joined.
#[derive(Default)]
struct Joined {
    scanned: BTreeMap<&'static str, Names>,
    headers: BTreeMap<&'static str, Header>,
    /// Snippets that a kernel has without need.
    idle: BTreeSet<(&'static str, &'static str)>,
    /// The snippets from which kernels of a name are joined.
    parts: BTreeMap<&'static str, BTreeSet<&'static str>>,
    seen: HashSet<String>,
}

impl Joined {
    fn add(&mut self, kernel: &Kernel) {
        let names: Vec<&'static str> = kernel.parts.iter().map(|p| p.name).collect();
        if !self.seen.insert(format!("{names:?} {:?}", kernel.bindings)) {
            return;
        }
        for part in &kernel.parts {
            self.scanned.entry(part.name).or_insert_with(|| scan::names(part.text));
        }
        self.parts.entry(kernel.name).or_default().extend(&names);
        let bound: BTreeSet<&str> = kernel.bindings.iter().map(|b| b.name).collect();
        let types: BTreeSet<String> = kernel.bindings.iter().flat_map(|b| scan::words(b.wgsl_type)).collect();
        let definer: BTreeMap<&str, &'static str> =
            names.iter().flat_map(|&n| self.scanned[n].defined.iter().map(move |d| (d.as_str(), n))).collect();
        let mut needed: BTreeSet<&'static str> = BTreeSet::new();
        for &name in &names {
            for used in &self.scanned[name].used {
                if let Some(&from) = definer.get(used.as_str()) {
                    needed.insert(from);
                    self.headers.entry(name).or_default().needs.insert(used.clone());
                    self.headers.entry(from).or_default().provides.insert(used.clone());
                } else if bound.contains(used.as_str()) {
                    self.headers.entry(name).or_default().binds.insert(used.clone());
                }
            }
        }
        for (used, from) in types.iter().filter_map(|t| Some((t, *definer.get(t.as_str())?))) {
            needed.insert(from);
            self.headers.entry(from).or_default().provides.insert(used.clone());
        }
        let idle = names.iter().filter(|n| !needed.contains(*n) && !self.scanned[*n].is_entry);
        self.idle.extend(idle.map(|n| (kernel.name, *n)));
    }

    fn all() -> Joined {
        let mut joined = Joined::default();
        crate::each_kernel(|kernel, _| joined.add(kernel));
        crate::each_draw().iter().for_each(|kernel| joined.add(kernel));
        joined
    }
}

fn text_of(name: &str) -> String {
    let there = FOLDERS.iter().map(|folder| root(folder).join(name)).find(|path| path.is_file());
    std::fs::read_to_string(there.unwrap_or_else(|| panic!("no file {name}"))).unwrap()
}

/// The folders of snippets: the product's and the laboratory's.
const FOLDERS: [&str; 2] = ["wgsl", "lab/wgsl"];

fn root(folder: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(folder)
}

/// How the header of a snippet differs from what it must say.
fn difference(name: &str, text: &str, expected: &Header) -> Option<String> {
    let says = Header::of(text);
    (says != *expected).then(|| format!("wgsl/{name} must say\n{}and says\n{}", expected.text(), says.text()))
}

#[test]
fn every_snippet_names_what_it_provides_needs_and_binds() {
    let joined = Joined::all();
    let none = Header::default();
    let must = |name: &str| joined.headers.get(name).unwrap_or(&none);
    let wrong: Vec<String> = joined.scanned.keys().filter_map(|n| difference(n, &text_of(n), must(n))).collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    for (name, _) in joined.scanned.iter().filter(|(_, s)| s.is_entry) {
        let text = text_of(name);
        let stage = Path::new(name).file_stem().unwrap().to_str().unwrap();
        assert!(
            text.starts_with(&format!("// {}", stage.trim_end_matches("_by_tile"))),
            "{name} does not begin with its stage"
        );
    }
    // a name too many, one too few, and one in the wrong list
    let (name, text) = ("shared/bundle.wgsl", text_of("shared/bundle.wgsl"));
    for (from, to) in
        [("// Needs: ", "// Needs: extra, "), ("// Provides: ", "// Provides: Bundled, "), ("// Needs: ", "// Binds: ")]
    {
        let planted = text.replacen(from, to, 1);
        assert!(planted != text && difference(name, &planted, must(name)).is_some(), "{to}");
    }
}

#[test]
fn every_snippet_is_part_of_a_kernel_and_needed_there() {
    let joined = Joined::all();
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
    let parts: BTreeSet<String> = joined.scanned.keys().map(|n| n.to_string()).collect();
    assert_eq!(files.symmetric_difference(&parts).collect::<Vec<_>>(), [""; 0]);
    assert_eq!(joined.idle, BTreeSet::from(IDLE), "kernels, and snippets of which some variant uses nothing");
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
    for name in Joined::all().scanned.keys() {
        let text = text_of(name);
        assert!(!text.contains("@compute") || lacks(&text).is_empty(), "{name} lacks {:?}", lacks(&text));
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

/// Variants of a kernel swap snippets that provide the same functions.
#[test]
fn functions_that_several_snippets_of_a_kernel_provide_have_one_signature() {
    let joined = Joined::all();
    let mut swapped = 0;
    for (kernel, parts) in &joined.parts {
        let mut found: BTreeMap<&str, (String, &str)> = BTreeMap::new();
        for part in parts {
            for provided in joined.headers.get(part).iter().flat_map(|h| &h.provides) {
                let Some(types) = signature(&text_of(part), provided) else { continue };
                if let Some((other_types, other)) = found.insert(provided, (types.clone(), part)) {
                    assert_eq!(types, other_types, "{kernel}: {provided} of {part} and of {other}");
                    swapped += 1;
                }
            }
        }
    }
    assert!(swapped > 50, "{swapped} functions of swapped snippets");
    assert_eq!(signature("fn a(x: f32, y: Node) -> u32 {", "a").as_deref(), Some("(f32, Node) -> u32"));
    assert_ne!(signature("fn a(x: f32, y: u32) -> u32 {", "a").as_deref(), Some("(f32, Node) -> u32"));
}

/// The scan and the compiler agree on the names of a kernel, and on which functions call which.
pub fn assert_scanned_right(kernel: &Kernel, module: &Module, what: &str) {
    let scans: Vec<Names> = kernel.parts.iter().map(|p| scan::names(p.text)).collect();
    let name = |n: &Option<String>| n.clone();
    let parsed: BTreeSet<String> = (module.functions.iter().filter_map(|(_, f)| name(&f.name)))
        .chain(module.constants.iter().filter_map(|(_, c)| name(&c.name)))
        // the planes' numbers are generated
        .chain(module.overrides.iter().filter_map(|(_, o)| name(&o.name)).filter(|n| !n.starts_with("PLANE_")))
        .chain(module.global_variables.iter().filter_map(|(_, g)| name(&g.name)))
        .chain(module.types.iter().filter_map(|(_, t)| name(&t.name)))
        .chain(module.entry_points.iter().map(|e| e.name.clone()))
        .collect();
    let scanned: BTreeSet<String> = (scans.iter().flat_map(|s| s.defined.clone()))
        .chain(kernel.bindings.iter().map(|b| b.name.to_string()))
        .collect();
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
