//! bounce in f64: the ray that goes on from where a pixel's ray meets the optics.

use super::bounded::{Bounded, Near3};
use super::raster::Visibility;
use super::smooth::Part;
use super::turn::{Turned, at_facet};
use super::{Input, Real};
use crate::engine::plan::curves::RayTable;
use crate::engine::surface::SurfaceRows;
use crate::gpu::layout::{NONE, PathState, split2};
use rayon::prelude::*;

/// A ray that was turned, and what lies behind it.
#[derive(Debug, Clone, Copy)]
pub struct Bounced {
    pub turned: Turned,
    pub way: PathState,
    /// How far the way's length may be off.
    pub length_error: f64,
}

/// Rounding of one f32 operation, relative.
const UNIT: f64 = f32::EPSILON as f64 / 2.0;

/// Squared length of a direction at most.
const SIZE_MAX: f64 = 65536.0;

/// Of every pixel of the band; nothing where the ray meets no surface of the optics.
pub fn bounce(input: &Input, visibility: &Visibility, real: Real) -> Vec<Option<Bounced>> {
    let pixels = input.params.width * input.params.height;
    let at = |pixel: u32| bounce_pixel(input, visibility.key(pixel as usize)?, pixel, real);
    (0..pixels).into_par_iter().map(at).collect()
}

fn bounce_pixel(input: &Input, key: u64, pixel: u32, real: Real) -> Option<Bounced> {
    let optics = input.optics.as_ref()?;
    // the pass that comes says how
    let optic = &optics.next?;
    let id = input.keys(real).id(key);
    let surface = id.checked_sub(optic.first_id)?;
    let ray = input.near_ray(pixel % input.params.width, pixel / input.params.width, real)?;
    let way = &optics.ways[pixel as usize];
    let mut turned = match optics.surface {
        SurfaceRows::Corners(corners) => at_facet(optic, &corners[3 * surface as usize..][..3], &ray, real),
        rows => Part { rows, number: surface }.turn(optic, &ray, way.last == id, &input.params, real),
    };
    let size = turned.d.value().length_squared();
    if !(size > 0.0 && size < SIZE_MAX) {
        turned.d = Near3([Bounded::exact(0.0, real); 3]);
    }
    let before = Bounded::exact(f64::from(way.length), real);
    let length = before + (turned.place - ray.p).norm();
    let way = PathState {
        light: [0, 1, 2].map(|k| way.light[k] * optic.tint[k] * optic.scale * turned.share.v as f32),
        length: length.v as f32,
        first: if way.first == NONE { surface } else { way.first },
        last: id,
        camera: if way.first == NONE { optics.camera_of(surface) } else { way.camera },
        pad0: 0,
    };
    if optic.is_environment == 1 {
        turned.place = Near3::pair(optic.from_hi, optic.from_lo, real);
    }
    // the last part rounded to f32, and the sum; this one's own rounding
    Some(Bounced { turned, way, length_error: length.e + 3.0 * UNIT * length.v })
}

/// The rays as the next pass reads them: one column and row more than the band, without rays.
pub fn table(input: &Input, bounced: &[Option<Bounced>]) -> RayTable {
    let (width, height) = (input.params.width as usize, input.params.height as usize);
    let numbers = 6 * (width + 1) * (height + 1);
    let mut table = RayTable { hi: vec![0.0; numbers], lo: vec![0.0; numbers] };
    for (pixel, bounced) in bounced.iter().enumerate() {
        let Some(Bounced { turned: Turned { place, d, .. }, .. }) = bounced else { continue };
        let at = 6 * (pixel / width * (width + 1) + pixel % width);
        for (k, [hi, lo]) in [place, d].iter().flat_map(|v: &&Near3| v.0).map(|n| split2(n.v)).enumerate() {
            (table.hi[at + k], table.lo[at + k]) = (hi, lo);
        }
    }
    table
}
