//! The output files of a render: their paths, checks and contents.

use super::job::RenderJob;
use super::outputs::Kind;
use super::{outputs, points};
use crate::camera::Camera;
use crate::camera::describe::Description;
use crate::camera::recipe::SceneUse;
use crate::engine::Rendered;
use crate::engine::report::Report;
use crate::image::cryptomatte::{Matte, OPTICS};
use crate::image::frame::Channel;
use crate::image::{Attributes, rgb8, write_exr_with, write_png, write_text};
use crate::input::files::Inputs;
use crate::input::{Error, Result};
use crate::scene::Scene;
use crate::scene::hash::{SCENE_HASH, scene_hash};
use crate::scene::matrices::{world_to_camera, world_to_ndc};
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

impl RenderJob {
    /// Completes the outputs by those that the scene names, after all checks. `inputs` are the files that the scene was read from.
    ///
    /// # Errors
    /// [`Error::Input`] if the render has no output, or a file must not be replaced; [`Error::Write`] if a file cannot be written.
    pub fn take_outputs(&mut self, scene: &Scene, inputs: &Inputs) -> Result<()> {
        let own = |asked: &Option<PathBuf>, own: &Option<PathBuf>| match (asked, own) {
            (None, Some(own)) if !self.outputs_anywhere => {
                outputs::check_inside(&self.scene, own).map(|()| Some(own.clone()))
            }
            _ => Ok(asked.clone().or_else(|| own.clone())),
        };
        (self.color, self.exr) = (own(&self.color, &scene.output.color)?, own(&self.exr, &scene.output.exr)?);
        let files = self.files();
        if files.is_empty() && !self.check {
            return Err(Error::input(
                "nothing to write; add -o OUT.png, --exr OUT.exr, --points OUT.ply or an [output] table to the scene",
            ));
        }
        // of a file that is there, such as an input, graver things are said below
        if ![&self.color, &self.exr].into_iter().flatten().any(|path| path.is_file()) {
            self.check_names()?;
        }
        if let Some(gradients) = self.gradients() {
            gradients.make_folder()?;
        }
        outputs::check(inputs, files.iter().map(|(path, kind)| (path.as_path(), *kind)))?;
        self.check_names()
    }

    /// Pictures are called what they are.
    fn check_names(&self) -> Result<()> {
        named_as(self.color.as_deref(), "png", "colour is written as PNG; name it .png, or use --exr")?;
        named_as(self.exr.as_deref(), "exr", "this output is written as EXR; name it .exr, or use -o for a PNG")
    }

    /// All files that are written.
    fn files(&self) -> Vec<(PathBuf, Kind)> {
        let all = [
            (&self.color, outputs::PICTURE),
            (&self.exr, outputs::EXR),
            (&self.points, outputs::POINTS),
            (&self.report, outputs::REPORT),
        ];
        let mut files: Vec<_> = all.into_iter().filter_map(|(path, kind)| Some((path.clone()?, kind))).collect();
        if let Some(gradients) = self.gradients() {
            files.extend(gradients.files().into_iter().map(|path| (path, outputs::RAYS)));
            files.push((gradients.list(), outputs::GRADIENTS));
        }
        files
    }

    /// The images' and points' names and a space, for the summary.
    pub fn output_names(&self) -> String {
        let list = self.gradients().map(|own| own.list());
        let named = [&self.color, &self.exr, &self.points, &list];
        let names: Vec<_> = named.into_iter().flatten().map(|p| p.display().to_string()).collect();
        if names.is_empty() { String::new() } else { format!("{} ", names.join(", ")) }
    }

    /// Writes the images, of the channels in `asked`, the mattes and more by their names, and the points.
    pub fn write(
        &self,
        scene: &Scene,
        camera: &Camera,
        rendered: &Rendered,
        asked: &[Channel],
        (mattes, mut more): (Vec<Matte>, Vec<(String, Vec<f32>)>),
    ) -> Result<()> {
        if let (Some(path), Some(rgba)) = (&self.color, &rendered.srgb8) {
            write_png(path, camera.width, camera.height, &rgb8(rgba))?;
        }
        if let Some(path) = &self.exr {
            let mut frame = rendered.frame.clone();
            frame.planes.retain(|(channel, _)| asked.contains(channel));
            let mut attributes = attributes(path, scene, camera, asked)?;
            for matte in mattes {
                let layers = matte.layers()?;
                more.extend(layers.planes);
                attributes.texts.extend(layers.attributes);
            }
            write_exr_with(path, &frame, more, &attributes)?;
        }
        if let Some(path) = &self.points {
            points::write(path, scene, camera, &rendered.frame)?;
        }
        Ok(())
    }
}

/// Refuses the name of another kind of image than is written.
pub fn named_as(path: Option<&Path>, extension: &str, remedy: &str) -> Result<()> {
    let Some(path) = path else { return Ok(()) };
    let is_other = |found: &OsStr| !found.eq_ignore_ascii_case(extension);
    if path.extension().is_some_and(is_other) {
        return Err(Error::input(format!("{}: {remedy}", path.display())));
    }
    Ok(())
}

/// Header attributes of an EXR: the meaning of its channels, and their origin.
pub fn attributes(path: &Path, scene: &Scene, camera: &Camera, channels: &[Channel]) -> Result<Attributes> {
    let texts = [
        ("anamorph.Z", "distance from P to the hit along the ray, world units; +inf where nothing is hit".to_owned()),
        ("anamorph.t", "ray parameter of the hit, X = P + t D; +inf where nothing is hit".into()),
        (CAMERA, described_camera(path, scene, camera)?),
        (SCENE_HASH, format!("{:016x}", scene_hash(scene, camera))),
        ("anamorph.version", env!("CARGO_PKG_VERSION").into()),
    ];
    let depth = scene.depth_range.filter(|_| channels.iter().any(|c| c.is_of_z()));
    let depth = depth.map(|[near, far]| {
        ("anamorph.depth_range".into(), format!("near {near}, far {far}, world units along the ray"))
    });
    let labels = names(scene, camera, channels)?;
    let texts = texts.into_iter().map(|(name, text)| (name.into(), text)).chain(depth).chain(labels).collect();
    Ok(Attributes { texts, world_to_camera: world_to_camera(scene), world_to_ndc: world_to_ndc(scene, camera) })
}

/// The EXR attribute with the camera.
pub const CAMERA: &str = "anamorph.camera";

/// The camera as JSON: what it compiled to, and its keys.
fn described_camera(path: &Path, scene: &Scene, camera: &Camera) -> Result<String> {
    let wrong = |e: serde_json::Error| Error::work(format!("camera as JSON: {e}"));
    let mut described = serde_json::to_value(Description::of(camera)).map_err(wrong)?;
    let folder = path.parent().unwrap_or(Path::new(""));
    if let Some(map) = described.as_object_mut() {
        map.append(&mut scene.camera_keys.json(camera.scene_use != SceneUse::Nothing, folder));
    }
    serde_json::to_string(&described).map_err(wrong)
}

/// Attributes with the names of objects and materials, as JSON lists: number k in `object.id` or `material.id` is name k, from 0.
fn names(scene: &Scene, camera: &Camera, channels: &[Channel]) -> Result<Vec<(String, String)>> {
    let objects = scene.objects.iter().map(|o| o.name.as_str()).collect();
    let materials = scene.mesh.base().materials.iter().map(|m| m.name.as_str()).collect();
    let optics = camera.optics.as_ref().map(|_| OPTICS);
    let list = |mut names: Vec<&str>| {
        names.extend(optics);
        serde_json::to_string(&names).map_err(|e| Error::work(format!("names as JSON: {e}")))
    };
    let named =
        [(Channel::ObjectId, "anamorph.objects", objects), (Channel::MaterialId, "anamorph.materials", materials)];
    let asked = named.into_iter().filter(|(channel, ..)| channels.contains(channel));
    asked.map(|(_, name, names)| Ok((name.into(), list(names)?))).collect()
}

pub fn write_report(path: &Path, report: &Report) -> Result<()> {
    let text = serde_json::to_string_pretty(report).map_err(|e| Error::work(format!("report as JSON: {e}")))?;
    write_text(path, &(text + "\n"))
}
