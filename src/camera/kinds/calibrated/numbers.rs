//! The numbers of a calibration by name: what a gradient may be of.

use super::FromFile;
use crate::camera::calibration::{Coefficients, Intrinsics, Model, Projection};

/// All names: focal lengths and principal point, px; coefficients of a distortion, as OpenCV counts them for the perspective projection, in the
/// order of powers for all others; and numbers of projections, as in their formulas.
pub(super) const NAMES: [&str; 28] = [
    "fx", "fy", "cx", "cy", "k1", "k2", "k3", "k4", "k5", "k6", "p1", "p2", "s1", "s2", "s3", "s4", "omega", "xi",
    "alpha", "beta", "k", "c1", "c2", "c3", "c4", "c5", "c6", "c7",
];

impl FromFile {
    pub(super) fn number(&mut self, name: &str) -> Option<&mut f64> {
        number(&mut self.intrinsics, &mut self.model, name)
    }
}

/// The numbers of a calibration that are not 0, with their names.
#[cfg(feature = "cli")]
pub fn listed(intrinsics: &Intrinsics, model: &Model) -> Vec<(&'static str, f64)> {
    let (mut intrinsics, mut model) = (intrinsics.clone(), model.clone());
    let mut value = |name| number(&mut intrinsics, &mut model, name).map(|number| (name, *number));
    NAMES.into_iter().filter_map(&mut value).filter(|(_, number)| *number != 0.0).collect()
}

fn number<'a>(intrinsics: &'a mut Intrinsics, model: &'a mut Model, name: &str) -> Option<&'a mut f64> {
    match name {
        "fx" => Some(&mut intrinsics.scale.x_axis.x),
        "fy" => Some(&mut intrinsics.scale.y_axis.y),
        "cx" => Some(&mut intrinsics.centre.x),
        "cy" => Some(&mut intrinsics.centre.y),
        _ => of_model(model, name),
    }
}

fn of_model<'a>(model: &'a mut Model, name: &str) -> Option<&'a mut f64> {
    let is_perspective = model.projection == Projection::Perspective;
    match (&mut model.projection, name) {
        (Projection::FieldOfView { omega }, "omega") => return Some(omega),
        (Projection::Unified { xi } | Projection::DoubleSphere { xi, .. }, "xi") => return Some(xi),
        (Projection::EnhancedUnified { alpha, .. } | Projection::DoubleSphere { alpha, .. }, "alpha") => {
            return Some(alpha);
        }
        (Projection::EnhancedUnified { beta, .. }, "beta") => return Some(beta),
        (Projection::Division { k }, "k") => return Some(k),
        (Projection::AngleOfRadius { c } | Projection::RadiusOfAngle { c } | Projection::HeightOfRadius { c }, _) => {
            if let Some(number) = numbered(name, 'c').and_then(|n| c.get_mut(n)) {
                return Some(number);
            }
        }
        _ => {}
    }
    // the numbers of several distortions would have the same names
    let [distortion] = model.distortions.as_mut_slice() else { return None };
    let Coefficients { radial, below, tangential, prism, .. } = distortion;
    match (numbered(name, 'k'), name) {
        (Some(n @ 3..=5), _) if is_perspective => Some(&mut below[n - 3]),
        (Some(n), _) => radial.get_mut(n),
        (_, "p1") => Some(&mut tangential[0]),
        (_, "p2") => Some(&mut tangential[1]),
        (_, "s1") => Some(&mut prism[0].x),
        (_, "s2") => Some(&mut prism[1].x),
        (_, "s3") => Some(&mut prism[0].y),
        (_, "s4") => Some(&mut prism[1].y),
        _ => None,
    }
}

/// `k1` is number 0 of k.
fn numbered(name: &str, letter: char) -> Option<usize> {
    name.strip_prefix(letter)?.parse::<usize>().ok()?.checked_sub(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_those_of_the_formulas() {
        let mut brown = Model::brown(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.0, 12.0]);
        let names = ["k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6", "s1", "s2", "s3", "s4"];
        for (name, expected) in names.into_iter().zip(1..) {
            assert_eq!(of_model(&mut brown, name), Some(&mut f64::from(expected)), "{name}");
        }
        let mut fisheye = Model::fisheye(&[1.0, 2.0, 3.0, 4.0]);
        for (name, expected) in [("k1", 1.0), ("k4", 4.0), ("k5", 0.0)] {
            assert_eq!(of_model(&mut fisheye, name), Some(&mut { expected }), "{name}");
        }
        assert_eq!(of_model(&mut fisheye, "k7"), None);
        assert_eq!(of_model(&mut fisheye, "xi"), None);
        let mut radius =
            Model { projection: Projection::RadiusOfAngle { c: vec![300.0, 2.0] }, distortions: Vec::new() };
        assert_eq!(of_model(&mut radius, "c2"), Some(&mut 2.0));
        assert_eq!(of_model(&mut radius, "c3"), None);
        assert_eq!(of_model(&mut radius, "k1"), None);
        assert!(NAMES.iter().all(|name| !name.is_empty()));
    }
}
