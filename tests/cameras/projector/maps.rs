//! Every reparametrisation by its formula.

use super::make::*;
use glam::DVec2;
use std::f64::consts::TAU;
use std::path::Path;

/// Where on the surfaces the pixels lie, by a plane whose points are (u, v, 0).
fn assert_reparam(dir: &Path, reparam: &str, formula: impl Fn(f64, f64) -> Option<DVec2>) {
    let surface = "{ kind = 'plane', origin = [0, 0, 0], u = [1, 0, 0], v = [0, 1, 0] }";
    let camera = try_load(dir, &projector(&[surface, FAR], &format!("reparam = {reparam}"))).unwrap();
    for (i, j) in pixels() {
        let (a, b) = place(i, j);
        let found = camera.curve(0, i, j).map(|(_, c)| c.points()[0]);
        match (found, formula(a, b)) {
            (Some(p), Some(uv)) => assert!(close(p, uv.extend(0.0)), "{reparam} at {a},{b}: {p}, not {uv}"),
            (found, expected) => assert!(found.is_none() && expected.is_none(), "{reparam} at {a},{b}: {found:?}"),
        }
    }
}

#[test]
fn reparametrisations() {
    let dir = tempfile::tempdir().unwrap();
    let check = |text: &str, formula: &dyn Fn(f64, f64) -> Option<DVec2>| assert_reparam(dir.path(), text, formula);
    check("{ kind = 'affine', m = [[2, 0.5, -1], [0.25, -3, 4]] }", &|a, b| {
        Some(DVec2::new(2.0 * a + 0.5 * b - 1.0, 0.25 * a - 3.0 * b + 4.0))
    });
    for (text, power) in [("{ kind = 'polar' }", 1.0), ("{ kind = 'lens', power = 2.5 }", 2.5)] {
        check(text, &|a, b| {
            let (x, y) = (2.0 * a - 1.0, 1.0 - 2.0 * b);
            let rho = (x * x + y * y).sqrt();
            let turn = if y >= 0.0 { (x / rho).acos() } else { TAU - (x / rho).acos() };
            (rho <= 1.0).then(|| DVec2::new(turn / TAU, rho.powf(power)))
        });
    }
    check("{ kind = 'magnify', center = [0.4, 0.6], radius = 0.3, strength = 3 }", &|a, b| {
        let c = DVec2::new(0.4, 0.6);
        let d = DVec2::new(a, b) - c;
        let q = d.length() / 0.3;
        let s = if q >= 1.0 { 1.0 } else { 1.0 / 3.0 + (2.0 / 3.0) * q.powi(2) * (3.0 - 2.0 * q) };
        Some(c + s * d)
    });
}

#[test]
fn tables_are_bilinear_between_the_centres_of_their_cells() {
    let dir = tempfile::tempdir().unwrap();
    // 3 x 2 cells with centres at a = 1/6, 1/2, 5/6 and b = 1/4, 3/4; one of them has no place
    let cell = |x: usize, y: usize| [x as f64 + 0.5 * y as f64, 2.0 * y as f64 - (x * y) as f64];
    let mut numbers: Vec<f64> = (0..2).flat_map(|y| (0..3).flat_map(move |x| cell(x, y))).collect();
    let expected = |a: f64, b: f64| {
        let (x, y) = ((3.0 * a - 0.5).clamp(0.0, 2.0), (2.0 * b - 0.5).clamp(0.0, 1.0));
        // the cells' numbers are themselves bilinear in the cell
        DVec2::new(x + 0.5 * y, 2.0 * y - x * y)
    };
    let table = "{ kind = 'table', file = 'uv.npy' }";
    anamorph::internals::image::write_npy_f64(&dir.path().join("uv.npy"), &[2, 3, 2], &numbers).unwrap();
    assert_reparam(dir.path(), table, |a, b| Some(expected(a, b)));
    numbers[10] = f64::NAN;
    anamorph::internals::image::write_npy_f64(&dir.path().join("uv.npy"), &[2, 3, 2], &numbers).unwrap();
    // the last cell of the second row has a say where x > 1 and y > 0
    assert_reparam(dir.path(), table, |a, b| (a <= 0.5 || b <= 0.25).then(|| expected(a, b)));
    use anamorph::internals::image::frame::{Channel, Frame, Plane};
    let planes = vec![(Channel::R, Plane::F32(vec![0.25; 4])), (Channel::G, Plane::F32(vec![0.75; 4]))];
    anamorph::internals::image::write_exr(&dir.path().join("uv.exr"), &Frame { width: 2, height: 2, planes }, &[])
        .unwrap();
    assert_reparam(dir.path(), "{ kind = 'table', file = 'uv.exr' }", |_, _| Some(DVec2::new(0.25, 0.75)));
}
