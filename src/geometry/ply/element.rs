//! Vertices and faces of a PLY file, as its reader fills them in.

use glam::{DVec2, DVec3};
use ply_rs_bw::ply::{Property, PropertyAccess, PropertyAccessResult};

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

/// An element that is not used.
pub(super) struct Skipped;

impl PropertyAccess for Skipped {
    fn new() -> Skipped {
        Skipped
    }
}

impl PropertyAccess for Vertex {
    fn new() -> Vertex {
        Vertex::default()
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        let Some(value) = number(&property) else { return PropertyAccessResult::Ignored };
        let place = match name {
            "x" => &mut self.position.x,
            "y" => &mut self.position.y,
            "z" => &mut self.position.z,
            "nx" => &mut self.normal.x,
            "ny" => &mut self.normal.y,
            "nz" => &mut self.normal.z,
            "s" | "u" | "texture_u" => &mut self.uv.x,
            "t" | "v" | "texture_v" => &mut self.uv.y,
            _ => return set_color(&mut self.color, name, &property),
        };
        *place = value;
        PropertyAccessResult::Set
    }
}

impl PropertyAccess for Face {
    fn new() -> Face {
        Face::default()
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        match name {
            "vertex_indices" | "vertex_index" => self.corners = integers(property).unwrap_or_default(),
            "texcoord" => self.texcoords = floats(property).unwrap_or_default(),
            "texnumber" => self.texture = number(&property).map_or(0, |n| n as i64),
            "red" | "green" | "blue" => return set_color(self.color.get_or_insert_default(), name, &property),
            _ => return PropertyAccessResult::Ignored,
        }
        PropertyAccessResult::Set
    }
}

pub(super) fn set_color(color: &mut [f64; 3], name: &str, property: &Property) -> PropertyAccessResult {
    let place = ["red", "green", "blue"].iter().position(|own| *own == name);
    let (Some(place), Some(value)) = (place, number(property)) else { return PropertyAccessResult::Ignored };
    color[place] = value / full(property);
    PropertyAccessResult::Set
}

/// The value of a full colour.
fn full(property: &Property) -> f64 {
    match property {
        Property::Float(_) | Property::Double(_) => 1.0,
        Property::UShort(_) => 65535.0,
        _ => 255.0,
    }
}

pub(super) fn number(property: &Property) -> Option<f64> {
    Some(match property {
        Property::Char(v) => (*v).into(),
        Property::UChar(v) => (*v).into(),
        Property::Short(v) => (*v).into(),
        Property::UShort(v) => (*v).into(),
        Property::Int(v) => (*v).into(),
        Property::UInt(v) => (*v).into(),
        Property::Float(v) => (*v).into(),
        Property::Double(v) => *v,
        _ => return None,
    })
}

fn integers(property: Property) -> Option<Vec<i64>> {
    fn wide<T: Into<i64>>(list: Vec<T>) -> Option<Vec<i64>> {
        Some(list.into_iter().map(Into::into).collect())
    }
    match property {
        Property::ListChar(list) => wide(list),
        Property::ListUChar(list) => wide(list),
        Property::ListShort(list) => wide(list),
        Property::ListUShort(list) => wide(list),
        Property::ListInt(list) => wide(list),
        Property::ListUInt(list) => wide(list),
        _ => None,
    }
}

fn floats(property: Property) -> Option<Vec<f64>> {
    match property {
        Property::ListFloat(list) => Some(list.into_iter().map(f64::from).collect()),
        Property::ListDouble(list) => Some(list),
        _ => None,
    }
}
