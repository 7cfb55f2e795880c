//! Parsing of option values, on the command line and in lists of jobs.

use super::batch::Shard;
use crate::engine::Method;
use crate::engine::rival::{self, EngineName};
use crate::image::cryptomatte::MatteKind;
use crate::image::frame::Channel;
use crate::image::size::check_size;
use crate::scene::gradients::Asked;
use std::path::PathBuf;

/// The channels that a name selects.
#[derive(Debug, Clone)]
pub enum Named {
    Channels(Vec<Channel>),
    /// All channels of the scene and the camera.
    All,
    Matte(MatteKind),
    /// Motion to the next frame.
    Motion,
}

/// Gradients to compute, and where their files go.
#[derive(Debug, Clone)]
pub struct Gradients {
    pub asked: Asked,
    pub folder: PathBuf,
}

/// `800x600`: width and height.
pub fn size(text: &str) -> Result<(u32, u32), String> {
    let sides = text.split_once(['x', 'X']).and_then(|(w, h)| Some((w.parse().ok()?, h.parse().ok()?)));
    let (width, height): (u64, u64) = sides.ok_or("write it as WIDTHxHEIGHT, for example 800x600")?;
    check_size(width, height).map_err(|e| e.to_string())?;
    // both sides are far under 2^32 by the check above
    Ok((width as u32, height as u32))
}

/// A frame of keyframed values.
#[cfg(feature = "cli")]
pub fn frame(text: &str) -> Result<f64, String> {
    let frame = text.parse().ok().filter(|f: &f64| f.is_finite());
    frame.ok_or_else(|| "write a finite number, for example 12 or 12.5".into())
}

/// `1/4`: the first of four parts.
pub fn shard(text: &str) -> Result<Shard, String> {
    let numbers = text.split_once('/').and_then(|(i, n)| Some((i.parse::<u32>().ok()?, n.parse::<u32>().ok()?)));
    match numbers {
        Some((i, n)) if 1 <= i && i <= n => Ok(Shard { index: i - 1, count: n }),
        _ => Err("write it as I/N with I from 1 to N, for example 1/4".into()),
    }
}

/// A name of one or several channels.
pub fn channels(name: &str) -> Result<Named, String> {
    match name.trim() {
        "all" => return Ok(Named::All),
        "crypto.object" => return Ok(Named::Matte(MatteKind::Objects)),
        "crypto.material" => return Ok(Named::Matte(MatteKind::Materials)),
        "motion" => return Ok(Named::Motion),
        _ => {}
    }
    let found = Channel::named(name.trim());
    if found.is_empty() {
        let known: Vec<&str> = Channel::every().map(Channel::name).collect();
        let more =
            "N, P, albedo and view for three each, uv and motion for two, crypto.object and crypto.material, all";
        let meant = Channel::similar(name.trim()).map_or(String::new(), |own| format!("did you mean {own}? "));
        return Err(format!("no such channel; {meant}known: {}, {more}", known.join(", ")));
    }
    Ok(Named::Channels(found))
}

/// compute, reference, or a registered technique.
pub fn engine(name: &str) -> Result<EngineName, String> {
    match name {
        "compute" => Ok(EngineName::Compute),
        "reference" => Ok(EngineName::Reference),
        _ => rival::parse(name, rival::techniques()).map(EngineName::Rival),
    }
}

/// auto, raster or trace.
pub fn method(name: &str) -> Result<Method, String> {
    match name {
        "auto" => Ok(Method::Auto),
        "raster" => Ok(Method::Raster),
        "trace" => Ok(Method::Trace),
        _ => Err("no such method; known: auto, raster, trace".into()),
    }
}

/// 1 to 64 rays per pixel.
pub fn samples(text: &str) -> Result<u32, String> {
    number_from_to(text, 1, SAMPLES_MAX)
}

/// 1 to a million timed frames.
pub fn repeat(text: &str) -> Result<u32, String> {
    number_from_to(text, 1, REPEAT_MAX)
}

/// Most rays per pixel, and most timed frames.
pub const SAMPLES_MAX: u32 = 64;
pub const REPEAT_MAX: u32 = 1_000_000;

fn number_from_to(text: &str, least: u32, most: u32) -> Result<u32, String> {
    let number = text.parse().ok().filter(|n| (least..=most).contains(n));
    number.ok_or_else(|| format!("{text:?} is not a whole number from {least} to {most}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_read_or_refused() {
        assert_eq!(size("800x600"), Ok((800, 600)));
        for wrong in ["800", "x", "0x5", "5x0", "-1x5", "70000x1", "65536x65536", "99999999999999999999x1"] {
            assert!(size(wrong).is_err(), "{wrong}");
        }
        assert_eq!((frame("-3"), frame("0.5")), (Ok(-3.0), Ok(0.5)));
        assert!(["inf", "nan", "one", ""].iter().all(|wrong| frame(wrong).is_err()));
        assert_eq!((samples("64"), repeat("1")), (Ok(64), Ok(1)));
        assert!(["0", "65", "-1", "1.5", ""].iter().all(|wrong| samples(wrong).is_err()));
        assert!(["0/4", "5/4", "1", "a/b"].iter().all(|wrong| shard(wrong).is_err()));
        let of = |name: &str| match channels(name) {
            Ok(Named::Channels(list)) => list,
            other => panic!("{name}: {other:?}"),
        };
        assert_eq!(of("triangle.id"), [Channel::TriangleId]);
        assert_eq!(of(" N"), [Channel::NormalX, Channel::NormalY, Channel::NormalZ]);
        assert!(matches!(channels("crypto.object"), Ok(Named::Matte(MatteKind::Objects))));
        assert!(matches!(channels("all"), Ok(Named::All)));
        assert!(channels("q").is_err_and(|e| e.contains("bary.v") && e.contains("N, P, albedo and view")));
        assert!(engine("rastr").is_err_and(|e| e.contains("use compute or reference")) && engine("reference").is_ok());
    }
}
