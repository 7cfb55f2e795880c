//! The text of the scene file that is viewed: edits that keep its comments, undo and redo, saving, and the command line that renders it.

use super::paths;
use super::values::{self, is_keys};
use crate::image::{read_pairs, write_text};
use crate::input::load::read_text;
use crate::input::parse::{self, Format};
use crate::input::tree::Node;
use crate::input::{Error, Limits, Loading, Result};
use crate::scene::file::{self, SceneFile};
use serde::Deserialize;
use serde_json::Value as Json;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use toml_edit::DocumentMut;

/// A change of one value.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Edit {
    /// Its dotted path, as for `--set`; one past a list's last index adds an item.
    pub path: String,
    /// The new value; `null` removes the key or the item of a list.
    pub value: Json,
}

impl Edit {
    fn new(path: &str, value: Json) -> Edit {
        Edit { path: path.into(), value }
    }
}

/// A drag of a handle or a slider: a page, and its number there. The edits of one gesture are undone together.
pub type Gesture = (u64, u64);

/// Texts kept for undo: at most so many, and so many bytes together.
const UNDO_MAX: usize = 500;
const UNDO_BYTES: usize = 32 << 20;
/// Offsets that are written into a scene's text.
const OFFSETS_MAX: usize = 1024;
/// The longest text of a scene that is edited.
pub const TEXT_MAX: usize = 4 << 20;

/// Keyframes of a scene.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Keys {
    /// The first and the last frame with a key; `None` without keys.
    pub frames: Option<[f64; 2]>,
    /// The dotted paths of all keyframed values.
    pub paths: Vec<String>,
    /// The camera's keys are poses of a file.
    pub has_poses: bool,
}

pub struct Document {
    /// The scene file, from whose folder relative paths start.
    pub path: PathBuf,
    /// Where it is saved: the scene file, or for a .json the .toml beside it; `None` for a scene in memory.
    target: Option<PathBuf>,
    text: String,
    /// The text of `target`; `None`: there is no such file yet, as far as this program wrote it.
    saved: Option<String>,
    undo: Vec<String>,
    redo: Vec<String>,
    gesture: Option<Gesture>,
    /// The limits of every load of the text.
    pub limits: Limits,
}

impl Document {
    /// Reads a scene file. JSON becomes TOML.
    ///
    /// # Errors
    /// Those of [`file::load`].
    pub fn open(path: &Path, limits: Limits) -> Result<Document> {
        let text = read_text(path, &Loading::new(limits))?;
        let (target, text, saved) = match Format::of(path)? {
            Format::Toml => (path.to_owned(), text.clone(), Some(text)),
            Format::Json => {
                let root = parse::parse(&text, Format::Json, path)?;
                (
                    path.with_extension("toml"),
                    values::toml(&root).map_err(|why| Error::input(why).at(path.display()))?,
                    None,
                )
            }
        };
        if text.len() > TEXT_MAX {
            let (name, bytes) = (path.display(), text.len());
            return Err(Error::input(format!("{name}: {bytes} bytes of text; view takes at most {TEXT_MAX}")));
        }
        Ok(Document::new(path.to_owned(), text, limits, Some(target), saved))
    }

    fn new(path: PathBuf, text: String, limits: Limits, target: Option<PathBuf>, saved: Option<String>) -> Document {
        Document { path, target, text, saved, undo: Vec::new(), redo: Vec::new(), gesture: None, limits }
    }

    /// The document of a scene in memory: its camera, a table in TOML or, where it begins with a brace, JSON; and the size of the image.
    /// Relative paths in it start from `folder`.
    ///
    /// # Errors
    /// [`Error::Input`] for a table that is neither.
    pub fn of_camera(camera: &str, size: Option<(u32, u32)>, folder: &Path, limits: Limits) -> Result<Document> {
        let path = folder.join("scene.toml");
        let format = if camera.trim_start().starts_with('{') { Format::Json } else { Format::Toml };
        let mut scene = serde_json::Map::new();
        if let Some((width, height)) = size {
            scene.insert("image".into(), serde_json::json!({ "width": width, "height": height }));
        }
        scene.insert("camera".into(), values::json(&parse::parse(camera, format, Path::new("camera"))?));
        let root = parse::parse(&Json::Object(scene).to_string(), Format::Json, &path)?;
        let text = values::toml(&root).map_err(Error::input)?;
        Ok(Document::new(path, text, limits, None, None))
    }

    /// Applies the changes of a command line: the image's size, and `key=value` texts as of `--set`.
    ///
    /// # Errors
    /// [`Error::Input`] for a text without a value, and for a path that leads nowhere.
    pub fn change(&mut self, size: Option<(u32, u32)>, set: &[String], frame: f64) -> Result<()> {
        let sides = |(width, height): (u32, u32)| {
            [Edit::new("image.width", width.into()), Edit::new("image.height", height.into())]
        };
        self.edit(&size.map(sides).into_iter().flatten().collect::<Vec<Edit>>(), frame, None)?;
        if set.is_empty() {
            return Ok(());
        }
        // in place of keyframes too, as `render` has it
        let mut document = self.parsed()?;
        for text in set {
            let wrong = |why: &dyn std::fmt::Display| Error::input(format!("--set {text:?}: {why}"));
            let (path, value) = text.split_once('=').ok_or_else(|| wrong(&"no '='; write it as key=value"))?;
            let steps: Vec<&str> = path.trim().split('.').collect();
            let value = values::value(&values::json(&parse::parse_set_value(value))).map_err(|why| wrong(&why))?;
            paths::set(&mut document, &steps, value).map_err(|why| wrong(&why))?;
        }
        self.replace(self.with_line_ends(document.to_string()), None)
    }

    pub fn text(&self) -> &str {
        &self.text
    }

    /// What it is called: the file that [`Document::save`] writes, if there is one.
    pub fn name(&self) -> String {
        self.target.as_ref().map_or("a scene in memory".into(), |target| target.display().to_string())
    }

    /// Whether it can be saved to a file.
    pub fn has_file(&self) -> bool {
        self.target.is_some()
    }

    pub fn is_saved(&self) -> bool {
        self.saved.as_ref() == Some(&self.text)
    }

    pub fn can_undo(&self) -> bool {
        !self.undo.is_empty()
    }

    pub fn can_redo(&self) -> bool {
        !self.redo.is_empty()
    }

    /// The scene at a frame, its values checked.
    ///
    /// # Errors
    /// Those of [`file::load`].
    pub fn scene_file(&self, frame: f64) -> Result<SceneFile> {
        file::of_text(&self.text, &self.path, frame, &self.loading())
    }

    /// All values at a frame: keyframed ones as numbers.
    ///
    /// # Errors
    /// [`Error::Input`] for text that is not TOML, and for wrong keyframes.
    pub fn values(&self, frame: f64) -> Result<Json> {
        let root = file::values(&self.text, &self.path, frame, &self.loading())?;
        Ok(values::json(&root))
    }

    /// What moves from frame to frame.
    pub fn keys(&self) -> Keys {
        // of text that cannot be read, nothing does
        let Ok(root) = self.root() else { return Keys::default() };
        let Ok(expanded) = file::expanded(&self.text, &self.path, &self.loading()) else { return Keys::default() };
        let ((frames, expanded), (_, paths)) = (values::keys(&expanded), values::keys(&root));
        Keys { frames, has_poses: expanded != paths, paths }
    }

    /// Changes values. A keyframed value gets a key at `frame`.
    ///
    /// # Errors
    /// [`Error::Input`] for a path that leads nowhere; the text is then unchanged.
    pub fn edit(&mut self, edits: &[Edit], frame: f64, gesture: Option<Gesture>) -> Result<()> {
        let wrong = |edit: &Edit, why: String| Error::input(format!("{}: {why}", edit.path));
        if edits.is_empty() {
            return Ok(());
        }
        let mut document = self.parsed()?;
        let mut at_frame = None;
        for edit in edits {
            let steps: Vec<&str> = edit.path.split('.').collect();
            if steps.iter().any(|step| step.is_empty()) {
                return Err(wrong(edit, "write a dotted path, as camera.eye".into()));
            }
            let keys = (1..=steps.len()).find(|n| paths::get(&document, &steps[..*n]).is_some_and(is_keys));
            match (keys, &edit.value) {
                (n, Json::Null) if n.is_none_or(|n| n == steps.len()) => {
                    paths::remove(&mut document, &steps).map_err(|why| wrong(edit, why))?;
                }
                (None, value) => {
                    let value = values::value(value).map_err(|why| wrong(edit, why))?;
                    paths::set(&mut document, &steps, value).map_err(|why| wrong(edit, why))?;
                }
                (Some(n), value) => {
                    let all = match &at_frame {
                        Some(all) => all,
                        None => at_frame.insert(self.values(frame)?),
                    };
                    let mut whole = values::get(all, &steps[..n]).cloned().unwrap_or_default();
                    match values::get_mut(&mut whole, &steps[n..]) {
                        Some(part) => *part = value.clone(),
                        None => return Err(wrong(edit, "there is no such number".into())),
                    }
                    let whole = values::value(&whole).map_err(|why| wrong(edit, why))?;
                    paths::set_key(&mut document, &steps[..n], frame, whole).map_err(|why| wrong(edit, why))?;
                }
            }
        }
        self.replace(self.with_line_ends(document.to_string()), gesture)
    }

    /// The text, to be changed.
    fn parsed(&self) -> Result<DocumentMut> {
        // its errors name the line
        self.root()?;
        self.text.parse().map_err(|_| Error::input("the scene's text is not TOML"))
    }

    /// Text with lines that end as those of the file; `toml_edit` ends them by a line feed alone.
    fn with_line_ends(&self, text: String) -> String {
        if self.text.contains("\r\n") { text.replace("\r\n", "\n").replace('\n', "\r\n") } else { text }
    }

    /// Writes the offsets of a `camera_texture`, which are in a file, into the scene.
    ///
    /// # Errors
    /// [`Error::Input`] if the camera has no such file, or too many offsets for a scene's text; those of reading the file.
    pub fn inline_offsets(&mut self, values: &Json, frame: f64) -> Result<()> {
        let Some(file) = values["camera"]["file"].as_str() else {
            return Err(Error::input("camera: its offsets are in no file"));
        };
        let folder = self.path.parent().unwrap_or(Path::new(""));
        let (columns, rows, offsets) = read_pairs(&folder.join(file), &self.loading())?;
        if offsets.len() > OFFSETS_MAX {
            let size = format!("{columns} x {rows}");
            return Err(Error::input(format!(
                "{file}: {size} offsets are too many to edit; {OFFSETS_MAX} are the most"
            )));
        }
        let rows: Vec<Vec<[f64; 2]>> =
            offsets.chunks(columns as usize).map(|row| row.iter().map(|o| o.to_array()).collect()).collect();
        self.edit(&[Edit::new("camera.offsets", rows.into()), Edit::new("camera.file", Json::Null)], frame, None)
    }

    /// Replaces the whole text, which need not be valid.
    ///
    /// # Errors
    /// [`Error::Input`] if it is too long.
    pub fn replace(&mut self, text: String, gesture: Option<Gesture>) -> Result<()> {
        if text.len() > TEXT_MAX {
            return Err(Error::input(format!("{} bytes of text; view takes at most {TEXT_MAX}", text.len())));
        }
        if text == self.text {
            return Ok(());
        }
        let before = std::mem::replace(&mut self.text, text);
        if gesture.is_none() || gesture != self.gesture || self.undo.is_empty() {
            self.undo.push(before);
            let bytes = |undo: &[String]| undo.iter().map(String::len).sum::<usize>();
            while self.undo.len() > UNDO_MAX || bytes(&self.undo) > UNDO_BYTES {
                self.undo.remove(0);
            }
        }
        self.redo.clear();
        self.gesture = gesture;
        Ok(())
    }

    pub fn undo(&mut self) {
        if let Some(text) = self.undo.pop() {
            self.redo.push(std::mem::replace(&mut self.text, text));
            self.gesture = None;
        }
    }

    pub fn redo(&mut self) {
        if let Some(text) = self.redo.pop() {
            self.undo.push(std::mem::replace(&mut self.text, text));
            self.gesture = None;
        }
    }

    /// Writes the text to its file, whole or not at all.
    ///
    /// # Errors
    /// [`Error::Input`] if the file was changed by others since it was read or written here; [`Error::Write`] if it cannot be written.
    pub fn save(&mut self) -> Result<()> {
        let Some(target) = &self.target else { return Err(Error::input("this scene has no file; download it")) };
        let name = target.display();
        let is_ours = match std::fs::metadata(target) {
            Err(e) => e.kind() == ErrorKind::NotFound,
            Ok(file) if !file.is_file() => return Err(Error::input(format!("{name}: not a file; download the scene"))),
            Ok(_) => match std::fs::read_to_string(target) {
                Ok(found) => self.saved.as_ref() == Some(&found) || found == self.text,
                // bytes that are no text are not from here
                Err(e) if e.kind() == ErrorKind::InvalidData => false,
                Err(e) => {
                    let why = format!("{name}: cannot be compared with the text that was read: {e}");
                    return Err(Error::Write(format!("{why}; nothing is saved; try again or download the scene")));
                }
            },
        };
        if !is_ours {
            return Err(Error::input(format!(
                "{name}: another program has changed or created it; download the scene, or move that file away"
            )));
        }
        write_text(target, &self.text)?;
        self.saved = Some(self.text.clone());
        Ok(())
    }

    /// The command that renders what is viewed: the file as it is saved, and `--set` for what differs from it.
    ///
    /// # Errors
    /// [`Error::Input`] if no `--set` can say it, since a section was removed.
    pub fn command(&self, frame: f64, samples: u32) -> Result<String> {
        let Some(target) = &self.target else {
            return Err(Error::input("this scene is in memory; no command line renders it"));
        };
        let (file, on_disk) = match &self.saved {
            Some(saved) => (target, parse::parse(saved, Format::Toml, target)?),
            // of JSON, which the text was made from
            None => {
                let text = read_text(&self.path, &self.loading())?;
                (&self.path, parse::parse(&text, Format::Json, &self.path)?)
            }
        };
        let Some(sets) = values::assignments(&on_disk, &self.root()?) else {
            return Err(Error::input("a section was removed, which no --set can say; save the scene first"));
        };
        let mut words = vec!["anamorph".into(), "render".into(), quoted(&file.display().to_string())];
        words.extend(sets.iter().flat_map(|set| ["--set".into(), quoted(set)]));
        if frame != 0.0 {
            words.extend(["--frame".into(), frame.to_string()]);
        }
        if samples > 1 {
            words.extend(["--samples".into(), samples.to_string()]);
        }
        let picture = file.with_extension("png");
        let name = picture.file_name().unwrap_or_default().to_string_lossy().into_owned();
        words.extend(["-o".into(), quoted(&name)]);
        Ok(words.join(" "))
    }

    /// A load of the text.
    fn loading(&self) -> Loading {
        Loading::new(self.limits)
    }

    fn root(&self) -> Result<Node> {
        parse::parse(&self.text, Format::Toml, &self.path)
    }
}

/// A word of a POSIX shell.
fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_./=,:+".contains(c);
    if !word.is_empty() && word.chars().all(is_plain) {
        word.into()
    } else {
        format!("'{}'", word.replace('\'', "'\\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    const TEXT: &str = "# seen\n[camera]\nkind = \"pinhole\"\neye = [{ frame = 0, value = [0, 0, 4] }, { frame = 10, value = [0, 0, 8] }]\n\
                        target = [0, 0, 0]\nvfov = 40 # degrees\n";

    fn open(name: &str, text: &str) -> (tempfile::TempDir, Document) {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join(name);
        std::fs::write(&path, text).unwrap();
        let document = Document::open(&path, Limits::default()).unwrap();
        (dir, document)
    }

    fn edit(document: &mut Document, path: &str, value: Json, gesture: Option<Gesture>) -> Result<()> {
        document.edit(&[Edit { path: path.into(), value }], 5.0, gesture)
    }

    #[test]
    fn edits_of_a_gesture_are_undone_together() {
        let (_dir, mut document) = open("s.toml", TEXT);
        for (vfov, gesture) in
            [(41, Some((1, 1))), (42, Some((1, 1))), (43, Some((1, 2))), (44, Some((2, 2))), (45, None)]
        {
            edit(&mut document, "camera.vfov", json!(vfov), gesture).unwrap();
        }
        assert_eq!(document.text(), TEXT.replace("40", "45"));
        let mut seen = Vec::new();
        while document.can_undo() {
            document.undo();
            seen.push(document.values(0.0).unwrap()["camera"]["vfov"].clone());
        }
        assert_eq!(seen, [json!(44), json!(43), json!(42), json!(40)]);
        assert!(document.text() == TEXT && document.is_saved());
        document.redo();
        assert_eq!(document.text(), TEXT.replace("40", "42"));
        edit(&mut document, "camera.vfov", json!(50), None).unwrap();
        assert!(!document.can_redo());
    }

    #[test]
    fn keyframed_values_get_a_key_at_the_frame() {
        let (_dir, mut document) = open("s.toml", TEXT);
        assert_eq!(
            document.keys(),
            Keys { frames: Some([0.0, 10.0]), paths: vec!["camera.eye".into()], has_poses: false }
        );
        // one number of three: the others are those of the frame
        edit(&mut document, "camera.eye.0", json!(1.5), None).unwrap();
        assert_eq!(document.values(5.0).unwrap()["camera"]["eye"], json!([1.5, 0, 6]));
        assert_eq!(document.values(10.0).unwrap()["camera"]["eye"], json!([0, 0, 8]));
        assert!(edit(&mut document, "camera.eye.3", json!(1), None).is_err());
        // as a whole it is removed with its keys
        edit(&mut document, "camera.eye", Json::Null, None).unwrap();
        assert!(!document.text().contains("eye") && document.keys().frames.is_none());
    }

    #[test]
    fn line_ends_and_text_that_is_not_touched_stay() {
        let text = TEXT.replace('\n', "\r\n");
        let (_dir, mut document) = open("s.toml", &text);
        document.change(None, &[], 0.0).unwrap();
        assert!(document.text() == text && document.is_saved() && !document.can_undo());
        edit(&mut document, "camera.vfov", json!(45), None).unwrap();
        assert_eq!(document.text(), text.replace("40", "45"));
    }

    #[test]
    fn only_what_is_known_is_overwritten() {
        let (dir, mut document) = open("s.toml", TEXT);
        let path = dir.path().join("s.toml");
        edit(&mut document, "camera.vfov", json!(45), None).unwrap();
        std::fs::write(&path, "other").unwrap();
        assert!(document.save().unwrap_err().to_string().contains("another program"));
        std::fs::write(&path, TEXT).unwrap();
        document.save().unwrap();
        assert!(std::fs::read_to_string(&path).unwrap() == document.text() && document.is_saved());
        // a file that is gone is written again
        std::fs::remove_file(&path).unwrap();
        document.save().unwrap();
        assert!(path.exists());
    }

    #[test]
    fn json_becomes_toml_beside_it() {
        let (dir, mut document) = open(
            "s.json",
            "{ \"camera\": { \"kind\": \"pinhole\", \"eye\": [0, 0, 4], \"target\": [0, 0, 0], \"vfov\": 40 } }",
        );
        assert!(document.text().starts_with("[camera]\n") && !document.is_saved());
        let file = |name: &str| dir.path().join(name).display().to_string();
        edit(&mut document, "camera.vfov", json!(45), None).unwrap();
        let command = document.command(0.0, 1).unwrap();
        assert_eq!(command, format!("anamorph render {} --set camera.vfov=45 -o s.png", file("s.json")));
        document.save().unwrap();
        assert_eq!(
            document.command(2.5, 4).unwrap(),
            format!("anamorph render {} --frame 2.5 --samples 4 -o s.png", file("s.toml"))
        );
    }

    #[test]
    fn command_lines_say_what_was_changed() {
        let (dir, mut document) = open("a scene.toml", TEXT);
        edit(&mut document, "camera.target", json!([0, 1, 0]), None).unwrap();
        edit(&mut document, "image.tone", json!("it's"), None).unwrap();
        edit(&mut document, "camera.vfov", Json::Null, None).unwrap();
        let path = dir.path().join("a scene.toml");
        let command = document.command(0.0, 1).unwrap();
        let camera = "camera={ \"eye\" = [{";
        assert!(command.starts_with(&format!("anamorph render '{}' --set '{camera}", path.display())), "{command}");
        assert!(command.ends_with("--set 'image={ \"tone\" = \"it'\\''s\" }' -o 'a scene.png'"), "{command}");
        edit(&mut document, "camera", Json::Null, None).unwrap();
        assert!(document.command(0.0, 1).unwrap_err().to_string().contains("save the scene first"));
    }

    #[test]
    fn sets_of_the_command_line_replace_keyframes() {
        let (_dir, mut document) = open("s.toml", TEXT);
        document.change(Some((8, 6)), &["camera.eye=[1, 2, 3]".into(), "camera.up = [0, 0, 1]".into()], 0.0).unwrap();
        let values = document.values(7.0).unwrap();
        assert_eq!(values["image"], json!({ "width": 8, "height": 6 }));
        assert_eq!((&values["camera"]["eye"], &values["camera"]["up"]), (&json!([1, 2, 3]), &json!([0, 0, 1])));
        for (set, why) in [("camera.vfov", "no '='"), ("camera.kind.x=1", "single value")] {
            let refused = document.change(None, &[set.into()], 0.0).unwrap_err().to_string();
            assert!(refused.contains(why), "{set}: {refused}");
        }
    }
}
