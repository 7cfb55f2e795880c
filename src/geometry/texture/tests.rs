use super::*;
use crate::image::srgb8;

fn texture(width: u32, greys: &[f32]) -> Texture {
    let rgba = greys.iter().map(|g| [*g, *g, *g, 1.0].map(f16::from_f32)).collect();
    Texture::new(Arc::new(Texels { width, height: greys.len() as u32 / width, rgba }))
}

#[test]
fn every_byte_of_srgb_comes_back() {
    let bytes: Vec<u8> = (0..=255).flat_map(|v| [v, v, v, 255]).collect();
    let image = image::RgbaImage::from_raw(256, 1, bytes).unwrap();
    let mut png = Cursor::new(Vec::new());
    image.write_to(&mut png, image::ImageFormat::Png).unwrap();
    let texels = decode(png.get_ref()).unwrap();
    assert_eq!((texels.width, texels.height), (256, 1));
    for (k, texel) in texels.rgba.iter().enumerate() {
        assert_eq!(srgb8(texel[0].to_f32()), k as u8);
    }
}

#[test]
fn the_first_row_is_on_top_and_values_between_are_bilinear() {
    let t = texture(2, &[0.0, 1.0, 0.5, 0.25]);
    for (uv, expected) in [
        ((0.25, 0.75), 0.0),
        ((0.75, 0.75), 1.0),
        ((0.25, 0.25), 0.5),
        ((0.75, 0.25), 0.25),
        ((0.5, 0.75), 0.5),
        ((0.5, 0.5), 0.4375),
    ] {
        assert_eq!(t.at(uv.into())[0], expected, "{uv:?}");
    }
}

#[test]
fn borders_repeat_end_or_mirror() {
    let seen = |wrap| (-3..6).map(|k| wrapped(k, 3, wrap)).collect::<Vec<_>>();
    assert_eq!(seen(Wrap::Repeat), [0, 1, 2, 0, 1, 2, 0, 1, 2]);
    assert_eq!(seen(Wrap::Clamp), [0, 0, 0, 0, 1, 2, 2, 2, 2]);
    assert_eq!(seen(Wrap::Mirror), [2, 1, 0, 0, 1, 2, 2, 1, 0]);
}

#[test]
fn an_alpha_mask_keeps_the_colour_of_what_is_there() {
    let opaque = [1.0, 0.5, 0.25, 1.0].map(f16::from_f32);
    let nothing = [0.0; 4].map(f16::from_f32);
    let texels = Arc::new(Texels { width: 2, height: 1, rgba: vec![opaque, nothing] });
    let t = Texture { cutoff: Some(0.5), ..Texture::new(texels) };
    let seen = t.at(DVec2::new(0.4, 0.5));
    assert_eq!(&seen[..3], &[1.0, 0.5, 0.25]);
    assert!((seen[3] - 0.7).abs() < 1e-12);
    assert!(t.is_there(DVec2::new(0.4, 0.5)) && !t.is_there(DVec2::new(0.6, 0.5)));
}

/// An opacity of a byte reaches the cutoff of that byte, and opaque is as opaque between texels as in their middles.
#[test]
fn opacities_equal_to_the_cutoff_reach_it() {
    for byte in 1..=255u8 {
        let opacity = f32::from(byte) / 255.0;
        let texels =
            Texels { width: 3, height: 3, rgba: vec![[f16::ONE, f16::ONE, f16::ONE, f16::from_f32(opacity)]; 9] };
        let t = Texture { cutoff: Some(opacity), ..Texture::new(Arc::new(texels)) };
        for k in 0..50 {
            assert!(t.is_there(DVec2::new(0.37 * f64::from(k), 0.0123 * f64::from(k))), "{byte}, {k}");
        }
    }
}

#[test]
fn far_coordinates_are_no_trouble() {
    let mut t = texture(2, &[0.0, 1.0, 0.5, 0.25]);
    for wrap in [Wrap::Repeat, Wrap::Clamp, Wrap::Mirror] {
        t.wrap = [wrap; 2];
        for far in [1e30, -1e30, 3e38] {
            assert!((0.0..=1.0).contains(&t.at(DVec2::new(far, -far))[0]));
        }
    }
}

#[test]
fn an_image_over_the_limit_says_so() {
    let mut head = Vec::new();
    let mut writer = png::Encoder::new(&mut head, 60_000, 60_000).write_header().unwrap();
    writer.write_chunk(png::chunk::IDAT, &[0; 8]).unwrap();
    drop(writer);
    let message = decode(&head).unwrap_err().to_string();
    assert_eq!(message, "is an image that takes more than 512 MiB of memory, the limit for one; make it smaller");
}

#[test]
fn what_is_no_image_says_so() {
    for bytes in [&b""[..], b"GIF89a", b"\x89PNG\r\n\x1a\nxx"] {
        let message = decode(bytes).unwrap_err().to_string();
        assert!(message.starts_with(NO_IMAGE), "{message}");
        assert!(!message.contains('\n'));
    }
}
