//! What a host asks with and what it gets: a sample in, a ray in world space with its weight out, or why there is none.

#[cfg(doc)]
use crate::sampling::DiskMapping;
use crate::trace::Blocked;

/// What a host asks with.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sample {
    /// Raster x, pixels, growing to the right; may lie outside the raster.
    pub image_x: f32,
    /// Raster y, pixels, growing downward; may lie outside the raster.
    pub image_y: f32,
    /// u of the lens sample (u, v), in [0, 1].
    pub lens_u: f32,
    /// v of the lens sample (u, v), in [0, 1].
    pub lens_v: f32,
    /// Time as a fraction of the shutter's interval, in [0, 1].
    pub time: f32,
}

/// A ray in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorldRay {
    /// Origin, world units.
    pub origin: [f32; 3],
    /// Unit direction.
    pub direction: [f32; 3],
    /// Where along the ray it begins, world units.
    pub mint: f32,
    /// Where along the ray it ends, world units.
    pub maxt: f32,
    /// Time, in the host's unit.
    pub time: f32,
}

/// What becomes of a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outcome {
    /// A ray and its weight, positive.
    Ray(WorldRay, f32),
    /// The lens blocks it: weight 0.
    Blocked(Blocked),
    /// The lens sample fell outside the disk ([`DiskMapping::Rejection`]): draw another.
    Redraw,
    /// The shutter is closed over the film point at this time: weight 0.
    Shut,
}
