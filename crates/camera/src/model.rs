//! The models of a camera, by name.

/// The model of a camera.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Model {
    /// Rays traced through every surface of a lens.
    #[default]
    Lens,
    /// The lens as a thick lens: ideal imaging with the pupil of the lens.
    Thick,
    /// The lens as a thin lens.
    Thin,
    /// A perspective projection through a pinhole or a thin lens of given radius.
    Perspective,
    /// A parallel projection.
    Orthographic,
    /// All directions from one point.
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
