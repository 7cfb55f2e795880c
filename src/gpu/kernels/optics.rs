//! What a mirror or a lens brings into kernels.

use super::variant::{Method, RaysKind, Variant};
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

impl Variant {
    /// Rays are bounced after this dispatch.
    pub fn bounces_rays(self) -> bool {
        self.optics.is_some_and(|o| o != OpticsKind::Atlas)
    }

    /// For the rays of the next bounce.
    pub fn after_bounce(self) -> Variant {
        // a few rays, each its own way
        let method = if self.traces() { Method::Trace } else { Method::Raster };
        let by_tile = self.by_tile && method == Method::Raster;
        let rays = RaysKind::Field;
        Variant { rays, method, by_tile, small: false, incoherent: false, slabbed: false, bounced: true, ..self }
    }

    /// A smooth surface is to be met.
    pub fn meets(self) -> bool {
        self.optics.is_some_and(OpticsKind::is_smooth)
    }
}
