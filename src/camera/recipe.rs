//! What a scene file may ask for by name, and how that becomes rays: one row a kind of camera.

use super::Rays;
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
    /// Its keys, their units and its formula, for a person.
    pub help: &'static str,
    /// Reads its table; every key is checked to be known.
    pub read: fn(&Table) -> Result<Arc<dyn Recipe>>,
}

/// A camera as asked for, its values checked one by one. What they mean together is checked by [`Recipe::build`].
pub trait Recipe: Any + Debug + Equal + Send + Sync {
    fn build(&self, setting: &Setting) -> Result<Built>;
}

/// Equality of recipes whose types are not known: those of one type are compared by `==`.
pub trait Equal {
    fn equals(&self, other: &dyn Any) -> bool;
}

impl<T: Any + PartialEq> Equal for T {
    fn equals(&self, other: &dyn Any) -> bool {
        other.downcast_ref::<T>() == Some(self)
    }
}

/// What a recipe may look at.
#[derive(Debug, Clone, Copy)]
pub struct Setting<'a> {
    /// The image's size in pixels, where one was given.
    pub size: Option<(u32, u32)>,
    /// The ends of t as the scene file gives them.
    pub t_range: [f64; 2],
    mesh: &'a Mesh,
    looked: Option<&'a Cell<SceneUse>>,
}

/// How far a recipe looked at the scene.
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
        Setting { size, t_range, mesh, looked: None }
    }

    /// The same for a camera with this range of t; `looked` records how far it looks at the scene.
    pub fn noting<'b>(&self, t_range: [f64; 2], looked: &'b Cell<SceneUse>) -> Setting<'b>
    where
        'a: 'b,
    {
        Setting { size: self.size, t_range, mesh: self.mesh, looked: Some(looked) }
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
        self.look(SceneUse::Mesh);
        self.mesh
    }

    /// The corners of the box around all vertices; `None` without any.
    pub fn bounds(&self) -> Option<(DVec3, DVec3)> {
        self.look(SceneUse::Bounds);
        self.mesh.bounds()
    }

    /// Records that a camera looked at the scene this far.
    pub(crate) fn look(&self, at: SceneUse) {
        if let Some(looked) = self.looked {
            looked.set(looked.get().max(at));
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
    /// t is in [0, 1] whatever the scene file says: chains and projectors.
    pub unit_t: bool,
    /// The mirror or lens that the rays meet.
    pub optics: Option<Arc<Optics>>,
    /// What a person should know of the camera: what was left out of it, what it stands for.
    pub notes: Vec<String>,
    /// What was asked for and cannot be done in this scene.
    pub unmet: Vec<String>,
}

impl Built {
    /// A camera of one layer.
    pub fn new(size: (u32, u32), rays: Rays) -> Built {
        Built { size, layers: vec![rays], unit_t: false, optics: None, notes: Vec::new(), unmet: Vec::new() }
    }
}
