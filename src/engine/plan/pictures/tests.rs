use super::pack::Packing;
use super::patch::{OVERLAP_PX, Patches, TOLERANCE_PX};
use crate::camera::project::Projector;
use crate::camera::{Camera, Rays};
use crate::input::Loading;
use crate::scene::file;
use crate::testing::Rng;
use glam::{DVec2, DVec3};
use std::path::Path;

const SIZE: (u32, u32) = (96, 64);
const LOOK: &str = "eye = [0.4, 1.5, 4]\ntarget = [0, 0, 0]";
const BOUNDS: (DVec3, DVec3) = (DVec3::new(-1.5, -1.0, -1.5), DVec3::new(1.5, 1.0, 1.5));

fn camera(keys: &str) -> Camera {
    let table = file::parse_table(&keys.replace("LOOK", LOOK)).unwrap();
    let spec = file::camera_of(&table, Path::new(""), &Loading::default()).unwrap();
    Camera::new(&spec, Some(SIZE)).unwrap()
}

/// Of cameras whose rays bend: two for each of so few pixels, of which there could be four, as there are almost of a whole turn about
/// an axis.
const MANY: usize = 2 * 96 * 64;

/// Kinds of cameras, and patches of each at most.
fn cameras() -> Vec<(Camera, usize)> {
    [
        ("kind = \"pinhole\"\nLOOK\nvfov = 35", 1),
        ("kind = \"orthographic\"\nLOOK\nheight = 3", 1),
        ("kind = \"pinhole\"\neye = [0, 0, 1]\ntarget = [0, 0, 0]\nvfov = 120", 1),
        ("kind = \"pushbroom\"\nstart = [-2, 3, 0]\nend = [2, 3, 0]\nlook = [0, -1, 0.1]\nvfov = 70", 1),
        ("kind = \"cross_slit\"\nLOOK\nheight = 3\nslits = [{ distance = 3, angle = 0 }, { distance = 4.5, angle = 90 }]", 1),
        ("kind = \"fisheye\"\nLOOK\nfov = 120\nframe = \"full\"", MANY),
        ("kind = \"fisheye\"\nLOOK\nfov = 190", MANY),
        ("kind = \"sphere\"\nLOOK", MANY),
        ("kind = \"cylinder\"\nLOOK\nfov = 200\nvfov = 80", MANY),
        ("kind = \"panini\"\nLOOK\nfov = 150\nd = 1", MANY),
        ("kind = \"panorama\"\ncenter = [0, 0, 0]\nradius = 4\nheight = 3\nelevation = 1", 16_000),
        ("kind = \"panorama\"\ncenter = [0, 0, 0]\nradius = 4\nheight = 3\npieces = 12", MANY),
        ("kind = \"twist\"\nLOOK\nvfov = 40\nangle = 30\ndegree = 1", MANY),
    ]
    .map(|(keys, most)| (camera(keys), most))
    .into()
}

/// The places of a point as the kernel finds them, which goes down a tree of these patches.
fn found(patches: &Patches, x: DVec3) -> Vec<DVec2> {
    let mut places = Vec::new();
    patches.root.each(&mut |patch| {
        let far = patch.half + OVERLAP_PX;
        places.extend(patch.find(x).filter(|at| (*at - patch.middle).abs().cmple(far).all()));
    });
    places
}

/// Points of the box, by the digits of their numbers in bases 2, 3 and 5.
fn points() -> impl Iterator<Item = DVec3> {
    let digits = |mut k: u32, base: u32| {
        let (mut sum, mut part) = (0.0, 1.0);
        while k > 0 {
            part /= f64::from(base);
            sum += part * f64::from(k % base);
            k /= base;
        }
        sum
    };
    let at = move |k: u32| DVec3::new(digits(k, 2), digits(k, 3), digits(k, 5));
    (1..400).map(move |k| BOUNDS.0 + at(k) * (BOUNDS.1 - BOUNDS.0))
}

#[test]
fn each_image_of_a_point_lies_in_a_patch_within_the_tolerance() {
    for (camera, most) in cameras() {
        let patches = Patches::new(&camera, Some(BOUNDS)).unwrap();
        let name = format!("{} {:?}", camera.kind, camera.t_range);
        let (mut images, mut missed, mut largest) = (0, 0, 0.0_f64);
        let projector = Projector::new(&camera);
        for x in points() {
            let near = found(&patches, x);
            for image in projector.project(x).images {
                let off = near.iter().map(|at| (*at - DVec2::new(image.x, image.y)).length());
                let off = off.fold(f64::INFINITY, f64::min);
                images += 1;
                missed += usize::from(off > 4.0 * TOLERANCE_PX);
                largest = if off.is_finite() { largest.max(off) } else { largest };
            }
        }
        println!("{name}: {} patches, {images} images, {missed} missed, {largest:.4} px", patches.root.count());
        assert!(patches.root.count() <= most, "{name}: {} patches", patches.root.count());
        // where rays cross each other's slit, a point may be seen by a column of the image
        assert!(images > 100 && missed * 200 <= images, "{name}: {missed} of {images} missed");
    }
}

#[test]
fn no_patch_is_left_out_by_the_boxes_above_it() {
    for (camera, _) in cameras() {
        let patches = Patches::new(&camera, Some(BOUNDS)).unwrap();
        let packing = Packing::new(&patches, Some(BOUNDS), DVec3::new(0.5, 0.0, 0.0));
        let (mut nodes, mut packed) = (Vec::new(), Vec::new());
        packing.grow(&patches.root, &mut nodes, &mut packed);
        assert_eq!(packed.len(), patches.root.count());
        for (k, node) in nodes.iter().enumerate() {
            for below in &nodes[k + 1..node.next as usize] {
                let inside = |of: usize| {
                    let ([lo, hi], [l, h]) = (node.boxes[of], below.boxes[of]);
                    l.cmpge(lo).all() && h.cmple(hi).all()
                };
                assert!(inside(0) && inside(1) && node.patch.is_none());
            }
        }
    }
}

/// No ray of any pixel meets a box that the patches are said to miss. Some box must be missed, or the test would prove nothing.
#[test]
fn boxes_that_no_ray_meets() {
    let mut rng = Rng(3);
    let size = (BOUNDS.1 - BOUNDS.0).length();
    let mut left_out = 0;
    for (camera, _) in cameras() {
        let patches = Patches::new(&camera, Some(BOUNDS)).unwrap();
        let pixels = (0..SIZE.1).flat_map(|j| (0..SIZE.0).map(move |i| (i, j)));
        let rays: Vec<_> = pixels.filter_map(|(i, j)| camera.ray(i, j)).collect();
        for _ in 0..60 {
            let (center, half) = (4.0 * rng.vector(), 0.3 * rng.vector().abs());
            let (lo, hi) = (center - half, center + half);
            let is_met = rays.iter().any(|ray| {
                let (a, b) = ((lo - ray.origin) / ray.direction, (hi - ray.origin) / ray.direction);
                let first = a.min(b).max_element().max(camera.t_range[0]).max(0.0);
                first <= a.max(b).min_element().min(camera.t_range[1])
            });
            let may_be_met = patches.root.may_meet(patches.t_range, (lo, hi), size);
            assert!(may_be_met || !is_met, "{}: {lo} to {hi}", camera.kind);
            left_out += usize::from(!may_be_met);
        }
    }
    println!("{left_out} boxes are left out");
    assert!(left_out > 0);
}

#[test]
fn rays_without_any_order_are_refused_before_they_fill_the_memory() {
    let (w, h) = (512u32, 512u32);
    let mut rng = Rng(1);
    let n = (w * h) as usize;
    let vectors: Vec<DVec3> = (0..n).map(|_| 0.5 * rng.vector() - DVec3::Z).collect();
    let origins = vec![DVec3::new(0.0, 0.0, 2.0); n];
    let field = crate::camera::Field::new(w, h, &origins, &vectors).unwrap();
    let camera = Camera::of("raymap", (w, h), [0.0, f64::INFINITY], Rays::Field(field));
    let error = Patches::new(&camera, Some(BOUNDS)).err().unwrap().to_string();
    assert!(error.contains("more than 262144 parts"), "{error}");
}
