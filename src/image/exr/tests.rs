//! EXR files come back bit for bit; damaged ones come back as errors.

use ::exr::prelude::f16;
use proptest::prelude::*;

use super::*;
use crate::image::frame::NO_ID;

fn bits(frame: &Frame) -> Vec<(Channel, Vec<u32>)> {
    let plane_bits = |plane: &Plane| match plane {
        Plane::F32(values) => values.iter().map(|v| v.to_bits()).collect(),
        Plane::U32(values) => values.clone(),
    };
    frame.planes.iter().map(|(channel, plane)| (*channel, plane_bits(plane))).collect()
}

/// A frame of every channel, with the values that break easily among plain ones.
fn sample(width: u32, height: u32) -> Frame {
    let odd = [f32::INFINITY, f32::NEG_INFINITY, f32::NAN, -0.0, 1e-40, f32::MAX];
    let count = width * height;
    let plane = |channel: Channel| match channel {
        c if c.is_id() => {
            Plane::U32((0..count).map(|i| if i % 3 == 0 { NO_ID } else { i.wrapping_mul(12_345_678) }).collect())
        }
        _ => Plane::F32((0..count).map(|i| odd.get(i as usize % 11).copied().unwrap_or(1.0 / i as f32)).collect()),
    };
    Frame { width, height, planes: Channel::ALL.into_iter().map(|c| (c, plane(c))).collect() }
}

fn in_folder<T>(test: impl FnOnce(&Path) -> T) -> T {
    let dir = tempfile::tempdir().unwrap();
    test(&dir.path().join("a.exr"))
}

/// An EXR with one channel written by the library alone.
fn write_foreign(path: &Path, name: &str, samples: FlatSamples) {
    let channels = AnyChannels::sort([AnyChannel::new(name, samples)].into_iter().collect());
    Image::from_channels((2, 1), channels).write().to_file(path).unwrap();
}

#[test]
fn every_channel_round_trips_bit_for_bit() {
    in_folder(|path| {
        for (width, height) in [(1, 1), (37, 19), (128, 65)] {
            let frame = sample(width, height);
            write_exr(path, &frame, &[]).unwrap();
            let back = read_exr(path, &Loading::default()).unwrap();
            assert_eq!((back.width, back.height), (width, height));
            assert_eq!(bits(&back), bits(&frame));
        }
    });
}

#[test]
fn attributes_are_kept_and_bytes_repeat() {
    in_folder(|path| {
        let attributes: Vec<(String, String)> =
            (0..20).map(|i| (format!("anamorph.{i}"), format!("value {i} \u{e9}\u{4e00}"))).collect();
        let frame = sample(9, 5);
        write_exr(path, &frame, &attributes).unwrap();
        let first = std::fs::read(path).unwrap();
        for _ in 0..5 {
            write_exr(path, &frame, &attributes).unwrap();
            assert_eq!(std::fs::read(path).unwrap(), first);
        }
        let image = ::exr::prelude::read_first_flat_layer_from_file(path).unwrap();
        for (name, text) in &attributes {
            let value = image.layer_data.attributes.other.get(&Text::from_slice_unchecked(name.as_bytes()));
            assert_eq!(value, Some(&AttributeValue::Text(Text::from_slice_unchecked(text.as_bytes()))));
        }
        assert_eq!(bits(&read_exr(path, &Loading::default()).unwrap()), bits(&frame));
    });
}

#[test]
fn frames_that_cannot_be_written_leave_no_file() {
    in_folder(|path| {
        let short = Frame { width: 2, height: 2, planes: vec![(Channel::R, Plane::F32(vec![0.0; 3]))] };
        let twice = Frame { width: 1, height: 1, planes: vec![(Channel::R, Plane::F32(vec![0.0])); 2] };
        let none = Frame { width: 1, height: 1, planes: vec![] };
        let empty = Frame { width: 0, height: 0, planes: vec![(Channel::R, Plane::F32(vec![]))] };
        for frame in [short, twice, none, empty] {
            assert!(matches!(write_exr(path, &frame, &[]), Err(Error::Work(_) | Error::Write(_))));
        }
        for name in ["", "compression", "a\0b", &"x".repeat(300)] {
            let attribute = (name.to_string(), "x".to_string());
            let written = write_exr(path, &sample(2, 2), &[attribute]);
            assert!(matches!(written, Err(Error::Work(_) | Error::Write(_))), "{name}");
        }
        assert_eq!(std::fs::read_dir(path.parent().unwrap()).unwrap().count(), 0);
    });
}

#[test]
fn other_programs_files_are_read_as_far_as_they_go() {
    in_folder(|path| {
        write_foreign(path, "Z", FlatSamples::F16(vec![f16::from_f32(1.5), f16::INFINITY]));
        assert_eq!(read_exr(path, &Loading::default()).unwrap().f32(Channel::Z), Some(&[1.5, f32::INFINITY][..]));
        for (name, samples, why) in [
            ("diffuse.R", FlatSamples::F32(vec![1.0, 2.0]), "none of its channels is known"),
            ("triangle.id", FlatSamples::F32(vec![1.0, 2.0]), "must be of type UINT"),
            ("R", FlatSamples::U32(vec![1, 2]), "must be of type FLOAT or HALF"),
        ] {
            write_foreign(path, name, samples);
            let error = read_exr(path, &Loading::default()).unwrap_err();
            assert!(error.exit_code() == 2 && error.to_string().contains(why), "{error}");
        }
        // cropped to the second column
        let samples = AnyChannel::new("Z", FlatSamples::F32(vec![1.0, 2.0]));
        let mut image = Image::from_channels((2, 1), AnyChannels::sort([samples].into_iter().collect()));
        image.layer_data.attributes.layer_position = ::exr::prelude::Vec2(1, 0);
        image.write().to_file(path).unwrap();
        let error = read_exr(path, &Loading::default()).unwrap_err();
        assert!(
            error.exit_code() == 2 && error.to_string().contains("its data window is not its display window"),
            "{error}"
        );
    });
}

#[test]
fn files_that_are_no_exr_are_input_errors() {
    in_folder(|path| {
        assert!(
            matches!(read_exr(path, &Loading::default()), Err(Error::Missing(text)) if text.contains("cannot be read"))
        );
        for bytes in [&b""[..], b"v 0 0 0", &[0x76, 0x2f, 0x31, 0x01], &[0x76, 0x2f, 0x31, 0x01, 2, 0, 0, 0]] {
            std::fs::write(path, bytes).unwrap();
            assert!(matches!(read_exr(path, &Loading::default()), Err(Error::Input(_))));
        }
        assert!(matches!(read_exr(path.parent().unwrap(), &Loading::default()), Err(Error::Read(_))));
    });
}

#[test]
fn a_cut_file_is_an_error_at_every_length() {
    in_folder(|path| {
        write_exr(path, &sample(5, 40), &[]).unwrap();
        let whole = std::fs::read(path).unwrap();
        for keep in (0..whole.len()).step_by(17) {
            std::fs::write(path, &whole[..keep]).unwrap();
            assert!(matches!(read_exr(path, &Loading::default()), Err(Error::Input(_))), "{keep} of {}", whole.len());
        }
    });
}

/// The lossless and lossy compressions that the library reads.
const COMPRESSIONS: [Compression; 8] = [
    Compression::Uncompressed,
    Compression::RLE,
    Compression::ZIP1,
    Compression::ZIP16,
    Compression::PIZ,
    Compression::PXR24,
    Compression::B44,
    Compression::B44A,
];

/// `frame`'s channels with any compression, in scan lines or in tiles.
fn write_compressed(path: &Path, frame: &Frame, compression: Compression, tiled: bool) {
    let size = (frame.width as usize, frame.height as usize);
    let channels =
        frame.planes.iter().map(|(c, p)| channel_from(c.name(), p.clone(), size.0 * size.1).unwrap()).collect();
    let blocks = if tiled { Blocks::Tiles((4, 4).into()) } else { Blocks::ScanLines };
    let encoding = Encoding { compression, blocks, line_order: LineOrder::Increasing };
    let layer = Layer::new(size, LayerAttributes::default(), encoding, AnyChannels::sort(channels));
    Image::from_layer(layer).write().to_file(path).unwrap();
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn damaged_files_never_panic(
        at in any::<prop::sample::Index>(),
        put in any::<[u8; 4]>(),
        size in (1..9u32, 1..40u32),
        compression in prop::sample::select(&COMPRESSIONS[..]),
        tiled in any::<bool>(),
    ) {
        in_folder(|path| {
            write_compressed(path, &sample(size.0, size.1), compression, tiled);
            let mut bytes = std::fs::read(path).unwrap();
            let at = at.index(bytes.len() - put.len());
            bytes[at..at + put.len()].copy_from_slice(&put);
            std::fs::write(path, bytes).unwrap();
            let _ = read_exr(path, &Loading::default());
        });
    }
}

/// A frame's rows `first .. first + count`.
fn strip(frame: &Frame, first: u32, count: u32) -> Frame {
    let range = (first * frame.width) as usize..((first + count) * frame.width) as usize;
    let cropped = |plane: &Plane| match plane {
        Plane::F32(values) => Plane::F32(values[range.clone()].to_vec()),
        Plane::U32(values) => Plane::U32(values[range.clone()].to_vec()),
    };
    Frame { width: frame.width, height: count, planes: frame.planes.iter().map(|(c, p)| (*c, cropped(p))).collect() }
}

#[test]
fn strips_make_the_whole_image_as_tiles() {
    use super::tiled::{TILE, write_exr_tiled};
    let texts = vec![("anamorph.a".to_owned(), "b".to_owned())];
    let own = Attributes { texts, world_to_camera: Some([0.5; 16]), world_to_ndc: None };
    for (width, height, rows) in [(70, 150, TILE), (64, 64, TILE), (3, 200, 2 * TILE), (130, 10, TILE)] {
        let whole = sample(width, height);
        let channels: Vec<Channel> = whole.planes.iter().map(|(channel, _)| *channel).collect();
        let write = |path: &Path| {
            let mut first = 0;
            write_exr_tiled(path, (width, height), &channels, &own, || {
                let own = strip(&whole, first, rows.min(height - first));
                first += rows;
                Ok(own)
            })
        };
        in_folder(|path| {
            write(path).unwrap();
            assert_eq!(bits(&read_exr(path, &Loading::default()).unwrap()), bits(&whole));
            let bytes = std::fs::read(path).unwrap();
            write(path).unwrap();
            assert!(std::fs::read(path).unwrap() == bytes);
            // what goes wrong with a strip leaves the file as it was
            let failed =
                write_exr_tiled(path, (width, height), &channels, &Attributes::default(), || Err(Error::work("lost")));
            assert_eq!(failed, Err(Error::work("lost")));
            let other = write_exr_tiled(path, (width, height), &channels, &Attributes::default(), || {
                Ok(sample(width + 1, TILE))
            });
            assert!(other.unwrap_err().to_string().contains("is none of this image"));
            assert!(std::fs::read(path).unwrap() == bytes);
        });
    }
}
