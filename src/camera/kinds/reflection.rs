//! `reflection` and `refraction`: a camera that looks at a mirror, or at and through a lens.
//!
//! Hou, Wei, Shum and Guo 2006, sections 3.1 and 3.2; Yu, Yu and McMillan 2009, section 5.2; for curved eyes Brosz et al. 2007, section
//! 6.1.

use super::read_part;
use crate::camera::Camera;
use crate::camera::optics::facet_error::error_px;
use crate::camera::optics::shape::{COUNT_MAX, Shape};
use crate::camera::optics::{Atlas, Bounce, Facets, Law, Optics, Surface};
use crate::camera::recipe::{Built, Recipe, SceneUse, Setting};
use crate::camera::spec::CameraSpec;
use crate::camera::values::{length, number_if};
use crate::geometry::bvh::Aabb;
use crate::geometry::load::load_mesh;
use crate::geometry::spec::{MeshSpec, read_mesh};
use crate::geometry::texture::Images;
use crate::input::limits::ROUGH_BOUNCES;
use crate::input::reader::{Field, Table};
use crate::input::{Error, Loading, Result};
use glam::DVec3;
use std::sync::Arc;

#[derive(Debug, PartialEq)]
struct Optical {
    eye: CameraSpec,
    source: Source,
    /// Number of facets of the coarser copy that defines the bounced rays.
    cameras: Option<usize>,
    facets: Mode,
    /// Largest error of the facets, px; their number follows from it.
    facets_error: Option<f64>,
    optics: Common,
}

/// The settings that do not depend on the surface.
#[derive(Debug, PartialEq)]
struct Common {
    bounce: Bounce,
    depth: u32,
    fresnel: bool,
    roughness: f64,
    rays: u32,
    environment: Option<DVec3>,
    atlas: Option<u32>,
    tint: [f32; 3],
    base: [f32; 3],
}

/// The source of the surface.
#[derive(Debug, PartialEq)]
enum Source {
    /// A shape with a number of facets.
    Shape(Shape, usize),
    /// A mesh, simplified to about this number of facets, or as it is.
    Mesh(Box<MeshSpec>, Option<usize>),
}

/// The key `facets`.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Mode {
    Flat,
    Normals,
    Exact,
}

/// The keys of both kinds.
const SHARED: [&str; 12] = [
    "kind",
    "t_range",
    "eye",
    "facets",
    "facets_error",
    "depth",
    "roughness",
    "rays",
    "environment",
    "atlas",
    "color",
    "base",
];

/// First number of facets in the search.
const COUNT_LEAST: usize = 32;

/// Most bounces of a ray; and most where each bounce splits it in two, which doubles the work.
const DEPTH_MAX: u64 = 16;
const FRESNEL_DEPTH_MAX: u64 = 8;

/// Most texels per side of a facet's triangle in an atlas.
const ATLAS_MAX: u64 = 4096;

/// Default and largest number of rays per pixel for a rough surface.
const RAYS: u64 = 16;
const RAYS_MAX: u64 = 256;

pub fn read(table: &Table) -> Result<Arc<dyn Recipe>> {
    table.allow(&[&SHARED[..], &["mirror"]].concat())?;
    let mirror = table.need("mirror", "{ shape = \"sphere\", radius = 1 }")?;
    read_optical(table, &mirror, Bounce::Reflect)
}

pub fn read_refraction(table: &Table) -> Result<Arc<dyn Recipe>> {
    table.allow(&[&SHARED[..], &["lens", "ior", "fresnel"]].concat())?;
    let key = table.need("ior", "1.5")?;
    let ior = number_if(&key, |ior| ior > 0.0, "is no index of refraction; give one above 0")?;
    let lens = table.need("lens", "{ shape = \"sphere\", radius = 1 }")?;
    read_optical(table, &lens, Bounce::Refract { ior })
}

fn read_optical(table: &Table, surface: &Field, bounce: Bounce) -> Result<Arc<dyn Recipe>> {
    let eye = table.need("eye", "{ kind = \"pinhole\", eye = [0, 0, 5], target = [0, 0, 0], vfov = 40 }")?;
    if let Some(range) = eye.table()?.get("t_range") {
        return Err(range.error("belongs beside the kind, not in the eye; move it there"));
    }
    let eye = read_part(&eye)?;
    let own = surface.table()?;
    let source = match own.get("shape") {
        Some(shape) => {
            let (shape, count) = Shape::read(&own, &shape)?;
            Source::Shape(shape, count)
        }
        None => {
            let count = own.optional("count", |f| f.integer(4, COUNT_MAX))?.map(|n| n as usize);
            Source::Mesh(Box::new(read_mesh(surface, &["count", "cameras"])?), count)
        }
    };
    let cameras = own.optional("cameras", |f| f.integer(4, COUNT_MAX))?.map(|n| n as usize);
    let facets = match table.get("facets") {
        Some(key) => read_mode(&key, &source)?,
        None if matches!(source, Source::Shape(..)) && cameras.is_none() => Mode::Exact,
        None => Mode::Normals,
    };
    let depth = table.or("depth", 1, |f| f.integer(1, DEPTH_MAX))? as u32;
    if let (Mode::Flat, Some(key)) = (facets, table.get("depth").filter(|_| depth > 1)) {
        let why = "flat facets reflect the rays from the eye to their corners, once";
        return Err(key.error(format_args!("{why}; use depth = 1 or facets = \"normals\"")));
    }
    let (tint, base) = (table.or("color", [1.0; 3], Field::color)?, table.or("base", [0.0; 3], Field::color)?);
    let fresnel = table.or("fresnel", false, Field::boolean)?;
    if let (true, Some(key)) = (fresnel && u64::from(depth) > FRESNEL_DEPTH_MAX, table.get("depth")) {
        return Err(key.error(format_args!(
            "{depth} bounces split a ray into {} with fresnel; use {FRESNEL_DEPTH_MAX} at most",
            1u64 << depth
        )));
    }
    let roughness = |f: &Field| number_if(f, |tangent| tangent >= 0.0, "is below 0; use a tangent from 0");
    let roughness = table.or("roughness", 0.0, roughness)?;
    let rays = if roughness > 0.0 { table.or("rays", RAYS, |f| f.integer(1, RAYS_MAX))? as u32 } else { 1 };
    if let (true, Some(key)) = (roughness == 0.0, table.get("rays")) {
        return Err(key.error("several rays need a roughness above 0; add it or leave this out"));
    }
    let environment = table.optional("environment", Field::vec3)?;
    if let (true, Some(key)) = (environment.is_some() && depth > 1, table.get("depth")) {
        return Err(key.error("an environment map knows nothing of the mirror; use depth = 1 or leave environment out"));
    }
    let atlas = table.optional("atlas", |f| f.integer(2, ATLAS_MAX))?.map(|r| r as u32);
    if let (true, Some(key)) = (depth > 1 || fresnel || rays > 1 || facets == Mode::Exact, table.get("atlas")) {
        return Err(key.error(
            "an atlas holds one ray of every facet's texel; use flat facets or normals, depth 1, no fresnel, no roughness",
        ));
    }
    let optics = Common { bounce, depth, fresnel, roughness, rays, environment, atlas, tint, base };
    let facets_error = table.optional("facets_error", length)?;
    if let (true, Some(key)) = (facets == Mode::Exact, table.get("facets_error")) {
        return Err(key.error("this surface is met exactly; leave it out, or use facets = \"normals\" or \"flat\""));
    }
    if let (Some(_), Some(key)) = (cameras, own.get("cameras")) {
        check_cameras(&key, facets, facets_error.is_some())?;
    }
    Ok(Arc::new(Optical { eye, source, cameras, facets, facets_error, optics }))
}

/// Errors where camera facets contradict other keys.
fn check_cameras(key: &Field, facets: Mode, has_error: bool) -> Result<()> {
    let why = match (facets, has_error) {
        (Mode::Exact, ..) => "this surface is met exactly; leave it out, or use facets = \"normals\" or \"flat\"",
        (_, true) => "facets_error is of facets with their own normals; leave one of the two out",
        _ => return Ok(()),
    };
    Err(key.error(why))
}

fn read_mode(key: &Field, source: &Source) -> Result<Mode> {
    match key.text()? {
        "flat" => Ok(Mode::Flat),
        "normals" => Ok(Mode::Normals),
        "exact" if matches!(source, Source::Shape(..)) => Ok(Mode::Exact),
        "exact" => Err(key.error("a mesh is flat triangles; use \"normals\", or a shape, which is smooth")),
        _ => Err(key.error("use \"flat\", \"normals\" or \"exact\"")),
    }
}

impl Source {
    /// The corners of a box around the surface.
    fn bounds(&self, loading: &Loading) -> Result<(DVec3, DVec3)> {
        let Aabb { lo, hi } = match self {
            Source::Shape(shape, _) => shape.smooth().bounds(),
            Source::Mesh(..) => Aabb::around(&self.facets(None, loading)?.positions),
        };
        Ok((lo, hi))
    }

    /// The surface tessellated into facets, about `count` where that is given.
    fn facets(&self, count: Option<usize>, loading: &Loading) -> Result<Facets> {
        match self {
            Source::Shape(shape, own) => Ok(shape.facets(count.unwrap_or(*own))),
            Source::Mesh(spec, own) => {
                let facets = Facets::of_mesh(&load_mesh(spec, &mut Images::left_out(), loading)?)?;
                count.or(*own).map_or_else(|| Ok(facets.clone()), |n| facets.resampled(n))
            }
        }
    }
}

impl Recipe for Optical {
    fn build(&self, setting: &Setting) -> Result<Built> {
        let eye_in = |setting: &Setting| Camera::in_setting(&self.eye, setting).map_err(|e| e.at("camera.eye"));
        let mut eye = eye_in(setting)?;
        if eye.scene_use != SceneUse::Nothing {
            // the surface is in view, too
            eye = eye_in(&setting.and(self.source.bounds(setting.loading())?))?;
        }
        self.check_eye(&eye, setting)?;
        let central = || centre(&eye);
        let Common { rays, depth, .. } = self.optics;
        if rays > 1 {
            let bounces = u64::from(eye.width) * u64::from(eye.height) * u64::from(rays) * u64::from(depth);
            let shown =
                format_args!("{} x {} pixels with {rays} rays to depth {depth}: {bounces}", eye.width, eye.height);
            setting.limits().check_as(ROUGH_BOUNCES, bounces, shown).map_err(|e| e.at("camera.rays"))?;
        }
        let (surface, note) = match (self.facets, &self.source) {
            (Mode::Exact, Source::Shape(shape, _)) => {
                let smooth = shape.smooth();
                let note = format!("the surface is met exactly: {}", smooth.name());
                (Surface::Smooth(smooth), note)
            }
            (mode, _) => {
                let law = if mode == Mode::Flat { Law::Flat { eye: central()? } } else { Law::Normals };
                let (facets, off) = self.tessellate(&eye, law, setting)?;
                let n = facets.triangles.len();
                let off = match (self.facets_error, off) {
                    (None, _) => String::new(),
                    (Some(_), Some(px)) => format!(", off by {px:.3} px (95th percentile)"),
                    (Some(_), None) => ", as few as there may be: no pixel sees them".into(),
                };
                let (facets, as_of) = self.matched(facets, setting.loading())?;
                let note = format!("the surface is tessellated into {n} facet{}{off}{as_of}", plural(n));
                (Surface::Facets { facets, law }, note)
            }
        };
        // curves and layers end where they end
        let t_range = eye.is_curved_or_layered().then_some(eye.t_range);
        let atlas = self.optics.atlas.map(|texels| Ok::<_, Error>(Atlas { texels, eye: central()? })).transpose()?;
        let optics = self.optics.with(surface, atlas);
        let mut notes = eye.notes;
        notes.push(note);
        let size = (eye.width, eye.height);
        let (optics, unfulfilled) = (Some(Arc::new(optics)), eye.unfulfilled);
        Ok(Built { t_range, optics, notes, unfulfilled, ..Built::of_layers(size, eye.layers) })
    }
}

impl Optical {
    /// Refuses what a mirror or lens cannot do for this eye.
    fn check_eye(&self, eye: &Camera, setting: &Setting) -> Result<()> {
        let kind = eye.kind;
        let refused = |key: &str, why: String| Err(Error::input(format!("camera.{key}: {why}")));
        if eye.optics.is_some() {
            return refused(
                "eye",
                format!("{kind} looks at a mirror or lens itself; use a camera that looks at the scene"),
            );
        }
        if eye.layered().is_some() {
            return refused(
                "eye",
                format!("a {kind} with master or feather has several rays per pixel; use one of its cameras"),
            );
        }
        if eye.composition.is_some() && eye.t_range != [0.0, f64::INFINITY] {
            return refused("eye", format!("cameras of this {kind} have a t_range; leave it out"));
        }
        if !eye.is_curved_or_layered() {
            return Ok(());
        }
        let rays = if eye.is_curved() { "curved rays" } else { "several layers of rays" };
        if setting.t_range != [0.0, f64::INFINITY] {
            return refused("t_range", format!("the {rays} of {kind} end where they end; leave it out"));
        }
        match self {
            Optical { facets: Mode::Exact, .. } if eye.is_curved() => refused(
                "facets",
                format!("{kind} has {rays}, which meet facets but not the exact surface; use facets = \"normals\""),
            ),
            Optical { facets: Mode::Flat, .. } => {
                refused("facets", format!("flat facets need an eye in one point; {kind} has {rays}; use \"normals\""))
            }
            Optical { optics: Common { atlas: Some(_), .. }, .. } => {
                refused("atlas", format!("an atlas needs an eye in one point; {kind} has {rays}; leave it out"))
            }
            Optical { facets_error: Some(_), .. } => refused(
                "facets_error",
                format!("it is measured for one straight ray a pixel; {kind} has {rays}; use count"),
            ),
            _ => Ok(()),
        }
    }

    /// The facets with the normals of the coarser copy, if any; and a note on it.
    fn matched(&self, facets: Facets, loading: &Loading) -> Result<(Facets, String)> {
        let Some(count) = self.cameras else { return Ok((facets, String::new())) };
        let coarse = self.source.facets(Some(count), loading).map_err(|e| e.at("camera"))?;
        let n = coarse.triangles.len();
        Ok((facets.shot_at(&coarse), format!(" that reflect rays as {n} camera facet{} would", plural(n))))
    }

    /// The facets; and their error in pixels if their number follows from it.
    fn tessellate(&self, eye: &Camera, law: Law, setting: &Setting) -> Result<(Facets, Option<f64>)> {
        let at = |e: Error| e.at("camera");
        let loading = setting.loading();
        let Some(most) = self.facets_error else {
            return Ok((self.source.facets(None, loading).map_err(at)?, None));
        };
        let once = |surface| Optics { depth: 1, ..self.optics.with(surface, None) };
        let truth = match &self.source {
            Source::Shape(shape, _) => Surface::Smooth(shape.smooth()),
            // a mesh is what it is
            Source::Mesh(spec, _) => Surface::Facets {
                facets: Facets::of_mesh(&load_mesh(spec, &mut Images::left_out(), loading)?).map_err(at)?,
                law: Law::Normals,
            },
        };
        let truth = once(truth);
        let middle = setting.bounds().map_or(DVec3::ZERO, |(lo, hi)| (lo + hi) / 2.0);
        let mut count = COUNT_LEAST;
        loop {
            let facets = self.source.facets(Some(count), loading).map_err(at)?;
            let off = error_px(eye, &truth, &once(Surface::Facets { facets: facets.clone(), law }), middle);
            if off.is_none_or(|px| px <= most) || 2 * count > COUNT_MAX as usize {
                return Ok((facets, off));
            }
            count *= 2;
        }
    }
}

impl Common {
    fn with(&self, surface: Surface, atlas: Option<Atlas>) -> Optics {
        let Common { bounce, depth, fresnel, roughness, rays, environment, tint, base, .. } = *self;
        Optics { bounce, surface, depth, fresnel, roughness, rays, environment, atlas, tint, base }
    }
}

fn plural(n: usize) -> &'static str {
    if n == 1 { "" } else { "s" }
}

/// Where all rays of a central camera start.
fn centre(eye: &Camera) -> Result<DVec3> {
    eye.centre().ok_or_else(|| {
        Error::input(format!(
            "camera.eye: the rays of {} do not start in one point, which flat facets and an atlas need; use facets = \"normals\"",
            eye.kind
        ))
    })
}
