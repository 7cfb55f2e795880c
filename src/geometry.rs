//! Triangles and spheres in f64: meshes with their materials, readers, generators, rays cast at them, polynomials in Bernstein form and exact sums.

pub mod bernstein;
pub mod bvh;
pub mod cast;
pub mod dae;
pub mod exact;
pub mod generate;
pub mod gltf;
pub mod heights;
pub mod instances;
pub mod interleave;
mod lex;
pub mod load;
pub mod mesh;
pub mod obj;
pub mod off;
pub mod opacity;
mod parts;
pub mod pattern;
pub mod place;
pub mod places;
pub mod ply;
pub mod primitive;
pub mod scene_mesh;
mod smooth;
pub mod spec;
pub mod spheres;
pub mod stl;
pub mod texture;
pub mod time_steps;
mod weld;
#[cfg(any(feature = "cli", feature = "view"))]
pub mod wires;
