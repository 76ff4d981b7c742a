//! ISET (`isetlens`, and pbrt's cameras that read its files): a list `surfaces`, scene side first, each with `radius` (0: a
//! plane), `thickness`, `semi_aperture` and `ior`, the medium behind it: an index, a name, or a list of wavelengths, nm,
//! and a list of indices. A plane with the index 0 is the stop.

use super::{
    NamedGlasses, Part, REVOLUTION, by_name, by_numbers, check_count, curvature, fates::NoEffect, finished,
    place, refused, title,
};
use crate::prescription::{
    Fate, LensFileError,
    glass::{GlassLibrary, tabulated},
    interfaces::{NO_TERMS, Prescription},
    reader::{
        ledger::Ledger,
        sequential::{SequentialLens, SequentialSurface, asphere},
        surface_rows::MediumBehind,
    },
};
use realistic_base::message::as_given;

/// Keys without an effect on rays.
pub(super) const NO_EFFECT: NoEffect = &[("names and notes", &["description", "type"])];

/// Returns whether a file is a lens of this format.
pub(super) fn is_lens(root: &super::Node) -> bool {
    root.get("surfaces").is_some_and(|list| list.elements().first().is_some_and(|own| own.has("ior")))
}

/// Reads a lens.
///
/// # Errors
/// A value is missing or wrong, or the lens cannot be traced.
pub(super) fn read(
    root: Part<'_>,
    library: &GlassLibrary,
    ledger: &mut Ledger<'_>,
) -> Result<Prescription, LensFileError> {
    if let Some(lenses) = root.get("microlens") {
        let reason = "an array of small lenses on the film, which is not traced; the lens is read without it";
        ledger.warn(Fate::LeftOut, lenses.node.location, "microlens", None, reason);
    }
    let list = root.list("surfaces")?;
    check_count(&list)?;
    let mut glasses = NamedGlasses::new(library, Vec::new());
    let mut surfaces = Vec::with_capacity(list.len());
    let mut thicknesses = Vec::with_capacity(list.len());
    let mut places = Vec::with_capacity(list.len());
    for (number, &part) in (1..).zip(&list) {
        let number: String = format!("{number}");
        surfaces.push(surface(part, &number, &mut glasses)?);
        thicknesses.push(part.needed_number("thickness", "the distance to the next surface")?);
        places.push(place(part, number, Some("semi_aperture"), Some("thickness")));
    }
    let location = root.node.location;
    let keys = ["surfaces", "semi_aperture", "thickness"];
    let lens = SequentialLens::in_air(location, surfaces, thicknesses, places, keys);
    let (lens, _) = lens.prescription(root.text, location, ledger)?;
    let title = title(root.string("name")?);
    Ok(finished(Prescription { title, ..lens }, glasses, root.text.file))
}

/// Reads one surface.
fn surface(
    part: Part<'_>,
    number: &str,
    glasses: &mut NamedGlasses<'_>,
) -> Result<SequentialSurface, LensFileError> {
    check_axis(part, number)?;
    let radius = of_both_axes(part, number, "radius")?.unwrap_or(0.0);
    let conic = of_both_axes(part, number, "conic_constant")?.unwrap_or(0.0);
    let ior = part.need("ior", "the medium behind the surface")?;
    let size = of_both_axes(part, number, "semi_aperture")?;
    let Some(size) = size.filter(|size| *size > 0.0) else {
        return Err(part
            .need("semi_aperture", "a semi-diameter")?
            .error("expected a positive semi-diameter"));
    };
    Ok(SequentialSurface {
        curvature: curvature(radius),
        asphere: asphere(conic, NO_TERMS),
        behind: medium(ior, glasses)?,
        semi_diameter: Some(size),
        listed: Some(size),
        clip: None,
        apertures: Vec::new(),
        is_fixed: true,
        is_stop: radius == 0.0 && ior.node.number() == Some(0.0),
        general: Default::default(),
        break_behind: None,
    })
}

/// Checks that the surface stands where its thicknesses put it: its transform is the identity.
fn check_axis(part: Part<'_>, number: &str) -> Result<(), LensFileError> {
    for (row, own) in part.list("transform")?.into_iter().enumerate() {
        for (column, value) in own.node.elements().iter().enumerate() {
            if value.number() != Some(if row == column { 1.0 } else { 0.0 }) {
                return Err(refused(
                    own,
                    number,
                    format!("has a tilt or decentring (transform); {REVOLUTION}"),
                ));
            }
        }
    }
    Ok(())
}

/// Returns a number that the file may state for each axis.
fn of_both_axes(part: Part<'_>, number: &str, key: &str) -> Result<Option<f64>, LensFileError> {
    let Some(own) = part.get(key).filter(|own| own.node.is_list()) else { return part.number(key) };
    let numbers = part.numbers(key)?;
    match numbers[..] {
        [x, y] if x == y => Ok(Some(x)),
        [x, y] => {
            let what = format!("has {key} {} and {} on its axes; {REVOLUTION}", as_given(x), as_given(y));
            Err(refused(own, number, what))
        }
        _ => Err(
            own.error(format!("\"{key}\" has {} numbers; expected one, or one for each axis", numbers.len()))
        ),
    }
}

/// Returns the medium behind a surface.
fn medium(part: Part<'_>, glasses: &mut NamedGlasses<'_>) -> Result<MediumBehind, LensFileError> {
    if let Some(name) = part.node.string() {
        return by_name(part, name, glasses);
    }
    if !part.node.is_list() {
        return by_numbers("", part.finite("ior")?, None, glasses).map_err(|why| part.error(why));
    }
    let [wavelengths, indices] = part.node.elements() else {
        return Err(part.error("\"ior\" is a list; expected the wavelengths, nm, and the indices"));
    };
    let numbers =
        |node: &super::Node| node.elements().iter().map(super::Node::number).collect::<Option<Vec<f64>>>();
    let (Some(wavelengths), Some(indices)) = (numbers(wavelengths), numbers(indices)) else {
        return Err(
            part.error("\"ior\" has something that is no number; expected wavelengths, nm, and indices")
        );
    };
    if wavelengths.len() != indices.len() {
        let message =
            format!("{} indices at {} wavelengths; expected one at each", indices.len(), wavelengths.len());
        return Err(part.error(message));
    }
    // The same index at every wavelength is that of a medium without dispersion.
    if let Some(first) = indices.first().filter(|first| indices.iter().all(|index| index == *first)) {
        return by_numbers("", *first, None, glasses).map_err(|why| part.error(why));
    }
    let points: Vec<[f64; 2]> = wavelengths.iter().zip(&indices).map(|(w, n)| [*w, *n]).collect();
    let (glass, _) = tabulated(&points).map_err(|why| part.error(why))?;
    Ok(glass.medium.into())
}

#[cfg(test)]
mod tests {
    use crate::prescription::{
        glass::refractive_index,
        interfaces::{Medium, Shape},
        reader::checks::{ok, refused},
    };

    const LENS: &str = r#"{"name": "Made up", "description": "a lens", "type": "multi element lens", "surfaces": [
 {"radius": 20, "thickness": 4, "ior": [[400, 500, 600, 700], [1.53, 1.52, 1.515, 1.512]], "semi_aperture": 5,
  "conic_constant": -0.5, "transform": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]},
 {"radius": [-20, -20], "thickness": 1, "ior": 1, "semi_aperture": 5},
 {"radius": 0, "thickness": 1, "ior": 0, "semi_aperture": 3},
 {"radius": 0, "thickness": 2, "ior": "N-BK7", "semi_aperture": 4},
 {"radius": -30, "thickness": 0, "ior": [[400, 700], [1, 1]], "semi_aperture": 4}]}
"#;

    fn with(from: &str, to: &str) -> String {
        assert!(LENS.contains(from), "{from}");
        LENS.replacen(from, to, 1)
    }

    #[test]
    fn surfaces_are_read() {
        let lens = ok(LENS);
        assert_eq!((lens.title.as_deref(), lens.interfaces.len()), (Some("Made up"), 5));
        let [first, second, stop, third, last] = lens.interfaces.as_slice() else { panic!("{lens:?}") };
        let Shape::Asphere(conic) = first.shape else { panic!("{first:?}") };
        assert_eq!((conic.radius, conic.conic, first.semi_diameter), (20.0, -0.5, 5.0));
        assert!((refractive_index(first.medium, 500.0) - 1.52).abs() < 1e-9);
        assert_eq!((second.shape, second.medium), (Shape::Sphere { radius: -20.0 }, Medium::Air));
        assert!(stop.is_stop && stop.semi_diameter == 3.0);
        assert!(matches!(third.medium, Medium::Sellmeier { .. }));
        assert_eq!((last.medium, lens.nominal_film_distance, lens.remarks), (Medium::Air, None, vec![]));
    }

    #[test]
    fn what_is_wrong_or_not_traced_is_refused_with_the_location() {
        refused(&with("[-20, -20]", "[-20, -30]"), "4:3", &["surface 2 has radius -20 and -30 on its axes"]);
        refused(&with("[0, 0, 0, 1]", "[0, 0, 2, 1]"), "3:83", &["surface 1 has a tilt or decentring"]);
        refused(&with("\"semi_aperture\": 3", "\"semi_aperture\": 0"), "5:42", &["a positive semi-diameter"]);
        refused(&with("\"ior\": 0", "\"ior\": 0.5"), "5:32", &["a refractive index is 1 or more"]);
        refused(&with("\"N-BK7\"", "\"XQ7\""), "6:32", &["glass \"XQ7\" is not known"]);
        refused(&with("[1.53, 1.52, 1.515, 1.512]", "[1.53, 1.52]"), "2:33", &["2 indices at 4 wavelengths"]);
        refused(
            &with("[400, 500, 600, 700], ", ""),
            "2:33",
            &["\"ior\" is a list; expected the wavelengths"],
        );
        refused(&with("\"thickness\": 4, ", ""), "2:2", &["no \"thickness\" here"]);
        let lenses = ok(&with("\"type\": ", "\"microlens\": {}, \"type\": "));
        assert!(lenses.remarks[0].contains("an array of small lenses"), "{:?}", lenses.remarks);
    }
}
