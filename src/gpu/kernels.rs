//! Kernels: each is an entry file under `wgsl/` with the files that it imports.
//!
//! A file says at its top what it stands on, `#import rays/meeting.wgsl`, and declares the buffers and textures that it binds by name alone,
//! `var<storage, read> pairs: array<vec2<u32>>;`. An import without `.wgsl` names an interface, `#import rays/pixel`: a folder has its
//! implementations, and the [`Variant`] chooses one, here `rays/pieces/pixel.wgsl`. An entry file may choose for its kernel:
//! `#choose arithmetic f32`. The joiner ([`Kernel`]) follows the imports, numbers the bindings and sets the `override` constants;
//! naga says which bindings the entry point reaches, and only those are bound.

mod files;
mod kernel;
mod optics;
mod reflect;
mod variant;
pub use files::{Access, Binding, File, Files};
pub use kernel::{Kernel, storage_buffers};
pub use optics::OpticsKind;
pub use reflect::reached;
pub use variant::{
    AdapterPath, Appearance, Arithmetic, EdgeSamples, Extras, LightsKind, MaterialsKind, Method, OpticsModel,
    PrimitivesKind, RayModel, RaysKind, SampleMeasure, SurfaceKind, Textures, TileDepths, TilePath, Variant,
    VerticesKind, Visibility, VolumeKind,
};
