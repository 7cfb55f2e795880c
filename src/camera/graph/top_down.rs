//! `top_down`: a root view with regions that have their own viewpoints (Popescu et al., section 3.3,
//! Fig. 1 and 6). The root is a pinhole, or the six faces of a cube around its eye (section 4.3).

use super::Net;
use super::bottom_up::{least, place, read_foreground};
use super::connect::JoinOptions;
use super::legs::{self, Depths};
use super::outline::{self, Outline};
use super::overlay::{self, Mix, Profile};
use super::path::Occluders;
use super::roots::{self, Layout, Root};
use super::view::{Pinhole, View, beyond};
use crate::arrays::MapEach;
use crate::camera::boxes::around;
use crate::camera::pose::{KEYS as POSE, Pose};
use crate::camera::recipe::{Built, Recipe, Setting};
use crate::camera::values::{length, of_part, word};
use crate::input::limits::CORNERS;
use crate::input::reader::{Field, Table};
use crate::input::{Error, Result};
use glam::{DVec2, DVec3};
use std::sync::Arc;

#[derive(Debug, PartialEq)]
struct TopDown {
    root: Pinhole,
    layout: Layout,
    regions: Vec<Region>,
    /// Width of the transitions, in parts of the root view's height.
    band: f64,
    near: f64,
    far: Option<f64>,
    cut: Option<f64>,
    foreground: bool,
    join: JoinOptions,
}

#[derive(Debug, PartialEq)]
struct Region {
    /// Image coordinates (a, b).
    outline: Outline,
    viewpoint: Viewpoint,
    vfov: Option<f64>,
}

#[derive(Debug, PartialEq)]
enum Viewpoint {
    Posed(Pose),
    /// Without a target, what the root sees in the region's middle; without an up, the root's.
    At {
        eye: DVec3,
        target: Option<DVec3>,
        up: Option<DVec3>,
    },
}

/// Reads the keys of help/top_down.txt.
pub fn read(table: &Table) -> Result<Arc<dyn Recipe>> {
    let own = ["kind", "vfov", "layout", "regions", "band", "near", "far", "foreground", "cut"];
    table.allow(&[&own[..], &POSE, &JoinOptions::KEYS].concat())?;
    let layouts = [("plain", Layout::Plain), ("cross", Layout::Cross), ("strip", Layout::Strip)];
    let wrong = "use layout = \"plain\", \"cross\" or \"strip\"";
    let layout = table.or("layout", Layout::Plain, |field| word(field, &layouts, wrong))?;
    let root = match (layout, table.get("vfov")) {
        (Layout::Plain, _) => Pinhole::read(table)?,
        (_, Some(vfov)) => return Err(vfov.error("a cube's faces are 90 degrees high; leave vfov out")),
        _ => Pinhole { pose: Pose::read(table)?, vfov: 90.0 },
    };
    let foreground = read_foreground(table, "regions")?;
    let regions = table.need("regions", "[{ rect = [0.1, 0.2, 0.4, 0.6], eye = [0, 9, 0] }]")?;
    let regions = regions.items("a list of regions")?.map(|region| read_region(&region)).collect::<Result<_>>()?;
    let near = table.or("near", 0.0, |f| least(f, 0.0))?;
    Ok(Arc::new(TopDown {
        root,
        layout,
        regions,
        band: table.or("band", 0.1, length)?,
        near,
        far: table.optional("far", |f| least(f, near))?,
        cut: table.optional("cut", length)?,
        foreground,
        join: JoinOptions::read(table)?,
    }))
}

fn read_region(field: &Field) -> Result<Region> {
    let table = field.table()?;
    table.allow(&[&["rect", "polygon", "vfov"], &POSE[..]].concat())?;
    let outline = match (table.get("rect"), table.get("polygon")) {
        (Some(rect), None) => {
            let [a0, b0, a1, b1] = rect.numbers("four numbers, as [a0, b0, a1, b1]")?;
            if !(a0 < a1 && b0 < b1) {
                return Err(rect.error("the first corner must be left of and above the second"));
            }
            outline::rectangle(DVec2::new(a0, b0), DVec2::new(a1, b1))
        }
        (None, Some(polygon)) => {
            let corner = |f: Field| f.numbers("two numbers, as [a, b]").map(DVec2::from_array);
            let corners: Vec<_> = polygon.items("a list of corners")?.map(corner).collect::<Result<_>>()?;
            polygon.limits().check(CORNERS, corners.len() as u64).map_err(|e| polygon.error(e))?;
            if corners.len() < 3 || outline::is_tangled(&corners) {
                return Err(polygon.error("give three or more corners in order, no side crossing another"));
            }
            corners
        }
        _ => return Err(table.error("a region has either rect = [a0, b0, a1, b1] or polygon = [[a, b], ...]")),
    };
    let viewpoint = match Pose::read_rotation(&table)? {
        Some(pose) => Viewpoint::Posed(pose),
        None => Viewpoint::At {
            eye: table.need("eye", "[0, 9, 0]")?.vec3()?,
            target: table.optional("target", Field::vec3)?,
            up: table.optional("up", Field::vec3)?,
        },
    };
    Ok(Region { outline, viewpoint, vfov: table.optional("vfov", Field::number)? })
}

/// A region where it lands.
struct Patch {
    view: View,
    root: usize,
    inner: Outline,
    outer: Outline,
}

impl Recipe for TopDown {
    fn build(&self, setting: &Setting) -> Result<Built> {
        let size = setting.size()?;
        let mut roots = roots::roots(&self.root, self.layout, size)?;
        let patches = self.patches(setting, &mut roots, size)?;
        let mut mesh = NetOfRoots::default();
        for (k, root) in roots.iter().enumerate() {
            mesh.add(k, &root.outline, &patches);
        }
        let root = |k: usize| roots[mesh.root_of[k]].view;
        let eyes: Vec<DVec3> = roots.iter().map(|r| r.view.eye()).chain(patches.iter().map(|p| p.view.eye())).collect();
        let reach = self.root.pose.distance().max(1000.0 * self.near);
        let far = self.far.unwrap_or_else(|| beyond(setting.bounds(), &eyes, 1000.0 * reach).max(2.0 * self.near));
        let depths = self.foreground.then(|| self.depths(&mesh, &patches, &roots, far));
        let far = depths.map_or(far, |d| d[2]);
        let plain = legs::plain(&mesh.net, root, far, depths);
        let leaf_depth = depths.map_or(0.0, |d| d[1]);
        let leaf = |plain_depth: f64, own_depth: f64| {
            let plain = |k: usize, q: DVec2| root(k).point(q, plain_depth);
            let own = |patch: usize, q: DVec2| patches[patch].view.point(q, own_depth);
            let point = |(k, q): (usize, &DVec2)| match &mesh.corners[k][..] {
                [(patch, corner, 1.0)] if corner == q => own(*patch, *q),
                corners => {
                    let added = |(patch, q, w): &(usize, DVec2, f64)| *w * (own(*patch, *q) - plain(k, *q));
                    corners.iter().map(added).fold(plain(k, *q), |sum, offset| sum + offset)
                }
            };
            mesh.net.places_px.iter().enumerate().map(point).collect::<Vec<_>>()
        };
        let graph = legs::with_leaves(&plain, [leaf(leaf_depth, self.near), leaf(far, far)], depths);
        let folds = graph.folds(setting.bounds());
        let mut built = graph.morphed(&plain, self.join.morph).build(self.join.bend, setting)?;
        built.notes.extend(far_note(self.far, far));
        built.notes.extend(
            fold_note(folds).map(|note| note + "; make band wider, or move the regions' eyes nearer to the root's"),
        );
        Ok(built)
    }
}

/// What to say where rays end farther than was asked for.
pub(super) fn far_note(asked: Option<f64>, far: f64) -> Option<String> {
    asked
        .filter(|asked| *asked < far)
        .map(|asked| format!("far = {asked} is too near for rays to turn back; they end at {far}"))
}

/// What to say where rays cross.
pub(super) fn fold_note((folded, all): (usize, usize)) -> Option<String> {
    (folded > 0).then(|| format!("rays cross in {folded} of {all} pieces: there some things show twice or mirrored"))
}

impl TopDown {
    /// The regions where they land; a plain root's outline is drawn around the image and all of them.
    fn patches(&self, setting: &Setting, roots: &mut [Root], (width, height): (u32, u32)) -> Result<Vec<Patch>> {
        let size = DVec2::new(width as f64, height as f64);
        let needs_scene = |r: &Region| matches!(r.viewpoint, Viewpoint::At { target: None, .. });
        let occluders = self.regions.iter().any(needs_scene).then(|| Occluders::of(setting.mesh()));
        let mut patches: Vec<Patch> = Vec::new();
        for (k, region) in self.regions.iter().enumerate() {
            let error = |message: String| Error::input(format!("camera.regions.{k}: {message}"));
            let inner: Outline = region.outline.iter().map(|q| *q * size).collect();
            let (lo, hi) = around(&inner);
            let region_centre = (lo + hi) / 2.0;
            let at = match self.layout {
                Layout::Plain => Some(0),
                _ => roots.iter().position(|r| outline::contains(&r.outline, region_centre)),
            };
            let at = at.ok_or_else(|| error("its middle lies in no face of the cube; move it".into()))?;
            let root = &roots[at];
            let outer = outline::widened(&inner, self.band * root.height as f64)
                .filter(|o| !outline::is_tangled(o))
                .ok_or_else(|| {
                    error("its outline is too sharp or narrow for the band around it; make band smaller".into())
                })?;
            let (face_lo, face_hi) = around(&root.outline);
            if self.layout != Layout::Plain && !outer.iter().all(|q| q.cmpge(face_lo).all() && q.cmple(face_hi).all()) {
                return Err(error("leaves its face of the cube, its band included; make it or band smaller".into()));
            }
            let seen = || {
                let ray = root.view.ray(region_centre);
                let seen = occluders.as_ref().and_then(|o| o.first(ray.origin, ray.direction, f64::INFINITY));
                ray.origin + seen.unwrap_or(root.pinhole.pose.distance()) * ray.direction
            };
            let pose = match region.viewpoint {
                Viewpoint::Posed(pose) => pose,
                Viewpoint::At { eye, target, up } => {
                    Pose::look_at(eye, target.unwrap_or_else(seen), up.unwrap_or(root.pinhole.pose.up))
                }
            };
            let pinhole = Pinhole { pose, vfov: region.vfov.unwrap_or(root.pinhole.vfov) };
            // a whole number of pixels from the plain view's centre, so that their grids are one
            let centre = root.centre_px + (region_centre - root.centre_px).round();
            let view = View::new(&pinhole, root.height, centre).map_err(|e| {
                let message = of_part(format_args!("camera.regions.{k}"), &e);
                Error::input(format!("{message} (the region looks at {})", place(pose.target)))
            })?;
            patches.push(Patch { view, root: at, inner, outer });
        }
        if self.layout == Layout::Plain {
            let all = patches.iter().flat_map(|p| &p.outer).copied().chain([DVec2::ZERO, size]);
            let (lo, hi) = around(&all.collect::<Vec<_>>());
            roots[0].outline = outline::rectangle(lo - 1.0, hi + 1.0);
        }
        Ok(patches)
    }

    /// The cut plane is halfway to the nearest near face of a region.
    fn depths(&self, mesh: &NetOfRoots, patches: &[Patch], roots: &[Root], far: f64) -> Depths {
        let corners = || {
            let of = |(k, all): (usize, &'_ Vec<(usize, DVec2, f64)>)| {
                all.iter().map(move |(patch, q, _)| (mesh.root_of[k], *patch, *q)).collect::<Vec<_>>()
            };
            mesh.corners.iter().enumerate().flat_map(of)
        };
        let near = |patch: usize, q: DVec2| patches[patch].view.point(q, self.near);
        let depth = |(root, patch, q): (usize, usize, DVec2)| roots[root].view.depth(near(patch, q));
        let nearest = corners().map(depth).filter(|d| *d > 0.0).fold(f64::INFINITY, f64::min);
        let cut = self.cut.unwrap_or(if nearest.is_finite() { nearest / 2.0 } else { far / 1000.0 });
        let leg_length =
            |(root, patch, q): (usize, usize, DVec2)| (near(patch, q) - roots[root].view.point(q, cut)).length();
        let (sum, count) = corners().map(leg_length).fold((0.0, 0), |(s, n), w| (s + w, n + 1));
        let near = cut + if sum > 0.0 { sum / count as f64 } else { cut };
        [cut, near, far.max(2.0 * near)]
    }
}

/// A net over roots and regions.
#[derive(Default)]
struct NetOfRoots {
    net: Net,
    /// The root of every vertex, and what regions add to it there: corners of regions (px), and their weights.
    root_of: Vec<usize>,
    corners: Vec<Vec<(usize, DVec2, f64)>>,
}

impl NetOfRoots {
    /// Adds a root: what is around its regions, the bands around them, and the regions.
    fn add(&mut self, root: usize, outline: &Outline, patches: &[Patch]) {
        let own: Vec<usize> = (0..patches.len()).filter(|&k| patches[k].root == root).collect();
        let groups = groups(&own, outline, patches);
        let holes: Vec<Outline> = groups.iter().map(|g| g.hole.clone()).collect();
        let first = self.push(root, None, outline);
        let mut outer_first = first + outline.len() as u32;
        for hole in &holes {
            self.push(root, None, hole);
        }
        self.triangles(first, outline::triangulate(outline, &holes));
        for group in &groups {
            match group.regions[..] {
                [k] => {
                    let inner = &patches[k].inner;
                    let inner_first = self.push(root, Some(k), inner);
                    self.triangles(inner_first, outline::triangulate(inner, &[]));
                    self.triangles(0, overlay::band(inner.len() as u32, inner_first, outer_first));
                }
                _ => self.add_overlapping(root, group, outer_first, patches),
            }
            outer_first += group.hole.len() as u32;
        }
    }

    /// Adds regions that overlap: the common subdivision of their triangles. `first` is the first corner of their rectangle.
    fn add_overlapping(&mut self, root: usize, group: &Group, first: u32, patches: &[Patch]) {
        let profile = |k: &usize| Profile::new(&patches[*k].inner, &patches[*k].outer, &group.hole);
        let profiles: Vec<Profile> = group.regions.iter().map(profile).collect();
        let common = overlay::overlay(&group.hole, &profiles);
        let mut vertex = |(q, mixes): (&DVec2, &Vec<Mix>)| {
            if let Some(corner) = group.hole.iter().position(|corner| corner == q) {
                return first + corner as u32;
            }
            let left = overlay::left_in_order(&mixes.iter().map(overlay::share).collect::<Vec<_>>());
            let of = |((k, mix), left): ((&usize, &Mix), f64)| {
                mix.iter().map(|(corner, weight)| (*k, *corner, left * weight)).collect::<Vec<_>>()
            };
            let corners = group.regions.iter().zip(mixes).zip(left).flat_map(of);
            let index = self.push(root, None, &[*q]);
            self.corners[index as usize] = corners.filter(|(_, _, weight)| *weight != 0.0).collect();
            index
        };
        let index: Vec<u32> = common.places_px.iter().zip(&common.mixes).map(&mut vertex).collect();
        self.net.triangles.extend(common.triangles.iter().map(|t| t.map_each(|k| index[k as usize])));
    }

    /// Adds vertices, corners of a region or of the root.
    fn push(&mut self, root: usize, region: Option<usize>, places: &[DVec2]) -> u32 {
        let first = self.net.places_px.len() as u32;
        self.net.places_px.extend(places);
        self.root_of.resize(self.net.places_px.len(), root);
        self.corners.extend(places.iter().map(|q| region.map(|k| (k, *q, 1.0)).into_iter().collect()));
        first
    }

    fn triangles(&mut self, first: u32, triangles: Vec<[u32; 3]>) {
        self.net.triangles.extend(triangles.into_iter().map(|t| t.map_each(|k| first + k)));
    }
}

/// Regions that overlap, bands included, in the order of the file; or one region.
struct Group {
    regions: Vec<usize>,
    /// The band's outer outline of one region; a rectangle around several.
    hole: Outline,
}

/// Space between overlapping regions and the rectangle around them, px; less where the face of a cube ends.
const FRAME_PX: f64 = 0.5;

/// The regions of a root, so grouped that the groups are disjoint.
fn groups(own: &[usize], face: &[DVec2], patches: &[Patch]) -> Vec<Group> {
    let (face_lo, face_hi) = around(face);
    let joined = |a: Group, b: Group| {
        let mut regions = [a.regions, b.regions].concat();
        regions.sort_unstable();
        let all: Vec<DVec2> = regions.iter().flat_map(|&k| &patches[k].outer).copied().collect();
        let (lo, hi) = around(&all);
        let frame = |space: DVec2| (space / 2.0).min(DVec2::splat(FRAME_PX));
        Group { regions, hole: outline::rectangle(lo - frame(lo - face_lo), hi + frame(face_hi - hi)) }
    };
    let mut groups: Vec<Group> = Vec::new();
    for &k in own {
        let mut group = Group { regions: vec![k], hole: patches[k].outer.clone() };
        while let Some(at) = groups.iter().position(|g| outline::overlap(&g.hole, &group.hole)) {
            group = joined(groups.remove(at), group);
        }
        groups.push(group);
    }
    groups
}
