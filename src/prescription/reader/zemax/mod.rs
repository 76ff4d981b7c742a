//! Zemax files (.zmx), sequential: text of keywords, a block `SURF n` per surface, the object first and the image last;
//! *semi*-diameters; the curvature for the radius. Text in, a prescription out.
//!
//! Surfaces where nothing changes and whose size the file's program computed are left out. The stop, on glass or in air, is as
//! large as the aperture that the file states.
//!
//! `blocks` cuts the text into records; `general` reads those of the whole lens, `surface` those of a block; `aperture` derives by
//! paraxial rays the semi-diameters that the file leaves open.

mod aperture;
mod blocks;
mod general;
mod surface;

use super::{
    named_glass::NamedGlasses,
    surfaces::{self, Role, SurfaceRow},
    text::{Place, Text},
};
use crate::{
    message::{cut, short},
    prescription::{
        LensFileError,
        glass::{D_LINE, GlassLibrary, loose},
        interfaces::{Medium, Prescription, Shape, Stated},
        positions::{Position, Positions},
    },
};
use aperture::{Aperture, Paraxial, farthest};
use blocks::Blocks;
use general::Configurations;
use surface::Surface;

/// An object that is farther away than this, in the file's unit, is at infinity: multi-configuration records write 1e10.
const FAR: f64 = 1e9;

/// Reads a lens from decoded bytes; `file` is its name in messages.
///
/// # Errors
/// The first place at which the text is not a lens, or not one that can be traced.
pub(super) fn read(file: &str, bytes: &[u8], library: &GlassLibrary) -> Result<Prescription, LensFileError> {
    let text = Text::new(file, bytes);
    let blocks = Blocks::of(&text)?;
    if let Some(record) =
        blocks.find("MODE").filter(|record| record.values.first().is_some_and(|v| v.text != "SEQ"))
    {
        return Err(text.error(record.key.place, "not a sequential lens (MODE SEQ)"));
    }
    let unit = unit(&text, &blocks)?;
    let [object, own @ .., image] = blocks.surfaces.as_slice() else {
        return Err(
            text.error(Place { line: 1, column: 1 }, "fewer than two surfaces, the object and the image")
        );
    };
    if own.is_empty() {
        return Err(text.error(image.place, "no surface between object and image; expected at least one"));
    }
    // The catalogues in which the file's program looks glasses up.
    let catalogues = blocks.find("GCAT").map_or(&[][..], |record| &record.values);
    let mut glasses =
        NamedGlasses::new(library, catalogues.iter().map(|catalogue| loose(catalogue.text)).collect());
    let primary = general::primary_wavelength(&text, &blocks)?;
    let wavelength = primary.map_or(D_LINE, |(wavelength, _)| wavelength);
    let mut surfaces =
        own.iter().map(|block| surface::read(&text, block, &mut glasses)).collect::<Result<Vec<_>, _>>()?;
    let configurations = Configurations::of(&text, &blocks)?;
    let mut remarks = configurations.remarks.clone();
    remarks.extend(odd_number(&text, &blocks));
    // Thicknesses by configuration, the object's distance first.
    let mut thicknesses = Vec::with_capacity(configurations.count);
    let stated = blocks.surfaces[..=own.len()]
        .iter()
        .enumerate()
        .map(|(i, block)| thickness(&text, block, i == 0))
        .collect::<Result<Vec<f64>, _>>()?;
    for column in 0..configurations.count {
        let of = |(i, own): (usize, &f64)| configurations.thickness(i, column, *own);
        thicknesses.push(stated.iter().enumerate().map(of).collect::<Vec<f64>>());
    }
    let stop = surfaces.iter().position(|surface| surface.is_stop);
    let stated_aperture = Aperture::of(&text, &blocks)?;
    let mut stop_sizes = Vec::new();
    if let Some(stop) = stop {
        for (column, thicknesses) in thicknesses.iter().enumerate() {
            let value =
                configurations.apertures.iter().find(|(own, _)| *own == column).map(|(_, value)| *value);
            let aperture = value.map_or(stated_aperture, |value| stated_aperture.with(value));
            let paraxial = Paraxial::of(&surfaces, &thicknesses[1..], wavelength);
            stop_sizes.push(paraxial.stop(aperture, stop, thicknesses[0]));
        }
        if let Some(size) = stop_sizes[0] {
            surfaces[stop].semi_diameter = Some(size);
        }
    }
    derive_missing(&blocks, stop, &mut surfaces, &thicknesses[0], wavelength, &mut remarks, &text);
    let kept = kept(&surfaces);
    let gaps: Vec<Vec<f64>> = thicknesses.iter().map(|column| merged(&kept, &column[1..])).collect();
    let mut rows = Vec::with_capacity(kept.len());
    for (row, &i) in kept.iter().enumerate() {
        rows.push(surface_row(&surfaces, i, gaps[0][row]).ok_or_else(|| {
            let message = format!(
                "surface {} has no semi-diameter (DIAM), and the file does not state an aperture, a field and a stop to \
                 derive it from",
                own[i].number
            );
            text.error(own[i].place, message)
        })?);
    }
    let Some(last) = rows.len().checked_sub(1) else {
        return Err(text.error(own[0].place, "no surface does anything; expected a lens"));
    };
    let back = rows[last].thickness;
    if back < 0.0 {
        let message = "the image lies in front of the last surface, where no film can be; the film's place is left open";
        remarks.push(text.error(image.place, message).to_string());
        rows[last].thickness = 0.0;
    }
    if image.find("CURV").and_then(|record| record.number_if_any(0)).is_some_and(|curvature| curvature != 0.0)
    {
        remarks.push(text.error(image.place, "the image is curved; the film is flat").to_string());
    }
    let at = |row: usize, message: &str| text.error(own[kept[row]].place, message);
    let (mut interfaces, wide) = surfaces::interfaces(&rows, &at)?;
    remarks.extend(wide.iter().map(LensFileError::to_string));
    interfaces[last].thickness = 0.0;
    let kept_blocks: Vec<_> = kept.iter().map(|&i| &own[i]).collect();
    let coatings = surface::coatings(&text, &kept_blocks, &interfaces, wavelength, &mut remarks);
    let mut positions = positions(&text, &thicknesses, &gaps, &stop_sizes, object.place)?;
    surfaces::positions_in_order(&interfaces, positions.as_ref(), &at)?;
    let (glasses, told) = glasses.told(file);
    remarks.extend(told);
    let is_angle = blocks.find("FTYP").and_then(|record| record.number_if_any(0)).unwrap_or(0.0) == 0.0;
    let field = Some(2.0 * farthest(&blocks)).filter(|field| is_angle && *field > 0.0 && *field <= 360.0);
    let fnumber = match stated_aperture {
        Aperture::FNumber(number) => Some(number),
        _ => None,
    };
    let mut stated = Stated { year: None, fnumber, fields: field.map(Some).into_iter().collect() };
    if let Some(positions) = &mut positions {
        for (i, column) in positions.columns.iter_mut().enumerate() {
            let changed = configurations.apertures.iter().find(|(own, _)| *own == i).map(|(_, value)| *value);
            column.fnumber = fnumber.map(|fnumber| changed.unwrap_or(fnumber));
        }
        let fields = field.map(|field| vec![Some(field); positions.columns.len()]);
        stated = Stated { year: None, fnumber: None, fields: fields.unwrap_or_default() };
    }
    let lens = Prescription {
        title: title(&blocks),
        nominal_film_distance: (back > 0.0).then_some(back),
        stated,
        glasses,
        coatings,
        wavelength: primary.map(|(wavelength, _)| wavelength),
        positions,
        remarks,
        ..Prescription::new(interfaces)
    };
    if let Some((wavelength, place)) = primary {
        lens.check_wavelength(wavelength).map_err(|why| text.error(place, why))?;
    }
    let lens = if unit == 1.0 { lens } else { lens.scaled(unit) };
    if has_range(&lens) {
        Ok(lens)
    } else {
        Err(text.error(object.place, "a length of this lens, in mm, is beyond the range of numbers"))
    }
}

/// That a surface has another number than its place in the file.
fn odd_number(text: &Text<'_>, blocks: &Blocks<'_>) -> Option<String> {
    let (i, odd) = blocks.surfaces.iter().enumerate().find(|(i, block)| block.number.parse() != Ok(*i))?;
    let message = format!(
        "surface {} where surface {i} was expected; surfaces are taken in the order in which they stand",
        cut(odd.number)
    );
    Some(text.error(odd.place, message).to_string())
}

/// Whether all lengths are numbers, semi-diameters and distances not 0: units and sums may take them out of range.
fn has_range(lens: &Prescription) -> bool {
    let is_length = |length: f64| length > 0.0 && length.is_finite();
    let interfaces = lens.interfaces.iter().all(|interface| {
        let shape = match interface.shape {
            Shape::Sphere { radius } => is_length(radius.abs()) && interface.semi_diameter <= radius.abs(),
            Shape::Asphere(asphere) => {
                asphere.radius != 0.0 && asphere.terms.iter().all(|term| term.is_finite())
            }
            Shape::Plane => true,
        };
        shape && interface.thickness.is_finite() && is_length(interface.semi_diameter)
    });
    let mut columns = lens.positions.iter().flat_map(|positions| &positions.columns);
    let columns = columns.all(|column| {
        let lengths = [column.stop_diameter, column.object_distance, column.focal_length];
        column.gaps.iter().all(|gap| gap.is_finite()) && lengths.into_iter().flatten().all(is_length)
    });
    interfaces && columns && lens.nominal_film_distance.is_none_or(is_length)
}

/// How many mm the file's unit has.
fn unit(text: &Text<'_>, blocks: &Blocks<'_>) -> Result<f64, LensFileError> {
    let Some(word) = blocks.find("UNIT").and_then(|record| record.values.first()) else { return Ok(1.0) };
    match word.text.to_ascii_uppercase().as_str() {
        "MM" => Ok(1.0),
        "CM" => Ok(10.0),
        "IN" | "INCH" => Ok(25.4),
        "M" | "METER" => Ok(1000.0),
        _ => Err(text.error(word.place, format!("\"{}\" is not a unit: MM, CM, IN or METER", word.cut()))),
    }
}

fn title(blocks: &Blocks<'_>) -> Option<String> {
    let words = blocks.find("NAME")?.values.iter().map(|word| word.text).collect::<Vec<_>>().join(" ");
    let title: String = words.chars().filter(|c| !c.is_control()).collect();
    Some(title.trim_matches(|c: char| c == '#' || c.is_whitespace()).to_owned())
        .filter(|title| !title.is_empty())
}

/// The thickness behind a surface; that of the object may have no end.
fn thickness(text: &Text<'_>, block: &blocks::Block<'_>, is_object: bool) -> Result<f64, LensFileError> {
    let Some(record) = block.find("DISZ") else { return Ok(if is_object { f64::INFINITY } else { 0.0 }) };
    let is_endless =
        record.values.first().is_some_and(|value| value.text.to_ascii_uppercase().starts_with("INF"));
    match is_endless {
        true if is_object => Ok(f64::INFINITY),
        true => Err(text
            .error(record.key.place, "a thickness without end; a lens's surfaces stand at finite distances")),
        false => record.number(text, 0),
    }
}

/// The media on both sides of a surface are the same.
fn is_idle(surfaces: &[Surface], i: usize) -> bool {
    let in_front = if i == 0 { Medium::Air.into() } else { surfaces[i - 1].behind };
    in_front == surfaces[i].behind
}

/// The surfaces that do something: bend rays, are the stop, or have an aperture that the file fixes.
fn kept(surfaces: &[Surface]) -> Vec<usize> {
    let does = |&i: &usize| {
        let surface = &surfaces[i];
        !is_idle(surfaces, i) || surface.is_stop || surface.is_fixed && surface.semi_diameter.is_some()
    };
    (0..surfaces.len()).filter(does).collect()
}

/// The thicknesses behind the kept surfaces, with those of the surfaces that are left out.
fn merged(kept: &[usize], thicknesses: &[f64]) -> Vec<f64> {
    let end = |row: usize| kept.get(row + 1).copied().unwrap_or(thicknesses.len());
    (0..kept.len()).map(|row| thicknesses[kept[row]..end(row)].iter().sum()).collect()
}

/// Gives the surfaces without a semi-diameter one, where the file says enough.
fn derive_missing(
    blocks: &Blocks<'_>,
    stop: Option<usize>,
    surfaces: &mut [Surface],
    thicknesses: &[f64],
    wavelength: f64,
    remarks: &mut Vec<String>,
    text: &Text<'_>,
) {
    let missing: Vec<usize> = (0..surfaces.len())
        .filter(|&i| surfaces[i].semi_diameter.is_none() && !is_idle(surfaces, i))
        .collect();
    let Some((stop, size)) = stop.and_then(|stop| Some((stop, surfaces[stop].semi_diameter?))) else {
        return;
    };
    let paraxial = Paraxial::of(surfaces, &thicknesses[1..], wavelength);
    let field = paraxial.field(blocks, stop, thicknesses[0]);
    for i in missing {
        if let Some(reach) = paraxial.reach(i, stop, size, field) {
            surfaces[i].semi_diameter = Some(reach);
            let block = &blocks.surfaces[i + 1];
            let message = format!(
                "surface {} has no semi-diameter (DIAM); {}, by paraxial rays of the file's aperture and field, is used",
                block.number,
                short(reach)
            );
            remarks.push(text.error(block.place, message).to_string());
        }
    }
}

/// The row of a surface; `None` where it has no size.
fn surface_row(surfaces: &[Surface], i: usize, thickness: f64) -> Option<SurfaceRow> {
    let surface = &surfaces[i];
    let is_plane =
        surface.curvature == 0.0 && surface.asphere.is_none_or(|asphere| asphere.terms == [0.0; 19]);
    let is_in_air = is_idle(surfaces, i) && surface.behind.medium == Medium::Air;
    let role = match surface.is_stop {
        true => Role::Stop,
        false if is_plane && is_in_air => Role::FlareStop,
        false => Role::Any,
    };
    Some(SurfaceRow {
        // A curvature of 0 is a plane's.
        radius: if surface.curvature == 0.0 { f64::INFINITY } else { surface.curvature.recip() },
        role,
        thickness,
        behind: surface.behind,
        diameter: 2.0 * surface.semi_diameter?,
        asphere: surface.asphere.filter(|_| !is_plane),
    })
}

/// The configurations as positions; `None` where there is one, and its object is at infinity.
fn positions(
    text: &Text<'_>,
    thicknesses: &[Vec<f64>],
    gaps: &[Vec<f64>],
    stop_sizes: &[Option<f64>],
    object: Place,
) -> Result<Option<Positions>, LensFileError> {
    let distance = |column: &Vec<f64>| Some(column[0]).filter(|distance| distance.abs() < FAR);
    if let Some(behind) = thicknesses.iter().filter_map(distance).find(|distance| *distance <= 0.0) {
        let message = format!(
            "the object lies {} in front of the first surface; expected a positive distance",
            short(behind)
        );
        return Err(text.error(object, message));
    }
    if thicknesses.len() == 1 && distance(&thicknesses[0]).is_none() {
        return Ok(None);
    }
    let moving: Vec<usize> =
        (0..gaps[0].len()).filter(|&row| gaps.iter().any(|column| column[row] != gaps[0][row])).collect();
    let column = |i: usize| Position {
        name: None,
        gaps: moving.iter().map(|&row| gaps[i][row]).collect(),
        stop_diameter: stop_sizes.get(i).copied().flatten().map(|size| 2.0 * size),
        focal_length: None,
        fnumber: None,
        object_distance: distance(&thicknesses[i]),
    };
    let columns = (0..gaps.len()).map(column).collect();
    Ok(Some(Positions { gaps: moving, columns }))
}

#[cfg(test)]
mod tests;
