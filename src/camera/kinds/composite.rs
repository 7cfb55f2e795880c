//! `composite`: several cameras, each in a region of one image (Agrawala et al. 2000; Brosz et al. 2007, section 6.1).

mod parts;

use super::read_part;
use crate::camera::composition::{Composition, Shown};
use crate::camera::curve::Curves;
use crate::camera::field::Field;
use crate::camera::notes::Notes;
use crate::camera::recipe::{Built, Recipe, Setting};
use crate::camera::region::Region;
use crate::camera::spec::CameraSpec;
use crate::camera::values::{number_if, word};
use crate::camera::{Camera, Rays};
use crate::image::size::check_size;
use crate::input::reader::{self, Table};
use crate::input::{Error, Result};
use crate::parallel;
use glam::DVec2;
use parts::{Part, Parts};
use std::collections::BTreeSet;
use std::sync::Arc;

#[derive(Debug, PartialEq)]
struct Composite {
    members: Vec<Member>,
    /// The number of the camera by whose depth cameras of one priority are ordered.
    master: Option<usize>,
}

/// A camera as written.
#[derive(Debug, PartialEq)]
struct Member {
    camera: CameraSpec,
    region: Region,
    /// Its own image is the box around its region.
    framed_by_region: bool,
    priority: i32,
    /// Width of the strip along the region's border in which colours are blended, px; 0: none.
    feather: f64,
    /// Patterns of the names of the objects that it shows.
    objects: Option<Vec<String>>,
}

/// Most cameras: a pixel asks the regions one by one.
const CAMERAS_MAX: usize = 256;

pub fn read(table: &Table) -> Result<Arc<dyn Recipe>> {
    table.allow(&["kind", "cameras", "master"])?;
    let field = table.need("cameras", "[{ camera = { kind = \"pinhole\", ... }, region = { ... } }]")?;
    let items = field.items("a list of tables with a camera and its region")?;
    let count = items.len();
    if !(1..=CAMERAS_MAX).contains(&count) {
        return Err(field.error(format_args!("{count} cameras; a composite has 1 to {CAMERAS_MAX}")));
    }
    let tables = items.map(|item| item.table()).collect::<Result<Vec<Table>>>()?;
    let members: Vec<Member> = tables.iter().map(Member::read).collect::<Result<_>>()?;
    let master = table.or("master", None, |field| Ok(Some(field.integer(0, count as u64 - 1)? as usize)))?;
    if let (None, Some(k)) = (master, members.iter().position(|member| member.objects.is_some())) {
        return Err(tables[k]
            .error("objects need a camera that says which of them hides which; add master = 0, a camera's number"));
    }
    Ok(Arc::new(Composite { members, master }))
}

impl Member {
    fn read(table: &Table) -> Result<Member> {
        table.allow(&["camera", "region", "frame", "priority", "feather", "objects"])?;
        let region = table.or("region", Region::Whole, Region::read)?;
        Ok(Member {
            camera: read_part(&table.need("camera", "{ kind = \"pinhole\", ... }")?)?,
            feather: table.or("feather", 0.0, |field| read_feather(field, &region))?,
            region,
            framed_by_region: table.or("frame", false, |field| {
                word(field, &[("image", false), ("region", true)], "use \"image\" or \"region\"")
            })?,
            priority: table.or("priority", 0, read_priority)?,
            objects: table.or("objects", None, |field| read_objects(field).map(Some))?,
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

/// Widest strip, px.
const FEATHER_MAX: f64 = 65536.0;

fn read_feather(field: &reader::Field, region: &Region) -> Result<f64> {
    let wrong = format_args!("px; a strip is 0 to {FEATHER_MAX} px wide");
    let width = number_if(field, |width| (0.0..=FEATHER_MAX).contains(&width), wrong)?;
    match region {
        Region::Whole => Err(field.error("colours are blended along the border of a region; give the camera one")),
        _ => Ok(width),
    }
}

fn read_objects(field: &reader::Field) -> Result<Vec<String>> {
    let names = field.items("a list of names of objects, as [\"cup\", \"plate*\"]")?;
    names.map(|item| Ok(item.text()?.to_owned())).collect()
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
        let (notes, unfulfilled) = (of_each(|camera| &camera.notes), of_each(|camera| &camera.unfulfilled));
        let mut notes = Notes::from(notes);
        if let Some(k) = cameras.iter().position(|camera| camera.layered().is_some()) {
            return Err(Error::input(format!(
                "{}.kind: a composite with master or feather has frames of its own; use one without these",
                key(k)
            )));
        }
        if let Some(master) = self.master {
            let members = self.by_themselves(&cameras, (width, height))?;
            return Ok(Built { notes, unfulfilled, ..self.layered(master, members, (width, height))? });
        }
        let (is_curved, t_range) = (cameras.iter().any(Camera::is_curved), common_range(&cameras)?);
        let parts = self.parts(cameras, (width, height), t_range.is_none());
        notes.extend(self.hidden(&parts, (width, height)));
        let built = Built::new((width, height), rays(width, height, parts.clone(), is_curved)?);
        let built = Built { t_range: Some(t_range.unwrap_or([0.0, 1.0])), notes, unfulfilled, ..built };
        let members = self.beyond_regions(&parts, (width, height), &built)?;
        Ok(Built { composition: self.composition(members, (width, height)), ..built })
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

    /// A member of the composition, with the camera that its frame is taken by.
    fn shown(&self, k: usize, camera: Camera) -> Shown {
        let Member { region, feather, priority, objects, .. } = &self.members[k];
        let (region, objects) = (region.clone(), objects.clone());
        Shown { camera: Arc::new(camera), region, feather: *feather, priority: *priority, objects }
    }

    fn composition(&self, members: Vec<Shown>, size: (u32, u32)) -> Option<Arc<Composition>> {
        Some(Arc::new(Composition::new(members, self.order(), self.master, size)))
    }

    /// The cameras by themselves, each with rays all over the image.
    fn by_themselves(&self, cameras: &[Camera], (width, height): (u32, u32)) -> Result<Vec<Shown>> {
        let shown = |(k, camera): (usize, &Camera)| {
            let Some(frame) = self.members[k].frame() else { return Ok(self.shown(k, camera.clone())) };
            let part = Part { region: Region::Whole, frame: Some(frame), camera: camera.clone(), span: None };
            let size = DVec2::new(width.into(), height.into());
            let parts = Parts { size, degree: camera.layers[0].degree(), parts: vec![part] };
            let rays = rays(width, height, parts, camera.is_curved()).map_err(|e| error_of(k, e))?;
            Ok(self.shown(k, Camera::of(camera.kind, (width, height), camera.t_range, rays)))
        };
        cameras.iter().enumerate().map(shown).collect()
    }

    /// The cameras with the rays of the composite, beyond their regions too; without rays if no frame is taken by one alone.
    fn beyond_regions(&self, parts: &Parts, (width, height): (u32, u32), built: &Built) -> Result<Vec<Shown>> {
        let is_feathered = self.members.iter().any(|member| member.feather > 0.0);
        let is_curved = matches!(built.layers[..], [Rays::Curves(_)]);
        let shown = |(k, number): (usize, usize)| {
            let part = Part { region: Region::Whole, ..parts.parts[k].clone() };
            let (kind, t_range) = (part.camera.kind, built.t_range.unwrap_or([0.0, 1.0]));
            if !is_feathered {
                return Ok((number, self.shown(number, Camera { layers: Vec::new(), ..part.camera })));
            }
            let parts = Parts { size: parts.size, degree: parts.degree, parts: vec![part] };
            let rays = rays(width, height, parts, is_curved).map_err(|e| error_of(number, e))?;
            Ok((number, self.shown(number, Camera::of(kind, (width, height), t_range, rays))))
        };
        let mut members: Vec<(usize, Shown)> =
            self.order().into_iter().enumerate().map(shown).collect::<Result<_>>()?;
        members.sort_by_key(|(number, _)| *number);
        Ok(members.into_iter().map(|(_, member)| member).collect())
    }

    /// A camera with the rays of its master, whose frames are composed of those of all.
    fn layered(&self, master: usize, members: Vec<Shown>, size: (u32, u32)) -> Result<Built> {
        let camera = members[master].camera.clone();
        if camera.is_curved() {
            return Err(Error::input(format!(
                "camera.master: camera {master} has curved rays; depth is along straight ones: choose another camera"
            )));
        }
        let built = Built::of_layers(size, camera.layers.clone());
        Ok(Built { t_range: Some(camera.t_range), composition: self.composition(members, size), ..built })
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
        let parts: Vec<Part> = self.order().into_iter().map(part).collect();
        let degree = parts.iter().map(|part| part.camera.layers[0].degree()).max().unwrap_or(1);
        Parts { size: DVec2::new(width.into(), height.into()), parts, degree }
    }

    /// Notes on cameras that show at no pixel's centre.
    fn hidden(&self, parts: &Parts, (width, height): (u32, u32)) -> Vec<String> {
        let of_row = |j: u32| -> BTreeSet<usize> {
            (0..width).filter_map(|i| parts.owner(DVec2::new(i.into(), j.into()) + 0.5)).collect()
        };
        let shown: BTreeSet<usize> = parallel::map(0..height, of_row).into_iter().flatten().collect();
        let order = self.order().into_iter().enumerate();
        let mut hidden: Vec<usize> = order.filter(|(place, _)| !shown.contains(place)).map(|(_, k)| k).collect();
        hidden.sort_unstable();
        let note = |k: usize| {
            format!("camera {k} shows nowhere: its region holds no pixel's centre, or others come before it")
        };
        hidden.into_iter().map(note).collect()
    }
}

fn rays(width: u32, height: u32, parts: Parts, is_curved: bool) -> Result<Rays> {
    Ok(match is_curved {
        true => {
            let curves = Curves::of_map((width, height), Arc::new(parts));
            let none = || Error::input("camera: no pixel has a ray; make the regions larger");
            Rays::Curves(curves.ok_or_else(none)?)
        }
        false => Rays::Field(Field::of_map(width, height, Arc::new(parts))?),
    })
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
