//! What several samples per pixel bring into kernels.

use super::parts::*;
use super::variant::{RaysKind, Variant};

impl Variant {
    /// Edge pixels have several samples.
    pub fn samples_edges(self) -> bool {
        self.samples > 1
    }

    /// The edges of pixels are found tile by tile where there is one tile to each.
    pub fn samples_by_tile(self) -> bool {
        self.by_tile && self.f64_depths && self.samples_edges() && !self.slabbed
    }

    /// Strips of four that the samples of a pixel take.
    pub fn strips(self) -> f64 {
        f64::from(self.samples.div_ceil(4))
    }

    /// Largest distance of a sample from its pixel's centre, px.
    pub fn sample_reach(self) -> f64 {
        // rounded up
        f64::from(self.samples - 1) / f64::from(2 * self.samples) * (1.0 + f64::from(f32::EPSILON))
    }

    /// The constants of kernels that test triangles against samples.
    pub fn sample_constants(self) -> Vec<(&'static str, f64)> {
        let samples = [("SAMPLES", f64::from(self.samples)), ("SAMPLE_REACH", self.sample_reach())];
        [self.constants(), samples.to_vec()].concat()
    }

    /// The rays of samples in recheck arithmetic, and what they bind beside the pixels' own.
    pub fn sample_rays(self, bindings: &mut Vec<Binding>) -> &'static [Parts] {
        if self.rays == RaysKind::Pieces {
            bindings.push(uniform("sample_offsets", "SampleOffsets"));
            return &[SAMPLE_OFFSETS, snippets!("camera/pieces_sample.wgsl")];
        }
        bindings.push(reads("sample_ray_deltas", "array<f32>"));
        &[snippets!("camera/field_sample.wgsl")]
    }
}
