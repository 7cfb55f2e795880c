//! `lidar`: rays that need not form a picture: a list of rays, or those of a spinning scanner.

use super::{Lens, POSE, Pose, Posed};
use crate::camera::exposure::{LineOrder, Lines};
use crate::camera::recipe::{Built, Recipe, Setting};
use crate::camera::tessellate::Tessellation;
use crate::camera::{Ray, RayMap};
use crate::image::read_npy_rows;
use crate::image::size::check_size;
use crate::input::reader::{Field, Table};
use crate::input::{Error, Result};
use glam::DVec3;
use std::collections::hash_map::DefaultHasher;
use std::hash::{Hash, Hasher};
use std::path::PathBuf;
use std::sync::Arc;

const LIST_KEYS: [&str; 3] = ["kind", "t_range", "file"];

/// The keys of a spinning scanner, besides its pose.
const SCANNER_KEYS: [&str; 6] = ["beams", "columns", "start", "sweep", "velocity", "period"];

pub fn read(table: &Table) -> Result<Arc<dyn Recipe>> {
    if let Some(file) = table.get("file") {
        if let Some(key) = POSE.iter().chain(&SCANNER_KEYS).find(|key| table.has(key)) {
            let what = "describes a scanner, but file lists the rays; leave one of the two out";
            return Err(table.error(format_args!("{key} {what}")));
        }
        table.allow(&LIST_KEYS)?;
        return read_list(&file);
    }
    table.allow(&[&LIST_KEYS[..], &POSE, &SCANNER_KEYS].concat())?;
    let beams = table.need("beams", "[15, 0, -15], or file = \"rays.npy\"")?;
    let elevations: Vec<f64> =
        beams.items("the beams' elevations in degrees")?.map(|beam| beam.number()).collect::<Result<_>>()?;
    if elevations.is_empty() || elevations.iter().any(|e| e.abs() > 90.0) {
        return Err(beams.error("give at least one elevation, each from -90 to 90 degrees"));
    }
    let columns = table.need("columns", "1024")?;
    let count = columns.integer(1, u32::MAX.into())?;
    check_size(count, elevations.len() as u64).map_err(|e| columns.error(e))?;
    if let (Some(velocity), false) = (table.get("velocity"), table.has("period")) {
        return Err(velocity.error("the scanner moves during its sweep only with a period; add period = 0.1"));
    }
    let period = table.or("period", 0.0, Field::number)?;
    Ok(Arc::new(Scanner {
        pose: Pose::read(table)?,
        beams: Beams {
            elevations: elevations.into_iter().map(f64::to_radians).collect(),
            // checked above to be far under 2^32
            columns: count as u32,
            start: table.or("start", -180.0, Field::number)?.to_radians(),
            sweep: table.or("sweep", 360.0, Field::number)?.to_radians(),
            travel: DVec3::ZERO,
        },
        travel: table.or("velocity", DVec3::ZERO, Field::vec3)? * period,
        period,
    }))
}

/// N x 6 numbers: P and D of each ray.
fn read_list(file: &Field) -> Result<Arc<dyn Recipe>> {
    let path = file.path()?;
    let rows = read_npy_rows::<6>(&path, file.loading())?;
    let ray = |r: [f64; 6]| Ray { origin: DVec3::new(r[0], r[1], r[2]), direction: DVec3::new(r[3], r[4], r[5]) };
    Ok(Arc::new(List { path, rays: rows.into_iter().map(ray).collect() }))
}

/// Rays in no order but their own.
#[derive(Debug, PartialEq)]
struct List {
    path: PathBuf,
    rays: Arc<[Ray]>,
}

impl Recipe for List {
    /// Row by row in the image's width; without a size in a picture about as high as it is wide.
    fn build(&self, setting: &Setting) -> Result<Built> {
        let n = self.rays.len();
        if n == 0 {
            return Err(Error::input("camera.file: the list has no rays"));
        }
        let side = (n as f64).sqrt().ceil() as u64;
        let (w, h) = match setting.size {
            Some((w, h)) => (u64::from(w), u64::from(h)),
            None => (side, (n as u64).div_ceil(side)),
        };
        check_size(w, h).map_err(|e| e.at("camera.file"))?;
        if w * h < n as u64 {
            let rows = (n as u64).div_ceil(w);
            return Err(Error::input(format!(
                "image: {w} x {h} pixels for {n} rays; use {w} x {rows} or leave it out"
            )));
        }
        // checked to be far under 2^32
        let size = (w as u32, h as u32);
        let map = Pixels { size, rays: self.rays.clone() };
        Tessellation::Exact.build(Arc::new(map), &setting.of_size(Some(size)))
    }
}

/// The index of the pixel at an image coordinate, of so many.
fn index(x: f64, count: u32) -> usize {
    // a cast saturates at 0
    ((x * f64::from(count)) as usize).min(count as usize - 1)
}

/// Of all numbers of rays.
fn hash_of(rays: &[Ray]) -> u64 {
    let mut hasher = DefaultHasher::new();
    let numbers = rays.iter().flat_map(|ray| ray.origin.to_array().into_iter().chain(ray.direction.to_array()));
    numbers.for_each(|v| v.to_bits().hash(&mut hasher));
    hasher.finish()
}

/// One pixel per ray, row by row; the ray is constant over the pixel, because neighbours are unrelated.
struct Pixels {
    size: (u32, u32),
    rays: Arc<[Ray]>,
}

impl std::fmt::Debug for Pixels {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(f, "{} rays {:016x} in {:?}", self.rays.len(), hash_of(&self.rays), self.size)
    }
}

impl RayMap for Pixels {
    fn ray(&self, a: f64, b: f64) -> Option<Ray> {
        let (w, h) = self.size;
        self.rays.get(index(b, h) * w as usize + index(a, w)).copied()
    }
}

/// Beams at fixed elevations that rotate about an axis.
#[derive(Debug, PartialEq)]
struct Scanner {
    pose: Pose,
    beams: Beams,
    /// Translation of the scanner during the sweep, world units.
    travel: DVec3,
    /// Seconds of a sweep; 0: it takes no time.
    period: f64,
}

impl Recipe for Scanner {
    fn build(&self, setting: &Setting) -> Result<Built> {
        let size = (self.beams.columns, self.beams.elevations.len() as u32);
        if setting.size.is_some_and(|s| s != size) {
            let (w, h) = size;
            return Err(Error::input(format!("image: the scan is {w} x {h}; leave the size out or make it that")));
        }
        let view = self.pose.view()?;
        let travel = DVec3::new(self.travel.dot(view.right), self.travel.dot(view.up), self.travel.dot(view.forward));
        let lens = Arc::new(Beams { travel, ..self.beams.clone() });
        Tessellation::Exact.build(Arc::new(Posed { eye: self.pose.eye, view, lens }), &setting.of_size(Some(size)))
    }

    fn lines(&self) -> Option<Lines> {
        let line_time = self.period / f64::from(self.beams.columns);
        (self.period != 0.0).then_some(Lines {
            first: line_time / 2.0,
            line_time,
            order: LineOrder::Right,
            count: self.beams.columns,
        })
    }
}

/// The beams in the scanner's own frame.
#[derive(Debug, Clone, PartialEq)]
struct Beams {
    /// Radians above the horizon, the first in the top row.
    elevations: Arc<[f64]>,
    columns: u32,
    /// Radians to the right of ahead where the sweep starts, and how far it goes.
    start: f64,
    sweep: f64,
    /// Translation during the sweep.
    travel: DVec3,
}

impl Lens for Beams {
    fn direction(&self, a: f64, b: f64) -> Option<DVec3> {
        let elevation = self.elevations[index(b, self.elevations.len() as u32)];
        let (sin, cos) = (self.start + self.part(a) * self.sweep).sin_cos();
        Some(DVec3::new(elevation.cos() * sin, elevation.sin(), elevation.cos() * cos))
    }

    fn origin(&self, a: f64, _b: f64) -> Option<DVec3> {
        (self.travel != DVec3::ZERO).then(|| self.part(a) * self.travel)
    }
}

impl Beams {
    /// The part of the sweep that is done at the middle of the column at image coordinate `a`.
    fn part(&self, a: f64) -> f64 {
        (index(a, self.columns) as f64 + 0.5) / f64::from(self.columns)
    }
}
