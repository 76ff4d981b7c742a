//! A surface of the file: reads its curvature, figure, glass and coating, and refuses unsupported surfaces.
//!
//! A coating is a name (`COAT NAME`). The file's program keeps the recipes in a separate file (COATING.DAT), which an
//! archive includes. Without that file, names in the sample file of that program select the coatings here that have the
//! same layers; other names are reported.

use super::{blocks::Block, coating_file::CoatingFile, frames, shapes, unsymmetric};
use crate::prescription::{
    CoordinateBreak, Fate, LensFileError,
    coating::{Coating, SurfaceCoating},
    interfaces::{AsphereTerms, Interface, Medium, NO_TERMS, has_coating},
    reader::{
        ledger::Ledger,
        named_glass::NamedGlasses,
        record::Record,
        reflections::MIRROR_INDEX,
        sequential::{SequentialSurface, asphere, set_term},
        surface_rows::{General, MediumBehind, checked, index},
        text::{Text, no_number},
    },
};
use realistic_base::message::{cut, quoted};

/// The supported types of surfaces, for messages.
const READ: &str = "read are STANDARD, EVENASPH, ODDASPHE, XASPHERE, XOSPHERE, TOROIDAL, BICONICX, COORDBRK, TILTSURF and a plane \
                    JONESMAT";

/// Reads one surface between the object and the image. `in_front` is the medium in front of it.
///
/// # Errors
/// Tracing does not support the surface, or a value is missing.
pub(super) fn read(
    text: &Text<'_>,
    block: &Block<'_>,
    in_front: MediumBehind,
    glasses: &mut NamedGlasses<'_>,
    ledger: &mut Ledger<'_>,
) -> Result<SequentialSurface, LensFileError> {
    let [front, break_behind] = frames::read(text, block)?;
    if frames::is_break(block) {
        return Ok(coordinate_break(in_front, front));
    }
    let conic = block.find("CONI").map_or(Ok(0.0), |record| record.number(text, 0))?;
    let curvature = block.find("CURV").map_or(Ok(0.0), |record| record.number(text, 0))?;
    let kind = block.find("TYPE").and_then(|record| record.word(0)).map_or("STANDARD", |word| word.text);
    let unsymmetric = unsymmetric::read(text, block, kind, (curvature, conic))?;
    let (curvature, figure) = match unsymmetric {
        Some(_) => (0.0, None),
        None if kind == "TILTSURF" => (0.0, asphere(0.0, terms(text, block, 0.0, ledger)?)),
        None => (curvature, asphere(conic, terms(text, block, curvature, ledger)?)),
    };
    let is_mirror = is_called_mirror(block) || block.find("GLAS").is_some_and(is_of_index_of_mirrors);
    let behind = match block.find("GLAS") {
        _ if is_mirror => in_front,
        Some(record) => glass(text, block, record, glasses)?,
        None => Medium::Air.into(),
    };
    let diameter = block.find("DIAM");
    let semi_diameter = diameter
        .map(|record| record.number(text, 0))
        .transpose()?
        .filter(|semi_diameter| *semi_diameter != 0.0);
    let is_listed_fixed = diameter.and_then(|record| record.number_if_any(1)) == Some(1.0);
    let floats = block.find("FLAP").is_some();
    // A floating aperture is as large as the semi-diameter of its surface.
    let by_float = semi_diameter.filter(|_| floats && is_listed_fixed);
    let (mut clip, mut apertures) = shapes::read(text, block, [semi_diameter, by_float], ledger)?;
    let is_fixed = clip.is_some() || !apertures.is_empty() || floats || is_listed_fixed;
    let mut semi_diameter = semi_diameter;
    if let Some(circle) = clip.or(semi_diameter)
        && let Some(ellipse) = frames::tilted_circle(text, block, circle)?
    {
        if !apertures.is_empty() {
            let what = "an aperture that is not round on a tilted plane (TILTSURF), which is not read: put it on a plane of \
                        its own";
            return Err(text.error(block.location, format!("surface {} has {what}", block.number)));
        }
        semi_diameter = Some(ellipse.reach());
        clip = clip.and(semi_diameter);
        apertures.extend(Some(ellipse).filter(|_| is_fixed));
    }
    Ok(SequentialSurface {
        curvature,
        asphere: figure,
        behind,
        semi_diameter: clip.or(semi_diameter),
        listed: semi_diameter,
        clip,
        apertures,
        is_fixed,
        is_stop: block.find("STOP").inspect(|record| _ = record.values()).is_some(),
        general: General { unsymmetric, is_mirror, coordinate_break: front },
        break_behind,
    })
}

/// Returns whether `GLAS MIRROR` makes a surface a mirror.
pub(super) fn is_called_mirror(block: &Block<'_>) -> bool {
    block.find("GLAS").and_then(|record| record.word(0)).is_some_and(|name| name.is("MIRROR"))
}

/// Returns whether `GLAS` is a model glass of the index -1.
fn is_of_index_of_mirrors(record: &Record<'_>) -> bool {
    record.number_if_any(1) == Some(1.0) && record.number_if_any(3) == Some(MIRROR_INDEX)
}

/// Returns the surface of a coordinate break, which only changes the frame.
fn coordinate_break(in_front: MediumBehind, change: Option<CoordinateBreak>) -> SequentialSurface {
    SequentialSurface {
        curvature: 0.0,
        asphere: None,
        behind: in_front,
        semi_diameter: None,
        listed: None,
        clip: None,
        apertures: Vec::new(),
        is_fixed: false,
        is_stop: false,
        general: General { coordinate_break: change, ..General::default() },
        break_behind: None,
    }
}

/// Returns the polynomial terms of the surface, which depend on its type.
///
/// # Errors
/// The type or a power of r is not supported.
fn terms(
    text: &Text<'_>,
    block: &Block<'_>,
    curvature: f64,
    ledger: &mut Ledger<'_>,
) -> Result<AsphereTerms, LensFileError> {
    let word = block.find("TYPE").and_then(|record| record.word(0));
    let location = word.map_or(block.location, |word| word.location);
    let location = block.find("TYPE").map_or(location, |record| record.key.location);
    let refuse = |what: &str, why: &str| {
        Err(text.error(location, format!("surface {} is {what}; {why}", block.number)))
    };
    let mut terms = NO_TERMS;
    // Sets the term of r^power.
    let mut add = |power: usize, value: f64, location| -> Result<(), LensFileError> {
        set_term(&mut terms, power, value)
            .map_err(|why| text.error(location, format!("surface {} {why}", block.number)))
    };
    let kind = word.map_or("STANDARD", |word| word.text);
    let parameters = block.numbered(text, "PARM")?;
    let data = block.numbered(text, "XDAT")?;
    let (even, is_extended) = match kind {
        "EVENASPH" => (true, false),
        "ODDASPHE" => (false, false),
        "XASPHERE" => (true, true),
        "XOSPHERE" => (false, true),
        "STANDARD" | "TILTSURF" => (true, false),
        "JONESMAT" if curvature == 0.0 => {
            let reason = "an element that polarises (JONESMAT); a plane, which polarises nothing, is traced";
            ledger.warn(Fate::Replaced, location, "TYPE", Some(block.number), reason);
            (true, false)
        }
        "DGRATING" | "EGRATING" => return refuse(&format!("a grating ({kind})"), READ),
        "PARAXIAL" => {
            let why = "off the axis it keeps no étendue, so that no light through it can be computed: put a lens of glass in its \
                       place";
            return refuse("an ideal thin lens (PARAXIAL)", why);
        }
        other => return refuse(&format!("of type {}, which is not read", cut(other)), READ),
    };
    let step = if even { 2 } else { 1 };
    // XDAT states first the number of terms, then the normalisation radius, then the terms.
    let of_data = |number: usize| data.iter().find(|(i, ..)| *i == number).map(|&(_, value, _)| value);
    let count = of_data(1).unwrap_or(f64::INFINITY);
    let counts = |i: usize| is_extended && i > 2 && (i - 2) as f64 <= count;
    let is_by_data = data.iter().any(|&(i, value, _)| counts(i) && value != 0.0);
    for &(i, value, location) in &parameters {
        if value == 0.0 {
            continue;
        }
        if kind == "TILTSURF" && i <= 2 {
            continue;
        }
        if matches!(kind, "STANDARD" | "JONESMAT" | "TILTSURF") || is_by_data {
            let reason = format!("a parameter (PARM {i}) that a surface of type {kind} does not have here");
            ledger.warn(Fate::LeftOut, location, "PARM", Some(block.number), reason);
        } else {
            add(step * i, value, location)?;
        }
    }
    let radius = of_data(2).unwrap_or(1.0);
    for &(i, value, location) in data.iter().filter(|(i, value, _)| *i > 2 && *value != 0.0) {
        if !counts(i) {
            let reason =
                "extra data (XDAT) that the type of the surface or its number of terms leaves unused";
            ledger.note(Fate::LeftOut, location, "XDAT", Some(block.number), reason);
            continue;
        }
        let power = step * (i - 2);
        let value = value / radius.powi(power.min(999) as i32);
        if !value.is_finite() {
            return Err(text.error(location, "the normalisation radius leaves this term without end"));
        }
        add(power, value, location)?;
    }
    Ok(terms)
}

/// Reads the medium between the object and the lens.
///
/// # Errors
/// The medium is unknown.
pub(super) fn object_medium(
    text: &Text<'_>,
    object: &Block<'_>,
    glasses: &mut NamedGlasses<'_>,
    ledger: &mut Ledger<'_>,
) -> Result<MediumBehind, LensFileError> {
    let Some(record) = object.find("GLAS") else { return Ok(Medium::Air.into()) };
    let behind = glass(text, object, record, glasses)?;
    Ok(checked(behind, |reason| {
        ledger.warn(Fate::Replaced, record.key.location, "GLAS", Some(object.number), reason);
    }))
}

/// The required form of a model glass, for messages.
const MODEL_GLASS: &str = "a model glass has an index of 1 or more as its fourth value";

/// Reads `GLAS name code pickup n_d V …`. Solve code 1 denotes a model glass, which n_d and V define. With any other
/// code only the name is used. The numbers may then belong to a previous glass, and with code 3 (substitute) they
/// mostly do.
fn glass(
    text: &Text<'_>,
    block: &Block<'_>,
    record: &Record<'_>,
    glasses: &mut NamedGlasses<'_>,
) -> Result<MediumBehind, LensFileError> {
    let location = record.key.location;
    let Some(name) = record.word(0) else {
        return Err(text.error(location, "GLAS without a name"));
    };
    // These numbers are written by programs that do not store the numbers of catalogue glasses.
    const PLACEHOLDER: [Option<f64>; 2] = [Some(1.5), Some(40.0)];
    const NO_NAME: &str = "___BLANK";
    let code = record.number_if_any(1).unwrap_or(0.0);
    let numbers = [record.number_if_any(3), record.number_if_any(4)];
    let [n_d, abbe] = [numbers[0], numbers[1].filter(|abbe| *abbe > 0.0)];
    if name.text == NO_NAME || code == 1.0 {
        // The Abbe number may be missing, but must not be malformed.
        if record.word(4).is_some() {
            record.number(text, 4)?;
        }
        let name = Some(name.text).filter(|name| *name != NO_NAME).unwrap_or("");
        return match n_d {
            Some(n_d) if n_d < 0.0 => {
                let message = format!(
                    "surface {} is a mirror, written by its index {n_d}; write GLAS MIRROR, and positive indices behind it with \
                     negative thicknesses",
                    block.number
                );
                Err(text.error(location, message))
            }
            Some(n_d) if n_d != 0.0 => match index(n_d) {
                Ok(None) => Ok(Medium::Air.into()),
                Ok(Some(n_d)) => Ok(glasses.by_numbers(name, n_d, abbe)),
                Err(_) => Err(text.error(location, MODEL_GLASS)),
            },
            Some(_) => Err(text.error(location, MODEL_GLASS)),
            None => Err(record.word(3).map_or_else(
                || text.error(location, MODEL_GLASS),
                |cell| text.error(cell.location, no_number(cell.text, "the index of a model glass")),
            )),
        };
    }
    if code == 4.0 {
        let message = format!("glass {name} with offsets of its index (mode 4) is not read");
        return Err(text.error(location, message));
    }
    let is_own = code != 3.0 && numbers != PLACEHOLDER;
    let [n_d, abbe] = if is_own { [n_d.filter(|n_d| *n_d > 1.0), abbe] } else { [None, None] };
    glasses.by_name(name.text, n_d, abbe).map_err(|why| {
        let numbers = match numbers {
            PLACEHOLDER | [None, _] => String::new(),
            [Some(n_d), _] => format!(
                "; that n_d is {n_d} counts only with 1, a model glass, for the solve code {code} behind the name: write 1 \
                 to take the line's numbers"
            ),
        };
        text.error(name.location, why + &numbers)
    })
}

/// Names of coatings, in any case, in addition to [`Coating::NAMES`]. AR is a quarter wave of MgF2. HEAR1 is a quarter
/// wave of MgF2, a half wave of ZrO2 and a quarter wave of CeF3. The waves refer to the file's primary wavelength.
const COATINGS: [(&str, Coating); 5] = [
    ("none", Coating::Bare),
    ("null", Coating::Bare),
    ("ar", Coating::QuarterWave),
    ("mgf2", Coating::QuarterWave),
    ("hear1", Coating::ThreeLayer),
];

/// The reason recorded when the indices of a coating's layers are taken at one wavelength.
const ONE_INDEX: &str = "the layers have their indices at the primary wavelength, at every wavelength";

/// Returns the coatings of the interfaces, which correspond to `blocks`, with layers in waves of `wavelength`, nm.
/// Definitions in `file` precede names known here. Returns `None` if the lens names no coating. Warnings about
/// unsupported coatings go to `ledger`.
pub(super) fn coatings(
    blocks: &[&Block<'_>],
    object: Medium,
    interfaces: &[Interface],
    wavelength: f64,
    file: Option<&CoatingFile>,
    ledger: &mut Ledger<'_>,
) -> Option<Vec<SurfaceCoating>> {
    let mut names_any = false;
    let coatings = blocks.iter().zip(has_coating(object, interfaces)).map(|(block, can_have)| {
        let bare = SurfaceCoating::Named { coating: Coating::Bare, wavelength };
        let Some(name) = block.find("COAT").and_then(|record| record.word(0)) else { return bare };
        names_any = true;
        let (coating, is_one_index) = match coating(name.text, wavelength, file) {
            Ok(known) => known,
            Err(why) => {
                ledger.warn(Fate::LeftOut, name.location, "COAT", Some(block.number), why);
                return bare;
            }
        };
        if coating.is_bare() {
            return bare;
        }
        if !can_have {
            let message = format!(
                "coating {name} is left out: the surface is not between air and glass, where coatings are"
            );
            ledger.warn(Fate::LeftOut, name.location, "COAT", Some(block.number), message);
            return bare;
        }
        if is_one_index {
            ledger.note(Fate::Replaced, name.location, "COAT", Some(block.number), ONE_INDEX);
        }
        coating
    });
    let coatings = coatings.collect();
    names_any.then_some(coatings)
}

/// Returns the coating of a name, and whether its layers have an index for one wavelength only, although the file gives
/// several.
///
/// # Errors
/// The coating is unknown or not supported; the text says so.
fn coating(
    name: &str,
    wavelength: f64,
    file: Option<&CoatingFile>,
) -> Result<(SurfaceCoating, bool), String> {
    let defined = file.and_then(|file| Some((file.layers(name, wavelength)?, &file.file)));
    match defined {
        Some((Ok(found), _)) => return Ok((SurfaceCoating::Stack(found.layers), found.is_dispersive)),
        Some((Err(why), file)) => {
            return Err(format!(
                "coating {} of {file} is not read, and the surface is bare: {why}",
                cut(name)
            ));
        }
        None => {}
    }
    let known = || Coating::NAMES.iter().chain(&COATINGS);
    match known().find(|(known, _)| name.eq_ignore_ascii_case(known)) {
        Some((_, coating)) => Ok((SurfaceCoating::Named { coating: *coating, wavelength }, false)),
        None => Err(format!(
            "coating {} is known to the file's program alone, and the surface is bare. {} are known here",
            cut(name),
            quoted(&known().map(|(name, _)| *name).collect::<Vec<_>>())
        )),
    }
}
