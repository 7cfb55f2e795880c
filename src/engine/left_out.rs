//! Things that a frame does without, for reports and notes.

use crate::camera::notes::Notes;
use crate::geometry::mesh::Missing;
use crate::image::frame::Channel;
use serde::{Serialize, Serializer};
use std::borrow::Cow;
use std::fmt;

/// Something that a frame does without: a part of the engine that a scene, its camera and its outputs do not need, or that the adapter does
/// not have; or a part of the scene that is not shown.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum LeftOut {
    RayTable,
    EdgeConics {
        is_curved: bool,
    },
    Recheck,
    Curves,
    Certify,
    Slabs,
    RayResiduals,
    BoundsPerCell,
    Bounces,
    Meet,
    Bands,
    Channels(Vec<Channel>),
    Spheres,
    SmoothNormals,
    Textures {
        has_images: bool,
    },
    VertexColors,
    AlphaMasks,
    Sky,
    Shadows,
    Pictures,
    SurfaceStyles,
    Outline,
    Gloss,
    Samples,
    Areas,
    Write,
    Volume {
        has_volume: bool,
    },
    TimeSteps,
    FragmentCounters,
    AdapterF64 {
        failed_test: bool,
    },
    SecondDepthDispatch,
    /// Notes of the camera.
    Rays(Notes),
    /// Triangles without area, by their number.
    Triangles(usize),
    /// `[style]`, by the reference.
    Style,
    /// One frame for the images of several cameras, and why not.
    OneFrame(&'static str),
    Missing(Missing),
    /// A part of the engine for things that no ray of the image meets.
    NotInView(&'static str),
    /// Lights that send out nothing, by their number.
    BlackLights(usize),
    /// Number of lamps below the ground, or behind another side of the box around the scene that triangles fill.
    HiddenLights(usize),
    /// Number of projector lights that illuminate nothing in view.
    IdleProjectorLights(usize),
}

impl LeftOut {
    /// What it is, and why it is left out.
    fn texts(&self) -> [Cow<'_, str>; 2] {
        let [what, why] = match self {
            LeftOut::RayTable => ["per-pixel ray table", "every ray follows from its piece"],
            LeftOut::EdgeConics { is_curved: false } => ["edge conics", "the camera is a ray field"],
            LeftOut::EdgeConics { is_curved: true } => ["edge conics", "the camera's rays are curved"],
            LeftOut::Recheck => ["recheck", "where a curve meets a triangle is found in f64 at once"],
            LeftOut::Curves => ["curves", "every ray is straight"],
            LeftOut::Certify => ["certify", "not asked what is proven"],
            LeftOut::Slabs => ["slabs", "the camera has one layer of straight rays"],
            LeftOut::RayResiduals => ["ray residuals", "every node holds one affine piece"],
            LeftOut::BoundsPerCell => ["separate bounds per cell", "no rays jump inside a tile"],
            LeftOut::Bounces => ["bounce, fit and meet", "the camera has no mirror or lens"],
            LeftOut::Meet => ["meet", "the mirror or lens is made of triangles"],
            LeftOut::Bands => ["bands", "the whole image fits the adapter's bindings"],
            LeftOut::Channels(absent) => {
                let names: Vec<&str> = absent.iter().map(|channel| channel.name()).collect();
                return ["channels".into(), format!("not asked for: {}", names.join(", ")).into()];
            }
            LeftOut::Spheres => ["spheres", "the scene has none"],
            LeftOut::SmoothNormals => ["smooth normals", "the scene has none"],
            LeftOut::Textures { has_images: false } => ["textures", "no image lies on the scene's triangles"],
            LeftOut::Textures { has_images: true } => ["textures", "no colour asked for"],
            LeftOut::VertexColors => ["vertex colours", "no colour asked for"],
            LeftOut::AlphaMasks => ["alpha masks", "no material has one"],
            LeftOut::Sky => ["sky", "no image lights the scene from all around"],
            LeftOut::Shadows => ["shadows", "no light casts shadows"],
            LeftOut::Pictures => ["pictures", "no projector light throws one onto surfaces"],
            LeftOut::SurfaceStyles => ["styles", "no patterns, wires or strokes are drawn on surfaces"],
            LeftOut::Outline => ["outline", "no lines are drawn between pixels"],
            LeftOut::Gloss => ["gloss", "all materials are matte"],
            LeftOut::Samples => ["edges, sample and resolve", "one sample a pixel"],
            LeftOut::Areas => ["areas of triangles in pixels", "samples are counted"],
            LeftOut::Write => ["write", "no 8-bit picture asked for"],
            LeftOut::Volume { has_volume: false } => ["volume", "the scene has none"],
            LeftOut::Volume { has_volume: true } => ["volume", "no colour and no coverage asked for"],
            LeftOut::TimeSteps => ["time steps", "nothing moves while the frame is taken"],
            LeftOut::FragmentCounters => ["fragment counters", "no report asked for"],
            LeftOut::AdapterF64 { failed_test: true } => {
                ["the adapter's f64", "it failed a test: f64 is done in 32-bit words"]
            }
            LeftOut::AdapterF64 { failed_test: false } => {
                ["the adapter's f64", "it has none, or no 64-bit integers: f64 is done in 32-bit words"]
            }
            LeftOut::SecondDepthDispatch => ["second depth dispatch", "the adapter has 64-bit atomics"],
            LeftOut::Rays(notes) => return ["rays".into(), notes.join("; ").into()],
            LeftOut::Triangles(count) => return [format!("{count} triangles").into(), "they have no area".into()],
            LeftOut::Style => ["style", "the reference draws no wireframe, outline, borders or hatching"],
            LeftOut::OneFrame(why) => ["one frame for all images", why],
            LeftOut::Missing(missing) => [&*missing.what, &*missing.why],
            LeftOut::NotInView(part) => [part, "not in view"],
            LeftOut::IdleProjectorLights(1) => ["1 projector light", "lights nothing in view"],
            LeftOut::IdleProjectorLights(count) => {
                return [format!("{count} projector lights").into(), "light nothing in view".into()];
            }
            LeftOut::HiddenLights(1) => ["1 light", "lights nothing in view"],
            LeftOut::HiddenLights(count) => return [format!("{count} lights").into(), "light nothing in view".into()],
            LeftOut::BlackLights(1) => ["1 light", "black"],
            LeftOut::BlackLights(count) => return [format!("{count} lights").into(), "black".into()],
        };
        [what.into(), why.into()]
    }
}

impl LeftOut {
    /// The notes of a camera: a row each, and one for those that are worked out only when a report or the user reads them.
    pub fn of_rays(notes: &Notes) -> Vec<LeftOut> {
        match notes {
            Notes::Known(lines) => lines.iter().map(|line| LeftOut::Rays(vec![line.clone()].into())).collect(),
            Notes::Later(_) => vec![LeftOut::Rays(notes.clone())],
        }
    }
}

/// A line for the user.
impl fmt::Display for LeftOut {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let [what, why] = self.texts();
        write!(f, "[{what}] is left out: {why}")
    }
}

impl Serialize for LeftOut {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        #[derive(Serialize)]
        #[serde(rename = "LeftOut")]
        struct Texts<'a> {
            what: &'a str,
            why: &'a str,
        }
        let [what, why] = &self.texts();
        Texts { what, why }.serialize(serializer)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reports_and_notes_have_the_same_texts() {
        let style = LeftOut::Style;
        let why = "the reference draws no wireframe, outline, borders or hatching";
        assert_eq!(serde_json::to_string(&style).unwrap(), format!(r#"{{"what":"style","why":"{why}"}}"#));
        assert_eq!(style.to_string(), format!("[style] is left out: {why}"));
        let channels = LeftOut::Channels(vec![Channel::R, Channel::Z]);
        assert_eq!(channels.to_string(), "[channels] is left out: not asked for: R, Z");
    }
}
