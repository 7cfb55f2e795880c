//! `[camera]` as written: the keys of a kind, each checked to be a finite value of its type. Combinations (eye = target, overlapping
//! pieces) are checked when the camera is built.

use super::recipe::Recipe;
use std::any::Any;
use std::sync::Arc;

/// The camera as written; `docs/reference/definitions.md` has each kind's mapping.
#[derive(Debug, Clone, PartialEq)]
pub struct CameraSpec {
    pub kind: CameraKind,
    /// The ends of t, inclusive; the first finite or -inf, the second finite or +inf, in order.
    pub t_range: [f64; 2],
}

/// A kind of camera with the values of its keys.
#[derive(Debug, Clone)]
pub struct CameraKind {
    /// The name in a scene file.
    pub name: &'static str,
    pub recipe: Arc<dyn Recipe>,
}

impl CameraKind {
    pub fn new(name: &'static str, recipe: impl Recipe) -> CameraKind {
        CameraKind { name, recipe: Arc::new(recipe) }
    }

    /// The recipe, if it is of this type: [`super::kinds::pinhole::Pinhole`], for example.
    pub fn recipe<R: Recipe>(&self) -> Option<&R> {
        (&*self.recipe as &dyn Any).downcast_ref()
    }
}

impl PartialEq for CameraKind {
    fn eq(&self, other: &CameraKind) -> bool {
        self.name == other.name && self.recipe.equals(&*other.recipe)
    }
}
