//! Where rays meet smooth surfaces and how they bounce there, with bounds on the values that a kernel computes.

use super::bounded::{Bounded, Bounded3};
use super::refract::{Bent, BouncedRay, BoundedRay, bent_at};
use super::{Real, quadric, torus, wave};
use anamorph::internals::engine::surface::OpticsSurface;
use anamorph::internals::gpu::layout::{Optic, Params};

/// Where a ray first meets a surface.
#[derive(Debug, Clone, Copy)]
pub struct Root {
    pub t: Option<Bounded>,
    /// Another correct evaluation finds none, or finds one, where this one does not; or another root.
    pub uncertain: bool,
}

impl Root {
    pub const NONE: Root = Root { t: None, uncertain: false };
}

/// One part of a smooth surface.
#[derive(Clone, Copy)]
pub struct Part<'a> {
    pub surface: &'a OpticsSurface,
    pub number: u32,
}

impl Part<'_> {
    /// Where the ray first meets it at a t in range; of a ray that starts on it, another place.
    pub fn first_root(&self, ray: &BoundedRay, starts: bool, params: &Params, real: Real) -> Root {
        let zero = Bounded::exact(0.0, real);
        let end = |t: [f32; 4]| t.iter().fold(zero, |sum, part| sum + Bounded::exact(f64::from(*part), real));
        let range = [end(params.t_min), end(params.t_max)];
        match self.surface {
            OpticsSurface::Corners(_) => Root::NONE,
            OpticsSurface::Quadrics(list) => quadric::first_root(&list[self.number as usize], ray, starts, range, real),
            OpticsSurface::Torus(torus) => torus::first_root(torus, ray, starts, range, real),
            OpticsSurface::Wave(wave) => wave::first_root(wave, ray, starts, range, real),
        }
    }

    /// At `place`, of any length; points out.
    fn normal(&self, place: Bounded3, real: Real) -> Bounded3 {
        match self.surface {
            // facets have a law of their own
            OpticsSurface::Corners(_) => place.lost(),
            OpticsSurface::Quadrics(list) => quadric::normal(&list[self.number as usize], place, real),
            OpticsSurface::Torus(torus) => torus::normal(torus, place, real),
            OpticsSurface::Wave(wave) => wave::normal(wave, place, real),
        }
    }

    /// The ray that leaves the point where `ray` meets the surface.
    pub fn bounce(&self, optic: &Optic, ray: &BoundedRay, starts: bool, params: &Params, real: Real) -> BouncedRay {
        let root = self.first_root(ray, starts, params, real);
        let t = root.t.filter(|_| !root.uncertain).unwrap_or(Bounded::exact(0.0, real).lost());
        let place = ray.p + ray.d * t;
        let normal = self.normal(place, real);
        let Bent { d, share, .. } = bent_at(optic, ray.d.unit(), normal, normal, real);
        BouncedRay { place, d, share }
    }
}
