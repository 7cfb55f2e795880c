//! The roots against exact arithmetic: of millions of polynomials, ordinary and made to be hard, none is missed and none is false
//! beyond what their own rounding hides.

use super::{Bernstein, Root, VALUE_ROUNDING};
use rayon::prelude::*;
use std::cmp::Ordering;

#[path = "../../../tests/common/exact.rs"]
mod arithmetic;
use arithmetic::{Dyadic, Powers, Rng, beyond, count, polynomial, product};

/// What is wrong with the roots that were found, in a line.
fn fault(c: &[f64], zero: f64, roots: &[Root]) -> Option<String> {
    let size = c.iter().fold(0.0f64, |m, c| m.max(c.abs()));
    // what counts as 0, and the rounding of the value that is compared with it
    let hidden = zero + VALUE_ROUNDING * size;
    let step = |t: f64| 4.0 * f64::EPSILON * t + f64::MIN_POSITIVE;
    for root in roots {
        let [before, after] = [root.t - step(root.t), root.t + step(root.t)].map(|t| t.clamp(0.0, 1.0));
        let exact = Powers::new(c, 0.0);
        let crosses = exact.sign_at(&Dyadic::of(before)) != exact.sign_at(&Dyadic::of(after));
        if !crosses && beyond(c, hidden, root.t, root.t).contains(&true) {
            return Some(format!("{} is no root", root.t));
        }
    }
    let places: Vec<f64> = roots.iter().map(|r| r.t).collect();
    let ends: Vec<f64> = [0.0].into_iter().chain(places).chain([1.0]).collect();
    let gaps: Vec<[bool; 2]> = ends
        .windows(2)
        .map(|gap| {
            // next to a root it may be on the other side by the root's own rounding
            let (a, b) = (gap[0] + step(gap[0]), gap[1] - step(gap[1]));
            let [a, b] = [if gap[0] == 0.0 { 0.0 } else { a }, if gap[1] == 1.0 { 1.0 } else { b }];
            if a < b { beyond(c, hidden, a, b) } else { [false, false] }
        })
        .collect();
    if let Some(k) = gaps.iter().position(|gap| *gap == [true, true]) {
        return Some(format!("a root is missed between {} and {}", ends[k], ends[k + 1]));
    }
    for (root, gaps) in roots.iter().zip(gaps.windows(2)) {
        let side = |gap: [bool; 2]| i8::from(gap[0]) - i8::from(gap[1]);
        let (before, after) = (side(gaps[0]), side(gaps[1]));
        let crossing = match before.cmp(&after) {
            _ if before == 0 || after == 0 => continue,
            Ordering::Less => 1,
            Ordering::Equal => 0,
            Ordering::Greater => -1,
        };
        if crossing != root.sign {
            return Some(format!("{} is crossed by {crossing} and not by {}", root.t, root.sign));
        }
    }
    None
}

#[test]
fn no_root_is_missed_and_none_is_false() {
    const EACH: u64 = 1000;
    let found: usize = (0..count().div_ceil(EACH))
        .into_par_iter()
        .map(|seed| {
            let mut rng = Rng(seed);
            let mut found = 0;
            for _ in 0..EACH {
                let c = polynomial(&mut rng);
                let p = Bernstein::new(&c);
                let zero = VALUE_ROUNDING * p.size();
                let roots = p.roots(zero);
                found += roots.len();
                if let Some(fault) = fault(&c, zero, &roots) {
                    panic!("{c:?}: {fault}; found {roots:?}");
                }
            }
            found
        })
        .sum();
    println!("{found} roots of {} polynomials", count());
    assert!(found as u64 > count() / 2);
}

/// The check sees a root that is missing, one too many, one beside its place, and one that is crossed the other way.
#[test]
fn the_check_can_fail() {
    let c = product(&[[-0.25, 0.75], [-0.5, 0.5], [-0.75, 0.25]]);
    let zero = VALUE_ROUNDING;
    let right = Bernstein::new(&c).roots(zero);
    assert_eq!((right.len(), fault(&c, zero, &right)), (3, None));
    for k in 0..3 {
        let missing: Vec<Root> = right.iter().enumerate().filter(|(j, _)| *j != k).map(|(_, r)| *r).collect();
        assert!(fault(&c, zero, &missing).is_some_and(|f| f.contains("missed")));
        let mut moved = right.clone();
        moved[k].t += 1e-13;
        assert!(fault(&c, zero, &moved).is_some_and(|f| f.contains("no root")));
        let mut flipped = right.clone();
        flipped[k].sign = -flipped[k].sign;
        assert!(fault(&c, zero, &flipped).is_some_and(|f| f.contains("crossed")));
    }
    let mut more = right.clone();
    more.insert(1, Root { t: 0.3, sign: 1 });
    assert!(fault(&c, zero, &more).is_some());
}
