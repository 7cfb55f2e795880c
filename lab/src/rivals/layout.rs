//! Structs of the rivals' kernels, as in `lab/wgsl/rivals/layout.wgsl`; `tests/wgsl_layout.rs` compares the two.

use bytemuck::{Pod, Zeroable};

/// Corners of a piece in pixels of the image.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Outline {
    pub a: [f32; 2],
    pub b: [f32; 2],
    pub c: [f32; 2],
    /// 1: the whole image; the corners are of a triangle that holds it.
    pub is_whole: u32,
    pub layer: u32,
}

/// Where a cube map, or one ordinary picture, is taken, and how fine.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Cube {
    /// Relative to the anchor.
    pub eye: [f32; 3],
    /// Texels of a face.
    pub side: u32,
    /// Of the one picture: the dot products of what it shows with these are [-1, 1] times that with `forward`. A cube map has none.
    pub right: [f32; 3],
    pub pad0: u32,
    pub up: [f32; 3],
    pub pad1: u32,
    pub forward: [f32; 3],
    pub pad2: u32,
}

/// What a pair of passes by the texture S is over.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Splat {
    /// Of S, texels.
    pub side: u32,
    /// (piece, slot) pair of the first cell: slots of one piece after the other.
    pub first: u32,
    pub slots: u32,
    pub pad0: u32,
}

/// The cone of all that perspective pieces which lie together see, relative to the anchor.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Cone {
    pub eye: [f32; 3],
    /// The first piece.
    pub first: u32,
    /// Unit.
    pub axis: [f32; 3],
    /// Pieces.
    pub count: u32,
    /// From the axis to the cone's side, radians; from pi on everything is in it.
    pub angle: f32,
    pub pad0: u32,
    pub pad1: u32,
    pub pad2: u32,
}
