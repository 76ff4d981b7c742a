//! The layers of coatings: those of a name, or the lens file's own. What a maker really uses no patent says; the names stand
//! for what textbooks and lenses of their time have.

use crate::prescription::{Coating, Layer, SurfaceCoating};

/// The index of magnesium fluoride.
const MAGNESIUM_FLUORIDE: f64 = 1.38;

impl SurfaceCoating {
    /// Whether what it does depends on the wavelength beyond what the indices of the media do.
    pub fn is_dispersive(&self) -> bool {
        !self.is_bare()
    }

    /// The layers from the air on.
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

    /// The layers of a surface between media of these indices, from the first to the second.
    pub fn layers(&self, [n, n_behind]: [f64; 2]) -> Vec<Layer> {
        let layers = self.from_air();
        if n == n_behind || n > 1.0 && n_behind > 1.0 {
            return Vec::new();
        }
        if n_behind > n { layers } else { layers.into_iter().rev().collect() }
    }
}
