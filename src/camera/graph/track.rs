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
//! hidden, so that the rays move smoothly while targets do. From one detour to another they jump, or, with `smooth`, pass
//! continuously (module `moving`).

use super::blend::{Seen, Target};
use super::connect::JoinOptions;
use super::moving::{Search, is_behind, no_room, steep};
use super::path::{Occluders, Paths};
use super::top_down::{far_note, fold_note};
use super::view::{Pinhole, View, beyond};
use super::{Graph, coarse, legs};
use crate::arrays::MapEach;
use crate::camera::Rays;
use crate::camera::pose::KEYS as POSE;
use crate::camera::recipe::{Built, Recipe, Setting};
use crate::camera::values::{number_if, word};
use crate::input::Result;
use crate::input::reader::{Field, Table};
use glam::{DVec2, DVec3};
use std::sync::Arc;

#[derive(Debug, PartialEq)]
struct Track {
    pinhole: Pinhole,
    targets: Vec<Target>,
    /// The direction (right, up) in which rays may be shifted; `None`: any of eight.
    bend: Option<(f64, f64)>,
    far: Option<f64>,
    /// Pairs of triangles in a layer, at most.
    segments: Option<usize>,
    /// How far a target moves in the picture while its rays pass from one detour to another, in parts of the image's height; 0: they jump.
    smooth: f64,
    join: JoinOptions,
}

/// Reads the keys of help/track.txt.
pub fn read(table: &Table) -> Result<Arc<dyn Recipe>> {
    table.allow(
        &[&["kind", "vfov", "targets", "bend", "far", "segments", "smooth"], &POSE[..], &JoinOptions::KEYS].concat(),
    )?;
    let field = table.need("targets", "[{ at = [0, 1, 0], radius = 1 }]")?;
    let targets = field.items("a list of targets")?;
    let count = targets.len();
    if count > TARGETS_MAX {
        return Err(field.error(format_args!("{count} targets; use {TARGETS_MAX} at most")));
    }
    let bends = [
        ("auto", None),
        ("up", Some((0.0, 1.0))),
        ("down", Some((0.0, -1.0))),
        ("left", Some((-1.0, 0.0))),
        ("right", Some((1.0, 0.0))),
    ];
    let wrong = "use bend = \"auto\", \"up\", \"down\", \"left\" or \"right\"";
    let bend = table.or("bend", None, |field| word(field, &bends, wrong))?;
    Ok(Arc::new(Track {
        pinhole: Pinhole::read(table)?,
        targets: targets.map(|t| read_target(&t)).collect::<Result<_>>()?,
        bend,
        far: table.optional("far", |f| super::bottom_up::least(f, 0.0))?,
        segments: table.optional("segments", |f| f.integer(coarse::FEWEST as u64, SEGMENTS_MAX))?.map(|n| n as usize),
        smooth: table.or("smooth", 0.0, smooth)?,
        join: JoinOptions::read(table)?,
    }))
}

fn smooth(field: &Field) -> Result<f64> {
    let is_usable = |part: f64| part == 0.0 || (SMOOTH[0]..=SMOOTH[1]).contains(&part);
    number_if(field, is_usable, format_args!("is neither 0 nor in [{}, {}]", SMOOTH[0], SMOOTH[1]))
}

fn read_target(field: &Field) -> Result<Target> {
    let table = field.table()?;
    table.allow(&["at", "radius"])?;
    let radius = table.or("radius", 0.0, |f| super::bottom_up::least(f, 0.0))?;
    Ok(Target { at: table.need("at", "[0, 1, 0]")?.vec3()?, radius })
}

/// The least and the largest `smooth` but 0, in parts of the image's height.
const SMOOTH: [f64; 2] = [0.001, 0.1];
/// How far outside the picture a target may lie whose detour still is in it, in parts of the picture's size.
const OUTSIDE: f64 = 1.0;
/// Most targets: the time for a camera grows with their third power, to over a minute for so many.
const TARGETS_MAX: usize = 32;
/// Most segments that `segments` may ask for: a limit against slips, far over what is of use.
const SEGMENTS_MAX: u64 = 10_000;

impl Recipe for Track {
    fn build(&self, setting: &Setting) -> Result<Built> {
        let size = setting.size()?;
        let view = View::new(&self.pinhole, size.1, legs::centre(size))?;
        let occluders = Occluders::of(setting.mesh());
        let largest = setting.bounds().map_or(0.0, |(lo, hi)| (hi - lo).length());
        let directions = self.directions(&view);
        let (mut notes, mut unfulfilled) = (Vec::new(), Vec::new());
        let mut seen = self.seen(&view, size, &mut notes, &mut unfulfilled);
        let deepest = seen.iter().map(|s| s.sight_lines.front).fold(0.0, f64::max);
        let asked = self.far.unwrap_or_else(|| beyond(setting.bounds(), &[view.eye()], deepest));
        let far = asked.max(2.0 * deepest);
        notes.extend(far_note(self.far, far));
        let (bend, segments, smooth) = (self.join.bend, self.segments, self.smooth);
        let (view, occluders, directions) = (&view, &occluders, &directions[..]);
        let paths = Paths { view, occluders, directions, bend, largest, steep: steep(smooth) };
        let search = Search { paths, size, far, segments, smooth };
        search.set_detours(&mut seen, &mut unfulfilled);
        let end = DVec2::new(size.0 as f64, size.1 as f64);
        // one that needs no detour leaves the picture by degrees too, if it is asked for
        let counts = |s: &Seen| s.is_inside || ((smooth > 0.0 || s.detour.is_some()) && s.meets(view, end));
        seen.retain(|s| s.presence > 0.0 && counts(s));
        let Some([graph, plain]) = self.graphs(&search, &mut seen, &mut unfulfilled) else {
            return Ok(plain_view(view, size, notes, unfulfilled));
        };
        for s in seen.iter().filter(|s| s.is_inside && !search.is_reached(&graph, s)) {
            if is_behind(view, &seen, s) {
                notes.push(format!("target {} is behind another in the picture, which shows", s.index));
            } else {
                unfulfilled.push(between(s.index));
            }
        }
        let folds = graph.folds(setting.bounds());
        let mut built = graph.morphed(&plain, self.join.morph).build(self.join.bend, setting)?;
        built.notes.extend(notes.into_iter().chain(fold_note(folds)));
        Ok(Built { unfulfilled, ..built })
    }
}

/// The camera without detours.
fn plain_view(view: &View, size: (u32, u32), mut notes: Vec<String>, unfulfilled: Vec<String>) -> Built {
    if unfulfilled.is_empty() {
        notes.push("nothing hides a target: the plain view".into());
    }
    Built { notes: notes.into(), unfulfilled, ..Built::new(size, Rays::Pieces(view.whole(size))) }
}

fn between(index: usize) -> String {
    format!(
        "target {index} is hidden for the moment: its rays are on their way from one detour to another, or to the plain view"
    )
}

impl Track {
    /// Unit directions in which rays may be shifted, those that are preferred first.
    fn directions(&self, view: &View) -> Vec<DVec3> {
        let [right, down] = view.steps().map_each(DVec3::normalize);
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let all =
            [(0., 1.), (-1., 0.), (1., 0.), (-half, half), (half, half), (0., -1.), (-half, -half), (half, -half)];
        let chosen = self.bend.as_ref().map_or(&all[..], std::slice::from_ref);
        chosen.iter().map(|(x, y)| *x * right - *y * down).collect()
    }

    /// The targets inside the image, and those beside it.
    fn seen(&self, view: &View, size: (u32, u32), notes: &mut Vec<String>, unfulfilled: &mut Vec<String>) -> Vec<Seen> {
        let end = DVec2::new(size.0 as f64, size.1 as f64);
        let mut seen = Vec::new();
        for (index, target) in self.targets.iter().enumerate() {
            let Some(s) = Seen::new(view, end, index, *target, 0.0) else {
                unfulfilled.push(format!("target {index} is not tracked: it lies behind or around the eye"));
                continue;
            };
            if !s.is_inside {
                notes.push(format!("target {index} is outside the picture"));
            }
            if s.is_within(-OUTSIDE * end, (1.0 + OUTSIDE) * end) {
                seen.push(s);
            }
        }
        seen
    }

    /// The graph in which the targets are seen, and the plain one. Drops targets for whose segments there is no room; `None` if no hidden
    /// target is left.
    fn graphs(&self, search: &Search, seen: &mut Vec<Seen>, unfulfilled: &mut Vec<String>) -> Option<[Graph; 2]> {
        while let Some((index, segments)) = search.without_room(seen) {
            unfulfilled.push(no_room(index, segments));
            seen.retain(|s| s.index != index);
        }
        seen.iter().any(|s| s.detour.is_some()).then(|| search.graphs(seen))
    }
}
