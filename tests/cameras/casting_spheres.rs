//! Rays cast at spheres and triangles: closed forms, whole numbers, and the reference's image of each camera pixel for pixel.

use crate::common;
use anamorph::internals::input::Limits;

use anamorph::internals::camera::Camera;
use anamorph::internals::camera::perturb::scene_size;
use anamorph::internals::geometry::cast::{Caster, ExactCaster, Ray};
use anamorph::internals::geometry::generate::plane;
use anamorph::internals::geometry::mesh::Mesh;
use anamorph::internals::geometry::place::merge;
use anamorph::internals::geometry::spheres::spheres_of;
use anamorph::internals::image::frame::{Channel, NO_ID};
use anamorph::internals::reference::image::image;
use common::cameras::{MeshShape, glc_of_each_class, mesh_camera, raymap};
use common::file::camera_of;
use common::rng::Rng;
use common::{ALL_T, FORWARD, camera, scene, soup};
use glam::DVec3;
use std::sync::Arc;

const SIZE: (u32, u32) = (64, 48);

fn balls(list: &[(DVec3, f64)]) -> Mesh {
    let (centres, radii) = list.iter().copied().unzip();
    spheres_of(centres, radii, None, Limits::default()).unwrap()
}

/// Triangles between spheres of many sizes: some inside others, some with a common centre, some equal.
fn mixed(seed: u64) -> Mesh {
    let mut rng = Rng(seed);
    let mut list: Vec<(DVec3, f64)> = Vec::new();
    for k in 0..150 {
        let centre = if k % 5 == 4 { list[rng.below(list.len())].0 } else { rng.vector() };
        let radius = if k % 11 == 10 { list[k - 6].1 } else { 10f64.powf(-0.5 - 2.5 * rng.unit()) };
        list.push((centre, radius));
    }
    list.push(list[3]);
    let mut spheres = balls(&list);
    spheres.materials[0].two_sided = !seed.is_multiple_of(3);
    let mut all = vec![soup(&mut rng, 60, 0.5), spheres];
    if seed.is_multiple_of(2) {
        all.swap(0, 1);
    }
    merge(all).unwrap()
}

fn cameras() -> Vec<(String, Camera)> {
    let mut all: Vec<(String, Camera)> =
        glc_of_each_class().into_iter().map(|(name, kind)| (name.to_owned(), camera(kind, SIZE, FORWARD))).collect();
    let shapes = [
        MeshShape::default(),
        MeshShape { normalize: true, weights: true, discontinuous: false },
        MeshShape { discontinuous: true, ..MeshShape::default() },
    ];
    for (k, shape) in shapes.into_iter().enumerate() {
        all.push((format!("mesh {shape:?}"), camera(mesh_camera(k as u64, 4, 3, shape), SIZE, ALL_T)));
    }
    all.push(("raymap".into(), raymap(SIZE.0, SIZE.1, FORWARD)));
    for kind in ["fisheye\"\nfov = 170", "cylinder\"\nvfov = 70", "sphere\"", "panini\"\nfov = 120"] {
        let text = format!("kind = \"{kind}\neye = [0.5, 1.2, 2.5]\ntarget = [0, 0, 0]");
        all.push((kind.to_owned(), camera_of("", SIZE, &text).unwrap()));
    }
    all
}

#[test]
fn both_casters_see_what_the_reference_does_at_every_pixel() {
    let cameras = cameras();
    assert!(cameras.len() >= 12, "{}", cameras.len());
    let mut seen = [0; 2];
    for (k, (name, camera)) in cameras.iter().enumerate() {
        for seed in [k as u64, 100 + k as u64] {
            let scene = scene(mixed(seed));
            let truth = image(&scene, camera, &[Channel::TriangleId, Channel::T]);
            let (ids, depths) = (truth.u32(Channel::TriangleId).unwrap(), truth.f32(Channel::T).unwrap());
            let (exact, aimed) = (ExactCaster::new(scene.mesh.mesh().clone()), Caster::new(&scene.mesh));
            let size = scene_size(scene.mesh.bounds());
            for place in 0..ids.len() {
                let (i, j) = (place as u32 % SIZE.0, place as u32 / SIZE.0);
                let Some((_, bundle)) = camera.pixel(0, i, j) else {
                    assert_eq!(ids[place], NO_ID, "{name}, {seed}: pixel {i},{j}");
                    continue;
                };
                let ray = bundle.ray(0.0, 0.0);
                let hits = [exact.first(&ray, camera.t_range), aimed.first(&bundle.aim(size).unwrap(), camera.t_range)];
                for hit in hits {
                    let id = hit.map_or(NO_ID, |hit| hit.triangle);
                    assert_eq!(id, ids[place], "{name}, {seed}: pixel {i},{j}");
                    // f32's own rounding, and t is relative
                    let is_close = |hit: &anamorph::internals::geometry::cast::Hit| {
                        (hit.t - f64::from(depths[place])).abs() <= 2f64.powi(-23) * hit.t.abs()
                    };
                    assert!(hit.as_ref().is_none_or(is_close), "{name}, {seed}: pixel {i},{j}: {hit:?}");
                    let is_sphere = scene.mesh.radius(id).is_some();
                    assert!(!is_sphere || hit.is_some_and(|hit| hit.bary == [0.0; 2]));
                    seen[usize::from(is_sphere)] += usize::from(id != NO_ID);
                }
                let first = exact.all(&ray, camera.t_range).first().copied();
                assert_eq!(first, hits[0], "{name}, {seed}: pixel {i},{j}");
            }
        }
    }
    assert!(seen.iter().all(|n| *n > 10_000), "{seen:?}");
}

/// A ray through nested balls, one that touches them, and a wall that cuts them: in order, and by id where they are level.
#[test]
fn all_hits_come_in_order() {
    let list = [(DVec3::ZERO, 5.0), (DVec3::ZERO, 3.0), (DVec3::ZERO, 5.0), (DVec3::new(0.0, 4.0, 0.0), 1.0)];
    let mesh = merge(vec![plane(40.0, 1), balls(&list)]).unwrap();
    let caster = ExactCaster::new(Arc::new(mesh.clone()));
    let all = |origin: DVec3, direction: DVec3, range: [f64; 2]| -> Vec<(f64, u32)> {
        let hits = caster.all(&Ray { origin, direction }, range);
        hits.into_iter().map(|hit| (hit.t, hit.triangle)).collect()
    };
    let ever = [f64::NEG_INFINITY, f64::INFINITY];
    // the plane y = 0 has two triangles, 0 and 1; the spheres are 2 to 5
    let down = |x: f64| all(DVec3::new(x, 9.0, 0.25 * x), DVec3::NEG_Y, ever);
    let through = down(1e-9);
    let ids: Vec<u32> = through.iter().map(|(_, id)| *id).collect();
    assert_eq!((&ids[..5], &ids[6..]), (&[2, 4, 5, 5, 3][..], &[3, 2, 4][..]), "{through:?}");
    assert!(ids[5] < 2 && through.windows(2).all(|pair| pair[0].0 <= pair[1].0), "{through:?}");
    // along the axis the small ball touches the large ones from inside, and the middle one from outside: by id
    let through = all(DVec3::new(0.0, 9.0, 0.0), DVec3::NEG_Y, ever);
    let upper: Vec<(f64, u32)> = through.iter().copied().filter(|(t, _)| *t < 9.0).collect();
    assert_eq!(upper, [(4.0, 2), (4.0, 4), (4.0, 5), (6.0, 3), (6.0, 5)]);
    // touching: in and out at one t
    let beside = all(DVec3::new(5.0, 0.5, -12.0), 0.5 * DVec3::Z, ever);
    assert_eq!(beside, []);
    let level = all(DVec3::new(-7.0, 5.0, 0.0), DVec3::X, ever);
    assert_eq!(level, [(7.0, 2), (7.0, 2), (7.0, 4), (7.0, 4), (7.0, 5), (7.0, 5)]);
    assert_eq!(all(DVec3::new(-7.0, 5.0_f64.next_up(), 0.0), DVec3::X, ever), []);
    // ends of the range are in it, and 3, 4, 5 are exact
    let along = |range| all(DVec3::new(-9.0, 3.0, 0.0), DVec3::X, range);
    let outer = [(5.0, 2), (5.0, 4), (13.0, 2), (13.0, 4)];
    let of = |range: [f64; 2]| along(range).into_iter().filter(|(_, id)| [2, 4].contains(id)).collect::<Vec<_>>();
    assert_eq!(of([5.0, 13.0]), outer);
    assert_eq!(of([5f64.next_up(), 13f64.next_down()]), []);
    assert_eq!(of([-1.0, 5.0]), outer[..2]);
    assert!(!caster.meets_any(&Ray { origin: DVec3::ZERO, direction: DVec3::X }, [0.0, 2.9]));
    assert!(caster.meets_any(&Ray { origin: DVec3::ZERO, direction: DVec3::X }, [0.0, 3.0]));
    assert!(caster.is_exact(&Ray { origin: DVec3::ZERO, direction: DVec3::X }));
    assert!(!caster.is_exact(&Ray { origin: DVec3::ZERO, direction: DVec3::new(1.0, 1e-13, 0.0) }));
}

/// Spheres about points of a coarse grid, walls through them: which hits are level, and which are first, is decided in whole numbers.
#[test]
fn level_hits_are_level_in_whole_numbers() {
    let mut rng = Rng(6);
    let mut grid = |n: f64| (n * rng.vector()).round();
    // a ray along z at a whole place of squared distance k from the centre leaves a sphere of radius^2 k + n^2 at n
    let mut level = 0;
    for _ in 0..400 {
        let (place, centres) = (grid(4.0), [grid(3.0), grid(3.0), grid(3.0), grid(3.0)]);
        let list: Vec<(DVec3, f64)> = centres.into_iter().map(|c| (c, 5.0)).collect();
        let caster = ExactCaster::new(Arc::new(balls(&list)));
        let ray = Ray { origin: DVec3::new(place.x, place.y, -20.0), direction: DVec3::Z };
        let hits = caster.all(&ray, [f64::NEG_INFINITY, f64::INFINITY]);
        // t + 20 = z -+ sqrt(25 - k): a pair is ordered by whole numbers alone
        let key = |k: usize| {
            let c = centres[k];
            let off = (c.x - place.x).powi(2) + (c.y - place.y).powi(2);
            (off <= 25.0).then_some((c.z as i64, 25 - off as i64))
        };
        let mut truth: Vec<(i64, i64, i64, u32)> = Vec::new();
        for k in 0..4 {
            for side in [-1, 1] {
                truth.extend(key(k).map(|(z, square)| (z, side, square, k as u32)));
            }
        }
        // a + s sqrt(b) against c + u sqrt(d)
        let sign = |(a, s, b, _): &(i64, i64, i64, u32), (c, u, d, _): &(i64, i64, i64, u32)| {
            let rooted = |p: i64, q: i64, square: i64| match (p.signum(), q.signum() * square.signum()) {
                (x, y) if x * y >= 0 => (x + y).signum(),
                (x, _) => x * (p * p - q * q * square).signum(),
            };
            let roots = if s * u < 0 { s * (b + d).signum() } else { s * (b - d).signum() };
            let p = a - c;
            match p.signum() * roots {
                ..0 => p.signum() * rooted(p * p - b - d, 2 * s * u, b * d),
                _ => (p.signum() + roots).signum(),
            }
        };
        truth.sort_by(|x, y| sign(x, y).cmp(&0).then(x.3.cmp(&y.3)));
        level += truth.windows(2).filter(|w| sign(&w[0], &w[1]) == 0 && w[0].3 != w[1].3).count();
        let ids: Vec<u32> = hits.iter().map(|hit| hit.triangle).collect();
        assert_eq!(ids, truth.iter().map(|t| t.3).collect::<Vec<_>>(), "{centres:?} {place}");
    }
    assert!(level > 50, "{level}");
}
