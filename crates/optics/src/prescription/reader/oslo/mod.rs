//! OSLO lens files (`.len`): commands for each surface, ended by `NXT`, and for the whole lens. The first surface is the
//! object, and the last one, before `END`, the image.
//!
//! `AP` is a semi-diameter: the edge of a clear aperture with `CHK`, and otherwise a size without an effect on rays. The
//! first wavelength of `WV` is that of the lens. `UNI` is the unit, mm.

use super::{
    commands::{Block, Command, Commands, NoEffect, Syntax, Untraced, record_fates},
    ledger::Ledger,
    named_glass::NamedGlasses,
    sequential::{
        Aperture, CURVED_IMAGE, Field, FieldKind, SequentialLens, SequentialSurface, SurfacePlaces, asphere,
        nanometres, set_term,
    },
    surface_rows::{MediumBehind, checked},
    text::{Location, Text, title},
};
use crate::prescription::{
    Fate, LensFileError, MAX_INTERFACES,
    glass::{D_LINE, GlassLibrary, tabulated},
    interfaces::{Medium, NO_TERMS, Prescription},
};

/// The marks of the language.
const SYNTAX: Syntax = Syntax { comment: "//", continues: None, letters: usize::MAX };

/// Keywords of the statements about the whole lens, which may stand among those of a surface.
const GENERAL: [&str; 12] =
    ["EBR", "NAO", "FNO", "ANG", "OBH", "GIH", "DES", "UNI", "WV", "WW", "CFG", "ZOO"];

/// Keywords without an effect on rays.
const NO_EFFECT: NoEffect = &[
    (
        "names and notes",
        &["DES", "SNO1", "SNO2", "SNO3", "SNO4", "SNO5", "SNO6", "SNO7", "SNO8", "SNO9", "SNO10"],
    ),
    ("settings of the file's program", &["DLRS", "RAIM", "CALLBACK"]),
    ("fields, wavelengths and their weights, which the user chooses", &["WW"]),
    ("the expansion of the glass with temperature", &["TCE"]),
];

/// Features that are not traced, with their keywords.
const UNTRACED: Untraced = &[
    ("has a tilt or decentring", &["TLA", "TLB", "TLC", "DCX", "DCY", "DCZ", "DT", "GC", "BEN", "RCO"]),
    ("is a mirror", &["RFL", "RFH"]),
    ("is a cylinder or toroid", &["CVX"]),
    ("is an ideal lens", &["PFL", "PFM"]),
    ("has an aperture of another form", &["APN", "AY1", "AY2", "AX1", "AX2", "ATP", "AAC", "AAN"]),
    ("has a figure of another kind", &["ASP", "ASI", "AH", "AI", "AJ", "AK"]),
    ("is a grating or diffractive", &["GSP", "GOR", "DOE", "DWV"]),
    ("has a value by a pickup or a solve, which the file does not hold", &["PK", "PY", "PYC", "PU", "PUC"]),
    ("has a medium whose index varies", &["GRT", "GRD"]),
];

/// The terms of r⁴ to r¹⁰.
const TERMS: [(&str, usize); 4] = [("AD", 4), ("AE", 6), ("AF", 8), ("AG", 10)];

/// Thicknesses of this magnitude mean infinity.
const ENDLESS: f64 = 1e10;

/// The statements of a file.
struct Blocks<'t> {
    general: Vec<Command<'t>>,
    surfaces: Vec<Block<'t>>,
    comments: Vec<Location>,
}

impl<'t> Blocks<'t> {
    fn of(text: &'t Text<'_>) -> Result<Self, LensFileError> {
        let Commands { all: commands, comments } = Commands::of(text, &SYNTAX);
        let mut all = Self { general: Vec::new(), surfaces: Vec::new(), comments };
        let mut is_ended = false;
        for command in commands {
            let key = command.key.as_str();
            is_ended |= key == "END";
            let begins = key == "NXT" || key == "LEN";
            if begins && all.surfaces.len() == MAX_INTERFACES + 2 {
                let message = format!("more surfaces; a lens has at most {MAX_INTERFACES} interfaces");
                return Err(text.error(command.location(), message));
            }
            if key == "LEN" && !all.surfaces.is_empty() {
                return Err(text.error(command.location(), "a second lens (LEN) in the file; expected one"));
            }
            if begins {
                command.record.values();
                let number = format!("{}", all.surfaces.len());
                all.surfaces.push(Block { number, entry: command, statements: Vec::new() });
            } else if let Some(surface) =
                all.surfaces.last_mut().filter(|_| !is_ended && !GENERAL.contains(&key))
            {
                surface.statements.push(command);
            } else {
                all.general.push(command);
            }
        }
        Ok(all)
    }

    /// Returns the last statement of this keyword about the whole lens.
    fn find(&self, key: &str) -> Option<&Command<'t>> {
        self.general.iter().rev().find(|statement| statement.key == key)
    }

    /// Returns the number of a statement about the whole lens.
    fn number(&self, text: &Text<'_>, key: &str) -> Result<Option<f64>, LensFileError> {
        self.find(key).map(|statement| statement.record.number(text, 0)).transpose()
    }
}

/// Reads a lens.
///
/// # Errors
/// The text is not a lens, or is a lens that cannot be traced; the error gives the first location with a fault.
pub(super) fn read(
    text: &Text<'_>,
    library: &GlassLibrary,
    ledger: &mut Ledger<'_>,
) -> Result<Prescription, LensFileError> {
    let blocks = Blocks::of(text)?;
    if let Some(statement) = blocks.find("CFG").or_else(|| blocks.find("ZOO")) {
        let message = "configurations, which are not read; keep one in OSLO and save the lens";
        return Err(text.error(statement.location(), message));
    }
    let [object, own @ .., image] = blocks.surfaces.as_slice() else {
        let location = Location { line: 1, column: 1 };
        return Err(
            text.error(location, "fewer than two surfaces; expected the object, a lens and the image")
        );
    };
    if own.is_empty() {
        return Err(
            text.error(image.entry.location(), "no lens before the image; expected at least one surface")
        );
    }
    let mut glasses = NamedGlasses::new(library, Vec::new());
    let wavelengths = wavelengths(text, &blocks)?;
    let front = checked(behind(text, object, &wavelengths, &mut glasses)?, |reason| {
        ledger.warn(Fate::Replaced, object.entry.location(), "GLA", Some("0"), reason);
    });
    let object_distance = thickness(text, object)?;
    let mut surfaces = Vec::with_capacity(own.len());
    let mut thicknesses = Vec::with_capacity(own.len());
    let mut places = Vec::with_capacity(own.len());
    for block in own {
        surfaces.push(surface(text, block, &wavelengths, &mut glasses)?);
        let thickness = thickness(text, block)?;
        if thickness.is_infinite() {
            let what = "has a thickness without end; a lens's surfaces stand at finite distances";
            return Err(block.refused(text, block.find("TH").unwrap_or(&block.entry), what));
        }
        thicknesses.push(thickness);
        let location = |key: &str| block.find(key).map(Command::location);
        places.push(SurfacePlaces {
            surface: block.entry.location(),
            size: location("AP"),
            thickness: location("TH"),
            number: block.number.clone(),
        });
    }
    if curvature(text, image)? != 0.0 {
        ledger.warn(Fate::Replaced, image.entry.location(), "RD", None, CURVED_IMAGE);
    }
    if let (Some(last), Some(_)) = (thicknesses.last_mut(), image.find("TH")) {
        // The thickness of the image is the distance of the film from it.
        *last += thickness(text, image)?;
    }
    let wavelength = wavelengths.first().map(|&(micrometres, location)| {
        nanometres(micrometres)
            .map(|wavelength| (wavelength, location))
            .map_err(|why| text.error(location, why))
    });
    let mut lens = SequentialLens {
        object: front,
        object_place: object.entry.location(),
        object_distance,
        surfaces,
        thicknesses,
        image_break: None,
        places,
        aperture: aperture(text, &blocks, object_distance)?,
        field: field(text, &blocks)?,
        wavelength: wavelength.transpose()?,
        keys: ["NXT", "AP", "TH"],
        unit: unit(text, &blocks)?,
    };
    lens.take_first_for_stop("AST", ledger);
    let (lens, _) = lens.prescription(text, object.entry.location(), ledger)?;
    let (glasses, remarks) = glasses.glasses_and_warnings(text.file);
    for key in ["END", "WV"] {
        blocks.general.iter().filter(|own| own.key == key).for_each(|own| _ = own.record.values());
    }
    record_fates(blocks.general.iter(), &blocks.surfaces, &blocks.comments, NO_EFFECT, ledger);
    Ok(Prescription {
        title: title(object.entry.record.word(1).map(|word| word.text)),
        glasses,
        remarks,
        ..lens
    })
}

/// Reads one surface of the lens.
fn surface(
    text: &Text<'_>,
    block: &Block<'_>,
    wavelengths: &[(f64, Location)],
    glasses: &mut NamedGlasses<'_>,
) -> Result<SequentialSurface, LensFileError> {
    block.check(text, UNTRACED)?;
    let mut terms = NO_TERMS;
    for (key, power) in TERMS {
        let Some(statement) = block.find(key) else { continue };
        set_term(&mut terms, power, statement.record.number(text, 0)?)
            .map_err(|why| block.refused(text, statement, &why))?;
    }
    let conic = block.find("CC").map_or(Ok(0.0), |statement| statement.record.number(text, 0))?;
    let (size, is_checked) = size(text, block)?;
    Ok(SequentialSurface {
        curvature: curvature(text, block)?,
        asphere: asphere(conic, terms),
        behind: behind(text, block, wavelengths, glasses)?,
        semi_diameter: size,
        listed: size.filter(|_| !is_checked),
        clip: size.filter(|_| is_checked),
        apertures: Vec::new(),
        is_fixed: is_checked,
        is_stop: block.find("AST").inspect(|statement| _ = statement.record.values()).is_some(),
        general: Default::default(),
        break_behind: None,
    })
}

/// Returns the semi-diameter of a surface, and whether it limits rays.
fn size(text: &Text<'_>, block: &Block<'_>) -> Result<(Option<f64>, bool), LensFileError> {
    let Some(statement) = block.find("AP") else { return Ok((None, false)) };
    let is_checked = statement.record.word(0).is_some_and(|word| word.is("CHK"));
    let size = statement.record.number(text, usize::from(is_checked))?;
    if size < 0.0 {
        return Err(block.refused(text, statement, "has a negative semi-diameter; expected 0 or more"));
    }
    Ok((Some(size).filter(|size| *size > 0.0), is_checked && size > 0.0))
}

/// Returns the curvature of a surface: `RD` states its radius, of which 0 means a plane, and `CV` the curvature.
fn curvature(text: &Text<'_>, block: &Block<'_>) -> Result<f64, LensFileError> {
    let Some(statement) = block.statements.iter().rev().find(|own| matches!(own.key.as_str(), "RD" | "CV"))
    else {
        return Ok(0.0);
    };
    let value = statement.record.number(text, 0)?;
    Ok(if statement.key == "RD" && value != 0.0 { value.recip() } else { value })
}

/// Returns the thickness behind a surface; infinite from [`ENDLESS`] on.
fn thickness(text: &Text<'_>, block: &Block<'_>) -> Result<f64, LensFileError> {
    let thickness = block.find("TH").map_or(Ok(0.0), |statement| statement.record.number(text, 0))?;
    Ok(if thickness.abs() >= ENDLESS { f64::INFINITY } else { thickness })
}

/// Returns the medium behind a surface: `AIR`, or `GLA` with a name, with a six-digit code, or with the indices at the
/// lens's wavelengths, which may follow `MOD` and a name.
fn behind(
    text: &Text<'_>,
    block: &Block<'_>,
    wavelengths: &[(f64, Location)],
    glasses: &mut NamedGlasses<'_>,
) -> Result<MediumBehind, LensFileError> {
    block.find("AIR").map(|statement| statement.record.values());
    let Some(statement) = block.statements.iter().rev().find(|own| matches!(own.key.as_str(), "AIR" | "GLA"))
    else {
        return Ok(Medium::Air.into());
    };
    let values = statement.record.values();
    let (name, first) = match values {
        _ if statement.key == "AIR" => return Ok(Medium::Air.into()),
        [] => return Err(text.error(statement.location(), "GLA without a glass; expected a name or indices")),
        [model, name, ..] if model.is("MOD") => (name.text, 2),
        [index, ..] if index.number().is_some_and(|index| index < 10.0) => ("", 0),
        [name, ..] => {
            return glasses.by_name(name.text, None, None).map_err(|why| text.error(name.location, why));
        }
    };
    let indices = statement.record.numbers(text, first)?;
    if indices.iter().all(|index| *index == 1.0) && !indices.is_empty() {
        return Ok(Medium::Air.into());
    }
    if indices.len() > 1 && indices.len() != wavelengths.len() {
        let message = format!(
            "{} indices of a glass at {} wavelengths (WV); expected one at each",
            indices.len(),
            wavelengths.len()
        );
        return Err(text.error(statement.location(), message));
    }
    let nm = |i: usize| wavelengths.get(i).map_or(D_LINE, |(own, _)| own * 1e3);
    let points: Vec<[f64; 2]> = indices.iter().enumerate().map(|(i, index)| [nm(i), *index]).collect();
    let (glass, _) = tabulated(&points).map_err(|why| text.error(statement.location(), why))?;
    Ok(if name.is_empty() { glass.medium.into() } else { glasses.use_as(name, glass) })
}

/// Returns the wavelengths, µm, with their places.
fn wavelengths(text: &Text<'_>, blocks: &Blocks<'_>) -> Result<Vec<(f64, Location)>, LensFileError> {
    let Some(statement) = blocks.find("WV") else { return Ok(Vec::new()) };
    let values = statement.record.values();
    values.iter().map(|cell| Ok((text.number(cell, "a wavelength, µm")?, cell.location))).collect()
}

/// Returns the aperture that limits the beam.
fn aperture(text: &Text<'_>, blocks: &Blocks<'_>, object: f64) -> Result<Aperture, LensFileError> {
    let is_distant = object.is_infinite();
    for key in ["EBR", "NAO", "FNO"] {
        let Some(statement) = blocks.find(key) else { continue };
        let value = statement.record.number(text, 0)?;
        if !(value > 0.0 && (key != "NAO" || value < 1.0)) {
            let message = format!("{} is not an aperture; expected a positive number", statement.shown());
            return Err(text.error(statement.location(), message));
        }
        return Ok(match key {
            "EBR" if is_distant => Aperture::EntrancePupil(2.0 * value),
            // The beam's radius at the first surface.
            "EBR" => Aperture::ObjectCone((value / object).atan().to_degrees()),
            "NAO" => Aperture::ObjectNa(value),
            _ if is_distant => Aperture::FNumber(value),
            _ => Aperture::WorkingFNumber(value),
        });
    }
    Ok(Aperture::ByStop)
}

/// Returns the farthest field: `ANG`, degrees, or a height of the object (`OBH`) or of the image (`GIH`).
fn field(text: &Text<'_>, blocks: &Blocks<'_>) -> Result<Option<Field>, LensFileError> {
    const KINDS: [(&str, FieldKind); 3] =
        [("ANG", Field::Angle), ("OBH", Field::ObjectHeight), ("GIH", Field::ImageHeight)];
    for (key, kind) in KINDS {
        if let Some(value) = blocks.number(text, key)? {
            return Ok(Some(kind(value.abs())));
        }
    }
    Ok(None)
}

/// Returns the unit of the file's lengths, mm.
fn unit(text: &Text<'_>, blocks: &Blocks<'_>) -> Result<f64, LensFileError> {
    match blocks.number(text, "UNI")? {
        None => Ok(1.0),
        Some(unit) if unit > 0.0 => Ok(unit),
        Some(_) => {
            let location = blocks.find("UNI").map_or(Location { line: 1, column: 1 }, Command::location);
            Err(text.error(location, "a unit that is not positive; expected the millimetres of a unit"))
        }
    }
}

#[cfg(test)]
mod tests;
