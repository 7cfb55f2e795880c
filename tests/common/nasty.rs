//! Tables of rays over one image.

use super::common::rng::Rng;
use anamorph::internals::camera::TILE;
use anamorph::internals::engine::plan::curves::RayTable;
use anamorph::internals::gpu::layout::split2;
use glam::DVec3;

/// Over this many pixels the tables below are made: three levels of nodes, and tiles that the image cuts.
pub const SIZE: (u32, u32) = (157, 75);

/// A table of rays: of a pixel, its origin and its direction; 0 is none.
fn table(ray: &mut dyn FnMut(u32, u32) -> Option<(DVec3, DVec3)>) -> RayTable {
    let mut table = RayTable { hi: Vec::new(), lo: Vec::new() };
    for (j, i) in (0..=SIZE.1).flat_map(|j| (0..=SIZE.0).map(move |i| (j, i))) {
        let inside = i < SIZE.0 && j < SIZE.1;
        let (p, d) = if inside { ray(i, j) } else { None }.unwrap_or_default();
        for [hi, lo] in p.to_array().into_iter().chain(d.to_array()).map(split2) {
            table.hi.push(hi);
            table.lo.push(lo);
        }
    }
    table
}

/// Smooth rays, as of a curved mirror.
fn smooth(i: u32, j: u32) -> (DVec3, DVec3) {
    let (x, y) = (f64::from(i) / 80.0 - 1.0, f64::from(j) / 80.0 - 0.5);
    (DVec3::new(x, y, 0.1 * (3.0 * x).sin() * y), DVec3::new(0.7 * x, 0.4 * y + 0.1 * x * x, 1.0).normalize())
}

/// Rays that no mirror in a room has.
pub fn nasty() -> Vec<(&'static str, RayTable)> {
    let mut rng = Rng(4);
    let at = |(p, d): (DVec3, DVec3), offset: f64| (p + offset * DVec3::new(1.0, -0.7, 0.3), d);
    let in_tile = |i: u32, j: u32| (i % TILE, j % TILE);
    // tile by tile: no pixel, one, a row, a column, a diagonal, two rows at one side, all but one
    let some = |i: u32, j: u32| {
        let (x, y) = in_tile(i, j);
        match (i / TILE + 3 * (j / TILE)) % 7 {
            0 => false,
            1 => (x, y) == (5, 2),
            2 => y == 3,
            3 => x == 7,
            4 => x == y,
            5 => y < 2 && x > 3,
            _ => (x, y) != (0, 0),
        }
    };
    let jump = |i: u32, j: u32| {
        let (x, y) = (f64::from(i) - 70.0, f64::from(j) - 40.0);
        x * x + y * y < 900.0
    };
    vec![
        ("smooth", table(&mut |i, j| Some(smooth(i, j)))),
        ("smooth, far away", table(&mut |i, j| Some(at(smooth(i, j), 1e4)))),
        ("few pixels", table(&mut |i, j| some(i, j).then(|| smooth(i, j)))),
        ("few pixels, far away", table(&mut |i, j| some(i, j).then(|| at(smooth(i, j), 1e4)))),
        (
            "a silhouette",
            table(&mut |i, j| {
                let (p, d) = smooth(i, j);
                Some(if jump(i, j) { (p + 5.0 * DVec3::Z, DVec3::new(d.z, d.x, -d.y)) } else { (p, d) })
            }),
        ),
        ("a silhouette against nothing", table(&mut |i, j| jump(i, j).then(|| smooth(i, j)))),
        ("noise", table(&mut |_, _| Some((3.0 * rng.vector(), rng.direction())))),
        (
            "sizes from 2^-20 to 2^20",
            table(&mut |i, j| {
                let scale = f64::from((i / TILE * 7 + j / TILE * 3) % 41).exp2() / f64::from(1 << 20);
                let (p, d) = smooth(i, j);
                Some((scale * p, d))
            }),
        ),
        (
            "some of them no numbers",
            table(&mut |i, j| {
                let (p, d) = smooth(i, j);
                let bad = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY][(i % 3) as usize] * DVec3::Y;
                Some(if (i * 5 + j * 3) % 11 == 0 {
                    (p + bad, d)
                } else if (i + j) % 13 == 0 {
                    (p, bad)
                } else {
                    (p, d)
                })
            }),
        ),
        ("all alike", table(&mut |_, _| Some((DVec3::new(0.3, 0.1, 7.0), DVec3::new(0.6, 0.0, 0.8))))),
        ("none", table(&mut |_, _| None)),
    ]
}
