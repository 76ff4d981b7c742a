//! Where the camera stands, how it moves, and when its shutter is open.

pub(crate) mod motion;
mod pose;
pub(crate) mod shutter;
pub(crate) mod transform;

pub(crate) use pose::*;
