//! The answer for a pixel over all layers of its camera, and whether it is safe.
//!
//! Straight layers: the verdict of each layer is proven for the whole box about the centre; a layer that may miss
//! hands over to the next. With a curved layer, with spheres, and behind mirrors and lenses, the box is *sampled*, not bounded: at its centre, its
//! corners, the middles of its edges and a ring inside. Of a scene with spheres only the spheres are sampled where rays are straight. A feature that slips between the samples (thinner than they are apart) is
//! missed, so an unsafe pixel may be called safe, and a candidate may be left out. This can raise a false alarm about a
//! correct frame; it never excuses a wrong pixel.

use super::path::{Path, Seen, Segment};
use super::{GAP, Hit, MARGIN_PX, Reference, Verdict, nearer, past};
use crate::camera::Camera;

/// The answer for one pixel and whether it is safe; see [`Verdict`].
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// The visible hit at the centre.
    pub seen: Option<Seen>,
    /// The same triangle, or none, is visible everywhere in the box, without ties.
    pub safe: bool,
    /// Ascending ids of all triangles that may be visible somewhere in the box, ties included.
    pub candidates: Vec<u32>,
    /// Some ray of the box may hit nothing.
    pub may_miss: bool,
}

/// Sample places in the box of half-size 1, for curves; the first is the centre. The inner four are as far
/// out as an image's f32 arithmetic may be off (2^-8 px at 2^16 px), so that what passes there passes a sample too.
pub(super) const PLACES: [(f64, f64); 13] = [
    (0.0, 0.0),
    (-1.0, -1.0),
    (0.0, -1.0),
    (1.0, -1.0),
    (-1.0, 0.0),
    (1.0, 0.0),
    (-1.0, 1.0),
    (0.0, 1.0),
    (1.0, 1.0),
    (-INNER, -INNER),
    (INNER, -INNER),
    (-INNER, INNER),
    (INNER, INNER),
];

/// 2^-8 px of [`MARGIN_PX`].
const INNER: f64 = 1.0 / 16.0;

impl Reference<'_> {
    /// Judges pixel `(i, j)`, whose path is `path`; with optics, that of its first ray.
    pub fn finding(&self, camera: &Camera, path: &Path, (i, j): (u32, u32)) -> Finding {
        match &camera.optics {
            Some(optics) => self.finding_of_bounces(camera, optics, (i, j)),
            None if camera.is_curved() || self.mesh.has_spheres() => self.sampled(camera, path, (i, j)),
            None => self.proven(camera, path, (i, j)),
        }
    }

    fn proven(&self, camera: &Camera, path: &Path, pixel: (u32, u32)) -> Finding {
        let mut finding = Finding { seen: None, safe: true, candidates: Vec::new(), may_miss: true };
        for layer in 0..camera.layers.len() {
            let verdict = self.layer_verdict(camera, layer, path.range(layer), pixel);
            if finding.seen.is_none() {
                finding.seen = verdict.hit.and_then(|hit| {
                    let piece = path.segments[layer].as_ref()?.0;
                    Some(Seen { layer, piece, hit: Hit { t: path.within(hit.t), ..hit } })
                });
            }
            finding.safe &= verdict.safe;
            finding.candidates.extend(verdict.candidates);
            if verdict.safe && verdict.hit.is_some() {
                let behind = self.behind_the_face(camera, path, layer, pixel);
                finding.safe &= behind.iter().all(|id| finding.candidates.contains(id));
                finding.candidates.extend(behind);
            }
            if !verdict.may_miss {
                finding.may_miss = false;
                break;
            }
        }
        finding.candidates.sort_unstable();
        finding.candidates.dedup();
        finding
    }

    /// The answer of one layer, by [`Reference::verdict`] over all its pieces near the pixel.
    fn layer_verdict(&self, camera: &Camera, layer: usize, range: [f64; 2], (i, j): (u32, u32)) -> Verdict {
        let has_ray = camera.pixel(layer, i, j).is_some();
        let (bundles, outside) = camera.near(layer, i, j);
        let mut verdict = self.verdict(&bundles, range);
        if !has_ray {
            verdict.hit = None;
        }
        if !has_ray || outside {
            verdict.safe = verdict.safe && verdict.candidates.is_empty();
            verdict.may_miss = true;
        }
        verdict
    }

    /// Triangles at the start of the next layer that tie with a safe hit at the end of this one.
    fn behind_the_face(&self, camera: &Camera, path: &Path, layer: usize, pixel: (u32, u32)) -> Vec<u32> {
        if layer + 1 == camera.layers.len() {
            return Vec::new();
        }
        // t is that of the whole path: both hits are within a tie of the face, at layer + 1
        let gap_t = GAP * (layer + 2) as f64;
        let [t0, _] = path.range(layer);
        let clear = self.layer_verdict(camera, layer, [t0, 1.0 - gap_t], pixel);
        if clear.safe && clear.hit.is_some() {
            return Vec::new();
        }
        let [start, _] = path.range(layer + 1);
        self.layer_verdict(camera, layer + 1, [start, gap_t], pixel).candidates
    }

    fn sampled(&self, camera: &Camera, path: &Path, (i, j): (u32, u32)) -> Finding {
        let at_offset = |(x, y): &(f64, f64)| Path::at_offset(camera, i, j, (x * MARGIN_PX, y * MARGIN_PX));
        let paths: Vec<Path> = [path.clone()].into_iter().chain(PLACES[1..].iter().map(at_offset)).collect();
        let answers = self.answers(&paths);
        let touching: Vec<bool> = answers.iter().map(|answer| answer.touches).collect();
        let mut answers = answers.into_iter();
        let centre = answers.next().unwrap_or_default();
        let mut finding = Finding {
            seen: centre.seen,
            safe: centre.ties.is_empty() && !centre.touches,
            may_miss: centre.seen.is_none(),
            candidates: centre.seen.iter().map(|s| s.hit.triangle).chain(centre.ties).collect(),
        };
        let what = |seen: Option<Seen>| seen.map(|s| (s.layer, s.hit.triangle));
        for answer in answers {
            finding.safe &= answer.ties.is_empty() && !answer.touches && what(answer.seen) == what(centre.seen);
            finding.may_miss |= answer.seen.is_none();
            finding.candidates.extend(answer.seen.iter().map(|s| s.hit.triangle).chain(answer.ties));
        }
        // what is behind a triangle that a curve touches, or one so thin that its plane is not known
        for (path, _) in paths.iter().zip(&touching).filter(|(_, touches)| **touches) {
            let crossed = self.first_crossed(path);
            finding.may_miss |= crossed.is_none();
            finding.candidates.extend(crossed);
        }
        if !camera.is_curved() {
            self.take_triangles(camera, &paths, (i, j), &mut finding);
        }
        finding.candidates.sort_unstable();
        finding.candidates.dedup();
        finding
    }

    /// Bounds the triangles of a scene with spheres: those that may be visible in front of the sphere that is seen, or instead of the triangle or
    /// nothing that is seen. Sampled rays that start at one point of an edge all hit it, or all miss it.
    fn take_triangles(&self, camera: &Camera, paths: &[Path], pixel: (u32, u32), finding: &mut Finding) {
        let (seen, path) = (finding.seen, &paths[0]);
        for layer in 0..=seen.map_or(camera.layers.len() - 1, |seen| seen.layer) {
            let own = seen.filter(|seen| seen.layer == layer).map(|seen| seen.hit);
            let sphere = own.filter(|hit| self.round(hit.triangle).is_some());
            let [start, end] = path.range(layer);
            let end = sphere.map_or(end, |hit| hit.t - GAP * hit.t.abs());
            let verdict = self.layer_verdict(camera, layer, [start, end], pixel);
            let expected = own.filter(|_| sphere.is_none()).map(|hit| hit.triangle);
            finding.safe &= verdict.safe && verdict.candidates.iter().copied().eq(expected);
            finding.candidates.extend(verdict.candidates);
            if sphere.is_none() && !verdict.safe {
                finding.may_miss |= verdict.may_miss;
                finding.candidates.extend(paths.iter().filter_map(|path| self.first_sphere(path, layer)));
            }
        }
    }

    /// The first triangle or sphere that a path crosses, and does not only touch.
    fn first_crossed(&self, path: &Path) -> Option<u32> {
        path.segments.iter().enumerate().find_map(|(layer, segment)| {
            let (_, segment) = segment.as_ref()?;
            let Segment::Curved(curve) = segment else { return None };
            let mut first = None;
            self.each_hit_of_curves(&[*curve], &[path.range(layer)], |_, hit| {
                if !self.touches(segment, &hit) {
                    first = nearer(first, hit);
                }
                first.map_or(f64::INFINITY, |first| past(first.t))
            });
            first.map(|hit| hit.triangle)
        })
    }

    /// The first sphere that a path meets in a layer, whatever triangles are in front of it.
    fn first_sphere(&self, path: &Path, layer: usize) -> Option<u32> {
        let Some((_, Segment::Straight(bundle))) = &path.segments[layer] else { return None };
        let mut first = None;
        self.each_hit_of_ray(bundle, path.range(layer), |hit| {
            if self.round(hit.triangle).is_some() {
                first = nearer(first, hit);
            }
            first.map_or(f64::INFINITY, |first| past(first.t))
        });
        first.map(|hit| hit.triangle)
    }
}
