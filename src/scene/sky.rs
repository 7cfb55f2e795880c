//! Environment light from an image.

use super::file::SkySpec;
use crate::arrays::MapEach;
use crate::geometry::texture::{Images, Texels, Texture, Wrap};
use crate::input::{Loading, Result};
use crate::parallel;
use glam::{DVec2, DVec3};
use half::f16;
use std::f64::consts::{PI, TAU};
use std::sync::{Arc, OnceLock};

/// An equirectangular environment image: longitude from left to right with -z in the middle, +y on top.
#[derive(Debug, Clone, PartialEq)]
pub struct Sky {
    /// Repeats in longitude.
    pub image: Texture,
    /// Factor of its light.
    pub strength: f32,
    /// Rotation about +y in revolutions, counter-clockwise seen from above.
    pub rotation: f64,
    /// Whether pixels that hit nothing show it.
    pub is_seen: bool,
    /// Irradiance over pi for a normal n, linear RGB: coefficients of 1, y, z, x, xy, yz, 3 zz - 1, xz and xx - yy.
    pub irradiance: [[f32; 3]; 9],
    /// The image and its mip levels, computed on first use.
    coarser: OnceLock<Vec<Texture>>,
}

/// Samples per side for the mean over a lobe.
const LOBE_SIDE: u32 = 16;

impl Sky {
    /// # Errors
    /// [`crate::input::Error::Input`] if its image cannot be read.
    pub fn new(spec: &SkySpec, images: &mut Images, loading: &Loading) -> Result<Sky> {
        let sky = Sky::of(images.load(&spec.file, loading)?, spec.strength as f32, spec.rotate / 360.0);
        Ok(Sky { is_seen: spec.is_seen, ..sky })
    }

    /// A visible environment of these texels.
    pub fn of(texels: Arc<Texels>, strength: f32, rotation: f64) -> Sky {
        let image = Texture { wrap: [Wrap::Repeat, Wrap::Clamp], ..Texture::new(texels) };
        let (irradiance, coarser) = ([[0.0; 3]; 9], OnceLock::new());
        let mut sky = Sky { image, strength, rotation, is_seen: true, irradiance, coarser };
        sky.irradiance = sky.harmonics();
        sky
    }

    /// The image place (u, v) of a unit direction.
    fn uv(&self, d: DVec3) -> DVec2 {
        DVec2::new(0.5 + d.x.atan2(-d.z) / TAU + self.rotation, 0.5 + d.y.clamp(-1.0, 1.0).asin() / PI)
    }

    /// The unit direction of an image place (u, v).
    fn direction(&self, uv: DVec2) -> DVec3 {
        let (longitude, latitude) = ((uv.x - 0.5 - self.rotation) * TAU, (uv.y - 0.5) * PI);
        DVec3::new(latitude.cos() * longitude.sin(), latitude.sin(), -latitude.cos() * longitude.cos())
    }

    /// Radiance from a unit direction, linear RGB.
    pub fn radiance(&self, d: DVec3) -> DVec3 {
        self.radiance_of(&self.image, d)
    }

    fn radiance_of(&self, image: &Texture, d: DVec3) -> DVec3 {
        let [r, g, b, _] = image.at(self.uv(d));
        f64::from(self.strength) * DVec3::new(r, g, b)
    }

    /// Mean radiance over a square of `width` radians about a unit direction.
    pub fn lobe(&self, d: DVec3, width: f64) -> DVec3 {
        // with texels no smaller than from one direction to the next, so that none is missed
        let step = width / f64::from(LOBE_SIDE) / (TAU / f64::from(self.image.texels.width));
        let level = step.log2().floor().max(0.0) as usize;
        let coarser = self.coarser.get_or_init(|| self.halved());
        let image = &coarser[level.min(coarser.len() - 1)];
        let (across, along) = d.any_orthonormal_pair();
        let place = |k: u32| ((f64::from(k) + 0.5) / f64::from(LOBE_SIDE) - 0.5) * width;
        let side = || (0..LOBE_SIDE).map(place);
        let tilted = |x: f64, y: f64| {
            let angle = x.hypot(y);
            angle.cos() * d + angle.sin() / angle * (x * across + y * along)
        };
        let sum: DVec3 = side().flat_map(|x| side().map(move |y| self.radiance_of(image, tilted(x, y)))).sum();
        sum / f64::from(LOBE_SIDE * LOBE_SIDE)
    }

    /// The image and its mip levels, each the means of 2 x 2 texels.
    fn halved(&self) -> Vec<Texture> {
        let mut all = vec![self.image.clone()];
        while let Some(Texture { texels: finer, .. }) = all.last().filter(|t| t.texels.width.min(t.texels.height) >= 2)
        {
            let (width, height) = (finer.width / 2, finer.height / 2);
            let texel = |k: u32| {
                let (x, y) = (2 * (k % width), 2 * (k / width));
                let at = |dx: u32, dy: u32| finer.rgba[((y + dy) * finer.width + x + dx) as usize];
                let four = [at(0, 0), at(1, 0), at(0, 1), at(1, 1)];
                std::array::from_fn(|c| f16::from_f32(four.iter().map(|t| t[c].to_f32()).sum::<f32>() / 4.0))
            };
            let rgba = parallel::map(0..width * height, texel);
            let texels = Arc::new(Texels { width, height, rgba });
            all.push(Texture { texels, ..self.image.clone() });
        }
        all
    }

    /// Irradiance over pi for the unit normal `n`: spherical harmonics of order 2 (Ramamoorthi and Hanrahan 2001), average error
    /// under 1 %.
    pub fn irradiance(&self, n: DVec3) -> DVec3 {
        let sum: DVec3 =
            basis(n).iter().zip(self.irradiance).map(|(y, c)| *y * DVec3::from(c.map_each(f64::from))).sum();
        sum.max(DVec3::ZERO)
    }

    fn harmonics(&self) -> [[f32; 3]; 9] {
        let Texels { width, height, ref rgba } = *self.image.texels;
        let of_row = |j: usize| {
            let row = &rgba[j * width as usize..][..width as usize];
            let v = 1.0 - (j as f64 + 0.5) / f64::from(height);
            // of a texel
            let solid_angle = TAU / f64::from(width) * PI / f64::from(height) * ((v - 0.5) * PI).cos();
            let mut sums = [DVec3::ZERO; 9];
            for (i, texel) in row.iter().enumerate() {
                let y = basis(self.direction(DVec2::new((i as f64 + 0.5) / f64::from(width), v)));
                let light = solid_angle * DVec3::new(texel[0].into(), texel[1].into(), texel[2].into());
                sums.iter_mut().zip(y).for_each(|(sum, y)| *sum += y * light);
            }
            sums
        };
        // added up in one order, whatever the threads
        let sums_of_rows: Vec<[DVec3; 9]> = parallel::map(0..height as usize, of_row);
        let sums: [DVec3; 9] = std::array::from_fn(|k| sums_of_rows.iter().map(|row| row[k]).sum());
        // squares of the harmonics' factors, times the share of each order that a cosine leaves
        let order = [1.0, 2.0 / 3.0, 0.25];
        let factors = [0.25, 0.75, 0.75, 0.75, 3.75, 3.75, 0.3125, 3.75, 0.9375].map(|f| f / PI);
        std::array::from_fn(|k| {
            let share = order[[0, 1, 1, 1, 2, 2, 2, 2, 2][k]];
            (f64::from(self.strength) * factors[k] * share * sums[k]).as_vec3().to_array()
        })
    }
}

/// 1, y, z, x, xy, yz, 3 zz - 1, xz and xx - yy.
fn basis(n: DVec3) -> [f64; 9] {
    let DVec3 { x, y, z } = n;
    [1.0, y, z, x, x * y, y * z, 3.0 * z * z - 1.0, x * z, x * x - y * y]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sky(light: impl Fn(DVec3) -> f64) -> Sky {
        const ROTATION: f64 = 0.1;
        let (width, height) = (256, 128);
        let texel = |k: u32| {
            let longitude = TAU * ((f64::from(k % width) + 0.5) / f64::from(width) - 0.5 - ROTATION);
            let latitude = PI * (0.5 - (f64::from(k / width) + 0.5) / f64::from(height));
            let level = DVec3::new(longitude.sin(), 0.0, -longitude.cos());
            [light(latitude.cos() * level + latitude.sin() * DVec3::Y), 0.0, 0.0, 1.0].map(f16::from_f64)
        };
        let rgba = (0..width * height).map(texel).collect();
        Sky::of(Arc::new(Texels { width, height, rgba }), 2.0, ROTATION)
    }

    #[test]
    fn directions_come_back_and_the_middle_is_ahead() {
        let sky = Sky { rotation: 0.0, ..sky(|_| 1.0) };
        assert!((sky.direction(DVec2::splat(0.5)) - DVec3::NEG_Z).length() < 1e-12);
        assert!((sky.direction(DVec2::new(0.75, 0.5)) - DVec3::X).length() < 1e-12);
        let rotated = Sky { rotation: 0.25, ..sky };
        for d in [DVec3::new(0.3, -0.5, 0.8), DVec3::new(-1.0, 0.1, -0.2)].map(DVec3::normalize) {
            assert!((rotated.direction(rotated.uv(d)) - d).length() < 1e-12);
        }
    }

    /// What falls on a surface under a uniform sky is its light; under one of light 1 + y it is 1 + 2/3 n.y; and of (3 zz - 1) a quarter
    /// is left.
    #[test]
    fn irradiance_is_that_of_the_first_orders() {
        type Of = fn(DVec3) -> f64;
        let lights: [(&str, Of, Of); 3] = [
            ("uniform", |_| 0.5, |_| 0.5),
            ("linear", |d| 1.0 + d.y, |n| 1.0 + 2.0 / 3.0 * n.y),
            ("quadratic", |d| 1.0 + 3.0 * d.z * d.z, |n| 2.0 + 0.25 * (3.0 * n.z * n.z - 1.0)),
        ];
        for (name, light, expected) in lights {
            let sky = sky(light);
            for n in [DVec3::X, DVec3::Y, DVec3::NEG_Z, DVec3::new(0.6, -0.48, 0.64)] {
                let seen = sky.irradiance(n).x / 2.0;
                // half floats have 2^-12 of their values; sums over 128 rows are off by their squared steps
                assert!((seen - expected(n)).abs() < 1e-3, "{name}, {n}: {seen}, {}", expected(n));
            }
        }
    }
}
