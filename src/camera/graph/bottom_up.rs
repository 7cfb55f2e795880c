//! `bottom_up`: two given pinhole views side by side, the scene between them bridged by a segment whose rays rotate from
//! the one to the other (Popescu et al., section 3.3, Fig. 4 and 7); and `graph_camera`, the same without bridges.

use super::connect::JoinOptions;
use super::legs::{self, Depths};
use super::view::{Pinhole, View, beyond};
use super::volume::Volume;
use super::{Graph, Net};
use crate::arrays::MapEach;
use crate::camera::Ray;
use crate::camera::pose::{KEYS as POSE, Pose};
use crate::camera::recipe::{Built, Recipe, Setting};
use crate::camera::values::{number_if, of_part};
use crate::input::reader::{Field, Table};
use crate::input::{Error, Result};
use glam::{DVec2, DVec3};
use std::sync::Arc;

#[derive(Debug, PartialEq)]
struct BottomUp {
    views: [Pinhole; 2],
    /// Shares of the image's width: left view, bridge, right view.
    weights: [f64; 3],
    near: f64,
    far: Option<f64>,
    /// Number of strips between the views; `None`: by the angle between them.
    lateral: Option<u64>,
    root: Option<Pinhole>,
    cut: Option<f64>,
    foreground: bool,
    join: JoinOptions,
    /// The parts are not joined: a graph camera of 2009.
    discontinuous: bool,
}

const SHARED: [&str; 8] = ["kind", "views", "weights", "near", "far", "root", "morph", "cut"];

/// Reads the keys of help/bottom_up.txt.
pub fn read(table: &Table) -> Result<Arc<dyn Recipe>> {
    table.allow(&[&SHARED[..], &JoinOptions::KEYS, &["lateral", "foreground"]].concat())?;
    let foreground = read_foreground(table, "views")?;
    let lateral = table.optional("lateral", |f| f.integer(1, 1000))?;
    Ok(Arc::new(BottomUp { lateral, foreground, ..read_shared(table, JoinOptions::read(table)?)? }))
}

/// Reads the keys of help/graph_camera.txt.
pub fn read_discontinuous(table: &Table) -> Result<Arc<dyn Recipe>> {
    table.allow(&SHARED[..SHARED.len() - 1])?;
    let shared = read_shared(table, JoinOptions::read(table)?)?;
    Ok(Arc::new(BottomUp { discontinuous: true, ..shared }))
}

fn read_shared(table: &Table, join: JoinOptions) -> Result<BottomUp> {
    let views = table.need("views", "[{ eye = [-5, 3, 9], target = [-5, 0, 0], vfov = 40 }, { ... }]")?;
    let [left, right] =
        views.array::<2>("two views, left and right, as [{ eye, target, vfov }, { eye, target, vfov }]")?;
    let weights = table.or("weights", [2.0, 1.0, 2.0], read_weights)?;
    let near = table.or("near", 0.0, |f| least(f, 0.0))?;
    let far = table.optional("far", |f| least(f, near))?;
    Ok(BottomUp {
        views: [read_pinhole(&left)?, read_pinhole(&right)?],
        weights,
        near,
        far,
        lateral: None,
        root: table.optional("root", read_pinhole)?,
        cut: table.optional("cut", |f| least(f, 0.0))?.filter(|cut| *cut > 0.0),
        foreground: false,
        join,
        discontinuous: false,
    })
}

fn read_pinhole(field: &Field) -> Result<Pinhole> {
    let table = field.table()?;
    table.allow(&[&["vfov"], &POSE[..]].concat())?;
    Pinhole::read(&table)
}

fn read_weights(field: &Field) -> Result<[f64; 3]> {
    let weights: [f64; 3] = field.numbers("three shares, as [left view, between, right view]")?;
    let usable = weights.iter().all(|w| *w > 0.0);
    if usable { Ok(weights) } else { Err(field.error("every share must be above 0")) }
}

/// Whether there are segments before the views or regions; without them some keys say nothing.
pub(super) fn read_foreground(table: &Table, parts: &str) -> Result<bool> {
    let foreground = table.or("foreground", false, Field::boolean)?;
    for key in ["cut", "longitudinal", "join"] {
        if let (Some(field), false) = (table.get(key), foreground) {
            return Err(field.error(format_args!("{key} is of the segments before the {parts}; add foreground = true")));
        }
    }
    Ok(foreground)
}

/// A number over `least`, or `least` itself where that is 0.
pub(super) fn least(field: &Field, least: f64) -> Result<f64> {
    let is_good = |x: f64| x > least || (x == 0.0 && least == 0.0);
    number_if(field, is_good, format_args!("must be more than {least}"))
}

/// The parts of the image: where each begins, px, and the views that land there.
struct Layout {
    /// Of the left view's end and the right view's start.
    between_px: [f64; 2],
    views: [View; 2],
    root: View,
    far: f64,
}

impl Recipe for BottomUp {
    fn build(&self, setting: &Setting) -> Result<Built> {
        let size = setting.size()?;
        let layout = self.layout(setting, size)?;
        self.check_disjoint(setting, &layout, size)?;
        let (net, leaf) =
            if self.discontinuous { self.discontinuous_leaves(&layout, size) } else { self.leaves(&layout, size) };
        let root = |_| layout.root;
        let depths = self.foreground.then(|| self.depths(&net, &layout, &leaf[0]));
        let plain = legs::plain(&net, root, layout.far, depths);
        let graph = legs::with_leaves(&plain, leaf, depths);
        if !self.discontinuous {
            check_folds(setting, &graph)?;
        }
        let mut built = graph.morphed(&plain, self.join.morph).build(self.join.bend, setting)?;
        if self.discontinuous {
            built.notes.push("the views are not joined: the picture breaks where they meet what is between".into());
        }
        Ok(built)
    }
}

impl BottomUp {
    fn layout(&self, setting: &Setting, (width, height): (u32, u32)) -> Result<Layout> {
        let sum: f64 = self.weights.iter().sum();
        let (w, h) = (width as f64, height as f64);
        let [left, right] = [self.weights[0], self.weights[2]].map_each(|share| (w * share / sum).round());
        let between_px = [left, w - right];
        if left < 1.0 || right < 1.0 || between_px[1] - between_px[0] < 1.0 {
            return Err(Error::input(format!(
                "camera.weights: in an image {width} pixels wide some part has less than one; make its share larger"
            )));
        }
        let centres = [left / 2.0, w - right / 2.0].map_each(|x| DVec2::new(x, h / 2.0));
        let view = |k: usize| {
            View::new(&self.views[k], height, centres[k])
                .map_err(|e| Error::input(of_part(format_args!("camera.views.{k}"), &e)))
        };
        let views = [view(0)?, view(1)?];
        let pinhole = self.root.unwrap_or_else(|| self.default_root(&views, &centres));
        let root = View::new(&pinhole, height, legs::centre((width, height)))?;
        let eyes = [views[0].eye(), views[1].eye(), root.eye()];
        let reach = self.views.iter().map(|v| v.pose.distance()).fold(1000.0 * self.near, f64::max);
        let far = self.far.unwrap_or_else(|| beyond(setting.bounds(), &eyes, 1000.0 * reach).max(2.0 * self.near));
        Ok(Layout { between_px, views, root, far })
    }

    /// A view from before both: it sees the views' eyes where their middles land, and looks along both.
    fn default_root(&self, views: &[View; 2], centres: &[DVec2; 2]) -> Pinhole {
        let baseline = views[1].eye() - views[0].eye();
        let up = self.views[0].pose.up;
        let vfov = self.views[0].vfov.max(self.views[1].vfov);
        // ahead is also what has the left view on its left: all that is left where the views look in opposite directions
        let along = views[0].forward() + views[1].forward() + up.cross(baseline).normalize_or_zero();
        let across = along - along.project_onto_normalized(baseline.normalize_or(views[0].steps()[0].normalize()));
        let forward = across.normalize_or(views[0].forward());
        let px_per_unit = (centres[1] - centres[0]).length();
        let step = views[0].steps()[0].length().max(views[1].steps()[0].length());
        let back = if baseline == DVec3::ZERO { 1.0 } else { baseline.length() / (px_per_unit * step) };
        let middle = (views[0].eye() + views[1].eye()) / 2.0;
        Pinhole { pose: Pose::look_at(middle - back * forward, middle, up), vfov }
    }

    /// Cut planes of the root: halfway to the views' near faces where no cut is given.
    fn depths(&self, net: &Net, layout: &Layout, near: &[DVec3]) -> Depths {
        let nearest = near.iter().map(|n| layout.root.depth(*n).abs()).fold(f64::INFINITY, f64::min);
        let cut = self.cut.unwrap_or(if nearest > 0.0 { nearest / 2.0 } else { layout.far / 1000.0 });
        let length = legs::mean_length(net, |_| layout.root, cut, near);
        let near = cut + if length > 0.0 { length } else { cut };
        [cut, near, layout.far.max(2.0 * near)]
    }

    /// Two vertices, at the image's top and bottom, for the borders of both views and of the strips between, with
    /// near and far points.
    fn leaves(&self, layout: &Layout, size: (u32, u32)) -> (Net, [Vec<DVec3>; 2]) {
        let [x1, x2] = layout.between_px;
        let (w, h) = (size.0 as f64, size.1 as f64);
        let [left, right] = layout.views;
        let border = |y: f64| [left.ray(DVec2::new(x1, y)).direction, right.ray(DVec2::new(x2, y)).direction];
        let angle = border(h / 2.0)[0].angle_between(border(h / 2.0)[1]);
        let strips = self.lateral.unwrap_or(((angle / STRIP_ANGLE).ceil() as u64).max(1));
        let mut leaves = Leaves::new(self.near, layout.far);
        leaves.column(0.0, h, |y| left.ray(DVec2::new(0.0, y)));
        for k in 0..=strips {
            let s = k as f64 / strips as f64;
            leaves.column(x1 + s * (x2 - x1), h, |y| {
                let [d1, d2] = border(y);
                let direction = match k {
                    0 => d1,
                    _ if k == strips => d2,
                    _ => d1.slerp(d2, s),
                };
                Ray { origin: left.eye().lerp(right.eye(), s), direction }
            });
        }
        leaves.column(w, h, |y| right.ray(DVec2::new(w, y)));
        leaves.joined()
    }

    /// The parts on their own: the root's view in between.
    fn discontinuous_leaves(&self, layout: &Layout, size: (u32, u32)) -> (Net, [Vec<DVec3>; 2]) {
        let [x1, x2] = layout.between_px;
        let (w, h) = (size.0 as f64, size.1 as f64);
        let mut leaves = Leaves::new(self.near, layout.far);
        for (view, from, to) in [(layout.views[0], 0.0, x1), (layout.root, x1, x2), (layout.views[1], x2, w)] {
            for x in [from, to] {
                leaves.column(x, h, |y| view.ray(DVec2::new(x, y)));
            }
        }
        let (mut net, ends) = leaves.joined();
        // every second strip joins two parts
        net.triangles = net.triangles.chunks(2).step_by(2).flatten().copied().collect();
        (net, ends)
    }

    /// Both views must not see one part of the scene.
    fn check_disjoint(&self, setting: &Setting, layout: &Layout, size: (u32, u32)) -> Result<()> {
        let ([x1, x2], (w, h)) = (layout.between_px, (size.0 as f64, size.1 as f64));
        let volume = |k: usize, from: f64, to: f64| {
            Volume::of_view(&layout.views[k], DVec2::new(from, 0.0), DVec2::new(to, h), [self.near, layout.far])
        };
        let left = volume(0, 0.0, x1);
        let left = setting.bounds().map_or(left.clone(), |(lo, hi)| left.and(&Volume::of_box(lo, hi)));
        match left.meets(&volume(1, x2, w)) {
            Some(at) if !self.discontinuous => Err(Error::input(format!(
                "camera.views: the two views intersect, as at {}; turn or move them apart, or give a nearer far",
                place(at)
            ))),
            _ => Ok(()),
        }
    }
}

/// Rays that cross within the scene show a part of it mirrored and again: segments that intersect.
fn check_folds(setting: &Setting, graph: &Graph) -> Result<()> {
    match graph.folds(setting.bounds()) {
        (0, _) => Ok(()),
        (folded, all) => Err(Error::input(format!(
            "camera.views: rays between the views cross within the scene ({folded} of {all} pieces); give the left view \
             first, turn the views apart, or give a nearer far"
        ))),
    }
}

/// Largest rotation of the rays over one strip between the views: the chord of 15 degrees lies 1 % inside its circle.
const STRIP_ANGLE: f64 = std::f64::consts::PI / 12.0;

/// Rays at columns of the image, from left to right.
struct Leaves {
    net: Net,
    depths: [f64; 2],
    ends: [Vec<DVec3>; 2],
}

impl Leaves {
    fn new(near: f64, far: f64) -> Leaves {
        Leaves { net: Net::default(), depths: [near, far], ends: [Vec::new(), Vec::new()] }
    }

    /// Adds the rays, their directions of depth 1, at the top and the bottom of a column.
    fn column(&mut self, x: f64, height: f64, ray: impl Fn(f64) -> Ray) {
        for y in [0.0, height] {
            let Ray { origin: eye, direction: d } = ray(y);
            self.net.places_px.push(DVec2::new(x, y));
            self.ends[0].push(eye + self.depths[0] * d);
            self.ends[1].push(eye + self.depths[1] * d);
        }
    }

    /// Two triangles between each column and the next.
    fn joined(mut self) -> (Net, [Vec<DVec3>; 2]) {
        let columns = self.net.places_px.len() as u32 / 2;
        let quad = |k: u32| [[2 * k, 2 * k + 2, 2 * k + 1], [2 * k + 1, 2 * k + 2, 2 * k + 3]];
        self.net.triangles = (0..columns - 1).flat_map(quad).collect();
        (self.net, self.ends)
    }
}

/// A point as text.
pub(super) fn place(at: DVec3) -> String {
    format!("({:.3}, {:.3}, {:.3})", at.x, at.y, at.z)
}
