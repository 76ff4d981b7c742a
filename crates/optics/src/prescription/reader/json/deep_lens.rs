//! DeepLens: `surfaces`, scene side first. Each has its type, its semi-diameter `r`, its radius `roc` or curvature `c`,
//! the material behind it (`mat2`: air, a glass's name, or `n_d/V`) and the distance to the next surface (`d_next`),
//! the last one to the sensor. The terms `ai` begin with r^2. A key in parentheses is a comment. Lengths are in mm.

use super::{
    NamedGlasses, Part, REVOLUTION, by_name, by_numbers, check_count, curvature, document::Node,
    fates::NoEffect, finished, place, refused, title,
};
use crate::prescription::{
    Fate, LensFileError,
    glass::GlassLibrary,
    interfaces::{Asphere, Medium, NO_TERMS, Prescription, Stated},
    reader::{
        ledger::Ledger,
        sequential::{SequentialLens, SequentialSurface, asphere, set_term},
        surface_rows::MediumBehind,
    },
};
use realistic_base::message::{as_given, cut};

/// Keys without an effect on rays.
pub(super) const NO_EFFECT: NoEffect = &[
    ("names, numbers and notes", &["idx", "surf_idx"]),
    ("settings of the file's program", &["device", "float_enpd", "float_foclen", "diffraction"]),
    (
        "the size and resolution of the sensor, which are the user's",
        &["r_sensor", "r_last", "sensor_size", "sensor_res"],
    ),
    ("follows from the distances of the surfaces", &["d", "d_sensor"]),
    ("the medium in front of a surface is that behind the surface before", &["mat1"]),
    ("follows from the surfaces and their stop", &["enpd", "hfov", "rfov"]),
    (
        "a term that the list of coefficients replaces",
        &["ai2", "ai4", "ai6", "ai8", "ai10", "ai12", "ai14", "ai16", "ai18", "ai20"],
    ),
    ("the curvature, which the radius replaces", &["c"]),
    ("describes the stop, which is a plane", &["roc"]),
];

/// Returns whether a file is a lens of this format.
pub(super) fn is_lens(root: &Node) -> bool {
    let has = |own: &Node| own.has("d_next") || own.has("mat2");
    root.get("surfaces").is_some_and(|list| list.elements().iter().any(has))
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
    if let Some(element) = root.get("DOE") {
        return Err(element.error("a diffractive element (DOE), which is not traced"));
    }
    let list = root.list("surfaces")?;
    check_count(&list)?;
    let mut glasses = NamedGlasses::new(library, Vec::new());
    let mut surfaces = Vec::with_capacity(list.len());
    let mut thicknesses = Vec::with_capacity(list.len());
    let mut places = Vec::with_capacity(list.len());
    for (number, &part) in (1..).zip(&list) {
        let number: String = format!("{number}");
        surfaces.push(surface(part, &number, &mut glasses, ledger)?);
        thicknesses.push(part.needed_number("d_next", "the distance to the next surface")?);
        places.push(place(part, number, Some("r"), Some("d_next")));
    }
    let location = root.node.location;
    let keys = ["surfaces", "r", "d_next"];
    let lens = SequentialLens::in_air(location, surfaces, thicknesses, places, keys);
    let (lens, _) = lens.prescription(root.text, location, ledger)?;
    let positive = |key: &str| -> Result<Option<f64>, LensFileError> {
        Ok(root.number(key)?.filter(|value| *value > 0.0))
    };
    let title = title(root.string("info")?.filter(|info| *info != "None"));
    let stated = Stated { fnumber: positive("fnum")?, ..lens.stated };
    let lens = Prescription { title, stated, stated_focal_length: positive("foclen")?, ..lens };
    Ok(finished(lens, glasses, root.text.file))
}

/// Reads one surface.
fn surface(
    part: Part<'_>,
    number: &str,
    glasses: &mut NamedGlasses<'_>,
    ledger: &mut Ledger<'_>,
) -> Result<SequentialSurface, LensFileError> {
    let kind = part.string("type")?.unwrap_or("");
    if !matches!(kind, "Spheric" | "Aspheric" | "Plane" | "Aperture" | "Stop") {
        let what = format!(
            "is of type {}, which is not read; read are Spheric, Aspheric, Plane, Aperture and Stop",
            cut(kind)
        );
        return Err(refused(part, number, what));
    }
    check_axis(part, number)?;
    if part.flag("is_square")? {
        let what = "is square (is_square), of which the program's versions take r for the half side or the half \
                    diagonal; write false to trace it as round";
        return Err(refused(part.need("is_square", "false")?, number, what));
    }
    let is_stop = matches!(kind, "Aperture" | "Stop");
    let curvature = if is_stop || kind == "Plane" { 0.0 } else { bending(part)? };
    let asphere = if kind == "Aspheric" { figure(part, number, ledger)? } else { None };
    let size = part.needed_number("r", "a semi-diameter")?;
    if size <= 0.0 {
        let place = part.need("r", "a semi-diameter")?;
        return Err(place.error(format!("\"r\" is {}; expected a positive semi-diameter", as_given(size))));
    }
    Ok(SequentialSurface {
        curvature,
        asphere,
        behind: medium(part, is_stop, number, glasses, ledger)?,
        semi_diameter: Some(size),
        listed: Some(size),
        clip: None,
        apertures: Vec::new(),
        is_fixed: true,
        is_stop,
        general: Default::default(),
        break_behind: None,
    })
}

/// Checks that a surface stands upright on the axis.
fn check_axis(part: Part<'_>, number: &str) -> Result<(), LensFileError> {
    let decentre = part.numbers("pos_xy")?;
    let normal = part.numbers("vec_local")?;
    let is_tilted = !matches!(normal.as_slice(), [] | [0.0, 0.0, 1.0]);
    if is_tilted || decentre.iter().any(|value| *value != 0.0) {
        let what = format!("has a tilt or decentring (pos_xy, vec_local); {REVOLUTION}");
        return Err(refused(part, number, what));
    }
    Ok(())
}

/// Returns the curvature of a surface.
fn bending(part: Part<'_>) -> Result<f64, LensFileError> {
    match part.number_or_infinity("roc")? {
        Some(radius) => Ok(curvature(radius)),
        None => part.needed_number("c", "a radius (roc) or a curvature"),
    }
}

/// Returns the figure of an asphere.
fn figure(part: Part<'_>, number: &str, ledger: &mut Ledger<'_>) -> Result<Option<Asphere>, LensFileError> {
    let conic = part.number("k")?.unwrap_or(0.0);
    let mut terms = NO_TERMS;
    let list = part.numbers("ai")?;
    let named = |power: usize| part.number(&format!("ai{power}"));
    if list.is_empty() {
        for power in (2..=20).step_by(2) {
            set_term(&mut terms, power, named(power)?.unwrap_or(0.0))
                .map_err(|why| refused(part, number, why))?;
        }
    }
    for (power, &value) in (2..).step_by(2).zip(&list) {
        set_term(&mut terms, power, value).map_err(|why| refused(part, number, why))?;
        let other = if power <= 20 { named(power)? } else { None };
        if other.is_some_and(|other| (other - value).abs() > 1e-3 * value.abs().max(other.abs())) {
            let place = part.need(&format!("ai{power}"), "a term")?;
            let reason = "a term that differs from that in the list of coefficients (ai); the list counts";
            ledger.warn(Fate::Replaced, place.node.location, "ai", Some(number), reason);
        }
    }
    Ok(asphere(conic, terms))
}

/// Returns the medium behind a surface.
fn medium(
    part: Part<'_>,
    is_stop: bool,
    number: &str,
    glasses: &mut NamedGlasses<'_>,
    ledger: &mut Ledger<'_>,
) -> Result<MediumBehind, LensFileError> {
    if is_stop && part.get("mat2").is_none() {
        return Ok(Medium::Air.into());
    }
    let material = part.need("mat2", "the medium behind the surface")?;
    let name = part.string("mat2")?.unwrap_or("").trim();
    match name.to_ascii_lowercase().as_str() {
        "air" | "vacuum" => return Ok(Medium::Air.into()),
        "occluder" => {
            let reason = "the material \"occluder\", whose index is that of air; air is used";
            ledger.note(Fate::Replaced, material.node.location, "mat2", Some(number), reason);
            return Ok(Medium::Air.into());
        }
        _ => {}
    }
    let numbers = name.split_once('/').and_then(|(n_d, abbe)| Some((n_d.parse().ok()?, abbe.parse().ok()?)));
    match numbers {
        Some((n_d, abbe)) => by_numbers("", n_d, Some(abbe), glasses).map_err(|why| material.error(why)),
        None => by_name(material, name, glasses),
    }
}
