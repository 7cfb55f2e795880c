//! `[caustics]`: a light before a mirror or a lens, and the planes on which its caustics fall.

use crate::camera::kinds::read_camera;
use crate::camera::spec::CameraSpec;
use crate::input::Result;
use crate::input::reader::Field;
use crate::scene::caustics::{Method, Receiver};

/// Caustics as written, checked value by value.
#[derive(Debug, Clone, PartialEq)]
pub struct CausticsSpec {
    /// A `reflection` or `refraction` whose eye, a `pinhole` or `orthographic`, is the light.
    pub light: CameraSpec,
    /// Columns and rows of the photon-location map.
    pub map: [u32; 2],
    pub flux: f64,
    pub method: Method,
    /// At least one.
    pub receivers: Vec<Receiver>,
}

/// Hou et al., figure 11.
const MAP: [u32; 2] = [512; 2];
/// Photons a side at most: two beams a cell, 48 bytes each.
const MAP_MAX: u64 = 2048;
const TEXELS: [u32; 2] = [256; 2];
/// Texels a side at most: 24 bytes each.
const TEXELS_MAX: u64 = 4096;
const RECEIVERS_MAX: usize = 64;

pub(crate) fn read_caustics(field: &Field) -> Result<CausticsSpec> {
    let table = field.table()?;
    table.allow(&["light", "map", "flux", "method", "receivers"])?;
    let example = "{ kind = \"reflection\", eye = { kind = \"pinhole\", ... }, mirror = { ... } }";
    let light = table.need("light", example)?;
    let own = light.table()?;
    one_of(&own.need("kind", "\"reflection\"")?, ["reflection", "refraction"])?;
    let eye =
        own.need("eye", "{ kind = \"pinhole\", eye = [0, 5, 0], target = [0, 0, 0], up = [0, 0, 1], vfov = 40 }")?;
    one_of(&eye.table()?.need("kind", "\"pinhole\"")?, ["pinhole", "orthographic"])?;
    let key = table.need("receivers", "[{ origin = [-1, 0, 1], u = [2, 0, 0], v = [0, 0, -2] }]")?;
    let receivers = key.items("receivers, each a table of origin, u and v")?;
    let receivers = receivers.map(|r| read_receiver(&r)).collect::<Result<Vec<Receiver>>>()?;
    if receivers.is_empty() || receivers.len() > RECEIVERS_MAX {
        let n = receivers.len();
        return Err(key.error(format_args!("{n} receivers; there may be 1 to {RECEIVERS_MAX}")));
    }
    let methods = [("flux", Method::Flux), ("solid_angle", Method::SolidAngle)];
    Ok(CausticsSpec {
        light: read_camera(&light)?,
        map: table.or("map", MAP, |f| read_sides(f, MAP_MAX))?,
        flux: table.or("flux", 1.0, |f| f.number_if(|flux| flux > 0.0, "is no flux; give a number above 0"))?,
        method: table.or("method", Method::Flux, |f| f.choice(methods))?,
        receivers,
    })
}

fn one_of(kind: &Field, known: [&str; 2]) -> Result<()> {
    let [a, b] = known;
    match kind.text()? {
        text if known.contains(&text) => Ok(()),
        text => Err(kind.error(format_args!("{text:?} cannot be a light here; use {a:?} or {b:?}"))),
    }
}

fn read_receiver(field: &Field) -> Result<Receiver> {
    let table = field.table()?;
    table.allow(&["origin", "u", "v", "texels"])?;
    let vector = |key, example| table.need(key, example)?.vec3();
    Ok(Receiver {
        origin: vector("origin", "[-1, 0, 1]")?,
        u: vector("u", "[2, 0, 0]")?,
        v: vector("v", "[0, 0, -2]")?,
        texels: table.or("texels", TEXELS, |f| read_sides(f, TEXELS_MAX))?,
    })
}

fn read_sides(field: &Field, most: u64) -> Result<[u32; 2]> {
    let [a, b] = field.array::<2>("two whole numbers, as [256, 256]")?;
    Ok([a.integer(1, most)? as u32, b.integer(1, most)? as u32])
}
