//! The keys of scene files as tables, for the controls of the viewer's page and for editors: from the help texts of cameras and of the
//! scene's other sections.

use crate::camera::kinds::KINDS;
use crate::camera::recipe::POSE;
use serde::Serialize;
use std::collections::BTreeMap;

/// A key of a section.
#[derive(Debug, PartialEq, Eq, Serialize)]
pub struct Key {
    pub name: String,
    /// How its value is written: `[x, y, z]`, `degrees`, `0..1`, `N`, `"up"`, ...; may be empty.
    pub shape: String,
    pub about: String,
    /// As in the text, in TOML where it is a value.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub default: Option<String>,
    /// The words that its text names as values.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub choices: Vec<String>,
}

/// The sections of a scene file besides the camera that have controls.
pub const SECTIONS: [(&str, &str); 7] = [
    ("image", include_str!("help/image.txt")),
    ("light", include_str!("help/light.txt")),
    ("projector_light", include_str!("help/projector_light.txt")),
    ("ambient_occlusion", include_str!("help/ambient_occlusion.txt")),
    ("environment", include_str!("help/environment.txt")),
    ("volume", include_str!("help/volume.txt")),
    ("style", include_str!("help/style.txt")),
];

/// Those without.
#[cfg(feature = "cli")]
const OTHERS: [(&str, &str); 4] = [
    ("mesh", include_str!("help/mesh.txt")),
    ("spheres", include_str!("help/spheres.txt")),
    ("caustics", include_str!("help/caustics.txt")),
    ("output", include_str!("help/output.txt")),
];

/// The keys of each kind of camera.
pub fn of_cameras() -> BTreeMap<&'static str, Vec<Key>> {
    KINDS.iter().map(|kind| (kind.name, keys(kind.help))).collect()
}

/// The keys of each other section.
#[cfg(feature = "view")]
pub fn of_sections() -> BTreeMap<&'static str, Vec<Key>> {
    SECTIONS.into_iter().map(|(name, help)| (name, keys(help))).collect()
}

/// The keys of all sections but the camera.
#[cfg(feature = "cli")]
pub fn of_all_sections() -> impl Iterator<Item = (&'static str, Vec<Key>)> {
    SECTIONS.into_iter().chain(OTHERS).map(|(name, help)| (name, keys(help)))
}

/// The keys of every camera, and those that replace eye, target and up where a kind has these.
#[cfg(feature = "cli")]
pub fn of_any_camera() -> [Vec<Key>; 2] {
    [keys(include_str!("help/any_camera.txt")), keys(&format!("\n\n{POSE}"))]
}

/// The keys that a help text lists: lines with two leading blanks, and continuation lines with more.
fn keys(help: &str) -> Vec<Key> {
    let mut found: Vec<Key> = Vec::new();
    // keys of one line have one text
    let mut together = 0;
    for line in help.split("\n\n").nth(1).unwrap_or("").lines() {
        let Some(line) = line.strip_prefix("  ") else { continue };
        match line.strip_prefix(' ') {
            Some(more) => {
                let start = found.len() - together;
                found[start..].iter_mut().for_each(|key| key.about += &format!(" {}", more.trim()));
            }
            None => {
                let (names, shape, about) = parts(line);
                together = names.len();
                let key = |name: &str| Key {
                    name: name.into(),
                    shape: shape.into(),
                    about: about.into(),
                    default: None,
                    choices: Vec::new(),
                };
                found.extend(names.into_iter().map(key));
            }
        }
    }
    for key in &mut found {
        key.about = key.about.trim().to_owned();
        key.default = default(&key.about);
        key.choices = choices(&format!("{} {}", key.shape, key.about));
    }
    found
}

/// The names of a line, the shape of their values, and the text.
fn parts(line: &str) -> (Vec<&str>, &str, &str) {
    let is_name = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == ',' || c == ' ';
    let end = line.find(|c| !is_name(c)).unwrap_or(line.len());
    let end = line.find("  ").unwrap_or(end).min(end);
    let names: Vec<&str> = line[..end].split(',').map(str::trim).filter(|name| !name.is_empty()).collect();
    let rest = line[end..].trim_start();
    match rest.split_once("  ") {
        Some((shape, about)) => (names, shape.trim(), about.trim()),
        None if rest.starts_with(['[', '{', '"']) => (names, rest, ""),
        None => (names, "", rest),
    }
}

/// What follows "(default " or "default " in a text.
fn default(about: &str) -> Option<String> {
    let rest = &about[about.find("(default ")? + "(default ".len()..];
    // up to the bracket that closes this one
    let mut open = 0;
    let end = rest.find(|c| match c {
        '(' | '[' => {
            open += 1;
            false
        }
        ')' | ']' if open > 0 => {
            open -= 1;
            false
        }
        _ => c == ')',
    })?;
    Some(rest[..end].split([':', ';']).next().unwrap_or("").trim().to_owned()).filter(|text| !text.is_empty())
}

/// The quoted words of a text, each once; file names and placeholders are none.
fn choices(text: &str) -> Vec<String> {
    let is_word =
        |word: &&str| !word.is_empty() && word.chars().all(|c| c.is_ascii_lowercase() || c == '-' || c == '_');
    let mut words: Vec<String> = Vec::new();
    for word in text.split('"').skip(1).step_by(2).filter(is_word) {
        if !words.iter().any(|known| known == word) {
            words.push(word.into());
        }
    }
    words
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::Loading;
    use crate::scene::file;
    use std::path::Path;

    fn key(keys: &[Key], name: &str) -> Key {
        let found = keys.iter().find(|key| key.name == name).unwrap_or_else(|| panic!("{name}"));
        let Key { name, shape, about, default, choices } = found;
        Key {
            name: name.clone(),
            shape: shape.clone(),
            about: about.clone(),
            default: default.clone(),
            choices: choices.clone(),
        }
    }

    #[test]
    fn shapes_defaults_and_choices_are_read() {
        let hinge = &of_cameras()["hinge"];
        let side = key(hinge, "side");
        assert_eq!((side.shape.as_str(), side.default.as_deref()), ("\"right\"", Some("\"right\"")));
        assert_eq!(side.choices, ["right", "left"]);
        assert_eq!(key(hinge, "up").default.as_deref(), Some("[0, 1, 0]"));
        assert_eq!(key(hinge, "angle").shape, "degrees");
        let track = &of_cameras()["track"];
        assert_eq!(key(track, "bend").choices, ["up", "down", "left", "right", "auto"]);
        assert!(
            ["eye", "target", "up", "vfov"].iter().all(|name| key(track, name).about == "the view, keys as of pinhole")
        );
        assert_eq!(key(track, "morph").shape, "0..1");
        assert!(key(track, "targets").about.starts_with("up to 32 balls, middle and outline"));
        assert_eq!(key(&of_sections()["image"], "tone").choices, ["clip", "reinhard", "aces"]);
        assert_eq!(key(&of_cameras()["top_down"], "band").default.as_deref(), Some("0.1"));
        assert_eq!(
            key(&of_cameras()["fisheye"], "mapping").choices,
            ["equidistant", "equisolid", "stereographic", "orthographic"]
        );
    }

    /// The keys that the refusal of an unknown one names.
    fn known(text: &str) -> Vec<String> {
        let refusal = file::of_text(text, Path::new("s.toml"), 0.0, &Loading::default()).unwrap_err().to_string();
        let (_, list) = refusal.split_once("(known: ").unwrap_or_else(|| panic!("{refusal}"));
        list.trim_end_matches(')').split(", ").map(String::from).collect()
    }

    #[test]
    fn the_sections_tables_are_complete() {
        let camera = "[camera]\nkind = \"pinhole\"\neye = [0, 0, 1]\ntarget = [0, 0, 0]\nvfov = 40\n";
        for (section, keys) in of_all_sections() {
            let is_list = section.ends_with("light") || ["mesh", "spheres"].contains(&section);
            let header = if is_list { format!("[[{section}]]") } else { format!("[{section}]") };
            let mut names: Vec<String> = keys.into_iter().map(|key| key.name).collect();
            let mut known = known(&format!("{camera}{header}\nunknown = 1\n"));
            names.sort();
            known.sort();
            assert_eq!(names, known, "{section}");
        }
    }

    /// Keys that are known only beside others.
    const BESIDE: [(&str, &str); 4] =
        [("cross_slit", "center"), ("cross_slit", "right"), ("surround", "file"), ("surround", "scale")];

    #[test]
    fn every_key_in_the_help_of_a_camera_is_known_to_it() {
        for (kind, keys) in of_cameras() {
            let known = known(&format!("[camera]\nkind = {kind:?}\nunknown = 1\n"));
            let is_known = |key: &&Key| known.contains(&key.name) || BESIDE.contains(&(kind, &key.name));
            let unknown: Vec<&Key> = keys.iter().filter(|key| !is_known(key)).collect();
            assert!(unknown.is_empty() && !keys.is_empty(), "{kind}: {unknown:?}");
        }
    }
}
