//! Vertices and faces of a PLY file.

use super::Wrong;
use super::read::{Body, Element, Kind, Row};
use crate::arrays::MapEach;
use glam::{DVec2, DVec3};

/// Ends a part of a triangle strip.
pub(super) const STRIP_END: i64 = -1;

#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Vertex {
    pub position: DVec3,
    pub normal: DVec3,
    /// sRGB, from 0 to 1.
    pub color: [f64; 3],
    pub uv: DVec2,
}

/// A face, or a triangle strip.
#[derive(Debug, Clone, Default)]
pub(super) struct Face {
    /// As in the file: some may have no vertex.
    pub corners: Vec<i64>,
    /// u and v of each corner in turn; or none.
    pub texcoords: Vec<f64>,
    /// sRGB, from 0 to 1.
    pub color: Option<[f64; 3]>,
    /// The number of its image.
    pub texture: i64,
    pub is_strip: bool,
}

/// Properties that are a colour.
#[derive(Debug, Clone, Copy)]
pub(super) struct Color {
    properties: [usize; 3],
    /// The value of a full colour.
    full: f64,
}

impl Color {
    pub fn of(element: &Element) -> Option<Color> {
        const NAMES: [[&str; 3]; 3] =
            [["red", "green", "blue"], ["r", "g", "b"], ["diffuse_red", "diffuse_green", "diffuse_blue"]];
        let properties = element.numbers(&NAMES)?;
        Some(Color { properties, full: element.properties[properties[0]].kind.full_color() })
    }

    /// sRGB, from 0 to 1.
    pub fn at(&self, row: &Row) -> [f64; 3] {
        row.numbers(self.properties).map_each(|c| c / self.full)
    }
}

/// Properties of vertices, by their numbers.
#[derive(Debug)]
pub(super) struct VertexProperties {
    position: [usize; 3],
    pub normal: Option<[usize; 3]>,
    pub color: Option<Color>,
    pub uv: Option<[usize; 2]>,
}

impl VertexProperties {
    /// # Errors
    /// There is no position.
    pub fn of(element: &Element) -> Result<VertexProperties, Wrong> {
        if let Some(axis) = ["x", "y", "z"].into_iter().find(|axis| element.number(axis).is_none()) {
            return Err(Wrong::File(format!("its vertices have no number {axis}; export them with x, y and z")));
        }
        let position = element.numbers(&[["x", "y", "z"]]);
        Ok(VertexProperties {
            position: position.unwrap_or_default(),
            normal: element.numbers(&[["nx", "ny", "nz"]]),
            color: Color::of(element),
            uv: element.numbers(&[["s", "t"], ["u", "v"], ["texture_u", "texture_v"]]),
        })
    }

    pub fn position(&self, row: &Row) -> DVec3 {
        row.numbers(self.position).into()
    }

    pub fn read(&self, body: &mut Body, element: &Element) -> Result<Vec<Vertex>, Wrong> {
        let mut vertices = Vec::with_capacity(element.count);
        body.read(element, &mut |row| {
            vertices.push(Vertex {
                position: self.position(row),
                normal: self.normal.map_or(DVec3::ZERO, |normal| row.numbers(normal).into()),
                color: self.color.map_or([0.0; 3], |color| color.at(row)),
                uv: self.uv.map_or(DVec2::ZERO, |uv| row.numbers(uv).into()),
            });
            Ok(())
        })?;
        Ok(vertices)
    }
}

/// Appends the faces, or strips, of an element.
pub(super) fn read_faces(body: &mut Body, element: &Element, faces: &mut Vec<Face>) -> Result<(), Wrong> {
    let is_strip = element.name == "tristrips";
    let is_whole = |list: &usize| !matches!(element.properties[*list].kind, Kind::F32 | Kind::F64);
    let corners = element.list("vertex_indices").or(element.list("vertex_index")).filter(is_whole);
    let (texcoords, texture) = (element.list("texcoord"), element.number("texnumber"));
    let color = Color::of(element);
    faces.reserve(element.count);
    body.read(element, &mut |row| {
        faces.push(Face {
            corners: corners.map_or_else(Vec::new, |list| row.list(list).iter().map(|k| *k as i64).collect()),
            texcoords: texcoords.map_or_else(Vec::new, |list| row.list(list).to_vec()),
            color: color.map(|color| color.at(row)),
            texture: texture.map_or(0, |k| row.number(k) as i64),
            is_strip,
        });
        Ok(())
    })
}
