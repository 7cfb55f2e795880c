//! What drawings of a camera show: its volume, and its scene as lines.

pub mod volume;
pub mod wires;
