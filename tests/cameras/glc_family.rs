//! The cameras made of general linear cameras, and the exact maps they are limits of: a known point lands at a known pixel.

use anamorph::internals::camera::glc::{Class, classify};
use anamorph::internals::camera::{Camera, Pieces, Ray, Rays};
use anamorph::internals::input::Loading;
use anamorph::internals::scene::Scene;
use glam::DVec3;

const SIZE: (u32, u32) = (80, 60);
/// Some tens of roundings of numbers up to 100.
const ROUNDING: f64 = 1e-11;

fn load(keys: &str) -> anamorph::internals::input::Result<Camera> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.toml");
    let (w, h) = SIZE;
    std::fs::write(&path, format!("image = {{ width = {w}, height = {h} }}\n[camera]\n{keys}\n")).unwrap();
    Scene::load(&path, &[], 0.0, &Loading::default())?.camera()
}

fn camera(keys: &str) -> Camera {
    load(keys).unwrap_or_else(|e| panic!("{keys}: {e}"))
}

fn refuses(keys: &str, says: &str) {
    let error = load(keys).expect_err(keys);
    assert_eq!(error.exit_code(), 2);
    let text = error.to_string();
    assert!(text.contains(says) && !text.contains('\n'), "{keys}: {says:?} not in {text}");
}

/// x = 2a - 1 and y = 1 - 2b of a pixel.
fn place((i, j): (u32, u32)) -> (f64, f64) {
    (2.0 * (i as f64 + 0.5) / SIZE.0 as f64 - 1.0, 1.0 - 2.0 * (j as f64 + 0.5) / SIZE.1 as f64)
}

const ASPECT: f64 = SIZE.0 as f64 / SIZE.1 as f64;
const PIXELS: [(u32, u32); 5] = [(0, 0), (79, 0), (13, 44), (40, 30), (79, 59)];

fn off(ray: &Ray, point: DVec3) -> f64 {
    let d = ray.direction.normalize();
    (point - ray.origin - (point - ray.origin).dot(d) * d).length()
}

/// The ray of each of some pixels goes through the point that the formula gives for its x and y.
fn meets(camera: &Camera, point: impl Fn(f64, f64) -> DVec3) {
    for q in PIXELS {
        let ray = camera.ray(q.0, q.1).unwrap();
        let (x, y) = place(q);
        let far = off(&ray, point(x, y));
        assert!(far < ROUNDING, "{} at {q:?}: {far}, {ray:?}", camera.kind);
    }
}

fn pieces(camera: &Camera) -> &Pieces {
    let [Rays::Pieces(pieces)] = &camera.layers[..] else { panic!("{} has no pieces", camera.kind) };
    pieces
}

/// The class of a piece and where its slits are.
fn class(camera: &Camera, piece: usize) -> (Class, Vec<f64>) {
    let bundle = &pieces(camera).pieces[piece].bundle;
    let rays = [(0.0, 0.0), (10.0, 0.0), (0.0, 10.0)].map(|(x, y)| bundle.ray(x, y));
    classify(&rays.map(|r| r.origin), &rays.map(|r| r.origin + r.direction))
}

fn assert_class(camera: &Camera, piece: usize, expected: Class, slits: &[f64]) {
    let (found, at) = class(camera, piece);
    assert_eq!((found, at.len()), (expected, slits.len()), "{}: {at:?}", camera.kind);
    assert!(at.iter().zip(slits).all(|(a, b)| (a - b).abs() < 1e-9), "{}: {at:?}, not {slits:?}", camera.kind);
}

/// Right and up of the picture's middle are to the right and up for a viewer at `eye` who looks at `target`, on the plane
/// through the target.
fn upright(camera: &Camera, eye: DVec3, target: DVec3) {
    let forward = (target - eye).normalize();
    let right = forward.cross(DVec3::Y).normalize();
    let at = |i, j| {
        let ray: Ray = camera.ray(i, j).unwrap();
        ray.origin + (target - ray.origin).dot(forward) / ray.direction.dot(forward) * ray.direction
    };
    assert!((at(42, 30) - at(38, 30)).dot(right) > 0.0, "{}: mirrored", camera.kind);
    assert!((at(40, 28) - at(40, 32)).dot(right.cross(forward)) > 0.0, "{}: upside down", camera.kind);
}

#[test]
fn slits_parallel_to_the_image_make_one_cross_slit_camera() {
    let view = "kind = \"cross_slit\"\neye = [0, 0, 10]\ntarget = [0, 0, 0]\nheight = 6\n";
    let upright_first =
        camera(&format!("{view}slits = [{{ distance = 10, angle = 90 }}, {{ distance = 4, angle = 0 }}]"));
    // the upright slit is the eye of x, the level one that of y
    meets(&upright_first, |x, y| DVec3::new(3.0 * ASPECT * x * (10.0 - 2.5) / 10.0, 3.0 * y * (4.0 - 2.5) / 4.0, 2.5));
    assert_class(&upright_first, 0, Class::CrossSlit, &[0.0, 0.6]);
    assert!(upright_first.ray(13, 44).unwrap().origin.x.abs() < ROUNDING);
    let behind = camera(&format!("{view}slits = [{{ distance = 10, angle = 90 }}, {{ distance = -20, angle = 0 }}]"));
    upright(&behind, 10.0 * DVec3::Z, DVec3::ZERO);
    assert_class(&behind, 0, Class::CrossSlit, &[0.0, 3.0]);
    // the same by lines and by the image's own vectors
    let lines = camera(
        "kind = \"cross_slit\"\ncenter = [0, 0, 0]\nright = [4, 0, 0]\nup = [0, 3, 0]\nslits = [{ point = [0, 7, 10], \
         direction = [0, 3, 0] }, { point = [5, 0, 4], direction = [-1, 0, 0] }]",
    );
    for (i, j) in PIXELS {
        let (a, b) = (upright_first.ray(i, j).unwrap(), lines.ray(i, j).unwrap());
        assert!((a.origin - b.origin).length() < ROUNDING && (a.direction - b.direction).length() < ROUNDING);
    }
}

#[test]
fn skew_slits_have_the_one_line_that_meets_both() {
    let camera = camera(
        "kind = \"cross_slit\"\neye = [0, 0, 10]\ntarget = [0, 0, 0]\nheight = 6\nslits = [{ point = [1, 0, 9], direction = \
         [0.2, 1, 0.5] }, { point = [0, 1, 4], direction = [1, 0.1, 0.3] }]",
    );
    assert_eq!(camera.piece_count(), 0);
    upright(&camera, 10.0 * DVec3::Z, DVec3::ZERO);
    meets(&camera, |x, y| DVec3::new(3.0 * ASPECT * x, 3.0 * y, 0.0));
    let lines =
        [(DVec3::new(1., 0., 9.), DVec3::new(0.2, 1., 0.5)), (DVec3::new(0., 1., 4.), DVec3::new(1., 0.1, 0.3))];
    for (i, j) in PIXELS {
        let ray = camera.ray(i, j).unwrap();
        for (point, direction) in lines {
            let across = ray.direction.cross(direction).normalize();
            assert!((point - ray.origin).dot(across).abs() < ROUNDING);
        }
        assert!(off(&Ray { origin: lines[0].0, direction: lines[0].1 }, ray.origin) < ROUNDING);
    }
}

#[test]
fn a_pushbroom_sees_each_column_from_its_own_place() {
    let common = "kind = \"pushbroom\"\nlook = [0, 0, -2]\nstart = [-8, 1, 5]\n";
    let k = 25f64.to_radians().tan();
    for path in ["end = [8, 1, 5]", "velocity = [4, 0, 0]\ntime = 4", "direction = [3, 0, 0]\nextent = 16"] {
        let camera = camera(&format!("{common}vfov = 50\n{path}"));
        meets(&camera, |x, y| DVec3::new(8.0 * x, 1.0 + 7.0 * k * y, 5.0 - 7.0));
        assert_class(&camera, 0, Class::Pushbroom, &[0.0]);
        upright(&camera, DVec3::new(0., 1., 5.), DVec3::new(0., 1., 0.));
    }
    // going left fills the picture from its right border on
    let left = camera(&format!("{common}vfov = 50\nend = [-24, 1, 5]"));
    upright(&left, DVec3::new(-16., 1., 5.), DVec3::new(-16., 1., 0.));
    assert!((left.ray(79, 30).unwrap().origin.x - (-8.0 - 0.1)).abs() < ROUNDING);
    let rows = camera(
        "kind = \"pushbroom\"\nlook = [0, -1, 0]\nup = [0, 0, -1]\nstart = [0, 9, 6]\nend = [0, 9, -6]\nhfov = 50",
    );
    meets(&rows, |x, y| DVec3::new(9.0 * k * x, 0.0, -6.0 * y));
    assert_class(&rows, 0, Class::Pushbroom, &[0.0]);
}

#[test]
fn pencil_and_twisted_keep_the_target_plane_and_shear_the_rest() {
    let view = "eye = [0, 0, 10]\ntarget = [0, 0, 0]\n";
    let k = 20f64.to_radians().tan();
    let pencil = camera(&format!("kind = \"pencil\"\n{view}vfov = 40\nslit = 4"));
    meets(&pencil, |x, y| DVec3::new(10.0 * k * ASPECT * x, 10.0 * k * y, 0.0));
    // half way from the eye (2y, 0, 10)
    meets(&pencil, |x, y| DVec3::new(5.0 * k * ASPECT * x + y, 5.0 * k * y, 5.0));
    let turned = camera(&format!("kind = \"pencil\"\n{view}vfov = 40\nslit = 4\nangle = 90"));
    meets(&turned, |x, y| DVec3::new(5.0 * k * ASPECT * x, 5.0 * k * y - ASPECT * x, 5.0));
    for camera in [&pencil, &turned] {
        assert_class(camera, 0, Class::Pencil, &[0.0]);
        upright(camera, 10.0 * DVec3::Z, DVec3::ZERO);
    }
    let twisted = camera(&format!("kind = \"twisted\"\n{view}height = 6\nangle = 45"));
    meets(&twisted, |x, y| DVec3::new(3.0 * ASPECT * x, 3.0 * y, 0.0));
    // the upper border looks 45 degrees to the right
    meets(&twisted, |x, y| DVec3::new(3.0 * ASPECT * x + 2.0 * y, 3.0 * y, -2.0));
    assert_class(&twisted, 0, Class::TwistedOrthographic, &[]);
    upright(&twisted, 10.0 * DVec3::Z, DVec3::ZERO);
}

#[test]
fn a_panorama_goes_round_and_all_rays_meet_its_axis() {
    let ring = "kind = \"panorama\"\ncenter = [1, 2, 3]\nradius = 5\nelevation = 1\nheight = 4\n";
    for sweep in [180.0f64, 270.0, 360.0] {
        let angle = |x: f64| (sweep / 2.0 * x).to_radians();
        let inward = camera(&format!("{ring}sweep = {sweep}"));
        meets(&inward, |x, _| DVec3::new(1.0 + 5.0 * angle(x).sin(), 3.0, 3.0 + 5.0 * angle(x).cos()));
        meets(&inward, |_, y| DVec3::new(1.0, 2.0 + 2.0 * y, 3.0));
        let outward = camera(&format!("{ring}sweep = {sweep}\nlook = \"outward\""));
        meets(&outward, |x, y| DVec3::new(1.0 - 10.0 * angle(x).sin(), 2.0 + 2.0 * y, 3.0 + 10.0 * angle(x).cos()));
        for q in PIXELS {
            assert!(
                outward
                    .ray(q.0, q.1)
                    .unwrap()
                    .direction
                    .dot(outward.ray(q.0, q.1).unwrap().origin - DVec3::new(1., 2., 3.))
                    > 0.0
            );
        }
    }
    // what turns to the right in the picture does so for the viewer: a point of the object's front, one of the surroundings
    let near = |keys: &str, point: DVec3| {
        let camera = camera(&format!("{ring}sweep = 180\n{keys}"));
        (0..SIZE.0).min_by(|&i, &j| {
            off(&camera.ray(i, 30).unwrap(), point).total_cmp(&off(&camera.ray(j, 30).unwrap(), point))
        })
    };
    assert!(near("", DVec3::new(1.5, 3.0, 4.5)).unwrap() > 40);
    assert!(near("look = \"outward\"", DVec3::new(-3.0, 3.0, 12.0)).unwrap() > 40);
}

#[test]
fn a_ring_of_pieces_is_of_cross_slit_cameras_that_share_the_axis_and_their_borders() {
    let keys = "kind = \"panorama\"\nradius = 5\nelevation = 1\nheight = 4\n";
    for (look, slits) in [("inward", [0.0, 1.0]), ("outward", [-1.0, 0.0])] {
        let ring = camera(&format!("{keys}look = {look:?}\npieces = 16"));
        assert_eq!(ring.piece_count(), 32);
        for piece in 0..32 {
            assert_class(&ring, piece, Class::CrossSlit, &slits);
        }
        // 5 px a piece: the rays at a border are the same from both sides, round the back too
        let at = |k: usize, x: f64, y: f64| {
            let found = pieces(&ring).bundle_at_place(k as u32, glam::DVec2::new(x, y)).ray(0.0, 0.0);
            (found.origin, found.direction)
        };
        for k in 0..16 {
            let next = (k + 1) % 16;
            for y in [0.0, 21.0, 60.0] {
                let (one, other) = (at(2 * k + 1, 5.0 * (k + 1) as f64, y), at(2 * next, 5.0 * next as f64, y));
                assert!((one.0 - other.0).length() < ROUNDING && (one.1 - other.1).length() < ROUNDING, "{k} {y}");
            }
        }
        let exact = camera(&format!("{keys}look = {look:?}"));
        // in a piece's middle the chord is inside the circle, by 1 - cos(360 / 32)
        let (a, b) = (ring.ray(2, 30).unwrap(), exact.ray(2, 30).unwrap());
        assert!((a.origin - b.origin).length() < 5.0 * (1.0 - 11.25f64.to_radians().cos()) + ROUNDING);
    }
}

#[test]
fn hinged_cameras_share_their_column_and_their_upright_slit() {
    let keys = "kind = \"hinge\"\neye = [0, 1, 10]\ntarget = [0, 1, 0]\nvfov = 40\ncolumn = 0.6\npath = 12\nangle = ";
    let k = 20f64.to_radians().tan();
    let (plain, hinged) = (camera(&format!("{keys}0")), camera(&format!("{keys}35")));
    let slit = 12.0 / (12.0 - 20.0 * k * ASPECT) * 10.0;
    for piece in 0..4 {
        assert_class(&hinged, piece, Class::CrossSlit, &[0f64.min(slit), 0f64.max(slit)]);
    }
    // left of the hinge nothing changes
    for (i, j) in [(0, 0), (20, 59), (47, 30)] {
        assert!((plain.ray(i, j).unwrap().direction - hinged.ray(i, j).unwrap().direction).length() < ROUNDING);
    }
    meets(&plain, |x, y| DVec3::new(10.0 * k * ASPECT * x, 1.0 + 10.0 * k * y, 0.0));
    // right of it the plane of the image turns about the hinge, towards the scene
    let (sin, cos) = 35f64.to_radians().sin_cos();
    let (x, y) = place((79, 59));
    let beyond = 10.0 * k * ASPECT * (x - 0.2);
    let point = DVec3::new(10.0 * k * ASPECT * 0.2 + beyond * cos, 1.0 + 10.0 * k * y, -beyond * sin);
    assert!(off(&hinged.ray(79, 59).unwrap(), point) < ROUNDING);
    upright(&hinged, DVec3::new(0., 1., 10.), DVec3::new(0., 1., 0.));
    // pieces that meet in the hinge have one ray there
    let rays = pieces(&hinged);
    for b in [0.0, 30.0, 60.0] {
        let at = |k: u32| {
            let bundle = rays.bundle_at_place(k, glam::DVec2::new(48.0, b));
            bundle.ray(0.0, 0.0)
        };
        for (one, other) in [(0, 2), (1, 3)] {
            assert!((at(one).origin - at(other).origin).length() < ROUNDING);
            assert!((at(one).direction - at(other).direction).length() < ROUNDING);
        }
    }
    let left = camera(&format!("{keys}35\nside = \"left\""));
    assert!((plain.ray(60, 3).unwrap().direction - left.ray(60, 3).unwrap().direction).length() < ROUNDING);
    assert!((plain.ray(9, 3).unwrap().origin - left.ray(9, 3).unwrap().origin).length() > 0.1);
}

#[test]
fn a_ball_of_cameras_looks_at_its_centre_from_all_sides() {
    let ball = camera("kind = \"surround\"\nradius = 3\ncenter = [0, 1, 0]\nlevel = 1");
    let list = &pieces(&ball).pieces;
    assert_eq!(list.len(), 80);
    let mut corners = Vec::new();
    for piece in list {
        let [a, b, c] =
            piece.corners_px.unwrap().map(|q| piece.bundle.ray(q.x - piece.centre_px.x, q.y - piece.centre_px.y));
        for ray in [a, b, c] {
            assert!((ray.origin.distance(DVec3::Y) - 3.0).abs() < ROUNDING && off(&ray, DVec3::Y) < ROUNDING);
            assert!((ray.direction.length() - 1.0).abs() < ROUNDING && ray.direction.dot(ray.origin - DVec3::Y) < 0.0);
            corners.push(ray.origin);
        }
        // seen from outside and unmirrored: the picture's y goes down, so its sense is turned round
        let outside = (b.origin - a.origin).cross(c.origin - a.origin).dot(a.origin - DVec3::Y);
        let q = piece.corners_px.unwrap();
        assert!(outside * (q[1] - q[0]).perp_dot(q[2] - q[0]) < 0.0);
        // the upright side goes up, for lack of triangles that stand on their tip: not always, but never down
        let side = if q[0].y < q[1].y { a.origin - b.origin } else { b.origin - a.origin };
        assert!(side.y > -ROUNDING, "{side}");
    }
    corners.sort_by(|a, b| a.to_array().partial_cmp(&b.to_array()).unwrap());
    corners.dedup_by(|a, b| a.distance(*b) < 1e-6);
    assert!(corners.len() >= 42);
    // every pixel has a camera: 40 cells fill 8 columns of 5 rows
    assert!((0..SIZE.1).all(|j| (0..SIZE.0).all(|i| ball.ray(i, j).is_some())));
}

#[test]
fn a_mesh_of_cameras_from_a_file_is_welded_and_its_holes_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cage.obj");
    // an octahedron, its first vertex written twice
    let text = "v 1 0 0\nv -1 0 0\nv 0 1 0\nv 0 -1 0\nv 0 0 1\nv 0 0 -1\nv 1 0 0\nf 1 3 5\nf 3 2 5\nf 2 4 5\nf 4 7 5\nf 3 7 6\n\
                f 2 3 6\nf 4 2 6\n";
    std::fs::write(&path, format!("{text}f 1 4 6\n")).unwrap();
    let keys = format!("kind = \"surround\"\nfile = {path:?}\nscale = 2");
    let whole = camera(&keys);
    assert!(whole.notes.is_empty() && whole.piece_count() == 8, "{:?}", whole.notes);
    let piece = &pieces(&whole).pieces[0];
    for q in piece.corners_px.unwrap() {
        let ray = piece.bundle.ray(q.x - piece.centre_px.x, q.y - piece.centre_px.y);
        assert!((ray.origin + 2.0 * ray.direction).length() < ROUNDING);
    }
    std::fs::write(&path, text).unwrap();
    assert!(camera(&keys).notes[0].contains("not closed: 3 of its edges"));
}

#[test]
fn mcop_columns_are_cameras_on_the_path() {
    let k = 20f64.to_radians().tan();
    let keys = "kind = \"mcop\"\nvfov = 40\n";
    let line = camera(&format!(
        "{keys}path = [{{ eye = [-4, 1, 6], target = [-4, 1, 0] }}, {{ eye = [4, 1, 6], target = [4, 1, 0] }}]"
    ));
    meets(&line, |x, y| DVec3::new(4.0 * x, 1.0 + 6.0 * k * y, 0.0));
    upright(&line, DVec3::new(0., 1., 6.), DVec3::new(0., 1., 0.));
    let corner = "path = [{ eye = [-4, 0, 6], target = [0, 0, 0] }, { eye = [0, 0, 8], target = [0, 0, 0] }, \
                  { eye = [4, 0, 6], target = [0, 0, 0] }]";
    let (linear, smooth) =
        (camera(&format!("{keys}{corner}")), camera(&format!("{keys}{corner}\ninterpolation = \"catmull-rom\"")));
    // a quarter of the way: the leg's middle, and Catmull and Rom's (-p0 + 9 p1 + 9 p2 - p3) / 16 with p0 = 2 p1 - p2
    for (camera, z) in [(&linear, 7.0), (&smooth, (-4.0 + 9.0 * 6.0 + 9.0 * 8.0 - 6.0) / 16.0)] {
        let (a, b) = (camera.ray(19, 30).unwrap().origin, camera.ray(20, 30).unwrap().origin);
        // the two columns beside a = 1/4 are equally far from it; the curve bends by under 1e-3 between them
        assert!(((a + b) / 2.0 - DVec3::new(-2.0, 0.0, z)).length() < 2e-3, "{}", (a + b) / 2.0);
    }
    let circle = camera(&format!("{keys}circle = {{ radius = 5, elevation = 2, center = [0, 1, 0], sweep = 90 }}"));
    meets(&circle, |x, _| {
        let (sin, cos) = (45.0 * x).to_radians().sin_cos();
        DVec3::new(5.0 * sin, 3.0, 5.0 * cos)
    });
    upright(&circle, DVec3::new(0., 3., 5.), DVec3::Y);
    let closed = camera(&format!("{keys}{corner}\nclosed = true"));
    assert!(closed.ray(79, 30).unwrap().origin.distance(DVec3::new(-4., 0., 6.)) < 0.2);
}

#[test]
fn bad_values_are_named() {
    let cross = "kind = \"cross_slit\"\neye = [0, 0, 10]\ntarget = [0, 0, 0]\nheight = 6\n";
    refuses(&format!("{cross}slits = [{{ distance = 9, angle = 0 }}]"), "two slits");
    refuses(&format!("{cross}slits = [{{ distance = 9, angle = 0 }}, {{ distance = 4, angle = 180 }}]"), "parallel");
    refuses(&format!("{cross}slits = [{{ distance = -9, angle = 0 }}, {{ distance = 4, angle = 90 }}]"), "slits.0");
    refuses(&format!("{cross}slits = [{{ distance = 9, angle = 0 }}, {{ distance = 0, angle = 90 }}]"), "slits.1");
    refuses(&format!("{cross}slits = [{{ distance = 9, angel = 0 }}, {{ distance = 4, angle = 90 }}]"), "angel");
    refuses(
        "kind = \"cross_slit\"\ncenter = [0, 0, 0]\nright = [1, 0, 0]\nup = [2, 0, 0]\nslits = []",
        "span no plane",
    );
    let push = "kind = \"pushbroom\"\nlook = [0, 0, -1]\nstart = [0, 0, 5]\n";
    refuses(&format!("{push}vfov = 40\nend = [0, 0, 5]"), "no length");
    refuses(&format!("{push}vfov = 40\nend = [0, 3, 5]"), "to a side");
    refuses(&format!("{push}vfov = 40"), "a path is end");
    refuses(&format!("{push}vfov = 40\nend = [1, 0, 5]\ntime = 3"), "time goes with velocity");
    refuses(&format!("{push}vfov = 40\nhfov = 40\nend = [1, 0, 5]"), "give one of them");
    refuses(&format!("{push}vfov = 180\nend = [1, 0, 5]"), "camera.vfov");
    refuses("kind = \"pencil\"\neye = [0, 0, 0]\ntarget = [0, 0, 0]\nvfov = 40\nslit = 1", "eye and target");
    refuses("kind = \"twisted\"\neye = [0, 0, 1]\ntarget = [0, 0, 0]\nheight = 4\nangle = 90", "camera.angle");
    let ring = "kind = \"panorama\"\nradius = 5\nheight = 2\n";
    refuses(&format!("{ring}sweep = 361"), "camera.sweep");
    refuses(&format!("{ring}look = \"up\""), "camera.look");
    refuses(&format!("{ring}front = [0, 2, 0]"), "camera.front");
    refuses("kind = \"panorama\"\nradius = 0\nheight = 2", "camera.radius");
    let hinge = "kind = \"hinge\"\neye = [0, 1, 10]\ntarget = [0, 1, 0]\nvfov = 40\npath = 12\n";
    refuses(&format!("{hinge}angle = -90"), "camera.angle");
    refuses(&format!("{hinge}angle = 9\ncolumn = 1"), "camera.column");
    refuses(&format!("{hinge}angle = 9\nside = \"top\""), "camera.side");
    refuses("kind = \"surround\"\nradius = 3\nlevel = 8", "camera.level");
    refuses("kind = \"surround\"\nfile = \"nowhere.obj\"", "camera.file");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("collapsed.obj");
    std::fs::write(&path, "v 0 0 0\nv 1 0 0\nf 1 1 2\nf 2 1 2\n").unwrap();
    refuses(&format!("kind = \"surround\"\nfile = {path:?}"), "the mesh has no triangle with three corners");
    refuses(
        "kind = \"surround\"\nradius = 3\nlevel = 1\ncolumns = 41",
        "camera.columns: expected a whole number from 1 to 40",
    );
    let mcop = "kind = \"mcop\"\nvfov = 40\n";
    refuses(&format!("{mcop}path = [{{ eye = [0, 0, 1], target = [0, 0, 0] }}]"), "two cameras");
    refuses(
        &format!("{mcop}path = [{{ eye = [0, 0, 1], target = [0, 0, 1] }}, {{ eye = [0, 0, 1], target = [0, 0, 0] }}]"),
        "camera.path.0",
    );
    refuses(&format!("{mcop}circle = {{ radius = 3, front = [0, 1, 0] }}"), "front is parallel");
    refuses(&format!("{mcop}circle = {{ radius = 3 }}\nclosed = true"), "camera.closed");
    refuses(&format!("{mcop}circle = {{ radius = 3 }}\ninterpolation = \"cubic\""), "camera.interpolation");
}
