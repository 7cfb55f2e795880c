//! `anamorph example`: writes example scenes for the user to edit.

use super::args::ExampleArgs;
use super::keep::may_write;
use super::say::print;
use crate::input::tree::did_you_mean;
use crate::input::{Error, Result};
use crate::tools::example::{EXAMPLES, list};

pub fn run(args: &ExampleArgs) -> Result<()> {
    let Some(name) = args.name.as_deref().filter(|_| !args.list) else {
        return print(&list());
    };
    let example = EXAMPLES.iter().find(|e| e.name == name).ok_or_else(|| {
        let known: Vec<_> = EXAMPLES.iter().map(|e| e.name).collect();
        Error::input(format!("no example {name:?}{}; known: {}", hint(name, &known), known.join(", ")))
    })?;
    // the folder's parts that are missing are made: it is asked for by name, and holds nothing else's files
    std::fs::create_dir_all(&args.out).map_err(|e| {
        Error::work(format!("{}: the folder cannot be made: {e}; choose another --out", args.out.display()))
    })?;
    for (file, content) in &example.parts() {
        may_write(&args.out.join(file), content, "--out")?;
    }
    let scene = example.write(&args.out)?;
    print(&format!("{}\n", scene.display()))
}

/// The names like this one; of a kind of camera the examples that use it.
fn hint(name: &str, known: &[&str]) -> String {
    let key = format!("kind = {name:?}");
    let of_kind: Vec<&str> = EXAMPLES.iter().filter(|e| e.scene.contains(&key)).map(|e| e.name).take(4).collect();
    match (did_you_mean(name, known), of_kind.as_slice()) {
        (near, []) => near,
        (_, some) => format!("; with such a camera: {}", some.join(", ")),
    }
}
