//! Gradients of a frame: what is asked for, what they are computed from, and the arrays. `docs/reference/definitions.md`, Gradients, says what
//! each is.

use crate::arrays::MapEach;
use crate::camera::change::PixelRay;
use crate::input::tree::nearest;
use crate::input::{Error, Limits, Result};
use glam::DVec3;

/// What changes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Quantity {
    /// The channel Z.
    Depth,
    /// The channel t.
    T,
    /// Where the ray meets the triangle, in the world.
    Position,
    /// Of the triangle's corners at the hit.
    Barycentrics,
    /// Of the pixel, by the triangle whose edge passes through it.
    Coverage,
}

/// Numbers of a hit, each with its change along a direction: t, Z, the position and the weights.
pub const HIT_NUMBERS: usize = 8;

/// Directions of the coordinates of a triangle's corners: x, y, z of the first, of the second, of the third.
pub const VERTEX_DIRECTIONS: usize = 9;

/// A pixel without the thing that an id or a number stands for.
pub const NONE: u32 = u32::MAX;

impl Quantity {
    pub const ALL: [Quantity; 5] =
        [Quantity::Depth, Quantity::T, Quantity::Position, Quantity::Barycentrics, Quantity::Coverage];

    pub fn name(self) -> &'static str {
        match self {
            Quantity::Depth => "depth",
            Quantity::T => "t",
            Quantity::Position => "position",
            Quantity::Barycentrics => "barycentrics",
            Quantity::Coverage => "coverage",
        }
    }

    /// # Errors
    /// What is wrong with the name.
    pub fn named(name: &str) -> std::result::Result<Quantity, String> {
        let known = Quantity::ALL.map(Quantity::name);
        let near = || nearest(name, &known).unwrap_or_default();
        let found = Quantity::ALL.into_iter().find(|quantity| quantity.name() == name);
        found.ok_or_else(|| format!("no such gradient; nearest known: {:?} (known: {})", near(), known.join(", ")))
    }

    /// Its numbers among those of a hit.
    fn of_hit(self) -> std::ops::Range<usize> {
        match self {
            Quantity::T => 0..1,
            Quantity::Depth => 1..2,
            Quantity::Position => 2..5,
            Quantity::Barycentrics => 5..8,
            Quantity::Coverage => 0..0,
        }
    }

    fn count(self) -> usize {
        if self == Quantity::Coverage { 1 } else { self.of_hit().len() }
    }
}

/// With respect to what.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Of {
    /// The corners of the triangle.
    Vertices,
    /// A number of the camera, by its key in the camera's table.
    Number(String),
}

impl Of {
    /// `vertices`, or `camera.vfov`.
    ///
    /// # Errors
    /// What is wrong with the name.
    pub fn named(name: &str) -> std::result::Result<Of, String> {
        match (name, name.strip_prefix("camera.")) {
            ("vertices", _) => Ok(Of::Vertices),
            (_, Some(key)) if !key.is_empty() => Ok(Of::Number(key.into())),
            _ => Err("write vertices, or a number of the camera as in camera.vfov or camera.eye.0".into()),
        }
    }
}

/// The gradients that are asked for.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Asked {
    pub quantities: Vec<Quantity>,
    pub of: Vec<Of>,
}

impl Asked {
    /// Each once, in the order of [`Quantity`]; vertices where nothing is named.
    ///
    /// # Errors
    /// [`Error::Input`] without a quantity.
    pub fn new(mut quantities: Vec<Quantity>, named: Vec<Of>) -> Result<Asked> {
        quantities.sort_unstable();
        quantities.dedup();
        if quantities.is_empty() {
            return Err(Error::input("no gradient is asked for; name depth, t, position, barycentrics or coverage"));
        }
        let mut of = Vec::new();
        for own in named {
            if !of.contains(&own) {
                of.push(own);
            }
        }
        if of.is_empty() {
            of.push(Of::Vertices);
        }
        Ok(Asked { quantities, of })
    }

    pub fn has_coverage(&self) -> bool {
        self.quantities.contains(&Quantity::Coverage)
    }

    pub fn has_vertices(&self) -> bool {
        self.of.contains(&Of::Vertices)
    }

    /// Keys of the camera.
    pub fn numbers(&self) -> impl Iterator<Item = &str> {
        self.of.iter().filter_map(|of| match of {
            Of::Number(key) => Some(key.as_str()),
            Of::Vertices => None,
        })
    }

    /// The names of all arrays, in their order.
    pub fn names(&self) -> Vec<String> {
        let mut names = vec!["triangle".to_owned()];
        if self.has_coverage() {
            names.extend(["coverage", "coverage.triangle", "coverage.pixels"].map_each(String::from));
        }
        let ends = [(self.has_vertices(), "vertices"), (self.numbers().next().is_some(), "camera")];
        for quantity in &self.quantities {
            names.extend(ends.iter().filter(|end| end.0).map(|end| format!("{}.{}", quantity.name(), end.1)));
        }
        names
    }

    /// Refuses an image whose gradients are larger than the free memory.
    ///
    /// # Errors
    /// [`Error::Work`] that names the limit.
    pub fn check_memory(&self, (width, height): (u32, u32), limits: Limits) -> Result<()> {
        let directions = (if self.has_vertices() { VERTEX_DIRECTIONS } else { 0 } + self.numbers().count()) as u64;
        let each: usize = self.quantities.iter().map(|quantity| quantity.count()).sum();
        let rays = RAY_TABLES * size_of::<PixelRay>() as u64;
        // and of one direction, or of those of vertices, what the device sends back: twice
        let sent = 2 * 4 * (HIT_NUMBERS as u64 + 5) * VERTEX_DIRECTIONS as u64;
        let bytes = u64::from(width) * u64::from(height) * (rays + sent + 4 * each as u64 * directions);
        let what = format!("gradients of {width} x {height} pixels by {directions} numbers");
        limits.check_memory(bytes, what, "make the image smaller, or ask for fewer")
    }
}

/// Tables of a ray a pixel alive at once: the rays, a derivative and its error, and the rays of seven cameras, each less than half of one.
const RAY_TABLES: u64 = 7;

/// What a frame shows, and by which rays.
#[derive(Clone, Copy)]
pub struct Seen<'a> {
    pub width: u32,
    pub height: u32,
    /// Row by row.
    pub rays: &'a [PixelRay],
    /// The triangle of each pixel, or [`NONE`].
    pub ids: &'a [u32],
    /// The corners of a triangle.
    pub corners: &'a (dyn Fn(u32) -> [DVec3; 3] + Sync),
    /// Whether edges are looked for.
    pub has_edges: bool,
}

/// The changes of all pixels along some directions.
#[derive(Debug, Clone, Default)]
pub struct Changes {
    /// Of each pixel, for each direction, [`HIT_NUMBERS`]; 0 where nothing is hit.
    pub hits: Vec<f32>,
    /// Of each pixel, for each direction; 0 without an edge. Empty if edges are not looked for.
    pub coverage: Vec<f32>,
    pub edges: Edges,
}

/// The edge that passes through each pixel.
#[derive(Debug, Clone, Default)]
pub struct Edges {
    /// The share of the pixel that the edge's triangle covers; 1 without an edge.
    pub coverage: Vec<f32>,
    /// The triangle, or [`NONE`].
    pub triangle: Vec<u32>,
    /// The pixels on both sides, by their numbers row by row: the one that shows the triangle, and the one beyond.
    pub pixels: Vec<[u32; 2]>,
}

/// Numbers of an array.
#[derive(Debug, Clone, PartialEq)]
pub enum Numbers {
    /// Shares and derivatives.
    F32(Vec<f32>),
    /// Triangles and pixels.
    U32(Vec<u32>),
}

/// An array of a number or several a pixel, in C order.
#[derive(Debug, Clone, PartialEq)]
pub struct Array {
    /// As in `depth.vertices`.
    pub name: String,
    /// Begins with height and width.
    pub shape: Vec<usize>,
    /// Row by row from the top, the last axis first.
    pub numbers: Numbers,
}

/// A number of the camera, and how its derivatives were found.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter {
    /// As in `camera.vfov`.
    pub name: String,
    /// As in the scene.
    pub value: f64,
    /// The largest step from the value.
    pub step: f64,
    /// Bounds on the absolute errors of the derivatives of all rays' P (world units a unit) and D.
    pub error: [f64; 2],
}

/// Gradients of a frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Gradients {
    /// Pixels.
    pub width: u32,
    /// Pixels.
    pub height: u32,
    /// In the order of the last axis of arrays named `camera`.
    pub parameters: Vec<Parameter>,
    /// `triangle`, those of the edges, then those of the quantities.
    pub arrays: Vec<Array>,
}

/// Collects the arrays of what was asked for.
pub struct Collected<'a> {
    asked: &'a Asked,
    size: [usize; 2],
    /// By [`Asked::quantities`]: of vertices, and of the camera's numbers.
    vertices: Vec<Vec<f32>>,
    camera: Vec<Vec<f32>>,
    edges: Edges,
}

impl<'a> Collected<'a> {
    pub fn new(asked: &'a Asked, (width, height): (u32, u32)) -> Collected<'a> {
        let none = vec![Vec::new(); asked.quantities.len()];
        let size = [height as usize, width as usize];
        Collected { asked, size, vertices: none.clone(), camera: none, edges: Edges::default() }
    }

    /// Adds the changes along the directions of the vertices.
    pub fn add_vertices(&mut self, changes: Changes) {
        for (quantity, array) in self.asked.quantities.iter().zip(&mut self.vertices) {
            if *quantity == Quantity::Coverage {
                array.clone_from(&changes.coverage);
                continue;
            }
            // directions last
            for pixel in changes.hits.chunks(HIT_NUMBERS * VERTEX_DIRECTIONS) {
                let of_number = |n: usize| pixel[n..].iter().step_by(HIT_NUMBERS);
                array.extend(quantity.of_hit().flat_map(of_number));
            }
        }
        self.edges = changes.edges;
    }

    /// Adds the changes along the camera's number `k` of `count`.
    pub fn add_number(&mut self, (k, count): (usize, usize), changes: Changes) {
        let pixels = self.size[0] * self.size[1];
        for (quantity, array) in self.asked.quantities.iter().zip(&mut self.camera) {
            let each = quantity.count();
            array.resize(pixels * each * count, 0.0);
            let (from, stride, first): (&[f32], usize, usize) = match quantity {
                Quantity::Coverage => (&changes.coverage, 1, 0),
                _ => (&changes.hits, HIT_NUMBERS, quantity.of_hit().start),
            };
            for (pixel, n) in (0..pixels).flat_map(|pixel| (0..each).map(move |n| (pixel, n))) {
                array[(pixel * each + n) * count + k] = from[pixel * stride + first + n];
            }
        }
        self.edges = changes.edges;
    }

    /// The arrays, in the order of [`Asked::names`]. `ids` are the triangles of all pixels.
    pub fn arrays(self, ids: &[u32]) -> Vec<Array> {
        let size = self.size;
        let array =
            |name: String, more: &[usize], numbers: Numbers| Array { name, shape: [&size[..], more].concat(), numbers };
        let mut arrays = vec![array("triangle".into(), &[], Numbers::U32(ids.to_vec()))];
        if self.asked.has_coverage() {
            let Edges { coverage, triangle, pixels } = self.edges;
            arrays.push(array("coverage".into(), &[], Numbers::F32(coverage)));
            arrays.push(array("coverage.triangle".into(), &[], Numbers::U32(triangle)));
            arrays.push(array("coverage.pixels".into(), &[2], Numbers::U32(pixels.into_flattened())));
        }
        let count = self.asked.numbers().count();
        for ((quantity, vertices), camera) in self.asked.quantities.iter().zip(self.vertices).zip(self.camera) {
            let own: &[usize] = if quantity.count() == 3 { &[3] } else { &[] };
            if self.asked.has_vertices() {
                let shape = [own, &[3, 3]].concat();
                arrays.push(array(format!("{}.vertices", quantity.name()), &shape, Numbers::F32(vertices)));
            }
            if count > 0 {
                let shape = [own, &[count]].concat();
                arrays.push(array(format!("{}.camera", quantity.name()), &shape, Numbers::F32(camera)));
            }
        }
        arrays
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_read_or_refused() {
        assert_eq!(Quantity::named("depth"), Ok(Quantity::Depth));
        assert!(Quantity::named("dept").is_err_and(|e| e.contains("\"depth\"")));
        assert_eq!(Of::named("camera.eye.0"), Ok(Of::Number("eye.0".into())));
        assert_eq!(Of::named("vertices"), Ok(Of::Vertices));
        assert!(["camera.", "camera", "vertex", ""].iter().all(|wrong| Of::named(wrong).is_err()));
        assert!(Asked::new(Vec::new(), Vec::new()).is_err());
        let asked = Asked::new(vec![Quantity::Coverage, Quantity::Depth, Quantity::Depth], Vec::new()).unwrap();
        assert_eq!(asked.quantities, [Quantity::Depth, Quantity::Coverage]);
        let names =
            ["triangle", "coverage", "coverage.triangle", "coverage.pixels", "depth.vertices", "coverage.vertices"];
        assert_eq!(asked.names(), names);
    }

    #[test]
    fn arrays_have_their_numbers_in_order() {
        let of = vec![Of::Vertices, Of::Number("a".into()), Of::Number("b".into())];
        let asked = Asked::new(vec![Quantity::Depth, Quantity::Position], of).unwrap();
        let mut collected = Collected::new(&asked, (2, 1));
        // pixel, direction, number
        let numbered = |directions: usize, more: f32| {
            let all =
                (0..2).flat_map(move |p| (0..directions).flat_map(move |d| (0..HIT_NUMBERS).map(move |n| (p, d, n))));
            let hits = all.map(|(p, d, n)| (1000 * p + 10 * d + n) as f32 + more).collect();
            Changes { hits, ..Changes::default() }
        };
        collected.add_vertices(numbered(VERTEX_DIRECTIONS, 0.0));
        collected.add_number((0, 2), numbered(1, 0.0));
        collected.add_number((1, 2), numbered(1, 0.5));
        let arrays = collected.arrays(&[7, NONE]);
        assert_eq!(arrays.iter().map(|a| a.name.clone()).collect::<Vec<_>>(), asked.names());
        let find = |name: &str| {
            let found = arrays.iter().find(|a| a.name == name).unwrap();
            let Numbers::F32(numbers) = &found.numbers else { panic!("{name}") };
            assert_eq!(found.shape.iter().product::<usize>(), numbers.len(), "{name}");
            (found.shape.clone(), numbers.clone())
        };
        let (shape, numbers) = find("position.vertices");
        assert_eq!(shape, [1, 2, 3, 3, 3]);
        // of the second pixel: z by y of the third corner
        assert_eq!(numbers[27 + 2 * 9 + 2 * 3 + 1], 1000.0 + 10.0 * 7.0 + 4.0);
        let (shape, numbers) = find("position.camera");
        assert_eq!((shape, numbers[6 + 2 * 2 + 1]), (vec![1, 2, 3, 2], 1004.5));
        assert_eq!(find("depth.camera"), (vec![1, 2, 2], vec![1.0, 1.5, 1001.0, 1001.5]));
    }
}
