//! `ortho_to_perspective`: parallel near the viewer, perspective far away (Brosz et al. 2007, Figure 12).
//!
//! Three planes, m = 2: at near and at the target the image of a parallel projection, at far that of the pinhole at the
//! eye that has the same picture of the target's plane. Projectors start along the view, and end along the pinhole's rays.
//! `blend` is the share of the pinhole in the far surface, in all of the image or at its corners.

use super::viewer::{Viewer, allow, aspect, upright};
use crate::arrays::MapEach;
use crate::camera::projector::Volume;
use crate::camera::projector::patch::Patch;
use crate::camera::projector::surface::Surface;
use crate::camera::recipe::{Built, Recipe, Setting};
use crate::camera::tessellate::Tessellation;
use crate::camera::values::number_if;
use crate::input::Result;
use crate::input::reader::{Field, Table};
use glam::{DMat2, DVec2};
use std::sync::Arc;

#[derive(Debug, PartialEq)]
struct OrthoToPerspective {
    viewer: Viewer,
    half_height: f64,
    /// In the image's corners: rows from the top, each from the left.
    blend: [[f64; 2]; 2],
}

pub fn read(table: &Table) -> Result<Arc<dyn Recipe>> {
    allow(table, &["blend"])?;
    let viewer = Viewer::read(table, [0.0, 3.0])?;
    if !(viewer.near < viewer.distance && viewer.distance < viewer.far) {
        let (near, distance, far) = (viewer.near, viewer.distance, viewer.far);
        return Err(table
            .error(format_args!("the target, at the depth {distance}, must lie between near {near} and far {far}")));
    }
    let blend = table.or("blend", [[1.0; 2]; 2], |field| {
        if !field.is_list() {
            return Ok([[read_share(field)?; 2]; 2]);
        }
        let [above, below] =
            field.array::<2>("a number, or four: [[top left, top right], [bottom left, bottom right]]")?;
        let row = |row: Field| {
            let [left, right] = row.array::<2>("two numbers: left and right")?;
            Ok([read_share(&left)?, read_share(&right)?])
        };
        Ok([row(above)?, row(below)?])
    })?;
    Ok(Arc::new(OrthoToPerspective { viewer, half_height: Viewer::half_height(table)?, blend }))
}

fn read_share(field: &Field) -> Result<f64> {
    number_if(field, |share| (0.0..=1.0).contains(&share), "is not in [0, 1]")
}

impl Recipe for OrthoToPerspective {
    fn build(&self, setting: &Setting) -> Result<Built> {
        let Viewer { near, far, distance, .. } = self.viewer;
        let m = upright(2.0 * distance * self.half_height, aspect(setting.size()?));
        let parallel = |depth: f64| Surface::from(self.viewer.plane(depth, m, DVec2::ZERO));
        Volume::over(vec![parallel(near), parallel(distance), self.far(m, far / distance)])?
            .build(setting, Tessellation::Exact)
    }
}

impl OrthoToPerspective {
    /// The surface at far: `m` at the target, `larger` for the pinhole.
    fn far(&self, m: DMat2, larger: f64) -> Surface {
        let scale = |j: usize, i: usize| 1.0 + self.blend[j][i] * (larger - 1.0);
        let [[s, other], below] = self.blend;
        if [other, below[0], below[1]] == [s; 3] {
            return self.viewer.plane(self.viewer.far, m * scale(0, 0), DVec2::ZERO).into();
        }
        // place times scale, each linear in u and in v: a patch of degree 2 both ways, whose control point (column, row) is the
        // mean over the ways to share the ends 0 0, 0 1 or 1 1 of each direction between the two factors (its polar form)
        let point = |column: usize, row: usize| {
            let ends = |k: usize| [[0, 0], [0, 1], [1, 1]][k];
            let ([x0, x1], [y0, y1]) = (ends(column), ends(row));
            let place = |x: usize, y: usize| m * DVec2::new(x as f64 - 0.5, 0.5 - y as f64);
            let sum = scale(y1, x1) * place(x0, y0)
                + scale(y1, x0) * place(x1, y0)
                + scale(y0, x1) * place(x0, y1)
                + scale(y0, x0) * place(x1, y1);
            self.viewer.point(sum / 4.0, self.viewer.far)
        };
        let points: Vec<_> =
            [0, 1, 2].iter().flat_map(|&row| [0, 1, 2].map_each(|column| point(column, row))).collect();
        Surface::Patch(Patch::uniform([2, 2], 3, &points))
    }
}
