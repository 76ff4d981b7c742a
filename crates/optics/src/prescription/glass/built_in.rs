//! The built-in glasses, read from `crates/optics/lenses/glasses.txt`. That file states the source of each glass and
//! the format of its lines. Looking up a name finds all glasses of that name, the preferred glass first. A line is
//! parsed only when a lens names its glass.

use super::{formula::Formula, loose};
use crate::prescription::interfaces::{Glass, Medium};

const FILE: &str = include_str!("../../../lenses/glasses.txt");

/// Returns the lines of the glasses, sorted by their [`loose`] names. Lines with equal names are sorted by preference.
fn entries() -> &'static str {
    let is_head = |line: &&str| line.starts_with(['#', '@']);
    let head: usize = FILE.split_inclusive('\n').take_while(is_head).map(str::len).sum();
    &FILE[head..]
}

/// Returns the first word of a line.
fn name_of(line: &'static str) -> &'static str {
    line.split(' ').next().unwrap_or("")
}

/// Returns every name with the catalogue of its glass.
pub(super) fn names() -> impl Iterator<Item = (&'static str, &'static str)> {
    entries().lines().map(|line| (name_of(line), catalogue(line.split(' ').nth(1).unwrap_or(""))))
}

/// Returns the catalogue, such as SCHOTT, that a key stands for.
fn catalogue(key: &str) -> &'static str {
    let lines = FILE.lines().filter_map(|line| line.strip_prefix("@ "));
    let found = lines.filter_map(|line| line.split_once(' ')).find(|(own, _)| *own == key);
    found.map_or("", |(_, rest)| name_of(rest))
}

/// Returns the glasses with a [`loose`] name and their catalogues, in the order of the table.
pub(super) fn candidates(name: &str) -> Vec<(&'static str, Glass)> {
    let mut found = Vec::new();
    for line in lines_of(name) {
        let words: Vec<&str> = line.split(' ').skip(1).collect();
        match &words[1..] {
            ["=", target] => found.extend(candidates(&loose(target))),
            constants => found.push((catalogue(words[0]), glass(constants))),
        }
    }
    found
}

/// Finds the lines with a [`loose`] name, by bisection.
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

/// Parses the words that follow the key in the line of a glass.
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
        "k" => Medium::Formula(Formula::Conrady(std::array::from_fn(|i| constants[i]))),
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

/// Returns the medium n² = `constant` + Σ B λ²/(λ² - C), from pairs of B and C.
fn sellmeier(constant: f64, pairs: &[f64]) -> Medium {
    if constant == 1.0 && pairs.len() <= 6 {
        let [b, c] = split(pairs);
        Medium::Sellmeier { b, c }
    } else {
        let [b, c] = split(pairs);
        Medium::Formula(Formula::Sellmeier { rest: [constant, 0.0], b, c })
    }
}

/// Splits pairs into their first and second members; missing members are 0.
fn split<const N: usize>(pairs: &[f64]) -> [[f64; N]; 2] {
    [0, 1].map(|which| std::array::from_fn(|i| pairs.get(2 * i + which).copied().unwrap_or(0.0)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::prescription::glass::usable_range;

    #[test]
    fn every_line_is_a_glass_that_its_name_finds() {
        let entries = entries();
        assert!(entries.is_ascii() && entries.ends_with('\n') && FILE.len() <= 240_000, "{}", FILE.len());
        assert!(entries.lines().map(|line| loose(name_of(line))).is_sorted());
        let mut count = 0;
        for line in entries.lines() {
            let words: Vec<&str> = line.split(' ').collect();
            let maker = catalogue(words[1]);
            assert!(!maker.is_empty(), "{line}");
            let found = candidates(&loose(words[0]));
            if words[2] == "=" {
                assert_eq!(found, candidates(&loose(words[3])), "{line}");
                assert!(!found.is_empty(), "{line}");
                continue;
            }
            count += 1;
            let own = glass(&words[2..]);
            assert!(found.contains(&(maker, own.clone())), "{line}");
            let range = usable_range(own.medium, own.range).unwrap_or_else(|why| panic!("{line}: {why}"));
            assert!(own.range.is_none() || range == own.range, "{line}: {range:?}");
        }
        assert!(count > 2350, "{count}");
        for unknown in ["", "A", "0", "ZZZZ", "NBK", "NBK77"] {
            assert_eq!(candidates(unknown), [], "{unknown}");
        }
    }
}
