//! meet in f64: the nearest smooth surface that a pixel's ray meets.

use super::raster::Visibility;
use super::smooth::{Part, Root};
use super::{KernelInputs, Real};
use rayon::prelude::*;

/// Merges what each pixel's ray meets; nothing but where the surface is smooth.
pub fn meet(input: &KernelInputs, real: Real, visibility: &mut Visibility) {
    let keys = input.keys(real);
    let pixels = input.params.width * input.params.height;
    let met: Vec<_> = (0..pixels).into_par_iter().map(|pixel| meetings(input, pixel, real)).collect();
    for (pixel, meetings) in met.iter().enumerate() {
        visibility.uncertain[pixel] |= meetings.iter().any(|m| m.1.uncertain);
        for (id, root) in meetings {
            if let Some(t) = root.t {
                visibility.merge(pixel, !keys.key(0, t.v, *id));
            }
        }
    }
}

/// Every part of the surface that the pixel's ray meets, or may meet, by its id.
pub fn meetings(input: &KernelInputs, pixel: u32, real: Real) -> Vec<(u32, Root)> {
    let Some(optics) = &input.optics else { return Vec::new() };
    if !optics.surface.is_smooth() {
        return Vec::new();
    }
    let (x, y) = (pixel % input.params.width, pixel / input.params.width);
    let (true, Some(ray)) = (optics.is_seen(), input.bounded_ray(x, y, real)) else { return Vec::new() };
    let root = |number: u32| {
        let id = optics.optic.first_id + number;
        let starts = optics.paths[pixel as usize].last == id;
        (id, Part { surface: optics.surface, number }.first_root(&ray, starts, &input.params, real))
    };
    let roots = (0..optics.optic.count).map(root);
    roots.filter(|(_, root)| root.t.is_some() || root.uncertain).collect()
}
