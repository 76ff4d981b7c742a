//! AGF glass catalogues, as glass makers publish them. `NM` states name, formula, code, n_d and V_d; `CD` the
//! constants; `LD` the range of wavelengths, µm; `IT` the internal transmittance, as wavelength (µm), transmittance and
//! thickness (mm). A catalogue is indexed by the names of its glasses, and an entry is parsed only when a lens names
//! its glass. A malformed line loses only its own data; the glass is lost only if it has no index without that line.

use std::{cell::RefCell, collections::HashMap, path::Path, sync::Arc};

use super::text::{Location, Text, as_str, decoded, no_number, words};
use crate::prescription::{
    LensFileError, MAX_CATALOG_BYTES, MAX_CATALOG_GLASSES, MAX_GLASS_BYTES, MAX_NAME_BYTES,
    glass::{Formula, InternalTransmittance, MOST_NM, loose, usable_range},
    interfaces::{Glass, Medium},
};
use realistic_base::message::cut;

/// A catalogue: an index of its text by glass name, and the glasses that were looked up. A clone shares the text and
/// the index.
#[derive(Clone, Debug)]
pub struct Catalogue {
    /// The name of the catalogue in messages.
    file: String,
    /// The name of the file without its extension, as a [`loose`] word. A lens names the catalogue by this word.
    pub name: String,
    text: Arc<str>,
    /// The line, counted from 1, and the byte offset at which the entry of each glass begins, by [`loose`] name.
    index: Arc<HashMap<String, [usize; 2]>>,
    found: RefCell<HashMap<usize, Result<Glass, String>>>,
    /// Warnings about lines that were left out, for the glasses that were looked up.
    warnings: RefCell<Vec<String>>,
}

impl Catalogue {
    /// Indexes a catalogue; `file` is the name of the catalogue in messages.
    ///
    /// # Errors
    /// The text is longer than [`MAX_CATALOG_BYTES`], names no glass, or names more than [`MAX_CATALOG_GLASSES`].
    pub fn new(file: &str, bytes: &[u8]) -> Result<Self, LensFileError> {
        let error =
            |line: usize, message: String| Text::new(file, &[]).error(Location { line, column: 1 }, message);
        if bytes.len() as u64 > MAX_CATALOG_BYTES {
            let message = format!("a glass catalogue has at most {MAX_CATALOG_BYTES} bytes (8 MiB)");
            return Err(error(1, message));
        }
        let text = as_str(&decoded(bytes)).into_owned();
        let mut index = HashMap::new();
        let mut start = 0;
        for (number, line) in (1..).zip(text.split(line_end(&text))) {
            if let Some(name) = name_in(line).map(loose).filter(|name| !name.is_empty()) {
                if index.len() == MAX_CATALOG_GLASSES {
                    let message = format!("a glass catalogue has at most {MAX_CATALOG_GLASSES} glasses");
                    return Err(error(number, message));
                }
                index.entry(name).or_insert([number, start]);
            }
            start += line.len() + 1;
        }
        if index.is_empty() {
            let message = "no glass; a glass catalogue (AGF) has lines NM with names and CD with constants";
            return Err(error(1, message.to_owned()));
        }
        let name = loose(&Path::new(file).file_stem().unwrap_or_default().to_string_lossy());
        Ok(Self {
            file: file.to_owned(),
            name,
            text: text.into(),
            index: Arc::new(index),
            found: RefCell::default(),
            warnings: RefCell::default(),
        })
    }

    /// Returns the names of the glasses, as written in the catalogue.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.index.values().filter_map(|&[_, start]| name_in(self.lines(start).next()?))
    }

    /// Returns the number of glasses in the catalogue.
    pub fn len(&self) -> usize {
        self.index.len()
    }

    /// Returns the name of the catalogue in messages.
    pub fn file(&self) -> &str {
        &self.file
    }

    /// Returns whether a glass of the catalogue was looked up.
    pub fn is_used(&self) -> bool {
        !self.found.borrow().is_empty()
    }

    /// Returns whether the catalogue has a glass with this [`loose`] name.
    pub fn has(&self, name: &str) -> bool {
        self.index.contains_key(name)
    }

    /// Returns the glass with a [`loose`] name.
    ///
    /// # Errors
    /// The entry cannot be used; the text gives the reason.
    pub fn find(&self, name: &str) -> Option<Result<Glass, String>> {
        let &[line, start] = self.index.get(name)?;
        let mut found = self.found.borrow_mut();
        Some(found.entry(start).or_insert_with(|| self.glass(line, start)).clone())
    }

    /// Returns warnings about lines that were left out, for the glasses that were looked up.
    pub fn warnings(&self) -> Vec<String> {
        self.warnings.borrow().clone()
    }

    /// Returns the lines from the first byte of a glass's entry on, up to the size limit for one glass.
    fn lines(&self, start: usize) -> impl Iterator<Item = &str> {
        let rest = &self.text[start..];
        rest[..rest.floor_char_boundary(MAX_GLASS_BYTES)].split(line_end(&self.text))
    }

    fn glass(&self, line: usize, start: usize) -> Result<Glass, String> {
        let mut formula = None;
        let mut constants = None;
        let mut range = None;
        let mut absorbs = Vec::new();
        for (number, text) in (line..).zip(self.lines(start)) {
            let words = words(number, text);
            match words.split_first().map(|(key, values)| (key.text, values)) {
                Some(("NM", _)) if number > line => break,
                Some(("NM", [_, code, ..])) => formula = code.number(),
                Some(("CD", values)) => {
                    constants = Some((
                        number,
                        values.iter().map(|value| (value.number(), value.text)).collect::<Vec<_>>(),
                    ));
                }
                Some(("LD", [from, to, ..])) => {
                    let ends = [from, to].map(|end| end.number().unwrap_or(0.0) * 1e3);
                    range = Some(ends).filter(|[from, to]| *from > 0.0 && from < to);
                }
                Some(("IT", [wavelength, share, thickness, ..])) => {
                    absorbs.push((
                        number,
                        [wavelength, share, thickness].map(|cell| (cell.number(), cell.text)),
                    ));
                }
                _ => {}
            }
        }
        let file = cut(&self.file);
        let Some((number, constants)) = constants else {
            return Err(format!("{file}:{line} has no constants (CD) for it"));
        };
        let medium =
            medium(formula, &constants).and_then(|medium| Ok((medium, usable_range(medium, range)?)));
        let (medium, range) = medium.map_err(|why| format!("{file}:{number}: {why}"))?;
        let mut rows = Vec::new();
        for (number, row) in absorbs {
            match transmittance_row(row) {
                Some(Ok(row)) => rows.push(row),
                Some(Err(why)) => {
                    self.warnings.borrow_mut().push(format!("{file}:{number}: {why}; this line is left out"))
                }
                None => {}
            }
        }
        let transmittance = InternalTransmittance::new(rows).map(Arc::new);
        Ok(Glass { medium, range, transmittance })
    }
}

/// Reads a line of internal transmittance: wavelength (nm), transmittance, thickness (mm). Returns `None` if the maker
/// gives no value.
///
/// # Errors
/// The numbers are malformed or out of range.
fn transmittance_row(row: [(Option<f64>, &str); 3]) -> Option<Result<[f64; 3], String>> {
    let [wavelength, share, thickness] = row;
    if share.1.chars().all(|c| c == '-') {
        return None;
    }
    // Makers write 1.001 for 1, and -0.0003 for 0, because of rounding errors.
    const ROUNDED: f64 = 2e-3;
    // Thickness of the thinnest plate, mm. A thinner plate could state coefficients beyond `MOST_PER_MM`.
    const THINNEST: f64 = 0.01;
    let row = match row.map(|(number, _)| number) {
        [Some(wavelength), Some(share), Some(thickness)]
            if wavelength > 0.0
                && 1e3 * wavelength <= MOST_NM
                && (-ROUNDED..=1.0 + ROUNDED).contains(&share)
                && thickness >= THINNEST =>
        {
            Ok([1e3 * wavelength, share.clamp(0.0, 1.0), thickness])
        }
        _ => Err(format!(
            "IT {} {} {}: expected a wavelength in µm, at most 1000, a transmittance from 0 to 1 and a thickness in mm, at least 0.01, or - for no value",
            cut(wavelength.1),
            cut(share.1),
            cut(thickness.1)
        )),
    };
    Some(row)
}

/// Returns the character that ends the lines of a text.
fn line_end(text: &str) -> char {
    if text.contains('\n') { '\n' } else { '\r' }
}

/// Returns the glass name in a line that begins a glass.
fn name_in(line: &str) -> Option<&str> {
    let mut words = line.split_whitespace();
    words.next().filter(|key| *key == "NM").and(words.next()).filter(|name| name.len() <= MAX_NAME_BYTES)
}

/// Number of constants of each formula, 1 to 13. The line in a catalogue may have more.
const CONSTANTS: [usize; 13] = [6, 6, 6, 5, 3, 8, 4, 4, 5, 8, 10, 8, 9];

/// Returns the medium for a formula's number and its constants. The constants are given as the words of the line;
/// missing constants are 0.
fn medium(formula: Option<f64>, words: &[(Option<f64>, &str)]) -> Result<Medium, String> {
    let code = formula.ok_or("the number of its formula is missing on the line NM, behind its name")? as i64;
    let count = usize::try_from(code - 1).ok().and_then(|index| CONSTANTS.get(index).copied());
    let count = count.ok_or_else(|| format!("formula {code} is not known; formulas are 1 to 13"))?;
    let mut constants = [0.0; 10];
    for (constant, (number, text)) in constants.iter_mut().zip(words).take(count) {
        *constant = number.ok_or_else(|| no_number(text, "a constant of CD"))?;
    }
    let k = |i: usize| constants[i];
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
    // Moves coefficients from the catalogue's order of powers (0, 2, -2, …) to ascending order (-12 to 6).
    let polynomial = |powers: &[i32]| {
        let mut by_power = [0.0; 10];
        for (i, power) in powers.iter().enumerate() {
            by_power[(power + 12) as usize / 2] = k(i);
        }
        Medium::Formula(Formula::Polynomial(by_power))
    };
    Ok(match code {
        1 => polynomial(&[0, 2, -2, -4, -6, -8]),
        2 => Medium::Sellmeier { b: [k(0), k(2), k(4)], c: [k(1), k(3), k(5)] },
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
        _ => polynomial(&[0, 2, 4, -2, -4, -6, -8, -10, -12]),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::prescription::glass::{C_LINE, D_LINE, F_LINE, refractive_index};

    /// Returns n_d and V of the glass in a catalogue with one glass.
    fn n_d_and_abbe(code: &str, constants: &str) -> [f64; 2] {
        let text = format!("CC of tests\nNM X {code} 0 1.5 60 0\nED 1 2\nCD {constants}\nTD 0\n");
        let catalogue = Catalogue::new("x.agf", text.as_bytes()).expect("a catalogue");
        let medium = catalogue.find("X").expect("listed").unwrap_or_else(|why| panic!("{why}")).medium;
        let [d, f, c] = [D_LINE, F_LINE, C_LINE].map(|line| refractive_index(medium, line));
        [d, (d - 1.0) / (f - c)]
    }

    #[test]
    fn every_formula_gives_its_sheets_index_and_abbe_number() {
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
        // n² = 1 + 1.25 λ²/(λ² - 0.01) + 1 λ²/(λ² - 100), converted by hand to each form that can express it.
        let plain = n_d_and_abbe("2", "1.25 0.01 1 100 0 0");
        for (code, constants) in [
            ("6", "1.25 0.01 1 100 0 0 0 0"),
            ("9", "1 1.25 0.01 1 100"),
            ("11", "1.25 0.01 1 100 0 0 0 0 0 0"),
            // λ²/(λ² - 100) = 1 + 100/(λ² - 100). This form takes √C as its constant.
            ("4", "1 1.25 0.1 100 10"),
        ] {
            let found = n_d_and_abbe(code, constants);
            assert!(
                (found[0] - plain[0]).abs() < 1e-12 && (found[1] - plain[1]).abs() < 1e-6,
                "{code}: {found:?}"
            );
        }
        // n² = 2.2 + 0.01/(λ² - 0.01) - 0.01 λ². The two forms agree because λ²/(λ² - 0.01) - 1 = 0.01/(λ² - 0.01).
        let seven = n_d_and_abbe("7", "2.2 0.01 0.01 0.01");
        let eight = n_d_and_abbe("8", "1.2 1 0.01 0.01");
        assert!((seven[0] - eight[0]).abs() < 1e-12 && (seven[1] - eight[1]).abs() < 1e-6);
        // A polynomial of n², written in each of the polynomial forms.
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
    fn an_unusable_entry_gives_the_reason_when_it_is_looked_up() {
        let text = b"NM A 2 0\nCD 1 x\nNM B\nCD 1 2\nNM C 2 0\nCD -1 0 0 0 0 0\nNM D 2 0\nCD 0.5 0.4 0.7 0.01\nNM E 7 0\nCD 2 1 0 0\nNM F 1 0\n";
        let catalogue = Catalogue::new("x.agf", text).expect("a catalogue");
        let why: Vec<String> = ["A", "B", "C", "D", "E", "F"]
            .map(|name| catalogue.find(name).expect("listed").err().unwrap_or_default())
            .to_vec();
        assert_eq!(why[0], "x.agf:2: \"x\" is not a number; expected a constant of CD");
        assert_eq!(why[1], "x.agf:4: the number of its formula is missing on the line NM, behind its name");
        assert!(why[2].contains("x.agf:6: the constants give index"), "{}", why[2]);
        assert!(why[2].ends_with("; expected 1 to 5"), "{}", why[2]);
        assert!(why[3].contains("a resonance at 632 nm"), "{}", why[3]);
        assert_eq!(why[4], "x.agf:10: C = 0 in B/(λ² - C)");
        assert_eq!(why[5], "x.agf:11 has no constants (CD) for it");
        let error = Catalogue::new("x.agf", b"a lens\n").expect_err("no catalogue").to_string();
        assert!(error.starts_with("x.agf:1:1: no glass"), "{error}");
        let long = vec![b'\n'; MAX_CATALOG_BYTES as usize + 1];
        assert!(Catalogue::new("x.agf", &long).expect_err("too long").message.contains("8 MiB"));
        let utf16: Vec<u8> =
            [0xFF, 0xFE].into_iter().chain("NM A 2 0\n".bytes().flat_map(|b| [b, 0])).collect();
        assert_eq!(Catalogue::new("x.agf", &utf16).expect("a catalogue").len(), 1);
    }

    #[test]
    fn a_range_and_a_name_in_another_spelling_are_read() {
        let text = "NM K-Own_1 1 0 1.5 60\rCD 2.25 0 0 0 0 0\rLD 0.25 2.5\rNM other 1 0\rCD 4\r";
        let catalogue = Catalogue::new("dir/Own Glass.agf", text.as_bytes()).expect("a catalogue");
        assert_eq!((catalogue.name.as_str(), catalogue.len()), ("OWNGLASS", 2));
        let glass = catalogue.find(&loose("kown1")).expect("listed").expect("right");
        assert_eq!((glass.range, refractive_index(glass.medium, 500.0)), (Some([250.0, 2500.0]), 1.5));
        assert_eq!(catalogue.find("OTHER").expect("listed").expect("right").range, None);
        assert_eq!(catalogue.find("OWN1"), None);
    }

    #[test]
    fn transmittances_are_read_and_wrong_lines_are_left_out() {
        let with = |rows: &str| {
            let text = format!("NM A 1 0\nCD 2.25\nLD 0.3 2.5\n{rows}NM B 1 0\nCD 2.25\nIT 0.5 0.1 10\n");
            let catalogue = Catalogue::new("x.agf", text.as_bytes()).expect("a catalogue");
            let glass = [(); 2].map(|()| catalogue.find("A").expect("listed").expect("right"))[1].clone();
            assert_eq!(refractive_index(glass.medium, 587.5618), 1.5);
            (glass.transmittance, catalogue.warnings())
        };
        let (glass, warnings) = with("IT 0.4 0.9 10\nIT 0.4 - 25\nIT 0.5\nIT 0.5 1.001 10.0 0\n");
        let glass = glass.expect("rows");
        assert!((glass.coefficient(400.0) + 0.9_f64.ln() / 10.0).abs() < 1e-15);
        assert_eq!((glass.coefficient(500.0), warnings), (0.0, Vec::new()));
        assert_eq!(with(""), (None, Vec::new()));
        for (rows, has_rows, start) in [
            ("IT 0.4 1.2 10\n", false, "x.agf:4: IT 0.4 1.2 10: expected a wavelength"),
            ("IT 0.4 0.9 0\n", false, "x.agf:4: IT 0.4 0.9 0"),
            ("IT 0.5 0.9 10\nIT 0.4 x 10\n", true, "x.agf:5: IT 0.4 x 10"),
        ] {
            let (glass, warnings) = with(rows);
            assert_eq!(glass.is_some(), has_rows, "{rows}");
            let [warning] = &warnings[..] else { panic!("once: {warnings:?}") };
            assert!(warning.starts_with(start) && warning.ends_with("this line is left out"), "{warning}");
        }
    }

    #[test]
    fn a_wrong_line_takes_away_no_more_than_it_states() {
        let text = "NM A 5 0\nCD 1.5 0 0 x\nLD 0.4 y\nNM B 5 0\nCD 1,5 0 0\nNM C 1 0\nCD 2.30 -0.80 0.014\nLD 0.4 1.6\n\
                    NM D 2 0\nCD 1 0.01 0.01 0.16 1 100\n";
        let catalogue = Catalogue::new("x.agf", text.as_bytes()).expect("a catalogue");
        let found = |name: &str| catalogue.find(name).expect("listed");
        let index = |name: &str| refractive_index(found(name).expect("right").medium, 587.5618);
        // Constants beyond the number that the formula has are ignored, and so is a malformed range.
        assert_eq!((index("A"), found("A").expect("right").range), (1.5, None));
        let why = found("B").expect_err("no index");
        assert!(
            why.starts_with("x.agf:5: \"1,5\" is not a number: its decimal point is a comma; write 1.5"),
            "{why}"
        );
        // n² = 2.30 - 0.80 λ² + 0.014/λ² gives 1.43679 at the d line and less than 1 from 1279 nm on.
        assert!((index("C") - 1.436_79).abs() < 5e-6, "{}", index("C"));
        let [from, to] = found("C").expect("right").range.expect("stated");
        assert!(from == 400.0 && (1277.0..1279.0).contains(&to), "{from} {to}");
        // A resonance lies in the violet.
        assert!(found("D").expect("right").range.is_some_and(|[from, _]| from > 400.0));
    }

    #[test]
    fn a_large_catalogue_is_read_only_for_the_named_glasses() {
        let line = "CD 1.1 0.006 0.23 0.02 1.01 103\n";
        // A glass with an excessive number of lines, and the largest allowed number of glasses.
        let mut text = format!("NM ENDLESS 2 0\n{}", "IT 0.5 1 10\n".repeat(100_000)) + line;
        for i in 1..MAX_CATALOG_GLASSES {
            text += &format!("NM G{i} 2 0\n{line}");
        }
        let catalogue = Catalogue::new("x.agf", text.as_bytes()).expect("a catalogue");
        assert_eq!((catalogue.len(), catalogue.found.borrow().len()), (MAX_CATALOG_GLASSES, 0));
        let why = catalogue.find("ENDLESS").expect("listed").expect_err("beyond what is read");
        assert!(why.contains("x.agf:1 has no constants (CD)"), "{why}");
        for _ in 0..2 {
            assert!(catalogue.find("G19999").expect("listed").is_ok());
        }
        assert_eq!(catalogue.found.borrow().len(), 2);
        let read = |name: &str| catalogue.lines(catalogue.index[name][1]).map(str::len).sum::<usize>();
        assert!(read("ENDLESS") <= MAX_GLASS_BYTES && read("G1") <= MAX_GLASS_BYTES);
        text += "NM ONEMORE 2 0\n";
        let error = Catalogue::new("x.agf", text.as_bytes()).expect_err("one more");
        assert!(error.line > 140_000 && error.message.contains("at most 20000 glasses"), "{error}");
    }
}
