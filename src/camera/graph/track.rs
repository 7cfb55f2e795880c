//! `track`: a pinhole view whose rays make detours around the occluders of targets in the scene (Popescu et al., section 3.3,
//! Fig. 8): each target is seen where it would be without occluders.
//!
//! All legs of the rays lie between planes parallel to the image. About a hidden target's place, rays are shifted on
//! the way to its occluder, pass it, and are back on their straight lines at the target's front, so the target and all
//! behind it appear as in the plain view. Around it the shift falls to 0, over a band wide enough for rays not to cross.
//! The paper renders one camera per target and blends the projections of vertices, which is not a map from pixels to
//! rays. Here the shifts are blended instead, at the vertices of one net over the image; in a target's core only its own
//! shift counts, and where cores overlap that of the nearer target. Targets without occluders keep their cores free of
//! shifts. Detours are means over those that are about as flat as the flattest, and begin to grow before a target is
//! hidden, so that the rays move smoothly while targets do.

use super::blend::{GUARD, Seen, Target, before, graphs};
use super::connect::JoinOptions;
use super::path::{self, Candidates, Detour, Occluders, Paths, SightLines};
use super::top_down::fold_note;
use super::view::{Pinhole, View, beyond};
use super::{Graph, coarse, legs};
use crate::camera::pose::KEYS as POSE;
use crate::camera::recipe::{Built, Recipe, Setting};
use crate::camera::{LAYERS_MAX, Rays};
use crate::input::Result;
use crate::input::reader::{Field, Table};
use glam::{DVec2, DVec3};
use std::sync::Arc;

#[derive(Debug, PartialEq)]
struct Track {
    pinhole: Pinhole,
    targets: Vec<Target>,
    /// Directions (right, up) in which rays may be shifted; empty: any of eight.
    bend: Vec<(f64, f64)>,
    far: Option<f64>,
    /// Pairs of triangles in a layer, at most.
    segments: Option<usize>,
    join: JoinOptions,
}

/// Reads the keys of help/track.txt.
pub fn read(table: &Table) -> Result<Arc<dyn Recipe>> {
    table.allow(&[&["kind", "vfov", "targets", "bend", "far", "segments"], &POSE[..], &JoinOptions::KEYS].concat())?;
    let targets = table.need("targets", "[{ at = [0, 1, 0], radius = 1 }]")?;
    let bend = table.or("bend", Vec::new(), |field| match field.text()? {
        "auto" => Ok(Vec::new()),
        "up" => Ok(vec![(0.0, 1.0)]),
        "down" => Ok(vec![(0.0, -1.0)]),
        "left" => Ok(vec![(-1.0, 0.0)]),
        "right" => Ok(vec![(1.0, 0.0)]),
        _ => Err(field.error("use bend = \"auto\", \"up\", \"down\", \"left\" or \"right\"")),
    })?;
    Ok(Arc::new(Track {
        pinhole: Pinhole::read(table)?,
        targets: targets.items("a list of targets")?.map(|t| read_target(&t)).collect::<Result<_>>()?,
        bend,
        far: table.optional("far", |f| super::bottom_up::least(f, 0.0))?,
        segments: table.optional("segments", |f| f.integer(coarse::FEWEST as u64, SEGMENTS_MAX))?.map(|n| n as usize),
        join: JoinOptions::read(table)?,
    }))
}

fn read_target(field: &Field) -> Result<Target> {
    let table = field.table()?;
    table.allow(&["at", "radius"])?;
    let radius = table.or("radius", 0.0, |f| super::bottom_up::least(f, 0.0))?;
    Ok(Target { at: table.need("at", "[0, 1, 0]")?.vec3()?, radius })
}

/// Pixels beyond a target's outline that share its detour: those that an image filter may read.
const MARGIN_PX: f64 = 2.0;
/// How far around a target the search looks for what is about to hide it, in parts of the image's height.
const AHEAD: f64 = 1.0 / 16.0;
/// How far outside the picture a target may lie whose detour still is in it, in parts of the picture's size.
const OUTSIDE: f64 = 1.0;
/// Halvings of the last step by which detours are widened.
const WIDENING_HALVINGS: usize = 8;
/// Most segments that `segments` may ask for: a limit against slips, far over what is of use.
const SEGMENTS_MAX: u64 = 10_000;
/// How often a detour disturbed by others is widened, and the factor.
const WIDENINGS: usize = 12;
const WIDENING: f64 = 1.25;
/// Points on a target's outline that must be seen, and on one half as large.
const OUTLINE: usize = 8;

impl Recipe for Track {
    fn build(&self, setting: &Setting) -> Result<Built> {
        let size = setting.size()?;
        let view = View::new(&self.pinhole, size.1, legs::centre(size))?;
        let occluders = Occluders::of(setting.mesh());
        let (mut notes, mut unfulfilled) = (Vec::new(), Vec::new());
        let mut seen = self.seen(&view, size, &mut notes, &mut unfulfilled);
        self.find_detours(setting, &view, &occluders, &mut seen, &mut unfulfilled);
        let end = DVec2::new(size.0 as f64, size.1 as f64);
        seen.retain(|s| {
            let reach = s.reach_px(&view);
            let meets = (s.place_px + reach).cmpgt(DVec2::ZERO).all() && (s.place_px - reach).cmplt(end).all();
            s.is_inside || (s.detour.is_some() && meets)
        });
        if seen.iter().all(|s| s.detour.is_none()) {
            return Ok(plain_view(&view, size, notes, unfulfilled));
        }
        let deepest = seen.iter().map(|s| s.sight_lines.front).fold(0.0, f64::max);
        let far = self.far.unwrap_or_else(|| beyond(setting.mesh(), &[view.eye()], deepest)).max(2.0 * deepest);
        let Some((graph, plain)) = self.free(&view, &occluders, seen, (size, far), &mut notes, &mut unfulfilled) else {
            return Ok(plain_view(&view, size, notes, unfulfilled));
        };
        let folds = graph.folds(setting.bounds());
        let mut built = graph.morphed(&plain, self.join.morph).build(self.join.bend, size)?;
        built.notes.extend(notes.into_iter().chain(fold_note(folds)));
        Ok(Built { unfulfilled, ..built })
    }
}

/// The camera without detours.
fn plain_view(view: &View, size: (u32, u32), mut notes: Vec<String>, unfulfilled: Vec<String>) -> Built {
    if unfulfilled.is_empty() {
        notes.push("nothing hides a target: the plain view".into());
    }
    Built { notes, unfulfilled, ..Built::new(size, Rays::Pieces(view.whole(size))) }
}

impl Track {
    /// The targets inside the image, and those beside it.
    fn seen(&self, view: &View, size: (u32, u32), notes: &mut Vec<String>, unfulfilled: &mut Vec<String>) -> Vec<Seen> {
        let [right, down] = view.steps().map(DVec3::normalize);
        let end = DVec2::new(size.0 as f64, size.1 as f64);
        let mut seen = Vec::new();
        for (index, target) in self.targets.iter().enumerate() {
            let front = view.depth(target.at) - target.radius;
            let place = view.place(target.at).filter(|_| front > 0.0);
            let Some(place_px) = place else {
                unfulfilled.push(format!("target {index} is not tracked: it lies behind or around the eye"));
                continue;
            };
            let is_within = |lo: DVec2, hi: DVec2| place_px.cmpge(lo).all() && place_px.cmple(hi).all();
            let is_inside = is_within(DVec2::ZERO, end);
            if !is_inside {
                notes.push(format!("target {index} is outside the picture"));
            }
            if !is_within(-OUTSIDE * end, (1.0 + OUTSIDE) * end) {
                continue;
            }
            let ring = |radius: f64| {
                let angle = |k: usize| std::f64::consts::TAU * k as f64 / OUTLINE as f64;
                (0..OUTLINE).map(move |k| target.at + radius * (angle(k).cos() * right + angle(k).sin() * down))
            };
            let points = ring(target.radius).chain(ring(target.radius / 2.0));
            let places = points.filter(|_| target.radius > 0.0).filter_map(|p| view.place(p));
            let places_px: Vec<DVec2> = std::iter::once(place_px).chain(places).collect();
            let reach = |q: &DVec2| (*q - place_px).abs().max_element();
            let outline_px = places_px.iter().map(reach).fold(0.0, f64::max);
            let core_px = outline_px + MARGIN_PX;
            let sight_lines = SightLines { places_px, front, outline_px, ahead_px: AHEAD * end.y };
            seen.push(Seen { index, target: *target, place_px, is_inside, sight_lines, core_px, detour: None });
        }
        seen
    }

    /// Gives every target that is hidden, or about to be, its detour: all in one direction if one works for all, so that
    /// neighbours bend alike. Removes hidden targets without a detour.
    fn find_detours(
        &self,
        setting: &Setting,
        view: &View,
        occluders: &Occluders,
        seen: &mut Vec<Seen>,
        unfulfilled: &mut Vec<String>,
    ) {
        let [right, down] = view.steps().map(DVec3::normalize);
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let all =
            [(0., 1.), (-1., 0.), (1., 0.), (-half, half), (half, half), (0., -1.), (-half, -half), (half, -half)];
        let chosen = if self.bend.is_empty() { &all[..] } else { &self.bend };
        let directions: Vec<DVec3> = chosen.iter().map(|(x, y)| *x * right - *y * down).collect();
        let largest = setting.bounds().map_or(0.0, |(lo, hi)| (hi - lo).length());
        let paths = Paths { view, occluders, directions: &directions, bend: self.join.bend, largest };
        let mut found: Vec<(usize, Candidates)> = Vec::new();
        let mut reached: Vec<Seen> = Vec::new();
        for s in seen.drain(..) {
            let is_hidden = self.is_hidden(view, occluders, &s);
            // what is between a ball's front and its middle leaves no depth to return
            let has_depth = !is_hidden || s.sight_lines.hidden(view, occluders).is_some();
            let candidates = has_depth.then(|| s.sight_lines.candidates(&paths)).flatten();
            match candidates.filter(|c| (0..directions.len()).any(|d| c.flattest(d).is_finite())) {
                None if is_hidden => {
                    if s.is_inside {
                        unfulfilled.push(no_path(s.index, largest));
                    }
                    continue;
                }
                None => {}
                Some(candidates) => found.push((reached.len(), candidates)),
            }
            reached.push(s);
        }
        *seen = reached;
        let weights = |cost: &dyn Fn(usize) -> f64| -> Option<Vec<f64>> {
            let costs: Vec<f64> = (0..directions.len()).map(cost).collect();
            let least = costs.iter().copied().fold(f64::INFINITY, f64::min);
            least.is_finite().then(|| costs.iter().map(|c| path::weight(*c, least)).collect())
        };
        let common = weights(&|d| found.iter().map(|(_, c)| c.fade * c.flattest(d)).sum());
        for (k, candidates) in &found {
            let own = || weights(&|d| candidates.flattest(d));
            let Some(weights) = common.clone().or_else(own) else { continue };
            seen[*k].detour = seen[*k].sight_lines.chosen(&paths, candidates, &weights);
        }
    }

    /// Whether one of the target's lines of sight, or that to its centre, is blocked.
    fn is_hidden(&self, view: &View, occluders: &Occluders, s: &Seen) -> bool {
        let straight = [view.eye(), s.target.at];
        s.sight_lines.hidden(view, occluders).is_some() || !reaches(view, occluders, &straight, &s.target)
    }

    /// The graph in which the targets are seen, and the plain one. Drops targets whose detours conflict with others'; `None` if no hidden
    /// target is left.
    fn free(
        &self,
        view: &View,
        occluders: &Occluders,
        mut seen: Vec<Seen>,
        extent: ((u32, u32), f64),
        notes: &mut Vec<String>,
        unfulfilled: &mut Vec<String>,
    ) -> Option<(Graph, Graph)> {
        loop {
            let detours = seen.iter().filter(|s| s.detour.is_some()).count();
            if detours == 0 {
                return None;
            }
            let (index, why) = match self.free_all(view, occluders, seen.clone(), extent) {
                Ok((graphs, behind)) => {
                    let segments = graphs.0.legs.iter().map(|leg| leg.bent(self.join.bend).len()).sum::<usize>();
                    let last = seen.iter().rfind(|s| s.detour.is_some()).map_or(0, |s| s.index);
                    if segments <= LAYERS_MAX || detours == 1 {
                        let note = |k| format!("target {k} is behind another in the picture, which shows");
                        notes.extend(behind.into_iter().map(note));
                        return Some(graphs);
                    }
                    (last, format!("with it, rays would have {segments} segments, and {LAYERS_MAX} is the most"))
                }
                Err(index) => {
                    (index, "its access path conflicts with those of the targets next to it in the picture".into())
                }
            };
            unfulfilled.push(format!("target {index} is not tracked: {why}"));
            seen.retain(|s| s.index != index);
        }
    }

    /// The graph in which all targets are seen, the plain one, and the targets behind others; the error is the index of a
    /// target that stays hidden however far the detours are widened.
    fn free_all(
        &self,
        view: &View,
        occluders: &Occluders,
        mut seen: Vec<Seen>,
        (size, far): ((u32, u32), f64),
    ) -> std::result::Result<((Graph, Graph), Vec<usize>), usize> {
        let behind = |seen: &[Seen], s: &Seen| {
            seen.iter().any(|o| {
                o.index != s.index
                    && o.target.at != s.target.at
                    && o.distance_px(s.place_px) <= (1.0 + GUARD) * o.core_px
                    && before(view, o, s) > 0.0
            })
        };
        // the graphs, targets that stay hidden, and targets behind others
        let result = |seen: &[Seen]| {
            let [graph, plain] = graphs(view, seen, size, far, self.segments);
            let free = |s: &Seen| {
                let line = graph.line(s.place_px, self.join.bend);
                line.is_some_and(|line| reaches(view, occluders, &line, &s.target))
            };
            let hidden = (0..seen.len()).filter(|&k| seen[k].is_inside && !free(&seen[k]));
            let (behind, blocked): (Vec<usize>, Vec<usize>) = hidden.partition(|k| behind(seen, &seen[*k]));
            ((graph, plain), blocked, behind.into_iter().map(|k| seen[k].index).collect::<Vec<_>>())
        };
        let mut narrower: Option<Vec<Seen>> = None;
        let mut still_hidden = 0;
        for _ in 0..=WIDENINGS {
            let (graphs, blocked, behind) = result(&seen);
            let Some(first) = blocked.first() else {
                // no wider than need be, so that the width changes smoothly with the targets' places
                let Some(mut low) = narrower else { return Ok((graphs, behind)) };
                let mut least = (graphs, behind);
                for _ in 0..WIDENING_HALVINGS {
                    let middle = mean_of(&low, &seen);
                    match result(&middle) {
                        (graphs, blocked, behind) if blocked.is_empty() => (seen, least) = (middle, (graphs, behind)),
                        _ => low = middle,
                    }
                }
                return Ok(least);
            };
            still_hidden = seen[*first].index;
            narrower = Some(seen.clone());
            for k in blocked {
                if let Some(detour) = &mut seen[k].detour {
                    detour.shift *= WIDENING;
                }
            }
        }
        Err(still_hidden)
    }
}

/// The targets with shifts halfway between both.
fn mean_of(a: &[Seen], b: &[Seen]) -> Vec<Seen> {
    let between = |a: &Detour, b: &Detour| Detour { shift: a.shift.lerp(b.shift, 0.5), ..*b };
    let of = |(a, b): (&Seen, &Seen)| Seen {
        detour: a.detour.as_ref().zip(b.detour.as_ref()).map(|(a, b)| between(a, b)),
        ..b.clone()
    };
    a.iter().zip(b).map(of).collect()
}

fn no_path(index: usize, largest: f64) -> String {
    format!(
        "target {index} is not tracked: every detour around its occluders is blocked, up to a shift of {largest:.3}; a smaller radius or \
         another bend may help"
    )
}

/// How far before its centre a target without a radius may be hit, as a part of its distance: its own surface.
const OWN: f64 = 1.0 / (1u64 << 20) as f64;

/// Whether the line reaches the target's centre without a hit outside the target's ball.
fn reaches(view: &View, occluders: &Occluders, line: &[DVec3], target: &Target) -> bool {
    let end = view.depth(target.at);
    let mut line: Vec<DVec3> = line.iter().copied().take_while(|p| view.depth(*p) < end).collect();
    line.push(target.at);
    let own = target.radius + OWN * (target.at - view.eye()).length();
    occluders.first_on(&line).is_none_or(|hit| (hit - target.at).length() <= own)
}
