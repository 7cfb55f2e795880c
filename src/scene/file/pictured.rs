//! The scene of a picture that was rendered, from the keys in its header.

use super::header::take;
use super::{SceneFile, read_tree};
use crate::arrays::MapEach;
use crate::input::parse::{Format, parse};
use crate::input::reader::Source;
use crate::input::tree::{Entry, Node, Value};
use crate::input::{Error, Loading, Result, overrides};
use std::path::Path;

/// The scene of a camera in a picture's header: the camera, and the meshes that it looks at. `text` is a JSON object with the entries of
/// [`CameraKeys::json`](super::CameraKeys::json) and the image's `width` and `height`. `overrides` are as for [`super::load`].
///
/// # Errors
/// [`Error::Input`] naming the picture at `path` and the key.
pub fn load_header(text: &str, path: &Path, overrides: &[String], loading: &Loading) -> Result<SceneFile> {
    let Node { value: Value::Table(mut entries), place } = parse(text, Format::Json, path)? else {
        return Err(no_camera(path));
    };
    let mut take = |key: &str| take(&mut entries, key);
    if take("moves").is_some() {
        let path = path.display();
        return Err(Error::input(format!(
            "{path}: its camera moved while the picture was taken, and the header does not say how; give the scene file"
        )));
    }
    let (Some(camera), Some(width), Some(height)) = (take("keys"), take("width"), take("height")) else {
        return Err(no_camera(path));
    };
    let folder = match take("folder").map(|node| node.value) {
        Some(Value::Text(folder)) => folder,
        _ => String::new(),
    };
    let table = |entries: Vec<(&str, Node)>| {
        let entry = |(key, node): (&str, Node)| Entry { key: key.into(), place, node };
        Node { value: Value::Table(entries.into_iter().map(entry).collect()), place }
    };
    let image = table(vec![("width", width), ("height", height)]);
    let others = ["mesh", "spheres"].map_each(|key| take(key).map(|node| (key, node)));
    let given = [("image", image), ("camera", camera)].into_iter().chain(others.into_iter().flatten());
    let mut root = table(given.collect());
    overrides::apply(&mut root, overrides)?;
    let dir = path.parent().unwrap_or(Path::new("")).join(folder);
    read_tree(root, &Source::new(path, &dir, loading))
}

fn no_camera(path: &Path) -> Error {
    let path = path.display();
    Error::input(format!("{path}: its header does not hold the keys of the camera; render it again with this version"))
}
