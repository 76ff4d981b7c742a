//! Camera space to world space.

use glam::{DMat3, DVec3};

/// An affine transform from camera space (world units) to world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraToWorld {
    linear: DMat3,
    origin: DVec3,
    is_identity: bool,
}

impl CameraToWorld {
    /// Camera space as it is.
    pub const IDENTITY: Self = Self { linear: DMat3::IDENTITY, origin: DVec3::ZERO, is_identity: true };

    /// From a row-major 4x4 matrix for column vectors. Mirrored and scaled ones are fine.
    ///
    /// # Errors
    /// What keeps the matrix from being an invertible affine transform, in words.
    pub fn from_rows(m: &[f32; 16]) -> Result<Self, &'static str> {
        let m = m.map(f64::from);
        if m.iter().any(|entry| !entry.is_finite()) {
            return Err("has an entry that is not finite");
        }
        if m[12..] != [0.0, 0.0, 0.0, 1.0] {
            return Err("is not affine: its last row must be 0 0 0 1");
        }
        let linear = DMat3::from_cols_array(&[m[0], m[4], m[8], m[1], m[5], m[9], m[2], m[6], m[10]]);
        let origin = DVec3::new(m[3], m[7], m[11]);
        // Each column's length is taken out, so that a small scale is not mistaken for a
        // flattened space.
        let normalized = DMat3::from_cols(
            linear.x_axis.normalize_or_zero(),
            linear.y_axis.normalize_or_zero(),
            linear.z_axis.normalize_or_zero(),
        );
        if normalized.determinant().abs() < 1e-9 {
            return Err("is singular: it flattens space");
        }
        let is_identity = linear == DMat3::IDENTITY && origin == DVec3::ZERO;
        Ok(Self { linear, origin, is_identity })
    }

    /// The inverse, world space to camera space, as a row-major 4x4 matrix for column vectors.
    pub fn inverse_rows(&self) -> [f32; 16] {
        let linear = self.linear.inverse();
        to_rows(linear, -(linear * self.origin))
    }

    /// The transform itself in the form that [`CameraToWorld::from_rows`] takes.
    pub fn rows(&self) -> [f32; 16] {
        to_rows(self.linear, self.origin)
    }

    /// World-space point of a camera-space point.
    pub fn point(&self, p: DVec3) -> DVec3 {
        if self.is_identity { p } else { self.linear * p + self.origin }
    }

    /// World-space unit vector of a camera-space direction that is a unit vector.
    pub fn direction(&self, d: DVec3) -> DVec3 {
        if self.is_identity { d } else { (self.linear * d).normalize() }
    }
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

    #[test]
    fn rows_act_on_columns_and_directions_stay_unit_vectors() {
        // A mirror in x, scaled by 2, then a move.
        let matrix = [
            -2.0, 0.0, 0.0, 5.0, //
            0.0, 0.0, -2.0, 6.0, //
            0.0, 2.0, 0.0, 7.0, //
            0.0, 0.0, 0.0, 1.0,
        ];
        let transform = CameraToWorld::from_rows(&matrix).expect("affine");
        assert_eq!(transform.point(DVec3::new(1.0, 2.0, 3.0)), DVec3::new(3.0, 0.0, 11.0));
        assert_eq!(transform.direction(DVec3::Z), DVec3::NEG_Y);
        assert_eq!(transform.rows(), matrix);
    }

    #[test]
    fn what_is_no_affine_transform_is_refused_in_words() {
        let with = |index: usize, entry: f32| {
            let mut rows = [0.0_f32; 16];
            (0..4).for_each(|i| rows[5 * i] = 1.0);
            rows[index] = entry;
            CameraToWorld::from_rows(&rows)
        };
        assert!(with(3, f32::NAN).expect_err("NaN").contains("not finite"));
        assert!(with(12, 1.0).expect_err("projective").contains("last row"));
        assert!(with(5, 0.0).expect_err("flat").contains("singular"));
        assert!(with(5, 1e-12).is_ok());
        assert_eq!(with(0, 1.0), Ok(CameraToWorld::IDENTITY));
    }
}
