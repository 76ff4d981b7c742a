//! The pose of a camera in a scene.

/// The pose of a camera: the row-major matrix that maps column vectors from camera space, mm, to the space of the
/// scene.
pub type Pose = [f32; 16];

/// The pose at the scene's origin, level, looking along +z.
pub const LEVEL: Pose = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];

/// Returns the pose at a position, mm, with a downward tilt in degrees.
pub fn tilted(degrees: f32, [x, y, z]: [f32; 3]) -> Pose {
    let (sine, cosine) = degrees.to_radians().sin_cos();
    [1.0, 0.0, 0.0, x, 0.0, cosine, -sine, y, 0.0, sine, cosine, z, 0.0, 0.0, 0.0, 1.0]
}

/// Returns the pose moved back along its own axis by `distance`, mm.
pub fn moved_back(pose: &Pose, distance: f32) -> Pose {
    let mut moved = *pose;
    for row in 0..3 {
        moved[4 * row + 3] -= distance * pose[4 * row + 2];
    }
    moved
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_camera_moves_back_along_its_own_axis() {
        let pose = moved_back(&tilted(30.0, [1.0, 2.0, 3.0]), 10.0);
        let position = [pose[3], pose[7], pose[11]];
        // The camera looks down by 30 degrees, and so rises as it moves back.
        let expected = [1.0, 2.0 + 5.0, 3.0 - 75.0_f32.sqrt()];
        assert!(position.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-5), "{position:?}");
        assert_eq!(moved_back(&LEVEL, 0.0), LEVEL);
    }
}
