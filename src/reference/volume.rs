//! What a volume does to the light along a path, by the definition: a differential equation, solved by steps that are halved until they
//! agree.

use super::path::{Path, Seen, Segment};
use crate::arrays::MapEach;
use crate::geometry::bernstein::Bernstein;
use crate::parallel;
use crate::scene::Scene;
use crate::scene::volume::{Mode, Volume};
use glam::{DAffine3, DVec3};

/// A scene's volume, and the light at its nodes.
pub struct Medium<'a> {
    volume: &'a Volume,
    to_grid: DAffine3,
    light: NodeLight,
}

/// What the colour is multiplied by at each node.
enum NodeLight {
    /// By 1.
    None,
    Given(Vec<DVec3>),
    /// By what a headlight makes of these normals.
    Headlight(Vec<DVec3>),
}

/// What comes out of a volume at the viewer's end of a path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Passed {
    /// The light that it sends out.
    pub light: [f64; 3],
    /// The share that it leaves of the light from behind it.
    pub left: f64,
}

impl Passed {
    pub const UNCHANGED: Passed = Passed { light: [0.0; 3], left: 1.0 };

    /// With light from behind.
    pub fn over(&self, behind: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map_each(|k| self.light[k] + self.left * behind[k])
    }

    fn then(&self, next: &Passed) -> Passed {
        Passed { light: self.over(next.light), left: self.left * next.left }
    }

    fn is_near(&self, other: &Passed) -> bool {
        let light = self.light.iter().zip(other.light).all(|(a, b)| (a - b).abs() <= TOLERANCE);
        light && (self.left - other.left).abs() <= TOLERANCE
    }
}

/// How near a step must be to its two halves. Some ten thousand steps then add up to less than 1e-6.
const TOLERANCE: f64 = 1e-11;

/// Once less light than this comes through, what lies behind is left out.
const DARK: f64 = 1e-9;

/// A step in which the transfer function has a corner is halved until no more than this is absorbed in it.
const CORNER: f64 = 1e-9;

/// Most halvings of a cell's stretch.
const LEVELS: u32 = 48;

/// Places of a cell's stretch at which the largest value is looked for, before it is enclosed.
const PLACES: u32 = 16;

/// Rounds of golden section that enclose it: 0.618^64 of a sixteenth of the stretch.
const ROUNDS: u32 = 64;

impl<'a> Medium<'a> {
    /// `None` if there is no volume.
    pub fn of(scene: &'a Scene) -> Option<Medium<'a>> {
        let volume = scene.volume.as_ref()?;
        let mut medium = Medium { volume, to_grid: volume.grid.to_world.inverse(), light: NodeLight::None };
        if volume.is_lit {
            let normals = medium.normals();
            medium.light = match scene.has_headlight() {
                true => NodeLight::Headlight(normals),
                false => NodeLight::Given(medium.lit(scene, &normals)),
            };
        }
        Some(medium)
    }

    /// Along a path up to what is seen.
    pub fn along(&self, path: &Path, seen: Option<&Seen>) -> Passed {
        let stretches = path.segments.iter().enumerate().filter_map(|(layer, segment)| {
            let (_, segment) = segment.as_ref()?;
            let [first, last] = path.t_range;
            let last = match seen {
                Some(seen) if seen.layer < layer => return None,
                Some(seen) if seen.layer == layer => seen.hit.t,
                _ => last,
            };
            Some((segment, self.cuts(segment, [first, last])))
        });
        match self.volume.mode {
            Mode::Composite => stretches.fold(Passed::UNCHANGED, |passed, (segment, cuts)| {
                cuts.windows(2).fold(passed, |passed, ends| self.stretch(segment, [ends[0], ends[1]], passed))
            }),
            Mode::Maximum => {
                let largest = stretches.flat_map(|(segment, cuts)| {
                    cuts.windows(2).map(|ends| self.largest(segment, [ends[0], ends[1]])).collect::<Vec<_>>()
                });
                let largest = largest.fold(f64::NEG_INFINITY, f64::max);
                if largest == f64::NEG_INFINITY {
                    return Passed::UNCHANGED;
                }
                // as one world unit of this value
                let (colour, extinction) = self.look(largest);
                let left = (-extinction).exp();
                Passed { light: colour.map_each(|c| c * (1.0 - left)), left }
            }
        }
    }

    /// Where a segment enters and leaves the cells of the grid, between two t; none outside of it.
    fn cuts(&self, segment: &Segment, [first, last]: [f64; 2]) -> Vec<f64> {
        let most = DVec3::from(self.volume.grid.sides.map_each(|n| f64::from(n - 1)));
        let mut cuts = Vec::new();
        match segment {
            Segment::Straight(bundle) => {
                let ray = bundle.ray(0.0, 0.0);
                let (p, d) = (self.to_grid.transform_point3(ray.origin), self.to_grid.transform_vector3(ray.direction));
                for axis in 0..3 {
                    let planes = (0..self.volume.grid.sides[axis]).map(f64::from);
                    cuts.extend(planes.map(|plane| (plane - p[axis]) / d[axis]).filter(|t| t.is_finite()));
                }
                cuts.retain(|t| first < *t && *t < last);
                cuts.extend([first, last].iter().filter(|t| t.is_finite()));
            }
            Segment::Curved(curve) => {
                let points: Vec<DVec3> = curve.points().iter().map(|p| self.to_grid.transform_point3(*p)).collect();
                for axis in 0..3 {
                    let own: Vec<f64> = points.iter().map(|p| p[axis]).collect();
                    let (lo, hi) = own.iter().fold((f64::MAX, f64::MIN), |(lo, hi), x| (lo.min(*x), hi.max(*x)));
                    let planes = (0..self.volume.grid.sides[axis]).map(f64::from).filter(|x| lo <= *x && *x <= hi);
                    for plane in planes {
                        let from: Vec<f64> = own.iter().map(|x| x - plane).collect();
                        cuts.extend(Bernstein::new(&from).roots(0.0).iter().map(|root| root.t));
                    }
                }
                cuts.retain(|t| first < *t && *t < last);
                cuts.extend([first.max(0.0), last.min(1.0)]);
            }
        }
        cuts.sort_by(f64::total_cmp);
        cuts.dedup();
        let is_inside = |a: f64, b: f64| {
            let x = self.to_grid.transform_point3(segment.point(0.5 * (a + b)));
            x.cmpge(DVec3::ZERO).all() && x.cmple(most).all()
        };
        // a straight ray crosses the grid once; a curve may leave it and come back, between which nothing is looked up
        let inside: Vec<bool> = cuts.windows(2).map(|c| is_inside(c[0], c[1])).collect();
        let (Some(a), Some(b)) = (inside.iter().position(|i| *i), inside.iter().rposition(|i| *i)) else {
            return Vec::new();
        };
        cuts[a..=b + 1].to_vec()
    }

    /// Through one cell, front to back.
    fn stretch(&self, segment: &Segment, ends: [f64; 2], mut passed: Passed) -> Passed {
        let middle = segment.point(0.5 * (ends[0] + ends[1]));
        let steepest = self.steepest(self.to_grid.transform_point3(middle));
        let mut todo = vec![(ends, LEVELS)];
        while let Some(([a, b], levels)) = todo.pop() {
            if passed.left < DARK {
                return passed;
            }
            let m = 0.5 * (a + b);
            let whole = self.step(segment, [a, b]);
            let halves = self.step(segment, [a, m]).then(&self.step(segment, [m, b]));
            let has_corner = self.has_corner(segment, [a, b], steepest);
            let absorbed = self.volume.extinction_max() * (segment.point(b) - segment.point(a)).length();
            let agree = whole.is_near(&halves) && (!has_corner || absorbed <= CORNER);
            if agree || levels == 0 {
                passed = passed.then(&halves);
            } else {
                todo.extend([([m, b], levels - 1), ([a, m], levels - 1)]);
            }
        }
        passed
    }

    /// A step of Runge and Kutta's classical method for light' = colour x extinction x left, left' = -extinction x left, over the length.
    fn step(&self, segment: &Segment, [a, b]: [f64; 2]) -> Passed {
        let h = b - a;
        let [start, middle, end] = [a, 0.5 * (a + b), b].map_each(|t| self.sample(segment, t));
        let slope = |(colour, rate): &([f64; 3], f64), left: f64| (colour.map_each(|c| c * rate * left), -rate * left);
        let k1 = slope(&start, 1.0);
        let k2 = slope(&middle, 1.0 + 0.5 * h * k1.1);
        let k3 = slope(&middle, 1.0 + 0.5 * h * k2.1);
        let k4 = slope(&end, 1.0 + h * k3.1);
        let sum = |a: f64, b: f64, c: f64, d: f64| h / 6.0 * (a + 2.0 * b + 2.0 * c + d);
        Passed {
            light: [0, 1, 2].map_each(|k| sum(k1.0[k], k2.0[k], k3.0[k], k4.0[k])),
            left: 1.0 + sum(k1.1, k2.1, k3.1, k4.1),
        }
    }

    /// The colour at t, and the extinction per t.
    fn sample(&self, segment: &Segment, t: f64) -> ([f64; 3], f64) {
        let x = self.to_grid.transform_point3(segment.point(t));
        let most = DVec3::from(self.volume.grid.sides.map_each(|n| f64::from(n - 1)));
        // a little outside: the border of the grid, or a curve that has left it
        if (x - x.clamp(DVec3::ZERO, most)).abs().max_element() > BORDER {
            return ([0.0; 3], 0.0);
        }
        let (colour, extinction) = self.look(self.value(x));
        let factor = self.factor(x, || segment.view(t));
        ([0, 1, 2].map_each(|k| colour[k] * factor[k]), extinction * segment.direction(t).length())
    }

    /// The step may meet a corner of the transfer function: a control point lies between the values at five places, or no farther from
    /// them than the value can change between two of these.
    fn has_corner(&self, segment: &Segment, [a, b]: [f64; 2], steepest: DVec3) -> bool {
        let place = |share: f64| self.to_grid.transform_point3(segment.point(a + share * (b - a)));
        let places = [0.0, 0.25, 0.5, 0.75, 1.0].map(place);
        let values = places.map(|x| self.value(x));
        let (lo, hi) = values.iter().fold((f64::MAX, f64::MIN), |(lo, hi), v| (lo.min(*v), hi.max(*v)));
        let between = places.windows(2).map(|x| (x[1] - x[0]).abs().dot(steepest)).fold(0.0, f64::max);
        let (lo, hi) = (lo - between, hi + between);
        let rounding = ROUNDED * lo.abs().max(hi.abs());
        let mut corners = self.volume.transfer.iter().map(|p| f64::from(p.value));
        corners.any(|corner| lo + rounding < corner && corner < hi - rounding)
    }

    /// How much the value changes at most along each axis of the cell that holds a place, per node.
    fn steepest(&self, x: DVec3) -> DVec3 {
        let grid = &self.volume.grid;
        let cell = [0, 1, 2].map_each(|axis| x[axis].floor().clamp(0.0, f64::from(grid.sides[axis] - 2)) as u32);
        let value = |n: u32| {
            let node = [cell[0] + (n & 1), cell[1] + (n >> 1 & 1), cell[2] + (n >> 2)];
            f64::from(grid.values[grid.index(node)])
        };
        let along = |bit: u32| {
            let edges = (0..8).filter(|n| n & bit == 0).map(|n| (value(n | bit) - value(n)).abs());
            edges.fold(0.0, f64::max)
        };
        DVec3::new(along(1), along(2), along(4))
    }

    /// The largest value in one cell.
    fn largest(&self, segment: &Segment, [a, b]: [f64; 2]) -> f64 {
        let value = |t: f64| self.value(self.to_grid.transform_point3(segment.point(t)));
        let place = |k: u32| a + (b - a) * f64::from(k) / f64::from(PLACES);
        let best = (0..=PLACES).max_by(|i, j| value(place(*i)).total_cmp(&value(place(*j)))).unwrap_or(0);
        let (mut lo, mut hi) = (place(best.saturating_sub(1)), place((best + 1).min(PLACES)));
        for _ in 0..ROUNDS {
            let share = 0.381_966_011_250_105 * (hi - lo);
            if value(lo + share) < value(hi - share) { lo += share } else { hi -= share }
        }
        value(place(best)).max(value(0.5 * (lo + hi)))
    }

    /// Colour and extinction of a value.
    fn look(&self, value: f64) -> ([f64; 3], f64) {
        let points = &self.volume.transfer;
        let after = points.partition_point(|p| f64::from(p.value) <= value);
        let (p, q) = (&points[after.saturating_sub(1)], &points[after.min(points.len() - 1)]);
        let width = f64::from(q.value) - f64::from(p.value);
        let share = if width > 0.0 { ((value - f64::from(p.value)) / width).clamp(0.0, 1.0) } else { 0.0 };
        let between = |a: f32, b: f32| (1.0 - share) * f64::from(a) + share * f64::from(b);
        ([0, 1, 2].map_each(|k| between(p.colour[k], q.colour[k])), between(p.extinction, q.extinction))
    }

    /// Trilinear in grid coordinates, of numbers at the nodes.
    fn interpolated<T>(&self, x: DVec3, at: impl Fn(usize) -> T) -> T
    where
        T: std::ops::Mul<f64, Output = T> + std::iter::Sum,
    {
        let grid = &self.volume.grid;
        let cell = [0, 1, 2].map_each(|axis| x[axis].floor().clamp(0.0, f64::from(grid.sides[axis] - 2)));
        let share = (x - DVec3::from(cell)).clamp(DVec3::ZERO, DVec3::ONE);
        let corner = |n: u32| {
            let steps = [n & 1, n >> 1 & 1, n >> 2];
            let weight: f64 = (0..3).map(|k| if steps[k] == 1 { share[k] } else { 1.0 - share[k] }).product();
            at(grid.index([0, 1, 2].map_each(|k| cell[k] as u32 + steps[k]))) * weight
        };
        (0..8).map(corner).sum()
    }

    fn value(&self, x: DVec3) -> f64 {
        self.interpolated(x, |n| f64::from(self.volume.grid.values[n]))
    }

    /// What the colour is multiplied by; a headlight's direction is that of the ray.
    fn factor(&self, x: DVec3, view: impl Fn() -> DVec3) -> [f64; 3] {
        match &self.light {
            NodeLight::None => [1.0; 3],
            NodeLight::Given(light) => self.interpolated(x, |n| light[n]).to_array(),
            NodeLight::Headlight(normals) => {
                let along = view();
                let of = |n: DVec3| if n == DVec3::ZERO { 1.0 } else { 0.1 + 0.9 * n.dot(along).abs() };
                [self.interpolated(x, |n| of(normals[n])); 3]
            }
        }
    }

    /// Unit vectors against the gradient at the nodes, by differences of neighbours; 0 where all are 0.
    fn normals(&self) -> Vec<DVec3> {
        let grid = &self.volume.grid;
        let [nx, ny, _] = grid.sides.map_each(|n| n as usize);
        let normal = |n: usize| {
            let node = [n % nx, n / nx % ny, n / nx / ny].map_each(|i| i as u32);
            let mut slope = [0.0; 3];
            for axis in 0..3 {
                let (mut a, mut b) = (node, node);
                a[axis] -= u32::from(a[axis] > 0);
                b[axis] += u32::from(b[axis] + 1 < grid.sides[axis]);
                let rise = f64::from(grid.values[grid.index(b)]) - f64::from(grid.values[grid.index(a)]);
                slope[axis] = rise / f64::from(b[axis] - a[axis]);
            }
            // its change along a world vector v is slope . (to_grid v)
            let own = DVec3::from(slope);
            let m = self.to_grid.matrix3;
            -DVec3::new(m.x_axis.dot(own), m.y_axis.dot(own), m.z_axis.dot(own)).normalize_or_zero()
        };
        parallel::map(0..grid.values.len(), normal)
    }

    /// The light that white matte surfaces with these normals send back from the nodes.
    fn lit(&self, scene: &Scene, normals: &[DVec3]) -> Vec<DVec3> {
        let grid = &self.volume.grid;
        let [nx, ny, _] = grid.sides.map_each(|n| n as usize);
        let lit = |n: usize| {
            let normal = normals[n];
            if normal == DVec3::ZERO {
                return DVec3::ONE;
            }
            let node = DVec3::new((n % nx) as f64, (n / nx % ny) as f64, (n / nx / ny) as f64);
            let place = grid.to_world.transform_point3(node);
            let lights = scene.lights.iter().map(|light| light.arriving(place));
            let direct: DVec3 = lights.map(|l| l.strength * normal.dot(l.to_light).max(0.0)).sum();
            match &scene.sky {
                Some(sky) => sky.irradiance(normal).max(DVec3::ZERO) + direct,
                None => DVec3::splat(0.1) + 0.9 * direct,
            }
        };
        parallel::map(0..normals.len(), lit)
    }
}

/// Values this near a control point are taken for it, relative to their size: where all nodes have its value, interpolation rounds them.
const ROUNDED: f64 = 1.0 / (1u64 << 40) as f64;

/// How far outside of the grid its border may be found by rounding, cells.
const BORDER: f64 = 1e-6;
