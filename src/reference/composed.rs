//! Composites whose cameras show objects of their own, or whose colours are blended across borders: `docs/reference/definitions.md`,
//! composite.

use super::Path;
use super::image::{CameraView, Judged, names_near};
use super::margin::{MARGIN_PX, clears};
use super::path::Segment;
use crate::arrays::MapEach;
use crate::camera::Ray;
use crate::camera::composition::Composition;
use crate::image::frame::{NO_ID, PixelValues};
use crate::scene::Scene;
use crate::scene::caustics::CausticMaps;
use std::borrow::Cow;

/// What is seen by each camera, and the rule that chooses.
pub(super) struct Composed<'a> {
    scene: &'a Scene,
    composition: &'a Composition,
    views: Vec<CameraView<'a>>,
}

/// A camera's hit at a pixel.
struct Candidate {
    number: usize,
    priority: i32,
    /// Along the master's ray.
    depth: f64,
}

impl<'a> Composed<'a> {
    /// `scenes` are those of [`Scene::of_each_camera`].
    pub fn new(
        scene: &'a Scene,
        composition: &'a Composition,
        scenes: &'a [Cow<'a, Scene>],
        maps: Option<&'a CausticMaps>,
    ) -> Composed<'a> {
        let members = scenes.iter().zip(&composition.members);
        let views = members.map(|(own, member)| CameraView::new(own, &member.camera, scene, maps)).collect();
        Composed { scene, composition, views }
    }

    pub fn values(&self, i: u32, j: u32) -> PixelValues {
        let values: Vec<PixelValues> = self.views.iter().map(|view| view.values(i, j)).collect();
        self.resolved((i, j), &values)
    }

    /// The number of the camera that is seen at a pixel.
    #[cfg(any(feature = "cli", feature = "view"))]
    pub fn owner_of(&self, i: u32, j: u32) -> Option<usize> {
        let values: Vec<PixelValues> = self.views.iter().map(|view| view.values(i, j)).collect();
        let held = self.composition.held(i, j).held;
        self.owner((i, j), &values, &|k| held[*k])
    }

    /// Values, whether they are safe, the scale of t, and whether `id` is near.
    pub fn judged(&self, (i, j): (u32, u32), id: Option<u32>) -> (PixelValues, bool, f32, bool) {
        let judged: Vec<Judged> = self.views.iter().map(|view| view.judged(i, j)).collect();
        let values: Vec<PixelValues> = judged.iter().map(|own| own.values).collect();
        let held = self.composition.held(i, j).held;
        let among = |k: &usize| held[*k];
        let owner = self.owner((i, j), &values, &among);
        let is_sure = (0..held.len()).filter(among).all(|k| judged[k].finding.safe);
        let is_inside = self.composition.is_clear(i, j, MARGIN_PX);
        let is_safe = is_sure && is_inside && self.is_clear((i, j), &values, &among);
        // without a master, away from all borders, the pixel is one camera's alone
        let has_one = is_safe || is_inside && self.composition.master.is_none();
        let is_near = id.is_none_or(|id| match owner {
            None => id == NO_ID,
            Some(k) if has_one => names_near(&judged[k].finding, id),
            // nothing is seen only where no camera sees anything
            Some(_) if id == NO_ID && self.composition.master.is_some() => {
                (0..held.len()).filter(among).all(|k| names_near(&judged[k].finding, id))
            }
            Some(_) => (0..held.len()).any(|k| names_near(&judged[k].finding, id)),
        });
        let scale = owner.map_or(1.0, |k| judged[k].scale);
        (self.resolved((i, j), &values), is_safe, scale, is_near)
    }

    /// The values of the camera that is seen, with blended colours.
    fn resolved(&self, pixel: (u32, u32), values: &[PixelValues]) -> PixelValues {
        let of = self.composition.held(pixel.0, pixel.1);
        let background = PixelValues { colour: self.scene.background.map_each(f64::from), ..PixelValues::MISS };
        let numbered = |k: usize| match values[k].piece {
            NO_ID => values[k],
            _ => PixelValues { piece: k as u32, ..values[k] },
        };
        let own = self.owner(pixel, values, &|k| of.held[*k]).map_or(background, numbered);
        let mut bounds = vec![0.0, 1.0];
        bounds.extend(of.weights.iter().copied().filter(|w| 0.0 < *w && *w < 1.0));
        bounds.sort_by(f64::total_cmp);
        let mut colour = [0.0; 3];
        // between two bounds all regions hold the same
        for ends in bounds.windows(2) {
            let middle = (ends[0] + ends[1]) / 2.0;
            let shown = self.owner(pixel, values, &|k| of.weights[*k] > middle);
            let seen = shown.map_or(background.colour, |k| values[k].colour);
            (0..3).for_each(|k| colour[k] += (ends[1] - ends[0]) * seen[k]);
        }
        PixelValues { colour, ..own }
    }

    /// The hits of the cameras `among` all, the one that is seen first.
    fn candidates(&self, pixel: (u32, u32), values: &[PixelValues], among: &dyn Fn(&usize) -> bool) -> Vec<Candidate> {
        let ray = self.composition.master.and_then(|master| self.ray(master, pixel));
        let candidate = |number: usize| {
            let depth = ray.map_or(0.0, |Ray { origin, direction }| {
                (values[number].position - origin).dot(direction) / direction.length()
            });
            Candidate { number, priority: self.composition.members[number].priority, depth }
        };
        let hits = (0..values.len()).filter(among).filter(|k| values[*k].triangle != NO_ID);
        let mut candidates: Vec<Candidate> = hits.map(candidate).collect();
        candidates.sort_by(|a, b| {
            b.priority.cmp(&a.priority).then(a.depth.total_cmp(&b.depth)).then(a.number.cmp(&b.number))
        });
        candidates
    }

    /// The number of the camera that is seen of those `among` all; `None`: none of them is there.
    fn owner(&self, pixel: (u32, u32), values: &[PixelValues], among: &dyn Fn(&usize) -> bool) -> Option<usize> {
        let priority = |k: &usize| self.composition.members[*k].priority;
        let all = || (0..values.len()).filter(among);
        let Some(master) = self.composition.master else {
            // the first of the highest
            return all().max_by(|a, b| priority(a).cmp(&priority(b)).then(b.cmp(a)));
        };
        let first = self.candidates(pixel, values, among).first().map(|candidate| candidate.number);
        // the last of the lowest
        let lowest = || all().min_by(|a, b| priority(a).cmp(&priority(b)).then(b.cmp(a)));
        first.or_else(|| Some(master).filter(among)).or_else(lowest)
    }

    /// Nothing ties with the hit that is seen.
    fn is_clear(&self, pixel: (u32, u32), values: &[PixelValues], among: &dyn Fn(&usize) -> bool) -> bool {
        if self.composition.master.is_none() {
            return true;
        }
        let candidates = self.candidates(pixel, values, among);
        let Some((first, others)) = candidates.split_first() else { return true };
        others.iter().all(|other| other.priority < first.priority || clears(first.depth, other.depth))
    }

    /// The master's ray.
    fn ray(&self, master: usize, (i, j): (u32, u32)) -> Option<Ray> {
        match Path::of_pixel(&self.composition.members[master].camera, i, j).segments.first()? {
            Some((_, Segment::Straight(bundle))) => Some(bundle.ray(0.0, 0.0)),
            _ => None,
        }
    }
}
