//! A sensor tilted against the lens, as OpenCV's `tau_x` and `tau_y`: a projective map of the plane z = 1 that fixes the middle.

use glam::{DMat3, DVec2, DVec3};

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tilt {
    /// From the plane to the sensor and back; `None` without a tilt.
    maps: Option<[DMat3; 2]>,
}

impl Tilt {
    /// From the angles about x and y, radians.
    ///
    /// # Errors
    /// An angle of 90 degrees or more: no light reaches such a sensor.
    pub fn new(tau_x: f64, tau_y: f64) -> Result<Tilt, String> {
        if tau_x.abs().max(tau_y.abs()) >= std::f64::consts::FRAC_PI_2 {
            return Err(format!("tau_x = {tau_x}, tau_y = {tau_y}: a tilt must be under pi / 2"));
        }
        if (tau_x, tau_y) == (0.0, 0.0) {
            return Ok(Tilt { maps: None });
        }
        // OpenCV's angles have the opposite sign of glam's
        let rotation = DMat3::from_rotation_y(-tau_y) * DMat3::from_rotation_x(-tau_x);
        let [x, y, z] = rotation.z_axis.to_array();
        let project = DMat3::from_cols(DVec3::new(z, 0.0, 0.0), DVec3::new(0.0, z, 0.0), DVec3::new(-x, -y, 1.0));
        let onto = project * rotation;
        Ok(Tilt { maps: Some([onto, onto.inverse()]) })
    }

    /// Where light from a place of the plane meets the sensor; `None` if it does not.
    pub fn onto(&self, place: DVec2) -> Option<DVec2> {
        self.maps.map_or(Some(place), |[onto, _]| projected(onto, place))
    }

    /// The place of the plane whose light meets the sensor here.
    pub fn back(&self, place: DVec2) -> Option<DVec2> {
        self.maps.map_or(Some(place), |[_, back]| projected(back, place))
    }
}

fn projected(map: DMat3, place: DVec2) -> Option<DVec2> {
    let v = map * place.extend(1.0);
    (v.z > 0.0).then(|| v.truncate() / v.z)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// OpenCV's `computeTiltProjectionMatrix`, written out.
    #[test]
    fn a_tilt_is_opencvs() {
        let (tau_x, tau_y) = (0.3_f64, -0.2_f64);
        let ((sx, cx), (sy, cy)) = (tau_x.sin_cos(), tau_y.sin_cos());
        let rows = |m: [[f64; 3]; 3]| DMat3::from_cols_array_2d(&m).transpose();
        let rotation = rows([[cy, 0.0, -sy], [0.0, 1.0, 0.0], [sy, 0.0, cy]])
            * rows([[1.0, 0.0, 0.0], [0.0, cx, sx], [0.0, -sx, cx]]);
        let [x, y, z] = rotation.z_axis.to_array();
        let all = rows([[z, 0.0, -x], [0.0, z, -y], [0.0, 0.0, 1.0]]) * rotation;
        let tilt = Tilt::new(tau_x, tau_y).unwrap();
        for p in [DVec2::ZERO, DVec2::new(0.3, -0.7), DVec2::new(-2.0, 0.1)] {
            let v = all * p.extend(1.0);
            let onto = tilt.onto(p).unwrap();
            assert!((onto - v.truncate() / v.z).length() < 1e-15, "{p}");
            assert!((tilt.back(onto).unwrap() - p).length() < 1e-14, "{p}");
        }
        assert_eq!(tilt.onto(DVec2::ZERO), Some(DVec2::ZERO));
        // light along the tilted sensor's plane, or beyond, does not meet it
        assert_eq!(tilt.onto(DVec2::new(6.0, 6.0)), None);
        assert!(Tilt::new(1.6, 0.0).is_err() && Tilt::new(0.0, 0.0).unwrap().maps.is_none());
    }
}
