//! Surfaces of pieces: who owns a place, what is outside, how pieces are numbered.

use super::make::*;
use glam::DVec3;

#[test]
fn pieces_are_linear_on_each_triangle_and_the_lowest_numbered_owns_a_border() {
    let z = [1.0, 2.0, 4.0, -8.0];
    let height = |a: f64, b: f64| {
        let upper = 1.0 + a * 1.0 + b * 3.0;
        let lower = -8.0 + (1.0 - b) * 10.0 + (1.0 - a) * 12.0;
        if a + b <= 1.0 { upper } else { lower }
    };
    // straight ones become pieces; under a map that is not affine, or with more surfaces, they stay curves
    let odd = "reparam = { kind = 'magnify', center = [9, 9], radius = 1, strength = 2 }";
    for (surfaces, reparam, curved) in [
        (vec![square([UPPER, LOWER], z), FAR_PLANE.into()], "", false),
        (vec![square([UPPER, LOWER], z), square([UPPER, LOWER], [9.0; 4])], "", false),
        (vec![square([UPPER, LOWER], z), FAR_PLANE.into()], odd, true),
        (vec![square([UPPER, LOWER], z), FAR.into(), FAR_PLANE.into()], "", true),
    ] {
        let surfaces: Vec<&str> = surfaces.iter().map(String::as_str).collect();
        let camera = load(&projector(&surfaces, reparam));
        assert_eq!((camera.is_curved(), camera.piece_count()), (curved, 2));
        for (i, j) in pixels() {
            let (a, b) = place(i, j);
            let (piece, curve) = camera.curve(0, i, j).unwrap();
            assert_eq!(piece, u32::from(a + b > 1.0), "{a},{b}");
            assert!(close(curve.points()[0], DVec3::new(a, b, height(a, b))), "{a},{b}: {}", curve.points()[0]);
        }
    }
    // on the diagonal both hold the pixel: the order in the file decides (3 x 2^k pixels per side give exact places)
    let swapped = load(&projector(&[&square([LOWER, UPPER], z), FAR, FAR], ""));
    assert!(pixels().all(|(i, j)| {
        let (a, b) = place(i, j);
        swapped.curve(0, i, j).unwrap().0 == u32::from(a + b < 1.0 - 1e-9)
    }));
}

#[test]
fn nothing_is_outside_the_pieces() {
    let half = square([UPPER], [0.0; 4]);
    for surfaces in [vec![half.as_str(), FAR], vec![half.as_str(), FAR, FAR_PLANE]] {
        let camera = load(&projector(&surfaces, ""));
        for (i, j) in pixels() {
            let (a, b) = place(i, j);
            assert_eq!(camera.curve(0, i, j).is_some(), a + b <= 1.0 + 1e-9, "{a},{b}");
        }
    }
}

#[test]
fn surfaces_tessellated_differently_count_each_pair() {
    let other = "{ kind = 'pieces', vertices = [{ image = [0, 0], at = [5, 5, 5] }, { image = [0.5, 0], at = [5, 6, 5] }, \
                 { image = [1, 0], at = [5, 5, 7] }, { image = [0, 1], at = [8, 5, 5] }, { image = [0.5, 1], at = [5, 9, 5] }, \
                 { image = [1, 1], at = [5, 5, 9] }], triangles = [[0, 1, 3], [1, 4, 3], [1, 2, 4], [2, 5, 4]] }";
    let camera = load(&projector(&[&square([UPPER, LOWER], [0.0; 4]), other], ""));
    assert_eq!(camera.piece_count(), 8);
    for (i, j) in pixels() {
        let (a, b) = place(i, j);
        let first = u32::from(a + b > 1.0 + 1e-9);
        let column = u32::from(a > 0.5);
        let second = 2 * column + u32::from(2.0 * (a - 0.5 * column as f64) + b > 1.0 + 1e-9);
        assert_eq!(camera.curve(0, i, j).unwrap().0, first + 2 * second, "{a},{b}");
    }
}

#[test]
fn overlapping_pieces_are_owned_by_the_lowest_numbered() {
    let both = square([UPPER, "[0, 1, 3]"], [0.0, 1.0, 2.0, 3.0]);
    let camera = load(&projector(&[&both, FAR], ""));
    for (i, j) in pixels() {
        let (a, b) = place(i, j);
        let owner = if a + b <= 1.0 + 1e-9 { Some(0) } else { (b <= a + 1e-9).then_some(1) };
        assert_eq!(camera.curve(0, i, j).map(|c| c.0), owner, "{a},{b}");
    }
}
