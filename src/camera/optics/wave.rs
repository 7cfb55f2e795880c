//! The wave: a square of water with waves along both axes.

use glam::DVec3;
use std::f64::consts::TAU;

/// The points `centre + (x, amplitude sin(2 pi x / wavelength) sin(2 pi z / wavelength), z)` for x and z within half of `size`.
/// The outside is above.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wave {
    pub centre: DVec3,
    pub size: f64,
    pub amplitude: f64,
    pub wavelength: f64,
}

/// Waves along a side at most: a ray that lies in the surface is followed from one to the next.
pub const WAVES_MAX: f64 = 1024.0;

impl Wave {
    /// At `place` over the surface; points up.
    pub fn normal(&self, place: DVec3) -> DVec3 {
        let (q, k) = (place - self.centre, TAU / self.wavelength);
        let ((sx, cx), (sz, cz)) = ((k * q.x).sin_cos(), (k * q.z).sin_cos());
        DVec3::new(-self.amplitude * k * cx * sz, 1.0, -self.amplitude * k * sx * cz)
    }

    /// Height of the surface over its middle, there where `q` is over, from the centre.
    pub fn height(&self, q: DVec3) -> f64 {
        let k = TAU / self.wavelength;
        self.amplitude * (k * q.x).sin() * (k * q.z).sin()
    }
}
