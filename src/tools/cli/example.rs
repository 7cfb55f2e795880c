//! `anamorph example`: writes example scenes for the user to edit.

use super::args::ExampleArgs;
use super::keep::may_write;
use super::say::print;
use crate::input::{Error, Result};
use crate::tools::example::{EXAMPLES, list};

pub fn run(args: &ExampleArgs) -> Result<()> {
    let Some(name) = args.name.as_deref().filter(|_| !args.list) else {
        return print(&list());
    };
    let example = EXAMPLES.iter().find(|e| e.name == name).ok_or_else(|| {
        let known: Vec<_> = EXAMPLES.iter().map(|e| e.name).collect();
        Error::input(format!("no example {name:?}; known: {}", known.join(", ")))
    })?;
    // the folder's parts that are missing are made: it is asked for by name, and holds nothing else's files
    std::fs::create_dir_all(&args.out).map_err(|e| {
        Error::work(format!("{}: the folder cannot be made: {e}; choose another --out", args.out.display()))
    })?;
    for (file, part) in &example.parts() {
        may_write(&args.out.join(file), &part.bytes(), "--out")?;
    }
    let scene = example.write(&args.out)?;
    print(&format!("{}\n", scene.display()))
}
