//! A distortion with all its branches: that of the middle, and those behind poles that zeros cancel.
//!
//! A fit of both polynomials of the radial part leaves a pole where the lens has none: numerator and denominator are 0 at almost the same
//! radius, so that the lens is smooth but for a narrow ring. Rays go on behind such a ring (`docs/reference/definitions.md`, Poles that
//! cancel).

use super::brown::Brown;
use super::roots;
use super::tilt::Tilt;
use crate::camera::calibration::Coefficients;
use glam::DVec2;

/// Brown's distortion with its tilt.
#[derive(Debug, Clone, PartialEq)]
pub struct Distortion {
    tilt: Tilt,
    /// From the middle outward. A place has the ray of the first branch that reaches it.
    branches: Vec<Brown>,
}

impl Distortion {
    /// # Errors
    /// See [`Brown::new`]; a tilt of 90 degrees or more.
    pub fn new(k: &Coefficients) -> Result<Distortion, String> {
        let tilt = Tilt::new(k.tilt[0], k.tilt[1])?;
        let mut branches = vec![Brown::new(k)?];
        while let Some(next) = branches.last_mut().and_then(behind_cancelled_pole) {
            branches.push(next);
        }
        Ok(Distortion { tilt, branches })
    }

    /// The point of the plane whose distorted place is `q`.
    pub fn undistorted(&self, q: DVec2) -> Option<DVec2> {
        let q = self.tilt.back(q)?;
        if q == DVec2::ZERO {
            return Some(q);
        }
        self.branches.iter().find_map(|branch| branch.inverse(q))
    }

    /// The distorted place of a point of the plane; `None` if it is not seen.
    pub fn distorted(&self, p: DVec2) -> Option<DVec2> {
        let (before, [branch, ..]) = self.branches.split_at(self.branches.iter().position(|branch| branch.sees(p))?)
        else {
            return None;
        };
        let place = branch.seen(p).place;
        let is_first = before.iter().all(|branch| branch.inverse(place).is_none());
        self.tilt.onto(is_first.then_some(place)?)
    }
}

/// Rays pass over radii between these, relative to the pole's, at most: a quarter to either side. In 80 fits of noisy
/// points OpenCV's `calibrateCamera` left 40 pairs of pole and zero that pass over less, and 11 poles that pass over more.
const PASSED_OVER: [f64; 2] = [0.75, 1.25];

/// The branch behind the first pole of a branch that a zero cancels. Rays of the branch then end where those of the next begin.
fn behind_cancelled_pole(branch: &mut Brown) -> Option<Brown> {
    let [r_min, r_max] = branch.grows;
    let roots_behind = |c: &[f64]| roots::sign_changes(c).into_iter().map(f64::sqrt).filter(move |r| *r > r_min);
    let pole = roots_behind(branch.below()).next()?;
    let zero = roots_behind(branch.above()).min_by(|a, b| (a - pole).abs().total_cmp(&(b - pole).abs()))?;
    let is_narrow = |before: f64, after: f64| before >= PASSED_OVER[0] * pole && after <= PASSED_OVER[1] * pole;
    if zero < pole {
        // the radial part folds before the pole and behind it
        let mut next = branch.behind_pole(pole, None)?;
        let fold = next.grows[0];
        next.injective = next.injective_around(pole + 2.0 * (fold - pole), next.grows);
        return (is_narrow(r_max, fold) && !next.injective.is_empty()).then_some(next);
    }
    // it grows to infinity and comes again from below: it goes on where the lens without the pair would be at the pole
    let slope = |c: &[f64], r: f64| roots::value(&roots::derivative(c), r * r);
    let place = pole * slope(branch.above(), zero) / slope(branch.below(), pole);
    let mut next = branch.behind_pole(pole, Some(zero))?;
    let (end, start) = (branch.radial_inverse(place)?, next.radial_inverse(place)?);
    next.injective = next.injective_around(start, next.grows);
    let goes_on = r_max == pole && is_narrow(end, start) && !next.injective.is_empty();
    if goes_on {
        branch.r_end = end;
    }
    goes_on.then_some(next)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// OpenCV's coefficients of lenses with a pole and a zero at almost the same radius, and on which side the zero lies.
    const LENSES: [([f64; 8], bool); 6] = [
        // a factory's calibration of a small color camera
        (
            [
                -4.093_396_66,
                9.190_781_59,
                0.001_254_39,
                -0.001_030_44,
                -8.917_245_86,
                -4.187_956_81,
                9.556_831_36,
                -9.303_533_55,
            ],
            true,
        ),
        // the same with numerator and denominator exchanged
        (
            [
                -4.187_956_81,
                9.556_831_36,
                0.001_254_39,
                -0.001_030_44,
                -9.303_533_55,
                -4.093_396_66,
                9.190_781_59,
                -8.917_245_86,
            ],
            false,
        ),
        // fits of noisy pictures of a board by OpenCV
        (
            [
                -0.786_736_97,
                0.267_539_85,
                -0.000_870_33,
                -0.001_802_23,
                -0.191_839_75,
                -0.668_827_79,
                0.084_596_27,
                -0.122_923_55,
            ],
            true,
        ),
        (
            [
                0.276_439_26,
                -1.007_178_21,
                -0.001_603_9,
                -0.000_955_5,
                0.209_220_79,
                0.192_727_4,
                -1.171_442_25,
                0.376_356_78,
            ],
            false,
        ),
        ([-0.786_736_97, 0.267_539_85, 0.0, 0.0, -0.191_839_75, -0.668_827_79, 0.084_596_27, -0.122_923_55], true),
        ([0.276_439_26, -1.007_178_21, 0.0, 0.0, 0.209_220_79, 0.192_727_4, -1.171_442_25, 0.376_356_78], false),
    ];

    fn distortion(k: &[f64]) -> Distortion {
        Distortion::new(&Coefficients::of_opencv(k)).unwrap()
    }

    /// Places up to a radius of 1.4, in all directions.
    fn places() -> impl Iterator<Item = DVec2> {
        (1..=700).map(|n| 0.002 * f64::from(n) * DVec2::from_angle(2.4 * f64::from(n)))
    }

    #[test]
    fn rays_go_on_behind_a_cancelled_pole_and_no_place_has_two() {
        for (k, is_zero_behind) in LENSES {
            let lens = distortion(&k);
            assert_eq!(lens.branches.len(), 2, "{k:?}");
            let pole = roots::first(lens.branches[0].below()).sqrt();
            let mut without = Vec::new();
            for q in places() {
                let Some(p) = lens.undistorted(q) else {
                    without.push(q.length());
                    continue;
                };
                // the ray is seen there
                let branch = lens.branches[usize::from(p.length() > pole)];
                assert!(branch.seen(p).place.distance(q) <= branch.rounding(p), "{k:?}: {q} from {p}");
                let back = lens.distorted(p).unwrap_or_else(|| panic!("{k:?}: {p}, the ray of {q}, is not seen"));
                assert!(back.distance(q) <= branch.rounding(p), "{k:?}: {q} and {back}");
            }
            // a point that is seen is the ray of its place
            let mut hidden = Vec::new();
            for p in places() {
                match lens.distorted(p) {
                    None => hidden.push(p.length()),
                    Some(q) => {
                        let branch = lens.branches[usize::from(p.length() > pole)];
                        let seen = branch.seen(p);
                        let stretch =
                            seen.slope.determinant() / (seen.slope.x_axis.length() + seen.slope.y_axis.length());
                        let found =
                            lens.undistorted(q).unwrap_or_else(|| panic!("{k:?}: {p} is seen at {q}, without a ray"));
                        assert!(
                            found.distance(p) <= 4.0 * branch.rounding(p) / stretch,
                            "{k:?}: {p} and {found} at {q}"
                        );
                    }
                }
            }
            // directions are passed over, a quarter of the pole's radius to either side at most
            assert!(
                !hidden.is_empty() && hidden.iter().all(|r| (r / pole - 1.0).abs() <= 0.25),
                "{k:?}: {pole} {hidden:?}"
            );
            // places are left out only between two folds
            assert_eq!(without.is_empty(), is_zero_behind, "{k:?}: {without:?}");
            assert!(without.len() < 120, "{k:?}: {without:?}");
        }
    }

    /// A place has a ray where OpenCV's iteration finds one that is seen there.
    #[test]
    fn places_have_rays_where_opencv_has_them() {
        // a hundredth of a pixel at a focal length of 500 px
        let close = 0.01 / 500.0;
        for (k, _) in LENSES {
            let lens = distortion(&k);
            let mut found = [0, 0];
            for q in places() {
                let p = by_iteration(&k, q);
                let is_seen = lens.branches[0].seen(p).place.distance(q) < close;
                // at the border of the gap the nearest place that has a ray is as close
                let has_ray =
                    lens.undistorted(q).is_some() || lens.distorted(p).is_some_and(|seen| seen.distance(q) < close);
                assert!(has_ray || !is_seen, "{k:?}: {q}, {p}");
                found[usize::from(is_seen)] += 1;
            }
            assert!(found[1] > 500, "{k:?}: {found:?}");
        }
    }

    /// `undistortPoints`: 100 steps of `p = (q - the other terms at p) / g(p)`.
    fn by_iteration(k: &[f64; 8], q: DVec2) -> DVec2 {
        let [k1, k2, p1, p2, k3, k4, k5, k6] = *k;
        let mut p = q;
        for _ in 0..100 {
            let r2 = p.length_squared();
            let gain = (1.0 + ((k3 * r2 + k2) * r2 + k1) * r2) / (1.0 + ((k6 * r2 + k5) * r2 + k4) * r2);
            let x = 2.0 * p1 * p.x * p.y + p2 * (r2 + 2.0 * p.x * p.x);
            let y = p1 * (r2 + 2.0 * p.y * p.y) + 2.0 * p2 * p.x * p.y;
            p = (q - DVec2::new(x, y)) / gain;
        }
        p
    }

    #[test]
    fn poles_of_other_lenses_end_the_branch() {
        // no zero; a zero far behind the pole; a zero far before it
        for k in [
            [0.0, 0.0, 0.0, 0.0, 0.0, -0.25, 0.0, 0.0],
            [-0.1, 0.0, 0.0, 0.0, 0.0, -0.25, 0.0, 0.0],
            [-0.6, 0.0, 0.0, 0.0, 0.0, -0.25, 0.0, 0.0],
        ] {
            assert_eq!(distortion(&k).branches.len(), 1, "{k:?}");
        }
        // two pairs
        let pair = |q: f64, zero: f64| [roots::product(&[1.0, -1.0 / zero], &[1.0]), vec![1.0, -1.0 / q]];
        let ([a, b], [c, d]) = (pair(0.5, 0.501), pair(1.2, 1.199));
        let (above, below) = (roots::product(&a, &c), roots::product(&b, &d));
        let lens = distortion(&[above[1], above[2], 0.0, 0.0, 0.0, below[1], below[2], 0.0]);
        assert_eq!(lens.branches.len(), 3);
        assert!(lens.undistorted(DVec2::X * 1.4).is_some_and(|p| (p.x - 1.4).abs() < 0.01));
    }
}
