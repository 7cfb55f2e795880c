//! Shapes of mirrors and lenses: read from a scene file, as smooth surfaces, and as facets.

use super::facets::Facets;
use super::quadric::{Quadric, sag};
use super::wave::WAVES_MAX;
use super::{Smooth, Torus, Wave};
use crate::arrays::MapEach;
use crate::camera::values::{direction, length};
use crate::input::Result;
use crate::input::reader::{Field, Table};
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// A surface by name. World units; axes are unit vectors.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    Sphere {
        center: DVec3,
        radius: f64,
    },
    Torus(Torus),
    /// [`Quadric::cap`].
    Quadric {
        cap: Cap,
    },
    /// Two caps and the wall between their rims; the outside of each is away from the other.
    Lens {
        caps: [Cap; 2],
    },
    Wave(Wave),
}

/// One face of a lens, as [`Quadric::cap`] takes it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cap {
    pub vertex: DVec3,
    pub axis: DVec3,
    pub curvature: f64,
    pub conic: f64,
    pub rim: f64,
    pub flipped: bool,
}

/// Default number of facets of a shape: that of the largest mirror in Yu et al., figure 8.
const COUNT: u64 = 960;
/// Most facets of a shape: about 200 bytes each on the device.
pub const COUNT_MAX: u64 = 600_000;

impl Cap {
    fn quadric(&self) -> Quadric {
        Quadric::cap(self.vertex, self.axis, self.curvature, self.conic, self.rim, self.flipped)
            .expect("a cap is read only where it reaches its rim")
    }

    /// Height of the rim over the vertex, along the axis.
    fn rim_height(&self) -> f64 {
        sag(self.curvature, self.conic, self.rim).expect("a cap is read only where it reaches its rim")
    }

    fn checked(self, field: &Field) -> Result<Cap> {
        if sag(self.curvature, self.conic, self.rim).is_some() {
            return Ok(self);
        }
        let widest = (1.0 / (1.0 + self.conic)).sqrt() / self.curvature.abs();
        Err(field.error(format_args!("{} is beyond the surface, which is {widest} wide at most; use less", self.rim)))
    }
}

impl Shape {
    /// Reads a table with a `shape`, and the number of facets if it is given.
    pub fn read(table: &Table, shape: &Field) -> Result<(Shape, usize)> {
        let name = shape.text()?;
        let own: &[&str] = match name {
            "sphere" => &["center", "radius"],
            "torus" => &["center", "axis", "radius", "tube"],
            "quadric" => &["vertex", "axis", "curvature", "conic", "radius"],
            "lens" => &["center", "axis", "radius", "thickness", "curvatures", "conics"],
            "wave" => &["center", "size", "amplitude", "wavelength"],
            _ => {
                let known = "\"sphere\", \"torus\", \"quadric\", \"lens\", \"wave\"";
                return Err(
                    shape.error(format_args!("{name:?} is no shape; use {known}, or a mesh by file or builtin"))
                );
            }
        };
        table.allow(&[&["shape", "count", "cameras"][..], own].concat())?;
        let count = table.or("count", COUNT, |f| f.integer(4, COUNT_MAX))? as usize;
        let center = |key| table.or(key, DVec3::ZERO, Field::vec3);
        let axis = || table.or("axis", DVec3::Y, direction);
        let radius = || -> Result<f64> { length(&table.need("radius", "1")?) };
        let shape = match name {
            "sphere" => Shape::Sphere { center: center("center")?, radius: radius()? },
            "torus" => {
                let (radius, tube) = (radius()?, length(&table.need("tube", "0.3")?)?);
                Shape::Torus(Torus { centre: center("center")?, axis: axis()?, radius, tube })
            }
            "quadric" => {
                let curvature = table.need("curvature", "0.5")?.number()?;
                let conic = table.or("conic", 0.0, Field::number)?;
                let (vertex, axis, rim) = (center("vertex")?, axis()?, radius()?);
                let cap = Cap { vertex, axis, curvature, conic, rim, flipped: false };
                Shape::Quadric { cap: cap.checked(&table.need("radius", "1")?)? }
            }
            "lens" => Shape::Lens { caps: read_lens(table, center("center")?, axis()?, radius()?)? },
            _ => {
                let of = |key, example| -> Result<f64> { length(&table.need(key, example)?) };
                let (size, amplitude, wavelength) = (of("size", "4")?, of("amplitude", "0.1")?, of("wavelength", "1")?);
                if size > WAVES_MAX * wavelength {
                    let why =
                        format_args!("{} waves along a side are too many; use {WAVES_MAX} at most", size / wavelength);
                    return Err(table.need("wavelength", "1")?.error(why));
                }
                Shape::Wave(Wave { centre: center("center")?, size, amplitude, wavelength })
            }
        };
        Ok((shape, count))
    }

    /// The exact, smooth shape.
    pub fn smooth(&self) -> Smooth {
        match self {
            Shape::Sphere { center, radius } => Smooth::Quadrics(vec![Quadric::sphere(*center, *radius)]),
            Shape::Torus(torus) => Smooth::Torus(*torus),
            Shape::Quadric { cap } => Smooth::Quadrics(vec![cap.quadric()]),
            Shape::Lens { caps } => {
                let [front, back] = caps;
                let [from, to] = wall_ends(caps);
                let mut list = vec![front.quadric(), back.quadric()];
                if to > from {
                    list.push(Quadric::wall(front.vertex, front.axis, front.rim, [from, to]));
                }
                Smooth::Quadrics(list)
            }
            Shape::Wave(wave) => Smooth::Wave(*wave),
        }
    }

    /// As about `count` facets with the surface's own normals at their corners: as near to it as a grid comes whose cells
    /// are nearly square, and exact where that has such a grid.
    pub fn facets(&self, count: usize) -> Facets {
        match self {
            Shape::Sphere { center, radius } => {
                let (around, stacks) = cells(count, |n, s| 2 * n * s.saturating_sub(1), 2.0);
                let row = |k: usize| {
                    let p = PI * k as f64 / stacks as f64;
                    let ring = |l: f64| DVec3::new(p.sin() * l.sin(), p.cos(), p.sin() * l.cos());
                    let poles = [DVec3::Y, DVec3::NEG_Y];
                    let units = match k {
                        0 => vec![poles[0]],
                        _ if k == stacks => vec![poles[1]],
                        _ => angles(around).map(ring).collect(),
                    };
                    units.into_iter().map(|n| (*center + *radius * n, n)).collect()
                };
                grid((0..=stacks).map(row).collect(), true)
            }
            Shape::Torus(torus) => {
                let Torus { centre, axis, radius, tube } = *torus;
                // a tube of two sides is flat
                let triangles = |n: usize, s: usize| if s < 3 { usize::MAX } else { 2 * n * s };
                let (around, sides) = cells(count, triangles, radius / tube);
                let (e1, e2) = axis.any_orthonormal_pair();
                let row = |k: usize| {
                    let ring = |l: f64| {
                        let p = TAU * (k % sides) as f64 / sides as f64;
                        let out = l.cos() * e1 + l.sin() * e2;
                        let n = p.cos() * out + p.sin() * axis;
                        // beyond the axis, where the tube is that wide, it is within itself
                        let side = if radius + tube * p.cos() < 0.0 { -1.0 } else { 1.0 };
                        (centre + radius * out + tube * n, side * n)
                    };
                    angles(around).map(ring).collect()
                };
                grid((0..=sides).map(row).collect(), true)
            }
            Shape::Quadric { cap } => {
                let (around, rings) = cells(count, |n, s| n * (2 * s - 1), 4.0);
                disc(cap, around, rings)
            }
            Shape::Lens { caps } => {
                // two faces and a wall
                let (around, rings) = cells(count, |n, s| 2 * n * (2 * s - 1) + 2 * n, 4.0);
                joined(&[disc(&caps[0], around, rings), disc(&caps[1], around, rings), wall(caps, around)])
            }
            Shape::Wave(wave) => {
                let (columns, rows) = cells(count, |n, s| 2 * n * s, 1.0);
                let point = |i: usize, j: usize| {
                    let side = |k: usize, of: usize| (k as f64 / of as f64 - 0.5) * wave.size;
                    let q = DVec3::new(side(i, columns), 0.0, side(j, rows));
                    let place = wave.centre + q + wave.height(q) * DVec3::Y;
                    (place, wave.normal(place).normalize())
                };
                grid((0..=rows).map(|j| (0..=columns).map(|i| point(i, j)).collect()).collect(), false)
            }
        }
    }
}

fn read_lens(table: &Table, center: DVec3, axis: DVec3, rim: f64) -> Result<[Cap; 2]> {
    let key = table.need("curvatures", "[0.5, -0.5]")?;
    let curvatures = key.numbers::<2>("two curvatures, 1 / radius, above 0 where the centre lies along the axis")?;
    let conics = table.or("conics", [0.0; 2], |f| f.numbers("two conic constants"))?;
    let thickness = table.need("thickness", "0.4")?;
    let half = length(&thickness)? / 2.0;
    let cap = |k: usize| {
        let vertex = center + [-half, half][k] * axis;
        Cap { vertex, axis, curvature: curvatures[k], conic: conics[k], rim, flipped: k == 1 }.checked(&key)
    };
    let caps = [cap(0)?, cap(1)?];
    let [from, to] = wall_ends(&caps);
    if to < from {
        let least = 2.0 * half + from - to;
        return Err(thickness.error(format_args!("the faces cross before the rim; use at least {least}")));
    }
    Ok(caps)
}

/// Where the wall of a lens begins and ends along the axis, from the first vertex.
fn wall_ends(caps: &[Cap; 2]) -> [f64; 2] {
    let thickness = (caps[1].vertex - caps[0].vertex).dot(caps[0].axis);
    [caps[0].rim_height(), thickness + caps[1].rim_height()]
}

/// Cells along both sides of a grid of about `count` triangles: `triangles` of them, and the first side about `ratio` times
/// the second.
fn cells(count: usize, triangles: impl Fn(usize, usize) -> usize, ratio: f64) -> (usize, usize) {
    let most = (2.0 * ((count as f64) * ratio).sqrt()).ceil().min(count as f64) as usize + 3;
    let second = |n: usize| {
        let fit = (2..=count + 2).take_while(|s| *s == 2 || triangles(n, *s) <= count).last().unwrap_or(2);
        [fit, fit + 1]
    };
    let shape = |n: usize, s: usize| (n as f64 / s as f64 / ratio).ln().abs();
    let key = |&(n, s): &(usize, usize)| (triangles(n, s).abs_diff(count), shape(n, s));
    let all = (3..=most.max(4)).flat_map(|n| second(n).map_each(|s| (n, s)));
    // long thin grids only where nothing else comes near
    let fair = |q: &(usize, usize)| shape(q.0, q.1) < 1.1;
    let best = |list: Vec<(usize, usize)>| {
        list.into_iter().min_by(|a, b| key(a).0.cmp(&key(b).0).then(key(a).1.total_cmp(&key(b).1)))
    };
    let all: Vec<_> = all.collect();
    best(all.iter().copied().filter(fair).collect()).or_else(|| best(all)).unwrap_or((3, 2))
}

/// `n` angles around a circle.
fn angles(n: usize) -> impl Iterator<Item = f64> {
    (0..n).map(move |k| TAU * k as f64 / n as f64)
}

/// A cap as rings about its vertex.
fn disc(cap: &Cap, around: usize, rings: usize) -> Facets {
    let quadric = cap.quadric();
    let (e1, e2) = cap.axis.any_orthonormal_pair();
    let row = |k: usize| {
        let r = cap.rim * k as f64 / rings as f64;
        let height = sag(cap.curvature, cap.conic, r).unwrap_or_else(|| cap.rim_height());
        let at = |l: f64| cap.vertex + r * (l.cos() * e1 + l.sin() * e2) + height * cap.axis;
        let point = |p: DVec3| (p, quadric.normal(p).normalize());
        if k == 0 { vec![point(cap.vertex)] } else { angles(around).map(|l| point(at(l))).collect() }
    };
    grid((0..=rings).map(row).collect(), true)
}

/// The wall between the rims of a lens.
fn wall(caps: &[Cap; 2], around: usize) -> Facets {
    let [from, to] = wall_ends(caps);
    if to <= from {
        return Facets::default();
    }
    let (e1, e2) = caps[0].axis.any_orthonormal_pair();
    let row = |height: f64| {
        let point = |l: f64| {
            let out = l.cos() * e1 + l.sin() * e2;
            (caps[0].vertex + caps[0].rim * out + height * caps[0].axis, out)
        };
        angles(around).map(point).collect()
    };
    grid(vec![row(from), row(to)], true)
}

/// Rows of points with normals, joined by triangles: a row of one point is a pole; `closed` rows go around.
fn grid(rows: Vec<Vec<(DVec3, DVec3)>>, closed: bool) -> Facets {
    let mut facets = Facets::default();
    let mut starts = Vec::new();
    for row in &rows {
        starts.push(facets.positions.len() as u32);
        facets.positions.extend(row.iter().map(|p| p.0));
        facets.normals.extend(row.iter().map(|p| p.1));
    }
    for k in 1..rows.len() {
        let (a, b) = (rows[k - 1].len() as u32, rows[k].len() as u32);
        let cells = if closed { a.max(b) } else { a.max(b) - 1 };
        let at = |row: usize, count: u32, i: u32| starts[row] + if count == 1 { 0 } else { i % count };
        for i in 0..cells {
            let quad = [at(k - 1, a, i), at(k - 1, a, i + 1), at(k, b, i + 1), at(k, b, i)];
            for t in [[quad[0], quad[1], quad[2]], [quad[0], quad[2], quad[3]]] {
                facets.push(t);
            }
        }
    }
    facets
}

impl Facets {
    /// Adds a triangle that has an area, its outside where its corners' normals point.
    fn push(&mut self, mut t: [u32; 3]) {
        let [a, b, c] = t.map_each(|k| self.positions[k as usize]);
        let cross = (b - a).cross(c - a);
        let out: DVec3 = t.iter().map(|k| self.normals[*k as usize]).sum();
        if t[0] == t[1] || t[1] == t[2] || t[2] == t[0] || cross == DVec3::ZERO {
            return;
        }
        if cross.dot(out) < 0.0 {
            t.swap(1, 2);
        }
        self.triangles.push(t);
        self.corner_normals.push(t);
    }
}

/// All triangles of these, one after the other.
fn joined(list: &[Facets]) -> Facets {
    let mut all = Facets::default();
    for f in list {
        let (p, n) = (all.positions.len() as u32, all.normals.len() as u32);
        all.positions.extend(&f.positions);
        all.normals.extend(&f.normals);
        all.triangles.extend(f.triangles.iter().map(|t| t.map_each(|k| k + p)));
        all.corner_normals.extend(f.corner_normals.iter().map(|t| t.map_each(|k| k + n)));
    }
    all
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// A cap of a sphere about the z axis.
    pub fn cap(z: f64, curvature: f64, rim: f64, flipped: bool) -> Cap {
        Cap { vertex: DVec3::Z * z, axis: DVec3::Z, curvature, conic: 0.0, rim, flipped }
    }

    pub fn torus() -> Shape {
        Shape::Torus(Torus { centre: DVec3::ONE, axis: DVec3::X, radius: 2.0, tube: 0.5 })
    }

    fn shapes() -> Vec<Shape> {
        vec![
            Shape::Sphere { center: DVec3::ONE, radius: 2.0 },
            torus(),
            Shape::Quadric { cap: cap(0.0, 0.5, 1.0, false) },
            Shape::Lens { caps: [cap(-0.4, 0.5, 1.0, false), cap(0.4, -0.5, 1.0, true)] },
            Shape::Wave(Wave { centre: DVec3::ONE, size: 4.0, amplitude: 0.2, wavelength: 2.0 }),
        ]
    }

    #[test]
    fn a_sphere_has_the_counts_of_the_papers() {
        let sphere = &shapes()[0];
        for count in [126, 360, 640, 960] {
            assert_eq!(sphere.facets(count).triangles.len(), count);
        }
        let many = sphere.facets(100_000).triangles.len();
        assert!(many.abs_diff(100_000) < 200, "{many}");
    }

    #[test]
    fn facets_come_near_their_count_and_face_outside() {
        for shape in shapes() {
            for count in [60, 300, 5000] {
                let facets = shape.facets(count);
                let n = facets.triangles.len();
                assert!(n.abs_diff(count) as f64 <= 0.2 * count as f64, "{shape:?}: {n} for {count}");
                for k in 0..n {
                    let f = facets.facet(k);
                    let cross = (f.corners[1] - f.corners[0]).cross(f.corners[2] - f.corners[0]);
                    assert!(f.normals.iter().all(|n| n.dot(cross) > 0.0), "{shape:?}: facet {k} of {n}");
                }
            }
        }
    }

    /// Every edge of a closed shape belongs to two triangles, the other way round in each, by position.
    #[test]
    fn closed_shapes_are_closed() {
        for shape in shapes().into_iter().filter(|s| !matches!(s, Shape::Wave(_) | Shape::Quadric { .. })) {
            let facets = shape.facets(500);
            let mut balance = std::collections::HashMap::new();
            let bits = |p: DVec3| (p * 1e9).round().as_i64vec3().to_array();
            for k in 0..facets.triangles.len() {
                let c = facets.facet(k).corners.map(bits);
                for (a, b) in [(c[0], c[1]), (c[1], c[2]), (c[2], c[0])] {
                    *balance.entry((a.min(b), a.max(b))).or_insert(0) += if a < b { 1 } else { -1 };
                }
            }
            let open = balance.values().filter(|n| **n != 0).count();
            assert_eq!(open, 0, "{shape:?}");
        }
    }

    #[test]
    fn a_torus_of_few_facets_has_an_inside() {
        for count in [4, 12, 26, 40] {
            let facets =
                Shape::Torus(Torus { centre: DVec3::ZERO, axis: DVec3::Y, radius: 1.15, tube: 0.42 }).facets(count);
            let volume = |k: usize| {
                let [a, b, c] = facets.facet(k).corners;
                a.dot(b.cross(c)) / 6.0
            };
            let all: f64 = (0..facets.triangles.len()).map(volume).sum();
            // inscribed: three sides of three have (27 / 16) / pi^2 of the torus's
            let whole = 2.0 * PI * PI * 1.15 * 0.42 * 0.42;
            assert!(all > 0.15 * whole && all < whole, "{count}: {all} of {whole}");
        }
    }

    #[test]
    fn corners_of_facets_lie_on_the_quadrics() {
        for shape in shapes() {
            let Smooth::Quadrics(quadrics) = shape.smooth() else { continue };
            for p in shape.facets(300).positions {
                let off = |q: &Quadric| {
                    let r = p - q.centre;
                    (r.dot(q.a * r) + 2.0 * q.b.dot(r) + q.c).abs()
                };
                let least = quadrics.iter().map(off).fold(f64::INFINITY, f64::min);
                assert!(least < 1e-14, "{shape:?}: {least}");
            }
        }
    }
}
