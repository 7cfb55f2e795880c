//! The source code is layered as `docs/architecture.md` says: a layer uses only those below it.

use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};

const PAGE: &str = include_str!("../docs/architecture.md");

/// The layers in the table of the page, from the top: the names of each, which are modules of the crate's root.
fn layers(page: &str) -> Vec<Vec<&str>> {
    let rows = page.lines().filter_map(|line| line.strip_prefix("| `")?.split(" |").next());
    rows.map(|cell| cell.split(", ").map(|name| name.trim_matches('`')).collect()).collect()
}

/// All source files, by their paths below `src`, but for the crate's root: it lists the layers and says what is public.
fn sources() -> Vec<(PathBuf, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut folders = vec![root.clone()];
    let mut files = Vec::new();
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            match path.extension() {
                _ if path.is_dir() => folders.push(path),
                Some(extension) if extension == "rs" && path != root.join("lib.rs") => {
                    files.push((path.strip_prefix(&root).unwrap().to_owned(), fs::read_to_string(&path).unwrap()));
                }
                _ => {}
            }
        }
    }
    files.sort();
    files
}

/// The module of the crate's root that a file belongs to.
fn layer_of(file: &Path) -> &str {
    file.iter().next().unwrap().to_str().unwrap().trim_end_matches(".rs")
}

/// How deep a file's module lies below the crate's root.
fn depth_of(file: &Path) -> usize {
    let name = file.file_name().unwrap();
    file.iter().count() - usize::from(name == "mod.rs" || file == Path::new("lib.rs") || file == Path::new("main.rs"))
}

/// The modules of the crate's root that some text names, by `crate::` or by so many `super::`, each with its line.
fn used(file: &Path, text: &str) -> Vec<(usize, String)> {
    let mut found = Vec::new();
    // lines that open a module within the file, by their indentation
    let mut inner: Vec<usize> = Vec::new();
    for (number, line) in text.lines().enumerate() {
        let code = line.split("//").next().unwrap();
        let indent = code.len() - code.trim_start().len();
        if code.trim() == "}" && inner.last() == Some(&indent) {
            inner.pop();
        }
        let mut add = |path: &str| {
            // a list that goes on in the next line names nothing that is a layer
            let list =
                path.strip_prefix('{').map(|list| list.split_once('}').map_or("unclosed_list", |(list, _)| list));
            let names = list.map_or(vec![path], |list| list.split(',').collect());
            for name in names.into_iter().map(str::trim).filter(|name| !name.is_empty()) {
                let end = name.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(name.len());
                found.push((number + 1, name[..end].to_owned()));
            }
        };
        let is_path = |at: usize| !code[..at].ends_with(|c: char| c.is_alphanumeric() || c == '_' || c == ':');
        code.match_indices("crate::").filter(|(at, _)| is_path(*at)).for_each(|(at, _)| add(&code[at + 7..]));
        for (at, _) in code.match_indices("super::").filter(|(at, _)| is_path(*at)) {
            let rest = code[at..].trim_start_matches("super::");
            let ups = (code.len() - at - rest.len()) / "super::".len();
            if ups == depth_of(file) + inner.len() {
                add(rest);
            }
        }
        if code.trim_start().trim_start_matches("pub ").starts_with("mod ") && code.trim_end().ends_with('{') {
            inner.push(indent);
        }
    }
    found
}

/// Uses of a layer by one below it or by none, each as `file:line: layer uses layer`.
fn faults(layers: &[Vec<&str>], files: &[(PathBuf, String)]) -> Vec<String> {
    let names = layers.iter().enumerate().flat_map(|(k, names)| names.iter().map(move |name| (*name, k)));
    let height: HashMap<&str, usize> = names.collect();
    let mut faults = Vec::new();
    for (file, text) in files {
        let own = layer_of(file);
        let Some(from) = height.get(own) else {
            faults.push(format!("{}: belongs to no layer", file.display()));
            continue;
        };
        for (line, name) in used(file, text) {
            // heights count from the top
            if height.get(name.as_str()).is_none_or(|to| to < from) {
                faults.push(format!("{}:{line}: {own} uses {name}", file.display()));
            }
        }
    }
    faults
}

#[test]
fn layers_use_only_those_below() {
    let layers = layers(PAGE);
    assert!(layers.len() > 5, "{layers:?}");
    let mut names: Vec<&str> = layers.concat();
    let count = names.len();
    names.sort();
    names.dedup();
    assert_eq!(names.len(), count, "a layer is listed twice");
    let files = sources();
    let is_there = |name: &&str| files.iter().any(|(file, _)| layer_of(file) == *name);
    assert!(names.iter().all(is_there), "a layer has no files");
    let faults = faults(&layers, &files);
    assert!(faults.is_empty(), "\n{}\n", faults.join("\n"));
}

/// The test above finds what it looks for.
#[test]
fn faults_are_found() {
    let layers = [vec!["roof", "lib"], vec!["wall"], vec!["floor"]];
    let found = |file: &str, text: &str| faults(&layers, &[(file.into(), text.into())]);
    for (file, text, name) in [
        ("floor.rs", "use crate::wall::Brick;", "wall"),
        ("floor/mod.rs", "use crate::{floor::Tile, roof};", "roof"),
        ("floor/deep/tile.rs", "fn lay() {\n    crate::roof::raise()\n}", "roof"),
        ("wall/brick.rs", "use super::super::roof::Beam;", "roof"),
        ("wall/mod.rs", "mod tests {\n    use super::super::roof;\n}\n", "roof"),
        ("floor.rs", "use crate::Error;", "Error"),
        ("floor.rs", "use crate::{\n    roof::Beam,\n};", "unclosed_list"),
    ] {
        assert!(found(file, text).iter().any(|f| f.ends_with(&format!("uses {name}"))), "{file}: {text}");
    }
    for (file, text) in [
        ("roof.rs", "use crate::floor::Tile; // not crate::attic"),
        ("wall/brick.rs", "use super::super::floor;\nuse super::mortar;"),
        ("wall/brick.rs", "mod tests {\n    use super::super::roof;\n}\n"),
        ("lib.rs", "pub use crate::wall::Brick;"),
    ] {
        assert_eq!(found(file, text), [""; 0], "{file}: {text}");
    }
    assert_eq!(found("cellar.rs", ""), ["cellar.rs: belongs to no layer"]);
}
