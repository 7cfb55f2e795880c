//! Whether a camera's rays hang together: from layer to layer, and from piece to piece.

use super::rng::Rng;
use anamorph::internals::camera::{Camera, Pieces, Rays};
use glam::{DVec2, DVec3};
use std::collections::HashMap;

/// A point of a ray, against the size of the points that it is interpolated from: some ten products and sums of 2^-53
/// each, their weights up to 2^9 at a triangle a few pixels wide that ends a band.
pub const POINT_ROUNDING: f64 = 1.0 / (1u64 << 40) as f64;

fn close(a: DVec3, b: DVec3, size: f64) -> bool {
    (a - b).length() <= POINT_ROUNDING * size
}

/// At random places of every pixel, each layer's rays start where those of the layer before end. Returns the number of
/// places that were compared.
pub fn assert_joined(camera: &Camera, seed: u64) -> usize {
    let mut rng = Rng(seed);
    let mut compared = 0;
    for _ in 0..3 {
        let camera = camera.with_sample_offset(0.5 * rng.signed(), 0.5 * rng.signed());
        for (i, j) in (0..camera.height).flat_map(|j| (0..camera.width).map(move |i| (i, j))) {
            for layer in 1..camera.layers.len() {
                let (Some((_, a)), Some((_, b))) = (camera.curve(layer - 1, i, j), camera.curve(layer, i, j)) else {
                    continue;
                };
                let size = a.points().iter().chain(b.points()).map(|p| p.length()).fold(1.0, f64::max);
                assert!(close(a.at(1.0), b.at(0.0), size), "layer {layer} at {i},{j}: {} {}", a.at(1.0), b.at(0.0));
                compared += 1;
            }
        }
    }
    compared
}

/// At random places of every border between two pieces, both have the same ray. Returns the number of borders.
pub fn assert_seamless(camera: &Camera, seed: u64) -> usize {
    let mut rng = Rng(seed);
    camera.layers.iter().map(|layer| if let Rays::Pieces(p) = layer { seamless(p, &mut rng) } else { 0 }).sum()
}

fn seamless(pieces: &Pieces, rng: &mut Rng) -> usize {
    let mut count = 0;
    for (a, b, from, to) in borders(pieces) {
        for _ in 0..5 {
            let place = from.lerp(to, rng.unit());
            let [s, t] = [a, b].map(|k| pieces.bundle_at_place(k, place).ray(0.0, 0.0));
            let corners = |k: u32| pieces.pieces[k as usize].corners_px.unwrap();
            let ends = corners(a).into_iter().chain(corners(b)).map(|q| {
                let ray = pieces.bundle_at_place(a, q).ray(0.0, 0.0);
                ray.origin.length() + ray.direction.length()
            });
            let size = ends.fold(1.0, f64::max);
            assert!(close(s.origin, t.origin, size) && close(s.direction, t.direction, size), "{a} and {b} at {place}");
        }
        count += 1;
    }
    count
}

/// Two pieces and the border that they share.
pub fn borders(pieces: &Pieces) -> Vec<(u32, u32, DVec2, DVec2)> {
    let mut sides: HashMap<[u64; 4], (u32, DVec2, DVec2)> = HashMap::new();
    let mut found = Vec::new();
    for (k, piece) in pieces.pieces.iter().enumerate() {
        let Some(c) = piece.corners_px else { continue };
        for (a, b) in [(c[0], c[1]), (c[1], c[2]), (c[2], c[0])] {
            let (a, b) = if (a.x, a.y) < (b.x, b.y) { (a, b) } else { (b, a) };
            let key = [a.x, a.y, b.x, b.y].map(f64::to_bits);
            match sides.remove(&key) {
                Some((other, from, to)) => found.push((other, k as u32, from, to)),
                None => {
                    sides.insert(key, (k as u32, a, b));
                }
            }
        }
    }
    found
}

/// Where a curve meets another layer it goes on in the same direction: sine of the angle between them.
pub fn assert_smooth(camera: &Camera) {
    for (i, j) in (0..camera.height).flat_map(|j| (0..camera.width).map(move |i| (i, j))) {
        for layer in 1..camera.layers.len() {
            let (Some((_, a)), Some((_, b))) = (camera.curve(layer - 1, i, j), camera.curve(layer, i, j)) else {
                continue;
            };
            let (end, start) = (a.tangent(1.0), b.tangent(0.0));
            let sine = end.normalize().cross(start.normalize()).length();
            let size = a.points().iter().chain(b.points()).map(|p| p.length()).fold(1.0, f64::max);
            let bound = POINT_ROUNDING * (1.0 + size / end.length() + size / start.length());
            assert!(sine <= bound && end.dot(start) > 0.0, "layer {layer} at {i},{j}: {end} {start}, sine {sine}");
        }
    }
}
