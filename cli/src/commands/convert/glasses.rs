//! The media of a lens, as other programs can state them: by the name of a catalogue's glass, or by numbers.

use super::numbers::number;
use realistic_base::message::short;
use realistic_optics::prescription::{
    Glass, GlassLibrary, Medium, Prescription,
    glass::{C_LINE, D_LINE, F_LINE, refractive_index},
};

/// A medium, as it can be stated.
#[derive(Clone, Debug, PartialEq)]
pub enum Material {
    Air,
    /// A built-in glass: the name and the catalogue that has it.
    Named {
        name: String,
        catalogue: String,
        medium: Medium,
    },
    /// A glass of n_d and V alone; without V the index is the same at every wavelength. `name` is the file's.
    Numbers {
        name: Option<String>,
        n_d: f64,
        abbe: Option<f64>,
    },
    /// A glass with a formula that no catalogue has under its name.
    Formula {
        name: Option<String>,
        medium: Medium,
        range: Option<[f64; 2]>,
    },
}

/// The wavelengths, nm, between which the error of a replaced glass is stated.
const VISIBLE: [f64; 2] = [400.0, 700.0];

impl Material {
    /// Returns the medium of a lens, given with its glass's position in the list of glasses.
    pub fn of(lens: &Prescription, (medium, glass): (Medium, Option<usize>)) -> Self {
        let own = glass.and_then(|glass| lens.glasses.get(glass));
        let name = own.map(|(name, _)| plain(name)).filter(|name| !name.is_empty());
        match medium {
            Medium::Air => Self::Air,
            Medium::Glass { n_d, abbe } => Self::Numbers { name, n_d, abbe },
            Medium::Sellmeier { .. } | Medium::Formula(_) => {
                let range = own.and_then(|(_, Glass { range, .. })| *range);
                let is_same = |glass: &Glass| glass.medium == medium;
                let catalogue = name.as_deref().and_then(|name| {
                    let library = GlassLibrary::default();
                    let mut all = library.candidates(name, &[]);
                    all.find(|found| found.glass.as_ref().is_ok_and(is_same)).map(|found| found.catalogue)
                });
                match (name, catalogue) {
                    (Some(name), Some(catalogue)) => Self::Named { name, catalogue, medium },
                    (name, _) => Self::Formula { name, medium, range },
                }
            }
        }
    }

    /// Returns the medium itself.
    pub fn medium(&self) -> Medium {
        match *self {
            Self::Air => Medium::Air,
            Self::Named { medium, .. } | Self::Formula { medium, .. } => medium,
            Self::Numbers { n_d, abbe, .. } => Medium::Glass { n_d, abbe },
        }
    }

    /// Returns the name that the lens has for the glass.
    pub fn name(&self) -> Option<&str> {
        match self {
            Self::Air => None,
            Self::Named { name, .. } => Some(name),
            Self::Numbers { name, .. } | Self::Formula { name, .. } => name.as_deref(),
        }
    }

    /// Returns the glass as n_d and V alone, with a sentence about the largest error of its index between 400 and
    /// 700 nm and at `wavelength`, nm; no sentence for a glass of which nothing else is known.
    pub fn two_numbers(&self, wavelength: f64) -> (f64, Option<f64>, Option<String>) {
        if let Self::Numbers { n_d, abbe, .. } = *self {
            return (n_d, abbe, None);
        }
        let medium = self.medium();
        let [d, f, c] = [D_LINE, F_LINE, C_LINE].map(|line| refractive_index(medium, line));
        let abbe = (d - 1.0) / (f - c);
        let stated = Medium::Glass { n_d: d, abbe: Some(abbe) };
        let range = match self {
            Self::Formula { range: Some(range), .. } => *range,
            _ => VISIBLE,
        };
        let [from, to] = [VISIBLE[0].max(range[0]), VISIBLE[1].min(range[1])];
        let steps = (0..=300).map(|i| VISIBLE[0] + f64::from(i)).filter(|nm| (from..=to).contains(nm));
        let error = |nm: f64| (refractive_index(stated, nm) - refractive_index(medium, nm)).abs();
        let largest = steps.chain([wavelength]).map(error).fold(0.0, f64::max);
        let name = self.name().unwrap_or("a glass with a formula");
        let remark = format!(
            "{name} is written by n_d {} and V {}; its index is off by at most {} in the visible",
            number(short_index(d)),
            short(abbe),
            short(largest)
        );
        (d, Some(abbe), Some(remark))
    }
}

/// Rounds an index for a sentence.
fn short_index(index: f64) -> f64 {
    (index * 1e5).round() * 1e-5
}

/// Returns the name of a glass without its catalogue or group, as one word.
fn plain(name: &str) -> String {
    let own = name.rsplit([':', '|']).next().unwrap_or(name);
    own.split_whitespace().collect::<Vec<_>>().join("_")
}
