//! MTL: the diffuse colours of an OBJ's materials.

use std::path::{Path, PathBuf};

use super::lex::{Lines, Words, parse_f64, quoted};
use crate::error::{Error, Result};
use crate::scene::mesh::Material;

/// Reads what a `mtllib` line names in `folder`: one file whose name may have blanks in it, or else several
/// files. `None` where none of them exists.
///
/// # Errors
/// [`Error::Input`] if a file cannot be read or is malformed.
pub(super) fn load(folder: &Path, library: &str) -> Result<Option<Vec<Material>>> {
    let find = |name: &str| -> Option<PathBuf> {
        [name.to_owned(), name.replace('\\', "/")].iter().map(|name| folder.join(name)).find(|path| path.is_file())
    };
    let files: Vec<PathBuf> = match find(library) {
        Some(file) => vec![file],
        None => library.split_whitespace().filter_map(find).collect(),
    };
    if files.is_empty() {
        return Ok(None);
    }
    let mut materials = Vec::new();
    for file in files {
        let name = file.display().to_string();
        let text = std::fs::read(&file).map_err(|e| Error::input(format!("{name}: cannot be read: {e}")))?;
        materials.extend(parse(&text, &name)?);
    }
    Ok(Some(materials))
}

/// Parses MTL text: names, and `Kd` as linear RGB, clamped to [0, 1]. Materials without `Kd` keep the default
/// colour; a `Kd` given as a spectrum or in XYZ is skipped.
///
/// # Errors
/// [`Error::Input`] naming `name` and the line.
pub(super) fn parse(text: &[u8], name: &str) -> Result<Vec<Material>> {
    let text = text.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(text);
    let mut materials: Vec<Material> = Vec::new();
    for (number, line) in Lines::new(text) {
        let wrong = |message: String| Error::input(format!("{name}:{}: {message}", number + 1));
        let mut words = Words::new(&line);
        match words.next().unwrap_or_default() {
            b"newmtl" => {
                let name = words.name();
                if name.is_empty() {
                    return Err(wrong("newmtl without a name; give one".into()));
                }
                materials.push(Material { name, ..Material::default() });
            }
            b"Kd" => {
                let Some(material) = materials.last_mut() else {
                    return Err(wrong("Kd before the first newmtl; name the material first".into()));
                };
                if let Some(diffuse) = parse_colour(words).map_err(wrong)? {
                    material.diffuse = diffuse;
                }
            }
            _ => {}
        }
    }
    Ok(materials)
}

/// `r g b`, or `r` alone for a grey.
fn parse_colour(words: Words) -> std::result::Result<Option<[f32; 3]>, String> {
    let mut values = Vec::new();
    for word in words.take(3) {
        if matches!(word, b"spectral" | b"xyz") {
            return Ok(None);
        }
        match parse_f64(word) {
            Some(value) if value.is_finite() => values.push(value.clamp(0.0, 1.0) as f32),
            _ => return Err(format!("Kd value {} is not a finite number", quoted(word))),
        }
    }
    match values[..] {
        [grey] => Ok(Some([grey; 3])),
        [r, g, b] => Ok(Some([r, g, b])),
        _ => Err(format!("Kd has {} of 3 values; give r g b", values.len())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_and_names() {
        let text =
            b"# m\nnewmtl red wall \r\nKd 0.5 0.25 2\r\nmap_Kd a.png\nnewmtl g\nKd .5\nnewmtl s\nKd spectral a.rfl";
        let materials = parse(text, "a.mtl").unwrap();
        let found: Vec<_> = materials.iter().map(|m| (m.name.as_str(), m.diffuse)).collect();
        assert_eq!(found, [("red wall", [0.5, 0.25, 1.0]), ("g", [0.5; 3]), ("s", [0.8; 3])]);
    }

    #[test]
    fn malformed_text_names_file_and_line() {
        for (text, expected) in [
            ("Kd 1 1 1", "a.mtl:1: Kd before"),
            ("newmtl\n", "a.mtl:1: newmtl without"),
            ("newmtl a\n\nKd 1 1", "a.mtl:3: Kd has 2 of 3"),
            ("newmtl a\nKd 1 x 1", "a.mtl:2: Kd value \"x\" is not"),
            ("newmtl a\nKd 1 nan 1", "a.mtl:2: Kd value \"nan\" is not"),
        ] {
            let message = parse(text.as_bytes(), "a.mtl").unwrap_err().to_string();
            assert!(message.starts_with(expected), "{message}");
        }
    }
}
