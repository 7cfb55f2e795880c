//! `make facets`: how far facets, atlases and environment maps are from a mirror itself, against the time they take; and the
//! papers' own tables of mirrors and lenses, each row with our frames of a scene like theirs.
//!
//! Writes into the folder that is its first argument: mirror_facets.csv, of ways to show a mirror ball; yu_figure_10.csv,
//! hou_table_1.csv and hou_figure_7.csv, of the papers' rows. A second argument is a part of the name of the only table that is wanted.

mod measure;
mod papers;
mod rows;
mod ways;

use anamorph::error::{Error, Result};
use measure::Bench;
use std::path::{Path, PathBuf};

fn main() -> Result<()> {
    let folder = PathBuf::from(std::env::args().nth(1).unwrap_or_else(|| "out".into()));
    std::fs::create_dir_all(&folder).map_err(|e| Error::work(format!("{}: {e}", folder.display())))?;
    let mut bench = Bench::open(&folder)?;
    println!("on {}", bench.adapter());
    if bench.is_software() {
        println!("a software adapter: its frames a second are no match for those of a GPU, of any year");
    }
    let only = std::env::args().nth(2).unwrap_or_default();
    if ways::FILE.contains(&only) {
        write(&folder.join(ways::FILE), ways::table(&mut bench)?)?;
    }
    for table in papers::TABLES.iter().filter(|t| t.file.contains(&only)) {
        write(&folder.join(table.file), rows::table(&mut bench, table)?)?;
    }
    Ok(())
}

fn write(file: &Path, text: String) -> Result<()> {
    std::fs::write(file, text).map_err(|e| Error::work(format!("{}: {e}", file.display())))
}
