//! The rays of a lens at each pixel, in the viewer's frame. All poses of a viewer share them: the viewer's axes turn them, and the eye is added.

use crate::camera::pose::Pose;
use crate::camera::recipe::Equal;
use crate::camera::view::View;
use crate::camera::{Ray, RayMap};
use crate::input::Result;
use crate::parallel;
use glam::{DVec2, DVec3};
use std::any::Any;
use std::sync::{Arc, Mutex, PoisonError, Weak};

/// A ray for every image place, in a viewer's frame: components to the right, up and forward.
pub trait Lens: Any + std::fmt::Debug + Equal + Send + Sync {
    /// Returns the direction at image coordinates (a, b); `None`: no ray.
    fn direction(&self, a: f64, b: f64) -> Option<DVec3>;

    /// Returns where the ray starts, relative to the eye; `None`, for all rays alike: in the eye.
    fn origin(&self, _a: f64, _b: f64) -> Option<DVec3> {
        None
    }
}

/// A lens at a pose: the viewer's eye, axes and lens.
#[derive(Debug, Clone)]
pub struct Posed {
    pub eye: DVec3,
    pub view: View,
    pub lens: Arc<dyn Lens>,
}

impl RayMap for Posed {
    fn ray(&self, a: f64, b: f64) -> Option<Ray> {
        let direction = self.lens.direction(a, b)?;
        Some(self.turned(Ray { origin: self.lens.origin(a, b).unwrap_or(DVec3::ZERO), direction }))
    }

    fn viewer(&self) -> Option<Posed> {
        Some(self.clone())
    }
}

impl Posed {
    /// # Errors
    /// The errors of [`Pose::view`].
    pub fn new(pose: &Pose, lens: impl Lens) -> Result<Posed> {
        Ok(Posed { eye: pose.eye, view: pose.view()?, lens: Arc::new(lens) })
    }

    /// Returns the viewer of the same lens at the origin, with the world's axes.
    pub fn unturned(&self) -> Posed {
        Posed { eye: DVec3::ZERO, view: View::UNTURNED, lens: self.lens.clone() }
    }

    /// Returns whether rays in the world are those of the lens.
    pub fn is_unturned(&self) -> bool {
        self.eye == DVec3::ZERO && self.view == View::UNTURNED
    }

    /// Returns a ray of the lens in the world.
    #[inline]
    pub fn turned(&self, ray: Ray) -> Ray {
        self.view.ray(self.eye, ray)
    }
}

/// The rays of a lens at one sample of each pixel of an image.
#[derive(Debug)]
pub struct LensRays {
    lens: Arc<dyn Lens>,
    pub size: (u32, u32),
    /// Offset of the sample from the upper left corner of its pixel, px.
    sample: DVec2,
    /// Directions row by row; zero for a pixel without a ray.
    directions: Vec<DVec3>,
    /// Origins row by row, relative to the eye; empty if all rays start in the eye.
    origins: Vec<DVec3>,
}

/// Values that cameras of this process hold, so that another camera can share an equal one.
pub struct Held<T>(Mutex<Vec<Weak<T>>>);

impl<T> Held<T> {
    pub const fn new() -> Held<T> {
        Held(Mutex::new(Vec::new()))
    }

    /// Returns the value that a camera holds already, or else a new one.
    pub fn or_make(&self, is_it: impl Fn(&T) -> bool, make: impl FnOnce() -> T) -> Arc<T> {
        let all = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(found) = all().iter().filter_map(Weak::upgrade).find(|value| is_it(value)) {
            return found;
        }
        let made = Arc::new(make());
        let mut all = all();
        all.retain(|value| value.strong_count() > 0);
        all.push(Arc::downgrade(&made));
        made
    }
}

static RAYS: Held<LensRays> = Held::new();

impl LensRays {
    /// Returns the rays of a lens, shared with a camera that already holds them.
    pub fn of(lens: Arc<dyn Lens>, size: (u32, u32), sample: DVec2) -> Arc<LensRays> {
        let is_it = |d: &LensRays| d.size == size && d.sample == sample && d.lens.equals(&*lens);
        RAYS.or_make(is_it, || LensRays::new(lens.clone(), size, sample))
    }

    fn new(lens: Arc<dyn Lens>, size: (u32, u32), sample: DVec2) -> LensRays {
        let size_px = DVec2::new(f64::from(size.0), f64::from(size.1));
        let place = |k: u64| {
            let (i, j) = (k % u64::from(size.0), k / u64::from(size.0));
            (DVec2::new(i as f64, j as f64) + sample) / size_px
        };
        let origin = |k: u64| {
            let place = place(k);
            lens.origin(place.x, place.y)
        };
        let pixels = 0..u64::from(size.0) * u64::from(size.1);
        let origins = parallel::flat_map(pixels.clone(), origin);
        let direction = |k: u64| {
            let place = place(k);
            let has_origin = origins.get(k as usize).is_none_or(|origin| origin.is_finite());
            let usable = |d: &DVec3| d.is_finite() && *d != DVec3::ZERO && has_origin;
            lens.direction(place.x, place.y).filter(usable).unwrap_or(DVec3::ZERO)
        };
        let directions = parallel::map(pixels, direction);
        LensRays { lens, size, sample, directions, origins }
    }

    /// Returns the ray of pixel `(i, j)` in the viewer's frame; `None` if it has no ray.
    #[inline]
    pub fn get(&self, i: u32, j: u32) -> Option<Ray> {
        let k = j as usize * self.size.0 as usize + i as usize;
        let (direction, origin) = (self.directions[k], self.origins.get(k).copied().unwrap_or(DVec3::ZERO));
        (direction != DVec3::ZERO).then_some(Ray { origin, direction })
    }

    /// Returns whether all rays start in the eye.
    pub fn is_central(&self) -> bool {
        self.origins.is_empty()
    }

    /// Returns the directions of a row of pixels in the viewer's frame, zero for a pixel without a ray; nothing beyond the image.
    pub fn directions_of_row(&self, j: u32) -> &[DVec3] {
        let width = self.size.0 as usize;
        if j < self.size.1 { &self.directions[j as usize * width..(j as usize + 1) * width] } else { &[] }
    }

    /// Returns whether any pixel has a ray.
    pub fn has_any(&self) -> bool {
        self.directions.iter().any(|d| *d != DVec3::ZERO)
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

        fn origin(&self, a: f64, b: f64) -> Option<DVec3> {
            (self.0 != 0.0).then(|| self.0 * DVec3::new(a, -b, 0.0))
        }
    }

    #[test]
    fn equal_lenses_share_rays_while_a_camera_holds_them() {
        let of = |number: f64, size: (u32, u32), sample: f64| {
            LensRays::of(Arc::new(Flat(number)), size, DVec2::splat(sample))
        };
        let one = of(1.0, (4, 2), 0.5);
        assert!(Arc::ptr_eq(&one, &of(1.0, (4, 2), 0.5)));
        for other in [of(2.0, (4, 2), 0.5), of(1.0, (2, 4), 0.5), of(1.0, (4, 2), 0.25)] {
            assert!(!Arc::ptr_eq(&one, &other));
        }
        let ray = one.get(1, 1).unwrap();
        assert_eq!((ray.origin, ray.direction), (DVec3::new(0.375, -0.75, 0.0), DVec3::new(0.375, 0.75, 1.0)));
        let central = of(0.0, (4, 2), 0.5);
        assert!(central.is_central() && !one.is_central());
        assert_eq!(central.get(1, 1).unwrap().origin, DVec3::ZERO);
        assert_eq!((one.get(2, 1).is_none(), one.has_any()), (true, true));
    }
}
