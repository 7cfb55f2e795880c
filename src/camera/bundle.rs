//! The rays about one pixel as one affine, homogeneous bundle.

pub use crate::geometry::cast::Ray;
use glam::DVec3;

/// Rays that are affine over the image in homogeneous form: at the image place `(x, y)` pixels right of
/// and below the bundle's centre, `P = p(x, y) / h(x, y)` and `D = d(x, y) / h(x, y)` with
/// `p(x, y) = p[0] + x p[1] + y p[2]`, and `d`, `h` alike. `h > 0` on the piece; plain GLCs have `h = 1`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bundle {
    /// Ray origins: value, derivative along x, derivative along y (world units, world units a pixel).
    pub p: [DVec3; 3],
    /// Ray directions, likewise.
    pub d: [DVec3; 3],
    /// The homogeneous weight, likewise.
    pub h: [f64; 3],
}

impl Bundle {
    /// `P = p[0] + x p[1] + y p[2]`, `D` alike, over an image of `(width, height)` pixels: x = 2a - 1 to the right and
    /// y = 1 - 2b upwards, so the borders are at -1 and 1; centred on the image's middle.
    pub fn over_image(p: [DVec3; 3], d: [DVec3; 3], (width, height): (u32, u32)) -> Bundle {
        let (x, y) = (2.0 / width as f64, -2.0 / height as f64);
        let per_px = |q: [DVec3; 3]| [q[0], x * q[1], y * q[2]];
        Bundle { p: per_px(p), d: per_px(d), h: [1.0, 0.0, 0.0] }
    }

    /// The ray `(x, y)` pixels from the centre.
    pub fn ray(&self, x: f64, y: f64) -> Ray {
        let h = self.h[0] + x * self.h[1] + y * self.h[2];
        Ray {
            origin: (self.p[0] + x * self.p[1] + y * self.p[2]) / h,
            direction: (self.d[0] + x * self.d[1] + y * self.d[2]) / h,
        }
    }

    /// The same rays with the centre moved by `(x, y)` pixels.
    pub fn recentred(&self, x: f64, y: f64) -> Bundle {
        let v = |c: &[DVec3; 3]| [c[0] + x * c[1] + y * c[2], c[1], c[2]];
        Bundle { p: v(&self.p), d: v(&self.d), h: [self.h[0] + x * self.h[1] + y * self.h[2], self.h[1], self.h[2]] }
    }
}
