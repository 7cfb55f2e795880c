//! Brown's model with its derivatives along x and y.

use crate::camera::calibration::Coefficients;
use crate::reference::dual::Dual;
use glam::DVec2;

/// A number with its derivatives.
pub type Rated = Dual<f64, DVec2>;

/// The distorted place of the plane's point (x, y); `None` where g's denominator does not have the sign `side`.
pub fn seen(k: &Coefficients, side: f64, [x, y]: [f64; 2]) -> Option<[Rated; 2]> {
    let Coefficients { radial, below: [k4, k5, k6], tangential: [p1, p2], prism: [s13, s24], tilt: [tau_x, tau_y] } = k;
    let (x, y) = (Dual { value: x, rate: DVec2::X }, Dual { value: y, rate: DVec2::Y });
    let r2 = x * x + y * y;
    let (r4, r6) = (r2 * r2, r2 * r2 * r2);
    let one = Rated::still(1.0);
    let (mut above, mut power) = (one, one);
    for k in radial {
        power = power * r2;
        above = above + *k * power;
    }
    let below = one + *k4 * r2 + *k5 * r4 + *k6 * r6;
    if below.value * side <= 0.0 {
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
    let (turned_y, depth) = (cx * v + Rated::still(sx), Rated::still(cx) - sx * v);
    let (turned_x, turned_z) = (cy * u - sy * depth, sy * u + cy * depth);
    if turned_z.value <= 0.0 {
        return None;
    }
    let [r13, r23, r33] = [-sy * cx, sx, cy * cx];
    Some([(r33 * turned_x - r13 * turned_z) / turned_z, (r33 * turned_y - r23 * turned_z) / turned_z])
}
