//! `glc`: a general linear camera, by the ends of three generator rays (Yu and McMillan 2004).

use crate::camera::bundle::Bundle;
use crate::camera::glc::of_planes;
use crate::camera::recipe::{Built, Recipe, Setting};
use crate::camera::{Pieces, Rays};
use crate::input::reader::{Field, Table};
use crate::input::{Error, Result};
use glam::DVec3;
use std::sync::Arc;

/// Points at the image's (0, 0), (a = 1) and (b = 1) corners, world units.
#[derive(Debug, Clone, PartialEq)]
pub struct Glc {
    /// Where t is 0.
    pub near: [DVec3; 3],
    /// Where t is 1.
    pub far: [DVec3; 3],
}

/// Reads the camera's table.
pub fn read(table: &Table) -> Result<Arc<dyn Recipe>> {
    table.allow(&["kind", "t_range", "near", "far"])?;
    let near = read_corners(&table.need("near", "[[-1, 1, 0], [1, 1, 0], [-1, -1, 0]]")?)?;
    let far = read_corners(&table.need("far", "[[-2, 2, -1], [2, 2, -1], [-2, -2, -1]]")?)?;
    Ok(Arc::new(Glc { near, far }))
}

fn read_corners(field: &Field) -> Result<[DVec3; 3]> {
    let [at_0, at_a, at_b] = field.array::<3>("three points, as [[x, y, z], [x, y, z], [x, y, z]]")?;
    Ok([at_0.vec3()?, at_a.vec3()?, at_b.vec3()?])
}

impl Recipe for Glc {
    /// One piece: the whole image.
    fn build(&self, setting: &Setting) -> Result<Built> {
        let (width, height) = setting.size()?;
        let bundle = bundle(&self.near, &self.far, width, height)?;
        Ok(Built::new((width, height), Rays::Pieces(Pieces::whole(bundle, width, height))))
    }
}

/// The bundle of a GLC over the whole image, centred on the image's middle.
pub fn bundle(near: &[DVec3; 3], far: &[DVec3; 3], width: u32, height: u32) -> Result<Bundle> {
    let affine = |n: &[DVec3; 3]| [n[0], n[1] - n[0], n[2] - n[0]];
    of_planes(&affine(near), &affine(far), width, height)
        .ok_or_else(|| Error::input("camera: near and far are the same three points, so no ray has a direction"))
}
