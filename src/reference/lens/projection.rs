//! Projections of calibrated models, inverted by bisection of the forward formulas over the angles that each is defined for.

use super::radial::{self, Range};
use crate::camera::calibration::Projection;
use glam::{DVec2, DVec3};
use std::f64::consts::{FRAC_PI_2, PI};

/// The direction that is projected to `p`.
pub fn direction(projection: &Projection, p: DVec2) -> Option<DVec3> {
    let r = p.length();
    if r == 0.0 {
        return Some(DVec3::Z);
    }
    if *projection == Projection::Perspective {
        return Some(p.extend(1.0));
    }
    if *projection == Projection::Equirectangular {
        let (longitude, latitude) = (p.x, p.y);
        // half a turn to each side and a quarter up and down, as far as these angles are rounded
        let is_inside = p.x.abs() < PI + 1e-14 && p.y.abs() < FRAC_PI_2 + 1e-14;
        let horizontal = DVec3::new(longitude.sin(), 0.0, longitude.cos());
        return is_inside.then(|| latitude.cos() * horizontal + latitude.sin() * DVec3::Y);
    }
    let theta = angle(projection, r)?;
    let (sin, cos) = theta.sin_cos();
    let of_unit_length = DVec3::new(p.x / r * sin, p.y / r * sin, cos);
    Some(if projection.is_plane() { of_unit_length / cos } else { of_unit_length })
}

/// The angle from the axis that is seen at the radius `r`.
fn angle(projection: &Projection, r: f64) -> Option<f64> {
    match projection {
        Projection::Perspective | Projection::Equirectangular => None,
        Projection::Equidistant => (r <= PI).then_some(r),
        Projection::FieldOfView { omega } => {
            let seen = |theta: f64| (2.0 * theta.tan() * (omega / 2.0).tan()).atan() / omega;
            bisect(seen, FRAC_PI_2, r)
        }
        Projection::Unified { xi } => {
            let end = if *xi > 1.0 { -1.0 / xi } else { -xi };
            bisect(|theta| theta.sin() / shifted(*xi, theta), end.acos(), r)
        }
        Projection::EnhancedUnified { alpha, beta } => {
            let seen = |theta: f64| {
                let (sin, cos) = theta.sin_cos();
                sin / (alpha * (beta * sin * sin + cos * cos).sqrt() + (1.0 - alpha) * cos)
            };
            // cos(theta) = -w d of the published condition, d^2 = beta sin^2 + cos^2
            let w = w(*alpha);
            let tangent_squared = (1.0 - w * w) / (w * w * beta);
            bisect(seen, PI - tangent_squared.sqrt().atan(), r)
        }
        Projection::DoubleSphere { xi, alpha } => {
            let seen = |theta: f64| {
                let (sin, z) = (theta.sin(), shifted(*xi, theta));
                sin / (alpha * (sin * sin + z * z).sqrt() + (1.0 - alpha) * z)
            };
            // `xi + cos = -w d` is a quadratic equation of cos
            let rest = 1.0 - w(*alpha).powi(2);
            let end = -xi * rest - w(*alpha) * (1.0 - xi * xi * rest).sqrt();
            bisect(seen, end.max(-1.0).acos(), r)
        }
        // tan(theta) = r / (1 + k r^2) grows up to k r^2 = 1
        Projection::Division { k } => (k * r * r <= 1.0).then(|| r.atan2(1.0 + k * r * r)),
        // theta = sum of c[n] r^(n + 1), while it grows and is at most pi
        Projection::AngleOfRadius { c } => {
            let value = |r: f64| c.iter().enumerate().map(|(n, c)| c * r.powi(n as i32 + 1)).sum::<f64>();
            let is_growing = radial::grows_until(&|x: Range| slope(c, x), &value, r);
            Some(value(r)).filter(|theta| is_growing && *theta <= PI)
        }
        // theta grows while the height h of the ray over the plane is over r h'
        Projection::HeightOfRadius { c } => {
            let height = |r: f64| c.iter().enumerate().map(|(n, c)| c * r.powi(n as i32)).sum::<f64>();
            let value = |r: f64| r.atan2(height(r));
            let is_growing = radial::grows_until(&|x: Range| growth(c, x), &value, r);
            Some(value(r)).filter(|_| is_growing)
        }
        Projection::RadiusOfAngle { c } => {
            let value = |theta: f64| c.iter().enumerate().map(|(n, c)| c * theta.powi(n as i32 + 1)).sum::<f64>();
            radial::in_range(&|x: Range| slope(c, x), &value, PI, r)
        }
    }
}

/// `xi + cos(theta)`, without cancellation where xi is near 1 and theta near pi.
fn shifted(xi: f64, theta: f64) -> f64 {
    xi - 1.0 + 2.0 * (theta / 2.0).cos().powi(2)
}

/// Bounds on the derivative of `c[0] x + c[1] x^2 + ...` over a range of x, from 0 up.
fn slope(c: &[f64], x: Range) -> Range {
    polynomial(c.iter().enumerate().map(|(n, c)| (n + 1) as f64 * c), x)
}

/// Bounds on `h - r h'` over a range of r, for `h = c[0] + c[1] r + ...`.
fn growth(c: &[f64], r: Range) -> Range {
    polynomial(c.iter().enumerate().map(|(n, c)| (1.0 - n as f64) * c), r)
}

/// Bounds on `k[0] + k[1] x + ...` over a range of x, from 0 up.
fn polynomial(coefficients: impl Iterator<Item = f64>, x: Range) -> Range {
    let (mut power, mut sum) = (Range::at(1.0), Range::at(0.0));
    for k in coefficients {
        sum = sum + Range::at(k) * power;
        power = power * x;
    }
    sum
}

/// Usenko's and Khomutenko's w: directions have a projection while `cos(theta) > -w d`.
fn w(alpha: f64) -> f64 {
    if alpha > 0.5 { (1.0 - alpha) / alpha } else { alpha / (1.0 - alpha) }
}

/// The angle under `end` with `seen = r`, for a projection that grows from 0 to `end`, by halving.
fn bisect(seen: impl Fn(f64) -> f64, end: f64, r: f64) -> Option<f64> {
    assert!(end.is_finite(), "the projection has an end");
    // at and past a pole, where nothing is seen, the formula is infinite or negative
    let is_before = |theta: f64| (0.0..r).contains(&seen(theta));
    let angle = radial::bisect(|theta| !is_before(theta), [0.0, end]);
    // not reached before the end
    (angle < end).then_some(angle)
}
