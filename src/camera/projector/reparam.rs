//! From image coordinates to surface coordinates: the projector's `reparam` (Brosz et al. 2007, section 3.4).

use super::surface::{Reader, read_kind};
use crate::camera::values::number_if;
use crate::image::read_pairs;
use crate::input::Result;
use crate::input::reader::{Field, Table};
use glam::{DMat2, DVec2};
use std::f64::consts::TAU;
use std::fmt;

/// `(u, v)` for every image place `(a, b)`.
#[derive(Debug, Clone, PartialEq)]
pub enum Reparam {
    Affine(Affine),
    /// `x = 2a - 1`, `y = 1 - 2b`: u the angle from +x over a full turn, counter-clockwise, and `v = |(x, y)|^power`; power 1
    /// is `polar`.
    Polar {
        power: f64,
    },
    /// Inside the radius (u, v) comes nearer to the centre, by 1/strength at the centre itself and by nothing at the rim.
    Magnify {
        center: DVec2,
        radius: f64,
        strength: f64,
    },
    Table(Places),
}

/// `linear (a, b) + offset`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Affine {
    pub linear: DMat2,
    pub offset: DVec2,
}

impl Affine {
    pub const IDENTITY: Affine = Affine { linear: DMat2::IDENTITY, offset: DVec2::ZERO };
}

/// (u, v) at the centres of `width x height` cells over the image, bilinear between them and constant beyond.
#[derive(Clone, PartialEq)]
pub struct Places {
    width: u32,
    height: u32,
    places: Vec<DVec2>,
}

impl fmt::Debug for Places {
    /// Every number: what is printed alike is alike.
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{}x{} {:?}", self.width, self.height, self.places)
    }
}

const KINDS: &[Reader<Reparam>] = &[
    ("affine", read_affine),
    ("polar", |table| table.allow(&["kind"]).map(|()| Reparam::Polar { power: 1.0 })),
    ("lens", read_lens),
    ("magnify", read_magnify),
    ("table", read_table),
];

impl Reparam {
    pub(super) fn read(field: &Field) -> Result<Reparam> {
        read_kind(&field.table()?, "affine", KINDS)
    }

    /// (u, v) at the image place; `None`: no ray there.
    pub fn at(&self, ab: DVec2) -> Option<DVec2> {
        match self {
            Reparam::Affine(m) => Some(m.linear * ab + m.offset),
            Reparam::Polar { power } => {
                let (x, y) = (2.0 * ab.x - 1.0, 1.0 - 2.0 * ab.y);
                let rho = x.hypot(y);
                (rho <= 1.0).then(|| DVec2::new(y.atan2(x).rem_euclid(TAU) / TAU, rho.powf(*power)))
            }
            Reparam::Magnify { center, radius, strength } => {
                let q = ab.distance(*center) / radius;
                if q >= 1.0 {
                    return Some(ab);
                }
                let least = 1.0 / strength;
                let s = least + (1.0 - least) * q * q * (3.0 - 2.0 * q);
                Some(*center + (ab - *center) * s)
            }
            Reparam::Table(places) => places.at(ab),
        }
    }

    /// The map as an affine one, where it is.
    pub(super) fn affine(&self) -> Option<Affine> {
        match self {
            Reparam::Affine(affine) => Some(*affine),
            _ => None,
        }
    }
}

impl Places {
    fn at(&self, ab: DVec2) -> Option<DVec2> {
        let along = |x: f64, count: u32| {
            let x = (x * f64::from(count) - 0.5).clamp(0.0, f64::from(count) - 1.0);
            (x.floor(), x - x.floor())
        };
        let ((x, fx), (y, fy)) = (along(ab.x, self.width), along(ab.y, self.height));
        let place = |dx: usize, dy: usize, weight: f64| match weight {
            // a neighbour without a say may be missing
            0.0 => Some(DVec2::ZERO),
            _ => {
                let place = self.places[(y as usize + dy) * self.width as usize + x as usize + dx];
                place.is_finite().then(|| weight * place)
            }
        };
        let upper = place(0, 0, (1.0 - fx) * (1.0 - fy))? + place(1, 0, fx * (1.0 - fy))?;
        Some(upper + place(0, 1, (1.0 - fx) * fy)? + place(1, 1, fx * fy)?)
    }
}

fn read_affine(table: &Table) -> Result<Reparam> {
    table.allow(&["kind", "m"])?;
    let rows = table.need("m", "[[1, 0, 0], [0, 1, 0]]")?.array::<2>("two rows of three numbers")?;
    let row = |k: usize| rows[k].numbers::<3>("a row of three numbers: for a, for b, and alone");
    let ([ua, ub, u0], [va, vb, v0]) = (row(0)?, row(1)?);
    let linear = DMat2::from_cols(DVec2::new(ua, va), DVec2::new(ub, vb));
    Ok(Reparam::Affine(Affine { linear, offset: DVec2::new(u0, v0) }))
}

fn read_lens(table: &Table) -> Result<Reparam> {
    table.allow(&["kind", "power"])?;
    Ok(Reparam::Polar { power: read_positive(&table.need("power", "2")?)? })
}

fn read_magnify(table: &Table) -> Result<Reparam> {
    table.allow(&["kind", "center", "radius", "strength"])?;
    let center: [f64; 2] = table.need("center", "[0.5, 0.5]")?.numbers("an image place, as [a, b]")?;
    let radius = read_positive(&table.need("radius", "0.3")?)?;
    let strength = read_positive(&table.need("strength", "2")?)?;
    Ok(Reparam::Magnify { center: center.into(), radius, strength })
}

fn read_table(table: &Table) -> Result<Reparam> {
    table.allow(&["kind", "file"])?;
    let field = table.need("file", "\"places.npy\"")?;
    let (width, height, places) = read_pairs(&field.path()?, field.loading()).map_err(|e| field.error(e))?;
    if !places.iter().any(|p| p.is_finite()) {
        return Err(field.error("the table holds no pair of finite numbers"));
    }
    Ok(Reparam::Table(Places { width, height, places }))
}

pub(super) fn read_positive(field: &Field) -> Result<f64> {
    number_if(field, |number| number > 0.0, "is not above 0")
}
