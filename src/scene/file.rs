//! The scene file: TOML or JSON text into typed values, with errors that name file, line and key.

mod header;
mod moments;
#[cfg(feature = "cli")]
mod pictured;
mod style;
#[cfg(test)]
mod tests;

use crate::arrays::MapEach;
use std::path::{Path, PathBuf};

pub use header::CameraKeys;
#[cfg(feature = "cli")]
pub use pictured::load_header;

use crate::camera::exposure::Exposure;
use crate::camera::kinds::{read_camera, read_camera_and_readout};
use crate::camera::spec::CameraSpec;
use crate::geometry::spec::{MeshSpec, read_look, read_mesh, read_radiance, read_spheres};
use crate::geometry::time_steps::TIMES_MAX;
use crate::image::size::{MAX_SIDE, check_size};
use crate::input::load::read_text;
use crate::input::{keyframes, overrides, parse};
use crate::scene::caustics::spec::{CausticsSpec, read_caustics};
use crate::scene::volume::spec::{VolumeSpec, read_volume, read_volume_look};

use super::light::{AmbientOcclusion, Light, Source as LightSource};
use super::poses;
use super::projector_light::{ProjectorSpec, read_projector, read_projectors};
use super::style::Style;
use crate::image::tone::{Curve, Tone};
use crate::input::reader::{Field, Source};
use crate::input::tree::{Node, Place};
use crate::input::{Loading, Result};
use std::sync::Arc;

/// A scene as written: values checked one by one; files not yet opened, except the camera's.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneFile {
    pub image: ImageSpec,
    /// The tables of meshes in file order, then those of spheres; triangle ids follow it.
    pub meshes: Vec<MeshSpec>,
    /// If empty, a headlight shines along each pixel's ray.
    pub lights: Vec<Light>,
    pub projector_lights: Vec<ProjectorSpec>,
    pub ambient_occlusion: Option<AmbientOcclusion>,
    pub style: Style,
    pub sky: Option<SkySpec>,
    pub volume: Option<VolumeSpec>,
    pub camera: CameraSpec,
    /// When the camera's pixels are exposed.
    pub exposure: Exposure,
    /// The scene at all times that a frame takes, if something moves in it; in order.
    pub steps: Vec<FileStep>,
    /// The keys of the camera, as written.
    pub camera_keys: Arc<CameraKeys>,
    pub caustics: Option<CausticsSpec>,
    pub output: OutputSpec,
    /// Folder of the scene file, which relative paths start from.
    pub dir: PathBuf,
}

/// What may move while a frame is taken, at one time.
#[derive(Debug, Clone, PartialEq)]
pub struct FileStep {
    /// Frames after the frame itself.
    pub time: f64,
    pub meshes: Vec<MeshSpec>,
    pub camera: CameraSpec,
}

/// `[image]`. A missing side comes from the command line or from the camera's ray map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ImageSpec {
    /// Pixels, 1 to [`MAX_SIDE`].
    pub width: Option<u32>,
    /// Pixels, 1 to [`MAX_SIDE`].
    pub height: Option<u32>,
    /// Linear RGB in [0, 1].
    pub background: [f32; 3],
    /// `exposure`, stops, and `tone`, a curve by its name.
    pub tone: Tone,
    /// For how many frames the shutter is open at a pixel.
    pub shutter: f64,
    /// Frames a second.
    pub frame_rate: f64,
    /// Into how many steps a frame is divided, in which everything moves straight, besides at keyframes; `None`: as many as it takes.
    pub motion_steps: Option<u32>,
    /// Near and far of the channels of normalised depth, world units.
    pub depth_range: Option<[f64; 2]>,
}

impl Default for ImageSpec {
    fn default() -> ImageSpec {
        ImageSpec {
            width: None,
            height: None,
            background: [0.0; 3],
            tone: Tone::default(),
            shutter: 0.0,
            frame_rate: 1.0,
            motion_steps: None,
            depth_range: None,
        }
    }
}

/// `[environment]`: an image of all directions as a light.
#[derive(Debug, Clone, PartialEq)]
pub struct SkySpec {
    /// Already relative to the working directory.
    pub file: PathBuf,
    /// Factor of its light.
    pub strength: f64,
    /// Rotation about +y, degrees, counter-clockwise seen from above.
    pub rotate: f64,
    /// Whether pixels that hit nothing show it.
    pub is_seen: bool,
}

/// `[output]`: files to write, already relative to the working directory.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct OutputSpec {
    pub color: Option<PathBuf>,
    pub exr: Option<PathBuf>,
}

/// Reads a scene file (.toml or .json). `overrides` are `key=value` texts with dotted keys
/// (`camera.vfov=40`, `mesh.0.scale=2`), applied in order before anything is checked. Then any list whose items are all
/// tables of `frame` and `value` becomes its value at `frame`: linear between two keys, constant before the first and
/// after the last; a value is a number or a list of numbers.
///
/// # Errors
/// [`crate::input::error::Error::Input`], one line, with the file, the line and the key, and what to write instead.
pub fn load(path: &Path, overrides: &[String], frame: f64, loading: &Loading) -> Result<SceneFile> {
    let format = parse::Format::of(path)?;
    read_scene(&read_text(path, loading)?, format, &source(path, loading), overrides, frame)
}

/// Reads the text of a scene file in TOML as if it were that of the file `path`.
///
/// # Errors
/// As [`load`].
pub fn of_text(text: &str, path: &Path, frame: f64, loading: &Loading) -> Result<SceneFile> {
    read_scene(text, parse::Format::Toml, &source(path, loading), &[], frame)
}

/// All values of such a text at a frame, unchecked.
///
/// # Errors
/// [`crate::input::error::Error::Input`] for text that is not TOML, and for wrong keyframes or poses.
#[cfg(feature = "view")]
pub(crate) fn values(text: &str, path: &Path, frame: f64, loading: &Loading) -> Result<Node> {
    let source = source(path, loading);
    let mut root = read_keyed(text, parse::Format::Toml, &source, &[], frame)?;
    keyframes::pick(&mut root, "", &source, frame)?;
    Ok(root)
}

/// The same with the poses of a file as keyframes, and all keyframes as they are.
///
/// # Errors
/// As [`values`].
#[cfg(feature = "view")]
pub(crate) fn expanded(text: &str, path: &Path, loading: &Loading) -> Result<Node> {
    let mut root = parse::parse(text, parse::Format::Toml, path)?;
    poses::expand(&mut root, &source(path, loading))?;
    Ok(root)
}

/// The source of a scene file. Its relative paths start from its folder.
fn source<'a>(path: &'a Path, loading: &'a Loading) -> Source<'a> {
    Source::new(path, path.parent().unwrap_or(Path::new("")), loading)
}

fn read_scene(
    text: &str,
    format: parse::Format,
    source: &Source,
    overrides: &[String],
    frame: f64,
) -> Result<SceneFile> {
    let keyed = read_keyed(text, format, source, overrides, frame)?;
    let mut root = keyed.clone();
    keyframes::pick(&mut root, "", source, frame)?;
    let mut file = read_tree(root, source)?;
    file.steps = moments::steps(&keyed, source, &file, frame)?;
    Ok(file)
}

/// The values of a scene file with overrides and the files of a frame, all keyframes as they are.
fn read_keyed(text: &str, format: parse::Format, source: &Source, overrides: &[String], frame: f64) -> Result<Node> {
    let mut root = parse::parse(text, format, source.path)?;
    overrides::apply(&mut root, overrides)?;
    keyframes::number(&mut root, frame);
    poses::expand(&mut root, source)?;
    Ok(root)
}

/// Parses a table alone, as a program gives it: TOML, or JSON where it begins with a brace.
///
/// # Errors
/// [`crate::input::error::Error::Input`] for text that is neither.
pub(crate) fn parse_table(text: &str) -> Result<Node> {
    let format = if text.trim_start().starts_with('{') { parse::Format::Json } else { parse::Format::Toml };
    Ok(parse::parse(text, format, Path::new(ARGUMENTS))?.placed(Place::Argument))
}

/// The name of a program's table in errors of the parser.
const ARGUMENTS: &str = "arguments";

/// Reads a table that a program gave. Errors name it by `key`; relative paths start from `folder`.
fn read_table<T>(
    table: &Node,
    key: &str,
    (folder, loading): (&Path, &Loading),
    read: impl FnOnce(&Field) -> Result<T>,
) -> Result<T> {
    read(&Field::new(&Source::new(Path::new(ARGUMENTS), folder, loading), key, table))
}

/// The camera of a `[camera]` table.
///
/// # Errors
/// As [`load`].
pub(crate) fn camera_of(table: &Node, folder: &Path, loading: &Loading) -> Result<CameraSpec> {
    read_table(table, "camera", (folder, loading), read_camera)
}

/// The picture of a `[[projector_light]]` table.
///
/// # Errors
/// As [`load`].
pub fn projector_light_of(table: &str, folder: &Path, loading: &Loading) -> Result<ProjectorSpec> {
    read_table(&parse_table(table)?, "projector_light", (folder, loading), read_projector)
}

/// The mesh of a `[[mesh]]` table.
///
/// # Errors
/// As [`load`].
pub fn mesh_of(table: &str, folder: &Path, loading: &Loading) -> Result<MeshSpec> {
    read_table(&parse_table(table)?, "mesh", (folder, loading), |field| read_mesh(field, &[]))
}

/// Where a mesh of arrays is, and what it looks like: a `[[mesh]]` table without a source.
///
/// # Errors
/// As [`load`].
pub fn look_of(table: &str, folder: &Path, loading: &Loading) -> Result<MeshSpec> {
    read_table(&parse_table(table)?, "mesh", (folder, loading), read_look)
}

/// Where a volume of an array is, and what it looks like: a `[volume]` table without a file.
///
/// # Errors
/// As [`load`].
pub fn volume_look_of(table: &str, folder: &Path, loading: &Loading) -> Result<VolumeSpec> {
    read_table(&parse_table(table)?, "volume", (folder, loading), read_volume_look)
}

/// Reads a scene from its tree of values.
fn read_tree(root: Node, source: &Source) -> Result<SceneFile> {
    let Source { path, dir, loading, .. } = *source;
    let [of_camera, of_meshes] = [(); 2].map_each(|()| Source::new(path, dir, loading));
    let file = read_tables(&root, [source, &of_camera, &of_meshes])?;
    let names_files = [&of_camera, &of_meshes].map_each(Source::names_files);
    Ok(SceneFile { camera_keys: Arc::new(CameraKeys::taken(root, names_files, dir)), ..file })
}

/// Reads all tables. The camera and the meshes have sources of their own, which note whether they name files.
fn read_tables<'a>(root: &'a Node, [source, of_camera, of_meshes]: [&'a Source<'a>; 3]) -> Result<SceneFile> {
    let dir = source.dir;
    let table = Field::new(source, "", root).table()?;
    table.allow(&[
        "image",
        "mesh",
        "spheres",
        "light",
        "projector_light",
        "environment",
        "ambient_occlusion",
        "volume",
        "style",
        "camera",
        "caustics",
        "output",
    ])?;
    let image = table.or("image", ImageSpec::default(), read_image)?;
    let Some(camera) = table.get("camera").map(|f| f.of(of_camera)) else {
        return Err(table.error("there is no camera; add a [camera] table with its kind"));
    };
    let (camera, readout) = read_camera_and_readout(&camera, (image.width, image.height), image.frame_rate)?;
    Ok(SceneFile {
        image,
        meshes: {
            let meshes = table.or("mesh", Vec::new(), |f| read_meshes(&f.clone().of(of_meshes)))?;
            let spheres = table.or("spheres", Vec::new(), |f| read_all_spheres(&f.clone().of(of_meshes)))?;
            [meshes, spheres].concat()
        },
        lights: table.or("light", Vec::new(), |f| {
            f.items("lights, each a table [[light]]")?.map(|l| read_light(&l)).collect()
        })?,
        projector_lights: table.or("projector_light", Vec::new(), read_projectors)?,
        ambient_occlusion: table.optional("ambient_occlusion", read_occlusion)?,
        style: table.or("style", Style::default(), style::read_style)?,
        sky: table.optional("environment", read_sky)?,
        volume: table.optional("volume", read_volume)?,
        camera,
        exposure: Exposure { readout, shutter: image.shutter, is_even: false },
        steps: Vec::new(),
        camera_keys: Arc::default(),
        caustics: table.optional("caustics", read_caustics)?,
        output: table.or("output", OutputSpec::default(), read_output)?,
        dir: if dir.as_os_str().is_empty() { PathBuf::from(".") } else { dir.into() },
    })
}

fn read_meshes(field: &Field) -> Result<Vec<MeshSpec>> {
    field.items("meshes, each a table [[mesh]]")?.map(|m| read_mesh(&m, &[])).collect()
}

fn read_all_spheres(field: &Field) -> Result<Vec<MeshSpec>> {
    field.items("spheres, each a table [[spheres]]")?.map(|s| read_spheres(&s)).collect()
}

/// Frames that a shutter may be open, and frames a second.
const SHUTTER_MAX: f64 = 1000.0;
const FRAME_RATE_MAX: f64 = 1e9;

fn read_image(field: &Field) -> Result<ImageSpec> {
    let table = field.table()?;
    table.allow(&[
        "width",
        "height",
        "background",
        "exposure",
        "tone",
        "shutter",
        "frame_rate",
        "motion_steps",
        "depth_range",
    ])?;
    let side = |key| table.optional(key, |f| f.integer(1, MAX_SIDE));
    let (width, height) = (side("width")?, side("height")?);
    if let (Some(width), Some(height)) = (width, height) {
        check_size(width, height).map_err(|e| table.error(e))?;
    }
    // Both sides are at most MAX_SIDE, far under 2^32.
    let narrow = |side: Option<u64>| side.map(|pixels| pixels as u32);
    let background = table.or("background", [0.0; 3], Field::color)?;
    let exposure = table.or("exposure", 0.0, read_exposure)?;
    let curve = table.or("tone", Curve::default(), read_curve)?;
    let within = |key, default: f64, [least, most]: [f64; 2]| {
        let wrong = format_args!("is out of range; use {least} to {most}");
        table.or(key, default, |f| f.number_if(|value| (least..=most).contains(&value), wrong))
    };
    let shutter = within("shutter", 0.0, [0.0, SHUTTER_MAX])?;
    let frame_rate = within("frame_rate", 1.0, [1.0 / FRAME_RATE_MAX, FRAME_RATE_MAX])?;
    let motion_steps = table.optional("motion_steps", |f| f.integer(1, TIMES_MAX as u64 - 1))?;
    Ok(ImageSpec {
        width: narrow(width),
        height: narrow(height),
        background,
        tone: Tone { exposure, curve },
        shutter,
        frame_rate,
        motion_steps: motion_steps.map(|n| n as u32),
        depth_range: table.optional("depth_range", read_depth_range)?,
    })
}

/// Near and far, world units.
fn read_depth_range(field: &Field) -> Result<[f64; 2]> {
    let [near, far] = field.numbers("near and far, as [0.1, 100]")?;
    if 0.0 < near && near < far {
        return Ok([near, far]);
    }
    Err(field.error(format_args!("[{near}, {far}] is no range; near must be above 0, and far above near")))
}

/// Stops either way, far within f32.
const EXPOSURE_MAX: f64 = 64.0;

fn read_exposure(field: &Field) -> Result<f64> {
    let wrong = format_args!("stops; use -{EXPOSURE_MAX} to {EXPOSURE_MAX}");
    field.number_if(|stops| stops.abs() <= EXPOSURE_MAX, wrong)
}

fn read_curve(field: &Field) -> Result<Curve> {
    let text = field.text()?;
    Curve::ALL.into_iter().find(|c| c.name() == text).ok_or_else(|| {
        let known = Curve::ALL.map_each(|c| format!("{:?}", c.name())).join(", ");
        field.error(format_args!("{text:?} is no tone curve; known: {known}"))
    })
}

fn read_light(field: &Field) -> Result<Light> {
    let table = field.table()?;
    table.allow(&["direction", "position", "distance", "color", "shadows"])?;
    let source = match (table.get("direction"), table.get("position")) {
        (Some(_), Some(position)) => {
            return Err(position.error("a light has either a direction or a position; remove one of the two"));
        }
        (None, Some(position)) => {
            LightSource::Point { position: position.vec3()?, distance: table.or("distance", 1.0, Field::above_zero)? }
        }
        _ => {
            let key = table.need("direction", "[-1, -2, -1]")?;
            let direction = key.vec3()?;
            if let Some(distance) = table.get("distance") {
                return Err(distance.error("light from far away is the same at all distances; give a position too"));
            }
            LightSource::Distant(
                direction
                    .try_normalize()
                    .ok_or_else(|| key.error("the direction is zero; give the way the light travels"))?,
            )
        }
    };
    Ok(Light {
        source,
        colour: table.or("color", [1.0; 3], read_radiance)?,
        casts_shadows: table.or("shadows", false, Field::boolean)?,
    })
}

/// Software drivers end a kernel's loops after 65535 rounds, of which a ray through a large hierarchy takes some hundreds.
const OCCLUSION_RAYS_MAX: u64 = 128;

fn read_occlusion(field: &Field) -> Result<AmbientOcclusion> {
    let table = field.table()?;
    table.allow(&["distance", "rays"])?;
    Ok(AmbientOcclusion {
        reach: table.need("distance", "1.0")?.above_zero()?,
        rays: table.optional("rays", |f| f.integer(1, OCCLUSION_RAYS_MAX))?.unwrap_or(32) as u32,
    })
}

fn read_sky(field: &Field) -> Result<SkySpec> {
    let table = field.table()?;
    table.allow(&["file", "strength", "rotate", "background"])?;
    let is_strength = |value| (0.0..=f64::from(f32::MAX)).contains(&value);
    let strength = |f: &Field| f.number_if(is_strength, "is no strength; use 0 and above");
    Ok(SkySpec {
        file: table.need("file", "\"sky.hdr\"")?.path()?,
        strength: table.or("strength", 1.0, strength)?,
        rotate: table.or("rotate", 0.0, Field::number)?,
        is_seen: table.or("background", true, Field::boolean)?,
    })
}

fn read_output(field: &Field) -> Result<OutputSpec> {
    let table = field.table()?;
    table.allow(&["color", "exr"])?;
    Ok(OutputSpec { color: table.optional("color", Field::path)?, exr: table.optional("exr", Field::path)? })
}
