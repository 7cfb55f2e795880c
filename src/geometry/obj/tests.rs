use std::io::Cursor;

use glam::DVec3;
use proptest::prelude::*;

use super::*;
use crate::testing::model;

fn parse_text(text: &str) -> Result<Mesh> {
    parse(text.as_bytes(), "cow.obj", CHUNK_BYTES, |_| Ok(Vec::new())).map(|(mesh, _)| mesh)
}

fn message_of(text: &str) -> String {
    match parse_text(text) {
        Err(Error::Input(message)) => message,
        other => panic!("{text}: {other:?}"),
    }
}

const QUAD: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

#[test]
fn every_face_form_gives_the_same_triangles() {
    let shared = format!("{QUAD}vt 0 0\nvn 0 0 2\n");
    for face in [
        "f 1 2 3 4",
        "f 1/1 2/1 3/1 4/1",
        "f 1//1 2//1 3//1 4//1",
        "f 1/1/1 2/1/1 3/1/1 4/1/1",
        "f -4 -3 -2 -1",
        "f -4/-1/-1 -3/-1/-1 -2/-1/-1 -1/-1/-1 # c",
        "f 1 2 \\\n 3 4",
        "fo 1 2 3 4",
        "l 1 2\np 1\nf 1 2 3 4",
        "s off\ng a b\no c\ncurv 1 2\nf 1 2 3 4\r\n\r\n",
    ] {
        let mesh = parse_text(&format!("{shared}{face}")).unwrap();
        assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3]], "{face}");
        assert_eq!(mesh.material_of, [0, 0]);
        assert_eq!(mesh.materials, [Material::default()]);
        let has_normals = face.contains("/1/1") || face.contains("//") || face.contains("/-1/");
        assert_eq!(mesh.corner_normals.len(), if has_normals { 2 } else { 0 }, "{face}");
        assert_eq!(mesh.normals, if has_normals { vec![Vec3::Z] } else { vec![] });
    }
}

#[test]
fn corners_without_a_usable_normal_have_none() {
    let text = format!("{QUAD}vn 0 0 0\nvn 3e200 0 0\nvn nan 0 0\nf 1 2 3\nf 1//2 2 3//1\nf 1//3 2//3 3//3\nf 1 2 3");
    let mesh = parse_text(&text).unwrap();
    let none = [NO_NORMAL; 3];
    assert_eq!(mesh.corner_normals, [none, [1, NO_NORMAL, NO_NORMAL], none, none]);
    assert!(mesh.normals.iter().all(|n| n.is_normalized()));
    assert_eq!(mesh.normals[1], Vec3::X);
    let mesh = parse_text(&format!("{QUAD}vn 0 0 0\nf 1//1 2//1 3//1")).unwrap();
    assert!(mesh.normals.is_empty() && mesh.corner_normals.is_empty());
}

#[test]
fn relative_indices_count_from_where_they_stand() {
    let text = format!("{QUAD}f -4 -3 -2\nv 5 5 5\nf -1 -2 -3\nv 6 6 6\nf 1 2 6");
    assert_eq!(parse_text(&text).unwrap().triangles, [[0, 1, 2], [4, 3, 2], [0, 1, 5]]);
}

#[test]
fn colours_weights_and_zero_area_are_kept_or_skipped() {
    let mesh = parse_text("v 0 0 0 1\nv 1 0 0 0.5 0.5 0.5\nv\t2 0 0 1 1 1 1\nf 1 2 3\nf 1 1 2").unwrap();
    assert_eq!(mesh.positions, [DVec3::ZERO, DVec3::X, DVec3::X * 2.0]);
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 0, 1]]);
}

#[test]
fn line_ends_and_byte_order_marks_do_not_matter() {
    let text = format!("{QUAD}f 1 2 3 4\n");
    let expected = parse_text(&text).unwrap();
    for other in [text.replace('\n', "\r\n"), text.replace('\n', "\r"), format!("\u{FEFF}{text}")] {
        assert_eq!(parse_text(&other).unwrap(), expected);
    }
}

#[test]
fn wrong_text_names_file_line_and_remedy() {
    for (line, expected) in [
        ("v 1 2", "cow.obj:5: has 2 of 3 coordinates"),
        ("v 1 2 # 3", "cow.obj:5: has 2 of 3 coordinates"),
        ("v 1 x 2", "cow.obj:5: coordinate \"x\" is not a number"),
        ("v 1 nan 2\nf 1 2 5", "cow.obj:5: vertex coordinate is not finite"),
        ("v 1 1e999 2\nf 5 2 1", "cow.obj:5: vertex coordinate is not finite"),
        ("vn 1 2", "cow.obj:5: has 2 of 3 coordinates"),
        ("f 0 1 2", "cow.obj:5: face's vertex index is 0; indices start at 1"),
        ("f 1 2 5", "cow.obj:5: face's vertex index 5 out of range; 1 to 4 exist"),
        ("f 1 2 -5", "cow.obj:5: face's vertex index -5 out of range; -1 to -4 exist up to here"),
        ("f 1//0 2 3", "cow.obj:5: face's normal index is 0"),
        ("f 1/0 2 3", "cow.obj:5: face's texture coordinate index is 0"),
        ("f 1.5 2 3", "cow.obj:5: face's vertex index \"1.5\" is not an integer"),
        ("f 1 2 \\\n99", "cow.obj:5: face's vertex index 99 out of range"),
        ("g \\\n\nf a b c", "cow.obj:7: face's vertex index \"a\" is not"),
    ] {
        let message = message_of(&format!("{QUAD}{line}\nf 1 2 3\n"));
        assert!(message.starts_with(expected), "{line}: {message}");
        assert!(!message.contains('\n') && message.len() < 100, "{message}");
    }
    assert!(message_of("").starts_with("cow.obj: is empty"));
    assert!(message_of("# nothing\n\n").starts_with("cow.obj: has no OBJ statements"));
    assert!(message_of("\u{1}\u{2}\u{7f}garbage").starts_with("cow.obj: has no OBJ statements"));
    assert!(message_of("v 0 0 0\0").starts_with("cow.obj: is binary"));
    assert!(message_of(QUAD).starts_with("cow.obj: has no faces"));
    let missing = load(Path::new("no/such.obj"), &mut Images::default(), &Loading::default()).unwrap_err().to_string();
    assert!(missing.starts_with("no/such.obj: cannot be read"), "{missing}");
}

#[test]
fn texture_coordinates_are_kept_and_lie_as_their_materials_say() {
    let text = format!(
        "{QUAD}vt 0 0\nvt 1\nvt 0.5 1 0\nvt nan 0\nmtllib a.mtl\nf 1 2 3\nf 1/1 2/2 3/3\nf 1/1 2/4 3\nusemtl moved\nf 1/1 2/2 3/3\nf 1 2 3"
    );
    let load = |text: &str| {
        parse(text.as_bytes(), "a.obj", CHUNK_BYTES, |_| {
            mtl::parse(b"newmtl plain\nnewmtl moved\nmap_Kd -s 2 4 -o 0.5 0.25 a.png", Path::new("a.mtl"))
        })
        .unwrap()
        .0
    };
    for bytes in [1, 20, 1 << 20] {
        let mesh = parse(text.as_bytes(), "a", bytes, |_| Ok(Vec::new())).unwrap().0;
        let none = [NO_UV; 3];
        assert_eq!(mesh.corner_uvs, [none, [0, 1, 2], none, [0, 1, 2], none]);
        assert_eq!(mesh.uvs_of(1), Some([Vec2::ZERO, Vec2::X, Vec2::new(0.5, 1.0)]));
        assert_eq!((mesh.uvs_of(0), mesh.uvs_of(2)), (None, None));
    }
    let mesh = load(&text);
    assert_eq!(mesh.uvs_of(1), Some([Vec2::ZERO, Vec2::X, Vec2::new(0.5, 1.0)]));
    assert_eq!(mesh.uvs_of(3), Some([Vec2::new(0.5, 0.25), Vec2::new(2.5, 0.25), Vec2::new(1.5, 4.25)]));
    assert!(parse_text(&format!("{QUAD}f 1 2 3")).unwrap().corner_uvs.is_empty());
    assert!(message_of(&format!("{QUAD}vt x\nf 1 2 3")).starts_with("cow.obj:5: coordinate \"x\" is not a number"));
}

#[test]
fn the_first_wrong_line_is_named_whatever_the_chunks() {
    let text = format!("{QUAD}f 1 2 3\nf 1 2 9\nf 1 2\nv 1\n");
    for bytes in 1..text.len() {
        let message = parse(text.as_bytes(), "a", bytes, |_| Ok(Vec::new())).unwrap_err().to_string();
        assert!(message.starts_with("a:6: "), "{message}");
    }
}

const GROUPED: &str = "\
# two groups, a material set before any object, an unknown one
mtllib city.mtl
v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
v 0 0 1.5
usemtl roof
o house
f 1 2 3 4
g a
usemtl wall
f 1 2 5
f 2 3 5
o shed
f 3 4 5
usemtl roof
f 4 1 5
";
const GROUPED_MTL: &[u8] = b"newmtl wall\nKd 0.5 0.25 0.125\nnewmtl roof\nKd 1 0 0\n";

#[test]
fn materials_run_across_groups_and_chunks() {
    for bytes in [1, 7, 20, 64, 1 << 20] {
        let mesh = parse(GROUPED.as_bytes(), "a", bytes, |libraries| {
            assert_eq!(libraries, ["city.mtl"]);
            mtl::parse(GROUPED_MTL, Path::new(libraries[0]))
        })
        .unwrap()
        .0;
        assert_eq!(mesh.material_of, [1, 1, 0, 0, 0, 1]);
        assert_eq!(mesh.materials.len(), 2);
        let unknown = parse(GROUPED.as_bytes(), "a", bytes, |_| Ok(Vec::new())).unwrap().0;
        assert_eq!(unknown.materials, [Material::default()]);
    }
}

#[test]
fn some_unknown_materials_are_the_default_one() {
    let text = format!("f 1 2 3\n{QUAD}mtllib a.mtl\nusemtl wall\nf 1 2 3\nusemtl other\nf 1 2 4\nusemtl\nf 1 2 4");
    let mesh = parse(text.as_bytes(), "a", CHUNK_BYTES, |_| mtl::parse(GROUPED_MTL, Path::new("a.mtl"))).unwrap().0;
    assert_eq!(mesh.material_of, [2, 0, 2, 2]);
    assert_eq!(mesh.materials[2], Material::default());
}

#[test]
fn material_files_lie_beside_the_obj() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("my walls.mtl", "newmtl a\nKd 1 0 0\n");
    write("b.mtl", "newmtl b\nKd 0 1 0\n");
    write("bad.mtl", "newmtl b\nKd 0\n\nKd 0 y 0\n");
    write("good.obj", &format!("mtllib my walls.mtl\nmtllib b.mtl none.mtl\n{QUAD}usemtl b\nf 1 2 3"));
    write("bad.obj", &format!("mtllib bad.mtl\n{QUAD}f 1 2 3"));
    let mesh = load(&folder.path().join("good.obj"), &mut Images::default(), &Loading::default()).unwrap();
    assert_eq!((mesh.materials.len(), &mesh.material_of[..]), (2, &[1][..]));
    let message =
        load(&folder.path().join("bad.obj"), &mut Images::default(), &Loading::default()).unwrap_err().to_string();
    assert!(message.contains("bad.mtl:4: Kd value \"y\""), "{message}");
}

/// An image that cannot be read is an error only if a face has it and images of its kind are read.
#[test]
fn images_that_are_not_needed_are_not_read() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("bad.png"), "no image").unwrap();
    let text = "newmtl bad\nmap_Kd bad.png\nnewmtl plain\nKd 1 0 0\nnewmtl masked\nKd 1 0 0\nmap_d bad.png";
    std::fs::write(folder.path().join("a.mtl"), text).unwrap();
    let load = |used: &str, read: ImagesRead| {
        let path = folder.path().join("a.obj");
        std::fs::write(&path, format!("mtllib a.mtl\n{QUAD}usemtl {used}\nf 1 2 3")).unwrap();
        load(&path, &mut Images::of(read), &Loading::default())
            .map(|mesh| mesh.materials[mesh.material_of[0] as usize].diffuse)
    };
    for read in [ImagesRead::All, ImagesRead::Masks, ImagesRead::None] {
        load("plain", read).unwrap();
    }
    assert_eq!(load("bad", ImagesRead::Masks), Ok([1.0; 3]));
    assert_eq!(load("bad", ImagesRead::None), Ok([0.8; 3]));
    load("masked", ImagesRead::None).unwrap();
    for (used, read) in [("bad", ImagesRead::All), ("masked", ImagesRead::All), ("masked", ImagesRead::Masks)] {
        let message = load(used, read).unwrap_err().to_string();
        let line = if used == "bad" { "a.mtl:2: map_Kd: " } else { "a.mtl:7: map_d: " };
        assert!(message.contains(line) && message.ends_with("; texture = false shows none"), "{message}");
    }
}

#[test]
fn missing_images_are_listed_and_left_out() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.mtl"), "newmtl gone\nKd 0 0.5 1\nmap_Kd no.png").unwrap();
    let path = folder.path().join("a.obj");
    std::fs::write(&path, format!("mtllib a.mtl\n{QUAD}usemtl gone\nf 1 2 3")).unwrap();
    let mesh = load(&path, &mut Images::default(), &Loading::default()).unwrap();
    assert_eq!((mesh.materials[0].diffuse, &mesh.materials[0].texture), ([0.0, 0.5, 1.0], &None));
    let [missing] = &mesh.missing[..] else { panic!("{:?}", mesh.missing) };
    assert!(missing.what.ends_with("no.png"), "{missing:?}");
    assert!(missing.why.contains("a.mtl:3: map_Kd: the file does not exist; the material's own colour"), "{missing:?}");
    let masked = load(&path, &mut Images::of(ImagesRead::Masks), &Loading::default()).unwrap();
    assert_eq!((masked.missing, masked.materials), (vec![], mesh.materials));
}

/// Also if it is named by different paths. Its place among the libraries is that of the last time.
#[test]
fn a_library_that_is_named_often_is_read_once() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("a.mtl", "newmtl x\nKd 1 0 0\nnewmtl y\n");
    write("b.mtl", "newmtl x\nKd 0 1 0\n");
    let often = "mtllib a.mtl\nmtllib b.mtl ./a.mtl\n".repeat(1000);
    for (last, diffuse) in [("", [1.0, 0.0, 0.0]), ("mtllib b.mtl\n", [0.0, 1.0, 0.0])] {
        write("o.obj", &format!("{often}{last}{QUAD}usemtl x\nf 1 2 3"));
        let mesh = load(&folder.path().join("o.obj"), &mut Images::default(), &Loading::default()).unwrap();
        assert_eq!(mesh.materials.len(), 3);
        assert_eq!(mesh.materials[mesh.material_of[0] as usize].diffuse, diffuse);
    }
}

#[test]
fn missing_normals_and_texture_coordinates_are_listed_and_left_out() {
    let text = format!("{QUAD}vn 0 0 1\nvt 0 0\nf 1//1 2//2 3//1\nf 1/1 2/-2 3/1\nf 1/1 2/1 3/1\nf 1//-2 2//1 4//9");
    for bytes in [1, 30, 1 << 20] {
        let mesh = parse(text.as_bytes(), "a.obj", bytes, |_| Ok(Vec::new())).unwrap().0;
        let none = NO_NORMAL;
        assert_eq!(mesh.corner_normals, [[0, none, 0], [none; 3], [none; 3], [none, 0, none]]);
        assert_eq!(mesh.corner_uvs, [[NO_UV; 3], [NO_UV; 3], [0; 3], [NO_UV; 3]]);
        let said: Vec<_> = mesh.missing.iter().map(|m| format!("{}: {}", m.what, m.why)).collect();
        let expected = [
            "normals of a.obj: missing at 3 corners of faces, first in line 7: \
             face's normal index 2 out of range; 1 to 1 exist",
            "texture coordinates of a.obj: missing at 1 corner of faces, first in line 8: \
             face's texture coordinate index -2 out of range; -1 to -1 exist up to here",
        ];
        assert_eq!(said, expected);
    }
    let mesh = parse_text(&format!("{QUAD}f 1/1/1 2/2/2 3/3/3")).unwrap();
    assert!(mesh.corner_normals.is_empty() && mesh.corner_uvs.is_empty() && mesh.missing.len() == 2);
}

/// Compares with tobj, which splits by group and reads f32: triangle by triangle.
fn assert_agrees_with_tobj(text: &[u8], mtl: &[u8]) {
    let mesh = parse(text, "a", CHUNK_BYTES, |_| mtl::parse(mtl, Path::new("a.mtl"))).unwrap().0;
    let options = tobj::LoadOptions { triangulate: true, ..Default::default() };
    let (models, materials) =
        tobj::load_obj_buf(&mut Cursor::new(text), &options, |_| tobj::load_mtl_buf(&mut Cursor::new(mtl))).unwrap();
    let materials = materials.unwrap();
    assert_eq!(models.iter().map(|m| m.mesh.indices.len() / 3).sum::<usize>(), mesh.triangles.len());
    let mut triangle = 0;
    for model in models.iter().map(|m| &m.mesh) {
        for corners in model.indices.chunks(3) {
            for (corner, &theirs) in corners.iter().enumerate() {
                let ours = mesh.positions[mesh.triangles[triangle][corner] as usize].as_vec3().to_array();
                assert_eq!(ours, model.positions[theirs as usize * 3..][..3], "triangle {triangle}");
            }
            if let Some(id) = model.material_id {
                assert_eq!(mesh.material_of[triangle] as usize, id);
                assert_eq!(Some(mesh.materials[id].diffuse), materials[id].diffuse);
            }
            triangle += 1;
        }
    }
}

#[test]
fn tobj_reads_the_same() {
    assert_agrees_with_tobj(GROUPED.as_bytes(), GROUPED_MTL);
    let plain =
        format!("mtllib a.mtl\n{QUAD}vt 0 0\nvn 0 0 1\nf 1/1/1 2/1/1 3/1/1 4/1/1\nf -1 -2 -3\nf 1//1 3//1 4//1");
    assert_agrees_with_tobj(plain.as_bytes(), GROUPED_MTL);
}

#[test]
fn models_have_the_counts_of_their_list() {
    for (name, triangles, positions, materials) in [
        ("cow.obj", 5804, 2903, 1),
        ("beast.obj", 64618, 32311, 1),
        ("denhaag/denhaag.obj", 41187, 22997, 4),
        ("delft/delft.obj", 36271, 18262, 7),
        ("spot/cow.obj", 5856, 2930, 1),
        ("stadium/stadium.obj", 11978, 6190, 3),
        ("kaykit-city/building_F.obj", 1389, 1161, 1),
        ("suzanne.obj", 968, 507, 1),
    ] {
        let Some(path) = model(name) else { continue };
        let mesh = load(&path, &mut Images::default(), &Loading::default()).unwrap();
        let found = (mesh.triangles.len(), mesh.positions.len(), mesh.materials.len());
        assert_eq!(found, (triangles, positions, materials), "{name}");
        assert_eq!(mesh.material_of.len(), triangles);
        assert!(mesh.normals.iter().all(|n| n.is_normalized()));
        let text = std::fs::read(&path).unwrap();
        let folder = path.parent().unwrap();
        let (chunked, _) =
            parse(&text, "a", 1000, |libraries| mtl::load(folder, libraries, &Loading::default())).unwrap();
        let plain = load(&path, &mut Images::left_out(), &Loading::default()).unwrap();
        assert_eq!(plain, chunked, "{name}");
        assert_eq!((mesh.triangles, mesh.uvs), (chunked.triangles, chunked.uvs), "{name}");
    }
}

proptest! {
    #[test]
    fn written_meshes_are_read_bit_for_bit(
        positions in prop::collection::vec(prop::array::uniform3(prop::num::f64::NORMAL | prop::num::f64::ZERO), 3..40),
        faces in prop::collection::vec(prop::array::uniform3(0usize..1000), 1..40),
        chunk_bytes in 1usize..500,
        exponents: bool,
    ) {
        let mut text = String::new();
        for p in &positions {
            text += &if exponents {
                format!("v {:e} {:e} {:e}\n", p[0], p[1], p[2])
            } else {
                format!("v {} {} {}\n", p[0], p[1], p[2])
            };
        }
        let faces: Vec<[u32; 3]> = faces.iter().map(|f| f.map(|i| (i % positions.len()) as u32)).collect();
        for f in &faces {
            text += &format!("f {} {} {}\n", f[0] + 1, i64::from(f[1]) - positions.len() as i64, f[2] + 1);
        }
        let mesh = parse(text.as_bytes(), "a", chunk_bytes, |_| Ok(Vec::new())).unwrap().0;
        let bits = |p: [f64; 3]| p.map(f64::to_bits);
        let found: Vec<_> = mesh.positions.iter().map(|p| bits(p.to_array())).collect();
        prop_assert_eq!(found, positions.iter().copied().map(bits).collect::<Vec<_>>());
        prop_assert_eq!(mesh.triangles, faces);
    }

    #[test]
    fn no_bytes_panic(bytes in prop::collection::vec(any::<u8>(), 0..300), chunk_bytes in 1usize..40) {
        let _ = parse(&bytes, "a", chunk_bytes, |_| Ok(Vec::new()));
        let _ = mtl::parse(&bytes, Path::new("a"));
    }

    #[test]
    fn no_statements_panic(
        text in "((v|vn|vt|f|fo|l|usemtl|mtllib|#)? ?(-?[0-9]{1,2}/?[ /]?){0,4}\\\\?\r?\n?){0,30}",
        chunk_bytes in 1usize..60,
    ) {
        let one = parse(text.as_bytes(), "a", CHUNK_BYTES, |_| Ok(Vec::new())).map(|(mesh, _)| mesh);
        let chunked = parse(text.as_bytes(), "a", chunk_bytes, |_| Ok(Vec::new())).map(|(mesh, _)| mesh);
        prop_assert_eq!(chunked, one);
    }
}

#[test]
fn vertices_of_six_numbers_have_colours() {
    let mesh = parse_text("v 0 0 0 1 0 0\nv 1 0 0 0.5 0 2\nv 1 1 0\nv 0 1 0 2\nf 1 2 3\nf 1 3 4").unwrap();
    assert_eq!(mesh.corner_colors, mesh.triangles);
    assert_eq!((mesh.colors[0], mesh.colors[2], mesh.colors[3]), ([1.0, 0.0, 0.0], [1.0; 3], [1.0; 3]));
    // half of what a display shows is a fifth of its light
    assert!((mesh.colors[1][0] - 0.214).abs() < 0.001 && mesh.colors[1][2] == 1.0, "{:?}", mesh.colors);
    assert_eq!(mesh.materials[0].diffuse, [1.0; 3]);
    assert!(parse_text(&format!("{QUAD}f 1 2 3")).unwrap().colors.is_empty());
    assert!(message_of("v 0 0 0 1 x 0").contains("cow.obj:1: colour \"x\" is not a number"));
    // chunk by chunk
    let lines: String = (0..40).map(|k| format!("v {k} 0 0{}\n", if k % 3 == 0 { " 0 1 0" } else { "" })).collect();
    let text = format!("{lines}f 1 2 3\nf 4 5 40");
    let read = |bytes| parse(text.as_bytes(), "cow.obj", bytes, |_| Ok(Vec::new())).unwrap().0;
    assert_eq!(read(10).colors, read(CHUNK_BYTES).colors);
    assert_eq!(read(10).colors[39], [0.0, 1.0, 0.0]);
}

/// Depth cameras and exporters write parts that are of no use; the rest is read.
#[test]
fn what_no_face_has_may_be_wrong() {
    let mesh = parse_text(&format!("{QUAD}v nan nan inf\nf 1 2\nf\nf 1 2 3\n")).unwrap();
    assert_eq!((&mesh.triangles[..], mesh.positions[4]), (&[[0, 1, 2]][..], mesh.positions[0]));
    let [missing] = &mesh.missing[..] else { panic!("{:?}", mesh.missing) };
    assert_eq!(missing.what, "vertices of cow.obj");
    assert_eq!(missing.why, "missing at 2 faces, first in line 6: face has 2 of at least 3 vertices");
    let mesh = parse_text("v 0 0 0 nan nan nan\nv 1 0 0 1 0 0\nv 0 1 0 0 1 0\nf 1 2 3").unwrap();
    assert_eq!(mesh.colors, [[1.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    assert_eq!(mesh.missing[0].why, "missing at 1 vertex line, first in line 1: it is not finite");
}

#[test]
fn colours_of_bytes_are_told_by_their_size() {
    let of = |colors: [&str; 3]| {
        let [a, b, c] = colors;
        parse_text(&format!("v 0 0 0 {a}\nv 1 0 0 {b}\nv 0 1 0 {c}\nf 1 2 3")).unwrap().colors
    };
    // 188 of 255 is half of the light, to within half a step of a byte: 2.4 / 255 * 0.5 / 0.74 of it
    let bytes = of(["255 0 188", "0 255 0", "1 1 1"]);
    assert!((bytes[0][2] - 0.5).abs() < 0.0032, "{bytes:?}");
    assert_eq!(bytes[..2].iter().map(|c| c[0]).collect::<Vec<_>>(), [1.0, 0.0]);
    // one that is not whole: light over 1 is cut
    assert_eq!(of(["255 0 0.5", "0 1 0", "1 1 1"])[0][..2], [1.0, 0.0]);
    assert_eq!(of(["1 0 0", "0 1 0", "1 1 1"])[2], [1.0; 3]);
}

#[test]
fn objects_or_else_groups_are_parts() {
    let parts = |text: &str| {
        let mesh = parse_text(&format!("{QUAD}{text}")).unwrap();
        mesh.parts.into_iter().map(|part| (part.name, part.triangles)).collect::<Vec<_>>()
    };
    let named = |list: &[(&str, usize)]| list.iter().map(|(n, k)| ((*n).to_owned(), *k)).collect::<Vec<_>>();
    assert_eq!(parts("f 1 2 3\n"), []);
    assert_eq!(
        parts("f 1 2 3\ng a b\nf 1 2 3 4\ng a b\nf 1 2 4\ng c\ng d\nf 1 2 3"),
        named(&[("", 1), ("a b", 3), ("d", 1)])
    );
    assert_eq!(parts("o x\ng a\nf 1 2 3\ng b\nf 1 2 3\no y\nf 1 2 3"), named(&[("x", 2), ("y", 1)]));
}
