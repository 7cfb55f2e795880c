use super::*;
use tiff::encoder::{TiffEncoder, colortype};
use tiff::tags::Tag;

fn spec(cell: Option<DVec2>) -> HeightSpec {
    HeightSpec { file: "dem.asc".into(), height_scale: 2.0, cell }
}

/// 3 x 2 samples, one without data.
const ASC: &str =
    "NCOLS 3\nnrows 2\nxllcorner 500000\nYLLCENTER 4000000\ncellsize 10\nNODATA_value -1\n1 2 3\n4 5 -1\n";

#[test]
fn ascii_grids_are_read_from_the_north_west() {
    let grid = asc::read(ASC.as_bytes()).unwrap();
    assert_eq!((grid.columns, grid.rows), (3, 2));
    assert!(grid.samples[..5] == [1.0, 2.0, 3.0, 4.0, 5.0] && grid.samples[5].is_nan());
    let place = grid.georeference.unwrap();
    assert_eq!((place.cell, place.middle), (DVec2::splat(10.0), DVec2::new(500_015.0, 4_000_005.0)));
    let mesh = mesh(&grid, &spec(None), Limits::default()).unwrap();
    let at = |x, y, z| DVec3::new(x, y, z);
    let corners = [at(-10., 2., -5.), at(0., 4., -5.), at(10., 6., -5.), at(-10., 8., 5.), at(0., 10., 5.)];
    assert_eq!(mesh.positions, corners);
    // both triangles of the second cell lack a corner
    assert_eq!(mesh.triangles, [[0, 3, 4], [0, 4, 1]]);
    for [a, b, c] in mesh.triangles.iter().map(|t| t.map(|i| mesh.positions[i as usize])) {
        assert!((b - a).cross(c - a).y > 0.0);
    }
    // slopes of 2 in 10 to the east and 6 in 10 to the south, also where a neighbour is missing
    let normal = Vec3::new(-0.2, 1.0, -0.6).normalize();
    assert!(mesh.normals.iter().filter(|n| (**n - normal).length() < 1e-6).count() >= 4, "{:?}", mesh.normals);
    assert_eq!(mesh.uvs[0], Vec2::new(0.5 / 3.0, 0.75));
}

#[test]
fn cells_may_be_given() {
    let mesh = mesh(&asc::read(ASC.as_bytes()).unwrap(), &spec(Some(DVec2::new(1.0, 3.0))), Limits::default()).unwrap();
    assert_eq!(mesh.bounds(), Some((DVec3::new(-1.0, 2.0, -1.5), DVec3::new(1.0, 10.0, 1.5))));
}

#[test]
fn wrong_grids_say_what_is_wrong() {
    let header = "ncols 2\nnrows 2\ncellsize 1\n";
    for (text, says) in [
        ("", "ncols is missing"),
        ("ncols 2\n1 2\n3 4\n", "nrows is missing"),
        ("ncols two\n", "line 1: ncols: expected a whole number, found \"two\""),
        ("ncols -2\n", "line 1: ncols: expected a whole number"),
        ("ncols\n", "line 1: expected a key and its number"),
        ("hello 3\n", "line 1: unknown key \"hello\""),
        ("ncols 1\nnrows 9\n", "1 x 9 heights make no cell"),
        ("ncols 100000\nnrows 100000\n", "over 2^28 triangles"),
        ("ncols 18446744073709551615\nnrows 18446744073709551615\n", "over 2^28 triangles"),
        ("ncols 10000\nnrows 10000\n1 2\n", "ends early"),
        ("ncols 2\nnrows 2\ncellsize 0\n", "cellsize: 0 is not a size"),
        (&format!("{header}1 2\n3\n"), "the header says 2 x 2 heights, found 3"),
        (&format!("{header}1 2\n3 4 5\n"), "line 5: more than the 2 x 2 heights of the header"),
        (&format!("{header}1 2\n3 x\n"), "line 5: expected a number, found \"x\""),
    ] {
        let error = asc::read(text.as_bytes()).unwrap_err();
        assert!(error.contains(says), "{text}: {error}");
    }
    // a first height of NaN is no key
    let nan = asc::read(format!("{header}NODATA_value nan\n  nan 2\n3 4\n").as_bytes()).unwrap();
    assert!(nan.samples[0].is_nan() && nan.samples[1..] == [2.0, 3.0, 4.0]);
    let none = asc::read(format!("{header}1 2\n-9999 -9999\n").as_bytes()).unwrap();
    assert!(mesh(&none, &spec(None), Limits::default()).unwrap_err().to_string().contains("no surface"));
    assert!(
        read(Path::new("missing.asc"), &Loading::default())
            .unwrap_err()
            .to_string()
            .contains("missing.asc: cannot be read")
    );
}

#[test]
fn gray_pngs_are_heights() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.png");
    image::ImageBuffer::<image::Luma<u16>, _>::from_raw(2, 2, vec![0u16, 1, 300, 65535]).unwrap().save(&path).unwrap();
    let grid = read(&path, &Loading::default()).unwrap();
    assert_eq!(grid, Grid { columns: 2, rows: 2, samples: vec![0.0, 1.0, 300.0, 65535.0], georeference: None });
    image::GrayImage::from_raw(2, 2, vec![1, 2, 3, 255]).unwrap().save(&path).unwrap();
    assert_eq!(read(&path, &Loading::default()).unwrap().samples, [1.0, 2.0, 3.0, 255.0]);
    image::GrayAlphaImage::from_raw(2, 2, vec![1, 255, 2, 1, 3, 0, 4, 9]).unwrap().save(&path).unwrap();
    let samples = read(&path, &Loading::default()).unwrap().samples;
    assert!([samples[0], samples[1], samples[3]] == [1.0, 2.0, 4.0] && samples[2].is_nan());
    image::RgbImage::new(2, 2).save(&path).unwrap();
    assert!(read(&path, &Loading::default()).unwrap_err().to_string().contains("is in colour"));
    // a decoder would turn heights of 0 to 15 into 0 to 255
    let mut encoder = png::Encoder::new(std::fs::File::create(&path).unwrap(), 2, 2);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(png::BitDepth::Four);
    encoder.write_header().unwrap().write_image_data(&[0x12, 0x3f]).unwrap();
    assert!(read(&path, &Loading::default()).unwrap_err().to_string().contains("fewer than 8 bits"));
    std::fs::write(&path, "P5").unwrap();
    assert!(read(&path, &Loading::default()).unwrap_err().to_string().contains("no PNG"));
}

/// A TIFF of 3 x 2 floats with these GeoKeys. One float has no data, with the digits that GDAL writes.
fn geotiff(keys: &[u16], tie: &[f64]) -> std::result::Result<Grid, String> {
    geotiff_without(keys, tie, "-3.4028234663852886e+38")
}

fn geotiff_without(keys: &[u16], tie: &[f64], no_data: &str) -> std::result::Result<Grid, String> {
    let mut bytes = Cursor::new(Vec::new());
    let mut tiff = TiffEncoder::new(&mut bytes).unwrap();
    let mut image = tiff.new_image::<colortype::Gray32Float>(3, 2).unwrap();
    let tags = image.encoder();
    tags.write_tag(Tag::ModelPixelScaleTag, &[30.0, 20.0, 0.0][..]).unwrap();
    tags.write_tag(Tag::ModelTiepointTag, tie).unwrap();
    tags.write_tag(Tag::GeoKeyDirectoryTag, keys).unwrap();
    tags.write_tag(Tag::GdalNodata, no_data).unwrap();
    image.write_data(&[1.5, 2.0, f32::MIN, 4.0, f32::NAN, 6.0]).unwrap();
    geotiff::read(&bytes.into_inner())
}

#[test]
fn geotiffs_say_where_they_are() {
    let (area, point, degrees) =
        ([1, 1, 0, 1, 1025, 0, 1, 1], [1, 1, 0, 1, 1025, 0, 1, 2], [1, 1, 0, 1, 1024, 0, 1, 2]);
    let tie = [0.0, 0.0, 0.0, 1000.0, 5000.0, 0.0];
    let grid = geotiff(&area, &tie).unwrap();
    assert_eq!((grid.columns, grid.rows), (3, 2));
    assert!([0, 1, 3, 5].map(|k| grid.samples[k]) == [1.5, 2.0, 4.0, 6.0]);
    assert!(grid.samples[2].is_nan() && grid.samples[4].is_nan());
    let place = grid.georeference.unwrap();
    assert_eq!((place.cell, place.middle), (DVec2::new(30.0, 20.0), DVec2::new(1045.0, 4980.0)));
    // fewer digits than an f32 needs
    assert!(geotiff_without(&area, &tie, "-3.40282346638529e+38").unwrap().samples[2].is_nan());
    // a tie point inside the image, and pixels that are points
    let moved = [1.0, 2.0, 0.0, 1030.0, 4960.0, 0.0];
    assert_eq!(geotiff(&area, &moved).unwrap().georeference, Some(place));
    assert_eq!(geotiff(&point, &tie).unwrap().georeference.unwrap().middle, DVec2::new(1030.0, 4990.0));
    let in_degrees = geotiff(&degrees, &tie).unwrap();
    assert!(mesh(&in_degrees, &spec(None), Limits::default()).unwrap_err().to_string().contains("30 x 20 degrees"));
    assert!(
        mesh(&in_degrees, &spec(Some(DVec2::ONE)), Limits::default())
            .is_err_and(|e| e.to_string().contains("no surface"))
    );
    assert!(geotiff::read(b"II*\0").is_err_and(|e| e.contains("no TIFF")));
    let mut bytes = Cursor::new(Vec::new());
    TiffEncoder::new(&mut bytes).unwrap().write_image::<colortype::RGB8>(2, 2, &[0; 12]).unwrap();
    assert!(geotiff::read(&bytes.into_inner()).is_err_and(|e| e.contains("one band")));
}
