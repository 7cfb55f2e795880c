//! Visibility keys: the smaller is the nearer hit, and of equal ones the smaller id.

/// The arithmetic in which a kernel variant decides: f64, or f32 alone.
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
}

/// How a frame's keys are laid out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct KeyLayout {
    pub real: Real,
    /// Low bits that hold the triangle id.
    pub id_bits: u32,
    /// Whether the layer is in the top 4 bits.
    pub slabbed: bool,
}

impl KeyLayout {
    /// Ordered bits of t above, id below. In f64 the id takes the place of t's lowest bits; an f32 has a word of its
    /// own. With slabs t is in [0, 1], whose ordered bits begin with 10: the layer takes the place of these.
    pub fn key(self, layer: u32, t: f64, id: u32) -> u64 {
        let mut bits = match self.real {
            Real::F64 => ordered((t + 0.0).to_bits(), 63),
            Real::F32 => ordered(u64::from((t as f32 + 0.0).to_bits()), 31) << 32,
        };
        if self.slabbed {
            bits = (bits << 2 >> 4) | u64::from(layer) << 60;
        }
        bits & !self.id_mask() | u64::from(id)
    }

    pub fn layer(self, key: u64) -> u32 {
        if self.slabbed { (key >> 60) as u32 } else { 0 }
    }

    /// The t of a key: the middle of those that the id cut off.
    pub fn t(self, key: u64) -> f64 {
        let mask = self.id_mask();
        let mut bits = key & !mask | (mask ^ mask >> 1);
        if self.slabbed {
            bits = bits << 4 >> 2 | 1 << 63;
        }
        match self.real {
            Real::F64 => f64::from_bits(unordered(bits, 63)),
            Real::F32 => f64::from(f32::from_bits(unordered(bits >> 32, 31) as u32)),
        }
    }

    pub fn id(self, key: u64) -> u32 {
        (key & self.id_mask()) as u32
    }

    /// Relative distance of neighbouring values of t that keys distinguish.
    pub fn step(self) -> f64 {
        match self.real {
            Real::F64 => f64::EPSILON * (1u64 << (self.id_bits + if self.slabbed { 2 } else { 0 })) as f64,
            Real::F32 => f64::from(f32::EPSILON),
        }
    }

    fn id_mask(self) -> u64 {
        (1 << self.id_bits) - 1
    }
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

    fn layout(real: Real, id_bits: u32) -> KeyLayout {
        KeyLayout { real, id_bits, slabbed: false }
    }

    #[test]
    fn keys_order_by_t_then_by_id() {
        let ts = [f64::NEG_INFINITY, -1e30, -2.0, -1.0, -1e-30, 0.0, 1e-30, 1.0, 2.0, f64::INFINITY];
        for real in [Real::F64, Real::F32] {
            let layout = layout(real, 3);
            for pair in ts.windows(2) {
                assert!(layout.key(0, pair[0], 7) < layout.key(0, pair[1], 0), "{pair:?}");
            }
            assert!(layout.key(0, 1.0, 2) < layout.key(0, 1.0, 3));
            assert_eq!(layout.key(0, -0.0, 2), layout.key(0, 0.0, 2));
        }
    }

    #[test]
    fn keys_with_slabs_order_by_layer_first() {
        for real in [Real::F64, Real::F32] {
            let layout = KeyLayout { slabbed: true, ..layout(real, 3) };
            let hits = [(0, 0.0), (0, 1e-30), (0, 0.5), (0, 1.0), (1, 0.0), (1, 1.0), (15, 0.0), (15, 1.0)];
            for pair in hits.windows(2) {
                assert!(layout.key(pair[0].0, pair[0].1, 7) < layout.key(pair[1].0, pair[1].1, 0), "{pair:?}");
            }
            for (layer, t) in hits {
                let key = layout.key(layer, t, 5);
                assert_eq!((layout.layer(key), layout.id(key)), (layer, 5));
                assert!((layout.t(key) - t).abs() <= layout.step() * t.max(1e-30), "{layer} {t}");
            }
        }
    }

    #[test]
    fn a_key_gives_back_its_id_and_its_t_within_a_step() {
        for real in [Real::F64, Real::F32] {
            for t in [-1234.567, -1.0, -0.3, 1e-20, 0.7, 1e9] {
                for id_bits in [1, 10, 28] {
                    let layout = layout(real, id_bits);
                    let key = layout.key(0, t, 1);
                    assert_eq!((layout.id(key), layout.layer(key)), (1, 0));
                    assert!((layout.t(key) - t).abs() <= layout.step() * t.abs());
                }
            }
        }
    }
}
