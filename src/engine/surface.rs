//! Structs of the surfaces of mirrors and lenses, as `bounce` and `meet` read them.

use super::tables::split_vector;
use crate::arrays::MapEach;
use crate::camera::optics::{Facets, Quadric, Smooth, Surface, Torus, Wave};
use crate::gpu::Gpu;
use crate::gpu::buffers::Buffers;
use crate::gpu::layout::{self, split2};
use crate::input::Result;
use glam::DVec3;

/// A surface about the anchor, each number a pair.
#[derive(Debug, Clone, PartialEq)]
pub enum OpticsSurface {
    /// Three a facet.
    Corners(Vec<layout::Corner>),
    Quadrics(Vec<layout::Quadric>),
    Torus(layout::Torus),
    Wave(layout::Wave),
}

impl OpticsSurface {
    pub fn new(surface: &Surface, anchor: DVec3) -> OpticsSurface {
        match surface {
            Surface::Facets { facets, .. } => OpticsSurface::Corners(corners(facets, anchor)),
            Surface::Smooth(Smooth::Quadrics(list)) => {
                OpticsSurface::Quadrics(list.iter().map(|q| quadric(q, anchor)).collect())
            }
            Surface::Smooth(Smooth::Torus(t)) => OpticsSurface::Torus(torus(t, anchor)),
            Surface::Smooth(Smooth::Wave(w)) => OpticsSurface::Wave(wave(w, anchor)),
        }
    }

    /// No triangles of the scene.
    #[cfg(feature = "internals")]
    pub fn is_smooth(&self) -> bool {
        !matches!(self, OpticsSurface::Corners(_))
    }

    /// `corners`, 64 bytes each; `quadrics`, 160 bytes each; `tori`, 64 bytes; or `waves`, 48 bytes.
    pub fn upload(&self, gpu: &Gpu, buffers: &mut Buffers) -> Result<()> {
        match self {
            OpticsSurface::Corners(list) => buffers.upload(gpu, "corners", list),
            OpticsSurface::Quadrics(list) => buffers.upload(gpu, "quadrics", list),
            OpticsSurface::Torus(torus) => buffers.upload(gpu, "tori", &[*torus]),
            OpticsSurface::Wave(wave) => buffers.upload(gpu, "waves", &[*wave]),
        }
    }
}

/// Three corners a facet.
fn corners(facets: &Facets, anchor: DVec3) -> Vec<layout::Corner> {
    let corner = |piece: u32, [u, v]: [f64; 2], (p, n): (DVec3, DVec3)| {
        let ([p_hi, p_lo], [n_hi, n_lo]) = (split_vector(p - anchor), split_vector(n));
        layout::Corner { p_hi, piece, p_lo, piece_u: u as f32, n_hi, piece_v: v as f32, n_lo, pad0: 0.0 }
    };
    let facet = |k: usize| {
        let facet = facets.facet(k);
        let (piece, weights) = (facets.coarse_of(k), facets.coarse_weights(k));
        [0, 1, 2].map_each(|c| corner(piece, weights[c], (facet.corners[c], facet.normals[c])))
    };
    (0..facets.triangles.len()).flat_map(facet).collect()
}

fn quadric(q: &Quadric, anchor: DVec3) -> layout::Quadric {
    // without an end: the largest finite number
    let number = |v: f64| split2(v.clamp(-f32::MAX as f64, f32::MAX as f64));
    let a = q.a;
    let [centre_hi, centre_lo] = split_vector(q.centre - anchor);
    let [diagonal_hi, diagonal_lo] = split_vector(DVec3::new(a.x_axis.x, a.y_axis.y, a.z_axis.z));
    let [beside_hi, beside_lo] = split_vector(DVec3::new(a.y_axis.z, a.x_axis.z, a.x_axis.y));
    let ([b_hi, b_lo], [axis_hi, axis_lo]) = (split_vector(q.b), split_vector(q.axis));
    let ([c_hi, c_lo], [rim2_hi, rim2_lo]) = (number(q.c), number(q.rim * q.rim));
    let ([low_hi, low_lo], [high_hi, high_lo]) = (number(q.heights[0]), number(q.heights[1]));
    layout::Quadric {
        centre_hi,
        c_hi,
        centre_lo,
        c_lo,
        diagonal_hi,
        low_hi,
        diagonal_lo,
        low_lo,
        beside_hi,
        high_hi,
        beside_lo,
        high_lo,
        b_hi,
        rim2_hi,
        b_lo,
        rim2_lo,
        axis_hi,
        pad0: 0.0,
        axis_lo,
        pad1: 0.0,
    }
}

fn torus(torus: &Torus, anchor: DVec3) -> layout::Torus {
    let ([centre_hi, centre_lo], [axis_hi, axis_lo]) = (split_vector(torus.centre - anchor), split_vector(torus.axis));
    let ([size_hi, size_lo], [ring_hi, ring_lo]) = (split2(torus.size()), split2(torus.radius / torus.size()));
    layout::Torus { centre_hi, size_hi, centre_lo, size_lo, axis_hi, ring_hi, axis_lo, ring_lo }
}

fn wave(wave: &Wave, anchor: DVec3) -> layout::Wave {
    let ([centre_hi, centre_lo], [half_hi, half_lo]) = (split_vector(wave.centre - anchor), split2(wave.size / 2.0));
    let [amplitude_hi, amplitude_lo] = split2(wave.amplitude);
    let [frequency_hi, frequency_lo] = split2(1.0 / wave.wavelength);
    layout::Wave { centre_hi, half_hi, centre_lo, half_lo, amplitude_hi, amplitude_lo, frequency_hi, frequency_lo }
}
