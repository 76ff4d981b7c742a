//! The knots of a slice's map: the disk's directions in which it is tabulated.

use std::f64::consts::PI;

use super::super::arc::direction;

/// Knots between the lens direction along the film point's and the opposite one, less one.
pub(crate) const CELLS: usize = 128;
/// Knots.
pub(crate) const KNOTS: usize = CELLS + 1;
/// The edge is traced at every knot whose number is a multiple of this.
pub(crate) const TRACE_EVERY: usize = 8;

/// The disk's directions at the knots: pseudo-angles q = 1 - cos/(|cos| + sin) in equal steps from
/// 0 to 2.
pub(crate) struct Knots {
    pub angles: Vec<f64>,
    /// The same over π.
    pub parts: Vec<f64>,
    pub directions: Vec<[f64; 2]>,
}

impl Knots {
    pub fn new() -> Self {
        let angle = |knot: usize| {
            let q = 2.0 * knot as f64 / CELLS as f64;
            (if q <= 1.0 { q } else { 2.0 - q }).atan2(1.0 - q)
        };
        let angles: Vec<f64> = (0..KNOTS).map(angle).collect();
        let directions = angles.iter().map(|&angle| direction(angle)).collect();
        Self { directions, parts: angles.iter().map(|angle| angle / PI).collect(), angles }
    }
}
