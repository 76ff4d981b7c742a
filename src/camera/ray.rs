//! What a host asks with, and what it gets.

use crate::trace::Blocked;

/// What a host asks with. Laid out as the first members of a pbrt-v1 host's own sample.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sample {
    /// Raster x, pixels, growing to the right; may lie outside the raster.
    pub image_x: f32,
    /// Raster y, pixels, growing downward; may lie outside the raster.
    pub image_y: f32,
    /// Lens sample u, in [0, 1].
    pub lens_u: f32,
    /// Lens sample v, in [0, 1].
    pub lens_v: f32,
    /// Time sample, in [0, 1].
    pub time: f32,
}

/// A ray in world space. Laid out as a pbrt-v1 host's own ray.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WorldRay {
    /// Origin, world units.
    pub origin: [f32; 3],
    /// Unit direction.
    pub direction: [f32; 3],
    /// Where along the ray it begins.
    pub mint: f32,
    /// Where along the ray it ends.
    pub maxt: f32,
    /// Time.
    pub time: f32,
}

impl WorldRay {
    /// How far from 1 the square of a direction's length may be: lengths are 1 to 1e-6 then, for the square is off by three
    /// roundings.
    pub(crate) const UNIT: f32 = 1.6e-6;

    /// Whether these are a ray's numbers: a finite origin, a unit direction. Those of image points that are none, or far
    /// out of any image, are not.
    pub(crate) fn is_sound(&self) -> bool {
        let [x, y, z] = self.direction;
        (x * x + y * y + z * z - 1.0).abs() < Self::UNIT && self.origin.iter().all(|part| part.is_finite())
    }
}

/// What becomes of a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outcome {
    /// A ray and its weight, positive.
    Ray(WorldRay, f32),
    /// The lens blocks it: weight 0.
    Blocked(Blocked),
    /// The lens sample fell outside the disk ([`DiskMapping::Rejection`](crate::sampling::DiskMapping::Rejection)): ask
    /// with a new one.
    Redraw,
    /// The shutter is closed over the film point at this time: weight 0.
    Shut,
    /// The wavelength asked for is none, or one at which the lens has no index: weight 0.
    Wavelength,
}
