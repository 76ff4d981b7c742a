//! The interface between a lens and the builder of maps: the rays through one point, and the excess by which
//! each of them passes outside the apertures.

use realistic_optics::lens::pupil::SlopeDisk;

/// The rays through one point, identified by points (x, y) of a plane; x and y are, for example, the slopes.
pub trait Pencil {
    /// Returns the excess of each ray: the largest ratio of the ray's height to the clear semi-diameter over
    /// all surfaces, minus 1. It is 0 or less for a ray that passes the lens, and infinity for a ray that
    /// misses a surface, is totally reflected or turns back.
    fn excesses(&self, points: &[[f64; 2]]) -> Vec<f64>;

    /// Returns a disk that contains every ray that passes the lens.
    fn cover(&self) -> SlopeDisk;

    /// Returns a disk around the region where rays are expected to pass the lens. It may be wrong: it only
    /// makes the rays of the first search dense in this region.
    fn guess(&self) -> SlopeDisk;
}

/// A family of pencils over a grid with one or two parameters.
///
/// The first parameter begins at 0. The second is counted in columns of the grid; pencils are requested at
/// columns and halfway between columns.
pub trait Family: Sync {
    /// Whether each pupil is symmetric under y → -y, and round at first parameter 0, as for rotationally
    /// symmetric lenses with the distance from the axis as first parameter. Otherwise the two ends of each
    /// row are found separately.
    const SYMMETRIC: bool;

    /// Whether light may end before the largest first parameter; the grid then ends there, too.
    const ENDS: bool;

    /// Returns the pencil at these parameters.
    fn pencil(&self, first: f64, column: f64) -> impl Pencil + '_;

    /// Returns the largest first parameter.
    fn reach(&self) -> f64;

    /// Returns the number of intervals of the first parameter and of the second; the latter is 0 for a grid
    /// with one parameter.
    fn intervals(&self) -> [usize; 2];
}
