//! Brown's model with its derivatives, by dual numbers: value, d/dx and d/dy.

use crate::arrays::MapEach;
use crate::camera::calibration::Coefficients;
use std::ops::{Add, Div, Mul, Sub};

#[derive(Debug, Clone, Copy)]
pub struct Dual(pub [f64; 3]);

pub fn constant(value: f64) -> Dual {
    Dual([value, 0.0, 0.0])
}

impl Add for Dual {
    type Output = Dual;
    fn add(self, b: Dual) -> Dual {
        Dual([0, 1, 2].map_each(|k| self.0[k] + b.0[k]))
    }
}

impl Sub for Dual {
    type Output = Dual;
    fn sub(self, b: Dual) -> Dual {
        Dual([0, 1, 2].map_each(|k| self.0[k] - b.0[k]))
    }
}

impl Mul for Dual {
    type Output = Dual;
    #[allow(clippy::suspicious_arithmetic_impl, reason = "the product rule")]
    fn mul(self, b: Dual) -> Dual {
        let slope = |k: usize| self.0[k] * b.0[0] + self.0[0] * b.0[k];
        Dual([self.0[0] * b.0[0], slope(1), slope(2)])
    }
}

impl Div for Dual {
    type Output = Dual;
    #[allow(clippy::suspicious_arithmetic_impl, reason = "the quotient rule")]
    fn div(self, b: Dual) -> Dual {
        let value = self.0[0] / b.0[0];
        let slope = |k: usize| (self.0[k] - value * b.0[k]) / b.0[0];
        Dual([value, slope(1), slope(2)])
    }
}

impl Mul<Dual> for f64 {
    type Output = Dual;
    fn mul(self, b: Dual) -> Dual {
        Dual(b.0.map_each(|v| self * v))
    }
}

/// The distorted place of the plane's point (x, y); `None` where g's denominator does not have the sign `side`.
pub fn seen(k: &Coefficients, side: f64, [x, y]: [f64; 2]) -> Option<[Dual; 2]> {
    let Coefficients { radial, below: [k4, k5, k6], tangential: [p1, p2], prism: [s13, s24], tilt: [tau_x, tau_y] } = k;
    let (x, y) = (Dual([x, 1.0, 0.0]), Dual([y, 0.0, 1.0]));
    let r2 = x * x + y * y;
    let (r4, r6) = (r2 * r2, r2 * r2 * r2);
    let one = constant(1.0);
    let (mut above, mut power) = (one, one);
    for k in radial {
        power = power * r2;
        above = above + *k * power;
    }
    let below = one + *k4 * r2 + *k5 * r4 + *k6 * r6;
    if below.0[0] * side <= 0.0 {
        return None;
    }
    let gain = above / below;
    let xy = 2.0 * (x * y);
    let u = x * gain + *p1 * xy + *p2 * (r2 + 2.0 * (x * x)) + s13.x * r2 + s24.x * r4;
    let v = y * gain + *p1 * (r2 + 2.0 * (y * y)) + *p2 * xy + s13.y * r2 + s24.y * r4;
    if (*tau_x, *tau_y) == (0.0, 0.0) {
        return Some([u, v]);
    }
    // R = [cy 0 -sy; 0 1 0; sy 0 cy] [1 0 0; 0 cx sx; 0 -sx cx] of (u, v, 1), then projected onto the sensor along its z axis
    let ((sx, cx), (sy, cy)) = (tau_x.sin_cos(), tau_y.sin_cos());
    let (turned_y, depth) = (cx * v + constant(sx), constant(cx) - sx * v);
    let (turned_x, turned_z) = (cy * u - sy * depth, sy * u + cy * depth);
    if turned_z.0[0] <= 0.0 {
        return None;
    }
    let [r13, r23, r33] = [-sy * cx, sx, cy * cx];
    Some([(r33 * turned_x - r13 * turned_z) / turned_z, (r33 * turned_y - r23 * turned_z) / turned_z])
}
