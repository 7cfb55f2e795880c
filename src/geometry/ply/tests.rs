use super::*;
use crate::geometry::mesh::NO_NORMAL;
use crate::input::Window;
use glam::{DVec3, Vec2};

/// A square and a triangle beside it, in text, with what else a vertex and a face have.
fn text(vertex: &str, of_vertices: [&str; 5], face: &str, of_faces: [&str; 2]) -> String {
    let places = ["0 0 0", "1 0 0", "1 1 0.1", "0 1 0", "2 0 -5e-1"];
    let vertices: Vec<String> = places.iter().zip(of_vertices).map(|(p, more)| format!("{p} {more}")).collect();
    let faces: Vec<String> =
        ["4 0 1 2 3", "3 1 4 2"].iter().zip(of_faces).map(|(f, more)| format!("{f} {more}")).collect();
    format!(
        "ply\nformat ascii 1.0\ncomment by hand\nelement vertex 5\nproperty double x\nproperty double y\nproperty double z\n{vertex}\
         element face 2\nproperty list uchar int vertex_indices\n{face}end_header\n{}\n{}\n",
        vertices.join("\n"),
        faces.join("\n")
    )
}

fn plain() -> String {
    text("", [""; 5], "", [""; 2])
}

fn mesh(bytes: &[u8]) -> Mesh {
    parsed(bytes).unwrap().0
}

fn parsed(bytes: &[u8]) -> std::result::Result<(Mesh, Vec<String>), String> {
    parsed_in_blocks(bytes, Window::whole(bytes.to_vec()))
}

/// The mesh of a file whose bytes come through a window.
fn parsed_in_blocks(bytes: &[u8], window: Window) -> std::result::Result<(Mesh, Vec<String>), String> {
    let limits = Limits::default();
    let parsed = Header::parse(bytes).and_then(|(header, header_end)| {
        check_sizes(&header, bytes.len() as u64, limits)?;
        parse(&header, Body::new(window, header_end), limits)
    });
    parsed.map_err(|wrong| match wrong {
        Wrong::Line(line, text) => format!("line {line}: {text}"),
        Wrong::File(text) => text,
        Wrong::Memory(e) => e.to_string(),
        Wrong::Unreadable(e) => e.to_string(),
    })
}

#[test]
fn faces_become_fans_in_file_order() {
    let mesh = mesh(plain().as_bytes());
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3], [1, 4, 2]]);
    assert_eq!(mesh.positions[2..], [DVec3::new(1.0, 1.0, 0.1), DVec3::Y, DVec3::new(2.0, 0.0, -0.5)]);
    assert_eq!((mesh.material_of, mesh.materials), (vec![0; 3], vec![Material::default()]));
    assert!(mesh.corner_normals.is_empty() && mesh.corner_uvs.is_empty() && mesh.corner_colors.is_empty());
}

/// The same mesh in both orders of bytes, with colours, and with an element between that is skipped.
#[test]
fn binary_files_give_the_same_mesh() {
    for (format, is_big) in [("binary_little_endian", false), ("binary_big_endian", true)] {
        let mut bytes = format!(
            "ply\nformat {format} 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty double z\nproperty uchar red\n\
             property uchar green\nproperty uchar blue\nproperty uchar alpha\nelement edge 1\nproperty list uint short of\nproperty float w\n\
             element face 1\nproperty list uchar uint vertex_index\nend_header\n"
        )
        .into_bytes();
        let order = |bytes: &[u8]| {
            let mut bytes = bytes.to_vec();
            if is_big {
                bytes.reverse();
            }
            bytes
        };
        for (x, y, z, color) in
            [(0.0f32, 0.5f32, 0.1, [255, 0, 0]), (1.0, 0.0, 2.0, [0, 188, 0]), (0.0, 1.0, 3.0, [0; 3])]
        {
            let z: f64 = z;
            bytes.extend([order(&x.to_le_bytes()), order(&y.to_le_bytes()), order(&z.to_le_bytes())].concat());
            bytes.extend([color[0], color[1], color[2], 9]);
        }
        bytes.extend(order(&2u32.to_le_bytes()));
        bytes
            .extend([order(&1i16.to_le_bytes()), order(&(-1i16).to_le_bytes()), order(&0.5f32.to_le_bytes())].concat());
        bytes.push(3);
        [2u32, 0, 1].iter().for_each(|k| bytes.extend(order(&k.to_le_bytes())));
        let mesh = mesh(&bytes);
        assert_eq!(mesh.triangles, [[2, 0, 1]]);
        assert_eq!(mesh.positions, [DVec3::new(0.0, 0.5, 0.1), DVec3::new(1.0, 0.0, 2.0), DVec3::new(0.0, 1.0, 3.0)]);
        assert_eq!(mesh.corner_colors, [[2, 0, 1]]);
        // 188 of 255 is half of the light
        assert_eq!(mesh.colors[0], [1.0, 0.0, 0.0]);
        assert!((mesh.colors[1][1] - 0.5).abs() < 0.004, "{:?}", mesh.colors);
        assert_eq!(mesh.materials[0].diffuse, [1.0; 3]);
        let cut = parsed(&bytes[..bytes.len() - 2]).unwrap_err();
        assert_eq!(cut, "ends within its face elements; is it cut short?");
    }
}

/// Wherever the bytes end that are read first, the row there is read as a whole.
#[test]
fn rows_may_lie_in_two_blocks() {
    let binary = b"ply\nformat binary_little_endian 1.0\nelement vertex 4\nproperty uchar x\nproperty uchar y\nproperty ushort z\n\
                   element edge 1\nproperty list uchar short of\nelement face 2\nproperty list uchar ushort vertex_indices\n\
                   property uchar texnumber\nend_header\n";
    let data = [
        0, 0, 1, 0, 1, 0, 0, 1, 0, 1, 2, 0, 1, 1, 9, 1, 2, 5, 0, 6, 0, 4, 0, 0, 1, 0, 3, 0, 2, 0, 7, 3, 1, 0, 2, 0, 3,
        0, 8,
    ];
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("rest");
    for bytes in
        [[&binary[..], &data].concat(), plain().into_bytes(), plain().replace("3 1 4 2", "\n\n3 1 4 2").into_bytes()]
    {
        let expected = mesh(&bytes);
        let header_end = bytes.windows(10).position(|word| word == b"end_header").unwrap() + 11;
        for first in header_end..bytes.len() {
            std::fs::write(&path, &bytes[first..]).unwrap();
            let window = Window::of(bytes[..first].to_vec(), std::fs::File::open(&path).unwrap()).unwrap();
            assert_eq!(parsed_in_blocks(&bytes, window).unwrap().0, expected, "{first}");
        }
    }
}

#[test]
fn normals_and_texture_coordinates_belong_to_vertices() {
    let own = ["0 0 3 0.25 0.5", "0 0 1 1 0", "0 0 0 0 0", "0 0 1 1e39 0", "0 1 0 1 1"];
    let header = "property float nx\nproperty float ny\nproperty float nz\nproperty float s\nproperty float t\n";
    let mesh = mesh(text(header, own, "", [""; 2]).as_bytes());
    assert_eq!(mesh.normals[0], glam::Vec3::Z);
    assert_eq!(mesh.corner_normals, [[0, 1, NO_NORMAL], [0, NO_NORMAL, 3], [1, 4, NO_NORMAL]]);
    assert_eq!(mesh.uvs[0], Vec2::new(0.25, 0.5));
    assert_eq!(mesh.corner_uvs, [[0, 1, 2], [0, 2, NO_UV], [1, 4, 2]]);
}

#[test]
fn faces_have_texture_coordinates_images_and_colours_of_their_own() {
    let header = "property list uchar float texcoord\nproperty int texnumber\nproperty float red\nproperty float green\nproperty float blue\n";
    let own = ["8 0 0 1 0 1 1 0 1 1 1 0 0", "6 0 0 0.5 0 0 0.5 0 0 0 1"];
    let bare = ["8 0 0 1 0 1 1 0 1 1 1 0 0", "0 0 0 0 1"];
    let text_of =
        |own| text("", [""; 5], header, own).replace("by hand", "TextureFile a b.png\ncomment TextureFile c.jpg");
    let text = text_of(own);
    let (mesh, textures) = parsed(text.as_bytes()).unwrap();
    assert_eq!(textures, ["a b.png", "c.jpg"]);
    assert_eq!(mesh.material_of, [1, 1, 0]);
    assert_eq!(mesh.corner_uvs, [[0, 1, 2], [0, 2, 3], [4, 5, 6]]);
    assert_eq!(mesh.uvs[5], Vec2::new(0.5, 0.0));
    let without = self::mesh(text_of(bare).as_bytes());
    assert_eq!(without.corner_uvs, [[0, 1, 2], [0, 2, 3], [NO_UV; 3]]);
    assert_eq!(mesh.corner_colors, [[0; 3], [0; 3], [1; 3]]);
    assert_eq!(mesh.colors, [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]);
}

#[test]
fn strips_are_cut_up_and_face_one_side() {
    let text = plain()
        .replace("element face 2", "element tristrips 1")
        .replace("4 0 1 2 3 \n3 1 4 2 ", "9 0 1 3 2 -1 1 4 2 -1");
    assert_eq!(mesh(text.as_bytes()).triangles, [[0, 1, 3], [3, 1, 2], [1, 4, 2]]);
}

#[test]
fn what_is_wrong_is_said_in_a_line() {
    let fails = |text: &str, part: &str| {
        let wrong = parsed(text.as_bytes()).expect_err(part);
        assert!(wrong.contains(part) && !wrong.contains('\n'), "{wrong:?}, not {part:?}");
    };
    let plain = plain();
    let with = |from: &str, to: &str| {
        assert!(plain.contains(from), "{from}");
        plain.replace(from, to)
    };
    fails("", "does not begin with");
    fails("plywood", "line 1: this is no line of a PLY header");
    fails(&with("format ascii 1.0", "format morse 1.0"), "line 2: this is no line of a PLY header");
    fails(&with("element face 2", "element face 3"), "ends within its face elements; is it cut short?");
    fails(&with("element face 2", "element face 2000000000"), "its header says 2000000000 faces, in a file of");
    fails(&with("1 1 0.1", "1 one 0.1"), "line 13: this is no line of the numbers that its header says");
    fails(&with("1 1 0.1", "1 1e999 0.1"), "vertex 2 lies at (1, inf, 0.1)");
    fails(&with("property double x", "property double X"), "its vertices have no number x");
    fails(&with("3 1 4 2", "3 1 5 2"), "face 1 names vertex 5; there are 5, from 0");
    fails(&with("3 1 4 2", "3 1 -1 2"), "face 1 names vertex -1");
    fails(&with("3 1 4 2", "2 1 4"), "face 1 has 2 of at least 3 vertices");
    fails(&with("vertex_indices", "indices"), "face 0 has 0 of");
    fails(&with("element face 2", "element fence 2"), "no faces");
    let header = "property float red\nproperty float green\nproperty float blue\n";
    fails(&text(header, ["0 0 0", "0 0 1e39", "0 0 0", "0 0 0", "0 0 0"], "", [""; 2]), "vertex 1 has a colour");
    let header = "property list uchar float texcoord\n";
    fails(&text("", [""; 5], header, ["6 0 0 0 0 0 0", "6 0 0 0 0 0 0"]), "face 0 has a texcoord of 6 numbers");
}

/// Rhinoceros ends lines with carriage returns, others write blanks and tabs, Blender 2.47 a line of no keyword.
#[test]
fn headers_of_other_programs() {
    let expected = mesh(plain().as_bytes());
    let returns = plain().replace('\n', "\r");
    let blanks =
        plain().replace("element vertex", "\telement \t vertex ").replace("property double y", " property  double\ty ");
    let created = plain().replace("comment by hand", "Created by a program, source file: ");
    let points = plain().replace("1 1 0.1", "1. +1 .1").replace("2 0 -5e-1", "\t2  0 -.5 ");
    for text in [returns, blanks, created, plain().replace('\n', "\r\n"), points] {
        assert_eq!(mesh(text.as_bytes()), expected, "{text:?}");
    }
}

/// Binary data begin behind the last line end of a header, whatever ends lines.
#[test]
fn binary_data_begin_behind_the_header() {
    let header = "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty uchar x\nproperty uchar y\nproperty uchar z\n\
                  element face 1\nproperty list uchar uchar vertex_indices\nend_header\n";
    // the first coordinate is that of a line feed
    let data = [10, 13, 0, 1, 0, 0, 0, 1, 0, 3, 0, 1, 2];
    for header in [header.to_owned(), header.replace('\n', "\r"), header.replace('\n', "\r\n")] {
        let mesh = mesh(&[header.as_bytes(), &data].concat());
        assert_eq!((mesh.positions[0], mesh.triangles), (DVec3::new(10.0, 13.0, 0.0), vec![[0, 1, 2]]));
    }
}

#[test]
fn what_no_face_has_may_be_nan() {
    let colors = "property float red\nproperty float green\nproperty float blue\n";
    let text = text(colors, ["0 0 1", "0 1 0", "1 0 0", "nan nan nan", "1 1 1"], "", [""; 2])
        .replace("4 0 1 2 3", "3 0 1 2")
        .replace("0 1 0 nan", "nan nan nan nan");
    let mesh = mesh(text.as_bytes());
    assert_eq!((mesh.positions[3], mesh.colors[3]), (mesh.positions[0], [1.0; 3]));
    let used = parsed(text.replace("3 1 4 2", "3 1 3 2").as_bytes()).unwrap_err();
    assert!(used.contains("vertex 3 lies at (NaN, NaN, NaN)"), "{used}");
}

#[test]
fn colours_have_other_names_too() {
    for names in [["r", "g", "b"], ["diffuse_red", "diffuse_green", "diffuse_blue"]] {
        let header: String = names.iter().map(|name| format!("property uchar {name}\n")).collect();
        let mesh = mesh(text(&header, ["255 0 0", "0 0 0", "0 255 0", "0 0 0", "9 9 9"], "", [""; 2]).as_bytes());
        assert_eq!((mesh.colors[0], mesh.colors[2]), ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]));
    }
}
