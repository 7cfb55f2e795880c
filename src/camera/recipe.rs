//! The interface of camera kinds: reading the keys of a kind, and building its rays.

use super::Rays;
use super::exposure::Lines;
use crate::camera::composition::Composition;
use crate::camera::notes::Notes;
use crate::camera::optics::Optics;
use crate::geometry::mesh::{Mesh, joined};
use crate::geometry::scene_mesh::SceneMesh;
use crate::input::reader::Table;
use crate::input::{Error, Limits, Loading, Result};
use glam::DVec3;
use std::any::Any;
use std::cell::Cell;
use std::fmt::Debug;
use std::sync::Arc;

/// One kind of camera.
pub struct Kind {
    /// The `kind` of a scene file.
    pub name: &'static str,
    /// Help text: its keys, their units and its formula.
    pub help: &'static str,
    /// Reads its table; unknown keys are errors.
    pub read: fn(&Table) -> Result<Arc<dyn Recipe>>,
}

/// The keys that can replace eye, target and up, for the help of kinds that have these.
pub const POSE: &str = include_str!("help/pose.txt");

impl Kind {
    /// Its help with all keys: a title, keys and formulas, with an empty line between. [`POSE`] comes after the kind's own keys.
    pub fn whole_help(&self) -> String {
        let mut parts: Vec<&str> = self.help.splitn(3, "\n\n").collect();
        let has = |key: &str| parts[1].split(|c: char| !c.is_alphanumeric()).any(|word| word == key);
        if has("eye") && has("target") {
            parts.insert(2, POSE.trim_end());
        }
        parts.join("\n\n")
    }
}

/// A camera as written, its values checked one by one. [`Recipe::build`] checks that they fit together.
pub trait Recipe: Any + Debug + Equal + Send + Sync {
    fn build(&self, setting: &Setting) -> Result<Built>;

    /// In what order lines are read and when, in seconds, if keys of the kind say so.
    fn lines(&self) -> Option<Lines> {
        None
    }

    /// The numbers that it has from a file, such as `fx`, by their names.
    fn numbers(&self) -> Vec<(&'static str, f64)> {
        Vec::new()
    }

    /// The same with another value of one of these numbers; `None`: it has none of this name.
    ///
    /// # Errors
    /// [`Error::Input`] for a value that the number cannot have.
    fn with_number(&self, _name: &str, _value: f64) -> Result<Option<Arc<dyn Recipe>>> {
        Ok(None)
    }
}

/// Equality of recipes behind `dyn`: those of the same type are compared by `==`.
pub trait Equal {
    fn equals(&self, other: &dyn Any) -> bool;
}

impl<T: Any + PartialEq> Equal for T {
    fn equals(&self, other: &dyn Any) -> bool {
        other.downcast_ref::<T>() == Some(self)
    }
}

/// The triangles that a camera looks at.
#[derive(Debug, Clone, Copy)]
pub enum Triangles<'a> {
    Mesh(&'a Mesh),
    /// One mesh is made of them only for a camera that reads it.
    OfScene(&'a SceneMesh),
}

impl<'a> Triangles<'a> {
    fn mesh(self) -> &'a Mesh {
        match self {
            Triangles::Mesh(mesh) => mesh,
            Triangles::OfScene(mesh) => mesh,
        }
    }

    fn bounds(self) -> Option<(DVec3, DVec3)> {
        match self {
            Triangles::Mesh(mesh) => mesh.bounds(),
            Triangles::OfScene(mesh) => mesh.bounds(),
        }
    }
}

/// What a camera looks at.
#[derive(Debug, Clone, Copy)]
pub struct Surroundings<'a> {
    pub triangles: Triangles<'a>,
    /// The corners of a box around all else that has a place: a volume, and the mesh at other times.
    pub beside: Option<(DVec3, DVec3)>,
    /// Rays that miss all of it show something, too: an environment.
    pub is_endless: bool,
}

impl<'a> From<&'a Mesh> for Surroundings<'a> {
    fn from(mesh: &'a Mesh) -> Surroundings<'a> {
        Surroundings { triangles: Triangles::Mesh(mesh), beside: None, is_endless: false }
    }
}

impl<'a> From<&'a SceneMesh> for Surroundings<'a> {
    fn from(mesh: &'a SceneMesh) -> Surroundings<'a> {
        Surroundings { triangles: Triangles::OfScene(mesh), beside: None, is_endless: false }
    }
}

impl<'a> From<&'a Arc<SceneMesh>> for Surroundings<'a> {
    fn from(mesh: &'a Arc<SceneMesh>) -> Surroundings<'a> {
        mesh.as_ref().into()
    }
}

/// What a recipe may depend on.
#[derive(Debug, Clone, Copy)]
pub struct Setting<'a> {
    /// The image's size in pixels, if the scene gives one.
    pub size: Option<(u32, u32)>,
    /// The t range of the scene file.
    pub t_range: [f64; 2],
    surroundings: Surroundings<'a>,
    loading: &'a Loading,
    scene_use: Option<&'a Cell<SceneUse>>,
}

/// How much of the scene a recipe reads.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum SceneUse {
    #[default]
    Nothing,
    Bounds,
    Mesh,
}

impl<'a> Setting<'a> {
    /// Of an image of `size`.
    pub fn new(
        size: Option<(u32, u32)>,
        seen: impl Into<Surroundings<'a>>,
        t_range: [f64; 2],
        loading: &'a Loading,
    ) -> Setting<'a> {
        Setting { size, t_range, surroundings: seen.into(), loading, scene_use: None }
    }

    /// Reads the files that a recipe names.
    pub fn loading(&self) -> &'a Loading {
        self.loading
    }

    pub fn limits(&self) -> Limits {
        self.loading.limits()
    }

    /// The same with something else, in the box with these corners, to look at.
    pub fn and(self, corners: (DVec3, DVec3)) -> Setting<'a> {
        let beside = self.surroundings.beside.map_or(corners, |beside| joined(beside, corners));
        Setting { surroundings: Surroundings { beside: Some(beside), ..self.surroundings }, ..self }
    }

    /// The same for a camera with this range of t; `scene_use` records how much of the scene it reads.
    pub fn noting<'b>(&self, t_range: [f64; 2], scene_use: &'b Cell<SceneUse>) -> Setting<'b>
    where
        'a: 'b,
    {
        Setting { t_range, scene_use: Some(scene_use), ..*self }
    }

    /// The same for an image of another size.
    pub fn of_size(self, size: Option<(u32, u32)>) -> Setting<'a> {
        Setting { size, ..self }
    }

    /// The image's size, which all but ray maps need.
    pub fn size(&self) -> Result<(u32, u32)> {
        self.size.ok_or_else(|| Error::input("image: no size; give width and height in [image] or --size"))
    }

    /// The scene's triangles, world units.
    pub fn mesh(&self) -> &'a Mesh {
        self.note_use(SceneUse::Mesh);
        self.surroundings.triangles.mesh()
    }

    /// The corners of the box around all that has a place; `None` without any.
    pub fn bounds(&self) -> Option<(DVec3, DVec3)> {
        self.note_use(SceneUse::Bounds);
        let Surroundings { triangles, beside, .. } = self.surroundings;
        triangles.bounds().into_iter().chain(beside).reduce(joined)
    }

    /// Rays that miss all that has a place show something, too.
    pub fn is_endless(&self) -> bool {
        self.note_use(SceneUse::Bounds);
        self.surroundings.is_endless
    }

    /// Records that a camera reads this much of the scene.
    pub(crate) fn note_use(&self, at: SceneUse) {
        if let Some(scene_use) = self.scene_use {
            scene_use.set(scene_use.get().max(at));
        }
    }
}

/// The rays of a camera.
#[derive(Debug, Clone)]
pub struct Built {
    /// Pixels.
    pub size: (u32, u32),
    /// One, or the layers of a chain, first to last.
    pub layers: Vec<Rays>,
    /// The range of t, if not that of the scene file: [0, 1] for chains and projectors.
    pub t_range: Option<[f64; 2]>,
    /// The mirror or lens in view.
    pub optics: Option<Arc<Optics>>,
    /// Notes for the user: what was left out or approximated.
    pub notes: Notes,
    /// Requests that cannot be fulfilled in this scene, one sentence each.
    pub unfulfilled: Vec<String>,
    /// The cameras of a composite.
    pub composition: Option<Arc<Composition>>,
}

impl Built {
    /// A camera of one layer.
    pub fn new(size: (u32, u32), rays: Rays) -> Built {
        Built::of_layers(size, vec![rays])
    }

    /// A camera of several layers.
    pub fn of_layers(size: (u32, u32), layers: Vec<Rays>) -> Built {
        let (notes, unfulfilled) = (Notes::default(), Vec::new());
        Built { size, layers, t_range: None, optics: None, notes, unfulfilled, composition: None }
    }
}
