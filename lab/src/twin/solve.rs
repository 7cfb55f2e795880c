//! solve in f64: the rays of a piece through a point, from the kernel's own bytes.

use anamorph::internals::geometry::bernstein::Bernstein;
use anamorph::internals::gpu::layout::{SolvePiece, SolvePoint};
use glam::{DMat3, DVec2, DVec3};

/// A ray through the point, at any place and t.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Through {
    /// px about the piece's base.
    pub place_px: DVec2,
    pub t: f64,
    /// Least distance inwards from the piece's edges, px; negative outside.
    pub inside_px: f64,
}

/// All of them; `None` where the point is on a slit or an eye, within rounding.
pub fn solve(piece: &SolvePiece, point: &SolvePoint) -> Option<Vec<Through>> {
    let v = |v: [f32; 3]| DVec3::from_array(v.map(f64::from));
    let x = v(point.hi) - v(piece.anchor_hi) + (v(point.lo) - v(piece.anchor_lo));
    let q = [v(piece.p0) - x, v(piece.p1) - f64::from(piece.h1) * x, v(piece.p2) - f64::from(piece.h2) * x];
    let d = [v(piece.d0), v(piece.d1), v(piece.d2)];
    let size = |m: &[DVec3; 3]| m.iter().map(|c| c.length()).sum::<f64>();
    let unit = size(&q) / size(&d);
    let mut all = Vec::new();
    let of = |m: [DVec3; 3]| DMat3::from_cols(m[0], m[1], m[2]).determinant();
    for is_far in [false, true] {
        // the determinant at four places gives its coefficients
        let matrix = |s: f64| {
            let (a, b) = if is_far { (unit * s, 1.0) } else { (1.0, s) };
            // columns of like size: t = unit s, or unit / s
            let scale = if is_far { 1.0 / unit } else { 1.0 };
            [0, 1, 2].map(|k| scale * a * q[k] + unit * b * d[k])
        };
        let value = [-1.0, -1.0 / 3.0, 1.0 / 3.0, 1.0].map(|s| of(matrix(s)));
        let [f0, f1, f2, f3] = value;
        let c = [
            f0,
            (-5.0 * f0 + 18.0 * f1 - 9.0 * f2 + 2.0 * f3) / 6.0,
            (2.0 * f0 - 9.0 * f1 + 18.0 * f2 - 5.0 * f3) / 6.0,
            f3,
        ];
        let cubic = Bernstein::new(&c);
        let columns: f64 = (0..3).map(|k| q[k].length() + unit * d[k].length()).product();
        for root in cubic.roots(1e-14 * columns) {
            let s = 2.0 * root.t - 1.0;
            let t = if is_far { unit / s } else { unit * s };
            let m = matrix(s);
            let n = m[1].cross(m[2]);
            let at = DVec2::new(m[2].cross(m[0]).dot(n), m[0].cross(m[1]).dot(n)) / n.length_squared();
            if !at.is_finite() || !t.is_finite() {
                continue;
            }
            // a root that no place has: its columns are parallel, or one of an eye behind all places
            let rest = (m[0] + at.x * m[1] + at.y * m[2]).length();
            if rest > 1e-7 * (m[0].length() + at.x.abs() * m[1].length() + at.y.abs() * m[2].length()) {
                continue;
            }
            let inside = piece.edges.iter().map(|e| f64::from(e[0]) * at.x + f64::from(e[1]) * at.y + f64::from(e[2]));
            let half = f64::from(piece.half_px);
            let inside_px = half * inside.fold(f64::INFINITY, f64::min);
            if root.sign == 0 && inside_px > -1.0 {
                return None;
            }
            all.push(Through { place_px: half * at, t, inside_px });
        }
    }
    Some(all)
}
