//! bounce in f64: the ray that leaves the point where a pixel's ray meets the optics.

use super::bounded::{Bounded, Bounded3};
use super::raster::Visibility;
use super::refract::{BouncedRay, at_facet};
use super::smooth::Part;
use super::{KernelInputs, Real};
use anamorph::internals::engine::plan::curves::RayTable;
use anamorph::internals::engine::surface::OpticsSurface;
use anamorph::internals::gpu::layout::{NONE, PathState, split2};
use rayon::prelude::*;

/// A bounced ray and the state of its path.
#[derive(Debug, Clone, Copy)]
pub struct Bounced {
    pub ray: BouncedRay,
    pub path: PathState,
    /// Bound on the error of the path's length, world units.
    pub length_error: f64,
}

/// Rounding of one f32 operation, relative.
const UNIT: f64 = f32::EPSILON as f64 / 2.0;

/// Maximum squared length of a direction.
const SIZE_MAX: f64 = 65536.0;

/// One result per pixel of the band, row by row; `None` where the ray misses the optics.
pub fn bounce(input: &KernelInputs, visibility: &Visibility, real: Real) -> Vec<Option<Bounced>> {
    let pixels = input.params.width * input.params.height;
    let at = |pixel: u32| bounce_pixel(input, visibility.key(pixel as usize)?, pixel, real);
    (0..pixels).into_par_iter().map(at).collect()
}

fn bounce_pixel(input: &KernelInputs, key: u64, pixel: u32, real: Real) -> Option<Bounced> {
    let optics = input.optics.as_ref()?;
    // the next bounce holds the law
    let optic = &optics.next?;
    let id = input.keys(real).id(key);
    let surface = id.checked_sub(optic.first_id)?;
    let ray = input.bounded_ray(pixel % input.params.width, pixel / input.params.width, real)?;
    let path = &optics.paths[pixel as usize];
    let mut bounced = match optics.surface {
        OpticsSurface::Corners(corners) => at_facet(optic, &corners[3 * surface as usize..][..3], &ray, real),
        smooth => Part { surface: smooth, number: surface }.bounce(optic, &ray, path.last == id, &input.params, real),
    };
    let size = bounced.d.value().length_squared();
    if !(size > 0.0 && size < SIZE_MAX) {
        bounced.d = Bounded3([Bounded::exact(0.0, real); 3]);
    }
    let before = Bounded::exact(f64::from(path.length), real);
    let length = before + (bounced.place - ray.p).norm();
    let path = PathState {
        light: [0, 1, 2].map(|k| path.light[k] * optic.tint[k] * optic.scale * bounced.share.v as f32),
        length: length.v as f32,
        first: if path.first == NONE { surface } else { path.first },
        last: id,
        piece: if path.first == NONE { optics.piece_of(surface) } else { path.piece },
        pad0: 0,
    };
    if optic.is_environment == 1 {
        bounced.place = Bounded3::pair(optic.from_hi, optic.from_lo, real);
    }
    // roundings: of the new segment to f32, of the sum, and of this f64 value
    Some(Bounced { ray: bounced, path, length_error: length.e + 3.0 * UNIT * length.v })
}

/// The rays as the next bounce reads them: one column and row more than the band, without rays.
pub fn table(input: &KernelInputs, bounced: &[Option<Bounced>]) -> RayTable {
    let (width, height) = (input.params.width as usize, input.params.height as usize);
    let numbers = 6 * (width + 1) * (height + 1);
    let mut table = RayTable { hi: vec![0.0; numbers], lo: vec![0.0; numbers] };
    for (pixel, bounced) in bounced.iter().enumerate() {
        let Some(Bounced { ray: BouncedRay { place, d, .. }, .. }) = bounced else { continue };
        let at = 6 * (pixel / width * (width + 1) + pixel % width);
        for (k, [hi, lo]) in [place, d].iter().flat_map(|v: &&Bounded3| v.0).map(|n| split2(n.v)).enumerate() {
            (table.hi[at + k], table.lo[at + k]) = (hi, lo);
        }
    }
    table
}
