//! A camera that moves while its shutter is open: two transforms, decomposed and interpolated.
//!
//! Interpolating the entries of two matrices would shrink a rotating camera. Instead, the polar decomposition
//! M = T R S splits each matrix into a translation, a rotation and a symmetric stretch (K. Shoemake and T.
//! Duff, "Matrix Animation and Polar Decomposition", Graphics Interface 1992). Translations and stretches are
//! interpolated linearly, rotations along the shorter great arc of unit quaternions (K. Shoemake, "Animating
//! Rotation with Quaternion Curves", SIGGRAPH 1985). A reflection, such as the one in a pbrt `LookAt`,
//! becomes part of the stretch, so that the remaining factor is a rotation.

use std::borrow::Cow;

use glam::{DMat3, DQuat, DVec3};

use super::transform::{CameraToWorld, TransformError};

/// Camera space to world space at any time.
#[derive(Clone, Debug, PartialEq)]
pub enum CameraMotion {
    /// The same transform at every time.
    Still(CameraToWorld),
    /// A motion from one transform to another.
    Moving(Box<Moving>),
}

/// Two transforms and the times at which they hold.
#[derive(Clone, Debug, PartialEq)]
pub struct Moving {
    pub(super) ends: [CameraToWorld; 2],
    pub(super) parts: [MotionParts; 2],
    pub(super) start: f64,
    pub(super) duration: f64,
}

/// A decomposed transform, which applies the stretch first, then the rotation, then the translation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct MotionParts {
    pub origin: DVec3,
    pub rotation: DQuat,
    pub stretch: DMat3,
}

impl From<CameraToWorld> for CameraMotion {
    fn from(to_world: CameraToWorld) -> Self {
        Self::Still(to_world)
    }
}

impl CameraMotion {
    /// Returns the motion from the transform `from` at time `start` to the transform `to` at the later time
    /// `end`; the camera is at rest before and after. If the rotation between them is by half a turn, its
    /// direction is ambiguous, and one of the two directions is chosen.
    ///
    /// # Errors
    /// [`TransformError::Times`] or [`TransformError::Mirrored`].
    pub fn between(
        (from, start): (CameraToWorld, f64),
        (to, end): (CameraToWorld, f64),
    ) -> Result<Self, TransformError> {
        let duration = end - start;
        if !(duration > 0.0 && duration.is_finite()) {
            return Err(TransformError::Times);
        }
        if (from.linear().determinant() < 0.0) != (to.linear().determinant() < 0.0) {
            return Err(TransformError::Mirrored);
        }
        if from == to {
            return Ok(Self::Still(from));
        }
        let parts = [MotionParts::of(&from), MotionParts::of(&to)];
        Ok(Self::Moving(Box::new(Moving { ends: [from, to], parts, start, duration })))
    }

    /// Returns the transform at a time.
    pub fn at(&self, time: f32) -> Cow<'_, CameraToWorld> {
        let moving = match self {
            Self::Still(to_world) => return Cow::Borrowed(to_world),
            Self::Moving(moving) => moving,
        };
        let along = (f64::from(time) - moving.start) / moving.duration;
        if !(along > 0.0) {
            return Cow::Borrowed(&moving.ends[0]);
        }
        if along >= 1.0 {
            return Cow::Borrowed(&moving.ends[1]);
        }
        let [from, to] = &moving.parts;
        let rotation = DMat3::from_quat(from.rotation.slerp(to.rotation, along));
        let stretch = from.stretch * (1.0 - along) + to.stretch * along;
        Cow::Owned(CameraToWorld::from_parts(rotation * stretch, from.origin.lerp(to.origin, along)))
    }
}

impl MotionParts {
    fn of(transform: &CameraToWorld) -> Self {
        let linear = transform.linear();
        let handed = linear.determinant().signum();
        let rotation = nearest_rotation(linear * handed);
        Self {
            origin: transform.origin(),
            rotation: DQuat::from_mat3(&rotation).normalize(),
            stretch: rotation.transpose() * linear,
        }
    }
}

/// Returns the rotation of the polar decomposition of a matrix with positive determinant, by Newton's
/// iteration Q ← (γ Q + Q⁻ᵀ/γ)/2 with γ = |det Q|^(-1/3) (N. Higham, "Computing the Polar
/// Decomposition - with Applications", *SIAM J. Sci. Stat. Comput.* 7(4), 1986; scaling by the determinant:
/// Byers and Xu, 2008). The iteration converges quadratically.
fn nearest_rotation(matrix: DMat3) -> DMat3 {
    const ENOUGH: u32 = 64;
    let mut q = matrix;
    for _ in 0..ENOUGH {
        let gamma = q.determinant().abs().cbrt().recip();
        let next = (q * gamma + q.inverse().transpose() * gamma.recip()) * 0.5;
        let settled = next.abs_diff_eq(q, 1e-15);
        q = next;
        if settled {
            break;
        }
    }
    q
}

#[cfg(test)]
mod tests {
    use super::*;

    fn placed(linear: DMat3, origin: DVec3) -> CameraToWorld {
        CameraToWorld::from_parts(linear, origin)
    }

    fn motion(from: CameraToWorld, to: CameraToWorld) -> CameraMotion {
        CameraMotion::between((from, 2.0), (to, 4.0)).expect("one motion")
    }

    #[test]
    fn a_turning_camera_turns_evenly_and_stays_rigid() {
        let to = placed(DMat3::from_rotation_y(1.6), DVec3::new(4.0, 0.0, 0.0));
        let moving = motion(CameraToWorld::IDENTITY, to);
        for (time, angle) in [(2.0, 0.0), (2.5, 0.4), (3.0, 0.8), (3.5, 1.2), (4.0, 1.6)] {
            let at = moving.at(time);
            assert!(at.linear().abs_diff_eq(DMat3::from_rotation_y(angle), 1e-14), "{time}");
            assert!((at.origin().x - 4.0 * (f64::from(time) - 2.0) / 2.0).abs() < 1e-14);
        }
    }

    #[test]
    fn before_and_after_the_camera_stands_still() {
        let to = placed(DMat3::from_rotation_x(0.3), DVec3::ONE);
        let moving = motion(CameraToWorld::IDENTITY, to);
        assert_eq!(*moving.at(1.0), CameraToWorld::IDENTITY);
        assert_eq!(*moving.at(4.0), to);
        assert_eq!(*moving.at(9.0), to);
    }

    #[test]
    fn the_decomposition_gives_the_matrix_back() {
        let shear = DMat3::from_cols(DVec3::X, DVec3::new(0.4, 1.0, 0.0), DVec3::new(0.0, -0.2, 1.0));
        for linear in [
            DMat3::from_rotation_z(2.0) * DMat3::from_diagonal(DVec3::new(3.0, 0.5, 1e-3)),
            DMat3::from_rotation_x(-1.0) * shear,
            // A transform with a reflection, like that of a pbrt LookAt.
            DMat3::from_rotation_y(0.7) * DMat3::from_diagonal(DVec3::new(-1.0, 1.0, 1.0)),
            DMat3::IDENTITY * 1e-6,
        ] {
            let parts = MotionParts::of(&placed(linear, DVec3::ZERO));
            let rotation = DMat3::from_quat(parts.rotation);
            let scale = linear.to_cols_array().iter().fold(0.0_f64, |most, entry| most.max(entry.abs()));
            assert!((rotation * parts.stretch).abs_diff_eq(linear, 1e-14 * scale), "{linear}");
            assert!(parts.stretch.abs_diff_eq(parts.stretch.transpose(), 1e-14 * scale), "{linear}");
        }
    }

    #[test]
    fn scale_grows_evenly_while_the_camera_turns() {
        let moving = motion(
            placed(DMat3::IDENTITY, DVec3::ZERO),
            placed(DMat3::from_rotation_z(1.0) * 3.0, DVec3::ZERO),
        );
        let expected = DMat3::from_rotation_z(0.5) * 2.0;
        assert!(moving.at(3.0).linear().abs_diff_eq(expected, 1e-14));
    }

    #[test]
    fn the_shorter_way_round_is_taken() {
        let ends = [3.0, -3.0].map(|angle| placed(DMat3::from_rotation_y(angle), DVec3::ZERO));
        let middle = motion(ends[0], ends[1]).at(3.0).into_owned();
        let behind = DMat3::from_rotation_y(std::f64::consts::PI);
        assert!(middle.linear().abs_diff_eq(behind, 1e-13), "{middle:?}");
    }

    #[test]
    fn what_is_no_motion_is_refused_in_words() {
        let mirrored = placed(DMat3::from_diagonal(DVec3::new(-1.0, 1.0, 1.0)), DVec3::ZERO);
        let refusal = |to, end| CameraMotion::between((CameraToWorld::IDENTITY, 0.0), (to, end));
        assert!(refusal(mirrored, 1.0).expect_err("mirrored").to_string().contains("mirror images"));
        assert!(refusal(mirrored, 0.0).expect_err("no time").to_string().contains("earlier time"));
        assert!(matches!(refusal(CameraToWorld::IDENTITY, 1.0), Ok(CameraMotion::Still(_))));
    }
}
