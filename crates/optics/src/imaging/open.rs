//! Opens a lens: finds a file or catalogue entry by name, and builds the lens at a wavelength and stop. Also computes
//! the first-order optics of the lens, which scaling needs, and its axial beam, which f-numbers need. Later code uses
//! both of these results.

use thiserror::Error;

use super::{
    axial_beam::{AxialBeam, semi_diameter_for_beam},
    moving::{MovingError, MovingGroups},
};
use crate::{
    lens::{Crossing, Lens, LensError, first_order::FirstOrder},
    prescription::{Prescription, SearchPath, SourceError, glass_library, load, split_scale},
};
use realistic_base::message::{Level, Log, as_given, fixed, short};

/// Stop setting of a lens.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum StopSize {
    /// The stop of the prescription.
    #[default]
    Listed,
    /// A clear diameter of the stop, mm, positive. A diameter wider than that of the prescription causes a warning and
    /// changes nothing.
    Diameter(f64),
    /// An f-number of the axial beam of exact rays, positive. An f-number lower than that of the lens causes a warning
    /// and changes nothing.
    FNumber(f64),
}

/// Smallest allowed ratio of a stop's diameter to its widest diameter. At this ratio the squares of ray slopes through
/// the stop remain well within the range of single precision.
const SMALLEST_STOP: f64 = 1e-12;

/// Relative difference between the reached and the requested f-number from which a warning is given.
const OFF: f64 = 1e-6;

/// Focal length, mm, below which the unit of a lens file is doubted. Endoscope lenses have focal lengths of 0.3 mm and
/// more.
const SHORTEST: f64 = 0.1;

/// Reason why a lens cannot be opened.
#[derive(Debug, Error)]
pub enum OpenError {
    /// No lens could be read.
    #[error(transparent)]
    Source(#[from] SourceError),
    /// The lens cannot be scaled or stopped down as requested, or its glasses have no data at the wavelength.
    #[error(transparent)]
    Lens(#[from] LensError),
    /// The request scales a zoom lens.
    #[error(transparent)]
    Moving(#[from] MovingError),
}

/// A lens with its first-order optics and its axial beam, computed once.
#[derive(Clone, Debug)]
pub struct OpenLens {
    /// The lens.
    pub lens: Lens,
    /// The cardinal points of the lens, or an error if the lens is afocal.
    pub first_order: Result<FirstOrder, LensError>,
    /// The beam of a distant axial point, with the pupils.
    pub beam: AxialBeam,
}

impl OpenLens {
    /// Computes the first-order optics and the axial beam of a lens.
    pub fn new(lens: Lens) -> Self {
        Self { first_order: FirstOrder::of(&lens), beam: AxialBeam::of(&lens), lens }
    }
}

/// Finds and reads the lens of a given name, scaled to a focal length if the name states one. Glasses are looked up
/// first in the glass catalogue `glasses`.
///
/// # Errors
/// No such lens or catalogue exists, the file is not a lens, or a lens to be scaled is afocal or a zoom lens.
pub fn find(name: &str, glasses: Option<&str>, search: &SearchPath) -> Result<Prescription, OpenError> {
    let (table, focal_length) = split_scale(name, search)?;
    let mut prescription = load(table, search, glass_library(glasses, search)?)?;
    if let Some(focal_length) = focal_length {
        if let Some(groups) = MovingGroups::of(&prescription).filter(MovingGroups::is_zoom) {
            return Err(MovingError::Scaled { given: name.to_owned(), range: groups.focal_range() }.into());
        }
        let own = FirstOrder::of(&Lens::at_own_wavelength(&prescription))?.focal_length;
        prescription = prescription.scaled(focal_length / own.abs());
        prescription.name = name.to_owned();
    }
    Ok(prescription)
}

/// Returns a warning if the focal length of a lens, or else of one of its positions, differs from the stated focal
/// length by more than a hundredth. A number in the file may then be misprinted, or the diameters, units or signs of
/// the file may be misinterpreted.
pub fn misstated(prescription: &Prescription) -> Option<String> {
    let warning = |at: &str, lens: &Prescription, stated: Option<f64>| {
        let stated = stated?;
        let own = FirstOrder::of(&Lens::at_own_wavelength(lens)).ok()?.focal_length;
        ((own - stated).abs() > 0.01 * stated).then(|| {
            format!(
                "lens \"{}\": {at}the file states a focal length of {} mm, and its surfaces have one of {} mm",
                prescription.name,
                as_given(stated),
                fixed(own, 3)
            )
        })
    };
    let at_position = |number: usize| {
        let positions = prescription.positions.as_ref()?;
        let column = &positions.columns[number];
        let at_gaps = prescription.with_gaps(&positions.gaps, &column.gaps);
        warning(&format!("at position {} ", number + 1), &at_gaps, column.focal_length)
    };
    let columns = prescription.positions.as_ref().map_or(0, |positions| positions.columns.len());
    warning("", prescription, prescription.stated_focal_length).or_else(|| (0..columns).find_map(at_position))
}

/// Builds the lens of a prescription at a stop and a wavelength, nm, which lies in
/// [`VALID_WAVELENGTHS`](crate::prescription::glass::VALID_WAVELENGTHS). `log` receives warnings.
///
/// # Errors
/// A glass has no index at the wavelength, or the lens cannot be stopped down as requested.
pub fn set_up(
    prescription: &Prescription,
    wavelength: f64,
    stop: StopSize,
    log: Log<'_>,
) -> Result<OpenLens, LensError> {
    for remark in &prescription.remarks {
        log(Level::Warning, remark);
    }
    let warnings = prescription.check_wavelength(wavelength);
    let warnings = warnings.map_err(|why| LensError::Wavelength { lens: prescription.name.clone(), why })?;
    for warning in warnings {
        log(Level::Warning, &warning);
    }
    if wavelength != prescription.own_wavelength() && !prescription.is_dispersive() {
        let name = &prescription.name;
        let text = format!(
            "lens \"{name}\" has neither V-numbers nor dispersion formulas: wavelength {} nm changes nothing",
            as_given(wavelength)
        );
        log(Level::Warning, &text);
    }
    let mut lens = Lens::new(prescription, wavelength);
    let in_front = lens.front().n_scene;
    let mut indices = std::iter::once(in_front).chain(lens.surfaces.iter().map(|surface| surface.n_film));
    if let Some((row, index)) = indices.by_ref().enumerate().find(|(_, index)| !(*index >= 1.0)) {
        return Err(LensError::Index { lens: prescription.name.clone(), row, index, wavelength });
    }
    report_media(&lens, log);
    report_crossings(&lens, log);
    // Cardinal points do not depend on the stop.
    let first_order = FirstOrder::of(&lens);
    if let Some(length) = first_order.as_ref().ok().map(|optics| optics.focal_length)
        && length.abs() < SHORTEST
    {
        let text = format!(
            "lens \"{}\" has a focal length of {} mm; lengths of a lens file are mm: are these metres?",
            lens.name,
            short(length)
        );
        log(Level::Warning, &text);
    }
    match stop {
        StopSize::Listed => {}
        StopSize::Diameter(diameter) => stop_to_diameter(&mut lens, diameter, log)?,
        StopSize::FNumber(number) => {
            stop_to_fnumber(&mut lens, first_order.clone()?.focal_length.abs(), number, log)?;
        }
    }
    Ok(OpenLens { first_order, beam: AxialBeam::of(&lens), lens })
}

fn stop_to_diameter(lens: &mut Lens, diameter: f64, log: Log<'_>) -> Result<(), LensError> {
    let Some(stop) = lens.stop_index() else {
        return Err(LensError::NoStop { lens: lens.name.clone() });
    };
    let widest = 2.0 * lens.surfaces[stop].semi_diameter;
    if diameter > widest {
        let text = format!(
            "\"aperture_diameter\" {} mm is wider than the lens's stop; {} mm is used",
            as_given(diameter),
            short(widest)
        );
        log(Level::Warning, &text);
    } else if diameter < SMALLEST_STOP * widest {
        let (lens, limit) = (lens.name.clone(), SMALLEST_STOP * widest);
        return Err(LensError::StopTooSmall { lens, name: "aperture_diameter", given: diameter, limit });
    } else {
        lens.surfaces[stop].semi_diameter = diameter / 2.0;
    }
    Ok(())
}

fn stop_to_fnumber(lens: &mut Lens, focal_length: f64, number: f64, log: Log<'_>) -> Result<(), LensError> {
    let beam = AxialBeam::of(lens);
    let widest = beam.fnumber(focal_length);
    if number < widest {
        let text = match beam.is_dark() {
            true => format!(
                "\"fnumber\" {} changes nothing: no ray parallel to the axis passes",
                as_given(number)
            ),
            false => {
                format!(
                    "\"fnumber\" {} is faster than the lens; f/{} is used",
                    as_given(number),
                    short(widest)
                )
            }
        };
        log(Level::Warning, &text);
        return Ok(());
    }
    if number * SMALLEST_STOP > widest {
        let (lens, limit) = (lens.name.clone(), widest / SMALLEST_STOP);
        return Err(LensError::StopTooSmall { lens, name: "fnumber", given: number, limit });
    }
    let surface = lens.stop_index().unwrap_or(beam.limiting);
    let semi_diameter = semi_diameter_for_beam(lens, surface, focal_length / number);
    // The stop may be wider than the beam at the lens's own f-number.
    let stop = &mut lens.surfaces[surface];
    stop.semi_diameter = stop.semi_diameter.min(semi_diameter);
    let reached = AxialBeam::of(lens).fnumber(focal_length);
    if !((reached / number - 1.0).abs() < OFF) {
        let text = format!(
            "\"fnumber\" {} cannot be reached by closing the stop: rays from the edge of the lens pass it nearer to the axis \
             than others do; with a stop of {} mm the outermost rays that pass are those of f/{}",
            as_given(number),
            short(2.0 * lens.surfaces[surface].semi_diameter),
            short(reached)
        );
        log(Level::Warning, &text);
    }
    Ok(())
}

/// Reports the media of the scene and of the film, unless both are air.
fn report_media(lens: &Lens, log: Log<'_>) {
    let [n_scene, n_film] = lens.outer_indices();
    if n_scene != 1.0 || n_film != 1.0 {
        let text = format!(
            "lens \"{}\": the scene lies in a medium of index {}, and the film in a medium of index {}",
            lens.name,
            short(n_scene),
            short(n_film)
        );
        log(Level::Info, &text);
    }
}

/// Warns of the first two surfaces whose crossing blocks rays. Also reports surfaces that overlap so little that rays
/// are traced as if the surfaces touched.
fn report_crossings(lens: &Lens, log: Log<'_>) {
    let crossings = lens.crossings();
    let rows = |crossing: &Crossing| crossing.surfaces.map(|surface| surface + 1);
    if let Some(crossing) = crossings.iter().find(|crossing| !crossing.is_contact) {
        let [first, second] = rows(crossing);
        let text = format!(
            "lens \"{}\": the surfaces of rows {first} and {second} cross {} mm from the axis, inside their clear diameters, \
             as no lens's do, and rays farther out are blocked; check their radii, diameters and the thickness between them",
            lens.name,
            short(crossing.height)
        );
        log(Level::Warning, &text);
    }
    for crossing in crossings.iter().filter(|crossing| crossing.is_contact && !crossing.is_rounding) {
        let [first, second] = rows(crossing);
        let text = format!(
            "lens \"{}\": the surfaces of rows {first} and {second} touch and overlap by up to {} mm inside their clear \
             diameters; rays are traced from one to the other all the same",
            lens.name,
            short(crossing.overlap)
        );
        log(Level::Info, &text);
    }
}
