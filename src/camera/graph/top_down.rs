//! `top_down`: a root view with regions that have their own viewpoints (Popescu et al., section 3.3,
//! Fig. 1 and 6). The root is a pinhole, or the six faces of a cube around its eye (section 4.3).

use super::Net;
use super::bottom_up::{least, place};
use super::connect::JoinOptions;
use super::legs::{self, Depths};
use super::outline::{self, Outline};
use super::path::Occluders;
use super::roots::{self, Layout, Root};
use super::view::{Pinhole, View, beyond};
use crate::camera::kinds::values::length;
use crate::camera::pose::{KEYS as POSE, Pose};
use crate::camera::recipe::{Built, Recipe, Setting};
use crate::input::limits;
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
    let layout = table.or("layout", Layout::Plain, |field| match field.text()? {
        "plain" => Ok(Layout::Plain),
        "cross" => Ok(Layout::Cross),
        "strip" => Ok(Layout::Strip),
        _ => Err(field.error("use layout = \"plain\", \"cross\" or \"strip\"")),
    })?;
    let root = match (layout, table.get("vfov")) {
        (Layout::Plain, _) => Pinhole::read(table)?,
        (_, Some(vfov)) => return Err(vfov.error("a cube's faces are 90 degrees high; leave vfov out")),
        _ => Pinhole { pose: Pose::read(table)?, vfov: 90.0 },
    };
    let foreground = table.or("foreground", false, Field::boolean)?;
    for key in ["cut", "longitudinal", "join"] {
        if let (Some(field), false) = (table.get(key), foreground) {
            return Err(field.error(format_args!("{key} is of the segments before the regions; add foreground = true")));
        }
    }
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
            limits::CORNERS.check(corners.len() as u64).map_err(|e| polygon.error(e))?;
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
        let far = self.far.unwrap_or_else(|| beyond(setting.mesh(), &eyes, 1000.0 * reach).max(2.0 * self.near));
        let depths = self.foreground.then(|| self.depths(&mesh, &patches, &roots, far));
        let far = depths.map_or(far, |d| d[2]);
        let plain = legs::plain(&mesh.net, root, far, depths);
        let leaf_depth = depths.map_or(0.0, |d| d[1]);
        let leaf = |plain_depth: f64, own_depth: f64| {
            let point = |(k, q): (usize, &DVec2)| match mesh.patch_of[k] {
                Some(patch) => patches[patch].view.point(*q, own_depth),
                None => root(k).point(*q, plain_depth),
            };
            mesh.net.places_px.iter().enumerate().map(point).collect::<Vec<_>>()
        };
        let graph = legs::with_leaves(&plain, [leaf(leaf_depth, self.near), leaf(far, far)], depths);
        let folds = graph.folds(setting.bounds());
        let mut built = graph.morphed(&plain, self.join.morph).build(self.join.bend, size)?;
        built.notes.extend(
            fold_note(folds).map(|note| note + "; make band wider, or move the regions' eyes nearer to the root's"),
        );
        Ok(built)
    }
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
            let (lo, hi) = outline::bounds(&inner);
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
            if let Some(other) = patches.iter().position(|p| outline::overlap(&p.outer, &outer)) {
                return Err(error(format!(
                    "overlaps region {other}, bands included; move them apart or make band smaller"
                )));
            }
            let (face_lo, face_hi) = outline::bounds(&root.outline);
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
                let message = e.to_string();
                let rest = message.strip_prefix("camera").unwrap_or(&message);
                Error::input(format!("camera.regions.{k}{rest} (the region looks at {})", place(pose.target)))
            })?;
            patches.push(Patch { view, root: at, inner, outer });
        }
        if self.layout == Layout::Plain {
            let all = patches.iter().flat_map(|p| &p.outer).copied().chain([DVec2::ZERO, size]);
            let (lo, hi) = outline::bounds(&all.collect::<Vec<_>>());
            roots[0].outline = outline::rectangle(lo - 1.0, hi + 1.0);
        }
        Ok(patches)
    }

    /// The cut plane is halfway to the nearest near face of a region.
    fn depths(&self, mesh: &NetOfRoots, patches: &[Patch], roots: &[Root], far: f64) -> Depths {
        let corners = || mesh.patch_of.iter().enumerate().filter_map(|(k, p)| p.map(|p| (k, p)));
        let near = |(k, p): (usize, usize)| patches[p].view.point(mesh.net.places_px[k], self.near);
        let depth = |(k, p): (usize, usize)| roots[mesh.root_of[k]].view.depth(near((k, p)));
        let nearest = corners().map(depth).filter(|d| *d > 0.0).fold(f64::INFINITY, f64::min);
        let cut = self.cut.unwrap_or(if nearest.is_finite() { nearest / 2.0 } else { far / 1000.0 });
        let leg_length = |(k, p): (usize, usize)| {
            (near((k, p)) - roots[mesh.root_of[k]].view.point(mesh.net.places_px[k], cut)).length()
        };
        let (sum, count) = corners().map(leg_length).fold((0.0, 0), |(s, n), w| (s + w, n + 1));
        let near = cut + if sum > 0.0 { sum / count as f64 } else { cut };
        [cut, near, far.max(2.0 * near)]
    }
}

/// A net over roots and regions.
#[derive(Default)]
struct NetOfRoots {
    net: Net,
    /// The root of every vertex, and the region whose own view it is seen by.
    root_of: Vec<usize>,
    patch_of: Vec<Option<usize>>,
}

impl NetOfRoots {
    /// Adds a root: what is around its regions, the bands around them, and the regions.
    fn add(&mut self, root: usize, outline: &[DVec2], patches: &[Patch]) {
        let own: Vec<usize> = (0..patches.len()).filter(|&k| patches[k].root == root).collect();
        let holes: Vec<Outline> = own.iter().map(|&k| patches[k].outer.clone()).collect();
        let mut outer_first = self.push(root, None, outline) + outline.len() as u32;
        let first = outer_first - outline.len() as u32;
        for hole in &holes {
            self.push(root, None, hole);
        }
        self.triangles(first, outline::triangulate(outline, &holes));
        for &k in &own {
            let n = patches[k].inner.len() as u32;
            let inner_first = self.push(root, Some(k), &patches[k].inner);
            self.triangles(inner_first, outline::triangulate(&patches[k].inner, &[]));
            for s in 0..n {
                let next = (s + 1) % n;
                let [a, b] = [inner_first + s, inner_first + next];
                let [c, d] = [outer_first + s, outer_first + next];
                self.net.triangles.extend([[a, b, c], [b, d, c]]);
            }
            outer_first += n;
        }
    }

    fn push(&mut self, root: usize, patch: Option<usize>, places: &[DVec2]) -> u32 {
        let first = self.net.places_px.len() as u32;
        self.net.places_px.extend(places);
        self.root_of.resize(self.net.places_px.len(), root);
        self.patch_of.resize(self.net.places_px.len(), patch);
        first
    }

    fn triangles(&mut self, first: u32, triangles: Vec<[u32; 3]>) {
        self.net.triangles.extend(triangles.into_iter().map(|t| t.map(|k| first + k)));
    }
}
