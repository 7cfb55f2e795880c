//! STL: triangles alone, binary or text. Neither says which it is: <https://en.wikipedia.org/wiki/STL_(file_format)>.

use super::lex::{Lines, Tokens, parse_f64, quoted, with_line_feeds};
use super::mesh::{MAX_TRIANGLES, Material, Mesh, check_memory};
use super::weld::{Number, weld};
use crate::arrays::MapEach;
use crate::input::{Error, Limits, Loading, Result, Window};
use crate::parallel;
use std::path::Path;

/// Bytes before the triangles of a binary file: a text, and their number.
const HEADER: usize = 84;
/// Bytes of a triangle: a normal, three corners and two bytes of any use.
const TRIANGLE: usize = 50;

/// Reads an STL file. Corners in the same place become one vertex. Triangles keep their order; the normals of the file are not used.
///
/// # Errors
/// [`Error::Missing`] or [`Error::Read`] if it cannot be read; [`Error::Input`] naming the file, and the line of a text: it is cut short or has no triangles, more than 2^28 of them, or
/// a corner that is not finite; [`Error::Work`] if the triangles do not fit the free memory.
pub fn load(path: &Path, loading: &Loading) -> Result<Mesh> {
    let name = path.display().to_string();
    let unreadable = |e| Error::unreadable(path, e);
    let start = loading.prefix(path).map_err(unreadable)?;
    let is_text = is_text(start.bytes(), start.length());
    let count = if is_text { 0 } else { check_binary(start.bytes(), start.length(), &name, loading.limits())? };
    // without a zero only the whole tells that it is no text
    if is_text || !start.has_zero() {
        return parse(&start.read_all().map_err(unreadable)?, &name, loading.limits());
    }
    let corners = read_binary(start.into_window().map_err(unreadable)?, count).map_err(unreadable)?;
    mesh_of(&corners, &name)
}

/// As [`load`], from the file's bytes; `name` stands for the file in messages.
fn parse(bytes: &[u8], name: &str, limits: Limits) -> Result<Mesh> {
    let length = bytes.len() as u64;
    if is_text(bytes, length) {
        let corners = read_text(bytes, name)?;
        check_count(corners.len() as u64, name, limits)?;
        return mesh_of(&corners, name);
    }
    let count = check_binary(bytes, length, name, limits)?;
    let corners =
        read_binary(Window::whole(bytes.to_vec()), count).map_err(|e| Error::input(format!("{name}: {e}")))?;
    mesh_of(&corners, name)
}

/// The triangles of these corners: numbers in the precision of the file.
fn mesh_of<T: Number>(corners: &[[[T; 3]; 3]], name: &str) -> Result<Mesh> {
    let is_finite = |v: &[T; 3]| v.iter().all(|x| (*x).into().is_finite());
    let wrong = |k: usize| (!corners[k].iter().all(is_finite)).then_some(k);
    if let Some(k) = parallel::reduce(0..corners.len(), wrong, usize::min) {
        return Err(Error::input(format!("{name}: triangle {k} has a corner that is not finite; use finite numbers")));
    }
    let (positions, triangles) = weld(corners);
    let material_of = vec![0; triangles.len()];
    Ok(Mesh { positions, triangles, materials: vec![Material::default()], material_of, ..Mesh::default() })
}

/// Refuses no triangles, too many, or more than memory holds.
fn check_count(triangles: u64, name: &str, limits: Limits) -> Result<()> {
    if triangles == 0 {
        return Err(Error::input(format!("{name}: has no triangles; export it as a mesh")));
    }
    if triangles > MAX_TRIANGLES as u64 {
        return Err(Error::input(format!("{name}: {triangles} triangles, at most 2^28 are possible; split the file")));
    }
    // of a closed mesh every second triangle adds a vertex
    let vertices = triangles / 2 + 2;
    check_memory(limits, (triangles, vertices), format_args!("{name}: {triangles} triangles"), "use fewer")
}

/// Programs write `solid` at the start of binary files, too, which are as long as their triangles. `bytes` are the file's first, or all of its
/// `length`.
fn is_text(bytes: &[u8], length: u64) -> bool {
    // a text has no zero byte
    let is_binary = bytes.contains(&0) && binary_count(bytes).is_some_and(|count| count <= held(length));
    !is_binary && bytes.trim_ascii_start().get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid"))
}

fn binary_count(bytes: &[u8]) -> Option<u64> {
    let count = bytes.get(HEADER - 4..HEADER)?.try_into().ok()?;
    Some(u32::from_le_bytes(count).into())
}

/// The triangles that a binary file of this length holds.
fn held(length: u64) -> u64 {
    length.saturating_sub(HEADER as u64) / TRIANGLE as u64
}

/// The number of triangles of a binary file, by its first bytes and its length.
fn check_binary(bytes: &[u8], length: u64, name: &str, limits: Limits) -> Result<usize> {
    let Some(count) = binary_count(bytes) else {
        return Err(Error::input(format!("{name}: is no STL file: neither a text that begins with solid, nor binary")));
    };
    let held = held(length);
    if count > held {
        return Err(Error::input(format!(
            "{name}: {count} triangles by its header, {held} in the file; is it cut short?"
        )));
    }
    check_count(count, name, limits)?;
    Ok(count as usize)
}

/// The corners of so many triangles of a binary file. Those behind its end are left out.
fn read_binary(mut window: Window, count: usize) -> std::io::Result<Vec<[[f32; 3]; 3]>> {
    let corners = |t: &[u8; TRIANGLE]| {
        let (numbers, _) = t.as_chunks::<4>();
        [3, 6, 9].map_each(|first| [0, 1, 2].map_each(|k| f32::from_le_bytes(numbers[first + k])))
    };
    let mut all = Vec::with_capacity(count);
    window.advance(HEADER);
    loop {
        let (triangles, _) = window.bytes().as_chunks::<TRIANGLE>();
        let triangles = &triangles[..triangles.len().min(count - all.len())];
        all.append(&mut parallel::map(triangles, corners));
        let used = triangles.len() * TRIANGLE;
        window.advance(used);
        if all.len() == count || window.is_at_end() {
            return Ok(all);
        }
        window.read_on()?;
    }
}

fn read_text(bytes: &[u8], name: &str) -> Result<Vec<[[f64; 3]; 3]>> {
    let (mut triangles, mut corners) = (Vec::new(), Vec::new());
    for (number, line) in Lines::new(&with_line_feeds(bytes)) {
        let wrong = |text: String| Error::input(format!("{name}:{}: {text}", number + 1));
        let mut tokens = Tokens::new(&line);
        match tokens.next().unwrap_or_default().to_ascii_lowercase().as_slice() {
            b"vertex" => {
                let mut v = [0.0; 3];
                for x in &mut v {
                    let token = tokens.next().ok_or_else(|| wrong("a vertex has three coordinates: x y z".into()))?;
                    let number = parse_f64(token);
                    *x = number.ok_or_else(|| wrong(format!("coordinate {} is not a number", quoted(token))))?;
                }
                corners.push(v);
            }
            b"endloop" => {
                let triangle = corners[..].try_into();
                let count = corners.len();
                triangles.push(triangle.map_err(|_| wrong(format!("a facet has {count} vertices; give it 3")))?);
                corners.clear();
            }
            b"" | b"solid" | b"facet" | b"outer" | b"endfacet" | b"endsolid" => {}
            other => return Err(wrong(format!("{} is no word of an STL text", quoted(other)))),
        }
    }
    match corners.len() {
        0 => Ok(triangles),
        _ => Err(Error::input(format!("{name}: ends within a facet; is it cut short?"))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    const TEXT: &str = "solid a b\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1 0 0\n   VERTEX 0 1e0 -0.0\n  \
                        endloop\n endfacet\n\nfacet normal 0 0 0\nouter loop\nvertex 1 0 0\nvertex 0 1 0\nvertex 0.1 2 3\nendloop\nendfacet\nendsolid\n";

    fn binary(header: &[u8], triangles: &[[[f32; 3]; 3]]) -> Vec<u8> {
        let mut bytes = header.to_vec();
        bytes.resize(80, b' ');
        bytes.extend((triangles.len() as u32).to_le_bytes());
        for triangle in triangles {
            bytes.extend([0; 12]);
            bytes.extend(triangle.iter().flatten().flat_map(|x| x.to_le_bytes()));
            bytes.extend([7; 2]);
        }
        bytes
    }

    #[test]
    fn text_and_binary_give_the_same_triangles() {
        let mesh = parse(TEXT.as_bytes(), "a.stl", Limits::default()).unwrap();
        assert_eq!(mesh.triangles, [[0, 1, 2], [1, 2, 3]]);
        // digits are read as f64
        assert_eq!(mesh.positions, [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::new(0.1, 2.0, 3.0)]);
        let triangles =
            [[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, -0.0]], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.5, 2.0, 3.0]]];
        for header in [&b"made by hand"[..], b"solid made by a program"] {
            let mesh = parse(&binary(header, &triangles), "a.stl", Limits::default()).unwrap();
            assert_eq!(mesh.triangles, [[0, 1, 2], [1, 2, 3]]);
            assert_eq!(mesh.positions[3], DVec3::new(0.5, 2.0, 3.0));
        }
        let old = TEXT.replace('\n', "\r");
        assert_eq!(parse(old.as_bytes(), "a.stl", Limits::default()).unwrap().triangles, [[0, 1, 2], [1, 2, 3]]);
        // some programs append their own
        let longer = [binary(b"solid", &triangles), vec![1, 2, 3]].concat();
        assert_eq!(parse(&longer, "a.stl", Limits::default()).unwrap().triangles.len(), 2);
    }

    #[test]
    fn what_is_wrong_is_said() {
        let fails = |bytes: &[u8], part: &str| {
            let text = parse(bytes, "a.stl", Limits::default()).unwrap_err().to_string();
            assert!(text.starts_with("a.stl") && text.contains(part) && !text.contains('\n'), "{text}");
        };
        fails(b"", "is no STL file");
        fails(b"hello", "is no STL file");
        fails(b"solid\nendsolid", "no triangles");
        fails(b"solid\nvertex 1 2\n", "a.stl:2: a vertex has three");
        fails(b"solid\nvertex 1 2 x\n", "\"x\" is not a number");
        fails(b"solid\nvertex 1 2 3\n", "ends within a facet");
        fails(b"solid\nvertex 1 2 3\nendloop\n", "a.stl:3: a facet has 1 vertices");
        fails(b"solid\nvertices\n", "\"vertices\" is no word");
        fails(&binary(b"", &[]), "no triangles");
        let whole = binary(b"", &[[[0.0; 3]; 3]]);
        fails(&whole[..whole.len() - 1], "1 triangles by its header, 0 in the file");
        fails(&binary(b"", &[[[0.0; 3], [f32::NAN; 3], [0.0; 3]]]), "triangle 0 has a corner that is not finite");
    }
}
