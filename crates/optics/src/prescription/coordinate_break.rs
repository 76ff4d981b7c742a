//! Changes of frame between the surfaces of a lens, as Zemax's coordinate breaks and CODE V's decentres state them.

/// A change of frame in front of a surface, or in front of the film: the frame is moved by `shift` and then turned by
/// `rotation`. A point with the coordinates q in the new frame has the coordinates `rotation` q + `shift` in the old
/// one.
///
/// Frames are right-handed, with z along the axis from the scene to the film, y up and x to the right as seen from the
/// film. A mirror does not turn the frame; behind it light travels toward -z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoordinateBreak {
    /// The rotation, by rows; its columns are the new axes in the old frame.
    pub rotation: [[f64; 3]; 3],
    /// The new origin in the old frame, mm.
    pub shift: [f64; 3],
}

/// Largest deviation of a rotation from the identity that rounding explains.
const ROUNDING: f64 = 1e-14;

impl CoordinateBreak {
    /// No change.
    pub const NONE: Self =
        Self { rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], shift: [0.0; 3] };

    /// Returns a shift along the axes, mm.
    pub fn shifted(shift: [f64; 3]) -> Self {
        Self { shift, ..Self::NONE }
    }

    /// Returns the rotation by angles in degrees about the axes x, y and z, one after the other, each axis as the
    /// rotations before have left it: `R_x` `R_y` `R_z`. A positive angle about x turns the z axis toward -y.
    pub fn tilted(degrees: [f64; 3]) -> Self {
        let about = |axis: usize| {
            let (sin, cos) = degrees[axis].to_radians().sin_cos();
            let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
            let mut turn = Self::NONE;
            turn.rotation[i][i] = cos;
            turn.rotation[j][j] = cos;
            turn.rotation[i][j] = -sin;
            turn.rotation[j][i] = sin;
            turn
        };
        about(0).then(&about(1)).then(&about(2))
    }

    /// Returns Zemax's coordinate break (COORDBRK): decentre in x and y, mm, and tilts about x, y and z, degrees. With
    /// `tilts_first` the tilts precede, in the order z, y, x; otherwise they follow, in the order x, y, z. The two
    /// orders with negated numbers are inverse to each other.
    pub fn zemax([x, y]: [f64; 2], degrees: [f64; 3], tilts_first: bool) -> Self {
        if tilts_first {
            return Self::zemax([-x, -y], degrees.map(|angle| -angle), false).inverse();
        }
        Self::shifted([x, y, 0.0]).then(&Self::tilted(degrees))
    }

    /// Returns this change followed by `next`, which is given in the new frame. A result that turns nothing but
    /// for rounding errors is an exact shift.
    #[must_use]
    pub fn then(&self, next: &Self) -> Self {
        let moved = self.turned(next.shift);
        let column = |j: usize| self.turned(std::array::from_fn(|i| next.rotation[i][j]));
        let columns: [[f64; 3]; 3] = std::array::from_fn(column);
        let rotation = std::array::from_fn(|i| std::array::from_fn(|j| columns[j][i]));
        let shift = std::array::from_fn(|i| self.shift[i] + moved[i]);
        let is_turned = !std::iter::zip(columns.as_flattened(), Self::NONE.rotation.as_flattened())
            .all(|(own, none)| (own - none).abs() <= ROUNDING);
        if is_turned {
            return Self { rotation, shift };
        }
        let size = self.shift.iter().chain(&next.shift).fold(0.0_f64, |size, part| size.max(part.abs()));
        Self::shifted(shift.map(|part| if part.abs() <= ROUNDING * size { 0.0 } else { part }))
    }

    /// Returns the change back.
    #[must_use]
    pub fn inverse(&self) -> Self {
        let rotation = std::array::from_fn(|i| std::array::from_fn(|j| self.rotation[j][i]));
        let back = Self { rotation, shift: [0.0; 3] }.turned(self.shift);
        Self { rotation, shift: back.map(|part| 0.0 - part) }
    }

    /// Returns a direction of the new frame in the old frame.
    pub fn turned(&self, direction: [f64; 3]) -> [f64; 3] {
        self.rotation.map(|row| row.iter().zip(direction).map(|(a, b)| a * b).sum())
    }

    /// Returns a point of the new frame in the old frame.
    pub fn point(&self, point: [f64; 3]) -> [f64; 3] {
        let turned = self.turned(point);
        std::array::from_fn(|i| turned[i] + self.shift[i])
    }

    /// Returns the same change with the z axes of both frames reversed.
    #[must_use]
    pub fn mirrored(&self) -> Self {
        let sign = |i: usize| if i == 2 { -1.0 } else { 1.0 };
        Self {
            rotation: std::array::from_fn(|i| {
                std::array::from_fn(|j| sign(i) * sign(j) * self.rotation[i][j])
            }),
            shift: std::array::from_fn(|i| sign(i) * self.shift[i]),
        }
    }

    /// Returns the length along z, if the change is no more than a shift along z.
    pub fn along_axis(&self) -> Option<f64> {
        let [x, y, z] = self.shift;
        (self.rotation == Self::NONE.rotation && x == 0.0 && y == 0.0).then_some(z)
    }

    /// Returns the change with every length multiplied by `factor`.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        Self { shift: self.shift.map(|part| part * factor), ..*self }
    }

    /// Returns whether all numbers are finite.
    pub fn is_finite(&self) -> bool {
        self.rotation.as_flattened().iter().chain(&self.shift).all(|number| number.is_finite())
    }

    /// Returns the decentre, mm, and the angles of [`tilted`](Self::tilted), degrees, that make this change after a shift
    /// along z: the shift, the decentre and the angles.
    pub fn parts(&self) -> (f64, [f64; 2], [f64; 3]) {
        let [x, y, z] = self.shift;
        let r = &self.rotation;
        // R_x R_y R_z has sin y in its corner; beside a quarter turn about y, x and z turn about one axis.
        let about_y = r[0][2].clamp(-1.0, 1.0).asin();
        let (about_x, about_z) = if r[0][0].hypot(r[0][1]) > 1e-9 {
            ((-r[1][2]).atan2(r[2][2]), (-r[0][1]).atan2(r[0][0]))
        } else {
            (r[2][1].atan2(r[1][1]), 0.0)
        };
        (z, [x, y], [about_x, about_y, about_z].map(f64::to_degrees))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: &CoordinateBreak, b: &CoordinateBreak) -> bool {
        let numbers = |change: &CoordinateBreak| [change.rotation.as_flattened(), &change.shift].concat();
        numbers(a).iter().zip(numbers(b)).all(|(a, b)| (a - b).abs() < 5e-7)
    }

    #[test]
    fn breaks_of_both_orders_follow_zemax() {
        // 5 mm; break (1, 2, 10, 20, 30, 0); 4 mm; break (-1, -2, -10, -20, -30, flag 1), 3 mm: OpticStudio's rule, by hand.
        let gap = |z: f64| CoordinateBreak::shifted([0.0, 0.0, z]);
        let first = gap(5.0).then(&CoordinateBreak::zemax([1.0, 2.0], [10.0, 20.0, 30.0], false));
        let rotation = [
            [0.813798, -0.469846, 0.342020],
            [0.543838, 0.823173, -0.163176],
            [-0.204874, 0.318796, 0.925417],
        ];
        assert!(close(&first, &CoordinateBreak { rotation, shift: [1.0, 2.0, 5.0] }), "{first:?}");
        let back = CoordinateBreak::zemax([-1.0, -2.0], [-10.0, -20.0, -30.0], true);
        let last = first.then(&gap(4.0)).then(&back).then(&gap(3.0));
        assert!(close(&last, &CoordinateBreak::shifted([1.368081, -0.652704, 11.701666])), "{last:?}");
        assert_eq!(last.rotation, CoordinateBreak::NONE.rotation, "rounding is removed");
    }

    #[test]
    fn a_fold_of_a_right_angle_leads_upward() {
        let turn = CoordinateBreak::tilted([45.0, 0.0, 0.0]);
        let folded = turn.then(&turn).then(&CoordinateBreak::shifted([0.0, 0.0, -30.0]));
        assert!((folded.shift[1] - 30.0).abs() < 1e-12 && folded.shift[2].abs() < 1e-12, "{folded:?}");
    }

    #[test]
    fn parts_make_the_change_again_and_the_inverse_undoes_it() {
        for degrees in [[10.0, 20.0, 30.0], [-120.0, 60.0, 170.0], [5.0, 90.0, 0.0], [0.0, -90.0, 12.0]] {
            let change = CoordinateBreak::shifted([1.0, -2.0, 3.0]).then(&CoordinateBreak::tilted(degrees));
            let (z, [x, y], degrees) = change.parts();
            let again = CoordinateBreak::shifted([x, y, z]).then(&CoordinateBreak::tilted(degrees));
            assert!(close(&change, &again), "{change:?} {again:?}");
            assert_eq!(change.then(&change.inverse()).along_axis(), Some(0.0), "{change:?}");
        }
        assert_eq!(CoordinateBreak::shifted([0.0, 0.0, 2.0]).along_axis(), Some(2.0));
        assert_eq!(CoordinateBreak::shifted([0.0, 1.0, 2.0]).along_axis(), None);
    }
}
