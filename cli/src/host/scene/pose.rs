//! Where a camera stands in a scene.

/// Where a camera stands: the row-major matrix for column vectors that takes its space, mm, to the
/// scene's.
pub type Pose = [f32; 16];

/// At the scene's origin, level, looking along +z.
pub const LEVEL: Pose = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];

/// At a place, mm, tilted downward by an angle in degrees.
pub fn tilted(degrees: f32, [x, y, z]: [f32; 3]) -> Pose {
    let (sine, cosine) = degrees.to_radians().sin_cos();
    [1.0, 0.0, 0.0, x, 0.0, cosine, -sine, y, 0.0, sine, cosine, z, 0.0, 0.0, 0.0, 1.0]
}
