//! f-theta cameras of the rig files of NVIDIA's DRIVE (`rig.json`). Their pixels are OpenCV's: the first has its centre at (0, 0).

use super::{Calibration, Which, intrinsics};
use crate::arrays::MapEach;
use crate::camera::calibration::{Intrinsics, Model, Projection};
use glam::{DMat2, DVec2};
use serde_json::{Map, Value};

type Result<T> = std::result::Result<T, String>;

/// JSON that names `rig` and `sensors`.
pub fn is_rig(text: &str) -> bool {
    let start = text.trim_start_matches('\u{feff}').trim_start();
    start.starts_with('{') && text.contains("\"rig\"") && text.contains("\"sensors\"")
}

/// A camera of `rig.sensors`: its `properties`.
pub fn parse(text: &str, which: Which) -> Result<Calibration> {
    let rig: Value = serde_json::from_str(text).map_err(|e| format!("not a rig of DRIVE: {e}"))?;
    let sensors = rig["rig"]["sensors"].as_array().ok_or("not a rig of DRIVE: rig.sensors is no list")?;
    let properties = |sensor: &Value| sensor["properties"].as_object().cloned();
    let is_f_theta = |p: &Map<String, Value>| p.get("Model").and_then(Value::as_str) == Some("ftheta");
    let cameras = sensors.iter().enumerate().filter_map(|(n, sensor)| Some((n as u64, properties(sensor)?)));
    let camera = which.of(cameras.filter(|(_, p)| is_f_theta(p)).collect())?;
    let number = |key: &str| number(&camera, key)?.ok_or(format!("properties: {key} is missing"));
    let or = |key: &str, default: f64| Ok::<_, String>(self::number(&camera, key)?.unwrap_or(default));
    let size = [number("width")?, number("height")?];
    if size.iter().any(|s| s.fract() != 0.0 || *s < 0.0) {
        return Err(format!("properties: width {} and height {} must be whole numbers", size[0], size[1]));
    }
    let centre = DVec2::new(number("cx")?, number("cy")?);
    let projection = projection(&camera)?;
    // (u, v) - (cx, cy) = [c d; e 1] (x, y)
    let scale = DMat2::from_cols_array(&[or("linear-c", 1.0)?, or("linear-e", 0.0)?, or("linear-d", 0.0)?, 1.0]);
    let determinant = scale.determinant();
    if determinant.is_nan() || determinant <= 0.0 {
        return Err(format!("properties: linear-c, linear-d, linear-e: c - d e = {determinant}; it must be over 0"));
    }
    let intrinsics = Intrinsics { scale, ..intrinsics(size.map_each(|s| s as u64), DVec2::ONE, centre)? };
    Ok(Calibration { intrinsics, model: Model { projection, distortions: Vec::new() }, placed: None, note: None })
}

/// A number, or one as text; both occur.
fn number(camera: &Map<String, Value>, key: &str) -> Result<Option<f64>> {
    let Some(value) = camera.get(key) else { return Ok(None) };
    let number = value.as_f64().or_else(|| value.as_str()?.trim().parse().ok()).filter(|x: &f64| x.is_finite());
    number.map(Some).ok_or(format!("properties: {key} must be a finite number"))
}

/// Most terms of a polynomial; DRIVE's have 4 to 6.
const TERMS: usize = 16;

/// `polynomial` of a `polynomial-type`, or the older `bw-poly`, from pixels to angles.
fn projection(camera: &Map<String, Value>) -> Result<Projection> {
    let text = |key: &str| camera.get(key).and_then(Value::as_str);
    let (listed, kind) = match (text("polynomial"), text("bw-poly")) {
        (Some(listed), _) => (listed, text("polynomial-type").unwrap_or("pixeldistance-to-angle")),
        (None, Some(listed)) => (listed, "pixeldistance-to-angle"),
        (None, None) => return Err("properties: polynomial (or bw-poly) is missing".into()),
    };
    let read = |word: &str| word.parse().map_err(|_| format!("properties: polynomial: {word:?} is not a number"));
    let c = listed.split_ascii_whitespace().map(read).collect::<Result<Vec<f64>>>()?;
    if c.first() != Some(&0.0) {
        return Err("properties: polynomial: its first number must be 0, as the middle is seen at angle 0".into());
    }
    let c = c[1..].to_vec();
    if c.len() > TERMS {
        return Err(format!("properties: polynomial: of degree {}; at most {TERMS} is possible", c.len()));
    }
    match kind {
        "pixeldistance-to-angle" => Ok(Projection::AngleOfRadius { c }),
        "angle-to-pixeldistance" => Ok(Projection::RadiusOfAngle { c }),
        other => Err(format!(
            "properties: polynomial-type: {other:?} is not known; use pixeldistance-to-angle or angle-to-pixeldistance"
        )),
    }
}
