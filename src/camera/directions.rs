//! The directions in which a lens looks from each pixel, in the viewer's frame. All poses of a viewer share them: a ray is the eye and a
//! direction turned by the viewer's axes.

use crate::camera::view::View;
use crate::parallel;
use glam::{DVec2, DVec3};
use std::any::Any;
use std::sync::{Arc, Mutex, PoisonError, Weak};

/// A direction for every image place, in a viewer's frame.
pub trait Lens: Any + std::fmt::Debug + Send + Sync {
    /// Returns the direction's components to the right, up and forward at image coordinates (a, b); `None`: no ray.
    fn direction(&self, a: f64, b: f64) -> Option<DVec3>;

    /// Returns whether the other lens has the same type and the same numbers, and so the same directions.
    fn is_same(&self, other: &dyn Lens) -> bool;
}

/// Implements [`Lens::is_same`] for a lens that can be compared.
pub fn is_same<L: Lens + PartialEq>(lens: &L, other: &dyn Lens) -> bool {
    (other as &dyn Any).downcast_ref::<L>() == Some(lens)
}

/// A viewer: eye, axes and lens.
#[derive(Debug, Clone)]
pub struct Viewer {
    pub eye: DVec3,
    pub view: View,
    pub lens: Arc<dyn Lens>,
}

/// The directions of a lens at one sample of each pixel of an image.
#[derive(Debug)]
pub struct Directions {
    lens: Arc<dyn Lens>,
    pub size: (u32, u32),
    /// Offset of the sample from the upper left corner of its pixel, px.
    sample: DVec2,
    /// Directions row by row; zero for a pixel without a ray.
    all: Vec<DVec3>,
}

/// The directions that cameras of this process hold.
static KNOWN: Mutex<Vec<Weak<Directions>>> = Mutex::new(Vec::new());

impl Directions {
    /// Returns the directions of a lens, shared with a camera that already holds them.
    pub fn of(lens: Arc<dyn Lens>, size: (u32, u32), sample: DVec2) -> Arc<Directions> {
        let is_it = |d: &Directions| d.size == size && d.sample == sample && d.lens.is_same(&*lens);
        let known = || KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(found) = known().iter().filter_map(Weak::upgrade).find(|d| is_it(d)) {
            return found;
        }
        let size_px = DVec2::new(f64::from(size.0), f64::from(size.1));
        let direction = |k: u64| {
            let (i, j) = (k % u64::from(size.0), k / u64::from(size.0));
            let place = (DVec2::new(i as f64, j as f64) + sample) / size_px;
            let usable = |d: &DVec3| d.is_finite() && *d != DVec3::ZERO;
            lens.direction(place.x, place.y).filter(usable).unwrap_or(DVec3::ZERO)
        };
        let all = parallel::map(0..u64::from(size.0) * u64::from(size.1), direction);
        let made = Arc::new(Directions { lens, size, sample, all });
        let mut known = known();
        known.retain(|d| d.strong_count() > 0);
        known.push(Arc::downgrade(&made));
        made
    }

    /// Returns the direction at pixel `(i, j)`; `None` if it has no ray.
    pub fn get(&self, i: u32, j: u32) -> Option<DVec3> {
        let d = self.all[j as usize * self.size.0 as usize + i as usize];
        (d != DVec3::ZERO).then_some(d)
    }

    /// Returns whether any pixel has a ray.
    pub fn has_any(&self) -> bool {
        self.all.iter().any(|d| *d != DVec3::ZERO)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug, PartialEq)]
    struct Flat(f64);

    impl Lens for Flat {
        fn direction(&self, a: f64, b: f64) -> Option<DVec3> {
            (a < 0.5).then(|| DVec3::new(a, b, self.0))
        }

        fn is_same(&self, other: &dyn Lens) -> bool {
            is_same(self, other)
        }
    }

    #[test]
    fn equal_lenses_share_their_directions_while_one_is_there() {
        let of = |number: f64, size: (u32, u32), sample: f64| {
            Directions::of(Arc::new(Flat(number)), size, DVec2::splat(sample))
        };
        let one = of(1.0, (4, 2), 0.5);
        assert!(Arc::ptr_eq(&one, &of(1.0, (4, 2), 0.5)));
        for other in [of(2.0, (4, 2), 0.5), of(1.0, (2, 4), 0.5), of(1.0, (4, 2), 0.25)] {
            assert!(!Arc::ptr_eq(&one, &other));
        }
        assert_eq!(one.get(1, 1), Some(DVec3::new(0.375, 0.75, 1.0)));
        assert_eq!((one.get(2, 1), one.has_any()), (None, true));
    }
}
