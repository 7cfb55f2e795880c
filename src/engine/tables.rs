//! Rows that follow from scene and plan alone, before any device is touched: the parameters of one job and the look
//! of the scene.

use super::Capacities;
use crate::camera::Camera;
use crate::gpu::rows::{self, split3};
use crate::plan::nodes::Level;
use crate::plan::{Band, Plan};
use crate::scene::Scene;
use crate::stage::AMBIENT;

/// Index of the first and count of the rest.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Span {
    pub first: u32,
    pub count: u32,
}

/// Lights, materials and normals as `shade` reads them.
#[derive(Debug, Clone)]
pub struct Look {
    pub shading: rows::Shading,
    /// Directions of travel.
    pub lights: Vec<[f32; 4]>,
    /// Diffuse colours.
    pub materials: Vec<[f32; 4]>,
    pub normals: Vec<[f32; 3]>,
}

impl Look {
    pub fn new(scene: &Scene) -> Look {
        let mesh = &scene.mesh;
        Look {
            shading: rows::Shading {
                light_count: scene.lights.len() as u32,
                has_normals: !mesh.normals.is_empty() as u32,
                background: scene.background,
                ambient: AMBIENT,
                pad0: 0,
                pad1: 0,
            },
            lights: scene.lights.iter().map(|l| l.as_vec3().extend(0.0).to_array()).collect(),
            materials: mesh.materials.iter().map(|m| [m.diffuse[0], m.diffuse[1], m.diffuse[2], 1.0]).collect(),
            normals: mesh.normals.iter().map(|n| n.to_array()).collect(),
        }
    }
}

/// The parameters of a job: `clusters` of the chunk whose triangles are `ids`, over `band`.
pub fn params(
    camera: &Camera,
    plan: &Plan,
    band: &Band,
    ids: Span,
    clusters: Span,
    vertex_reach: f32,
    capacities: Capacities,
) -> rows::Params {
    let level = |f: fn(&Level) -> u32| {
        let mut words = [0; 8];
        words.iter_mut().zip(&band.nodes.levels).for_each(|(w, l)| *w = f(l));
        words
    };
    rows::Params {
        width: camera.width,
        height: band.rows,
        tiles_x: band.tiles.tiles_x,
        tiles_y: band.tiles.tiles_y,
        levels: band.nodes.levels.len() as u32,
        cluster_first: clusters.first,
        cluster_count: clusters.count,
        id_bits: plan.id_bits,
        queue_capacity: capacities.queue as u32,
        work_capacity: capacities.work as u32,
        pair_capacity: capacities.pairs as u32,
        sheet_rows: band.tiles.sheet_rows,
        id_first: ids.first,
        id_count: ids.count,
        band_row: band.row,
        vertex_reach,
        spans: plan.sheets.spans,
        pad0: 0,
        pad1: 0,
        pad2: 0,
        t_min: split3(camera.t_range[0]),
        t_max: split3(camera.t_range[1]),
        level_start: level(|l| l.start),
        level_width: level(|l| l.width),
        level_height: level(|l| l.height),
    }
}
