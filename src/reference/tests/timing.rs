//! Times of an ordinary frame and of a large build; run by hand: `cargo test --release -- --ignored --nocapture`.

use super::FORWARD;
use super::make::mesh;
use crate::camera::bundle::Bundle;
use crate::reference::Reference;
use crate::scene::mesh::Mesh;
use glam::DVec3;
use rayon::prelude::*;
use std::time::Instant;

/// A rolling field of `2 n^2` triangles over [-1, 1]^2.
fn field(n: u32) -> Mesh {
    let at = |i: u32| 2.0 * f64::from(i) / f64::from(n) - 1.0;
    let height = |x: f64, z: f64| 0.15 * (7.0 * x).sin() * (5.0 * z).cos() + 0.03 * (31.0 * x + 17.0 * z).sin();
    let point = |k: u32| (at(k % (n + 1)), at(k / (n + 1)));
    let positions = (0..(n + 1) * (n + 1)).map(|k| DVec3::new(point(k).0, height(point(k).0, point(k).1), point(k).1));
    let triangles = (0..n * n).flat_map(|k| {
        let a = k / n * (n + 1) + k % n;
        [[a, a + 1, a + n + 1], [a + 1, a + n + 2, a + n + 1]]
    });
    mesh(positions.collect(), triangles.collect())
}

/// A skewed cross-slit, 800 x 600, looking down at the field.
fn pixel(i: u32, j: u32) -> Bundle {
    let (dx, dy) = (1.0 / 800.0, 1.0 / 600.0);
    let near = [DVec3::new(-0.4, 1.5, 1.3), DVec3::new(0.8, 0.1, 0.0), DVec3::new(0.0, -0.3, 0.0)];
    let far = [DVec3::new(-1.0, 0.0, -0.9), DVec3::new(2.0, 0.0, 0.1), DVec3::new(0.1, -0.2, 1.8)];
    let p = [near[0], near[1] * dx, near[2] * dy];
    let q = [far[0], far[1] * dx, far[2] * dy];
    let d = std::array::from_fn(|k| q[k] - p[k]);
    Bundle { p, d, h: [1.0, 0.0, 0.0] }.recentred(f64::from(i) + 0.5, f64::from(j) + 0.5)
}

#[test]
#[ignore = "a timing, run by hand"]
fn an_ordinary_frame_and_a_large_build() {
    for n in [87, 1414] {
        let mesh = field(n);
        let start = Instant::now();
        let reference = Reference::build(&mesh);
        println!("{} triangles: built in {:.3} s", mesh.triangles.len(), start.elapsed().as_secs_f64());
        let pixels: Vec<Bundle> = (0..480_000).map(|k| pixel(k % 800, k / 800)).collect();
        let start = Instant::now();
        let hits = pixels.par_iter().filter(|b| reference.hit(b, FORWARD).is_some()).count();
        println!("  hit(): {:.3} s, {hits} of 480000 hit", start.elapsed().as_secs_f64());
        let start = Instant::now();
        let verdicts: Vec<_> = pixels.par_iter().map(|b| reference.verdict(&[*b], FORWARD)).collect();
        let count = |f: &dyn Fn(&super::super::Verdict) -> bool| verdicts.iter().filter(|v| f(v)).count();
        println!(
            "  verdict(): {:.3} s, {} unsafe, {} of them may miss",
            start.elapsed().as_secs_f64(),
            count(&|v| !v.safe),
            count(&|v| !v.safe && v.may_miss)
        );
        let changes = |b: &Bundle| {
            let at = |k: i32| f64::from(k) / 64.0;
            let id = |x, y| reference.hit(&b.recentred(x, y), FORWARD).map(|h| h.triangle);
            let first = id(0.0, 0.0);
            (-4..=4).any(|j| (-4..=4).any(|i| id(at(i), at(j)) != first))
        };
        let (changing, unsafe_px) = (0..pixels.len())
            .into_par_iter()
            .step_by(31)
            .map(|k| (usize::from(changes(&pixels[k])), usize::from(!verdicts[k].safe)))
            .reduce(|| (0, 0), |a, b| (a.0 + b.0, a.1 + b.1));
        println!("  of every 31st pixel {unsafe_px} are unsafe, {changing} change at 9 x 9 samples");
    }
}
