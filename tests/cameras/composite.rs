//! `composite`: each pixel has its own camera's ray, whatever the shape of the regions; frames against the reference.

use super::project_named::{BOX, all_keys, plain_keys};
use crate::common;

use anamorph::internals::camera::kinds::KINDS;
use anamorph::internals::camera::{Camera, Curve, Rays};
use anamorph::internals::engine::plan::Wanted;
use anamorph::internals::engine::{Method, RunOptions};
use anamorph::internals::geometry::generate;
use anamorph::internals::geometry::place::merge;
use anamorph::internals::image::frame::Channel;
use anamorph::internals::image::{png_bytes, write_npy_f64};
use common::file::{camera_of, load};
use common::gpu::{Without, check, engine, hits, ids, wanted};
use common::rng::Rng;
use common::written::{assert_refused, camera, camera_in, try_camera};
use glam::{DVec2, DVec3};
use std::collections::BTreeSet;
use std::path::Path;

const SIZE: (u32, u32) = (64, 48);

const PINHOLE: &str = "{ kind = 'pinhole', eye = [0, 0, 4], target = [0, 0, 0], vfov = 40 }";
const FISHEYE: &str = "{ kind = 'fisheye', eye = [0.1, 0.2, 3], target = [0, 0, 0], fov = 120, frame = 'full' }";
const ABOVE: &str = "{ kind = 'orthographic', eye = [0, 4, 0], target = [0, 0, 0], up = [0, 0, -1], height = 3 }";
const TWO_SLITS: &str = "{ kind = 'cross_slit', slits = [{ distance = 4, angle = 20 }, { distance = 2.5, angle = 100 }], \
                         eye = [0, 0, 4], target = [0, 0, 0], height = 2 }";
const STRIPS: &str = "{ kind = 'cylinder', eye = [0, 0.1, 2], target = [0, 0.1, 0], vfov = 80, strips = 8 }";
const SCREEN: &str = "{ kind = 'mesh', vertices = [{ image = [0, 0], near = [-1, 1, 2], far = [-1.5, 1, -2] }, \
                      { image = [1, 0], near = [1, 1, 2], far = [2, 1, -2] }, { image = [0, 1], near = [-1, -1, 2], far = [-2, -1, -2] }], \
                      triangles = [[0, 1, 2]], t_range = [0, 2] }";
const TWISTED: &str =
    "{ kind = 'twist', eye = [0, 0, 4], target = [0, 0, 0], angle = 60, near = 1, far = 7, degree = 3 }";

/// The `[camera]` of members: the keys of each table.
fn composite(members: &[String]) -> String {
    let tables: Vec<String> = members.iter().map(|member| format!("{{ {member} }}")).collect();
    format!("kind = 'composite'\ncameras = [{}]", tables.join(", "))
}

fn member(of: &str, keys: &str) -> String {
    format!("camera = {of}{}{keys}", if keys.is_empty() { "" } else { ", " })
}

/// The camera of an inline table as a `[camera]`.
fn alone(of: &str, size: (u32, u32)) -> Camera {
    Camera::new(&load(&format!("camera = {of}")).unwrap().camera, Some(size)).unwrap()
}

fn pixels((w, h): (u32, u32)) -> impl Iterator<Item = (u32, u32)> {
    (0..h).flat_map(move |j| (0..w).map(move |i| (i, j)))
}

/// Image coordinates of a pixel's centre.
fn place((i, j): (u32, u32), (w, h): (u32, u32)) -> DVec2 {
    (DVec2::new(i.into(), j.into()) + 0.5) / DVec2::new(w.into(), h.into())
}

/// A star, which is not convex.
const STAR: &[[f64; 2]] =
    &[[0.5, 0.05], [0.6, 0.4], [0.95, 0.5], [0.6, 0.6], [0.5, 0.95], [0.4, 0.6], [0.05, 0.5], [0.4, 0.4]];

/// Inside of [`STAR`]: of one of the two kites that it is made of.
fn is_in_star(q: DVec2) -> bool {
    let v = (q - 0.5).abs();
    // the sides from (0, 0.45) to (0.1, 0.1) and from there to (0.45, 0)
    let upright = v.x / 0.1 * 0.35 <= 0.45 - v.y && v.x <= 0.1;
    let level = v.y / 0.1 * 0.35 <= 0.45 - v.x && v.y <= 0.1;
    upright || level
}

/// A mask whose texel (x, y) is white where `inside` says so, and nearly so elsewhere.
pub fn write_mask(folder: &std::path::Path, (w, h): (u32, u32), inside: impl Fn(u32, u32) -> bool) {
    let byte = |(x, y)| if inside(x, y) { 128 } else { 127 };
    let bytes: Vec<u8> = pixels((w, h)).flat_map(|q| [byte(q), byte(q), byte(q), 255]).collect();
    std::fs::write(folder.join("mask.png"), png_bytes(w, h, &bytes).unwrap()).unwrap();
}

/// Asserts that each pixel has the ray of the `alone` camera that `owner` names, bit for bit.
fn assert_owned(composite: &Camera, alone: &[Camera], owner: impl Fn(DVec2) -> Option<usize>, offset: (f64, f64)) {
    let moved = |camera: &Camera| camera.with_sample_offset(offset.0, offset.1);
    let (composite, alone) = (moved(composite), alone.iter().map(moved).collect::<Vec<_>>());
    let mut shown = vec![0; alone.len()];
    let size = DVec2::new(composite.width.into(), composite.height.into());
    for (i, j) in pixels((composite.width, composite.height)) {
        let own = owner(place((i, j), (composite.width, composite.height)) + DVec2::from(offset) / size);
        let expected = own.and_then(|k| alone[k].ray(i, j));
        assert_eq!(composite.ray(i, j), expected, "{i},{j} of camera {own:?}");
        own.iter().for_each(|k| shown[*k] += 1);
    }
    assert!(shown.iter().all(|n| *n > 20), "{shown:?}");
}

#[test]
fn each_pixel_has_the_ray_of_its_own_camera() {
    let folder = tempfile::tempdir().unwrap();
    let is_white = |x: u32, y: u32| (3 * x + 5 * y).is_multiple_of(4);
    write_mask(folder.path(), (7, 5), is_white);
    let star = format!("region = {{ kind = 'polygon', points = {STAR:?} }}");
    // the borders run through pixel centres, which belong to it
    let corners = [DVec2::new(10.5 / 64.0, 8.5 / 48.0), DVec2::new(0.6, 30.5 / 48.0)];
    let [from, to] = corners.map(|q| format!("[{:?}, {:?}]", q.x, q.y));
    let rectangle = format!("priority = 1, region = {{ kind = 'rectangle', from = {from}, to = {to} }}");
    let members = [
        member(PINHOLE, &star),
        member(FISHEYE, &rectangle),
        member(TWO_SLITS, "region = { kind = 'mask', file = 'mask.png' }"),
        member(STRIPS, "region = { kind = 'rectangle', from = [0, 0], to = [1, 0.8] }"),
    ];
    let camera = camera_in(folder.path(), &composite(&members), Some(SIZE)).unwrap();
    let alone = [PINHOLE, FISHEYE, TWO_SLITS, STRIPS].map(|of| self::alone(of, SIZE));
    let owner = |q: DVec2| {
        let texel = (q * DVec2::new(7.0, 5.0)).floor();
        let in_rectangle = q.cmpge(corners[0]).all() && q.cmple(corners[1]).all();
        let all =
            [(1, in_rectangle), (0, is_in_star(q)), (2, is_white(texel.x as u32, texel.y as u32)), (3, q.y <= 0.8)];
        all.into_iter().find(|(_, holds)| *holds).map(|(k, _)| k)
    };
    assert!(camera.ray(10, 8).is_some() && camera.t_range == common::FORWARD && camera.kind == "composite");
    // samples belong to the region of their own place
    for offset in [(0.0, 0.0), (0.375, -0.25), (-0.4375, 0.46875)] {
        assert_owned(&camera, &alone, owner, offset);
    }
}

#[test]
fn a_camera_framed_by_its_region_has_its_whole_image_there() {
    let folder = tempfile::tempdir().unwrap();
    // white texels from column 2 to 5 of 8 and from row 1 to 4 of 6
    write_mask(folder.path(), (8, 6), |x, y| (2..6).contains(&x) && (1..5).contains(&y) && (x, y) != (3, 3));
    let triangle = "{ kind = 'polygon', points = [[0.25, 0.25], [0.75, 0.25], [0.25, 0.75]] }";
    let rectangle = "{ kind = 'rectangle', from = [0.25, 0.25], to = [0.75, 0.75] }";
    for (region, low, high) in [
        (rectangle, DVec2::splat(0.25), DVec2::splat(0.75)),
        (triangle, DVec2::splat(0.25), DVec2::splat(0.75)),
        (
            "{ kind = 'mask', file = 'mask.png' }",
            DVec2::new(2., 1.) / DVec2::new(8., 6.),
            DVec2::new(6., 5.) / DVec2::new(8., 6.),
        ),
    ] {
        for of in [PINHOLE, FISHEYE, STRIPS, SCREEN] {
            let text = composite(&[member(of, &format!("frame = 'region', region = {region}"))]);
            let camera = camera_in(folder.path(), &text, Some(SIZE)).unwrap();
            let size = DVec2::new(64.0, 48.0);
            let own_size = ((high - low) * size).as_uvec2();
            let first = (low * size).as_uvec2();
            let own = alone(of, (own_size.x, own_size.y));
            let mut shown = 0;
            for (i, j) in pixels(SIZE) {
                let Some(ray) = camera.ray(i, j) else { continue };
                let expected = own.ray(i - first.x, j - first.y).unwrap();
                let off = (ray.origin - expected.origin).length().max((ray.direction - expected.direction).length());
                assert!(off < 1e-13, "{of} in {region} at {i},{j}: {ray:?}, not {expected:?}");
                shown += 1;
            }
            assert!(shown > 200, "{of} in {region}: {shown}");
        }
    }
}

#[test]
fn rays_of_a_table_are_its_own() {
    let folder = tempfile::tempdir().unwrap();
    let mut rng = Rng(5);
    let numbers: Vec<f64> = (0..SIZE.0 * SIZE.1 * 3).map(|_| rng.unit()).collect();
    for name in ["o.npy", "d.npy"] {
        write_npy_f64(&folder.path().join(name), &[SIZE.1.into(), SIZE.0.into(), 3], &numbers).unwrap();
    }
    let table = "{ kind = 'raymap', origins = 'o.npy', directions = 'd.npy' }";
    let left = "region = { kind = 'rectangle', from = [0, 0], to = [0.5, 1] }";
    let camera = camera_in(folder.path(), &composite(&[member(table, left), member(PINHOLE, "")]), Some(SIZE)).unwrap();
    for (i, j) in pixels(SIZE).filter(|(i, _)| *i < 32) {
        let at = 3 * (j * SIZE.0 + i) as usize;
        let row = DVec3::new(numbers[at], numbers[at + 1], numbers[at + 2]);
        assert_eq!(camera.ray(i, j).map(|ray| (ray.origin, ray.direction)), Some((row, row)), "{i},{j}");
    }
    let smaller = composite(&[member(table, &format!("frame = 'region', {left}"))]);
    let error = camera_in(folder.path(), &smaller, Some(SIZE)).unwrap_err().to_string();
    assert!(error.starts_with("camera.cameras.0.camera: it has 64 x 48 rays, but its own image is 32 x 48"), "{error}");
}

fn with_range(of: &str, range: &str) -> String {
    match of.strip_suffix(" }") {
        Some(keys) if !of.contains("t_range") => format!("{keys}, t_range = {range} }}"),
        _ => of.into(),
    }
}

#[test]
fn t_is_each_cameras_own_or_from_end_to_end() {
    let left = "region = { kind = 'rectangle', from = [0, 0], to = [0.5, 1] }";
    let both = |a: &str, b: &str| camera(&composite(&[member(a, left), member(b, "")]), SIZE);
    let (a, b) = (alone(PINHOLE, SIZE), alone(FISHEYE, SIZE));
    let same = both(&with_range(PINHOLE, "[1, 9]"), &with_range(FISHEYE, "[1, 9]"));
    assert!(same.t_range == [1.0, 9.0] && same.ray(3, 3) == a.ray(3, 3) && same.ray(60, 3) == b.ray(60, 3));
    let differ = both(&with_range(PINHOLE, "[1, 9]"), &with_range(FISHEYE, "[-2, 0.5]"));
    assert_eq!(differ.t_range, [0.0, 1.0]);
    let curved = both(&with_range(PINHOLE, "[1, 9]"), TWISTED);
    assert!(curved.t_range == [0.0, 1.0] && matches!(&curved.layers[..], [Rays::Curves(c)] if c.map.degree() == 3));
    let twisted = alone(TWISTED, SIZE);
    let at = |camera: &Camera, (i, j), t: f64| camera.ray(i, j).map(|ray| ray.origin + t * ray.direction).unwrap();
    let curve = |camera: &Camera, (i, j)| -> Curve { camera.curve(0, i, j).unwrap().1 };
    for pixel in pixels(SIZE) {
        for t in [0.0, 0.25, 1.0] {
            let is_left = pixel.0 < 32;
            let straight = if is_left { at(&a, pixel, 1.0 + 8.0 * t) } else { at(&b, pixel, -2.0 + 2.5 * t) };
            let bent = if is_left { straight } else { curve(&twisted, pixel).at(t) };
            assert!((at(&differ, pixel, t) - straight).length() < 1e-13, "{pixel:?}");
            assert!((curve(&curved, pixel).at(t) - bent).length() < 1e-13, "{pixel:?}");
        }
    }
}

#[test]
fn a_composite_in_a_composite_is_one_of_its_cameras() {
    let inner = format!(
        "{{ {} }}",
        composite(&[member(FISHEYE, "region = { kind = 'rectangle', from = [0, 0], to = [1, 0.5] }")])
            .replace('\n', ", ")
    );
    let text =
        composite(&[member(&inner, "frame = 'region', region = { kind = 'rectangle', from = [0.5, 0], to = [1, 1] }")]);
    let (camera, fisheye) = (camera(&text, SIZE), alone(FISHEYE, (32, 48)));
    for (i, j) in pixels(SIZE) {
        let expected = (i >= 32 && j < 24).then(|| fisheye.ray(i - 32, j).unwrap());
        assert_eq!(camera.ray(i, j), expected, "{i},{j}");
    }
}

#[test]
fn both_cameras_are_near_at_a_border() {
    // a border 1/32 px right of the centres of column 15, and one 1/8 px right of those of column 31
    let to = |x: f64| format!("region = {{ kind = 'rectangle', from = [0, 0], to = [{:?}, 1] }}", x / 64.0);
    let members = [member(PINHOLE, &to(15.53125)), member(ABOVE, &to(31.625)), member(FISHEYE, &to(47.53125))];
    let camera = camera(&composite(&members), SIZE);
    let alone = [PINHOLE, ABOVE, FISHEYE].map(|of| self::alone(of, SIZE));
    for j in [0, 20, 47] {
        let (near, outside) = camera.near(0, 15, j);
        assert!(near.len() == 8 && !outside);
        for (own, of) in near.chunks(4).zip(&alone) {
            let expected = of.ray(15, j).unwrap();
            for bundle in own {
                let ray = bundle.ray(0.0, 0.0);
                assert!(
                    (ray.origin - expected.origin).length() < 1e-12
                        && (ray.direction - expected.direction).length() < 1e-12
                );
                // no slope is that of a jump
                assert!(bundle.d[1].length() + bundle.p[1].length() < 0.2, "{bundle:?}");
            }
        }
        for i in [14, 16, 31, 32] {
            assert!(camera.near(0, i, j).0.len() == 4 && !camera.near(0, i, j).1, "{i},{j}");
        }
        assert!(camera.near(0, 47, j).1 && camera.near(0, 48, j).0.is_empty());
    }
}

/// A ball in a cloud of small triangles.
fn ball_in_cloud() -> anamorph::internals::scene::Scene {
    let cloud = common::soup(&mut Rng(1), 240, 0.3);
    let mut ball = generate::icosphere(3);
    ball.positions.iter_mut().for_each(|p| *p *= 0.7);
    common::scene(merge(vec![ball, cloud]).unwrap())
}

#[test]
fn frames_are_right_by_margin() {
    let size = (101, 77);
    let at = |column: u32, row: u32| {
        let place = |x: u32, y: u32| format!("[{}, {}]", f64::from(x) / 4.0, f64::from(y) / 2.0);
        format!("region = {{ kind = 'rectangle', from = {}, to = {} }}", place(column, row), place(column + 1, row + 1))
    };
    let star = format!("priority = 3, region = {{ kind = 'polygon', points = {STAR:?} }}");
    let orthographic = "{ kind = 'orthographic', eye = [1, 1, 4], target = [0, 0, 0], height = 2.5 }";
    let eight = [PINHOLE, FISHEYE, ABOVE, TWO_SLITS, STRIPS, SCREEN, orthographic];
    let range = |of: &str| with_range(of, "[0, 8]").replace("[0, 2]", "[0, 8]");
    let grid = |range: &dyn Fn(&str) -> String| -> Vec<String> {
        (0..).zip(eight).map(|(k, of)| member(&range(of), &format!("frame = 'region', {}", at(k % 4, k / 4)))).collect()
    };
    let straight = grid(&|of| of.replace(", t_range = [0, 2]", ""));
    let curved: Vec<String> = grid(&range).into_iter().chain([member(TWISTED, &star)]).collect();
    let pair = [member(PINHOLE, &star), member(ABOVE, "")];
    for (name, members) in [("straight", &straight[..]), ("curved", &curved), ("two", &pair)] {
        let camera = camera(&composite(members), size);
        assert_eq!(camera.is_curved(), name == "curved");
        let Some((frame, judged, _)) = check(name, &ball_in_cloud(), &camera) else { return };
        let unsafe_pixels = judged.safe.iter().filter(|is_safe| !**is_safe).count();
        println!("{name}: {} hits, {unsafe_pixels} unsafe", hits(&frame));
        assert!(hits(&frame) > 2000, "{name}: {} hits", hits(&frame));
    }
}

/// Of the files of [`every_member`].
pub(crate) const OWN_SIZE: (u32, u32) = (60, 44);

/// Cameras with a mirror or lens, and those of several layers of rays: composites refuse them.
const REFUSED: [&str; 4] = ["reflection", "refraction", "chain", "track"];

/// Cameras that have a size of their own: [`OWN_SIZE`].
const OF_OWN_SIZE: [&str; 4] = ["raymap", "lidar", "opencv", "calibrated"];

/// The keys of cameras of every kind that can be one of several, and each camera by itself.
fn every_member(folder: &Path) -> Vec<(String, Camera)> {
    let all = [plain_keys(folder), all_keys(folder)].concat().into_iter();
    // a camera in another one has no times of its own
    let all = all.filter(|keys| !keys.contains("line_time"));
    let all = all.map(|keys| (camera_of(BOX, OWN_SIZE, &keys).unwrap_or_else(|e| panic!("{keys}: {e}")), keys));
    let members: Vec<(String, Camera)> =
        all.filter(|(camera, _)| camera.layers.len() == 1).map(|(camera, keys)| (keys, camera)).collect();
    let missing = |name: &&str| !members.iter().any(|(_, camera)| camera.kind == *name);
    let missing: BTreeSet<&str> = KINDS.iter().map(|kind| kind.name).filter(missing).collect();
    assert_eq!(missing, BTreeSet::from(REFUSED));
    members
}

/// The members whose rays are straight from t = 0 on; and the others, with some of the former between them whose t ends.
pub(crate) fn straight_and_ended(folder: &Path) -> [Vec<(String, Camera)>; 2] {
    let all = every_member(folder).into_iter();
    let (straight, others): (Vec<_>, Vec<_>) = all.partition(|(_, c)| !c.is_curved() && c.t_range == common::FORWARD);
    let ended = straight.iter().step_by(7).map(|(keys, c)| (format!("{keys}\nt_range = [0, 9]"), c.clone()));
    let ended = others.into_iter().chain(ended).collect();
    [straight, ended]
}

/// The `[camera]` of members by the keys of each camera and those beside it.
pub(crate) fn composite_of<'a>(rest: &str, members: impl IntoIterator<Item = (&'a str, String)>) -> String {
    let table =
        |(camera, keys): (&str, String)| format!("[[camera.cameras]]\n{keys}\n[camera.cameras.camera]\n{camera}\n");
    format!("kind = 'composite'\n{rest}\n{}", members.into_iter().map(table).collect::<String>())
}

/// Asserts that composites of four members each are right, and that each member is seen; their number.
fn assert_right_by_fours(folder: &Path, name: &str, members: &[(String, Camera)]) -> usize {
    write_mask(folder, (7, 5), |x, y| (3 * x + 5 * y).is_multiple_of(4));
    let regions = [
        format!("priority = 1\nregion = {{ kind = 'polygon', points = {STAR:?} }}"),
        format!("region = {{ kind = 'mask', file = '{}/mask.png' }}", folder.display()),
        "region = { kind = 'rectangle', from = [0, 0], to = [0.47, 1] }".into(),
        "priority = -1".to_owned(),
    ];
    let (scene, count) = (ball_in_cloud(), members.len().div_ceil(4));
    for k in 0..count {
        // from all over the list; and each composite gives its cameras the regions in another order
        let four: Vec<&(String, Camera)> = members.iter().skip(k).step_by(count).collect();
        let own = (0..).zip(&four).map(|(n, (keys, camera))| {
            let region = &regions[(n + k) % 4];
            let is_framed = region.contains("rectangle") && !OF_OWN_SIZE.contains(&camera.kind);
            (keys.as_str(), format!("{region}\nframe = '{}'", if is_framed { "region" } else { "image" }))
        });
        let camera = camera_of(BOX, OWN_SIZE, &composite_of("", own)).unwrap_or_else(|e| panic!("{name} {k}: {e}"));
        let kinds: Vec<&str> = four.iter().map(|(_, camera)| camera.kind).collect();
        let Some((frame, judged, _)) = check(&format!("{name} {kinds:?}"), &scene, &camera) else { break };
        let pieces = frame.u32(Channel::PieceId).unwrap();
        let counts: Vec<usize> =
            (0..).take(four.len()).map(|k| pieces.iter().filter(|piece| **piece == k).count()).collect();
        let safe = judged.safe.iter().filter(|is_safe| **is_safe).count();
        println!("{name} {kinds:?}: {counts:?}, {safe} safe");
        assert!(counts.iter().all(|count| *count > 20) && safe > 1500, "{name} {kinds:?}: {counts:?}, {safe} safe");
    }
    count
}

#[test]
fn cameras_of_every_kind_with_straight_rays_share_frames() {
    let folder = tempfile::tempdir().unwrap();
    let [straight, _] = straight_and_ended(folder.path());
    assert!(assert_right_by_fours(folder.path(), "straight", &straight) >= 10);
}

#[test]
fn curved_and_straight_cameras_share_frames() {
    let folder = tempfile::tempdir().unwrap();
    let [_, ended] = straight_and_ended(folder.path());
    assert!(assert_right_by_fours(folder.path(), "with ends of t", &ended) >= 5);
}

/// Where two cameras of curves meet within tiles, each tile's curves are bounded on either side of the border.
#[test]
fn a_border_within_tiles_of_curves_costs_little() {
    let scene = ball_in_cloud();
    let other = TWISTED.replace("eye = [0, 0, 4]", "eye = [4, 0, 0]");
    let mut kept = Vec::new();
    // between two columns of tiles, and within one
    for border in [32.0, 36.0] {
        let to =
            format!("priority = 1, region = {{ kind = 'rectangle', from = [0, 0], to = [{:?}, 1] }}", border / 64.0);
        let camera = camera(&composite(&[member(TWISTED, &to), member(&other, "")]), SIZE);
        assert!(camera.is_curved());
        let Some(mut engine) = engine(&camera, Without::Nothing) else { return };
        let counting = Wanted { counting: true, ..wanted() };
        let by = |method: Method| RunOptions { method, ..RunOptions::default() };
        let raster = engine.render(&scene, &camera, &counting, &by(Method::Raster)).unwrap();
        let trace = engine.render(&scene, &camera, &wanted(), &by(Method::Trace)).unwrap();
        assert!(hits(&raster.frame) > 500 && ids(&raster.frame) == ids(&trace.frame), "{border}");
        kept.push(raster.counts.pairs_kept);
    }
    println!("pairs: {kept:?}");
    // all triangles with each tile of the column, in each span of t, otherwise
    assert!(kept[1] < 2 * kept[0], "{kept:?}");
}

#[test]
fn a_mirror_is_seen_by_one_ray_a_pixel() {
    let before = |eye: String| {
        let mirror = "mirror = { shape = 'sphere', center = [0, 0, 0], radius = 1 }";
        format!("kind = 'reflection'\n{mirror}\n[camera.eye]\n{eye}")
    };
    let (both, ended) = ([member(PINHOLE, ""), member(PINHOLE, "")], PINHOLE.replace(" }", ", t_range = [0, 9] }"));
    assert_refused(&before(format!("{}\nmaster = 0", composite(&both))), "several rays per pixel");
    assert_refused(&before(composite(&[member(&ended, "")])), "have a t_range");
}

#[test]
fn errors_say_which_camera_and_what_to_do() {
    let one = |of: &str| composite(&[member(PINHOLE, ""), member(of, "")]);
    let region = |region: &str| composite(&[member(PINHOLE, &format!("region = {region}"))]);
    let with = |keys: &str| composite(&[member(PINHOLE, keys)]);
    let mirror = format!(
        "{{ kind = 'reflection', eye = {PINHOLE}, mirror = {{ shape = 'sphere', center = [0, 0, 0], radius = 1 }} }}"
    );
    let layer = "{ vertices = [{ image = [0, 0], near = [-1, 1, 2], far = [-1, 1, 0] }, { image = [2, 0], near = [1, 1, 2], far = [2, 1, 0] }, \
                 { image = [0, 2], near = [-1, -1, 2], far = [-2, -1, 0] }], triangles = [[0, 1, 2]] }";
    let chain = format!("{{ kind = 'chain', layers = [{layer}, {layer}] }}");
    let many = vec![member(PINHOLE, ""); 257];
    for (text, expected) in [
        ("kind = 'composite'".to_owned(), "cameras is missing"),
        ("kind = 'composite'\ncameras = []".into(), "camera.cameras: 0 cameras; a composite has 1 to 256"),
        (composite(&many), "257 cameras"),
        ("kind = 'composite'\ncameras = [{}]".into(), "camera.cameras.0: camera is missing"),
        (format!("{}\nt_range = [0, 1]", with("")), "unknown key \"t_range\""),
        (with("regio = {}"), "unknown key \"regio\" in camera.cameras.0; nearest known key: \"region\""),
        (with("frame = 'picture'"), "camera.cameras.0.frame: use \"image\" or \"region\""),
        (with("priority = 1.5"), "camera.cameras.0.priority: expected a whole number"),
        (region("{ kind = 'circle' }"), "camera.cameras.0.region.kind: use \"rectangle\""),
        (
            region("{ kind = 'rectangle', from = [0.5, 0], to = [0.5, 1] }"),
            "camera.cameras.0.region: the rectangle has no area",
        ),
        (region("{ kind = 'rectangle', from = [0.5, 0] }"), "to is missing"),
        (region("{ kind = 'rectangle', from = [0, 0], to = [1e9, 1] }"), "too far outside of the image"),
        (region("{ kind = 'polygon', points = [[0, 0], [1, 1]] }"), "2 points; a polygon has 3 to 1024"),
        (region("{ kind = 'polygon', points = [[0, 0], [1, 0], [2, 0]] }"), "the polygon has no area"),
        (region("{ kind = 'mask', file = 'none.png' }"), "none.png: cannot be read"),
        (one("{ kind = 'pinhol' }"), "camera.cameras.1.camera.kind: unknown camera kind \"pinhol\""),
        (one(&PINHOLE.replace("40", "200")), "camera.cameras.1.camera.vfov = 200: must lie between"),
        (one(&PINHOLE.replace("[0, 0, 4]", "[0, 0, 0]")), "camera.cameras.1.camera: eye and target are the same point"),
        (
            one("{ kind = 'lidar', eye = [0, 0, 4], target = [0, 0, 0], beams = [0], columns = 8, period = 0.1 }"),
            "camera.cameras.1.camera.period: a camera in another one has no times of its own",
        ),
        (one(&mirror), "camera.cameras.1.camera.kind: reflection looks at a mirror or lens; use"),
        (one(&chain), "camera.cameras.1.camera.kind: chain has 2 layers of rays; use"),
        (
            one(TWISTED),
            "camera.cameras.0.camera.t_range: [0, inf] does not end, and camera 1 has curved rays; give it two ends",
        ),
        (
            one(SCREEN),
            "camera.cameras.0.camera.t_range: [0, inf] does not end, and the cameras differ in their t_range",
        ),
        (
            composite(&[member(&with_range(PINHOLE, "[2, 2]"), ""), member(TWISTED, "")]),
            "camera.cameras.0.camera.t_range: [2, 2] is one t",
        ),
        (
            with("frame = 'region', region = { kind = 'rectangle', from = [-900, -900], to = [900, 900] }"),
            "camera.cameras.0.camera: the image size 72000 x 54000 is over the limit",
        ),
        (region("{ kind = 'rectangle', from = [2, 2], to = [3, 3] }"), "no pixel has a ray"),
    ] {
        assert_refused(&text, expected);
    }
    let folder = tempfile::tempdir().unwrap();
    write_mask(folder.path(), (4, 4), |_, _| false);
    let black = region("{ kind = 'mask', file = 'mask.png' }");
    let error = camera_in(folder.path(), &black, Some(SIZE)).unwrap_err().to_string();
    assert!(
        error.contains("camera.cameras.0.region.file: ") && error.contains("mask.png: no texel is white"),
        "{error}"
    );
    std::fs::write(folder.path().join("mask.png"), b"no image").unwrap();
    let error = camera_in(folder.path(), &black, Some(SIZE)).unwrap_err().to_string();
    assert!(error.contains("is no PNG, JPEG or HDR"), "{error}");
    let notes = try_camera(&composite(&[member(FISHEYE, ""), member(PINHOLE, "")]), SIZE).unwrap().notes;
    assert!(matches!(&notes[..], [note] if note.starts_with("camera 1 shows nowhere")), "{notes:?}");
}
