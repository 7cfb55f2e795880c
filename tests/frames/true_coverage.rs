//! Coverage and its gradient against the true area: the image of a triangle, clipped to the pixel; and the areas of `--analytic`, as an
//! edge moves, against the same.

use super::gradients::{BALL, SIZE, View, difference};
use crate::common;

use anamorph::internals::camera::change::PixelRay;
use anamorph::internals::engine::RunOptions;
use anamorph::internals::engine::plan::Wanted;
use anamorph::internals::image::frame::Channel;
use anamorph::internals::reference::gradient::{Direction, Edge, PixelChange};
use common::gpu::engine_on;
use common::polygon::{area, pixel_about};
use glam::{DMat3, DVec2, DVec3};

/// The image of a point through a pinhole, px right of and below the centre of the pixel with this ray: where the pixel's plane of rays,
/// D + x D_x + y D_y, points at it.
fn image(ray: &PixelRay, point: DVec3) -> DVec2 {
    let vector = |k: usize| DVec3::from_slice(&ray[3 * k..3 * k + 3]);
    let at = DMat3::from_cols(vector(3), vector(5), vector(1)).inverse() * (point - vector(0));
    at.truncate() / at.z
}

/// The images of a triangle's corners, counterclockwise in x and y.
fn outline(ray: &PixelRay, corners: [DVec3; 3]) -> Vec<DVec2> {
    let images = corners.map(|corner| image(ray, corner)).to_vec();
    if area(&images) < 0.0 { images.into_iter().rev().collect() } else { images }
}

/// How much of the pixel a triangle's image covers.
fn covered(ray: &PixelRay, corners: [DVec3; 3]) -> f64 {
    area(&common::polygon::common(outline(ray, corners), &pixel_about(DVec2::ZERO)))
}

/// An edge's image: places along it in px from the foot of the pixel's centre.
struct Line {
    /// Unit normal.
    across: DVec2,
    /// Of the edge's two corners.
    ends: [f64; 2],
    /// What of it lies in the pixel; `None` if it passes beside it.
    within: Option<[f64; 2]>,
}

impl Line {
    fn of(ray: &PixelRay, corners: [DVec3; 3], number: usize) -> Line {
        let [from, to] = [corners[number], corners[(number + 1) % 3]].map(|corner| image(ray, corner));
        let along = (to - from).normalize();
        let foot = from - along * from.dot(along);
        // of one coordinate after the other: between -1/2 and 1/2
        let between = |place: f64, slope: f64| {
            let ends = [-0.5, 0.5].map(|side| (side - place) / slope);
            if slope == 0.0 { [f64::NEG_INFINITY, f64::INFINITY] } else { [ends[0].min(ends[1]), ends[0].max(ends[1])] }
        };
        let [x, y] = [between(foot.x, along.x), between(foot.y, along.y)];
        let within = [x[0].max(y[0]), x[1].min(y[1])];
        let within = (within[0] < within[1] && foot.abs().max_element() < 1.0).then_some(within);
        Line { across: along.perp(), ends: [from.dot(along), to.dot(along)], within }
    }

    /// How far coverage may be from the true area. With c and s the sizes of the normal's coordinates, the area grows by 1 / max(c, s)
    /// a pixel while the edge leaves the pixel by opposite sides, then more slowly. It is off most where it grows as coverage does, and
    /// where that ends.
    fn most_off(&self) -> f64 {
        let [c, s] = self.across.abs().to_array();
        if c * s == 0.0 {
            return 0.0;
        }
        let over = c + s - 1.0;
        (over * over / 4.0).max(over * over / (8.0 * c * s))
    }
}

/// Whether the other edges of a triangle leave the pixel alone: all of it, and a little more, lies inside of them.
fn is_alone(ray: &PixelRay, corners: [DVec3; 3], number: usize) -> bool {
    let images = corners.map(|corner| image(ray, corner));
    let around = area(&images).signum();
    let inside = |edge: usize| {
        let (from, side) = (images[edge], (images[(edge + 1) % 3] - images[edge]).normalize());
        pixel_about(DVec2::ZERO).iter().all(|p| around * side.perp_dot(*p - from) > 1e-3)
    };
    [1, 2].iter().all(|k| inside((number + k) % 3))
}

/// How far coverage is from the true area at most, by `docs/reference/definitions.md`: at 45 degrees.
const MOST_OFF: f64 = 0.05;

/// Areas of numbers below 64 by some tens of operations of f64.
const CLOSE: f64 = 1e-12;

/// The edges that pass alone through a pixel, or beside it.
fn lone_edges<'v>(
    view: &'v View,
    changes: &'v [PixelChange],
) -> impl Iterator<Item = (&'v PixelRay, [DVec3; 3], &'v Edge, Line)> {
    let edge = |(k, change): (usize, &'v PixelChange)| {
        let edge = change.edge.as_ref().filter(|edge| edge.distance.abs() < 0.75)?;
        let (ray, corners) = (&view.rays[k], view.corners(edge.triangle));
        is_alone(ray, corners, edge.number).then(|| (ray, corners, edge, Line::of(ray, corners, edge.number)))
    };
    changes.iter().enumerate().filter_map(edge)
}

fn pinhole(meshes: &str) -> View {
    View::of(meshes, SIZE, "kind = \"pinhole\"\nvfov = 38\nVIEW")
}

/// Half a plane at z = 0, beyond an edge through a place that leans so many degrees from the upright, 4 before a pinhole.
fn half_plane(degrees: f64, at: f64) -> View {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("half.obj");
    let along = DVec2::from_angle((90.0 - degrees).to_radians());
    let corners = [DVec2::X * at - 9.0 * along, DVec2::X * at + 9.0 * along, DVec2::X * at + 9.0 * along.perp()];
    let text: String = corners.iter().map(|p| format!("v {:?} {:?} 0\n", p.x, p.y)).collect();
    std::fs::write(&path, format!("{text}f 1 2 3\n")).unwrap();
    let keys = "kind = \"pinhole\"\neye = [0, 0, 4]\ntarget = [0, 0, 0]\nvfov = 40";
    // the light is the same at all places
    View::of(&format!("[[light]]\ndirection = [0, 0, -1]\n[[mesh]]\nfile = {path:?}\n"), SIZE, keys)
}

/// Upright and level edges, and slanted ones. At 45 degrees pixels lie at some distances from the edge only, an eighth of a pixel further
/// in each.
const LEANING: [(f64, f64); 9] = [
    (0.0, 0.317),
    (90.0, 0.317),
    (5.0, 0.317),
    (20.0, 0.317),
    (70.0, 0.317),
    (45.0, 0.317),
    (45.0, 0.317 + 0.125 * DIAGONAL),
    (45.0, 0.317 + 0.25 * DIAGONAL),
    (45.0, 0.317 + 0.375 * DIAGONAL),
];

/// sqrt(2) pixels of 1/15.
const DIAGONAL: f64 = std::f64::consts::SQRT_2 / 15.0;

#[test]
fn coverage_is_off_from_the_true_area_by_as_much_as_is_documented() {
    let (mut most, mut seen) = (0f64, 0);
    let leaning = LEANING.map(|(degrees, at)| half_plane(degrees, at));
    for view in [pinhole(BALL)].iter().chain(&leaning) {
        for (ray, corners, edge, line) in lone_edges(view, &view.reference(&[])) {
            let off = (edge.coverage - covered(ray, corners)).abs();
            assert!(
                off <= line.most_off() + CLOSE && off <= MOST_OFF,
                "{off} along {}, at {}",
                line.across,
                edge.distance
            );
            most = most.max(off);
            seen += 1;
        }
    }
    println!("{seen} pixels, at most {most:.4} off");
    // (sqrt(2) - 1)^2 / 4 at 45 degrees
    assert!(seen > 500 && most > 0.042, "{seen} pixels, {most} off");
}

/// The area grows with the edge by what of it lies in the pixel, moved as its middle is; coverage by 1 px, moved as the foot of the
/// pixel's centre is. So the true gradient is the documented one times both ratios, exactly.
#[test]
fn the_gradient_of_coverage_is_off_by_what_of_the_edge_lies_in_the_pixel() {
    let (mut upright, mut slanted, mut lengths) = (0, 0, [f64::INFINITY, 0f64]);
    let leaning = LEANING.map(|(degrees, at)| half_plane(degrees, at));
    for view in [pinhole(BALL)].iter().chain(&leaning) {
        let changes = view.reference(&Direction::vertices());
        for (ray, corners, edge, line) in
            lone_edges(view, &changes).filter(|(_, _, edge, _)| edge.distance.abs() < 0.49)
        {
            let Some([first, last]) = line.within else { continue };
            let (length, middle) = (last - first, 0.5 * (first + last));
            lengths = [lengths[0].min(length), lengths[1].max(length)];
            let size = (corners[edge.number] - corners[(edge.number + 1) % 3]).length();
            for (direction, got) in edge.change.iter().enumerate() {
                // of the corner's own motion, the share at a place falls to 0 at the edge's other corner
                let share = match (direction / 3 + 3 - edge.number) % 3 {
                    0 => (line.ends[1] - middle) / line.ends[1],
                    1 => (line.ends[0] - middle) / line.ends[0],
                    _ => 1.0,
                };
                let (slope, off) = difference(size / 65536.0, 1e3, |h| {
                    let mut moved = corners;
                    moved[direction / 3][direction % 3] += h;
                    covered(ray, moved)
                });
                let expected = length * share * got;
                assert!(
                    (slope - expected).abs() <= off + CLOSE,
                    "{slope}, not {expected} +- {off}, along {}",
                    line.across
                );
                let is_upright = line.across.abs().max_element() > 1.0 - CLOSE;
                if is_upright {
                    assert!((slope - got).abs() <= off + CLOSE, "{slope}, not {got} +- {off}: upright");
                    upright += 1;
                } else {
                    slanted += 1;
                }
            }
        }
    }
    println!("{upright} of upright edges, {slanted} of slanted ones, which are {lengths:.3?} px long in their pixels");
    assert!(upright > 300 && slanted > 5000, "{upright}, {slanted}");
    // across a corner, at 45 degrees: from 2 (sqrt(1/2) - 1/2) = 0.41 to sqrt(2)
    assert!(lengths[0] < 0.5 && lengths[1] > 1.3, "{lengths:?}");
}

/// A pixel is 1/15 wide. Places on it are found in f32 from numbers of at most 9, in some ten roundings.
const AREA_ERROR: f64 = 10.0 * 9.0 * 15.0 / 16_777_216.0;

/// Alpha and colour, as an edge moves to the right and to the left by a sixteenth of a pixel.
#[test]
fn analytic_areas_change_as_the_true_ones_and_as_coverage_does() {
    let Some(mut engine) = engine_on(|_| {}) else { return };
    let wanted = Wanted { samples: 16, analytic: true, ..Wanted::of(vec![Channel::R, Channel::A]) };
    let step = 2.0 * 4.0 * 20f64.to_radians().tan() / f64::from(SIZE.1) / 16.0;
    for (degrees, at) in LEANING.into_iter().filter(|(degrees, _)| *degrees < 90.0) {
        let [view, left, right] = [at, at - step, at + step].map(|at| half_plane(degrees, at));
        let [reds, alphas] = [Channel::R, Channel::A].map(|channel| {
            [&left, &right].map(|view| {
                let seen = engine.render(&view.scene, &view.camera, &wanted, &RunOptions::default()).unwrap().frame;
                seen.f32(channel).unwrap().iter().map(|value| f64::from(*value)).collect::<Vec<f64>>()
            })
        });
        let red_of = |alpha: f64| reds[0][alphas[0].iter().position(|a| *a == alpha).unwrap()];
        let contrast = red_of(1.0) - red_of(0.0);
        assert!(contrast.abs() > 0.1);
        let changes = view.reference(&Direction::vertices());
        let mut tested = 0;
        for (k, change) in changes.iter().enumerate() {
            let Some(edge) = change.edge.as_ref().filter(|edge| edge.distance.abs() < 0.4) else { continue };
            // of which samples see both the triangle and nothing, before and after
            if alphas.iter().any(|alphas| alphas[k] <= 0.0 || alphas[k] >= 1.0) {
                continue;
            }
            let slope = |[left, right]: [f64; 2]| (right - left) / (2.0 * step);
            let (ray, error) = (&view.rays[k], AREA_ERROR / step);
            let truth = slope([&left, &right].map(|view| covered(ray, view.corners(edge.triangle))));
            let [red, alpha] = [&reds, &alphas].map(|of| slope([of[0][k], of[1][k]]));
            assert!((alpha - truth).abs() <= error, "{degrees} degrees, pixel {k}: {alpha} for {truth}");
            assert!((red - contrast * alpha).abs() <= error, "{degrees} degrees, pixel {k}: red {red}, alpha {alpha}");
            // both corners of the edge move to the right
            let documented = edge.change[3 * edge.number] + edge.change[3 * ((edge.number + 1) % 3)];
            let line = Line::of(ray, view.corners(edge.triangle), edge.number);
            let Some([first, last]) = line.within else { continue };
            // what of the edge lies in the pixel changes by up to 1 / (c s) px a pixel: in the mean over c / 16 px on each side by half
            // of that
            let changing = if degrees == 0.0 { 0.0 } else { 0.5 / 16.0 / line.across.abs().min_element() };
            let (expected, off) = ((last - first) * documented, changing * documented.abs() + error);
            assert!((alpha - expected).abs() <= off, "{degrees} degrees, pixel {k}: {alpha}, not {expected} +- {off}");
            tested += 1;
        }
        assert!(tested > 20, "{degrees} degrees: {tested} pixels");
    }
}
