//! Lights and ambient occlusion.

use crate::arrays::MapEach;
use glam::DVec3;

/// Share of ambient light.
pub const AMBIENT: f32 = 0.1;

/// A light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Light {
    pub source: Source,
    /// Linear RGB irradiance over pi, at normal incidence.
    pub colour: [f32; 3],
    /// Whether triangles cast shadows.
    pub casts_shadows: bool,
}

/// Position of a light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Source {
    /// Distant: unit direction in which the light travels.
    Distant(DVec3),
    /// Point light: position, and the distance at which it has its colour; inverse-square falloff.
    Point { position: DVec3, distance: f64 },
}

/// Ambient occlusion: number of directions, and maximum distance, world units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AmbientOcclusion {
    pub rays: u32,
    pub reach: f64,
}

/// Light at a place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Arriving {
    /// Unit direction to the light.
    pub to_light: DVec3,
    /// Distance to the light, world units.
    pub far: f64,
    /// Irradiance over pi at normal incidence.
    pub strength: DVec3,
}

impl Light {
    /// A white distant light with this direction of travel and without shadows.
    pub fn distant(travel: DVec3) -> Light {
        Light { source: Source::Distant(travel.normalize()), colour: [1.0; 3], casts_shadows: false }
    }

    pub fn is_plain(&self) -> bool {
        matches!(self.source, Source::Distant(_)) && self.colour == [1.0; 3] && !self.casts_shadows
    }

    /// The unshadowed light at `p`.
    pub fn arriving(&self, p: DVec3) -> Arriving {
        let colour = DVec3::from(self.colour.map_each(f64::from));
        match self.source {
            Source::Distant(travel) => Arriving { to_light: -travel, far: f64::MAX, strength: colour },
            Source::Point { position, distance } => {
                let to_light = position - p;
                let square = to_light.length_squared().max(1e-30);
                Arriving {
                    to_light: to_light / square.sqrt(),
                    far: square.sqrt(),
                    strength: distance * distance / square * colour,
                }
            }
        }
    }
}

impl AmbientOcclusion {
    /// Cosine-weighted directions about +z: a Fibonacci spiral projected from the unit disc.
    pub fn directions(&self) -> impl Iterator<Item = DVec3> {
        let count = f64::from(self.rays);
        let golden_angle = std::f64::consts::PI * (3.0 - 5f64.sqrt());
        (0..self.rays).map(move |k| {
            let square = (f64::from(k) + 0.5) / count;
            let (sin, cos) = (golden_angle * f64::from(k)).sin_cos();
            DVec3::new(square.sqrt() * cos, square.sqrt() * sin, (1.0 - square).sqrt())
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_light_falls_off_by_the_square() {
        let source = Source::Point { position: DVec3::new(0.0, 3.0, 0.0), distance: 3.0 };
        let light = Light { source, colour: [1.0, 0.5, 0.0], casts_shadows: true };
        let near = light.arriving(DVec3::ZERO);
        assert_eq!((near.to_light, near.far, near.strength), (DVec3::Y, 3.0, DVec3::new(1.0, 0.5, 0.0)));
        assert_eq!(light.arriving(DVec3::new(0.0, -3.0, 0.0)).strength, DVec3::new(0.25, 0.125, 0.0));
        assert!(light.arriving(DVec3::new(0.0, 3.0, 0.0)).strength.is_finite());
    }

    /// Their mean is that of a cosine lobe: 2/3 along the normal, and nothing across it.
    #[test]
    fn directions_are_as_dense_as_their_cosine() {
        for rays in [16, 64, 256] {
            let occlusion = AmbientOcclusion { rays, reach: 1.0 };
            let sum: DVec3 = occlusion.directions().sum();
            let mean = sum / f64::from(rays);
            assert!((mean - 2.0 / 3.0 * DVec3::Z).length() < 1.0 / f64::from(rays), "{rays}: {mean}");
        }
    }
}
