//! Pictures as cameras on masts take them of a street corner with its paint: every pixel's ray against a few boxes and the ground.

use super::NamedFile;
use crate::arrays::MapEach;
use crate::image::png_bytes;
use glam::{DVec2, DVec3};

/// Pixels.
const SIZE: (u32, u32) = (480, 360);

/// The pictures of the three cameras, frame by frame.
const NAMES: [[&str; 3]; 4] = [
    ["west-0000.png", "east-0000.png", "mast-0000.png"],
    ["west-0001.png", "east-0001.png", "mast-0001.png"],
    ["west-0002.png", "east-0002.png", "mast-0002.png"],
    ["west-0003.png", "east-0003.png", "mast-0003.png"],
];

/// The boxes of the scene file: middle and half sizes.
const BOXES: [(DVec3, DVec3); 5] = [
    (DVec3::new(-7.0, 3.0, -6.5), DVec3::new(3.5, 3.0, 3.0)),
    (DVec3::new(6.5, 4.5, -6.5), DVec3::new(3.0, 4.5, 3.0)),
    (DVec3::new(-6.5, 2.0, 6.5), DVec3::new(3.0, 2.0, 3.0)),
    (DVec3::new(7.0, 2.5, 6.5), DVec3::new(3.5, 2.5, 2.5)),
    (DVec3::new(0.0, 1.0, -8.0), DVec3::new(1.0, 1.0, 1.0)),
];

/// The walls' colours, sRGB.
const WALLS: [DVec3; 5] = [
    DVec3::new(0.78, 0.44, 0.32),
    DVec3::new(0.62, 0.66, 0.74),
    DVec3::new(0.86, 0.76, 0.50),
    DVec3::new(0.52, 0.62, 0.48),
    DVec3::new(0.80, 0.30, 0.26),
];

const SKY: DVec3 = DVec3::new(0.62, 0.76, 0.90);

/// Eye, target and the angle of view: from the upper to the lower border, or of the fisheye across the diagonal; degrees.
const WEST: (DVec3, DVec3, f64) = (DVec3::new(-12.0, 9.0, 13.0), DVec3::new(1.0, 0.5, -1.5), 48.0);
const EAST: (DVec3, DVec3, f64) = (DVec3::new(14.0, 10.0, 11.0), DVec3::new(-1.0, 0.5, -1.5), 48.0);
const MAST: (DVec3, DVec3, f64) = (DVec3::new(0.5, 11.0, 0.5), DVec3::new(0.0, 0.0, 0.0), 150.0);

/// The pictures of two pinhole cameras and of a fisheye above the crossing, four frames each.
pub fn takes() -> Vec<NamedFile> {
    let cameras = [(WEST, false), (EAST, false), (MAST, true)];
    let of_frame = |(frame, names): (u32, [&'static str; 3])| {
        [0, 1, 2].map_each(|k| (names[k], take(cameras[k].0, cameras[k].1, frame)))
    };
    (0..).zip(NAMES).flat_map(of_frame).collect()
}

fn take((eye, target, angle): (DVec3, DVec3, f64), is_fisheye: bool, frame: u32) -> Vec<u8> {
    let (width, height) = SIZE;
    let forward = (target - eye).normalize();
    let right = forward.cross(if is_fisheye { DVec3::NEG_Z } else { DVec3::Y }).normalize();
    let up = right.cross(forward);
    let half = angle.to_radians() / 2.0;
    let size = DVec2::new(width.into(), height.into());
    let direction = |place: DVec2| {
        let off = (place - 0.5 * size) * DVec2::new(1.0, -1.0);
        if is_fisheye {
            let off = off / (0.5 * size.length());
            let (sin, cos) = (off.length() * half).sin_cos();
            return cos * forward + sin / off.length().max(1e-9) * (off.x * right + off.y * up);
        }
        let off = off / (0.5 * size.y) * half.tan();
        forward + off.x * right + off.y * up
    };
    // four places a pixel
    let places = [(0.25, 0.25), (0.75, 0.25), (0.25, 0.75), (0.75, 0.75)];
    let pixel = |k: u32| {
        let corner = DVec2::new((k % width).into(), (k / width).into());
        let sum: DVec3 = places.iter().map(|p| seen(eye, direction(corner + DVec2::from(*p)), frame)).sum();
        (0.25 * sum).to_array().map_each(|v| (255.0 * v).round() as u8)
    };
    let srgb8: Vec<u8> = (0..width * height).flat_map(pixel).collect();
    // three bytes a pixel
    png_bytes(width, height, &srgb8).unwrap_or_default()
}

/// The colour of what a ray meets first.
fn seen(eye: DVec3, d: DVec3, frame: u32) -> DVec3 {
    let ground = if d.y < 0.0 { -eye.y / d.y } else { f64::INFINITY };
    let (mut nearest, mut colour) = (ground, None);
    for (k, (middle, half)) in BOXES.iter().enumerate() {
        let (a, b) = ((middle - half - eye) / d, (middle + half - eye) / d);
        let (enters, leaves) = (a.min(b), a.max(b));
        let t = enters.max_element();
        if t <= leaves.min_element() && t > 0.0 && t < nearest {
            let axis = enters.max_position();
            (nearest, colour) = (t, Some((k, axis, eye + t * d)));
        }
    }
    match colour {
        Some((k, axis, p)) => wall(k, axis, p),
        None if ground.is_finite() => street(eye + ground * d, frame),
        None => SKY,
    }
}

/// Roofs with a rim, and walls with windows.
fn wall(k: usize, axis: usize, p: DVec3) -> DVec3 {
    let (middle, half) = BOXES[k];
    let from = p - middle + half;
    if axis == 1 {
        let rim = (half - (p - middle).abs()).x.min((half - (p - middle).abs()).z);
        return if rim < 0.3 { DVec3::splat(0.75) } else { DVec3::new(0.42, 0.40, 0.40) };
    }
    let shade = if axis == 0 { 0.82 } else { 1.0 };
    let along = if axis == 0 { from.z } else { from.x };
    let (x, y) = ((along - 0.5).rem_euclid(1.0), from.y.rem_euclid(1.0));
    let is_window = (0.25..0.75).contains(&x) && (0.3..0.8).contains(&y) && half.y > 1.5;
    if is_window { DVec3::new(0.16, 0.22, 0.30) } else { shade * WALLS[k] }
}

/// Two streets that cross, pavements, and three cars on their way.
fn street(p: DVec3, frame: u32) -> DVec3 {
    const ROAD: f64 = 2.2;
    let on = [p.z.abs() < ROAD, p.x.abs() < ROAD];
    let moved = f64::from(frame);
    let cars = [
        (DVec2::new(-9.0 + 3.0 * moved, 1.1), DVec2::new(1.0, 0.5), DVec3::new(0.85, 0.15, 0.12)),
        (DVec2::new(8.0 - 2.5 * moved, -1.1), DVec2::new(1.1, 0.5), DVec3::new(0.95, 0.85, 0.20)),
        (DVec2::new(-1.1, -4.5 + 2.0 * moved), DVec2::new(0.5, 1.0), DVec3::new(0.15, 0.35, 0.80)),
    ];
    for (middle, half, colour) in cars {
        let off = (DVec2::new(p.x, p.z) - middle).abs();
        if off.cmplt(half).all() {
            return if off.cmplt(0.6 * half).all() { 0.55 * colour } else { colour };
        }
    }
    let dashes = |along: f64, across: f64| across.abs() < 0.08 && along.rem_euclid(1.6) < 0.9;
    match on {
        [true, true] => DVec3::splat(0.34),
        [true, false] if dashes(p.x, p.z) => DVec3::splat(0.95),
        [false, true] if dashes(p.z, p.x) => DVec3::splat(0.95),
        // zebra crossings
        [true, false] if (2.6..3.8).contains(&p.x.abs()) && p.z.rem_euclid(0.8) < 0.4 => DVec3::splat(0.92),
        [false, true] if (2.6..3.8).contains(&p.z.abs()) && p.x.rem_euclid(0.8) < 0.4 => DVec3::splat(0.92),
        [true, false] | [false, true] => DVec3::splat(0.34),
        _ if p.x.abs().min(p.z.abs()) < 3.2 => DVec3::new(0.70, 0.68, 0.64),
        _ => DVec3::new(0.40, 0.54, 0.30),
    }
}
