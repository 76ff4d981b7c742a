//! Where the camera stands, how it moves, and when its shutter is open.
//!
//! In come rays in camera space and times as fractions of the shutter's interval, out go rays in world space.

pub(crate) mod motion;
mod pose;
pub(crate) mod shutter;
mod single;
mod to_world;
pub(crate) mod transform;

pub(crate) use pose::Placement;
pub(crate) use single::{RangedRays, SingleToWorld};
pub(crate) use to_world::ToWorld;
