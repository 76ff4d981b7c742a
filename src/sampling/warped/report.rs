//! What building a table took, and the film radii that it had to give up.

/// What building the table took, and what it could not fit.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BuildReport {
    /// Film radii in the table.
    pub slices: usize,
    /// Rays traced.
    pub rays: u32,
    /// Share of the film radius over which the rear element's disk is used instead of an outline.
    pub covered: f64,
}

/// Why there is no map, or no close one, for a film radius.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MapFailure {
    /// Light gets through in several components, or round a hole.
    Components,
    /// A half-line from its middle meets the pupil's edge more than once, or the pupil jumps from one radius to the next.
    NotStarShaped,
    /// The pupil changes faster with film radius than the table can follow: a larger shape is sampled, not the rear
    /// element's disk.
    TooFast,
    /// No light was found in the plane of axis and film point, within the image.
    NoLight,
    /// The rays that a table may take were spent.
    RaysSpent,
    /// The pupil is so narrow that slopes in single precision cannot follow it over the film.
    TooNarrow,
}

/// Film radii that were given up: more than the pupil is sampled there, mostly the rear element's disk.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GivenUp {
    /// From and to, mm.
    pub radii: [f64; 2],
    /// Why.
    pub reason: MapFailure,
    /// Least share of samples found to get through, where any did; 0 where none did.
    pub acceptance: f64,
}
