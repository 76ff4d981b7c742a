//! The set-up of the models with a lens file: the lens, the film's position, and the camera's settings. A
//! parameter overrides the value in the lens file, for example the blades of the stop or the coatings.

use std::sync::Arc;

use super::{
    common::{disk_mapping, placement, raster},
    facts::Facts,
    focusing::{FilmPosition, Focusing, place_film, warn_of_blurred_film},
    groups::{focus_distance, place_groups, reach},
    shared::SharedLens,
    stop_picture::stop_picture,
};
use crate::{
    film::Film,
    host::Host,
    parameters::{
        CameraError, Exposure, FocusBy, ParameterError, Parameters, Pupil, Transmission, Units, Weighting,
    },
    placement::Placement,
    plan::Precision,
    sampling::{DiskMapping, FilmSurface},
};
use realistic_base::message::{Level, Log, as_given, short};
use realistic_optics::{
    imaging::{
        focus::{Conjugates, FocusError},
        open::{OpenLens, StopSize, find, misstated, set_up},
    },
    lens::{Lens, Surface, refraction::Refraction},
    prescription::{
        Blades, Medium, Prescription, SourceError, SurfaceCoating, catalogue,
        glass::{D_LINE, InternalTransmittance},
        glass_library, read_with,
    },
};

/// The input of a camera with a prescription.
#[derive(Clone, Debug)]
pub struct Setup {
    pub facts: Facts,
    /// The parts of the set-up that another camera with this lens may reuse.
    pub shared: SharedLens,
    /// The media from the scene's to the film's, one more than surfaces.
    pub media: Vec<Medium>,
    /// Absorption of the medium behind each surface; `None` if it is not known.
    pub transmittances: Vec<Option<Arc<InternalTransmittance>>>,
    pub refraction: Refraction,
    pub pupil: Pupil,
    pub mapping: DiskMapping,
    pub weighting: Weighting,
    /// The coatings of the surfaces, if weights include the surfaces' transmission.
    pub coatings: Option<Vec<SurfaceCoating>>,
    /// Share of the samples that follow paths with two reflections; greater than 0 only with coatings.
    pub ghosts: f64,
    /// Factor of radiometric weights; 1 if no exposure is given.
    pub exposure: f64,
    pub precision: Option<Precision>,
    /// Tolerance, pixels; 0 for exact tracing.
    pub tolerance: f64,
    pub leave_out: bool,
    pub mm_per_unit: f64,
    pub placement: Placement,
}

impl Setup {
    /// Reads and checks the parameters of these models. Reuses the parts of the donor that depend only on
    /// unchanged input.
    pub fn of(
        given: &Parameters,
        host: &Host,
        focusing: Focusing,
        donor: Option<&SharedLens>,
        log: Log<'_>,
    ) -> Result<Self, CameraError> {
        let film = film(given, host)?;
        let units = units(given, host)?;
        let with_units = |error| with_units(error, given, units);
        let shared = open(given, host, focusing, donor, log).map_err(with_units)?;
        let in_use = shared.in_use.clone();
        let prescription = &in_use.prescription;
        let (film_distance, in_focus) =
            place_film(&in_use.optics, film_position(given)?, focusing, log).map_err(with_units)?;
        // If the groups focus the lens, the distance in focus is the requested one.
        let focus_distance_mm = focus_distance(given)?.or(in_focus);
        let OpenLens { mut lens, first_order, beam } = in_use.optics.lens.clone();
        lens.set_blades(blades(given, prescription)?);
        if let Some(picture) = stop_picture(given, prescription, host, log)? {
            lens.add_picture(picture);
        }
        check_reach(&lens, film_distance, units.mm)?;
        let film = film.behind(&lens);
        let ghosts = ghosts(given, &film, &lens)?;
        let facts = Facts { lens, first_order, beam, film, film_distance, focus_distance_mm };
        let is_given = given.film_distance.is_some();
        if is_given || given.focus_distance.is_none() && facts.lens.nominal_film_distance.is_some() {
            warn_of_blurred_film(&facts, &in_use.optics, is_given, log);
        }
        let clip = [given.hither()?, given.yon()?];
        tell_units(units, given, log);
        warn_of_clipped_focus(&facts, clip, units.mm, log);
        Ok(Self {
            facts,
            shared,
            transmittances: prescription.transmittances(),
            media: prescription.media().map(|(medium, _)| medium).collect(),
            refraction: given.refraction(),
            pupil: given.pupil(),
            mapping: disk_mapping(given, host)?,
            weighting: given.weighting()?,
            coatings: coatings(given.transmission(), prescription)?,
            ghosts,
            exposure: exposure(given)?,
            precision: given.precision(),
            tolerance: given.tolerance()?,
            leave_out: host.leave_out,
            mm_per_unit: units.mm,
            placement: placement(clip, units.per_world_unit.recip(), given, host)?,
        })
    }

    /// Whether the wavelength of a ray matters, because of a glass or of a coating.
    pub fn is_dispersive(&self) -> bool {
        self.media.iter().any(Medium::is_dispersive)
            || self.coatings.iter().flatten().any(SurfaceCoating::is_dispersive)
    }
}

/// Returns the blades in the stop of a lens; `None` for a round stop.
///
/// # Errors
/// The number of blades is not supported, an angle or a curvature is given without blades, or the lens has no stop.
pub fn blades(given: &Parameters, prescription: &Prescription) -> Result<Option<Blades>, CameraError> {
    let (rotation, curvature) = (given.blade_rotation()?, given.blade_curvature()?);
    let count = match given.blades()? {
        None => prescription.blades().map_or(0, |blades| blades.count),
        Some(0.0) => 0,
        Some(number) => {
            let count = Blades::COUNTS.clone().find(|count| f64::from(*count) == number);
            let (from, to) = (Blades::COUNTS.start(), Blades::COUNTS.end());
            let range = format!("0 (a round stop) or a whole number from {from} to {to}");
            count.ok_or_else(|| ParameterError::out_of_range("blades", number, &range))?
        }
    };
    if count == 0 {
        let given = [("blade_rotation", rotation), ("blade_curvature", curvature)];
        return match given.into_iter().find(|(_, value)| value.is_some()) {
            Some((name, _)) => Err(CameraError::NoBlades { name }),
            None => Ok(None),
        };
    }
    if prescription.stop_in_air().is_none() {
        return Err(CameraError::NoStopFor { name: "blades", lens: prescription.name.clone() });
    }
    let own = prescription.blades().unwrap_or(Blades { count, rotation: 0.0, curvature: 0.0 });
    Ok(Some(Blades {
        count,
        rotation: rotation.unwrap_or(own.rotation),
        curvature: curvature.unwrap_or(own.curvature),
    }))
}

/// Returns the coatings of a lens's surfaces, from the scene on; `None` if the surfaces lose no light.
///
/// # Errors
/// The coatings of the lens file are requested, but the lens file names none.
pub fn coatings(
    transmission: Transmission,
    prescription: &Prescription,
) -> Result<Option<Vec<SurfaceCoating>>, CameraError> {
    if transmission == Transmission::File {
        let own = prescription.coatings.clone();
        let error = || CameraError::NoCoatings { lens: prescription.name.clone() };
        return own.ok_or_else(error).map(Some);
    }
    let all = |coating| vec![SurfaceCoating::from(coating); prescription.interfaces.len()];
    Ok(transmission.of_all().map(all))
}

/// Returns the film with its surface.
///
/// # Errors
/// The image has no pixels, a number is out of range, or the film reaches beyond the sphere along which it is
/// curved.
fn film(given: &Parameters, host: &Host) -> Result<Film, CameraError> {
    let film = Film::new(raster(host)?, given.film_diagonal()?).on(film_surface(given)?);
    if film.depth()[0].is_nan() {
        return Err(curved_too_much(given)?);
    }
    Ok(film)
}

/// Returns the surface of the film: its shift, its tilt and its curvature.
///
/// # Errors
/// A number is out of range, or the radius of the curvature is 0.
pub fn film_surface(given: &Parameters) -> Result<FilmSurface, CameraError> {
    let shift = [given.film_shift_x()?, given.film_shift_y()?];
    let tilt = [given.film_tilt_x()?, given.film_tilt_y()?];
    let radius = curvature_radius(given)?;
    if radius == 0.0 {
        return Err(curved_too_much(given)?);
    }
    Ok(FilmSurface::new(shift, tilt, radius))
}

/// Returns the radius of the film's curvature in mm, infinite for a flat film.
fn curvature_radius(given: &Parameters) -> Result<f64, CameraError> {
    Ok(given.film_curvature_radius()?.unwrap_or(f64::INFINITY))
}

/// Returns the error for a film that reaches beyond the sphere along which it is curved.
fn curved_too_much(given: &Parameters) -> Result<CameraError, CameraError> {
    Ok(CameraError::FilmCurvature { radius: curvature_radius(given)?, corner: 0.5 * given.film_diagonal()? })
}

/// Returns the factor of radiometric weights that turns them into an exposure as defined by OpenUSD's
/// cameras; 1 if none of the exposure parameters is given. With the factor, the mean weight on the axis is
/// the linear exposure scale of a camera whose `exposure:fStop` is the lens's T-number.
///
/// # Errors
/// A number is out of range, or weights are not radiometric.
fn exposure(given: &Parameters) -> Result<f64, CameraError> {
    let (Some(name), Some(exposure)) = (Exposure::given(given), Exposure::of(given)?) else {
        return Ok(1.0);
    };
    let weighting = given.weighting()?;
    if weighting != Weighting::Radiometric {
        return Err(CameraError::Exposure { name, weighting });
    }
    // The T-number is sqrt(π/(4 E)), where E is the irradiance on the axis, so 1/T² is 4/π times the mean
    // weight.
    let Exposure { iso, time, stops, responsivity } = exposure;
    Ok(4.0 / std::f64::consts::PI * (iso / 100.0 * time * responsivity) * stops.exp2())
}

/// Returns the share of the samples that follow paths with two reflections.
///
/// # Errors
/// The number is out of range, the surfaces reflect nothing, the film is tilted or curved, or the lens is not symmetric or
/// has mirrors.
fn ghosts(given: &Parameters, film: &Film, lens: &Lens) -> Result<f64, CameraError> {
    let share = given.ghosts()?;
    if share > 0.0 && !lens.is_round() {
        return Err(CameraError::GhostsOfGeneralLens { lens: lens.name.clone() });
    }
    if share > 0.0 && !film.surface().is_across() {
        return Err(CameraError::GhostsOnPosedFilm);
    }
    if share > 0.0 && given.transmission() == Transmission::None {
        return Err(CameraError::NothingReflects { share });
    }
    Ok(share)
}

/// Finds the lens of `lens_file` (or the host's `lens_text`), and sets it up at `wavelength`, at `zoom` and
/// at the stop of `aperture_diameter` or `fnumber`. If `focus_by` selects the groups, the lens is focused at
/// `focus_distance`. In the returned prescription, the groups are in position, and the positions that the
/// lens file lists are kept. Other parameters are ignored. `log` receives warnings.
///
/// # Errors
/// The lens does not exist, a file is not a lens, a value is out of range, or the lens cannot be scaled, zoomed,
/// focused or stopped down as requested.
pub fn open_lens(given: &Parameters, host: &Host, log: Log<'_>) -> Result<(Prescription, Lens), CameraError> {
    let in_use = open(given, host, Focusing::Exact, None, log)?.in_use;
    Ok((in_use.prescription.clone(), in_use.optics.lens.lens.clone()))
}

fn open(
    given: &Parameters,
    host: &Host,
    focusing: Focusing,
    donor: Option<&SharedLens>,
    log: Log<'_>,
) -> Result<SharedLens, CameraError> {
    let place_lens = |read: &Prescription, log: Log<'_>| {
        let light = light(given, read)?;
        let placed = placed(read, light, given, focusing, log)?;
        Ok((placed, light))
    };
    SharedLens::of((given, host), donor, || read_lens(given, host), place_lens, log)
}

/// Returns the lens with its groups in position, at a given wavelength and stop.
fn placed(
    prescription: &Prescription,
    (wavelength, stop): (f64, StopSize),
    given: &Parameters,
    focusing: Focusing,
    log: Log<'_>,
) -> Result<Prescription, CameraError> {
    if given.wavelength.is_none() && (wavelength - D_LINE).abs() > 0.01 {
        let name = &prescription.name;
        let text =
            format!("lens \"{name}\" is for {} nm by its file, and is traced at that", as_given(wavelength));
        log(Level::Info, &text);
    }
    let silent = |prescription: &Prescription| Ok(set_up(prescription, wavelength, stop, &mut |_, _| ())?);
    place_groups(prescription.clone(), given, focusing, silent)
}

fn read_lens(given: &Parameters, host: &Host) -> Result<Prescription, CameraError> {
    let glasses = given.glass_catalog.as_deref();
    let mut prescription = match (&host.lens_text, &given.lens_file) {
        (Some(_), Some(_)) => return Err(both("lens_file", "lens_text").into()),
        (Some((name, text)), None) => {
            let library = glass_library(glasses, &host.search)?;
            read_with(name, text, &library).map_err(SourceError::from)?
        }
        (None, Some(name)) => find(name, glasses, &host.search)?,
        (None, None) => {
            // The built-in lens names no glasses, but a catalogue that is given must exist.
            glass_library(glasses, &host.search)?;
            catalogue::default()
        }
    };
    if given.strict == Some(true) {
        prescription.check_as_written()?;
    }
    prescription.remarks.extend(misstated(&prescription));
    Ok(prescription)
}

/// Returns the wavelength, nm, and the size of the stop that the parameters request.
fn light(given: &Parameters, prescription: &Prescription) -> Result<(f64, StopSize), ParameterError> {
    let stop = match (given.aperture_diameter()?, given.fnumber()?) {
        (Some(_), Some(_)) => return Err(both("fnumber", "aperture_diameter")),
        (Some(diameter), None) => StopSize::Diameter(diameter),
        (None, Some(number)) => StopSize::FNumber(number),
        (None, None) => StopSize::Listed,
    };
    Ok((given.wavelength()?.unwrap_or_else(|| prescription.own_wavelength()), stop))
}

/// Returns the nearest and the farthest plane on which the lens of [`open_lens`] focuses by moving its
/// groups, by exact rays, each with its film distance; `focus_by` and `focus_distance` are ignored.
///
/// # Errors
/// The errors of [`open_lens`]; also if the lens's table does not describe how the groups move to focus.
pub fn group_reach(given: &Parameters, host: &Host) -> Result<[Conjugates; 2], CameraError> {
    let prescription = read_lens(given, host)?;
    let (wavelength, stop) = light(given, &prescription)?;
    let silent = |prescription: &Prescription| Ok(set_up(prescription, wavelength, stop, &mut |_, _| ())?);
    reach(&prescription, given, silent)
}

/// Returns the distance from the last vertex to the film, mm, for the given `film_distance` or
/// `focus_distance` (units of camera space), by exact rays. If neither is given, or if the groups of the lens
/// are focused instead (`focus_by`), returns the lens file's distance or, if it has none, the distance that
/// focuses at infinity.
///
/// # Errors
/// A value is out of range, both distances are given, or the lens cannot focus there.
pub fn film_distance(given: &Parameters, lens: &Lens) -> Result<f64, CameraError> {
    place_film(&OpenLens::new(lens.clone()).into(), film_position(given)?, Focusing::Exact, &mut |_, _| ())
        .map(|(film_distance, _)| film_distance)
}

/// Largest distance of any part of a camera from its front vertex, world units: even if a transform stretches
/// it 1e15 times, it fits in a float.
const FARTHEST: f64 = 1e22;
/// Largest distance of any part in mm, so that squares of lengths stay in range.
const FARTHEST_MM: f64 = 1e50;

/// Checks that the coordinates of lens and film fit in floats, the type that hosts accept.
fn check_reach(lens: &Lens, film_distance: f64, mm_per_unit: f64) -> Result<(), CameraError> {
    let of_surface = |surface: &Surface| surface.vertex.abs() + surface.semi_diameter;
    let reach = lens.surfaces.iter().map(of_surface).fold(film_distance, f64::max);
    if reach <= FARTHEST_MM && reach / mm_per_unit <= FARTHEST {
        return Ok(());
    }
    Err(CameraError::TooFar { lens: lens.name.clone(), reach, units: reach / mm_per_unit })
}

fn film_position(given: &Parameters) -> Result<FilmPosition, ParameterError> {
    Ok(match (given.film_distance()?, given.focus_distance()?) {
        (Some(_), Some(_)) => return Err(both("film_distance", "focus_distance")),
        _ if given.focus_by() == FocusBy::Group => FilmPosition::Nominal,
        (Some(distance), None) => FilmPosition::At(distance),
        (None, Some(distance)) => FilmPosition::FocusedOn(distance * given.mm_per_unit()?),
        (None, None) => FilmPosition::Nominal,
    })
}

/// Returns the units of camera space and of the world at the time when the shutter opens.
fn units(given: &Parameters, host: &Host) -> Result<Units, ParameterError> {
    let to_world = host.to_world.at(given.shutter_open()? as f32);
    Ok(Units::new(given.mm_per_unit()?, to_world.axial_scale()))
}

/// Adds the unit of `focus_distance` to the error of a distance that may have been meant in another unit.
fn with_units(error: CameraError, parameters: &Parameters, units: Units) -> CameraError {
    let may_be_others = units.differ() || parameters.mm_per_unit.is_none();
    match (error, parameters.focus_distance) {
        (CameraError::Focus(error @ FocusError::TooNear { .. }), Some(given)) if may_be_others => {
            CameraError::TooNear { error, given, units }
        }
        (error, _) => error,
    }
}

/// Reports the length of a world unit if the camera transform scales. Warns if `mm_per_unit` is given, too:
/// users easily mistake it for the length of a world unit, and the scale is then applied twice.
fn tell_units(units: Units, given: &Parameters, log: Log<'_>) {
    if !units.differ() {
        return;
    }
    if given.mm_per_unit.is_none() || units.mm == 1.0 {
        let focus = given.focus_distance.filter(|distance| distance.is_finite()).map(|distance| {
            let [distance, in_world] = [distance, distance / units.per_world_unit].map(short);
            format!("; \"focus_distance\" {distance} is {in_world} world units")
        });
        return log(Level::Info, &format!("{units}{}", focus.unwrap_or_default()));
    }
    let [alone, scale] = [units.per_world_unit, units.mm_per_world_unit()].map(short);
    log(
        Level::Warning,
        &format!(
            "{units}; \"mm_per_unit\" is the length of a unit of camera space, and the scale multiplies it: leave \"mm_per_unit\" \
             out if a world unit is {alone} mm, or give the scale {scale} alone if it is {scale} mm"
        ),
    );
}

/// Warns if `hither` and `yon`, in units of camera space, exclude the plane in focus, because they were then
/// probably meant in other units.
fn warn_of_clipped_focus(facts: &Facts, [hither, yon]: [f64; 2], mm_per_unit: f64, log: Log<'_>) {
    let Some(focus_distance) = facts.focus_distance_mm.filter(|distance| distance.is_finite()) else {
        return;
    };
    let front = facts.lens.front().vertex;
    let distance = (focus_distance + facts.film_z() - front) / mm_per_unit;
    let (name, clip) = if distance > yon {
        ("yon", yon)
    } else if distance < hither {
        ("hither", hither)
    } else {
        return;
    };
    let [distance, clip] = [distance, clip].map(short);
    log(
        Level::Warning,
        &format!(
            "\"{name}\" {clip} hides the plane in focus, which lies {distance} units of camera space in front of the lens; \
             \"hither\" and \"yon\" are in these units"
        ),
    );
}

fn both(first: &'static str, second: &'static str) -> ParameterError {
    ParameterError::Both { first, second }
}
