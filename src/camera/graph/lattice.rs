//! A lattice of points, and linear interpolation between them: continuous in the place, however what is given at the points
//! changes from one to the next.

/// The corners of the simplex around a place, in steps of the lattice, and their weights: positive, with the sum 1. The cubes of the
/// lattice are divided by the order of the coordinates' fractions (Kuhn, 1960), so that neighbours agree where they meet.
pub fn corners(place: &[f64]) -> Vec<(Vec<i64>, f64)> {
    let fraction = |k: usize| place[k] - place[k].floor();
    let mut order: Vec<usize> = (0..place.len()).collect();
    order.sort_by(|a, b| fraction(*b).total_cmp(&fraction(*a)));
    let mut corner: Vec<i64> = place.iter().map(|x| x.floor() as i64).collect();
    let mut left = 1.0;
    let mut corners = Vec::new();
    for k in order {
        corners.push((corner.clone(), left - fraction(k)));
        (corner[k], left) = (corner[k] + 1, fraction(k));
    }
    corners.push((corner, left));
    corners.retain(|(_, weight)| *weight > 0.0);
    corners
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Rng;

    #[test]
    fn corners_have_the_place_as_their_mean_and_weights_change_with_it_alone() {
        let mut rng = Rng(1);
        for n in 1..=9 {
            for _ in 0..100 {
                let place: Vec<f64> = (0..n).map(|_| 8.0 * rng.unit() - 4.0).collect();
                let all = corners(&place);
                assert!(all.len() <= n + 1 && all.iter().all(|(_, w)| *w > 0.0));
                for (k, x) in place.iter().enumerate() {
                    let mean: f64 = all.iter().map(|(c, w)| w * c[k] as f64).sum();
                    assert!((mean - x).abs() < 1e-13, "{mean} {x}");
                }
                // a function that jumps from point to point: its interpolation moves by its jumps times the motion
                let of = |c: &[i64]| c.iter().fold(7u64, |h, x| (h ^ *x as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15));
                let value = |place: &[f64]| -> f64 {
                    corners(place).iter().map(|(c, w)| w * (of(c) >> 11) as f64 / (1u64 << 53) as f64).sum()
                };
                let moved: Vec<f64> = place.iter().map(|x| x + 1e-6 * (rng.unit() - 0.5)).collect();
                assert!((value(&moved) - value(&place)).abs() <= n as f64 * 1e-6, "{place:?}");
            }
        }
        assert_eq!(corners(&[2.0, -3.0]), [(vec![2, -3], 1.0)]);
        assert_eq!(corners(&[0.25, 0.75]), [(vec![0, 0], 0.25), (vec![0, 1], 0.5), (vec![1, 1], 0.25)]);
    }
}
