//! `lightfield`: one ray for each sub-pixel of a lenslet display, which shows a different view in each direction.

use super::{Lens, Posed};
use crate::camera::recipe::{Built, Recipe, Setting};
use crate::camera::tessellate::{KEYS, Tessellation};
use crate::camera::values::number_if;
use crate::camera::view::view;
use crate::input::reader::{Field, Table};
use crate::input::{Error, Result};
use glam::{DVec2, DVec3};
use std::sync::Arc;

#[derive(Debug, PartialEq)]
struct Lightfield {
    centre: DVec3,
    /// Towards the viewer.
    normal: DVec3,
    up: DVec3,
    /// Of the display, world units.
    size: DVec2,
    /// Pixels under a lenslet.
    views: [u32; 2],
    /// Tangents of half the angles through which a lenslet sends its pixels.
    tan: DVec2,
    tessellation: Tessellation,
}

/// Pixels under a lenslet at most, each way: as many as an image can have.
const VIEWS_MAX: u64 = 1 << 16;

pub fn read(table: &Table) -> Result<Arc<dyn Recipe>> {
    let own = ["center", "normal", "up", "width", "height", "views", "fov"];
    table.allow(&[&["kind", "t_range"], &own[..], &KEYS].concat())?;
    let length = |key: &str| number_if(&table.need(key, "1")?, |x| x > 0.0, "must be over 0");
    let views = table.need("views", "[5, 5]")?.array::<2>("the pixels of a lenslet, as [across, down]")?;
    Ok(Arc::new(Lightfield {
        centre: table.need("center", "[0, 0, 0]")?.vec3()?,
        normal: table.need("normal", "[0, 0, 1]")?.vec3()?,
        up: table.or("up", DVec3::Y, Field::vec3)?,
        size: DVec2::new(length("width")?, length("height")?),
        // the range is under 2^32
        views: [views[0].integer(1, VIEWS_MAX)? as u32, views[1].integer(1, VIEWS_MAX)? as u32],
        tan: read_fov(&table.need("fov", "40")?)?,
        tessellation: Tessellation::read(table)?,
    }))
}

/// One angle for both ways, or two.
fn read_fov(field: &Field) -> Result<DVec2> {
    let degrees = if field.is_list() {
        DVec2::from(field.numbers::<2>("one or two angles in degrees, as [across, down]")?)
    } else {
        DVec2::splat(field.number()?)
    };
    if degrees.cmple(DVec2::ZERO).any() || degrees.cmpge(DVec2::splat(180.0)).any() {
        return Err(field.error("the angles must lie between 0 and 180 degrees"));
    }
    Ok((degrees / 2.0).map(|x| x.to_radians().tan()))
}

impl Recipe for Lightfield {
    fn build(&self, setting: &Setting) -> Result<Built> {
        let (w, h) = setting.size()?;
        let [nx, ny] = self.views;
        if w % nx != 0 || h % ny != 0 {
            let (w, h) = (w.next_multiple_of(nx), h.next_multiple_of(ny));
            return Err(Error::input(format!("camera.views: the image is no whole number of lenslets; use {w} x {h}")));
        }
        // the display's own frame is that of a viewer who looks at it
        let frame = view(self.centre + self.normal, self.centre, self.up).map_err(|_| {
            Error::input("camera: normal is zero, or up is zero or parallel to it; give other directions")
        })?;
        let lenslets = DVec2::new((w / nx).into(), (h / ny).into());
        let lens = Arc::new(Lenslets { size: self.size, lenslets, tan: self.tan });
        self.tessellation.build(Arc::new(Posed { eye: self.centre, view: frame, lens }), setting)
    }
}

/// Rays from the middles of lenslets into the display, against the light that leaves them: a pixel to the right of its
/// lenslet's middle shines to the left, where one sees what lies to the right.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Lenslets {
    size: DVec2,
    /// Across and down.
    lenslets: DVec2,
    tan: DVec2,
}

impl Lens for Lenslets {
    fn direction(&self, a: f64, b: f64) -> Option<DVec3> {
        let place = DVec2::new(a, b) * self.lenslets;
        let within = (place - self.lenslet(place)) * 2.0 - 1.0;
        let slope = within * self.tan;
        Some(DVec3::new(slope.x, -slope.y, 1.0))
    }

    fn origin(&self, a: f64, b: f64) -> Option<DVec3> {
        let lenslet = self.lenslet(DVec2::new(a, b) * self.lenslets);
        let at = ((lenslet + 0.5) / self.lenslets - 0.5) * self.size;
        Some(DVec3::new(at.x, -at.y, 0.0))
    }
}

impl Lenslets {
    /// The column and row of the lenslet over a place in lenslets; the image's last border belongs to the last lenslet.
    fn lenslet(&self, place: DVec2) -> DVec2 {
        place.floor().min(self.lenslets - 1.0).max(DVec2::ZERO)
    }
}
