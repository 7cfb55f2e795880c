//! Whole frames of the engine against the f64 reference, by margin. Nothing to do without an adapter.

use crate::common;
use anamorph::internals::input::Loading;

use anamorph::internals::camera::glc;
use anamorph::internals::camera::kinds::glc::Glc;
use anamorph::internals::camera::kinds::orthographic::Orthographic;
use anamorph::internals::camera::spec::CameraKind;
use anamorph::internals::engine::plan::Wanted;
use anamorph::internals::engine::{Method, RunOptions};
use anamorph::internals::geometry::generate;
use anamorph::internals::geometry::mesh::{Material, Mesh};
use anamorph::internals::geometry::texture::Images;
use anamorph::internals::geometry::{gltf, obj, place};
use anamorph::internals::image::compare::compare;
use anamorph::internals::image::frame::{Channel, Frame, NO_ID, Plane};
use anamorph::internals::scene::Scene;
use anamorph::internals::scene::light::Light;
use common::any::any;
use common::cameras::{MeshShape, glc_of_each_class, mesh_camera, mesh_spec, pinhole, raymap};
use common::gpu::{Without, assert_right, assert_same_without_f64, check, engine, hits, ids, render, render_with};
use common::rng::Rng;
use common::{ALL_T, FORWARD, camera, mesh, moved, scene};
use glam::{DMat3, DVec3};
use std::path::PathBuf;
use std::sync::Arc;

/// Not a multiple of the tile size.
const SIZE: (u32, u32) = (101, 77);

/// Unsafe pixels of an ordinary scene at most (`docs/reference/definitions.md`, Safe).
const UNSAFE_SHARE: f64 = 0.01;

/// A ball in a cloud of small triangles, 1,520 in all.
fn ball_in_cloud() -> Scene {
    let cloud = common::soup(&mut Rng(1), 240, 0.3);
    let mut ball = generate::icosphere(3);
    ball.positions.iter_mut().for_each(|p| *p *= 0.7);
    scene(place::merge(vec![ball, cloud]).unwrap())
}

#[test]
fn a_glc_of_each_class() {
    let scene = ball_in_cloud();
    for (name, kind) in glc_of_each_class() {
        let Some(&Glc { near, far }) = kind.recipe() else { unreachable!() };
        assert_eq!(glc::classify(&near, &far).0.name(), name);
        let Some((frame, ..)) = check(name, &scene, &camera(kind, SIZE, FORWARD)) else { return };
        // the ball alone covers a fifth of each of these pictures
        assert!(hits(&frame) > 1000, "{name}: {} hits", hits(&frame));
    }
}

/// A camera of two slits 10^-12 apart, and a triangle in a plane through both: the unperturbed ray meets that plane far before the triangle.
#[test]
fn a_triangle_that_two_slits_see_edge_on_hides_nothing_before_it() {
    let (scene, camera) = any(&mut Rng(668_277), (32, 32));
    check("edge-on", &scene, &camera);
}

#[test]
fn pinhole_and_orthographic() {
    let scene = scene(generate::teapot(8));
    let target = DVec3::new(0.2, 1.2, 0.0);
    let eye = DVec3::new(4.0, 6.0, 9.0);
    let orthographic = CameraKind::new("orthographic", Orthographic { eye, target, up: DVec3::Y, height: 5.0 });
    for (name, kind) in [("pinhole", pinhole(eye, target, 35.0)), ("orthographic", orthographic)] {
        let Some((frame, _, seen)) = check(name, &scene, &camera(kind, SIZE, FORWARD)) else { return };
        assert!(hits(&frame) > 1000 && seen.wrong_hit_miss.unwrap() <= seen.unsafe_pixels.unwrap());
    }
}

#[test]
fn a_camera_in_the_middle_of_a_city() {
    let city = generate::city(3, Some(6), 12_000).unwrap();
    let scene = scene(city);
    let (lo, hi) = scene.bounds().unwrap();
    let eye = DVec3::new((lo.x + hi.x) / 2.0, lo.y + 0.8 * (hi.y - lo.y), lo.z - 0.1 * (hi.z - lo.z));
    let kind = pinhole(eye, (lo + hi) / 2.0, 60.0);
    let Some((_, _, seen)) = check("city", &scene, &camera(kind, SIZE, FORWARD)) else { return };
    println!("{:?} of the pixels are unsafe", seen.unsafe_share);
}

#[test]
fn an_ordinary_scene_has_few_unsafe_pixels() {
    // triangles of some hundred pixels: their edges' margins of 1/16 px hold a few per mille of the picture
    let scene = scene(generate::icosphere(1));
    let kind = pinhole(DVec3::new(0.3, 0.4, 4.0), DVec3::ZERO, 30.0);
    let Some((_, _, seen)) = check("icosphere", &scene, &camera(kind, (301, 227), FORWARD)) else { return };
    assert!(seen.unsafe_share.unwrap() <= UNSAFE_SHARE, "{seen}");
}

#[test]
fn mesh_cameras_of_512_and_1000_pieces() {
    let scene = ball_in_cloud();
    for (columns, rows) in [(1, 1), (16, 16), (25, 20)] {
        let kind = mesh_camera(5, columns, rows, MeshShape::default());
        let camera = camera(kind, SIZE, FORWARD);
        assert_eq!(camera.piece_count() as u32, 2 * columns * rows);
        let Some((frame, ..)) = check(&format!("{columns} x {rows} cells"), &scene, &camera) else { return };
        assert!(hits(&frame) > 1000);
    }
}

#[test]
fn pieces_with_weights_unit_directions_and_tears() {
    let scene = ball_in_cloud();
    let shapes = [
        MeshShape { weights: true, ..Default::default() },
        MeshShape { normalize: true, ..Default::default() },
        MeshShape { discontinuous: true, ..Default::default() },
        MeshShape { normalize: true, weights: true, discontinuous: true },
    ];
    for shape in shapes {
        let camera = camera(mesh_camera(6, 9, 7, shape), SIZE, FORWARD);
        if check(&format!("{shape:?}"), &scene, &camera).is_none() {
            return;
        }
    }
}

#[test]
fn pieces_that_leave_part_of_the_image_free() {
    let mut spec = mesh_spec(7, 6, 5, MeshShape::default());
    spec.triangles.retain(|t| (t[0] + t[2]) % 3 != 0);
    // beyond the image on two sides, and turned the other way round
    spec.vertices.iter_mut().for_each(|v| v.image = [1.3 * v.image[0] - 0.4, 0.9 * v.image[1] + 0.2]);
    spec.triangles.iter_mut().step_by(2).for_each(|t| t.swap(1, 2));
    let camera = camera(CameraKind::new("mesh", spec), SIZE, FORWARD);
    let Some((frame, ..)) = check("holes", &ball_in_cloud(), &camera) else { return };
    let free = (0..SIZE.1).flat_map(|j| (0..SIZE.0).map(move |i| (i, j))).filter(|&(i, j)| camera.ray(i, j).is_none());
    let background: Vec<usize> = free.map(|(i, j)| (j * SIZE.0 + i) as usize).collect();
    assert!(background.len() > 500);
    assert!(background.iter().all(|&k| ids(&frame)[k] == NO_ID && frame.f32(Channel::R).unwrap()[k] == 0.1));
}

#[test]
fn a_ray_map_with_blind_pixels() {
    let scene = ball_in_cloud();
    for t_range in [FORWARD, ALL_T] {
        let camera = raymap(SIZE.0, SIZE.1, t_range);
        let Some((frame, ..)) = check(&format!("ray map {t_range:?}"), &scene, &camera) else { return };
        let blind = |k: usize| camera.ray(k as u32 % SIZE.0, k as u32 / SIZE.0).is_none();
        assert!((0..ids(&frame).len()).filter(|&k| blind(k)).all(|k| ids(&frame)[k] == NO_ID));
        assert!(hits(&frame) > 1000);
    }
}

#[test]
fn one_sided_meshes_show_their_fronts_alone() {
    let mut one_sided = ball_in_cloud();
    Arc::make_mut(&mut one_sided.mesh).materials.iter_mut().for_each(|m| m.two_sided = false);
    for (name, kind) in glc_of_each_class() {
        let camera = camera(kind, SIZE, ALL_T);
        let Some((frame, ..)) = check(&format!("one-sided {name}"), &one_sided, &camera) else { return };
        assert!(hits(&frame) > 1000);
    }
}

#[test]
fn negative_t_comes_first_and_ends_belong_to_the_range() {
    let scene = ball_in_cloud();
    for t_range in [ALL_T, [f64::NEG_INFINITY, 0.4], [0.45, 0.55], [-3.0, -1.0], [0.5, 0.5]] {
        for (name, kind) in glc_of_each_class().into_iter().step_by(3) {
            if check(&format!("{name} {t_range:?}"), &scene, &camera(kind, SIZE, t_range)).is_none() {
                return;
            }
        }
    }
    // a wall at t = 3 exactly: seen where the range ends there, to within 2^-42 of the scene's size
    let far = |x: f64, y: f64| DVec3::new(x, y, -3.0);
    let wall = common::scene(mesh(vec![far(-9.0, -9.0), far(9.0, -9.0), far(0.0, 9.0)], vec![[0, 1, 2]]));
    let kind = || pinhole(DVec3::ZERO, DVec3::NEG_Z, 20.0);
    for (t_range, seen) in [
        ([0.0, 3.0], true),
        ([3.0, 3.0], true),
        ([3.0, f64::INFINITY], true),
        ([0.0, 3.0_f64.next_down()], true),
        ([3.0_f64.next_up(), f64::INFINITY], true),
        ([0.0, 3.0 - 1e-9], false),
        ([3.0 + 1e-9, f64::INFINITY], false),
    ] {
        let camera = camera(kind(), (16, 16), t_range);
        let Some(rendered) = render_with(&wall, &camera, Without::Nothing, &Default::default()) else { return };
        assert_eq!(hits(&rendered.frame), if seen { 256 } else { 0 }, "{t_range:?}");
    }
}

/// A triangle that the rays run along, and whose plane they start on, is hit at their start, behind a wall as well as in the open; unless the hit
/// would be moved by more than 2^-32 of the scene's size, which is 2 here.
#[test]
fn hits_are_moved_to_the_start_from_behind_a_wall() {
    let far = 2.0_f64.powi(31);
    let at = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
    let wall = [at(-1.0, -1.0, 0.2), at(1.0, -1.0, 0.2), at(0.0, 2.0, 0.2)];
    let scene_met_at = |t: f64| {
        // its plane is 0.9 of 2^-9 from the start, and 2^-42 of the scene's size is 2^-9
        let along = |y: f64, z: f64| at(0.9 * 0.5_f64.powi(9) * (z / t - 1.0), y, z);
        let ends = [-far, far].into_iter().flat_map(|x| [at(x, 0.0, 9.0), at(x, 1.0, 9.0), at(x, 0.0, 8.0)]);
        let mut positions: Vec<DVec3> = wall.into_iter().chain(ends).collect();
        positions.extend([along(-1.0, 0.3), along(1.0, 0.3), along(0.0, 40.0)]);
        positions.extend((0..600).map(|k| at(f64::from(k % 3) - 1.0, f64::from(k % 2), 50.0 + f64::from(k))));
        scene(mesh(positions, (0..204).map(|k| [0, 1, 2].map(|v| v + 3 * k)).collect()))
    };
    let view = Orthographic { eye: DVec3::ZERO, target: DVec3::Z, up: DVec3::Y, height: 1e-5 };
    let ways = [Without::Nothing, Without::F64Depths, Without::F64];
    for (method, without) in
        [Method::Raster, Method::Trace].into_iter().flat_map(|method| ways.map(|without| (method, without)))
    {
        for (t_met, t_range, (id, t)) in
            [(1.8, FORWARD, (3, 0.0)), (1.8, [-3.0, 3.0], (0, 0.2)), (2.2, FORWARD, (0, 0.2))]
        {
            let (scene, camera) =
                (scene_met_at(t_met), camera(CameraKind::new("orthographic", view.clone()), (16, 16), t_range));
            let run = RunOptions { method, ..Default::default() };
            let Some(rendered) = render_with(&scene, &camera, without, &run) else { return };
            let frame = rendered.frame;
            let name = format!("{method:?} {without:?}, met at {t_met} in {t_range:?}");
            assert_right(&name, &scene, &camera, &frame);
            assert!(ids(&frame).iter().all(|&seen| seen == id), "{name}: {:?}", ids(&frame));
            assert!(frame.f32(Channel::T).unwrap().iter().all(|&seen| seen == t), "{name}");
        }
        // every sample too
        let wanted = Wanted { samples: 4, ..Wanted::of(vec![Channel::A, Channel::T]) };
        let camera = camera(CameraKind::new("orthographic", view.clone()), (16, 16), FORWARD);
        let (scene, run) = (scene_met_at(1.8), RunOptions { method, ..Default::default() });
        let frame = engine(&camera, without).unwrap().render(&scene, &camera, &wanted, &run).unwrap().frame;
        assert!(frame.f32(Channel::A).unwrap().iter().all(|&share| share == 1.0), "{method:?} {without:?}: samples");
    }
}

#[test]
fn no_pixel_is_wrong_however_near_an_edge() {
    // 20,480 triangles of about a pixel, turned so that no edge passes a centre exactly: a sign that f32 alone decided
    // wrongly would show
    let mut ball = generate::icosphere(5);
    let turn = DMat3::from_euler(glam::EulerRot::XYZ, 0.31, 0.47, 0.93);
    ball.positions.iter_mut().for_each(|p| *p = turn * *p);
    for offset in [0.0, 1e6] {
        let by = offset * DVec3::new(1.0, -0.7, 0.3);
        let scene = scene(moved(ball.clone(), by));
        for (name, kind) in glc_of_each_class() {
            let Some(&Glc { near, far }) = kind.recipe() else { unreachable!() };
            let kind = CameraKind::new("glc", Glc { near: near.map(|p| by + p), far: far.map(|p| by + p) });
            let camera = camera(kind, (200, 150), FORWARD);
            let Some(rendered) = render_with(&scene, &camera, Without::Nothing, &Default::default()) else { return };
            let (_, seen) = assert_right(&format!("{name} at {offset}"), &scene, &camera, &rendered.frame);
            assert!(seen.wrong_triangle == Some(0), "{name} at {offset}: {seen}");
            assert!(rendered.counts.rechecked > 0, "{name} at {offset}: nothing was near an edge");
        }
    }
}

/// The frame with the colour of `truth` wherever their ids differ: what is left to compare is the shading.
fn with_colour_of_other_ids(frame: &Frame, truth: &Frame) -> Frame {
    let mut frame = frame.clone();
    let other: Vec<usize> = (0..ids(truth).len()).filter(|&k| ids(truth)[k] != ids(&frame)[k]).collect();
    for (channel, plane) in &mut frame.planes {
        if let (Plane::F32(values), Some(right)) = (plane, truth.f32(*channel)) {
            other.iter().for_each(|&k| values[k] = right[k]);
        }
    }
    frame
}

/// 60 dB is an error of 1/1000 of full scale, root mean square: a quarter of an 8-bit step.
const SHADING_DB: f64 = 60.0;

#[test]
fn smooth_normals_and_lights_shade_as_the_reference_does() {
    let mut lit = scene(generate::teapot(10));
    Arc::make_mut(&mut lit.mesh).materials.push(Material { diffuse: [0.9, 0.4, 0.1], ..Material::default() });
    Arc::make_mut(&mut lit.mesh).material_of.iter_mut().step_by(3).for_each(|m| *m = 1);
    assert!(!lit.mesh.normals.is_empty());
    let kind = || pinhole(DVec3::new(4.0, 6.0, 9.0), DVec3::new(0.2, 1.2, 0.0), 35.0);
    for lights in [vec![], [DVec3::new(-1.0, -2.0, -1.0), DVec3::new(1.0, -0.5, 0.2)].map(Light::distant).to_vec()] {
        lit.lights = lights;
        let camera = camera(kind(), SIZE, FORWARD);
        let Some(frame) = render(&lit, &camera) else { return };
        let (judged, _) = assert_right("lit teapot", &lit, &camera, &frame);
        let frame = with_colour_of_other_ids(&frame, &judged.truth);
        let seen = compare(&frame, &judged.truth, None, None).unwrap();
        assert!(seen.psnr.unwrap() >= SHADING_DB, "{seen}");
        // barycentrics are rounded to f32 once, but for triangles seen edge-on
        assert!(seen.bary_max.unwrap().0 <= 1e-4, "{seen}");
    }
}

#[test]
fn without_f64_the_frame_is_the_same() {
    let scene = ball_in_cloud();
    let mut cameras: Vec<_> =
        glc_of_each_class().into_iter().map(|(name, kind)| (name, camera(kind, SIZE, FORWARD))).collect();
    cameras.push(("mesh", camera(mesh_camera(1, 9, 7, MeshShape::default()), SIZE, FORWARD)));
    cameras.push(("ray map", raymap(SIZE.0, SIZE.1, FORWARD)));
    for (name, camera) in cameras {
        let Some(frame) = render(&scene, &camera) else { return };
        assert_same_without_f64(name, &scene, &camera, &frame);
    }
}

#[test]
fn far_from_the_origin() {
    for offset in [1e3, 1e6] {
        let by = DVec3::new(offset, -0.7 * offset, 0.3 * offset);
        let mut scene = ball_in_cloud();
        scene.mesh = moved(Mesh::clone(&scene.mesh), by).into();
        let kind = pinhole(by + DVec3::new(0.5, 0.8, 3.0), by, 50.0);
        let Some((frame, ..)) = check(&format!("offset {offset}"), &scene, &camera(kind, SIZE, FORWARD)) else {
            return;
        };
        assert!(hits(&frame) > 1000);
    }
}

#[test]
fn a_ball_seen_from_10_000_times_its_size_is_shaded_right() {
    // colour is worked out in f32 about the anchor, which lies on the ball: P is off by 2^-24 of the distance, and the
    // weights of a normal by that over a triangle's size
    let scene = scene(generate::icosphere(3));
    let eye = 1e4 * DVec3::new(0.6, 0.0, 0.8);
    let camera = camera(pinhole(eye, DVec3::ZERO, (3.0_f64 / 1e4).to_degrees()), SIZE, FORWARD);
    let Some((frame, judged, _)) = check("far ball", &scene, &camera) else { return };
    let seen = compare(&with_colour_of_other_ids(&frame, &judged.truth), &judged.truth, None, None).unwrap();
    assert!(seen.psnr.unwrap() >= SHADING_DB, "{seen}");
}

/// Third-party models beside the checkout, where somebody put them.
fn models() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../shared/models")
}

fn load(name: &str) -> Option<Mesh> {
    let path = models().join(name);
    if !path.exists() {
        common::needs::skip(&format!("no model {name}"));
        return None;
    }
    Some(
        if name.ends_with(".obj") {
            obj::load(&path, &mut Images::default(), &Loading::default())
        } else {
            gltf::load(&path, gltf::Files::Below, &Images::default(), None, &Loading::default())
        }
        .unwrap(),
    )
}

#[test]
fn models_of_other_people() {
    let names =
        ["cow.obj", "suzanne.obj", "teapot.obj", "denhaag/denhaag.obj", "gltf/Duck.glb", "gltf/CesiumMilkTruck.glb"];
    for name in names {
        let Some(mesh) = load(name) else { continue };
        let scene = scene(mesh);
        let (lo, hi) = scene.bounds().unwrap();
        let (middle, reach) = ((lo + hi) / 2.0, (hi - lo).length() / 2.0);
        // cameras of the unit ball, put about the model
        let eye = middle + reach * DVec3::new(1.0, 1.1, 1.9);
        let mut kinds = vec![("pinhole", pinhole(eye, middle, 40.0))];
        let (glc_name, kind) = glc_of_each_class().swap_remove(3);
        let Some(&Glc { near, far }) = kind.recipe() else { unreachable!() };
        let placed = |v: [DVec3; 3]| v.map(|p| middle + reach * p);
        kinds.push((glc_name, CameraKind::new("glc", Glc { near: placed(near), far: placed(far) })));
        for (kind_name, kind) in kinds {
            let Some((frame, ..)) = check(&format!("{name} {kind_name}"), &scene, &camera(kind, SIZE, FORWARD)) else {
                return;
            };
            assert!(hits(&frame) > 500, "{name}: {} hits", hits(&frame));
        }
    }
}
