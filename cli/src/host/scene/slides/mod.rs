//! The small scenes of the lecture's slides, each with what shows one effect.

pub mod colour;
pub mod gloss;
pub mod motion;
pub mod soft_shadow;
pub mod translucency;
