//! First intersections of rays with smooth surfaces: a quadric by its two roots, a torus by those of a quartic in Bernstein
//! form, a wave by bisection of intervals that may contain a root.

use crate::arrays::MapEach;
use crate::camera::bundle::Ray;
use crate::camera::optics::{Quadric, Smooth, Torus, Wave};
use crate::geometry::bernstein::Bernstein;
use glam::DVec3;
use std::f64::consts::TAU;

/// The first t in the range at which a ray meets a part of a surface; for a ray that starts on it, the first one after its start.
pub fn first_meeting((smooth, part): (&Smooth, usize), ray: &Ray, starts: bool, range: [f64; 2]) -> Option<f64> {
    match smooth {
        Smooth::Quadrics(list) => on_quadric(&list[part], ray, starts, range),
        Smooth::Torus(torus) => on_torus(torus, ray, starts, range),
        Smooth::Wave(wave) => on_wave(wave, ray, starts, range),
    }
}

/// Rounding of a place's height along the axis, in units of what is summed up to get the place: some 20 of its root t, as many of the place
/// and the height. A flat cap is all of one height and would have holes without.
const HEIGHT_UNITS: f64 = 128.0;

fn on_quadric(quadric: &Quadric, ray: &Ray, starts: bool, range: [f64; 2]) -> Option<f64> {
    let (q, d) = (ray.origin - quadric.centre, ray.direction);
    let (a, b) = (d.dot(quadric.a * d), d.dot(quadric.a * q + quadric.b));
    let c = q.dot(quadric.a * q) + 2.0 * quadric.b.dot(q) + quadric.c;
    let roots = if starts {
        [-2.0 * b / a, f64::NAN]
    } else {
        let root = (b * b - a * c).sqrt();
        let far = if b < 0.0 { root - b } else { -root - b };
        [far / a, c / far]
    };
    let size = |v: DVec3| v.abs().element_sum();
    let there = |t: &f64| {
        let error = HEIGHT_UNITS * f64::EPSILON * (size(q) + t.abs() * size(d));
        t.is_finite() && quadric.contains(q + *t * d, error) && range[0] <= *t && *t <= range[1]
    };
    roots.into_iter().filter(there).reduce(f64::min)
}

/// Squared radius of the ball that is searched for a torus of radius 1.
const BALL: f64 = 1.01;

/// Rounding of a quartic's value, against its largest coefficient: that of four levels of de Casteljau's construction, and
/// as much of the coefficients themselves.
const QUARTIC_ROUNDING: f64 = 24.0 * f64::EPSILON;

fn on_torus(torus: &Torus, ray: &Ray, starts: bool, range: [f64; 2]) -> Option<f64> {
    // s in units of the size, from where the ray is nearest to the centre, or from its start
    let speed = ray.direction.length() / torus.size();
    let (u, v) = (ray.direction.normalize(), (ray.origin - torus.centre) / torus.size());
    let nearest = if starts { 0.0 } else { -v.dot(u) };
    let q = v + nearest * u;
    let chord = (q.dot(u).powi(2) + BALL - q.length_squared()).sqrt();
    let [from, to] = range.map_each(|t| t * speed - nearest);
    let span = [from.max(-q.dot(u) - chord), to.min(chord - q.dot(u))];
    // a chord that is no number is none
    if span[0].is_nan() || chord.is_nan() || span[0] >= span[1] {
        return None;
    }
    let [radius, tube] = [torus.radius, torus.tube].map_each(|r| r / torus.size());
    let (z, w) = (q.dot(torus.axis), u.dot(torus.axis));
    // |q + s u|^2, the left side's root and the square of the distance from the axis, by powers of s
    let square = [q.length_squared(), 2.0 * q.dot(u), 1.0];
    let left = [square[0] + radius * radius - tube * tube, square[1], 1.0];
    let away = [square[0] - z * z, square[1] - 2.0 * z * w, 1.0 - w * w];
    let mut powers = [0.0; 5];
    for (i, j) in (0..3).flat_map(|i| (0..3).map(move |j| (i, j))) {
        powers[i + j] += left[i] * left[j];
    }
    (0..3).for_each(|k| powers[k] -= 4.0 * radius * radius * away[k]);
    // at its start the value is 0: what is left is s times a cubic
    let function = Bernstein::of_powers(&powers[usize::from(starts)..], span);
    let roots = function.roots(QUARTIC_ROUNDING * function.size());
    let t = roots.iter().map(|r| (span[0] + r.t * (span[1] - span[0]) + nearest) / speed);
    t.map(|t| t.clamp(range[0], range[1])).next()
}

/// Half-height of the slab that is searched for a wave, in amplitudes.
const OVER: f64 = 1.0 / 128.0;

fn on_wave(wave: &Wave, ray: &Ray, starts: bool, range: [f64; 2]) -> Option<f64> {
    let (o, d) = (ray.origin - wave.centre, ray.direction);
    let half = DVec3::new(wave.size / 2.0, wave.amplitude * (1.0 + OVER), wave.size / 2.0);
    let mut part = range;
    for k in 0..3 {
        if d[k] == 0.0 && o[k].abs() > half[k] {
            return None;
        } else if d[k] != 0.0 {
            let (a, b) = ((-half[k] - o[k]) / d[k], (half[k] - o[k]) / d[k]);
            part = [part[0].max(a.min(b)), part[1].min(a.max(b))];
        }
    }
    if starts {
        part[0] = 0.0;
    }
    let (q, length) = (o + part[0] * d, part[1] - part[0]);
    // the second derivative of the product of sines, which is small all the way next to where one of them is 0
    let [x, z] = [d.x, d.z].map_each(|d| TAU / wave.wavelength * d.abs());
    let sine = |q: f64| (TAU / wave.wavelength * q).sin().abs();
    let sines = (sine(q.x) + x * length).min(sine(q.z) + z * length);
    let bend = wave.amplitude * (x * x + z * z).min((x * x + z * z) * sines + 2.0 * x * z);
    let mut over = Over { wave, q, d, zero: 0.0, bend };
    let mut from = 0.0;
    if starts {
        // the slope alone outweighs the rest up to twice as far
        over.zero = over.height(0.0);
        from = over.slope(0.0).abs() / bend;
    }
    if from.is_nan() || length.is_nan() || from >= length {
        return None;
    }
    over.first_root(from, length).map(|s| part[0] + s)
}

/// How high a ray is over a wave, s from `q`.
struct Over<'a> {
    wave: &'a Wave,
    q: DVec3,
    d: DVec3,
    /// Heights up to this count as 0.
    zero: f64,
    /// The second derivative is at most this.
    bend: f64,
}

impl Over<'_> {
    fn height(&self, s: f64) -> f64 {
        let at = self.q + s * self.d;
        at.y - self.wave.height(at) - self.zero
    }

    fn slope(&self, s: f64) -> f64 {
        self.wave.normal(self.wave.centre + self.q + s * self.d).dot(self.d)
    }

    fn first_root(&self, from: f64, to: f64) -> Option<f64> {
        let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
        let (height, slope) = (self.height(middle), self.slope(middle));
        if height.abs() > slope.abs() * half + 0.5 * self.bend * half * half {
            return None;
        }
        let differ = self.height(from).signum() != self.height(to).signum();
        if slope.abs() > self.bend * half {
            return differ.then(|| self.root_between(from, to));
        }
        if middle <= from || middle >= to {
            // the ray touches the wave
            return Some(middle);
        }
        self.first_root(from, middle).or_else(|| self.first_root(middle, to))
    }

    fn root_between(&self, mut from: f64, mut to: f64) -> f64 {
        let above = self.height(from) > 0.0;
        loop {
            let middle = 0.5 * (from + to);
            if middle <= from || middle >= to {
                return middle;
            }
            if (self.height(middle) > 0.0) == above {
                from = middle;
            } else {
                to = middle;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Rng;

    fn surfaces(rng: &mut Rng) -> [Smooth; 2] {
        let axis = rng.vector().normalize();
        let tube = 0.01 + 0.7 * rng.signed().abs();
        let (amplitude, wavelength) = (0.02 + 0.3 * rng.signed().abs(), 0.4 + rng.signed().abs());
        [
            Smooth::Torus(Torus { centre: rng.vector(), axis, radius: 0.6, tube }),
            Smooth::Wave(Wave { centre: rng.vector(), size: 3.0, amplitude, wavelength }),
        ]
    }

    /// How far outside a place is, to first order; nothing where the surface ends.
    fn outside(smooth: &Smooth, place: DVec3) -> Option<f64> {
        match smooth {
            Smooth::Quadrics(_) => None,
            Smooth::Torus(t) => {
                let q = place - t.centre;
                let z = q.dot(t.axis);
                let r = (q - z * t.axis).length();
                // the sign of the quartic: within both tubes it is outside again
                let [near, far] = [r - t.radius, r + t.radius].map(|r| r.hypot(z) - t.tube);
                Some(near * if far < 0.0 { -1.0 } else { 1.0 })
            }
            Smooth::Wave(w) => {
                let q = place - w.centre;
                let within = q.x.abs() <= w.size / 2.0 && q.z.abs() <= w.size / 2.0;
                within.then(|| q.y - w.height(q))
            }
        }
    }

    /// However far from the world's origin it is, and from however far it is seen.
    #[test]
    fn a_flat_disc_has_no_holes() {
        let mut rng = Rng(3);
        for (away, distance) in [(0.0, 5.0), (0.0, 1e4), (1e4, 1e4), (1e5, 5.0), (1e6, 5.0)] {
            let axis = rng.vector().normalize();
            let vertex = away * rng.vector().normalize();
            let disc = Quadric::cap(vertex, axis, 0.0, 0.0, 1.0, false).unwrap();
            let (e1, e2) = axis.any_orthonormal_pair();
            for _ in 0..1000 {
                let origin = vertex + distance * (rng.vector() - 1.5 * axis);
                let aim = vertex + 0.7 * (rng.signed() * e1 + rng.signed() * e2);
                let ray = Ray { origin, direction: (aim - origin).normalize() };
                let met = on_quadric(&disc, &ray, false, [0.0, f64::INFINITY]);
                assert!(met.is_some(), "{ray:?} misses {disc:?}");
            }
        }
    }

    /// Along thousands of rays, from anywhere and from the surface itself: nothing changes sides before the first meeting,
    /// and there it does, or touches.
    #[test]
    fn nothing_is_met_before_the_first_meeting() {
        let mut rng = Rng(7);
        let (mut met, mut again) = ([0, 0], [0, 0]);
        for _ in 0..4000 {
            for (k, smooth) in surfaces(&mut rng).into_iter().enumerate() {
                let mut ray = Ray { origin: 4.0 * rng.vector(), direction: rng.vector() };
                ray.direction = 0.3 * ray.direction - ray.origin;
                let mut starts = false;
                for hit in 0..3 {
                    let found = first_meeting((&smooth, 0), &ray, starts, [0.0, f64::INFINITY]);
                    let end = found.unwrap_or(10.0 / ray.direction.length());
                    let at = |s: f64| outside(&smooth, ray.origin + s * end * ray.direction);
                    // away from both ends by more than roots are off; of a ray that starts on it, from where it is seen to go
                    let places = (1..400).map(|k| f64::from(k) / 400.0);
                    let sides: Vec<f64> = places.filter_map(at).filter(|v| v.abs() > 1e-9).map(f64::signum).collect();
                    let alike = sides.windows(2).all(|s| s[0] == s[1]);
                    assert!(alike, "hit {hit} of {ray:?} at {smooth:?}: {found:?}");
                    let Some(t) = found else { break };
                    let place = ray.origin + t * ray.direction;
                    assert!(outside(&smooth, place).is_none_or(|v| v.abs() < 1e-11), "{smooth:?}, {ray:?}: {t}");
                    if starts {
                        again[k] += 1
                    } else {
                        met[k] += 1
                    }
                    let n = smooth.normal(0, place).normalize();
                    let d = ray.direction.normalize();
                    // through it and back alternately
                    let direction = if hit == 0 { d - 2.0 * d.dot(n) * n } else { d + 0.3 * n };
                    (ray, starts) = (Ray { origin: place, direction }, true);
                }
            }
        }
        assert!(met.iter().all(|n| *n > 800) && again.iter().all(|n| *n > 100), "{met:?} {again:?}");
    }
}
