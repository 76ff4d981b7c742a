//! AGF glass catalogues, as the makers of glass publish them: `NM` name, formula, code, n_d, V_d; `CD` the constants.
//! Text in, glasses with their names out.

use super::text::{Cell, Place, Text, decoded, no_number, words};
use crate::{
    message::cut,
    prescription::{
        error::LensFileError,
        glass::{Formula, check},
        interfaces::{Medium, Sellmeier},
        limits::{MAX_CATALOG_BYTES, MAX_NAME_BYTES},
    },
};

/// A glass of a catalogue.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// As the catalogue has it.
    pub name: String,
    /// What it says of the glass, or why that cannot be used.
    pub medium: Result<Medium, String>,
}

/// Reads a catalogue; `file` is its name in messages.
///
/// # Errors
/// The text is longer than [`MAX_CATALOG_BYTES`] or names no glass.
pub fn read(file: &str, bytes: &[u8]) -> Result<Vec<Entry>, LensFileError> {
    let bytes = decoded(bytes);
    let text = Text::new(file, &bytes);
    let start = Place { line: 1, column: 1 };
    if bytes.len() as u64 > MAX_CATALOG_BYTES {
        let message = format!("a glass catalogue has at most {MAX_CATALOG_BYTES} bytes (8 MiB)");
        return Err(text.error(start, message));
    }
    let mut entries: Vec<Entry> = Vec::new();
    let mut formula = None;
    for (number, line) in text.lines() {
        let words = words(number, line);
        match words.split_first().map(|(key, values)| (key.text, values)) {
            Some(("NM", [name, values @ ..])) if name.text.len() <= MAX_NAME_BYTES => {
                formula = values.first().and_then(|code| code.number());
                let medium = Err(format!("{file}:{number} has no constants (CD) for it"));
                entries.push(Entry { name: name.text.to_owned(), medium });
            }
            Some(("CD", values)) => {
                if let Some(entry) = entries.last_mut() {
                    let constant = |value: &Cell<'_>| {
                        value.number().ok_or_else(|| no_number(value.text, "a constant of CD"))
                    };
                    entry.medium = (values.iter().map(constant).collect::<Result<Vec<f64>, _>>())
                        .and_then(|constants| medium(formula, &constants))
                        .map_err(|why| format!("{}:{number}: {why}", cut(file)));
                }
            }
            _ => {}
        }
    }
    if entries.is_empty() {
        let message = "no glass; a glass catalogue (AGF) has lines NM with names and CD with constants";
        return Err(text.error(start, message));
    }
    Ok(entries)
}

/// The medium of a formula's number and its constants, as many as the line has.
fn medium(formula: Option<f64>, constants: &[f64]) -> Result<Medium, String> {
    let k = |i: usize| constants.get(i).copied().unwrap_or(0.0);
    let sellmeier = |rest: [f64; 2], terms: &[(f64, f64)]| {
        let term = |i: usize| terms.get(i).copied().unwrap_or((0.0, 0.0));
        let [b, c] = [std::array::from_fn(|i| term(i).0), std::array::from_fn(|i| term(i).1)];
        Medium::Formula(Formula::Sellmeier { rest, b, c })
    };
    // B/(λ² - C) = B/C (λ²/(λ² - C) - 1).
    let without_square = |constant: f64, slope: f64, term: (f64, f64), (b, c): (f64, f64)| {
        if c == 0.0 {
            Err("C = 0 in B/(λ² - C)")
        } else {
            Ok(sellmeier([constant - b / c, slope], &[term, (b / c, c)]))
        }
    };
    // From the powers 2, 0, -2, … of the catalogues to those from -12 to 6.
    let polynomial = |powers: &[i32]| {
        let mut by_power = [0.0; 10];
        for (i, power) in powers.iter().enumerate() {
            by_power[(power + 12) as usize / 2] = k(i);
        }
        Medium::Formula(Formula::Polynomial(by_power))
    };
    let code = formula.ok_or("the number of its formula is missing on the line NM, behind its name")?;
    let medium = match code as i64 {
        1 => polynomial(&[0, 2, -2, -4, -6, -8]),
        2 => {
            let three = Medium::Sellmeier(Sellmeier { b: [k(0), k(2), k(4)], c: [k(1), k(3), k(5)] });
            // A glass that is one in the visible only.
            let any = || sellmeier([1.0, 0.0], &[(k(0), k(1)), (k(2), k(3)), (k(4), k(5))]);
            check(three).map_or_else(|_| any(), |()| three)
        }
        3 => Medium::Formula(Formula::Herzberger(std::array::from_fn(k))),
        4 => without_square(1.0 + k(0), 0.0, (k(1), k(2) * k(2)), (k(3), k(4) * k(4)))?,
        5 => Medium::Formula(Formula::Conrady(std::array::from_fn(k))),
        6 => sellmeier([1.0, 0.0], &[(k(0), k(1)), (k(2), k(3)), (k(4), k(5)), (k(6), k(7))]),
        7 => without_square(k(0), -k(3), (0.0, 0.0), (k(1), k(2)))?,
        8 => sellmeier([k(0), -k(3)], &[(k(1), k(2))]),
        9 => sellmeier([k(0), 0.0], &[(k(1), k(2)), (k(3), k(4))]),
        10 => polynomial(&[0, 2, -2, -4, -6, -8, -10, -12]),
        11 => sellmeier([1.0, 0.0], &[(k(0), k(1)), (k(2), k(3)), (k(4), k(5)), (k(6), k(7)), (k(8), k(9))]),
        12 => polynomial(&[0, 2, -2, -4, -6, -8, 4, 6]),
        13 => polynomial(&[0, 2, 4, -2, -4, -6, -8, -10, -12]),
        _ => return Err(format!("formula {code} is not known; formulas are 1 to 13")),
    };
    check(medium)?;
    Ok(medium)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::prescription::glass::{C_LINE, D_LINE, F_LINE, refractive_index};

    /// n_d and V of the one glass of a catalogue.
    fn n_d_and_abbe(code: &str, constants: &str) -> [f64; 2] {
        let text = format!("CC of tests\nNM X {code} 0 1.5 60 0\nED 1 2\nCD {constants}\nTD 0\n");
        let [entry] = &read("x.agf", text.as_bytes()).expect("a catalogue")[..] else { panic!("{text}") };
        let medium = entry.medium.clone().unwrap_or_else(|why| panic!("{why}"));
        let [d, f, c] = [D_LINE, F_LINE, C_LINE].map(|line| refractive_index(medium, line));
        [d, (d - 1.0) / (f - c)]
    }

    #[test]
    fn every_formula_gives_the_index_and_the_abbe_number_that_its_sheet_states() {
        for (code, constants, n_d, abbe) in [
            // FCD1.
            (
                "1",
                "2.2181132 -0.005799427 0.0083470679 6.5046523e-05 8.5142186e-06 -5.8852269e-07 0.0 0.0 0.0 0.0",
                1.496997,
                81.608379,
            ),
            // N-SF6.
            (
                "2",
                "1.77931763 0.0133714182 0.338149866 0.0617533621 2.08734474 174.01759 0.0 0.0",
                1.80518,
                25.36,
            ),
            // CLRTR_OLD.
            (
                "3",
                "2.2596285 0.0311097853 0.0010251756 -0.000594355286 4.49796618e-07 -4.12852834e-09 0.0 0.0 0.0 0.0",
                2.367678,
                15.282309,
            ),
            // NICHIA_MELT1.
            ("5", "1.47444837 0.0103147698 0.00026742387 0.0 0.0 0.0 0.0 0.0 0.0 0.0", 1.493724, 64.358478),
            // CALCITE.
            (
                "6",
                "0.8559 0.00345744 0.8391 0.019881 0.0009 0.038809 0.6845 49.070025 0.0 0.0",
                1.658643,
                48.541403,
            ),
            // E-KZFH1.
            (
                "12",
                "2.54662904 -0.0122972332 0.0187464623 0.000460296583 7.85351066e-07 1.72720972e-06 -0.000133476806 0.0 0.0 0.0",
                1.61266,
                44.461379,
            ),
            // Q-LASFH19S.
            (
                "13",
                "3.22566311 -0.0126719158 -0.000122584245 0.0306900263 0.000649958511 1.0629994e-05 1.20774149e-06 0.0 0.0 0.0",
                1.82098,
                42.656702,
            ),
        ] {
            let found = n_d_and_abbe(code, constants);
            assert!((found[0] - n_d).abs() < 2e-5 && (found[1] - abbe).abs() < 0.05, "{code}: {found:?}");
        }
    }

    #[test]
    fn one_glass_in_many_formulas_is_one_glass() {
        // n² = 1 + 1.25 λ²/(λ² - 0.01) + 1 λ²/(λ² - 100), by hand in the forms that can say it.
        let plain = n_d_and_abbe("2", "1.25 0.01 1 100 0 0");
        for (code, constants) in [
            ("6", "1.25 0.01 1 100 0 0 0 0"),
            ("9", "1 1.25 0.01 1 100"),
            ("11", "1.25 0.01 1 100 0 0 0 0 0 0"),
            // λ²/(λ² - 100) = 1 + 100/(λ² - 100), λ in roots.
            ("4", "1 1.25 0.1 100 10"),
        ] {
            let found = n_d_and_abbe(code, constants);
            assert!(
                (found[0] - plain[0]).abs() < 1e-12 && (found[1] - plain[1]).abs() < 1e-6,
                "{code}: {found:?}"
            );
        }
        // n² = 2.2 + 0.01/(λ² - 0.01) - 0.01 λ²; λ²/(λ² - 0.01) - 1 = 0.01/(λ² - 0.01).
        let seven = n_d_and_abbe("7", "2.2 0.01 0.01 0.01");
        let eight = n_d_and_abbe("8", "1.2 1 0.01 0.01");
        assert!((seven[0] - eight[0]).abs() < 1e-12 && (seven[1] - eight[1]).abs() < 1e-6);
        // A polynomial of n² in each of the forms.
        let schott = n_d_and_abbe("1", "2.3 -0.01 0.01 0.0002 0 0");
        for (code, constants) in [
            ("10", "2.3 -0.01 0.01 0.0002 0 0 0 0"),
            ("12", "2.3 -0.01 0.01 0.0002 0 0 0 0"),
            ("13", "2.3 -0.01 0 0.01 0.0002 0 0 0 0"),
        ] {
            assert_eq!(n_d_and_abbe(code, constants), schott, "{code}");
        }
    }

    #[test]
    fn what_cannot_be_used_says_why_when_it_is_asked_for() {
        let entries = read("x.agf", b"NM A 2 0\nCD 1 x\nNM B\nCD 1 2\nNM C 2 0\nCD -1 0 0 0 0 0\nNM D 2 0\nCD 0.5 0.4 0.7 0.01\nNM E 7 0\nCD 2 1 0 0\nNM F 1 0\n");
        let why: Vec<String> = entries
            .expect("a catalogue")
            .into_iter()
            .map(|entry| entry.medium.err().unwrap_or_default())
            .collect();
        assert_eq!(why[0], "x.agf:2: \"x\" is not a number; expected a constant of CD");
        assert_eq!(why[1], "x.agf:4: the number of its formula is missing on the line NM, behind its name");
        assert!(why[2].contains("x.agf:6: the constants give index"), "{}", why[2]);
        assert!(why[2].ends_with("; expected 1 to 5"), "{}", why[2]);
        assert!(why[3].contains("index"), "a resonance in the visible: {}", why[3]);
        assert_eq!(why[4], "x.agf:10: C = 0 in B/(λ² - C)");
        assert_eq!(why[5], "x.agf:11 has no constants (CD) for it");
        let error = read("x.agf", b"a lens\n").expect_err("no catalogue").to_string();
        assert!(error.starts_with("x.agf:1:1: no glass"), "{error}");
        let long = vec![b'\n'; MAX_CATALOG_BYTES as usize + 1];
        assert!(read("x.agf", &long).expect_err("too long").message.contains("8 MiB"));
        let utf16: Vec<u8> =
            [0xFF, 0xFE].into_iter().chain("NM A 2 0\n".bytes().flat_map(|b| [b, 0])).collect();
        assert_eq!(read("x.agf", &utf16).expect("a catalogue").len(), 1);
    }
}
