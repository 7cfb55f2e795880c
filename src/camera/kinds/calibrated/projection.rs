//! Projections of calibrated models: from directions to a plane and back. [`super::brown`] then distorts the plane.
//!
//! All but one are the same all round the axis. Each shows the branch of the middle: directions from the axis to the angle where the
//! radius stops growing (a fold) or becomes infinite (a pole).

use super::roots;
use crate::camera::calibration::Projection;
use glam::{DVec2, DVec3};
use std::f64::consts::{FRAC_PI_2, PI};

impl Projection {
    /// # Errors
    /// A number that is not finite, or out of its range.
    pub fn check(&self) -> Result<(), String> {
        let in_range = |name: &str, value: f64, is_in: bool, range: &str| match is_in {
            true => Ok(()),
            false => Err(format!("{name} = {value}: must be {range}")),
        };
        let alpha_in_range = |alpha: f64| in_range("alpha", alpha, (0.0..=1.0).contains(&alpha), "in [0, 1]");
        match *self {
            Projection::FieldOfView { omega } => in_range("omega", omega, omega > 0.0 && omega < PI, "in [0, pi)"),
            Projection::Unified { xi } => in_range("xi", xi, xi >= 0.0 && xi.is_finite(), "at least 0"),
            Projection::EnhancedUnified { alpha, beta } => {
                alpha_in_range(alpha)?;
                in_range("beta", beta, beta > 0.0 && beta.is_finite(), "over 0")
            }
            Projection::DoubleSphere { xi, alpha } => {
                alpha_in_range(alpha)?;
                in_range("xi", xi, xi > -1.0 && xi <= 1.0, "in (-1, 1]")
            }
            Projection::Division { k } => in_range("k", k, k.is_finite(), "finite"),
            Projection::AngleOfRadius { ref c }
            | Projection::RadiusOfAngle { ref c }
            | Projection::HeightOfRadius { ref c } => {
                let is_height = matches!(self, Projection::HeightOfRadius { .. });
                let start = if is_height { "under 0 at the middle" } else { "start with 0 and a number over 0" };
                let is_good = c.first().is_some_and(|c| *c > 0.0) && c.iter().all(|c| c.is_finite());
                if is_good { Ok(()) } else { Err(format!("polynomial: must be finite, and {start}")) }
            }
            Projection::Perspective | Projection::Equidistant | Projection::Equirectangular => Ok(()),
        }
    }

    /// The direction that is seen at `p`: of z = 1 if [`Projection::is_plane`], else of unit length; `None`: nothing is. `end` is
    /// [`Projection::end`].
    pub fn direction(&self, p: DVec2, end: f64) -> Option<DVec3> {
        let square = p.length_squared();
        // (x s, y s, z) for a unit direction
        let scaled = |s: f64, z: f64| Some((p * s).extend(z));
        match self {
            Projection::Perspective => Some(p.extend(1.0)),
            Projection::FieldOfView { omega } => {
                let (r, angle) = (square.sqrt(), square.sqrt() * omega);
                let across = if r == 0.0 { 0.0 } else { angle.tan() / (2.0 * (0.5 * omega).tan() * r) };
                (angle < FRAC_PI_2).then(|| (p * across).extend(1.0))
            }
            Projection::Unified { xi } => {
                let below = 1.0 + (1.0 - xi) * (1.0 + xi) * square;
                let root = below.max(0.0).sqrt();
                // the second is the first less xi, without cancellation
                if below >= 0.0 {
                    scaled((xi + root) / (1.0 + square), (root - xi * square) / (1.0 + square))
                } else {
                    None
                }
            }
            Projection::EnhancedUnified { alpha, beta } => {
                p.extend(height_on_sphere(*alpha, beta * square)?).try_normalize()
            }
            Projection::DoubleSphere { xi, alpha } => {
                let z = height_on_sphere(*alpha, square)?;
                let inner = z * z + (1.0 - xi * xi) * square;
                let along = (z * xi + inner.max(0.0).sqrt()) / (z * z + square);
                // for xi = 1 nothing is left beyond 180 degrees
                if inner >= 0.0 && along > 0.0 { scaled(along, along * z - xi) } else { None }
            }
            Projection::Division { k } => {
                let is_before_fold = k * square <= 1.0;
                if is_before_fold { p.extend(1.0 + k * square).try_normalize() } else { None }
            }
            Projection::Equirectangular => {
                let is_inside = p.x.abs() <= PI + EDGE && p.y.abs() <= FRAC_PI_2 + EDGE;
                let ((sin, cos), (down, across)) = (p.x.sin_cos(), p.y.sin_cos());
                is_inside.then(|| DVec3::new(across * sin, down, across * cos))
            }
            Projection::HeightOfRadius { c } => {
                let r = square.sqrt();
                if r <= end { p.extend(roots::value(c, r)).try_normalize() } else { None }
            }
            Projection::Equidistant | Projection::AngleOfRadius { .. } | Projection::RadiusOfAngle { .. } => {
                let r = square.sqrt();
                if r == 0.0 {
                    return Some(DVec3::Z);
                }
                let (sin, cos) = self.angle(r, end)?.sin_cos();
                scaled(sin / r, cos)
            }
        }
    }

    /// The angle that is seen at a radius over 0, for the projections that are made of one.
    fn angle(&self, r: f64, end: f64) -> Option<f64> {
        match self {
            Projection::AngleOfRadius { c } => (r <= end).then(|| polynomial(c, r).0),
            Projection::RadiusOfAngle { c } => {
                let off = |theta: f64| {
                    let (value, slope) = polynomial(c, theta);
                    (value - r, slope)
                };
                (off(end).0 >= 0.0).then(|| roots::in_bracket(r / c[0], end, off))
            }
            _ => (r <= end).then_some(r),
        }
    }

    /// The largest argument of the polynomial: at the fold or at 180 degrees.
    ///
    /// Where the height over the plane is h, `theta = atan2(r, h)` grows while `h - r h'` is over 0.
    pub fn end(&self) -> f64 {
        let fold = |c: &[f64]| roots::first(&roots::derivative(&with_0(c)));
        match self {
            Projection::AngleOfRadius { c } => {
                let mut behind = with_0(c);
                behind[0] = -PI;
                roots::first(&behind).min(fold(c))
            }
            Projection::RadiusOfAngle { c } => fold(c).min(PI),
            Projection::HeightOfRadius { c } => {
                let growth: Vec<f64> = c.iter().enumerate().map(|(n, c)| (1.0 - n as f64) * c).collect();
                roots::first(&growth)
            }
            _ => PI,
        }
    }

    /// The place of the direction `v`, of any length over 0; `None` if it is not seen.
    pub fn place(&self, v: DVec3, end: f64) -> Option<DVec2> {
        let (across, length) = (v.truncate(), v.length());
        // z + xi |v|, without cancellation near 180 degrees for xi near 1
        let shifted = |xi: f64| match v.z < 0.0 {
            true => (xi - 1.0) * length + across.length_squared() / (length - v.z),
            false => v.z + xi * length,
        };
        // over the denominator, while the direction is on the branch of the middle
        let over = |below: f64, is_seen: bool| (is_seen && below > 0.0).then(|| across / below);
        match self {
            Projection::Perspective => over(v.z, true),
            Projection::FieldOfView { omega } => {
                let r = (across.length() * 2.0 * (0.5 * omega).tan()).atan2(v.z) / omega;
                (v.z > 0.0).then(|| across.normalize_or_zero() * r)
            }
            Projection::Unified { xi } => {
                // the fold is at cos(theta) = -1 / xi
                over(shifted(*xi), *xi <= 1.0 || v.z * xi > -length)
            }
            Projection::EnhancedUnified { alpha, beta } => {
                let d = (beta * across.length_squared() + v.z * v.z).sqrt();
                over(alpha * d + (1.0 - alpha) * v.z, v.z > -end_of_sphere(*alpha) * d)
            }
            Projection::DoubleSphere { xi, alpha } => {
                let shifted = shifted(*xi);
                let d = across.length().hypot(shifted);
                over(alpha * d + (1.0 - alpha) * shifted, shifted > -end_of_sphere(*alpha) * d)
            }
            Projection::Division { k } => {
                let square = across.length_squared();
                let root = (v.z * v.z - 4.0 * k * square).max(0.0).sqrt();
                if *k > 0.0 || v.z >= 0.0 {
                    return over(0.5 * (v.z + root), *k <= 0.0 || v.z * v.z > 4.0 * k * square && v.z > 0.0);
                }
                // without cancellation; k = 0 sees nothing here
                over(-2.0 * k * square / (root - v.z), true)
            }
            Projection::Equirectangular => Some(DVec2::new(v.x.atan2(v.z), v.y.atan2(v.x.hypot(v.z)))),
            Projection::HeightOfRadius { c } => {
                let radius = across.length();
                if radius == 0.0 {
                    return (v.z > 0.0).then_some(DVec2::ZERO);
                }
                // r z - h(r) radius has the sign of the angle at r less that of v
                let off = |r: f64| {
                    let (rest, slope) = polynomial(&c[1..], r);
                    (r * v.z - (c[0] + rest) * radius, v.z - slope * radius)
                };
                let mut hi = if end.is_finite() { end } else { c[0] };
                while end == f64::INFINITY && off(hi).0 < 0.0 && hi < f64::MAX.sqrt() {
                    hi *= 2.0;
                }
                (off(hi).0 >= 0.0)
                    .then(|| across / radius * roots::in_bracket((c[0] * radius / v.z.abs()).min(hi), hi, off))
            }
            Projection::Equidistant | Projection::AngleOfRadius { .. } | Projection::RadiusOfAngle { .. } => {
                let theta = across.length().atan2(v.z);
                let r = match self {
                    Projection::AngleOfRadius { c } => {
                        let off = |r: f64| {
                            let (value, slope) = polynomial(c, r);
                            (value - theta, slope)
                        };
                        let hi = if end.is_finite() { end } else { theta / c[0] };
                        (off(hi).0 > 0.0 || theta == 0.0).then(|| roots::in_bracket(theta / c[0], hi, off))?
                    }
                    _ if theta >= end => return None,
                    Projection::RadiusOfAngle { c } => polynomial(c, theta).0,
                    _ => theta,
                };
                Some(across.normalize_or_zero() * r)
            }
        }
    }

    /// Rays have z = 1, so that t is the depth along the axis; else they have unit length.
    pub fn is_plane(&self) -> bool {
        matches!(self, Projection::Perspective | Projection::FieldOfView { .. })
    }

    /// The direction `v` is seen on a whole curve, or within rounding of such a one: straight behind on a circle, the poles on lines.
    pub fn is_on_curve(&self, v: DVec3) -> bool {
        match self {
            Projection::Equidistant
            | Projection::AngleOfRadius { .. }
            | Projection::RadiusOfAngle { .. }
            | Projection::DoubleSphere { xi: 1.0, .. } => v.z < 0.0 && v.truncate().length() <= STRAIGHT * v.length(),
            Projection::Equirectangular => v.x.hypot(v.z) <= STRAIGHT * v.length(),
            _ => false,
        }
    }
}

/// Sine of the largest angle at which a direction counts as on an axis: 2^-40, as for other degenerate images in projection.
const STRAIGHT: f64 = 1.0 / (1u64 << 40) as f64;

/// Rounding of an angle up to pi at an image's edge: some roundings of its pixel, relative to the image's half.
const EDGE: f64 = 16.0 * f64::EPSILON;

/// The least `z / d` on the branch of the middle is minus this: Khomutenko's and Usenko's w. Usenko et al. bound z itself for the double
/// sphere, more tightly than the branch goes.
fn end_of_sphere(alpha: f64) -> f64 {
    if alpha <= 0.5 { alpha / (1.0 - alpha) } else { (1.0 - alpha) / alpha }
}

/// The z of the direction (x, y, z) that EUCM shows at a place, `square` being beta (x^2 + y^2): `(1 - alpha^2 square) / (alpha root +
/// 1 - alpha)`, `root^2 = 1 - (2 alpha - 1) square`; `None` beyond the fold.
fn height_on_sphere(alpha: f64, square: f64) -> Option<f64> {
    let below = 1.0 - (2.0 * alpha - 1.0) * square;
    let root = below.max(0.0).sqrt();
    let z = match alpha > 0.75 {
        // the same, which is no 0 / 0 at the fold of alpha = 1
        true => (alpha * root + alpha - 1.0) / (2.0 * alpha - 1.0),
        false => (1.0 - alpha * alpha * square) / (alpha * root + 1.0 - alpha),
    };
    (below >= 0.0).then_some(z)
}

/// `c[0] x + c[1] x^2 + ...` and its derivative.
fn polynomial(c: &[f64], x: f64) -> (f64, f64) {
    c.iter()
        .enumerate()
        .rev()
        .fold((0.0, 0.0), |(value, slope), (n, c)| ((value + c) * x, slope * x + (n + 1) as f64 * c))
}

/// The coefficients of the same polynomial, constant first.
fn with_0(c: &[f64]) -> Vec<f64> {
    [0.0].iter().chain(c).copied().collect()
}
