//! Lenses of Physical Camera, an add-on for Blender, in TOML: a table `[lens]`, and a table `[[surface]]` for each
//! surface, scene side first. A surface has `radius` (0: a plane), `thickness`, `ior` and `abbe_v` of the medium behind
//! it, and `aperture`, its clear *diameter*. `type` is spherical, flat, stop, aspheric or cylindrical. An aspheric
//! surface has `conic` and `aspheric_coeffs` from the term of r⁴ on, in even powers. The last thickness is 0: the file
//! does not state the film's place.
//!
//! `coating` is the lens's: `single` is read as a quarter wave, and `multi` as the three-layer broadband coating, on
//! surfaces between air and glass. The gaps for near objects (`[focus]`) are left out, because the file does not say
//! from where the object's distance is measured.

use std::ops::Range;

use toml::de::{DeTable, DeValue};

use super::{
    ledger::Ledger,
    surface_rows::{self, General, MediumBehind, Role, SurfaceRow},
    text::{Location, Text},
};
use crate::prescription::{
    Fate, LensFileError,
    coating::{Coating, SurfaceCoating},
    interfaces::{Asphere, FIRST_POWER, Medium, NO_TERMS, Prescription, Stated, has_coating},
    unsymmetric::{Meridian, Toroid, Unsymmetric},
};
use realistic_base::message::{cut, quoted};

/// The power of the first of `aspheric_coeffs`.
const FIRST_COEFFICIENT: usize = 4;

/// The coatings of a lens by their names.
const COATINGS: [(&str, Coating); 3] =
    [("none", Coating::Bare), ("single", Coating::QuarterWave), ("multi", Coating::ThreeLayer)];

/// Returns whether a text has the tables of a lens.
pub(super) fn is_lens(bytes: &[u8]) -> bool {
    let mut lines = bytes.split(|byte| *byte == b'\n');
    let mut has = |heading: &[u8]| {
        lines.any(|line| {
            line.split(|byte| *byte == b'#').next().is_some_and(|line| line.trim_ascii() == heading)
        })
    };
    has(b"[lens]") && has(b"[[surface]]")
}

/// Reads a lens from a text.
///
/// # Errors
/// The text is not a lens; the error gives the first location at which it is malformed.
pub(super) fn read(text: &Text<'_>, ledger: &mut Ledger<'_>) -> Result<Prescription, LensFileError> {
    let document = Document::of(text);
    let root = DeTable::parse(text.whole()).map_err(|error| {
        document.error(&error.span().unwrap_or(0..0), format!("not TOML: {}", cut(error.message())))
    })?;
    let mut facts = Facts::default();
    let mut rows: Vec<(SurfaceRow, Location)> = Vec::new();
    for (key, value) in root.get_ref() {
        let span = key.span().start..value.span().end;
        match (&**key.get_ref(), value.get_ref()) {
            ("lens", DeValue::Table(table)) => facts = facts_of(&document, table, ledger)?,
            ("surface", DeValue::Array(surfaces)) => {
                for surface in surfaces.iter() {
                    let DeValue::Table(table) = surface.get_ref() else {
                        return Err(document.error(&surface.span(), "a surface is a table"));
                    };
                    let row = row(&document, table, &surface.span(), rows.len() + 1, ledger)?;
                    rows.push((row, document.location(surface.span().start)));
                }
            }
            ("focus", _) => document.leave_out_focus(value.get_ref(), &span, ledger),
            (name, _) => {
                let reason = format!("{} is not known to this reader", cut(name));
                ledger.warn(Fate::LeftOut, document.location(span.start), name, None, reason);
            }
        }
    }
    let (rows, locations): (Vec<SurfaceRow>, Vec<Location>) = rows.into_iter().unzip();
    let Some(last) = rows.len().checked_sub(1) else {
        return Err(document.error(&(0..0), "no [[surface]]; expected at least one"));
    };
    let at = |row: usize, message: &str| text.error(locations[row], message);
    let mut interfaces = surface_rows::interfaces(&rows, Medium::Air, &at, ledger)?;
    surface_rows::film_in_air(&interfaces, &at)?;
    let back = std::mem::take(&mut interfaces[last].thickness);
    let coatings = facts.coating.filter(|coating| *coating != Coating::Bare).map(|coating| {
        let own = |has: bool| SurfaceCoating::from(if has { coating } else { Coating::Bare });
        has_coating(Medium::Air, &interfaces).map(own).collect()
    });
    let is_heading = |word: &str| ["[lens]", "[[surface]]"].iter().any(|heading| word.starts_with(heading));
    ledger.use_open(|_, word| is_heading(word).then_some(word));
    Ok(Prescription {
        title: facts.title,
        nominal_film_distance: (back > 0.0).then_some(back),
        stated_focal_length: facts.focal_length,
        stated: Stated { fnumber: facts.fnumber, ..Stated::default() },
        coatings,
        ..Prescription::new(interfaces)
    })
}

/// The values of `[lens]`.
#[derive(Default)]
struct Facts {
    title: Option<String>,
    focal_length: Option<f64>,
    fnumber: Option<f64>,
    coating: Option<Coating>,
}

fn facts_of(
    document: &Document<'_, '_>,
    table: &DeTable<'_>,
    ledger: &mut Ledger<'_>,
) -> Result<Facts, LensFileError> {
    let mut facts = Facts::default();
    for (key, value) in table {
        let (name, span) = (&**key.get_ref(), value.span());
        let number =
            || document.number(value.get_ref(), &span).map(|number| Some(number).filter(|it| *it > 0.0));
        let (fate, reason) = match name {
            "name" => {
                let title: String =
                    value.get_ref().as_str().unwrap_or("").chars().filter(|c| !c.is_control()).collect();
                facts.title = Some(title.trim().to_owned()).filter(|title| !title.is_empty());
                (Fate::Used, "")
            }
            "focal_length" => {
                facts.focal_length = number()?;
                (Fate::Used, "")
            }
            "max_fstop" => {
                facts.fnumber = number()?;
                (Fate::Used, "")
            }
            "coating" => {
                let word = value.get_ref().as_str().unwrap_or("");
                let known = COATINGS.iter().find(|(known, _)| *known == word).ok_or_else(|| {
                    let names = quoted(&COATINGS.map(|(name, _)| name));
                    document.error(&span, format!("coating \"{}\": expected {names}", cut(word)))
                })?;
                facts.coating = Some(known.1);
                (Fate::Replaced, "the coating is taken for one that has one layer (single) or three (multi)")
            }
            "patent" => (Fate::Informative, "names and notes"),
            "squeeze" => (Fate::Informative, "the cylinders of the lens decide how it squeezes the picture"),
            _ => {
                let reason = format!("{} of [lens] is not known to this reader", cut(name));
                ledger.warn(Fate::LeftOut, document.location(key.span().start), name, None, reason);
                continue;
            }
        };
        document.note(&(key.span().start..span.end), fate, name, reason, ledger);
    }
    Ok(facts)
}

/// Reads a surface; `number` is its place, counted from 1.
fn row(
    document: &Document<'_, '_>,
    table: &DeTable<'_>,
    span: &Range<usize>,
    number: usize,
    ledger: &mut Ledger<'_>,
) -> Result<SurfaceRow, LensFileError> {
    let mut kind = None;
    let [mut radius, mut thickness, mut index, mut diameter] = [None; 4];
    let [mut abbe, mut conic] = [0.0; 2];
    let mut coefficients: Option<Vec<f64>> = None;
    for (key, value) in table {
        let (name, own) = (&**key.get_ref(), value.span());
        let numeric = || document.number(value.get_ref(), &own);
        match name {
            "type" => kind = Some((value.get_ref().as_str().unwrap_or("").to_owned(), own.clone())),
            "radius" => radius = Some(numeric()?),
            "thickness" => thickness = Some(numeric()?),
            "ior" => {
                index = Some(numeric()?);
                if let Err(why) = surface_rows::index(numeric()?) {
                    return Err(document.error(&own, format!("{why}; air has 1")));
                }
            }
            "aperture" => diameter = Some(numeric()?),
            "abbe_v" => abbe = numeric()?,
            "conic" => conic = numeric()?,
            "aspheric_coeffs" => coefficients = Some(document.numbers(value.get_ref(), &own)?),
            _ => {
                let message = format!(
                    "surface {number} has \"{}\", which is not known: delete it to trace the surface without it",
                    cut(name)
                );
                return Err(document.error(&key.span(), message));
            }
        }
        document.note(&(key.span().start..own.end), Fate::Used, name, "", ledger);
    }
    let stated = |value: Option<f64>, name: &str| {
        value.ok_or_else(|| document.error(span, format!("surface {number} has no {name}")))
    };
    let radius = stated(radius, "radius")?;
    let kind =
        kind.unwrap_or_else(|| (if radius == 0.0 { "flat" } else { "spherical" }.to_owned(), span.clone()));
    match kind.0.as_str() {
        "spherical" | "aspheric" if radius == 0.0 => {
            return Err(document.error(span, format!("surface {number} is {} and has radius 0", kind.0)));
        }
        "spherical" | "flat" | "stop" | "cylindrical_x" | "cylindrical_y"
            if coefficients.is_some() || conic != 0.0 =>
        {
            let message = format!("surface {number} has the figure of an asphere and is {}", kind.0);
            return Err(document.error(&kind.1, message));
        }
        "flat" | "stop" if radius != 0.0 => {
            let message = format!("surface {number} has a radius and is {}; expected radius 0", kind.0);
            return Err(document.error(&kind.1, message));
        }
        "spherical" | "aspheric" | "flat" | "stop" | "cylindrical_x" | "cylindrical_y" => {}
        other => {
            let message = format!("surface {number} is of type \"{}\", which is not read", cut(other));
            return Err(document.error(&kind.1, message));
        }
    }
    let n_d = surface_rows::index(stated(index, "ior")?).unwrap_or(None);
    let abbe = Some(abbe).filter(|abbe| *abbe > 0.0);
    let mut terms = NO_TERMS;
    for (i, coefficient) in coefficients.into_iter().flatten().enumerate() {
        let power = FIRST_COEFFICIENT + 2 * i;
        match terms.get_mut(power - FIRST_POWER) {
            Some(term) => *term = coefficient,
            None => return Err(document.error(span, format!("surface {number} has a term of r^{power}"))),
        }
    }
    let radius = if radius == 0.0 { f64::INFINITY } else { radius };
    // The letter is that of the meridian in which the cylinder bends light.
    let meridian = match kind.0.as_str() {
        "cylindrical_x" => Some(Meridian::X),
        "cylindrical_y" => Some(Meridian::Y),
        _ => None,
    };
    let unsymmetric = meridian.map(|meridian| Unsymmetric::Toroid(Toroid::cylinder(meridian, radius)));
    Ok(SurfaceRow {
        radius: if unsymmetric.is_some() { f64::INFINITY } else { radius },
        role: if kind.0 == "stop" { Role::Stop } else { Role::Any },
        thickness: stated(thickness, "thickness")?,
        behind: MediumBehind::from(n_d.map_or(Medium::Air, |n_d| Medium::Glass { n_d, abbe })),
        diameter: stated(diameter, "aperture")?,
        asphere: (kind.0 == "aspheric").then_some(Asphere { radius: f64::INFINITY, conic, terms }),
        apertures: Vec::new(),
        general: General { unsymmetric, ..General::default() },
    })
}

/// A text, with the byte at which each line begins.
struct Document<'d, 't> {
    text: &'d Text<'t>,
    starts: Vec<usize>,
}

impl<'d, 't> Document<'d, 't> {
    fn of(text: &'d Text<'t>) -> Self {
        let ends = text.whole().match_indices('\n').map(|(at, _)| at + 1);
        Self { text, starts: std::iter::once(0).chain(ends).collect() }
    }

    fn location(&self, byte: usize) -> Location {
        let line = self.starts.partition_point(|start| *start <= byte);
        Location { line, column: byte - self.starts[line - 1] + 1 }
    }

    fn error(&self, span: &Range<usize>, message: impl Into<String>) -> LensFileError {
        self.text.error(self.location(span.start), message)
    }

    /// Records the fate of a statement on each of its lines.
    fn note(&self, span: &Range<usize>, fate: Fate, name: &str, reason: &str, ledger: &mut Ledger<'_>) {
        let [first, last] = [span.start, span.end.max(span.start + 1) - 1].map(|byte| self.location(byte));
        for line in first.line..=last.line {
            ledger.note(fate, Location { line, ..first }, name, None, reason);
        }
    }

    /// Records that the gaps for near objects are left out, on all their lines.
    fn leave_out_focus(&self, value: &DeValue<'_>, span: &Range<usize>, ledger: &mut Ledger<'_>) {
        const REASON: &str = "the gaps for near objects are left out: the file does not say from where the object's distance \
                              is measured";
        ledger.warn(Fate::LeftOut, self.location(span.start), "focus", None, REASON);
        let mut tables: Vec<&DeTable<'_>> = value.as_table().into_iter().collect();
        while let Some(table) = tables.pop() {
            for (key, value) in table {
                self.note(&(key.span().start..value.span().end), Fate::LeftOut, "focus", REASON, ledger);
                tables.extend(value.get_ref().as_table());
                let own = value.get_ref().as_array().into_iter().flat_map(|array| array.iter());
                for value in own {
                    self.note(&value.span(), Fate::LeftOut, "focus", REASON, ledger);
                    tables.extend(value.get_ref().as_table());
                }
            }
        }
    }

    /// Returns the finite number of a value.
    fn number(&self, value: &DeValue<'_>, span: &Range<usize>) -> Result<f64, LensFileError> {
        let word = match value {
            DeValue::Float(number) => number.as_str(),
            DeValue::Integer(number) if number.radix() == 10 => number.as_str(),
            _ => "",
        };
        let number = word.parse().ok().filter(|number: &f64| number.is_finite());
        number.ok_or_else(|| self.error(span, "expected a finite decimal number"))
    }

    /// Returns the finite numbers of an array.
    fn numbers(&self, value: &DeValue<'_>, span: &Range<usize>) -> Result<Vec<f64>, LensFileError> {
        let array = value.as_array().ok_or_else(|| self.error(span, "expected a list of numbers"))?;
        array.iter().map(|own| self.number(own.get_ref(), &own.span())).collect()
    }
}

#[cfg(test)]
mod tests {
    use crate::prescription::{
        Coating, Fate, Medium, Shape, SurfaceCoating, read,
        reader::checks::{ok, refused, replaced},
    };

    const LENS: &str = "[lens] # made up\nname = \"A lens\"\npatent = \"none\"\nfocal_length = 50.5\nmax_fstop = 2\n\
        coating = \"single\"\n\n# Front\n[[surface]]\nradius = 50.0\nthickness = 4\nior = 1.618\naperture = 20.0\n\
        abbe_v = 63.4\n\n[[surface]]\ntype = \"aspheric\"\nradius = -80.0\nthickness = 2.5\nior = 1.0\naperture = 19.0\n\
        abbe_v = 0.0\nconic = -0.5\naspheric_coeffs = [\n  1e-6, # A4\n  -2e-9,\n]\n\n[[surface]]\ntype = \"stop\"\n\
        radius = 0.0\nthickness = 40.0\nior = 1.0\naperture = 16.0\n";

    fn with(from: &str, to: &str) -> String {
        replaced(LENS, from, to)
    }

    #[test]
    fn surfaces_of_every_kind_are_read() {
        let lens = ok(LENS);
        let [first, second, stop] = lens.interfaces.as_slice() else { panic!("{lens:?}") };
        assert_eq!((first.shape, first.thickness), (Shape::Sphere { radius: 50.0 }, 4.0));
        assert_eq!(first.medium, Medium::Glass { n_d: 1.618, abbe: Some(63.4) });
        // The aperture is a diameter.
        assert_eq!((first.semi_diameter, stop.semi_diameter, stop.is_stop), (10.0, 8.0, true));
        let Shape::Asphere(asphere) = second.shape else { panic!("{second:?}") };
        assert_eq!((asphere.radius, asphere.conic), (-80.0, -0.5));
        assert_eq!((asphere.term(4), asphere.term(6)), (1e-6, -2e-9));
        assert!(asphere.terms.iter().filter(|term| **term != 0.0).count() == 2);
        assert_eq!((lens.title.as_deref(), lens.stated_focal_length), (Some("A lens"), Some(50.5)));
        assert_eq!((lens.stated.fnumber, lens.nominal_film_distance), (Some(2.0), Some(40.0)));
        let [coated, bare] = [Coating::QuarterWave, Coating::Bare].map(SurfaceCoating::from);
        assert_eq!(lens.coatings, Some(vec![coated.clone(), coated, bare]));
        assert_eq!(lens.remarks, [""; 0]);
        assert!(lens.findings.iter().all(|finding| finding.fate != Fate::LeftOut), "{:?}", lens.findings);
        // The letter is that of the meridian with power.
        for (kind, radii) in [("x", [50.0, f64::INFINITY]), ("y", [f64::INFINITY, 50.0])] {
            let cylinder =
                ok(&with("radius = 50.0", &format!("type = \"cylindrical_{kind}\"\nradius = 50.0")));
            let Shape::Unsymmetric(figure) = cylinder.interfaces[0].shape else { panic!("{cylinder:?}") };
            assert_eq!(figure.radii(), radii);
        }
        let open = ok(&with("thickness = 40.0", "thickness = 0.0"));
        assert_eq!(open.nominal_film_distance, None);
        assert_eq!(ok(&with("\"single\"", "\"none\"")).coatings, None);
        assert_eq!(ok(&LENS.replace('\n', "\r\n")).interfaces, lens.interfaces);
    }

    #[test]
    fn what_is_not_used_is_reported() {
        let focus =
            "[focus]\nclose_distance = 500.0\n\n[[focus.variable]]\nsurface = 1\nthickness_close = 3\n";
        let lens = ok(&format!("{LENS}\n{focus}\n[other]\na = 1\n"));
        assert_eq!(lens.interfaces, ok(LENS).interfaces);
        assert!(lens.remarks.iter().any(|remark| remark.contains("the gaps for near objects are left out")));
        assert!(
            lens.remarks.iter().any(|remark| remark.contains("other is not known")),
            "{:?}",
            lens.remarks
        );
        assert!(ok(&with("max_fstop", "size")).remarks[0].contains("size of [lens] is not known"));
    }

    #[test]
    fn a_malformed_file_is_refused_with_the_location() {
        refused(&with("= 50.5", "= "), "4:16", &["not TOML"]);
        refused(&with("= 50.5", "= \"long\""), "4:16", &["expected a finite decimal number"]);
        refused(&with("50.0", "inf"), "10:10", &["expected a finite decimal number"]);
        refused(&with("50.0", "0x10"), "10:10", &["expected a finite decimal number"]);
        refused(&with("1.618", "0.5"), "12:7", &["a refractive index is 1 or more"]);
        refused(&with("aperture = 20.0\n", ""), "9:1", &["surface 1 has no aperture"]);
        refused(&with("aperture = 20.0", "aperture = 0"), "9:1", &["clear diameter 0 mm"]);
        refused(
            &with("\"aspheric\"", "\"cylindrical_x\""),
            "17:8",
            &["surface 2 has the figure of an asphere and is cylindrical_x"],
        );
        refused(&with("\"aspheric\"", "\"toric\""), "17:8", &["surface 2 is of type \"toric\""]);
        refused(&with("\"aspheric\"", "\"spherical\""), "17:8", &["has the figure of an asphere"]);
        refused(&with("abbe_v = 63.4", "tilt = 3"), "14:1", &["surface 1 has \"tilt\", which is not known"]);
        refused(&with("\"single\"", "\"best\""), "6:11", &["\"none\", \"single\" or \"multi\""]);
        refused(&with("[\n  1e-6, # A4\n  -2e-9,\n]", "7"), "24:19", &["expected a list of numbers"]);
        refused(&with("radius = -80.0", "radius = 0"), "16:1", &["surface 2 is aspheric and has radius 0"]);
        let long = format!("[{}]", "0, ".repeat(15));
        refused(&with("[\n  1e-6, # A4\n  -2e-9,\n]", &long), "16:1", &["a term of r^32"]);
    }

    #[test]
    fn deep_and_long_texts_are_read_or_refused_at_once() {
        let depth = 300_000;
        let [dotted, arrays, tables] =
            [("a.", "a = 1"), ("[", ""), ("{a=", "")].map(|(part, end)| part.repeat(depth) + end);
        for text in [
            dotted.clone(),
            format!("[{dotted}]\n").replace(" = 1", ""),
            format!("a = {arrays}"),
            format!("a = {tables}"),
            format!("[focus]\n{dotted}"),
            "[[a]]\n".repeat(depth / 3),
            format!("x = [{}]", "1,".repeat(depth)),
        ] {
            let _ = read("lens.toml", format!("{LENS}\n{text}\n").as_bytes());
        }
    }
}
