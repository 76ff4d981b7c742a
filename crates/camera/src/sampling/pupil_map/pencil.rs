//! The interface between a lens and the builder of maps: the rays of one point, and how far outside the apertures each
//! of them passes.

use realistic_optics::lens::pupil::SlopeDisk;

/// The rays of one point, identified by points (x, y) of a plane, such as their slopes.
pub trait Pencil {
    /// Returns how far outside the apertures each ray passes: the largest height over the clear semi-diameter, less 1.
    /// It is 0 or less for a ray that gets through, and infinity for a ray that misses a surface, is reflected or turns
    /// back.
    fn excesses(&self, points: &[[f64; 2]]) -> Vec<f64>;

    /// Returns a disk that holds every ray that gets through.
    fn cover(&self) -> SlopeDisk;

    /// Returns a disk about the region where rays are expected to get through. It may be wrong: it only makes the rays
    /// of the first search dense there.
    fn guess(&self) -> SlopeDisk;
}

/// Pencils over a grid of one parameter or two.
///
/// The first parameter begins at 0. The second is counted in columns of the grid: pencils are requested at columns and
/// halfway between two.
pub trait Family: Sync {
    /// Whether each pupil is its own mirror image in y, and round at first parameter 0, as for lenses of revolution
    /// with the distance from the axis as first parameter. Otherwise each row has two ends of its own.
    const SYMMETRIC: bool;

    /// Whether light may end within the largest first parameter, and the grid with it.
    const ENDS: bool;

    /// Returns the pencil at these parameters.
    fn pencil(&self, first: f64, column: f64) -> impl Pencil + '_;

    /// Returns the largest first parameter.
    fn reach(&self) -> f64;

    /// Returns the numbers of intervals of the first parameter and of the second; the second is 0 for a grid of one
    /// parameter.
    fn intervals(&self) -> [usize; 2];
}
