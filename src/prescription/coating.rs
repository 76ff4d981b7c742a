//! The coatings that a lens file states for its surfaces: a name with its design wavelength, or layers. The layers of
//! each name are defined in [`crate::light`].

/// A named coating of a surface between air and glass. Cemented surfaces have none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Coating {
    /// No coating.
    #[default]
    Bare,
    /// A quarter wave of magnesium fluoride, n = 1.38: the usual coating of lenses from about 1940 on.
    QuarterWave,
    /// Two quarter waves, of n = 1.38 and 1.70 counted from the air, which cancel the reflection of crown glass at one
    /// wavelength.
    VCoat,
    /// Three layers, a quarter, half and quarter wave, of n = 1.38, 2.05 and 1.63 counted from the air: the broadband
    /// coating of the 1970s.
    ThreeLayer,
}

impl Coating {
    /// Every coating with its name.
    pub const NAMES: [(&'static str, Self); 4] = [
        ("bare", Self::Bare),
        ("quarter-wave", Self::QuarterWave),
        ("v-coat", Self::VCoat),
        ("three-layer", Self::ThreeLayer),
    ];

    /// Returns its name.
    pub fn name(self) -> &'static str {
        Self::NAMES.iter().find(|(_, coating)| *coating == self).map_or("", |(name, _)| name)
    }
}

/// The keyword before the layers of a coating without a name.
pub const STACK: &str = "stack";

/// A layer of a coating.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layer {
    /// Refractive index, the same at every wavelength.
    pub index: f64,
    /// Thickness, nm.
    pub thickness: f64,
}

impl Layer {
    /// Returns a layer of a given optical thickness in wavelengths at normal incidence: 0.25 for a quarter wave at
    /// `wavelength`, nm.
    pub fn of_waves(index: f64, waves: f64, wavelength: f64) -> Self {
        Self { index, thickness: waves * wavelength / index }
    }
}

/// The coating of one surface.
#[derive(Clone, Debug, PartialEq)]
pub enum SurfaceCoating {
    /// A coating with a name.
    Named {
        /// The coating.
        coating: Coating,
        /// The design wavelength, nm: the layers are quarter and half waves of it.
        wavelength: f64,
    },
    /// The layers, from the air on.
    Stack(Vec<Layer>),
}

impl SurfaceCoating {
    /// The default design wavelength, nm.
    pub const WAVELENGTH: f64 = 550.0;

    /// Whether it has no layers.
    pub fn is_bare(&self) -> bool {
        match self {
            Self::Named { coating, .. } => *coating == Coating::Bare,
            Self::Stack(layers) => layers.is_empty(),
        }
    }
}

/// Uses the default design wavelength.
impl From<Coating> for SurfaceCoating {
    fn from(coating: Coating) -> Self {
        Self::Named { coating, wavelength: Self::WAVELENGTH }
    }
}
