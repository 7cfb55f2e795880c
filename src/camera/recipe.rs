//! The interface of camera kinds: reading the keys of a kind, and building its rays.

use super::Rays;
use super::exposure::Lines;
use crate::camera::kinds::composite::composition::Composition;
use crate::camera::optics::Optics;
use crate::geometry::mesh::Mesh;
use crate::input::reader::Table;
use crate::input::{Error, Result};
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

/// What a recipe may depend on.
#[derive(Debug, Clone, Copy)]
pub struct Setting<'a> {
    /// The image's size in pixels, if the scene gives one.
    pub size: Option<(u32, u32)>,
    /// The t range of the scene file.
    pub t_range: [f64; 2],
    mesh: &'a Mesh,
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
    /// Of an image of `size` in the scene of `mesh`.
    pub fn new(size: Option<(u32, u32)>, mesh: &'a Mesh, t_range: [f64; 2]) -> Setting<'a> {
        Setting { size, t_range, mesh, scene_use: None }
    }

    /// The same for a camera with this range of t; `scene_use` records how much of the scene it reads.
    pub fn noting<'b>(&self, t_range: [f64; 2], scene_use: &'b Cell<SceneUse>) -> Setting<'b>
    where
        'a: 'b,
    {
        Setting { size: self.size, t_range, mesh: self.mesh, scene_use: Some(scene_use) }
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
        self.mesh
    }

    /// The corners of the box around all vertices; `None` without any.
    pub fn bounds(&self) -> Option<(DVec3, DVec3)> {
        self.note_use(SceneUse::Bounds);
        self.mesh.bounds()
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
    pub notes: Vec<String>,
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
        let (notes, unfulfilled) = (Vec::new(), Vec::new());
        Built { size, layers, t_range: None, optics: None, notes, unfulfilled, composition: None }
    }
}
