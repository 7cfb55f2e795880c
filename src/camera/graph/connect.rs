//! From a graph to layers: connecting legs straight, in straight parts, or curved.

use super::super::curve::{Curve, CurveMap, Curves};
use super::super::recipe::{Built, Setting};
use super::super::{LAYERS_MAX, Pieces, Rays, mesh};
use super::{Graph, Leg, Net};
use crate::arrays::MapEach;
use crate::camera::mesh::spec::{CameraVertex, MeshCameraSpec};
use crate::camera::values::{number_if, word};
use crate::input::reader::{Field, Table};
use crate::input::{Error, Limits, Result};
use glam::{DVec2, DVec3};
use std::sync::Arc;

/// How rays pass from one view to the next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Bend {
    /// This many straight parts along the curve below; 1 is the paper's connecting segment.
    Straight(usize),
    /// A cubic Bezier curve that leaves and enters along the views' own rays (section 4.3, after Cui et al. 2010).
    Curved,
}

/// The keys that all constructors share.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct JoinOptions {
    pub bend: Bend,
    /// 1: the camera as built; 0: the plain view.
    pub morph: f64,
}

impl JoinOptions {
    pub const KEYS: [&str; 3] = ["longitudinal", "join", "morph"];

    pub fn read(table: &Table) -> Result<JoinOptions> {
        let parts = table.optional("longitudinal", |f| f.integer(1, LAYERS_MAX as u64))?;
        let curved = table.or("join", false, |field| {
            word(field, &[("straight", false), ("bezier", true)], "use join = \"straight\" or \"bezier\"")
        })?;
        if curved && parts.is_some_and(|n| n > 1) {
            return Err(table.error("longitudinal cuts straight segments; leave it out with join = \"bezier\""));
        }
        let bend = if curved { Bend::Curved } else { Bend::Straight(parts.unwrap_or(1) as usize) };
        let morph = |f: &Field| number_if(f, |x| (0.0..=1.0).contains(&x), "lies outside [0, 1]");
        Ok(JoinOptions { bend, morph: table.or("morph", 1.0, morph)? })
    }
}

impl Graph {
    /// The layers of the graph, its connecting legs bent as asked.
    pub fn build(&self, bend: Bend, setting: &Setting) -> Result<Built> {
        let (size, limits) = (setting.size()?, setting.limits());
        let legs: Vec<Leg> = self.legs.iter().flat_map(|leg| leg.bent(bend)).collect();
        if legs.len() > LAYERS_MAX {
            let n = legs.len();
            return Err(Error::input(format!(
                "camera: its rays have {n} segments, and {LAYERS_MAX} is the most; use a smaller longitudinal, or fewer targets \
                 that are hidden at once"
            )));
        }
        let mut notes = Vec::new();
        let layers = legs.iter().map(|leg| self.net.rays(leg, size, &mut notes, limits)).collect::<Result<_>>()?;
        Ok(Built { t_range: Some([0.0, 1.0]), notes: notes.into(), ..Built::of_layers(size, layers) })
    }
}

impl Leg {
    /// The leg as it is rendered: connecting ones by `bend`.
    pub fn bent(&self, bend: Bend) -> Vec<Leg> {
        match (self, bend) {
            (Leg::Connecting(points), Bend::Straight(n)) => {
                let end = |k: usize| match k {
                    0 => points[0].clone(),
                    k if k == n => points[3].clone(),
                    k => (0..points[0].len()).map(|v| curve(points, v).at(k as f64 / n as f64)).collect(),
                };
                let ends: Vec<Vec<DVec3>> = (0..=n).map(end).collect();
                ends.windows(2).map(|pair| Leg::Straight([pair[0].clone(), pair[1].clone()])).collect()
            }
            _ => vec![self.clone()],
        }
    }
}

fn curve(points: &[Vec<DVec3>; 4], vertex: usize) -> Curve {
    Curve::new(&[0, 1, 2, 3].map_each(|k| points[k][vertex]))
}

impl Net {
    fn rays(&self, leg: &Leg, size: (u32, u32), notes: &mut Vec<String>, limits: Limits) -> Result<Rays> {
        Ok(match leg {
            Leg::Straight([from, to]) => Rays::Pieces(self.pieces([from, to], size, notes, limits)?),
            Leg::Connecting([a, b, c, d]) => {
                let first = self.pieces([a, b], size, notes, limits)?;
                let legs = [first, self.pieces([c, d], size, &mut Vec::new(), limits)?];
                Rays::Curves(Curves::new(size.0, size.1, Arc::new(CurvedLeg { legs, size })))
            }
        })
    }

    fn pieces(
        &self,
        [from, to]: [&[DVec3]; 2],
        size: (u32, u32),
        notes: &mut Vec<String>,
        limits: Limits,
    ) -> Result<Pieces> {
        let unit = DVec2::new(size.0 as f64, size.1 as f64);
        let vertex = |k: usize| {
            let image = (self.places_px[k] / unit).to_array();
            CameraVertex { image, near: from[k], far: to[k], w: 1.0 }
        };
        let vertices = (0..self.places_px.len()).map(vertex).collect();
        let spec = MeshCameraSpec { vertices, triangles: self.triangles.clone(), normalize: false };
        mesh::compile(&spec, size, notes, limits)
    }
}

/// Cubic curves, their Bezier points interpolated over image triangles.
#[derive(Debug)]
struct CurvedLeg {
    /// From the first point to the second, and from the third to the fourth.
    legs: [Pieces; 2],
    /// Of the image, pixels.
    size: (u32, u32),
}

impl CurveMap for CurvedLeg {
    fn degree(&self) -> usize {
        3
    }

    fn curve(&self, a: f64, b: f64) -> Option<(u32, Curve)> {
        let place = DVec2::new(a * self.size.0 as f64, b * self.size.1 as f64);
        let piece = self.legs[0].owner_at(place)?;
        let [first, last] = [0, 1].map_each(|k| self.legs[k].bundle_at_place(piece, place).ray(0.0, 0.0));
        let points = [first.origin, first.origin + first.direction, last.origin, last.origin + last.direction];
        Some((piece, Curve::new(&points)))
    }

    fn piece_count(&self) -> usize {
        self.legs[0].pieces.len()
    }
}
