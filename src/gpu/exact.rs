//! Operations on f64 that kernels need without rounding, tested on an adapter when it is opened.
//!
//! No kernel takes the error of a sum or product of floats by further floats, as a driver may take these in another order, or at once.
//! Exact are f64 of pairs of f32, products of them, and what is done by the bits of numbers: signs of differences of products, and the
//! way back to pairs.

use super::Gpu;
use super::buffers::{Buffers, Pipeline};
use super::device::label;
use super::kernels::Kernel;
use super::single::{run, words};
use crate::arrays::MapEach;
use crate::input::{Error, Result};

/// What is compared, with the words of a case where it stands.
const FOUND: [(&str, std::ops::Range<usize>); 4] = [
    ("the sum of a pair", 0..2),
    ("the product of a pair", 2..4),
    ("the split into a pair", 4..6),
    ("the sign of a difference of products", 6..7),
];

/// Words of a case, given and found.
const CASE_WORDS: usize = 8;

struct Case {
    /// Summed and multiplied.
    pair: [f32; 2],
    /// Split.
    number: f64,
    /// Whose product is compared with 1.
    factors: [f64; 2],
}

/// Ulps of 1.
const ULP: f64 = f64::EPSILON;
const ULP_F32: f32 = f32::EPSILON;

/// Sums and products of up to 50 bits, ties of the split, and factors whose product rounds to 1. Both parts of a split have 24 bits at
/// most: drivers may round the conversion to f32 as they like.
const CASES: [Case; 5] = [
    Case { pair: [1.0 + ULP_F32, ULP_F32 / 3.0], number: 1.0 + ULP, factors: [1.0 + ULP, 1.0 - ULP] },
    // 2^102 + 1 = (2^51 - 2^26 + 1) (2^51 + 2^26 + 1)
    Case {
        pair: [-1.0 - ULP_F32, 1.0 - ULP_F32 / 2.0],
        number: 1.0 + 1.5 * ULP_F32 as f64,
        factors: [2251799746576385.0, 2251799880794113.0 * 4.0 * ULP * ULP],
    },
    Case { pair: [16777215.0, 0.2499999], number: -3.0 - ULP_F32 as f64 + 128.0 * ULP, factors: [-3.0, -1.0 / 3.0] },
    Case { pair: [1e20, -3e12], number: -562949953421312.0 - 5.125, factors: [-1.0, 1.0 + ULP] },
    Case { pair: [PI_HI, PI_LO], number: PI_HI as f64 + PI_LO as f64, factors: [0.5, 2.0] },
];

/// Pi in 48 bits.
const PI_HI: f32 = std::f32::consts::PI;
const PI_LO: f32 = (std::f64::consts::PI - PI_HI as f64) as f32;

impl Case {
    fn given(&self) -> [u32; CASE_WORDS] {
        let [x, y] = self.pair.map_each(f32::to_bits);
        let [number, a, b] = [self.number, self.factors[0], self.factors[1]].map_each(words_of);
        [x, y, number[0], number[1], a[0], a[1], b[0], b[1]]
    }

    /// The CPU's answer.
    fn expected(&self) -> [u32; CASE_WORDS] {
        let [x, y] = self.pair.map_each(f64::from);
        let (sum, product) = (words_of(x + y), words_of(x * y));
        let head = nearest_f32(self.number);
        let rest = (self.number - f64::from(head)) as f32;
        // fused, it has the sign of the exact difference
        let beyond_1 = self.factors[0].mul_add(self.factors[1], -1.0);
        let order = i32::from(beyond_1 > 0.0) - i32::from(beyond_1 < 0.0);
        [sum[0], sum[1], product[0], product[1], head.to_bits(), rest.to_bits(), order as u32, 0]
    }
}

/// Low word first.
fn words_of(v: f64) -> [u32; 2] {
    [v.to_bits() as u32, (v.to_bits() >> 32) as u32]
}

/// Ties away from 0, as the kernels round.
fn nearest_f32(v: f64) -> f32 {
    const BELOW_F32: u64 = (1 << 29) - 1;
    f64::from_bits((v.to_bits() + (1 << 28)) & !BELOW_F32) as f32
}

/// What the adapter gets wrong of [`FOUND`], if anything; with f64 in words where it has none of its own.
///
/// # Errors
/// [`Error::Work`] if the device fails.
pub fn wrong(gpu: &Gpu) -> Result<Option<&'static str>> {
    let mut buffers = Buffers::default();
    buffers.upload(gpu, "given", &CASES.map(|case| case.given()))?;
    buffers.create(gpu, "found", (4 * CASE_WORDS * CASES.len()) as u64, wgpu::BufferUsages::empty())?;
    run(gpu, "exact", &Pipeline::new(gpu, Kernel::alone("control/exact.wgsl"))?, &buffers, 1)?;
    let found = buffers.get("found").map(|found| words(gpu, found)).transpose()?.unwrap_or_default();
    let is_right = |words: &std::ops::Range<usize>| {
        let found = found.chunks(CASE_WORDS);
        CASES.iter().zip(found).all(|(case, found)| case.expected()[words.clone()] == found[words.clone()])
    };
    Ok(FOUND.iter().find(|(_, words)| !is_right(words)).map(|(what, _)| *what))
}

/// Turns the adapter's own f64 off if it is wrong.
///
/// # Errors
/// [`Error::Work`] if f64 in 32-bit words is wrong too, or the device fails.
pub fn check(gpu: &mut Gpu) -> Result<()> {
    if gpu.has.f64 {
        if wrong(gpu)?.is_none() {
            return Ok(());
        }
        (gpu.has.f64, gpu.has.f64_is_wrong) = (false, true);
    }
    match wrong(gpu)? {
        None => Ok(()),
        Some(what) => {
            Err(Error::work(format!("adapter {}: {what} is wrong; use --engine reference", label(&gpu.info))))
        }
    }
}

#[test]
fn cases_are_exact_by_the_cpu_too() {
    let mut orders = Vec::new();
    for case in &CASES {
        let [x, y] = case.pair.map(f64::from);
        // the error of a sum after Knuth, that of a product by a fused one
        let (sum, product) = (x + y, x * y);
        let part = sum - x;
        assert_eq!(((x - (sum - part)) + (y - part), x.mul_add(y, -product)), (0.0, 0.0), "{:?}", case.pair);
        let [_, _, _, _, head, rest, order, _] = case.expected();
        let split = [head, rest].map(|w| f64::from(f32::from_bits(w)));
        assert_eq!(split[0] + split[1], case.number);
        orders.push(order as i32);
    }
    assert_eq!(orders, [-1, 1, -1, -1, 0]);
}
