//! `occlusion`: an occlusion camera (Mei, Popescu and Sacks 2005), as Brosz et al. 2007, section 5 and Figure 10, build it.
//!
//! A pinhole whose rays, from the depth `near` to `far`, are pulled towards a pole of the image: the ray of the image place
//! q passes `q - d unit(q - pole)` there, with d = d_n at near and d_f at far, in heights of the image. So pixels just
//! outside an occluder's silhouette see what lies behind it. In between d is linear in 1/z, which is a straight ray; beyond
//! far d stays d_f. A place nearer to the pole than d goes to the pole itself, not past it: rays stay in order.
//!
//! `join = "linear"`: the bent ray itself, a chain of the segments eye - near - far - end. `join = "bezier"`: the curve of
//! degree 3 over these four points, which starts along the first and ends along the last segment. It bends from the
//! eye on, so it sees less behind the silhouette for the same distortion. (The paper's volume ends at far.)

use super::viewer::{Viewer, allow, aspect, upright};
use crate::camera::projector::Volume;
use crate::camera::projector::surface::{Plane, Pulled, Surface};
use crate::camera::recipe::{Built, Recipe, Setting};
use crate::camera::tessellate::Tessellation;
use crate::camera::values::{number_if, word};
use crate::input::Result;
use crate::input::reader::Table;
use glam::DVec2;
use std::sync::Arc;

#[derive(Debug, PartialEq)]
struct Occlusion {
    viewer: Viewer,
    half_height: f64,
    /// Depth at which the rays end.
    end: f64,
    /// (a, b).
    pole: DVec2,
    /// At near and at far, heights of the image.
    distortion: [f64; 2],
    bezier: bool,
}

pub fn read(table: &Table) -> Result<Arc<dyn Recipe>> {
    allow(table, &["end", "pole", "distortion", "join"])?;
    let viewer = Viewer::read(table, [1.0, 1.5])?;
    if viewer.near == 0.0 {
        return Err(table.error("near is 0; the rays must start to bend in front of the eye"));
    }
    let joins = [("linear", false), ("bezier", true)];
    let bezier = table.or("join", false, |field| word(field, &joins, "must be \"linear\" or \"bezier\""))?;
    let end = table.or("end", 2.0 * viewer.far, |field| {
        number_if(field, |end| end > viewer.far, format_args!("must be beyond far {}", viewer.far))
    })?;
    let pole: [f64; 2] = table.or("pole", [0.5, 0.5], |field| field.numbers("an image place, as [a, b]"))?;
    let distortion = table.or("distortion", [0.0, 0.15], |field| {
        let distortion: [f64; 2] = field.numbers("two shares of the image's height: at near and at far")?;
        let below = distortion.iter().any(|d| *d < 0.0);
        if below { Err(field.error("must not be below 0")) } else { Ok(distortion) }
    })?;
    let half_height = Viewer::half_height(table)?;
    Ok(Arc::new(Occlusion { viewer, half_height, end, pole: pole.into(), distortion, bezier }))
}

impl Recipe for Occlusion {
    fn build(&self, setting: &Setting) -> Result<Built> {
        let size = setting.size()?;
        let aspect = aspect(size);
        let at = |depth: f64, pull: f64| {
            let plane = self.viewer.plane(depth, upright(2.0 * depth * self.half_height, aspect), DVec2::ZERO);
            let pulled = Pulled { plane, pole: self.pole, pull, aspect };
            if pull == 0.0 { Surface::from(plane) } else { Surface::Pulled(pulled) }
        };
        let ([d_near, d_far], Viewer { near, far, .. }) = (self.distortion, self.viewer);
        let eye = Surface::from(Plane::point(self.viewer.eye));
        let stops = [eye, at(near, d_near), at(far, d_far), at(self.end, d_far)];
        if self.bezier {
            return Volume::over(stops.to_vec())?.build(setting, Tessellation::Exact);
        }
        let segment = |two: &[Surface]| Volume::over(two.to_vec())?.build(setting, Tessellation::Exact);
        let segments: Vec<Built> = stops.windows(2).map(segment).collect::<Result<_>>()?;
        Ok(Built {
            t_range: Some([0.0, 1.0]),
            notes: vec!["layers: from the eye to near, on to far, and on to end".into()].into(),
            ..Built::of_layers(size, segments.into_iter().flat_map(|s| s.layers).collect())
        })
    }
}
