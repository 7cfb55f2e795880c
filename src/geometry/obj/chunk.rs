//! One chunk of an OBJ text: its counts, and its parsed contents.

use glam::{DVec2, DVec3, Vec3};

use crate::geometry::lex::{Lines, Tokens, parse_f64, parse_i64, quoted};
use crate::geometry::mesh::{NO_NORMAL, NO_UV};
use crate::input::{Error, Result};

/// How many lines and vertex statements a stretch of text has.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Counts {
    pub lines: usize,
    pub positions: usize,
    pub texcoords: usize,
    pub normals: usize,
}

impl Counts {
    pub(super) fn of(text: &[u8]) -> Counts {
        let mut counts = Counts::default();
        let mut lines = Lines::new(text);
        for (_, line) in lines.by_ref() {
            match line.trim_ascii_start() {
                [b'v', blank, ..] if blank.is_ascii_whitespace() => counts.positions += 1,
                [b'v', b't', ..] => counts.texcoords += usize::from(keyword(&line) == b"vt"),
                [b'v', b'n', ..] => counts.normals += usize::from(keyword(&line) == b"vn"),
                _ => {}
            }
        }
        counts.lines = lines.read_so_far();
        counts
    }

    pub(super) fn plus(&self, other: &Counts) -> Counts {
        Counts {
            lines: self.lines + other.lines,
            positions: self.positions + other.positions,
            texcoords: self.texcoords + other.texcoords,
            normals: self.normals + other.normals,
        }
    }
}

fn keyword(line: &[u8]) -> &[u8] {
    Tokens::new(line).next().unwrap_or_default()
}

/// A parsed chunk: its vertices, and its triangles with indices into the whole file's vertices.
#[derive(Debug, Default)]
pub(super) struct Chunk {
    pub positions: Vec<DVec3>,
    /// Unit length, or zero where the file's normal has no direction.
    pub normals: Vec<Vec3>,
    pub triangles: Vec<[u32; 3]>,
    pub texcoords: Vec<DVec2>,
    /// sRGB of its first positions as the file has it, as far as the last that has one; NaN where one has none.
    pub colors: Vec<[f64; 3]>,
    /// As far as the last triangle that has texture coordinates; the rest have none.
    pub corner_texcoords: Vec<[u32; 3]>,
    /// As far as the last triangle that has a normal; the rest have none.
    pub corner_normals: Vec<[u32; 3]>,
    /// `usemtl` lines: the first triangle of the chunk each is for, and the name.
    pub uses: Vec<(usize, String)>,
    /// The rest of each `mtllib` line.
    pub libraries: Vec<String>,
    /// `o` and `g` lines: the first triangle of the chunk each is for, whether it is an `o` line, and the name.
    pub groups: Vec<(usize, bool, String)>,
    /// Corners of faces whose index is out of range.
    pub dangling_normals: LeftOut,
    pub dangling_texcoords: LeftOut,
    /// Faces of fewer than three vertices.
    pub short_faces: LeftOut,
    /// Colours that are not finite.
    pub wrong_colors: LeftOut,
}

/// Parts of a chunk that the mesh is made without.
#[derive(Debug, Default)]
pub(super) struct LeftOut {
    pub count: usize,
    /// The line of the first one, from 1, and what is wrong.
    pub first: Option<(usize, String)>,
}

/// One corner of a face: its position, its normal or [`NO_NORMAL`], its texture coordinate or [`NO_UV`].
type Corner = (u32, u32, u32);

/// What becomes of texture coordinates.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Texcoords {
    /// Faces may have none.
    Kept,
    Needed,
}

/// Parses one chunk.
pub(super) struct Reader<'a> {
    name: &'a str,
    before: Counts,
    total: Counts,
    texcoords: Texcoords,
    /// The current line, from 1.
    line: usize,
    corners: Vec<Corner>,
    chunk: Chunk,
}

impl<'a> Reader<'a> {
    /// `before`: what lies in the chunks before this one; `total`: in the whole file.
    pub(super) fn new(name: &'a str, before: Counts, total: Counts, texcoords: Texcoords) -> Self {
        let (line, corners, chunk) = (0, Vec::new(), Chunk::default());
        Reader { name, before, total, texcoords, line, corners, chunk }
    }

    /// # Errors
    /// That of the chunk's first line with an error, as `file:line: what`.
    pub(super) fn read(mut self, text: &[u8], own: &Counts) -> Result<Chunk> {
        self.chunk.positions.reserve_exact(own.positions);
        self.chunk.normals.reserve_exact(own.normals);
        self.chunk.texcoords.reserve_exact(own.texcoords);
        for (number, line) in Lines::new(text) {
            self.line = self.before.lines + number + 1;
            if let Err(message) = self.read_line(&line) {
                return Err(Error::input(format!("{}:{}: {message}", self.name, self.line)));
            }
        }
        Ok(self.chunk)
    }

    fn read_line(&mut self, line: &[u8]) -> std::result::Result<(), String> {
        let mut tokens = Tokens::new(line);
        match tokens.next().unwrap_or_default() {
            b"v" => {
                let position = read_vector(tokens.clone())?;
                // others may be vertices that no face has
                if !position.is_finite() && self.texcoords == Texcoords::Needed {
                    return Err(NOT_FINITE.into());
                }
                if let Some(color) = read_color(tokens)? {
                    let is_finite = color.iter().all(|c| c.is_finite());
                    if !is_finite {
                        self.chunk.wrong_colors.add(self.line, "it is not finite".into());
                    }
                    self.chunk.colors.resize(self.chunk.positions.len(), NO_SRGB);
                    self.chunk.colors.push(if is_finite { color } else { NO_SRGB });
                }
                self.chunk.positions.push(position);
            }
            b"vn" => self.chunk.normals.push(unit(read_vector(tokens)?)),
            b"vt" => {
                let uv = read_texcoord(tokens, self.texcoords)?;
                if !uv.is_finite() && self.texcoords == Texcoords::Needed {
                    return Err("texture coordinate is not finite; use finite numbers".into());
                }
                self.chunk.texcoords.push(uv);
            }
            b"f" | b"fo" => self.read_face(tokens)?,
            b"usemtl" => self.chunk.uses.push((self.chunk.triangles.len(), tokens.name())),
            key @ (b"o" | b"g") => self.chunk.groups.push((self.chunk.triangles.len(), key == b"o", tokens.name())),
            b"mtllib" => self.chunk.libraries.push(tokens.name()),
            _ => {}
        }
        Ok(())
    }

    fn read_face(&mut self, tokens: Tokens) -> std::result::Result<(), String> {
        let mut corners = std::mem::take(&mut self.corners);
        corners.clear();
        for token in tokens {
            corners.push(self.read_corner(token)?);
        }
        if corners.len() < 3 {
            self.chunk.short_faces.add(self.line, format!("face has {} of at least 3 vertices", corners.len()));
            self.corners = corners;
            return Ok(());
        }
        let (p0, n0, t0) = corners[0];
        for pair in corners.windows(2).skip(1) {
            let [(p1, n1, t1), (p2, n2, t2)] = [pair[0], pair[1]];
            self.chunk.triangles.push([p0, p1, p2]);
            if t0.max(t1).max(t2) != NO_UV {
                self.chunk.corner_texcoords.resize(self.chunk.triangles.len() - 1, [NO_UV; 3]);
                self.chunk.corner_texcoords.push([t0, t1, t2]);
            } else if self.texcoords == Texcoords::Needed {
                return Err("face without texture coordinates; write its vertices as v/vt".into());
            }
            if n0 & n1 & n2 != NO_NORMAL {
                self.chunk.corner_normals.resize(self.chunk.triangles.len() - 1, [NO_NORMAL; 3]);
                self.chunk.corner_normals.push([n0, n1, n2]);
            }
        }
        self.corners = corners;
        Ok(())
    }

    /// `v`, `v/vt`, `v//vn` or `v/vt/vn`. Normals may be missing, and texture coordinates unless the caller needs them.
    fn read_corner(&mut self, token: &[u8]) -> std::result::Result<Corner, String> {
        let mut parts = token.splitn(3, |&b| b == b'/');
        let seen = self.before.positions + self.chunk.positions.len();
        let position = resolve(parts.next().unwrap_or_default(), "vertex", seen, self.total.positions)??;
        let seen = self.before.texcoords + self.chunk.texcoords.len();
        let texcoord = match parts.next() {
            None | Some([]) => NO_UV,
            Some(part) => match resolve(part, "texture coordinate", seen, self.total.texcoords)? {
                Err(missing) if self.texcoords == Texcoords::Kept => {
                    self.chunk.dangling_texcoords.add(self.line, missing);
                    NO_UV
                }
                found => found?,
            },
        };
        let seen = self.before.normals + self.chunk.normals.len();
        let normal = match parts.next() {
            None | Some([]) => NO_NORMAL,
            Some(part) => resolve(part, "normal", seen, self.total.normals)?.unwrap_or_else(|missing| {
                self.chunk.dangling_normals.add(self.line, missing);
                NO_NORMAL
            }),
        };
        Ok((position, normal, texcoord))
    }
}

impl LeftOut {
    fn add(&mut self, line: usize, what: String) {
        self.count += 1;
        self.first.get_or_insert((line, what));
    }
}

/// The index from 0 of an OBJ index: positive ones count from 1, negative ones back from the `seen` vertices so far.
///
/// # Errors
/// The outer error: the token is not an index. The inner error: the index is out of range.
fn resolve(
    token: &[u8],
    what: &str,
    seen: usize,
    total: usize,
) -> std::result::Result<std::result::Result<u32, String>, String> {
    let Some(index) = parse_i64(token) else {
        return Err(format!("face's {what} index {} is not an integer", quoted(token)));
    };
    if index == 0 {
        return Err(format!("face's {what} index is 0; indices start at 1"));
    }
    // Both counts fit an i64: they are numbers of lines in memory.
    let (from_zero, limit) = if index > 0 { (index - 1, total as i64) } else { (seen as i64 + index, seen as i64) };
    if !(0..limit).contains(&from_zero) {
        let (count, sign, so_far) = if index > 0 { (total, "", "") } else { (seen, "-", " up to here") };
        return Ok(Err(match count {
            0 => format!("face's {what} index {index}, but there are none{so_far}"),
            _ => format!("face's {what} index {index} out of range; {sign}1 to {sign}{count} exist{so_far}"),
        }));
    }
    Ok(u32::try_from(from_zero).map_err(|_| format!("face's {what} index {index} is too large")))
}

/// What is wrong with a vertex.
pub(super) const NOT_FINITE: &str = "vertex coordinate is not finite; use finite numbers";

/// The colour of a vertex without one.
const NO_SRGB: [f64; 3] = [f64::NAN; 3];

/// The last three of a vertex's first six numbers: an sRGB colour, which may be NaN. Four numbers are a place and a weight.
fn read_color(tokens: Tokens) -> std::result::Result<Option<[f64; 3]>, String> {
    let mut own = tokens.skip(3);
    let (Some(r), Some(g), Some(b)) = (own.next(), own.next(), own.next()) else { return Ok(None) };
    let mut color = [0.0; 3];
    for (value, token) in color.iter_mut().zip([r, g, b]) {
        *value = parse_f64(token).ok_or_else(|| format!("colour {} is not a number", quoted(token)))?;
    }
    Ok(Some(color))
}

/// The first three tokens as numbers; more of them (a weight, a colour) are skipped.
fn read_vector(tokens: Tokens) -> std::result::Result<DVec3, String> {
    Ok(DVec3::from(read_numbers::<3>(tokens, "x y z")?))
}

/// The first two tokens; or the first and 0, where that will do.
fn read_texcoord(tokens: Tokens, texcoords: Texcoords) -> std::result::Result<DVec2, String> {
    match tokens.clone().count() {
        1 if texcoords == Texcoords::Kept => Ok(DVec2::new(read_numbers::<1>(tokens, "u")?[0], 0.0)),
        _ => Ok(DVec2::from(read_numbers::<2>(tokens, "u v")?)),
    }
}

fn read_numbers<const N: usize>(mut tokens: Tokens, names: &str) -> std::result::Result<[f64; N], String> {
    let mut numbers = [0.0; N];
    for (at, value) in numbers.iter_mut().enumerate() {
        let token = tokens.next().ok_or_else(|| format!("has {at} of {N} coordinates; give {names}"))?;
        *value = parse_f64(token).ok_or_else(|| format!("coordinate {} is not a number", quoted(token)))?;
    }
    Ok(numbers)
}

/// The direction of `v`; zero where it has none.
fn unit(v: DVec3) -> Vec3 {
    // Scaled first: squares of large or small components leave the range.
    let scaled = v / v.abs().max_element();
    if v.is_finite() && scaled.is_finite() { scaled.normalize().as_vec3() } else { Vec3::ZERO }
}
