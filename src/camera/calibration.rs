//! Calibrated cameras as their files define them: numbers only. [`super::kinds::calibrated`] makes rays of them, and the reference makes
//! its own.

use super::view::View;
use glam::{DMat2, DVec2, DVec3};

/// Where the plane of a lens model lies in the image.
#[derive(Debug, Clone, PartialEq)]
pub struct Intrinsics {
    /// Width and height of the calibrated image, px.
    pub size: (u32, u32),
    /// From the plane to pixels: the focal lengths, px, on the diagonal.
    pub scale: DMat2,
    /// `cx`, `cy`, px; the centre of the first pixel is at (0, 0), as OpenCV counts.
    pub centre: DVec2,
}

/// Everything that defines the rays. The reference computes its own rays from this alone.
#[derive(Debug, Clone)]
pub struct Calibrated {
    pub eye: DVec3,
    pub view: View,
    pub intrinsics: Intrinsics,
    pub model: Model,
    pub shutter: Shutter,
}

/// How the camera moves while its rows are read, top to bottom.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shutter {
    /// Seconds from one row to the next.
    pub line_time: f64,
    /// World units a second.
    pub velocity: DVec3,
    /// Radians a second about the world's axes through the eye, right-handed.
    pub angular: DVec3,
}

impl Shutter {
    pub fn is_still(&self) -> bool {
        self.line_time == 0.0 || (self.velocity, self.angular) == (DVec3::ZERO, DVec3::ZERO)
    }
}

/// A lens as its calibration defines it: directions are projected onto a plane, whose points each distortion then moves, in order.
#[derive(Debug, Clone, PartialEq)]
pub struct Model {
    pub projection: Projection,
    pub distortions: Vec<Coefficients>,
}

/// A distortion of the plane: the radial gain `(1 + k1 r^2 + k2 r^4 + ...) / (1 + below[0] r^2 + ...)`, tangential and thin prism terms,
/// and a tilt. `kinds/calibrated/brown.rs` has the formula.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Coefficients {
    /// k1, k2, k3 and on: OpenCV's k1, k2, k3.
    pub radial: [f64; 6],
    /// OpenCV's k4, k5, k6.
    pub below: [f64; 3],
    /// p1, p2.
    pub tangential: [f64; 2],
    /// (s1, s3) of r^2, and (s2, s4) of r^4.
    pub prism: [DVec2; 2],
    /// tau_x, tau_y, radians.
    pub tilt: [f64; 2],
}

impl Coefficients {
    /// The radial terms alone: k1, k2 and on.
    pub fn radial(k: &[f64]) -> Coefficients {
        Coefficients { radial: std::array::from_fn(|n| k.get(n).copied().unwrap_or(0.0)), ..Coefficients::default() }
    }

    /// Radial terms `k`, and then `p` and `s` of the point that they have moved: RAD_TAN_THIN_PRISM_FISHEYE of COLMAP, Fisheye624 of Project
    /// Aria.
    pub fn radial_then_thin_prism(k: &[f64], p: [f64; 2], s: [f64; 4]) -> Vec<Coefficients> {
        let then = Coefficients {
            tangential: [p[1], p[0]],
            prism: [DVec2::new(s[0], s[2]), DVec2::new(s[1], s[3])],
            ..Coefficients::default()
        };
        vec![Coefficients::radial(k), then]
    }

    /// From OpenCV's list `k1, k2, p1, p2, k3, k4, k5, k6, s1, s2, s3, s4, tau_x, tau_y` or its beginning.
    pub fn of_opencv(k: &[f64]) -> Coefficients {
        let k = |n: usize| k.get(n).copied().unwrap_or(0.0);
        Coefficients {
            radial: [k(0), k(1), k(4), 0.0, 0.0, 0.0],
            below: [k(5), k(6), k(7)],
            tangential: [k(2), k(3)],
            prism: [DVec2::new(k(8), k(10)), DVec2::new(k(9), k(11))],
            tilt: [k(12), k(13)],
        }
    }

    /// Points move only towards or away from the middle, unless a tilt follows.
    pub fn is_radial(&self) -> bool {
        self.tangential == [0.0; 2] && self.prism == [DVec2::ZERO; 2]
    }
}

impl Model {
    /// A projection without distortion.
    pub fn plain(projection: Projection) -> Model {
        Model { projection, distortions: Vec::new() }
    }

    /// A picture on the plane z = 1 with OpenCV's coefficients.
    pub fn brown(k: &[f64]) -> Model {
        Model { projection: Projection::Perspective, distortions: vec![Coefficients::of_opencv(k)] }
    }

    /// Kannala and Brandt's fisheye: `r = theta (1 + k1 theta^2 + k2 theta^4 + ...)`, as in OpenCV's `fisheye` module, which stops
    /// before 90 degrees; here theta goes up to 180.
    pub fn fisheye(k: &[f64]) -> Model {
        Model { projection: Projection::Equidistant, distortions: vec![Coefficients::radial(k)] }
    }

    /// The FOV model, which is even in omega; `omega` = 0 is none.
    pub fn field_of_view(omega: f64) -> Model {
        let omega = omega.abs();
        let projection = if omega == 0.0 { Projection::Perspective } else { Projection::FieldOfView { omega } };
        Model::plain(projection)
    }
}

/// From directions to a plane. The frame is OpenCV's: x right, y down, z forward. theta is the angle from z, r the radius on the plane.
#[derive(Debug, Clone, PartialEq)]
pub enum Projection {
    /// `r = tan(theta)`; the plane is z = 1.
    Perspective,
    /// `r = theta`, up to 180 degrees.
    Equidistant,
    /// `r = atan(2 tan(theta) tan(omega / 2)) / omega` (Devernay and Faugeras 2001), omega in radians over 0 and under pi.
    FieldOfView { omega: f64 },
    /// `r = sin(theta) / (cos(theta) + xi)`, xi >= 0 (Geyer and Daniilidis 2000, Mei and Rives 2007).
    Unified { xi: f64 },
    /// `r = sin(theta) / (alpha sqrt(beta sin^2(theta) + cos^2(theta)) + (1 - alpha) cos(theta))`, alpha in [0, 1], beta over 0
    /// (Khomutenko et al. 2016).
    EnhancedUnified { alpha: f64, beta: f64 },
    /// `r = sin(theta) / (alpha d + (1 - alpha) (xi + cos(theta)))`, `d^2 = sin^2(theta) + (xi + cos(theta))^2`, alpha in [0, 1], xi in
    /// (-1, 1] (Usenko et al. 2018).
    DoubleSphere { xi: f64, alpha: f64 },
    /// `tan(theta) = r / (1 + k r^2)`, theta up to 180 degrees (Fitzgibbon 2001).
    Division { k: f64 },
    /// Longitude and latitude, radians, latitude downward: a whole turn and half a turn.
    Equirectangular,
    /// `theta = c[0] r + c[1] r^2 + ...`, up to 180 degrees: NVIDIA's f-theta model.
    AngleOfRadius { c: Vec<f64> },
    /// `r = c[0] theta + c[1] theta^2 + ...`, up to 180 degrees.
    RadiusOfAngle { c: Vec<f64> },
    /// The direction seen at (x, y) is along `(x, y, c[0] + c[1] r + c[2] r^2 + ...)`: Scaramuzza's model (2006), whose polynomial is minus
    /// this one.
    HeightOfRadius { c: Vec<f64> },
}

impl Projection {
    /// The name in the table of projections of the definitions.
    pub fn name(&self) -> &'static str {
        match self {
            Projection::Perspective => "perspective",
            Projection::Equidistant => "equidistant",
            Projection::FieldOfView { .. } => "FOV",
            Projection::Unified { .. } => "omni (Mei)",
            Projection::EnhancedUnified { .. } => "EUCM",
            Projection::DoubleSphere { .. } => "double sphere",
            Projection::Division { .. } => "division",
            Projection::Equirectangular => "equirectangular",
            Projection::AngleOfRadius { .. } | Projection::RadiusOfAngle { .. } => "f-theta",
            Projection::HeightOfRadius { .. } => "Scaramuzza",
        }
    }
}
