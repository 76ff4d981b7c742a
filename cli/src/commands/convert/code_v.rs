//! Writes a lens as a sequence of CODE V's commands (.seq): `RDM` for radii, `S` with radius, thickness and glass for
//! each surface, and a private catalogue for glasses without a name. Sizes are *semi*-diameters.

use super::{
    glasses::Material,
    numbers::{number, numbers},
    sequence::{Sequence, SequenceRow},
};
use realistic_optics::prescription::{
    Aperture, Medium, Outline,
    glass::{C_LINE, D_LINE, F_LINE, Formula, refractive_index},
};
use std::fmt::Write as _;

/// The beginning of a line that holds a note.
pub const NOTE: &str = "! ";

/// The letters of the terms of r^4, r^6, … r^20.
const TERMS: [&str; 9] = ["A", "B", "C", "D", "E", "F", "G", "H", "J"];

/// The wavelengths, nm, at which a private glass has its indices, beside the lens's own.
const TABLE: [f64; 9] = [404.66, 435.84, 479.99, F_LINE, 546.07, D_LINE, 632.8, C_LINE, 706.52];

/// Returns the text. `notes` has the notes about the sequence, and receives what the format cannot state.
///
/// # Errors
/// A surface has a figure without words in this format. The rays of another figure would be wrong.
pub fn write(sequence: &Sequence<'_>, notes: &mut Vec<String>) -> Result<String, String> {
    sequence.note_one_configuration(notes);
    sequence.note_no_coatings(notes);
    let mut private = PrivateGlasses::default();
    let mut surfaces = String::new();
    let object = sequence.configurations[0].object_distance;
    let object = if object.is_finite() { number(object) } else { "1e20".to_owned() };
    let _ = writeln!(surfaces, "SO 0 {object}{}", private.word(&sequence.object));
    for row in &sequence.rows {
        let radius = if row.radius.is_infinite() { 0.0 } else { row.radius };
        let [radius, thickness] = [radius, row.thickness].map(number);
        let _ = writeln!(surfaces, "S {radius} {thickness}{}", private.word(&row.behind));
        if row.is_stop {
            surfaces += "  STO\n";
        }
        surfaces += &figure(row)?;
        let circle = || format!("  CIR {}\n", number(row.semi_diameter));
        surfaces += &row.shape(|shape| aperture(shape, row.semi_diameter), notes).unwrap_or_else(circle);
    }
    surfaces += "SI 0 0\n";
    let glasses = private.definitions(sequence, notes);

    let mut text = String::new();
    for note in notes.iter() {
        let _ = writeln!(text, "{NOTE}{}", note.replace(['\n', '\r'], " "));
    }
    text += "RDM;LEN\n";
    if let Some(title) = sequence.title {
        let _ = writeln!(text, "TITLE '{}'", title.replace('\'', "`"));
    }
    let _ = writeln!(text, "EPD {}\nDIM M", number(sequence.entrance_pupil));
    let _ = writeln!(text, "WL {}", numbers(sequence.wavelengths.iter().copied()));
    let _ = writeln!(text, "REF {}", sequence.primary + 1);
    let angles = sequence.angles();
    let _ = writeln!(text, "XAN {}", numbers(angles.iter().map(|_| 0.0)));
    let _ = writeln!(text, "YAN {}", numbers(angles));
    Ok(text + &glasses + &surfaces + "GO\n")
}

/// Returns the lines of a figure that is no sphere.
fn figure(row: &SequenceRow<'_>) -> Result<String, String> {
    if row.terms.is_empty() {
        let conic = format!("  CON\n  K {}\n", number(row.conic));
        return Ok(if row.conic == 0.0 { String::new() } else { conic });
    }
    let mut text = format!("  ASP\n  K {}\n", number(row.conic));
    for (power, term) in &row.terms {
        let letter =
            power.checked_sub(4).filter(|power| power % 2 == 0).and_then(|power| TERMS.get(power / 2));
        let letter = letter.ok_or_else(|| {
            format!(
                "surface {} has a term of r^{power}, and aspheres of CODE V (ASP) have r^4, r^6 to r^20; write .zmx or \
                 .json",
                row.number
            )
        })?;
        let _ = writeln!(text, "  {letter} {}", number(*term));
    }
    Ok(text)
}

/// Returns the lines of an aperture of a surface with this semi-diameter; `None` for an aperture whose words are not
/// known for certain.
fn aperture(shape: &Aperture, semi_diameter: f64) -> Option<String> {
    if shape.center != [0.0; 2] || shape.rotation != 0.0 {
        return None;
    }
    match (&shape.outline, shape.is_obstruction) {
        (Outline::Ellipse([radius, other]), true) if radius == other => {
            Some(format!("  CIR {}\n  CIR OBS {}\n", number(semi_diameter), number(*radius)))
        }
        (Outline::Rectangle([x, y]), false) => Some(format!("  REX {}\n  REY {}\n", number(*x), number(*y))),
        _ => None,
    }
}

/// The glasses that the file defines.
#[derive(Default)]
struct PrivateGlasses {
    all: Vec<(String, Material)>,
}

impl PrivateGlasses {
    /// Returns the word for a medium, behind a space; empty for air. A glass of n_d and V is their decimals; one without
    /// a catalogue is defined in the file.
    fn word(&mut self, material: &Material) -> String {
        if let Material::Numbers { n_d, abbe: Some(abbe), .. } = material
            && let Some(code) = code(*n_d, *abbe)
        {
            return format!(" {code}");
        }
        match material {
            Material::Air => String::new(),
            Material::Named { name, catalogue, .. } => format!(" {}_{catalogue}", loose(name)),
            Material::Numbers { .. } | Material::Formula { .. } => {
                let known = self.all.iter().find(|(_, known)| known == material);
                let name = known.map(|(name, _)| name.clone()).unwrap_or_else(|| {
                    let name = format!("GLASS{}", self.all.len() + 1);
                    self.all.push((name.clone(), material.clone()));
                    name
                });
                format!(" '{name}'")
            }
        }
    }

    /// Returns the private catalogue: Laurent's formula where the glass has it, otherwise indices at some wavelengths.
    fn definitions(&self, sequence: &Sequence<'_>, notes: &mut Vec<String>) -> String {
        if self.all.is_empty() {
            return String::new();
        }
        let mut wavelengths = [&TABLE[..], &sequence.wavelengths].concat();
        wavelengths.sort_by(f64::total_cmp);
        wavelengths.dedup();
        let has_index = |nm: &f64| {
            let index = |(_, material): &(String, Material)| refractive_index(material.medium(), *nm);
            self.all.iter().all(|own| (1.0..5.0).contains(&index(own)))
        };
        wavelengths.retain(has_index);
        let mut text = format!("PRV\nPWL {}\n", numbers(wavelengths.iter().copied()));
        let mut tabulated = Vec::new();
        for (name, material) in &self.all {
            let medium = material.medium();
            let constants = match laurent(medium) {
                Some(constants) => format!("LAU {}", numbers(constants)),
                None => {
                    tabulated.extend(medium.is_dispersive().then_some(name.as_str()));
                    numbers(wavelengths.iter().map(|nm| refractive_index(medium, *nm)))
                }
            };
            let _ = writeln!(text, "'{name}' {constants}");
            if let Some(own) = material.name().filter(|own| own != name) {
                notes.push(format!("{name} is {own}"));
            }
        }
        if !tabulated.is_empty() {
            notes.push(format!(
                "{}: indices at {} wavelengths (PWL), exact at these; between them CODE V interpolates",
                tabulated.join(", "),
                wavelengths.len()
            ));
        }
        text + "END\n"
    }
}

/// Returns n_d and V as six decimals each, 516800.641700 for 1.5168 and 64.17; `None` if they have more. Decimals of n_d
/// below .3 would mean an index from 2 on.
fn code(n_d: f64, abbe: f64) -> Option<String> {
    let (n, v) = (format!("{:06.0}", (n_d - 1.0) * 1e6), format!("{:06.0}", abbe * 1e4));
    let is_exact = (1.3..2.0).contains(&n_d)
        && v.len() == 6
        && format!("1.{n}").parse() == Ok(n_d)
        && format!("{}.{}", &v[..2], &v[2..]).parse() == Ok(abbe);
    is_exact.then(|| format!("{n}.{v}"))
}

/// Returns A0 to A5 of n² = A0 + A1 λ² + A2 λ^-2 + A3 λ^-4 + A4 λ^-6 + A5 λ^-8, if the medium has this formula.
fn laurent(medium: Medium) -> Option<[f64; 6]> {
    match medium {
        Medium::Formula(Formula::Polynomial([lower, low, a5, a4, a3, a2, a0, a1, high, higher])) => {
            [lower, low, high, higher].iter().all(|term| *term == 0.0).then_some([a0, a1, a2, a3, a4, a5])
        }
        _ => None,
    }
}

/// Returns a name of a glass as CODE V writes it: capitals, without dashes, underscores and spaces.
fn loose(name: &str) -> String {
    let counts = |c: &char| !matches!(c, '-' | '_' | ' ');
    name.chars().filter(counts).map(|c| c.to_ascii_uppercase()).collect()
}
