//! `track`: a pinhole view whose rays make detours around the occluders of targets in the scene (Popescu et al., section 3.3,
//! Fig. 8): each target is seen where it would be without occluders.
//!
//! All legs of the rays lie between planes parallel to the image. About a hidden target's place, rays are shifted on
//! the way to its occluder, pass it, and are back on their straight lines at the target's front, so the target and all
//! behind it appear as in the plain view. Around it the shift falls to 0, over a band wide enough for rays not to cross.
//! The paper renders one camera per target and blends the projections of vertices, which is not a map from pixels to
//! rays. Here the shifts are blended instead, at the vertices of one net over the image; in a target's core only its own
//! shift counts. Targets without occluders keep their cores free of shifts.

use super::blend::{Seen, Target, graphs};
use super::connect::JoinOptions;
use super::path::{Detour, Occluders, SightLines};
use super::top_down::fold_note;
use super::view::{Pinhole, View, beyond};
use super::{Graph, legs};
use crate::camera::Rays;
use crate::camera::pose::KEYS as POSE;
use crate::camera::recipe::{Built, Recipe, Setting};
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
    join: JoinOptions,
}

/// Reads the keys of help/track.txt.
pub fn read(table: &Table) -> Result<Arc<dyn Recipe>> {
    table.allow(&[&["kind", "vfov", "targets", "bend", "far"], &POSE[..], &JoinOptions::KEYS].concat())?;
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
    /// The targets inside the image.
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
            if place_px.cmplt(DVec2::ZERO).any() || place_px.cmpgt(end).any() {
                notes.push(format!("target {index} is outside the picture"));
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
            let core_px = places_px.iter().map(reach).fold(0.0, f64::max) + MARGIN_PX;
            let sight_lines = SightLines { places_px, front };
            seen.push(Seen { index, target: *target, place_px, sight_lines, core_px, detour: None });
        }
        seen
    }

    /// Gives every hidden target its detour: all in one direction if one works for all, so that neighbours bend alike. Removes targets
    /// without a detour.
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
        let mut found: Vec<(usize, Vec<Option<Detour>>)> = Vec::new();
        let mut reached: Vec<Seen> = Vec::new();
        for s in seen.drain(..) {
            if self.is_hidden(view, occluders, &s) {
                let detours = s.sight_lines.detours(view, occluders, &directions, (self.join.bend, largest));
                if detours.iter().all(Option::is_none) {
                    unfulfilled.push(no_path(s.index, largest));
                    continue;
                }
                found.push((reached.len(), detours));
            }
            reached.push(s);
        }
        *seen = reached;
        let common = |d: usize| found.iter().map(|(_, detours)| detours[d].map(|w| w.slope())).sum::<Option<f64>>();
        let costs = (0..directions.len()).filter_map(|d| Some((d, common(d)?)));
        let best = costs.reduce(|a, b| if b.1 < a.1 { b } else { a }).map(|(d, _)| d);
        for (k, detours) in found {
            let flattest = detours.iter().flatten().copied().reduce(|a, b| if b.slope() < a.slope() { b } else { a });
            seen[k].detour = best.map_or(flattest, |d| detours[d]);
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
        while seen.iter().any(|s| s.detour.is_some()) {
            match self.free_all(view, occluders, seen.clone(), extent, notes) {
                Ok(graphs) => return Some(graphs),
                Err(index) => {
                    unfulfilled.push(format!(
                        "target {index} is not tracked: its access path conflicts with those of the targets next to it in the picture"
                    ));
                    seen.retain(|s| s.index != index);
                }
            }
        }
        None
    }

    /// The graph in which all targets are seen, and the plain one; the error is the index of a target that stays hidden however far the
    /// detours are widened.
    fn free_all(
        &self,
        view: &View,
        occluders: &Occluders,
        mut seen: Vec<Seen>,
        (size, far): ((u32, u32), f64),
        notes: &mut Vec<String>,
    ) -> std::result::Result<(Graph, Graph), usize> {
        let mut still_hidden = 0;
        for _ in 0..=WIDENINGS {
            let [graph, plain] = graphs(view, &seen, size, far);
            let free = |s: &Seen| {
                let line = graph.line(s.place_px, self.join.bend);
                line.is_some_and(|line| reaches(view, occluders, &line, &s.target))
            };
            let before = |s: &Seen, o: &Seen| {
                let distance = (s.place_px - o.place_px).abs().max_element();
                o.index != s.index
                    && o.target.at != s.target.at
                    && distance <= o.core_px
                    && o.sight_lines.front < s.sight_lines.front
            };
            let hidden: Vec<usize> = (0..seen.len()).filter(|&k| !free(&seen[k])).collect();
            let is_behind = |k: &usize| seen.iter().any(|o| before(&seen[*k], o));
            let (behind, blocked): (Vec<usize>, Vec<usize>) = hidden.into_iter().partition(is_behind);
            let Some(first) = blocked.first() else {
                let note = |k: usize| format!("target {} is behind another in the picture, which shows", seen[k].index);
                notes.extend(behind.into_iter().map(note));
                return Ok((graph, plain));
            };
            still_hidden = seen[*first].index;
            for k in blocked {
                if let Some(detour) = &mut seen[k].detour {
                    detour.shift *= WIDENING;
                }
            }
        }
        Err(still_hidden)
    }
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
