//! The small scenes of the lecture's slides, each of which shows one effect.

pub mod colour;
pub mod gloss;
pub mod motion;
pub mod soft_shadow;
pub mod translucency;
