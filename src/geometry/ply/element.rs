//! Vertices of a PLY file.

use super::Wrong;
use super::body::Part;
use super::read::{Element, Row};
use crate::arrays::MapEach;
use crate::geometry::texture::linear_of_srgb;
use crate::image::NumberType;
use glam::{DVec2, DVec3, Vec2, Vec3};

/// Attributes of consecutive vertices; lists of attributes that they do not have are empty.
#[derive(Debug, Default)]
pub(super) struct Vertices {
    pub positions: Vec<DVec3>,
    /// Unit normals, or 0 where a vertex has no direction.
    pub normals: Vec<Vec3>,
    /// Linear light; `None` where a colour is not finite.
    pub colors: Vec<Option<[f32; 3]>>,
    pub uvs: Vec<Vec2>,
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
        let full = match element.properties[properties[0]].kind {
            NumberType::F32 | NumberType::F64 => 1.0,
            NumberType::U16 => 65535.0,
            _ => 255.0,
        };
        Some(Color { properties, full })
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

    /// Reads consecutive vertices.
    pub fn read(&self, part: &Part) -> Result<Vertices, Wrong> {
        let mut vertices = Vertices::default();
        vertices.reserve(part.count, self);
        part.read(|row| {
            vertices.positions.push(self.position(row));
            if let Some(normal) = self.normal {
                let normal: DVec3 = row.numbers(normal).into();
                vertices.normals.push(normal.normalize_or_zero().as_vec3());
            }
            vertices.colors.extend(self.color.map(|color| linear(color.at(row))));
            vertices.uvs.extend(self.uv.map(|uv| DVec2::from(row.numbers(uv)).as_vec2()));
            Ok(())
        })?;
        Ok(vertices)
    }
}

impl Vertices {
    /// Makes room for so many vertices with these properties.
    pub fn reserve(&mut self, count: usize, has: &VertexProperties) {
        let of = |has: bool| if has { count } else { 0 };
        self.positions.reserve_exact(count);
        self.normals.reserve_exact(of(has.normal.is_some()));
        self.colors.reserve_exact(of(has.color.is_some()));
        self.uvs.reserve_exact(of(has.uv.is_some()));
    }

    /// Appends the vertices behind these.
    pub fn append(&mut self, more: &Vertices) {
        self.positions.extend_from_slice(&more.positions);
        self.normals.extend_from_slice(&more.normals);
        self.colors.extend_from_slice(&more.colors);
        self.uvs.extend_from_slice(&more.uvs);
    }
}

/// Linear light of an sRGB colour from 0 to 1; `None` if it is not finite.
pub(super) fn linear(color: [f64; 3]) -> Option<[f32; 3]> {
    let is_finite = color.iter().all(|c| c.is_finite());
    is_finite.then(|| color.map_each(|c| linear_of_srgb(c.clamp(0.0, 1.0)) as f32))
}
