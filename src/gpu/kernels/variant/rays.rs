//! The rays that kernels follow.

use crate::gpu::kernels::OpticsKind;

/// The rays of a camera, or of a bounce.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct RayModel {
    pub kind: RaysKind,
    /// The tiles of several layers, or of several spans of t, are stacked below each other.
    pub slabbed: bool,
    pub optics: Option<OpticsModel>,
}

/// How the kernels hold a camera's rays.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum RaysKind {
    /// Affine pieces.
    #[default]
    Pieces,
    /// A ray a pixel. Rays that are incoherent even after sorting are tested one by one against boxes.
    Field { incoherent: bool },
    /// A Bezier curve a pixel and layer, all of this degree.
    Curves { degree: u32 },
}

/// A mirror that reflects the rays, or a lens that refracts them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct OpticsModel {
    pub kind: OpticsKind,
    /// The rays have bounced there, and start on it.
    pub bounced: bool,
}

impl RaysKind {
    pub fn is_curved(self) -> bool {
        matches!(self, RaysKind::Curves { .. })
    }

    pub fn is_field(self) -> bool {
        matches!(self, RaysKind::Field { .. })
    }
}
