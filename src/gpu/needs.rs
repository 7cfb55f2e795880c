//! What the kernels of plain scenes need of an adapter: no more than every WebGPU adapter has.

use super::layout::{GROUP, TEXELS_A_ROW};

/// A limit of adapters.
pub struct Need {
    /// What is limited.
    pub what: &'static str,
    /// The most that kernels of plain scenes take.
    pub needed: u32,
    /// What an adapter allows.
    pub allowed: fn(&wgpu::Limits) -> u32,
}

/// Storage buffers of the kernel that binds most in a scene without optics, samples, caustics and the channel `certified`, pair by pair:
/// as many as every WebGPU adapter has. A kernel that binds more than the adapter has is an error when it is compiled.
pub const STORAGE_BUFFERS: u32 = 8;

/// The same tile by tile, in any scene: those of `edges`.
pub const STORAGE_BUFFERS_BY_TILE: u32 = 12;

/// Limits that these kernels touch. They have no memory of workgroups, no samplers and one bind group; buffers grow up to what an adapter
/// binds.
pub const NEEDS: [Need; 6] = [
    Need {
        what: "storage buffers a kernel",
        needed: STORAGE_BUFFERS,
        allowed: |limits| limits.max_storage_buffers_per_shader_stage,
    },
    Need { what: "uniform buffers a kernel", needed: 3, allowed: |limits| limits.max_uniform_buffers_per_shader_stage },
    Need { what: "textures a kernel", needed: 9, allowed: |limits| limits.max_sampled_textures_per_shader_stage },
    Need {
        what: "written textures a kernel",
        needed: 1,
        allowed: |limits| limits.max_storage_textures_per_shader_stage,
    },
    Need {
        what: "threads a workgroup",
        needed: GROUP,
        allowed: |limits| limits.max_compute_invocations_per_workgroup.min(limits.max_compute_workgroup_size_x),
    },
    Need { what: "texels a row of a texture", needed: TEXELS_A_ROW, allowed: |limits| limits.max_texture_dimension_2d },
];

/// What an adapter with these limits has too little of, if anything.
pub fn lacks(limits: &wgpu::Limits) -> Option<String> {
    let need = NEEDS.iter().find(|need| (need.allowed)(limits) < need.needed)?;
    Some(format!("{} {}, {} needed", (need.allowed)(limits), need.what, need.needed))
}
