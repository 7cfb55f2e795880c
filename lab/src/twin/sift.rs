//! sift in f64: which beams may see a point.

use anamorph::internals::gpu::layout::{Beam, NONE};

/// How wide beams are taken: each end of an origin is moved outwards by `tolerance` of it and of the point's largest
/// coordinate, quotients by the relative `quotient`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bound {
    pub tolerance: f64,
    pub quotient: f64,
}

impl Bound {
    /// What a kernel must keep: the tree in f64 has a margin of 2^-34 of the point's coordinates.
    pub const NEEDED: Bound = Bound { tolerance: 1.0 / (1u64 << 34) as f64, quotient: 0.0 };
    /// What it may keep: its tolerance is 2^-22 of both, and it rounds it four times by 2^-24; quotients have 1e-6 twice and
    /// their own rounding.
    pub const ALLOWED: Bound = Bound { tolerance: 1.0 / (1u64 << 20) as f64, quotient: 4e-6 };
}

/// The nodes listed for a point in the nodes' units, ascending.
pub fn sift(beams: &[Beam], [t0, t1]: [f32; 2], point: [f64; 3], bound: Bound) -> Vec<u32> {
    let range = [f64::from(t0), f64::from(t1)];
    let mut found = Vec::new();
    let mut k = 0;
    while let Some(beam) = beams.get(k) {
        let met = meets(beam, range, point, bound);
        if met && beam.node != NONE {
            found.push(beam.node);
        }
        k = if met && beam.node == NONE { k + 1 } else { beam.next as usize };
    }
    found
}

/// Some t of the range brings a ray of the beam to the point.
fn meets(beam: &Beam, [t0, t1]: [f64; 2], x: [f64; 3], bound: Bound) -> bool {
    let half = |s: f64, mut lo: f64, mut hi: f64| {
        let size = x.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        for k in 0..3 {
            let [p_lo, p_hi, d_lo, d_hi] = [beam.p_lo, beam.p_hi, beam.d_lo, beam.d_hi].map(|v| f64::from(v[k]));
            let (d_lo, d_hi) = if s > 0.0 { (d_lo, d_hi) } else { (-d_hi, -d_lo) };
            let margin = |p: f64| bound.tolerance * (size + p.abs());
            // t d_lo <= x - p_lo and t d_hi >= x - p_hi
            for (a, b) in [(d_lo, x[k] - p_lo + margin(p_lo)), (-d_hi, p_hi - x[k] + margin(p_hi))] {
                match a {
                    _ if a > 0.0 => hi = hi.min(b / a),
                    _ if a < 0.0 => lo = lo.max(b / a),
                    _ if b < 0.0 => return false,
                    _ => {}
                }
            }
        }
        lo * (1.0 - bound.quotient) <= hi * (1.0 + bound.quotient)
    };
    (t1 >= 0.0 && half(1.0, t0.max(0.0), t1)) || (t0 < 0.0 && half(-1.0, (-t1).max(0.0), -t0))
}
