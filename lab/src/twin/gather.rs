//! gather in f64: the light that the receivers' maps, as stored, add to a pixel.

use anamorph::internals::gpu::layout::{Receiver, ReceiverTriangle};
use glam::DVec2;

/// Where on its receiver's map a hit with these weights of its second and third corner lies, texels.
pub fn place(receiver_triangle: &ReceiverTriangle, weights: [f32; 2]) -> DVec2 {
    let v = |v: [f32; 2]| DVec2::new(f64::from(v[0]), f64::from(v[1]));
    v(receiver_triangle.a)
        + f64::from(weights[0]) * v(receiver_triangle.ab)
        + f64::from(weights[1]) * v(receiver_triangle.ac)
}

/// Units in the sums of a texel among those of all receivers.
pub fn units(sums: &[u32], texel: usize) -> [f64; 3] {
    [0, 2, 4].map(|k| {
        let word = |k: usize| u64::from(sums[6 * texel + k]);
        (word(k) | word(k + 1) << 32) as f64
    })
}

/// The diffuse reflection of the flux at a place, linear RGB; 0 outside the map.
pub fn gather(receiver_triangle: &ReceiverTriangle, receiver: &Receiver, sums: &[u32], place: DVec2) -> [f64; 3] {
    let size = DVec2::new(receiver.columns.into(), receiver.rows.into());
    if place.cmplt(DVec2::ZERO).any() || place.cmpgt(size).any() {
        return [0.0; 3];
    }
    let p = (place - 0.5).clamp(DVec2::ZERO, size - 1.0);
    let next = (p.floor() + 1.0).min(size - 1.0);
    let mut light = [0.0; 3];
    for (x, s) in [(p.x.floor(), 1.0 - p.x.fract()), (next.x, p.x.fract())] {
        for (y, t) in [(p.y.floor(), 1.0 - p.y.fract()), (next.y, p.y.fract())] {
            let texel = receiver.first as usize + y as usize * receiver.columns as usize + x as usize;
            let units = units(sums, texel);
            for k in 0..3 {
                light[k] += s * t * units[k] * f64::from(receiver.scale) * f64::from(receiver_triangle.diffuse[k]);
            }
        }
    }
    light
}
