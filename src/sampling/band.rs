//! A ring of the film with the slopes that are sampled there: what a proof needs to know of a sampler.

/// A ring of the film, and the disk of slopes that holds what is sampled there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Band {
    /// Film radii, mm.
    pub radii: [f64; 2],
    /// Slope of the disk's centre over the film radius, 1/mm: from, to.
    pub center: [f64; 2],
    /// Radius of the disk, in slope.
    pub radius: f64,
}
