//! A camera's keys in the header of a picture, which make the same rays without the scene file.

use crate::arrays::MapEach;
use crate::camera::kinds::read_camera_of_scene;
use crate::camera::pose::Pose;
use crate::camera::spec::{CameraKind, CameraSpec};
use crate::input::reader::{Field, Source};
use crate::input::tree::{Entry, Node, Value};
use crate::input::{Error, Loading, Result};
use serde_json::{Map, Value as Json};
use std::path::{Path, PathBuf};

/// The tables of the camera, the meshes and the spheres in a scene file, with overrides and keyframes applied. All but the first are for cameras that look at
/// them.
#[derive(Debug, Clone, Default)]
pub struct CameraKeys {
    camera: Option<Node>,
    meshes: Option<Node>,
    spheres: Option<Node>,
    /// Whether the camera names files, and whether a mesh or spheres do.
    names_files: [bool; 2],
    /// The folder that relative paths start from.
    dir: PathBuf,
}

impl PartialEq for CameraKeys {
    /// Compares values, not where in the file they are.
    fn eq(&self, other: &CameraKeys) -> bool {
        let written = |keys: &CameraKeys| {
            [&keys.camera, &keys.meshes, &keys.spheres].map_each(|node| node.as_ref().map(|n| json(&n.value)))
        };
        (&self.dir, written(self)) == (&other.dir, written(other))
    }
}

impl CameraKeys {
    /// Takes the tables out of a scene file's tree.
    pub(super) fn taken(root: Node, names_files: [bool; 2], dir: &Path) -> CameraKeys {
        let Value::Table(mut entries) = root.value else { return CameraKeys::default() };
        let [camera, meshes, spheres] = ["camera", "mesh", "spheres"].map_each(|key| take(&mut entries, key));
        CameraKeys { camera, meshes, spheres, names_files, dir: dir.into() }
    }

    /// The keys of a `[camera]` table alone, whose relative paths start from `folder`.
    pub(crate) fn of_table(table: Node, folder: &Path) -> CameraKeys {
        CameraKeys { camera: Some(table), dir: folder.into(), ..CameraKeys::default() }
    }

    /// The camera's number of this key, as `vfov` or `eye.0`, or that of its file, as `fx`.
    ///
    /// # Errors
    /// [`Error::Input`] if there is no such number.
    pub fn number(&self, key: &str, loading: &Loading) -> Result<f64> {
        let mut all = Vec::new();
        if let Some(camera) = &self.camera {
            numbers(camera, "", &mut all);
        }
        let of_file = self.spec(None, loading)?.kind.recipe.numbers();
        all.extend(of_file.into_iter().map(|(name, value)| (name.into(), value)));
        if let Some((_, value)) = all.iter().find(|(name, _)| name == key) {
            return Ok(*value);
        }
        let known: Vec<&str> = all.iter().take(NUMBERS_SHOWN).map(|(name, _)| name.as_str()).collect();
        let more = if all.len() > NUMBERS_SHOWN { " and more" } else { "" };
        let known = if known.is_empty() { "no numbers".into() } else { format!("{}{more}", known.join(", ")) };
        Err(Error::input(format!("camera.{key}: the camera's table has no such number; it has {known}")))
    }

    /// The camera with another number of this key.
    ///
    /// # Errors
    /// [`Error::Input`] if it cannot have this value.
    pub fn with_number(&self, key: &str, value: f64, loading: &Loading) -> Result<CameraSpec> {
        let Some(mut camera) = self.camera.clone() else { return self.spec(None, loading) };
        if let Some(number) = number_mut(&mut camera, key) {
            *number = Value::Float(value);
            return self.spec(Some(&camera), loading);
        }
        let spec = self.spec(None, loading)?;
        match spec.kind.recipe.with_number(key, value)? {
            Some(recipe) => Ok(CameraSpec { kind: CameraKind { recipe, ..spec.kind }, ..spec }),
            None => Err(Error::input(format!("camera.{key}: there is no such number"))),
        }
    }

    /// Of these keys, or of its own.
    fn spec(&self, keys: Option<&Node>, loading: &Loading) -> Result<CameraSpec> {
        let Some(camera) = keys.or(self.camera.as_ref()) else {
            return Err(Error::input(
                "the camera has no keys whose numbers could change; give it by its kind and keys",
            ));
        };
        let path = Path::new("camera");
        read_camera_of_scene(&Field::new(&Source::new(path, &self.dir, loading), "camera", camera))
    }

    /// The folder that relative paths in them start from.
    #[cfg(feature = "view")]
    pub fn folder(&self) -> &Path {
        &self.dir
    }

    /// For the header of a picture in `folder`: `keys` is the camera; `mesh` the meshes and `spheres` the spheres, if `uses_scene`, that is,
    /// the camera depends on them; and `folder`, if these name files, the path from the picture's folder to the folder that relative paths start from. Empty if
    /// the camera is not from a file.
    pub fn json(&self, uses_scene: bool, folder: &Path) -> Map<String, Json> {
        let mut map = Map::new();
        let Some(camera) = &self.camera else { return map };
        map.insert("keys".into(), json(&camera.value));
        let looked_at = [("mesh", &self.meshes), ("spheres", &self.spheres)].into_iter().filter(|_| uses_scene);
        map.extend(looked_at.filter_map(|(key, node)| Some((key.into(), json(&node.as_ref()?.value)))));
        if self.names_files[0] || (uses_scene && self.names_files[1]) {
            map.insert("folder".into(), relative_path(folder, &self.dir).to_string_lossy().into_owned().into());
        }
        map
    }

    /// The pose of the camera, or of the eye in front of its mirror or lens; `None` if it has none.
    pub fn pose(&self) -> Option<Pose> {
        // a pose names no file
        let (path, loading) = (Path::new(""), Loading::default());
        let source = Source::new(path, path, &loading);
        let table = Field::new(&source, "camera", self.camera.as_ref()?).table().ok()?;
        match table.get("eye").filter(Field::is_table) {
            Some(eye) => Pose::read(&eye.table().ok()?).ok(),
            None => Pose::read(&table).ok(),
        }
    }
}

/// So many keys are named where one is not known.
const NUMBERS_SHOWN: usize = 24;

/// All numbers below a value, by dotted paths.
fn numbers(node: &Node, path: &str, all: &mut Vec<(String, f64)>) {
    let below = |key: &str| if path.is_empty() { key.into() } else { format!("{path}.{key}") };
    match &node.value {
        Value::Int(i) => all.push((path.into(), *i as f64)),
        Value::Float(x) if x.is_finite() => all.push((path.into(), *x)),
        Value::List(items) => items.iter().enumerate().for_each(|(k, n)| numbers(n, &below(&k.to_string()), all)),
        Value::Table(entries) => entries.iter().for_each(|e| numbers(&e.node, &below(&e.key), all)),
        _ => {}
    }
}

/// The number at a dotted path.
fn number_mut<'a>(node: &'a mut Node, path: &str) -> Option<&'a mut Value> {
    let at = |node: &'a mut Node, key: &str| match &mut node.value {
        Value::Table(entries) => entries.iter_mut().find(|e| e.key == key).map(|e| &mut e.node),
        Value::List(items) => key.parse::<usize>().ok().and_then(|k| items.get_mut(k)),
        _ => None,
    };
    let found = path.split('.').try_fold(node, at)?;
    matches!(found.value, Value::Int(_) | Value::Float(_)).then_some(&mut found.value)
}

/// Removes an entry from a table.
pub(super) fn take(entries: &mut Vec<Entry>, key: &str) -> Option<Node> {
    let at = entries.iter().position(|e| e.key == key)?;
    Some(entries.swap_remove(at).node)
}

/// The path from one folder to another; absolute if they have no common root.
fn relative_path(from: &Path, to: &Path) -> PathBuf {
    let here = |path: &Path| if path.as_os_str().is_empty() { PathBuf::from(".") } else { path.into() };
    let (Ok(from), Ok(to)) = (here(from).canonicalize(), here(to).canonicalize()) else { return to.into() };
    let common = from.components().zip(to.components()).take_while(|(a, b)| a == b).count();
    if common == 0 {
        return to;
    }
    let up = from.components().skip(common).map(|_| Path::new("..").as_os_str());
    up.chain(to.components().skip(common).map(|c| c.as_os_str())).collect()
}

/// The value as JSON. Numbers are read back to the last bit.
fn json(value: &Value) -> Json {
    match value {
        Value::Null => Json::Null,
        Value::Bool(b) => (*b).into(),
        Value::Int(i) => i64::try_from(*i)
            .map(Json::from)
            .or_else(|_| u64::try_from(*i).map(Json::from))
            .unwrap_or(Json::from(*i as f64)),
        Value::Float(x) if x.is_infinite() => (if *x > 0.0 { "inf" } else { "-inf" }).into(),
        Value::Float(x) => (*x).into(),
        Value::Text(text) => text.as_str().into(),
        Value::List(items) => items.iter().map(|item| json(&item.value)).collect(),
        Value::Table(entries) => Json::Object(entries.iter().map(|e| (e.key.clone(), json(&e.node.value))).collect()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::parse::{Format, parse};

    #[test]
    fn relative_paths_lead_from_folder_to_folder() {
        let dir = tempfile::tempdir().unwrap();
        let folder = |name: &str| {
            let path = dir.path().join(name);
            std::fs::create_dir_all(&path).unwrap();
            path
        };
        let (a, b) = (folder("one/two/a"), folder("one/b"));
        assert_eq!(relative_path(&a, &b), Path::new("../../b"));
        assert_eq!(relative_path(&b, &a), Path::new("../two/a"));
        assert_eq!(relative_path(&a, &a), Path::new(""));
    }

    #[test]
    fn values_read_back_to_the_last_bit() {
        let text = "{\"a\": [0.1, 2.0, -0.0, 5e-324, 18446744073709551615, -3, 1.7976931348623157e308], \"b\": {\"c\": \"inf\", \"d\": true}}";
        let path = Path::new("x.json");
        let tree = parse(text, Format::Json, path).unwrap();
        let again = parse(&json(&tree.value).to_string(), Format::Json, path).unwrap();
        assert_eq!(json(&tree.value).to_string(), json(&again.value).to_string());
        let Value::Table(entries) = again.value else { panic!() };
        let Value::List(items) = &entries[0].node.value else { panic!() };
        let bits: Vec<u64> = items
            .iter()
            .map(|n| match n.value {
                Value::Float(x) => x.to_bits(),
                Value::Int(i) => (i as f64).to_bits(),
                _ => 0,
            })
            .collect();
        let expected = [0.1, 2.0, -0.0, 5e-324, 18446744073709551615.0, -3.0, f64::MAX];
        assert_eq!(bits, expected.map(f64::to_bits));
        assert_eq!(json(&Value::Float(f64::NEG_INFINITY)), "-inf");
    }
}
