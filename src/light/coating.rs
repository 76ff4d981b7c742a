//! Layers of coatings: those of a named coating, or the lens file's own. Patents do not publish the makers' coatings;
//! the names stand for typical ones of textbooks and lenses of their time.

use crate::prescription::{Coating, Layer, SurfaceCoating};

/// The index of magnesium fluoride.
const MAGNESIUM_FLUORIDE: f64 = 1.38;

impl SurfaceCoating {
    /// Whether the effect of the coating itself depends on the wavelength.
    pub fn is_dispersive(&self) -> bool {
        !self.is_bare()
    }

    /// Returns the layers from the air on.
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

    /// Returns the layers of a surface between media of these indices, from the first to the second.
    pub fn layers(&self, media: [f64; 2]) -> Vec<Layer> {
        match AirSide::of(media) {
            None => Vec::new(),
            Some(AirSide::First) => self.from_air(),
            Some(AirSide::Second) => self.from_air().into_iter().rev().collect(),
        }
    }
}

/// The side of a surface that is air, if the other is glass: only such surfaces are coated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum AirSide {
    First,
    Second,
}

impl AirSide {
    /// Returns the air side of two media with these indices; `None` if both are air or neither is.
    pub fn of([first, second]: [f64; 2]) -> Option<Self> {
        if first == second || first > 1.0 && second > 1.0 {
            return None;
        }
        Some(if second > first { Self::First } else { Self::Second })
    }
}
