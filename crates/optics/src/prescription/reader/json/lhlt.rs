//! LensHH (`.lhlt`), the format of the largest open collection of stock lenses. Its writer leaves out values that are
//! defaults: a Standard surface, radius Infinity, thickness 0, an entrance pupil (EPD), fields as
//! angles (ObjectAngle). Sizes are semi-diameters in mm. The object is the first surface and the image the last.
//!
//! `SemiDiameter` is the edge of the glass as it is drawn. `ClearAperturePercent` is that semi-diameter relative to the
//! clear one: in the stock lenses 12.7 mm at 111.1 % has the clear semi-diameter 11.43 mm, half of the stated pupil.
//!
//! The format has no cylinders, and the collection has cylindrical lenses as surfaces of revolution. Their titles tell, and
//! they are refused.

use super::{
    NamedGlasses, Part, by_name, by_numbers, check_image, curvature, fates::NoEffect, finished,
    object_own_image, place, refused, title,
};
use crate::prescription::{
    Aperture as Outline, Fate, LensFileError, Outline as Figure,
    glass::{GlassLibrary, by_fractions, loose},
    interfaces::{Medium, NO_TERMS, Prescription},
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
    ("names and notes", &["FormatVersion", "Notes", "Designer", "Comment", "Surfaces.Index"]),
    (
        "settings of the file's program, of its optimiser and of its displays",
        &[
            "RayAiming",
            "PenalizeVignetting",
            "GlassSubstitutions",
            "MeritFunction",
            "CurvatureVariable",
            "ThicknessVariable",
            "ConicVariable",
            "AsphericVariable",
            "CurvatureMin",
            "CurvatureMax",
            "ThicknessMin",
            "ThicknessMax",
            "ConicMin",
            "ConicMax",
            "AsphericMin",
            "AsphericMax",
        ],
    ),
    ("solves and pickups, whose values the file holds", &["Pickups", "HasMarginalRaySolve"]),
    ("the lens has one configuration, which the surfaces hold", &["ConfigurationEditor"]),
    (
        "fields, wavelengths and their weights, which the user chooses",
        &["Fields", "Wavelengths", "Wavelengths.Value", "Weight"],
    ),
    (
        "describes the object or the image, which are the user's",
        &[
            "Surfaces.Type",
            "Surfaces.SemiDiameter",
            "Surfaces.SemiDiameterMode",
            "Surfaces.ClearAperturePercent",
            "Surfaces.Conic",
            "Surfaces.IsStop",
            "Surfaces.InnerRadius",
            "Surfaces.ObscurationRadius",
            "Surfaces.FloatingApertureRadius",
            "Surfaces.AsphericCoefficients",
            "Surfaces.Radius",
            "Surfaces.Thickness",
            "Surfaces.Material",
        ],
    ),
    ("bounds of the fields for the optimiser", &["Fields.Variable", "Fields.Min", "Fields.Max"]),
];

/// Thicknesses of this magnitude mean infinity.
const ENDLESS: f64 = 1e18;

/// Reads a lens.
///
/// # Errors
/// A value is missing or wrong, or the lens cannot be traced.
pub(super) fn read(
    root: Part<'_>,
    library: &GlassLibrary,
    ledger: &mut Ledger<'_>,
) -> Result<Prescription, LensFileError> {
    if root.number("FormatVersion")? != Some(1.0) {
        let version = root.need("FormatVersion", "1")?;
        return Err(version.error(format!("version {} of LensHH's format; read is 1", version.node.shown())));
    }
    check_configurations(root)?;
    let list = root.list("Surfaces")?;
    let (object, own, image) = object_own_image(&list, root.need("Surfaces", "a list of surfaces")?)?;
    let catalogues = root.list("GlassCatalogs")?;
    let catalogues = catalogues.iter().filter_map(|name| name.node.string()).map(loose).collect();
    let mut glasses = NamedGlasses::new(library, catalogues);
    let object_medium = checked(medium(object, "0", &mut glasses)?, |reason| {
        ledger.warn(Fate::Replaced, object.node.location, "Material", Some("0"), reason);
    });
    let mut surfaces = Vec::with_capacity(own.len());
    let mut thicknesses = Vec::with_capacity(own.len());
    let mut places = Vec::with_capacity(own.len());
    for (number, &part) in (1..).zip(own) {
        let number: String = format!("{number}");
        let place = place(part, number, Some("SemiDiameter"), Some("Thickness"));
        surfaces.push(surface(part, &place.number, &mut glasses, ledger)?);
        thicknesses.push(thickness(part, &place.number)?);
        places.push(place);
    }
    check_image(curvature(image.number_or_infinity("Radius")?.unwrap_or(0.0)), image, "Radius", ledger);
    if root.flag("IsAfocal")? {
        let location = root.need("IsAfocal", "true or false")?.node.location;
        let reason = "the file's program takes the lens for afocal, without an image of its own; the distance of its image is \
                      taken as it is written";
        ledger.warn(Fate::LeftOut, location, "IsAfocal", None, reason);
    }
    let object_distance = object.number_or_infinity("Thickness")?.unwrap_or(0.0);
    let lens = SequentialLens {
        object: object_medium,
        object_place: object.node.location,
        object_distance: if object_distance.abs() >= ENDLESS { f64::INFINITY } else { object_distance },
        surfaces,
        thicknesses,
        image_break: None,
        places,
        aperture: aperture(root)?,
        field: field(root, ledger)?,
        wavelength: wavelength(root)?,
        keys: ["Surfaces", "SemiDiameter", "Thickness"],
        unit: 1.0,
    };
    let (lens, _) = lens.prescription(root.text, root.node.location, ledger)?;
    let title = title(root.string("Title")?);
    let is_cylinder = |word: &str| word == "cyl" || word.starts_with("cylind");
    let lower = title.as_ref().map(|title| title.to_ascii_lowercase()).unwrap_or_default();
    if lower.split(|c: char| !c.is_ascii_alphabetic()).any(is_cylinder) {
        let message = "the title calls the lens cylindrical, and the format has no cylinders: the round surfaces that the file \
                       states are not those of the lens; take it from its maker's Zemax file, or change the title to trace them";
        return Err(root.need("Title", "a title")?.error(message));
    }
    Ok(finished(Prescription { title, ..lens }, glasses, root.text.file))
}

/// Checks that the file has one configuration.
fn check_configurations(root: Part<'_>) -> Result<(), LensFileError> {
    let Some(editor) = root.get("ConfigurationEditor") else { return Ok(()) };
    let count = editor.list("Configurations")?.len();
    if count > 1 && !editor.list("Operands")?.is_empty() {
        let message = format!(
            "{count} configurations, and their operands are not read; keep one of them in LensHH and save the lens"
        );
        return Err(editor.error(message));
    }
    Ok(())
}

/// Reads one surface of the lens.
fn surface(
    part: Part<'_>,
    number: &str,
    glasses: &mut NamedGlasses<'_>,
    ledger: &mut Ledger<'_>,
) -> Result<SequentialSurface, LensFileError> {
    let kind = part.string("Type")?.unwrap_or("Standard");
    if !matches!(kind, "Standard" | "EvenAsphere") {
        let what = format!("is of type {}, which is not read; read are Standard and EvenAsphere", cut(kind));
        return Err(refused(part.need("Type", "a type")?, number, what));
    }
    let coefficients = part.numbers("AsphericCoefficients")?;
    let mut terms = NO_TERMS;
    if kind == "EvenAsphere" {
        for (i, &value) in coefficients.iter().enumerate() {
            let error = |why: String| refused(part, number, why);
            set_term(&mut terms, 2 * (i + 1), value).map_err(error)?;
        }
    } else if coefficients.iter().any(|value| *value != 0.0) {
        let location = part.need("AsphericCoefficients", "a list")?.node.location;
        let reason = "aspheric coefficients of a Standard surface, which has none";
        ledger.warn(Fate::LeftOut, location, "AsphericCoefficients", Some(number), reason);
    }
    let conic = part.number("Conic")?.unwrap_or(0.0);
    let size = size(part, number, ledger)?;
    Ok(SequentialSurface {
        curvature: curvature(part.number_or_infinity("Radius")?.unwrap_or(f64::INFINITY)),
        asphere: asphere(conic, terms),
        behind: medium(part, number, glasses)?,
        semi_diameter: size.clip.or(size.listed),
        listed: size.listed,
        clip: size.clip,
        apertures: size.apertures,
        is_fixed: size.is_fixed,
        is_stop: part.flag("IsStop")?,
        general: Default::default(),
        break_behind: None,
    })
}

/// The size of a surface.
struct Size {
    listed: Option<f64>,
    clip: Option<f64>,
    apertures: Vec<Outline>,
    is_fixed: bool,
}

/// Reads the size of a surface.
fn size(part: Part<'_>, number: &str, ledger: &mut Ledger<'_>) -> Result<Size, LensFileError> {
    let positive = |key: &str| -> Result<Option<f64>, LensFileError> {
        Ok(part.number(key)?.filter(|value| *value != 0.0))
    };
    let drawn = positive("SemiDiameter")?;
    let percent = positive("ClearAperturePercent")?.unwrap_or(100.0);
    if percent <= 0.0 {
        let what = part.need("ClearAperturePercent", "a number")?;
        return Err(what.error(format!(
            "\"ClearAperturePercent\" is {}; expected a positive number",
            as_given(percent)
        )));
    }
    if percent != 100.0 && drawn.is_some() {
        let location = part.need("ClearAperturePercent", "a number")?.node.location;
        let reason =
            "the semi-diameter is that of the edge, in percent of the clear one; the clear one is used";
        ledger.note(Fate::Replaced, location, "ClearAperturePercent", Some(number), reason);
    }
    if let Some(inner) = positive("InnerRadius")? {
        let what = format!(
            "has an InnerRadius of {}: a hole or a ring, of which the file does not say which; write 0 to trace the \
             surface without it",
            as_given(inner)
        );
        return Err(refused(part.need("InnerRadius", "a number")?, number, what));
    }
    let obstruction = positive("ObscurationRadius")?;
    let floating = positive("FloatingApertureRadius")?;
    for (key, value) in [("ObscurationRadius", obstruction), ("FloatingApertureRadius", floating)] {
        if value.is_some_and(|value| value < 0.0) {
            return Err(part
                .need(key, "a number")?
                .error(format!("\"{key}\" is negative; expected 0 or more")));
        }
    }
    let mode = part.string("SemiDiameterMode")?.unwrap_or("Auto");
    let is_fixed = match mode {
        "Fixed" => true,
        "Auto" => false,
        other => {
            let what = format!("has the SemiDiameterMode {}; read are Auto and Fixed", cut(other));
            return Err(refused(part.need("SemiDiameterMode", "Auto")?, number, what));
        }
    };
    let listed = drawn.map(|drawn| drawn / (percent / 100.0));
    // The floating aperture is as wide as the drawn edge, or narrower than the clear aperture.
    let clip = floating.map(|floating| listed.map_or(floating, |listed| floating.min(listed)));
    let obstruction = obstruction
        .map(|radius| Outline { is_obstruction: true, ..Outline::centered(Figure::Ellipse([radius; 2])) });
    let is_fixed = is_fixed || clip.is_some() || obstruction.is_some();
    Ok(Size { listed, clip, apertures: obstruction.into_iter().collect(), is_fixed })
}

/// Returns the medium behind a surface: a glass's name, a code such as `620.6030` (n_d 1.620, V 60.30), or air.
fn medium(
    part: Part<'_>,
    number: &str,
    glasses: &mut NamedGlasses<'_>,
) -> Result<MediumBehind, LensFileError> {
    let name = part.string("Material")?.unwrap_or("").trim();
    if name.is_empty() {
        return Ok(Medium::Air.into());
    }
    let material = part.need("Material", "a name")?;
    if name.eq_ignore_ascii_case("MIRROR") {
        return Err(refused(
            material,
            number,
            "is a mirror, of which the sign of the thickness behind it is not known in this format",
        ));
    }
    match by_fractions(name).filter(|_| name.len() == 8 && name.as_bytes()[3] == b'.') {
        Some(Medium::Glass { n_d, abbe }) => {
            by_numbers(name, n_d, abbe, glasses).map_err(|why| material.error(why))
        }
        _ => by_name(material, name, glasses),
    }
}

/// Returns the thickness behind a surface of the lens.
fn thickness(part: Part<'_>, number: &str) -> Result<f64, LensFileError> {
    match part.number_or_infinity("Thickness")? {
        Some(thickness) if thickness.abs() >= ENDLESS => Err(refused(
            part.need("Thickness", "a number")?,
            number,
            "has a thickness without end; a lens's surfaces stand at finite distances",
        )),
        thickness => Ok(thickness.unwrap_or(0.0)),
    }
}

/// Returns the aperture that limits the beam.
fn aperture(root: Part<'_>) -> Result<Aperture, LensFileError> {
    let Some(aperture) = root.get("Aperture") else { return Ok(Aperture::ByStop) };
    let value = aperture.number("Value")?.unwrap_or(0.0);
    if value < 0.0 {
        return Err(aperture.error(format!("an aperture of {}; expected a positive number", as_given(value))));
    }
    match aperture.string("Type")?.unwrap_or("EPD") {
        _ if value == 0.0 => Ok(Aperture::ByStop),
        "EPD" => Ok(Aperture::EntrancePupil(value)),
        "FNumber" => Ok(Aperture::FNumber(value)),
        other => Err(aperture.error(format!("an aperture of type {}; read are EPD and FNumber", cut(other)))),
    }
}

/// Returns the farthest field.
fn field(root: Part<'_>, ledger: &mut Ledger<'_>) -> Result<Option<Field>, LensFileError> {
    let mut farthest: f64 = 0.0;
    for field in root.list("Fields")? {
        farthest = farthest.max(field.number("Y")?.unwrap_or(0.0).abs());
    }
    match root.string("FieldType")?.unwrap_or("ObjectAngle") {
        "ObjectAngle" => Ok(Some(Field::Angle(farthest))),
        "ObjectHeight" => Ok(Some(Field::ObjectHeight(farthest))),
        other => {
            let location = root.need("FieldType", "a type")?.node.location;
            let reason = format!("fields of type {}, which is not read", cut(other));
            ledger.warn(Fate::LeftOut, location, "FieldType", None, reason);
            Ok(None)
        }
    }
}

/// Returns the primary wavelength, nm, and its place.
fn wavelength(root: Part<'_>) -> Result<Option<(f64, Location)>, LensFileError> {
    for wavelength in root.list("Wavelengths")? {
        if wavelength.flag("IsPrimary")? {
            let value = wavelength.needed_number("Value", "a wavelength, µm")?;
            let own = wavelength.need("Value", "a wavelength, µm")?;
            return Ok(Some((nanometres(value).map_err(|why| own.error(why))?, own.node.location)));
        }
    }
    Ok(None)
}
