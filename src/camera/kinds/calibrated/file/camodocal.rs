//! camodocal's YAML, which VINS-Fusion and KITTI-360 have: `model_type` MEI, KANNALA_BRANDT, PINHOLE, PINHOLE_FULL or SCARAMUZZA, in
//! either case. The first pixel has its centre at (0, 0).

use super::document::{Document, Result, Tree};
use super::{Calibration, Contents, intrinsics, ocam};
use crate::camera::calibration::{Coefficients, Model, Projection};
use glam::{DMat2, DVec2};

pub fn is_file(document: &Document) -> bool {
    let is_parameters = |(key, value): (&str, &Tree)| key.ends_with("_parameters") && value.is_table();
    document.tree().get("model_type").is_some() && document.tree().entries().any(is_parameters)
}

pub fn contents(document: &Document) -> Result<Contents> {
    Contents::of_one(camera(document.tree()))
}

fn camera(tree: &Tree) -> Result<Calibration> {
    let size = tree.need_size(["image_width", "image_height"])?;
    let of = |table: &'static str| {
        let values = tree.need(table);
        move |keys: &[&str]| -> Result<Vec<f64>> {
            let values = values.clone()?;
            keys.iter().map(|key| values.need_number(key).map_err(|why| format!("{table}: {why}"))).collect()
        }
    };
    let (projection, distortion) = (of("projection_parameters"), of("distortion_parameters"));
    let kind = tree.need_text("model_type")?;
    let (plane, model) = match kind.to_ascii_uppercase().as_str() {
        "MEI" => {
            let xi = of("mirror_parameters")(&["xi"])?[0];
            let bent = Coefficients::of_opencv(&distortion(&["k1", "k2", "p1", "p2"])?);
            let model = Model { projection: Projection::Unified { xi }, distortions: vec![bent] };
            (projection(&["gamma1", "gamma2", "u0", "v0"])?, model)
        }
        // its k2 to k5, of theta^3 to theta^9, are OpenCV's k1 to k4
        "KANNALA_BRANDT" => {
            let model = Model::fisheye(&projection(&["k2", "k3", "k4", "k5"])?);
            (projection(&["mu", "mv", "u0", "v0"])?, model)
        }
        "PINHOLE" => (projection(&["fx", "fy", "cx", "cy"])?, Model::brown(&distortion(&["k1", "k2", "p1", "p2"])?)),
        "PINHOLE_FULL" => {
            let k = distortion(&["k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"])?;
            (projection(&["fx", "fy", "cx", "cy"])?, Model::brown(&k))
        }
        "SCARAMUZZA" => {
            let heights = of("poly_parameters")(&["p0", "p1", "p2", "p3", "p4"])?;
            let affine = of("affine_parameters")(&["ac", "ad", "ae", "cx", "cy"])?;
            let scale = DMat2::from_cols(DVec2::new(affine[0], affine[2]), DVec2::new(affine[1], 1.0));
            return ocam::camera(size, scale, DVec2::new(affine[3], affine[4]), &heights);
        }
        _ => {
            return Err(format!(
                "model_type: {kind:?} is not known; use MEI, KANNALA_BRANDT, PINHOLE, PINHOLE_FULL or SCARAMUZZA"
            ));
        }
    };
    let intrinsics = intrinsics(size, DVec2::new(plane[0], plane[1]), DVec2::new(plane[2], plane[3]))?;
    Ok(Calibration::new(intrinsics, model))
}
