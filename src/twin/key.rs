//! Visibility keys: the smaller is the nearer hit, and of equal ones the smaller id.

/// The arithmetic in which a kernel variant decides: f64, or f32 where the adapter has no f64.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Real {
    F64,
    F32,
}

impl Real {
    /// Rounding of the numbers that the edge rule reads, relative: a pair of f32, or one f32.
    pub fn unit(self) -> f64 {
        match self {
            Real::F64 => 1.0 / (1u64 << 48) as f64,
            Real::F32 => 1.0 / (1u64 << 24) as f64,
        }
    }

    /// Rounding of one operation, relative.
    pub fn rounding(self) -> f64 {
        match self {
            Real::F64 => f64::EPSILON / 2.0,
            Real::F32 => f64::from(f32::EPSILON) / 2.0,
        }
    }

    /// Within this many times the bound on its distance from the ray a vertex counts as on it; none does in f32, whose
    /// coverage proves signs by itself.
    pub fn at_ray(self) -> f64 {
        match self {
            Real::F64 => 1024.0,
            Real::F32 => 0.0,
        }
    }

    /// Ordered bits of t above, id below. In f64 the id takes the place of t's lowest bits; an f32 has a word of its
    /// own.
    pub fn key(self, t: f64, id: u32, id_bits: u32) -> u64 {
        match self {
            Real::F64 => ordered((t + 0.0).to_bits(), 63) & !id_mask(id_bits) | u64::from(id),
            Real::F32 => ordered(u64::from((t as f32 + 0.0).to_bits()), 31) << 32 | u64::from(id),
        }
    }

    /// The t of a key: the middle of those that the id cut off.
    pub fn key_t(self, key: u64, id_bits: u32) -> f64 {
        match self {
            Real::F64 => {
                let mask = id_mask(id_bits);
                f64::from_bits(unordered(key & !mask | (mask ^ mask >> 1), 63))
            }
            Real::F32 => f64::from(f32::from_bits(unordered(key >> 32, 31) as u32)),
        }
    }

    /// Relative distance of two neighbouring ts that keys tell apart.
    pub fn key_step(self, id_bits: u32) -> f64 {
        match self {
            Real::F64 => f64::EPSILON * (1u64 << id_bits) as f64,
            Real::F32 => f64::from(f32::EPSILON),
        }
    }
}

pub fn key_id(key: u64, id_bits: u32) -> u32 {
    (key & id_mask(id_bits)) as u32
}

fn id_mask(id_bits: u32) -> u64 {
    (1 << id_bits) - 1
}

/// Bits such that larger numbers have larger ones; `sign` is the place of the sign bit.
fn ordered(bits: u64, sign: u32) -> u64 {
    let all = u64::MAX >> (63 - sign);
    if bits >> sign == 1 { !bits & all } else { bits | 1 << sign }
}

fn unordered(bits: u64, sign: u32) -> u64 {
    let all = u64::MAX >> (63 - sign);
    if bits >> sign & 1 == 1 { bits & (all >> 1) } else { !bits & all }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_order_by_t_then_by_id() {
        let ts = [f64::NEG_INFINITY, -1e30, -2.0, -1.0, -1e-30, 0.0, 1e-30, 1.0, 2.0, f64::INFINITY];
        for real in [Real::F64, Real::F32] {
            for pair in ts.windows(2) {
                assert!(real.key(pair[0], 7, 3) < real.key(pair[1], 0, 3), "{pair:?}");
            }
            assert!(real.key(1.0, 2, 3) < real.key(1.0, 3, 3));
            assert_eq!(real.key(-0.0, 2, 3), real.key(0.0, 2, 3));
        }
    }

    #[test]
    fn a_key_gives_back_its_id_and_its_t_within_a_step() {
        for real in [Real::F64, Real::F32] {
            for t in [-1234.567, -1.0, -0.3, 1e-20, 0.7, 1e9] {
                for id_bits in [1, 10, 28] {
                    let key = real.key(t, 1, id_bits);
                    assert_eq!(key_id(key, id_bits), 1);
                    assert!((real.key_t(key, id_bits) - t).abs() <= real.key_step(id_bits) * t.abs());
                }
            }
        }
    }
}
