//! The rays of one point, and how far outside the apertures each of them passes: all that building a map asks of a lens.

use crate::lens::pupil::SlopeDisk;

/// The rays of one point, named by points (x, y) of a plane, such as their slopes.
pub(crate) trait Pencil {
    /// Returns of each ray how far outside the apertures it passes: the largest height over the clear semi-diameter,
    /// less 1. A ray that gets through has 0 or less, a ray that misses a surface, is reflected or turns back infinity.
    fn excesses(&self, points: &[[f64; 2]]) -> Vec<f64>;

    /// A disk that holds every ray that gets through.
    fn cover(&self) -> SlopeDisk;

    /// A disk about where rays are expected to get through. It may be wrong: it only says where the first search has its
    /// rays closest together.
    fn guess(&self) -> SlopeDisk;
}

/// Pencils over a grid of one parameter or two.
///
/// The first parameter begins at 0. The second is counted in columns of the grid: pencils are asked for at columns and halfway
/// between two.
pub(crate) trait Family: Sync {
    /// Whether each pupil is its own mirror image in y, and round where the first parameter is 0, as with lenses of
    /// revolution and a first parameter that is the distance from the axis. Else rows have two ends of their own.
    const SYMMETRIC: bool;

    /// Whether light may end within the largest first parameter, and the grid then with it.
    const ENDS: bool;

    /// The pencil of a point.
    fn pencil(&self, first: f64, column: f64) -> impl Pencil + '_;

    /// The largest first parameter.
    fn reach(&self) -> f64;

    /// The intervals of the first parameter, and those of the second, 0 for a grid of one parameter.
    fn intervals(&self) -> [usize; 2];
}
