//! What text parameters choose among, with the names that users write.

/// Where lens samples are drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum PupilChoice {
    /// The true pupil of each film point.
    #[default]
    Warped,
    /// The rear element's disk.
    Rear,
    /// The thick-lens exit pupil.
    Disk,
}

impl PupilChoice {
    pub const NAMES: [(&'static str, Self); 3] =
        [("warped", Self::Warped), ("rear", Self::Rear), ("disk", Self::Disk)];
}

/// How a ray's weight is measured.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Weighting {
    /// The mean over lens samples is film irradiance for unit radiance.
    #[default]
    Radiometric,
    /// The assignment's cos⁴/Z²: radiometric over an area that is the same for all film points. For a disk it is the
    /// area samples are taken from; for the warped pupil, whose area varies, the paraxial exit pupil's.
    Assignment,
    /// Relative to the mean on the axis.
    Relative,
    /// 1 for a ray that gets through.
    None,
}

impl Weighting {
    pub const NAMES: [(&'static str, Self); 4] = [
        ("radiometric", Self::Radiometric),
        ("assignment", Self::Assignment),
        ("relative", Self::Relative),
        ("none", Self::None),
    ];
}

/// What the trace computes with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Precision {
    /// Double, or what the tolerance allows.
    #[default]
    Auto,
    /// Double.
    Double,
    /// Single.
    Single,
}

impl Precision {
    pub const NAMES: [(&'static str, Self); 5] = [
        ("auto", Self::Auto),
        ("f64", Self::Double),
        ("f32", Self::Single),
        ("double", Self::Double),
        ("single", Self::Single),
    ];
}
