//! Mirrors and lenses: closed forms that the reference must give, and the engine's frames against the reference by
//! margin. The frames have nothing to do without an adapter.

use crate::common;

use anamorph::internals::camera::Camera;
use anamorph::internals::image::frame::{Channel, Frame, NO_ID};
use anamorph::internals::reference::image::image;
use anamorph::internals::reference::{Path, Reference, Segment};
use anamorph::internals::scene::Scene;
use common::file::load;
use common::gpu::{Without, assert_same_without_f64, check, ids, render_with};
use glam::DVec3;

/// A floor, a ball, a box and a teapot around the origin; the mirror goes into the middle.
const THINGS: &str = r#"
[[mesh]]
builtin = "plane"
size = 12
divisions = 6
translate = [0, -1.2, 0]
[[mesh]]
builtin = "icosphere"
level = 2
scale = 0.5
translate = [-1.6, -0.3, 1.4]
[[mesh]]
builtin = "teapot"
level = 3
scale = 0.4
translate = [1.6, -1.2, 1.2]
[[mesh]]
builtin = "box"
scale = 0.5
translate = [0.3, -0.9, 1.9]
[[light]]
direction = [-1, -2, -1.2]
"#;

const EYE: &str = r#"eye = { kind = "pinhole", eye = [0.3, 1.1, 6], target = [0, -0.1, 0], vfov = 42 }"#;

fn scene(size: (u32, u32), things: &str, camera: &str) -> (Scene, Camera) {
    let (w, h) = size;
    let image = format!("image = {{ width = {w}, height = {h}, background = [0.2, 0.3, 0.4] }}");
    let scene = load(&format!("{image}\n{things}\n[camera]\n{camera}\n")).unwrap();
    let camera = scene.camera().unwrap();
    (scene, camera)
}

/// The last ray of a pixel's path, and the length of the path before it.
fn last_ray(scene: &Scene, camera: &Camera, i: u32, j: u32) -> (DVec3, DVec3, f64) {
    let scene = scene.with_optics(camera);
    let reference = Reference::build(&scene.mesh);
    let shown = reference.shown(camera, Path::of_pixel(camera, i, j));
    let rays: Vec<_> = shown
        .path
        .segments
        .iter()
        .map(|s| match s {
            Some((_, Segment::Straight(b))) => b.ray(0.0, 0.0),
            _ => panic!("a straight ray"),
        })
        .collect();
    let last = rays[rays.len() - 1];
    let before = rays[..rays.len() - 1].iter().map(|r| r.direction.length()).sum();
    (last.origin, last.direction, before)
}

/// How far a line passes from a point.
fn distance(point: DVec3, (origin, direction): (DVec3, DVec3)) -> f64 {
    (point - origin).cross(direction).length() / direction.length()
}

fn hit(frame: &Frame, k: usize) -> bool {
    frame.u32(Channel::TriangleId).unwrap()[k] != NO_ID
}

#[test]
fn a_ball_shows_what_is_behind_the_eye_at_its_path_length() {
    // a wall at z = 7 behind an eye at z = 5; the middle pixel looks along the axis
    let wall = "[[mesh]]\nbuiltin = \"plane\"\nsize = 40\nrotate = [90, 0, 0]\ntranslate = [0, 0, 7]";
    let eye = r#"eye = { kind = "pinhole", eye = [0, 0, 5], target = [0, 0, 0], vfov = 40 }"#;
    let mirror = format!("kind = \"reflection\"\n{eye}\nmirror = {{ shape = \"sphere\", radius = 1.5 }}");
    let (scene, camera) = scene((31, 21), wall, &mirror);
    let frame = image(&scene, &camera, &Channel::ALL);
    let middle = 10 * 31 + 15;
    assert!(hit(&frame, middle));
    assert!((frame.f32(Channel::Z).unwrap()[middle] - (3.5 + 5.5)).abs() < 1e-6);
    assert!((frame.f32(Channel::T).unwrap()[middle] - 5.5).abs() < 1e-6);
    assert_eq!(frame.u32(Channel::MirrorId).unwrap()[middle], 0);
    assert_eq!(frame.u32(Channel::PieceId).unwrap()[middle], 1, "behind the one piece of the eye");
}

#[test]
fn conics_gather_the_rays_of_one_focus_in_the_other() {
    let no_scene = "";
    // a paraboloid of focal length 1 / (2 curvature) gathers rays along its axis
    let parallel = r#"eye = { kind = "orthographic", eye = [0, 0, 5], target = [0, 0, 0], height = 1.8 }"#;
    let bowl = "mirror = { shape = \"quadric\", vertex = [0, 0, 0], axis = [0, 0, 1], curvature = 0.5, conic = -1, radius = 1.5 }";
    let (s, camera) = scene((13, 9), no_scene, &format!("kind = \"reflection\"\n{parallel}\n{bowl}"));
    for k in 0..13 * 9 {
        let (origin, direction, _) = last_ray(&s, &camera, k % 13, k / 13);
        let off = distance(DVec3::Z, (origin, direction));
        assert!(off < 1e-14, "{off}");
    }
    // an ellipsoid with half axes 2 along z and sqrt(3): foci 1 from its middle, one in the eye
    let (curvature, conic) = (2.0 / 3.0, 3.0 / 4.0 - 1.0);
    let bowl = format!(
        "mirror = {{ shape = \"quadric\", vertex = [0, 0, -2], axis = [0, 0, 1], curvature = {curvature}, conic = {conic}, radius = 1.7 }}"
    );
    let eye = r#"eye = { kind = "pinhole", eye = [0, 0, 1], target = [0, 0, 0], vfov = 30 }"#;
    let (s, camera) = scene((13, 9), no_scene, &format!("kind = \"reflection\"\n{eye}\n{bowl}"));
    for k in 0..13 * 9 {
        let (origin, direction, before) = last_ray(&s, &camera, k % 13, k / 13);
        let off = distance(-DVec3::Z, (origin, direction));
        let length = before + (origin + DVec3::Z).length();
        assert!(off < 1e-14 && (length - 4.0).abs() < 1e-14, "{off} {length}");
    }
}

#[test]
fn rays_refract_by_snells_law_and_leave_a_slab_as_they_came() {
    let eye = r#"eye = { kind = "pinhole", eye = [0, 0, 4], target = [0.4, 0.2, 0], vfov = 50 }"#;
    // one flat interface at z = 0
    let flat = "lens = { shape = \"quadric\", axis = [0, 0, -1], curvature = 0, radius = 9 }\nior = 1.5";
    let (s, camera) = scene((15, 11), "", &format!("kind = \"refraction\"\n{eye}\n{flat}"));
    for k in 0..15 * 11 {
        let before = camera.ray(k % 15, k / 15).unwrap().direction.normalize();
        let (_, after, _) = last_ray(&s, &camera, k % 15, k / 15);
        let sine = |d: DVec3| (d.x * d.x + d.y * d.y).sqrt();
        assert!((sine(before) - 1.5 * sine(after)).abs() < 1e-15);
        assert!(before.cross(after).z.abs() < 1e-15 && after.z < 0.0);
    }
    // a plane-parallel lens shifts rays and keeps their directions
    let slab = "lens = { shape = \"lens\", axis = [0, 0, -1], radius = 9, thickness = 0.5, curvatures = [0, 0] }\nior = 1.5\ndepth = 2";
    let (s, camera) = scene((15, 11), "", &format!("kind = \"refraction\"\n{eye}\n{slab}"));
    for k in 0..15 * 11 {
        let before = camera.ray(k % 15, k / 15).unwrap().direction.normalize();
        let (_, after, _) = last_ray(&s, &camera, k % 15, k / 15);
        assert!((before - after).length() < 1e-15);
    }
}

#[test]
fn light_beyond_the_critical_angle_is_reflected() {
    // from inside water, through a flat surface above: sine 1 / 1.33 is the edge of the window
    let eye = r#"eye = { kind = "fisheye", eye = [0, -1, 0], target = [0, 0, 0], up = [0, 0, -1], fov = 170 }"#;
    let water = "lens = { shape = \"quadric\", axis = [0, -1, 0], curvature = 0, radius = 500 }\nior = 1.33";
    let (s, camera) = scene((41, 41), "", &format!("kind = \"refraction\"\n{eye}\n{water}"));
    let (mut through, mut back) = (0, 0);
    for k in 0..41 * 41 {
        let Some(ray) = camera.ray(k % 41, k / 41) else { continue };
        let d = ray.direction.normalize();
        let (_, after, _) = last_ray(&s, &camera, k % 41, k / 41);
        let sine = (1.0 - d.y * d.y).sqrt();
        assert_eq!(after.y > 0.0, sine < 1.0 / 1.33, "{d} {after}");
        if after.y > 0.0 { through += 1 } else { back += 1 }
    }
    assert!(through > 300 && back > 300, "{through} {back}");
}

#[test]
fn a_thin_lens_has_the_focal_length_of_its_makers() {
    // 1 / f = (n - 1) (c1 - c2 + (n - 1) d c1 c2 / n), from the principal plane
    let (n, c, d) = (1.5, 0.2, 0.05);
    let f = 1.0 / ((n - 1.0) * (2.0 * c - (n - 1.0) * d * c * c / n));
    let eye = r#"eye = { kind = "orthographic", eye = [0, 0, 5], target = [0, 0, 0], height = 0.02 }"#;
    let lens = format!(
        "lens = {{ shape = \"lens\", axis = [0, 0, -1], radius = 0.3, thickness = {d}, curvatures = [{c}, -{c}] }}\nior = {n}\ndepth = 2"
    );
    let (s, camera) = scene((9, 9), "", &format!("kind = \"refraction\"\n{eye}\n{lens}"));
    let back = -(d / 2.0) - f * (1.0 - (n - 1.0) * d * c / n);
    for k in (0..81).filter(|k| *k != 40) {
        let (origin, direction, _) = last_ray(&s, &camera, k % 9, k / 9);
        let out = DVec3::new(origin.x, origin.y, 0.0);
        let t = -out.length_squared() / direction.dot(out);
        let at = origin.z + t * direction.z;
        // spherical aberration at 0.014 from the axis: 3e-5 of f
        assert!((at - back).abs() < 1e-3 * f, "{at} {back}");
    }
}

#[test]
fn two_facing_mirrors_repeat_as_often_as_asked() {
    // an eye between two walls of mirrors sees itself nowhere, and the box of mirrors at every depth
    let eye = r#"eye = { kind = "pinhole", eye = [0, 0, 0], target = [0.2, 0.1, -1], vfov = 40 }"#;
    let ball = |depth: u32| {
        format!(
            "kind = \"reflection\"\n{eye}\nmirror = {{ builtin = \"icosphere\", level = 2, scale = 3 }}\ndepth = {depth}"
        )
    };
    for depth in [1, 2, 5] {
        let (s, camera) = scene((9, 7), "", &ball(depth));
        let joined = s.with_optics(&camera);
        let reference = Reference::build(&joined.mesh);
        for k in 0..63 {
            let shown = reference.shown(&camera, Path::of_pixel(&camera, k % 9, k / 9));
            assert_eq!(shown.path.segments.len() as u32, depth + 1);
            // inside a closed mirror a ray ends on it, where it sees it at all
            assert_eq!(shown.seen.is_some(), depth > 1);
        }
    }
}

/// The first ray's end and the second's direction, of the one pixel that a parallel eye of next to no height looks with.
fn first_bounce(from: [f64; 3], to: [f64; 3], optics: &str) -> (DVec3, DVec3) {
    let eye = format!(
        "eye = {{ kind = \"orthographic\", eye = {from:?}, target = {to:?}, up = [0.3, 0.5, 0.7], height = 1e-30 }}"
    );
    let (s, camera) = scene((1, 1), "", &format!("{eye}\n{optics}"));
    let (origin, direction, _) = last_ray(&s, &camera, 0, 0);
    (origin, direction)
}

#[test]
fn rays_meet_a_torus_where_its_circles_are() {
    let ring = |depth: u32| {
        format!(
            "kind = \"reflection\"\nmirror = {{ shape = \"torus\", center = [1, 0, 0], axis = [0, 1, 0], radius = 2, tube = 0.5 }}\ndepth = {depth}"
        )
    };
    let near = |seen: (DVec3, DVec3), place: [f64; 3], direction: [f64; 3]| {
        // places of size 3 in f64, through a quartic of slope 0.3 and more
        let (off, rotated) = ((seen.0 - DVec3::from(place)).length(), (seen.1 - DVec3::from(direction)).length());
        assert!(off < 1e-13 && rotated < 1e-12, "{seen:?} for {place:?} {direction:?}");
    };
    // down on its top, from the side on its outer equator, from within on its inner one
    near(first_bounce([3., 5., 0.], [3., 0., 0.], &ring(1)), [3., 0.5, 0.], [0., 1., 0.]);
    near(first_bounce([9., 0., 0.], [0., 0., 0.], &ring(1)), [3.5, 0., 0.], [1., 0., 0.]);
    near(first_bounce([1., 0., 0.], [5., 0., 0.], &ring(1)), [2.5, 0., 0.], [-1., 0., 0.]);
    // at 45 degrees on the tube the ray is rotated to the side
    let h = 0.5 * 0.5f64.sqrt();
    near(first_bounce([3. + h, 5., 0.], [3. + h, 0., 0.], &ring(1)), [3. + h, h, 0.], [1., 0., 0.]);
    // to and fro through the middle of the ring, as often as asked
    for (depth, place) in [(2, -0.5), (3, 2.5), (8, -0.5)] {
        near(
            first_bounce([1., 0., 0.], [5., 0., 0.], &ring(depth)),
            [place, 0., 0.],
            [if place < 0. { 1. } else { -1. }, 0., 0.],
        );
    }
    // from ten thousand away
    let far = first_bounce([3. + h, 1e4, 0.], [3. + h, 0., 0.], &ring(1));
    assert!((far.0 - DVec3::new(3. + h, h, 0.)).length() < 1e-11 && (far.1 - DVec3::X).length() < 1e-11, "{far:?}");
}

#[test]
fn rays_meet_a_wave_at_crests_and_between() {
    // crests at a quarter of the wavelength from the middle both ways
    let wave = |depth: u32| {
        format!(
            "kind = \"reflection\"\nmirror = {{ shape = \"wave\", center = [0, 1, 0], size = 8, amplitude = 0.25, wavelength = 2 }}\ndepth = {depth}"
        )
    };
    let near = |seen: (DVec3, DVec3), place: [f64; 3], direction: [f64; 3]| {
        let (off, rotated) = ((seen.0 - DVec3::from(place)).length(), (seen.1 - DVec3::from(direction)).length());
        assert!(off < 1e-14 && rotated < 1e-14, "{seen:?} for {place:?} {direction:?}");
    };
    near(first_bounce([0.5, 5., 0.5], [0.5, 0., 0.5], &wave(1)), [0.5, 1.25, 0.5], [0., 1., 0.]);
    near(first_bounce([0.5, -5., -0.5], [0.5, 0., -0.5], &wave(1)), [0.5, 0.75, -0.5], [0., -1., 0.]);
    near(first_bounce([2., 5., 3.25], [2., 0., 3.25], &wave(1)), [2., 1., 3.25], {
        // steepest along x, where sin(2 pi z / 2) is -sin(pi / 4)
        let slope = -0.25 * std::f64::consts::PI * 0.5f64.sqrt();
        let s = 1. + slope * slope;
        [-2. * slope / s, 2. / s - 1., 0.]
    });
    // between two crests a ray along x meets the first slope as high as it is
    let along = first_bounce([-9., 1.125, 0.5], [9., 1.125, 0.5], &wave(1));
    // sin(pi x) = 1 / 2 first behind the border at -4: at -4 + 1 / 6
    assert!((along.0 - DVec3::new(-4. + 1. / 6., 1.125, 0.5)).length() < 1e-14, "{along:?}");
    // a ray on the line that the surface holds at z = 0 meets it at once where it is over the square
    let first = first_bounce([-9., 1., 0.], [9., 1., 0.], &wave(1));
    assert!((first.0.x + 4.).abs() < 1e-9, "{first:?}");
    // nothing beside the square
    let (s, camera) = scene(
        (1, 1),
        "",
        &format!(
            "{}\n{}",
            r#"eye = { kind = "orthographic", eye = [4.1, 5, 0.5], target = [4.1, 0, 0.5], up = [0, 0, 1], height = 1e-30 }"#,
            wave(1)
        ),
    );
    assert!(Reference::build(&s.mesh).shown(&camera, Path::of_pixel(&camera, 0, 0)).first.is_none());
}

/// Every kind of surface and law, by engine and reference.
#[test]
fn frames_agree_with_the_reference() {
    let sphere = "shape = \"sphere\", radius = 1, count = 300";
    let torus = "shape = \"torus\", axis = [0.3, 1, 0.5], radius = 0.9, tube = 0.35, count = 800";
    let bowl = "shape = \"quadric\", vertex = [0, -0.4, -0.5], axis = [0, 0.2, 1], curvature = 0.7, conic = -0.8, radius = 1.3, count = 400";
    let lens = "shape = \"lens\", center = [0, 0, 2.5], axis = [0, 0, -1], radius = 0.9, thickness = 0.6, curvatures = [0.5, -0.6], count = 500";
    let wave = "shape = \"wave\", center = [0, -0.9, 1], size = 5, amplitude = 0.06, wavelength = 1.7, count = 600";
    let chop = "shape = \"wave\", center = [0, -0.6, 1], size = 5, amplitude = 0.25, wavelength = 1.1";
    let pot = "builtin = \"teapot\", level = 4, scale = 0.7, translate = [0, -0.6, 0]";
    let mirrors = [
        (sphere, "exact", 1),
        (sphere, "normals", 1),
        (sphere, "flat", 1),
        (torus, "exact", 1),
        (torus, "exact", 3),
        (torus, "normals", 3),
        (torus, "flat", 1),
        (bowl, "exact", 4),
        (bowl, "flat", 1),
        (lens, "exact", 1),
        (wave, "exact", 1),
        (chop, "exact", 3),
        (wave, "normals", 2),
        (pot, "normals", 2),
        (pot, "flat", 1),
        (&format!("{sphere}, cameras = 40"), "flat", 1),
        (&format!("{torus}, cameras = 90"), "normals", 2),
        (&format!("{pot}, cameras = 120"), "normals", 1),
    ];
    for (mirror, facets, depth) in mirrors {
        let text =
            format!("kind = \"reflection\"\n{EYE}\nmirror = {{ {mirror} }}\nfacets = \"{facets}\"\ndepth = {depth}");
        let (scene, camera) = scene((77, 59), THINGS, &text);
        let name = format!("reflection, {facets}, depth {depth}, {mirror}");
        let Some((frame, ..)) = check(&name, &scene, &camera) else { return };
        assert_numbers(&name, &scene, &camera, &frame);
    }
    let lenses = [
        (sphere, "exact", 1),
        (sphere, "exact", 2),
        (sphere, "normals", 4),
        (sphere, "flat", 1),
        (lens, "exact", 2),
        (lens, "normals", 6),
        (torus, "exact", 2),
        (torus, "exact", 4),
        (chop, "exact", 1),
        (wave, "normals", 1),
        (wave, "flat", 1),
        (&format!("{lens}, cameras = 100"), "normals", 3),
    ];
    for (lens, facets, depth) in lenses {
        let text = format!(
            "kind = \"refraction\"\nior = 1.5\n{EYE}\nlens = {{ {lens} }}\nfacets = \"{facets}\"\ndepth = {depth}"
        );
        let (scene, camera) = scene((77, 59), THINGS, &text);
        let name = format!("refraction, {facets}, depth {depth}, {lens}");
        let Some((frame, ..)) = check(&name, &scene, &camera) else { return };
        assert_numbers(&name, &scene, &camera, &frame);
    }
}

/// The optics are seen where the reference sees them, and the path lengths agree. A pixel that is not safe may see another.
fn assert_numbers(name: &str, scene: &Scene, camera: &Camera, frame: &Frame) {
    let truth = image(scene, camera, &Channel::ALL);
    let of = |f: &Frame| f.u32(Channel::MirrorId).unwrap().to_vec();
    let (seen, known) = (of(frame), of(&truth));
    let mirrored = known.iter().filter(|k| **k != NO_ID).count();
    let differ = (0..seen.len()).filter(|k| seen[*k] != known[*k]).count();
    assert!(mirrored > seen.len() / 20, "{name}: {mirrored} pixels see the optics");
    assert!(differ <= seen.len() / 1000, "{name}: {differ} of {mirrored} pixels name another facet");
    let piece = |f: &Frame| f.u32(Channel::PieceId).unwrap().to_vec();
    let (piece, piece_known) = (piece(frame), piece(&truth));
    let (z, z_known) = (frame.f32(Channel::Z).unwrap(), truth.f32(Channel::Z).unwrap());
    let covered = |f: &Frame| f.f32(Channel::A).unwrap().to_vec();
    let (a, a_known) = (covered(frame), covered(&truth));
    for k in (0..seen.len()).filter(|k| seen[*k] == known[*k]) {
        assert_eq!(a[k], a_known[k], "{name}: pixel {k}");
        assert!(seen[k] == NO_ID || piece[k] == piece_known[k], "{name}: pixel {k}");
        let both = z[k].is_finite() && z_known[k].is_finite();
        // a few f32 roundings of each of up to seven lengths
        assert!(
            !both || hit_differs(frame, &truth, k) || (z[k] - z_known[k]).abs() <= 1e-5 * z_known[k],
            "{name}: pixel {k}"
        );
    }
}

fn hit_differs(a: &Frame, b: &Frame, k: usize) -> bool {
    a.u32(Channel::TriangleId).unwrap()[k] != b.u32(Channel::TriangleId).unwrap()[k]
}

#[test]
fn fresnel_shares_the_light_and_loses_none() {
    let eye = r#"eye = { kind = "pinhole", eye = [0, 0, 5], target = [0, 0, 0], vfov = 30 }"#;
    let glass = |depth: u32| {
        format!(
            "kind = \"refraction\"\n{eye}\nlens = {{ shape = \"sphere\", radius = 1 }}\nior = 1.5\nfresnel = true\ndepth = {depth}\nbase = [0.2, 0.3, 0.4]"
        )
    };
    // straight on a fifth squared comes back, of what goes in and of what goes out
    let (s, camera) = scene((11, 11), "", &glass(2));
    let reference = Reference::build(&s.mesh);
    let optics = camera.optics.as_ref().unwrap();
    let shares = reference.shares(optics, &Path::of_pixel(&camera, 5, 5));
    let mut light: Vec<f64> = shares.iter().map(|o| o.light).collect();
    light.sort_by(f64::total_cmp);
    for (seen, known) in light.iter().zip([0.96 * 0.04, 0.04, 0.96 * 0.96]) {
        assert!((seen - known).abs() < 1e-15, "{light:?}");
    }
    // where everything has one colour, so has the glass, whatever its shape and roughness
    for depth in [1, 2, 4] {
        for rough in ["", "roughness = 0.2\nrays = 3"] {
            let (s, camera) = scene((31, 31), "", &format!("{}\n{rough}", glass(depth)));
            let Some(frame) = render_with(&s, &camera, Without::Nothing, &Default::default()) else { return };
            for (channel, known) in [(Channel::R, 0.2), (Channel::G, 0.3), (Channel::B, 0.4)] {
                // up to 48 sums and products of shares, 2^-24 each
                let near = |v: &f32| (v - known).abs() < 1e-5;
                assert!(frame.frame.f32(channel).unwrap().iter().all(near), "depth {depth}, {rough}");
            }
        }
    }
}

/// Colours that several rays per pixel make up, by engine and reference.
#[test]
fn colours_of_split_rays_agree_with_the_reference() {
    let ball = "shape = \"sphere\", radius = 1";
    let lens = "shape = \"lens\", center = [0, 0, 2.5], axis = [0, 0, -1], radius = 0.9, thickness = 0.6, curvatures = [0.5, -0.6]";
    let torus = "shape = \"torus\", axis = [0.3, 1, 0.5], radius = 0.9, tube = 0.35";
    let wave = "shape = \"wave\", center = [0, -0.9, 1], size = 5, amplitude = 0.06, wavelength = 1.7";
    let cases = [
        format!("kind = \"refraction\"\nior = 1.5\nfresnel = true\ndepth = 3\nlens = {{ {torus} }}"),
        format!("kind = \"reflection\"\nroughness = 0.05\nrays = 4\ndepth = 2\nmirror = {{ {wave} }}"),
        format!("kind = \"refraction\"\nior = 1.5\nfresnel = true\ndepth = 3\nlens = {{ {ball} }}"),
        format!(
            "kind = \"refraction\"\nior = 1.3\nfresnel = true\ndepth = 4\nlens = {{ {lens} }}\nfacets = \"normals\""
        ),
        format!("kind = \"refraction\"\nior = 1.5\nfresnel = true\nlens = {{ {ball} }}\nfacets = \"flat\""),
        format!("kind = \"reflection\"\nroughness = 0.1\nrays = 7\ncolor = [0.9, 0.8, 0.7]\nmirror = {{ {ball} }}"),
        format!(
            "kind = \"reflection\"\nroughness = 0.05\nrays = 4\ndepth = 2\nmirror = {{ {ball} }}\nfacets = \"normals\""
        ),
    ];
    for text in cases {
        let (scene, camera) = scene((81, 61), THINGS, &format!("{text}\n{EYE}"));
        let Some((frame, judged, _)) = check(&text, &scene, &camera) else { return };
        let mut off = 0;
        for channel in [Channel::R, Channel::G, Channel::B] {
            let (seen, known) = (frame.f32(channel).unwrap(), judged.truth.f32(channel).unwrap());
            // some ten f32 roundings of a colour, and steep normals next to edges
            off += seen.iter().zip(known).filter(|(a, b)| (*a - *b).abs() > 1e-4).count();
        }
        assert_eq!(off, 0, "{text}: {off} colours are off");
    }
}

/// Pixels of those that see the mirror which name another triangle.
fn wrong(frame: &Frame, truth: &Frame) -> f64 {
    let ids = |f: &Frame, c| f.u32(c).unwrap().to_vec();
    let (mirror, seen, known) =
        (ids(truth, Channel::MirrorId), ids(frame, Channel::TriangleId), ids(truth, Channel::TriangleId));
    let pixels: Vec<usize> = (0..mirror.len()).filter(|&k| mirror[k] != NO_ID).collect();
    pixels.iter().filter(|&&k| seen[k] != known[k]).count() as f64 / pixels.len() as f64
}

#[test]
fn what_is_approximate_comes_nearer_with_facets_and_texels() {
    let ball = |keys: &str, own: &str| {
        let text =
            format!("kind = \"reflection\"\n{EYE}\n{keys}\nmirror = {{ shape = \"sphere\", radius = 1.2, {own} }}");
        let (scene, camera) = scene((141, 107), THINGS, &text);
        render_with(&scene, &camera, Without::Nothing, &Default::default()).map(|r| r.frame)
    };
    let Some(truth) = ball("facets = \"exact\"", "count = 4") else { return };
    let off = |keys: &str, own: &str| wrong(&ball(keys, own).unwrap(), &truth);
    let count = |n: u32| format!("count = {n}");
    for law in ["flat", "normals"] {
        let keys = format!("facets = \"{law}\"");
        let (coarse, fine, finest) = (off(&keys, &count(126)), off(&keys, &count(1000)), off(&keys, &count(16_000)));
        println!("{law}: {coarse} {fine} {finest}");
        // the sagitta of a facet falls with their number, 8 and 16 times as many, and edges move with it; of few facets a
        // quarter of the picture is wrong, and more than all of it cannot be
        assert!(fine < coarse / 2.0 && finest < fine / 4.0, "{law}: {coarse} {fine} {finest}");
    }
    for law in ["flat", "normals"] {
        let (direct, few, many) = (
            off(&format!("facets = \"{law}\""), &count(1000)),
            off(&format!("facets = \"{law}\"\natlas = 4"), &count(1000)),
            off(&format!("facets = \"{law}\"\natlas = 32"), &count(1000)),
        );
        println!("{law} in an atlas: {few} {many}, direct {direct}");
        assert!(many < few && many < direct + (few - direct) / 3.0, "{law}: {few} {many}, direct {direct}");
    }
    // an atlas shows spheres, too
    let spheres = |keys: &str| {
        let text = format!(
            "kind = \"reflection\"\n{EYE}\n{keys}\nmirror = {{ shape = \"sphere\", radius = 1.2, count = 1000 }}"
        );
        let spheres = "[[spheres]]\ncenters = [[-1.6, -0.3, 1.4], [1.2, 0.4, 1.6]]\nradius = 0.4\n";
        let (scene, camera) = scene((141, 107), &format!("{THINGS}{spheres}"), &text);
        let frame = render_with(&scene, &camera, Without::Nothing, &Default::default()).unwrap().frame;
        let is_shown = |id: &u32| *id != NO_ID && scene.mesh.radius(*id).is_some();
        ids(&frame).iter().map(is_shown).collect::<Vec<bool>>()
    };
    let [direct, atlas] = ["facets = \"normals\"", "facets = \"normals\"\natlas = 32"].map(spheres);
    // normals of the atlas are those of a texel's middle: outlines move by up to two pixels
    let width = 141;
    let around = |k: usize| (0..25).map(move |n| k + n / 5 * width + n % 5 - 2 * width - 2);
    let rows = 2 * width + 2..direct.len() - 2 * width - 2;
    let inside: Vec<usize> = rows.filter(|k| around(*k).all(|n| direct[n] == direct[*k])).collect();
    let shown = inside.iter().filter(|k| direct[**k]).count();
    let different = inside.iter().filter(|k| atlas[**k] != direct[**k]).count();
    println!("{shown} pixels inside of spheres; {different} differ with an atlas");
    assert!(shown > 200 && different == 0, "{shown} {different}");
    // as the paper has it: few cameras in an atlas, on a mirror of its own silhouette
    let shot = |cameras: u32, texels: u32| {
        off(&format!("facets = \"normals\"\natlas = {texels}"), &format!("count = 3000, cameras = {cameras}"))
    };
    let (coarse, few, many) = (shot(100, 64), shot(600, 4), shot(600, 64));
    println!("an atlas of 100 and of 600 cameras: {coarse} {many}, of fewer texels {few}");
    assert!(many < coarse / 1.5 && many < few / 1.5, "{coarse} {few} {many}");
    // without parallax what stands near is out of place however fine the map
    let map = off("environment = [0, 0, 0]", &count(4));
    println!("environment map: {map}");
    assert!(map > 5.0 * off("facets = \"normals\"", &count(1000)), "{map}");
}

#[test]
fn a_fine_mirror_shows_what_a_coarse_one_reflects() {
    let ring = |facets: &str, own: &str| {
        let mirror = format!("mirror = {{ shape = \"torus\", axis = [0.3, 1, 1], radius = 0.9, tube = 0.45, {own} }}");
        let text = format!("kind = \"reflection\"\n{EYE}\nfacets = \"{facets}\"\n{mirror}");
        let (scene, camera) = scene((141, 107), THINGS, &text);
        let frame = render_with(&scene, &camera, Without::Nothing, &Default::default()).map(|r| r.frame);
        frame.map(|frame| (camera, frame))
    };
    // facets 20 times as fine as those that are shown are off by a 20th of what those are
    let Some((_, truth)) = ring("normals", "count = 100000") else { return };
    for law in ["normals", "flat"] {
        let (_, plain) = ring(law, "count = 5000").unwrap();
        let mirror = plain.u32(Channel::MirrorId).unwrap();
        let off = [40, 160, 640].map(|cameras| {
            let (camera, frame) = ring(law, &format!("count = 5000, cameras = {cameras}")).unwrap();
            // the eye sees the fine mirror, whatever reflects the rays
            assert!(frame.u32(Channel::MirrorId).unwrap() == mirror, "{law}, {cameras}: another silhouette");
            // one piece of the eye, and then the cameras
            let facets = camera.optics.as_ref().unwrap().facets().unwrap().clone();
            assert!(facets.piece_count().abs_diff(cameras) < 10, "{} cameras", facets.piece_count());
            assert_eq!(camera.piece_count(), 1 + facets.piece_count());
            let piece = frame.u32(Channel::PieceId).unwrap();
            let is_own = |k: usize| piece[k] == 1 + facets.coarse_of(mirror[k] as usize);
            assert!((0..mirror.len()).filter(|k| mirror[*k] != NO_ID).all(is_own), "{law}, {cameras}");
            wrong(&frame, &truth)
        });
        // what the fine mirror is off by itself stays
        let own = wrong(&plain, &truth);
        println!("{law}: {off:?} as 40, 160 and 640 cameras do, {own} by itself");
        // four times as many each: interpolated normals are off by the square of a camera's size, and edges move with them
        let more = off.map(|o| o - own);
        assert!(more[2] > 0.0 && more[1] < more[0] / 2.0 && more[2] < more[1] / 2.0, "{law}: {off:?}, {own}");
        // as many cameras as facets: the mirror itself, but for roundings of normals
        let (_, same) = ring(law, "count = 5000, cameras = 5000").unwrap();
        for channel in [Channel::TriangleId, Channel::MirrorId, Channel::PieceId] {
            assert!(same.u32(channel).unwrap() == plain.u32(channel).unwrap(), "{law}: another {channel:?}");
        }
        for channel in [Channel::R, Channel::T, Channel::Z, Channel::BaryU] {
            let pairs = same.f32(channel).unwrap().iter().zip(plain.f32(channel).unwrap());
            // 1e-15 of a normal, times at most 1e3 by slant, and one f32 rounding
            assert!(
                pairs.into_iter().all(|(a, b)| a == b || (a - b).abs() <= 1e-6 * b.abs().max(1.0)),
                "{law}: {channel:?}"
            );
        }
    }
}

#[test]
fn camera_facets_do_not_go_with_keys_that_say_otherwise() {
    let message = |own: &str, keys: &str| {
        let mirror = format!("mirror = {{ shape = \"sphere\", radius = 1, {own} }}");
        let text =
            format!("image = {{ width = 9, height = 9 }}\n[camera]\nkind = \"reflection\"\n{EYE}\n{keys}\n{mirror}\n");
        load(&text).unwrap_err().to_string()
    };
    for (keys, expected) in [
        ("facets = \"exact\"", "camera.mirror.cameras: this surface is met exactly"),
        ("facets_error = 1", "camera.mirror.cameras: facets_error is of facets with their own normals"),
    ] {
        let message = message("cameras = 30", keys);
        assert!(message.contains(expected), "{message}");
    }
    assert!(message("cameras = 3", "").contains("camera.mirror.cameras"));
    assert!(message("camera = 30", "").contains("cameras"));
}

#[test]
fn facets_are_as_many_as_an_error_or_a_count_asks_for() {
    let count = |keys: &str| {
        let (_, camera) = scene((141, 107), THINGS, &format!("kind = \"reflection\"\n{EYE}\n{keys}"));
        let n = camera.optics.as_ref().unwrap().surface_count();
        println!("{keys}: {n}, {:?}", camera.notes);
        n
    };
    let ball = "mirror = { shape = \"sphere\", radius = 1.2 }\nfacets = \"normals\"";
    let counts = [4.0, 1.0, 0.25].map(|px| count(&format!("{ball}\nfacets_error = {px}")));
    // interpolated normals are off by the square of a facet's size, so by the inverse of their number
    assert!(counts[0] < counts[1] && counts[1] < counts[2] && counts[2] < 64 * counts[0], "{counts:?}");
    for shape in ["torus\", radius = 0.9, tube = 0.35", "wave\", size = 5, amplitude = 0.06, wavelength = 1.7"] {
        let facets = format!("mirror = {{ shape = \"{shape} }}\nfacets = \"normals\"");
        let [coarse, fine] = [8.0, 1.0].map(|px| count(&format!("{facets}\nfacets_error = {px}")));
        assert!(coarse < fine && fine < 64 * coarse, "{shape}: {coarse} {fine}");
    }
    // an image of one row, and a mirror between the pixels that are looked at first
    for (size, vfov, radius) in [((141, 1), 0.3, 1.2), ((1900, 1267), 42.0, 0.02)] {
        let eye = EYE.replace("vfov = 42", &format!("vfov = {vfov}"));
        let mirror =
            format!("mirror = {{ shape = \"sphere\", radius = {radius} }}\nfacets = \"normals\"\nfacets_error = 1");
        let (_, camera) = scene(size, THINGS, &format!("kind = \"reflection\"\n{eye}\n{mirror}"));
        assert!(camera.notes.last().unwrap().contains(", off by "), "{:?}", camera.notes);
    }
    assert!(count("mirror = { builtin = \"teapot\", level = 10, count = 512 }") <= 512);
    assert_eq!(count("mirror = { builtin = \"box\", count = 200 }"), 192);
}

#[test]
fn shapes_are_smooth_where_nothing_else_is_asked_for_and_meshes_are_not() {
    let text =
        |keys: &str| format!("image = {{ width = 9, height = 7 }}\n[camera]\nkind = \"reflection\"\n{EYE}\n{keys}\n");
    let built = |keys: &str| load(&text(keys)).and_then(|s| s.camera());
    for (shape, name) in [
        ("sphere\", radius = 1", "1 quadric"),
        ("torus\", radius = 1, tube = 0.2", "a torus"),
        ("wave\", size = 4, amplitude = 0.1, wavelength = 1", "a wave"),
    ] {
        let mirror = format!("mirror = {{ shape = \"{shape} }}");
        let notes = built(&mirror).unwrap().notes;
        assert!(notes.contains(&format!("the surface is met exactly: {name}")), "{notes:?}");
        assert!(built(&format!("{mirror}\nfacets = \"normals\"")).unwrap().optics.unwrap().facets().is_some());
    }
    let error = |keys: &str| built(keys).unwrap_err().to_string();
    let mesh = error("mirror = { builtin = \"box\" }\nfacets = \"exact\"");
    assert!(mesh.contains("camera.facets") && mesh.contains("a mesh is flat triangles"), "{mesh}");
    let fine = error("mirror = { shape = \"wave\", size = 4, amplitude = 0.1, wavelength = 0.001 }");
    assert!(
        fine.contains("camera.mirror.wavelength") && fine.contains("4000 waves") && fine.contains("1024"),
        "{fine}"
    );
}

/// Thin tubes, tubes that nearly touch themselves or do, eyes within a ring, far away, and just over the water.
#[test]
fn surfaces_and_eyes_that_are_hard_on_rays() {
    let within = r#"{ kind = "fisheye", eye = [0.02, 0.1, 0.05], target = [0, 0.3, 5], fov = 170 }"#;
    let inside = r#"{ kind = "fisheye", eye = [0.9, 0.05, -0.02], target = [0, 0.3, 2], fov = 150 }"#;
    let distant = r#"{ kind = "pinhole", eye = [3000, 5500, 7000], target = [0, 0, 0], vfov = 0.03 }"#;
    let low = r#"{ kind = "pinhole", eye = [0.1, -0.5, 3.4], target = [0, -0.62, 0], vfov = 30 }"#;
    // a row of pixels looks 1e-9 above the middle of the wave, and one of them along a line that lies in it, at x = 0.9
    let (x, y) = (0.9 - 1.0 / 64.0, -0.9 + 1e-9 - 1.0 / 64.0);
    let skim = &format!(r#"{{ kind = "orthographic", eye = [{x}, {y}, 9], target = [{x}, {y}, 0], height = 2 }}"#);
    let front = r#"{ kind = "pinhole", eye = [0.3, 1.1, 6], target = [0, -0.1, 0], vfov = 42 }"#;
    let ring =
        |radius: f64, tube: f64| format!("shape = \"torus\", axis = [0.3, 1, 0.5], radius = {radius}, tube = {tube}");
    let wave = |amplitude: f64, length: f64| {
        format!("shape = \"wave\", center = [0, -0.9, 1], size = 5, amplitude = {amplitude}, wavelength = {length}")
    };
    let mirror = |shape: String| format!("kind = \"reflection\"\ndepth = 3\nmirror = {{ {shape} }}");
    let lens = |shape: String| format!("kind = \"refraction\"\nior = 1.4\ndepth = 3\nlens = {{ {shape} }}");
    for (eye, optics) in [
        (front, mirror(ring(1.2, 0.01))),
        (front, mirror(ring(0.6, 0.599))),
        (front, lens(ring(0.5, 0.8))),
        (within, mirror(ring(0.9, 0.35))),
        (inside, lens(ring(0.9, 0.35))),
        (distant, mirror(ring(0.9, 0.35))),
        (low, mirror(wave(0.3, 0.9))),
        (low, mirror(wave(0.02, 0.11))),
        (skim, mirror(wave(0.3, 0.9))),
        (distant, lens(wave(0.06, 1.7))),
    ] {
        let (scene, camera) = scene((96, 64), THINGS, &format!("eye = {eye}\n{optics}"));
        if check(&format!("{eye}, {optics}"), &scene, &camera).is_none() {
            return;
        }
    }
}

#[test]
fn any_central_eye_and_an_eye_inside_the_glass() {
    let glass = "lens = { shape = \"sphere\", radius = 1.3, count = 500 }\nior = 1.4";
    let inside = r#"eye = { kind = "fisheye", eye = [0.2, 0.1, 0.3], target = [0, 0, 5], fov = 200 }"#;
    let fisheye = r#"eye = { kind = "fisheye", eye = [0, 1, 4], target = [0, 0, 0], fov = 120 }"#;
    for (eye, depth) in [(fisheye, 2), (inside, 3)] {
        for facets in ["exact", "normals"] {
            let text = format!("kind = \"refraction\"\n{eye}\n{glass}\nfacets = \"{facets}\"\ndepth = {depth}");
            let (scene, camera) = scene((96, 64), THINGS, &text);
            if check(&format!("{eye}, {facets}"), &scene, &camera).is_none() {
                return;
            }
        }
    }
}

#[test]
fn adapters_without_64_bit_atomics_see_the_same() {
    for mirror in ["shape = \"sphere\"", "shape = \"torus\""] {
        let own = if mirror.contains("torus") { "radius = 0.9, tube = 0.3" } else { "radius = 1" };
        let text = format!("kind = \"reflection\"\n{EYE}\nmirror = {{ {mirror}, {own} }}\ndepth = 2");
        let (scene, camera) = scene((77, 59), THINGS, &text);
        let by = |without| render_with(&scene, &camera, without, &Default::default()).map(|r| r.frame);
        let (Some(all), Some(less)) = (by(Without::Nothing), by(Without::Int64Atomics)) else { return };
        assert!(all == less, "{mirror}: 32-bit atomics give other bytes");
    }
}

/// Kernels with f64 in words take a software adapter long to compile: one kind of them.
#[test]
#[ignore = "slow: make test-all"]
fn adapters_without_f64_see_the_same() {
    let text = format!("kind = \"reflection\"\n{EYE}\nmirror = {{ shape = \"sphere\", radius = 1 }}\ndepth = 2");
    let (scene, camera) = scene((77, 59), THINGS, &text);
    let Some(all) = render_with(&scene, &camera, Without::Nothing, &Default::default()) else { return };
    assert_same_without_f64("sphere", &scene, &camera, &all.frame);
}

/// A convex mirror lies behind the plane of each of its facets, so a reflected ray never meets it again. The interpolated normals lean by
/// up to 20 degrees, and many rays near the silhouette meet them from behind.
#[test]
fn no_ray_meets_a_convex_mirror_of_facets_twice() {
    for mesh in ["builtin = \"icosphere\", level = 1", "builtin = \"icosphere\", level = 2"] {
        let mirror = format!("kind = \"reflection\"\ndepth = 2\n{EYE}\nmirror = {{ {mesh} }}");
        let (scene, camera) = scene((120, 90), THINGS, &mirror);
        let frame = image(&scene, &camera, &[Channel::TriangleId, Channel::MirrorId]);
        let (ids, mirrors) = (frame.u32(Channel::TriangleId).unwrap(), frame.u32(Channel::MirrorId).unwrap());
        let own = scene.mesh.triangles.len() as u32;
        let met = mirrors.iter().filter(|m| **m != NO_ID).count();
        let inside = ids.iter().filter(|id| **id != NO_ID && **id >= own).count();
        assert!(met > 500, "{mesh}: {met} pixels see the mirror");
        assert_eq!(inside, 0, "{mesh}: rays of {inside} pixels end on the mirror");
    }
}
