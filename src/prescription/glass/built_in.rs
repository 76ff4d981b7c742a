//! The glasses that are built in, by the makers' names: the lines of `lenses/glasses.csv`, which say where each comes
//! from. A name in, Sellmeier's constants out.

use crate::prescription::interfaces::{Medium, Sellmeier};

const FILE: &str = include_str!("../../../lenses/glasses.csv");

/// Other names of the same glass: of a sort with less absorption, in other catalogues, in lens files.
const ALIASES: &[(&str, &str)] = &[
    ("N-BK7HT", "N-BK7"),
    ("N-SF6HT", "N-SF6"),
    ("SF6HT", "SF6"),
    ("N-SF57HT", "N-SF57"),
    ("F2HT", "F2"),
    ("N-KZFS4HT", "N-KZFS4"),
    ("SILICA", "F_SILICA"),
    ("FUSED_SILICA", "F_SILICA"),
    ("C79-80", "F_SILICA"),
    ("FLUORITE", "CAF2"),
    ("ACRYLIC", "PMMA"),
    ("PC", "POLYCARB"),
    ("PS", "POLYSTYR"),
    ("STYRENE", "POLYSTYR"),
];

/// The names, and what stands behind each in its line.
fn glasses() -> impl Iterator<Item = (&'static str, &'static str)> {
    FILE.lines().filter(|line| !line.starts_with('#')).filter_map(|line| line.split_once(','))
}

/// Every name, aliases last.
pub(super) fn names() -> impl Iterator<Item = &'static str> {
    glasses().map(|(name, _)| name).chain(ALIASES.iter().map(|&(alias, _)| alias))
}

/// The glass of that name, capitals or not.
pub(super) fn find(name: &str) -> Option<Medium> {
    let alias = ALIASES.iter().find(|(alias, _)| alias.eq_ignore_ascii_case(name));
    let name = alias.map_or(name, |(_, own)| own);
    let (_, numbers) = glasses().find(|(own, _)| own.eq_ignore_ascii_case(name))?;
    let mut numbers = numbers.split(',').map(|number| number.parse().expect("a test reads every glass"));
    let [b, c] = std::array::from_fn(|_| std::array::from_fn(|_| numbers.next().expect("six constants")));
    Some(Medium::Sellmeier(Sellmeier { b, c }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::prescription::glass::{C_LINE, D_LINE, F_LINE, refractive_index};

    #[test]
    fn every_glass_has_the_index_and_the_abbe_number_that_its_sheet_states() {
        let mut seen = std::collections::HashSet::new();
        for (name, rest) in glasses() {
            assert!(seen.insert(name.to_ascii_uppercase()), "{name} twice");
            let words: Vec<&str> = rest.split(',').collect();
            assert_eq!(words.len(), 9, "{name}");
            let [n_d, abbe]: [f64; 2] = [6, 7].map(|i| words[i].parse().expect("a number"));
            let glass = find(name).expect("listed");
            let [d, f, c] = [D_LINE, F_LINE, C_LINE].map(|line| refractive_index(glass, line));
            assert!((d - n_d).abs() < 1.2e-5, "{name}: {d} for {n_d}");
            assert!(((d - 1.0) / (f - c) - abbe).abs() < 0.025, "{name}: {}", (d - 1.0) / (f - c));
            let falls = (380..800).step_by(10).map(|nm| refractive_index(glass, f64::from(nm)));
            assert!(falls.collect::<Vec<_>>().is_sorted_by(|a, b| a > b), "{name}");
        }
        assert!(seen.len() >= 150);
        for (alias, own) in ALIASES {
            assert!(seen.contains(*own) && seen.insert((*alias).to_owned()), "{alias}");
            assert_eq!(find(&alias.to_ascii_lowercase()), find(own));
        }
        assert_eq!(find("XYZ"), None);
    }
}
