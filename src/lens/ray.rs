//! A ray in lens space: origin at the vertex of the first interface, +z toward the scene, +x image right, +y image up,
//! millimetres. What tracing takes and gives.

/// A ray in lens space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// A point on it, mm.
    pub origin: [f64; 3],
    /// Its direction; any length but 0 before a lens, 1 behind one.
    pub direction: [f64; 3],
}
