//! A grey picture as the transmission of a stop.
//!
//! The picture is centred on the axis, and its width is the clear diameter of the stop. Between the centres of pixels
//! the transmission is interpolated linearly in both directions; from the outermost centres to the border it is constant,
//! and outside the picture it is 0.

use std::fmt;

/// The transmission of a stop, from a picture.
#[derive(Clone, PartialEq)]
pub struct StopPicture {
    /// Width and height, pixels.
    size: [usize; 2],
    /// For each point of the grid the transmission there and one row below, so that two neighbouring entries are the
    /// four corners of a cell. The points are the centres of the pixels, with the outermost ones repeated once around
    /// them, row by row from the top.
    cells: Box<[[f32; 2]]>,
}

/// Maximum width and height of a picture, pixels. Single precision counts the points of such a grid exactly.
pub const MAX_PICTURE_SIDE: usize = 1024;

impl StopPicture {
    /// Builds a picture from the transmission of its pixels, row by row from the top.
    ///
    /// # Panics
    /// Panics if the number of values is not that of the pixels, a side is 0, or a side exceeds [`MAX_PICTURE_SIDE`].
    pub fn new([width, height]: [usize; 2], values: &[f32]) -> Self {
        assert!(values.len() == width * height && !values.is_empty(), "a value for each pixel");
        assert!(
            width.max(height) <= MAX_PICTURE_SIDE,
            "a picture of at most {MAX_PICTURE_SIDE} pixels a side"
        );
        let stride = width + 2;
        let nearest = |at: usize, side: usize| at.clamp(1, side) - 1;
        let row_of =
            |row: usize| (0..stride).map(move |column| (nearest(row, height), nearest(column, width)));
        let points: Vec<f32> =
            (0..height + 2).flat_map(row_of).map(|(row, column)| values[row * width + column]).collect();
        let below = points.iter().skip(stride).chain(std::iter::repeat(&0.0));
        let mut cells: Vec<[f32; 2]> = points.iter().zip(below).map(|(own, below)| [*own, *below]).collect();
        // The last point is the corner of a cell, too.
        cells.push([0.0; 2]);
        Self { size: [width, height], cells: cells.into() }
    }

    /// Returns the width and the height, pixels.
    pub fn size(&self) -> [usize; 2] {
        self.size
    }

    /// Returns the number of points in a row of [`StopPicture::cells`].
    pub fn stride(&self) -> usize {
        self.size[0] + 2
    }

    /// Returns the places of the picture's borders: column and row of the upper left corner, and of the lower right one.
    pub fn borders(&self) -> [[f64; 2]; 2] {
        [[0.5; 2], self.size.map(|side| side as f64 + 0.5)]
    }

    /// Returns the transmission at each point of the grid, with that one row below.
    pub fn cells(&self) -> &[[f32; 2]] {
        &self.cells
    }

    /// Returns the transmission at a place of the grid, counted in points from the upper left one; 0 outside the picture
    /// and for NaN.
    pub fn at(&self, place: [f64; 2]) -> f64 {
        let [from, to] = self.borders();
        if !(0..2).all(|axis| (from[axis]..=to[axis]).contains(&place[axis])) {
            return 0.0;
        }
        let [column, row] = place.map(|at| at as usize);
        let [right, down] = [place[0] - column as f64, place[1] - row as f64];
        let first = row * self.stride() + column;
        let [[a, b], [c, d]] = [first, first + 1].map(|i| self.cells[i].map(f64::from));
        (a * (1.0 - right) + c * right) * (1.0 - down) + (b * (1.0 - right) + d * right) * down
    }

    /// Returns the factors and constants from x and y, in units of the clear semi-diameter, to a place of the grid.
    pub fn to_place(&self) -> [[f64; 2]; 2] {
        let [width, height] = self.size.map(|side| side as f64);
        // The centre of the first pixel has the number 1.
        [[0.5 * width, 0.5 * width + 0.5], [-0.5 * width, 0.5 * height + 0.5]]
    }

    /// Returns the distance from the axis to the farthest point that passes light, in units of the clear semi-diameter;
    /// at most 1.
    pub fn reach(&self) -> f64 {
        let [[per_column, middle], [per_row, center]] = self.to_place();
        let [from, to] = self.borders();
        let stride = self.stride();
        // Light passes at less than one point's distance from a point that is not black.
        let farthest = |at: usize, axis: usize, middle: f64| {
            let ends = [at as f64 - 1.0, at as f64 + 1.0].map(|end| end.clamp(from[axis], to[axis]) - middle);
            ends.map(f64::abs).into_iter().fold(0.0, f64::max)
        };
        let bright = self.cells[..self.cells.len() - 1].iter().enumerate().filter(|(_, cell)| cell[0] > 0.0);
        let distance = |(i, _)| {
            let [x, y] = [farthest(i % stride, 0, middle), farthest(i / stride, 1, center)];
            (x / per_column).hypot(y / per_row)
        };
        bright.map(distance).fold(0.0, f64::max).min(1.0)
    }

    /// Returns the mean transmission over the disk of the stop.
    pub fn mean(&self) -> f64 {
        const SIDE: u32 = 1024;
        let at = |i: u32| (f64::from(i) + 0.5) * (2.0 / f64::from(SIDE)) - 1.0;
        let [to_column, to_row] = self.to_place();
        let (mut sum, mut count) = (0.0, 0_u32);
        for (x, y) in (0..SIDE).flat_map(|i| (0..SIDE).map(move |j| (at(i), at(j)))) {
            if x * x + y * y <= 1.0 {
                sum += self.at([to_column[0] * x + to_column[1], to_row[0] * y + to_row[1]]);
                count += 1;
            }
        }
        sum / f64::from(count)
    }

    /// Returns the picture with every transmission multiplied by a factor.
    #[must_use]
    pub fn times(&self, factor: f64) -> Self {
        let scaled = |cell: &[f32; 2]| cell.map(|own| (f64::from(own) * factor) as f32);
        Self { size: self.size, cells: self.cells.iter().map(scaled).collect() }
    }
}

impl fmt::Debug for StopPicture {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("StopPicture").field("size", &self.size).finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_lie_over_the_stop_and_add_up_to_their_mean() {
        // Two by one pixels: the picture ends at half the stop's radius.
        let picture = StopPicture::new([2, 1], &[1.0, 0.25]);
        let [to_column, to_row] = picture.to_place();
        let at = |x: f64, y: f64| picture.at([to_column[0] * x + to_column[1], to_row[0] * y + to_row[1]]);
        assert_eq!([at(-0.5, 0.0), at(0.5, 0.0), at(0.0, 0.0)], [1.0, 0.25, 0.625]);
        assert_eq!([at(-1.0, 0.5), at(-0.5, -0.5), at(-0.5, 0.51), at(-1.01, 0.0)], [1.0, 1.0, 0.0, 0.0]);
        assert_eq!([at(f64::NAN, 0.0), at(9.0, 0.0)], [0.0; 2]);
        let square = StopPicture::new([3, 3], &[0.5; 9]);
        assert!((square.mean() - 0.5).abs() < 1e-12 && (square.times(2.0).mean() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn the_reach_ends_where_interpolation_is_black() {
        let one = |size: [usize; 2], bright: usize| {
            let mut values = vec![0.0; size[0] * size[1]];
            values[bright] = 1.0;
            StopPicture::new(size, &values).reach()
        };
        // Half a pixel and the half of the next one, of three over the diameter.
        assert!((one([3, 3], 4) - 2.0_f64.sqrt() * 2.0 / 3.0).abs() < 1e-12);
        assert!((one([3, 1], 1) - (2.0_f64 / 3.0).hypot(1.0 / 3.0)).abs() < 1e-12);
        assert!(one([3, 3], 0) == 1.0 && one([1, 1], 0) == 1.0);
    }

    #[test]
    fn rows_begin_at_the_top() {
        let picture = StopPicture::new([1, 2], &[1.0, 0.5]);
        let [_, to_row] = picture.to_place();
        assert_eq!([1.0, -1.0].map(|y| picture.at([1.0, to_row[0] * y + to_row[1]])), [1.0, 0.5]);
    }
}
