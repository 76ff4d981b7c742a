//! The transform from camera space to world space.

use glam::{DMat3, DVec3};
use thiserror::Error;

/// The reason why a matrix is not a camera pose; the text continues "the camera transform".
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum TransformError {
    /// An entry is NaN or infinite.
    #[error("has an entry that is not finite")]
    NotFinite,
    /// The last row is not 0 0 0 1, and rounding does not explain it.
    #[error("is not affine: its last row must be 0 0 0 1")]
    NotAffine,
    /// An entry is so large that results could leave single precision.
    #[error("has an entry above 1e15, which leaves single precision no room: scale the world")]
    TooLarge,
    /// One axis is stretched so much more than another that little is left of the latter.
    #[error("is nearly singular: it stretches one axis more than 1e15 times as much as another")]
    NearlySingular,
    /// The matrix has no inverse.
    #[error("is singular: it flattens space")]
    Singular,
    /// The second transform does not hold at a later time than the first.
    #[error("must hold at an earlier time than its end does")]
    Times,
    /// One transform mirrors and the other does not.
    #[error("and its end are mirror images of each other, and no motion leads from one to the other")]
    Mirrored,
}

/// An affine transform from camera space to world space. If it scales, their units differ.
///
/// It is a 3x3 matrix and a translation: no fourth coordinate is computed and nothing divided.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraToWorld {
    linear: DMat3,
    origin: DVec3,
    is_identity: bool,
    is_rigid: bool,
}

/// Deviation of a rigid transform's axes from unit length and right angles by the rounding of its single-precision
/// entries.
const RIGID: f64 = 1e-5;

/// Deviation below which directions are not normalised: they are unit vectors to 1e-6 then.
const RIGID_SINGLE: f64 = 5e-7;

/// Largest entry of a matrix: squares of its results stay in the range of single precision.
const LARGEST: f64 = 1e15;
/// Largest ratio of the stretches of two axes.
const FLATTEST: f64 = 1e15;
/// Largest deviation of the last row from 0 0 0 1, by [`last_row_error`]. An affine matrix inverted in single precision
/// by Gauss-Jordan with full pivoting deviates by 4 roundings (2.4e-7) if all axes are stretched alike, and by 2e-6 if
/// one is stretched 1000 times as much as another.
const AFFINE: f64 = 1e-5;

impl CameraToWorld {
    /// The identity: camera space is world space.
    pub const IDENTITY: Self =
        Self { linear: DMat3::IDENTITY, origin: DVec3::ZERO, is_identity: true, is_rigid: true };

    /// Returns the transform of a row-major 4x4 matrix for column vectors, which may mirror and scale. A last row
    /// within rounding of 0 0 0 1, as of a single-precision inverse, counts as 0 0 0 1.
    ///
    /// # Errors
    /// The matrix is not an invertible affine transform with room in single precision.
    pub fn from_rows(m: &[f32; 16]) -> Result<Self, TransformError> {
        if m.iter().any(|entry| !entry.is_finite()) {
            return Err(TransformError::NotFinite);
        }
        if last_row_error(m) > AFFINE {
            return Err(TransformError::NotAffine);
        }
        let (linear, origin) = affine_parts(m);
        Self::checked(linear, origin)
    }

    /// Returns the transform of a matrix given with its inverse, world space to camera space, each as in
    /// [`CameraToWorld::from_rows`]. The caller computed one from the other in single precision and does not state which.
    ///
    /// The one whose last row is nearer to 0 0 0 1 has lost less to rounding. If that is the inverse, it is inverted
    /// again in double precision; if both are alike, the matrix is taken bit by bit.
    ///
    /// # Errors
    /// The errors of [`CameraToWorld::from_rows`].
    pub fn from_rows_and_inverse(matrix: &[f32; 16], inverse: &[f32; 16]) -> Result<Self, TransformError> {
        if last_row_error(matrix) <= last_row_error(inverse) {
            return Self::from_rows(matrix);
        }
        let to_camera = Self::from_rows(inverse)?;
        let linear = to_camera.linear.inverse();
        Self::checked(linear, -(linear * to_camera.origin))
    }

    /// Checks a matrix and the image of the origin.
    ///
    /// # Errors
    /// The matrix is not invertible, or leaves no room in single precision.
    fn checked(linear: DMat3, origin: DVec3) -> Result<Self, TransformError> {
        let entries = linear.to_cols_array().into_iter().chain(origin.to_array());
        if entries.fold(0.0, |most, entry| entry.abs().max(most)) > LARGEST {
            return Err(TransformError::TooLarge);
        }
        let lengths = linear.to_cols_array_2d().map(|column| DVec3::from(column).length());
        let [shortest, longest] = [f64::min, f64::max].map(|pick| lengths.into_iter().reduce(pick));
        if longest > shortest.map(|length| length * FLATTEST) {
            return Err(TransformError::NearlySingular);
        }
        // Divides each column by its length, so that a small scale is not mistaken for a flattened space.
        let normalized = DMat3::from_cols(
            linear.x_axis.normalize_or_zero(),
            linear.y_axis.normalize_or_zero(),
            linear.z_axis.normalize_or_zero(),
        );
        if normalized.determinant().abs() < 1e-9 {
            return Err(TransformError::Singular);
        }
        Ok(Self::from_parts(linear, origin))
    }

    /// Returns the transform of an invertible matrix and the image of the origin.
    pub(crate) fn from_parts(linear: DMat3, origin: DVec3) -> Self {
        let is_identity = linear == DMat3::IDENTITY && origin == DVec3::ZERO;
        let is_rigid = (linear.transpose() * linear).abs_diff_eq(DMat3::IDENTITY, RIGID_SINGLE);
        Self { linear, origin, is_identity, is_rigid }
    }

    /// Whether world space is camera space.
    pub(crate) fn is_identity(&self) -> bool {
        self.is_identity
    }

    /// Whether the transform only turns, moves and mirrors, up to the rounding of its entries.
    pub(crate) fn is_rigid(&self) -> bool {
        self.is_rigid
    }

    /// Returns the matrix without the translation.
    pub fn linear(&self) -> DMat3 {
        self.linear
    }

    /// Returns the cube root of the factor by which volumes grow: the scale of lengths if the transform keeps angles.
    pub fn scale(&self) -> f64 {
        self.linear.determinant().abs().cbrt()
    }

    /// Returns world units per unit of camera space, along the optical axis.
    pub(crate) fn axial_scale(&self) -> f64 {
        self.linear.z_axis.length()
    }

    /// Whether the transform only turns, moves, mirrors and scales evenly.
    pub(crate) fn keeps_angles(&self) -> bool {
        let linear = self.linear * self.scale().recip();
        (linear.transpose() * linear).abs_diff_eq(DMat3::IDENTITY, RIGID)
    }

    /// Returns the position of camera space's origin in the world.
    pub fn origin(&self) -> DVec3 {
        self.origin
    }

    /// Returns the inverse, world space to camera space, as a row-major 4x4 matrix for column vectors.
    pub fn inverse_rows(&self) -> [f32; 16] {
        let linear = self.linear.inverse();
        to_rows(linear, -(linear * self.origin))
    }

    /// Returns the transform in the form that [`CameraToWorld::from_rows`] takes.
    pub fn rows(&self) -> [f32; 16] {
        to_rows(self.linear, self.origin)
    }

    /// Returns the world-space point of a camera-space point.
    #[inline(always)]
    pub fn point(&self, p: DVec3) -> DVec3 {
        if self.is_identity { p } else { self.linear * p + self.origin }
    }

    /// Returns the world-space unit vector of a camera-space unit vector.
    #[inline(always)]
    pub fn direction(&self, d: DVec3) -> DVec3 {
        if self.is_identity { d } else { (self.linear * d).normalize() }
    }
}

/// Returns the linear part and the translation of an affine matrix.
fn affine_parts(m: &[f32; 16]) -> (DMat3, DVec3) {
    let m = m.map(f64::from);
    let linear = DMat3::from_cols_array(&[m[0], m[4], m[8], m[1], m[5], m[9], m[2], m[6], m[10]]);
    (linear, DVec3::new(m[3], m[7], m[11]))
}

/// Returns the last row's deviation from 0 0 0 1, relative to the rows above it: the relative change, on leaving the
/// row out, of points as far from camera space's origin as that is from world space's, or one unit away if that is
/// less.
fn last_row_error(m: &[f32; 16]) -> f64 {
    let (linear, origin) = affine_parts(m);
    let [x, y, z, w] = [m[12], m[13], m[14], m[15]].map(f64::from);
    let away = (origin.abs().max_element() / largest_entry(linear)).max(1.0);
    (w - 1.0).abs().max(DVec3::new(x, y, z).abs().max_element() * away)
}

/// Returns the largest entry of a matrix, without its sign.
pub fn largest_entry(matrix: DMat3) -> f64 {
    matrix.to_cols_array().into_iter().fold(0.0, |most, entry| entry.abs().max(most))
}

fn to_rows(linear: DMat3, origin: DVec3) -> [f32; 16] {
    std::array::from_fn(|i| match (i / 4, i % 4) {
        (3, column) => f32::from(u8::from(column == 3)),
        (row, 3) => origin[row] as f32,
        (row, column) => linear.col(column)[row] as f32,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A mirror in x, scaled by 2, then a move.
    const MATRIX: [f32; 16] = [
        -2.0, 0.0, 0.0, 5.0, //
        0.0, 0.0, -2.0, 6.0, //
        0.0, 2.0, 0.0, 7.0, //
        0.0, 0.0, 0.0, 1.0,
    ];

    #[test]
    fn rows_act_on_columns_and_directions_stay_unit_vectors() {
        let transform = CameraToWorld::from_rows(&MATRIX).expect("affine");
        assert_eq!(transform.point(DVec3::new(1.0, 2.0, 3.0)), DVec3::new(3.0, 0.0, 11.0));
        assert_eq!(transform.direction(DVec3::Z), DVec3::NEG_Y);
        assert_eq!(transform.rows(), MATRIX);
    }

    #[test]
    fn what_is_no_affine_transform_is_refused_in_words() {
        let with = |index: usize, entry: f32| {
            let mut rows = [0.0_f32; 16];
            (0..4).for_each(|i| rows[5 * i] = 1.0);
            rows[index] = entry;
            CameraToWorld::from_rows(&rows)
        };
        assert!(with(3, f32::NAN).expect_err("NaN").to_string().contains("not finite"));
        assert!(with(12, 1.0).expect_err("projective").to_string().contains("last row"));
        assert!(with(5, 0.0).expect_err("flat").to_string().contains("singular"));
        assert!(with(5, 1e-12).is_ok());
        assert!(with(5, 1e-16).expect_err("nearly flat").to_string().contains("nearly singular"));
        assert!(with(3, 1e16).expect_err("far away").to_string().contains("above 1e15"));
        assert_eq!(with(0, 1.0), Ok(CameraToWorld::IDENTITY));
    }

    #[test]
    fn a_last_row_within_rounding_is_that_of_an_affine_transform() {
        // The last row's third entry, its fourth, and the camera's distance from world space's origin.
        let with = |third: f32, fourth: f32, away: f32| {
            let mut rows = MATRIX;
            [rows[3], rows[14], rows[15]] = [2.0 * away, third, fourth];
            CameraToWorld::from_rows(&rows).map(|transform| transform.rows()[12..].to_vec())
        };
        let affine = Ok(vec![0.0, 0.0, 0.0, 1.0]);
        let projective = Err(TransformError::NotAffine);
        assert_eq!(with(-7e-9, 1.0 - f32::EPSILON, 10.0), affine);
        assert_eq!(with(1e-6, 1.0, 0.0), affine);
        assert_eq!(with(1e-11, 1.0, 1e5), affine);
        assert_eq!(with(1e-9, 1.0, 1e5), projective);
        assert_eq!(with(1e-4, 1.0, 0.0), projective);
        assert_eq!(with(0.0, 1.001, 0.0), projective);
        assert_eq!(with(1.0, 0.0, 0.0), projective);
    }

    #[test]
    fn the_matrix_that_rounding_spared_is_taken() {
        let both = |matrix, inverse| CameraToWorld::from_rows_and_inverse(&matrix, &inverse);
        let exact = CameraToWorld::from_rows(&MATRIX).expect("affine");
        // An entry that the other matrix lacks identifies each.
        let inverse = |x: f32, third: f32| {
            let mut rows = exact.inverse_rows();
            [rows[3], rows[14]] = [x, third];
            rows
        };
        let mut rounded = MATRIX;
        rounded[14] = 1e-8;
        assert_eq!(both(MATRIX, inverse(2.0, 0.0)), Ok(exact));
        assert_eq!(both(MATRIX, inverse(2.0, 1e-8)), Ok(exact));
        assert_eq!(both(rounded, inverse(2.0, 1e-7)), Ok(exact));
        let inverted = both(rounded, inverse(2.0, 0.0)).expect("affine");
        assert_eq!(inverted.origin(), DVec3::new(4.0, 6.0, 7.0));
        let mut projective = MATRIX;
        projective[14] = 0.1;
        assert_eq!(both(projective, inverse(2.0, -0.1)), Err(TransformError::NotAffine));
    }
}
