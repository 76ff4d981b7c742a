//! AGF glass catalogues, as the makers of glass publish them: `NM` name, formula, code, n_d, V_d; `CD` the constants.
//! Text in, glasses with their names out.

use super::text::{Place, Text, decoded, words};
use crate::{
    message::{cut, short},
    prescription::{
        error::LensFileError,
        glass::{C_LINE, D_LINE, F_LINE, Formula, refractive_index},
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
                    let constants: Option<Vec<f64>> = values.iter().map(|value| value.number()).collect();
                    entry.medium = medium(formula, constants.as_deref())
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
fn medium(formula: Option<f64>, constants: Option<&[f64]>) -> Result<Medium, String> {
    let constants = constants.ok_or("a constant is no number")?;
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
    let code = formula.ok_or("the formula's number is missing")?;
    let medium = match code as i64 {
        1 => polynomial(&[0, 2, -2, -4, -6, -8]),
        2 => Medium::Sellmeier(Sellmeier { b: [k(0), k(2), k(4)], c: [k(1), k(3), k(5)] }),
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
        _ => return Err(format!("formula {code} is not known")),
    };
    for line in [F_LINE, D_LINE, C_LINE] {
        let index = refractive_index(medium, line);
        if !(index > 1.0 && index < 5.0) {
            return Err(format!("its constants give index {} at {line} nm", short(index)));
        }
    }
    Ok(medium)
}
