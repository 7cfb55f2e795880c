//! Camera models of NVIDIA's ncore, as JSON: f-theta, whose first pixel has its centre at (0, 0), and OpenCV's two models, whose first pixel
//! has its centre at (0.5, 0.5).

use super::document::{Document, Result, Tree, whole};
use super::{Calibration, Contents, intrinsics, rig};
use crate::camera::calibration::{Coefficients, Model, Projection};
use glam::DVec2;

/// The key that says which model a table has.
const TYPE: &str = "camera_model_type";

fn cameras(root: &Tree) -> impl Iterator<Item = &Tree> {
    let all = std::iter::once(root).chain(root.entries().map(|(_, camera)| camera));
    all.filter(|camera| camera.get(TYPE).is_some())
}

pub fn is_file(document: &Document) -> bool {
    cameras(document.tree()).next().is_some()
}

/// The cameras by their places in the file.
pub fn contents(document: &Document) -> Result<Contents> {
    let all = cameras(document.tree()).enumerate();
    Ok(Contents::of_cameras(all.map(|(n, tree)| (n as u64, camera(tree))).collect()))
}

/// The parameters are in the camera's table, or in a table in it.
const TABLES: [&str; 2] = ["camera_model_parameters", "intrinsics"];

fn camera(tree: &Tree) -> Result<Calibration> {
    let tables: Vec<&Tree> = std::iter::once(tree).chain(TABLES.iter().filter_map(|key| tree.get(key))).collect();
    let of = |key: &str| *tables.iter().find(|table| table.get(key).is_some()).unwrap_or(&tree);
    let size = whole(of("resolution").need_list("resolution")?)?;
    let point = DVec2::from(of("principal_point").need_list::<2>("principal_point")?);
    let list = |key: &str| of(key).get(key).map_or(Ok(Vec::new()), |_| of(key).need_numbers(key));
    let plane = || Ok::<_, String>(DVec2::from(of("focal_length").need_list::<2>("focal_length")?));
    let mut calibration = match tree.need_text(TYPE)? {
        "ftheta" => {
            let projection = projection(of("reference_poly"), &list)?;
            let linear = match &list("linear_cde")?[..] {
                [] => [1.0, 0.0, 0.0],
                [c, d, e] => [*c, *d, *e],
                other => return Err(format!("linear_cde: {} numbers; it has 3", other.len())),
            };
            rig::f_theta(size, point, projection, linear)?
        }
        "opencv-pinhole" => {
            let [mut k, p, s] = [list("radial_coeffs")?, list("tangential_coeffs")?, list("thin_prism_coeffs")?];
            k.resize(6, 0.0);
            let at = |list: &[f64], n: usize| list.get(n).copied().unwrap_or(0.0);
            let all =
                [k[0], k[1], at(&p, 0), at(&p, 1), k[2], k[3], k[4], k[5], at(&s, 0), at(&s, 1), at(&s, 2), at(&s, 3)];
            Calibration::new(intrinsics(size, plane()?, point - 0.5)?, Model::brown(&all))
        }
        "opencv-fisheye" => {
            let k = list("radial_coeffs")?;
            let model = Model { projection: Projection::Equidistant, distortions: vec![Coefficients::radial(&k)] };
            Calibration::new(intrinsics(size, plane()?, point - 0.5)?, model)
        }
        other => {
            return Err(format!("{TYPE}: {other:?} is not known; use ftheta, opencv-pinhole or opencv-fisheye"));
        }
    };
    let has = |key: &str| tables.iter().any(|table| table.get(key).is_some());
    let ignored: Vec<&str> =
        ["external_distortion_parameters", "max_angle", "max_angle_rad"].into_iter().filter(|key| has(key)).collect();
    calibration.note = (!ignored.is_empty()).then(|| format!("{} of the file: not applied", ignored.join(", ")));
    Ok(calibration)
}

/// The reference polynomial; the other one approximates its inverse.
fn projection(table: &Tree, list: &dyn Fn(&str) -> Result<Vec<f64>>) -> Result<Projection> {
    let reference = table.need("reference_poly")?;
    let of = |key: &str| rig::from_first_power(&list(key)?).map_err(|why| format!("{key}: {why}"));
    match (reference.text(), reference.number()) {
        (Some("PIXELDIST_TO_ANGLE"), _) | (_, Some(1.0)) => {
            Ok(Projection::AngleOfRadius { c: of("pixeldist_to_angle_poly")? })
        }
        (Some("ANGLE_TO_PIXELDIST"), _) | (_, Some(2.0)) => {
            Ok(Projection::RadiusOfAngle { c: of("angle_to_pixeldist_poly")? })
        }
        _ => Err("reference_poly must be PIXELDIST_TO_ANGLE (1) or ANGLE_TO_PIXELDIST (2)".into()),
    }
}
