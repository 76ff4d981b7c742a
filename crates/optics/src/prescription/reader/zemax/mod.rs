//! Sequential Zemax files (.zmx): text of keywords, with a block `SURF n` for each surface, the object first and the
//! image last. The files state *semi*-diameters, and curvatures instead of radii.
//!
//! Surfaces that have no effect, and whose size the file's program computed, are left out. The stop, whether on glass
//! or in air, has the size that follows from the file's aperture.
//!
//! `blocks` splits the text into records. `general` reads the records of the whole lens, and `surface` reads the
//! records of a block. `coating_file` reads the file of coatings that an archive includes. `aperture` derives missing semi-diameters by paraxial rays. `shapes` reads the apertures of
//! surfaces. `statements` records the fate of
//! every line.

mod aperture;
mod blocks;
mod coating_file;
mod general;
mod shapes;
mod statements;
mod surface;

use super::{
    ledger::Ledger,
    named_glass::NamedGlasses,
    surface_rows::{self, MediumBehind, Role, SurfaceRow},
    text::{Location, Text},
};
use crate::prescription::{
    Fate, LensFileError,
    glass::{D_LINE, GlassLibrary, loose},
    interfaces::{Medium, NO_TERMS, Prescription, Shape, Stated},
    positions::{Position, Positions},
};
use aperture::{Aperture, Paraxial, farthest};
use blocks::{Block, Blocks};
pub(super) use coating_file::CoatingFile;
use general::{Configurations, Operand};
use realistic_base::message::{cut, short};
use surface::ZemaxSurface;

/// Returns whether a line begins a surface. No other format has such a line.
pub(super) fn is_surface(line: &[u8]) -> bool {
    blocks::is_surface(line)
}

/// Object distances from this value on, in the file's unit, mean infinity: multi-configuration records write 1e10.
const FAR: f64 = 1e9;

/// Negative thicknesses of a magnitude below this value, mm, are rounding errors and are set to 0.
const ROUNDING: f64 = 1e-4;

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
    let mut surfaces = own
        .iter()
        .map(|block| surface::read(text, block, &mut glasses, ledger))
        .collect::<Result<Vec<_>, _>>()?;
    general::environment(&blocks, ledger);
    let stop = surfaces.iter().position(|surface| surface.is_stop);
    let aperture = Aperture::of(text, &blocks, ledger)?;
    // The surface of the object is number 0, even if the file lacks it.
    let numbers = (stop.map(|stop| stop + 1), aperture == Aperture::ByStop);
    let configurations = Configurations::of(text, &blocks, own.len() + 2, numbers, ledger)?;
    // The thicknesses in each configuration, beginning with the distance of the object.
    let mut stated = vec![object.map_or(Ok(f64::INFINITY), |object| thickness(text, object, true))?];
    for block in own {
        stated.push(thickness(text, block, false)?);
    }
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
            let paraxial = Paraxial::of(in_front.medium, &surfaces, &thicknesses[1..], wavelength);
            let by_aperture = paraxial.stop(aperture, stop, thicknesses[0]);
            let own = configurations.value(Operand::StopSize, stop + 1, column).filter(|size| *size > 0.0);
            let listed = own.or(surfaces[stop].listed);
            let size = by_aperture.or(listed).into_iter().chain(surfaces[stop].clip).min_by(f64::total_cmp);
            stop_sizes.push(size.or_else(|| let_through(in_front, &surfaces, stop, &paraxial)));
        }
        report_stop(&own[stop], &surfaces[stop], aperture, stop_sizes[0], ledger);
        surfaces[stop].semi_diameter = stop_sizes[0].or(surfaces[stop].semi_diameter);
    }
    derive_missing(&blocks, own, stop, in_front, &mut surfaces, &thicknesses[0], wavelength, ledger);
    let effective = effective_surfaces(own, in_front, &surfaces, &thicknesses[0], ledger);
    let gaps: Vec<Vec<f64>> = thicknesses.iter().map(|column| merged(&effective, &column[1..])).collect();
    let mut rows = Vec::with_capacity(effective.len());
    for (row, &i) in effective.iter().enumerate() {
        rows.push(surface_row(in_front, &surfaces, i, gaps[0][row]).ok_or_else(|| {
            let message = format!(
                "surface {} has no semi-diameter (DIAM), and the file does not state an aperture, a field and a stop to \
                 derive it from",
                own[i].number
            );
            text.error(own[i].location, message)
        })?);
    }
    let Some(last) = rows.len().checked_sub(1) else {
        return Err(text.error(own[0].location, "no surface does anything; expected a lens"));
    };
    let back = rows[last].thickness;
    if back < 0.0 {
        let message = "the image lies in front of the last surface, where no film can be; the film's place is left open";
        let block = &own[own.len() - 1];
        ledger.warn(Fate::LeftOut, image.unwrap_or(block).location, "DISZ", None, message);
        rows[last].thickness = 0.0;
    }
    if let Some(record) = image.and_then(|image| image.find("CURV"))
        && record.number_if_any(0).is_some_and(|curvature| curvature != 0.0)
    {
        ledger.warn(
            Fate::Replaced,
            record.key.location,
            "CURV",
            None,
            "the image is curved; the film is flat",
        );
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
    let mut positions = positions(text, &thicknesses, &gaps, &stop_sizes, first_location)?;
    surface_rows::positions_in_order(in_front.medium, &interfaces, positions.as_ref(), &at)?;
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

/// Returns the semi-diameter of a stop that states none: that of the widest beam that passes the other surfaces.
fn let_through(
    object: MediumBehind,
    surfaces: &[ZemaxSurface],
    stop: usize,
    paraxial: &Paraxial,
) -> Option<f64> {
    let counts = |&i: &usize| i != stop && (!is_idle(object, surfaces, i) || surfaces[i].is_fixed);
    let others = (0..surfaces.len()).filter(counts).filter_map(|i| Some((i, surfaces[i].semi_diameter?)));
    paraxial.let_through(stop, others)
}

/// Records how the stop's size was found.
fn report_stop(
    block: &Block<'_>,
    stop: &ZemaxSurface,
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

/// Returns whether all lengths are finite, and whether all lengths except thicknesses and gaps are also positive. Units
/// and sums may cause overflow or underflow.
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

/// Returns whether the media on both sides of a surface are the same. `object` is the medium in front of the lens.
fn is_idle(object: MediumBehind, surfaces: &[ZemaxSurface], i: usize) -> bool {
    let in_front = if i == 0 { object } else { surfaces[i - 1].behind };
    in_front == surfaces[i].behind
}

/// Returns the surfaces that have an effect: they bend rays, are the stop, or have an aperture that the file fixes.
/// Planes behind the image limit no ray that reaches the image. The fates of the other surfaces go to `ledger`.
fn effective_surfaces(
    own: &[Block<'_>],
    object: MediumBehind,
    surfaces: &[ZemaxSurface],
    thicknesses: &[f64],
    ledger: &mut Ledger<'_>,
) -> Vec<usize> {
    let limits = |i: usize| surfaces[i].is_fixed && surfaces[i].semi_diameter.is_some();
    let mut effective: Vec<usize> = Vec::new();
    for i in 0..surfaces.len() {
        let to_image: f64 = thicknesses[i + 1..].iter().sum();
        let bends = |i: usize| !is_idle(object, surfaces, i) || surfaces[i].is_stop;
        let reason = if bends(i) {
            None
        } else if to_image < 0.0 && !(i..surfaces.len()).any(bends) {
            Some("a plane behind the image, which limits no ray that reaches it")
        } else if limits(i) {
            None
        } else {
            Some("a surface that bends no ray and whose size the file's program computed")
        };
        match reason {
            Some(reason) => ledger.note(Fate::LeftOut, own[i].location, "SURF", Some(own[i].number), reason),
            None => effective.push(i),
        }
    }
    effective
}

/// Returns, for each surface with an effect, the thickness behind it plus the thicknesses behind the surfaces left out
/// after it.
fn merged(effective: &[usize], thicknesses: &[f64]) -> Vec<f64> {
    let end = |row: usize| effective.get(row + 1).copied().unwrap_or(thicknesses.len());
    (0..effective.len()).map(|row| thicknesses[effective[row]..end(row)].iter().sum()).collect()
}

/// Derives the missing semi-diameters, if the file has the data for that.
#[allow(clippy::too_many_arguments, reason = "they are the file's parts, each used once")]
fn derive_missing(
    blocks: &Blocks<'_>,
    own: &[Block<'_>],
    stop: Option<usize>,
    object: MediumBehind,
    surfaces: &mut [ZemaxSurface],
    thicknesses: &[f64],
    wavelength: f64,
    ledger: &mut Ledger<'_>,
) {
    let missing: Vec<usize> = (0..surfaces.len())
        .filter(|&i| surfaces[i].semi_diameter.is_none() && !is_idle(object, surfaces, i))
        .collect();
    let Some((stop, size)) = stop.and_then(|stop| Some((stop, surfaces[stop].semi_diameter?))) else {
        return;
    };
    let paraxial = Paraxial::of(object.medium, surfaces, &thicknesses[1..], wavelength);
    let field = paraxial.field(blocks, stop, thicknesses[0]);
    for i in missing {
        if let Some(reach) = paraxial.reach(i, stop, size, field) {
            surfaces[i].semi_diameter = Some(reach);
            let reason = "no semi-diameter (DIAM) is stated; that of paraxial rays of the file's aperture and field is used";
            ledger.warn(Fate::Replaced, own[i].location, "DIAM", Some(own[i].number), reason);
        }
    }
}

/// Returns the row of a surface; `None` if the surface has no size.
fn surface_row(
    object: MediumBehind,
    surfaces: &[ZemaxSurface],
    i: usize,
    thickness: f64,
) -> Option<SurfaceRow> {
    let surface = &surfaces[i];
    let is_plane =
        surface.curvature == 0.0 && surface.asphere.is_none_or(|asphere| asphere.terms == NO_TERMS);
    let is_in_air = is_idle(object, surfaces, i) && surface.behind.medium == Medium::Air;
    let role = match surface.is_stop {
        true => Role::Stop,
        false if is_plane && is_in_air => Role::FlareStop,
        false => Role::Any,
    };
    Some(SurfaceRow {
        // A curvature of 0 means a plane.
        radius: if surface.curvature == 0.0 { f64::INFINITY } else { surface.curvature.recip() },
        role,
        thickness,
        behind: surface.behind,
        diameter: 2.0 * surface.semi_diameter?,
        asphere: surface.asphere.filter(|_| !is_plane),
        apertures: surface.apertures.clone(),
    })
}

/// Returns the configurations as positions; `None` if the file has a single configuration with the object at infinity.
fn positions(
    text: &Text<'_>,
    thicknesses: &[Vec<f64>],
    gaps: &[Vec<f64>],
    stop_sizes: &[Option<f64>],
    object: Location,
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
