//! deposit: the kernel against its twin, from the same bytes.

use crate::common::needs::adapter;
use crate::common::rng::Rng;
use anamorph::internals::engine::stage::deposit::{CausticTriangles, Deposit};
use anamorph::internals::gpu::buffers::Buffers;
use anamorph::internals::gpu::kernels::Kernel;
use anamorph::internals::gpu::layout::{CausticTriangle, Receiver};
use anamorph::internals::scene::caustics::shares::LINE_WIDTH;
use anamorph_lab::twin::deposit::{corners, deposit};
use glam::DVec2;

const SIZES: [[u32; 2]; 3] = [[37, 21], [1, 1], [64, 90]];
const MOST: u32 = 1 << 30;

fn receivers() -> Vec<Receiver> {
    let mut first = 0;
    let receiver = |[columns, rows]: [u32; 2]| {
        let receiver = Receiver { columns, rows, first, scale: 1.0 };
        first += columns * rows;
        receiver
    };
    SIZES.into_iter().map(receiver).collect()
}

fn caustic_triangles(triangles: Vec<CausticTriangle>) -> CausticTriangles {
    let receivers = receivers();
    let texels = receivers.iter().map(|r| r.columns * r.rows).sum();
    CausticTriangles { triangles, receivers, texels, unit: 1.0 }
}

fn triangle(receiver: u32, corners: [DVec2; 3], flux: [u32; 3]) -> CausticTriangle {
    let [a, b, c] = corners.map(|p| p.as_vec2().to_array());
    CausticTriangle { a, b, c, receiver, pad0: 0, flux, pad1: 0 }
}

/// Triangles of all sizes, lines, points, on borders of texels, across and beyond those of the map.
fn any(rng: &mut Rng, count: usize) -> Vec<CausticTriangle> {
    let mut triangles = Vec::new();
    while triangles.len() < count {
        let receiver = rng.below(3);
        let size = DVec2::from(SIZES[receiver].map(f64::from));
        let far = if rng.below(8) == 0 { 3.0 } else { 1.0 };
        let at = size * (0.5 + far * 0.6 * DVec2::new(rng.signed(), rng.signed()));
        let extent = [1e-4, 0.1, 1.0, 7.0, 60.0][rng.below(5)];
        let mut near = || at + extent * DVec2::new(rng.signed(), rng.signed());
        let [a, b, c] = [near(), near(), near()];
        let corners = match rng.below(10) {
            0 => [a, b, (a + b) / 2.0],
            1 => [a, a, b],
            2 => [a; 3],
            3 => [a, a + DVec2::X * extent, a + DVec2::X * 0.3],
            4 => [a, a + DVec2::Y * extent, a],
            5 => [a.floor(), a.floor() + DVec2::X, a.floor() + DVec2::Y],
            6 => [a.floor(); 3],
            _ => [a, b, c],
        };
        let flux = [MOST, rng.below(MOST as usize) as u32, rng.below(3) as u32];
        let triangle = triangle(receiver as u32, corners, flux);
        if !nearly_a_line(&triangle) {
            triangles.push(triangle);
        }
    }
    triangles
}

/// Within rounding of the width below which a triangle is a line.
fn nearly_a_line(triangle: &CausticTriangle) -> bool {
    let (width, _, size) = measures(triangle);
    (width - LINE_WIDTH).abs() < 1e-2 * LINE_WIDTH + 1e-5 * size
}

/// Width across the longest side, area, and size of the box about all corners with the map's border cut off.
fn measures(triangle: &CausticTriangle) -> (f64, f64, f64) {
    let [a, b, c] = corners(triangle);
    let area = (b - a).perp_dot(c - a).abs() / 2.0;
    let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
    let size = (a.max(b).max(c) - a.min(b).min(c)).max_element() + 1.0;
    (if longest > 0.0 { 2.0 * area / longest } else { 0.0 }, area, size)
}

/// What the kernel's share of a texel may be off. Its numbers are right to some 2^-22 of the triangle's size: an edge in
/// that many texels' heights, of an area; the place where a line crosses a border, against its steepness.
fn share_error(triangle: &CausticTriangle) -> f64 {
    let (width, area, size) = measures(triangle);
    let rounding = size / f64::from(1 << 22);
    if width > LINE_WIDTH {
        return 16.0 * rounding / area;
    }
    let [a, b, c] = corners(triangle);
    let step = [(a, b), (b, c), (c, a)].map(|(p, q)| q - p);
    let longest = step.into_iter().max_by(|p, q| p.length().total_cmp(&q.length())).unwrap();
    let crossing = |d: f64| if d.abs() < 1e-12 { 0.0 } else { 8.0 * rounding / d.abs() };
    (crossing(longest.x) + crossing(longest.y)).min(1.0)
}

/// Sums a texel and colour, and how far the kernel's may be off; what missed comes behind all texels.
fn known(caustic_triangles: &CausticTriangles) -> (Vec<[f64; 3]>, Vec<[f64; 3]>, u32) {
    let mut sums = vec![[0.0; 3]; caustic_triangles.texels as usize + 1];
    let mut tolerance = vec![[0.0; 3]; caustic_triangles.texels as usize + 1];
    let mut lines = 0;
    for triangle in &caustic_triangles.triangles {
        let brought = deposit(triangle, &caustic_triangles.receivers);
        lines += u32::from(brought.is_line);
        let missed = (caustic_triangles.texels as usize, brought.missed);
        let error = share_error(triangle);
        // the last to be served gets the rounding of all others; a texel beside them may get a sliver
        let all = error * (brought.list.len() as f64 + 1.0);
        let receiver = caustic_triangles.receivers[triangle.receiver as usize];
        let beside = around(triangle, &receiver);
        for k in 0..3 {
            let flux = f64::from(triangle.flux[k]);
            let wide = flux * all.min(1.0) + 0.5 * (brought.list.len() as f64 + 1.0) + flux / f64::from(1 << 23);
            for (texel, share) in brought.list.iter().chain([&missed]) {
                sums[*texel][k] += share * flux;
            }
            for texel in beside.iter().chain([&missed.0]) {
                tolerance[*texel][k] += if flux > 0.0 { wide } else { 0.0 };
            }
        }
    }
    (sums, tolerance, lines)
}

/// Texels in the box about a triangle.
fn around(triangle: &CausticTriangle, receiver: &Receiver) -> Vec<usize> {
    let [a, b, c] = corners(triangle);
    let size = DVec2::new(receiver.columns.into(), receiver.rows.into());
    let lo = a.min(b).min(c).floor().clamp(DVec2::ZERO, size);
    let hi = (a.max(b).max(c).floor() + 1.0).clamp(DVec2::ZERO, size);
    let columns = receiver.columns as usize;
    (lo.y as usize..hi.y as usize)
        .flat_map(|y| (lo.x as usize..hi.x as usize).map(move |x| (x, y)))
        .map(|(x, y)| receiver.first as usize + y * columns + x)
        .collect()
}

/// Words that are not what the twin has.
fn compare(words: &[u32], caustic_triangles: &CausticTriangles) -> Vec<String> {
    let (sums, tolerance, lines) = known(caustic_triangles);
    let mut wrong = Vec::new();
    for (texel, (sum, tolerance)) in sums.iter().zip(&tolerance).enumerate() {
        for k in 0..3 {
            let at = 6 * texel + 2 * k;
            let got = (u64::from(words[at]) | u64::from(words[at + 1]) << 32) as f64;
            if (got - sum[k]).abs() > tolerance[k] {
                wrong.push(format!("texel {texel}, colour {k}: {got} for {} +- {}", sum[k], tolerance[k]));
            }
        }
    }
    if words[6 * sums.len()] != lines {
        wrong.push(format!("{} lines for {lines}", words[6 * sums.len()]));
    }
    wrong
}

fn total(words: &[u32], k: usize) -> u64 {
    let sums = words[..words.len() - 1].chunks_exact(6);
    sums.map(|w| u64::from(w[2 * k]) | u64::from(w[2 * k + 1]) << 32).sum()
}

#[test]
fn the_kernel_deposits_what_its_twin_does_and_loses_nothing() {
    let Some(gpu) = adapter() else { return };
    let kernel = Deposit::new(&gpu).unwrap();
    let mut rng = Rng(11);
    for count in [1, 20, 300, 5000] {
        let caustic_triangles = caustic_triangles(any(&mut rng, count));
        let words = kernel.run(&caustic_triangles, &mut Buffers::default()).unwrap();
        let wrong = compare(&words, &caustic_triangles);
        assert!(wrong.is_empty(), "{count}: {} are wrong, the first: {}", wrong.len(), wrong[0]);
        for k in 0..3 {
            let flux: u64 = caustic_triangles.triangles.iter().map(|c| u64::from(c.flux[k])).sum();
            assert_eq!(total(&words, k), flux, "every unit is somewhere");
        }
    }
}

#[test]
fn sums_carry_into_their_high_words_and_do_not_depend_on_the_order() {
    let Some(gpu) = adapter() else { return };
    let kernel = Deposit::new(&gpu).unwrap();
    let mut rng = Rng(12);
    let mut triangles = any(&mut rng, 2000);
    triangles.extend((0..3000).map(|_| triangle(0, [DVec2::new(3.5, 2.5); 3], [MOST, MOST - 1, 7])));
    let words = kernel.run(&caustic_triangles(triangles.clone()), &mut Buffers::default()).unwrap();
    let texel = 6 * (2 * SIZES[0][0] as usize + 3);
    assert!(words[texel + 1] >= ((3000 * u64::from(MOST)) >> 32) as u32, "the high word of red");
    for _ in 0..3 {
        let order = rng.shuffled(triangles.len());
        let shuffled = caustic_triangles(order.iter().map(|k| triangles[*k]).collect());
        assert!(kernel.run(&shuffled, &mut Buffers::default()).unwrap() == words, "another order, other bytes");
    }
}

#[test]
fn the_kernel_calls_lines_what_its_twin_does() {
    let constant = format!("const LINE_WIDTH: f32 = 1.0 / {:.1};", 1.0 / LINE_WIDTH);
    assert!(Kernel::alone("deposit.wgsl").source().contains(&constant), "{constant}");
}

#[test]
fn the_comparison_sees_planted_errors() {
    let caustic_triangles = caustic_triangles(vec![
        triangle(0, [DVec2::new(1.2, 1.3), DVec2::new(4.8, 2.1), DVec2::new(2.5, 5.9)], [MOST, 1000, 0]),
        triangle(2, [DVec2::new(60.0, 3.0), DVec2::new(70.0, 3.5), DVec2::new(61.0, 9.0)], [MOST, MOST, MOST]),
        triangle(1, [DVec2::new(0.5, 0.5); 3], [5, 6, 7]),
    ]);
    let (sums, _, lines) = known(&caustic_triangles);
    let mut right: Vec<u32> = Vec::new();
    for sum in &sums {
        right.extend(sum.iter().flat_map(|s| [s.round() as u64 as u32, (s.round() as u64 >> 32) as u32]));
    }
    right.push(lines);
    assert_eq!(compare(&right, &caustic_triangles), [""; 0]);
    let lit = sums.iter().position(|s| s[0] > 1e8).unwrap();
    let plants: [(usize, u32); 4] = [
        (6 * lit, right[6 * lit] / 1000 * 999),
        (6 * lit + 1, 1),
        (6 * caustic_triangles.texels as usize, 0),
        (right.len() - 1, lines + 1),
    ];
    for (at, word) in plants {
        let mut words = right.clone();
        words[at] = word;
        assert_eq!(compare(&words, &caustic_triangles).len(), 1, "word {at}");
    }
}
