//! The glasses that are built in: `lenses/glasses.txt`, which says where each comes from and how its lines are written. A
//! name in, glasses out, the preferred one first. A line is read when a lens names its glass, and none before.

use super::{formula::Formula, loose};
use crate::prescription::interfaces::{Glass, Medium, Sellmeier};

const FILE: &str = include_str!("../../../lenses/glasses.txt");

/// The glasses, a line each, sorted by their [`loose`] names and among the same by preference.
fn entries() -> &'static str {
    let is_head = |line: &&str| line.starts_with(['#', '@']);
    let head: usize = FILE.split_inclusive('\n').take_while(is_head).map(str::len).sum();
    &FILE[head..]
}

/// The first word of a line.
fn name_of(line: &'static str) -> &'static str {
    line.split(' ').next().unwrap_or("")
}

/// Every name.
pub(super) fn names() -> impl Iterator<Item = &'static str> {
    entries().lines().map(name_of)
}

/// The name of the catalogue with a key, such as SCHOTT.
fn catalogue(key: &str) -> &'static str {
    let lines = FILE.lines().filter_map(|line| line.strip_prefix("@ "));
    let found = lines.filter_map(|line| line.split_once(' ')).find(|(own, _)| *own == key);
    found.map_or("", |(_, rest)| name_of(rest))
}

/// The glasses of a [`loose`] name: those of the catalogues in `first` before the others, each in the order of the table;
/// only those of one catalogue where `only`, loose too, names it.
pub(super) fn candidates(name: &str, only: Option<&str>, first: &[String]) -> Vec<Glass> {
    let mut found: Vec<(usize, Glass)> = Vec::new();
    for line in lines_of(name) {
        let words: Vec<&str> = line.split(' ').skip(1).collect();
        let catalogue = catalogue(words[0]);
        match &words[1..] {
            ["=", target] => return candidates(&loose(target), only, first),
            words if only.is_none_or(|only| only == catalogue) => {
                let place = first.iter().position(|some| some.contains(catalogue));
                found.push((place.unwrap_or(first.len()), glass(words)));
            }
            _ => {}
        }
    }
    found.sort_by_key(|(place, _)| *place);
    found.into_iter().map(|(_, glass)| glass).collect()
}

/// The lines of a [`loose`] name, by bisection.
fn lines_of(name: &str) -> impl Iterator<Item = &'static str> {
    let entries = entries();
    let (mut low, mut high) = (0, entries.len());
    while low < high {
        let middle = low + (high - low) / 2;
        let start = entries[..middle].rfind('\n').map_or(0, |end| end + 1);
        let line = entries[start..].lines().next().unwrap_or("");
        if loose(name_of(line)).as_str() < name {
            low = start + line.len() + 1;
        } else {
            high = start;
        }
    }
    entries[low..].lines().take_while(move |line| loose(name_of(line)) == name)
}

/// What stands behind the key in a glass's line.
fn glass(words: &[&str]) -> Glass {
    let number = |word: &&str| word.parse::<f64>().expect("a test reads every glass");
    let (range, words) = match words {
        ["-", rest @ ..] => (None, rest),
        [from, to, rest @ ..] => (Some([from, to].map(|end| 1e3 * number(end))), rest),
        _ => unreachable!("a test reads every glass"),
    };
    let constants: Vec<f64> = words[1..].iter().map(number).collect();
    let medium = match words[0] {
        "s" => sellmeier(1.0, &constants),
        "c" => sellmeier(1.0 + constants[0], &constants[1..]),
        formula => {
            let mut by_power = [0.0; 10];
            let lowest = match formula {
                "p" => 2,
                "q" => 1,
                _ => 0,
            };
            by_power[lowest..][..constants.len()].copy_from_slice(&constants);
            Medium::Formula(Formula::Polynomial(by_power))
        }
    };
    Glass::new(medium, range)
}

/// n² = `constant` + Σ B λ²/(λ² - C), of pairs of B and C.
fn sellmeier(constant: f64, pairs: &[f64]) -> Medium {
    if constant == 1.0 && pairs.len() <= 6 {
        let [b, c] = split(pairs);
        Medium::Sellmeier(Sellmeier { b, c })
    } else {
        let [b, c] = split(pairs);
        Medium::Formula(Formula::Sellmeier { rest: [constant, 0.0], b, c })
    }
}

/// The first of each pair and the second of each; those that are missing are 0.
fn split<const N: usize>(pairs: &[f64]) -> [[f64; N]; 2] {
    [0, 1].map(|which| std::array::from_fn(|i| pairs.get(2 * i + which).copied().unwrap_or(0.0)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::prescription::glass::check;

    #[test]
    fn every_line_is_a_glass_that_its_name_finds() {
        let entries = entries();
        assert!(entries.is_ascii() && entries.ends_with('\n') && FILE.len() <= 200_000, "{}", FILE.len());
        assert!(entries.lines().map(|line| loose(name_of(line))).is_sorted());
        let mut count = 0;
        for line in entries.lines() {
            let words: Vec<&str> = line.split(' ').collect();
            let maker = catalogue(words[1]);
            assert!(!maker.is_empty(), "{line}");
            let found = candidates(&loose(words[0]), None, &[]);
            if words[2] == "=" {
                assert_eq!(found, candidates(&loose(words[3]), None, &[]), "{line}");
                assert!(!found.is_empty(), "{line}");
                continue;
            }
            count += 1;
            let own = glass(&words[2..]);
            assert!(
                found.contains(&own) && candidates(&loose(words[0]), Some(maker), &[]).contains(&own),
                "{line}"
            );
            check(own.medium, own.range).unwrap_or_else(|why| panic!("{line}: {why}"));
        }
        assert!(count > 1670, "{count}");
        for unknown in ["", "A", "0", "ZZZZ", "NBK", "NBK77"] {
            assert_eq!(candidates(unknown, None, &[]), [], "{unknown}");
        }
    }

    #[test]
    fn a_name_of_three_makers_is_the_preferred_ones_or_the_one_that_is_named() {
        let n_d = |only: Option<&str>, first: &[&str]| {
            let first: Vec<String> = first.iter().map(|word| (*word).to_owned()).collect();
            let glasses = candidates("F2", only, &first);
            let index = |glass: &Glass| super::super::refractive_index(glass.medium, 587.5618);
            glasses.iter().map(|glass| (1e4 * index(glass)).round() / 1e4).collect::<Vec<f64>>()
        };
        assert_eq!(n_d(None, &[]), [1.62, 1.62, 1.6129], "SCHOTT, HIKARI, CDGM");
        assert_eq!(n_d(Some("CDGM"), &[]), [1.6129]);
        assert!(n_d(Some("OHARA"), &[]).is_empty());
        assert_eq!(n_d(None, &["MISC", "CDGM201409"])[0], 1.6129);
    }
}
