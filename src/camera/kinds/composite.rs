//! `composite`: several cameras, each in a region of one image (Agrawala et al. 2000; Brosz et al. 2007, section 6.1).

mod mask;
mod parts;
mod region;

use crate::camera::curve::Curves;
use crate::camera::field::Field;
use crate::camera::recipe::{Built, Recipe, Setting};
use crate::camera::spec::{CameraSpec, read_camera};
use crate::camera::{Camera, Rays};
use crate::image::size::check_size;
use crate::input::reader::{self, Table};
use crate::input::{Error, Result};
use glam::DVec2;
use parts::{Part, Parts};
use rayon::prelude::*;
use region::Region;
use std::sync::Arc;

#[derive(Debug, PartialEq)]
struct Composite {
    members: Vec<Member>,
}

/// A camera as written.
#[derive(Debug, PartialEq)]
struct Member {
    camera: CameraSpec,
    region: Region,
    /// Its own image is the box around its region.
    framed_by_region: bool,
    priority: i32,
}

/// Most cameras: a pixel asks the regions one by one.
const CAMERAS_MAX: usize = 256;

pub fn read(table: &Table) -> Result<Arc<dyn Recipe>> {
    table.allow(&["kind", "cameras"])?;
    let field = table.need("cameras", "[{ camera = { kind = \"pinhole\", ... }, region = { ... } }]")?;
    let items = field.items("a list of tables with a camera and its region")?;
    let count = items.len();
    if !(1..=CAMERAS_MAX).contains(&count) {
        return Err(field.error(format_args!("{count} cameras; a composite has 1 to {CAMERAS_MAX}")));
    }
    let members = items.map(|item| Member::read(&item.table()?)).collect::<Result<_>>()?;
    Ok(Arc::new(Composite { members }))
}

impl Member {
    fn read(table: &Table) -> Result<Member> {
        table.allow(&["camera", "region", "frame", "priority"])?;
        Ok(Member {
            camera: read_camera(&table.need("camera", "{ kind = \"pinhole\", ... }")?)?,
            region: table.or("region", Region::Whole, Region::read)?,
            framed_by_region: table.or("frame", false, |field| match field.text()? {
                "image" => Ok(false),
                "region" => Ok(true),
                _ => Err(field.error("use \"image\" or \"region\"")),
            })?,
            priority: table.or("priority", 0, read_priority)?,
        })
    }

    /// The corners of its own image in the whole one; `None`: the whole image.
    fn frame(&self) -> Option<[DVec2; 2]> {
        self.framed_by_region.then(|| self.region.bounds())
    }

    /// The size of its own image in whole pixels.
    fn size(&self, (width, height): (u32, u32)) -> Result<(u32, u32)> {
        let Some([low, high]) = self.frame() else { return Ok((width, height)) };
        let size = ((high - low) * DVec2::new(width.into(), height.into())).round().max(DVec2::ONE);
        check_size(size.x as u64, size.y as u64)?;
        Ok((size.x as u32, size.y as u32))
    }

    fn compile(&self, setting: &Setting) -> Result<Camera> {
        let size = self.size(setting.size()?)?;
        let camera = Camera::in_setting(&self.camera, &setting.of_size(Some(size)));
        let camera = camera.map_err(|e| self.conflict(size, setting).unwrap_or(e))?;
        let kind = camera.kind;
        if camera.optics.is_some() {
            return Err(Error::input(format!(
                "camera.kind: {kind} looks at a mirror or lens; use a camera that looks at the scene itself"
            )));
        }
        match camera.layers.len() {
            1 => Ok(camera),
            count => {
                Err(Error::input(format!("camera.kind: {kind} has {count} layers of rays; use a camera of one layer")))
            }
        }
    }

    /// The error of a camera that has another size of its own.
    fn conflict(&self, (width, height): (u32, u32), setting: &Setting) -> Option<Error> {
        let Camera { width: w, height: h, .. } = Camera::in_setting(&self.camera, &setting.of_size(None)).ok()?;
        let remedy = "change the size of the image or the region, or use other rays";
        let message = format!("camera: it has {w} x {h} rays, but its own image is {width} x {height}; {remedy}");
        ((w, h) != (width, height)).then(|| Error::input(message))
    }
}

fn read_priority(field: &reader::Field) -> Result<i32> {
    let number = field.number()?;
    let priority = number as i32;
    if f64::from(priority) != number {
        return Err(field.error("expected a whole number, such as 1; the highest one comes first"));
    }
    Ok(priority)
}

/// Of the camera with this number.
fn key(number: usize) -> String {
    format!("camera.cameras.{number}.camera")
}

/// An error of the camera with this number: "camera.KEY: ..." becomes that key of its own table.
fn error_of(number: usize, error: Error) -> Error {
    match error {
        Error::Input(message) => match message.strip_prefix("camera") {
            Some(rest) => Error::input(format!("{}{rest}", key(number))),
            None => Error::input(message).at(key(number)),
        },
        other => other.at(key(number)),
    }
}

impl Recipe for Composite {
    /// A ray for each pixel; curves if any camera has some.
    fn build(&self, setting: &Setting) -> Result<Built> {
        let (width, height) = setting.size()?;
        let compiled = |(k, member): (usize, &Member)| member.compile(setting).map_err(|e| error_of(k, e));
        let cameras = self.members.iter().enumerate().map(compiled).collect::<Result<Vec<Camera>>>()?;
        let of_each = |what: fn(&Camera) -> &[String]| -> Vec<String> {
            let of_one = |(k, camera)| what(camera).iter().map(move |note| format!("camera {k}: {note}"));
            cameras.iter().enumerate().flat_map(of_one).collect()
        };
        let (mut notes, unfulfilled) = (of_each(|camera| &camera.notes), of_each(|camera| &camera.unfulfilled));
        let (is_curved, t_range) = (cameras.iter().any(Camera::is_curved), common_range(&cameras)?);
        let parts = self.parts(cameras, (width, height), t_range.is_none());
        notes.extend(self.hidden(&parts, (width, height)));
        let rays = match is_curved {
            true => Rays::Curves(curves(width, height, parts)?),
            false => Rays::Field(Field::of_map(width, height, Arc::new(parts))?),
        };
        let built = Built::new((width, height), rays);
        Ok(Built { t_range: Some(t_range.unwrap_or([0.0, 1.0])), notes, unfulfilled, ..built })
    }
}

impl Composite {
    /// The numbers of the cameras, those with the highest priority first.
    fn order(&self) -> Vec<usize> {
        let mut order: Vec<usize> = (0..self.members.len()).collect();
        // stable: equal ones stay in the order of the file
        order.sort_by_key(|k| std::cmp::Reverse(self.members[*k].priority));
        order
    }

    /// The compiled cameras in order; with `rescaled` their t is from 0 to 1.
    fn parts(&self, cameras: Vec<Camera>, (width, height): (u32, u32), rescaled: bool) -> Parts {
        let part = |k: usize| {
            let (member, camera) = (&self.members[k], &cameras[k]);
            Part {
                region: member.region.clone(),
                frame: member.frame(),
                camera: camera.clone(),
                span: Some(camera.t_range).filter(|range| rescaled && *range != [0.0, 1.0]),
            }
        };
        let degree = |part: &Part| match part.camera.layers.first() {
            Some(Rays::Curves(curves)) => curves.map.degree(),
            _ => 1,
        };
        let parts: Vec<Part> = self.order().into_iter().map(part).collect();
        let degree = parts.iter().map(degree).max().unwrap_or(1);
        Parts { size: DVec2::new(width.into(), height.into()), parts, degree }
    }

    /// Notes on cameras that show at no pixel's centre.
    fn hidden(&self, parts: &Parts, (width, height): (u32, u32)) -> Vec<String> {
        let count = parts.parts.len();
        let joined = |mut a: Vec<bool>, b: Vec<bool>| {
            a.iter_mut().zip(b).for_each(|(a, b)| *a |= b);
            a
        };
        let of_row = |j: u32| {
            let mut shown = vec![false; count];
            let place = |i: u32| DVec2::new(f64::from(i), f64::from(j)) + 0.5;
            (0..width).filter_map(|i| parts.owner(place(i))).for_each(|k| shown[k] = true);
            shown
        };
        let shown = (0..height).into_par_iter().map(of_row).reduce(|| vec![false; count], joined);
        let mut hidden: Vec<usize> = self.order().into_iter().zip(shown).filter(|(_, s)| !s).map(|(k, _)| k).collect();
        hidden.sort_unstable();
        let note = |k: usize| {
            format!("camera {k} shows nowhere: its region holds no pixel's centre, or others come before it")
        };
        hidden.into_iter().map(note).collect()
    }
}

/// The range of t that all cameras have, if all rays are straight; `None`: each camera's own becomes [0, 1].
fn common_range(cameras: &[Camera]) -> Result<Option<[f64; 2]>> {
    let first = cameras[0].t_range;
    let curved = cameras.iter().position(Camera::is_curved);
    if curved.is_none() && cameras.iter().all(|camera| camera.t_range == first) {
        return Ok(Some(first));
    }
    let is_endless = |camera: &Camera| !(camera.t_range[1] - camera.t_range[0]).is_finite();
    let is_point = |camera: &Camera| camera.t_range[0] == camera.t_range[1];
    let Some(k) = cameras.iter().position(|camera| is_endless(camera) || is_point(camera)) else { return Ok(None) };
    let [t0, t1] = cameras[k].t_range;
    let what = if is_endless(&cameras[k]) { "does not end" } else { "is one t" };
    let why = match curved {
        Some(other) => format!("camera {other} has curved rays"),
        None => "the cameras differ in their t_range".into(),
    };
    Err(Error::input(format!("{}.t_range: [{t0}, {t1}] {what}, and {why}; give it two ends, as [0, 100]", key(k))))
}

fn curves(width: u32, height: u32, parts: Parts) -> Result<Curves> {
    let curves = Curves::new(width, height, Arc::new(parts));
    let has_curve = |j: u32| (0..width).any(|i| curves.near(i, j, (0.0, 0.0)).is_some());
    if !(0..height).into_par_iter().any(has_curve) {
        return Err(Error::input("camera: no pixel has a ray; make the regions larger"));
    }
    Ok(curves)
}
