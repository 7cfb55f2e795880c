//! deposit in f64: the flux of caustic triangles, as stored, by texel.

use anamorph::internals::gpu::layout::{CausticTriangle, Receiver};
use anamorph::internals::scene::caustics::shares::shares;
use glam::DVec2;

/// What one triangle brings, as parts of its flux.
#[derive(Debug, Clone, PartialEq)]
pub struct Brought {
    /// Texel among those of all receivers, and its part.
    pub list: Vec<(usize, f64)>,
    /// Beyond the border.
    pub missed: f64,
    pub is_line: bool,
}

/// Corners as stored, texels.
pub fn corners(triangle: &CausticTriangle) -> [DVec2; 3] {
    [triangle.a, triangle.b, triangle.c].map(|p| DVec2::new(f64::from(p[0]), f64::from(p[1])))
}

pub fn deposit(triangle: &CausticTriangle, receivers: &[Receiver]) -> Brought {
    let receiver = receivers[triangle.receiver as usize];
    let shares = shares(&corners(triangle), [receiver.columns, receiver.rows]);
    let list: Vec<(usize, f64)> = shares.list.iter().map(|(k, s)| (receiver.first as usize + k, *s)).collect();
    let inside: f64 = list.iter().map(|l| l.1).sum();
    Brought { list, missed: 1.0 - inside, is_line: shares.flat }
}
