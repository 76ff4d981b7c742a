//! Coatings by name: what a lens's surfaces between air and glass are coated with. What a maker really uses no patent says;
//! these are what textbooks and lenses of their time have.

use super::stack::Layer;

/// A coating of the surfaces between air and glass. Cemented surfaces have none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Coating {
    /// None.
    #[default]
    Bare,
    /// A quarter wave of magnesium fluoride, n = 1.38, at 550 nm: what lenses had from about 1940 on.
    QuarterWave,
    /// Three layers, quarter, half and quarter of a wave at 550 nm, of n = 1.38, 2.05 and 1.63 from the air on: the
    /// broadband coating of the 1970s.
    ThreeLayer,
}

/// The wavelength for which coatings are made, nm.
const DESIGN: f64 = 550.0;
/// The index of magnesium fluoride.
const MAGNESIUM_FLUORIDE: f64 = 1.38;

impl Coating {
    /// Every coating with its name.
    pub const NAMES: [(&'static str, Self); 3] =
        [("bare", Self::Bare), ("quarter-wave", Self::QuarterWave), ("three-layer", Self::ThreeLayer)];

    /// Whether what it does depends on the wavelength beyond what the indices of the media do.
    pub fn is_dispersive(self) -> bool {
        !self.from_air().is_empty()
    }

    /// The layers from the air on.
    pub fn from_air(self) -> Vec<Layer> {
        let quarter = |index| Layer::of_waves(index, 0.25, DESIGN);
        match self {
            Self::Bare => Vec::new(),
            Self::QuarterWave => vec![quarter(MAGNESIUM_FLUORIDE)],
            Self::ThreeLayer => {
                vec![quarter(MAGNESIUM_FLUORIDE), Layer::of_waves(2.05, 0.5, DESIGN), quarter(1.63)]
            }
        }
    }

    /// The layers of a surface between media of these indices, from the first to the second.
    pub fn layers(self, [n, n_behind]: [f64; 2]) -> Vec<Layer> {
        let layers = self.from_air();
        if n == n_behind || n > 1.0 && n_behind > 1.0 {
            return Vec::new();
        }
        if n_behind > n { layers } else { layers.into_iter().rev().collect() }
    }
}
