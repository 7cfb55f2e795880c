//! What a mirror or a lens brings into kernels.

use crate::camera::optics::{Optics, Smooth, Surface};

/// What the surface of a camera's optics is made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OpticsKind {
    Facets,
    /// Facets that are looked up in an atlas.
    Atlas,
    Quadrics,
    Torus,
    Wave,
}

impl OpticsKind {
    #[cfg(feature = "internals")]
    pub const ALL: [OpticsKind; 5] =
        [OpticsKind::Facets, OpticsKind::Atlas, OpticsKind::Quadrics, OpticsKind::Torus, OpticsKind::Wave];

    pub fn of(optics: &Optics) -> OpticsKind {
        match &optics.surface {
            Surface::Facets { .. } if optics.atlas.is_some() => OpticsKind::Atlas,
            Surface::Facets { .. } => OpticsKind::Facets,
            Surface::Smooth(Smooth::Quadrics(_)) => OpticsKind::Quadrics,
            Surface::Smooth(Smooth::Torus(_)) => OpticsKind::Torus,
            Surface::Smooth(Smooth::Wave(_)) => OpticsKind::Wave,
        }
    }

    /// The surface is no triangles, and met by `meet`.
    pub fn is_smooth(self) -> bool {
        matches!(self, OpticsKind::Quadrics | OpticsKind::Torus | OpticsKind::Wave)
    }
}
