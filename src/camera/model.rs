//! The models of a camera, and the parameters that each uses.

/// What a camera is a model of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Model {
    /// Rays through every interface of a lens.
    #[default]
    Lens,
    /// The same lens as a thick one: ideal imaging with its pupil.
    Thick,
    /// The same lens as a thin one.
    Thin,
    /// A pinhole, or a thin lens of given radius, and a projection matrix.
    Perspective,
    /// Parallel projection.
    Orthographic,
    /// Everything around a point.
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

    /// The model's name.
    pub fn name(self) -> &'static str {
        Self::NAMES.iter().find(|(_, model)| *model == self).map_or("", |(name, _)| name)
    }

    /// Whether the model does something with a parameter.
    pub fn uses(self, parameter: &str) -> bool {
        if EVERY_MODEL.contains(&parameter) {
            return true;
        }
        let projective = PROJECTIVE.contains(&parameter);
        match self {
            Self::Lens => !projective && parameter != "fov",
            Self::Thick | Self::Thin => Self::Lens.uses(parameter) && !TRACING.contains(&parameter),
            Self::Perspective => projective || matches!(parameter, "fov" | "disk"),
            Self::Orthographic => projective || parameter == "disk",
            Self::Environment => false,
        }
    }
}

/// The parameters that every model uses.
const EVERY_MODEL: [&str; 8] =
    ["model", "hither", "yon", "shutteropen", "shutterclose", "shutter", "shutterramp", "shutterslit"];

/// The parameters of the two projections.
const PROJECTIVE: [&str; 5] =
    ["screenwindow", "frameaspectratio", "lensradius", "focaldistance", "lensplane"];

/// The parameters that only a lens whose interfaces are traced uses.
const TRACING: [&str; 4] = ["pupil", "refraction", "precision", "tolerance"];
