//! Wrong projectors: one line that names the key.

use super::make::*;

#[test]
fn wrong_projectors_say_what_is_wrong() {
    let dir = tempfile::tempdir().unwrap();
    let fails = |camera: String, key: &str, why: &str| {
        let error = try_load(dir.path(), &camera).map(|c| c.kind).unwrap_err();
        let text = error.to_string();
        assert!(error.exit_code() == 2 && text.contains(key) && text.contains(why) && !text.contains('\n'), "{text}");
    };
    let one = |surface: &str, key: &str, why: &str| fails(projector(&[surface, FAR], ""), key, why);
    fails("kind = 'projector'".into(), "camera", "surfaces is missing");
    fails(projector(&[FAR], ""), "camera.surfaces", "1 surfaces");
    fails(projector(&[FAR; 5], ""), "camera.surfaces", "5 surfaces");
    fails(projector(&[FAR, FAR], ""), "camera.surfaces", "no pixel has a projector");
    fails(projector(&[FAR, FAR, FAR], ""), "camera.surfaces", "no pixel has a projector");
    fails(projector(&[FAR, FAR_PLANE], "t_range = [0, 2]"), "t_range", "unknown key");
    one("{ kind = 'torus' }", "camera.surfaces.0.kind", "unknown kind \"torus\"");
    one("{ at = [0, 0, 0] }", "camera.surfaces.0", "kind is missing");
    one("{ kind = 'plane', origin = [0, 0, 0], u = [1, 0, 0] }", "camera.surfaces.0", "v is missing");
    one(
        "{ kind = 'plane', origin = [0, 0, 0], u = [1, 0, 0], w = [1, 0, 0] }",
        "camera.surfaces.0",
        "unknown key \"w\"",
    );
    one("{ kind = 'bilinear', corners = [[0, 0, 0]] }", "camera.surfaces.0.corners", "four points");
    one("{ kind = 'cylinder', center = [0, 0, 0], axis = [0, 0, 0], radius = 1, height = 1 }", "0.axis", "is zero");
    one("{ kind = 'cylinder', center = [0, 0, 0], axis = [0, 1, 0], radius = -1, height = 1 }", "0.radius", "below 0");
    one("{ kind = 'sphere', center = [0, 0, 0], radius = 1, lon = [0], lat = [0, 1] }", "0.lon", "two angles");
    one("{ kind = 'disc', center = [0, 0, 0], normal = [0, 1, 0], radius = 1 }", "surfaces.0", "up is parallel");
    let bezier = |points: &str| format!("{{ kind = 'bezier', points = {points} }}");
    one(&bezier("[[[0, 0, 0], [1, 0, 0]]]"), "0.points", "1 rows; 2 to 6");
    one(&bezier("[[[0, 0, 0], [1, 0, 0]], [[0, 0, 0]]]"), "0.points.1", "1 in this row; 2 to 6");
    one(&bezier("[[[0, 0, 0], [1, 0, 0]], [[0, 0, 0], [1, 1, 1], [2, 2, 2]]]"), "0.points.1", "rows must be equal");
    one(&bezier("[[0, 1, 2], [3, 4, 5]]"), "0.points.0.0", "three numbers");
    one(&bezier(&grid(7, 2).1), "0.points", "7 rows; 2 to 6");
    let spline = |rest: &str| format!("{{ kind = 'bspline', points = {}, {rest} }}", grid(3, 4).1);
    one(&spline("degree = 3"), "0.points", "3 rows; 4 to");
    one(&spline("degree = 0"), "0.degree", "1 to 5");
    one(&spline("degree = [3, 2], knots_u = [0, 1]"), "0.knots_u", "2 knots; 4 control points of degree 3 need 8");
    one(&spline("degree = [3, 2], knots_u = [0, 0, 0, 0, 1, 1, 1, 0.5]"), "0.knots_u", "knot 7 is below");
    one(&spline("degree = [1, 2], knots_u = [0, 1, 1, 1, 2, 3]"), "0.knots_u", "more than 2 times");
    one(&spline("degree = 2, knots_v = [0, 1, 2, 2, 3, 4]"), "0.knots_v", "no extent");
    let nurbs =
        |weights: &str| format!("{{ kind = 'nurbs', degree = 1, points = {}, weights = {weights} }}", grid(2, 2).1);
    one(&nurbs("[[1, 1], [1, 0]]"), "0.weights.1.1", "0 is not above 0");
    one(&nurbs("[[1, 1, 1], [1, 1, 1]]"), "0.weights", "one weight for each control point");
    one(&square(["[0, 1, 4]"], [0.0; 4]), "0.triangles", "vertex 4 does not exist");
    one(&square(["[0, 1, 1]"], [0.0; 4]), "0.triangles", "no area");
    one(&square([], [0.0; 4]), "0.triangles", "no pieces");
    let map = |reparam: &str, key: &str, why: &str| {
        fails(projector(&[FAR, FAR_PLANE], &format!("reparam = {reparam}")), key, why);
    };
    map("{ kind = 'mirror' }", "reparam.kind", "unknown kind");
    map("{ kind = 'affine', m = [[1, 0], [0, 1]] }", "reparam.m.0", "three numbers");
    map("{ kind = 'polar', power = 2 }", "reparam", "unknown key \"power\"");
    map("{ kind = 'lens', power = 0 }", "reparam.power", "not above 0");
    map("{ kind = 'magnify', center = [0, 0], radius = 0, strength = 2 }", "reparam.radius", "not above 0");
    map("{ kind = 'magnify', center = [0, 0], radius = 1, strength = -2 }", "reparam.strength", "not above 0");
    map("{ kind = 'table', file = 'none.npy' }", "reparam.file", "cannot be read");
    anamorph::internals::image::write_npy_f64(&dir.path().join("three.npy"), &[1, 1, 3], &[0.0; 3]).unwrap();
    map("{ kind = 'table', file = 'three.npy' }", "reparam.file", "height x width x 2");
    anamorph::internals::image::write_npy_f64(&dir.path().join("nan.npy"), &[1, 1, 2], &[f64::NAN; 2]).unwrap();
    map("{ kind = 'table', file = 'nan.npy' }", "reparam.file", "no pair of finite numbers");
}
