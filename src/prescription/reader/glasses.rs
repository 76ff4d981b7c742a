//! Lines that define a glass by name: `glass N-BK7 sellmeier B1=… C1=… B2=… C2=… B3=… C3=…`, in any
//! order, C in µm². Each constant bears its name, so that a data sheet's order cannot be mistaken. A row of the
//! table then has the name where others have the refractive index.

use super::lines::{Line, Lines, Word};
use crate::{
    message::{cut, short},
    prescription::{
        LensFileError,
        glass::{C_LINE, D_LINE, F_LINE, VALID_WAVELENGTHS, refractive_index},
        interfaces::{Medium, Sellmeier},
        limits::{MAX_INTERFACES, MAX_NAME_BYTES},
    },
};

const FORM: &str = "a glass is defined by: glass NAME sellmeier B1=… C1=… B2=… C2=… B3=… C3=… (C in µm²)";

/// The glasses that a file defines, by name.
#[derive(Debug, Default)]
pub(super) struct Glasses(Vec<(String, Medium)>);

impl Glasses {
    /// Takes the lines that define a glass out of the others.
    pub(super) fn take(lines: &mut Lines) -> Result<Self, LensFileError> {
        let is_glass = |line: &Line| line.words[0].text.eq_ignore_ascii_case("glass");
        let (definitions, table) = std::mem::take(&mut lines.lines).into_iter().partition(is_glass);
        lines.lines = table;
        let mut glasses = Self::default();
        let definitions: Vec<Line> = definitions;
        lines.at_most(&definitions, &format!("a lens file defines at most {MAX_INTERFACES} glasses"))?;
        for line in &definitions {
            let (name, constants) = glasses.definition(lines, line)?;
            glasses.0.push((name.text.clone(), Medium::Sellmeier(constants)));
        }
        Ok(glasses)
    }

    /// The medium of a name in the index column; `None` when the word is to be read as a number.
    pub(super) fn find(&self, lines: &Lines, word: &Word) -> Result<Option<Medium>, LensFileError> {
        if let Some((_, medium)) = self.0.iter().find(|(name, _)| *name == word.text) {
            return Ok(Some(*medium));
        }
        if !is_name(&word.text) || word.text.parse::<f64>().is_ok() {
            return Ok(None);
        }
        check_length(lines, word)?;
        let known = match self.0.as_slice() {
            [] => "the file defines none".to_owned(),
            some => {
                let names: Vec<&str> = some.iter().map(|(name, _)| name.as_str()).collect();
                format!("the file defines {}", cut(&names.join(", ")))
            }
        };
        Err(lines.error(word, &format!("\"{word}\" is no refractive index and no glass: {known}; {FORM}")))
    }

    fn definition<'a>(&self, lines: &Lines, line: &'a Line) -> Result<(&'a Word, Sellmeier), LensFileError> {
        let [glass, name, formula, words @ ..] = line.words.as_slice() else {
            return Err(lines.error(&line.words[0], FORM));
        };
        if !is_name(&name.text) || name.text.parse::<f64>().is_ok() {
            let text = format!("\"{name}\" is no name for a glass: it begins with a letter; {FORM}");
            return Err(lines.error(name, &text));
        }
        check_length(lines, name)?;
        if self.0.iter().any(|(known, _)| *known == name.text) {
            return Err(lines.error(name, &format!("glass \"{name}\" is defined twice")));
        }
        if !formula.text.eq_ignore_ascii_case("sellmeier") {
            return Err(lines.error(formula, &format!("no formula is called \"{formula}\"; {FORM}")));
        }
        let mut constants = [None; 6];
        for word in words {
            let (place, number) = constant(lines, word)?;
            if constants[place].replace(number).is_some() {
                return Err(lines.error(word, &format!("\"{word}\": given twice; {FORM}")));
            }
        }
        let [Some(b1), Some(b2), Some(b3), Some(c1), Some(c2), Some(c3)] = constants else {
            return Err(lines.error(glass, &format!("{} of six constants; {FORM}", words.len())));
        };
        let constants = Sellmeier { b: [b1, b2, b3], c: [c1, c2, c3] };
        check(constants).map_err(|wrong| lines.error(name, &wrong))?;
        Ok((name, constants))
    }
}

/// Where a constant such as `B1=1.04` stands among B1, B2, B3, C1, C2, C3, and its value.
fn constant(lines: &Lines, word: &Word) -> Result<(usize, f64), LensFileError> {
    const NAMES: [&str; 6] = ["B1", "B2", "B3", "C1", "C2", "C3"];
    let split = word.text.split_once('=');
    let place = split.and_then(|(name, _)| NAMES.iter().position(|known| known.eq_ignore_ascii_case(name)));
    let (Some((name, number)), Some(place)) = (split, place) else {
        return Err(lines.error(word, &format!("\"{word}\" is no constant such as B1=1.04; {FORM}")));
    };
    let value = Word { text: number.to_owned(), line: word.line, column: word.column + name.len() + 1 };
    Ok((place, lines.number(&value, "a constant of Sellmeier's formula")?))
}

/// That the constants are a glass's in the range in which they will be used.
fn check(constants: Sellmeier) -> Result<(), String> {
    let (shortest, longest) = (*VALID_WAVELENGTHS.start(), *VALID_WAVELENGTHS.end());
    let resonances = [shortest, longest].map(|wavelength| (wavelength * 1e-3).powi(2));
    if let Some(c) = constants.c.iter().find(|c| (resonances[0]..=resonances[1]).contains(*c)) {
        return Err(format!(
            "C = {c} µm² is a resonance at {:.0} nm, between {shortest} and {longest} nm; {FORM}",
            1e3 * c.sqrt()
        ));
    }
    for wavelength in [shortest, F_LINE, D_LINE, C_LINE, longest] {
        let index = refractive_index(Medium::Sellmeier(constants), wavelength);
        if !(index > 1.0 && index < 5.0) {
            return Err(format!("the constants give index {} at {wavelength} nm; {FORM}", short(index)));
        }
    }
    Ok(())
}

fn check_length(lines: &Lines, name: &Word) -> Result<(), LensFileError> {
    let length = name.text.len();
    if length <= MAX_NAME_BYTES {
        return Ok(());
    }
    let message = format!("\"{name}\" has {length} bytes; a glass's name has at most {MAX_NAME_BYTES}");
    Err(lines.error(name, &message))
}

/// Whether a word can be a glass's name: it begins with a letter and is none of the table's own words.
fn is_name(text: &str) -> bool {
    text.starts_with(|first: char| first.is_ascii_alphabetic()) && !text.eq_ignore_ascii_case("stop")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::prescription::{Prescription, reader::read};

    const BK7: &str = "glass N-BK7 sellmeier B1=1.03961212 B2=0.231792344 B3=1.01046945 \
                       C1=0.00600069867 C2=0.0200179144 C3=103.560653\n";

    fn ok(text: &str) -> Prescription {
        read("lens.dat", text.as_bytes()).unwrap_or_else(|error| panic!("{error}"))
    }

    #[track_caller]
    fn refused(text: &str, at: &str, parts: &[&str]) {
        let message = read("lens.dat", text.as_bytes()).expect_err("refused").to_string();
        assert!(message.starts_with(&format!("lens.dat:{at}: ")), "{message}");
        for part in parts {
            assert!(message.contains(part), "{message} lacks {part:?}");
        }
    }

    #[test]
    fn a_named_glass_stands_in_the_index_column_of_either_table() {
        let four = ok(&format!("{BK7}20 5 N-BK7 10\n-20 30 1 10\n"));
        let Medium::Sellmeier(constants) = four.interfaces[0].medium else { panic!("{four:?}") };
        assert_eq!((constants.b[1], constants.c[2]), (0.231792344, 103.560653));
        assert!(four.is_dispersive());
        for text in [
            format!("20 5 N-BK7 - 10\n-20 30 10\n{BK7}"),
            format!("# title\n50\n{BK7}20 5 N-BK7 - 10\n-20 30 - - 10"),
            format!("20 5 N-BK7 10\n{}-20 30 1 10", BK7.replace(' ', ", ").to_ascii_uppercase()),
        ] {
            assert_eq!(ok(&text).interfaces, four.interfaces, "{text}");
        }
    }

    #[test]
    fn a_wrong_definition_is_told_where_it_stands() {
        let rows = "20 5 N-BK7 10\n-20 30 1 10\n";
        let with = |from: &str, to: &str| format!("{}{rows}", BK7.replace(from, to));
        refused(rows, "1:6", &["\"N-BK7\"", "no glass", "defines none", "glass NAME sellmeier"]);
        refused(&format!("{BK7}20 5 SF2 10\n-20 30 1 10"), "2:6", &["\"SF2\"", "defines N-BK7"]);
        refused(&with(" C3=103.560653", ""), "1:1", &["5 of six constants"]);
        refused(&with("B2=", "B1="), "1:37", &["given twice"]);
        refused(&with("B2=", ""), "1:37", &["no constant such as B1=1.04"]);
        refused(&with("B2=0", "B2=x"), "1:40", &["not a number"]);
        refused(&with("sellmeier", "schott"), "1:13", &["\"schott\"", "sellmeier"]);
        refused(&with("N-BK7", "7"), "1:7", &["no name"]);
        refused(&with("C3=103.560653", "C3=0.35"), "1:7", &["resonance at 592 nm"]);
        refused(&with("B1=1.03961212", "B1=-3"), "1:7", &["index NaN"]);
        refused(&format!("{BK7}{BK7}{rows}"), "2:7", &["defined twice"]);
        refused(&format!("glass\n{rows}"), "1:1", &["glass NAME sellmeier"]);
        refused(&format!("{BK7}20 5 N-BK7 64.2 10\n-20 30 - - 10"), "2:12", &["write - for the V-number"]);
    }
}
