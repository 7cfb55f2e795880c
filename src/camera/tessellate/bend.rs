//! How much the rays of a map bend over a rectangle of the image.

use crate::arrays::MapEach;
use crate::camera::{Ray, RayMap};
use glam::{DVec2, DVec3};

/// Intervals a side of the lattice that [`across`] looks at.
const STEPS: usize = 4;

/// By how much the largest second difference of the lattice is taken. A second difference is a mean of the derivative over
/// two intervals, and the lattice's cover the rectangle; so this holds where the derivative is nowhere more than twice its largest
/// mean over a half of the rectangle: an assumption on the map, true of smooth maps over small enough rectangles.
const SAFETY: f64 = 2.0;

type Lattice = [[Ray; STEPS + 1]; STEPS + 1];

/// Bounds over the rectangle from `lo` to `hi` of image coordinates, for each weight `(p, d)`: with F = p P + d D and a rectangle of w x h,
/// at least `|F_aa| w^2`, `|F_ab| w h` and `|F_bb| h^2` anywhere in it, of the second derivatives only the part across any ray of the
/// rectangle. They are second differences on a lattice of 5 x 5 places; `None` where one of them has no ray. Not proven: see [`SAFETY`],
/// and no sine is larger than the largest over the lattice.
pub fn across(map: &dyn RayMap, lo: DVec2, hi: DVec2, weights: &[(f64, f64)]) -> Option<Vec<[f64; 3]>> {
    let mut rays: Lattice = [[Ray { origin: DVec3::ZERO, direction: DVec3::ZERO }; STEPS + 1]; STEPS + 1];
    for (j, row) in rays.iter_mut().enumerate() {
        for (i, slot) in row.iter_mut().enumerate() {
            let q = lo + (hi - lo) * DVec2::new(i as f64, j as f64) / STEPS as f64;
            *slot = usable(map.ray(q.x, q.y))?;
        }
    }
    let forward = rays[STEPS / 2][STEPS / 2].direction.normalize();
    let unit = rays.iter().flatten().map(|r| r.direction.normalize());
    // beyond a right angle the sine falls again
    let sine = |d: DVec3| if d.dot(forward) > 0.0 { d.cross(forward).length() } else { 1.0 };
    let sine_max = unit.fold(0f64, |m, d| m.max(sine(d)));
    Some(weights.iter().map(|w| largest_differences(&rays, *w, forward, sine_max)).collect())
}

/// A ray with finite numbers and a direction.
pub fn usable(ray: Option<Ray>) -> Option<Ray> {
    ray.filter(|r| r.origin.is_finite() && r.direction.is_finite() && r.direction != DVec3::ZERO)
}

fn largest_differences(rays: &Lattice, (p, d): (f64, f64), forward: DVec3, sine_max: f64) -> [f64; 3] {
    let f = rays.each_ref().map(|row| row.each_ref().map(|r| p * r.origin + d * r.direction));
    let mut most = [Largest { forward, sine_max, size: 0.0 }; 3];
    for j in 0..=STEPS {
        for i in 0..=STEPS {
            if (1..STEPS).contains(&i) {
                most[0].take(f[j][i - 1] - 2.0 * f[j][i] + f[j][i + 1]);
            }
            if (1..STEPS).contains(&j) {
                most[2].take(f[j - 1][i] - 2.0 * f[j][i] + f[j + 1][i]);
            }
            if i < STEPS && j < STEPS {
                most[1].take(f[j + 1][i + 1] - f[j][i + 1] - f[j + 1][i] + f[j][i]);
            }
        }
    }
    // differences over 1/STEPS of the extents
    most.map_each(|m| SAFETY * (STEPS * STEPS) as f64 * m.size)
}

/// The largest size of vectors as seen along the rays of a rectangle: their component across `forward`, plus `sine_max` times their length.
#[derive(Clone, Copy)]
struct Largest {
    forward: DVec3,
    sine_max: f64,
    size: f64,
}

/// `(a + b)^2 <= 2 (a^2 + b^2)`, and a little more for rounding.
const SQUARE_OF_SUM: f64 = 2.0 + 1e-9;

impl Largest {
    fn take(&mut self, v: DVec3) {
        let across = (v - v.dot(self.forward) * self.forward).length_squared();
        let whole = v.length_squared();
        // most vectors are smaller, which needs no roots to see
        if SQUARE_OF_SUM * (across + self.sine_max * self.sine_max * whole) < self.size * self.size {
            return;
        }
        self.size = self.size.max(across.sqrt() + self.sine_max * whole.sqrt());
    }
}
