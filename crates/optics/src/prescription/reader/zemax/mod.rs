//! Sequential Zemax files (.zmx): text of keywords, with a block `SURF n` for each surface, the object first and the
//! image last. The files state *semi*-diameters, and curvatures instead of radii.
//!
//! Surfaces that have no effect, and whose size the file's program computed, are left out. The stop, whether on glass
//! or in air, has the size that follows from the file's aperture.
//!
//! Coordinate breaks are such surfaces, too: their changes of frame are those of the next surface with an effect.
//!
//! `blocks` splits the text into records. `general` reads the records of the whole lens, and `surface` reads the
//! records of a block. `coating_file` reads the file of coatings that an archive includes. `aperture` reads the
//! aperture and the field. `shapes` reads the apertures of surfaces, `frames` their changes of frame, and `unsymmetric`
//! figures that are not round. `statements` records the fate of every line.

mod aperture;
mod blocks;
mod coating_file;
mod frames;
mod general;
mod shapes;
mod statements;
mod surface;
mod unsymmetric;

use super::{
    ledger::Ledger,
    named_glass::NamedGlasses,
    reflections,
    sequential::{
        self, Aperture, Effective, Frames, Paraxial, ROUNDING, SequentialSurface, has_range, let_through,
        light_sign, positions, surface_row,
    },
    surface_rows,
    text::{Location, Text},
};
use crate::prescription::{
    Fate, LensFileError,
    glass::{D_LINE, GlassLibrary, loose},
    interfaces::{Medium, Prescription, Stated},
    unsymmetric::Meridian,
};
use aperture::{farthest, farthest_field};
use blocks::{Block, Blocks};
pub(super) use coating_file::CoatingFile;
use general::{Configurations, Operand};
use realistic_base::message::cut;

/// Returns whether a line begins a surface. No other format has such a line.
pub(super) fn is_surface(line: &[u8]) -> bool {
    blocks::is_surface(line)
}

/// Reads a lens from a text. `coating_file` has the recipes of its coatings, if they are known.
///
/// # Errors
/// The text is not a lens, or is a lens that cannot be traced; the error gives the first location with a fault.
pub(super) fn read(
    text: &Text<'_>,
    library: &GlassLibrary,
    coating_file: Option<&CoatingFile>,
    ledger: &mut Ledger<'_>,
) -> Result<Prescription, LensFileError> {
    let blocks = Blocks::of(text)?;
    if let Some(record) =
        blocks.find("MODE").filter(|record| record.word(0).is_some_and(|mode| mode.text != "SEQ"))
    {
        return Err(text.error(record.key.location, "not a sequential lens (MODE SEQ)"));
    }
    let unit = unit(text, &blocks)?;
    let ZemaxParts { object, own, image } = ZemaxParts::of(text, &blocks, ledger)?;
    let first_location = object.unwrap_or(&own[0]).location;
    // The catalogues in which the file's program searches for glasses.
    let catalogues = blocks.find("GCAT").map_or(&[][..], |record| record.values());
    let mut glasses =
        NamedGlasses::new(library, catalogues.iter().map(|catalogue| loose(catalogue.text)).collect());
    let primary = general::primary_wavelength(text, &blocks)?;
    let wavelength = primary.map_or(D_LINE, |(wavelength, _)| wavelength);
    let in_front = match object {
        Some(object) => surface::object_medium(text, object, &mut glasses, ledger)?,
        None => Medium::Air.into(),
    };
    if let Some(object) = object {
        frames::check_object(text, object)?;
    }
    let mut surfaces: Vec<SequentialSurface> = Vec::with_capacity(own.len());
    for block in own {
        let behind = surfaces.last().map_or(in_front, |before| before.behind);
        surfaces.push(surface::read(text, block, behind, &mut glasses, ledger)?);
    }
    let image_break = match image {
        Some(image) => frames::read(text, image)?[0],
        None => None,
    };
    general::environment(&blocks, ledger);
    let stop = surfaces.iter().position(|surface| surface.is_stop);
    let aperture = aperture::aperture(text, &blocks, ledger)?;
    // The surface of the object is number 0, even if the file lacks it.
    let numbers = (stop.map(|stop| stop + 1), aperture == Aperture::ByStop);
    let configurations = Configurations::of(text, &blocks, own.len() + 2, numbers, ledger)?;
    // The thicknesses in each configuration, beginning with the distance of the object.
    let mut stated = vec![object.map_or(Ok(f64::INFINITY), |object| thickness(text, object, true))?];
    for block in own {
        stated.push(thickness(text, block, false)?);
    }
    check_mirrors(text, own, &surfaces, &stated[1..])?;
    let mut thicknesses = Vec::with_capacity(configurations.count);
    for column in 0..configurations.count {
        let of = |(surface, own): (usize, &f64)| {
            configurations.value(Operand::Thickness, surface, column).unwrap_or(*own)
        };
        thicknesses.push(stated.iter().enumerate().map(of).collect::<Vec<f64>>());
    }
    for (i, block) in own.iter().enumerate() {
        let is_rounding = |thickness: f64| thickness < 0.0 && thickness * unit > -ROUNDING;
        let mut rounded = thicknesses.iter_mut().filter(|column| is_rounding(column[i + 1])).peekable();
        if rounded.peek().is_some() {
            let reason = "a thickness of less than 100 nm below 0, as rounding leaves; 0 is used";
            ledger.warn(Fate::Replaced, block.location, "DISZ", Some(block.number), reason);
        }
        rounded.for_each(|column| column[i + 1] = 0.0);
    }
    let mut stop_sizes = Vec::new();
    if let Some(stop) = stop {
        for (column, thicknesses) in thicknesses.iter().enumerate() {
            let aperture = configurations.aperture(column).map_or(aperture, |value| aperture.with(value));
            let thicknesses_behind = &thicknesses[1..];
            let paraxial =
                Paraxial::of(in_front.medium, &surfaces, thicknesses_behind, Meridian::Y, wavelength);
            let by_aperture = paraxial.stop(aperture, stop, thicknesses[0]);
            let own = configurations.value(Operand::StopSize, stop + 1, column).filter(|size| *size > 0.0);
            let listed = own.or(surfaces[stop].listed);
            let size = by_aperture.or(listed).into_iter().chain(surfaces[stop].clip).min_by(f64::total_cmp);
            stop_sizes.push(size.or_else(|| let_through(in_front, &surfaces, stop, &paraxial)));
        }
        report_stop(&own[stop], &surfaces[stop], aperture, stop_sizes[0], ledger);
        surfaces[stop].semi_diameter = stop_sizes[0].or(surfaces[stop].semi_diameter);
    }
    let field = farthest_field(&blocks);
    for i in sequential::derive_missing(in_front, &mut surfaces, &thicknesses[0], field, wavelength) {
        let reason = "no semi-diameter (DIAM) is stated; 1.1 times that of paraxial rays of the file's aperture and field is used";
        ledger.warn(Fate::Replaced, own[i].location, "DIAM", Some(own[i].number), reason);
    }
    let Effective { kept: effective, left_out } = Effective::of(in_front, &surfaces, &thicknesses[0][1..]);
    for (i, reason) in left_out {
        ledger.note(Fate::LeftOut, own[i].location, "SURF", Some(own[i].number), reason);
    }
    let all_frames: Vec<Frames> = thicknesses
        .iter()
        .map(|column| Frames::of(&surfaces, &effective, &column[1..], image_break))
        .collect();
    check_moving_breaks(text, &all_frames, &effective, own)?;
    let moves = thicknesses.iter().any(|column| column[1..] != thicknesses[0][1..]);
    for block in own.iter().filter(|_| moves) {
        if let Some(record) = frames::return_of(block) {
            let reason = "a return to the frame of an earlier surface, with the values of the saved configuration at every \
                          position";
            ledger.warn(Fate::Replaced, record.key.location, "SCBD", Some(block.number), reason);
        }
    }
    let Frames { breaks, film_break, .. } = &all_frames[0];
    let film_break = *film_break;
    let mut gaps: Vec<Vec<f64>> = all_frames.iter().map(|frames| frames.gaps.clone()).collect();
    let mut rows = Vec::with_capacity(effective.len());
    for (row, &i) in effective.iter().enumerate() {
        let place = (gaps[0][row], breaks[row]);
        rows.push(surface_row(in_front, &surfaces, i, place).ok_or_else(|| {
            let message = format!(
                "surface {} has no semi-diameter (DIAM), and the file does not state an aperture, a field and a stop to \
                 derive it from",
                own[i].number
            );
            text.error(own[i].location, message)
        })?);
    }
    let moves = |row: usize| gaps.iter().any(|column| column[row] != gaps[0][row]);
    let origins = reflections::join(&mut rows, in_front, moves);
    let effective: Vec<usize> = origins.iter().map(|own| effective[own.row]).collect();
    for column in &mut gaps {
        *column = origins.iter().map(|own| column[own.gap]).collect();
    }
    for (row, reason) in reflections::obstructions(&mut rows, in_front) {
        let block = &own[effective[row]];
        ledger.warn(Fate::Replaced, block.location, "SURF", Some(block.number), reason);
    }
    let Some(last) = rows.len().checked_sub(1) else {
        return Err(text.error(own[0].location, "no surface does anything; expected a lens"));
    };
    // The distance to the film is along the light.
    let back = light_sign(&surfaces) * gaps[0][last];
    if back < 0.0 {
        let message = "the image lies in front of the last surface, where no film can be; the film's place is left open";
        let block = &own[own.len() - 1];
        ledger.warn(Fate::LeftOut, image.unwrap_or(block).location, "DISZ", None, message);
        rows[last].thickness = 0.0;
    }
    if let Some(record) = image.and_then(|image| image.find("CURV"))
        && record.number_if_any(0).is_some_and(|curvature| curvature != 0.0)
    {
        ledger.warn(Fate::Replaced, record.key.location, "CURV", None, sequential::CURVED_IMAGE);
    }
    let at = |row: usize, message: &str| text.error(own[effective[row]].location, message);
    let mut interfaces = surface_rows::interfaces(&rows, in_front.medium, &at, ledger)?;
    if image.is_none() {
        // Without the image's surface, the medium behind the last surface is unknown.
        surface_rows::film_in_air(&interfaces, &at)?;
    }
    interfaces[last].thickness = 0.0;
    let effective_blocks: Vec<_> = effective.iter().map(|&i| &own[i]).collect();
    let object = in_front.medium;
    let coatings =
        surface::coatings(&effective_blocks, object, &interfaces, wavelength, coating_file, ledger);
    let objects: Vec<f64> =
        thicknesses.iter().zip(&all_frames).map(|(column, frames)| column[0] + frames.front).collect();
    let mut positions = positions(text, &objects, &gaps, &stop_sizes, first_location)?;
    surface_rows::positions_in_order(in_front.medium, &interfaces, positions.as_mut(), &at)?;
    let (glasses, remarks) = glasses.glasses_and_warnings(text.file);
    let is_angle = blocks.find("FTYP").and_then(|record| record.number_if_any(0)).unwrap_or(0.0) == 0.0;
    let field = Some(2.0 * farthest(&blocks)).filter(|field| is_angle && *field > 0.0 && *field <= 360.0);
    let fnumber = match aperture {
        Aperture::FNumber(number) => Some(number),
        _ => None,
    };
    let mut stated = Stated { year: None, fnumber, fields: field.map(Some).into_iter().collect() };
    if let Some(positions) = &mut positions {
        for (i, column) in positions.columns.iter_mut().enumerate() {
            column.fnumber = fnumber.map(|fnumber| configurations.aperture(i).unwrap_or(fnumber));
        }
        let fields = field.map(|field| vec![Some(field); positions.columns.len()]);
        stated = Stated { year: None, fnumber: None, fields: fields.unwrap_or_default() };
    }
    let lens = Prescription {
        title: title(&blocks),
        object_medium: in_front.medium,
        object_glass: in_front.glass,
        nominal_film_distance: (back > 0.0).then_some(back),
        film_break,
        stated,
        glasses,
        coatings,
        wavelength: primary.map(|(wavelength, _)| wavelength),
        positions,
        remarks,
        ..Prescription::new(interfaces)
    };
    if let Some((wavelength, location)) = primary {
        lens.check_wavelength(wavelength).map_err(|why| text.error(location, why))?;
    }
    let lens = if unit == 1.0 { lens } else { lens.scaled(unit) };
    if !has_range(&lens) {
        return Err(
            text.error(first_location, "a length of this lens, in mm, is beyond the range of numbers")
        );
    }
    statements::record_fates(&blocks, own, ledger);
    Ok(lens)
}

/// Checks that light goes back behind mirrors that are written by their index, which also stands for other things.
///
/// # Errors
/// The thickness behind such a mirror leads on along the light.
fn check_mirrors(
    text: &Text<'_>,
    own: &[Block<'_>],
    surfaces: &[SequentialSurface],
    thicknesses: &[f64],
) -> Result<(), LensFileError> {
    for (i, (block, surface)) in own.iter().zip(surfaces).enumerate() {
        let is_by_index = surface.general.is_mirror && !surface::is_called_mirror(block);
        if is_by_index && light_sign(&surfaces[..=i]) * thicknesses[i] < 0.0 {
            let message = format!(
                "surface {} is a mirror, written by its index -1, and the thickness behind it is against the light: behind \
                 an odd number of mirrors thicknesses are 0 or less",
                block.number
            );
            return Err(text.error(block.location, message));
        }
    }
    Ok(())
}

/// Checks that the configurations have the same changes of frame.
///
/// # Errors
/// A configuration changes a thickness behind a tilt, so that the change of frame that they make together is another.
fn check_moving_breaks(
    text: &Text<'_>,
    all: &[Frames],
    effective: &[usize],
    own: &[Block<'_>],
) -> Result<(), LensFileError> {
    for (number, frames) in (1..).zip(all) {
        if let Some(row) = all[0].differs(frames) {
            let block = effective.get(row).map_or(&own[own.len() - 1], |&i| &own[i]);
            let message = format!(
                "configuration {number} changes a thickness between tilts in front of surface {} or the film, which would move \
                 the tilted surfaces: keep one configuration in the file's program and save the lens",
                block.number
            );
            return Err(text.error(block.location, message));
        }
    }
    Ok(())
}

/// The blocks of a file: the lens, the object in front of it and the image behind it.
struct ZemaxParts<'b, 't> {
    object: Option<&'b Block<'t>>,
    /// The surfaces of the lens; at least one.
    own: &'b [Block<'t>],
    image: Option<&'b Block<'t>>,
}

impl<'b, 't> ZemaxParts<'b, 't> {
    /// Assigns the surfaces of a file, which are numbered from 0, to the lens, the object and the image. A file that
    /// begins with surface 1 has no object, and has an image only if its last surface is a plane in air.
    fn of(text: &Text<'_>, blocks: &'b Blocks<'t>, ledger: &mut Ledger<'_>) -> Result<Self, LensFileError> {
        let all = blocks.surfaces.as_slice();
        let first = usize::from(all.first().is_some_and(|block| block.number.parse() == Ok(1)));
        let odd = (first..).zip(all).find(|(i, block)| block.number.parse() != Ok(*i));
        if let Some((i, odd)) = odd {
            let message = format!(
                "surface {} where surface {i} was expected; surfaces are taken in the order in which they stand",
                cut(odd.number)
            );
            ledger.warn(Fate::Replaced, odd.location, "SURF", None, message);
        }
        if first == 0 {
            let [object, own @ .., image] = all else {
                let location = Location { line: 1, column: 1 };
                return Err(text.error(location, "fewer than two surfaces, the object and the image"));
            };
            if own.is_empty() {
                return Err(
                    text.error(image.location, "no surface between object and image; expected at least one")
                );
            }
            return Ok(Self { object: Some(object), own, image: Some(image) });
        }
        let message = "the file has no surface 0, the object's: the first surface is taken for the lens's, and the object is \
                       distant";
        ledger.warn(Fate::Replaced, all[0].location, "SURF", None, message);
        let image = match all {
            [_, .., before, last] if before.find("GLAS").is_none() && is_plane_in_air(last) => Some(last),
            _ => None,
        };
        Ok(Self { object: None, own: &all[..all.len() - usize::from(image.is_some())], image })
    }
}

/// Returns whether a surface has no effect if there is air in front of it.
fn is_plane_in_air(block: &Block<'_>) -> bool {
    let curvature = block.find("CURV").and_then(|record| record.number_if_any(0));
    curvature.unwrap_or(0.0) == 0.0 && block.find("GLAS").is_none() && block.find("STOP").is_none()
}

/// Records how the stop's size was found.
fn report_stop(
    block: &Block<'_>,
    stop: &SequentialSurface,
    aperture: Aperture,
    size: Option<f64>,
    ledger: &mut Ledger<'_>,
) {
    let location_of = |key: &str| block.find(key).map(|record| record.key.location);
    let number = Some(block.number);
    if stop.clip.is_some() && stop.clip == size {
        if stop.clip < stop.listed || aperture != Aperture::ByStop {
            let reason = "the stop's own aperture (CLAP), which is the narrower one, limits the beam";
            ledger.note(
                Fate::Replaced,
                location_of("DIAM").unwrap_or(block.location),
                "DIAM",
                number,
                reason,
            );
        }
    } else if aperture != Aperture::ByStop {
        for key in ["DIAM", "CLAP"] {
            if let Some(location) = location_of(key) {
                ledger.note(
                    Fate::Replaced,
                    location,
                    key,
                    number,
                    "the stop is as large as the file's aperture says",
                );
            }
        }
    } else if stop.listed.is_none() && size.is_some() {
        let reason = "the stop has no size (DIAM), and the file states no aperture; it is as large as the axial beam that the \
                      other surfaces let through";
        ledger.warn(Fate::Replaced, block.location, "DIAM", number, reason);
    }
}

/// Returns the unit of the file's lengths, mm.
fn unit(text: &Text<'_>, blocks: &Blocks<'_>) -> Result<f64, LensFileError> {
    let Some(word) = blocks.find("UNIT").and_then(|record| record.word(0)) else { return Ok(1.0) };
    match word.text.to_ascii_uppercase().as_str() {
        "MM" => Ok(1.0),
        "CM" => Ok(10.0),
        "IN" | "INCH" => Ok(25.4),
        "M" | "METER" => Ok(1000.0),
        _ => Err(text.error(word.location, format!("\"{word}\" is not a unit: MM, CM, IN or METER"))),
    }
}

fn title(blocks: &Blocks<'_>) -> Option<String> {
    let words = blocks.find("NAME")?.values().iter().map(|word| word.text).collect::<Vec<_>>().join(" ");
    let title: String = words.chars().filter(|c| !c.is_control()).collect();
    Some(title.trim_matches(|c: char| c == '#' || c.is_whitespace()).to_owned())
        .filter(|title| !title.is_empty())
}

/// Returns the thickness behind a surface. The thickness behind the object may be infinite.
fn thickness(text: &Text<'_>, block: &Block<'_>, is_object: bool) -> Result<f64, LensFileError> {
    let Some(record) = block.find("DISZ") else { return Ok(if is_object { f64::INFINITY } else { 0.0 }) };
    let is_endless = record.word(0).is_some_and(|value| value.text.to_ascii_uppercase().starts_with("INF"));
    match is_endless {
        true if is_object => Ok(f64::INFINITY),
        true => Err(text.error(
            record.key.location,
            "a thickness without end; a lens's surfaces stand at finite distances",
        )),
        false => record.number(text, 0),
    }
}

#[cfg(test)]
mod tests;
