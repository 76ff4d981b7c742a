//! The models of a camera, by name.

/// The model of a camera.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Model {
    /// Rays through every interface of a lens.
    #[default]
    Lens,
    /// The lens as a thick lens: ideal imaging with its pupil.
    Thick,
    /// The lens as a thin lens.
    Thin,
    /// A pinhole, or a thin lens of given radius, and a projection matrix.
    Perspective,
    /// Parallel projection.
    Orthographic,
    /// All directions from a point.
    Environment,
}

impl Model {
    /// Every model with the name that the parameter `model` uses.
    pub const NAMES: [(&'static str, Self); 6] = [
        ("lens", Self::Lens),
        ("thick", Self::Thick),
        ("thin", Self::Thin),
        ("perspective", Self::Perspective),
        ("orthographic", Self::Orthographic),
        ("environment", Self::Environment),
    ];
}
