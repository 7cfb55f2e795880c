//! `projector`: a viewing volume between control surfaces (Brosz, Samavati, Carpendale and Costa Sousa 2007).
//!
//! `X(a, b, t) = sum of Bernstein(i, m)(t) S_i(u, v)`, t in [0, 1], with `(u, v) = reparam(a, b)` (sections 3.2, 3.4, 4.1):
//! the projector of an image place is the Bezier curve over one point of each of the m + 1 surfaces.

mod bend;
pub mod facets;
pub mod patch;
pub mod reparam;
pub mod round;
pub mod surface;

use super::bundle::Ray;
use super::curve::{Bend, Curve, CurveMap, Curves};
use super::field::RayMap;
use super::pieces::Pieces;
use super::recipe::{Built, Recipe, Setting};
use super::tessellate::{self, Tessellation};
use super::{Rays, glc, mesh};
use crate::arrays::MapEach;
use crate::camera::mesh::spec::{CameraVertex, MeshCameraSpec};
use crate::input::reader::Table;
use crate::input::{Error, Limits, Result};
use facets::Facets;
use glam::{DVec2, DVec3};
use reparam::{Affine, Reparam};
use std::sync::Arc;
use surface::{Plane, Surface};

/// A viewing volume: 2 to 4 surfaces, and where on them an image place lies.
#[derive(Debug, Clone, PartialEq)]
pub struct Volume {
    surfaces: Vec<Surface>,
    reparam: Reparam,
    /// What a surface's piece number counts in the volume's; 0 where it follows from those of the surfaces before.
    strides: Vec<u32>,
    /// 0 without `pieces` surfaces.
    piece_count: u32,
}

/// The camera as read.
#[derive(Debug, PartialEq)]
struct Projector {
    volume: Volume,
    tessellation: Tessellation,
}

/// Reads `surfaces`, `reparam` and the keys of [`Tessellation`].
pub fn read(table: &Table) -> Result<Arc<dyn Recipe>> {
    let [pieces, error] = tessellate::KEYS;
    table.allow(&["kind", "surfaces", "reparam", pieces, error])?;
    let field = table.need("surfaces", "[{ kind = \"point\", at = [0, 0, 5] }, { kind = \"plane\", ... }]")?;
    let items = field.items("a list of 2 to 4 surfaces")?;
    if !(2..=4).contains(&items.len()) {
        let count = items.len();
        return Err(field.error(format_args!("{count} surfaces; a projector has 2 (straight) to 4 (cubic)")));
    }
    let surfaces = items.map(|item| Surface::read(&item)).collect::<Result<_>>()?;
    let reparam = table.or("reparam", Reparam::Affine(Affine::IDENTITY), Reparam::read)?;
    let volume = Volume::new(surfaces, reparam).map_err(|message| field.error(message))?;
    let tessellation = Tessellation::read(table)?;
    if tessellation != Tessellation::Exact && volume.degree() > 1 {
        return Err(table.error("pieces: only straight projectors (two surfaces) can be tessellated; leave it out"));
    }
    Ok(Arc::new(Projector { volume, tessellation }))
}

impl Recipe for Projector {
    fn build(&self, setting: &Setting) -> Result<Built> {
        self.volume.build(setting, self.tessellation)
    }
}

impl Volume {
    /// A volume over 2 to 4 surfaces.
    ///
    /// # Errors
    /// A message where the `pieces` surfaces, each tessellated in its own way, make more pieces than can be numbered.
    pub fn new(surfaces: Vec<Surface>, reparam: Reparam) -> std::result::Result<Volume, String> {
        let facets: Vec<Option<&Facets>> = surfaces.iter().map(as_facets).collect();
        let (mut strides, mut count) = (Vec::new(), 0u32);
        for (k, f) in facets.iter().enumerate() {
            let Some(f) = f.filter(|f| !facets[..k].iter().flatten().any(|g| g.same_pieces(f))) else {
                strides.push(0);
                continue;
            };
            let stride = count.max(1);
            let product = u32::try_from(f.triangles.len()).ok().and_then(|n| n.checked_mul(stride));
            // the highest number stands for no piece
            count =
                product.filter(|n| *n < u32::MAX).ok_or("too many pieces: each of one surface with each of another")?;
            strides.push(stride);
        }
        Ok(Volume { surfaces, reparam, strides, piece_count: count })
    }

    /// A volume over the image itself, of surfaces that are not tessellated.
    pub(super) fn over(surfaces: Vec<Surface>) -> Result<Volume> {
        Volume::new(surfaces, Reparam::Affine(Affine::IDENTITY)).map_err(Error::input)
    }

    fn degree(&self) -> usize {
        self.surfaces.len() - 1
    }

    /// Straight projectors become one piece between planes, a piece for each triangle between `pieces`, else a ray field;
    /// others stay curves. t is in [0, 1].
    pub fn build(&self, setting: &Setting, tessellation: Tessellation) -> Result<Built> {
        let size = setting.size()?;
        let mut notes = Vec::new();
        let straight = if self.degree() == 1 { self.pieces(size, &mut notes, setting.limits())? } else { None };
        let built = match straight {
            Some(pieces) => Built { notes: notes.into(), ..Built::new(size, Rays::Pieces(pieces)) },
            None if self.degree() == 1 && self.piece_count == 0 => {
                tessellation.build(Arc::new(self.clone()), setting)?
            }
            None if self.degree() == 1 && tessellation != Tessellation::Exact => {
                return Err(Error::input(
                    "camera.pieces: straight projectors of a surface of pieces are not tessellated; leave pieces out",
                ));
            }
            None => Built::new(size, Rays::Curves(Curves::of_map(size, Arc::new(self.clone())).ok_or_else(nowhere)?)),
        };
        Ok(Built { t_range: Some([0.0, 1.0]), ..built })
    }

    /// The pieces of straight projectors that are affine over each; `None` where they are not.
    fn pieces(&self, (w, h): (u32, u32), notes: &mut Vec<String>, limits: Limits) -> Result<Option<Pieces>> {
        let Some(reparam) = self.reparam.affine() else { return Ok(None) };
        let planes: Vec<Option<Plane>> = self.surfaces.iter().map(Surface::plane).collect();
        if let [Some(near), Some(far)] = planes[..] {
            let over_image = |s: Plane| {
                let axis = |uv: DVec2| uv.x * s.u + uv.y * s.v;
                [s.at(reparam.offset), axis(reparam.linear.x_axis), axis(reparam.linear.y_axis)]
            };
            let bundle = glc::of_planes(&over_image(near), &over_image(far), w, h).ok_or_else(nowhere)?;
            return Ok(Some(Pieces::whole(bundle, w, h)));
        }
        let Some(spec) = self.mesh(&reparam, &planes) else { return Ok(None) };
        if spec.vertices.iter().all(|v| v.near == v.far) {
            return Err(nowhere());
        }
        mesh::compile(&spec, (w, h), notes, limits).map(Some)
    }

    /// The `mesh` camera with the same rays, where the surfaces are planes or all tessellated alike without overlaps.
    fn mesh(&self, reparam: &Affine, planes: &[Option<Plane>]) -> Option<MeshCameraSpec> {
        let facets = self.surfaces.iter().find_map(as_facets)?;
        let alike =
            |k: usize| planes[k].is_some() || as_facets(&self.surfaces[k]).is_some_and(|f| f.same_pieces(facets));
        if reparam.linear.determinant() == 0.0 || !alike(0) || !alike(1) {
            return None;
        }
        let count = facets.triangles.len() as u32;
        let corners: Vec<[DVec2; 3]> = (0..count).map(|k| facets.corners(k)).collect();
        if mesh::first_overlap(&corners).is_some() {
            return None;
        }
        let image_from_uv = reparam.linear.inverse();
        let vertex = |(k, corner): (usize, usize)| {
            let uv = corners[k][corner];
            let point = |surface: &Surface, plane: &Option<Plane>| match (surface, plane) {
                (Surface::Pieces(f), _) => f.points[f.triangles[k][corner] as usize],
                (_, plane) => plane.map_or(DVec3::NAN, |p| p.at(uv)),
            };
            let [near, far] = [0, 1].map_each(|s| point(&self.surfaces[s], &planes[s]));
            CameraVertex { image: (image_from_uv * (uv - reparam.offset)).to_array(), near, far, w: 1.0 }
        };
        let vertices = (0..count as usize).flat_map(|k| [(k, 0), (k, 1), (k, 2)]).map(vertex).collect();
        let triangles = (0..count).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
        Some(MeshCameraSpec { vertices, triangles, normalize: false })
    }
}

impl CurveMap for Volume {
    fn degree(&self) -> usize {
        self.degree()
    }

    /// No curve where a surface has no point, or where all surfaces have the same.
    fn curve(&self, a: f64, b: f64) -> Option<(u32, Curve)> {
        let uv = self.reparam.at(DVec2::new(a, b))?;
        let (mut points, mut piece) = ([DVec3::ZERO; 4], 0);
        for (k, surface) in self.surfaces.iter().enumerate() {
            let (found, point) = surface.at(uv)?;
            piece += self.strides[k] * found;
            points[k] = point;
        }
        let points = &points[..self.surfaces.len()];
        points.iter().any(|p| *p != points[0]).then(|| (piece, Curve::new(points)))
    }

    fn piece_count(&self) -> usize {
        self.piece_count as usize
    }

    fn bend(&self, ab: [DVec2; 2]) -> Option<Bend> {
        self.bend_over(ab)
    }
}

impl RayMap for Volume {
    fn ray(&self, a: f64, b: f64) -> Option<Ray> {
        self.curve(a, b).map(|(_, curve)| curve.chord())
    }
}

fn as_facets(surface: &Surface) -> Option<&Facets> {
    match surface {
        Surface::Pieces(facets) => Some(facets),
        _ => None,
    }
}

fn nowhere() -> Error {
    Error::input(
        "camera.surfaces: no pixel has a projector: the surfaces are the same or have no points there; move one",
    )
}
