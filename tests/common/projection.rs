//! Projection against coverage: images see their points, and pixels are images of what they see; with the GPU's help
//! the same.

use super::needs;
use super::rng::Rng;
use super::soup;
use anamorph::internals::camera::project::{Image, Images, Projector};
use anamorph::internals::camera::{Camera, Ray, Rays};
use anamorph::internals::engine::stage::sift::Sift;
use anamorph::internals::engine::stage::solve::Solve;
use anamorph::internals::gpu::Gpu;
use anamorph::internals::jobs::splat::splat;
use anamorph::internals::reference::{Path, Reference};
use glam::{DVec2, DVec3};
use std::sync::OnceLock;

/// What an image place may be off by, px (the promise of the property).
pub const PLACE_PX: f64 = 1e-6;

/// A ray may miss its point by a ten-millionth of a pixel's footprint, which is under 1/10 in all these cameras.
pub const MISS: f64 = 1e-8;

/// Where the camera looks from an image place at the image's t, by the image's own piece.
pub fn point_seen(camera: &Camera, image: &Image) -> DVec3 {
    let place = DVec2::new(image.x, image.y);
    let t = image.t - image.layer as f64;
    let along = |r: Ray| r.origin + t * r.direction;
    match &camera.layers[image.layer] {
        Rays::Pieces(p) => along(p.bundle_at_place(image.piece - camera.first_piece(image.layer), place).ray(0.0, 0.0)),
        Rays::Field(f) => along(f.ray_at(place).unwrap()),
        Rays::Curves(c) => c.at_place(place).unwrap().1.at(t),
    }
}

/// How often each number of images occurred; the last: 7 and more.
pub type Counts = [usize; 8];

/// Points of the cube of half-size 1/2: each image sees its point.
pub fn images_see_their_points(name: &str, camera: &Camera, rng: &mut Rng, points: usize) -> Counts {
    let projector = Projector::new(camera);
    let mut counts = Counts::default();
    for _ in 0..points {
        let point = 0.5 * rng.vector();
        let Images { images, degenerate, incomplete } = projector.project(point);
        assert!(!incomplete, "{name}: {point}");
        assert_eq!(degenerate, None, "{name}: {point}");
        for image in &images {
            let off = (point_seen(camera, image) - point).length();
            assert!(off < MISS, "{name}: {image:?} misses {point} by {off}");
            assert!((0.0..=1.0).contains(&image.a) && (0.0..=1.0).contains(&image.b), "{name}: {image:?}");
            let px = DVec2::new(image.a * f64::from(camera.width), image.b * f64::from(camera.height));
            assert!(px.distance(DVec2::new(image.x, image.y)) < 1e-12);
        }
        counts[images.len().min(7)] += 1;
    }
    counts
}

/// Random triangles: what a pixel sees has an image at its centre, at the same t.
pub fn pixels_are_images_of_what_they_see(name: &str, camera: &Camera, rng: &mut Rng, pixels: usize) -> usize {
    let mesh = soup(rng, 60, 1.0);
    let reference = Reference::build(&mesh);
    let projector = Projector::new(camera);
    let mut hits = 0;
    for _ in 0..pixels {
        let (i, j) = (rng.below(camera.width as usize) as u32, rng.below(camera.height as usize) as u32);
        if !has_rays_about(camera, i, j) {
            continue;
        }
        let path = Path::of_pixel(camera, i, j);
        let Some(seen) = reference.first(&path) else { continue };
        let place = DVec2::new(f64::from(i) + 0.5, f64::from(j) + 0.5);
        let own = Image { x: place.x, y: place.y, a: 0.0, b: 0.0, t: seen.t(), layer: seen.layer, piece: seen.piece };
        let point = point_seen(camera, &own);
        let Images { images, degenerate, .. } = projector.project(point);
        if degenerate.is_some() {
            // one place of a whole curve of them, as in the pieces beside a pole, which see the same along a row
            continue;
        }
        let same = |i: &&Image| i.layer == seen.layer && i.piece == seen.piece && (i.t - seen.t()).abs() < PLACE_PX;
        let off =
            images.iter().filter(same).map(|i| DVec2::new(i.x, i.y).distance(place)).fold(f64::INFINITY, f64::min);
        assert!(off < PLACE_PX, "{name}: pixel {i},{j} sees {point} at {}: {images:?}", seen.t());
        hits += 1;
    }
    hits
}

/// Random places of curved layers, at random t: each is an image of the point that it sees, whatever else sees it.
pub fn places_are_images_of_their_points(name: &str, camera: &Camera, rng: &mut Rng, places: usize) {
    let projector = Projector::new(camera);
    for (layer, rays) in camera.layers.iter().enumerate() {
        let Rays::Curves(curves) = rays else { continue };
        for _ in 0..places {
            let place = DVec2::new(f64::from(camera.width) * rng.unit(), f64::from(camera.height) * rng.unit());
            let t = rng.unit();
            let Some((_, curve)) = curves.at_place(place) else { continue };
            let all = projector.project(curve.at(t));
            let is_it = |i: &Image| i.layer == layer && DVec2::new(i.x, i.y).distance(place) < PLACE_PX;
            let found = all.degenerate.is_some() || all.images.iter().any(is_it);
            assert!(found, "{name}: layer {layer}, {place} at {t}: {all:?}");
        }
    }
}

/// A table of rays is an image between four of them only.
fn has_rays_about(camera: &Camera, i: u32, j: u32) -> bool {
    let [Rays::Field(f)] = camera.layers.as_slice() else { return true };
    let has = |dx: i64, dy: i64| {
        let (x, y) = (i64::from(i) + dx, i64::from(j) + dy);
        let inside = (0..i64::from(camera.width)).contains(&x) && (0..i64::from(camera.height)).contains(&y);
        inside && f.ray(x as u32, y as u32).is_some()
    };
    f.map().is_some() || [(-1, -1), (-1, 1), (1, -1), (1, 1)].iter().any(|&(x, y)| has(x, 0) && has(0, y) && has(x, y))
}

/// This machine's adapter; `None`, as [`needs::no_adapter`] says, where there is none.
pub fn gpu() -> Option<&'static Gpu> {
    static GPU: OnceLock<Option<Gpu>> = OnceLock::new();
    let gpu = GPU.get_or_init(needs::adapter).as_ref();
    if gpu.is_none() {
        needs::no_adapter();
    }
    gpu
}

/// The GPU's lists lead to the very lines of the CPU alone: at random points, near and far, and at what places see.
pub fn sifted_lines_are_the_same(name: &str, camera: &Camera, rng: &mut Rng, points: usize) {
    let Some(gpu) = gpu() else { return };
    let projector = Projector::new(camera);
    let seen = |rng: &mut Rng| {
        let (i, j) = (rng.below(camera.width as usize) as u32, rng.below(camera.height as usize) as u32);
        camera.ray(i, j).map_or(DVec3::ZERO, |r| r.origin + 4.0 * rng.signed() * r.direction)
    };
    let points: Vec<DVec3> = (0..points)
        .map(|k| match k % 8 {
            0..5 => 0.5 * rng.vector(),
            5 => 1e3 * rng.vector(),
            _ => seen(rng),
        })
        .collect();
    let mut sift = Sift::new(gpu, &projector).unwrap();
    let started = sift.start(&points).unwrap();
    let sifted = sift.finish(started).unwrap();
    let mut solve = Solve::new(gpu, &projector).unwrap();
    let started = solve.start(&points).unwrap();
    let solved = solve.finish(started).unwrap();
    for (k, point) in points.iter().enumerate() {
        let lines = [
            projector.project(*point),
            projector.project_below(*point, |layer| sifted.nodes(layer, k)),
            projector.project_below(*point, |layer| solved.nodes(layer, k)),
        ]
        .map(|images| serde_json::to_string(&images).unwrap());
        assert!(lines[0] == lines[1], "{name}: {point}: {} against {}", lines[0], lines[1]);
        assert!(lines[0] == lines[2], "{name}: {point}: {} against {}, solved", lines[0], lines[2]);
    }
}

/// Points as a picture: with the GPU and without, each pixel shows the nearest of all images in it.
pub fn splats_show_the_nearest_points(name: &str, camera: &Camera, rng: &mut Rng, points: usize) {
    let Some(gpu) = gpu() else { return };
    let points: Vec<DVec3> = (0..points).map(|k| if k % 50 == 49 { DVec3::NAN } else { 0.5 * rng.vector() }).collect();
    // every point twice: at the same t the first one is seen
    let points: Vec<DVec3> = points.iter().chain(&points).copied().collect();
    let projector = Projector::new(camera);
    let (width, height) = (camera.width as usize, camera.height as usize);
    let mut nearest = vec![(f64::INFINITY, u32::MAX); width * height];
    for (k, point) in points.iter().enumerate() {
        for image in projector.project(*point).images {
            let pixel = (image.y as usize).min(height - 1) * width + (image.x as usize).min(width - 1);
            if image.t < nearest[pixel].0 {
                nearest[pixel] = (image.t, k as u32);
            }
        }
    }
    for gpu in [None, Some(gpu)] {
        let all = splat(camera, &points, gpu).unwrap();
        for (pixel, (t, k)) in nearest.iter().enumerate() {
            assert!(
                all.index[pixel] == *k && all.t[pixel].to_bits() == t.to_bits(),
                "{name}: pixel {pixel}: {} at {}, not {k} at {t}",
                all.index[pixel],
                all.t[pixel]
            );
        }
        if gpu.is_some() && matches!(camera.layers.as_slice(), [Rays::Pieces(_)]) {
            println!("{name}: {} of {} points left out by kernels", all.by_kernel, points.len());
        }
    }
}

/// All properties, at random points, pixels and places. How many points had how many images.
pub fn check(name: &str, camera: &Camera, seed: u64) -> Counts {
    let mut rng = Rng(seed);
    let counts = images_see_their_points(name, camera, &mut rng, 100);
    let hits = pixels_are_images_of_what_they_see(name, camera, &mut rng, 120);
    assert!(hits > 18, "{name}: only {hits} hits");
    places_are_images_of_their_points(name, camera, &mut rng, 40);
    sifted_lines_are_the_same(name, camera, &mut rng, 40);
    splats_show_the_nearest_points(name, camera, &mut rng, 40);
    counts
}
