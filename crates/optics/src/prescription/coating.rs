//! The coatings that a lens file states for its surfaces: a named coating with its design wavelength, or a list of
//! layers. [`SurfaceCoating::from_air`] defines the layers of each named coating.

/// A named coating of a surface between air and glass. Cemented surfaces have no coating.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Coating {
    /// No coating.
    #[default]
    Bare,
    /// A quarter wave of magnesium fluoride, n = 1.38: the usual coating of lenses from about 1940 on.
    QuarterWave,
    /// Two quarter waves, of n = 1.38 and 1.70 from the air inward, which cancel the reflection of crown glass at one
    /// wavelength.
    VCoat,
    /// Three layers from the air inward, a quarter, a half and a quarter wave of n = 1.38, 2.05 and 1.63: the broadband
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

    /// Returns the name of the coating.
    pub fn name(self) -> &'static str {
        Self::NAMES.iter().find(|(_, coating)| *coating == self).map_or("", |(name, _)| name)
    }
}

/// The keyword before the layers of a coating without a name.
pub const STACK: &str = "stack";

/// Maximum number of layers of a coating without a name, and maximum total thickness of the layers, nm. The tables of a
/// coated surface grow with the thickness of its coating.
pub(super) const MOST_LAYERS: usize = 50;
pub(super) const THICKEST: f64 = 5_000.0;
/// The largest allowed index of a layer; the smallest is 1.
pub(super) const DENSEST: f64 = 10.0;

/// A layer of a coating.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layer {
    /// Refractive index, the same at every wavelength.
    pub index: f64,
    /// Thickness, nm.
    pub thickness: f64,
}

impl Layer {
    /// Returns a layer of a given optical thickness at normal incidence, in wavelengths of `wavelength` nm: 0.25 for a
    /// quarter wave.
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
        /// The design wavelength, nm: the layers are quarter and half waves at this wavelength.
        wavelength: f64,
    },
    /// The layers, from the air inward.
    Stack(Vec<Layer>),
}

impl SurfaceCoating {
    /// The default design wavelength, nm.
    pub const WAVELENGTH: f64 = 550.0;

    /// Returns whether the coating has no layers.
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

// The layers of named coatings. Patents do not publish the makers' coatings; each name denotes a coating that is
// typical of textbooks and of lenses of its time.

/// The index of magnesium fluoride.
const MAGNESIUM_FLUORIDE: f64 = 1.38;

impl SurfaceCoating {
    /// Returns whether the effect of the coating itself depends on the wavelength.
    pub fn is_dispersive(&self) -> bool {
        !self.is_bare()
    }

    /// Returns the layers from the air inward.
    pub fn from_air(&self) -> Vec<Layer> {
        let (coating, wavelength) = match self {
            Self::Named { coating, wavelength } => (*coating, *wavelength),
            Self::Stack(layers) => return layers.clone(),
        };
        let layer = |index, waves| Layer::of_waves(index, waves, wavelength);
        let first = layer(MAGNESIUM_FLUORIDE, 0.25);
        match coating {
            Coating::Bare => Vec::new(),
            Coating::QuarterWave => vec![first],
            Coating::VCoat => vec![first, layer(1.70, 0.25)],
            Coating::ThreeLayer => vec![first, layer(2.05, 0.5), layer(1.63, 0.25)],
        }
    }

    /// Returns the layers of a surface between media of these indices, in order from the first medium to the second.
    pub fn layers(&self, media: [f64; 2]) -> Vec<Layer> {
        match AirSide::of(media) {
            None => Vec::new(),
            Some(AirSide::First) => self.from_air(),
            Some(AirSide::Second) => self.from_air().into_iter().rev().collect(),
        }
    }
}

/// The side of a surface on which the medium is air while the other medium is glass. Only such surfaces are coated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AirSide {
    /// The first medium is air.
    First,
    /// The second medium is air.
    Second,
}

impl AirSide {
    /// Returns the side on which the medium is air, for media with these indices; `None` if both media are air or
    /// neither is.
    pub fn of([first, second]: [f64; 2]) -> Option<Self> {
        if first == second || first > 1.0 && second > 1.0 {
            return None;
        }
        Some(if second > first { Self::First } else { Self::Second })
    }
}
