//! The projector: each surface and each reparametrisation by the formulas of `docs/reference/definitions.md` written down a second time,
//! what it compiles to, and curves through their control points.

pub mod bad;
pub mod make;
pub mod maps;
pub mod pieces;
pub mod surfaces;
pub mod volumes;
