//! Named glasses. A line `glass NAME sellmeier B1=… C1=… B2=… C2=… B3=… C3=…` defines a glass, with the constants in
//! any order and C in µm². The other formulas of [`Formula`] are possible too, and so is a range `from=… to=…` in µm.
//! Each constant is written with its name, so that the order in a data sheet cannot be mistaken. A row of the table
//! then has the name of the glass instead of the refractive index. Glasses of the library need no definition.
//!
//! Lines `absorption NAME NM PER_MM …` state the absorption of a glass that rows name.

use std::{cell::RefCell, sync::Arc};

use super::lines::Lines;
use crate::prescription::{
    LensFileError, MAX_INTERFACES, MAX_NAME_BYTES,
    glass::{
        Formula, GlassLibrary, HIGHEST_POWER, InternalTransmittance, LOWEST_POWER, MOST_NM, MOST_PER_MM,
        by_word, usable_range,
    },
    interfaces::{Glass, Medium},
    reader::{surface_rows::MediumBehind, text::Cell},
};
use realistic_base::message::cut;

const FORM: &str = "a glass is defined by: glass NAME sellmeier B1=… C1=… B2=… C2=… B3=… C3=… (C in µm²)";

const ABSORPTION: &str = "what a glass absorbs is: absorption NAME NM PER_MM … with wavelengths in rising order, nm, and the \
     absorption coefficient at each, 1/mm (NAME as the rows have it)";

/// Maximum number of lines `absorption` in a file, because such lines increase the work of a camera with several
/// wavelengths.
const MOST_ABSORPTIONS: usize = 100;

/// Keywords for the ends of the range of a formula, µm.
const RANGE: [&str; 2] = ["from", "to"];

/// The glasses that a file can name.
#[derive(Debug)]
pub(super) struct Glasses<'a> {
    /// The glasses that the file defines.
    defined: Vec<(String, Glass)>,
    /// The absorption that the file states for glasses, with the names of the glasses.
    absorbing: Vec<(Cell<'a>, Arc<InternalTransmittance>)>,
    library: &'a GlassLibrary,
    used: RefCell<Vec<(String, Glass)>>,
}

impl<'a> Glasses<'a> {
    /// Takes the lines that define a glass or state the absorption of a glass out of `lines`.
    pub(super) fn take(lines: &mut Lines<'a>, library: &'a GlassLibrary) -> Result<Self, LensFileError> {
        let definitions = lines.take(&["glass"]);
        let absorptions = lines.take(&["absorption"]);
        let mut glasses =
            Self { defined: Vec::new(), absorbing: Vec::new(), library, used: RefCell::default() };
        lines.at_most(
            &definitions,
            MAX_INTERFACES,
            &format!("a lens file defines at most {MAX_INTERFACES} glasses"),
        )?;
        for line in &definitions {
            let (name, glass) = glasses.definition(lines, line)?;
            glasses.defined.push((name.text.to_owned(), glass));
        }
        lines.at_most(
            &absorptions,
            MOST_ABSORPTIONS,
            &format!("a lens file says of at most {MOST_ABSORPTIONS} glasses what they absorb"),
        )?;
        for line in &absorptions {
            let (name, absorption) = absorption(lines, line)?;
            if glasses.absorbing.iter().any(|(known, _)| known.text == name.text) {
                return Err(lines.error(&name, &format!("what {name} absorbs is given twice; {ABSORPTION}")));
            }
            glasses.absorbing.push((name, Arc::new(absorption)));
        }
        Ok(glasses)
    }

    /// Returns the medium that a name in the index column stands for; `None` if the word is to be read as a number.
    pub(super) fn find(
        &self,
        lines: &Lines<'_>,
        word: &Cell<'_>,
    ) -> Result<Option<MediumBehind>, LensFileError> {
        if let Some((_, glass)) = self.defined.iter().find(|(name, _)| *name == word.text) {
            return Ok(Some(self.use_as(word, glass.clone())));
        }
        let is_number = word.text.parse::<f64>().is_ok();
        if !is_number
            && word.text.len() <= MAX_NAME_BYTES
            && let Some(found) = self.library.find(word.text)
        {
            let unusable = |why: String| lines.error(word, &format!("glass \"{word}\": {why}"));
            return found.map(|glass| Some(self.use_as(word, glass))).map_err(unusable);
        }
        // A six-digit code is also a number, but larger than any index.
        match by_word(word.text) {
            Some(Medium::Air) => return Ok(Some(Medium::Air.into())),
            Some(medium) => return Ok(Some(self.use_as(word, Glass::new(medium, None)))),
            None if is_number => return Ok(None),
            None => {}
        }
        if !is_name(word.text) {
            return Ok(None);
        }
        check_length(lines, word)?;
        let known = match self.defined.as_slice() {
            [] => "the file defines none".to_owned(),
            some => {
                let names: Vec<&str> = some.iter().map(|(name, _)| name.as_str()).collect();
                format!("the file defines {}", cut(&names.join(", ")))
            }
        };
        let unknown = self.library.unknown(word.text);
        let message =
            format!("\"{word}\" is neither a refractive index nor a known glass: {known}; {unknown}; {FORM}");
        Err(lines.error(word, &message))
    }

    /// Returns the glasses that rows name.
    ///
    /// # Errors
    /// The absorption of a glass is stated, but no row names the glass.
    pub(super) fn used(self, lines: &Lines<'_>) -> Result<Vec<(String, Glass)>, LensFileError> {
        let used = self.used.into_inner();
        let is_used = |name: &Cell<'_>| used.iter().any(|(known, _)| *known == name.text);
        if let Some((name, _)) = self.absorbing.iter().find(|(name, _)| !is_used(name)) {
            return Err(lines.error(name, &format!("no row names a glass \"{name}\"; {ABSORPTION}")));
        }
        Ok(used)
    }

    fn use_as(&self, name: &Cell<'_>, mut glass: Glass) -> MediumBehind {
        if let Some((_, own)) = self.absorbing.iter().find(|(known, _)| known.text == name.text) {
            glass.transmittance = Some(own.clone());
        }
        MediumBehind::named(name.text, glass, &mut self.used.borrow_mut())
    }

    fn definition<'t>(
        &self,
        lines: &Lines<'_>,
        line: &[Cell<'t>],
    ) -> Result<(Cell<'t>, Glass), LensFileError> {
        let [glass, name, formula, words @ ..] = line else {
            return Err(lines.error(&line[0], FORM));
        };
        if !is_name(name.text) || name.text.parse::<f64>().is_ok() {
            let text = format!("\"{name}\" is not a glass's name: it begins with a letter; {FORM}");
            return Err(lines.error(name, &text));
        }
        check_length(lines, name)?;
        if self.defined.iter().any(|(known, _)| *known == name.text) {
            return Err(lines.error(name, &format!("glass \"{name}\" is defined twice")));
        }
        let Some(mut names) = constants_of(formula.text) else {
            let known = "formulas are sellmeier, polynomial, conrady and herzberger";
            return Err(lines.error(formula, &format!("no formula is called \"{formula}\"; {known}; {FORM}")));
        };
        let count = names.len();
        names.extend(RANGE.map(str::to_owned));
        let mut constants = lines.constants(words, &names, &format!("{}=1.04", names[0]), FORM)?;
        let range = match constants.split_off(count)[..] {
            [Some(from), Some(to)] if 0.0 < from && from < to => Some([from, to].map(|end| 1e3 * end)),
            [None, None] => None,
            _ => return Err(lines.error(name, &format!("the range is from=… to=…, both, in µm; {FORM}"))),
        };
        let medium = medium(formula.text, &constants).map_err(|missing| {
            let given = constants.iter().flatten().count();
            lines.error(glass, &format!("{given} of {missing} constants; {FORM}"))
        })?;
        let range =
            usable_range(medium, range).map_err(|wrong| lines.error(name, &format!("{wrong}; {FORM}")))?;
        Ok((*name, Glass::new(medium, range)))
    }
}

/// Reads a line `absorption`: the name of a glass and its absorption.
fn absorption<'t>(
    lines: &Lines<'_>,
    line: &[Cell<'t>],
) -> Result<(Cell<'t>, InternalTransmittance), LensFileError> {
    let [_, name, values @ ..] = line else {
        return Err(lines.error(&line[0], ABSORPTION));
    };
    let (pairs, []) = values.as_chunks::<2>() else {
        let last = &values[values.len() - 1];
        return Err(lines.error(last, &format!("the wavelength {last} has no coefficient; {ABSORPTION}")));
    };
    let mut rows: Vec<[f64; 2]> = Vec::with_capacity(pairs.len());
    for [wavelength_word, coefficient_word] in pairs {
        let wavelength = lines.number(wavelength_word, "a wavelength in nm")?;
        if !(wavelength > rows.last().map_or(0.0, |[before, _]| *before) && wavelength <= MOST_NM) {
            let message = format!(
                "{wavelength_word} nm: wavelengths are positive, rise, and are at most {MOST_NM} nm; {ABSORPTION}"
            );
            return Err(lines.error(wavelength_word, &message));
        }
        let coefficient = lines.number(coefficient_word, "an absorption coefficient in 1/mm")?;
        if !(0.0..=MOST_PER_MM).contains(&coefficient) {
            let message = format!(
                "a coefficient of {coefficient_word}/mm; it is at most {MOST_PER_MM}, and glass adds no light; {ABSORPTION}"
            );
            return Err(lines.error(coefficient_word, &message));
        }
        rows.push([wavelength, coefficient]);
    }
    let absorption = InternalTransmittance::of_coefficients(rows);
    Ok((*name, absorption.ok_or_else(|| lines.error(name, &format!("no wavelengths; {ABSORPTION}")))?))
}

/// Returns the names of a formula's constants.
fn constants_of(formula: &str) -> Option<Vec<String>> {
    let names = |names: &[&str]| Some(names.iter().map(|name| (*name).to_owned()).collect());
    match formula.to_ascii_lowercase().as_str() {
        "sellmeier" => names(&["B1", "B2", "B3", "C1", "C2", "C3", "B4", "B5", "C4", "C5", "A", "D"]),
        "polynomial" => Some((LOWEST_POWER..=HIGHEST_POWER).step_by(2).map(|p| format!("A{p}")).collect()),
        "conrady" => names(&["A", "B", "C"]),
        "herzberger" => names(&["A", "B", "C", "D", "E", "F"]),
        _ => None,
    }
}

/// Returns the medium that a formula gives with these constants, which are in the order of [`constants_of`].
///
/// # Errors
/// Constants are missing; the error is the number of constants that the formula requires, as a word.
fn medium(formula: &str, constants: &[Option<f64>]) -> Result<Medium, &'static str> {
    let every = |missing| constants.iter().copied().collect::<Option<Vec<f64>>>().ok_or(missing);
    let or = |index: usize, default: f64| constants[index].unwrap_or(default);
    Ok(Medium::Formula(match formula.to_ascii_lowercase().as_str() {
        "sellmeier" if constants[6..].iter().all(Option::is_none) => {
            let [Some(b1), Some(b2), Some(b3), Some(c1), Some(c2), Some(c3)] = constants[..6] else {
                return Err("six");
            };
            return Ok(Medium::Sellmeier { b: [b1, b2, b3], c: [c1, c2, c3] });
        }
        // If a constant beyond those of three terms is given, any constant may be left out.
        "sellmeier" => Formula::Sellmeier {
            rest: [or(10, 1.0), or(11, 0.0)],
            b: [0, 1, 2, 6, 7].map(|index| or(index, 0.0)),
            c: [3, 4, 5, 8, 9].map(|index| or(index, 0.0)),
        },
        "conrady" => Formula::Conrady(every("three")?.try_into().expect("three")),
        "herzberger" => Formula::Herzberger(every("six")?.try_into().expect("six")),
        _ => Formula::Polynomial(std::array::from_fn(|index| or(index, 0.0))),
    }))
}

fn check_length(lines: &Lines<'_>, name: &Cell<'_>) -> Result<(), LensFileError> {
    let length = name.text.len();
    if length <= MAX_NAME_BYTES {
        return Ok(());
    }
    let message = format!("\"{name}\" has {length} bytes; a glass's name has at most {MAX_NAME_BYTES}");
    Err(lines.error(name, &message))
}

/// Returns whether a word can be the name of a glass: it begins with a letter and is not `stop`.
fn is_name(text: &str) -> bool {
    text.starts_with(|first: char| first.is_ascii_alphabetic()) && !text.eq_ignore_ascii_case("stop")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::prescription::{
        glass::refractive_index,
        reader::checks::{ok, refused},
    };

    const BK7: &str = "glass N-BK7 sellmeier B1=1.03961212 B2=0.231792344 B3=1.01046945 \
                       C1=0.00600069867 C2=0.0200179144 C3=103.560653\n";

    #[test]
    fn a_named_glass_is_read_from_the_index_column_of_either_table() {
        let four = ok(&format!("{BK7}20 5 N-BK7 10\n-20 30 1 10\n"));
        let Medium::Sellmeier { b, c } = four.interfaces[0].medium else { panic!("{four:?}") };
        assert_eq!((b[1], c[2]), (0.231792344, 103.560653));
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
    fn a_files_glass_comes_before_the_built_in_one() {
        let rows = "20 5 n-bk7 10\n-20 30 1 10\n";
        let built_in = ok(rows);
        assert_eq!(built_in.interfaces, ok(&format!("{BK7}{}", rows.to_uppercase())).interfaces);
        let [(name, glass)] = &built_in.glasses[..] else { panic!("{built_in:?}") };
        assert_eq!((name.as_str(), glass.medium), ("n-bk7", built_in.interfaces[0].medium));
        assert_eq!(glass.range, Some([300.0, 2500.0]));
        let own = ok(&format!("{}{}", BK7.replace("1.0396", "1.0397"), rows.to_uppercase()));
        assert_ne!(own.interfaces[0].medium, built_in.interfaces[0].medium);
        // A name may begin with a digit if the library has it.
        assert!(ok("20 5 480R 10\n-20 30 1 10").is_dispersive());
    }

    #[test]
    fn every_formula_can_be_written() {
        let index = |definition: &str| {
            let lens = ok(&format!("glass x {definition}\n20 5 x 10\n-20 30 1 10"));
            refractive_index(lens.interfaces[0].medium, 500.0)
        };
        // Expected values at 0.5 µm, where λ² = 1/4, computed by hand.
        let near = |definition: &str, square: f64| {
            let index = index(definition);
            assert!((index * index - square).abs() < 1e-12, "{definition}: {index}");
        };
        near("sellmeier A=2 D=-0.4 B1=0.6 C1=0.01 B4=0.5 C4=0.05", 2.0 - 0.1 + 0.15 / 0.24 + 0.125 / 0.2);
        near("polynomial A0=2 A2=0.4 A-2=0.01 A-12=1e-7 A6=0.064", 2.0 + 0.1 + 0.04 + 4.096e-4 + 0.001);
        let conrady = index("conrady A=1.5 B=0.01 C=0.001");
        assert!((conrady - (1.5 + 0.02 + 0.001 * 2_f64.powf(3.5))).abs() < 1e-12, "{conrady}");
        let herzberger = index("herzberger A=1.5 B=0.01 C=0.001 D=-0.01 E=0.001 F=0.001");
        let l: f64 = 1.0 / 0.222;
        let expected = 1.5 + 0.01 * l + 0.001 * l * l - 0.0025 + 6.25e-5 + 1.5625e-5;
        assert!((herzberger - expected).abs() < 1e-12, "{herzberger}");
        refused("glass x conrady A=1 B=1\n20 5 x 10\n-20 30 1 10", "1:1", &["2 of three constants"]);
        refused(
            "glass x polynomial A3=1\n20 5 x 10\n-20 30 1 10",
            "1:20",
            &["not a constant such as A-12=1.04"],
        );
        refused("glass x polynomial A0=0.5\n20 5 x 10\n-20 30 1 10", "1:7", &["index 0.707"]);
    }

    #[test]
    fn a_malformed_definition_is_refused_with_its_location() {
        let rows = "20 5 N-BK7 10\n-20 30 1 10\n";
        let with = |from: &str, to: &str| format!("{}{rows}", BK7.replace(from, to));
        let unknown = rows.replace("N-BK7", "N-BK77");
        let nearest = "the nearest that is known is N-BK7";
        refused(
            &unknown,
            "1:6",
            &["\"N-BK77\"", "nor a known glass", "defines none", nearest, "glass NAME sellmeier"],
        );
        refused(&format!("{BK7}{unknown}"), "2:6", &["\"N-BK77\"", "defines N-BK7"]);
        refused(&with(" C3=103.560653", ""), "1:1", &["5 of six constants"]);
        refused(&with("B2=", "B1="), "1:37", &["given twice"]);
        refused(&with("B2=", ""), "1:37", &["not a constant such as B1=1.04"]);
        refused(&with("B2=0", "B2=x"), "1:40", &["not a number"]);
        refused(&with("sellmeier", "schott"), "1:13", &["\"schott\"", "sellmeier"]);
        refused(&with("N-BK7", "7"), "1:7", &["not a glass's name"]);
        refused(&with("C3=103.560653", "C3=0.35"), "1:7", &["resonance at 592 nm"]);
        refused(&with("B1=1.03961212", "B1=-3"), "1:7", &["index NaN"]);
        refused(&format!("{BK7}{BK7}{rows}"), "2:7", &["defined twice"]);
        refused(&format!("glass\n{rows}"), "1:1", &["glass NAME sellmeier"]);
        refused(&format!("{BK7}20 5 N-BK7 64.2 10\n-20 30 - - 10"), "2:12", &["write - for the V-number"]);
    }

    #[test]
    fn what_a_glass_absorbs_is_read_and_wrong_lines_are_told() {
        let rows = "20 5 N-BK7 10\n-20 2 own 10\n-50 30 1 10\nglass own conrady A=1.5 B=0.01 C=0.001\n";
        let absorption = "absorption own 380 0.25 420 0.0625\nABSORPTION N-BK7, 400, 1e-3\n";
        let lens = ok(&format!("{rows}{absorption}"));
        let [Some(crown), Some(own), None] = &lens.transmittances()[..] else { panic!("{lens:?}") };
        assert_eq!([380.0, 300.0, 420.0, 900.0].map(|nm| own.coefficient(nm)), [0.25, 0.25, 0.0625, 0.0625]);
        assert_eq!(crown.coefficient(550.0), 1e-3);
        assert!(ok(rows).transmittances().iter().all(Option::is_none));
        let with = |line: &str| format!("{line}\n{rows}");
        refused(&with("absorption"), "1:1", &["absorption NAME NM PER_MM"]);
        refused(&with("absorption own"), "1:12", &["no wavelengths"]);
        refused(&with("absorption own 380"), "1:16", &["the wavelength 380 has no coefficient"]);
        refused(&with("absorption own 420 0.1 380 0.2"), "1:24", &["380 nm", "rise"]);
        refused(&with("absorption own 0 0.1"), "1:16", &["positive"]);
        refused(&with("absorption own 380 -0.1"), "1:20", &["glass adds no light"]);
        refused(&with("absorption own 380 x"), "1:20", &["an absorption coefficient in 1/mm"]);
        refused(&with("absorption own 1e39 0.1"), "1:16", &["at most 1000000 nm"]);
        refused(&with("absorption own 380 1e39"), "1:20", &["at most 1000"]);
        let twins = "20 5 N-BK7 10\n-20 2 N-BK7HT 10\n-50 30 1 10\nabsorption N-BK7HT 400 0.1\n";
        // Two glasses with the same formula.
        let [None, Some(dim), None] = &ok(twins).transmittances()[..] else { panic!("{twins}") };
        assert_eq!(dim.coefficient(500.0), 0.1);
        let many = (0..101).map(|i| format!("absorption own{i} 400 0.1\n")).collect::<String>();
        refused(&format!("{many}{rows}"), "101:1", &["at most 100 glasses"]);
        refused(&with("absorption F2 380 0.1"), "1:12", &["no row names a glass \"F2\""]);
        refused(&with(&format!("{absorption}absorption own 500 0")), "3:12", &["given twice"]);
    }
}
