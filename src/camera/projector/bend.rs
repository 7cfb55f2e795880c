//! How far a volume's control surfaces are from quadratic ones over a rectangle: bounds of their derivatives.

use super::Volume;
use super::surface::{Pulled, Surface};
use crate::arrays::MapEach;
use crate::camera::curve::Bend;
use glam::DVec2;

impl Volume {
    /// `None` of surfaces in pieces and rational patches, and where (u, v) is not (a, b), scaled and moved.
    pub(super) fn bend_over(&self, [lo, hi]: [DVec2; 2]) -> Option<Bend> {
        let affine = self.reparam.affine()?;
        let scale = DVec2::new(affine.linear.x_axis.x, affine.linear.y_axis.y);
        if affine.linear.x_axis.y != 0.0 || affine.linear.y_axis.x != 0.0 {
            return None;
        }
        let ends = [lo, hi].map_each(|ab| scale * ab + affine.offset);
        let uv = [ends[0].min(ends[1]), ends[0].max(ends[1])];
        let all = self.surfaces.iter().map(|s| s.bend(uv)).try_fold(Bend::default(), |m, b| Some(m.max(b?)))?;
        Some(all.scaled(scale.x, scale.y))
    }
}

impl Surface {
    /// By (u, v), over a rectangle of them.
    fn bend(&self, uv: [DVec2; 2]) -> Option<Bend> {
        match self {
            Surface::Plane(_) | Surface::Bilinear(_) => Some(Bend::default()),
            Surface::Cylinder(s) => Some(s.bend()),
            Surface::Sphere(s) => Some(s.bend()),
            Surface::Disc(s) => Some(s.bend(uv)),
            Surface::Patch(s) => s.bend(uv),
            Surface::Pulled(s) => s.bend(uv),
            Surface::Pieces(_) => None,
        }
    }
}

impl Pulled {
    /// `None` where the rectangle is not all outside of what is drawn to the pole.
    fn bend(&self, [lo, hi]: [DVec2; 2]) -> Option<Bend> {
        let nearest = self.pole.clamp(lo, hi) - self.pole;
        let r = (nearest * DVec2::new(self.aspect, 1.0)).length();
        if r <= self.pull {
            return None;
        }
        // Of the direction (cos th, sin th) by the place w: |th_i| <= 1 / r, |th_ij| <= 1 / r^2, |th_ijk| <= 2 / r^3, so the third
        // derivatives are within (1 + 3 + 2) / r^3.
        let of_w = 6.0 / (r * r * r);
        let reach = self.pull * (self.plane.u.length() / self.aspect.abs() + self.plane.v.length());
        Some(Bend { aaa: of_w, aab: of_w, abb: of_w, bbb: of_w }.scaled(self.aspect, 1.0).times(reach))
    }
}

#[cfg(test)]
mod tests {
    use super::super::patch::Patch;
    use super::super::surface::Plane;
    use super::*;
    use crate::input::Loading;
    use crate::input::parse::parse_set_value;
    use crate::input::reader::{Field, Source};
    use glam::DVec3;
    use std::path::Path;

    /// Derivatives at places of the rectangle, by differences; the largest of each.
    fn sampled(surface: &Surface, [lo, hi]: [DVec2; 2]) -> Bend {
        let step = STEP * (hi - lo);
        let at = |q: DVec2, i: i32, j: i32| surface.at(q + step * DVec2::new(i.into(), j.into())).unwrap().1;
        let mut all = Bend::default();
        for k in 0..81 {
            let share = DVec2::new(f64::from(k % 9), f64::from(k / 9)) / 8.0;
            let q = lo + 2.0 * step + share * (hi - lo - 4.0 * step);
            let (x, y) = (step.x, step.y);
            let uu = |j: i32| (at(q, 1, j) - 2.0 * at(q, 0, j) + at(q, -1, j)) / (x * x);
            let vv = |i: i32| (at(q, i, 1) - 2.0 * at(q, i, 0) + at(q, i, -1)) / (y * y);
            let uuu = at(q, 2, 0) - 2.0 * at(q, 1, 0) + 2.0 * at(q, -1, 0) - at(q, -2, 0);
            let vvv = at(q, 0, 2) - 2.0 * at(q, 0, 1) + 2.0 * at(q, 0, -1) - at(q, 0, -2);
            all = all.max(Bend {
                aaa: uuu.length() / (2.0 * x * x * x),
                aab: (uu(1) - uu(-1)).length() / (2.0 * y),
                abb: (vv(1) - vv(-1)).length() / (2.0 * x),
                bbb: vvv.length() / (2.0 * y * y * y),
            });
        }
        all
    }

    /// Of the rectangle's side.
    const STEP: f64 = 0.02;

    fn read(text: &str) -> Surface {
        let (node, path) = (parse_set_value(text), Path::new(""));
        Surface::read(&Field::new(&Source::new(path, path, &Loading::default()), "surface", &node)).unwrap()
    }

    #[test]
    fn bounds_hold_and_are_not_far_off() {
        let bicubic =
            "{ kind = 'bezier', points = [[[0,0,0],[1,0,2],[2,1,0],[3,0,1]], [[0,1,1],[1,1,-1],[2,1,1],[3,1,0]],
            [[0,2,0],[1,2,1],[2,3,0],[3,2,2]], [[0,3,1],[1,3,0],[2,3,-2],[4,3,0]]] }";
        let spline = "{ kind = 'bspline', degree = 3, points = [[[0,0,0],[1,0,2],[2,1,0],[3,0,1],[4,0,0]], [[0,1,1],[1,1,-1],[2,1,1],[3,1,0],[4,1,1]],
            [[0,2,0],[1,2,1],[2,3,0],[3,2,2],[4,2,0]], [[0,3,1],[1,3,0],[2,3,-2],[4,3,0],[5,3,0]]] }";
        let pulled = Pulled {
            plane: Plane { origin: DVec3::ZERO, u: DVec3::new(4.0, 0.0, 1.0), v: DVec3::new(0.0, -3.0, 0.0) },
            pole: DVec2::new(0.4, 0.5),
            pull: 0.1,
            aspect: 4.0 / 3.0,
        };
        let all = [
            read(
                "{ kind = 'cylinder', center = [0, 0, 0], axis = [0, 1, 0], radius = 2, height = 3, from = -40, to = 100 }",
            ),
            read("{ kind = 'sphere', center = [1, 0, 0], radius = 2, lon = [-180, 180], lat = [90, -90] }"),
            read("{ kind = 'disc', center = [1, 0, 0], normal = [0, 0, 1], radius = 2 }"),
            read(bicubic),
            read(spline),
            Surface::Pulled(pulled),
        ];
        for surface in all {
            for uv in [
                [DVec2::new(0.61, 0.7), DVec2::new(0.66, 0.72)],
                [DVec2::new(0.45, 0.1), DVec2::new(0.55, 0.2)],
                [DVec2::new(0.9, -0.02), DVec2::new(1.03, 0.1)],
            ] {
                let (bound, seen) = (surface.bend(uv).unwrap(), sampled(&surface, uv));
                // six places of up to 10, rounded, over the cube of a step
                let rounding = 6e-15 / (STEP * (uv[1] - uv[0]).min_element()).powi(3);
                for (bound, seen) in
                    [(bound.aaa, seen.aaa), (bound.aab, seen.aab), (bound.abb, seen.abb), (bound.bbb, seen.bbb)]
                {
                    assert!(seen <= 1.001 * bound + rounding, "{surface:?} {uv:?}: {seen} {bound} {rounding}");
                    assert!(bound <= 20.0 * seen + rounding, "{surface:?} {uv:?}: {seen} {bound} {rounding}");
                }
            }
        }
    }

    #[test]
    fn kinks_have_no_bound() {
        let linear =
            Surface::Patch(Patch::uniform([1, 1], 3, &[0, 1, 2, 3, 4, 5].map(|k| DVec3::splat(f64::from(k * k)))));
        assert!(linear.bend([DVec2::splat(0.45), DVec2::splat(0.55)]).is_none());
        assert_eq!(linear.bend([DVec2::splat(0.1), DVec2::splat(0.4)]), Some(Bend::default()));
        let points: Vec<DVec3> = (0..12).map(|k| DVec3::splat(f64::from(k * k))).collect();
        let quadratic = Surface::Patch(Patch::uniform([2, 1], 4, &points));
        assert!(quadratic.bend([DVec2::new(0.45, 0.1), DVec2::new(0.55, 0.2)]).is_none());
        let plane = Plane { origin: DVec3::ZERO, u: DVec3::X, v: DVec3::Y };
        let pulled = Surface::Pulled(Pulled { plane, pole: DVec2::splat(0.5), pull: 0.1, aspect: 1.0 });
        assert!(pulled.bend([DVec2::splat(0.3), DVec2::splat(0.45)]).is_none());
    }
}
