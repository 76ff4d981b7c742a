//! Geopter: `Assembly` has the surfaces under their numbers, with the object first and the image last, and `Stop`, the
//! number of the stop. `Spec` has `Pupil` (`Type` 0 diameter, 1 f-number, 2 and 3 numerical aperture of the object and
//! the image), `Field` (`Type` 0 angle, 1 object height, 2 image height) and `Wvl` (nm).
//!
//! A `Material` is `AIR`, `NAME_MAKER` or `n_d:V`. The terms of an `ASP` begin with r⁴.

use super::{
    NamedGlasses, Part, check_image, fates::NoEffect, finished, object_own_image, place, refused, title,
};
use crate::prescription::{
    Fate, LensFileError,
    glass::{GlassLibrary, by_pair},
    interfaces::{Asphere, Medium, NO_TERMS, Prescription},
    reader::{
        ledger::Ledger,
        sequential::{Aperture, Field, SequentialLens, SequentialSurface, asphere, nanometres, set_term},
        surface_rows::{MediumBehind, checked},
        text::Location,
    },
};
use realistic_base::message::{as_given, cut};

/// Keys without an effect on rays.
pub(super) const NO_EFFECT: NoEffect = &[
    ("names and notes", &["Note", "Label"]),
    (
        "fields, wavelengths and their weights, which the user chooses",
        &["Color", "VLX", "VLY", "VUX", "VUY", "Weight"],
    ),
    (
        "describes the object or the image, which are the user's",
        &["Type", "Material", "Aperture", "Thickness", "Curvature", "Conic", "Coefs"],
    ),
];

/// Reads a lens.
///
/// # Errors
/// A value is missing or wrong, or the lens cannot be traced.
pub(super) fn read(
    root: Part<'_>,
    library: &GlassLibrary,
    ledger: &mut Ledger<'_>,
) -> Result<Prescription, LensFileError> {
    let assembly = root.need("Assembly", "the surfaces")?;
    let stop = assembly.number("Stop")?;
    let list = surfaces_in_order(assembly)?;
    let (object, own, image) = object_own_image(&list, assembly)?;
    let mut glasses = NamedGlasses::new(library, Vec::new());
    let front = checked(medium(object, "0", &mut glasses, ledger)?, |reason| {
        ledger.warn(Fate::Replaced, object.node.location, "Material", Some("0"), reason);
    });
    let mut surfaces = Vec::with_capacity(own.len());
    let mut thicknesses = Vec::with_capacity(own.len());
    let mut places = Vec::with_capacity(own.len());
    for (number, &part) in (1..).zip(own) {
        let is_stop = stop == Some(f64::from(number));
        let number: String = format!("{number}");
        surfaces.push(surface(part, &number, is_stop, &mut glasses, ledger)?);
        thicknesses.push(part.needed_number("Thickness", "the distance to the next surface")?);
        places.push(place(part, number, Some("Aperture"), Some("Thickness")));
    }
    check_image(image.number("Curvature")?.unwrap_or(0.0), image, "Curvature", ledger);
    let object_distance = object.number_or_infinity("Thickness")?.unwrap_or(f64::INFINITY);
    let specification = root.need("Spec", "aperture, fields and wavelengths")?;
    let lens = SequentialLens {
        object: front,
        object_place: object.node.location,
        object_distance,
        surfaces,
        thicknesses,
        image_break: None,
        places,
        aperture: aperture(specification, object_distance)?,
        field: field(specification)?,
        wavelength: wavelength(specification)?,
        keys: ["Assembly", "Aperture", "Thickness"],
        unit: 1.0,
    };
    let (lens, _) = lens.prescription(root.text, root.node.location, ledger)?;
    let title = title(root.string("Title")?);
    Ok(finished(Prescription { title, ..lens }, glasses, root.text.file))
}

/// Returns the surfaces in the order of their numbers, which the file sorts as words.
fn surfaces_in_order(assembly: Part<'_>) -> Result<Vec<Part<'_>>, LensFileError> {
    let mut numbered: Vec<(usize, Part<'_>)> =
        assembly.members().filter_map(|(key, part)| Some((key.parse().ok()?, part))).collect();
    numbered.sort_by_key(|(number, _)| *number);
    if let Some((expected, (number, part))) = (0..).zip(&numbered).find(|(i, (number, _))| i != number) {
        return Err(part.error(format!("surface {number} where surface {expected} is expected")));
    }
    Ok(numbered.into_iter().map(|(_, part)| part).collect())
}

/// Reads one surface of the lens.
fn surface(
    part: Part<'_>,
    number: &str,
    is_stop: bool,
    glasses: &mut NamedGlasses<'_>,
    ledger: &mut Ledger<'_>,
) -> Result<SequentialSurface, LensFileError> {
    let asphere = match part.string("Type")?.unwrap_or("SPH") {
        "SPH" => None,
        "ASP" => figure(part, number)?,
        other => {
            let what = format!("is of type {}; read are SPH and ASP", cut(other));
            return Err(refused(part.need("Type", "SPH")?, number, what));
        }
    };
    let clip = clear_aperture(part, number)?;
    Ok(SequentialSurface {
        curvature: part.number("Curvature")?.unwrap_or(0.0),
        asphere,
        behind: medium(part, number, glasses, ledger)?,
        semi_diameter: clip,
        listed: None,
        clip,
        is_fixed: clip.is_some(),
        apertures: Vec::new(),
        is_stop,
        general: Default::default(),
        break_behind: None,
    })
}

/// Returns the figure of an asphere.
fn figure(part: Part<'_>, number: &str) -> Result<Option<Asphere>, LensFileError> {
    let mut terms = NO_TERMS;
    for (i, &value) in part.numbers("Coefs")?.iter().enumerate() {
        set_term(&mut terms, 4 + 2 * i, value).map_err(|why| refused(part, number, why))?;
    }
    Ok(asphere(part.number("Conic")?.unwrap_or(0.0), terms))
}

/// Returns the semi-diameter of a surface's aperture.
fn clear_aperture(part: Part<'_>, number: &str) -> Result<Option<f64>, LensFileError> {
    let Some(own) = part.get("Aperture") else { return Ok(None) };
    match own.string("Type")?.unwrap_or("None") {
        "None" => Ok(None),
        "Circular" => {
            let radius = own.needed_number("Radius", "a semi-diameter")?;
            if radius > 0.0 {
                return Ok(Some(radius));
            }
            Err(own.error(format!("\"Radius\" is {}; expected a positive number", as_given(radius))))
        }
        other => Err(refused(own, number, format!("has an aperture {}; read is Circular", cut(other)))),
    }
}

/// Returns the medium behind a surface.
fn medium(
    part: Part<'_>,
    number: &str,
    glasses: &mut NamedGlasses<'_>,
    ledger: &mut Ledger<'_>,
) -> Result<MediumBehind, LensFileError> {
    let name = part.string("Material")?.unwrap_or("");
    if name.is_empty() || name.eq_ignore_ascii_case("AIR") {
        return Ok(Medium::Air.into());
    }
    let own = part.need("Material", "a name")?;
    if name.eq_ignore_ascii_case("MIRROR") {
        return Err(refused(
            own,
            number,
            "is a mirror, of which the sign of the thickness behind it is not known in this format",
        ));
    }
    if let Some(Medium::Glass { n_d, abbe }) = by_pair(name) {
        return super::by_numbers(name, n_d, abbe, glasses).map_err(|why| own.error(why));
    }
    let (medium, remark) = glasses.of_maker(name).map_err(|why| own.error(why))?;
    if let Some(reason) = remark {
        ledger.warn(Fate::Replaced, own.node.location, "Material", Some(number), reason);
    }
    Ok(medium)
}

/// Returns the aperture that limits the beam.
fn aperture(specification: Part<'_>, object: f64) -> Result<Aperture, LensFileError> {
    let pupil = specification.need("Pupil", "an aperture")?;
    let value = pupil.needed_number("Value", "a positive number")?;
    let kind = pupil.needed_number("Type", "0 to 3")?;
    match kind as i64 {
        _ if !(value > 0.0 && (kind < 2.0 || value < 1.0)) => {
            Err(pupil.error(format!("an aperture of {}; expected a positive number", as_given(value))))
        }
        0 => Ok(Aperture::EntrancePupil(value)),
        1 if object.abs() >= 1e10 => Ok(Aperture::FNumber(value)),
        1 => Ok(Aperture::WorkingFNumber(value)),
        2 => Ok(Aperture::ObjectNa(value)),
        3 => Ok(Aperture::image_na(value)),
        _ => Err(pupil.error(format!("an aperture of type {}; expected 0 to 3", as_given(kind)))),
    }
}

/// Returns the farthest field.
fn field(specification: Part<'_>) -> Result<Option<Field>, LensFileError> {
    let Some(own) = specification.get("Field") else { return Ok(None) };
    let [x, y] = [own.numbers("X")?, own.numbers("Y")?];
    let value = |all: &[f64], i: usize| all.get(i).copied().unwrap_or(0.0);
    let farthest = (0..x.len().max(y.len())).map(|i| value(&x, i).hypot(value(&y, i))).fold(0.0, f64::max);
    match own.number("Type")?.unwrap_or(0.0) as i64 {
        0 => Ok(Some(Field::Angle(farthest))),
        1 => Ok(Some(Field::ObjectHeight(farthest))),
        2 => Ok(Some(Field::ImageHeight(farthest))),
        other => Err(own.error(format!("fields of type {other}; expected 0 to 2"))),
    }
}

/// Returns the reference wavelength, nm, and its place.
fn wavelength(specification: Part<'_>) -> Result<Option<(f64, Location)>, LensFileError> {
    let Some(own) = specification.get("Wvl") else { return Ok(None) };
    let all = own.numbers("Value")?;
    let number = own.number("RefIndex")?.unwrap_or(0.0);
    let Some(&value) = all.get(number as usize).filter(|_| number >= 0.0) else { return Ok(None) };
    let place = own.need("Value", "wavelengths, nm")?;
    Ok(Some((nanometres(value / 1e3).map_err(|why| place.error(why))?, place.node.location)))
}

#[cfg(test)]
mod tests {
    use crate::prescription::{
        glass::{D_LINE, refractive_index},
        interfaces::{Medium, Shape},
        reader::checks::{ok, refused},
    };

    const LENS: &str = r#"{"Assembly": {
  "0": {"Type": "SPH", "Curvature": 0.0, "Thickness": 1e10, "Material": "AIR", "Label": "Obj"},
  "1": {"Type": "ASP", "Curvature": 0.05, "Thickness": 4.0, "Material": "N-BK7_SCHOTT", "Coefs": [0.0, 1e-7], "Conic": -0.5},
  "10": {"Type": "SPH", "Curvature": 0.0, "Thickness": 0.0, "Material": "AIR"},
  "2": {"Type": "SPH", "Curvature": -0.05, "Thickness": 1.0, "Material": "AIR", "Aperture": {"Type": "Circular", "Radius": 5.0}},
  "3": {"Type": "SPH", "Curvature": 0.0, "Thickness": 1.0, "Material": "AIR"},
  "4": {"Type": "SPH", "Curvature": -0.02, "Thickness": 1.0, "Material": "1.620000:60.300000"},
  "5": {"Type": "SPH", "Curvature": 0.0, "Thickness": 1.0, "Material": "AIR"},
  "6": {"Type": "SPH", "Curvature": 0.0, "Thickness": 1.0, "Material": "517642"},
  "7": {"Type": "SPH", "Curvature": 0.0, "Thickness": 1.0, "Material": "AIR", "Aperture": {"Type": "None"}},
  "8": {"Type": "SPH", "Curvature": 0.0, "Thickness": 1.0, "Material": "AIR"},
  "9": {"Type": "SPH", "Curvature": 0.0, "Thickness": 20.0, "Material": "AIR"},
  "Stop": 3},
 "Spec": {"Pupil": {"Type": 1, "Value": 4.0}, "Field": {"Type": 0, "X": [0.0, 3.0], "Y": [0.0, 4.0], "Weight": [1, 1]},
  "Wvl": {"RefIndex": 1, "Value": [656.273, 587.562, 486.133]}}, "Title": "Made up", "Note": "", "Unheard": 1}
"#;

    fn with(from: &str, to: &str) -> String {
        assert!(LENS.contains(from), "{from}");
        LENS.replacen(from, to, 1)
    }

    #[test]
    fn surfaces_are_read_in_the_order_of_their_numbers() {
        let lens = ok(LENS);
        assert_eq!((lens.title.as_deref(), lens.interfaces.len()), (Some("Made up"), 7));
        let Shape::Asphere(first) = lens.interfaces[0].shape else { panic!("{lens:?}") };
        assert_eq!((first.radius, first.conic, first.term(6)), (20.0, -0.5, 1e-7));
        assert!((refractive_index(lens.interfaces[0].medium, D_LINE) - 1.5168).abs() < 1e-5);
        assert_eq!((lens.interfaces[1].semi_diameter, lens.stop_in_air()), (5.0, Some(2)));
        assert_eq!(lens.interfaces[3].medium, Medium::Glass { n_d: 1.62, abbe: Some(60.3) });
        assert_eq!((lens.nominal_film_distance, lens.wavelength), (Some(22.0), Some(587.562)));
        assert_eq!((lens.stated.fnumber, lens.stated.fields), (Some(4.0), vec![Some(10.0)]));
        let unknown = lens.findings.iter().find(|finding| finding.statement == "Unheard");
        assert!(
            unknown.is_some_and(|finding| finding.reason.contains("does not know")),
            "{:?}",
            lens.findings
        );
        let other = ok(&with("N-BK7_SCHOTT", "N-BK7_NOBODY"));
        assert!(other.remarks[0].contains("no glass N-BK7 of NOBODY is known"), "{:?}", other.remarks);
        let stop = |pupil: &str| ok(&with("\"Type\": 1, \"Value\": 4.0", pupil)).interfaces[2].semi_diameter;
        let [half, by_na] = ["\"Type\": 1, \"Value\": 8", "\"Type\": 3, \"Value\": 0.0625"].map(stop);
        assert!((lens.interfaces[2].semi_diameter / half - 2.0).abs() < 1e-12);
        assert!((by_na / half - 1.0 / (1.0_f64 - 0.0625 * 0.0625).sqrt()).abs() < 1e-9);
    }

    #[test]
    fn what_is_wrong_or_not_traced_is_refused_with_the_location() {
        refused("{\"Assembly\": {}}", "1:2", &["0 surface(s)"]);
        refused(&with("\"8\":", "\"18\":"), "12:3", &["surface 9 where surface 8 is expected"]);
        refused(&with("\"Type\": \"ASP\"", "\"Type\": \"ODD\""), "3:9", &["surface 1 is of type ODD"]);
        refused(&with("N-BK7_SCHOTT", "MIRROR"), "3:61", &["surface 1 is a mirror"]);
        refused(&with("N-BK7_SCHOTT", "XQ7"), "3:61", &["glass \"XQ7\" is not known"]);
        refused(&with("\"Circular\"", "\"Rectangular\""), "5:81", &["has an aperture Rectangular"]);
        refused(&with("\"Radius\": 5.0", "\"Radius\": 0"), "5:81", &["\"Radius\" is 0"]);
        refused(&with("\"Type\": 1, \"Value\": 4.0", "\"Type\": 7, \"Value\": 0.5"), "14:11", &["of type 7"]);
        refused(
            &with("\"Type\": 1, \"Value\": 4.0", "\"Type\": 0, \"Value\": 0"),
            "14:11",
            &["an aperture of 0"],
        );
    }
}
