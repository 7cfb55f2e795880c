//! Where curves meet a plane by the kernels, against exact arithmetic: none is missed, none is false, and the first is found.
//!
//! A picture of one large triangle in the plane z = 0, in which every pixel's curve has the z of a polynomial of its own.

use crate::common;
use crate::exact;

use anamorph::internals::camera::curve::{Curve, CurveMap, Curves};
use anamorph::internals::camera::{Camera, Rays};
use anamorph::internals::engine::RunOptions;
use anamorph::internals::engine::plan::Wanted;
use anamorph::internals::gpu::layout::split2;
use anamorph::internals::image::frame::{Channel, NO_ID};
use common::gpu::{Without, engine};
use exact::{Powers, Rng, beyond, count, polynomial};
use glam::DVec3;
use std::sync::Arc;

const SIDE: u32 = 100;

/// How far the corners of the triangle lie from where the curves are, the sum of their components.
const REACH: f64 = 8.0;

/// What the kernel takes for 0 is 16 units of 2^-48 of the vertices' and control points' sizes, twice for what it has lost of a value.
const ZERO: f64 = 2.0 * 16.0 / (1u64 << 48) as f64;

/// t of a visibility key is off by 2^-24, and by as much as f32.
const T_ROUNDING: f64 = 4.0 / (1u64 << 24) as f64;

#[derive(Debug)]
struct Polynomials {
    degree: usize,
    all: Vec<Vec<f64>>,
}

impl CurveMap for Polynomials {
    fn degree(&self) -> usize {
        self.degree
    }

    /// From side to side as they go, so that none stands still.
    fn curve(&self, a: f64, b: f64) -> Option<(u32, Curve)> {
        let [i, j] = [a, b].map(|x| (x * f64::from(SIDE)) as usize);
        let c = &self.all[j * SIDE as usize + i];
        let point = |(k, z): (usize, &f64)| DVec3::new(k as f64 / self.degree as f64, 0.0, *z);
        Some((0, Curve::new(&c.iter().enumerate().map(point).collect::<Vec<_>>())))
    }
}

/// As the kernels hold it: a sum of two f32.
fn stored(c: f64) -> f64 {
    split2(c).iter().map(|part| f64::from(*part)).sum()
}

fn zero_of(c: &[f64]) -> f64 {
    ZERO * (REACH + 1.0 + c.iter().fold(0.0f64, |m, c| m.max(c.abs())))
}

/// It comes nearer to 0 than `zero`, or passes it, between two places.
fn is_zero_between(c: &[f64], zero: f64, [a, b]: [f64; 2]) -> bool {
    let [a, b] = [a, b].map(exact::Dyadic::of);
    let negative: Vec<f64> = c.iter().map(|c| -c).collect();
    let below = |c: &[f64]| Powers::new(c, zero).is_above_between(&a, &b);
    below(c) && below(&negative)
}

/// What is wrong with the first root that was found, in a line.
fn fault(c: &[f64], found: Option<f64>) -> Option<String> {
    let zero = zero_of(c);
    let before = found.map_or(1.0, |t| (t - T_ROUNDING).max(0.0));
    if before > 0.0 && beyond(c, zero, 0.0, before) == [true, true] {
        return Some(format!("a root is missed before {before}"));
    }
    let t = found?;
    let around = [(t - T_ROUNDING).max(0.0), (t + T_ROUNDING).min(1.0)];
    (!is_zero_between(c, zero, around)).then(|| format!("{t} is no root"))
}

/// As many polynomials of degree 1, 2 and 3 as fill a picture.
fn polynomials(rng: &mut Rng, degree: usize) -> Vec<Vec<f64>> {
    let mut all = Vec::new();
    while all.len() < (SIDE * SIDE) as usize {
        let c: Vec<f64> = polynomial(rng).into_iter().map(stored).collect();
        if c.len() == degree + 1 && c.iter().all(|c| c.abs() < 1e6) {
            all.push(c);
        }
    }
    all
}

#[test]
fn the_first_root_is_found_and_no_other() {
    let corner = |x: f64, y: f64| DVec3::new(x, y, 0.0);
    let corners = vec![corner(-4.0, -3.0), corner(5.0, -3.0), corner(0.5, 6.0)];
    let scene = common::scene(common::mesh(corners, vec![[0, 1, 2]]));
    let wanted = Wanted::of(vec![Channel::T, Channel::TriangleId]);
    let rounds = count().div_ceil(u64::from(3 * SIDE * SIDE));
    let mut hits = 0;
    for (round, degree) in (0..rounds).flat_map(|round| [1, 2, 3].map(|degree| (round, degree))) {
        let all = polynomials(&mut Rng(1000 * round + degree as u64), degree);
        let map = Arc::new(Polynomials { degree, all: all.clone() });
        let curves = Rays::Curves(Curves::new(SIDE, SIDE, map));
        let camera = Camera::of("projector", (SIDE, SIDE), [0.0, 1.0], curves);
        let Some(mut engine) = engine(&camera, Without::Nothing) else { return };
        let frame = engine.render(&scene, &camera, &wanted, &RunOptions::default()).unwrap().frame;
        let (ids, ts) = (frame.u32(Channel::TriangleId).unwrap(), frame.f32(Channel::T).unwrap());
        for ((c, id), t) in all.iter().zip(ids).zip(ts) {
            let found = (*id != NO_ID).then_some(f64::from(*t));
            hits += usize::from(found.is_some());
            if let Some(fault) = fault(c, found) {
                panic!("{c:?}: {fault}");
            }
        }
    }
    println!("{hits} first roots of {} polynomials", 3 * rounds * u64::from(SIDE * SIDE));
    assert!(hits as u64 > rounds * u64::from(SIDE * SIDE));
}

/// The check sees a root that is missing, one that is none, and one that is not the first.
#[test]
fn the_check_can_fail() {
    let c = exact::product(&[[-0.25, 0.75], [-0.5, 0.5], [-0.75, 0.25]]);
    assert_eq!(fault(&c, Some(0.25)), None);
    assert!(fault(&c, None).is_some_and(|f| f.contains("missed")));
    assert!(fault(&c, Some(0.5)).is_some_and(|f| f.contains("missed")));
    assert!(fault(&c, Some(0.24)).is_some_and(|f| f.contains("no root")));
}
