//! Every comparator must notice the error planted for it.

use super::*;
use crate::image::frame::Plane;

const WIDTH: u32 = 20;
const HEIGHT: u32 = 10;
const PIXELS: usize = 200;
/// A pixel that is hit and one that is not.
const HIT: usize = 55;
const MISS: usize = 0;

/// Misses in the first row, hits at t = 1 + i, |D| = 2 below.
fn frame() -> Frame {
    let hit = |i: usize| i >= WIDTH as usize;
    let plane = |channel: Channel| match channel {
        c if c.is_id() => Plane::U32((0..PIXELS).map(|i| if hit(i) { (i / 7) as u32 } else { NO_ID }).collect()),
        Channel::T | Channel::Z => {
            let length = if channel == Channel::Z { 2.0 } else { 1.0 };
            Plane::F32((0..PIXELS).map(|i| if hit(i) { length * (1 + i) as f32 } else { f32::INFINITY }).collect())
        }
        _ => Plane::F32((0..PIXELS).map(|i| if hit(i) { i as f32 / PIXELS as f32 } else { 0.0 }).collect()),
    };
    Frame { width: WIDTH, height: HEIGHT, planes: Channel::ALL.into_iter().map(|c| (c, plane(c))).collect() }
}

fn set(frame: &mut Frame, channel: Channel, pixel: usize, value: f32) {
    for (c, plane) in &mut frame.planes {
        match plane {
            Plane::F32(values) if *c == channel => values[pixel] = value,
            Plane::U32(values) if *c == channel => values[pixel] = value as u32,
            _ => {}
        }
    }
}

/// The comparison of a frame with one planted value against the frame without it.
fn planted(channel: Channel, pixel: usize, value: f32) -> Comparison {
    let mut a = frame();
    set(&mut a, channel, pixel, value);
    compare(&a, &frame(), Some(&[true; PIXELS]), None).unwrap()
}

fn max(quantiles: Option<Quantiles>) -> f64 {
    quantiles.unwrap().max.0
}

#[test]
fn equal_frames_have_no_error() {
    let same = compare(&frame(), &frame(), Some(&[true; PIXELS]), Some(&[1.0; PIXELS])).unwrap();
    let zero = Some(0);
    assert_eq!((same.wrong_triangle, same.wrong_hit_miss, same.wrong_safe), (zero, zero, zero));
    assert_eq!((same.pixels, same.unsafe_pixels, same.unsafe_share), (200, zero, Some(0.0)));
    assert_eq!((max(same.t_relative), max(same.z_relative), same.bary_max), (0.0, 0.0, Some(Measure(0.0))));
    assert_eq!((same.psnr, same.identical), (Some(f64::INFINITY), Some(true)));
    let json = serde_json::to_string(&same).unwrap();
    assert!(json.contains(r#""psnr":null,"identical":true"#), "{json}");
    assert!(same.to_string().ends_with("colour identical") && !same.to_string().contains('\n'));
}

#[test]
fn one_wrong_id_is_counted() {
    let got = planted(Channel::TriangleId, HIT, 9999.0);
    assert_eq!((got.wrong_triangle, got.wrong_hit_miss, got.wrong_safe), (Some(1), Some(0), Some(1)));
    let mut a = frame();
    set(&mut a, Channel::TriangleId, HIT, 9999.0);
    let safe: Vec<bool> = (0..PIXELS).map(|i| i != HIT).collect();
    let got = compare(&a, &frame(), Some(&safe), None).unwrap();
    assert_eq!((got.wrong_triangle, got.wrong_safe, got.unsafe_pixels), (Some(1), Some(0), Some(1)));
    assert_eq!(got.unsafe_share, Some(0.005));
    let without = compare(&a, &frame(), None, None).unwrap();
    assert_eq!((without.wrong_triangle, without.wrong_safe, without.unsafe_pixels), (Some(1), None, None));
}

#[test]
fn one_flipped_hit_or_miss_is_counted() {
    for (pixel, id) in [(HIT, NO_ID as f32), (MISS, 3.0)] {
        let got = planted(Channel::TriangleId, pixel, id);
        assert_eq!((got.wrong_triangle, got.wrong_hit_miss, got.wrong_safe), (Some(1), Some(1), Some(1)));
    }
    let only_t = |mut frame: Frame| {
        frame.planes.retain(|(c, _)| *c == Channel::T);
        frame
    };
    let mut a = frame();
    set(&mut a, Channel::T, MISS, 1.0);
    let got = compare(&only_t(a), &only_t(frame()), None, None).unwrap();
    assert_eq!((got.wrong_triangle, got.wrong_hit_miss, max(got.t_relative), got.psnr), (None, Some(1), 0.0, None));
}

#[test]
fn one_shifted_t_or_z_is_measured() {
    let t = (1 + HIT) as f32;
    let got = planted(Channel::T, HIT, t * 1.25);
    assert_eq!((max(got.t_relative), max(got.z_relative)), (0.25, 0.0));
    assert_eq!(got.t_relative.unwrap().median.0, 0.0);
    let got = planted(Channel::Z, HIT, 2.0 * t * 0.75);
    assert_eq!((max(got.t_relative), max(got.z_relative)), (0.0, 0.25));
}

#[test]
fn scales_hold_below_them_alone() {
    let shifted = |channel, value| {
        let mut a = frame();
        set(&mut a, channel, HIT, value);
        compare(&a, &frame(), None, Some(&[560.0; PIXELS])).unwrap()
    };
    let t = (1 + HIT) as f32;
    assert_eq!(max(shifted(Channel::T, t + 56.0).t_relative), 0.1);
    // |D| = 2: the floor of Z is twice that of t.
    assert!((max(shifted(Channel::Z, 2.0 * t - 1.12).z_relative) - 0.001).abs() < 1e-6);
}

#[test]
fn one_nan_is_an_infinite_error() {
    assert_eq!(max(planted(Channel::T, HIT, f32::NAN).t_relative), f64::INFINITY);
    assert_eq!(max(planted(Channel::Z, HIT, f32::NAN).z_relative), f64::INFINITY);
    assert_eq!(planted(Channel::BaryU, HIT, f32::NAN).bary_max, Some(Measure(f64::INFINITY)));
    let color = planted(Channel::G, HIT, f32::NAN);
    assert_eq!(color.identical, Some(false));
    assert!((color.psnr.unwrap() - 10.0 * 600f64.log10()).abs() < 1e-9);
    let mut both = frame();
    set(&mut both, Channel::T, HIT, f32::NAN);
    assert_eq!(max(compare(&both, &both, None, None).unwrap().t_relative), f64::INFINITY);
}

#[test]
fn infinite_t_on_a_hit_is_an_infinite_error() {
    assert_eq!(max(planted(Channel::T, HIT, f32::INFINITY).t_relative), f64::INFINITY);
}

#[test]
fn barycentric_and_color_errors_are_measured() {
    let bary = planted(Channel::BaryV, HIT, HIT as f32 / PIXELS as f32 + 0.5);
    assert!((bary.bary_max.unwrap().0 - 0.5).abs() < 1e-6);
    let color = planted(Channel::B, MISS, 0.1);
    assert!((color.psnr.unwrap() - -10.0 * (0.01 / 600.0f64).log10()).abs() < 1e-5);
    assert_eq!(color.identical, Some(false));
    // Clamped: brighter than white is white.
    let mut white = frame();
    set(&mut white, Channel::R, MISS, 1.0);
    let mut brighter = frame();
    set(&mut brighter, Channel::R, MISS, 7.0);
    assert_eq!(compare(&brighter, &white, None, None).unwrap().identical, Some(true));
}

#[test]
fn different_sizes_are_input_errors() {
    let rotated = Frame { width: HEIGHT, height: WIDTH, ..frame() };
    let error = compare(&frame(), &rotated, None, None).unwrap_err();
    assert!(error.exit_code() == 2 && error.to_string().contains("20 x 10 against 10 x 20"), "{error}");
    assert!(compare(&frame(), &frame(), Some(&[true; 3]), None).is_err());
    assert!(compare(&frame(), &frame(), None, Some(&[1.0; 3])).is_err());
    let mut short = frame();
    short.planes[0].1 = Plane::F32(vec![0.0; 3]);
    assert!(compare(&short, &frame(), None, None).is_err());
}

/// Only these channels of a frame.
fn only(frame: Frame, channels: &[Channel]) -> Frame {
    let planes = frame.planes.into_iter().filter(|(c, _)| channels.contains(c)).collect();
    Frame { planes, ..frame_of_nothing() }
}

fn frame_of_nothing() -> Frame {
    Frame { width: WIDTH, height: HEIGHT, planes: Vec::new() }
}

#[test]
fn depth_is_compared_without_ids() {
    let mut near = frame();
    (0..PIXELS).for_each(|i| set(&mut near, Channel::Z, i, if i < 40 { f32::INFINITY } else { 5.0 }));
    let mut far = frame();
    (0..PIXELS).for_each(|i| set(&mut far, Channel::Z, i, if i < 20 { f32::INFINITY } else { 50.0 }));
    let z = [Channel::Z, Channel::R];
    let got = compare(&only(near, &z), &only(far, &z), None, None).unwrap();
    assert_eq!(got.channels, ["R", "Z"]);
    // 20 pixels are hit in one frame only; the depth of the others is 5 instead of 50
    assert_eq!((got.wrong_triangle, got.wrong_hit_miss), (None, Some(20)));
    assert_eq!((got.where_both_hit, max(got.z_relative)), (Some(Matched::BothHit), 0.9));
    let text = got.to_string();
    assert!(
        text.starts_with("200 pixels of R Z, 20 wrong hit or miss, Z error where both hit median 9.0e-1"),
        "{text}"
    );
}

#[test]
fn images_without_a_channel_in_common_are_not_compared() {
    let (z, colour) = (only(frame(), &[Channel::Z]), only(frame(), &[Channel::R, Channel::G, Channel::B]));
    let error = compare(&z, &colour, None, None).unwrap_err();
    assert_eq!(error.exit_code(), 2);
    assert!(error.to_string().contains("the first image has Z, the second R G B"), "{error}");
}

#[test]
fn every_channel_that_both_have_is_compared() {
    for (channel, value, largest) in [
        (Channel::PieceId, 77.0, None),
        (Channel::MirrorId, 77.0, None),
        (Channel::A, 1.0 + HIT as f32 / PIXELS as f32, Some(1.0)),
        (Channel::A, f32::NAN, Some(f64::INFINITY)),
    ] {
        let got = planted(channel, HIT, value);
        let differs: Vec<&Difference> = got.others.iter().filter(|d| d.pixels > 0).collect();
        assert!(matches!(differs[..], [d] if d.channel == channel.name() && d.pixels == 1), "{differs:?}");
        let max = differs[0].max.map(|m| m.0);
        assert!(max == largest || (max.unwrap() - largest.unwrap()).abs() < 1e-6, "{max:?}");
        assert!(got.to_string().contains(&format!("{} differs in 1", channel.name())), "{got}");
    }
    // single colour channels, and weights without triangle ids, are compared as any other channel
    for channel in [Channel::G, Channel::BaryU] {
        let mut a = frame();
        set(&mut a, channel, MISS, 0.25);
        let got = compare(&only(a, &[channel]), &only(frame(), &[channel]), None, None).unwrap();
        let expected = Difference { channel: channel.name(), pixels: 1, max: Some(Measure(0.25)) };
        assert_eq!((got.others, got.psnr, got.bary_max), (vec![expected], None, None));
    }
}
