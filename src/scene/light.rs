//! Lights, and what hides them.

use glam::DVec3;

/// Share of the light that comes from everywhere alike.
pub const AMBIENT: f32 = 0.1;

/// A light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Light {
    pub source: Source,
    /// Linear RGB: irradiance over pi, where it falls straight on.
    pub colour: [f32; 3],
    /// Triangles in the way hide it.
    pub casts_shadows: bool,
}

/// Where light comes from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Source {
    /// The unit way that the light travels, everywhere.
    Distant(DVec3),
    /// A place, and how far from there the light has its colour: it falls off with the square of the distance.
    Point { position: DVec3, distance: f64 },
}

/// How light from all around is hidden by what is near: the directions that are looked along, and how far, world units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AmbientOcclusion {
    pub rays: u32,
    pub reach: f64,
}

/// Light at a place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Arriving {
    /// The unit way to where it comes from.
    pub way: DVec3,
    /// How far that is.
    pub far: f64,
    /// Irradiance over pi of what it falls on straight.
    pub strength: DVec3,
}

impl Light {
    /// White light from far away, which travels this way and shines through everything.
    pub fn distant(travel: DVec3) -> Light {
        Light { source: Source::Distant(travel.normalize()), colour: [1.0; 3], casts_shadows: false }
    }

    pub fn is_plain(&self) -> bool {
        matches!(self.source, Source::Distant(_)) && self.colour == [1.0; 3] && !self.casts_shadows
    }

    /// What arrives at `p` where nothing is in the way.
    pub fn arriving(&self, p: DVec3) -> Arriving {
        let colour = DVec3::from(self.colour.map(f64::from));
        match self.source {
            Source::Distant(travel) => Arriving { way: -travel, far: f64::MAX, strength: colour },
            Source::Point { position, distance } => {
                let way = position - p;
                let square = way.length_squared().max(1e-30);
                Arriving {
                    way: way / square.sqrt(),
                    far: square.sqrt(),
                    strength: distance * distance / square * colour,
                }
            }
        }
    }
}

impl AmbientOcclusion {
    /// Directions by their cosine about +z: a spiral of Fibonacci's on the disc below them.
    pub fn directions(&self) -> impl Iterator<Item = DVec3> {
        let count = f64::from(self.rays);
        let turn = std::f64::consts::PI * (3.0 - 5f64.sqrt());
        (0..self.rays).map(move |k| {
            let square = (f64::from(k) + 0.5) / count;
            let (sin, cos) = (turn * f64::from(k)).sin_cos();
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
        assert_eq!((near.way, near.far, near.strength), (DVec3::Y, 3.0, DVec3::new(1.0, 0.5, 0.0)));
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
