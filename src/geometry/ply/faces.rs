//! Faces and triangle strips of a PLY file, cut into triangles.

use super::Wrong;
use super::body::Part;
use super::element::{Color, linear};
use super::read::{Element, Row};
use crate::arrays::MapEach;
use crate::geometry::mesh::NO_UV;
use glam::Vec2;

/// Ends a part of a triangle strip.
const STRIP_END: i64 = -1;

/// The elements that are faces.
pub(super) const NAMES: [&str; 2] = ["face", "tristrips"];

/// Properties of faces, or of triangle strips, by their numbers, and the numbers in the whole file that faces depend on.
#[derive(Debug)]
pub(super) struct FaceProperties {
    corners: Option<usize>,
    texcoords: Option<usize>,
    color: Option<Color>,
    /// Index of the property that holds the index of a face's image.
    texture: Option<usize>,
    is_strip: bool,
    file: FileFacts,
}

/// Numbers in the whole file that faces depend on.
#[derive(Debug, Clone, Copy)]
pub(super) struct FileFacts {
    pub vertices: usize,
    pub textures: usize,
    /// Whether some faces have colours; the others are white.
    pub has_face_colors: bool,
}

/// Triangles of consecutive faces.
#[derive(Debug, Default)]
pub(super) struct Faces {
    pub triangles: Vec<[u32; 3]>,
    /// Texture coordinates of faces.
    pub uvs: Vec<Vec2>,
    /// Of all triangles if a face has texture coordinates, [`NO_UV`] where it has none; else empty.
    pub corner_uvs: Vec<[u32; 3]>,
    pub has_uvs: bool,
    /// A colour a face, linear light, if faces have colours; else empty.
    pub colors: Vec<[f32; 3]>,
    pub corner_colors: Vec<[u32; 3]>,
    /// The number of each triangle's image; empty if there are fewer than two.
    pub textures: Vec<u32>,
    /// Number of faces.
    pub count: usize,
    /// Number of triangles by the faces' corners alone.
    pub promised: usize,
    /// The error of the first face that is wrong, behind which there are no triangles.
    pub wrong: Option<Wrong>,
}

impl FaceProperties {
    pub fn of(element: &Element, file: FileFacts) -> FaceProperties {
        let is_whole = |list: &usize| element.properties[*list].kind.is_whole();
        FaceProperties {
            corners: element.list("vertex_indices").or(element.list("vertex_index")).filter(is_whole),
            texcoords: element.list("texcoord"),
            color: Color::of(element),
            texture: element.number("texnumber").filter(|_| file.textures > 1),
            is_strip: element.name == "tristrips",
            file,
        }
    }

    /// Reads consecutive faces.
    pub fn read(&self, part: &Part) -> Result<Faces, Wrong> {
        let mut faces = Faces { triangles: Vec::with_capacity(part.count), ..Faces::default() };
        // kept from face to face
        let (mut corners, mut places) = (Vec::new(), Vec::new());
        part.read(|row| {
            let listed = self.corners.map_or(&[][..], |list| row.list(list));
            faces.promised += listed.len().saturating_sub(2);
            faces.has_uvs |= self.texcoords.is_some_and(|list| !row.list(list).is_empty());
            if faces.wrong.is_none() {
                let number = part.first + faces.count;
                faces.wrong = self.add(&mut faces, row, number, (listed, &mut corners, &mut places)).err();
            }
            faces.count += 1;
            Ok(())
        })?;
        Ok(faces)
    }

    /// Adds the triangles of a face by its number. `corners` and `places` are lists for any use.
    fn add(
        &self,
        faces: &mut Faces,
        row: &Row,
        number: usize,
        (listed, corners, places): (&[f64], &mut Vec<u32>, &mut Vec<[u32; 3]>),
    ) -> Result<(), Wrong> {
        self.read_corners(listed, number, corners)?;
        if corners.len() < 3 && !self.is_strip {
            return Err(Wrong::File(format!("face {number} has {} of at least 3 vertices", corners.len())));
        }
        // the corners of each triangle, by their places in the face
        places.clear();
        match self.is_strip {
            true => strip(listed, places),
            false => places.extend((2..corners.len() as u32).map(|c| [0, c - 1, c])),
        }
        if let Some(list) = self.texcoords {
            faces.add_uvs(row.list(list), (number, corners.len()), places)?;
        }
        if self.file.has_face_colors {
            let color = self.color.map_or(Some([1.0; 3]), |color| linear(color.at(row)));
            let color = color.ok_or_else(|| not_finite(format_args!("face {number}")))?;
            let all = faces.triangles.len() + places.len();
            faces.corner_colors.resize(all, [faces.colors.len() as u32; 3]);
            faces.colors.push(color);
        }
        faces.triangles.extend(places.iter().map(|t| t.map_each(|c| corners[c as usize])));
        if let Some(texture) = self.texture {
            let texture = row.number(texture) as i64;
            let texture = usize::try_from(texture).ok().filter(|t| *t < self.file.textures).unwrap_or(0);
            faces.textures.resize(faces.triangles.len(), texture as u32);
        }
        Ok(())
    }

    /// Reads the vertex indices of a face into `corners`; the ends of strips, -1, become 0.
    fn read_corners(&self, listed: &[f64], number: usize, corners: &mut Vec<u32>) -> Result<(), Wrong> {
        let vertices = self.file.vertices;
        corners.clear();
        for index in listed {
            // whole numbers, by their type
            let index = *index as i64;
            corners.push(match usize::try_from(index) {
                Ok(index) if index < vertices => index as u32,
                _ if index == STRIP_END && self.is_strip => 0,
                _ => {
                    let text = format!("face {number} names vertex {index}; there are {vertices}, from 0");
                    return Err(Wrong::File(text));
                }
            });
        }
        Ok(())
    }
}

impl Faces {
    /// Adds the texture coordinates of a face of so many corners, whose triangles have these corners.
    fn add_uvs(
        &mut self,
        texcoords: &[f64],
        (number, corners): (usize, usize),
        places: &[[u32; 3]],
    ) -> Result<(), Wrong> {
        let (pairs, _) = texcoords.as_chunks::<2>();
        if texcoords.is_empty() {
            return Ok(());
        }
        if pairs.len() != corners {
            let count = texcoords.len();
            return Err(Wrong::File(format!(
                "face {number} has a texcoord of {count} numbers; give 2 for each of {corners} vertices"
            )));
        }
        let first = self.uvs.len() as u32;
        self.uvs.extend(pairs.iter().map(|uv| Vec2::from(uv.map_each(|x| x as f32))));
        self.corner_uvs.resize(self.triangles.len(), [NO_UV; 3]);
        self.corner_uvs.extend(places.iter().map(|t| t.map_each(|c| first + c)));
        Ok(())
    }

    /// Appends the faces behind these.
    pub fn append(&mut self, more: Faces) {
        self.count += more.count;
        self.promised += more.promised;
        self.has_uvs |= more.has_uvs;
        if self.wrong.is_some() {
            return;
        }
        self.wrong = more.wrong;
        if !more.corner_uvs.is_empty() {
            let first = self.uvs.len() as u32;
            let shifted = |c: u32| if c == NO_UV { c } else { first + c };
            self.corner_uvs.resize(self.triangles.len(), [NO_UV; 3]);
            self.corner_uvs.extend(more.corner_uvs.iter().map(|t| t.map_each(shifted)));
            self.uvs.extend_from_slice(&more.uvs);
        }
        let first = self.colors.len() as u32;
        self.corner_colors.extend(more.corner_colors.iter().map(|t| t.map_each(|c| first + c)));
        self.colors.extend_from_slice(&more.colors);
        self.triangles.extend_from_slice(&more.triangles);
        if !more.textures.is_empty() {
            self.textures.resize(self.triangles.len() - more.triangles.len(), 0);
            self.textures.extend_from_slice(&more.textures);
        }
    }
}

pub(super) fn not_finite(what: impl std::fmt::Display) -> Wrong {
    Wrong::File(format!("{what} has a colour that is not finite; use finite numbers"))
}

/// The triangles of a strip. Every second one has its corners in reverse, so that all face the same side.
fn strip(corners: &[f64], triangles: &mut Vec<[u32; 3]>) {
    let mut first = 0;
    for part in corners.split(|k| *k as i64 == STRIP_END) {
        let ordered = |k: u32| if k.is_multiple_of(2) { [k, k + 1, k + 2] } else { [k + 1, k, k + 2] };
        triangles.extend((0..part.len().saturating_sub(2) as u32).map(|k| ordered(k).map_each(|c| first + c)));
        first += part.len() as u32 + 1;
    }
}
