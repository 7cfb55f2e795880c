//! f-theta cameras of the rig files of NVIDIA's DRIVE (`rig.json`). Their pixels are OpenCV's: the first has its centre at (0, 0).

use super::document::{Document, Result, Tree, whole};
use super::{Calibration, Contents, intrinsics};
use crate::camera::calibration::{Intrinsics, Model, Projection};
use glam::{DMat2, DVec2};

/// JSON with `rig.sensors`.
pub fn is_rig(document: &Document) -> bool {
    document.tree().at(&["rig", "sensors"]).is_some()
}

/// The cameras of `rig.sensors`, by their places there: their `properties`.
pub fn contents(document: &Document) -> Result<Contents> {
    let sensors = document.tree().at(&["rig", "sensors"]).map_or(&[][..], Tree::items);
    let cameras = sensors.iter().enumerate().filter_map(|(n, sensor)| Some((n as u64, sensor.get("properties")?)));
    let cameras = cameras.filter(|(_, p)| p.get("Model").and_then(Tree::text) == Some("ftheta"));
    let read = |p| camera(p).map_err(|why| format!("properties: {why}"));
    Ok(Contents::of_cameras(cameras.map(|(n, p)| (n, read(p))).collect()))
}

fn camera(properties: &Tree) -> Result<Calibration> {
    let size = whole(properties.need_each(["width", "height"])?).map_err(|why| format!("width and height: {why}"))?;
    let [cx, cy] = properties.need_each(["cx", "cy"])?;
    let projection = projection(properties)?;
    let or = |key: &str, default: f64| properties.number_or(key, default);
    let linear = [or("linear-c", 1.0)?, or("linear-d", 0.0)?, or("linear-e", 0.0)?];
    f_theta(size, DVec2::new(cx, cy), projection, linear)
}

/// A camera whose pixels are `(u, v) - centre = [c d; e 1] (x, y)`.
pub fn f_theta(size: [u64; 2], centre: DVec2, projection: Projection, [c, d, e]: [f64; 3]) -> Result<Calibration> {
    let scale = DMat2::from_cols_array(&[c, e, d, 1.0]);
    let determinant = scale.determinant();
    if determinant.is_nan() || determinant <= 0.0 {
        return Err(format!("linear terms c, d, e: c - d e = {determinant}; it must be over 0"));
    }
    let intrinsics = Intrinsics { scale, ..intrinsics(size, DVec2::ONE, centre)? };
    Ok(Calibration::new(intrinsics, Model::plain(projection)))
}

/// Most terms of a polynomial; DRIVE's have 4 to 6.
const TERMS: usize = 16;

/// A polynomial's coefficients from that of the first power on.
///
/// # Errors
/// The constant is not 0, or there are more than [`TERMS`].
pub fn from_first_power(c: &[f64]) -> Result<Vec<f64>> {
    if c.first() != Some(&0.0) {
        return Err("polynomial: its first number must be 0, as the middle is seen at angle 0".into());
    }
    if c.len() > TERMS + 1 {
        return Err(format!("polynomial: of degree {}; at most {TERMS} is possible", c.len() - 1));
    }
    Ok(c[1..].to_vec())
}

/// `polynomial` of a `polynomial-type`, or the older `bw-poly`, from pixels to angles.
fn projection(properties: &Tree) -> Result<Projection> {
    let text = |key: &str| properties.get(key).and_then(Tree::text);
    let (listed, kind) = match (text("polynomial"), text("bw-poly")) {
        (Some(listed), _) => (listed, text("polynomial-type").unwrap_or("pixeldistance-to-angle")),
        (None, Some(listed)) => (listed, "pixeldistance-to-angle"),
        (None, None) => return Err("polynomial (or bw-poly) is missing".into()),
    };
    let read = |word: &str| word.parse().map_err(|_| format!("polynomial: {word:?} is not a number"));
    let c = from_first_power(&listed.split_ascii_whitespace().map(read).collect::<Result<Vec<f64>>>()?)?;
    match kind {
        "pixeldistance-to-angle" => Ok(Projection::AngleOfRadius { c }),
        "angle-to-pixeldistance" => Ok(Projection::RadiusOfAngle { c }),
        other => Err(format!(
            "polynomial-type: {other:?} is not known; use pixeldistance-to-angle or angle-to-pixeldistance"
        )),
    }
}
