//! Which camera of a composite a pixel shows, where that does not follow from regions alone: cameras show objects of their own, or
//! colours are blended across the borders of regions. Each camera then has a frame of its own, and pixels are chosen from these.

use super::region::Region;
use crate::camera::Camera;
use crate::camera::exposure::Sample;
use crate::geometry::load::Object;
use crate::input::{Error, Result};
use glam::DVec2;
use std::sync::Arc;

/// The cameras of a composite.
#[derive(Debug, Clone)]
pub struct Composition {
    /// In the order of the list.
    pub members: Vec<Shown>,
    /// Their numbers, the highest priority first; equal ones in the order of the list.
    pub order: Vec<usize>,
    /// The number of the camera by whose depth the others are ordered; `None`: the first one in `order` shows, whatever it hits.
    pub master: Option<usize>,
    /// A pixel's place, px from its upper left corner.
    place: DVec2,
    /// Of the image, px.
    size: DVec2,
}

/// One of the cameras.
#[derive(Debug, Clone)]
pub struct Shown {
    /// Of an image as large as the composite's.
    pub camera: Arc<Camera>,
    pub region: Region,
    /// Width of the strip along the region's border in which colours are blended, px; 0: none.
    pub feather: f64,
    pub priority: i32,
    /// Patterns of the names of the objects that it shows, none if empty; `None`: all that no camera names.
    pub objects: Option<Vec<String>>,
}

/// Where a pixel lies, for each camera.
#[derive(Debug, Clone)]
pub struct Held {
    /// The camera's region holds the pixel.
    pub held: Vec<bool>,
    /// The share of the strip's width by which the pixel is inside, from 0 to 1; without a strip 0 or 1.
    pub weights: Vec<f64>,
}

impl Composition {
    pub fn new(
        members: Vec<Shown>,
        order: Vec<usize>,
        master: Option<usize>,
        (width, height): (u32, u32),
    ) -> Composition {
        let size = DVec2::new(width.into(), height.into());
        Composition { members, order, master, place: DVec2::splat(0.5), size }
    }

    /// Each camera needs a frame of its own.
    pub fn is_layered(&self) -> bool {
        self.master.is_some() || self.is_feathered()
    }

    pub fn is_feathered(&self) -> bool {
        self.members.iter().any(|member| member.feather > 0.0)
    }

    /// The same with every pixel's place moved.
    pub fn with_sample_offset(&self, (dx, dy): (f64, f64), sample: Option<Sample>) -> Composition {
        let mut moved = Composition { place: DVec2::new(0.5 + dx, 0.5 + dy), ..self.clone() };
        for member in &mut moved.members {
            member.camera = Arc::new(Camera { sample, ..member.camera.with_sample_offset(dx, dy) });
        }
        moved
    }

    /// Where a pixel lies.
    pub fn held(&self, i: u32, j: u32) -> Held {
        let place_px = DVec2::new(i.into(), j.into()) + self.place;
        let held: Vec<bool> = self.members.iter().map(|m| m.region.holds(place_px / self.size)).collect();
        let weight = |(member, held): (&Shown, &bool)| match member.feather > 0.0 {
            true => {
                let depth = member.region.depth_px(place_px, self.size, member.feather);
                (0.5 + depth / member.feather).clamp(0.0, 1.0)
            }
            false => f64::from(u8::from(*held)),
        };
        let weights = self.members.iter().zip(&held).map(weight).collect();
        Held { held, weights }
    }

    /// The camera that a pixel shows by regions alone.
    pub fn first(&self, i: u32, j: u32) -> Option<usize> {
        let place = (DVec2::new(i.into(), j.into()) + self.place) / self.size;
        self.order.iter().copied().find(|k| self.members[*k].region.holds(place))
    }

    /// No region's border is within `radius` px of the pixel's place.
    pub fn is_clear(&self, i: u32, j: u32, radius: f64) -> bool {
        let place_px = DVec2::new(i.into(), j.into()) + self.place;
        self.members.iter().all(|member| member.region.is_clear(place_px, self.size, radius))
    }

    /// For each camera which objects it shows.
    pub fn shows(&self, objects: &[Object]) -> Vec<Vec<bool>> {
        let names = |k: usize, object: &Object| {
            self.members[k].objects.iter().flatten().any(|pattern| matches(pattern, &object.name))
        };
        let is_named = |object: &Object| (0..self.members.len()).any(|k| names(k, object));
        let has_rest = |k: usize| match &self.members[k].objects {
            None => true,
            // nobody else shows them; one that names nothing is there for its depth alone
            Some(own) => {
                !own.is_empty() && self.master == Some(k) && self.members.iter().all(|member| member.objects.is_some())
            }
        };
        let shows = |k: usize| objects.iter().map(|o| names(k, o) || has_rest(k) && !is_named(o)).collect();
        (0..self.members.len()).map(shows).collect()
    }

    /// # Errors
    /// [`Error::Input`] for names that no object has.
    pub fn check(&self, objects: &[Object]) -> Result<()> {
        for (k, member) in self.members.iter().enumerate() {
            let unknown = |p: &&String| !objects.iter().any(|object| matches(p, &object.name));
            if let Some(pattern) = member.objects.iter().flatten().find(unknown) {
                let known: String = objects.iter().take(NAMES_LISTED).map(|o| format!(" \"{}\"", o.name)).collect();
                let known = if known.is_empty() { "the scene has none".into() } else { format!("objects:{known}") };
                return Err(Error::input(format!(
                    "camera.cameras.{k}.objects: no object is named \"{pattern}\"; {known}"
                )));
            }
        }
        Ok(())
    }
}

/// Most names in an error.
const NAMES_LISTED: usize = 20;

/// A name, or that of a mesh with copies (`name#0`, `name#1`); `*` in the pattern stands for any letters.
pub fn matches(pattern: &str, name: &str) -> bool {
    let of_copies = name.rsplit_once('#').filter(|(_, n)| n.bytes().all(|b| b.is_ascii_digit())).map(|(mesh, _)| mesh);
    is_like(pattern, name) || of_copies.is_some_and(|mesh| is_like(pattern, mesh))
}

fn is_like(pattern: &str, name: &str) -> bool {
    let mut parts = pattern.split('*');
    let first = parts.next().unwrap_or_default();
    let Some(mut rest) = name.strip_prefix(first) else { return false };
    let Some(last) = parts.next_back() else { return rest.is_empty() };
    // the earliest place of each part leaves most for those after it
    for part in parts {
        let Some(at) = rest.find(part) else { return false };
        rest = &rest[at + part.len()..];
    }
    rest.ends_with(last)
}

#[cfg(test)]
mod tests {
    use super::matches;

    #[test]
    fn names_match_patterns() {
        for (pattern, name, expected) in [
            ("cup", "cup", true),
            ("cup", "cup#12", true),
            ("cup", "cups", false),
            ("cup#1", "cup#1", true),
            ("cup#1", "cup#12", false),
            ("*", "", true),
            ("*", "cup#1", true),
            ("c*p", "cup", true),
            ("c*p", "cp", true),
            ("c*p", "cup#3", true),
            ("a*a", "a", false),
            ("a*b*c", "axxbyyc", true),
            ("a*b*c", "axxcyyb", false),
            ("*ab*ab", "abab", true),
            ("*ab*ab", "xab", false),
            ("", "cup", false),
        ] {
            assert_eq!(matches(pattern, name), expected, "{pattern} {name}");
        }
    }
}
