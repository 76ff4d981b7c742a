//! What a lens file says of the coatings of its surfaces: names, and the wavelength that each is made for; or layers. What
//! layers a name stands for is known where light is ([`crate::light`]).

/// A named coating of surfaces between air and glass. Cemented surfaces have none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Coating {
    /// None.
    #[default]
    Bare,
    /// A quarter wave of magnesium fluoride, n = 1.38: the coating of lenses from about 1940 on.
    QuarterWave,
    /// Two quarter waves, of n = 1.38 and 1.70 from the air on, which on crown glass reflect nothing at one wavelength.
    VCoat,
    /// Three layers, quarter, half and quarter of a wave, of n = 1.38, 2.05 and 1.63 from the air on: the broadband coating of
    /// the 1970s.
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

    /// Its name.
    pub fn name(self) -> &'static str {
        Self::NAMES.iter().find(|(_, coating)| *coating == self).map_or("", |(name, _)| name)
    }
}

/// The word before the layers of a coating that has no name.
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
    /// A layer that is so many wavelengths thick at normal incidence: 0.25 for a quarter wave at `wavelength`, nm.
    pub fn of_waves(index: f64, waves: f64, wavelength: f64) -> Self {
        Self { index, thickness: waves * wavelength / index }
    }
}

/// The coating of one surface.
#[derive(Clone, Debug, PartialEq)]
pub enum SurfaceCoating {
    /// One that has a name.
    Named {
        /// Which it is.
        coating: Coating,
        /// The wavelength that it is made for, nm: its layers are quarters and halves of that.
        wavelength: f64,
    },
    /// Its layers, from the air on.
    Stack(Vec<Layer>),
}

impl SurfaceCoating {
    /// The wavelength that coatings are made for unless another is stated, nm.
    pub const WAVELENGTH: f64 = 550.0;

    /// Whether it has no layer.
    pub fn is_bare(&self) -> bool {
        match self {
            Self::Named { coating, .. } => *coating == Coating::Bare,
            Self::Stack(layers) => layers.is_empty(),
        }
    }
}

/// For 550 nm.
impl From<Coating> for SurfaceCoating {
    fn from(coating: Coating) -> Self {
        Self::Named { coating, wavelength: Self::WAVELENGTH }
    }
}
