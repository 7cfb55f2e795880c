//! `[[projector_light]]`: pictures that are thrown onto surfaces along the rays of the cameras that took them.

use crate::arrays::MapEach;
use crate::camera::kinds::read_camera;
use crate::camera::project::SEARCH_ROUNDING;
use crate::camera::spec::CameraSpec;
use crate::camera::{Camera, Field as RaysOfPixels, Rays};
use crate::geometry::mesh::Mesh;
use crate::geometry::texture::{Texture, Wrap};
use crate::input::reader::Field;
use crate::input::{Error, Result};
use crate::parallel;
use std::path::PathBuf;
use std::sync::Arc;

/// A picture and how it is thrown, as written: the image not yet opened.
#[derive(Debug, Clone, PartialEq)]
pub struct ProjectorSpec {
    /// Already relative to the working directory.
    pub image: PathBuf,
    /// Compiled for an image as large as the picture.
    pub camera: CameraSpec,
    pub throw: Throw,
}

/// A picture that is thrown onto surfaces.
#[derive(Debug, Clone)]
pub struct ProjectorLight {
    /// With one layer of straight rays, which start at a finite t.
    pub camera: Arc<Camera>,
    /// Clamped at its borders; as large as the camera's image, or else stretched over it.
    pub picture: Texture,
    pub throw: Throw,
}

/// How a picture is thrown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Throw {
    pub mode: Mode,
    /// Of [`Mode::Light`], its factor; of the others the opacity, up to 1.
    pub strength: f64,
    /// Width of the strip along the picture's border over which its share grows from 0 to 1, px.
    pub feather: f64,
    /// Powers of the cosine and of the inverse distance in the weight of a picture among others.
    pub angle_power: f64,
    pub distance_power: f64,
    /// Of [`Mode::Light`]: where it has the picture's colours, with inverse-square falloff, world units; `None`: everywhere.
    pub distance: Option<f64>,
    /// Surfaces hide what is behind them.
    pub occlusion: bool,
}

/// What a picture does to a surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum Mode {
    /// It takes the place of the surface's colour.
    Paint,
    /// It is seen as it is, without the scene's light.
    Show,
    /// It lights the surface.
    Light,
}

impl Mode {
    const ALL: [(Mode, &'static str); 3] = [(Mode::Paint, "paint"), (Mode::Show, "show"), (Mode::Light, "light")];
}

impl Default for Throw {
    fn default() -> Throw {
        Throw {
            mode: Mode::Paint,
            strength: 1.0,
            feather: 0.0,
            angle_power: 1.0,
            distance_power: 1.0,
            distance: None,
            occlusion: true,
        }
    }
}

impl PartialEq for ProjectorLight {
    fn eq(&self, other: &ProjectorLight) -> bool {
        Arc::ptr_eq(&self.camera, &other.camera) && self.picture == other.picture && self.throw == other.throw
    }
}

impl ProjectorLight {
    /// # Errors
    /// [`Error::Input`] if the camera's rays are not straight, or start at no finite t.
    pub fn new(camera: Arc<Camera>, picture: Texture, throw: Throw) -> Result<ProjectorLight> {
        let kind = camera.kind;
        let why = match camera.layers.as_slice() {
            _ if camera.optics.is_some() => "reflects or refracts its rays",
            [Rays::Curves(_)] => "has curved rays",
            [_] if !camera.t_range[0].is_finite() => "has rays without a start: its t_range begins at -inf",
            [_] => {
                let picture = Texture { wrap: [Wrap::Clamp; 2], cutoff: None, ..picture };
                return Ok(ProjectorLight { camera, picture, throw });
            }
            _ => "has rays of several layers",
        };
        Err(Error::input(format!("camera: {kind} {why}; a picture is thrown along straight rays that start somewhere")))
    }

    /// Whether it is one of the scene's lights.
    pub fn is_light(&self) -> bool {
        self.throw.mode == Mode::Light
    }
}

/// Refuses a camera with a ray for each pixel if its rays begin too far away. For every visible point such a camera is searched for the ray
/// through it; a tolerance wider than the scene rules no ray out, and each pixel of the frame takes a search of all rays.
///
/// # Errors
/// [`Error::Input`] with the farthest origin of a ray.
pub(super) fn check_reach(camera: &Camera, mesh: &Mesh) -> Result<()> {
    let [Rays::Field(field)] = camera.layers.as_slice() else { return Ok(()) };
    let Some((lo, hi)) = mesh.bounds() else { return Ok(()) };
    let reach = parallel::reduce(0..field.height, |j| row_reach(field, j), f64::max).unwrap_or(0.0);
    if SEARCH_ROUNDING * reach <= lo.abs().max(hi.abs()).length() {
        return Ok(());
    }
    Err(Error::input(format!(
        "camera: a ray begins {reach:.1e} from the origin, so far that rounding exceeds the size of the scene; let rays begin nearer to it"
    )))
}

/// The distance from the world's origin to the farthest origin of a ray in a row.
fn row_reach(field: &RaysOfPixels, j: u32) -> Option<f64> {
    let reach = |i: u32| field.ray(i, j).map(|(origin, _)| origin.length());
    (0..field.width).filter_map(reach).reduce(f64::max)
}

/// Each is looked up at every pixel.
const PROJECTORS_MAX: usize = 64;

/// Weights are powers up to this one.
const POWER_MAX: f64 = 64.0;

/// Pixels of the widest picture.
const FEATHER_MAX: f64 = 65536.0;

pub(super) fn read_projectors(field: &Field) -> Result<Vec<ProjectorSpec>> {
    let items = field.items("projector lights, each a table [[projector_light]]")?;
    if items.len() > PROJECTORS_MAX {
        return Err(field.error(format_args!("{} projector lights; there may be {PROJECTORS_MAX}", items.len())));
    }
    items.map(|f| read_projector(&f)).collect()
}

const KEYS: [&str; 10] = [
    "image",
    "camera",
    "mode",
    "opacity",
    "strength",
    "feather",
    "angle_power",
    "distance_power",
    "distance",
    "occlusion",
];

pub(super) fn read_projector(field: &Field) -> Result<ProjectorSpec> {
    let table = field.table()?;
    table.allow(&KEYS)?;
    let image = table.need("image", "\"picture.png\"")?.path()?;
    let camera = table.need("camera", "{ kind = \"pinhole\", eye = [0, 2, 5], target = [0, 0, 0], vfov = 40 }")?;
    let mode = table.or("mode", Mode::Paint, read_mode)?;
    let (mine, others) = match mode {
        Mode::Light => (["strength", "distance"].as_slice(), ["opacity", "angle_power", "distance_power"].as_slice()),
        _ => (["opacity", "angle_power", "distance_power"].as_slice(), ["strength", "distance"].as_slice()),
    };
    if let Some(other) = others.iter().find_map(|key| table.get(key)) {
        let name = Mode::ALL.iter().find(|(known, _)| *known == mode).map_or("", |(_, name)| name);
        return Err(other.error(format_args!("mode {name:?} does not use it; it has {}", mine.join(", "))));
    }
    let default = Throw { mode, ..Throw::default() };
    let within = |key, default: f64, most: f64| {
        let limit = if most == f64::from(f32::MAX) { "and above".into() } else { format!("to {most}") };
        let wrong = format_args!("is out of range; use 0 {limit}");
        table.or(key, default, |f| f.number_if(|value| (0.0..=most).contains(&value), wrong))
    };
    Ok(ProjectorSpec {
        image,
        camera: read_camera(&camera)?,
        throw: Throw {
            strength: match mode {
                Mode::Light => within("strength", default.strength, f64::from(f32::MAX))?,
                _ => within("opacity", default.strength, 1.0)?,
            },
            feather: within("feather", default.feather, FEATHER_MAX)?,
            angle_power: within("angle_power", default.angle_power, POWER_MAX)?,
            distance_power: within("distance_power", default.distance_power, POWER_MAX)?,
            distance: table.optional("distance", Field::above_zero)?,
            occlusion: table.or("occlusion", default.occlusion, Field::boolean)?,
            ..default
        },
    })
}

fn read_mode(field: &Field) -> Result<Mode> {
    let text = field.text()?;
    Mode::ALL.into_iter().find(|(_, name)| *name == text).map(|(mode, _)| mode).ok_or_else(|| {
        let known = Mode::ALL.map_each(|(_, name)| format!("{name:?}")).join(", ");
        field.error(format_args!("{text:?} is no mode; use {known}"))
    })
}
