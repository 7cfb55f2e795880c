//! Gradients by their definitions: numbers that carry their derivative go through the formulas of t, weights and distances. In f64.

use super::dual::{Dual, Number};
use crate::arrays::MapEach;
use crate::camera::change::PixelRay;
use crate::parallel;
use crate::scene::gradients::{HIT_NUMBERS, NONE, Seen, VERTEX_DIRECTIONS};
use glam::DVec3;

/// The changes of a pixel along some directions.
#[derive(Debug, Clone, Default)]
pub struct PixelChange {
    /// t, Z, position and weights, and for each direction how they change; empty where nothing is hit.
    pub hit: Vec<[f64; HIT_NUMBERS]>,
    pub values: [f64; HIT_NUMBERS],
    pub edge: Option<Edge>,
}

/// The edge that passes through a pixel.
#[derive(Debug, Clone, PartialEq)]
pub struct Edge {
    /// The triangle, and the number of its edge: from corner k to the next.
    pub triangle: u32,
    pub number: usize,
    /// The pixel that shows the triangle, and the one beyond.
    pub pixels: [u32; 2],
    /// Of the pixel's centre from the edge, px, positive inside.
    pub distance: f64,
    /// How much of the pixel the triangle covers, and for each direction how that changes.
    pub coverage: f64,
    pub change: Vec<f64>,
}

/// A ray, a triangle, and how both change along a direction.
#[derive(Debug, Clone, Copy)]
pub struct Direction<'a> {
    /// How the rays of all pixels change; `None`: they stay.
    pub rays: Option<&'a [PixelRay]>,
    /// Which coordinate of the triangle's corners grows, of [`VERTEX_DIRECTIONS`].
    pub coordinate: Option<usize>,
}

impl Direction<'_> {
    /// The coordinates of a triangle's corners.
    pub fn vertices() -> [Direction<'static>; VERTEX_DIRECTIONS] {
        std::array::from_fn(|k| Direction { rays: None, coordinate: Some(k) })
    }
}

/// The changes of all pixels, row by row.
pub fn changes(seen: &Seen, directions: &[Direction]) -> Vec<PixelChange> {
    parallel::map(0..seen.ids.len(), |pixel| of_pixel(seen, pixel, directions))
}

fn of_pixel(seen: &Seen, pixel: usize, directions: &[Direction]) -> PixelChange {
    let mut change = PixelChange::default();
    let id = seen.ids[pixel];
    if id != NONE {
        let corners = (seen.corners)(id);
        for direction in directions {
            let (ray, corners) = moving(seen.rays[pixel], corners, pixel, direction);
            let hit = hit(&ray, &corners);
            change.values = hit.map(|number| number.value);
            change.hit.push(hit.map(|number| number.rate));
        }
    }
    if seen.has_edges && seen.rays[pixel].iter().all(|number| number.is_finite()) {
        change.edge = nearest_edge(seen, pixel).map(|edge| Edge {
            change: directions.iter().map(|direction| coverage_rate(seen, pixel, &edge, direction)).collect(),
            ..edge
        });
    }
    change
}

/// How the coverage of an edge's triangle changes.
fn coverage_rate(seen: &Seen, pixel: usize, edge: &Edge, direction: &Direction) -> f64 {
    if edge.distance.abs() >= 0.5 {
        return 0.0;
    }
    let (ray, corners) = moving(seen.rays[pixel], (seen.corners)(edge.triangle), pixel, direction);
    let distance = distance(&ray, &corners, edge.number).rate;
    if is_inside_positive(seen, edge) { distance } else { -distance }
}

/// Whether E is positive inside the edge's triangle, at the pixel that shows it.
fn is_inside_positive(seen: &Seen, edge: &Edge) -> bool {
    let ray = vectors(seen.rays[edge.pixels[0] as usize]);
    across(&ray, &(seen.corners)(edge.triangle).map_each(|v| v.to_array())) > 0.0
}

/// Distances (px), shares of a way, and depths (relative) that differ by less are equal: rounding does not choose between them.
const LEVEL: f64 = 1.0 / (1 << 20) as f64;

/// The nearest of the edges between the pixel and its neighbours.
fn nearest_edge(seen: &Seen, pixel: usize) -> Option<Edge> {
    let (width, height) = (seen.width as usize, seen.height as usize);
    let (i, j) = (pixel % width, pixel / width);
    let around = [
        (i > 0).then(|| pixel - 1),
        (i + 1 < width).then(|| pixel + 1),
        (j > 0).then(|| pixel - width),
        (j + 1 < height).then(|| pixel + width),
    ];
    let mut nearest: Option<Edge> = None;
    for neighbour in around.into_iter().flatten() {
        let Some((triangle, number, pixels)) = edge_between(seen, pixel, neighbour) else { continue };
        let (ray, corners) = (vectors(seen.rays[pixel]), (seen.corners)(triangle).map_each(|v| v.to_array()));
        let edge = Edge { triangle, number, pixels, distance: 0.0, coverage: 1.0, change: Vec::new() };
        let sign = if is_inside_positive(seen, &edge) { 1.0 } else { -1.0 };
        let distance = sign * distance(&ray, &corners, number);
        let is_nearer = |known: &Edge| distance.abs() + LEVEL < known.distance.abs();
        if !distance.is_finite() || !nearest.as_ref().is_none_or(is_nearer) {
            continue;
        }
        nearest = Some(Edge { distance, coverage: (0.5 + distance).clamp(0.0, 1.0), ..edge });
    }
    nearest
}

/// The edge between two pixels, if they show different triangles and one of these ends between them: the triangle, its edge, and the pixels
/// inside and outside.
fn edge_between(seen: &Seen, a: usize, b: usize) -> Option<(u32, usize, [u32; 2])> {
    if seen.ids[a] == seen.ids[b] {
        return None;
    }
    let depth = |pixel: usize| match seen.ids[pixel] {
        NONE => f64::INFINITY,
        id => hit(&vectors(seen.rays[pixel]), &(seen.corners)(id).map_each(|v| v.to_array()))[1],
    };
    let [depth_a, depth_b] = [a, b].map_each(depth);
    let level = LEVEL * depth_a.abs().min(depth_b.abs());
    let is_first = depth_b - depth_a > level || (depth_a - depth_b <= level && seen.ids[a] < seen.ids[b]);
    let order = if is_first { [(a, b), (b, a)] } else { [(b, a), (a, b)] };
    order.into_iter().find_map(|(inside, outside)| {
        let number = edge_left(seen, inside, outside)?;
        Some((seen.ids[inside], number, [inside as u32, outside as u32]))
    })
}

/// The edge by which the way from one pixel to another leaves the triangle that the first one shows.
fn edge_left(seen: &Seen, inside: usize, outside: usize) -> Option<usize> {
    let id = seen.ids[inside];
    if id == NONE || seen.rays[outside][..6].iter().any(|number| number.is_nan()) {
        return None;
    }
    let corners = (seen.corners)(id).map_each(|v| v.to_array());
    let (from, to) = (vectors(seen.rays[inside]), vectors(seen.rays[outside]));
    let sign = across(&from, &corners).signum();
    let mut first = None;
    for number in 0..3 {
        // a hit on the edge itself may lie outside by a rounding
        let start = (sign * side(&from, &corners, number)).max(0.0);
        let end = sign * side(&to, &corners, number);
        if end < 0.0 {
            let share = start / (start - end);
            if first.is_none_or(|(least, _)| share + LEVEL < least) {
                first = Some((share, number));
            }
        }
    }
    first.map(|(_, number)| number)
}

/// P, D and their changes over the pixel, as vectors.
struct Vectors<T> {
    p: [T; 3],
    d: [T; 3],
    right: [[T; 3]; 2],
    down: [[T; 3]; 2],
}

/// t, Z, position, weights.
fn hit<T: Number>(ray: &Vectors<T>, corners: &[[T; 3]; 3]) -> [T; HIT_NUMBERS] {
    let across = across(ray, corners);
    let t = dot(normal(corners), minus(corners[0], ray.p)) / across;
    let [x, y, z] = [0, 1, 2].map_each(|k| ray.p[k] + t * ray.d[k]);
    let weight = |edge: usize| side(ray, corners, edge) / across;
    [t, t * dot(ray.d, ray.d).root(), x, y, z, weight(1), weight(2), weight(0)]
}

/// N . D.
fn across<T: Number>(ray: &Vectors<T>, corners: &[[T; 3]; 3]) -> T {
    dot(normal(corners), ray.d)
}

fn normal<T: Number>([a, b, c]: &[[T; 3]; 3]) -> [T; 3] {
    cross(minus(*b, *a), minus(*c, *a))
}

/// E of the edge from corner k to the next.
fn side<T: Number>(ray: &Vectors<T>, corners: &[[T; 3]; 3], k: usize) -> T {
    side_of((ray.p, ray.d), (corners[k], corners[(k + 1) % 3]))
}

fn side_of<T: Number>((p, d): ([T; 3], [T; 3]), (from, to): ([T; 3], [T; 3])) -> T {
    dot(cross(minus(from, p), minus(to, from)), d)
}

/// The distance of the pixel's centre from the edge's image at first order, px, with the sign of E.
fn distance<T: Number>(ray: &Vectors<T>, corners: &[[T; 3]; 3], k: usize) -> T {
    let slope = |[p, d]: [[T; 3]; 2]| {
        // E of rays that move over the pixel at a unit of speed
        let moving = |v: [T; 3], rate: [T; 3]| [0, 1, 2].map_each(|n| Dual { value: v[n], rate: rate[n] });
        let still = |v: [T; 3]| v.map_each(Dual::still);
        side_of((moving(ray.p, p), moving(ray.d, d)), (still(corners[k]), still(corners[(k + 1) % 3]))).rate
    };
    let (x, y) = (slope(ray.right), slope(ray.down));
    side(ray, corners, k) / (x * x + y * y).root()
}

/// A number and its rate along a direction.
type Rated = Dual<f64, f64>;

/// The pixel's ray and a triangle's corners with their rates along a direction.
fn moving(
    ray: PixelRay,
    corners: [DVec3; 3],
    pixel: usize,
    direction: &Direction,
) -> (Vectors<Rated>, [[Rated; 3]; 3]) {
    let rate = direction.rays.map_or([0.0; 18], |rays| rays[pixel]);
    let number = |n: usize| Dual { value: ray[n], rate: rate[n] };
    let coordinate = |corner: usize, axis: usize| {
        let rate = if direction.coordinate == Some(3 * corner + axis) { 1.0 } else { 0.0 };
        Dual { value: corners[corner][axis], rate }
    };
    (
        vectors(std::array::from_fn(number)),
        [0, 1, 2].map_each(|corner| [0, 1, 2].map_each(|axis| coordinate(corner, axis))),
    )
}

fn vectors<T: Number>(n: [T; 18]) -> Vectors<T> {
    let vector = |k: usize| [n[3 * k], n[3 * k + 1], n[3 * k + 2]];
    Vectors { p: vector(0), d: vector(1), right: [vector(2), vector(3)], down: [vector(4), vector(5)] }
}

fn minus<T: Number>(a: [T; 3], b: [T; 3]) -> [T; 3] {
    [0, 1, 2].map_each(|k| a[k] - b[k])
}

fn dot<T: Number>(a: [T; 3], b: [T; 3]) -> T {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross<T: Number>(a: [T; 3], b: [T; 3]) -> [T; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
