//! OFF: polygons as text, with the colours and normals of vertices and the colours of faces: <http://www.geomview.org/docs/html/OFF.html>.

use super::lex::{HAS_ZEROS, Lines, Tokens, parse_f64, parse_i64, quoted, with_line_feeds};
use super::mesh::{MAX_TRIANGLES, Material, Mesh, Missing, NO_COLOR, check_memory};
use super::texture::{full_color, linear_color};
use crate::input::{Error, Limits, Loading, Result};
use glam::DVec3;
use std::path::Path;

/// Reads an OFF, COFF, NOFF or CNOFF file. Its faces are fan-triangulated from their first vertex; zero-area triangles stay, so that ids are
/// file order. Faces of fewer than three vertices have no triangle, and are listed in [`Mesh::missing`]. Colours of faces take precedence over
/// colours of vertices; both are sRGB, from 0 to 1, or from 0 to 255 where all of the file are whole numbers.
///
/// # Errors
/// [`Error::Missing`] or [`Error::Read`] if it cannot be read; [`Error::Input`] naming the file and the line: it is binary or of more than three
/// dimensions, is cut short, has no triangles or more than 2^28; a number is none, a vertex of a face is not finite, an index has no vertex.
/// [`Error::Work`] if the mesh does not fit the free memory.
pub fn load(path: &Path, loading: &Loading) -> Result<Mesh> {
    let name = path.display().to_string();
    let unreadable = |e| Error::unreadable(path, e);
    let start = loading.prefix(path).map_err(unreadable)?;
    if start.goes_on_after_zero() {
        return Err(Error::input(format!("{name}: {HAS_ZEROS}")));
    }
    // comments may move the header behind what is read first
    if !start.bytes().contains(&b'#') {
        let text = with_line_feeds(start.bytes().strip_prefix(BYTE_ORDER_MARK).unwrap_or(start.bytes()));
        read_header(&mut Reader { name: &name, lines: Lines::new(&text) }, start.length(), loading.limits())?;
    }
    parse(&start.read_all().map_err(unreadable)?, &name, loading.limits())
}

/// UTF-8's, at the start of a text.
const BYTE_ORDER_MARK: &[u8] = b"\xEF\xBB\xBF";

/// Attributes of vertices, in the order in which they follow the coordinates.
#[derive(Debug, Clone, Copy, Default)]
struct Attributes {
    normals: bool,
    colors: bool,
}

/// The lines that are not empty, as their tokens' numbers are read.
struct Reader<'a> {
    name: &'a str,
    lines: Lines<'a>,
}

/// A line, and its number from 1.
struct Line {
    number: usize,
    text: Vec<u8>,
}

impl Line {
    fn numbers(&self) -> std::result::Result<Vec<f64>, String> {
        let number = |token: &[u8]| parse_f64(token).ok_or_else(|| format!("{} is not a number", quoted(token)));
        Tokens::new(&self.text).map(number).collect()
    }

    /// Whether a face has fewer vertices than its first number says.
    fn lacks_vertices(&self) -> bool {
        let mut tokens = Tokens::new(&self.text);
        let count = tokens.next().and_then(parse_i64).and_then(|count| usize::try_from(count).ok());
        count.is_some_and(|count| tokens.count() < count)
    }
}

impl Reader<'_> {
    fn next(&mut self) -> Result<Line> {
        for (number, text) in self.lines.by_ref() {
            if Tokens::new(&text).next().is_some() {
                return Ok(Line { number: number + 1, text: text.into_owned() });
            }
        }
        Err(Error::input(format!(
            "{}: ends before the vertices and faces that it promises; is it cut short?",
            self.name
        )))
    }

    fn wrong(&self, line: &Line, what: impl std::fmt::Display) -> Error {
        Error::input(format!("{}:{}: {what}", self.name, line.number))
    }
}

/// As [`load`], from the file's bytes; `name` stands for the file in messages.
fn parse(bytes: &[u8], name: &str, limits: Limits) -> Result<Mesh> {
    let text = with_line_feeds(bytes.strip_prefix(BYTE_ORDER_MARK).unwrap_or(bytes));
    let mut reader = Reader { name, lines: Lines::new(&text) };
    let (has, [vertices, faces]) = read_header(&mut reader, bytes.len() as u64, limits)?;
    let (mut mesh, mut colors) = (Mesh::default(), Vec::new());
    for _ in 0..vertices {
        read_vertex(&mut reader, has, &mut mesh, &mut colors)?;
    }
    let (mut face_colors, mut short): (Vec<(usize, [f64; 3])>, usize) = (Vec::new(), 0);
    for _ in 0..faces {
        let mut line = reader.next()?;
        // a few programs break the line of a face
        while line.lacks_vertices()
            && let Ok(more) = reader.next()
        {
            line.text.push(b' ');
            line.text.extend(more.text);
        }
        let (corners, color) = read_face(&line, vertices).map_err(|what| reader.wrong(&line, what))?;
        short += usize::from(corners.len() < 3);
        face_colors.extend(color.map(|color| (mesh.triangles.len(), color)));
        mesh.triangles.extend(corners.windows(2).skip(1).map(|pair| [corners[0], pair[0], pair[1]]));
        if mesh.triangles.len() > MAX_TRIANGLES {
            return Err(reader.wrong(&line, "more than 2^28 triangles are not possible; split the file"));
        }
    }
    let triangles = mesh.triangles.len();
    if triangles == 0 {
        return Err(Error::input(format!("{name}: has no faces; render points as spheres, by [[spheres]]")));
    }
    mesh.settle_unused()
        .map_err(|k| Error::input(format!("{name}: vertex {k} is not finite and a face has it; use finite numbers")))?;
    if short > 0 {
        let why = format!("{short} of its faces have fewer than 3");
        mesh.missing.push(Missing { what: format!("vertices of {name}"), why });
    }
    if has.normals {
        mesh.corner_normals.clone_from(&mesh.triangles);
        mesh.drop_unusable();
    }
    color(&mut mesh, &colors, &face_colors);
    let white = Material { diffuse: [1.0; 3], ..Material::default() };
    mesh.materials = vec![if mesh.corner_colors.is_empty() { Material::default() } else { white }];
    mesh.material_of = vec![0; triangles];
    Ok(mesh)
}

/// Reads the word OFF with the letters before it, and the numbers of vertices and faces behind it or in the next line. Refuses more of these
/// than a file of `length` bytes, or memory, holds.
fn read_header(reader: &mut Reader, length: u64, limits: Limits) -> Result<(Attributes, [usize; 2])> {
    let line = reader.next()?;
    let word = Tokens::new(&line.text).next().unwrap_or_default().to_vec();
    let Some(end) = word.windows(3).position(|w| w == b"OFF") else {
        return Err(reader.wrong(&line, "is no OFF file: it does not begin with the word OFF"));
    };
    let mut has = Attributes::default();
    for letter in &word[..end] {
        match letter {
            b'C' => has.colors = true,
            b'N' => has.normals = true,
            _ => return Err(reader.wrong(&line, format_args!("{} files are not read; write it as OFF", quoted(&word)))),
        }
    }
    // some programs write the first count without a blank
    let start = line.text.windows(3).position(|w| w == b"OFF").unwrap_or(0) + 3;
    let rest = Line { number: line.number, text: line.text[start..].to_vec() };
    if Tokens::new(&rest.text).next() == Some(b"BINARY") {
        return Err(reader.wrong(&line, "binary OFF is not read; write it as text"));
    }
    let counts = if Tokens::new(&rest.text).next().is_some() { rest } else { reader.next()? };
    let count = |token: Option<&[u8]>| parse_i64(token?).and_then(|n| usize::try_from(n).ok());
    let mut tokens = Tokens::new(&counts.text);
    let [Some(vertices), Some(faces)] = [count(tokens.next()), count(tokens.next())] else {
        return Err(reader.wrong(&counts, "expected the numbers of vertices, faces and edges, as 8 6 0"));
    };
    let name = reader.name;
    // a vertex and a face are a line each
    if (vertices as u64).saturating_add(faces as u64) > length {
        return Err(Error::input(format!(
            "{name}: its header says {vertices} vertices and {faces} faces, in {length} bytes"
        )));
    }
    check_memory(limits, (faces as u64, vertices as u64), format_args!("{name}: {faces} faces"), "use fewer")?;
    Ok((has, [vertices, faces]))
}

fn read_vertex(reader: &mut Reader, has: Attributes, mesh: &mut Mesh, colors: &mut Vec<[f64; 3]>) -> Result<()> {
    let line = reader.next()?;
    let numbers = line.numbers().map_err(|what| reader.wrong(&line, what))?;
    let needed = 3 + 3 * usize::from(has.normals) + 3 * usize::from(has.colors);
    if numbers.len() < needed {
        let count = numbers.len();
        return Err(reader.wrong(&line, format_args!("a vertex has {needed} numbers here, not {count}")));
    }
    let (triples, _) = numbers.as_chunks::<3>();
    mesh.positions.push(DVec3::from(triples[0]));
    if has.normals {
        mesh.normals.push(DVec3::from(triples[1]).normalize_or_zero().as_vec3());
    }
    if has.colors {
        colors.push(triples[1 + usize::from(has.normals)]);
    }
    Ok(())
}

/// The vertices of a face, and its colour if it has three numbers or more behind them.
fn read_face(line: &Line, vertices: usize) -> std::result::Result<(Vec<u32>, Option<[f64; 3]>), String> {
    let numbers = line.numbers()?;
    let count = numbers.first().copied().unwrap_or_default();
    let Some(corners) = numbers.get(1..).and_then(|after| after.get(..count as usize)) else {
        return Err(format!("a face of {count} vertices names {}", numbers.len().saturating_sub(1)));
    };
    let index = |k: &f64| match k.fract() == 0.0 && (0.0..vertices as f64).contains(k) {
        // there are fewer vertices than bytes, and `Mesh` holds no more than a u32 counts
        true => u32::try_from(*k as usize).map_err(|_| format!("vertex {k} is too large")),
        false => Err(format!("a face names vertex {k}; there are {vertices}, from 0")),
    };
    let corners: Vec<u32> = corners.iter().map(index).collect::<std::result::Result<_, _>>()?;
    let color = match numbers[1 + corners.len()..] {
        [r, g, b, ..] => Some([r, g, b]),
        _ => None,
    };
    Ok((corners, color))
}

/// Colors the triangles by their faces, given with the index of each face's first triangle, or else by their vertices.
fn color(mesh: &mut Mesh, of_vertices: &[[f64; 3]], of_faces: &[(usize, [f64; 3])]) {
    let count = mesh.triangles.len();
    if of_faces.is_empty() {
        let full = full_color(of_vertices.iter().flatten());
        mesh.colors = of_vertices.iter().map(|rgb| linear_color(*rgb, full)).collect();
        mesh.corner_colors = if of_vertices.is_empty() { Vec::new() } else { mesh.triangles.clone() };
        return;
    }
    let full = full_color(of_faces.iter().flat_map(|(_, rgb)| rgb));
    mesh.colors = of_faces.iter().map(|(_, rgb)| linear_color(*rgb, full)).collect();
    // a face without a colour, before the first that has one, is white
    mesh.corner_colors = vec![[NO_COLOR; 3]; count];
    let ends = of_faces.iter().skip(1).map(|(first, _)| *first).chain([count]);
    for ((k, (first, _)), end) in of_faces.iter().enumerate().zip(ends) {
        mesh.corner_colors[*first..end].fill([k as u32; 3]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::mesh::NO_NORMAL;

    fn read(text: &str) -> Result<Mesh> {
        parse(text.as_bytes(), "a.off", Limits::default())
    }

    const QUAD: &str = "# by hand\nOFF\n4 2 0\n\n0 0 0\n1 0 0 # x\n1 1 0.1\n0 1 0\n4 0 1 2 3\n3 2 1 0\n";

    #[test]
    fn faces_become_fans_in_file_order() {
        let mesh = read(QUAD).unwrap();
        assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3], [2, 1, 0]]);
        assert_eq!(mesh.positions[2], DVec3::new(1.0, 1.0, 0.1));
        assert_eq!(mesh.materials, [Material::default()]);
        for other in [
            QUAD.replace("4 0 1 2 3", "4 0 1\n2 \n3"),
            QUAD.replace('\n', "\r\n"),
            QUAD.replace('\n', "\r"),
            QUAD.replace("OFF\n", "OFF"),
            QUAD.replace("OFF\n", "OFF "),
        ] {
            // a comment would take the whole text where carriage returns were no line ends
            assert_eq!(read(&other).unwrap(), mesh, "{other:?}");
        }
    }

    #[test]
    fn vertices_have_normals_and_colours() {
        let text = "CNOFF 3 1 0\n0 0 0 0 0 2 255 0 0 255\n1 0 0 0 0 0 0 255 0 9\n0 1 0 1 0 0 0 0 128 0\n3 0 1 2\n";
        let mesh = read(text).unwrap();
        assert_eq!(mesh.corner_normals, [[0, NO_NORMAL, 2]]);
        assert_eq!(mesh.normals[0], glam::Vec3::Z);
        assert_eq!(mesh.colors[..2], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
        assert_eq!((&mesh.corner_colors[..], mesh.materials[0].diffuse), (&[[0, 1, 2]][..], [1.0; 3]));
    }

    #[test]
    fn faces_have_colours() {
        let text = QUAD.replace("4 0 1 2 3", "4 0 1 2 3 1.0 0 0.0").replace("3 2 1 0", "3 2 1 0 0 1 0 0.5");
        let mesh = read(&text).unwrap();
        assert_eq!(mesh.corner_colors, [[0; 3], [0; 3], [1; 3]]);
        assert_eq!(mesh.colors, [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
        let second = read(&QUAD.replace("3 2 1 0", "3 2 1 0 0 1 0")).unwrap();
        assert_eq!(second.corner_colors, [[NO_COLOR; 3], [NO_COLOR; 3], [0; 3]]);
    }

    #[test]
    fn what_no_face_has_may_be_wrong() {
        let mesh = read(&QUAD.replace("4 2 0", "5 3 0").replace("4 0 1", "nan 0 0\n2 0 1\n4 0 1")).unwrap();
        assert_eq!((mesh.triangles.len(), mesh.positions[4]), (3, mesh.positions[0]));
        assert_eq!(mesh.missing[0].why, "1 of its faces have fewer than 3");
        let error = read(&QUAD.replace("0 1 0\n4", "0 nan 0\n4")).unwrap_err().to_string();
        assert!(error.contains("vertex 3 is not finite"), "{error}");
    }

    #[test]
    fn what_is_wrong_is_said_in_a_line() {
        for (text, part) in [
            ("", "ends before"),
            ("solid", "a.off:1: is no OFF file"),
            ("4OFF\n1 1 0", "\"4OFF\" files are not read"),
            ("OFF BINARY\n", "binary OFF is not read"),
            ("OFF\n3 x 0", "a.off:2: expected the numbers"),
            ("OFF\n3 900000000000 0", "its header says"),
            ("OFF\n3 1 0\n0 0 0\n1 0", "a.off:4: a vertex has 3 numbers here, not 2"),
            ("OFF\n3 1 0\n0 0 0\n1 0 b", "a.off:4: \"b\" is not a number"),
            ("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3", "a.off:6: a face names vertex 3; there are 3"),
            ("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1", "a.off:6: a face of 3 vertices names 2"),
            ("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n", "ends before"),
            ("OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n", "has no faces"),
        ] {
            let error = read(text).unwrap_err().to_string();
            assert!(error.contains(part) && !error.contains('\n'), "{error}, not {part}");
        }
    }
}
