//! Tensor-product patches: Bezier, B-spline and NURBS, all by de Boor's construction.
//!
//! A Bezier patch is the B-spline patch whose knots are 0 and 1 only; a NURBS patch is a B-spline patch in homogeneous
//! coordinates (w x, w y, w z, w). (Brosz et al. 2007, section 5, on Glassner's and the magnification lens's surfaces.)

use super::reparam::read_positive;
use crate::arrays::MapEach;
use crate::camera::curve::Bend;
use crate::input::Result;
use crate::input::reader::{Field, Table};
use glam::{DVec2, DVec3, DVec4};

/// Degrees, knots and control points of a patch; (u, v) in [0, 1] is its whole extent, beyond which the outermost
/// polynomials go on.
#[derive(Debug, Clone, PartialEq)]
pub struct Patch {
    /// Along u: the columns of a row.
    u: Basis,
    /// Along v: the rows.
    v: Basis,
    /// Row by row, with the weight last and multiplied in.
    points: Vec<DVec4>,
    /// The weights are not all 1.
    rational: bool,
}

/// One direction of a patch of n control points: degree p and n + p + 1 knots, not descending.
#[derive(Debug, Clone, PartialEq)]
struct Basis {
    degree: usize,
    knots: Vec<f64>,
}

/// The highest degree of a patch.
const DEGREE_MAX: usize = 5;

/// Most control points of a row or a column.
const POINTS_MAX: usize = 4096;

impl Patch {
    /// A B-spline patch of evenly spaced knots; `points` row by row, `columns` in a row. Needs more points than the degree
    /// each way.
    pub(crate) fn uniform(degree: [usize; 2], columns: usize, points: &[DVec3]) -> Patch {
        let rows = points.len() / columns;
        Patch {
            u: Basis::uniform(degree[0], columns),
            v: Basis::uniform(degree[1], rows),
            points: points.iter().map(|p| p.extend(1.0)).collect(),
            rational: false,
        }
    }

    pub(super) fn read_bezier(table: &Table) -> Result<Patch> {
        table.allow(&["kind", "points"])?;
        let (columns, points) = read_grid(&table.need("points", GRID_EXAMPLE)?, &[2, 2], DEGREE_MAX + 1, Field::vec3)?;
        Ok(Patch::uniform([columns - 1, points.len() / columns - 1], columns, &points))
    }

    pub(super) fn read_bspline(table: &Table) -> Result<Patch> {
        table.allow(&["kind", "points", "degree", "knots_u", "knots_v"])?;
        let (u, v, points) = read_spline(table)?;
        Ok(Patch { u, v, points: points.iter().map(|p| p.extend(1.0)).collect(), rational: false })
    }

    pub(super) fn read_nurbs(table: &Table) -> Result<Patch> {
        table.allow(&["kind", "points", "degree", "knots_u", "knots_v", "weights"])?;
        let (u, v, points) = read_spline(table)?;
        let field = table.need("weights", "[[1, 1], [1, 1]]")?;
        let (columns, weights) = read_grid(&field, &[2, 2], POINTS_MAX, read_positive)?;
        if columns != u.points() || weights.len() != points.len() {
            return Err(field.error("there must be one weight for each control point, in rows like the points'"));
        }
        let points = points.iter().zip(&weights).map(|(p, w)| (*w * *p).extend(*w)).collect();
        Ok(Patch { u, v, points, rational: true })
    }

    /// `None` where the weights of a rational patch, gone on beyond its extent, sum to 0 or less.
    pub fn at(&self, uv: DVec2) -> Option<DVec3> {
        let (columns, (at_u, at_v)) = (self.u.points(), (self.u.knot_at(uv.x), self.v.knot_at(uv.y)));
        let (first_u, first_v) = (self.u.span(at_u), self.v.span(at_v));
        let row = |j: usize| {
            let start = (first_v - self.v.degree + j) * columns + first_u - self.u.degree;
            self.u.blossom(first_u, |_| at_u, |i| self.points[start + i])
        };
        let point = self.v.blossom(first_v, |_| at_v, row);
        if !self.rational {
            return Some(point.truncate());
        }
        (point.w > 0.0).then(|| point.truncate() / point.w)
    }

    /// Over a rectangle of (u, v): the control points of each of its polynomials, by blossoms, bound their derivatives. `None` of a rational
    /// patch, and where it has a kink.
    pub(super) fn bend(&self, [lo, hi]: [DVec2; 2]) -> Option<Bend> {
        if self.rational {
            return None;
        }
        let (across, down) = (self.u.parts([lo.x, hi.x])?, self.v.parts([lo.y, hi.y])?);
        let all = across.iter().flat_map(|u| down.iter().map(move |v| self.bend_of(*u, *v)));
        Some(all.fold(Bend::default(), Bend::max))
    }

    /// Of one polynomial, over spans of both parameters.
    fn bend_of(&self, (first_u, ends_u): (usize, [f64; 2]), (first_v, ends_v): (usize, [f64; 2])) -> Bend {
        let (p, q, columns) = (self.u.degree, self.v.degree, self.u.points());
        let row = |i: usize, j: usize| {
            let start = (first_v - q + j) * columns + first_u - p;
            self.u.blossom(first_u, |r| ends_u[usize::from(r <= i)], |k| self.points[start + k])
        };
        let point =
            |i: usize, j: usize| self.v.blossom(first_v, |r| ends_v[usize::from(r <= j)], |k| row(i, k)).truncate();
        let net: Vec<Vec<DVec3>> = (0..=q).map(|j| (0..=p).map(|i| point(i, j)).collect()).collect();
        let u = |net: &[Vec<DVec3>]| -> Vec<Vec<DVec3>> {
            net.iter().map(|row| row.windows(2).map(|w| w[1] - w[0]).collect()).collect()
        };
        let v = |net: &[Vec<DVec3>]| -> Vec<Vec<DVec3>> {
            net.windows(2).map(|w| w[0].iter().zip(&w[1]).map(|(a, b)| *b - *a).collect()).collect()
        };
        let most = |net: &[Vec<DVec3>]| net.iter().flatten().fold(0.0_f64, |m, d| m.max(d.length()));
        let (uu, vv) = (u(&u(&net)), v(&v(&net)));
        let (p, q) = (p as f64, q as f64);
        let differences = Bend {
            aaa: p * (p - 1.0) * (p - 2.0) * most(&u(&uu)),
            aab: p * (p - 1.0) * q * most(&v(&uu)),
            abb: q * (q - 1.0) * p * most(&u(&vv)),
            bbb: q * (q - 1.0) * (q - 2.0) * most(&v(&vv)),
        };
        let scale =
            |basis: &Basis, [t0, t1]: [f64; 2]| (basis.knots[basis.points()] - basis.knots[basis.degree]) / (t1 - t0);
        differences.scaled(scale(&self.u, ends_u), scale(&self.v, ends_v))
    }

    /// Greville's abscissae of a uniform basis: a patch whose control points lie at these places of a plane is that plane, with
    /// its (u, v).
    pub(crate) fn greville(degree: usize, count: usize) -> Vec<f64> {
        let basis = Basis::uniform(degree, count);
        (0..count).map(|i| basis.knots[i + 1..=i + degree].iter().sum::<f64>() / degree as f64).collect()
    }
}

impl Basis {
    /// Knots 0 and 1 `degree + 1` times each, and evenly spaced ones between.
    fn uniform(degree: usize, points: usize) -> Basis {
        let spans = points - degree;
        let knot = |k: usize| k.saturating_sub(degree).min(spans) as f64 / spans as f64;
        Basis { degree, knots: (0..points + degree + 1).map(knot).collect() }
    }

    fn points(&self) -> usize {
        self.knots.len() - self.degree - 1
    }

    /// The parameter whose place is `x` of the way from the first end of the extent to the last.
    fn knot_at(&self, x: f64) -> f64 {
        let (first, last) = (self.knots[self.degree], self.knots[self.points()]);
        first * (1.0 - x) + last * x
    }

    /// The span of positive length that holds `t`, by the number of its first knot; the outermost ones beyond the extent.
    fn span(&self, t: f64) -> usize {
        let (p, n) = (self.degree, self.points());
        let above = self.knots[p + 1..n].partition_point(|k| *k <= t);
        let is_span = |k: &usize| self.knots[*k] < self.knots[*k + 1];
        let (mut below, mut beyond) = ((p..=p + above).rev(), p + above + 1..n);
        below.find(is_span).or_else(|| beyond.find(is_span)).unwrap_or(p)
    }

    /// The spans that places between two ends lie in, each with the parameters that it has of them. `None` where a first or second derivative may
    /// jump between the ends.
    fn parts(&self, ends: [f64; 2]) -> Option<Vec<(usize, [f64; 2])>> {
        let [mut from, to] = ends.map_each(|x| self.knot_at(x));
        let mut parts = Vec::new();
        while from < to {
            let span = self.span(from);
            let knot = self.knots[span + 1];
            let is_last = knot >= to || knot >= self.knots[self.points()];
            parts.push((span, [from, if is_last { to } else { knot }]));
            if is_last {
                return Some(parts);
            }
            if self.knots.iter().filter(|k| **k == knot).count() + 2 > self.degree {
                return None;
            }
            from = knot;
        }
        None
    }

    /// de Boor: the `degree + 1` points of a span, `point(0)` the first, blended with a parameter for each step, from 1 to the degree
    /// (Ramshaw 1989).
    fn blossom(&self, span: usize, t: impl Fn(usize) -> f64, point: impl Fn(usize) -> DVec4) -> DVec4 {
        let p = self.degree;
        let mut d = [DVec4::ZERO; DEGREE_MAX + 1];
        d.iter_mut().take(p + 1).enumerate().for_each(|(j, d)| *d = point(j));
        for r in 1..=p {
            for j in (r..=p).rev() {
                let (low, high) = (self.knots[span - p + j], self.knots[span + 1 + j - r]);
                let s = (t(r) - low) / (high - low);
                d[j] = (1.0 - s) * d[j - 1] + s * d[j];
            }
        }
        d[p]
    }
}

const GRID_EXAMPLE: &str = "[[[-1, 1, 0], [1, 1, 0]], [[-1, -1, 0], [1, -1, 0]]]";

/// Basis along u, along v, and the control points row by row.
fn read_spline(table: &Table) -> Result<(Basis, Basis, Vec<DVec3>)> {
    let integer = |field: &Field| Ok(field.integer(1, DEGREE_MAX as u64)? as usize);
    let degree = table.need("degree", "3")?;
    let [p, q] = if degree.is_list() {
        let [p, q] = degree.array::<2>("a whole number, or two: along u and along v")?;
        [integer(&p)?, integer(&q)?]
    } else {
        [integer(&degree)?; 2]
    };
    let (columns, points) = read_grid(&table.need("points", GRID_EXAMPLE)?, &[p + 1, q + 1], POINTS_MAX, Field::vec3)?;
    let knots = |key: &str, degree: usize, count: usize| {
        table.or(key, Basis::uniform(degree, count), |field| read_knots(field, degree, count))
    };
    Ok((knots("knots_u", p, columns)?, knots("knots_v", q, points.len() / columns)?, points))
}

fn read_knots(field: &Field, degree: usize, points: usize) -> Result<Basis> {
    let expected = points + degree + 1;
    let items = field.items("a list of numbers that do not descend")?;
    let knots: Vec<f64> = items.map(|item| item.number()).collect::<Result<_>>()?;
    if knots.len() != expected {
        let count = knots.len();
        return Err(field.error(format_args!(
            "{count} knots; {points} control points of degree {degree} need {expected} (points + degree + 1)"
        )));
    }
    if let Some(k) = (1..expected).find(|&k| knots[k] < knots[k - 1]) {
        return Err(field.error(format_args!("knot {k} is below the one before it; knots must not descend")));
    }
    // every control point must have a say somewhere, so no knot is there more than degree + 1 times
    if let Some(k) = (0..points).find(|&k| knots[k] == knots[k + degree + 1]) {
        let knot = knots[k];
        return Err(field.error(format_args!("knot {knot} is there more than {} times", degree + 1)));
    }
    if knots[degree] == knots[points] {
        return Err(field.error("the patch has no extent; its inner knots are all the same"));
    }
    Ok(Basis { degree, knots })
}

/// A list of rows of equal length: the columns of a row, and all items row by row. `least` columns and rows.
fn read_grid<'a, T>(
    field: &Field<'a>,
    least: &[usize; 2],
    most: usize,
    read: impl Fn(&Field<'a>) -> Result<T>,
) -> Result<(usize, Vec<T>)> {
    let rows: Vec<Field> = field.items("a list of rows")?.collect();
    if !(least[1]..=most).contains(&rows.len()) {
        let count = rows.len();
        return Err(field.error(format_args!("{count} rows; {} to {most} are needed", least[1])));
    }
    let (mut columns, mut all) = (0, Vec::new());
    for (k, row) in rows.iter().enumerate() {
        let items: Vec<Field> = row.items("a row: a list")?.collect();
        let count = items.len();
        if !(least[0]..=most).contains(&count) {
            return Err(row.error(format_args!("{count} in this row; {} to {most} are needed", least[0])));
        }
        if k > 0 && count != columns {
            return Err(row.error(format_args!("{count} in this row and {columns} in the first; rows must be equal")));
        }
        columns = count;
        for item in items {
            all.push(read(&item)?);
        }
    }
    Ok((columns, all))
}
