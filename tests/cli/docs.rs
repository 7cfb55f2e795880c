//! The project's pages: links lead somewhere, commands run, scenes load. A block of code that is not run says why on the line above it,
//! as in `<!-- not run: it takes minutes -->`.

use super::program::Place;
use std::collections::BTreeSet;
use std::path::{Component, Path, PathBuf};
use std::process::Command;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Every page, from the top of the tree.
fn pages() -> Vec<PathBuf> {
    let mut pages = vec![PathBuf::from("README.md"), "python/README.md".into()];
    let mut folders = vec![root().join("docs"), root().join("bench_results")];
    while let Some(folder) = folders.pop() {
        for path in std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
            match path.extension() {
                _ if path.is_dir() => folders.push(path),
                Some(extension) if extension == "md" => pages.push(path.strip_prefix(root()).unwrap().to_owned()),
                _ => {}
            }
        }
    }
    pages.sort();
    pages
}

fn text(page: &Path) -> String {
    std::fs::read_to_string(root().join(page)).unwrap()
}

/// A block of code.
struct Block {
    /// "sh", "toml", ...
    language: String,
    /// Its line in the page.
    line: usize,
    text: String,
    /// Why it is not run.
    left_out: Option<String>,
}

/// The blocks of a page, and what remains of it.
fn blocks(page: &str) -> (Vec<Block>, String) {
    let (mut blocks, mut prose) = (Vec::<Block>::new(), String::new());
    let (mut is_open, mut last) = (false, "");
    for (k, line) in page.lines().enumerate() {
        match line.trim_start().strip_prefix("```") {
            Some(_) if is_open => is_open = false,
            Some(language) => {
                is_open = true;
                let reason = last.trim().strip_prefix("<!-- not run: ").and_then(|rest| rest.strip_suffix(" -->"));
                blocks.push(Block {
                    language: language.split(',').next().unwrap().to_owned(),
                    line: k + 1,
                    text: String::new(),
                    left_out: reason.map(str::to_owned),
                });
            }
            None if is_open => blocks.last_mut().unwrap().text += &format!("{line}\n"),
            None => prose += &format!("{line}\n"),
        }
        last = line;
    }
    assert!(!is_open, "a block without an end");
    (blocks, prose)
}

/// A heading's anchor, as forges make it.
fn anchor(heading: &str) -> String {
    let mut plain = String::new();
    let mut rest = heading;
    // of a link its text
    while let Some((before, after)) = rest.split_once("](") {
        plain += before;
        rest = after.split_once(')').map_or("", |(_, after)| after);
    }
    plain += rest;
    let kept = |c: &char| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_');
    plain.trim().to_lowercase().chars().filter(kept).map(|c| if c == ' ' { '-' } else { c }).collect()
}

fn anchors(page: &Path) -> BTreeSet<String> {
    let (_, prose) = blocks(&text(page));
    prose.lines().filter(|l| l.starts_with('#')).map(|l| anchor(l.trim_start_matches('#'))).collect()
}

/// `path` as seen from the top of the tree, where `page` names it.
fn beside(page: &Path, path: &str) -> PathBuf {
    let mut whole = PathBuf::new();
    for part in page.parent().unwrap().join(path).components() {
        match part {
            Component::ParentDir => assert!(whole.pop(), "{}: {path} leaves the tree", page.display()),
            part => whole.push(part),
        }
    }
    whole
}

#[test]
fn links_lead_to_files_and_headings_that_are_there() {
    let mut broken = Vec::new();
    for page in pages() {
        let (_, prose) = blocks(&text(&page));
        for link in prose.split("](").skip(1).filter_map(|rest| rest.split_once(')')).map(|(link, _)| link) {
            if link.contains("://") {
                continue;
            }
            let (path, heading) = link.split_once('#').map_or((link, None), |(path, heading)| (path, Some(heading)));
            let target = if path.is_empty() { page.clone() } else { beside(&page, path) };
            let is_there = root().join(&target).exists();
            if !is_there || heading.is_some_and(|heading| !anchors(&target).contains(heading)) {
                broken.push(format!("{}: {link}", page.display()));
            }
        }
    }
    assert!(broken.is_empty(), "{broken:#?}");
}

/// A name with capitals, as in `src/engine/stage/NAME.rs`, stands for many files. The lab book names files of its day.
#[test]
fn files_that_pages_name_are_there() {
    let folders = ["src/", "wgsl/", "lab/", "tests/", "benches/", "python/", "examples/", "fuzz/"];
    let is_part = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || "._-/".contains(c);
    let mut missing = Vec::new();
    for page in pages().into_iter().filter(|page| !page.ends_with("bench_results/lab.md")) {
        let (_, prose) = blocks(&text(&page));
        // names stand between backticks: every second part
        let names = prose.split('`').skip(1).step_by(2);
        for name in names.filter(|name| folders.iter().any(|f| name.starts_with(f)) && name.chars().all(is_part)) {
            if !root().join(name).exists() && !root().join(beside(&page, name)).exists() {
                missing.push(format!("{}: {name}", page.display()));
            }
        }
    }
    assert!(missing.is_empty(), "{missing:#?}");
}

#[test]
fn every_page_is_in_the_book() {
    let summary = text(Path::new("docs/SUMMARY.md"));
    let listed: BTreeSet<PathBuf> = summary
        .split("](")
        .skip(1)
        .map(|rest| beside(Path::new("docs/SUMMARY.md"), rest.split_once(')').unwrap().0))
        .collect();
    // summaries of runs are linked by their pages
    let is_summary = |page: &PathBuf| page.ends_with("summary.md") || page.ends_with("SUMMARY.md");
    let missing: Vec<PathBuf> = pages().into_iter().filter(|p| !is_summary(p) && !listed.contains(p)).collect();
    assert!(missing.is_empty(), "docs/SUMMARY.md leaves out {missing:?}");
}

/// Blocks of Rust that can be run would fetch a list of crates from another host.
#[test]
fn the_book_fetches_nothing_and_has_its_style() {
    let book: toml::Table = text(Path::new("docs/book.toml")).parse().unwrap();
    let html = &book["output"]["html"];
    assert_eq!(html["playground"]["runnable"].as_bool(), Some(false));
    // relative to the folder of the README
    for style in html["additional-css"].as_array().unwrap() {
        assert!(text(Path::new(style.as_str().unwrap())).contains("white-space: pre-wrap"));
    }
}

/// `make camera-pages` makes them anew.
#[test]
fn every_kind_of_camera_has_a_page_with_its_help() {
    let place = Place::new();
    for (kind, _) in anamorph::camera_kinds() {
        let page = text(&Path::new("docs/cameras").join(format!("{kind}.md")));
        let help = place.works(&["camera", "--help", kind]);
        assert!(
            page.contains(help.trim_end()),
            "docs/cameras/{kind}.md does not hold what camera --help {kind} prints"
        );
    }
}

/// A folder with what the commands of a page name without making it.
fn place() -> Place {
    let place = Place::new();
    let points = [[0.0, 0.0, 0.0], [0.3, 0.2, 0.1], [-0.4, 0.1, 0.2], [0.1, -0.3, 0.4]];
    let lines = |points: &[[f64; 3]]| points.iter().map(|[x, y, z]| format!("{x} {y} {z}\n")).collect::<String>();
    place.write("points.txt", lines(&points));
    let header = |n: usize| {
        format!("ply\nformat ascii 1.0\nelement vertex {n}\nproperty float x\nproperty float y\nproperty float z\n")
    };
    place.write("cloud.ply", format!("{}end_header\n{}", header(4), lines(&points)));
    let faces = "element face 4\nproperty list uchar int vertex_indices\nend_header\n";
    let scan = format!("{}{faces}{}3 0 1 2\n3 0 3 1\n3 0 2 3\n3 1 3 2\n", header(4), lines(&points));
    place.write("scan.ply", scan);
    place
}

/// The blocks of a language that are run, page by page.
fn to_run(language: &str) -> Vec<(PathBuf, Vec<Block>)> {
    let of = |page: PathBuf| {
        let (all, _) = blocks(&text(&page));
        let run: Vec<Block> = all.into_iter().filter(|b| b.language == language && b.left_out.is_none()).collect();
        (page, run)
    };
    pages().into_iter().map(of).filter(|(_, run)| !run.is_empty()).collect()
}

#[test]
#[ignore = "slow: make test-all"]
fn commands_run() {
    let program = Path::new(env!("CARGO_BIN_EXE_anamorph"));
    let known = std::env::var_os("PATH").unwrap();
    let paths = [program.parent().unwrap().to_owned()].into_iter().chain(std::env::split_paths(&known));
    let path = std::env::join_paths(paths).unwrap();
    let mut failed = Vec::new();
    if !Place::new().has_adapter() {
        return;
    }
    for (page, run) in to_run("sh") {
        // commands of a page follow one another
        let place = place();
        for block in run {
            let ran = Command::new("sh")
                .args(["-euc", &block.text])
                .env("PATH", &path)
                .current_dir(place.path())
                .output()
                .unwrap();
            if !ran.status.success() {
                failed.push(format!("{}:{}: {}", page.display(), block.line, String::from_utf8_lossy(&ran.stderr)));
            }
        }
    }
    assert!(failed.is_empty(), "{}", failed.join("\n"));
}

/// A block is a scene, or tables of one; then a camera is added.
#[test]
fn scenes_load() {
    let camera = "\n[camera]\nkind = \"pinhole\"\neye = [0, 0, 4]\ntarget = [0, 0, 0]\nvfov = 40\n";
    let mut failed = Vec::new();
    for (page, run) in to_run("toml") {
        for block in run {
            let place = place();
            let whole = block.text.lines().any(|line| line.starts_with("[camera]"));
            let image = if block.text.contains("[image]") { "" } else { "[image]\nwidth = 64\nheight = 48\n" };
            place.write("block.toml", format!("{image}{}{}", block.text, if whole { "" } else { camera }));
            let ran = place.run(&["camera", "block.toml"]);
            // what a scene names need not be there
            if ran.code != 0 && !ran.err.contains("No such file") && !ran.err.contains("does not exist") {
                failed.push(format!("{}:{}: {}", page.display(), block.line, ran.err));
            }
        }
    }
    assert!(failed.is_empty(), "{}", failed.join(""));
}

#[test]
fn what_is_broken_is_noticed() {
    let page = "# A *page* of [`this`](x.md)\n<!-- not run: it takes long -->\n```sh\nls\n```\n```toml,x\na = 1\n```\n";
    let (found, prose) = blocks(page);
    assert_eq!((found.len(), found[0].line, found[1].language.as_str()), (2, 3, "toml"));
    assert_eq!((found[0].left_out.as_deref(), found[1].left_out.as_deref()), (Some("it takes long"), None));
    assert_eq!((found[1].text.as_str(), prose.lines().count()), ("a = 1\n", 2));
    assert_eq!(anchor(" A *page* of [`this`](x.md), 2.5 wide"), "a-page-of-this-25-wide");
    assert_eq!(beside(Path::new("docs/guide/a.md"), "../b.md"), Path::new("docs/b.md"));
}
