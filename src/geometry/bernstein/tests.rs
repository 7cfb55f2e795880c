use super::*;
use crate::testing::Rng;

/// Bernstein coefficients of `(t - r0) (t - r1) (t - r2)`, by its blossom.
fn cubic(r: [f64; 3]) -> Bernstein {
    let blossom = |u: [f64; 3]| {
        let orders = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];
        orders.iter().map(|o| (u[0] - r[o[0]]) * (u[1] - r[o[1]]) * (u[2] - r[o[2]])).sum::<f64>() / 6.0
    };
    Bernstein::new(&[[0., 0., 0.], [0., 0., 1.], [0., 1., 1.], [1., 1., 1.]].map(blossom))
}

fn found(p: &Bernstein) -> Vec<(f64, i8)> {
    p.roots(VALUE_ROUNDING * p.size()).iter().map(|r| (r.t, r.sign)).collect()
}

#[test]
fn all_roots_of_a_cubic_and_how_it_passes_them() {
    let mut rng = Rng(3);
    let mut three = 0;
    for _ in 0..100_000 {
        let mut r = [0, 1, 2].map(|_| 1.6 * rng.unit() - 0.3);
        r.sort_unstable_by(f64::total_cmp);
        // a root at 1e-6 from another or from an end may be distinguished or not
        let separate = r[1] - r[0] > 1e-6 && r[2] - r[1] > 1e-6;
        if !separate || r.iter().any(|r| r.abs() < 1e-6 || (1.0 - r).abs() < 1e-6) {
            continue;
        }
        let expected: Vec<(f64, i8)> = r.into_iter().zip([1, -1, 1]).filter(|(r, _)| (0.0..=1.0).contains(r)).collect();
        let roots = found(&cubic(r));
        assert_eq!(roots.len(), expected.len(), "{r:?}: {roots:?}");
        three += usize::from(roots.len() == 3);
        for (found, expected) in roots.iter().zip(&expected) {
            // coefficients round to 2^-52; the slope at a root is at least 1e-6 times the distance to the third
            assert!((found.0 - expected.0).abs() < 1e-8 && found.1 == expected.1, "{r:?}: {roots:?}");
        }
    }
    assert!(three > 1000);
}

#[test]
fn all_roots_of_a_quartic_from_its_powers() {
    let mut rng = Rng(5);
    let mut four = 0;
    for _ in 0..20_000 {
        let mut r = [0, 1, 2, 3].map(|_| 2.0 * rng.unit() - 1.0);
        r.sort_unstable_by(f64::total_cmp);
        let (from, to) = (-rng.unit(), rng.unit());
        let separate = r.windows(2).all(|r| r[1] - r[0] > 1e-3);
        if !separate || to - from < 0.1 || r.iter().any(|r| (r - from).abs() < 1e-3 || (r - to).abs() < 1e-3) {
            continue;
        }
        let mut powers = vec![1.0];
        for r in r {
            powers = (0..=powers.len())
                .map(|k| k.checked_sub(1).map_or(0.0, |j| powers[j]) - r * powers.get(k).unwrap_or(&0.0))
                .collect();
        }
        let quartic = Bernstein::of_powers(&powers, [from, to]);
        assert!((quartic.at(0.0) - r.iter().map(|r| from - r).product::<f64>()).abs() < 1e-14);
        let roots = quartic.roots(2.0 * VALUE_ROUNDING * quartic.size());
        let expected: Vec<(f64, i8)> =
            r.into_iter().zip([-1, 1, -1, 1]).filter(|(r, _)| (from..=to).contains(r)).collect();
        assert_eq!(roots.len(), expected.len(), "{r:?}, {from} to {to}: {roots:?}");
        four += usize::from(roots.len() == 4);
        for (found, (t, sign)) in roots.iter().zip(&expected) {
            // values round to some 2^-50; the slope at a root is at least 1e-9
            assert!((from + found.t * (to - from) - t).abs() < 1e-5 && found.sign == *sign, "{r:?}: {roots:?}");
        }
    }
    assert!(four > 300, "{four}");
}

#[test]
fn touching_roots_and_roots_at_the_ends() {
    assert_eq!(found(&Bernstein::new(&[1.0, -1.0, 1.0])), [(0.5, 0)]);
    assert_eq!(found(&Bernstein::new(&[-1.0, 1.0, -1.0])), [(0.5, 0)]);
    assert_eq!(found(&Bernstein::new(&[0.0, 1.0])), [(0.0, 1)]);
    assert_eq!(found(&Bernstein::new(&[1.0, 0.0])), [(1.0, -1)]);
    assert_eq!(found(&Bernstein::new(&[0.0, 1.0, 0.0])), [(0.0, 1), (1.0, -1)]);
    // t^2 and t^3: at the end alone they rise from 0.
    assert_eq!(found(&Bernstein::new(&[0.0, 0.0, 1.0])), [(0.0, 1)]);
    assert_eq!(found(&Bernstein::new(&[0.0, 0.0, 0.0, 1.0])), [(0.0, 1)]);
    // a threefold root: (2 t - 1)^3
    let [root] = found(&Bernstein::new(&[-1.0, 1.0, -1.0, 1.0]))[..] else { panic!("one root") };
    assert!((root.0 - 0.5).abs() < 1e-5 && root.1 == 1, "{root:?}");
    for none in [[1.0, 2.0, 3.0, 4.0], [1.0, -0.5, 1.0, 1.0], [0.0; 4]] {
        assert!(found(&Bernstein::new(&none)).is_empty(), "{none:?}");
    }
}

#[test]
fn roots_near_the_start_keep_their_leading_digits() {
    for e in [1e-3, 1e-9, 1e-15] {
        let p = Bernstein::new(&[-e, 1.0 - e, 1.5, 1.0]);
        let roots = p.roots(1e-3 * e);
        assert_eq!(roots.len(), 1);
        assert!(p.at(roots[0].t).abs() < 1e-14 * e + 1e-16 * e, "{e}: {}", p.at(roots[0].t));
    }
}
