//! What a page shows of a frame: colour, or a channel as colours.

use crate::arrays::MapEach;
use crate::camera::{Camera, Rays};
use crate::engine::plan::Wanted;
use crate::geometry::cast::ExactCaster;
use crate::image::frame::{Channel, Frame, NO_ID};
use crate::image::rgb8;
use crate::input::{Error, Result};
use crate::scene::Scene;
use serde::{Deserialize, Serialize};

/// What is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Shown {
    #[default]
    Color,
    /// Distance along the ray.
    Depth,
    Triangle,
    Object,
    Material,
    Piece,
    Normal,
    /// What is proven.
    Certified,
    /// Triangles along each pixel's ray.
    Overdraw,
}

/// What colours of a channel mean.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "scale", rename_all = "snake_case")]
pub enum Legend {
    /// From dark to bright.
    Range { from: f64, to: f64, unit: &'static str },
    /// Names and their colours.
    Names { names: Vec<(String, [u8; 3])> },
}

/// Pixels of 8-bit sRGB, three bytes each.
pub struct Colours {
    pub rgb: Vec<u8>,
    pub legend: Option<Legend>,
}

/// Shares of the depths below and above the scale's ends.
const CLIPPED: f64 = 0.01;
const NOTHING: [u8; 3] = [24, 24, 28];

impl Shown {
    /// The channels that it needs.
    pub fn wanted(self) -> Wanted {
        let channels = match self {
            Shown::Color => Vec::new(),
            Shown::Depth => vec![Channel::Z],
            Shown::Triangle => vec![Channel::TriangleId],
            Shown::Object => vec![Channel::TriangleId, Channel::ObjectId],
            Shown::Material => vec![Channel::TriangleId, Channel::MaterialId],
            Shown::Piece => vec![Channel::PieceId],
            Shown::Normal => vec![Channel::TriangleId, Channel::NormalX, Channel::NormalY, Channel::NormalZ],
            Shown::Certified => vec![Channel::Certified],
            // counted on the CPU
            Shown::Overdraw => vec![Channel::TriangleId],
        };
        Wanted { srgb8: self == Shown::Color, ..Wanted::of(channels) }
    }

    /// The colours of a frame.
    ///
    /// # Errors
    /// [`Error::Input`] for the overdraw of rays that are not straight.
    pub fn colours(self, scene: &Scene, camera: &Camera, frame: &Frame, srgb8: Option<&[u8]>) -> Result<Colours> {
        let ids = |channel| frame.u32(channel).unwrap_or_default();
        let plain = |rgb| Colours { rgb, legend: None };
        Ok(match self {
            Shown::Color => plain(srgb8.map(rgb8).unwrap_or_default()),
            Shown::Depth => depths(frame.f32(Channel::Z).unwrap_or_default()),
            Shown::Triangle => plain(flat(ids(Channel::TriangleId).iter().map(|id| of_id(*id)))),
            Shown::Piece => plain(flat(ids(Channel::PieceId).iter().map(|id| of_id(*id)))),
            Shown::Object => named(ids(Channel::ObjectId), |k| scene.objects.get(k).map(|o| o.name.clone())),
            Shown::Material => {
                named(ids(Channel::MaterialId), |k| scene.mesh.base().materials.get(k).map(|m| m.name.clone()))
            }
            Shown::Normal => {
                let plane = |channel| frame.f32(channel).unwrap_or_default();
                let [x, y, z] = [Channel::NormalX, Channel::NormalY, Channel::NormalZ].map_each(plane);
                let byte = |v: f32| (127.5 + 127.5 * v).round() as u8;
                plain(flat(x.iter().zip(y).zip(z).map(|((x, y), z)| match (x, y, z) {
                    (0.0, 0.0, 0.0) => NOTHING,
                    _ => [byte(*x), byte(*y), byte(*z)],
                })))
            }
            Shown::Certified => {
                let colours = [[196, 60, 48], [220, 180, 60], [52, 140, 80]];
                let names = ["not proven", "proven by the recheck", "proven in f32"];
                let names = names.map_each(String::from).into_iter().zip(colours).collect();
                let rgb = flat(ids(Channel::Certified).iter().map(|k| colours[(*k as usize).min(2)]));
                Colours { rgb, legend: Some(Legend::Names { names }) }
            }
            Shown::Overdraw => overdraw(scene, camera)?,
        })
    }
}

fn flat(colours: impl Iterator<Item = [u8; 3]>) -> Vec<u8> {
    colours.flatten().collect()
}

/// Distances between two quantiles, brighter where nearer.
fn depths(z: &[f32]) -> Colours {
    let mut finite: Vec<f32> = z.iter().copied().filter(|z| z.is_finite()).collect();
    if finite.is_empty() {
        return Colours { rgb: flat(z.iter().map(|_| NOTHING)), legend: None };
    }
    finite.sort_unstable_by(f32::total_cmp);
    let at = |share: f64| f64::from(finite[(share * (finite.len() - 1) as f64).round() as usize]);
    let (from, to) = (at(CLIPPED), at(1.0 - CLIPPED));
    let share = |z: f32| if to > from { (f64::from(z) - from) / (to - from) } else { 0.0 };
    let colour = |z: &f32| if z.is_finite() { viridis(1.0 - share(*z)) } else { NOTHING };
    let legend = Legend::Range { from, to, unit: "world units" };
    Colours { rgb: flat(z.iter().map(colour)), legend: Some(legend) }
}

/// How many triangles each pixel's ray meets, and how often it enters or leaves spheres.
fn overdraw(scene: &Scene, camera: &Camera) -> Result<Colours> {
    let is_plain = camera.layers.len() == 1 && camera.optics.is_none() && !matches!(camera.layers[0], Rays::Curves(_));
    if !is_plain || camera.layered().is_some() {
        return Err(Error::input(
            "depth complexity: needs a camera of one layer of straight rays, without mirrors, lenses or composites by depth; choose another channel",
        ));
    }
    if scene.steps.is_some() {
        return Err(Error::input(
            "depth complexity: needs a scene that stands still while a frame is taken; choose another channel",
        ));
    }
    let (width, height) = (camera.width, camera.height);
    scene.mesh.check_copies(scene.limits)?;
    let caster = ExactCaster::new(scene.mesh.mesh().clone());
    let all: Vec<(u32, u32)> = (0..height).flat_map(|j| (0..width).map(move |i| (i, j))).collect();
    let rays = all.iter().map(|(i, j)| camera.ray(*i, *j).filter(|ray| ray.direction.length_squared() > 0.0));
    let rays: Vec<_> = rays.collect();
    let cast: Vec<_> = rays.iter().flatten().copied().collect();
    let mut counts = caster.each(&cast, |ray| caster.all(ray, camera.t_range).len()).into_iter();
    let counts: Vec<usize> = rays.iter().map(|ray| ray.and_then(|_| counts.next()).unwrap_or(0)).collect();
    let most = counts.iter().copied().max().unwrap_or(0);
    let colour = |n: &usize| if *n == 0 { NOTHING } else { viridis(*n as f64 / most.max(1) as f64) };
    let legend = Legend::Range { from: 0.0, to: most as f64, unit: "surfaces along the ray" };
    Ok(Colours { rgb: flat(counts.iter().map(colour)), legend: Some(legend) })
}

/// Colours of ids, and the names of those that are seen.
fn named(ids: &[u32], name_of: impl Fn(usize) -> Option<String>) -> Colours {
    const NAMES_MAX: usize = 40;
    let mut seen: Vec<u32> = ids.iter().copied().filter(|id| *id != NO_ID).collect();
    seen.sort_unstable();
    seen.dedup();
    let names =
        seen.iter().take(NAMES_MAX).map(|id| (name_of(*id as usize).unwrap_or_else(|| format!("{id}")), of_id(*id)));
    let legend = Some(Legend::Names { names: names.collect() });
    Colours { rgb: flat(ids.iter().map(|id| of_id(*id))), legend }
}

/// Hues a golden ratio apart, so that neighbouring ids differ.
fn of_id(id: u32) -> [u8; 3] {
    if id == NO_ID {
        return NOTHING;
    }
    let hue = (f64::from(id) * 0.618_033_988_749_895).fract() * 6.0;
    let (saturation, value) = (0.45 + 0.1 * f64::from(id / 7 % 4), 0.95 - 0.12 * f64::from(id / 3 % 4));
    let byte = |n: f64| {
        let k = (n + hue) % 6.0;
        (255.0 * (value - value * saturation * k.min(4.0 - k).clamp(0.0, 1.0))).round() as u8
    };
    [byte(5.0), byte(3.0), byte(1.0)]
}

/// A scale that is even to the eye: eighths of matplotlib's viridis, linear between them.
fn viridis(share: f64) -> [u8; 3] {
    const SCALE: [[u8; 3]; 9] = [
        [68, 1, 84],
        [71, 44, 122],
        [59, 81, 139],
        [44, 113, 142],
        [33, 144, 141],
        [39, 173, 129],
        [92, 200, 99],
        [170, 220, 50],
        [253, 231, 37],
    ];
    let at = share.clamp(0.0, 1.0) * (SCALE.len() - 1) as f64;
    let k = (at as usize).min(SCALE.len() - 2);
    let part = at - k as f64;
    [0, 1, 2].map_each(|c| (f64::from(SCALE[k][c]) * (1.0 - part) + f64::from(SCALE[k + 1][c]) * part).round() as u8)
}
