//! The transform from camera space to world space.

use glam::{DMat3, DVec3};
use thiserror::Error;

/// The reason why a matrix is not a valid camera transform; each text continues a sentence that begins "the
/// camera transform".
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum TransformError {
    /// An entry is NaN or infinite.
    #[error("has an entry that is not finite")]
    NotFinite,
    /// The last row differs from 0 0 0 1 by more than rounding.
    #[error("is not affine: its last row must be 0 0 0 1")]
    NotAffine,
    /// An entry is so large that results could leave single precision.
    #[error("has an entry above 1e15, which leaves single precision no room: scale the world")]
    TooLarge,
    /// One axis is stretched so much more than another that little of the other axis's precision is left.
    #[error("is nearly singular: it stretches one axis more than 1e15 times as much as another")]
    NearlySingular,
    /// The matrix has no inverse.
    #[error("is singular: it flattens space")]
    Singular,
    /// The time of the second transform is not later than that of the first.
    #[error("must hold at an earlier time than its end does")]
    Times,
    /// One transform contains a reflection and the other does not.
    #[error("and its end are mirror images of each other, and no motion leads from one to the other")]
    Mirrored,
}

/// An affine transform from camera space to world space. If it scales, the units of the two spaces differ.
///
/// The transform is stored as a 3x3 matrix and a translation, so no fourth coordinate is computed and there
/// is no division.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraToWorld {
    linear: DMat3,
    origin: DVec3,
    is_identity: bool,
    is_rigid: bool,
}

/// Largest deviation of a rigid transform's axes from unit length and right angles that rounding its entries
/// to single precision may cause.
const RIGID: f64 = 1e-5;

/// Deviation below which directions are not normalised, because they are then unit vectors to within 1e-6.
const RIGID_SINGLE: f64 = 5e-7;

/// Largest entry of a matrix; up to this, squares of the transformed coordinates stay in the range of single
/// precision.
const LARGEST: f64 = 1e15;
/// Largest ratio of the stretches along two axes.
const FLATTEST: f64 = 1e15;
/// Largest deviation of the last row from 0 0 0 1, as measured by [`last_row_error`]. An affine matrix that
/// was inverted in single precision by Gauss-Jordan elimination with full pivoting deviates by 4 roundings
/// (2.4e-7) if all axes are stretched equally, and by 2e-6 if one axis is stretched 1000 times as much as
/// another.
const AFFINE: f64 = 1e-5;

impl CameraToWorld {
    /// The identity: camera space is world space.
    pub const IDENTITY: Self =
        Self { linear: DMat3::IDENTITY, origin: DVec3::ZERO, is_identity: true, is_rigid: true };

    /// Returns the transform of a row-major 4x4 matrix that multiplies column vectors; the matrix may reflect
    /// and scale. A last row within rounding of 0 0 0 1, as a single-precision inverse has, counts as 0 0
    /// 0 1.
    ///
    /// # Errors
    /// The matrix is not an invertible affine transform whose results fit in single precision.
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

    /// Returns the transform of a matrix that is given together with its inverse (world space to camera
    /// space); both have the form of [`CameraToWorld::from_rows`]. The caller has computed one of them from
    /// the other in single precision and does not state which.
    ///
    /// The matrix whose last row is nearer to 0 0 0 1 has lost less precision to rounding. If that is the
    /// inverse, it is inverted again in double precision; if both last rows are equally near, `matrix` is
    /// used bit for bit.
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

    /// Checks the linear part and the image of the origin.
    ///
    /// # Errors
    /// The matrix is not invertible, or its results do not fit in single precision.
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

    /// Returns the transform with an invertible linear part and the given image of the origin.
    pub(crate) fn from_parts(linear: DMat3, origin: DVec3) -> Self {
        let is_identity = linear == DMat3::IDENTITY && origin == DVec3::ZERO;
        let is_rigid = (linear.transpose() * linear).abs_diff_eq(DMat3::IDENTITY, RIGID_SINGLE);
        Self { linear, origin, is_identity, is_rigid }
    }

    /// Whether world space is camera space.
    pub(crate) fn is_identity(&self) -> bool {
        self.is_identity
    }

    /// Whether the transform only rotates, translates and reflects, up to the rounding of its entries.
    pub(crate) fn is_rigid(&self) -> bool {
        self.is_rigid
    }

    /// Returns the matrix without the translation.
    pub fn linear(&self) -> DMat3 {
        self.linear
    }

    /// Returns the cube root of the factor by which volumes grow; if the transform keeps angles, this is the
    /// scale of lengths.
    pub fn scale(&self) -> f64 {
        self.linear.determinant().abs().cbrt()
    }

    /// Returns the number of world units per unit of camera space, along the optical axis.
    pub(crate) fn axial_scale(&self) -> f64 {
        self.linear.z_axis.length()
    }

    /// Whether the transform only rotates, translates, reflects and scales uniformly.
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

    /// Returns the transform in the form that [`CameraToWorld::from_rows`] accepts.
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

/// Returns the deviation of the last row from 0 0 0 1, relative to the rows above it. It is the relative
/// change of a point when the last row is ignored, for points whose distance from the origin of camera space
/// is the distance of that origin from the origin of world space, or one unit if that distance is less.
fn last_row_error(m: &[f32; 16]) -> f64 {
    let (linear, origin) = affine_parts(m);
    let [x, y, z, w] = [m[12], m[13], m[14], m[15]].map(f64::from);
    let away = (origin.abs().max_element() / largest_entry(linear)).max(1.0);
    (w - 1.0).abs().max(DVec3::new(x, y, z).abs().max_element() * away)
}

/// Returns the largest absolute value of a matrix's entries.
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

    /// A reflection in x with a scale of 2, then a translation.
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
        // The parameters are the last row's third entry, its fourth entry, and the camera's distance from the
        // world origin.
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
        // Each matrix is identified by an entry that the other matrix lacks.
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
